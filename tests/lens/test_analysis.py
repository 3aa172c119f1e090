#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Spots, wavefronts and curves of fields by the command, against rays at 50 digits.

    python3 test_analysis.py SAGITTA

The oracle is analysis_oracle.py; its answers are ../data/analysis_*.csv, whose README says what the columns
are.  Lengths may be off by 1e-10 of the lens's length, from the object or else the first vertex to the image,
and by no more than the error that is told; path differences by no more than the error that is told.
"""
import csv
import decimal
import functools
import json
import math
import os
import pathlib
import random
import sys
from decimal import Decimal

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / 'tool'))
from command import *  # noqa: E402

DATA = HERE.parent / 'data'
SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'), 0)
os.environ['SAGITTA_GLASS'] = str(HERE.parents[1] / 'data' / 'glass')
WITHIN = 1e-10   # of the length of a lens
ULPS = 64       # an error of a path difference, in ulps of the longest path
IDEAL_ULPS = 128 # the same behind an ideal lens: errors of directions are of first order there.  86 observed
DEEP = 'DeepLens__zemax_double_gaussian__e5f0f7.zmx'
# Elements tilted or beside the axis by `origin`, or without a curvature at the vertex: no paraxial data.
NOT_PARAXIAL = ('figured_mirror.yaml', 'newtonian.yaml', 'analysis_odd_asphere.yaml',
                'analysis_polynomial_xy.yaml')
JUMPS = 'figured_mirror.yaml',  # the second derivative of a grid of heights, so the oracle has no foci
# No plane of symmetry: the oracle's sections are those of the image, the command's turn with the chief ray.
MIXED = {'analysis_tilted.yaml': 1e-5, 'analysis_polynomial_xy.yaml': 1e-4}


def number(cell):
    return float(cell) if cell else None


@functools.lru_cache
def oracle(table):
    """The rows of a table, of each lens."""
    out = {}
    with (DATA / f'analysis_{table}.csv').open() as file:
        for row in csv.DictReader(file):
            out.setdefault(row['lens'], []).append(row)
    return out


def path_of(lens):
    if isinstance(lens, pathlib.Path):
        return lens
    return next(p for p in (LENSES / lens, DATA / lens, DATA / 'zmx' / lens) if p.exists())


def length_of(lens):
    return float(oracle('fields')[lens][0]['length'])


def key(row):
    return (int(row['field']), float(row['wavelength'])) + tuple(
        round(float(row[k]), 9) + 0.0 for k in ('px', 'py') if k in row)


def told(command, lens, *arguments):
    """Rows of the command, by field, wavelength and point of the pupil."""
    return {key(row): row for row in rows(command, path_of(lens), '--no-apertures', *arguments, exit=None)
            if row['wavelength'] != 'all'}


def points_of(lens):
    first = oracle('rays')[lens]
    several = dict.fromkeys((row['px'], row['py']) for row in first)
    return [word for point in several for word in ('--pupil', ' '.join(point))]


def both(got, wanted, within, what):
    """Two numbers within a tolerance, or two that are not there."""
    got, wanted = (number(x) if isinstance(x, str) else x for x in (got, wanted))
    if got is None or wanted is None:
        equal(got, wanted, what)
    else:
        close(got, wanted, within, what)


def waves(lens, wavelength):
    """In a unit of length."""
    return float(oracle('fields')[lens][0]['micrometres']) / wavelength


@functools.lru_cache
def ends(lens):
    """The rows of `sagitta trace` at the image, by field, wavelength and point of the pupil."""
    everything = rows('trace', path_of(lens), '--no-apertures', '--wavelength', 'all', *points_of(lens))
    last = max(int(row['element']) for row in everything)
    return {key(row): row for row in everything if int(row['element']) == last}


def test_rays():
    """Points, directions and paths at the image."""
    for lens, rays in oracle('rays').items():
        got = ends(lens)
        equal(len(got), len(rays), f'{lens}: rays')
        for row in rays:
            mine, what = got[key(row)], f'{lens} {key(row)}: '
            for column in 'xyzlmn':
                within = 1e-14 if column in 'lmn' else 1e-14 * length_of(lens)
                close(mine[column], row[column], within, what + column)
            chief = got[key(row)[:2] + (0, 0)]
            close(float(mine['opl']) - float(chief['opl']), row['opl'], 1e-14 * length_of(lens), what + 'opl')


def test_the_error_of_a_path():
    """Of meridional rays through spheres, at 50 digits: one leaves glass just below total reflection, where rounding
    moves the end, and with it the path to it, far more than the path to a wavefront; the last surface is plane or steep."""
    def exact(y, index, spheres):
        """The path of a ray along z from z = -8 at y; spheres: curvature, distance in front, index behind."""
        o, d, n, path = [y, Decimal(-8)], [Decimal(0), Decimal(1)], Decimal(index), Decimal(0)
        for c, distance, behind in spheres:
            o[1] -= distance
            c = Decimal(c)
            b, e = d[1] - c * (o[0] * d[0] + o[1] * d[1]), c * (o[0] ** 2 + o[1] ** 2) - 2 * o[1]
            t = e / (b + (b * b - c * e).sqrt())
            o, path = [o[i] + t * d[i] for i in (0, 1)], path + n * t
            normal = [-c * o[0], 1 - c * o[1]]
            along = n * (normal[0] * d[0] + normal[1] * d[1])
            more = (behind ** 2 - n ** 2 + along ** 2).sqrt() - along
            d, n = [(n * d[i] + more * normal[i]) / behind for i in (0, 1)], Decimal(behind)
        return path

    generator = random.Random(SEED)
    worst = 0
    decimal.getcontext().prec = 50
    for image in (0, 0.025, -0.03):
        path = written(json.dumps({
            'units': 'mm', 'wavelengths': [0.5], 'object': {'index': 1.5}, 'pupil': {'semi_diameter': 8, 'distance': 0},
            'surfaces': [{'type': 'conic', 'curvature': 0.1, 'index': 1, 'thickness': 10},
                         {'type': 'conic', 'curvature': image} if image else {'type': 'plane'}]}))
        points = [6.66666 / 8] + [(1 - 10 ** generator.uniform(-6, -0.3)) / 1.2 for _ in range(60)]
        got = rows('ends', path, *(a for py in points for a in ('--pupil', f'0 {py!r}')))
        for py, row in zip(points, got):
            equal(row['fate'], 'passed')
            off = float(abs(Decimal(float(row['opl'])) - exact(8 * Decimal(py), 1.5, [(0.1, 0, 1), (image, 10, 1)])))
            assert off <= float(row['opl_err']), (image, py, off, row)
            worst = max(worst, off / float(row['opl_err']))
    assert worst > 1e-3, f'{worst:.3g} of the told error: it tells nothing'


def test_fans():
    """Each transverse error, from the chief ray of the primary wavelength."""
    for lens, rays in oracle('rays').items():
        got, primary = told('fan', lens, *points_of(lens)), float(oracle('spots')[lens][0]['wavelength'])
        chief = {key(row)[0]: row for row in rays if key(row)[1:] == (primary, 0, 0)}
        equal(len(got), len(rays), f'{lens}: rays of a fan')
        for row in rays:
            mine, centre = got[key(row)], chief[int(row['field'])]
            equal(mine['fate'], 'passed', f'{lens} {key(row)}')
            for axis in 'xy':
                wanted = float(row[axis]) - float(centre[axis])
                what = f'{lens} {key(row)}: e{axis}'
                close(mine['e' + axis], wanted, WITHIN * length_of(lens), what)
                close(mine['e' + axis], wanted, float(mine['e_err']), what + ', its error')
        clipped = {key(row): row['fate'] for row in rows('fan', path_of(lens), *points_of(lens), exit=None)}
        for row in rays:
            fate = 'passed' if row['passed'] == '1' else 'clipped'
            equal(clipped[key(row)], fate, f'{lens} {key(row)}, apertures')


def test_path_differences():
    """Each opd, and what is told of its error."""
    for lens, rays in oracle('rays').items():
        column = 'opd_foot' if lens in NOT_PARAXIAL else 'opd'
        got, longest = told('opd', lens, *points_of(lens)), {}
        equal(len(got), len(rays), f'{lens}: rays')
        for at, row in ends(lens).items():
            longest[at[:2]] = max(longest.get(at[:2], 0), abs(float(row['opl'])))
        for row in rays:
            mine, what = got[key(row)], f'{lens} {key(row)}'
            equal(mine['fate'], 'passed', what)
            close(mine['opd'], row[column], float(mine['opd_err']), what)
            ulp = math.ulp(longest[key(row)[:2]]) * waves(lens, key(row)[1])
            if not float(mine['opd_err']) <= (IDEAL_ULPS if lens == DEEP else ULPS) * ulp:
                raise AssertionError(f"{what}: opd_err is {float(mine['opd_err']) / ulp:.0f} ulps")


RELAY = """units: mm
wavelengths: [0.45, 0.55, 0.65]
primary: 2
object: {{distance: 100, index: {index}}}
field_type: object_height
pupil: {{object_na: 0.05}}
fields: [0, 5, [3, -2]]
aim: pupil
surfaces:
{front}
  - {{type: ideal, focal_length: 100{given}, thickness: {apart}, stop: true, index: 1}}
{middle}
  - {{type: ideal, focal_length: {second}, thickness: {last}, index: 1}}
  - {{type: plane}}
"""


def test_relays():
    """Relays of ideal lenses image every point of the object plane with equal paths, whatever stands where: all
    derivatives, errors and digits are there, and the image surface is where rays meet."""
    none = {'front': '', 'middle': '', 'given': '', 'second': 100, 'last': 100, 'index': 1, 'apart': 200}
    for what, kind in (('4f', {}), ('4f, given', {'given': ', object_distance: 100'}),
                       # an image on an ideal lens; 200 behind it the relay, whose second lens has an object at -150
                       ('a field lens', {'front': '  - {type: ideal, focal_length: 50, thickness: 100, index: 1}\n'
                                                  '  - {type: ideal, focal_length: 70, thickness: 200, index: 1}',
                                         'apart': 50, 'last': 60}),
                       # 1 / 150 = 1 / 60 - 1 / 100: an object 100 behind the first of the relay, 40 behind the next
                       ('converging light', {'front': '  - {type: ideal, focal_length: 60, thickness: 50, index: 1}',
                                             'apart': 10, 'second': 90, 'last': 1 / (1 / 90 + 1 / 40)})):
        row = {**none, **kind}
        path = written(RELAY.format(**row))
        for curve in rows('field', path):
            assert float(curve['xy_err']) < 1e-11, (what, curve)
            for focus in ('tangential', 'sagittal'):
                close(curve[focus], 0, 1e-10, f'{what}: {focus}')
        for end in rows('opd', path, '--grid', 6):
            close(end['opd'], 0, float(end['opd_err']), f'{what}: {end}')
            assert float(end['opd_err']) < 1e-6, (what, end)
        for spot in rows('spot', path):
            assert float(spot['geometric']) < 1e-12, (what, spot)
        assert all(int(x['digits']) > 8 for x in rows('spot', path, '--defocus', '1') if x['digits']), what


def test_the_last_surface_has_no_say():
    """An ideal lens as the last surface is the plane that it stands on, in every analysis."""
    front = """units: mm
wavelengths: [0.4861, 0.5876]
primary: 2
pupil: {semi_diameter: 5}
fields: [0, 3]
surfaces:
  - {type: sphere, radius: 51.68, thickness: 4, index: [1.5224, 1.5168], stop: true}
  - {type: sphere, radius: -700, thickness: 60, index: 1}
"""
    plane = written(front + '  - {type: plane, index: 1}\n')
    for last in ('{type: ideal, focal_length: 30, index: 1}', '{type: ideal, focal_length: -3, index: 1.5}',
                 '{type: ideal, focal_length: 30, object_distance: 10, mirror: true}'):
        ideal = written(f'{front}  - {last}\n')
        for command in (('spot',), ('opd', '--grid', 7), ('opd', '--summary'), ('fan',), ('field',),
                        ('map', '--cells', 5), ('sweep',), ('info', '--parabasal')):
            got, wanted = (rows(command[0], path, *command[1:]) for path in (ideal, plane))
            assert wanted
            equal(got, wanted, f'{last}: {command}')


def test_no_second_derivatives():
    """Where they are missing for a surface that bends the chief ray, `field` names it, and the columns are empty;
    elsewhere, and where such a surface is the last, it does not."""
    julia = '{type: julia, c: [-0.2, 0.4, 0, 0], iterations: 6, decenter: [0, 0, 2], '
    head = """units: mm
wavelengths: [0.55]
pupil: {semi_diameter: 0.1, distance: 0}
fields: [0, 1]
surfaces:
  - {type: sphere, radius: 50, thickness: 2, index: 1.5, stop: true}
"""
    for more, lacks in ((julia + 'thickness: 5, index: 1}', 2), (julia + 'thickness: 5, mirror: true}', 2),
                        ('{type: ideal, focal_length: 30, thickness: 5, index: 1}', 0)):
        for afocal in ('', 'afocal: true\n'):
            path = written(f'{afocal}{head}  - {more}\n  - {{type: plane, index: 1}}\n')
            for row in rows('field', path):
                equal(row['fate'], 'passed')
                equal(int(row['lacks']), lacks, more)
                for focus in ('tangential', 'sagittal'):
                    equal(row[focus + ('_dioptre' if afocal else '')] == '', lacks != 0, (more, focus))
            text = run('field', path).stdout
            equal(f'through surface {lacks}: its type (julia) has no second derivatives.' in text, lacks != 0, text)
    for row in rows('field', written(f'{head}  - {julia[:-2]}}}\n')):
        equal((row['lacks'], row['tangential'] == ''), ('0', False))


def test_explicit_object_distance():
    """.inf that is given stays: those paths are not those of the relay."""
    row = {'front': '', 'middle': '', 'given': ', object_distance: .inf', 'second': 100, 'last': 100, 'index': 1,
           'apart': 200}
    most = max(abs(float(r['opd'])) for r in rows('opd', written(RELAY.format(**row)), '--grid', 6))
    assert most > 0.1, most


def test_afocal():
    """Parallel light against a plane."""
    for lens in ('analysis_afocal.yaml', 'optiland__simple_fold_mirror_up__8136ed.zmx'):
        afocal = written(run('import', path_of(lens)).stdout + 'afocal: true\n')
        for path, asked in (path_of(lens), ['--afocal']), (afocal, []):
            got = told('opd', path, *asked, *points_of(lens))
            for row in oracle('rays')[lens]:
                mine = got[key(row)]
                close(mine['opd'], row['opd_plane'], float(mine['opd_err']), f'{path} {key(row)}')


def angles_from(row, chief):
    """Those of a row's direction about another's, in milliradians: along x and across."""
    (a, b, c), z = ([float(r[k]) for k in 'lmn'] for r in (row, chief))
    r = math.hypot(z[1], z[2])
    across, along = (b * z[2] - c * z[1]) / r, a * r - (z[1] * b + z[2] * c) * z[0] / r
    ahead = a * z[0] + b * z[1] + c * z[2]
    return 1e3 * math.atan2(along, ahead), 1e3 * math.atan2(across, ahead)


def test_angles():
    """Fans and spots of an afocal lens, in milliradians: of the oracle's directions."""
    for lens in ('analysis_afocal.yaml', 'optiland__simple_fold_mirror_up__8136ed.zmx', 'cooke_triplet.yaml'):
        path = written(run('import', path_of(lens)).stdout + 'afocal: true\n')
        got, primary = told('fan', path, *points_of(lens)), float(oracle('spots')[lens][0]['wavelength'])
        chief = {key(row)[0]: row for row in oracle('rays')[lens] if key(row)[1:] == (primary, 0, 0)}
        for row in oracle('rays')[lens]:
            mine, wanted = got[key(row)], angles_from(row, chief[int(row['field'])])
            for axis, angle in zip('xy', wanted):
                error = float(mine['e_err_mrad'])
                close(mine[f'e{axis}_mrad'], angle, error + 1e-12, f'{lens} {key(row)}: e{axis}')
                assert error < 1e-9, (lens, error)
        fan, several = {}, points_of(lens)
        for row in got.values():
            fan.setdefault(key(row)[:2], []).append([float(row['ex_mrad']), float(row['ey_mrad'])])
        for row in rows('spot', path, '--no-apertures', *several):
            if row['wavelength'] == 'all':
                continue
            angles = fan[key(row)]
            for column, power in (('rms_x_mrad', (1, 0)), ('rms_y_mrad', (0, 1)), ('rms_mrad', (1, 1))):
                mean = sum(power[0] * x * x + power[1] * y * y for x, y in angles) / len(angles)
                close(row[column], math.sqrt(mean), 1e-12 * (1 + math.sqrt(mean)), f'{lens} {key(row)[:2]}: {column}')
            assert int(row['digits']) > 5 or float(row['rms_mrad']) < 1e-6, row


def test_afocal_field():
    """The chief ray's angles are the oracle's; vergences are what rays beside it do, by differences."""
    lens, near = 'analysis_afocal.yaml', 1e-4
    path = written(run('import', path_of(lens)).stdout + 'afocal: true\n')
    chief = {key(row)[:2]: row for row in oracle('rays')[lens] if key(row)[2:] == (0, 0)}
    beside = {}
    for row in rows('trace', path, '--no-apertures', '--wavelength', 'all', '--pupil', '0 0', '--pupil',
                    f'0 {near}', '--pupil', f'{near} 0'):
        beside.setdefault(key(row)[:2], {})[float(row['px']), float(row['py'])] = row  # the last element's stays
    for row in rows('field', path):
        at = beside[key(row)]
        l, m, n = (float(chief[key(row)][k]) for k in 'lmn')
        for name, wanted in (('x_mrad', math.atan2(l, n)), ('y_mrad', math.atan2(m, n))):
            close(row[name], 1e3 * wanted, float(row['xy_err_mrad']) + 1e-11, f'{key(row)} {name}')
        middle = at[0.0, 0.0]
        across, ahead = (float(at[near, 0.0][k]) - float(middle[k]) for k in 'xl')
        close(row['sagittal_dioptre'], -1e3 * ahead / across, 1e-4, f'{key(row)}: sagittal')
        y, m2, n2 = (float(at[0.0, near][k]) - float(middle[k]) for k in 'ymn')
        turn = m2 * n - n2 * m  # in the plane of the field; the ray beside is y n away across the chief ray
        close(row['tangential_dioptre'], -1e3 * turn / (y * n), 1e-4, f'{key(row)}: tangential')


def test_unknown_exit_pupil():
    """Paths then go to the foot of the perpendicular, and that is told."""
    for lens in NOT_PARAXIAL:
        done = run('opd', path_of(lens), '--pupil', '0 1')
        if 'exit pupil is at infinity or not known' not in done.stderr:
            raise AssertionError(f'{lens}: {done.stderr!r}')


SINGLET = '''
units: mm
wavelengths: [0.55]
pupil: {semi_diameter: 6}
fields: [0, 4]
surfaces:
  - {type: sphere, radius: 50, thickness: 5, index: 1.5, stop: true}
  - {type: sphere, radius: -60, thickness: 20, index: 1}
  - {type: plane, thickness: 10, index: 1}
  - {type: break, tilt: [0, 0, 0], thickness: 20}
  - {type: plane}
'''


def test_turned_image():
    """An image that is turned about the axis, or bends light, is the same image."""
    straight = written(SINGLET)
    for angle in (30, 90, 180, -135):
        turned = written(SINGLET.replace('[0, 0, 0]', f'[0, 0, {angle}]'))
        for a, b in zip(rows('field', straight), rows('field', turned)):
            for column in ('tangential', 'sagittal', 'distortion_percent'):
                both(b[column], number(a[column]), 1e-10, (angle, column))
    for image in ('mirror: true', 'index: 1.5'):
        other = written(SINGLET.replace('{type: plane}', '{type: plane, ' + image + '}'))
        for command in (('field',), ('opd', '--summary')):
            for a, b in zip(rows(*command[:1], straight, *command[1:]), rows(*command[:1], other, *command[1:])):
                equal({k: b[k] for k in b if k not in ('fate', 'digits')},
                      {k: a[k] for k in a if k not in ('fate', 'digits')}, image)
                # (the bound of a mirror's direction is another one)
                assert abs(int(a['digits']) - int(b['digits'])) <= 1, (a, b)


STOP_BEHIND = """units: mm
wavelengths: [0.55]
object: {distance: 100, telecentric: %s}
pupil: {%s}
field_type: %s
fields: [0, 2]
surfaces:
  - {type: sphere, radius: 51, thickness: 2, index: 1.5}
  - {type: sphere, radius: -51, thickness: %g, index: 1}
  - {type: plane, thickness: 40, stop: true}
  - {type: plane}
"""


def test_pupil_before_the_object():
    """Rays through a pupil in front of the object (a hypercentric lens) run on along z if they are aimed, too."""
    lens = written(STOP_BEHIND % ('false', 'semi_diameter: 4', 'object_height', 60))
    near, far = (rows('opd', lens, '--fan', 3, '--fields', 1, '--aim', aim)[-1] for aim in ('paraxial', 'real'))
    close(far['opd'], near['opd'], 0.02 * abs(float(near['opd'])))
    for row in rows('trace', lens, '--fan', 3, '--aim', 'real'):
        assert float(row['n']) > 0 and float(row['t']) > 0, row


def test_vignetting_does_not_move_the_field():
    """A field's curves are along the ray through the centre of the pupil."""
    text = SINGLET.replace('fields: [0, 4]', 'fields: [0, 4]\nvignetting: [{}, {dy: 0.3, cy: 0.3}]')
    for a, b in zip(rows('field', written(SINGLET)), rows('field', written(text))):
        equal(b, a)
    both(rows('field', written(text), '--steps', 2)[1]['y'], float(rows('field', written(text))[1]['y']), 0, 'y')


def test_real_heights():
    """Fields by real image heights: telecentric, and about a decentred stop, the field 0 too."""
    telecentric = STOP_BEHIND % ('true', 'object_na: 0.05', 'real_image_height', 50)
    decentred = """units: mm
wavelengths: [0.55]
object: {distance: 100}
pupil: {semi_diameter: 5}
aim: stop
field_type: real_image_height
fields: [0, 3]
surfaces:
  - {type: sphere, radius: 50, thickness: 5, index: 1.5, stop: true, decenter: [0.3, -0.2, 0]}
  - {type: sphere, radius: -60, thickness: 100, index: 1}
  - {type: plane}
"""
    for text, heights in ((telecentric, (0, 2)), (decentred, (0, 3))):
        for row, height in zip(rows('spot', written(text), '--wavelength', 1, '--chief', '--columns', 'y,field')[::2],
                               heights):
            close(row['y'], height, 1e-9, row)


def test_index_in_front():
    """The ideal height is n efl tan(angle), with the index in front at each wavelength."""
    lens = written("""units: mm
wavelengths: [0.45, 0.65]
pupil: {semi_diameter: 2}
fields: [5]
object: {glass: SCHOTT N-SF11}
surfaces:
  - {type: sphere, radius: -50, thickness: 5, index: 1, stop: true}
  - {type: sphere, radius: 30, thickness: 80, index: 1.5}
  - {type: plane}
""")
    for row in rows('field', lens):
        data = rows('info', lens, '--wavelength', row['wavelength'])[0]
        opl = rows('trace', lens, '--field', 0, '--chief', '--wavelength', row['wavelength'])[0]
        index = float(opl['opl']) / float(opl['t'])
        close(row['ideal'], index * float(data['efl']) * math.tan(math.radians(5)), 1e-9)


def test_tip_of_a_cone():
    """At the tip there is no second derivative, so no focus, and no digit is certain; without a cone there are."""
    text = """units: mm
wavelengths: [0.55]
pupil: {semi_diameter: 3, distance: 0}
fields: [0]
surfaces:
  - {type: odd_asphere, radius: 50, coefficients: [%g, 0.001, 0.0001], thickness: 5, index: 1.5, stop: true}
  - {type: plane, thickness: 60, index: 1}
  - {type: plane}
"""
    tip, smooth = (rows('field', written(text % slope))[0] for slope in (0.01, 0))
    equal((tip['tangential'], tip['sagittal'], tip['xy_err']), ('', '', 'inf'))
    assert smooth['tangential'] and float(smooth['xy_err']) < 1e-10, smooth


def test_units():
    """A lens in metres is the same lens: its path differences in waves, and its spots a thousandth."""
    metres = SINGLET.replace('units: mm', 'units: m').replace('semi_diameter: 6', 'semi_diameter: 0.006')
    for length in ('radius: 50', 'radius: -60', 'thickness: 5,', 'thickness: 20', 'thickness: 10'):
        key, value = length.rstrip(',').split(': ')
        metres = metres.replace(length, f'{key}: {float(value) / 1000:.17g}' + ',' * length.endswith(','))
    here, there = written(SINGLET), written(metres)
    for a, b in zip(rows('opd', here), rows('opd', there)):
        close(b['opd'], a['opd'], 10 * float(a['opd_err']), a)
    for a, b in zip(rows('spot', here), rows('spot', there)):
        for column in ('rms', 'geometric', 'airy'):
            close(1000 * float(b[column]), a[column], 1e-11, column)
        assert abs(int(a['digits']) - int(b['digits'])) <= 1, (a, b)


def test_nothing_to_tell():
    """No image of an object at the front focus; a chief ray that is lost; a wavelength of no weight."""
    collimator = written("""units: mm
wavelengths: [0.55]
object: {distance: 48.0}
pupil: {semi_diameter: 3}
field_type: object_height
fields: [0, 2]
surfaces:
  - {type: plane, thickness: 2, index: 1.5, stop: true}
  - {type: conic, radius: -24.66666666666667, conic: -2.25, thickness: 20, index: 1}
  - {type: plane}
""")
    row = rows('field', collimator)[0]
    equal((row['tangential'], row['sagittal'], row['ideal']), ('', '', ''))
    ends = rows('spot', written(SINGLET.replace('fields: [0, 4]', 'fields: [95]')), exit=BAD_INPUT)
    equal(ends, [])


def fraction(percent):
    """A cell in per cent as a fraction; empty cells stay."""
    return percent if percent == '' else float(percent) / 100


def test_fields():
    """Chief rays, foci, distortion of both kinds."""
    for lens, fields in oracle('fields').items():
        length = length_of(lens)
        for kind in ('tan', 'theta'):
            got = told('field', lens, '--distortion', kind)
            equal(len(got), len(fields), f'{lens}: fields')
            for row in fields:
                mine, what = got[key(row)], f'{lens} {key(row)}: '
                error = number(mine['xy_err'])
                assert error < math.inf, what + 'xy_err'
                for axis in 'xy':
                    close(mine[axis], row[axis], min(WITHIN * length, error or length), what + axis)
                for focus in ('tangential', 'sagittal'):
                    wanted = row[focus]
                    within = MIXED.get(lens, WITHIN * max(length, abs(number(wanted) or 0)))
                    if lens not in JUMPS:
                        both(mine[focus], wanted, within, what + focus)
                for column in ('ideal', 'distortion'):
                    wanted = '' if lens in NOT_PARAXIAL else row[f'{column}_{kind}']
                    within = WITHIN * length if column == 'ideal' else MIXED.get(lens, WITHIN)
                    got_one = mine[column] if column == 'ideal' else fraction(mine['distortion_percent'])
                    both(got_one, wanted, within, what + column)


def test_spots():
    """316 cells, about the centroid and about the chief ray; how many pass the apertures."""
    for lens, spots in oracle('spots').items():
        length = length_of(lens)
        for about in ('centroid', 'chief'):
            got = told('spot', lens, '--cells', '20', '--reference', about)
            for row in spots:
                mine, what = got[key(row)], f'{lens} {key(row)}, {about}: '
                equal(int(mine['passed']), int(row['traced']), what + 'rays')
                for column in ('rms', 'rms_x', 'rms_y', 'geometric'):
                    close(mine[column], row[f'{column}_{about}'], WITHIN * length, what + column)
                close(mine['rms'], row['rms_' + about], float(mine['rms']) * 10.0 ** -int(mine['digits']),
                      what + f"{mine['digits']} digits of rms")
                if about == 'centroid':
                    for axis in 'xy':
                        close(mine[axis], row[axis], WITHIN * length, what + axis)
        clipped = rows('spot', path_of(lens), '--cells', '20', exit=None)
        passed = {key(row): row['passed'] for row in clipped if row['wavelength'] != 'all'}
        for row in spots:
            equal(int(passed[key(row)]), int(row['passed']), f'{lens} {key(row)}: rays that pass')


def rms_about(points, centre):
    """Of points of a weight each."""
    squares = math.fsum(w * ((x - centre[0]) ** 2 + (y - centre[1]) ** 2) for w, x, y in points)
    return math.sqrt(squares / math.fsum(w for w, x, y in points))


def test_through_focus():
    """Spots of single rays on a moved image, of each wavelength and of all, about the primary chief ray."""
    weights = {'analysis_relay.yaml': {'0.4861': 1, '0.5876': 3}}
    for lens in ('ftheta.yaml', 'analysis_tilted.yaml', 'analysis_relay.yaml',
                 'ray-optics__US05331467-1__e65bce.zmx'):
        primary = float(oracle('spots')[lens][0]['wavelength'])
        for z in (0.0, 0.25, -0.125):
            got = {(row['field'], row['wavelength']): row for row in rows(
                'spot', path_of(lens), '--no-apertures', *points_of(lens), f'--defocus={z}')}
            for field in dict.fromkeys(row['field'] for row in oracle('rays')[lens]):
                points, chief = {'all': []}, None
                for row in (row for row in oracle('rays')[lens] if row['field'] == field):
                    x, y, l, m, n = (float(row[k]) for k in 'xylmn')
                    here = weights.get(lens, {}).get(row['wavelength'], 1), x + z * l / n, y + z * m / n
                    points['all'].append(here)
                    points.setdefault(row['wavelength'], []).append(here)
                    chief = here[1:] if key(row)[1:] == (primary, 0, 0) else chief
                for wavelength, several in points.items():
                    close(got[field, wavelength]['rms'], rms_about(several, chief), WITHIN * length_of(lens),
                          f'{lens}, field {field}, {wavelength}, {z} out of focus')


def test_airy():
    """1.22 wavelength working F-number: the first zero of the Bessel function J1 is 3.8317059702."""
    for lens, fields in oracle('fields').items():
        got = told('spot', lens, '--chief')
        for row in fields:
            wanted = None if lens in NOT_PARAXIAL else number(row['working_f_number'])
            if wanted is not None:
                wanted *= 3.8317059702 / math.pi / waves(lens, float(row['wavelength']))
            both(got[key(row)]['airy'], wanted, 1e-9 * (wanted or 0), f'{lens} {key(row)}: airy')


def test_wavefronts():
    """316 cells: RMS, peak to valley, the coefficients of both orders."""
    for lens, spots in oracle('spots').items():
        if lens in NOT_PARAXIAL:
            continue
        cells = ('--cells', '20')
        off = {}
        for at, row in told('opd', lens, *cells).items():
            off[at[:2]] = max(off.get(at[:2], 0), float(row['opd_err']))
        got = told('opd', lens, *cells, '--summary')
        for row in spots:
            mine, what, within = got[key(row)], f'{lens} {key(row)}: ', off[key(row)]
            close(mine['rms'], row['opd_rms'], within, what + 'rms')
            close(mine['rms'], row['opd_rms'], float(mine['rms']) * 10.0 ** -int(mine['digits']),
                  what + f"{mine['digits']} digits of rms")
            close(mine['pv'], row['opd_pv'], 2 * within, what + 'pv')
        for order, terms in (('noll', 15), ('fringe', 16)):
            fits = {key(row) + (row['term'],): row for row in rows(
                'opd', path_of(lens), *cells, '--no-apertures', '--zernike', terms, '--order', order)}
            for row in oracle('zernike')[lens]:
                if row['order'] == order:
                    mine, what = fits[key(row) + (row['term'],)], f"{lens} {key(row)}: {order} {row['term']}"
                    equal((mine['n'], mine['m']), (row['n'], row['m']), what)
                    # a coefficient is the mean of the values times a factor below 2 n + 2
                    close(mine['coefficient'], row['coefficient'], 14 * off[key(row)], what)


def test_reference():
    """RMS spots and wavefronts of the ten .zmx files by another tracer, aimed at the paraxial pupil."""
    for lens, several in oracle('reference').items():
        how = ('--aim', 'paraxial', '--cells', '20')
        length, primary = length_of(lens), float(oracle('spots')[lens][0]['wavelength'])
        spots = {about: told('spot', lens, *how, '--reference', about) for about in ('centroid', 'chief')}
        summary, off = told('opd', lens, *how, '--summary'), {}
        for at, row in told('opd', lens, *how).items():
            off[at[:2]] = max(off.get(at[:2], 0), number(row['opd_err']) or 0)
        for row in several:
            what = f'{lens} {key(row)}: '
            equal(spots['centroid'][key(row)]['passed'], row['traced'], what + 'rays')
            for about in ('centroid', 'chief') if key(row)[1] == primary else ('centroid',):
                both(spots[about][key(row)]['rms'], row['rms_' + about], WITHIN * length, what + about)
            for column in ('pv', 'rms') if row['opd_pv'] else ():
                close(summary[key(row)][column], row['opd_' + column], 2 * off[key(row)], what + column)


def test_published():
    """Foci and distortion of a published lens, to the digits that are published.

    There distortion is a percentage, and compared to the scale that images near the axis have on the surface."""
    lens = 'published_triplet.yaml'
    with (DATA / 'published_triplet.csv').open() as file:
        for row in csv.DictReader(file):
            nominator, _, denominator = row['degrees'].partition('/')
            angle = float(nominator) / float(denominator or 1)
            kind = row['quantity'] if row['quantity'] in ('tan', 'theta') else 'tan'
            point = told('field', lens, '--field', repr(angle), '--distortion', kind + '-surface')
            cells = point[1, float(row['wavelength'])]
            got = float(cells[row['quantity'] if row['quantity'] in cells else 'distortion_percent'])
            last = 10.0 ** -len(row['value'].partition('.')[2])
            close(got, row['value'], last, str(row))  # some are cut off, not rounded


# A mirror used off axis, its light let in beside the axis; lenses with an obscuration and a rim that the chief
# and the marginal ray meet.  BEAM, RIM: what clips.  The stop comes behind them.
CLIPPED = (
    """{{units: mm, aim: {aim}, wavelengths: [0.55], pupil: {{semi_diameter: 4}}, fields: [0, 0.5], surfaces: [
      {{type: plane, thickness: 40, index: 1{beam}}},
      {{type: conic, radius: -200, conic: -1, mirror: true, stop: true, thickness: -100}},
      {{type: plane, index: 1}}]}}""",
    """{{units: mm, aim: {aim}, wavelengths: [0.55], object: {{distance: 300}}, pupil: {{semi_diameter: 6}}, fields: [0, 1],
      surfaces: [
      {{type: sphere, radius: 40, thickness: 6, index: 1.6{beam}}},
      {{type: conic, radius: -90, conic: -3, thickness: 9, index: 1{rim}}},
      {{type: plane, thickness: 9, index: 1, stop: true}},
      {{type: sphere, radius: 60, thickness: 5, index: 1.5{rim}}},
      {{type: plane, thickness: 70, index: 1{beam}}},
      {{type: plane, index: 1}}]}}""")
BEAM = (', apertures: [{type: rectangle, half_width: 2, half_height: 2, offset: [0, 30]}]', ', apertures: [{type: circle, radius: 1, offset: [9, 0]}]')
RIM = ', semi_diameter: 0.01', ', apertures: [{type: circle, radius: 2, obscures: true}]'


def test_clips_decide_no_size():
    """What clips takes rays away and nothing else: the pupil, chief rays and their references stay."""
    for lens in CLIPPED:
        for aim in ('pupil', 'stop', 'real_stop'):
            bare = written(lens.format(aim=aim, beam='', rim=''))
            for how in (['field'], ['info'], ['info', '--parabasal'],
                        *([c, '--no-apertures', '--cross', 5] for c in ('fan', 'opd', 'spot'))):
                wanted = rows(how[0], bare, *how[1:], exit=None)
                for beam in BEAM:
                    for rim in RIM:
                        path = written(lens.format(aim=aim, beam=beam, rim=rim))
                        got = rows(how[0], path, *how[1:], exit=None)
                        what = f'{aim}{beam}{rim}: {how}'
                        equal(len(got), len(wanted), what)
                        for a, b in zip(got, wanted):
                            for column in b:
                                alike(a[column], b[column], f'{what} {column}')


def alike(got, wanted, what):
    """Two cells; numbers but for rounding, which a rim may change as the search ends at once or later."""
    if got == wanted:
        return
    try:
        close(float(got), float(wanted), 1e-9 * (1 + abs(float(wanted))), what)
    except ValueError:
        equal(got, wanted, what)


def test_threads():
    """The same bytes for any number of threads."""
    for how in (['spot'], ['fan'], ['opd'], ['opd', '--summary'], ['opd', '--zernike', 11], ['field']):
        ways = [] if how == ['field'] else ['--hexapolar', 30]
        arguments = [how[0], path_of('analysis_relay.yaml'), *how[1:], *ways, '--format', 'csv', '--threads']
        several = {run(*arguments, n, exit=None).stdout for n in (1, 2, 5)}
        equal(len(several), 1, f'{how}: outputs')


def test_numpy():
    """Coefficients are those of numpy.linalg.lstsq for the differences that the command told."""
    try:
        import numpy
    except ImportError:
        print('       (numpy is missing: the oracle\'s own fits are compared all the same)')
        return
    for lens in ('cooke_triplet.yaml', 'analysis_relay.yaml', 'analysis_tilted.yaml'):
        for hexapolar in (2, 6):
            pattern = '--hexapolar', str(hexapolar)
            several, fits = {}, {}
            for row in told('opd', lens, *pattern).values():
                several.setdefault(key(row)[:2], []).append([float(row[k]) for k in ('px', 'py', 'opd')])
            for row in rows('opd', path_of(lens), *pattern, '--no-apertures', '--zernike', 11):
                fits.setdefault(key(row), []).append(float(row['coefficient']))
            for at, points in several.items():
                x, y, opd = numpy.array(points).T
                weight = numpy.sqrt([hexapolar_weight(hexapolar, r) for r in numpy.hypot(x, y)])
                wanted = numpy.linalg.lstsq((numpy.array(noll(x, y)) * weight).T, opd * weight, rcond=None)[0]
                for term, (a, b) in enumerate(zip(fits[at], wanted), 1):
                    close(a, b, 1e-12 * max(abs(opd)), f'{lens} {at}, {hexapolar} rings: term {term}')


def hexapolar_weight(rings, radius):
    """As docs/rays.md has it, for a ray at this radius."""
    ring = round(radius * rings)
    if ring == 0:
        return 1 / (4 * rings ** 2)
    if ring == rings:
        return (rings - 1 / 4) / (6 * rings ** 3)
    return 1 / (3 * rings ** 2)


def noll(x, y):
    """The first 11 (Noll 1976, table I)."""
    r2, s = x * x + y * y, math.sqrt
    return [x * 0 + 1, 2 * x, 2 * y, s(3) * (2 * r2 - 1), 2 * s(6) * x * y, s(6) * (x * x - y * y),
            s(8) * (3 * r2 - 2) * y, s(8) * (3 * r2 - 2) * x, s(8) * (3 * x * x - y * y) * y,
            s(8) * (x * x - 3 * y * y) * x, s(5) * (6 * r2 * r2 - 6 * r2 + 1)]


main(globals())
