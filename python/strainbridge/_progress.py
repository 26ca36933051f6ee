"""Progress as a bar of tqdm, if it is installed."""

from __future__ import annotations

from contextlib import contextmanager
from typing import Any, Callable, Iterator, Optional, Union

Told = Optional[Callable[[str, int, int], object]]


@contextmanager
def shown(progress: Union[bool, Told]) -> Iterator[Told]:
    """Yields the receiver of progress: the given function, or for True a bar that is closed at the end.

    Raises:
        ImportError: a bar is requested and tqdm is not installed.
    """
    if not isinstance(progress, bool):
        yield progress
        return
    if not progress:
        yield None
        return
    try:
        from tqdm.auto import tqdm  # type: ignore[import-untyped, unused-ignore]
    except ImportError as e:
        raise ImportError("progress=True needs tqdm: pip install tqdm, or pass a function of stage, done, total") from e
    bar: Any = tqdm(total=0, leave=False)

    def report(stage: str, done: int, total: int) -> None:
        if (stage, total) != (bar.desc.rstrip(": "), bar.total):
            bar.reset(total=total)
            bar.set_description(stage, refresh=False)
        bar.n = done
        bar.refresh()

    try:
        yield report
    finally:
        bar.close()
