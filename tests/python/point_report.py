"""Makes a plan on a report in headless Chromium, with real mouse and touch events, and prints the lines of the page.

    python point_report.py REPORT.html PLAN.json

The plan is {"width": 1280, "touch": false, "steps": [[word, ..]..]}. The steps are ["view", "z"], ["state",
"allowed"], ["tool", "brush"], ["radius", 3], ["through", true], ["property", 7], ["drag", [x, y, z], ..] over these
places of the model, ["two fingers"], ["undo"], ["clear"], ["save"], ["lines"], ["choose", "field", "-1"], ["picture",
"scene.png"] (the model), and ["page", "page.png"] (the window, "height" pixels of it, 900 by default).

Prints one JSON object: "lines" (of every step "lines", for the job and for gauges), "saved", "camera" (before and
after two fingers), "gauges", "errors", "requests", and "seconds" of the longest drag. Exit code 77 if playwright or
chromium is missing.
"""
import json
import os
import sys
import time

from browser import HARMLESS, chromium

PROJECT = """(p) => {
  const { camera, box, local } = document.querySelector(".scene").scene, at = box.getBoundingClientRect(), q = camera.project(local(p));
  return { x: at.left + box.clientLeft + q[0], y: at.top + box.clientTop + q[1] };
}"""
CAMERA = "(() => { const c = document.querySelector('.scene').scene.camera; return [c.far, c.yaw, ...c.target]; })()"
GAUGES = """() => {
  const { camera, marks, lifted, world } = document.querySelector(".scene").scene;
  return marks.map((m) => ({ name: m.name, at: world(m.at), pixel: camera.pixel(camera.project(m.at)[2]), spot: world(lifted(m)) }));
}"""


class Hand:
    """A mouse, or a finger."""

    def __init__(self, page, touch):
        self.page, self.touch = page, touch
        self.cdp = page.context.new_cdp_session(page) if touch else None

    def press(self, selector):
        locator = self.page.locator(selector)
        locator.scroll_into_view_if_needed()
        if not self.touch:
            return locator.click()
        # The tap ends before the page has processed its click.
        locator.evaluate("(e) => { window.clicked = false; e.addEventListener('click', () => { window.clicked = true; }, { once: true }); }")
        locator.tap()
        self.page.wait_for_function("window.clicked")

    def fingers(self, kind, points):
        spots = [{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)]
        self.cdp.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": spots})

    def drag(self, places):
        view = self.page.locator(".scene .canvas")
        view.scroll_into_view_if_needed()
        self.page.wait_for_timeout(50)
        at = [self.page.evaluate(PROJECT, p) for p in places]
        path = [(at[0]["x"], at[0]["y"])]
        for a, b in zip(at, at[1:]):
            path += [(a["x"] + (b["x"] - a["x"]) * k / 8, a["y"] + (b["y"] - a["y"]) * k / 8) for k in range(1, 9)]
        if self.touch:
            self.fingers("touchStart", path[:1])
            for p in path[1:]:
                self.fingers("touchMove", [p])
            self.fingers("touchEnd", [])
        else:
            self.page.mouse.move(*path[0])
            self.page.mouse.down()
            for p in path[1:]:
                self.page.mouse.move(*p)
            self.page.mouse.up()
        self.page.wait_for_timeout(50)

    def spread(self):
        """Moves two fingers apart from the middle of the picture. A mouse uses the wheel, which zooms the picture that
        has the focus.
        """
        view = self.page.locator(".scene .canvas")
        view.scroll_into_view_if_needed()
        box = view.bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        if not self.touch:
            view.focus()
            self.page.mouse.move(x, y)
            self.page.mouse.wheel(0, -200)
        else:
            self.fingers("touchStart", [(x - 20, y), (x + 20, y)])
            for d in range(25, 60, 5):
                self.fingers("touchMove", [(x - d, y), (x + d, y)])
            self.fingers("touchEnd", [])
        self.page.wait_for_timeout(100)


def run(page, plan):
    hand, out = Hand(page, plan["touch"]), {"lines": [], "camera": [], "gauges": [], "seconds": 0.0}
    for word, *rest in plan["steps"]:
        if word == "view":
            hand.press(f"[data-view={rest[0]}]")
            page.wait_for_timeout(100)
        elif word == "state":
            hand.press(f".tools [data-state]:text-is('{rest[0]}')")
        elif word == "tool":
            hand.press(f"[data-tool={rest[0]}]")
        elif word == "radius":
            page.locator("input[data-role=brush]").fill(str(rest[0]))
        elif word == "through":
            page.locator("[data-role=through]").set_checked(rest[0])
        elif word == "property":
            if not page.locator("details.properties").get_attribute("open") is not None:
                hand.press("details.properties summary")
            hand.press(f"[data-property='{rest[0]}']")
        elif word == "drag":
            start = time.time()
            hand.drag(rest)
            out["seconds"] = max(out["seconds"], time.time() - start)
        elif word == "two fingers":
            out["camera"].append(page.evaluate(CAMERA))
            hand.spread()
            out["camera"].append(page.evaluate(CAMERA))
        elif word in ("undo", "clear"):
            hand.press(f"[data-role={word}]")
        elif word == "save":
            with page.expect_download() as download:
                hand.press("[data-written=places] [data-role=save]")
            out["saved"] = {"name": download.value.suggested_filename, "text": open(download.value.path()).read()}
        elif word == "picture":
            page.mouse.move(0, 0)
            page.locator(".scene .canvas").screenshot(path=rest[0])
        elif word == "page":
            page.screenshot(path=rest[0])
        elif word == "choose":
            page.locator(f"[data-role={rest[0]}]").select_option(rest[1])
        elif word == "gauges":
            out["gauges"].append(page.evaluate(GAUGES))
        elif word == "lines":
            text = [page.locator(f"[data-written={k}] pre") for k in ("places", "gauges")]
            out["lines"].append([t.text_content() if t.count() else "" for t in text])
        else:
            raise ValueError(word)
    return out


path, plan = sys.argv[1], json.loads(open(sys.argv[2]).read())
errors, requests = [], []
with chromium() as browser:
    context = browser.new_context(
        viewport={"width": plan["width"], "height": plan.get("height", 900)}, has_touch=plan["touch"], is_mobile=plan["touch"], device_scale_factor=2 if plan["touch"] else 1
    )
    page = context.new_page()
    page.set_default_timeout(60000)
    page.on("console", lambda m: errors.append(m.text) if m.type in ("error", "warning") and not HARMLESS.search(m.text) else None)
    page.on("pageerror", lambda e: errors.append(str(e)))
    page.on("request", lambda r: requests.append(r.url) if not r.url.startswith(("file:", "data:", "blob:")) else None)
    page.goto("file://" + os.path.abspath(path))
    page.wait_for_selector("html[data-drawn=all]", timeout=60000, state="attached")
    out = run(page, plan)
    if os.environ.get("SHOTS"):
        page.screenshot(path=os.path.join(os.environ["SHOTS"], f"plan-{plan['width']}.png"), full_page=True)
    context.close()
print(json.dumps({**out, "errors": errors, "requests": requests}))
