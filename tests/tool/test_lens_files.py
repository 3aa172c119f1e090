#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Lens files: the running frame, pupils and fields, several wavelengths, and `sagitta import` of a lens file.

    python3 test_lens_files.py SAGITTA

Frames are checked against products of 4 x 4 matrices, pupils and fields against matrices of paraxial rays,
each in the manner of their definition and not in that of the command.
"""
import json
import math
import random

from command import *

SEED = 20261123


# ------------------------------------------------------------ the running frame

def times(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def turn(axis, degrees):
    m = [[float(i == j) for j in range(4)] for i in range(4)]
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    m[i][i], m[i][j], m[j][i], m[j][j] = c, -s, s, c
    return m


def shift(x, y, z):
    return [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]]


def broken(decenter, tilt, tilt_first):
    """The matrix of a break: new coordinates to old ones."""
    turns = [turn(i, tilt[i]) for i in range(3)]
    if tilt_first:
        return times(times(times(turns[2], turns[1]), turns[0]), shift(*decenter, 0))
    return times(times(times(shift(*decenter, 0), turns[0]), turns[1]), turns[2])


def test_breaks():
    """Where a plane stands and how it is turned, after random breaks: the point and direction that a ray has in its
    frame, against the inverse of the product of the matrices."""
    draw = random.Random(SEED)
    print(f'       seed {SEED}')
    for case in range(40):
        frame, surfaces = shift(0, 0, 0), []
        for _ in range(draw.randrange(1, 5)):
            decenter = [draw.uniform(-1, 1), draw.uniform(-1, 1)]
            tilt = [draw.choice([0, 45, -90, draw.uniform(-30, 30)]) for _ in range(3)]
            late, thickness = draw.random() < 0.5, draw.uniform(-2, 2)
            surfaces.append({'type': 'break', 'decenter': decenter, 'tilt': tilt, 'thickness': thickness,
                             **({'order': 'tilt_first'} if late else {})})
            frame = times(times(frame, broken(decenter, tilt, late)), shift(0, 0, thickness))
        own = [draw.uniform(-20, 20) for _ in range(3)]
        surfaces.append({'type': 'plane', 'tilt': own, 'decenter': [0.1, -0.2, 0.3]})
        frame = times(frame, shift(0.1, -0.2, 0.3))
        frame = times(times(times(frame, turn(2, own[2])), turn(1, own[1])), turn(0, own[0]))
        # a ray from a point of the frame's own +z or -z side, along its z
        at = [0.7, -0.4, -3.0]
        origin = [sum(frame[i][j] * at[j] for j in range(3)) + frame[i][3] for i in range(3)]
        direction = [frame[i][2] for i in range(3)]
        path = written(json.dumps({'surfaces': surfaces}))
        row, = rows('trace', path, '--rays', '-', stdin=rays((*map(repr, origin + direction),)))
        for key, wanted in zip('xyzlmn', (0.7, -0.4, 0, 0, 0, 1)):
            close(row[key], wanted, 2e-15 * 8, (case, key, row))
        close(row['t'], 3, 1e-14, case)


def test_a_break_undone():
    """Order 1 with all signs changed undoes order 0; a thickness is travelled along the new axis."""
    forth = {'type': 'break', 'decenter': [0.3, -0.2], 'tilt': [12, -7, 31], 'thickness': 0}
    back = {'type': 'break', 'decenter': [-0.3, 0.2], 'tilt': [-12, 7, -31], 'order': 'tilt_first', 'thickness': 5}
    path = written(json.dumps({'surfaces': [forth, back] * 500 + [{'type': 'plane'}]}))
    row, = rows('trace', path, '--rays', '-', stdin=rays((1, 2, -1, 0, 0, 1)))
    for key, wanted in (('x', 1), ('y', 2), ('z', 0), ('l', 0), ('m', 0), ('n', 1), ('t', 2501)):
        close(row[key], wanted, 2e-12, key)


def test_a_fold():
    """A mirror between two breaks of 45 degrees sends light to +y; negative thicknesses after it."""
    fold = {'type': 'break', 'tilt': [45, 0, 0], 'thickness': 0}
    path = written(json.dumps({'surfaces': [
        {'type': 'plane', 'thickness': 10}, fold, {'type': 'plane', 'mirror': True, 'thickness': 0}, fold,
        {'type': 'break', 'thickness': -7}, {'type': 'plane'}]}))
    last = rows('trace', path, '--rays', '-', '--frame', 'global', stdin=rays((0.5, 0.25, -1, 0, 0, 1)))[-1]
    for key, wanted in zip('xyzlmn', (0.5, 7, 10.25, 0, 1, 0)):
        close(last[key], wanted, 4e-15, (key, last))


def test_older_files_mean_what_they_meant():
    """Without a break a tilt moves nothing but its own surface, as ever."""
    lens = {'surfaces': [{'type': 'plane', 'thickness': 10, 'tilt': [30, 0, 0]}, {'type': 'plane'}]}
    last = rows('trace', written(json.dumps(lens)), '--rays', '-', stdin=rays((0.5, 0.25, -1, 0, 0, 1)))[-1]
    for key, wanted in (('x', 0.5), ('y', 0.25), ('z', 0), ('t', 10 - 0.25 * math.tan(math.radians(30)))):
        close(last[key], wanted, 1e-14, key)


# ---------------------------------------------------------- pupils and fields

SINGLET = {'wavelengths': [0.5], 'surfaces': [
    {'type': 'plane', 'thickness': 3},
    {'type': 'sphere', 'radius': 40, 'thickness': 5, 'index': 1.6},
    {'type': 'plane', 'thickness': 4, 'index': 1},
    {'type': 'plane', 'thickness': 60, 'stop': True, 'draw_to': 2.5},
    {'type': 'plane'}]}


def matrix(upto):
    """[[A, B], [C, D]] of (y, n u) from the first vertex to that of a surface of the singlet."""
    def by(p, q):
        return [[sum(p[i][k] * q[k][j] for k in range(2)) for j in range(2)] for i in range(2)]
    m, n = [[1, 0], [0, 1]], 1.0
    for s in SINGLET['surfaces'][:upto]:
        behind = s.get('index', n)
        m = by([[1, 0], [-(behind - n) / s.get('radius', math.inf), 1]], m)
        n = behind
        m = by([[1, s['thickness'] / n], [0, 1]], m)
    return m


def launched(extra, *options, field=(0,)):
    path = written(json.dumps({**SINGLET, **extra}))
    return rows('trace', path, '--fan', 3, *options)


def pupil_of(distance=math.inf, **pupil):
    """The semi-diameter of the entrance pupil as the rays show it: in its plane, where p = B/A."""
    got = launched({'pupil': pupil, 'object': {'distance': distance if distance < math.inf else '.inf'}})
    first = [r for r in got if r['element'] == '1'][-1]
    stop = matrix(3)
    p = stop[0][1] / stop[0][0]
    return float(first['y']) + p * float(first['m']) / float(first['n'])


def test_definitions_of_the_pupil():
    power, stop = -matrix(4)[1][0], matrix(3)
    p = stop[0][1] / stop[0][0]
    for distance in (math.inf, 200.0):
        close(pupil_of(distance, semi_diameter=3), 3, 1e-13)
        close(pupil_of(distance, diameter=6), 3, 1e-13)
        close(pupil_of(distance, image_na=0.05), pupil_of(distance, working_f_number=10), 1e-13)
        close(pupil_of(distance, f_number=10), 1 / power / 20, 1e-12)
        close(pupil_of(distance, stop_size=True), 2.5 / stop[0][0], 1e-12)
    close(pupil_of(working_f_number=10), 1 / power / 20, 1e-12)
    close(pupil_of(200.0, object_na=0.02), math.tan(math.asin(0.02)) * (200 + p), 1e-12)
    close(pupil_of(200.0, object_angle=1.5), math.tan(math.radians(1.5)) * (200 + p), 1e-12)
    slope = matrix(4)[1][0] * 200 + matrix(4)[1][1]  # n'u' of y = 200 u, u = 1
    close(pupil_of(200.0, working_f_number=10), abs((200 + p) / (20 * slope)), 1e-12)


def test_a_stop_seen_through_a_lens():
    """Paraxially the marginal ray of a stop's size meets the stop at its edge."""
    row = [r for r in launched({'pupil': {'stop_size': True, 'distance': 12.0}}) if r['element'] == '4']
    assert 2.4 < float(row[-1]['y']) < 2.6, row


def test_kinds_of_fields():
    power, stop = -matrix(4)[1][0], matrix(3)
    p = stop[0][1] / stop[0][0]
    pupil = {'pupil': {'semi_diameter': 1e-3}}

    def slopes(distance, **fields):
        got = launched({**pupil, 'object': {'distance': distance if distance < math.inf else '.inf'}, **fields})
        middle = [r for r in got if r['element'] == '1' and r['py'] == '0'][0]
        return [float(middle[k]) / float(middle['n']) for k in 'lm']

    for got, wanted in (
            (slopes(math.inf, fields=[[3, -4]]), [math.tan(math.radians(3)), -math.tan(math.radians(4))]),
            (slopes(200.0, fields=[[3, -4]]), [math.tan(math.radians(3)), -math.tan(math.radians(4))]),
            (slopes(200.0, fields=[[3, -4]], field_type='object_height'), [-3 / (200 + p), 4 / (200 + p)]),
            (slopes(math.inf, fields=[2], field_type='paraxial_image_height'), [0, 2 * power])):
        for a, b in zip(got, wanted):
            close(a, b, 1e-14)
    # at finite distance: the object is at h / m, m = 1 / (n'u' of y = D u)
    m = 1 / (matrix(4)[1][0] * 200 + matrix(4)[1][1])
    got = slopes(200.0, fields=[2], field_type='paraxial_image_height')
    close(got[1], -2 / m / (200 + p), 1e-14)


def test_telecentric():
    lens = {'object': {'distance': 50, 'telecentric': True}, 'pupil': {'object_na': 0.1}, 'fields': [0, 3],
            'field_type': 'object_height', 'surfaces': [{'type': 'plane', 'thickness': 1}, {'type': 'plane'}]}
    got = [r for r in rows('trace', written(json.dumps(lens)), '--fan', 3) if r['element'] == '1']
    for r, (height, py) in zip(got, ((h, p) for h in (0, 3) for p in (-1, 0, 1))):
        slope = py * math.tan(math.asin(0.1))
        close(float(r['m']) / float(r['n']), slope, 1e-15, r)
        close(r['y'], height + 50 * slope, 1e-13, r)
    for change, words in (({'pupil': {'semi_diameter': 1}}, 'object_na or object_angle'),
                          ({'object': {'telecentric': True}}, 'must be at a distance'),
                          ({'field_type': 'angle'}, 'object_height')):
        assert words in run('trace', written(json.dumps({**lens, **change})), exit=BAD_INPUT).stderr, words


def test_vignetting():
    """A point x, y of the pupil goes to dx + x (1 - cx), dy + y (1 - cy), turned; px, py are as asked for."""
    draw = random.Random(SEED + 1)
    factors = [{}, {'dy': -0.2, 'cy': 0.3}, {k: draw.uniform(-0.3, 0.3) for k in ('dx', 'dy', 'cx', 'cy')} | {'angle': 30}]
    lens = {'pupil': {'semi_diameter': 2.0}, 'fields': [0, 0, 0], 'vignetting': factors, 'surfaces': [{'type': 'plane'}]}
    for r in rows('trace', written(json.dumps(lens)), '--hexapolar', 2):
        f = {'dx': 0, 'dy': 0, 'cx': 0, 'cy': 0, 'angle': 0} | factors[int(r['field']) - 1]
        z = complex(f['dx'] + float(r['px']) * (1 - f['cx']), f['dy'] + float(r['py']) * (1 - f['cy']))
        z *= 2 * complex(math.cos(math.radians(f['angle'])), math.sin(math.radians(f['angle'])))
        close(r['x'], z.real, 1e-14, r), close(r['y'], z.imag, 1e-14, r)
    lens['vignetting'] = [{}]
    assert 'a map for each field' in run('trace', written(json.dumps(lens)), exit=BAD_INPUT).stderr


# ------------------------------------------------------------------ apertures

SHAPES = [
    ({'type': 'circle', 'radius': 2.0}, lambda z: abs(z) - 2),
    ({'type': 'annulus', 'inner': 1.0, 'outer': 2.5}, lambda z: max(abs(z) - 2.5, 1 - abs(z))),
    ({'type': 'rectangle', 'half_width': 2.0, 'half_height': 1.0}, lambda z: max(abs(z.real) - 2, abs(z.imag) - 1)),
    ({'type': 'ellipse', 'half_width': 2.0, 'half_height': 1.0}, lambda z: abs(complex(z.real, 2 * z.imag)) - 2),
    ({'type': 'polygon', 'points': [[-2, -1], [2, -1], [0, 2]]},  # between y = -1 and two lines of slope 3/2
     lambda z: max(-1 - z.imag, 1.5 * abs(z.real) + z.imag - 2)),
    ({'type': 'spider', 'arms': 3, 'width': 0.6},
     lambda z: min(max(abs((z / a).imag) - 0.3, -(z / a).real) for a in (1, THIRD, THIRD * THIRD))),
]
THIRD = complex(-0.5, math.sqrt(0.75))


def test_apertures():
    """Each shape, passing and obscuring, offset and turned: which rays of a grid are clipped.  Complex numbers say it:
    the point, less the offset, turned back, and a function of it that is negative inside."""
    points = [complex(-3 + 0.37 * i, -3 + 0.41 * j) for i in range(17) for j in range(15)]
    launched = rays(*((z.real, z.imag, -1, 0, 0, 1) for z in points))
    for shape, outside in SHAPES:
        for obscures in (False, True):
            for offset, degrees in ((0j, 0), (0.3 - 0.2j, 25)):
                aperture = {**shape, 'offset': [offset.real, offset.imag], 'turn': degrees, 'obscures': obscures}
                path = written(json.dumps({'surfaces': [{'type': 'plane', 'apertures': [aperture]}]}))
                back = complex(math.cos(math.radians(degrees)), -math.sin(math.radians(degrees)))
                for z, row in zip(points, rows('trace', path, '--rays', '-', stdin=launched)):
                    beyond = outside((z - offset) * back)
                    assert abs(beyond) > 1e-9, (shape, z)
                    clipped = (beyond < 0) if obscures else (beyond > 0)
                    equal(row['fate'], 'clipped' if clipped else 'passed', (aperture, z))


def test_by_what_a_ray_is_clipped():
    path = written(json.dumps({'pupil': {'semi_diameter': 4}, 'surfaces': [{'type': 'plane', 'semi_diameter': 3.5, 'apertures': [
        {'type': 'circle', 'radius': 1, 'obscures': True}, {'type': 'rectangle', 'half_width': 5, 'half_height': 2.5}]}]}))
    said = run('trace', path, '--fan', 9).stdout
    for line in ('element 1 (plane): 5 clipped', 'Ray 0 (field 1, px 0, py -1) at element 1: clipped by its semi_diameter: r = 4 is beyond 3.5.',
                 'Ray 1 (field 1, px 0, py -0.75) at element 1: clipped by aperture 2 (rectangle): 0.5 beyond its edge.',
                 'Ray 4 (field 1, px 0, py 0) at element 1: clipped by aperture 1 (circle, obscuring): r = 0 is within 1.',
                 '1 more did not get through: sagitta diagnose LENS --ray N shows why.'):
        assert line in said, (line, said)
    assert 'clipped by aperture 2 (rectangle): 0.5 beyond' in run('diagnose', path, '--fan', 9, '--ray', 7).stdout
    assert 'clipped' not in run('trace', path, '--fan', 9, '--no-apertures').stdout


def test_bad_apertures():
    for aperture, line in (
            ({'type': 'square'}, 'type: must be circle, annulus, rectangle, ellipse, polygon or spider, not "square"'),
            ({'radius': 1}, 'type: missing'), ({'type': 'circle'}, 'radius: missing'),
            ({'type': 'circle', 'radius': -1}, 'radius: must not be negative'),
            ({'type': 'annulus', 'inner': 2, 'outer': 1}, 'inner: must not be larger than outer'),
            ({'type': 'polygon', 'points': [[0, 0], [1, 1]]}, 'points: must be a list of at least three'),
            ({'type': 'spider', 'arms': 0, 'width': 1}, 'arms: must be a whole number from 1 to 64'),
            ({'type': 'circle', 'radius': 1, 'inner': 2}, 'inner: unknown key'),
            ({'type': 'circle', 'radius': 1, 'offset': 3}, 'offset: must be two numbers')):
        said = run('trace', written(json.dumps({'surfaces': [{'type': 'plane', 'apertures': [aperture]}]})), '--rays', '-',
                   stdin=rays((0, 0, -1, 0, 0, 1)), exit=BAD_INPUT).stderr
        assert line in said, (line, said)


# ----------------------------------------------------------------- ideal lenses

def test_ideal_lenses():
    """A relay: images at their places and sizes, equal paths, the pupil as through matrices."""
    lens = {'object': {'distance': 60}, 'pupil': {'semi_diameter': 4, 'distance': 0}, 'field_type': 'object_height',
            'fields': [0, 3], 'surfaces': [
                {'type': 'ideal', 'focal_length': 20, 'object_distance': 60, 'thickness': 90, 'semi_diameter': 5},
                {'type': 'ideal', 'focal_length': -40, 'object_distance': 60, 'index': 1.5, 'thickness': 0, 'semi_diameter': 9},
                {'type': 'plane'}]}
    b = 1.5 / (1 / -40 - 1 / 60)  # a virtual image, in glass
    lens['surfaces'][1]['thickness'] = b
    path = written(json.dumps(lens))
    last = [r for r in rows('trace', path, '--grid', 5) if r['element'] == '3']
    equal({r['fate'] for r in last}, {'passed'})
    for field, height in (('1', 0), ('2', 3)):
        beam = [r for r in last if r['field'] == field]
        paths = [float(r['opl']) for r in beam]
        assert max(paths) - min(paths) < 1e-12, paths
        # the object is below the axis for a positive field in angle; as a height it is what it says
        right = height * -0.5 * (-b / 1.5 / 60)
        for r in beam:
            assert abs(float(r['x'])) < 1e-13 and abs(float(r['y']) - right) < 1e-13, (r, right)
    # a telescope magnifies slopes by -f1 / f2; its pupil, behind it, is imaged to the front
    scope = {'pupil': {'semi_diameter': 5}, 'fields': [1], 'surfaces': [
        {'type': 'ideal', 'focal_length': 100, 'thickness': 125},
        {'type': 'ideal', 'focal_length': 25, 'object_distance': 25, 'thickness': 31.25},
        {'type': 'plane', 'stop': True}]}
    out = [r for r in rows('trace', written(json.dumps(scope)), '--fan', 5) if r['element'] == '3']
    for r in out:
        assert abs(float(r['m']) / float(r['n']) + 4 * math.tan(math.radians(1))) < 1e-14, r
    assert abs(float(out[2]['y'])) < 1e-13, out[2]
    # F-number, and a lens in double pass
    pupil = {'pupil': {'f_number': 5}, 'surfaces': [{'type': 'ideal', 'focal_length': 50, 'thickness': 30},
        {'type': 'plane', 'mirror': True, 'thickness': -30}, {'type': 'ideal', 'focal_length': 50, 'thickness': -10},
        {'type': 'plane'}]}
    p = 1 / 50 + 1 / 50 - 60 / 2500
    first = rows('trace', written(json.dumps(pupil)), '--fan', 3)
    assert abs(float(first[0]['y']) + 1 / p / 10) < 1e-12, first[0]
    y, u = 1.0, -1 / 50
    y, u = y + 60 * u, u - (y + 60 * u) / 50
    edge = [r for r in first if r['py'] == '1']
    assert abs(float(edge[3]['y']) - (y + 10 * u) / p / 10) < 1e-12, edge[3]
    # a mirror that focuses; the picture has arrow heads; --trade agrees with 113 bits
    one = {'pupil': {'semi_diameter': 5}, 'surfaces': [{'type': 'ideal', 'focal_length': 20, 'mirror': True,
                                                        'thickness': -20}, {'type': 'plane'}]}
    for r in rows('trace', written(json.dumps(one)), '--fan', 5):
        if r['element'] == '2':
            assert abs(float(r['y'])) < 1e-14, r
    for keys, fault in (({}, 'focal_length: missing'), ({'focal_length': 0}, 'focal_length: must not be zero'),
                        ({'focal_length': 1e200}, 'focal_length: must be from 4e-151 to 3e150'),
                        ({'focal_length': 5, 'object_distance': 0}, 'object_distance: must not be zero'),
                        ({'focal_length': 5, 'radius': 3}, 'radius: unknown key')):
        said = run('trace', written(json.dumps({'surfaces': [{'type': 'ideal', **keys}]})), exit=BAD_INPUT).stderr
        assert fault in said, (fault, said)


# ----------------------------------------------------------------- wavelengths

def test_several_wavelengths():
    """Rows come wavelength after wavelength, the same launch rays in each, at its indices."""
    lens = {'wavelengths': [0.4861327, 0.5875618, 0.6562725], 'primary': 2, 'pupil': {'semi_diameter': 2},
            'fields': [0, 3], 'surfaces': [{'type': 'sphere', 'radius': 30, 'thickness': 4, 'glass': 'N-BK7'},
                                           {'type': 'plane', 'thickness': 50, 'glass': 'air'}, {'type': 'plane'}]}
    path = written(json.dumps(lens))
    together = rows('trace', path, '--wavelength', 'all', '--fan', 3)
    alone = [rows('trace', path, '--wavelength', w, '--fan', 3) for w in (1, 2, 3)]
    equal(together, alone[0] + alone[1] + alone[2])
    equal([r['wavelength'] for r in together[::18]], ['0.4861327', '0.5875618', '0.6562725'])
    equal({(r['field'], r['px'], r['py']) for r in together},
          {(f, '0', y) for f in '12' for y in ('-1', '0', '1')})
    equal(rows('trace', path, '--fan', 3), alone[1], 'the primary one is the default')
    equal(rows('trace', path, '--fan', 3, '--wavelength', 'F', '--wavelength', '3'), alone[0] + alone[2])
    text = run('trace', path, '--wavelength', 'all', '--fan', 3).stdout
    equal(text.splitlines()[0].split(), TRACE_ALL.split(','))
    assert '18 of 18 rays passed' in text, text
    equal(run('trace', path, '--fan', 3).stdout.splitlines()[0].split(), TRACE.split(','))
    row = rows('trace', path, '--rays', '-', stdin=rays((0, 1, -5, 0, 0, 1)))[0]
    equal((row['field'], row['wavelength'], row['px'], row['py']), ('', '0.5875618', '', ''))
    assert json.loads(run('trace', path, '--rays', '-', '--format', 'json',
                          stdin=rays((0, 1, -5, 0, 0, 1))).stdout)[0]['px'] is None
    run('diagnose', path, '--wavelength', 'all', exit=USAGE)
    run('trace', path, '--wavelength', 'all', '--wavelength', '1', exit=USAGE)
    both = run('trace', path, '--wavelength', '0.5,0.6', '--format', 'csv').stdout
    assert both == run('trace', path, '--wavelength', '0.5', '--wavelength', '0.6', '--format', 'csv').stdout


def test_strict():
    lens = {'wavelengths': [0.1], 'pupil': {'semi_diameter': 2}, 'surfaces': [
        {'type': 'sphere', 'radius': 30, 'thickness': 4, 'glass': 'N-BK7'}, {'type': 'plane'}]}
    path = written(json.dumps(lens))
    lens['wavelengths'] = [3]
    path = written(json.dumps(lens))
    assert 'outside the range of N-BK7' in run('trace', path).stderr
    assert 'outside the range of N-BK7' in run('trace', path, '--strict', exit=BAD_INPUT).stderr


# ---------------------------------------------------------------------- import

def test_import_of_lens_files():
    """Each example, imported, traces to the same bytes; imported twice it is the same text."""
    for path in sorted(LENSES.glob('*.yaml')):
        text = run('import', path).stdout
        again = written(text, path.name)
        for file in LENSES.glob('*.csv'):
            (again.parent / file.name).write_bytes(file.read_bytes())
        equal(run('import', again).stdout, text, path)
        equal(run('trace', again, '--grid', 5, '--format', 'csv').stdout,
              run('trace', path, '--grid', 5, '--format', 'csv').stdout, path)


ZMX = HERE.parent / 'data' / 'zmx'
SMALL = """MODE SEQ
NAME small
{notes}UNIT MM X W X CM MR CPMM
ENPD 4
FTYP 0 0 1 1
YFLN 0
WAVM 1 0.55 1
PWAV 1
SURF 0
  DISZ INFINITY
SURF 1
  STOP
{more}  CURV 0.02
  DISZ 3
  GLAS {glass} 0 0
SURF 2
  DISZ 5
TOL TOFF
"""


def small(notes='', more='', glass='N-BK7'):
    return SMALL.format(notes=notes, more=more, glass=glass)


def head(text):
    return [line for line in text.splitlines() if line.startswith('#')]


def test_remarks_of_import():
    """Each on one line, that begins with the file and the line of it; --strict refuses, and writes nothing."""
    path = written(small(more='  COAT AR\n  PKUP 1 1\n  COAT AR\n', notes='ZZQX 3\n'), 'small.zmx')
    out = path.parent / 'out.yaml'
    said = run('import', path, '-o', out).stderr
    equal(sorted(said.splitlines()), sorted([
        f'{path}:3: ZZQX: left out: an unknown record',
        f'{path}:14: COAT: left out: this record (2 times)',
        f'{path}:15: PKUP: taken as the number that is stored: it is a solve or pickup']))
    out.unlink()
    said = run('import', path, '-o', out, '--strict', exit=BAD_INPUT)
    equal((out.exists(), said.stdout), (False, ''))
    assert said.stderr.endswith(f'sagitta: {path}: 2 things were left out, and --strict was given\n'), said.stderr
    for file in ZMX.glob('*.zmx'):
        for line in run('import', file).stderr.splitlines():
            assert line.startswith(f'{file}:'), line
            number, key, words = line[len(str(file)) + 1:].split(': ', 2)
            assert int(number) > 0 and ' ' not in key, line
            assert words.startswith(('taken as ', 'left out: ', 'the file ends with a surface')), line


def test_an_unknown_glass():
    said = run('import', written(small(glass='N-BK77'), 'small.zmx'), exit=BAD_INPUT).stderr
    for words in (':15: ', '"N-BK77"', 'N-BK7,', '--glass PATH'):
        assert words in said, (words, said)
    equal(len(said.splitlines()), 1)


def test_notes_are_comments():
    """NOTE lines of a .zmx file stand at the head of the YAML; the lens is the same, and they survive the next import."""
    words = ['word%d' % i for i in range(90)]
    long = ' '.join(words)                                  # in pieces of 200 characters, as OpticStudio writes it
    pieces = ''.join(f'NOTE 0 {long[i:i + 200]}\n' for i in range(0, len(long), 200))
    plain = written(small(), 'small.zmx')
    bare = run('import', plain).stdout
    equal(head(bare), [])
    for notes, wanted in (
            ('NOTE 0 one: {two}\nNOTE 4\n', ['# one: {two}']),
            ('NOTE 0\nNOTE 4\nNOTE 0 one\nNOTE 4\nNOTE 0 \nNOTE 4\nNOTE 0   two # "3\nNOTE 4\nNOTE 0\n', ['# one', '#', '#   two # "3']),
            ('NOTE no code\nNOTE 12 lenses\n', ['# no code', '# 12 lenses']),
            ('NOTE 0 a\x01b\u2028c\x85d\x7f\te\nNOTE 0 \u00fc\U0001F52D\n', ['# a b c d  e', '# \u00fc\U0001F52D']),
            ('NOTE 0 ' + 'x' * 150 + '\n', ['# ' + 'x' * 150]),
            ('NOTE 0 ---\nNOTE 0 %YAML 1.1\nNOTE 0 surfaces: 3\n', ['# ---', '# %YAML 1.1', '# surfaces: 3'])):
        path = written(small(notes=notes), 'small.zmx')
        done = run('import', path)
        equal((head(done.stdout), done.stderr), (wanted, ''))
        equal(done.stdout, ''.join(line + '\n' for line in wanted) + bare)
        equal(run('import', written(done.stdout)).stdout, done.stdout)
    got = head(run('import', written(small(notes=pieces), 'small.zmx')).stdout)
    equal(' '.join(line[2:] for line in got), long)
    assert len(got) > 4 and all(line[:2] == '# ' and len(line) <= 102 for line in got), got
    last = small() + 'NOTE 0 the end'                       # without an end of line
    equal(head(run('import', written(last, 'small.zmx')).stdout), ['# the end'])
    # rays are the same, to the last byte
    for file in ZMX.glob('*.zmx'):
        again = written(run('import', file).stdout)
        equal(run('trace', again, '--grid', 5, '--format', 'csv', exit=None).stdout,
              run('trace', file, '--grid', 5, '--format', 'csv', exit=None).stdout, file)


def test_comments_of_lens_files():
    """Those at the head are kept, whatever ends their lines; others are not."""
    for end in ('\n', '\r\n'):
        text = end.join(['\ufeff# one', '', '#two', '#', 'surfaces:  # three', '# four', '  - {type: plane}', ''])
        equal(run('import', written(text)).stdout, '# one\n# two\n#\nsurfaces:\n  - {type: plane}\n')
    equal(run('import', written('#\n#')  , exit=BAD_INPUT).stdout, '')


def test_import_writes():
    path = written(json.dumps({'name': 'a "quoted": name\n', 'surfaces': [{'type': 'plane', 'name': 'true'}]}))
    out = path.parent / 'out.yaml'
    run('import', path, '-o', out)
    equal(run('import', out).stdout, out.read_text())
    assert 'would be written over' in run('import', path, '-o', path, exit=USAGE).stderr
    run('import', exit=USAGE)
    run('import', path, path, exit=USAGE)
    assert 'import' in run('import', '--help').stdout


def test_set():
    """--set is the lens of the file in which the value stands, at each command; errors name the path."""
    lens = LENSES / 'cooke_triplet.yaml'
    text = lens.read_text()
    other = written(text.replace('thickness: 42.20778', 'thickness: 42.2').replace('radius: 22.01359', 'radius: 22'))
    assert text != other.read_text()
    given = ('--set', 'surfaces[6].thickness=42.2', '--set', 'surfaces[1].radius=22')
    for command in (('info',), ('spot',), ('trace', '--fan', 3), ('field',), ('diagnose', '--fan', 3, '--ray', 1)):
        equal(run(*command, lens, *given, '--format', 'csv').stdout, run(*command, other, '--format', 'csv').stdout)
    equal(run('import', lens, *given).stdout, run('import', other).stdout)
    # between two of them the lens need not be one
    both = run('import', lens, '--set', 'wavelengths=[0.5, 0.6]', '--set', 'primary=2', '--set',
               'wavelength_weights=[1, 2]').stdout
    assert 'wavelengths: [0.5, 0.6]\nobject' in both, both
    assert 'glass: "a=b"' not in run('import', lens, '--set', 'surfaces[1].name=a=b').stdout
    assert 'name: "a=b"' in run('import', lens, '--set', 'surfaces[1].name=a=b').stdout
    for value, words, status in (
            ('surfaces[6].thickness=x', ':16: surfaces[6].thickness: must be a number, not "x"', BAD_INPUT),
            ('surfaces[9].radius=1', ': surfaces[9].radius: there is no surface 9; there are 7', BAD_INPUT),
            ('surfaces[1].glass=N-BK8', ':11: surfaces[1].glass: no glass "N-BK8"', BAD_INPUT),
            ('surfaces[1].radius={pickup: surfaces[2].radius}', 'put the path of a pickup in quotes', BAD_INPUT),
            ('surfaces[1].radius', 'must be PATH=VALUE', USAGE), ('=1', 'must be PATH=VALUE', USAGE)):
        said = run('info', lens, '--set', value, exit=status).stderr
        assert words in said, (words, said)
    # what is to be run again has it, too
    note = run('spot', LENSES / 'ftheta.yaml', '--field', 60, '--set', 'surfaces[1].name="x"', exit=None)
    assert note.stdout


def test_one_stop():
    lens = {'surfaces': [{'type': 'plane', 'stop': i in (1, 3), 'thickness': 1} for i in range(4)]}
    assert 'a second stop' in run('import', written(json.dumps(lens)), exit=BAD_INPUT).stderr


def test_import_keeps_each_character():
    """A name has every character of the first plane after it has been written as YAML."""
    points = [*range(1, 0xD800), *range(0xE000, 0x10000)]
    for i in range(0, len(points), 4096):
        name = '"' + ''.join(map(chr, points[i:i + 4096])) + '.'
        lens = json.dumps({'name': name, 'surfaces': [{'type': 'plane'}]})
        line = run('import', written(lens)).stdout.split('\n')[0]
        got = json.loads(line.removeprefix('"name": '))
        wrong = [f'{ord(a):X} as {ord(b):X}' for a, b in zip(got, name) if a != b]
        equal((len(got), wrong[:5]), (len(name), []), f'from {points[i]:X} on')


def test_edit():
    """Edits in the order in which they are given, as if each had been written and read."""
    lens = LENSES / 'cooke_triplet.yaml'
    def surfaces(*options, of=lens):
        return [line for line in run('edit', of, *options).stdout.splitlines() if line.startswith('  - ')]
    whole = surfaces()
    equal(run('edit', lens).stdout, run('import', lens).stdout, 'nothing is edited')
    equal(surfaces('--reverse', '1,6', '--reverse', '1,6'), whole, 'turned twice')
    equal(surfaces('--scale', 2, '--scale', 0.5), whole, 'larger and smaller')
    equal(surfaces('--insert', 'surfaces[3]={type: plane, thickness: 1}', '--remove', 'surfaces[3]'), whole)
    window = 'surfaces[3]={type: plane, thickness: 0.5, glass: air, name: window}'
    several = ('--remove', 'fields[2]', '--insert', window, '--reverse', 'window,5', '--scale', 3,
               '--set', 'surfaces[5].thickness=7')
    text, steps = run('edit', lens, *several).stdout, lens
    for k in range(0, len(several), 2):
        steps = written(run('edit', steps, *several[k:k + 2]).stdout)
    equal(steps.read_text(), text, 'one by one')
    assert 'fields: [0, 20]' in text and 'name: window' in text, text
    # in air a lens has one focal length from either side
    focus = [float(re.search(r'^efl +(\S+)', run('info', l).stdout, re.MULTILINE)[1])
             for l in (lens, written(run('edit', lens, '--reverse', '1,6', '--scale', 2).stdout))]
    close(focus[1], 2 * focus[0], 3e-7, 'the focal length of a lens that is turned')
    out = written('')
    run('edit', lens, '--scale', 2, '-o', out)
    assert 'radius: 44.02718' in out.read_text()
    for options, words, exit in ((('--remove', 'surfaces[9]'), 'there is no surface 9', BAD_INPUT),
                                 (('--scale', 0), 'factor must be positive', BAD_INPUT),
                                 (('--reverse', '6,1'), 'surfaces[6]', BAD_INPUT),
                                 (('--insert', 'surfaces[2]={type: plane, glass: air, colour: 1}'), 'colour', BAD_INPUT),
                                 (('--insert', 'surfaces'), 'PATH=VALUE', USAGE), (('--scale', 'x'), 'scale', USAGE)):
        said = run('edit', lens, *options, exit=exit).stderr
        assert words in said, (options, said)


main(globals())
