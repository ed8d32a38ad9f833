// The page: what the server tells becomes text and pictures, what hands do becomes wishes.
import { Drawing } from "./drawing.js";
import { Plot } from "./plots.js";

const ALIVE = 50; // ms; the server gives up a page after 500 ms
const RETRY = 1000; // ms
const LIMITS = ["torque", "voltage", "speed"]; // by bit

const at = (id) => document.getElementById(id);
const drawing = new Drawing(at("arm"));
const plots = {
  error: new Plot(at("error"), ["--one"]),
  torque: new Plot(at("torque"), ["--one", "--four"]),
  current: new Plot(at("current"), ["--one", "--four"]),
};

let socket = null;
let me = null;
let state = null;

function send(wish) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(wish));
}

function connect() {
  socket = new WebSocket(`ws://${location.host}/live${location.search}`);
  socket.onmessage = (event) => hear(JSON.parse(event.data));
  socket.onclose = () => {
    state = null;
    document.body.dataset.state = "offline";
    at("state").textContent = "no connection; a moving arm comes to rest by itself";
    setTimeout(connect, RETRY);
  };
}

function hear(news) {
  if (news.hello) me = news.hello;
  if (news.state) show(news.state);
  if (news.notice && (news.notice.to ?? me) === me) notice(news.notice.text, news.notice.refused);
  if ("fault" in news) showFault(news.fault);
  if (news.job) showJob(news.job);
}

function notice(text, refused) {
  at("notice").textContent = text;
  at("notice").classList.toggle("refused", refused);
}

const degrees = (angle) => `${((angle * 180) / Math.PI).toFixed(2)}°`;
const millimetres = (length) => (1000 * length).toFixed(2);

function show(news) {
  state = news;
  const watching = news.control !== me;
  document.body.dataset.state = news.state;
  const doing = news.homed ? news.state : `${news.state}, not homed`;
  at("state").textContent = watching ? `${doing} · watching` : doing;
  at("control").hidden = !watching;
  at("theta1").textContent = news.homed ? degrees(news.angle[0]) : "–";
  at("theta4").textContent = news.homed ? degrees(news.angle[1]) : "–";
  at("tool").textContent = news.tool ? `${news.tool.map(millimetres).join(", ")} mm` : "–";
  at("limits").textContent = LIMITS.filter((_, bit) => news.limits & (1 << bit)).join(", ") || "nothing";
  at("bus").textContent = `${news.bus_voltage.toFixed(1)} V`;
  at("line").textContent = news.tag || "–";
  const [done, all] = news.progress ?? [0, 1];
  at("progress").value = done / all;
  const error = news.tool && news.reference
    ? 1e6 * Math.hypot(news.tool[0] - news.reference[0], news.tool[1] - news.reference[1]) : null;
  plots.error.add(news.time, [error]);
  plots.torque.add(news.time, news.torque);
  plots.current.add(news.time, news.current);
  drawing.show(news);
}

function showFault(fault) {
  at("fault").hidden = !fault;
  if (!fault) return;
  at("fault-name").textContent = `${fault.name} (${fault.fault})`;
  const pair = (values, unit, digits) => values.map((v) => v.toFixed(digits)).join(", ") + ` ${unit}`;
  const rows = [
    ["while", fault.state],
    ["tick", fault.tick],
    ["θ1, θ4", fault.angle.map(degrees).join(", ")],
    ["ω1, ω4", pair(fault.velocity, "rad/s", 3)],
    ["position errors", pair(fault.error, "rad", 5)],
    ["currents", pair(fault.current, "A", 3)],
    ["torques", pair(fault.torque, "N·m", 4)],
    ["bus", `${fault.bus_voltage.toFixed(1)} V`],
  ];
  at("snapshot").replaceChildren(...rows.map(([name, value]) => {
    const row = document.createElement("tr");
    const head = document.createElement("th");
    const cell = document.createElement("td");
    head.textContent = name;
    cell.textContent = value;
    row.append(head, cell);
    return row;
  }));
}

function showJob(job) {
  drawing.job = job;
  at("run").disabled = job.refusal !== null;
  at("job").textContent = job.refusal
    ? `${job.name} is refused. ${job.refusal}`
    : `${job.name}: ${job.moves} moves, all within the arm's limits.`;
  at("job").dataset.ready = job.refusal === null;
}

const request = (name) => send({ request: name });

function jog(x, y) {
  const step = Number(at("step").value);
  send({ jog: [x * step, y * step] });
}

document.addEventListener("click", (event) => {
  const button = event.target.closest("button");
  if (button?.dataset.request) request(button.dataset.request);
  if (button?.dataset.jog) jog(...button.dataset.jog.split(",").map(Number));
});
at("control").onclick = () => send("control");
at("run").onclick = () => send("run");
at("change").onclick = () => send({ mode: at("mode").value.split(",") });
at("file").onchange = async () => {
  const [file] = at("file").files;
  if (file) send({ load: { name: file.name, text: await file.text() } });
};

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
document.addEventListener("keydown", (event) => {
  if (event.key === "Escape") return request("emergency_stop");
  const typing = event.target.closest("select, input");
  if (typing || event.ctrlKey || event.altKey || event.metaKey) return;
  if (event.key === " " && !event.target.closest("button")) request("stop");
  else if (event.key in ARROWS) jog(...ARROWS[event.key]);
  else return;
  event.preventDefault();
});

drawing.onFollow = (point) => send({ follow: point });
drawing.onTurn = (joint, angle) => send({ turn: { joint, to: angle } });

setInterval(() => send("alive"), ALIVE);
const arm = await (await fetch(`arm.json${location.search}`)).json();
drawing.arm = arm;
at("name").textContent = arm.simulated ? `${arm.name}, simulated` : arm.name;
connect();
