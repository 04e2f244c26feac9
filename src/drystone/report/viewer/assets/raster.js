// Triangles and lines with hidden ones hidden, by the processor: a colour and a nearness for every
// pixel.  Vertices are rows of four numbers: x and y [px], nearness, and by how much they are beyond
// the section, which are cut away where that is positive.

export class Raster {
  constructor(width, height) {
    this.width = width;
    this.height = height;
    this.image = new ImageDataLike(width, height);
    this.pixels = new Uint32Array(this.image.data.buffer);
    this.near = new Float32Array(width * height);
  }

  clear() {
    this.pixels.fill(0xffffffff);
    this.near.fill(-Infinity);
  }

  /** Fill a triangle of rows a, b, c of `v` with a packed colour. */
  triangle(v, a, b, c, colour) {
    [a, b, c] = [4 * a, 4 * b, 4 * c];
    const area = (v[b] - v[a]) * (v[c + 1] - v[a + 1]) - (v[c] - v[a]) * (v[b + 1] - v[a + 1]);
    if (Math.abs(area) < 1e-9) return;
    const low = Math.max(0, Math.ceil(Math.min(v[a + 1], v[b + 1], v[c + 1]) - 0.5));
    const high = Math.min(this.height - 1, Math.floor(Math.max(v[a + 1], v[b + 1], v[c + 1]) - 0.5));
    const first = Math.max(0, Math.ceil(Math.min(v[a], v[b], v[c]) - 0.5));
    const last = Math.min(this.width - 1, Math.floor(Math.max(v[a], v[b], v[c]) - 0.5));
    for (let y = low; y <= high; y++) {
      for (let x = first; x <= last; x++) {
        const [px, py] = [x + 0.5 - v[a], y + 0.5 - v[a + 1]];
        const beta = (px * (v[c + 1] - v[a + 1]) - (v[c] - v[a]) * py) / area;
        const gamma = ((v[b] - v[a]) * py - px * (v[b + 1] - v[a + 1])) / area;
        if (beta < 0 || gamma < 0 || beta + gamma > 1) continue;
        const alpha = 1 - beta - gamma;
        if (alpha * v[a + 3] + beta * v[b + 3] + gamma * v[c + 3] > 0) continue;
        const near = alpha * v[a + 2] + beta * v[b + 2] + gamma * v[c + 2];
        const at = y * this.width + x;
        if (near <= this.near[at]) continue;
        this.near[at] = near;
        this.pixels[at] = colour;
      }
    }
  }

  /** A line one pixel wide from row a to row b, hidden by what is nearer by more than `slack`. */
  line(v, a, b, colour, slack) {
    [a, b] = [4 * a, 4 * b];
    const steps = Math.ceil(Math.max(Math.abs(v[b] - v[a]), Math.abs(v[b + 1] - v[a + 1]), 1));
    if (steps > 1e4) return;
    for (let s = 0; s <= steps; s++) {
      const t = s / steps;
      const [x, y] = [Math.floor(v[a] + t * (v[b] - v[a])), Math.floor(v[a + 1] + t * (v[b + 1] - v[a + 1]))];
      if (x < 0 || y < 0 || x >= this.width || y >= this.height) continue;
      if (v[a + 3] + t * (v[b + 3] - v[a + 3]) > 0) continue;
      const at = y * this.width + x;
      if (v[a + 2] + t * (v[b + 2] - v[a + 2]) + slack >= this.near[at]) this.pixels[at] = colour;
    }
  }
}

/** The browser's ImageData, or what is like it where there is none. */
class ImageDataLike {
  constructor(width, height) {
    if (typeof ImageData !== "undefined") return new ImageData(width, height);
    this.data = new Uint8ClampedArray(4 * width * height);
  }
}

/** A colour of parts from 0 to 1 as a pixel holds it. */
export function packed([r, g, b]) {
  const byte = (part) => Math.round(255 * Math.min(Math.max(part, 0), 1));
  return ((255 << 24) | (byte(b) << 16) | (byte(g) << 8) | byte(r)) >>> 0;
}
