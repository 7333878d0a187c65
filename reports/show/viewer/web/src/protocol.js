// Messages of the server's protocol, version 1.

export const kVersion = 1;

// A binary message: {header, images: [Uint8Array]}, a picture a pane. Errors: what is not one.
export function parseFrame(buffer) {
  if (buffer.byteLength < 4) throw new Error("a frame of fewer than four bytes");
  const length = new DataView(buffer).getUint32(0, true);
  if (4 + length > buffer.byteLength) throw new Error("a frame that ends within its header");
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const images = [];
  let at = 4 + length;
  for (const bytes of header.images) {
    if (at + bytes > buffer.byteLength) throw new Error("a frame that ends within a picture");
    images.push(new Uint8Array(buffer, at, bytes));
    at += bytes;
  }
  return { header, images };
}

// The same the other way, for tests.
export function packFrame(header, images) {
  const text = new TextEncoder().encode(
    JSON.stringify({ ...header, images: images.map(({ length }) => length) }),
  );
  const bytes = new Uint8Array(4 + text.length + images.reduce((sum, i) => sum + i.length, 0));
  new DataView(bytes.buffer).setUint32(0, text.length, true);
  bytes.set(text, 4);
  let at = 4 + text.length;
  for (const image of images) {
    bytes.set(image, at);
    at += image.length;
  }
  return bytes;
}

const kFirstWait = 500; // ms
const kLongestWait = 10_000;

// Milliseconds before the try after `failures` failed ones.
export const waitAfter = (failures) => Math.min(kLongestWait, kFirstWait * 2 ** (failures - 1));
