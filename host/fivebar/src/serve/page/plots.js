// A plot of one or two values over the last seconds. A drag zooms, and a double click shows the
// last seconds again.
import { colour } from "./colour.js";

const SPAN = 10; // s
const HEIGHT = 130; // px

export class Plot {
  #place;
  #unit;
  #names;
  #colours;
  #plot;
  #zoomed = false;
  // Times, then the values of each series.
  #data;

  constructor(place, unit, names, colours) {
    [this.#place, this.#unit, this.#names, this.#colours] = [place, unit, names, colours];
    this.#data = [[], ...names.map(() => [])];
    this.#make();
    // In the next frame, because the plot's height is part of what is observed.
    new ResizeObserver(() => requestAnimationFrame(() => this.#resize())).observe(place);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.#make());
  }

  #make() {
    this.#plot?.destroy();
    const text = (value) => (value === null ? "–" : String(Number(value.toPrecision(4))).replaceAll("-", "−"));
    const line = { stroke: colour("--grid"), width: 1 };
    const axis = (label, more) => ({ label, labelSize: 18, stroke: colour("--quiet"), grid: line, ticks: line,
      font: "12px system-ui", labelFont: "12px system-ui", values: (_, values) => values.map(text), ...more });
    const series = this.#names.map((label, index) => (
      { label, stroke: colour(this.#colours[index]), width: 1.5, points: { show: false }, value: (_, value) => text(value) }));
    const whole = () => { this.#zoomed = false; this.draw(); };
    this.#plot = new uPlot({
      width: this.#place.clientWidth,
      height: HEIGHT,
      scales: { x: { time: false }, y: { range: { min: { pad: 0.1, soft: 0, mode: 1 }, max: { pad: 0.1, soft: 0, mode: 1 } } } },
      axes: [axis("time [s]", { size: 28 }), axis(this.#unit, { size: 48 })],
      series: [{ label: "time [s]", value: (_, value) => text(value) }, ...series],
      cursor: { bind: { dblclick: () => whole } },
      hooks: { setSelect: [() => (this.#zoomed = true)] },
    }, this.#data, this.#place);
  }

  // A plot in a closed tab has no size.
  get #isOpen() {
    return this.#place.clientWidth > 0;
  }

  #resize() {
    if (!this.#isOpen) return;
    this.#plot.setSize({ width: this.#place.clientWidth, height: HEIGHT });
    this.draw();
  }

  // A value that is null breaks its curve.
  add(time, values) {
    const [times] = this.#data;
    if (times.length && time < times.at(-1)) for (const column of this.#data) column.length = 0;
    [time, ...values].forEach((value, index) => this.#data[index].push(value));
    const old = times.findIndex((kept) => kept >= time - SPAN);
    for (const column of this.#data) column.splice(0, old);
  }

  draw() {
    const now = this.#data[0].at(-1);
    if (now === undefined || !this.#isOpen) return;
    this.#plot.setData(this.#data, false);
    if (this.#zoomed) this.#plot.redraw();
    else this.#plot.setScale("x", { min: now - SPAN, max: now });
  }
}
