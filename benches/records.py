"""Long records, one process each: time and peak of resident memory, including the file that is read into it.

    STRAINBRIDGE=target/release/strainbridge python benches/records.py [FOLDER]

`check` reads a binary record of 40 gauges (2 million samples) with a zero of 300,000 samples as text. `recover` reads 41 columns (10 million
samples, 1.6 GB, and 150,000 samples as text). Seconds are the smaller of two. Files are in the page cache. Needs numpy, and 4 GB of disk.
"""

import os
import struct
import sys
import tempfile
from pathlib import Path

import numpy as np
from day import job, run


def binary(path, names, samples, random):
    """Writes sines with noise, in single precision, at 500 Hz."""
    heads = b"".join(struct.pack("<H", len(n)) + n.encode() for n in names)
    begin = (56 + len(heads) + 63) // 64 * 64
    with path.open("wb") as out:
        out.write(b"STRAINBH" + struct.pack("<IIIIQddd", 1, 4, len(names), begin, samples, 0.0, 1 / 500, 1e-6))
        out.write(heads + bytes(begin - 56 - len(heads)))
        phase = random.normal(size=len(names))
        for first in range(0, samples, 500_000):
            t = np.arange(first, min(first + 500_000, samples)) / 500
            block = 100 * np.sin(t[:, None] + phase) + random.normal(size=(len(t), len(names)))
            out.write(block.astype("<f4").tobytes())


def text(path, names, samples, random):
    """Writes similar samples as CSV with four decimals."""
    t = np.arange(samples) / 500
    block = np.column_stack([t, 100 * np.sin(t[:, None] + random.normal(size=len(names))) + random.normal(size=(samples, len(names)))])
    np.savetxt(path, block, fmt="%.4f", delimiter=",", header=",".join(["time", *names]), comments="")


def timed(command, path):
    """Runs a command on a job twice."""
    program = os.environ.get("STRAINBRIDGE", "strainbridge")
    runs = [run([program, command, str(path), "--out", str(path.parent / f"out{i}")], (0, 1)) for i in range(2)]
    seconds, peak = min(r[0] for r in runs), max(r[2] for r in runs)
    sizes = sum(f.stat().st_size for f in path.parent.iterdir() if f.suffix in (".bin", ".csv") and f.name != "S.csv")
    print(f"{command} {path.stem}: {sizes / 1e6:.0f} MB of records, {seconds:.2f} s, peak {peak / 1e6:.0f} MB")


if __name__ == "__main__":
    random = np.random.default_rng(7)
    for name, gauges, samples, commands in [
        ("zeroed", 40, 2_000_000, ["check", "recover"]),
        ("long", 41, 10_000_000, ["recover"]),
        ("text", 41, 150_000, ["recover"]),
    ]:
        with tempfile.TemporaryDirectory(dir=sys.argv[1] if len(sys.argv) > 1 else None) as kept:
            folder = Path(kept)
            names = [f"G{g}" for g in range(gauges)]
            file = folder / f"record.{'csv' if name == 'text' else 'bin'}"
            (text if name == "text" else binary)(file, names, samples, random)
            measured = f'[measured]\nnoise_microstrain = 1.0\nstrain = "{file.name}"\n'
            if name == "zeroed":
                text(folder / "zero.csv", names, 300_000, random)
                measured += 'zero = "zero.csv"\n'
            for command in commands:
                timed(command, job(folder / f"{name}.toml", names, measured))
