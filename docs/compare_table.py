#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Published digits beside those of the command and of an oracle: the tables of compare.md.

    python3 docs/compare_table.py build/src/tool/sagitta            writes them between their marks
    python3 docs/compare_table.py --check build/src/tool/sagitta    says whether they are as they were

The figures that others print are tests/data/published/*.csv, with the lenses beside them; the oracle is
tests/lens/published_oracle.py, 50 digits.  A figure is met if the oracle's number, rounded to as many places, is
what is printed; in the tests of a peer (peer_tests.csv), also if it is cut off there.  One of 15 digits and more is
that of a double, and may be off by some roundings.  Each one that is not met has to be met by another definition,
EXPLAINED below, or be off by no more than what ROUNDED says; else, and wherever sagitta is off, this command fails.

--check lets a number differ in its last place, and asks whether the times that the page repeats stand in the pages
that it names.
"""
import csv
import functools
import json
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
DATA = HERE.parent / 'tests/data'
PAGE = HERE / 'compare.md'
sys.path.insert(0, str(HERE.parent / 'tests/lens'))
from published_oracle import Lens, mp, mpf, zernike  # noqa: E402

SAGITTA = sys.argv[-1]
STEP = mpf('0.001')             # of the pupil, in OpticStudio's foci
NEAR = mpf('0.01')              # degrees: of the chief ray in OpticStudio's exit pupil
WITHIN = 2e-11                  # of a number, or of 1: how far the command may be from the oracle


# ------------------------------------------------------------------ the command

@functools.lru_cache(maxsize=None)
def asked(*arguments):
    done = subprocess.run([SAGITTA, *arguments, '--quiet'], capture_output=True, text=True, check=True)
    return json.loads(done.stdout) if 'json' in arguments else list(csv.DictReader(done.stdout.splitlines()))


def path_of(lens):
    return str(DATA / ('published_triplet.yaml' if lens == 'telescope_triplet' else f'published/{lens}.yaml'))


def info(lens, key, wave=None):
    """A number of `sagitta info`; wave: from 0."""
    more = [] if wave is None else ['--wavelength', str(wave + 1)]
    out = asked('info', path_of(lens), '--format', 'json', *more)
    for part in key.split('.'):
        out = out[part]
    return mpf(out)


def ray(lens, degrees, px, py, wave=None):
    """Where a ray ends: point and direction, as the oracle has them."""
    more = [] if wave is None else ['--wavelength', str(wave + 1)]
    row = asked('trace', path_of(lens), '--field', str(degrees), '--pupil', f'{px} {py}', '--no-apertures', '--last',
                '--format', 'csv', *more)[0]
    return [mpf(row[k]) for k in 'xyz'], [mpf(row[k]) for k in 'lmn']


def spots(lens, field, key, wave=0, reference='chief'):
    rows = asked('spot', path_of(lens), '--hexapolar', '6', '--weights', 'equal', '--reference', reference,
                 '--format', 'csv')
    rows = [r for r in rows if r['field'] == str(field) and r['wavelength'] != 'all']
    return mpf(rows[wave][key])


def curve(lens, degrees, key, kind='tan', wavelength=None):
    more = ['--wavelength', wavelength] if wavelength else []
    rows = asked('field', path_of(lens), '--field', degrees, '--distortion', kind, '--format', 'csv', *more)
    return mpf(rows[0][key])


def coefficient(place):
    rows = asked('opd', path_of('hubble'), '--zernike', '37', '--order', 'fringe', '--hexapolar', '8', '--fields', '3',
                 '--format', 'csv')
    return -mpf(rows[place - 1]['coefficient'])


def seidel(lens, place):
    rows = asked('info', path_of(lens), '--format', 'json')['seidel_sum']
    return mpf(rows[('spherical', 'coma', 'astigmatism', 'petzval', 'distortion')[place]])


def crosses(one):
    (p, d) = one
    return p[2] - p[1] * d[2] / d[1]


# ------------------------------------------------------------------ what each figure is

@functools.lru_cache(maxsize=None)
def oracle(lens, wave=None, significant=None):
    return Lens(path_of(lens), wave, significant)


@functools.lru_cache(maxsize=None)
def fitted():
    mine = oracle('hubble')
    return zernike(mine, mine.fields[-1], 8)


@functools.lru_cache(maxsize=None)
def oracle_spot(lens, field, wave=None, about=None):
    """about: None the chief ray, else the centroid of this wavelength."""
    mine = oracle(lens, wave)
    if about is None:
        return mine.spot(mine.fields[field], 6)
    middle = oracle(lens, about).spot(mine.fields[field], 6, centroid=True)['about']
    return mine.spot(mine.fields[field], 6, about=middle)


FIRST_ORDER = {  # quantity: key of info and its factor, key of the oracle and its factor
    'focal length': ('efl', 1, 'efl', 1),
    'entrance pupil: diameter': ('entrance_pupil.radius', 2, None, 0),
    'entrance pupil: z from surface 1': ('entrance_pupil.z', 1, 'entrance pupil', 1),
    'exit pupil: diameter': ('exit_pupil.radius', 2, 'exit radius', 2),
    'exit pupil: radius': ('exit_pupil.radius', 1, 'exit radius', 1),
    'marginal ray at the stop': ('stop_radius', 1, 'at the stop', 1),
    'exit pupil: z from the image': ('exit_pupil.z', 1, 'exit pupil', 1),
    'F-number': ('f_number', 1, 'f number', 1),
    'rear focus from the image': ('focus', 1, 'focus', 1),
    'rear principal plane from the image': ('rear_principal', 1, 'rear principal', 1),
    'Lagrange invariant': ('lagrange', -1, 'lagrange', 1)}

KEYS_OF_SPOT = {'RMS spot': ('rms', 'rms'), 'largest distance': ('geometric', 'largest')}


def axial(wave, of_command):
    """From the last vertex to where the marginal ray crosses the axis; its sine."""
    one = ray('objective', 0, 0, 1, wave) if of_command else oracle('objective', wave).ray(mpf(0), 0, 1)
    return 47 + crosses(one), -one[1][1]


def of_objective(quantity, of_command):
    far, sine = axial(1, of_command)
    if of_command:
        near, slope = info('objective', 'bfd'), 1 / (2 * info('objective', 'f_number_working'))
    else:
        data = oracle('objective').first_order()
        near, slope = data['bfd'], abs(data['slope'])
    return {'marginal ray: from the last vertex': lambda: far,
            'marginal ray: angle to the axis': lambda: mp.asin(sine),
            'paraxial ray: from the last vertex': lambda: near,
            'paraxial ray: angle to the axis': lambda: slope,
            'longitudinal spherical aberration': lambda: near - far,
            'offence against the sine condition': lambda: 1 - near * slope / (sine * far),
            'axial colour, F less C': lambda: axial(2, of_command)[0] - axial(0, of_command)[0]}[quantity]()


def both(lens, quantity):
    """The number of the command, and that of the oracle."""
    if lens == 'objective':
        return of_objective(quantity, True), of_objective(quantity, False)
    mine = oracle(lens)
    if quantity in FIRST_ORDER:
        key, factor, other, times = FIRST_ORDER[quantity]
        return factor * info(lens, key), times * mine.first_order()[other] if other else 2 * mine.radius
    if quantity == 'Petzval curvature':
        return -1 / info(lens, 'petzval_radius'), mine.seidel()[3] / mine.first_order()['lagrange'] ** 2
    if quantity == 'paraxial image height':
        heights = asked('info', path_of(lens), '--format', 'json')['image_height']
        return mpf(max(heights)), mine.first_order()['image height']
    if m := re.fullmatch(r'Seidel S(\d)', quantity):
        sign, place = -1 if 'singlet' in lens else 1, int(m[1]) - 1
        return sign * seidel(lens, place), sign * mine.seidel()[place]
    if m := re.fullmatch(r'ray ([\d.]+), ([\d.-]+) ([\d.-]+): (.)', quantity):
        place = 'xyz lmn'.index(m[4])
        ends = ray(lens, *m.groups()[:3]), mine.ray(mpf(m[1]), mpf(m[2]), mpf(m[3]))
        return tuple(e[place // 4][place % 4] for e in ends)
    if m := re.fullmatch(r'(RMS spot|largest distance).*?(on the axis|at 0.15 degrees)', quantity):
        key, field = KEYS_OF_SPOT[m[1]], 0 if m[2] == 'on the axis' else 2
        return spots(lens, field + 1, key[0]), oracle_spot(lens, field)[key[1]]
    if m := re.fullmatch(r'(RMS spot|largest distance), field (\d), ([\d.]+) um', quantity):
        key, field = KEYS_OF_SPOT[m[1]], int(m[2]) - 1
        wave = ('0.48', '0.55', '0.65').index(m[3])
        return spots(lens, m[2], key[0], wave, 'centroid'), oracle_spot(lens, field, wave, wave)[key[1]]
    if quantity == 'Airy radius on the axis':
        return (mpf(asked('spot', path_of(lens), '--fields', '1', '--wavelength', '2', '--format', 'csv')[0]['airy']),
                mpf('1.219669891266504454926538847465') * mine.um / 1000 * mine.first_order()['f number'])
    if m := re.fullmatch(r'Zernike (\d), waves', quantity):
        place = int(m[1])
        # (OpticStudio's differences have the other sign, and its angle goes from x: cos 2 is - cos 2, sines are
        # what cosines from y are)
        turned = {3: 2, 8: 7}
        return coefficient(place), (1 if place == 5 else -1) * fitted()[turned.get(place, place)]
    return of_field(lens, quantity, mine)


def of_field(lens, quantity, mine):
    a = mine.fields[-1]
    if quantity == 'distortion, %':
        height = mine.ray(a, 0, 0)[0][1]
        return curve(lens, '0.15', 'distortion_percent'), 100 * (height / mine.first_order()['image height'] - 1)
    if quantity == 'focus on the axis':
        return curve(lens, '0', 'sagittal'), mine.coddington(mpf(0))[1]
    place = ('tangential focus', 'sagittal focus').index(quantity)
    return curve(lens, '0.15', quantity.split()[0]), mine.coddington(a)[place]


# ------------------------------------------------------------------ other definitions

def rounded_file():
    """The focal length, of the command, of the telescope as its file had it: nine digits."""
    text = pathlib.Path(path_of('hubble')).read_text()
    for old in ('-11040.02286', '-1349.31166', '-635.38227'):
        text = text.replace(f'radius: {old}', f'curvature: {1 / float(old):.8E}')
    with tempfile.NamedTemporaryFile('w', suffix='.yaml') as file:
        file.write(text)
        file.flush()
        return mpf(asked('info', file.name, '--format', 'json')['efl'])


def level(lens, degrees, px, py, axis):
    """The chief ray and one beside it, met as if both points had the same z: by rays of the command, and exactly."""
    mine, chief = oracle(lens), ray(lens, degrees, 0, 0)
    return (mine.meet(chief, ray(lens, degrees, px, py), axis, True),
            mine.meet(mine.ray(mpf(degrees), 0, 0), mine.ray(mpf(degrees), mpf(px), mpf(py)), axis, True))


def surface_distortion():
    mine = oracle('hubble')
    height = mine.ray(mine.fields[-1], 0, 0)[0][1]
    return (curve('hubble', '0.15', 'distortion_percent', 'tan-surface'),
            100 * (height / mine.first_order()['chief at the image'] - 1))


def near_pupil():
    return crosses(ray('triplet', NEAR, 0, 0)), oracle('triplet').crosses_axis(NEAR)


def near_size():
    """Twice the height there of the ray through 0.001 of the pupil, times 1000."""
    out = []
    for (p, d), z in zip((ray('triplet', 0, 0, STEP), oracle('triplet').ray(mpf(0), 0, STEP)), near_pupil()):
        out.append(2 / STEP * abs(p[1] + (z - p[2]) * d[1] / d[2]))
    return tuple(out)


def about_primary(key):
    """Of field 3 at 0.65 um, about the centroid of 0.55 um."""
    mine = oracle_spot('triplet', 2, 2, 1)[key]
    points = asked('ends', path_of('triplet'), '--hexapolar', '6', '--fields', '3', '--format', 'csv')
    several = {w: [(mpf(r['x']), mpf(r['y'])) for r in points if r['wavelength'] == w] for w in ('0.55', '0.65')}
    about = [sum(p[i] for p in several['0.55']) / len(several['0.55']) for i in (0, 1)]
    square = [(p[0] - about[0]) ** 2 + (p[1] - about[1]) ** 2 for p in several['0.65']]
    return mp.sqrt(sum(square) / len(square) if key == 'rms' else max(square)), mine


def real_airy():
    out = []
    for p, d in (ray('triplet', 0, 0, 1), oracle('triplet').ray(mpf(0), 0, 1)):
        out.append(mpf('1.22') * mpf('0.00055') / (2 * abs(d[1])))
    return tuple(out)


EXPLAINED = {  # what gives the printed number: the command, the oracle, and in words
    ('hubble', 'focal length'): (lambda: (rounded_file(), oracle('hubble', None, 9).first_order()['efl']),
                                 'the lens file had curvatures of nine digits'),
    ('hubble', 'distortion, %'): (surface_distortion,
                                  'against f tan, scaled to the image surface: `--distortion tan-surface`'),
    ('hubble', 'focus on the axis'): (lambda: level('hubble', '0', '0', '0.001', 1),
                                      'where two rays meet: chief, and 0, 0.001'),
    ('hubble', 'sagittal focus'): (lambda: level('hubble', '0.15', '0.001', '0', 0), 'the same with the ray 0.001, 0'),
    ('hubble', 'tangential focus'): (lambda: level('hubble', '0.15', '0', '0.001', 1),
                                     'the same with the ray 0, 0.001, both taken as if they ended at one z'),
    ('triplet', 'exit pupil: z from the image'): (near_pupil,
                                                  'where the real chief ray of 0.01 degrees crosses the axis'),
    ('triplet', 'exit pupil: diameter'): (near_size, '2000 times the height there of the real ray 0, 0.001'),
    ('triplet', 'RMS spot, field 3, 0.65 um'): (lambda: about_primary('rms'), 'about the centroid of 0.55 um'),
    ('triplet', 'largest distance, field 3, 0.65 um'): (lambda: about_primary('largest'),
                                                        'about the centroid of 0.55 um'),
    ('triplet', 'Airy radius on the axis'): (real_airy, '1.22 wavelength / (2 sin) of the real marginal ray')}
# Off by rounding: by so much at most, and why.
GRAIN = mpf(2) ** -52
PATH = 17385 / mpf('0.00055') * GRAIN         # waves: a unit in the last place of a path of 17385 mm
ROUNDED = {('hubble', 'Zernike 1, waves'): (2 * PATH,
                                            'two units in the last place of a path of 17,385 mm are 1.4e-8 waves'),
           ('hubble', 'RMS spot on the axis'): (11040 * GRAIN, 'a unit in the last place of 11,040 mm is 2.5e-12 mm'),
           ('hubble', 'ray 0.105, 0.7 0: m'): (mpf(0), 'rounded twice: 0.01515318246, 0.0151531825, 0.015153183')}


# ------------------------------------------------------------------ tables

def places_of(printed):
    """The last place of a number as it is printed."""
    mantissa, _, power = printed.partition('e')
    return mpf(10) ** (int(power or 0) - len(mantissa.partition('.')[2]))


def digits_of(printed):
    return len(printed.strip('-0.').partition('e')[0].replace('.', ''))


def is_met(printed, exact, cut=False):
    """'met', in words; None: no.  cut: digits may be cut off, and not rounded."""
    unit, wanted = places_of(printed), mpf(printed)
    off = abs(exact - wanted)
    if off <= unit / 2 * (1 + mpf(10) ** -9):
        return 'met'
    if digits_of(printed) >= 15 and off < 50 * 4 * GRAIN:
        return f'met, but for {mp.nstr(off, 2)}'
    return 'met, cut off' if cut and 0 < abs(exact) - abs(wanted) < unit and exact * wanted > 0 else None


def shown(x, digits):
    return mp.nstr(x, digits, strip_zeros=True, min_fixed=-6, max_fixed=7) if abs(x) > mpf(10) ** -30 else '0'


def short(x):
    return mp.nstr(abs(x), 2, min_fixed=0, max_fixed=0)


def row_of(lens, quantity, printed, faults, cut):
    here, exact = both(lens, quantity)
    if abs(here - exact) > (PATH if 'waves' in quantity else WITHIN * max(1, abs(exact))):
        faults.append(f'{lens}, {quantity}: {here} here, {exact}')
    verdict, unit = is_met(printed, exact, cut), places_of(printed)
    if not verdict:
        off = mpf(printed) - exact
        verdict = f'**off by {short(off)}**'
        if (lens, quantity) in ROUNDED:
            most, why = ROUNDED[lens, quantity]
            twice = mp.floor(mp.floor(exact * 10 / unit + mpf(1) / 2) / 10 + mpf(1) / 2) == mp.nint(mpf(printed) / unit)
            verdict += f': {why}'
            if not (twice if most == 0 else abs(off) <= most + unit / 2):
                faults.append(f'{lens}, {quantity}: more than rounding')
        elif (lens, quantity) not in EXPLAINED:
            faults.append(f'{lens}, {quantity}: {printed} is not explained; {exact}')
    elif (lens, quantity) in EXPLAINED:
        faults.append(f'{lens}, {quantity}: is met, and explained')
    elif verdict == 'met' and not is_met(printed, here):
        verdict += f'; here off by {short(here - exact)}'
    digits = min(max(7, digits_of(printed) + 1), 16)
    return f'| {quantity} | {printed} | {shown(here, digits)} | {shown(exact, 20)} | {verdict} |'


def table(rows, faults, cut=False):
    head = '| quantity | printed there | here | 50 digits | |\n|---|---|---|---|---|\n'
    return head + ''.join(row_of(*row, faults, cut) + '\n' for row in rows)


def explained(keys, figures, faults, cut=False):
    out = ('| quantity | printed there | here, so defined | 50 digits, so defined | what it is |\n'
           '|---|---|---|---|---|\n')
    for lens, quantity in keys:
        printed = next(p for a, b, p in figures if (a, b) == (lens, quantity))
        here, exact = EXPLAINED[lens, quantity][0]()
        if not is_met(printed, exact, cut):
            faults.append(f'{lens}, {quantity}: {printed} by its definition is {exact}')
        if not is_met(printed, here, cut) and places_of(printed) > mpf(10) ** -11:
            faults.append(f'{lens}, {quantity}: {printed} by its definition is {here} here')
        out += f'| {quantity} | {printed} | {shown(here, 11)} | {shown(exact, 20)} | {EXPLAINED[lens, quantity][1]} |\n'
    return out


def ways():
    """Where tangential rays of the telescope meet: near and by a step, with and without the depths of their ends."""
    mine, near, fine = oracle('hubble'), mpf(10) ** -30, mpf('1e-5')
    a = mine.fields[-1]

    def met(low, high, level=False):
        return mine.meet(mine.ray(a, 0, low), mine.ray(a, 0, high), 1, level)
    rows = (('Coddington\'s equation along the chief ray', mine.coddington(a)[0]),
            ('the chief ray and one beside it, in the limit', met(0, near)),
            ('the same, by half as much the other way', met(0, -near / 2)),
            ('rays -1e-5 and 1e-5, from the first (Optiland, which prints -1.67515169)', met(-fine, fine)),
            ('rays 0 and 0.001', met(0, STEP)),
            ('in the limit, as if all rays ended at one z', met(0, near, True)),
            ('rays 0 and 0.001, as if both ended at one z (OpticStudio, -1.66509538)', met(0, STEP, True)))
    return '| what meets | mm from the image surface |\n|---|---|\n' + ''.join(
        f'| {what} | {shown(x, 16)} |\n' for what, x in rows)


def degrees_of(text):
    top, _, bottom = text.partition('/')
    return mpf(top) / mpf(bottom or 1)


def telescope_triplet(faults):
    """The foci and distortions of Optiland's tests, tests/data/published_triplet.csv."""
    out = '| quantity | um | degrees | printed there | here | 50 digits | |\n|---|---|---|---|---|---|---|\n'
    with (DATA / 'published_triplet.csv').open() as file:
        for r in csv.DictReader(file):
            wave = ('0.4861', '0.5876', '0.6563').index(r['wavelength'])
            mine, a, what = oracle('telescope_triplet', wave), degrees_of(r['degrees']), r['quantity']
            angle = mp.nstr(a, 17)
            if what in ('tan', 'theta'):
                radians = a * mp.pi / 180
                scale = mine.first_order()['chief at the image'] / mp.tan(mine.fields[-1] * mp.pi / 180)
                exact = 100 * (mine.ray(a, 0, 0)[0][1] / (scale * (mp.tan(radians) if what == 'tan' else radians)) - 1)
                here = curve('telescope_triplet', angle, 'distortion_percent', what + '-surface', r['wavelength'])
            else:
                exact = mine.coddington(a)[('tangential', 'sagittal').index(what)]
                here = curve('telescope_triplet', angle, what, 'tan', r['wavelength'])
            verdict = is_met(r['value'], exact, True)
            if not verdict or abs(here - exact) > 1e-10:
                faults.append(f'{r}: {here} here, {exact}')
            name = f'distortion, {what}, %' if what in ('tan', 'theta') else f'{what} focus'
            out += (f'| {name} | {r["wavelength"]} | {r["degrees"]} | {r["value"]} | {shown(here, 7)} | '
                    f'{shown(exact, 20)} | {verdict} |\n')
    return out


def read(name):
    with (DATA / 'published' / name).open() as file:
        return [(r['lens'], r['quantity'], r['printed']) for r in csv.DictReader(file)]


def made(faults):
    figures, peers = read('figures.csv'), read('peer_tests.csv')
    out = {lens: table([r for r in figures if r[0] == lens], faults)
           for lens in ('hubble', 'triplet', 'singlet', 'objective', 'patent_lens', 'sasian_triplet')}
    for lens in ('hubble', 'triplet'):
        keys = [k for k in EXPLAINED if k[0] == lens and any(k == r[:2] for r in figures)]
        out[lens + ', explained'] = explained(keys, figures, faults)
    out['tests of Optiland'] = table(peers, faults, True)
    out['tests of Optiland, explained'] = explained([k for k in EXPLAINED if any(k == r[:2] for r in peers)], peers,
                                                    faults, True)
    out['tests of Optiland, a telescope objective'] = telescope_triplet(faults)
    out['ways'] = ways()
    count = sum(len(text.splitlines()) - 2 for name, text in out.items() if 'explained' not in name and name != 'ways')
    out['how many'] = (f'Of {count} figures {count - len(EXPLAINED) - len(ROUNDED)} are met as sagitta defines them, '
                       f'{len(EXPLAINED)} by another definition, and {len(ROUNDED)} but for rounding.\n')
    return out


def marks(name):
    return f'<!-- docs/compare_table.py, {name}: from here -->\n', '<!-- to here -->\n'


def alike(one, other):
    """A number may differ in its last place."""
    if one == other:
        return True
    try:
        return abs(mpf(one) - mpf(other)) <= 2 * places_of(min(one, other, key=len))
    except ValueError:
        return False


def split(text):
    return re.split(r'[\s|*]+', text)


def check_times(page, faults):
    """Each number in a table of the last section stands in the page that the row links to."""
    section, found = page.split('\n## In time', 1)[1].split('\n## ', 1)[0], 0
    for row in re.findall(r'^\|.*\]\(.*$', section, re.M):
        where = re.search(r'\]\(([\w/]+\.md)', row)[1]
        for number in re.findall(r'(?<![\w.])\d[\d,.]*\d', re.sub(r'\]\(.*?\)', '', row)):
            found += 1
            if not re.search(rf'(?<![\d.,]){re.escape(number)}(?![\d.,]*\d)', (HERE / where).read_text()):
                faults.append(f'{number} of "{row}" is not in {where}')
    if found < 10:
        faults.append('the times are not found')


def main():
    faults, page = [], PAGE.read_text()
    tables = made(faults)
    if '--check' in sys.argv:
        check_times(page, faults)
    for name, text in tables.items():
        begin, end = marks(name)
        if page.count(begin) != 1:
            faults.append(f'no marks of "{name}" in {PAGE.name}')
            continue
        before, rest = page.split(begin)
        old, after = rest.split(end, 1)
        if '--check' in sys.argv:
            words, mine = split(old), split(text)
            if len(words) != len(mine) or not all(map(alike, words, mine)):
                faults.append(f'the table "{name}" of {PAGE.name} is not what {pathlib.Path(__file__).name} writes')
        else:
            page = before + begin + text + end + after
    if '--check' not in sys.argv:
        PAGE.write_text(page)
    print('\n'.join([*faults, tables['how many'].strip(), f'{len(faults)} faults']))
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
