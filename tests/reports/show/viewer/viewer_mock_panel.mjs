// The panel of the viewer against a mock server: two runs, surfels, paths, the training, keys.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { kHello } from "./viewer_hello.mjs";
import { colorAt, near, textOf, until } from "./viewer_page.mjs";

const kOne = { ...kHello, runs: [kHello.runs[0]] };
const kOther = { ...kHello.runs[1], name: "2dgs elsewhere", scene: "room_2" };
const kThree = { ...kHello, runs: [...kHello.runs, kOther] };

async function testTwoRuns(page, server, { shot, wholeShown }) {
  await page.goto(server.url());
  await page.waitForSelector("#open");
  assert.equal(await page.locator(".column").count(), 2);
  assert.match(await textOf(page, ".run-card:has(:disabled)"), /not comparable/);
  await shot(page, "mock_start");
  await page.click("#open");
  await wholeShown(page, server);
  assert.deepEqual(server.last("look").panes, [
    { run: 0, layer: "rgb" },
    { run: 1, layer: "rgb" },
  ]);
  await page.keyboard.press("x");
  await page.waitForSelector('[data-value="right"][aria-pressed="true"]');
  await page.keyboard.press("3");
  await until(() => server.last("look").panes[1].layer === "depth", "the right side's layer");
  assert.equal(server.last("look").panes[0].layer, "rgb", "the left side keeps its own");
  await wholeShown(page, server);
  assert.ok(near(await colorAt(page, 0.75, 0.1), "#2a788e"), "depth at the right");
  const grip = await page.locator(".grip").boundingBox();
  const box = await page.locator(".picture").boundingBox();
  await page.mouse.move(grip.x + grip.width / 2, box.y + 30);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.9 * box.width, box.y + 40, { steps: 4 });
  await page.mouse.up();
  await until(async () => near(await colorAt(page, 0.75, 0.1), "#7a8896"), "the slider moves");
  await page.keyboard.press("ArrowLeft");
  await until(() => page.url().includes("split=88"), "and by keyboard");
  await page.locator(".grip").focus();
  await shot(page, "mock_two_runs");
  await page.reload();
  await wholeShown(page, server);
  assert.equal(server.last("look").panes.length, 2, "a reload comes back to both");
  await page.click("#runs");
  await page.waitForSelector("#open");
}

const setRange = (page, id, value) => page.locator(id).fill(String(value));

async function testSurfels(page, server, { shot, wholeShown }) {
  await page.goto(server.url());
  await wholeShown(page, server);
  await setRange(page, "#scale-reflection", 2.5);
  await until(() => server.last("look").scales.reflection === 2.5, "a scale");
  await page.dblclick("#scale-reflection");
  await until(() => server.last("look").scales.reflection === 1, "a double click resets it");
  await setRange(page, "#scale-transparency", 0.5);
  await page.click('[aria-label="Cut plane"] [data-value="z"]');
  await until(() => server.last("look").cut?.normal.join() === "0,0,1", "a cut");
  await setRange(page, "#cut-share", 0.5);
  await until(() => Math.abs(server.last("look").cut.offset - 1.3) < 1e-9, "where it stands");
  await page.check("#cut-flip");
  await until(() => server.last("look").cut.normal[2] === -1, "the other side");
  await page.click('[data-value="discs"]');
  await until(() => server.last("look").style === "discs", "discs");
  await page.uncheck("#set-interface");
  await until(() => server.last("look").hidden.join() === "interface", "a set taken away");
  await until(() => page.url().includes("hidden=interface"), "the address");
  await page.reload();
  await wholeShown(page, server);
  assert.equal(server.last("look").hidden.join(), "interface", "the address keeps it");
  await page.check("#set-interface");
  await until(() => server.last("look").hidden.length === 0, "and back");
  assert.match(await textOf(page, ".counts"), /GLINT\s+90,930\s+interface\s+61,234/);
  await page.locator(".counts").scrollIntoViewIfNeeded();
  await shot(page, "mock_surfels");
  await page.click('[data-value="window"]');
  await until(() => server.last("look").size[0] > 800, "the window's resolution");
  await setRange(page, "#fov", 90);
  await until(() => server.last("look").camera.fov_x === 90, "the field of view");
  await page.selectOption("#up", "-y");
  await until(() => server.last("look").camera.world_from_cam[1][0] ** 2 < 1e-12, "level again");
}

async function testPath(page, server, { shot, wholeShown }) {
  await page.goto(server.url());
  await wholeShown(page, server);
  await page.click("#path > summary");
  for (const [key, next] of [
    ["k", "]"],
    ["k", "]"],
    ["k", "]"],
  ]) {
    await page.keyboard.press(key);
    await page.keyboard.press(next);
  }
  await until(async () => (await page.locator(".keys-list li").count()) === 3, "three keys");
  await page.click(".keys-list li:last-child [aria-label]");
  await until(async () => (await page.locator(".keys-list li").count()) === 2, "one is removed");
  await page.fill("#path-seconds", "1");
  await page.keyboard.press("Tab");
  const looks = server.of("look").length;
  await page.keyboard.press("p").then(() => page.locator("#path-play").click());
  await until(() => server.of("look").length > looks + 3, "it plays");
  await until(async () => (await textOf(page, "#path-play")) === "Play", "to its end");
  await page.click("#path-save");
  const sent = await until(() => server.last("path"), "it is sent");
  assert.equal(sent.cameras.length, 24);
  assert.deepEqual([sent.name, sent.run, sent.fps, sent.video], ["tour", 0, 24, false]);
  const { cameras } = sent;
  assert.deepEqual([cameras[0].width, cameras[0].cx], [240, 120]);
  const command = "glint-bench render --run out/small --path tour.json";
  server.tell({ type: "path", file: "out/tour.json", command });
  await until(async () => (await textOf(page, ".command code")) === command, "the command");
  const [download] = await Promise.all([
    page.waitForEvent("download"),
    page.click("#path-download"),
  ]);
  assert.equal(download.suggestedFilename(), "path.json");
  const file = JSON.parse(readFileSync(await download.path(), "utf8"));
  assert.deepEqual([file.schema, file.frames.length, file.width], [1, 24, 240]);
  assert.deepEqual(file.frames[5].world_from_cam, cameras[5].world_from_cam);
  await page.click("#path-video");
  await until(() => server.last("path").video === true, "a video is asked for");
  server.tell({ type: "video", done: 3, of: 24, name: "tour", file: null, error: null });
  await page.waitForSelector("text=3 of 24");
  await shot(page, "mock_path");
  server.tell({ type: "video", done: 24, of: 24, name: "tour", file: "out/tour.mp4", error: null });
  const href = await page.locator("#video-link").getAttribute("href");
  assert.match(href, /^\/video\?name=tour&token=/);
}

async function testTraining(page, server, { shot, wholeShown }) {
  await page.goto(server.url());
  await wholeShown(page, server);
  server.tell({ type: "state", iteration: 1200, seconds: 75, paused: false });
  await until(
    async () => (await textOf(page, "#training")).includes("1,200 / 30,000 · 1:15 min"),
    "how far it is",
  );
  const shown = server.of("shown").length;
  await server.frame(server.look, { iteration: 1210, color: "#aa3377" });
  await until(async () => near(await colorAt(page, 0.9, 0.1), "#aa3377"), "a newer picture");
  assert.equal(server.of("shown").length, shown + 1);
  assert.match(await textOf(page, ".status"), /iteration 1,210/);
  await page.click("#pause");
  await until(() => server.last("pause")?.paused === true, "it is paused");
  await until(async () => (await textOf(page, "#pause")) === "Go on", "the button says so");
  await page.click("#pause");
  await until(() => server.last("pause").paused === false, "it goes on");
  server.tell({ type: "state", iteration: 1211, paused: false });
  const more = structuredClone(server.hello);
  more.runs[0].layers.push({ id: "away", title: "Glass taken away", style: "picture" });
  const looks = server.of("look").length;
  server.tell(more);
  await page.waitForSelector('[data-value="away"]');
  assert.equal(server.of("look").length, looks, "new layers alone ask for no frame");
  await shot(page, "mock_training");
}

async function testKeys(page, server, { shot, wholeShown }) {
  await page.goto(server.url());
  await wholeShown(page, server);
  await page.keyboard.press("?");
  await page.waitForSelector("dialog[open] kbd");
  await shot(page, "mock_keys");
  const looks = server.of("look").length;
  await page.keyboard.press("3");
  await page.keyboard.press("Escape");
  await page.waitForSelector("dialog", { state: "detached" });
  assert.equal(server.of("look").length, looks, "a dialog has the keys");
  await page.keyboard.press("h");
  await page.waitForSelector("#panel", { state: "hidden" });
  await page.keyboard.press("h");
  await page.click("#theme");
  await shot(page, "mock_light");
}

export async function testPanel(tools) {
  const { run } = tools;
  await run("two runs", kThree, (page, server) => testTwoRuns(page, server, tools));
  await run("surfels", kOne, (page, server) => testSurfels(page, server, tools));
  await run("a path", kOne, (page, server) => testPath(page, server, tools));
  const training = { ...kOne, training: { iterations: 30000 } };
  await run("a training", training, (page, server) => testTraining(page, server, tools));
  await run("keys", kOne, (page, server) => testKeys(page, server, tools));
}
