// The viewer's maths, paths and messages, in Node.js alone.
import assert from "node:assert/strict";
import test from "node:test";
import * as camera from "../../../../reports/show/viewer/web/src/camera.js";
import * as cut from "../../../../reports/show/viewer/web/src/cut.js";
import * as frusta from "../../../../reports/show/viewer/web/src/frusta.js";
import * as look from "../../../../reports/show/viewer/web/src/look.js";
import * as motions from "../../../../reports/show/viewer/web/src/motions.js";
import { pathCameras, pathFile } from "../../../../reports/show/viewer/web/src/path_file.js";
import {
  packFrame,
  parseFrame,
  waitAfter,
} from "../../../../reports/show/viewer/web/src/protocol.js";
import { Spline } from "../../../../reports/show/viewer/web/src/spline.js";
import * as states from "../../../../reports/show/viewer/web/src/state.js";
import { pinch } from "../../../../reports/show/viewer/web/src/touch.js";
import * as vectors from "../../../../reports/show/viewer/web/src/vectors.js";
import { kHello } from "./viewer_hello.mjs";

const { dot, length, sub } = vectors;
const kUp = [0, 0, 1];

function near(found, expected, what = "", tolerance = 1e-9) {
  assert.equal(found.length, expected.length, what);
  found.forEach((value, i) =>
    assert.ok(Math.abs(value - expected[i]) < tolerance, `${what}: ${found} for ${expected}`),
  );
}

const rigAt = (mode, eye = [0, -4, 0]) => ({
  pose: camera.lookAt(eye, [0, 0, 0], kUp),
  pivot: [0, 0, 0],
  up: kUp,
  fov: 60,
  speed: 1,
  mode,
});

test("a look at a point is level and right-handed", () => {
  const pose = camera.lookAt([1, -4, 2], [0, 0, 0.5], kUp);
  near([dot(pose.right, kUp)], [0], "level");
  near(vectors.cross(pose.right, pose.down), pose.forward, "right-handed");
  assert.ok(dot(pose.down, kUp) < 0, "down is down");
  const straight = camera.lookAt([0, 0, 3], [0, 0, 0], kUp);
  near([length(straight.right)], [1], "straight down has axes, too");
});

test("matrices and seven numbers keep a pose", () => {
  const pose = camera.turned(camera.lookAt([1, 2, 3], [4, -1, 0], kUp), kUp, 2.5, 0.3);
  for (const same of [
    camera.poseOf(camera.matrixOf(pose)),
    camera.poseOfNumbers(camera.numbersOf(pose)),
  ])
    for (const axis of ["right", "down", "forward", "position"]) near(same[axis], pose[axis], axis);
});

test("a camera projects as the conventions say", () => {
  const pose = { right: [1, 0, 0], down: [0, 1, 0], forward: [0, 0, 1], position: [0, 0, 0] };
  const lens = camera.cameraOf(pose, 90, [200, 100]);
  near(camera.projected(lens, [0, 0, 2]), [100, 50, 2], "the middle is half the width");
  near(camera.projected(lens, [1, 0.5, 1]), [200, 100, 1], "x to the right, y down");
  near([camera.fovOf(lens)], [90], "the angle of view comes back");
});

test("flying turns with the pointer, and not over the pole", () => {
  const right = motions.turn(rigAt("fly"), 0.1, 0);
  assert.ok(right.pose.forward[0] < 0, "dragged to the right: it looks to the left");
  near(right.pose.position, [0, -4, 0], "it stays where it is");
  const up = motions.turn(rigAt("fly"), 0, 50);
  assert.ok(camera.elevationOf(up.pose, kUp) < Math.PI / 2);
  assert.ok(dot(up.pose.down, kUp) <= 0, "never upside down");
});

test("an orbit keeps its distance and its look", () => {
  const rig = motions.turn(rigAt("orbit"), 0.2, 0.1);
  near([length(rig.pose.position)], [4], "distance");
  near(rig.pose.forward, vectors.scaled(rig.pose.position, -0.25), "it looks at the pivot");
  assert.ok(rig.pose.position[0] < 0 && rig.pose.position[2] > 0, "the scene follows the pointer");
  near([length(motions.dolly(rig, 0.5).pose.position)], [2], "half as far");
});

test("what lies at the pivot stays under the pointer while panning", () => {
  const rig = rigAt("fly");
  const panned = motions.pan(rig, 0.25, -0.1);
  const lens = camera.cameraOf(panned.pose, 60, [400, 200]);
  near(camera.projected(lens, rig.pivot).slice(0, 2), [200 + 100, 100 - 40], "pixels");
  const orbit = motions.pan(rigAt("orbit"), 0.25, -0.1);
  const came = sub(orbit.pose.position, [0, -4, 0]);
  near(orbit.pivot, came, "the pivot comes along");
});

test("keys walk along the view and the world's up", () => {
  const none = { right: 0, up: 0, forward: 0, turnLeft: 0, turnUp: 0, fast: false };
  near(motions.keys(rigAt("fly"), { ...none, forward: 1 }, 2).pose.position, [0, -2, 0], "ahead");
  near(motions.keys(rigAt("fly"), { ...none, up: -1 }, 1).pose.position, [0, -4, -1], "down");
  const orbit = motions.keys(rigAt("orbit"), { ...none, right: 1 }, 1);
  near(orbit.pivot, [1, 0, 0], "an orbit takes its pivot along");
  const left = motions.keys(rigAt("fly"), { ...none, turnLeft: 1 }, 0.1);
  assert.ok(left.pose.forward[0] < 0, "turns to the left");
  assert.ok(motions.wheel(rigAt("fly"), -1, false).speed > 1, "the wheel is the speed");
});

test("two fingers pan and pinch", () => {
  const before = [
    [0, 0],
    [2, 0],
  ];
  const now = [
    [1, 1],
    [5, 1],
  ];
  assert.deepEqual(pinch(before, now), { dx: 2, dy: 1, ratio: 2 });
  assert.equal(pinch([before[0], before[0]], now).ratio, 1, "fingers in one place have no spread");
});

const keysOf = (eyes) => eyes.map((eye) => ({ pose: camera.lookAt(eye, [0, 0, 0], kUp), fov: 60 }));

test("a spline goes through its keys, smoothly", () => {
  const keys = keysOf([
    [4, 0, 1],
    [0, 4, 1],
    [-5, 0, 2],
    [0, -4, 1],
  ]);
  const spline = new Spline(keys);
  spline.knots.slice(1, -1).forEach((knot, i) => {
    const { pose, fov } = spline.at(knot / spline.length);
    near(pose.position, keys[i].pose.position, `key ${i}`, 1e-6);
    near(pose.forward, keys[i].pose.forward, `key ${i}`, 1e-6);
    near([fov], [60], "angle of view", 1e-6);
  });
  const places = spline.frames(400).map(({ pose }) => pose.position);
  const steps = places.slice(1).map((place, i) => sub(place, places[i]));
  const bends = steps.slice(1).map((step, i) => length(sub(step, steps[i])));
  assert.ok(Math.max(...bends) < 0.1 * Math.max(...steps.map(length)), "no corner");
});

test("odd paths: one key, keys twice, keys that only zoom", () => {
  const [a] = keysOf([[4, 0, 1]]);
  assert.equal(new Spline([a]).at(0.7), a);
  assert.equal(new Spline([a, { ...a }]).at(0.7), a);
  const zoom = new Spline([a, { ...a, fov: 30 }]);
  near([zoom.at(0.5).fov], [45], "half way", 1e-6);
  const turnedBy = (angle) => ({ pose: camera.turned(a.pose, kUp, angle, 0), fov: 60 });
  const { pose } = new Spline([turnedBy(2.9), turnedBy(3.4)]).at(0.5);
  near(pose.forward, turnedBy(3.15).pose.forward, "the short way", 1e-6);
});

test("a path file is as render reads it", () => {
  const keys = keysOf([
    [4, 0, 1],
    [0, 4, 1],
  ]);
  keys[1].fov = 40;
  const cameras = pathCameras(keys, { fps: 10, seconds: 2 }, [320, 180]);
  assert.equal(cameras.length, 20);
  const file = pathFile(cameras, 10);
  assert.deepEqual([file.schema, file.fps, file.width, file.height], [1, 10, 320, 180]);
  near([file.cx, file.cy], [160, 90]);
  near([camera.fovOf({ ...file, fx: file.fx })], [60], "the first key's lens", 1e-4);
  near([camera.fovOf(file.frames.at(-1))], [40], "a frame's own lens", 1e-4);
  assert.deepEqual(file.frames[0].world_from_cam.at(-1), [0, 0, 0, 1]);
  assert.equal(pathCameras(keys, { fps: 1e6, seconds: 1e6 }, [320, 180]).length, 6000, "no more");
  assert.ok(JSON.stringify(pathCameras(keys, { fps: 1e6, seconds: 1 }, [320, 180])).length < 4e6);
});

test("a plane cuts the box where it says", () => {
  const box = { low: [-1, -2, 0], high: [3, 2, 4] };
  const plain = { axis: "x", direction: [0, 0, 1], flipped: false, share: 0.25 };
  assert.deepEqual(cut.planeOf(plain, box), { normal: [1, 0, 0], offset: 0 });
  assert.equal(cut.cutText(plain, box), "x = 0.00 m");
  const flipped = cut.planeOf({ ...plain, flipped: true }, box);
  near([...flipped.normal, flipped.offset], [-1, 0, 0, -2], "x < 2 goes");
  assert.equal(cut.planeOf({ ...plain, axis: null }, box), null);
  const view = cut.planeOf({ ...plain, axis: "view", share: 1 }, box);
  near([...view.normal, view.offset], [0, 0, -1, 0], "nothing goes at the end");
});

test("frusta are clipped and found", () => {
  const at = (x, depth) => ({
    ...camera.cameraOf(camera.lookAt([x, 0, 0], [x, 9, 0], kUp), 60, [100, 100]),
    depth,
  });
  const viewer = camera.cameraOf(camera.lookAt([0, -4, 0], [0, 0, 0], kUp), 60, [200, 100]);
  const pyramids = [at(0), at(1), at(0.2)].map((one) => frusta.frustumOf(one, 0.5));
  assert.equal(frusta.segmentsOf(pyramids[0]).length, 8);
  assert.equal(frusta.frustumAt(pyramids, viewer, [100, 50], 3), 0);
  const [x, y] = camera.projected(viewer, pyramids[1].apex);
  assert.equal(frusta.frustumAt(pyramids, viewer, [x, y], 3), 1);
  assert.equal(frusta.frustumAt(pyramids, viewer, [2, 2], 3), -1);
  const through = frusta.projectedSegment(viewer, [
    [0, -5, 0.1],
    [0, -3, 0.1],
  ]);
  assert.ok(through.flat().every(Number.isFinite), "a line through the camera is cut");
  assert.equal(
    frusta.projectedSegment(viewer, [
      [0, -5, 0],
      [0, -6, 0],
    ]),
    null,
  );
});

test("frames come out as they were packed; torn ones do not", () => {
  const images = [new Uint8Array([1, 2, 3]), new Uint8Array([4])];
  const bytes = packFrame({ type: "frame", serial: 7, size: [2, 1] }, images);
  const { header, images: found } = parseFrame(bytes.buffer);
  assert.equal(header.serial, 7);
  assert.deepEqual(
    found.map((image) => [...image]),
    [[1, 2, 3], [4]],
  );
  for (const length of [0, 3, 4, 20, bytes.length - 1])
    assert.throws(() => parseFrame(bytes.slice(0, length).buffer), /frame|JSON/);
});

test("waits grow and end", () => {
  assert.deepEqual([1, 2, 3, 9].map(waitAfter), [500, 1000, 2000, 10_000]);
});

test("a look is what the server expects", () => {
  const state = states.firstState(kHello);
  state.left = { run: 0, layer: "error" };
  const free = look.lookOf(kHello, state, [900, 700]);
  assert.deepEqual(free.panes, [{ run: 0, layer: "rgb" }], "an error needs a view");
  assert.deepEqual(free.size, kHello.size);
  assert.equal(free.cut, null);
  state.resolution = "window";
  assert.deepEqual(look.lookOf(kHello, state, [900, 700]).size, [900, 700]);
  state.view = { split: "test", index: 0 };
  state.right = { photo: true };
  const snapped = look.lookOf(kHello, state, [900, 700]);
  assert.deepEqual(snapped.panes, [{ run: 0, layer: "error" }], "a photo is no pane");
  assert.deepEqual(snapped.size, [kHello.views[0].camera.width, kHello.views[0].camera.height]);
  near(
    look.cameraOfLook(kHello, free).world_from_cam.flat(),
    kHello.views[0].camera.world_from_cam.flat(),
  );
});

class Params {
  constructor(values) {
    this.values = values;
  }
  get(name, fallback = null) {
    return this.values[name] ?? fallback;
  }
  numbers(name, count) {
    const numbers = this.values[name];
    return numbers?.length === count ? numbers : null;
  }
  number(name, low, high, fallback) {
    return this.values[name] === undefined ? fallback : vectors.clamp(this.values[name], low, high);
  }
  choice(name, allowed, fallback) {
    return allowed.includes(this.values[name]) ? this.values[name] : fallback;
  }
  list(name) {
    return this.values[name];
  }
  flag(name, fallback) {
    return this.values[name] ?? fallback;
  }
}

test("an address brings the state back", () => {
  const state = states.firstState(kHello);
  state.left = { run: 1, layer: "depth" };
  state.right = { run: 0, layer: "rgb" };
  state.rig = motions.turn({ ...state.rig, fov: 75, mode: "orbit" }, 0.1, 0.02);
  state.up = "-y";
  state.rig.up = [0, -1, 0];
  state.scales.reflection = 2;
  state.hidden = states.setsOf(kHello.runs).slice(0, 1);
  state.cut = { axis: "view", direction: [0, 1, 0], flipped: true, share: 0.3 };
  const values = states.addressValues(kHello, state);
  const back = states.stateOfAddress(kHello, new Params(values));
  near(back.rig.pose.forward, state.rig.pose.forward, "pose", 1e-4);
  for (const name of ["left", "right", "up", "scales", "hidden", "cut"])
    assert.deepEqual(back[name], state[name], name);
  const odd = states.stateOfAddress(kHello, new Params({ left: "gone", view: "test:99", up: "q" }));
  assert.deepEqual([odd.left.run, odd.view, odd.up], [0, null, "scene"], "nonsense is left out");
});
