#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The table of data/lenses.md: lenses against 50 digits (docs/tables.py has the convention).

    python3 docs/lenses_table.py build
"""
import re
import sys

import tables

NAMES = {'ftheta_laikin': 'f-theta scan lens', 'cassegrain_laikin': 'Cassegrain with corrector'}
LINE = re.compile(r'^(\w+): (\d+) rays, (\d+) rows compared .*worst point (\S+) lengths, direction (\S+)$', re.M)


def main(build):
    data = tables.DOCS.parent / 'tests/data'
    lines = LINE.findall(tables.run(f'{build}/tests/oracle/test_reference', data))
    rows = [[NAMES.get(name, name.replace('_', ' ')), *counts] for name, *counts in lines]
    hard = tables.run(f'{build}/tests/oracle/test_hard', data).splitlines()[-1]
    tables.write('lenses', build, tables.table(['lens', 'rays', 'rows compared', 'worst point', 'worst direction'],
                                               rows) + f'\n\nSingle rays that are hard: {hard}.')


if __name__ == '__main__':
    main(*sys.argv[1:])
