#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sagitta trace: rays of a field, elements one after another, losses.

    python3 test_trace.py SAGITTA

The oracle is a trace of our own, in a few lines: conics in closed form about the vertex,
Snell's law in vectors, for lenses along an axis.
"""
import json
import math
import re

from command import *

NAMES = ('aspheric_singlet', 'cassegrain', 'cooke_triplet', 'ftheta', 'newtonian')


def surfaces_of(name):
    """The surfaces of an example, one flow map a line, read without a YAML library."""
    text = (LENSES / f'{name}.yaml').read_text()
    several = []
    for line in re.findall(r'^  - \{(.*)\}$', text, re.MULTILINE):
        line = re.sub(r'\[([^\]]*)\]', lambda m: m.group(1).split(',')[0], line)  # the first wavelength
        several.append(dict(pair.split(': ') for pair in line.split(', ')))
    return several


def paraxial(several, count):
    """Matrix from the first vertex to that of element `count`, mirrors with index and thickness negative."""
    a, b, c, d, index = 1.0, 0.0, 0.0, 1.0, 1.0  # y' = a y + b u, n'u' = c y + d n u
    for s in several[:count]:
        behind = -index if s.get('mirror') else math.copysign(float(s.get('index', abs(index))), index)
        curvature = 1 / float(s['radius']) if 'radius' in s else 0.0
        power = curvature * (behind - index)
        c, d = c - power * a, d - power * b
        reduced = float(s.get('thickness', 0)) / behind
        a, b = a + reduced * c, b + reduced * d
        index = behind
    return a, b


def own_trace(several, origin, direction):
    """(x, y, z, l, m, n) behind each surface, in its own frame, and the optical path length."""
    o, d, index, opl, out = list(origin), list(direction), 1.0, 0.0, []
    for s in several:
        c = 1 / float(s['radius']) if 'radius' in s else 0.0
        k = float(s.get('conic', 0))
        t = -o[2] / d[2]
        x, y = o[0] + t * d[0], o[1] + t * d[1]
        a = c * (d[0] ** 2 + d[1] ** 2 + (1 + k) * d[2] ** 2)
        b = d[2] - c * (x * d[0] + y * d[1])
        e = c * (x * x + y * y)
        t += e / (b + math.copysign(math.sqrt(b * b - a * e), b))
        p = [o[i] + t * d[i] for i in range(3)]
        opl += index * t
        normal = [-c * p[0], -c * p[1], 1 - c * (1 + k) * p[2]]
        length = math.sqrt(sum(v * v for v in normal))
        normal = [v / length for v in normal]
        cosine = sum(u * v for u, v in zip(d, normal))
        if s.get('mirror'):
            d = [u - 2 * cosine * v for u, v in zip(d, normal)]
        else:
            behind = float(s.get('index', index))
            r = index / behind
            q = math.sqrt(1 - r * r * (1 - cosine * cosine))
            d = [r * u + (math.copysign(q, cosine) - r * cosine) * v for u, v in zip(d, normal)]
            index = behind
        out.append((*p, *d, opl))
        o = [p[0], p[1], p[2] - float(s.get('thickness', 0))]
    return out


def test_columns():
    for name in NAMES:
        done = run('trace', LENSES / f'{name}.yaml', '--format', 'csv')
        equal(done.stdout.splitlines()[0], TRACE_ALL)


def test_against_own_trace():
    for name, size, steepness in (('cooke_triplet', 60, 1), ('cassegrain', 90, 0.05), ('ftheta', 29, 1)):
        several = surfaces_of(name)
        launch = [(0.1 * i, 0.2 * i - 0.7, -5, 0.001 * steepness * i, 0.004 * steepness * (i - 3), 1) for i in range(8)]
        launch = [(*r[:3], *(v / math.sqrt(r[3] ** 2 + r[4] ** 2 + 1) for v in r[3:])) for r in launch]
        got = rows('trace', LENSES / f'{name}.yaml', '--rays', '-', '--no-apertures', stdin=rays(*launch))
        equal(len(got), 8 * len(several))
        for row in got:
            wanted = own_trace(several, launch[int(row['ray'])][:3], launch[int(row['ray'])][3:])[int(row['element']) - 1]
            equal((row['fate'], row['status']), ('passed', 'hit'))
            for column, value in zip(('x', 'y', 'z', 'l', 'm', 'n', 'opl'), wanted):
                close(row[column], value, 1e-12 * size, f"{name} ray {row['ray']} element {row['element']} {column}")


def first_rows(*arguments):
    return [r for r in rows('trace', *arguments, '--frame', 'global') if r['element'] == '1']


def test_fan_and_grid_counts():
    lens = LENSES / 'ftheta.yaml'

    def rays_of(*arguments):
        return len(first_rows(lens, *arguments))
    equal(rays_of(), 3 * 5)
    equal(rays_of('--field', '0'), 5)
    equal(rays_of('--field', '0', '--field', '-3.5', '--fan', '7'), 14)
    for n in (1, 2, 3, 4, 5, 12, 33):
        equal(rays_of('--field', '5', '--fan', n), n)
        if n == 2:
            continue  # its four corners are outside the circle: an error
        # (2i - (n - 1))^2 + (2j - (n - 1))^2 <= (n - 1)^2 in whole numbers
        inside = sum((2 * i - n + 1) ** 2 + (2 * j - n + 1) ** 2 <= (n - 1) ** 2 for i in range(n) for j in range(n))
        equal(rays_of('--field', '5', '--grid', n), inside, f'grid {n}')


def test_fan_reaches_the_edges():
    """The stop of the scan lens is its first surface and its pupil: heights are known."""
    got = first_rows(LENSES / 'ftheta.yaml', '--field', '17', '--fan', '5')
    for row, height in zip(got, (-0.5, -0.25, 0, 0.25, 0.5)):
        close(row['y'], height, 1e-15)
        close(row['m'], math.sin(math.radians(17)), 1e-15)
        equal(row['fate'], 'passed')
    row, = first_rows(LENSES / 'ftheta.yaml', '--field', '-17', '--fan', '1')
    close(row['y'], 0, 1e-15)
    close(row['m'], -math.sin(math.radians(17)), 1e-15)


def test_common_wavefront():
    """In front of the stop, equal optical paths belong to points on a plane across the beam."""
    got = first_rows(LENSES / 'ftheta.yaml', '--field', '12', '--grid', '5')
    along = [float(r['opl']) - float(r['y']) * float(r['m']) - float(r['z']) * float(r['n']) for r in got]
    assert max(along) - min(along) < 1e-15 * 16, along
    assert all(float(r['t']) > 0 for r in got)


def test_entrance_pupil():
    """The chief ray of a field crosses the axis, if it went straight on, where the paraxial pupil is."""
    for name, stop in (('cooke_triplet', 3), ('ftheta', 0), ('cassegrain', 0)):
        a, b = paraxial(surfaces_of(name), stop)
        pupil = b / a
        row, = first_rows(LENSES / f'{name}.yaml', '--field', '0.1', '--fan', '1', '--no-apertures')
        crossing = float(row['z']) - float(row['y']) / math.tan(math.radians(0.1)) if stop else 0.0
        close(crossing, pupil, 1e-9 * 60, name)
    close(pupil, 0, 0)
    a, b = paraxial(surfaces_of('cooke_triplet'), 3)
    close(b / a, 11.512, 0.001, 'the pupil of the triplet')
    # and the real ray then meets the stop near its centre, which it does only if the pupil is right
    stop = [r for r in rows('trace', LENSES / 'cooke_triplet.yaml', '--field', '0.1', '--fan', '1') if r['element'] == '4']
    close(stop[0]['y'], 0, 1e-6)


def test_pupil_of_the_catalogue_in_front():
    """The section in y counts.  A normal that is not along z, and the tip of a cone, have no paraxial image."""
    template = 'pupil: {semi_diameter: 1}\nsurfaces:\n  - {type: %s, thickness: 3, index: 1.5}\n  - {type: plane, thickness: 4, index: 1}\n  - {type: plane, stop: true}\n'
    def crossing(surface):
        row, = first_rows(written(template % surface), '--field', '1', '--fan', '1')
        return float(row['z']) - float(row['y']) / math.tan(math.radians(1))
    wanted = crossing('sphere, radius: 20')
    for surface in ('toroidal, radius: 20, radius_x: -7', 'biconic, radius_y: 20', 'cylinder, radius: 20', 'polynomial_xy, coefficients: [[0, 0, 0.025], [0, 1e-3]]',
                    'chebyshev, norm_x: 2, norm_y: 2, coefficients: [[0, 0, 0.05]]', 'zernike, norm: 2, order: noll, coefficients: [0, 0, 0, 0.05]',
                    'odd_asphere, coefficients: [0, 0.025, 1e-3]', 'q_con, radius: 20, norm: 2, coefficients: [1e-3]',
                    'sum, radius: 40, terms: [{type: even_asphere, coefficients: [0.0125]}]'):
        close(crossing(surface), wanted, 1e-9, surface)
    for surface in ('polynomial_xy, coefficients: [[0, 1e-3]]', 'odd_asphere, coefficients: [1e-3]', 'torus, major: 3, minor: 1', 'ellipsoid, a: 3'):
        done = run('trace', written(template % surface), '--fan', 3, exit=BAD_INPUT)
        assert 'pupil.distance: needed: element 1' in done.stderr, done.stderr


def test_pupil_of_an_asphere_in_front():
    """The r^2 term of an asphere is part of its curvature: 1/20 and 1/40 + 2/80 are the same to a paraxial ray."""
    template = 'pupil: {semi_diameter: 1}\nsurfaces:\n  - {type: %s, thickness: 3, index: 1.5}\n  - {type: plane, thickness: 4, index: 1}\n  - {type: plane, stop: true}\n'
    crossing = []
    for surface in ('sphere, radius: 20', 'even_asphere, radius: 40, coefficients: [0.0125]'):
        row, = first_rows(written(template % surface), '--field', '1', '--fan', '1')
        crossing.append(float(row['z']) - float(row['y']) / math.tan(math.radians(1)))
    close(crossing[0], crossing[1], 1e-9)
    power = (1.5 - 1) / 20
    close(crossing[0], (3 / 1.5 + 4) / (1 - power * (3 / 1.5 + 4)), 1e-9)


def test_pupil_behind_a_mirror():
    """A concave mirror of focal length 50 images a stop 20 in front of it to 1/(1/50 - 1/20) = -33.3: behind it."""
    lens = written('pupil: {semi_diameter: 1}\nsurfaces:\n  - {type: sphere, radius: -100, thickness: -20, mirror: true}\n  - {type: plane, stop: true}\n')
    row, = first_rows(lens, '--field', '0.5', '--fan', '1')
    close(float(row['z']) - float(row['y']) / math.tan(math.radians(0.5)), 1 / (1 / 20 - 1 / 50), 1e-7)


def test_finite_object():
    """The rays of a field come from one point, below the axis for a positive field."""
    lens = written('object: {distance: 40, index: 1}\npupil: {semi_diameter: 2, distance: 10}\nsurfaces:\n  - {type: plane}\n')
    got = first_rows(lens, '--field', '7', '--fan', '3')
    for row, height in zip(got, (-2, 0, 2)):
        y, m, n = (float(row[c]) for c in ('y', 'm', 'n'))
        close(y - 40 * m / n, -50 * math.tan(math.radians(7)), 1e-13)
        close(y + 10 * m / n, height, 1e-13)
        close(row['opl'], 40 / n, 1e-13)
    assert float(got[1]['m']) > 0


def test_wavelengths():
    lens = LENSES / 'ftheta.yaml'
    lines = [rows('trace', lens, '--field', '15', '--fan', '1', *more)[-1]['y'] for more in
             ((), ('--wavelength', '1'), ('--wavelength', '2'), ('--wavelength', '3'))]
    equal(lines[0], lines[1])
    equal(len(set(lines)), 3)


def test_scan_lens_clips_nothing():
    for wavelength in (1, 2, 3):
        fields = [w for f in range(-20, 21, 4) for w in ('--field', f)]
        done = run('trace', LENSES / 'ftheta.yaml', *fields, '--grid', '15', '--wavelength', wavelength)
        assert re.search(r'^(\d+) of \1 rays passed all 8 elements\.$', done.stdout, re.MULTILINE), done.stdout[-300:]


def test_examples_clip_nothing():
    for name in NAMES:
        done = run('trace', LENSES / f'{name}.yaml', '--grid', '21')
        assert re.search(r'^(\d+) of \1 rays passed all', done.stdout, re.MULTILINE), (name, done.stdout[-300:])


LOSSY = '''surfaces:
  - {type: sphere, radius: -5, thickness: 4, index: 1.5, semi_diameter: 3}
  - {type: plane, thickness: 1, index: 1}
  - {type: sphere, radius: 2, thickness: 1, index: 1}
'''


def test_losses():
    text = rays((0, 0, -9, 0, 0, 1), (0, 3.5, -9, 0, 0, 1), (0, 6, -9, 0, 0, 1), (0, 2.9, -9, 0, 0.83, 1), (0, 2.5, -9, 0, 0, 1))
    lens = written(LOSSY)
    got = rows('trace', lens, '--rays', '-', stdin=text)
    last = {r['ray']: r for r in got}
    equal([(last[i]['element'], last[i]['fate'], last[i]['status']) for i in '012'],
          [('3', 'passed', 'hit'), ('1', 'clipped', 'hit'), ('1', 'missed', 'miss')])
    equal((last['4']['element'], last['4']['fate']), ('3', 'missed'))
    equal([last['1'][c] for c in 'lmn'], ['nan'] * 3)
    close(last['1']['y'], 3.5, 0)
    equal([last['2'][c] for c in ('x', 'y', 'z', 'l', 'm', 'n', 't')], ['nan'] * 7)
    lines = run('trace', lens, '--rays', '-', stdin=text).stdout.splitlines()
    assert '1 of 5 rays passed all 3 elements.' in lines, lines[-4:]
    assert any(re.match(r'element 1 \(sphere\): .*1 clipped', line) for line in lines), lines[-4:]
    free = rows('trace', lens, '--rays', '-', '--no-apertures', stdin=text)
    equal([r['fate'] for r in free if r['ray'] == '1'][0], 'passed')


def test_total_reflection():
    lens = written('object: {index: 1.5}\nsurfaces:\n  - {type: plane, index: 1}\n')
    row, = rows('trace', lens, '--rays', '-', stdin=rays((0, 0, -1, 0, 1, 1)))
    equal((row['fate'], row['status']), ('tir', 'hit'))
    close(row['opl'], 1.5 * math.sqrt(2), 1e-15)
    assert '1 totally reflected' in run('trace', lens, '--rays', '-', stdin=rays((0, 0, -1, 0, 1, 1))).stdout


def test_decenter_and_tilt_move_one_element_only():
    lens = written('''surfaces:
  - {type: plane, thickness: 10}
  - {type: plane, thickness: 10, decenter: [0, 1, 2], tilt: [30, 0, 0]}
  - {type: plane}
''')
    local = rows('trace', lens, '--rays', '-', stdin=rays((0, 3, -5, 0, 0, 1)))
    everywhere = rows('trace', lens, '--rays', '-', '--frame', 'global', stdin=rays((0, 3, -5, 0, 0, 1)))
    # the plane through (0, 1, 12) with the normal (0, -sin 30, cos 30): z = 12 + 2 tan 30 at y = 3
    close(everywhere[1]['z'], 12 + 2 * math.tan(math.radians(30)), 1e-14)
    close(everywhere[1]['y'], 3, 1e-15)
    close(local[1]['y'], 2 / math.cos(math.radians(30)), 1e-14)
    close(local[1]['m'], math.sin(math.radians(30)), 1e-15)
    close(local[1]['z'], 0, 1e-15)
    close(everywhere[1]['m'], 0, 1e-15)
    close(local[2]['y'], 3, 1e-14)
    equal(everywhere[2]['z'], '20')


def test_places_given_outright():
    """A flat mirror at 45 degrees sends light up to a plane that faces down."""
    lens = written('''surfaces:
  - {type: plane, origin: [0, 0, 10], tilt: [45, 0, 0], mirror: true}
  - {type: plane, origin: [0, 7, 10], tilt: [-90, 0, 0]}
''')
    got = rows('trace', lens, '--rays', '-', '--frame', 'global', stdin=rays((1, 0.5, 0, 0, 0, 1)))
    close(got[0]['m'], 1, 1e-15)
    close(got[0]['z'], 10.5, 1e-14)
    close(got[1]['y'], 7, 1e-14)
    close(got[1]['x'], 1, 0)


def test_newtonian():
    """On the axis a paraboloid makes a point, by paths of one length; the flat sends it out to +y."""
    got = [r for r in rows('trace', LENSES / 'newtonian.yaml', '--field', '0', '--grid', '9') if r['element'] == '3']
    for row in got:
        close(row['x'], 0, 1e-12)
        close(row['y'], 0, 1e-12)
        close(row['opl'], got[0]['opl'], 1e-12 * 1600)
    place = rows('trace', LENSES / 'newtonian.yaml', '--field', '0', '--fan', '2', '--frame', 'global')[2]
    close(place['y'], 180, 1e-11)
    close(place['z'], -620, 1e-11)


def test_lens_of_the_manual():
    text = (LENSES.parent.parent / 'docs' / 'lens_file.md').read_text()
    lens = written(re.search(r'```yaml\n(.*?)```', text, re.DOTALL).group(1))
    done = run('trace', lens, '--wavelength', '2')
    assert '10 of 10 rays passed all 4 elements.' in done.stdout, done.stdout[-300:]


def test_index_of_a_mirror_and_of_nothing():
    """index may stand on a mirror if it is the one in front; `glass: same` and a mirror keep what is in front."""
    lens = written('''surfaces:
  - {type: plane, thickness: 3, index: 1.5}
  - {type: plane, thickness: -2, mirror: true, index: 1.5}
  - {type: plane, thickness: -1, glass: same}
  - {type: plane, index: 1}
''')
    got = rows('trace', lens, '--rays', '-', stdin=rays((0, 0, -1, 0, 0, 1)))
    equal([r['opl'] for r in got], ['1', '5.5', '8.5', '10'])
    equal([r['n'] for r in got], ['1', '-1', '-1', '-1'])


def test_json_and_ids():
    text = rays((0, 0, -1, 0, 0, 1, 'chief'), (0, 9, -1, 0, 0, 1, '9'), header='ox,oy,oz,dx,dy,dz,id')
    shown = ('trace', LENSES / 'ftheta.yaml', '--rays', '-', '--format', 'json')
    got = json.loads(run(*shown, stdin=text).stdout)
    equal(list(got[0]), TRACE_ALL.split(',') + ['id'])
    equal((got[0]['id'], got[-1]['id'], got[-1]['l'], got[-1]['fate']), ('chief', '9', None, 'clipped'))


def test_one_index_for_many_wavelengths_and_json_lens():
    lens = written(json.dumps({'name': 'j', 'wavelengths': [0.5, 0.6], 'object': {'distance': '.inf'}, 'pupil': {'semi_diameter': 1},
                               'surfaces': [{'type': 'sphere', 'radius': 1e1, 'index': [1.5, 1.4], 'thickness': 0}, {'type': 'plane', 'stop': False}]}))
    equal(len(rows('trace', lens, '--wavelength', '2')), 10)


def test_undecided_is_exit_1():
    lens = written('pupil: {semi_diameter: 9}\nsurfaces:\n  - {type: even_asphere, radius: 20, coefficients: [-2e-4, -5e-6, -6e-8]}\n')
    got = rows('trace', lens, '--field', '5', '--max-evals', '1', exit=UNDECIDED)
    assert any(r['fate'] == 'lost' and r['status'] == 'exhausted' for r in got)
    assert 'lost (exhausted)' in run('trace', lens, '--field', '5', '--max-evals', '1', exit=UNDECIDED).stdout


main(globals())
