"""Records of many vehicles and days: this machine's cores, a Dask cluster, or any scheduler.

    import strainbridge as sb
    result = sb.fleet.run("job.toml", ["data/T1_2026-05-01.parquet", ...], out="fleet")
    result = sb.fleet.run("job.toml", files, out="/shared/fleet", client=dask.distributed.Client("tcp://scheduler:8786"))

A task processes some files. It stores a small result for each file in the folder `out`, by the digest of file, job and version. If a task is
repeated, or a run starts again, it processes only new files. At the end, all stored results are merged. Equal files give equal bytes of `fleet.csv`,
on any machine. Every worker must find `out`, `job` and `files` under the same paths. A file may be a URL of an object store
(``s3://bucket/T1_2026-05-01.parquet``). The worker that reads it copies it through fsspec.

If the environment variable STRAINBRIDGE names a command, or the engine of the package is missing (this file is sufficient), that command does the
work. This file alone returns dictionaries with the keys of `result.json`.
"""

from __future__ import annotations

import glob
import json
import os
import shutil
import socket
import subprocess
import tempfile
import uuid
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterable, Iterator, Mapping, Sequence, cast

if TYPE_CHECKING:
    from ._outcome import Outcome as Answer

try:
    from . import _objects
    from . import _strainbridge as _engine
    from ._convert import threads as _threads
    from ._faults import Faults
    from ._job import job_of
    from ._outcome import Outcome
    from ._progress import shown
except ImportError:  # this file without the package
    _engine = None  # type: ignore[assignment]
    _objects = None  # type: ignore[assignment]

    def _threads(value: Any) -> int | None:
        return None if value in (None, -1) else int(value)

__all__ = ["FILES_A_TASK", "FleetError", "mark", "merge", "part", "program", "run"]

#: Files per task of a cluster. Few tasks have little overhead, and a lost task with few files loses little work.
FILES_A_TASK = 8

#: A job, or its path.
AnyJob = Any

#: A fault: file, line, field, what is wrong, what to do.
_Parts = tuple[str, "int | None", str, str, str]


class FleetError(RuntimeError):
    """Faulty input: every fault, as the command prints it."""


def program() -> str:
    """Returns the path of the command: the one in STRAINBRIDGE, otherwise the one on the path."""
    found = os.environ.get("STRAINBRIDGE") or shutil.which("strainbridge")
    if not found:
        raise FleetError("no command `strainbridge` on the path: install it, or name it in the environment variable STRAINBRIDGE")
    return found


@contextmanager
def mark(out: str | Path) -> Iterator[str]:
    """Writes a file into `out` for the duration of a run, and yields its name.

    :func:`part` with this name raises an error on a worker whose `out` is another folder."""
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    name = f".run-{uuid.uuid4().hex}"
    file = folder / name
    file.write_text(f"{socket.gethostname()}\n", encoding="utf-8")
    try:
        yield name
    finally:
        file.unlink(missing_ok=True)


def part(
    job: AnyJob,
    files: str | Sequence[str],
    out: str,
    threads: int | None = None,
    mark: str | None = None,
) -> list[dict[str, str]]:
    """Processes some files and returns path, status, message and SHA-256 of each.

    The result depends only on the arguments and on the results stored in `out`.

    Args:
        job: a job with ``[fleet]``, or its path.
        files: paths as this process finds them, or URLs of an object store.
        out: folder of the results, common to all tasks.
        threads: number of threads; None or -1: all cores.
        mark: name of the file that :func:`mark` has written into `out`.

    Raises:
        Faults: the input is faulty, or this process does not find a file or a folder. With the command instead of the engine: FleetError.
    """
    files = [str(files)] if isinstance(files, (str, os.PathLike)) else [str(f) for f in files]
    threads = _threads(threads)
    if not files:
        return []
    here = f"worker {socket.gethostname()}, working folder {os.getcwd()}"
    if mark is not None and not os.path.exists(os.path.join(out, mark)):
        remedy = f"mount the folder of the caller under the same path on every worker ({here})"
        raise _bad([(str(out), None, "out", "the worker does not find the folder of the caller", remedy)])
    missing = [f for f in files if not _is_object(f) and not os.path.exists(f)]
    if missing:
        remedy = f"give a path that every worker finds ({here})"
        raise _bad([(f, None, "files", "the worker does not find the file", remedy) for f in missing])
    urls = [f for f in files if _is_object(f)]
    known = _objects.known_digests(urls, out) if urls else {}
    with _copies([u for u in urls if u not in known], out) as states:
        names = _local_names(files, out)
        # The results are stored in `out/days`, which all tasks share. The answer of a part is discarded.
        task = _Task(job, list(names), out, threads, digests={_local_name(u, out): d for u, d in known.items()})
        if _in_process():
            answer: Mapping[str, Any] = task.by_engine()
        else:
            with tempfile.TemporaryDirectory() as own:
                answer = task.by_command(own)
        done = [{**{k: f[k] or "" for k in ("status", "message", "sha256")}, "path": names[f["path"]]} for f in answer["files"]]
        if states:
            _objects.keep_states(states, {f["path"]: f["sha256"] for f in done if f["status"] != "failed"}, out)
    # An object that was read before for another job has no result here, so this task reads it again.
    again = [f["path"] for f in done if f["status"] == "failed" and f["path"] in known]
    if not again:
        return done
    for url in again:
        _objects.forget(url, out)
    return [f for f in done if f["path"] not in again] + part(job, again, out, threads, mark)


def merge(job: AnyJob, out: str | Path) -> Answer:
    """Returns the merged result of all stored results of this job in `out`, and writes `fleet.csv`, `fleet.parquet` and the report there."""
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
    """Processes all files, writes the files of the command into `out`, and returns the outcome: ``vehicles``, ``files``, as in `result.json`.

    Args:
        job: a job with ``[fleet]``, or its path.
        files: records, relative to the working folder, or URLs of an object store that fsspec reads. A text or path is one file. A pattern
            (``data/**/*.parquet``) means the matching files or objects, a folder means the records below it (without a client).
        out: folder for the results of single files and those of the fleet.
        client: a `dask.distributed.Client`, whose workers process the files in tasks of eight; None: they are processed here. The task of a lost
            worker is repeated. Faulty input is not.
        threads: number of threads. None: all cores here, 1 on a worker.
        shard: ``"3/64"``: only the third of 64 parts of the files, for another scheduler. The outcome of the part goes to a separate folder
            within `out`. :func:`merge` combines all parts.
        progress: as for every command; True: a bar of tqdm, for the files that are processed here.
        digests: SHA-256 of files, by path as in `files`, for a driver that does not read them again.

    Raises:
        Faults: the input is faulty, a file is missing, or a worker does not find a file or `out`. The results of other files remain. A record
            that cannot be read is a failed file and a finding.
        FleetError: the workers were lost, or the command reports faults instead of the engine.
    """
    job = str(job) if isinstance(job, os.PathLike) else job
    out = str(out)
    if shard is not None and not isinstance(shard, str):
        raise TypeError(f"shard is {shard!r}; give a text such as '3/64'")
    if client is not None and not (hasattr(client, "map") and hasattr(client, "gather")):
        raise TypeError(f"client is {client!r}; give a `dask.distributed.Client`")
    _check_digests(digests)
    given = [files] if isinstance(files, (str, os.PathLike)) else files
    listed = sorted({f for g in given for f in _matching(str(g))})
    digests = dict(digests or {})
    missing = [f for f in listed if f not in digests and not _is_object(f) and not os.path.exists(f)]
    if missing and client is None:
        raise _missing(missing)
    folders = [f for f in listed if os.path.isdir(f)]
    if folders and (client is not None or any(map(_is_object, listed))):
        remedy = "give a pattern, such as data/**/*.parquet"
        raise _bad([(f, None, "files", "a folder is not divided among workers or mixed with objects", remedy) for f in folders])
    threads = _threads(threads)
    names = {_local_name(f, out): f for f in listed}
    done: list[dict[str, str]] = []
    if client is not None and shard is None:
        done = _by_workers(job, [f for f in listed if f not in digests or _is_object(f)], out, client, threads or 1)
    else:
        urls = [names[n] for n in _share(sorted(names), shard) if _is_object(names[n])]
        done = [f for few in _tasks(urls) for f in part(job, few, out, threads)]
    digests.update({f["path"]: f["sha256"] for f in done if f["sha256"]})
    to = out
    if shard is not None:
        number, _, of = shard.partition("/")
        to = os.path.join(out, f"shard-{number}-of-{of}")
    task = _Task(job, list(names), out, threads, shard, progress, {_local_name(f, out): d for f, d in digests.items()})
    # A failed record has no stored result. It is read again for its message.
    failed = [f["path"] for f in done if f["status"] == "failed" and _is_object(f["path"])]
    with _copies(failed, out):
        return _saved(task, to)


def _check_digests(digests: Any) -> None:
    """Checks the type of digests.

    Raises:
        TypeError: they are no dictionary.
        ValueError: a digest is not a SHA-256.
    """
    if digests is not None and not isinstance(digests, Mapping):
        raise TypeError(f"digests is {digests!r}; give a dictionary of SHA-256 by path")
    for file, digest in (digests or {}).items():
        if not isinstance(digest, str) or len(digest) != 64 or set(digest.lower()) - set("0123456789abcdef"):
            raise ValueError(f"the digest of {file} is {digest!r}; give its SHA-256, 64 hexadecimal digits")


def _matching(file: str) -> list[str]:
    """Returns the files that match a pattern, or any other path unchanged.

    Raises:
        Faults: no file matches.
    """
    if not any(sign in file for sign in "*?[") or os.path.exists(file):
        return [file]
    if _is_object(file):
        return list(_objects.matching(file))
    found = [f for f in glob.glob(file, recursive=True) if os.path.isfile(f)]
    if not found:
        raise _bad([(file, None, "files", "no file matches the pattern", "check the path; patterns are relative to the working folder")])
    return found


def _tasks(files: Sequence[str]) -> list[list[str]]:
    return [list(files[i : i + FILES_A_TASK]) for i in range(0, len(files), FILES_A_TASK)]


def _share(files: Sequence[str], shard: str | None) -> Sequence[str]:
    """Returns the files of a shard, divided as in the engine. The list is empty if the shard is not valid, which the engine reports."""
    number, _, of = (shard or "1/1").partition("/")
    valid = number.isdecimal() and of.isdecimal() and 1 <= int(number) <= int(of)
    return files[int(number) - 1 :: int(of)] if valid else []


def _by_workers(job: AnyJob, files: Sequence[str], out: str, client: Any, threads: int) -> list[dict[str, str]]:
    """Lets the workers process the files, and returns the results of :func:`part` for all of them.

    Raises:
        Faults: the faults of all workers, after all of them have ended.
        FleetError: files that no worker processed, because workers were lost.
    """
    tasks = _tasks(files)
    with mark(out) as name:
        n = len(tasks)
        # The scheduler repeats the task of a lost worker. An exception would occur again on every worker.
        futures = client.map(_answer, [job] * n, tasks, [out] * n, [threads] * n, [name] * n, pure=False, retries=0)
        answers = client.gather(futures, errors="skip")
    faults = list(dict.fromkeys(f for _, some in answers for f in some))
    if any(not f[0] for f in faults):
        raise FleetError("\n".join(f[3] for f in faults))
    if faults:
        raise _bad(faults)
    done = [f for some, _ in answers for f in some]
    processed = {f["path"] for f in done}
    lost = [f for f in files if f not in processed]
    if lost:
        more = "" if len(lost) == 1 else f" and {len(lost) - 1} more"
        failed = next((str(e) for e in (_error_of(f) for f in futures) if e is not None), "no reason is known")
        raise FleetError(f"no worker processed {lost[0]}{more}: {failed}. Results of the other files are kept: call `run` again")
    return done


def _error_of(future: Any) -> BaseException | None:
    return future.exception() if getattr(future, "status", None) == "error" else None


def _answer(job: AnyJob, files: Sequence[str], out: str, threads: int, mark: str) -> tuple[list[dict[str, str]], list[_Parts]]:
    """Returns the result of :func:`part` and the faults of the input as a value, so that no scheduler repeats the task."""
    try:
        return part(job, files, out, threads, mark), []
    except FleetError as e:
        return [], [("", None, "", str(e), "")]
    except ValueError as e:
        if _engine is None or not isinstance(e, Faults):
            raise
        return [], [(f.file, f.line, f.field, f.wrong, f.remedy) for f in e.faults]


def _bad(faults: Sequence[_Parts]) -> Exception:
    """Returns the exception for faulty input."""
    if _engine is not None:
        return Faults(faults)
    return FleetError("\n".join(": ".join(t for t in (f[0], f[2], f[3], f[4]) if t) for f in faults))


def _missing(files: Sequence[str]) -> Exception:
    """Returns the error for files that do not exist."""
    return _bad([(f, None, "files", "the file does not exist", "give a path relative to the working folder") for f in files])


def _is_object(file: str) -> bool:
    return _objects is not None and _objects.is_object(file)


def _copies(urls: Sequence[str], out: str) -> AbstractContextManager[dict[str, str]]:
    """Copies objects into `out` for the duration of a block, and yields their states."""
    return _objects.copies(urls, out) if urls else nullcontext({})


def _local_name(file: str, out: str) -> str:
    """Returns the path of a file for the engine: the path of the copy if the file is in an object store."""
    return _objects.local_name(file, out) if _is_object(file) else file


def _local_names(files: Sequence[str], out: str) -> dict[str, str]:
    """Returns the files by their path for the engine."""
    return {_local_name(f, out): f for f in files}


def _in_process() -> bool:
    """Returns whether the engine of the package does the work."""
    return _engine is not None and not os.environ.get("STRAINBRIDGE")


@dataclass(frozen=True)
class _Task:
    """Request: the files, and the folder `kept` with the results of single files."""

    job: AnyJob
    files: Sequence[str]
    kept: str
    threads: int | None = None
    shard: str | None = None
    progress: Any = None
    digests: Mapping[str, str] = field(default_factory=dict)

    def by_engine(self) -> Outcome:
        with shown(self.progress) as report:
            return Outcome(
                _engine.ask(
                    "fleet",
                    job_of(self.job)._checked(),
                    files=self.files,
                    folder=self.kept,
                    shard=self.shard,
                    digests=self.digests,
                    threads=self.threads,
                    progress=report,
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
    """Returns the answer, and writes its files into `out`."""
    if not _in_process():
        answer = task.by_command(out)
        if _engine is None:
            # This file without the package: a dictionary with the keys of result.json.
            return cast("Answer", answer)
        return Outcome.of_folder(answer, out)
    outcome = task.by_engine()
    outcome.save(out)
    return outcome


def __dir__() -> list[str]:
    return sorted(__all__)
