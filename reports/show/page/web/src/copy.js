// Texts to the clipboard.
import { h } from "./dom.js";

const kAgain = 1500; // ms until a button has its own text again

// Where the browser refuses the clipboard: the text, selected.
function showText(text) {
  const area = h("textarea", { rows: "16", cols: "90", readonly: "", "aria-label": "Text" });
  area.value = text;
  const dialog = h(
    "dialog",
    { class: "text", "aria-label": "Copy by hand", onclose: () => dialog.remove() },
    h("p", {}, "The browser does not let this page use the clipboard; copy by hand."),
    area,
    h("form", { method: "dialog" }, h("button", { class: "primary" }, "Close (Esc)")),
  );
  document.body.append(dialog);
  dialog.showModal();
  area.select();
}

// `text`: a string, or what makes one.
export function copyButton(text, title = "Copy", attributes = {}) {
  const button = h(
    "button",
    { type: "button", class: "copy", ...attributes, onclick: copy },
    title,
  );
  async function copy() {
    const copied = typeof text === "function" ? text() : text;
    try {
      await navigator.clipboard.writeText(copied);
    } catch {
      return showText(copied);
    }
    button.textContent = "Copied";
    setTimeout(() => (button.textContent = title), kAgain);
  }
  return button;
}
