#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Prints names.h: each name of the library that leaves its file, with the name of the set at its end.

    python3 src/dispatch/names.py SRC FILE...
    python3 src/dispatch/names.py --narrow SRC FILE... --wide FILE...
                                                prints narrow_names.h: of files, and of functions in wide files,
                                                that v4 shares with v3

The library is compiled whole for each set of instructions (dispatch.h), and names.h is included before
every other file in those compilations.  So each function and table has the set's name at its end, and
differs from set to set.  A name that is missed is defined once for each set, and the library does not link.
Files that gain nothing by AVX-512 are not compiled for v4, nor are functions that SGT_NARROW marks: what the
set and the dispatch call NAME_v4 is then NAME_v3, by narrow_names.h.

A definition begins in the first column and is not static (CONTRIBUTING.md, "Style").  A macro of SRC that
defines sgt_##NAME##_end of its argument NAME is looked for, too, and so are the operations of the types in
types.def.
"""
import pathlib
import re
import sys

COMMENT = re.compile(r'/\*.*?\*/', re.DOTALL)
DEFINED = re.compile(r'^(?!static\b|typedef\b|extern\b|SGT_INLINE\b)[A-Za-z_][\w *]*?\b(sgt_\w+)\s*'
                     r'(?:\([^;{]*?\)\s*\{|(?:\[[^\]]*\])?\s*=)', re.MULTILINE)
MACRO = re.compile(r'^#define (\w+)\((\w+)[^)]*\)((?:[^\n]*\\\n)*[^\n]*)', re.MULTILINE)
# Of num/exact.h.
NARROWED = re.compile(r'^SGT_NARROW\([^,]*,\s*(sgt_\w+),', re.MULTILINE)
TYPE = re.compile(r'^TYPE\([^,]*,[^,]*,\s*(\w+),\s*([\w/]+\.c)', re.MULTILINE)

HEAD = '''/* Each name that leaves its file, with the name of the set at its end; printed by src/dispatch/names.py. */
#define SGT_JOINED(name, set) name##_##set
#define SGT_OF_SET(name, set) SGT_JOINED(name, set)
#define SGT_SET_NAME(name) SGT_OF_SET(name, SGT_SET)'''

NARROW = '/* What v4 shares with v3; printed by src/dispatch/names.py. */'


def makers(src):
    """The macros that define names: the name of a macro, and the ends."""
    found = {}
    for header in list(src.rglob('*.h')) + list(src.rglob('*.c')):
        for name, parameter, body in MACRO.findall(header.read_text()):
            ends = re.findall(rf'^    const sgt_surface_ops sgt_##{parameter}##(\w+) =|'
                              rf'^    double sgt_##{parameter}##(\w+)\(', body, re.MULTILINE)
            if ends and header.parent.name != 'dispatch':
                found[name] = [table or function for table, function in ends]
    return found


def names(src, files):
    found = {f'sgt_{name}_ops' for name, file in TYPE.findall((src / 'types.def').read_text())
             if any(given.as_posix().endswith(f'/surface/{file}') for given in files)}
    made = makers(src)
    for file in files:
        text = COMMENT.sub('', file.read_text())
        found.update(DEFINED.findall(text) + NARROWED.findall(text))
        for macro, name in re.findall(r'^(\w+)\((\w+)', text, re.MULTILINE):
            found.update(f'sgt_{name}{end}' for end in made.get(macro, ()))
    return sorted(found)


def main(*words):
    narrow = words[0] == '--narrow'
    end = words.index('--wide') if narrow else len(words)
    src, *files = map(pathlib.Path, words[narrow:end])
    print(NARROW if narrow else HEAD)
    wide = {name for file in words[end + 1:] for name in NARROWED.findall(pathlib.Path(file).read_text())}
    for name in sorted({*names(src, files), *wide}):
        print(f'#define {name}_v4 {name}_v3' if narrow else f'#define {name} SGT_SET_NAME({name})')


if __name__ == '__main__':
    main(*sys.argv[1:])
