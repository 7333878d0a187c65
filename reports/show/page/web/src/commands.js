// What failed and why; and the commands that repeat everything.
import { keepAddress } from "./address.js";
import { copyButton } from "./copy.js";
import { loadScene, report, runTitle, sceneKey, sceneOfAddress } from "./data.js";
import { h, replace } from "./dom.js";
import { setViewKeys } from "./keys.js";
import { sceneChoice } from "./scene_choice.js";

let sceneIndex = 0;

const commandBlock = (text) =>
  h("div", { class: "command" }, h("code", {}, text), copyButton(text));

function failureCard(failure) {
  return h(
    "section",
    { class: "card failure" },
    h("h2", {}, h("span", { "aria-hidden": "true" }, "✕ "), failure.cell),
    h(
      "p",
      {},
      h("span", { class: "chip bad" }, failure.kind || "unknown"),
      ` in ${failure.stage}`,
      failure.date && ` · ${failure.date}`,
    ),
    h("pre", { class: "message" }, failure.message),
    failure.log_tail.length > 0 &&
      h(
        "details",
        {},
        h("summary", {}, `Last ${failure.log_tail.length} lines of log.jsonl`),
        h("pre", {}, failure.log_tail.join("\n")),
      ),
    h("p", { class: "note" }, "Run it again:"),
    commandBlock(failure.command),
  );
}

export function showFailures(container) {
  setViewKeys([]);
  const cards = report.failures.map(failureCard);
  replace(container, cards.length > 0 ? cards : h("p", { class: "card" }, "No run failed."));
}

const kWhat = {
  cell: "The whole cell",
  train: "Training alone",
  render: "Rendering",
  eval: "Scoring",
};

function runCard(scene, run) {
  const rows = run.commands.map(({ what, command }) => [
    h("h3", {}, kWhat[what] ?? what),
    commandBlock(command),
  ]);
  const warnings =
    run.warnings.length > 0 &&
    h(
      "ul",
      { class: "notes" },
      run.warnings.map((text) => h("li", {}, text)),
    );
  return h(
    "details",
    { class: "card" },
    h("summary", {}, runTitle(scene, run), run.ok ? "" : " · failed"),
    warnings,
    h("p", { class: "note" }, run.folder),
    rows,
  );
}

export async function showCommands(container, from) {
  setViewKeys([]);
  const table = report.command.replace("glint-bench report", "glint-bench table");
  const whole = h(
    "section",
    { class: "card" },
    h("h2", {}, "Tables and this page"),
    commandBlock(table),
    commandBlock(report.command),
  );
  if (report.scenes.length === 0) return replace(container, whole);
  if (from) sceneIndex = sceneOfAddress(from, sceneIndex);
  const scene = await loadScene(sceneIndex);
  const open = (index) => {
    sceneIndex = index;
    keepAddress("commands", { scene: sceneKey(index) }, true);
    showCommands(container);
  };
  replace(
    container,
    whole,
    h("div", { class: "bar" }, sceneChoice(sceneIndex, open)),
    scene.runs.map((run) => runCard(scene, run)),
  );
  keepAddress("commands", { scene: sceneKey(sceneIndex) });
}
