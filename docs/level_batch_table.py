#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tables of data/level_batch.md: batches of level sets (docs/tables.py has the convention).

    python3 docs/level_batch_table.py build
"""
import csv
import sys

import tables


def main(build, *words):
    lines = list(csv.DictReader(tables.run(f'{build}/tests/bench/bench_level_batch', *words).splitlines()))
    cases = list(dict.fromkeys(line['case'] for line in lines))
    of = {(line['case'], line['variant']): line for line in lines}

    def whole(line):
        return f'{float(line["ns"]):,.0f}'

    def several(begin, columns, cells):
        """A row a variant, the columns of each set beside each other."""
        names = list(dict.fromkeys(line['variant'] for line in lines if line['variant'].startswith(begin)))
        head = [f'{case}: {column}' if column == columns[0] else column for case in cases for column in columns]
        return tables.table(['', *head], [[name, *(cell for case in cases for cell in cells(of[case, name]))]
                                          for name in names])

    first = [line for line in lines if line['case'] == cases[0]
             and not line['variant'].startswith(('batch ', 'float '))]
    tables.write('level_batch', build, '\n\n'.join([
        'Every way on the first set:',
        tables.table([cases[0], 'ns a ray', 'ratio', 'evaluations', 'levels', 'busy'],
                     [[line['variant'], whole(line), line['ratio'],
                       *(line[column] or '-' for column in ('evals', 'levels', 'busy'))] for line in first]),
        'The batch with a tolerance:',
        several('batch ', ['ns a ray', 'ratio', 'evaluations'],
                lambda line: [whole(line), line['ratio'], line['evals']]),
        'The march in single precision:',
        several('float ', ['ratio', 'wrong', 'error: 99 %'],
                lambda line: [line['ratio'], f'{100 * float(line["wrong"]):.2g} %', line['err_99']])]))


if __name__ == '__main__':
    main(*sys.argv[1:])
