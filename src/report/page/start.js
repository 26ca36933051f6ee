// One figure after another, so that the page answers in between.
async function all() {
  for (const figure of document.querySelectorAll("[data-figure]")) {
    try {
      const data = JSON.parse(figure.querySelector('script[type="application/json"]').textContent);
      if (figure.dataset.figure === "chart") chart(figure, data);
      else await scene(figure, data);
    } catch (e) {
      // The others are still worth drawing.
      figure.append(Object.assign(document.createElement("p"), { textContent: "This figure could not be drawn: " + e.message }));
      console.error(e);
    }
    figure.dataset.drawn = "yes";
    await new Promise((done) => setTimeout(done, 0));
  }
  subjects();
  document.documentElement.dataset.drawn = "all";
}

// A gauge in the subject of a finding is shown in all pictures while the pointer or the focus is on its name.
function subjects() {
  const scenes = [...document.querySelectorAll("[data-figure]")].map((f) => f.scene).filter(Boolean), labels = [...document.querySelectorAll(".first svg text")];
  for (const span of document.querySelectorAll("[data-subject]")) {
    const name = span.textContent.trim(), texts = labels.filter((t) => t.textContent.trim() === name);
    const shown = scenes.filter((s) => s.marks.some((m) => m.name === name));
    if (!texts.length && !shown.length) continue;
    const show = (lit) => { texts.forEach((t) => t.classList.toggle("lit", lit)); shown.forEach((s) => s.light(lit ? name : "")); };
    Object.assign(span, { className: "subject", tabIndex: 0, title: "Show the gauge in the pictures" });
    for (const on of ["pointerenter", "focus"]) span.addEventListener(on, () => show(true));
    for (const off of ["pointerleave", "blur"]) span.addEventListener(off, () => show(false));
  }
}
all();
