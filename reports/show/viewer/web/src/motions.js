// What drags, keys, wheels and fingers do to the rig: {pose, pivot, up, fov, speed (metres a
// second), mode ("fly", "orbit")}. Distances on the picture are shares of its width.
import { moved, turned, walk } from "./camera.js";
import { add, clamp, dot, radians, scaled, sub } from "./vectors.js";

const kOrbitTurn = Math.PI; // radians for a drag over the whole width
const kKeyTurn = radians(60); // a second
const kFast = 4; // with Shift
const kSpeeds = [0.01, 100]; // metres a second

// How far away what one drags is, metres.
function dragDepth({ pose, pivot, speed }) {
  const depth = dot(sub(pivot, pose.position), pose.forward);
  return Math.max(depth, 0.5 * speed);
}

// One finger, left button. Orbit: the scene turns with the pointer; fly: the picture follows it.
export function turn(rig, dx, dy) {
  if (rig.mode === "orbit") {
    const { pose, up, pivot } = rig;
    return { ...rig, pose: turned(pose, up, -kOrbitTurn * dx, -kOrbitTurn * dy, pivot) };
  }
  const angle = radians(rig.fov);
  return { ...rig, pose: turned(rig.pose, rig.up, angle * dx, angle * dy) };
}

// What lies at the pivot's depth stays under the pointer.
export function pan(rig, dx, dy) {
  const size = 2 * Math.tan(radians(rig.fov) / 2) * dragDepth(rig);
  const { right, down } = rig.pose;
  return shift(rig, add(scaled(right, -dx * size), scaled(down, -dy * size)));
}

// In an orbit the pivot comes along.
function shift(rig, offset) {
  const pivot = rig.mode === "orbit" ? add(rig.pivot, offset) : rig.pivot;
  return { ...rig, pose: moved(rig.pose, offset), pivot };
}

// Nearer (factor < 1) or further away: from the pivot, or ahead by as much.
export function dolly(rig, factor) {
  if (rig.mode === "orbit") {
    const arm = sub(rig.pose.position, rig.pivot);
    return { ...rig, pose: { ...rig.pose, position: add(rig.pivot, scaled(arm, factor)) } };
  }
  return { ...rig, pose: moved(rig.pose, scaled(rig.pose.forward, -Math.log(factor) * rig.speed)) };
}

export const faster = (rig, factor) => ({ ...rig, speed: clamp(rig.speed * factor, ...kSpeeds) });

// The wheel by `steps` notches towards the user. A pinch on a touchpad dollies in both modes.
export function wheel(rig, steps, pinched) {
  if (rig.mode === "orbit" || pinched) return dolly(rig, Math.exp(0.12 * steps));
  return faster(rig, Math.exp(-0.15 * steps));
}

// `held`: {right, up, forward, turnLeft, turnUp, fast}, of which the numbers are -1, 0 or 1.
export function keys(rig, held, seconds) {
  const distance = rig.speed * (held.fast ? kFast : 1) * seconds;
  const steps = [held.right, held.up, held.forward].map((direction) => direction * distance);
  const there = shift(rig, walk(rig.pose, rig.up, steps));
  const pivot = rig.mode === "orbit" ? there.pivot : undefined;
  const [yaw, pitch] = [held.turnLeft, held.turnUp].map((way) => way * kKeyTurn * seconds);
  if (rig.mode === "orbit")
    return { ...there, pose: turned(there.pose, rig.up, -yaw, -pitch, pivot) };
  return { ...there, pose: turned(there.pose, rig.up, yaw, pitch) };
}
