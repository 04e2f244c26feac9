// Rotations as quaternions [x, y, z, w]; a body's pose is 8 numbers in one array: place, a flag, and
// the quaternion.  All functions write into what they are given and make nothing new.

export const POSE = 8;

/** The quaternion of a rotation vector (rad), into out[at..at + 3]. */
export function fromVector(x, y, z, out, at) {
  const angle = Math.hypot(x, y, z);
  const share = angle > 1e-12 ? Math.sin(0.5 * angle) / angle : 0.5;
  out[at] = share * x;
  out[at + 1] = share * y;
  out[at + 2] = share * z;
  out[at + 3] = Math.cos(0.5 * angle);
}

/** The rotation b, then a: out = a b. */
export function multiply(a, i, b, j, out, at) {
  const [ax, ay, az, aw] = [a[i], a[i + 1], a[i + 2], a[i + 3]];
  const [bx, by, bz, bw] = [b[j], b[j + 1], b[j + 2], b[j + 3]];
  out[at] = aw * bx + ax * bw + ay * bz - az * by;
  out[at + 1] = aw * by - ax * bz + ay * bw + az * bx;
  out[at + 2] = aw * bz + ax * by - ay * bx + az * bw;
  out[at + 3] = aw * bw - ax * bx - ay * by - az * bz;
}

/** A vector turned as body `i` of `poses` is, into `out`. */
export function turn(poses, i, x, y, z, out) {
  const at = i * POSE + 4;
  const [qx, qy, qz, qw] = [poses[at], poses[at + 1], poses[at + 2], poses[at + 3]];
  const tx = 2 * (qy * z - qz * y);
  const ty = 2 * (qz * x - qx * z);
  const tz = 2 * (qx * y - qy * x);
  out[0] = x + qw * tx + qy * tz - qz * ty;
  out[1] = y + qw * ty + qz * tx - qx * tz;
  out[2] = z + qw * tz + qx * ty - qy * tx;
  return out;
}

/** A vector turned back. */
export function turnBack(poses, i, x, y, z, out) {
  const at = i * POSE + 4;
  const [qx, qy, qz, qw] = [-poses[at], -poses[at + 1], -poses[at + 2], poses[at + 3]];
  const tx = 2 * (qy * z - qz * y);
  const ty = 2 * (qz * x - qx * z);
  const tz = 2 * (qx * y - qy * x);
  out[0] = x + qw * tx + qy * tz - qz * ty;
  out[1] = y + qw * ty + qz * tx - qx * tz;
  out[2] = z + qw * tz + qx * ty - qy * tx;
  return out;
}

/** Where a point of body `i`, given from its centroid, is in the poses. */
export function place(poses, i, x, y, z, out) {
  turn(poses, i, x, y, z, out);
  out[0] += poses[i * POSE];
  out[1] += poses[i * POSE + 1];
  out[2] += poses[i * POSE + 2];
  return out;
}

/** The angle of body `i`'s rotation [rad], and its axis in `axis` where one is given. */
export function angle(quaternion, at, axis) {
  const sign = quaternion[at + 3] < 0 ? -1 : 1;
  const [x, y, z] = [0, 1, 2].map((k) => sign * quaternion[at + k]);
  const size = Math.hypot(x, y, z);
  if (axis) [axis[0], axis[1], axis[2]] = size > 0 ? [x / size, y / size, z / size] : [0, 0, 1];
  return 2 * Math.atan2(size, sign * quaternion[at + 3]);
}
