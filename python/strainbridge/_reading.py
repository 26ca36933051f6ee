"""Decks and result files as arrays."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Literal, Sequence

import numpy as np
from numpy.typing import NDArray

from . import _strainbridge as _engine
from ._faults import Fault, Faults
from ._outcome import Record

Path = os.PathLike[str] | str


class Deck:
    """A Nastran deck, INCLUDE files and all."""

    _native: _engine._Deck
    #: The file.
    path: str

    def __init__(self, path: Path) -> None:
        self.path = os.fspath(path)
        self._native = _engine._Deck(path)

    @classmethod
    def read(cls, path: Path) -> Deck:
        """The deck in a file, or the mesh of an OP2. What is wrong with cards is in :attr:`faults`.

        Raises:
            Faults: the file can't be read at all.
        """
        return cls(path)

    @property
    def counts(self) -> dict[str, int]:
        """Number of cards by name."""
        return self._native.counts

    @property
    def faults(self) -> tuple[Fault, ...]:
        """Everything that is wrong with its cards, with file and line."""
        return tuple(Fault(*f) for f in self._native.faults)

    def cards(self, name: str) -> dict[str, NDArray[Any]]:
        """The cards of a name as columns, in the order of the file.

        ``GRID``: ``id``, ``cp``, ``cd``, ``x`` (n x 3, in cp). Elements (``CQUAD4``, ``CQUADR``, ``CQUAD8``, ``CTRIA3``, ``CTRIAR``,
        ``CTRIA6``, ``CHEXA``, ``CPENTA``, ``CTETRA``, ``CPYRAM``, ``CBAR``, ``CBEAM``, ``CROD``, ``CTUBE``): ``id``, ``pid``, ``grids`` (ids; 0: no
        grid there), shells ``theta`` (degrees; NaN: a coordinate system says it). ``CONM2``: ``id``, ``grid``, ``mass``, ``offset``.

        Raises:
            KeyError: cards of that name have no columns here.
        """
        found = self._native.cards(name.upper())
        if found is None:
            raise KeyError(f"cards `{name}` have no columns here; the deck has {', '.join(self.counts)}")
        return found

    def positions(self) -> dict[str, NDArray[Any]]:
        """``id`` (ascending) and ``x`` (n x 3, basic frame) of the grids."""
        return self._native.positions()

    def __repr__(self) -> str:
        return f"Deck({self.path!r}: {sum(self.counts.values())} cards)"


@dataclass(frozen=True)
class Strain:
    """Strain at places of shells, microstrain."""

    #: Element ids, a row each.
    element: NDArray[np.int64]
    #: Grid id of a corner, 0: the centre.
    grid: NDArray[np.int64]
    #: n x 3 or n x 6.
    values: NDArray[np.float64]
    #: What the columns of `values` are.
    columns: tuple[str, ...]


_LOCAL = ("exx", "eyy", "gxy")
_BASIC = ("Exx", "Eyy", "Ezz", "Exy", "Eyz", "Ezx")


class Results:
    """A result file of Nastran: OP2, punch or HDF5."""

    _native: _engine._Results
    #: The file.
    path: str
    #: Its deck, where one was given.
    deck: str | None

    def __init__(self, path: Path, deck: Path | None = None) -> None:
        self.path = os.fspath(path)
        self.deck = None if deck is None else os.fspath(deck)
        self._native = _engine._Results(path)

    @classmethod
    def read(cls, path: Path, deck: Path | None = None) -> Results:
        """The results in a file. Strain in the basic frame needs the mesh: the deck, or a file that holds it.

        Raises:
            Faults: the file can't be read, or is none of those.
        """
        return cls(path, deck)

    @property
    def tables(self) -> Sequence[Record]:
        """What the tables hold: ``table``, ``quantity``, ``analysis``, ``subcase``, ``mode``, ``step``, ``element_type``, ``titles``."""
        return [Record(t) for t in json.loads(self._native.tables())]

    def table(self, number: int) -> dict[str, NDArray[Any]]:
        """A table, as numbered in :attr:`tables`, as columns: ``entity`` (grid or element id), ``at`` (corner grid, 0: centre), ``layer``
        (shells: 1 for Z1, 2 for Z2), then its own, in the units of the file (strain is not micro)."""
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
        """Strain of the shells of a static subcase, microstrain, elements ascending.

        Args:
            subcase: its id.
            surface: ``top`` is Z2 of the element normal, ``bottom`` Z1.
            frame: ``element``: exx, eyy, gxy (engineering shear); ``basic``: Exx, Eyy, Ezz, Exy, Eyz, Ezx (tensor shear).
            corners: whether corners are listed beside the centre, where the file has them.

        Raises:
            Faults: no such subcase; no strain in it; no mesh for the basic frame.
        """
        if surface not in ("top", "bottom") or frame not in ("element", "basic"):
            raise ValueError(f"surface is top or bottom, and frame element or basic, not {surface!r} and {frame!r}")
        try:
            rows = _engine.shell_strain(self.deck or self.path, self.path, subcase)
        except Faults:
            if self.deck is not None or frame == "basic":
                raise
            # No mesh in the file: its own rows will do.
            rows = self._own_strain(subcase)
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
            remedy = "ask for STRAIN(FIBER) of shells in it, or name the deck: Results.read(path, deck=...)"
            raise Faults([(self.path, None, "subcase", f"no strain of shells in subcase {subcase}", remedy)])
        column = {name: np.concatenate([rows[name] for rows in found]) for name in ("entity", "at", "layer", *_LOCAL)}
        order = np.lexsort((column["layer"], np.arange(len(column["entity"])) // 2, column["entity"]))
        column = {name: values[order] for name, values in column.items()}
        return {
            "element": column["entity"],
            "grid": column["at"],
            "top": (column["layer"] == 2).astype(np.int64),
            "local": 1e6 * np.column_stack([column[name] for name in _LOCAL]),
        }

    def __repr__(self) -> str:
        return f"Results({self.path!r}: {len(self.tables)} tables)"
