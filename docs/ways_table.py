#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tables of notes/ways.md that say which search the rays go through, as tests/ways/ways.c counts them.

    python3 docs/ways_table.py build/tests/ways/ways            writes them between their marks
    python3 docs/ways_table.py build/tests/ways/ways --check    says whether they are as the library counts
"""
import csv
import pathlib
import subprocess
import sys

PAGE = pathlib.Path(__file__).parent / 'notes/ways.md'
BEGIN, END = '<!-- docs/ways_table.py, {} rays: from here -->\n', '<!-- to here -->\n'
WAYS = {'closed': 'C', 'rounds': 'R', 'quick': '1q', 'careful': '1c',
        'cells': '3', 'steps': '4', 'parted': '6'}
ROOTS = ['first', 'near the seed', 'all', 'proven']


def ways_of(line):
    """As 1q 100, 3 2: the ways that some of the rays take, and the share in per cent."""
    return ', '.join(f'{short} {line[way]}' for way, short in WAYS.items() if line[way] != '0') or 'none'


def table(lines):
    """A row for each type; neighbours of which all is the same share one."""
    rows = []
    for first in (line for line in lines if line['root'] == 'first'):
        of_type = {line['root']: line for line in lines if line['type'] == first['type']}
        cells = [ways_of(of_type[root]) for root in ROOTS] + [str(100 - int(first['batch: one by one']))]
        if rows and rows[-1][1] == cells:
            rows[-1][0].append(first['type'])
        else:
            rows.append(([first['type']], cells))
    yield '| surface | first root | near the seed | all roots | first, proven | batch: % in lanes |\n'
    yield '|---|---|---|---|---|---|\n'
    for types, cells in rows:
        yield '| ' + ', '.join(types) + ' | ' + ' | '.join(cells) + ' |\n'


def main(program, check=None):
    said = subprocess.run([program], text=True, check=True, capture_output=True).stdout
    lines = list(csv.DictReader(said.splitlines()))
    page = new = PAGE.read_text(encoding='utf-8')
    for kind in ('ordinary', 'hostile'):
        begin = BEGIN.format(kind)
        head, rest = new.split(begin)
        rows = table([line for line in lines if line['rays'] == kind])
        new = head + begin + ''.join(rows) + END + rest.split(END, 1)[1]
    if check is None:
        PAGE.write_text(new, encoding='utf-8')
    elif new != page:
        for old, now in zip(page.splitlines(), new.splitlines()):
            if old != now:
                print(f'notes/ways.md has {old}\nthe library says {now}')
        return 'docs/ways_table.py BUILD/tests/ways/ways writes them anew'
    print(f'{len(lines)} lines')
    return 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
