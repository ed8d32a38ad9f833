// The guided page of a commissioning: it shows the state that the server has, and sends clicks.
import { ClickGuard } from "./clicks.js";
import { connection } from "./emergency.js";

const part = (id) => document.getElementById(id);
const clicks = new ClickGuard();
let shown = "";

async function send(what, body = "") {
  try {
    const answer = await fetch(what, { method: "POST", body });
    if (!answer.ok) trouble(await answer.text());
  } catch {
    trouble("The click did not reach the server: click again.");
  }
}

function trouble(text) {
  part("trouble").textContent = text ?? "";
  part("trouble").hidden = !text;
}

function offline() {
  document.body.dataset.state = "offline";
  part("state").textContent = "offline: use the switch at the arm";
  shown = "";
}

// Whether a step was done, with the way to do it again.
function entry(step, state) {
  const line = document.createElement("li");
  line.append(step.name);
  if (step.name === (state.running ?? state.next)) line.setAttribute("aria-current", "step");
  const found = document.createElement("span");
  found.className = "found";
  found.textContent = step.found ? `${step.sign} ${step.date}: ${step.found}` : step.does;
  line.append(found);
  if (step.found && !state.running) {
    const again = document.createElement("button");
    again.type = "button";
    again.textContent = `Repeat from ${step.name}`;
    again.addEventListener("click", () => send("again", step.name));
    line.append(again);
  }
  return line;
}

function show(state) {
  const name = state.running ?? state.next;
  const step = state.steps.find((other) => other.name === name);
  const word = state.running ? "Running" : state.stopped ? "Fault" : name ? "Stopped" : "Done";
  document.body.dataset.state = word === "Done" ? "Armed" : word;
  part("state").textContent = state.running ? `doing ${name}` : state.stopped ? "stopped" : name ? "waiting" : "finished";
  part("now").textContent = !name ? "All steps are done" : `${state.running ? "Now" : "Next"}: ${name}`;
  part("does").textContent = step ? `It ${step.does}.` : "";
  part("begin").hidden = Boolean(state.running) || state.stopped || !name;
  part("begin").dataset.step = name ?? "";
  part("begin").textContent = name ? `Start ${name}` : "";
  part("safe").hidden = !state.stopped;
  trouble(state.trouble);
  part("task").hidden = !state.task;
  part("ask").textContent = state.task ? state.task.text.replace(/[^?]$/, "$&.") : "";
  const answers = state.task?.answers ?? [];
  part("done").hidden = answers.length > 0;
  part("answers").replaceChildren(...answers.map((text, index) => {
    const button = document.createElement("button");
    button.type = "button";
    button.dataset.answer = index;
    button.textContent = text;
    return button;
  }));
  part("all").hidden = !state.task?.simulated;
  part("place").textContent = state.place;
  part("lines").replaceChildren(...state.lines.map((text) => {
    const line = document.createElement("li");
    line.textContent = text;
    return line;
  }));
  part("steps").replaceChildren(...state.steps.map((each) => entry(each, state)));
}

connection.deliver(({ guide }) => {
  if (!guide) return;
  // Unchanged parts keep the focus.
  const text = JSON.stringify(guide);
  if (text !== shown) show(guide);
  shown = text;
}, offline);

// Clicks on what moves the arm, and on what is in its place before.
const actions = {
  begin: (button) => send("begin", button.dataset.step),
  done: () => send("done"),
  all: () => send("done", "all"),
  safe: () => send("safe"),
};
addEventListener("click", (event) => {
  const button = event.target.closest("button");
  if (!button) return;
  if (!clicks.admits(button.id || button.textContent, button, event)) return;
  if (button.dataset.answer) send("answer", button.dataset.answer);
  else actions[button.id]?.(button);
});
