// The 3D view, a bundle of its own: it is loaded when meshes are opened.
import {
  AmbientLight,
  BackSide,
  Box3,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  FrontSide,
  Group,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  PerspectiveCamera,
  Plane,
  Scene,
  Spherical,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { codes16, unpack } from "./data.js";

const kFrontColor = 0xb8c4d4;
const kBackColor = 0xd98324;
const kFieldOfView = 45;
const kHome = new Vector3(0.6, -1, 0.7).normalize(); // from the middle of the mesh to the eye
const kMargin = 1.05;

const cornersOf = ({ min, max }) =>
  [...Array(8).keys()].map(
    (i) => new Vector3(i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z),
  );

// How far the eye must be from the middle of a box, in the direction `to`, to see all its corners.
function fittingDistance(box, to, up, aspect) {
  const center = box.getCenter(new Vector3());
  const right = up.clone().cross(to).normalize();
  const top = to.clone().cross(right);
  const tan = Math.tan((kFieldOfView * Math.PI) / 360);
  let distance = 0;
  for (const corner of cornersOf(box)) {
    corner.sub(center);
    const beside = Math.abs(corner.dot(right)) / (tan * aspect);
    const above = Math.abs(corner.dot(top)) / tan;
    distance = Math.max(distance, corner.dot(to) + kMargin * Math.max(beside, above));
  }
  return distance || 1;
}

async function geometryOf(data) {
  const codes = codes16(await unpack(data.position));
  const positions = new Float32Array(codes.length);
  for (let i = 0; i < codes.length; ++i) {
    const axis = i % 3;
    positions[i] = data.low[axis] + (codes[i] / 65535) * (data.high[axis] - data.low[axis]);
  }
  const index = await unpack(data.index);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(new Uint32Array(index.buffer, 0, index.length / 4), 1));
  if (data.color)
    geometry.setAttribute("color", new BufferAttribute(await unpack(data.color), 3, true));
  geometry.computeVertexNormals();
  return geometry;
}

// Fronts are lit, backs are of one colour that shows where a surface is seen from behind or cut.
function meshOf(geometry, { wire, backs }, planes) {
  const colored = geometry.hasAttribute("color");
  const common = { wireframe: wire, clippingPlanes: planes };
  const front = new MeshLambertMaterial({
    color: colored ? 0xffffff : kFrontColor,
    vertexColors: colored,
    side: FrontSide,
    flatShading: !colored,
    ...common,
  });
  const back = new MeshBasicMaterial({ color: kBackColor, side: BackSide, ...common });
  const group = new Group();
  group.add(new Mesh(geometry, front));
  if (backs) group.add(new Mesh(geometry, back));
  return group;
}

class MeshView {
  constructor(stage, titles) {
    this.stage = stage;
    this.renderer = new WebGLRenderer({ antialias: true });
    this.renderer.localClippingEnabled = true;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.renderer.domElement.setAttribute("aria-label", titles.join(" and "));
    this.renderer.domElement.setAttribute("role", "img");
    const labels = titles.map((title) => {
      const label = document.createElement("span");
      label.className = "label";
      label.textContent = title;
      return label;
    });
    stage.replaceChildren(this.renderer.domElement, ...labels);
    labels.forEach((label, i) => (label.style.left = `calc(${(100 * i) / labels.length}% + 8px)`));
    this.plane = new Plane(new Vector3(-1, 0, 0), 0);
    this.camera = new PerspectiveCamera(kFieldOfView, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("start", () => (this.atHome = false));
    this.controls.addEventListener("end", () => this.onMove?.());
    // The whole mesh stays in a frame that changes, until the reader chose a view.
    this.watcher = new ResizeObserver(() => (this.atHome ? this.home() : this.draw()));
    this.watcher.observe(stage);
  }

  async add(meshes, options) {
    this.box = new Box3();
    this.scenes = [];
    for (const { data } of meshes) {
      const scene = new Scene();
      const mesh = meshOf(await geometryOf(data), options, [this.plane]);
      const sun = new DirectionalLight(0xffffff, 1.6);
      sun.position.set(0.4, -0.7, 1);
      const lamp = new DirectionalLight(0xffffff, 0.8);
      lamp.position.set(-1, 0.6, 0.3);
      scene.add(mesh, sun, lamp, new AmbientLight(0xffffff, 0.9));
      this.box.expandByObject(mesh);
      this.scenes.push(scene);
    }
    this.home();
  }

  home() {
    const center = this.box.getCenter(new Vector3());
    const aspect = this.stage.clientWidth / this.scenes.length / this.stage.clientHeight || 1;
    const distance = fittingDistance(this.box, kHome, this.camera.up, aspect);
    this.#look(center.clone().addScaledVector(kHome, distance), center, distance);
    this.atHome = true;
    this.onMove?.();
  }

  #look(eye, target, distance) {
    this.camera.near = distance / 500;
    this.camera.far = distance * 10 + this.box.getSize(new Vector3()).length();
    this.camera.position.copy(eye);
    this.controls.target.copy(target);
    this.controls.update();
    this.draw();
  }

  // [x, y, z of the eye, then of what it looks at]; null: the whole mesh.
  get view() {
    if (this.atHome) return null;
    return [...this.camera.position, ...this.controls.target];
  }

  set view(numbers) {
    const [eye, target] = [0, 3].map((i) => new Vector3(...numbers.slice(i, i + 3)));
    this.atHome = false;
    this.#look(eye, target, eye.distanceTo(target) || 1);
  }

  // Drawn at this moment: WebGL keeps no picture for later.
  picture() {
    this.draw();
    return this.renderer.domElement;
  }

  // `share` of the box along the axis is cut away.
  cut(axis, share, flipped) {
    const sign = flipped ? 1 : -1;
    const [low, high] = [this.box.min[axis], this.box.max[axis]];
    const margin = 1e-3 * (high - low) + 1e-6;
    const from = flipped
      ? low - margin + share * (high - low)
      : high + margin - share * (high - low);
    this.plane.normal.set(0, 0, 0)[axis] = sign;
    this.plane.constant = -sign * from;
    this.draw();
  }

  turn(azimuth, polar) {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const toY = new Vector3(offset.x, offset.z, -offset.y); // Spherical has y up
    const sphere = new Spherical().setFromVector3(toY);
    sphere.theta += azimuth;
    sphere.phi = Math.min(Math.PI - 0.01, Math.max(0.01, sphere.phi + polar));
    const turned = new Vector3().setFromSpherical(sphere);
    this.camera.position.set(turned.x, -turned.z, turned.y).add(this.controls.target);
    this.#moved();
  }

  #moved() {
    this.atHome = false;
    this.controls.update();
    this.draw();
    this.onMove?.();
  }

  approach(factor) {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.#moved();
  }

  draw() {
    if (!this.scenes) return;
    const { clientWidth: width, clientHeight: height } = this.stage;
    if (width === 0 || height === 0) return;
    const background = getComputedStyle(document.documentElement)
      .getPropertyValue("--stage")
      .trim();
    this.renderer.setSize(width, height, false);
    this.renderer.setScissorTest(true);
    const share = width / this.scenes.length;
    this.camera.aspect = share / height;
    this.camera.updateProjectionMatrix();
    this.scenes.forEach((scene, i) => {
      scene.background = new Color(background);
      this.renderer.setViewport(i * share, 0, share, height);
      this.renderer.setScissor(i * share, 0, share, height);
      this.renderer.render(scene, this.camera);
    });
  }

  stop() {
    this.watcher.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}

window.GLINT_MESH_VIEW = {
  // meshes: {title, data}, one or two; options: {wire, backs}.
  async open(stage, meshes, options) {
    const view = new MeshView(
      stage,
      meshes.map(({ title }) => title),
    );
    await view.add(meshes, options);
    return view;
  },
};
