#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tables of data/batches.md (docs/tables.py has the convention).

    python3 docs/batches_table.py build
    python3 docs/batches_table.py build --avx2    the figures to reach, of a build with -Dclones=x86-64-v3
"""
import re
import sys

import tables

KINDS = [  # of tables: the cases, how each ends, in the order of its columns
    (['plane', 'sphere', 'paraboloid', 'conic', 'asphere'], '1e3'),
    (['plane', 'sphere', 'paraboloid', 'conic', 'asphere'], '1e6'),
    (['own-conic', 'own-asphere'], '1e3'),
    (['scan-lens', 'lens-of-aspheres', 'aspheric-singlet', 'phone-lens'], '1e3'),
    (['scan-lens', 'lens-of-aspheres', 'aspheric-singlet', 'phone-lens'], '1e6'),
]
PLACES = (28, 37, 46, 57, 68)                        # where the columns of the figures to reach end


def short(ns):
    return f'{float(ns):.3g}'


def reached(lines):
    """case/variant, ns, to reach, times the peer, to reach; what is missing is left blank."""
    for line in lines:
        cells = [line[a:b].strip() for a, b in zip((0,) + PLACES, PLACES)]
        if '/' in cells[0]:
            yield cells[0], *[cell or '-' for cell in cells[1:]]


def main(build, which=None):
    lines = tables.run(f'{build}/tests/bench/bench_batch').splitlines()
    medians, order = {}, []
    for line in lines:
        if match := re.fullmatch(r'([\w-]+),([\w-]+),([\d.]+),[\d.e+-]+', line):
            case, variant, ns = match.groups()
            medians[case, variant] = ns
            if variant not in order:
                order.append(variant)
    begin = next(i for i, line in enumerate(lines) if line.split()[:3] == ['ns', 'to', 'reach'])
    parts = [tables.table(['', 'ns', 'to reach', 'times its peer', 'to reach'], reached(lines[begin + 1:]))]
    if which == '--avx2':
        tables.write('batches', build, parts[0], 'batches avx2')
        return
    for cases, size in KINDS:
        names = [f'{case}-{size}' for case in cases]
        rows = [[variant, *[short(medians[name, variant]) if (name, variant) in medians else '-'
                            for name in names]]
                for variant in order if any((name, variant) in medians for name in names)]
        parts.append(tables.table([size, *cases], rows))
    tables.write('batches', build, '\n\n'.join(parts))


if __name__ == '__main__':
    main(*sys.argv[1:])
