"""Decks and results that pyNastran has read or created, as files in memory."""

from __future__ import annotations

import io
from typing import Any, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from . import _strainbridge as _engine

_NODAL = ("t1", "t2", "t3", "r1", "r2", "r3")
_SHELL = {
    "strain": ("fiber", "exx", "eyy", "gxy", "angle", "emax", "emin", "vm"),
    "stress": ("fiber", "oxx", "oyy", "txy", "angle", "omax", "omin", "vm"),
}
_PLY = ("s11", "s22", "s12", "s1z", "s2z", "angle", "smax", "smin", "vm")
_BAR = ("s1a", "s2a", "s3a", "s4a", "axial", "smaxa", "smina", "mst", "s1b", "s2b", "s3b", "s4b", "smaxb", "sminb", "msc")
_BAR_STATION = ("x_xb", "s1", "s2", "s3", "s4", "axial", "smax", "smin", "ms")
_BEAM = ("sxc", "sxd", "sxe", "sxf", "smax", "smin", "mst", "msc")
_ROD = ("axial", "msa", "torsion", "mst")
_SOLID = ("xx", "yy", "zz", "xy", "yz", "zx", "max", "mid", "min", "vm")

#: Element types of Nastran by number.
_SHELLS = {33: "CQUAD4", 64: "CQUAD8", 70: "CTRIAR", 74: "CTRIA3", 75: "CTRIA6", 82: "CQUADR", 144: "CQUAD4-corner", 227: "CTRIAR-centre", 228: "CQUADR-centre"}
_PLIES = {95: "CQUAD4-composite", 96: "CQUAD8-composite", 97: "CTRIA3-composite", 98: "CTRIA6-composite", 232: "CQUADR-composite", 233: "CTRIAR-composite"}
_RODS = {1: "CROD", 3: "CTUBE", 10: "CONROD"}
_SOLIDS = {39: "CTETRA", 67: "CHEXA", 68: "CPENTA", 255: "CPYRAM"}

#: Tables of elements in pyNastran, without the quantity.
_TABLES = (
    *(f"{shell}_{{}}" for shell in ("cquad4", "cquad8", "cquadr", "ctria3", "ctria6", "ctriar")),
    *(f"{shell}_composite_{{}}" for shell in ("cquad4", "cquad8", "cquadr", "ctria3", "ctria6", "ctriar")),
    *(f"{line}_{{}}" for line in ("cbar", "cbeam", "crod", "ctube", "conrod")),
    "cbar_{}_10nodes",
    *(f"{solid}_{{}}" for solid in ("ctetra", "chexa", "cpenta", "cpyram")),
)


def is_deck(what: object) -> bool:
    """Returns whether it is a `BDF` of pyNastran, or has the same methods."""
    return callable(getattr(what, "write_bdf", None))


def is_results(what: object) -> bool:
    """Returns whether it is an `OP2` of pyNastran, or has the same methods."""
    return callable(getattr(what, "read_op2", None)) or hasattr(what, "op2_results")


def deck_bytes(bdf: Any) -> bytes:
    """Returns the text of a `BDF`."""
    text = io.StringIO()
    bdf.write_bdf(text, size=16, enddata=True, close=False)
    return text.getvalue().encode()


def op2_bytes(op2: Any) -> bytes:
    """Returns displacements, strain and stress of the static subcases of an `OP2` as a new OP2 file.

    Raises:
        ValueError: the `OP2` contains none of them.
    """
    tables = [*_nodal(op2), *_elements(op2, "strain"), *_elements(op2, "stress")]
    if not tables:
        raise ValueError("the OP2 contains no displacements, strain or stress of a static subcase: ask for STRAIN(FIBER) of shells in Nastran")
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


def _elements(op2: Any, quantity: str) -> Iterator[dict[str, Any]]:
    holder = getattr(getattr(op2, "op2_results", None), quantity, None)
    for name in _TABLES:
        # Location of the tables in pyNastran before 1.4.
        tables = getattr(op2 if holder is None else holder, name.format(quantity), None) or {}
        for subcase, table in tables.items():
            made = _rows(table, quantity) if _is_static(table) else None
            if made is None:
                continue
            word, kind, names, ids, at, layer, fibre = made
            values = table.data[0]
            if kind == "CBEAM":
                values = np.column_stack([table.xxb, values])
            if values.shape[1] != len(names):
                continue
            columns = {column: values[:, i] for i, column in enumerate(names)}
            yield {**_static(table, subcase, word, columns, ids, at, layer), "element_type": kind, "fibre": fibre}


#: Quantity, element type, columns, elements, places, layers, whether fibres are distances.
_Made = tuple[str, str, tuple[str, ...], NDArray[Any], NDArray[Any], NDArray[Any], bool]


def _rows(table: Any, quantity: str) -> _Made | None:
    """Returns the content of the rows of a table, or None for element types that are not needed here."""
    number = int(table.element_type)
    if number in _SHELLS:
        ids, at = table.element_node[:, 0], table.element_node[:, 1]
        # Two fibres at every place, Z1 first. The centre has no grid.
        return quantity, _SHELLS[number], _SHELL[quantity], ids, at, 1 + np.arange(len(ids)) % 2, bool(table.is_fiber_distance)
    if number in _PLIES:
        ids, ply = table.element_layer[:, 0], table.element_layer[:, 1]
        return f"ply_{quantity}", _PLIES[number], _PLY, ids, np.zeros(len(ids)), ply, False
    if number in _SOLIDS:
        ids, at = table.element_node[:, 0], table.element_node[:, 1]
        return quantity, _SOLIDS[number], _SOLID, ids, at, np.zeros(len(ids)), False
    if number == 2:
        ids, at = table.element_node[:, 0], table.element_node[:, 1]
        return quantity, "CBEAM", ("x_xb", *_BEAM), ids, at, np.zeros(len(ids)), False
    if number in (34, 100) or number in _RODS:
        ids = np.asarray(table.element)
        at = np.zeros(len(ids))
        if number == 100:
            # Stations of a bar are numbered from 1.
            starts = np.r_[0, np.flatnonzero(np.diff(ids)) + 1]
            at = np.arange(len(ids)) - np.repeat(starts, np.diff(np.r_[starts, len(ids)])) + 1
            return quantity, "CBAR-stations", _BAR_STATION, ids, at, np.zeros(len(ids)), False
        return (quantity, "CBAR", _BAR, ids, at, at, False) if number == 34 else (quantity, _RODS[number], _ROD, ids, at, at, False)
    return None
