// Elements without markup strings: texts of records never become HTML.

function append(parent, child) {
  if (child === null || child === undefined || child === false) return;
  if (Array.isArray(child)) child.forEach((item) => append(parent, item));
  else parent.append(child);
}

function setAttribute(element, name, value) {
  if (value === null || value === undefined || value === false) return;
  if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
  else if (name === "style" && typeof value === "object") Object.assign(element.style, value);
  else if (name in element && typeof value !== "string") element[name] = value;
  else element.setAttribute(name, value);
}

// h("button", {class: "key", onclick: f}, "text", node, [more])
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) setAttribute(element, name, value);
  append(element, children);
  return element;
}

export function svg(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  append(element, children);
  return element;
}

export function replace(parent, ...children) {
  parent.replaceChildren();
  append(parent, children);
}

// A labelled select; `choices`: [value, text] pairs.
export function select(label, choices, value, onchange, id) {
  const options = choices.map(([key, text]) =>
    h("option", { value: String(key), selected: String(key) === String(value) }, text),
  );
  return h(
    "label",
    { class: "field" },
    h("span", {}, label),
    h("select", { id, onchange: (event) => onchange(event.target.value) }, options),
  );
}

// One of several, as buttons.
export function segmented(label, choices, value, onchange) {
  return h(
    "div",
    { class: "segmented", role: "group", "aria-label": label },
    choices.map(([key, text, hint]) =>
      h(
        "button",
        {
          type: "button",
          "data-value": key,
          title: hint,
          "aria-pressed": String(key === value),
          onclick: () => onchange(key),
        },
        text,
      ),
    ),
  );
}

export function checkbox(label, checked, onchange, id) {
  return h(
    "label",
    { class: "check" },
    h("input", {
      type: "checkbox",
      id,
      checked,
      onchange: (event) => onchange(event.target.checked),
    }),
    h("span", {}, label),
  );
}
