"""Display of an outcome in a notebook: the blocks of its report."""

import re
from html.parser import HTMLParser

import pytest

import strainbridge as sb

#: Elements without an end tag.
ENDLESS = ("br", "hr", "img", "meta", "input")


class Read(HTMLParser):
    """Collects texts of a page by element. Fails if elements are not closed in order."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.texts: dict[str, list[str]] = {}
        self.feed(page)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        if tag not in ENDLESS:
            self.open.append(tag)
        self.texts.setdefault(tag, []).append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open:
            self.texts[self.open[-1]][-1] += data


def shown(out: sb.Outcome) -> tuple[str, Read]:
    page = out._repr_html_()
    # The page contains no script and no external file, and its styles do not change the notebook.
    assert "<script" not in page and "http" not in page and len(page.encode()) < 300_000
    style = re.search(r"<style>(.*?)</style>", page, re.S)
    rules = [r for r in style[1].split("}") if r.strip()]
    assert rules and all(s.strip().startswith(".strainbridge") for r in rules for s in r.split("{")[0].split(","))
    return page, Read(page)


def test_a_layout_is_shown_as_its_report_shows_it(strip_folder):
    out = sb.place("job.toml")
    page, read = shown(out)
    report = Read(out.report())
    # The sections of the report, its gauges, its sentences.
    assert read.texts["h4"] == [t for t in report.texts["h2"] if t != "Notes and tests"]
    cells = read.texts["td"] + read.texts["th"]
    assert [g.name for g in out.gauges if g.name not in cells] == []
    assert any("<" not in f.message for f in out.findings)
    assert all(f.message.rstrip(".") in page.replace("&quot;", '"').replace("&amp;", "&") for f in out.findings if "<" not in f.message)
    # The strip with its gauges, and S as a map.
    assert page.count("<svg") >= 2
    assert set(read.texts["text"]) >= {g.name for g in out.gauges}


def test_loads_are_shown_with_the_verdict_first(matrix_folder):
    out = sb.recover("job.toml")
    page, read = shown(out)
    assert "<svg" in page and all(l.name in page for l in out.loads)
    job = sb.Job.read("job.toml")
    # A reading far from the prediction of the other gauges.
    lines = (matrix_folder / "strain.csv").read_text().splitlines()
    lines[3] = ",".join([lines[3].split(",")[0], "400", *lines[3].split(",")[2:]])
    (matrix_folder / "strain.csv").write_text("\n".join([*lines, ""]))
    bad = sb.recover(job)
    said = shown(bad)[0]
    assert any(f.severity != "info" for f in bad.findings)
    verdict = "The result is usable, with" if bad.is_reliable else "cannot be relied on"
    assert 0 < said.find(verdict) < said.find("<h4")


@pytest.mark.parametrize("name", ["sensitivity", "cases", "solve", "modes"])
def test_every_outcome_has_a_piece(name, strip_folder):
    if name == "sensitivity":
        job = sb.Job.read("job.toml")
        job.gauge = [{"name": f"{e}", "element": e, "surface": "top", "direction": [1, 0, 0]} for e in (2, 4, 7, 9)]
    else:
        job = "job.toml"
    _, read = shown(getattr(sb, name)(job))
    assert read.texts["h3"][0].strip()


def test_a_proposal_shows_its_summary_and_the_job(strip_folder):
    (strip_folder / "job.toml").unlink()
    out = sb.init("strip.bdf")
    _, read = shown(out)
    assert out.summary in out._repr_html_()
    out.save(strip_folder)
    job = (strip_folder / "job.toml").read_text().splitlines()
    lines = [line for text in read.texts["pre"] for line in text.splitlines()]
    assert [line for line in job if line not in lines] == []
    # The page shows the structure with the proposed loads.
    assert "<html" in out.report()


def test_the_truck_is_small_enough_for_a_notebook():
    from conftest import ROOT

    page, _ = shown(sb.place(ROOT / "models" / "truck-shell" / "job.toml"))
    assert "<svg" in page
