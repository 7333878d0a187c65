// Every record: filtered, sorted, rendered as one scrolls.
import { metricInfo, metricText, metricTitle, report } from "./data.js";
import { h, replace } from "./dom.js";
import { setViewKeys } from "./keys.js";
import { DataTable } from "./table.js";

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
let allMetrics = false;

function fieldColumns() {
  const columns = kFields.map((title, i) => ({
    title,
    className: kNumbers.includes(title) ? "number" : "text",
    value: (row) => row[i],
  }));
  columns[4].value = (row) => (row[4] ? "ok" : "failed");
  columns[4].cell = (row) =>
    h("td", { class: row[4] ? "text" : "text failed" }, row[4] ? "ok" : "✕ failed");
  columns[7].cell = (row) => row[7]?.replace("T", " ").replace(/:\d+Z$/, " UTC");
  return columns;
}

function metricColumns() {
  const { metrics } = report.records;
  const ids = allMetrics ? metrics : kShown.filter((id) => metrics.includes(id));
  return ids
    .map((id) => ({ id, at: kFields.length + metrics.indexOf(id) }))
    .map(({ id, at }) => ({
      title: metricTitle(id),
      className: "number",
      firstSign: metricInfo(id).direction === "higher" ? -1 : 1,
      value: (row) => row[at],
      cell: (row) => metricText(id, row[at]),
    }));
}

export function showRecords(container) {
  const { rows } = report.records;
  const table = new DataTable({
    columns: [...fieldColumns(), ...metricColumns()],
    rows,
    label: "Records",
    emptyText: "No record matches.",
  });
  const count = h("output", {}, `${rows.length} records`);
  const filter = h("input", {
    type: "search",
    id: "record-filter",
    placeholder: "scene, method, failed, …",
    oninput: () => {
      const words = filter.value.toLowerCase().split(/\s+/);
      const text = (row) => [...row.slice(0, 4), row[4] ? "ok" : "failed"].join(" ").toLowerCase();
      const found = rows.filter((row) => words.every((word) => text(row).includes(word)));
      count.textContent = `${found.length} of ${rows.length} records`;
      table.show(found);
    },
  });
  const toggle = () => {
    allMetrics = !allMetrics;
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
        allMetrics ? "Main metrics" : `All ${report.records.metrics.length} metrics`,
      ),
    ),
    h("section", { class: "card" }, table.element),
  );
}
