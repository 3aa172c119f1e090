#!/usr/bin/env python3
"""The tables of accuracy.md's section on batches, from what the benchmark prints.

    build/tests/bench/bench_batch > batches.txt
    python3 docs/batches_table.py batches.txt
"""
import re
import sys

KINDS = [  # of tables: the cases, how each ends, in the order of its columns
    (['plane', 'sphere', 'paraboloid', 'conic', 'asphere'], '1e3'),
    (['plane', 'sphere', 'paraboloid', 'conic', 'asphere'], '1e6'),
    (['own-conic', 'own-asphere'], '1e3'),
    (['scan-lens', 'lens-of-aspheres', 'aspheric-singlet', 'phone-lens'], '1e3'),
    (['scan-lens', 'lens-of-aspheres', 'aspheric-singlet', 'phone-lens'], '1e6'),
]
PLACES = (28, 37, 46, 57, 68)                        # where the columns of the figures to reach end


def row(cells):
    return '| ' + ' | '.join(cells) + ' |'


def table(head, rows):
    return '\n'.join([row(head), '|' + '---|' * len(head), *map(row, rows)])


def short(ns):
    return f'{float(ns):.3g}'


def reached(lines):
    """case/variant, ns, to reach, times the peer, to reach; what is missing is left blank."""
    for line in lines:
        cells = [line[a:b].strip() for a, b in zip((0,) + PLACES, PLACES)]
        if '/' in cells[0]:
            yield cells[0], *[cell or '-' for cell in cells[1:]]


def main(path):
    lines = open(path).read().splitlines()
    medians, order = {}, []
    for line in lines:
        if match := re.fullmatch(r'([\w-]+),([\w-]+),([\d.]+),[\d.e+-]+', line):
            case, variant, ns = match.groups()
            medians[case, variant] = ns
            if variant not in order:
                order.append(variant)
    begin = next(i for i, line in enumerate(lines) if line.split()[:3] == ['ns', 'to', 'reach'])
    print(table(['', 'ns', 'to reach', 'times its peer', 'to reach'], reached(lines[begin + 1:])), end='\n\n')
    for cases, size in KINDS:
        names = [f'{case}-{size}' for case in cases]
        rows = [[variant, *[short(medians[name, variant]) if (name, variant) in medians else '-'
                            for name in names]]
                for variant in order if any((name, variant) in medians for name in names)]
        print(table([size, *cases], rows), end='\n\n')


if __name__ == '__main__':
    main(*sys.argv[1:])
