// The fields of place, size and angle of the drawing. A change of one places the drawing; its shape stays.

const at = (name) => document.getElementById(`place-${name}`);
const MILLIMETRE = 1e-3;
const DEGREE = Math.PI / 180;
const NAMES = ["left", "low", "width", "height", "turn"];

export class PlacementFields {
  #box = null; // lower left and upper right corner of what the job draws [m]
  #turn = 0; // of the job against its file [rad]

  // `onPlace` gets the point that stays when scaled and turned [m], the motion [m], the factor and the angle [degrees].
  constructor(onPlace) {
    for (const name of NAMES) {
      at(name).addEventListener("change", () => {
        const value = Number(at(name).value);
        if (this.#box && at(name).value !== "" && Number.isFinite(value)) this.#place(name, value, onPlace);
        this.#fill();
      });
    }
  }

  // Shows where the drawing lies, and how it is turned.
  show(box, turn) {
    this.#box = box;
    this.#turn = turn;
    this.#fill();
  }

  #values() {
    const [left, low, right, high] = this.#box;
    const turn = this.#turn / DEGREE - 360 * Math.round(this.#turn / DEGREE / 360);
    const sizes = { left, low, width: right - left, height: high - low };
    return { ...Object.fromEntries(Object.entries(sizes).map(([name, size]) => [name, size / MILLIMETRE])), turn };
  }

  #fill() {
    const values = this.#box ? this.#values() : null;
    for (const name of NAMES) {
      at(name).disabled = !values;
      at(name).value = values ? Number(values[name].toFixed(1)) : "";
    }
  }

  #place(name, value, onPlace) {
    const [left, low, right, high] = this.#box;
    const now = this.#values()[name];
    const by = value - now;
    if (name === "turn") onPlace([(left + right) / 2, (low + high) / 2], [0, 0], 1, by);
    else if (name === "left") onPlace([left, low], [by * MILLIMETRE, 0], 1, 0);
    else if (name === "low") onPlace([left, low], [0, by * MILLIMETRE], 1, 0);
    else if (value > 0 && now > 0) onPlace([left, low], [0, 0], value / now, 0);
  }
}
