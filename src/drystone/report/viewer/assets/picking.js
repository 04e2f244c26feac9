// What is under a pixel: blocks by the line of sight through their triangles, joints by their
// distance on the screen.

import { POSE, turnBack } from "./rotation.js";

export class Picker {
  constructor(record) {
    this.record = record;
    this.first = firsts(record); // triangles of block i: first[i] to first[i + 1]
    this.radius = new Float32Array(record.n);
    for (let v = 0; v < record.owner.length; v++) {
      const size = Math.hypot(...record.vertices.subarray(3 * v, 3 * v + 3));
      this.radius[record.owner[v]] = Math.max(this.radius[record.owner[v]], size);
    }
  }

  /** The nearest block on a line of sight: { block, distance }, or null. */
  block(poses, ray, section) {
    let best = null;
    const [from, along] = [[0, 0, 0], [0, 0, 0]];
    for (let i = 0; i < this.record.n; i++) {
      if (poses[i * POSE + 3] || !this._near(poses, i, ray)) continue;
      const off = [0, 1, 2].map((k) => ray.origin[k] - poses[i * POSE + k]);
      turnBack(poses, i, ...off, from);
      turnBack(poses, i, ...ray.direction, along);
      for (const distance of this._hits(i, from, along)) {
        if (best && distance >= best.distance) continue;
        const place = [0, 1, 2].map((k) => ray.origin[k] + distance * ray.direction[k]);
        if (!section || section.shows(place)) best = { block: i, distance, place };
      }
    }
    return best;
  }

  _near(poses, i, { origin, direction }) {
    const off = [0, 1, 2].map((k) => poses[i * POSE + k] - origin[k]);
    const along = off[0] * direction[0] + off[1] * direction[1] + off[2] * direction[2];
    const gap2 = off[0] ** 2 + off[1] ** 2 + off[2] ** 2 - along ** 2;
    return gap2 <= this.radius[i] ** 2 * (1 + 1e-3) + 1e-12;
  }

  _hits(i, from, along) {
    const { vertices, triangles } = this.record;
    const found = [];
    for (let t = this.first[i]; t < this.first[i + 1]; t++) {
      const distance = intersection(vertices, triangles, 3 * t, from, along);
      if (distance !== null) found.push(distance);
    }
    return found;
  }

  /** The joint nearest to a pixel, at most `reach` pixels away; hidden ones do not count. */
  joint(poses, camera, x, y, reach, { section = null, hit = null, throughBlocks = false } = {}) {
    const { joints } = this.record;
    const [p, q, a, b] = [[0, 0, 0], [0, 0, 0], [0, 0, 0], [0, 0, 0]];
    let best = null;
    const nearness = hit ? camera.project(hit.place)[2] : -Infinity;
    const slack = 8 * camera.metresPerPixel + 0.01 * this.record.size;
    joints.owner.forEach((j, polygon) => {
      if (poses[joints.a[j] * POSE + 3] || poses[joints.b[j] * POSE + 3]) return;
      const [first, last] = [joints.polygon[polygon], joints.polygon[polygon + 1]];
      for (let c = first; c < last; c++) {
        const next = c + 1 < last ? c + 1 : first;
        joints.cornerAt(poses, j, c, false, p);
        joints.cornerAt(poses, j, next, false, q);
        camera.project(p, a);
        camera.project(q, b);
        const { distance, share } = toSegment(x, y, a, b);
        if (distance > reach || (best && distance >= best.distance)) continue;
        const place = [0, 1, 2].map((k) => p[k] + share * (q[k] - p[k]));
        if (section && !section.shows(place)) continue;
        const depth = a[2] + share * (b[2] - a[2]);
        if (!throughBlocks && depth < nearness - slack) continue;
        best = { joint: j, distance };
      }
    });
    return best;
  }
}

function firsts(record) {
  // Triangles follow each other block by block.
  const first = new Uint32Array(record.n + 1);
  for (let t = 0; t < record.triangles.length; t += 3) first[record.owner[record.triangles[t]] + 1]++;
  for (let i = 0; i < record.n; i++) first[i + 1] += first[i];
  return first;
}

/** How far along the line it meets the triangle (Moeller and Trumbore), or null. */
export function intersection(vertices, triangles, t, from, along) {
  const at = (corner, k) => vertices[3 * triangles[t + corner] + k];
  const [e, f, s] = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
  for (let k = 0; k < 3; k++) {
    e[k] = at(1, k) - at(0, k);
    f[k] = at(2, k) - at(0, k);
    s[k] = from[k] - at(0, k);
  }
  const h = cross(along, f);
  const det = e[0] * h[0] + e[1] * h[1] + e[2] * h[2];
  if (Math.abs(det) < 1e-14) return null;
  const u = (s[0] * h[0] + s[1] * h[1] + s[2] * h[2]) / det;
  if (u < -1e-6 || u > 1 + 1e-6) return null;
  const q = cross(s, e);
  const v = (along[0] * q[0] + along[1] * q[1] + along[2] * q[2]) / det;
  if (v < -1e-6 || u + v > 1 + 1e-6) return null;
  const distance = (f[0] * q[0] + f[1] * q[1] + f[2] * q[2]) / det;
  return distance > 0 ? distance : null;
}

function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}

/** Distance of a pixel to a segment, and the share along it of the nearest place. */
export function toSegment(x, y, a, b) {
  const [dx, dy] = [b[0] - a[0], b[1] - a[1]];
  const size2 = dx * dx + dy * dy;
  const free = size2 > 0 ? ((x - a[0]) * dx + (y - a[1]) * dy) / size2 : 0;
  const share = Math.min(Math.max(free, 0), 1);
  return { distance: Math.hypot(x - a[0] - share * dx, y - a[1] - share * dy), share };
}
