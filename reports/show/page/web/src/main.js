// The page: header, views by the address's fragment ("#scene?map=depth"), theme, keys.
import { dropAddress, readAddress, writeAddress } from "./address.js";
import { showCommands, showFailures } from "./commands.js";
import { copyButton } from "./copy.js";
import { showCurves } from "./curves.js";
import { report } from "./data.js";
import { h, replace } from "./dom.js";
import { setGlobalKeys, showHelp, startKeys } from "./keys.js";
import { showMeshes } from "./meshes.js";
import { showRecords } from "./records.js";
import { showScene } from "./scene.js";
import { showSummary } from "./summary.js";

const kViews = [
  ["summary", "Summary", showSummary],
  ["scene", "Scenes", showScene],
  ["curves", "Curves", showCurves],
  ["meshes", "Meshes", showMeshes],
  ["records", "Records", showRecords],
  ["failures", "Failures", showFailures],
  ["commands", "Commands", showCommands],
];

const main = h("main", { id: "main", tabindex: "-1" });
let stopView = null;
let opening = 0;

async function openView() {
  dropAddress();
  const address = readAddress();
  const [id, , show] = kViews.find(([key]) => key === address.view) ?? kViews[0];
  const mine = ++opening;
  stopView?.();
  stopView = null;
  document.querySelectorAll("nav a").forEach((link) => {
    link.removeAttribute("aria-current");
    if (link.hash === `#${id}`) link.setAttribute("aria-current", "page");
  });
  main.dataset.view = id;
  try {
    const stop = await show(main, address);
    if (mine === opening) stopView = stop ?? null;
    else stop?.();
  } catch (error) {
    replace(main, h("p", { class: "card warning" }, error.message));
  }
}

function savedTheme() {
  try {
    return localStorage.getItem("glint-theme");
  } catch {
    return null; // some browsers keep nothing for file://
  }
}

function setTheme(theme) {
  document.documentElement.dataset.theme = theme;
  try {
    localStorage.setItem("glint-theme", theme);
  } catch {
    // Lasts for this page only.
  }
}

function startTheme() {
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  document.documentElement.dataset.theme = savedTheme() ?? (system.matches ? "dark" : "light");
  system.addEventListener("change", () => {
    if (savedTheme()) return;
    document.documentElement.dataset.theme = system.matches ? "dark" : "light";
    openView();
  });
}

function switchTheme() {
  setTheme(document.documentElement.dataset.theme === "dark" ? "light" : "dark");
  openView(); // charts have their colours drawn in
}

function header() {
  const links = kViews.map(([id, title]) => {
    const count =
      id === "failures" && report.failures.length > 0 ? ` (${report.failures.length})` : "";
    return h("a", { href: `#${id}` }, title + count);
  });
  return h(
    "header",
    { class: "top" },
    h(
      "a",
      { class: "skip", href: "#main", onclick: (event) => (event.preventDefault(), main.focus()) },
      "To the content",
    ),
    h(
      "div",
      { class: "brand" },
      h("strong", {}, "GLINT Bench"),
      h("span", { class: "chip" }, report.profile),
      h("span", { class: "version" }, report.version),
    ),
    h("nav", { "aria-label": "Views" }, links),
    h(
      "div",
      { class: "tools" },
      copyButton(() => (writeAddress(), location.href), "Copy link", {
        title: "opens exactly what is shown now",
        id: "link",
      }),
      h(
        "button",
        { type: "button", id: "theme", title: "light or dark (d)", onclick: switchTheme },
        "◐ Theme",
      ),
      h(
        "button",
        { type: "button", id: "help", title: "keyboard (?)", onclick: showHelp },
        "? Keys",
      ),
    ),
  );
}

startTheme();
setGlobalKeys([
  { keys: ["?"], help: "this list", run: showHelp },
  { keys: ["d"], help: "light or dark", run: switchTheme },
  ...kViews.map(([id, title], i) => ({
    keys: [String(i + 1)],
    help: title,
    run: () => (location.hash = `#${id}`),
  })),
]);
replace(document.querySelector("#app"), header(), main);
window.addEventListener("hashchange", openView);
startKeys();
openView();
