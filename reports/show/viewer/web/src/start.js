// The first page where several runs are given: which one on which side.
import { h, replace } from "../../../page/web/src/dom.js";
import { button, thousands } from "./parts.js";

const sceneOf = (hello, run) => run.scene ?? hello.scene.name;

function card(hello, side, choice, index, choose) {
  const run = hello.runs[index];
  const scene = sceneOf(hello, run);
  const other = side === "right" ? sceneOf(hello, hello.runs[choice.left]) : scene;
  const differs = scene !== other;
  return h(
    "label",
    { class: "run-card" },
    h("input", {
      ...{ type: "radio", name: side, value: String(index), disabled: differs },
      checked: choice[side] === index,
      onchange: () => choose(side, index),
    }),
    h("strong", {}, run.title),
    h("span", { class: "quiet" }, `${run.name} · ${scene} · ${thousands(run.total)} surfels`),
    h("span", { class: "path quiet" }, run.folder),
    differs && h("span", { class: "bad" }, "another scene: not comparable"),
  );
}

function nothingCard(choice, choose) {
  return h(
    "label",
    { class: "run-card" },
    h("input", {
      ...{ type: "radio", name: "right", value: "", checked: choice.right === null },
      onchange: () => choose("right", null),
    }),
    h("strong", {}, "Nothing"),
    h("span", { class: "quiet" }, "the left run alone"),
  );
}

const column = (title, cards) => h("fieldset", { class: "column" }, h("legend", {}, title), cards);

// open(left, right): indices of runs; right is null where there is one side.
export function showStart(container, hello, open) {
  const choice = { left: 0, right: null };
  const isComparable = (right) =>
    right !== null && sceneOf(hello, hello.runs[right]) === sceneOf(hello, hello.runs[choice.left]);
  const second = hello.runs.findIndex((_, i) => i > 0 && isComparable(i));
  if (second > 0) choice.right = second;
  const columns = h("div", { class: "columns" });
  const choose = (side, index) => {
    choice[side] = index;
    if (!isComparable(choice.right)) choice.right = null;
    show();
    const value = index === null ? "" : String(index);
    columns.querySelector(`input[name="${side}"][value="${value}"]`)?.focus();
  };
  const show = () => {
    const cards = (side) => hello.runs.map((_, i) => card(hello, side, choice, i, choose));
    replace(
      columns,
      column("Left", cards("left")),
      column("Right", [nothingCard(choice, choose), cards("right")]),
    );
  };
  show();
  replace(
    container,
    h(
      "main",
      { class: "start" },
      h("h1", {}, hello.title),
      h("p", { class: "quiet" }, "One run alone, or two of one scene with a slider between them."),
      columns,
      button("Open", () => open(choice.left, choice.right), { class: "primary", id: "open" }),
    ),
  );
}
