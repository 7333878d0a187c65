// The tables of the paper, measured and published, and what they were measured on.
import { report } from "./data.js";
import { checkbox, h, replace } from "./dom.js";
import { setViewKeys } from "./keys.js";
import { DataTable } from "./table.js";

let withPublished = true;

const kArrows = { higher: " ↑", lower: " ↓", none: "" };
const kRankWords = ["", "best", "second", "third"];

// What stands in place of a value; of a metric that needs what is not there ("no weights"), why.
const wordOf = ({ status, note }) =>
  ({ missing: "missing", failed: "failed", unavailable: note, "not applicable": "n/a" })[status];

function cellNode(cell, column) {
  const word = wordOf(cell);
  const ranked = cell.rank ? kRankWords[cell.rank] : "";
  const classes = [
    "number",
    column.published && "published",
    cell.rank && `rank-${cell.rank}`,
    word && "word",
    cell.status === "failed" && "failed",
  ];
  const scenes = cell.n_scenes ? `${cell.n_scenes} scenes, ${cell.n_seeds} seed(s)` : "";
  const hint = [ranked, cell.note, scenes].filter(Boolean).join(" · ");
  const shown = word ?? `${cell.text}${column.published ? "†" : ""}`;
  return h(
    "td",
    { class: classes.filter(Boolean).join(" "), title: hint },
    cell.status === "failed" && h("span", { "aria-hidden": "true" }, "✕ "),
    shown,
    cell.status === "failed" && cell.note && h("span", { class: "why" }, cell.note),
    ranked && h("span", { class: "unseen" }, ` (${ranked})`),
  );
}

function tableColumns(table) {
  const columns = table.columns.filter((column) => withPublished || !column.published);
  return [
    { title: "Method", group: "", value: (row) => row.title, className: "method" },
    ...columns.map((column) => ({
      title: `${column.title}${column.unit ? ` (${column.unit})` : ""}${kArrows[column.direction]}`,
      group: column.published ? `${column.group}, published †` : `${column.group}, measured`,
      className: column.published ? "published" : "",
      firstSign: column.direction === "higher" ? -1 : 1,
      value: (row) => row.cells[column.id].value ?? row.cells[column.id].text ?? null,
      cell: (row) => cellNode(row.cells[column.id], column),
    })),
  ];
}

const isMeasured = (table) =>
  table.rows.some((row) =>
    table.columns.some(({ id, published }) => {
      const { status } = row.cells[id];
      return !published && !["missing", "unavailable", "not applicable"].includes(status);
    }),
  );

const titleOf = (table, id) => table.columns.find((column) => column.id === id)?.title ?? id;

function agreementOf(table) {
  if (table.order_agreement.length === 0) return null;
  const chips = table.order_agreement.map(({ column, kendall_tau: tau, n_methods: count }) =>
    h(
      "span",
      { class: "chip" },
      `${titleOf(table, column)}: τ = ${tau.toFixed(2)} (${count} methods)`,
    ),
  );
  const hint =
    "Kendall's τ of the method order, measured against published: 1 is the same order, −1 the reverse.";
  return h(
    "p",
    { class: "agreement" },
    h("span", { title: hint }, "Rank agreement with the paper "),
    chips,
  );
}

// Without the agreement of orders, which has chips of its own.
const shownNotes = (table) => table.notes.filter((note) => !note.startsWith("Kendall's tau"));

function tableSection(table) {
  const measured = isMeasured(table);
  return h(
    "section",
    { class: "card", id: `table-${table.id}` },
    h("h2", {}, table.title),
    h("p", { class: "caption" }, table.caption),
    measured ? null : h("p", { class: "note" }, "Nothing measured yet for this table."),
    new DataTable({ columns: tableColumns(table), rows: table.rows, label: table.title }).element,
    agreementOf(table),
    h(
      "ul",
      { class: "notes" },
      shownNotes(table).map((note) => h("li", {}, note)),
    ),
  );
}

function tile(value, label) {
  return h("div", { class: "tile" }, h("strong", {}, String(value)), h("span", {}, label));
}

function tiles() {
  const { rows } = report.records;
  const methods = new Set(rows.map((row) => row[2]));
  const seeds = new Set(rows.map((row) => row[3]));
  return h(
    "div",
    { class: "tiles" },
    tile(rows.filter((row) => row[4]).length, "finished runs"),
    tile(report.failures.length, "failed runs"),
    tile(methods.size, methods.size === 1 ? "method" : "methods"),
    tile(report.scenes.length, report.scenes.length === 1 ? "scene" : "scenes"),
    tile(seeds.size, seeds.size === 1 ? "seed" : "seeds"),
  );
}

function environmentCard() {
  const lines = report.environments.map((machine) => {
    const memory = machine.memory_bytes
      ? `${(machine.memory_bytes / 2 ** 30).toFixed(0)} GiB`
      : null;
    const parts = [
      machine.device,
      machine.driver,
      machine.cpu,
      machine.cores && `${machine.cores} cores`,
      machine.threads && `${machine.threads} threads`,
      memory,
      machine.compiler,
      machine.git_revision && `revision ${machine.git_revision}`,
    ];
    return h("li", {}, `${machine.records} records: `, parts.filter(Boolean).join(" · "));
  });
  return h(
    "section",
    { class: "card" },
    h("h2", {}, "Measured on"),
    h("ul", { class: "notes" }, lines),
    report.dates && h("p", { class: "note" }, report.dates),
  );
}

const shadeKey = () =>
  h(
    "p",
    { class: "shade-key" },
    h("span", { class: "rank-1" }, "best"),
    h("span", { class: "rank-2" }, "second"),
    h("span", { class: "rank-3" }, "third"),
    " of the measured column, on unrounded values · † published by the paper's authors on their own data",
  );

export function showSummary(container) {
  setViewKeys([
    { keys: ["p"], help: "show or hide published numbers", run: () => toggle(!withPublished) },
  ]);
  const toggle = (on) => {
    withPublished = on;
    showSummary(container);
  };
  const tables = [...report.tables].sort((a, b) => isMeasured(b) - isMeasured(a));
  replace(
    container,
    tiles(),
    h(
      "div",
      { class: "bar" },
      shadeKey(),
      checkbox("Published numbers", withPublished, toggle, "with-published"),
    ),
    tables.map(tableSection),
    environmentCard(),
  );
}
