// Regions of a grid of values as outlines, so that they are sharp at every zoom.

// A grid with a border of cells around it, with values by a function of a cell's code; the border has 0.
export function bordered(codes, columns, value) {
  const wide = columns + 2, rows = codes.length / columns;
  const values = new Float32Array(wide * (rows + 2));
  codes.forEach((code, index) => {
    values[(Math.floor(index / columns) + 1) * wide + (index % columns) + 1] = value(code);
  });
  return values;
}

// A grid of zeros and ones whose steps between neighbours are smoothed: each value with half the weight
// of its neighbours, along both axes.
export function smoothed(values, columns) {
  for (const step of [1, columns]) {
    const old = values.slice();
    for (let i = step; i + step < values.length; i += 1) values[i] = (old[i - step] + 2 * old[i] + old[i + step]) / 4;
  }
  return values;
}

// Where the values, linear between the cells' middles, are at least `level`. The path's coordinates are
// columns and rows.
export function region(values, columns, level) {
  const path = new Path2D();
  const rows = values.length / columns;
  for (let row = 0; row + 1 < rows; row += 1) {
    let start = null; // of a run of squares that lie inside
    for (let column = 0; column < columns; column += 1) {
      const low = row * columns + column, high = low + columns;
      const corners = column + 1 < columns
        ? [values[low], values[low + 1], values[high + 1], values[high]].map((value) => value - level) : [-1, -1, -1, -1];
      if (corners.every((value) => value >= 0)) {
        start ??= column;
        continue;
      }
      if (start !== null) path.rect(start, row, column - start, 1);
      start = null;
      if (corners.some((value) => value >= 0)) addPart(path, column, row, corners);
    }
  }
  return path;
}

const CORNERS = [[0, 0], [1, 0], [1, 1], [0, 1]];

// Adds the part of a square that lies inside; `values` are those of its corners, 0 at the edge.
function addPart(path, column, row, values) {
  const points = [];
  CORNERS.forEach(([x, y], i) => {
    const next = (i + 1) % 4, [value, other] = [values[i], values[next]];
    if (value >= 0) points.push([x, y]);
    if (value >= 0 === other >= 0) return;
    const share = value / (value - other);
    points.push([x + share * (CORNERS[next][0] - x), y + share * (CORNERS[next][1] - y)]);
  });
  points.forEach(([x, y], i) => path[i === 0 ? "moveTo" : "lineTo"](column + x, row + y));
  path.closePath();
}
