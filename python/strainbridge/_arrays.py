"""Placement, recovery and counting on bare numpy arrays.

Arguments are anything that ``numpy.asarray`` accepts: lists, slices, float32, Fortran order, tables of pandas, polars and pyarrow. A float64 array
in C order is read without a copy. Masked values are missing values.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _strainbridge as _engine
from ._convert import check_order, count, floats, number
from ._convert import threads as _threads
from ._outcome import Finding, UnreliableWarning, warn_if_unreliable
from ._table import Table

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Placement:
    """Layout and its certificate."""

    #: Chosen rows of S, from 0, ascending.
    rows: NDArray[np.int64]
    #: Natural log of det(S'S) of the chosen rows.
    log_det: float
    #: Upper bound of the log det of all layouts that follow the rules.
    upper_bound: float
    #: exp((log_det - upper_bound) / loads), from 0 to 1. The layout reaches at least this share of the best possible one.
    efficiency_bound: float
    #: Whether the chosen rows are proved to be the best.
    proved: bool
    #: Condition number of the chosen rows.
    condition_number: float


@dataclass(frozen=True)
class RecoveredRows:
    """Recovered loads with their intervals."""

    #: runs x loads, or loads for a single run. NaN if the gauges with readings do not determine a load.
    loads: Floats
    #: loads x loads: covariance of a run with readings of every gauge.
    covariance: Floats
    #: Findings on the loads, the worst first.
    findings: Sequence[Finding]
    _half: Floats = field(repr=False)
    _others: NDArray[np.int64] = field(repr=False)
    _other_halves: Floats = field(repr=False)
    _s: Floats = field(repr=False)
    _strain: Floats = field(repr=False)
    _noise: Floats = field(repr=False)

    @property
    def half_width(self) -> Floats:
        """runs x loads: half width of the 95 % intervals."""
        if self.loads.ndim == 1:
            return self._other_halves[0] if len(self._others) else self._half
        out = np.broadcast_to(self._half, self.loads.shape)
        if len(self._others):
            out = out.copy()
            out[self._others] = self._other_halves
        return out

    @property
    def sigma(self) -> Floats:
        """runs x loads: one standard deviation."""
        factor: Floats = self._half / np.sqrt(np.diag(self.covariance))
        return self.half_width / factor

    @property
    def residuals(self) -> Floats:
        """runs x gauges: reading minus prediction, microstrain. NaN if a gauge has no reading."""
        return self._strain - self.loads @ self._s.T

    @property
    def chi2(self) -> Floats:
        """One number for each run: sum over gauges of (residual / noise) squared."""
        return np.asarray(np.nansum((self.residuals / self._noise) ** 2, axis=-1))

    @property
    def low(self) -> Floats:
        """runs x loads: lower ends of the 95 % intervals."""
        return self.loads - self.half_width

    @property
    def high(self) -> Floats:
        """runs x loads: upper ends of the 95 % intervals."""
        return self.loads + self.half_width

    def to_arrow(self, names: Sequence[str] | None = None) -> Table:
        """One row for each run, for any reader of the Arrow PyCapsule interface.

        The columns of each load are its value, ``<name>.low`` and ``<name>.high``.

        Args:
            names: names of the loads; default: ``f0``, ``f1`` ..
        """
        n = self.loads.shape[-1]
        labels = list(names) if names is not None else [f"f{i}" for i in range(n)]
        if len(labels) != n:
            raise ValueError(f"{len(labels)} names are given and there are {n} loads")
        if len(set(labels)) != n:
            raise ValueError("two loads have the same name; give each a name of its own")
        ends = [(end, np.atleast_2d(rows)) for end, rows in (("", self.loads), (".low", self.low), (".high", self.high))]
        return Table.from_columns({f"{name}{end}": values[:, i] for i, name in enumerate(labels) for end, values in ends})

    @property
    def is_reliable(self) -> bool:
        """Whether no finding is an error. A finding of severity ``error`` states that the loads are not reliable."""
        return all(f.severity != "error" for f in self.findings)

    def raise_if_unreliable(self) -> RecoveredRows:
        """Returns the loads themselves.

        Raises:
            UnreliableWarning: a finding is an error.
        """
        bad = [f.message for f in self.findings if f.severity == "error"]
        if bad:
            raise UnreliableWarning("; ".join(bad))
        return self

    def __repr__(self) -> str:
        runs, loads = np.atleast_2d(self.loads).shape
        bad = [f.message for f in self.findings if f.severity == "error"]
        verdict = f", NOT RELIABLE: {'; '.join(bad)}" if bad else ""
        return f"RecoveredRows({runs} runs x {loads} loads{verdict})"


@dataclass(frozen=True)
class Relaxation:
    """Placement with weights instead of gauges."""

    #: One weight for each row of S, 0 to 1. The sum is n.
    weights: Floats
    #: Natural log of det of the sum of w a a' over the rows a of S.
    log_det: float
    #: Upper bound of log det(S'S) for any n rows of S.
    upper_bound: float


def place_rows(
    S: ArrayLike,
    n: int,
    spacing: float | None = None,
    proof: bool = True,
    *,
    positions: ArrayLike | None = None,
    threads: int | None = None,
) -> Placement:
    """Returns the n rows of S with the largest det(S'S), with an upper bound for any other n rows.

    Args:
        S: candidates x loads; any unit. Rows have equal weight: divide each by the sd of its reading if these differ.
        n: number of rows, at least as many as loads.
        spacing: least distance between two chosen rows, in the unit of `positions`.
        proof: whether to try to prove by branch and bound that no layout is better. The bound does not need it.
        positions: candidates x 3, needed for a spacing.
        threads: number of threads; None or -1: all cores.

    Raises:
        Faults: S is empty or not finite, or no n of its rows separate the loads.
        TypeError: an argument has another type.
    """
    rows, log_scale = _scaled(floats("S", S))
    at = None if positions is None else floats("positions", positions)
    apart = None if spacing is None else number("spacing", spacing)
    found = _engine.place_rows(rows, count("n", n), apart, at, bool(proof), _threads(threads))
    del found["seconds"]
    plan = Placement(**found)
    if log_scale:
        plan = replace(plan, log_det=plan.log_det + log_scale, upper_bound=plan.upper_bound + log_scale)
    return plan


def relax(S: ArrayLike, n: int, tolerance: float = 1e-6, *, threads: int | None = None) -> Relaxation:
    """Returns weights of the rows of S with the largest log det(S' diag(w) S), and the upper bound for any n rows.

    Weights are from 0 to 1, and their sum is n. If the log det of another layout is d, its efficiency is at least exp((d - upper_bound) / loads) of
    the best possible. A good layout does not need rows with weight 0.

    Args:
        S: candidates x loads; any unit. Divide each row by the sd of its reading if these differ.
        n: number of gauges.
        tolerance: gap per load between weights and bound at the end. The bound is valid for any tolerance.
        threads: number of threads; None or -1: all cores.

    Raises:
        Faults: S is empty or not finite, or no n of its rows separate the loads.
        TypeError: an argument has another type.

    Reference:
        Boyd and Vandenberghe, Convex Optimization, 2004, section 7.5.2 (D-optimal design).
    """
    rows, log_scale = _scaled(floats("S", S))
    weights, log_det, bound = _engine.relax(rows, count("n", n), number("tolerance", tolerance), _threads(threads))
    return Relaxation(weights, log_det + log_scale, bound + log_scale)


def strain_along(
    strain: ArrayLike,
    direction: ArrayLike | None = None,
    *,
    angle_deg: ArrayLike | None = None,
    corners: ArrayLike | None = None,
) -> Floats:
    """Returns normal strain of shells along a direction, which is the reading of a gauge of zero length, in the unit of `strain`.

    Args:
        strain: places x 3, exx, eyy, gxy (engineering shear) in the element's frame, as an OP2 contains them; or places x 6, Exx, Eyy, Ezz, Exy,
            Eyz, Ezx (tensor shear) in the basic frame.
        direction: 3, or places x 3, of any length, in the frame of `strain`. With `corners`, in the basic frame and projected onto the element.
        angle_deg: instead of a direction: degrees from the element's x axis, right-handed about its normal; one number, or one for each place.
        corners: places x 4 x 3 or places x 3 x 3, the grids of quadrilaterals (CQUAD4) or triangles (CTRIA3) in the basic frame.

    Returns:
        One strain for each place. NaN if an element has no area or the direction is its normal.

    Raises:
        Faults: the shapes do not match.
    """
    values = floats("strain", strain)
    if (direction is None) == (angle_deg is None) or (angle_deg is not None and corners is not None):
        raise ValueError("give a direction, with corners or without, or an angle_deg")
    if angle_deg is not None:
        angle = np.deg2rad(floats("angle_deg", angle_deg).reshape(np.shape(angle_deg)))
        axis = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)
    else:
        axis = floats("direction", direction)
    if axis.ndim == 1 and values.ndim == 2:
        axis = np.broadcast_to(axis, (len(values), len(axis)))
    where = None if corners is None else floats("corners", corners)
    return _engine.strain_along(values, np.ascontiguousarray(axis), where)


def recover_rows(S: ArrayLike, strain: ArrayLike, noise: float | ArrayLike = 1.0, *, threads: int | None = None) -> RecoveredRows:
    """Recovers the loads f of every row of strain by least squares, strain = S f + noise, with 95 % intervals.

    Intervals follow from the stated noise. They are wider if the residuals exceed it, and a finding states this. A warning gives the number of
    rows with a missing reading. An error lists the loads that no row determines. If a finding is an error, an :class:`UnreliableWarning` is issued.

    Args:
        S: gauges x loads, microstrain per unit of load.
        strain: runs (or samples) x gauges, or one run as a vector; microstrain. NaN or masked if a gauge has no reading; the others are used.
        noise: sd of one reading, microstrain; one number, or one for each gauge.
        threads: number of threads; None or -1: all cores.

    Raises:
        Faults: the loads cannot be separated, or shapes do not match.
        TypeError: an argument has another type.
        ValueError: S and strain are tables with the same gauges in another order.
    """
    check_order(S, strain)
    s, readings = floats("S", S), floats("strain", strain)
    rows = readings.reshape(1, -1) if readings.ndim == 1 else readings
    sd = floats("noise", noise) if np.ndim(noise) else np.float64(number("noise", noise))
    weights = None
    common = float(sd) if np.ndim(sd) == 0 else np.nan
    if np.ndim(sd):
        if s.ndim != 2 or sd.shape != (len(s),) or not (np.isfinite(sd) & (sd > 0.0)).all():
            raise ValueError(f"noise has the shape {sd.shape}; give one positive number, or one for each row of S")
        # Rows divided by their noise, in units of the median noise.
        common = float(np.median(sd))
        weights = common / sd
    found = _engine.recover_rows(
        s if weights is None else s * weights[:, None],
        rows if weights is None or rows.shape[-1] != len(weights) else rows * weights,
        common,
        _threads(threads),
    )
    findings = tuple(Finding(*f) for f in found["findings"])
    loads = found["loads"][0] if readings.ndim == 1 else found["loads"]
    out = RecoveredRows(
        loads, found["covariance"], findings, found["half"], found["others"], found["other_halves"], s, readings, np.broadcast_to(sd, len(s))
    )
    warn_if_unreliable("recover_rows", findings)
    return out


def rainflow(signal: ArrayLike) -> NDArray[np.void]:
    """Returns the rainflow cycles of a signal, counted by ASTM E1049.

    Args:
        signal: samples; values that are not finite are skipped.

    Returns:
        A structured array with one row for each cycle: ``range``, ``mean``, ``count`` (1, or 0.5 for the residue at the end), ``first`` and
        ``second`` (the samples of its reversals, from 0).
    """
    rows = _engine.rainflow(floats("signal", signal))
    out = np.empty(len(rows), dtype=[("range", "f8"), ("mean", "f8"), ("count", "f8"), ("first", "i8"), ("second", "i8")])
    for i, name in enumerate(out.dtype.names or ()):
        out[name] = rows[:, i]
    return out


def _scaled(S: Floats) -> tuple[Floats, float]:
    """Returns S divided by a power of two if its determinant would overflow or vanish, and the change of ``log_det`` by this scale."""
    largest = float(np.max(np.abs(S), initial=0.0))
    if S.ndim != 2 or not np.isfinite(largest) or largest == 0.0 or 1e-50 < largest < 1e50:
        return S, 0.0
    exponent = int(np.floor(np.log2(largest)))
    return np.ldexp(S, -exponent), 2.0 * S.shape[1] * exponent * float(np.log(2.0))
