"""A small model, a small matrix, and the command if it is built."""

import importlib
import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


def needed(name: str):
    """Returns a package for a comparison. Without it the test is skipped, or fails if STRAINBRIDGE_TESTS is `required`."""
    if os.environ.get("STRAINBRIDGE_TESTS") == "required":
        return importlib.import_module(name)
    return pytest.importorskip(name)


def strip() -> str:
    """Returns a free strip of plates along x, 11 by 2 grids 20 mm apart, 2 mm thick."""
    lines = ["SOL 101", "CEND", "BEGIN BULK"]
    for i in range(11):
        for j in range(2):
            lines.append(f"GRID,{1 + i + 100 * j},,{20.0 * i:.1f},{20.0 * j:.1f},0.")
    for i in range(10):
        lines.append(f"CQUAD4,{1 + i},1,{1 + i},{2 + i},{102 + i},{101 + i}")
    return "\n".join([*lines, "PSHELL,1,1,2.,1,,1", "MAT1,1,210000.,,.3,7.85-9", "ENDDATA", ""])


#: Job on the strip, as a dictionary.
STRIP_JOB = {
    "units": "mm-t-s",
    "model": {"deck": "strip.bdf"},
    "load": [
        {"name": "left", "grid": 1, "component": "FZ", "expected": 10.0},
        {"name": "middle", "grid": 6, "component": "FZ", "expected": 10.0},
    ],
    "placement": {"gauges": 4},
}

#: The same job as a file.
STRIP_TEXT = """units = "mm-t-s"
[model]
deck = "strip.bdf"
[[load]]
name = "left"
grid = 1
component = "FZ"
expected = 10.0
[[load]]
name = "middle"
grid = 6
component = "FZ"
expected = 10.0
[placement]
gauges = 4
"""

#: Job with a given S.
MATRIX_TEXT = """title = "Two loads"
units = "m-kg-s"
report_units = { force = "kN", moment = "kN m" }
[sensitivity]
file = "S.csv"
per = { force = "kN" }
[[load]]
name = "A.FZ"
expected = 20000.0
[[load]]
name = "B.FZ"
expected = 20000.0
[measured]
strain = "strain.csv"
noise_microstrain = 1.0
[fleet]
file_name = "{vehicle}_{day}.csv"
"""

#: Microstrain per kN.
MATRIX = np.array([[10.0, 1.0], [-8.0, 3.0], [2.0, 9.0], [1.0, -11.0], [6.0, 6.0]])


@pytest.fixture
def strip_folder(tmp_path, monkeypatch):
    """Creates a working folder with the strip and its job."""
    (tmp_path / "strip.bdf").write_text(strip())
    (tmp_path / "job.toml").write_text(STRIP_TEXT)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def matrix_folder(tmp_path, monkeypatch):
    """Creates a working folder with S, six runs and two records of two vehicles."""
    rng = np.random.default_rng(3)
    rows = [f"G{g},{a},{b}" for g, (a, b) in enumerate(MATRIX)]
    (tmp_path / "S.csv").write_text("\n".join(["gauge,A.FZ,B.FZ", *rows, ""]))
    names = ",".join(f"G{g}" for g in range(len(MATRIX)))
    loads = rng.normal(0.0, 20.0, (6, 2))
    strain = loads @ MATRIX.T + rng.normal(0.0, 1.0, (6, len(MATRIX)))
    lines = [f"R{i}," + ",".join(f"{v:.6f}" for v in row) for i, row in enumerate(strain)]
    (tmp_path / "strain.csv").write_text("\n".join([f"run,{names}", *lines, ""]))
    for vehicle in ("T1", "T2"):
        waves = np.cumsum(rng.normal(0.0, 1.0, (600, 2)), axis=0)
        readings = waves @ MATRIX.T
        lines = [f"{i * 0.01:.2f}," + ",".join(f"{v:.6f}" for v in row) for i, row in enumerate(readings)]
        (tmp_path / f"{vehicle}_1.csv").write_text("\n".join([f"time,{names}", *lines, ""]))
    (tmp_path / "job.toml").write_text(MATRIX_TEXT)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="session")
def command():
    """Runs the command: the one in STRAINBRIDGE_COMMAND, otherwise the one built here.

    Without it the test is skipped, or fails if STRAINBRIDGE_TESTS is `required`.
    """
    found = os.environ.get("STRAINBRIDGE_COMMAND") or ROOT / "target" / "debug" / "strainbridge"
    if not Path(found).is_file():
        assert os.environ.get("STRAINBRIDGE_TESTS") != "required", f"no command at {found}, and required"
        pytest.skip("the command is not built: cargo build")

    def run(*arguments: object, ok: tuple[int, ...] = (0,)) -> dict:
        done = subprocess.run([str(found), *map(str, arguments), "--json"], capture_output=True, text=True)
        assert done.returncode in ok, done.stderr
        return json.loads(done.stdout)

    return run
