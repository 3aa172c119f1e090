#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The table of data/sensitivity.md: what derivatives cost (docs/tables.py has the convention).

    python3 docs/sensitivity_table.py build
"""
import re
import sys

import tables

LINE = re.compile(r'^([\w-]+) +([\d.]+) +([\d.]+) times +([\d.]+) times +([\d.]+) times$', re.M)


def main(build):
    rows = LINE.findall(tables.run(f'{build}/tests/bench/bench_sensitivity'))
    tables.write('sensitivity', build, tables.table(['', 'batch, ns', 'by ray, times', 'by all, times',
                                                     'and of n, times'], rows))


if __name__ == '__main__':
    main(*sys.argv[1:])
