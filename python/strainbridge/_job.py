"""A job, read from a file or created from a dictionary, and changed in place."""

from __future__ import annotations

import json
import os
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterator, Mapping

from . import _strainbridge as _engine
from ._data import csv_bytes, is_table
from ._foreign import deck_bytes, is_deck, is_results, op2_bytes
from ._keys import Keys
from ._section import Items, Section
from ._toml import plain, text_of

#: Name of a job from a dictionary in its folder. No such file is written.
_NAME = "job.toml"


@lru_cache(maxsize=None)
def _schema() -> dict[str, Any]:
    """Returns the schema of a job, by key."""
    keys: dict[str, Any] = json.loads(_engine.schema())["properties"]
    return keys


def _is_section(name: str) -> bool:
    """Returns whether a key is a single section."""
    return "properties" in _schema()[name]


def in_folder(folder: str | os.PathLike[str], name: str) -> str:
    """Returns the path of a file as seen from the folder of a job."""
    base = os.fspath(folder)
    return name if base in ("", ".") else os.path.join(base, name)


class Job(Keys):
    """A job, as in the file that the command reads: ``Job.read(path)`` or ``Job.from_dict({...})``.

    Keys and sections are attributes, as in the file, and can be changed in place: ``job.placement.gauges = 12``. A change is checked at the next use
    of the job, or by :meth:`check`. Faults raise :class:`strainbridge.Faults`. A job can be pickled.
    """

    _path: str
    _text: str
    _files: dict[str, bytes]
    _table: dict[str, Any] | None
    _native: _engine._Job | None

    def __init__(self, path: str | os.PathLike[str], text: str | None = None, files: Mapping[str, bytes] | None = None) -> None:
        put = object.__setattr__
        put(self, "_path", os.fspath(path))
        put(self, "_files", dict(files or {}))
        put(self, "_table", None)
        put(self, "_native", None)
        # The engine reads the text of the file and reports its faults.
        put(self, "_text", text)
        self.check()

    @classmethod
    def read(cls, path: str | os.PathLike[str]) -> Job:
        """Reads a job from a file. Paths in it are relative to its folder.

        Raises:
            Faults: every fault with its line: syntax, unknown keys, wrong types, contradictions.
        """
        return cls(path)

    @classmethod
    def from_dict(cls, job: Mapping[str, Any], folder: str | os.PathLike[str] = ".", files: Mapping[str, bytes] | None = None) -> Job:
        """Creates a job from a dictionary with the keys of the file. Numpy arrays, paths and tuples are accepted.

        Args:
            job: sections are dictionaries; ``[[load]]`` and similar sections are lists of dictionaries. A key that names a table may contain the
                table (a DataFrame, or another object with ``__arrow_c_stream__``). ``deck`` and ``results`` of ``model`` may be a `BDF` and `OP2` of
                pyNastran instead of paths.
            folder: folder to which paths are relative. Nothing is written there.
            files: files in memory, by path relative to `folder` or to the working folder. They replace files on the disk.

        Raises:
            Faults: every fault. Lines refer to ``job.text``.
        """
        if not isinstance(job, Mapping):
            raise TypeError(f"job is {job!r}; a dictionary is needed")
        held = dict(files or {})
        held.update({in_folder(folder, os.fspath(name)): content for name, content in (files or {}).items()})
        return cls(in_folder(folder, _NAME), text_of(_without_objects(job, folder, held)), held)

    @property
    def path(self) -> str:
        """Path of the file. For a job from a dictionary, the path that it would have."""
        return self._path

    @property
    def text(self) -> str:
        """The job as TOML, including changes."""
        return Path(self._path).read_text(encoding="utf-8") if self._text is None else self._text

    def to_dict(self) -> dict[str, Any]:
        """Returns the keys that the text states. Keys with default values are absent."""
        copy: dict[str, Any] = plain({k: v for k, v in self._keys().items() if v != []})
        return copy

    def check(self) -> Job:
        """Checks the present job, and returns it.

        Raises:
            Faults: every fault.
        """
        self._checked()
        return self

    def _checked(self) -> _engine._Job:
        if self._native is None:
            files = dict(self._files)
            if self._text is not None:
                files[self._path] = self._text.encode()
            object.__setattr__(self, "_native", _engine._Job(self._path, files))
        assert self._native is not None
        return self._native

    def _keys(self) -> dict[str, Any]:
        if self._table is None:
            object.__setattr__(self, "_table", json.loads(_engine.job_to_json(self._path, self.text)))
        assert self._table is not None
        return self._table

    def _view(self, value: Any, where: str, schema: Mapping[str, Any]) -> Any:
        if isinstance(value, dict):
            return Section(self, value, where, schema)
        if isinstance(value, list):
            return Items(self, value, where, schema)
        return value

    def _hold(self, name: str, table: Any) -> str:
        """Stores a table in memory as a CSV file of the job, and returns the name of the file."""
        self._files[in_folder(os.path.dirname(self._path), f"{name}.csv")] = csv_bytes(table)
        return f"{name}.csv"

    def _change(self, section: Section | None = None) -> None:
        if section is not None and section._absent:
            self._keys()[section._where] = section._table
        object.__setattr__(self, "_text", text_of({k: v for k, v in self._keys().items() if v != []}))
        object.__setattr__(self, "_native", None)

    # A type checker uses only the keys of `_keys.py`, and reports others.
    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name.startswith("_") or name not in _schema():
                raise AttributeError(f"a job has no `{name}`")
            table = self._keys()
            schema = _schema()[name]
            if name in table:
                return self._view(table[name], name, schema)
            if _is_section(name):
                return Section(self, {}, name, schema, absent=True)
            # An empty list, which becomes part of the job with its first entry.
            return Items(self, table.setdefault(name, []), name, schema) if "items" in schema else None

        def __setattr__(self, name: str, value: Any) -> None:
            if name not in _schema():
                raise AttributeError(f"a job has no `{name}`")
            if value is None:
                self._keys().pop(name, None)
            else:
                self._keys()[name] = plain(value)
            self._change()

        def __delattr__(self, name: str) -> None:
            setattr(self, name, None)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *_schema()]

    def __getitem__(self, name: str) -> Any:
        """Returns a key or section, as the attribute of this name."""
        try:
            return getattr(self, name) if name in _schema() else self._keys()[name]
        except AttributeError:
            raise KeyError(name) from None

    def __iter__(self) -> Iterator[str]:
        return (name for name, value in self._keys().items() if value != [])

    def __contains__(self, name: object) -> bool:
        return name in list(self)

    def __eq__(self, other: object) -> bool:
        """Whether both jobs have the same keys, folder and files in memory. Files on the disk are not compared."""
        if not isinstance(other, Job):
            return NotImplemented
        folder, others = (os.path.abspath(os.path.dirname(j._path)) for j in (self, other))
        return folder == others and self._files == other._files and self.to_dict() == other.to_dict()

    __hash__ = None  # type: ignore[assignment]

    def __getstate__(self) -> dict[str, Any]:
        return {"_path": self._path, "_text": self._text, "_files": self._files}

    def __setstate__(self, state: dict[str, Any]) -> None:
        for name, value in {**state, "_table": None, "_native": None}.items():
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        return f"Job({self._path!r})"


def _without_objects(job: Mapping[str, Any], folder: str | os.PathLike[str], files: dict[str, bytes]) -> Mapping[str, Any]:
    """Returns the job with tables and objects of pyNastran as files in memory."""
    job = dict(job)
    for section, keys in job.items():
        held = {k: v for k, v in keys.items() if is_table(v)} if isinstance(keys, Mapping) else {}
        for key, table in held.items():
            files[in_folder(folder, f"{section}_{key}.csv")] = csv_bytes(table)
        if held:
            job[section] = {**keys, **{key: f"{section}_{key}.csv" for key in held}}
    model = job.get("model")
    if not isinstance(model, Mapping):
        return job
    keys = dict(model)
    if is_deck(keys.get("deck")):
        files[in_folder(folder, "pynastran.bdf")] = deck_bytes(keys["deck"])
        keys["deck"] = "pynastran.bdf"
    results = keys.get("results")
    if results is not None:
        listed = list(results) if isinstance(results, (list, tuple)) else [results]
        for i, one in enumerate(listed):
            if is_results(one):
                files[in_folder(folder, f"pynastran_{i + 1}.op2")] = op2_bytes(one)
                listed[i] = f"pynastran_{i + 1}.op2"
        keys["results"] = listed
    return {**job, "model": keys}


def job_of(job: Job | str | os.PathLike[str] | Mapping[str, Any]) -> Job:
    """Returns the job: the same object, or one that is read from a file or created from a dictionary."""
    if isinstance(job, Job):
        return job
    if isinstance(job, Mapping):
        return Job.from_dict(job)
    return Job.read(job)
