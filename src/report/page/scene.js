// Draws the figures of the page with plotly.js: charts as they stand, the model from packed arrays.
(function () {
  "use strict";
  const narrow = window.innerWidth < 600;
  const touch = window.matchMedia("(pointer: coarse)").matches;
  const font = { family: "system-ui, sans-serif", size: 12, color: "#1c2530" };
  const config = { displaylogo: false, responsive: true, displayModeBar: touch ? false : "hover" };

  // Numbers of a packed array {dtype, bdata}.
  function unpack(packed) {
    const text = atob(packed.bdata);
    const bytes = Uint8Array.from(text, (c) => c.charCodeAt(0));
    const kinds = { f4: Float32Array, i2: Int16Array, u2: Uint16Array, u4: Uint32Array };
    return new kinds[packed.dtype](bytes.buffer);
  }

  function chart(figure, data) {
    const canvas = figure.querySelector(".canvas");
    const layout = Object.assign({}, data.layout, { font, autosize: true, paper_bgcolor: "#fff", plot_bgcolor: "#fff" });
    layout.margin = Object.assign({ l: 56, r: 16, t: 28, b: 48 }, layout.margin);
    // A finger on a chart scrolls the page.
    if (touch) layout.dragmode = false;
    for (const axis of ["xaxis", "yaxis"]) layout[axis] = Object.assign({ gridcolor: "#eceff2" }, layout[axis]);
    // No room beside or above a chart on a phone.
    if (narrow && layout.legend) layout.legend = { orientation: "h", y: -0.28, yanchor: "top" };
    if (narrow) for (const t of data.choices.flat()) if (t.type === "heatmap") t.showscale = false;
    const draw = (i) => Plotly.react(canvas, data.choices[i], layout, config);
    const choice = figure.querySelector("[data-role=choice]");
    if (choice) choice.addEventListener("change", () => draw(+choice.value));
    return draw(0);
  }

  const greys = ["#c9d1d9", "#b9c6d3", "#d5cdbf", "#bfd0c6", "#d3c3c3", "#c5c2d6", "#d9d4b8", "#b8cfd4"];
  const signed = [[0, "#1f4e8c"], [0.25, "#7fb0d9"], [0.5, "#eef1f4"], [0.75, "#eb9a6b"], [1, "#b2182b"]];
  const unsigned = [[0, "#e6ebf0"], [0.25, "#f3dc8e"], [0.5, "#f0a04b"], [0.75, "#d1492e"], [1, "#7a0f1d"]];
  const sides = { top: "#c0392b", bottom: "#1f5fa8" };
  const digits = (v) => (Number.isFinite(v) ? String(+v.toPrecision(4)) : "none");

  // Every trace costs the compilation of its shaders: all parts are one mesh, all arrows another, all gauges one set of points.
  function scene(figure, data) {
    const canvas = figure.querySelector(".canvas");
    const size = data.size;
    const role = (name) => figure.querySelector("[data-role=" + name + "]");
    const chosen = (name, otherwise) => (role(name) ? +role(name).value : otherwise);
    const on = (name) => (role(name) ? role(name).checked : true);
    const join = (Kind, lists) => {
      const out = new Kind(lists.reduce((n, l) => n + l.length, 0));
      lists.reduce((n, l) => (out.set(l, n), n + l.length), 0);
      return out;
    };
    const parts = data.parts.map((p) => ({ name: p.name, xyz: p.xyz.map(unpack), ijk: p.ijk.map(unpack), grid: unpack(p.grid) }));
    const firsts = [0];
    for (const p of parts) firsts.push(firsts[firsts.length - 1] + p.grid.length);
    const xyz = [0, 1, 2].map((k) => join(Float32Array, parts.map((p) => p.xyz[k])));
    const values = data.fields.map((f) => f.values.map((by) => by.map(unpack)));
    const shown = (part) => {
      const box = figure.querySelector('[data-part="' + part + '"]');
      return box ? box.checked : true;
    };

    // Strain at all vertices, NaN where there is none; side 2 is the larger magnitude of both.
    function strain(f, side) {
      const step = data.fields[f].step;
      const one = (v) => (v === -32768 ? NaN : v * step);
      return join(Float32Array, values[f].map(([bottom, top]) => Float32Array.from(top, (v, i) =>
        side === 2 ? Math.max(Math.abs(one(v)), Math.abs(one(bottom[i]))) : one(side ? v : bottom[i]))));
    }

    // The 99th percentile: the few hottest places do not wash out the rest.
    function top99(list) {
      const all = list.filter(Number.isFinite).map(Math.abs).sort();
      return all.length ? all[Math.floor(0.99 * (all.length - 1))] || all[all.length - 1] : 0;
    }

    function surfaces() {
      const f = chosen("field", -1), side = chosen("side", 2);
      const painted = f >= 0 ? strain(f, side) : null;
      const unit = f >= 0 ? data.fields[f].unit : "";
      const most = painted ? top99(painted) || 1 : 1;
      const text = [];
      parts.forEach((p, n) => p.grid.forEach((id, v) => {
        text.push(p.name + "<br>grid " + id + (painted ? "<br>" + digits(painted[firsts[n] + v]) + " " + unit : ""));
      }));
      const faces = [[[], [], []], [[], [], []]], colours = [];
      parts.forEach((p, n) => {
        if (!shown(n)) return;
        const [a, b, c] = p.ijk, first = firsts[n];
        for (let t = 0; t < a.length; t++) {
          const bare = !painted || Number.isNaN(painted[first + a[t]] + painted[first + b[t]] + painted[first + c[t]]);
          const to = faces[bare ? 1 : 0];
          to[0].push(first + a[t]); to[1].push(first + b[t]); to[2].push(first + c[t]);
          if (bare) colours.push(greys[n % greys.length]);
        }
      });
      const mesh = ([i, j, k], more) => Object.assign({
        type: "mesh3d", name: "surface", x: xyz[0], y: xyz[1], z: xyz[2], i, j, k, text, hoverinfo: "text", visible: i.length > 0, flatshading: true,
        lightposition: { x: 1e5, y: -5e4, z: 2e5 },
      }, more);
      const bar = narrow ? { orientation: "h", y: 0, yanchor: "bottom", len: 0.9 } : { len: 0.7, x: 1, xanchor: "right" };
      return [
        mesh(faces[0], {
          intensity: painted || undefined, colorscale: side === 2 ? unsigned : signed, cmin: side === 2 ? 0 : -most, cmax: most, showscale: true,
          lighting: { ambient: 0.85, diffuse: 0.25, specular: 0.02, roughness: 1, fresnel: 0 },
          colorbar: Object.assign({ title: { text: unit, side: narrow ? "top" : "right" }, thickness: 12, tickfont: { size: 11 }, nticks: 6 }, bar),
        }),
        mesh(faces[1], { facecolor: colours, lighting: { ambient: 0.65, diffuse: 0.5, specular: 0.05, roughness: 0.9, fresnel: 0 } }),
      ];
    }

    function lines(packed, colour, width, name) {
      const [x, y, z] = packed.map(unpack);
      return { type: "scatter3d", mode: "lines", x, y, z, line: { color: colour, width }, hoverinfo: "skip", name, visible: x.length > 0 };
    }

    const along = (a, d, s) => a.map((v, i) => v + s * d[i]);
    const columns = (list) => ({ x: list.map((p) => p[0]), y: list.map((p) => p[1]), z: list.map((p) => p[2]) });

    function gauges() {
      const list = data.marks;
      if (!list.length) return [];
      const gaps = list.some((m) => m.gap);
      // A little above the surface, so that it is seen.
      const at = list.map((m) => (m.out ? along(m.at, m.out, 0.004 * size) : m.at));
      const hovertext = list.map((m) => "<b>" + m.name + "</b><br>" + m.note);
      const meta = list.map((m) => m.name + ": " + m.note), colour = list.map((m) => (gaps ? "#34495e" : sides[m.side]));
      const ends = [], shades = [];
      list.forEach((m, i) => {
        if (!m.along) return;
        ends.push(along(at[i], m.along, -0.016 * size), along(at[i], m.along, 0.016 * size), [null, null, null]);
        shades.push(colour[i], colour[i], colour[i]);
      });
      const visible = on("gauges");
      const out = [
        Object.assign({
          type: "scatter3d", mode: on("names") ? "markers+text" : "markers", name: "gauges", text: list.map((m) => m.name), textposition: "top center",
          textfont: { color: colour, size: 12 }, marker: { size: 5.5, color: colour, line: { color: "#fff", width: 1 } }, hovertext, hoverinfo: "text", meta, visible,
        }, columns(at)),
        Object.assign({
          type: "scatter3d", mode: "lines", name: "axes of gauges", hoverinfo: "skip", line: { color: shades, width: 6 }, visible: visible && ends.length > 0,
        }, columns(ends)),
      ];
      const most = Math.max(1e-300, ...list.map((m) => (m.gap ? Math.max(...m.gap) : 0)));
      if (gaps) [["gap before", "rgba(214,137,16,.45)"], ["gap after", "rgba(31,97,141,.85)"]].forEach(([name, fill], k) => {
        out.push(Object.assign({
          type: "scatter3d", mode: "markers", name, hovertext, hoverinfo: "text", meta, visible,
          marker: { size: list.map((m) => (m.gap ? 4 + 34 * Math.sqrt(m.gap[k] / most) : 0)), color: fill, line: { width: 0 } },
        }, columns(at)));
      });
      return out;
    }

    // Tail and tip of an arrow: it ends where the load acts.
    const span = (a) => {
      const d = a.along.map((v) => v * Math.sign(a.share));
      return [d, along(a.at, d, -size * (0.03 + 0.11 * Math.abs(a.share)))];
    };

    function arrows() {
      const set = data.arrows[chosen("arrows", -1)];
      const list = set ? set.list.filter((a) => a.share) : [];
      if (!list.length) return [];
      const points = [], faces = [], colours = [], tails = [], shades = [];
      for (const a of list) {
        const colour = a.moment ? "#7d3c98" : "#0b7a3e";
        const [d, tail] = span(a);
        const helper = Math.abs(d[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
        const cross = (p, q) => [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
        const u0 = cross(d, helper), n = Math.hypot(...u0), u = u0.map((v) => v / n), w = cross(d, u);
        const tip = 0.024 * size;
        const ring = (centre, r) => {
          const first = points.length;
          for (let k = 0; k < 8; k++) points.push(centre.map((v, i) => v + r * (u[i] * Math.cos(k * Math.PI / 4) + w[i] * Math.sin(k * Math.PI / 4))));
          return first;
        };
        const face = (...corners) => { faces.push(corners); colours.push(colour); };
        const cone = (end) => {
          const base = along(end, d, -tip), foot = ring(base, 0.38 * tip), top = points.push(end) - 1, back = points.push(base) - 1;
          for (let k = 0; k < 8; k++) { const next = foot + (k + 1) % 8; face(foot + k, next, top); face(next, foot + k, back); }
        };
        const p = ring(tail, 0.09 * tip), q = ring(along(a.at, d, -tip), 0.09 * tip);
        for (let k = 0; k < 8; k++) { const m = (k + 1) % 8; face(p + k, p + m, q + k); face(p + m, q + m, q + k); }
        cone(a.at);
        if (a.moment) cone(along(a.at, d, -0.8 * tip));
        tails.push(tail);
        shades.push(colour);
      }
      const text = list.map((a) => a.label);
      return [
        Object.assign({
          type: "mesh3d", name: "arrows", i: faces.map((f) => f[0]), j: faces.map((f) => f[1]), k: faces.map((f) => f[2]), facecolor: colours, hoverinfo: "skip",
          lighting: { ambient: 0.75, diffuse: 0.4, specular: 0, fresnel: 0 },
        }, columns(points)),
        Object.assign({
          type: "scatter3d", name: "loads", mode: list.length <= 24 && on("names") ? "markers+text" : "markers", textposition: "bottom center",
          text: text.map((t) => t.replace(/(, grid| \().*/, "")), textfont: { color: shades, size: 11 }, hovertext: text, hoverinfo: "text", meta: text,
          marker: { size: 3.5, color: shades },
        }, columns(tails)),
      ];
    }

    // Room for everything that may be switched on.
    const lo = data.box[0].slice(), hi = data.box[1].slice();
    for (const set of data.arrows) for (const a of set.list) if (a.share) {
      span(a)[1].forEach((v, i) => { lo[i] = Math.min(lo[i], v); hi[i] = Math.max(hi[i], v); });
    }
    const widest = Math.max(...hi.map((v, i) => v - lo[i])) || 1;
    const range = lo.map((v, i) => {
      const pad = Math.max(0.01 * widest, 0.5 * (0.06 * widest - (hi[i] - v)));
      return [v - pad, hi[i] + pad];
    });
    const ratio = range.map(([a, b]) => 2 * (b - a) / widest);

    // Points that the first view must show, in the scene's own coordinates.
    const samples = [];
    const put = (p) => samples.push(p.map((v, i) => ratio[i] * ((v - range[i][0]) / (range[i][1] - range[i][0]) - 0.5)));
    for (let v = 0, step = Math.ceil(xyz[0].length / 3000); v < xyz[0].length; v += step) put(xyz.map((c) => c[v]));
    data.marks.forEach((m) => put(m.at));
    data.arrows.forEach((set) => set.list.forEach((a) => a.share && put(span(a)[1])));
    put(data.box[0]); put(data.box[1]);

    // The camera as near as shows all of them.
    function camera(name) {
      const to = { iso: [1.1, -1.5, 0.95], x: [1, 0, 0.0005], y: [0, -1, 0.0005], z: [0, -0.0005, 1] }[name];
      const n = Math.hypot(...to), e = to.map((v) => v / n);
      const h = Math.hypot(e[0], e[1]), right = [-e[1] / h, e[0] / h, 0];
      const up = [-e[2] * right[1], e[2] * right[0], e[0] * right[1] - e[1] * right[0]];
      const dot = (p, q) => p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
      // Half the field of view is 22.5 degrees up and down.
      const high = Math.tan(Math.PI / 8), wide = high * canvas.clientWidth / Math.max(1, canvas.clientHeight);
      let centre = [0, 0, 0], far = 1;
      for (let pass = 0; pass < 3; pass++) {
        const seen = samples.map((p) => { const q = p.map((v, i) => v - centre[i]); return [dot(q, e), dot(q, right), dot(q, up)]; });
        far = seen.reduce((f, [d, x, y]) => Math.max(f, d + Math.abs(x) / wide, d + Math.abs(y) / high), 0);
        if (pass === 2) break;
        // To the middle of what is seen from there.
        const middle = (k) => {
          const at = seen.map((q) => q[k] / (far - q[0] + 1e-9));
          return 0.5 * far * (at.reduce((a, b) => Math.max(a, b)) + at.reduce((a, b) => Math.min(a, b)));
        };
        const [x, y] = [middle(1), middle(2)];
        centre = centre.map((v, i) => v + x * right[i] + y * up[i]);
      }
      const point = (v) => ({ x: v[0], y: v[1], z: v[2] });
      return { eye: point(centre.map((v, i) => v + 1.08 * far * e[i])), up: { x: 0, y: 0, z: 1 }, center: point(centre) };
    }
    const axis = (text, k) => ({
      title: { text }, range: range[k], showbackground: false, showspikes: false, gridcolor: "#f0f3f6", zerolinecolor: "#e3e8ed", color: "#8695a5",
      nticks: Math.max(2, Math.round(3 * ratio[k])), tickfont: { size: 10 },
    });
    const layout = {
      font, autosize: true, margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false, uirevision: 1, paper_bgcolor: "#fff", hoverlabel: { align: "left" },
      scene: {
        aspectmode: "manual", aspectratio: { x: ratio[0], y: ratio[1], z: ratio[2] }, xaxis: axis("x", 0), yaxis: axis("y", 1), zaxis: axis("z", 2),
        camera: camera("iso"), dragmode: "orbit", uirevision: 1, hovermode: "closest",
      },
    };
    const edges = lines(data.edges, "rgba(60,74,90,.8)", 1.2, "edges"), rods = lines(data.bars, "#5b6b7c", 4, "bars");
    function draw() {
      edges.visible = edges.x.length > 0 && on("edges");
      return Plotly.react(canvas, surfaces().concat([edges, rods], gauges(), arrows()), layout, config);
    }
    const pick = figure.querySelector(".pick");
    // The gauge nearest to a place on the screen, within a fingertip; one on the far side of a sheet counts, too.
    function gaugeAt(event) {
      const shown = canvas._fullLayout && canvas._fullLayout.scene && canvas._fullLayout.scene._scene;
      if (!shown || !on("gauges")) return null;
      const { model, view, projection } = shown.glplot.cameraParams;
      const times = (m, v) => [0, 1, 2, 3].map((r) => m[r] * v[0] + m[4 + r] * v[1] + m[8 + r] * v[2] + m[12 + r] * v[3]);
      const box = shown.container.getBoundingClientRect();
      let best = null, near = touch ? 22 : 11;
      for (const m of data.marks) {
        const p = times(projection, times(view, times(model, m.at.map((v, k) => v * shown.dataScale[k]).concat(1))));
        const away = Math.hypot(box.left + box.width * (1 + p[0] / p[3]) / 2 - event.clientX, box.top + box.height * (1 - p[1] / p[3]) / 2 - event.clientY);
        if (away < near) { near = away; best = m; }
      }
      return best;
    }
    let gauge = null;
    const point = (event) => {
      if (event.type === "pointermove" && event.buttons) return;
      gauge = gaugeAt(event);
      if (gauge) pick.textContent = gauge.name + ": " + gauge.note;
    };
    canvas.addEventListener("pointermove", point, true);
    canvas.addEventListener("pointerup", point, true);
    const said = (event) => {
      if (gauge) return;
      const p = event.points[0];
      const text = (p.data.meta || p.data.text || [])[p.pointNumber];
      if (text) pick.textContent = String(text).replace(/<br>/g, ", ");
    };
    figure.addEventListener("change", (event) => {
      if (event.target.dataset.role === "all") {
        figure.querySelectorAll("[data-part]").forEach((box) => { box.checked = event.target.checked; });
      }
      draw();
    });
    figure.querySelectorAll("[data-view]").forEach((button) => {
      button.addEventListener("click", () => Plotly.relayout(canvas, { "scene.camera": camera(button.dataset.view) }));
    });
    return draw().then(() => {
      canvas.on("plotly_hover", said);
      canvas.on("plotly_click", said);
    });
  }

  // One after another, so that the page answers in between.
  async function all() {
    for (const figure of document.querySelectorAll("[data-figure]")) {
      const data = JSON.parse(figure.querySelector('script[type="application/json"]').textContent);
      await (figure.dataset.figure === "scene" ? scene : chart)(figure, data);
      figure.dataset.drawn = "yes";
      await new Promise((done) => setTimeout(done, 0));
    }
    document.documentElement.dataset.drawn = "all";
  }
  all();
})();
