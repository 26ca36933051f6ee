"""A plan of gauges in memory: a layout after a change costs only the search."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping
from typing import Any

from . import _strainbridge as _engine
from ._commands import AnyJob, Progress, outcome_of
from ._convert import threads as _threads
from ._data import csv_bytes, is_table
from ._job import job_of
from ._outcome import Outcome
from ._progress import shown


class Plan:
    """Plan of gauges for one model and its loads, as ``strainbridge open`` keeps it.

    ``plan = sb.Plan.read(job)`` reads the model and the strain of the loads once. :meth:`place` chooses gauges for this job, or for a job with other
    candidates, another number of gauges or gauges that stay. :meth:`evaluate` states what gauges at other places cost. A plan cannot be pickled.
    """

    __slots__ = ("_native",)

    _native: _engine._Plan

    def __init__(self, native: _engine._Plan) -> None:
        self._native = native

    @classmethod
    def read(cls, job: AnyJob, *, threads: int | None = None, cache: bool = True, progress: Progress = None) -> Plan:
        """Reads the model of a job and the strain of its loads.

        Raises:
            Faults: every fault of the files, or a job without a model or loads.
        """
        with shown(progress) as report:
            return cls(_engine._Plan(job_of(job)._checked(), _threads(threads), cache, report))

    def place(self, job: AnyJob, *, threads: int | None = None, progress: Progress = None) -> Outcome:
        """Chooses gauges like :func:`strainbridge.place`. The job must have the model and the loads of the plan.

        Raises:
            Faults: candidates that allow no layout, or gauges that cannot be kept.
        """
        with shown(progress) as report:
            return outcome_of("place", self._native.place(job_of(job)._checked(), _threads(threads), report))

    @staticmethod
    def gauges(layout: Outcome) -> list[dict[str, str]]:
        """Returns the rows of ``gauges.csv`` of a layout, as texts by column. Change them for :meth:`evaluate`.

        To move a gauge, set ``x``, ``y`` and ``z`` and leave ``element`` empty. The program then takes the nearest shell.

        Raises:
            TypeError: the outcome is no layout, or a copy without its engine.
        """
        read = getattr(layout._native, "gauge_table", None)
        text = read() if read is not None else None
        if text is None:
            raise TypeError("no layout: give an outcome of `Plan.place` or `place`, not a copy of it")
        return list(csv.DictReader(io.StringIO(text)))

    def evaluate(self, job: AnyJob, gauges: Any, best: Outcome, *, threads: int | None = None, progress: Progress = None) -> Outcome:
        """Evaluates gauges like a chosen layout, with the bound of the best one.

        Args:
            job: the job of `best`.
            gauges: rows of :meth:`gauges`, or a table with the columns of ``gauges.csv``.
            best: an outcome of :meth:`place` for the same job. Its bound gives ``efficiency_bound`` of the gauges.

        Raises:
            Faults: gauges that cannot be laid, or that do not separate the loads.
            TypeError: `best` is no outcome of the engine, or `gauges` is no table.
        """
        if not isinstance(best._native, _engine._Outcome):
            raise TypeError("`best` is a copy of an outcome: give the one that `Plan.place` returned")
        with shown(progress) as report:
            native = self._native.evaluate(job_of(job)._checked(), _text_of(gauges), best._native, _threads(threads), report)
        return outcome_of("place", native)


def _text_of(gauges: Any) -> str:
    """Returns gauges as the text of a table."""
    if is_table(gauges):
        return csv_bytes(gauges).decode()
    rows: list[Any] = list(gauges) if isinstance(gauges, Iterable) and not isinstance(gauges, (str, bytes)) else [None]
    if not rows or not all(isinstance(row, Mapping) for row in rows):
        raise TypeError("gauges: give rows of `Plan.gauges`, or a table with the columns of `gauges.csv`")
    text = io.StringIO()
    out = csv.DictWriter(text, list(dict.fromkeys(key for row in rows for key in row)), lineterminator="\n")
    out.writeheader()
    out.writerows(rows)
    return text.getvalue()
