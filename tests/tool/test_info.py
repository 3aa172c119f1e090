#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sagitta info: first-order data and Seidel sums.

    python3 test_info.py SAGITTA

The oracles: first-order data of lens files at 20 digits (tests/data/zmx/first_order.json, see the README there);
a published table of Seidel sums; and for random lenses, paraxial matrices in mpmath, and the wavefront itself,
whose expansion in the fields and the pupil has the Seidel sums as its fourth-order terms.
"""
import json
import math
import os
import random
from fractions import Fraction

import mpmath

from command import *

ZMX = HERE.parent / 'data' / 'zmx'
SEED = 20261124
SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))


def info(path, *options):
    return json.loads(run('info', path, '--format', 'json', *options).stdout)


def flat(path, *options):
    """The object with the names of csv, whose numbers are the same."""
    got = info(path, *options)
    for pupil in ('entrance', 'exit'):
        for name, value in got.pop(pupil + '_pupil').items():
            got[f'{pupil}_pupil.{name}'] = value
    got['image_height'] = max(got['image_height'], key=lambda x: x or 0)
    return got


def test_files():
    """Ten files as people have them; null: what an afocal system lacks."""
    for name, wanted in json.loads((ZMX / 'first_order.json').read_text()).items():
        got = flat(ZMX / name)
        for key, value in wanted.items():
            if value is None:
                equal(got[key], None, (name, key))
            else:
                close(got[key], value, 1e-9 * max(1, abs(float(value))), (name, key))


# A triplet attributed to Geiser, from J. Sasian's course Lens Design (OPTI 517, University of Arizona), as the
# documentation of ray-optics has it (M. J. Hayford, docs/examples/TripletExample, with its Seidel sums).
TRIPLET = {'wavelengths': [0.5875618, 0.4861327, 0.6562725], 'pupil': {'semi_diameter': 6.25}, 'fields': [0, 20],
           'makers': ['SCHOTT'], 'surfaces': [
    {'type': 'sphere', 'radius': 23.713, 'thickness': 4.831, 'glass': 'N-LAK9'},
    {'type': 'sphere', 'radius': 7331.288, 'thickness': 5.86, 'glass': 'air'},
    {'type': 'sphere', 'radius': -24.456, 'thickness': 0.975, 'glass': 'N-SF5', 'stop': True},
    {'type': 'sphere', 'radius': 21.896, 'thickness': 4.822, 'glass': 'air'},
    {'type': 'sphere', 'radius': 86.759, 'thickness': 3.127, 'glass': 'N-LAK9'},
    {'type': 'sphere', 'radius': -20.4942, 'thickness': 41.2365, 'glass': 'air'},
    {'type': 'plane'}]}
SEIDEL = [(0.027654, 0.019379, 0.013581, 0.089174, 0.072010), (0.022082, -0.059501, 0.160327, -0.000288, -0.431229),
          (-0.105156, 0.137692, -0.180295, -0.085097, 0.347506), (-0.045358, -0.076796, -0.130024, -0.095046, -0.381069),
          (0.007942, 0.028382, 0.101431, 0.024373, 0.449596), (0.103810, -0.050068, 0.024148, 0.103180, -0.061411),
          (0, 0, 0, 0, 0), (0.010973, -0.000912, -0.010832, 0.036297, -0.004597)]
SUMS = ('spherical', 'coma', 'astigmatism', 'petzval', 'distortion')


def test_published_seidel_sums():
    path = written(json.dumps(TRIPLET))
    for row, wanted in zip(rows('info', path, '--seidel'), SEIDEL):
        for key, value in zip(SUMS, wanted):
            close(row[key], value, 0.6e-6, (row['surface'], key))
    got = flat(path)
    for key, value, within in (('efl', 50, 0.5), ('ffd', -37.1, 0.05), ('bfd', 41.24, 0.005), ('f_number', 4, 0.05),
                               ('entrance_pupil.z', 11.68, 0.005), ('exit_pupil.z', -10.01 - 41.24, 0.01),
                               ('exit_pupil.radius', 6.406, 5e-4), ('image_height', 18.2, 0.05), ('front_principal', 12.9, 0.05),
                               ('rear_principal', 41.24 - 50.0 - 41.2365, 0.05)):
        close(got[key], value, within, key)


# ---------------------------------------------------------------- the object

CONTRACT = ['name', 'units', 'wavelength', 'efl', 'bfd', 'ffd', 'f_number', 'f_number_working', 'magnification',
            'entrance_pupil', 'exit_pupil', 'image_height', 'petzval_radius', 'lagrange', 'fields', 'wavelengths',
            'surfaces', 'parabasal']
DOUBLET = {'name': 'a "doublet"', 'units': 'mm', 'wavelengths': [0.5875618, 0.4861327, 0.6562725], 'primary': 1,
           'pupil': {'semi_diameter': 4}, 'fields': [[0, 0], [3, -4], 2], 'field_weights': [1, 2, 0.5], 'surfaces': [
    {'type': 'sphere', 'radius': 40, 'thickness': 4, 'glass': 'N-BK7'},
    {'type': 'sphere', 'radius': -30, 'thickness': 2, 'glass': 'N-SF2', 'stop': True},
    {'type': 'plane', 'thickness': 50, 'glass': 'air'}, {'type': 'plane'}]}


def test_the_object():
    """Its names, and that each is there and is what the file says; csv has the same bits."""
    path = written(json.dumps(DOUBLET))
    got = info(path)
    equal(list(got)[:len(CONTRACT)], CONTRACT)
    equal([got[k] for k in ('name', 'units', 'wavelength', 'surfaces', 'stop', 'magnification')],
          ['a "doublet"', 'mm', 0.5875618, 4, 2, None])
    equal(got['wavelengths'], DOUBLET['wavelengths'])
    equal(got['fields'], [{'x': x, 'y': y, 'kind': 'angle', 'weight': w} for x, y, w in ((0, 0, 1), (3, -4, 2), (0, 2, 0.5))])
    equal([set(got[k]) for k in ('entrance_pupil', 'exit_pupil')], [{'z', 'radius'}] * 2)
    same, row = flat(path), rows('info', path)[0]
    for key, value in row.items():
        equal(math.nan if same[key] is None else same[key], float(value), key) if value != 'nan' else equal(same[key], None, key)
    equal(len([k for k in row if row[k] == 'nan']), 1)
    # several wavelengths are a list, one is not, however it is asked for
    each = info(path, '--wavelength', 'all')
    equal([o['wavelength'] for o in each], DOUBLET['wavelengths'])
    equal(each[0], got)
    equal(info(path, '--wavelength', 'F'), each[1])
    equal(info(path, '--wavelength', 'F', '--wavelength', '3'), each[1:])
    equal(info(written(json.dumps({**DOUBLET, 'wavelengths': [0.5875618]})), '--wavelength', 'all')[0]['efl'], got['efl'])
    # the options that choose a table choose none here; hexadecimal numbers are words
    equal(info(path, '--seidel'), got), equal(info(path, '--parabasal'), got)
    equal(float.fromhex(info(path, '--hex')['efl']), got['efl'])
    out = path.parent / 'out.json'
    run('info', path, '--format', 'json', '--output', out)
    equal(json.loads(out.read_text()), got)
    assert 'would be written over' in run('info', path, '--format', 'json', '--output', path, exit=USAGE).stderr
    # nothing is said of what is not given
    bare = {'surfaces': [{'type': 'plane', 'thickness': 3}, {'type': 'plane'}]}
    got = info(written(json.dumps(bare)))
    equal([got[k] for k in ('name', 'units', 'wavelength', 'wavelengths', 'image_height', 'parabasal', 'seidel', 'seidel_sum')],
          [None, None, None, [], [None], None, None, None])
    equal(got['entrance_pupil'], {'z': 0, 'radius': None})
    assert 'pupil has no size' in got['parabasal_why_not'] and got['seidel_why_not'], got


def test_image_heights():
    """Of each kind of field: f tan of the angle to the axis, and object heights by the magnification."""
    mpmath.mp.dps = 30
    m, n = mpmath.eye(2), mpmath.mpf(1)
    lens = {'pupil': {'semi_diameter': 1}, 'surfaces': [
        {'type': 'sphere', 'radius': 30, 'thickness': 5, 'index': 1.6, 'stop': True},
        {'type': 'sphere', 'radius': -45, 'thickness': 50, 'index': 1.2}, {'type': 'plane'}]}
    for s in lens['surfaces'][:2]:
        m = mpmath.matrix([[1, 0], [-(s['index'] - n) / mpmath.mpf(s['radius']), 1]]) * m
        n = mpmath.mpf(s['index'])
        if s is lens['surfaces'][0]:
            m = mpmath.matrix([[1, 5 / n], [0, 1]]) * m
    fields = [[0, 0], [3, -4], [0, 2], [-1, 0]]
    tangents = [mpmath.hypot(*(mpmath.tan(mpmath.radians(a)) for a in f)) for f in fields]
    heights = [mpmath.hypot(*f) for f in fields]
    near = 1 / (m[1, 0] * 200 + m[1, 1])
    for change, wanted in (
            ({}, [-t / m[1, 0] for t in tangents]),
            ({'object': {'distance': 200}}, [abs(near) * 200 * t for t in tangents]),
            ({'object': {'distance': 200}, 'field_type': 'object_height'}, [abs(near) * h for h in heights]),
            ({'object': {'distance': 200}, 'field_type': 'paraxial_image_height'}, heights),
            ({'field_type': 'paraxial_image_height'}, heights)):
        got = info(written(json.dumps({**lens, **change, 'fields': fields})))
        equal(len(got['image_height']), 4)
        for a, b in zip(got['image_height'], wanted):
            close(a, b, 1e-13 * 20, change)
        equal({f['kind'] for f in got['fields']}, {change.get('field_type', 'angle')})


def test_sums_and_chief_rays_of_the_object():
    """They are those of the tables, and a reason stands where there are none."""
    path = written(json.dumps(TRIPLET))
    got = info(path)
    *table, total = rows('info', path, '--seidel')
    equal(len(got['seidel']), got['surfaces'])
    for number, (a, b, wanted) in enumerate(zip(got['seidel'] + [got['seidel_sum']], table + [total], SEIDEL), 1):
        equal([a[k] for k in (*SUMS, 'axial', 'lateral')], [float(b[k]) for k in (*SUMS, 'axial', 'lateral')])
        equal((a.get('surface'), a.get('type')), (number, b['type']) if number < 8 else (None, None))
        for key, value in zip(SUMS, wanted):
            close(a[key], value, 0.6e-6, (number, key))
    equal([got['seidel_why_not'], got['parabasal_why_not']], [None, None])
    for field, row in zip(got['parabasal']['fields'], rows('info', path, '--parabasal')):
        equal(field.pop('why_not'), None)
        equal({k: 'nan' if v is None else float(v) for k, v in field.items()},
              {k: v if v == 'nan' else float(v) for k, v in row.items()})
    # a field whose chief ray misses the second surface: the others are there
    ball = {'pupil': {'semi_diameter': 0.1}, 'fields': [0, 80], 'surfaces': [
        {'type': 'plane', 'thickness': 10, 'stop': True},
        {'type': 'sphere', 'radius': 5, 'thickness': 10, 'index': 1.5}, {'type': 'plane'}]}
    path = written(json.dumps(ball))
    done = run('info', path, '--format', 'json')
    first, second = json.loads(done.stdout)['parabasal']['fields']
    equal((first['why_not'], second['why_not'], second['efl_x']), (None, 'the chief ray does not get through surface 2', None))
    close(first['efl_x'], 10, 1e-12)
    equal(done.stderr, '')
    assert 'field 2: the chief ray does not get through surface 2' in run('info', path, '--parabasal').stderr
    # of a real image height that no ray has there is no chief ray, and the rest is there
    far = {**ball, 'fields': [1000], 'field_type': 'real_image_height'}
    got = info(written(json.dumps(far)))
    equal(got['parabasal'], None)
    assert 'no chief ray was found that meets the image at [0, 1000]' in got['parabasal_why_not'], got['parabasal_why_not']
    close(got['efl'], 10, 1e-12)


# ------------------------------------------------------------- random lenses

def drawn(draw):
    """A lens of a few spheres, conics and even aspheres, perhaps with a mirror; its object afar or near."""
    surfaces, n = [], 1.0
    for i in range(draw.randrange(2, 6)):
        s = {'type': draw.choice(['sphere', 'conic', 'even_asphere']),
             'radius': draw.choice([-1, 1]) * draw.uniform(30, 200), 'thickness': draw.uniform(2, 9)}
        if s['type'] != 'sphere':
            s['conic'] = draw.uniform(-2, 1)
        if s['type'] == 'even_asphere':
            s['coefficients'] = [draw.uniform(-1e-3, 1e-3), draw.uniform(-1e-6, 1e-6)]
        n = draw.uniform(1.4, 1.9) if n == 1 else 1.0
        s['index'] = n
        surfaces.append(s)
    surfaces[-1]['index'] = 1.0
    surfaces[draw.randrange(len(surfaces))]['stop'] = True
    surfaces.append({'type': 'plane'})
    near = draw.random() < 0.4
    return {'object': {'distance': 150.0 if near else '.inf'}, 'pupil': {'semi_diameter': 5.0}, 'fields': [0, 4],
            'surfaces': surfaces}


def with_ideal(draw, lens):
    """An ideal lens somewhere among its surfaces, in their medium or with one of its own in front of the next."""
    ideal = {'type': 'ideal', 'focal_length': draw.choice((-1, 1)) * draw.uniform(60, 200), 'thickness': draw.uniform(1, 6)}
    if draw.random() < 0.5:
        ideal['index'] = draw.uniform(1.1, 1.8)
    else:
        ideal['glass'] = 'same'
    lens['surfaces'].insert(draw.randrange(len(lens['surfaces']) - 1), ideal)
    return lens


def vertices(lens):
    """(curvature, power, n behind, thickness, fourth-order coefficient beyond the sphere) of each surface."""
    out, n = [], mpmath.mpf(1)
    for s in lens['surfaces']:
        c = 1 / mpmath.mpf(s['radius']) if 'radius' in s else mpmath.mpf(0)
        a2, a4 = (*map(mpmath.mpf, s.get('coefficients', ())), 0, 0)[:2]
        sphere = c + 2 * a2
        fourth = (1 + mpmath.mpf(s.get('conic', 0))) * c ** 3 / 8 + a4
        behind = mpmath.mpf(s.get('index', n))
        power = 1 / mpmath.mpf(s['focal_length']) if 'focal_length' in s else sphere * (behind - n)
        out.append((sphere, power, behind, mpmath.mpf(s.get('thickness', 0)), fourth))
        n = behind
    return out


def test_random_lenses():
    """Focal length, foci, pupils and magnification by products of matrices at 30 digits."""
    mpmath.mp.dps = 30
    draw = random.Random(SEED)
    print(f'       seed {SEED}')
    for case in range(60):
        lens = drawn(draw)
        if case >= 40:
            lens = with_ideal(draw, lens)
        got = flat(written(json.dumps(lens)))
        v, stop = vertices(lens), [bool(s.get('stop')) for s in lens['surfaces']].index(True)

        def matrix(first, end, transfers):
            m, n = mpmath.eye(2), v[first - 1][2] if first else mpmath.mpf(1)
            for i in range(first, end):
                m = mpmath.matrix([[1, 0], [-v[i][1], 1]]) * m
                n = v[i][2]
                if i - first < transfers:
                    m = mpmath.matrix([[1, v[i][3] / n], [0, 1]]) * m
            return m

        last = len(v) - 1
        m = matrix(0, last, last - 1)
        efl = -1 / m[1, 0]
        front = matrix(0, stop, stop)
        pupil = front[0, 1] / front[0, 0]
        rear = matrix(stop, last, last - stop)
        close(got['efl'], efl, 1e-12 * abs(efl), case)
        close(got['bfd'], m[0, 0] * efl, 1e-11 * abs(efl), case)
        close(got['ffd'], -m[1, 1] * efl, 1e-11 * abs(efl), case)
        close(got['entrance_pupil.z'], pupil, 1e-12 * (1 + abs(pupil)), case)
        exit = -rear[0, 1] / rear[1, 1]
        close(got['exit_pupil.z'], exit, 1e-11 * (1 + abs(exit)), case)
        distance = lens['object']['distance']
        if distance == '.inf':
            equal(got['magnification'], None, case)
        else:
            w = m[1, 0] * distance + m[1, 1]
            close(got['magnification'], 1 / w, 1e-12 / abs(w), case)


def refracted(d, normal, n1, n2):
    cosine = sum(a * b for a, b in zip(d, normal))
    if cosine < 0:
        normal, cosine = [-x for x in normal], -cosine
    r = n1 / n2
    root = mpmath.sqrt(1 - r * r * (1 - cosine * cosine))
    return [r * a + (root - r * cosine) * b for a, b in zip(d, normal)]


def through(lens, origin, d):
    """The last point and direction of a real ray, by Newton's method on the sag."""
    v, n, z = vertices(lens), mpmath.mpf(1), mpmath.mpf(0)
    p = list(origin)
    for s, vertex in zip(lens['surfaces'], v):
        c = 1 / mpmath.mpf(s['radius']) if 'radius' in s else mpmath.mpf(0)
        k = mpmath.mpf(s.get('conic', 0))
        a2, a4 = (*map(mpmath.mpf, s.get('coefficients', ())), 0, 0)[:2]

        def sag(r2):
            root = mpmath.sqrt(1 - (1 + k) * c * c * r2)
            return c * r2 / (1 + root) + a2 * r2 + a4 * r2 * r2, c / root / 2 + a2 + 2 * a4 * r2

        t = (z - p[2]) / d[2]
        for _ in range(40):
            x, y = p[0] + t * d[0], p[1] + t * d[1]
            height, slope = sag(x * x + y * y)
            f = p[2] + t * d[2] - z - height
            t -= f / (d[2] - 2 * slope * (x * d[0] + y * d[1]))
        p = [a + t * b for a, b in zip(p, d)]
        _, slope = sag(p[0] ** 2 + p[1] ** 2)
        normal = [-2 * slope * p[0], -2 * slope * p[1], mpmath.mpf(1)]
        length = mpmath.sqrt(sum(x * x for x in normal))
        if 'focal_length' in s:
            slopes = [(n * a / d[2] - x / mpmath.mpf(s['focal_length'])) / vertex[2] for a, x in zip(d, p[:2])]
            length = mpmath.sqrt(1 + slopes[0] ** 2 + slopes[1] ** 2)
            d = [slopes[0] / length, slopes[1] / length, 1 / length]
        else:
            d = refracted(d, [x / length for x in normal], n, vertex[2])
        n, z = vertex[2], z + vertex[3]
    return p, d


def test_seidel_sums_of_random_lenses():
    """Real rays of a small pupil and field land beside the paraxial image by the transverse aberrations of the third
    order, which are the Seidel sums over 2 n'u' (Welford 1986, 8.3).  Halving pupil and field leaves a fourth part of
    what remains, so three halvings and an extrapolation give the sums to some digits."""
    mpmath.mp.dps = 40
    draw = random.Random(SEED + 1)
    for case in range(10):
        lens = drawn(draw)
        if case >= 6:
            lens = with_ideal(draw, lens)
        lens['object'] = {'distance': '.inf'}
        got = flat(written(json.dumps(lens)))
        lens['surfaces'][-2]['thickness'] += got['image']       # to the paraxial image
        path = written(json.dumps(lens))
        total = rows('info', path, '--seidel')[-1]
        got = flat(path)
        slope = mpmath.tan(mpmath.radians(4))
        marginal = -5 / mpmath.mpf(got['efl'])                  # n'u'
        measured = {}
        for px, py, h in ((0, 1, 0), (0, 1, 1), (0, -1, 1), (1, 0, 1), (0, 0, 1)):
            steps = []
            for i in range(4):
                e = mpmath.mpf(2) ** -(5 + i)
                d = [mpmath.mpf(0), h * e * slope, mpmath.mpf(1)]
                length = mpmath.sqrt(sum(x * x for x in d))
                z = -mpmath.mpf(30)
                pupil = mpmath.mpf(got['entrance_pupil.z'])
                start = [px * e * 5, py * e * 5 + (z - pupil) * d[1], z]
                p, _ = through(lens, start, [x / length for x in d])
                ideal = h * e * slope * mpmath.mpf(got['efl'])
                steps.append(((p[0]) / e ** 3, (p[1] - ideal) / e ** 3))
            for order in range(3):
                steps = [tuple((4 ** (order + 1) * b - a) / (4 ** (order + 1) - 1) for a, b in zip(s, t))
                         for s, t in zip(steps, steps[1:])]
            measured[px, py, h] = steps[-1]
        # y of (0, py, h): [S1 py^3 + 3 S2 py^2 h + (3 S3 + S4) py h^2 + S5 h^3] / (2 n'u')
        s1, s2, s3, s4, s5 = (mpmath.mpf(total[k]) for k in SUMS)
        scale = max(map(abs, (s1, s2, s3, s4, s5)))
        for (px, py, h), (x, y) in measured.items():
            wanted_y = (s1 * py * (px * px + py * py) + s2 * h * (3 * py * py + px * px) +
                        (3 * s3 + s4) * h * h * py + s5 * h ** 3) / (2 * marginal)
            wanted_x = (s1 * px * (px * px + py * py) + 2 * s2 * h * px * py + (s3 + s4) * h * h * px) / (2 * marginal)
            for a, b in ((x, wanted_x), (y, wanted_y)):
                assert abs(abs(a) - abs(b)) < 1e-6 * scale / abs(marginal), (case, px, py, h, a, b)
                assert abs(a - b) < 1e-6 * scale / abs(marginal), ('sign', case, px, py, h, a, b)


# ------------------------------------------------------- along the chief ray

MIRROR = '  GLAS MIRROR 0 0\n'


def surface(number, thickness, more='', kind='STANDARD', curvature=0.0):
    return f'SURF {number}\n  TYPE {kind}\n{more}  CURV {curvature!r}\n  DISZ {thickness!r}\n'


def folded(field, *surfaces):
    head = f'MODE SEQ\nENPD 10\nFTYP 0 0 1 1\nYFLN {field}\nWAVM 1 0.55 1\nPWAV 1\n'
    return (head + 'SURF 0\n  DISZ INFINITY\n' + ''.join(surfaces)).encode()


def freeform(field):
    """Three mirrors with polynomials of x^2, y, y^2 and x^2 y, tilted and displaced in the y-z plane."""
    def tilt(number, degrees, thickness, dy=0.0):
        return surface(number, thickness, f'  PARM 2 {dy}\n  PARM 3 {degrees}\n', 'COORDBRK')

    def mirror(number, curvature, terms):
        data = ''.join(f'  XDAT {i} {v!r} 0 0\n' for i, v in enumerate([9, 50.0, *terms], 1))
        return surface(number, 0.0, MIRROR + data, 'XPOLYNOM', curvature)
    return folded(field, surface(1, 60.0, '  STOP\n'),
                  tilt(2, 12.0, 0.0), mirror(3, -0.004, [0, 0.02, 0.5, 0, 0.3, 0, 0.05, 0, -0.02]), tilt(4, 11.0, -80.0),
                  tilt(5, -20.0, 0.0, 1.5), mirror(6, -0.006, [0, 0, -0.4, 0, 0.2, 0, 0, 0, 0.03]), tilt(7, -19.0, 90.0),
                  tilt(8, 15.0, 0.0), mirror(9, -0.008, [0, 0, 0.1, 0, -0.3, 0, 0.02, 0, 0]), tilt(10, 14.0, -70.0),
                  surface(11, 0.0)), 3


def cassegrain(field):
    return folded(field, surface(1, 100.0, '  STOP\n'), surface(2, -70.0, MIRROR + '  CONI -1\n', curvature=-0.005),
                  surface(3, 90.0, MIRROR + '  CONI -2.5\n', curvature=-0.012), surface(4, 0.0)), 2


def off_axis_parabola(field):
    return (ZMX / 'ray-optics__zmax_37992__40b107.zmx').read_bytes(), 1


def test_quiet():
    """No remarks, and no notes on what the numbers leave out."""
    told = 0
    for path in sorted(LENSES.glob('*.yaml')):
        said, quiet = run('info', path), run('info', path, '--quiet')
        equal((quiet.stdout, quiet.stderr), (said.stdout, ''), path.name)
        told += 'do not count in these data' in said.stderr
    assert told >= 1, told


def test_parabasal():
    """Against finite differences of rays traced at 50 digits: the section across the plane of symmetry is x's."""
    sys.path.insert(0, str(HERE.parent / 'lens'))
    import zmx_oracle
    D = zmx_oracle.D
    for make in (cassegrain, off_axis_parabola, freeform):
        for field in ((0.0, 0.7) if make is not off_axis_parabola else (0.0,)):
            data, mirrors = make(field)
            row = rows('info', written(data, 'lens.zmx'), '--parabasal')[0]
            lens = zmx_oracle.Lens(data)
            angle = mpmath.radians(mpmath.mpf(field))
            mpmath.mp.dps = 50
            d = [D(0), D(mpmath.nstr(mpmath.sin(angle), 45)), D(mpmath.nstr(mpmath.cos(angle), 45))]
            h = D('1e-20')
            ex, ey = [D(1), D(0), D(0)], [D(0), d[2], -d[1]]

            def end(origin, direction):
                length = sum(v * v for v in direction).sqrt()
                last = lens.trace(origin, [v / length for v in direction], lens.wavelengths[0], apertures=False)[-1]
                equal(last.fate, 'passed')
                return last.everywhere, last.direction

            start = [-10 * v for v in d]
            p0, d0 = end(start, d)
            sign = (-1) ** mirrors
            ey_end = [D(0), sign * d0[2], -sign * d0[1]]    # d' x ex, reflected
            for name, base, base_end in (('x', ex, ex), ('y', ey, ey_end)):
                p, q = end([o + h * e for o, e in zip(start, base)], d)
                a = sum((u - v) * e for u, v, e in zip(p, p0, base_end)) / h
                c = sum((u - v) * e for u, v, e in zip(q, d0, base_end)) / h
                what = (make.__name__, field, name)
                close(row['efl_' + name], -1 / c, 1e-9 * abs(float(1 / c)), what)
                close(row['focus_' + name], -a / c, 1e-9 * abs(float(1 / c)), what)
            close(row['power_xy'], 0, 1e-12)


def test_parabasal_on_the_axis():
    """On the axis of a centred lens both sections are the paraxial data; of an object at a distance the image too."""
    draw = random.Random(SEED + 2)
    for case in range(20):
        lens = drawn(draw)
        lens['fields'] = [0]
        path = written(json.dumps(lens))
        plain, along = flat(path), rows('info', path, '--parabasal')[0]
        for name in 'xy':
            close(along['efl_' + name], plain['efl'], 1e-11 * abs(plain['efl']), case)
            close(along['focus_' + name], plain['focus'], 1e-10 * abs(plain['efl']), case)
            close(along['image_' + name], plain['image'], 1e-10 * (abs(plain['image']) + abs(plain['efl'])), case)
            if plain['magnification'] is not None:
                close(along['magnification_' + name], plain['magnification'], 1e-9 * abs(plain['magnification']), case)


def test_colour():
    """Axial and lateral colour: the paraxial rays at the two wavelengths, in the limit of a small change of index."""
    lens = json.loads(json.dumps(TRIPLET))
    total = rows('info', written(json.dumps(lens)), '--seidel')[-1]
    # the sums with the sign of Welford: axial W = sum / 2; the foci of F and C differ by sum / (n'u'^2)
    red, blue = flat(written(json.dumps(lens)), '--wavelength', 'C'), flat(written(json.dumps(lens)), '--wavelength', 'F')
    marginal = 6.25 / 50
    close(blue['focus'] - red['focus'], -float(total['axial']) / marginal ** 2, 0.1 * abs(blue['focus'] - red['focus']) + 2e-3)


def test_said_to_be_afocal():
    """An afocal lens says so, in text and in json; a lens without power that does not say it is none."""
    plain = {'pupil': {'semi_diameter': 1}, 'surfaces': [{'type': 'plane', 'thickness': 3}, {'type': 'plane'}]}
    for lens, afocal in ((plain, False), ({**plain, 'afocal': False}, False), ({**plain, 'afocal': True}, True)):
        path = written(json.dumps(lens))
        equal(info(path)['afocal'], afocal)
        equal('Afocal: light leaves as parallel rays.' in run('info', path).stdout, afocal)


def exact_power(lens, size):
    """Of the doubles of a lens in air, exactly; with size, the same of the sizes of all terms: no bound of what
    half an ulp of each number and each rounding changes is less than u times that, or more than some 100 u."""
    y, w, n, z = Fraction(1), Fraction(0), Fraction(1), Fraction(0)
    for s in lens['surfaces']:
        behind = Fraction(s.get('index', n))
        if 'focal_length' in s:
            power = 1 / Fraction(s['focal_length'])
        else:
            c = 1 / Fraction(s['radius']) if 'radius' in s else Fraction(0)
            power = c * ((behind + n if behind != n else 0) if size else behind - n)
        w = w + abs(power) * y if size else w - y * power
        n, t = behind, Fraction(s.get('thickness', 0))
        y += (z + abs(t) if size else t) * w / n
        z += abs(t)
    return abs(w)


def afocal(random):
    """Two lenses, each of one to three thick elements or an ideal one, so far apart that a beam leaves as it came, to
    the rounding of the last thickness."""
    scale = 10 ** random.uniform(-6, 6)
    surfaces, relay = [], random.random() < 0.3
    for half in range(2):
        for _ in range(1 if relay else random.randint(1, 3)):
            if relay:
                surfaces.append({'type': 'ideal', 'focal_length': scale * random.uniform(0.3, 3), 'index': 1})
            else:
                r = scale * random.uniform(1, 3) * random.choice((-1, 1))
                surfaces += [{'type': 'sphere', 'radius': r, 'thickness': scale * random.uniform(0.01, 0.3),
                              'index': random.uniform(1.3, 2)},
                             {'type': 'sphere', 'radius': -r * random.uniform(0.5, 2), 'index': 1}]
            surfaces[-1]['thickness'] = scale * random.uniform(0.01, 0.3)
        between = len(surfaces) - 1 if not half else between
    lens = {'pupil': {'semi_diameter': scale * 0.01}, 'surfaces': surfaces + [{'type': 'plane'}]}

    def power(t):
        surfaces[between]['thickness'] = t
        y, w, n = Fraction(1), Fraction(0), Fraction(1)
        for s in surfaces:
            behind = Fraction(s['index'])
            w -= y / Fraction(s['focal_length']) if 'focal_length' in s else y * (behind - n) / Fraction(s['radius'])
            n = behind
            y += Fraction(s['thickness']) * w / n
        return w

    at0, at1 = power(Fraction(0)), power(Fraction(1))  # linear in it
    if at1 == at0:
        return afocal(random)
    t = -at0 / (at1 - at0)
    if not scale * 1e-3 < abs(t) < scale * 1e3:
        return afocal(random)
    surfaces[between]['thickness'] = float(t)
    return lens, between


def test_afocal():
    """Afocal but for rounding: no focal length, at each scale.  The same, one distance changed by more than rounding:
    it has the power that its doubles have."""
    draw, u, seen = random.Random(SEED), Fraction(1, 2 ** 53), 0
    for case in range(max(8, int(60 * SCALE))):
        lens, between = afocal(draw)
        size = exact_power(lens, True)
        assert exact_power(lens, False) <= 2 * u * size
        path = written(json.dumps(lens))
        got = info(path)
        for key in ('efl', 'efl_image', 'bfd', 'ffd', 'focus', 'image', 'f_number', 'f_number_working', 'front_principal',
                    'rear_principal', 'front_nodal', 'rear_nodal'):
            equal(got[key], None, (key, lens))
        equal(rows('info', path)[0]['efl'], 'nan', lens)
        if case < 5:
            line, = (s for s in run('info', path).stdout.splitlines() if s.startswith('efl '))
            assert line.endswith('none: the lens is afocal, it has no power'), line
        lens['surfaces'][between]['thickness'] *= 1 + draw.choice((-1, 1)) * 10 ** draw.uniform(-14, -6)
        power, size = exact_power(lens, False), exact_power(lens, True)
        if power > 100 * u * size:
            seen += 1
            efl = info(written(json.dumps(lens)))['efl']
            assert efl is not None, lens
            assert abs(1 / abs(Fraction(efl)) - power) <= 100 * u * size, lens
    assert seen > 3, seen
    for _ in range(5):  # plates have none at all
        plates = [{'type': 'plane', 'thickness': draw.uniform(0, 9), 'index': draw.uniform(1, 2)} for _ in range(4)]
        got = info(written(json.dumps({'pupil': {'semi_diameter': 1}, 'surfaces': plates + [{'type': 'plane'}]})))
        equal((got['efl'], got['petzval_radius'], got['focus']), (None, None, None))


def test_what_is_not_there():
    afocal = {'pupil': {'semi_diameter': 1}, 'surfaces': [{'type': 'plane', 'thickness': 3}, {'type': 'plane'}]}
    got = flat(written(json.dumps(afocal)))
    for key in ('efl', 'bfd', 'focus', 'image', 'petzval_radius'):
        equal(got[key], None, key)
    tilted = {'pupil': {'semi_diameter': 1}, 'surfaces': [
        {'type': 'sphere', 'radius': 50, 'index': 1.5, 'thickness': 3, 'tilt': [1, 0, 0]}, {'type': 'plane', 'thickness': 1, 'index': 1}, {'type': 'plane'}]}
    path = written(json.dumps(tilted))
    assert 'no Seidel sums: the lens is not centred' in run('info', path, '--seidel').stderr
    equal(rows('info', path, '--seidel')[-1]['coma'], 'nan')
    close(flat(path)['efl'], 100, 1e-12)  # as of its parent, on the axis
    body = {'pupil': {'semi_diameter': 1, 'distance': 0}, 'surfaces': [
        {'type': 'torus', 'major': 10, 'minor': 2, 'thickness': 3}, {'type': 'plane'}]}
    equal(flat(written(json.dumps(body)))['efl'], None)


def test_text():
    said = run('info', written(json.dumps(TRIPLET)), '--wavelength', 'all').stdout
    assert said.splitlines()[0].split() == ['quantity', 'value', 'value', 'value', 'is'], said
    assert '7 surfaces, stop: surface 3' in said
    assert 'Object: at infinity.  2 fields by angle, in degrees.' in said, said
    for quantity, words in (('magnification', 'none: the object is at infinity'), ('entrance_pupil.z', 'from the first vertex')):
        line, = (s for s in said.splitlines() if s.startswith(quantity + ' '))
        assert line.endswith(words), line
    head = run('info', written(json.dumps(DOUBLET)), '--seidel', '--wavelength', 'F').stdout.splitlines()[0]
    equal(head, 'Seidel sums (wavefront) at 0.4861327 micrometres, lengths in mm.  Axial and lateral colour: '
                'from 0.4861327 to 0.6562725 micrometres.')
    for surfaces, more, reasons in (
            ([{'type': 'plane', 'thickness': 3}, {'type': 'plane'}], {'pupil': {'semi_diameter': 1}},
             {'wavelength': 'the lens gives no wavelengths', 'efl': 'the lens is afocal, it has no power',
              'f_number': 'the lens is afocal, it has no power', 'petzval_radius': 'it is flat'}),
            ([{'type': 'sphere', 'radius': 5, 'index': 1.5, 'thickness': 10}, {'type': 'plane', 'stop': True, 'thickness': 1, 'glass': 'same'},
              {'type': 'plane'}], {},
             {'exit_pupil.radius': 'the lens gives no size of its pupil', 'f_number': 'the lens gives no size of its pupil'}),
            ([{'type': 'torus', 'major': 10, 'minor': 2, 'thickness': 3}, {'type': 'plane'}], {'pupil': {'semi_diameter': 1}},
             {'efl': 'the power of the lens is not known'}),
            ([{'type': 'sphere', 'radius': 5, 'index': 1.5, 'thickness': 15}, {'type': 'plane', 'stop': True, 'thickness': 1, 'glass': 'same'},
              {'type': 'plane'}], {'pupil': {'semi_diameter': 1}}, {'entrance_pupil.z': 'at infinity'})):
        said = run('info', written(json.dumps({'surfaces': surfaces, **more}))).stdout
        for quantity, reason in reasons.items():
            line, = (s for s in said.splitlines() if s.startswith(quantity + ' '))
            assert line.endswith('none: ' + reason) and line.split()[1] == '-', (line, reason)
    run('info', exit=USAGE)
    run('info', written('surfaces: 3'), exit=BAD_INPUT)


main(globals())
