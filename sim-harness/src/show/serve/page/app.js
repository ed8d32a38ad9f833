// The page: shows the server's messages, and sends what the user does as requests.
import { Connection } from "./connection.js";
import { Drawing } from "./drawing.js";
import { DragHandler } from "./drag.js";
import { WorkspaceMap } from "./map.js";
import { nextStep, put, showFault, showJob, showNotice, showNumbers, stateText, whyNot } from "./panel.js";
import { Plot } from "./plots.js";

const DEGREE = Math.PI / 180;
const SHIFT = 0.005; // m that a button moves the drawing by

// An error of a script is shown, so that a failed page is not taken for a working one.
const fail = (reason) => showNotice(`This page failed: ${reason}. Load it again.`, true);
addEventListener("error", (event) => fail(event.message));
addEventListener("unhandledrejection", (event) => fail(event.reason));

const at = (id) => document.getElementById(id);
const json = async (path) => (await fetch(path)).json();
const arm = await json("arm.json");
const map = new WorkspaceMap(await json("maps.json"));
const connection = new Connection();
const drawing = new Drawing(at("arm"), arm, map);
const drag = new DragHandler(at("arm"), drawing);
const plots = {
  error: new Plot(at("error"), ["--one"]),
  torque: new Plot(at("torque"), ["--one", "--four"]),
  current: new Plot(at("current"), ["--one", "--four"]),
};
let me = null; // this page's number
let elbows = null; // the sides of the arm's elbows
let last = null; // the last state; null without a connection
let fault = null;
let loaded = null; // the job that was loaded last
let next = null; // the control that does the next step

// Messages of the server.

connection.onMessage = (message) => {
  if (message.hello) me = message.hello;
  if (message.state) showState(message.state);
  if (message.notice && (message.notice.to ?? me) === me) showNotice(message.notice.text, message.notice.refused);
  if ("fault" in message) {
    fault = message.fault;
    showFault(fault);
  }
  if (message.job) {
    const isNew = drawing.job?.name !== message.job.name;
    drawing.job = loaded = message.job;
    at("file").value = "";
    if (isNew) {
      at("from").value = 1;
      drawing.forget();
      if (message.job.strokes.length) drawing.showJob();
    }
    showJob(message.job);
    showControls();
    redraw();
  }
};

connection.onLost = (reason) => {
  last = null;
  showStateText("offline", "No connection");
  showControls();
  if (reason) showNotice(reason, true);
};

function showStateText(state, text) {
  document.body.dataset.state = state;
  put("state", text);
  document.title = `${state} · ${at("name").textContent}`;
}

function showState(state) {
  last = state;
  const watching = state.control !== me;
  showStateText(state.state, stateText(state, watching));
  document.body.classList.toggle("watching", watching);
  showNumbers(state);
  showControls();
  if (state.elbows && String(state.elbows) !== elbows) {
    elbows = String(state.elbows);
    chooseBranch(elbows);
  }
  for (const option of at("mode").options) {
    option.disabled = state.modes !== null && !state.modes.some((mode) => String(mode) === option.value);
  }
  at("run-on").checked = state.run_on;
  if (document.activeElement !== at("feed")) at("feed").value = String(Math.round(100 * state.feed) / 100);
  const error = state.tool && state.reference
    ? 1e6 * Math.hypot(state.tool[0] - state.reference[0], state.tool[1] - state.reference[1]) : null;
  plots.error.add(state.time, [error]);
  plots.torque.add(state.time, state.torque);
  plots.current.add(state.time, state.current);
  drawing.show(state);
  redraw();
}

// The name by which `whyNot` knows a control.
function nameOf(control) {
  const { request, jog, turn, place } = control.dataset;
  if (request) return request;
  if (jog || turn) return "jog";
  return place || control.id === "grab" ? "place" : control.id;
}

const controls = [...document.querySelectorAll("#panel button")];

// Marks the controls that have no use now, and shows the next step.
function showControls() {
  for (const control of controls) {
    const disabled = whyNot(nameOf(control), last, loaded) !== null;
    if ((control.getAttribute("aria-disabled") === "true") !== disabled) control.setAttribute("aria-disabled", disabled);
  }
  const watching = last !== null && last.control !== me;
  const isControl = at("control").getAttribute("aria-disabled") === "true";
  if (isControl === watching) at("control").setAttribute("aria-disabled", !watching);
  const [advice, control, words] = nextStep(last, loaded, fault, watching);
  next = control;
  put("advice", advice);
  put("next", words);
  if ((at("next").getAttribute("aria-disabled") === "true") !== (control === null)) {
    at("next").setAttribute("aria-disabled", control === null);
  }
}

// Chooses the branch whose map is shown and to which "Change branch" leads.
function chooseBranch(branch) {
  at("mode").value = branch;
  map.choose(branch);
  redraw();
}

function showLegend() {
  at("ramp").replaceChildren(...map.legend.map((background) => {
    const step = document.createElement("i");
    step.style.background = background;
    return step;
  }));
}

// Draws once at the browser's next frame, for all changes before it.
let willDraw = false;
function redraw() {
  if (willDraw) return;
  willDraw = true;
  requestAnimationFrame(() => {
    willDraw = false;
    drawing.draw();
    for (const plot of Object.values(plots)) plot.draw();
  });
}

// Actions of the user.

function send(request) {
  showNotice("");
  if (!connection.send(request)) showNotice("Not sent: there is no connection.", true);
}

function emergencyStop() {
  if (!connection.emergencyStop()) {
    showNotice("No connection: a moving arm comes to rest, unless its job runs on. The emergency stop is "
      + "sent as soon as there is a connection.", true);
  }
}

function jog(x, y) {
  const step = Number(at("step-size").value);
  send({ jog: [x * step, y * step] });
}

function jogJoint(joint, sign) {
  send({ jog_joint: { joint, by: sign * Number(at("turn").value) * DEGREE } });
}

// Moves the drawing, and scales and turns it about its middle.
function place([x, y], scale, degrees) {
  const box = drawing.jobBox;
  if (!box) return;
  const about = [0, 1].map((axis) => (box[axis] + box[axis + 2]) / 2);
  send({ place: { about, by: [x, y], scale, turn: degrees * DEGREE } });
}

const load = (name, text) => send({ load: { name, text } });

function setGrab(on) {
  drawing.grabs = on;
  at("grab").setAttribute("aria-pressed", on);
  if (on) showNotice("Drag the drawing, or use the buttons beside “Move drawing”.");
}

const ACTIONS = {
  control: () => send("control"),
  run: () => send("run"),
  resume: () => send("resume"),
  "run-from": () => send({ run_from: Math.max(1, Math.round(Number(at("from").value))) }),
  change: () => send({ mode: at("mode").value.split(",") }),
  grab: () => setGrab(!drawing.grabs),
  demonstration: async () => {
    const answer = await fetch("demonstration.gcode");
    load("the demonstration", await answer.text());
  },
};

function zoom(how) {
  if (how === "in") drawing.zoom(1.4);
  if (how === "out") drawing.zoom(1 / 1.4);
  if (how === "job") drawing.showJob();
  if (how === "arm") drawing.showAll();
  redraw();
}

function act(button) {
  const { request, jog: direction, turn, place: where, zoom: how } = button.dataset;
  if (how) return zoom(how);
  const why = button.closest("#panel") ? whyNot(nameOf(button), last, loaded) : null;
  if (why !== null && last?.control === me) return showNotice(why.includes(". ") ? why : `Not now: ${why}.`, true);
  if (request) send({ request });
  else if (direction) jog(...direction.split(",").map(Number));
  else if (turn) jogJoint(turn.slice(0, -1), turn.endsWith("+") ? 1 : -1);
  else if (where) {
    const [x, y, scale, degrees] = where.split(",").map(Number);
    place([x * SHIFT, y * SHIFT], scale, degrees);
  } else ACTIONS[button.id]?.();
}

document.addEventListener("click", ({ target }) => {
  const button = target.closest("button");
  if (!button) return;
  if (button.id === "emergency") return emergencyStop();
  if (button.id !== "next") return act(button);
  if (next) act(document.querySelector(`[data-request="${next}"]`) ?? at(next));
});
at("run-on").onchange = () => send({ run_on: at("run-on").checked });
at("feed").onchange = () => send({ feed: Number(at("feed").value) });
at("mode").onchange = () => chooseBranch(at("mode").value);
at("map").onchange = () => {
  map.shown = at("map").checked;
  redraw();
};
at("file").onchange = async () => {
  const [file] = at("file").files;
  if (file) load(file.name, await file.text());
};

const KEYS = {
  ArrowLeft: () => jog(-1, 0),
  ArrowRight: () => jog(1, 0),
  ArrowUp: () => jog(0, 1),
  ArrowDown: () => jog(0, -1),
  "+": () => zoom("in"),
  "-": () => zoom("out"),
};
const SHIFT_KEYS = {
  ArrowLeft: () => jogJoint("theta1", 1),
  ArrowRight: () => jogJoint("theta1", -1),
  ArrowUp: () => jogJoint("theta4", 1),
  ArrowDown: () => jogJoint("theta4", -1),
  "+": KEYS["+"],
};
document.addEventListener("keydown", (event) => {
  const { key, target } = event;
  if (key === "Escape") return emergencyStop();
  if (target.closest("select, input") || event.ctrlKey || event.altKey || event.metaKey) return;
  const action = (event.shiftKey ? SHIFT_KEYS : KEYS)[key];
  if (key === " " && !target.closest("button")) send({ request: "stop" });
  else if (action) action();
  else return;
  event.preventDefault();
});

drag.onStart = () => showNotice("");
drag.onFollow = (point) => connection.send({ follow: point });
drag.onTurn = (joint, angle) => connection.send({ turn: { joint, to: angle } });
drag.onPlace = (by) => place(by, 1, 0);
drag.onView = redraw;

at("name").textContent = arm.name;
at("place").textContent = arm.place;
chooseBranch(at("mode").value);
showLegend();
showControls();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  map.paint();
  showLegend();
  redraw();
});
addEventListener("resize", () => {
  if (drawing.jobBox) drawing.showJob();
  else drawing.showAll();
  redraw();
});
connection.open();
