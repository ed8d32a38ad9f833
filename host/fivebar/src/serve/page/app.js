// The page: shows the server's messages, and sends what the user does as requests.
import { ClickGuard } from "./clicks.js";
import { colour } from "./colour.js";
import { Console } from "./console.js";
import { Drawing } from "./drawing.js";
import { DragHandler } from "./drag.js";
import { Drives } from "./drives.js";
import { alarm, connection } from "./emergency.js";
import { listenToFiles } from "./files.js";
import { Hold } from "./hold.js";
import { Inspect } from "./inspect.js";
import { listen } from "./keys.js";
import { WorkspaceMap } from "./map.js";
import { showMacros } from "./macros.js";
import { nextStep, put, showFault, showJob, showNotice, showNumbers, stateText, whyNot } from "./panel.js";
import { PenHeights } from "./pen.js";
import { PlacementFields } from "./placement.js";
import { Plot } from "./plots.js";
import { listenToReading, showReading } from "./reading.js";
import { LABELS, Recording } from "./recording.js";
import { Replay } from "./replay.js";
import { listenToTabs, show as showTabOf } from "./tabs.js";

const DEGREE = Math.PI / 180;
const SHIFT = 0.005; // m that a button moves the drawing by
const STEPS = [0.0001, 0.001, 0.005, 0.02]; // m
const TURNS = [0.1, 1, 5, 20]; // degrees
const STEPS_A_SECOND = 10; // of a control that is held
const PAUSE = 1000; // ms for which the button of the next step does nothing after it has changed

// An error of a script is shown, so that a failed page is not taken for a working one.
const fail = (reason) => showNotice(`This page failed: ${reason}. Load it again.`, true);
addEventListener("error", (event) => fail(event.message));
addEventListener("unhandledrejection", (event) => fail(event.reason));

const at = (id) => document.getElementById(id);
const json = async (path) => (await fetch(path)).json();
const arm = await json("arm.json");
const map = new WorkspaceMap(await json("maps.json"));
const drawing = new Drawing(at("arm"), arm, map);
const drag = new DragHandler(at("arm"), drawing);
const plots = {
  error: new Plot(at("error"), "error [µm]", ["error"], ["--one"]),
  torque: new Plot(at("torque"), "torque [N·m]", ["joint 1", "joint 4"], ["--one", "--four"]),
};
const drives = new Drives(arm.drives);
const recording = new Recording();
const replay = new Replay(recording, drawing, redraw);
new Inspect(at("arm"), drawing, recording, at("under"));
const placement = new PlacementFields(place);
const penHeights = new PenHeights((pen, width) => send({ pen_height: { pen, width } }));
showMacros(arm.macros);
let me = null; // this page's number
let elbows = null; // the sides of the arm's elbows
let chosen = null; // the branch whose map is shown
let last = null; // the last state; null without a connection
let hadConsole = false; // whether this page's console was in control
let fault = null;
let loaded = null; // the job that was loaded last
let next = null; // the control that does the next step
let marked = null; // the control that is marked, because the next step has its own place
let nextBefore = null; // the one before
let stateBefore; // the arm's state when the next step was shown last
let nextSince = -PAUSE; // when it changed [ms]
const clicks = new ClickGuard();
const NOT_MEANT = "Not done, because a click in this place has just done something else. Look at the arm, then click again.";

// Messages of the server.

function receive(message) {
  if (message.hello) me = message.hello;
  if (message.stopped) {
    drag.releaseArm();
    muteKeys();
    hold.forget();
  }
  if (message.state) showState(message.state);
  if (message.notice && (message.notice.to ?? me) === me) showNotice(message.notice.text, message.notice.refused);
  if (message.line?.to === me) showLine(message.line);
  if (message.console?.to === me) terminal.answer(message.console.text);
  if ("fault" in message) {
    fault = message.fault;
    showFault(fault, arm.shows);
  }
  if (message.job) {
    const isNew = drawing.job?.name !== message.job.name;
    drawing.job = loaded = message.job;
    drawing.begins = null;
    at("file").value = "";
    if (isNew) {
      at("from").value = 1;
      drawing.forget();
      if (message.job.strokes.length) {
        setMap(false);
        drawing.showJob();
      }
    }
    showJob(message.job, drawing.jobBox);
    placement.show(drawing.jobBox, message.job.turn);
    showReading(message.job.reading);
    showControls();
    redraw();
  }
}

function lose(reason) {
  last = null;
  hold.forget();
  showStateText("offline", "No connection");
  showControls();
  if (reason) showNotice(reason, true);
}

function showStateText(state, text) {
  document.body.dataset.state = state;
  put("state", text);
  document.title = `${state} · ${at("name").textContent}`;
}

function showState(state) {
  last = state;
  if (hadConsole && state.console !== me) terminal.answer("[The console has ended: G91, G92 and F are forgotten.]");
  hadConsole = state.console === me;
  // This page's own console gives way to what the page asks for.
  if (state.console === me) state.sender = false;
  const watching = state.control !== me;
  showStateText(state.state, stateText(state, watching));
  document.body.classList.toggle("watching", watching);
  showNumbers(state, me);
  penHeights.show(state.pen);
  showControls();
  if (state.elbows && String(state.elbows) !== elbows) {
    elbows = String(state.elbows);
    chooseBranch(elbows);
  }
  for (const button of modes) {
    const isOut = state.modes !== null && !state.modes.some((mode) => String(mode) === button.dataset.mode);
    if (button.classList.contains("out") !== isOut) button.classList.toggle("out", isOut);
  }
  at("run-on").checked = state.run_on;
  if (document.activeElement !== at("feed")) {
    at("feed").value = String(Math.round(100 * state.feed));
    showSliders();
  }
  const error = state.tool && state.reference
    ? 1e6 * Math.hypot(state.tool[0] - state.reference[0], state.tool[1] - state.reference[1]) : null;
  plots.error.add(state.time, [error]);
  plots.torque.add(state.time, state.torque);
  drives.show(state);
  drawing.show(state);
  recording.follow(state);
  replay.follow(state);
  redraw();
}

// The name by which `whyNot` knows a control.
function nameOf(control) {
  const { request, jog, turn, place, pen, macro } = control.dataset;
  if (request) return request;
  if (jog || turn) return "jog";
  if (pen) return "pen";
  if (macro) return "macro";
  return place || ["grab", "fit", "pick"].includes(control.id) ? "place" : control.id;
}

// The controls that move the arm, or power its motors.
const MOVING = ["home", "arm", "clear_fault", "control", "frame", "run", "run-from", "resume", "jog", "pen", "lead", "macro", "change", "send"];
const controls = [...document.querySelectorAll("#panel button:not([data-mode])")];
const modes = [...document.querySelectorAll("[data-mode]")];
const controlOf = (name) => document.querySelector(`[data-request="${name}"]`) ?? at(name);

// Marks the controls that have no use now, and shows the next step.
function showControls() {
  for (const control of controls) {
    const disabled = whyNot(nameOf(control), last, loaded) !== null;
    if ((control.getAttribute("aria-disabled") === "true") !== disabled) control.setAttribute("aria-disabled", disabled);
  }
  const watching = last !== null && last.control !== me;
  const isControl = at("control").getAttribute("aria-disabled") === "true";
  if (isControl === watching) at("control").setAttribute("aria-disabled", !watching);
  const [advice, control, words, elsewhere] = nextStep(last, loaded, fault, watching);
  marked = elsewhere ? controlOf(elsewhere) : null;
  const [was, is] = [stateBefore, last?.state];
  stateBefore = is;
  // The way out of a fault, and back to a job that waits.
  if (marked && is !== was && (is === "Fault" || was === "Stopped")) showTabOf(marked);
  if (control !== next) [next, nextBefore, nextSince] = [control, next, performance.now()];
  put("advice", advice);
  put("next", words);
  for (const other of controls) {
    if (other.classList.contains("marked") !== (other === marked)) other.classList.toggle("marked");
  }
  const isUseless = (control ?? marked) === null || isFresh();
  if ((at("next").getAttribute("aria-disabled") === "true") !== isUseless) at("next").setAttribute("aria-disabled", isUseless);
}

// Whether the button of the next step has changed a moment ago, so that a click may be meant for the one before.
const isFresh = () => next !== "stop" && performance.now() - nextSince < PAUSE;

// Chooses the branch whose map is shown and to which "Change branch" leads.
function chooseBranch(branch) {
  chosen = branch;
  for (const button of modes) button.setAttribute("aria-pressed", button.dataset.mode === branch);
  map.choose(branch);
  redraw();
}

// Shows or hides the map of the workspace. It is off while a job is loaded, unless the user wants it.
function setMap(on) {
  map.shown = at("map").checked = on;
  at("legend").hidden = !on;
  redraw();
}

// Colours the strokes by error or speed, or with one colour.
function setColouring(how) {
  drawing.colouring = how;
  for (const button of document.querySelectorAll("[data-colouring]")) {
    button.setAttribute("aria-pressed", button.dataset.colouring === how);
  }
  at("scale").hidden = how === "pen";
  put("scale-name", how === "error" ? "tip error from [µm]" : "speed from [mm/s]");
  showLegend();
  redraw();
}

function showLegend() {
  at("steps").replaceChildren(...LABELS.map((label, i) => {
    const step = document.createElement("span");
    step.textContent = label;
    step.style.borderColor = colour(`--step${i}`);
    return step;
  }));
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
    if (!drawing.draw()) redraw();
    for (const plot of Object.values(plots)) plot.draw();
    drives.draw();
  });
}

// Actions of the user.

// Sends a request; returns its number, or false.
function send(request) {
  showNotice("");
  const number = connection.send(request);
  if (!number) showNotice("Not sent: there is no connection.", true);
  return number;
}

// Stops on the path, whatever this page last received about the arm. The hand lets go of what it drags.
function stop() {
  drag.releaseArm();
  hold.forget();
  showNotice("");
  if (!connection.send({ request: "stop" })) {
    alarm("Stop NOT SENT: there is no connection. Use the switch at the arm.");
  }
}

function jog(x, y) {
  const step = STEPS[at("step-size").value];
  send({ jog: [x * step, y * step] });
}

function jogJoint(joint, sign) {
  send({ jog_joint: { joint, by: sign * TURNS[at("turn").value] * DEGREE } });
}

// The steps of an arrow, and the joint and the sign of a turning arrow.
const stepsOf = (direction) => direction.split(",").map(Number);
const turnOf = (turn) => [turn.slice(0, -1), turn.endsWith("+") ? 1 : -1];

function holdTool(x, y) {
  const speed = STEPS_A_SECOND * STEPS[at("step-size").value];
  return send({ hold: [x * speed, y * speed] });
}

function holdJoint(joint, sign) {
  return send({ hold_joint: { joint, rate: sign * STEPS_A_SECOND * TURNS[at("turn").value] * DEGREE } });
}

// What begins the motion of a button while it is held; null: it has none now.
function motionOf(button, event) {
  const { jog: direction, turn } = button.dataset;
  if (!direction && !turn) return null;
  if (whyNot("jog", last, loaded) !== null || last.control !== me) return null;
  return () => {
    if (clicks.admits("jog", button, event)) {
      return direction ? holdTool(...stepsOf(direction)) : holdJoint(...turnOf(turn));
    }
    showNotice(NOT_MEANT, true);
    return false;
  };
}

const hold = new Hold(motionOf, (number) => connection.renew(number), stop);

const terminal = new Console((line) => {
  const why = whyNot("send", last, loaded);
  if (last?.control !== me && last) showNotice("This page watches: take control first.", true);
  else if (why !== null) showNotice(`Not now: ${why}.`, true);
  else send({ console: line });
  return why === null && last.control === me;
});

// Moves the drawing, and scales and turns it about its middle.
function place(about, by, scale, degrees) {
  send({ place: { about, by, scale, turn: degrees * DEGREE } });
}

const load = (name, text) => send({ load: { name, text } });

function setGrab(on) {
  drawing.grabs = on;
  at("grab").setAttribute("aria-pressed", on);
  if (on) showNotice("Drag the drawing, or a corner to scale it; or use the buttons and fields below “Move drawing”.");
}

// The next click on the drawing chooses the line at which the job begins.
function setPick(on) {
  drawing.picks = on;
  at("pick").setAttribute("aria-pressed", on);
  if (on) showNotice("Click on the drawing, where the job shall begin.");
}

function showLine({ line, at: place }) {
  setPick(false);
  at("from").value = line;
  drawing.begins = place;
  showNotice(`The job can begin at line ${line}, at the mark: press “Run from line”.`);
  redraw();
}

const ACTIONS = {
  control: () => send("control"),
  run: () => send("run"),
  resume: () => send("resume"),
  "run-from": () => send({ run_from: Math.max(1, Math.round(Number(at("from").value))) }),
  change: () => send({ mode: chosen.split(",") }),
  send: () => terminal.send(),
  play: () => replay.play(),
  live: () => replay.end(),
  fit: () => {
    send("fit");
    showNotice("The greatest scale is searched for …");
  },
  grab: () => setGrab(!drawing.grabs),
  frame: () => send("frame"),
  lead: () => send({ teach: last.state !== "Compliant" }),
  pick: () => setPick(!drawing.picks),
  "keep-pen": () => send("keep_pen"),
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

function act(button, event) {
  const { request, jog: direction, turn, pen, macro, place: where, zoom: how, mode, colouring } = button.dataset;
  const name = nameOf(button);
  const isMeant = clicks.admits(name, button, event);
  // What this page last received keeps no stop back.
  if (request === "stop") return stop();
  if (how) return zoom(how);
  if (mode) return chooseBranch(mode);
  if (colouring) return setColouring(colouring);
  if (!isMeant && MOVING.includes(name)) return showNotice(NOT_MEANT, true);
  const why = button.closest("#panel") ? whyNot(name, last, loaded) : null;
  if (why !== null && last?.control === me) return showNotice(why.includes(". ") ? why : `Not now: ${why}.`, true);
  if (request) send({ request });
  else if (direction) jog(...stepsOf(direction));
  else if (turn) jogJoint(...turnOf(turn));
  else if (pen) send({ pen });
  else if (macro) send({ macro });
  else if (where) {
    const [x, y, scale, degrees] = where.split(",").map(Number);
    if (drawing.jobMiddle) place(drawing.jobMiddle, [x * SHIFT, y * SHIFT], scale, degrees);
  } else ACTIONS[button.id]?.();
}

// Does the next step. Where another one has just been the next, its click is not for this one.
function actNext(event) {
  if (next && !isFresh()) return act(controlOf(next), event);
  clicks.admits("next", at("next"), event);
  if (isFresh() && nextBefore === "stop") return stop();
  if (!marked) return;
  showTabOf(marked);
  marked.scrollIntoView({ block: "nearest" });
  marked.focus({ preventScroll: true });
}

document.addEventListener("click", (event) => {
  const button = event.target.closest("button");
  if (button?.id === "next") actNext(event);
  else if (button) act(button, event);
});

const percent = () => Number(at("feed").value);
function showSliders() {
  const step = 1000 * STEPS[at("step-size").value];
  put("ten", `→ ${step} mm\n⇒ ${10 * step} mm`);
  for (const [id, text] of [
    ["feed", `${percent()} %`],
    ["step-size", `${step} mm, held: ${STEPS_A_SECOND * step} mm/s`],
    ["turn", `${TURNS[at("turn").value]}°, held: ${STEPS_A_SECOND * TURNS[at("turn").value]}°/s`],
  ]) {
    put(`${id}-value`, text);
    if (at(id).ariaValueText !== text) at(id).ariaValueText = text;
  }
}

for (const id of ["feed", "step-size", "turn"]) at(id).oninput = showSliders;
at("feed").onchange = () => send({ feed: percent() / 100 });
at("run-on").onchange = () => send({ run_on: at("run-on").checked });
at("map").onchange = () => setMap(at("map").checked);
listenToFiles(at("file"), connection, load, (reason) => showNotice(reason, true));
listenToReading((reading) => send({ read: reading }));
listenToTabs(redraw);

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const JOINT_ARROWS = {
  ArrowLeft: ["theta1", 1], ArrowRight: ["theta1", -1], ArrowUp: ["theta4", 1], ArrowDown: ["theta4", -1],
};
const actions = (act, arrows) => Object.fromEntries(Object.entries(arrows).map(([key, by]) => [key, () => act(...by)]));
const ZOOM_KEYS = { "+": () => zoom("in"), "-": () => zoom("out") };
const muteKeys = listen(
  stop,
  { ...actions(jog, ARROWS), ...ZOOM_KEYS },
  { ...actions(jogJoint, JOINT_ARROWS), ...ZOOM_KEYS },
  (event) => {
    const { key, shiftKey } = event;
    hold.pressKey(event, () => (shiftKey ? holdJoint(...JOINT_ARROWS[key]) : holdTool(...ARROWS[key])));
  },
);

drag.onStart = () => showNotice("");
drag.onFollow = (point) => connection.send({ follow: point });
drag.onTurn = (joint, angle) => connection.send({ turn: { joint, to: angle } });
drag.onPlace = ({ about, by, scale }) => place(about, by, scale, 0);
drag.onPick = (point) => send({ line_at: point });
drag.onView = redraw;

at("name").textContent = arm.name;
at("place").textContent = arm.place;
at("tip-error").textContent = arm.tip_error;
// What these drives do not measure is not shown.
for (const part of document.querySelectorAll("[data-shows]")) part.hidden = !arm.shows.includes(part.dataset.shows);
chooseBranch(modes[0].dataset.mode);
showLegend();
setMap(true);
showControls();
showSliders();
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
connection.deliver(receive, lose);
