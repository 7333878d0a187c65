// Numbers of the pixel under the pointer: each layer of the panes, and the truth of a view.
import { h } from "../../../page/web/src/dom.js";
import { keyed } from "./parts.js";

const kColorDecimals = 3;
const kVectorDecimals = 2;
const kPlainDecimals = 3;

const short = (text) => text.replace(/^(-?)0\./, "$1.");

// A number, three of a colour or vector, or nothing.
export function valueText(value, layer) {
  if (value === null || value === undefined) return "–";
  if (layer.style === "depth" && value === 0) return "–"; // nothing there
  if (!Array.isArray(value)) return value.toFixed(layer.decimals ?? kPlainDecimals);
  const decimals = layer.style === "normal" ? kVectorDecimals : kColorDecimals;
  return value.map((part) => short(part.toFixed(decimals))).join(" ");
}

// Layers with a value in any column, in the order of the runs' lists.
function layersOf(app, columns) {
  const layers = new Map();
  for (const run of app.shownRuns())
    for (const layer of run.layers) if (!layers.has(layer.id)) layers.set(layer.id, layer);
  const has = (id) => columns.some(({ values }) => values?.[id] !== undefined);
  return [...layers.values()].filter(({ id }) => has(id));
}

function columnsOf(app, { panes, truth }) {
  const columns = panes.map(({ run, values }) => ({ title: app.runTitle(run), values }));
  const unique = columns.filter(
    ({ title }, i) => columns.findIndex((c) => c.title === title) === i,
  );
  return truth ? [...unique, { title: "Truth", values: truth }] : unique;
}

const titleOf = ({ title, unit }) => (unit ? `${title}, ${unit}` : title);

function table(app, probe) {
  const columns = columnsOf(app, probe);
  const row = (layer) =>
    h(
      "tr",
      { "data-layer": layer.id },
      h("th", { scope: "row" }, titleOf(layer)),
      columns.map(({ values }) => h("td", {}, valueText(values?.[layer.id], layer))),
    );
  const head = ["", ...columns.map(({ title }) => title)];
  return h(
    "table",
    { class: "values" },
    h(
      "thead",
      {},
      h(
        "tr",
        {},
        head.map((title) => h("th", { scope: "col" }, title)),
      ),
    ),
    h("tbody", {}, layersOf(app, columns).map(row)),
  );
}

export function probePanel(app) {
  const body = h("div", {});
  const update = () => {
    const { probe } = app;
    keyed(body, [probe, app.state.left.run, app.state.right], () => [
      h("h2", {}, probe ? `Pixel ${probe.x}, ${probe.y}` : "Pixel"),
      probe
        ? table(app, probe)
        : h("p", { class: "note" }, "Point at the picture at rest to read its values."),
    ]);
  };
  return {
    element: h("section", { class: "probe-box", "aria-label": "Pixel values" }, body),
    update,
  };
}
