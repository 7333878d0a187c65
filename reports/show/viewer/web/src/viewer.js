// The page with the picture: stage, panel, and what ties them to the app.
import { h, replace } from "../../../page/web/src/dom.js";
import { copyButton } from "../../../page/web/src/copy.js";
import { setViewKeys, showHelp } from "../../../page/web/src/keys.js";
import { Controls } from "./controls.js";
import { viewerKeys } from "./key_list.js";
import { viewOf } from "./look.js";
import { Overlay } from "./overlay.js";
import { cameraPanel, photoUrl, viewTitle } from "./panel_camera.js";
import { layersPanel } from "./panel_layers.js";
import { pathPanel } from "./panel_path.js";
import { kStyleTitles, surfelsPanel } from "./panel_surfels.js";
import { trainingPanel } from "./panel_training.js";
import { button, kNarrow } from "./parts.js";
import { Picture } from "./picture.js";
import { statusText } from "./status.js";
import { clamp } from "./vectors.js";

export class Viewer {
  // rate(): frames a second; toRuns: back to the start page, or null
  constructor(container, app, { rate, toRuns, toggleTheme }) {
    Object.assign(this, { container, app, rate, toRuns, toggleTheme });
    this.picture = new Picture({
      onSplit: (percent) => app.set({ split: clamp(percent, 0, 100) }),
      onResize: () => app.changed(),
    });
    this.overlay = new Overlay(this.picture.overlay, app.hello);
    this.panels = [trainingPanel, layersPanel, cameraPanel, surfelsPanel, pathPanel].map((make) =>
      make(app),
    );
    this.path = this.panels.at(-1).path;
    this.controls = new Controls(this.picture.element, this.#actions());
    this.#build();
    setViewKeys(viewerKeys(this));
    app.listeners.add(() => this.update());
    app.changed();
  }

  stop() {
    this.controls.stop();
    this.path.player.stop();
    this.app.stop();
    setViewKeys([]);
  }

  #actions() {
    const { app } = this;
    return {
      rig: () => app.state.rig,
      move: (rig) => {
        this.path.player.playing = false;
        app.moveRig(rig);
      },
      speed: (speed) => app.change({ speed }),
      point: (at) => {
        this.#hover(at);
        app.point(at);
      },
      click: (...at) => {
        const found = this.#frustumAt(at);
        if (found >= 0) app.snap(app.hello.views[found]);
      },
      pick: (...at) => this.#frustumAt(at) < 0 && app.pick(at),
    };
  }

  #frustumAt(at) {
    const camera = this.app.shown?.camera;
    return camera && this.app.state.frusta ? this.overlay.at(camera, at) : -1;
  }

  #hover(at) {
    const found = at ? this.#frustumAt(at) : -1;
    const { tip, element } = this.picture;
    this.overlay.hovered = found;
    element.classList.toggle("on-camera", found >= 0);
    tip.hidden = found < 0 || this.controls.pointers.size > 0;
    if (found < 0) return;
    tip.textContent = viewTitle(this.app.hello.views[found]);
    Object.assign(tip.style, { left: `${100 * at[0]}%`, top: `${100 * at[1]}%` });
  }

  #header() {
    const { hello } = this.app;
    return h(
      "header",
      { class: "panel-head" },
      h("strong", {}, hello.title),
      h("span", { class: "quiet" }, `${hello.device}, ${hello.threads} threads`),
      h(
        "div",
        { class: "line" },
        this.toRuns && button("Runs", this.toRuns, { class: "small", id: "runs" }),
        copyButton(() => this.link(), "Link", {
          ...{ class: "small", id: "link" },
          title: "copies a link to what is shown, without the token",
        }),
        button("◐ Theme", this.toggleTheme, { class: "small", id: "theme" }),
        button("? Keys", () => showHelp(), { class: "small", id: "help", title: "keys (?)" }),
        button("Hide", () => this.togglePanel(), { class: "small", id: "hide", title: "hide (h)" }),
      ),
    );
  }

  link() {
    return location.origin + location.pathname + this.app.address();
  }

  #build() {
    this.status = h("p", { class: "status" });
    this.unfold = button("Panel", () => this.togglePanel(), {
      ...{ class: "small", id: "unfold", title: "show the panel (h)" },
    });
    this.stageArea = h("div", { class: "stage-area" }, this.picture.element);
    const bar = h("div", { class: "status-bar" }, this.status, this.unfold);
    const panel = h(
      "aside",
      { class: "panel", id: "panel", "aria-label": "Panel" },
      h(
        "div",
        { class: "panel-scroll" },
        this.#header(),
        this.panels.map(({ element }) => element),
      ),
    );
    this.layout = h(
      "div",
      { class: "layout" },
      h("main", { class: "stage" }, this.stageArea, bar),
      panel,
    );
    // A list that was chosen from by the mouse gives the keys back to the picture.
    panel.addEventListener("change", ({ target }) => {
      if (target.tagName === "SELECT" && !target.matches(":focus-visible")) target.blur();
    });
    this.#showPanel(!window.matchMedia(kNarrow).matches);
    replace(this.container, this.layout);
  }

  // The focus goes where the panel comes back from.
  togglePanel() {
    const open = this.layout.dataset.panel !== "open";
    const held = this.layout.querySelector(".panel").contains(document.activeElement);
    this.#showPanel(open);
    if (!open && held) this.unfold.focus();
  }

  #showPanel(open) {
    this.layout.dataset.panel = open ? "open" : "folded";
    this.unfold.hidden = open;
  }

  show(header, bitmaps) {
    this.picture.show(bitmaps, header);
    this.app.frameShown(header);
  }

  update() {
    const { state, shown } = this.app;
    if (shown?.camera !== this.camera) this.#hover(this.app.pointer);
    this.camera = shown?.camera;
    this.picture.setSplit(state.split);
    this.#updatePhoto();
    this.picture.setLabels(this.#labels());
    this.overlay.draw(shown?.camera, {
      frusta: state.frusta,
      keys: this.app.keys,
      pivot: state.rig.mode === "orbit" ? state.rig.pivot : null,
    });
    this.status.textContent = statusText(this.app, this.rate());
    for (const panel of this.panels) panel.update();
  }

  // The photo of the view as the right side; where none is snapped to there is nothing.
  #updatePhoto() {
    const { right, view } = this.app.state;
    const seen = right?.photo && view && viewOf(this.app.hello, view);
    const url = seen?.photo ? photoUrl(seen) : null;
    if (url === this.photoUrl) return;
    this.photoUrl = url;
    this.picture.setPhoto(null);
    if (!url) return;
    const image = new Image();
    image.onload = () => url === this.photoUrl && this.picture.setPhoto(image);
    image.src = url;
  }

  #labels() {
    const { left, right, style } = this.app.state;
    const drawn = style === "image" ? "" : ` · ${kStyleTitles[style]}`;
    const title = (side) =>
      `${this.app.runTitle(this.app.state[side].run)} · ${this.app.layerOf(side).title}${drawn}`;
    if (right?.photo) return [title("left"), this.photoUrl && "Photo"];
    return [left && title("left"), right && title("right")];
  }
}
