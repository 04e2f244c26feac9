// WebGL in three nouns: buffers of vertices, a texture of numbers, layers that are drawn from them.

/** What is told of every vertex, or of every instance: `size` numbers each. */
export class Attribute {
  constructor(gl, array, size, { perInstance = false, normalized = false } = {}) {
    Object.assign(this, { gl, size, perInstance, normalized });
    this.type = array instanceof Uint8Array ? gl.UNSIGNED_BYTE : gl.FLOAT;
    this.buffer = gl.createBuffer();
    this.write(array);
  }

  /** Other numbers, as many as one likes. */
  write(array) {
    this.gl.bindBuffer(this.gl.ARRAY_BUFFER, this.buffer);
    this.gl.bufferData(this.gl.ARRAY_BUFFER, array, this.gl.DYNAMIC_DRAW);
  }

  attach(place) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, this.size, this.type, this.normalized, 0, 0);
    gl.vertexAttribDivisor(place, this.perInstance ? 1 : 0);
  }
}

/** Rows of texels, four floats each, of which shaders read single ones. */
export class Texels {
  constructor(gl, width, height) {
    Object.assign(this, { gl, width, height });
    this.texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, width, height);
  }

  write(array) {
    const { gl, width, height } = this;
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, height, gl.RGBA, gl.FLOAT, array);
  }
}

/** Triangles or lines, by a program and the attributes that it reads. */
export class Layer {
  constructor(gl, vertex, fragment, attributes, { index = null, lines = false } = {}) {
    this.gl = gl;
    this.mode = lines ? gl.LINES : gl.TRIANGLES;
    this.program = linked(gl, vertex, fragment);
    this.uniforms = uniformsOf(gl, this.program);
    this.array = gl.createVertexArray();
    gl.bindVertexArray(this.array);
    for (const [name, attribute] of Object.entries(attributes)) {
      const place = gl.getAttribLocation(this.program, name);
      if (place >= 0) attribute.attach(place);
    }
    this.count = index ? index.length : null;
    if (index) {
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, index, gl.STATIC_DRAW);
    }
    gl.bindVertexArray(null);
  }

  /** Draw by values of uniforms; `test` and `write`: of the depth buffer; `back`: by how much what
   *  is filled lies behind lines on it. */
  draw(values, { test = true, write = true, back = 0, count = this.count, instances = 1 } = {}) {
    const { gl } = this;
    if (!count || !instances) return;
    gl.useProgram(this.program);
    for (const [name, set] of this.uniforms) set(values[name]);
    (test ? gl.enable : gl.disable).call(gl, gl.DEPTH_TEST);
    gl.depthMask(write);
    (back ? gl.enable : gl.disable).call(gl, gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(back, back);
    gl.bindVertexArray(this.array);
    if (this.count) gl.drawElementsInstanced(this.mode, count, gl.UNSIGNED_INT, 0, instances);
    else gl.drawArraysInstanced(this.mode, 0, count, instances);
    gl.bindVertexArray(null);
  }
}

function linked(gl, vertex, fragment) {
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, `#version 300 es\nprecision highp float;\n${source}`);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw Error(gl.getShaderInfoLog(shader));
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw Error(gl.getProgramInfoLog(program));
  return program;
}

/** What sets each uniform of a program, by name. */
function uniformsOf(gl, program) {
  const setters = {
    [gl.FLOAT]: (place) => (value) => gl.uniform1f(place, value),
    [gl.FLOAT_VEC2]: (place) => (value) => gl.uniform2fv(place, value),
    [gl.FLOAT_VEC3]: (place) => (value) => gl.uniform3fv(place, value),
    [gl.FLOAT_VEC4]: (place) => (value) => gl.uniform4fv(place, value),
    [gl.FLOAT_MAT4]: (place) => (value) => gl.uniformMatrix4fv(place, false, value),
    [gl.SAMPLER_2D]: (place) => (value) => {
      gl.bindTexture(gl.TEXTURE_2D, value.texture);
      gl.uniform1i(place, 0);
    },
  };
  return Array.from({ length: gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS) }, (_, i) => {
    const { name, type } = gl.getActiveUniform(program, i);
    return [name, setters[type](gl.getUniformLocation(program, name))];
  });
}
