#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Numbers as text, both ways, against Python's own, which is correctly rounded.

A ray parallel to the axis meets the plane z = 0 at its own x: so any double but -0 goes in as
text and comes out as text.

    python3 test_numbers.py SAGITTA
"""
import json
import math
import os
import random
from fractions import Fraction

from command import *

SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'))
COUNT = int(4000 * float(os.environ.get('SAGITTA_TEST_SCALE', '0.5')))
print(f'seed {SEED}, {COUNT} of each kind')


def shortest(x):
    """What the csv promises: the shortest of 15, 16, 17 digits that reads back."""
    return next(text for text in ('%.*g' % (digits, x) for digits in (15, 16, 17)) if float(text) == x)


def near(x, draw):
    for _ in range(draw.randint(0, 3)):
        x = math.nextafter(x, draw.choice((0, math.inf)))
    return x


# what may go wrong: ties, powers of two and ten and their neighbours, few digits, the borders
# 1e-38, 1e-6, 1e15 of what goes the short way, 5^27, 2^53 / 10^k, very large and very small
KINDS = {
    'uniform': lambda d: d.uniform(-10, 10),
    'any size': lambda d: d.uniform(-10, 10) * 10.0 ** d.randint(-45, 30),
    'very small or large': lambda d: d.uniform(1, 10) * 10.0 ** d.choice((d.randint(-307, -200), d.randint(90, 120))),
    'few digits': lambda d: float(f'{d.randrange(10 ** d.randint(1, 16))}e{d.randint(-25, 5)}'),
    'binary fractions': lambda d: math.ldexp(d.randrange(2 ** d.randint(1, 53)), -d.randint(0, 140)),
    'halves': lambda d: (d.randrange(10 ** d.randint(1, 9)) + 0.5) / 2 ** d.randint(0, 20),
    'powers of ten': lambda d: near(10.0 ** d.randint(-42, 20), d),
    'powers of two': lambda d: near(2.0 ** d.randint(-140, 60), d),
    'nines': lambda d: near((10 ** d.randint(1, 17) - 1) / 10.0 ** d.randint(0, 22), d),
    '2^53 and a power of ten': lambda d: near(2.0 ** 53 / 10.0 ** d.randint(0, 22), d),
}

SPELLINGS = (repr, '{:.17g}'.format, '{:.17E}'.format, '{:.25e}'.format, '{:.40f}'.format, float.hex,
             lambda x: repr(x).replace('0.', '.', 1) if repr(x).startswith(('0.', '-0.')) else repr(x),
             lambda x: ('' if x < 0 else '+') + repr(x), lambda x: repr(x).replace('e', 'E') + ('' if 'e' in repr(x) else 'e0'))


def shown(values, *more, **how):
    text = rays(*((x, 0, -1, 0, 0, 1) for x in values))
    return run('intersect', '--surface', '{type: plane}', '--rays', '-', *more, stdin=text, **how).stdout


def column(text, name='x'):
    return [row[name] for row in csv.DictReader(io.StringIO(text))]


def test_out():
    for kind, draw_one in KINDS.items():
        draw = random.Random(f'{SEED} {kind}')
        values = [draw.choice((1, -1)) * (draw_one(draw) or 1.0) for _ in range(COUNT)]
        got = column(shown([x.hex() for x in values], '--format', 'csv'))
        equal(len(got), len(values))
        for text, x in zip(got, values):
            equal(text, shortest(x), f'{kind}, {x.hex()}')
        if kind in ('any size', 'nines', 'halves'):
            got = [row['x'] for row in json.loads(shown([x.hex() for x in values], '--format', 'json'))]
            assert got == values, kind
            for text, x in zip(shown([x.hex() for x in values]).splitlines()[1:], values):
                assert text.split()[5] == '%.9g' % x, (text, x)


def test_in():
    for kind, draw_one in KINDS.items():
        draw = random.Random(f'{SEED} in {kind}')
        values, spelled = [], []
        for _ in range(COUNT):
            text = draw.choice(SPELLINGS)(draw.choice((1, -1)) * (draw_one(draw) or 1.0))
            spelled.append(text)
            values.append(float.fromhex(text) if 'x' in text else float(text))
        got = column(shown(spelled, '--format', 'csv', '--hex'))
        for text, x, was in zip(got, values, spelled):
            assert float.fromhex(text) == x, f'{kind}: {was} is {x.hex()}, read as {text}'


def test_half_way():
    """Decimals that lie between two doubles, exactly, and a digit to this side or that."""
    draw = random.Random(SEED)
    spelled, values = [], []
    for _ in range(COUNT):
        low = abs(KINDS['binary fractions'](draw)) or 1.0
        middle = (Fraction(low) + Fraction(math.nextafter(low, math.inf))) / 2
        places = draw.choice((17, 19, 25, 120))
        if draw.random() < 0.5:  # few enough digits to go the short way
            places = draw.randint(1, 2)
            middle = Fraction(2 * draw.randrange(2 ** 52, 2 ** 53) + 1, 2 ** places)
        text = f'{round(middle * 10 ** places) + draw.choice((0, 0, 1, -1))}e-{places}'
        spelled.append(text)
        values.append(float(text))
    for text, x, was in zip(column(shown(spelled, '--format', 'csv', '--hex')), values, spelled):
        assert float.fromhex(text) == x, f'{was} is {x.hex()}, read as {text}'


def test_odd_spellings():
    for text, x in (('0', '0'), ('-0', '0'), ('0e5', '0'), ('.0', '0'), ('00.50', '0.5'), ('5.', '5'), ('+5', '5'),
                    ('1e+2', '100'),
                    ('1E-2', '0.01'), ('0.1e1', '1'), ('0000000000000000000000001', '1'), ('1' + 30 * '0', '1e+30'),
                    ('0.' + 30 * '0' + '1', '1e-31'), ('123456789012345678901234567890e-29', '1.2345678901234567'),
                    ('9007199254740993', '9007199254740992'), ('9007199254740993.0000000000001', '9007199254740994'),
                    ('1e-400', '0'), ('4611686018427387904', '4.611686018427388e+18'), ('0x10', '16')):
        equal(column(shown([text], '--format', 'csv')), [x], text)
    for text in ('', '.', '-', '+', 'e5', '.e5', '1e', '1e+', '1e5.', '1..2', '--1', '+-1', '1 2', '1_0', '1,', '0x', '1f',
                 '1e999', '0xg'):
        done = run('intersect', '--surface', '{type: plane}', '--rays', '-', stdin=rays((f'"{text}"', 0, -1, 0, 0, 1)),
                   exit=BAD_INPUT)
        assert f'ox: "{text}" is not a number' in done.stderr, done.stderr


def test_bounds():
    """t_err has three digits and covers the double's bound and what the decimal of t leaves out."""
    draw = random.Random(SEED)
    text = rays(*((draw.uniform(-2, 2), draw.uniform(-2, 2), -draw.uniform(1, 9) * 10.0 ** draw.randint(-3, 6),
                   draw.uniform(-0.01, 0.01), 0, 1) for _ in range(COUNT)))
    asked = ('intersect', '--surface', '{type: conic, radius: -20, conic: 0.3}', '--rays', '-')
    plain, exact = rows(*asked, stdin=text), rows(*asked, '--hex', stdin=text)
    met = 0
    for p, h in zip(plain, exact):
        if p['status'] != 'hit':
            continue
        met += 1
        t, t_err = float.fromhex(h['t']), float.fromhex(h['t_err'])
        needed = Fraction(t_err) + abs(Fraction(p['t']) - Fraction(t))
        if t_err == 0:
            equal(p['t_err'], '0')
            continue
        assert needed <= Fraction(float(p['t_err'])) <= needed * Fraction('1.0102'), (p, h)
        equal(p['t_err'], shortest(float(p['t_err'])))
        assert len(p['t_err'].split('e')[0].replace('.', '').strip('0')) <= 3 or Fraction(float(p['t_err'])) == needed, p
    assert met > COUNT / 4


main(globals())
