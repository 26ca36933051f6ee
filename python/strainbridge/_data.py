"""Tables of pandas, polars, pyarrow and other packages as CSV files in memory."""

from __future__ import annotations

import csv
import datetime
import io
import math
from typing import Any, Iterator

import numpy as np

#: Names that pandas and its users give to the key of a row.
_KEYS = ("run", "time", "gauge", "name")


def is_table(value: Any) -> bool:
    """Returns whether a value is a table: it has an Arrow stream, or is a DataFrame of pandas."""
    return hasattr(value, "__arrow_c_stream__") or _is_pandas(value)


def _is_pandas(value: Any) -> bool:
    return type(value).__module__.split(".")[0] == "pandas" and hasattr(value, "columns")


def csv_bytes(table: Any) -> bytes:
    """Returns the table as UTF-8 CSV with full precision. A missing value is an empty cell.

    The index of a DataFrame becomes a column if it has a name, or contains times or texts.

    Raises:
        TypeError: a column contains lists, or no installed package reads the table.
        ValueError: two columns have the same name, or the index has the name of a column.
    """
    names = _names(table)
    twice = sorted({n for n in names if names.count(n) > 1})
    if twice:
        raise ValueError(f"the table has more than one column {', '.join(twice)}; give each column, and the index, a name of its own")
    columns = dict(_columns(table))
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(columns)
    for row in zip(*columns.values()):
        out.writerow([_cell(v) for v in row])
    return text.getvalue().encode()


def _index_name(index: Any) -> str | None:
    """Returns the name of the column that the index of a DataFrame becomes, or None if it is a plain count."""
    kind = index.dtype.kind if hasattr(index.dtype, "kind") else "O"
    if index.name is None and kind in "iu":
        return None
    return str(index.name or ("time" if kind in "fMm" else "run"))


def _names(table: Any) -> list[str]:
    if _is_pandas(table):
        index = _index_name(table.index)
        return [*([] if index is None else [index]), *map(str, table.columns)]
    return list(_arrow(table).column_names)


def _columns(table: Any) -> Iterator[tuple[str, list[Any]]]:
    if _is_pandas(table):
        index = _index_name(table.index)
        if index is not None:
            yield index, _values(table.index)
        for name in table.columns:
            yield str(name), _values(table[name])
        return
    arrow = _arrow(table)
    for name in arrow.column_names:
        yield name, arrow[name].to_pylist()


def _values(column: Any) -> list[Any]:
    return [None if missing else v for v, missing in zip(column.tolist(), column.isna())]


def _arrow(table: Any) -> Any:
    try:
        import pyarrow  # type: ignore[import-untyped, import-not-found, unused-ignore]

        return pyarrow.table(table)
    except ImportError:
        pass
    if hasattr(table, "to_dict") and hasattr(table, "get_columns"):
        return _Polars(table)
    raise TypeError(f"a table of {type(table).__module__} needs pyarrow: pip install pyarrow, or pass a DataFrame of pandas or polars")


class _Polars:
    """A DataFrame of polars with the attribute names of pyarrow."""

    def __init__(self, frame: Any) -> None:
        self._frame = frame
        self.column_names = list(frame.columns)

    def __getitem__(self, name: str) -> Any:
        return _Polars._Column(self._frame[name].to_list())

    class _Column(list):  # type: ignore[type-arg]
        def to_pylist(self) -> list[Any]:
            return self


def _cell(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, (bool, np.bool_)):
        return str(int(value))
    if isinstance(value, (float, np.floating)):
        return "" if math.isnan(value) else repr(float(value))
    if isinstance(value, (int, np.integer, str)):
        return str(value)
    if isinstance(value, datetime.timedelta):
        return repr(value.total_seconds())
    if isinstance(value, (datetime.datetime, datetime.date)):
        return value.isoformat()
    if isinstance(value, bytes):
        return value.decode()
    raise TypeError(f"a cell contains {value!r}; numbers, texts and times are needed")
