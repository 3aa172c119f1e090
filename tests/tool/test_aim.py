#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Rays aimed at the paraxial pupil and at the stop, and fields by real image heights.

    python3 test_aim.py SAGITTA

The oracle: chief rays and rays through the edge of the stop of ten lens files, of every field and wavelength, aimed
and traced at 50 digits (tests/data/zmx/rays.json).
"""
import json
import math

from command import *

ZMX = HERE.parent / 'data' / 'zmx'
POINTS = {'marginal -x': (-1, 0), 'marginal -y': (0, -1), 'chief_real': (0, 0), 'marginal +y': (0, 1),
          'marginal +x': (1, 0)}


def length_of(name, image):
    """Of the lens along its axis, from first vertex to image, by its own YAML."""
    return max(1.0, *(abs(float(r['t'])) for r in rows('trace', ZMX / name, '--fan', 1, '--no-apertures') if int(r['element']) > 1))


def test_examples():
    worst = 0
    for name, example in json.loads((ZMX / 'rays.json').read_text()).items():
        length = None
        got = {}
        for aim, options in (('real', ('--grid', 3)), ('paraxial', ('--fan', 1))):
            for r in rows('trace', ZMX / name, '--wavelength', 'all', '--aim', aim, '--no-apertures', *options, exit=None):
                wave = 1 + example['wavelengths'].index(float(r['wavelength']))
                key = (int(r['field']), wave, aim, float(r['px']), float(r['py']))
                got.setdefault(key, []).append(r)
        length = sum(abs(float(r['t'])) for r in got[1, 1, 'real', 0, 0][1:])
        for field, wave, aim, px, py, sx, sy, *end in example['rays']:
            point = POINTS.get(aim, (0, 0))
            what = (name, field, wave, aim)
            path = got.get((field, wave, 'paraxial' if aim == 'chief_paraxial' else 'real', *map(float, point)))
            assert path, what
            last = path[-1]
            if end[0] == 'tir':
                equal((last['fate'], int(last['element'])), ('tir', end[1]), what)
                continue
            equal((last['fate'], int(last['element'])), ('passed', len(path)), what)
            for key, wanted in zip('xyzlmn', end):
                apart = abs(float(last[key]) - wanted) / (length if key in 'xyz' else 1)
                worst = max(worst, apart)
                assert apart < 1e-10, (what, key, last[key], wanted)
    print(f'       largest difference {worst:.1e} of the length')


def test_a_stop_behind_a_lens():
    """Aimed rays meet the stop where they were sent, unaimed ones beside it; at every wavelength."""
    lens = {'wavelengths': ['F', 'C'], 'pupil': {'semi_diameter': 4}, 'fields': [0, 15], 'surfaces': [
        {'type': 'sphere', 'radius': 50, 'thickness': 6, 'glass': 'N-SF6'}, {'type': 'plane', 'thickness': 12, 'glass': 'air'},
        {'type': 'plane', 'stop': True, 'thickness': 20}, {'type': 'plane'}]}
    path = written(json.dumps(lens))
    radius = json.loads(run('info', path, '--format', 'json').stdout)['stop_radius']
    for r in rows('trace', path, '--aim', 'real', '--hexapolar', 2, '--wavelength', 'all'):
        if r['element'] == '3':
            close(r['x'], float(r['px']) * radius, 1e-13), close(r['y'], float(r['py']) * radius, 1e-13)
    beside = [abs(float(r['y']) - float(r['py']) * radius) for r in rows('trace', path, '--hexapolar', 2) if r['element'] == '3']
    assert max(beside) > 1e-2, max(beside)
    own = written(json.dumps({**lens, 'aim': 'stop'}))
    equal(run('trace', own, '--grid', 5, '--format', 'csv').stdout,
          run('trace', path, '--aim', 'real', '--grid', 5, '--format', 'csv').stdout)
    equal(run('trace', own, '--aim', 'paraxial', '--format', 'csv').stdout, run('trace', path, '--format', 'csv').stdout)


def test_no_such_ray():
    """A stop that no ray of the beam can fill: proven, said, and left out."""
    lens = {'pupil': {'semi_diameter': 9, 'distance': 0}, 'fields': [0], 'surfaces': [
        {'type': 'sphere', 'radius': 10, 'thickness': 12, 'index': 1.9},
        {'type': 'plane', 'thickness': 1, 'stop': True, 'glass': 'same'}, {'type': 'plane'}]}
    lens['surfaces'][1]['draw_to'] = 40
    lens['pupil'] = {'stop_size': True, 'distance': 0}
    done = run('trace', written(json.dumps(lens)), '--aim', 'real', '--fan', 3, '--format', 'csv', exit=None)
    assert 'of 3 rays are not there' in done.stderr, done.stderr
    equal([r['ray'] for r in csv.DictReader(io.StringIO(done.stdout))], ['1'] * 3)


def test_usage():
    run('trace', LENSES / 'ftheta.yaml', '--aim', 'there', exit=USAGE)


main(globals())
