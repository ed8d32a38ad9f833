// The page: shows the server's messages, and sends what the user does as requests.
import { Connection } from "./connection.js";
import { Drawing } from "./drawing.js";
import { DragHandler } from "./drag.js";
import { WorkspaceMap } from "./map.js";
import { stateText, showFault, showJob, showNotice, showNumbers } from "./panel.js";
import { Plot } from "./plots.js";

const DEGREE = Math.PI / 180;

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

// Messages of the server.

connection.onMessage = (message) => {
  if (message.hello) me = message.hello;
  if (message.state) showState(message.state);
  if (message.notice && (message.notice.to ?? me) === me) showNotice(message.notice.text, message.notice.refused);
  if ("fault" in message) showFault(message.fault);
  if (message.job) {
    drawing.job = message.job;
    showJob(message.job);
    redraw();
  }
};

connection.onLost = (reason) => {
  showStateText("offline", "No connection: a moving arm comes to rest");
  if (reason) showNotice(reason, true);
};

function showStateText(state, text) {
  document.body.dataset.state = state;
  if (at("state").textContent !== text) at("state").textContent = text;
  document.title = `${state} · ${at("name").textContent}`;
}

function showState(state) {
  const watching = state.control !== me;
  showStateText(state.state, stateText(state, watching));
  document.body.classList.toggle("watching", watching);
  showNumbers(state);
  if (state.elbows && String(state.elbows) !== elbows) {
    elbows = String(state.elbows);
    chooseBranch(elbows);
  }
  const error = state.tool && state.reference
    ? 1e6 * Math.hypot(state.tool[0] - state.reference[0], state.tool[1] - state.reference[1]) : null;
  plots.error.add(state.time, [error]);
  plots.torque.add(state.time, state.torque);
  plots.current.add(state.time, state.current);
  drawing.show(state);
  redraw();
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
    showNotice("No connection: a moving arm comes to rest. The emergency stop is sent as soon "
      + "as there is a connection.", true);
  }
}

function jog(x, y) {
  const step = Number(at("step").value);
  send({ jog: [x * step, y * step] });
}

function jogJoint(joint, sign) {
  send({ jog_joint: { joint, by: sign * Number(at("turn").value) * DEGREE } });
}

const load = (name, text) => send({ load: { name, text } });

document.addEventListener("click", ({ target }) => {
  const { request, jog: direction, turn } = target.closest("button")?.dataset ?? {};
  if (request) send({ request });
  if (direction) jog(...direction.split(",").map(Number));
  if (turn) jogJoint(turn.slice(0, -1), turn.endsWith("+") ? 1 : -1);
});
at("emergency").onclick = emergencyStop;
at("control").onclick = () => send("control");
at("run").onclick = () => send("run");
at("change").onclick = () => send({ mode: at("mode").value.split(",") });
at("mode").onchange = () => chooseBranch(at("mode").value);
at("map").onchange = () => {
  map.shown = at("map").checked;
  redraw();
};
at("demonstration").onclick = async () => {
  const answer = await fetch("demonstration.gcode");
  load("the demonstration", await answer.text());
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
};
const SHIFT_KEYS = {
  ArrowLeft: () => jogJoint("theta1", 1),
  ArrowRight: () => jogJoint("theta1", -1),
  ArrowUp: () => jogJoint("theta4", 1),
  ArrowDown: () => jogJoint("theta4", -1),
};
document.addEventListener("keydown", (event) => {
  const { key, target } = event;
  if (key === "Escape") return emergencyStop();
  if (target.closest("select, input") || event.ctrlKey || event.altKey || event.metaKey) return;
  const act = (event.shiftKey ? SHIFT_KEYS : KEYS)[key];
  if (key === " " && !target.closest("button")) send({ request: "stop" });
  else if (act) act();
  else return;
  event.preventDefault();
});

drag.onStart = () => showNotice("");
drag.onFollow = (point) => connection.send({ follow: point });
drag.onTurn = (joint, angle) => connection.send({ turn: { joint, to: angle } });

at("name").textContent = arm.name;
at("place").textContent = arm.place;
chooseBranch(at("mode").value);
showLegend();
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  map.paint();
  showLegend();
  redraw();
});
addEventListener("resize", redraw);
connection.open();
