#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Julia and Mandelbrot sets at the command: every key, all roots, the fast way, a lens.

    python3 test_level_sets.py SAGITTA

The oracle is the orbit itself, in a few lines, first in doubles at many points along the
ray: between two of them of unlike sign lies an odd number of roots, between two of one sign
an even number.  Then with 60 digits: the sign changes within t_err of each root reported.
SAGITTA_TEST_SEED chooses other rays (1), SAGITTA_TEST_SCALE multiplies how many (1).
"""
import json
import math
import random
from decimal import Decimal, getcontext

from command import *

getcontext().prec = 60
SEED, SCALE = int(os.environ.get('SAGITTA_TEST_SEED', '1'), 0), float(os.environ.get('SAGITTA_TEST_SCALE', '1'))
UNIT = {'ex': (1, 0, 0, 0), 'ey': (0, 1, 0, 0), 'ez': (0, 0, 1, 0)}

# The set named first is the one that the others differ from, each in one key.
JULIA = {'type': 'julia', 'c': [-0.2, 0.8, 0.0, 0.0], 'iterations': 6, 'escape': 4.0}
MANDELBROT = {'type': 'mandelbrot', 'iterations': 5, 'escape': 4.0}
JULIAS = [JULIA] + [{**JULIA, **other} for other in (
    {'c': [-0.083, 0.0, -0.83, -0.025]}, {'at': [0.1, -0.05, 0.0, 0.2]}, {'slice': 0.3}, {'iterations': 9}, {'escape': 2.5},
    {'power': 3, 'iterations': 4}, {'power': 8, 'iterations': 2, 'c': [0.6, 0.2, -0.3, 0.1]},
    {'ex': [0.6, 0.0, 0.8, 0.0], 'ey': [0.0, 1.0, 0.0, 0.0], 'ez': [0.0, 0.0, 0.28, 0.96]},
    {'ex': [0.0, 0.0, 1.0, 0.0], 'ey': [1.0, 0.0, 0.0, 0.0], 'ez': [0.0, 1.25, 0.0, 0.5]})]
MANDELBROTS = [MANDELBROT] + [{**MANDELBROT, **other} for other in (
    {'at': [-0.5, 0.0, 0.1, 0.0]}, {'slice': -0.25}, {'iterations': 8}, {'escape': 2.5}, {'power': 3, 'iterations': 4},
    {'ex': [0.0, 1.0, 0.0, 0.0], 'ey': [0.0, 0.0, 1.0, 0.0], 'ez': [0.8, 0.0, 0.0, 0.6]})]


# ------------------------------------------------------------------ the oracle

def multiply(a, b):
    return (a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3], a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
            a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1], a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0])


def excess(shape, p, number=float):
    """|Q_N|^2 - E^2, its sign that of F; once far outside, the orbit is not followed."""
    at = [number(v) for v in shape.get('at', (0, 0, 0, shape.get('slice', 0)))]
    axes = [[number(v) for v in shape.get(name, UNIT[name])] for name in ('ex', 'ey', 'ez')]
    start = tuple(at[i] + sum(p[k] * axes[k][i] for k in range(3)) for i in range(4))
    julia = shape['type'] == 'julia'
    c = tuple(number(v) for v in shape['c']) if julia else start
    q = start if julia else (number(0),) * 4
    for _ in range(shape['iterations']):
        power = q
        for _ in range(shape.get('power', 2) - 1):
            power = multiply(power, q)
        q = tuple(u + v for u, v in zip(power, c))
        if sum(v * v for v in q) > 1000000:
            break
    return sum(v * v for v in q) - number(shape['escape']) ** 2


def along(shape, ray, t, number=float):
    return excess(shape, [number(ray[i]) + t * number(ray[i + 3]) for i in range(3)], number)


def changes_sign(shape, ray, row):
    t, t_err = Decimal(row['t']), Decimal(row['t_err'])
    return (along(shape, ray, t - t_err, Decimal) > 0) != (along(shape, ray, t + t_err, Decimal) > 0)


# --------------------------------------------------------------------- helpers

def intersect(shape, several, *more, **how):
    return rows('intersect', '--surface', json.dumps(shape), '--rays', '-', *more, stdin=rays(*several), **how)


def by_ray(got):
    several = {}
    for row in got:
        several.setdefault(int(row['ray']), []).append(row)
    return several


def random_rays(draw, count, radius=3.0):
    """From a sphere about the set toward somewhere in it; every third from inside the sphere."""
    several = []
    for i in range(count):
        start, goal = ([draw.gauss(0, 1) for _ in range(3)] for _ in range(2))
        length = math.hypot(*start)
        start = [(radius if i % 3 else 0.6) * v / length for v in start]
        several.append((*start, *(0.4 * g - s for g, s in zip(goal, start))))
    return several


def check_all(shape, several, samples=2000):
    """Every root along each ray, against the oracle; how many there were."""
    got, met = by_ray(intersect(shape, several, '--all')), 0
    for number, ray in enumerate(several):
        mine = got[number]
        if mine[0]['status'] == 'miss':
            equal([(r['root'], r['t']) for r in mine], [('-1', 'nan')], (shape, ray))
            mine = []
        equal([(r['root'], r['status']) for r in mine], [(str(i), 'hit') for i in range(len(mine))], (shape, ray))
        t = [float(r['t']) for r in mine]
        assert t == sorted(t), (shape, ray, t)
        for row in mine:
            assert changes_sign(shape, ray, row), (shape, ray, row)
            assert float(row['t_err']) < 1e-6 and int(row['evals']) > 0, (shape, ray, row)
        end = 8 / math.hypot(*ray[3:])
        outside, root = along(shape, ray, 0.0) > 0, 0
        for i in range(1, samples + 1):
            here = end * i / samples
            before = root
            while root < len(t) and t[root] <= here:
                root += 1
            now = along(shape, ray, here) > 0
            assert (now != outside) == ((root - before) % 2 == 1), (shape, ray, here, t)
            outside = now
        equal(root, len(t), (shape, ray))
        # it enters where F falls, n . d < 0, and then leaves
        slopes = [sum(float(r['n' + x]) * ray[k] for k, x in enumerate('xyz', 3)) for r in mine]
        start_outside = along(shape, ray, 0.0) > 0
        equal([s < 0 for s in slopes], [i % 2 != start_outside for i in range(len(slopes))], (shape, ray, slopes))
        met += len(t)
    return met


# ----------------------------------------------------------------------- tests

def test_all_roots():
    """Each key, alone, against the orbit: a key that were not read would show."""
    draw = random.Random(SEED)
    count = max(3, round(6 * SCALE))
    for shape in JULIAS + MANDELBROTS:
        met = check_all(shape, random_rays(draw, count))
        assert met >= 2, (shape, met)


def test_each_key_matters():
    draw = random.Random(SEED)
    several = random_rays(draw, 12)
    for shapes in (JULIAS, MANDELBROTS):
        answers = [tuple(r['t'] for r in intersect(shape, several)) for shape in shapes]
        equal(len(set(answers)), len(shapes))


def test_two_ways_to_say_it():
    several = random_rays(random.Random(SEED), 6)
    for base in (JULIA, MANDELBROT):
        plain = intersect({**base, 'slice': 0.25}, several)
        equal(plain, intersect({**base, 'at': [0, 0, 0, 0.25]}, several))
        equal(intersect(base, several), intersect({**base, **{name: list(axis) for name, axis in UNIT.items()}}, several))
        equal(intersect(base, several), intersect({**base, 'power': 2, 'slice': 0, 'iterations': float(base['iterations'])}, several))


def test_defaults():
    """Ten iterations, power 2; the escape is the root of x^2 = x + |c|, of a Mandelbrot set 2."""
    several = random_rays(random.Random(SEED), 6)
    size = math.hypot(*JULIA['c'])
    for bare, whole in (({'type': 'julia', 'c': JULIA['c']}, {**JULIA, 'iterations': 10, 'escape': (1 + math.sqrt(1 + 4 * size)) / 2}),
                        ({'type': 'mandelbrot'}, {'type': 'mandelbrot', 'iterations': 10, 'escape': 2}),
                        ({'type': 'mandelbrot', 'power': 3}, {'type': 'mandelbrot', 'power': 3, 'iterations': 10, 'escape': math.sqrt(2)})):
        for row, other in zip(intersect(bare, several), intersect(whole, several)):
            equal(row['status'], other['status'], bare)
            if row['status'] == 'hit':
                close(row['t'], other['t'], 1e-9, bare)
    sphere, = intersect({'type': 'julia', 'iterations': 3, 'escape': 16}, [(0, 0, -5, 0, 0, 2)])  # c = 0: |Q_3| = |Q|^8
    close(sphere['t'], (5 - math.sqrt(2)) / 2, 1e-15)
    equal(sphere['status'], 'hit')


def test_gradient():
    """F = (u - 1)/(u + 1), u = |Q_N|^2/E^2, by central differences with 60 digits."""
    step = Decimal('1e-18')

    def value(shape, p):
        square = Decimal(shape['escape']) ** 2
        u = (excess(shape, p, Decimal) + square) / square
        return (u - 1) / (u + 1)

    for shape in JULIAS + MANDELBROTS:
        for row in intersect(shape, random_rays(random.Random(SEED), 4)):
            if row['status'] != 'hit':
                continue
            p = [Decimal(row[x]) for x in 'xyz']
            size = math.hypot(*(float(row['n' + x]) for x in 'xyz'))
            for i, x in enumerate('xyz'):
                low, high = ([v + sign * step * (k == i) for k, v in enumerate(p)] for sign in (-1, 1))
                close(row['n' + x], (value(shape, high) - value(shape, low)) / (2 * step), 1e-9 * size, (shape, row))


def test_first_is_the_first_of_all():
    several = random_rays(random.Random(SEED), 20)
    every = by_ray(intersect(JULIA, several, '--all'))
    for row in intersect(JULIA, several):
        first = every[int(row['ray'])][0]
        equal((row['status'], row['root']), (first['status'], first['root']))
        if row['status'] == 'hit':
            close(row['t'], first['t'], float(row['t_err']) + float(first['t_err']))


def test_coarse_tolerance():
    several = random_rays(random.Random(SEED), 20)
    evals = {}
    for tolerance in ('0', '1e-3'):
        got = intersect(JULIA, several, '--all', '--t-tol', tolerance)
        evals[tolerance] = sum(int(r['evals']) for r in got)
        for row in got:
            if row['status'] == 'hit':
                assert changes_sign(JULIA, several[int(row['ray'])], row), row
                assert tolerance == '0' or float(row['t_err']) <= 1e-3, row
    assert evals['1e-3'] < evals['0'], evals


def test_fast_way():
    """What it finds is there; where it sees nothing in the ball it says unproven."""
    several = random_rays(random.Random(SEED), 40) + [(0, 9, -5, 0, 0, 1)]
    sure = intersect(JULIA, several)
    for step in ('1e-3', '0.05', '0.5'):
        for row, first in zip(intersect(JULIA, several, '--dt-min', step, '--max-evals', 100000, exit=None), sure):
            if row['status'] == 'hit':
                assert changes_sign(JULIA, several[int(row['ray'])], row), row
                assert float(row['t']) >= float(first['t']) - float(row['t_err']) - float(first['t_err']), (row, first)
            elif row['status'] == 'miss':  # of the ball
                equal((row['evals'], first['status'], first['evals']), ('0', 'miss', '0'), (step, row))
            else:
                equal((row['status'], row['ray'] == '40'), ('unproven', False), (step, row))
    for row in intersect(JULIA, several, '--dt-min', '0.01', '--all', exit=None):
        if row['status'] == 'hit':
            assert changes_sign(JULIA, several[int(row['ray'])], row), row
        elif row['status'] == 'miss':
            equal((sure[int(row['ray'])]['status'], row['evals']), ('miss', '0'), row)
        else:
            assert row['status'] == 'unproven' and float(row['t_err']) > 0, row
    equal(intersect(JULIA, several, '--dt-min', '0'), sure)


def test_fast_way_in_words():
    shown = ('intersect', '--surface', json.dumps(JULIA), '--ray')
    hit, aside, by = '0.1 0.2 -3 0 0 1', '1.25 0.1 -3 0 0 1', '0 9 -3 0 0 1'
    for ray, exit, words in ((hit, DECIDED, '1 hit.\n'), (aside, UNDECIDED, '1 unproven.')):
        said = run(*shown, ray, '--dt-min', '0.01', exit=exit).stdout
        assert words in said and 'skipped' in said and 'certain' not in said, said
    assert 'certain' in run(*shown, hit).stdout
    for command in ('intersect', 'diagnose'):
        done = run(command, '--surface', '{type: plane}', '--ray', '0 0 -5 0 0 1', '--dt-min', '0.1')
        assert '--dt-min: not used' in done.stderr and 'skipped' not in done.stdout, (done.stderr, done.stdout)
        assert '--dt-min' not in run(command, '--surface', json.dumps(JULIA), '--ray', hit, '--dt-min', '0.1').stderr
        assert 'passes beside the ball' in run(command, '--surface', json.dumps(JULIA), '--ray', by).stdout
        assert '--pick near-seed: not used' in run(command, '--surface', json.dumps(JULIA), '--ray', hit, '--pick', 'near-seed').stderr
        assert not run(command, '--surface', '{type: plane}', '--ray', hit, '--pick', 'near-seed').stderr
        behind = '0 0 9 0 0 1'
        assert 'outside tmin ... tmax' in run(command, '--surface', json.dumps(JULIA), '--ray', behind).stdout


def test_what_is_left_when_evaluations_are_spent():
    ray = (0.1, 0.2, -3, 0, 0, 1)
    full = intersect(JULIA, [ray], '--all')
    assert len(full) >= 2, full
    statuses = set()
    for most in (1, 3, 10, 30):
        got = intersect(JULIA, [ray], '--all', '--max-evals', most, exit=None)
        equal([r['root'] for r in got], [str(i) for i in range(len(got))])
        statuses.update(r['status'] for r in got)
        for root in full:
            assert any(abs(float(r['t']) - float(root['t'])) <= float(r['t_err']) + float(root['t_err']) for r in got), (most, root, got)
    assert 'exhausted' in statuses, statuses
    row, = intersect(JULIA, [ray], '--max-evals', '1', exit=UNDECIDED)
    equal((row['status'], row['root'], row['t']), ('exhausted', '0', 'nan'))


def test_diagnose():
    one = ('--surface', json.dumps(JULIA), '--ray', '0.1 0.2 -3 0 0 1')
    hit, = rows('intersect', *one)
    got = rows('diagnose', *one)
    equal(len(got), int(hit['evals']))
    equal([int(r['eval']) for r in got], list(range(1, len(got) + 1)))
    close(got[-1]['t'], hit['t'], 1e-6)
    said = run('diagnose', *one).stdout
    assert f'hit at t = {hit["t"]}' in said and 'sgt_' not in said, said
    said = run('diagnose', '--surface', json.dumps(JULIA), '--ray', '1.25 0.1 -3 0 0 1').stdout
    assert 'marching: ' in said and 'wandering' not in said and 'certainly does not meet' in said, said
    said = run('diagnose', *one, '--dt-min', '0.01').stdout
    assert 'skipped' in said, said
    said = run('diagnose', '--surface', json.dumps(JULIA), '--ray', '1.25 0.1 -3 0 0 1', '--dt-min', '0.01', exit=UNDECIDED).stdout
    assert 'may have been skipped' in said, said


def test_bare_methods_start_in_the_middle():
    """Of the ball's chord, where the ray is nearest to the centre: not at a vertex plane."""
    ray, middle = '0.1 0.2 -3 0.1 0 1', (3 - 0.01) / 1.01
    one = ('diagnose', '--surface', json.dumps(JULIA), '--ray')
    for method in ('newton', 'newton-normalised'):
        close(rows(*one, ray, '--method', method, exit=None)[0]['t'], middle, 1e-6)
    first, last = rows(*one, ray, '--method', 'bisection', exit=None)[:2]
    equal([r['move'] for r in (first, last)], ['seed', 'seed'])
    close((float(first['t']) + float(last['t'])) / 2, middle, 1e-6)
    for method in ('newton', 'bisection'):
        said = run(*one, '0 9 -3 0 0 1', '--method', method, exit=UNDECIDED).stdout
        assert 'passes beside the surface' in said, said


LENS = '''name: a set in glass
pupil: {semi_diameter: 0.2, distance: 0}
surfaces:
  - {type: plane, thickness: 3}
  - type: julia
    c: [-0.2, 0.8, 0, 0]
    iterations: 6
    escape: 4
    thickness: 3
    index: 1.5
    tilt: [0, 30, 0]
  - {type: plane}
'''


def test_in_a_lens():
    lens = written(LENS)
    got = [r for r in rows('trace', lens, '--fan', '3') if r['element'] == '2']
    equal([r['fate'] for r in got], ['passed'] * 3)
    for row in got:
        p, step = [float(row[x]) for x in 'xyz'], 1e-11
        signs = {excess(JULIA, [p[0] + i * step, p[1] + j * step, p[2] + k * step]) > 0
                 for i in (-1, 0, 1) for j in (-1, 0, 1) for k in (-1, 0, 1)}
        equal(len(signs), 2, row)
    clipped = rows('trace', written(LENS.replace('    index: 1.5\n', '    index: 1.5\n    semi_diameter: 0.01\n')), '--fan', '2')
    equal({r['fate'] for r in clipped if r['element'] == '2'}, {'clipped'})
    assert {r['element'] for r in rows('diagnose', lens, '--fan', '1')} == {'1', '2', '3'}
    assert '--dt-min' not in run('trace', lens, '--dt-min', '0.01').stderr
    assert '--dt-min: not used' in run('trace', LENSES / 'ftheta.yaml', '--dt-min', '0.01').stderr


def test_lens_errors():
    for old, new, line, key in (('iterations: 6', 'radius: 6', 7, 'radius'), ('iterations: 6', 'iterations: 0', 7, 'iterations'),
                                ('iterations: 6', 'conic: 1', 7, 'conic'), ('escape: 4', 'escape: 0.5', 8, 'escape'),
                                ('0.8, 0, 0]', '0.8, 0]', 6, 'c'), ('iterations: 6', 'slice: 1\n    at: [0, 0, 0, 1]', 7, 'slice')):
        path = written(LENS.replace(old, new))
        done = run('trace', path, exit=BAD_INPUT)
        assert f'{path}:{line}: {key}: ' in done.stderr, (new, done.stderr)
    # a set has no vertex, so the pupil's image through it cannot be worked out
    stop = LENS.replace(', distance: 0', '').replace('{type: plane}', '{type: plane, stop: true}')
    assert 'pupil.distance' in run('trace', written(stop), exit=BAD_INPUT).stderr


print(f'SAGITTA_TEST_SEED={SEED}')
main(globals())
