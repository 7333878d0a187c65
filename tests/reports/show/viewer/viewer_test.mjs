// The viewer's page and its server in headless Chromium. Arguments: glint-bench, a folder of a
// store with runs of 2dgs and glint on one scene, folder for screenshots, folder of a scene to
// train on (without: no training is watched).
import assert from "node:assert/strict";
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { launchBrowser } from "../page/chromium.mjs";
import { readExr } from "./exr.mjs";
import { boxOf, breathe, drag, hold, openPage, shotsInto, textOf, until } from "./viewer_page.mjs";
import { socketStatus, startServer } from "./viewer_server.mjs";

const [bench, store, shots, dataset] = process.argv.slice(2);
const shot = shotsInto(shots);
const [scene] = readdirSync(`${store}/runs`);
const runOf = (method) => `${store}/runs/${scene}/${method}/0`;
const kChannels = { rgb: ["R", "G", "B"], normal: ["X", "Y", "Z"] };
const kPixels = [
  [0.1, 0.2],
  [0.5, 0.5],
  [0.77, 0.31],
  [0.4, 0.9],
  [0.93, 0.66],
];

// Texts that went over the page's WebSocket, and headers of frames.
function listen(page) {
  const heard = { looks: [], texts: [], frames: [] };
  page.on("websocket", (socket) => {
    socket.on("framesent", ({ payload }) => {
      const message = JSON.parse(payload);
      if (message.type === "look") heard.looks.push(message);
    });
    socket.on("framereceived", ({ payload }) => {
      if (typeof payload === "string") heard.texts.push(JSON.parse(payload));
      else heard.frames.push(headerOf(payload));
    });
  });
  return heard;
}

const headerOf = (payload) =>
  JSON.parse(payload.toString("utf8", 4, 4 + Buffer.from(payload).readUInt32LE(0)));

// A whole frame of the last look is shown.
async function rests(page, heard) {
  await breathe(page);
  await until(() => {
    const [look, frame] = [heard.looks.at(-1), heard.frames.at(-1)];
    return look && frame?.whole && frame.serial === look.serial;
  }, "a whole frame");
  await until(async () => !/moving|Waiting/.test(await textOf(page, ".status")), "it is shown");
  await breathe(page);
}

// So many colours does the picture have.
const colors = (page) =>
  page.locator(".frame-canvas").evaluate((canvas) => {
    const { width, height } = canvas;
    const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
    return new Set(new Uint32Array(data.buffer)).size;
  });

const placeOf = ({ camera }) => camera.world_from_cam.slice(0, 3).map((row) => row[3]);

async function testMotion(page, heard) {
  await rests(page, heard);
  assert.ok((await colors(page)) > 50, "a picture");
  await shot(page, "open");
  const before = heard.looks.at(-1);
  const frames = heard.frames.length;
  await hold(page, "w", () => heard.frames.length > frames + 1, "frames while it moves");
  await rests(page, heard);
  assert.notDeepEqual(placeOf(heard.looks.at(-1)), placeOf(before), "it moved");
  await drag(page, [0.5, 0.5], [0.6, 0.5]);
  await rests(page, heard);
  const serials = heard.frames.map(({ serial }) => serial);
  assert.ok(
    serials.every((serial, i) => i === 0 || serial >= serials[i - 1]),
    "in order",
  );
  const box = await boxOf(page);
  await page.keyboard.press("f");
  await page.mouse.dblclick(box.x + 0.5 * box.width, box.y + 0.6 * box.height);
  await until(() => heard.texts.find(({ type }) => type === "pick")?.point, "a point is picked");
  await page.keyboard.press("f");
  await page.mouse.move(2, 2);
}

async function testLayers(page, heard) {
  await page
    .selectOption("#view", { label: "Test view 0000" })
    .catch(() => page.keyboard.press("]"));
  await rests(page, heard);
  const { layers } = heard.texts.find(({ type }) => type === "hello").runs[0];
  assert.ok(layers.length >= 10, `glint has ${layers.length} layers`);
  await page.keyboard.press("f");
  for (const { id } of layers) {
    await page.click(`.layer[data-value="${id}"]`);
    await until(() => heard.looks.at(-1).panes[0].layer === id, id);
    await rests(page, heard);
    assert.ok((await colors(page)) > 1, `${id} has a picture`);
    await shot(page, `layer_${id}`);
  }
  await page.click('.layer[data-value="rgb"]');
  await rests(page, heard);
}

function pixelOf(maps, id, x, y) {
  const { width, channels } = maps[id];
  const values = (kChannels[id] ?? ["Z"]).map((name) => channels[name][y * width + x]);
  return values.length === 1 ? values[0] : values;
}

// Values under the pointer are those of the files of `render`.
async function testProbe(page, heard) {
  const hello = heard.texts.find(({ type }) => type === "hello");
  const { name } = hello.views.find(({ split, index }) => split === "test" && index === 0);
  const folder = `${runOf("glint")}/renders/${name}`;
  const ids = ["rgb", "depth", "normal", "transparency", "behind_depth"];
  const maps = Object.fromEntries(
    ids
      .map((id) => [id, `${folder}/${id}.exr`])
      .filter(([, file]) => existsSync(file))
      .map(([id, file]) => [id, readExr(file)]),
  );
  assert.ok(Object.keys(maps).length >= 3, `${folder} has maps`);
  const box = await boxOf(page);
  let compared = 0;
  for (const [u, v] of kPixels) {
    const count = heard.texts.length;
    await page.mouse.move(box.x + u * box.width, box.y + v * box.height);
    const probe = await until(
      () => heard.texts.slice(count).find(({ type }) => type === "probe"),
      "values of a pixel",
    );
    assert.equal(probe.size[0], maps.depth.width);
    for (const id of Object.keys(maps)) {
      const [found] = probe.panes;
      const expected = [pixelOf(maps, id, probe.x, probe.y)].flat();
      [found.values[id]].flat().forEach((value, i) => {
        const most = 1e-6 * Math.max(1, Math.abs(expected[i]));
        const at = `${id} at ${probe.x}, ${probe.y}: ${value} for ${expected[i]}`;
        assert.ok(Math.abs(value - expected[i]) <= most, at);
      });
      compared += 1;
    }
    assert.ok(probe.truth.rgb.length === 3, "the truth, too");
  }
  await page.waitForSelector(".layer .value:not(:empty)");
  await shot(page, "probe");
  await page.mouse.move(2, 2);
  console.log(`ok: ${compared} values of pixels equal those of render`);
}

const setRange = (page, id, value) => page.locator(id).fill(String(value));

async function testSurfels(page, heard) {
  for (const style of ["discs", "points"]) {
    await page.click(`[data-value="${style}"]`);
    await rests(page, heard);
    assert.ok((await colors(page)) > 10, style);
    await shot(page, `style_${style}`);
  }
  const whole = await colorSum(page);
  await page.uncheck("#set-interface");
  await rests(page, heard);
  assert.notEqual(await colorSum(page), whole, "without a set");
  await shot(page, "style_points_behind");
  await page.check("#set-interface");
  await page.click('[aria-label="Surfels as"] [data-value="image"]');
  await rests(page, heard);
  const plain = await colorSum(page);
  await setRange(page, "#scale-reflection", 4);
  await rests(page, heard);
  assert.notEqual(await colorSum(page), plain, "more reflection is another picture");
  await shot(page, "more_reflection");
  await page.click("#scales-reset");
  await page.click('[aria-label="Cut plane"] [data-value="z"]');
  await rests(page, heard);
  assert.notEqual(await colorSum(page), plain, "a cut is another picture");
  await shot(page, "cut");
  await page.click('[aria-label="Cut plane"] [data-value=""]');
  await rests(page, heard);
  assert.equal(await colorSum(page), plain, "and comes back");
}

const colorSum = (page) =>
  page.locator(".frame-canvas").evaluate((canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return data.reduce((sum, value) => sum + value, 0);
  });

async function testPath(page, heard) {
  await page.click("#path > summary");
  for (const key of ["k", "]", "k", "]", "k"]) await page.keyboard.press(key);
  await page.fill("#path-name", "by hand");
  await page.locator("#path-name").blur();
  await page.click("#path-save");
  const saved = await until(() => heard.texts.find(({ type }) => type === "path"), "it is saved");
  const file = JSON.parse(readFileSync(saved.file, "utf8"));
  assert.deepEqual([file.schema, file.frames.length, file.fps], [1, 96, 24]);
  assert.match(saved.command, /^glint-bench render --run /);
  await page.waitForSelector(".command code");
  await shot(page, "path");
}

async function testReload(page, heard) {
  await page.click('.layer[data-value="depth"]');
  await rests(page, heard);
  const before = heard.looks.at(-1);
  await until(() => page.url().includes("layer=depth"), "the address");
  await page.reload();
  await until(() => heard.looks.at(-1).serial < before.serial, "again");
  await rests(page, heard);
  assert.deepEqual(heard.looks.at(-1).panes, before.panes);
  assert.deepEqual(heard.looks.at(-1).view, before.view);
}

async function testTwoRuns(page, heard) {
  await page.waitForSelector("#open");
  await shot(page, "start");
  await page.click("#open");
  await rests(page, heard);
  assert.equal(heard.looks.at(-1).panes.length, 2);
  assert.equal(heard.frames.at(-1).images.length, 2);
  await page.keyboard.press("]");
  await rests(page, heard);
  await shot(page, "two_runs");
  await page.click('.layer[data-value="depth"]');
  await page.keyboard.press("x");
  await page.click('.layer[data-value="depth"]');
  await page.locator(".grip").focus();
  for (let i = 0; i < 8; ++i) await page.keyboard.press("ArrowLeft");
  await rests(page, heard);
  await shot(page, "two_runs_depth");
}

async function testRefusals(address) {
  const { origin, searchParams } = new URL(address);
  const token = searchParams.get("token");
  const status = async (path) => (await fetch(origin + path)).status;
  const wrong = token.replace(/^./, (digit) => (digit === "0" ? "1" : "0"));
  for (const path of ["/", `/?token=${wrong}`, `/photo?split=test&index=0&token=${wrong}`])
    assert.equal(await status(path), 403, path);
  assert.equal(await status(`/?token=${token}`), 200);
  assert.equal(await status(`/nothing?token=${token}`), 404);
  assert.equal(await socketStatus(address, `/ws?token=${wrong}`), 403, "a wrong token");
  assert.equal(await socketStatus(address, `/ws?token=${token}`), 101);
  const foreign = { Origin: "http://elsewhere.example" };
  assert.equal(await socketStatus(address, `/ws?token=${token}`, foreign), 403, "another page");
  const named = { Host: "elsewhere.example" };
  assert.equal(await socketStatus(address, `/ws?token=${token}`, named), 403, "DNS rebinding");
}

const kSteps = 3000;

// Frames come while it trains; a pause holds it, and looking goes on.
async function testTraining(page, heard) {
  const iteration = () => heard.frames.at(-1)?.iteration ?? 0;
  await until(() => iteration() > 0, "a frame of the training");
  const first = iteration();
  await until(() => iteration() > first, "a newer one by itself");
  await page.click("#pause");
  const told = () => heard.texts.filter(({ type }) => type === "state").at(-1);
  const { iteration: held } = await until(() => told()?.paused && told(), "it is held");
  await page.keyboard.press("]");
  await rests(page, heard);
  assert.equal(iteration(), held, "the model rests");
  assert.match(await textOf(page, "#training"), new RegExp(`/ ${kSteps / 1000},000`));
  await shot(page, "training");
  await page.click("#pause");
  await until(() => told().iteration > held, "it goes on");
}

// Nobody who looks keeps a training from its end.
async function watchTraining(browser) {
  const folder = mkdtempSync(`${tmpdir()}/glint-watched-`);
  const options = ["--method", "2dgs", "--iterations", String(kSteps), "--run", `${folder}/run`];
  const verb = ["train", "--view", "--dataset", dataset, ...options];
  try {
    const server = await run(browser, "a training", verb, testTraining, false);
    assert.equal(await server.ended, 0, "it ends well");
    assert.ok(existsSync(`${folder}/run/interface.ply`), "with its surfels");
  } finally {
    rmSync(folder, { recursive: true });
  }
}

async function run(browser, name, verb, body, stops = true) {
  const server = await startServer(bench, verb);
  const opened = await openPage(browser);
  const heard = listen(opened.page);
  try {
    await opened.page.goto(server.address);
    await body(opened.page, heard, server.address);
    assert.deepEqual(opened.problems, [], `${name}: console and network stay quiet`);
    await opened.close();
  } finally {
    if (stops) await server.stop();
  }
  console.log(`ok: ${name}`);
  return server;
}

const browser = await launchBrowser({ webgl: false });
try {
  await run(browser, "one run", ["view", runOf("glint")], async (page, heard, address) => {
    await testRefusals(address);
    await testMotion(page, heard);
    await testLayers(page, heard);
    await testProbe(page, heard);
    await testSurfels(page, heard);
    await testPath(page, heard);
    await testReload(page, heard);
  });
  await run(browser, "two runs", ["view", runOf("glint"), runOf("2dgs")], testTwoRuns);
  if (dataset) await watchTraining(browser);
} finally {
  await browser.close();
}
