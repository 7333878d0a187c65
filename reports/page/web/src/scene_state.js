// What the scene view shows; kept while other views are open.
import { outlinePath } from "./outline.js";
import { Transform } from "./transform.js";

const reducedMotion = () => window.matchMedia("(prefers-reduced-motion: reduce)").matches;

export class SceneState {
  index = -1;
  scene = null;
  view = 0;
  run = 0;
  metric = "psnr";
  order = "worst";
  layerId = "rgb";
  mode = "slider";
  left = -1;
  right = 0;
  split = 50;
  outline = false;
  flickerRuns = !reducedMotion();
  hiddenRuns = new Set();
  transform = new Transform();
  values = null;
  pixel = null;
  pinned = false;
  onChange = () => {};

  // Another scene: what names its runs and views starts anew.
  open(index, scene) {
    if (this.scene === scene) return;
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

  shownRuns() {
    return this.scene.runs.map((_, i) => i).filter((i) => !this.hiddenRuns.has(i));
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
