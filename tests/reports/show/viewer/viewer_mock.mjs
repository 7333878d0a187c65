// A server in the test's own hands: greets, answers looks with painted frames by the protocol's
// rules, and does what a real one hardly does: goes away, is late, sends nonsense.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { packFrame } from "../../../../reports/show/viewer/web/src/protocol.js";

export const kOrigin = "http://127.0.0.1:8999";
export const kToken = "a-token";
const kDist = new URL("../../../../reports/show/viewer/dist/", import.meta.url);
const kWholeAfter = 200; // ms

const distFile = (name) => readFileSync(new URL(name, kDist), "utf8");

// The document as the server makes it.
function documentOf(title) {
  const parts = {
    "<!--TITLE-->": title,
    "<!--STYLES-->": `<style>${distFile("viewer.css")}</style>`,
    "<!--SCRIPTS-->": `<script>${distFile("viewer.js")}</script>`,
  };
  return Object.entries(parts).reduce(
    (html, [mark, text]) => html.replace(mark, () => text),
    distFile("index.html"),
  );
}

// Paints JPEGs on a canvas of a page of its own.
export class Painter {
  constructor(page) {
    this.page = page;
    this.cache = new Map();
  }

  // A colour with a checkered floor, and a text.
  async jpeg(size, color, text) {
    const key = JSON.stringify([size, color, text]);
    if (!this.cache.has(key)) this.cache.set(key, await this.#paint(size, color, text));
    return this.cache.get(key);
  }

  async #paint(size, color, text) {
    const base64 = await this.page.evaluate(
      ([[width, height], fill, label]) => {
        const canvas = new OffscreenCanvas(width, height);
        const context = canvas.getContext("2d");
        context.fillStyle = fill;
        context.fillRect(0, 0, width, height);
        context.fillStyle = "rgb(0 0 0 / 18%)";
        for (let i = 0; i < 12; ++i)
          for (let j = i % 2; j < 12; j += 2)
            context.fillRect((i * width) / 12, height * (0.6 + j / 30), width / 12, height / 30);
        context.fillStyle = "rgb(255 255 255 / 70%)";
        context.font = `${Math.round(height / 9)}px sans-serif`;
        context.fillText(label, width / 20, height / 2);
        return canvas
          .convertToBlob({ type: "image/jpeg", quality: 0.9 })
          .then((blob) => blob.arrayBuffer())
          .then((bytes) => btoa(String.fromCharCode(...new Uint8Array(bytes))));
      },
      [size, color, text],
    );
    return new Uint8Array(Buffer.from(base64, "base64"));
  }
}

const kColors = { rgb: "#7a8896", depth: "#2a788e", normal: "#8080ff", error: "#3b0f70" };

export class MockServer {
  constructor(painter, hello) {
    Object.assign(this, { painter, hello, messages: [], sockets: 0, inFlight: false });
    this.isAway = false; // sockets are closed at once
    this.isWrongToken = false;
    this.isSilent = false; // looks are not answered
    this.pictures = {}; // "run:layer" -> [color, text]
  }

  async install(page) {
    await page.route(`${kOrigin}/**`, (route) => this.#answer(route));
    await page.routeWebSocket(/\/ws\?/, (socket) => this.#connect(socket));
  }

  url(hash = "") {
    return `${kOrigin}/?token=${kToken}${hash}`;
  }

  async #answer(route) {
    const url = new URL(route.request().url());
    if (this.isWrongToken || url.searchParams.get("token") !== kToken)
      return route.fulfill({ status: 403, body: "403" });
    if (url.pathname === "/photo") {
      const text = `photo ${url.searchParams.get("split")} ${url.searchParams.get("index")}`;
      const body = Buffer.from(await this.painter.jpeg(this.hello.size, "#96866a", text));
      return route.fulfill({ contentType: "image/jpeg", body });
    }
    return route.fulfill({ contentType: "text/html", body: documentOf(this.hello.title) });
  }

  #connect(socket) {
    assert.equal(new URL(socket.url()).searchParams.get("token"), kToken);
    if (this.isAway || this.isWrongToken) return socket.close({ code: 4000, reason: "away" });
    this.sockets += 1;
    this.inFlight = false;
    this.socket = socket;
    clearTimeout(this.timer); // of a page that has gone
    this.next = null;
    socket.onMessage((text) => this.#receive(JSON.parse(text)));
    this.tell(this.hello);
  }

  tell(message) {
    this.socket.send(JSON.stringify(message));
  }

  drop() {
    this.socket.close({ code: 4000, reason: "gone" });
  }

  #receive(message) {
    this.messages.push(message);
    if (message.type === "look") this.#look(message);
    if (message.type === "shown") {
      this.inFlight = false;
      this.#flush();
    }
    if (message.type === "probe") this.#probe(message);
    if (message.type === "pick") this.tell({ type: "pick", point: [0.5, 0.25, 1] });
  }

  #look(look) {
    this.look = look;
    clearTimeout(this.timer);
    if (this.isSilent) return;
    const [width, height] = look.size;
    this.next = { look, whole: false, size: [Math.ceil(width / 2), Math.ceil(height / 2)] };
    this.#flush();
    this.timer = setTimeout(() => {
      this.next = { look, whole: true, size: look.size };
      this.#flush();
    }, kWholeAfter);
  }

  // One frame in flight; what came in the meantime is the newest alone.
  async #flush() {
    if (this.inFlight || !this.next) return;
    const { look, whole, size } = this.next;
    this.next = null;
    this.inFlight = true;
    await this.frame(look, { whole, size });
  }

  // The last look has its whole frame, and the page has shown it.
  isSettled() {
    const { look, next, inFlight, sent } = this;
    return !next && !inFlight && look && sent?.whole && sent.serial === look.serial;
  }

  // A frame for a look, whatever is in flight.
  async frame(look, { whole = true, size = look.size, iteration = null, color } = {}) {
    const { socket } = this;
    const images = [];
    for (const { run, layer } of look.panes) {
      const text = `${this.hello.runs[run].title} ${layer}`;
      images.push(await this.painter.jpeg(size, color ?? kColors[layer] ?? "#707070", text));
    }
    const numbers = { ms: 12.3, pixels_per_second: 2.6e6, surfels: 90930, iteration };
    const header = { type: "frame", serial: look.serial, whole, size, ...numbers };
    if (socket !== this.socket) return; // painted for a page that has gone meanwhile
    this.sent = header;
    socket.send(Buffer.from(packFrame(header, images)));
  }

  raw(bytes) {
    this.socket.send(Buffer.from(bytes));
  }

  #probe({ serial, x, y }) {
    const [width, height] = this.look.size;
    const panes = this.look.panes.map(({ run }) => ({
      run,
      values: { rgb: [0.5, 0.25, x], depth: 2.5 + run, normal: [0, -1, 0], transparency: null },
    }));
    const truth = this.look.view ? { rgb: [0.125, 0.25, 0.375], depth: 2 } : null;
    const pixel = { x: Math.floor(x * width), y: Math.floor(y * height) };
    this.tell({ type: "probe", serial, ...pixel, size: [width, height], panes, truth });
  }

  of(type) {
    return this.messages.filter((message) => message.type === type);
  }

  last(type) {
    return this.of(type).at(-1);
  }
}
