#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The table of data/random.md: a million random rays (docs/tables.py has the convention).

    python3 docs/random_table.py build [--count N]
"""
import re
import sys

import tables

KINDS = ['conics', 'aspheres', 'narrow: conics', 'narrow: aspheres']
SAMPLES = [  # what the program prints, and the table
    ('t_err / max(error, ulp(t)/2)', 't_err / error of t'), ('p_err / max(error, ulp(p)/2)', 'p_err / error of p'),
    ('normal error of p, ulps of the largest term', 'normal error of p in ulps'), ('evaluations', 'evaluations')]


def main(build, *words):
    said = tables.run(f'{build}/tests/oracle/test_random', *(words or ('--count', '1000000')), '--seed', '1')
    parts = dict(re.findall(r'^((?:narrow: )?(?:conics|aspheres)): (.*?)(?=^$)', said + '\n\n', re.M | re.S))
    answers = {kind: int(re.search(r'(\d+) answers', parts[kind])[1]) for kind in KINDS}
    rows = [['answers', *(f'{answers[kind]:,}' for kind in KINDS)]]
    for status in ('hit', 'miss', 'unproven', 'exhausted'):
        counts = [int(re.search(rf' {status} (\d+)', parts[kind])[1]) for kind in KINDS]
        rows.append([status, *(f'{count:,}' for count in counts)])
    for printed, name in SAMPLES:
        numbers = [re.search(rf'^ *{re.escape(printed)} +(.*)$', parts[kind], re.M)[1].split() for kind in KINDS]
        for place, which in ((1, f'{name}: median'), (2, '99 %'), (4, 'worst')):
            rows.append([which, *(tables.short(one[place]) for one in numbers)])
    failures = re.search(r'(\d+) kinds of failure', said)[1]
    tables.write('random', build, tables.table(['', *KINDS], rows) +
                 f'\n\n{sum(answers.values()):,} answers, {failures} kinds of failure.')


if __name__ == '__main__':
    main(*sys.argv[1:])
