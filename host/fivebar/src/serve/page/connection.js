// The connection to the server. It sends signs of life, detects a lost server, connects again,
// and repeats an emergency stop until the server has confirmed it.

const TIMEOUT = 3000; // ms without a message after which the server counts as lost
const STALL = 1000; // ms between two ticks after which the page itself stood still
const RETRY = 1000; // ms
const REPEAT = 200; // ms after which an emergency stop without confirmation is sent again

const MOVING = ["Running", "Homing", "Stopping", "Crossing", "Exciting", "Compliant"];

// Whether the arm moves in this state.
export const isMoving = ({ state }) => MOVING.includes(state);

export class Connection {
  #socket = null;
  #received = 0; // time of the last message, or of the attempt to connect [ms]
  #ticked = 0; // time of the last tick [ms]
  #asked = null; // when the emergency stop was asked for that is not confirmed yet [ms]
  #latest = {}; // the latest message of each kind
  #number = 0; // of the last request that has one
  #onMessage = null;
  #onLost = () => {};
  // Called again and again while an emergency stop is not confirmed, with the time since it was asked
  // for [ms]; and when it is.
  onUnconfirmed = () => {};
  onConfirmed = () => {};

  open() {
    new Worker("clock.js").onmessage = () => this.#tick();
    this.#connect();
  }

  // Passes on what has come while the page was loading, and then every message.
  deliver(onMessage, onLost) {
    this.#onMessage = onMessage;
    this.#onLost = onLost;
    for (const [kind, content] of Object.entries(this.#latest)) onMessage({ [kind]: content });
  }

  get isOpen() {
    return this.#socket?.readyState === WebSocket.OPEN;
  }

  // Whether the arm moves, or may move because its state is not known.
  get mayMove() {
    const { state, guide } = this.#latest;
    if (!this.isOpen || !(state || guide)) return true;
    return guide ? Boolean(guide.running) : isMoving(state);
  }

  #connect() {
    const socket = new WebSocket(`ws://${location.host}/live`);
    this.#socket = socket;
    this.#received = performance.now();
    socket.onopen = () => this.#sendStop();
    socket.onmessage = (event) => this.#receive(JSON.parse(event.data));
    socket.onclose = ({ reason }) => this.#lose(socket, reason);
  }

  #receive(message) {
    this.#received = performance.now();
    if (message.stopped === "emergency_stop" && this.#asked !== null) {
      this.#asked = null;
      this.onConfirmed();
    }
    Object.assign(this.#latest, message);
    this.#onMessage?.(message);
  }

  #lose(socket, reason = "") {
    if (socket !== this.#socket) return;
    this.#socket = null;
    this.#onLost(reason);
    setTimeout(() => this.#connect(), RETRY);
  }

  #tick() {
    this.send("alive");
    const socket = this.#socket;
    const now = performance.now();
    // What the server sent while the page stood still may wait behind this tick.
    if (now - this.#ticked > STALL) this.#received = now;
    this.#ticked = now;
    if (socket && now - this.#received > TIMEOUT) {
      this.#lose(socket);
      socket.close();
    }
  }

  // Sends a request; returns its number, or false if it was not sent. One with content is sent with its number.
  send(request) {
    if (!this.isOpen) return false;
    const number = ++this.#number;
    this.#socket.send(JSON.stringify(typeof request === "string" ? request : { ...request, number }));
    return number;
  }

  // Renews the held motion that the request with this number began.
  renew(number) {
    if (this.isOpen) this.#socket.send(JSON.stringify({ renew: number }));
  }

  // Sends an emergency stop, again and again until it is confirmed.
  emergencyStop() {
    if (this.#asked !== null) return;
    this.#asked = performance.now();
    this.#repeatStop();
  }

  #repeatStop() {
    if (this.#asked === null) return;
    this.#sendStop();
    this.onUnconfirmed(performance.now() - this.#asked);
    setTimeout(() => this.#repeatStop(), REPEAT);
  }

  #sendStop() {
    if (this.#asked !== null) this.send({ request: "emergency_stop" });
  }
}
