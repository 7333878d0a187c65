// Cameras as pyramids: their lines on the picture, and which one lies under the pointer.
import { poseOf, projected } from "./camera.js";
import { add, scaled, sub } from "./vectors.js";

const kNear = 0.02; // metres in front of the camera, from where lines are drawn

// Corners of the picture `depth` metres in front of a camera: [upper left, upper right, ...].
export function frustumOf(camera, depth) {
  const { right, down, forward, position } = poseOf(camera.world_from_cam);
  const corner = (x, y) => {
    const across = scaled(right, ((x - camera.cx) / camera.fx) * depth);
    const below = scaled(down, ((y - camera.cy) / camera.fy) * depth);
    return add(add(position, scaled(forward, depth)), add(across, below));
  };
  const { width, height } = camera;
  const corners = [corner(0, 0), corner(width, 0), corner(width, height), corner(0, height)];
  return { apex: position, corners };
}

// Four from the apex, four around the picture.
export const segmentsOf = ({ apex, corners }) => [
  ...corners.map((corner) => [apex, corner]),
  ...corners.map((corner, i) => [corner, corners[(i + 1) % 4]]),
];

// The part of a segment before the camera in pixels: [[x, y], [x, y]]; null: none.
export function projectedSegment(camera, [from, to]) {
  const pose = poseOf(camera.world_from_cam);
  const depth = (point) =>
    sub(point, pose.position).reduce((s, v, i) => s + v * pose.forward[i], 0);
  const [a, b] = [depth(from), depth(to)];
  if (a < kNear && b < kNear) return null;
  const at = (share) => add(from, scaled(sub(to, from), share));
  const share = (kNear - a) / (b - a);
  const ends = [a < kNear ? at(share) : from, b < kNear ? at(share) : to];
  return ends.map((end) => projected(camera, end).slice(0, 2));
}

// Is [x, y] within the polygon of points?
export function isInside([x, y], points) {
  let inside = false;
  points.forEach(([ax, ay], i) => {
    const [bx, by] = points[(i + 1) % points.length];
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) inside = !inside;
  });
  return inside;
}

// The nearest frustum at a pixel: its picture covers it, or its apex is within `reach` pixels.
// frusta: [{apex, corners}]; -1: none.
export function frustumAt(frusta, camera, pixel, reach) {
  let [best, nearest] = [-1, Infinity];
  frusta.forEach(({ apex, corners }, i) => {
    const [ax, ay, depth] = projected(camera, apex);
    const points = corners.map((corner) => projected(camera, corner));
    if (depth >= nearest || points.some(([, , z]) => z < kNear)) return;
    const isNear = depth > kNear && Math.hypot(ax - pixel[0], ay - pixel[1]) <= reach;
    if (isNear || isInside(pixel, points)) [best, nearest] = [i, depth];
  });
  return best;
}
