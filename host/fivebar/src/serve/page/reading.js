// The fields of how files are read where they leave it open. An empty field leaves it to the file.

const at = (name) => document.getElementById(`read-${name}`);
const LENGTHS = ["hatch", "speed", "pen_height", "gap", "margin"];
const FIELDS = [...LENGTHS, "trace", "level", "columns", "rows"];
// What a picture becomes, from left to right. No list of the browser: it would take the Esc of an emergency stop.
const TRACES = [[null, "outline"], ["centre-line", "centre line"], ["tone", "lines by tone"], ["stipple", "dots"],
  ["one-line", "one line"]];
const MILLIMETRE = 1e-3;
const PERCENT = 1e-2;

// The values of the fields [m, m/s, shares], null for empty ones.
function values() {
  const number = (name, unit) => (at(name).value === "" ? null : Number(at(name).value) * unit);
  const copies = ["columns", "rows"].map((name) => number(name, 1));
  return {
    ...Object.fromEntries(LENGTHS.map((name) => [name, number(name, MILLIMETRE)])),
    trace: TRACES[at("trace").value][0],
    level: number("level", PERCENT) || null,
    copies: copies.every((count) => count === null) ? null : copies.map((count) => count ?? 1),
  };
}

// `onRead` gets the values when one has changed.
export function listenToReading(onRead) {
  for (const name of FIELDS) at(name).addEventListener("change", () => onRead(values()));
}

// Shows how the loaded file was read.
export function showReading(reading) {
  for (const name of LENGTHS) {
    at(name).value = reading[name] === null ? "" : Number((reading[name] / MILLIMETRE).toFixed(4));
  }
  const trace = TRACES.findIndex(([name]) => name === (reading.trace === "outline" ? null : reading.trace));
  at("trace").value = trace;
  document.getElementById("trace-name").textContent = TRACES[trace][1];
  at("level").value = reading.level === null ? 0 : Math.round(reading.level / PERCENT);
  [at("columns").value, at("rows").value] = reading.copies ?? ["", ""];
}
