"""Opens reports in headless Chromium, wide and at the width of a phone, and says what is seen there.

    python open_report.py REPORT.html...

Prints one JSON object: by file and width the seconds until all is drawn, errors of the console, requests that leave the file, titles,
what each figure shows, whether the page is wider than the screen, and what the scene says when a gauge is pointed at. Exit code 77
where playwright or chromium is absent. Pictures go to the folder that SHOTS names.
"""
import base64
import json
import os
import re
import shutil
import sys
import time

try:
    from playwright.sync_api import sync_playwright
except Exception as e:
    print(f"absent: {e}")
    sys.exit(77)

chromium = shutil.which("chromium") or shutil.which("chromium-browser")
if chromium is None:
    print("absent: chromium")
    sys.exit(77)

FLAGS = [
    "--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic",
    "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
]

# What Chromium says of software rendering, and of our own look at the pixels.
HARMLESS = re.compile("GPU stall|willReadFrequently")

# Share of the pixels that differ from the one in the corner, and the number of colours, of a PNG.
COLOURS = """async (png) => {
  const image = new Image();
  image.src = "data:image/png;base64," + png;
  await image.decode();
  const canvas = document.createElement("canvas");
  canvas.width = image.width; canvas.height = image.height;
  const context = canvas.getContext("2d");
  context.drawImage(image, 0, 0);
  const words = new Uint32Array(context.getImageData(0, 0, image.width, image.height).data.buffer);
  let other = 0;
  for (const w of words) if (w !== words[0]) other++;
  return { other: other / words.length, colours: new Set(words).size };
}"""

# Where the gauges stand on the screen, and their names.
GAUGES = """() => {
  const plot = document.querySelector(".scene .canvas");
  const scene = plot._fullLayout.scene._scene;
  const box = scene.container.getBoundingClientRect();
  const { model, view, projection } = scene.glplot.cameraParams;
  const times = (m, v) => [0, 1, 2, 3].map((r) => [0, 1, 2, 3].reduce((s, c) => s + m[4 * c + r] * v[c], 0));
  const out = [];
  for (const trace of plot.data.filter((t) => t.name === "gauges" && t.visible !== false)) {
    trace.x.forEach((x, i) => {
      const at = [x, trace.y[i], trace.z[i]].map((v, k) => v * scene.dataScale[k]).concat([1]);
      const p = times(projection, times(view, times(model, at)));
      out.push({ name: trace.text[i], x: box.left + (box.width * (1 + p[0] / p[3])) / 2, y: box.top + (box.height * (1 - p[1] / p[3])) / 2 });
    });
  }
  return out;
}"""


def look(browser, path, width):
    errors, requests = [], []
    phone = width < 600
    context = browser.new_context(viewport={"width": width, "height": 800}, has_touch=phone, is_mobile=phone, device_scale_factor=1)
    page = context.new_page()
    page.on("console", lambda m: errors.append(m.text) if m.type in ("error", "warning") and not HARMLESS.search(m.text) else None)
    page.on("pageerror", lambda e: errors.append(str(e)))
    page.on("request", lambda r: requests.append(r.url) if not r.url.startswith(("file:", "data:", "blob:")) else None)
    start = time.time()
    page.goto("file://" + os.path.abspath(path))
    figures = page.locator("[data-figure]").count()
    if figures:
        page.wait_for_selector("html[data-drawn=all]", timeout=60000, state="attached")
    page.wait_for_timeout(300)
    seen = {
        "seconds": time.time() - start - 0.3,
        "titles": page.locator("h2").all_inner_texts(),
        "wider": page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth"),
        "figures": [],
    }
    for i in range(figures):
        figure = page.locator("[data-figure]").nth(i)
        canvas = figure.locator(".canvas")
        canvas.scroll_into_view_if_needed()
        page.wait_for_timeout(100)
        png = canvas.screenshot()
        drawn = page.evaluate(COLOURS, base64.b64encode(png).decode())
        seen["figures"].append({"kind": figure.get_attribute("data-figure"), "label": figure.get_attribute("aria-label"), **drawn})
    if page.locator(".scene").count():
        page.locator(".scene .canvas").scroll_into_view_if_needed()
        page.wait_for_timeout(300)
        gauges = page.evaluate(GAUGES)
        seen["picked"] = []
        for gauge in gauges[:12]:
            page.mouse.move(gauge["x"] + 40, gauge["y"] + 40)
            page.wait_for_timeout(80)
            page.mouse.move(gauge["x"], gauge["y"])
            page.wait_for_timeout(250)
            seen["picked"].append([gauge["name"], page.locator(".scene .pick").inner_text()])
            if seen["picked"][-1][1].startswith(gauge["name"] + ":"):
                break
    if os.environ.get("SHOTS"):
        name = os.path.basename(os.path.dirname(os.path.abspath(path))) + f"-{width}.png"
        page.evaluate("window.scrollTo(0, 0)")
        page.screenshot(path=os.path.join(os.environ["SHOTS"], name), full_page=True)
    seen["errors"], seen["requests"] = errors, requests
    context.close()
    return seen


with sync_playwright() as play:
    browser = play.chromium.launch(executable_path=chromium, args=FLAGS)
    found = {path: {str(width): look(browser, path, width) for width in (1280, 390)} for path in sys.argv[1:]}
    browser.close()
print(json.dumps(found))
