// What the colours of a layer mean.
import { h } from "./dom.js";

const kBallSize = 44;

// A ball seen from the front in the colours of normals.
export function normalBall() {
  const canvas = h("canvas", {
    width: kBallSize,
    height: kBallSize,
    class: "ball",
    "aria-hidden": "true",
  });
  const context = canvas.getContext("2d");
  const picture = context.createImageData(kBallSize, kBallSize);
  const radius = kBallSize / 2;
  for (let i = 0; i < kBallSize * kBallSize; ++i) {
    const x = ((i % kBallSize) + 0.5) / radius - 1;
    const up = 1 - (Math.floor(i / kBallSize) + 0.5) / radius;
    const rest = 1 - x * x - up * up;
    if (rest < 0) continue;
    const color = [x, up, Math.sqrt(rest)].map((n) => 255 * (0.5 + 0.5 * n));
    picture.data.set([...color, 255], 4 * i);
  }
  context.putImageData(picture, 0, 0);
  return canvas;
}

const limit = (value, unit) =>
  `${Number(value.toPrecision(3))}${unit === "°" ? "" : " "}${unit}`.trim();

// Lowest value, its colours, highest value.
export const colorbar = ({ low, high, unit, colors }) => [
  h("span", { class: "limit" }, limit(low, unit)),
  h("span", {
    class: "colorbar",
    style: { background: `linear-gradient(90deg, ${colors.join(", ")})` },
  }),
  h("span", { class: "limit" }, limit(high, unit)),
];

const kNotes = {
  depth: "black: nothing there",
  angle: "larger angles are as light as the last; grey: no true normal",
  error: "mean over channels of |render − reference|; larger errors are as light as the last",
};

export function legend(layer, depthFromTruth) {
  if (layer.style === "picture")
    return h("div", { class: "legend" }, h("span", { class: "note" }, "As displayed; not scaled."));
  if (layer.style === "normal")
    return h(
      "div",
      { class: "legend" },
      normalBall(),
      h(
        "span",
        { class: "note" },
        "Camera space: red to the right, green up, blue towards the viewer; black: nothing there",
      ),
    );
  const source =
    layer.style === "depth"
      ? depthFromTruth
        ? ", from the true depths"
        : ", from the rendered depths"
      : "";
  const notes = [
    `one range for all methods of the scene${source}`,
    kNotes[layer.style === "depth" ? "depth" : layer.id],
  ];
  return h(
    "div",
    { class: "legend" },
    colorbar(layer),
    h("span", { class: "note" }, notes.filter(Boolean).join(" · ")),
  );
}
