// Chromium and pages in it, for the tests of the report page. Arguments: see browser_test.mjs.
import { mkdirSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { launchBrowser, newPage } from "./chromium.mjs";

export const [folderPage, singlePage, shots] = process.argv.slice(2);
mkdirSync(shots, { recursive: true });

export const browser = await launchBrowser();

export async function openPage(file, options = {}) {
  const opened = await newPage(browser, /^(file|data|blob):/, options);
  await opened.page.goto(file.startsWith("file:") ? file : pathToFileURL(file).href);
  await opened.page.waitForSelector("main > *");
  return opened;
}

export const shot = (page, name) => page.screenshot({ path: `${shots}/${name}.png` });

export async function openView(page, name, selector) {
  await page.click(`nav a[href="#${name}"]`);
  await page.waitForSelector(selector);
}

export const textOf = (page, selector) => page.locator(selector).first().innerText();
