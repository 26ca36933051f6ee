"""Placement, recovery and counting on bare numpy arrays.

Arrays are numpy arrays of float64 with their rows one after the other in memory (C order). They are read where they lie, without a copy; what
is not so raises, with the call that makes it so.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _strainbridge as _engine
from ._outcome import Finding
from ._table import Table

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Placement:
    """A layout and its certificate."""

    #: Rows of S that were chosen, from 0, ascending.
    rows: NDArray[np.int64]
    #: Natural log of det(S'S) of those rows.
    log_det: float
    #: No rows that keep the rules have a larger one.
    upper_bound: float
    #: exp((log_det - upper_bound) / loads), 0 to 1: certified to be at least this share of the best possible.
    efficiency_bound: float
    #: Whether these rows are proved to be the best.
    proved: bool
    #: Condition number of those rows.
    condition_number: float


@dataclass(frozen=True)
class RecoveredRows:
    """Loads with their intervals."""

    #: runs x loads; NaN where the gauges that read don't tell a load.
    loads: Floats
    #: loads x loads: covariance of a run in which every gauge reads.
    covariance: Floats
    #: What is to be known of them, the worst first.
    findings: Sequence[Finding]
    _half: Floats = field(repr=False)
    _others: NDArray[np.int64] = field(repr=False)
    _other_halves: Floats = field(repr=False)

    @property
    def half_width(self) -> Floats:
        """runs x loads: half width of the 95 % intervals."""
        out = np.broadcast_to(self._half, self.loads.shape)
        if len(self._others):
            out = out.copy()
            out[self._others] = self._other_halves
        return out

    @property
    def low(self) -> Floats:
        """runs x loads: lower ends of the 95 % intervals."""
        return self.loads - self.half_width

    @property
    def high(self) -> Floats:
        """runs x loads: upper ends of the 95 % intervals."""
        return self.loads + self.half_width

    def to_arrow(self, names: Sequence[str] | None = None) -> Table:
        """A row a run, for any reader of the Arrow PyCapsule interface: of each load its value, ``<name>.low`` and ``<name>.high``.

        Args:
            names: of the loads; ``f0``, ``f1`` .. where left out.
        """
        labels = list(names) if names is not None else [f"f{i}" for i in range(self.loads.shape[1])]
        if len(labels) != self.loads.shape[1]:
            raise ValueError(f"{len(labels)} names are given and there are {self.loads.shape[1]} loads")
        ends = (("", self.loads), (".low", self.low), (".high", self.high))
        return Table.from_columns({f"{name}{end}": values[:, i] for i, name in enumerate(labels) for end, values in ends})

    @property
    def is_reliable(self) -> bool:
        """Whether no finding says that the loads can't be relied on."""
        return all(f.severity != "error" for f in self.findings)

    def __repr__(self) -> str:
        runs, loads = self.loads.shape
        bad = [f.message for f in self.findings if f.severity == "error"]
        verdict = f", CAN'T BE RELIED ON: {'; '.join(bad)}" if bad else ""
        return f"RecoveredRows({runs} runs x {loads} loads{verdict})"


@dataclass(frozen=True)
class Relaxation:
    """A placement with weights in place of gauges."""

    #: A weight a row of S, 0 to 1; they sum to n.
    weights: Floats
    #: Natural log of det of the sum of w a a' over the rows a of S.
    log_det: float
    #: No n rows of S have a larger log det(S'S).
    upper_bound: float


def place_rows(
    S: Floats,
    n: int,
    spacing: float | None = None,
    proof: bool = True,
    *,
    positions: Floats | None = None,
    threads: int | None = None,
) -> Placement:
    """The n rows of S with the largest det(S'S), with a bound that no other n rows can pass.

    Args:
        S: candidates x loads, float64 in C order; any unit. Rows are weighed alike: divide each by the sd of its reading where these differ.
        n: how many rows, at least as many as loads.
        spacing: least distance between two rows chosen, in the unit of `positions`.
        proof: whether to try to prove by branch and bound that no layout is better. The bound stands without.
        positions: candidates x 3, needed for a spacing.
        threads: how many; all of the machine where None.

    Raises:
        Faults: S is empty, not finite or not in C order, or no n of its rows separate the loads.
        TypeError: not a numpy array of float64.
    """
    found = _engine.place_rows(S, _count(n), spacing, positions, proof, threads)
    del found["seconds"]
    return Placement(**found)


def relax(S: Floats, n: int, tolerance: float = 1e-6, *, threads: int | None = None) -> Relaxation:
    """Weights of the rows of S, 0 to 1 and n in sum, with the largest log det(S' diag(w) S), and the bound that no n rows can pass.

    A layout of your own with log det d has at least the share exp((d - upper_bound) / loads) of the best possible efficiency; rows of
    weight 0 are those that a good layout does without.

    Args:
        S: candidates x loads, float64 in C order; any unit. Divide each row by the sd of its reading where these differ.
        n: how many gauges.
        tolerance: gap per load to which weights and bound are brought together; the bound holds at any.
        threads: how many; all of the machine where None.

    Raises:
        Faults: S is empty, not finite or not in C order, or no n of its rows separate the loads.
        TypeError: not a numpy array of float64.

    Reference:
        Boyd and Vandenberghe, Convex Optimization, 2004, section 7.5.2 (D-optimal design).
    """
    return Relaxation(*_engine.relax(S, _count(n), float(tolerance), threads))


def strain_along(
    strain: ArrayLike,
    direction: ArrayLike | None = None,
    *,
    angle_deg: ArrayLike | None = None,
    corners: ArrayLike | None = None,
) -> Floats:
    """Normal strain of shells along a direction: what a gauge of zero length glued that way reads. The unit is that of `strain`.

    Args:
        strain: places x 3, exx, eyy, gxy (engineering shear) in the element's frame, as an OP2 holds them; or places x 6, Exx, Eyy, Ezz, Exy,
            Eyz, Ezx (tensor shear) in the basic frame.
        direction: 3, or places x 3, of any length. In the frame of `strain`; with `corners` in the basic frame, and laid onto the element.
        angle_deg: instead of a direction: degrees from the element's x axis, right-handed about its normal; one, or one a place.
        corners: places x 4 x 3 or places x 3 x 3, the grids of quadrilaterals (CQUAD4) or triangles (CTRIA3) in the basic frame.

    Returns:
        A strain a place; NaN where an element has no area or the direction is its normal.

    Raises:
        Faults: shapes that don't fit.
    """
    values = np.ascontiguousarray(strain, dtype=np.float64)
    if (direction is None) == (angle_deg is None) or (angle_deg is not None and corners is not None):
        raise ValueError("give a direction, with corners or without, or an angle_deg")
    if angle_deg is not None:
        angle = np.deg2rad(np.asarray(angle_deg, dtype=np.float64))
        axis = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)
    else:
        axis = np.asarray(direction, dtype=np.float64)
    if axis.ndim == 1 and values.ndim == 2:
        axis = np.broadcast_to(axis, (len(values), len(axis)))
    where = None if corners is None else np.ascontiguousarray(corners, dtype=np.float64)
    return _engine.strain_along(values, np.ascontiguousarray(axis), where)


def recover_rows(S: Floats, strain: Floats, noise: float = 1.0, *, threads: int | None = None) -> RecoveredRows:
    """Loads f of every row of strain by least squares, strain = S f + noise, with 95 % intervals.

    Intervals are those of the noise stated, and wider where the residuals are larger than it explains; a finding says so. A warning
    says in how many rows a gauge gives nothing, an error which loads no row tells.

    Args:
        S: gauges x loads, float64 in C order, microstrain per unit of load.
        strain: runs (or samples) x gauges, float64 in C order, microstrain; NaN where a gauge gave nothing: the others are taken.
        noise: sd of one reading, microstrain.
        threads: how many; all of the machine where None.

    Raises:
        Faults: the loads can't be told apart, or an array is not as it has to be.
        TypeError: not a numpy array of float64.
    """
    found = _engine.recover_rows(S, strain, float(noise), threads)
    findings = tuple(Finding(*f) for f in found["findings"])
    return RecoveredRows(found["loads"], found["covariance"], findings, found["half"], found["others"], found["other_halves"])


def rainflow(signal: Floats) -> NDArray[np.void]:
    """Rainflow cycles of a signal, as ASTM E1049 counts them.

    Args:
        signal: samples, float64 in C order; values that are not finite are passed over.

    Returns:
        A structured array with a row a cycle: ``range``, ``mean``, ``count`` (1, or 0.5 for what is left over at the end), ``first`` and
        ``second`` (the samples of its reversals, from 0).
    """
    rows = _engine.rainflow(signal)
    out = np.empty(len(rows), dtype=[("range", "f8"), ("mean", "f8"), ("count", "f8"), ("first", "i8"), ("second", "i8")])
    for i, name in enumerate(out.dtype.names or ()):
        out[name] = rows[:, i]
    return out


def _count(n: int) -> int:
    if n < 1:
        raise ValueError(f"n is {n}: ask for 1 or more")
    return int(n)
