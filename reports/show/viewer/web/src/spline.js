// A smooth way of the camera through keys: Catmull-Rom polynomials [Catmull74] of position,
// quaternion and angle of view, on knots as far apart as the keys; the same curve as
// `render --path spline`.
import { numbersOf, poseOfNumbers } from "./camera.js";
import { dot, length, scaled, sub } from "./vectors.js";

const kSame = 1e-9; // metres and radians

const angleBetween = (a, b) => 2 * Math.acos(Math.min(1, Math.abs(dot(a, b))));

// Eight numbers a key: position, quaternion on the short way from the last, angle of view.
function nodesOf(keys) {
  const nodes = [];
  for (const { pose, fov } of keys) {
    const node = [...numbersOf(pose), fov];
    const last = nodes.at(-1);
    if (last) {
      const [before, after] = [last, node].map((n) => n.slice(3, 7));
      if (dot(before, after) < 0) node.splice(3, 4, ...scaled(after, -1));
      if (stepBetween(last, node, 1) < kSame && last[7] === fov) continue;
    }
    nodes.push(node);
  }
  return nodes;
}

const distance = (a, b) => length(sub(a.slice(0, 3), b.slice(0, 3)));

// A mean distance counts as much as a radian.
function stepBetween(a, b, mean) {
  const metres = mean > 0 ? distance(a, b) / mean : 0;
  return metres + angleBetween(a.slice(3, 7), b.slice(3, 7));
}

function knotsOf(nodes) {
  const pairs = nodes.slice(1).map((node, i) => [nodes[i], node]);
  const mean = pairs.reduce((sum, [a, b]) => sum + distance(a, b), 0) / pairs.length;
  const knots = [0];
  // Keys that differ in the angle of view alone are a little apart, too.
  for (const [a, b] of pairs) knots.push(knots.at(-1) + Math.max(stepBetween(a, b, mean), 1e-3));
  return knots;
}

// The polynomial through p[1] and p[2] at t[1] <= x <= t[2], by the pyramid of [Barry88].
function catmullRom(p, t, x) {
  const mix = (a, b, i, j) =>
    a.map((value, k) => ((t[j] - x) * value + (x - t[i]) * b[k]) / (t[j] - t[i]));
  const [a, b, c] = [0, 1, 2].map((i) => mix(p[i], p[i + 1], i, i + 1));
  return mix(mix(a, b, 0, 2), mix(b, c, 1, 3), 1, 2);
}

const mirrored = (end, next) => end.map((value, i) => 2 * value - next[i]);

export class Spline {
  // keys: [{pose, fov}]; such as stand and look like the one before are left out.
  constructor(keys) {
    const nodes = nodesOf(keys);
    this.single = nodes.length < 2 ? keys[0] : null;
    if (this.single) return;
    const knots = knotsOf(nodes);
    this.length = knots.at(-1);
    this.nodes = [mirrored(nodes[0], nodes[1]), ...nodes, mirrored(nodes.at(-1), nodes.at(-2))];
    this.knots = [-knots[1], ...knots, 2 * knots.at(-1) - knots.at(-2)];
  }

  // share: 0 at the first key, 1 at the last.
  at(share) {
    if (this.single) return this.single;
    const x = Math.min(1, Math.max(0, share)) * this.length;
    let i = 1;
    while (i < this.knots.length - 3 && this.knots[i + 1] <= x) ++i;
    const numbers = catmullRom(this.nodes.slice(i - 1), this.knots.slice(i - 1), x);
    return { pose: poseOfNumbers(numbers.slice(0, 7)), fov: numbers[7] };
  }

  frames(count) {
    return Array.from({ length: count }, (_, i) => this.at(count > 1 ? i / (count - 1) : 0));
  }
}
