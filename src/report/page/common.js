// For figures and the model alike.
const FONT = "11px system-ui, sans-serif";
const ruler = document.createElement("canvas").getContext("2d");
function widthOf(text, font) {
  ruler.font = font || FONT;
  return ruler.measureText(text).width;
}

// A number in words, to so many digits.
function significant(v, digits) {
  if (!Number.isFinite(v)) return "none";
  const short = +v.toPrecision(digits);
  const size = Math.abs(short);
  return size !== 0 && (size < 1e-4 || size >= 1e7) ? short.toExponential().replace("e+", "e") : String(short).replace("-", "−");
}

// The same to a multiple of `grain`, a power of ten.
const rounded = (v, grain) => significant(Math.round(v / grain) * grain, Math.min(15, Math.max(1, Math.ceil(Math.log10(Math.abs(v) / grain + 1)) + 1)));

function svg(name, attributes, parent, text) {
  const e = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const k in attributes) e.setAttribute(k, attributes[k]);
  if (text !== undefined) e.textContent = text;
  if (parent) parent.appendChild(e);
  return e;
}

function svgSet(e, attributes) {
  for (const k in attributes) e.setAttribute(k, attributes[k]);
}
