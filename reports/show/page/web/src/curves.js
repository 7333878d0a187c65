// Training by iteration and by time; quality against what it costs.
import { keepAddress } from "./address.js";
import { chartCanvas, startCharts, stopCharts } from "./charts.js";
import { costChart, costPoints } from "./cost_chart.js";
import {
  loadScene,
  metricInfo,
  metricTitle,
  report,
  runKey,
  runTitle,
  sceneKey,
  sceneOfAddress,
  sceneTitle,
} from "./data.js";
import { checkbox, h, replace, segmented, select } from "./dom.js";
import { setViewKeys } from "./keys.js";
import { chosenKeys, hiddenKeys, methodChoice } from "./method_choice.js";
import { saveButton } from "./save_png.js";
import { sceneChoice } from "./scene_choice.js";
import { marksOf, trainingChart } from "./training_chart.js";

const kMaxSmooth = 30; // percent of the points
const start = () => ({
  by: "iteration",
  cost: "train-minutes",
  metric: "psnr",
  smooth: 8,
  marks: true,
  hidden: new Set(),
  range: null,
});
const state = { scene: 0, ...start() };
const kCosts = ["train-minutes", "num-surfels", "fps", "peak-memory", "device-memory"];
const kBy = { iteration: "iteration", time: "seconds" };

function keep(scene, push = false) {
  const { by, cost, metric, smooth, marks, hidden, range } = state;
  const chosen = chosenKeys(scene, hidden);
  keepAddress(
    "curves",
    {
      scene: sceneKey(state.scene),
      by: by === "seconds" ? "time" : by,
      smooth,
      marks,
      quality: metric,
      cost,
      methods: chosen,
      range,
    },
    push,
  );
}

function readState(params, scene) {
  Object.assign(state, start());
  state.by = kBy[params.choice("by", Object.keys(kBy), "iteration")];
  state.smooth = params.number("smooth", 0, kMaxSmooth, state.smooth);
  state.marks = params.flag("marks", true);
  state.metric = params.choice("quality", qualities(), state.metric);
  state.cost = params.choice("cost", costs(), state.cost);
  state.hidden = hiddenKeys(scene, params.list("methods"));
  state.range = params.numbers("range", 2);
}

// As it stands in the address: lines are drawn at whole pixels, so a range that is a little
// longer elsewhere would move some of them.
const addressed = (range) => range?.map((x) => Number(x.toPrecision(5))) ?? null;

const costs = () => kCosts.filter((id) => report.records.metrics.includes(id));

const qualities = () =>
  report.records.metrics.filter(
    (id) => !id.includes("@") && metricInfo(id).direction !== "none" && !kCosts.includes(id),
  );

function smoothSlider(changed) {
  const shown = h("output", {}, `${state.smooth} %`);
  const slider = h("input", {
    type: "range",
    id: "smooth",
    min: "0",
    max: String(kMaxSmooth),
    value: String(state.smooth),
    title: "each point is the mean over this share of the training around it; raw lines are faint",
    oninput: () => {
      state.smooth = Number(slider.value);
      shown.textContent = `${state.smooth} %`;
      changed();
    },
  });
  return h("label", { class: "field" }, h("span", {}, "Smoothed over"), slider, shown);
}

// What each mark stands for.
function marksList(scene, chosen) {
  const items = chosen
    .map(({ run }) => ({ run, marks: marksOf(run.curve?.events, "iteration") }))
    .filter(({ marks }) => marks.length > 0)
    .map(({ run, marks }) =>
      h(
        "li",
        {},
        h("strong", {}, `${runTitle(scene, run)}: `),
        marks.map(({ x, text }) => `${x}: ${text}`).join(" · "),
      ),
    );
  return h(
    "details",
    { class: "card", id: "marks-list" },
    h("summary", {}, "What begins and ends, by iteration"),
    h("ul", { class: "notes" }, items),
    h(
      "p",
      { class: "note" },
      "Read from the logs: resets of opacities, the first and last step with a loss term, and with another number of surfels.",
    ),
  );
}

// A card whose chart is drawn again when a choice changes.
class ChartCard {
  constructor(id, title, draw) {
    Object.assign(this, { title, draw, body: h("div"), heading: h("h2") });
    const save = saveButton(
      () => chartCanvas(this.plot, this.title(), this.keys),
      () => [report.profile, sceneTitle(state.scene), id],
    );
    this.save = save;
    this.element = h(
      "div",
      { class: "card chart", id: `chart-${id}` },
      h("div", { class: "card-head" }, this.heading, save),
      this.body,
    );
  }

  show(scene, chosen) {
    this.heading.textContent = this.title();
    replace(this.body);
    const drawn = this.draw(this.body, scene, chosen);
    this.save.hidden = !drawn.plot;
    if (drawn.plot) Object.assign(this, drawn);
    else replace(this.body, h("p", { class: "note" }, drawn));
  }
}

const keysOf = (scene, chosen) =>
  chosen.map(({ run, index }) => ({ index, title: runTitle(scene, run) }));

function trainingCard(id, field, title, onRange) {
  return new ChartCard(
    id,
    () => title,
    (body, scene, chosen) => {
      const logged = chosen.filter(({ run }) => run.curve);
      if (chosen.length === 0) return "No method is chosen.";
      if (logged.length === 0) return "No training log in any run folder: missing.";
      const plot = trainingChart(body, scene, logged, field, title, state, onRange);
      return { plot, keys: keysOf(scene, logged) };
    },
  );
}

function costCard() {
  const { title } = {
    title: () => `${metricTitle(state.metric)} against ${metricTitle(state.cost)}`,
  };
  return new ChartCard("cost", title, (body, scene, chosen) => {
    const points = costPoints(state.scene, scene, chosen, state.cost, state.metric);
    if (chosen.length === 0) return "No method is chosen.";
    if (points.length === 0) return `No run has both ${state.cost} and ${state.metric}: missing.`;
    return { plot: costChart(body, points, state.cost, state.metric), keys: points };
  });
}

function controls(again, redraw, open) {
  return h(
    "div",
    { class: "bar" },
    sceneChoice(state.scene, open),
    segmented(
      "Horizontal axis",
      [
        ["iteration", "by iteration"],
        ["seconds", "by time"],
      ],
      state.by,
      (by) => again({ by, range: null }),
    ),
    smoothSlider(redraw),
    checkbox("Mark what begins and ends", state.marks, (marks) => again({ marks }), "marks"),
    select(
      "Quality",
      qualities().map((id) => [id, metricTitle(id)]),
      state.metric,
      (metric) => again({ metric }),
      "quality",
    ),
    select(
      "against",
      costs().map((id) => [id, metricTitle(id)]),
      state.cost,
      (cost) => again({ cost }),
      "cost",
    ),
  );
}

function stop() {
  stopCharts();
}

const curveKeys = (again) => [
  {
    keys: ["t"],
    help: "by iteration or by time",
    run: () => again({ by: state.by === "iteration" ? "seconds" : "iteration", range: null }),
  },
];

const hint = () =>
  h(
    "p",
    { class: "note" },
    "Drag across a chart to enlarge a stretch, double-click for all. Loss and PSNR are of single training views, so they scatter.",
  );

const chartsOf = (cards) =>
  h(
    "div",
    { class: "charts" },
    cards.map((card) => card.element),
  );

export async function showCurves(container, from) {
  stop();
  setViewKeys([]);
  if (report.scenes.length === 0) {
    replace(container, h("p", { class: "card" }, "No records yet: nothing to show."));
    return stop;
  }
  if (from) state.scene = sceneOfAddress(from, state.scene);
  const scene = await loadScene(state.scene);
  if (from?.params) readState(from.params, scene);
  const onRange = (dragged) => {
    const range = addressed(dragged);
    if (String(range) === String(state.range)) return;
    state.range = range;
    keep(scene);
    redraw();
  };
  const cards = [
    trainingCard("loss", "loss", "Training loss", onRange),
    trainingCard("psnr", "psnr", "PSNR of training views (dB)", onRange),
    costCard(),
  ];
  const below = h("div");
  const redraw = () => {
    const chosen = scene.runs
      .map((run, index) => ({ run, index }))
      .filter(({ run }) => !state.hidden.has(runKey(scene, run)));
    stopCharts();
    cards.forEach((card) => card.show(scene, chosen));
    replace(below, marksList(scene, chosen));
    startCharts();
    keep(scene);
  };
  const head = h("div");
  const again = (changes) => {
    Object.assign(state, changes);
    fill();
  };
  const open = (index) => {
    Object.assign(state, { scene: index, range: null });
    loadScene(index).then((other) => (keep(other, true), showCurves(container)));
  };
  const fill = () => {
    replace(
      head,
      controls(again, redraw, open),
      methodChoice(scene, state.hidden, fill),
      hint(),
    );
    redraw();
  };
  setViewKeys(curveKeys(again));
  replace(container, head, chartsOf(cards), below);
  fill();
  return stop;
}
