// Values under the pointer, of all methods.
import { codes16, loadPart, runTitle, unpack } from "./data.js";
import { h, replace } from "./dom.js";
import { copyButtons } from "./table.js";

// Layers of one value a pixel; colours and errors have columns of their own.
const valueLayers = (scene) => scene.layers.filter(({ decimals }) => decimals !== undefined);

async function decodeLayer({ bits, high, data }) {
  const bytes = await unpack(data);
  return { bits, high, codes: bits === 16 ? codes16(bytes) : bytes };
}

async function decodeLayers(layers) {
  const entries = Object.entries(layers ?? {}).map(async ([id, layer]) => [
    id,
    await decodeLayer(layer),
  ]);
  return Object.fromEntries(await Promise.all(entries));
}

// Null where the map has no value.
function valueAt(layer, i) {
  if (!layer) return null;
  const code = layer.codes[i];
  if (layer.bits === 16 && code === 0) return null;
  return (code / (2 ** layer.bits - 1)) * layer.high;
}

const colorAt = (layers, i) =>
  layers.rgb ? [0, 1, 2].map((c) => valueAt(layers.rgb, 3 * i + c)) : null;

// Values of one view, decoded.
export class ViewValues {
  static async load(scene, view) {
    const part = await loadPart(`probe_${scene}_${view}`);
    const values = new ViewValues();
    [values.width, values.height] = part.size;
    values.step = part.step;
    values.columns = Math.ceil(part.size[0] / part.step);
    values.truth = await decodeLayers(part.truth);
    values.runs = await Promise.all((part.runs ?? []).map(decodeLayers));
    values.glass = part.glass ? await unpack(part.glass) : null;
    return values;
  }

  // Of the truth for run -1.
  at(run, x, y) {
    const layers = run < 0 ? this.truth : this.runs[run];
    const i = Math.floor(y / this.step) * this.columns + Math.floor(x / this.step);
    const color = colorAt(layers, i);
    const truth = colorAt(this.truth, i);
    const error =
      run >= 0 && color && truth
        ? color.reduce((sum, c, k) => sum + Math.abs(c - truth[k]) / 3, 0)
        : null;
    return { color, error, of: (id) => valueAt(layers[id], i) };
  }
}

const number = (value, decimals) => (value === null ? "–" : value.toFixed(decimals));

function probeRow(scene, title, value) {
  const css = value.color ? `rgb(${value.color.map((c) => Math.round(c * 255)).join(" ")})` : null;
  return h(
    "tr",
    {},
    h("th", { scope: "row" }, title),
    h(
      "td",
      {},
      css && h("span", { class: "swatch", style: { background: css } }),
      value.color ? value.color.map((c) => c.toFixed(3)).join("  ") : "missing",
    ),
    h("td", {}, number(value.error, 4)),
    valueLayers(scene).map(({ id, decimals }) => h("td", {}, number(value.of(id), decimals))),
  );
}

// The table of an element, for copies.
function modelOf(element, title) {
  const texts = (row) => [...row.cells].map((cell) => cell.textContent);
  const [head, ...rows] = [...element.querySelectorAll("tr")];
  return {
    title,
    columns: texts(head).map((text) => ({ title: text || "Method" })),
    rows: rows.map((row) => texts(row).map((text) => ({ text }))),
  };
}

// The table below the pictures. `pixel`: [x, y] or null.
export function showProbe(container, scene, values, pixel, pinned) {
  if (!values || !pixel) {
    replace(
      container,
      h(
        "p",
        { class: "note" },
        "Point at a picture to read the values of all methods; click to hold the pixel, arrow keys move it.",
      ),
    );
    return;
  }
  const [x, y] = pixel;
  const coarse = values.step > 1 ? `, every ${values.step} pixels` : "";
  const glass = values.glass?.[y * values.width + x] ? " · glass" : "";
  const title = `Pixel ${x}, ${y}${coarse}${glass}`;
  const titles = [
    "",
    "RGB",
    "Error",
    ...valueLayers(scene).map(({ title, unit }) => (unit ? `${title} (${unit})` : title)),
  ];
  replace(
    container,
    h(
      "div",
      { class: "card-head" },
      h("p", { class: "probe-title" }, `${title}${pinned ? " · held" : ""}`),
      pinned && copyButtons(() => modelOf(container, title)),
    ),
    h(
      "div",
      { class: "table-scroll" },
      h(
        "table",
        { class: "probe" },
        h(
          "thead",
          {},
          h(
            "tr",
            {},
            titles.map((title) => h("th", { scope: "col" }, title)),
          ),
        ),
        h(
          "tbody",
          {},
          probeRow(scene, "Reference", values.at(-1, x, y)),
          scene.runs.map((run, i) => probeRow(scene, runTitle(scene, run), values.at(i, x, y))),
        ),
      ),
    ),
  );
}
