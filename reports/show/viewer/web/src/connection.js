// The WebSocket to the server, which comes back after a loss.
import { waitAfter } from "./protocol.js";

const kToken = new URLSearchParams(location.search).get("token") ?? "";

// Of the same server, with the token.
export function serverUrl(path, values = {}) {
  return `${path}?${new URLSearchParams({ ...values, token: kToken })}`;
}

function socketUrl() {
  const url = new URL(serverUrl("/ws"), location.href);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  return url.href;
}

// Browsers do not say why a WebSocket was refused; a plain request does.
async function isTokenWrong() {
  try {
    return (await fetch(serverUrl("/"), { cache: "no-store" })).status === 403;
  } catch {
    return false; // nobody answers
  }
}

export class Connection {
  // onMessage(object); onFrame(ArrayBuffer); onStatus(status, ms to the next try), of which the
  // status is "open", "lost" or "refused"
  constructor({ onMessage, onFrame, onStatus }) {
    Object.assign(this, { onMessage, onFrame, onStatus, failures: 0 });
  }

  open() {
    clearTimeout(this.timer);
    const socket = new WebSocket(socketUrl());
    socket.binaryType = "arraybuffer";
    socket.onopen = () => this.onStatus("open");
    socket.onmessage = ({ data }) => this.#receive(data);
    socket.onclose = () => socket === this.socket && this.#lost();
    this.socket = socket;
  }

  // False: nobody is there; what matters is said again after the greeting.
  send(message) {
    if (this.socket?.readyState !== WebSocket.OPEN) return false;
    this.socket.send(JSON.stringify(message));
    return true;
  }

  #receive(data) {
    if (typeof data !== "string") return this.onFrame(data);
    const message = JSON.parse(data);
    if (message.type === "hello") this.failures = 0;
    this.onMessage(message);
  }

  async #lost() {
    this.socket = null;
    this.failures += 1;
    if (await isTokenWrong()) return this.onStatus("refused");
    const wait = waitAfter(this.failures);
    this.onStatus("lost", wait);
    this.timer = setTimeout(() => this.open(), wait);
  }
}
