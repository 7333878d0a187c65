// The camera: views to snap to, how it moves, its lens.
import { checkbox, h, segmented, select } from "../../../page/web/src/dom.js";
import { serverUrl } from "./connection.js";
import { kFovHigh, kFovLow } from "./camera.js";
import { viewOf } from "./look.js";
import { button, keyed, section, slider } from "./parts.js";
import { kUps } from "./state.js";

export const photoUrl = ({ split, index }) => serverUrl("/photo", { split, index });
export const viewTitle = ({ split, name }) =>
  `${split === "test" ? "Test" : "Training"} view ${name}`;

function viewChoice(app) {
  const { views } = app.hello;
  const choices = views.map((view, i) => [i, viewTitle(view)]);
  const now = app.state.view ? views.indexOf(viewOf(app.hello, app.state.view)) : "";
  const choose = (value) => app.snap(value === "" ? null : views[Number(value)]);
  return [
    button("‹", () => app.step(-1), {
      id: "previous",
      title: "previous view ([)",
      "aria-label": "Previous view",
    }),
    select("View", [["", "free"], ...choices], now, choose, "view"),
    button("›", () => app.step(1), {
      id: "next",
      title: "next view (])",
      "aria-label": "Next view",
    }),
  ];
}

function photo(app) {
  const view = app.state.view && viewOf(app.hello, app.state.view);
  if (!view?.photo) return null;
  return h(
    "button",
    {
      type: "button",
      class: "photo",
      title: "the photo on the right side of the slider (c)",
      onclick: () => app.setRight(app.state.right?.photo ? null : "photo"),
    },
    h("img", { src: photoUrl(view), alt: `Photo of ${viewTitle(view)}`, draggable: false }),
  );
}

const upChoice = (app) =>
  select(
    "Up",
    [["scene", "scene's"], ...Object.keys(kUps).map((name) => [name, name])],
    app.state.up,
    (name) => app.setUp(name),
    "up",
  );

const modeChoice = (app) =>
  segmented(
    "Motion",
    [
      ["fly", "Fly", "drag turns the camera (o)"],
      ["orbit", "Orbit", "drag turns the scene about the pivot (o)"],
    ],
    app.state.rig.mode,
    (mode) => mode !== app.state.rig.mode && app.toggleMode(),
  );

export function cameraPanel(app) {
  const views = h("div", { class: "line views" });
  const beside = h("div", {});
  const modes = h("div", { class: "line" });
  const fov = slider("Field of view", {
    ...{ id: "fov", min: kFovLow, max: kFovHigh, step: 0.5 },
    oninput: (value) => app.setFov(value),
  });
  // The speed by its logarithm.
  const speed = slider("Speed", {
    ...{ id: "speed", min: -2, max: 2, step: 0.01 },
    oninput: (value) => app.change({ speed: 10 ** value }),
  });
  const reset = button("Reset", () => app.reset(), {
    id: "reset",
    title: "back to the first view (r)",
  });
  const frusta = h("div", {});
  const update = () => {
    const { view, rig, up } = app.state;
    keyed(views, [view, app.hello.views.length], () => viewChoice(app));
    keyed(beside, view, () => photo(app));
    keyed(modes, [rig.mode, up], () => [modeChoice(app), upChoice(app), reset]);
    keyed(frusta, app.state.frusta, () =>
      checkbox("Cameras of the views", app.state.frusta, (on) => app.set({ frusta: on }), "frusta"),
    );
    fov.set(rig.fov, `${rig.fov.toFixed(1)}°`);
    speed.set(Math.log10(rig.speed), `${Number(rig.speed.toPrecision(2))} m/s`);
  };
  return { element: section("Camera", [views, beside, modes, fov, speed, frusta]), update };
}
