// The keys of the page: Space stops, arrows jog, plus and minus zoom.
import { connection } from "./emergency.js";

// Controls that move the arm or switch its motors on: they are pressed by Enter, so that Space stops there.
const MOVING = "[data-request], [data-jog], [data-turn], [data-pen], [data-macro], #lead, #frame, #run, #run-from, #resume, #change, #send, #next";

// Listens to keys. `stop` stops the arm; `keys` and `shiftKeys` have an action for each other key, and `held` gets the
// event of a key that may be held for a motion. Returns a function that mutes the keys that are down.
export function listen(stop, keys, shiftKeys, held) {
  let isHeld = false; // the Space that has stopped the arm is still down
  let isMuted = false; // an arrow that was held before the stop jogs no more
  const isSpace = ({ key, code }) => key === " " || code === "Space";

  addEventListener("keydown", (event) => {
    const { key, target, repeat, ctrlKey, altKey, metaKey, shiftKey } = event;
    const isControl = target.closest?.("button, select, input");
    if (isSpace(event)) {
      const stops = connection.mayMove || !isControl || target.closest(MOVING);
      if (!isHeld && !stops) return;
      event.preventDefault();
      if (!isHeld || !repeat) {
        isMuted = true;
        stop();
      }
      isHeld = true;
      return;
    }
    if (target.closest?.("select, input, [role=tab]") || ctrlKey || altKey || metaKey) return;
    const action = (shiftKey ? shiftKeys : keys)[key];
    if (!action) return;
    event.preventDefault();
    const isArrow = key.startsWith("Arrow");
    if (!repeat) isMuted = false;
    if (isMuted || (isArrow && repeat)) return;
    action();
    if (isArrow) held(event);
  }, true);
  // Some browsers press a button when the key is released.
  addEventListener("keyup", (event) => {
    if (!isSpace(event) || !isHeld) return;
    event.preventDefault();
    isHeld = false;
  }, true);
  addEventListener("blur", () => { isHeld = false; });
  return () => { isMuted = true; };
}
