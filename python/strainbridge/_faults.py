"""Faulty input, with every fault."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Iterable, Optional, Tuple

from ._words import in_python

Parts = Tuple[str, Optional[int], str, str, str]


@dataclass(frozen=True)
class Fault:
    """One fault of the input."""

    #: File as given, or the name of a function if an argument is wrong.
    file: str
    #: Line, from 1. None if the fault concerns the whole file.
    line: int | None
    #: Key of a job, field of a card, column of a table, argument.
    field: str
    #: What is wrong.
    wrong: str
    #: What to do.
    remedy: str

    def __str__(self) -> str:
        line = "" if self.line is None else f"{self.line}:"
        return f"{self.file}:{line} {self.field}: {self.wrong}: {self.remedy}"


class Faults(ValueError):
    """Faulty input. ``.faults`` contains every fault, at least one."""

    faults: tuple[Fault, ...]

    def __init__(self, faults: Iterable[Parts]) -> None:
        listed: list[Parts] = [(f, line, in_python(key, f), in_python(wrong, f), in_python(remedy, f)) for f, line, key, wrong, remedy in faults]
        super().__init__(listed)
        self.faults = tuple(Fault(*f) for f in listed)

    def __str__(self) -> str:
        n = len(self.faults)
        return "\n".join([*map(str, self.faults), f"{n} fault{'' if n == 1 else 's'} found"])
