#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sagitta tolerance: each tolerance against a file that is written by hand, trials in any split and threads,
quantiles against theory.

    python3 test_tolerance.py SAGITTA [--without-cairo] [--without-openmp]
"""
import json
import math
import re
import statistics

from command import *

EXAMPLE = LENSES / 'triplet_tolerances.yaml'
CAIRO, OPENMP = '--without-cairo' not in sys.argv, '--without-openmp' not in sys.argv
GREEN = 0.5461e-3
HEAD = '''name: triplet
units: mm
wavelengths: [0.55, 0.65]
primary: 1
pupil: {semi_diameter: 5}
fields: [0, 14]
field_weights: [1, 2]
'''
# radius, thickness, index, more
TRIPLET = [(22.01359, 3.25896, '[1.6226, 1.618]', 'semi_diameter: 9.5'),
           (-435.76044, 6.00755, 1, 'semi_diameter: 8.5'),
           (-22.21328, 0.99997, '[1.6237, 1.615]', 'semi_diameter: 5'),
           (20.29192, 4.75041, 1, 'semi_diameter: 4, stop: true'),
           (79.6836, 2.95208, '[1.6226, 1.618]', 'semi_diameter: 7.5'),
           (-18.39533, 42.20778, 1, 'semi_diameter: 7.5')]
RAYS = ('--hexapolar', 4, '--quiet')


def surfaces(changes={}, before={}, behind={}):
    """The lines of the triplet; changes[i]: keys of surface i in place of its own, before and behind: lines."""
    text = 'surfaces:\n'
    for i, (radius, thickness, index, more) in enumerate(TRIPLET, 1):
        own = {'type': 'sphere', 'radius': repr(radius), 'thickness': repr(thickness), 'index': index}
        own.update(changes.get(i, {}))
        if 'curvature' in own:
            del own['radius']
        text += before.get(i, '') + '  - {' + ', '.join(f'{k}: {v}' for k, v in own.items()) + f', {more}}}\n'
        text += behind.get(i, '')
    return text + '  - {type: plane}\n'


def spot(text, *options):
    """The figure by hand: from the rows of sagitta spot for all wavelengths together."""
    fields = [float(r['rms']) for r in rows('spot', written(text), *RAYS, *options) if r['wavelength'] == 'all']
    return math.sqrt((fields[0] ** 2 + 2 * fields[1] ** 2) / 3)


def tolerances(*entries):
    return 'tolerances:\n' + ''.join(f'  - {{{e}}}\n' for e in entries)


def sensitivity(lens, *entries, **how):
    return {r['tolerance']: r for r in rows('tolerance', written(lens + tolerances(*entries)), *RAYS, **how)}


def by_hand(entry, hand, lens=HEAD + surfaces()):
    """An entry at -d and d against files; hand(d) is one."""
    d = float(re.search(r'(?:radius|fringes|thickness|_[xyz]|index|irregularity): ([\d.e-]+)', entry)[1])
    row, = sensitivity(lens, entry).values()
    nominal = spot(lens)
    for end, x in (('lower', -d), ('upper', d)):
        by_file = spot(hand(x))
        close(row['figure_' + end], by_file, 1e-11 * by_file, f'{entry} at {x}')
        close(row['change_' + end], by_file - nominal, 1e-11 * by_file, f'{entry} at {x}, change')


def test_radius_and_fringes():
    by_hand('surface: 1, radius: 0.05', lambda d: HEAD + surfaces({1: {'radius': 22.01359 + d}}))
    # n fringes: the sag of the test plate at the edge is off by n half waves
    for i, h, n in ((2, 8.5, 3), (4, 4, 3)):
        by_hand(f'surface: {i}, fringes: {n}',
                lambda d: HEAD + surfaces({i: {'curvature': 1 / TRIPLET[i - 1][0] + d * GREEN / h ** 2}}))
    by_hand('surface: 4, fringes: 3, wavelength: 0.6328, over: 3',
            lambda d: HEAD + surfaces({4: {'curvature': 1 / 20.29192 + d * 0.6328e-3 / 9}}))
    # the sag at h of the two curvatures, exactly: the paraxial formula is near it
    r, h, n = 79.6836, 7.5, 1
    other = 1 / (1 / r + n * GREEN / h ** 2)
    sag = [x - math.sqrt(x * x - h * h) for x in (r, other)]
    close(sag[1] - sag[0], n * GREEN / 2, 0.02 * n * GREEN / 2, 'half a wave a fringe')


def test_a_flat_surface_becomes_a_sphere():
    lens = '''units: mm
wavelengths: [0.55, 0.65]
primary: 1
pupil: {semi_diameter: 5}
fields: [0, 3]
field_weights: [1, 2]
surfaces:
  - {type: plane, thickness: 3, index: 1.5, stop: true, semi_diameter: 6}
  - {type: conic, radius: -50, conic: -0.6, thickness: 98, index: 1, semi_diameter: 6}
  - {type: plane}
'''
    by_hand('surface: 1, fringes: 5', lambda d: lens.replace(
        'type: plane, thickness: 3', f'type: sphere, curvature: {d * GREEN / 36!r}, thickness: 3'), lens)
    for term in some((5, 9, 11)):
        by_hand(f'surface: 2, irregularity: 2, term: {term}', lambda d: lens.replace(
            'type: conic', f'type: zernike, norm: 6, order: fringe, coefficients: '
            f'[{"0, " * (term - 1)}{d * GREEN / 2!r}]'), lens)
        by_hand(f'surface: 1, irregularity: 2, term: {term}', lambda d: lens.replace(
            'type: plane, thickness: 3', f'type: zernike, norm: 6, order: fringe, coefficients: '
            f'[{"0, " * (term - 1)}{d * GREEN / 2!r}], thickness: 3'), lens)


def test_thickness_and_index():
    by_hand('surface: 3, thickness: 0.05', lambda d: HEAD + surfaces({3: {'thickness': repr(0.99997 + d)}}))
    by_hand('surface: 3, index: 1e-3',
            lambda d: HEAD + surfaces({3: {'index': f'[{1.6237 + d!r}, {1.615 + d!r}]'}}))
    by_hand('surface: 2, index: 1e-3', lambda d: HEAD + surfaces({2: {'index': f'{1 + d!r}'}}))
    # a glass by its name: the same off at every wavelength
    def bk7(um):
        w, n = um * um, 1
        for b, c in ((1.03961212, 0.00600069867), (0.231792344, 0.0200179144), (1.01046945, 103.560653)):
            n += b * w / (w - c)
        return math.sqrt(n)
    glass = HEAD + surfaces({1: {'glass': 'SCHOTT N-BK7'}}).replace('index: [1.6226, 1.618], glass', 'glass', 1)
    row, = sensitivity(glass, 'surface: 1, index: 1e-3').values()
    other = HEAD + surfaces({1: {'index': f'[{bk7(0.55) + 1e-3!r}, {bk7(0.65) + 1e-3!r}]'}})
    close(row['figure_upper'], spot(other), 1e-11 * spot(other), 'the index of a glass')


def test_place():
    for i, axis in some(list(enumerate('xyz'))):
        def vector(d):
            return [d if k == i else 0 for k in range(3)]
        by_hand(f'surface: 3, decenter_{axis}: 0.02', lambda d: HEAD + surfaces({3: {'decenter': vector(d)}}))
        by_hand(f'surface: 3, tilt_{axis}: 0.2', lambda d: HEAD + surfaces({3: {'tilt': vector(d)}}))
        by_hand(f'surfaces: [3, 4], decenter_{axis}: 0.02',
                lambda d: HEAD + surfaces({3: {'decenter': vector(d)}, 4: {'decenter': vector(d)}}))


def test_a_group_tilts_as_one_body():
    """By breaks: to the pivot, turned, back; then behind the group the other way."""
    t = TRIPLET[2][1]
    for axis in some(range(3)):
        for pivot in (0, 0.5, -2):
            def hand(d):
                turn = [d if k == axis else 0 for k in range(3)]
                back = [-x for x in turn]
                return HEAD + surfaces(
                    {4: {'thickness': repr(pivot - t)}},
                    {3: f'  - {{type: break, thickness: {pivot}}}\n'
                        f'  - {{type: break, tilt: {turn}, thickness: {-pivot}}}\n'},
                    {4: f'  - {{type: break, tilt: {back}, order: tilt_first, '
                        f'thickness: {t + TRIPLET[3][1] - pivot!r}}}\n'})
            by_hand(f'surfaces: [3, 4], tilt_{"xyz"[axis]}: 0.3, pivot: {pivot}', hand)


def test_a_tilted_surface_has_its_own_axes():
    tilted = HEAD + surfaces({5: {'tilt': '[3, 0, 0]'}})
    c, s = math.cos(math.radians(3)), math.sin(math.radians(3))
    by_hand('surface: 5, decenter_y: 0.05',
            lambda d: HEAD + surfaces({5: {'tilt': '[3, 0, 0]', 'decenter': [0, d * c, d * s]}}), tilted)
    by_hand('surface: 5, tilt_x: 0.1', lambda d: HEAD + surfaces({5: {'tilt': [3 + d, 0, 0]}}), tilted)
    by_hand('surface: 5, tilt_y: 0.1', lambda d: HEAD + surfaces(
        {5: {'thickness': 0}},
        {5: f'  - {{type: break, tilt: [3, 0, 0], thickness: 0}}\n'
            f'  - {{type: break, tilt: [0, {d}, 0], thickness: 0}}\n'},
        {5: f'  - {{type: break, tilt: [0, {-d}, 0], thickness: 0}}\n'
            f'  - {{type: break, tilt: [-3, 0, 0], thickness: {TRIPLET[4][1]!r}}}\n'}), tilted)
    # within a turned frame, and by an origin
    fold = {4: '  - {type: break, tilt: [1, 2, 0], thickness: 0}\n'}
    by_hand('surface: 5, tilt_x: 0.1', lambda d: HEAD + surfaces({5: {'tilt': [d, 0, 0]}}, behind=fold),
            HEAD + surfaces(behind=fold))
    by_hand('surface: 5, decenter_x: 0.1', lambda d: HEAD + surfaces({5: {'decenter': [d, 0, 0]}}, behind=fold),
            HEAD + surfaces(behind=fold))
    z, placed = 0, {}
    for i, (_, thickness, _, _) in enumerate(TRIPLET, 1):
        placed[i], z = f'origin: [0, 0, {z!r}]', z + thickness
    def origins(d):
        text = HEAD + surfaces()
        for i, (_, thickness, _, _) in enumerate(TRIPLET, 1):
            own = placed[i].replace('[0', f'[{d!r}') if i == 6 else placed[i]
            text = text.replace(f'thickness: {thickness!r}', own)
        return text.replace('{type: plane}', f'{{type: plane, origin: [0, 0, {z!r}]}}')
    by_hand('surface: 6, decenter_x: 0.02', origins, origins(0.0))


def test_a_folded_lens():
    """An image surface across the axis, where the angles of a tilt are not unique."""
    folded = '''units: mm
wavelengths: [0.55, 0.65]
primary: 1
pupil: {{semi_diameter: 5, distance: 0}}
fields: [0, 1]
field_weights: [1, 2]
surfaces:
  - {{type: sphere, radius: 50, origin: [0, 0, 0], index: 1.5}}
  - {{type: plane, origin: [0, 0, 4], index: 1}}
  - {{type: plane, origin: [0, 0, 50], tilt: [0, 45, 0], mirror: true}}
  - {{type: plane, origin: [-40, 0, 50], tilt: [{}, {}, 0]}}
'''
    by_hand('surface: 4, tilt_x: 2', lambda d: folded.format(d, 90), folded.format(0, 90))
    by_hand('surface: 4, tilt_y: 2', lambda d: folded.format(0, 90 + d), folded.format(0, 90))
    by_hand('surface: 3, tilt_y: 0.1', lambda d: folded.format(0, 90).replace('45', repr(45 + d)),
            folded.format(0, 90))


def test_pickups_and_solves_keep_their_values():
    """A radius that is off in one surface is not off in those that picked it up, and the focus stays."""
    text = HEAD + surfaces({4: {'radius': '{pickup: "surfaces[3].radius", scale: -1}'},
                            6: {'thickness': '{solve: paraxial_focus}'}})
    row, = sensitivity(text, 'surface: 3, radius: 0.1').values()
    image = float(rows('info', written(HEAD + surfaces({4: {'radius': 22.21328}})))[0]['image'])
    hand = HEAD + surfaces({3: {'radius': -22.21328 + 0.1}, 4: {'radius': 22.21328},
                            6: {'thickness': repr(42.20778 + image)}})
    close(row['figure_upper'], spot(hand), 1e-9 * spot(hand))


def test_the_paraxial_compensator():
    lens = HEAD + surfaces()
    row, = sensitivity(lens, 'surface: 1, radius: 0.2', 'surface: 6, thickness: 2, compensator: paraxial').values()
    def image(text):
        return float(rows('info', written(text))[0]['image'])
    for end, d in (('lower', -0.2), ('upper', 0.2)):
        radius = {'radius': 22.01359 + d}
        way = image(HEAD + surfaces({1: radius})) - image(lens)
        close(row['compensator_' + end], way, 1e-11, end)
        by_file = spot(HEAD + surfaces({1: radius, 6: {'thickness': repr(42.20778 + way)}}))
        close(row['figure_' + end], by_file, 1e-9 * by_file, end)


def test_the_best_compensator():
    """Against a search by a finer and finer net."""
    lens = HEAD + surfaces()
    row, = sensitivity(lens, 'surface: 1, radius: 0.2', 'surface: 6, thickness: 2, compensator: figure').values()
    for end, d in (('lower', -0.2), ('upper', 0.2)):
        middle, half = 0.0, 2.0
        built = HEAD + surfaces({1: {'radius': 22.01359 + d}})
        while half > 1e-5:
            net = [middle + half * k / 10 for k in range(-10, 11)]
            sums = {z: 0 for z in net}
            for r in rows('spot', written(built), *RAYS, '--defocus', ','.join(map(repr, net))):
                if r['wavelength'] == 'all':
                    sums[float(r['defocus'])] += (1 if r['field'] == '1' else 2) * float(r['rms']) ** 2 / 3
            middle, half = min(sums, key=sums.get), half / 8
        close(row['compensator_' + end], middle, 1e-4, end)
        close(row['figure_' + end], math.sqrt(sums[middle]), 1e-7 * math.sqrt(sums[middle]), end)
    # at the end of its range, and two of them, are never worse than one
    tight, = sensitivity(lens, 'surface: 1, radius: 0.2',
                         'surface: 6, thickness: 0.1, compensator: figure').values()
    equal(abs(float(tight['compensator_upper'])), 0.1, 'the end of the range')
    two, = sensitivity(lens, 'surface: 1, radius: 0.2', 'surface: 6, thickness: 2, compensator: figure',
                       'surface: 4, thickness: 0.2, compensator: figure').values()
    assert float(two['figure_upper']) < float(row['figure_upper']), two


def test_sorted_and_estimated():
    table = rows('tolerance', EXAMPLE, *RAYS)
    worse = [max(float(r['change_lower']), float(r['change_upper'])) for r in table]
    equal(worse, sorted(worse, reverse=True), 'the worst first')
    text = run('tolerance', EXAMPLE, *RAYS).stdout
    nominal = float(table[0]['figure_lower']) - float(table[0]['change_lower'])
    squares = sum((float(r['change_lower']) ** 2 + float(r['change_upper']) ** 2) / 2 for r in table)
    close(re.search(r'sum of squares: ([\d.]+)', text)[1], nominal + math.sqrt(squares), 1e-7, 'estimate')
    opd = rows('tolerance', EXAMPLE, *RAYS, '--figure', 'opd')
    sums = [float(r['rms']) ** 2 for r in rows('opd', EXAMPLE, *RAYS, '--summary')]
    close(float(opd[0]['figure_lower']) - float(opd[0]['change_lower']), math.sqrt(sum(sums) / 3), 1e-12, 'opd')
    by_json = json.loads(run('tolerance', EXAMPLE, *RAYS, '--format', 'json').stdout)
    equal([r['tolerance'] for r in by_json], [r['tolerance'] for r in table], 'json')


# One of each kind, beside each other, and two that put several numbers off.
KINDS = ('surface: 1, radius: 0.02', 'surface: 2, fringes: 4', 'surface: 3, thickness: [-0.02, 0.03]',
         'surface: 3, decenter_x: 0.01', 'surfaces: [3, 4], decenter_y: 0.01', 'surface: 5, decenter_z: 0.02',
         'surfaces: [3, 4], tilt_x: 0.02, pivot: 0.5', 'surface: 6, tilt_y: 0.02', 'surface: 5, tilt_z: 0.02',
         'surface: 3, index: 5e-4', 'surface: 5, irregularity: 0.5, term: 5', 'surface: 6, irregularity: 0.5, term: 8')
FOCUS = 'surface: 6, thickness: 0.5, compensator: '
PLACE = re.compile(r'(radius|fringes|thickness|_[xyz]|index|irregularity): (\[.*?\]|[\d.e-]+)')


def some(cases):
    """All, but for a sanitized command one."""
    return cases if SCALE >= 0.1 else cases[SEED % len(cases):][:1]


def by_derivative(more, options, sharp, follows):
    """The derivative of each entry against the ends of boxes that get smaller; of the compensator as well."""
    lens = HEAD.replace('[0, 14]', '[3, 14]') + surfaces()
    def table(part):
        scaled = [PLACE.sub(lambda m: f'{m[1]}: {eval(m[2])[1] * part if "[" in m[2] else float(m[2]) * part!r}', kind)
                  for kind in KINDS]
        return {r['tolerance']: r for r in rows('tolerance', written(lens + tolerances(*scaled, *more)), *options)}
    whole, wide, narrow = table(1), table(1 / 8), table(1 / 16)
    for name, row in whole.items():
        d = [(float(r['upper']) - float(r['lower'])) for r in (wide[name], narrow[name])]
        for key, ends, far in (('derivative', 'figure', sharp), ('compensator_derivative', 'compensator', follows)):
            if far is None or key not in row:
                continue
            slope = [(float(r[ends + '_upper']) - float(r[ends + '_lower'])) / w
                     for r, w in zip((wide[name], narrow[name]), d)]
            brute = (4 * slope[1] - slope[0]) / 3
            if row[key] == '':
                equal((name, '--figure' in options), ('surface 6 irregularity 8', True), 'there is no exit pupil')
                continue
            size = abs(brute) + abs(float(row[ends + '_upper']) - float(row[ends + '_lower'])) / 1000 + 1e-6
            close(row[key], brute, far * size + (1e-6 if ends == 'compensator' else 0),
                  f'{key} of {name}, {more} {options}')
            alike = 1e-8 if key == 'derivative' else 1e-6  # (differences over the box)
            close(narrow[name][key], float(row[key]), alike * size, f'{key} of {name}: by any box')
        close(row['linear_upper'] or 0, float(row['derivative'] or 0) * float(row['upper']), 1e-15, name)


def test_derivatives():
    """Exact, compensators following: against lenses that are built with less and less off."""
    for options in some((RAYS, (*RAYS, '--reference', 'centroid'), (*RAYS, '--figure', 'opd'),
                         (*RAYS, '--fields', '2', '--wavelength', '2'))):
        by_derivative((), options, 1e-5, None)
        by_derivative((FOCUS + 'paraxial',), options, 1e-5, 1e-6)
        by_derivative((FOCUS + 'figure',), options, 1e-3, 1e-3)
    by_derivative((FOCUS + 'figure', 'surface: 4, thickness: 0.2, compensator: figure'), RAYS, 1e-2, None)  # (sought in turn)
    # a compensator at the end of its range stays
    lens = HEAD + surfaces()
    entry = 'surface: 1, radius: 0.02'
    tight, = sensitivity(lens, entry, 'surface: 6, thickness: [0, 1e-5], compensator: figure').values()
    free, = sensitivity(lens, entry, FOCUS + 'figure').values()
    equal((tight['compensator_lower'], tight['compensator_derivative']), ('0', '0'))
    assert abs(float(free['compensator_derivative'])) > 1, free
    # a boresight is 0 as designed, and grows to both sides
    for more in ((), (FOCUS + 'paraxial',)):
        scaled = [PLACE.sub(lambda m: f'{m[1]}: {1e-5 * (0.02 if "[" in m[2] else float(m[2]))!r}', kind)
                  for kind in KINDS]
        for row in rows('tolerance', written(lens + tolerances(*scaled, *more)), '--figure', 'boresight', '--quiet'):
            worse = max(float(row['change_lower']), float(row['change_upper']))
            close(row['linear_upper'], worse, 1e-4 * worse + 1e-13, row['tolerance'])
            equal(row['linear_lower'], row['linear_upper'], row['tolerance'])


def test_boresight():
    """Where chief rays end, against sagitta spot of files."""
    lens = HEAD + surfaces()
    row, = rows('tolerance', written(lens + tolerances('surface: 3, decenter_y: 0.02')), '--quiet', '--figure',
                'boresight')
    def ends(text):
        return [(float(r['x']), float(r['y'])) for r in rows('spot', written(text), *RAYS)
                if r['wavelength'] == 'all']
    for end, d in (('lower', -0.02), ('upper', 0.02)):
        way = [math.dist(a, b) for a, b in zip(ends(lens), ends(HEAD + surfaces({3: {'decenter': [0, d, 0]}})))]
        close(row['figure_' + end], math.sqrt((way[0] ** 2 + 2 * way[1] ** 2) / 3), 1e-12, end)
        equal(row['figure_' + end], row['change_' + end], 'from 0')
    # to move the image surface back makes it good again
    row, = rows('tolerance', written(lens + tolerances(
        'surface: 3, decenter_y: 0.02', 'surface: 6, thickness: 0.001, compensator: figure')), '--quiet', '--figure',
        'boresight')
    assert abs(float(row['compensator_upper'])) <= 0.001
    run('tolerance', EXAMPLE, '--figure', 'boresight', '--hexapolar', 4, exit=USAGE)


def test_trials_in_any_threads_and_split():
    def lines(first, count, *more):
        done = run('tolerance', EXAMPLE, '--hexapolar', 2, '--quiet', '--trials', count, '--first', first,
                   '--format', 'csv', *more)
        return done.stdout.splitlines()
    whole = lines(0, 100)
    equal(len(whole), 101)
    for threads in range(1, 8) if OPENMP else ():
        equal(lines(0, 100, '--threads', threads), whole, f'{threads} threads')
    for cut in ((1, 99), (16, 84), (37, 20, 43), (50, 50)):
        parts, first = whole[:1], 0
        for count in cut:
            parts += lines(first, count)[1:]
            first += count
        equal(parts, whole, f'split in {cut}')
    assert lines(0, 3, '--trial-seed', 2)[1:] != whole[1:4], 'another seed'


def test_the_worst_trial_is_a_lens_file():
    path = written('', 'worst.yaml')
    table = rows('tolerance', EXAMPLE, *RAYS, '--trials', 40, '--worst', path)
    worst = max(float(r['figure']) for r in table)
    fields = [float(r['rms']) ** 2 for r in rows('spot', path, *RAYS) if r['wavelength'] == 'all']
    close(math.sqrt(sum(fields) / 3), worst, 1e-15, 'the figure of its file')
    told = run('tolerance', EXAMPLE, *RAYS, '--trials', 40).stdout
    number = max(table, key=lambda r: float(r['figure']))['trial']
    assert f'the worst is trial {number}:' in told, told


# Focus 100, and a spot whose radius is proportional to how far the image is off.
LINEAR = '''units: mm
wavelengths: [0.5]
pupil: {{semi_diameter: 5}}
surfaces:
  - {{type: ideal, focal_length: 100, thickness: 100, semi_diameter: 6}}
  - {{type: plane}}
tolerances: [{{surface: 1, thickness: [0.1, 0.5], distribution: {}}}]
'''


def quantiles(lens, trials, seed):
    text = run('tolerance', lens, '--hexapolar', 1, '--trials', trials, '--trial-seed', seed, '--quiet').stdout
    return [[float(x) if x != '-' else math.nan for x in line.split()]
            for line in text.splitlines() if re.match(r' *\d+ +[\d.-]+e?', line)]


def test_quantiles_against_theory():
    normal = statistics.NormalDist()
    cut = normal.cdf(2) - normal.cdf(-2)
    truth = {'uniform': lambda p: 0.1 + 0.4 * p,
             'normal': lambda p: 0.3 + 0.1 * normal.inv_cdf(normal.cdf(-2) + p * cut)}
    for distribution, off in truth.items():
        lens = written(LINEAR.format(distribution))
        # by two known ends: the figure is linear in how far it is off
        scale = float(rows('tolerance', lens, '--hexapolar', 1, '--quiet')[0]['figure_upper']) / 0.5
        inside = total = 0
        for seed in range(12):
            for percent, figure, low, high in quantiles(lens, 400, seed):
                value = scale * off(percent / 100)
                inside, total = inside + (low <= value <= high), total + 1
                close(figure, value, 0.05 * scale, f'{distribution}, {percent} %')
        assert inside >= 0.88 * total, f'{distribution}: {inside} of {total}, at 95 % each'
        drawn = [float(r['s1_thickness']) for r in rows('tolerance', lens, '--hexapolar', 1, '--trials', 4000,
                                                        '--quiet')]
        assert 0.1 <= min(drawn) and max(drawn) <= 0.5
        drawn.sort()
        apart = max(abs(x - off((k + 0.5) / 4000)) for k, x in enumerate(drawn) if 40 < k < 3960)
        assert apart < 0.015, apart
    drawn = [r['s1_thickness'] for r in rows('tolerance', written(LINEAR.format('ends')), '--hexapolar', 1,
                                             '--trials', 2000, '--quiet')]
    equal(set(drawn), {'0.1', '0.5'})
    assert 900 < drawn.count('0.1') < 1100, drawn.count('0.1')


def test_a_lens_without_a_figure():
    """A stop that is put off so far that the chief ray misses the sphere behind it."""
    lens = written('''units: mm
wavelengths: [0.5]
pupil: {semi_diameter: 1, distance: 0}
surfaces:
  - {type: plane, thickness: 5, semi_diameter: 2}
  - {type: sphere, radius: 5, thickness: 20, index: 1.5}
  - {type: plane}
tolerances: [{surface: 2, decenter_y: 8, distribution: ends}]
''')
    row, = rows('tolerance', lens, '--quiet')
    equal((row['figure_lower'], row['change_upper']), ('', ''), 'empty')
    text = run('tolerance', lens, '--trials', 30, '--limit', 1, '--quiet').stdout
    assert '30 have no figure' in text and 'yield at 1 mm: 0 % (0 to' in text, text


def test_written_and_read_again():
    again = written(run('import', EXAMPLE, '--quiet').stdout)
    equal(run('import', again, '--quiet').stdout, run('import', EXAMPLE, '--quiet').stdout)
    equal(run('tolerance', again, *RAYS).stdout, run('tolerance', EXAMPLE, *RAYS).stdout)


def test_by_name():
    text = (HEAD + surfaces()).replace('radius: -22.21328', 'name: rear one, radius: -22.21328')
    row, = sensitivity(text, 'surface: rear one, radius: 0.05').values()
    equal(row['tolerance'], 'surface 3 radius')


def test_arrays():
    try:
        import numpy
    except ImportError:
        return
    path = written('', 'trials.npy')
    run('tolerance', EXAMPLE, *RAYS, '--trials', 5, '--format', 'npy', '--output', path)
    by_csv = rows('tolerance', EXAMPLE, *RAYS, '--trials', 5)
    table = numpy.load(path)
    for name in by_csv[0]:
        equal([float(r[name]) for r in by_csv], [float(x) for x in table[name]], name)
    only = run('tolerance', EXAMPLE, *RAYS, '--trials', 3, '--format', 'csv', '--columns', 'trial,figure').stdout
    equal(only.splitlines()[0], 'trial,figure')


def test_picture():
    path = written('', 'yield.svg')
    run('tolerance', EXAMPLE, *RAYS, '--trials', 20, '--limit', 0.0115, '--picture', path,
        exit=DECIDED if CAIRO else USAGE)
    assert not CAIRO or b'<svg' in path.read_bytes()


def test_errors():
    lens = HEAD + surfaces()
    line = lens.count('\n') + 2
    for entry, key, words in (
            ('surface: 8, radius: 1', 'surface', 'from 1 to 7'),
            ('surface: nowhere, radius: 1', 'surface', 'by its name'),
            ('radius: 1', 'surface', 'missing'),
            ('surface: 1', 'tolerances', 'must say what is off'),
            ('surface: 1, radius: 1, index: 1', 'index', 'given beside radius'),
            ('surface: 1, radius: -1', 'radius', 'must be positive'),
            ('surface: 1, radius: [2, 1]', 'radius', 'must rise'),
            ('surface: 1, radius: .nan', 'radius', ''),
            ('surface: 1, radius: 30', 'radius', 'pass through 0'),
            ('surface: 7, radius: 1', 'radius', 'has none'),
            ('surface: 7, thickness: 1', 'thickness', 'none behind surface 7'),
            ('surface: 7, index: 1', 'index', 'the last one'),
            ('surface: 7, fringes: 1', 'over', 'missing'),
            ('surfaces: [3, 4], radius: 1', 'surfaces', 'of one surface'),
            ('surfaces: [4, 3], tilt_x: 1', 'surfaces', 'in order'),
            ('surfaces: 3, tilt_x: 1', 'surfaces', 'first and the last'),
            ('surface: 1, surfaces: [1, 2], tilt_x: 1', 'surfaces', 'given beside'),
            ('surface: 1, decenter_x: 1, pivot: 1', 'pivot', 'goes with'),
            ('surface: 1, radius: 1, over: 1', 'over', 'goes with'),
            ('surface: 1, fringes: 1, term: 5', 'term', 'goes with'),
            ('surface: 1, irregularity: 1', 'term', 'missing'),
            ('surface: 1, irregularity: 1, term: 3', 'term', 'from 4 to 49'),
            ('surface: 1, radius: 1, distribution: flat', 'distribution', 'uniform, normal or ends'),
            ('surface: 5, thickness: 1, compensator: paraxial', 'compensator', 'surface 6'),
            ('surface: 6, thickness: 1, compensator: best', 'compensator', 'figure or paraxial'),
            ('surface: 6, thickness: [1, 2], compensator: figure', 'compensator', 'contain 0'),
            ('surface: 6, thickness: 1, compensator: figure, distribution: ends', 'distribution', 'has none'),
            ('surface: 1, radius: 1, colour: red', 'colour', 'unknown key')):
        path = written(lens + tolerances(entry))
        told = run('tolerance', path, exit=BAD_INPUT).stderr
        assert f'{path.name}:{line}: {key}: ' in told and words in told, f'{entry}: {told}'
    told = run('tolerance', written(lens + 'tolerances: {}\n'), exit=BAD_INPUT).stderr
    assert f':{line - 1}: tolerances: must be a list' in told, told
    assert 'tolerances: missing' in run('tolerance', written(lens), exit=BAD_INPUT).stderr
    # what only shows when the lens is built names its entry
    told = run('tolerance', written(lens + tolerances('surface: 1, radius: 1', 'surface: 1, index: 2')),
               exit=BAD_INPUT).stderr
    assert f':{line + 1}: tolerances[2]: surface 1 index at -2: ' in told, told
    # with coma a surface has a slope at its vertex: in front of the stop no pupil can be found
    told = run('tolerance', written(lens + tolerances('surface: 2, irregularity: 0.5, term: 8')), exit=BAD_INPUT).stderr
    assert 'surface 2 irregularity 8 at -0.5: pupil.distance: needed' in told, told
    for options in (('--limit', 1), ('--worst', 'x'), ('--trials', 0), ('--confidence', 100),
                    ('--figure', 'opd', '--reference', 'chief', '--rays', 'x'), ('--figure', 'mtf')):
        run('tolerance', EXAMPLE, *options, exit=USAGE)


main(globals())
