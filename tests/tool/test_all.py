#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sagitta intersect --all: every root of a ray, in order, and how its rows are numbered.

    python3 test_all.py SAGITTA

The roots of the hard rays were worked out with 30 digits by another program (tests/data).
"""
import json
from decimal import Decimal, getcontext
from fractions import Fraction

from command import *

getcontext().prec = 50
DATA = HERE.parent / 'data'
WAVE = '{type: even_asphere, coefficients: [-0.2, 0.02]}'  # a W: four roots, seen from the side
WAVE_RAY = (0, -6, -0.3, 0, 0.999999500000375, 0.000999999500000375)


def all_of(surface, text, *more, **how):
    return rows('intersect', '--surface', surface, '--rays', '-', '--all', *more, stdin=text, **how)


def hard_cases():
    """(id, surface, ray with its ends, roots) of each ray on which some program has failed."""
    with open(DATA / 'hard_cases.csv', newline='') as file:
        for case in csv.DictReader(file):
            terms = [float(case[f'a{i}']) for i in range(2, 17, 2)]
            radius = '.inf' if case['R'] == 'inf' else case['R']
            spec = f'radius: {radius}, conic: {case["k"]}, semi_diameter: {case["semi_diameter"]}'
            kind = 'even_asphere' if any(terms) else 'conic'
            spec = f'{{type: {kind}, {spec}' + (f', coefficients: {terms}}}' if any(terms) else '}')
            ray = [case[name] for name in ('ox', 'oy', 'oz', 'dx', 'dy', 'dz', 'tmin', 'tmax')]
            yield case['id'], kind, spec, ray, [Decimal(root) for root in case['roots'].split()]


def test_hard_rays():
    met = 0
    for name, kind, surface, ray, roots in hard_cases():
        text = rays(ray, header='ox,oy,oz,dx,dy,dz,tmin,tmax')
        done = run('intersect', '--surface', surface, '--rays', '-', '--all', '--format', 'csv', stdin=text)
        got = list(csv.DictReader(io.StringIO(done.stdout)))
        if not roots:
            equal([(r['ray'], r['root'], r['status'], r['t'], r['x']) for r in got], [('0', '-1', 'miss', 'nan', 'nan')], name)
            continue
        equal([(r['ray'], r['root'], r['status']) for r in got], [('0', str(i), 'hit') for i in range(len(roots))], name)
        for row, root in zip(got, roots):
            assert abs(Decimal(row['t']) - root) <= Decimal(row['t_err']), (name, row, root)
            assert float(row['t_err']) <= 1e-6 * max(1, abs(float(root))), (name, row)
            assert int(row['evals']) > 0, (name, row)
            met += 1
        # a ray enters where F falls along it, and then leaves
        falls = [sum(float(row['n' + x]) * float(ray[i]) for i, x in enumerate('xyz', 3)) < 0 for row in got]
        assert all(a != b for a, b in zip(falls, falls[1:])), (name, falls)
    assert met > 30, met


def test_two_roots_of_a_paraboloid():
    """z = y^2/4, met along the line z = 4 + y/8: 2 y^2 - y - 32 = 0, so y = (1 +- sqrt 257) / 4."""
    got = all_of('{type: conic, radius: 2, conic: -1}', rays((0, -10, 2.75, 0, 1, 0.125)))
    for row, sign in zip(got, (-1, 1)):
        y = Decimal(1) / 4 + sign * Decimal(257).sqrt() / 4
        assert abs(Decimal(row['t']) - 10 - y) <= Decimal(row['t_err']), row
        close(row['y'], float(y), 1e-14)
        close(row['z'], float(4 + y / 8), 1e-14)
    equal([r['root'] for r in got], ['0', '1'])


def test_first_is_the_first():
    """The first of all is what a search for the first finds, up to both bounds."""
    for surface, ray in ((WAVE, WAVE_RAY), ('{type: conic, radius: 2, conic: -1}', (0, -10, 2.75, 0, 1, 0.125)),
                         ('{type: sphere, radius: 3}', (0.5, 0, -4, 0, 0.1, 1)), ('{type: plane}', (1, 2, 3, 0, 1, -2))):
        first, = rows('intersect', '--surface', surface, '--rays', '-', stdin=rays(ray))
        got = all_of(surface, rays(ray))[0]
        equal((got['root'], got['status']), ('0', first['status']), surface)
        assert abs(Fraction(got['t']) - Fraction(first['t'])) <= Fraction(got['t_err']) + Fraction(first['t_err']), (got, first)


def test_rows_of_several_rays():
    """Numbered ray by ray; a ray without a root has one row, and a bad one has none."""
    text = rays((*WAVE_RAY, 'four'), (0, 0, 5, 0, 0, 1, 'none'), ('x', 0, 0, 0, 0, 1, 'bad'), (0, 1, -5, 0, 0, 1, 'one'),
                header='ox,oy,oz,dx,dy,dz,id')
    got = all_of(WAVE, text, '--skip-bad')
    equal([(r['ray'], r['root'], r['id'], r['status']) for r in got],
          [('0', str(i), 'four', 'hit') for i in range(4)] + [('1', '-1', 'none', 'miss'), ('3', '0', 'one', 'hit')])


def test_columns_and_formats():
    text = rays(WAVE_RAY, (0, 0, 5, 0, 0, 1))
    shown = ('intersect', '--surface', WAVE, '--rays', '-', '--all')
    done = run(*shown, '--format', 'csv', stdin=text)
    equal(done.stdout.splitlines()[0], INTERSECT)
    plain = list(csv.DictReader(io.StringIO(done.stdout)))
    lists = json.loads(run(*shown, '--format', 'json', stdin=text).stdout)
    hexadecimal = rows(*shown, '--hex', stdin=text)
    equal((len(plain), len(lists), len(hexadecimal)), (5, 5, 5))
    for p, j, h in zip(plain, lists, hexadecimal):
        equal(list(j), INTERSECT.split(','))
        for name in ('ray', 'root', 'evals'):
            equal((j[name], int(h[name])), (int(p[name]), int(p[name])), name)
        for name in ('t', 'x', 'y', 'z', 'nx', 'ny', 'nz'):
            if p['status'] == 'miss':
                equal((p[name], h[name], j[name]), ('nan', 'nan', None), name)
            else:
                equal((float(p[name]), float.fromhex(h[name])), (j[name], j[name]), name)


def test_ends_of_a_ray():
    """A root at tmin does not count; one at tmax does."""
    whole = all_of(WAVE, rays((*WAVE_RAY, '-inf', 'inf'), header='ox,oy,oz,dx,dy,dz,tmin,tmax'))
    between = [r['t'] for r in whole]
    equal(len(between), 4)
    for first in range(4):
        for last in range(first, 4):
            part = rays((*WAVE_RAY, between[first], between[last]), header='ox,oy,oz,dx,dy,dz,tmin,tmax')
            got = all_of(WAVE, part)
            if first == last:
                equal([(r['root'], r['status']) for r in got], [('-1', 'miss')])
                continue
            equal([r['root'] for r in got], [str(i) for i in range(last - first)], (first, last))
            for row, t in zip(got, between[first + 1:last + 1]):
                close(row['t'], t, 2 * float(row['t_err']))


def test_text_for_people():
    lines = run('intersect', '--surface', WAVE, '--rays', '-', '--all', stdin=rays(WAVE_RAY, (0, 0, 5, 0, 0, 1))).stdout.splitlines()
    equal(lines[0].split(), INTERSECT.split(','))
    equal([line.split()[:3] for line in lines[1:7]], [['0', str(i), 'hit'] for i in range(4)] + [[], ['1', '-1', 'miss']])
    equal(lines[-1], '2 rays, 5 rows: 4 hit, 1 miss.  Every answer is certain.')
    lines = run('intersect', '--surface', WAVE, '--rays', '-', stdin=rays(WAVE_RAY, (0, 0, 5, 0, 0, 1))).stdout.splitlines()
    equal(lines[-1], '2 rays: 1 hit, 1 miss.  Every answer is certain.')


def test_undecided_stretch():
    """What is left of the ray when the evaluations are spent is the last row; no root is lost."""
    full = all_of(WAVE, rays(WAVE_RAY))
    seen = set()
    for most in range(1, 12):
        done = run('intersect', '--surface', WAVE, '--rays', '-', '--all', '--max-evals', most, '--format', 'csv',
                   stdin=rays(WAVE_RAY), exit=None)
        got = list(csv.DictReader(io.StringIO(done.stdout)))
        equal([r['root'] for r in got], [str(i) for i in range(len(got))])
        undecided = [r for r in got if r['status'] not in ('hit', 'graze')]
        equal(done.returncode, UNDECIDED if undecided else DECIDED, most)
        seen.update(r['status'] for r in undecided)
        for row in undecided:
            equal((row['x'], row['nz']), ('nan', 'nan'))
        for root in full:
            assert any(abs(float(r['t']) - float(root['t'])) <= float(r['t_err']) + float(root['t_err']) for r in got), (most, root, got)
    assert 'exhausted' in seen, seen
    said = run('intersect', '--surface', WAVE, '--rays', '-', '--all', '--max-evals', 1, stdin=rays(WAVE_RAY), exit=UNDECIDED).stdout
    assert 'exhausted' in said and 'tmin and tmax' in said and 'certain' not in said, said


def test_help():
    assert '--all' in run('intersect', '--help').stdout


main(globals())
