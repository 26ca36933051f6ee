"""Converts a dictionary to the text of a job."""

from __future__ import annotations

import json
import os
import re
from typing import Any, Mapping

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def plain(value: Any) -> Any:
    """Converts a value to numbers, texts, lists and dictionaries. It accepts scalars and arrays of numpy, paths and tuples."""
    if isinstance(value, Mapping):
        return {str(k): plain(v) for k, v in value.items() if v is not None}
    if isinstance(value, (str, bool, int, float)):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, (list, tuple, set, frozenset, range)):
        return [plain(v) for v in value]
    raise TypeError(f"a job contains numbers, texts, lists and dictionaries, not {type(value).__name__}")


def text_of(job: Mapping[str, Any]) -> str:
    """Returns the text of a job: values first, followed by the sections, with one line for each key."""
    lines: list[str] = []
    sections: list[str] = []
    for key, value in plain(job).items():
        if isinstance(value, dict):
            sections += ["", f"[{_key(key)}]", *_lines(value)]
        elif isinstance(value, list) and value and all(isinstance(v, dict) for v in value):
            for one in value:
                sections += ["", f"[[{_key(key)}]]", *_lines(one)]
        else:
            lines.append(f"{_key(key)} = {_value(value)}")
    return "\n".join(lines + sections) + "\n"


def _lines(table: Mapping[str, Any]) -> list[str]:
    return [f"{_key(k)} = {_value(v)}" for k, v in table.items()]


def _key(key: str) -> str:
    return key if _BARE.fullmatch(key) else _text(key)


def _text(value: str) -> str:
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    return "{ " + ", ".join(_lines(value)) + " }"
