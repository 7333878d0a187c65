// Which scene a view shows.
import { report, sceneTitle } from "./data.js";
import { select } from "./dom.js";

export const sceneChoice = (current, onchange) =>
  select(
    "Scene",
    report.scenes.map((_, i) => [i, sceneTitle(i)]),
    current,
    (index) => onchange(Number(index)),
    "scene-choice",
  );
