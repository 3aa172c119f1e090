#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sagitta intersect: columns, numbers that read back, statuses, options.

    python3 test_intersect.py SAGITTA
"""
import json
import math
import random

from command import *

SPHERE = '{type: sphere, radius: -2.2136}'


def intersect(surface, text, *more, **how):
    return rows('intersect', '--surface', surface, '--rays', '-', *more, stdin=text, **how)


def test_columns():
    done = run('intersect', '--surface', SPHERE, '--ray', '0 0 -5 0 0 1', '--format', 'csv')
    equal(done.stdout.splitlines()[0], INTERSECT)
    done = run('intersect', '--surface', SPHERE, '--rays', '-', '--format', 'csv',
               stdin=rays((0, 0, -5, 0, 0, 1, 'a'), header='ox,oy,oz,dx,dy,dz,id'))
    equal(done.stdout.splitlines()[0], INTERSECT + ',id')


def test_published_root():
    """R. Laikin's scan lens, first surface, the ray on which a gradient scaled to 1 fails."""
    row, = intersect(SPHERE, rays((0, 0.5, -5, 0, 0.3420201433256687, 0.9396926207859084)))
    equal((row['ray'], row['root'], row['status']), ('0', '0', 'hit'))
    close(row['t'], 4.143085073464611924, 1e-15)
    close(row['y'], 1.91701855063680506, 1e-15)
    close(row['z'], -1.10677352917706055, 1e-15)
    close(float(row['ny']) / float(row['nz']), 1.7319955757938, 1e-12)
    assert 0 < float(row['t_err']) < 1e-14


def test_plane_against_its_formula():
    """Every number as the C library reads it, and within its bound taken as a decimal."""
    from fractions import Fraction
    draw = random.Random(1)
    several = [[draw.uniform(-9, 9) for _ in range(6)] for _ in range(300)]
    for row, ray in zip(intersect('{type: plane}', rays(*several), '--pick', 'near-seed'), several):
        root = -Fraction(ray[2]) / Fraction(ray[5])
        if root > 0:
            assert abs(Fraction(row['t']) - root) <= Fraction(row['t_err']), (ray, row)
        else:
            equal(row['status'], 'miss')


def test_round_trip():
    """csv, json and hexadecimal say the same doubles (t_err in decimal covers the decimal)."""
    draw = random.Random(2)
    several = [[draw.gauss(0, 1) * 10 ** draw.randint(-3, 3) for _ in range(3)] + [draw.gauss(0, 1) for _ in range(3)]
               for _ in range(200)]
    text = rays(*([repr(v) for v in ray] for ray in several))
    shown = ('intersect', '--surface', '{type: conic, radius: 30, conic: -0.7}', '--rays', '-')
    plain = rows(*shown, stdin=text)
    hexadecimal = rows(*shown, '--hex', stdin=text)
    lists = json.loads(run(*shown, '--format', 'json', stdin=text).stdout)
    hex_lists = json.loads(run(*shown, '--format', 'json', '--hex', stdin=text).stdout)
    equal(len(plain), 200)
    met = 0
    for p, h, j, x in zip(plain, hexadecimal, lists, hex_lists):
        equal(list(j), INTERSECT.split(','))
        equal((j['ray'], j['root'], j['status'], j['evals']), (int(p['ray']), int(p['root']), p['status'], int(p['evals'])))
        for name in ('t', 'x', 'y', 'z', 'nx', 'ny', 'nz', 't_err'):
            if p['status'] == 'miss':
                equal((p[name], h[name], j[name]), ('nan', 'nan', None))
                continue
            met += 1
            value = float(p[name])
            equal(j[name], value, name)
            equal(float.fromhex(x[name]), float.fromhex(h[name]), name)
            if name == 't_err':
                assert float.fromhex(h[name]) <= value <= 1.01 * float.fromhex(h[name]) + math.ulp(float(p['t']))
            else:
                equal(float.fromhex(h[name]), value, name)
                assert len(p[name].lstrip('-').replace('.', '').split('e')[0].lstrip('0')) <= 17
    assert met > 100


def test_numbers_as_they_may_be_written():
    for radius in ('-2.2136', '-22136e-4', '-.22136e+1', '-2.21360', '-0x1.1b573eab367a1p+1', '-2.2136E0'):
        row, = intersect('{"type": "sphere", "radius": %s}' % radius, rays((0, 1, -5, 0, 0, 1)))
        close(row['t'], 4.761248085296689, 1e-14, radius)
    for radius in ('.inf', '-.inf', '".inf"', '"inf"', '.Inf', 'inf', '+.INF', '"-inf"'):
        row, = intersect('{type: sphere, radius: %s}' % radius, rays((0, 1, -5, 0, 0, 1)))
        equal((row['t'], row['z']), ('5', '0'), radius)


def test_radius_is_one_over_curvature():
    ray = rays((0.3, 1, -5, 0.1, 0, 1))
    for radius in (-2.2136, 3.0, 7.7, 1e9):
        equal(intersect('{type: sphere, radius: %r}' % radius, ray), intersect('{type: sphere, curvature: %r}' % (1 / radius), ray))


def test_statuses_and_exit():
    text = rays((0, 0, -5, 0, 0, 1), (0, 9, -5, 0, 0, 1))
    equal([r['status'] for r in intersect(SPHERE, text)], ['hit', 'miss'])
    equal([r['root'] for r in intersect(SPHERE, text)], ['0', '-1'])
    asphere = '{type: even_asphere, radius: 20, coefficients: [-2e-4, -5e-6, -6e-8]}'
    row, = intersect(asphere, rays((0, 9, -5, 0, 0.1, 1)), '--max-evals', '1', exit=UNDECIDED)
    equal((row['status'], row['root']), ('exhausted', '0'))


def test_semi_diameter_is_a_filter():
    for y, status in ((1.99, 'hit'), (2.0, 'hit'), (2.01, 'miss')):
        row, = intersect('{type: sphere, radius: -2.2136, semi_diameter: 2}', rays((0, y, -5, 0, 0, 1)))
        equal(row['status'], status, y)


def test_ends_of_a_ray():
    header = 'tmax,dz,tmin,ox,oy,oz,dx,dy'
    for tmin, tmax, status in ((0, 'inf', 'hit'), ('-inf', 'inf', 'hit'), (0, 4, 'miss'), (6, 9, 'miss'), (5, 6, 'miss'),
                               (4.9, 5, 'hit'), (0, 0, 'miss'), ('-inf', 0, 'miss')):
        row, = intersect('{type: plane}', rays((tmax, 1, tmin, 0, 0, -5, 0, 0), header=header))
        equal(row['status'], status, (tmin, tmax))
    one = ('intersect', '--surface', '{type: plane}', '--ray')
    equal(rows(*one, '0 0 5 0 0 1')[0]['status'], 'miss')
    equal(rows(*one, '0, 0, 5, 0, 0, 1, -inf, inf')[0]['t'], '-5')


def test_pick():
    """A steep ray meets a deep paraboloid twice: first on the near wall, then where its tangent plane led."""
    text = rays((0, -10, 5, 0, 1, -0.2))
    surface = '{type: conic, radius: 2, conic: -1}'
    first, = intersect(surface, text, '--pick', 'first')
    equal(intersect(surface, text), [first])
    other, = intersect(surface, text, '--pick', 'near-seed')
    for row in (first, other):
        close(float(row['y']) ** 2 / 4, row['z'], 1e-13)
    assert float(first['t']) < float(other['t'])


def test_t_tol():
    surface = '{type: even_asphere, radius: 20, coefficients: [-2e-4, -5e-6, -6e-8]}'
    text = rays((0, 6, -5, 0, 0.1, 1))
    sharp, = intersect(surface, text)
    blunt, = intersect(surface, text, '--t-tol', '1e-3')
    assert int(blunt['evals']) <= int(sharp['evals'])
    assert abs(float(sharp['t']) - float(blunt['t'])) <= float(blunt['t_err']) + float(sharp['t_err'])


def test_csv_as_spreadsheets_write_it():
    text = '\ufeff ox , "oy",oz,dx,dy,dz,id\r\n\r\n 0 ,0,-5, 0,0,"1","a ""b"", c"\r\n   \r\n0,0,-6,0,0,1, d\t'
    got = intersect('{type: plane}', text)
    equal([r['t'] for r in got], ['5', '6'])
    equal([r['id'] for r in got], ['a "b", c', 'd'])
    shown = ('intersect', '--surface', '{type: plane}', '--rays', '-', '--format', 'json')
    equal([r['id'] for r in json.loads(run(*shown, stdin=text).stdout)], ['a "b", c', 'd'])


def test_skip_bad():
    """Bad rows keep their numbers, so that what is left can be joined with the file."""
    text = rays((0, 0, -5, 0, 0, 1), (0, 0, 'x', 0, 0, 1), (0, 0, -6, 0, 0, 0), (0, 0, -7, 0, 0, 1))
    shown = ('intersect', '--surface', '{type: plane}', '--rays', '-', '--skip-bad')
    got = rows(*shown, stdin=text)
    equal([(r['ray'], r['t']) for r in got], [('0', '5'), ('3', '7')])
    done = run(*shown, stdin=text)
    assert '2 bad rows skipped' in done.stderr and 'line 3' in done.stderr and 'oz' in done.stderr, done.stderr


def test_no_rays():
    shown = ('intersect', '--surface', '{type: plane}', '--rays', '-')
    assert 'no rays' in run(*shown, stdin=rays(), exit=BAD_INPUT).stderr
    one = rays((0, 0, 'x', 0, 0, 1))  # all of them skipped: an empty table
    equal(intersect('{type: plane}', one, '--skip-bad'), [])
    equal(json.loads(run(*shown, '--skip-bad', '--format', 'json', stdin=one).stdout), [])
    run(*shown, '--skip-bad', stdin=one)


def test_output_file():
    path = written('').parent / 'out.csv'
    shown = ('intersect', '--surface', SPHERE, '--ray', '0 0 -5 0 0 1', '--format', 'csv')
    equal(run(*shown, '--output', path).stdout, '')
    equal(path.read_text(), run(*shown).stdout)


def test_text_for_people():
    text = rays((0, 0.5, -5, 0, 0.3420201433256687, 0.9396926207859084), (0, 9, -5, 0, 0, 1))
    lines = run('intersect', '--surface', SPHERE, '--rays', '-', stdin=text).stdout.splitlines()
    equal(lines[0].split(), INTERSECT.split(','))
    assert '4.14308507' in lines[1] and 'miss' in lines[2]
    equal(lines[-1], '2 rays: 1 hit, 1 miss.  Every answer is certain.')


TWENTY = '{type: sphere, radius: 20}'  # its curvature, as a double, is above 1/20: it ends an ulp before r = 20


def test_reason_of_a_miss():
    for surface, ray, word in (
            (SPHERE, '0 5 -5 0 0 1', 'within r = 2.2136'), ('{type: plane}', '0 0 5 0 0 1', 'root at t = -5'),
            ('{type: plane, semi_diameter: 1}', '0 3 -5 0 0 1', 'r = 3'),
            ('{type: zernike, norm: 1, order: noll, semi_diameter: 1}', '0 3 -5 0 0 1', 'only outside semi_diameter, first at r = 3'),
            ('{type: q_bfs, radius: 2, norm: 1}', '0 3 -5 0 0 1', 'never comes within r = 2'),
            ('{type: grid, step_x: 1, step_y: 1, sag: [[0,0,0,0],[0,0,0,0],[0,0,0,0],[0,0,0,0]]}', '0 3 -5 0 0 1', 'there is no surface'),
            ('{type: torus, major: 3, minor: 1}', '0 0 -5 0 0 1', 'passes beside the surface'), ('{type: torus, major: 3, minor: 1}', '3 0 0 0 0 1 2 5', 'outside tmin'),
            ('{type: plane}', '0 0 -5 0 1 0', 'parallel'),
            (TWENTY, '20 0 -5 0 0 1', 'very edge of the surface'), (TWENTY, '20 -5 20 0 1 0', 'ends, to within rounding'),
            ('{type: sphere, radius: 20, semi_diameter: 5}', '20 0 -5 0 0 1', 'outside semi_diameter'),
            (TWENTY, '-5 0 -1e-9 1 0 0', 'only just misses'), (TWENTY, '5 0 40 1 0 0', 'near, but only to the other'),
            (TWENTY, '25 0 25 -1 0 -1 0 3', 'Outside of them one is in doubt'),
            ('{type: sphere, radius: 2}', '0 0 3.5 0 1 0', 'other sheet'), ('{type: sphere, radius: 2}', '0 0 5 0 1 0', 'passes beside the whole')):
        for command in ('intersect', 'diagnose'):
            done = run(command, '--surface', surface, '--ray', ray)
            assert word in done.stdout, (surface, ray, done.stdout)
    for far in 1, 1e2, 1e4, 1e6, 1e8:  # the reason is that of the line, wherever it begins
        for offset, word in ((70, 'passes beside the whole'), (14.5, 'passes beside the whole')):
            ray = f'0 {-far!r} {-far - offset!r} 0 1 1'
            said = run('intersect', '--surface', '{type: sphere, radius: 10}', '--ray', ray).stdout
            assert word in said, (ray, said)


def test_many_rays():
    """More than fit into any first allocation."""
    equal(len(intersect('{type: plane}', rays(*((0, i / 1000, -5, 0, 0, 1) for i in range(5000))))), 5000)


main(globals())
