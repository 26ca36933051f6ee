"""Tests `reconcile` with a calibrated S on two measured bridges.

Half of the runs of each lane are calibration runs. The other half have one planted fault at one of the eight gauges with the largest strain.

    python benches/calibrated_reconcile.py target/release/strainbridge ../shared/bridges [seeds]

Prints a line for each case, and a table: fault named at its place, right channel with another fault, nothing named, and additional wrong names.
"""
import collections
import csv
import json
import pathlib
import random
import subprocess
import sys
import tempfile

TRUCK_KN = 219.386
FAULTS = ["none", "sign_flip", "dead_channel", "gauge_swap", "gauge_gain"]
JOB = """units = "m-kg-s"
[measured]
strain = "strain.csv"
noise_microstrain = 0.05
[runs]
file = "runs.csv"
units = { force = "kN" }
[calibration]
repeats = ["lane"]
"""


def rows(path):
    with open(path, newline="") as f:
        return list(csv.DictReader(f))


class Bridge:
    """Runs that are suitable for weighing and have readings of every gauge."""

    def __init__(self, folder):
        readings = {r["run"]: r for r in rows(folder / "peaks.csv")}
        self.gauges = [g for g in next(iter(readings.values())) if g != "run"]
        fit = [r for r in rows(folder / "runs.csv") if r["fit_for_weighing"] == "1"]
        whole = [r for r in fit if all(readings[r["run"]][g] for g in self.gauges)]
        self.runs = [(r["run"], r["lane"], {g: float(readings[r["run"]][g]) for g in self.gauges}) for r in whole]
        self.lanes = sorted({lane for _, lane, _ in self.runs})
        self.hot = sorted(self.gauges, key=lambda g: -sum(abs(v[g]) for _, _, v in self.runs))

    def halves(self, draw):
        taught, asked = [], []
        for lane in self.lanes:
            here = [r for r in self.runs if r[1] == lane]
            draw.shuffle(here)
            taught += here[: len(here) // 2]
            asked += here[len(here) // 2 :]
        return taught, asked

    def write(self, folder, runs, plant=lambda readings: readings):
        with open(folder / "strain.csv", "w") as s, open(folder / "runs.csv", "w") as r:
            print("run", *self.gauges, sep=",", file=s)
            print("run,lane", *self.lanes, sep=",", file=r)
            for name, lane, readings in runs:
                planted = plant(dict(readings))
                print(name, *(planted[g] for g in self.gauges), sep=",", file=s)
                print(name, lane, *(TRUCK_KN if l == lane else 0 for l in self.lanes), sep=",", file=r)


def planter(fault, gauge, other):
    def plant(v):
        if fault == "sign_flip":
            v[gauge] = -v[gauge]
        elif fault == "dead_channel":
            v[gauge] = 0.01
        elif fault == "gauge_swap":
            v[gauge], v[other] = v[other], v[gauge]
        elif fault == "gauge_gain":
            v[gauge] *= 0.7
        return v

    return plant


def ask(program, *arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    return json.loads((pathlib.Path(arguments[-1]) / "result.json").read_text())


def main(program, folder, seeds="10"):
    table = collections.defaultdict(collections.Counter)
    for bridge in (Bridge(pathlib.Path(folder) / name) for name in ("ponca", "ashland")):
        for seed in range(1, int(seeds) + 1):
            for fault in FAULTS:
                draw = random.Random(seed)
                taught, asked = bridge.halves(draw)
                k = draw.randrange(8)
                gauge, other = bridge.hot[k], bridge.hot[(k + 4) % 9]
                with tempfile.TemporaryDirectory() as scratch:
                    at = pathlib.Path(scratch)
                    loads = "".join(f'[[load]]\nname = "{l}"\n' for l in bridge.lanes)
                    (at / "job.toml").write_text(JOB + loads)
                    bridge.write(at, taught)
                    ask(program, "calibrate", str(at / "job.toml"), "--out", str(at / "cal"))
                    bridge.write(at, asked, planter(fault, gauge, other))
                    found = ask(program, "reconcile", str(at / "cal" / "calibrated.toml"), "--out", str(at / "found"))
                named = found["named"]
                right = [n for n in named if fault != "none" and gauge in n.split(":")[1]]
                count = table[fault]
                count["cases"] += 1
                count["named"] += any(n.startswith(fault) for n in right)
                count["other name"] += bool(right) and not any(n.startswith(fault) for n in right)
                count["silent"] += not named
                count["false"] += len(named) > len(right)
                print(f"{len(bridge.runs)} runs, seed {seed}, {fault} at {gauge}: {found['verdict']} {named}", flush=True)
    columns = ["cases", "named", "other name", "silent", "false"]
    print("fault", *columns, sep=" | ")
    for fault in FAULTS:
        print(fault, *(table[fault][c] for c in columns), sep=" | ")


if __name__ == "__main__":
    main(*sys.argv[1:])
