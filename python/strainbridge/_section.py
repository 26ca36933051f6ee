"""Sections of a job, with their keys as attributes."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, Generic, Iterable, Iterator, Mapping, MutableSequence, TypeVar, overload

from ._data import is_table
from ._toml import plain

if TYPE_CHECKING:
    from ._job import Job

T_co = TypeVar("T_co", covariant=True)

if TYPE_CHECKING:

    class _Key(Generic[T_co]):
        """A key for a type checker. Its value is `T_co`, and it also accepts dictionaries, lists and tables."""

        @overload
        def __get__(self, instance: None, owner: type) -> _Key[T_co]: ...
        @overload
        def __get__(self, instance: object, owner: type) -> T_co: ...
        def __get__(self, instance: Any, owner: type) -> Any: ...
        def __set__(self, instance: object, value: Any) -> None: ...
        def __delete__(self, instance: object) -> None: ...


def keys_of(schema: Mapping[str, Any]) -> Mapping[str, Any] | None:
    """Returns the keys that a section may have, or None if any name is a key, as in a table of columns."""
    if "items" in schema:
        schema = schema["items"]
    keys: Mapping[str, Any] | None = schema.get("properties")
    return keys


class Section:
    """Section of a job. Its keys are attributes and items, and can be set.

    ``del`` removes a key, and an absent key is None. A name that no section of this kind has raises ``AttributeError`` with the closest name. A key
    that names a table may contain the table: a DataFrame, or another object with ``__arrow_c_stream__``."""

    __slots__ = ("_job", "_table", "_where", "_schema", "_absent")

    if TYPE_CHECKING:
        _job: Job
        _table: dict[str, Any]
        _where: str
        _schema: Mapping[str, Any]
        _absent: bool

    def __init__(self, job: Job, table: dict[str, Any], where: str, schema: Mapping[str, Any], absent: bool = False) -> None:
        object.__setattr__(self, "_job", job)
        object.__setattr__(self, "_table", table)
        object.__setattr__(self, "_where", where)
        object.__setattr__(self, "_schema", schema)
        # Whether the section is absent from the job until a key is set.
        object.__setattr__(self, "_absent", absent)

    def _known(self, name: str) -> Mapping[str, Any]:
        """Returns the schema of a key.

        Raises:
            AttributeError: no section of this kind has the key.
        """
        return known(self._schema, self._where, name)

    # A type checker uses only the keys of `_keys.py`, and reports others.
    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name.startswith("_"):
                raise AttributeError(name)
            schema = self._known(name)
            if name not in self._table and keys_of(self._schema) is None:
                raise AttributeError(f"`{self._where}` has no key `{name}`")
            return self._job._view(self._table.get(name), f"{self._where}.{name}", schema)

        def __setattr__(self, name: str, value: Any) -> None:
            self._known(name)
            if is_table(value):
                value = self._job._hold(f"{self._where}_{name}".replace(".", "_"), value)
            self._table[name] = plain(value)
            self._job._change(self)

        def __delattr__(self, name: str) -> None:
            self._known(name)
            if name not in self._table:
                raise AttributeError(f"`{self._where}.{name}` is not set")
            del self._table[name]
            self._job._change(self)

    def __getitem__(self, name: str) -> Any:
        if name not in self._table:
            raise KeyError(name)
        return getattr(self, name)

    def __setitem__(self, name: str, value: Any) -> None:
        setattr(self, name, value)

    def __delitem__(self, name: str) -> None:
        delattr(self, name)

    def get(self, name: str, default: Any = None) -> Any:
        """Returns the value of a key, or `default` if it is not set."""
        return self[name] if name in self._table else default

    def keys(self) -> list[str]:
        """Returns the keys that are set."""
        return list(self._table)

    def __contains__(self, name: str) -> bool:
        return name in self._table

    def __iter__(self) -> Iterator[str]:
        return iter(self._table)

    def __len__(self) -> int:
        return len(self._table)

    def __eq__(self, other: object) -> bool:
        return bool(self._table == (other._table if isinstance(other, Section) else other))

    __hash__ = None  # type: ignore[assignment]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(keys_of(self._schema) or self._table)]

    def __repr__(self) -> str:
        return repr(self._table)


def known(schema: Mapping[str, Any], where: str, name: str) -> Mapping[str, Any]:
    """Returns the schema of a key of a section, or an empty one if the section has keys of any name.

    Raises:
        AttributeError: no section of this kind has the key.
    """
    keys = keys_of(schema)
    if keys is None:
        return {}
    if name not in keys:
        close = get_close_matches(name, keys, n=1)
        hint = f"; did you mean `{close[0]}`?" if close else f", but {', '.join(keys)}"
        raise AttributeError(f"`{where}` has no key `{name}`{hint}")
    found: Mapping[str, Any] = keys[name]
    return found


class Items(MutableSequence[Any], Generic[T_co]):
    """List of a job, changed in place: ``job.load.append({...})``."""

    __slots__ = ("_job", "_list", "_where", "_schema")

    def __init__(self, job: Job, values: list[Any], where: str, schema: Mapping[str, Any]) -> None:
        self._job, self._list, self._where, self._schema = job, values, where, schema

    @overload
    def __getitem__(self, at: int) -> T_co: ...
    @overload
    def __getitem__(self, at: slice) -> list[T_co]: ...
    def __getitem__(self, at: Any) -> Any:
        if isinstance(at, slice):
            return [self[i] for i in range(*at.indices(len(self._list)))]
        return self._job._view(self._list[at], self._where, self._schema)

    def __setitem__(self, at: Any, value: Any) -> None:
        self._list[at] = [self._entry(v) for v in value] if isinstance(at, slice) else self._entry(value)
        self._job._change()

    def _entry(self, value: Any) -> Any:
        """Returns a value for the list.

        Raises:
            TypeError: the list holds sections, and the value is not one.
            AttributeError: no section of this kind has a key of the value.
        """
        if keys_of(self._schema) is not None:
            if not isinstance(value, (Mapping, Section)):
                raise TypeError(f"`{self._where}` holds sections: give a dictionary, not {value!r}")
            for name in value.keys():
                known(self._schema, self._where, name)
        return plain(value)

    def __delitem__(self, at: Any) -> None:
        del self._list[at]
        self._job._change()

    def __iter__(self) -> Iterator[T_co]:
        return (self[i] for i in range(len(self)))

    def insert(self, index: int, value: Any) -> None:
        """Inserts a value before the one at `index`."""
        self._list.insert(index, self._entry(value))
        self._job._change()

    def __len__(self) -> int:
        return len(self._list)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Items):
            return self._list == other._list
        return isinstance(other, Iterable) and self._list == plain(list(other))

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return repr(self._list)


