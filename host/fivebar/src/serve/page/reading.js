// The fields of how files are read where they leave it open. An empty field leaves it to the file.

const at = (name) => document.getElementById(`read-${name}`);
const NAMES = ["hatch", "speed", "pen_height"];
const MILLIMETRE = 1e-3;

// `onRead` gets the values [m, m/s], null for empty fields.
export function listenToReading(onRead) {
  const value = (name) => (at(name).value === "" ? null : Number(at(name).value) * MILLIMETRE);
  for (const name of NAMES) {
    at(name).addEventListener("change", () => onRead(Object.fromEntries(NAMES.map((each) => [each, value(each)]))));
  }
}

// Shows how the loaded file was read.
export function showReading(reading) {
  for (const name of NAMES) at(name).value = reading[name] === null ? "" : Number((reading[name] / MILLIMETRE).toFixed(4));
}
