"""Decks and result files as arrays."""

from __future__ import annotations

import json
import os
import warnings
from dataclasses import dataclass
from pathlib import Path as _Path
from typing import Any, Iterable, Literal, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _strainbridge as _engine
from ._faults import Fault, Faults
from ._foreign import deck_bytes, is_deck, is_results, op2_bytes
from ._mesh import Mesh, of_native
from ._outcome import Record
from ._table import Table

Path = os.PathLike[str] | str


class Deck:
    """Nastran deck, including its INCLUDE files."""

    _native: _engine._Deck
    #: Path of the file. For a `BDF` of pyNastran, its name in memory.
    path: str

    def __init__(self, path: Path, files: Mapping[str, bytes] | None = None) -> None:
        self.path = os.fspath(path)
        self._files = dict(files or {})
        self._native = _engine._Deck(path, self._files)
        self._changed: dict[str, dict[str, NDArray[Any]]] = {}

    def __reduce__(self) -> Any:
        # A copy reads the file again.
        return (Deck, (self.path, self._files), {"_changed": self._changed})

    @classmethod
    def read(cls, path: Path | Any) -> Deck:
        """Reads the deck in a file, the mesh of an OP2, or a `BDF` of pyNastran. :attr:`faults` contains faults of cards.

        Raises:
            Faults: the file cannot be read.
        """
        if is_deck(path):
            return cls("pynastran.bdf", {"pynastran.bdf": deck_bytes(path)})
        return cls(path)

    @property
    def counts(self) -> dict[str, int]:
        """Number of cards by name."""
        return self._native.counts

    @property
    def faults(self) -> tuple[Fault, ...]:
        """All faults of the cards, with file and line."""
        return tuple(Fault(*f) for f in self._native.faults)

    def cards(self, name: str) -> dict[str, NDArray[Any]]:
        """Returns the cards with a name as columns, in the order of the file.

        Columns of ``GRID``, ``CONM2`` and shells may be changed in place, and rows may be removed or added (``deck.cards("GRID")["x"] = ..``).
        :meth:`write` writes the changes.

        ``GRID``: ``id``, ``cp``, ``cd``, ``x`` (n x 3, in cp). Elements (``CQUAD4``, ``CQUADR``, ``CQUAD8``, ``CTRIA3``, ``CTRIAR``,
        ``CTRIA6``, ``CHEXA``, ``CPENTA``, ``CTETRA``, ``CPYRAM``, ``CBAR``, ``CBEAM``, ``CROD``, ``CTUBE``): ``id``, ``pid``, ``grids`` (ids; 0: no
        grid there), and for shells ``theta`` (degrees; NaN: a coordinate system states it). ``CONM2``: ``id``, ``grid``, ``mass``, ``offset``.

        Raises:
            KeyError: cards with that name have no columns here.
        """
        name = name.upper()
        if name not in self._changed:
            found = self._native.cards(name)
            if found is None:
                raise KeyError(f"cards `{name}` have no columns here; the deck has {', '.join(self.counts)}")
            self._changed[name] = found
        return self._changed[name]

    def write(self, path: Path) -> list[str]:
        """Writes the deck with the present content of :meth:`cards`. Lines of other cards are unchanged.

        Cards whose id is missing are removed, and cards with a new id are added. Changed INCLUDE files are written next to the deck.

        Returns:
            The files written.

        Raises:
            Faults: columns are not valid cards, or cards cannot be changed.
        """
        to = _Path(path)
        changed = {}
        for name, columns in self._changed.items():
            before = self._native.cards(name)
            assert before is not None
            if any(not np.array_equal(b, columns.get(c, np.empty(0)), equal_nan=b.dtype.kind == "f") for c, b in before.items()):
                flat = {c: np.ascontiguousarray(v, dtype=np.float64).ravel() for c, v in columns.items()}
                changed[name] = flat
        written = []
        for i, (name, data) in enumerate(self._native.edit_files(to.parent, to.stem, changed)):
            file = to if i == 0 else to.parent / name
            file.write_bytes(bytes(data))
            written.append(os.fspath(file))
        return written

    def mesh(self) -> Mesh:
        """Returns points and cells for pyvista and meshio. ``grid`` and ``element`` are ids.

        Only corners are included, and changes of :meth:`cards` are not.
        """
        return of_native(self._native.mesh())

    def positions(self) -> dict[str, NDArray[Any]]:
        """Returns ``id`` (ascending) and ``x`` (n x 3, basic frame) of the grids."""
        return self._native.positions()

    def __repr__(self) -> str:
        return f"Deck({self.path!r}: {sum(self.counts.values())} cards)"


@dataclass(frozen=True)
class Strain:
    """Strain at places of shells, microstrain."""

    #: Element ids, one for each row.
    element: NDArray[np.int64]
    #: Grid id of a corner. 0 is the centre.
    grid: NDArray[np.int64]
    #: n x 3 or n x 6.
    values: NDArray[np.float64]
    #: Content of the columns of `values`.
    columns: tuple[str, ...]

    def to_arrow(self) -> Table:
        """One row for each place, for any reader of the Arrow PyCapsule interface."""
        values = {name: self.values[:, i] for i, name in enumerate(self.columns)}
        return Table.from_columns({"element": self.element, "grid": self.grid, **values})


_LOCAL = ("exx", "eyy", "gxy")
_BASIC = ("Exx", "Eyy", "Ezz", "Exy", "Eyz", "Ezx")


class Results:
    """Result file of Nastran: OP2, punch or HDF5."""

    _native: _engine._Results
    #: Path of the file.
    path: str
    #: Path of its deck, if one was given.
    deck: str | None

    def __init__(self, path: Path, deck: Path | None = None, files: Mapping[str, bytes] | None = None) -> None:
        self.path = os.fspath(path)
        self.deck = None if deck is None else os.fspath(deck)
        self._files = dict(files or {})
        self._native = _engine._Results(path, self._files)

    @classmethod
    def read(cls, path: Path | Any, deck: Path | Any | None = None) -> Results:
        """Reads the results in a file, or an `OP2` of pyNastran.

        Strain in the basic frame needs the mesh. Strain from stress, plies or curvature needs materials and thicknesses. They come from the deck (or
        a `BDF` of pyNastran), or from a file that contains it. An `OP2Geom` contains its deck. Of an `OP2`, the static subcases are read:
        displacements, strain and stress of shells, plies, bars, beams, rods and solids.

        Raises:
            Faults: the file cannot be read, or has another format.
            ValueError: the `OP2` contains none of these.
        """
        files = {}
        if is_results(path):
            if deck is None and is_deck(path):
                # The results were read with their geometry and contain the deck.
                deck = path
            files["pynastran.op2"], path = op2_bytes(path), "pynastran.op2"
        if is_deck(deck):
            files["pynastran.bdf"], deck = deck_bytes(deck), "pynastran.bdf"
        return cls(path, deck, files)

    @property
    def tables(self) -> Sequence[Record]:
        """Contents of the tables: ``table``, ``quantity``, ``analysis``, ``subcase``, ``mode``, ``step``, ``element_type``, ``titles``."""
        return [Record(t) for t in json.loads(self._native.tables())]

    def table(self, number: int) -> dict[str, NDArray[Any]]:
        """Returns a table, as numbered in :attr:`tables`, as columns.

        The columns are ``entity`` (grid or element id), ``at`` (corner grid, 0: centre), ``layer`` (shells: 1 for Z1, 2 for Z2), and those of the
        table in the units of the file (strain is not in microstrain)."""
        if not 0 <= number < len(self.tables):
            raise IndexError(f"no table {number}: there are {len(self.tables)}")
        return self._native.rows(number)

    def strain(
        self,
        subcase: int = 1,
        surface: Literal["top", "bottom"] = "top",
        frame: Literal["element", "basic"] = "element",
        corners: bool = False,
    ) -> Strain:
        """Returns strain of the shells of a static subcase, microstrain, by ascending element.

        Args:
            subcase: id of the subcase.
            surface: ``top`` is Z2 of the element normal, ``bottom`` Z1.
            frame: ``element``: exx, eyy, gxy (engineering shear); ``basic``: Exx, Eyy, Ezz, Exy, Eyz, Ezx (tensor shear).
            corners: whether corners are listed in addition to the centre, if the file has them.

        Raises:
            Faults: the subcase does not exist or has no strain, or there is no mesh for the basic frame.
        """
        if surface not in ("top", "bottom") or frame not in ("element", "basic"):
            raise ValueError(f"surface is top or bottom, and frame element or basic, not {surface!r} and {frame!r}")
        try:
            rows = _engine.shell_strain(self.deck or self.path, self.path, subcase, self._files)
        except Faults:
            if self.deck is not None or frame == "basic":
                raise
            # The file has no mesh, so its rows are used as they are.
            rows = self._own_strain(subcase)
        if not len(rows["element"]):
            raise self._no_strain(subcase)
        self._warn_of_others(subcase, rows["element"])
        keep = rows["top"] == (surface == "top")
        if not corners:
            keep &= rows["grid"] == 0
        values, columns = (rows["local"], _LOCAL) if frame == "element" else (rows["basic"], _BASIC)
        return Strain(rows["element"][keep], rows["grid"][keep], values[keep], columns)

    def _own_strain(self, subcase: int) -> dict[str, NDArray[Any]]:
        found = []
        for number, t in enumerate(self.tables):
            if t.quantity == "strain" and t.analysis == "statics" and t.subcase == subcase and t.fibre:
                rows = self.table(number)
                if "gxy" in rows:
                    found.append(rows)
        if not found:
            raise self._no_strain(subcase)
        column = {name: np.concatenate([rows[name] for rows in found]) for name in ("entity", "at", "layer", *_LOCAL)}
        order = np.lexsort((column["layer"], np.arange(len(column["entity"])) // 2, column["entity"]))
        column = {name: values[order] for name, values in column.items()}
        return {
            "element": column["entity"],
            "grid": column["at"],
            "top": (column["layer"] == 2).astype(np.int64),
            "local": 1e6 * np.column_stack([column[name] for name in _LOCAL]),
        }

    def _warn_of_others(self, subcase: int, found: NDArray[Any]) -> None:
        """Warns of shells that have stress but no strain in a subcase."""
        of = [(i, t) for i, t in enumerate(self.tables) if t.analysis == "statics" and t.subcase == subcase and _is_shell(t)]
        if any(t.quantity == "strain" for _, t in of):
            return
        stressed = [self.table(i)["entity"] for i, t in of if t.quantity == "stress"]
        others = np.setdiff1d(np.concatenate(stressed), found) if stressed else np.empty(0)
        if len(others):
            said = f"{self.path}: {len(others)} shells have stress in subcase {subcase} and no strain, such as {others[0]}: "
            why = "they are laminates, or the deck does not have them. Ask for STRAIN(FIBER) of shells in Nastran"
            warnings.warn(said + why, UserWarning, stacklevel=3)

    def _no_strain(self, subcase: int) -> Faults:
        """Returns the fault for a subcase without strain of shells: other subcases that have it, or other results."""
        shells = [t for t in self.tables if t.analysis == "statics" and _is_shell(t)]
        here = {t.quantity for t in shells if t.subcase == subcase}
        others = sorted({t.subcase for t in shells} - {subcase})
        if here and self.deck is None:
            # For stress, plies or curvature, the deck has thickness and material.
            remedy = f"name the deck, Results.read(path, deck=...): strain is computed from {', '.join(sorted(here))}"
        elif others:
            remedy = f"take one of the subcases {', '.join(map(str, others))}, or ask for STRAIN(FIBER) of shells in it"
        else:
            remedy = "ask for STRAIN(FIBER) of shells in Nastran"
        return Faults([(self.path, None, "subcase", f"no strain of shells in subcase {subcase}", remedy)])

    def __repr__(self) -> str:
        return f"Results({self.path!r}: {len(self.tables)} tables)"


def _is_shell(table: Record) -> bool:
    return str(table.element_type).startswith(("CQUAD", "CTRIA"))


def write_op2(path: Path, tables: Iterable[tuple[Mapping[str, Any], Mapping[str, ArrayLike]]]) -> None:
    """Writes an OP2 for readers of Nastran files: displacements, strain, stress, forces.

    Args:
        path: path of the file.
        tables: contents and columns of each table, as in :attr:`Results.tables` and :meth:`Results.table`: ``{"quantity": "strain",
            "element_type": "CQUAD4", "subcase": 1}`` and ``{"entity": ids, "at": .., "layer": .., "exx": .., ..}``. Strain of shells has two
            rows for each element, ``layer`` 1 (Z1) and 2 (Z2), and no unit (it is not in microstrain). ``fiber``, ``angle``, ``emax``, ``emin``
            and ``vm`` are optional and NaN by default. Other columns are required. Give all subcases of a kind together.

    Raises:
        Faults: a column belongs to no table, or rows do not match the element type.
    """
    made = []
    for what, columns in tables:
        given = {name: np.ascontiguousarray(c) for name, c in columns.items()}
        ids = {name: given.pop(name, None) for name in ("entity", "at", "layer")}
        if ids["entity"] is None:
            raise ValueError("a table has a column `entity`: ids of grids or elements")
        n = len(ids["entity"])
        if {"exx", "eyy", "gxy"} <= given.keys():
            for name in ("fiber", "angle", "emax", "emin", "vm"):
                given.setdefault(name, np.full(n, np.nan))
        titles = [str(t) for t in what.get("titles") or ("", "", "")]
        made.append({
            "quantity": what["quantity"],
            "analysis": what.get("analysis", "statics"),
            "subcase": int(what.get("subcase", 1)),
            "mode": int(what.get("mode", 0)),
            "step": float(what.get("step", 0.0)),
            "element_type": what.get("element_type"),
            "fibre": bool(what.get("fibre", True)),
            "titles": titles,
            **{name: np.ascontiguousarray(np.zeros(n) if v is None else v, dtype=np.int64) for name, v in ids.items()},
            "columns": {name: np.ascontiguousarray(c, dtype=np.float64) for name, c in given.items()},
        })
    _Path(path).write_bytes(bytes(_engine.op2_bytes(made)))
