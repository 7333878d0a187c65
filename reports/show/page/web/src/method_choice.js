// A key of methods: the line of each with its title, and which are drawn.
import { runKey, runTitle } from "./data.js";
import { h, svg } from "./dom.js";
import { methodStyle } from "./method_style.js";

// A piece of the line as charts draw it.
function lineSample(index) {
  const { color, dash } = methodStyle(index);
  return svg(
    "svg",
    { class: "sample", viewBox: "0 0 34 10", "aria-hidden": "true" },
    svg("line", {
      x1: 0,
      x2: 34,
      y1: 5,
      y2: 5,
      stroke: color,
      "stroke-width": 2.5,
      "stroke-dasharray": dash.join(" "),
    }),
  );
}

// `hidden`: a set of keys of runs; `changed` is called after it changed.
export function methodChoice(scene, hidden, changed) {
  const keys = scene.runs.map((run) => runKey(scene, run));
  const set = (hide) => () => {
    keys.forEach((key) => (hide ? hidden.add(key) : hidden.delete(key)));
    changed();
  };
  const toggle = (key) => (event) => {
    if (event.target.checked) hidden.delete(key);
    else hidden.add(key);
    changed();
  };
  const chips = scene.runs.map((run, i) => {
    const { color, marker } = methodStyle(i);
    return h(
      "label",
      { class: "method-line" },
      h("input", {
        type: "checkbox",
        id: `method-${i}`,
        checked: !hidden.has(keys[i]),
        onchange: toggle(keys[i]),
      }),
      lineSample(i),
      h("span", { style: { color }, "aria-hidden": "true" }, marker),
      h("span", {}, runTitle(scene, run)),
    );
  });
  const button = (text, hide) => h("button", { type: "button", onclick: set(hide) }, text);
  return h(
    "div",
    { class: "methods card", role: "group", "aria-label": "Methods" },
    h(
      "div",
      { class: "bar" },
      h("strong", {}, "Methods"),
      button("All", false),
      button("None", true),
    ),
    h("div", { class: "method-list" }, chips),
  );
}

// Keys of the runs that are drawn, for the address; null: all.
export function chosenKeys(scene, hidden) {
  const keys = scene.runs.map((run) => runKey(scene, run));
  const chosen = keys.filter((key) => !hidden.has(key));
  return chosen.length === keys.length ? null : chosen;
}

// The other way round.
export const hiddenKeys = (scene, chosen) =>
  new Set(
    chosen
      ? scene.runs.map((run) => runKey(scene, run)).filter((key) => !chosen.includes(key))
      : [],
  );
