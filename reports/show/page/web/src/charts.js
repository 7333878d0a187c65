// What all charts share: axes, sizes, and saving one as a picture.
import uPlot from "uplot";
import { isDark, methodStyle } from "./method_style.js";
import { drawText, newCanvas } from "./save_png.js";

const kHeight = 320;
const kFont = "12px system-ui, sans-serif";
const charts = [];

export const cssColor = (name) =>
  getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export function axis(label, size) {
  const grid = { stroke: cssColor("--line"), width: 1 };
  return {
    label,
    stroke: cssColor("--quiet"),
    grid,
    ticks: grid,
    font: kFont,
    labelFont: kFont,
    size,
    labelSize: 22,
  };
}

const widthOf = (parent) => Math.max(280, parent.clientWidth);

export function addChart(parent, options, data) {
  const plot = new uPlot({ width: widthOf(parent), height: kHeight, ...options }, data, parent);
  charts.push({ parent, plot });
  return plot;
}

function resize() {
  for (const { parent, plot } of charts)
    if (parent.isConnected) plot.setSize({ width: widthOf(parent), height: kHeight });
}

export function startCharts() {
  window.addEventListener("resize", resize);
}

export function stopCharts() {
  charts.splice(0).forEach(({ plot }) => plot.destroy());
  window.removeEventListener("resize", resize);
}

const kKeyRow = 22;
const kKeyWidth = 210;

function drawKey(context, { index, title }, x, y) {
  const { color, dash, marker } = methodStyle(index);
  context.save();
  context.strokeStyle = color;
  context.lineWidth = 2.5;
  context.setLineDash(dash);
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(x + 34, y);
  context.stroke();
  context.restore();
  drawText(context, `${marker} ${title}`, x + 42, y, { room: kKeyWidth - 50 });
}

// The chart with its title and a key of its methods ({index, title}), on white or on dark.
export function chartCanvas(plot, title, keys) {
  const source = plot.ctx.canvas;
  const scale = devicePixelRatio;
  const [width, height] = [source.width / scale, source.height / scale];
  const columns = Math.max(1, Math.floor(width / kKeyWidth));
  const rows = Math.ceil(keys.length / columns);
  const { canvas, context } = newCanvas(
    source.width,
    source.height + scale * (30 + rows * kKeyRow + 10),
  );
  if (isDark()) {
    context.fillStyle = cssColor("--card");
    context.fillRect(0, 0, canvas.width, canvas.height);
  }
  context.drawImage(source, 0, 30 * scale);
  context.scale(scale, scale);
  const ink = isDark() ? { color: cssColor("--text") } : {};
  drawText(context, title, 12, 16, { bold: true, ...ink });
  keys.forEach((key, i) => {
    const x = 12 + (i % columns) * kKeyWidth;
    drawKey(context, key, x, height + 30 + (Math.floor(i / columns) + 0.5) * kKeyRow);
  });
  return canvas;
}
