// What the last run did at the place under the pointer: how far off, how fast, at which line, when.

const NEAR = 12; // px from the pointer

export class Inspect {
  #drawing;
  #recording;
  #label;

  constructor(canvas, drawing, recording, label) {
    this.#drawing = drawing;
    this.#recording = recording;
    this.#label = label;
    const show = (event) => { if (event.buttons === 0 || event.pointerType === "touch") this.#show(event); };
    canvas.addEventListener("pointermove", show);
    canvas.addEventListener("pointerdown", show);
    canvas.addEventListener("pointerleave", () => { label.hidden = true; });
  }

  #show(event) {
    const drawing = this.#drawing;
    const found = drawing.colouring === "pen" ? null
      : this.#recording.nearest(drawing.position(event), NEAR / drawing.pixelsPerMetre);
    this.#label.hidden = found === null;
    if (found === null) return;
    const { error, speed, line, since } = found;
    const corner = this.#label.parentElement.getBoundingClientRect();
    this.#label.style.left = `${event.clientX - corner.left + 12}px`;
    this.#label.style.top = `${event.clientY - corner.top + 12}px`;
    this.#label.textContent = `${(1e6 * error).toFixed(0)} µm off · ${(1e3 * speed).toFixed(0)} mm/s`
      + `${line === null ? "" : ` · line ${line}`} · after ${since.toFixed(2)} s`;
  }
}
