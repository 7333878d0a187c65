// One table of results: what nobody has is folded away, the rest sorts and can be copied.
import { h } from "./dom.js";
import { copyButtons, DataTable } from "./table.js";

// Behind a space that does not break: no line has an arrow alone.
const kArrows = { higher: "\u00a0↑", lower: "\u00a0↓", none: "" };
const kRankWords = ["", "best", "second", "third"];

// What stands in place of a value; of a metric that needs what is not there ("no weights"), why.
const wordOf = ({ status, note }) =>
  ({ missing: "missing", failed: "failed", unavailable: note, "not applicable": "n/a" })[status];

const shownText = (cell, column) => wordOf(cell) ?? `${cell.text}${column.published ? "†" : ""}`;

// A number, or a word that says what went wrong.
const tells = ({ status }) => !["missing", "unavailable", "not applicable"].includes(status);

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
  return h(
    "td",
    { class: classes.filter(Boolean).join(" "), title: hint },
    cell.status === "failed" && h("span", { "aria-hidden": "true" }, "✕ "),
    shownText(cell, column),
    cell.status === "failed" && cell.note && h("span", { class: "why" }, cell.note),
    ranked && h("span", { class: "unseen" }, ` (${ranked})`),
  );
}

const columnTitle = ({ title, unit, direction }) =>
  `${title}${unit ? ` (${unit})` : ""}${kArrows[direction]}`;

function tableColumns(columns) {
  return [
    { key: "method", title: "Method", group: "", value: (row) => row.title, className: "method" },
    ...columns.map((column) => ({
      key: column.id,
      title: columnTitle(column),
      group: column.published ? `${column.group}, published †` : `${column.group}, measured`,
      className: column.published ? "published" : "",
      firstSign: column.direction === "higher" ? -1 : 1,
      value: (row) => row.cells[column.id].value ?? row.cells[column.id].text ?? null,
      text: (row) => shownText(row.cells[column.id], column),
      rank: (row) => row.cells[column.id].rank,
      cell: (row) => cellNode(row.cells[column.id], column),
    })),
  ];
}

export const isMeasured = (table) =>
  table.rows.some((row) =>
    table.columns.some(({ id, published }) => !published && tells(row.cells[id])),
  );

// A failed method stands in every column; what it lacks fills none that no other method fills.
function emptyColumns(table, columns) {
  const holds = (test) => (column) => table.rows.some(({ cells }) => test(cells[column.id]));
  const isFilled = holds((cell) => tells(cell) && cell.status !== "failed");
  return columns.filter((column) => !(columns.some(isFilled) ? isFilled : holds(tells))(column));
}

// Rows that were not run: variants of a method (an ablation's), and others without a published
// number to show.
function rowsNotRun(table, columns) {
  const measured = table.columns.filter(({ published }) => !published);
  const published = columns.filter((column) => column.published);
  return table.rows.filter(
    ({ method, cells }) =>
      measured.every(({ id }) => cells[id].status === "missing") &&
      (method.includes("/") || !published.some(({ id }) => tells(cells[id]))),
  );
}

function foldButton(folded, open, what, names, toggle) {
  if (folded.length === 0) return null;
  const text = open ? `Hide ${folded.length} ${what}` : `Show ${folded.length} ${what}`;
  return h(
    "button",
    { type: "button", class: "fold", "aria-expanded": String(open), onclick: toggle },
    h("span", { "aria-hidden": "true" }, open ? "▾ " : "▸ "),
    text,
    !open && h("span", { class: "folded" }, `: ${names.join(", ")}`),
  );
}

const plural = (list, one, several) => (list.length === 1 ? one : several);

function emptyName(table, { id, title }) {
  const why = table.rows.map((row) => row.cells[id].note).find(Boolean);
  return why ? `${title} (${why})` : title;
}

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

// state: {published, columns and rows (sets of ids of tables whose folds are open), sorts (table
// id -> {key, sign})}; `changed(redraw)` after each change of it.
export function resultTable(table, state, changed) {
  const candidates = table.columns.filter(({ published }) => state.published || !published);
  const empty = emptyColumns(table, candidates);
  const notRun = rowsNotRun(table, candidates);
  const [allColumns, allRows] = [state.columns.has(table.id), state.rows.has(table.id)];
  const toggle = (open) => () => {
    if (!open.delete(table.id)) open.add(table.id);
    changed(true);
  };
  const data = new DataTable({
    columns: tableColumns(candidates.filter((column) => allColumns || !empty.includes(column))),
    rows: table.rows.filter((row) => allRows || !notRun.includes(row)),
    label: table.title,
    emptyText: "No row was run.",
    sorted: state.sorts.get(table.id),
    onSort: (sorted) => (state.sorts.set(table.id, sorted), changed(false)),
    foot: foldButton(
      notRun,
      allRows,
      plural(notRun, "row that was not run", "rows that were not run"),
      notRun.map(({ title }) => title),
      toggle(state.rows),
    ),
  });
  const { title, caption } = table;
  const model = () => ({ title, caption, notes: shownNotes(table), ...data.model() });
  return h(
    "section",
    { class: "card", id: `table-${table.id}` },
    h("div", { class: "card-head" }, h("h2", {}, title), copyButtons(model)),
    h("p", { class: "caption" }, caption),
    isMeasured(table) ? null : h("p", { class: "note" }, "Nothing measured yet for this table."),
    data.element,
    foldButton(
      empty,
      allColumns,
      plural(empty, "empty column", "empty columns"),
      empty.map((column) => emptyName(table, column)),
      toggle(state.columns),
    ),
    agreementOf(table),
    h(
      "ul",
      { class: "notes" },
      shownNotes(table).map((note) => h("li", {}, note)),
    ),
  );
}
