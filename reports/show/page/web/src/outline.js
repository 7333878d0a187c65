// The outline of glass as a path along pixel edges: sharp at any zoom.
import { svg } from "./dom.js";

export function outlinePath({ glass, width, height }) {
  if (!glass) return "";
  const inside = (x, y) =>
    x >= 0 && x < width && y >= 0 && y < height && glass[y * width + x] !== 0;
  const parts = [];
  for (let y = 0; y <= height; ++y)
    for (let x = 0; x <= width; ++x) {
      if (inside(x, y) !== inside(x, y - 1)) parts.push(`M${x} ${y}h1`);
      if (inside(x, y) !== inside(x - 1, y)) parts.push(`M${x} ${y}v1`);
    }
  return parts.join("");
}

export function outlineElement(path, width, height) {
  return svg(
    "svg",
    {
      class: "outline",
      viewBox: `0 0 ${width} ${height}`,
      preserveAspectRatio: "none",
      "aria-hidden": "true",
    },
    svg("path", { d: path, class: "under" }),
    svg("path", { d: path, class: "over" }),
  );
}
