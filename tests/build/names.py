#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Each name in backticks on a page exists: a file as a path, a word in the sources.

    python3 tests/build/names.py [TREE]       README.md, CONTRIBUTING.md, docs, docs/data, tests, src
    python3 tests/build/names.py --planted    tries the test itself on trees with faults

- A path is found from the page's folder, from the folder of the path (or the suite of tests) before it in
  the same block, from the tree, or from src, src/surface, include or include/sagitta; on pages of src from
  the folder above, too; on the others the name of any file will do.  NAME.c is any file; a program may stand
  without .c.  What begins with build/ is not asked for.
- A word stands in the sources, outside the comments of C.  `sgt_TYPE_ops` may have any word for TYPE, and
  `_square` any beginning.
- `word` of file, `word` in file and `word` (file): the word stands in that file, not only as a member.
- On the pages of src, each source file of the folder stands in a table (name.h beside name.c need not), and
  each name of a file, even without backticks, is that of some file.
What a page has in its own blocks of code is known there.
"""
import pathlib
import re
import sys
import tempfile

C = {'.c', '.h', '.cpp', '.hpp', '.in'}
TEXT = C | {'.py', '.sh', '.build', '.map', '.txt', '.yaml', '.csv'}
FOLDERS = ('src', 'include', 'tests', 'examples', 'docs', 'python')
# Names of other projects and of systems.
FOREIGN = {'ldconfig', 'julia_fractal', 'dllimport', 'autopkgtest', 'libsagitta2', 'Containerfile'}
# Words that stand for others.
EXAMPLES = {'sgt_saddle_object'}
SETS = re.compile(r'_(base|v3|v4)$')
COMMENT = re.compile(r'/\*.*?\*/|//[^\n]*', re.DOTALL)
FENCED = re.compile(r'^```.*?^```', re.DOTALL | re.MULTILINE)
INDENTED = re.compile(r'^    .*$', re.MULTILINE)
CODE = re.compile(r'`([^`\n]+)`')
WORD = re.compile(r'_?[A-Za-z]\w*')
FILE = r'[\w./]*\w\.(?:cpp|hpp|c|h|py|sh|md|map|yaml|csv|txt)'
PATH = re.compile(rf'{FILE}|(?:\w+/)+[\w.]*')
BARE = re.compile(r'(?<![\w./])[\w/]+\.(?:cpp|hpp|c|h|py)(?!\w)')
AT = re.compile(rf'`(\w+)`(?:(?: of| in) `?({FILE})`?| \(`?({FILE})`?\))')


def text_of(path):
    text = path.read_text(errors='replace')
    return COMMENT.sub(' ', text) if path.suffix in C else text


def pages(tree):
    found = [tree / 'README.md', tree / 'CONTRIBUTING.md', tree / 'tests/README.md', *sorted((tree / 'docs').glob('*.md')),
             *sorted((tree / 'docs/data').glob('*.md')), *sorted((tree / 'src').rglob('README.md'))]
    return [p for p in found if p.is_file()]


def is_at(name, folders):
    """The file, folder or program of that name, seen from the first of the folders that has it; else None."""
    like = re.sub(r'[A-Z]{2,}(?=[._]\w)', '*', name)
    for folder in folders:
        for suffix in ('', '.c', '.cpp'):
            if (folder / (name + suffix)).exists():
                return folder / (name + suffix)
        if like != name and (like[0] == '*' or list(folder.glob(like))):
            return folder / name
    return None


def page_faults(page, tree, words, files):
    text, found = page.read_text(), []
    own = '\n'.join(m.group() for e in (FENCED, INDENTED) for m in e.finditer(text))
    own_words, own_files = set(re.findall(r'\w+', own)), set(re.findall(FILE, own))
    text = INDENTED.sub('', FENCED.sub('', text))
    src = tree / 'src'
    folders = [page.parent, tree, src, src / 'surface', tree / 'include', tree / 'include/sagitta']
    if src in page.parent.parents:
        folders.append(page.parent.parent)
    else:
        own_files |= files
    for block in re.split(r'\n\s*\n', text):
        before = []
        for name in CODE.findall(block):
            if PATH.fullmatch(name) and not name.startswith('build/'):
                at = is_at(name, before + folders)
                if at:
                    before = [at.parent]
                elif not {name, pathlib.PurePath(name).name} & own_files:
                    found.append(f'{name}: no such file')
            elif (tree / 'tests' / name).is_dir():
                before = [tree / 'tests' / name]
            elif WORD.fullmatch(name) and name not in FOREIGN | EXAMPLES | own_words:
                like = re.sub(r'[A-Z]{2,}', r'\\w+', name) if re.search('[a-z]', name) else name
                like = (r'\w+' if name[0] == '_' else '') + like
                if not ({name, SETS.sub('', name)} & words) and (
                        like == name or not any(re.fullmatch(like, w) for w in words)):
                    found.append(f'{name}: in no source')
        for word, of, beside in AT.findall(block):
            at = is_at(of or beside, before + folders)
            if at and not re.search(rf'(?<![.>])\b{word}\b', text_of(at)):
                found.append(f'{word}: not in {at.relative_to(tree)}')
    if src not in page.parents:
        return found
    rows = '\n'.join(line for line in text.splitlines() if line.startswith('|'))
    for path in sorted(page.parent.iterdir()):
        like = rf'\b{path.stem}\.(?:{path.suffix[1:]}|cpp|c)\b'
        if path.suffix in C - {'.in'} and not re.search(like, rows):
            found.append(f'{path.name}: not in a table of the page')
    found += [f'{name}: no such file' for name in BARE.findall(CODE.sub('', text))
              if pathlib.PurePath(name).name not in files]
    return found


def faults(tree):
    paths = [p for f in FOLDERS for p in sorted((tree / f).rglob('*')) if p.is_file() and p.suffix in TEXT]
    paths += [p for p in (tree / 'meson.build', tree / 'meson_options.txt') if p.is_file()]
    words = {w for p in paths if p.name != 'names.py' for w in re.findall(r'\w+', text_of(p))}
    files = {p.name for p in paths}
    return [f'{page.relative_to(tree)}: {fault}' for page in pages(tree)
            for fault in page_faults(page, tree, words, files)]


# ------------------------------------------------------- the test of the test

SOUND = {
    'src/num/README.md': '''# num
| file | for |
|---|---|
| `a.h` | `one` |
| `b.c` | see `ray/c.c` and `d.h` |

`two` of `b.c` calls `one` (a.h), and sgt.h has `sgt_TYPE_ops` and `_ops`. `num`/`sgt.h`, `one_v3`.
''',
    'src/num/a.h': 'int one(void);\n',
    'src/num/b.c': '/* three */ int two(void);\n',
    'src/num/b.h': '\n',
    'src/ray/README.md': '| `c.c` | the `main` |\n| `d.h` | |\n',
    'src/ray/c.c': 'int main(void);\nops o = {.all = main};\n',
    'src/ray/d.h': '\n',
    'include/sagitta/sgt.h': 'extern int sgt_conic_ops, num;\n',
    'docs/page.md': '''Save it as `my.c`, with `mine` in it, in `build/x/`:

    cc my.c

```c
int mine;
```
''',
}

PLANTED = [
    {'docs/bad.md': '`src/num/e.c`\n'},
    {'docs/bad.md': '`src/none/`\n'},
    {'docs/bad.md': '`four`\n'},
    {'docs/bad.md': '`three`\n'},
    {'docs/bad.md': '`my.c`\n'},
    {'docs/bad.md': '`sgt_TYPE_operations`\n'},
    {'docs/bad.md': '`_operations`\n'},
    {'README.md': '`one` of `src/num/b.c`\n'},
    {'README.md': '`one` (`num/b.c`)\n'},
    {'CONTRIBUTING.md': '`two` in num/a.h\n'},
    {'CONTRIBUTING.md': '`all` in ray/c.c\n'},
    {'src/num/e.c': '\n'},
    {'src/num/e.h': '\n'},
    {'src/tool/README.md': 'See e.c.\n'},
    {'src/tool/README.md': '`ray/c.c`\n\nand `d.h`\n'},
]


def planted():
    """The sound tree has no fault, and with each planted one exactly one."""
    bad = 0
    for plant in [{}] + PLANTED:
        with tempfile.TemporaryDirectory() as name:
            tree = pathlib.Path(name)
            for file, content in {**SOUND, **plant}.items():
                (tree / file).parent.mkdir(parents=True, exist_ok=True)
                (tree / file).write_text(content)
            found = faults(tree)
        if len(found) != bool(plant):
            bad += 1
            print(f'{plant}: found {found}')
    print(f'{len(PLANTED)} planted faults, {bad} misjudged')
    return bad == 0


def main(arguments):
    if arguments[:1] == ['--planted']:
        return 0 if planted() else 1
    tree = pathlib.Path(arguments[0]).resolve() if arguments else pathlib.Path(__file__).resolve().parents[2]
    found = faults(tree)
    print('\n'.join(found + [f'{len(pages(tree))} pages, {len(found)} faults']))
    return 1 if found or len(pages(tree)) < 20 else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
