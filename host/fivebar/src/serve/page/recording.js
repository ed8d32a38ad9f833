// The last run of a job, to be shown again: the arm at each state, and what the tool drew.
import { Points } from "./layers.js";

const STATES = 110000; // an hour of states
const SAMPLES = 400000;
const BOUNDS = [5, 10, 20, 50, 100, 200, 500]; // µm of error, mm/s of speed

// The step of a value among eight.
const step = (value) => { const at = BOUNDS.findIndex((bound) => value < bound); return at < 0 ? BOUNDS.length : at; };

// A kind of points that has the steps of error [m] and speed [m/s], and both steps of a kind.
export const kindOf = (error, speed) => 8 * step(1e6 * error) + step(1e3 * speed);
export const stepsOf = (kind) => ({ error: kind >> 3, speed: kind & 7 });
export const LABELS = ["0", ...BOUNDS.map(String)];

export class Recording {
  #states = [];
  #points = new Points();
  #values = []; // error [m] and speed [m/s] of each point
  #isDown = false;
  #ran = false;
  #wasHeld = false;

  get length() {
    return this.#states.length;
  }

  // Follows the states of the server: it records while a job runs, and begins anew with a new run.
  follow(state) {
    const runs = state.left !== null;
    if (runs && !this.#ran && !this.#wasHeld) {
      this.#states = [];
      this.#points = new Points();
      this.#values = [];
      this.#isDown = false;
    }
    this.#ran = runs;
    this.#wasHeld = state.held !== null && !runs;
    if (!runs || !state.joints || !state.tool) return;
    if (this.#states.length >= STATES || this.#points.length >= SAMPLES) return;
    for (const [x, y, level, error, speed] of state.trail) {
      if (level > 0) {
        this.#points.add([x, y], this.#isDown ? kindOf(error, speed) : -1);
        this.#values.push([error, speed]);
      }
      this.#isDown = level > 0;
    }
    const { time, joints, tool, reference } = state;
    // The last points come with a state that has no line any more.
    const line = state.tag ?? this.#states.at(-1)?.line ?? null;
    this.#states.push({ time, joints, tool, reference, line, count: this.#points.length });
  }

  // What was seen at the drawn point that is nearest to a place [m]; null if none is within `radius` [m].
  nearest(place, radius) {
    const index = this.#points.nearest(place, radius);
    if (index === null) return null;
    const state = this.#states[this.#firstState((it) => it.count > index)];
    const [error, speed] = this.#values[index];
    return { error, speed, line: state.line, since: state.time - this.#states[0].time };
  }

  // The number of the first state of which this holds, as it does of all that follow; or of the last state.
  #firstState(holds) {
    let [low, high] = [0, this.length - 1];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (holds(this.#states[middle])) high = middle;
      else low = middle + 1;
    }
    return low;
  }

  // The arm at a number of states from the beginning, what it has drawn by then, and the time since the beginning.
  at(index) {
    const state = this.#states[Math.min(index, this.length - 1)];
    return { ...state, points: this.#points, since: state.time - this.#states[0].time };
  }

  // The number of the last state not after a time since the beginning [s].
  indexAt(since) {
    const wanted = this.#states[0].time + since;
    const later = this.#firstState((state) => state.time > wanted);
    return this.#states[later].time > wanted ? Math.max(0, later - 1) : later;
  }
}
