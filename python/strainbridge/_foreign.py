"""Decks and results that pyNastran has read or made: files in memory."""

from __future__ import annotations

import io
from typing import Any, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from . import _strainbridge as _engine

#: Element types of Nastran by number.
_TYPES = {33: "CQUAD4", 64: "CQUAD8", 70: "CTRIAR", 74: "CTRIA3", 75: "CTRIA6", 82: "CQUADR", 144: "CQUAD4-corner", 227: "CTRIAR-centre", 228: "CQUADR-centre"}
_SHELL = ("fiber", "exx", "eyy", "gxy", "angle", "emax", "emin", "vm")
_NODAL = ("t1", "t2", "t3", "r1", "r2", "r3")
_RESULTS = ("cquad4_strain", "cquad8_strain", "cquadr_strain", "ctria3_strain", "ctria6_strain", "ctriar_strain")


def is_deck(what: object) -> bool:
    """Whether it is a `BDF` of pyNastran, or answers like one."""
    return callable(getattr(what, "write_bdf", None))


def is_results(what: object) -> bool:
    """Whether it is an `OP2` of pyNastran, or answers like one."""
    return callable(getattr(what, "read_op2", None)) or hasattr(what, "op2_results")


def deck_bytes(bdf: Any) -> bytes:
    """The text of a `BDF`."""
    text = io.StringIO()
    bdf.write_bdf(text, size=16, enddata=True, close=False)
    return text.getvalue().encode()


def op2_bytes(op2: Any) -> bytes:
    """Displacements and strain of shells of an `OP2`, as a file of our own.

    Raises:
        ValueError: it holds neither.
    """
    tables = [*_nodal(op2), *_shells(op2)]
    if not tables:
        raise ValueError("the OP2 holds no displacements and no strain of shells: ask for STRAIN(FIBER) of shells in Nastran")
    return bytes(_engine.op2_bytes(tables))


def _static(
    table: Any, subcase: Any, quantity: str, columns: Mapping[str, NDArray[Any]], ids: NDArray[Any], at: NDArray[Any], layer: NDArray[Any]
) -> dict[str, Any]:
    return {
        "quantity": quantity,
        "analysis": "statics",
        "subcase": int(subcase[0] if isinstance(subcase, tuple) else subcase),
        "mode": 0,
        "step": 0.0,
        "element_type": None,
        "fibre": True,
        "titles": [str(getattr(table, name, "") or "").strip() for name in ("title", "subtitle", "label")],
        "entity": np.ascontiguousarray(ids, dtype=np.int64),
        "at": np.ascontiguousarray(at, dtype=np.int64),
        "layer": np.ascontiguousarray(layer, dtype=np.int64),
        "columns": {name: np.ascontiguousarray(c, dtype=np.float64) for name, c in columns.items()},
    }


def _is_static(table: Any) -> bool:
    return getattr(table, "analysis_code", 1) == 1 and not np.iscomplexobj(table.data)


def _nodal(op2: Any) -> Iterator[dict[str, Any]]:
    for subcase, table in getattr(op2, "displacements", {}).items():
        if _is_static(table):
            columns = {name: table.data[0, :, i] for i, name in enumerate(_NODAL)}
            ids, kind = table.node_gridtype[:, 0], table.node_gridtype[:, 1]
            yield _static(table, subcase, "displacement", columns, ids, kind, np.zeros(len(ids)))


def _shells(op2: Any) -> Iterator[dict[str, Any]]:
    holder = getattr(getattr(op2, "op2_results", None), "strain", None)
    for name in _RESULTS:
        # Where pyNastran kept them before 1.4.
        tables = getattr(op2 if holder is None else holder, name, None) or {}
        for subcase, table in tables.items():
            kind = _TYPES.get(int(table.element_type))
            if kind is None or not _is_static(table):
                continue
            ids, at = table.element_node[:, 0], table.element_node[:, 1]
            # Two fibres at every place, Z1 first; the centre has no grid.
            layer = 1 + np.arange(len(ids)) % 2
            columns = {column: table.data[0, :, i] for i, column in enumerate(_SHELL)}
            made = _static(table, subcase, "strain", columns, ids, at, layer)
            yield {**made, "element_type": kind, "fibre": bool(table.is_fiber_distance)}
