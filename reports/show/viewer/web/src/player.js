// Plays the recorded path in real time.
import { Spline } from "./spline.js";

export class Player {
  // seconds(): how long the way takes
  constructor(app, seconds) {
    Object.assign(this, { app, seconds, playing: false });
  }

  toggle() {
    if (this.playing) this.stop();
    else if (this.app.keys.length > 0) this.#start();
  }

  stop() {
    this.playing = false;
    this.app.changed();
  }

  #start() {
    this.playing = true;
    const spline = new Spline(this.app.keys);
    const begin = performance.now();
    const step = (now) => {
      if (!this.playing || this.app.stopped) return;
      const share = Math.max(0, now - begin) / 1000 / this.seconds();
      this.app.moveRig({ ...this.app.state.rig, ...spline.at(share) });
      if (share >= 1) return this.stop();
      requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }
}
