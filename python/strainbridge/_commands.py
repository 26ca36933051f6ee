"""The commands as functions. A job is a :class:`Job`, its path, or a dictionary with its keys.

Common arguments:

- `threads`: number of threads; None or -1: all cores.
- `cache`: whether solutions of the built-in solver are stored in the user's cache, as the command does.
- `progress`: True shows a bar of tqdm, if it is installed. A function is called about twenty times a second with the stage, the number of
  completed parts and the total number of parts (0: unknown).

The functions raise :class:`Faults` with every fault of the input. They raise ``KeyboardInterrupt`` as soon as the work has stopped: between two
stages, or between the load cases, runs, files or trials of a stage. They write nothing before :meth:`Outcome.save`. If a finding is an error, the
call issues an :class:`UnreliableWarning`.
"""

from __future__ import annotations

import json
import logging
import os
import tempfile
from pathlib import Path as _Folder
from typing import Any, Callable, Mapping, Optional, Union

from . import _strainbridge as _engine
from ._convert import count
from ._convert import threads as _threads
from ._faults import Faults
from ._job import Job, job_of
from ._outcome import Outcome, Record, warn_if_unreliable
from ._progress import shown

Path = Union[str, "os.PathLike[str]"]
AnyJob = Union[Job, Path, Mapping[str, Any]]
Progress = Optional[Union[bool, Callable[[str, int, int], object]]]

_log = logging.getLogger("strainbridge")


def _ask(command: str, job: AnyJob | None, **more: Any) -> Outcome:
    checked = None if job is None else job_of(job)._checked()
    more["threads"] = _threads(more.get("threads"))
    with shown(more.pop("progress", None)) as report:
        return outcome_of(command, _engine.ask(command, checked, progress=report, **more))


def outcome_of(command: str, native: _engine._Outcome) -> Outcome:
    """Returns the outcome of a command. Logs its notes, and issues a warning if a finding is an error."""
    out = Outcome(native)
    for note in out.notes:
        _log.info("%s: %s", command, note)
    warn_if_unreliable(command, out.findings)
    return out


def _is_job(what: AnyJob) -> bool:
    return isinstance(what, (Job, Mapping)) or os.fspath(what).lower().endswith(".toml")


def sensitivity(job: AnyJob, *, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """S of the job's gauges, or of its candidates.

    The outcome contains ``S`` (gauges x loads, microstrain per job unit of each load), ``gauges`` and ``loads`` (names of rows and columns), ``rank``,
    ``condition_number``, ``condition_number_scaled``; ``to_arrow()`` and, once saved, ``sensitivity.csv``.
    """
    return _ask("sensitivity", job, threads=threads, cache=cache, progress=progress)


def place(job: AnyJob, *, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """Places gauges.

    The outcome contains ``gauges`` (name, element, surface, position, direction, angle_deg, leverage), ``log_det``, ``efficiency_bound``, ``condition_number``, ``load_sigma``.
    """
    return _ask("place", job, threads=threads, cache=cache, progress=progress)


def recover(job: AnyJob, *, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """Loads from measured strain.

    The outcome contains ``loads`` (run, name, value, sigma, unit), ``condition_number``, ``residual_rms_microstrain``, ``gauges``.
    """
    return _ask("recover", job, threads=threads, cache=cache, progress=progress)


def respond(job: AnyJob, *, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """Strain and stress anywhere on the structure from recovered loads.

    The outcome contains ``elements`` (element, surface, max_von_mises, at, sigma).
    """
    return _ask("respond", job, threads=threads, cache=cache, progress=progress)


def payload(job: AnyJob, *, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """Mass and position of the payload.

    The outcome contains ``payload`` (run, force, mass, position, their sigmas), ``by_gauge``.
    """
    return _ask("payload", job, threads=threads, cache=cache, progress=progress)


def ballast(job: AnyJob, *, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """Lumped masses that bring the model's reactions to the measured ones.

    The outcome contains ``masses`` (mass, position), ``reactions``.
    """
    return _ask("ballast", job, threads=threads, cache=cache, progress=progress)


def study(job: AnyJob, *, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """Recovery repeated under stated errors, for a range of layouts and gauge counts.

    The outcome contains ``study`` (layout, gauges, error, condition_number, loads).
    """
    return _ask("study", job, threads=threads, cache=cache, progress=progress)


def identify(job: AnyJob, *, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """Parameters of the vehicle and wheel loads from accelerations.

    The outcome contains ``parameters`` (name, value, sigma, unit, identifiable), ``unidentifiable``, ``fit``, ``mass_closure``.
    """
    return _ask("identify", job, threads=threads, cache=cache, progress=progress)


def simulate(job: AnyJob, *, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """Response of a vehicle with known parameters to wheel forces, to a road or to recorded accelerations.

    The outcome contains ``response`` (channel, unit, min, max, rms), ``fastest_mode_hz`` and ``integration``; ``response.csv`` once saved.
    """
    return _ask("simulate", job, threads=threads, cache=cache, progress=progress)


def calibrate(job: AnyJob, *, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """Calibrates S with runs of known loads.

    The outcome contains ``calibration`` (runs, prior, gauges, repeat_scatter_rel, noise_rel, coverage).
    """
    return _ask("calibrate", job, threads=threads, cache=cache, progress=progress)


def cases(job: AnyJob, *, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """The job's deck with one unit-load subcase for each load, ready for Nastran.

    The outcome contains ``subcases``; ``unit_loads.bdf`` once saved.
    """
    return _ask("cases", job, threads=threads, cache=cache, progress=progress)


def reconcile(job: AnyJob, *, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """Gap between simulation and measurement, the missing effect, and the gap with this effect.

    The outcome contains ``verdict``, ``named``, ``effects``, ``rivals``, ``gap``, ``next_measurement``.
    """
    return _ask("reconcile", job, threads=threads, cache=cache, progress=progress)


def check(*files: Path, threads: int | None = None, progress: Progress = None) -> Outcome:
    """Contents of decks, results and jobs, every fault, and whether the files match.

    The outcome contains ``decks`` (path, cards, grids, elements, mass, cg), ``results`` (path, solver, tables) and ``faults``, which are part of
    the answer here.

    Raises:
        Faults: no file is given.
    """
    if not files:
        raise Faults([("check", None, "files", "no file is given", "name decks, results, records or jobs")])
    return _ask("check", None, files=list(files), threads=threads, progress=progress)


def init(deck: Path, *results: Path, folder: Path = ".", threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """Proposes a job from a deck and its results, for `folder`. :meth:`Outcome.save` writes it there as ``job.toml``.

    The outcome contains ``job``, ``loads``, ``left_out``, ``placeable``.

    Raises:
        Faults: a file cannot be read, or the folder contains a job already.
    """
    return _ask("init", None, files=[deck, *results], folder=folder, threads=threads, cache=cache, progress=progress)


def strains(deck: Path, *results: Path, threads: int | None = None, progress: Progress = None) -> Outcome:
    """Strain of shells and bars of every static subcase in the element frame and in the basic frame, with ``strains.csv`` once saved.

    The outcome contains ``rows`` and ``subcases``.
    """
    return _ask("strains", None, files=[deck, *results], threads=threads, progress=progress)


def solve(
    job: AnyJob,
    *,
    modes: int = 10,
    total_strain: bool = False,
    threads: int | None = None,
    cache: bool = True,
    progress: Progress = None,
) -> Outcome:
    """The unit loads of a job, or the static subcases of a deck, by the built-in solver.

    The outcome contains ``grids``, ``dofs``, ``balance``, ``peak_memory_bytes``; ``results.op2`` and ``results.vtu`` once saved.

    Args:
        job: a job, or the path of a deck.
        modes: elastic modes in addition to the static solution.
        total_strain: whether strain of a heated structure includes thermal expansion.
    """
    files, asked = ([], job) if _is_job(job) else ([job], None)
    more: dict[str, Any] = {"modes": count("modes", modes), "total_strain": total_strain, "threads": threads, "cache": cache, "progress": progress}
    return _ask("solve", asked, files=files, **more)


def modes(job: AnyJob, *, modes: int = 10, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Outcome:
    """Elastic modes of the structure of a job or of a deck.

    The outcome contains ``modes`` (hz, generalised_mass).

    Args:
        job: a job, or the path of a deck.
        modes: number of modes.
    """
    files, asked = ([], job) if _is_job(job) else ([job], None)
    return _ask("modes", asked, files=files, modes=count("modes", modes), threads=threads, cache=cache, progress=progress)


def verify(folder: Path, *, threads: int | None = None, progress: Progress = None) -> Outcome:
    """Recomputes a result folder from its inputs without stored solutions, and compares all files and numbers.

    The outcome contains ``same`` and ``differs`` (file, at, was, now).

    Args:
        folder: folder that a command or :meth:`Outcome.save` wrote.

    Raises:
        Faults: it is not such a folder, or its inputs are missing.
    """
    command, main, results = _engine.made(folder)
    with tempfile.TemporaryDirectory() as again:
        more: dict[str, Any] = {"threads": threads, "progress": progress}
        if command in ("fleet", "verify"):
            raise ValueError(f"{os.fspath(folder)} was written by `{command}`, which is repeated by calling it")
        if command in ("strains", "check"):
            out = _ask(command, None, files=[main, *(results if command == "strains" else [])], **more)
        elif command == "init":
            out = _ask(command, None, files=[main], folder=again, **more)
        elif command in ("solve", "modes"):
            out = {"solve": solve, "modes": modes}[command](os.fspath(main), cache=False, **more)
        else:
            out = _ask(command, os.fspath(main), cache=False, **more)
        out.save(again)
        return _ask("verify", None, files=[folder], folder=again, threads=threads)


def clean(folder: Path | None = None) -> Record:
    """Removes stored solutions of the built-in solver. Returns ``folder``, ``removed`` (their number) and ``bytes``.

    Args:
        folder: folder of the solutions; None: the user's cache folder.
    """
    where, removed, size = _engine.clean(None if folder is None else _Folder(folder))
    return Record({"command": "clean", "folder": os.fspath(where), "removed": removed, "bytes": size})


def explain(code: str | None = None) -> Record | list[Record]:
    """Explains a finding: ``code``, ``severity``, ``said_by``, ``cause``, ``limit``, ``remedy``, ``example``.

    Args:
        code: code of a finding, such as ``loads-not-separable``; None: every code.

    Raises:
        Faults: no finding has the code. The message names the closest code.
    """
    said = json.loads(_engine.explain(code))
    return Record(said) if code is not None else [Record(c) for c in said]
