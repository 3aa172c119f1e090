#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The analyses: spot, fan, opd, field, map, sweep, energy, illumination.

    python3 test_look.py SAGITTA [--without-cairo]

What they tell is held against the same rays of `sagitta trace`, summed here; the rays themselves and the
wavefronts have an oracle of their own (tests/lens).
"""
import json
import math

from command import *

try:
    import numpy
except ImportError:
    numpy = None
    print('no numpy: the arrays are not read')

TRIPLET, NEWTONIAN = LENSES / 'cooke_triplet.yaml', LENSES / 'newtonian.yaml'
COLOURED = '''
units: mm
wavelengths: [0.4861327, 0.5875618, 0.6562725]
wavelength_weights: [1, 2, 1]
primary: 2
pupil: {semi_diameter: 5}
fields: [0, 3]
surfaces:
  - {type: sphere, radius: 51.68, thickness: 4, glass: SCHOTT N-BK7, semi_diameter: 5, stop: true}
  - {type: sphere, radius: -51.68, thickness: 48, index: 1}
  - {type: plane}
'''
# A stop of radius 5, and 10 behind it a hole of radius 6.
VIGNETTED = '''
units: mm
wavelengths: [0.5]
pupil: {semi_diameter: 5}
fields: [0, 5, 20, 40]
surfaces:
  - {type: plane, stop: true, semi_diameter: 5, thickness: 10}
  - {type: plane, semi_diameter: 6, thickness: 10, index: 1}
  - {type: plane}
'''
# Seen at 15 degrees the chief ray passes beside the ball, and rays from below meet it.
BALL = '''
units: mm
wavelengths: [0.5, 0.6]
primary: 1
pupil: {semi_diameter: 5}
fields: [15]
surfaces:
  - {type: plane, stop: true, thickness: 20}
  - {type: sphere, radius: 4, thickness: 30, index: 1.2}
  - {type: plane}
'''
# A mirror with the stop `far` before it; the image is `behind` the mirror's vertex.
MIRROR = '''
units: mm
wavelengths: [0.5]
pupil: {{semi_diameter: 5}}
fields: [0]
surfaces:
  - {{type: plane, stop: true, thickness: {far}}}
  - {{type: sphere, radius: -200, mirror: true, thickness: {behind}}}
  - {{type: plane}}
'''
ANALYSES = commands('docs/analysis.md')


def ends(lens, *options):
    """The last rows of traced rays, and for each field and wavelength those that passed."""
    last = {}
    for row in rows('trace', lens, *options, exit=None):
        last[row['field'], row['wavelength'], row['ray']] = row
    groups = {}
    for (field, wavelength, _), row in last.items():
        groups.setdefault((field, wavelength), []).append(row)
    return groups


def passed(group):
    return [(float(r['x']), float(r['y'])) for r in group if r['fate'] == 'passed']


def spread(points, about):
    square = [math.fsum((p[k] - about[k]) ** 2 for p in points) / len(points) for k in (0, 1)]
    return math.sqrt(sum(square)), *map(math.sqrt, square)


def test_spot():
    """Counts, centroid and rms of the rays that trace tells."""
    for lens in (TRIPLET, NEWTONIAN, written(COLOURED)):
        groups = ends(lens, '--cells', 12, '--wavelength', 'all')
        for row in rows('spot', lens, '--cells', 12, '--reference', 'centroid'):
            if row['wavelength'] == 'all':
                continue
            group = groups[row['field'], row['wavelength']]
            points = passed(group)
            equal((int(row['rays']), int(row['passed'])), (len(group), len(points)), lens)
            middle = [math.fsum(p[k] for p in points) / len(points) for k in (0, 1)]
            close(row['x'], middle[0], 1e-13), close(row['y'], middle[1], 1e-13)
            wanted = (*spread(points, middle), max(math.dist(p, middle) for p in points))
            for key, value in zip(('rms', 'rms_x', 'rms_y', 'geometric'), wanted):
                close(row[key], value, 1e-12 * value + 1e-15, (lens, key))


def test_spot_of_all_wavelengths():
    """About the chief ray of the primary wavelength, weighted."""
    lens = written(COLOURED)
    groups = ends(lens, '--cells', 12, '--wavelength', 'all')
    for row in rows('spot', lens, '--cells', 12):
        chief = passed(ends(lens, '--chief', '--fields', row['field'])[row['field'], '0.5875618'])[0]
        close(row['y'], chief[1], 0)
        several = [(w, groups[row['field'], f'{um}']) for um, w in ((.4861327, 1), (.5875618, 2), (.6562725, 1))]
        if row['wavelength'] != 'all':
            several = [(1, groups[row['field'], row['wavelength']])]
        weighted = [(w, math.dist(p, chief) ** 2) for w, group in several for p in passed(group)]
        close(row['rms'], math.sqrt(math.fsum(w * s for w, s in weighted) / sum(w for w, _ in weighted)), 1e-13)
    first = rows('spot', lens, '--wavelength', 1)[0]
    close(first['airy'], 1.2196698912665045 * .4861327e-3 * first_order(lens, 1), 1e-12)


def first_order(lens, wavelength):
    return json.loads(run('info', lens, '--wavelength', wavelength, '--format', 'json').stdout)['f_number_working']


def test_weights():
    """Each ray alike, in all that weighs them, and the table says so; on an obscured pupil, too."""
    alike = 'Each ray counts alike, whatever area of the pupil it stands for.'
    for lens in (TRIPLET, NEWTONIAN):
        def asked(name, *options):
            return rows(name, lens, '--hexapolar', 4, '--weights', 'equal', '--fields', 2, *options)
        several = asked('ends')
        equal({float(r['weight']) for r in several}, {1 / len(several)})
        points = [(float(r['x']), float(r['y'])) for r in several if r['fate'] == 'passed']
        middle = [math.fsum(p[k] for p in points) / len(points) for k in (0, 1)]
        spot = asked('spot', '--reference', 'centroid')[0]
        for key, value in zip(('x', 'y', 'rms', 'rms_x', 'rms_y'), (*middle, *spread(points, middle))):
            close(spot[key], value, 1e-12)
        waves = [float(r['opd']) for r in asked('opd') if r['opd']]
        mean = math.fsum(waves) / len(waves)
        close(asked('opd', '--summary')[0]['rms'],
              math.sqrt(math.fsum((w - mean) ** 2 for w in waves) / len(waves)), 1e-12)
        close(asked('opd', '--zernike', 1)[0]['coefficient'], mean, 1e-12)
        close(asked('illumination')[0]['fraction'], len(points) / len(several), 1e-13)
        for row in asked('energy', '--steps', 5):
            inside = sum(math.dist(p, middle) <= float(row['radius']) for p in points)
            close(row['fraction'], inside / len(points), float(row['unsure']) + 1e-12)
    for options, told in ((['--weights', 'equal'], True), (['--weights', 'area'], False), ([], False)):
        equal(alike in run('spot', TRIPLET, '--hexapolar', 2, *options).stdout, told)


def test_a_wavelength_without_weight():
    """A row for one wavelength does not depend on how the lens weighs it; the row of all does."""
    weighed, not_weighed = written(COLOURED), written(COLOURED.replace('[1, 2, 1]', '[0, 2, 1]'))
    for one, other in zip(rows('spot', weighed), rows('spot', not_weighed)):
        if one['wavelength'] != 'all':
            equal(other, one)
        else:
            assert one['rms'] != other['rms'], one
    single, together = rows('spot', not_weighed, '--fields', 1, '--wavelength', 1)
    equal({**together, 'wavelength': single['wavelength']}, single)  # with the Airy radius of that wavelength


def test_digits_know_the_reference():
    """The bound on rms has that of the chief ray in it, which fan tells twice for the chief ray itself."""
    counted = 0
    for lens in (TRIPLET, NEWTONIAN, LENSES / 'double_gauss.yaml'):
        for n in (4, 6, 8, 10, 12):
            errors = {}
            for row in rows('fan', lens, '--cells', n):
                if row['fate'] == 'passed':
                    errors.setdefault((row['field'], row['wavelength']), []).append(float(row['e_err']))
            chiefs = {(r['field'], r['wavelength']): float(r['e_err']) / 2 for r in rows('fan', lens, '--chief')}
            for row in rows('spot', lens, '--cells', n):
                key = row['field'], row['wavelength']
                if row['wavelength'] == 'all' or not float(row['rms']) or key not in chiefs:
                    continue
                own = [e - chiefs[key] for e in errors[key]]
                rms, rounding = float(row['rms']), len(own) * 2 ** -52 * float(row['rms'])
                spread = math.sqrt(math.fsum(e * e for e in own) / len(own)) + rounding
                wanted, without = math.log10(rms / (spread + chiefs[key])), math.log10(rms / spread)
                equal(int(row['digits']), max(0, math.floor(wanted)), (lens, n, row))
                counted += wanted > 0 and math.floor(wanted) != math.floor(without)
    assert counted, 'no case depends on the reference'


def test_memory_of_many_surfaces():
    """Without a picture the rays of one image surface make room for those of the next."""
    if b'__asan_init' in pathlib.Path(SAGITTA).read_bytes():
        return                                             # what is freed is kept for a while

    def most(*options):
        child = subprocess.Popen([SAGITTA, 'spot', TRIPLET, '--fields', '1', '--cells', '100', *options],
                                 stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        equal(child.returncode, 0)
        return usage.ru_maxrss                             # kB
    more = most('--defocus', ','.join(f'{i / 100}' for i in range(40))) - most()
    assert more < 20000, f'{more} kB more for 40 surfaces'


def test_defocus():
    """A moved image surface is that of a lens whose last thickness is another."""
    for z in (-.5, 0, .25):
        moved = written(COLOURED.replace('thickness: 48', f'thickness: {48 + z}'))
        one, other = rows('spot', moved), rows('spot', written(COLOURED), '--defocus', z)
        for a, b in zip(one, other):
            close(a['rms'], b['rms'], 1e-14), close(b['defocus'], z, 0)
    equal([r['defocus'] for r in rows('spot', TRIPLET, '--fields', 1, '--defocus', '-1,0', '--defocus', 2)],
          ['-1', '-1', '0', '0', '2', '2'])


def test_sampling():
    """What half as many rays across change."""
    fine, coarse = rows('spot', TRIPLET, '--cells', 20), rows('spot', TRIPLET, '--cells', 10)
    for a, b in zip(fine, coarse):
        close(a['sampling'], float(a['rms']) - float(b['rms']), 1e-15)
    fine, coarse = (rows('opd', TRIPLET, '--summary', '--hexapolar', n) for n in (8, 4))
    for a, b in zip(fine, coarse):
        close(a['sampling'], float(a['rms']) - float(b['rms']), 1e-13)


def test_fan():
    """Errors from the chief ray of the primary wavelength."""
    lens = written(COLOURED)
    groups = ends(lens, '--cross', 7, '--wavelength', 'all')
    for field in '12':
        chief = passed(ends(lens, '--chief', '--fields', field)[field, '0.5875618'])[0]
        for row in rows('fan', lens, '--cross', 7, '--fields', field):
            ray = [r for r in groups[field, row['wavelength']] if (r['px'], r['py']) == (row['px'], row['py'])]
            equal((len(ray), ray[0]['fate']), (1, row['fate']))
            if row['fate'] != 'passed':
                equal((row['ex'], row['ey']), ('', ''))
                continue
            close(row['ex'], float(ray[0]['x']) - chief[0], 0), close(row['ey'], float(ray[0]['y']) - chief[1], 0)


def test_energy():
    """The share of the traced rays within each radius, about their centroid or the chief ray."""
    for lens in (TRIPLET, written(COLOURED)):
        groups = ends(lens, '--cells', 12, '--wavelength', 'all')
        weight = {'0.4861327': 1, '0.5875618': 2, '0.6562725': 1, '0.55': 1}
        for field in sorted({f for f, _ in groups}):
            several = {w: passed(g) for (f, w), g in groups.items() if f == field}
            every = [(weight[w] / len(groups[field, w]), p) for w, points in several.items() for p in points]
            total = math.fsum(w for w, _ in every)
            middle = [math.fsum(w * p[k] for w, p in every) / total for k in (0, 1)]
            chief = passed(ends(lens, '--chief', '--fields', field)[field, '0.5875618' if len(several) > 1 else '0.55'])[0]
            for reference, about in (('centroid', middle), ('chief', chief)):
                table = rows('energy', lens, '--cells', 12, '--reference', reference, '--fields', field)
                for row in table:
                    r, own = float(row['radius']), several.get(row['wavelength'])
                    kept = [(1, p) for p in own] if own else every
                    share = math.fsum(w for w, p in kept if math.dist(p, about) <= r) / math.fsum(w for w, _ in kept)
                    close(row['fraction'], share, float(row['unsure']) + 1e-12, (lens, row))
                equal((table[-1]['wavelength'], float(table[-1]['fraction']) > 1 - 1e-12), ('all', True))  # the last radius is the largest distance
    three = rows('energy', TRIPLET, '--radius', '0.02,0.01', '--radius', 0.005, '--fields', 1)
    equal([r['radius'] for r in three if r['wavelength'] == 'all'], ['0.005', '0.01', '0.02'])


def test_illumination():
    """Counts and the chief ray's direction are those that trace tells."""
    for lens in (TRIPLET, NEWTONIAN, written(VIGNETTED), written(COLOURED)):
        groups = ends(lens, '--cells', 12, '--wavelength', 'all')
        chiefs = ends(lens, '--chief', '--wavelength', 'all')
        for row in rows('illumination', lens, '--cells', 12):
            group, chief = groups[row['field'], row['wavelength']], chiefs[row['field'], row['wavelength']][0]
            equal((int(row['rays']), int(row['passed'])), (len(group), len(passed(group))), lens)
            close(row['fraction'], len(passed(group)) / len(group), 1e-13, lens)
            if chief['fate'] == 'passed':                  # else trace does not follow it to the image
                close(row['cos4'], float(chief['n']) ** 4, float(row['cos4_err']) + 1e-15, lens)
            close(row['illumination'], float(row['fraction']) * float(row['cos4']), 1e-15, lens)


def test_illumination_of_two_circles():
    """Nothing bends light: the part of a disc inside another, and cos^4 of the field."""
    table = rows('illumination', written(VIGNETTED), '--cells', 200)
    for row, degrees in zip(table, (0, 5, 20, 40)):
        far, r, big = 10 * math.tan(math.radians(degrees)), 5, 6
        if far <= big - r:
            part = 1
        elif far >= big + r:
            part = 0
        else:
            a = (far * far + r * r - big * big) / (2 * far)  # from the middle of the disc to the common chord
            b = far - a
            part = (r * r * math.acos(a / r) - a * math.sqrt(r * r - a * a) +
                    big * big * math.acos(b / big) - b * math.sqrt(big * big - b * b)) / (math.pi * r * r)
        close(row['fraction'], part, 5e-4, row)
        close(row['cos4'], math.cos(math.radians(degrees)) ** 4, float(row['cos4_err']), row)
    assert float(table[0]['fraction']) == 1 and .1 < float(table[3]['fraction']) < .9, table


def test_a_perfect_mirror():
    """A paraboloid has no spot and no path difference on the axis, as far as it says that it knows."""
    row = rows('spot', NEWTONIAN, '--fields', 1)[0]
    equal(row['digits'], '0')
    close(row['rms'], 0, 1e-12)
    for row in rows('opd', NEWTONIAN, '--fields', 1, '--grid', 9):
        close(row['opd'], 0, float(row['opd_err']))


def test_opd_of_a_mirror_out_of_focus():
    """Of a paraboloid whose image surface lies 1 before the focus the wavefront is known."""
    lens = written('units: mm\nwavelengths: [0.5]\npupil: {semi_diameter: 5}\nsurfaces:\n'
                   '  - {type: conic, radius: -200, conic: -1, mirror: true, stop: true, thickness: -99}\n'
                   '  - {type: plane}\n')
    for row in rows('opd', lens, '--fan', 9):
        # The stop is the mirror, so the sphere about (0, -99) has the radius 99, and the chief ray starts on it.
        y = 5 * float(row['py'])
        z = -y * y / 400
        far = math.hypot(y, z + 100)                       # to the focus
        along = (y * -y + (z + 99) * (-100 - z)) / far     # from the centre to the mirror, along the ray
        to_sphere = -along - math.sqrt(along ** 2 - (y * y + (z + 99) ** 2 - 99 ** 2))
        close(row['opd'], (z + to_sphere) / .5e-3, 1e-9, row)


def test_fates():
    """The sums of fates are those of trace; none is dropped."""
    options = ('--field', 24, '--grid', 21)
    group = ends(TRIPLET, *options)['1', '0.55']
    row = rows('spot', TRIPLET, *options)[0]
    for fate in ('passed', 'missed', 'clipped', 'tir', 'lost'):
        equal(int(row[fate]), sum(r['fate'] == fate for r in group), fate)
    equal([r['fate'] for r in rows('map', TRIPLET, *options)], [r['fate'] for r in group])
    equal([r['element'] for r in rows('map', TRIPLET, *options)], [r['element'] for r in group])
    row = rows('sweep', TRIPLET, '--from', 24, '--to', 25, '--steps', 2, '--grid', 21)[0]
    for fate in ('passed', 'missed', 'clipped', 'tir', 'lost'):
        equal(int(row[fate]), sum(r['fate'] == fate for r in group), fate)
    said = run('spot', TRIPLET, *options).stdout
    assert f"{sum(r['fate'] == 'clipped' for r in group)} clipped" in said, said


def test_map_of_evaluations_and_conditions():
    groups = {}
    for row in rows('trace', TRIPLET, '--field', 14, '--grid', 5):
        groups.setdefault(row['ray'], []).append(row)
    for row, ray in zip(rows('map', TRIPLET, '--field', 14, '--grid', 5), groups.values()):
        equal(int(row['evals']), sum(int(r['evals']) for r in ray))
        most = max(float(r['t_err']) for r in ray)         # for csv trace adds the rounding of t in decimal
        assert most / 2 <= float(row['t_err']) <= most, (row, most)
        assert float(row['condition']) >= 1
    # on a plane the condition is 1 / cos of the angle of incidence
    plane = written('pupil: {semi_diameter: 1}\nfields: [30]\nsurfaces:\n  - {type: plane}\n')
    close(rows('map', plane, '--chief')[0]['condition'], 1 / math.cos(math.radians(30)), 1e-14)


def test_field_of_a_sphere():
    """A concave mirror with the stop at its centre has no astigmatism, and a spherical image."""
    lens = written('units: mm\npupil: {semi_diameter: 1}\nfields: [0, 5, 10]\nsurfaces:\n'
                   '  - {type: plane, stop: true, thickness: 200}\n'
                   '  - {type: sphere, radius: -200, mirror: true, thickness: -100}\n  - {type: plane}\n')
    for row in rows('field', lens):
        angle = math.radians(float(row['fy']))
        # every field is focused at 100 from the centre of curvature, along its chief ray
        z = 100 * math.cos(angle) - 100
        for curve in ('tangential', 'sagittal'):
            close(row[curve], z, 1e-11, row)
        if angle:
            close(row['distortion_percent'], 0, 1e-11, row)


def test_distortion():
    """The height of an f theta lens against both rules."""
    row = {d: rows('field', LENSES / 'ftheta.yaml', '--distortion', d)[-1] for d in ('tan', 'theta')}
    angle, efl = math.radians(float(row['tan']['fy'])), float(row['tan']['ideal']) / math.tan(math.radians(
        float(row['tan']['fy'])))
    for rule, ideal in (('tan', efl * math.tan(angle)), ('theta', efl * angle)):
        close(row[rule]['ideal'], ideal, 1e-12 * abs(ideal))
        close(row[rule]['distortion_percent'], 100 * (float(row[rule]['y']) / ideal - 1), 1e-12)
    steps = rows('field', TRIPLET, '--steps', 5)
    equal([(s['field'], float(s['fy'])) for s in steps], [(str(i + 1), 5.0 * i) for i in range(5)])


def test_threads():
    for name in ANALYSES:
        one = run(name, TRIPLET, '--format', 'csv', '--threads', 1).stdout
        for threads in (2, 3):
            equal(run(name, TRIPLET, '--format', 'csv', '--threads', threads).stdout, one, (name, threads))


def test_formats():
    """json has the columns and the values of csv; text names the fates."""
    for name in ANALYSES:
        table, objects = rows(name, TRIPLET), json.loads(run(name, TRIPLET, '--format', 'json').stdout)
        equal(len(objects), len(table), name)
        for row, one in zip(table, objects):
            equal(list(one), list(row))
            for key, value in one.items():
                if value is None:
                    equal(row[key], '', key)
                elif isinstance(value, str):
                    equal(row[key], value, key)
                else:
                    close(row[key], value, 0, key)
        said = run(name, TRIPLET).stdout.splitlines()[-1]
        assert 'passed' in said and 'ray' in said, said


def test_npy_and_columns():
    """The arrays have what csv has; the columns that are asked for come in that order."""
    codes = {'passed': 1, 'clipped': 2, 'tir': 3, 'evanescent': 4, 'missed': 0, 'lost': -1, 'none': -2}
    for name in ANALYSES if numpy else ():
        path = written('', 'out.npy')
        run(name, TRIPLET, '--format', 'npy', '-o', path)
        array, table = numpy.load(path), rows(name, TRIPLET)
        equal((len(array), list(array.dtype.names)), (len(table), list(table[0])), name)
        for one, row in zip(array, table):
            for key, text in row.items():
                if key == 'fate':
                    equal(one[key], codes[text])
                elif text not in ('', 'all'):
                    equal(float(one[key]), float(text), (name, key))
                elif one.dtype[key].kind == 'f':
                    assert math.isnan(one[key]), (name, key)
    equal(list(rows('spot', TRIPLET, '--columns', 'rms,field')[0]), ['rms', 'field'])
    assert 'clipped' in run('spot', TRIPLET, '--columns', 'field,clipped').stdout.splitlines()[0]


def test_proof():
    row = rows('spot', TRIPLET, '--fields', 2, '--proof', 'first')[0]
    equal(row['proven'], row['passed'])
    assert 'proven' in run('spot', TRIPLET, '--proof', 'first').stdout


def test_no_chief_ray():
    """A field whose chief ray does not get through has no reference, and says so."""
    done = run('opd', TRIPLET, '--field', 40)
    assert 'no reference' in done.stderr, done.stderr
    row = rows('spot', TRIPLET, '--field', 40)[0]
    equal((row['passed'], row['rms'], row['x']), ('0', '', ''))


def test_a_chief_ray_that_is_lost():
    """Without its reference a spot has no numbers, and says why; the centroid has them."""
    lens = written(BALL)
    done = run('spot', lens, '--cells', 12, '--format', 'csv')
    assert 'field 1: the chief ray does not get through, so there is no reference' in done.stderr, done.stderr
    for row in csv.DictReader(io.StringIO(done.stdout)):
        assert int(row['passed']) > 0, row
        equal((row['rms'], row['geometric'], row['x'], row['digits']), ('', '', '', '0'))
    done = run('spot', lens, '--defocus', '-1,2')
    assert 'field 1, defocus 2: the chief ray' in done.stderr, done.stderr
    done = run('spot', lens, '--cells', 12, '--reference', 'centroid', '--format', 'csv')
    equal(done.stderr, '')
    assert all(float(r['rms']) > 0 for r in csv.DictReader(io.StringIO(done.stdout)))
    done = run('fan', lens, '--cross', 3, '--format', 'csv')
    assert 'field 1: the chief ray does not get through, so there is no reference' in done.stderr, done.stderr
    done = run('opd', lens, '--cells', 12)                 # which names the wavelength
    for wavelength in ('0.5', '0.6'):
        assert f'field 1, {wavelength} \u00b5m: the chief ray does not' in done.stderr, done.stderr


def test_reference_spheres():
    """What is said of a reference sphere of infinite radius, and of one without a radius."""
    infinite = written(MIRROR.format(far=100, behind=-99))
    said = 'the exit pupil is at infinity or not known'
    assert said in run('opd', infinite).stderr
    equal(run('opd', infinite, '--afocal').stderr, '')
    none = written(MIRROR.format(far=200, behind=-200))    # the exit pupil is the image surface
    done = run('opd', none, '--fan', 9, '--format', 'csv')
    equal([r['opd'] for r in csv.DictReader(io.StringIO(done.stdout))], [''] * 9)
    assert 'field 1: 9 rays passed and have no path difference' in done.stderr, done.stderr
    equal(run('opd', written(MIRROR.format(far=150, behind=-99))).stderr, '')
    done = run('opd', TRIPLET, '--zernike', 40, '--cells', 3)
    assert 'do not determine 40 polynomials' in done.stderr, done.stderr


def test_a_glass_and_no_wavelengths():
    """A wavelength that is asked for is the primary one of a lens without any."""
    lens = written('''
units: mm
pupil: {semi_diameter: 5}
fields: [0, 3]
surfaces:
  - {type: sphere, radius: 51.68, thickness: 4, glass: SCHOTT N-BK7, stop: true}
  - {type: sphere, radius: -51.68, thickness: 48, index: 1}
  - {type: plane}
''')
    given = written(lens.read_text().replace('units: mm', 'units: mm\nwavelengths: [0.55]'))
    for name in ANALYSES:
        equal(rows(name, lens, '--wavelength', .55), rows(name, given), name)
        run(name, lens, exit=BAD_INPUT)


def test_over():
    """sweep --over asks an analysis of the lens with each value, as --set has it."""
    lens = LENSES / 'double_gauss.yaml'
    path = 'surfaces[6].thickness'
    for figure, more in ((), ('--fields', '1,3', '--reference', 'centroid')), (('--figure', 'field'), ()):
        all_of_it = rows('sweep', lens, '--over', path, '--from', 12, '--to', 12.5, '--steps', 3, *figure, *more)
        there = []
        for x in (12, 12.25, 12.5):
            one = rows(figure[1] if figure else 'spot', lens, '--set', f'{path}={x}', *more)
            there += [{'at': format(x, 'g'), **row} for row in one]
        equal(all_of_it, there)
    picture = written('', 'over.svg')
    run('sweep', lens, '--over', path, '--from', 12, '--to', 13, '--steps', 4, '--of', 'geometric', '--picture',
        picture)
    assert picture.read_text().count('<svg') == 1
    for more, words in ((('--over', path), '--from and --to'), (('--of', 'rms'), 'go with --over'),
                        (('--over', path, '--from', 1, '--to', 2, '--figure', 'no'), 'there is no analysis "no"'),
                        (('--over', path, '--from', 1, '--to', 2, '--of', 'no'), 'has no column "no"'),
                        (('--over', path, '--from', 1, '--to', 2, '--figure', 'fan', '--picture', picture),
                         'a row for each ray'),
                        (('--over', path, '--from', 1, '--to', 2, '--steps', 1), 'from 2 to')):
        said = run('sweep', lens, *more, exit=USAGE).stderr
        assert words in said, (words, said)
    said = run('sweep', lens, '--over', 'surfaces[1].radius', '--from', -1, '--to', 1, '--steps', 3,
               exit=BAD_INPUT).stderr
    assert 'surfaces[1].radius: must not be zero' in said, said


def test_help():
    """--help all offers what is taken, and tells the defaults."""
    for name, default in (('spot', '--hexapolar 10'), ('fan', '--cross 41'), ('opd', '--cross 41; with'),
                          ('field', None), ('map', '--cells 41'), ('sweep', '--hexapolar 10')):
        said = run(name, '--help', 'all').stdout
        options = [line.split()[0] for line in said.splitlines() if line.startswith('  --')]
        for option in ('--wavelength', '--aim', '--glass', '--proof', '--picture', '--threads', '--max-evals'):
            equal(options.count(option), 0 if (name, option) == ('field', '--proof') else 1, (name, option))
        for option in ('--rays', '--skip-bad'):
            assert option not in options, (name, option)
        for option in ('--field', '--fields'):
            equal(option in options, name != 'sweep', (name, option))
        for option in ('--fan', '--cells', '--chief', '--pupil'):
            equal(option in options, name != 'field', (name, option))
        if default:
            assert f'none of these      {default}' in said, name
        assert 'Default: the primary one; of spot, fan, opd and field' in said, name
    said = run('trace', '--help', 'all').stdout
    for words in ('--rays FILE', '--skip-bad', '--fields LIST', 'none of these      --fan 5',
                  'Default: the primary one'):
        equal(said.count(words), 1, words)


def test_errors():
    for words, *arguments in (
            ('the lens file is missing: sagitta spot LENS', 'spot'),
            ('--reference must be chief or centroid, not "middle"', 'spot', TRIPLET, '--reference', 'middle'),
            ('--defocus', 'spot', TRIPLET, '--defocus', 'a'),
            ('--defocus must be a number', 'spot', TRIPLET, '--defocus', ''),
            ('give --summary or --zernike', 'opd', TRIPLET, '--summary', '--zernike', 3),
            ('--order goes with --zernike', 'opd', TRIPLET, '--order', 'noll'),
            ('--zernike', 'opd', TRIPLET, '--zernike', 0),
            ('--distortion must be tan, theta, tan-surface or theta-surface', 'field', TRIPLET, '--distortion', 'sin'),
            ('a pattern of rays is of no use here', 'field', TRIPLET, '--grid', 3),
            ('--weights: field follows chief rays', 'field', TRIPLET, '--weights', 'equal'),
            ('--weights must be area or equal', 'spot', TRIPLET, '--weights', 'even'),
            ('--over must be pupil or field', 'map', TRIPLET, '--over', 'x'),
            ('--of must be fate', 'map', TRIPLET, '--of', 'x'),
            ('--steps goes with --over field', 'map', TRIPLET, '--steps', 3),
            ('sweep takes --from and --to', 'sweep', TRIPLET, '--field', 3),
            ('--to: angles', 'sweep', TRIPLET, '--to', 90),
            ('--from: the same as to: 5; give a range of angles', 'sweep', TRIPLET, '--from', 5, '--to', 5),
            ('give a range of object heights', 'sweep',
             written(COLOURED.replace('fields:', 'object: {distance: 100}\nfield_type: object_height\nfields:')),
             '--from', 5, '--to', 5),
            *(('--skip-bad goes with --rays', name, TRIPLET, '--skip-bad') for name in ANALYSES),
            ('--rays: fan launches', 'fan', TRIPLET, '--rays', 'x.csv')):
        done = run(*arguments, exit=USAGE)
        assert words in done.stderr, (arguments, done.stderr)
    plain = written(COLOURED.replace('units: mm\n', ''))
    done = run('opd', plain, exit=BAD_INPUT)
    assert f'{plain}:' in done.stderr and 'units: must be mm' in done.stderr, done.stderr
    equal(rows('spot', plain)[0]['airy'], '')


def test_pictures():
    """Each analysis draws in each format."""
    begins = {'svg': b'<?xml', 'png': b'\x89PNG\r\n', 'pdf': b'%PDF-'}
    for name, *options in (*((n,) for n in ANALYSES), ('opd', '--cells', 12), ('map', '--of', 't_err'),
                           ('spot', '--defocus', '-.1,0,.1'), ('map', '--over', 'field', '--steps', 5)):
        for ending, begin in begins.items():
            path = written('', f'{name}.{ending}')
            if '--without-cairo' in sys.argv:
                assert 'without cairo' in run(name, TRIPLET, '--picture', path, exit=USAGE).stderr
                continue
            run(name, TRIPLET, *options, '--picture', path, '--format', 'csv')
            equal(path.read_bytes()[:len(begin)], begin, (name, ending))
    if '--without-cairo' not in sys.argv:
        run('spot', TRIPLET, '--picture', 'x.gif', exit=USAGE)
        for name, *options in (('fan', '--grid', 4), ('opd', '--sobol', 9), ('opd', '--summary', '--sobol', 9)):
            done = run(name, TRIPLET, *options, '--picture', written('', 'x.svg'), exit=USAGE)
            assert 'on no line across the pupil' in done.stderr, done.stderr
            equal(done.stdout, '')
        run('opd', TRIPLET, '--summary', '--hexapolar', 4, '--picture', written('', 'x.svg'))
        run('spot', written(BALL), '--picture', written('', 'x.svg'))
        for name in 'map', 'opd':                          # wrote behind a map of one cell
            run(name, TRIPLET, '--grid', 1, '--picture', written('', 'x.svg'))


def test_a_lens_without_its_image():
    """Where the last surface bends light, one line says that it is taken for the image; --quiet leaves it out."""
    plane, glass = '\n  - {type: plane}\n', ', thickness: 48, index: 1}'
    assert COLOURED.endswith(glass + plane)
    refracts, mirror = COLOURED[:-len(plane)] + '\n', MIRROR.format(far=10, behind=-100)[:-len(plane)] + '\n'
    for text, word in (refracts, 'refracts'), (mirror, 'reflects'):
        for name in 'spot', 'fan', 'info':
            lines = [line for line in run(name, written(text)).stderr.splitlines() if 'taken for the image' in line]
            assert len(lines) == 1 and f'surfaces[2], {word},' in lines[0], lines
            assert 'taken for' not in run(name, written(text), '--quiet').stderr
    for text in COLOURED, MIRROR.format(far=10, behind=-100), refracts.replace('48, index: 1', '48, glass: SCHOTT N-BK7'):
        assert 'taken for' not in run('spot', written(text), exit=None).stderr, text


main(globals())
