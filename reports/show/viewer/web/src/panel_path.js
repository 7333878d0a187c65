// A camera path: keys, a smooth way through them, played, saved, filmed.
import { h } from "../../../page/web/src/dom.js";
import { copyButton } from "../../../page/web/src/copy.js";
import { frameSize } from "./look.js";
import { button, keyed, section } from "./parts.js";
import { pathCameras, pathFile } from "./path_file.js";
import { serverUrl } from "./connection.js";
import { Player } from "./player.js";

const kSecondsOfKey = 2;

function numberField(title, id, value, [min, max], onchange) {
  const input = h("input", {
    ...{
      type: "number",
      id,
      min: String(min),
      max: String(max),
      step: "any",
      value: String(value),
    },
    onchange: () => {
      const number = Number(input.value);
      onchange(Math.min(max, Math.max(min, number > 0 ? number : value)));
    },
  });
  return h("label", { class: "field" }, h("span", {}, title), input);
}

function download(file, name) {
  const url = URL.createObjectURL(new Blob([JSON.stringify(file)], { type: "application/json" }));
  h("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

// Of the app's path.
class Path {
  constructor(app) {
    Object.assign(this, { app, fps: 24, seconds: null, name: "tour" });
    this.player = new Player(app, () => this.length());
  }

  // Unless chosen, two seconds from key to key.
  length() {
    return this.seconds ?? Math.max(1, this.app.keys.length - 1) * kSecondsOfKey;
  }

  add() {
    const { pose, fov } = this.app.state.rig;
    this.change([...this.app.keys, { pose, fov }]);
  }

  remove(index) {
    this.change(this.app.keys.filter((_, i) => i !== index));
  }

  change(keys) {
    this.player.stop();
    this.app.keys = keys;
    this.app.saved = this.app.video = null;
    this.app.changed();
  }

  cameras() {
    const { hello, state, stage } = this.app;
    const size = frameSize(hello, { ...state, view: null }, stage());
    const timing = { fps: this.fps, seconds: this.length() };
    return pathCameras(this.app.keys, timing, size);
  }

  save(video) {
    this.app.saved = null;
    this.app.video = video ? { done: 0, of: 0 } : null;
    const { name, fps } = this;
    const { run } = this.app.state.left;
    this.app.connection.send({ type: "path", name, run, cameras: this.cameras(), fps, video });
    this.app.changed();
  }

  download() {
    download(pathFile(this.cameras(), this.fps), "path.json");
  }
}

function keyRow(path, i) {
  const { pose, fov } = path.app.keys[i];
  const go = () => path.app.moveRig({ ...path.app.state.rig, pose, fov });
  return h(
    "li",
    {},
    button(`Key ${i + 1}`, go, { class: "small", title: "go there" }),
    h("span", { class: "number" }, pose.position.map((n) => n.toFixed(2)).join("  ")),
    button("×", () => path.remove(i), { class: "small", "aria-label": `Remove key ${i + 1}` }),
  );
}

function settings(path) {
  const { app } = path;
  const name = h("input", {
    ...{ type: "text", id: "path-name", value: path.name, maxlength: "60" },
    onchange: () => (path.name = name.value.trim() || "tour"),
  });
  const set = (values) => {
    Object.assign(path, values);
    app.changed();
  };
  return h(
    "div",
    { class: "line" },
    numberField("Seconds", "path-seconds", path.length(), [0.1, 600], (seconds) =>
      set({ seconds }),
    ),
    numberField("fps", "path-fps", path.fps, [1, 120], (fps) => set({ fps })),
    h("label", { class: "field" }, h("span", {}, "Name"), name),
  );
}

function actions(path) {
  const isPlaying = path.player.playing;
  return h(
    "div",
    { class: "line" },
    button(isPlaying ? "Stop" : "Play", () => path.player.toggle(), {
      id: "path-play",
      title: "play (p)",
    }),
    button("Save", () => path.save(false), { id: "path-save", title: "on the server's machine" }),
    button("path.json", () => path.download(), {
      id: "path-download",
      title: "download the cameras",
    }),
    path.app.hello.video && button("Video", () => path.save(true), { id: "path-video" }),
  );
}

const command = (text) =>
  h("div", { class: "command" }, h("code", {}, text), copyButton(text, "Copy", { class: "small" }));

function videoState({ done, of, name, file, error }) {
  if (error) return h("p", { class: "bad" }, `No video: ${error}`);
  if (file) {
    const href = serverUrl("/video", { name });
    return h(
      "p",
      {},
      h("a", { href, download: `${name}.mp4`, id: "video-link" }, `Video: ${name}.mp4`),
    );
  }
  return h(
    "label",
    { class: "slider" },
    h("span", {}, "Video"),
    h("progress", { max: of || 1, value: done }),
    h("output", {}, of ? `${done} of ${of}` : "begins"),
  );
}

export function pathPanel(app) {
  const path = new Path(app);
  const list = h("ol", { class: "keys-list" });
  const tools = h("div", {});
  const answer = h("div", {});
  const add = button("Add a key", () => path.add(), { id: "path-add", title: "here (k)" });
  const update = () => {
    const { keys, saved, video } = app;
    const numbers = keys.map(({ pose, fov }) => [...pose.position, ...pose.forward, fov]);
    keyed(list, numbers, () => keys.map((_, i) => keyRow(path, i)));
    keyed(
      tools,
      [keys.length, path.player.playing, path.length(), path.fps, app.hello.video],
      () => (keys.length > 0 ? [settings(path), actions(path)] : null),
    );
    const before = answer.builtFor;
    keyed(answer, [saved, video], () => [
      saved && [h("p", { class: "note" }, `Saved: ${saved.file}`), command(saved.command)],
      video && videoState(video),
    ]);
    if (before && before !== answer.builtFor) answer.scrollIntoView({ block: "nearest" });
  };
  const element = section("Camera path", [add, list, tools, answer], { open: false, id: "path" });
  return { element, update, path };
}
