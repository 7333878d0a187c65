// Chromium for the tests of both pages: the report's and that of `glint-bench view`.
import { chromium } from "playwright-core";

const kWebGl = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

// Without WebGL pages are drawn by the processor alone, which costs it less.
export const launchBrowser = ({ webgl = true } = {}) =>
  chromium.launch({
    executablePath: process.env.CHROMIUM,
    args: [
      "--no-sandbox",
      "--disable-quic",
      "--no-first-run",
      "--disable-background-networking",
      "--disable-component-update",
      "--disable-sync",
      ...(webgl ? kWebGl : ["--disable-gpu"]),
    ],
  });

// A page of its own context, and what went wrong in it: console errors, exceptions, requests to
// addresses other than `allowed` (a pattern).
export async function newPage(browser, allowed, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, ...options });
  context.setDefaultTimeout(120_000); // WebGL in software, on machines that do other work
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
    if (!allowed.test(request.url())) problems.push(`request: ${request.url()}`);
  });
  return { page, problems, close: () => context.close() };
}
