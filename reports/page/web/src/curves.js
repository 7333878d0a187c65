// Training by iteration and by time; quality against what it costs.
import uPlot from "uplot";
import { loadScene, metricInfo, metricTitle, report, runTitle, sceneTitle } from "./data.js";
import { h, replace, segmented, select } from "./dom.js";
import { setViewKeys } from "./keys.js";
import { methodStyle } from "./styles.js";

const state = { scene: 0, by: "iteration", cost: "train-minutes", metric: "psnr" };
const kHeight = 300;
const kCosts = ["train-minutes", "num-surfels", "fps", "peak-memory"];
let charts = [];

const cssColor = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function axis(label, size) {
  const grid = { stroke: cssColor("--line"), width: 1 };
  return {
    label,
    stroke: cssColor("--quiet"),
    grid,
    ticks: grid,
    font: "12px system-ui, sans-serif",
    labelFont: "12px system-ui, sans-serif",
    size,
    labelSize: 22,
  };
}

function chart(parent, options, data) {
  const width = Math.max(280, parent.clientWidth);
  charts.push({ parent, plot: new uPlot({ width, height: kHeight, ...options }, data, parent) });
}

function lineSeries(label, index) {
  const { color, dash, marker } = methodStyle(index);
  return {
    label: `${marker} ${label}`,
    stroke: color,
    dash,
    width: 2,
    points: { show: false },
    spanGaps: true,
  };
}

// One chart of `field` for all runs that have a curve.
function showCurve(parent, scene, field, title) {
  const runs = scene.runs.map((run, i) => ({ run, i })).filter(({ run }) => run.curve);
  if (runs.length === 0) {
    replace(parent, h("p", { class: "note" }, "No training log in any run folder: missing."));
    return;
  }
  const data = uPlot.join(runs.map(({ run }) => [run.curve[state.by], run.curve[field]]));
  const xLabel = state.by === "iteration" ? "iteration" : "seconds of training";
  chart(
    parent,
    {
      title,
      scales: { x: { time: false } },
      axes: [axis(xLabel, 34), axis(title, 56)],
      series: [{ label: xLabel }, ...runs.map(({ run, i }) => lineSeries(runTitle(scene, run), i))],
      cursor: { drag: { x: true, y: false } },
      legend: {
        markers: { dash: (plot, i) => (plot.series[i].dash?.length ? "dashed" : "solid") },
      },
    },
    data,
  );
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

// Records of the scene as {title, x, y}.
function pointsOf(sceneIndex, scene) {
  const { metrics, rows } = report.records;
  const { dataset, name } = report.scenes[sceneIndex];
  const first = 8; // columns before the metrics
  const x = metrics.indexOf(state.cost) + first;
  const y = metrics.indexOf(state.metric) + first;
  return scene.runs
    .map((run, index) => {
      const row = rows.find(
        (r) => r[0] === dataset && r[1] === name && r[2] === run.method && r[3] === run.seed,
      );
      return { title: runTitle(scene, run), index, x: row?.[x], y: row?.[y] };
    })
    .filter(({ x: cost, y: quality }) => typeof cost === "number" && typeof quality === "number");
}

function showCost(parent, sceneIndex, scene) {
  const points = pointsOf(sceneIndex, scene);
  if (points.length === 0) {
    replace(
      parent,
      h("p", { class: "note" }, `No run has both ${state.cost} and ${state.metric}: missing.`),
    );
    return;
  }
  const series = points.map(({ title, index }) => {
    const { color, marker } = methodStyle(index);
    return {
      label: `${marker} ${title}`,
      stroke: color,
      paths: () => null,
      points: { show: drawMarker(marker, color) },
    };
  });
  const margin = (plot, low, high) => {
    const room = 0.08 * (high - low || Math.abs(high) || 1);
    return [low - room, high + room];
  };
  chart(
    parent,
    {
      title: `${metricTitle(state.metric)} against ${metricTitle(state.cost)}`,
      scales: { x: { time: false, range: margin }, y: { range: margin } },
      axes: [axis(metricTitle(state.cost), 34), axis(metricTitle(state.metric), 56)],
      series: [{ label: state.cost }, ...series],
    },
    uPlot.join(points.map(({ x, y }) => [[x], [y]])),
  );
}

function resize() {
  for (const { parent, plot } of charts)
    if (parent.isConnected)
      plot.setSize({ width: Math.max(280, parent.clientWidth), height: kHeight });
}

function stop() {
  charts.forEach(({ plot }) => plot.destroy());
  charts = [];
  window.removeEventListener("resize", resize);
}

export async function showCurves(container, index = state.scene) {
  stop();
  const again = (changes) => {
    Object.assign(state, changes);
    showCurves(container);
  };
  setViewKeys([
    {
      keys: ["t"],
      help: "by iteration or by time",
      run: () => again({ by: state.by === "iteration" ? "seconds" : "iteration" }),
    },
  ]);
  if (report.scenes.length === 0) {
    replace(container, h("p", { class: "card" }, "No records yet: nothing to show."));
    return stop;
  }
  state.scene = Math.min(Number(index) || 0, report.scenes.length - 1);
  const scene = await loadScene(state.scene);
  const [loss, psnr, cost] = ["loss", "psnr", "cost"].map((name) =>
    h("div", { class: "card chart", id: `chart-${name}` }),
  );
  const measured = report.records.metrics;
  const quality = measured.filter(
    (id) => !id.includes("@") && metricInfo(id).direction !== "none" && !kCosts.includes(id),
  );
  replace(
    container,
    h(
      "div",
      { class: "bar" },
      select(
        "Scene",
        report.scenes.map((_, i) => [i, sceneTitle(i)]),
        state.scene,
        (i) => (location.hash = `#curves/${i}`),
      ),
      segmented(
        "Horizontal axis",
        [
          ["iteration", "by iteration"],
          ["seconds", "by time"],
        ],
        state.by,
        (by) => again({ by }),
      ),
      select(
        "Quality",
        quality.map((id) => [id, metricTitle(id)]),
        state.metric,
        (metric) => again({ metric }),
      ),
      select(
        "against",
        kCosts.filter((id) => measured.includes(id)).map((id) => [id, metricTitle(id)]),
        state.cost,
        (c) => again({ cost: c }),
      ),
    ),
    h(
      "p",
      { class: "note" },
      "Drag across a chart to enlarge a stretch, double-click for all. Click a name to hide its line. Loss and PSNR are of single training views, so they scatter.",
    ),
    h("div", { class: "charts" }, loss, psnr, cost),
  );
  showCurve(loss, scene, "loss", "training loss");
  showCurve(psnr, scene, "psnr", "PSNR of training views (dB)");
  showCost(cost, state.scene, scene);
  window.addEventListener("resize", resize);
  return stop;
}
