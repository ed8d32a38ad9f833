// The console: lines of G-code and their answers, with the lines before at the arrow keys.

const LINES = 200; // lines and answers that are shown
const HISTORY = 100; // lines that come back

export class Console {
  #input = document.getElementById("console");
  #log = document.getElementById("console-log");
  #history = [];
  #at = 0; // the line of the history that is shown; its length: a new one
  #draft = "";
  #send;

  // `send` gets a line; it returns whether the line was sent.
  constructor(send) {
    this.#send = send;
    this.#input.addEventListener("keydown", (event) => {
      const step = { ArrowUp: -1, ArrowDown: 1 }[event.key];
      if (event.key === "Enter" && !event.isComposing && !event.repeat) this.send();
      else if (step) this.#recall(step);
      else return;
      event.preventDefault();
    });
  }

  send() {
    const line = this.#input.value.trim();
    if (!line || !this.#send(line)) return;
    this.#show(`> ${line}`);
    if (this.#history.at(-1) !== line) this.#history.push(line);
    if (this.#history.length > HISTORY) this.#history.shift();
    this.#at = this.#history.length;
    this.#draft = this.#input.value = "";
  }

  #recall(step) {
    const at = this.#at + step;
    if (at < 0 || at > this.#history.length) return;
    if (this.#at === this.#history.length) this.#draft = this.#input.value;
    this.#at = at;
    this.#input.value = this.#history[at] ?? this.#draft;
    this.#input.setSelectionRange(this.#input.value.length, this.#input.value.length);
  }

  answer(text) {
    this.#show(text.trimEnd());
  }

  #show(text) {
    this.#log.append(`${text}\n`);
    while (this.#log.childNodes.length > LINES) this.#log.firstChild.remove();
    this.#log.scrollTop = this.#log.scrollHeight;
  }
}
