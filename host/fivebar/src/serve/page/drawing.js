// The arm on its canvas, with its trail and the path of the job.
import { colour } from "./colour.js";
import { Layer, Points } from "./layers.js";
import { kindOf, stepsOf } from "./recording.js";

const DRAWN = 200000; // samples of strokes
const TRAVELLED = 250; // samples of the path with the pen up
const ZOOMS = [0.5, 60];
export const UNMOVED = { about: [0, 0], by: [0, 0], scale: 1 }; // the point that stays when scaled, and the motion [m]
const CORNER = 5; // px from the middle of a corner's handle to its sides
const BARS = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1]; // m

export class Drawing {
  #canvas;
  #context;
  #arm;
  #map;
  #state = null;
  #drawn = new Points();
  #drawings = 0; // how often what was drawn was forgotten in part
  #travelled = [];
  #view = { zoom: 1, x: 0, y: 0 }; // the zoom, and the shift of the middle [px]
  #job = null;
  #path = new Points(); // of the job
  #paths = 0; // the number of jobs
  #layers = { job: new Layer(), drawn: new Layer(), replay: new Layer() };
  colouring = "pen"; // what the colour of strokes shows: "pen", "error" or "speed"
  replay = null; // what is shown of the last run, in place of the arm as it is
  jobBox = null; // lower left and upper right corner of what the job draws [m]
  placed = UNMOVED; // how the drawing is placed anew while it is dragged
  grabs = false; // whether a drag moves the drawing
  picks = false; // whether a click chooses where the job begins
  begins = null; // where it does [m]
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

  #down = false; // whether the tool was down

  get job() {
    return this.#job;
  }

  set job(job) {
    this.#job = job;
    this.#path = new Points();
    this.#paths += 1;
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    for (const { down, points } of job.strokes) {
      points.forEach(([x, y], i) => {
        this.#path.add([x, y], i === 0 ? -1 : Number(down));
        if (!down) return;
        box[0] = Math.min(box[0], x);
        box[1] = Math.min(box[1], y);
        box[2] = Math.max(box[2], x);
        box[3] = Math.max(box[3], y);
      });
    }
    this.jobBox = box[0] <= box[2] ? box : null;
  }

  // The middle of what the job draws [m].
  get jobMiddle() {
    const box = this.jobBox;
    return box && [0, 1].map((axis) => (box[axis] + box[axis + 2]) / 2);
  }

  // The corners of what the job draws [m], each opposite to the one two places on; none if it draws nothing.
  get jobCorners() {
    if (!this.jobBox) return [];
    const [left, low, right, high] = this.jobBox;
    return [[left, low], [right, low], [right, high], [left, high]];
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
    if (this.jobBox) this.#canvas.dataset.corner = this.pixel(this.jobCorners[2]);
    if (!state.tool) return;
    for (const [x, y, level, error, speed] of state.trail) this.#follow([x, y], level > 0, kindOf(error, speed));
    if (this.#drawn.length > DRAWN) {
      this.#drawn.keep(DRAWN / 2);
      this.#drawings += 1;
    }
  }

  #follow(point, down, kind) {
    this.#travelled.push(point);
    if (this.#travelled.length > TRAVELLED) this.#travelled.shift();
    if (down) this.#drawn.add(point, this.#down ? kind : -1);
    this.#down = down;
  }

  // Forgets what was drawn.
  forget() {
    this.#drawn = new Points();
    this.#drawings += 1;
    this.#down = false;
  }

  isInJob([x, y]) {
    const box = this.jobBox;
    const wide = 20 / this.#scale()[0];
    return box !== null && x > box[0] - wide && x < box[2] + wide && y > box[1] - wide && y < box[3] + wide;
  }

  // Zooms about a pixel, by default the middle.
  zoom(by, [x, y] = [this.#canvas.clientWidth / 2, this.#canvas.clientHeight / 2]) {
    const view = this.#view;
    const [least, greatest] = ZOOMS;
    const zoom = Math.min(greatest, Math.max(least, view.zoom * by));
    const share = zoom / view.zoom;
    const [middleX, middleY] = [this.#canvas.clientWidth / 2, this.#canvas.clientHeight / 2];
    view.x = (x - middleX) * (1 - share) + view.x * share;
    view.y = (y - middleY) * (1 - share) + view.y * share;
    view.zoom = zoom;
  }

  pan(x, y) {
    this.#view.x += x;
    this.#view.y += y;
  }

  showAll() {
    this.#view = { zoom: 1, x: 0, y: 0 };
  }

  // Shows what the job draws, as large as the canvas.
  showJob() {
    this.showAll();
    const box = this.jobBox;
    if (!box) return;
    const [scale] = this.#scale();
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    const size = Math.max((box[2] - box[0]) / width, (box[3] - box[1]) / height, 1e-6) * scale;
    this.#view.zoom = Math.min(ZOOMS[1], Math.max(1, 0.6 / size));
    const [x, y] = this.pixel([(box[0] + box[2]) / 2, (box[1] + box[3]) / 2]);
    this.pan(width / 2 - x, height / 2 - y);
  }

  // Pixels per metre, and the pixel of the origin.
  #scale() {
    const { clientWidth: width, clientHeight: height } = this.#canvas;
    const [x0, y0, x1, y1] = this.#map.box;
    const { zoom, x, y } = this.#view;
    const scale = 0.94 * zoom * Math.min(width / (x1 - x0), height / (y1 - y0));
    return [scale, width / 2 + x - (scale * (x0 + x1)) / 2, height / 2 + y + (scale * (y0 + y1)) / 2];
  }

  get pixelsPerMetre() {
    return this.#scale()[0];
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

  // Returns whether all is drawn; else the next frame draws more.
  draw() {
    const canvas = this.#canvas, context = this.#context;
    if (!canvas.clientWidth) return true;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== wide || canvas.height !== high) Object.assign(canvas, { width: wide, height: high });
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.lineCap = context.lineJoin = "round";
    this.#map.draw(context, (point) => this.pixel(point), (...line) => this.#line(...line));
    const [scale, left, top] = this.#scale();
    const view = { scale, left, top, width, height, ratio };
    const isWhole = [this.#drawJob(view), this.#drawTrail(view)].every(Boolean);
    const shown = this.replay ?? this.#state;
    if (shown?.joints) this.#drawArm(shown);
    else this.#drawHome();
    this.#drawBar(height);
    return isWhole;
  }

  // What was drawn, and the latest path of the tool; in a replay, what was drawn by then.
  #drawTrail(view) {
    const context = this.#context;
    const steps = Array.from({ length: 8 }, (_, i) => [colour(`--step${i}`), 3]);
    const pen = [colour("--drawn"), 3];
    const ink = this.colouring === "pen" ? () => pen : (kind) => steps[stepsOf(kind)[this.colouring]];
    const draw = (layer, points, count, name) => layer.draw(context, view, `${name} ${this.colouring} ${pen}`, count,
      (picture, from, to) => points.stroke(picture, view, from, to, ink));
    if (this.replay) return draw(this.#layers.replay, this.replay.points, this.replay.count, "replay");
    context.setLineDash([1, 4]);
    this.#line(this.#travelled, "--quiet", 1.5);
    context.setLineDash([]);
    return draw(this.#layers.drawn, this.#drawn, this.#drawn.length, this.#drawings);
  }

  // In four passes: travel, then strokes, each with a rim of the paper's colour.
  #drawJob(view) {
    const context = this.#context;
    const [path, casing] = [colour("--path"), colour("--casing")];
    const passes = [
      { kind: 0, ink: [casing, 1.5], dash: [2, 5], offset: 0 },
      { kind: 0, ink: [path, 1], dash: [2, 5], offset: 3.5 },
      { kind: 1, ink: [casing, 5], dash: [], offset: 0 },
      { kind: 1, ink: [path, 2], dash: [], offset: 0 },
    ];
    const { length } = this.#path;
    const paint = (layer, from, to) => passes.forEach(({ kind, ink, dash, offset }, pass) => {
      const [first, last] = [from, to].map((step) => Math.min(length, Math.max(0, step - pass * length)));
      if (first === last) return;
      layer.setLineDash(dash);
      layer.lineDashOffset = offset;
      this.#path.stroke(layer, view, first, last, (other) => (other === kind ? ink : null));
    });
    const { about, by, scale } = this.placed;
    const [x, y] = this.pixel(about);
    context.save();
    context.translate(x + view.scale * by[0], y - view.scale * by[1]);
    context.scale(scale, scale);
    context.translate(-x, -y);
    const isWhole = this.#layers.job.draw(context, view, `${this.#paths} ${path}`, passes.length * length, paint);
    context.restore();
    if (this.job?.at) this.#cross(this.job.at);
    if (this.begins) this.#dot(this.begins, "--busy", 6);
    if (this.grabs && this.jobBox) {
      const corners = this.jobCorners.map((corner) => corner.map((u, axis) => about[axis] + scale * (u - about[axis]) + by[axis]));
      context.setLineDash([6, 4]);
      this.#line([...corners, corners[0]], "--one", 2);
      context.setLineDash([]);
      context.fillStyle = colour("--one");
      for (const corner of corners) {
        const [u, v] = this.pixel(corner);
        context.fillRect(u - CORNER, v - CORNER, 2 * CORNER, 2 * CORNER);
      }
    }
    return isWhole;
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
    this.#line([a, b, c, d, e], "--casing", 10);
    this.#line([b, c, d], "--ink", 5);
    if (tool) this.#line([c, tool], "--ink", 5);
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
