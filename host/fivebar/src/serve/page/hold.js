// Motion while a control is held: by mouse, finger or key. The motion begins when the control has been held for a
// moment; a shorter press is a step. It ends when the control is released, and also when the window loses the focus,
// the page is hidden, or the pointer leaves the control.

const PRESS = 350; // ms

export class Hold {
  #held = null; // what is held: a pointer's number or a key
  #timer = 0;
  #moves = false;
  #wasHeld = false; // whether the last press of a pointer was no step
  #end;

  // `motionOf(button)` gives what begins the motion of a button, or null; `end` ends a motion.
  constructor(motionOf, end) {
    this.#end = end;
    addEventListener("pointerdown", (event) => {
      this.#wasHeld = false;
      const button = event.button === 0 && event.target.closest?.("button");
      const begin = button && motionOf(button, event);
      if (begin) this.press(event.pointerId, () => { this.#wasHeld = true; begin(); });
    });
    for (const kind of ["pointerup", "pointercancel"]) {
      addEventListener(kind, ({ pointerId }) => this.release(pointerId), true);
    }
    addEventListener("pointerout", (event) => {
      const button = event.target.closest?.("button");
      if (button && !button.contains(event.relatedTarget)) this.release(event.pointerId);
    }, true);
    addEventListener("keydown", (event) => {
      const button = event.key === "Enter" && !event.repeat && event.target.closest?.("button");
      const begin = button && motionOf(button, event);
      if (begin) this.press("Enter", begin);
    });
    addEventListener("keyup", ({ key }) => this.release(key), true);
    addEventListener("blur", () => this.release());
    addEventListener("visibilitychange", () => this.release());
    // A motion has ended: the click that its release makes is no step.
    addEventListener("click", (event) => {
      if (!this.#wasHeld) return;
      this.#wasHeld = false;
      event.preventDefault();
      event.stopPropagation();
    }, true);
  }

  // Something is held: `begin` begins its motion.
  press(what, begin) {
    this.release();
    this.#held = what;
    this.#timer = setTimeout(() => { this.#moves = true; begin(); }, PRESS);
  }

  // It is held no more; by default, whatever is held.
  release(what = this.#held) {
    if (what !== this.#held) return;
    const moved = this.#moves;
    this.forget();
    if (moved) this.#end();
  }

  // The motion has ended otherwise.
  forget() {
    clearTimeout(this.#timer);
    this.#held = null;
    this.#moves = false;
  }
}
