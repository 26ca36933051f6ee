"""What a command comes to."""

from __future__ import annotations

import json
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Iterator, Literal, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from . import _strainbridge as _engine
from ._mesh import Mesh, read_vtu
from ._table import Table


@dataclass(frozen=True)
class Finding:
    """What is to be known of an answer."""

    #: ``error``: the answer can't be relied on; ``warning``: look before you trust; ``info``: worth knowing.
    severity: Literal["info", "warning", "error"]
    #: Stable code, such as ``loads-not-separable``.
    code: str
    #: What it is about: a gauge, a load, a file, an element.
    subject: str
    #: A sentence with the consequence.
    message: str
    #: The measured number, where there is one.
    measured: float | None
    #: The limit it is held against.
    limit: float | None
    #: What to do.
    remedy: str

    @property
    def where(self) -> str:
        """What it is about: the subject."""
        return self.subject

    @property
    def text(self) -> str:
        """The sentence: the message."""
        return self.message

    def __str__(self) -> str:
        return f"{self.severity}: {self.code}: {self.subject}: {self.message}: {self.remedy}"


class Record(Mapping[str, Any]):
    """An object of ``result.json``: its keys are attributes and items. Lists of numbers are numpy arrays."""

    __slots__ = ("_keys", "_seen")

    def __init__(self, keys: dict[str, Any]) -> None:
        self._keys = keys
        self._seen: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._seen:
            self._seen[name] = _value(self._keys[name])
        return self._seen[name]

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_") or name not in self._keys:
            raise AttributeError(f"no `{name}` here, but {', '.join(self._keys)}")
        return self[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._keys)

    def __len__(self) -> int:
        return len(self._keys)

    def to_dict(self) -> dict[str, Any]:
        """The keys as JSON has them."""
        copy: dict[str, Any] = json.loads(json.dumps(self._keys))
        return copy

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Record) and self._keys == other._keys

    __hash__ = None  # type: ignore[assignment]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._keys]

    def __repr__(self) -> str:
        return "Record(" + ", ".join(f"{k}={v!r}" for k, v in self._keys.items()) + ")"

    def __reduce__(self) -> Any:
        return (Record, (self._keys,))


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _value(value: Any) -> Any:
    """A value of JSON as Python has it: objects as records, lists of numbers (null: NaN) and of such lists as arrays."""
    if isinstance(value, dict):
        return Record(value)
    if not isinstance(value, list):
        return value
    if value and any(map(_is_number, value)) and all(v is None or _is_number(v) for v in value):
        whole = all(isinstance(v, int) for v in value)
        return np.array(value, dtype=np.int64 if whole else np.float64)
    if value and all(isinstance(v, list) and v for v in value) and len({len(v) for v in value}) == 1:
        rows = [_value(v) for v in value]
        if all(isinstance(r, np.ndarray) for r in rows):
            return np.array(rows)
    return [_value(v) for v in value]


class Outcome(Record):
    """What a command comes to: the keys of its ``result.json`` are attributes, with lists of numbers as numpy arrays.

    ``findings`` are objects; :attr:`is_reliable` is False where one of them says that the answer can't be relied on (the command would end
    with exit code 1), and the outcome then says so when it is printed.
    """

    __slots__ = ("_native", "_json")

    def __init__(self, native: _engine._Outcome) -> None:
        super().__init__(json.loads(native.json))
        self._native = native
        self._json = native.json
        self._seen["findings"] = tuple(Finding(**f) for f in self._keys["findings"])

    @property
    def findings(self) -> Sequence[Finding]:
        """What is to be known of the answer, the worst first."""
        listed: Sequence[Finding] = self["findings"]
        return listed

    @property
    def is_reliable(self) -> bool:
        """Whether no finding says that the answer can't be relied on."""
        return all(f.severity != "error" for f in self.findings)

    @property
    def words(self) -> str:
        """What the command prints on a terminal."""
        return self._native.words

    @property
    def notes(self) -> list[str]:
        """What is worth knowing of the way, and no part of the answer."""
        return list(self._native.notes)

    def to_json(self) -> str:
        """The text of ``result.json``; `tables` is filled once the outcome has been saved."""
        return self._json

    def save(self, folder: str | Path) -> Path:
        """Writes the files of the command (``result.json``, tables, ``report.html``) into a folder, which is made where missing.

        Raises:
            Faults: a file that can't be written.
        """
        self._json = self._native.save(folder)
        self._keys["tables"] = json.loads(self._json)["tables"]
        self._seen.pop("tables", None)
        return Path(folder)

    def report(self) -> str:
        """The page of the command, HTML that needs nothing else.

        Raises:
            KeyError: the command writes none; a notebook shows what it answers.
        """
        with tempfile.TemporaryDirectory() as folder:
            page = self.save(folder) / "report.html"
            if not page.exists():
                raise KeyError(f"`{self._keys['command']}` writes no page")
            return page.read_text(encoding="utf-8")

    def history(self) -> dict[str, NDArray[np.float64]]:
        """Every sample of a record that :func:`strainbridge.recover` was given: ``time`` (s), then of each load its value, ``<load>.low`` and
        ``<load>.high`` (95 %), as `loads.csv` has them, report units; NaN where the gauges that read don't tell a load.

        Raises:
            KeyError: the outcome holds no record.
        """
        found = self._native.history()
        if found is None:
            raise KeyError("no history: static runs were measured, or another question was asked")
        return found

    def to_arrow(self, table: str | None = None) -> Table:
        """A table of the answer for any reader of the Arrow PyCapsule interface (pandas, polars, DuckDB, pyarrow): the list of records named,
        else the first (``loads``, ``gauges``); ``history``: every sample of a record, as :meth:`history`.

        Raises:
            KeyError: there is no such table.
        """
        if table == "history":
            return Table.from_columns(self.history())
        name = table or next(iter(self._tables()), None)
        if name is None or name not in self._keys:
            raise KeyError(f"no table `{name}`, but {', '.join(self._tables()) or 'none'}")
        return Table.from_records(self._keys[name])

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """The first table, by the Arrow PyCapsule interface."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def mesh(self, file: str | None = None) -> Mesh:
        """Points and cells with the numbers of the answer on them, those of the VTU that the command writes: the mesh with displacement and
        strain (`solve`, `modes`), with the envelope of stress (`respond`); gauges with their axes (`place`), loads as arrows (`recover`).
        The bare mesh of a deck: ``Deck.read(path).mesh()``.

        Args:
            file: which VTU, where there are several.

        Raises:
            KeyError: the answer has no picture in space.
        """
        with tempfile.TemporaryDirectory() as folder:
            found = {p.name: p for p in sorted(self.save(folder).glob("*.vtu"))}
            name = file or next(iter(found), "")
            if name not in found:
                raise KeyError(f"no mesh `{name}`" if found else f"`{self._keys['command']}` has no mesh: take `Deck.read(path).mesh()`")
            return read_vtu(found[name])

    def _tables(self) -> list[str]:
        of_the_way = ("inputs", "findings")
        lists = ((k, v) for k, v in self._keys.items() if k not in of_the_way and isinstance(v, list))
        return [k for k, v in lists if v and all(isinstance(r, dict) for r in v)]

    def _verdict(self) -> str:
        bad = [f for f in self.findings if f.severity == "error"]
        if not bad:
            return ""
        return "CAN'T BE RELIED ON: " + "; ".join(f.message for f in bad)

    def __repr__(self) -> str:
        lines = [f"{self._keys['command']}: {self._verdict() or 'done'}"]
        lines += [line for line in self.words.splitlines() if line]
        lines += [f"{f.severity}: {f.message}" for f in self.findings if f.severity != "error"]
        return "\n".join(lines)

    def __reduce__(self) -> Any:
        raise TypeError("an outcome can't be pickled: save it, or take `to_dict()`")

    def _repr_html_(self) -> str:
        return self._native.html()
