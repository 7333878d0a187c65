// What the page asks the server for: the state of the page as a message "look".
import { cameraOf, fovOf, matrixOf, poseOf } from "./camera.js";
import { planeOf } from "./cut.js";

const kMostPixels = 4096; // a side

export const kResolutions = [
  ["data", "Data"],
  ["double", "Twice"],
  ["window", "Window"],
];

export const viewOf = (hello, { split, index }) =>
  hello.views.find((view) => view.split === split && view.index === index);

// [width, height] of a whole frame. `stage`: of the window's part, device pixels.
export function frameSize(hello, state, stage) {
  const view = state.view && viewOf(hello, state.view).camera;
  if (view) return [view.width, view.height];
  const sizes = { data: hello.size, double: hello.size.map((n) => 2 * n), window: stage };
  return sizes[state.resolution].map((n) => Math.min(kMostPixels, Math.max(16, Math.round(n))));
}

// Layers that compare with the truth are there where a view is snapped to; elsewhere the image.
export function shownLayer(hello, pane, view) {
  const layers = hello.runs[pane.run].layers;
  const layer = layers.find(({ id }) => id === pane.layer) ?? layers[0];
  return layer.needs_view && !view ? layers[0] : layer;
}

// Without its serial number.
export function lookOf(hello, state, stage) {
  const panes = [state.left, state.right].filter((pane) => pane && !pane.photo);
  return {
    type: "look",
    size: frameSize(hello, state, stage),
    camera: { world_from_cam: matrixOf(state.rig.pose), fov_x: state.rig.fov },
    view: state.view,
    panes: panes.map((pane) => ({ run: pane.run, layer: shownLayer(hello, pane, state.view).id })),
    scales: state.scales,
    style: state.style,
    hidden: state.hidden,
    cut: planeOf(state.cut, hello.scene),
  };
}

// The whole camera that a look means.
export function cameraOfLook(hello, look) {
  if (look.view) return viewOf(hello, look.view).camera;
  return cameraOf(poseOf(look.camera.world_from_cam), look.camera.fov_x, look.size);
}

export const sawView = ({ camera }) => ({
  pose: poseOf(camera.world_from_cam),
  fov: fovOf(camera),
});
