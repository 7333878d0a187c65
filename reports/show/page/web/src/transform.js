// One zoom and pan for all panes of a view. Positions are fractions of a pane, so that panes of any
// size show the same part of their picture.

const kMaxScale = 64;
const kDragPixels = 4; // less is a click

export class Transform {
  constructor() {
    this.listeners = new Set();
    this.reset();
  }

  reset() {
    Object.assign(this, { scale: 1, x: 0, y: 0 });
    this.changed();
  }

  // [scale, x, y] of an address; null: as it is.
  set(values) {
    if (values) this.#moveTo(Math.min(kMaxScale, Math.max(1, values[0])), values[1], values[2]);
  }

  changed() {
    this.listeners.forEach((listener) => listener(this));
  }

  // `factor` about the point (u, v) of the pane.
  zoom(factor, u = 0.5, v = 0.5) {
    const scale = Math.min(kMaxScale, Math.max(1, this.scale * factor));
    const growth = scale / this.scale;
    this.#moveTo(scale, u - (u - this.x) * growth, v - (v - this.y) * growth);
  }

  pan(dx, dy) {
    this.#moveTo(this.scale, this.x + dx, this.y + dy);
  }

  // The picture never leaves the pane.
  #moveTo(scale, x, y) {
    const lowest = 1 - scale;
    this.scale = scale;
    this.x = Math.min(0, Math.max(lowest, x));
    this.y = Math.min(0, Math.max(lowest, y));
    this.changed();
  }

  // Fractions of the picture from fractions of the pane.
  toPicture(u, v) {
    return [(u - this.x) / this.scale, (v - this.y) / this.scale];
  }

  css() {
    return `translate(${this.x * 100}%, ${this.y * 100}%) scale(${this.scale})`;
  }
}

function fractions(event, element) {
  const box = element.getBoundingClientRect();
  return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
}

const distance = ([a, b]) => Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);

// Wheel, drag, pinch, hover and click on a pane. onHover(u, v), onClick(u, v): fractions of the
// picture; onLeave(). onDrag(u) instead of panning while the picture is not enlarged.
export function watchPointer(pane, transform, { onHover, onClick, onLeave, onDrag }) {
  const pointers = new Map();
  let travelled = 0;
  let spread = 0;
  pane.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      transform.zoom(Math.exp(-event.deltaY * 0.002), ...fractions(event, pane));
    },
    { passive: false },
  );
  pane.addEventListener("pointerdown", (event) => {
    pane.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, event);
    travelled = 0;
    if (pointers.size === 2) spread = distance([...pointers.values()]);
  });
  pane.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    const [u, v] = fractions(event, pane);
    onHover(...transform.toPicture(u, v));
    if (!before) return;
    pointers.set(event.pointerId, event);
    if (pointers.size === 2) {
      const now = distance([...pointers.values()]);
      transform.zoom(now / spread, u, v);
      spread = now;
      travelled = kDragPixels;
      return;
    }
    travelled +=
      Math.abs(event.clientX - before.clientX) + Math.abs(event.clientY - before.clientY);
    if (onDrag && transform.scale === 1) onDrag(u);
    else
      transform.pan(
        (event.clientX - before.clientX) / pane.clientWidth,
        (event.clientY - before.clientY) / pane.clientHeight,
      );
  });
  const release = (event) => {
    const pressed = pointers.delete(event.pointerId);
    if (event.type === "pointerup" && pressed && travelled < kDragPixels)
      onClick(...transform.toPicture(...fractions(event, pane)));
  };
  pane.addEventListener("pointerup", release);
  pane.addEventListener("pointercancel", release);
  pane.addEventListener("pointerleave", onLeave);
}
