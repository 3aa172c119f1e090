# SPDX-License-Identifier: MIT
"""The structs of _library.py against the compiler's: every member, its offset and its size."""
import ctypes
import re

import sagitta
from sagitta import _library as C
from sagitta.lens import _dtype
from sagitta.results import HIT_TABLE, STEP_TABLE, Hit


def camel(name):
    return "".join(
        word.capitalize() for word in name.removeprefix("sgt_").removeprefix("sagitta_").split("_")
    )


def rows():
    table, i = C.library.sagitta_layouts(), 0
    while table[i].type:
        yield table[i].type.decode(), table[i].member.decode(), table[i].at, table[i].size
        i += 1


def test_every_member():
    seen = {}
    for of, member, at, size in rows():
        struct = getattr(C, camel(of))
        if not member:
            assert ctypes.sizeof(struct) == size, of
            continue
        mine = getattr(struct, member)
        assert (mine.offset, mine.size) == (at, size), f"{of}.{member}"
        seen.setdefault(struct, set()).add(member)
    structs = {
        s
        for s in vars(C).values()
        if isinstance(s, type) and issubclass(s, ctypes.Structure) and s not in (ctypes.Structure, C.Layout)
    }
    assert structs == set(seen)
    for struct, members in seen.items():
        assert members == {f[0] for f in struct._fields_}, struct


def test_tables_of_numpy():
    for table, struct in ((HIT_TABLE, C.Hit), (STEP_TABLE, C.Step), (_dtype(C.Launched), C.Launched)):
        assert table.itemsize == ctypes.sizeof(struct)
        for member in struct._fields_:
            assert table.fields[member[0]][1] == getattr(struct, member[0]).offset, member
    assert ctypes.sizeof(Hit) == ctypes.sizeof(C.Hit)
    for mine, theirs in zip(Hit._fields_, C.Hit._fields_):
        assert getattr(Hit, mine[0]).offset == getattr(C.Hit, theirs[0]).offset


def test_enumerations(tree):
    """Every word of the headers, with its number."""
    text = "".join(path.read_text() for path in sorted((tree / "include" / "sagitta").glob("*.h")))
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", text, flags=re.DOTALL)
    for name in ("Status", "Fate", "Aimed", "Fault", "Verdict"):
        (body,) = re.findall(rf"typedef enum (?:SGT_ONE_BYTE )?sgt_{name.lower()} \{{(.*?)\}}", text, re.DOTALL)
        found, number = {}, -1
        for word, given in re.findall(r"SGT_(\w+)\s*(?:=\s*(-?\d+))?", body):
            number = int(given) if given else number + 1
            found[word.removeprefix("AIMED_")] = number
        assert found == {member.name: member.value for member in getattr(sagitta, name)}
