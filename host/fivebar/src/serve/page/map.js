// The map of the workspace under the arm: condition number and singularities.
import { colour } from "./colour.js";
import { bordered, region, smoothed } from "./regions.js";

// The codes of cells, as in maps.rs.
const OUTSIDE = -1;
const FORBIDDEN = 200;

const STEPS = 10;
const QUIET = 0.68; // share of the paper in the colours
const PALE = 0.9; // the same, for cells that are not allowed
// Ten colours of viridis, those of the picture of a workspace.
const VIRIDIS = ["#440154", "#482878", "#3e4989", "#31688e", "#26828e",
  "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"];

export class WorkspaceMap {
  #maps;
  #map = null; // of the chosen branch
  #regions = null; // its regions
  #picture = document.createElement("canvas");
  #painted = ""; // what the picture shows now
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
    this.#regions = null;
    this.paint();
  }

  // The colours of the steps, from the worst to the best, with a share of the paper.
  #ramp(share) {
    const paper = channels(colour("--stage"));
    return VIRIDIS.map(channels).map((step) =>
      `rgb(${step.map((part, i) => Math.round(part + share * (paper[i] - part)))})`);
  }

  // Colours for a legend.
  get legend() {
    return this.#ramp(QUIET);
  }

  // Has the map painted anew; call it when the style sheet's colours change.
  paint() {
    this.#painted = "";
  }

  // What can be reached, what is allowed, and where the condition reaches each step but the first.
  #trace() {
    const { cells, columns } = this.#map;
    const values = (value) => bordered(cells, columns, value);
    const wide = columns + 2;
    const condition = values((code) => Math.max(0, code % FORBIDDEN));
    this.#regions = {
      reach: region(smoothed(values((code) => code !== OUTSIDE), wide), wide, 0.5),
      allowed: region(smoothed(values((code) => code !== OUTSIDE && code < FORBIDDEN), wide), wide, 0.5),
      steps: Array.from({ length: STEPS - 1 }, (_, i) => region(condition, wide, ((i + 1) * 100) / STEPS)),
    };
  }

  // Paints the picture of the map for a canvas; `corners` are the pixels of the grid's corners.
  #paintFor(canvas, ratio, [left, bottom, right, top]) {
    if (!this.#regions) this.#trace();
    const { reach, allowed, steps } = this.#regions;
    const columns = this.#map.columns, rows = this.#map.cells.length / columns;
    const [across, up] = [(right - left) / columns, (top - bottom) / rows];
    Object.assign(this.#picture, { width: canvas.width, height: canvas.height });
    const context = this.#picture.getContext("2d");
    context.scale(ratio, ratio);
    // The middle of the border's first cell is half a cell before the corner.
    context.transform(across, 0, 0, up, left - across / 2, bottom - up / 2);
    const fill = (first, ramp) => [first, ...steps].forEach((step, i) => {
      context.fillStyle = ramp[i];
      context.fill(step);
    });
    context.clip(reach);
    fill(reach, this.#ramp(PALE));
    context.clip(allowed);
    fill(allowed, this.#ramp(QUIET));
  }

  // Draws the map: `pixel` gives the pixel of a position, `line` draws a curve.
  draw(context, pixel, line) {
    if (!this.#map || !this.shown) return;
    const { low, high, type1, type2 } = this.#map;
    const { canvas } = context, ratio = context.getTransform().a;
    const corners = [...pixel(low), ...pixel(high)];
    const wanted = [ratio, canvas.width, canvas.height, ...corners].join();
    if (this.#painted !== wanted) this.#paintFor(canvas, ratio, corners);
    this.#painted = wanted;
    context.drawImage(this.#picture, 0, 0, canvas.width / ratio, canvas.height / ratio);
    for (const curve of type1) line(curve, "--edge", 1.5);
    context.setLineDash([6, 4]);
    for (const curve of type2) line(curve, "--drawn", 1.5);
    context.setLineDash([]);
  }
}

// Red, green and blue of a colour such as #1d2430.
const channels = (hex) => [1, 3, 5].map((start) => parseInt(hex.slice(start, start + 2), 16));
