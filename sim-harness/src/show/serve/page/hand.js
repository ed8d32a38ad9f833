// The hand on the arm: what it takes, and where it pulls it.

const GRASP = 28; // px around the tool or an elbow
const OFTEN = 40; // ms between two targets of a drag

export class Hand {
  #canvas;
  #drawing;
  #held = null; // "tool", "theta1" or "theta4"
  #sent = 0; // ms
  onTake = () => {};
  onFollow = () => {};
  onTurn = () => {};

  constructor(canvas, drawing) {
    this.#canvas = canvas;
    this.#drawing = drawing;
    canvas.addEventListener("pointerdown", (event) => this.#take(event));
    canvas.addEventListener("pointermove", (event) => this.#pull(event, false));
    canvas.addEventListener("pointerup", (event) => this.#release(event));
    canvas.addEventListener("pointercancel", () => this.#let());
  }

  #take(event) {
    const place = this.#drawing.place(event);
    const things = Object.entries(this.#drawing.handles ?? {})
      .map(([name, point]) => ({ name, distance: this.#drawing.distance(point, place) }))
      .filter(({ distance }) => distance <= GRASP)
      .sort((one, other) => one.distance - other.distance);
    if (things.length === 0) return;
    this.#held = things[0].name;
    this.#canvas.setPointerCapture(event.pointerId);
    this.onTake();
  }

  #pull(event, last) {
    if (this.#held === null) return;
    const [x, y] = this.#drawing.place(event);
    this.#drawing.target = [x, y];
    if (!last && event.timeStamp - this.#sent < OFTEN) return;
    this.#sent = event.timeStamp;
    if (this.#held === "tool") return this.onFollow([x, y]);
    const pivot = this.#held === "theta1" ? 0 : this.#drawing.base;
    return this.onTurn(this.#held, Math.atan2(y, x - pivot));
  }

  #release(event) {
    this.#pull(event, true);
    this.#let();
  }

  #let() {
    this.#held = null;
    this.#drawing.target = null;
  }
}
