// Which clicks are meant. A double click, or a key that is held, must not go on from one control to
// another one that has come to its place, and so move the arm.

const PAUSE = 1000; // ms between clicks on two controls in one place
const NEAR = 40; // px

// A key that is held presses a button once.
addEventListener("keydown", (event) => {
  if (event.repeat && ["Enter", " "].includes(event.key) && event.target.closest?.("button")) event.preventDefault();
}, true);

export class ClickGuard {
  #last = { name: null, time: -PAUSE, x: 0, y: 0 };

  // Whether a click on a control is meant for it: it comes a second after the last click in its place, if
  // that was on a control with another name.
  admits(name, button, { detail, clientX: x, clientY: y }) {
    // A click from the keyboard has no place of its own.
    if (detail === 0) {
      const box = button.getBoundingClientRect();
      [x, y] = [(box.left + box.right) / 2, (box.top + box.bottom) / 2];
    }
    const last = this.#last;
    const now = performance.now();
    const isNear = Math.hypot(x - last.x, y - last.y) < NEAR;
    const isMeant = name === last.name || !isNear || now - last.time > PAUSE;
    // A click that is not meant counts for the control before, so that more of them do nothing.
    this.#last = { name: isMeant ? name : last.name, time: now, x, y };
    return isMeant;
  }
}
