"""Points and cells in the form of VTK, pyvista and meshio."""

from __future__ import annotations

import html
import os
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _strainbridge as _engine

#: VTK types of cells, by the names of meshio.
_KINDS = {1: "vertex", 3: "line", 5: "triangle", 9: "quad", 10: "tetra", 12: "hexahedron", 13: "wedge", 14: "pyramid", 22: "triangle6", 23: "quad8"}


@dataclass(frozen=True)
class Mesh:
    """Mesh with numbers: ``pyvista.UnstructuredGrid(mesh.cells, mesh.celltypes, mesh.points)``, or :meth:`to_pyvista`."""

    #: n x 3, basic frame.
    points: NDArray[np.float64]
    #: For each cell, the number of its points, followed by these points (rows of `points`, from 0).
    cells: NDArray[np.int64]
    #: VTK type of every cell: 1 vertex, 3 line, 5 triangle, 9 quadrilateral, 10 12 13 14 solids.
    celltypes: NDArray[np.uint8]
    #: Numbers by point: n, or n x columns. ``grid`` contains the ids.
    point_data: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    #: Numbers by cell. ``element`` contains the ids.
    cell_data: Mapping[str, NDArray[Any]] = field(default_factory=dict)

    @classmethod
    def from_arrays(
        cls,
        points: ArrayLike,
        cells: Mapping[str, ArrayLike],
        point_data: Mapping[str, ArrayLike] | None = None,
        cell_data: Mapping[str, ArrayLike] | None = None,
    ) -> Mesh:
        """Creates a mesh from blocks of cells by kind, as in meshio: ``{"quad": m x 4, "triangle": m x 3}``, rows of `points` from 0.

        Args:
            points: n x 3.
            cells: ``vertex``, ``line``, ``triangle``, ``quad``, ``tetra``, ``hexahedron``, ``wedge``, ``pyramid``, ``triangle6``, ``quad8``.
            point_data: numbers by point.
            cell_data: numbers by cell, in the order of the blocks.

        Raises:
            ValueError: the shapes do not match, or a point does not exist.
        """
        x = np.ascontiguousarray(points, dtype=np.float64)
        if x.ndim != 2 or x.shape[1] != 3:
            raise ValueError(f"points have the shape n x 3, not {x.shape}")
        numbers = {name: number for number, name in _KINDS.items()}
        flat, types = [], []
        for kind, block in cells.items():
            rows = np.asarray(block, dtype=np.int64)
            if kind not in numbers or rows.ndim != 2:
                raise ValueError(f"cells `{kind}`: give {', '.join(numbers)}, m x points of a cell")
            if rows.size and not (0 <= rows.min() and rows.max() < len(x)):
                raise ValueError(f"cells `{kind}` name points that do not exist: they count from 0 to {len(x) - 1}")
            flat.append(np.column_stack([np.full(len(rows), rows.shape[1]), rows]).ravel())
            types.append(np.full(len(rows), numbers[kind], dtype=np.uint8))
        joined = np.concatenate(flat).astype(np.int64) if flat else np.empty(0, np.int64)
        kinds = np.concatenate(types) if types else np.empty(0, np.uint8)
        return cls(x, joined, kinds, _data(point_data, len(x), "point"), _data(cell_data, len(kinds), "cell"))

    @property
    def offsets(self) -> NDArray[np.int64]:
        """End of each cell's points without the counts: `offsets` of VTK without its first 0."""
        ends = np.empty(len(self.celltypes), np.int64)
        at = total = 0
        for i in range(len(ends)):
            total += int(self.cells[at])
            at += int(self.cells[at]) + 1
            ends[i] = total
        return ends

    @property
    def blocks(self) -> dict[str, NDArray[np.int64]]:
        """Cells by kind, m x points, as in meshio. Within a kind, they have the order of the mesh."""
        ends = self.offsets
        sizes = np.diff(ends, prepend=0)
        starts = ends - sizes + np.arange(len(ends)) + 1
        out = {}
        for number in np.unique(self.celltypes):
            of = np.flatnonzero(self.celltypes == number)
            width = int(sizes[of[0]])
            out[_KINDS.get(int(number), str(number))] = self.cells[starts[of][:, None] + np.arange(width)]
        return out

    def to_pyvista(self) -> Any:
        """Returns the mesh as a ``pyvista.UnstructuredGrid`` with its numbers.

        Raises:
            ImportError: pyvista is not installed.
        """
        try:
            import pyvista  # type: ignore[import-untyped, import-not-found, unused-ignore]
        except ImportError as e:
            raise ImportError("to_pyvista needs pyvista: pip install pyvista") from e
        grid = pyvista.UnstructuredGrid(self.cells, self.celltypes, self.points)
        for name, values in self.point_data.items():
            grid.point_data[name] = values
        for name, values in self.cell_data.items():
            grid.cell_data[name] = values
        return grid

    def write(self, path: str | os.PathLike[str]) -> None:
        """Writes a VTU with all digits, which ParaView, pyvista and meshio read."""
        flat = np.delete(self.cells, self.offsets - np.diff(self.offsets, prepend=0) + np.arange(len(self.celltypes)))
        points = _data(dict(self.point_data), len(self.points), "point")
        cells = _data(dict(self.cell_data), len(self.celltypes), "cell")
        written = _engine.vtu_bytes(self.points, flat, self.offsets, self.celltypes, points, cells)
        Path(path).write_bytes(written)

    def __repr__(self) -> str:
        data = ", ".join([*self.point_data, *self.cell_data])
        return f"Mesh({len(self.points)} points, {len(self.celltypes)} cells{': ' if data else ''}{data})"


def _data(given: Mapping[str, ArrayLike] | None, n: int, what: str) -> dict[str, NDArray[Any]]:
    out = {}
    for name, values in (given or {}).items():
        array = np.asarray(values)
        if array.ndim not in (1, 2) or len(array) != n or array.dtype.kind not in "iufb":
            raise ValueError(f"`{name}` has the shape {array.shape}: give numbers, {n} rows, one for each {what}")
        out[name] = np.ascontiguousarray(array, dtype=np.float64 if array.dtype.kind == "f" else np.int64)
    return out


def of_native(found: dict[str, NDArray[Any]]) -> Mesh:
    """Returns the mesh of a deck from the data of the engine."""
    return _joined(found["points"], found["connectivity"], found["offsets"], found["types"], {"grid": found["grid"]}, {"element": found["element"]})


def _joined(points: Any, connectivity: Any, offsets: Any, types: Any, on_points: Any, on_cells: Any) -> Mesh:
    sizes = np.diff(offsets, prepend=0)
    cells = np.insert(connectivity, offsets - sizes, sizes).astype(np.int64)
    return Mesh(points, cells, types, on_points, on_cells)


_ARRAY = re.compile(r'<DataArray type="(\w+)" Name="([^"]*)" NumberOfComponents="(\d+)" format="appended" offset="(\d+)"/>')
_DTYPES = {"Float64": "<f8", "Float32": "<f4", "Int64": "<i8", "Int32": "<i4", "UInt8": "|u1"}


def read_vtu(path: Path) -> Mesh:
    """Reads a VTU of this package, which contains arrays as appended raw bytes."""
    data = path.read_bytes()
    mark = b'<AppendedData encoding="raw">\n_'
    begin = data.index(mark) + len(mark)
    text = data[:begin].decode()

    def section(name: str) -> dict[str, NDArray[Any]]:
        inside = text[text.index(f"<{name}>") : text.index(f"</{name}>")] if f"<{name}>" in text else ""
        out = {}
        for kind, label, columns, offset in _ARRAY.findall(inside):
            at = begin + int(offset)
            size = int.from_bytes(data[at : at + 8], "little")
            values = np.frombuffer(data, _DTYPES[kind], offset=at + 8, count=size // np.dtype(_DTYPES[kind]).itemsize)
            # A copy, because an array over bytes is read-only.
            out[html.unescape(label)] = values.reshape(-1, int(columns)).copy() if columns != "1" else values.copy()
        return out

    cells = section("Cells")
    return _joined(section("Points")["Points"], cells["connectivity"], cells["offsets"], cells["types"], section("PointData"), section("CellData"))
