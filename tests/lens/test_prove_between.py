#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sagitta prove --fields all, --wavelengths all: no ray of any field and wavelength between leaves a bound; and
--proof all, which holds a sample of rays against the proof.

    python3 test_prove_between.py SAGITTA [--without-cairo]

Fields, wavelengths and points of the pupil are random.  The rays are those of `sagitta fan` and `sagitta opd`, which
know nothing of boxes.
"""
import math
import pathlib
import random
import shlex
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / 'tool'))
from command import *

SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'), 0)
SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
TRIPLET, HYBRID, ZONE = LENSES / 'cooke_triplet.yaml', LENSES / 'hybrid_achromat.yaml', LENSES.parent / 'prove' / 'steep_zone.yaml'
BROKEN = 4
BOXES = 100  # bounds must hold for any number
# Fields that span a triangle and a square; glasses by formulas, a phase, a mirror, a tilt; from afar and from near.
AFAR = '''
units: mm
wavelengths: [0.4861, 0.5876, 0.6563]
primary: 2
pupil: {semi_diameter: 6}
fields: [[0, 0], [4, 0], [2, 5], [1, 1]]
surfaces:
  - {type: sphere, radius: 61, thickness: 6, glass: N-BK7, semi_diameter: 9}
  - {type: sphere, radius: -44, thickness: 2.5, glass: N-SF5, semi_diameter: 9}
  - {type: even_asphere, radius: -129, coefficients: [0, 1.0e-7], thickness: 30, glass: air, semi_diameter: 9, stop: true}
  - {type: plane, tilt: [3, 0, 0], thickness: 65, semi_diameter: 30}
  - {type: plane}
'''
NEAR = '''
units: mm
wavelengths: [0.45, 0.65]
object: {distance: 120}
pupil: {semi_diameter: 5}
field_type: object_height
fields: [[-3, -3], [3, -3], [3, 3], [-3, 3]]
surfaces:
  - {type: sphere, radius: 60, thickness: 5, glass: {nd: 1.6, vd: 50}, semi_diameter: 8, stop: true}
  - {type: sphere, radius: -60, thickness: 90, glass: air, semi_diameter: 8}
  - {type: sphere, radius: -400, thickness: -40, mirror: true}
  - {type: plane}
'''
TELECENTRIC = '''
units: mm
wavelengths: [0.5, 0.6]
object: {distance: 50, telecentric: true}
pupil: {object_na: 0.05}
field_type: object_height
fields: [0, 2, 4]
surfaces:
  - {type: sphere, radius: 60, thickness: 5, glass: {sellmeier: [1.04, 0.006, 0.23, 0.02]}, semi_diameter: 12}
  - {type: sphere, radius: -60, thickness: 45, glass: air, semi_diameter: 12}
  - {type: plane}
'''
AFOCAL = '''
units: mm
afocal: true
wavelengths: [0.5, 0.6]
pupil: {semi_diameter: 4}
fields: [0, 1.5]
surfaces:
  - {type: sphere, radius: 50, thickness: 4, glass: {nd: 1.5168, vd: 64.2}, semi_diameter: 8}
  - {type: plane, thickness: 121.3, glass: air, semi_diameter: 8}
  - {type: plane, thickness: 3, glass: {nd: 1.5168, vd: 64.2}, semi_diameter: 8}
  - {type: sphere, radius: -25, thickness: 5, glass: air, semi_diameter: 8}
  - {type: plane}
'''
HOLES = '''
units: mm
wavelengths: [0.5]
pupil: {semi_diameter: 5}
fields: [0, 25, 10]
surfaces:
  - {type: plane, stop: true, semi_diameter: 5.5, thickness: 10}
  - {type: plane, semi_diameter: 60, thickness: 10, index: 1}
  - {type: plane}
'''


def any_end(*arguments):
    """As run, whatever its exit status."""
    return subprocess.run([str(a) for a in (SAGITTA, *arguments)], capture_output=True, text=True, check=False)


def between(lens, *options, exit=None):
    return rows('prove', lens, '--fields', 'all', '--wavelengths', 'all', *options, exit=exit)


def fields_of(lens):
    """Points of the fields as the bounds have them: slopes from afar, else points of the object; and how to say one."""
    given = {AFAR: [(0, 0), (4, 0), (2, 5), (1, 1)], NEAR: [(-3, -3), (3, -3), (3, 3), (-3, 3)], TELECENTRIC: [(0, 0), (0, 4)],
             AFOCAL: [(0, 0), (0, 1.5)], TRIPLET: [(0, 0), (0, 20)], HYBRID: [(0, 0), (0, 1)]}[lens]
    if lens in (NEAR, TELECENTRIC):
        return given, lambda x, y: f'{x!r} {y!r} object_height'
    slopes = [tuple(math.tan(math.radians(a)) for a in f) for f in given]
    return slopes, lambda x, y: f'{math.degrees(math.atan(x))!r} {math.degrees(math.atan(y))!r} angle'


def check_lens(lens, wavelengths, draw, count):
    path = written(lens) if isinstance(lens, str) else lens
    options = ['--boxes', BOXES, '--boxes', draw.choice((30, BOXES))]
    bound = {(r['quantity'], r['element']): float(r['bound']) for r in between(path, *options)}
    corners, say = fields_of(lens)
    for turn in range(count):
        share = [draw.expovariate(1) for _ in corners]
        if turn % 3 == 0:  # a corner or an edge
            share = [s if i in draw.sample(range(len(corners)), 2) else 0 for i, s in enumerate(share)] if turn % 2 else \
                    [float(i == turn // 2 % len(corners)) for i in range(len(corners))]
        total = sum(share) or 1
        x, y = (sum(s * c[k] for s, c in zip(share, corners)) / total for k in (0, 1))
        if not sum(share):
            continue
        um = draw.uniform(*wavelengths) if turn % 4 else draw.choice(wavelengths)
        which = ['--field-at', say(x, y), '--wavelength', f'{um!r}', '--aim', 'paraxial', '--hexapolar', 5]
        what = (str(path), which)
        suffix = '_mrad' if lens == AFOCAL else ''
        for r in rows('fan', path, *which, exit=None):
            if r['fate'] != 'passed':
                continue
            ex, ey = abs(float(r['ex' + suffix])), abs(float(r['ey' + suffix]))
            for name, value in (('ex', ex), ('ey', ey), ('spot', math.hypot(ex, ey))):
                if not value <= bound[name, ''] * (1 + 1e-12) + 1e-11:
                    raise AssertionError(f'{what}: {name} {value}, beyond {bound[name, ""]}')
        waves = [float(r['opd']) for r in rows('opd', path, *which, exit=None) if r['fate'] == 'passed']
        if waves and not max(waves) - min(waves) <= bound['opd', ''] + 1e-6:
            raise AssertionError(f'{what}: opd {max(waves) - min(waves)}, beyond {bound["opd", ""]}')
    return bound


def test_rays():
    """No ray leaves a bound, whatever its field and wavelength."""
    draw = random.Random(SEED)
    count = max(int(30 * SCALE), 2)
    some = ((AFAR, (0.4861, 0.6563)), (NEAR, (0.45, 0.65)), (TELECENTRIC, (0.5, 0.6)), (AFOCAL, (0.5, 0.6)),
                              (TRIPLET, (0.55, 0.55)), (HYBRID, (0.48613270, 0.65627250)))
    for lens, wavelengths in some if SCALE > 2 else [some[0], *draw.sample(some[1:], 2)]:
        bound = check_lens(lens, wavelengths, draw, count)
        if not math.isfinite(bound['incidence', '1']):
            raise AssertionError((lens, bound))


def test_seen():
    """The worst rays are of the fields and wavelengths asked for, and do what is said of them."""
    lens = written(AFAR)
    for r in between(lens, '--boxes', 30):
        if r['quantity'] not in ('ex', 'ey', 'spot'):
            continue
        got, = rows('fan', lens, '--field-at', f'{r["fx"]} {r["fy"]} angle', '--wavelength', r['um'], '--pupil', f'{r["px"]} {r["py"]}')
        value = {'ex': abs(float(got['ex'])), 'ey': abs(float(got['ey'])), 'spot': math.hypot(float(got['ex']), float(got['ey']))}
        close(value[r['quantity']], float(r['seen']), 1e-9)
        if not float(r['seen']) <= float(r['bound']):
            raise AssertionError(r)


def test_circles():
    """Planes and holes: angles and heights are known.  The largest field is not the last of the file."""
    lens = written(HOLES)
    bound = {(r['quantity'], r['element']): r for r in rows('prove', lens, '--fields', 'all', '--boxes', 500)}
    close(bound['incidence', '1']['bound'], 25, 0.3)
    if not float(bound['incidence', '1']['bound']) >= 25 * (1 - 1e-12):
        raise AssertionError(bound['incidence', '1'])
    close(bound['incidence', '1']['fy'], 25, 1e-9)
    far = 60 - 5 - 10 * math.tan(math.radians(25))
    if not 0.97 * far <= float(bound['clearance', '2']['bound']) <= far + 1e-9:
        raise AssertionError((far, bound['clearance', '2']))
    # a path difference of parallel light that is not focused: what the way from the wavefront to the pupil is
    # belongs to it
    seen, most = (float(bound['opd', ''][k]) for k in ('seen', 'bound'))
    if not seen <= most <= 1.2 * seen:
        raise AssertionError(bound['opd', ''])
    at = bound['opd', '']
    two = [float(rows('opd', lens, '--field-at', f'{at["fx"]} {at["fy"]} angle', '--pupil', f'{at[px]} {at[py]}')[0]['opd'])
           for px, py in (('px', 'py'), ('low_px', 'low_py'))]
    close(two[0] - two[1], seen, 1e-6 * seen)
    for r in rows('prove', TRIPLET, '--fields', 'all', '--limit', 'ey < 0.1; incidence[3] < 46.9'):
        equal(r['verdict'], 'proven', r)  # 2.3 and 1.015 times what was seen
    close(bound['spot', '']['bound'], 5, 0.11)  # of parallel light through nothing: the pupil itself


def test_limits():
    """Proven above the bound; broken by a ray that lies between the fields, and does it; or undecided."""
    # at the fields of the file it is 0.0408 at most
    equal({r['verdict'] for r in rows('prove', TRIPLET, '--limit', 'spot < 0.043')}, {'proven'})
    got, = rows('prove', TRIPLET, '--fields', 'all', '--limit', 'spot < 0.043', '--boxes', 30, exit=BROKEN)
    ray, = rows('fan', TRIPLET, '--field-at', f'{got["fx"]} {got["fy"]} angle', '--pupil', f'{got["px"]} {got["py"]}')
    if not 14 < float(got['fy']) < 20 or not math.hypot(float(ray['ex']), float(ray['ey'])) > 0.043:
        raise AssertionError((got, ray))
    said = run('prove', TRIPLET, '--fields', 'all', '--limit', 'ey < 0.001; opd < 1', exit=BROKEN).stdout
    command = next(line for line in said.splitlines() if 'sagitta diagnose' in line).split('diagnose ')[1]
    run('diagnose', *shlex.split(command))
    equal('and by the one with the smallest difference' in said, True, said)
    got, = rows('prove', TRIPLET, '--fields', 'all', '--limit', 'spot < 0.0441', '--boxes', 100, exit=UNDECIDED)
    equal(got['verdict'], 'undecided')


def test_what_is_wrong():
    table = AFAR.replace('glass: N-BK7', 'glass: [[0.48, 1.52], [0.6, 1.516], [0.7, 1.514]]')
    numbers = AFAR.replace('glass: N-BK7', 'index: [1.522, 1.517, 1.514]')
    for lens, options, code, words in (
            (TRIPLET, ['--fields', 'all', '--limit', 'pass > 99'], USAGE, 'pass is of one field'),
            (TRIPLET, ['--fields', 'all', '--limit', 'rms < 1'], USAGE, 'rms is of one field'),
            (TRIPLET, ['--fields', 'all', '--elements'], USAGE, '--elements: not of all fields'),
            (TRIPLET, ['--fields', 'all', '--picture', 'nowhere.svg'], USAGE, '--picture'),
            (TRIPLET, ['--wavelengths', '2'], USAGE, 'wavelengths'),
            (TRIPLET, ['--fields', 'all', '--limit', 'incidence[99] < 1'], USAGE, 'no element 99'),
            (TRIPLET, ['--wavelengths', 'all', '--boxes', 100], 0, 'there is one alone'),
            (written(table), ['--wavelengths', 'all'], 3, 'a table of indices'),
            (written(numbers), ['--wavelengths', 'all'], 3, 'is for the wavelengths of the file'),
            (TRIPLET, ['--fields', 'all', '--boxes', 200], 1, '200 each; more --boxes')):
        done = any_end('prove', lens, *options)
        equal((done.returncode, words in done.stderr), (code, True), (options, done.stderr))


def test_vignetting():
    """Where fields differ in it, the whole pupil is taken; where they do not, theirs."""
    lens = TRIPLET.read_text()
    one = lens + 'vignetting: [{cy: 0}, {cy: 0.2}, {cy: 0.4}]\n'
    done = run('prove', written(one), '--fields', 'all', '--boxes', 100, exit=None)
    equal('the whole pupil is taken' in done.stderr, True, done.stderr)
    same = lens + 'vignetting: [{cx: 0.5, cy: 0.5}, {cx: 0.5, cy: 0.5}, {cx: 0.5, cy: 0.5}]\n'
    small, = (r for r in rows('prove', written(same), '--fields', 'all', '--boxes', 30, exit=None) if r['quantity'] == 'spot')
    large, = (r for r in rows('prove', TRIPLET, '--fields', 'all', '--boxes', 30, exit=None) if r['quantity'] == 'spot')
    if not float(small['seen']) < 0.5 * float(large['seen']):
        raise AssertionError((small, large))


def test_threads_and_shards():
    """The same bytes for any number; of the views of single fields, too."""
    draw = random.Random(SEED)
    for view in (['--fields', 'all', '--boxes', 60], ['--fields', 'all', '--boxes', 60, '--limit', 'spot < 0.05'],
                 ['--boxes', 100, '--elements'], ['--boxes', 100, '--regions'],
                 ['--boxes', 100, '--limit', 'spot < 0.03; rms < 0.02']):
        whole = [any_end('prove', TRIPLET, *view, '--threads', n) for n in (1, 3)]
        equal(whole[0].stdout, whole[1].stdout, view)
        count = draw.choice((2, 3, 5))
        parts = [pathlib.Path(tempfile.mkdtemp()) / f'{k}.part' for k in range(count)]
        for k, part in enumerate(parts):
            equal(run('prove', TRIPLET, *view, '--shard', f'{k + 1}/{count}', '--output', part).stdout, '', view)
        draw.shuffle(parts)
        done = any_end('join', *parts)
        equal((done.stdout, done.stderr, done.returncode), (whole[0].stdout, whole[0].stderr, whole[0].returncode), view)


def test_steps():
    """The vignetting curve: fields from the axis to the farthest one, which is not the last; both bounds."""
    lens = written(HOLES)
    got = rows('prove', lens, '--steps', 6, '--boxes', 300)
    equal([float(r['fy']) for r in got], [0, 5, 10, 15, 20, 25])
    lens = written(HOLES.replace('semi_diameter: 60', 'semi_diameter: 6'))
    for r in rows('prove', lens, '--steps', 4, '--boxes', 1000, exit=None):
        a, b, d = 5, 6, 10 * math.tan(math.radians(float(r['fy'])))
        common = math.pi * a * a
        if d > b - a:
            u, v = (d * d + a * a - b * b) / (2 * d), (d * d + b * b - a * a) / (2 * d)
            common = (a * a * math.acos(u / a) - u * math.sqrt(a * a - u * u) + b * b * math.acos(v / b) -
                      v * math.sqrt(b * b - v * v))
        share = 100 * common / (math.pi * a * a)
        if not float(r['passes']) - 1e-9 <= share <= float(r['passes']) + float(r['undecided']) + 1e-9:
            raise AssertionError((share, r))
    picture = pathlib.Path(tempfile.mkdtemp(dir=folder.name)) / 'curve.svg'
    if '--without-cairo' not in sys.argv:
        run('prove', lens, '--steps', 3, '--boxes', 100, '--picture', picture, exit=None)
        equal('<svg' in picture.read_text(), True)
    equal('--steps' in run('prove', lens, '--steps', 3, '--regions', exit=USAGE).stderr, True)


def test_progress():
    done = run('prove', TRIPLET, '--progress', '--boxes', 200, '--fields', 2)
    equal('boxes, ' in done.stderr, True, done.stderr)
    equal('parts of the fields' in run('prove', TRIPLET, '--progress', '--boxes', 200, '--fields', 'all', exit=None).stderr, True)


def test_proof_all():
    """A ring that no ray fell into is named; where nothing is missed, that is said."""
    done = run('spot', ZONE, '--format', 'csv', '--proof', 'all')
    equal(done.stdout, run('spot', ZONE, '--format', 'csv').stdout, 'the same numbers as without it')
    said = done.stderr
    equal('totally reflected at element 2, where no ray of the sample fell' in said, True, said)
    for name, options in (('opd', ['--grid', 12]), ('map', ['--cells', 5])):
        done = run(name, TRIPLET, '--fields', 1, '--proof', 'all', *options)
        equal(done.stderr.startswith('sagitta: field 1') or 'Held against' in done.stdout, True, done)
    got = re.search(r'field 1: ([\d.]+) % of the pupil.*radii ([\d.]+) to ([\d.]+)', said)
    close(got[1], 6.5, 0.1), close(got[2], 0.932, 0.002), close(got[3], 0.967, 0.002)
    done = run('spot', TRIPLET, '--proof', 'all')
    equal(('Held against every ray of the pupil' in done.stdout, done.stderr), (True, ''), done)
    inner = run('spot', TRIPLET, '--random', 2, '--fields', 2, '--proof', 'all')
    equal(('those of the sample end within' in inner.stderr, 'These rays miss something' in inner.stdout), (True, True), inner)
    for options, words in ((['--shard', '1/2', '--output', 'x'], 'not with shards'), (['--chief'], 'single rays')):
        equal(words in run('spot', TRIPLET, '--proof', 'all', *options, exit=USAGE).stderr, True, options)
    equal('--proof must be' in run('trace', TRIPLET, '--proof', 'all', exit=USAGE).stderr, True)


if __name__ == '__main__':
    print(f'SAGITTA_TEST_SEED={SEED}')
    main(globals())
