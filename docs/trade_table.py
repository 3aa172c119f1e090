#!/usr/bin/env python3
"""The tables of every type and every lens in accuracy.md, section "The trade".

    python3 docs/trade_table.py build

runs `sagitta trade` on one surface of each type and on the lenses of examples/lenses, and prints the tables.
"""
import csv
import io
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
SECONDS = '3'
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


def trade(command, *arguments):
    done = subprocess.run([command, 'trade', *arguments, '--seconds', SECONDS, '--format', 'csv'],
                          capture_output=True, text=True, check=True)
    table = list(csv.DictReader(io.StringIO(done.stdout)))
    return table[0]['case'], {row['setting']: row for row in table if row['case'] == table[0]['case']}


def ns(row):
    return f'{float(row["ns"]):,.3g}' if float(row['ns']) < 1000 else f'{float(row["ns"]):,.0f}'


def line(cells):
    print('| ' + ' | '.join(cells) + ' |')


def main(build):
    command = str(pathlib.Path(build) / 'src/tool/sagitta')
    def block(settings, more, cases):
        line(['', *settings, *more])
        line(['---'] * (1 + len(settings) + len(more)))
        for arguments in cases:
            name, table = trade(command, *arguments)
            line([name, *(ns(table[s]) if s in table else '-' for s in settings),
                  *(f'{float(table["default"][m]):.1e}' for m in more)])
        print()
    block(['default', 'single', 't_tol=1e-6', 'proof=root', 'proof=first'], ['err_99', 'err_worst'],
          [('--surface', s) for s in SURFACES])
    block(['default', 'out=point', 'single', 'pick=first', 'proof=root', 'proof=first'],
          ['err_99', 'waves_worst'],
          [(str(lens),) for lens in sorted((HERE.parent / 'examples/lenses').glob('*.yaml'))])


if __name__ == '__main__':
    main(*sys.argv[1:])
