"""Records of many vehicles and days: this machine's cores, a Dask cluster, or any scheduler.

    from strainbridge import fleet
    result = fleet.run("job.toml", ["data/T1_2026-05-01.parquet", ...], out="fleet")
    result = fleet.run("job.toml", files, out="/shared/fleet", client=dask.distributed.Client("tcp://scheduler:8786"))

A task is one call of the command `strainbridge fleet` on some files. It keeps a small result a file in the folder `out`, by the digest of file,
job and version, so a task that is repeated, or a run that is begun again, does what is new alone; at the end one call without files merges
what the folder holds. The same files give the same bytes of `fleet.csv` whoever did them. `out`, `job` and `files` must be reachable under
the same paths by every worker.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Iterable, Sequence

#: Files of one task of a cluster: enough that starting a process costs little, few enough that a lost task loses little.
FILES_A_TASK = 8


class FleetError(RuntimeError):
    """Bad input: every fault, as the command prints it."""


def program() -> str:
    """Path of the command: that named by STRAINBRIDGE, else the one on the path."""
    found = os.environ.get("STRAINBRIDGE") or shutil.which("strainbridge")
    if not found:
        raise FleetError("no command `strainbridge` on the path: install it, or name it in the environment variable STRAINBRIDGE")
    return found


def part(job: str, files: Sequence[str], out: str, threads: int | None = None) -> list[dict[str, str]]:
    """Does some files and returns path, status and message of each: a pure function of its arguments but for the results kept in `out`."""
    files = [str(f) for f in files]
    if not files:
        return []
    # The answer of a task goes to a folder of its own; what counts is kept under `out/days`, which all tasks share.
    with tempfile.TemporaryDirectory() as own:
        answer = _call([job, *files, "--out", own, "--kept", out, "--json"], threads)
    return [{k: f[k] for k in ("path", "status", "message")} for f in answer["files"]]


def merge(job: str, out: str) -> dict[str, Any]:
    """The result of everything that `out` holds of this job; `fleet.csv`, `fleet.parquet` and the report are written there."""
    return _call([job, "--out", out, "--json"], None)


def run(job: str | Path, files: Iterable[str | Path], out: str | Path = "fleet", client: Any = None, threads: int | None = None) -> dict[str, Any]:
    """Does all files and returns what `result.json` holds.

    `client` is a `dask.distributed.Client`, whose workers do the files in tasks of eight; None does them here, on all cores or `threads`.
    """
    job, out = str(job), str(out)
    files = sorted({str(f) for f in files})
    if client is None:
        return _call([job, *files, "--out", out, "--json"], threads)
    tasks = [files[i : i + FILES_A_TASK] for i in range(0, len(files), FILES_A_TASK)]
    futures = client.map(part, [job] * len(tasks), tasks, [out] * len(tasks), [threads or 1] * len(tasks), pure=False, retries=3)
    client.gather(futures)
    # Files whose results were kept by the workers are not decoded again.
    return _call([job, *files, "--out", out, "--json"], threads)


def _call(arguments: list[str], threads: int | None) -> dict[str, Any]:
    more = ["--threads", str(threads)] if threads else []
    done = subprocess.run([program(), "fleet", *arguments, *more], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise FleetError(done.stderr.strip())
    return json.loads(done.stdout)
