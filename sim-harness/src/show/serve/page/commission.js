// The guided page of a commissioning: it shows the state that the server has, and sends clicks.
"use strict";

const part = (id) => document.getElementById(id);
let shown = "";

async function send(what, body = "") {
  try {
    const answer = await fetch(what, { method: "POST", body });
    if (!answer.ok) trouble(await answer.text());
  } catch {
    offline();
  }
  look();
}

function trouble(text) {
  part("trouble").textContent = text ?? "";
  part("trouble").hidden = !text;
}

function offline() {
  document.body.dataset.state = "offline";
  part("state").textContent = "offline: use the switch at the arm";
}

// Whether a step was done, with the way to do it again.
function entry(step, state) {
  const line = document.createElement("li");
  line.append(step.name);
  if (step.name === (state.running ?? state.next)) line.setAttribute("aria-current", "step");
  const found = document.createElement("span");
  found.className = "found";
  found.textContent = step.found ? `✓ ${step.date}: ${step.found}` : step.does;
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
  const word = state.running ? "Running" : name ? "Stopped" : "Done";
  document.body.dataset.state = word === "Done" ? "Armed" : word;
  part("state").textContent = state.running ? `doing ${name}` : name ? "waiting" : "finished";
  part("now").textContent = !name ? "All steps are done" : `${state.running ? "Now" : "Next"}: ${name}`;
  part("does").textContent = step ? `It ${step.does}.` : "";
  part("begin").hidden = Boolean(state.running) || !name;
  part("begin").dataset.step = name ?? "";
  part("begin").textContent = name ? `Start ${name}` : "";
  trouble(state.trouble);
  part("task").hidden = !state.task;
  part("ask").textContent = state.task ? `${state.task.text}.` : "";
  part("all").hidden = !state.task?.simulated;
  part("place").textContent = state.place;
  part("lines").replaceChildren(...state.lines.map((text) => {
    const line = document.createElement("li");
    line.textContent = text;
    return line;
  }));
  part("steps").replaceChildren(...state.steps.map((each) => entry(each, state)));
}

async function look() {
  try {
    const answer = await fetch("state.json");
    const text = await answer.text();
    if (!answer.ok) throw new Error(text);
    // Unchanged parts keep the focus.
    if (text !== shown || document.body.dataset.state === "offline") show(JSON.parse(text));
    shown = text;
  } catch {
    offline();
    shown = "";
  }
}

part("begin").addEventListener("click", (event) => send("begin", event.target.dataset.step));
part("done").addEventListener("click", () => send("done"));
part("all").addEventListener("click", () => send("done", "all"));
part("emergency").addEventListener("click", () => send("stop"));
document.addEventListener("keydown", (event) => {
  if (event.key === "Escape") send("stop");
});
setInterval(look, 200);
look();
