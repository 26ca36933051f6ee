"""Writes the typed keys of a job: python python/keys.py > python/strainbridge/_keys.py

Editors and type checkers read them. They come from the schema of a job, and a test compares them with the schema."""

import json
import keyword
import textwrap
from typing import Any

from strainbridge import _strainbridge as engine

QUOTES = '"' * 3

HEAD = f"""{QUOTES}Keys of a job by section, for editors and type checkers. Made by `python python/keys.py`.{QUOTES}

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._section import Items, Section

if TYPE_CHECKING:
    from ._section import _Key
"""


def described(schema: dict[str, Any]) -> list[str]:
    """Returns the docstring of a key."""
    words = str(schema.get("description", "")).replace("\\", "\\\\").replace('"', "'").strip()
    if not words:
        return []
    lines = textwrap.wrap(QUOTES + words.rstrip(".") + "." + QUOTES, 140, break_long_words=False)
    return [f"    {line}" for line in lines]


def class_of(name: str) -> str:
    return "".join(part.capitalize() for part in name.split("_")) + "Keys"


def text() -> str:
    """Returns the module."""
    schema: dict[str, Any] = json.loads(engine.schema())["properties"]
    out = [HEAD]
    top = []
    for name, section in schema.items():
        keys = section.get("items", section).get("properties")
        kind = "Any" if keys is None else f"Items[{class_of(name)}]" if "items" in section else class_of(name)
        top += [f"    {name}: _Key[{kind}]", *described(section)]
        if keys is None:
            continue
        out += ["", f"class {class_of(name)}(Section):", f"    {QUOTES}Keys of ``{name}``.{QUOTES}", ""]
        for key, what in keys.items():
            if key.isidentifier() and not keyword.iskeyword(key):
                out += [f"    {key}: _Key[Any]", *described(what)]
        out.append("")
    out += ["", "class Keys:", f"    {QUOTES}Sections and keys of a job.{QUOTES}", "", *top]
    return "\n".join(out) + "\n"


if __name__ == "__main__":
    print(text(), end="")
