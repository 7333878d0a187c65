// The picture: one pane, or two with a divider between them, fitted into its part of the window.
import { h } from "../../../page/web/src/dom.js";

const kKeyStep = 2; // percent, of the divider by an arrow key
const kBlocks = 2; // so much enlarged, the pixels of a whole frame are shown as they are

function fitCanvas(canvas, box) {
  const scale = window.devicePixelRatio || 1;
  const [width, height] = [box.width, box.height].map((n) => Math.max(1, Math.round(n * scale)));
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
}

export class Picture {
  // onSplit(percent), onResize()
  constructor({ onSplit, onResize }) {
    this.onSplit = onSplit;
    this.panes = []; // ImageBitmap; a photo is an image
    this.split = null; // percent
    this.canvas = h("canvas", { class: "frame-canvas" });
    this.overlay = h("canvas", { class: "overlay", "aria-hidden": "true" });
    this.labels = ["left", "right"].map((side) =>
      h("span", { class: `label ${side}`, hidden: true }),
    );
    this.tip = h("span", { class: "label tip", hidden: true });
    this.divider = this.#divider();
    this.element = h(
      "div",
      { class: "picture", tabindex: "0", role: "img", "aria-label": "Rendered picture" },
      [this.canvas, this.overlay, this.divider, ...this.labels, this.tip],
    );
    new ResizeObserver(() => {
      this.draw();
      onResize();
    }).observe(this.element);
  }

  #divider() {
    const divider = h(
      "div",
      {
        ...{ class: "grip", role: "slider", tabindex: "0", hidden: true },
        ...{ "aria-label": "Divider", "aria-valuemin": "0", "aria-valuemax": "100" },
        onkeydown: (event) => this.#dividerKey(event),
      },
      h("div", { class: "divider" }),
    );
    divider.addEventListener("pointerdown", (event) => {
      event.stopPropagation();
      divider.setPointerCapture(event.pointerId);
    });
    divider.addEventListener("pointermove", (event) => {
      if (!divider.hasPointerCapture(event.pointerId)) return;
      event.stopPropagation();
      const box = this.element.getBoundingClientRect();
      this.onSplit((100 * (event.clientX - box.left)) / box.width);
    });
    for (const name of ["pointerup", "dblclick"])
      divider.addEventListener(name, (event) => event.stopPropagation());
    return divider;
  }

  #dividerKey(event) {
    const step = { ArrowLeft: -kKeyStep, ArrowRight: kKeyStep }[event.key];
    if (!step) return;
    event.preventDefault();
    event.stopPropagation();
    this.onSplit(this.split + step);
  }

  // The bitmaps are the picture's now; an image in `photo` stands for the right pane.
  show(bitmaps, header) {
    const olds = this.panes;
    this.panes = bitmaps;
    this.whole = header.whole;
    this.element.style.setProperty("--aspect", String(header.size[0] / header.size[1]));
    this.draw();
    for (const old of olds) if (!bitmaps.includes(old)) old.close();
  }

  setPhoto(image) {
    if (this.photo === image) return;
    this.photo = image;
    this.draw();
  }

  setSplit(percent) {
    if (this.split === percent) return;
    this.split = percent;
    this.divider.style.left = `${percent}%`;
    this.divider.setAttribute("aria-valuenow", String(Math.round(percent)));
    this.draw();
  }

  setLabels(texts) {
    this.labels.forEach((label, i) => {
      label.hidden = !texts[i];
      label.textContent = texts[i] ?? "";
    });
  }

  draw() {
    const { canvas } = this;
    fitCanvas(canvas, this.element.getBoundingClientRect());
    fitCanvas(this.overlay, this.element.getBoundingClientRect());
    const [left, second] = this.panes;
    const right = this.photo ?? second;
    this.divider.hidden = !right;
    if (!left) return;
    const context = canvas.getContext("2d");
    const edge = right ? Math.round((canvas.width * this.split) / 100) : canvas.width;
    this.#part(context, left, 0, edge);
    if (right) this.#part(context, right, edge, canvas.width);
  }

  // Columns `from` to `to` of the canvas.
  #part(context, image, from, to) {
    if (to <= from) return;
    const { width, height } = this.canvas;
    context.save();
    context.beginPath();
    context.rect(from, 0, to - from, height);
    context.clip();
    context.imageSmoothingEnabled = !this.whole || width < kBlocks * image.width;
    context.imageSmoothingQuality = "high";
    context.drawImage(image, 0, 0, width, height);
    context.restore();
  }
}
