// The line below the picture: what the frame is, and what it cost.
import { viewOf } from "./look.js";
import { viewTitle } from "./panel_camera.js";
import { thousands } from "./parts.js";

export function statusText(app, rate) {
  if (!app.shown) return "Waiting for the first frame";
  const { header, look, latency } = app.shown;
  const { size, ms, drawn, surfels, iteration, whole } = header;
  const view = look?.view && viewOf(app.hello, look.view);
  return [
    view && viewTitle(view),
    iteration !== null && iteration !== undefined && `iteration ${thousands(iteration)}`,
    `${size[0]} × ${size[1]}${whole ? "" : " moving"}`,
    `${ms.toFixed(ms < 10 ? 1 : 0)} ms`,
    rate > 0 && `${rate.toFixed(rate < 10 ? 1 : 0)} fps`,
    latency !== undefined && `${Math.round(latency)} ms to the screen`,
    `${drawn === undefined ? "" : `${thousands(drawn)} of `}${thousands(surfels)} surfels`,
  ]
    .filter(Boolean)
    .join("  ·  ");
}
