"""Chromium and axe-core for the scripts in this folder. Exit code 77 if playwright, axe-core or chromium is missing."""
import re
import shutil
import sys
from contextlib import contextmanager
from pathlib import Path

try:
    import axe_playwright_python
    from playwright.sync_api import sync_playwright
except Exception as e:
    print(f"absent: {e}")
    sys.exit(77)

EXECUTABLE = shutil.which("chromium") or shutil.which("chromium-browser")
if EXECUTABLE is None:
    print("absent: chromium")
    sys.exit(77)

# Program that tests the accessibility of a page.
AXE_CORE = (Path(axe_playwright_python.__file__).parent / "axe.min.js").read_text(encoding="utf-8")

FLAGS = [
    "--headless=new", "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic",
    "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage",
]

# Messages of Chromium about software rendering, and about the access of these scripts to the pixels.
HARMLESS = re.compile("GPU stall|willReadFrequently")

# Pairs of texts whose visible boxes overlap by more than a pixel and a half. Parts that an element clips do not count.
OVERLAPS = """() => {
  const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), found = [];
  for (let node = walk.nextNode(); node; node = walk.nextNode()) {
    const text = node.textContent.trim(), parent = node.parentElement;
    if (!text || parent.closest("script, style, option, [hidden]") || !parent.checkVisibility({ visibilityProperty: true })) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    for (const r of range.getClientRects()) {
      let box = [r.left, r.top, r.right, r.bottom];
      for (let e = parent; e && e !== document.body; e = e.parentElement) {
        const style = getComputedStyle(e);
        if (style.overflowX === "visible" && style.overflowY === "visible") continue;
        const c = e.getBoundingClientRect();
        box = [Math.max(box[0], c.left), Math.max(box[1], c.top), Math.min(box[2], c.right), Math.min(box[3], c.bottom)];
      }
      if (box[2] - box[0] > 1 && box[3] - box[1] > 1) found.push({ text, node, box });
    }
  }
  found.sort((a, b) => a.box[1] - b.box[1]);
  const out = [];
  for (let i = 0; i < found.length; i++) for (let k = i + 1; k < found.length && found[k].box[1] < found[i].box[3] - 1.5; k++) {
    const [a, b] = [found[i].box, found[k].box];
    if (Math.min(a[2], b[2]) - Math.max(a[0], b[0]) > 1.5 && Math.min(a[3], b[3]) - Math.max(a[1], b[1]) > 1.5) out.push([found[i].text, found[k].text]);
  }
  return out.slice(0, 20);
}"""


@contextmanager
def chromium():
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=EXECUTABLE, args=FLAGS)
        yield browser
        browser.close()
