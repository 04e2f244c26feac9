import assert from "node:assert/strict";
import { test } from "node:test";

import { OKABE_ITO, STATE_COLOURS, viridis } from "../../src/drystone/report/viewer/assets/colours.js";
import { nearestPoint, paths, ticks } from "../../src/drystone/report/viewer/assets/curve.js";
import { force, length } from "../../src/drystone/report/viewer/assets/format.js";
import { KEYS, action, takesKey } from "../../src/drystone/report/viewer/assets/keyboard.js";
import { overlay } from "../../src/drystone/report/viewer/assets/overlays.js";
import { paint } from "../../src/drystone/report/viewer/assets/painting.js";
import { Raster, packed } from "../../src/drystone/report/viewer/assets/raster.js";
import { Ribbons } from "../../src/drystone/report/viewer/assets/ribbons.js";
import { angle, fromVector, multiply } from "../../src/drystone/report/viewer/assets/rotation.js";
import { Timeline } from "../../src/drystone/report/viewer/assets/timeline.js";
import { near, twoSquares } from "./given.mjs";

test("rotations: angle, axis, one after the other", () => {
  const [p, q] = [new Float64Array(4), new Float64Array(4)];
  fromVector(0, 0, 0.3, p, 0);
  fromVector(0, 0, 0.5, q, 0);
  multiply(p, 0, q, 0, q, 0); // in place, as the states do it
  const axis = [0, 0, 0];
  near(angle(q, 0, axis), 0.8);
  near(axis, [0, 0, 1]);
});

test("ticks are round and within", () => {
  assert.deepEqual(ticks(0, 1, 5), [0, 0.2, 0.4, 0.6, 0.8, 1]);
  assert.deepEqual(ticks(0, 0.0872, 4), [0, 0.05]);
  assert.deepEqual(ticks(-0.1, 0.1, 2), [-0.1, 0, 0.1]);
});

test("dragging goes on along the curve where it comes near itself", () => {
  // There and back again: the last points lie on the first ones.
  const xs = [0, 10, 20, 30, 20, 10, 0];
  const ys = [0, 0, 0, 0, 0, 0, 0];
  assert.equal(nearestPoint(19, 0, xs, ys, 1), 2);
  assert.equal(nearestPoint(19, 0, xs, ys, 5), 4);
});

test("the line breaks at dynamic points, jumps go through them", () => {
  const { still, jumps } = paths([0, 1, 2, 3], [0, 1, 2, 3], [false, false, true, false]);
  assert.equal(still, "M0.0 0.0L1.0 1.0M3.0 3.0");
  assert.equal(jumps, "M1.0 1.0L2.0 2.0M2.0 2.0L3.0 3.0");
});

test("the timeline stays within the curve and plays to its end once", () => {
  let told = 0;
  const line = new Timeline(5, () => told++);
  line.go(99);
  assert.equal(line.point, 4);
  line.step(-99);
  assert.equal(line.point, 0);
  line.toggle();
  for (let i = 0; i < 50; i++) line.tick(0.02); // a second at 20 points a second
  assert.equal(line.point, 4);
  assert.equal(line.playing, false);
  line.toggle();
  assert.equal(line.point, 0); // from the beginning again
  assert.ok(told > 5);
});

test("a curve of one point does not play", () => {
  const line = new Timeline(1, () => {});
  line.toggle();
  assert.equal(line.playing, false);
});

test("every key of the help does something, and fields keep theirs", () => {
  for (const { keys } of KEYS) for (const key of keys) assert.ok(action(key), key);
  assert.equal(action("ArrowRight", true).value, 10);
  assert.equal(action("x"), null);
  assert.ok(takesKey({ tagName: "INPUT", type: "text" }, "p"));
  assert.ok(takesKey({ tagName: "INPUT", type: "range" }, "ArrowLeft"));
  assert.ok(!takesKey({ tagName: "INPUT", type: "range" }, "p"));
  assert.ok(!takesKey({ tagName: "CANVAS" }, "ArrowLeft"));
});

test("numbers with their units", () => {
  assert.equal(length(0.0218), "21.8 mm");
  assert.equal(length(0.55636), "0.5564 m");
  assert.equal(length(0), "0 mm");
  assert.equal(force(1234567), "1.235 MN");
  assert.equal(force(2000), "2 kN");
});

test("viridis grows lighter all the way", () => {
  const light = [...Array(50).keys()].map((i) => {
    const [r, g, b] = viridis(i / 49);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  });
  for (let i = 1; i < light.length; i++) assert.ok(light[i] > light[i - 1]);
});

test("states and bodies are told apart without red or green receptors", () => {
  // Machado, Oliveira and Fernandes 2009, severity 1: protanopia, deuteranopia.
  const blind = [
    [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]],
  ];
  for (const matrix of blind) {
    const seen = (colour) => matrix.map((row) => row.reduce((sum, m, k) => sum + m * colour[k], 0));
    for (const colours of [STATE_COLOURS, OKABE_ITO]) {
      colours.forEach((one, i) =>
        colours.slice(0, i).forEach((other) => {
          const [a, b] = [seen(one), seen(other)];
          const apart = Math.hypot(...a.map((value, k) => value - b[k]));
          assert.ok(apart > 0.1, `${one} and ${other}: ${apart}`); // a tenth of black to red
        }),
      );
    }
  }
});

test("ribbons grow beyond their first size", () => {
  const ribbons = new Ribbons();
  for (let i = 0; i < 3000; i++) ribbons.push([i, 0, 0], [i, 1, 0], [0, 0, 1], 2);
  assert.equal(ribbons.count, 3000);
  near([...ribbons.start.slice(3 * 2999, 3 * 3000)], [2999, 0, 0]);
});

test("what is shown over the blocks is what was asked for", () => {
  const record = twoSquares();
  const ribbons = new Ribbons();
  const count = (show, selected = null) => {
    overlay(ribbons, record, record.posesAt(1, 1), 1, show, selected, null);
    return ribbons.count;
  };
  assert.equal(count({}), 0);
  assert.equal(count({ joints: true }), 2); // partly open: on both blocks
  assert.equal(count({ forces: true }), 1); // one contact point
  assert.equal(count({ thrust: true }), 1);
  assert.equal(count({ marks: true }), 4); // way, cross, load
  assert.equal(count({}, { joint: 0 }), 2);
});

test("an arrow of a force ends where the force acts and points where it pushes", () => {
  const record = twoSquares();
  const ribbons = new Ribbons();
  overlay(ribbons, record, record.posesAt(1, 1), 1, { forces: true }, null, null);
  near([...ribbons.end.slice(0, 3)], [0.25, 1, 0]);
  const way = [0, 1].map((k) => ribbons.end[k] - ribbons.start[k]);
  near(way[0] / way[1], 500 / 2000, 1e-5);
});

test("colours: supports grey, the farthest brightest, the selected one marked", () => {
  const record = twoSquares({ angle: 0 });
  const out = new Uint8Array(32);
  const options = { by: "displacement", truePoses: record.posesAt(2, 1), displacement: new Float32Array(8) };
  const shown = paint(record, options, out);
  near(shown.most, 0.1);
  assert.deepEqual([...out.slice(0, 3)], [184, 184, 184]);
  near([...out.slice(16, 19)], viridis(1).map((part) => 255 * part), 1);
  paint(record, { ...options, selected: { block: 1 } }, out);
  assert.ok(out[18] > 100); // its blue: yellow has hardly any
});

test("the processor's picture: the nearer one is seen, the section cuts", () => {
  const raster = new Raster(20, 20);
  raster.clear();
  const [red, blue] = [packed([1, 0, 0]), packed([0, 0, 1])];
  // Two triangles over the whole picture; the second is nearer on the right, and cut below y = 10.
  const v = Float32Array.from([
    -30, -30, 0, 0, 50, -30, 0, 0, 10, 60, 0, 0,
    -30, -30, -40, -40, 50, -30, 40, -40, 10, 60, 0, 50,
  ]); // prettier-ignore
  raster.triangle(v, 0, 1, 2, red);
  raster.triangle(v, 3, 4, 5, blue);
  const at = (x, y) => raster.pixels[20 * y + x];
  assert.equal(at(2, 5), red);
  assert.equal(at(17, 5), blue);
  assert.equal(at(17, 15), red);
  raster.line(v, 0, 1, blue, 0);
  assert.equal(at(2, 5), red); // the line lies outside of the picture
});
