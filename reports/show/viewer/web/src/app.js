// What the page shows and asks for: the state, the messages that follow from it, what came back.
import { addressOf, keepAddress } from "../../../page/web/src/address.js";
import { levelled } from "./camera.js";
import { cameraOfLook, lookOf, sawView, shownLayer, viewOf } from "./look.js";
import { Prober } from "./prober.js";
import { addressValues, firstRig, upOf } from "./state.js";

const kMostLooks = 64; // of which it is kept what they asked for

export class App {
  // stage(): [width, height] of the window's part for the picture, device pixels
  constructor(hello, state, connection, stage) {
    Object.assign(this, { hello, state, connection, stage });
    this.listeners = new Set(); // called after each change, once a frame of the browser
    this.looks = new Map(); // serial -> {look, sent (ms)}
    this.side = "left"; // which the layer keys are for
    this.keys = []; // of the path: {pose, fov}
    this.shown = null; // {header, look, camera, latency}
    this.prober = new Prober(this);
    this.probe = null; // its last answer
    this.training = null; // the last word of it
    this.video = null;
    this.saved = null; // the answer to a path
  }

  changed() {
    this.waiting ??= requestAnimationFrame(() => this.#flush());
  }

  #flush() {
    this.waiting = null;
    this.#sendLook();
    keepAddress("view", addressValues(this.hello, this.state));
    this.listeners.forEach((listener) => listener(this));
  }

  stop() {
    this.stopped = true;
    cancelAnimationFrame(this.waiting);
    this.listeners.clear();
  }

  address() {
    return addressOf("view", addressValues(this.hello, this.state));
  }

  set(values) {
    Object.assign(this.state, values);
    this.changed();
  }

  // --- the camera

  // Any motion leaves a view that was snapped to.
  moveRig(rig) {
    this.set({ rig, view: null });
  }

  change(values) {
    this.set({ rig: { ...this.state.rig, ...values } });
  }

  setFov(fov) {
    this.moveRig({ ...this.state.rig, fov });
  }

  reset() {
    this.set({ up: "scene" });
    this.moveRig(firstRig(this.hello, this.state.rig.mode));
  }

  setUp(name) {
    const up = upOf(this.hello, name);
    this.set({ up: name });
    this.moveRig({ ...this.state.rig, up, pose: levelled(this.state.rig.pose, up) });
  }

  level() {
    const { rig } = this.state;
    this.moveRig({ ...rig, pose: levelled(rig.pose, rig.up) });
  }

  toggleMode() {
    this.change({ mode: this.state.rig.mode === "fly" ? "orbit" : "fly" });
  }

  // {split, index}, or null: the camera stays and is free.
  snap(view) {
    if (!view) return this.set({ view: null });
    const seen = sawView(viewOf(this.hello, view));
    const { split, index } = view;
    this.lastView = { split, index };
    this.set({ view: this.lastView, rig: { ...this.state.rig, ...seen } });
  }

  // The next view of the same split, or the one before.
  step(direction) {
    const from = this.state.view ?? this.lastView;
    const { views: all } = this.hello;
    const split = from?.split ?? (all.some((view) => view.split === "test") ? "test" : "train");
    const views = all.filter((view) => view.split === split);
    if (views.length === 0) return;
    const at = views.findIndex(({ index }) => index === from?.index);
    const next = at < 0 ? 0 : (at + direction + views.length) % views.length;
    this.snap(this.state.view || at < 0 ? views[next] : views[at]);
  }

  // --- panes and layers

  pane(side = this.side) {
    return this.state[side];
  }

  setPane(side, values) {
    this.set({ [side]: { ...this.state[side], ...values } });
  }

  setRun(side, run) {
    const { layers } = this.hello.runs[run];
    const layer = this.state[side]?.layer ?? this.state.left.layer;
    const known = layers.some(({ id }) => id === layer);
    this.set({ [side]: { run, layer: known ? layer : layers[0].id } });
  }

  // null: nothing, "photo", or a run.
  setRight(what) {
    this.side = "left";
    if (what === null) return this.set({ right: null });
    if (what === "photo") return this.set({ right: { photo: true } });
    this.side = "right";
    this.setRun("right", what);
  }

  toggleSide() {
    if (!this.state.right || this.state.right.photo) return;
    this.side = this.side === "left" ? "right" : "left";
    this.changed();
  }

  layersOf(side = this.side) {
    return this.hello.runs[this.state[side].run].layers;
  }

  setLayer(number, side = this.side) {
    const layer = this.layersOf(side)[number];
    if (layer && (!layer.needs_view || this.state.view)) this.setPane(side, { layer: layer.id });
  }

  layerOf(side = this.side) {
    return shownLayer(this.hello, this.state[side], this.state.view);
  }

  runTitle(index) {
    const { runs } = this.hello;
    const isOnly = runs.filter(({ title }) => title === runs[index].title).length === 1;
    return isOnly ? runs[index].title : runs[index].name;
  }

  // Runs that are shown.
  shownRuns() {
    const panes = [this.state.left, this.state.right].filter((pane) => pane && !pane.photo);
    return [...new Set(panes.map(({ run }) => run))].map((run) => this.hello.runs[run]);
  }

  // --- messages

  #sendLook() {
    const look = lookOf(this.hello, this.state, this.stage());
    const text = JSON.stringify(look);
    if (text === this.sent) return;
    const serial = this.connection.serial + 1;
    if (!this.connection.send({ ...look, serial })) return;
    this.sent = text;
    this.connection.serial = serial;
    this.looks.set(serial, { look, sent: performance.now() });
    for (const old of this.looks.keys()) {
      if (this.looks.size <= kMostLooks) break;
      this.looks.delete(old);
    }
  }

  // A greeting: of a server that was away, and knows of no look, or because a training has more
  // layers than before.
  greet(hello, isNew) {
    this.hello = hello;
    if (isNew) this.sent = null;
    this.changed();
  }

  frameShown(header) {
    const asked = this.looks.get(header.serial);
    const look = asked?.look ?? this.shown?.look;
    for (const old of this.looks.keys()) if (old < header.serial) this.looks.delete(old);
    this.shown = {
      ...{ header, look },
      camera: look && cameraOfLook(this.hello, look),
      latency: asked && !asked.answered ? performance.now() - asked.sent : this.shown?.latency,
    };
    if (asked) asked.answered = true;
    if (header.whole) this.prober.ask();
    this.changed();
  }

  // The pointer is at u, v (shares of the picture), or null: gone.
  point(at) {
    this.pointer = at;
    if (!at) this.probe = null;
    this.prober.ask();
    this.changed();
  }

  pick([x, y]) {
    if (this.shown) this.connection.send({ type: "pick", x, y });
  }

  receive(message) {
    if (message.type === "probe") this.probe = this.pointer ? message : null;
    if (message.type === "state") this.training = message;
    if (message.type === "path") this.saved = message;
    if (message.type === "video") this.video = message;
    if (message.type === "error" && !this.video?.of) this.video = null; // it did not begin
    if (message.type === "pick" && message.point) this.change({ pivot: message.point });
    this.changed();
  }
}
