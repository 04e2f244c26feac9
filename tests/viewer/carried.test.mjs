// Ties, dead loads, and the axes of supports that move.

import assert from "node:assert/strict";
import { test } from "node:test";

import { DEAD_LOAD, TIE_COLOURS } from "../../src/drystone/report/viewer/assets/colours.js";
import { SLACK, YIELDING } from "../../src/drystone/report/viewer/assets/data.js";
import { motion, ordinate } from "../../src/drystone/report/viewer/assets/format.js";
import { overlay } from "../../src/drystone/report/viewer/assets/overlays.js";
import { carriedLegend, ofLoads, ofPoint, ofTies } from "../../src/drystone/report/viewer/assets/panel.js";
import { Ribbons } from "../../src/drystone/report/viewer/assets/ribbons.js";
import { CARRIED, near, twoSquares } from "./given.mjs";

const drawn = (record, k, show) => {
  const ribbons = new Ribbons();
  overlay(ribbons, record, record.posesAt(k, 1), k, show, null, null);
  return ribbons;
};

test("a tie goes with its block, stays on the ground, and has the colour of its state", () => {
  const record = twoSquares({ angle: 0, carried: CARRIED });
  for (const [k, state, x] of [[0, SLACK, -0.5], [2, YIELDING, -0.4]]) {
    const ribbons = drawn(record, k, { ties: true });
    assert.equal(ribbons.count, 1);
    near([...ribbons.start.slice(0, 3)], [-4, 2, 0]);
    near([...ribbons.end.slice(0, 3)], [x, 2, 0]);
    near([...ribbons.colour.slice(0, 3)], TIE_COLOURS[state]);
  }
});

test("the arrow of a dead load goes with its block and keeps its way", () => {
  const record = twoSquares({ angle: Math.PI / 2, carried: CARRIED });
  const ribbons = drawn(record, 2, { loads: true });
  assert.equal(ribbons.count, 1);
  // The middle of the top was 0.5 m above the centroid (0, 1.5), which is at (0.1, 1.5) now.
  near([...ribbons.end.slice(0, 3)], [-0.4, 1.5, 0]);
  near([...ribbons.start.slice(0, 3)], [-0.4, 1.9, 0]);
  near([...ribbons.colour.slice(0, 3)], DEAD_LOAD);
  const gone = twoSquares({ left: { 1: 2 }, carried: CARRIED });
  assert.equal(drawn(gone, 2, { loads: true }).count, 0);
});

test("the picture's box holds ends of ties and arrows", () => {
  const { extent } = twoSquares({ carried: CARRIED });
  near(extent.low, [-4, 0, 0]);
  near(extent.high, [0.5, 2.4, 0]);
});

test("the panel tells force, strength and state, and where dead loads are", () => {
  const record = twoSquares({ carried: CARRIED });
  assert.deepEqual(ofTies(record, 1), [["rod", "5 kN of 8 kN, elastic"]]);
  assert.deepEqual(ofLoads(record), [["roof", "surcharge, 3 kN on upper, stage 1, with mass"]]);
  const names = carriedLegend(record, 2, { ties: true, loads: true }).map((entry) => entry[1]);
  assert.deepEqual(names, ["yielding tie", "dead load"]);
  assert.deepEqual(carriedLegend(twoSquares(), 0, { ties: true, loads: true }), []);
});

test("supports that move have their motion and reaction", () => {
  const record = twoSquares();
  record.curve.axes = {
    motion: "rotation of the supports", motion_unit: "°", force: "support reaction", force_unit: "N m",
  }; // prettier-ignore
  record.curve.displacement[1] = 2.5;
  record.curve.multiplier[1] = -1200;
  const rows = new Map(ofPoint(record, 1));
  assert.equal(rows.get("rotation of the supports"), "2.5°");
  assert.equal(rows.get("support reaction"), "-1.2 kN m");
  assert.equal(motion({ motion_unit: "m" }, 0.25), "0.25 m");
  assert.equal(ordinate(undefined, 0.25), "0.2500");
});
