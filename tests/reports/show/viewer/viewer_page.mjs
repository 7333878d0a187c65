// What tests of the viewer's page share, with a mock or a real server.
import assert from "node:assert/strict";
import { mkdirSync } from "node:fs";
import { newPage } from "../page/chromium.mjs";

const kAllowed = /^(http:\/\/(127\.0\.0\.1|localhost):|data:|blob:)/;
const kWait = 100_000; // ms until something that has to come fails

export async function openPage(browser, options = {}) {
  return newPage(browser, kAllowed, { viewport: { width: 1280, height: 720 }, ...options });
}

export function shotsInto(folder) {
  mkdirSync(folder, { recursive: true });
  return (page, name) => page.screenshot({ path: `${folder}/${name}.png` });
}

// Until condition() holds; its value.
export async function until(condition, what) {
  const end = performance.now() + kWait;
  for (;;) {
    const value = await condition();
    if (value) return value;
    if (performance.now() > end) assert.fail(`waited in vain: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 20));
  }
}

// Two frames of the browser: what was to follow has followed.
export const breathe = (page) =>
  page.evaluate(
    () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))),
  );

export const textOf = (page, selector) => page.locator(selector).first().innerText();
export const boxOf = (page) => page.locator(".picture").boundingBox();

// The colour of the picture at u, v (shares): [r, g, b].
export const colorAt = (page, u, v) =>
  page.locator(".frame-canvas").evaluate(
    (canvas, [x, y]) => [
      ...canvas
        .getContext("2d")
        .getImageData(Math.floor(x * canvas.width), Math.floor(y * canvas.height), 1, 1)
        .data.slice(0, 3),
    ],
    [u, v],
  );

export const near = (color, hex) =>
  [0, 1, 2].every((i) => {
    const expected = parseInt(hex.slice(1 + 2 * i, 3 + 2 * i), 16);
    return Math.abs(color[i] - expected) <= 6;
  });

// A key is held until something holds.
export async function hold(page, key, condition, what) {
  await page.keyboard.down(key);
  await until(condition, what);
  await page.keyboard.up(key);
}

export async function drag(page, from, to, button = "left") {
  const box = await boxOf(page);
  const at = ([u, v]) => [box.x + u * box.width, box.y + v * box.height];
  await page.mouse.move(...at(from));
  await page.mouse.down({ button });
  await page.mouse.move(...at(to), { steps: 6 });
  await page.mouse.up({ button });
}
