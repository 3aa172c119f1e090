#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Ideal lenses against 50 digits, by the definitions of system.h.

    python3 test_phase.py PHASE      (the program phase.c)

SAGITTA_TEST_SEED chooses other cases, SAGITTA_TEST_SCALE multiplies how many.  The oracle is mpmath, or the
decimal module where that is not installed.
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


def size(*w):
    return root(1 + sum(c * c for c in w))


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def power_of(f):
    return N(0) if f in (N('inf'), -N('inf')) else 1 / f


def exact(n1, n2, mirror, f, a, p, d):
    """The direction behind, and W: as the path to the image, or where that is at infinity, by the formula.  Of two
    powers f the image is that of the section in which p and the ray lie; elsewhere W is the formula."""
    fx, fy = f
    powers = [power_of(fx), power_of(fy)]
    flat = [k for k in (0, 1) if p[1 - k] == 0 and d[1 - k] == 0]
    to = 1 if d[2] > 0 else -1
    w = [d[0] / abs(d[2]), d[1] / abs(d[2])]
    w2 = [(n1 * u - x * s) / n2 for u, x, s in zip(w, p, powers)]
    w0 = [u - x / a if a else u for u, x in zip(w, p)]
    w02 = [n1 * u / n2 for u in w0]
    length = size(*w2)
    behind = [u / length for u in w2] + [(-to if mirror else to) / length]
    power = powers[flat[0]] if flat else powers[0]
    vergence = power - (n1 / a if a else 0)
    if a and (fx == fy or flat) and abs(vergence) > N(10) ** -8 * abs(power):
        b = n2 / vergence
        more = n1 * a * (size(*w0) - size(*w)) + n2 * b * (size(*w02) - size(*w2))
    else:
        more = (n2 * dot(p, [s + t for s, t in zip(w2, w02)]) / (size(*w2) + size(*w02))
                - n1 * dot(p, [s + t for s, t in zip(w, w0)]) / (size(*w) + size(*w0)))
    if fx != fy and not a and w == [0, 0] and ORACLE == 'mpmath' and len(AXIAL) < 40:
        AXIAL.append((powers, n2, p, more))
    return behind, more


AXIAL = []


def along_the_line():
    """Of rays parallel to the axis: W is the integral of the momentum behind along the line from the vertex."""
    for powers, n2, p, more in AXIAL:
        def slope(t):
            w = [-t * x * s / n2 for x, s in zip(p, powers)]
            return n2 * dot(p, w) / size(*w)
        by = mpmath.quad(slope, [0, 1])
        if not abs(by - more) <= N(10) ** -15 * abs(more):
            return f'FAIL along the line: {by}, not {more}'
    print(f'{len(AXIAL)} rays parallel to the axis agree with the integral')
    return '' if len(AXIAL) > 5 or ORACLE != 'mpmath' else 'FAIL no rays along the axis'


def main():
    text = subprocess.run([sys.argv[1], str(COUNT), SEED], capture_output=True, text=True, check=True).stdout
    print(f'SAGITTA_TEST_SEED={SEED}, {len(text.splitlines())} of {COUNT} cases, by {ORACLE}')
    unit, faults, worst = N(2) ** -53, 0, {'direction': (N(0), ''), 'path': (N(0), '')}
    for line in text.splitlines():
        x = [N(float.fromhex(s)) for s in line.split()]
        n1, n2, mirror, fx, fy, a, p, d, got, opl = *x[:6], x[6:8], x[8:11], x[11:14], x[14]
        fy = fy or fx
        f = min(abs(fx), abs(fy))
        behind, more = exact(n1, n2, mirror != 0, (fx, fy), a, p, d)
        r2, change = dot(p, p), abs(n2 - n1)
        r = root(r2)
        bound = (r2 / abs(f) * (1 + change / n2) + change * r) * (1 + r / (n2 * abs(f)))
        off = {'direction': (max(abs(s - t) for s, t in zip(behind, got)), 8),
               'path': (abs(opl - more) / bound if bound else abs(opl), 64)}
        for what, (by, limit) in off.items():
            worst[what] = max(worst[what], (by / unit, line))
            if not by <= limit * unit:
                faults += 1
                print(f'FAIL {what} off by {float(by / unit):.3g} of 2^-53: {line}')
    for what, (by, line) in worst.items():
        print(f'{what}: at most {float(by):.3g} of 2^-53 times its size, {line}')
    wrong = along_the_line()
    if wrong:
        sys.exit(wrong)
    if not text or len(text.splitlines()) < 0.99 * COUNT:
        sys.exit('FAIL too few cases')
    sys.exit(1 if faults else 0)


if __name__ == '__main__':
    main()
