"""A model from arrays of points, cells and properties."""

from __future__ import annotations

import os
from typing import Any, Iterable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from . import _strainbridge as _engine
from ._commands import solve
from ._job import Job, in_folder
from ._mesh import Mesh, of_native
from ._outcome import Outcome
from ._toml import plain

#: Cards of cells, by the names that meshio, gmsh and pyvista use.
_CARDS = {"quad": "CQUAD4", "triangle": "CTRIA3", "quad8": "CQUAD8", "triangle6": "CTRIA6"}
_GRIDS = {"CQUAD4": 4, "CTRIA3": 3, "CQUAD8": 8, "CTRIA6": 6}

_NAME = "model.bdf"


class Model:
    """Shell model from arrays. Point i is grid i + 1. Elements are numbered from 1, block after block."""

    #: Text of the deck.
    deck: str

    def __init__(self, deck: str) -> None:
        self.deck = deck

    @classmethod
    def from_arrays(
        cls,
        points: ArrayLike,
        cells: Mapping[str, ArrayLike] | Iterable[tuple[str, ArrayLike]],
        properties: Mapping[int, Mapping[str, float]],
        cell_properties: Sequence[ArrayLike] | None = None,
    ) -> Model:
        """Creates a model of shells.

        Args:
            points: n x 3, basic frame, in the length unit of the job.
            cells: blocks of cells by kind, as in meshio: ``[("quad", m x 4), ("triangle", m x 3)]`` with rows of `points`, from 0; also
                ``quad8``, ``triangle6``.
            properties: by number: ``thickness``, ``E``, ``nu``, ``rho`` (default: 0), job units.
            cell_properties: property of every cell, one list for each block; default: the first property for all cells.

        Raises:
            ValueError: the shapes do not match, or points or properties do not exist.
        """
        x = np.asarray(points, dtype=float)
        if x.ndim != 2 or x.shape[1] != 3 or not np.isfinite(x).all():
            raise ValueError(f"points have the shape n x 3 and are finite, not {x.shape}")
        if not properties:
            raise ValueError("there is no property: give one, {1: {'thickness': .., 'E': .., 'nu': ..}}")
        blocks = list(cells.items() if isinstance(cells, Mapping) else cells)
        numbers = cell_properties or [np.full(len(np.asarray(c)), next(iter(properties))) for _, c in blocks]
        if len(numbers) != len(blocks):
            raise ValueError(f"cell_properties has {len(numbers)} lists and cells {len(blocks)} blocks")
        lines = ["SOL 101", "CEND", "BEGIN BULK"]
        lines += [f"GRID,{i + 1},,{_row(p)}" for i, p in enumerate(x)]
        element = 0
        for (kind, block), of in zip(blocks, numbers):
            card, grids = _cells(kind, block, len(x))
            pids = np.asarray(of, dtype=int)
            if pids.shape != (len(grids),) or not set(pids.tolist()) <= set(properties):
                raise ValueError(f"the cells of `{kind}` need one of the properties {list(properties)} each")
            for pid, row in zip(pids, grids + 1):
                element += 1
                fields = [str(g) for g in row]
                # The first line of a shell has six fields left.
                more = "," + ",".join(fields[6:]) if len(fields) > 6 else ""
                lines.append(f"{card},{element},{pid},{','.join(fields[:6])}" + ("\n" + more if more else ""))
        for number, p in properties.items():
            lines.append(f"PSHELL,{number},{number},{_number(p['thickness'])},{number},,{number}")
            lines.append(f"MAT1,{number},{_number(p['E'])},,{_number(p['nu'])},{_number(p.get('rho', 0.0))}")
        return cls("\n".join([*lines, "ENDDATA", ""]))

    def job(self, job: Mapping[str, Any], folder: str | os.PathLike[str] = ".") -> Job:
        """Returns a job on this model: the dictionary of :meth:`Job.from_dict` without ``[model] deck``.

        A load may state its ``point``, from 0, instead of its ``grid``. Nothing is written."""
        keys = plain(job)
        for load in keys.get("load", []):
            if "point" in load:
                load["grid"] = load.pop("point") + 1
        keys["model"] = {**keys.get("model", {}), "deck": _NAME}
        return Job.from_dict(keys, folder, {in_folder(folder, _NAME): self.deck.encode()})

    def solve(self, job: Mapping[str, Any], **more: Any) -> Outcome:
        """Solves the unit loads of :meth:`job` with the built-in solver. Further arguments are those of :func:`strainbridge.solve`."""
        return solve(self.job(job), **more)

    def mesh(self) -> Mesh:
        """Returns points and cells for pyvista and meshio. ``grid`` and ``element`` are the ids in the deck."""
        return of_native(_engine._Deck(_NAME, {_NAME: self.deck.encode()}).mesh())

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes the deck."""
        with open(path, "w", encoding="ascii") as file:
            file.write(self.deck)


def _number(value: float) -> str:
    return repr(float(value))


def _row(values: np.ndarray[Any, Any]) -> str:
    return ",".join(map(_number, values))


def _cells(kind: str, block: ArrayLike, points: int) -> tuple[str, np.ndarray[Any, Any]]:
    card = _CARDS.get(kind, kind.upper())
    rows = np.asarray(block)
    if card not in _GRIDS:
        raise ValueError(f"cells `{kind}` are not known: give {', '.join(_CARDS)}")
    if rows.ndim != 2 or rows.shape[1] != _GRIDS[card] or rows.dtype.kind not in "iu":
        raise ValueError(f"cells `{kind}` are whole numbers, m x {_GRIDS[card]}, not {rows.dtype} {rows.shape}")
    if rows.size and not (0 <= rows.min() and rows.max() < points):
        raise ValueError(f"cells `{kind}` name points that do not exist: they count from 0 to {points - 1}")
    return card, rows.astype(np.int64)
