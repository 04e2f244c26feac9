// What stands beside the picture in words: the state that is shown, the block or joint that was
// clicked, the legend.

import {
  DEAD_LOAD, OKABE_ITO, RESTING, STATE_COLOURS, STATE_NAMES, SUPPORT, TIE_COLOURS, TIE_NAMES, css,
  gradient,
} from "./colours.js"; // prettier-ignore
import { degrees, digits, force, length, motion, ordinate } from "./format.js";
import { POSE, angle } from "./rotation.js";

/** Name and value of what is told of a point of the curve. */
export function ofPoint(record, k) {
  const { curve } = record;
  if (!curve) return [["state", "as designed"]];
  const rows = [
    ["point", `${curve.step[k]} of ${curve.n_points - 1}`],
    [curve.axes ? curve.axes.motion : "control displacement", motion(curve.axes, curve.displacement[k])],
    [curve.axes ? curve.axes.force : "load multiplier", ordinate(curve.axes, curve.multiplier[k])],
    ["residual", digits(curve.residual[k], 2)],
  ];
  if (curve.dynamic[k]) rows.push(["state", "dynamic: on the way between states at rest"]);
  else if (curve.unstable[k]) rows.push(["state", "an equilibrium that does not last"]);
  return rows;
}

/** Ties and dead loads of which so many are listed. */
const MOST = 200;

/** Force, strength and state of every tie at point k. */
export function ofTies(record, k) {
  const { ties } = record;
  return ties.ties.slice(0, MOST).map(({ name, strength }, i) => {
    const most = Number.isFinite(strength) && strength !== null ? ` of ${force(strength)}` : "";
    return [name, `${force(ties.forceAt(k, i))}${most}, ${TIE_NAMES[ties.stateAt(k, i)]}`];
  });
}

/** Kind, resultant and place of every dead load. */
export function ofLoads(record) {
  return (record.header.dead_loads || []).slice(0, MOST).map((load) => {
    const size = force(Math.hypot(...load.force));
    const mass = load.mass ? ", with mass" : "";
    return [load.name, `${load.kind}, ${size} on ${load.on}, stage ${load.stage}${mass}`];
  });
}

export function ofBlock(record, k, poses, i) {
  const rows = [
    ["block", record.names[i]],
    ["weight", force(record.weight[i])],
  ];
  if (record.support[i]) rows.push(["", "support"]);
  if (record.hasLeft(i, k)) return [...rows, ["", "has left the structure"]];
  const origin = [...record.header.origin, 0].slice(0, 3);
  const axes = record.dimension === 2 ? [0, 1] : [0, 1, 2];
  const at = axes.map((c) => digits(poses[i * POSE + c] + origin[c], 5)).join(", ");
  const motion = record.motionOf(k, i, new Float64Array(6));
  rows.push(["centroid", `(${at}) m`]);
  if (record.nPoints < 2) return rows;
  rows.push(["moved", axes.map((c) => length(motion[c])).join(", ")]);
  if (record.dimension === 2) rows.push(["turned", degrees(motion[5])]);
  else {
    const axis = [0, 0, 1];
    const quaternion = new Float64Array(4);
    const size = Math.hypot(motion[3], motion[4], motion[5]);
    quaternion.set([...motion.subarray(3).map((w) => w * (size ? Math.sin(size / 2) / size : 0.5)), 0]);
    quaternion[3] = Math.cos(size / 2);
    const turned = angle(quaternion, 0, axis);
    rows.push(["turned", `${degrees(turned)} about (${axis.map((c) => digits(c, 2)).join(", ")})`]);
  }
  return rows;
}

export function ofJoint(record, k, j) {
  const { joints, names } = record;
  const rows = [["joint", `${names[joints.a[j]]} – ${names[joints.b[j]]}`]];
  const friction = joints.friction[j];
  if (Number.isFinite(friction)) rows.push(["friction coefficient", digits(friction, 4)]);
  const resultant = joints.resultantAt(k, j);
  if (!resultant) return rows;
  rows.push(["state", STATE_NAMES[resultant.state]]);
  if (!(resultant.size > 0)) return [...rows, ["resultant", "none"]];
  rows.push(["resultant", force(resultant.size)]);
  rows.push(["normal", force(resultant.normal)], ["tangential", force(resultant.tangential)]);
  resultant.arms.forEach((arm, c) => {
    const whole = 2 * resultant.half[c];
    const share = whole > 0 ? ` = ${digits(arm / whole, 3)} of ${length(whole)}` : "";
    const name = resultant.arms.length > 1 ? `eccentricity ${c + 1}` : "eccentricity";
    rows.push([name, `${length(arm)}${share}`]);
  });
  if (resultant.mobilised !== null) {
    const used = resultant.friction ? ` = ${digits(100 * (resultant.mobilised / resultant.friction), 3)} % of μ` : "";
    rows.push(["mobilised friction", `${digits(resultant.mobilised, 3)}${used}`]);
  }
  return rows;
}

/** Joints of a block. */
export function jointsOf(record, i) {
  const found = [];
  for (let j = 0; j < record.joints.n; j++) {
    if (record.joints.a[j] === i || record.joints.b[j] === i) found.push(j);
  }
  return found;
}

/** A list of names and values. */
export function list(element, rows) {
  const parts = rows.flatMap(([name, value]) => {
    const [dt, dd] = [document.createElement("dt"), document.createElement("dd")];
    dt.textContent = name;
    dd.textContent = value;
    return [dt, dd];
  });
  element.replaceChildren(...parts);
}

/** The legend of how blocks and joints are coloured. */
export function legend(element, shown, joints, more = []) {
  const parts = [];
  if (shown.kind === "scale") {
    const bar = document.createElement("div");
    bar.className = "bar";
    bar.style.background = gradient();
    const ends = document.createElement("div");
    ends.className = "ends";
    for (const words of ["0", "displacement", length(shown.most)]) {
      ends.append(Object.assign(document.createElement("span"), { textContent: words }));
    }
    parts.push(bar, ends);
  }
  if (shown.kind === "macro-blocks") {
    parts.push(swatch(RESTING, "at rest"));
    for (let label = 0; label < shown.count; label++) {
      parts.push(swatch(OKABE_ITO[label % OKABE_ITO.length], `body ${label + 1}`));
    }
  }
  if (shown.kind === "states" || joints) {
    STATE_COLOURS.forEach((colour, state) => parts.push(swatch(colour, STATE_NAMES[state])));
  }
  if (shown.kind !== "none") parts.push(swatch(SUPPORT, "support"));
  for (const [colour, words] of more) parts.push(swatch(colour, words));
  element.replaceChildren(...parts);
}

/** Colours and words of the ties and dead loads that are drawn at point k. */
export function carriedLegend(record, k, show) {
  const found = [];
  const { ties } = record;
  if (show.ties) {
    const states = new Set(ties.ties.map((tie, i) => ties.stateAt(k, i)));
    for (const state of [...states].sort()) found.push([TIE_COLOURS[state], `${TIE_NAMES[state]} tie`]);
  }
  if (show.loads && record.arrows.length) found.push([DEAD_LOAD, "dead load"]);
  return found;
}

function swatch(colour, words) {
  const item = document.createElement("span");
  item.className = "swatch";
  const dot = document.createElement("i");
  dot.style.background = css(colour);
  item.append(dot, words);
  return item;
}
