#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tables of data/trade.md (docs/tables.py has the convention).

    python3 docs/trade_table.py build

runs `sagitta trade` as it is, which draws docs/trade.svg as well; then on one surface of each type and on the
lenses of examples/lenses.
"""
import csv
import io
import pathlib
import sys

import tables

HERE = pathlib.Path(__file__).resolve().parent
SECONDS, SECONDS_OF_EACH = '30', '3'
CASES = {'conic': 'conic', 'asphere': 'asphere', 'scan-lens': 'scan lens, 8 elements',
         'julia': 'Julia, N = 7'}
SURFACES = '''
{type: plane}
{type: sphere, radius: 10}
{type: conic, radius: 10, conic: -0.6}
{type: even_asphere, radius: 10, conic: -0.6, coefficients: [0, 1e-4, -2e-6, 1e-8], semi_diameter: 4}
{type: odd_asphere, curvature: 0.02, conic: -0.7, coefficients: [0, -0.002, 1e-4, 2e-5], semi_diameter: 5}
{type: polynomial_xy, curvature: 0.01, conic: 0.5, coefficients: [[0, 0, 0.014], [0, 2e-3], [0.013, 0, 1e-5]], semi_diameter: 5}
{type: chebyshev, curvature: -0.02, norm_x: 7, norm_y: 9, coefficients: [[0, 0.1, 0.2], [0.1, -0.05], [0.1, 0.02, 0, 0.03]], semi_diameter: 5}
{type: zernike, curvature: 0.02, norm: 6, order: noll, coefficients: [0.1, 0.02, -0.03, 0.2, 0.1, -0.1, 0.03, 0.02, 0.01], semi_diameter: 5}
{type: q_con, curvature: 0.03, conic: -1, norm: 8, coefficients: [0.3, -0.1, 0.05, 0.02, -0.01], semi_diameter: 5}
{type: q_bfs, curvature: 0.03, norm: 8, coefficients: [0.3, -0.1, 0.05, 0.02, -0.01], semi_diameter: 5}
{type: grid, curvature: 0.01, step_x: 2.5, step_y: 3, sag: [[0.1, 0.2, 0.1, 0, 0.1], [0, 0.1, 0.1, 0, 0], [0.1, 0, 0.2, 0, 0.1], [0, 0, 0.1, 0.1, 0]], semi_diameter: 4}
{type: sum, curvature: 0.02, conic: -0.5, semi_diameter: 5, terms: [{type: even_asphere, coefficients: [1e-3, -1e-5]}, {type: zernike, norm: 6, order: noll, coefficients: [0, 0.1, 0.1, 0.1]}]}
{type: toroidal, curvature: 0.025, conic: -1, curvature_x: 0.04, coefficients: [1e-3, -1e-5], semi_diameter: 5}
{type: biconic, curvature_x: 0.04, conic_x: -0.5, curvature_y: -0.02, conic_y: 2, semi_diameter: 5}
{type: cylinder, curvature: 0.05, conic: -0.5, semi_diameter: 5}
{type: quadric, squares: [1, 2, 0.5], products: [0.3, -0.2, 0.1], linear: [1, -1, 0.5], constant: -20}
{type: ellipsoid, a: 5, f: 0.3}
{type: torus, major: 5, minor: 2}
{type: julia, c: [-0.2, 0.8, 0, 0], iterations: 6}
{type: mandelbrot, iterations: 6}
'''.split('\n')[1:-1]


def trade(command, seconds, *arguments):
    """{case: {setting: row}}"""
    text = tables.run(command, 'trade', *arguments, '--seconds', seconds, '--format', 'csv')
    found = {}
    for row in csv.DictReader(io.StringIO(text)):
        found.setdefault(row['case'], {})[row['setting']] = row
    return found


def ns(row):
    return tables.short(row['ns'])


def share(x):
    return f'{float(x):.1e}'


def what_to_turn(command):
    found = trade(command, SECONDS, '--picture', str(HERE / 'trade.svg'))
    of = [found[case] for case in CASES]

    def rows(cell, settings):
        return [[name, *(cell(case, keys) for case in of)] for name, *keys in settings]

    def one_of(case, keys):
        return next(case[key] for key in keys if key in case)

    def total(member):
        return sum(int(case[key][member]) for case in of for _, *keys in settings for key in keys if key in case)
    settings = [('default', 'default'), ('t alone, or the last point', 'out=t', 'out=point'),
                ('all there is', 'out=all'), ('one ray a call', 'single'), ('t_tol = 1e-12', 't_tol=1e-12'),
                ('t_tol = 1e-6', 't_tol=1e-6'), ('proof = root', 'proof=root'), ('proof = first', 'proof=first')]
    errors = [(f'{name}: {of_rays}', key, member) for name, key in
              (('default', 'default'), ('t_tol = 1e-12', 't_tol=1e-12'), ('t_tol = 1e-6', 't_tol=1e-6'))
              for of_rays, member in (('99 %', 'err_99'), ('worst', 'err_worst'))]
    return '\n\n'.join([
        tables.table(['ns a ray', *CASES.values()], rows(lambda case, keys: ns(one_of(case, keys)), settings)),
        tables.table(['times the default', *CASES.values()],
                     rows(lambda case, keys: f'{float(one_of(case, keys)["ns"]) / float(case["default"]["ns"]):.3g}',
                          settings[1:])),
        tables.table(['error', *CASES.values()], rows(lambda case, keys: share(case[keys[0]][keys[1]]), errors)),
        f'The worst path through the lens is off by {share(found["scan-lens"]["default"]["waves_worst"])} waves. '
        f'Undecided rays: {total("undecided")}; wrong ones: {total("wrong")}.'])


def each(command):
    def block(settings, more, cases):
        rows = []
        for arguments in cases:
            (name, table), = list(trade(command, SECONDS_OF_EACH, *arguments).items())[:1]
            rows.append([name, *(ns(table[s]) if s in table else '-' for s in settings),
                         *(share(table['default'][m]) for m in more)])
        return tables.table(['', *settings, *more], rows)
    types = block(['default', 'single', 't_tol=1e-6', 'proof=root', 'proof=first'], ['err_99', 'err_worst'],
                  [('--surface', s) for s in SURFACES])
    lenses = block(['default', 'out=point', 'single', 'pick=first', 'proof=root', 'proof=first'],
                   ['err_99', 'waves_worst'],
                   [(str(lens),) for lens in sorted((HERE.parent / 'examples/lenses').glob('*.yaml'))])
    return f'### Every type\n\n{types}\n\n### Every lens\n\n{lenses}'


def main(build):
    command = f'{build}/src/tool/sagitta'
    tables.write('trade', build, f'{what_to_turn(command)}\n\n{each(command)}')


if __name__ == '__main__':
    main(*sys.argv[1:])
