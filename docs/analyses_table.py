#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The table of data/analyses.md: what analyses cost beside their rays (docs/tables.py has the convention).

    python3 docs/analyses_table.py build [--before BUILD] [--runs N]

tests/bench/rays_and_questions.py measures; further words are passed on to it.
"""
import sys

import tables


def main(build, *words):
    script = tables.DOCS.parent / 'tests/bench/rays_and_questions.py'
    tables.write('analyses', build, tables.run(sys.executable, script, build, *words))


if __name__ == '__main__':
    main(*sys.argv[1:])
