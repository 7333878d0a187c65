// Vectors of three numbers, quaternions (w, x, y, z).

export const add = (a, b) => a.map((value, i) => value + b[i]);
export const sub = (a, b) => a.map((value, i) => value - b[i]);
export const scaled = (a, s) => a.map((value) => s * value);
export const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
export const length = (a) => Math.sqrt(dot(a, a));
export const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
export const radians = (degrees) => (degrees * Math.PI) / 180;
export const degrees = (angle) => (angle * 180) / Math.PI;

export const cross = ([ax, ay, az], [bx, by, bz]) => [
  ay * bz - az * by,
  az * bx - ax * bz,
  ax * by - ay * bx,
];

// A vector without length stays as it is.
export function normalized(a) {
  const norm = length(a);
  return norm > 0 ? scaled(a, 1 / norm) : a;
}

// `v` about the unit vector `axis` by `angle` radians, right-handed [Rodrigues].
export function rotated(v, axis, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const along = scaled(axis, dot(axis, v) * (1 - c));
  return add(add(scaled(v, c), scaled(cross(axis, v), s)), along);
}

// A unit vector at a right angle to `axis`.
export const anyAcross = (axis) =>
  normalized(cross(axis, Math.abs(axis[0]) < 0.9 * length(axis) ? [1, 0, 0] : [0, 1, 0]));

// Of the rotation whose columns are the three unit vectors: the largest part first, which is exact
// for every rotation.
export function quaternionOf([a, b, c]) {
  const [xx, yy, zz] = [a[0], b[1], c[2]];
  const squares = [1 + xx + yy + zz, 1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz];
  const largest = squares.indexOf(Math.max(...squares));
  const [wx, wy, wz] = [b[2] - c[1], c[0] - a[2], a[1] - b[0]];
  const [xy, xz, yz] = [a[1] + b[0], c[0] + a[2], b[2] + c[1]];
  const rows = [
    [squares[0], wx, wy, wz],
    [wx, squares[1], xy, xz],
    [wy, xy, squares[2], yz],
    [wz, xz, yz, squares[3]],
  ];
  return normalized(rows[largest]);
}

// The columns of the rotation of a quaternion of any length.
export function columnsOf(quaternion) {
  const [w, x, y, z] = normalized(quaternion);
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
  ];
}
