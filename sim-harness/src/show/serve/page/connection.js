// The line to the server. It tells that this page lives, notices when the server falls
// silent, connects again, and keeps an emergency stop until it can be sent.

const SILENCE = 3000; // ms after which the server counts as lost
const RETRY = 1000; // ms

export class Connection {
  #socket = null;
  #heard = 0; // when the server was heard last, or when it was called
  #emergency = false; // an emergency stop waits to be sent
  onNews = () => {};
  onLost = () => {};

  open() {
    new Worker("clock.js").onmessage = () => this.#tick();
    this.#connect();
  }

  #connect() {
    const socket = new WebSocket(`ws://${location.host}/live`);
    this.#socket = socket;
    this.#heard = performance.now();
    socket.onopen = () => { if (this.#emergency) this.emergencyStop(); };
    socket.onmessage = (event) => {
      this.#heard = performance.now();
      this.onNews(JSON.parse(event.data));
    };
    socket.onclose = () => this.#lose(socket);
  }

  #lose(socket) {
    if (socket !== this.#socket) return;
    this.#socket = null;
    this.onLost();
    setTimeout(() => this.#connect(), RETRY);
  }

  #tick() {
    this.send("alive");
    const socket = this.#socket;
    if (socket && performance.now() - this.#heard > SILENCE) {
      this.#lose(socket);
      socket.close();
    }
  }

  // Whether it went out.
  send(wish) {
    if (this.#socket?.readyState !== WebSocket.OPEN) return false;
    this.#socket.send(JSON.stringify(wish));
    return true;
  }

  // Whether it went out; if not, it will as soon as there is a connection.
  emergencyStop() {
    this.#emergency = !this.send({ request: "emergency_stop" });
    return !this.#emergency;
  }
}
