"""Two Dask workers compared with one on the same files: time of `fleet.run`, the smaller of two, and million samples per second.

The samples are read, recovered, counted, tested and hashed. `benches/day.py` compares the speed with plain reading of the same file.

    python benches/fleet.py          (with the package, numpy, pyarrow and distributed installed)

The target is .6 of the time. Workers are processes with one thread on this machine, and the caller merges at the end. If other programs use the
cores, two workers get no more processor time than one. The sum of the processor times of the busiest worker and of the caller is then the time on an
idle machine.
"""

import os
import tempfile
import time
from pathlib import Path

import distributed
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

try:
    from strainbridge import fleet
except ImportError:  # the file of this checkout, with the command in STRAINBRIDGE
    import sys

    sys.path.insert(0, str(Path(__file__).parent.parent / "python" / "strainbridge"))
    import fleet

FILES, SAMPLES, GAUGES, LOADS = 32, 120_000, 40, 6


def records(folder):
    """Writes a job and its records."""
    random = np.random.default_rng(8)
    names = [f"G{g}" for g in range(GAUGES)]
    s = random.normal(size=(LOADS, GAUGES))
    rows = [f"{n}," + ",".join(str(v) for v in s[:, g]) for g, n in enumerate(names)]
    loads = [f"F{i}" for i in range(LOADS)]
    (folder / "S.csv").write_text("\n".join(["gauge," + ",".join(loads), *rows, ""]))
    listed = "\n".join(f'[[load]]\nname = "{n}"\nexpected = 20e3' for n in loads)
    (folder / "job.toml").write_text(
        f'units = "m-kg-s"\n[sensitivity]\nfile = "S.csv"\nper = {{ force = "kN" }}\n{listed}\n'
        '[measured]\nnoise_microstrain = 1.0\n[fleet]\nfile_name = "{vehicle}_{day}.parquet"\n'
    )
    t = np.arange(SAMPLES) / 500
    files = []
    for i in range(FILES):
        f = 20 * np.sin(np.outer(t, random.uniform(1, 12, LOADS)))
        strain = (f @ s + random.normal(size=(SAMPLES, GAUGES))).astype(np.float32)
        files.append(str(folder / f"T{i % 4}_{i:02}.parquet"))
        pq.write_table(pa.table([t, *strain.T], names=["time", *names]), files[-1])
    return folder / "job.toml", files


def busy():
    """Returns the processor seconds of this process and of the processes that it has started and waited for."""
    return sum(os.times()[:4])


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        job, files = records(folder)
        best, path = {}, {}
        for turn in range(2):
            for workers in (1, 2):
                with distributed.LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
                    with distributed.Client(cluster) as client:
                        client.wait_for_workers(workers)
                        before, own = client.run(busy), busy()
                        begin = time.perf_counter()
                        fleet.run(str(job), files, folder / f"out-{turn}-{workers}", client=client)
                        took = time.perf_counter() - begin
                        after = client.run(busy)
                        spent = max(after[w] - before[w] for w in before) + busy() - own
                best[workers] = min(took, best.get(workers, took))
                path[workers] = min(spent, path.get(workers, spent))
        speed = {w: FILES * SAMPLES / t / 1e6 for w, t in best.items()}
        print(
            f"{FILES} files of {SAMPLES} samples: one worker {best[1]:.1f} s ({speed[1]:.2f} million samples a second), "
            f"two {best[2]:.1f} s ({speed[2]:.2f}): {best[2] / best[1]:.2f} of the time; of processor, the busiest worker and the caller, "
            f"{path[1]:.1f} and {path[2]:.1f} s: {path[2] / path[1]:.2f}"
        )
