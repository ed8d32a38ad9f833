// Drags the tool, an elbow, the drawing, one of its corners or the view with one pointer; zooms with two or the wheel.
import { UNMOVED } from "./drawing.js";

const GRAB_RADIUS = 28; // px around the tool or an elbow
const INTERVAL = 40; // ms between two targets of a drag

export class DragHandler {
  #canvas;
  #drawing;
  #held = null; // "tool", "theta1", "theta4", "job", "corner", "pick" or "view"
  #pivot = null; // the corner opposite to the one that is dragged [m]
  #sent = 0; // ms
  #from = null; // where the drag of drawing or view began [m], [px]
  #pointers = new Map(); // pixels of the pointers that are down
  onStart = () => {};
  onFollow = () => {};
  onTurn = () => {};
  onPlace = () => {};
  onPick = () => {};
  onView = () => {};

  constructor(canvas, drawing) {
    this.#canvas = canvas;
    this.#drawing = drawing;
    canvas.addEventListener("pointerdown", (event) => this.#start(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event, false));
    canvas.addEventListener("pointerup", (event) => this.#finish(event));
    canvas.addEventListener("pointercancel", (event) => this.#cancel(event));
    // With Ctrl, or on the focused canvas: else the wheel scrolls the page.
    canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && document.activeElement !== canvas) return;
      event.preventDefault();
      drawing.zoom(Math.exp(-0.002 * event.deltaY), this.#pixel(event));
      this.onView();
    }, { passive: false });
    // A finger on nothing that can be dragged scrolls the page.
    canvas.addEventListener("touchstart", (event) => {
      if (event.touches.length > 1 || this.#grabs(event.touches[0]) !== "view") event.preventDefault();
    }, { passive: false });
  }

  #pixel({ clientX, clientY }) {
    const corner = this.#canvas.getBoundingClientRect();
    return [clientX - corner.left, clientY - corner.top];
  }

  // What a pointer grabs.
  #grabs(event) {
    const drawing = this.#drawing;
    const position = drawing.position(event);
    const candidates = Object.entries(drawing.handles ?? {})
      .map(([name, point]) => ({ name, distance: drawing.distance(point, position) }))
      .filter(({ distance }) => distance <= GRAB_RADIUS)
      .sort((one, other) => one.distance - other.distance);
    if (drawing.picks) return "pick";
    if (drawing.grabs) {
      const corners = drawing.jobCorners;
      const corner = corners.findIndex((corner) => drawing.distance(corner, position) <= GRAB_RADIUS / 2);
      this.#pivot = corners[(corner + 2) % 4] ?? null;
      if (corner >= 0) return "corner";
      if (drawing.isInJob(position)) return "job";
    }
    return candidates[0]?.name ?? "view";
  }

  #start(event) {
    this.#pointers.set(event.pointerId, this.#pixel(event));
    if (this.#pointers.size > 1) {
      this.#held = "view";
      return;
    }
    this.#held = this.#grabs(event);
    if (this.#held === "view" && event.pointerType === "touch") {
      this.#held = null;
      return;
    }
    this.#from = this.#held === "view" ? this.#pixel(event) : this.#drawing.position(event);
    this.#canvas.setPointerCapture(event.pointerId);
    if (this.#held !== "view") this.onStart();
  }

  #move(event, last) {
    const before = this.#pointers.get(event.pointerId);
    if (!before || this.#held === null) return;
    const now = this.#pixel(event);
    this.#pointers.set(event.pointerId, now);
    const drawing = this.#drawing;
    if (this.#held === "view") {
      const other = [...this.#pointers].find(([id]) => id !== event.pointerId)?.[1];
      const apart = (pixel) => Math.hypot(pixel[0] - other[0], pixel[1] - other[1]);
      if (other) drawing.zoom(apart(now) / Math.max(1, apart(before)), other);
      else drawing.pan(now[0] - before[0], now[1] - before[1]);
      this.onView();
      return;
    }
    if (this.#held === "pick") return;
    const [x, y] = drawing.position(event);
    if (this.#held === "job") {
      drawing.placed = { ...UNMOVED, by: [x - this.#from[0], y - this.#from[1]] };
      this.onView();
      return;
    }
    if (this.#held === "corner") {
      const apart = ([u, v]) => Math.hypot(u - this.#pivot[0], v - this.#pivot[1]);
      const scale = Math.max(0.02, apart([x, y]) / Math.max(1e-6, apart(this.#from)));
      drawing.placed = { ...UNMOVED, about: this.#pivot, scale };
      this.onView();
      return;
    }
    drawing.target = [x, y];
    if (!last && event.timeStamp - this.#sent < INTERVAL) return;
    this.#sent = event.timeStamp;
    if (this.#held === "tool") this.onFollow([x, y]);
    else this.onTurn(this.#held, Math.atan2(y, x - (this.#held === "theta1" ? 0 : drawing.base)));
  }

  // Lets go of the arm, after a stop.
  releaseArm() {
    if (!["view", "job", "corner"].includes(this.#held)) this.#release();
  }

  #release() {
    this.#held = null;
    this.#drawing.target = null;
    this.#drawing.placed = UNMOVED;
  }

  #finish(event) {
    this.#move(event, true);
    if (this.#held === "pick") this.onPick(this.#drawing.position(event));
    if (this.#held === "job" || this.#held === "corner") this.onPlace(this.#drawing.placed);
    this.#cancel(event);
  }

  #cancel(event) {
    this.#pointers.delete(event.pointerId);
    if (this.#pointers.size === 0 || this.#held !== "view") this.#release();
  }
}
