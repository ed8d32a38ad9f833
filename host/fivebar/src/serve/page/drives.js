// What the drives do: a number and a plot for each of their values, which their kind decides.
import { Plot } from "./plots.js";

const at = (id) => document.getElementById(id);

// An element with a text, in another one.
function add(to, name, text = "") {
  const element = document.createElement(name);
  element.textContent = text;
  to.append(element);
  return element;
}

export class Drives {
  #values;

  // The values that each state has, with name, unit and decimals.
  constructor(values) {
    this.#values = values.map(({ name, unit, digits }) => {
      const row = add(at("drive-numbers"), "div");
      add(row, "dt", name);
      const number = add(row, "dd", "–");
      const figure = add(at("drive-plots"), "figure");
      add(figure, "figcaption", name[0].toUpperCase() + name.slice(1));
      const plot = new Plot(figure, `[${unit}]`, ["joint 1", "joint 4"], ["--one", "--four"]);
      return { unit, digits, number, plot };
    });
  }

  // A value is null while the drives have no power.
  show({ time, drives }) {
    this.#values.forEach(({ unit, digits, number, plot }, index) => {
      const pair = drives[index];
      plot.add(time, pair ?? [null, null]);
      const text = pair ? `${pair.map((value) => value.toFixed(digits).replace("-", "−")).join(", ")} ${unit}` : "–";
      if (number.textContent !== text) number.textContent = text;
    });
  }

  draw() {
    for (const { plot } of this.#values) plot.draw();
  }
}
