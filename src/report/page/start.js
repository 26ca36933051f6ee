// One figure after another, so that the page answers in between.
async function all() {
  for (const figure of document.querySelectorAll("[data-figure]")) {
    const data = JSON.parse(figure.querySelector('script[type="application/json"]').textContent);
    if (figure.dataset.figure === "chart") chart(figure, data);
    else await scene(figure, data);
    figure.dataset.drawn = "yes";
    await new Promise((done) => setTimeout(done, 0));
  }
  document.documentElement.dataset.drawn = "all";
}
all();
