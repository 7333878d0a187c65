// Mouse, fingers, wheel and held keys on the picture.
import { isForPage } from "../../../page/web/src/keys.js";
import * as motions from "./motions.js";
import { pinch } from "./touch.js";
import { clamp } from "./vectors.js";

const kDragPixels = 4; // less is a click
const kNotch = 100; // of a wheel, pixels
const kLongestStep = 0.1; // seconds; after a pause of the browser nobody jumps
const kShortestStep = 1 / 120;
// KeyboardEvent.code -> what it moves; codes are places on the keyboard, whatever the letters.
const kHeld = {
  KeyW: ["forward", 1],
  KeyS: ["forward", -1],
  KeyD: ["right", 1],
  KeyA: ["right", -1],
  KeyE: ["up", 1],
  KeyQ: ["up", -1],
  ArrowLeft: ["turnLeft", 1],
  ArrowRight: ["turnLeft", -1],
  ArrowUp: ["turnUp", 1],
  ArrowDown: ["turnUp", -1],
};

const place = (event) => [event.clientX, event.clientY];

export class Controls {
  // actions: rig(), move(rig), point([u, v] or null), click(u, v), pick(u, v)
  constructor(element, actions) {
    Object.assign(this, { element, actions, pointers: new Map() });
    Object.assign(this, { held: new Set(), released: new Set() });
    const on = (name, handler, options) => element.addEventListener(name, handler, options);
    on("pointerdown", (event) => this.#press(event));
    on("pointermove", (event) => this.#moved(event));
    on("pointerup", (event) => this.#release(event));
    on("pointercancel", (event) => this.#release(event));
    on("pointerleave", (event) => this.#leave(event));
    on("dblclick", (event) => actions.pick(...this.#shares(event)));
    on("contextmenu", (event) => event.preventDefault());
    on("wheel", (event) => this.#wheel(event), { passive: false });
    this.ending = new AbortController();
    const { signal } = this.ending;
    document.addEventListener("keydown", (event) => this.#key(event), { signal });
    document.addEventListener("keyup", ({ code }) => this.released.add(code), { signal });
    window.addEventListener("blur", () => this.held.clear(), { signal });
  }

  stop() {
    this.ending.abort();
    this.held.clear();
  }

  #box() {
    return this.element.getBoundingClientRect();
  }

  #shares(event) {
    const box = this.#box();
    return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  }

  #press(event) {
    this.element.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, place(event));
    this.travelled = this.pointers.size > 1 ? kDragPixels : 0;
    this.pans = event.button > 0 || event.shiftKey;
  }

  #moved(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return this.actions.point(this.#shares(event));
    const fingers = [...this.pointers.values()];
    this.pointers.set(event.pointerId, place(event));
    const now = [...this.pointers.values()];
    if (fingers.length === 2) this.#pinch(fingers, now);
    else if (fingers.length === 1) this.#drag(before, now[0]);
  }

  // A click that trembles is no drag.
  #drag(before, now) {
    const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
    this.travelled += Math.abs(dx) + Math.abs(dy);
    if (this.travelled < kDragPixels) return;
    const { width } = this.#box();
    const motion = this.pans ? motions.pan : motions.turn;
    this.element.classList.add("dragged");
    this.actions.point(null);
    this.actions.move(motion(this.actions.rig(), dx / width, dy / width));
  }

  #pinch(before, now) {
    const { width } = this.#box();
    const { dx, dy, ratio } = pinch(before, now);
    const panned = motions.pan(this.actions.rig(), dx / width, dy / width);
    this.actions.move(motions.dolly(panned, 1 / ratio));
  }

  #release(event) {
    const pressed = this.pointers.delete(event.pointerId);
    this.element.classList.remove("dragged");
    const isClick = event.type === "pointerup" && event.button === 0;
    if (!pressed || !isClick || this.travelled >= kDragPixels) return;
    this.actions.point(this.#shares(event));
    this.actions.click(...this.#shares(event));
  }

  // A finger has no place between touches: where it tapped stays pointed at.
  #leave({ pointerType }) {
    if (this.pointers.size === 0 && pointerType !== "touch") this.actions.point(null);
  }

  #wheel(event) {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? kNotch / 3 : 1;
    const steps = (event.deltaY * lines) / kNotch;
    const before = this.actions.rig();
    const rig = motions.wheel(before, steps, event.ctrlKey);
    if (rig.pose === before.pose) this.actions.speed(rig.speed);
    else this.actions.move(rig);
  }

  #key(event) {
    if (!isForPage(event) || !kHeld[event.code]) return;
    event.preventDefault();
    this.fast = event.shiftKey;
    this.released.delete(event.code);
    if (this.held.size === 0) this.#walk();
    this.held.add(event.code);
  }

  // For as long as keys are held; a key that is only touched moves by a step, too.
  #walk() {
    let last = performance.now();
    const step = (now) => {
      if (this.held.size === 0) return;
      const seconds = clamp((now - last) / 1000, kShortestStep, kLongestStep);
      last = now;
      this.actions.move(motions.keys(this.actions.rig(), this.#directions(), seconds));
      for (const code of this.released) this.held.delete(code);
      this.released.clear();
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  #directions() {
    const held = { right: 0, up: 0, forward: 0, turnLeft: 0, turnUp: 0, fast: this.fast };
    for (const code of this.held) held[kHeld[code][0]] += kHeld[code][1];
    return held;
  }
}
