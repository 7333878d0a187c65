// One scene: views by error, pictures of every method, values under the pointer.
import { keepAddress } from "./address.js";
import { loadScene, report, runKey, runTitle, sceneOfAddress } from "./data.js";
import { checkbox, h, replace, segmented, select } from "./dom.js";
import { showFrames, sortedViews } from "./frames.js";
import { setViewKeys } from "./keys.js";
import { legend } from "./legend.js";
import { showProbe, ViewValues } from "./probe.js";
import { saveButton } from "./save_png.js";
import { sceneChoice } from "./scene_choice.js";
import { sceneCanvas, sceneWords } from "./scene_png.js";
import { kModes, SceneState } from "./scene_state.js";
import { ownerTitle } from "./owner.js";
import { Viewer } from "./viewer.js";

const state = new SceneState();
const step = (list, current, by) => list[(list.indexOf(current) + by + list.length) % list.length];

function ownerChoices(scene) {
  return [-1, ...scene.runs.map((_, i) => i)].map((owner) => [owner, ownerTitle(scene, owner)]);
}

// Layers that some render or the truth of the scene has.
function layersThere(scene) {
  const there = new Set(
    scene.views.flatMap(({ truth, runs }) => [...truth, ...(runs ?? []).flat()]),
  );
  return scene.layers.filter(({ id }) => there.has(id));
}

function methodChecks() {
  const toggle = (key) => (on) => {
    if (on) state.hiddenRuns.delete(key);
    else state.hiddenRuns.add(key);
    state.set({});
  };
  const checks = state.scene.runs.map((run, i) => {
    const key = runKey(state.scene, run);
    return checkbox(
      runTitle(state.scene, run),
      !state.hiddenRuns.has(key),
      toggle(key),
      `shown-${i}`,
    );
  });
  return h("div", { class: "checks", role: "group", "aria-label": "Methods" }, checks);
}

const swap = () => state.set({ left: state.right, right: state.left });

function sideChoices() {
  const owners = ownerChoices(state.scene);
  const choose = (side) => (owner) => state.set({ [side]: Number(owner) });
  return h(
    "div",
    { class: "sides" },
    select("Left", owners, state.left, choose("left"), "left-owner"),
    h("button", { type: "button", title: "swap (x)", id: "swap", onclick: swap }, "⇄"),
    select("Right", owners, state.right, choose("right"), "right-owner"),
    state.mode === "flicker" &&
      checkbox("by itself", state.flickerRuns, (on) => state.set({ flickerRuns: on }), "auto"),
  );
}

function zoomButtons() {
  const { transform } = state;
  const button = (title, text, onclick) => h("button", { type: "button", title, onclick }, text);
  return [
    button("zoom out (-)", "−", () => transform.zoom(0.5)),
    h("output", { class: "zoom" }),
    button("zoom in (+)", "+", () => transform.zoom(2)),
    button("whole picture (0)", "Fit", () => transform.reset()),
  ];
}

function controls() {
  const layers = layersThere(state.scene).map(({ id, title }) => [id, title]);
  return h(
    "div",
    { class: "controls card" },
    h(
      "div",
      { class: "bar" },
      segmented("Layer", layers, state.layerId, (id) => state.set({ layerId: id })),
    ),
    h(
      "div",
      { class: "bar" },
      segmented("Mode", kModes, state.mode, (mode) => state.set({ mode })),
      zoomButtons(),
      checkbox("Glass outline", state.outline, (on) => state.set({ outline: on }), "outline"),
      state.mode === "grid" ? methodChecks() : sideChoices(),
      saveButton(
        () => sceneCanvas(state),
        () => sceneWords(state),
      ),
    ),
  );
}

class SceneView {
  constructor(container) {
    this.container = container;
    this.frames = h("aside", { class: "card frames-panel", "aria-label": "Views of the scene" });
    this.controls = h("div");
    this.legend = h("div");
    this.probe = h("div", { class: "card probe-panel", "aria-live": "off" });
    this.viewer = new Viewer(state, (pixel, kind) => this.point(pixel, kind));
    state.transform.listeners.add(() => this.showZoom());
    state.onChange = () => this.update();
    state.moveProbe = (dx, dy) => this.moveProbe(dx, dy);
    state.onKeep = () => this.keep();
    state.viewer = this.viewer;
  }

  keep() {
    keepAddress("scene", state.address());
  }

  choice() {
    return sceneChoice(state.index, (index) => openScene(this.container, index));
  }

  show() {
    const { note, views } = state.scene;
    const stage = h("div", { class: "stage card" }, this.viewer.element, this.legend);
    const column = h("div", { class: "main-column" }, this.controls, stage, this.probe);
    replace(
      this.container,
      note && h("p", { class: "note warning" }, note),
      views.length > 0
        ? h("div", { class: "scene-layout" }, this.frames, column)
        : [
            h("div", { class: "bar" }, this.choice()),
            h("p", { class: "card" }, "No view of this scene was rendered: missing."),
          ],
    );
    if (views.length > 0) this.update();
  }

  update() {
    const focused = document.activeElement?.closest("[data-value], [data-view], [id]");
    showFrames(this.frames, state, this.choice());
    replace(this.controls, controls());
    replace(this.legend, legend(state.layer, state.scene.depth_from_truth));
    this.viewer.show();
    this.showZoom();
    this.showPixel();
    this.#restoreFocus(focused);
    if (!state.values) this.loadValues();
  }

  // The control that was used was replaced by a new one of the same name.
  #restoreFocus(old) {
    if (!old || old.isConnected) return;
    const name = old.id
      ? `#${old.id}`
      : old.dataset.value
        ? `[data-value="${CSS.escape(old.dataset.value)}"]`
        : `[data-view="${old.dataset.view}"]`;
    this.container.querySelector(name)?.focus({ preventScroll: true });
  }

  async loadValues() {
    const { index, view } = state;
    const here = () => state.index === index && state.view === view;
    try {
      const values = await ViewValues.load(index, view);
      if (!here()) return;
      state.values = values;
      if (state.outline) this.viewer.show();
      this.showPixel();
    } catch (error) {
      if (here()) replace(this.probe, h("p", { class: "note" }, `No values: ${error.message}`));
    }
  }

  point(pixel, kind) {
    if (kind === "click") state.pinned = !state.pinned;
    else if (state.pinned) return;
    state.pixel = pixel ?? state.pixel;
    this.showPixel();
  }

  moveProbe(dx, dy) {
    const [width, height] = state.scene.views[state.view].size;
    const [x, y] = state.pixel ?? [Math.floor(width / 2), Math.floor(height / 2)];
    state.pixel = [
      Math.min(width - 1, Math.max(0, x + dx)),
      Math.min(height - 1, Math.max(0, y + dy)),
    ];
    state.pinned = true;
    this.showPixel();
  }

  showPixel() {
    this.viewer.place();
    showProbe(this.probe, state.scene, state.values, state.pixel, state.pinned);
    this.keep();
  }

  showZoom() {
    const output = this.controls.querySelector(".zoom");
    if (output) output.textContent = `${state.transform.scale.toFixed(1)}×`;
    this.keep();
  }
}

// What is shown.
function choiceKeys() {
  const views = () => sortedViews(state.scene, state);
  const layers = () => layersThere(state.scene).map(({ id }) => id);
  const owners = () => ownerChoices(state.scene).map(([owner]) => owner);
  return [
    {
      keys: ["j"],
      help: "next view of the list",
      run: () => state.setView(step(views(), state.view, 1)),
    },
    { keys: ["k"], help: "view before", run: () => state.setView(step(views(), state.view, -1)) },
    {
      keys: ["m"],
      help: "next method on the right",
      run: () => state.set({ right: step(owners(), state.right, 1) }),
    },
    {
      keys: ["M"],
      help: "next method on the left",
      run: () => state.set({ left: step(owners(), state.left, 1) }),
    },
    {
      keys: ["l"],
      help: "next layer",
      run: () => state.set({ layerId: step(layers(), state.layerId, 1) }),
    },
    {
      keys: ["L"],
      help: "layer before",
      run: () => state.set({ layerId: step(layers(), state.layerId, -1) }),
    },
  ];
}

// How it is shown.
function pictureKeys() {
  const probe = (key, dx, dy) => ({
    keys: [key],
    help: "move the probed pixel (Shift: 10)",
    run: (event) => state.moveProbe(dx * (event.shiftKey ? 10 : 1), dy * (event.shiftKey ? 10 : 1)),
  });
  return [
    { keys: ["s"], help: "slider", run: () => state.set({ mode: "slider" }) },
    { keys: ["f"], help: "flicker", run: () => state.set({ mode: "flicker" }) },
    { keys: ["g"], help: "grid", run: () => state.set({ mode: "grid" }) },
    { keys: [" "], help: "flicker: the other picture", run: () => state.viewer.flip() },
    { keys: ["["], help: "slider: divider to the left", run: () => state.viewer.moveDivider(-5) },
    { keys: ["]"], help: "slider: divider to the right", run: () => state.viewer.moveDivider(5) },
    {
      keys: ["x"],
      help: "swap left and right",
      run: swap,
    },
    { keys: ["o"], help: "outline of glass", run: () => state.set({ outline: !state.outline }) },
    { keys: ["+", "="], help: "zoom in", run: () => state.transform.zoom(2) },
    { keys: ["-"], help: "zoom out", run: () => state.transform.zoom(0.5) },
    { keys: ["0"], help: "whole picture", run: () => state.transform.reset() },
    probe("ArrowLeft", -1, 0),
    probe("ArrowRight", 1, 0),
    probe("ArrowUp", 0, -1),
    probe("ArrowDown", 0, 1),
    {
      keys: ["h"],
      help: "hold or release the probed pixel",
      run: () => state.viewer.onPixel(state.pixel, "click"),
    },
  ];
}

async function openScene(container, index) {
  state.open(index, await loadScene(index));
  keepAddress("scene", state.address(), true);
  showScene(container);
}

export async function showScene(container, from) {
  if (report.scenes.length === 0) {
    setViewKeys([]);
    replace(container, h("p", { class: "card" }, "No records yet: nothing to show."));
    return () => {};
  }
  const current = Math.max(0, state.index);
  const index = from ? sceneOfAddress(from, current) : current;
  const scene = await loadScene(index);
  if (from?.params) state.read(from.params, index, scene);
  else state.open(index, scene);
  const view = new SceneView(container);
  setViewKeys(state.scene.views.length > 0 ? [...choiceKeys(), ...pictureKeys()] : []);
  view.show();
  return () => view.viewer.stop();
}
