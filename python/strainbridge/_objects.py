"""Records in object stores, through fsspec. While the engine reads a record, the folder of the results contains a copy of it."""

from __future__ import annotations

import hashlib
import json
import os
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Iterator, Mapping, Sequence

from ._faults import Faults

#: Folders within the folder of the results: copies for reading, and the state of each object with a stored result.
_COPIES, _STATES = "records", "objects"


def is_object(file: str) -> bool:
    """Returns whether a path is a URL, such as ``s3://bucket/T1_2026-05-01.parquet``."""
    scheme, separator, _ = file.partition("://")
    return bool(separator) and scheme.replace("+", "").replace("-", "").isalnum()


def local_name(url: str, out: str) -> str:
    """Returns the path of the copy of an object. All workers and the results use the same path.

    Raises:
        Faults: the URL refers to a place outside the folder.
    """
    scheme, _, rest = url.partition("://")
    parts = [p for p in rest.replace("\\", "/").split("/") if p]
    if not parts or ".." in parts:
        raise Faults([(url, None, "files", "the URL names no object", "give scheme, bucket and key: s3://bucket/T1_2026-05-01.parquet")])
    if is_pattern(rest):
        # The engine would read the path of the copy as a pattern.
        raise Faults([(url, None, "files", "no object has this name, or it has a sign of a pattern: * ? [", "check bucket and key, or rename the object")])
    return os.path.join(out, _COPIES, scheme, *parts)


def is_pattern(path: str) -> bool:
    """Returns whether a path contains a sign of a pattern."""
    return any(sign in path for sign in "*?[")


def matching(url: str) -> list[str]:
    """Returns the URLs of the objects that match a pattern.

    Raises:
        Faults: no object matches.
    """
    system, path = _opened(url)
    scheme, _, rest = url.partition("://")
    found = [p for p in system.glob(path) if system.isfile(p)]
    if not found:
        raise Faults([(url, None, "files", "no object matches the pattern", "check bucket and key")])
    return [f"{scheme}://{p if rest.startswith('/') else p.lstrip('/')}" for p in found]


def _opened(url: str) -> tuple[Any, str]:
    """Returns the file system of a URL, and the path in it."""
    try:
        import fsspec  # type: ignore[import-untyped, import-not-found, unused-ignore]
    except ImportError as e:
        raise ImportError("records in an object store need fsspec: pip install fsspec, and the package of the store (s3fs, gcsfs, adlfs)") from e
    system, path = fsspec.core.url_to_fs(url)
    return system, path


def _state_file(url: str, out: str) -> Path:
    return Path(out, _STATES, f"{hashlib.sha256(url.encode()).hexdigest()}.json")


def known_digests(urls: Sequence[str], out: str) -> dict[str, str]:
    """Returns the SHA-256 by URL of objects that were read before and have not changed since."""
    found = {}
    for url in urls:
        state = _state_file(url, out)
        if not state.exists():
            continue
        kept = json.loads(state.read_text(encoding="utf-8"))
        system, path = _opened(url)
        try:
            same = kept["state"] == str(system.ukey(path))
        except FileNotFoundError:
            same = False
        if same:
            found[url] = str(kept["sha256"])
    return found


def forget(url: str, out: str) -> None:
    """Removes the stored state of an object, so that it is read again."""
    _state_file(url, out).unlink(missing_ok=True)


@contextmanager
def copies(urls: Sequence[str], out: str) -> Iterator[dict[str, str]]:
    """Copies objects into `out` and removes the copies afterwards. Yields the state of each object before it was copied, by URL.

    Raises:
        Faults: every object that does not exist.
    """
    states: dict[str, str] = {}
    made: list[Path] = []
    faults = []
    try:
        for url in urls:
            system, path = _opened(url)
            to = Path(local_name(url, out))
            to.parent.mkdir(parents=True, exist_ok=True)
            part = to.with_name(f"{to.name}.{os.getpid()}.part")
            try:
                states[url] = str(system.ukey(path))
                system.get_file(path, os.fspath(part))
            except FileNotFoundError:
                part.unlink(missing_ok=True)
                faults.append((url, None, "files", "the object does not exist, or this worker has no access to it", "check bucket, key and credentials"))
                continue
            os.replace(part, to)
            made.append(to)
        if faults:
            raise Faults(faults)
        yield states
    finally:
        for copy in made:
            copy.unlink(missing_ok=True)
            _remove_empty(copy.parent, Path(out))


def keep_states(states: Mapping[str, str], digests: Mapping[str, str], out: str) -> None:
    """Stores the state of objects with their SHA-256, so that a later run copies only changed objects."""
    for url, state in states.items():
        if not digests.get(url):
            continue
        to = _state_file(url, out)
        to.parent.mkdir(parents=True, exist_ok=True)
        part = to.with_name(f"{to.name}.{os.getpid()}.part")
        part.write_text(json.dumps({"url": url, "state": state, "sha256": digests[url]}), encoding="utf-8")
        os.replace(part, to)


def _remove_empty(folder: Path, top: Path) -> None:
    """Removes a folder if it is empty, and the empty folders above it up to `top`."""
    while folder != top and top in folder.parents:
        try:
            folder.rmdir()
        except OSError:
            return
        folder = folder.parent
