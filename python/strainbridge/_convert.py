"""Converts arguments from Python for the engine."""

from __future__ import annotations

import operator
from decimal import Decimal
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

#: Largest whole number that the engine takes.
_LARGEST = 2**63 - 1
#: Largest number of threads. Starting millions would take hours.
_MOST_THREADS = 1024


def floats(name: str, value: Any) -> Floats:
    """Returns `value` as a float64 array in C order, without a copy if it is one already.

    Masked values, ``None`` and missing values of pandas, polars and pyarrow become NaN.

    Raises:
        TypeError: texts, complex numbers or objects that are not numbers.
    """
    if isinstance(value, np.ma.MaskedArray):
        filled = value.astype(np.float64).filled(np.nan)  # type: ignore[no-untyped-call, attr-defined, unused-ignore]
        return np.ascontiguousarray(filled)
    array = np.asarray(value)
    if array.dtype.kind == "O":
        array = _of_objects(name, array)
    if array.dtype.kind not in "fiub":
        raise TypeError(f"{name} has the type {array.dtype}; numbers are needed: pass {name}.astype(float)")
    return np.ascontiguousarray(array, dtype=np.float64)


def _of_objects(name: str, array: NDArray[Any]) -> NDArray[np.float64]:
    """Returns objects as numbers. Missing values of pandas and Python become NaN."""
    out = np.full(array.shape, np.nan)
    for at, value in np.ndenumerate(array):
        if value is None or type(value).__name__ in ("NAType", "NaTType"):
            continue
        if not isinstance(value, (Real, Decimal, np.number)):
            raise TypeError(f"{name} contains {value!r} at {at}; numbers are needed")
        out[at] = float(value)
    return out


def check_order(S: Any, strain: Any) -> None:
    """Compares the row names of a DataFrame S with the column names of a table of strain. Tables without such names pass.

    Raises:
        ValueError: both name the same gauges, in another order. Rows and columns are paired by their order.
    """
    gauges = _texts(getattr(S, "index", None)) if hasattr(S, "columns") else []
    columns = _texts(getattr(strain, "columns", None) if not hasattr(strain, "column_names") else strain.column_names)
    if set(gauges) & set(columns) and gauges != columns:
        first = next((pair for pair in zip(gauges, columns) if pair[0] != pair[1]), (gauges[-1], columns[-1]))
        raise ValueError(f"the gauges of S and strain differ in order or name, first {first[0]} and {first[1]}; pass strain[list(S.index)]")


def _texts(labels: Any) -> list[str]:
    """Returns labels if all of them are texts, otherwise an empty list."""
    try:
        listed = list(labels)
    except TypeError:
        return []
    return listed if all(isinstance(name, str) for name in listed) else []


def count(name: str, value: Any) -> int:
    """Returns a whole number of 1 or more.

    Raises:
        TypeError: a text or a number with a fraction.
        ValueError: 0 or less, or a number that the engine does not take.
    """
    try:
        number = operator.index(_no_truth(value))
    except TypeError:
        raise TypeError(f"{name} is {value!r}; a whole number is needed") from None
    if number < 1:
        raise ValueError(f"{name} is {number}; 1 or more is needed")
    if number > _LARGEST:
        raise ValueError(f"{name} is {number}; at most {_LARGEST} is possible")
    return number


def _no_truth(value: Any) -> Any:
    """Returns the value unchanged.

    Raises:
        TypeError: it is a truth value, which Python counts as a number.
    """
    if isinstance(value, (bool, np.bool_)):
        raise TypeError("a truth value")
    return value


def number(name: str, value: Any) -> float:
    """Returns a real number.

    Raises:
        TypeError: a text, an array or another object.
    """
    if isinstance(value, (bool, str, bytes)) or not isinstance(value, (Real, np.number, np.ndarray)) or np.asarray(value).ndim:
        raise TypeError(f"{name} is {value!r}; a number is needed")
    return float(value)


def threads(value: Any) -> int | None:
    """Returns the number of threads; ``None`` and -1 mean all cores.

    Raises:
        TypeError: the value is not a whole number.
        ValueError: the value is 0 or below -1, or above 1024.
    """
    if value is None:
        return None
    try:
        number = operator.index(_no_truth(value))
    except TypeError:
        raise TypeError(f"threads is {value!r}; a whole number is needed") from None
    if number == -1:
        return None
    if number < 1:
        raise ValueError(f"threads is {number}; give 1 or more, or -1 for all cores")
    if number > _MOST_THREADS:
        raise ValueError(f"threads is {number}; give {_MOST_THREADS} or fewer, or -1 for all cores")
    return number
