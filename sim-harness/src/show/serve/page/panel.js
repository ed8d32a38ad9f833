// The server's messages as text and numbers.

const LIMITS = ["torque", "voltage", "speed"]; // by bit

// What to add to a fault's name and snapshot, by its number.
const CAUSES = {
  10: "The bridges are off and the brake is on.",
  12: "The page in control was closed, disconnected or suspended while the arm moved. The arm "
    + "came to rest on its path and is held.",
};

const at = (id) => document.getElementById(id);
const degrees = (angle) => `${((angle * 180) / Math.PI).toFixed(2)}°`.replace("-", "−");
const numbers = (values, digits) => values.map((v) => v.toFixed(digits).replace("-", "−")).join(", ");
const sides = ([elbow1, elbow4]) => `1 ${elbow1}, 4 ${elbow4}`;

// The state of the arm and of the page in a few words.
export function stateText(state, watching) {
  const parts = [state.homed ? state.state : `${state.state}, not homed`];
  if (watching) parts.push("this page watches");
  if (!state.alive) parts.push("no page is in control");
  return parts.join(" · ");
}

export function showNumbers(state) {
  at("theta1").textContent = state.homed ? degrees(state.angle[0]) : "–";
  at("theta4").textContent = state.homed ? degrees(state.angle[1]) : "–";
  at("tool").textContent = state.tool ? `${numbers(state.tool.map((x) => 1000 * x), 2)} mm` : "–";
  at("elbows").textContent = state.elbows ? sides(state.elbows) : "–";
  at("limits").textContent = LIMITS.filter((_, bit) => state.limits & (1 << bit)).join(", ") || "none";
  at("bus").textContent = `${state.bus_voltage.toFixed(1)} V`;
  at("line").textContent = state.tag || "–";
  at("speed").textContent = state.speed === null ? "–" : `${state.speed.toFixed(2)}×`;
  const [done, all] = state.progress ?? [0, 1];
  at("progress").value = done / all;
}

export function showNotice(text, refused = false) {
  at("notice").textContent = text;
  at("notice").classList.toggle("refused", refused);
}

export function showFault(fault) {
  at("fault").hidden = !fault;
  if (!fault) return;
  at("fault-name").textContent = `${fault.name} (${fault.fault})`;
  at("cause").textContent = `${CAUSES[fault.fault] ?? ""} Repair the cause, clear the fault, arm.`;
  const rows = [
    ["state", fault.state],
    ["tick", fault.tick],
    ["θ1, θ4", fault.angle.map(degrees).join(", ")],
    ["ω1, ω4", `${numbers(fault.velocity, 3)} rad/s`],
    ["position errors", `${numbers(fault.error, 5)} rad`],
    ["currents", `${numbers(fault.current, 3)} A`],
    ["torques", `${numbers(fault.torque, 4)} N·m`],
    ["bus", `${fault.bus_voltage.toFixed(1)} V`],
  ];
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

export function showJob(job) {
  at("run").disabled = false;
  at("job").textContent = job.refusal
    ? `${job.name} is refused. ${job.refusal}`
    : `${job.name}: ${job.moves} moves, all within the arm's limits.`;
  at("job").classList.toggle("refused", job.refusal !== null);
}
