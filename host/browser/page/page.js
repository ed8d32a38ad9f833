// Sliders to requests, answers and samples to the picture.
"use strict";
const ROW = 6; // Time [s], θ1, θ4 [rad], x, y [m], level of the tool.
const get = (id) => document.getElementById(id);
const sliders = ["crank", "coupler", "base"].map(get);
const plane = get("plane");
let arm = null; // The program's answer to "arm".
let mapPicture = null;
let run = null; // { worker, rows: [Float32Array], count, begun, done }

/** The five lengths [m]; none for the default arm, whose own file has its masses. */
function lengths() {
  const [crank, coupler, base] = sliders.map((slider) => Number(slider.value) / 1000);
  const isDefault = sliders.every((slider) => slider.value === slider.defaultValue);
  return isDefault ? undefined : [crank, coupler, coupler, crank, base];
}

function say(text) { get("state").textContent = text; }

// The arm. Of several changes while the program is busy only the last one is asked for.
const asker = new Worker("worker.js");
let isAsking = false, isAskedAgain = false;
function ask() {
  sliders.forEach((slider) => { slider.nextElementSibling.textContent = `${slider.value} mm`; });
  if (isAsking) { isAskedAgain = true; return; }
  isAsking = true;
  asker.postMessage({ op: "arm", link_lengths: lengths() });
}
asker.onmessage = ({ data: { answered } }) => {
  isAsking = false;
  if (isAskedAgain) { isAskedAgain = false; ask(); return; }
  arm = answered.error ? null : answered;
  get("draw").setAttribute("aria-disabled", String(!arm));
  get("file").hidden = !arm;
  if (arm) {
    get("file").href = URL.createObjectURL(new Blob([arm.file], { type: "application/toml" }));
    paintMap();
  }
  say(arm ? "Ready: press Draw" : sentence(answered.error));
  paint();
};

function sentence(text) { return text.charAt(0).toUpperCase() + text.slice(1); }

function stop() {
  run?.worker.terminate();
  run = null;
  for (const id of ["error", "simulated", "pace", "digest"]) get(id).textContent = "–";
}

function draw(job) {
  if (!arm) return;
  stop();
  const mine = { worker: new Worker("worker.js"), rows: [], count: 0, begun: null, done: null };
  run = mine;
  say("The arm looks for its home switches and draws");
  mine.worker.onmessage = ({ data: { rows, answered, seconds } }) => {
    if (run !== mine) return;
    if (rows) {
      if (mine.begun === null) { mine.begun = performance.now(); requestAnimationFrame(play); }
      for (let at = 0; at < rows.length; at += ROW) mine.rows.push(rows.subarray(at, at + ROW));
      return;
    }
    mine.done = answered;
    if (answered.error) { say(sentence(answered.error)); return; }
    const micro = (metres) => `${(1e6 * metres).toFixed(1)} µm`;
    get("error").textContent = `${micro(answered.tip_error.rms_m)} RMS, ${micro(answered.tip_error.max_m)} at most`;
    get("simulated").textContent = `${answered.simulated_s.toFixed(2)} s`;
    get("pace").textContent = `${(answered.simulated_s / seconds).toFixed(1)} times as fast as the arm moves`;
    get("digest").textContent = answered.digest;
  };
  mine.worker.postMessage({ op: "draw", link_lengths: lengths(), job });
}

// Shows the run as fast as the arm moves.
function play() {
  if (!run) return;
  const now = (performance.now() - run.begun) / 1000;
  const first = run.rows[0]?.[0] ?? 0;
  while (run.count < run.rows.length && run.rows[run.count][0] - first <= now) run.count += 1;
  paint();
  if (run.count < run.rows.length || !run.done) { requestAnimationFrame(play); return; }
  if (run.done.error) return;
  const { faults, scale } = run.done;
  const size = scale === 1 ? "" : `, at ${(100 * scale).toFixed(0)} % of its size`;
  say(faults.length ? `The arm stopped: ${faults.join(", ")}` : `Drawn${size}`);
}

function paintMap() {
  const { columns, cells } = arm;
  mapPicture = document.createElement("canvas");
  mapPicture.width = columns;
  mapPicture.height = cells.length / columns;
  const context = mapPicture.getContext("2d");
  const image = context.createImageData(columns, mapPicture.height);
  cells.forEach((cell, index) => {
    if (cell === 0) return;
    const [row, column] = [Math.floor(index / columns), index % columns];
    image.data.set([40, 150, 100, 40 + 1.6 * cell], 4 * ((mapPicture.height - 1 - row) * columns + column));
  });
  context.putImageData(image, 0, 0);
}

function paint() {
  const [width, height] = [plane.clientWidth, plane.clientHeight];
  [plane.width, plane.height] = [width, height].map((size) => Math.round(size * devicePixelRatio));
  if (!arm) return;
  const context = plane.getContext("2d");
  const colour = (name) => getComputedStyle(plane).getPropertyValue(name);
  const [[left, low], [right, high]] = [arm.low, arm.high];
  const scale = 0.96 * Math.min(width / (right - left), height / (high - low)) * devicePixelRatio;
  const at = ([x, y]) => [plane.width / 2 + scale * (x - (left + right) / 2), plane.height / 2 - scale * (y - (low + high) / 2)];
  context.imageSmoothingEnabled = true;
  context.drawImage(mapPicture, ...at([left, high]), scale * (right - left), scale * (high - low));
  context.lineCap = context.lineJoin = "round";
  const line = (points, name, thickness) => {
    context.beginPath();
    for (const point of points) context.lineTo(...at(point));
    context.strokeStyle = colour(name);
    context.lineWidth = thickness * devicePixelRatio;
    context.stroke();
  };
  const rows = run ? run.rows.slice(0, run.count) : [];
  context.beginPath();
  rows.forEach((row, index) => {
    const to = at([row[3], row[4]]);
    if (row[5] > 0 && index > 0) context.lineTo(...to); else context.moveTo(...to);
  });
  context.strokeStyle = colour("--drawn");
  context.lineWidth = 2 * devicePixelRatio;
  context.stroke();
  const now = rows.at(-1);
  const [theta1, theta4, x, y] = now ? now.slice(1, 5) : arm.home;
  const [l1, , , l4, base] = arm.link_lengths;
  const b = [l1 * Math.cos(theta1), l1 * Math.sin(theta1)];
  const d = [base + l4 * Math.cos(theta4), l4 * Math.sin(theta4)];
  line([[0, 0], [base, 0]], "--edge", 6);
  line([[0, 0], b, [x, y]], "--one", 5);
  line([[base, 0], d, [x, y]], "--four", 5);
  for (const joint of [[0, 0], [base, 0], b, d, [x, y]]) {
    context.beginPath();
    context.arc(...at(joint), 5 * devicePixelRatio, 0, 2 * Math.PI);
    context.fillStyle = colour("--ink");
    context.fill();
  }
}

for (const slider of sliders) slider.addEventListener("input", () => { stop(); ask(); });
get("draw").addEventListener("click", () => draw(undefined));
get("job").addEventListener("change", async ({ target }) => {
  const [file] = target.files;
  if (file) draw(await file.text());
  target.value = "";
});
addEventListener("resize", paint);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", paint);
ask();
