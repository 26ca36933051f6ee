"""Plans gauges on the page of `strainbridge open` in headless Chromium, and says what the page showed.

    python live_page.py ADDRESS JOB.toml PID

Ends the server PID at last. Prints one JSON object; exit code 77 where playwright, axe-core or chromium is absent.
"""
import json
import os
import signal
import sys
import time

from browser import AXE_CORE, HARMLESS, chromium

PROJECT = """(name) => {
  const { camera, box, marks, lifted } = document.querySelector("[data-live=page] .scene").scene, at = box.getBoundingClientRect();
  const q = camera.project(lifted(marks.find((m) => m.name === name)));
  return { x: at.left + box.clientLeft + q[0], y: at.top + box.clientTop + q[1] };
}"""
# Gauges of the layout whose element is of a property, by the data of the page.
ON_PROPERTY = """([property]) => {
  const { plan } = document.querySelector("[data-live=page] .scene").scene;
  const forbidden = new Set(plan.ids.filter((_, e) => plan.pids[e] === property));
  const table = [...document.querySelectorAll("[data-live=page] table")].find((t) => t.textContent.includes("leverage"));
  return [...table.querySelectorAll("tbody tr")].filter((r) => forbidden.has(+r.cells[1].textContent)).length;
}"""

address, job, pid = sys.argv[1], sys.argv[2], int(sys.argv[3])
errors, elsewhere, out = [], [], {}
with chromium() as browser:
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    page = context.new_page()
    page.set_default_timeout(60000)
    page.on("console", lambda m: errors.append(m.text) if m.type in ("error", "warning") and not HARMLESS.search(m.text) else None)
    page.on("pageerror", lambda e: errors.append(str(e)))
    page.on("request", lambda r: elsewhere.append(r.url) if not r.url.startswith((address.split("#")[0], "data:", "blob:")) else None)
    live = lambda name: page.locator(f"[data-live={name}]")
    names = lambda: page.eval_on_selector_all("[data-keep]", "(all) => all.map((b) => b.dataset.keep)")
    loads = lambda: live("loads").inner_text()

    def until(condition, arg=None):
        """Waits without `eval` in the page, which its policy refuses."""
        end = time.time() + 60
        while not page.evaluate(condition, arg):
            assert time.time() < end, (condition, live("said").inner_text(), live("faults").inner_text(), errors)
            page.wait_for_timeout(50)

    def act(press):
        """Does something that places gauges, and waits for its picture."""
        page.evaluate("document.querySelector('[data-live=page]').firstElementChild.dataset.old = 'yes'")
        press()
        until("() => !document.querySelector('[data-live=page] > [data-old]') && !document.querySelector('[data-live=place]').disabled"
              " && Boolean(document.querySelector('[data-live=page] .scene')?.scene)")

    page.goto(address)
    until("() => Boolean(document.querySelector('[data-live=page] .scene')?.scene) && !document.querySelector('[data-live=place]').disabled")
    out["first"] = names()
    if os.environ.get("SHOTS"):
        page.screenshot(path=os.path.join(os.environ["SHOTS"], "live.png"))

    page.locator(".tools [data-state]:text-is('forbidden')").click()
    page.locator("details.properties summary").click()
    page.locator("[data-property='3']").click()
    out["stale"] = live("said").inner_text()
    act(live("place").click)
    out["forbidden_left"] = page.evaluate(ON_PROPERTY, [3])

    def slide():
        live("count").evaluate("(e) => { e.value = 10; e.dispatchEvent(new Event('input')); e.dispatchEvent(new Event('change')); }")
        if "press" in live("said").inner_text():
            live("place").click()
    act(slide)
    out["slider"] = names()

    page.locator("[data-tool=gauge]").click()
    page.locator("[data-live=page] .scene .canvas").scroll_into_view_if_needed()
    page.wait_for_timeout(100)
    # A gauge that the tools above the picture do not cover.
    name = page.evaluate("""() => {
      const { camera, marks, lifted, box } = document.querySelector("[data-live=page] .scene").scene, at = box.getBoundingClientRect();
      const free = marks.find((m) => { const q = camera.project(lifted(m)); return document.elementFromPoint(at.left + q[0], at.top + q[1])?.closest(".canvas") === box; });
      return free.name;
    }""")
    out["before_drag"] = loads()
    at = page.evaluate(PROJECT, name)
    page.mouse.move(at["x"], at["y"])
    page.mouse.down()
    for k in range(1, 9):
        page.mouse.move(at["x"] + 4 * k, at["y"] - 2 * k)
    page.mouse.up()
    until("(before) => document.querySelector('[data-live=loads]').innerText !== before", out["before_drag"])
    page.wait_for_timeout(1500)
    out["dragged"] = loads()
    page.locator("[data-role=undo]").click()
    until("(before) => document.querySelector('[data-live=loads]').innerText === before", out["before_drag"])
    out["drag_undone"] = loads()

    # By keyboard alone: the tool, the picture, a gauge, a step, back again.
    focused = lambda: page.evaluate("document.activeElement.className + ' ' + (document.activeElement.dataset.tool || document.activeElement.dataset.live || '')")
    ringed = lambda: page.evaluate("getComputedStyle(document.activeElement).outlineStyle") != "none"

    def tab_to(word, key="Tab"):
        for _ in range(400):
            page.keyboard.press(key)
            if word in focused():
                return ringed()
        raise AssertionError(f"{word} is not reached by {key}")
    page.locator("[data-tool=turn]").click()
    page.evaluate("document.activeElement.blur()")
    out["focus"] = [tab_to("place"), tab_to("gauge")]
    page.keyboard.press("Enter")
    out["focus"].append(tab_to("canvas", "Shift+Tab"))
    said = lambda: page.locator("[data-live=page] .scene .pick").first.inner_text()
    page.keyboard.press("Enter")
    out["chosen"] = said()
    for way in ("ArrowRight", "ArrowLeft", "ArrowUp", "ArrowDown"):
        page.keyboard.press(way)
        if "moved to" in said():
            break
    out["stepped"] = said()
    until("(before) => document.querySelector('[data-live=loads]').innerText !== before", out["before_drag"])
    page.keyboard.press("Escape")
    until("(before) => document.querySelector('[data-live=loads]').innerText === before", out["before_drag"])

    # A plan that is undone has the lists that its layout was chosen for.
    placed_with = []
    page.on("request", lambda r: placed_with.append((r.url.rsplit("/", 1)[1], r.post_data_json)) if r.method == "POST" else None)
    page.locator("details.properties").evaluate("(e) => { e.open = true; }")
    page.locator("[data-property='2']").click()
    out["save_while_marks_wait"] = live("save").is_enabled()
    act(live("place").click)
    act(live("undo").click)
    live("save").click()
    until("() => document.querySelector('[data-live=said]').innerText.startsWith('Saved')")
    out["picks_after_undo"] = [body["picks"] for call, body in placed_with if call == "save"][-1]

    # Work that takes long: the picture is pale, and after `cancel` it is the plan as it was.
    held = []
    page.route("**/place", lambda route: held.append(route))
    live("place").click()
    until("() => document.querySelector('[data-live=page]').classList.contains('stale') && !document.querySelector('[data-live=cancel]').disabled")
    with page.expect_response("**/cancel") as cancelled:
        live("cancel").click()
    held[0].fulfill(status=422, content_type="application/json", body=json.dumps({"faults": [{"wrong": "stopped", "remedy": ""}]}))
    until("() => !document.querySelector('[data-live=page]').classList.contains('stale') && !document.querySelector('[data-live=place]').disabled")
    out["cancelled"] = [cancelled.value.status, live("said").inner_text(), loads() == out["before_drag"]]
    page.unroute("**/place")
    # Chromium itself reports that status.
    errors[:] = [e for e in errors if "status of 422" not in e]

    live("kept").evaluate("(e) => { e.parentElement.open = true; }")
    page.eval_on_selector_all("[data-keep]", "(all) => all.forEach((b, i) => { b.checked = i < 2; })")
    out["kept"] = names()[:2]
    act(live("rest").click)
    out["rest"] = names()
    act(live("undo").click)
    out["undone"] = names()

    # The plan is the one that was saved: nothing is left to save.
    out["save_of_saved"] = live("save").is_enabled()
    live("report").click()
    until("() => document.querySelector('[data-live=said]').innerText.startsWith('Written')")
    page.evaluate(AXE_CORE)
    found = page.evaluate("axe.run(document, { runOnly: ['wcag2a', 'wcag2aa'] })")
    out["axe"] = [[v["id"], [n["html"][:200] for n in v["nodes"]]] for v in found["violations"] if v["impact"] in ("serious", "critical")]
    page.set_viewport_size({"width": 390, "height": 800})
    page.wait_for_timeout(300)
    out["wide"] = page.evaluate("document.documentElement.scrollWidth > innerWidth + 1")
    if os.environ.get("SHOTS"):
        page.screenshot(path=os.path.join(os.environ["SHOTS"], "live-390.png"))
    page.set_viewport_size({"width": 1280, "height": 900})

    with open(job, "a", encoding="utf-8") as f:
        f.write("# changed\n")
    live("changed").wait_for(state="visible")
    out["changed"] = live("changes").text_content()
    act(live("reload").click)
    live("changed").wait_for(state="hidden")
    # What the browser itself says of a server that is gone is expected.
    before = list(errors)
    os.kill(pid, signal.SIGKILL)
    live("lost").wait_for(state="visible")
    out["lost"] = live("lines").text_content()
    context.close()
print(json.dumps({**out, "errors": before, "elsewhere": elsewhere}))
