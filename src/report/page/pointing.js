// Planning by pointing: where gauges may go, where they really are.
const STATES = ["nothing", "allowed", "forbidden", "wanted"];
const TINTS = [[0, 0, 0, 0], [46, 160, 67, 190], [214, 40, 40, 200], [106, 61, 198, 220]];

function planning(api) {
  const { figure, box, mesh, marks, camera, paint } = api, stated = api.data.pointing;
  const role = (name) => figure.querySelector("[data-role=" + name + "]");
  const plan = elementsOf(mesh), done = [];
  const overlay = svg("svg", { width: "100%", height: "100%" }, box.querySelector(".words"));
  const ring = svg("circle", { class: "aim", r: 0 }, overlay), frame = svg("rect", { class: "aim", width: 0, height: 0 }, overlay);
  let tool = "turn", state = 1, tinted = false;

  // Elements into a state; what they were is kept until it is undone.
  function set(list, to, undoable) {
    const changed = list.filter((e) => plan.state[e] !== to);
    if (!changed.length) return;
    if (undoable) done.push({ elements: changed, before: changed.map((e) => plan.state[e]) });
    for (const e of changed) plan.state[e] = to;
    show(changed);
  }
  function show(changed) {
    const paintFaces = (from, to, ink) => { for (let c = mesh.start[from]; c < mesh.start[to]; c++) api.tint.set(TINTS[tinted ? ink : 0], 4 * c); };
    const coarse = new Set();
    for (const e of changed) {
      const f = plan.faceOf(e);
      if (f < 0) coarse.add(plan.partOf(e)); else paintFaces(f, f + 1, plan.state[e]);
    }
    // Of a part that is drawn coarser each vertex has the colour of its elements; one that has none, that of its neighbour.
    for (const n of coarse) {
      const p = mesh.parts[n], inks = plan.coarse.get(n).inks(plan.state), none = TINTS[0];
      for (let c = p.first; c < p.first + p.count; c += 3) {
        const of = [0, 1, 2].map((k) => inks[mesh.vertexOf[c + k] - p.vertex]), known = of.find((ink) => ink) || none;
        of.forEach((ink, k) => api.tint.set(tinted ? ink || known : none, 4 * (c + k)));
      }
    }
    paint.refill(api.faces.tint, api.tint);
    api.request();
  }
  // The picture shows the plan while one is made: until then, its strain.
  function colour() {
    const now = done.length > 0 || tool === "brush" || tool === "box";
    if (now === tinted) return;
    tinted = now;
    show(plan.all());
  }
  function undo() {
    const last = done.pop();
    if (!last) return;
    if (last.mark) { Object.assign(last.mark, last.before); api.regauge(); } else {
      last.elements.forEach((e, i) => { plan.state[e] = last.before[i]; });
      show(last.elements);
    }
    write();
  }

  // Brush and box work on one picture: what is seen of it, and where the middles of the faces are.
  function seen() {
    const { w, h, list } = api.numbers(), at = new Float32Array(3 * mesh.nFaces);
    for (let f = 0; f < mesh.nFaces; f++) at.set(camera.project(centreOf(mesh, f)), 3 * f);
    const number = (x, y) => faceIn({ w, h, list }, x, y);
    // A face of a pixel or less counts as seen where one of the same surface close beside it is.
    const visible = (f) => {
      const g = number(at[3 * f], at[3 * f + 1]);
      if (g === f || g < 0) return g === f;
      const pixel = camera.pixel(at[3 * f + 2]);
      return mesh.radius[f] < 1.5 * pixel && Math.abs(V.dot(normalOf(mesh, f), normalOf(mesh, g))) > 0.7 &&
        Math.hypot(...V.sub(centreOf(mesh, f), centreOf(mesh, g))) <= mesh.radius[f] + mesh.radius[g] + 1.5 * pixel;
    };
    // Of elements that are drawn coarser: the middles too. One is seen where what is drawn there is its part, as far away as it is, or where the
    // drawn face nearest to it is.
    const spots = new Map();
    for (const [n, c] of plan.coarse) {
      const list = new Float32Array(c.middle.length);
      for (let e = 0; e < list.length / 3; e++) list.set(camera.project(c.middleOf(e)), 3 * e);
      spots.set(n, list);
    }
    const seenCoarse = (n, e) => {
      const c = plan.coarse.get(n), list = spots.get(n), x = list[3 * e], y = list[3 * e + 1], g = number(x, y);
      if (g >= 0 && mesh.part[g] === n) {
        const hit = onFace(mesh, g, ...camera.ray(x, y)) || centreOf(mesh, g);
        if (Math.hypot(...V.sub(c.middleOf(e), hit)) <= 0.5 * mesh.radius[g] + 1.5 * camera.pixel(list[3 * e + 2])) return true;
      }
      const f = c.face[e];
      return f >= 0 && number(at[3 * f], at[3 * f + 1]) === f;
    };
    return { w, h, at, number, visible, spots, seenCoarse };
  }
  function within(view, x0, y0, x1, y1, inside, through) {
    const found = new Set(), shown = mesh.parts.map((_, n) => api.shownPart(n));
    for (let y = Math.max(0, Math.floor(y0)); y <= Math.min(view.h - 1, y1); y++) for (let x = Math.max(0, Math.floor(x0)); x <= Math.min(view.w - 1, x1); x++) {
      const f = inside(x + 0.5, y + 0.5) ? view.number(x, y) : -1;
      if (f < 0) continue;
      const e = plan.elementOf(f);
      if (e >= 0) found.add(e); else if (x % 2 === 0 && y % 2 === 0) found.add(plan.elementUnder(f, camera.ray(x + 0.5, y + 0.5)));
    }
    const over = (at, k) => at[k] >= x0 && at[k] <= x1 && at[k + 1] >= y0 && at[k + 1] <= y1 && at[k + 2] > 0 && inside(at[k], at[k + 1]);
    for (let f = 0; f < mesh.nFaces; f++) if (over(view.at, 3 * f) && shown[mesh.part[f]] && (through || view.visible(f))) found.add(plan.elementOf(f));
    for (const [n, at] of view.spots) if (shown[n]) for (let e = 0; e < at.length / 3; e++) {
      if (over(at, 3 * e) && (through || view.seenCoarse(n, e))) found.add(plan.coarse.get(n).first + e);
    }
    found.delete(-1);
    return [...found];
  }

  let stroke = null;
  const tools = {
    brush: {
      down(x, y) { stroke = { view: seen(), last: [x, y], elements: new Map() }; this.move(x, y); return true; },
      move(x, y) {
        // All within the brush of the way from the last place.
        const r = +role("brush").value, [a, b] = stroke.last, dx = x - a, dy = y - b, length = dx * dx + dy * dy || 1;
        const near = (p, q) => {
          const t = Math.min(1, Math.max(0, ((p - a) * dx + (q - b) * dy) / length));
          return Math.hypot(p - a - t * dx, q - b - t * dy) <= r;
        };
        const hit = within(stroke.view, Math.min(a, x) - r, Math.min(b, y) - r, Math.max(a, x) + r, Math.max(b, y) + r, near, false);
        const fresh = hit.filter((e) => !stroke.elements.has(e));
        for (const e of fresh) stroke.elements.set(e, plan.state[e]);
        set(fresh, state, false);
        stroke.last = [x, y];
        this.hover(x, y);
      },
      hover(x, y) { svgSet(ring, { cx: x, cy: y, r: +role("brush").value }); },
      up() {
        const changed = [...stroke.elements].filter(([, before]) => before !== state);
        if (changed.length) done.push({ elements: changed.map((c) => c[0]), before: changed.map((c) => c[1]) });
        stroke = null;
        write();
      },
      cancel() {
        if (stroke) { for (const [e, before] of stroke.elements) plan.state[e] = before; show([...stroke.elements.keys()]); }
        stroke = null;
      },
    },
    box: {
      down(x, y) { stroke = [x, y]; return true; },
      move(x, y) { svgSet(frame, { x: Math.min(x, stroke[0]), y: Math.min(y, stroke[1]), width: Math.abs(x - stroke[0]), height: Math.abs(y - stroke[1]) }); },
      up(x, y) {
        const [x0, x1] = [x, stroke[0]].sort((a, b) => a - b), [y0, y1] = [y, stroke[1]].sort((a, b) => a - b);
        this.cancel();
        set(within(seen(), x0, y0, x1, y1, (p, q) => p >= x0 && p <= x1 && q >= y0 && q <= y1, role("through").checked), state, true);
        write();
      },
      cancel() { stroke = null; svgSet(frame, { width: 0, height: 0 }); },
    },
    gauge: {
      down(x, y, event) {
        const k = api.markAt(x, y, event.pointerType === "mouse" ? 14 : 26), mark = marks[k];
        if (!mark || !mark.along) return false;
        const row = mark.name.replace(/\.[a-d]$/, "");
        if (row !== mark.name && marks.some((m) => m !== mark && m.name.replace(/\.[a-d]$/, "") === row)) {
          api.said.textContent = row + " is a rosette: its place stands in the job's table of gauges, for all of its legs.";
          return false;
        }
        stroke = { mark, before: Object.assign({}, mark), moved: false };
        return true;
      },
      move(x, y) {
        const f = api.faceAt(x, y);
        if (f < 0) return;
        const [eye, along] = camera.ray(x, y), hit = plan.onSurface(f, eye, along);
        if (!hit) return;
        const { at, n } = hit, side = V.dot(n, along) < 0 ? "top" : "bottom", out = side === "top" ? n : n.map((v) => -v);
        // Its axis is laid onto the surface; one that stands on it turns to the element's edge.
        let axis = V.along(stroke.before.along, n, -V.dot(stroke.before.along, n));
        if (Math.hypot(...axis) < 0.1) axis = V.sub(vertexAt(mesh, mesh.faces[4 * f + 1]), vertexAt(mesh, mesh.faces[4 * f]));
        axis = V.unit(V.along(axis, n, -V.dot(axis, n)));
        Object.assign(stroke.mark, { at, side, out, along: axis, moved: true, note: "moved to " + api.place(at) + ", " + side });
        stroke.moved = true;
        api.said.textContent = stroke.mark.name + ": " + stroke.mark.note;
        api.regauge();
        figure.dispatchEvent(new Event("moving"));
      },
      up() {
        if (stroke.moved) done.push({ mark: stroke.mark, before: Object.assign({ moved: false }, stroke.before) });
        stroke = null;
        write();
      },
      cancel() { if (stroke) { Object.assign(stroke.mark, { moved: false }, stroke.before); api.regauge(); } stroke = null; },
    },
  };

  function choose(name) {
    tool = name;
    chosen = -1;
    api.tool = tools[name] || null;
    box.classList.toggle("planning", name !== "turn");
    colour();
    svgSet(ring, { r: 0 });
    figure.querySelectorAll("[data-tool]").forEach((b) => b.setAttribute("aria-pressed", b.dataset.tool === name));
  }
  figure.querySelectorAll("[data-tool]").forEach((b) => b.addEventListener("click", () => choose(b.dataset.tool)));
  figure.querySelectorAll("[data-state]").forEach((b) => b.addEventListener("click", () => {
    state = +b.dataset.state;
    figure.querySelectorAll("[data-state]").forEach((o) => o.setAttribute("aria-pressed", o === b));
  }));
  // By keyboard, with "move gauges": Enter or n takes the next gauge, arrows move it to the next element that way, Escape puts it back.
  let chosen = -1, held = null;
  const row = (mark) => mark.name.replace(/\.[a-d]$/, "");
  const isFree = (mark) => mark.along && !marks.some((m) => m !== mark && row(m) === row(mark));
  const showChosen = () => {
    const at = chosen < 0 ? null : camera.project(api.lifted(marks[chosen]));
    svgSet(ring, at ? { cx: at[0], cy: at[1], r: 14 } : { r: 0 });
  };
  function chooseNext() {
    held = null;
    for (let k = 1; k <= marks.length; k++) {
      const next = (chosen + k + marks.length) % marks.length;
      if (!isFree(marks[next])) continue;
      chosen = next;
      api.said.textContent = marks[next].name + " is chosen: arrow keys move it, Escape puts it back.";
      return showChosen();
    }
  }
  // The nearest drawn face that way, on the side that is seen, at least as far as the face is wide.
  function step(dx, dy) {
    const mark = marks[chosen], here = camera.project(mark.at), view = seen(), own = view.number(here[0], here[1]);
    let best = -1, least = Infinity;
    for (let f = 0; f < mesh.nFaces; f++) {
      const x = view.at[3 * f] - here[0], y = view.at[3 * f + 1] - here[1], ahead = x * dx + y * dy, aside = Math.abs(x * dy - y * dx);
      if (f === own || !(ahead > 2) || aside > ahead || !api.shownPart(mesh.part[f]) || !view.visible(f)) continue;
      const away = ahead + 2 * aside + 4 * Math.hypot(...V.sub(centreOf(mesh, f), mark.at)) / camera.pixel(here[2]);
      if (away < least) { least = away; best = f; }
    }
    if (best < 0) { api.said.textContent = "There is no element that way."; return; }
    const [x, y] = [view.at[3 * best], view.at[3 * best + 1]];
    if (!held) held = { done: done.length };
    stroke = { mark, before: Object.assign({}, mark), moved: false };
    tools.gauge.move(x, y);
    tools.gauge.up();
    showChosen();
  }
  // Before the camera takes the arrow keys.
  box.addEventListener("keydown", (event) => {
    if (tool !== "gauge" || stroke || event.ctrlKey || event.metaKey || event.altKey) return;
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (event.key === "Enter" || event.key === "n") chooseNext();
    else if (chosen >= 0 && way) step(...way);
    else if (chosen >= 0 && event.key === "Escape") {
      if (held) while (done.length > held.done) undo();
      held = null;
      chosen = -1;
      showChosen();
      api.said.textContent = "";
    } else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  }, true);
  box.addEventListener("pointerleave", () => svgSet(ring, { r: 0 }));
  role("undo").addEventListener("click", undo);
  box.addEventListener("keydown", (event) => { if (event.key === "z" && (event.ctrlKey || event.metaKey)) { event.preventDefault(); undo(); } });
  if (role("clear")) role("clear").addEventListener("click", () => { set(plan.all(), 0, true); write(); });

  // A button a property: all of its elements.
  const list = role("properties");
  if (list) for (const [id, p] of plan.properties) {
    const b = Object.assign(document.createElement("button"), { type: "button" });
    b.dataset.property = id;
    b.append(p.name + " ", Object.assign(document.createElement("small"), { textContent: p.elements.length + (p.elements.length === 1 ? " element" : " elements") }));
    b.addEventListener("click", () => { set(p.elements, state, true); write(); });
    list.append(b);
  }

  function write() {
    colour();
    role("undo").disabled = done.length === 0;
    const put = (kind, text) => {
      const into = figure.querySelector(`[data-written=${kind}]`);
      if (!into) return;
      into.hidden = !text;
      into.querySelector("pre").textContent = text;
    };
    if (list) {
      const n = STATES.map((_, s) => plan.state.reduce((sum, t) => sum + (t === s), 0));
      role("count").textContent = `${n[1]} elements allowed, ${n[2]} forbidden, ${n[3]} wanted of ${plan.ids.length}.` + (n[1] ? "" : " Where none is allowed, all are that aren't forbidden.") + (stated.also ? " The job's sets, boxes and distances limit them further." : "");
      put("places", candidateLines(plan));
      figure.querySelectorAll("[data-property]").forEach((b) => {
        const p = plan.properties.get(+b.dataset.property), s = plan.state[p.elements[0]];
        b.className = p.elements.every((e) => plan.state[e] === s) ? "s" + s : "";
      });
    }
    put("gauges", gaugeLines(marks, api.world));
    figure.dispatchEvent(new Event("planned"));
  }
  for (const kind of ["places", "gauges"]) {
    const into = figure.querySelector(`[data-written=${kind}]`);
    if (!into) continue;
    const pre = into.querySelector("pre"), name = kind === "places" ? stated.file.split(/[\\/]/).pop() : "moved_gauges.csv";
    into.querySelector("[data-role=copy]").addEventListener("click", async () => {
      const range = document.createRange();
      range.selectNodeContents(pre);
      getSelection().removeAllRanges();
      getSelection().addRange(range);
      try { await navigator.clipboard.writeText(pre.textContent); } catch { document.execCommand("copy"); }
      api.said.textContent = "Copied.";
    });
    into.querySelector("[data-role=save]").addEventListener("click", () => {
      const link = Object.assign(document.createElement("a"), { download: name, href: URL.createObjectURL(new Blob([pre.textContent], { type: "text/plain" })) });
      link.click();
      setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    });
  }
  if (stated.lists) begin(plan, stated.lists);
  show(plan.all());
  write();
  api.plan = plan;
}

// Items 0 .. by their key, 0 .. n - 1: a list of each key.
function grouped(keys, n) {
  const start = new Int32Array(n + 1), list = new Int32Array(keys.length);
  for (const k of keys) start[k + 1]++;
  for (let k = 0; k < n; k++) start[k + 1] += start[k];
  const next = start.slice();
  keys.forEach((k, i) => { list[next[k]++] = i; });
  return (k) => list.subarray(start[k], start[k + 1]);
}

// Elements of a part that is drawn coarser: their middles, the drawn vertex that each goes with, the drawn face nearest to each.
function coarseOf(mesh, p, first) {
  const count = p.elements.length, nv = p.grids.length, middle = new Float32Array(3 * count), vertex = new Int32Array(count), face = new Int32Array(count).fill(-1);
  for (let e = 0; e < count; e++) {
    vertex[e] = p.middles[4 * e];
    for (let k = 0; k < 3; k++) middle[3 * e + k] = p.xyz[3 * vertex[e] + k] + p.middles[4 * e + 1 + k] * mesh.middleStep;
  }
  const middleOf = (e) => [middle[3 * e], middle[3 * e + 1], middle[3 * e + 2]], corners = new Int32Array(3 * p.nFaces);
  for (let f = 0; f < p.nFaces; f++) for (let k = 0; k < 3; k++) corners[3 * f + k] = p.faces[4 * f + k];
  const elementsAt = grouped(vertex, nv), cornersAt = grouped(corners, nv);
  // How far an element is from a place on a face: what lies off its plane counts three times.
  const far = (e, f, place) => {
    const d = V.sub(middleOf(e), place), off = V.dot(d, normalOf(mesh, f));
    return V.dot(d, d) + 8 * off * off;
  };
  for (let e = 0; e < count; e++) {
    let least = Infinity;
    for (const c of cornersAt(vertex[e])) {
      const f = p.face + Math.floor(c / 3), away = far(e, f, centreOf(mesh, f));
      if (away < least) { least = away; face[e] = f; }
    }
  }
  // The element nearest to a place on a face.
  const under = (f, place) => {
    let best = -1, least = Infinity;
    for (let k = 0; k < 3; k++) for (const e of elementsAt(mesh.faces[4 * f + k] - p.vertex)) {
      const away = far(e, f, place);
      if (away < least) { least = away; best = e; }
    }
    return best < 0 ? -1 : first + best;
  };
  // Where a ray meets the elements themselves, and their normal there: the plane of three middles about the place on the drawn face. Null
  // where that is the face, to the raster of the middles, and where the three lie round an edge.
  const onElements = (f, drawn, from, along) => {
    // An element under the face may go with a vertex of a face beside it.
    const normal = normalOf(mesh, f), about = new Set(), list = [];
    for (let k = 0; k < 3; k++) for (const c of cornersAt(mesh.faces[4 * f + k] - p.vertex)) {
      const g = Math.floor(c / 3);
      for (let i = 0; i < 3; i++) about.add(corners[3 * g + i]);
    }
    for (const v of about) list.push(...elementsAt(v));
    let at = drawn, n = null;
    for (let pass = 0; pass < 3; pass++) {
      const near = list.map((e) => [far(e, f, at), middleOf(e)]).sort((a, b) => a[0] - b[0]).slice(0, 12).map((e) => e[1]);
      if (near.length < 3) return null;
      const u = V.sub(near[1], near[0]), wide = (q) => Math.hypot(...V.cross(V.unit(u), V.unit(V.sub(q, near[0])))) > 0.5;
      const third = near.slice(2).find(wide);
      if (!third) return null;
      if ([near[0], near[1], third].every((q) => Math.abs(V.dot(V.sub(q, drawn), normal)) <= mesh.middleStep)) return null;
      const across = V.unit(V.cross(u, V.sub(third, near[0])));
      n = V.dot(across, normal) < 0 ? across.map((v) => -v) : across;
      const slope = V.dot(n, along);
      if (V.dot(n, normal) < 0.7 || Math.abs(slope) < 0.1) return null;
      at = V.along(from, along, V.dot(V.sub(near[0], from), n) / slope);
    }
    return { at, n };
  };
  // By vertex the colour of the strongest state among its elements, the fainter the fewer have it; null where it has none.
  const inks = (state) => {
    const n = new Uint32Array(4 * nv);
    for (let e = 0; e < count; e++) n[4 * vertex[e] + state[first + e]]++;
    return Array.from({ length: nv }, (_, v) => {
      const of = n.subarray(4 * v, 4 * v + 4), all = of[0] + of[1] + of[2] + of[3], s = of[3] ? 3 : of[2] ? 2 : of[1] ? 1 : 0;
      return all ? [...TINTS[s].slice(0, 3), TINTS[s][3] * (0.4 + 0.6 * of[s] / all)] : null;
    });
  };
  return { first, middle, middleOf, face, under, onElements, inks };
}

// Shells of the parts. Of a part that is drawn as it is, an element is a face; of another one, it is known by its middle.
function elementsOf(mesh) {
  const ids = [], pids = [], of = [], first = new Map(), properties = new Map(), coarse = new Map();
  mesh.parts.forEach((p, n) => {
    if (!p.elements) return;
    first.set(n, ids.length);
    if (!p.whole) coarse.set(n, coarseOf(mesh, p, ids.length));
    for (let e = 0; e < p.elements.length; e++) {
      const pid = p.properties[e];
      if (!properties.has(pid)) properties.set(pid, { name: p.name.startsWith("shells " + pid) ? p.name : "shells " + pid, elements: [] });
      properties.get(pid).elements.push(ids.length);
      ids.push(p.elements[e]);
      pids.push(pid);
      of.push(n);
    }
  });
  const plan = { ids, pids, properties, coarse, state: new Uint8Array(ids.length) };
  plan.all = () => ids.map((_, e) => e);
  plan.partOf = (e) => of[e];
  plan.faceOf = (e) => {
    const p = mesh.parts[of[e]];
    return p.whole ? p.face + e - first.get(of[e]) : -1;
  };
  plan.elementOf = (f) => {
    const n = mesh.part[f], p = mesh.parts[n];
    return p.elements && p.whole ? first.get(n) + f - p.face : -1;
  };
  // The element of a coarser part that is nearest to where a ray meets its face.
  plan.elementUnder = (f, ray) => {
    const of = coarse.get(mesh.part[f]);
    return of ? of.under(f, onFace(mesh, f, ...ray) || centreOf(mesh, f)) : -1;
  };
  // Where a ray that meets a drawn face meets the model, and the normal there.
  plan.onSurface = (f, from, along) => {
    const of = coarse.get(mesh.part[f]), at = onFace(mesh, f, from, along);
    return at && ((of && of.onElements(f, at, from, along)) || { at, n: normalOf(mesh, f) });
  };
  return plan;
}

// What the job states to begin with.
function begin(plan, lists) {
  const has = (key, id) => (lists[key] ? lists[key].some(([a, b]) => a <= id && id <= b) : null);
  plan.ids.forEach((id, e) => {
    const pid = plan.pids[e];
    if (has("exclude_properties", pid) || has("exclude_elements", id)) plan.state[e] = 2;
    else if (has("wanted_elements", id)) plan.state[e] = 3;
    else if ((lists.properties || lists.elements) && has("properties", pid) !== false && has("elements", id) !== false) plan.state[e] = 1;
  });
}

// Ids as text: runs in which no shell is left out as `a THRU b`.
function runsOf(plan, member) {
  const order = plan.ids.map((id, e) => [id, member(e)]).sort((a, b) => a[0] - b[0]), out = [];
  for (let i = 0; i < order.length;) {
    if (!order[i][1]) { i++; continue; }
    let j = i;
    while (j + 1 < order.length && order[j + 1][1]) j++;
    if (j - i < 2) for (let k = i; k <= j; k++) out.push(order[k][0]);
    else out.push(order[i][0] + " THRU " + order[j][0]);
    i = j + 1;
  }
  return '"' + out.join(", ") + '"';
}

// The lines of `[candidates]`; whole properties by their ids.
function candidateLines(plan) {
  const out = [], any = (s) => plan.state.some((t) => t === s);
  const of = (member) => {
    const whole = [...plan.properties].filter(([, p]) => p.elements.every(member)).map(([id]) => id).sort((a, b) => a - b), known = new Set(whole);
    return { whole, rest: (e) => member(e) && !known.has(plan.pids[e]) };
  };
  if (any(1)) {
    const member = (e) => plan.state[e] === 1 || plan.state[e] === 3, { whole, rest } = of(member);
    const all = plan.ids.every((_, e) => !rest(e));
    out.push(all ? `properties = [${whole.join(", ")}]` : `elements = ${runsOf(plan, member)}`);
  }
  if (any(2)) {
    const { whole, rest } = of((e) => plan.state[e] === 2);
    if (whole.length) out.push(`exclude_properties = [${whole.join(", ")}]`);
    if (plan.ids.some((_, e) => rest(e))) out.push(`exclude_elements = ${runsOf(plan, rest)}`);
  }
  if (any(3)) out.push(`wanted_elements = ${runsOf(plan, (e) => plan.state[e] === 3)}`);
  return out.length ? "[candidates]\n" + out.join("\n") + "\n" : "";
}

// Rows of the table of gauges for those that were moved.
function gaugeLines(marks, world) {
  const cell = (t) => (/[",\n]/.test(t) ? '"' + t.replace(/"/g, '""') + '"' : t), n = (v) => String(+v.toPrecision(7));
  const rows = marks.filter((m) => m.moved).map((m) => [cell(m.name), "", ...world(m.at).map(n), m.side, ...m.along.map((v) => n(+v.toFixed(6))), 0].join(","));
  return rows.length ? ["name,element,x,y,z,surface,dir_x,dir_y,dir_z,angle_deg", ...rows].join("\n") + "\n" : "";
}
