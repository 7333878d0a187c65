// Poses and lenses. A pose has the camera's axes in the world (right, down, forward: OpenCV's) and
// its position in metres; a lens is the angle of view of its width.
import {
  add,
  anyAcross,
  clamp,
  columnsOf,
  cross,
  degrees,
  dot,
  length,
  normalized,
  quaternionOf,
  radians,
  rotated,
  scaled,
  sub,
} from "./vectors.js";

export const kFovLow = 10;
export const kFovHigh = 130; // degrees
const kSteepest = radians(89); // of looking up or down

// Of four rows of four numbers, world from camera.
export function poseOf(rows) {
  const column = (i) => [rows[0][i], rows[1][i], rows[2][i]];
  return { right: column(0), down: column(1), forward: column(2), position: column(3) };
}

export function matrixOf({ right, down, forward, position }) {
  const row = (i) => [right[i], down[i], forward[i], position[i]];
  return [row(0), row(1), row(2), [0, 0, 0, 1]];
}

// Seven numbers: position, quaternion.
export const numbersOf = ({ right, down, forward, position }) => [
  ...position,
  ...quaternionOf([right, down, forward]),
];

export function poseOfNumbers(numbers) {
  const [right, down, forward] = columnsOf(numbers.slice(3));
  return { right, down, forward, position: numbers.slice(0, 3) };
}

// The same view without roll: the horizon is level.
export function levelled(pose, up) {
  const across = cross(pose.forward, up);
  const right = length(across) > 1e-6 ? normalized(across) : anyAcross(pose.forward);
  return { ...pose, right, down: cross(pose.forward, right) };
}

export function lookAt(eye, target, up) {
  const forward = normalized(sub(target, eye));
  return levelled({ forward, position: eye }, up);
}

const rotatedPose = (pose, axis, angle) => ({
  ...pose,
  right: rotated(pose.right, axis, angle),
  down: rotated(pose.down, axis, angle),
  forward: rotated(pose.forward, axis, angle),
});

// Above the horizon, radians.
export const elevationOf = (pose, up) => Math.asin(clamp(dot(pose.forward, up), -1, 1));

// The step that keeps the view off the poles, where left and right would swap.
function allowedPitch(pose, up, pitch) {
  const now = elevationOf(pose, up);
  const [low, high] = [Math.min(-kSteepest, now), Math.max(kSteepest, now)];
  return clamp(now + pitch, low, high) - now;
}

// To the left by `yaw` about `up`, upwards by `pitch`, radians; about `pivot` where there is one.
export function turned(pose, up, yaw, pitch, pivot = pose.position) {
  const rise = allowedPitch(pose, up, pitch);
  const level = rotatedPose(pose, pose.right, rise);
  const arm = rotated(sub(pose.position, pivot), pose.right, rise);
  const result = rotatedPose(level, up, yaw);
  return { ...result, position: add(pivot, rotated(arm, up, yaw)) };
}

export const moved = (pose, offset) => ({ ...pose, position: add(pose.position, offset) });

// [right, up, forward] metres: along the picture's right, the world's up, the view.
export const walk = (pose, up, [right, rise, forward]) =>
  add(add(scaled(pose.right, right), scaled(up, rise)), scaled(pose.forward, forward));

// Pixels of the focal length at a width.
export const focalOf = (fov, width) => width / 2 / Math.tan(radians(fov) / 2);
export const fovOf = ({ fx, width }) => 2 * degrees(Math.atan(width / 2 / fx));

// The whole camera of files and messages.
export function cameraOf(pose, fov, [width, height]) {
  const focal = focalOf(fov, width);
  const lens = { width, height, fx: focal, fy: focal, cx: width / 2, cy: height / 2 };
  return { world_from_cam: matrixOf(pose), ...lens };
}

// x, y in pixels, depth z in metres; behind the camera z is negative, x and y mean nothing.
export function projected(camera, point) {
  const pose = poseOf(camera.world_from_cam);
  const offset = sub(point, pose.position);
  const z = dot(offset, pose.forward);
  const x = (camera.fx * dot(offset, pose.right)) / z + camera.cx;
  const y = (camera.fy * dot(offset, pose.down)) / z + camera.cy;
  return [x, y, z];
}
