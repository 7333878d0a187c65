// What the programs wrote beside the page: one summary at once, parts when a view needs them.

export const report = window.GLINT_REPORT;

const waiting = new Map();

function addScript(source) {
  return new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = source;
    script.onload = () => resolve();
    script.onerror = () => reject(new Error(`${source} is missing; write the report again`));
    document.head.append(script);
  });
}

// In a single file every script is there already.
export function loadScript(name, isLoaded) {
  if (isLoaded()) return Promise.resolve();
  if (!waiting.has(name)) waiting.set(name, addScript(`assets/${name}.js`));
  return waiting.get(name);
}

export async function loadPart(name) {
  await loadScript(name, () => window.GLINT_PARTS?.[name] !== undefined);
  return window.GLINT_PARTS[name];
}

export const loadScene = (index) => loadPart(`scene_${index}`);

export const picturePath = (scene, view, owner, layer) =>
  `pictures/s${scene}/v${view}_${owner}_${layer}`;

export function pictureUrl(scene, view, owner, layer) {
  const path = `${picturePath(scene, view, owner, layer)}.png`;
  return window.GLINT_ASSETS?.[path] ?? `assets/${path}`;
}

// Bytes of a zlib stream in base64.
export async function unpack(text) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// 16-bit codes whose low bytes come first, then the high bytes.
export function codes16(bytes) {
  const count = bytes.length / 2;
  const codes = new Uint16Array(count);
  for (let i = 0; i < count; ++i) codes[i] = bytes[i] | (bytes[count + i] << 8);
  return codes;
}

export function metricInfo(id) {
  const plain = id.split("@")[0];
  const known = report.metrics[id] ?? report.metrics[plain];
  return known ?? { unit: "", direction: "none", decimals: 3 };
}

export function metricTitle(id) {
  const { unit, direction } = metricInfo(id);
  const arrow = { higher: " ↑", lower: " ↓" }[direction] ?? "";
  return `${id}${unit ? ` (${unit})` : ""}${arrow}`;
}

const kHuge = 1e7; // from here on with an exponent, as in tables

export function metricText(id, value) {
  if (value === null || value === undefined) return "–";
  if (Math.abs(value) >= kHuge) return value.toExponential(3);
  return value.toFixed(metricInfo(id).decimals);
}

export const methodTitle = (id) => report.titles[id] ?? id;
// False: it was given the truth.
export const isRival = (id) => !report.no_rivals.includes(id);

const hasSeeds = (scene, run) =>
  scene.runs.filter((other) => other.method === run.method).length > 1;

// "GLINT", or "GLINT · seed 1" where the scene has several seeds of a method.
export function runTitle(scene, run) {
  const title = methodTitle(run.method);
  return hasSeeds(scene, run) ? `${title} · seed ${run.seed}` : title;
}

// The same in the address: "glint", "glint:1".
export const runKey = (scene, run) =>
  hasSeeds(scene, run) ? `${run.method}:${run.seed}` : run.method;
// -1: no such run.
export const runOfKey = (scene, key) => scene.runs.findIndex((run) => runKey(scene, run) === key);

const severalDatasets = new Set(report.scenes.map(({ dataset }) => dataset)).size > 1;

export function sceneTitle(index) {
  const { name, dataset } = report.scenes[index];
  return severalDatasets ? `${dataset} / ${name}` : name;
}

// The same in the address.
export function sceneKey(index) {
  const { name, dataset } = report.scenes[index];
  return severalDatasets ? `${dataset}/${name}` : name;
}

// The scene that an address names, or `current`.
export function sceneOfAddress({ argument, params } = {}, current) {
  const last = report.scenes.length - 1;
  const named = report.scenes.findIndex((_, i) => sceneKey(i) === params?.get("scene"));
  if (named >= 0) return named;
  const index = argument ? Number(argument) || 0 : params ? 0 : current;
  return Math.min(Math.max(0, index), last);
}
