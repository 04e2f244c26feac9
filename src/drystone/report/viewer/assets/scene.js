// The structure by WebGL.  Geometry is made once: every vertex knows its block, whose pose it looks
// up in a small texture, so that a new state is a new texture and nothing else.

import * as THREE from "./three.module.min.js";

import { POSE } from "./rotation.js";

const WIDTH = 1024; // texels in a row of poses; two a block

const POSED = `
uniform sampler2D poses;
uniform mat4 clip;
attribute float owner;
vec3 posed(vec3 arm, out float gone) {
  int texel = 2 * int(owner + 0.5);
  vec4 where = texelFetch(poses, ivec2(texel % ${WIDTH}, texel / ${WIDTH}), 0);
  vec4 q = texelFetch(poses, ivec2(texel % ${WIDTH} + 1, texel / ${WIDTH}), 0);
  vec3 t = 2.0 * cross(q.xyz, arm);
  gone = where.w;
  return where.xyz + arm + q.w * t + cross(q.xyz, t);
}`;

const BODY_VERTEX = `${POSED}
attribute vec4 colour;
varying vec4 shade;
varying vec3 world;
void main() {
  float gone;
  world = posed(position, gone);
  shade = colour;
  gl_Position = gone > 0.5 ? vec4(2.0, 2.0, 2.0, 1.0) : clip * vec4(world, 1.0);
}`;

const BODY_FRAGMENT = `
uniform vec4 plane;
uniform vec3 towards;
uniform vec3 light;
uniform float lit;
uniform float opacity;
varying vec4 shade;
varying vec3 world;
void main() {
  if (dot(world, plane.xyz) > plane.w) discard;
  vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
  float bright = mix(1.0, 0.62 + 0.42 * abs(dot(normal, light)), lit);
  vec3 colour = shade.rgb * bright;
  // What is seen from within is where the section cuts.
  if (lit > 0.5 && !gl_FrontFacing) colour = mix(shade.rgb, vec3(0.25), 0.35);
  gl_FragColor = vec4(colour, shade.a * opacity);
}`;

const LINE_FRAGMENT = `
uniform vec4 plane;
uniform vec3 ink;
varying vec4 shade;
varying vec3 world;
void main() {
  if (dot(world, plane.xyz) > plane.w) discard;
  gl_FragColor = vec4(ink, 0.75);
}`;

const LINE_VERTEX = BODY_VERTEX.replace(
  "clip * vec4(world, 1.0)",
  "clip * vec4(world, 1.0) - vec4(0.0, 0.0, 2e-6, 0.0)",
);

const RIBBON_VERTEX = `
uniform mat4 clip;
uniform vec2 pixels;
attribute vec3 start;
attribute vec3 end;
attribute vec3 colour;
attribute vec3 style;
varying vec3 shade;
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
varying vec3 shade;
void main() { gl_FragColor = vec4(shade, 1.0); }`;

/** Corners of a ribbon, x: share of the way, y: side, z: 1 for those of the head. */
const RIBBON = [
  [0, -1, 0], [1, -1, 0], [1, 1, 0], [0, -1, 0], [1, 1, 0], [0, 1, 0],
  [0, -1, 1], [1, 0, 1], [0, 1, 1],
].flat(); // prettier-ignore

/** A WebGL2 context of a canvas, or null. */
export function context(canvas) {
  return canvas.getContext("webgl2", { antialias: true, alpha: false });
}

export class WebScene {
  constructor(canvas, gl, record) {
    this.record = record;
    this.renderer = new THREE.WebGLRenderer({ canvas, context: gl, antialias: true });
    this.renderer.setClearColor(0xffffff, 1);
    this.scene = new THREE.Scene();
    this.camera = new THREE.Camera();
    const rows = Math.max(1, Math.ceil((2 * record.n) / WIDTH));
    this.texels = new Float32Array(4 * WIDTH * rows);
    this.texture = new THREE.DataTexture(
      this.texels, WIDTH, rows, THREE.RGBAFormat, THREE.FloatType,
    ); // prettier-ignore
    this.texture.minFilter = this.texture.magFilter = THREE.NearestFilter;
    this.uniforms = {
      poses: { value: this.texture },
      clip: { value: new Float32Array(16) },
      plane: { value: [0, 0, 0, 1] },
      towards: { value: [0, 0, 1] },
      light: { value: [0, 0, 1] },
      pixels: { value: [1, 1] },
      lit: { value: record.dimension === 3 ? 1 : 0 },
      ink: { value: [0.12, 0.12, 0.12] },
      opacity: { value: 1 },
    };
    this._bodies();
    this._joints();
    this._ribbons();
  }

  _material(vertexShader, fragmentShader, more = {}) {
    const { uniforms, ...rest } = more;
    return new THREE.ShaderMaterial({
      vertexShader,
      fragmentShader,
      uniforms: { ...this.uniforms, ...uniforms },
      side: THREE.DoubleSide,
      ...rest,
    });
  }

  _add(object, order) {
    object.frustumCulled = false;
    object.renderOrder = order;
    this.scene.add(object);
    return object;
  }

  _geometry(positions, owners) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute("owner", new THREE.BufferAttribute(Float32Array.from(owners), 1));
    const colours = new Uint8Array(4 * owners.length);
    const attribute = new THREE.BufferAttribute(colours, 4, true);
    attribute.setUsage(THREE.DynamicDrawUsage);
    geometry.setAttribute("colour", attribute);
    return geometry;
  }

  _bodies() {
    const { vertices, owner, triangles, edges } = this.record;
    const flat = this.record.dimension === 2;
    const geometry = this._geometry(vertices, owner);
    geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
    this.colours = geometry.getAttribute("colour");
    this.bodyMaterial = this._material(BODY_VERTEX, BODY_FRAGMENT, {
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
      depthTest: !flat,
      transparent: true,
    });
    this._add(new THREE.Mesh(geometry, this.bodyMaterial), 0);
    const lines = new THREE.BufferGeometry();
    for (const name of ["position", "owner", "colour"]) {
      lines.setAttribute(name, geometry.getAttribute(name));
    }
    lines.setIndex(new THREE.BufferAttribute(edges, 1));
    const material = this._material(LINE_VERTEX, LINE_FRAGMENT, {
      transparent: true,
      depthTest: !flat,
    });
    this._add(new THREE.LineSegments(lines, material), 1);
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
    const geometry = this._geometry(joints.corners, owners);
    geometry.setIndex(new THREE.BufferAttribute(Uint32Array.from(index), 1));
    this.jointColours = geometry.getAttribute("colour");
    const material = this._material(BODY_VERTEX, BODY_FRAGMENT, {
      uniforms: { lit: { value: 0 }, opacity: { value: 1 } },
      transparent: true,
      depthTest: false,
    });
    this.jointFaces = this._add(new THREE.Mesh(geometry, material), 2);
  }

  _ribbons() {
    const material = this._material(RIBBON_VERTEX, RIBBON_FRAGMENT, {
      depthTest: this.record.dimension === 3,
      transparent: true,
    });
    this.ribbons = this._add(new THREE.Mesh(new THREE.InstancedBufferGeometry(), material), 3);
  }

  /** Take ribbons over.  Where they have grown the geometry is a new one: three.js draws no more
   *  instances than a geometry had when it was first drawn. */
  _fill(ribbons) {
    if (this.capacity !== ribbons.capacity) {
      this.capacity = ribbons.capacity;
      this.ribbons.geometry.dispose();
      const grown = new THREE.InstancedBufferGeometry();
      grown.setAttribute("position", new THREE.BufferAttribute(new Float32Array(RIBBON), 3));
      for (const name of ["start", "end", "colour", "style"]) {
        const attribute = new THREE.InstancedBufferAttribute(ribbons[name], 3);
        attribute.setUsage(THREE.DynamicDrawUsage);
        grown.setAttribute(name, attribute);
      }
      this.ribbons.geometry = grown;
    }
    const { geometry } = this.ribbons;
    for (const name of ["start", "end", "colour", "style"]) {
      geometry.getAttribute(name).needsUpdate = true;
    }
    geometry.instanceCount = ribbons.count;
    this.ribbons.visible = ribbons.count > 0;
  }

  resize(width, height, ratio) {
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
  }

  /** Draw: poses of the blocks, their colours, ribbons over them, as a camera sees it. */
  draw({ poses, colours, jointColours, ribbons, camera, section, opacity }) {
    for (let i = 0; i < this.record.n; i++) {
      this.texels.set(poses.subarray(i * POSE, (i + 1) * POSE), 8 * i);
    }
    this.texture.needsUpdate = true;
    this.colours.array.set(colours);
    this.colours.needsUpdate = true;
    if (this.jointFaces) {
      this.jointFaces.visible = Boolean(jointColours);
      if (jointColours) {
        this.jointColours.array.set(jointColours);
        this.jointColours.needsUpdate = true;
      }
    }
    this._fill(ribbons);
    const { uniforms } = this;
    const { right, up, towards } = camera.axes;
    uniforms.clip.value.set(camera.matrix);
    uniforms.towards.value = towards;
    const light = [0, 1, 2].map((k) => 0.75 * towards[k] + 0.55 * up[k] - 0.35 * right[k]);
    uniforms.light.value = light.map((value) => value / Math.hypot(...light));
    uniforms.pixels.value = [camera.width, camera.height];
    uniforms.plane.value = section.plane || [0, 0, 0, 1];
    uniforms.opacity.value = opacity;
    this.bodyMaterial.depthWrite = opacity >= 1;
    this.renderer.render(this.scene, this.camera);
  }
}
