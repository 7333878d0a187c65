// Numbers of the pixel under the pointer: each layer of the panes, and the truth of a view.
import { h } from "../../../page/web/src/dom.js";
import { keyed, kNarrow } from "./parts.js";

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

// Of the runs that are shown, in the order of their lists.
function layersOf(runs) {
  const layers = new Map();
  for (const run of runs)
    for (const layer of run.layers) if (!layers.has(layer.id)) layers.set(layer.id, layer);
  return [...layers.values()];
}

// A run each, then the truth of a view; without values while nothing is pointed at, so that the
// table keeps its size.
function columnsOf(app) {
  const { probe, hello, state } = app;
  const columns = app.shownRuns().map((run) => {
    const index = hello.runs.indexOf(run);
    const values = probe?.panes.find((pane) => pane.run === index)?.values;
    return { title: app.runTitle(index), values };
  });
  return state.view ? [...columns, { title: "Truth", values: probe?.truth }] : columns;
}

const titleOf = ({ title, unit }) => (unit ? `${title}, ${unit}` : title);

function table(app) {
  const columns = columnsOf(app);
  const text = (values, layer) => (app.probe ? valueText(values?.[layer.id], layer) : "");
  const row = (layer) =>
    h(
      "tr",
      { "data-layer": layer.id },
      h("th", { scope: "row" }, titleOf(layer)),
      columns.map(({ values }) => h("td", {}, text(values, layer))),
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
    h("tbody", {}, layersOf(app.shownRuns()).map(row)),
  );
}

export function probePanel(app) {
  const summary = h("summary", {});
  const body = h("div", {});
  const open = !window.matchMedia(kNarrow).matches;
  const update = () => {
    const { probe, state } = app;
    summary.textContent = probe ? `Pixel ${probe.x}, ${probe.y}` : "Pixel under the pointer";
    const layers = app.shownRuns().map((run) => [run.name, run.layers.length]);
    keyed(body, [probe, layers, Boolean(state.view)], () => table(app));
  };
  return { element: h("details", { class: "probe-box", open }, summary, body), update };
}
