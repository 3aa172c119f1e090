#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Rays aimed at stops anywhere: beside the axis, behind cones, at ideal lenses; and what is said where there is none.

    python3 test_aim_family.py SAGITTA

The oracles: straight lines and spheres at 50 digits, and the closed form of an ideal lens.
"""
import json
import math
import os
import random
import shlex

from mpmath import mp, mpf, sqrt

from command import *

mp.dps = 50
SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'))
SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
print(f'       seed {SEED}')
draw = random.Random(SEED)


def times(n):
    return range(max(1, round(n * SCALE)))


def lens(surfaces, **more):
    surfaces = [{'index': 1, **s} if not s.get('glass') else s for s in surfaces]
    return written(json.dumps({'units': 'mm', 'aim': 'stop', 'surfaces': surfaces, **more}))


def at_stop(path, element, *options, **how):
    return {(r['field'], r['px'], r['py']): r for r in rows('trace', path, *options, **how) if r['element'] == str(element)}


def test_a_stop_beside_the_axis():
    """A stop first, decentred by 0 to 50 pupil radii: every ray is there, at its point."""
    for _ in times(20):
        radius, way, angle = draw.uniform(.5, 5), draw.uniform(0, 50), draw.uniform(0, 2 * math.pi)
        to = [radius * way * math.cos(angle), radius * way * math.sin(angle), 0]
        field = draw.choice([0, 10, -30])
        path = lens([{'type': 'plane', 'decenter': to, 'thickness': 50, 'stop': True}, {'type': 'plane'}],
                    pupil={'semi_diameter': radius}, fields=[field])
        for r in rows('trace', path, '--grid', 3):
            if r['element'] == '1':
                close(r['x'], float(r['px']) * radius, 1e-12 * (1 + radius * way)), close(r['y'], float(r['py']) * radius, 1e-12 * (1 + radius * way))
        assert '331 rays: 331 passed' in run('spot', path).stdout


def test_a_stop_beside_the_axis_behind_a_lens():
    """A weak lens in front: found up to 50 radii too."""
    for _ in times(10):
        way = draw.uniform(0, 50)
        path = lens([{'type': 'sphere', 'radius': 2000, 'thickness': 5, 'index': 1.5}, {'type': 'plane', 'thickness': 20},
                     {'type': 'plane', 'decenter': [0, way, 0], 'thickness': 50, 'stop': True}, {'type': 'plane'}],
                    pupil={'semi_diameter': 1, 'distance': 0}, fields=[0])
        got = at_stop(path, 3, '--chief', exit=None)
        equal(len(got), 1, path)
        for r in got.values():
            close(r['x'], 0, 1e-12), close(r['y'], 0, 1e-12)


def test_a_stop_beside_a_rim():
    """A rim in front lets nothing through to the stop: its rays are found, as they are far from the pupil, and clipped."""
    for _ in times(10):
        way = draw.uniform(8, 50)
        path = lens([{'type': 'plane', 'thickness': 5, 'semi_diameter': 2}, {'type': 'plane', 'decenter': [0, way, 0], 'thickness': 50, 'stop': True},
                     {'type': 'plane'}], pupil={'semi_diameter': 1, 'distance': 0}, fields=[0])
        assert '331 rays: 331 clipped' in run('spot', path, exit=None).stdout, path
        assert '331 rays: 331 passed' in run('spot', path, '--no-apertures').stdout, path


def sphere_on(o, d, z, radius, index_ratio):
    """Where a ray meets the sphere with its vertex at z, near it, and the direction behind; at 50 digits."""
    centre = z + radius
    q = [o[0], o[1], o[2] - centre]
    b, c = sum(a * e for a, e in zip(q, d)), sum(a * a for a in q) - radius * radius
    t = -b - sqrt(b * b - c) * (1 if radius > 0 else -1)
    p = [a + t * e for a, e in zip(o, d)]
    n = [p[0] / radius, p[1] / radius, (p[2] - centre) / radius]
    n = [-a for a in n]
    cosine = sum(a * e for a, e in zip(n, d))
    behind = sqrt(1 - index_ratio ** 2 * (1 - cosine ** 2))
    return p, [index_ratio * e + (behind - index_ratio * cosine) * a for e, a in zip(d, n)]


def test_telecentric_cones():
    """The rays of a telecentric object meet the stop where they are asked to: their launch rays, traced at 50 digits."""
    for _ in times(6):
        distance, na, radius = draw.uniform(10, 20), draw.uniform(.02, .2), draw.uniform(18, 30)
        path = lens([{'type': 'sphere', 'radius': radius, 'thickness': 7, 'index': 1.5},
                     {'type': 'sphere', 'radius': -radius, 'thickness': 15},
                     {'type': 'plane', 'thickness': 15, 'stop': True}, {'type': 'plane'}],
                    object={'distance': distance, 'telecentric': True, 'index': 1}, pupil={'object_na': na},
                    field_type='object_height', fields=[0, 2])
        size = json.loads(run('info', path, '--format', 'json').stdout)['stop_radius']
        first = at_stop(path, 1, '--grid', 3)
        for key, r in at_stop(path, 3, '--grid', 3).items():
            height = (0, 2)[int(key[0]) - 1]
            p = [mpf(first[key][k]) for k in 'xyz']
            o = [mpf(0), mpf(height), -mpf(distance)]
            d = [a - b for a, b in zip(p, o)]
            length = sqrt(sum(a * a for a in d))
            d = [a / length for a in d]
            p, d = sphere_on(o, d, mpf(0), mpf(radius), 1 / mpf('1.5'))
            p, d = sphere_on(p, d, mpf(7), -mpf(radius), mpf('1.5'))
            t = (22 - p[2]) / d[2]
            for k, point in ((0, key[1]), (1, key[2])):
                close(p[k] + t * d[k], float(point) * size, 1e-11, (path, key))


TELECENTRIC_ZMX = '''VERS 140124 258 36214
MODE SEQ
UNIT MM X W X CM MR CPMM
OBNA 0.2 0
RAIM 0 2 1 1 0 0 0 0 0
FTYP 1 1 2 1 0 0 0
XFLN 0 0
YFLN 0 2
FWGN 1 1
WAVM 1 0.55 1
PWAV 1
SURF 0
  TYPE STANDARD
  CURV 0
  DISZ 15
SURF 1
  TYPE STANDARD
  CURV 0.05
  DISZ 7
  GLAS ___BLANK 1 0 1.5 60 0 0 0 0 0 0
SURF 2
  TYPE STANDARD
  CURV -0.05
  DISZ 15
SURF 3
  STOP
  TYPE STANDARD
  CURV 0
  DISZ 15
SURF 4
  TYPE STANDARD
  CURV 0
  DISZ 0
'''


def test_a_telecentric_import_is_not_aimed():
    """OpticStudio ignores ray aiming there; the reader says so, and --aim real aims."""
    path = written(TELECENTRIC_ZMX, 'telecentric.zmx')
    done = run('trace', path, '--chief', '--format', 'csv')
    assert 'RAIM' in done.stderr and 'telecentric' in done.stderr, done.stderr
    chief = list(at_stop(path, 3, '--chief', '--fields', 2).values())[0]
    assert float(chief['y']) > .1, chief
    aimed = list(at_stop(path, 3, '--chief', '--fields', 2, '--aim', 'real').values())[0]
    close(aimed['y'], 0, 1e-12)


def test_an_ideal_lens_as_stop():
    """The ray through its centre is not bent: it meets the focal plane at f tan; all rays do.  Also behind another."""
    for _ in times(20):
        f, front, fields = draw.uniform(20, 300), draw.choice([0, 0, 3]), [0, draw.uniform(.1, 20), draw.uniform(-20, -.1)]
        ideal = {'type': 'ideal', 'focal_length': f, 'thickness': f, 'stop': True}
        plane = [{'type': 'plane', 'thickness': front}] if front else []
        path = lens([*plane, ideal, {'type': 'plane'}], pupil={'semi_diameter': f / 15}, fields=fields)
        for key, r in at_stop(path, 2 + len(plane), '--hexapolar', 3).items():
            close(r['y'], f * math.tan(math.radians(fields[int(key[0]) - 1])), 1e-12 * f, path)
        assert 'lost' not in run('spot', path).stdout
    for _ in times(10):
        f = draw.uniform(50, 300)
        path = lens([{'type': 'ideal', 'focal_length': f, 'thickness': 10}, {'type': 'plane', 'thickness': f, 'stop': True},
                     {'type': 'plane'}], pupil={'semi_diameter': f / 15}, fields=[0, draw.uniform(1, 10)])
        size = json.loads(run('info', path, '--format', 'json').stdout)['stop_radius']
        got = at_stop(path, 2, '--grid', 3)
        equal(len(got), 2 * 5)
        for key, r in got.items():
            close(r['x'], float(key[1]) * size, 1e-11), close(r['y'], float(key[2]) * size, 1e-11)


def test_none_is_none():
    """Where `none` is said, no ray of 1000 that the rims let through comes to the point; without rims, it is not said."""
    said = 0
    for _ in times(12):
        radius, rim, thick = draw.uniform(8, 14), draw.uniform(2, 6), draw.uniform(8, 16)
        front = {'type': 'sphere', 'radius': radius, 'thickness': thick, 'index': 1.9, 'semi_diameter': rim}
        size, field = draw.uniform(3, 40), draw.choice([0, 5, 20])
        slope = math.tan(math.radians(field))
        path = lens([front, {'type': 'plane', 'thickness': 1, 'stop': True, 'draw_to': size}, {'type': 'plane'}],
                    pupil={'stop_size': True, 'distance': 0}, fields=[field])
        done = run('trace', path, '--fan', 5, exit=None)
        if 'as is proven' not in done.stderr:
            continue
        said += 1
        launch = [(x, y - 50 * slope, -50, 0, slope, 1)
                  for x, y in ((draw.uniform(-2 * rim, 2 * rim), draw.uniform(-2 * rim, 2 * rim)) for _ in range(1000))]
        at = [(float(r['x']), float(r['y']))
               for r in csv.DictReader(io.StringIO(run('trace', path, '--rays', '-', '--format', 'csv', stdin=rays(*launch), exit=None).stdout))
               if r['element'] == '2']
        there = at_stop(path, 2, '--fan', 5, exit=None)
        for py in (-1, -.5, .5, 1):
            missing = not any(float(key[2]) == py for key in there)
            # the nearest of 1000 rays stays off the point; where one is there, it lands within a tenth or so
            near = min(math.hypot(x, y - py * size) for x, y in at)
            assert not missing or near > 1e-3 * size, (path, py, near)
    print(f'       said of {said} lenses')
    assert said


def test_unbounded_is_undecided():
    """A plane in front bounds nothing: what is not found is undecided, with the limit, and the status is 1."""
    path = lens([{'type': 'plane', 'thickness': 5, 'index': 1.5}, {'type': 'plane', 'decenter': [0, 0, 0], 'tilt': [0, 0, 0], 'thickness': 3},
                 {'type': 'plane', 'decenter': [0, 5000, 0], 'thickness': 50, 'stop': True}, {'type': 'plane'}],
                pupil={'semi_diameter': 1, 'distance': 0}, fields=[0])
    done = run('trace', path, '--chief', exit=UNDECIDED)
    assert 'none within 600 pupil radii' in done.stderr, done.stderr
    done = run('spot', path, exit=UNDECIDED)
    assert 'none lies within 600 pupil radii' in done.stdout, done.stdout
    shown = run('diagnose', path, '--chief', exit=UNDECIDED).stdout
    assert 'edge of the rays' in shown, shown


def test_each_lost_ray_can_be_asked_for():
    """What an analysis says of its first lost ray runs, and gives a reason."""
    ball = lens([{'type': 'sphere', 'radius': 10, 'thickness': 12, 'index': 1.9}, {'type': 'plane', 'thickness': 1, 'index': 1.2},
                 {'type': 'plane', 'stop': True, 'thickness': 3, 'draw_to': 8}, {'type': 'plane'}],
                pupil={'semi_diameter': 30, 'distance': 0}, fields=[0, 30], wavelengths=[0.55])
    asked = 0
    for command in (['spot'], ['sweep', '--steps', 5, '--to', 60], ['fan'], ['opd'], ['map', '--fields', '2'], ['field']):
        done = run(*command, ball, exit=None)
        for line in done.stdout.splitlines():
            if line.startswith('    sagitta diagnose '):
                shown = run(*shlex.split(line)[1:], exit=None)
                asked += 1
                assert 'element' in shown.stdout and 'no ray' in shown.stdout, (line, shown.stdout)
                assert command[0] == 'field' or same_point(line, shown.stdout), (line, shown.stdout)
    print(f'       asked {asked} times')
    assert asked >= 5


def same_point(line, shown):
    """Diagnose tells of the point of the pupil that the printed command names."""
    words = shlex.split(line)
    x, y = (float(a) for a in words[words.index('--pupil') + 1].split())
    return f'through {x:g}, {y:g} of the pupil' in shown


def test_each_lost_trace_can_be_asked_for():
    """A ray that is traced and lost, as its evaluations are spent: each analysis prints a command that shows it so."""
    path = lens([{'type': 'even_asphere', 'radius': 50, 'coefficients': [0, 1e-6, 2e-9], 'thickness': 4, 'index': 1.5, 'stop': True},
                 {'type': 'plane', 'thickness': 90}, {'type': 'even_asphere', 'radius': -80, 'coefficients': [0, 1e-7]}],
                pupil={'semi_diameter': 8}, fields=[0, 5], wavelengths=[0.55])
    for command in (['spot'], ['spot', '--defocus', '3'], ['spot', '--defocus', '-2'], ['sweep', '--steps', 3, '--to', 20],
                    ['fan'], ['opd'], ['map', '--fields', '2'], ['field']):
        more = ['--defocus', '-2'] if '-2' in command else ['--defocus', '3'] if '3' in command else []
        done = run(*command, path, '--aim', 'paraxial', '--max-evals', '1', exit=None)
        asked = [line for line in done.stdout.splitlines() if line.startswith('    sagitta diagnose ')]
        assert asked or command == ['field'], (command, done.stdout)  # curves of fields have no searches of one step
        for line in asked:
            words = shlex.split(line)[1:]
            for word in more:
                assert word.lstrip('-') in ' '.join(words), (command, line)
            shown = run(*words, exit=None).stdout
            assert 'lost' in shown or 'exhausted' in shown, (line, shown)
    # with --defocus the last element is met elsewhere: the ray that is shown ends where spot had it
    shown = {z: run('diagnose', path, '--pupil', '0 1', '--fields', '1', '--defocus', z).stdout for z in ('3', '-2')}
    assert shown['3'] != shown['-2']


# S = A r^2 + B r^4 is 0 at r = 10 and -2 at r = 2, where its slope is -23/12
STEEP = {'type': 'even_asphere', 'coefficients': [-100 / 192, 1 / 192], 'index': 1.5, 'semi_diameter': 2.3}
HIDDEN = {'apertures': [{'type': 'circle', 'radius': 1, 'obscures': True, 'offset': [0, 2]}]}


def test_the_root_that_the_lens_means():
    """A line of slope 4 through (0, -2.5) meets the sag at y = 10, near the vertex plane and outside of semi_diameter, and at y = 2.

    The chief ray and the marginal ray follow the second, also where it is hidden by an obscuration.
    """
    steepest = math.degrees(math.atan(4))
    for more in ({}, HIDDEN):
        path = lens([{'type': 'plane', 'thickness': 2.5, 'stop': True}, {**STEEP, **more, 'thickness': 3}, {'type': 'plane'}],
                    pupil={'semi_diameter': .01}, fields=[steepest])
        for aim in 'real', 'paraxial':
            got = at_stop(path, 2, '--chief', '--aim', aim)
            equal(len(got), 1)
            for r in got.values():
                close(r['y'], 2, 1e-11), close(r['z'], -2, 1e-11)
            bare = list(at_stop(path, 2, '--chief', '--aim', aim, '--no-apertures').values())[0]
            close(bare['y'], 10, 1e-9)  # no aperture says that another root is meant
    # the marginal ray of an object at (0, -2.5), by Snell's law at (2, -2), and a plane stop 2 behind the vertex
    d, n, mu = (4 / math.sqrt(17), 1 / math.sqrt(17)), (23 / 12 / math.hypot(23 / 12, 1), 1 / math.hypot(23 / 12, 1)), 1 / 1.5
    cosine = d[0] * n[0] + d[1] * n[1]
    more_n = math.sqrt(1 - mu * mu * (1 - cosine * cosine)) - mu * cosine
    behind = [mu * a + more_n * b for a, b in zip(d, n)]
    radius = 2 + 4 * behind[0] / behind[1]
    for more in ({}, HIDDEN):
        path = lens([{**STEEP, **more, 'thickness': 2}, {'type': 'plane', 'stop': True, 'index': 1.5, 'thickness': 3}, {'type': 'plane'}],
                    object={'distance': 2.5, 'index': 1}, pupil={'object_na': 4 / math.sqrt(17)}, field_type='object_height', fields=[0], aim='real_stop')
        # the ray across the axis tells of that size, as the marginal ray itself may be clipped
        got = list(at_stop(path, 2, '--pupil', '0 -1', exit=None).values())
        equal(len(got), 1), close(got[0]['y'], -radius, 1e-11 * radius)


main(globals(), halved=False)
