"""Tables for pandas, polars, DuckDB and other readers of Arrow."""

from __future__ import annotations

import json
from typing import Any, Mapping, Sequence

import numpy as np

from . import _strainbridge as _engine


class Table:
    """Table in the Arrow format, which other packages read through the Arrow PyCapsule interface.

    Use ``polars.DataFrame(table)``, ``pandas.DataFrame.from_arrow(table)``, ``duckdb.sql("select * from table")`` or ``pyarrow.table(table)``. No
    Arrow package is needed here. If pyarrow is installed, a table also has the methods of a ``pyarrow.Table``: ``table["name"]``,
    ``table.to_pandas()``."""

    __slots__ = ("_native", "_source")

    def __init__(self, native: _engine._Table, source: tuple[str, Any]) -> None:
        self._native = native
        # The constructor and its argument, for copies.
        self._source = source

    @classmethod
    def from_records(cls, records: Sequence[Mapping[str, Any]]) -> Table:
        """Creates one row for each record, with columns in the order of the keys.

        Values are numbers, truth values, texts and lists of numbers. Other values are stored as JSON.
        """
        rows = list(records)
        names = list(dict.fromkeys(name for row in rows for name in row))
        return cls(_engine._Table(json.dumps(rows), names), ("from_records", rows))

    @classmethod
    def from_columns(cls, columns: Mapping[str, Any]) -> Table:
        """Creates one column for each name, from one-dimensional arrays of numbers or lists of texts."""
        held = {name: _column(c) for name, c in columns.items()}
        return cls(_engine._Table(columns=held), ("from_columns", held))

    @property
    def num_rows(self) -> int:
        """Number of rows."""
        return self._native.num_rows

    @property
    def column_names(self) -> list[str]:
        """Names of the columns."""
        return self._native.column_names

    def __arrow_c_schema__(self) -> object:
        """Returns the schema through the Arrow PyCapsule interface."""
        return self._native.__arrow_c_schema__()

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """Returns the rows through the Arrow PyCapsule interface."""
        return self._native.__arrow_c_stream__(requested_schema)

    def __len__(self) -> int:
        return self.num_rows

    def __reduce__(self) -> Any:
        constructor, argument = self._source
        return (getattr(Table, constructor), (argument,))

    def _pyarrow(self, what: str) -> Any:
        try:
            import pyarrow  # type: ignore[import-untyped, import-not-found, unused-ignore]
        except ImportError as e:
            said = f"`{what}` is pyarrow's: pip install pyarrow, or hand the table to pandas, polars or DuckDB as it is"
            raise ImportError(said) from e
        return pyarrow.table(self)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self._pyarrow(name), name)

    def __getitem__(self, key: Any) -> Any:
        return self._pyarrow("[]")[key]

    def __repr__(self) -> str:
        return f"Table({self.num_rows} rows: {', '.join(self.column_names)})"


def _column(values: Any) -> Any:
    array = np.asarray(values)
    if array.dtype.kind in "iub":
        return np.ascontiguousarray(array, dtype=np.int64)
    if array.dtype.kind == "f":
        return np.ascontiguousarray(array, dtype=np.float64)
    return [str(v) for v in values]
