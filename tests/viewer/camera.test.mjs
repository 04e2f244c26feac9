import assert from "node:assert/strict";
import { test } from "node:test";

import { Camera } from "../../src/drystone/report/viewer/assets/camera.js";
import { Picker } from "../../src/drystone/report/viewer/assets/picking.js";
import { Section } from "../../src/drystone/report/viewer/assets/section.js";
import { near, twoSquares } from "./given.mjs";

const BOX = { low: [-1, -2, 0], high: [3, 2, 4] };

function camera(dimension, direction = null) {
  const made = new Camera(BOX, dimension, direction);
  made.resize(640, 480);
  return made;
}

test("the line of sight through a pixel meets what is projected there", () => {
  const seen = camera(3, [1, 0, 0]);
  seen.orbit(37, -21).pan(15, 8).zoomAt(1.7, 100, 50);
  const p = [0.3, -0.7, 2.2];
  const [x, y, nearness] = seen.project(p);
  const { origin, direction } = seen.ray(x, y);
  const along = seen.depth - nearness;
  near(origin.map((value, k) => value + along * direction[k]), p);
});

test("the matrix of the graphics card and the projection agree", () => {
  const seen = camera(3, [0, -1, 0]);
  const m = seen.matrix;
  const p = [2.5, 1, 3];
  const clip = [0, 1].map((row) => m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row]);
  const [x, y] = seen.project(p);
  near([320 + 320 * clip[0], 240 - 240 * clip[1]], [x, y], 1e-9);
});

test("zooming keeps what is under the pointer", () => {
  for (const dimension of [2, 3]) {
    const seen = camera(dimension);
    const p = [1.2, 0.4, dimension === 3 ? 1.0 : 0];
    const [x, y] = seen.project(p);
    seen.zoomAt(3, x, y);
    near(seen.project(p).slice(0, 2), [x, y], 1e-6);
  }
});

test("the whole structure is in the picture at first, with room around it", () => {
  for (const dimension of [2, 3]) {
    const seen = camera(dimension, [0, -1, 0]);
    for (const x of [-1, 3]) for (const y of [-2, 2]) for (const z of [0, 4]) {
      const [px, py] = seen.project([x, y, z]);
      assert.ok(px > 0 && px < 640 && py > 0 && py < 480, `${[x, y, z]} at ${[px, py]}`);
    }
  }
});

test("what the load pushes comes nearer and goes right", () => {
  for (const load of [[1, 0, 0], [0, -1, 0], [-0.6, 0.8, 0]]) {
    const { right, towards } = camera(3, load).axes;
    assert.ok(right[0] * load[0] + right[1] * load[1] > 0);
    assert.ok(towards[0] * load[0] + towards[1] * load[1] > 0);
  }
});

test("in the plane dragging moves and never turns", () => {
  const seen = camera(2);
  const before = seen.project([0, 0, 0]);
  seen.orbit(10, 5);
  near(seen.project([0, 0, 0]), [before[0] + 10, before[1] + 5, before[2]]);
});

test("a click finds the block it is on, where that block is now", () => {
  const record = twoSquares({ angle: 0 });
  const picker = new Picker(record);
  const seen = new Camera(record.box, 2);
  seen.resize(400, 400);
  const at = (k, p) => {
    const [x, y] = seen.project(p);
    const hit = picker.block(record.posesAt(k, 1), seen.ray(x, y), null);
    return hit && hit.block;
  };
  assert.equal(at(0, [0, 0.5, 0]), 0);
  assert.equal(at(0, [0, 1.5, 0]), 1);
  assert.equal(at(0, [0.55, 1.5, 0]), null);
  assert.equal(at(2, [0.55, 1.5, 0]), 1); // it has moved by 0.1 m
});

test("what a section hides is not found", () => {
  const record = twoSquares();
  const section = new Section(record.box);
  section.axis = 1;
  section.share = 0.5;
  const seen = new Camera(record.box, 2);
  seen.resize(400, 400);
  const [x, y] = seen.project([0, 1.5, 0]);
  assert.equal(new Picker(record).block(record.posesAt(0, 1), seen.ray(x, y), section), null);
});

test("a joint is found within reach of its line, and no farther", () => {
  const record = twoSquares();
  const seen = new Camera(record.box, 2);
  seen.resize(400, 400);
  const [x, y] = seen.project([0.2, 1, 0]);
  const picker = new Picker(record);
  const poses = record.posesAt(0, 1);
  assert.equal(picker.joint(poses, seen, x, y + 4, 5).joint, 0);
  assert.equal(picker.joint(poses, seen, x, y + 6, 5), null);
});
