// Drags the tool or an elbow with the pointer.

const GRAB_RADIUS = 28; // px around the tool or an elbow
const INTERVAL = 40; // ms between two targets of a drag

export class DragHandler {
  #canvas;
  #drawing;
  #held = null; // "tool", "theta1" or "theta4"
  #sent = 0; // ms
  onStart = () => {};
  onFollow = () => {};
  onTurn = () => {};

  constructor(canvas, drawing) {
    this.#canvas = canvas;
    this.#drawing = drawing;
    canvas.addEventListener("pointerdown", (event) => this.#start(event));
    canvas.addEventListener("pointermove", (event) => this.#move(event, false));
    canvas.addEventListener("pointerup", (event) => this.#finish(event));
    canvas.addEventListener("pointercancel", () => this.#cancel());
  }

  #start(event) {
    const position = this.#drawing.position(event);
    const candidates = Object.entries(this.#drawing.handles ?? {})
      .map(([name, point]) => ({ name, distance: this.#drawing.distance(point, position) }))
      .filter(({ distance }) => distance <= GRAB_RADIUS)
      .sort((one, other) => one.distance - other.distance);
    if (candidates.length === 0) return;
    this.#held = candidates[0].name;
    this.#canvas.setPointerCapture(event.pointerId);
    this.onStart();
  }

  #move(event, last) {
    if (this.#held === null) return;
    const [x, y] = this.#drawing.position(event);
    this.#drawing.target = [x, y];
    if (!last && event.timeStamp - this.#sent < INTERVAL) return;
    this.#sent = event.timeStamp;
    if (this.#held === "tool") return this.onFollow([x, y]);
    const pivot = this.#held === "theta1" ? 0 : this.#drawing.base;
    return this.onTurn(this.#held, Math.atan2(y, x - pivot));
  }

  #finish(event) {
    this.#move(event, true);
    this.#cancel();
  }

  #cancel() {
    this.#held = null;
    this.#drawing.target = null;
  }
}
