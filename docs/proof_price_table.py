#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tables of data/proof_price.md: what proofs cost (docs/tables.py has the convention).

    python3 docs/proof_price_table.py build
"""
import re
import sys

import tables

LINE = re.compile(r'^(\S.*?) +(batch|single) +([\d.]+) +[\d.]+ +([\d.]+) +([\d.]+) +([\d.]+) +([\d.]+)$', re.M)
DECIDED = 93                                         # per cent, from which on L decides a row


def main(build):
    of = {}
    for name, way, *numbers in LINE.findall(tables.run(f'{build}/tests/bench/bench_proof')):
        of.setdefault(name, {})[way] = numbers
    lenses, decided, others = [], [], []
    for name, ways in of.items():
        share, open_, *batch = ways['batch']
        single = ways['single'][2:] if 'single' in ways else ['-'] * 3
        cells = [f'{float(share):.0f}', f'{float(open_):.0f}', tables.short(batch[0]), *batch[1:],
                 tables.short(single[0]) if single[0] != '-' else '-', *single[1:]]
        if name.startswith('lens '):
            lenses.append([name[5:], *cells])
        else:
            (decided if float(share) >= DECIDED else others).append([name, *cells])
    head = ['', 'L decides, %', 'open, %', 'batch, ns', 'root', 'first', 'single, ns', 'root', 'first']
    tables.write('proof_price', build, '\n\n'.join([
        'The lenses of examples/lenses, a field each, the pupil filled:', tables.table(head, lenses),
        'Surfaces, where L decides:', tables.table(head, decided),
        'Where it does not: no rim, a rim near the equator, or shallow rays:', tables.table(head, others)]))


if __name__ == '__main__':
    main(*sys.argv[1:])
