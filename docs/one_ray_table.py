#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The table of data/one_ray.md: one ray a call, beside others (docs/tables.py has the convention).

    python3 docs/one_ray_table.py build
"""
import re
import sys

import tables

NAMES = {'newton-by-hand': 'Newton by hand', 'closed-form-by-hand': 'closed form by hand',
         'boost-newton_raphson_iterate': 'Boost.Math, newton_raphson_iterate, 53 bits',
         'boost-newton_raphson_iterate-31-bits': 'the same, 31 bits asked',
         'gsl-fdfsolver_newton': 'GSL, fdfsolver_newton'}
CASES = ['plane', 'sphere', 'paraboloid', 'conic', 'asphere']


def main(build):
    said = tables.run(f'{build}/tests/bench/bench_one_ray')
    ns = {(case, variant): tables.short(time) for case, variant, time
          in re.findall(r'^([\w-]+),([\w-]+),([\d.e+-]+),[\d.e+-]+$', said, re.M)}
    rows = [[NAMES.get(variant, variant), *(ns.get((case, variant), '-') for case in CASES)]
            for variant in dict.fromkeys(variant for _, variant in ns)]
    tables.write('one_ray', build, tables.table(['ns a ray', *CASES], rows))


if __name__ == '__main__':
    main(*sys.argv[1:])
