"""S calibrated from bare arrays: readings under known loads."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from typing import Any, Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._commands import calibrate
from ._convert import floats, number
from ._job import Job
from ._outcome import Finding, Outcome


@dataclass(frozen=True)
class CalibratedRows:
    """S from calibration runs, with its uncertainty."""

    #: gauges x loads, microstrain per unit of load.
    S: NDArray[np.float64]
    #: Answer of the command `calibrate`: ``outcome.calibration``.
    outcome: Outcome

    @property
    def findings(self) -> Sequence[Finding]:
        """Findings, the worst first."""
        return self.outcome.findings

    @property
    def is_reliable(self) -> bool:
        """Whether no finding is an error. An error means that the answer is unreliable."""
        return self.outcome.is_reliable

    def __repr__(self) -> str:
        return repr(self.outcome)


def calibrate_rows(
    strain: ArrayLike,
    loads: ArrayLike,
    noise: float = 1.0,
    *,
    prior: ArrayLike | None = None,
    prior_rel: float = 0.1,
    repeats: Sequence[object] | None = None,
    threads: int | None = None,
) -> CalibratedRows:
    """Returns S from runs with known loads, as the command `calibrate` computes it.

    Args:
        strain: runs x gauges, microstrain; NaN for a missing reading.
        loads: runs x loads, in any one unit; NaN: unknown, 0: known to be zero.
        noise: sd of one reading, microstrain.
        prior: S of a model, gauges x loads, microstrain per unit of load.
        prior_rel: relative error of the model, 1 sd, for each entry and common to a gauge.
        repeats: one label for each run; runs with equal labels are repeats, and their scatter enters the intervals.
        threads: number of threads; None: all cores.

    Raises:
        Faults: there are too few runs, or the tables are not valid.
        ValueError: the shapes do not match.
    """
    readings, known = floats("strain", strain), floats("loads", loads)
    if readings.ndim != 2 or known.ndim != 2 or len(readings) != len(known):
        raise ValueError(f"strain is runs x gauges and loads is runs x loads, not {readings.shape} and {known.shape}")
    gauges = [f"G{g}" for g in range(readings.shape[1])]
    names = [f"L{load}" for load in range(known.shape[1])]
    runs = [f"R{r}" for r in range(len(readings))]
    labels = runs if repeats is None else [str(label) for label in repeats]
    if len(labels) != len(runs):
        raise ValueError(f"repeats has {len(labels)} labels and strain {len(runs)} runs")
    job: dict[str, Any] = {
        "title": "calibrate_rows",
        "units": "m-kg-s",
        "report_units": {"force": "N"},
        "load": [{"name": name} for name in names],
        "measured": {"strain": "strain.csv", "noise_microstrain": number("noise", noise)},
        "runs": {"file": "runs.csv", "units": {"force": "N"}},
        "calibration": {"model_uncertainty_rel": number("prior_rel", prior_rel)} if repeats is None else {"model_uncertainty_rel": number("prior_rel", prior_rel), "repeats": ["set"]},
    }
    files = {
        "strain.csv": _table(["run", *gauges], ([run, *row] for run, row in zip(runs, readings))),
        "runs.csv": _table(["run", "set", *names], ([run, label, *row] for run, label, row in zip(runs, labels, known))),
    }
    if prior is not None:
        rows = floats("prior", prior)
        if rows.shape != (len(gauges), len(names)):
            raise ValueError(f"prior is gauges x loads, {(len(gauges), len(names))}, not {rows.shape}")
        job["sensitivity"] = {"file": "S.csv", "per": {"force": "N"}}
        files["S.csv"] = _table(["gauge", *names], ([gauge, *row] for gauge, row in zip(gauges, rows)))
    outcome = calibrate(Job.from_dict(job, files=files), threads=threads)
    return CalibratedRows(outcome.S, outcome)


def _table(header: list[str], rows: Iterable[Sequence[Any]]) -> bytes:
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(header)
    for row in rows:
        out.writerow([v if isinstance(v, str) else "" if np.isnan(v) else repr(float(v)) for v in row])
    return text.getvalue().encode()
