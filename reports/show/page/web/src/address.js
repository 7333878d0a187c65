// What is shown, in the address: "#scene?scene=room_1&map=depth". A copied link opens the same.

const kWait = 150; // ms; browsers refuse an address that changes too often
let pending = null;
let timer = 0;

function decoded(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text; // a torn link
  }
}

const listItem = (text) => String(text).replace(/[%,]/g, encodeURIComponent);

function encoded(value) {
  if (typeof value === "boolean") return value ? "1" : "0";
  const text = Array.isArray(value) ? value.map(listItem).join(",") : String(value);
  return encodeURIComponent(text).replace(/%(2F|2C|3A|40|7E)/g, decodeURIComponent);
}

// The choices of an address; what is absent or no such choice is the fallback.
class Params {
  constructor(query) {
    const pairs = query.split("&").filter(Boolean);
    this.values = new Map(
      pairs.map((pair) => [pair.split("=")[0], decoded(pair.split("=").slice(1).join("="))]),
    );
  }

  get(name, fallback = null) {
    return this.values.get(name) ?? fallback;
  }

  list(name) {
    const text = this.values.get(name);
    if (text === undefined) return null;
    return text === "" ? [] : text.split(",").map(decoded);
  }

  numbers(name, count) {
    const numbers = this.list(name)?.map(Number);
    return numbers?.length === count && numbers.every(Number.isFinite) ? numbers : null;
  }

  number(name, low, high, fallback) {
    const value = this.numbers(name, 1)?.[0];
    return value === undefined ? fallback : Math.min(high, Math.max(low, value));
  }

  choice(name, allowed, fallback) {
    const value = this.get(name);
    return allowed.includes(value) ? value : fallback;
  }

  flag(name, fallback) {
    return { 0: false, 1: true }[this.get(name)] ?? fallback;
  }
}

// {view, argument ("#scene/1"), params}; params is null where the address makes no choice, and the
// view stays as it was left.
export function readAddress() {
  const [path, query] = location.hash.slice(1).split("?");
  const [view, argument] = path.split("/");
  return { view, argument, params: query ? new Params(query) : null };
}

// "#view?name=value&..."; values that are null or undefined are left out.
export function addressOf(view, values) {
  const pairs = Object.entries(values)
    .filter(([, value]) => value !== null && value !== undefined)
    .map(([name, value]) => `${name}=${encoded(value)}`);
  return `#${view}?${pairs.join("&")}`;
}

export function writeAddress(push = false) {
  clearTimeout(timer);
  const address = pending;
  pending = null;
  if (!address || address === location.hash) return;
  try {
    history[push ? "pushState" : "replaceState"](null, "", address);
  } catch {
    // Some browsers allow neither for file://; the page works without.
  }
}

// Soon, and once for many changes; `push`: at once, and the browser's "back" returns to before.
export function keepAddress(view, values, push = false) {
  pending = addressOf(view, values);
  clearTimeout(timer);
  if (push) writeAddress(true);
  else timer = setTimeout(writeAddress, kWait);
}

// Another view opens: what the one before had to say is late.
export function dropAddress() {
  clearTimeout(timer);
  pending = null;
}
