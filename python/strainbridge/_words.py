"""Replaces words of the command and of job files by the words of the Python package."""

from __future__ import annotations

import json
import re
from functools import lru_cache
from typing import Any

#: Functions on arrays, which have no job.
_OF_ARRAYS = ("place_rows", "relax", "recover_rows")

#: Words of a job that have another meaning for arrays.
_ARRAYS = (
    (re.compile(r"gauges among these candidates separate"), "rows of S separate"),
    (re.compile(r"ask for at least (\d+) gauges"), r"give n of at least \1"),
    (re.compile(r"drop loads with the same effect, or state `expected` for loads with role \"nuisance\""), "or leave out columns of S with the same effect"),
    (re.compile(r"gauges are asked for and the candidates contain (\d+) places"), r"rows are asked for and S has \1"),
    (re.compile(r"widen \[candidates\]"), "give more rows"),
)

#: Options of the command, with the corresponding argument of a call.
_OPTIONS = (
    (re.compile(r" with `?--out`?(?: DIR)?"), ""),
    (re.compile(r"`?strainbridge explain --list`?"), "`strainbridge.explain()`"),
    (re.compile(r"`?--no-cache`?"), "`cache=False`"),
    (re.compile(r"`?--kept`?"), "`out`"),
    (re.compile(r"`?--shard`?"), "`shard`"),
    (re.compile(r"`?--digests`?"), "`digests`"),
    (re.compile(r"`?--threads`?"), "`threads`"),
)

_SECTION = re.compile(r"\[\[?([a-z_]+)\]\]?(?: ([a-z_]+)\b)?")


@lru_cache(maxsize=None)
def _keys() -> dict[str, set[str]]:
    """Returns the keys of each section of a job."""
    from . import _strainbridge as engine

    schema: dict[str, Any] = json.loads(engine.schema())["properties"]
    return {name: set(section.get("items", section).get("properties") or ()) for name, section in schema.items()}


def in_python(text: str, function: str = "") -> str:
    """Returns the text with attributes of a job instead of sections, and arguments instead of options.

    ``[measured] time_unit`` becomes ``job.measured.time_unit``. A unit in brackets is unchanged."""
    if function in _OF_ARRAYS:
        for word, other in _ARRAYS:
            text = word.sub(other, text)
    for option, other in _OPTIONS:
        text = option.sub(other, text)
    return _SECTION.sub(_attribute, text)


def _attribute(found: re.Match[str]) -> str:
    section, key = found.groups()
    keys = _keys().get(section)
    if not keys:
        return found.group(0)
    if key is None:
        return f"job.{section}"
    one = found.group(0).startswith("[[")
    return f"job.{section}.{key}" if key in keys and not one else f"job.{section}, {key}" if key in keys else f"job.{section} {key}"
