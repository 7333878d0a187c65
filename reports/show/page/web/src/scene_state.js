// What the scene view shows; kept while other views are open.
import { runKey, runOfKey, sceneKey } from "./data.js";
import { kOrders } from "./frames.js";
import { chosenKeys, hiddenKeys } from "./method_choice.js";
import { outlinePath } from "./outline.js";
import { Transform } from "./transform.js";

const reducedMotion = () => window.matchMedia("(prefers-reduced-motion: reduce)").matches;

export const kModes = [
  ["slider", "Slider", "two pictures and a divider (s)"],
  ["flicker", "Flicker", "two pictures in turn (f)"],
  ["grid", "Grid", "all methods (g)"],
];

// What is chosen in any scene.
const start = () => ({
  metric: "psnr",
  order: "worst",
  layerId: "rgb",
  mode: "slider",
  split: 50,
  outline: false,
  flickerRuns: !reducedMotion(),
});

const ids = (choices) => choices.map(([id]) => id);

export class SceneState {
  index = -1;
  scene = null;
  view = 0;
  run = 0;
  left = -1;
  right = 0;
  hiddenRuns = new Set();
  transform = new Transform();
  values = null;
  pixel = null;
  pinned = false;
  onChange = () => {};
  onKeep = () => {}; // something that the address has changed

  constructor() {
    Object.assign(this, start());
  }

  // Another scene: what names its runs and views starts anew.
  open(index, scene) {
    if (this.scene !== scene) this.reset(index, scene);
  }

  reset(index, scene) {
    Object.assign(this, {
      index,
      scene,
      view: 0,
      values: null,
      pixel: null,
      pinned: false,
      left: -1,
    });
    this.hiddenRuns = new Set();
    const best = scene.runs.findIndex(({ method, ok }) => ok && method === "glint");
    const first = scene.runs.findIndex(({ ok }) => ok);
    this.right = this.run = Math.max(0, best >= 0 ? best : first);
    if (!scene.metrics.includes(this.metric)) this.metric = scene.metrics[0] ?? "psnr";
    this.transform.reset();
  }

  get layer() {
    return this.scene.layers.find(({ id }) => id === this.layerId);
  }

  // Indices of the runs in the grid.
  shownRuns() {
    const { scene, hiddenRuns } = this;
    return scene.runs.map((_, i) => i).filter((i) => !hiddenRuns.has(runKey(scene, scene.runs[i])));
  }

  #ownerKey(owner) {
    return owner < 0 ? "truth" : runKey(this.scene, this.scene.runs[owner]);
  }

  #ownerOf(key, fallback) {
    if (key === "truth") return -1;
    const run = runOfKey(this.scene, key);
    return run >= 0 ? run : fallback;
  }

  address() {
    const { scene, transform } = this;
    const view = scene.views[this.view];
    const round = (x) => Number(x.toFixed(4));
    return {
      scene: sceneKey(this.index),
      view: view?.name,
      map: this.layerId,
      mode: this.mode,
      left: this.#ownerKey(this.left),
      right: this.#ownerKey(this.right),
      split: this.mode === "slider" ? round(this.split) : null,
      auto: this.mode === "flicker" ? this.flickerRuns : null,
      methods: chosenKeys(scene, this.hiddenRuns),
      outline: this.outline,
      zoom: transform.scale > 1 ? [transform.scale, transform.x, transform.y].map(round) : null,
      pixel: this.pixel,
      held: this.pixel ? this.pinned : null,
      sorted: [this.metric, scene.runs[this.run] ? this.#ownerKey(this.run) : "", this.order],
    };
  }

  // From the address alone: what it leaves out is as at the start.
  read(params, index, scene) {
    Object.assign(this, start());
    this.reset(index, scene);
    const named = scene.views.findIndex(({ name }) => name === params.get("view"));
    this.view = Math.max(0, named);
    const layers = scene.layers.map(({ id }) => id);
    this.layerId = params.choice("map", layers, this.layerId);
    this.mode = params.choice("mode", ids(kModes), this.mode);
    this.left = this.#ownerOf(params.get("left"), this.left);
    this.right = this.#ownerOf(params.get("right"), this.right);
    this.split = params.number("split", 0, 100, this.split);
    this.flickerRuns = params.flag("auto", this.flickerRuns);
    this.outline = params.flag("outline", false);
    this.hiddenRuns = hiddenKeys(scene, params.list("methods"));
    this.transform.set(params.numbers("zoom", 3));
    this.#readPixel(params.numbers("pixel", 2), params.flag("held", false));
    const [metric, run, order] = params.list("sorted") ?? [];
    if (scene.metrics.includes(metric)) this.metric = metric;
    this.run = Math.max(0, this.#ownerOf(run, this.run));
    if (ids(kOrders).includes(order)) this.order = order;
  }

  #readPixel(pixel, held) {
    const size = this.scene.views[this.view]?.size;
    if (!pixel || !size) return;
    this.pixel = pixel.map((x, i) => Math.min(size[i] - 1, Math.max(0, Math.floor(x))));
    this.pinned = held;
  }

  set(changes) {
    Object.assign(this, changes);
    this.onChange(changes);
  }

  setView(view) {
    if (view !== this.view) this.set({ view, values: null, path: undefined });
  }

  // Of the loaded view; computed once.
  outlinePath() {
    if (!this.values) return "";
    if (this.pathOf !== this.values)
      Object.assign(this, { pathOf: this.values, path: outlinePath(this.values) });
    return this.path;
  }
}
