// The structure without WebGL, by the processor alone: simpler shading, nothing is seen through.

import { css } from "./colours.js";
import { Raster, packed } from "./raster.js";
import { POSE, turn } from "./rotation.js";

const EDGE = packed([0.12, 0.12, 0.12]);

export class FlatScene {
  constructor(canvas, record) {
    this.record = record;
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
    this.seen = new Float32Array(4 * record.owner.length);
  }

  resize(width, height, ratio) {
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.ratio = ratio;
    this.raster = null;
  }

  draw({ poses, colours, ribbons, camera, section }) {
    const { pen, record } = this;
    pen.setTransform(1, 0, 0, 1, 0, 0);
    if (record.dimension === 3) {
      this._look(poses, camera, section, this.ratio);
      this._solids(poses, colours, camera);
      pen.putImageData(this.raster.image, 0, 0);
      pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    } else {
      pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
      pen.fillStyle = "#ffffff";
      pen.fillRect(0, 0, camera.width, camera.height);
      this._look(poses, camera, section, 1);
      this._outlines(poses, colours);
    }
    for (let r = 0; r < ribbons.count; r++) this._ribbon(ribbons, r, camera);
  }

  /** Where all vertices are in the picture. */
  _look(poses, camera, section, ratio) {
    const { record, seen } = this;
    const plane = section.plane;
    const { right, up, towards } = camera.axes;
    const scale = ratio / camera.metresPerPixel;
    const [p, t] = [[0, 0, 0], camera.target];
    for (let v = 0; v < record.owner.length; v++) {
      record.vertexAt(poses, v, p);
      const [x, y, z] = [p[0] - t[0], p[1] - t[1], p[2] - t[2]];
      seen[4 * v] = 0.5 * ratio * camera.width + scale * (x * right[0] + y * right[1] + z * right[2]);
      seen[4 * v + 1] = 0.5 * ratio * camera.height - scale * (x * up[0] + y * up[1] + z * up[2]);
      seen[4 * v + 2] = x * towards[0] + y * towards[1] + z * towards[2];
      seen[4 * v + 3] = plane ? plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] - plane[3] : 0;
    }
  }

  _solids(poses, colours, camera) {
    const { record, seen } = this;
    if (!this.raster) this.raster = new Raster(this.canvas.width, this.canvas.height);
    this.raster.clear();
    const { triangles, edges, owner } = record;
    for (let t = 0; t < triangles.length; t += 3) {
      const i = owner[triangles[t]];
      if (poses[i * POSE + 3]) continue;
      const bright = this._brightness(t, i, poses, camera);
      const mean = [0, 0, 0];
      for (let corner = 0; corner < 3; corner++) {
        const at = 4 * triangles[t + corner];
        for (let k = 0; k < 3; k++) mean[k] += (bright * colours[at + k]) / 765;
      }
      this.raster.triangle(seen, triangles[t], triangles[t + 1], triangles[t + 2], packed(mean));
    }
    const slack = 1e-3 * record.size;
    for (let e = 0; e < edges.length; e += 2) {
      if (poses[owner[edges[e]] * POSE + 3]) continue;
      this.raster.line(seen, edges[e], edges[e + 1], EDGE, slack);
    }
  }

  _outlines(poses, colours) {
    const { pen, record, seen } = this;
    const { triangles, edges, owner } = record;
    pen.lineWidth = 0.7;
    for (let t = 0; t < triangles.length; t += 3) {
      const v = 4 * triangles[t];
      if (poses[owner[triangles[t]] * POSE + 3]) continue;
      pen.fillStyle = pen.strokeStyle = css([0, 1, 2].map((k) => colours[v + k] / 255));
      pen.beginPath();
      for (let k = 0; k < 3; k++) pen.lineTo(seen[4 * triangles[t + k]], seen[4 * triangles[t + k] + 1]);
      pen.closePath();
      pen.fill();
      pen.stroke(); // closes the seam beside the next triangle
    }
    pen.strokeStyle = "#1f1f1f";
    pen.lineWidth = 0.8;
    pen.beginPath();
    for (let e = 0; e < edges.length; e += 2) {
      if (poses[owner[edges[e]] * POSE + 3]) continue;
      pen.moveTo(seen[4 * edges[e]], seen[4 * edges[e] + 1]);
      pen.lineTo(seen[4 * edges[e + 1]], seen[4 * edges[e + 1] + 1]);
    }
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

/** Normal of a triangle of a block as designed, as long as twice its area. */
function normalOf({ vertices, triangles }, t) {
  const [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[t + k]);
  const e = [0, 1, 2].map((k) => vertices[b + k] - vertices[a + k]);
  const f = [0, 1, 2].map((k) => vertices[c + k] - vertices[a + k]);
  return [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
}
