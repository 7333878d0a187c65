// Who a picture is of: -1 is the reference, others are indices of runs.
import { runTitle } from "./data.js";

export const ownerKey = (owner) => (owner < 0 ? "t" : `r${owner}`);
export const ownerTitle = (scene, owner) =>
  owner < 0 ? "Reference" : runTitle(scene, scene.runs[owner]);

export function whyMissing(scene, owner, layer) {
  if (owner < 0) return scene.note || "no reference for this layer";
  const run = scene.runs[owner];
  if (!run.ok) return `run failed: ${run.failure}`;
  return layer.id === "error" || layer.id === "angle" ? "cannot be compared" : "not rendered";
}

// Ids of the layers that an owner has of a view.
export function layersOf(scene, view, owner) {
  const { truth, runs } = scene.views[view];
  return owner < 0 ? truth : (runs?.[owner] ?? []);
}

// The layer that is shown of an owner; of the reference its image where it has no such layer.
export function shownLayer({ scene, view, layer }, owner) {
  const there = layersOf(scene, view, owner);
  if (there.includes(layer.id)) return layer;
  return owner < 0 ? scene.layers.find(({ id }) => id === "rgb" && there.includes(id)) : null;
}
