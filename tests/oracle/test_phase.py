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


def exact(n1, n2, mirror, f, a, p, d):
    """The direction behind, and W: as the path to the image, or where that is at infinity, by the formula."""
    to = 1 if d[2] > 0 else -1
    w = [d[0] / abs(d[2]), d[1] / abs(d[2])]
    w2 = [(n1 * u - x / f) / n2 for u, x in zip(w, p)]
    w0 = [u - x / a if a else u for u, x in zip(w, p)]
    w02 = [n1 * u / n2 for u in w0]
    length = size(*w2)
    behind = [u / length for u in w2] + [(-to if mirror else to) / length]
    vergence = 1 / f - (n1 / a if a else 0)
    if a and abs(vergence * f) > N(10) ** -8:
        b = n2 / vergence
        more = n1 * a * (size(*w0) - size(*w)) + n2 * b * (size(*w02) - size(*w2))
    else:
        more = (n2 * dot(p, [s + t for s, t in zip(w2, w02)]) / (size(*w2) + size(*w02))
                - n1 * dot(p, [s + t for s, t in zip(w, w0)]) / (size(*w) + size(*w0)))
    return behind, more


def main():
    text = subprocess.run([sys.argv[1], str(COUNT), SEED], capture_output=True, text=True, check=True).stdout
    print(f'SAGITTA_TEST_SEED={SEED}, {len(text.splitlines())} of {COUNT} cases, by {ORACLE}')
    unit, faults, worst = N(2) ** -53, 0, {'direction': (N(0), ''), 'path': (N(0), '')}
    for line in text.splitlines():
        x = [N(float.fromhex(s)) for s in line.split()]
        n1, n2, mirror, f, a, p, d, got, opl = *x[:5], x[5:7], x[7:10], x[10:13], x[13]
        behind, more = exact(n1, n2, mirror != 0, f, a, p, d)
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
    if not text or len(text.splitlines()) < 0.99 * COUNT:
        sys.exit('FAIL too few cases')
    sys.exit(1 if faults else 0)


if __name__ == '__main__':
    main()
