// The greeting of a server with two runs, for tests without one.
import { cameraOf, lookAt } from "../../../../reports/show/viewer/web/src/camera.js";

const kUp = [0, 0, 1];
const kColors = Array.from({ length: 256 }, (_, i) => {
  const part = (share) =>
    Math.round(255 * share)
      .toString(16)
      .padStart(2, "0");
  return `#${part(i / 255)}${part(0.4 + 0.4 * (i / 255))}${part(0.6 - 0.4 * (i / 255))}`;
});

const scalar = (id, title, low, high, unit = "", more = {}) => ({
  ...{ id, title, style: "scalar", low, high, unit, decimals: 3, colors: kColors },
  ...more,
});

const kPlain = [
  { id: "rgb", title: "Image", style: "picture" },
  scalar("error", "Error", 0, 0.25, "", { needs_view: true }),
  scalar("depth", "Depth", 1.2, 6.5, "m", { style: "depth" }),
  { id: "normal", title: "Normal", style: "normal" },
  scalar("angle", "Angle error", 0, 45, "°", { needs_view: true, decimals: 1 }),
];
const kGlass = [
  ...kPlain,
  scalar("transparency", "Transparency t", 0, 1),
  scalar("specularity", "Specularity k_s", 0, 1),
  scalar("alpha", "Coverage alpha", 0, 1),
  scalar("behind_depth", "Depth behind glass", 1.2, 6.5, "m", { style: "depth" }),
  { id: "interface", title: "Interface", style: "picture" },
  { id: "transmission", title: "Transmission", style: "picture" },
  { id: "reflection", title: "Reflection", style: "picture" },
];

function viewsOf(split, count, size) {
  return Array.from({ length: count }, (_, index) => {
    const angle = (2 * Math.PI * index) / count + (split === "test" ? 0.2 : 0);
    const eye = [2.2 * Math.cos(angle), 1.6 * Math.sin(angle), 1.4];
    const camera = cameraOf(lookAt(eye, [0, 0, 1.1], kUp), 70, size);
    return { split, index, name: String(index).padStart(4, "0"), camera, photo: true };
  });
}

const kSize = [240, 135];
const run = (method, title, layers, scales, surfels, cut = true) => ({
  name: `${method} (seed 0)`,
  method,
  title,
  folder: `out/small/runs/room_1/${method}/0`,
  surfels,
  total: Object.values(surfels).reduce((sum, n) => sum + n, 0),
  layers,
  scales,
  styles: ["image", "discs", "points"],
  cut,
});

export const kHello = {
  type: "hello",
  version: 1,
  title: "room_1",
  device: "a processor",
  threads: 2,
  scene: {
    name: "room_1",
    dataset: "glassroom",
    up: kUp,
    center: [0, 0, 1.2],
    radius: 3,
    low: [-3, -2.2, 0],
    high: [3, 2.2, 2.6],
    kind: "room",
  },
  size: kSize,
  video: true,
  fps: 30,
  runs: [
    run("glint", "GLINT", kGlass, ["reflection", "transmission", "transparency"], {
      interface: 61234,
      transmission: 20480,
      reflection: 9216,
    }),
    run("2dgs", "2DGS", kPlain, [], { surfels: 83211 }),
  ],
  views: [...viewsOf("test", 6, kSize), ...viewsOf("train", 18, kSize)],
  training: null,
};
