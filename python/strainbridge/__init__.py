"""Turns a structure into its own load cell: strain gauges and a finite element model in, wheel loads with intervals out.

Bare arrays::

    import strainbridge as sb
    plan = sb.place_rows(S, 8)                 # S: candidates x loads; plan.rows, plan.efficiency_bound
    out = sb.recover_rows(S[plan.rows], strain)  # strain: runs x gauges; out.loads, out.low, out.high

Jobs, as the command takes them::

    job = sb.Job.read("truck.toml")
    job.placement.gauges = 12
    plan = sb.place(job)
    plan.gauges, plan.log_det, plan.findings
    plan.save("truck.out")

Bad input raises :class:`Faults`, which contains every fault with file and line. An outcome carries findings. If one has the severity ``error``, the
answer is not reliable: the call issues an :class:`UnreliableWarning`, and ``outcome.raise_if_unreliable()`` raises it.
"""

from importlib.metadata import PackageNotFoundError as _NotInstalled
from importlib.metadata import version as _version

from . import fleet
from ._arrays import Placement, RecoveredRows, Relaxation, place_rows, rainflow, recover_rows, relax, strain_along
from ._calibrate import CalibratedRows, calibrate_rows
from ._commands import (
    ballast,
    calibrate,
    cases,
    check,
    clean,
    explain,
    identify,
    init,
    modes,
    payload,
    place,
    reconcile,
    recover,
    respond,
    sensitivity,
    simulate,
    solve,
    strains,
    study,
    verify,
)
from ._faults import Fault, Faults
from ._job import Job
from ._mesh import Mesh
from ._model import Model
from ._outcome import Finding, Outcome, Record, UnreliableWarning
from ._plan import Plan
from ._reading import Deck, Results, Strain, write_op2
from ._table import Table

try:
    __version__ = _version("strainbridge")
except _NotInstalled:  # used from its sources
    __version__ = "unknown"

__all__ = [
    "CalibratedRows",
    "Deck",
    "Fault",
    "Faults",
    "Finding",
    "Job",
    "Mesh",
    "Model",
    "Outcome",
    "Placement",
    "Plan",
    "Record",
    "RecoveredRows",
    "Relaxation",
    "Results",
    "Strain",
    "Table",
    "UnreliableWarning",
    "ballast",
    "calibrate",
    "calibrate_rows",
    "cases",
    "check",
    "clean",
    "explain",
    "fleet",
    "identify",
    "init",
    "modes",
    "payload",
    "place",
    "place_rows",
    "rainflow",
    "reconcile",
    "recover",
    "recover_rows",
    "relax",
    "respond",
    "sensitivity",
    "simulate",
    "solve",
    "strain_along",
    "strains",
    "study",
    "verify",
    "write_op2",
]
