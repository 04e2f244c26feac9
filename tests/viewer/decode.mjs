// Reads a page's header and streams (JSON on standard input) and tells what the viewer makes of them.

import { decode, inflate } from "../../src/drystone/report/viewer/assets/codec.js";
import { Record } from "../../src/drystone/report/viewer/assets/data.js";

let text = "";
for await (const part of process.stdin) text += part;
const { header, streams, points } = JSON.parse(text);
const decoded = decode(await inflate(streams), header.streams);
const answer = {};
if (points) {
  const record = new Record(header, decoded);
  answer.vertices = points.map((k) => {
    const poses = record.posesAt(k, 1);
    return Array.from(record.owner, (_, v) => record.vertexAt(poses, v, [0, 0, 0]));
  });
  answer.forces = points.map((k) => {
    const poses = record.posesAt(k, 1);
    return Array.from(record.joints.a, (_, j) => {
      const resultant = record.joints.resultantAt(k, j);
      return {
        pair: [record.joints.a[j], record.joints.b[j]],
        force: record.joints.vectorAt(poses, j, resultant.force),
        place: record.joints.placeAt(poses, j, resultant.arms),
      };
    });
  });
} else {
  for (const [name, { values }] of Object.entries(decoded)) answer[name] = Array.from(values);
}
process.stdout.write(JSON.stringify(answer));
