#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The unit of length changes no bit of an analysis: lenses at every power of two.

    python3 tests/lens/test_units.py SAGITTA

All lengths of a lens are multiplied by 2^k; angles, indices and wavelengths stay.  Each column of what info, spot,
fan, opd, field and trace print is then a power of the factor times what it was, the same power in all rows and at
all k: -1 (a power), 0 (an angle, a count, digits) or 1 (a length, waves).  Nothing is rounded by that, so the numbers
are equal to the last bit.  Left out is t_err, which trace prints with three digits, and with the rounding of the t it
prints beside it; tests/catalogue/test_units.cpp compares it.  SAGITTA_TEST_SCALE from 10 on takes every k from -40 to 40.
"""
import csv
import io
import os
import subprocess
import sys
import tempfile


def lenses(k):
    def s(x, power=1):
        return repr(x * 2.0 ** (k * power))

    def many(*x):
        return '[' + ', '.join(s(a, p) for a, p in x) + ']'
    yield 'triplet', f'''
units: mm
wavelengths: [0.4861, 0.5876]
primary: 2
pupil: {{f_number: 2.8}}
fields: [0, 0.7, 1]
surfaces:
  - {{type: sphere, radius: {s(50.098)}, thickness: {s(4.5)}, index: [1.5224, 1.5168], stop: true}}
  - {{type: even_asphere, radius: {s(-983.42)}, coefficients: {many((0.0, -1), (1e-8, -3))}, thickness: {s(0.1)}, index: 1}}
  - {{type: sphere, radius: {s(56.671)}, thickness: {s(4.5)}, index: [1.5224, 1.5168]}}
  - {{type: sphere, radius: {s(-171.15)}, thickness: {s(5.571)}, index: 1, semi_diameter: {s(11.0)}}}
  - {{type: sphere, radius: {s(-97.339)}, thickness: {s(3.5)}, index: [1.7310, 1.7174]}}
  - {{type: sphere, radius: {s(81.454)}, thickness: {s(75.132)}, index: 1}}
  - {{type: plane}}
'''
    yield 'odd asphere', f'''
units: mm
wavelengths: [0.55]
pupil: {{semi_diameter: {s(7.5)}}}
fields: [2, [-3, 2]]
surfaces:
  - {{type: plane, thickness: {s(10.0)}, index: 1, stop: true}}
  - {{type: odd_asphere, radius: {s(56.128)}, coefficients: {many((-0.003142, 0), (0.003867, -1), (-0.0001602, -2))},
     thickness: {s(7.0)}, index: 1.79115}}
  - {{type: sphere, radius: {s(-58.697)}, thickness: {s(30.0)}, index: 1}}
  - {{type: plane}}
'''
    yield 'tilted', f'''
units: mm
wavelengths: [0.55]
pupil: {{semi_diameter: {s(6.0)}}}
fields: [0, 2, [1.5, -1]]
surfaces:
  - {{type: sphere, radius: {s(50.0)}, thickness: {s(5.0)}, index: 1.5, stop: true, decenter: {many((0.3, 1), (-0.2, 1), (0.0, 1))}}}
  - {{type: sphere, radius: {s(-60.0)}, thickness: {s(20.0)}, index: 1}}
  - {{type: plane, tilt: [25, 10, 0], thickness: {s(4.0)}, index: 1.6}}
  - {{type: plane, tilt: [25, 10, 0], thickness: {s(27.0)}, index: 1}}
  - {{type: plane}}
'''
    yield 'relay', f'''
units: mm
wavelengths: [0.4861, 0.5876]
primary: 2
object: {{distance: {s(90.0)}}}
pupil: {{object_na: 0.08}}
aim: stop
field_type: object_height
fields: [[0, 0], [0, {s(6.0)}], {many((4.0, 1), (-3.0, 1))}]
vignetting: [{{}}, {{cy: 0.25}}, {{cx: 0.2, cy: 0.125}}]
surfaces:
  - {{type: conic, radius: {s(60.0)}, conic: -0.7, thickness: {s(8.0)}, index: [1.5224, 1.5168], semi_diameter: {s(16.0)}}}
  - {{type: sphere, radius: {s(-45.0)}, thickness: {s(6.0)}, index: 1}}
  - {{type: plane, thickness: {s(4.0)}, index: 1, stop: true}}
  - {{type: sphere, radius: {s(80.0)}, thickness: {s(5.0)}, index: [1.7435, 1.7283]}}
  - {{type: sphere, radius: {s(200.0)}, thickness: {s(73.0)}, index: [1.337, 1.333]}}
  - {{type: plane}}
'''
    yield 'paraboloid', f'''
units: mm
wavelengths: [0.55, 0.65]
pupil: {{semi_diameter: {s(16.0)}}}
fields: [0, 1, [0.75, -0.5]]
surfaces:
  - {{type: plane, thickness: {s(128.0)}, index: 1, stop: true}}
  - {{type: conic, radius: {s(-256.0)}, conic: -1, mirror: true, thickness: {s(-130.0)}}}
  - {{type: plane}}
'''


ASKED = [['info'], ['spot'], ['fan'], ['opd', '--summary'], ['field'], ['trace', '--chief'], ['trace', '--fan', '7']]


def rows(sagitta, command, text, folder):
    path = os.path.join(folder, 'lens.yaml')
    with open(path, 'w') as file:
        file.write(text)
    done = subprocess.run([sagitta, command[0], path, *command[1:], '--format', 'csv'], text=True, capture_output=True)
    if done.returncode > 1 or not done.stdout:
        sys.exit(f'FAIL {command}: {done.stderr}\n{text}')
    return [row for row in csv.reader(io.StringIO(done.stdout)) if row]


def scaled(a, b, power, k):
    try:
        x, y = float(a), float(b)
    except ValueError:
        return a == b
    return y == x * 2.0 ** (k * power) or (x != x and y != y)


def main():
    sagitta, failures, compared = sys.argv[1], 0, 0
    all_of_them = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5')) >= 10
    powers = [k for k in range(-40, 41) if k] if all_of_them else [1, -3, 40]
    with tempfile.TemporaryDirectory() as folder:
        plain = dict(lenses(0))
        for command in ASKED:
            for name, text in plain.items():
                want = rows(sagitta, command, text, folder)
                fits = {}  # of a column (info: a row) the powers that fit so far
                for k in powers:
                    got = rows(sagitta, command, dict(lenses(k))[name], folder)
                    if len(got) != len(want):
                        failures += 1
                        print(f'FAIL {name}, {command}, 2^{k}: {len(got)} rows, not {len(want)}')
                        continue
                    for i, (a, b) in enumerate(zip(want, got)):
                        for j, (x, y) in enumerate(zip(a, b)):
                            if want[0][j] == 't_err':
                                continue
                            compared += 1
                            key = (a[0], j) if command[0] == 'info' else want[0][j]
                            left = [p for p in fits.get(key, (0, 1, -1)) if scaled(x, y, p, k)]
                            if not left and i:
                                failures += 1
                                print(f'FAIL {name}, {command}, 2^{k}, {key}: {x} became {y}')
                            else:
                                fits[key] = left or (0, 1, -1)
    print(f'{compared} numbers compared, {failures} failures')
    sys.exit(failures != 0)


main()
