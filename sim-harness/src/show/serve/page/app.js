// The page: what the server tells becomes text and pictures, what hands do becomes wishes.
import { Connection } from "./connection.js";
import { Drawing } from "./drawing.js";
import { Hand } from "./hand.js";
import { WorkspaceMap } from "./map.js";
import { doing, showFault, showJob, showNotice, showNumbers } from "./panel.js";
import { Plot } from "./plots.js";

const DEGREE = Math.PI / 180;

// A page that fails must not look like one that works.
const fail = (reason) => showNotice(`This page failed: ${reason}. Load it again.`, true);
addEventListener("error", (event) => fail(event.message));
addEventListener("unhandledrejection", (event) => fail(event.reason));

const at = (id) => document.getElementById(id);
const json = async (path) => (await fetch(path)).json();
const arm = await json("arm.json");
const map = new WorkspaceMap(await json("maps.json"));
const connection = new Connection();
const drawing = new Drawing(at("arm"), arm, map);
const hand = new Hand(at("arm"), drawing);
const plots = {
  error: new Plot(at("error"), ["--one"]),
  torque: new Plot(at("torque"), ["--one", "--four"]),
  current: new Plot(at("current"), ["--one", "--four"]),
};
let me = null; // this page's number
let elbows = null; // where the arm's are

// What the server tells.

connection.onNews = (news) => {
  if (news.hello) me = news.hello;
  if (news.state) showState(news.state);
  if (news.notice && (news.notice.to ?? me) === me) showNotice(news.notice.text, news.notice.refused);
  if ("fault" in news) showFault(news.fault);
  if (news.job) {
    drawing.job = news.job;
    showJob(news.job);
    redraw();
  }
};

connection.onLost = () => showDoing("offline", "No connection: an arm that moves comes to rest by itself");

function showDoing(state, words) {
  document.body.dataset.state = state;
  if (at("state").textContent !== words) at("state").textContent = words;
  document.title = `${state} · ${at("name").textContent}`;
}

function showState(state) {
  const watching = state.control !== me;
  showDoing(state.state, doing(state, watching));
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

// Whose map is shown, and where "Change branch" goes.
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

// Draws at the next frame, once for all that changes before it.
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

// What hands do.

function wish(what) {
  showNotice("");
  if (!connection.send(what)) showNotice("Not sent: there is no connection.", true);
}

function emergencyStop() {
  if (!connection.emergencyStop()) {
    showNotice("No connection: an arm that moves comes to rest by itself. The emergency stop "
      + "is sent as soon as there is one.", true);
  }
}

function jog(x, y) {
  const step = Number(at("step").value);
  wish({ jog: [x * step, y * step] });
}

function jogJoint(joint, sign) {
  wish({ jog_joint: { joint, by: sign * Number(at("turn").value) * DEGREE } });
}

const load = (name, text) => wish({ load: { name, text } });

document.addEventListener("click", ({ target }) => {
  const { request, jog: direction, turn } = target.closest("button")?.dataset ?? {};
  if (request) wish({ request });
  if (direction) jog(...direction.split(",").map(Number));
  if (turn) jogJoint(turn.slice(0, -1), turn.endsWith("+") ? 1 : -1);
});
at("emergency").onclick = emergencyStop;
at("control").onclick = () => wish("control");
at("run").onclick = () => wish("run");
at("change").onclick = () => wish({ mode: at("mode").value.split(",") });
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
const SHIFTED = {
  ArrowLeft: () => jogJoint("theta1", 1),
  ArrowRight: () => jogJoint("theta1", -1),
  ArrowUp: () => jogJoint("theta4", 1),
  ArrowDown: () => jogJoint("theta4", -1),
};
document.addEventListener("keydown", (event) => {
  const { key, target } = event;
  if (key === "Escape") return emergencyStop();
  if (target.closest("select, input") || event.ctrlKey || event.altKey || event.metaKey) return;
  const act = (event.shiftKey ? SHIFTED : KEYS)[key];
  if (key === " " && !target.closest("button")) wish({ request: "stop" });
  else if (act) act();
  else return;
  event.preventDefault();
});

hand.onTake = () => showNotice("");
hand.onFollow = (point) => connection.send({ follow: point });
hand.onTurn = (joint, angle) => connection.send({ turn: { joint, to: angle } });

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
