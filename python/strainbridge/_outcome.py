"""Outcome of a command."""

from __future__ import annotations

import csv
import json
import os
import sys
import tempfile
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Iterator, Literal, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from . import _strainbridge as _engine
from ._faults import Faults
from ._mesh import Mesh, read_vtu
from ._table import Table


@dataclass(frozen=True)
class Finding:
    """Finding on a result."""

    #: ``error``: the result is not reliable; ``warning``: the result is usable with the stated limits; ``info``: for information.
    severity: Literal["info", "warning", "error"]
    #: Stable code, such as ``loads-not-separable``.
    code: str
    #: Subject: a gauge, a load, a file, an element.
    subject: str
    #: A sentence with the consequence.
    message: str
    #: Measured number, if there is one.
    measured: float | None
    #: Limit of the measured number.
    limit: float | None
    #: What to do.
    remedy: str

    @property
    def where(self) -> str:
        """Subject of the finding."""
        return self.subject

    @property
    def text(self) -> str:
        """Message of the finding."""
        return self.message

    def __str__(self) -> str:
        return f"{self.severity}: {self.code}: {self.subject}: {self.message} {self.remedy}"


class UnreliableWarning(UserWarning):
    """The answer has a finding of severity ``error`` and is not reliable."""


def warn_if_unreliable(command: str, findings: Sequence[Finding]) -> None:
    """Issues an :class:`UnreliableWarning` for the user's call if a finding is an error."""
    bad = [f.message for f in findings if f.severity == "error"]
    if bad:
        depth, frame = 2, sys._getframe(1)
        while frame.f_back is not None and frame.f_globals.get("__name__", "").startswith("strainbridge."):
            depth, frame = depth + 1, frame.f_back
        warnings.warn(f"{command}: {'; '.join(bad)}", UnreliableWarning, stacklevel=depth)


class Record(Mapping[str, Any]):
    """Object of ``result.json``. Its keys are attributes and items. Lists of numbers are numpy arrays."""

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
        """Returns the keys as in JSON."""
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
    """Converts a value of JSON: objects become records, and lists of numbers (null: NaN) and nested lists of numbers become arrays."""
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
    """Outcome of a command. The keys of its ``result.json`` are attributes, with lists of numbers as numpy arrays.

    ``findings`` are objects. :attr:`is_reliable` is False if one of them states that the result is not reliable. The command would then have exit
    code 1, and the printed outcome states it.
    """

    __slots__ = ("_native", "_json")

    _native: _engine._Outcome | _Stored

    def __init__(self, native: _engine._Outcome | _Stored) -> None:
        super().__init__(json.loads(native.json))
        self._native = native
        self._json = native.json
        self._seen["findings"] = tuple(Finding(**f) for f in self._keys["findings"])
        if self._keys["command"] == "sensitivity" and (found := native.sensitivity()) is not None:
            # `result.json` contains the number of gauges, which is the length of the list in Python.
            self._seen["gauges"], self._seen["loads"] = found[1], found[2]

    @classmethod
    def of_folder(cls, answer: Mapping[str, Any], folder: str | Path) -> Outcome:
        """Returns the outcome of a command that has written its files into a folder. `answer` is its ``result.json``."""
        where = Path(folder)
        listed = [line.split("\t")[1] for line in (where / _LISTED).read_text(encoding="utf-8").splitlines() if "\t" in line]
        files = {name: (where / name).read_bytes() for name in [*listed, _LISTED] if (where / name).is_file()}
        text = json.dumps(answer)
        page = files.get("report.html", b"").decode()
        return cls(_Stored(text, "", [], page, None, None, files, text))

    @property
    def findings(self) -> Sequence[Finding]:
        """Findings on the answer, the worst first."""
        listed: Sequence[Finding] = self["findings"]
        return listed

    @property
    def is_reliable(self) -> bool:
        """Whether no finding is an error. An error means that the answer is unreliable."""
        return all(f.severity != "error" for f in self.findings)

    def __getattr__(self, name: str) -> Any:
        if name == "S":
            raise AttributeError(f"`{self._keys['command']}` gives no S: call `sensitivity` or `calibrate`")
        return super().__getattr__(name)

    def raise_if_unreliable(self) -> Outcome:
        """Returns the outcome itself.

        Raises:
            UnreliableWarning: a finding is an error.
        """
        if not self.is_reliable:
            raise UnreliableWarning(self._verdict())
        return self

    @property
    def S(self) -> NDArray[np.float64]:
        """S of ``sensitivity`` and ``calibrate``: gauges x loads, microstrain per job unit of each load.

        Rows and columns have the order of ``sensitivity.csv``.

        Raises:
            AttributeError: the outcome is that of another command.
        """
        found = self._native.sensitivity()
        if found is None:
            raise AttributeError("S")
        return found[0]

    @property
    def words(self) -> str:
        """Output of the command on a terminal."""
        return self._native.words

    @property
    def notes(self) -> list[str]:
        """Notes about the computation, which are not part of the answer."""
        return list(self._native.notes)

    def to_json(self) -> str:
        """Returns the text of ``result.json``. `tables` is filled once the outcome is saved."""
        return self._json

    def save(self, folder: str | Path) -> Path:
        """Writes the files of the command (``result.json``, tables, ``report.html``) into a folder, and creates the folder if necessary.

        Raises:
            Faults: a file cannot be written.
        """
        self._json = self._native.save(folder)
        self._keys["tables"] = json.loads(self._json)["tables"]
        self._seen.pop("tables", None)
        return Path(folder)

    def report(self) -> str:
        """Returns the page of the command, as HTML without external files.

        Raises:
            KeyError: the command writes no page. A notebook shows its answer.
        """
        with tempfile.TemporaryDirectory() as folder:
            page = self.save(folder) / "report.html"
            if not page.exists():
                raise KeyError(f"`{self._keys['command']}` writes no page")
            return page.read_text(encoding="utf-8")

    def history(self) -> dict[str, NDArray[np.float64]]:
        """Returns every sample of a record of :func:`strainbridge.recover`, as in `loads.csv`, in report units.

        The columns are ``time`` (s), and for each load its value, ``<load>.low`` and ``<load>.high`` (95 %). Values are NaN if the valid gauges do
        not determine a load.

        Raises:
            KeyError: the outcome contains no record.
        """
        found = self._native.history()
        if found is None:
            raise KeyError("no history: static runs were measured, or another question was asked")
        return found

    def to_arrow(self, table: str | None = None) -> Table:
        """Returns a table of the answer for any reader of the Arrow PyCapsule interface (pandas, polars, DuckDB, pyarrow).

        A table is a list of records of the outcome (``loads``, ``gauges``), or a CSV file of the command by its name (``sensitivity``, ``fleet``).
        By default it is the first one. ``history`` is every sample of a record, as in :meth:`history`. Columns have the order of ``result.json`` or
        of the file.

        Raises:
            KeyError: there is no such table.
        """
        if table == "history":
            return Table.from_columns(self.history())
        name = table or next(iter(self._tables()), None)
        if name is not None and name in self._tables():
            return Table.from_records(self._keys[name])
        with tempfile.TemporaryDirectory() as folder:
            files = {p.stem: p for p in sorted(self._copy(folder).glob("*.csv"))}
            name = name or next(iter(files), None)
            if name in files:
                return _table_of_csv(files[name])
        raise KeyError(f"no table `{name}`, but {', '.join([*self._tables(), *files]) or 'none'}")

    def _copy(self, folder: str) -> Path:
        """Writes the files into a folder without a change of the outcome."""
        self._native.save(folder)
        return Path(folder)

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object:
        """Returns the first table through the Arrow PyCapsule interface."""
        return self.to_arrow().__arrow_c_stream__(requested_schema)

    def mesh(self, file: str | None = None) -> Mesh:
        """Returns points and cells with the numbers of the answer, as in the VTU that the command writes.

        The mesh has displacement and strain (`solve`, `modes`) or the envelope of stress (`respond`). Otherwise it has gauges with their axes
        (`place`) or loads as arrows (`recover`). For the bare mesh of a deck, use ``Deck.read(path).mesh()``.

        Args:
            file: name of the VTU, if there are several.

        Raises:
            KeyError: the answer has no mesh.
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
        return "NOT RELIABLE: " + "; ".join(f.message for f in bad)

    def __repr__(self) -> str:
        lines = [f"{self._keys['command']}: {self._verdict() or 'done'}"]
        lines += [line for line in self.words.splitlines() if line]
        lines += [f"{f.severity}: {f.message}" for f in self.findings if f.severity != "error"]
        return "\n".join(lines)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Outcome):
            return NotImplemented
        own, others = ({k: v for k, v in o._keys.items() if k not in ("seconds", "tables")} for o in (self, other))
        return own == others

    __hash__ = None

    def __reduce__(self) -> Any:
        return (Outcome, (_stored(self._native),))

    def _repr_html_(self) -> str:
        return self._native.html()


@dataclass(frozen=True)
class _Stored:
    """Outcome without its engine: the content of a copy or a pickle."""

    json: str
    words: str
    notes: list[str]
    page: str
    s: tuple[NDArray[np.float64], list[str], list[str]] | None
    samples: dict[str, NDArray[np.float64]] | None
    #: Files that `save` writes, by name, and the text of ``result.json`` with its tables.
    files: dict[str, bytes]
    saved: str

    def html(self) -> str:
        return self.page

    def sensitivity(self) -> tuple[NDArray[np.float64], list[str], list[str]] | None:
        return self.s

    def history(self) -> dict[str, NDArray[np.float64]] | None:
        return self.samples

    def save(self, folder: str | os.PathLike[str]) -> str:
        where = Path(folder)
        where.mkdir(parents=True, exist_ok=True)
        listed = where / _LISTED
        lines = listed.read_text(encoding="utf-8").splitlines() if listed.exists() else []
        written = {line.split("\t")[1] for line in lines if "\t" in line}
        foreign = [n for n in self.files if n != _LISTED and n not in written and (where / n).exists()]
        if foreign:
            raise Faults([(str(where / n), None, "save", "the file exists, and no command wrote it", "save into another folder, or remove the file") for n in foreign])
        for name, content in self.files.items():
            if name != _LISTED:
                part = where / f"{name}.part"
                part.write_bytes(content)
                part.replace(where / name)
        kept = [line for line in lines if line.split("\t")[1:2] and line.split("\t")[1] not in self.files]
        text = "".join(f"{line}\n" for line in kept) + self.files.get(_LISTED, b"").decode()
        listed.write_text(text, encoding="utf-8")
        return self.saved


#: File with the list of files that commands wrote into a folder.
_LISTED = ".strainbridge"


def _stored(native: _engine._Outcome | _Stored) -> _Stored:
    if isinstance(native, _Stored):
        return native
    with tempfile.TemporaryDirectory() as folder:
        saved = native.save(folder)
        files = {p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(Path(folder).rglob("*")) if p.is_file()}
    return _Stored(native.json, native.words, list(native.notes), native.html(), native.sensitivity(), native.history(), files, saved)


def _table_of_csv(path: Path) -> Table:
    """Returns one column for each name: numbers if every cell is a number or empty (NaN), otherwise texts."""
    with path.open(encoding="utf-8", newline="") as file:
        header, *rows = csv.reader(file)
    columns: dict[str, Any] = {}
    for i, name in enumerate(header):
        cells = [row[i] for row in rows]
        try:
            columns[name] = np.array([float(c) if c else np.nan for c in cells])
        except ValueError:
            columns[name] = cells
    return Table.from_columns(columns)
