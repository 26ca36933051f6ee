"""Opens reports in headless Chromium, wide and at the width of a phone, and says what is seen there.

    python open_report.py REPORT.html...

Prints one JSON object: by file and width the seconds until all is drawn, errors of the console, requests that leave the file, titles,
what each figure shows, texts that lie over each other, whether the page is wider than the screen, whether the wheel scrolls it, the size
of the model drawn, and what the scene says when a gauge is pointed at. Exit code 77 where playwright or chromium is absent. Pictures go to
the folder that SHOTS names.
"""
import base64
import json
import os
import sys
import time

from browser import HARMLESS, OVERLAPS, chromium

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
  const { camera, marks, box, lifted } = document.querySelector(".scene").scene, at = box.getBoundingClientRect();
  return marks.map((m) => { const p = camera.project(lifted(m)); return { name: m.name, x: at.left + box.clientLeft + p[0], y: at.top + box.clientTop + p[1] }; });
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
        "bytes": os.path.getsize(path),
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
        view = page.locator(".scene .canvas")
        view.scroll_into_view_if_needed()
        page.wait_for_timeout(300)
        seen["size"] = page.locator("[data-role=size]").inner_text()
        seen["views"] = page.locator(".scene [data-view]").all_inner_texts()
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
        if not phone:
            seen["wheel"] = wheel(page, view)
        # Every view, so that no names lie over each other in any.
        seen["overlaps"] = []
        for button in page.locator(".scene [data-view]").all():
            button.click()
            page.wait_for_timeout(150)
            seen["overlaps"] += page.evaluate(OVERLAPS)
    else:
        seen["overlaps"] = page.evaluate(OVERLAPS)
    if os.environ.get("SHOTS"):
        name = os.path.basename(os.path.dirname(os.path.abspath(path))) + f"-{width}.png"
        page.evaluate("window.scrollTo(0, 0)")
        page.screenshot(path=os.path.join(os.environ["SHOTS"], name), full_page=True)
    seen["errors"], seen["requests"] = errors, requests
    context.close()
    return seen


def wheel(page, view):
    """How far the wheel scrolls the page over the picture, before and after it is clicked, and by how much it zooms."""
    far = "document.querySelector('.scene').scene.camera.far"
    out = {}
    for name in ["before", "after"]:
        page.evaluate("window.scrollTo(0, 0)")
        view.scroll_into_view_if_needed()
        box = view.bounding_box()
        x, y = box["x"] + 20, box["y"] + 20
        if name == "after":
            page.mouse.click(x, y)
        page.mouse.move(x, y)
        top, was = page.evaluate("window.scrollY"), page.evaluate(far)
        page.mouse.wheel(0, -60 if top > 60 else 60)
        page.wait_for_timeout(200)
        out[name] = {"scrolled": abs(page.evaluate("window.scrollY") - top), "zoom": page.evaluate(far) / was}
    return out


def sees_overlaps(browser):
    """Of two words over each other, one beside them and one that is clipped away, the first pair is said."""
    page = browser.new_page()
    at = "margin:0;position:absolute;left:20px;top:%dpx"
    page.set_content(
        f"<p style='{at % 20}'>one</p><p style='{at % 26}'>two</p><p style='{at % 90}'>three</p>"
        f"<div style='{at % 120};height:10px;overflow:hidden'><p style='margin:0'>a<br>b</p></div><p style='{at % 132}'>four</p>"
    )
    pairs = page.evaluate(OVERLAPS)
    page.close()
    return pairs


with chromium() as browser:
    pairs = sees_overlaps(browser)
    assert pairs == [["one", "two"]], pairs
    found = {path: {str(width): look(browser, path, width) for width in (1280, 390)} for path in sys.argv[1:]}
print(json.dumps(found))
