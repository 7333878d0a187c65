// Bundles src/ into ../dist: report.js (the page), mesh3d.js (the 3D view, loaded when it is opened),
// report.css, index.html and the licences of what is bundled; and the page of `glint-bench view`, which
// shares modules with it, into ../../viewer/dist: viewer.js, viewer.css, index.html.
import { build } from "esbuild";
import { copyFileSync, readFileSync, writeFileSync } from "node:fs";

const dist = new URL("../dist/", import.meta.url).pathname;

const viewer = new URL("../../viewer/", import.meta.url).pathname;

const bundle = (entryPoints, outdir) =>
  build({
    entryPoints,
    outdir,
    bundle: true,
    minify: true,
    format: "iife",
    target: ["es2022"],
    charset: "ascii",
    legalComments: "none",
    logLevel: "warning",
  });

await bundle(
  [
    { in: "src/main.js", out: "report" },
    { in: "src/mesh3d.js", out: "mesh3d" },
    { in: "src/style.css", out: "report" },
  ],
  dist,
);
await bundle(
  [
    { in: `${viewer}web/src/main.js`, out: "viewer" },
    { in: `${viewer}web/src/style.css`, out: "viewer" },
  ],
  `${viewer}dist/`,
);

const library = (name) =>
  readFileSync(new URL(`node_modules/${name}/package.json`, import.meta.url), "utf8");
const licences = ["uplot", "three"].map((name) => {
  const { version, license } = JSON.parse(library(name));
  const text = readFileSync(new URL(`node_modules/${name}/LICENSE`, import.meta.url), "utf8");
  return `${name} ${version} (${license})\n\n${text.trim()}\n`;
});
writeFileSync(`${dist}LICENSES.txt`, licences.join("\n" + "-".repeat(72) + "\n\n"));
copyFileSync("index.html", `${dist}index.html`);
copyFileSync(`${viewer}web/index.html`, `${viewer}dist/index.html`);
