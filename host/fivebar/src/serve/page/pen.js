// The sliders of the pen's heights. The servo follows them while the motors are off.

const INTERVAL = 100; // ms between two requests of a height
const SETTLES = 500; // ms after which a slider shows what the server has
const MILLISECOND = 1e-3;
const HEIGHTS = ["up", "down"];

const at = (id) => document.getElementById(id);

export class PenHeights {
  #timers = {}; // of the requests that wait, by height
  #touched = -SETTLES; // when a slider was last moved [ms]

  // `onHold` gets the height, "up" or "down", and the width of the pulse [s].
  constructor(onHold) {
    for (const pen of HEIGHTS) {
      const slider = at(`pen-${pen}`);
      slider.oninput = () => {
        this.#touched = performance.now();
        this.#write(pen, Number(slider.value));
        this.#timers[pen] ??= setTimeout(() => {
          this.#timers[pen] = null;
          onHold(pen, Number(slider.value) * MILLISECOND);
        }, INTERVAL);
      };
    }
  }

  // Shows the widths of a state [s]; null without a servo.
  show(widths) {
    at("pen-heights").hidden = widths === null;
    if (widths === null || performance.now() - this.#touched < SETTLES) return;
    HEIGHTS.forEach((pen, index) => this.#write(pen, widths[index] / MILLISECOND));
  }

  #write(pen, width) {
    const slider = at(`pen-${pen}`);
    const text = `${width.toFixed(2)} ms`;
    if (slider.ariaValueText === text) return;
    // The file may have a width beyond the usual ones.
    slider.min = Math.min(slider.min, width);
    slider.max = Math.max(slider.max, width);
    slider.value = width;
    slider.ariaValueText = at(`pen-${pen}-value`).textContent = text;
  }
}
