// What is drawn over the picture: cameras of the views, the recorded path, the pivot.
import { frustumAt, frustumOf, projectedSegment, segmentsOf } from "./frusta.js";
import { length, sub } from "./vectors.js";
import { Spline } from "./spline.js";

const kSize = 0.035; // of a frustum, times the scene's radius
const kInside = 0.5; // frusta: nearer than so many of their depths, one stands in it
const kReach = 8; // pixels of the window around an apex
const kPathSteps = 24; // lines between two keys
const kColors = { train: "#7fb2ff", test: "#ffb454", path: "#ff6fae", pivot: "#ffffff" };

export class Overlay {
  constructor(canvas, hello) {
    this.canvas = canvas;
    this.depth = kSize * hello.scene.radius;
    this.views = hello.views;
    this.frusta = hello.views.map(({ camera }) => frustumOf(camera, this.depth));
    this.hovered = -1;
  }

  // The frustum at u, v (shares of the picture); -1: none. `camera`: of the frame that is shown.
  at(camera, [u, v]) {
    const reach = (kReach * camera.width) / this.canvas.clientWidth;
    const near = this.frusta.map((frustum) => (this.#isInside(camera, frustum) ? null : frustum));
    const shown = near.map((frustum, i) => [frustum, i]).filter(([frustum]) => frustum);
    const found = frustumAt(
      shown.map(([frustum]) => frustum),
      camera,
      [u * camera.width, v * camera.height],
      reach,
    );
    return found < 0 ? -1 : shown[found][1];
  }

  #isInside(camera, { apex }) {
    const position = camera.world_from_cam.slice(0, 3).map((row) => row[3]);
    return length(sub(apex, position)) < kInside * this.depth;
  }

  // what: {frusta: bool, keys: [{pose, fov}], pivot: [x, y, z] or null}
  draw(camera, { frusta, keys, pivot }) {
    const context = this.canvas.getContext("2d");
    const { width, height } = this.canvas;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, width, height);
    if (!camera) return;
    this.context = context;
    this.pixel = window.devicePixelRatio || 1;
    this.scale = [width / camera.width, height / camera.height];
    if (frusta) this.#drawFrusta(camera);
    if (keys.length > 0) this.#drawPath(camera, keys);
    if (pivot) this.#drawPivot(camera, pivot);
  }

  // A dark line under a light one is seen on any picture.
  #stroke(camera, segments, color, alpha, width) {
    const { context, scale, pixel } = this;
    const path = new Path2D();
    for (const segment of segments) {
      const ends = projectedSegment(camera, segment);
      if (!ends) continue;
      const [from, to] = ends.map(([x, y]) => [x * scale[0], y * scale[1]]);
      path.moveTo(...from);
      path.lineTo(...to);
    }
    context.globalAlpha = alpha;
    context.lineJoin = "round";
    context.strokeStyle = "rgb(0 0 0 / 55%)";
    context.lineWidth = (width + 1.5) * pixel;
    context.stroke(path);
    context.strokeStyle = color;
    context.lineWidth = width * pixel;
    context.stroke(path);
    context.globalAlpha = 1;
  }

  #drawFrusta(camera) {
    this.frusta.forEach((frustum, i) => {
      if (i === this.hovered || this.#isInside(camera, frustum)) return;
      this.#stroke(camera, segmentsOf(frustum), kColors[this.views[i].split], 0.5, 1);
    });
    const frustum = this.frusta[this.hovered];
    if (frustum)
      this.#stroke(camera, segmentsOf(frustum), kColors[this.views[this.hovered].split], 1, 2);
  }

  #drawPath(camera, keys) {
    const points = new Spline(keys)
      .frames(kPathSteps * keys.length)
      .map(({ pose }) => pose.position);
    const lines = points.slice(1).map((point, i) => [points[i], point]);
    this.#stroke(camera, lines, kColors.path, 0.9, 1.5);
    for (const { pose, fov } of keys) {
      const lens = {
        width: 16,
        height: 9,
        fx: 8 / Math.tan((fov * Math.PI) / 360),
        cx: 8,
        cy: 4.5,
      };
      const { right, down, forward, position } = pose;
      const world_from_cam = [0, 1, 2].map((i) => [right[i], down[i], forward[i], position[i]]);
      const frustum = frustumOf({ ...lens, fy: lens.fx, world_from_cam }, this.depth);
      if (!this.#isInside(camera, frustum))
        this.#stroke(camera, segmentsOf(frustum), kColors.path, 0.9, 1);
    }
  }

  #drawPivot(camera, pivot) {
    const arm = 0.4 * this.depth;
    const lines = [0, 1, 2].map((axis) =>
      [-arm, arm].map((step) => pivot.map((value, i) => value + (i === axis ? step : 0))),
    );
    this.#stroke(camera, lines, kColors.pivot, 0.8, 1.5);
  }
}
