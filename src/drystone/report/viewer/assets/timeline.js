// Which point of the curve is shown, and playing from one to the next.

export class Timeline {
  constructor(count, changed) {
    Object.assign(this, { count, changed, point: 0, playing: false, rate: 20, _rest: 0 });
  }

  go(point) {
    const wanted = Math.min(Math.max(Math.round(point), 0), this.count - 1);
    if (wanted === this.point) return;
    this.point = wanted;
    this.changed();
  }

  step(by) {
    this.pause();
    this.go(this.point + by);
  }

  toggle() {
    if (this.playing) return this.pause();
    if (this.count < 2) return undefined;
    if (this.point === this.count - 1) this.go(0);
    this.playing = true;
    this._rest = 0;
    return this.changed();
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.changed();
  }

  /** Go on by so many seconds. */
  tick(seconds) {
    if (!this.playing) return;
    this._rest += Math.min(seconds, 0.25) * this.rate;
    const whole = Math.floor(this._rest);
    this._rest -= whole;
    if (whole > 0) this.go(this.point + whole);
    if (this.point === this.count - 1) this.pause();
  }
}
