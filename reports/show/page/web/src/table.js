// Tables whose columns sort, rendered a stretch at a time so that 10,000 rows open at once.
import { copyButton } from "./copy.js";
import { h, replace } from "./dom.js";
import { tableCsv, tableLatex, tableMarkdown } from "./table_text.js";

const kChunk = 100; // rows added whenever the end comes near

function comparator(value, sign) {
  return (a, b) => {
    const x = value(a);
    const y = value(b);
    if (x === null || x === undefined) return y === null || y === undefined ? 0 : 1;
    if (y === null || y === undefined) return -1;
    const order =
      typeof x === "number" && typeof y === "number"
        ? x - y
        : `${x}`.localeCompare(`${y}`, "en", { numeric: true });
    return sign * order;
  };
}

function groupRow(columns) {
  if (!columns.some(({ group }) => group)) return null;
  const cells = [];
  for (const { group, className } of columns) {
    const last = cells.at(-1);
    if (last && last.group === group) ++last.span;
    else cells.push({ group, className, span: 1 });
  }
  return h(
    "tr",
    { class: "groups" },
    cells.map(({ group, className, span }) =>
      h("th", { colSpan: span, scope: "colgroup", class: className }, group ?? ""),
    ),
  );
}

// columns: {key, title, group, value(row), cell(row) -> node or text, className, firstSign,
// text(row), rank(row)}. Missing values sort last in either direction. `firstSign`: -1 sorts
// descending at the first click; `text` and `rank` (1: best): of copies, where they differ from the
// cell. `sorted`: {key, sign}; onSort gets the same. `foot`: a last line over all columns.
export class DataTable {
  constructor({ columns, rows, label, emptyText = "Nothing here.", sorted, onSort, foot }) {
    this.columns = columns;
    this.rows = rows;
    this.emptyText = emptyText;
    this.onSort = onSort;
    this.sorted = {
      column: columns.findIndex(({ key }) => key !== undefined && key === sorted?.key),
      sign: sorted?.sign ?? 1,
    };
    this.heads = columns.map((column, index) => this.#head(column, index));
    this.body = h("tbody");
    this.end = h("div", { class: "table-end", "aria-hidden": "true" });
    this.element = h(
      "div",
      { class: "table-scroll", tabindex: "0", role: "region", "aria-label": label },
      h(
        "table",
        { "aria-label": label, "aria-rowcount": String(rows.length) },
        h("thead", {}, groupRow(columns), h("tr", {}, this.heads)),
        this.body,
        foot && h("tfoot", {}, h("tr", {}, h("td", { colSpan: columns.length }, foot))),
      ),
      this.end,
    );
    this.watcher = new IntersectionObserver((entries) => {
      if (entries.some((entry) => entry.isIntersecting)) this.#grow();
    });
    this.watcher.observe(this.end);
    this.#showDirection();
    this.show(rows);
  }

  #head(column, index) {
    const button = h("button", { type: "button", onclick: () => this.sort(index) }, column.title);
    return h("th", { scope: "col", class: column.className, title: column.hint }, button);
  }

  // The first click on a column sorts best first.
  sort(index) {
    const again = this.sorted.column === index;
    const first = this.columns[index].firstSign ?? 1;
    this.sorted = { column: index, sign: again ? -this.sorted.sign : first };
    this.#showDirection();
    this.onSort?.({ key: this.columns[index].key, sign: this.sorted.sign });
    this.show(this.rows);
  }

  #showDirection() {
    const { column, sign } = this.sorted;
    this.heads.forEach((head, i) => {
      head.removeAttribute("aria-sort");
      if (i === column) head.setAttribute("aria-sort", sign > 0 ? "ascending" : "descending");
    });
  }

  // What is shown, for copies: see table_text.js.
  model() {
    const cellOf = (row) => (column) => {
      const shown = column.text ?? column.cell;
      const text = shown ? shown(row) : column.value(row);
      return { text: String(text ?? "–"), value: column.value(row), rank: column.rank?.(row) };
    };
    return {
      columns: this.columns.map(({ title, group }) => ({
        title: title.replaceAll("\u00a0", " "),
        group,
      })),
      rows: this.order.map((row) => this.columns.map(cellOf(row))),
    };
  }

  show(rows) {
    this.rows = rows;
    const { column, sign } = this.sorted;
    this.order = column < 0 ? rows : [...rows].sort(comparator(this.columns[column].value, sign));
    this.shown = 0;
    replace(this.body);
    if (rows.length === 0)
      this.body.append(h("tr", {}, h("td", { colSpan: this.columns.length }, this.emptyText)));
    this.#grow();
  }

  #grow() {
    const next = this.order.slice(this.shown, this.shown + kChunk);
    this.shown += next.length;
    this.body.append(...next.map((row) => this.#row(row)));
    if (next.length > 0 && this.shown < this.order.length) {
      // Observed anew: an element that stays visible is reported once only.
      this.watcher.unobserve(this.end);
      this.watcher.observe(this.end);
    }
  }

  #row(row) {
    return h(
      "tr",
      {},
      this.columns.map((column, index) => {
        const cell = column.cell ? column.cell(row) : column.value(row);
        if (cell instanceof HTMLTableCellElement) return cell;
        return h(
          index === 0 ? "th" : "td",
          { class: column.className, scope: index === 0 ? "row" : null },
          cell ?? "–",
        );
      }),
    );
  }
}

const kWriters = [
  ["LaTeX", tableLatex],
  ["CSV", tableCsv],
  ["Markdown", tableMarkdown],
];

// Buttons that copy what `modelOf` gives: {title, caption, notes, columns, rows}.
export function copyButtons(modelOf) {
  const hint = "the table as it is shown: its order, without what is folded away";
  return h(
    "div",
    { class: "copies", role: "group", "aria-label": "Copy the table" },
    h("span", { class: "note" }, "Copy as"),
    kWriters.map(([name, write]) =>
      copyButton(() => write(modelOf()), name, { title: hint, "data-format": name.toLowerCase() }),
    ),
  );
}
