// Shows the last run again: a slider over its time, and a button that lets the time pass.
import { isMoving } from "./connection.js";
import { put } from "./panel.js";

const MOVED = 2e-4; // m: a tool farther from where it was when the replay began has moved
const at = (id) => document.getElementById(id);

export class Replay {
  #recording;
  #drawing;
  #redraw;
  #index = null; // of the state that is shown; null: the arm as it is
  #timer = 0;
  #tool = null; // where the real tool was when the replay began

  constructor(recording, drawing, redraw) {
    [this.#recording, this.#drawing, this.#redraw] = [recording, drawing, redraw];
    at("replay").oninput = () => {
      this.#pause();
      this.#show(Number(at("replay").value));
    };
  }

  // The real arm is shown as soon as it moves, or has moved between two states.
  follow(state) {
    if (this.#index !== null) {
      const tool = state.tool ?? this.#tool;
      this.#tool ??= tool;
      const moved = tool && Math.hypot(tool[0] - this.#tool[0], tool[1] - this.#tool[1]) > MOVED;
      if (moved || isMoving(state)) this.end();
    }
    const last = String(Math.max(0, this.#recording.length - 1));
    if (this.#index === null && at("replay").max !== last) {
      at("replay").max = at("replay").value = last;
      this.#say();
    }
  }

  play() {
    if (!this.#recording.length) return;
    if (this.#timer) return this.#pause();
    const last = this.#recording.length - 1;
    const from = this.#index === null || this.#index >= last ? 0 : this.#index;
    const [begun, before] = [performance.now(), this.#recording.at(from).since];
    this.#show(from);
    put("play", "Pause");
    this.#timer = setInterval(() => {
      const index = this.#recording.indexAt(before + (performance.now() - begun) / 1000);
      this.#show(index);
      if (index >= last) this.#pause();
    }, 33);
  }

  end() {
    this.#pause();
    this.#index = this.#tool = null;
    this.#drawing.replay = null;
    at("replay").value = at("replay").max;
    this.#say();
    this.#redraw();
  }

  #pause() {
    clearInterval(this.#timer);
    this.#timer = 0;
    put("play", "Replay");
  }

  #show(index) {
    if (!this.#recording.length) return;
    this.#index = index;
    this.#drawing.replay = this.#recording.at(index);
    at("replay").value = index;
    this.#say();
    this.#redraw();
  }

  #say() {
    const { length } = this.#recording;
    const seconds = (index) => this.#recording.at(index).since.toFixed(1);
    const text = !length ? "no run yet" : this.#index === null ? `${seconds(length - 1)} s` : `${seconds(this.#index)} of ${seconds(length - 1)} s`;
    put("replay-value", text);
    if (at("replay").ariaValueText !== text) at("replay").ariaValueText = text;
    at("replaying").hidden = this.#index === null;
  }
}
