// The report page in headless Chromium, from file://. Arguments: index.html of a folder, index.html
// of a single file, folder for screenshots. Every console error and every request that leaves the
// folder fails the test.
import assert from "node:assert/strict";
import {
  browser,
  folderPage,
  openPage,
  openView,
  shot,
  singlePage,
  textOf,
} from "./browser_page.mjs";
import { copied, testAddresses, testCopies, testPictures } from "./browser_sharing.mjs";

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

// The picture, then the headline, before anything else.
async function testOpening(page) {
  await page.waitForSelector("#opening img");
  const sections = await page.locator("main section").evaluateAll((all) => all.map(({ id }) => id));
  assert.deepEqual(sections.slice(0, 2), ["opening", "table-summary"]);
  const captions = await page.locator("#opening figcaption").allInnerTexts();
  assert.match(captions.slice(0, 3).join("|"), /^Reference\|2DGS[^|]*\|GLINT[^|]*$/);
  assert.deepEqual(captions.slice(3), ["Depth", "Depth behind glass"], "titles of the rows");
  const loaded = await page
    .locator("#opening img")
    .evaluateAll((all) => Promise.all(all.map((img) => img.decode().then(() => img.naturalWidth))));
  assert.ok(loaded.length >= 3 && loaded.every((width) => width > 0), "its pictures are there");
}

// Columns and rows without anything fold away and come back.
async function testFolds(page) {
  const ablation = page.locator("#table-table3_ablation");
  const rows = ablation.locator("tbody tr");
  // Methods that the table does not name stand below its own.
  const shown = ["Full model", "broken</script><b id=injected>"];
  assert.deepEqual(await rows.locator("th").allInnerTexts(), shown);
  const fold = ablation.locator("tfoot .fold");
  assert.match(await fold.innerText(), /Show 6 rows that were not run: w\/o/);
  await fold.click();
  assert.equal(await rows.count(), 8);
  await fold.click();
  assert.equal(await rows.count(), 2);
  const empty = await page.evaluate(() =>
    window.GLINT_REPORT.tables.map(({ id, columns, rows }) => {
      const words = ["missing", "unavailable", "not applicable", "failed"];
      const has = (column) => rows.some(({ cells }) => !words.includes(cells[column.id].status));
      return { id, empty: columns.filter((column) => !has(column)).length, all: columns.length };
    }),
  );
  for (const { id, empty: count, all } of empty) {
    const table = page.locator(`#table-${id}`);
    const heads = table.locator("thead tr:last-child th");
    assert.equal(await heads.count(), 1 + all - count, `${id}: no column without a value`);
    if (count === 0) continue;
    const button = table.locator("section > .fold, :scope > .fold");
    assert.match(await button.innerText(), new RegExp(`Show ${count} empty column`));
    await button.click();
    assert.equal(await heads.count(), 1 + all, `${id}: all columns`);
    await button.click();
  }
}

async function testScene(page) {
  await openView(page, "scene", ".viewer img");
  assert.equal(await page.locator("#injected").count(), 0, "names never become elements");
  assert.match(await textOf(page, ".label.right"), /^GLINT/);
  await page.selectOption("#right-owner", { label: "2DGS" });
  assert.match(await textOf(page, ".label.right"), /^2DGS/);

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
  const csv = await copied(page, page.locator(".probe-panel [data-format=csv]"));
  assert.match(csv, /^Method,RGB,Error,.*\nReference,/, "the values can be copied");
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

// The number of colours near the border of a picture, below its labels.
function borderColors(page, png) {
  return page.evaluate(async (source) => {
    const { data, width, height } = await window.pixelsOfPng(source);
    const at = (x, y) => data.slice(4 * (y * width + x), 4 * (y * width + x) + 3).join();
    const border = new Set();
    for (let x = 12; x < width - 12; ++x) border.add(at(x, height - 12));
    for (let y = 50; y < height - 12; ++y) border.add(at(12, y)).add(at(width - 12, y));
    return border.size;
  }, png);
}

async function testMeshes(page) {
  const stage = page.locator("#stage3d canvas");
  const picture = async () => {
    await page.waitForSelector("#stage3d[data-ready] canvas");
    await page.waitForTimeout(300);
    return (await stage.screenshot()).toString("base64");
  };
  await openView(page, "meshes", "#stage3d[data-ready] canvas");
  const labels = await page.locator("#stage3d .label").allInnerTexts();
  assert.match(labels[0], /^(GLINT|2DGS): mesh/, "a method");
  assert.equal(labels[1], "Ground truth", "beside the truth");
  const whole = await picture();
  assert.equal(await borderColors(page, whole), 1, "nothing reaches the frame");
  await shot(page, "meshes");
  await page.locator("#cut").fill("50");
  const both = await picture();
  assert.notEqual(both, whole, "the cut changes the picture");
  await page.selectOption("#mesh-right", "none");
  await page.waitForFunction(() => document.querySelectorAll("#stage3d .label").length === 1);
  const one = await picture();
  await page.locator("#cut").fill("100");
  assert.notEqual(await picture(), one, "one mesh is drawn and cut");
  await page.locator("#cut").fill("0");
  await page.selectOption("#mesh-right", "truth");
}

const chartPicture = async (page, name) => {
  await page.waitForTimeout(100);
  return (await page.locator(`#chart-${name} canvas`).screenshot()).toString("base64");
};

async function testCurves(page) {
  await openView(page, "curves", ".u-over");
  assert.equal(await page.locator(".uplot").count(), 3);
  const key = await page.locator(".method-list").innerText();
  assert.match(key, /2DGS[^]*GLINT/, "titles, not ids");
  const before = await chartPicture(page, "loss");
  await page.locator("#smooth").fill("30");
  const smooth = await chartPicture(page, "loss");
  assert.notEqual(smooth, before, "smoothing changes the line");
  assert.equal(await page.locator("#chart-loss .u-series.raw").count(), 2, "raw lines stay");
  await page.locator("#marks").uncheck();
  assert.notEqual(await chartPicture(page, "loss"), smooth, "marks are drawn");
  await page.locator("#marks").check();
  await page.locator("#marks-list summary").click();
  assert.match(await textOf(page, "#marks-list"), /GLINT: \d+: .* loss begins/);
  assert.match(await textOf(page, "#marks-list"), /Read from the logs: resets of opacities/);
  await shot(page, "curves");
  await page.locator("#method-0").uncheck();
  assert.equal(await page.locator("#chart-loss .u-series:not(.raw)").count(), 2, "x and GLINT");
  await page.getByRole("button", { name: "None" }).click();
  assert.match(await textOf(page, "#chart-loss"), /No method is chosen/);
  await page.getByRole("button", { name: "All", exact: true }).click();
}

async function testOthers(page) {
  await testCurves(page);
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
  await page.keyboard.press("d");
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
    await testOpening(page);
    await shot(page, "summary");
    await testFolds(page);
    await testSummary(page);
    await testCopies(page);
    await testScene(page);
    await testProbe(page);
    await testModesAndLayers(page);
    await testOthers(page);
    await testKeyboard(page);
    await testPictures(page, "folder");
    await testAddresses(page, folderPage);
  });
  await run("a single file", singlePage, async (page) => {
    await testScene(page);
    await testProbe(page);
    await openView(page, "meshes", "#stage3d canvas");
    assert.match(await textOf(page, "main"), /merged to 30,000 faces/);
    await testPictures(page, "single");
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
