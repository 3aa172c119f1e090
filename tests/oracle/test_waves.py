#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Gratings and polynomial phases against 50 digits, by the definitions of system.h.

    python3 test_waves.py WAVES      (the program waves.c)

The direction behind is found from its two properties: its tangential momentum, as the components along two
tangents of the surface, and its length.  SAGITTA_TEST_SEED chooses other cases, SAGITTA_TEST_SCALE multiplies how
many.  The oracle is mpmath, or the decimal module where that is not installed.
"""
import os
import subprocess
import sys

try:
    import mpmath
    mpmath.mp.dps = 50
    N, root, ORACLE = mpmath.mpf, mpmath.sqrt, 'mpmath'
except ImportError:
    import decimal
    decimal.getcontext().prec = 50
    N, ORACLE = decimal.Decimal, 'decimal'
    def root(x): return x.sqrt()

SEED = os.environ.get('SAGITTA_TEST_SEED', '1')
COUNT = max(1, int(20000 * float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))))
PASSED, EVANESCENT = 1, 4
UNIT = N(2) ** -53


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def exact(x):
    """The direction behind (None: there is none), S, |t|, n2, the sizes of G and of S, and the cosine behind."""
    n1, n2, mirror, c, k, per_wave, a, p, d = x[0], x[1], x[2], x[3], x[4], x[5], x[6:15], x[15:18], x[18:21]
    phi = root(1 - (1 + k) * c * c * (p[0] * p[0] + p[1] * p[1]))
    slope = [c * p[0] / phi, c * p[1] / phi]
    power = [[N(1), q, q * q] for q in p[:2]]
    by = [[N(0), N(1), 2 * q] for q in p[:2]]
    terms = [(a[3 * i + j], i, j) for i in range(3) for j in range(3)]
    w = sum(t * power[0][i] * power[1][j] for t, i, j in terms)
    g = [per_wave * sum(t * by[0][i] * power[1][j] for t, i, j in terms),
         per_wave * sum(t * power[0][i] * by[1][j] for t, i, j in terms)]
    sizes = (abs(per_wave) * sum(abs(t * by[0][i] * power[1][j]) + abs(t * power[0][i] * by[1][j])
                                 for t, i, j in terms),
             abs(per_wave) * sum(abs(t * power[0][i] * power[1][j]) for t, i, j in terms))
    u = [n1 * d[0] + g[0], n1 * d[1] + g[1], n1 * d[2]]
    # tangents (1, 0, sx) and (0, 1, sy): t = A e1 + B e2 has the products of u with them
    e1, e2 = [N(1), N(0), slope[0]], [N(0), N(1), slope[1]]
    g11, g12, g22 = dot(e1, e1), dot(e1, e2), dot(e2, e2)
    r1, r2, det = dot(u, e1), dot(u, e2), g11 * g22 - g12 * g12
    A, B = (g22 * r1 - g12 * r2) / det, (g11 * r2 - g12 * r1) / det
    t = [A * s + B * q for s, q in zip(e1, e2)]
    normal = [-slope[0], -slope[1], N(1)]
    inverse = 1 / root(dot(normal, normal))
    normal = [s * inverse for s in normal]
    t2 = dot(t, t)
    along = root(t2)
    if t2 >= n2 * n2:
        return None, per_wave * w, along, n2, sizes, N(0)
    up = (dot(d, normal) > 0) != (mirror != 0)
    behind = root(n2 * n2 - t2)
    out = [(s + (behind if up else -behind) * q) / n2 for s, q in zip(t, normal)]
    return out, per_wave * w, along, n2, sizes, behind / n2


def main():
    text = subprocess.run([sys.argv[1], str(COUNT), SEED], capture_output=True, text=True, check=True).stdout
    lines = text.splitlines()
    print(f'SAGITTA_TEST_SEED={SEED}, {len(lines)} of {COUNT} cases, by {ORACLE}')
    faults, count, worst = 0, {}, {'direction': (N(0), ''), 'path': (N(0), '')}
    for line in lines:
        word = line.split()
        x = [N(float.fromhex(s)) for s in word[:21]]
        fate, got, opl = int(word[21]), [N(float.fromhex(s)) for s in word[22:25]], N(float.fromhex(word[25]))
        count[fate] = count.get(fate, 0) + 1
        behind, S, along, n2, sizes, cosine = exact(x)
        # the normal of a conic is off by some roundings, too
        noise = UNIT * (8 * (x[0] + sizes[0]) + (0 if x[3] == 0 else 8 * (x[0] + sizes[0])))
        if fate != (PASSED if behind else EVANESCENT):
            if abs(along - n2) > noise:
                faults += 1
                print(f'FAIL fate {fate}: {line}')
            continue
        if not behind:
            continue
        off = {'direction': (max(abs(s - t) for s, t in zip(behind, got)) / (noise / (n2 * cosine) + 4 * UNIT), 1),
               'path': (abs(opl - S) / (16 * UNIT * sizes[1]) if sizes[1] else abs(opl), 1)}
        for what, (by, limit) in off.items():
            worst[what] = max(worst[what], (by, line))
            if not by <= limit:
                faults += 1
                print(f'FAIL {what} off by {float(by):.3g} of its bound: {line}')
    for what, (by, line) in worst.items():
        print(f'{what}: at most {float(by):.3g} of its bound, {line}')
    print('fates', count)
    if len(lines) < 0.9 * COUNT or count.get(EVANESCENT, 0) < 0.02 * COUNT:
        sys.exit('FAIL too few cases')
    sys.exit(1 if faults else 0)


if __name__ == '__main__':
    main()
