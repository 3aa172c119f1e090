#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""--proof: what is claimed is true, what is not proven says so and why, and the words fit.

    python3 test_proof.py SAGITTA

The roots of the hard rays were worked out with 30 digits by another program (tests/data); those of random rays on conics
are worked out here, from the doubles that are given, by the quadratic with 80 digits.
"""
import json
import math
import os
import random
import re
from decimal import Decimal, getcontext

from command import *

getcontext().prec = 80
DATA = HERE.parent / 'data'
SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'))
SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))

ENDS = 'ox,oy,oz,dx,dy,dz,tmin,tmax'
SPHERE = '{type: sphere, radius: 2, semi_diameter: 1}'
WAVE = '{type: even_asphere, coefficients: [-0.2, 0.02]}'  # a W: four roots, seen from the side
WAVE_RAY = (0, -6, -0.3, 0, 1, 0.001)
JULIA = '{type: julia, c: [-0.2, 0.8, 0, 0], iterations: 8}'
# The rim is soft by a part in 2^44 of r^2 (surfaces.h): a ray parallel to the axis at this height is on its edge.
EDGE = float.fromhex('0x1.00000000000800p+0')


def words(*arguments, stdin='', exit=DECIDED):
    """What stands under the table."""
    said = run(*arguments, stdin=stdin, exit=exit).stdout
    return said[said.rindex('\n\n') + 2:].splitlines()


# ------------------------------------------------------------------ options

def test_the_choices_are_named():
    for command in (('intersect', '--surface', SPHERE, '--ray', '0 0 -5 0 0 1'), ('trace', LENSES / 'ftheta.yaml'),
                    ('diagnose', '--surface', SPHERE, '--ray', '0 0 -5 0 0 1')):
        for wrong in ('best', '', 'FIRST', '1', 'root,first'):
            said = run(*command, f'--proof={wrong}', exit=USAGE)
            assert f'estimate, root or first, not "{wrong}"' in said.stderr, said.stderr
            equal(said.stdout, '')
        assert '--proof' in run(*command, '--proof', exit=USAGE).stderr
        assert '--proof P' in run(command[0], '--help', 'all').stdout
        equal(run(*command, '--proof', 'estimate').stdout, run(*command).stdout)


def test_the_fast_way_proves_nothing():
    for command in ('intersect', 'diagnose'):
        shown = (command, '--surface', JULIA, '--ray', '0.1 0.2 -3 0 0 1', '--dt-min', '0.1')
        run(*shown, '--proof', 'estimate')
        assert '--dt-min' in run(*shown, '--proof', 'root', exit=USAGE).stderr
        sag = (command, '--surface', SPHERE, '--ray', '0 0 -5 0 0 1', '--dt-min', '0.1', '--proof', 'first')
        assert 'not used' in run(*sag).stderr


def test_columns():
    """As ever, and behind them, where a proof is asked for, the stretch that is left."""
    text, named = rays((0, 0, -5, 0, 0, 1)), rays((0, 0, -5, 0, 0, 1, 'a'), header='ox,oy,oz,dx,dy,dz,id')
    for command, text_head, head in ((('intersect', '--surface', SPHERE), INTERSECT, INTERSECT),
                                     (('trace', LENSES / 'ftheta.yaml'), TRACE, TRACE_ALL)):
        for proof, more in (('estimate', ''), ('root', ',lo,hi'), ('first', ',lo,hi')):
            for stdin, id in ((text, ''), (named, ',id')):
                done = run(*command, '--rays', '-', '--proof', proof, '--format', 'csv', stdin=stdin)
                equal(done.stdout.splitlines()[0], head + id + more)
                done = run(*command, '--rays', '-', '--proof', proof, '--format', 'json', stdin=stdin)
                equal(','.join(json.loads(done.stdout)[0]), head + id + more)
            shown = run(*command, '--rays', '-', '--proof', proof, stdin=text).stdout.splitlines()
            equal(shown[0].split(), text_head.split(','))


# ------------------------------------------------------------- is it proven?

def hard_cases():
    with open(DATA / 'hard_cases.csv', newline='') as file:
        for case in csv.DictReader(file):
            terms = [float(case[f'a{i}']) for i in range(2, 17, 2)]
            radius = '.inf' if case['R'] == 'inf' else case['R']
            spec = f'radius: {radius}, conic: {case["k"]}, semi_diameter: {case["semi_diameter"]}'
            kind = 'even_asphere' if any(terms) else 'conic'
            spec = f'{{type: {kind}, {spec}' + (f', coefficients: {terms}}}' if any(terms) else '}')
            ray = [case[name] for name in ENDS.split(',')]
            yield case['id'], spec, ray, [Decimal(root) for root in case['roots'].split()]


def test_hard_rays():
    """Each is decided: the first root, or a miss; and near the seed, where it is the only one."""
    alone = several = 0
    for name, surface, ray, roots in hard_cases():
        text = rays(ray, header=ENDS)
        for proof in ('root', 'first'):
            row, = rows('intersect', '--surface', surface, '--rays', '-', '--proof', proof, stdin=text)
            equal(row['status'], 'hit' if roots else 'miss', name)
            if roots:
                assert abs(Decimal(row['t']) - roots[0]) <= Decimal(row['t_err']) <= Decimal('1e-6') * max(1, abs(roots[0])), (name, row)
            equal((row['lo'], row['hi']), ('nan', 'nan'), name)
            got = rows('intersect', '--surface', surface, '--rays', '-', '--all', '--proof', proof, stdin=text)
            equal([r['status'] for r in got], ['hit'] * len(roots) or ['miss'], name)
            for row, root in zip(got, roots):
                within = [r for r in roots if abs(Decimal(row['t']) - r) <= Decimal(row['t_err'])]
                equal(within, [root], name)
        row, = rows('intersect', '--surface', surface, '--rays', '-', '--pick', 'near-seed', '--proof', 'first', stdin=text, exit=None)
        equal(row['status'], ('miss', 'hit')[len(roots)] if len(roots) < 2 else 'unproven', name)
        if len(roots) > 1:
            several += 1
            slack = Decimal('1e-9') * max(1, abs(roots[-1]))
            assert Decimal(row['lo']) <= roots[0] + slack and Decimal(row['hi']) >= roots[-1] - slack, (name, row, roots)
        alone += len(roots) == 1
    assert alone > 3 and several >= 3, (alone, several)


def conic_roots(c, k, ray):
    """The roots of the sheet, as (t, r^2), and how far the quadric is from having one root less or more: its discriminant."""
    x, y, z, l, m, n = map(Decimal, ray)
    c, k1 = Decimal(c), 1 + Decimal(k)
    A = c * (l * l + m * m + k1 * n * n)
    B = n - c * (x * l + y * m + k1 * z * n)
    C = c * (x * x + y * y + k1 * z * z) - 2 * z
    D = B * B - A * C
    if A == 0:
        found = [C / (2 * B)] if B else []
    elif D < 0:
        found = []
    else:
        q = B + D.sqrt().copy_sign(B)
        found = sorted({C / q, q / A}) if q else [Decimal(0)]
    at = [(t, (x + t * l) ** 2 + (y + t * m) ** 2, 1 - k1 * c * (z + t * n)) for t in found]
    return [(t, r2) for t, r2, v in at if v >= 0]


def draw_conic(draw):
    """c, k, the rim."""
    c, k = draw.choice((-1, 1)) * 10 ** draw.uniform(-2, 0.5), draw.choice((0.0, -1.0, draw.uniform(-3, 2)))
    edge = 1 / abs(c) / math.sqrt(1 + k) if k > -1 else 3 / abs(c)
    return c, k, edge * draw.uniform(0.1, 0.95)


def draw_ray(draw, c, k, rim):
    """Often a difficult one: tangent within 1e-12, at the rim, from far away."""
    r, a, kind = rim * math.sqrt(draw.random()), draw.uniform(0, 2 * math.pi), draw.randrange(5)
    if kind == 1:
        r = rim * (1 + draw.choice((0, 1e-16, 3e-16, 2e-14, 2.8421709430404007e-14, -1e-15)))
    x, y, phi = r * math.cos(a), r * math.sin(a), math.sqrt(1 - (1 + k) * c * c * r * r)
    z = c * r * r / (1 + phi)
    l, m, n = (draw.gauss(0, 1) for _ in range(3))
    if kind == 2:  # in the tangent plane, but for very little
        n = (c * x * l + c * y * m) / phi
        z += 10 ** draw.uniform(-16, -10) * draw.choice((-1, 0, 1)) / abs(c)
    length = math.sqrt(l * l + m * m + n * n)
    back = 10 ** (draw.uniform(4, 9) if kind == 3 else draw.uniform(-1, 1)) / abs(c)
    l, m, n = l / length, m / length, n / length
    return x - back * l, y - back * m, z - back * n, l, m, n


def check_answer(row, roots, inside, pick, proof, what):
    if row['status'] == 'miss':
        assert not inside, what
    if row['status'] == 'hit':
        t, t_err = (Decimal(float.fromhex(row[name])) for name in ('t', 't_err'))
        within = [root for root, _ in roots if abs(root - t) <= t_err]
        assert len(within) == 1 and within[0] in inside, what
        if proof == 'first':
            equal(within[0], inside[0], what)
            assert pick == 'first' or len(inside) == 1, what
    if row['status'] == 'unproven':
        lo, hi = (Decimal(float.fromhex(row[name])) for name in ('lo', 'hi'))
        assert all(lo <= root for root in inside), what  # what comes before is decided
        assert pick == 'first' or all(root <= hi for root in inside), what


def test_conics_against_their_quadratic():
    """A hit: one root of the sheet within t_err, within the rim, none before it that counts; a miss: none that counts."""
    draw = random.Random(SEED)
    print(f'       seed {SEED}')
    seen = dict.fromkeys(('hit', 'miss', 'graze', 'unproven'), 0)
    for _ in range(max(1, int(20 * SCALE))):
        c, k, rim = draw_conic(draw)
        several = [draw_ray(draw, c, k, rim) for _ in range(25)]
        spec = f'{{type: conic, curvature: {c!r}, conic: {k!r}, semi_diameter: {rim!r}}}'
        text = rays(*(map(float.hex, ray) for ray in several))
        for pick, proof in (('first', 'root'), ('first', 'first'), ('near-seed', 'first')):
            got = rows('intersect', '--surface', spec, '--rays', '-', '--pick', pick, '--proof', proof, '--hex', stdin=text, exit=None)
            for row, ray in zip(got, several, strict=True):
                roots = conic_roots(c, k, ray)
                inside = [t for t, r2 in roots if r2 <= Decimal(rim) ** 2 * (1 + Decimal(2) ** -44) and t > 0]
                seen[row['status']] += 1
                check_answer(row, roots, inside, pick, proof, (spec, ray, pick, proof, row, roots))
    assert seen['hit'] > seen['unproven'] > 0 and seen['miss'] > 0, seen


def test_a_proof_takes_answers_away_and_changes_none():
    draw = random.Random(SEED + 1)
    several = [[draw.uniform(-1.3, 1.3), draw.uniform(-1.3, 1.3), -5.0, draw.gauss(0, 0.1), draw.gauss(0, 0.1), draw.uniform(-0.3, 1)]
               for _ in range(int(1000 * max(1, min(SCALE, 20))))]
    for surface, picks in ((SPHERE, ('first', 'near-seed')), (WAVE[:-1] + ', semi_diameter: 2}', ('first', 'near-seed')), (JULIA, ('first',))):
        for pick in picks:
            shown = ('intersect', '--surface', surface, '--rays', '-', '--pick', pick)
            plain, root, first = (rows(*shown, '--proof', proof, stdin=rays(*several), exit=None) for proof in ('estimate', 'root', 'first'))
            hits = unproven = 0
            for p, r, f in zip(plain, root, first):
                for row, more in ((r, p), (f, r)):
                    assert row['status'] in (more['status'], 'unproven'), (surface, more, row)
                    if row['status'] == 'hit':
                        assert abs(float(row['t']) - float(more['t'])) <= float(row['t_err']) + float(more['t_err']), (more, row)
                hits += f['status'] == 'hit'
                unproven += f['status'] == 'unproven'
            assert hits > 100, (surface, pick, hits)
            assert pick == 'near-seed' or unproven == 0, (surface, pick, unproven)  # none of these is difficult


# ------------------------------------------------------------------- words

def test_verdicts():
    several = rays((0, 0, -5, 0, 0, 1), (0, 0.5, -5, 0, 0, 1), (0, 9, -5, 0, 0, 1))
    shown = ('intersect', '--surface', SPHERE, '--rays', '-', '--proof')
    equal(words(*shown, 'root', stdin=several)[-1], '3 rays: 2 hits proven to be single roots, 1 miss proven.')
    equal(words(*shown, 'first', stdin=several)[-1], '3 rays: 2 hits proven to be the first, 1 miss proven.')
    equal(words(*shown, 'first', '--pick', 'near-seed', stdin=several)[-1], '3 rays: 2 hits proven to be the only roots, 1 miss proven.')
    one = ('intersect', '--surface', SPHERE, '--ray', '0 0 -5 0 0 1', '--proof')
    equal(words(*one, 'root'), ['1 ray: 1 hit proven to be a single root.'])
    equal(words(*one, 'first', '--pick', 'near-seed'), ['1 ray: 1 hit proven to be the only root.'])
    equal(words('intersect', '--surface', JULIA, '--ray', '0.1 0.2 -3 0 0 1', '--all', '--proof', 'first')[-1],
          '1 ray, 6 rows: 6 hits proven to be single roots.')
    # a ball: |Q|^2 = 1; the ray touches it
    said = words('intersect', '--surface', '{type: julia, iterations: 1}', '--ray', '1 0 -3 0 0 1', '--proof', 'first')
    equal(said[-1], '1 ray: 1 graze (touches, as far as can be told).')


def unproven(surface, ray, *more):
    """What is said of it, and what is left."""
    shown = ('intersect', '--surface', surface, '--ray', ' '.join(map(str, ray)), *more)
    said = words(*shown, exit=UNDECIDED)
    equal(said[-1], '1 ray: 1 unproven.', said)
    assert said[0].startswith('Ray 0: unproven'), said
    row, = rows(*shown, exit=UNDECIDED)
    equal((row['root'], row['t'], row['x']), ('0', 'nan', 'nan'))
    return said[0], float(row['lo']), float(row['hi'])


def test_the_rim():
    """On its edge it cannot be told whether the root counts; one double aside it can, and without a proof there is a rule."""
    for proof in ('root', 'first'):
        said, lo, hi = unproven(SPHERE, (0, EDGE, -5, 0, 0, 1), '--proof', proof)
        assert 'which side of the rim' in said and 'r = 1.00000000000002' in said, said
        root = 5 + 2 - math.sqrt(4 - EDGE * EDGE)
        assert lo <= root <= hi and hi - lo < 1e-14, (lo, hi)
    for y, status in ((EDGE, 'hit'), (EDGE + 1e-15, 'miss')):
        row, = rows('intersect', '--surface', SPHERE, '--ray', f'0 {y!r} -5 0 0 1')
        equal(row['status'], status, y)
    for y, status in ((1.0, 'hit'), (EDGE - 4e-15, 'hit'), (EDGE + 4e-15, 'miss')):
        row, = rows('intersect', '--surface', SPHERE, '--ray', f'0 {y!r} -5 0 0 1', '--proof', 'first')
        equal(row['status'], status, y)


def test_not_the_only_root():
    whole = rows('intersect', '--surface', WAVE, '--ray', ' '.join(map(str, WAVE_RAY)), '--all')
    said, lo, hi = unproven(WAVE, WAVE_RAY, '--pick', 'near-seed', '--proof', 'first')
    assert 'not the only one' in said and all(row['t'] in said for row in whole[:3]) and '1 more' in said, said
    assert lo <= float(whole[0]['t']) and float(whole[-1]['t']) <= hi, (lo, hi)
    cut = [(float(a['t']) + float(b['t'])) / 2 for a, b in zip(whole, whole[1:])]
    for i in range(4):  # each of them, alone between two ends
        ends = (([0] + cut)[i], (cut + [20])[i])
        row, = rows('intersect', '--surface', WAVE, '--ray', ' '.join(map(str, (*WAVE_RAY, *ends))), '--pick', 'near-seed', '--proof', 'first')
        close(row['t'], whole[i]['t'], 1e-12)
    two = (*WAVE_RAY, 0, cut[1])
    said, lo, hi = unproven(WAVE, two, '--pick', 'near-seed', '--proof', 'first')
    assert all(row['t'] in said for row in whole[:2]) and ' and ' in said and hi < cut[1], said


def test_where_rounding_decides():
    said, lo, hi = unproven('{type: sphere, radius: 2}', (0, -3, 2, 0, 1, 0), '--proof', 'root')
    assert 'equator' in said and lo <= 1 <= hi, said
    for proof in ((), ('--proof', 'root')):  # the stretch in doubt is the whole ray
        edge = words('intersect', '--surface', '{type: even_asphere, radius: 20, coefficients: [0, 1e-6]}',
                     '--ray', '20 0 -5 0 0 1', *proof, exit=UNDECIDED)
        assert 'at the equator, where the surface ends' in edge[0], edge
    said, lo, hi = unproven(WAVE, (0, -6, 0, 0, 1, 0), '--proof', 'root', '--pick', 'near-seed')
    assert 'grazes' in said and lo <= 6 <= hi, said
    said, lo, hi = unproven('{type: plane, semi_diameter: 1e-200}', (0, 0, -5, 0, 0, 1), '--proof', 'first')
    assert 'semi_diameter' in said and (lo, hi) == (0, math.inf), (said, lo, hi)
    met = words('intersect', '--surface', '{type: plane, semi_diameter: 1e200}', '--ray', '0 0 -5 0 0 1', '--proof', 'first')
    equal(met[-1], '1 ray: 1 hit proven to be the first.')


def test_many_undecided():
    """Four are explained, in the order of the rays; the others are counted."""
    edge = [(0, EDGE, -5 - i, 0, 0, 1) for i in range(600)]
    several = rays((0, 0, -5, 0, 0, 1), *edge)
    said = words('intersect', '--surface', SPHERE, '--rays', '-', '--proof', 'first', stdin=several, exit=UNDECIDED)
    equal([line.split(':')[0] for line in said[:4]], ['Ray 1', 'Ray 2', 'Ray 3', 'Ray 4'])
    equal(said[4:], ['601 rays: 1 hit proven to be the first, 600 unproven.', '596 more undecided: sagitta diagnose shows why.'])


def test_without_a_proof_too():
    said = words('intersect', '--surface', WAVE, '--rays', '-', '--max-evals', 5, stdin=rays(WAVE_RAY), exit=UNDECIDED)
    assert said[0].startswith('Ray 0: exhausted') and 'max_evals was used up' in said[0], said
    equal(said[-1], '1 ray: 1 exhausted.')
    for surface, ray in ((WAVE, WAVE_RAY), (JULIA, (0.1, 0.2, -3, 0, 0, 1))):  # with one it is the same, under another name
        said, lo, hi = unproven(surface, ray, '--max-evals', 5, '--proof', 'first')
        assert 'max_evals was used up first' in said, said


def test_diagnose():
    one = ('diagnose', '--surface', SPHERE, '--ray', '0 0.5 -5 0 0 1')
    for more, proven in ((('root',), 'a single root'), (('first',), 'the first'), (('first', '--pick', 'near-seed'), 'the only root')):
        said = run(*one, '--proof', *more).stdout
        assert f' off, proven to be {proven}.' in said, said
    assert 'proven' not in run(*one).stdout
    said = run('diagnose', '--surface', SPHERE, '--ray', f'0 {EDGE!r} -5 0 0 1', '--proof', 'first', exit=UNDECIDED).stdout
    assert 'unproven ' in said and ' t = 5.26794919' in said and 'which side of the rim' in said, said
    assert 'which side of the rim' in run('diagnose', '--surface', SPHERE, '--ray', f'0 {EDGE!r} -5 0 0 1', '--proof', 'first', '--method', 'newton').stdout


# ------------------------------------------------------------------- lenses

WAVES = '''pupil: {semi_diameter: 1, distance: 0}
surfaces:
  - {type: plane, thickness: 5}
  - {type: even_asphere, coefficients: [-0.2, 0.02], index: 1.5, semi_diameter: 5, thickness: 10}
  - {type: plane, semi_diameter: 100}
'''


def test_lenses():
    """Every ray of every example is proven, at the price of no row; a surface of the catalogue is searched another way
    for a proof, and its numbers are the same within their bounds."""
    def same(got, plain):
        if not catalogue:
            return got == plain
        got, plain = (line.split(',') for line in (got, plain))
        return got[:4] == plain[:4] and all(abs(float(a) - float(b)) < 1e-9 for a, b in zip(got[4:], plain[4:]))
    for lens in sorted(LENSES.glob('*.yaml')):
        catalogue = re.search('type: (sum|toroidal)', lens.read_text())
        plain = run('trace', lens, '--grid', 7, '--format', 'csv').stdout.splitlines()
        for proof, pick in (('root', 'near-seed'), ('first', 'near-seed'), ('first', 'first')):
            shown = ('trace', lens, '--grid', 7, '--proof', proof, '--pick', pick)
            got = run(*shown, '--format', 'csv').stdout.splitlines()
            if pick == 'near-seed':
                equal(len(got), len(plain), (lens, proof))
                for a, b in zip(got[1:], plain[1:]):
                    evals = TRACE.count(',')
                    a, b = ([*line[:evals], *line[evals + 1:]] for line in (a.split(',')[:-2], b.split(',')))
                    assert same(','.join(a), ','.join(b)), (lens, proof, a, b)
            said = words(*shown)
            count = said[-2].split()[0]
            equal(said[-1].split(':')[0], f'Proven for {count} of them', (lens, said))


def test_a_ray_that_is_lost():
    """Along the axis the wave is met once; from the side four times within its aperture, and the ray is lost there."""
    lens = written(WAVES)
    side = (0, -6, 4.7, 0, 1, 0.001)
    text = rays((0, 0.1, 0, 0, 0, 1), side, (0, 50, 0, 0, 0, 1))
    got = rows('trace', lens, '--rays', '-', '--proof', 'first', stdin=text, exit=UNDECIDED)
    lost, = [row for row in got if row['ray'] == '1' and row['fate'] != 'passed']
    equal((lost['element'], lost['fate'], lost['status'], lost['x'], lost['t']), ('2', 'lost', 'unproven', 'nan', 'nan'))
    before = next(row for row in got if row['ray'] == '1')  # behind the first plane, in whose frame the wave is 5 ahead
    start = [float(before[name]) for name in 'xyzlmn']
    start[2] -= 5
    whole = rows('intersect', '--surface', WAVE[:-1] + ', semi_diameter: 5}', '--rays', '-', '--all', stdin=rays((*start, '-inf', 'inf'), header=ENDS))
    equal(len(whole), 4)
    assert float(lost['lo']) <= float(whole[0]['t']) and float(whole[-1]['t']) <= float(lost['hi']), (lost, whole)
    assert all(row['lo'] == row['hi'] == 'nan' for row in got if row is not lost)
    said = words('trace', lens, '--rays', '-', '--proof', 'first', stdin=text, exit=UNDECIDED)
    equal(said[:2], ['1 of 3 rays passed all 3 elements.',
                     'Proven for 1 of them: at each element one root, and only one, lies within t_err of t, and no other within the clear aperture.'])
    assert any('1 lost (unproven)' in line for line in said), said
    assert said[-1].startswith('Ray 1 at element 2: unproven from t = ') and 'not the only one' in said[-1], said
    for proof, pick in (('root', 'near-seed'), ('first', 'first')):  # these claim less
        got = rows('trace', lens, '--rays', '-', '--proof', proof, '--pick', pick, stdin=text, exit=None)
        equal([row['status'] for row in got if row['ray'] == '1' and row['element'] == '2'], ['hit'])


def test_narrower_than_the_surface():
    """Roots outside the clear aperture are no others."""
    text = rays((0, -2.9, 4.6, 0, 1, 0.05))
    for rim, status in ((5, 'unproven'), (2.5, 'unproven'), (1.2, 'hit')):
        lens = written(WAVES.replace('semi_diameter: 5', f'semi_diameter: {rim}'))
        got = [row for row in rows('trace', lens, '--rays', '-', '--proof', 'first', stdin=text, exit=None) if row['element'] == '2']
        equal([row['status'] for row in got], [status], rim)


# ------------------------------------------------------------------ threads

def test_threads():
    """The same bytes for any number of threads, lo and hi and the reasons included."""
    draw = random.Random(SEED + 2)
    several = [[draw.uniform(-3, 3), draw.uniform(-6, 6), draw.uniform(-2, 1), draw.gauss(0, 0.1), draw.gauss(0, 1), draw.gauss(0, 0.1)]
               for _ in range(600)]
    text, lens = rays(*several), written(WAVES)
    moved = rays(*[[x, y, z + 5, *d] for x, y, z, *d in several])
    for proof in ('root', 'first'):
        for form in ('csv', 'json', 'text'):
            for command in (('intersect', '--surface', WAVE, '--pick', 'near-seed'), ('intersect', '--surface', WAVE, '--all'),
                            ('trace', lens)):
                shown = (*command, '--rays', '-', '--proof', proof, '--format', form)
                stdin = moved if command[0] == 'trace' else text
                one = run(*shown, '--threads', 1, stdin=stdin, exit=None)
                if proof == 'first' and '--all' not in command:
                    equal(one.returncode, UNDECIDED)
                for n in (2, 5):
                    equal(run(*shown, '--threads', n, stdin=stdin, exit=one.returncode).stdout, one.stdout, shown)


main(globals())
