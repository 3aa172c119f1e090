#!/usr/bin/env python3
"""One question, one answer, at every door: the command, Python and C.

    python3 test_doors.py SAGITTA LIBRARY_OF_PYTHON DOORS

Every analysis that the library lists, of every lens of tests/data/zmx and examples/lenses, at several wavelengths and
fields.  The json of the command is compared with Python's numbers bit by bit, and what C (doors.c) writes of its rows
with both.  What is right is another matter: test_analysis.py and test_numbers.py have oracles.
"""
import json
import math
import os
import pathlib
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

FEW = {'field': {}, 'sweep': {'steps': 4, 'rays': 2}, 'map': {'rays': 5}, 'zernike': {'rays': 8, 'terms': 6}}
PART = {'wavefront': ['opd', '--summary'], 'zernike': ['opd', '--zernike', '6']}
FATES = {'passed': 1, 'clipped': 2, 'tir': 3, 'missed': 0, 'lost': -1, 'none': -2}


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
        assert math.isnan(mine) or mine == 0, (what, cell, mine)    # 0: a place that there is not
    elif cell == 'all':
        equal(mine, 0, what)
    elif isinstance(cell, str):
        equal(FATES.get(cell, cell), int(mine) if cell in FATES else str(mine), what)
    else:
        equal(bits(cell), bits(mine), what)


def both(lens, path, name, wavelength, field):
    """Asks at both doors; returns the command's words and Python's answer, or why there is none."""
    few = FEW.get(name, {'rays': 3})
    arguments = [*PART.get(name, [name]), path, '--format', 'json', '--quiet', '--threads', 1]
    given = dict(few)
    for key, value in few.items():
        if key == 'rays':
            arguments += [f'--{sagitta_pattern(name)}', value]
        elif key != 'terms':
            arguments += [f'--{key}', value]
    if wavelength:
        arguments += ['--wavelength', wavelength]
        given['wavelength'] = 'all' if wavelength == 'all' else int(wavelength)
    if field and name != 'sweep':
        arguments += ['--fields', field]
        given['field'] = int(field)
    done = told(*arguments)
    try:
        return done, getattr(lens, name)(**given)
    except (ValueError, IndexError) as error:
        return done, error


def sagitta_pattern(name):
    words = sagitta.Lens.__dict__[name].__doc__
    return words.split('so many rays across.  Default: ')[1].split(',')[0].strip()


def test_command_and_python():
    compared = told = 0
    for path in lenses():
        lens = sagitta.Lens.read(path)
        for name in analyses():
            for wavelength, field in (('', ''), ('all', str(len(lens.fields)))):
                what = f'{path.name} {name} {wavelength} {field}'
                done, answer = both(lens, path, name, wavelength, field)
                if isinstance(answer, Exception):
                    assert done.returncode not in (0, 1), (what, answer)
                    told += 1
                    continue
                table = json.loads(done.stdout, parse_int=float)
                equal(len(table), len(answer), what)
                for row, mine in zip(table, answer):
                    equal(list(row), list(mine.dtype.names), what)
                    for key, cell in row.items():
                        same(cell, mine[key], (what, key))
                        compared += 1
    print(f'       {compared} numbers the same, {told} times both refuse')
    assert compared > 10000


def test_command_and_c():
    """Typed rows, as a program of C reads them."""
    for path in lenses():
        done = subprocess.run([DOORS, path], capture_output=True, text=True)
        if done.returncode:
            continue
        rows_of_c = [line.split() for line in done.stdout.splitlines()]
        for name, keys in (('spot', ('field', 'rays', 'rms', 'y', 'digits')), ('fan', ('field', 'px', 'ey', 'e_err')),
                           ('sweep', ('at', 'passed', 'evals')), ('field', ('field', 'fy', 'distortion_percent'))):
            rays = [] if name == 'field' else ['--' + sagitta_pattern(name), 3]
            table = json.loads(told(name, path, '--format', 'json', '--quiet', *rays).stdout, parse_int=float)
            mine = [words[1:] for words in rows_of_c if words[0] == name]
            equal(len(table), len(mine), (path.name, name))
            for row, words in zip(table, mine):
                for key, word in zip(keys, words):
                    cell = row.get(key, row.get(f'{key}_mrad'))
                    value = float.fromhex(word)
                    assert (cell is None and math.isnan(value)) or bits(cell) == bits(value), (path.name, name, key, row)


def test_patterns_in_blocks():
    """A study makes its points block by block: those of sgt_pupil_points, in their order."""
    lens = sagitta.Lens.read(TREE / 'examples/lenses/cooke_triplet.yaml')
    for pattern, several in (('fan', (1, 300)), ('grid', (1, 3, 25)), ('hexapolar', (1, 12)), ('random', (1, 400)),
                             ('sobol', (1, 128, 129, 400)), ('cells', (1, 2, 21)), ('cross', (1, 2, 131, 200))):
        for rays in several:
            mine, whole = lens.ends(1, pattern=pattern, rays=rays, seed=5), lens.launch(1, pattern, rays, seed=5)
            for one, other in ((mine.px, whole.px), (mine.py, whole.py), (mine.weight, whole.weight)):
                assert one.tobytes() == other.tobytes(), (pattern, rays)


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


def test_threads():
    lens = sagitta.Lens.read(TREE / 'examples/lenses/double_gauss.yaml')
    for name in analyses():
        given = {} if name == 'field' else {'rays': 8} if name == 'sweep' else {'rays': 20}
        one = getattr(lens, name)(**given).rows
        for threads in (2, 5, 7):
            several = getattr(lens, name)(threads=threads, **given).rows
            for column in one.dtype.names:
                assert several[column].tobytes() == one[column].tobytes(), (name, threads, column)


main(globals())
