// Keyboard: views register their keys, the overlay lists them.
import { h } from "./dom.js";

const kGlobal = [];
let viewKeys = [];
let titles = ["This view", "Everywhere"];

// [{keys: ["j", "ArrowDown"], help: "next frame", run: (event) => ...}]; `shown`: other names for
// the list.
export const setGlobalKeys = (keys) => kGlobal.push(...keys);
export const setViewKeys = (keys) => (viewKeys = keys);
// Of the list: the view's keys, then the others.
export const setKeyTitles = (view, others) => (titles = [view, others]);

const kTyping = ["INPUT", "SELECT", "TEXTAREA"];

function isTyping(event) {
  const { tagName, type } = event.target;
  return kTyping.includes(tagName) && type !== "checkbox" && type !== "range";
}

// Space and Enter belong to a focused button, arrows to a focused slider.
function belongsToControl(event) {
  if (event.target.type === "range") return /^(Arrow|Page|Home|End)/.test(event.key);
  const onControl = event.target.closest?.("button, a, summary, input, select");
  return onControl && [" ", "Enter"].includes(event.key);
}

// Does the page have the key, and not the browser, a control or a dialog?
export function isForPage(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return false;
  if (isTyping(event) || belongsToControl(event)) return false;
  return !document.querySelector("dialog[open]");
}

export function startKeys() {
  document.addEventListener("keydown", (event) => {
    if (!isForPage(event)) return;
    const entry = [...viewKeys, ...kGlobal].find(({ keys }) => keys.includes(event.key));
    if (!entry) return;
    event.preventDefault();
    entry.run(event);
  });
}

const shownKey = (key) =>
  ({ " ": "Space", ArrowLeft: "←", ArrowRight: "→", ArrowUp: "↑", ArrowDown: "↓" })[key] ?? key;

function keyRows(title, keys) {
  if (keys.length === 0) return null;
  const rows = keys.map(({ keys: names, help, shown = names }) => [
    h(
      "dt",
      {},
      shown.map((name) => h("kbd", {}, shownKey(name))),
    ),
    h("dd", {}, help),
  ]);
  return h("section", {}, h("h3", {}, title), h("dl", { class: "keys" }, rows));
}

export function showHelp() {
  const dialog = h(
    "dialog",
    { class: "help", "aria-label": "Keyboard", onclose: () => dialog.remove() },
    h("h2", {}, "Keyboard"),
    keyRows(titles[0], viewKeys),
    keyRows(titles[1], kGlobal),
    h("form", { method: "dialog" }, h("button", { class: "primary" }, "Close (Esc)")),
  );
  document.body.append(dialog);
  dialog.showModal();
}
