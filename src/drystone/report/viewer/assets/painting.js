// Colours of all vertices and joints for the way of colouring that was chosen.

import {
  PALE, RESTING, SELECTED, STATE_COLOURS, SUPPORT, ofLabel, viridis,
} from "./colours.js"; // prettier-ignore

export const PAINTINGS = ["displacement", "macro-blocks", "joint states", "plain"];

/** Paints vertices: bytes r, g, b, a of each, into `out`; returns what the legend says. */
export function paint(record, options, out) {
  const { by, truePoses, displacement, labels, selected } = options;
  const colour = [0, 0, 0];
  let legend = { kind: "none" };
  let tell = (v, i) => copy(record.support[i] ? SUPPORT : RESTING, colour);
  if (by === "displacement") {
    const most = record.displacements(truePoses, displacement);
    legend = { kind: "scale", title: "displacement", most };
    tell = (v, i) => {
      if (record.support[i]) copy(SUPPORT, colour);
      else viridis(most > 0 ? displacement[v] / most : 0, colour);
    };
  } else if (by === "macro-blocks" && labels) {
    legend = { kind: "macro-blocks", count: 1 + Math.max(-1, ...labels) };
    tell = (v, i) => copy(record.support[i] ? SUPPORT : ofLabel(labels[i]), colour);
  } else if (by === "joint states") {
    legend = { kind: "states" };
    tell = (v, i) => copy(record.support[i] ? SUPPORT : PALE, colour);
  }
  for (let v = 0; v < record.owner.length; v++) {
    const i = record.owner[v];
    tell(v, i);
    const share = selected && selected.block === i ? 0.65 : 0;
    for (let k = 0; k < 3; k++) {
      out[4 * v + k] = 255 * ((1 - share) * colour[k] + share * SELECTED[k]);
    }
    out[4 * v + 3] = 255;
  }
  return legend;
}

/** Colours of the joints' faces, by corner. */
export function paintJoints(record, k, out) {
  const { joints } = record;
  joints.owner.forEach((j, polygon) => {
    const colour = STATE_COLOURS[joints.stateAt(k, j)];
    for (let c = joints.polygon[polygon]; c < joints.polygon[polygon + 1]; c++) {
      for (let part = 0; part < 3; part++) out[4 * c + part] = 255 * colour[part];
      out[4 * c + 3] = 150;
    }
  });
}

function copy(from, to) {
  [to[0], to[1], to[2]] = from;
}
