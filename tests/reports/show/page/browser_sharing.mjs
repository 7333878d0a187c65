// What leaves the page: tables as text, comparisons as pictures, and its address.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { openPage, openView, shots } from "./browser_page.mjs";

// What a button leaves on the clipboard.
export async function copied(page, button) {
  await page.evaluate(() => {
    window.copied = null;
    Object.defineProperty(navigator, "clipboard", {
      configurable: true,
      value: { writeText: async (text) => (window.copied = text) },
    });
  });
  await button.click();
  await page.waitForFunction(() => window.copied !== null);
  return page.evaluate(() => window.copied);
}

export async function testCopies(page) {
  const table = page.locator("#table-summary");
  const copy = (format) => copied(page, table.locator(`[data-format="${format}"]`));
  const rows = await table.locator("tbody tr").count();
  const columns = await table.locator("thead tr:last-child th").count();
  const best = await table.locator("td.rank-1").count();
  const second = await table.locator("td.rank-2").count();
  assert.ok(best > 0, "something is best");

  const latex = await copy("latex");
  assert.match(latex, /\\begin\{tabular\}\{lc+\}/);
  assert.match(latex, /\\multicolumn\{\d+\}\{c\}\{GlassRoom, measured\}/);
  assert.match(latex, /PSNR \(dB\) \$\\uparrow\$/, "titles with units");
  assert.equal(latex.split("\\textbf{").length - 1, best, "best in bold");
  assert.equal(latex.split("\\underline{").length - 1, second, "second underlined");
  const lines = latex.split("\n").filter((line) => line.endsWith("\\\\"));
  assert.equal(lines.length, rows + 2, "groups, titles, rows");
  for (const line of lines.slice(1)) assert.equal(line.split(" & ").length, columns);

  const csv = (await copy("csv")).trimEnd().split("\n");
  assert.equal(csv.length, rows + 1);
  assert.match(csv[0], /^Method,PSNR \(dB\) ↑,/);
  assert.match(csv.join("\n"), /GLINT,\d+\.\d{4,}/, "unrounded");

  const markdown = await copy("markdown");
  const shown = markdown.split("\n").filter((line) => line.startsWith("| "));
  assert.equal(shown.length, rows + 2);
  assert.equal((markdown.match(/\| \*\*/g) ?? []).length, best);

  const folded = await copied(page, page.locator("#table-table3_ablation [data-format=csv]"));
  assert.equal(folded.trimEnd().split("\n").length, 3, "folded rows are left out");
  assert.match(await copied(page, page.locator("#link")), /^file:.*#summary\?published=1/);
}

// Saves and looks into the PNG: {width, height, colors}.
async function saved(page, button, name) {
  const [download] = await Promise.all([page.waitForEvent("download"), button.click()]);
  assert.match(download.suggestedFilename(), /^[\w.+-]+\.png$/);
  await download.saveAs(`${shots}/${name}.png`);
  return page.evaluate(
    async (source) => {
      const pixels = await window.pixelsOfPng(source);
      const { width, height } = pixels;
      return { width, height, colors: new Set(new Uint32Array(pixels.data.buffer)).size };
    },
    readFileSync(`${shots}/${name}.png`).toString("base64"),
  );
}

export async function testPictures(page, kind) {
  const save = (where) => page.locator(`${where} .save`).first();
  const check = async (where, name, colors) => {
    const picture = await saved(page, save(where), `saved_${kind}_${name}`);
    assert.ok(picture.width >= 200 && picture.height >= 100, `${name} has a size`);
    assert.ok(picture.colors > colors, `${name} has ${picture.colors} colours`);
    return picture;
  };
  await openView(page, "summary", "#opening img");
  await check("#opening", "opening", 500);
  await openView(page, "scene", ".viewer img");
  const sizes = {};
  for (const mode of ["slider", "flicker", "grid"]) {
    await page.click(`[data-value="${mode}"]`);
    sizes[mode] = await check(".controls", mode, 200);
  }
  assert.ok(sizes.flicker.height < sizes.flicker.width / 2, "two pictures side by side");
  await openView(page, "curves", ".u-over");
  await check("#chart-loss", "curve", 20);
  await check("#chart-cost", "cost", 20);
  await openView(page, "meshes", "#stage3d[data-ready] canvas");
  await check(".controls", "meshes", 50);
}

// The share of pixels that differ clearly; 1 where the sizes differ.
function difference(page, here, there) {
  return page.evaluate(
    async (sources) => {
      const [a, b] = await Promise.all(sources.map(window.pixelsOfPng));
      if (a.width !== b.width || a.height !== b.height) return 1;
      let count = 0;
      for (let i = 0; i < a.data.length; i += 4)
        count += [0, 1, 2].some((c) => Math.abs(a.data[i + c] - b.data[i + c]) > 24);
      return (4 * count) / a.data.length;
    },
    [here, there].map((png) => png.toString("base64")),
  );
}

// Chromium places text by parts of a pixel that depend on how one came there, and the eye of a mesh
// is rounded in the address: edges differ. What is said must not.
const kEdges = 0.005;

// The same text and picture of `selector` in a page that opens the address of this one.
async function sameElsewhere(page, name, selector, ready = selector) {
  await page.mouse.move(0, 0);
  await page.evaluate(() => (document.activeElement?.blur(), window.scrollTo(0, 0)));
  await page.waitForTimeout(700); // the address follows, pictures are there
  const picture = (where, side) =>
    where
      .locator(selector)
      .screenshot({ animations: "disabled", path: `${shots}/link_${name}_${side}.png` });
  const here = await picture(page, "here");
  const url = page.url();
  const other = await openPage(url);
  await other.page.waitForSelector(ready);
  await other.page.waitForTimeout(700);
  const there = await picture(other.page, "there");
  assert.deepEqual(other.problems, []);
  assert.equal(other.page.url(), url, `${name}: the address stays`);
  const share = await difference(page, here, there);
  const text = (where) => where.locator(selector).innerText();
  assert.equal(await text(other.page), await text(page), `${name}: the text stays`);
  assert.ok(share <= kEdges, `${name}: ${share} of the pixels differ: ${url}`);
  await other.close();
  return url;
}

async function testSceneAddress(page) {
  await openView(page, "scene", ".viewer img");
  await page.keyboard.press("0");
  await page.click('[data-value="normal"]');
  await page.click('[data-value="grid"]');
  await page.locator("#shown-0").uncheck();
  await page.keyboard.press("+");
  await page.locator("#outline").check();
  const grid = await sameElsewhere(page, "grid", ".scene-layout", ".viewer .outline");
  assert.match(grid, /map=normal&mode=grid/);
  assert.match(grid, /methods=glint/);
  assert.match(grid, /zoom=2,-0\.5,-0\.5/);
  await page.locator("#shown-0").check();
  await page.click('[data-value="slider"]');
  await page.selectOption("#left-owner", { label: "2DGS" });
  await page.locator("input.handle").fill("20");
  const pane = await page.locator(".pane").boundingBox();
  await page.mouse.click(pane.x + 0.3 * pane.width, pane.y + 0.3 * pane.height);
  const slider = await sameElsewhere(page, "slider", ".scene-layout", "table.probe");
  assert.match(slider, /left=2dgs&right=2dgs&split=20&.*pixel=\d+,\d+&held=1/);
}

async function testCurvesAddress(page) {
  await openView(page, "curves", ".u-over");
  await page.locator("#smooth").fill("3");
  await page.click('[data-value="seconds"]');
  await page.locator("#method-0").uncheck();
  await page.selectOption("#cost", "num-surfels");
  const plot = await page.locator("#chart-loss .u-over").boundingBox();
  await page.mouse.move(plot.x + 0.3 * plot.width, plot.y + 50);
  await page.mouse.down();
  await page.mouse.move(plot.x + 0.7 * plot.width, plot.y + 50, { steps: 4 });
  await page.mouse.up();
  const url = await sameElsewhere(page, "curves", "main", ".u-over");
  assert.match(url, /by=time&smooth=3&.*cost=num-surfels&.*range=[\d.]+,[\d.]+/);
}

async function testMeshAddress(page) {
  await openView(page, "meshes", "#stage3d[data-ready] canvas");
  await page.locator("#cut").fill("30");
  await page.click('[data-value="z"]');
  await page.waitForSelector("#stage3d[data-ready] canvas");
  await page.locator("main").focus();
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("+");
  const url = await sameElsewhere(page, "meshes", "#stage3d", "#stage3d[data-ready] canvas");
  assert.match(url, /right=truth&axis=z&cut=30&.*camera=/);
}

async function testTableAddress(page) {
  await openView(page, "summary", "#opening img");
  await page.locator("#with-published").uncheck();
  await page.locator("#table-table3_ablation tfoot .fold").click();
  const columns = page.locator(".fold", { hasText: /empty column/ }).first();
  const id = await columns.evaluate((button) => button.closest("[id^=table-]").id.slice(6));
  await columns.click();
  await page.locator("#table-summary thead button", { hasText: "PSNR" }).first().click();
  const url = await sameElsewhere(page, "summary", "main", "#opening img");
  assert.match(url, /published=0&.*rows=table3_ablation&.*summary:down:psnr/);
  assert.match(url, new RegExp(`&columns=${id}&`));
  await openView(page, "records", "#record-filter");
  await page.fill("#record-filter", "glint");
  const records = await sameElsewhere(page, "records", "main");
  assert.match(records, /#records\?all=0&filter=glint/);
}

async function testOddAddresses(file) {
  for (const odd of [
    "#scene/0",
    "#scene/99",
    "#scene?scene=none&view=%E0&map=x&left=y&zoom=1e9,z&pixel=-5,1e9&sorted=a",
    "#curves?smooth=x&methods=&range=5",
    "#meshes?left=no&camera=1,2&cut=1e9",
    "#summary?sort=a&columns=,&rows=%",
  ]) {
    const opened = await openPage(`${new URL(`file://${file}`).href}${odd}`);
    await opened.page.waitForTimeout(300);
    assert.equal(await opened.page.locator("main > .warning").count(), 0, odd);
    assert.deepEqual(opened.problems, [], odd);
    await opened.close();
  }
}

export async function testAddresses(page, file) {
  await testSceneAddress(page);
  await testCurvesAddress(page);
  await testMeshAddress(page);
  await testTableAddress(page);
  await testOddAddresses(file);
}
