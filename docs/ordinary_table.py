#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tables of data/ordinary.md (docs/tables.py has the convention).

    python3 docs/ordinary_table.py build
    python3 docs/ordinary_table.py build --search [SECONDS [SEED]]

The first runs build/tests/bench/bench_ordinary for its tables and for the fifty random sags; further words are
passed on to the program (--quick).  The second writes what the search for cliffs finds in SECONDS (1200).
"""
import sys

import tables


def main(build, *words):
    program = f'{build}/tests/bench/bench_ordinary'
    if words[:1] == ('--search',):
        seconds, seed = (*words[1:], *('1200', '1')[len(words) - 1:])
        found = tables.run(program, '--search', '--brief', '--seconds', seconds, '--seed', seed)
        tables.write('ordinary', build, found, 'ordinary search')
        return
    made, drawn = tables.run(program, *words), tables.run(program, '--drawn', *words)
    tables.write('ordinary', build, f'{made}\n\n### Fifty random sags\n\n{drawn}')


if __name__ == '__main__':
    main(*sys.argv[1:])
