// A training that is watched while it goes on.
import { h } from "../../../page/web/src/dom.js";
import { button, keyed, section, thousands } from "./parts.js";

function clock(seconds) {
  const [minutes, rest] = [Math.floor(seconds / 60), Math.floor(seconds % 60)];
  return `${minutes}:${String(rest).padStart(2, "0")} min`;
}

export function trainingPanel(app) {
  // The server says nothing while it rests, so what was asked for counts as done.
  const pause = button("Pause", () => {
    const paused = !app.training?.paused;
    if (!app.connection.send({ type: "pause", paused })) return;
    app.training = { ...app.training, paused };
    app.changed();
  });
  pause.id = "pause";
  const progress = h("progress", { "aria-label": "Progress of the training" });
  const text = h("p", { class: "number" });
  const element = section("Training", [progress, h("div", { class: "line" }, pause, text)], {
    id: "training",
  });
  const update = () => {
    element.hidden = !app.hello.training;
    if (element.hidden) return;
    const { iteration = 0, seconds, paused = false } = app.training ?? {};
    const { iterations } = app.hello.training;
    Object.assign(progress, { max: iterations, value: iteration });
    const parts = [
      `${thousands(iteration)} / ${thousands(iterations)}`,
      seconds > 0 && clock(seconds),
    ];
    keyed(text, parts, () => parts.filter(Boolean).join(" · "));
    pause.textContent = paused ? "Go on" : "Pause";
  };
  return { element, update };
}
