"use strict";
// Draws each animation of the page from the data in its script element. Coordinates are integer
// multiples of `quantum` from `origin`; times are in milliseconds.
for (const figure of document.querySelectorAll("figure.animation")) {
  const data = JSON.parse(figure.querySelector("script").textContent);
  const canvas = figure.querySelector("canvas");
  const button = figure.querySelector("button");
  const slider = figure.querySelector("input");
  const output = figure.querySelector("output");
  const select = figure.querySelector("select");
  const times = data.times.length ? data.times : [0];
  const start = times[0], end = times[times.length - 1];
  let now = start, playing = false, last = null;

  slider.min = start; slider.max = Math.max(end, start + 1);
  const speeds = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50];
  for (const speed of speeds) select.add(new Option(speed + "×", speed));
  // Real time, or the least speed at which the animation takes at most half a minute.
  select.value = speeds.find(speed => speed >= 1 && (end - start) / speed <= 3e4) || 50;

  // Index of the last entry at or before `time`, or -1.
  function before(list, time) {
    let low = 0, high = list.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (list[middle] <= time) low = middle + 1; else high = middle;
    }
    return low - 1;
  }

  function draw() {
    const style = getComputedStyle(figure);
    const color = name => style.getPropertyValue(name);
    const ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, air = 18;
    const [across, up] = data.size.map(size => Math.max(size, 1));
    const height = Math.min(Math.max((width - 2 * air) * up / across + 2 * air, 160),
      0.65 * window.innerHeight);
    canvas.style.height = height + "px";
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const scale = Math.min((width - 2 * air) / across, (height - 2 * air) / up);
    const left = (width - scale * across) / 2, bottom = (height + scale * up) / 2;
    const x = step => left + scale * step, y = step => bottom - scale * step;
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    context.lineCap = context.lineJoin = "round";

    function curve(points, count) {
      let open = false;
      context.beginPath();
      for (let i = 0; i < count; i++) {
        const px = points[2 * i], py = points[2 * i + 1];
        if (px === null || py === null) { open = false; continue; }
        if (open) context.lineTo(x(px), y(py)); else context.moveTo(x(px), y(py));
        open = true;
      }
      context.stroke();
    }

    context.strokeStyle = color("--quiet");
    context.lineWidth = 1;
    context.setLineDash([4, 4]);
    for (const points of data.fixed) curve(points, points.length / 2);
    context.setLineDash([]);
    context.lineWidth = 1.8;
    data.traces.forEach((trace, index) => {
      context.strokeStyle = color("--s" + (index % 4 + 1));
      curve(trace.points, before(trace.times, now) + 1);
    });

    const frame = Math.max(before(times, now), 0), next = Math.min(frame + 1, times.length - 1);
    const span = times[next] - times[frame];
    const share = span > 0 ? (now - times[frame]) / span : 0;
    context.strokeStyle = color("--ink");
    for (const frames of data.bodies) {
      if (!frames.length) continue;
      const from = frames[frame], to = frames[next];
      const points = from.map((value, i) =>
        value === null || to[i] === null ? null : value + share * (to[i] - value));
      context.lineWidth = 5;
      context.globalAlpha = 0.75;
      curve(points, points.length / 2);
      context.globalAlpha = 1;
      context.lineWidth = 2;
      context.fillStyle = color("--paper");
      for (let i = 0; i + 1 < points.length; i += 2) {
        if (points[i] === null) continue;
        context.beginPath();
        context.arc(x(points[i]), y(points[i + 1]), 4, 0, 2 * Math.PI);
        context.fill();
        context.stroke();
      }
    }

    // Scale bar: the greatest length 1, 2 or 5 × 10ⁿ within a quarter of the width.
    const widest = 0.25 * width / scale * data.quantum;
    const decade = 10 ** Math.floor(Math.log10(widest));
    const bar = [5, 2, 1].find(digit => digit * decade <= widest) * decade;
    const length = bar / data.quantum * scale;
    context.lineWidth = 2;
    context.strokeStyle = context.fillStyle = color("--quiet");
    context.beginPath();
    context.moveTo(12, height - 10);
    context.lineTo(12 + length, height - 10);
    context.stroke();
    context.font = "12px system-ui, sans-serif";
    context.fillText(Number(bar.toPrecision(1)) + " " + data.unit, 12, height - 16);

    slider.value = now;
    output.textContent = (now / 1000).toFixed(2) + " / " + (end / 1000).toFixed(2) + " s";
  }

  function step(stamp) {
    if (!playing) return;
    if (last !== null) now += (stamp - last) * Number(select.value);
    last = stamp;
    if (now >= end) { now = end; play(false); }
    draw();
    requestAnimationFrame(step);
  }

  function play(on) {
    if (on && now >= end) now = start;
    playing = on;
    last = null;
    button.textContent = on ? "Pause" : "Play";
    if (on) requestAnimationFrame(step);
  }

  button.addEventListener("click", () => play(!playing));
  slider.addEventListener("input", () => { now = Number(slider.value); play(false); draw(); });
  slider.addEventListener("keydown", event => {
    const steps = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1 }[event.key];
    if (event.key === " ") play(!playing);
    else if (steps) {
      play(false);
      now = Math.min(Math.max(now + steps * (end - start) / 200, start), end);
      draw();
    } else return;
    event.preventDefault();
  });
  new ResizeObserver(draw).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  // The page opens on the end of the animation, with all traces.
  now = end;
  draw();
}
