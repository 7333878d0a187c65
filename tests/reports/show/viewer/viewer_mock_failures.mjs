// What goes wrong between page and server, by a mock: losses, late and torn frames, errors.
import assert from "node:assert/strict";
import { packFrame } from "../../../../reports/show/viewer/web/src/protocol.js";
import { kHello } from "./viewer_hello.mjs";
import { colorAt, near, textOf, until } from "./viewer_page.mjs";

const kOne = { ...kHello, runs: [kHello.runs[0]] };

async function testLateFrames(page, server, { wholeShown }) {
  await page.goto(server.url());
  await wholeShown(page, server);
  const late = structuredClone(server.look);
  await page.keyboard.press("3");
  await until(() => server.look.panes[0].layer === "depth", "another look");
  await wholeShown(page, server);
  await until(async () => near(await colorAt(page, 0.9, 0.1), "#2a788e"), "the depth");
  const shown = server.of("shown").length;
  await server.frame(late, { color: "#ff0000" });
  await until(() => server.of("shown").length > shown, "a late frame is answered");
  assert.equal(server.last("shown").serial, late.serial);
  assert.ok(near(await colorAt(page, 0.9, 0.1), "#2a788e"), "and not shown");
  const header = { type: "frame", serial: server.look.serial, whole: true, size: [4, 4], ms: 1 };
  server.raw(packFrame(header, [new Uint8Array([1, 2, 3])]));
  await page.waitForSelector(".toast:not([hidden])");
  assert.match(await textOf(page, ".toast"), /frame could not be read/);
  await until(() => server.of("shown").length > shown + 1, "a damaged picture is answered, too");
  server.raw([9, 0, 0, 0, 1]);
  await until(
    async () => (await textOf(page, ".toast")).includes("ends within its header"),
    "torn",
  );
  assert.ok(near(await colorAt(page, 0.9, 0.1), "#2a788e"), "the picture stays");
}

async function testErrors(page, server, { wholeShown }) {
  await page.goto(server.url());
  await wholeShown(page, server);
  server.tell({ type: "error", message: "cut: the normal has no length <b id=injected>" });
  await until(async () => (await textOf(page, ".toast")).startsWith("cut: the normal"), "a line");
  assert.equal(await page.locator("#injected").count(), 0, "texts never become elements");
  await page.waitForSelector(".toast", { state: "hidden" });
}

async function testLoss(page, server, { shot, wholeShown }) {
  await page.goto(server.url());
  await wholeShown(page, server);
  await page.keyboard.press("3");
  await until(() => server.look.panes[0].layer === "depth", "a layer");
  server.isAway = true;
  server.drop();
  await page.waitForSelector(".banner:not([hidden])");
  assert.match(await textOf(page, ".banner"), /^Connection lost\. Trying again/);
  await page.keyboard.press("w"); // nobody hears it
  await shot(page, "mock_lost");
  const before = server.last("look");
  server.isAway = false;
  await page.click("text=Try now").catch(() => {});
  await until(() => server.sockets === 2, "it comes back");
  await page.waitForSelector(".banner", { state: "hidden" });
  await until(() => server.last("look").serial > before.serial, "the look is said again");
  assert.equal(server.last("look").panes[0].layer, "depth", "as it was");
  await wholeShown(page, server);
}

async function testRefusal(page, server, { shot, wholeShown }, problems) {
  await page.goto(server.url());
  await wholeShown(page, server);
  server.isWrongToken = true;
  server.drop();
  await until(async () => (await textOf(page, ".banner")).includes("token is wrong"), "refused");
  await shot(page, "mock_refused");
  await page.waitForTimeout(800);
  assert.equal(server.sockets, 1, "it does not try again");
  problems.splice(0); // the browser's own line about the 403
}

export async function testFailures(tools) {
  const { run } = tools;
  await run("late frames", kOne, (page, server) => testLateFrames(page, server, tools));
  await run("errors", kOne, (page, server) => testErrors(page, server, tools));
  await run("a loss", kOne, (page, server) => testLoss(page, server, tools));
  await run("a wrong token", kOne, (page, server, problems) =>
    testRefusal(page, server, tools, problems),
  );
}
