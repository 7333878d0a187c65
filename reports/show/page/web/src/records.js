// Every record: filtered, sorted, rendered as one scrolls.
import { keepAddress } from "./address.js";
import { methodTitle, metricInfo, metricText, metricTitle, report } from "./data.js";
import { h, replace } from "./dom.js";
import { setViewKeys } from "./keys.js";
import { copyButtons, DataTable } from "./table.js";

const kFields = ["Dataset", "Scene", "Method", "Seed", "State", "Resolution", "Surfels", "Date"];
const kShown = [
  "psnr",
  "ssim-3dgs",
  "normal-mae",
  "depth-absrel",
  "mesh-f1@5cm",
  "fps",
  "train-minutes",
];
const kNumbers = ["Seed", "Surfels"];
const start = () => ({ all: false, filter: "", sorted: null });
let state = start();

function fieldColumns() {
  const columns = kFields.map((title, i) => ({
    key: title,
    title,
    className: kNumbers.includes(title) ? "number" : "text",
    value: (row) => row[i],
  }));
  columns[2].value = (row) => methodTitle(row[2]);
  columns[2].cell = (row) => h("td", { class: "text", title: row[2] }, methodTitle(row[2]));
  columns[2].text = columns[2].value;
  columns[4].text = (row) => (row[4] ? "ok" : "failed");
  columns[4].value = (row) => (row[4] ? "ok" : "failed");
  columns[4].cell = (row) =>
    h("td", { class: row[4] ? "text" : "text failed" }, row[4] ? "ok" : "✕ failed");
  columns[7].cell = (row) => row[7]?.replace("T", " ").replace(/:\d+Z$/, " UTC");
  return columns;
}

function metricColumns() {
  const { metrics } = report.records;
  const ids = state.all ? metrics : kShown.filter((id) => metrics.includes(id));
  return ids
    .map((id) => ({ id, at: kFields.length + metrics.indexOf(id) }))
    .map(({ id, at }) => ({
      key: id,
      title: metricTitle(id),
      className: "number",
      firstSign: metricInfo(id).direction === "higher" ? -1 : 1,
      value: (row) => row[at],
      cell: (row) => metricText(id, row[at]),
    }));
}

const isSorted = ({ sorted }) => sorted && `${sorted.sign < 0 ? "down" : "up"}:${sorted.key}`;

function keep() {
  const { all, filter } = state;
  keepAddress("records", { all, filter: filter || null, sort: isSorted(state) });
}

function readState(params) {
  state = start();
  state.all = params.flag("all", false);
  state.filter = params.get("filter", "");
  const [direction, ...key] = (params.get("sort") ?? "").split(":");
  if (key.length > 0) state.sorted = { key: key.join(":"), sign: direction === "down" ? -1 : 1 };
}

function matching(rows) {
  const words = state.filter.toLowerCase().split(/\s+/);
  const text = (row) =>
    [...row.slice(0, 4), methodTitle(row[2]), row[4] ? "ok" : "failed"].join(" ").toLowerCase();
  return rows.filter((row) => words.every((word) => text(row).includes(word)));
}

export function showRecords(container, from) {
  if (from?.params) readState(from.params);
  const { rows } = report.records;
  const table = new DataTable({
    columns: [...fieldColumns(), ...metricColumns()],
    rows,
    label: "Records",
    emptyText: "No record matches.",
    sorted: state.sorted,
    onSort: (sorted) => ((state.sorted = sorted), keep()),
  });
  const count = h("output", {});
  const apply = () => {
    const found = matching(rows);
    count.textContent =
      found.length === rows.length
        ? `${rows.length} records`
        : `${found.length} of ${rows.length} records`;
    table.show(found);
    keep();
  };
  const filter = h("input", {
    type: "search",
    id: "record-filter",
    placeholder: "scene, method, failed, …",
    oninput: () => ((state.filter = filter.value), apply()),
  });
  filter.value = state.filter;
  const toggle = () => {
    state.all = !state.all;
    showRecords(container);
  };
  setViewKeys([
    { keys: ["/"], help: "filter", run: () => filter.focus() },
    { keys: ["a"], help: "all metrics or the main ones", run: toggle },
  ]);
  replace(
    container,
    h(
      "div",
      { class: "bar" },
      h("label", { class: "field" }, h("span", {}, "Filter"), filter),
      count,
      h(
        "button",
        { type: "button", onclick: toggle },
        state.all ? "Main metrics" : `All ${report.records.metrics.length} metrics`,
      ),
      copyButtons(() => ({ title: `Records of ${report.profile}`, ...table.model() })),
    ),
    h("section", { class: "card" }, table.element),
  );
  apply();
}
