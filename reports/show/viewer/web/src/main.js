// The page of `glint-bench view`: greets the server, opens the start page or the picture.
import { dropAddress, readAddress } from "../../../page/web/src/address.js";
import { h, replace } from "../../../page/web/src/dom.js";
import { setGlobalKeys, setKeyTitles, showHelp, startKeys } from "../../../page/web/src/keys.js";
import { App } from "./app.js";
import { Connection } from "./connection.js";
import { Frames } from "./frames.js";
import { Notices } from "./notices.js";
import { kVersion } from "./protocol.js";
import { showStart } from "./start.js";
import { stateOfAddress } from "./state.js";
import { Viewer } from "./viewer.js";

const kThemeKey = "glint-viewer-theme";

const content = h("div", { class: "content" });
const notices = new Notices(() => connection.open());
let hello = null;
let viewer = null;
let isGreeted = false; // by this connection

const connection = new Connection({
  onMessage: receive,
  onFrame: (buffer) => frames.receive(buffer),
  onStatus: (status, wait) => {
    if (status === "open") isGreeted = false;
    notices.connection(status, wait);
  },
});
connection.serial = 0; // of the last look, over all connections

const frames = new Frames({
  onFrame: (header, bitmaps) => {
    if (viewer) viewer.show(header, bitmaps);
    else bitmaps.forEach((bitmap) => bitmap.close());
  },
  answer: (serial) => connection.send({ type: "shown", serial }),
  onError: (text) => notices.say(text),
});

// Of the picture's part of the window, device pixels.
function stageSize() {
  const area = viewer?.stageArea ?? document.documentElement;
  const scale = window.devicePixelRatio || 1;
  return [area.clientWidth * scale, area.clientHeight * scale];
}

function close() {
  viewer?.stop();
  viewer = null;
  dropAddress();
}

function openViewer(state) {
  close();
  const app = new App(hello, state, connection, stageSize);
  viewer = new Viewer(content, app, {
    rate: () => frames.rate(),
    toRuns: hello.runs.length > 1 ? openStart : null,
    toggleTheme,
  });
}

function openStart() {
  close();
  showStart(content, hello, (left, right) => {
    const state = stateOfAddress(hello, null);
    const [{ id: first }] = hello.runs[left].layers;
    state.left = { run: left, layer: first };
    state.right = right === null ? null : { run: right, layer: hello.runs[right].layers[0].id };
    openViewer(state);
  });
}

function openByAddress() {
  const { params } = readAddress();
  if (hello.runs.length > 1 && !params) openStart();
  else openViewer(stateOfAddress(hello, params));
}

const namesOf = ({ runs }) => JSON.stringify(runs.map(({ name }) => name));

function greet(message) {
  if (message.version !== kVersion) {
    notices.say(
      `The server speaks version ${message.version}, this page ${kVersion}; load it again.`,
    );
    return;
  }
  const isSame = hello && namesOf(hello) === namesOf(message);
  hello = message;
  document.title = `${hello.title} · GLINT Bench`;
  if (isSame && viewer) viewer.app.greet(hello, !isGreeted);
  else if (!isSame) openByAddress();
  isGreeted = true;
}

function receive(message) {
  if (message.type === "hello") greet(message);
  else viewer?.app.receive(message);
  if (message.type === "error") notices.say(message.message);
}

function savedTheme() {
  try {
    return localStorage.getItem(kThemeKey);
  } catch {
    return null; // some browsers keep nothing
  }
}

function toggleTheme() {
  const { dataset } = document.documentElement;
  dataset.theme = dataset.theme === "dark" ? "light" : "dark";
  try {
    localStorage.setItem(kThemeKey, dataset.theme);
  } catch {
    // Lasts for this page only.
  }
}

document.documentElement.dataset.theme = savedTheme() ?? "dark";
setKeyTitles("Camera and layers", "Everywhere");
setGlobalKeys([{ keys: ["?"], help: "this list", run: showHelp }]);
replace(document.querySelector("#app"), content, notices.element);
replace(content, h("p", { class: "waiting" }, "Connecting"));
window.addEventListener("hashchange", () => hello && openByAddress());
startKeys();
connection.open();
