// The structure by WebGL.  Geometry is made once: every vertex knows its block, whose pose it looks
// up in a small texture, so that a new state is a new texture and nothing else.

import { Attribute, Layer, Texels } from "./gl.js";
import { POSE } from "./rotation.js";

const WIDTH = 1024; // texels in a row of poses; two a block

const POSED = `
uniform highp sampler2D poses;
uniform mat4 clip;
in vec3 position;
in float owner;
vec3 posed(vec3 arm, out float hidden) {
  int texel = 2 * int(owner + 0.5);
  vec4 where = texelFetch(poses, ivec2(texel % ${WIDTH}, texel / ${WIDTH}), 0);
  vec4 q = texelFetch(poses, ivec2(texel % ${WIDTH} + 1, texel / ${WIDTH}), 0);
  vec3 t = 2.0 * cross(q.xyz, arm);
  hidden = where.w;
  return where.xyz + arm + q.w * t + cross(q.xyz, t);
}`;

const BODY_VERTEX = `${POSED}
in vec4 colour;
out vec4 shade;
out vec3 world;
void main() {
  float hidden;
  world = posed(position, hidden);
  shade = colour;
  gl_Position = hidden > 0.5 ? vec4(2.0, 2.0, 2.0, 1.0) : clip * vec4(world, 1.0);
}`;

const BODY_FRAGMENT = `
uniform vec4 plane;
uniform vec3 light;
uniform float lit;
uniform float opacity;
in vec4 shade;
in vec3 world;
out vec4 pixel;
void main() {
  if (dot(world, plane.xyz) > plane.w) discard;
  vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
  float bright = mix(1.0, 0.62 + 0.42 * abs(dot(normal, light)), lit);
  vec3 colour = shade.rgb * bright;
  // What is seen from within is where the section cuts.
  if (lit > 0.5 && !gl_FrontFacing) colour = mix(shade.rgb, vec3(0.25), 0.35);
  pixel = vec4(colour, shade.a * opacity);
}`;

const LINE_FRAGMENT = `
uniform vec4 plane;
uniform vec3 ink;
in vec4 shade;
in vec3 world;
out vec4 pixel;
void main() {
  if (dot(world, plane.xyz) > plane.w) discard;
  pixel = vec4(ink, 0.75);
}`;

const LINE_VERTEX = BODY_VERTEX.replace(
  "clip * vec4(world, 1.0)",
  "clip * vec4(world, 1.0) - vec4(0.0, 0.0, 2e-6, 0.0)",
);

const RIBBON_VERTEX = `
uniform mat4 clip;
uniform vec2 pixels;
in vec3 position;
in vec3 start;
in vec3 end;
in vec3 colour;
in vec3 style;
out vec3 shade;
void main() {
  vec4 a = clip * vec4(start, 1.0);
  vec4 b = clip * vec4(end, 1.0);
  vec2 along = 0.5 * pixels * (b.xy - a.xy);
  float size = max(length(along), 1e-4);
  along /= size;
  vec2 aside = vec2(-along.y, along.x);
  float head = style.y * min(4.0 + 2.2 * style.x, 0.6 * size);
  // position: share of the way, side, and whether it is of the head.
  bool pointed = position.z > 0.5;
  float way = pointed ? size - head + position.x * head : position.x * (size - head);
  float half_width = pointed ? 0.5 * head * 0.85 : 0.5 * style.x;
  vec2 off = along * way + aside * half_width * position.y;
  float depth = mix(a.z, b.z, clamp(way / size, 0.0, 1.0));
  gl_Position = vec4(a.xy + 2.0 * off / pixels, style.z > 0.5 ? -0.999 : depth - 4e-6, 1.0);
  shade = colour;
}`;

const RIBBON_FRAGMENT = `
in vec3 shade;
out vec4 pixel;
void main() { pixel = vec4(shade, 1.0); }`;

/** Corners of a ribbon, x: share of the way, y: side, z: 1 for those of the head. */
const RIBBON = [
  [0, -1, 0], [1, -1, 0], [1, 1, 0], [0, -1, 0], [1, 1, 0], [0, 1, 0],
  [0, -1, 1], [1, 0, 1], [0, 1, 1],
].flat(); // prettier-ignore

/** What is told of every ribbon. */
const LENGTHS = ["start", "end", "colour", "style"];

/** A WebGL2 context of a canvas, or null. */
export function context(canvas) {
  return canvas.getContext("webgl2", { antialias: true, alpha: false });
}

export class WebScene {
  constructor(canvas, gl, record) {
    Object.assign(this, { canvas, gl, record });
    const rows = Math.max(1, Math.ceil((2 * record.n) / WIDTH));
    this.texels = new Float32Array(4 * WIDTH * rows);
    this.texture = new Texels(gl, WIDTH, rows);
    gl.clearColor(1, 1, 1, 1);
    gl.enable(gl.BLEND);
    gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthFunc(gl.LEQUAL);
    this._bodies();
    this._joints();
    this._ribbons();
  }

  /** Attributes of vertices that blocks carry along. */
  _carried(positions, owners) {
    const { gl } = this;
    return {
      position: new Attribute(gl, positions, 3),
      owner: new Attribute(gl, Float32Array.from(owners), 1),
      colour: new Attribute(gl, new Uint8Array(4 * owners.length), 4, { normalized: true }),
    };
  }

  _bodies() {
    const { gl } = this;
    const { vertices, owner, triangles, edges } = this.record;
    const carried = this._carried(vertices, owner);
    this.colours = carried.colour;
    this.bodies = new Layer(gl, BODY_VERTEX, BODY_FRAGMENT, carried, { index: triangles });
    this.lines = new Layer(gl, LINE_VERTEX, LINE_FRAGMENT, carried, { index: edges, lines: true });
  }

  /** Faces of the joints of solids, carried along by their first blocks. */
  _joints() {
    const { joints, dimension } = this.record;
    if (dimension === 2 || !joints.owner.length) return;
    const owners = new Float32Array(joints.corners.length / 3);
    const index = [];
    joints.owner.forEach((j, polygon) => {
      const [first, last] = [joints.polygon[polygon], joints.polygon[polygon + 1]];
      owners.fill(joints.a[j], first, last);
      for (let c = first + 1; c + 1 < last; c++) index.push(first, c, c + 1);
    });
    const carried = this._carried(joints.corners, owners);
    this.jointColours = carried.colour;
    const triangles = { index: Uint32Array.from(index) };
    this.joints = new Layer(this.gl, BODY_VERTEX, BODY_FRAGMENT, carried, triangles);
  }

  _ribbons() {
    const { gl } = this;
    const position = new Attribute(gl, new Float32Array(RIBBON), 3);
    this.lengths = Object.fromEntries(
      LENGTHS.map((name) => [name, new Attribute(gl, new Float32Array(3), 3, { perInstance: true })]),
    );
    this.ribbons = new Layer(gl, RIBBON_VERTEX, RIBBON_FRAGMENT, { position, ...this.lengths });
  }

  resize(width, height, ratio) {
    this.canvas.width = Math.floor(width * ratio);
    this.canvas.height = Math.floor(height * ratio);
  }

  /** Draw: poses of the blocks, their colours, ribbons over them, as a camera sees it. */
  draw({ poses, colours, jointColours, ribbons, camera, section, opacity }) {
    const { gl, record } = this;
    for (let i = 0; i < record.n; i++) {
      this.texels.set(poses.subarray(i * POSE, (i + 1) * POSE), 8 * i);
    }
    this.texture.write(this.texels);
    this.colours.write(colours);
    const { right, up, towards } = camera.axes;
    const light = [0, 1, 2].map((k) => 0.75 * towards[k] + 0.55 * up[k] - 0.35 * right[k]);
    const solid = record.dimension === 3;
    const values = {
      poses: this.texture,
      clip: camera.matrix,
      plane: section.plane || [0, 0, 0, 1],
      light: light.map((value) => value / Math.hypot(...light)),
      pixels: [camera.width, camera.height],
      lit: solid ? 1 : 0,
      ink: [0.12, 0.12, 0.12],
      opacity,
    };
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.bodies.draw(values, { test: solid, write: opacity >= 1, back: 1 });
    this.lines.draw(values, { test: solid });
    if (this.joints && jointColours) {
      this.jointColours.write(jointColours);
      this.joints.draw({ ...values, lit: 0, opacity: 1 }, { test: false });
    }
    for (const name of LENGTHS) this.lengths[name].write(ribbons[name]);
    const many = { count: RIBBON.length / 3, instances: ribbons.count };
    this.ribbons.draw(values, { test: solid, ...many });
  }
}
