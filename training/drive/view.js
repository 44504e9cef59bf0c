// Draws MuJoCo's shapes with WebGL 2: boxes, cylinders, capsules, spheres and a floor.

const VERTEX = `#version 300 es
in vec3 place; in vec3 normal;
uniform mat4 model, camera; uniform vec3 size; uniform float point;
out vec3 at, up;
void main() {
  vec4 world = model * vec4(place * size, 1.0);
  at = world.xyz;
  up = mat3(model) * (normal / max(size, vec3(1e-6)));
  gl_Position = camera * world;
  gl_PointSize = point;
}`;
const FRAGMENT = `#version 300 es
precision highp float;
in vec3 at, up; out vec4 result;
uniform vec4 colour; uniform vec3 eye; uniform int look;   // 0 lit, 1 floor, 2 plain
void main() {
  if (look == 2) { result = colour; return; }
  vec3 base = colour.rgb;
  vec3 n = normalize(up);
  if (look == 1) {
    vec2 cell = abs(fract(at.xy - 0.5) - 0.5) / fwidth(at.xy);
    float line = 1.0 - min(min(cell.x, cell.y), 1.0);
    base = mix(vec3(0.80, 0.83, 0.86), vec3(0.70, 0.74, 0.78), line);
    float far = smoothstep(20.0, 70.0, length(at - eye));
    result = vec4(mix(base, vec3(0.875, 0.906, 0.937), far), 1.0);
    return;
  }
  if (dot(n, eye - at) < 0.0) n = -n;
  float sun = max(dot(n, normalize(vec3(0.35, -0.5, 0.8))), 0.0);
  float sky = 0.5 + 0.5 * n.z;
  result = vec4(base * (0.35 + 0.3 * sky + 0.5 * sun), colour.a);
}`;
const SHADOW = [0.1, 0.14, 0.2, 0.22];
const GHOST = [0.05, 0.45, 0.85, 0.32];

export class View {
  constructor(canvas, about) {
    this.canvas = canvas;
    const gl = this.gl = canvas.getContext("webgl2", { alpha: false, stencil: true, preserveDrawingBuffer: true });
    if (!gl) throw new Error("this browser has no WebGL 2");
    const program = this.program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text); gl.compileShader(shader); gl.attachShader(program, shader);
    }
    gl.bindAttribLocation(program, 0, "place"); gl.bindAttribLocation(program, 1, "normal");
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    this.at = {};
    for (const name of ["model", "camera", "size", "colour", "eye", "look", "point"])
      this.at[name] = gl.getUniformLocation(program, name);
    this.meshes = { box: this.mesh(box()), cylinder: this.mesh(tube(24, true)), pipe: this.mesh(tube(16, false)),
                    sphere: this.mesh(ball(16)), plane: this.mesh(sheet()) };
    this.dots = gl.createBuffer();
    this.still = about.still;
    const floor = about.still.find(([kind]) => kind === "plane");
    this.floor = floor ? floor[2][2] : null;
    this.frameCamera(about.camera);
    canvas.addEventListener("pointerdown", e => { canvas.setPointerCapture(e.pointerId); });
    canvas.addEventListener("pointermove", e => { if (e.buttons) this.turn(e); });
    canvas.addEventListener("wheel", e => { e.preventDefault(); this.far *= Math.exp(0.001 * e.deltaY); }, { passive: false });
  }

  // Looks where the scene's own camera looks, at a target in the middle of what moves.
  frameCamera({ place, axes, angle }) {
    const forward = [-axes[2], -axes[5], -axes[8]];
    this.angle = angle * Math.PI / 180;
    this.far = Math.hypot(...place) || 10;
    this.target = place.map((p, i) => p + this.far * forward[i]);
    this.azimuth = Math.atan2(-forward[1], -forward[0]);
    this.height = Math.asin(-forward[2]);
  }

  turn(event) {
    if (event.buttons === 1) {
      this.azimuth -= 0.006 * event.movementX;
      this.height = Math.min(1.5, Math.max(-0.2, this.height + 0.006 * event.movementY));
    } else {
      const [right, up] = this.axes(), step = 0.0014 * this.far;
      this.target = this.target.map((t, i) => t - step * (event.movementX * right[i] - event.movementY * up[i]));
    }
  }

  axes() {
    const [a, h] = [this.azimuth, this.height];
    const back = [Math.cos(h) * Math.cos(a), Math.cos(h) * Math.sin(a), Math.sin(h)];
    const right = [-Math.sin(a), Math.cos(a), 0];
    return [right, cross(back, right), back];
  }

  draw(shapes, ghost, trails) {
    const { gl, canvas, at } = this, ratio = window.devicePixelRatio || 1;
    const [w, h] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (canvas.width !== w || canvas.height !== h) { canvas.width = w; canvas.height = h; }
    gl.viewport(0, 0, w, h);
    gl.clearColor(0.875, 0.906, 0.937, 1); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST); gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.useProgram(this.program);
    const [right, up, back] = this.axes();
    const eye = this.target.map((t, i) => t + this.far * back[i]);
    gl.uniformMatrix4fv(at.camera, false, lens(right, up, back, eye, this.angle, w / h, 0.05 * this.far / 3, 40 * this.far));
    gl.uniform3fv(at.eye, eye);
    gl.uniform1f(at.point, 1);
    for (const shape of this.still) this.shape(shape);
    if (this.floor !== null) {
      // Each pixel of the floor once, however many shapes are above it.
      gl.depthMask(false); gl.enable(gl.STENCIL_TEST);
      gl.stencilFunc(gl.EQUAL, 0, 255); gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
      for (const shape of shapes) this.shape(shape, SHADOW, true);
      gl.depthMask(true); gl.disable(gl.STENCIL_TEST);
    }
    for (const shape of shapes) this.shape(shape);
    for (const { points, colour, size } of trails) this.trail(points, colour, size * ratio);
    if (ghost) { gl.depthMask(false); for (const shape of ghost) this.shape(shape, GHOST); gl.depthMask(true); }
  }

  shape([kind, size, place, m, colour], instead, flat) {
    const { gl, at } = this;
    gl.uniform1i(at.look, kind === "plane" ? 1 : flat ? 2 : 0);
    gl.uniform4fv(at.colour, instead || colour);
    const part = (mesh, scale, move) => {
      const p = place.map((v, i) => v + move * m[3 * i + 2]);
      const matrix = [m[0], m[3], m[6], 0, m[1], m[4], m[7], 0, m[2], m[5], m[8], 0, ...p, 1];
      if (flat) for (let c = 0; c < 4; c++) matrix[4 * c + 2] = c === 3 ? this.floor + 0.01 : 0;
      gl.uniformMatrix4fv(at.model, false, matrix);
      gl.uniform3fv(at.size, scale);
      gl.bindVertexArray(this.meshes[mesh].array);
      gl.drawArrays(gl.TRIANGLES, 0, this.meshes[mesh].count);
    };
    const [r, , half] = size;
    if (kind === "capsule") {
      part("pipe", [r, r, half], 0);
      if (!flat) { part("sphere", [r, r, r], half); part("sphere", [r, r, r], -half); }
    } else if (kind === "plane") part("plane", [200, 200, 1], 0);
    else part(kind, size, 0);
  }

  trail(points, colour, size) {
    if (points.length < 3) return;
    const { gl, at } = this;
    gl.bindVertexArray(null);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.dots);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(points), gl.STREAM_DRAW);
    gl.enableVertexAttribArray(0); gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.disableVertexAttribArray(1);
    gl.uniform1i(at.look, 2); gl.uniform4fv(at.colour, colour); gl.uniform3fv(at.size, [1, 1, 1]);
    gl.uniform1f(at.point, size);
    gl.uniformMatrix4fv(at.model, false, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    gl.drawArrays(gl.LINE_STRIP, 0, points.length / 3);
    gl.drawArrays(gl.POINTS, 0, points.length / 3);
  }

  mesh(triangles) {
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(triangles.flat(2)), gl.STATIC_DRAW);
    for (const i of [0, 1]) { gl.enableVertexAttribArray(i); gl.vertexAttribPointer(i, 3, gl.FLOAT, false, 24, 12 * i); }
    return { array, count: triangles.length };
  }
}

const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

function lens(right, up, back, eye, angle, aspect, near, far) {
  const f = 1 / Math.tan(angle / 2), a = (far + near) / (near - far), b = 2 * far * near / (near - far);
  const [x, y, z] = [right, up, back].map(axis => -dot(axis, eye));
  const column = i => [f / aspect * right[i], f * up[i], a * back[i], -back[i]];
  return [...column(0), ...column(1), ...column(2), f / aspect * x, f * y, a * z + b, -z];
}

// Triangles as lists of vertices, each a place and a normal, of half-width 1.
const quad = (a, b, c, d) => [a, b, c, a, c, d];

function box() {
  const faces = [];
  for (const axis of [0, 1, 2]) for (const sign of [-1, 1]) {
    const n = [0, 0, 0]; n[axis] = sign;
    const corner = (u, v) => { const p = [0, 0, 0]; p[axis] = sign; p[(axis + 1) % 3] = u; p[(axis + 2) % 3] = v; return [p, n]; };
    faces.push(...quad(corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)));
  }
  return faces;
}

function tube(count, closed) {
  const result = [], ring = k => [Math.cos(2 * Math.PI * k / count), Math.sin(2 * Math.PI * k / count)];
  for (let k = 0; k < count; k++) {
    const [[a, b], [c, d]] = [ring(k), ring(k + 1)];
    result.push(...quad([[a, b, -1], [a, b, 0]], [[c, d, -1], [c, d, 0]], [[c, d, 1], [c, d, 0]], [[a, b, 1], [a, b, 0]]));
    if (closed) for (const z of [-1, 1]) result.push([[0, 0, z], [0, 0, z]], [[a, b, z], [0, 0, z]], [[c, d, z], [0, 0, z]]);
  }
  return result;
}

function ball(count) {
  const at = (i, k) => {
    const [t, p] = [Math.PI * i / count, 2 * Math.PI * k / count];
    const v = [Math.sin(t) * Math.cos(p), Math.sin(t) * Math.sin(p), Math.cos(t)];
    return [v, v];
  };
  const result = [];
  for (let i = 0; i < count; i++) for (let k = 0; k < count; k++)
    result.push(...quad(at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)));
  return result;
}

const sheet = () => quad(...[[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => [[x, y, 0], [0, 0, 1]]));
