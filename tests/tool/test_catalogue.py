#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Every type of surface through its keys, against its formula in 60 digits, written here another way.

    python3 test_catalogue.py SAGITTA

Polynomials are taken from their published tables and sums of powers, not from recurrences; a root is
refined on the formula from where the command says it is, and lies within the t_err that it says.
"""
import json
import math
import random
import struct
import subprocess
from decimal import Decimal as D, getcontext
from fractions import Fraction

from command import *

getcontext().prec = 60
STEP = D('1e-25')
RAYS = 24


# ------------------------------------------------------------------ formulas

def conic(c, k, r2):
    return c * r2 / (1 + (1 - (1 + k) * c * c * r2).sqrt())


def table(a, basis_x, basis_y):
    return sum(D(v) * basis_x[i] * basis_y[j] for i, row in enumerate(a) for j, v in enumerate(row))


def powers(x, n):
    return [x ** i if i else D(1) for i in range(n)]


# T_0 ... T_6, Abramowitz and Stegun 1964, table 22.3
T = [[1], [0, 1], [-1, 0, 2], [0, -3, 0, 4], [1, 0, -8, 0, 8], [0, 5, 0, -20, 0, 16], [-1, 0, 18, 0, -48, 0, 32]]


def polynomial(a, x):
    return sum(D(v) * p for v, p in zip(a, powers(x, len(a))))


NOLL = [(0, 0), (1, 1), (1, -1), (2, 0), (2, -2), (2, 2), (3, -1), (3, 1), (3, -3), (3, 3), (4, 0), (4, 2), (4, -2), (4, 4), (4, -4)]
FRINGE = [(0, 0), (1, 1), (1, -1), (2, 0), (2, 2), (2, -2), (3, 1), (3, -1), (4, 0), (3, 3), (3, -3), (4, 2), (4, -2), (5, 1), (5, -1), (6, 0)]


def zernike(n, m, x, y, normalised):
    """The sum with factorials, r^|m| cos m theta as a power of x + i y (m < 0: sin)."""
    k, r2, radial = abs(m), x * x + y * y, D(0)
    for s in range((n - k) // 2 + 1):
        f = math.factorial
        radial += D((-1) ** s * f(n - s) // (f(s) * f((n + k) // 2 - s) * f((n - k) // 2 - s))) * powers(r2, n)[(n - k) // 2 - s] if n else 1
    real, imaginary = D(1), D(0)
    for _ in range(k):
        real, imaginary = real * x - imaginary * y, real * y + imaginary * x
    return radial * (imaginary if m < 0 else real) * (D((n + 1) * (2 if m else 1)).sqrt() if normalised else 1)


def q_con(m, x):
    """Jacobi's P_m^(0,4)(2 x - 1)."""
    return sum(math.comb(m, m - s) * math.comb(m + 4, s) * (x - 1) ** s * x ** (m - s) for s in range(m + 1)) if m else D(1)


def q_bfs_polynomials(most):
    """The Q of which d/du of u^2 (1 - u^2) Q(u^2) are orthonormal, in the mean over u = sin(angle): Gram and Schmidt."""
    def slope(a):  # of u^2 (1 - u^2) sum a_i u^2i, as powers of u
        b = [Fraction(0)] * (2 * len(a) + 4)
        for i, v in enumerate(a):
            b[2 * i + 1] += (2 * i + 2) * v
            b[2 * i + 3] -= (2 * i + 4) * v
        return b

    def mean(a, b):  # of sin^2k it is (2k)! / (4^k k!^2)
        return sum(p * q * Fraction(math.comb(i + j, (i + j) // 2), 2 ** (i + j)) for i, p in enumerate(a) for j, q in enumerate(b) if p and q)
    found = []
    for m in range(most):
        a = [Fraction(0)] * m + [Fraction(1)]
        for b in found:
            part = mean(slope(a), slope(b)) / mean(slope(b), slope(b))
            a = [p - part * q for p, q in zip(a, b + [Fraction(0)] * (len(a) - len(b)))]
        found.append(a if a[0] > 0 else [-v for v in a])
    def number(f): return D(f.numerator) / D(f.denominator)
    return [[number(v) / number(mean(slope(a), slope(a))).sqrt() for v in a] for a in found]


def keys(u):
    """The kernel of cubic convolution, a = -1/2 (Keys 1981, equation 15)."""
    u = abs(u)
    if u >= 2:
        return D(0)
    return (3 * u ** 3 - 5 * u * u) / 2 + 1 if u < 1 else (-u ** 3 + 5 * u * u - 8 * u) / 2 + 2


def interpolated(z, x, y):
    """x and y in cells from the first height on; one height more on each side by Keys' condition."""
    def beyond(a): return [3 * a[0] - 3 * a[1] + a[2], *a, 3 * a[-1] - 3 * a[-2] + a[-3]]
    wide = [beyond([D(v) for v in row]) for row in z]
    wide = [list(row) for row in zip(*[beyond(list(column)) for column in zip(*wide)])]
    return sum(wide[i][j] * keys(y + 1 - i) * keys(x + 1 - j) for i in range(len(wide)) for j in range(len(wide[0])))


def departure(s, x, y):
    t, a, r2 = s['type'], s['coefficients'] if 'coefficients' in s else None, x * x + y * y
    if t == 'even_asphere':
        return sum(D(v) * r2 ** (i + 1) for i, v in enumerate(a))
    if t == 'odd_asphere':
        return sum(D(v) * r2.sqrt() ** (i + 1) for i, v in enumerate(a))
    if t == 'polynomial_xy':
        return table(a, powers(x, 8), powers(y, 8))
    if t == 'chebyshev':
        return table(a, [polynomial(p, x / D(s['norm_x'])) for p in T], [polynomial(p, y / D(s['norm_y'])) for p in T])
    if t == 'zernike':
        order = {'noll': NOLL, 'fringe': FRINGE}[s['order']]
        return sum(D(v) * zernike(n, m, x / D(s['norm']), y / D(s['norm']), s.get('normalised', False)) for v, (n, m) in zip(a, order))
    u2 = r2 / D(s['norm']) ** 2 if 'norm' in s else None
    if t == 'q_con':
        return u2 ** 2 * sum(D(v) * q_con(m, u2) for m, v in enumerate(a))
    if t == 'q_bfs':
        return u2 * (1 - u2) / (1 - D(s.get('curvature', 0)) ** 2 * r2).sqrt() * sum(D(v) * polynomial(q, u2) for v, q in zip(a, q_bfs_polynomials(len(a))))
    if t == 'grid':
        z = s['sag']
        return interpolated(z, x / D(s['step_x']) + D(len(z[0]) - 1) / 2, y / D(s['step_y']) + D(len(z) - 1) / 2)
    if t == 'sum':
        return sum(departure(term, x, y) for term in s['terms'])
    raise KeyError(t)


def value(s, x, y, z):
    t = s['type']
    def number(key, default=0): return D(s.get(key, default))
    if t == 'biconic':
        u, v = number('curvature_x'), number('curvature_y')
        return z - (u * x * x + v * y * y) / (1 + (1 - (1 + number('conic_x')) * u * u * x * x - (1 + number('conic_y')) * v * v * y * y).sqrt())
    if t == 'cylinder':
        return z - conic(number('curvature'), number('conic'), y * y)
    if t == 'toroidal':
        p = conic(number('curvature'), number('conic'), y * y) + sum(D(v) * y ** (2 * i + 2) for i, v in enumerate(s.get('coefficients', [])))
        if not number('curvature_x'):
            return z - p
        radius = 1 / number('curvature_x')  # the circle about the axis at z = radius, through z = p
        away = ((radius - p) ** 2 - x * x).sqrt()
        return z - (radius - away if radius > 0 else radius + away)
    if t == 'quadric':
        q, p, l = ([D(v) for v in s.get(key, (0, 0, 0))] for key in ('squares', 'products', 'linear'))
        return q[0] * x * x + q[1] * y * y + q[2] * z * z + p[0] * x * y + p[1] * y * z + p[2] * x * z + l[0] * x + l[1] * y + l[2] * z + number('constant')
    if t == 'ellipsoid':
        a = number('a')
        return (x * x + y * y) / a ** 2 + z * z / (a * (1 - number('f'))) ** 2 - 1
    if t == 'torus':
        R, r = number('major'), number('minor')
        return (x * x + y * y + z * z + R * R - r * r) ** 2 - 4 * R * R * (x * x + y * y)
    return z - conic(number('curvature'), number('conic'), x * x + y * y) - departure(s, x, y)


# --------------------------------------------------------------------- cases

SAGS = [
    {'type': 'odd_asphere', 'curvature': 0.02, 'conic': -0.7, 'coefficients': [0.01, -0.002, 1e-4, 2e-5]},
    {'type': 'odd_asphere', 'coefficients': [0.5]},
    {'type': 'polynomial_xy', 'curvature': 0.01, 'conic': 0.5, 'coefficients': [[0.3, -0.1, 0.014], [0.01, 2e-3], [0.013, 0, 1e-5, -2e-6]]},
    {'type': 'polynomial_xy', 'coefficients': [[0, 0, 0.02], [0.1]]},
    {'type': 'toroidal', 'curvature': 0.025, 'conic': -1, 'curvature_x': 0.04, 'coefficients': [1e-3, -1e-5]},
    {'type': 'toroidal', 'curvature': 0.025, 'curvature_x': -0.03},
    {'type': 'toroidal', 'curvature': 0.025, 'conic': 0.3},
    {'type': 'biconic', 'curvature_x': 0.04, 'conic_x': -0.5, 'curvature_y': -0.02, 'conic_y': 2},
    {'type': 'biconic', 'curvature_y': 0.03},
    {'type': 'cylinder', 'curvature': 0.05, 'conic': -0.5},
    {'type': 'zernike', 'curvature': 0.02, 'norm': 6, 'order': 'noll', 'coefficients': [0.1, 0.02, -0.03, 0.2, 0.1, -0.1, 0.03, 0.02, 0.01, -0.02, 0.03, 0.01, 0.02, -0.02, 0.01]},
    {'type': 'zernike', 'norm': 5.5, 'order': 'fringe', 'normalised': True, 'coefficients': [0.1, 0.02, -0.03, 0.2, 0.1, -0.1, 0.03, 0.02, 0.01, -0.02, 0.03, 0.01, 0.02, -0.02, 0.01, 0.03]},
    {'type': 'chebyshev', 'curvature': -0.02, 'norm_x': 7, 'norm_y': 9, 'coefficients': [[0, 0.1, 0.2, 0, 0.01], [0.1, -0.05], [0.1, 0.02, 0, 0.03, 0, 0, 0.02], [0], [0.02], [0.01], [0.01]]},
    {'type': 'q_con', 'curvature': 0.03, 'conic': -1, 'norm': 8, 'coefficients': [0.3, -0.1, 0.05, 0.02, -0.01]},
    {'type': 'q_bfs', 'curvature': 0.03, 'norm': 8, 'coefficients': [0.3, -0.1, 0.05, 0.02, -0.01]},
    {'type': 'grid', 'curvature': 0.01, 'step_x': 2.5, 'step_y': 3, 'sag': [[0.1 * math.sin(i * j + i) for j in range(9)] for i in range(7)]},
    {'type': 'sum', 'curvature': 0.02, 'conic': -0.5, 'terms': [{'type': 'even_asphere', 'coefficients': [1e-3, -1e-5]},
     {'type': 'odd_asphere', 'coefficients': [0, 0, 1e-4]}, {'type': 'zernike', 'norm': 6, 'order': 'noll', 'coefficients': [0, 0.1, 0.1, 0.1]},
     {'type': 'grid', 'step_x': 5, 'step_y': 5, 'sag': [[0.01 * i * j for j in range(5)] for i in range(5)]}]},
]
BODIES = [
    {'type': 'quadric', 'squares': [1, 2, 0.5], 'products': [0.3, -0.2, 0.1], 'linear': [1, -1, 0.5], 'constant': -20},
    {'type': 'quadric', 'squares': [1, 1, -1], 'constant': 4},
    {'type': 'ellipsoid', 'a': 5, 'f': 0.3},
    {'type': 'ellipsoid', 'a': 3, 'f': -0.4},
    {'type': 'torus', 'major': 5, 'minor': 2},
    {'type': 'torus', 'major': 2, 'minor': 3},
]


def spec(s):
    return json.dumps(s)


def along(s, ray, t):
    return value(s, *(D(ray[i]) + t * D(ray[i + 3]) for i in range(3)))


def check_root(s, ray, row):
    """The root next to t lies within t_err of it, and the normal is the gradient's direction."""
    t = D(row['t'])
    for _ in range(12):
        f = along(s, ray, t)
        step = f * STEP / (along(s, ray, t + STEP) - f)
        t -= step
        if abs(step) < D('1e-45'):
            break
    assert abs(t - D(row['t'])) <= D(row['t_err']), f'{spec(s)} {ray}: t {row["t"]} +- {row["t_err"]}, and the root is {t:.25}'
    assert float(row['t_err']) < 1e-9, f'{spec(s)} {ray}: t_err {row["t_err"]}'
    p = [D(ray[i]) + t * D(ray[i + 3]) for i in range(3)]
    grad = [(value(s, *(v + (STEP if i == k else 0) for i, v in enumerate(p))) - value(s, *p)) / STEP for k in range(3)]
    normal = [D(row[key]) for key in ('nx', 'ny', 'nz')]
    length = sum(v * v for v in grad).sqrt() * sum(v * v for v in normal).sqrt()
    apart = max(abs(grad[i] * normal[j] - grad[j] * normal[i]) for i in range(3) for j in range(i))
    assert apart <= D('1e-7') * length, f'{spec(s)} {ray}: normal {normal}, gradient {grad}'
    for name, v in zip('xyz', p):
        close(row[name], v, 1e-8, f'{spec(s)} {ray}: {name}')


def several(draw, reach, back):
    """Rays from z = -back toward the disk of radius reach at z = 0."""
    found = []
    for _ in range(RAYS):
        o = [draw.uniform(-reach, reach), draw.uniform(-reach, reach), -back]
        to = [draw.uniform(-reach, reach), draw.uniform(-reach, reach), 0]
        found.append([*o, *(b - a for a, b in zip(o, to))])
    return found


def meet(s, shots, *more):
    return rows('intersect', '--surface', spec(s), '--rays', '-', *more, stdin=rays(*([repr(v) for v in ray] for ray in shots)), exit=None)


def test_sags():
    for number, s in enumerate(SAGS):
        shots = several(random.Random(number), 4, 20)
        found = meet(s, shots)
        equal([row['status'] for row in found], ['hit'] * RAYS, spec(s))
        for ray, row in zip(shots, found):
            check_root(s, ray, row)


def test_bodies():
    """Every root that is told is one; as many are told as F changes its sign on a fine row of points."""
    for number, s in enumerate(BODIES):
        shots = several(random.Random(number), 6, 15)
        found = meet(s, shots, '--all')
        met = 0
        for k, ray in enumerate(shots):
            mine = [row for row in found if int(row['ray']) == k and row['root'] != '-1']
            for row in mine:
                assert row['status'] in ('hit', 'graze'), (spec(s), ray, row)
                if row['status'] == 'hit':
                    check_root(s, ray, row)
            met += len(mine)
            o, d = ray[:3], ray[3:]
            def sign(t): return float(value(s, *(D(a + t * b) for a, b in zip(o, d)))) > 0
            signs = [sign(0.01 * i) for i in range(1, 400)]
            crossings = sum(a != b for a, b in zip(signs, signs[1:]))
            inside = [row for row in mine if 0.01 < float(row['t']) < 3.99]
            assert len(inside) >= crossings, f'{spec(s)} {ray}: {len(inside)} roots, and F changes its sign {crossings} times'
        assert met > RAYS // 4, (spec(s), met)


def test_known_answers():
    """Small ones, worked out by hand: on the axis, and where a root is plain."""
    for s, ray, t in [
        ({'type': 'torus', 'major': 3, 'minor': 1}, (-9, 0, 0, 1, 0, 0), 5),
        ({'type': 'ellipsoid', 'a': 4, 'f': 0.25}, (0, 0, -10, 0, 0, 1), 7),
        ({'type': 'ellipsoid', 'a': 4, 'f': 0.25}, (10, 0, 0, -1, 0, 0), 6),
        ({'type': 'quadric', 'squares': [1, 1, 1], 'constant': -9}, (0, 0, -5, 0, 0, 1), 2),
        ({'type': 'quadric', 'linear': [0, 0, 1], 'constant': -2}, (0, 0, 0, 0, 0, 1), 2),
        ({'type': 'cylinder', 'radius': 5}, (7, 3, -4, 0, 0, 1), 5),
        ({'type': 'cylinder', 'radius': .5}, (0, 0, -4, 0, 0, 1), 4),
        ({'type': 'toroidal', 'radius': 5}, (7, 3, -4, 0, 0, 1), 5),
        ({'type': 'toroidal', 'radius_x': 5}, (3, 7, -4, 0, 0, 1), 5),
        ({'type': 'biconic', 'radius_x': 5}, (3, 7, -4, 0, 0, 1), 5),
        ({'type': 'biconic', 'radius_y': -5}, (3, 4, -4, 0, 0, 1), 2),
        ({'type': 'odd_asphere', 'coefficients': [1]}, (3, 4, -5, 0, 0, 1), 10),
        ({'type': 'polynomial_xy', 'coefficients': [[1, 2], [0, 4]]}, (3, 0.5, -5, 0, 0, 1), 13),
        ({'type': 'chebyshev', 'norm_x': 2, 'norm_y': 4, 'coefficients': [[0, 0], [0, 0], [0, 1]]}, (1, 2, 0, 0, 0, 1), None),
        ({'type': 'chebyshev', 'norm_x': 2, 'norm_y': 4, 'coefficients': [[0, 0], [0, 0], [0, 1]]}, (1, 2, -1, 0, 0, 1), 0.75),
        ({'type': 'zernike', 'norm': 2, 'order': 'noll', 'coefficients': [0, 0, 0, 1]}, (1, 0, -1, 0, 0, 1), 0.5),
        ({'type': 'zernike', 'norm': 2, 'order': 'fringe', 'coefficients': [0, 0, 0, 0, 1]}, (2, 0, -1, 0, 0, 1), 2),
        ({'type': 'zernike', 'norm': 2, 'order': 'noll', 'normalised': True, 'coefficients': [0, 1]}, (2, 0, -1, 0, 0, 1), 3),
        ({'type': 'q_con', 'norm': 2, 'coefficients': [3]}, (2, 0, -1, 0, 0, 1), 4),
        ({'type': 'q_bfs', 'norm': 2, 'coefficients': [16]}, (1, 0, -1, 0, 0, 1), 4),
        ({'type': 'grid', 'step_x': 1, 'step_y': 1, 'sag': [[1, 2, 3, 4]] * 4}, (1.5, 0, 0, 0, 0, 1), 4),
        ({'type': 'grid', 'step_x': 1, 'step_y': 2, 'sag': [[1] * 5, [2] * 5, [3] * 5, [4] * 5]}, (0, 1, 0, 0, 0, 1), 3),
    ]:
        row, = meet(s, [ray])
        if t is None:
            equal(row['status'], 'miss', spec(s))
        else:
            equal(row['status'], 'hit', spec(s))
            close(row['t'], t, float(row['t_err']) + 1e-15 * t, spec(s))


def test_radii():
    """1/radius in each place that a curvature has, infinite ones too; a term of a sum has neither."""
    ray = [(1, 2, -5, 0.1, 0.05, 1)]
    for one, other in [
        ({'type': 'biconic', 'radius_x': 8, 'radius_y': -16}, {'type': 'biconic', 'curvature_x': 0.125, 'curvature_y': -0.0625}),
        ({'type': 'biconic', 'radius_x': math.inf, 'radius_y': 16, 'conic_y': 1}, {'type': 'cylinder', 'radius': 16, 'conic': 1}),
        ({'type': 'toroidal', 'radius': 8, 'radius_x': math.inf}, {'type': 'toroidal', 'curvature': 0.125}),
        ({'type': 'zernike', 'radius': 8, 'norm': 1, 'order': 'noll'}, {'type': 'zernike', 'curvature': 0.125, 'norm': 1, 'order': 'fringe'}),
    ]:
        text = (spec(s).replace('Infinity', '.inf') for s in (one, other))
        first, second = (rows('intersect', '--surface', s, '--rays', '-', stdin=rays(*ray)) for s in text)
        for key in ('t', 'x', 'y', 'z'):
            close(first[0][key], second[0][key], float(first[0]['t_err']) + float(second[0]['t_err']), f'{one} {key}')


def without_113_bits(test):
    """Of a command that tells no errors."""
    return (lambda: None) if '--without-quad' in sys.argv else test


@without_113_bits
def test_trade_tells_the_errors():
    """The worst error that `trade` tells of t is the one by these 60 digits, of each type."""
    for number, s in enumerate(SAGS + BODIES):
        shots = several(random.Random(number), 4, 20)[:6]
        worst = D(0)
        for ray, row in zip(shots, meet(s, shots)):
            if row['status'] != 'hit':
                continue
            t = D(row['t'])
            for _ in range(12):
                f = along(s, ray, t)
                t -= f * STEP / (along(s, ray, t + STEP) - f)
            worst = max(worst, abs(t - D(float(row['t']))))
        default = rows('trade', '--surface', spec(s), '--rays', '-', '--seconds', '0', stdin=rays(*([repr(v) for v in ray] for ray in shots)))[0]
        equal((default['setting'], default['wrong']), ('default', '0'))
        close(default['err_worst'], float(worst), 1e-6 * float(worst), spec(s))


# --------------------------------------------------------------------- files

def npy(z, type='<f8', fortran=False, version=1, shape=None, header=None):
    order = [v for column in zip(*z) for v in column] if fortran else [v for row in z for v in row]
    text = header or "{'descr': '%s', 'fortran_order': %s, 'shape': %s, }" % (type, fortran, shape or (len(z), len(z[0])))
    text = (text + ' ' * (-(len(text) + 11) % 64) + '\n').encode()
    return b'\x93NUMPY' + bytes((version, 0)) + struct.pack('<H' if version == 1 else '<I', len(text)) + text + \
        struct.pack(f'<{len(order)}{"f" if type == "<f4" else "d"}', *order)


HEIGHTS = [[0.125 * i - 0.0625 * j * j for j in range(5)] for i in range(4)]
CSV = '\n'.join(','.join(map(repr, row)) for row in HEIGHTS)


def test_files():
    """A grid from a file is the grid written out, to the last byte; so is a table of coefficients."""
    shots = rays((0.3, 0.4, -5, 0.01, 0.02, 1), (-1.2, 0.1, -5, 0, 0.02, 1))
    def answers(sag): return run('intersect', '--surface', '{type: grid, step_x: 1, step_y: 2, sag: %s}' % sag, '--rays', '-', '--format', 'csv', stdin=shots).stdout
    wanted = answers(json.dumps(HEIGHTS))
    for name, content in [
        ('a.csv', CSV), ('b.CSV', CSV + '\n'), ('c.csv', '\ufeff' + CSV.replace(',', ' ,\t').replace('\n', ' \r\n') + '\r\n\n \n'),
        ('a.npy', npy(HEIGHTS)), ('b.npy', npy(HEIGHTS, fortran=True)), ('c.npy', npy(HEIGHTS, version=2)), ('d.npy', npy(HEIGHTS, type='<f4')),
        ('e.npy', npy(HEIGHTS, type='<f4', fortran=True, version=3)), ('f.npy', npy(HEIGHTS, header="{'shape':(4,5),'fortran_order':False,'descr':'<f8'}")),
    ]:
        equal(answers(written(content, name)), wanted, name)
    coefficients = written('0,0.125\n0.25,0.5\n', 'coefficients.csv')
    first, second = (rows('intersect', '--surface', '{type: polynomial_xy, coefficients: %s}' % c, '--rays', '-', stdin=shots)
                     for c in (coefficients, '[[0, 0.125], [0.25, 0.5]]'))
    equal(first, second)


def places():
    """Rays from places and places of hits: --from and --look, csv, --all, shards' own columns; what is wrong is said."""
    surface = '{type: geodetic_height, h: 100}'
    table = 'lat,lon,height,az,el,id\n48,11,7e5,0,-90,a\n90,0,7e5,90,-90,b\n-90,7,7e5,0,-90,c\n10,180,7e5,0,-90,d\n-10,-180,7e5,0,-90,e\n5,5,7e5,0,30,f\n'
    found = rows('intersect', '--surface', surface, '--rays', '-', stdin=table)
    looks = [word for line in table.split()[1:] for la, lo, h, az, el, _ in [line.split(',')] for word in ('--from', f'{la} {lo} {h}', '--look', f'{az} {el}')]
    by_option = rows('intersect', '--surface', surface, *looks)
    for a, b, (la, lo) in zip(found, by_option, ((48, 11), (90, 0), (-90, 0), (10, 180), (-10, 180), (None, None))):
        equal([a[k] for k in ('status', 't', 'lat', 'lon', 'height')], [b[k] for k in ('status', 't', 'lat', 'lon', 'height')])
        if la is None:
            equal((a['status'], a['lat'], a['height']), ('miss', 'nan', 'nan'))
            continue
        close(a['t'], 7e5 - 100, 1e-7), close(a['lat'], la, 1e-9), close(a['lon'], lo, 1e-9), close(a['height'], 100, 1e-7)
    every = rows('intersect', '--surface', surface, '--from', '48 11 7e5', '--look', '0 -90', '--all')
    equal([round(float(r['height']), 6) for r in every], [100, 100])
    close(every[1]['lon'], 11 - 180, 1e-6)
    equal(len(rows('intersect', '--surface', surface, '--from', '0 0 7e5', '--look', '0 -90 0 1000', '--look', '0 -90')), 2)
    equal('lat' in rows('intersect', '--surface', '{type: sphere, radius: 2}', '--ray', '0 0 -5 0 0 1')[0], False)
    for words, wanted, exit in ((('--from', '0 0 0'), '--from without --look', 2), (('--look', '0 0'), '--look: give the place first', BAD_INPUT),
                                (('--from', '91 0 0', '--look', '0 0'), '--from: lat: must be from -90', BAD_INPUT),
                                (('--from', '0 0 0', '--look', '0 -91'), '--look: el: must be from -90', BAD_INPUT),
                                (('--from', '0 0', '--look', '0 0'), '--from: must be 3 numbers', BAD_INPUT),
                                (('--from', '0 0 0', '--look', '0 0', '--ray', '1 0 0 1 0 0'), 'not both', BAD_INPUT),
                                (('--ray', '1 0 0 1 0 0', '--from', '0 0 0', '--look', '0 0'), 'not both', BAD_INPUT)):
        done = run('intersect', '--surface', surface, *words, exit=exit)
        assert wanted in done.stderr, (words, done.stderr)
    done = run('intersect', '--surface', '{type: torus, major: 2, minor: 1}', '--from', '0 0 0', '--look', '0 0', exit=2)
    assert 'needs a surface about the Earth' in done.stderr, done.stderr
    for text, wanted in (('lat,lon,height,az\n1,1,1,1\n', ':1: el: this column is missing'), ('lat,lon,height,az,el,ox\n', ':1: ox: unknown column'),
                         ('lat,lon,height,az,el\n0,0,0,0,0\n0,0,0,x,0\n', ':3: az: "x" is not a number'), ('lat,lon,height,az,el\n-91,0,0,0,0\n', ':2: lat: must be')):
        done = run('intersect', '--surface', surface, '--rays', '-', stdin=text, exit=BAD_INPUT)
        assert wanted in done.stderr, (text, done.stderr)


def test_earth():
    """At the equator and at the pole; bad parameters name their key.  Without GeographicLib the types are errors that say so."""
    a, f = 6378137, 1 / 298.257223563
    for kind in ('geodetic_height', 'level_gravity', 'geoid'):
        done = subprocess.run([SAGITTA, 'intersect', '--surface', '{type: %s, h: 1e9}' % kind, '--ray', '7e6 0 0 -1 0 0'], capture_output=True, text=True)
        if 'built without GeographicLib' in done.stderr:
            assert '--surface:1: type: ' + kind in done.stderr, done.stderr
            equal(done.returncode, BAD_INPUT)
            continue
        for ray, t in (((7e6, 0, 0, -1, 0, 0), 7e6 - a), ((0, 0, 7e6, 0, 0, -1), 7e6 - a * (1 - f))):
            if kind == 'geoid':
                continue
            row, = rows('intersect', '--surface', '{type: %s}' % kind, '--rays', '-', stdin=rays(ray))
            close(row['t'], t, 1e-7, kind)
            row, = rows('intersect', '--surface', '{type: geodetic_height, h: 100}', '--rays', '-', stdin=rays(ray))
            close(row['t'], t - 100, 1e-7, 'h')
            row, = rows('intersect', '--surface', '{type: geodetic_height, a: 6000000, f: %r}' % f, '--rays', '-', stdin=rays(ray))
            close(row['t'], 7e6 - (7e6 - t) * 6000000 / a, 1e-7, 'a and f')
    if 'built without' in done.stderr:
        return
    cut = written(struct.pack('>4d2i', -90, -180, 90, 90, 3, 4) + bytes(20), 'cut.gtx')
    flat = written(struct.pack('>4d2i', -90, -180, 1, 1, 181, 360) + struct.pack('>f', 10) * (181 * 360), 'flat.gtx')
    row, = rows('intersect', '--surface', '{type: geoid, file: "%s", h: 5}' % flat, '--rays', '-', stdin=rays((7e6, 0, 0, -1, 0, 0)))
    close(row['t'], 7e6 - a - 15, 1e-7, 'a geoid 10 m over the ellipsoid')
    places()
    for spec_of, wanted in (('geodetic_height, f: 1', 'f: '), ('geodetic_height, a: -1', 'a: '), ('geodetic_height, h: -7e6', 'h: '),
                            ('geodetic_height, potential: 1', 'potential: unknown key'), ('level_gravity, h: 1e8', 'h: '),
                            ('level_gravity, potential: 1', 'potential: '), (f'geoid, file: "{cut}"', f'file: {cut}'),
                            ('geoid, file: nowhere.gtx', 'file: nowhere.gtx'), ('geoid, fil: x', 'fil: unknown key; did you mean file?  Known here: type, h, file'),
                            (f'geoid, file: "{flat}", h: .inf', 'h: must be finite')):
        done = run('intersect', '--surface', '{type: %s}' % spec_of, '--ray', '7e6 0 0 -1 0 0', exit=BAD_INPUT)
        assert '--surface:1: ' + wanted in done.stderr, (spec_of, done.stderr)


def test_file_beside_the_lens():
    """A file is looked for beside the lens file; of --surface in the current folder."""
    lens = written('pupil: {semi_diameter: 0.5}\nsurfaces:\n  - {type: plane, thickness: 5, stop: true}\n'
                   '  - {type: grid, step_x: 1, step_y: 1, sag: heights.csv}\n')
    (lens.parent / 'heights.csv').write_text(CSV)
    inline = written(lens.read_text().replace('heights.csv', json.dumps(HEIGHTS)))
    equal(rows('trace', lens, '--fan', 5), rows('trace', inline, '--fan', 5))
    here = os.getcwd()
    try:
        os.chdir(lens.parent)
        equal(rows('trace', lens.name, '--fan', 5), rows('trace', inline, '--fan', 5))
        row, = rows('intersect', '--surface', '{type: grid, step_x: 1, step_y: 1, sag: heights.csv}', '--ray', '0 0 -5 0 0 1')
        equal(row['status'], 'hit')
        done = run('intersect', '--surface', '{type: grid, step_x: 1, step_y: 1, sag: heights.csv}', '--ray', '0 0 -5 0 0 1', '--output', 'heights.csv', exit=USAGE)
        assert 'written over heights.csv' in done.stderr, done.stderr
        equal((lens.parent / 'heights.csv').read_text(), CSV)
    finally:
        os.chdir(here)


FILES = [
    ('header.csv', 'a,b,c\n1,2,3\n', 'header.csv:1: column 1: "a" is not a number; the file must have no header row'),
    ('hole.csv', '1,2,3,4\n5,,7,8\n', 'hole.csv:2: column 2: empty'),
    ('last.csv', '1,2,3,4\n5,6,7,\n', 'last.csv:2: column 4: empty'),
    ('nan.csv', '1,2,3\n4,nan,6\n', 'nan.csv:2: column 2: nan'),
    ('inf.csv', '1,2,3\n4,5,-inf\n', 'inf.csv:2: column 3: -inf'),
    ('ragged.csv', '1,2,3\n4,5,6\n7,8\n', 'ragged.csv:3: 2 numbers, but the rows above have 3'),
    ('more.csv', '1,2\n4,5,6\n', 'more.csv:2: 3 numbers, but the rows above have 2'),
    ('cut.csv', '1,2,3\n4,5,6e', 'cut.csv:2: column 3: "6e" is not a number'),
    ('line.csv', '1,2\n\n3,4\n', 'line.csv:2: column 1: empty'),
    ('blanks.csv', '1,2\n3 4\n', 'blanks.csv:2: column 1: "3 4" is not a number; put commas'),
    ('decimal.csv', '1,5;2,5\n', 'decimal.csv:1: column 2: "5;2" is not a number; put commas'),
    ('comment.csv', '# heights\n1,2\n', 'comment.csv:1: column 1: "# heights" is not a number'),
    ('quoted.csv', '"1",2\n', 'quoted.csv:1: column 1: '),
    ('zero.csv', '1,2\x003,4\n', 'zero.csv:1: column 2: a zero byte'),
    ('huge.csv', '1,1e999\n', 'huge.csv:1: column 2: '),
    ('empty.csv', '', 'empty.csv: empty'),
    ('blank.csv', ' \n\n', 'blank.csv: empty'),
    ('wide.csv', ','.join(['0'] * 4097) + '\n', 'wide.csv:1: more than 4096 columns'),
    ('long.csv', '0\n' * 4097, 'long.csv:4097: more than 4096 rows'),
    ('few.csv', '1,2,3\n' * 5, 'sag: '),
    ('text.npy', '1,2,3\n', 'text.npy: not an npy file'),
    ('cut.npy', npy(HEIGHTS)[:-1], 'cut.npy: cut off: 19 numbers, but the header says 20'),
    ('more.npy', npy(HEIGHTS) + b'1', 'more.npy: 1 bytes behind the last number'),
    ('header.npy', npy(HEIGHTS)[:40], 'header.npy: cut off within its header'),
    ('start.npy', npy(HEIGHTS)[:9], 'start.npy: not an npy file'),
    ('ten.npy', npy(HEIGHTS, version=2)[:10], 'ten.npy: cut off within its header'),
    ('version.npy', npy(HEIGHTS, version=9), 'version.npy: version 9'),
    ('type.npy', npy(HEIGHTS, type='<i8'), "type.npy: numbers of the type '<i8'"),
    ('order.npy', npy(HEIGHTS, type='>f8'), "order.npy: numbers of the type '>f8'"),
    ('one.npy', npy(HEIGHTS, shape='(20,)'), 'one.npy: the shape must have two dimensions'),
    ('three.npy', npy(HEIGHTS, shape='(4, 5, 1)'), 'three.npy: the shape must have two dimensions'),
    ('none.npy', npy(HEIGHTS, shape='(0, 5)'), 'none.npy: empty'),
    ('vast.npy', npy(HEIGHTS, shape='(4611686018427387905, 4)'), 'vast.npy: the shape must have two dimensions'),
    ('many.npy', npy(HEIGHTS, shape='(4, 5000)'), 'many.npy: 4 rows and 5000 columns; at most 4096 of either are allowed'),
    ('key.npy', npy(HEIGHTS, header="{'shape': (4, 5)}"), 'key.npy: no header'),
    ('nan.npy', npy([[1, 2], [3, math.nan]]), 'nan.npy: row 2, column 2: nan'),
    ('fortran.npy', npy([[1, 2, 3], [math.inf, 4, 5]], fortran=True), 'fortran.npy: row 2, column 1: inf'),
]


def test_bad_files():
    for name, content, wanted in FILES:
        lens = written('surfaces:\n  - {type: plane, thickness: 1}\n  - {type: grid, step_x: 1, step_y: 1,\n     sag: %s}\n' % name)
        (lens.parent / name).write_bytes(content.encode() if isinstance(content, str) else content)
        done = run('trace', lens, '--rays', '-', stdin=rays((0, 0, -1, 0, 0, 1)), exit=BAD_INPUT)
        assert f'{lens}:4: sag: ' in done.stderr and wanted in done.stderr, f'{name}: {done.stderr}'
    for name in ('nowhere.csv', 'nowhere.npy', '/', '', 'heights.txt', '5'):
        done = run('intersect', '--surface', '{type: grid, step_x: 1, step_y: 1, sag: "%s"}' % name, '--ray', '0 0 -5 0 0 1', exit=BAD_INPUT)
        assert '--surface:1: sag: ' in done.stderr, done.stderr


DOCS = HERE.parent.parent / 'docs'
DOCUMENTS = [DOCS / name for name in ('lens_file.md', 'lens_file_surfaces.md', 'lens_file_phases.md')]


def test_document():
    """Each surface that the pages of the lens file show can be read; with docs/surfaces.md it names every type, and every key of each."""
    text = ''.join(page.read_text() for page in DOCUMENTS)
    heights = written('\n'.join(','.join(['0.01'] * 5) for _ in range(5)), 'measured.csv')
    examples = [line[2:].split('   #')[0] for line in text.splitlines() if line.startswith('- {type')]
    assert len(examples) > 14, len(examples)
    for example in examples:
        run('intersect', '--surface', example.replace('measured.csv', str(heights)), '--ray', '0.1 0.2 -5 0 0 1', exit=None)
    done = run('intersect', '--surface', '{type: nothing}', '--ray', '0 0 -5 0 0 1', exit=BAD_INPUT)
    text += (DOCS / 'surfaces.md').read_text()
    types = done.stderr.strip().split('there are: ')[1].split(', ')
    assert len(types) >= 20, types
    for name in types:
        assert f'`{name}`' in text, name
        text_of = ', f: x' if name == 'formula' else ''
        done = run('intersect', '--surface', '{type: %s, nothing: 1%s}' % (name, text_of), '--ray', '0 0 -5 0 0 1', exit=BAD_INPUT)
        known = done.stderr.strip().split('known here: ')[1].removesuffix(', and the parameters that the formula names')
        for key in known.replace(' or ', ', ').split(', '):
            assert f'`{key}`' in text, (name, key)


main(globals())
