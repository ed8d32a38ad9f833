// The arm on its canvas, with its trail and the path of the job.
import { colour } from "./colour.js";

const TRAIL = 600; // samples
const BARS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1]; // m

export class Drawing {
  #canvas;
  #context;
  #arm;
  #map;
  #state = null;
  #trail = [];
  job = null;
  target = null; // where the pointer drags [m]

  constructor(canvas, arm, map) {
    this.#canvas = canvas;
    this.#arm = arm;
    this.#map = map;
    this.#context = canvas.getContext("2d");
  }

  get base() {
    return this.#arm.base;
  }

  // What can be dragged, by name; null until the arm is homed.
  get handles() {
    const state = this.#state;
    if (!state?.joints || !state.tool) return null;
    return { tool: state.tool, theta1: state.joints[0], theta4: state.joints[2] };
  }

  show(state) {
    this.#state = state;
    // Their pixels, for tests.
    for (const [name, point] of Object.entries(this.handles ?? {})) {
      this.#canvas.dataset[name] = this.pixel(point);
    }
    if (!state.tool) return;
    this.#trail.push({ at: state.tool, down: state.tool_level > 0 });
    if (this.#trail.length > TRAIL) this.#trail.shift();
  }

  // Pixels per metre, and the pixel of the origin.
  #scale() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    const [x0, y0, x1, y1] = this.#map.box;
    const scale = 0.94 * Math.min(width / (x1 - x0), height / (y1 - y0));
    return [scale, width / 2 - (scale * (x0 + x1)) / 2, height / 2 + (scale * (y0 + y1)) / 2];
  }

  // The pixel of a position [m], counted from the canvas's corner.
  pixel([x, y]) {
    const [scale, left, top] = this.#scale();
    return [left + scale * x, top - scale * y];
  }

  // The position under a pointer [m].
  position({ clientX, clientY }) {
    const [scale, left, top] = this.#scale();
    const corner = this.#canvas.getBoundingClientRect();
    return [(clientX - corner.left - left) / scale, (top - (clientY - corner.top)) / scale];
  }

  // The distance of two positions, in pixels.
  distance([x0, y0], [x1, y1]) {
    return this.#scale()[0] * Math.hypot(x1 - x0, y1 - y0);
  }

  draw() {
    const canvas = this.#canvas, context = this.#context;
    if (!canvas.clientWidth) return;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== wide || canvas.height !== high) Object.assign(canvas, { width: wide, height: high });
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.lineCap = context.lineJoin = "round";
    this.#map.draw(context, (point) => this.pixel(point), (...line) => this.#line(...line));
    this.#drawJob();
    this.#drawTrail();
    if (this.#state?.joints) this.#drawArm(this.#state);
    else this.#drawHome();
    this.#drawBar(height);
  }

  // The trail: strong where the tool was down or on, faint elsewhere.
  #drawTrail() {
    let from = 0;
    for (let to = 1; to <= this.#trail.length; to += 1) {
      const { down } = this.#trail[from];
      if (this.#trail[to]?.down === down) continue;
      const points = this.#trail.slice(from, to + 1).map(({ at }) => at);
      this.#line(points, down ? "--good" : "--quiet", down ? 2 : 1);
      from = to;
    }
  }

  #drawJob() {
    for (const { down, points } of this.job?.strokes ?? []) {
      if (down) {
        this.#line(points, "--path", 1.5);
      } else {
        this.#context.setLineDash([2, 5]);
        this.#line(points, "--quiet", 1);
        this.#context.setLineDash([]);
      }
    }
    if (this.job?.at) this.#cross(this.job.at);
  }

  // The home pose, pale, because the arm's real pose is unknown until it is homed.
  #drawHome() {
    const [b, c, d, tool] = this.#arm.home;
    this.#context.globalAlpha = 0.3;
    this.#line([[0, 0], b, c, d, [this.base, 0]], "--quiet", 6);
    this.#line([c, tool], "--quiet", 6);
    this.#context.globalAlpha = 1;
  }

  #drawArm({ joints: [b, c, d], tool, reference }) {
    const [a, e] = [[0, 0], [this.base, 0]];
    if (reference) this.#dot(reference, "--good", 8);
    this.#line([b, c, d], "--ink", 4);
    if (tool) this.#line([c, tool], "--ink", 4);
    this.#line([a, b], "--one", 7);
    this.#line([e, d], "--four", 7);
    for (const point of [a, e]) this.#dot(point, "--quiet", 7);
    this.#dot(b, "--one", 10, "1");
    this.#dot(d, "--four", 10, "4");
    if (tool) this.#dot(tool, "--ink", 8);
    if (this.target) this.#dot(this.target, "--quiet", 4);
  }

  // The scale bar.
  #drawBar(height) {
    const context = this.#context;
    const length = BARS.findLast((bar) => this.#scale()[0] * bar < 120) ?? BARS[0];
    const [left, low] = [14, height - 14];
    context.strokeStyle = context.fillStyle = colour("--quiet");
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(left, low);
    context.lineTo(left + this.#scale()[0] * length, low);
    context.stroke();
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "left";
    context.textBaseline = "alphabetic";
    context.fillText(`${1000 * length} mm`, left, low - 6);
  }

  #line(points, name, width) {
    if (points.length < 2) return;
    const context = this.#context;
    context.strokeStyle = colour(name);
    context.lineWidth = width;
    context.beginPath();
    for (const point of points) context.lineTo(...this.pixel(point));
    context.stroke();
  }

  #dot(point, name, radius, label = "") {
    const context = this.#context;
    const [x, y] = this.pixel(point);
    context.fillStyle = colour(name);
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fill();
    if (!label) return;
    context.fillStyle = colour("--paper");
    context.font = "bold 12px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(label, x, y + 0.5);
  }

  #cross(point) {
    const context = this.#context;
    const [x, y] = this.pixel(point);
    context.strokeStyle = colour("--bad");
    context.lineWidth = 3;
    context.beginPath();
    for (const [dx, dy] of [[7, 7], [7, -7]]) {
      context.moveTo(x - dx, y - dy);
      context.lineTo(x + dx, y + dy);
    }
    context.stroke();
  }
}
