// What is drawn over the blocks: joints in their states, forces, thrust, load, control point.

import {
  DEAD_LOAD, FORCE, INK, SELECTED, STATE_COLOURS, THRUST, TIE_COLOURS,
} from "./colours.js"; // prettier-ignore
import { BROKEN, OPEN, SLACK, SLIDING, STICKING, YIELDING } from "./data.js";
import { POSE } from "./rotation.js";

/** Longest arrow of a force, over the structure's size and over that of its blocks. */
const [LONGEST, OF_BLOCKS] = [0.14, 3];
/** Joints up to which lines are as wide as can be. */
const FEW = 300;
/** Forces below this share of the point's largest are not drawn. */
const LEAST = 0.01;
const WIDTHS = { [OPEN]: 2.5, [STICKING]: 1.6, [SLIDING]: 3.5, 3: 2.5 };

/** Fill `ribbons` with what `show` asks for, of point k in the shown poses. */
export function overlay(ribbons, record, poses, k, show, selected, section) {
  ribbons.clear();
  const shown = (p) => !section || section.shows(p);
  if (show.joints) drawJoints(ribbons, record, poses, k, shown);
  if (show.forces) drawForces(ribbons, record, poses, k, shown);
  if (show.thrust) drawThrust(ribbons, record, poses, k, shown);
  if (show.ties) drawTies(ribbons, record, poses, k, shown);
  if (show.loads) drawDeadLoads(ribbons, record, poses, shown);
  if (show.marks) drawControl(ribbons, record, poses);
  if (selected && selected.joint !== undefined) {
    drawSelected(ribbons, record, poses, k, selected.joint);
  }
}

function longest(record) {
  return Math.min(LONGEST * record.size, OF_BLOCKS * record.grain);
}

function present(record, poses, j) {
  const { a, b } = record.joints;
  return !poses[a[j] * POSE + 3] && !poses[b[j] * POSE + 3];
}

function eachSide(record, poses, polygon, onB, tell) {
  const { joints } = record;
  const [j, first, last] = [
    joints.owner[polygon], joints.polygon[polygon], joints.polygon[polygon + 1],
  ]; // prettier-ignore
  const sides = record.dimension === 2 ? 1 : last - first;
  for (let s = 0; s < sides; s++) {
    const next = first + ((s + 1) % (last - first));
    tell(joints.cornerAt(poses, j, first + s, onB), joints.cornerAt(poses, j, next, onB));
  }
}

function drawJoints(ribbons, record, poses, k, shown) {
  const { joints } = record;
  const thin = Math.min(1, Math.max(0.35, Math.sqrt(FEW / joints.n)));
  joints.owner.forEach((j, polygon) => {
    if (!present(record, poses, j)) return;
    const state = joints.stateAt(k, j);
    const colour = STATE_COLOURS[state];
    for (const onB of state === STICKING ? [false] : [false, true]) {
      eachSide(record, poses, polygon, onB, (p, q) => {
        if (shown(p) && shown(q)) ribbons.push(p, q, colour, thin * WIDTHS[state]);
      });
    }
  });
}

const measured = new WeakMap();

/** Largest resultant of a point [N]: the measure of all its arrows. */
export function largest(record, k) {
  const known = measured.get(record);
  if (known && known.k === k) return known.most;
  let most = 0;
  for (let j = 0; j < record.joints.n; j++) {
    const resultant = record.joints.resultantAt(k, j);
    if (resultant) most = Math.max(most, resultant.size);
  }
  measured.set(record, { k, most });
  return most;
}

/** Arrows at contact points, on the block that is pushed; of joints where there are no points. */
function drawForces(ribbons, record, poses, k, shown) {
  const { joints, contacts } = record;
  if (!joints.force) return;
  const scale = longest(record) / (largest(record, k) || 1);
  const arrow = (j, arms, force) => {
    const at = joints.placeAt(poses, j, Array.from(arms));
    const vector = joints.vectorAt(poses, j, Array.from(force));
    if (Math.hypot(...vector) * scale < LEAST * longest(record) || !shown(at)) return;
    const tail = at.map((value, c) => value - scale * vector[c]);
    ribbons.push(tail, at, FORCE, 1.6, { head: true, front: true });
  };
  if (contacts) {
    contacts.each(k, (j, arms, force) => present(record, poses, j) && arrow(j, arms, force));
    return;
  }
  for (let j = 0; j < joints.n; j++) {
    const resultant = joints.resultantAt(k, j);
    if (resultant) arrow(j, resultant.arms, resultant.force);
  }
}

/** Resultants through their centres of pressure; where a block has two, a line joins them. */
function drawThrust(ribbons, record, poses, k, shown) {
  const { joints } = record;
  if (!joints.force) return;
  const most = largest(record, k) || 1;
  const ends = new Map();
  for (let j = 0; j < joints.n; j++) {
    const resultant = joints.resultantAt(k, j);
    if (!resultant || resultant.size < LEAST * most || !(resultant.normal > 0)) continue;
    const at = joints.placeAt(poses, j, resultant.arms);
    const vector = joints.vectorAt(poses, j, resultant.force);
    const half = (0.5 * longest(record)) / most;
    const [p, q] = [-half, half].map((s) => at.map((value, c) => value + s * vector[c]));
    const width = 1.5 + 4.5 * (resultant.size / most);
    if (shown(at)) ribbons.push(p, q, THRUST, width, { front: true });
    for (const i of [joints.a[j], joints.b[j]]) ends.set(i, [...(ends.get(i) || []), at]);
  }
  for (const [i, places] of ends) {
    if (places.length !== 2 || record.support[i] || !places.every(shown)) continue;
    ribbons.push(places[0], places[1], THRUST, 1.4, { front: true });
  }
}

/** Width of a tie by what it does [px]. */
const TIE_WIDTHS = { [SLACK]: 1.5, 1: 3, [YIELDING]: 4, [BROKEN]: 1 };

/** Ties from end to end, before everything: their ends are within blocks. */
function drawTies(ribbons, record, poses, k, shown) {
  const { ties } = record;
  for (let i = 0; i < ties.n; i++) {
    const [p, q] = ties.endsAt(poses, i);
    if (!shown(p) && !shown(q)) continue;
    const state = ties.stateAt(k, i);
    ribbons.push(p, q, TIE_COLOURS[state], TIE_WIDTHS[state], { front: true });
  }
}

/** Arrows of dead loads, on blocks that are there. */
function drawDeadLoads(ribbons, record, poses, shown) {
  for (const arrow of record.arrows) {
    if (poses[arrow.block * POSE + 3]) continue;
    const [tail, tip] = record.arrowAt(poses, arrow);
    if (shown(tip)) ribbons.push(tail, tip, DEAD_LOAD, 2.5, { head: true, front: true });
  }
}

function drawControl(ribbons, record, poses) {
  if (record.header.load_direction) drawLoad(ribbons, record);
  const control = record.controlPoint(poses);
  if (!control) return;
  ribbons.push(control.start, control.now, INK, 1.2, { front: true });
  const arm = 0.012 * record.size;
  const axes = record.dimension === 2 ? [[1, 1, 0], [1, -1, 0]] : [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (const axis of axes) {
    const [p, q] = [-arm, arm].map((s) => control.now.map((value, c) => value + s * axis[c]));
    ribbons.push(p, q, INK, 2.5, { front: true });
  }
}

/** The arrow of the load pattern, beside the structure where the load comes from. */
function drawLoad(ribbons, record) {
  const direction = [0, 1, 2].map((c) => record.header.load_direction[c] || 0);
  const { low, high } = record.movable;
  const middle = low.map((value, c) => 0.5 * (value + high[c]));
  const halves = low.map((value, c) => 0.5 * (high[c] - value));
  const reach = Math.min(
    ...direction.map((d, c) => (Math.abs(d) > 1e-9 ? halves[c] / Math.abs(d) : Infinity)),
  );
  const size = 0.12 * record.size;
  const tip = middle.map((value, c) => value - direction[c] * (reach + 0.4 * size));
  const tail = tip.map((value, c) => value - direction[c] * size);
  ribbons.push(tail, tip, INK, 3, { head: true, front: true });
}

function drawSelected(ribbons, record, poses, k, j) {
  const { joints } = record;
  if (!present(record, poses, j)) return;
  joints.owner.forEach((owner, polygon) => {
    if (owner !== j) return;
    eachSide(record, poses, polygon, false, (p, q) =>
      ribbons.push(p, q, SELECTED, 6, { front: true }),
    );
  });
  const resultant = joints.resultantAt(k, j);
  if (!resultant || !(resultant.size > 0)) return;
  const at = joints.placeAt(poses, j, resultant.arms);
  const vector = joints.vectorAt(poses, j, resultant.force);
  const scale = longest(record) / (largest(record, k) || resultant.size);
  const tail = at.map((value, c) => value - scale * vector[c]);
  ribbons.push(tail, at, SELECTED, 4, { head: true, front: true });
}
