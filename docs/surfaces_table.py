#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The table of data/surfaces.md, and that of the figures in surfaces.md (docs/tables.py has the convention).

    python3 docs/surfaces_table.py build

runs build/tests/bench/bench_catalogue, and build/tests/catalogue/test_values with SCALE times its points.
"""
import re
import sys

import tables

SCALE = '20'
WORST = re.compile(r'(\w+) +(\d+) points.*; F within (\S+) of its size and (\S+) of `rounding`.*gradient '
                   r'(\S+), second (\S+), by parameter (\S+)')
LONG = re.compile(r'(\S.*\S) +F within (\S+) of its size, the gradient within (\S+)')


def short(number):
    """Three digits, and no exponent."""
    if number in ('-', ''):
        return number
    return f'{float(number):.0f}' if float(number) >= 100 else f'{float(number):.3g}'


def of_which(surface):
    variant = surface['surface'][len(surface['type']) + 2:]
    return f' ({variant})' if variant else ''


def main(build):
    values = tables.run(f'{build}/tests/catalogue/test_values', SAGITTA_TEST_SCALE=SCALE)
    lines = tables.run(f'{build}/tests/bench/bench_catalogue').splitlines()
    begin = next(i for i, line in enumerate(lines) if line.startswith('type;surface;'))
    surfaces = [dict(zip(lines[begin].split(';'), line.split(';'))) for line in lines[begin + 1:]]

    worst = {of[0]: of[1:] for of in WORST.findall(values)}
    long_sums = {}
    for name, f, gradient in LONG.findall(values):
        so_far = long_sums.get(name, (0, 0))
        long_sums[name] = max(so_far[0], float(f)), max(so_far[1], float(gradient))

    rows = []
    for kind in dict.fromkeys(s['type'] for s in surfaces if s['type'] in worst):
        points, f, of_rounding, gradient, second, by_parameter = worst[kind]
        of = [s for s in surfaces if s['type'] == kind]
        cost = [', '.join(short(s[column]) + of_which(s) for s in of) for column in ('first', 'one-first')]
        rows.append([f'`{kind}`', of[0]['offers'], f, of_rounding, gradient, second, by_parameter, *cost])
    text = tables.table(['type', 'offers', 'F', 'of `rounding`', 'gradient', 'second', 'by parameter',
                         'ns a ray, in a batch', 'one ray, ns'], rows)
    text += '\n\n' + tables.table(['a long sum', 'F', 'gradient'],
                                  [[name, f'{f:.2g}', f'{gradient:.2g}'] for name, (f, gradient) in long_sums.items()])
    tables.put(tables.DOCS / 'surfaces.md', 'surfaces', f'{tables.machine(build)}\n\n{text}')

    columns = ['met', 'evaluations', 'first', 'near', 'formula', 'times', 'one-first', 'one-near', 'boost']
    head = ['', 'met', 'evaluations', 'batch, first', 'batch, near', 'formula', 'times', 'one ray, first',
            'one ray, near', 'Boost']
    tables.write('surfaces', build, tables.table(head, [[s['surface'], *[short(s[c]) for c in columns]]
                                                        for s in surfaces]))


if __name__ == '__main__':
    main(*sys.argv[1:])
