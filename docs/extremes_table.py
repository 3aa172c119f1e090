#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tables of data/extremes.md (docs/tables.py has the convention).

    python3 docs/extremes_table.py build

runs build/tests/extremes/table with 2,000 rays a row, and asks the command about single rays.
"""
import csv
import io
import re
import subprocess
import sys

import tables

UNIT, CUP = '{type: sphere, radius: 1}', '{type: conic, radius: 1, conic: -1}'
BUMP = '{type: even_asphere, coefficients: [0.5, -0.125], semi_diameter: 1.5}'
ROWS = [  # surface, ray, what is special about it
    (UNIT, '0.3 0.2 -1e12 0 0 1', 'from 1e12 radii: an ulp of t is 1.2e-4'),
    (UNIT, '0 0.9999999999999999 -5 0 0 1', 'an ulp inside the equator'),
    (UNIT, '0 1 -5 0 0 1', 'on the equator'),
    (UNIT, '0 1.0000000000000002 -5 0 0 1', 'an ulp outside'),
    (CUP, '-3 0 -3.5 1 0 1 -inf inf', 'exactly tangent'),
    (CUP, '-3 0 -3.4999999999999996 1 0 1 -inf inf', 'an ulp nearer'),
    (CUP, '-3 0 -3.5000000000000004 1 0 1 -inf inf', 'an ulp farther'),
    (BUMP, '1 -4 0.375 0 1 0 -inf inf', 'exactly tangent'),
    (BUMP, '1 -4 0.3750000000000001 0 1 0 -inf inf', 'two ulps nearer'),
    (BUMP, '1 -4 0.3749999999999999 0 1 0 -inf inf', 'two ulps farther'),
    ('{type: conic, curvature: 1e-300}', '1 2 -5 1 0 0', 'parallel to a nearly flat surface, the root 1e150 away'),
    ('{type: conic, curvature: 1e300, conic: -1}', '0 1 -5 0 0 1', 'a sag of 5e299 on a radius of 1e-300'),
    ('{type: plane}', '1 2 0 1 0 0', 'the ray lies in the plane'),
]


def asked(command, surface, ray):
    done = subprocess.run([command, 'intersect', '--surface', surface, '--ray', ray, '--format', 'csv'],
                          capture_output=True, text=True)
    answer = next(csv.DictReader(io.StringIO(done.stdout)))
    met = answer['status'] in ('hit', 'graze')
    return [answer['status'], *(answer[name] if met else '-' for name in ('t', 'z'))]


def row_by_row(build):
    rows = [[f'`{surface}`', f'`{ray}`', special, *asked(f'{build}/src/tool/sagitta', surface, ray)]
            for surface, ray, special in ROWS]
    return '### Row by row\n\n' + tables.table(['surface', 'ray', '', 'answer', 't', 'z'], rows)


def main(build):
    done = subprocess.run([f'{build}/tests/extremes/table', '--count', '2000'], capture_output=True, text=True)
    answers, failures = re.search(r'(\d+) answers, .* (\d+) failures', done.stderr).groups()
    tables.write('extremes', build, '\n\n'.join([
        f'{int(answers):,} answers of {int(answers) // 3:,} rays, {failures} failures.', done.stdout.strip(),
        row_by_row(build)]))


if __name__ == '__main__':
    main(*sys.argv[1:])
