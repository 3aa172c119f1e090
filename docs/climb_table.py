#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The table of data/climb.md: the greatest errors over their bounds (docs/tables.py has the convention).

    python3 docs/climb_table.py build
"""
import sys

import tables


def main(build):
    head = ['', 't', 't, proven', 'p', 'F', 'g', "g'"]
    rows = [tables.run(f'{build}/tests/{room}/test_climb', '--table', SAGITTA_TEST_SCALE='3')
            for room in ('catalogue', 'geo')]
    tables.write('climb', build, '\n'.join([tables.table(head, []), *(line for text in rows
                                            for line in text.splitlines() if line.startswith('| '))]))


if __name__ == '__main__':
    main(*sys.argv[1:])
