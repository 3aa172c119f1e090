#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tables of data/proof.md: what is claimed, against Arb (docs/tables.py has the convention).

    python3 docs/proof_table.py build [--part N]    a part: rays by thousands (1000: all of them)
"""
import re
import sys

import tables

OPTICAL = {'ordinary': 'ordinary', 'far': 'far, to 1e12 sizes', 'parallel': 'along the axes, nearly',
           'start': 'from the surface, or ending on it', 'tangent': 'tangent to 1e-12',
           'pair': 'a pair of roots, 1e-18 to 1e-9 apart', 'equator': 'next to the equator',
           'rim': 'within some ulps of the rim'}
LEVELS = {'ordinary, set': 'ordinary', 'far, set': 'far, to 1e9 sizes', 'start, set': 'from the surface',
          'tangent, set': 'tangent, by halving between a hit and a miss'}


def rows(said, names, columns):
    """Kind, rays, and per cents: (5, 2) is what stands in column 5 behind the second /."""
    for kind, name in names.items():
        if line := re.search(rf'^{re.escape(kind)} +(\d+) +\d+ +\d+ +\d+ +(\S.*)$', said, re.M):
            shares = [share.split('/') + ['0'] for share in line[2].split()]
            yield [name, f'{int(line[1]):,}', *(shares[column][which] for column, which in columns)]


def main(build, option='--part', part='1000'):
    def asked(optical, levels, unproven, seed):
        counts = (str(count * int(part) // 1000) for count in (optical, levels, unproven))
        options = sum(zip(('--optical', '--levels', '--unproven'), counts), ())
        return tables.run(f'{build}/tests/proof/test_proof', *options, '--seed', seed)
    optical, plain = asked(10**6, 0, 0, '20260101'), asked(0, 0, 10**7, '20260103')
    levels = asked(0, 10**4, 0, '20260106')
    hits = re.search(r'(\d+) rays, (\d+) hits', plain)
    wrong = len(re.findall('^ *FAIL', optical + plain + levels, re.M))
    tables.write('proof', build, '\n\n'.join([
        'Undecided conics and aspheres:',
        tables.table(['per cent', 'rays', 'estimate', 'root', 'first', 'near the seed, root', 'first', 'others'],
                     rows(optical, OPTICAL, [(0, 0), (1, 0), (2, 0), (3, 0), (4, 0), (4, 1)])),
        'Undecided level sets:',
        tables.table(['per cent', 'rays', 'first: estimate', 'root', 'first', 'all: estimate', 'root', 'first'],
                     rows(levels, LEVELS, [(0, 0), (1, 0), (2, 0), (5, 0), (6, 0), (7, 0)])),
        f'Without proof: {int(hits[1]):,} rays, {int(hits[2]):,} hits. Kinds of wrong claims in all: {wrong}.']))


if __name__ == '__main__':
    main(*sys.argv[1:])
