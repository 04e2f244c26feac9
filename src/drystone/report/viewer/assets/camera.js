// From where the structure is seen: a parallel projection that turns about a target.  Angles in
// degrees; azimuth 0 looks along +y, elevation 0 is level.  The plane is seen from +z alone.

const FLATTEST = -89.9;
const STEEPEST = 89.9;

export const VIEWS = {
  front: { azimuth: 0, elevation: 0 },
  right: { azimuth: 90, elevation: 0 },
  back: { azimuth: 180, elevation: 0 },
  left: { azimuth: -90, elevation: 0 },
  top: { azimuth: 0, elevation: STEEPEST },
};

export class Camera {
  constructor(box, dimension, loadDirection = null) {
    this.box = box;
    this.dimension = dimension;
    this.home = dimension === 3 ? oblique(box, loadDirection) : { azimuth: 0, elevation: 0 };
    this.width = 1; // of the picture [px]
    this.height = 1;
    this.reset();
  }

  reset() {
    Object.assign(this, this.home);
    this.target = [0, 1, 2].map((k) => 0.5 * (this.box.low[k] + this.box.high[k]));
    this.zoom = 1;
    this.fitted = this.axes; // the scale stays while one turns
  }

  look(name) {
    Object.assign(this, VIEWS[name] || this.home);
    this.fitted = this.axes;
  }

  resize(width, height) {
    this.width = Math.max(width, 1);
    this.height = Math.max(height, 1);
  }

  /** Unit vectors to the right, up and towards the viewer. */
  get axes() {
    if (this.dimension === 2) return { right: [1, 0, 0], up: [0, 1, 0], towards: [0, 0, 1] };
    const [a, e] = [rad(this.azimuth), rad(this.elevation)];
    const towards = [Math.cos(e) * Math.sin(a), -Math.cos(e) * Math.cos(a), Math.sin(e)];
    const right = [Math.cos(a), Math.sin(a), 0];
    const up = [-Math.sin(e) * Math.sin(a), Math.sin(e) * Math.cos(a), Math.cos(e)];
    return { right, up, towards };
  }

  /** Metres from the middle of the picture to its upper edge. */
  get halfHeight() {
    const { right, up } = this.fitted;
    let [wide, high] = [0, 0];
    for (const corner of corners(this.box)) {
      const off = corner.map((value, k) => value - 0.5 * (this.box.low[k] + this.box.high[k]));
      wide = Math.max(wide, Math.abs(dot(off, right)));
      high = Math.max(high, Math.abs(dot(off, up)));
    }
    const margin = 1.25; // around the structure, so that it may move
    return (margin * Math.max(high, (wide * this.height) / this.width, 1e-9)) / this.zoom;
  }

  /** Metres per pixel. */
  get metresPerPixel() {
    return (2 * this.halfHeight) / this.height;
  }

  /** Radius of everything that is between near and far [m]. */
  get depth() {
    return 20 * Math.hypot(...[0, 1, 2].map((k) => this.box.high[k] - this.box.low[k]));
  }

  /** World to clip space, by columns as graphics cards have it. */
  get matrix() {
    const { right, up, towards } = this.axes;
    const half = this.halfHeight;
    const [sx, sy, sz] = [this.height / (half * this.width), 1 / half, -1 / this.depth];
    const t = this.target;
    return [
      sx * right[0], sy * up[0], sz * towards[0], 0,
      sx * right[1], sy * up[1], sz * towards[1], 0,
      sx * right[2], sy * up[2], sz * towards[2], 0,
      -sx * dot(right, t), -sy * dot(up, t), -sz * dot(towards, t), 1,
    ]; // prettier-ignore
  }

  /** Pixels from the upper left corner, and nearness [m], of a place. */
  project(p, out = [0, 0, 0]) {
    const { right, up, towards } = this.axes;
    const off = [p[0] - this.target[0], p[1] - this.target[1], p[2] - this.target[2]];
    const scale = 1 / this.metresPerPixel;
    out[0] = 0.5 * this.width + scale * dot(off, right);
    out[1] = 0.5 * this.height - scale * dot(off, up);
    out[2] = dot(off, towards);
    return out;
  }

  /** The line of sight through a pixel: where it starts, before everything, and its direction. */
  ray(x, y) {
    const { right, up, towards } = this.axes;
    const scale = this.metresPerPixel;
    const [along, above] = [(x - 0.5 * this.width) * scale, (0.5 * this.height - y) * scale];
    const origin = [0, 1, 2].map(
      (k) => this.target[k] + along * right[k] + above * up[k] + this.depth * towards[k],
    );
    return { origin, direction: towards.map((value) => -value) };
  }

  orbit(dx, dy) {
    if (this.dimension === 2) return this.pan(dx, dy);
    this.azimuth = ((this.azimuth - 0.4 * dx + 540) % 360) - 180;
    this.elevation = Math.min(Math.max(this.elevation + 0.4 * dy, FLATTEST), STEEPEST);
    return this;
  }

  /** Move the picture by pixels. */
  pan(dx, dy) {
    const { right, up } = this.axes;
    const scale = this.metresPerPixel;
    for (let k = 0; k < 3; k++) this.target[k] += scale * (-dx * right[k] + dy * up[k]);
    return this;
  }

  /** Magnify by a factor; what is at the pixel stays there. */
  zoomAt(factor, x = 0.5 * this.width, y = 0.5 * this.height) {
    const before = this.metresPerPixel;
    this.zoom = Math.min(Math.max(this.zoom * factor, 0.05), 500);
    const change = before / this.metresPerPixel - 1;
    return this.pan(-(x - 0.5 * this.width) * change, -(y - 0.5 * this.height) * change);
  }
}

/** A view obliquely from above, so that what the load pushes comes nearer and goes right. */
function oblique(box, direction) {
  const sides = [0, 1].map((k) => box.high[k] - box.low[k]);
  let along = direction ? [direction[0], direction[1]] : [0, 0];
  if (Math.hypot(...along) < 0.2) along = sides[0] >= sides[1] ? [0, -1] : [1, 0];
  const size = Math.hypot(...along);
  along = along.map((value) => value / size);
  const length = Math.abs(along[0]) * sides[0] + Math.abs(along[1]) * sides[1];
  const width = Math.abs(along[1]) * sides[0] + Math.abs(along[0]) * sides[1];
  const away = rad(34 + (34 * length) / Math.max(length + width, 1e-300));
  const level = [
    Math.cos(away) * along[0] + Math.sin(away) * along[1],
    Math.cos(away) * along[1] - Math.sin(away) * along[0],
  ];
  return { azimuth: (180 / Math.PI) * Math.atan2(level[0], -level[1]), elevation: 24 };
}

function corners({ low, high }) {
  const found = [];
  for (const x of [low[0], high[0]])
    for (const y of [low[1], high[1]]) for (const z of [low[2], high[2]]) found.push([x, y, z]);
  return found;
}

function rad(degrees) {
  return (Math.PI / 180) * degrees;
}

export function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
