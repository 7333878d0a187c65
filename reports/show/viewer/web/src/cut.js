// The cut plane: what has normal . x > offset is not drawn.
import { add, clamp, dot, scaled, sub } from "./vectors.js";

export const kCutAxes = ["x", "y", "z", "view"];

// `direction`: the view's when the plane was chosen. What is nearer to the viewer goes.
function normalOf({ axis, direction, flipped }) {
  const plain =
    axis === "view" ? scaled(direction, -1) : ["x", "y", "z"].map((name) => Number(name === axis));
  return flipped ? scaled(plain, -1) : plain;
}

// Of a box along a direction: [lowest, highest], metres.
export function extentAlong(normal, low, high) {
  const middle = dot(normal, scaled(add(low, high), 0.5));
  const half = dot(normal.map(Math.abs), scaled(sub(high, low), 0.5));
  return [middle - half, middle + half];
}

// cut: {axis ("x", "y", "z", "view" or null), direction, flipped, share (of the box that stays)};
// null: nothing is cut.
export function planeOf(cut, { low, high }) {
  if (!cut.axis) return null;
  const normal = normalOf(cut);
  const [from, to] = extentAlong(normal, low, high);
  return { normal, offset: from + clamp(cut.share, 0, 1) * (to - from) };
}

// Where it stands: "x = 1.20 m", or how much of the box stays.
export function cutText(cut, bounds) {
  const plane = planeOf(cut, bounds);
  if (!plane) return "";
  if (cut.axis === "view") return `${Math.round(100 * cut.share)} % stays`;
  return `${cut.axis} = ${(cut.flipped ? -plane.offset : plane.offset).toFixed(2)} m`;
}
