#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The rooms of src/: what a reader may count on.

    python3 tests/build/rooms.py [TREE]            each file and folder
    python3 tests/build/rooms.py TREE LIBRARY.a...  and the symbols of the object files
    python3 tests/build/rooms.py --planted         tries the test itself on trees with faults

- Files include each other without a circle, and so do folders; with libraries, the same of what
  object files ask of each other (nm).  tests/build/floors.py holds the floors to their order.
- A name that a file keeps to itself (static functions and tables, types, macros) stands in no other file
  of the library, nor in two of the command.
- Lines have at most 110 columns, also those of tests and examples, and of meson; in public headers 90.
- Each folder has a README.md of at most 40 lines.
- Each source file names its licence in its first line (behind #!), unless a program has written it and it
  says so ("Written by ...").  Data for tests need not.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = {'.c', '.h', '.cpp', '.hpp'}
COLUMNS, COLUMNS_PUBLIC, README_LINES = 110, 90, 40
LICENCE = 'SPDX-License-Identifier: MIT'
LICENSED = SOURCE | {'.def', '.in', '.rs', '.py', '.sh', '.f90', '.m'}
DATA = ('tests/data/', 'tests/fuzz/corpus/', 'tests/fuzz/past/')
COMMENT = re.compile(r'/\*.*?\*/|//[^\n]*', re.DOTALL)
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*"([^"]+)"', re.MULTILINE)
# A definition begins in the first column.  SGT_INLINE and its kin are static (src/num/exact.h).
# A sign in front of a sum that ends in fma: compilers make one instruction of it, whose zero has another sign.
NEGATED = re.compile(r'(?:[=(,?:*/+<>&|{\[-]|\breturn)\s*-\(?(?:dot|sgt_fma|fma)\(')
STATIC = re.compile(r'^(?:(?:SGT_KERNEL|SGT_NOINLINE)\s+)?(?:static|SGT_INLINE)\b[^;{=()]*?'
                    r'\b(\w+)\s*(?:\(|(?:\[[^\]]*\])*\s*=)', re.MULTILINE)
TYPE = re.compile(r'^typedef\s+(?:struct|union|enum)\b[^{;]*'
                  r'\{[^{}]*(?:\{[^{}]*\}[^{}]*)*\}\s*(\w+)\s*;', re.MULTILINE)
MACRO = re.compile(r'^[ \t]*#[ \t]*define[ \t]+(\w+)', re.MULTILINE)


def sources(folder):
    return sorted(p for p in folder.rglob('*') if p.suffix in SOURCE) if folder.is_dir() else []


def text_of(path):
    return COMMENT.sub(lambda m: '\n' * m.group().count('\n') or ' ', path.read_text())


def circles(edges):
    """Each set of two or more nodes that reach one another (Tarjan 1972)."""
    number, low, stack, found = {}, {}, [], []

    def visit(v):
        number[v] = low[v] = len(number)
        stack.append(v)
        for w in sorted(edges.get(v, ())):
            if w not in number:
                visit(w)
                low[v] = min(low[v], low[w])
            elif w in stack:
                low[v] = min(low[v], number[w])
        if low[v] == number[v]:
            one = stack[stack.index(v):]
            del stack[stack.index(v):]
            if len(one) > 1:
                found.append(sorted(one))

    sys.setrecursionlimit(10000)
    for v in sorted(edges):
        if v not in number:
            visit(v)
    return found


def folders_of(edges, folder_of):
    out = {}
    for v, ws in edges.items():
        for w in ws:
            if folder_of(v) != folder_of(w):
                out.setdefault(folder_of(v), set()).add(folder_of(w))
    return out


def told(edges, folder_of, by):
    return ([f'{by}: a circle of files: {", ".join(c)}' for c in circles(edges)]
            + [f'{by}: a circle of folders: {", ".join(c)}' for c in circles(folders_of(edges, folder_of))])


def include_faults(src):
    edges = {}
    for path in sources(src):
        mine = edges.setdefault(str(path.relative_to(src)), set())
        for name in INCLUDE.findall(text_of(path)):
            for base in (path.parent, src, src / path.relative_to(src).parts[0]):
                target = (base / name).resolve()
                if target.is_file() and src.resolve() in target.parents:
                    mine.add(str(target.relative_to(src.resolve())))
                    break
    return told(edges, lambda f: str(pathlib.PurePath(f).parent), 'includes')


def symbol_faults(src, library):
    """Files are told from the names of objects, surface_sag_poly.c.o of src/surface/sag/poly.c; those of
    lens from src/lens."""
    files = {str(p.relative_to(base)).replace('/', '_') + '.o': str(p.relative_to(src))
             for base in (src / 'lens', src) for p in sources(base)}
    listing = subprocess.run(['nm', '-A', library], capture_output=True, text=True, check=True).stdout
    defined, asked = {}, {}
    for line in listing.splitlines():
        place, *rest = line.split()
        parts = place.split(':')
        member = files.get(pathlib.PurePath(parts[1] if len(parts) > 2 else parts[0]).name)
        if member is None:
            continue
        kind, name = rest[-2], rest[-1]
        if kind == 'U':
            asked.setdefault(member, set()).add(name)
        elif kind.isupper():
            defined[name] = member
    edges = {m: {defined[n] for n in names if n in defined and defined[n] != m} for m, names in asked.items()}
    if not defined:
        return [f'{library}: no object of src in it']
    return told(edges, lambda f: str(pathlib.PurePath(f).parent), 'symbols')


def name_faults(paths, src):
    where = {}
    for path in paths:
        text = text_of(path)
        own = set(STATIC.findall(text)) | set(TYPE.findall(text)) | set(MACRO.findall(text))
        for name in own:
            where.setdefault(name, []).append(str(path.relative_to(src)))
    return [f'{name}: in {", ".join(files)}' for name, files in sorted(where.items()) if len(files) > 1]


def negated_faults(tree):
    """Results of fma that are negated, where bits have to be the same everywhere."""
    found = []
    for path in sources(tree / 'include') + [p for room in ('num', 'ray', 'solve', 'surface', 'system')
                                              for p in sources(tree / 'src' / room)]:
        text = COMMENT.sub(lambda m: re.sub(r'[^\n]', ' ', m[0]), path.read_text())
        for m in NEGATED.finditer(text):
            line = text.count('\n', 0, m.end()) + 1
            found.append(f'{path.relative_to(tree)}:{line}: the result of fma or dot is negated (num/lanes.h)')
    return found


def licence_faults(tree):
    found = []
    for room in ('src', 'include', 'tests', 'examples', 'python', 'docs'):
        for path in sorted((tree / room).rglob('*')):
            name = path.relative_to(tree).as_posix()
            if path.suffix not in LICENSED or name.startswith(DATA) or name.endswith('.def.in'):
                continue
            head = path.read_text().splitlines()[:3]
            if not any(LICENCE in line for line in head[:2]) and 'Written by ' not in ' '.join(head):
                found.append(f'{name}: its first line should be {LICENCE}')
    return found


def faults(tree, libraries=()):
    src, found = tree / 'src', []
    found += include_faults(src)
    found += negated_faults(tree)
    found += licence_faults(tree)
    for library in libraries:
        found += symbol_faults(src, library)
    clients = [src / name for name in ('tool', 'geo', 'lens', 'truth')]
    found += name_faults([p for p in sources(src) if not any(c in p.parents for c in clients)], src)
    for client in clients:
        found += name_faults(sources(client), src)
    rooms = [tree / room for room in ('src', 'include', 'tests', 'examples')]
    meson = [p for room in rooms if room.is_dir() for p in sorted(room.rglob('meson.build'))]
    meson += [p for p in (tree / 'meson.build', tree / 'meson_options.txt') if p.is_file()]
    for path in [p for room in rooms for p in sources(room)] + meson:
        most = COLUMNS_PUBLIC if tree / 'include' in path.parents else COLUMNS
        for number, line in enumerate(path.read_text().splitlines(), 1):
            if len(line) > most:
                found.append(f'{path.relative_to(tree)}:{number}: {len(line)} columns, {most} at most')
    for folder in sorted({p.parent for p in sources(src)}):
        readme = folder / 'README.md'
        lines = len(readme.read_text().splitlines()) if readme.is_file() else 0
        if not 0 < lines <= README_LINES:
            found.append(f'{readme.relative_to(tree)}: {lines} lines, 1 to {README_LINES} are wanted')
    return found


# ------------------------------------------------------- the test of the test

SOUND = {
    'src/num/README.md': 'Numbers.\n',
    'src/num/a.h': '#define A 1\ntypedef struct pair { int x; } pair;\n'
                   'SGT_INLINE int one(void) { return 1; }\n',
    'src/num/b.c': '#include "a.h"\nstatic int two(int x) { return x; }\nstatic const int table[3] = {0};\n',
    'src/ray/README.md': 'Rays.\n',
    'src/ray/c.c': '/* static int two(void) */\n#include "../num/a.h"\nint three(void) { return 3; }\n',
    'src/tool/README.md': 'The command.\n',
    'src/tool/d.c': 'static int two(void) { return 2; }\n',
    'include/sagitta/sagitta.h': '/* fine */\n',
}

BARE = '\0'                                          # in front of a file that shall not have the licence's line
PLANTED = [
    {'src/num/a.h': '#include "e.h"\n', 'src/num/e.h': '#include "a.h"\n'},
    {'src/num/e.h': '#include "../ray/f.h"\n', 'src/ray/f.h': '\n'},
    {'src/ray/e.c': 'static void two(void) {}\n'},
    {'src/ray/e.c': 'SGT_KERNEL\nstatic double two(double x) { return x; }\n'},
    {'src/ray/e.c': 'static const int table[] = {1};\n'},
    {'src/ray/e.c': '#define A 2\n'},
    {'src/ray/e.c': 'typedef struct pair {\n    double y;\n} pair;\n'},
    {'src/ray/e.c': '/* ' + 'x' * 110 + ' */\n'},
    {'tests/unit/e.c': '/* ' + 'x' * 110 + ' */\n'},
    {'tests/unit/meson.build': '# ' + 'x' * 110 + '\n'},
    {'meson_options.txt': '# ' + 'x' * 110 + '\n'},
    {'include/sagitta/sagitta.h': '/* ' + 'x' * 90 + ' */\n'},
    {'src/ray/README.md': 'x\n' * 71},
    {'src/sub/e.c': 'int e;\n'},
    {'src/num/b.c': 'double t = -dot(a, b) * c;\n'},
    {'src/ray/e.c': 'double t = f(a,\n             -sgt_fma(a, b, c));\n'},
    {'src/ray/e.c': BARE + 'int e;\n'},
    {'docs/e.py': BARE + '#!/usr/bin/env python3\nprint(1)\n'},
]


def planted():
    """The sound tree has no fault, and with each planted one exactly one."""
    bad = 0
    for plant in [{}] + PLANTED:
        with tempfile.TemporaryDirectory() as name:
            tree = pathlib.Path(name)
            for file, content in {**SOUND, **plant}.items():
                (tree / file).parent.mkdir(parents=True, exist_ok=True)
                if pathlib.PurePath(file).suffix in LICENSED:
                    content = content[1:] if content.startswith(BARE) else f'// {LICENCE}\n{content}'
                (tree / file).write_text(content)
            found = faults(tree)
        if len(found) != bool(plant):
            bad += 1
            print(f'{plant}: found {found}')
    edges = {'a': {'b'}, 'b': {'c'}, 'c': {'a', 'd'}, 'd': set()}
    if circles(edges) != [['a', 'b', 'c']] or circles({'a': {'b'}, 'b': {'c'}}):
        bad += 1
        print('circles of a graph are misjudged')
    print(f'{len(PLANTED)} planted faults, {bad} misjudged')
    return bad == 0


def main(arguments):
    if arguments[:1] == ['--planted']:
        return 0 if planted() else 1
    default = pathlib.Path(__file__).resolve().parents[2]
    tree = pathlib.Path(arguments[0]) if arguments else default
    found = faults(tree, arguments[1:])
    print('\n'.join(found + [f'{len(found)} faults']))
    return 1 if found else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
