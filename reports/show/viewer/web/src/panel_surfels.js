// What surfels look like: parts scaled, a cut, discs and points; how many there are.
import { checkbox, h, segmented } from "../../../page/web/src/dom.js";
import { cutText, kCutAxes } from "./cut.js";
import { button, keyed, section, slider, thousands } from "./parts.js";
import { kScaleTitles, setsOf } from "./state.js";

export const kStyleTitles = { image: "Image", discs: "Discs", points: "Points" };
const kMostScale = 4;

const union = (lists) => [...new Set(lists.flat())];

function styleChoice(app, styles) {
  const choices = styles.map((style) => [style, kStyleTitles[style] ?? style]);
  return segmented("Surfels as", choices, app.state.style, (style) => app.set({ style }));
}

// Which sets are drawn as discs or points: what stands before them can be taken away.
function setChoice(app, names) {
  const { hidden } = app.state;
  const show = (name, on) =>
    app.set({ hidden: on ? hidden.filter((one) => one !== name) : [...hidden, name] });
  return names.map((name) =>
    checkbox(name, !hidden.includes(name), (on) => show(name, on), `set-${name}`),
  );
}

function scaleSliders(app, names) {
  return names.map((name) => {
    const element = slider(kScaleTitles[name] ?? name, {
      ...{ id: `scale-${name}`, min: 0, max: kMostScale, step: 0.05, first: 1 },
      oninput: (value) => app.set({ scales: { ...app.state.scales, [name]: value } }),
    });
    element.update = () =>
      element.set(app.state.scales[name], `× ${app.state.scales[name].toFixed(2)}`);
    return element;
  });
}

const setCut = (app, values) => app.set({ cut: { ...app.state.cut, ...values } });

function cutChoice(app) {
  const { axis, flipped } = app.state.cut;
  const choices = [
    ["", "Off"],
    ...kCutAxes.map((name) => [
      name,
      name === "view" ? "View" : name,
      name === "view" ? "along the view as it is now" : null,
    ]),
  ];
  const choose = (name) =>
    setCut(app, { axis: name || null, direction: app.state.rig.pose.forward });
  return [
    h("span", { class: "quiet" }, "Cut"),
    segmented("Cut plane", choices, axis ?? "", choose),
    axis && checkbox("flip", flipped, (on) => setCut(app, { flipped: on }), "cut-flip"),
  ];
}

function counts(app) {
  return h(
    "table",
    { class: "counts" },
    h(
      "tbody",
      {},
      app
        .shownRuns()
        .map((run) => [
          h(
            "tr",
            {},
            h("th", {}, app.runTitle(app.hello.runs.indexOf(run))),
            h("td", {}, thousands(run.total)),
          ),
          Object.entries(run.surfels).length > 1 &&
            Object.entries(run.surfels).map(([name, count]) =>
              h("tr", { class: "part" }, h("th", {}, name), h("td", {}, thousands(count))),
            ),
        ]),
    ),
  );
}

export function surfelsPanel(app) {
  const styles = h("div", { class: "line" });
  const sets = h("div", { class: "line" });
  const scales = h("div", {});
  const cut = h("div", { class: "line" });
  const offset = slider("Offset", {
    ...{ id: "cut-share", min: 0, max: 1, step: 0.005 },
    oninput: (share) => setCut(app, { share }),
  });
  const numbers = h("div", {});
  const again = button(
    "Scales to 1",
    () =>
      app.set({ scales: Object.fromEntries(Object.keys(kScaleTitles).map((name) => [name, 1])) }),
    { class: "small", id: "scales-reset" },
  );
  let sliders = [];
  const update = () => {
    const runs = app.shownRuns();
    const { cut: plane, style, hidden, scales: factors } = app.state;
    const names = union(runs.map((run) => run.scales));
    const kinds = union(runs.map((run) => run.styles));
    keyed(styles, [kinds, style], () => kinds.length > 1 && styleChoice(app, kinds));
    const drawn = style === "image" ? [] : setsOf(runs);
    keyed(sets, [drawn, hidden], () => drawn.length > 1 && setChoice(app, drawn));
    keyed(scales, names, () => [(sliders = scaleSliders(app, names)), names.length > 0 && again]);
    sliders.forEach((element) => element.update());
    again.hidden = names.every((name) => factors[name] === 1);
    keyed(cut, [plane.axis, plane.flipped, runs.some((run) => run.cut)], () =>
      runs.some((run) => run.cut) ? cutChoice(app) : null,
    );
    offset.hidden = !plane.axis;
    if (plane.axis) offset.set(plane.share, cutText(plane, app.hello.scene));
    keyed(
      numbers,
      runs.map(({ name, total }) => [name, total]),
      () => counts(app),
    );
  };
  return { element: section("Surfels", [styles, sets, scales, cut, offset, numbers]), update };
}
