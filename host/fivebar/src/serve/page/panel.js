// The server's messages as text and numbers.

import { isMoving } from "./connection.js";

const LIMITS = ["torque", "voltage", "speed"]; // by bit

const at = (id) => document.getElementById(id);
const degrees = (angle) => `${((angle * 180) / Math.PI).toFixed(2)}°`.replace("-", "−");
const numbers = (values, digits) => values.map((v) => v.toFixed(digits).replace("-", "−")).join(", ");
const sides = ([elbow1, elbow4]) => `1 ${elbow1}, 4 ${elbow4}`;

// Sets a text only if it changes, so that screen readers do not repeat it.
export function put(id, text) {
  if (at(id).textContent !== text) at(id).textContent = text;
}

// A time such as 2:05 or 1:02:05.
function clock(seconds) {
  const whole = Math.round(seconds), minutes = Math.floor(whole / 60), two = (part) => String(part).padStart(2, "0");
  const hours = Math.floor(minutes / 60);
  return `${hours ? `${hours}:${two(minutes % 60)}` : minutes}:${two(whole % 60)}`;
}

// The time that a job still takes: by its plan at its own speed, estimated at another one.
const timeLeft = ({ left, feed }) => `${feed === 1 ? "" : "about "}${clock(left)} left`;

// The states whose names in the protocol say little.
const STATES = { Stopped: "Motors off", Armed: "Motors on", Running: "Moving", Crossing: "Changing branch" };
const word = ({ state }) => STATES[state] ?? state;

// The state of the arm and of the page in a few words.
export function stateText(state, watching) {
  const parts = [state.homed ? word(state) : `${word(state)}, not homed`];
  if (watching) parts.push("this page watches");
  if (state.sender) parts.push("a sender is in control");
  else if (!state.alive) parts.push(state.run_on && state.state === "Running" ? "the job runs on" : "no page is in control");
  return parts.join(" · ");
}

// Whether a control has a use now: null, or why it has none.
export function whyNot(control, state, job) {
  if (!state) return "there is no connection";
  if (state.sender && control !== "stop") return "a sender of G-code is in control";
  const { state: name, homed } = state;
  const armed = name === "Armed", running = name === "Running";
  const isJob = state.left !== null;
  switch (control) {
    case "home": return name === "Stopped" ? null : `the state is “${word(state)}”`;
    case "arm": return name !== "Stopped" ? `the state is “${word(state)}”` : homed ? null : "the arm is not homed";
    case "disarm": return armed ? null : `the state is “${word(state)}”`;
    case "stop": return isMoving(state) ? null : "the arm rests";
    case "clear_fault": return name === "Fault" ? null : "there is no fault";
    case "jog": case "change":
      return isJob ? "a job runs" : armed || running ? null : `the state is “${word(state)}”`;
    case "pen": case "macro":
      return isJob ? "a job runs" : armed ? null : running ? "the arm moves" : "the motors are off";
    case "lead":
      return isJob ? "a job runs" : armed || name === "Compliant" ? null : running ? "the arm moves" : "the motors are off";
    case "send": return isJob ? "a job runs" : null;
    case "resume": return state.held === null ? "no job was stopped" : armed ? null : "the motors are off";
    case "run": case "run-from":
      if (isJob) return "a job runs";
      if (!job) return "no job is loaded";
      if (job.refusal && homed) return `The job cannot be done. ${job.refusal}`;
      return armed ? null : "the motors are off";
    case "frame": return isJob ? "a job runs" : !job?.moves ? "no job is loaded" : armed ? null : "the motors are off";
    case "place": return isJob ? "a job runs" : job?.moves ? null : "no job is loaded";
    default: return null;
  }
}

// The next step: a sentence, the control that does it (its name, and its words), and the control that is
// marked instead. Clearing a fault, switching the motors on and resuming a job are three buttons in three
// places, so that clicks in one place do not lead from a stop to a motion.
export function nextStep(state, job, fault, watching) {
  if (!state) return ["No connection. A moving arm comes to rest, unless its job runs on. The page connects again by itself.", null, "Wait"];
  const held = state.pause ? ` ${state.pause}. The job waits at line ${state.held}.`
    : state.held !== null ? ` The job waits at line ${state.held}.` : "";
  if (state.sender) return ["A sender of G-code is in control. Any page may stop the arm.", "stop", "Stop"];
  if (watching) {
    if (state.left !== null) return ["Another page's job runs. Any page may stop it.", "stop", "Stop"];
    return [`This page watches.${held}`, "control", "Take control"];
  }
  switch (state.state) {
    case "Fault": {
      const what = fault ? `Fault ${fault.fault}, ${fault.name}. ${fault.advice}` : "Fault.";
      return [`${what} Repair the cause, then press the marked button.${held}`, null, "Show it", "clear_fault"];
    }
    case "Homing": return ["The arm searches for its home switches.", "stop", "Stop"];
    case "Compliant": return ["Lead the tip by hand. What you teach becomes the job.", "lead", "End leading"];
    case "Crossing": return ["The arm crosses a singularity.", null, "Wait"];
    case "Stopping": return ["The arm comes to rest on its path.", null, "Wait"];
    case "Stopped":
      if (!state.homed) return ["The joint angles are unknown: home the arm. It will move.", "home", "Home"];
      return [`The motors are off.${held} Switch them on, then the arm holds its position.`, "arm", "Motors on"];
    case "Running":
      if (state.left === null) return ["The arm moves.", "stop", "Stop"];
      return [`The job is at line ${state.tag ?? "–"}, ${timeLeft(state)}.`, "stop", "Stop"];
    default:
      if (state.left !== null) return ["The job begins.", "stop", "Stop"];
      if (state.pause) return [`${state.pause}. Then press Resume.`, null, "Show it", "resume"];
      if (held) return [`${held.trim()} Resume it with the marked button, or run it from the start.`, null, "Show it", "resume"];
      if (!job) return ["The motors hold the arm. Open a job, or drag the tool.", "demonstration", "Load demonstration"];
      if (job.refusal && !job.moves) return [`${job.name} cannot be read: the reason is at Job. Open another file.`, "demonstration", "Load demonstration"];
      if (job.refusal) return [`${job.name} does not fit as it lies: fit it, or move, scale or turn it.`, "fit", "Fit drawing"];
      return [`Ready: ${job.name}. Run it.`, "run", "Run job"];
  }
}

export function showNumbers(state, me) {
  put("theta1", state.homed ? degrees(state.angle[0]) : "–");
  put("theta4", state.homed ? degrees(state.angle[1]) : "–");
  put("tool", state.tool ? `${numbers(state.tool.map((x) => 1000 * x), 2)} mm` : "–");
  put("elbows", state.elbows ? sides(state.elbows) : "–");
  put("limits", LIMITS.filter((_, bit) => state.limits & (1 << bit)).join(", ") || "none");
  put("bus", `${state.bus_voltage.toFixed(1)} V`);
  put("line", String(state.tag || state.held || "–"));
  put("holder", state.sender ? "a sender" : !state.alive ? "no page" : state.control === me ? "this page" : "another page");
  put("speed", state.speed === null ? "–" : `${state.speed.toFixed(2)}×`);
  const [done, all] = state.progress ?? [0, 1];
  at("progress").value = all > 0 ? done / all : 0;
  put("left", state.left !== null ? timeLeft(state)
    : state.pause ? "the job waits for you" : state.held !== null ? `stopped at line ${state.held}` : "–");
}

export function showNotice(text, refused = false) {
  put("notice", text);
  at("notice").classList.toggle("refused", refused);
}

// `shows` is what the drives measure.
export function showFault(fault, shows) {
  at("fault").hidden = !fault;
  if (!fault) return;
  at("fault-name").textContent = `${fault.name} (${fault.fault})`;
  at("cause").textContent = `${fault.advice} Repair the cause, clear the fault, wait a second, switch the motors on.`;
  const rows = [
    ["state", fault.state],
    ["tick", fault.tick],
    ["θ1, θ4", fault.angle.map(degrees).join(", ")],
    ["ω1, ω4", `${numbers(fault.velocity, 3)} rad/s`],
    ["position errors", `${numbers(fault.error, 5)} rad`],
    ["currents", `${numbers(fault.current, 3)} A`, "current"],
    ["torques", `${numbers(fault.torque, 4)} N·m`, "torque"],
    ["bus", `${fault.bus_voltage.toFixed(1)} V`, "bus_voltage"],
  ].filter(([, , signal]) => !signal || shows.includes(signal));
  at("snapshot").replaceChildren(...rows.map(([name, value]) => {
    const row = document.createElement("tr");
    const head = document.createElement("th");
    const cell = document.createElement("td");
    head.scope = "row";
    head.textContent = name;
    cell.textContent = value;
    row.append(head, cell);
    return row;
  }));
}

// What a job draws: its size, the number and length of its strokes, and its time. Nothing for a job without strokes.
function extent(job, box) {
  if (!box) return "";
  const strokes = job.strokes.filter(({ down }) => down);
  const along = (points) => points.slice(1).reduce(
    (sum, [x, y], i) => sum + Math.hypot(x - points[i][0], y - points[i][1]), 0);
  const length = strokes.reduce((sum, { points }) => sum + along(points), 0);
  const [wide, high] = [box[2] - box[0], box[3] - box[1]].map((size) => (1000 * size).toFixed(1));
  const count = `${strokes.length} ${strokes.length === 1 ? "stroke" : "strokes"}`;
  const time = job.time === null ? "" : ` · ${job.time < 60 ? `${job.time.toFixed(1)} s` : clock(job.time)}`;
  return `${wide} × ${high} mm · ${count} · ${(1000 * length).toFixed(0)} mm drawn${time}`;
}

// Shows a job; `box` holds the corners of what it draws [m].
export function showJob(job, box) {
  const notes = job.notes.map((note) => `\nNote: ${note}.`).join("");
  put("job", (job.refusal
    ? `${job.name} is refused. ${job.refusal}`
    : `${job.name}: ${job.moves} moves, all within the arm's limits.`)
    + (job.is_from_home ? " Checked from home: it is checked again once the arm is homed." : "") + notes);
  at("job").classList.toggle("refused", job.refusal !== null);
  put("size", extent(job, box));
  at("layers").hidden = job.layers.length === 0;
  at("layers").replaceChildren(...job.layers.map(({ name, strokes, length }) => {
    const item = document.createElement("li");
    item.textContent = `${name} · ${strokes} ${strokes === 1 ? "stroke" : "strokes"} · ${(1000 * length).toFixed(0)} mm`;
    return item;
  }));
}
