// One field of the training logs by iteration or by time.
import uPlot from "uplot";
import { addChart, axis, cssColor } from "./charts.js";
import { runTitle } from "./data.js";
import { methodStyle } from "./method_style.js";
import { smoothed, valueAt } from "./smoothing.js";

const kMark = 5; // half the size of a mark, pixels
const kFewLines = 2; // that many lines leave room for what marks mean

function lines(run, index, title, { by, smooth }, field) {
  const { color, dash, marker } = methodStyle(index);
  const xs = run.curve[by];
  const raw = run.curve[field];
  const line = (values, more) => ({
    xs,
    values,
    series: { stroke: color, points: { show: false }, spanGaps: true, ...more },
  });
  const label = `${marker} ${title}`;
  const smoothLine = line(smoothed(raw, smooth), { label, dash, width: 2 });
  if (smooth === 0) return [smoothLine];
  return [line(raw, { label: `${label}, raw`, width: 1, alpha: 0.22, class: "raw" }), smoothLine];
}

function drawMark({ ctx }, x, y, color) {
  const size = kMark * devicePixelRatio;
  ctx.beginPath();
  ctx.moveTo(x, y - size);
  ctx.lineTo(x + size, y);
  ctx.lineTo(x, y + size);
  ctx.lineTo(x - size, y);
  ctx.closePath();
  ctx.fillStyle = cssColor("--card");
  ctx.strokeStyle = color;
  ctx.lineWidth = 1.5 * devicePixelRatio;
  ctx.fill();
  ctx.stroke();
}

// What begins or ends, along a vertical line: from its top, or up to its bottom.
function drawText(plot, x, text, color, atTop) {
  const { ctx, bbox } = plot;
  ctx.setLineDash([3 * devicePixelRatio, 3 * devicePixelRatio]);
  ctx.lineWidth = devicePixelRatio;
  ctx.strokeStyle = color;
  ctx.beginPath();
  ctx.moveTo(x, bbox.top);
  ctx.lineTo(x, bbox.top + bbox.height);
  ctx.stroke();
  ctx.setLineDash([]);
  const edge = 4 * devicePixelRatio;
  const y = atTop ? bbox.top + edge : bbox.top + bbox.height - edge;
  ctx.translate(x - 3 * devicePixelRatio, y);
  ctx.rotate(-Math.PI / 2);
  ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
  ctx.fillStyle = color;
  ctx.textBaseline = "bottom"; // beside the line, not on it
  ctx.textAlign = atTop ? "right" : "left";
  ctx.fillText(text, 0, 0);
}

// Events of one step under one mark.
export function marksOf(events, by) {
  const marks = new Map();
  for (const event of events ?? [])
    marks.set(event[by], [...(marks.get(event[by]) ?? []), event.text]);
  return [...marks].map(([x, texts]) => ({ x, text: texts.join(", ") })).sort((a, b) => a.x - b.x);
}

function drawMarks(plot, chosen, { by }, linesOf) {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  chosen.forEach(({ run, index }, i) => {
    const { color } = methodStyle(index);
    const line = linesOf[i].at(-1);
    for (const { x, text } of marksOf(run.curve.events, by)) {
      const value = valueAt(line.xs, line.values, x);
      const left = plot.valToPos(x, "x", true);
      if (chosen.length <= kFewLines) {
        ctx.save();
        drawText(plot, left, text, color, i === 0);
        ctx.restore();
      }
      if (value !== null) drawMark(plot, left, plot.valToPos(value, "y", true), color);
    }
  });
  ctx.restore();
}

// chosen: [{run, index}]; settings: {by, smooth, marks, range}; onRange([low, high] or null).
export function trainingChart(parent, scene, chosen, field, title, settings, onRange) {
  const linesOf = chosen.map(({ run, index }) =>
    lines(run, index, runTitle(scene, run), settings, field),
  );
  const all = linesOf.flat();
  const data = uPlot.join(all.map(({ xs, values }) => [xs, values]));
  const xLabel = settings.by === "iteration" ? "iteration" : "seconds of training";
  let ready = false;
  const plot = addChart(
    parent,
    {
      scales: { x: { time: false } },
      axes: [axis(xLabel, 34), axis(title, 56)],
      series: [{ label: xLabel }, ...all.map(({ series }) => series)],
      cursor: { drag: { x: true, y: false }, focus: { prox: 24 } },
      focus: { alpha: 0.3 },
      legend: {
        markers: { dash: (u, i) => (u.series[i].dash?.length ? "dashed" : "solid") },
      },
      hooks: {
        draw: [(u) => settings.marks && drawMarks(u, chosen, settings, linesOf)],
        setScale: [
          (u, key) => {
            if (!ready || key !== "x") return;
            const xs = u.data[0];
            const { min, max } = u.scales.x;
            onRange(min <= xs[0] && max >= xs.at(-1) ? null : [min, max]);
          },
        ],
      },
    },
    data,
  );
  if (settings.range) plot.setScale("x", { min: settings.range[0], max: settings.range[1] });
  // uPlot sets its scales in a microtask; only later changes are the reader's.
  queueMicrotask(() => queueMicrotask(() => (ready = true)));
  return plot;
}
