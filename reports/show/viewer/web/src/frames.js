// Frames as they arrive: decoded, shown in order, answered; never a queue, as the server sends the
// next one when this one is answered.
import { parseFrame } from "./protocol.js";

const kJpeg = { type: "image/jpeg" };
const kRateMs = 2000; // frames a second are counted over this

const decoded = (images) =>
  Promise.all(images.map((bytes) => createImageBitmap(new Blob([bytes], kJpeg))));

export class Frames {
  // onFrame(header, bitmaps), which are its own to close; answer(serial); onError(text)
  constructor({ onFrame, answer, onError }) {
    Object.assign(this, { onFrame, answer, onError, shown: -1, times: [] });
  }

  async receive(buffer) {
    let header = null;
    try {
      const frame = parseFrame(buffer);
      header = frame.header;
      const bitmaps = await decoded(frame.images);
      this.#show(header, bitmaps);
    } catch (error) {
      this.onError(`A frame could not be read: ${error.message}`);
    }
    if (header) this.answer(header.serial);
  }

  // An older one than what is shown came late: it is dropped.
  #show(header, bitmaps) {
    if (header.serial < this.shown) return bitmaps.forEach((bitmap) => bitmap.close());
    this.shown = header.serial;
    this.times.push(performance.now());
    this.onFrame(header, bitmaps);
  }

  // Frames a second of late.
  rate() {
    const from = performance.now() - kRateMs;
    this.times = this.times.filter((time) => time > from);
    if (this.times.length < 2) return 0;
    return (1000 * (this.times.length - 1)) / (this.times.at(-1) - this.times[0]);
  }
}
