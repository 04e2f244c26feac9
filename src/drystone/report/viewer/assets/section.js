// A section: what lies beyond a plane across one of the axes is not shown.

export class Section {
  constructor(box) {
    this.box = box;
    this.axis = null; // 0, 1, 2, or null where nothing is cut
    this.share = 0.5; // of the box along the axis
    this.flipped = false;
  }

  /** [nx, ny, nz, d]: shown is what has n p <= d; null without a section. */
  get plane() {
    if (this.axis === null) return null;
    const [low, high] = [this.box.low[this.axis], this.box.high[this.axis]];
    const d = low + this.share * (high - low);
    const plane = [0, 0, 0, this.flipped ? -d : d];
    plane[this.axis] = this.flipped ? -1 : 1;
    return plane;
  }

  shows(p) {
    const plane = this.plane;
    return !plane || plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] <= plane[3] + 1e-9;
  }
}
