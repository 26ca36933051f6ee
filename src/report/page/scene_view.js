// The figure of the model: its switches, its words, what pointing at it says.
const GREYS = ["#c9d1d9", "#b9c6d3", "#d5cdbf", "#bfd0c6", "#d3c3c3", "#c5c2d6", "#d9d4b8", "#b8cfd4"];
const SIGNED = ["#1f4e8c", "#7fb0d9", "#eef1f4", "#eb9a6b", "#b2182b"];
const UNSIGNED = ["#e6ebf0", "#f3dc8e", "#f0a04b", "#d1492e", "#7a0f1d"];
const SIDES = { top: "#c0392b", bottom: "#1f5fa8" };
const rgb = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));

// Triangles of one colour each, for arrows and axes of gauges.
function solidShapes() {
  const at = [], normal = [], base = [];
  const face = (a, b, c, ink) => {
    const n = V.unit(V.cross(V.sub(b, a), V.sub(c, a)));
    for (const p of [a, b, c]) { at.push(...p); normal.push(...n.map((v) => Math.round(127 * v)), 0); base.push(...ink, 255); }
  };
  const arrays = (paint) => paint.arrays({
    at: [new Float32Array(at), 3], normal: [new Int8Array(normal), 4, true], base: [new Uint8Array(base), 4], tint: [new Uint8Array(base.length), 4],
    value: [new Float32Array(at.length / 3).fill(1e30), 1],
  });
  return { face, arrays, empty: () => at.length === 0 };
}

// An arrow whose head ends at `end`; a moment has two heads.
function arrowInto(shapes, tail, end, d, tip, moment, ink) {
  const u = V.unit(V.cross(d, Math.abs(d[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0])), w = V.cross(d, u);
  const ring = (c, r) => [0, 1, 2, 3, 4, 5, 6, 7].map((k) => V.along(V.along(c, u, r * Math.cos(k * Math.PI / 4)), w, r * Math.sin(k * Math.PI / 4)));
  const cone = (top) => {
    const base = V.along(top, d, -tip), foot = ring(base, 0.38 * tip);
    foot.forEach((p, k) => { const q = foot[(k + 1) % 8]; shapes.face(p, q, top, ink); shapes.face(q, p, base, ink); });
  };
  const p = ring(tail, 0.09 * tip), q = ring(V.along(end, d, -tip), 0.09 * tip);
  p.forEach((a, k) => { const m = (k + 1) % 8; shapes.face(a, p[m], q[k], ink); shapes.face(p[m], q[m], q[k], ink); });
  cone(end);
  if (moment) cone(V.along(end, d, -0.8 * tip));
}

async function scene(figure, data) {
  const box = figure.querySelector(".canvas"), said = figure.querySelector(".pick"), bar = figure.querySelector(".bar");
  const size = data.size || 1, touch = window.matchMedia("(pointer: coarse)").matches;
  const role = (name) => figure.querySelector("[data-role=" + name + "]");
  const chosen = (name, otherwise) => (role(name) ? +role(name).value : otherwise);
  const on = (name) => (role(name) ? role(name).checked : true);
  const canvas = document.createElement("canvas"), words = document.createElement("div");
  words.className = "words";
  box.append(canvas, words);
  const paint = painter(canvas);
  if (!paint) { said.textContent = "This browser does not support WebGL: the model is not shown."; return; }
  const { gl } = paint, mesh = meshOf(data), camera = cameraOf(size);
  const local = (p) => V.sub(p, mesh.middle), world = (p) => V.along(p, mesh.middle, 1);
  const marks = data.marks.map((m) => Object.assign({}, m, { at: local(m.at) }));
  const arrows = data.arrows.map((set) => set.list.filter((a) => a.share).map((a) => {
    const along = a.along.map((v) => v * Math.sign(a.share)), at = local(a.at);
    return { at, along, tail: V.along(at, along, -size * (0.03 + 0.11 * Math.abs(a.share))), moment: a.moment, label: a.label, ink: a.moment ? "#7d3c98" : "#0b7a3e" };
  }));
  const shownPart = (n) => { const b = figure.querySelector('[data-part="' + n + '"]'); return b ? b.checked : true; };

  // What stands on the card.
  const corners = mesh.vertexOf.length, at = new Float32Array(3 * corners), normal = new Int8Array(4 * corners), id = new Uint8Array(4 * corners), base = new Uint8Array(4 * corners);
  for (let f = 0; f < mesh.nFaces; f++) for (let c = mesh.start[f]; c < mesh.start[f + 1]; c++) {
    const v = mesh.vertexOf[c], grey = rgb(GREYS[mesh.part[f] % GREYS.length]);
    for (let k = 0; k < 3; k++) {
      at[3 * c + k] = mesh.xyz[3 * v + k];
      normal[4 * c + k] = Math.round(127 * mesh.normal[3 * f + k]);
      base[4 * c + k] = grey[k];
      id[4 * c + k] = ((f + 1) >> (8 * k)) & 255;
    }
    id[4 * c + 3] = base[4 * c + 3] = 255;
  }
  const tint = new Uint8Array(4 * corners);
  const faces = paint.arrays({ at: [at, 3], normal: [normal, 4, true], id: [id, 4], base: [base, 4], tint: [tint, 4], value: [new Float32Array(corners).fill(1e30), 1] });
  const edges = paint.strokes(mesh.edges), bars = paint.strokes(mesh.bars);
  let values = null, ends = [0, 1], stops = SIGNED, gaugeShapes = null, gaugeDiscs = null, arrowShapes = null;

  // Strain at all vertices, NaN where there is none; side 2 is the larger magnitude of both. The few hottest places do not wash out the rest.
  const kept = new Map();
  function strain(f, side) {
    if (kept.has(f + "/" + side)) return kept.get(f + "/" + side);
    const field = data.fields[f], out = new Float32Array(mesh.grids.length);
    const one = (v) => (v < -data.steps ? NaN : v * field.step);
    mesh.parts.forEach((p, n) => {
      const [bottom, top] = field.values[n].map((text) => unpack(text, 1));
      for (let v = 0; v < top.length; v++) {
        const [a, b] = [one(bottom[v]), one(top[v])];
        out[p.vertex + v] = side === 2 ? Math.max(Math.abs(a), Math.abs(b)) : side ? b : a;
      }
    });
    const sizes = out.filter(Number.isFinite).map(Math.abs).sort();
    const most = sizes.length ? sizes[Math.floor(0.99 * (sizes.length - 1))] || sizes[sizes.length - 1] || 1 : 1;
    kept.set(f + "/" + side, { values: out, most, largest: sizes.length ? sizes[sizes.length - 1] : most });
    return kept.get(f + "/" + side);
  }

  function colours() {
    const f = chosen("field", -1), side = chosen("side", 2), list = new Float32Array(corners).fill(1e30);
    bar.replaceChildren();
    values = null;
    if (f >= 0) {
      const found = strain(f, side);
      values = found.values;
      for (let t = 0; t < corners; t += 3) {
        const [a, b, c] = [0, 1, 2].map((k) => values[mesh.vertexOf[t + k]]);
        if (!Number.isNaN(a + b + c)) list.set([a, b, c], t);
      }
      // A magnitude begins at 0, and so does the larger magnitude of both sides.
      const signed = side !== 2 && data.fields[f].signed;
      ends = [signed ? -found.most : 0, found.most];
      stops = signed ? SIGNED : UNSIGNED;
      const ramp = document.createElement("i");
      ramp.style.background = "linear-gradient(to right," + stops.join(",") + ")";
      const word = (t) => Object.assign(document.createElement("span"), { textContent: t });
      // The few largest values have the colours of the ends.
      const [end, top] = [found.most, found.largest].map((v) => significant(v, 4)), beyond = end !== top, unit = " " + data.fields[f].unit;
      bar.append(word(signed ? (beyond ? "≤ −" : "−") + end : "0"), ramp, word(beyond ? `≥ ${end}, largest ${signed ? "magnitude " : ""}${top}${unit}` : end + unit));
    }
    paint.refill(faces.value, list);
  }

  // A gauge: a stroke along its axis, a disc; the gap as the areas of two discs.
  const lifted = (m) => (m.out ? V.along(m.at, m.out, 0.004 * size) : m.at);
  function gauges() {
    for (const set of [gaugeShapes, gaugeDiscs]) if (set) paint.free(set);
    const shapes = solidShapes(), gaps = marks.some((m) => m.gap), place = [], ink = [], disc = [];
    const most = Math.max(1e-300, ...marks.map((m) => (m.gap ? Math.max(...m.gap) : 0)));
    const add = (m, colour, share, d) => { place.push(...lifted(m)); ink.push(...colour, share); disc.push(d); };
    for (const m of marks) {
      const colour = rgb(gaps ? "#34495e" : SIDES[m.side]);
      if (m.along) {
        const across = V.cross(m.out, m.along), p = lifted(m);
        const c = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([l, w]) => V.along(V.along(p, m.along, 0.016 * l * size), across, 0.0022 * w * size));
        shapes.face(c[0], c[1], c[2], colour);
        shapes.face(c[0], c[2], c[3], colour);
      }
      if (m.gap) { add(m, [214, 137, 16], 115, 4 + 34 * Math.sqrt(m.gap[0] / most)); add(m, [31, 97, 141], 217, 4 + 34 * Math.sqrt(m.gap[1] / most)); }
      add(m, colour, 255, gaps ? 5 : 9);
    }
    gaugeShapes = shapes.empty() ? null : shapes.arrays(paint);
    gaugeDiscs = marks.length ? paint.arrays({ at: [new Float32Array(place), 3], base: [new Uint8Array(ink), 4], disc: [new Float32Array(disc), 1] }) : null;
  }

  function loads() {
    if (arrowShapes) paint.free(arrowShapes);
    const shapes = solidShapes();
    for (const a of arrows[chosen("arrows", -1)] || []) arrowInto(shapes, a.tail, a.at, a.along, 0.024 * size, a.moment, rgb(a.ink));
    arrowShapes = shapes.empty() ? null : shapes.arrays(paint);
  }

  function fit() {
    const ratio = window.devicePixelRatio || 1;
    camera.width = Math.max(1, box.clientWidth);
    camera.height = Math.max(1, box.clientHeight);
    canvas.width = Math.round(camera.width * ratio);
    canvas.height = Math.round(camera.height * ratio);
    return ratio;
  }

  let asked = false, numbered = null, ratio = fit();
  const request = () => { numbered = null; if (!asked) { asked = true; requestAnimationFrame(draw); } };
  const runs = () => mesh.parts.filter((p, n) => p.count && shownPart(n)).map((p) => [p.first, p.count]);
  function draw() {
    asked = false;
    const view = camera.matrix(), eye = camera.frame().eye, flat = new Float32Array(stops.flatMap((s) => rgb(s).map((v) => v / 255)));
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    paint.use(paint.faces, faces, { view, eye, ends, stops: flat });
    for (const [first, count] of runs()) gl.drawArrays(gl.TRIANGLES, first, count);
    for (const set of [arrowShapes, on("gauges") ? gaugeShapes : null]) if (set) {
      paint.use(paint.faces, set, { view, eye, ends, stops: flat });
      gl.drawArrays(gl.TRIANGLES, 0, set.n);
    }
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    const strokes = (set, width, ink) => {
      paint.use(paint.lines, set, { view, size: [camera.width, camera.height], width, ink });
      gl.drawArrays(gl.TRIANGLES, 0, set.n);
    };
    if (on("edges")) strokes(edges, 1.1, [0.24, 0.29, 0.35, 0.75]);
    strokes(bars, 3, [0.36, 0.42, 0.49, 1]);
    if (gaugeDiscs && on("gauges")) {
      paint.use(paint.discs, gaugeDiscs, { view, ratio });
      gl.drawArrays(gl.POINTS, 0, gaugeDiscs.n);
    }
    letters();
  }

  // Names beside what they name, the nearest first; one that would lie over another is left out.
  const made = new Map();
  let lit = "";
  const light = (name) => {
    lit = name;
    const mark = marks.find((m) => m.name === name);
    if (mark) said.textContent = mark.name + ": " + mark.note;
    request();
  };
  function letters() {
    const wanted = [], names = on("names");
    const length = 34, corner = [length + 14, camera.height - length - 14], { right, up } = camera.frame();
    ["x", "y", "z"].forEach((text, k) => {
      const tip = [corner[0] + length * right[k], corner[1] - length * up[k]];
      axes[k].setAttribute("d", `M${corner[0]} ${corner[1]}L${tip[0]} ${tip[1]}`);
      wanted.push({ key: "axis" + k, text, ink: "#5b6b7c", x: corner[0] + (length + 9) * right[k], y: corner[1] - (length + 9) * up[k], first: Math.hypot(right[k], up[k]) < 0.3 ? null : -2 });
    });
    if (on("gauges")) marks.forEach((m, k) => {
      const [x, y, away] = camera.project(lifted(m)), bold = m.name === lit;
      if (names || bold) wanted.push({ key: "gauge" + k, text: m.name, bold, ink: marks.some((o) => o.gap) ? "#34495e" : SIDES[m.side], x, y: y - 14, first: bold ? -3 : away });
    });
    const set = arrows[chosen("arrows", -1)] || [];
    if (names && set.length <= 24) set.forEach((a, k) => {
      const [x, y, away] = camera.project(a.tail);
      wanted.push({ key: "load" + chosen("arrows", -1) + "/" + k, text: a.label.replace(/(, grid| \().*/, ""), ink: a.ink, x, y: y + 12, first: away });
    });
    const taken = [], seen = new Set();
    for (const w of wanted.filter((w) => w.first !== null).sort((a, b) => a.first - b.first)) {
      const wide = widthOf(w.text, (w.bold ? "700 14px" : "12px") + " system-ui, sans-serif") + 4, x0 = w.x - wide / 2, y0 = w.y - 8;
      if (!(x0 >= 0 && x0 + wide <= camera.width && y0 >= 0 && y0 + 16 <= camera.height)) continue;
      if (taken.some((t) => x0 < t[0] + t[2] + 2 && t[0] < x0 + wide + 2 && y0 < t[1] + 17 && t[1] < y0 + 17)) continue;
      taken.push([x0, y0, wide]);
      let span = made.get(w.key);
      if (!span) { made.set(w.key, span = document.createElement("span")); words.append(span); }
      if (span.textContent !== w.text) span.textContent = w.text;
      span.style.cssText = `left:${x0}px;top:${y0}px;width:${wide}px;color:${w.ink}${w.bold ? ";font:700 14px/16px system-ui,sans-serif;background:#fff;outline:2px solid #c0392b" : ""}`;
      span.classList.toggle("lit", !!w.bold);
      seen.add(w.key);
    }
    for (const [key, span] of made) span.hidden = !seen.has(key);
  }
  const triad = svg("svg", { width: "100%", height: "100%" }, words);
  const axes = [0, 1, 2].map(() => svg("path", { stroke: "#5b6b7c", "stroke-width": 1.5 }, triad));

  // By pixel the number of the face that is seen there, from 1; rows from below.
  function numbers() {
    if (numbered) return numbered;
    const [w, h] = [camera.width, camera.height].map(Math.round), frame = gl.createFramebuffer(), ink = gl.createRenderbuffer(), depth = gl.createRenderbuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    [[ink, gl.RGBA8, gl.COLOR_ATTACHMENT0], [depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]].forEach(([buffer, kind, slot]) => {
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorage(gl.RENDERBUFFER, kind, w, h);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, slot, gl.RENDERBUFFER, buffer);
    });
    gl.viewport(0, 0, w, h);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
    paint.use(paint.numbers, faces, { view: camera.matrix() });
    for (const [first, count] of runs()) gl.drawArrays(gl.TRIANGLES, first, count);
    const bytes = new Uint8Array(4 * w * h);
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.deleteFramebuffer(frame);
    gl.deleteRenderbuffer(ink);
    gl.deleteRenderbuffer(depth);
    numbered = { w, h, list: new Uint32Array(bytes.buffer) };
    return numbered;
  }
  const faceAt = (x, y) => faceIn(numbers(), x, y);

  const markAt = (x, y, near) => {
    let best = -1;
    if (on("gauges")) marks.forEach((m, k) => {
      const p = camera.project(lifted(m)), away = Math.hypot(p[0] - x, p[1] - y);
      if (away < near) { near = away; best = k; }
    });
    return best;
  };
  // To a hundred thousandth of the model.
  const grain = 10 ** Math.floor(Math.log10(size) - 5);
  const place = (p) => world(p).map((v) => rounded(v, grain)).join(", ") + (data.length ? " " + data.length : "");
  function tell(x, y) {
    const near = touch ? 22 : 11, k = markAt(x, y, near);
    if (k >= 0) return marks[k].name + ": " + marks[k].note;
    const set = arrows[chosen("arrows", -1)] || [];
    for (const a of set) for (const p of [a.tail, a.at]) { const q = camera.project(p); if (Math.hypot(q[0] - x, q[1] - y) < near) return a.label; }
    const f = faceAt(x, y);
    if (f < 0) return "";
    const part = mesh.parts[mesh.part[f]], hit = onFace(mesh, f, ...camera.ray(x, y)) || centreOf(mesh, f);
    let v = mesh.faces[4 * f], best = Infinity;
    for (let c = 0; c < 4; c++) {
      const w = mesh.faces[4 * f + c], away = Math.hypot(...V.sub(vertexAt(mesh, w), hit));
      if (away < best) { best = away; v = w; }
    }
    // Strain is kept in steps: no digit below one is said.
    const field = values ? data.fields[chosen("field", -1)] : null, unit = field ? field.unit : "", step = field ? 10 ** Math.floor(Math.log10(Math.abs(field.step) || 1)) : 1;
    return [part.name, part.whole && part.elements ? "element " + part.elements[f - part.face] : "", "grid " + mesh.grids[v],
      values && !Number.isNaN(values[v]) ? rounded(values[v], step) + " " + unit : "", "at " + place(hit)].filter(Boolean).join(", ");
  }

  // Points that a view must show: also what may be switched on.
  const samples = [];
  for (let v = 0, step = Math.ceil(mesh.grids.length / 3000); v < mesh.grids.length; v += step) samples.push(vertexAt(mesh, v));
  for (const list of [mesh.edges, mesh.bars]) for (let i = 0, step = 3 * Math.ceil(list.length / 9000); i + 2 < list.length; i += step) samples.push([list[i], list[i + 1], list[i + 2]]);
  marks.forEach((m) => samples.push(m.at));
  arrows.forEach((set) => set.forEach((a) => samples.push(a.tail)));
  if (!samples.length) samples.push([0, 0, 0]);

  const api = { figure, box, mesh, marks, camera, data, paint, faces, tint, request, light, numbers, faceAt, markAt, lifted, place, shownPart, local, world, regauge: () => { gauges(); request(); }, tool: null, said };
  listen(api, tell);
  figure.addEventListener("change", (event) => {
    const part = event.target.dataset.role;
    if (part === "all") figure.querySelectorAll("[data-part]").forEach((b) => { b.checked = event.target.checked; });
    if (part === "field" || part === "side") colours();
    if (part === "arrows") loads();
    request();
  });
  figure.querySelectorAll("[data-view]").forEach((button) => button.addEventListener("click", () => { camera.look(button.dataset.view, samples); request(); }));
  new ResizeObserver(() => {
    if (box.clientWidth === camera.width && box.clientHeight === camera.height) return;
    ratio = fit();
    request();
  }).observe(box);
  camera.look("iso", samples);
  colours();
  gauges();
  loads();
  if (data.pointing && figure.querySelector("[data-pointing]")) planning(api);
  figure.scene = api;
  numbered = null;
  draw();
}

// Mouse, fingers, wheel and keys: a tool has the first finger, two fingers always move the picture.
function listen(api, tell) {
  const { box, camera } = api, fingers = new Map();
  const spot = (event) => { const r = box.getBoundingClientRect(); return [event.clientX - r.left - box.clientLeft, event.clientY - r.top - box.clientTop]; };
  let held = false, hover = null;
  const spread = () => { const [a, b] = [...fingers.values()]; return { x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2, d: Math.hypot(a[0] - b[0], a[1] - b[1]) }; };
  box.addEventListener("contextmenu", (event) => event.preventDefault());
  // A finger that leaves a tool in full swing would set the page flinging, and a browser swallows the next tap to stop that.
  box.addEventListener("touchmove", (event) => { if (api.tool) event.preventDefault(); }, { passive: false });
  box.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "mouse") box.focus({ preventScroll: true });
    box.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, spot(event));
    if (fingers.size === 1) held = Boolean(api.tool && event.button === 0 && api.tool.down(...spot(event), event));
    else if (held) { held = false; api.tool.cancel(); }
    event.preventDefault();
  });
  box.addEventListener("pointermove", (event) => {
    const [x, y] = spot(event), before = fingers.get(event.pointerId);
    if (!before) {
      if (api.tool && api.tool.hover) api.tool.hover(x, y, event);
      if (!hover) requestAnimationFrame(() => { const text = tell(...hover); hover = null; if (text) api.said.textContent = text; });
      hover = [x, y];
      return;
    }
    if (fingers.size === 2) {
      const a = spread();
      fingers.set(event.pointerId, [x, y]);
      const b = spread();
      camera.pan(b.x - a.x, b.y - a.y);
      if (a.d > 0 && b.d > 0) camera.zoom(a.d / b.d, b.x, b.y);
      return api.request();
    }
    fingers.set(event.pointerId, [x, y]);
    if (held) return api.tool.move(x, y, event);
    if (event.buttons & 6 || event.shiftKey) camera.pan(x - before[0], y - before[1]);
    else camera.turn(x - before[0], y - before[1]);
    api.request();
  });
  const up = (event) => {
    if (!fingers.delete(event.pointerId)) return;
    const [x, y] = spot(event);
    // A finger that scrolled the page does not count as a tap.
    if (event.type === "pointerup") box.focus({ preventScroll: true });
    if (held && event.type === "pointerup") api.tool.up(x, y, event);
    else if (held) api.tool.cancel();
    else if (event.type === "pointerup") { const text = tell(x, y); if (text) api.said.textContent = text; }
    held = false;
  };
  box.addEventListener("pointerup", up);
  box.addEventListener("pointercancel", up);
  // The wheel scrolls the page until the picture was clicked.
  box.addEventListener("wheel", (event) => {
    if (document.activeElement !== box && !event.ctrlKey) return;
    event.preventDefault();
    camera.zoom(Math.exp(0.0015 * event.deltaY * (event.deltaMode ? 30 : 1)), ...spot(event));
    api.request();
  }, { passive: false });
  box.addEventListener("keydown", (event) => {
    const turn = { ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, -20], ArrowDown: [0, 20] }[event.key];
    const zoom = { "+": 0.85, "=": 0.85, "-": 1.18 }[event.key];
    if (event.key === "Escape") return box.blur();
    if (!turn && !zoom) return;
    event.preventDefault();
    if (turn) camera.turn(...turn);
    else camera.zoom(zoom, camera.width / 2, camera.height / 2);
    api.request();
  });
}
