// Motion while a control is held: by mouse, finger or key. The motion begins when the control has been held for a
// moment; a shorter press is a step. The control is a dead-man's switch: the motion is renewed as long as the pointer is
// down on it or the key is down, and the server stops the arm when the renewals stay out. It also ends when a modifier
// key changes, because the release of a key may then come under another name or not at all, when the focus moves, when
// the window loses it, when the page is hidden, and when the pointer leaves the control.

const PRESS = 350; // ms
const RENEW = 50; // ms, a third of the time after which the server stops the arm

// A key is known by its place on the keyboard: its name changes with the modifiers.
const keyOf = ({ code, key }) => code || key;
const MODIFIERS = [
  "Shift", "Control", "Alt", "AltGraph", "Meta", "OS", "Super", "Hyper", "Fn", "FnLock", "NumLock", "CapsLock", "ScrollLock",
];
const modifiersOf = (event) => MODIFIERS.map((name) => Number(event.getModifierState(name))).join("");

export class Hold {
  #held = null; // what is held: a pointer's number or a key
  #modifiers = null; // those of the key that is held
  #timer = 0;
  #number = null; // the number of the request that began the motion
  #wasHeld = false; // whether the last press of a pointer was no step
  #renew;
  #end;

  // `motionOf(button)` gives what begins the motion of a button and returns its number, or null; `renew` renews the
  // motion of a number; `end` ends a motion.
  constructor(motionOf, renew, end) {
    this.#renew = renew;
    this.#end = end;
    addEventListener("pointerdown", (event) => {
      this.#wasHeld = false;
      const button = event.button === 0 && event.target.closest?.("button");
      const begin = button && motionOf(button, event);
      if (begin) this.press(event.pointerId, () => { this.#wasHeld = true; return begin(); });
    });
    for (const kind of ["pointerup", "pointercancel"]) {
      addEventListener(kind, ({ pointerId }) => this.release(pointerId), true);
    }
    addEventListener("pointerout", (event) => {
      const button = event.target.closest?.("button");
      if (button && !button.contains(event.relatedTarget)) this.release(event.pointerId);
    }, true);
    // The release of the pointer was lost.
    addEventListener("pointermove", ({ pointerId, buttons }) => {
      if (buttons === 0) this.release(pointerId);
    }, true);
    addEventListener("keydown", (event) => {
      if (this.#held !== null && this.#hasChanged(event)) this.release();
      const button = event.key === "Enter" && !event.repeat && event.target.closest?.("button");
      const begin = button && motionOf(button, event);
      if (begin) this.pressKey(event, begin);
    }, true);
    addEventListener("keyup", (event) => {
      this.release(keyOf(event));
      if (this.#held !== null && this.#hasChanged(event)) this.release();
    }, true);
    // A pointer takes the focus itself.
    addEventListener("focusin", () => { if (this.#modifiers !== null) this.release(); }, true);
    addEventListener("blur", () => this.release());
    document.addEventListener("visibilitychange", () => this.release());
    // A motion has ended: the click that its release makes is no step.
    addEventListener("click", (event) => {
      if (!this.#wasHeld) return;
      this.#wasHeld = false;
      event.preventDefault();
      event.stopPropagation();
    }, true);
  }

  // Whether this is a modifier key, or others are down than when the key was pressed that is held.
  #hasChanged(event) {
    return MODIFIERS.includes(event.key) || (this.#modifiers !== null && modifiersOf(event) !== this.#modifiers);
  }

  // The key of this event is held: `begin` begins its motion.
  pressKey(event, begin) {
    this.press(keyOf(event), begin);
    this.#modifiers = modifiersOf(event);
  }

  // Something is held: `begin` begins its motion and returns its number, or false.
  press(what, begin) {
    this.release();
    this.#held = what;
    this.#timer = setTimeout(() => {
      this.#number = begin();
      if (!this.#number) return this.forget();
      this.#timer = setInterval(() => this.#renew(this.#number), RENEW);
    }, PRESS);
  }

  // It is held no more; by default, whatever is held.
  release(what = this.#held) {
    if (what !== this.#held) return;
    const moved = this.#number !== null;
    this.forget();
    if (moved) this.#end();
  }

  // The motion has ended otherwise.
  forget() {
    clearTimeout(this.#timer);
    this.#held = null;
    this.#modifiers = null;
    this.#number = null;
  }
}
