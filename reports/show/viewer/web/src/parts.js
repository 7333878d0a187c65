// Pieces of the panel.
import { h, replace } from "../../../page/web/src/dom.js";

export const kNarrow = "(max-width: 50rem)"; // as in narrow.css

// A part of the panel that folds.
export function section(title, children, { open = true, id } = {}) {
  return h("details", { class: "section", open, id }, h("summary", {}, title), children);
}

// Of what is the same in another build of a list; null: nothing is.
function selectorOf({ id, dataset }) {
  if (id) return `#${CSS.escape(id)}`;
  return dataset.value === undefined ? null : `[data-value="${CSS.escape(dataset.value)}"]`;
}

// Builds the contents of `container` anew when `key` is another; what had the focus keeps it.
export function keyed(container, key, build) {
  const text = JSON.stringify(key);
  if (container.builtFor === text) return;
  container.builtFor = text;
  const focused = container.contains(document.activeElement) ? document.activeElement : null;
  const selector = focused && selectorOf(focused);
  replace(container, build());
  if (selector) container.querySelector(selector)?.focus();
}

// A labelled range with its value beside it. oninput(number); double click: `first` again.
// The element's set(value, text) shows another value.
export function slider(label, { min, max, step, first, oninput, id }) {
  const input = h("input", {
    ...{ type: "range", id, min: String(min), max: String(max), step: String(step) },
    title: first === undefined ? null : "double click: as at first",
    oninput: () => oninput(Number(input.value)),
    ondblclick: () => first !== undefined && oninput(first),
  });
  const text = h("output", {});
  const element = h("label", { class: "slider" }, h("span", {}, label), input, text);
  element.set = (value, shown) => {
    input.value = String(value);
    text.textContent = shown;
    input.setAttribute("aria-valuetext", shown);
  };
  return element;
}

export const button = (title, onclick, attributes = {}) =>
  h("button", { type: "button", onclick, ...attributes }, title);

export const thousands = (number) => Math.round(number).toLocaleString("en-GB");
