// Pictures of one view side by side, one over the other, or in turn, with one zoom for all.
import { metricText, pictureUrl } from "./data.js";
import { h, replace } from "./dom.js";
import { scoreOf } from "./frames.js";
import { outlineElement } from "./outline.js";
import { ownerKey, ownerTitle, shownLayer, whyMissing } from "./owner.js";
import { watchPointer } from "./transform.js";

const kFlickerMs = 800;

export class Viewer {
  constructor(state, onPixel) {
    this.state = state;
    this.onPixel = onPixel;
    this.element = h("div", { class: "viewer" });
    this.contents = [];
    state.transform.listeners.clear();
    state.transform.listeners.add(() => this.place());
  }

  stop() {
    clearInterval(this.timer);
  }

  show() {
    this.stop();
    this.contents = [];
    const { mode } = this.state;
    this.element.dataset.mode = mode;
    const [width, height] = this.#size();
    this.element.style.setProperty("--aspect", String(width / height));
    if (mode === "grid") this.#showGrid();
    else if (mode === "slider") this.#showSlider();
    else this.#showFlicker();
    this.place();
  }

  place() {
    for (const content of this.contents) content.style.transform = this.state.transform.css();
    this.#placeMark();
  }

  #size() {
    const [width, height] = this.state.scene.views[this.state.view].size;
    return [width || 16, height || 9];
  }

  #picture(owner) {
    const { scene, view, index, layer } = this.state;
    const shown = shownLayer(this.state, owner);
    if (!shown)
      return h(
        "div",
        { class: "missing" },
        h("strong", {}, "missing"),
        h("span", {}, whyMissing(scene, owner, layer)),
      );
    return h("img", {
      src: pictureUrl(index, view, ownerKey(owner), shown.id),
      alt: `${shown.title}, ${ownerTitle(scene, owner)}, view ${scene.views[view].name}`,
      draggable: false,
    });
  }

  // A missing picture stays as it is when the others are enlarged.
  #content(owner) {
    const { outline, values } = this.state;
    const picture = this.#picture(owner);
    if (picture.classList.contains("missing")) return picture;
    const content = h("div", { class: "content" }, picture);
    if (outline && this.state.outlinePath())
      content.append(outlineElement(this.state.outlinePath(), values.width, values.height));
    content.append(h("span", { class: "mark", hidden: true }));
    this.contents.push(content);
    return content;
  }

  #label(owner, side) {
    const { scene, view, metric, layer } = this.state;
    const score = owner < 0 ? null : scoreOf(scene, owner, view, metric);
    const shown = shownLayer(this.state, owner);
    return h(
      "span",
      { class: `label ${side ?? ""}` },
      ownerTitle(scene, owner),
      shown && shown !== layer && h("span", { class: "score" }, "image"),
      score !== null && h("span", { class: "score" }, `${metric} ${metricText(metric, score)}`),
    );
  }

  #pane(children, onDrag) {
    const [width, height] = this.#size();
    const pane = h(
      "div",
      { class: "pane", style: { aspectRatio: `${width} / ${height}` } },
      children,
    );
    const pixel = (u, v) => [
      Math.min(width - 1, Math.max(0, Math.floor(u * width))),
      Math.min(height - 1, Math.max(0, Math.floor(v * height))),
    ];
    watchPointer(pane, this.state.transform, {
      onHover: (u, v) => this.onPixel(pixel(u, v), "hover"),
      onClick: (u, v) => this.onPixel(pixel(u, v), "click"),
      onLeave: () => this.onPixel(null, "leave"),
      onDrag,
    });
    return pane;
  }

  #showGrid() {
    const owners = [-1, ...this.state.shownRuns()];
    const panes = owners.map((owner) =>
      h("figure", {}, this.#pane([this.#content(owner)]), h("figcaption", {}, this.#label(owner))),
    );
    replace(this.element, h("div", { class: "grid" }, panes));
  }

  #showSlider() {
    const { left, right } = this.state;
    const handle = h("input", {
      type: "range",
      class: "handle",
      min: "0",
      max: "100",
      step: "0.5",
      value: String(this.state.split),
      "aria-label": "Divider",
      oninput: () => this.#split(Number(handle.value)),
    });
    this.upper = h("div", { class: "clip" }, this.#content(right));
    this.line = h("div", { class: "divider", "aria-hidden": "true" });
    this.handle = handle;
    const pane = this.#pane(
      [
        h("div", { class: "clip" }, this.#content(left)),
        this.upper,
        this.line,
        this.#label(left, "left"),
        this.#label(right, "right"),
      ],
      (u) => this.#split(100 * u),
    );
    replace(this.element, pane, handle);
    this.#split(this.state.split);
  }

  #split(percent) {
    this.state.split = Math.min(100, Math.max(0, percent));
    this.upper.style.clipPath = `inset(0 0 0 ${this.state.split}%)`;
    this.line.style.left = `${this.state.split}%`;
    this.handle.value = String(this.state.split);
    this.state.onKeep();
  }

  moveDivider(step) {
    if (this.state.mode === "slider") this.#split(this.state.split + step);
  }

  #showFlicker() {
    const { left, right, flickerRuns } = this.state;
    const sides = [left, right].map((owner) =>
      h("div", { class: "clip" }, this.#content(owner), this.#label(owner, "left")),
    );
    this.sides = sides;
    this.front = 0;
    replace(this.element, this.#pane(sides));
    this.flip(0);
    if (flickerRuns) this.timer = setInterval(() => this.flip(), kFlickerMs);
  }

  flip(side = 1 - this.front) {
    if (this.state.mode !== "flicker") return;
    this.front = side;
    this.sides.forEach((element, i) => (element.hidden = i !== side));
  }

  #placeMark() {
    const [width, height] = this.#size();
    const { pixel } = this.state;
    for (const content of this.contents) {
      const mark = content.querySelector(".mark");
      mark.hidden = !pixel;
      if (!pixel) continue;
      Object.assign(mark.style, {
        left: `${(100 * pixel[0]) / width}%`,
        top: `${(100 * pixel[1]) / height}%`,
        width: `${100 / width}%`,
        height: `${100 / height}%`,
      });
      mark.style.setProperty("--thin", `${1 / this.state.transform.scale}px`);
    }
  }
}
