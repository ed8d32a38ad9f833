// The fields of how files are read where they leave it open. An empty field leaves it to the file.

const at = (name) => document.getElementById(`read-${name}`);
const LENGTHS = ["hatch", "speed", "pen_height", "gap"];
const FIELDS = [...LENGTHS, "trace", "level", "columns", "rows"];
const MILLIMETRE = 1e-3;
const PERCENT = 1e-2;

// The values of the fields [m, m/s, shares], null for empty ones.
function values() {
  const number = (name, unit) => (at(name).value === "" ? null : Number(at(name).value) * unit);
  const copies = ["columns", "rows"].map((name) => number(name, 1));
  return {
    ...Object.fromEntries(LENGTHS.map((name) => [name, number(name, MILLIMETRE)])),
    trace: at("trace").value || null,
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
  at("trace").value = reading.trace ?? "";
  at("level").value = reading.level === null ? 0 : Math.round(reading.level / PERCENT);
  [at("columns").value, at("rows").value] = reading.copies ?? ["", ""];
}
