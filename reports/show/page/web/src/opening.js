// The picture that the page opens with: a test view, true and by the methods that the program names,
// with the depth of both layers.
import { addressOf } from "./address.js";
import { isRival, loadScene, metricText, pictureUrl, report, runKey, sceneKey, sceneTitle } from "./data.js";
import { h, replace } from "./dom.js";
import { scoreOf } from "./frames.js";
import { layersOf, ownerKey, ownerTitle } from "./owner.js";
import { enlargement, panelCanvas, readablePicture, saveButton } from "./save_png.js";

const kMethods = 5; // beside the truth
const kLayers = ["rgb", "depth", "behind_depth"];
const kMetric = "psnr";

// The view with the largest share of glass, as in figures; without glass the middle one.
function openingView({ views }) {
  const shares = views.map(({ glass }) => glass ?? 0);
  const most = Math.max(...shares);
  return most > 0 ? shares.indexOf(most) : Math.floor(views.length / 2);
}

// Mean over the views of the scene; -1e9 puts runs without a score last.
function meanScore(scene, run) {
  const scores = scene.views
    .map((_, view) => scoreOf(scene, run, view, kMetric))
    .filter((score) => score !== null);
  return scores.length > 0 ? scores.reduce((a, b) => a + b) / scores.length : -1e9;
}

const rendered = (scene, view) =>
  scene.runs.map((_, run) => run).filter((run) => layersOf(scene, view, run).includes("rgb"));

// The first run of each of the program's choice.
const mainRuns = (scene, view) =>
  report.main_methods
    .map((id) => rendered(scene, view).find((run) => scene.runs[run].method === id))
    .filter((run) => run !== undefined);

const bestRuns = (scene, view) =>
  rendered(scene, view)
    .filter((run) => isRival(scene.runs[run].method))
    .sort((a, b) => meanScore(scene, b) - meanScore(scene, a))
    .slice(0, kMethods);

// Where none of the choice was run, the best are shown.
function shownRuns(scene, view) {
  const chosen = mainRuns(scene, view);
  return chosen.length > 0
    ? { runs: chosen, rule: "the main methods, with depth at the glass and behind it" }
    : { runs: bestRuns(scene, view), rule: "the methods of highest PSNR on this scene" };
}

function titleOf(scene, view, owner) {
  if (owner < 0) return ownerTitle(scene, owner);
  const score = scoreOf(scene, owner, view, kMetric);
  const quality = score === null ? "" : ` · ${metricText(kMetric, score)} dB`;
  return `${ownerTitle(scene, owner)}${quality}`;
}

const layerTitle = (scene, layer) => scene.layers.find(({ id }) => id === layer).title;

// What the picture shows: {index, scene, view, owners, layers, rule}; null: nothing was rendered.
async function content() {
  for (let index = 0; index < report.scenes.length; ++index) {
    const scene = await loadScene(index);
    if (scene.views.length === 0) continue;
    const view = openingView(scene);
    const truth = layersOf(scene, view, -1).includes("rgb") ? [-1] : [];
    const { runs, rule } = shownRuns(scene, view);
    const owners = [...truth, ...runs];
    const layers = kLayers.filter((layer) =>
      owners.some((owner) => layersOf(scene, view, owner).includes(layer)),
    );
    if (owners.length > 0) return { index, scene, view, owners, layers, rule };
  }
  return null;
}

// `caption`: above it; empty: none.
function panel({ index, scene, view }, owner, layer, caption) {
  const title = titleOf(scene, view, owner);
  const there = layersOf(scene, view, owner).includes(layer);
  const [width, height] = scene.views[view].size;
  const right = owner < 0 ? "truth" : runKey(scene, scene.runs[owner]);
  const link = addressOf("scene", {
    scene: sceneKey(index),
    view: scene.views[view].name,
    map: layer,
    left: "truth",
    right,
  });
  return h(
    "figure",
    {},
    caption && h("figcaption", {}, caption),
    there
      ? h(
          "a",
          { href: link, title: "open in Scenes" },
          h("img", {
            src: pictureUrl(index, view, ownerKey(owner), layer),
            alt: `${layerTitle(scene, layer)}, ${title}`,
            style: { aspectRatio: `${width} / ${height}` },
          }),
        )
      : h(
          "div",
          { class: "missing", style: { aspectRatio: `${width} / ${height}` } },
          layer === "behind_depth" ? "one layer: none behind glass" : "not rendered",
        ),
  );
}

const placeText = ({ index, scene, view, owners, rule }) =>
  `${sceneTitle(index)}, view ${scene.views[view].name}${
    (scene.views[view].glass ?? 0) > 0 ? ", the test view with most glass" : ""
  }: ${owners.includes(-1) ? "the reference beside " : ""}${rule}.`;

async function pictureCanvas(shown) {
  const { index, scene, view, owners, layers } = shown;
  const [width, height] = scene.views[view].size;
  const scale = enlargement(width);
  const one = async (owner, layer) => {
    const title = layer === layers[0] ? titleOf(scene, view, owner) : layerTitle(scene, layer);
    if (!layersOf(scene, view, owner).includes(layer)) return { title, why: "not rendered" };
    const image = await readablePicture(index, view, ownerKey(owner), layer);
    return { title, draw: (context, w, h) => context.drawImage(image, 0, 0, w, h) };
  };
  const rows = await Promise.all(
    layers.map((layer) => Promise.all(owners.map((owner) => one(owner, layer)))),
  );
  return panelCanvas(rows, scale * width, scale * height, placeText(shown));
}

async function fill(card) {
  const shown = await content();
  if (!shown) return card.remove();
  const { index, scene, view, owners, layers } = shown;
  const captionOf = (owner, layer) => {
    if (layer === layers[0]) return titleOf(scene, view, owner);
    return owner === owners[0] ? layerTitle(scene, layer) : "";
  };
  const panels = layers.map((layer) =>
    owners.map((owner) => panel(shown, owner, layer, captionOf(owner, layer))),
  );
  const words = () => [report.profile, sceneTitle(index), scene.views[view].name];
  replace(
    card,
    h("div", { class: "opening-grid" }, panels),
    h(
      "div",
      { class: "card-head" },
      h("p", { class: "caption" }, placeText(shown), " Click a picture to compare it."),
      saveButton(() => pictureCanvas(shown), words),
    ),
  );
  card.querySelector(".opening-grid").style.setProperty("--columns", String(owners.length));
}

export function openingPicture() {
  const card = h("section", { class: "card opening", id: "opening" });
  fill(card).catch((error) => replace(card, h("p", { class: "note" }, error.message)));
  return card;
}
