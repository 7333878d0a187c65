// Which layer of which run is shown, its numbers, what its colours mean, what it is compared with.
import { h, segmented, select } from "../../../page/web/src/dom.js";
import { colorbar, normalBall } from "../../../page/web/src/legend.js";
import { layerList } from "./layer_list.js";
import { kResolutions } from "./look.js";
import { keyed, section } from "./parts.js";

function legendOf(layer) {
  if (layer.style === "normal")
    return [normalBall(), h("span", { class: "note" }, "red right, green up, blue to the viewer")];
  return layer.colors ? colorbar(layer) : null;
}

const runChoices = (app) => app.hello.runs.map((_, i) => [i, app.runTitle(i)]);

function rightChoice(app) {
  const { right } = app.state;
  const now = right?.photo ? "photo" : (right?.run ?? "");
  const choices = [["", "nothing"], ["photo", "the photo"], ...runChoices(app)];
  const choose = (value) =>
    app.setRight(value === "" ? null : value === "photo" ? value : Number(value));
  return select("Slider to", choices, now, choose, "right");
}

function sideChoice(app) {
  if (!app.state.right || app.state.right.photo) return null;
  const sides = [
    ["left", `Left: ${app.runTitle(app.state.left.run)}`],
    ["right", `Right: ${app.runTitle(app.state.right.run)}`],
  ];
  return segmented("Side", sides, app.side, (side) => side !== app.side && app.toggleSide());
}

function runChoice(app) {
  if (app.hello.runs.length < 2) return null;
  const choose = (run) => app.setRun("left", Number(run));
  return select("Run", runChoices(app), app.state.left.run, choose, "left");
}

export function layersPanel(app) {
  const top = h("div", { class: "rows" });
  const list = layerList(app);
  const legend = h("div", { class: "legend" });
  const resolution = h("div", { class: "line" });
  const update = () => {
    const { left, right, view, resolution: size } = app.state;
    const names = app.hello.runs.map(({ name }) => name);
    keyed(top, [left.run, right, app.side, names], () => [
      runChoice(app),
      rightChoice(app),
      sideChoice(app),
    ]);
    const shown = app.layerOf(app.side);
    list.update();
    keyed(legend, [app.pane().run, shown, names], () => legendOf(shown));
    keyed(resolution, [size, Boolean(view)], () => [
      h("span", { class: "quiet" }, "Resolution"),
      segmented("Resolution", kResolutions, size, (id) => app.set({ resolution: id })),
    ]);
  };
  return { element: section("Layers", [top, list.element, legend, resolution]), update };
}
