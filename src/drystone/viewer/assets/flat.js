// The structure without WebGL: painted face after face from the back to the front, simpler, and right
// as long as no face winds around another.

import { css } from "./colours.js";
import { POSE, turn } from "./rotation.js";

export class FlatScene {
  constructor(canvas, record) {
    this.record = record;
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
    this.faces = faces(record);
  }

  resize(width, height, ratio) {
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.ratio = ratio;
  }

  draw({ poses, colours, ribbons, camera, section, opacity }) {
    const { pen, record } = this;
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.fillStyle = "#ffffff";
    pen.fillRect(0, 0, camera.width, camera.height);
    const seen = new Float32Array(record.owner.length * 3);
    const [p, q] = [[0, 0, 0], [0, 0, 0]];
    for (let v = 0; v < record.owner.length; v++) {
      record.vertexAt(poses, v, p);
      seen.set(camera.project(p, q), 3 * v);
    }
    pen.globalAlpha = opacity;
    for (const face of this._order(seen, poses, section)) this._face(face, seen, poses, colours, camera);
    pen.globalAlpha = 1;
    for (let r = 0; r < ribbons.count; r++) this._ribbon(ribbons, r, camera);
  }

  /** Faces that are turned to the viewer and not cut away, those behind first. */
  _order(seen, poses, section) {
    const { record } = this;
    const shown = [];
    const there = [...Array(record.n).keys()].map((i) => {
      const centre = [0, 1, 2].map((k) => poses[i * POSE + k]);
      return !poses[i * POSE + 3] && section.shows(centre);
    });
    for (const face of this.faces) {
      if (!there[face.block]) continue;
      const [a, b, c] = face.rows.slice(0, 3).map((row) => 3 * row);
      const area =
        (seen[b] - seen[a]) * (seen[c + 1] - seen[a + 1]) -
        (seen[c] - seen[a]) * (seen[b + 1] - seen[a + 1]);
      // Pixels go down: what faces us turns clockwise.
      if (record.dimension === 3 && area >= 0) continue;
      let near = 0;
      for (const row of face.rows) near += seen[3 * row + 2];
      shown.push({ ...face, near: near / face.rows.length });
    }
    return shown.sort((one, other) => one.near - other.near);
  }

  _face({ rows, drawn, block, first }, seen, poses, colours, camera) {
    const { pen, record } = this;
    const bright = record.dimension === 2 ? 1 : this._brightness(first, block, poses, camera);
    const mean = [0, 1, 2].map((k) => {
      const sum = rows.reduce((total, row) => total + colours[4 * row + k], 0);
      return Math.min(1, (bright * sum) / rows.length / 255);
    });
    pen.fillStyle = pen.strokeStyle = css(mean);
    pen.lineWidth = 0.6; // closes the seam beside the next face
    pen.beginPath();
    for (const row of rows) pen.lineTo(seen[3 * row], seen[3 * row + 1]);
    pen.closePath();
    pen.fill();
    pen.stroke();
    pen.strokeStyle = "#1f1f1f";
    pen.lineWidth = 0.8;
    pen.beginPath();
    rows.forEach((row, k) => {
      if (!drawn[k]) return;
      const next = rows[(k + 1) % rows.length];
      pen.moveTo(seen[3 * row], seen[3 * row + 1]);
      pen.lineTo(seen[3 * next], seen[3 * next + 1]);
    });
    pen.stroke();
  }

  _brightness(t, i, poses, camera) {
    const normal = turn(poses, i, ...normalOf(this.record, t), [0, 0, 0]);
    const { right, up, towards } = camera.axes;
    let [along, size] = [0, 0];
    for (let k = 0; k < 3; k++) {
      along += normal[k] * (0.75 * towards[k] + 0.55 * up[k] - 0.35 * right[k]);
      size += normal[k] * normal[k];
    }
    return Math.min(1, 0.62 + (0.42 * Math.abs(along)) / Math.sqrt(size || 1));
  }

  _ribbon(ribbons, r, camera) {
    const { pen } = this;
    const [a, b] = [ribbons.start, ribbons.end].map((ends) =>
      camera.project(ends.subarray(3 * r, 3 * r + 3), [0, 0, 0]),
    );
    const [width, head] = [ribbons.style[3 * r], ribbons.style[3 * r + 1]];
    pen.strokeStyle = pen.fillStyle = css([...ribbons.colour.subarray(3 * r, 3 * r + 3)]);
    pen.lineWidth = width;
    pen.beginPath();
    pen.moveTo(a[0], a[1]);
    pen.lineTo(b[0], b[1]);
    pen.stroke();
    if (!head) return;
    const size = Math.hypot(b[0] - a[0], b[1] - a[1]);
    if (size < 1) return;
    const [ux, uy] = [(b[0] - a[0]) / size, (b[1] - a[1]) / size];
    const length = Math.min(4 + 2.2 * width, 0.6 * size);
    pen.beginPath();
    pen.moveTo(b[0], b[1]);
    for (const side of [-1, 1]) {
      const [x, y] = [b[0] - length * ux, b[1] - length * uy];
      pen.lineTo(x - side * 0.42 * length * uy, y + side * 0.42 * length * ux);
    }
    pen.fill();
  }
}

/** Faces of all blocks: triangles in one plane that fan out from one corner, one after the other. */
export function faces(record) {
  const { triangles, owner } = record;
  const edges = new Set();
  const key = (a, b) => Math.min(a, b) * owner.length + Math.max(a, b);
  for (let e = 0; e < record.edges.length; e += 2) {
    edges.add(key(record.edges[e], record.edges[e + 1]));
  }
  const found = [];
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = triangles.subarray(t, t + 3);
    const last = found[found.length - 1];
    const fans = last && last.rows[0] === a && last.rows[last.rows.length - 1] === b;
    if (fans && inOnePlane(record, last.first, t)) last.rows.push(c);
    else found.push({ block: owner[a], first: t, rows: [a, b, c] });
  }
  for (const face of found) {
    const { rows } = face;
    face.drawn = rows.map((row, k) => edges.has(key(row, rows[(k + 1) % rows.length])));
  }
  return found;
}

/** Normal of a triangle of a block as designed, as long as twice its area. */
function normalOf({ vertices, triangles }, t) {
  const [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[t + k]);
  const e = [0, 1, 2].map((k) => vertices[b + k] - vertices[a + k]);
  const f = [0, 1, 2].map((k) => vertices[c + k] - vertices[a + k]);
  return [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
}

function inOnePlane(record, t, u) {
  const [m, n] = [normalOf(record, t), normalOf(record, u)];
  const along = m[0] * n[0] + m[1] * n[1] + m[2] * n[2];
  return along > (1 - 1e-6) * Math.hypot(...m) * Math.hypot(...n);
}
