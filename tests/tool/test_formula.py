#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Formulas through the command: hits in closed form, a sag beside the built-in one, what is said of bad texts.

    python3 test_formula.py SAGITTA
"""
import math
import random

from command import *

SEED = int(os.environ.get('SAGITTA_TEST_SEED', 20261123))
print(f'       seed {SEED}')


def formula(words):
    return f'{{type: formula, {words}}}'


def refused(words):
    """What is said of a surface that cannot be read."""
    return run('intersect', '--surface', formula(words), '--ray', '0 0 -3 0 0 1', exit=BAD_INPUT).stderr


def test_closed_form():
    """On a ray along z, z^4 = a - x^4 - y^4: two hits, or none."""
    draw = random.Random(SEED)
    places = [(draw.uniform(-1.2, 1.2), draw.uniform(-1.2, 1.2)) for _ in range(300)]
    for a in (1, 0.3):
        found = rows('intersect', '--surface', formula(f'f: "x^4 + y^4 + z^4 = a", a: {a}, inside: {{ball: 2}}'), '--all',
                     '--proof', 'first', '--rays', '-', stdin=rays(*[(x, y, -3, 0, 0, 1) for x, y in places]))
        hits = 0
        for i, (x, y) in enumerate(places):
            mine, z4 = [row for row in found if row['ray'] == str(i)], a - x ** 4 - y ** 4
            if z4 < 0:
                equal([row['status'] for row in mine], ['miss'], (x, y))
                continue
            z = z4 ** 0.25
            equal([row['status'] for row in mine], ['hit', 'hit'], (x, y))
            for row, t in zip(mine, (3 - z, 3 + z)):
                close(row['t'], t, float(row['t_err']) + 1e-15 * (3 + 1 / max(z, 1e-6) ** 3), (x, y))
                hits += 1
        assert 100 < hits < 600, hits


def test_inside():
    """A ball or a box cuts the surface, and both do."""
    for inside, wanted in (('{ball: 1.1}', 2), ('{box: [2, 2, 0.5]}', 0), ('{box: [[-2, -2, 0], [2, 2, 2]]}', 1),
                           ('{ball: 0.9}', 0), ('{ball: 2, box: [2, 2, 2]}', 2)):
        found = rows('intersect', '--surface', formula(f'f: "x^2 + y^2 + z^2 = 1", inside: {inside}'), '--all',
                     '--ray', '0.1 0.2 -3 0 0 1')
        equal(sum(row['status'] == 'hit' for row in found), wanted, inside)


def test_a_sag_is_the_built_in_one():
    """The same lens, its second face a formula: points and paths agree within what rounding does."""
    lens = '''pupil: {{semi_diameter: 6}}
surfaces:
  - {{type: plane, thickness: 10, stop: true, semi_diameter: 6}}
  - {{{}, thickness: 4, index: 1.5168, semi_diameter: 8}}
  - {{type: plane, thickness: 90, index: 1}}
  - {{type: plane}}
'''
    asphere = 'type: even_asphere, radius: 51.68, conic: -0.6, coefficients: [0, 1.0e-6]'
    sag = 'type: formula, sag: "r^2/R/(1 + sqrt(1 - (1 + k)*r^2/R^2)) + a*r^4", R: 51.68, k: -0.6, a: 1.0e-6'
    found = [rows('trace', written(lens.format(face)), '--field', 4, '--grid', 9) for face in (asphere, sag)]
    assert len(found[0]) == len(found[1]) > 100
    for one, other in zip(*found):
        equal(one['fate'], 'passed')
        equal(other['fate'], 'passed')
        for key in 'xyzlmn':
            close(one[key], other[key], 1e-12, key)
        close(one['opl'], other['opl'], 1e-11)


def test_undecided_with_a_reason():
    """At a cut, a pole and a double root there is no hit, and what may be there is told."""
    for words, ray, reason in (
            ('f: "atan2(y, x) = 1.7*z", inside: {ball: 2}', '-1 -3 0.2 0 1 0', 'F may end, jump'),
            ('f: "y = tan(2*x)", inside: {ball: 2}', '0.4 0.1 0 1 0 0 0 0.8', 'F may end, jump'),
            ('f: "(x^2 + y^2 + z^2 - 1)^2", inside: {ball: 2}', '0 0 -3 0 0 1', 'rounding hides which'),
            ('f: "z^2 = x^2 + y^2", inside: {ball: 2}', '-3 0 0 1 0 0', 'rounding hides which')):
        for proof in ((), ('--proof', 'first')):
            said = run('intersect', '--surface', formula(words), '--ray', ray, *proof, exit=UNDECIDED).stdout
            assert 'unproven' in said and reason in said, said


def test_a_pole_that_is_a_number():
    found = rows('intersect', '--surface', formula('f: "1/x = y", inside: {ball: 3}'), '--all', '--ray', '-3 -1 0 1 0 0')
    equal([row['status'] for row in found], ['hit'])
    close(found[0]['t'], 2, 1e-15)


def test_bad_texts():
    for words, said in (
            ('f: "2x + y = z"', 'f: column 2: expected an operator before x'), ('f: "x**2 + y"', 'f: column 2: a power is written with ^'),
            ('f: "ln(x) + y"', 'write log(u)'), ('f: "X^2 + y"', 'write x'), ('f: "x^2 + (y^2"', 'f: column 11: expected )'),
            ('f: "x = y = z"', 'column 7'), ('f: "1/0*x"', 'not defined'), ('f: "3"', 'the same everywhere'), ('f: ""', 'no formula'),
            ('f: "x^2 + a*y"', 'a is not known; there are x, y, z, r, pi; a parameter is a key beside f, as in a: 1'),
            ('f: "x", a: 3', 'a: the formula does not name it'), ('f: "x*pi", pi: 3', 'a meaning of its own'),
            ('f: "x*name", name: 3', 'name: is a key of lens files'), ('sag: "z + x"', 'sag: column 1: a sag has no z'),
            ('sag: "x = 2"', 'a sag has no ='), ('f: "x", sag: "x"', 'given beside f'), ('sag: "x", inside: {ball: 1}', 'is for f'),
            ('f: "x", semi_diameter: 1', 'is for a sag'), ('f: "x", inside: {ball: -1}', 'must be above 0'),
            ('f: "x", inside: {cone: 1}', 'must have a ball or a box'), ('f: "x", inside: {box: [1, 0, 1]}', 'larger than 0'),
            ('f: "x - a", a: .nan', 'a'), ('thickness: 1', 'missing; give f')):
        text = refused(words)
        assert said in text and '--surface:1' in text and text.count('\n') == 1, (words, text)


main(globals())
