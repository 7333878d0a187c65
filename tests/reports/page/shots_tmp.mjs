import { chromium } from "playwright-core";
const browser = await chromium.launch({ executablePath: "/usr/bin/chromium", args: ["--no-sandbox","--use-angle=swiftshader","--enable-unsafe-swiftshader"] });
for (const scheme of ["light", "dark"]) {
const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, colorScheme: scheme });
const page = await context.newPage();
page.on("console", (m) => m.type() === "error" && console.log(m.text()));
page.on("pageerror", (e) => console.log(String(e)));
await page.goto("file://" + process.argv[2]);
const shot = async (name, full) => { await page.waitForTimeout(500); await page.screenshot({ path: `/tmp/page_shots/ci_${scheme}_${name}.png`, fullPage: !!full }); };
await page.waitForSelector("main table");
await shot("summary", true);
await page.click('nav a[href="#scene"]'); await page.waitForSelector(".viewer img");
const pane = await page.locator(".pane").boundingBox();
await page.mouse.move(pane.x + pane.width * 0.6, pane.y + pane.height * 0.4);
await page.keyboard.press("o");
await shot("scene", true);
await page.keyboard.press("g"); await page.click('[data-value="angle"]'); await shot("grid", true);
await page.click('[data-value="normal"]'); await shot("grid_normal");
await page.click('[data-value="t"]'); await shot("grid_t");
await page.click('nav a[href="#curves"]'); await page.waitForSelector(".u-over"); await shot("curves", true);
await page.click('nav a[href="#meshes"]'); await page.waitForSelector("#stage3d canvas"); await page.waitForTimeout(1000); await shot("meshes");
await page.click('nav a[href="#records"]'); await shot("records");
await context.close();
}
await browser.close();
