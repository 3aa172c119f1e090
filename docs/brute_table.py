#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The table of data/brute.md: level sets against brute force (docs/tables.py has the convention).

    python3 docs/brute_table.py build [--rays WxH]   without --rays every ray, which takes hours
"""
import re
import sys

import tables

PLACES = {'met': 1, 'roots': 3, 'stepped over': 4, 'library wrong': 6, 'undecided': 7, 'worst |t - t_ref|': 8,
          'worst t_err': 9, 'evaluations': 10}     # columns of the program, behind the rays


def main(build, *words):
    said = tables.run(f'{build}/tests/oracle/test_brute', *(words or ('--full',)))
    rows = []
    for part in ('first hits', 'all roots'):
        lines = re.search(rf'^{part} .*\n.*\n((?:\S.*\n)+)', said, re.M)[1].splitlines()
        cells = [(line[:38].strip(), line[38:].split()) for line in lines]
        for name, numbers in [cells[-1], *(cells[:-1] if part == 'first hits' else [])]:
            rows.append([f'**all sets, {part}**' if name == 'total' else name,
                         *(tables.short(numbers[place]) for place in (0, *PLACES.values()))])
    tables.write('brute', build, tables.table(['', 'rays', *PLACES], rows))


if __name__ == '__main__':
    main(*sys.argv[1:])
