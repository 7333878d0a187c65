// Asks for the numbers of the pixel under the pointer: at most ten times a second, and of the last
// position in any case.

const kWait = 100; // ms

export class Prober {
  constructor(app) {
    this.app = app;
    this.last = -kWait;
  }

  ask() {
    if (this.timer) return;
    const wait = Math.max(0, kWait - (performance.now() - this.last));
    this.timer = setTimeout(() => {
      this.timer = null;
      this.#send();
    }, wait);
  }

  // Only whole frames have numbers, and while the camera moves the next one is not there yet.
  #send() {
    const { shown, pointer, connection, stopped } = this.app;
    const rests = shown?.header.whole && shown.header.serial === connection.serial;
    if (stopped || !pointer || !rests) return;
    this.last = performance.now();
    const [x, y] = pointer;
    connection.send({ type: "probe", serial: shown.header.serial, x, y });
  }
}
