#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measured figures in docs/ are those that a command has written.

    python3 tests/build/measured.py [TREE]
    python3 tests/build/measured.py --planted    tries the test itself on trees with faults

- What stands between the marks of a table (docs/tables.py) has the checksum that its first mark says.
- A page docs/data/NAME.md begins with a heading, names the command docs/NAME_table.py, which exists, and has at
  least one table between marks that names its machine.  No figure stands in a table outside of them.
- docs/accuracy.md links to each of these pages.  It has at most 2,000 words.  Each number of a row, a bullet or a
  paragraph stands in a page or section of docs/data or docs/notes that the same row, bullet or paragraph links to.
  Its section "Where it ends" has limits that are not measured; code is not looked at.
"""
import pathlib
import re
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve()
sys.path[:0] = [str(HERE.parent), str(HERE.parents[2] / 'docs')]
sys.dont_write_bytecode = True
from readme import sections  # noqa: E402
from tables import BLOCK, checksum  # noqa: E402

WORDS = 2000
MARK = re.compile(r'^<!-- table .*: from here -->$', re.MULTILINE)
FIGURE = re.compile(r'\|\s*[\d.,e-]*\d[\d.,e-]*( %)?\s*(?=\|)')
UNIT = re.compile(r'^\|.*$|^- .*(?:\n  .*)*|^[^|\n#-].*(?:\n[^|\n#-].*)*', re.MULTILINE)
LINK = re.compile(r'\]\(((?:data|notes)/\w+\.md)(?:#([^)]*))?\)')
NUMBER = re.compile(r'(?<![\w.^-])\d[\d,]*(?:\.\d+)?(?:e-?\d+)?(?![\w^])')
UNMEASURED = 'where-it-ends'


def plain(number):
    return number.replace(',', '').rstrip('.')


def numbers(text):
    """Each number of a page of figures."""
    return {plain(n) for n in re.findall(r'(?<![\d.])\d[\d,]*(?:\.\d+)?(?:e-?\d+)?', text)}


def marked_faults(page, name):
    text = page.read_text()
    blocks = list(BLOCK.finditer(text))
    if len(blocks) != len(MARK.findall(text)):
        yield f'{name}: the marks of a table are broken'
    for block in blocks:
        if checksum(block[3]) != block[2]:
            yield f'{name}: the table {block[1]} was changed by hand, or its command did not write it'


def data_faults(page, name):
    text = page.read_text()
    blocks = list(BLOCK.finditer(text))
    command = f'docs/{page.stem}_table.py'
    if not text.startswith('# '):
        yield f'{name}: no heading'
    if not re.search(rf'^    .*python3 {command} build', text, re.MULTILINE):
        yield f'{name}: its command is not named'
    if not (page.parents[2] / command).is_file():
        yield f'{name}: there is no {command}'
    if not blocks or not all(block[3].strip().startswith('Made on ') for block in blocks):
        yield f'{name}: no table between marks, or one that does not name its machine'
    for line in BLOCK.sub('', text).splitlines():
        if line.startswith('|') and FIGURE.search(line):
            yield f'{name}: a figure outside of the marks: {line}'


def quoted_faults(page):
    """Numbers of the page that none of the pages has that they link to."""
    text = page.read_text()
    if len(text.split()) > WORDS:
        yield f'{page.name}: {len(text.split())} words, {WORDS} at most'
    text = text.replace(sections(page).get(UNMEASURED, '\0'), '')
    for unit in UNIT.findall(text):
        if unit.startswith('    '):
            continue
        known = set()
        for file, anchor in LINK.findall(unit):
            there = page.parent / file
            if there.is_file():
                known |= numbers(sections(there).get(anchor, '') if anchor else there.read_text())
        for number in NUMBER.findall(re.sub(r'\]\(.*?\)|`[^`]*`', '', unit)):
            if plain(number) not in known:
                yield f'{page.name}: {number} is in no table that is linked to beside it: {unit[:60]}...'


def faults(tree):
    docs, found = tree / 'docs', []
    for page in sorted(docs.rglob('*.md')):
        found += marked_faults(page, page.relative_to(tree))
    accuracy = docs / 'accuracy.md'
    linked = {file for file, _ in LINK.findall(accuracy.read_text())}
    for page in sorted((docs / 'data').glob('*.md')):
        found += data_faults(page, page.relative_to(tree))
        if f'data/{page.name}' not in linked:
            found.append(f'{accuracy.name} does not link to data/{page.name}')
    return found + list(quoted_faults(accuracy))


# ------------------------------------------------------- the test of the test

TABLE = '\nMade on a machine.\n\n### Some\n\n| ns | a | b |\n|---|---|---|\n| batch | 3.91 | 1,470 |\n\n'
SOUND = {
    'docs/one_table.py': '\n',
    'docs/data/one.md': '# One\n\nWhat it shows.\n\n    python3 docs/one_table.py build\n\n| column | 99 % of it |\n\n'
                        f'<!-- table one {checksum(TABLE)}: from here -->\n{TABLE}<!-- table one: to here -->\n',
    'docs/accuracy.md': '# Accuracy\n\n| a ray | 3.91 ns | 1470 for one | [one](data/one.md#some) |\n\nAVX-512.\n\n'
                        '## Where it ends\n\n- From 1e12 on.\n',
}
PLANTED = [  # page, what, by what
    ('docs/data/one.md', '3.91', '3.90'),
    ('docs/data/one.md', '| batch | 3.91 | 1,470 |\n', ''),
    ('docs/data/one.md', 'one: to here', 'two: to here'),
    ('docs/data/one.md', 'python3 docs/one_table.py build', 'python3 docs/two_table.py build'),
    ('docs/data/one.md', '| 99 % of it |', '| 99 |'),
    ('docs/data/one.md', '# One\n', 'One\n'),
    ('docs/accuracy.md', '3.91', '3.9'),
    ('docs/accuracy.md', '1470', '1,471'),
    ('docs/accuracy.md', '#some', '#other'),
    ('docs/accuracy.md', 'AVX-512.', 'It takes 12 ns.'),
    ('docs/accuracy.md', 'AVX-512.', '- It takes 3.91 ns.'),
    ('docs/accuracy.md', 'AVX-512.', 'word ' * WORDS),
]


def planted():
    """The sound tree has no fault, and each planted one is found."""
    bad = 0
    for plant in [None, *PLANTED]:
        with tempfile.TemporaryDirectory() as name:
            tree = pathlib.Path(name)
            for file, text in SOUND.items():
                (tree / file).parent.mkdir(parents=True, exist_ok=True)
                (tree / file).write_text(text)
            if plant:
                page, old, new = plant
                assert SOUND[page].count(old) == 1, plant
                (tree / page).write_text(SOUND[page].replace(old, new))
            found = faults(tree)
        if bool(found) != bool(plant):
            bad += 1
            print(f'{plant}: found {found}')
    print(f'{len(PLANTED)} planted faults, {bad} misjudged')
    return bad == 0


def main(arguments):
    if arguments[:1] == ['--planted']:
        return 0 if planted() else 1
    found = faults(pathlib.Path(arguments[0]) if arguments else HERE.parents[2])
    print('\n'.join(found + [f'{len(found)} faults']))
    return 1 if found else 0


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
