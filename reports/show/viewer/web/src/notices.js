// Lines over the picture: the connection's state, and errors, which go away.
import { h, replace } from "../../../page/web/src/dom.js";
import { button } from "./parts.js";

const kShownMs = 7000;
const kRefused =
  "The token is wrong. Open the address that glint-bench view printed; each start has a new one.";

export class Notices {
  constructor(again) {
    this.again = again;
    this.banner = h("div", { class: "banner", role: "alert", hidden: true });
    this.line = h("p", { class: "toast", role: "status", hidden: true });
    this.element = h("div", { class: "notices" }, this.banner, this.line);
  }

  say(text) {
    this.line.textContent = text;
    this.line.hidden = false;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => (this.line.hidden = true), kShownMs);
  }

  connection(status, wait) {
    clearInterval(this.counter);
    this.banner.hidden = status === "open";
    if (status === "refused") replace(this.banner, h("span", {}, kRefused));
    if (status === "lost") this.#count(performance.now() + wait);
  }

  #count(end) {
    const text = h("span", {});
    const show = () => {
      const seconds = Math.max(0, Math.ceil((end - performance.now()) / 1000));
      const next = seconds > 0 ? ` in ${seconds} s` : "";
      text.textContent = `Connection lost. Trying again${next}.`;
    };
    show();
    this.counter = setInterval(show, 500);
    replace(this.banner, text, button("Try now", this.again, { class: "small" }));
  }
}
