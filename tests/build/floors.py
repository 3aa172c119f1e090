#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The floors of src/: a file includes its own folder and those before it.

    python3 tests/build/floors.py [TREE]     prints each include that breaks the order
    python3 tests/build/floors.py --planted  tries the test itself on trees with faults
"""
import pathlib
import re
import sys
import tempfile

FLOORS = ['num', 'solve', 'surface', 'ray', 'check', 'system', 'dispatch']  # the library, from the ground up
CLIENTS = ['geo', 'lens', 'tool']                      # see <sagitta/...> as any program does
SHARED = ['text', 'truth']                             # compiled into the clients that see them
SEEN = {'text': ['lens', 'tool'], 'truth': ['tool'], 'num': ['text']}  # by these; num by the floors above, too

# All the library may ask of C: nothing that allocates, prints, ends the program
# or keeps a state (errno, the locale).
C_HEADERS = {'float.h', 'limits.h', 'math.h', 'stdbool.h', 'stddef.h', 'stdint.h', 'string.h'}

# And what asks the processor and the environment.
ASKING = {'choose.c': {'cpuid.h', 'stdlib.h'}}

# The floor that answers for a public header; those below do not know of it.
PUBLIC = {'sagitta.h': 'num', 'fma.h': 'num', 'pair.h': 'num', 'interval.h': 'num', 'diagnose.h': 'check',
          'surfaces.h': 'surface', 'formula.h': 'surface', 'sensitivity.h': 'ray', 'system.h': 'system',
          'aim.h': 'system', 'beam.h': 'system', 'geo.h': 'geo', 'lens.h': 'lens', 'edit.h': 'lens',
          'figure.h': 'lens', 'analysis.h': 'lens', 'study.h': 'lens', 'tolerance.h': 'lens', 'prove.h': 'lens',
          'shape.h': 'lens', 'why.h': 'lens', 'sagitta.hpp': 'C++'}

# The list of the built-in types, which is on no floor: data for all of them.
LIST = 'types.def'

# All that sagitta.hpp may ask of C++: nothing of it allocates or throws.
CPP_HEADERS = {'cstddef', 'limits', 'type_traits', 'utility'}

# The intervals and the fma are inline, and need what they are made of.
INLINE = {'float.h', 'math.h', 'string.h'}

SOURCE = {'.c', '.h', '.inc', '.cc', '.cpp', '.hpp'}
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include\b[ \t]*(.*)$', re.MULTILINE)
NAMED = re.compile(r'([<"])([^>"]+)[>"]')
COMMENT = re.compile(r'/\*.*?\*/|//[^\n]*', re.DOTALL)


def includes(path):
    """Yields (line number, '<' or '"' or '?', name)."""
    text = COMMENT.sub(lambda m: '\n' * m.group().count('\n'), path.read_text())
    for found in INCLUDE.finditer(text):
        line = text.count('\n', 0, found.start()) + 1
        name = NAMED.match(found.group(1))
        yield (line, name.group(1), name.group(2)) if name else (line, '?', found.group(1))


def sources(folder):
    return sorted(p for p in folder.rglob('*') if p.suffix in SOURCE) if folder.is_dir() else []


def fault_in_library(src, path, floor, kind, name):
    if kind == '<':
        if name.startswith('sagitta/'):
            lowest = PUBLIC.get(name[len('sagitta/'):])
            if lowest is None:
                return 'no such public header'
            if lowest not in FLOORS:
                return f'is the header of {lowest}, a client'
            if FLOORS.index(lowest) > FLOORS.index(floor):
                return f'is the header of {lowest}, a floor above {floor}'
        elif name not in C_HEADERS | ASKING.get(path.name, set()):
            return 'the library does without it'
        return None
    for base in (path.parent, src):
        target = (base / name).resolve()
        if target.is_file():
            break
    else:
        return 'no such file in src'
    try:
        other = target.relative_to(src.resolve()).parts[0]
    except ValueError:
        return 'outside src (a public header is included as <sagitta/...>)'
    if other == LIST:
        return None
    if other not in FLOORS:
        return f'{other} is no floor of the library'
    if FLOORS.index(other) > FLOORS.index(floor):
        return f'{other} is a floor above {floor}'
    return None


def fault_in_client(folder, path, kind, name):
    if kind == '<':
        if name.startswith('sagitta/') and name[len('sagitta/'):] not in PUBLIC:
            return 'no such public header'
        return None
    for base in (path.parent, folder):
        target = (base / name).resolve()
        if target.name == LIST and target.is_file():
            return None
        if target.is_file():
            shared = [folder.parent / room for room, users in SEEN.items() if folder.name in users]
            inside = any(room.resolve() in target.parents for room in [folder] + shared)
            return None if inside else 'a client sees <sagitta/...> and its own folder'
    return 'no such file in its folder'


def faults(tree):
    """All faults of a tree, each as 'file:line: include: what is wrong'; and
    how many includes were looked at."""
    src, found, seen = tree / 'src', [], 0

    def look(path, ask):
        nonlocal seen
        for line, kind, name in includes(path):
            seen += 1
            fault = 'not a plain name' if kind == '?' else ask(kind, name)
            if fault:
                found.append(f'{path.relative_to(tree)}:{line}: {name}: {fault}')

    for entry in sorted(src.iterdir()):
        if entry.is_dir() and entry.name not in FLOORS + CLIENTS + SHARED:
            found.append(f'src/{entry.name}: not a floor: {", ".join(FLOORS + CLIENTS)}')
        elif entry.suffix in SOURCE:
            found.append(f'src/{entry.name}: on no floor')
    for floor in FLOORS:
        for path in sources(src / floor):
            look(path, lambda kind, name: fault_in_library(src, path, floor, kind, name))
    for folder in [src / client for client in CLIENTS + SHARED] + [tree / 'examples']:
        for path in sources(folder):
            look(path, lambda kind, name: fault_in_client(folder, path, kind, name))
    for path in sources(tree / 'include'):
        allowed = {f'sagitta/{name}' for name in PUBLIC if path.suffix == '.hpp' or not name.endswith('.hpp')}
        allowed |= CPP_HEADERS if path.suffix == '.hpp' else {'stdbool.h', 'stddef.h'}
        allowed |= {'stdint.h'} if path.name == 'lens.h' else set()
        allowed |= INLINE if path.name in ('fma.h', 'pair.h', 'interval.h') else set()
        look(path, lambda kind, name: None if kind == '<' and name in allowed
             else 'a public header includes <stdbool.h>, <stddef.h> <sagitta/...>; sagitta.hpp little else')
    return found, seen


# ------------------------------------------------------- the test of the test

SOUND = {
    'src/num/exact.h': '#include <math.h>\n',
    'src/solve/root.c': '#include "solve/root.h"\n#include "num/exact.h"\n#include <sagitta/sagitta.h>\n',
    'src/solve/root.h': '#include "../num/exact.h"\n',
    'src/ray/intersect.c': '# include "solve/root.h"\n#include <sagitta/surfaces.h>\n',
    'src/tool/main.c': '#include "main.h"\n#include <stdio.h>\n#include <sagitta/sagitta.h>\n',
    'src/text/number.h': '#include <sagitta/fma.h>\n#include "../num/exact.h"\n',
    'src/lens/read/read.c': '#include "../../text/number.h"\n',
    'src/tool/main.h': '/* #include "num/exact.h" */\n',
    'examples/one.c': '#include <sagitta/system.h>\n#include <stdio.h>\n',
    'include/sagitta/sagitta.h': '#include <stddef.h>\n',
    'include/sagitta/sagitta.hpp': '#include <sagitta/sagitta.h>\n#include <utility>\n',
    'examples/two.cpp': '#include <sagitta/sagitta.hpp>\n#include <vector>\n',
}

PLANTED = [
    ('src/num/up.h', '#include "solve/root.h"\n'),
    ('src/num/up.h', '\n  #  include "../solve/root.h"\n'),
    ('src/solve/up.c', '#include "ray/intersect.c"\n'),
    ('src/solve/loud.c', '#include <stdio.h>\n'),
    ('src/solve/public.c', '#include <sagitta/system.h>\n'),
    ('src/solve/gone.c', '#include "num/nothing.h"\n'),
    ('src/solve/out.c', '#include "../../include/sagitta/sagitta.h"\n'),
    ('src/ray/up.c', '#include "tool/main.h"\n'),
    ('src/ray/hidden.c', '#define H "tool/main.h"\n#include H\n'),
    ('src/tool/in.c', '#include "num/exact.h"\n'),
    ('src/tool/in.c', '#include "../num/exact.h"\n'),
    ('src/geo/in.cpp', '#include "tool/main.h"\n'),
    ('src/ray/client.c', '#include <sagitta/geo.h>\n'),
    ('src/ray/client.c', '#include <sagitta/lens.h>\n'),
    ('src/lens/in.c', '#include "num/exact.h"\n'),
    ('src/geo/in.c', '#include "../text/number.h"\n'),
    ('src/text/up.c', '#include "../lens/read/read.c"\n'),
    ('src/text/up.c', '#include "../solve/root.h"\n'),
    ('examples/in.c', '#include "../src/num/exact.h"\n'),
    ('src/attic/old.c', ''),
    ('src/loose.c', ''),
    ('include/sagitta/sagitta.h', '#include <stdio.h>\n'),
    ('include/sagitta/sagitta.h', '#include <sagitta/sagitta.hpp>\n'),
    ('include/sagitta/sagitta.hpp', '#include <vector>\n'),
    ('src/ray/cpp.c', '#include <sagitta/sagitta.hpp>\n'),
]


def planted():
    """The sound tree has no fault, and with each planted one exactly one."""
    bad = 0
    for path, text in [(None, '')] + PLANTED:
        with tempfile.TemporaryDirectory() as name:
            tree = pathlib.Path(name)
            for file, content in {**SOUND, **({path: text} if path else {})}.items():
                (tree / file).parent.mkdir(parents=True, exist_ok=True)
                (tree / file).write_text(content)
            found, _ = faults(tree)
        if len(found) != (1 if path else 0):
            bad += 1
            print(f'{path}: {text!r}: found {found}')
    print(f'{len(PLANTED)} planted faults, {bad} misjudged')
    return bad == 0


def main(arguments):
    if arguments[:1] == ['--planted']:
        return 0 if planted() else 1
    default = pathlib.Path(__file__).resolve().parents[2]
    tree = pathlib.Path(arguments[0]) if arguments else default
    found, seen = faults(tree)
    print('\n'.join(found + [f'{seen} includes, {len(found)} faults']))
    return 1 if found or not seen else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
