"""Effect of `[model] mesh_error` on recovered loads and on the coverage of their intervals, for six ladder frames.

    python benches/mesh_error.py target/release/strainbridge ../shared/benchmarks/frames [folder for decks and results]

The frames come from `frame.py` there: C rails and box rails, straight and kicked, higher and lower. The deck has elements of 40 mm. `place` places
40 gauges on it with the mesh error. The truth is the same frame with elements of 13.3 mm, loaded through the grids of the deck's RBE3. A gauge reads
the mean over its nine elements. There are 34 states of 18 wheel loads of expected size, with 1 microstrain of noise and no stated model uncertainty.
The output for each frame is the error of the loads (rms, in expected sizes) and the coverage of the 95 % intervals. Both are given without and with
the mesh error. Needs numpy.
"""

import csv
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

FRAMES = {
    "C": {},
    "C kicked": {"kicked": True},
    "C 280 x 120": {"sizes": {"RAIL_H": 7, "RAIL_W": 3}},
    "box": {"section": "box"},
    "box kicked": {"section": "box", "kicked": True},
    "box 200 x 80": {"section": "box", "sizes": {"RAIL_H": 5}},
}
EXPECTED = {"FZ": 1e4, "FX": 5e3, "FY": 5e3}
STATES = 34
FINE = 3


def main():
    binary, frames = os.path.abspath(sys.argv[1]), sys.argv[2]
    root = sys.argv[3] if len(sys.argv) > 3 else tempfile.mkdtemp(prefix="mesh_error_")
    sys.path.insert(0, frames)
    import frame

    usual = {k: getattr(frame, k) for k in ("RAIL_H", "RAIL_W")}
    loads = [(f"{w}.{c}", w, c) for c in EXPECTED for w in frame.WHEELS]
    expected = np.array([EXPECTED[c] for _, _, c in loads])
    print("frame | rms without | held | rms with | held")
    shares = []
    for name, how in FRAMES.items():
        for key, size in {**usual, **how.get("sizes", {})}.items():
            setattr(frame, key, size)
        how = {k: v for k, v in how.items() if k != "sizes"}
        folder = os.path.join(root, name.replace(" ", "_"))
        os.makedirs(folder, exist_ok=True)
        case = Case(binary, folder, frame, loads)
        row = case.run(how, expected)
        shares.append(row)
        print(name, *(f"{v:.3f}" for v in row), sep=" | ", flush=True)
    print("mean", *(f"{v:.3f}" for v in np.mean(shares, 0)), sep=" | ")


class Case:
    def __init__(self, binary, folder, frame, loads):
        self.binary, self.folder, self.frame, self.loads = binary, folder, frame, loads

    def path(self, name):
        return os.path.join(self.folder, name)

    def command(self, *words):
        keep = {**os.environ, "STRAINBRIDGE_CACHE": self.path("kept")}
        done = subprocess.run([self.binary, *words], cwd=self.folder, capture_output=True, text=True, env=keep)
        if done.returncode > 1:
            sys.exit(done.stderr)
        return done.stdout

    def job(self, name, deck, model, more, mesh_error=False):
        text = f'units = "mm-t-s"\n[model]\ndeck = "{deck}"\nmesh_error = {str(mesh_error).lower()}\n'
        for load, wheel, component in self.loads:
            grid = model["gid"][model["points"][wheel]]
            text += f'[[load]]\nname = "{load}"\ngrid = {grid}\ncomponent = "{component}"\nexpected = {EXPECTED[component]}\n'
        with open(self.path(name), "w") as f:
            f.write(text + more)

    def run(self, how, expected):
        coarse, fine = self.frame.build(1, **how), self.frame.build(FINE, **how)
        place = lambda x: tuple(np.round(x, 3))
        have = {place(x) for x in coarse["xyz"]}
        fine["rbe3"] = [(e, ref, np.array([r for r in rows if place(fine["xyz"][r]) in have])) for e, ref, rows in fine["rbe3"]]
        self.frame.write_deck(coarse, self.path("coarse.bdf"), [])
        self.frame.write_deck(fine, self.path("fine.bdf"), [])
        plan = (
            "[placement]\ngauges = 40\nnoise_microstrain = 1.0\nspacing = 120\n"
            "[candidates]\nangle_step_deg = 45\nclear_of = { loads = 200, attachments = 200 }\n"
        )
        self.job("place.toml", "coarse.bdf", coarse, plan, mesh_error=True)
        self.command("place", "place.toml", "--out", "place")
        with open(self.path("place/gauges.csv")) as f:
            gauges = [(r["name"], int(r["element"]), r["surface"], float(r["angle_from_element_x_deg"])) for r in csv.DictReader(f)]
        children = self.children(how.get("section", "C"))
        own = [(f"{n}_{i}", e, s, a) for n, e0, s, a in gauges for i, e in enumerate(children[e0])]
        self.job("fine.toml", "fine.bdf", fine, tables(own))
        self.command("sensitivity", "fine.toml", "--out", "fine")
        with open(self.path("fine/sensitivity.csv")) as f:
            rows = {r[0]: np.array(r[1:], float) for r in list(csv.reader(f))[1:]}
        s = np.array([np.mean([rows[f"{n}_{i}"] for i in range(FINE**2)], 0) for n, *_ in gauges])
        random = np.random.default_rng(3)
        truth = random.normal(size=(STATES, len(self.loads))) * expected
        strain = truth @ s.T + random.normal(size=(STATES, len(gauges)))
        with open(self.path("strain.csv"), "w") as f:
            print("run", *(g[0] for g in gauges), sep=",", file=f)
            for i, row in enumerate(strain):
                print(f"r{i}", *(f"{x:.5f}" for x in row), sep=",", file=f)
        measured = '[measured]\nstrain = "strain.csv"\nnoise_microstrain = 1.0\nreference = "none"\n'
        out = []
        for mesh_error in (False, True):
            self.job("recover.toml", "coarse.bdf", coarse, tables(gauges) + measured, mesh_error)
            answer = json.loads(self.command("recover", "recover.toml", "--out", "out", "--json"))
            value, low, high = (np.array([l[k] for l in answer["loads"]]).reshape(truth.shape) for k in ("value", "low", "high"))
            out += [np.sqrt(np.mean(((value - truth) / expected) ** 2)), np.mean((low <= truth) & (truth <= high))]
        return out

    def children(self, section):
        """Returns the fine elements of each coarse element, in the order in which the patches of the frame are made."""
        f = self.frame
        length, height, width, span = f.RAIL_LEN, f.RAIL_H, f.RAIL_W, f.SPAN
        rail = [(length, height), (length, width), (length, width)] + [(length, height)] * (section == "box")
        cross = [(span, f.CM_H), (f.CM_W, span), (f.CM_W, span)]
        out, e, fine = {}, 1, 1
        for along, across in rail * 2 + cross * len(f.CM_X):
            for i in range(along):
                for j in range(across):
                    inside = [(FINE * i + a, FINE * j + b) for a in range(FINE) for b in range(FINE)]
                    out[e + i * across + j] = [fine + a * across * FINE + b for a, b in inside]
            e += along * across
            fine += along * across * FINE**2
        return out


def tables(gauges):
    return "".join(f'[[gauge]]\nname = "{n}"\nelement = {e}\nsurface = "{s}"\nangle_deg = {a}\n' for n, e, s, a in gauges)


if __name__ == "__main__":
    main()
