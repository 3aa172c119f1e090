#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Exact sums, and those of rays, against mpmath with as many bits as the sum has.

    python3 test_sums.py SUMS      which is tests/lens/sums.c; it tries orders and partitions
"""
import fractions
import math
import os
import subprocess
import sys

import mpmath

SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
SETS, PARTITIONS = max(28, int(200 * SCALE)), 100
BITS = 7000  # a product of three doubles has its bits between 2^-3222 and 2^3072


def nearest(sum_):
    """The double nearest to a number of mpmath, ties to even."""
    sign, mantissa, exponent, _ = sum_._mpf_
    exact = fractions.Fraction(-mantissa if sign else mantissa) * fractions.Fraction(2) ** exponent
    try:
        return float(exact)
    except OverflowError:
        return math.inf if exact > 0 else -math.inf


def same(a, b):
    return a == b or (math.isnan(a) and math.isnan(b))


def check_sum(words):
    value, rest = float.fromhex(words[0]), float.fromhex(words[1])
    odd, total = [], mpmath.mpf(0)
    for i in range(2, len(words), 3):
        factors, w, x = int(words[i]), float.fromhex(words[i + 1]), float.fromhex(words[i + 2])
        parts = ([x], [w, x], [w, x, x])[factors - 1]
        if all(map(math.isfinite, parts)):
            total += mpmath.fprod(map(mpmath.mpf, parts))
        else:  # of infinities the product of signs; 0 times one is a NaN
            signs = [p if p == 0 or math.isnan(p) else math.copysign(1, p) for p in parts]
            product = math.prod(signs)
            odd.append(math.nan if product == 0 or math.isnan(product) else math.copysign(math.inf, product))
    expected = sum(odd) if odd else nearest(total)
    assert same(value, expected), (value, expected, words)
    if not odd and math.isfinite(value):
        left = nearest(total - mpmath.mpf(value))
        assert same(rest, left), (rest, left)


def check_spot(words):
    rms_x, rms_y, rms, error = map(float.fromhex, words[:4])
    n = [mpmath.mpf(float.fromhex(w)) for w in words[4:]]
    weight, x, y = n[0::3], [v - mpmath.mpf(1) / 8 for v in n[1::3]], [v + 3 for v in n[2::3]]
    x, y = ([mpmath.mpf(float(v)) for v in values] for values in (x, y))  # as the sums have the distances
    squares = []
    for values, found in ((x, rms_x), (y, rms_y)):
        mean = mpmath.fdot(weight, values) / mpmath.fsum(weight)
        squares.append(mpmath.fdot(weight, [(v - mean) ** 2 for v in values]) / mpmath.fsum(weight))
        assert abs(found - mpmath.sqrt(squares[-1])) < 2 ** -51 * found, found
    assert abs(rms - mpmath.sqrt(sum(squares))) < min(error, 2 ** -51 * rms), rms


def check_wavefront(words):
    mean, rms, error = map(float.fromhex, words[:3])
    n = [mpmath.mpf(float.fromhex(w)) for w in words[3:]]
    weight, values = n[0::2], n[1::2]
    true = mpmath.fdot(weight, values) / mpmath.fsum(weight)
    square = mpmath.fdot(weight, [(v - true) ** 2 for v in values]) / mpmath.fsum(weight)
    assert abs(mean - true) <= 2 ** -52 * abs(true), mean
    assert abs(rms - mpmath.sqrt(square)) < min(error, 2 ** -51 * rms), rms


def main():
    mpmath.mp.prec = BITS
    told = subprocess.run([sys.argv[1], str(SETS), str(PARTITIONS)], capture_output=True, text=True)
    assert told.returncode == 0, told.stdout[-300:]
    lines = told.stdout.splitlines()
    assert len(lines) == SETS + 2
    for line in lines:
        words = line.split()
        kind = {'spot': check_spot, 'wavefront': check_wavefront}.get(words[0])
        if kind:
            kind(words[1:])
        else:
            check_sum(words)
    print(f'{SETS} sets, {SETS * PARTITIONS} partitions and orders')


main()
