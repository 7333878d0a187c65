// The comparison of the scene view as one picture: its panes, cut as they are.
import { metricText, sceneTitle } from "./data.js";
import { scoreOf } from "./frames.js";
import { ownerKey, ownerTitle, shownLayer, whyMissing } from "./owner.js";
import { drawColorbar, enlargement, panelCanvas, readablePicture } from "./save_png.js";

const kColumns = 4; // of a grid

// The part of the picture that is shown, in its pixels.
function cropOf({ scene, view, transform }) {
  const [width, height] = scene.views[view].size;
  const { scale, x, y } = transform;
  return {
    left: (-x / scale) * width,
    top: (-y / scale) * height,
    width: width / scale,
    height: height / scale,
  };
}

function drawOutline(context, state, crop, width) {
  if (!state.outline || !state.outlinePath()) return;
  const scale = width / crop.width;
  const path = new Path2D();
  path.addPath(
    new Path2D(state.outlinePath()),
    new DOMMatrix([scale, 0, 0, scale, -crop.left * scale, -crop.top * scale]),
  );
  for (const [color, line] of [
    ["#000", 3],
    ["#fff", 1.2],
  ]) {
    context.strokeStyle = color;
    context.lineWidth = line;
    context.stroke(path);
  }
}

async function panelOf(state, owner, crop) {
  const { scene, view, index, metric, layer } = state;
  const score = owner < 0 ? null : scoreOf(scene, owner, view, metric);
  const shown = shownLayer(state, owner);
  const words = [
    ownerTitle(scene, owner),
    shown && shown !== layer && "image",
    score !== null && `${metric} ${metricText(metric, score)}`,
  ];
  const title = words.filter(Boolean).join(" · ");
  if (!shown) return { title, why: whyMissing(scene, owner, layer) };
  const image = await readablePicture(index, view, ownerKey(owner), shown.id);
  const draw = (context, width, height) => {
    context.drawImage(image, crop.left, crop.top, crop.width, crop.height, 0, 0, width, height);
    drawOutline(context, state, crop, width);
  };
  return { title, draw };
}

// Left of the divider one panel, right of it the other.
function dividedPanel([left, right], split) {
  const part = (context, panel, from, to, width, height) => {
    context.save();
    context.beginPath();
    context.rect(from, 0, to - from, height);
    context.clip();
    panel.draw?.(context, width, height);
    context.restore();
  };
  return {
    title: `${left.title}  |  ${right.title}`,
    draw: (context, width, height) => {
      context.fillStyle = "#e8ecf2"; // where a picture is missing
      context.fillRect(0, 0, width, height);
      const at = (width * split) / 100;
      part(context, left, 0, at, width, height);
      part(context, right, at, width, width, height);
      context.fillStyle = "#fff";
      context.fillRect(at - 1, 0, 2, height);
    },
  };
}

function rowsOf(list, columns) {
  const rows = [];
  for (let i = 0; i < list.length; i += columns) rows.push(list.slice(i, i + columns));
  return rows;
}

export async function sceneCanvas(state) {
  const { scene, view, mode, layer } = state;
  const crop = cropOf(state);
  const owners = mode === "grid" ? [-1, ...state.shownRuns()] : [state.left, state.right];
  const panels = await Promise.all(owners.map((owner) => panelOf(state, owner, crop)));
  const shown = mode === "slider" ? [dividedPanel(panels, state.split)] : panels;
  // One picture alone may be larger; all sizes are whole multiples of the pixels.
  const scale = enlargement(crop.width) * (mode === "slider" && crop.width <= 480 ? 2 : 1);
  const zoom = state.transform.scale > 1 ? `, ${state.transform.scale.toFixed(1)}× enlarged` : "";
  return panelCanvas(
    rowsOf(shown, kColumns),
    Math.round(scale * crop.width),
    Math.round(scale * crop.height),
    `${sceneTitle(state.index)}, view ${scene.views[view].name}: ${layer.title}${zoom}`,
    layer.colors && ((context, x, y) => drawColorbar(context, layer, x, y)),
  );
}

export const sceneWords = ({ index, scene, view, layerId, mode }) => [
  sceneTitle(index),
  scene.views[view].name,
  layerId,
  mode,
];
