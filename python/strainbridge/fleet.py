"""Records of many vehicles and days: this machine's cores, a Dask cluster, or any scheduler.

    import strainbridge as sb
    result = sb.fleet.run("job.toml", ["data/T1_2026-05-01.parquet", ...], out="fleet")
    result = sb.fleet.run("job.toml", files, out="/shared/fleet", client=dask.distributed.Client("tcp://scheduler:8786"))

A task does some files. It keeps a small result a file in the folder `out`, by the digest of file, job and version, so a task that is
repeated, or a run that is begun again, does what is new alone; at the end what the folder holds is merged. The same files give the same bytes
of `fleet.csv` whoever did them. `out`, `job` and `files` must be reachable under the same paths by every worker.

Where the environment variable STRAINBRIDGE names a command, or the engine of the package is missing (this file alone will do), that command
does the work.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterable, Mapping, Sequence, cast

if TYPE_CHECKING:
    from ._outcome import Outcome as Answer

try:
    from . import _strainbridge as _engine
    from ._convert import threads as _threads
    from ._faults import Faults
    from ._job import job_of
    from ._outcome import Outcome
    from ._progress import shown
except ImportError:  # the file alone
    _engine = None  # type: ignore[assignment]

    def _threads(value: Any) -> int | None:
        return None if value in (None, -1) else int(value)

__all__ = ["FILES_A_TASK", "FleetError", "merge", "part", "program", "run"]

#: Files of one task of a cluster: enough that starting a task costs little, few enough that a lost task loses little.
FILES_A_TASK = 8

#: A job, or the path of one.
AnyJob = Any


class FleetError(RuntimeError):
    """Bad input: every fault, as the command prints it."""


def program() -> str:
    """Path of the command: that named by STRAINBRIDGE, else the one on the path."""
    found = os.environ.get("STRAINBRIDGE") or shutil.which("strainbridge")
    if not found:
        raise FleetError("no command `strainbridge` on the path: install it, or name it in the environment variable STRAINBRIDGE")
    return found


def part(job: AnyJob, files: Sequence[str], out: str, threads: int | None = None) -> list[dict[str, str]]:
    """Does some files and returns path, status, message and SHA-256 of each: a pure function of its arguments but for the results kept in `out`."""
    files = [str(f) for f in files]
    if not files:
        return []
    # What counts is kept under `out/days`, which all tasks share; the answer of a part is not.
    task = _Task(job, files, out, threads)
    if _in_process():
        answer: Mapping[str, Any] = task.by_engine()
    else:
        with tempfile.TemporaryDirectory() as own:
            answer = task.by_command(own)
    return [{k: f[k] for k in ("path", "status", "message", "sha256")} for f in answer["files"]]


def merge(job: AnyJob, out: str | Path) -> Answer:
    """The result of everything that `out` holds of this job; `fleet.csv`, `fleet.parquet` and the report are written there."""
    return _saved(_Task(job, [], str(out)), str(out))


def run(
    job: AnyJob,
    files: str | Path | Iterable[str | Path],
    out: str | Path = "fleet",
    client: Any = None,
    threads: int | None = None,
    shard: str | None = None,
    progress: Any = None,
    digests: Mapping[str, str] | None = None,
) -> Answer:
    """Does all files, writes what the command writes into `out`, and returns the outcome: ``vehicles``, ``files``, as in `result.json`.

    Args:
        job: a job with ``[fleet]``, or the path of one.
        files: records, relative to the working folder; a text or path is one file.
        out: where the results of single files are kept, and those of the fleet written.
        client: a `dask.distributed.Client`, whose workers do the files in tasks of eight; None: they are done here.
        threads: how many here, all cores where None; on a worker 1 where None.
        shard: ``"3/64"``: the third of 64 parts of the files alone, for a scheduler of your own. The outcome of the part goes to a folder of its
            own within `out`; :func:`merge` makes the fleet of all parts.
        progress: as of every command; True: a bar of tqdm. Of the files done here.
        digests: SHA-256 of files, by path as in `files`, for a driver that does not read them again.

    Raises:
        Faults: bad input; a file that is missing. A record that cannot be read is a failed file and a finding.
    """
    job = str(job) if isinstance(job, os.PathLike) else job
    out = str(out)
    listed = sorted({str(f) for f in ([files] if isinstance(files, (str, os.PathLike)) else files)})
    digests = dict(digests or {})
    missing = [f for f in listed if f not in digests and not os.path.exists(f)]
    if missing and client is None:
        raise _missing(missing)
    threads = _threads(threads)
    if shard is not None:
        number, _, of = shard.partition("/")
        return _saved(_Task(job, listed, out, threads, shard, progress), os.path.join(out, f"shard-{number}-of-{of}"))
    if client is not None:
        tasks = [listed[i : i + FILES_A_TASK] for i in range(0, len(listed), FILES_A_TASK)]
        n = len(tasks)
        futures = client.map(part, [job] * n, tasks, [out] * n, [threads or 1] * n, pure=False, retries=3)
        # What a task that failed for good leaves undone is done here, or raises here. Files that workers did are not read again.
        done = [f for some in client.gather(futures, errors="skip") for f in some]
        digests.update({f["path"]: f["sha256"] for f in done if f["sha256"]})
    return _saved(_Task(job, listed, out, threads, progress=progress, digests=digests), out)


def _missing(files: Sequence[str]) -> Exception:
    """The error for files that do not exist."""
    faults = [(f, None, "files", "the file does not exist", "give a path relative to the working folder") for f in files]
    return Faults(faults) if _engine is not None else FleetError("\n".join(f"{f[0]}: {f[3]}: {f[4]}" for f in faults))


def _in_process() -> bool:
    """Whether the engine of the package does the work."""
    return _engine is not None and not os.environ.get("STRAINBRIDGE")


@dataclass(frozen=True)
class _Task:
    """What is asked: the files, and the folder `kept` of the results of single files."""

    job: AnyJob
    files: Sequence[str]
    kept: str
    threads: int | None = None
    shard: str | None = None
    progress: Any = None
    digests: Mapping[str, str] = field(default_factory=dict)

    def by_engine(self) -> Outcome:
        with shown(self.progress) as told:
            return Outcome(
                _engine.ask(
                    "fleet",
                    job_of(self.job)._checked(),
                    files=self.files,
                    folder=self.kept,
                    shard=self.shard,
                    digests=self.digests,
                    threads=self.threads,
                    progress=told,
                )
            )

    def by_command(self, out: str) -> dict[str, Any]:
        path = str(getattr(self.job, "path", self.job))
        more = ["--threads", str(self.threads)] if self.threads else []
        more += ["--kept", self.kept] if self.kept != out else []
        more += ["--shard", self.shard] if self.shard else []
        with tempfile.TemporaryDirectory() as own:
            if self.digests:
                listed = Path(own, "digests.txt")
                lines = [f"{digest}  {file}\n" for file, digest in self.digests.items() if "\n" not in file]
                listed.write_text("".join(lines), encoding="utf-8")
                more += ["--digests", str(listed)]
            call = [program(), "fleet", path, *self.files, "--out", out, "--json", *more]
            done = subprocess.run(call, capture_output=True, text=True, check=False)
        if done.returncode not in (0, 1):
            raise FleetError(done.stderr.strip())
        answer: dict[str, Any] = json.loads(done.stdout)
        return answer


def _saved(task: _Task, out: str) -> Answer:
    """The answer, its files written into `out`."""
    if not _in_process():
        return cast("Answer", task.by_command(out))
    outcome = task.by_engine()
    outcome.save(out)
    return outcome


def __dir__() -> list[str]:
    return sorted(__all__)
