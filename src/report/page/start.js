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
  document.documentElement.dataset.drawn = "all";
}
all();
