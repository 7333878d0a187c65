// Reads the EXR files that glint-bench writes: scan lines of float32 channels, by ZIP or not
// compressed [openexr.com, "OpenEXR File Layout"].
import { readFileSync } from "node:fs";
import { inflateSync } from "node:zlib";

const kMagic = 20000630;
const kFloat = 2;
const kLinesOfChunk = { 0: 1, 2: 1, 3: 16 }; // none, ZIPS, ZIP

function textAt(file, at) {
  const end = file.indexOf(0, at);
  return [file.toString("latin1", at, end), end + 1];
}

// Attributes by name, and where the header ends.
function readHeader(file) {
  if (file.readUInt32LE(0) !== kMagic) throw new Error("no EXR file");
  const attributes = {};
  let at = 8;
  while (file[at] !== 0) {
    const [name, type] = textAt(file, at);
    const [, size] = textAt(file, type);
    const length = file.readUInt32LE(size);
    attributes[name] = file.subarray(size + 4, size + 4 + length);
    at = size + 4 + length;
  }
  return { attributes, end: at + 1 };
}

// Names, in the order of the file.
function channelsOf(list) {
  const names = [];
  for (let at = 0; list[at] !== 0;) {
    const [name, rest] = textAt(list, at);
    if (list.readUInt32LE(rest) !== kFloat) throw new Error(`channel ${name} is not float32`);
    names.push(name);
    at = rest + 16;
  }
  return names;
}

// Of ZIP: differences of bytes, of which the even ones come first.
function unpacked(bytes, size) {
  if (bytes.length === size) return bytes;
  const plain = inflateSync(bytes);
  for (let i = 1; i < plain.length; ++i) plain[i] = plain[i - 1] + plain[i] - 128;
  const half = Math.ceil(plain.length / 2);
  return Buffer.from(plain.map((_, i) => plain[i % 2 ? half + (i >> 1) : i >> 1]));
}

// {width, height, channels: {name: Float32Array}}
export function readExr(path) {
  const file = readFileSync(path);
  const { attributes, end } = readHeader(file);
  const [left, top, right, bottom] = [0, 4, 8, 12].map((i) => attributes.dataWindow.readInt32LE(i));
  const [width, height] = [right - left + 1, bottom - top + 1];
  const names = channelsOf(attributes.channels);
  const lines = kLinesOfChunk[attributes.compression[0]];
  const channels = Object.fromEntries(names.map((n) => [n, new Float32Array(width * height)]));
  for (let chunk = 0; chunk * lines < height; ++chunk) {
    const at = Number(file.readBigUInt64LE(end + 8 * chunk));
    const first = file.readInt32LE(at) - top;
    const rows = Math.min(lines, height - first);
    const bytes = file.subarray(at + 8, at + 8 + file.readUInt32LE(at + 4));
    const values = unpacked(bytes, 4 * rows * width * names.length);
    let next = 0;
    for (let y = first; y < first + rows; ++y)
      for (const name of names)
        for (let x = 0; x < width; ++x, next += 4)
          channels[name][y * width + x] = values.readFloatLE(next);
  }
  return { width, height, channels };
}
