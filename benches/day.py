"""Record of a day, 8 hours at 500 Hz with 41 channels: time and peak memory of `fleet`, compared with plain reading by pyarrow and asammdf.

    STRAINBRIDGE=target/release/strainbridge python benches/day.py [HOURS] [FOLDER]

Every reading is a separate process, and the files are in the page cache. `fleet` reads, recovers, counts and hashes the record. The peak is that of
resident memory minus the file, which is read into memory. Needs numpy and pyarrow, and asammdf for MDF4.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

RATE, GAUGES, LOADS = 500, 40, 6
GROUP = 500_000

JOB = """units = "m-kg-s"
report_units = { force = "kN" }
[sensitivity]
file = "S.csv"
per = { force = "kN" }
"""

PLAIN = {
    "parquet": """
import sys, pyarrow.parquet as pq
n = 0
for batch in pq.ParquetFile(sys.argv[1]).iter_batches(batch_size=65536):
    n += batch.num_rows
print(n)
""",
    "mf4": """
import sys, asammdf
file = asammdf.MDF(sys.argv[1])
all = [(None, 0, i) for i in range(len(file.groups[0].channels))]
print(len(file.select(all)[0].samples))
""",
}


def blocks(samples, random):
    """Strain of slowly varying loads with noise, block by block."""
    s = random.normal(size=(LOADS, GAUGES))
    for begin in range(0, samples, GROUP):
        t = np.arange(begin, min(begin + GROUP, samples)) / RATE
        f = 20 * np.sin(np.outer(t, [1.1, 1.7, 2.3, 3.1, 4.3, 5.9]) * 2) * (1 + 0.3 * np.sin(0.01 * t))[:, None]
        yield t, (f @ s + random.normal(size=(len(t), GAUGES))).astype(np.float32)


def written(folder, ending, samples):
    """Writes the record and its job into a folder."""
    random = np.random.default_rng(8)
    names = [f"G{g}" for g in range(GAUGES)]
    path = folder / f"T1_day.{ending}"
    if ending == "parquet":
        import pyarrow as pa
        import pyarrow.parquet as pq

        schema = pa.schema([("time", pa.float64())] + [(n, pa.float32()) for n in names])
        with pq.ParquetWriter(path, schema) as writer:
            for t, strain in blocks(samples, random):
                writer.write_table(pa.table([t, *strain.T], schema=schema))
    else:
        import asammdf

        file = asammdf.MDF(version="4.10")
        for i, (t, strain) in enumerate(blocks(samples, random)):
            columns = [strain[:, g].copy() for g in range(GAUGES)]
            if i == 0:
                file.append([asammdf.Signal(c, t, name=n, unit="um/m") for n, c in zip(names, columns)])
            else:
                file.extend(0, [(v, None) for v in [t, *columns]])
        file.save(path, overwrite=True)
    fleet = f'[measured]\nnoise_microstrain = 1.0\n[fleet]\nfile_name = "{{vehicle}}_{{day}}.{ending}"\n'
    job(folder / f"{ending}.toml", names, fleet)
    return path


def job(path, gauges, sections):
    """Writes a job with six loads and these sections, and S of its gauges."""
    s = np.random.default_rng(8).normal(size=(LOADS, len(gauges)))
    rows = [f"{n}," + ",".join(str(v) for v in s[:, g]) for g, n in enumerate(gauges)]
    loads = [f"F{i}" for i in range(LOADS)]
    (path.parent / "S.csv").write_text("\n".join(["gauge," + ",".join(loads), *rows, ""]))
    listed = "\n".join(f'[[load]]\nname = "{n}"\nexpected = 20e3' for n in loads)
    path.write_text(f"{JOB}{listed}\n{sections}")
    return path


# A separate process starts the command, because the memory of the starting process counts in the peak of the command.
MEASURED = """
import os, subprocess, sys, time
begin = time.perf_counter()
child = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
_, status, usage = os.wait4(child.pid, 0)
print(time.perf_counter() - begin, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, os.waitstatus_to_exitcode(status))
"""


def run(call, ends):
    """Returns seconds, processor seconds and peak memory (bytes) of a command that ends with one of these codes."""
    done = subprocess.run([sys.executable, "-c", MEASURED, *map(str, call)], capture_output=True, text=True, check=True)
    seconds, busy, peak, code = done.stdout.split()
    if int(code) not in ends:
        raise RuntimeError(done.stderr)
    return float(seconds), float(busy), int(peak)


if __name__ == "__main__":
    hours = float(sys.argv[1]) if len(sys.argv) > 1 else 8.0
    kept = Path(sys.argv[2]) if len(sys.argv) > 2 else None
    program = os.environ.get("STRAINBRIDGE", "strainbridge")
    samples = int(hours * 3600 * RATE)
    with tempfile.TemporaryDirectory(dir=kept) as name:
        folder = Path(name)
        for ending in ["parquet", "mf4"]:
            try:
                path = written(folder, ending, samples)
            except ImportError as absent:
                print(f"{ending}: {absent}")
                continue
            size = path.stat().st_size
            path.read_bytes()
            plain = [run([sys.executable, "-c", PLAIN[ending], str(path)], (0,)) for _ in range(3)]
            ours = []
            for i in range(3):
                call = [program, "fleet", str(folder / f"{ending}.toml"), str(path), "--out", str(folder / f"out{i}")]
                ours.append(run(call, (0, 1)))
            (theirs, busy), (seconds, spent) = ([min(r[i] for r in runs) for i in range(2)] for runs in (plain, ours))
            peak = max(r[2] for r in ours)
            for i in range(3):
                answer = json.loads((folder / f"out{i}" / "result.json").read_text())
                if answer["files"][0]["status"] != "done":
                    raise RuntimeError(answer["files"][0]["message"])
            print(
                f"{ending}: {samples} samples, {size / 1e6:.0f} MB; plain reading {theirs:.1f} s ({busy:.1f} of processor), fleet {seconds:.1f} s "
                f"({spent:.1f}): {theirs / seconds:.2f} of its throughput; peak {(peak - size) / 1e6:.0f} MB above the file"
            )
            path.unlink()
