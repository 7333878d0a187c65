// Chromium and pages in it, for the tests of the report page. Arguments: see browser_test.mjs.
import { mkdirSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";

export const [folderPage, singlePage, shots] = process.argv.slice(2);
mkdirSync(shots, { recursive: true });

export const browser = await chromium.launch({
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

export async function openPage(file, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, ...options });
  context.setDefaultTimeout(120_000); // pictures and WebGL in software, on machines that do other work
  const page = await context.newPage();
  await page.addInitScript(() => {
    // ImageData of a PNG in base64.
    window.pixelsOfPng = async (source) => {
      const image = new Image();
      image.src = `data:image/png;base64,${source}`;
      await image.decode();
      const canvas = new OffscreenCanvas(image.width, image.height);
      const context = canvas.getContext("2d");
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, image.width, image.height);
    };
  });
  const problems = [];
  page.on("console", (message) => message.type() === "error" && problems.push(message.text()));
  page.on("pageerror", (error) => problems.push(String(error)));
  page.on("request", (request) => {
    if (!/^(file|data|blob):/.test(request.url())) problems.push(`request: ${request.url()}`);
  });
  await page.goto(file.startsWith("file:") ? file : pathToFileURL(file).href);
  await page.waitForSelector("main > *");
  return { page, problems, close: () => context.close() };
}

export const shot = (page, name) => page.screenshot({ path: `${shots}/${name}.png` });

export async function openView(page, name, selector) {
  await page.click(`nav a[href="#${name}"]`);
  await page.waitForSelector(selector);
}

export const textOf = (page, selector) => page.locator(selector).first().innerText();
