// The layers of the side that is chosen, and their numbers at the pixel under the pointer.
import { h } from "../../../page/web/src/dom.js";
import { keyed } from "./parts.js";
import { valueText } from "./values.js";

const kKeyed = 9; // layers that have a number key
const kRoom = 3; // columns, from where numbers are shorter

// [{title, values(probe)}]: a run each, then the truth of a view.
function columnsOf(app) {
  const columns = app.shownRuns().map((run) => {
    const index = app.hello.runs.indexOf(run);
    const values = (probe) => probe.panes.find((pane) => pane.run === index)?.values;
    return { title: app.runTitle(index), values };
  });
  return app.state.view ? [...columns, { title: "Truth", values: ({ truth }) => truth }] : columns;
}

function layerButton(app, layer, number, columns) {
  const isFree = !layer.needs_view || app.state.view;
  const key = number < kKeyed ? String(number + 1) : "";
  const cells = columns.map(() => h("span", { class: "value" }));
  const button = h(
    "button",
    {
      ...{ type: "button", class: "layer", "data-value": layer.id, disabled: !isFree },
      ...{ title: isFree ? null : "compares with the truth: go to a view" },
      ...{ "aria-label": layer.title, "aria-pressed": String(layer.id === app.layerOf().id) },
      onclick: () => app.setLayer(number),
    },
    h("span", { class: "layer-key" }, key),
    h("span", { class: "layer-title" }, layer.title),
    cells,
  );
  button.show = (probe) =>
    cells.forEach((cell, i) => {
      const value = probe && columns[i].values(probe)?.[layer.id];
      cell.textContent = probe ? valueText(value, layer, columns.length >= kRoom) : "";
    });
  return button;
}

function headOf(columns) {
  const title = h("span", { class: "layer-title" });
  const head = h("div", { class: "layer-head" }, title, [
    columns.map((column) => h("span", { class: "value" }, column.title)),
  ]);
  head.show = (probe) => {
    title.textContent = probe ? `Pixel ${probe.x}, ${probe.y}` : "Values under the pointer";
  };
  return head;
}

export function layerList(app) {
  const element = h("div", { class: "layers", role: "group", "aria-label": "Layers" });
  const update = () => {
    const columns = columnsOf(app);
    const ids = app.layersOf().map(({ id }) => id);
    const titles = columns.map(({ title }) => title);
    element.style.setProperty("--columns", String(columns.length));
    keyed(element, [app.side, app.pane().run, app.layerOf().id, titles, ids], () => [
      headOf(columns),
      app.layersOf().map((layer, i) => layerButton(app, layer, i, columns)),
    ]);
    for (const row of element.children) row.show(app.probe);
  };
  return { element, update };
}
