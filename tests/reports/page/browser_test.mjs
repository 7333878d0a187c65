// The report page in headless Chromium, from file://. Arguments: index.html of a folder, index.html
// of a single file, folder for screenshots. Every console error and every request that leaves the
// folder fails the test.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

const [folderPage, singlePage, shots] = process.argv.slice(2);
mkdirSync(shots, { recursive: true });

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM,
  args: [
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
  ],
});

async function openPage(file, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, ...options });
  const page = await context.newPage();
  const problems = [];
  page.on("console", (message) => message.type() === "error" && problems.push(message.text()));
  page.on("pageerror", (error) => problems.push(String(error)));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) problems.push(`request: ${request.url()}`);
  });
  await page.goto(pathToFileURL(file).href);
  await page.waitForSelector("main table");
  return { page, problems, close: () => context.close() };
}

const shot = (page, name) => page.screenshot({ path: `${shots}/${name}.png` });
const openView = async (page, name, selector) => {
  await page.click(`nav a[href="#${name}"]`);
  await page.waitForSelector(selector);
};
const textOf = (page, selector) => page.locator(selector).first().innerText();

async function testSummary(page) {
  const table = page.locator("#table-table1_photometric");
  assert.equal(await table.locator("tbody .word").first().isVisible(), true, "missing is a word");
  assert.ok((await table.locator("td.published").count()) > 0, "published numbers are there");
  assert.doesNotMatch(await textOf(page, "main"), /undefined|NaN|null/, "every cell has a word");
  const column = table.locator("thead button", { hasText: "PSNR" }).first();
  await column.click();
  const head = table.locator("thead th[aria-sort]");
  assert.equal(await head.getAttribute("aria-sort"), "descending", "best first");
  const values = async () =>
    (await table.locator("tbody tr td:nth-child(2)").allInnerTexts())
      .map(parseFloat)
      .filter((v) => !Number.isNaN(v));
  const down = await values();
  assert.equal(down.length, 2);
  assert.ok(down[0] >= down[1]);
  await column.click();
  assert.deepEqual(await values(), [...down].reverse());
  await page.keyboard.press("p");
  assert.equal(await page.locator("td.published").count(), 0, "p hides published numbers");
  await page.keyboard.press("p");
}

async function testScene(page) {
  await openView(page, "scene", ".viewer img");
  assert.equal(await page.locator("#injected").count(), 0, "names never become elements");
  assert.match(await textOf(page, ".label.right"), /^glint/);
  await page.selectOption("#right-owner", { label: "2dgs" });
  assert.match(await textOf(page, ".label.right"), /^2dgs/);

  const divider = page.locator("input.handle");
  const clip = () =>
    page
      .locator(".clip")
      .nth(1)
      .evaluate((element) => element.style.clipPath);
  const before = await clip();
  await divider.focus();
  await page.keyboard.press("ArrowRight");
  assert.notEqual(await clip(), before, "the divider moves by keyboard");
  const pane = await page.locator(".pane").boundingBox();
  await page.mouse.move(pane.x + pane.width * 0.5, pane.y + pane.height * 0.5);
  await page.mouse.down();
  await page.mouse.move(pane.x + pane.width * 0.25, pane.y + pane.height * 0.5, { steps: 5 });
  await page.mouse.up();
  assert.match(await clip(), /2[45]/, "the divider follows the pointer");
}

async function testProbe(page) {
  const pane = await page.locator(".pane").boundingBox();
  await page.mouse.move(pane.x + pane.width * 0.6, pane.y + pane.height * 0.4);
  await page.waitForSelector("table.probe");
  assert.match(await textOf(page, ".probe-title"), /^Pixel 28, 11/);
  const rows = await page.locator("table.probe tbody tr").allInnerTexts();
  assert.equal(rows.length, 4, "reference, two methods, the failed one");
  assert.match(rows[0], /\d\.\d{3}/);
  assert.match(rows[3], /missing/);
  await page.mouse.click(pane.x + pane.width * 0.6, pane.y + pane.height * 0.4);
  assert.match(await textOf(page, ".probe-title"), /held/);
  await page.locator("main").focus();
  await page.keyboard.press("ArrowRight");
  assert.match(await textOf(page, ".probe-title"), /^Pixel 29, 11/);
  await page.keyboard.press("h");
}

async function testModesAndLayers(page) {
  for (const layer of [
    "error",
    "depth",
    "normal",
    "angle",
    "transparency",
    "specularity",
    "interface",
    "transmission",
    "reflection",
  ]) {
    await page.click(`[data-value="${layer}"]`);
    await page.waitForSelector(`[data-value="${layer}"][aria-pressed="true"]`);
  }
  await page.click('[data-value="depth"]');
  assert.equal(await page.locator(".colorbar").count(), 1, "the range is shown");
  await page.keyboard.press("g");
  await page.waitForSelector('.viewer[data-mode="grid"]');
  assert.equal(await page.locator("figure").count(), 4);
  assert.ok((await page.locator(".viewer .missing").count()) >= 1, "the failed method is missing");
  await page.keyboard.press("+");
  const transforms = await page
    .locator(".content")
    .evaluateAll((all) => all.map((one) => one.style.transform));
  assert.equal(new Set(transforms).size, 1, "one zoom for all");
  assert.equal(transforms.length, 3);
  assert.match(transforms[0], /scale\(2\)/);
  await page.keyboard.press("o");
  await page.waitForSelector(".outline path");
  await shot(page, "scene_grid_depth");
  await page.keyboard.press("0");
  await page.keyboard.press("f");
  await page.waitForSelector('.viewer[data-mode="flicker"]');
  await page.keyboard.press("o");
  await page.click('[data-value="rgb"]');
  await page.keyboard.press("s");
  const current = () => page.locator(".frame[aria-current]").getAttribute("data-view");
  const first = await current();
  await page.keyboard.press("j");
  assert.notEqual(await current(), first, "j opens the next view");
  await page.waitForTimeout(200);
  await shot(page, "scene_slider");
}

async function testMeshes(page) {
  const stage = page.locator("#stage3d canvas");
  const picture = async () => {
    await page.waitForSelector("#stage3d[data-ready] canvas");
    await page.waitForTimeout(300);
    return (await stage.screenshot()).toString("base64");
  };
  await openView(page, "meshes", "#stage3d canvas");
  const whole = await picture();
  await page.locator("#cut").fill("50");
  assert.notEqual(await picture(), whole, "the cut changes the picture");
  await page.getByLabel("beside").selectOption({ index: 2 });
  await page.waitForFunction(() => document.querySelectorAll("#stage3d .label").length === 2);
  const both = await picture();
  await shot(page, "meshes");
  await page.locator("#cut").fill("100");
  assert.notEqual(await picture(), both, "two meshes are drawn and cut");
}

async function testOthers(page) {
  await openView(page, "curves", ".u-over");
  assert.equal(await page.locator(".uplot").count(), 3);
  await shot(page, "curves");
  await testMeshes(page);
  await openView(page, "records", "#record-filter");
  await page.fill("#record-filter", "failed");
  assert.equal(await page.locator("main tbody tr").count(), 1);
  await openView(page, "failures", ".failure");
  assert.match(await textOf(page, ".failure .message"), /onerror=alert/);
  await page.click(".failure summary");
  assert.match(await textOf(page, ".failure details pre"), /"iteration":7/);
  await shot(page, "failures");
  await openView(page, "commands", "main details summary");
  await page.click("main details summary");
  assert.match(await textOf(page, "main details code"), /^glint-bench all --profile/);
}

async function testKeyboard(page) {
  await page.keyboard.press("?");
  await page.waitForSelector("dialog[open] kbd");
  await shot(page, "keys");
  await page.keyboard.press("Escape");
  await page.waitForSelector("dialog", { state: "detached" });
  await page.keyboard.press("2");
  await page.waitForSelector(".viewer");
  await page.keyboard.press("1");
  await page.waitForSelector("#table-table1_photometric");
  const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
  const before = await theme();
  await page.keyboard.press("d");
  assert.notEqual(await theme(), before);
}

async function run(name, file, body, options) {
  const opened = await openPage(file, options);
  await body(opened.page);
  assert.deepEqual(opened.problems, [], `${name}: console and network stay quiet`);
  await opened.close();
  console.log(`ok: ${name}`);
}

try {
  await run("a folder", folderPage, async (page) => {
    await shot(page, "summary");
    await testSummary(page);
    await testScene(page);
    await testProbe(page);
    await testModesAndLayers(page);
    await testOthers(page);
    await testKeyboard(page);
  });
  await run("a single file", singlePage, async (page) => {
    await testScene(page);
    await testProbe(page);
    await openView(page, "meshes", "#stage3d canvas");
  });
  await run(
    "dark and narrow",
    folderPage,
    async (page) => {
      assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), "dark");
      await shot(page, "narrow_summary");
      await openView(page, "scene", ".viewer img");
      const wide = await page.evaluate(
        () => document.documentElement.scrollWidth > window.innerWidth,
      );
      assert.equal(wide, false, "nothing is wider than the screen");
      await shot(page, "narrow_scene");
    },
    { viewport: { width: 400, height: 800 }, colorScheme: "dark" },
  );
} finally {
  await browser.close();
}
