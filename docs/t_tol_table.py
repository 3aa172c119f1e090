#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The table of data/t_tol.md: an asphere at looser tolerances (docs/tables.py has the convention).

    python3 docs/t_tol_table.py build

A thousand rays by `sagitta intersect --t-tol`.  They lie on two sunflower spirals, so that they are the same
everywhere: origins in the disk of radius 2.5 at z = -5, slopes up to 0.15.
"""
import csv
import math
import sys
import tempfile

import tables

SURFACE = ('{type: even_asphere, curvature: 0.1, conic: -0.6, coefficients: [0, 1e-4, -2e-6, 1e-8], '
           'semi_diameter: 4}')
TOLERANCES = ('0', '1e-15', '1e-12', '1e-9', '1e-6', '1e-3')
RAYS = 1000


def ray(i):
    r, a = 2.5 * math.sqrt((i + 0.5) / RAYS), 2.399963229728653 * i
    s, b = 0.15 * math.sqrt((i * 377 % RAYS + 0.5) / RAYS), 1.7 * i
    return r * math.cos(a), r * math.sin(a), -5, s * math.cos(b), s * math.sin(b), math.sqrt(1 - s * s)


def main(build):
    with tempfile.NamedTemporaryFile('w', suffix='.csv') as rays:
        rays.write('ox,oy,oz,dx,dy,dz\n' + ''.join(','.join(f'{x:.17g}' for x in ray(i)) + '\n' for i in range(RAYS)))
        rays.flush()
        answers = {t_tol: list(csv.DictReader(tables.run(
            f'{build}/src/tool/sagitta', 'intersect', '--surface', SURFACE, '--rays', rays.name, '--t-tol', t_tol,
            '--format', 'csv').splitlines())) for t_tol in TOLERANCES}
    rows = []
    for t_tol, hits in answers.items():
        evals, errors = [int(hit['evals']) for hit in hits], sorted(float(hit['t_err']) for hit in hits)
        moved = max(abs(float(hit['t']) - float(exact['t'])) for hit, exact in zip(hits, answers['0']))
        rows.append([t_tol, str(sum(hit['status'] == 'hit' for hit in hits)), f'{sum(evals) / RAYS:.2f}',
                     str(max(evals)), *(tables.short(x) for x in (errors[RAYS // 2], errors[-1], moved))])
    tables.write('t_tol', build, tables.table(['t_tol', 'hits', 'mean evaluations', 'most', 'median t_err', 'largest',
                                               'largest change of t'], rows))


if __name__ == '__main__':
    main(*sys.argv[1:])
