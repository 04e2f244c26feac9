// Lines of a width in pixels, some with a head: joints, forces, thrust, marks.  One growing set of
// arrays, filled anew for every picture, that either renderer draws.

const GROWTH = 1024;

export class Ribbons {
  constructor() {
    this.count = 0;
    this._allocate(GROWTH);
  }

  _allocate(capacity) {
    const grown = (old, width) => {
      const array = new Float32Array(capacity * width);
      if (old) array.set(old);
      return array;
    };
    this.capacity = capacity;
    this.start = grown(this.start, 3);
    this.end = grown(this.end, 3);
    this.colour = grown(this.colour, 3);
    this.style = grown(this.style, 3); // width [px], head (1 with), in front of everything (1)
  }

  clear() {
    this.count = 0;
  }

  push(start, end, colour, width, { head = false, front = false } = {}) {
    if (this.count === this.capacity) this._allocate(2 * this.capacity);
    const i = this.count++;
    for (let k = 0; k < 3; k++) {
      this.start[3 * i + k] = start[k];
      this.end[3 * i + k] = end[k];
      this.colour[3 * i + k] = colour[k];
    }
    this.style[3 * i] = width;
    this.style[3 * i + 1] = head ? 1 : 0;
    this.style[3 * i + 2] = front ? 1 : 0;
  }
}
