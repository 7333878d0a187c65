// Meshes of a scene in 3D: one or two beside each other under one camera, with a cut plane.
import { keepAddress } from "./address.js";
import {
  loadPart,
  loadScene,
  loadScript,
  report,
  runKey,
  runTitle,
  sceneKey,
  sceneOfAddress,
  sceneTitle,
} from "./data.js";
import { checkbox, h, replace, segmented, select } from "./dom.js";
import { setViewKeys } from "./keys.js";
import { drawText, newCanvas, saveButton } from "./save_png.js";
import { sceneChoice } from "./scene_choice.js";

const kTitle = 28; // pixels of the line above a saved picture

const start = () => ({
  left: "",
  right: "",
  axis: "x",
  cut: 0,
  flipped: false,
  wire: false,
  backs: false,
  camera: null,
});
// left, right: keys of meshes; "" chooses one, "none" shows none.
const state = { scene: 0, ...start() };
const kAxes = [
  ["x", "x"],
  ["y", "y"],
  ["z", "z"],
];
let view3d = null;

// {key, title, part, faces} of the truth and every run.
function meshesOf(scene) {
  const ofRuns = scene.runs.flatMap((run) =>
    run.meshes.map((mesh) => ({
      ...mesh,
      key: runKey(scene, run) + (mesh.part.endsWith("b") ? "~behind" : ""),
      method: run.method,
      title: `${runTitle(scene, run)}: ${mesh.title}`,
    })),
  );
  return [...scene.meshes.map((mesh) => ({ ...mesh, key: "truth" })), ...ofRuns];
}

// A method beside the truth, where nothing that is there is chosen.
function choose(meshes) {
  const there = (key) => meshes.some((mesh) => mesh.key === key);
  const truth = meshes.find(({ key }) => key === "truth");
  const ofRuns = meshes.filter(({ key }) => key !== "truth");
  const best = ofRuns.find(({ method }) => method === "glint") ?? ofRuns[0];
  if (!there(state.left)) state.left = (best ?? truth).key;
  if (state.right !== "none" && !there(state.right))
    state.right = truth && state.left !== "truth" ? "truth" : "none";
}

const chosenMeshes = (meshes) =>
  [state.left, state.right].map((key) => meshes.find((mesh) => mesh.key === key)).filter(Boolean);

async function openMeshes(meshes) {
  return Promise.all(
    chosenMeshes(meshes).map(async ({ title, part }) => ({ title, data: await loadPart(part) })),
  );
}

function address() {
  const { scene, camera, ...choices } = state;
  const numbers = camera?.map((x) => Number(x.toFixed(4)));
  return { scene: sceneKey(scene), ...choices, camera: numbers };
}

const keep = () => keepAddress("meshes", address());

function readState(params) {
  Object.assign(state, start());
  state.left = params.get("left", "");
  state.right = params.get("right", "");
  state.axis = params.choice("axis", ["x", "y", "z"], "x");
  state.cut = params.number("cut", 0, 100, 0);
  for (const flag of ["flipped", "wire", "backs"]) state[flag] = params.flag(flag, false);
  state.camera = params.numbers("camera", 6);
}

// Titles above what the 3D view shows.
function meshCanvas(meshes) {
  const titles = chosenMeshes(meshes).map(({ title }) => title);
  const picture = view3d.picture();
  const { canvas, context } = newCanvas(picture.width, picture.height + kTitle);
  titles.forEach((title, i) =>
    drawText(context, title, 8 + (i * picture.width) / titles.length, kTitle / 2, { bold: true }),
  );
  context.drawImage(picture, 0, kTitle);
  return canvas;
}

function stop() {
  view3d?.stop();
  view3d = null;
}

function applyCut() {
  view3d?.cut(state.axis, state.cut / 100, state.flipped);
  keep();
}

function controls(meshes, again) {
  const choices = meshes.map(({ key, title, faces }) => [
    key,
    `${title} (${faces.toLocaleString("en")} faces)`,
  ]);
  const cut = h("input", {
    type: "range",
    min: "0",
    max: "100",
    value: String(state.cut),
    id: "cut",
    "aria-label": "Position of the cut plane",
    oninput: () => ((state.cut = Number(cut.value)), applyCut()),
  });
  const setCut = (changes) => {
    Object.assign(state, changes);
    again();
  };
  return h(
    "div",
    { class: "controls card" },
    h(
      "div",
      { class: "bar" },
      select("Mesh", choices, state.left, (left) => setCut({ left }), "mesh-left"),
      select(
        "beside",
        [["none", "none"], ...choices],
        state.right,
        (right) => setCut({ right }),
        "mesh-right",
      ),
      saveButton(
        () => meshCanvas(meshes),
        () => [sceneTitle(state.scene), "meshes", state.left],
      ),
    ),
    h(
      "div",
      { class: "bar" },
      segmented("Axis of the cut", kAxes, state.axis, (axis) => setCut({ axis })),
      h("label", { class: "field grow" }, h("span", {}, "Cut"), cut),
      checkbox("other side", state.flipped, (flipped) => setCut({ flipped })),
      checkbox("backs of faces", state.backs, (backs) => setCut({ backs })),
      checkbox("wires", state.wire, (wire) => setCut({ wire })),
      h("button", { type: "button", onclick: () => view3d?.home() }, "Fit"),
    ),
  );
}

function meshKeys(again) {
  const moveCut = (by) => {
    state.cut = Math.min(100, Math.max(0, state.cut + by));
    const input = document.querySelector("#cut");
    if (input) input.value = String(state.cut);
    applyCut();
  };
  const next = { x: "y", y: "z", z: "x" };
  return [
    { keys: ["["], help: "cut less", run: () => moveCut(-2) },
    { keys: ["]"], help: "cut more", run: () => moveCut(2) },
    {
      keys: ["c"],
      help: "next axis of the cut",
      run: () => (Object.assign(state, { axis: next[state.axis] }), again()),
    },
    {
      keys: ["w"],
      help: "wires",
      run: () => (Object.assign(state, { wire: !state.wire }), again()),
    },
    {
      keys: ["b"],
      help: "backs of faces",
      run: () => (Object.assign(state, { backs: !state.backs }), again()),
    },
    { keys: ["0"], help: "whole mesh", run: () => view3d?.home() },
    { keys: ["ArrowLeft"], help: "turn", run: () => view3d?.turn(-0.1, 0) },
    { keys: ["ArrowRight"], help: "turn", run: () => view3d?.turn(0.1, 0) },
    { keys: ["ArrowUp"], help: "turn", run: () => view3d?.turn(0, -0.1) },
    { keys: ["ArrowDown"], help: "turn", run: () => view3d?.turn(0, 0.1) },
    { keys: ["+", "="], help: "nearer", run: () => view3d?.approach(0.8) },
    { keys: ["-"], help: "farther", run: () => view3d?.approach(1.25) },
  ];
}

async function show3d(stage, meshes) {
  const opened = await openMeshes(meshes);
  await loadScript("mesh3d", () => window.GLINT_MESH_VIEW !== undefined);
  try {
    view3d = await window.GLINT_MESH_VIEW.open(stage, opened, state);
    if (state.camera) view3d.view = state.camera;
    view3d.onMove = () => {
      state.camera = view3d.view;
      keep();
    };
    applyCut();
    stage.dataset.ready = "true";
  } catch (error) {
    replace(
      stage,
      h("p", { class: "note warning" }, `The 3D view cannot be shown: ${error.message}`),
    );
  }
}

export async function showMeshes(container, from) {
  stop();
  const again = () => showMeshes(container);
  setViewKeys([]);
  if (report.scenes.length === 0) {
    replace(container, h("p", { class: "card" }, "No records yet: nothing to show."));
    return stop;
  }
  if (from) state.scene = sceneOfAddress(from, state.scene);
  if (from?.params) readState(from.params);
  const scene = await loadScene(state.scene);
  const meshes = meshesOf(scene);
  const open = (index) => {
    Object.assign(state, { scene: index, camera: null });
    keepAddress("meshes", address(), true);
    again();
  };
  const bar = h("div", { class: "bar" }, sceneChoice(state.scene, open));
  if (meshes.length === 0) {
    replace(
      container,
      bar,
      h(
        "p",
        { class: "card" },
        "Missing: no run of this scene has a mesh.ply, and its data has no gt/mesh.ply.",
      ),
    );
    return stop;
  }
  choose(meshes);
  setViewKeys(meshKeys(again));
  const stage = h(
    "div",
    { class: "stage3d", id: "stage3d" },
    h("p", { class: "note" }, "Loading …"),
  );
  replace(
    container,
    bar,
    controls(meshes, again),
    h(
      "div",
      { class: "card" },
      stage,
      h(
        "p",
        { class: "note" },
        `Drag to turn, wheel to approach, right drag to shift. Backs of faces are left out, or orange. Large meshes are merged to ${report.mesh_faces.toLocaleString("en")} faces for this view.`,
      ),
    ),
  );
  await show3d(stage, meshes);
  return stop;
}
