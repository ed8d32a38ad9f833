// A curve or two over the last seconds.

const SPAN = 10; // s

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class Plot {
  #canvas;
  #colours;
  #samples = [];

  constructor(canvas, colours) {
    this.#canvas = canvas;
    this.#colours = colours;
  }

  // A value that is null breaks its curve.
  add(time, values) {
    if (this.#samples.length && time < this.#samples.at(-1).time) this.#samples = [];
    this.#samples.push({ time, values });
    while (this.#samples[0].time < time - SPAN) this.#samples.shift();
    this.#draw(time);
  }

  #draw(now) {
    const canvas = this.#canvas;
    const { clientWidth: width, clientHeight: height } = canvas;
    const ratio = window.devicePixelRatio || 1;
    Object.assign(canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    const values = this.#samples.flatMap((sample) => sample.values).filter((v) => v !== null);
    const high = niceAbove(Math.max(0, ...values)), low = -niceAbove(Math.max(0, ...values.map((v) => -v)));
    const range = high - low || 1;
    const x = (time) => width * (1 + (time - now) / SPAN);
    const y = (value) => 6 + ((high - value) / range) * (height - 12);
    context.fillStyle = colour("--quiet");
    context.strokeStyle = colour("--grid");
    context.font = "12px system-ui, sans-serif";
    for (const level of new Set([low, 0, high])) {
      context.beginPath();
      context.moveTo(0, y(level));
      context.lineTo(width, y(level));
      context.stroke();
      context.fillText(String(level), 4, Math.max(12, y(level) - 3));
    }
    context.lineWidth = 1.5;
    this.#colours.forEach((name, index) => {
      context.strokeStyle = colour(name);
      context.beginPath();
      let pen = "moveTo";
      for (const sample of this.#samples) {
        const value = sample.values[index];
        if (value === null) {
          pen = "moveTo";
        } else {
          context[pen](x(sample.time), y(value));
          pen = "lineTo";
        }
      }
      context.stroke();
    });
  }
}

// The least of 1, 2, 5 times a power of ten that is no less than a value; 0 for 0.
function niceAbove(value) {
  if (!(value > 0)) return 0;
  const power = 10 ** Math.floor(Math.log10(value));
  const digit = [1, 2, 5, 10].find((candidate) => candidate * power >= value);
  return Number((digit * power).toPrecision(2));
}
