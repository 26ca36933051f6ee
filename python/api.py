"""Writes the page of the Python package's names from their docstrings: `python python/api.py > docs/reference/python-api.md`."""

import inspect
import re
import sys

import strainbridge as sb

#: Names by subject. `page` fails if a name is missing.
SUBJECTS = {
    "Bare arrays": ["place_rows", "Placement", "relax", "Relaxation", "recover_rows", "RecoveredRows", "calibrate_rows", "CalibratedRows", "strain_along", "rainflow"],
    "Jobs": ["Job", "Plan"],
    "Commands": [
        "check", "init", "strains", "cases", "solve", "modes", "sensitivity", "place", "recover", "respond", "payload", "ballast", "study", "identify",
        "simulate", "reconcile", "calibrate", "verify", "clean", "explain", "fleet",
    ],
    "Outcomes": ["Outcome", "Record", "Finding", "UnreliableWarning", "Table", "Mesh", "Fault", "Faults"],
    "Decks, results, models": ["Deck", "Results", "Strain", "write_op2", "Model"],
}


def signature(name: str, what: object, bound: bool) -> str:
    """Returns the call, with types as in the source."""

    def one(p: inspect.Parameter) -> str:
        star = {p.VAR_POSITIONAL: "*", p.VAR_KEYWORD: "**"}.get(p.kind, "")
        kind = "" if p.annotation is p.empty else f": {p.annotation}"
        default = "" if p.default is p.empty else f" = {p.default!r}"
        return f"{star}{p.name}{kind}{default}"

    found = inspect.signature(what)
    shown, free = [], False
    for i, p in enumerate(found.parameters.values()):
        if bound and i == 0:
            continue
        if p.kind == p.KEYWORD_ONLY and not free:
            shown.append("*")
        free = free or p.kind in (p.KEYWORD_ONLY, p.VAR_POSITIONAL)
        shown.append(one(p))
    back = "" if found.return_annotation is found.empty else f" -> {found.return_annotation}"
    return f"{name}({', '.join(shown)}){back}"


def text(what: object) -> str:
    """Returns a docstring as Markdown: double backticks of reST become single, sections become bold."""
    doc = inspect.getdoc(what) or ""
    doc = re.sub(r":(?:class|func|meth|attr):`(?:strainbridge\.)?([^`]*)`", r"`\1`", doc)
    doc = doc.replace("``", "`")
    lines, section = [], False
    for line in doc.splitlines():
        head = re.fullmatch(r"(Args|Returns|Raises|Reference):", line)
        if head:
            section = True
            lines += [f"*{head[1]}*", ""]
        elif section and re.match(r"    \S", line):
            lines.append("- " + line.strip())
        elif section and re.match(r"     +\S", line):
            lines.append("  " + line.strip())
        else:
            lines.append(line)
    return "\n".join(lines)


def fields(cls: type) -> list[str]:
    """Returns attributes with the comments above them."""
    out, said = [], []
    for line in inspect.getsource(cls).splitlines():
        comment = re.fullmatch(r"    #: (.*)", line)
        named = re.match(r"    (\w+): ([^=]+?)(?: = .*)?$", line)
        if comment:
            said.append(comment[1])
        elif named and said:
            out.append(f"- `{named[1]}: {named[2]}`: {' '.join(said)}")
            said = []
        else:
            said = []
    return out


def entry(name: str) -> list[str]:
    what = getattr(sb, name)
    if inspect.ismodule(what):
        functions = [n for n, f in vars(what).items() if inspect.isfunction(f) and f.__module__ == what.__name__ and not n.startswith("_")]
        out = [f"### {name}", "", text(what), ""]
        for n in functions:
            out += [f"#### {name}.{n}", "", f"`{signature(f'{name}.{n}', getattr(what, n), False)}`", "", text(getattr(what, n)), ""]
        return out
    if not inspect.isclass(what):
        return [f"### {name}", "", f"`{signature(name, what, False)}`", "", text(what), ""]
    out = [f"### {name}", "", text(what), ""]
    listed = fields(what)
    if listed:
        out += [*listed, ""]
    for n, member in vars(what).items():
        if n.startswith("_") and n not in ("__arrow_c_stream__",):
            continue
        if isinstance(member, property):
            kind = inspect.signature(member.fget).return_annotation
            out += [f"- `{n}: {kind}`: {text(member.fget)}", ""]
        elif isinstance(member, classmethod):
            out += [f"#### {name}.{n}", "", f"`{signature(f'{name}.{n}', member.__func__, True)}`", "", text(member.__func__), ""]
        elif inspect.isfunction(member):
            out += [f"#### {name}.{n}", "", f"`{signature(f'{name}.{n}', member, True)}`", "", text(member), ""]
    return out


def page() -> str:
    """Returns the page."""
    left_out = set(sb.__all__) - {n for names in SUBJECTS.values() for n in names}
    assert not left_out, f"give a subject to {sorted(left_out)}"
    lines = ["# Python, name by name", "", "Made from the docstrings by `python python/api.py > docs/reference/python-api.md`. By task: [Python](python.md).", ""]
    for subject, names in SUBJECTS.items():
        lines += [f"## {subject}", ""]
        for name in names:
            lines += entry(name)
    made = "\n".join(line.rstrip() for line in lines)
    return re.sub(r"\n{3,}", "\n\n", made).strip() + "\n"


if __name__ == "__main__":
    sys.stdout.write(page())
