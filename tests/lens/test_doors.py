#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""One question, one answer, at every door: the command, Python and C.

    python3 test_doors.py SAGITTA LIBRARY_OF_PYTHON DOORS

Every analysis that the library lists, of every lens of tests/data/zmx and examples/lenses, and first-order data:
as they come by default, for all wavelengths at the farthest field, and, for a share of them, with fields,
wavelengths and settings that are drawn (SAGITTA_TEST_SEED).  Columns and settings are read from the library's
tables.  The bits of C (doors.c) are compared with Python's, and the json of the command with Python's.  So are
figures with their derivatives, and tolerances: sensitivity and trials.  What is right is another matter:
test_analysis.py and test_numbers.py have oracles.
"""
import json
import math
import os
import pathlib
import random
import re
import struct
import sys

HERE = pathlib.Path(__file__).resolve().parent
TREE = HERE.parents[1]
sys.path.insert(0, str(HERE.parent / 'tool'))
from command import *  # noqa: E402

os.environ['SAGITTA_PYTHON_LIBRARY'] = os.path.abspath(sys.argv[2])
DOORS = os.path.abspath(sys.argv[3])
sys.path.insert(0, str(TREE / 'python'))
try:
    import sagitta
except ImportError as missing:
    print(f'skipped: {missing}')
    sys.exit(77)

from sagitta import _library as library  # noqa: E402

SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'), 0)
SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
SHARE = 0.4 * SCALE            # of the analyses of a lens, with what is drawn
FEW = {'field': {}, 'sweep': {'steps': 4, 'rays': 2}, 'map': {'rays': 5}, 'zernike': {'rays': 8, 'terms': 6},
       'prove': {'boxes': 40}, 'prove_elements': {'boxes': 40}, 'prove_regions': {'boxes': 20},
       'prove_limits': {'boxes': 40, 'limit': 'spot<0.02;pass>=90;incidence<40'},
       'prove_between': {'boxes': 8, 'between': 'fields'}, 'prove_samples': {'boxes': 40},
       'prove_between_limits': {'boxes': 8, 'between': 'fields', 'limit': 'spot<0.02;incidence<40'}}
PART = {'wavefront': ['opd', '--summary'], 'zernike': ['opd', '--zernike'], 'prove_elements': ['prove', '--elements'],
        'prove_regions': ['prove', '--regions'], 'prove_limits': ['prove'],
        'prove_between': ['prove', '--fields', 'all'], 'prove_between_limits': ['prove', '--fields', 'all']}
LONG = ('prove_between', 'prove_between_limits', 'prove_samples')  # asked of these alone
LONG_OF = ('cooke_triplet.yaml', 'hybrid_achromat.yaml')
FATES = {'passed': 1, 'clipped': 2, 'tir': 3, 'evanescent': 4, 'missed': 0, 'lost': -1, 'none': -2,
         'ex': 1, 'ey': 2, 'spot': 3, 'opd': 5, 'incidence': 7, 'clearance': 8,
         'proven': 1, 'broken': 0, 'undecided': -1, 'empty': -2}
FLAG, COUNT, WORD, NUMBER, NUMBERS = range(5)
SEIDEL = ('spherical', 'coma', 'astigmatism', 'petzval', 'distortion', 'axial', 'lateral')


def lenses():
    files = [*(TREE / 'tests/data/zmx').glob('*.zmx'), *(TREE / 'examples/lenses').glob('*.yaml')]
    return sorted(f for f in files if f.suffix != '.csv')


def analyses():
    return [n for n, f in vars(sagitta.Lens).items() if 'An Answer has the columns' in (f.__doc__ or '')]


def bits(x):
    return struct.pack('<d', float(x))


def told(*arguments):
    """The command, whatever its exit status."""
    return subprocess.run([SAGITTA, *map(str, arguments)], capture_output=True, text=True)


def same(cell, mine, what):
    """A cell of json and a number of Python."""
    if cell is None:
        assert math.isnan(mine) or mine == 0 and not isinstance(mine, float), (what, mine)  # (no such place)
    elif cell == 'all':
        equal(mine, 0, what)
    elif isinstance(cell, str):
        equal(FATES.get(cell, cell), int(mine) if cell in FATES else str(mine), what)
    else:
        equal(bits(cell), bits(mine), what)


def analysis_of(name):
    place = 0
    while at := library.library.sgt_analysis_at(place):
        if library.text(at.contents.name) == name:
            return at.contents
        place += 1
    raise KeyError(name)


def settings_of(name):
    analysis = analysis_of(name)
    return analysis.setting[:analysis.settings]


def drawn_settings(draw, name):
    """What suits its kind; steps are few.  Proofs have what FEW says: others would take long."""
    given = {}
    if name.startswith('prove'):
        return given
    for s in settings_of(name):
        if s.kind == WORD:
            given[library.text(s.name)] = draw.choice(library.text(s.words).split('|'))
        elif s.kind == FLAG:
            given[library.text(s.name)] = draw.random() < 0.5
        elif s.kind == COUNT:
            given[library.text(s.name)] = max(s.least, draw.randint(3, 7))
        else:
            given[library.text(s.name)] = [draw.uniform(0, 3) for _ in range(1 if s.kind == NUMBER else 2)]
    if given.get('over') == 'pupil':
        del given['steps']
    if 'radius' in given:
        del given[draw.choice(['radius', 'steps'])]
    if 'from' in given:
        given['to'] = [given['from'][0] + given['to'][0] + 0.5]
    return given


def questions(draw, lens, name):
    """fields, wavelengths, settings; None: by default."""
    few = FEW.get(name, {'rays': 3})
    no_fields = analysis_of(name).no_fields
    yield None, None, few
    yield None if no_fields else [len(lens.fields)], 'all', few
    if draw.random() < SHARE:
        fields = sorted(draw.sample(range(1, len(lens.fields) + 1), draw.randint(1, len(lens.fields))))
        least, most = min(lens.wavelengths), max(lens.wavelengths)
        bands = draw.choice([[draw.randint(1, len(lens.wavelengths))], [draw.uniform(least, most + 0.01)],
                             [len(lens.wavelengths), draw.uniform(least, most + 0.01)]])
        weights = {} if analysis_of(name).no_rays else {'weights': draw.choice(['area', 'equal'])}
        yield None if no_fields else fields, bands, {**few, **weights, **drawn_settings(draw, name)}


def of_command(name, path, fields, wavelengths, given):
    arguments = [*PART.get(name, [name]), *([given['terms']] if name == 'zernike' else []), path, '--format', 'json',
                 '--quiet', '--threads', 1]
    for key, value in given.items():
        if key == 'rays':
            if given.get('over') != 'field':
                arguments += [f'--{sagitta_pattern(name)}', value]
        elif isinstance(value, bool):
            arguments += [f'--{key}'] if value else []
        elif key not in ('terms', 'between'):  # (that is --fields all)
            arguments += [f'--{key}={",".join(map(repr, value)) if isinstance(value, list) else value}']
    for w in [wavelengths] if wavelengths == 'all' else wavelengths or []:
        arguments += ['--wavelength', w]
    if fields:
        arguments += ['--fields', ','.join(map(str, fields))]
    return told(*arguments)


def of_python(lens, name, fields, wavelengths, given):
    given = {key: value for key, value in given.items() if key != 'rays' or given.get('over') != 'field'}
    try:
        return getattr(lens, name)(fields=fields, wavelength=wavelengths, **given)
    except (ValueError, IndexError) as error:
        return error


def for_c(name, fields, wavelengths, given):
    """The question as a line for doors.c."""
    listed = wavelengths if wavelengths == 'all' else ','.join(map(repr, wavelengths or '')) or '-'
    rays = given.get('rays', 0) if given.get('over') != 'field' else 0
    words = [name, ','.join(map(str, fields or '')) or '-', listed, str(rays)]
    of = {library.text(s.name): s for s in settings_of(name)}
    for key, value in given.items():
        if key == 'weights':
            words += ['weights=equal'] if value == 'equal' else []
        elif key != 'rays' and value is not False:
            if of[key].kind == WORD:
                value = library.text(of[key].words).split('|').index(value)
            listed = value if isinstance(value, list) else [value if isinstance(value, str) else value + 0]
            words.append(f'{key}={",".join(x if isinstance(x, str) else repr(x) for x in listed)}')
    return ' '.join(words)


def ask_c(path, lines):
    """For each line what doors.c says of it: lists of [first word, the rest]."""
    done = subprocess.run([DOORS, path], input='\n'.join(lines) + '\n', capture_output=True, text=True)
    equal((done.returncode, done.stderr), (0, ''), path)
    answers = done.stdout.split('end\n')[:-1]
    equal(len(answers), len(lines), path)
    return [[(line.split(' ', 1) + [''])[:2] for line in answer.splitlines()] for answer in answers]


def as_c(x):
    """A number of Python as doors.c writes it."""
    if isinstance(x, float):
        return 'nan' if math.isnan(x) else struct.pack('>d', x).hex()
    return f'{int(x):016x}'


def same_as_c(answer, said, what):
    """Rows, columns and their units, sentences and fates."""
    def all_of(first):
        return [rest for word, rest in said if word == first]
    equal(all_of('columns')[0].split(), [f'{name}={unit}' for name, unit in answer.units.items()], what)
    equal(len(all_of('row')), len(answer), what)
    kinds = [answer.rows.dtype[name].kind for name in answer.rows.dtype.names]
    for words, row in zip(all_of('row'), answer.rows):
        mine = [str(int(x)) if kind == 'i' else as_c(x.item()) for x, kind in zip(row, kinds)]
        equal(words.split(), mine, what)
    equal(all_of('note'), answer.notes, what)
    equal(all_of('legend'), answer.legend, what)
    fates = [as_c(x) if isinstance(x, float) else str(x) for x in vars(answer.fates).values()]
    equal(all_of('fates')[0].split(), fates, what)


def sagitta_pattern(name):
    words = sagitta.Lens.__dict__[name].__doc__
    return words.split('so many rays across.  Default: ')[1].split(',')[0].strip()


def test_analyses():
    draw = random.Random(SEED)
    compared = refused = 0
    for path in lenses():
        lens = sagitta.Lens.read(path)
        asked = [(name, *question) for name in analyses() if name not in LONG or path.name in LONG_OF
                 for question in questions(draw, lens, name)]
        for question, said in zip(asked, ask_c(path, [for_c(*question) for question in asked])):
            name, what = question[0], (path.name, *question)
            answer = of_python(lens, *question)
            if name == 'prove_samples':  # of which the command has the notes alone
                same_as_c(answer, said, what)
                continue
            done = of_command(name, path, *question[1:])
            if isinstance(answer, Exception):
                assert done.returncode not in (0, 1), (what, answer)
                assert dict(said).get('refused', '?') in str(answer), (what, said, answer)
                refused += 1
                continue
            assert done.returncode in (0, 1, 4), (what, done.stderr)  # (4: a limit is broken)
            same_as_c(answer, said, what)
            table = json.loads(done.stdout, parse_int=float)
            equal(len(table), len(answer), what)
            for row, mine in zip(table, answer):
                equal(list(row), list(mine.dtype.names), what)
                for key, cell in row.items():
                    same(cell, mine[key], (what, key))
                    compared += 1
    print(f'       {compared} numbers the same, {refused} times all refuse')
    assert compared > 10000 and refused * 20 < compared


def same_info(told_of, data, seidel, what):
    """An object of `info`, and what Python has."""
    flat = dict(told_of)
    for pupil in ('entrance', 'exit'):
        at = flat.pop(f'{pupil}_pupil')
        flat[f'{pupil}_pupil'], flat[f'{pupil}_radius'] = at['z'], at['radius']
    flat['image_height'] = max((h for h in flat['image_height'] if h is not None), default=None)
    for key, mine in vars(data).items():
        if key not in ('power', 'without_vertex'):                  # (which json has not)
            same(flat[key], mine, (*what, key))
    equal(flat['seidel_why_not'] or '', seidel.why_not, what)
    total = dict.fromkeys(SEIDEL, 0.0)
    for i, row in enumerate(flat['seidel'] or []):
        for key in SEIDEL:
            same(row[key], getattr(seidel, key)[i], (*what, i, key))
            total[key] += float(getattr(seidel, key)[i])
    for key in SEIDEL if flat['seidel'] else ():
        same(flat['seidel_sum'][key], total[key], (*what, 'sum', key))


PARABASAL = [f'{key}_{axis}' for key in ('efl', 'focus', 'image', 'magnification') for axis in 'xy'] + ['power_xy']


def same_parabasal(told_of, rows, said, what):
    """Along the chief rays: the json of `info`, what Python has, and the lines of C."""
    assert [rest for key, rest in said if key == 'parabasal'] == [
        ' '.join(as_c(float(getattr(row, key))) for key in PARABASAL) for row in rows], what
    for row, words in zip(rows, (rest for key, rest in said if key == 'not_parabasal')):
        assert bool(words) == bool(row.why_not) and words in row.why_not, (what, words, row)
    if not told_of['parabasal']:
        equal(told_of['parabasal_why_not'], rows[0].why_not, what)
        return 0
    fields = told_of['parabasal']['fields']
    equal(len(rows), len(fields), what)
    for field, row in zip(fields, rows):
        equal((field['field'], field['why_not'] or ''), (row.field, row.why_not), what)
        for key in PARABASAL:
            same(field[key], getattr(row, key), (*what, field['field'], key))
    return len(fields)


def test_first_order():
    """At each wavelength of the lens, and at one that is drawn."""
    draw = random.Random(SEED)
    answered = refused = along = 0
    for path in lenses():
        lens = sagitta.Lens.read(path)
        several = [*lens.wavelengths, draw.uniform(min(lens.wavelengths), max(lens.wavelengths) + 0.01)]
        asked = [*(n + 1 for n in range(len(lens.wavelengths))), several[-1]]
        for w, said in zip(asked, ask_c(path, [f'first_order {um!r}' for um in several])):
            what, done = (path.name, w), told('info', path, '--format', 'json', '--quiet', '--wavelength', w)
            try:
                data, seidel = lens.first_order(w), lens.seidel(w)
            except ValueError as error:                             # the index is not known there
                assert done.returncode == BAD_INPUT, (what, error)
                assert dict(said).get('refused', '?') in str(error), (what, said, error)
                refused += 1
                continue
            equal(done.returncode, 0, (*what, done.stderr))
            mine = {key: as_c(x) for key, x in vars(data).items()}
            rows = [' '.join(as_c(float(getattr(seidel, key)[i])) for key in SEIDEL) for i in range(len(lens))]
            besides = ('seidel', 'why_not', 'parabasal', 'not_parabasal')
            equal({key: rest for key, rest in said if key not in besides}, mine, what)
            equal([rest for key, rest in said if key == 'seidel'], rows, what)
            equal([rest for key, rest in said if key == 'why_not'], [seidel.why_not], what)
            same_info(json.loads(done.stdout, parse_int=float), data, seidel, what)
            along += same_parabasal(json.loads(done.stdout), lens.parabasal(w), said, what)
            answered += 1
    print(f'       {answered} times the same, {refused} times all refuse; {along} chief rays')
    assert answered > 20 and along > 60


FIGURES = ('spot', 'opd', 'chief', 'efl', 'distortion')
TOLERANCES = ('spot', 'opd', 'boresight')


def numbers_of(said, name):
    return [rest.split() for word, rest in said if word == name]


def test_figures():
    """Residuals, values and derivatives of C and Python; the command has the values, as its analyses tell them."""
    draw = random.Random(SEED)
    compared = refused = 0
    for path in lenses():
        lens = sagitta.Lens.read(path)
        free = [p for p in lens.paths() if 'radius' in p or 'thickness' in p or 'coefficients' in p]
        paths = [p for p in draw.sample(free, min(4, len(free))) if ' ' not in p]
        if not paths:
            continue
        asked = [f'figure {kind} 2 {" ".join(paths)}' for kind in range(len(FIGURES))]
        for figure, said in zip(FIGURES, ask_c(path, asked)):
            what = (path.name, figure, paths)
            try:
                v = lens.variables(paths, figure, rays=2)
                mine = {'residual': v.residuals(v.x0), 'jacobian': v.jacobian(v.x0), 'value': v.values(v.x0),
                        'gradient': v.gradient(v.x0)}
            except ValueError as error:                             # (a LensError is one)
                words = dict(said).get('refused')
                assert words and words in str(error) or 'do not get through' in str(error), (what, said, error)
                refused += 1
                continue
            for name, numbers in mine.items():
                equal(numbers_of(said, name), [[as_c(float(x)) for x in numbers.ravel()]], (*what, name))
                compared += numbers.size
            if figure == 'spot':
                rays = (f'--{sagitta_pattern(figure)}', 2)
                table = json.loads(told('spot', path, *rays, '--format', 'json', '--quiet').stdout)
                for row, x in zip([r for r in table if r['wavelength'] == 'all'], mine['value']):
                    close(row['rms'], x, 1e-12 * x, (*what, 'of the command'))
    print(f'       {compared} numbers the same, {refused} times all refuse')
    assert compared > 10000 and refused < 40, (compared, refused)


def test_tolerances():
    """Sensitivity and trials, by all three."""
    path = TREE / 'examples/lenses/triplet_tolerances.yaml'
    lens = sagitta.Lens.read(path)
    for figure, said in zip(TOLERANCES, ask_c(path, [f'tolerance {i} 2 9' for i in range(len(TOLERANCES))])):
        rays = {} if figure == 'boresight' else {'rays': 2}
        t = lens.tolerance(figure, **rays)
        table, estimate = t.sensitivity()
        names = table.dtype.names[1:]
        equal(numbers_of(said, 'entry'), [[str(row['entry'])] for row in table], figure)
        equal(numbers_of(said, 'sensitivity'), [[as_c(float(row[n])) for n in names] for row in table], figure)
        equal(numbers_of(said, 'sum')[0][2], as_c(estimate), figure)
        trials = t.trials(9)
        equal(numbers_of(said, 'trial'), [[as_c(float(x))] for x in trials.figure], figure)
        equal(numbers_of(said, 'drawn'), [[as_c(float(x)) for x in row] for row in trials.value], figure)
        own = {'spot': 'spot', 'opd': 'wavefront'}.get(figure)      # (the analysis whose pattern it takes)
        pattern = [f'--{sagitta_pattern(own)}', 2] if own else []

        def by_command(*more):
            done = told('tolerance', path, '--figure', figure, *pattern, '--format', 'json', '--quiet', *more)
            return json.loads(done.stdout, parse_int=float)
        for row, mine in zip(by_command(), table, strict=True):
            equal(row['tolerance'], t.entries[mine['entry']].text, figure)
            for name in names:
                if name != 'worse':
                    same(row[name], float(mine[name]), (figure, row['tolerance'], name))
        for row, value, drawn in zip(by_command('--trials', 9), trials.figure, trials.value, strict=True):
            for cell, x in zip(list(row.values())[1:], [value, *drawn], strict=True):
                same(cell, float(x), (figure, row['trial']))


def test_patterns_in_blocks():
    """A study makes its points block by block: those of sgt_pupil_points, in their order."""
    lens = sagitta.Lens.read(TREE / 'examples/lenses/cooke_triplet.yaml')
    for pattern, several in (('fan', (1, 300)), ('grid', (1, 3, 25)), ('hexapolar', (1, 12)), ('random', (1, 400)),
                             ('sobol', (1, 128, 129, 400)), ('cells', (1, 2, 21)), ('cross', (1, 2, 131, 200))):
        for rays in several:
            mine, whole = lens.ends(1, pattern=pattern, rays=rays, seed=5), lens.launch(1, pattern, rays, seed=5)
            for one, other in ((mine.px, whole.px), (mine.py, whole.py), (mine.weight, whole.weight)):
                assert one.tobytes() == other.tobytes(), (pattern, rays)
            alike = lens.ends(1, pattern=pattern, rays=rays, seed=5, weights='equal')
            assert (alike.weight == 1 / len(alike)).all() and alike.px.tobytes() == mine.px.tobytes(), (pattern, rays)


def test_memory():
    """It does not grow with the number of rays."""
    if b'__asan_init' in pathlib.Path(SAGITTA).read_bytes():
        return                                             # what is freed is kept for a while

    def most(rays):
        child = subprocess.Popen([SAGITTA, 'spot', TREE / 'examples/lenses/cooke_triplet.yaml', '--fields', '1',
                                  '--cells', str(rays)], stdout=subprocess.DEVNULL)
        _, _, usage = os.wait4(child.pid, 0)
        return usage.ru_maxrss                             # kB
    less, more = most(60), most(400)
    assert more < less + 3000, f'{more} kB for 125,000 rays, {less} kB for 2,800'


def test_options_have_room():
    """Of the options of each analysis each word that is reserved must be zero: the call tells which is not."""
    header = (TREE / 'include/sagitta/study.h').read_text()
    room = {name: int(words) for words, name in
            re.findall(r'\n    unsigned long long reserved_\[(\d)\];\n} sgt_(\w+)_options;', header)}
    opd = ('wavefront', 'zernike')  # views of "opd", with its options
    asked = {**{name: words for name, words in room.items() if name != 'study'}, **{name: room['opd'] for name in opd}}
    assert len(asked) >= 8, asked
    lines = [f'room {name} {words}' for name, words in asked.items()]
    for (name, words), said in zip(asked.items(), ask_c(TREE / 'examples/lenses/ftheta.yaml', lines)):
        equal([' '.join(line).split(':')[0] for line in said],
              [f'refused options.reserved_[{i}]' for i in range(words)], name)


def test_threads():
    lens = sagitta.Lens.read(TREE / 'examples/lenses/double_gauss.yaml')
    for name in analyses():
        given = FEW[name] if name.startswith('prove') else {} if name == 'field' else {'rays': 8 if name == 'sweep' else 20}
        one = getattr(lens, name)(**given).rows
        for threads in (2, 5, 7):
            several = getattr(lens, name)(threads=threads, **given).rows
            for column in one.dtype.names:
                assert several[column].tobytes() == one[column].tobytes(), (name, threads, column)


print(f'SAGITTA_TEST_SEED={SEED}')
main(globals())
