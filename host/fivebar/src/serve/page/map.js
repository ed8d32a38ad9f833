// The map of the workspace under the arm: condition number and singularities.
import { colour } from "./colour.js";

// The codes of cells, as in maps.rs.
const OUTSIDE = -1;
const FORBIDDEN = 200;

const STEPS = 10;
const PALE = 0.62; // share of the paper in the colour of cells that are not allowed
// Ten colours of viridis, those of the picture of a workspace.
const VIRIDIS = ["#440154", "#482878", "#3e4989", "#31688e", "#26828e",
  "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"];

export class WorkspaceMap {
  #maps;
  #map = null; // of the chosen branch
  #picture = document.createElement("canvas");
  shown = true;

  constructor(maps) {
    this.#maps = maps;
  }

  // Lower left and upper right corner of all that can be reached [m].
  get box() {
    const { low, high } = this.#maps[0];
    return [...low, ...high];
  }

  // The branch by its elbows, such as "right,left".
  choose(elbows) {
    this.#map = this.#maps.find((map) => String(map.elbows) === elbows) ?? null;
    this.paint();
  }

  // The colours of the steps, from the worst to the best, and what pale ones are mixed with.
  get #ramp() {
    return VIRIDIS.map(channels);
  }

  // Colours for a legend.
  get legend() {
    return this.#ramp.map((channels) => `rgb(${channels})`);
  }

  // Draws the map's picture; call it again when the style sheet's colours change.
  paint() {
    if (!this.#map) return;
    const { cells, columns } = this.#map;
    const rows = cells.length / columns;
    Object.assign(this.#picture, { width: columns, height: rows });
    const context = this.#picture.getContext("2d");
    const image = context.createImageData(columns, rows);
    const ramp = this.#ramp;
    const paper = channels(colour("--paper"));
    const pale = ramp.map((step) => step.map((part, i) => Math.round(part + PALE * (paper[i] - part))));
    cells.forEach((cell, index) => {
      if (cell === OUTSIDE) return;
      const forbidden = cell >= FORBIDDEN;
      const condition = forbidden ? cell - FORBIDDEN : cell;
      const step = Math.min(STEPS - 1, Math.floor((condition * STEPS) / 100));
      // The picture's rows begin at the top.
      const pixel = (rows - 1 - Math.floor(index / columns)) * columns + (index % columns);
      image.data.set([...(forbidden ? pale : ramp)[step], 255], 4 * pixel);
    });
    context.putImageData(image, 0, 0);
  }

  // Draws the map: `pixel` gives the pixel of a position, `line` draws a curve.
  draw(context, pixel, line) {
    if (!this.#map || !this.shown) return;
    const { low, high, type1, type2 } = this.#map;
    const [left, bottom] = pixel(low), [right, top] = pixel(high);
    context.imageSmoothingEnabled = false;
    context.drawImage(this.#picture, left, top, right - left, bottom - top);
    for (const curve of type1) line(curve, "--quiet", 1.5);
    context.setLineDash([6, 4]);
    for (const curve of type2) line(curve, "--drawn", 1.5);
    context.setLineDash([]);
  }
}

// Red, green and blue of a colour such as #1d2430.
const channels = (hex) => [1, 3, 5].map((start) => parseInt(hex.slice(start, start + 2), 16));
