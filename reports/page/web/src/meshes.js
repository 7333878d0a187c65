// Meshes of a scene in 3D: one or two beside each other under one camera, with a cut plane.
import { loadPart, loadScene, loadScript, report, runTitle, sceneTitle } from "./data.js";
import { checkbox, h, replace, segmented, select } from "./dom.js";
import { setViewKeys } from "./keys.js";

const state = {
  scene: 0,
  left: 0,
  right: -1,
  axis: "x",
  cut: 0,
  flipped: false,
  wire: false,
  backs: false,
};
const kAxes = [
  ["x", "x"],
  ["y", "y"],
  ["z", "z"],
];
let view3d = null;

// {title, part, faces} of the truth and every run.
function meshesOf(scene) {
  const ofRuns = scene.runs.flatMap((run) =>
    run.meshes.map((mesh) => ({ ...mesh, title: `${runTitle(scene, run)}: ${mesh.title}` })),
  );
  return [...scene.meshes, ...ofRuns];
}

async function openMeshes(meshes) {
  const wanted = [state.left, state.right].filter((i) => i >= 0 && i < meshes.length);
  return Promise.all(
    wanted.map(async (i) => ({ title: meshes[i].title, data: await loadPart(meshes[i].part) })),
  );
}

function stop() {
  view3d?.stop();
  view3d = null;
}

function applyCut() {
  view3d?.cut(state.axis, state.cut / 100, state.flipped);
}

function controls(meshes, again) {
  const choices = meshes.map(({ title, faces }, i) => [
    i,
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
      select("Mesh", choices, state.left, (i) => setCut({ left: Number(i) })),
      select("beside", [[-1, "none"], ...choices], state.right, (i) =>
        setCut({ right: Number(i) }),
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
    applyCut();
    stage.dataset.ready = "true";
  } catch (error) {
    replace(
      stage,
      h("p", { class: "note warning" }, `The 3D view cannot be shown: ${error.message}`),
    );
  }
}

export async function showMeshes(container, index = state.scene) {
  stop();
  const again = () => showMeshes(container);
  setViewKeys([]);
  if (report.scenes.length === 0) {
    replace(container, h("p", { class: "card" }, "No records yet: nothing to show."));
    return stop;
  }
  state.scene = Math.min(Number(index) || 0, report.scenes.length - 1);
  const scene = await loadScene(state.scene);
  const meshes = meshesOf(scene);
  if (state.left >= meshes.length) Object.assign(state, { left: 0, right: -1 });
  const bar = h(
    "div",
    { class: "bar" },
    select(
      "Scene",
      report.scenes.map((_, i) => [i, sceneTitle(i)]),
      state.scene,
      (i) => (location.hash = `#meshes/${i}`),
    ),
  );
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
        "Drag to turn, wheel to approach, right drag to shift. Backs of faces are left out, or orange. Large meshes are merged to 300,000 faces for this view.",
      ),
    ),
  );
  await show3d(stage, meshes);
  return stop;
}
