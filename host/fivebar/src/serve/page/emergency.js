// The emergency stop of a page: the key Esc wherever the focus is, and the button. It works before the
// rest of the page is loaded, and also if that fails.
import { Connection } from "./connection.js";

const SURE = 400; // ms without a confirmation after which the page says so
const SHOWN = 4000; // ms for which a sentence is shown; that of a stop without confirmation is shown again and again

export const connection = new Connection();

let timer = 0;

// Shows a sentence that cannot be overlooked, above everything else.
export function alarm(text, kind = "alarm") {
  const place = document.getElementById("alarm");
  if (!place) return;
  clearTimeout(timer);
  place.dataset.kind = kind;
  if (place.textContent !== text) place.textContent = text;
  timer = setTimeout(() => { place.textContent = ""; }, SHOWN);
}

connection.onConfirmed = () => alarm("Emergency stop confirmed: the bridges are off.", "confirmed");
connection.onUnconfirmed = (since) => {
  if (!connection.isOpen) {
    alarm("Emergency stop NOT SENT: there is no connection. Use the switch at the arm. The stop is sent as "
      + "soon as there is a connection.");
  } else if (since > SURE) {
    alarm("Emergency stop NOT CONFIRMED: the server does not answer. Use the switch at the arm. The page "
      + "sends the stop again and again.");
  }
};

// While an input method composes a text, the key has another name.
const isEscape = ({ key, code }) => key === "Escape" || code === "Escape";

let isDown = false;
// Before all other listeners, and whatever has the focus.
addEventListener("keydown", (event) => {
  if (!isEscape(event)) return;
  event.preventDefault();
  isDown = true;
  connection.emergencyStop();
}, true);
// A list or a menu of the browser may have taken the key to close itself. If the arm moves, the stop was meant.
addEventListener("keyup", (event) => {
  if (!isEscape(event)) return;
  if (!isDown && connection.mayMove) connection.emergencyStop();
  isDown = false;
}, true);
addEventListener("blur", () => { isDown = false; });

// The button acts when it is touched. A click comes from a keyboard or a screen reader, too.
for (const kind of ["pointerdown", "click"]) {
  addEventListener(kind, ({ target }) => {
    if (target.closest?.("#emergency")) connection.emergencyStop();
  }, true);
}

// While a menu of the browser is open or something is dragged from the page, the browser keeps the keys to
// itself.
for (const kind of ["contextmenu", "dragstart"]) addEventListener(kind, (event) => event.preventDefault());

// Keys reach the page only while it has the focus.
const showFocus = () => document.documentElement.classList.toggle("without-keys", !document.hasFocus());
for (const kind of ["focus", "blur", "load"]) addEventListener(kind, showFocus);

connection.open();
