"""The page of names agrees with the docstrings, and the notebooks run."""

import json
import os
import re
import runpy
import shutil
from concurrent.futures import ThreadPoolExecutor

import pytest
from conftest import ROOT, needed

TASKS = sorted((ROOT / "docs" / "python").glob("*.md"))
NOTEBOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.ipynb"))


def test_the_page_of_names_is_made_from_the_docstrings():
    made = runpy.run_path(str(ROOT / "python" / "api.py"))["page"]()
    kept = (ROOT / "docs" / "reference" / "python-api.md").read_text(encoding="utf-8")
    assert made == kept, "python python/api.py > docs/reference/python-api.md"


def test_notebooks_are_kept_without_their_outputs():
    assert len(NOTEBOOKS) == 5
    for path in NOTEBOOKS:
        cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
        assert all(c["outputs"] == [] and c["execution_count"] is None for c in cells if c["cell_type"] == "code"), path


def test_notebooks_run_and_have_pictures(tmp_path):
    nbclient, nbformat = needed("nbclient"), needed("nbformat")
    for name in ("ipykernel", "matplotlib", "pandas", "pyarrow"):
        needed(name)

    def pictures(path):
        folder = tmp_path / path.stem
        folder.mkdir()
        book = nbformat.read(path, as_version=4)
        nbclient.NotebookClient(book, timeout=120, resources={"metadata": {"path": str(folder)}}).execute()
        outputs = [o for c in book.cells if c.cell_type == "code" for o in c.outputs]
        kinds = [kind for o in outputs for kind in o.get("data", {})]
        return kinds.count("image/png"), kinds.count("text/html")

    # Kernels start in parallel.
    with ThreadPoolExecutor(3) as pool:
        for path, (images, pages) in zip(NOTEBOOKS, pool.map(pictures, NOTEBOOKS)):
            assert images >= 1 and pages >= 1, path


def boxes(page: str, kind: str):
    """Yields the line number and text of the boxes of a kind."""
    for box in re.finditer(rf"^```{kind}\n(.*?)^```$", page, re.MULTILINE | re.DOTALL):
        yield page[: box.start(1)].count("\n"), box.group(1)


def test_a_page_of_every_task_is_there():
    assert {p.stem for p in TASKS} >= {"place", "recover", "reconcile", "calibrate", "payload", "fleet"}


@pytest.mark.parametrize("path", TASKS, ids=lambda p: p.stem)
def test_the_code_of_a_page_runs_in_order_on_the_examples(path, tmp_path, monkeypatch):
    for name in ("pandas", "pyarrow"):
        needed(name)
    folder = shutil.copytree(ROOT / "examples", tmp_path / "examples")
    monkeypatch.chdir(folder)
    names = {"__name__": path.stem}
    page = path.read_text(encoding="utf-8")
    count = 0
    for line, code in boxes(page, "python"):
        # Lines of an error refer to the page.
        exec(compile("\n" * line + code, os.fspath(path), "exec"), names)
        count += 1
    assert count >= 3 and "assert" in page


@pytest.mark.parametrize("name", ["README.md", "docs/reference/python.md", *(f"docs/python/{p.name}" for p in TASKS)])
def test_names_of_the_pages_exist(name):
    import strainbridge as sb

    used = set(re.findall(r"\bsb\.(\w+)", (ROOT / name).read_text(encoding="utf-8")))
    assert used and all(hasattr(sb, n) for n in used), used
