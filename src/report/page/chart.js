// Figures in two dimensions, as SVG.
const PALETTE = ["#1f618d", "#c0392b", "#0b7a3e", "#d68910", "#7d3c98", "#148f9c", "#8e5a2b", "#566573", "#b03a7c", "#6b8e23"];
const HEAT = [[0, [31, 78, 140]], [0.25, [134, 177, 216]], [0.5, [246, 247, 248]], [0.75, [238, 157, 114]], [1, [178, 24, 43]]];
const ROW = 14;
const BAND = "rgba(214,137,16,.16)";

// As much of a text as fits.
function fitted(text, room) {
  if (widthOf(text) <= room) return text;
  let n = text.length;
  while (n > 1 && widthOf(text.slice(0, n) + "…") > room) n--;
  return text.slice(0, n) + "…";
}

// A step of 1, 2 or 5 times a power of ten, for so many marks at most.
function stepFor(span, most) {
  const raw = span / Math.max(1, most), power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((k) => k * power >= raw * 0.999999);
}

// An axis: values or names to pixels between two ends.
function scaleOf(axis, values, from, to, most) {
  if (axis.names) {
    // Names go from left to right, and down from the top.
    const n = Math.max(1, axis.names.length), first = axis.upward ? to : from, last = axis.upward ? from : to;
    return { at: (i) => first + (last - first) * (i + 0.5) / n, marks: axis.names.map((t, i) => [i, t]), wide: Math.abs(to - from) / n };
  }
  let [lo, hi] = axis.range || [Infinity, -Infinity];
  if (!axis.range) for (const v of values) if (Number.isFinite(v) && (!axis.log || v > 0)) { lo = Math.min(lo, v); hi = Math.max(hi, v); }
  if (!(lo <= hi)) [lo, hi] = axis.log ? [1, 10] : [0, 1];
  if (axis.log) {
    const a = Math.floor(Math.log10(lo) + 1e-9), b = Math.max(a + 1, Math.ceil(Math.log10(hi) - 1e-9));
    const stride = Math.ceil((b - a) / Math.max(2, most)), marks = [];
    for (let p = a; p <= b; p += stride) marks.push([10 ** p, significant(10 ** p, 2)]);
    return { at: (v) => v > 0 ? from + (to - from) * (Math.log10(v) - a) / (b - a) : NaN, marks, lo: 10 ** a, hi: 10 ** b };
  }
  if (axis.zero) { lo = Math.min(lo, 0); hi = Math.max(hi, 0); }
  // What differs by rounding alone is one value.
  if (!(hi - lo > 1e-9 * Math.max(Math.abs(lo), Math.abs(hi)))) { lo -= Math.abs(lo) * 0.1 || 0.5; hi += Math.abs(hi) * 0.1 || 0.5; }
  if (!axis.range) { const pad = 0.04 * (hi - lo); lo = axis.zero && lo === 0 ? 0 : lo - pad; hi = axis.zero && hi === 0 ? 0 : hi + pad; }
  const step = stepFor(hi - lo, most), marks = [];
  const digits = Math.max(3, Math.ceil(Math.log10(Math.max(Math.abs(lo), Math.abs(hi)) / step)) + 1);
  if (axis.at) for (const v of axis.at) { if (v >= lo && v <= hi) marks.push([v, String(v)]); }
  else for (let k = Math.ceil(lo / step - 1e-9); k * step <= hi + 1e-9 * step; k++) marks.push([k * step, significant(k * step, Math.min(12, digits))]);
  return { at: (v) => from + (to - from) * (v - lo) / (hi - lo), back: (p) => lo + (hi - lo) * (p - from) / (to - from), marks, lo, hi };
}

// Words of a point, from `%{x:.4}` and the like: a value to so many digits.
function worded(trace, i, j) {
  const template = trace.hovertemplate;
  const name = trace.name || "";
  const at = (list, k) => (list ? list[k] : undefined);
  if (!template) return name + ": " + significant(trace.y[i], 5) + " at " + significant(trace.x[i], 6);
  const extra = /<extra>(.*?)<\/extra>/.exec(template);
  const text = template.replace(/<extra>.*?<\/extra>/, "").replace(/<br>/g, ", ").replace(/%\{(\w+)(?:\[(\d+)\])?(?::\.(\d+))?\}/g, (_, key, index, digits) => {
    let v = key === "customdata" && j !== undefined ? at(at(trace.customdata, i), j) : key === "y" && j !== undefined ? trace.y[i] : key === "x" && j !== undefined ? trace.x[j] : at(trace[key], i);
    if (index !== undefined) v = at(v, +index);
    return typeof v === "number" ? significant(v, digits ? +digits : 5) : String(v === undefined || v === null ? "none" : v);
  });
  return extra && extra[1] ? extra[1] + ": " + text : text;
}

function heatColour(share) {
  const t = Math.min(1, Math.max(0, (share + 1) / 2));
  const k = Math.min(HEAT.length - 2, HEAT.findIndex((s, i) => i + 1 < HEAT.length && t <= HEAT[i + 1][0]));
  const [a, b] = [HEAT[k], HEAT[k + 1]], f = (t - a[0]) / (b[0] - a[0]);
  return "rgb(" + a[1].map((v, i) => Math.round(v + f * (b[1][i] - v))).join(",") + ")";
}

// What an axis is, from its layout and the values on it.
function axisOf(layout, traces, key) {
  const said = layout[key + "axis"] || {};
  const values = traces.flatMap((t) => t[key] || []);
  const named = said.type === "category" || values.some((v) => typeof v === "string");
  return {
    names: named ? [...new Set(values)] : null, title: said.title ? said.title.text : (traces.find((t) => t[key + "title"]) || {})[key + "title"] || "", range: said.range, log: said.type === "log",
    zero: said.rangemode === "tozero", at: said.tickvals, upward: key === "y", above: said.side === "top",
  };
}

// Colours of a map with what their ends mean.
function mapLegend() {
  const box = document.createElement("div"), ramp = document.createElement("i");
  box.className = "legend";
  ramp.style.cssText = "width:140px;background:linear-gradient(90deg," + [-1, -0.5, 0, 0.5, 1].map(heatColour).join(",") + ")";
  box.append("−100 %", ramp, "100 % of the largest magnitude in the column");
  return box;
}

function legendOf(traces, colour, band) {
  if (traces.some((t) => t.type === "heatmap")) return mapLegend();
  const shown = traces.map((t, i) => [t, i]).filter(([t]) => t.name && t.showlegend !== false && t.type !== "heatmap");
  if (shown.length < 2 && !band) return null;
  const box = document.createElement("div");
  box.className = "legend";
  for (const [t, i] of shown) {
    const item = document.createElement("span"), mark = document.createElement("i");
    mark.style.background = t.fillcolor || colour(i);
    item.append(mark, t.name);
    box.append(item);
  }
  if (band) {
    const item = document.createElement("span"), mark = document.createElement("i");
    mark.style.background = BAND;
    item.append(mark, band.name);
    box.append(item);
  }
  return box;
}

function colourOf(traces) {
  return (i) => {
    const t = traces[i];
    const own = (t.line && t.line.color) || (t.marker && typeof t.marker.color === "string" && t.marker.color);
    return own || PALETTE[i % PALETTE.length];
  };
}

function drawHeat(root, trace, sx, sy) {
  const [w, h] = [Math.max(1, sx.wide - 1), Math.max(1, sy.wide - 1)];
  trace.z.forEach((row, r) => row.forEach((v, c) => {
    svg("rect", { x: sx.at(c) - w / 2, y: sy.at(r) - h / 2, width: w, height: h, fill: v === null ? "#fff" : heatColour(v) }, root);
  }));
}

function drawBars(root, traces, colour, sx, sy, names) {
  const bars = traces.filter((t) => t.type === "bar"), wide = 0.8 * sx.wide / Math.max(1, bars.length);
  traces.forEach((t, i) => {
    const k = bars.indexOf(t);
    if (k < 0) return;
    t.y.forEach((v, j) => {
      if (v === null) return;
      const x = sx.at(names.indexOf(t.x[j])) + (k - bars.length / 2) * wide, foot = sy.at(0), top = sy.at(v);
      svg("rect", { x, y: Math.min(foot, top), width: Math.max(0.5, wide - 0.5), height: Math.abs(foot - top), fill: colour(i) }, root);
    });
  });
}

const fixed = (v) => Math.round(v * 10) / 10;

// Lines with gaps where nothing is known.
function pathOf(xs, ys) {
  let text = "", open = false;
  for (let i = 0; i < xs.length; i++) {
    if (Number.isFinite(xs[i]) && Number.isFinite(ys[i])) { text += (open ? "L" : "M") + fixed(xs[i]) + " " + fixed(ys[i]); open = true; } else open = false;
  }
  return text;
}

// The ends of the interval about a value, none where one of them is not known.
function intervalAt(t, k) {
  const { array, arrayminus } = t.error_x, known = [t.x[k], array[k], arrayminus[k]];
  return known.includes(null) ? [null, null] : [t.x[k] - arrayminus[k], t.x[k] + array[k]];
}

function drawScatter(root, traces, colour, px, py) {
  let before = null;
  traces.forEach((t, i) => {
    if (t.type !== "scatter") return;
    const xs = t.x.map(px), ys = t.y.map(py), line = t.line || {}, marker = t.marker || {}, mode = t.mode || "lines";
    if (t.fill === "tonexty" && before) {
      for (let a = 0; a < xs.length;) {
        while (a < xs.length && !(Number.isFinite(ys[a]) && Number.isFinite(before[a]))) a++;
        let b = a;
        while (b < xs.length && Number.isFinite(ys[b]) && Number.isFinite(before[b])) b++;
        if (b > a) {
          const there = pathOf(xs.slice(a, b), ys.slice(a, b)), back = pathOf(xs.slice(a, b).reverse(), before.slice(a, b).reverse());
          svg("path", { d: there + back.replace("M", "L") + "Z", fill: t.fillcolor, stroke: "none" }, root);
        }
        a = b;
      }
    }
    before = ys;
    if (mode.includes("lines") && line.width !== 0) svg("path", { d: pathOf(xs, ys), fill: "none", stroke: colour(i), "stroke-width": line.width || 1.6 }, root);
    if (t.error_x) t.x.forEach((_, k) => {
      const [a, b] = intervalAt(t, k).map(px);
      if (!Number.isFinite(a + b + ys[k])) return;
      // A range is a wide bar, an interval a thin line with caps.
      if (t.error_x.span) svg("rect", { x: Math.min(a, b), y: ys[k] - 5, width: Math.abs(b - a), height: 10, fill: colour(i), "fill-opacity": 0.35 }, root);
      else svg("path", { d: `M${a} ${ys[k]}H${b}M${a} ${ys[k] - 5}v10M${b} ${ys[k] - 5}v10`, stroke: colour(i), "stroke-width": 2 }, root);
    });
    if (!mode.includes("markers")) return;
    const r = (marker.size || 6) / 2, group = svg("g", { fill: colour(i), "fill-opacity": marker.opacity || 1 }, root);
    for (let k = 0; k < xs.length; k++) {
      if (!Number.isFinite(xs[k] + ys[k])) continue;
      if (marker.symbol === "line-ew-open") svg("path", { d: `M${xs[k] - r} ${ys[k]}h${2 * r}`, stroke: colour(i), "stroke-width": 2 }, group);
      else if (marker.symbol === "diamond-open") svg("path", { d: `M${xs[k]} ${ys[k] - r}l${r} ${r}l${-r} ${r}l${-r} ${-r}Z`, fill: "none", stroke: colour(i) }, group);
      else if (marker.symbol === "x") svg("path", { d: `M${xs[k] - r} ${ys[k] - r}l${2 * r} ${2 * r}m${-2 * r} 0l${2 * r} ${-2 * r}`, stroke: colour(i), "stroke-width": 2 }, group);
      else svg("circle", { cx: fixed(xs[k]), cy: fixed(ys[k]), r }, group);
    }
  });
}

// Marks and words of both axes; what does not fit is left out, never drawn over.
function drawAxes(root, frame, sx, sy, ax, ay) {
  const { left, right, top, bottom } = frame;
  const grid = svg("g", { stroke: "#e6eaef" }, root), words = svg("g", { fill: "#516173" }, root);
  words.style.font = FONT;
  if (!ax.names) for (const [v] of sx.marks) svg("path", { d: `M${fixed(sx.at(v))} ${top}V${bottom}` }, grid);
  if (!ay.names) for (const [v] of sy.marks) svg("path", { d: `M${left} ${fixed(sy.at(v))}H${right}` }, grid);
  svg("rect", { x: left, y: top, width: right - left, height: bottom - top, fill: "none", stroke: "#c3ccd6" }, root);
  const across = !frame.upright;
  let last = -Infinity;
  for (const [v, t] of sx.marks) {
    const x = sx.at(v), wide = across ? widthOf(t) : ROW - 2;
    const from = across ? Math.min(Math.max(x - wide / 2, 0), frame.width - wide) : x - wide / 2;
    if (from < last + (across ? 6 : 1)) continue;
    last = from + wide;
    if (across) svg("text", { x: from, y: ax.above ? top - 6 : bottom + 18 }, words, t);
    else svg("text", { transform: `translate(${fixed(x + 4)} ${ax.above ? top - 5 : bottom + 6}) rotate(-90)`, "text-anchor": ax.above ? "start" : "end" }, words, fitted(t, frame.tall));
  }
  let low = Infinity;
  for (const [v, t] of sy.marks.slice().sort((a, b) => sy.at(b[0]) - sy.at(a[0]))) {
    const y = sy.at(v);
    if (y + ROW / 2 > low) continue;
    low = y - ROW / 2;
    svg("text", { x: left - 6, y: y + 4, "text-anchor": "end" }, words, ay.names ? fitted(t, left - 10) : t);
  }
  if (ax.title) svg("text", { x: (left + right) / 2, y: frame.height - 5, "text-anchor": "middle" }, words, fitted(ax.title, right - left));
  if (ay.title) svg("text", { x: 2, y: 12 }, words, fitted(ay.title, frame.width - 4));
}

// Sizes around the field of a figure.
function frameOf(width, height, ax, ay, values, equal) {
  const longest = (names) => Math.max(0, ...names.map((t) => widthOf(t)));
  const trial = scaleOf(ay, values, height, 0, height / 40);
  const left = Math.min(0.38 * width, Math.max(28, longest(trial.marks.map((m) => m[1])) + 10));
  let right = width - 12;
  const upright = Boolean(ax.names) && longest(ax.names) + 6 > (right - left) / ax.names.length;
  const tall = upright ? Math.min(110, longest(ax.names) + 8) : ROW + 9;
  const top = (ay.title ? ROW + 8 : 8) + (ax.above ? tall : 0);
  let bottom = height - (ax.title ? ROW + 6 : 4) - (ax.above ? 0 : tall);
  if (equal) {
    const side = Math.min(right - left, bottom - top);
    right = left + side;
    bottom = top + side;
    height = bottom + tall + (ax.title ? ROW + 6 : 4);
  }
  return { width, height, left, right, top, bottom, upright, tall };
}

function chart(figure, data) {
  const canvas = figure.querySelector(".canvas"), choice = figure.querySelector("[data-role=choice]");
  const height = canvas.clientHeight || 380;
  canvas.style.height = "auto";
  const said = document.createElement("p");
  said.className = "pick";
  said.setAttribute("aria-live", "polite");
  let zoom = null;

  function draw() {
    const traces = data.choices[choice ? +choice.value : 0] || [], colour = colourOf(traces);
    const width = Math.max(200, canvas.clientWidth);
    const ax = axisOf(data.layout, traces, "x"), ay = axisOf(data.layout, traces, "y");
    if (zoom && !ax.names) ax.range = zoom;
    const reach = (key) => traces.flatMap((t) => {
      const list = (t[key] || []).filter((v, i) => typeof v === "number" && (!zoom || key === "x" || (t.x[i] >= zoom[0] && t.x[i] <= zoom[1])));
      return key === "x" && t.error_x ? list.concat(t.x.flatMap((_, k) => intervalAt(t, k)).filter((v) => v !== null)) : t.type === "bar" && key === "y" ? list.concat([0]) : list;
    });
    const equal = Boolean(data.layout.equal), band = data.layout.band;
    if (zoom && equal) ay.range = zoom;
    const both = equal ? reach("x").concat(reach("y")) : null;
    const frame = frameOf(width, height, ax, ay, both || reach("y"), equal);
    const root = svg("svg", { width, height: frame.height, viewBox: `0 0 ${width} ${frame.height}`, role: "img", "aria-label": figure.getAttribute("aria-label") });
    const sx = scaleOf(ax, both || reach("x"), frame.left, frame.right, (frame.right - frame.left) / 80);
    const sy = scaleOf(ay, both || reach("y"), frame.bottom, frame.top, (frame.bottom - frame.top) / 40);
    drawAxes(root, frame, sx, sy, ax, ay);
    const id = "clip" + [...document.querySelectorAll("[data-figure]")].indexOf(figure);
    const clip = svg("clipPath", { id }, root);
    svg("rect", { x: frame.left, y: frame.top, width: frame.right - frame.left, height: Math.max(0, frame.bottom - frame.top) }, clip);
    const field = svg("g", { "clip-path": `url(#${id})` }, root);
    const px = (v) => (ax.names ? sx.at(ax.names.indexOf(v)) : v === null ? NaN : sx.at(v));
    const py = (v) => (ay.names ? sy.at(ay.names.indexOf(v)) : v === null ? NaN : sy.at(v));
    if (band) {
      const [a, b] = band.ends.map((v) => Math.min(frame.right, Math.max(frame.left, sx.at(v))));
      svg("rect", { x: a, y: frame.top, width: Math.max(0, b - a), height: frame.bottom - frame.top, fill: BAND }, field);
    }
    for (const t of traces) if (t.type === "heatmap") drawHeat(field, t, sx, sy);
    if (ax.names) drawBars(field, traces, colour, sx, sy, ax.names);
    drawScatter(field, traces, colour, px, py);
    const legend = legendOf(traces, colour, band);
    canvas.replaceChildren(...(legend ? [legend] : []), root, said);
    listen(root, frame, { ax, ay, sx, sy, px, py, traces });
  }

  // Words of what is under the pointer; a drag across zooms an axis of numbers, a double click shows all of it.
  function listen(root, frame, s) {
    const zooms = !s.ax.names && s.sx.back && s.traces.some((t) => t.mode === "lines");
    if (zooms) root.style.touchAction = "pan-y";
    const x = (event) => event.clientX - root.getBoundingClientRect().left, y = (event) => event.clientY - root.getBoundingClientRect().top;
    let from = null, band = null;
    root.addEventListener("pointerdown", (event) => {
      if (!zooms) return;
      from = x(event);
      root.setPointerCapture(event.pointerId);
      band = svg("rect", { x: from, y: frame.top, width: 0, height: frame.bottom - frame.top, fill: "rgba(31,97,141,.15)" }, root);
    });
    root.addEventListener("pointermove", (event) => {
      if (band) {
        band.setAttribute("x", Math.min(from, x(event)));
        band.setAttribute("width", Math.abs(x(event) - from));
      } else said.textContent = wordsAt(s, x(event), y(event)) || said.textContent;
    });
    root.addEventListener("pointercancel", () => { if (band) band.remove(); band = null; });
    root.addEventListener("pointerup", (event) => {
      if (!band) return;
      band.remove();
      band = null;
      const ends = [from, x(event)].map((p) => s.sx.back(Math.min(frame.right, Math.max(frame.left, p)))).sort((a, b) => a - b);
      if (Math.abs(x(event) - from) > 12) { zoom = ends; draw(); } else said.textContent = wordsAt(s, x(event), y(event));
    });
    if (zooms) root.addEventListener("dblclick", () => { zoom = null; draw(); });
    if (!said.textContent) said.textContent = zooms ? "Drag across to zoom, double click to show the whole figure." : "Point at the figure to read its values.";
  }

  function wordsAt(s, x, y) {
    const heat = s.traces.find((t) => t.type === "heatmap");
    if (heat) {
      const c = s.ax.names.findIndex((_, i) => Math.abs(s.sx.at(i) - x) <= s.sx.wide / 2), r = s.ay.names.findIndex((_, i) => Math.abs(s.sy.at(i) - y) <= s.sy.wide / 2);
      return c < 0 || r < 0 ? "" : worded(heat, r, c);
    }
    let best = null, near = Infinity;
    for (const t of s.traces) if (t.hoverinfo !== "skip" || t.hovertemplate) (t.x || []).forEach((v, i) => {
      const away = t.mode === "lines" ? Math.abs(s.px(v) - x) + 1e-3 * Math.abs(s.py(t.y[i]) - y) : Math.hypot(s.px(v) - x, t.type === "bar" ? 0 : s.py(t.y[i]) - y);
      if (away < near) { near = away; best = [t, i]; }
    });
    if (!best || near > 60) return "";
    const [t, i] = best;
    return (t.mode === "lines" && s.ax.title ? s.ax.title + " " + significant(t.x[i], 5) + ": " : "") + worded(t, i);
  }

  draw();
  if (choice) matching(figure, choice);
  if (choice) choice.addEventListener("change", () => { zoom = null; draw(); matching(figure, choice); });
  let known = canvas.clientWidth;
  new ResizeObserver(() => { if (canvas.clientWidth !== known) { known = canvas.clientWidth; draw(); } }).observe(canvas);
}

// In a table next to a figure, the rows of what the figure shows.
function matching(figure, choice) {
  const name = choice.selectedOptions[0].textContent;
  const rows = [...figure.parentElement.querySelectorAll(":scope > .scroll tbody tr")], of = (row) => row.cells[0].textContent === name;
  if (rows.some(of)) for (const row of rows) row.hidden = !of(row);
}
