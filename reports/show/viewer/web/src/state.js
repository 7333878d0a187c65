// What the page shows, and how it begins.
import { kFovHigh, kFovLow, lookAt, numbersOf, poseOfNumbers } from "./camera.js";
import { kCutAxes } from "./cut.js";
import { kResolutions, sawView, viewOf } from "./look.js";
import { add, clamp, scaled } from "./vectors.js";

export const kUps = {
  "+x": [1, 0, 0],
  "-x": [-1, 0, 0],
  "+y": [0, 1, 0],
  "-y": [0, -1, 0],
  "+z": [0, 0, 1],
  "-z": [0, 0, -1],
};
export const kScaleTitles = {
  reflection: "Reflection",
  transmission: "Transmission",
  transparency: "Transparency t",
};

// Names of the sets of surfels that any of the runs has.
export const setsOf = (runs) => [...new Set(runs.flatMap((run) => Object.keys(run.surfels)))];

export const upOf = (hello, name) => kUps[name] ?? hello.scene.up;

// The first test view's pose; without views from outside of the scene.
function firstLook({ views, scene }) {
  const first = views.find(({ split }) => split === "test") ?? views[0];
  if (first) return sawView(first);
  const across = Math.abs(scene.up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0];
  const eye = add(scene.center, scaled(add(across, scaled(scene.up, 0.5)), 1.5 * scene.radius));
  return { pose: lookAt(eye, scene.center, scene.up), fov: 60 };
}

export function firstRig(hello, mode) {
  const { pose, fov } = firstLook(hello);
  const { center, radius, up } = hello.scene;
  return { pose, fov, up, pivot: center, speed: clamp(radius / 3, 0.01, 100), mode };
}

export function firstState(hello) {
  return {
    rig: firstRig(hello, hello.scene.kind === "object" ? "orbit" : "fly"),
    up: "scene",
    view: null,
    left: { run: 0, layer: hello.runs[0].layers[0].id },
    right: null, // {run, layer}, or {photo: true}
    split: 50, // percent
    scales: Object.fromEntries(Object.keys(kScaleTitles).map((name) => [name, 1])),
    style: "image",
    hidden: [], // names of sets that are not drawn as discs or points
    cut: { axis: null, direction: [0, 0, 1], flipped: false, share: 0.6 },
    resolution: "data",
    frusta: true,
  };
}

const paneName = (hello, pane) => (pane.photo ? "photo" : hello.runs[pane.run].name);
const digits = (values, count) => values.map((value) => Number(value.toFixed(count)));

// For the address; what is as at first is left out.
export function addressValues(hello, state) {
  const { rig, view, left, right, scales, cut } = state;
  const isScaled = Object.values(scales).some((value) => value !== 1);
  return {
    left: paneName(hello, left),
    layer: left.layer,
    right: right && paneName(hello, right),
    layer2: right?.layer,
    at: digits(numbersOf(rig.pose), 5),
    pivot: digits(rig.pivot, 3),
    fov: Number(rig.fov.toFixed(3)),
    mode: rig.mode,
    up: state.up === "scene" ? null : state.up,
    view: view && `${view.split}:${view.index}`,
    split: right ? Math.round(state.split) : null,
    scales: isScaled ? digits(Object.values(scales), 2) : null,
    style: state.style === "image" ? null : state.style,
    hidden: state.hidden.length > 0 ? state.hidden : null,
    cut: cut.axis,
    cutshare: cut.axis && Number(cut.share.toFixed(3)),
    cutflip: cut.axis && cut.flipped ? true : null,
    cutalong: cut.axis === "view" ? digits(cut.direction, 4) : null,
    size: state.resolution === "data" ? null : state.resolution,
    frusta: state.frusta ? null : false,
  };
}

function paneOf(hello, params, runName, layerName, fallback) {
  const name = params.get(runName);
  const run = hello.runs.findIndex((one) => one.name === name);
  if (run < 0) return name === "photo" && runName === "right" ? { photo: true } : fallback;
  const layer = params.get(layerName);
  return { run, layer: layer ?? hello.runs[run].layers[0].id };
}

function viewOfText(hello, text) {
  const [split, index] = (text ?? "").split(":");
  const view = { split, index: Number(index) };
  return viewOf(hello, view) ? view : null;
}

function readRig(hello, params, rig, up) {
  const at = params.numbers("at", 7);
  return {
    ...rig,
    up: upOf(hello, up),
    pose: at ? poseOfNumbers(at) : rig.pose,
    pivot: params.numbers("pivot", 3) ?? rig.pivot,
    fov: params.number("fov", kFovLow, kFovHigh, rig.fov),
    mode: params.choice("mode", ["fly", "orbit"], rig.mode),
  };
}

// `params` of the address over a state as at first; what makes no sense is left as it was.
export function stateOfAddress(hello, params) {
  const state = firstState(hello);
  if (!params) return state;
  state.up = params.choice("up", Object.keys(kUps), "scene");
  state.rig = readRig(hello, params, state.rig, state.up);
  state.left = paneOf(hello, params, "left", "layer", state.left);
  state.right = paneOf(hello, params, "right", "layer2", null);
  state.view = viewOfText(hello, params.get("view"));
  if (state.view) Object.assign(state.rig, sawView(viewOf(hello, state.view)));
  state.split = params.number("split", 0, 100, 50);
  const scales = params.numbers("scales", 3);
  if (scales) Object.keys(state.scales).forEach((name, i) => (state.scales[name] = scales[i]));
  state.style = params.choice("style", hello.runs[state.left.run].styles, "image");
  state.hidden = (params.list("hidden") ?? []).filter((name) => setsOf(hello.runs).includes(name));
  state.cut = {
    axis: params.choice("cut", kCutAxes, null),
    direction: params.numbers("cutalong", 3) ?? [0, 0, 1],
    flipped: params.flag("cutflip", false),
    share: params.number("cutshare", 0, 1, 0.6),
  };
  state.resolution = params.choice(
    "size",
    kResolutions.map(([id]) => id),
    "data",
  );
  state.frusta = params.flag("frusta", true);
  return state;
}
