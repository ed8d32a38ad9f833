// The fields of place, size and angle of the drawing. A change of one places the drawing; its shape stays.

const at = (name) => document.getElementById(`place-${name}`);
const MILLIMETRE = 1e-3;

export class PlacementFields {
  #box = null; // lower left and upper right corner of what the job draws [m]

  // `onPlace` gets the point that stays when scaled and turned [m], the motion [m], the factor and the angle [degrees].
  constructor(onPlace) {
    for (const name of ["left", "low", "width", "height", "turn"]) {
      at(name).addEventListener("change", () => {
        const value = Number(at(name).value);
        if (this.#box && at(name).value !== "" && Number.isFinite(value)) this.#place(name, value, onPlace);
        this.#fill();
      });
    }
  }

  // Shows where the drawing lies.
  show(box) {
    this.#box = box;
    this.#fill();
  }

  #values() {
    const [left, low, right, high] = this.#box;
    return { left, low, width: right - left, height: high - low };
  }

  #fill() {
    for (const name of ["left", "low", "width", "height"]) {
      at(name).disabled = !this.#box;
      at(name).value = this.#box ? (this.#values()[name] / MILLIMETRE).toFixed(1) : "";
    }
    at("turn").disabled = !this.#box;
    at("turn").value = 0;
  }

  #place(name, value, onPlace) {
    const [left, low, right, high] = this.#box;
    if (name === "turn") return onPlace([(left + right) / 2, (low + high) / 2], [0, 0], 1, value);
    const now = this.#values()[name];
    const wanted = value * MILLIMETRE;
    if (name === "left") return onPlace([left, low], [wanted - now, 0], 1, 0);
    if (name === "low") return onPlace([left, low], [0, wanted - now], 1, 0);
    if (wanted > 0 && now > 0) onPlace([left, low], [0, 0], wanted / now, 0);
  }
}
