// What a page holds of an analysis: blocks, joints, the curve, and the state at any point of it.
// Models of the plane lie in z = 0, so that whoever draws or picks need not know the dimension.

import { POSE, fromVector, multiply, place, turn } from "./rotation.js";

export const OPEN = 0;
export const STICKING = 1;
export const SLIDING = 2;
export const PARTLY_OPEN = 3;

export class Record {
  constructor(header, streams) {
    this.header = header;
    this.dimension = header.dimension;
    this.names = header.blocks.name;
    this.weight = header.blocks.weight;
    this.support = header.blocks.support;
    this.n = this.names.length;
    this.curve = header.curve && header.curve.displacement.length ? header.curve : null;
    this.nPoints = this.curve ? this.curve.displacement.length : 1;
    this.marks = header.marks;
    this.left = new Map(Object.entries(header.left).map(([i, k]) => [Number(i), k]));
    this.centroid = inSpace(streams.centroid);
    this.vertices = inSpace(streams.vertices);
    this.owner = streams.owner.values;
    this.triangles = streams.triangles.values;
    this.edges = streams.edges.values;
    this.initial = this._initial(streams.initial.values);
    this.motion = streams.motion;
    this.motionScale = streams.motion_scale;
    this.joints = new Joints(streams, this);
    this.contacts = Contacts.of(streams);
    this.ties = new Ties(header.ties || [], streams, this);
    this.arrows = header.arrows || [];
    this.box = this._box(() => true);
    this.movable = this._box((i) => !this.support[i]);
    this.extent = this._extent();
    this.grain = this._grain();
    this.size = Math.max(...[0, 1, 2].map((i) => this.box.high[i] - this.box.low[i]));
  }

  _initial(stored) {
    const poses = new Float32Array(this.n * POSE);
    const width = this.dimension === 2 ? 3 : 7;
    for (let i = 0; i < this.n; i++) {
      const [from, at] = [i * width, i * POSE];
      for (let k = 0; k < 3; k++) poses[at + k] = this.centroid[3 * i + k];
      for (let k = 0; k < this.dimension; k++) poses[at + k] += stored[from + k];
      if (this.dimension === 2) {
        fromVector(0, 0, stored[from + 2], poses, at + 4);
      } else {
        for (let k = 0; k < 3; k++) poses[at + 4 + k] = stored[from + 4 + k];
        poses[at + 7] = stored[from + 3];
      }
    }
    return poses;
  }

  /** The box around those blocks, as they are where the load begins. */
  _box(counts) {
    const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    const p = [0, 0, 0];
    for (let v = 0; v < this.owner.length; v++) {
      if (!counts(this.owner[v])) continue;
      this.vertexAt(this.initial, v, p);
      for (let k = 0; k < 3; k++) {
        low[k] = Math.min(low[k], p[k]);
        high[k] = Math.max(high[k], p[k]);
      }
    }
    return { low, high };
  }

  /** The box around all that is drawn as designed: blocks, ends of ties, arrows of dead loads. */
  _extent() {
    const [low, high] = [[...this.box.low], [...this.box.high]];
    const hold = (p) => {
      for (let k = 0; k < 3; k++) {
        low[k] = Math.min(low[k], p[k]);
        high[k] = Math.max(high[k], p[k]);
      }
    };
    for (let i = 0; i < this.ties.n; i++) this.ties.endsAt(this.initial, i).forEach(hold);
    for (const arrow of this.arrows) this.arrowAt(this.initial, arrow).forEach(hold);
    return { low, high };
  }

  /** Tail and tip of the arrow of a dead load in the poses: it keeps its direction. */
  arrowAt(poses, { block, tip, way }) {
    const at = this.carried(poses, block, tip);
    return [at.map((value, k) => value - (way[k] || 0)), at];
  }

  /** A point as designed, carried along by a block; -1 is the ground. */
  carried(poses, block, point) {
    const p = [0, 1, 2].map((k) => point[k] || 0);
    if (block < 0) return p;
    return place(poses, block, ...p.map((value, k) => value - this.centroid[3 * block + k]), [0, 0, 0]);
  }

  /** Distance of the farthest vertex from its centroid, of a block in the middle of all [m]. */
  _grain() {
    const reach = new Float32Array(this.n);
    for (let v = 0; v < this.owner.length; v++) {
      const size = Math.hypot(...this.vertices.subarray(3 * v, 3 * v + 3));
      if (size > reach[this.owner[v]]) reach[this.owner[v]] = size;
    }
    return reach.sort()[this.n >> 1];
  }

  /** Motion of block i since the load began: translation [m] and rotation vector [rad]. */
  motionOf(k, i, out) {
    out.fill(0);
    if (!this.motion) return out;
    const width = this.motion.shape[1];
    for (let c = 0; c < width; c++) {
      const row = k * width + c;
      const scale = this.motionScale ? this.motionScale.values[row] : 1;
      const to = this.dimension === 2 ? [0, 1, 5][c] : c;
      out[to] = scale * this.motion.values[row * this.n + i];
    }
    return out;
  }

  /** Poses of all blocks at point k, displacements taken `factor` times, into `out`. */
  posesAt(k, factor, out = new Float32Array(this.n * POSE)) {
    out.set(this.initial);
    const [motion, turned] = [new Float64Array(6), new Float64Array(4)];
    for (let i = 0; i < this.n; i++) {
      const at = i * POSE;
      out[at + 3] = this.hasLeft(i, k) ? 1 : 0;
      this.motionOf(k, i, motion);
      for (let c = 0; c < 3; c++) out[at + c] += factor * motion[c];
      fromVector(factor * motion[3], factor * motion[4], factor * motion[5], turned, 0);
      multiply(turned, 0, this.initial, at + 4, out, at + 4);
    }
    return out;
  }

  /** Whether block i has left the structure at point k. */
  hasLeft(i, k) {
    return this.left.has(i) && k >= this.left.get(i);
  }

  vertexAt(poses, v, out) {
    const p = this.vertices;
    return place(poses, this.owner[v], p[3 * v], p[3 * v + 1], p[3 * v + 2], out);
  }

  /** Displacement of every vertex since the load began [m], into `out`; returns the largest. */
  displacements(poses, out) {
    const [now, before] = [[0, 0, 0], [0, 0, 0]];
    let largest = 0;
    for (let v = 0; v < this.owner.length; v++) {
      if (poses[this.owner[v] * POSE + 3]) {
        out[v] = 0;
        continue;
      }
      this.vertexAt(poses, v, now);
      this.vertexAt(this.initial, v, before);
      out[v] = Math.hypot(now[0] - before[0], now[1] - before[1], now[2] - before[2]);
      if (out[v] > largest) largest = out[v];
    }
    return largest;
  }

  /** The control point in the poses, and as it was when the load began; null without one. */
  controlPoint(poses) {
    const control = this.header.control;
    if (!control) return null;
    const at = (where) => this.carried(where, control.block, control.point);
    return { start: at(this.initial), now: at(poses) };
  }
}

/** Values (m, dim) with zeros for the third coordinate of the plane. */
function inSpace({ shape, values }) {
  const [m, dim] = shape;
  if (dim === 3) return values;
  const out = new Float32Array(3 * m);
  for (let i = 0; i < m; i++) {
    out[3 * i] = values[2 * i];
    out[3 * i + 1] = values[2 * i + 1];
  }
  return out;
}

export class Joints {
  constructor(streams, record) {
    this.record = record;
    this.a = streams.joint_a.values;
    this.b = streams.joint_b.values;
    this.n = this.a.length;
    this.dim = record.dimension;
    this.centre = inSpace(streams.joint_centre);
    this.axes = streams.joint_frame.values; // rows: normal, tangents
    this.half = streams.joint_half.values;
    this.friction = streams.joint_friction.values;
    this.corners = inSpace(streams.joint_corners);
    this.polygon = streams.joint_polygon.values;
    this.owner = streams.joint_owner.values;
    this.force = streams.force;
    this.forceScale = streams.force_scale;
    this.arm = streams.arm;
    this.armScale = streams.arm_scale;
    this.state = streams.state;
  }

  _value(stream, scale, k, c, j) {
    const row = k * stream.shape[1] + c;
    return (scale ? scale.values[row] : 1) * stream.values[row * this.n + j];
  }

  stateAt(k, j) {
    return this.state ? this.state.values[k * this.n + j] : STICKING;
  }

  /** Component c of an axis (0 the normal) of joint j as designed. */
  axis(j, row) {
    const from = j * this.dim * this.dim + row * this.dim;
    return [this.axes[from], this.axes[from + 1], this.dim === 3 ? this.axes[from + 2] : 0];
  }

  /** The axis of joint j in the poses, carried along by block a. */
  axisAt(poses, j, row, out = [0, 0, 0]) {
    return turn(poses, this.a[j], ...this.axis(j, row), out);
  }

  /** A place on joint j, by arms along its tangents [m]. */
  placeAt(poses, j, arms, out = [0, 0, 0]) {
    const p = [this.centre[3 * j], this.centre[3 * j + 1], this.centre[3 * j + 2]];
    arms.forEach((arm, i) => {
      const axis = this.axis(j, i + 1);
      for (let k = 0; k < 3; k++) p[k] += arm * axis[k];
    });
    return place(poses, this.a[j], ...p, out);
  }

  /** Corner c of the polygons on block a, or on block b, in the poses. */
  cornerAt(poses, j, c, onB, out = [0, 0, 0]) {
    const [a, b, centroid] = [this.a[j], this.b[j], this.record.centroid];
    const p = [0, 1, 2].map((k) => this.corners[3 * c + k]);
    if (onB) for (let k = 0; k < 3; k++) p[k] += centroid[3 * a + k] - centroid[3 * b + k];
    return place(poses, onB ? b : a, ...p, out);
  }

  /** What joint j carries at point k; null where there are no forces, or one block has left. */
  resultantAt(k, j) {
    if (!this.force || this.record.hasLeft(this.a[j], k) || this.record.hasLeft(this.b[j], k)) {
      return null;
    }
    const force = [];
    for (let c = 0; c < this.dim; c++) force.push(this._value(this.force, this.forceScale, k, c, j));
    const arms = [];
    for (let c = 0; c < this.dim - 1; c++) arms.push(this._value(this.arm, this.armScale, k, c, j));
    const [normal, ...shear] = force;
    const tangential = Math.hypot(...shear);
    const friction = this.friction[j];
    return {
      force,
      arms,
      normal,
      tangential,
      size: Math.hypot(...force),
      state: this.stateAt(k, j),
      half: [...this.half.subarray(j * (this.dim - 1), (j + 1) * (this.dim - 1))],
      mobilised: normal > 0 ? tangential / normal : null,
      friction: Number.isFinite(friction) ? friction : null,
    };
  }

  /** Force on block b as a vector, in the poses. */
  vectorAt(poses, j, force) {
    const out = [0, 0, 0];
    force.forEach((value, row) => {
      const axis = this.axisAt(poses, j, row);
      for (let k = 0; k < 3; k++) out[k] += value * axis[k];
    });
    return out;
  }
}

export const SLACK = 0;
export const ELASTIC = 1;
export const YIELDING = 2;
export const BROKEN = 3;

/** Ties and springs between two blocks, or a block and the ground. */
export class Ties {
  constructor(ties, streams, record) {
    this.record = record;
    this.ties = ties;
    this.n = ties.length;
    this.force = streams.tie_force;
    this.state = streams.tie_state;
  }

  /** Both ends of tie i in the poses. */
  endsAt(poses, i) {
    return [this.ties[i].from, this.ties[i].to].map(({ block, point }) =>
      this.record.carried(poses, block, point),
    );
  }

  /** What tie i does at point k; elastic where there is no curve. */
  stateAt(k, i) {
    return this.state ? this.state.values[k * this.n + i] : ELASTIC;
  }

  /** Force in tie i at point k [N], tension positive; its pretension where there is no curve. */
  forceAt(k, i) {
    return this.force ? this.force.values[k * this.n + i] : this.ties[i].pretension;
  }
}

/** Single contact points, of all points of the curve one after the other. */
export class Contacts {
  static of(streams) {
    return streams.contact_count ? new Contacts(streams) : null;
  }

  constructor(streams) {
    this.joint = streams.contact_joint.values;
    this.arm = streams.contact_arm;
    this.force = streams.contact_force;
    this.first = [0];
    for (const count of streams.contact_count.values) {
      this.first.push(this.first[this.first.length - 1] + count);
    }
  }

  /** Calls `tell(joint, arms, force)` for every contact point at point k. */
  each(k, tell) {
    const [width, dim] = [this.arm.shape[1], this.force.shape[1]];
    for (let c = this.first[k]; c < this.first[k + 1]; c++) {
      tell(
        this.joint[c],
        this.arm.values.subarray(c * width, (c + 1) * width),
        this.force.values.subarray(c * dim, (c + 1) * dim),
      );
    }
  }
}
