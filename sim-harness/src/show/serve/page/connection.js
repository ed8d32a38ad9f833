// The connection to the server. It sends signs of life, detects a lost server, connects
// again, and keeps an emergency stop until it can be sent.

const TIMEOUT = 3000; // ms without a message after which the server counts as lost
const RETRY = 1000; // ms

export class Connection {
  #socket = null;
  #received = 0; // time of the last message, or of the attempt to connect [ms]
  #emergency = false; // an emergency stop waits to be sent
  onMessage = () => {};
  onLost = () => {};

  open() {
    new Worker("clock.js").onmessage = () => this.#tick();
    this.#connect();
  }

  #connect() {
    const socket = new WebSocket(`ws://${location.host}/live`);
    this.#socket = socket;
    this.#received = performance.now();
    socket.onopen = () => { if (this.#emergency) this.emergencyStop(); };
    socket.onmessage = (event) => {
      this.#received = performance.now();
      this.onMessage(JSON.parse(event.data));
    };
    socket.onclose = ({ reason }) => this.#lose(socket, reason);
  }

  #lose(socket, reason = "") {
    if (socket !== this.#socket) return;
    this.#socket = null;
    this.onLost(reason);
    setTimeout(() => this.#connect(), RETRY);
  }

  #tick() {
    this.send("alive");
    const socket = this.#socket;
    if (socket && performance.now() - this.#received > TIMEOUT) {
      this.#lose(socket);
      socket.close();
    }
  }

  // Sends a request; returns whether it was sent.
  send(request) {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(request));
    return true;
  }

  // Sends an emergency stop, or keeps it until there is a connection; returns whether it was
  // sent.
  emergencyStop() {
    this.#emergency = !this.send({ request: "emergency_stop" });
    return !this.#emergency;
  }
}
