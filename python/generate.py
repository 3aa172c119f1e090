#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes sagitta/surfaces.py: a class for each type of the library's own table, sgt_builtins; and
sagitta/_analyses.pyi: what an editor and mypy know of each analysis, from the library's tables (study.h).

    SAGITTA_PYTHON_LIBRARY=BUILD/python/libsagitta_python.so python3 python/generate.py [--check]

They are files and not made as the package is loaded, so that an editor and mypy know the parameters, as
arguments and as attributes.  All are given by their names; those of POSITIONAL may be given in that order,
too.  With --check they are compared, and not written; the suite `python` does that.
"""
import keyword
import pathlib
import sys
import textwrap
import types

here = pathlib.Path(__file__).resolve().parent
SURFACES, ANALYSES = here / "sagitta" / "surfaces.py", here / "sagitta" / "_analyses.pyi"
sys.path.insert(0, str(here))

HEAD = '''"""The types of the catalogue.  Written by python/generate.py from the library's own table.

docs/surfaces.md and surfaces.h say more of each.  Lengths have any one unit.  A parameter that is not given
has its default, 0 or none.  `semi_diameter` is the radius of the rim; 0: none.
"""
from __future__ import annotations

from typing import Literal, Optional, Sequence

from numpy.typing import ArrayLike

from ._tables import Floats
from .surface import CLASSES, Catalogue
'''

POSITIONAL = {
    "sphere": ("radius",),
    "conic": ("radius", "conic"),
    "cylinder": ("radius", "conic"),
    "even_asphere": ("radius", "conic", "coefficients"),
    "odd_asphere": ("radius", "conic", "coefficients"),
    "torus": ("major", "minor"),
    "ellipsoid": ("a", "f"),
}


def class_name(of_type):
    return "".join(word.capitalize() for word in of_type.split("_"))


def unit(p):
    u = p.unit
    if not (u.length or u.by_i or u.by_j):
        return ""
    power = str(u.length) if u.length else ""
    for factor, index in ((u.by_i, "i"), (u.by_j, "j")):
        if factor:
            sign = " - " if factor < 0 else " + "
            term = index if abs(factor) == 1 else f"{abs(factor)} {index}"
            power = f"{power}{sign}{term}" if power else f"-{term}" if factor < 0 else term
    return (
        "length"
        if power == "1"
        else f"length^({power})"
        if not power.lstrip("-").isdigit()
        else f"length^{power}"
    )


def described(p, C):
    """The type of the argument, its default, what it is; the type of the attribute."""
    said = [unit(p)] if unit(p) else []
    if p.kind == C.TERMS:
        what = f"up to {p.count} surfaces, whose departures are added"
        return "Sequence[Catalogue]", "()", what, "tuple[Catalogue, ...]"
    if p.kind == C.WORD:
        words = ", ".join(f'"{w}"' for w in p.words.decode().split("|"))
        return f"Optional[Literal[{words}]]", "None", "one of " + words, f"Optional[Literal[{words}]]"
    if p.kind == C.TRUTH:
        return "bool", "False", "True or False", "bool"
    if p.kind == C.WHOLE:
        return "Optional[int]", "None", f"a whole number from {p.lo:g} to {p.hi:g}", "int"
    if p.kind == C.TABLE:
        return (
            "Optional[ArrayLike]",
            "None",
            "; ".join([f"a table of up to {p.count} rows and columns", *said]),
            "Floats",
        )
    if p.kind == C.LIST or (p.kind == C.REAL and p.count > 1):
        return "Optional[ArrayLike]", "None", "; ".join([f"up to {p.count} numbers", *said]), "Floats"
    if p.kind == C.VECTOR:
        return "Optional[ArrayLike]", "None", "; ".join([f"{p.count} numbers", *said]), "Floats"
    if p.hi < 1e300:
        said.append(f"{p.lo:g} to {p.hi:g}")
    return "Optional[float]", "None", "; ".join(said or ["a number"]), "float"


def wrapped(begin, items, end, indent):
    """begin item, item, ... end, on as many lines as it takes."""
    lines = [" " * indent + begin]
    for i, item in enumerate(items):
        item += end if i == len(items) - 1 else ","
        space = "" if lines[-1][-1] in "([" else " "
        if len(lines[-1] + space + item) > 108:
            lines.append(" " * (indent + len(begin)) + item)
        else:
            lines[-1] += space + item
    return lines


def written():
    # The package without the file that is to be written, which may be missing or wrong.
    sys.modules["sagitta.surfaces"] = types.ModuleType("sagitta.surfaces")
    sys.modules["sagitta.surfaces"].__all__ = []
    from sagitta import _library as C
    from sagitta import surface

    parts, names = [HEAD], []
    for of_type, row in surface.BUILTINS.items():
        lines, arguments, passed, attributes = [], {}, [], []
        for p in surface.params_of(row):
            name = p.name.decode()
            hint, default, what, attribute = described(p, C)
            if name.startswith("curvature"):
                radius = name.replace("curvature", "radius")
                lines.append((radius, f"length; 1 / {name}, math.inf is flat.  Or give the {name}"))
                arguments[radius] = f"{radius}: {hint} = {default}"
                passed.append(radius)
                attributes.append(f"    {radius}: {attribute}")
            lines.append((name, what))
            arguments[name] = f"{name}: {hint} = {default}"
            passed.append(name)
            if not hasattr(surface.Surface, name):  # (as a grid's sag, which is a method, too)
                attributes.append(f"    {name}: {attribute}")
        wide = max((len(name) for name, _ in lines), default=0)
        name = class_name(of_type)
        names.append((of_type, name))
        formula, where = formulas().get(of_type, ("", ""))
        title = f"{formula}; {where}." if formula else f"The type {of_type}."
        text = [
            f"\n\nclass {name}(Catalogue):",
            *textwrap.wrap(f'"""{title}', 108, initial_indent="    ", subsequent_indent="    "),
            "",
        ]
        text += [f"    {n:{wide}}  {what}" for n, what in lines]
        first = POSITIONAL.get(of_type, ())
        rest = [a for n, a in arguments.items() if n not in first]
        order = [*(arguments[n] for n in first), *(["*"] if rest else []), *rest]
        text += ['    """', f'    type = "{of_type}"', *attributes, ""]
        text += wrapped("def __init__(", ["self", *order], ") -> None:", 4)
        text += wrapped("self._make(dict(", [f"{n}={n}" for n in passed], "))", 8)
        parts.append("\n".join(text))
    parts.append(
        "\n\n_ALL: tuple[type[Catalogue], ...] = (\n"
        + "\n".join(
            textwrap.wrap(
                ", ".join(n for _, n in names), 104, initial_indent="    ", subsequent_indent="    "
            )
        )
        + ")\nCLASSES.update((c.type, c) for c in _ALL)\n"
    )
    parts.append(
        "\n__all__ = [\n"
        + "\n".join(
            textwrap.wrap(
                ", ".join(f'"{n}"' for _, n in names), 104, initial_indent="    ", subsequent_indent="    "
            )
        )
        + ",\n]\n"
    )
    return "\n".join(parts[:1]) + "\n".join(parts[1:-2]) + "\n" + "".join(parts[-2:])


def formulas():
    """Formula and domain of each type, as docs/surfaces_types.py reads them from the list of types."""
    import re

    text = (here.parent / "src" / "types.def").read_text()
    found = {}
    for row in re.finditer(
        r'^TYPE\(\w+, (\w+),.*?SAYS\(((?:"[^"]*"\s*)+)\)\s*,\s*((?:"[^"]*"\s*)+),',
        text,
        re.MULTILINE | re.DOTALL,
    ):
        join = lambda s: "".join(re.findall(r'"([^"]*)"', s))
        found[row[1]] = join(row[2]), join(row[3])
    return found


ANALYSES_HEAD = '''"""The analyses as methods of Lens.  Written by python/generate.py from the library's tables.

study.py makes these methods when the package is loaded; this is for editors and for mypy.  Each answers with
an Answer; the classes here only say which columns it has, and of which type each is.
"""
from typing import Literal, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack

from ._tables import Floats
from .study import Answer, Asking, Field, Wavelength
'''


def setting_type(setting, study, C):
    listed = C.text(setting.words).split("|") if setting.kind == study._WORD else ()
    words = ", ".join(f'"{w}"' for w in listed)
    return {
        study._FLAG: "bool",
        study._SETTING_COUNT: "Optional[int]",
        study._WORD: f"Optional[Literal[{words}]]",
        study._ONE_NUMBER: "Optional[float]",
        study._NUMBERS: "Optional[ArrayLike]",
        study._TEXT: "Optional[str]",
    }[setting.kind]


def analyses():
    from sagitta import _library as C
    from sagitta import study

    parts, methods = [ANALYSES_HEAD], ["\n\nclass Analyses:"]
    count, fate = "NDArray[np.uintp]", "NDArray[np.intc]"
    kinds = {study._COUNT: count, study._PLACE: count, study._FATE: fate, study._VERDICT: fate, study._QUANTITY: fate}
    for analysis in study.analyses():
        name = class_name(C.text(analysis.name)) + "Answer"
        parts.append(f"\n\nclass {name}(Answer):")
        for column in analysis.column[: analysis.columns]:
            parts.append(f"    {C.text(column.name)}: {kinds.get(column.kind, 'Floats')}")
        arguments = ["self"]
        if not analysis.no_fields:
            arguments.append("field: Optional[Field] = None")
        arguments.append("wavelength: Union[Wavelength, Sequence[Wavelength]] = None")
        if analysis.no_fields:
            arguments.insert(1, "field: None = None")
        settings = [x for x in analysis.setting[: analysis.settings] if not keyword.iskeyword(C.text(x.name))]
        if settings:
            arguments.append("*")
        for setting in settings:
            hint = setting_type(setting, study, C)
            arguments.append(f"{C.text(setting.name)}: {hint} = {'False' if hint == 'bool' else 'None'}")
        arguments.append("**asked: Unpack[Asking]")
        methods += wrapped(f"def {C.text(analysis.name)}(", arguments, f") -> {name}: ...", 4)
    # Columns by the types that they have in all analyses, for answer["name"].
    types = {}
    for analysis in study.analyses():
        for column in analysis.column[: analysis.columns]:
            types.setdefault(C.text(column.name), set()).add(kinds.get(column.kind, "Floats"))
    names = []
    for alias, hint in (("Reals", "Floats"), ("Counts", count), ("FatesOfRays", fate)):
        names += ["", *wrapped(f"{alias} = Literal[", [f'"{n}"' for n, t in types.items() if t == {hint}], "]", 0)]
    return "\n".join(parts[:1] + names + parts[1:] + methods) + "\n"


def main():
    texts = {SURFACES: written(), ANALYSES: analyses()}
    long = [line for text in texts.values() for line in text.splitlines() if len(line) > 110]
    if long:
        print("too long:", *long, sep="\n")
        return 1
    for target, text in texts.items():
        if "--check" not in sys.argv[1:]:
            target.write_text(text)
        elif not target.exists() or target.read_text() != text:
            print(f"{target} is not what python/generate.py writes: run it")
            return 1
        else:
            print(f"{target.name}: as the library has it")
    return 0


if __name__ == "__main__":
    sys.exit(main())
