// The arm on its canvas, and the hand on the arm.

const GRASP = 28; // px around the tool or an elbow
const OFTEN = 40; // ms between two targets of a drag
const TRAIL = 600; // samples

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class Drawing {
  #canvas;
  #state = null;
  #arm = null;
  #held = null; // what the hand has: "tool", 0 or 1
  #target = null;
  #sent = 0;
  #trail = [];
  job = null;
  onFollow = () => {};
  onTurn = () => {};

  constructor(canvas) {
    this.#canvas = canvas;
    canvas.addEventListener("pointerdown", (event) => this.#take(event));
    canvas.addEventListener("pointermove", (event) => this.#pull(event));
    canvas.addEventListener("pointerup", (event) => this.#release(event));
    canvas.addEventListener("pointercancel", () => { this.#held = null; });
    const draw = () => {
      this.#draw();
      requestAnimationFrame(draw);
    };
    requestAnimationFrame(draw);
  }

  set arm(arm) {
    this.#arm = arm;
    const xs = [], ys = [];
    for (const { center, radius, from, to } of arm.boundary) {
      for (let i = 0; i <= 32; i += 1) {
        const angle = from + ((to - from) * i) / 32;
        xs.push(center[0] + radius * Math.cos(angle));
        ys.push(center[1] + radius * Math.sin(angle));
      }
    }
    this.box = [Math.min(...xs), Math.min(...ys), Math.max(...xs), Math.max(...ys)];
  }

  show(state) {
    this.#state = state;
    if (!state.tool) return;
    // Where a hand, or a test, finds the tool.
    this.#canvas.dataset.tool = this.pixel(state.tool);
    this.#trail.push(state.tool);
    if (this.#trail.length > TRAIL) this.#trail.shift();
  }

  // Pixels of the canvas per metre, and the pixel of the origin.
  #scale() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    const [x0, y0, x1, y1] = this.box;
    const scale = 0.94 * Math.min(width / (x1 - x0), height / (y1 - y0));
    return [scale, width / 2 - (scale * (x0 + x1)) / 2, height / 2 + (scale * (y0 + y1)) / 2];
  }

  // The pixel of a place, counted from the canvas's corner.
  pixel([x, y]) {
    const [scale, left, top] = this.#scale();
    return [left + scale * x, top - scale * y];
  }

  #place(event) {
    const [scale, left, top] = this.#scale();
    const box = this.#canvas.getBoundingClientRect();
    return [(event.clientX - box.left - left) / scale, (top - (event.clientY - box.top)) / scale];
  }

  #take(event) {
    if (!this.#state?.joints) return;
    const place = this.#place(event);
    const [scale] = this.#scale();
    const [b, , d] = this.#state.joints;
    const distance = (point) => scale * Math.hypot(point[0] - place[0], point[1] - place[1]);
    const things = [["tool", this.#state.tool], [0, b], [1, d]];
    things.sort((one, other) => distance(one[1]) - distance(other[1]));
    const [what, point] = things[0];
    if (distance(point) > GRASP) return;
    this.#held = what;
    this.#canvas.setPointerCapture(event.pointerId);
  }

  #pull(event) {
    if (this.#held === null) return;
    this.#target = this.#place(event);
    if (event.timeStamp - this.#sent >= OFTEN) this.#send(event);
  }

  #release(event) {
    if (this.#held === null) return;
    this.#target = this.#place(event);
    this.#send(event);
    this.#held = null;
    this.#target = null;
  }

  #send(event) {
    this.#sent = event.timeStamp;
    const [x, y] = this.#target;
    if (this.#held === "tool") this.onFollow([x, y]);
    else this.onTurn(this.#held, Math.atan2(y, x - (this.#held === 0 ? 0 : this.#arm.base)));
  }

  #draw() {
    const canvas = this.#canvas;
    if (!this.#arm || !canvas.clientWidth) return;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth * ratio, canvas.clientHeight * ratio].map(Math.round);
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
    context.lineCap = context.lineJoin = "round";
    this.#drawReach(context);
    this.#drawJob(context);
    this.#drawLine(context, this.#trail, "--good", 1.5);
    this.#drawArm(context);
  }

  #drawReach(context) {
    const [scale] = this.#scale();
    context.strokeStyle = colour("--quiet");
    context.lineWidth = 1;
    context.setLineDash([4, 4]);
    for (const { center, radius, from, to } of this.#arm.boundary) {
      context.beginPath();
      context.arc(...this.pixel(center), scale * radius, -to, -from);
      context.stroke();
    }
    context.setLineDash([]);
  }

  #drawJob(context) {
    for (const { down, points } of this.job?.strokes ?? []) {
      if (!down) context.setLineDash([2, 5]);
      this.#drawLine(context, points, down ? "--one" : "--quiet", down ? 1.5 : 1);
      context.setLineDash([]);
    }
    if (this.job?.at) this.#dot(context, this.job.at, "--bad", 6);
  }

  #drawArm(context) {
    const state = this.#state;
    const a = [0, 0], e = [this.#arm.base, 0];
    if (!state?.joints) {
      const [b, c, d, tool] = this.#arm.home;
      context.globalAlpha = 0.3;
      this.#drawLine(context, [a, b, c, d, e], "--quiet", 6);
      this.#drawLine(context, [c, tool], "--quiet", 6);
      context.globalAlpha = 1;
      return;
    }
    const [b, c, d] = state.joints;
    if (state.reference) this.#dot(context, state.reference, "--good", 7);
    this.#drawLine(context, [a, b], "--one", 7);
    this.#drawLine(context, [b, c], "--ink", 4);
    this.#drawLine(context, [e, d], "--four", 7);
    this.#drawLine(context, [d, c], "--ink", 4);
    if (state.tool) this.#drawLine(context, [c, state.tool], "--ink", 4);
    for (const point of [a, e]) this.#dot(context, point, "--quiet", 7);
    this.#dot(context, b, "--one", 8);
    this.#dot(context, d, "--four", 8);
    if (state.tool) this.#dot(context, state.tool, "--ink", 8);
    if (this.#target) this.#dot(context, this.#target, "--quiet", 4);
  }

  #drawLine(context, points, name, width) {
    if (points.length < 2) return;
    context.strokeStyle = colour(name);
    context.lineWidth = width;
    context.beginPath();
    for (const point of points) context.lineTo(...this.pixel(point));
    context.stroke();
  }

  #dot(context, point, name, radius) {
    context.fillStyle = colour(name);
    context.beginPath();
    context.arc(...this.pixel(point), radius, 0, 2 * Math.PI);
    context.fill();
  }
}
