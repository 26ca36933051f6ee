"""Opens reports in headless Chromium, on a wide screen and with the width of a phone, and prints the observations.

    python open_report.py REPORT.html...

Prints one JSON object by file and width. It has the seconds until everything is drawn, errors of the console, requests
that leave the file, and titles. It also has the content of each figure, overlapping texts, whether the page is wider
than the screen, and whether the wheel scrolls it. Finally, it has the size of the model, and the name that the scene
shows if the pointer is on a gauge. Exit code 77 if playwright or chromium is missing. Pictures go to the folder in
SHOTS.
"""
import base64
import json
import os
import sys
import time

from browser import AXE_CORE, HARMLESS, OVERLAPS, chromium

# Share of the pixels that differ from the corner pixel, and the number of colours, of a PNG.
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

# Screen positions of the gauges, and their names.
GAUGES = """() => {
  const { camera, marks, box, lifted } = document.querySelector(".scene").scene, at = box.getBoundingClientRect();
  return marks.map((m) => { const p = camera.project(lifted(m)); return { name: m.name, x: at.left + box.clientLeft + p[0], y: at.top + box.clientTop + p[1] }; });
}"""


# Boxes of the parts of the first screen, and its sentence.
FIRST = """() => {
  const box = (s) => {
    const e = [...document.querySelectorAll(s)].find((e) => e.checkVisibility());
    if (!e) return null;
    const r = e.getBoundingClientRect();
    return [r.left, r.top, r.right, r.bottom];
  };
  const summary = document.querySelector(".verdict .summary");
  return { verdict: box(".verdict"), numbers: box(".tiles"), picture: box(".picture svg"), table: box(".result table"), summary: summary && summary.textContent };
}"""

# Width and height of the plot area of a figure, and its legend.
FRAME = """(f) => {
  const r = f.querySelector("svg > rect[stroke]"), legend = f.querySelector(".legend");
  return { size: r && [+r.getAttribute("width"), +r.getAttribute("height")], legend: legend ? legend.textContent : "" };
}"""

# Heading, size of the picture, and words in the picture, by card.
CARDS = """() => [...document.querySelectorAll(".card")].map((c) => {
  const r = (c.querySelector("svg") || c).getBoundingClientRect(), words = [...c.querySelectorAll("svg text")].map((t) => t.textContent);
  return { title: c.querySelector("h3").textContent, size: c.querySelector("svg") ? [r.width, r.height] : [0, 0], words: words.join(" ") };
})"""

# Violations of the rules of WCAG 2 (A, AA) and of good practice that axe-core finds: rule, impact, the first elements.
# Folded tables and figures are opened first.
AXE = """async () => {
  document.querySelectorAll("details").forEach((d) => { d.open = true; });
  const found = await axe.run(document, { runOnly: { type: "tag", values: ["wcag2a", "wcag2aa", "best-practice"] }, resultTypes: ["violations"] });
  document.querySelectorAll("details").forEach((d) => { d.open = false; });
  return found.violations.map((v) => [v.id, v.impact, ...v.nodes.slice(0, 3).map((n) => n.html.slice(0, 120) + " " + (n.any[0] || n.all[0] || n.none[0] || {}).message)].join(": "));
}"""


def violations(page):
    """Returns the violations on a complete page, in the light scheme and, if the page has one, in the dark scheme."""
    page.evaluate(AXE_CORE)
    found = page.evaluate(AXE)
    if "prefers-color-scheme" in page.content():
        page.emulate_media(color_scheme="dark")
        found += ["dark: " + f for f in page.evaluate(AXE)]
        page.emulate_media(color_scheme="light")
    return found


# Figures without a picture if JavaScript is off.
WITHOUT_PICTURE = """() => [...document.querySelectorAll("[data-figure=chart]")].filter((f) => {
  const still = f.nextElementSibling;
  return !still || still.localName !== "noscript" || ![...still.querySelectorAll("svg")].some((e) => e.checkVisibility() && e.getBoundingClientRect().height > 40);
}).map((f) => f.getAttribute("aria-label"))"""


def without_scripts(browser, path):
    """Returns the content of a page without JavaScript: the first screen, and whether parts that need scripts are empty."""
    context = browser.new_context(viewport={"width": 1280, "height": 800}, java_script_enabled=False)
    page = context.new_page()
    page.goto("file://" + os.path.abspath(path))
    seen = page.evaluate(FIRST)
    seen["empty"] = page.evaluate("[...document.querySelectorAll('.canvas, .controls')].filter((e) => e.checkVisibility()).length")
    seen["pictures"] = page.evaluate("[...document.querySelectorAll('svg')].filter((e) => e.checkVisibility()).length")
    seen["without_picture"] = page.evaluate(WITHOUT_PICTURE)
    seen["overlaps"] = page.evaluate(OVERLAPS)
    context.close()
    return seen


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
        "first": page.evaluate(FIRST),
        "rules": violations(page),
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
        seen["figures"].append({"kind": figure.get_attribute("data-figure"), "label": figure.get_attribute("aria-label"), "caption": figure.locator("figcaption").inner_text(), "frame": figure.evaluate(FRAME), **drawn})
    seen["terminal"] = page.locator("pre").count()
    seen["cards"] = page.evaluate(CARDS)
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
        seen["shown"] = subjects(page)
        if not phone:
            seen["wheel"] = wheel(page, view)
        # Every view, to find overlapping names in each of them.
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
    if not phone:
        seen["still"] = without_scripts(browser, path)
    seen["errors"], seen["requests"] = errors, requests
    context.close()
    return seen


def subjects(page):
    """Returns the marked words by gauge in the subject of a visible finding.

    These are words under the model and bold labels of the pictures, while the gauge has the focus and afterwards.
    """
    out = []
    page.evaluate("document.querySelectorAll('.f details, .folded').forEach((d) => { d.open = true; })")
    for subject in page.locator(".subject").all()[:4]:
        subject.focus()
        page.wait_for_timeout(150)
        lit = "[...document.querySelectorAll('.lit')].filter((e) => !e.hidden).map((e) => e.textContent.trim())"
        row = {"name": subject.inner_text(), "said": page.locator(".scene .pick").inner_text(), "lit": page.evaluate(lit)}
        page.evaluate("document.activeElement.blur()")
        page.wait_for_timeout(150)
        out.append({**row, "after": page.evaluate(lit)})
    page.evaluate("document.querySelectorAll('.f details, .folded').forEach((d) => { d.open = false; })")
    return out


def wheel(page, view):
    """Returns how far the wheel scrolls the page over the picture, before and after a click on it, and by how much it
    zooms.
    """
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
    """Tests the search for overlaps: two overlapping words, one separate word, and one clipped word give the first pair
    only.
    """
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
