"""The engine."""

import os
from typing import Any, Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

_Path = str | os.PathLike[str]

class _Job:
    def __new__(cls, path: _Path, files: Mapping[str, bytes] = ...) -> _Job: ...

class _Outcome:
    @property
    def json(self) -> str: ...
    @property
    def words(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    def save(self, folder: _Path) -> str: ...

def ask(
    command: str,
    job: _Job | None = None,
    *,
    files: Sequence[_Path] = ...,
    folder: _Path = ...,
    modes: int = 0,
    total_strain: bool = False,
    shard: str | None = None,
    threads: int | None = None,
    cache: bool = True,
    progress: Callable[[str, int, int], object] | None = None,
) -> _Outcome: ...
def commands() -> list[str]: ...
def schema() -> str: ...
def job_to_json(path: str, text: str) -> str: ...
def place_rows(
    s: NDArray[np.float64], n: int, spacing: float | None, positions: NDArray[np.float64] | None, proof: bool, threads: int | None
) -> dict[str, Any]: ...
def recover_rows(s: NDArray[np.float64], strain: NDArray[np.float64], noise: float, threads: int | None) -> dict[str, Any]: ...
def rainflow(signal: NDArray[np.float64]) -> NDArray[np.float64]: ...
def _fail(threads: int | None = None) -> int: ...
