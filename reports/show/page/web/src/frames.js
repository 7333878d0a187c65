// The views of a scene, sorted by what a method makes of them.
import { metricInfo, metricText, metricTitle, pictureUrl, runTitle } from "./data.js";
import { h, replace, select } from "./dom.js";

export const kOrders = [
  ["worst", "worst first"],
  ["best", "best first"],
  ["camera", "along the path"],
];

export function scoreOf(scene, run, view, metric) {
  const column = scene.metrics.indexOf(metric);
  return scene.runs[run]?.scores[view]?.[column] ?? null;
}

// Indices of views; those without a score last.
export function sortedViews(scene, { run, metric, order }) {
  const views = scene.views.map((_, index) => index);
  if (order === "camera") return views;
  const higherIsBetter = metricInfo(metric).direction !== "lower";
  const sign = (order === "worst") === higherIsBetter ? 1 : -1;
  const value = (view) => {
    const score = scoreOf(scene, run, view, metric);
    return score === null ? Infinity : sign * score;
  };
  return views.sort((a, b) => value(a) - value(b) || a - b);
}

function thumbnail(state, view) {
  const { truth, runs } = state.scene.views[view];
  const owner = truth.includes("rgb")
    ? "t"
    : runs?.[state.run]?.includes("rgb")
      ? `r${state.run}`
      : null;
  if (!owner) return h("span", { class: "thumb missing" }, "missing");
  return h("img", {
    class: "thumb",
    loading: "lazy",
    alt: "",
    src: pictureUrl(state.index, view, owner, "rgb"),
  });
}

function frameButton(state, view, largest) {
  const score = scoreOf(state.scene, state.run, view, state.metric);
  const share = score === null || !largest ? 0 : Math.abs(score) / largest;
  return h(
    "button",
    {
      type: "button",
      class: "frame",
      "data-view": String(view),
      "aria-current": view === state.view ? "true" : null,
      onclick: () => state.setView(view),
    },
    thumbnail(state, view),
    h("span", { class: "frame-name" }, state.scene.views[view].name),
    h("span", { class: "frame-score" }, metricText(state.metric, score)),
    h("span", { class: "frame-bar", style: { width: `${100 * share}%` }, "aria-hidden": "true" }),
  );
}

export function showFrames(container, state, sceneChoice) {
  const { scene } = state;
  const metrics = scene.metrics.map((id) => [id, metricTitle(id)]);
  const runs = scene.runs.map((run, i) => [i, runTitle(scene, run)]);
  const order = sortedViews(scene, state);
  const largest = Math.max(
    ...order.map((view) => Math.abs(scoreOf(scene, state.run, view, state.metric) ?? 0)),
  );
  replace(
    container,
    sceneChoice,
    h("h2", {}, `${scene.views.length} test views`),
    metrics.length > 0 &&
      select("Sorted by", metrics, state.metric, (id) => state.set({ metric: id }), "frame-metric"),
    select("of", runs, state.run, (run) => state.set({ run: Number(run) }), "frame-run"),
    select("Order", kOrders, state.order, (name) => state.set({ order: name }), "frame-order"),
    h(
      "div",
      { class: "frames", role: "group", "aria-label": "Views" },
      order.map((view) => frameButton(state, view, largest)),
    ),
  );
  // Scrolls the list alone: the page must not jump.
  const list = container.querySelector(".frames");
  const current = list.querySelector("[aria-current]");
  if (current) list.scrollTop = current.offsetTop - list.offsetTop - list.clientHeight / 3;
}
