// A plot of one or two curves over the last seconds.
import { colour } from "./colour.js";

const SPAN = 10; // s
const MARGIN = 44; // px left of the curves, for the levels

export class Plot {
  #canvas;
  #context;
  #colours;
  #samples = [];

  constructor(canvas, colours) {
    this.#canvas = canvas;
    this.#context = canvas.getContext("2d");
    this.#colours = colours;
  }

  // A value that is null breaks its curve.
  add(time, values) {
    if (this.#samples.length && time < this.#samples.at(-1).time) this.#samples = [];
    this.#samples.push({ time, values });
    while (this.#samples[0].time < time - SPAN) this.#samples.shift();
  }

  draw() {
    const canvas = this.#canvas, context = this.#context;
    const { clientWidth: width, clientHeight: height } = canvas;
    if (!width || !this.#samples.length) return;
    const ratio = window.devicePixelRatio || 1;
    Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
    context.scale(ratio, ratio);
    const now = this.#samples.at(-1).time;
    const values = this.#samples.flatMap((sample) => sample.values).filter((v) => v !== null);
    const high = niceAbove(Math.max(0, ...values)), low = -niceAbove(Math.max(0, ...values.map((v) => -v)));
    const range = high - low || 1;
    const x = (time) => width - ((width - MARGIN) * (now - time)) / SPAN;
    const y = (value) => 10 + ((high - value) / range) * (height - 20);
    this.#drawLevels([...new Set([low, 0, high])], y, width);
    context.lineWidth = 1.5;
    context.lineJoin = "round";
    this.#colours.forEach((name, index) => {
      context.strokeStyle = colour(name);
      context.beginPath();
      let pen = "moveTo";
      for (const sample of this.#samples) {
        const value = sample.values[index];
        if (value !== null) context[pen](x(sample.time), y(value));
        pen = value === null ? "moveTo" : "lineTo";
      }
      context.stroke();
    });
  }

  #drawLevels(levels, y, width) {
    const context = this.#context;
    context.fillStyle = colour("--quiet");
    context.strokeStyle = colour("--grid");
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const level of levels) {
      context.beginPath();
      context.moveTo(MARGIN, y(level));
      context.lineTo(width, y(level));
      context.stroke();
      context.fillText(String(level).replace("-", "−"), MARGIN - 6, y(level));
    }
  }
}

// The least of 1, 2, 5 times a power of ten that is at least the value; 0 for 0.
function niceAbove(value) {
  if (!(value > 0)) return 0;
  const power = 10 ** Math.floor(Math.log10(value));
  const digit = [1, 2, 5, 10].find((candidate) => candidate * power >= value);
  return Number((digit * power).toPrecision(2));
}
