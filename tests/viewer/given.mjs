// A record made by hand: two unit squares one on the other; the upper one turns about its corner.

import { Record } from "../../src/drystone/report/viewer/assets/data.js";

const square = [-0.5, -0.5, 0.5, -0.5, 0.5, 0.5, -0.5, 0.5];

/** Three points; at the last the upper block has turned by `angle` and moved by 0.1 m. */
export function twoSquares({ left = {}, angle = 0.2, carried = {} } = {}) {
  const f4 = (values, ...shape) => ({ shape, values: Float32Array.from(values) });
  const u4 = (values, ...shape) => ({ shape, values: Uint32Array.from(values) });
  // motion: (3 points, 3 components, 2 blocks)
  const motion = [0, 0, 0, 0, 0, 0, 0, 0.05, 0, 0, 0, angle / 2, 0, 0.1, 0, 0, 0, angle];
  const header = {
    dimension: 2,
    origin: [100, 50],
    title: "two",
    blocks: { name: ["lower", "upper"], weight: [1000, 2000], support: [true, false] },
    curve: {
      n_points: 3,
      step: [0, 1, 2],
      displacement: [0, 0.05, 0.1],
      multiplier: [0, 0.4, 0.1],
      dynamic: [false, false, true],
      unstable: [false, false, false],
      residual: [1e-12, 1e-10, 1e-11],
      stop_multiplier: 0.01,
    },
    marks: [{ name: "peak", kind: "peak", displacement: 0.05, multiplier: 0.4, point: 1 }],
    left,
    macro_blocks: {},
    load_direction: [1, 0],
    ...carried,
    control: { block: 1, point: [0.5, 2], direction: [1, 0] },
  };
  return new Record(header, {
    centroid: f4([0, 0.5, 0, 1.5], 2, 2),
    initial: f4([0, 0, 0, 0, 0, 0], 2, 3),
    vertices: f4([...square, ...square], 8, 2),
    owner: u4([0, 0, 0, 0, 1, 1, 1, 1], 8),
    triangles: u4([0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7], 4, 3),
    edges: u4([0, 1, 1, 2, 2, 3, 3, 0, 4, 5, 5, 6, 6, 7, 7, 4], 8, 2),
    motion: f4(motion, 3, 3, 2),
    joint_a: u4([0], 1),
    joint_b: u4([1], 1),
    joint_centre: f4([0, 0.5], 1, 2),
    joint_frame: f4([0, 1, 1, 0], 1, 4),
    joint_half: f4([0.5], 1, 1),
    joint_friction: f4([0.5], 1),
    joint_corners: f4([-0.5, 0.5, 0.5, 0.5], 2, 2),
    joint_polygon: u4([0, 2], 2),
    joint_owner: u4([0], 1),
    force: f4([2000, 0, 2000, 500, 1800, 900], 3, 2, 1),
    arm: f4([0, 0.25, 0.5], 3, 1, 1),
    state: { shape: [3, 1], values: Uint8Array.from([1, 3, 2]) },
    ...(carried.ties && {
      tie_force: f4([0, 5000, 8000], 3, 1),
      tie_state: { shape: [3, 1], values: Uint8Array.from([0, 1, 2]) },
    }),
    contact_count: u4([2, 1, 1], 3),
    contact_joint: u4([0, 0, 0, 0], 4),
    contact_arm: f4([-0.5, 0.5, 0.25, 0.5], 4, 1),
    contact_force: f4([1000, 0, 1000, 0, 2000, 500, 1800, 900], 4, 2),
  });
}

/** A tie from the ground to the upper block's left top corner, and a load on the middle of its top. */
export const CARRIED = {
  ties: [
    {
      name: "rod",
      from: { block: -1, point: [-4, 2] },
      to: { block: 1, point: [-0.5, 2] },
      strength: 8000,
      pretension: 0,
    },
  ],
  dead_loads: [{ name: "roof", kind: "surcharge", on: "upper", force: [0, -3000], mass: true, stage: 1 }],
  arrows: [{ block: 1, tip: [0, 2], way: [0, -0.4] }],
};

export function near(actual, expected, tolerance = 1e-6) {
  const [a, b] = [[actual].flat(3), [expected].flat(3)];
  const apart = a.map((value, i) => Math.abs(value - b[i]));
  if (a.length !== b.length || !apart.every((gap) => gap <= tolerance)) {
    throw new Error(`${JSON.stringify(a)} is not ${JSON.stringify(b)} to ${tolerance}`);
  }
}
