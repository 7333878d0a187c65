// The camera path as `render --path` reads it.
import { cameraOf } from "./camera.js";
import { Spline } from "./spline.js";

const kMostFrames = 6000; // a message of them stays below 4 MiB

const rounded = (value) => Number(value.toPrecision(9));

function compact({ world_from_cam, ...lens }) {
  const numbers = Object.entries(lens).map(([name, value]) => [name, rounded(value)]);
  return {
    world_from_cam: world_from_cam.map((row) => row.map(rounded)),
    ...Object.fromEntries(numbers),
  };
}

// Cameras of the frames of a way through the keys.
export function pathCameras(keys, { fps, seconds }, size) {
  const count = Math.min(kMostFrames, Math.max(1, Math.round(fps * seconds)));
  return new Spline(keys).frames(count).map(({ pose, fov }) => compact(cameraOf(pose, fov, size)));
}

const sameLens = (a, b) => a.fx === b.fx && a.width === b.width;

// The lens of the first camera for all; frames with another have their own.
export function pathFile(cameras, fps) {
  const { world_from_cam: _, ...lens } = cameras[0];
  const frames = cameras.map((camera) =>
    sameLens(camera, lens) ? { world_from_cam: camera.world_from_cam } : camera,
  );
  return { schema: 1, fps, ...lens, frames };
}
