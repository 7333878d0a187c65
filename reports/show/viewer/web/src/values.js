// Numbers of a pixel as text.

const kVectorDecimals = 2;
const kColorDecimals = 3;
const kPlainDecimals = 3;

const bare = (text) => text.replace(/^(-?)0\./, "$1.");

function vectorText(values, decimals) {
  return values.map((value) => bare(value.toFixed(decimals))).join(" ");
}

// A number with its unit, or three of a colour or vector; nothing there: a dash. `short`: colours
// with two decimals.
export function valueText(value, layer, short) {
  if (value === null || value === undefined) return "–";
  if (layer.style === "depth" && value === 0) return "–";
  const isShort = short || layer.style === "normal";
  if (Array.isArray(value)) return vectorText(value, isShort ? kVectorDecimals : kColorDecimals);
  const unit = layer.unit === "°" ? "°" : layer.unit ? ` ${layer.unit}` : "";
  return value.toFixed(layer.decimals ?? kPlainDecimals) + unit;
}
