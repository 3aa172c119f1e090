#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Phases of lens files, through the command.

    python3 test_phases.py SAGITTA

What a phase does is known in closed form: a plane grating turns a ray by the grating equation, a phase of a perfect
lens has no path differences, a hologram images one of its points onto the other.  Some numbers are those that other
programs printed (said beside them).  The forms of tests/data/zmx and those of test_zmx.py are traced at 50 digits there.
"""
import json
import math
import os
import pathlib
import random
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / 'tool'))
from command import *  # noqa: E402

SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'), 0)
SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
PHASES, HYBRID = HERE.parent / 'data' / 'phases.yaml', LENSES / 'hybrid_achromat.yaml'
os.environ['SAGITTA_GLASS'] = str(HERE.parents[1] / 'data' / 'glass')


def lens(*surfaces, waves=(0.55,), **more):
    return written(json.dumps({'units': 'mm', 'wavelengths': list(waves), 'primary': 1, 'pupil': {'semi_diameter': 5},
                               'surfaces': list(surfaces), **more}))


def plane(**more):
    return {'type': 'plane', **more}


def traced(path, *launch, more=()):
    """The rows of the last element that each ray reached."""
    out = {}
    for row in rows('trace', path, '--rays', '-', *more, stdin=rays(*launch)):
        out[int(row['ray'])] = row
    return [out[i] for i in range(len(launch))]


def close_to(row, columns, wanted, tolerance=1e-13):
    for column, value in zip(columns, wanted):
        assert abs(float(row[column]) - value) <= tolerance * max(1, abs(value)), f'{column}: {row}, not {wanted}'


def test_the_grating_equation():
    """On a plane the part along it grows by order * wavelength * lines, whatever the medium, by either way through."""
    u = random.Random(f'{SEED} gratings').uniform
    for trial in range(40):
        lines, order, turn, um, index = u(1, 900), random.Random(trial).choice((-2, -1, 1, 2, 3)), u(-180, 180), u(0.4, 0.8), u(1, 1.8)
        mirror = trial % 3 == 0
        glass = {'mirror': True} if mirror else {'index': index}
        path = lens(plane(thickness=0, phase={'lines': lines, 'order': order, 'turn': turn}, **glass), plane(), waves=(um,))
        o, d = (u(-1, 1), u(-1, 1), -2.0), (u(-0.4, 0.4), u(-0.4, 0.4), 1.0)
        size = math.hypot(*d)
        n = 1 if mirror else index
        l, m = ((d[i] / size + order * um * 1e-3 * lines * part) / n
                for i, part in ((0, -math.sin(math.radians(turn))), (1, math.cos(math.radians(turn)))))
        row = [r for r in rows('trace', path, '--rays', '-', stdin=rays((*o, *d))) if r['element'] == '1'][0]
        if l * l + m * m >= 1:
            equal(row['fate'], 'evanescent')
            continue
        close_to(row, 'lmn', (l, m, math.sqrt(1 - l * l - m * m) * (-1 if mirror else 1)), 1e-12)


def test_kinks():
    """At a kink, and within rounding of it, the told error reaches both sides; next to it, it is small again.  A
    phase or a sag with a kink at the vertex has no first-order data."""
    for text, at, low, high in (
            ('100*abs(y)', 0.0, -100, 100), ('100*abs(y - 2.5)', 2.5, -100, 100), ('80*max(y, 0)', 0.0, 0, 80),
            ('60*min(2*y, y)', 0.0, 60, 120), ('50*sqrt(y^2)', 0.0, -50, 50), ('100*max(abs(y), abs(y)/2)', 0.0, -100, 100),
            ('90*abs(abs(y) - 2.5)', 2.5, -90, 90), ('70*hypot(y, 0)', 0.0, -70, 70), ('100*abs(y - x)', 0.0, -100, 100)):
        path = lens(plane(thickness=50, phase=text), plane(), waves=(0.5,))
        apart = 50 * abs(math.tan(math.asin(high * 5e-4)) - math.tan(math.asin(low * 5e-4)))
        ends = {float(r['py']): r for r in rows('ends', path, '--grid', '5') if float(r['px']) == 0}
        told = float(ends[at / 5]['xy_err'])
        assert told >= apart, f'{text}: told {told}, the sides are {apart} apart'
        if text not in ('100*abs(y - x)', '90*abs(abs(y) - 2.5)'):  # others of these rays are at a kink, too
            assert all(float(r['xy_err']) < 1e-11 for py, r in ends.items() if py != at / 5), (text, ends)
        if at == 0 and 'x' not in text.replace('max', ''):
            equal(rows('info', path)[0]['efl'], 'nan', text)
    smooth = lens(plane(thickness=50, phase='100*y + 3*abs(y)^3 - 0.2*y^2'), plane())
    assert math.isfinite(float(rows("info", smooth)[0]["efl"])), "no kink"
    ridge = {'type': 'formula', 'sag': '0.1*abs(y)', 'thickness': 50, 'index': 1.5}
    at, beside = (float(r['xy_err']) for r in rows('ends', lens(ridge, plane()), '--grid', '5')
                  if float(r['px']) == 0 and float(r['py']) in (0, 0.5))
    assert at > 1 > 1e-11 > beside, (at, beside)


def test_numbers_of_other_programs():
    """OpticStudio's, in public files: a grating, a Zernike phase before an ideal lens, a hologram."""
    path = lens(plane(thickness=20, phase={'lines': 250}), plane(), waves=(0.9,))
    row, = traced(path, (0, 0, -1, 0, 0, 1))
    close_to(row, 'y', (4.618422,), 1e-6)
    fifth, = traced(path, (0, 0, -1, 0, 0, 1), more=('--set', 'surfaces[1].phase.order=5'))
    equal((fifth['fate'], fifth['element']), ('evanescent', '1'))
    zernike = {'type': 'zernike', 'norm': 4, 'order': 'fringe', 'coefficients': [-2, 0, 0, -3, 0, 0, 0, 0, -1]}
    row, = traced(lens(plane(thickness=0, phase={'waves': zernike}), {'type': 'ideal', 'focal_length': 100, 'thickness': 100}, plane()),
                  (0, 2, -1, 0, 0, 1))
    close_to(row, 'y', (-0.0412500035,), 1e-9)
    points = {'wavelength': 0.55, 'converges': True}
    row, = traced(lens(plane(thickness=100, phase={'points': [[0, 0, -200], [0, 0, 100]], **points}), plane()),
                  (0, 10, -200, 0, 15, 200))
    close_to(row, 'y', (-5.505476815018,), 1e-12)
    row, = traced(lens(plane(thickness=-200, mirror=True, phase={'points': [[0, 0, -100], [0, 0, -200]], **points}), plane()),
                  (0, 10, -100, 0, 15, 100))
    assert float(row['n']) < 0
    compressor, = traced(lens(plane(thickness=-1, mirror=True, phase={'lines': 1740}), plane(), waves=(1.03,)),
                         (0, 0, -1, 0, -math.sin(math.radians(59.1)), math.cos(math.radians(59.1))))
    close_to(compressor, 'm', (0.934135,), 1e-6)


def test_perfect_lenses():
    """No path differences: S = f - sqrt(f^2 + r^2) from afar; on a curved surface of glass, too, where
    S = C - n' |Q - F| - n z has the rays go to F; a hologram from one of its points to the other."""
    afar = lens(plane(thickness=40, phase={'waves': '(f - sqrt(f^2 + r^2))/L', 'f': 40, 'L': 0.55e-3}), plane())
    curved = lens({'type': 'sphere', 'radius': 30, 'thickness': 40, 'index': 1.5,
                   'phase': {'waves': '(40*1.5 - 1.5*sqrt(r^2 + (40 - z)^2) - z)/L', 'L': 0.55e-3}}, plane())
    hologram = lens(plane(thickness=100, phase={'points': [[0, 0, -60], [0, 0, 100]], 'wavelength': 0.55, 'converges': True}),
                    plane(), object={'distance': 60})
    for path in (afar, curved, hologram):
        for row in rows('opd', path, '--grid', 7):
            equal(row['fate'], 'passed')
            assert abs(float(row['opd'])) <= float(row['opd_err']) < 1e-7, row
        row = rows('spot', path)[0]
        assert float(row['geometric']) < 1e-12, row


def test_a_spectrometer():
    """Behind a grating the axis is a break; each wavelength has its place, f tan of the angle to the primary's.  The
    stop is behind the grating, and rays are aimed at it."""
    first = math.asin(0.55e-3 * 600)
    path = lens(plane(thickness=0, phase={'lines': 600}), {'type': 'break', 'tilt': [-math.degrees(first), 0, 0], 'thickness': 20},
                {'type': 'ideal', 'focal_length': 100, 'thickness': 100, 'stop': True, 'semi_diameter': 8}, plane(),
                waves=(0.55, 0.5, 0.6), aim='real_stop')
    for row in rows('fan', path):
        y = 100 * math.tan(first - math.asin(float(row['wavelength']) * 0.6))
        equal(row['fate'], 'passed')
        assert abs(-float(row['ey']) - y) < 1e-12 and abs(float(row['ex'])) < 1e-12, (row, y)
    for row in rows('opd', path, '--summary'):
        assert float(row['pv']) < 1e-8, row
    row, = rows('info', path, '--parabasal')
    close_to(row, ('efl_x', 'efl_y'), (100, 100 / math.cos(first)), 1e-12)


def test_wavelengths():
    """The focal length is f L0 / L, at wavelengths of the file and at others; the power of a grating is 0."""
    path = lens(plane(thickness=40, phase={'waves': {'type': 'even_asphere', 'coefficients': [-20]}}), plane(), waves=(0.5, 0.6))
    for um in (0.5, 0.6, 0.55, 0.4321):
        said = json.loads(run('info', path, '--wavelength', um, '--format', 'json').stdout)
        text = json.dumps(said)
        efl = float(re.search(r'"efl": ([-0-9.e]+)', text)[1])
        assert abs(efl - 1 / (2 * 20 * um * 1e-3)) < 1e-12 * efl, (um, efl)
        row = [r for r in rows('trace', path, '--wavelength', um, '--rays', '-', stdin=rays((0, 0.25, -1, 0, 0, 1)))][0]
        close_to(row, 'm', (-2 * 20 * 0.25 * um * 1e-3,), 1e-14)
    said = run('info', lens(plane(thickness=40, phase='600*y'), plane())).stdout
    assert re.search(r'^efl +- ', said, re.M), said


def test_solves_and_pickups():
    """A solve sees the power; a pickup reaches into a phase, and so does --set."""
    path = lens(plane(thickness={'solve': 'paraxial_focus'}, phase={'waves': {'type': 'even_asphere', 'coefficients': [-20]}}),
                plane(thickness=1, phase={'lines': {'pickup': 'surfaces[1].phase.waves.coefficients[1]', 'scale': -2}}), plane())
    row = rows('trace', path, '--rays', '-', stdin=rays((0, 0, -1, 0, 0, 1)))
    close_to(row[1], 't', (1 / (2 * 20 * 0.55e-3),), 1e-13)
    close_to(row[1], 'm', (40 * 0.55e-3,), 1e-13)
    row = rows('trace', path, '--rays', '-', '--set', 'surfaces[2].phase.order=-2', stdin=rays((0, 0, -1, 0, 0, 1)))
    close_to(row[1], 'm', (-2 * 40 * 0.55e-3,), 1e-13)


def test_scaled_and_reversed():
    """Scaled by 2, rays at twice the place have the same directions and twice the paths.  Reversed twice it is as it
    was; light through a reversed part and back is where it came from."""
    text = PHASES.read_text().replace('"-2*r^2 + 3*x*y"', '{waves: {type: polynomial_xy, coefficients: [[0, 0, -2], [0, 3], [-2]]}}')
    text = text.replace('{waves: "a*x^2 + b*z", a: -1.5, b: 0.25, order: -1}', '{lines: 3, order: -1}')
    path, twice = written(text), written('')
    run('edit', path, '--scale', 2, '-o', twice)
    launch = [(0.1 * i, 0.2 * i - 0.5, -1, 0.01 * i, -0.02, 1) for i in range(7)]
    for one, two in zip(traced(path, *launch), traced(twice, *([2 * a for a in r[:3]] + list(r[3:]) for r in launch))):
        equal((one['fate'], two['fate']), ('passed', 'passed'))
        close_to(two, ('x', 'y', 'z', 'opl'), [2 * float(one[c]) for c in ('x', 'y', 'z', 'opl')], 1e-13)
        close_to(two, 'lmn', [float(one[c]) for c in 'lmn'], 1e-13)
    once, again = written(''), written('')
    run('edit', path, '--reverse', '2,5', '-o', once)
    run('edit', once, '--reverse', '2,5', '-o', again)
    for one, two in zip(traced(path, *launch), traced(again, *launch)):
        equal([one[c] for c in 'xyzlmn'], [two[c] for c in 'xyzlmn'])


def test_numbers_in_files():
    """No edit changes numbers that stand in a file, wherever a surface has them: it says so.  In place they are scaled."""
    height = [[i * i + j * j for j in range(5)] for i in range(5)]
    for name, type, numbers in (('sag', {'type': 'grid', 'step_x': 1, 'step_y': 1}, height),
                                ('coefficients', {'type': 'polynomial_xy'}, [[0, 1, 2], [3, 1, 1]])):
        table = written('\n'.join(','.join(map(str, row)) for row in numbers) + '\n')
        file = table.with_name(f'{table.name}.csv')
        table.rename(file)
        for inside in (lambda s: {**s, 'thickness': 1}, lambda s: plane(thickness=1, phase={'waves': s}),
                       lambda s: {'type': 'sum', 'terms': [{'type': 'even_asphere'}, s], 'thickness': 1},
                       lambda s: plane(thickness=1, phase={'waves': {'type': 'sum', 'terms': [{'type': 'even_asphere'}, s]}})):
            path = lens(inside({**type, name: str(file)}), plane())
            run('info', path)
            said = run('edit', path, '--scale', 2, exit=BAD_INPUT).stderr
            assert f'{path}:1: the numbers of {name} stand in a file, {str(file)[:200]}, ' in said, said
            assert said.count('\n') == 1, said
            run('edit', lens(inside({**type, name: numbers}), plane()), '--scale', 2)


def test_what_is_refused():
    for phase, words in (
            ({}, 'one of waves, lines and points'), ({'lines': 3, 'waves': 'y'}, 'one of waves, lines and points'),
            ('y +', 'column 4'), ({'waves': 'a*y'}, 'a is not known'), ({'waves': 'y', 'b': 1}, 'does not name it'),
            ({'waves': {'type': 'torus', 'major': 3, 'minor': 1}}, 'no sag'), ({'waves': {'type': 'no_such'}}, 'no surface is called'),
            ({'waves': {'type': 'even_asphere', 'coefficients': [1], 'semi_diameter': 3}}, 'unknown key'),
            (600, '{lines: 600}'), ('1.5e3', '{lines: 1.5e3}'), ('-2', '{lines: -2}'), (None, 'a formula of x, y, r or z, or a map'),
            ({'waves': 3}, 'same everywhere'), ({'waves': 'a*pi', 'a': 2}, 'same everywhere'), ('exp(2)', 'same everywhere'),
            ({'lines': 600, 'wavelength': 0.5}, 'wavelength: belongs to `points`'), ({'waves': 'y', 'turn': 3}, 'does not name it'),
            ({'points': [[0, 0, 1], [0, 0, 2]], 'wavelength': 1, 'turn': 3}, 'turn: belongs to `lines`'),
            ({'lines': 600, 'order': 1.5}, 'order: must be a whole number, not 1.5'), ({'lines': 600, 'order': 1e-9}, 'whole number'),
            ({'lines': 'x'}, 'number'), ({'lines': 3, 'order': 'x'}, 'number'), ({'lines': 3, 'converges': True}, 'converges'),
            ({'points': [[0, 0, 1]], 'wavelength': 0.5}, 'two points'), ({'points': [[0, 0, 1], [0, 0, 2]]}, 'wavelength'),
            ({'points': [[0, 0, 0], [0, 0, 2]], 'wavelength': 0.5}, 'vertex'), ({'lines': 0}, 'lines: must not be zero'),
            ({'points': [[0, 3, 2], [0, 3, 2]], 'wavelength': 0.5}, 'one point'),
            ({'points': [[0, 0, 1], [0, 0, 2]], 'wavelength': -1}, 'positive')):
        done = run('info', lens(plane(thickness=1, phase=phase), plane()), exit=BAD_INPUT)
        assert words in done.stderr and done.stderr.count('\n') == 1, (phase, done.stderr)
    path = lens({'type': 'ideal', 'focal_length': 10, 'thickness': 10, 'phase': 'y'}, plane())
    assert 'no other phase' in run('info', path, exit=BAD_INPUT).stderr
    text = lens(plane(thickness=1, phase='y'), plane()).read_text()
    for missing, words in (('"units": "mm", ', 'units: must be'), ('"wavelengths": [0.55], "primary": 1, ', 'wavelengths: missing')):
        assert missing in text
        assert words in run('info', written(text.replace(missing, '')), exit=BAD_INPUT).stderr
    for edit in (('--scale', 2), ('--reverse', '1,1')):
        path = lens(plane(thickness=1, phase='y*z'), plane(thickness=1), plane())
        assert 'phase that is a formula' in run('edit', path, *edit, exit=BAD_INPUT).stderr


HOSTILE = ('0', '-0.0', '-1', '1.5', '.nan', '.inf', '-.inf', '1e999', '1e308', '-1e308', '1e-320', '1e17', "''", '~', 'true', '[]', '{}',
           '[1]', '[[1]]', '"x"', '1_0', '1 2')


def test_hostile_numbers():
    """Each key of a phase with each kind of wrong value: an error that names file, line and key, or a lens whose rays have
    a fate.  What is taken is listed."""
    numbers = {'-1', '1.5', '1e308', '-1e308', '1e-320', '1e17'}
    whole, any_number = {'0', '-0.0', '-1', '1e17', '1e308', '-1e308'}, numbers | {'0', '-0.0'}
    length = {'-1', '1.5', '1e17'}
    apart = length | {'.inf', '-.inf'}
    point = any_number
    ideal = '{type: ideal, focal_length: 50, %s, thickness: 50}'
    taken = {
        ('lines', '{type: plane, thickness: 1, phase: {lines: %s}}'): numbers,
        ('turn', '{type: plane, thickness: 1, phase: {lines: 600, turn: %s}}'): any_number,
        ('order', '{type: plane, thickness: 1, phase: {lines: 600, order: %s}}'): whole,
        ('wavelength', '{type: plane, thickness: 1, phase: {points: [[0, 0, -20], [0, 0, 10]], wavelength: %s}}'):
            {'1.5', '1e308', '1e17'},
        ('points', '{type: plane, thickness: 1, phase: {points: [[0, 3, %s], [0, 0, 10]], wavelength: 0.5}}'): point,
        ('converges', '{type: plane, thickness: 1, phase: {points: [[0, 0, -20], [0, 0, 10]], wavelength: 0.5, converges: %s}}'):
            {'true'},
        ('a', '{type: plane, thickness: 1, phase: {waves: "a*y", a: %s}}'): any_number,
        ('coefficients', '{type: plane, thickness: 1, phase: {waves: {type: even_asphere, coefficients: [%s]}}}'): any_number,
        ('radius', '{type: plane, thickness: 1, index: 1.5, facets: {type: sphere, radius: %s}}'): numbers - {'1e-320'} | {'.inf', '-.inf'},
        ('focal_length', '{type: ideal, focal_length: %s, thickness: 50}'): length,
        ('focal_length', '{type: ideal, focal_length: %s, focal_length_y: 20, thickness: 50}'): apart,
        ('focal_length_y', ideal % 'focal_length_y: %s'): apart,
        ('object_distance', ideal % 'object_distance: %s'): apart}
    faults = []
    for (key, surface), wanted in taken.items():
        got = set()
        for value in HOSTILE:
            path = written('units: mm\nwavelengths: [0.5]\npupil: {semi_diameter: 2}\nsurfaces:\n  - ' + surface % value +
                           '\n  - {type: plane}\n')
            done = subprocess.run([SAGITTA, 'trace', path, '--fan', '3', '--format', 'csv'], capture_output=True, text=True, timeout=60)
            assert done.returncode in (DECIDED, UNDECIDED, BAD_INPUT), (surface % value, done.returncode, done.stderr)
            if done.returncode == BAD_INPUT:
                last = done.stderr.rstrip('\n').splitlines()[-1]
                assert re.search(re.escape(f'{path}:5: ') + rf'(surfaces\[1\]\.)?[\w.]*{key}', last), (surface % value, last)
            else:
                got.add(value)
        faults += [f'{surface}: takes {sorted(got - wanted)}, not {sorted(wanted - got)}'] if got != wanted else []
    assert not faults, '\n'.join(faults)


def test_order_0_is_no_phase():
    """Total reflection is told as such, and W is not asked, not even where it is no number.  The file keeps its phase."""
    def surfaces(phase):
        return lens({'type': 'sphere', 'radius': 7, 'thickness': 3, 'index': 1, **phase}, plane(thickness=1),
                    object={'index': 1.7})
    bare = surfaces({})
    fates = {row['fate'] for row in rows('ends', bare, '--grid', 9)}
    assert {'tir', 'passed'} <= fates, fates
    for waves in ({'lines': 600}, {'waves': 'sqrt(-1 - r^2)'}, {'waves': {'type': 'even_asphere', 'coefficients': [-3]}},
                  {'points': [[0, 0, -60], [0, 0, 100]], 'wavelength': 0.55}):
        path, kept = surfaces({'phase': {**waves, 'order': 0}}), written('')
        for command in (('ends', '--grid', 9), ('opd', '--grid', 9), ('ends', '--grid', 9, '--wavelength', 0.6)):
            equal(run(command[0], path, *command[1:], '--format', 'csv').stdout,
                  run(command[0], bare, *command[1:], '--format', 'csv').stdout, (waves, command))
        run('edit', path, '--set', 'surfaces[1].phase.order=1', '-o', kept)
        fate = UNDECIDED if 'sqrt' in str(waves) else DECIDED
        equal(run('ends', kept, '--format', 'csv', exit=fate).stdout,
              run('ends', surfaces({'phase': waves}), '--format', 'csv', exit=fate).stdout)


def test_evanescent():
    """Told everywhere: by trace, by each count, and by diagnose with the orders that pass."""
    path = lens(plane(thickness=20, phase={'lines': 250, 'order': 5}, stop=True), plane(), waves=(0.9,))
    said = run('trace', path).stdout
    assert re.search(r'^element 1 \(plane\): \d+ evanescent', said, re.M), said
    assert 'evanescent: its phase asks for 1.125' in said, said
    for row in rows('sweep', path, '--steps', 2):
        equal((row['evanescent'], row['passed']), (row['rays'], '0'))
    equal({r['fate'] for r in rows('map', path)}, {'evanescent'})
    told = run('diagnose', path, '--ray', 0).stdout
    assert 'Of the orders, -4 to 4 pass; it is 5.' in told, told


def test_broken_texts():
    """Each prefix of a lens with phases, and noise in it: read, or one clear error."""
    generator = random.Random(f'{SEED} broken')
    text = PHASES.read_text()
    texts = [text[:i] for i in range(0, len(text), max(1, round(6 / SCALE)))]
    words = ['', '0', '-1', 'nan', '.inf', '1e999', '[]', '{}', '[1, 2]', '{a: 1}', '"x"', 'true', '~', '1e-320', 'z', '"r^"']
    for _ in range(round(200 * SCALE)):
        at = generator.choice(list(re.finditer(r'[-\w.]+', text)))
        texts.append(text[:at.start()] + generator.choice(words) + text[at.end():])
    read = 0
    for broken in texts:
        path = written(broken)
        done = subprocess.run([SAGITTA, 'info', path], capture_output=True, text=True, timeout=100)
        assert done.returncode in (DECIDED, BAD_INPUT), (done.returncode, done.stderr[-500:], broken)
        read += done.returncode == DECIDED
        if done.returncode == BAD_INPUT:
            last = done.stderr.rstrip('\n').splitlines()[-1]
            assert str(path) in last and len(last) < 1500, last
    assert read


if __name__ == '__main__':
    print(f'SAGITTA_TEST_SEED={SEED}')
    main(globals())
