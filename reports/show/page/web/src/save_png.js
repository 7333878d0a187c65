// What the page shows, as a PNG: panels with titles on one canvas.
import { loadPart, picturePath } from "./data.js";
import { h } from "./dom.js";

const kFont = "system-ui, 'DejaVu Sans', sans-serif";
const kTitle = 24; // pixels of a title's line
const kGap = 8;
const kPanel = 420; // smaller pictures are enlarged by whole numbers up to this width
const [kPaper, kInk, kQuiet] = ["#ffffff", "#1a2230", "#5a6678"];

// A picture whose pixels may be read: one that a page from file:// shows may not.
export async function readablePicture(scene, view, owner, layer) {
  const path = picturePath(scene, view, owner, layer);
  const image = new Image();
  image.src = window.GLINT_ASSETS?.[`${path}.png`] ?? (await loadPart(path));
  await image.decode();
  return image;
}

export function newCanvas(width, height) {
  const canvas = h("canvas", {});
  Object.assign(canvas, { width: Math.round(width), height: Math.round(height) });
  const context = canvas.getContext("2d");
  context.fillStyle = kPaper;
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.textBaseline = "middle";
  return { canvas, context };
}

export function drawText(context, text, x, y, { bold, quiet, room, color } = {}) {
  context.font = `${bold ? "600 " : ""}14px ${kFont}`;
  context.fillStyle = color ?? (quiet ? kQuiet : kInk);
  context.fillText(text, x, y, room);
}

// How much larger a picture of this width is drawn.
export const enlargement = (width) => Math.max(1, Math.round(kPanel / width));

function drawMissing(context, { why }, x, y, width, height) {
  context.fillStyle = "#e8ecf2";
  context.fillRect(x, y, width, height);
  drawText(context, `missing: ${why}`, x + kGap, y + height / 2, {
    quiet: true,
    room: width - 2 * kGap,
  });
}

// rows: [[{title, draw(context, width, height)} or {title, why}]], all of one size; `foot`: a last
// line, and {draw, height} below it.
export function panelCanvas(rows, width, height, foot, legend) {
  const columns = Math.max(...rows.map((row) => row.length));
  const rowHeight = kTitle + height + kGap;
  const total = rows.length * rowHeight + kTitle + (legend ? kTitle : 0);
  const { canvas, context } = newCanvas(columns * (width + kGap) + kGap, total + kGap);
  rows.forEach((row, j) =>
    row.forEach((panel, i) => {
      const [x, y] = [kGap + i * (width + kGap), kGap + j * rowHeight];
      drawText(context, panel.title, x, y + kTitle / 2 - 2, { bold: true, room: width });
      context.save();
      context.translate(x, y + kTitle);
      context.beginPath();
      context.rect(0, 0, width, height);
      context.clip();
      context.imageSmoothingEnabled = false;
      if (panel.draw) panel.draw(context, width, height);
      else drawMissing(context, panel, 0, 0, width, height);
      context.restore();
    }),
  );
  const y = kGap + rows.length * rowHeight + kTitle / 2 - 4;
  drawText(context, foot, kGap, y, { quiet: true, room: canvas.width - 2 * kGap });
  legend?.(context, kGap, y + kTitle);
  return canvas;
}

// Limits and colours of a layer in one line.
export function drawColorbar(context, layer, x, y) {
  const bar = 180;
  const low = `${Number(layer.low.toPrecision(3))}`;
  drawText(context, low, x, y);
  const from = x + context.measureText(low).width + kGap;
  layer.colors.forEach((color, i) => {
    context.fillStyle = color;
    const step = bar / layer.colors.length;
    context.fillRect(from + i * step, y - 6, step + 1, 12);
  });
  drawText(context, `${Number(layer.high.toPrecision(3))} ${layer.unit}`, from + bar + kGap, y);
}

const fileName = (words) =>
  `${words
    .filter(Boolean)
    .join("_")
    .replace(/[^\w.+-]+/g, "-")}.png`;

// `make` gives a canvas or promises one; `words` names the file.
export function saveButton(make, words, title = "Save as PNG") {
  const button = h("button", { type: "button", class: "save", onclick: save }, title);
  async function save() {
    button.disabled = true;
    try {
      const canvas = await make();
      const blob = await new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
      const url = URL.createObjectURL(blob);
      h("a", { href: url, download: fileName(words()) }).click();
      setTimeout(() => URL.revokeObjectURL(url), 10_000);
      button.textContent = title;
    } catch (error) {
      button.textContent = `Not saved: ${error.message}`;
    }
    button.disabled = false;
  }
  return button;
}
