// A metric against what it costs: a marker with its title for each run of a scene.
import uPlot from "uplot";
import { addChart, axis, cssColor } from "./charts.js";
import { metricTitle, report, runTitle } from "./data.js";
import { methodStyle } from "./method_style.js";

const kFirstMetric = 8; // columns of a record before its metrics

// [{title, index, x, y}] of the chosen runs that have both.
export function costPoints(sceneIndex, scene, chosen, cost, metric) {
  const { metrics, rows } = report.records;
  const { dataset, name } = report.scenes[sceneIndex];
  const [x, y] = [cost, metric].map((id) => metrics.indexOf(id) + kFirstMetric);
  return chosen
    .map(({ run, index }) => {
      const row = rows.find(
        (r) => r[0] === dataset && r[1] === name && r[2] === run.method && r[3] === run.seed,
      );
      return { title: runTitle(scene, run), index, x: row?.[x], y: row?.[y] };
    })
    .filter((point) => typeof point.x === "number" && typeof point.y === "number");
}

const overlap = (a, b) =>
  a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;

// Places beside a marker, in order of preference, as [horizontal, vertical] in text sizes.
const kPlaces = [
  [1, 0],
  [-1, 0],
  [0, -1],
  [0, 1],
  [1, -1],
  [1, 1],
  [-1, -1],
  [-1, 1],
];

// Titles beside their markers; one without room is left to the key of methods.
function drawTitles(plot, points) {
  const { ctx, bbox } = plot;
  const size = 12 * devicePixelRatio;
  ctx.save();
  ctx.font = `${size}px system-ui, sans-serif`;
  ctx.textBaseline = "middle";
  ctx.textAlign = "left";
  ctx.fillStyle = cssColor("--text");
  const centers = points.map(({ x, y }) => [
    plot.valToPos(x, "x", true),
    plot.valToPos(y, "y", true),
  ]);
  const taken = centers.map(([x, y]) => ({
    left: x - size / 2,
    right: x + size / 2,
    top: y - size / 2,
    bottom: y + size / 2,
  }));
  const fits = (box) =>
    box.left >= bbox.left &&
    box.right <= bbox.left + bbox.width &&
    box.top >= bbox.top &&
    box.bottom <= bbox.top + bbox.height &&
    !taken.some((other) => overlap(box, other));
  points.forEach(({ title }, i) => {
    const width = ctx.measureText(title).width;
    const [x, y] = centers[i];
    const boxes = kPlaces.map(([h, v]) => {
      const left = h === 0 ? x - width / 2 : h > 0 ? x + 0.8 * size : x - 0.8 * size - width;
      const middle = y + v * 1.2 * size;
      return { left, right: left + width, top: middle - size / 2, bottom: middle + size / 2 };
    });
    const box = boxes.find(fits);
    if (!box) return;
    taken.push(box);
    ctx.fillText(title, box.left, (box.top + box.bottom) / 2);
  });
  ctx.restore();
}

// A marker of the series' own shape instead of uPlot's circle.
function drawMarker(marker, color) {
  return (plot, series) => {
    const { ctx } = plot;
    ctx.save();
    ctx.fillStyle = color;
    ctx.font = `${15 * devicePixelRatio}px system-ui, sans-serif`;
    ctx.textAlign = "center";
    ctx.textBaseline = "middle";
    plot.data[series].forEach((value, i) => {
      if (value === null || value === undefined) return;
      ctx.fillText(
        marker,
        plot.valToPos(plot.data[0][i], "x", true),
        plot.valToPos(value, "y", true),
      );
    });
    ctx.restore();
  };
}

function margin(plot, low, high) {
  const room = 0.08 * (high - low || Math.abs(high) || 1);
  return [low - room, high + room];
}

export function costChart(parent, points, cost, metric) {
  const series = points.map(({ title, index }) => {
    const { color, marker } = methodStyle(index);
    return {
      label: `${marker} ${title}`,
      stroke: color,
      paths: () => null,
      points: { show: drawMarker(marker, color) },
    };
  });
  return addChart(
    parent,
    {
      scales: { x: { time: false, range: margin }, y: { range: margin } },
      axes: [axis(metricTitle(cost), 34), axis(metricTitle(metric), 56)],
      series: [{ label: cost }, ...series],
      legend: { show: false },
      hooks: { draw: [(plot) => drawTitles(plot, points)] },
    },
    uPlot.join(points.map(({ x, y }) => [[x], [y]])),
  );
}
