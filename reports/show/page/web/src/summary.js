// The tables, measured and published, below a picture; and what they were measured on.
import { keepAddress } from "./address.js";
import { report } from "./data.js";
import { checkbox, h, replace } from "./dom.js";
import { setViewKeys } from "./keys.js";
import { openingPicture } from "./opening.js";
import { isMeasured, resultTable } from "./result_table.js";

const kHeadline = "summary"; // id of the table that comes first
const start = () => ({ published: true, columns: new Set(), rows: new Set(), sorts: new Map() });
let state = start();

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

const kBySign = { 1: "up", "-1": "down" };

function address() {
  const sorts = [...state.sorts].map(
    ([table, { key, sign }]) => `${table}:${kBySign[sign]}:${key}`,
  );
  return {
    published: state.published,
    columns: state.columns.size > 0 ? [...state.columns] : null,
    rows: state.rows.size > 0 ? [...state.rows] : null,
    sort: sorts.length > 0 ? sorts : null,
  };
}

function readState(params) {
  state = start();
  state.published = params.flag("published", true);
  state.columns = new Set(params.list("columns"));
  state.rows = new Set(params.list("rows"));
  for (const sort of params.list("sort") ?? []) {
    const [table, direction, ...key] = sort.split(":");
    state.sorts.set(table, { key: key.join(":"), sign: direction === "down" ? -1 : 1 });
  }
}

// The headline first, then what has numbers.
const place = (table) => (table.id === kHeadline ? 2 : 0) + (isMeasured(table) ? 1 : 0);

export function showSummary(container, from) {
  if (from?.params) readState(from.params);
  const changed = (redraw) => {
    keepAddress("summary", address());
    if (redraw) fill();
  };
  const toggle = (on) => {
    state.published = on;
    changed(true);
  };
  setViewKeys([
    { keys: ["p"], help: "show or hide published numbers", run: () => toggle(!state.published) },
  ]);
  const tables = [...report.tables].sort((a, b) => place(b) - place(a));
  const picture = openingPicture();
  const below = h("div");
  const fill = () => {
    const [first, ...others] = tables.map((table) => resultTable(table, state, changed));
    const bar = h(
      "div",
      { class: "bar" },
      shadeKey(),
      checkbox("Published numbers", state.published, toggle, "with-published"),
    );
    replace(below, first, bar, others, tiles(), environmentCard());
  };
  replace(container, picture, below);
  fill();
  keepAddress("summary", address());
}
