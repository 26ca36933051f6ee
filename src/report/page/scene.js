// The model in three dimensions: numbers of the page, camera, WebGL.

// Whole numbers from their steps, rows of so many columns.
function unpack(text, columns) {
  const coded = atob(text), bytes = new Uint8Array(coded.length);
  let n = 0;
  for (let i = 0; i < bytes.length; i++) { bytes[i] = coded.charCodeAt(i); if (bytes[i] < 128) n++; }
  const out = new Int32Array(n);
  for (let i = 0, at = 0; i < n; i++) {
    let v = 0, size = 1, b;
    do { b = bytes[at++]; v += (b & 127) * size; size *= 128; } while (b > 127);
    out[i] = (i >= columns ? out[i - columns] : 0) + (v % 2 ? -(v + 1) / 2 : v / 2);
  }
  return out;
}

const V = {
  sub: (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]],
  along: (a, d, s) => [a[0] + s * d[0], a[1] + s * d[1], a[2] + s * d[2]],
  dot: (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
  cross: (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]],
  unit: (a) => { const n = Math.hypot(a[0], a[1], a[2]) || 1; return [a[0] / n, a[1] / n, a[2] / n]; },
};

// Points and faces of all parts. Places are kept about the middle of the model: 32 bits are then fine enough.
function meshOf(data) {
  const middle = data.box[0].map((v, k) => (v + data.box[1][k]) / 2);
  const place = (steps) => Float32Array.from(steps, (v, i) => data.origin[i % 3] + v * data.step - middle[i % 3]);
  const parts = data.parts.map((p) => ({
    name: p.name, whole: p.whole, xyz: place(unpack(p.points, 3)), faces: unpack(p.faces, 4), grids: unpack(p.grids, 1),
    elements: p.elements ? unpack(p.elements, 1) : null, properties: p.elements ? unpack(p.properties, 1) : null, middles: p.middles ? unpack(p.middles, 4) : null,
  }));
  let nv = 0, nf = 0, corners = 0;
  for (const p of parts) {
    Object.assign(p, { vertex: nv, face: nf, nFaces: p.faces.length / 4, first: corners });
    nv += p.grids.length;
    nf += p.nFaces;
    for (let f = 0; f < p.nFaces; f++) corners += p.faces[4 * f + 2] === p.faces[4 * f + 3] ? 3 : 6;
    p.count = corners - p.first;
  }
  const m = {
    middle, parts, middleStep: data.middle_step, nFaces: nf, xyz: new Float32Array(3 * nv), grids: new Int32Array(nv), faces: new Int32Array(4 * nf), part: new Uint16Array(nf),
    normal: new Float32Array(3 * nf), centre: new Float32Array(3 * nf), radius: new Float32Array(nf), start: new Int32Array(nf + 1), vertexOf: new Int32Array(corners),
    edges: place(unpack(data.edges, 3)), bars: place(unpack(data.bars, 3)),
  };
  let at = 0;
  parts.forEach((p, n) => {
    m.xyz.set(p.xyz, 3 * p.vertex);
    m.grids.set(p.grids, p.vertex);
    for (let f = 0; f < p.nFaces; f++) {
      const g = p.face + f, c = [0, 1, 2, 3].map((k) => p.faces[4 * f + k] + p.vertex), quad = c[2] !== c[3];
      m.faces.set(c, 4 * g);
      m.part[g] = n;
      m.start[g] = at;
      for (const k of quad ? [0, 1, 2, 0, 2, 3] : [0, 1, 2]) m.vertexOf[at++] = c[k];
      const x = c.map((v) => vertexAt(m, v));
      const normal = V.unit(quad ? V.cross(V.sub(x[2], x[0]), V.sub(x[3], x[1])) : V.cross(V.sub(x[1], x[0]), V.sub(x[2], x[0])));
      const sum = (k) => (x[0][k] + x[1][k] + x[2][k] + (quad ? x[3][k] : 0)) / (quad ? 4 : 3);
      const centre = [sum(0), sum(1), sum(2)];
      m.normal.set(normal, 3 * g);
      m.centre.set(centre, 3 * g);
      m.radius[g] = Math.max(...x.map((p) => Math.hypot(...V.sub(p, centre))));
    }
  });
  m.start[nf] = at;
  return m;
}

const vertexAt = (m, v) => [m.xyz[3 * v], m.xyz[3 * v + 1], m.xyz[3 * v + 2]];
const centreOf = (m, f) => [m.centre[3 * f], m.centre[3 * f + 1], m.centre[3 * f + 2]];
const normalOf = (m, f) => [m.normal[3 * f], m.normal[3 * f + 1], m.normal[3 * f + 2]];

// Where a ray meets a face: of its triangles the nearer; where it passes by, its plane.
function onFace(m, f, from, along) {
  const x = [0, 1, 2, 3].map((k) => vertexAt(m, m.faces[4 * f + k]));
  for (const [a, b, c] of [[x[0], x[1], x[2]], [x[0], x[2], x[3]]]) {
    const u = V.sub(b, a), v = V.sub(c, a), p = V.cross(along, v), det = V.dot(u, p);
    if (Math.abs(det) < 1e-30) continue;
    const t = V.sub(from, a), s = V.dot(t, p) / det, q = V.cross(t, u), r = V.dot(along, q) / det;
    if (s >= -1e-6 && r >= -1e-6 && s + r <= 1 + 1e-6) return V.along(from, along, V.dot(v, q) / det);
  }
  return null;
}

// The face that is seen at a pixel of a picture of numbers, -1 where none is.
function faceIn({ w, h, list }, x, y) {
  const c = Math.floor(x), r = h - 1 - Math.floor(y);
  return c >= 0 && r >= 0 && c < w && r < h ? (list[r * w + c] & 0xffffff) - 1 : -1;
}

// A camera that turns about a point, z up.
function cameraOf(size) {
  const half = Math.tan(Math.PI / 8);
  const c = { yaw: 0, pitch: 0, far: size, target: [0, 0, 0], width: 1, height: 1 };
  c.frame = () => {
    const e = [Math.cos(c.pitch) * Math.cos(c.yaw), Math.cos(c.pitch) * Math.sin(c.yaw), Math.sin(c.pitch)];
    const right = [-Math.sin(c.yaw), Math.cos(c.yaw), 0];
    return { e, right, up: V.cross(e, right), eye: V.along(c.target, e, c.far) };
  };
  // Column by column, as WebGL takes it.
  c.matrix = () => {
    const { e, right, up, eye } = c.frame(), aspect = c.width / c.height;
    const near = Math.max(c.far - size - Math.hypot(...c.target), 0.01 * c.far), far = c.far + 1.2 * size + Math.hypot(...c.target), a = 1 / (half * aspect), b = 1 / half;
    const p = (far + near) / (far - near), q = 2 * far * near / (far - near);
    const row = (v, s) => [v[0] * s, v[1] * s, v[2] * s, -V.dot(v, eye) * s];
    const x = row(right, a), y = row(up, b), back = row(e, 1);
    const z = back.map((v, k) => -p * v - (k === 3 ? q : 0)), w = back.map((v) => -v);
    const out = new Float32Array(16);
    for (let k = 0; k < 4; k++) { out[4 * k] = x[k]; out[4 * k + 1] = y[k]; out[4 * k + 2] = z[k]; out[4 * k + 3] = w[k]; }
    return out;
  };
  // Pixels, and how far away.
  c.project = (p) => {
    const { e, right, up, eye } = c.frame(), d = V.sub(p, eye), away = -V.dot(d, e), s = c.height / (2 * half * away);
    // What is behind the eye is nowhere.
    return away > 0 ? [c.width / 2 + V.dot(d, right) * s, c.height / 2 - V.dot(d, up) * s, away] : [NaN, NaN, away];
  };
  c.ray = (x, y) => {
    const { e, right, up, eye } = c.frame(), s = 2 * half / c.height;
    const d = V.along(V.along(V.along([0, 0, 0], e, -1), right, (x - c.width / 2) * s), up, -(y - c.height / 2) * s);
    return [eye, V.unit(d)];
  };
  c.pixel = (away) => 2 * half * away / c.height;
  c.pan = (dx, dy) => {
    const { right, up } = c.frame(), s = c.pixel(c.far);
    c.target = V.along(V.along(c.target, right, -dx * s), up, dy * s);
  };
  // By a factor, about a place of the picture.
  c.zoom = (factor, x, y) => {
    const f = Math.min(40 * size / c.far, Math.max(2e-4 * size / c.far, factor)), dx = x - c.width / 2, dy = y - c.height / 2;
    c.pan(-dx * (1 - f), -dy * (1 - f));
    c.far *= f;
  };
  c.turn = (dx, dy) => {
    c.yaw -= 0.008 * dx;
    c.pitch = Math.min(1.5706, Math.max(-1.5706, c.pitch + 0.008 * dy));
  };
  // As near as shows all of these points.
  c.look = (name, points) => {
    const to = V.unit({ iso: [1.1, -1.5, 0.95], x: [1, 0, 0], y: [0, -1, 0], z: [0, -0.0002, 1] }[name]);
    c.yaw = Math.atan2(to[1], to[0]);
    c.pitch = Math.asin(to[2]);
    c.target = [0, 0, 0];
    const { e, right, up } = c.frame(), wide = 0.96 * half * c.width / c.height, high = 0.94 * half;
    for (let pass = 0; pass < 3; pass++) {
      const seen = points.map((p) => { const q = V.sub(p, c.target); return [V.dot(q, e), V.dot(q, right), V.dot(q, up)]; });
      c.far = seen.reduce((f, [d, x, y]) => Math.max(f, d + Math.abs(x) / wide, d + Math.abs(y) / high), 1e-3 * size);
      if (pass === 2) break;
      const middle = (k) => {
        let lo = Infinity, hi = -Infinity;
        for (const q of seen) { const a = q[k] / (c.far - q[0] + 1e-9 * size); lo = Math.min(lo, a); hi = Math.max(hi, a); }
        return 0.5 * c.far * (lo + hi);
      };
      c.target = V.along(V.along(c.target, right, middle(1)), up, middle(2));
    }
  };
  return c;
}

// Faces and arrows: lit from the eye, coloured by their value where they have one.
const FACES = [`#version 300 es
in vec3 at; in vec3 normal; in float value; in vec4 base; in vec4 tint;
uniform mat4 view; uniform vec3 eye;
out float v; out vec4 b; out vec4 t; out float lit;
void main() { gl_Position = view * vec4(at, 1.0); v = value; b = base; t = tint; lit = abs(dot(normalize(normal), normalize(eye - at))); }`, `#version 300 es
precision highp float;
in float v; in vec4 b; in vec4 t; in float lit;
uniform vec3 stops[5]; uniform vec2 ends;
out vec4 colour;
void main() {
  bool bare = v > 1e20;
  float s = clamp((v - ends.x) / (ends.y - ends.x), 0.0, 1.0) * 4.0;
  int k = min(int(s), 3);
  vec3 c = bare ? b.rgb : mix(stops[k], stops[k + 1], s - float(k));
  c = mix(c, t.rgb, t.a);
  colour = vec4(c * (bare ? 0.55 + 0.45 * lit : 0.78 + 0.22 * lit), 1.0);
}`];
// Faces by number.
const NUMBERS = [`#version 300 es
in vec3 at; in vec4 id; uniform mat4 view; flat out vec4 c;
void main() { gl_Position = view * vec4(at, 1.0); c = id; }`, `#version 300 es
precision highp float; flat in vec4 c; out vec4 colour; void main() { colour = c; }`];
// Lines some pixels wide, a little before what they lie on.
const LINES = [`#version 300 es
in vec3 at; in vec3 other; in float side; uniform mat4 view; uniform vec2 size; uniform float width;
void main() {
  vec4 p = view * vec4(at, 1.0), q = view * vec4(other, 1.0);
  vec2 d = (q.xy / q.w - p.xy / p.w) * size;
  vec2 n = length(d) > 0.0 ? normalize(vec2(-d.y, d.x)) : vec2(1.0, 0.0);
  p.xy += n * side * width / size * p.w;
  p.z -= 2e-4 * p.w;
  gl_Position = p;
}`, `#version 300 es
precision highp float; uniform vec4 ink; out vec4 colour; void main() { colour = ink; }`];
// Discs.
const DISCS = [`#version 300 es
in vec3 at; in vec4 base; in float disc; uniform mat4 view; uniform float ratio; out vec4 b; out float r;
void main() { gl_Position = view * vec4(at, 1.0); gl_Position.z -= 1e-3 * gl_Position.w; gl_PointSize = disc * ratio; b = base; r = disc; }`, `#version 300 es
precision highp float; in vec4 b; in float r; out vec4 colour;
void main() {
  float d = length(gl_PointCoord - 0.5) * 2.0;
  if (d > 1.0) discard;
  colour = b.a > 0.99 && d > 1.0 - 2.4 / r ? vec4(1.0) : b;
}`];

function painter(canvas) {
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
  if (!gl) return null;
  const program = ([vertex, fragment]) => {
    const p = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const s = gl.createShader(kind);
      gl.shaderSource(s, text);
      gl.compileShader(s);
      gl.attachShader(p, s);
    }
    gl.linkProgram(p);
    if (!gl.getProgramParameter(p, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(p));
    return p;
  };
  const out = { gl, faces: program(FACES), numbers: program(NUMBERS), lines: program(LINES), discs: program(DISCS) };
  // Arrays on the card: name to columns and kind; bytes count as shares of 255.
  out.arrays = (lists) => {
    const set = { n: 0 };
    for (const [name, [list, columns, signed]] of Object.entries(lists)) {
      const buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, list, gl.DYNAMIC_DRAW);
      set[name] = { buffer, columns, kind: list instanceof Float32Array ? gl.FLOAT : signed ? gl.BYTE : gl.UNSIGNED_BYTE };
      set.n = list.length / columns;
    }
    return set;
  };
  out.refill = (entry, list) => { gl.bindBuffer(gl.ARRAY_BUFFER, entry.buffer); gl.bufferData(gl.ARRAY_BUFFER, list, gl.DYNAMIC_DRAW); };
  out.free = (set) => { for (const e of Object.values(set)) if (e.buffer) gl.deleteBuffer(e.buffer); };
  out.use = (p, set, uniforms) => {
    gl.useProgram(p);
    for (let i = 0; i < 6; i++) gl.disableVertexAttribArray(i);
    for (const [name, e] of Object.entries(set)) {
      const at = e.buffer ? gl.getAttribLocation(p, name) : -1;
      if (at < 0) continue;
      gl.bindBuffer(gl.ARRAY_BUFFER, e.buffer);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, e.columns, e.kind, e.kind !== gl.FLOAT, 0, 0);
    }
    for (const [name, v] of Object.entries(uniforms)) {
      const at = gl.getUniformLocation(p, name);
      if (v.length === 16) gl.uniformMatrix4fv(at, false, v);
      else if (v.length === 15) gl.uniform3fv(at, v);
      else if (v.length) gl["uniform" + v.length + "fv"](at, v);
      else gl.uniform1f(at, v);
    }
  };
  // Two triangles a line.
  out.strokes = (xyz) => {
    const n = xyz.length / 6, at = new Float32Array(18 * n), other = new Float32Array(18 * n), side = new Float32Array(6 * n);
    for (let i = 0; i < n; i++) [[0, 1], [0, -1], [1, 1], [1, 1], [0, -1], [1, -1]].forEach(([end, s], k) => {
      for (let c = 0; c < 3; c++) {
        at[18 * i + 3 * k + c] = xyz[6 * i + 3 * end + c];
        other[18 * i + 3 * k + c] = xyz[6 * i + 3 * (1 - end) + c];
      }
      side[6 * i + k] = end ? -s : s;
    });
    return out.arrays({ at: [at, 3], other: [other, 3], side: [side, 1] });
  };
  return out;
}
