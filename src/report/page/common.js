// For figures and the model alike.
const FONT = "11px system-ui, sans-serif";
const ruler = document.createElement("canvas").getContext("2d");
function widthOf(text, font) {
  ruler.font = font || FONT;
  return ruler.measureText(text).width;
}

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
