// The viewer's page against a mock server in headless Chromium. Argument: folder for screenshots.
import assert from "node:assert/strict";
import { launchBrowser } from "../page/chromium.mjs";
import { kHello } from "./viewer_hello.mjs";
import { MockServer, Painter } from "./viewer_mock.mjs";
import { testFailures } from "./viewer_mock_failures.mjs";
import { testPanel } from "./viewer_mock_panel.mjs";
import { boxOf, breathe, drag, hold, openPage, shotsInto, textOf, until } from "./viewer_page.mjs";
import { cameraOfLook } from "../../../../reports/show/viewer/web/src/look.js";
import { projected } from "../../../../reports/show/viewer/web/src/camera.js";

const shot = shotsInto(process.argv[2]);
const browser = await launchBrowser({ webgl: false });
const painter = new Painter(await (await browser.newContext()).newPage());
const kOne = { ...kHello, runs: [kHello.runs[0]] };

// The page rests: its last look has been answered with a whole frame.
async function wholeShown(page, server) {
  await breathe(page);
  await until(() => server.isSettled(), "a whole frame");
  await until(async () => !/moving|Waiting/.test(await textOf(page, ".status")), "which is shown");
}

async function testOpening(page, server) {
  await page.goto(server.url());
  await wholeShown(page, server);
  const look = server.last("look");
  assert.deepEqual(look.panes, [{ run: 0, layer: "rgb" }]);
  assert.deepEqual(look.size, kHello.size);
  assert.equal(look.view, null, "it flies");
  assert.ok(Math.abs(look.camera.fov_x - 70) < 1e-6, "as wide as the first test view");
  const expected = placeOf(kHello.views[0]);
  placeOf(look).forEach((value, i) => assert.ok(Math.abs(value - expected[i]) < 1e-6, "its place"));
  assert.equal(await textOf(page, ".label.left"), "GLINT · Image");
  assert.match(await textOf(page, ".status"), /240 × 135.*12 ms.*90,930 surfels/);
  assert.equal(server.of("shown").length, 2, "both frames are answered");
  await shot(page, "mock_open");
}

const placeOf = ({ camera }) => camera.world_from_cam.slice(0, 3).map((row) => row[3]);
const forwardOf = ({ camera }) => camera.world_from_cam.slice(0, 3).map((row) => row[2]);
const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);

async function testMotion(page, server) {
  const before = server.last("look");
  const way = () => placeOf(server.last("look")).map((value, i) => value - placeOf(before)[i]);
  await hold(page, "w", () => dot(way(), forwardOf(before)) > 0.05, "W goes ahead");
  await wholeShown(page, server);
  const ahead = server.last("look");
  await hold(page, "q", () => placeOf(server.last("look"))[2] < placeOf(ahead)[2], "Q goes down");
  await wholeShown(page, server);
  const turning = server.last("look");
  await drag(page, [0.5, 0.5], [0.7, 0.5]);
  await wholeShown(page, server);
  assert.ok(dot(forwardOf(server.last("look")), forwardOf(turning)) < 0.999, "a drag turns");
  assert.deepEqual(placeOf(server.last("look")), placeOf(turning), "on the spot");
  await drag(page, [0.5, 0.5], [0.6, 0.5], "right");
  await until(() => placeOf(server.last("look"))[0] !== placeOf(turning)[0], "right drag moves");
  const speed = await textOf(page, "#speed + output");
  await page.mouse.wheel(0, -300);
  await until(async () => (await textOf(page, "#speed + output")) !== speed, "the wheel is speed");
  const serials = server.of("look").map(({ serial }) => serial);
  assert.ok(
    serials.every((serial, i) => i === 0 || serial > serials[i - 1]),
    "serials ascend",
  );
}

async function testOrbit(page, server) {
  await page.keyboard.press("o");
  await page.waitForSelector('[data-value="orbit"][aria-pressed="true"]');
  const box = await boxOf(page);
  await page.keyboard.press("f"); // no camera takes the click
  await page.mouse.dblclick(box.x + 0.5 * box.width, box.y + 0.5 * box.height);
  await until(() => server.last("pick"), "a double click picks");
  const pivot = [0.5, 0.25, 1];
  await until(() => page.url().includes("pivot=0.5,0.25,1"), "the pivot is set");
  const apart = (look) => Math.hypot(...placeOf(look).map((value, i) => value - pivot[i]));
  const before = server.last("look");
  await drag(page, [0.4, 0.5], [0.6, 0.55]);
  await wholeShown(page, server);
  assert.ok(server.last("look").serial > before.serial, "it orbits");
  assert.ok(Math.abs(apart(server.last("look")) - apart(before)) < 1e-6, "as far from the pivot");
  await page.mouse.wheel(0, -200);
  await until(() => apart(server.last("look")) < 0.95 * apart(before), "the wheel goes nearer");
  await page.keyboard.press("r");
  await page.keyboard.press("o");
  await page.keyboard.press("f");
}

// Clicks on the camera of a test view, as it stands on the picture.
async function testSnapping(page, server) {
  await wholeShown(page, server);
  const camera = cameraOfLook(kHello, server.last("look"));
  const seen = kHello.views
    .map((view) => [view, projected(camera, placeOf(view))])
    .filter(([, [x, y, z]]) => z > 0.3 && x > 10 && y > 10 && x < 230 && y < 125);
  assert.ok(seen.length > 0, "a camera is on the picture");
  const [view, [x, y]] = seen.reduce((a, b) => (a[1][2] < b[1][2] ? a : b));
  const box = await boxOf(page);
  const at = [box.x + (x / 240) * box.width, box.y + (y / 135) * box.height];
  await page.mouse.move(...at);
  await page.waitForSelector(".label.tip:not([hidden])");
  await shot(page, "mock_frusta");
  await page.mouse.click(...at);
  const { split, index } = view;
  await until(() => server.last("look").view, "a click snaps");
  assert.deepEqual(server.last("look").view, { split, index });
  await page.waitForSelector(".photo img");
  await page.selectOption("#view", { label: "Test view 0003" });
  await until(() => server.last("look").view?.index === 3, "the list snaps");
  await page.keyboard.press("]");
  await until(() => server.last("look").view?.index === 4, "] is the next");
  await page.keyboard.press("[");
  await page.keyboard.press("[");
  await until(() => server.last("look").view?.index === 2, "[ goes back");
  await page.keyboard.press("2");
  await until(() => server.last("look").panes[0].layer === "error", "the error is there");
  await page.keyboard.press("c");
  await until(async () => (await textOf(page, ".label.right")) === "Photo", "the photo beside");
  await wholeShown(page, server);
  await shot(page, "mock_photo");
  await page.keyboard.press("c");
}

async function testProbe(page, server) {
  const count = server.of("probe").length;
  const box = await boxOf(page);
  const begin = performance.now();
  for (let i = 0; i < 40; ++i)
    await page.mouse.move(box.x + box.width * (0.3 + 0.01 * i), box.y + box.height * 0.1);
  await until(
    () => Math.abs((server.last("probe")?.x ?? 0) - 0.69) < 0.01,
    "the last position is asked",
  );
  const seconds = (performance.now() - begin) / 1000;
  assert.ok(server.of("probe").length - count <= 2 + 10 * seconds, "at most ten a second");
  await until(
    async () =>
      (await textOf(page, ".layer-head .layer-title")) === `Pixel ${Math.floor(0.69 * 240)}, 13`,
    "the pixel's numbers",
  );
  const row = (id) => page.locator(`.layer[data-value="${id}"] .value`).allInnerTexts();
  assert.match((await row("rgb")).join(), /^\.500 \.250 \.69\d,\.125 \.250 \.375$/);
  assert.deepEqual(await row("depth"), ["2.500 m", "2.000 m"]);
  assert.deepEqual(await row("transparency"), ["–", "–"], "nothing there");
  await page.mouse.move(5, 5);
  await hold(page, "s", () => server.last("look").view === null, "a motion leaves the view");
  assert.equal(server.last("look").panes[0].layer, "rgb", "where there is no truth: the image");
}

async function testAddress(page, server) {
  await wholeShown(page, server); // else the last motion goes on
  await page.keyboard.press("3");
  await until(() => server.last("look").panes[0].layer === "depth", "a number key");
  const link = page.url();
  const before = server.last("look");
  await until(() => page.url().includes("layer=depth"), "the address has it");
  await page.reload();
  await until(() => server.sockets === 2 && server.last("look").serial < before.serial, "again");
  await wholeShown(page, server);
  const after = server.last("look");
  assert.deepEqual(after.panes, before.panes);
  placeOf(after).forEach((n, i) => assert.ok(Math.abs(n - placeOf(before)[i]) < 1e-4, "place"));
  const text = await page.locator("#link").evaluate(() => location.hash);
  assert.doesNotMatch(text, /token/, link);
}

async function testTouch(page, server) {
  await page.goto(server.url());
  await wholeShown(page, server);
  await shot(page, "mock_phone");
  const wide = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
  assert.equal(wide, false, "nothing is wider than the screen");
  const box = await boxOf(page);
  const client = await page.context().newCDPSession(page);
  const touch = (type, points) =>
    client.send("Input.dispatchTouchEvent", {
      type,
      touchPoints: points.map(([u, v], id) => ({
        x: box.x + u * box.width,
        y: box.y + v * box.height,
        id,
      })),
    });
  const before = server.last("look");
  await touch("touchStart", [[0.4, 0.5]]);
  for (const u of [0.45, 0.5, 0.6]) await touch("touchMove", [[u, 0.5]]);
  await touch("touchEnd", []);
  await until(() => dot(forwardOf(server.last("look")), forwardOf(before)) < 0.999, "one finger");
  const turned = server.last("look");
  await touch("touchStart", [
    [0.4, 0.5],
    [0.6, 0.5],
  ]);
  for (const step of [0.02, 0.06, 0.1])
    await touch("touchMove", [
      [0.4 - step, 0.5],
      [0.6 + step, 0.5],
    ]);
  await touch("touchEnd", []);
  await until(
    () =>
      dot(
        placeOf(server.last("look")).map((value, i) => value - placeOf(turned)[i]),
        forwardOf(turned),
      ) > 0.1,
    "two fingers go nearer",
  );
  await page.click("#unfold");
  await page.waitForSelector("#panel:visible");
  await wholeShown(page, server);
  await shot(page, "mock_phone_panel");
}

async function run(name, hello, body, options) {
  const opened = await openPage(browser, options);
  const server = new MockServer(painter, structuredClone(hello));
  await server.install(opened.page);
  await body(opened.page, server, opened.problems);
  assert.deepEqual(opened.problems, [], `${name}: console and network stay quiet`);
  await opened.close();
  console.log(`ok: ${name}`);
}

const tools = { run, shot, wholeShown };
try {
  await run("one run", kOne, async (page, server) => {
    await testOpening(page, server);
    await testMotion(page, server);
    await testOrbit(page, server);
    await testSnapping(page, server);
    await testProbe(page, server);
    await testAddress(page, server);
  });
  await run("a phone", kOne, testTouch, {
    viewport: { width: 390, height: 780 },
    hasTouch: true,
  });
  await testPanel(tools);
  await testFailures(tools);
} finally {
  await browser.close();
}
