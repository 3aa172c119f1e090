#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sagitta trade: what it prints agrees with itself, with arithmetic of 60 digits, and with its bounds.

    python3 test_trade.py SAGITTA

No time is asserted, only that there is one.
"""
import decimal
import itertools
import json
import math
import os
import pathlib
import random
import re
import sys
import xml.etree.ElementTree as xml
from decimal import Decimal

import mpmath

from command import *

decimal.getcontext().prec = mpmath.mp.dps = 60
QUICK = ('--seconds', '0')
SEED, SCALE = int(os.environ.get('SAGITTA_TEST_SEED', '1'), 0), float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
FIRST = 'case,setting,ns,evals,err_median,err_99,err_worst,undecided,wrong,rays,best'.split(',')
LAST = ['ns_low', 'ns_high', 'effect']
SURFACE = FIRST + LAST
LENS = FIRST + ['path_worst', 'waves_worst'] + LAST
CONIC = '{type: conic, radius: 10, conic: -0.6}'
ASPHERE = '{type: even_asphere, radius: 10, conic: -0.6, coefficients: [0, 1e-4, -2e-6, 1e-8], semi_diameter: 4}'
JULIA = '{type: julia, c: [-0.2, 0.8, 0, 0], iterations: 4}'


def trade(*arguments, **how):
    return rows('trade', *arguments, *QUICK, **how)


def by_setting(table, case=None):
    return {row['setting']: row for row in table if case in (None, row['case'])}


def settings_of(table):
    return [row['setting'] for row in table]


if '--without-quad' in sys.argv:  # there is nothing else to be tried
    assert '113 bits' in run('trade', exit=USAGE).stderr
    sys.exit(0)

DEFAULT = trade()


# ------------------------------------------------------------------- what is printed

def test_columns():
    for arguments, columns in (((), LENS), ((LENSES / 'ftheta.yaml',), LENS), (('--surface', CONIC), SURFACE)):
        head = run('trade', *arguments, *QUICK, '--format', 'csv').stdout.splitlines()[0]
        equal(head.split(','), columns)


def test_default_set():
    cases = [case for case, _ in itertools.groupby(row['case'] for row in DEFAULT)]
    equal(cases, ['conic', 'asphere', 'scan-lens', 'julia', 'julia-iterations'])
    always = ['default', 'single', 'out=all', 't_tol=1e-12', 't_tol=1e-9', 't_tol=1e-6', 't_tol=1e-3', 'proof=root', 'proof=first']
    for case in cases[:4]:
        settings = by_setting(DEFAULT, case)
        assert all(s in settings for s in always), (case, list(settings))
        assert any(s.startswith('out=') and s != 'out=all' for s in settings), case
        equal(any(s.startswith('pick=') for s in settings), case != 'julia', case)
        equal(sum(s.startswith('dt_min=') for s in settings), 4 if case == 'julia' else 0, case)
    equal(list(by_setting(DEFAULT, 'julia-iterations')), [f'iterations={n}' for n in (3, 5, 7, 9, 11)])


def test_numbers_make_sense():
    for row in DEFAULT:
        assert 0 < float(row['ns_low']) <= float(row['ns']) <= float(row['ns_high']) < math.inf, row
        assert row['best'] in ('0', '1'), row
        assert 0 <= int(row['undecided']) + int(row['wrong']) <= int(row['rays']), row
        errors = [float(row[e]) for e in ('err_median', 'err_99', 'err_worst')]
        assert all(map(math.isnan, errors)) or 0 <= errors[0] <= errors[1] <= errors[2], row
        equal(math.isnan(float(row['path_worst'])), row['case'] != 'scan-lens', row)


def test_json_and_text():
    table = json.loads(run('trade', '--surface', JULIA, *QUICK, '--format', 'json').stdout)
    equal(sorted({tuple(row) for row in table}), [tuple(SURFACE)])
    equal([row['setting'] for row in table], settings_of(trade('--surface', JULIA)))
    assert all(isinstance(row['ns'], (int, float)) and isinstance(row['evals'], (int, float)) for row in table), table
    text = run('trade', '--surface', JULIA, *QUICK).stdout
    assert 'julia-iterations: ' in text and 'errors against N = 8' in text and JULIA in text, text
    assert run('trade', '--surface', CONIC, *QUICK, '--hex', '--format', 'csv').stdout.count('0x1') > 9


# -------------------------------------------------------------------- the best

def gives(a, b):
    """It has all the outputs of the other, and as much is proven."""
    def outputs(row): return {'out=t': 0, 'out=point': 0, 'out=all': 2}.get(row['setting'], 1)
    def proven(row): return {'proof=root': 1, 'proof=first': 2}.get(row['setting'], 0)
    return outputs(a) >= outputs(b) and proven(a) >= proven(b)


def slower(a, b):
    return float(a['ns']) > 1.1 * float(b['ns']) and float(a['ns_low']) > float(b['ns_high'])


def worse(a, b):
    undecided, wrong = (int(a[k]) - int(b[k]) for k in ('undecided', 'wrong'))
    far = float(a['err_99']) > 2 * float(b['err_99']) and undecided >= 0  # never of NaN
    return slower(a, b) or far or undecided > 0 or wrong > 0


def beats(a, b):
    """a gives as much as b, is nowhere worse, and somewhere better."""
    return gives(a, b) and worse(b, a) and not worse(a, b)


def same(a, b):
    return math.isnan(float(a['err_99'])) == math.isnan(float(b['err_99'])) and not worse(a, b) and not worse(b, a)


def test_best_marks():
    for case in {row['case'] for row in DEFAULT}:
        table = [row for row in DEFAULT if row['case'] == case]
        best = [row for row in table if row['best'] == '1']
        assert not any(row['effect'] == 'changes nothing' for row in best), table  # it is the default
        for i, row in enumerate(table):
            if row['best'] == '1':
                assert row['err_99'] != 'nan' and not any(beats(other, row) for other in best), (row, table)
                assert not any(other['best'] == '1' and gives(other, row) and same(other, row) for other in table[:i]), (row, table)
            else:
                assert row['err_99'] == 'nan' or any(beats(other, row) or (gives(other, row) and same(other, row)) for other in table if other is not row), (row, table)
        assert best, case
    assert any(row['best'] == '0' for row in DEFAULT)


# ------------------------------------------------------------------- the words

def words(row, base):
    """What the row says against the base, by its own numbers."""
    told = []
    for name, a, b in (('fast', base, row), ('slow', row, base)):
        if slower(a, b):
            told.append(f'times as {name}')
    error, before = float(row['err_99']), float(base['err_99'])
    if error > 2 * before or before > 2 * error:
        told.append('err_99')
    if math.isnan(error) and not math.isnan(before):
        told.append('no hit is left')
    for key in ('undecided', 'wrong'):
        if row[key] != base[key]:
            told.append(f'{abs(int(row[key]) - int(base[key]))} {"more" if int(row[key]) > int(base[key]) else "fewer"}')
    one, other = float(row['ns']), float(base['ns'])
    apart = one > 1.1 * other or other > 1.1 * one
    return told or ['nothing beyond the scatter of the runs' if apart else 'changes nothing' if gives(base, row) else 'costs nothing']


def test_words():
    for case in {row['case'] for row in DEFAULT}:
        table = [row for row in DEFAULT if row['case'] == case]
        base, = (row for row in table if row['effect'] == '')
        equal(base['setting'], 'iterations=11' if case == 'julia-iterations' else 'default', case)
        for row in table:
            if row is not base:
                parts, wanted = row['effect'].split('; '), words(row, base)
                equal(len(parts), len(wanted), (row, base))
                for part, want in zip(parts, wanted):
                    assert want in part, (row, base)
    for row in DEFAULT:
        if match := re.match(r'([\d.]+) times as (fast|slow)', row['effect']):
            base = next(r for r in DEFAULT if r['case'] == row['case'] and r['effect'] == '')
            ratio = float(row['ns']) / float(base['ns'])
            close(float(match[1]), ratio if match[2] == 'slow' else 1 / ratio, 0.06 * float(match[1]), row)


def test_words_of_knobs():
    """What changes nothing stands in words under the rows, and is not best; the case's name stands once."""
    table = json.loads(run('trade', '--surface', '{type: sphere, radius: 10}', '--seconds', '0.3', '--format', 'json').stdout)
    equal({row['case'] for row in table}, {'sphere'})
    idle = [row['setting'] for row in table if row['effect'] == 'changes nothing']
    assert not any(row['best'] for row in table if row['setting'] in idle), table
    text = run('trade', '--surface', '{type: sphere, radius: 10}', '--seconds', '0.3', '--t-tol', '1e-9').stdout
    equal(text.count('sphere'), 2, text)  # the name, and the surface as it was given
    assert not re.search(r'^case|^setting.* (rays|ns_low) ', text, re.MULTILINE), text
    lines = text.splitlines()
    row, = (line for line in lines if line.startswith('t_tol=1e-9'))
    said = any(re.match(r'.*\bt_tol\b.* (changes?) nothing here', line) for line in lines)
    equal(said, row.endswith('changes nothing'), text)


def test_no_trade_is_told():
    """A torus has one best setting for the default's outputs and proof, and the text says so; a Julia set has
    more."""
    said = 'Here no accuracy can be traded for speed'
    for surface, traded in (('{type: torus, major: 5, minor: 2}', False), ('{type: julia, c: [-0.2, 0.8, 0, 0]}', True)):
        done = run('trade', '--surface', surface, '--seconds', '0.5', '--t-tol', '1e-6', '--dt-min', '0.3').stdout
        others = [line.split() for line in done.splitlines() if re.match(r'(single|floats|(t_tol|dt_min|max_evals|pick)=)', line)]
        best = [row[0] for row in others if row[8] == '1']
        equal(said in done, not best, done)
        assert traded or not best or best == ['t_tol=1e-6'], done


# -------------------------------------------------------------------- proofs

def test_proof():
    table = by_setting(trade('--surface', JULIA, '--proof', 'first'))
    assert 'proof=first' in table and 'proof=root' not in table, list(table)
    both = by_setting(trade('--surface', ASPHERE, '--proof', 'root,first'))
    for name in ('proof=root', 'proof=first'):
        equal((both[name]['wrong'], both[name]['undecided']), ('0', '0'))
        assert float(both[name]['err_worst']) < 2e-15, both[name]
    level = by_setting(trade('--surface', JULIA))
    assert float(level['proof=first']['evals']) > float(level['default']['evals']), level  # and it is turned at all


# ------------------------------------------------------------------ the errors

def test_full_precision_is_full():
    """Where nothing is given away the errors are those of rounding, and nobody is wrong or undecided."""
    for case, size in (('conic', 2e-15), ('asphere', 2e-15), ('scan-lens', 1e-13), ('julia', 1e-13)):
        settings = by_setting(DEFAULT, case)
        for name, row in settings.items():
            if name == 'default' or name.split('=')[0] in ('single', 'out', 'pick', 'proof'):
                equal((row['undecided'], row['wrong']), ('0', '0'), (case, name))
                assert 0 < float(row['err_worst']) < size, (case, row)
                if name.split('=')[0] not in ('pick', 'proof'):
                    equal(row['evals'], settings['default']['evals'], name)
    path = float(by_setting(DEFAULT, 'scan-lens')['default']['path_worst'])
    waves = float(by_setting(DEFAULT, 'scan-lens')['default']['waves_worst'])
    assert 0 < path < 1e-13, path
    close(waves, path * 25400 / 0.5876, 1e-6 * waves)


def test_floats():
    """Floats: of conics and even aspheres; errors as large as floats are, and none wrong."""
    for case in ('conic', 'asphere'):
        settings = by_setting(DEFAULT, case)
        equal((settings['floats']['undecided'], settings['floats']['wrong']), ('0', '0'), case)
        assert 1e-9 < float(settings['floats']['err_median']) < float(settings['floats']['err_worst']) < 1e-4, case
    for case in ('scan-lens', 'julia'):
        assert 'floats' not in by_setting(DEFAULT, case), case


def test_t_tol_is_honoured():
    for row in DEFAULT:
        if row['setting'].startswith('t_tol=') and row['case'] != 'scan-lens':
            assert float(row['err_worst']) <= float(row['setting'][6:]), row
            equal(row['wrong'], '0', row)
    coarse, default = (by_setting(DEFAULT, 'julia')[name] for name in ('t_tol=1e-3', 'default'))
    assert float(coarse['err_worst']) > 1e-9 > float(default['err_worst']), coarse  # and it is turned at all
    assert float(coarse['evals']) < float(default['evals']), coarse


def test_budget():
    table = by_setting(trade('--surface', JULIA, '--max-evals', '1000000,3,8'))
    budgets = [s for s in table if s.startswith('max_evals=')]
    equal(budgets, ['max_evals=1000000', 'max_evals=3', 'max_evals=8'])
    equal(table[budgets[0]]['undecided'], '0')
    assert int(table[budgets[1]]['undecided']) > int(table[budgets[2]]['undecided']) > 0, table
    for name in budgets:
        equal(table[name]['wrong'], '0', name)


def test_fast_way_and_iterations():
    table = trade('--surface', JULIA, '--dt-min', '0.3', '--dt-min', '1e-3', '--iterations', '2,6')
    fast = by_setting(table, 'julia')
    coarse, fine = fast['dt_min=3e-1'], fast['dt_min=1e-3']
    assert int(coarse['wrong']) > int(fine['wrong']), (coarse, fine)
    assert float(coarse['evals']) < float(fine['evals']), (coarse, fine)
    deep = by_setting(table, 'julia-iterations')
    equal(list(deep), ['iterations=2', 'iterations=6'])
    assert float(deep['iterations=6']['err_worst']) < 1e-13 < 1e-3 < float(deep['iterations=2']['err_99']), deep
    equal(deep['iterations=6']['wrong'], '0')


def test_pick():
    """--pick tries that one; of a sphere beyond its vertex plane the two are different roots, none of them wrong."""
    arguments = ('--surface', '{type: sphere, radius: -10}', '--ray', '0.5 -20 -4 0.01 1 0.02', '--ray', '0.1 -20 -3 0 1 0')
    both = by_setting(trade(*arguments))
    equal((both['default']['wrong'], both['pick=near-seed']['wrong']), ('0', '0'))
    one = trade(*arguments, '--pick', 'near-seed')
    assert not any(s.startswith('pick=') for s in settings_of(one)), one
    equal(by_setting(one)['default']['err_worst'], both['pick=near-seed']['err_worst'])


# ------------------------------------------------- the errors by other arithmetic

RAYS = [(1.25, -0.5, -5, 0.1, 0.05, 0.99), (-2, 0.75, -3, 0.05, -0.1, 1), (0.3, 2.1, -8, -0.02, -0.11, 2), (1, 1, -1e6, 1e-7, -1e-7, 0.7)]


def worst_error(surface, value, several=RAYS, number=Decimal):
    """Of the t that `sagitta intersect` prints: from a root of value(t, ray) by secants in 60 digits."""
    found = rows('intersect', '--surface', surface, '--rays', '-', stdin=rays(*several))
    worst = 0
    for ray, row in zip(several, found):
        equal(row['status'], 'hit')
        exact = [number(float(v)) for v in ray]
        t = number(float(row['t']))
        step = abs(t) * number('1e-20')
        for _ in range(4):
            f = value([exact[i] + t * exact[3 + i] for i in range(3)])
            ahead = value([exact[i] + (t + step) * exact[3 + i] for i in range(3)])
            t -= f * step / (ahead - f)
        worst = max(worst, abs(t - number(float(row['t']))))
    return float(worst)


def same_worst(surface, value, several=RAYS, number=Decimal):
    wanted = worst_error(surface, value, several, number)
    assert wanted > 0, surface
    got = by_setting(trade('--surface', surface, '--rays', '-', stdin=rays(*several)))['default']
    close(got['err_worst'], wanted, 1e-9 * wanted, surface)
    equal((got['rays'], got['wrong']), (str(len(several)), '0'))


def sag(p, c, k, coefficients=()):
    c, k = Decimal(c), Decimal(k)
    r2 = p[0] * p[0] + p[1] * p[1]
    return p[2] - c * r2 / (1 + (1 - (1 + k) * c * c * r2).sqrt()) - sum(Decimal(a) * r2 ** (i + 1) for i, a in enumerate(coefficients))


def test_sags_in_sixty_digits():
    same_worst(CONIC, lambda p: sag(p, 0.1, -0.6))
    same_worst(ASPHERE, lambda p: sag(p, 0.1, -0.6, (0, 1e-4, -2e-6, 1e-8)), RAYS[:3])
    same_worst('{type: plane}', lambda p: p[2])


def product(x, y):
    return (x[0] * y[0] - x[1] * y[1] - x[2] * y[2] - x[3] * y[3], x[0] * y[1] + x[1] * y[0] + x[2] * y[3] - x[3] * y[2],
            x[0] * y[2] - x[1] * y[3] + x[2] * y[0] + x[3] * y[1], x[0] * y[3] + x[1] * y[2] - x[2] * y[1] + x[3] * y[0])


def test_level_sets_in_sixty_digits():
    several = [(0.1, 0.2, -3, 0, 0.02, 1), (0.3, -0.1, -4, -0.05, 0.1, 1.5), (2.5, 0.2, 0.1, -1, 0, 0.1)]
    c = [Decimal(v) for v in (-0.2, 0.3, 0.1, 0.05)]
    size = sum(v * v for v in c).sqrt()
    safe = (1 + (1 + 4 * size).sqrt()) / 2

    def julia(p):
        q = (*p, Decimal(0.25))
        for _ in range(4):
            q = tuple(u + v for u, v in zip(product(q, q), c))
        return sum(v * v for v in q) - safe * safe

    def mandelbrot(p):
        q = at = (*p, Decimal(0))
        for _ in range(3):
            q = tuple(u + v for u, v in zip(product(product(q, q), q), at))
        return sum(v * v for v in q) - 2

    same_worst('{type: julia, c: [-0.2, 0.3, 0.1, 0.05], slice: 0.25, iterations: 4}', julia, several)
    same_worst('{type: mandelbrot, power: 3, iterations: 4}', mandelbrot, several)


BARTH = ('{type: formula, f: "4*(p^2*x^2 - y^2)*(p^2*y^2 - z^2)*(p^2*z^2 - x^2) = (1 + 2*p)*(x^2 + y^2 + z^2 - 1)^2", '
         'p: 1.618033988749895, inside: {ball: 1.6}}')
GYROID = '{type: formula, f: "sin(k*x)*cos(k*y) + sin(k*y)*cos(k*z) + sin(k*z)*cos(k*x) = 1e-1", k: 5.5, inside: {box: [1, 1, 1]}}'
TWISTED = '{type: formula, sag: "c*r^2/(1 + sqrt(1 - (1 + k)*c^2*r^2)) + a*r^4*cos(3*atan2(y, x))", c: 0.1, k: -0.6, a: 1e-4, semi_diameter: 6}'


def test_formulas_in_sixty_digits():
    mp = mpmath
    several = [(0.1, 0.2, -3, 0, 0.02, 1), (0.3, -0.1, -4, -0.05, 0.1, 1.5), (3, 0.7, 0.2, -1, 0.05, 0.03), (-2, 1.5, 3, 0.8, -0.7, -1.1)]

    def barth(at):
        x, y, z = (v * v for v in at)
        g = mp.mpf(1.618033988749895)
        return 4 * (g * g * x - y) * (g * g * y - z) * (g * g * z - x) - (1 + 2 * g) * (x + y + z - 1) ** 2

    def gyroid(at):
        x, y, z = (mp.mpf(5.5) * v for v in at)
        return mp.sin(x) * mp.cos(y) + mp.sin(y) * mp.cos(z) + mp.sin(z) * mp.cos(x) - mp.mpf(0.1)

    def twisted(at):
        x, y, z = at
        c, k, a, r = mp.mpf(0.1), mp.mpf(-0.6), mp.mpf(1e-4), mp.hypot(x, y)
        return z - c * r**2 / (1 + mp.sqrt(1 - (1 + k) * c**2 * r**2)) - a * r**4 * mp.cos(3 * mp.atan2(y, x))

    same_worst(BARTH, barth, several, mp.mpf)
    same_worst(GYROID, gyroid, several, mp.mpf)
    same_worst(TWISTED, twisted, RAYS[:3], mp.mpf)
    # functions, powers of a parameter, min, a number with an exponent and no point
    same_worst('{type: formula, f: "exp(-x^2) + log(2.5 + y)/3 + (2.5 + z)^p = min(cosh(z), tan(0.5)) + 1.5 + atan(z) + tanh(x*y)*cbrt(1e1)", p: 0.7, inside: {ball: 2}}',
               lambda p: mp.exp(-p[0]**2) + mp.log(2.5 + p[1]) / 3 + (2.5 + p[2]) ** mp.mpf(0.7) - min(mp.cosh(p[2]), mp.tan(0.5)) - 1.5 -
               mp.atan(p[2]) - mp.tanh(p[0] * p[1]) * mp.cbrt(10), [(3, 0.2, 0.1, -1, 0.1, 0.2), (0.3, -3, 0.1, 0.01, 1, 0.1), (-0.5, -3, -0.5, 0.1, 1, 0.1)], mp.mpf)


def test_formulas_by_default():
    """Rays that suit them, and every knob that other bodies and sags have; a box is met where it stands."""
    elsewhere = '{type: formula, f: "(x - 9)^2 + (y - 7)^2 + z^2 = a", a: 0.5, inside: {box: [[8, 6, -1], [10, 8, 1]]}}'
    for surface in (TWISTED, elsewhere, '{type: formula, f: "x^4 + y^4 + z^4 = a", a: 1}', '{type: formula, sag: "0.01*r^2"}'):
        lines = run('trade', '--surface', surface, *QUICK).stdout.splitlines()
        assert int(re.search(r'1000 rays, (\d+) of them met', lines[0])[1]) > 250 and 'left out' not in lines[1], lines[:2]
        head = next(line for line in lines if line.startswith('setting')).split()
        got = {line.split()[0]: dict(zip(head, line.split())) for line in reversed(lines[3:]) if len(line.split()) >= len(head) - 1}
        for name in ('default', 'single', 'out=t', 'out=all', 't_tol=1e-9', 'pick=near-seed', 'proof=root', 'proof=first'):
            equal((got[name]['wrong'], got[name]['undecided']), ('0', '0'), (surface, name))
            assert float(got[name]['err_worst']) < (1e-9 if 'tol' in name else 1e-13), (surface, got[name])
        assert not any(name.startswith('dt_min') for name in got), got


def test_vertex_of_a_formula():
    """r and atan2 have no slope there, and formula.h says that the polynomial is meant."""
    got = by_setting(trade('--surface', TWISTED, '--ray', '0 0 -3 0 0 1', '--ray', '0 0 4 0.1 0 -1'))['default']
    assert got['err_worst'] != 'nan' and float(got['err_worst']) < 1e-15, got
    text = run('trade', '--surface', TWISTED, '--ray', '0 0 -3 0 0 1', *QUICK).stdout
    assert '1 ray, 1 of them met' in text and 'left out' not in text, text
    # a tip has no slope, and no exact answer
    text = run('trade', '--surface', '{type: formula, f: "z*z = r^2", inside: {ball: 2}}', '--ray', '1 0 0 -1 0 0', *QUICK).stdout
    assert 'left out' in text, text


SINGLET = '''units: mm
wavelengths: [0.5]
surfaces:
  - {type: sphere, radius: 30, thickness: 4, index: 1.5, semi_diameter: 8}
  - {type: sphere, radius: -40, thickness: 30, index: 1, semi_diameter: 8, tilt: [0, 0, 90]}
  - {type: plane, mirror: true, tilt: [180, 0, 0]}
'''
BEAM = [(0, 0, -10, 0, 0, 1), (1.25, -2, -10, 0.01, 0.05, 1), (-3, 1, -7, 0.1, -0.05, 2)]


def exact_landing(ray):
    """The point on the mirror and the path, in 60 digits; turns by quarters change nothing of a sphere."""
    o, d = ([Decimal(float(v)) for v in half] for half in (ray[:3], ray[3:]))
    length = sum(v * v for v in d).sqrt()
    d, path, index = [v / length for v in d], Decimal(0), Decimal(1)
    for z, c, behind in ((0, Decimal(1 / 30), Decimal(1.5)), (4, Decimal(-1 / 40), Decimal(1)), (34, Decimal(0), None)):
        q = [o[0], o[1], o[2] - z]
        a, b = c, d[2] - c * sum(u * v for u, v in zip(q, d))
        e = c * sum(v * v for v in q) - 2 * q[2]
        t = e / (b + (b * b - a * e).sqrt())
        o = [u + t * v for u, v in zip(o, d)]
        path += index * t
        if behind:
            n = [-c * o[0], -c * o[1], 1 - c * (o[2] - z)]
            cosine, ratio = sum(u * v for u, v in zip(d, n)), index / behind
            along = (1 - ratio * ratio * (1 - cosine * cosine)).sqrt() - ratio * cosine
            d, index = [ratio * u + along * v for u, v in zip(d, n)], behind
    return o, path


def test_lens_in_sixty_digits():
    lens_in_sixty_digits(SINGLET)
    formulas = SINGLET.replace('type: sphere, radius: 30', f'type: formula, sag: "c*r^2/(1 + sqrt(1 - c^2*r^2))", c: {1 / 30!r}')
    formulas = formulas.replace('type: sphere, radius: -40', 'type: formula, f: "2*z = c*(x^2 + y^2 + z^2)", c: -0.025, inside: {ball: 20}')
    equal(formulas.count('formula'), 2)
    lens_in_sixty_digits(formulas)


def lens_in_sixty_digits(which):
    lens, text = written(which), rays(*BEAM)
    ends = [row for row in rows('trace', lens, '--rays', '-', '--frame', 'global', stdin=text) if row['element'] == '3']
    equal(len(ends), len(BEAM))
    point = path = 0
    for ray, row in zip(BEAM, ends):
        o, opl = exact_landing(ray)
        point = max(point, sum((u - Decimal(float(row[v]))) ** 2 for u, v in zip(o, 'xyz')).sqrt())
        path = max(path, abs(opl - Decimal(float(row['opl']))))
    got = by_setting(trade(lens, '--rays', '-', stdin=text))['default']
    close(got['path_worst'], path, 1e-6 * float(path))
    close(got['err_worst'], point, 2e-16 + 1e-6 * float(point))  # trace adds the vertex to z, and rounds
    close(got['waves_worst'], path * 2000, 2e-3 * float(path))


# ---------------------------------------------------------------- other lenses

def test_lenses():
    lenses = sorted(LENSES.glob('*.yaml'))
    assert len(lenses) >= 7, lenses
    for lens in lenses:
        got = by_setting(trade(lens, '--grid', 9))
        for name in ('default', 'single', 'out=point', 'out=all', 'proof=root'):
            equal((got[name]['wrong'], got[name]['undecided']), ('0', '0'), (lens, name))
            assert float(got[name]['err_worst']) < 1e-12, (lens, got[name])
            assert float(got[name]['path_worst']) < 1e-12, (lens, got[name])
    equal(trade(LENSES / 'ftheta.yaml', '--field', 5, '--fan', 7)[0]['rays'], '7')


def test_lost_rays_are_no_errors():
    """Clipped and missing rays are decided, and where they should be."""
    got = by_setting(trade(LENSES / 'ftheta.yaml', '--rays', '-', stdin=rays((0, 0, -1, 0, 0, 1), (0, 3, -1, 0, 0, 1), (0, 0, -1, 1, 0, 0))))
    equal((got['default']['rays'], got['default']['wrong'], got['default']['undecided']), ('3', '0', '0'))


MIXED = '''units: mm
surfaces:
  - {type: q_bfs, radius: 40, norm: 10, coefficients: [0.01, -0.002], thickness: 5, index: 1.5, stop: true, semi_diameter: 9}
  - {type: zernike, radius: -60, norm: 10, order: noll, coefficients: [0, 0, 0, 0.01, 0.02], thickness: 4, index: 1, semi_diameter: 9}
  - {type: conic, radius: -80, conic: -2, thickness: 3, index: 1.6, semi_diameter: 9}
  - {type: biconic, radius_x: 50, radius_y: 60, conic_y: -1, thickness: 30, index: 1, semi_diameter: 9, tilt: [3, -2, 1]}
  - {type: ellipsoid, a: 40, f: 0.2, decenter: [0, 0, 40], thickness: 40, index: 1}
pupil: {semi_diameter: 5}
fields: [0, 2]
'''


def test_lens_of_types_old_and_new():
    got = by_setting(trade(written(MIXED), '--grid', 7))['default']
    equal((got['wrong'], got['undecided']), ('0', '0'), got)
    assert 0 < float(got['err_worst']) < 1e-12, got


IDEAL = '''units: mm
surfaces:
  - {type: ideal, focal_length: 100, thickness: 125, semi_diameter: 9, stop: true}
  - {type: ideal, focal_length: -25, object_distance: -25, index: 1.3, thickness: 31.25, tilt: [3, 2, 0]}
  - {type: ideal, focal_length: 60, mirror: true, object_distance: 70, thickness: -20, tilt: [10, 0, 0]}
  - {type: ideal, focal_length: 30, index: 1, object_distance: 500, thickness: -20}
  - {type: plane}
pupil: {semi_diameter: 5}
fields: [0, 2]
'''


def test_ideal_lenses():
    """Places and paths, by the formulas of system.h in 113 bits."""
    got = by_setting(trade(written(IDEAL), '--grid', 7))
    for name in ('default', 'single', 'out=all'):
        equal((got[name]['wrong'], got[name]['undecided']), ('0', '0'), got[name])
        assert float(got[name]['err_worst']) < 2e-13 and float(got[name]['path_worst']) < 2e-13, got[name]


# ------------------------------------------------------------------- every type

# One surface of each: the specimens of src/types.def.
sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent.parent / 'docs'))
import surfaces_types  # noqa: E402
TYPES = {**surfaces_types.specimens(), 'sum': 'curvature: 0.02, semi_diameter: 5, terms: [{type: even_asphere, coefficients: [1e-3]}, {type: zernike, norm: 6, order: fringe, coefficients: [0, 0.1]}]'}


def test_every_type():
    earth = {'geodetic_height', 'level_gravity', 'geoid'}
    known = set(re.findall(r'\w+', run('trade', '--surface', '{type: none}', exit=BAD_INPUT).stderr.split('there are:')[-1]))
    equal(known - earth - {'formula'}, set(TYPES))  # formulas: above
    drawn = random.Random(SEED)
    for name, keys in TYPES.items():
        if drawn.random() > 0.1 + 2 * SCALE:  # a part of them where each is slow, under a sanitizer
            continue
        lines = run('trade', '--surface', f'{{type: {name}, {keys}}}', *QUICK).stdout.splitlines()
        rays, met = map(int, re.search(r'; (\d+) rays, (\d+) of them met', lines[0]).groups())
        assert lines[0].startswith(name + ': ') and rays == 1000 and met > 250, lines[0]
        assert 'left out of the errors' not in lines[1], lines[1]
        head = next(line for line in lines if line.startswith('setting')).split()
        default = dict(zip(head, next(line for line in lines if line.startswith('default')).split()))
        equal((default['undecided'], default['wrong']), ('0', '0'), name)
        assert 0 < float(default['err_worst']) < 1e-12, default


def test_the_earth_is_refused():
    for name, keys in (('geodetic_height', 'h: 0'), ('level_gravity', 'h: 0')):
        surface = f'{{type: {name}, {keys}}}'
        here = name in run('trade', '--surface', '{type: none}', exit=BAD_INPUT).stderr
        done = run('trade', '--surface', surface, *QUICK, exit=USAGE if here else BAD_INPUT)
        assert name in done.stderr and ('113 bits' if here else 'GeographicLib') in done.stderr and not done.stdout, done.stderr


# ---------------------------------------------------------------------- errors

def test_bad_options():
    lens = LENSES / 'ftheta.yaml'
    for arguments, word in (
            (('--t-tol', '-1'), '--t-tol'), (('--t-tol', '1e-3,x'), '--t-tol'), (('--t-tol', ','), '--t-tol'), (('--t-tol', '0'), '--t-tol'),
            (('--t-tol', ','.join(['1'] * 17)), '--t-tol'), (('--dt-min', 'nan'), '--dt-min'), (('--max-evals', '2.5'), '--max-evals'),
            (('--max-evals', '0'), '--max-evals'), (('--iterations', '0'), '--iterations'), (('--seconds', '-1'), '--seconds'),
            (('--seconds', 'soon'), '--seconds'), (('--pick', 'last'), '--pick'), (('--format', 'xml'), '--format'),
            (('--proof', 'roots'), '--proof'), (('--proof', ','), '--proof'), (('--proof', 'root,first,root,first'), '--proof'), (('--rays', '-'), '--surface'), (('--ray', '0 0 -5 0 0 1'), '--surface'), (('--fan', '3'), 'lens'),
            ((lens, lens), 'one lens file'), ((lens, '--surface', CONIC), '--surface'), (('--surface', CONIC, '--fan', 3), '--fan'),
            ((lens, '--ray', '0 0 -5 0 0 1'), '--ray'), (('--surface', CONIC, '--ray', '0 0 -5 0 0 1', '--rays', '-'), '--ray'),
            (('--surface', JULIA, '--iterations', '4,50000'), '--iterations'), (('--turbo',), '--turbo')):
        done = run('trade', *arguments, *QUICK, exit=USAGE)
        assert word in done.stderr, (arguments, done.stderr)
        equal(done.stdout, '', arguments)


def test_bad_input():
    for arguments, word in ((('--surface', '{type: cone}'), 'type'), (('nowhere.yaml',), 'nowhere.yaml'),
                            (('--surface', CONIC, '--ray', '1 2 3'), '--ray'),
                            (('--surface', '{type: formula, f: "x^4 + y^4 + = a", a: 1}'), 'column 13'),
                            (('--surface', '{type: formula, f: "x^2 + b*y^2 = 1"}'), 'b is not known'),
                            (('--surface', '{type: formula, sag: "0.01*r^2 + z"}'), 'a sag has no z'),
                            (('--surface', '{type: formula, f: "x + y", b: 1}'), 'does not name it')):
        done = run('trade', *arguments, *QUICK, exit=BAD_INPUT)
        assert word in done.stderr and not done.stdout, (arguments, done.stderr)


def test_what_is_not_used_is_told():
    for arguments, word in ((('--surface', CONIC, '--dt-min', '0.1'), '--dt-min'), (('--surface', CONIC, '--iterations', '4,5'), '--iterations'),
                            (('--surface', JULIA, '--pick', 'near-seed'), '--pick'), (('--surface', BARTH, '--dt-min', '0.1'), '--dt-min')):
        assert word in run('trade', *arguments, *QUICK).stderr, arguments
    equal(run('trade', '--surface', CONIC, *QUICK).stderr, '')


def test_help():
    text = run('trade', '--help', 'all').stdout
    for option in ('--surface', '--rays', '--ray', '--grid', '--t-tol', '--max-evals', '--proof', '--dt-min', '--iterations', '--pick', '--seconds', '--picture'):
        assert option in text, option
    assert 'differ from run to run' in text
    assert max(map(len, text.splitlines())) <= 100


# --------------------------------------------------------------------- picture

SVG = '{http://www.w3.org/2000/svg}'


def picture(*arguments):
    path = written('').parent / 'picture.svg'
    run('trade', *arguments, *QUICK, '--picture', path)
    return xml.parse(path).getroot()


def with_cairo(test):
    """Only where there is cairo."""
    return (lambda: None) if '--without-cairo' in sys.argv else test


def drawn(root):
    return sum(1 for _ in root.iter(SVG + 'path'))


@with_cairo
def test_picture():
    one, two = picture('--surface', CONIC), picture('--surface', JULIA)
    for root in (one, two):
        equal(root.tag, SVG + 'svg')
        width, height = (float(root.get(side).removesuffix('pt')) for side in ('width', 'height'))
        assert 500 <= width <= 1200 and 200 <= height <= 1200, (width, height)
    assert drawn(two) > drawn(one) > 20, (drawn(one), drawn(two))  # two panels and more dots
    assert drawn(picture('--surface', JULIA, '--t-tol', '1e-2,1e-3,1e-4,1e-5,1e-6,1e-7,1e-8,1e-9')) > drawn(two)
    picture('--surface', JULIA, '--ray', '5 5 5 1 0 0')  # nothing is met


def strokes(root, width):
    """The numbers of each path of a stroke of this width."""
    for path in root.iter(SVG + 'path'):
        style = dict(item.split(':') for item in path.get('style', '').split(';') if ':' in item)
        if float(path.get('stroke-width') or style.get('stroke-width', 'nan')) == width:
            yield [float(v) for v in re.findall(r'-?[\d.]+', path.get('d'))]


@with_cairo
def test_what_is_drawn_can_be_seen():
    """Dots of one place are rings about each other, the stairs go from the top to the right edge, the y axis is labelled."""
    several = [picture('--surface', f'{{type: {name}, {keys}}}') for name, keys in TYPES.items() if name in ('plane', 'toroidal', 'torus', 'julia')]
    for root in several + [picture(lens, '--grid', 5) for lens in (LENSES / 'ftheta.yaml', LENSES / 'toroidal_lens.yaml')]:
        dots = {}
        for d in strokes(root, 1.3):
            x, y = d[0::2], d[1::2]
            ring = tuple(round(v) for v in ((max(x) + min(x)) / 2, (max(y) + min(y)) / 2, (max(x) - min(x)) / 2))
            assert ring not in dots, ('a dot covers another', ring)
            dots[ring] = True
        assert len(dots) > 4, dots
        for (x, y, r), (u, v, s) in itertools.combinations(dots, 2):
            assert abs(r - s) > 1 or math.hypot(x - u, y - v) > r, ('dots that hide one another', (x, y, r), (u, v, s))
        stairs = list(strokes(root, 1.8))
        width = float(root.get('width').removesuffix('pt'))
        assert stairs and all(d[0] == d[2] or d[1] == d[3] for d in stairs), stairs
        assert sum(math.hypot(d[2] - d[0], d[3] - d[1]) for d in stairs) > width / 4, stairs
        upward = [round(float(u.get('x')), 1) for u in root.iter(SVG + 'use') if u.get('x')]
        assert max(map(upward.count, upward)) > 20, 'a label along the y axis'


@with_cairo
def test_picture_that_cannot_be_written():
    path = written('').parent / 'no' / 'picture.svg'
    done = run('trade', '--surface', CONIC, *QUICK, '--picture', path, exit=BAD_INPUT)
    assert str(path) in done.stderr and not done.stdout, done.stderr
    same = written('', 'same.svg')
    done = run('trade', '--surface', CONIC, *QUICK, '--picture', same, '--output', same, exit=USAGE)
    assert 'written over' in done.stderr, done.stderr


def test_without_cairo():
    if '--without-cairo' in sys.argv:
        assert 'without cairo' in run('trade', '--picture', written('').parent / 'x.svg', exit=USAGE).stderr


main(globals())
