import assert from "node:assert/strict";
import { test } from "node:test";

import { Section } from "../../src/drystone/report/viewer/assets/section.js";
import { ofBlock, ofJoint, ofPoint } from "../../src/drystone/report/viewer/assets/panel.js";
import { near, twoSquares } from "./given.mjs";

test("a block turns about its centroid, its joint with the first block stays", () => {
  const record = twoSquares({ angle: Math.PI / 2 });
  const poses = record.posesAt(2, 1);
  // (-0.5, -0.5) from the centroid becomes (0.5, -0.5); the centroid is at (0.1, 1.5).
  near(record.vertexAt(poses, 4, [0, 0, 0]), [0.6, 1.0, 0]);
  near(record.joints.placeAt(poses, 0, [0.25]), [0.25, 1, 0]);
  near(record.joints.cornerAt(poses, 0, 0, true), [0.6, 1.0, 0]);
});

test("displacements are magnified since the load began, and largest where they are", () => {
  const record = twoSquares({ angle: 0 });
  near([...record.posesAt(2, 10).slice(8, 11)], [1.0, 1.5, 0]);
  const field = new Float32Array(8);
  near(record.displacements(record.posesAt(2, 1), field), 0.1);
  near([...field.slice(0, 4)], [0, 0, 0, 0]);
});

test("a block that has left is away from its point on, with its joints", () => {
  const record = twoSquares({ left: { 1: 2 } });
  assert.equal(record.posesAt(1, 1)[8 + 3], 0);
  assert.equal(record.posesAt(2, 1)[8 + 3], 1);
  assert.equal(record.joints.resultantAt(2, 0), null);
  assert.match(JSON.stringify(ofBlock(record, 2, record.posesAt(2, 1), 1)), /has left/);
});

test("resultants: size, eccentricity and mobilised friction in words", () => {
  const record = twoSquares();
  const resultant = record.joints.resultantAt(1, 0);
  near(resultant.mobilised, 0.25); // 500 N over 2000 N
  near(record.joints.vectorAt(record.posesAt(1, 1), 0, resultant.force), [500, 2000, 0], 1e-3);
  const told = Object.fromEntries(ofJoint(record, 1, 0));
  assert.equal(told.state, "partly open");
  assert.equal(told.eccentricity, "0.25 m = 0.25 of 1 m");
  assert.equal(told["mobilised friction"], "0.25 = 50 % of μ");
});

test("contact points of a point of the curve alone", () => {
  const record = twoSquares();
  const counts = [0, 1, 2].map((k) => {
    let sum = 0;
    record.contacts.each(k, (joint, arms, force) => (sum += force[0]));
    return sum;
  });
  near(counts, [2000, 2000, 1800]);
});

test("what is told of a block has its place in the coordinates of the model", () => {
  const record = twoSquares({ angle: 0.2 });
  const told = Object.fromEntries(ofBlock(record, 2, record.posesAt(2, 1), 1));
  assert.equal(told.centroid, "(100.1, 51.5) m");
  assert.equal(told.weight, "2 kN");
  assert.equal(told.turned, "11.5°"); // 0.2 rad
  assert.match(JSON.stringify(ofPoint(record, 2)), /dynamic/);
});

test("a section shows one side, or the other", () => {
  const section = new Section({ low: [0, 0, 0], high: [2, 2, 2] });
  assert.ok(section.shows([2, 2, 2]));
  section.axis = 1;
  section.share = 0.25;
  assert.ok(section.shows([9, 0.4, 9]) && !section.shows([0, 0.6, 0]));
  section.flipped = true;
  assert.ok(!section.shows([9, 0.4, 9]) && section.shows([0, 0.6, 0]));
});
