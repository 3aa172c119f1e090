#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""--watch FILE of trace and intersect: the evaluations of the rays that were lost.

    python3 test_watch.py SAGITTA
"""
import csv
import math
import random

from command import *

SEED = int(os.environ.get('SAGITTA_TEST_SEED', 20261123))
print(f'       seed {SEED}')

LENS = LENSES / 'aspheric_singlet.yaml'
JULIA = '{type: julia, c: [-0.2, 0.8, 0, 0], iterations: 8}'


def watched(*arguments, **how):
    """What the command printed, and the rows of the watch."""
    path = pathlib.Path(tempfile.mkdtemp(dir=folder.name)) / 'watch.csv'
    done = run(*arguments, '--watch', path, **how)
    return done, list(csv.DictReader(io.StringIO(path.read_text()))), path.read_bytes()


def table(done):
    return list(csv.DictReader(io.StringIO(done.stdout)))


def random_rays(count, across=12, slope=0.25):
    draw = random.Random(SEED)
    return rays(*[(draw.uniform(-across, across), draw.uniform(-across, across), -5,
                   draw.gauss(0, slope), draw.gauss(0, slope), 1) for _ in range(count)])


def test_columns():
    equal(watched('trace', LENS)[2].decode(), DIAGNOSE.replace('hi,f_lo', 'hi,wavelength,f_lo') + '\n')  # no ray is lost
    equal(watched('intersect', '--surface', '{type: sphere, radius: 1}', '--ray', '0 0 -5 0 0 1')[2].decode(), DIAGNOSE + '\n')


def test_lost_rays_and_no_others():
    """A ray has as many rows at each element as the trace tells evaluations, in the order of the rays."""
    text = random_rays(3000)
    for more in (('--max-evals', 4), ('--proof', 'first'), ('--max-evals', 1, '--pick', 'first')):
        done, seen, _ = watched('trace', LENS, '--rays', '-', *more, '--format', 'csv', stdin=text, exit=None)
        assert run('trace', LENS, '--rays', '-', *more, '--format', 'csv', stdin=text, exit=None).stdout == done.stdout
        every = table(done)
        lost = {row['ray'] for row in every if row['fate'] == 'lost'}
        wanted = [(row['ray'], row['element'], str(i + 1)) for row in every if row['ray'] in lost for i in range(int(row['evals']))]
        equal([(row['ray'], row['element'], row['eval']) for row in seen], wanted, more)
        assert more[0] == '--proof' or len(lost) > 10, (more, len(lost))


def test_rows_are_those_of_diagnose():
    done, seen, _ = watched('trace', LENS, '--field', 15, '--grid', 9, '--max-evals', 2, '--format', 'csv', exit=UNDECIDED)
    for ray in sorted({row['ray'] for row in seen}, key=int)[:12]:
        alone = rows('diagnose', LENS, '--field', 15, '--grid', 9, '--max-evals', 2, '--ray', ray, exit=UNDECIDED)
        own = [{name: row[name] for name in DIAGNOSE.split(',')} for row in seen if row['ray'] == ray]
        equal(own, alone, ray)


def test_f_and_slope():
    """F = z - s at the t of each row, behind a plane that does not bend the ray; s as the lens file has it."""
    c, a = 1 / 20, (0, 3e-4, 0, 1e-6)  # of r, r^2, r^3, r^4
    lens = written('surfaces:\n  - {type: plane, thickness: 5}\n'
                   f'  - {{type: odd_asphere, radius: 20, coefficients: {list(a)}, index: 1.5}}\n')
    draw = random.Random(SEED)
    launched = [(draw.uniform(-8, 8), draw.uniform(-8, 8), 0, draw.gauss(0, 0.3), draw.gauss(0, 0.3), 1) for _ in range(50)]
    _, seen, _ = watched('trace', lens, '--rays', '-', '--max-evals', 2, stdin=rays(*launched), exit=UNDECIDED)

    def value(ray, t):
        length = math.sqrt(sum(x * x for x in ray[3:]))
        x, y, z = (o + t * d / length for o, d in zip(ray[:3], ray[3:]))
        r = math.hypot(x, y)
        return z - 5 - c * r * r / (1 + math.sqrt(1 - c * c * r * r)) - sum(k * r ** (i + 1) for i, k in enumerate(a))

    compared = 0
    for row in seen:
        if row['element'] == '2' and abs(float(row['t'])) < 20 and row['f'] != 'nan':
            ray, t, h = launched[int(row['ray'])], float(row['t']), 1e-4
            close(row['f'], value(ray, t), 1e-12, row)
            close(row['slope'], (value(ray, t + h) - value(ray, t - h)) / (2 * h), 1e-6, row)
            compared += 1
    assert compared > 50, compared


def test_wavelengths():
    """Rays of each wavelength are counted from 0, so rows say which one they are of."""
    done, seen, _ = watched('trace', LENS, '--field', 15, '--wavelength', 'F,d', '--max-evals', 2, '--format', 'csv', exit=UNDECIDED)
    lost = [(row['ray'], row['wavelength']) for row in table(done) if row['fate'] == 'lost']
    equal(list(dict.fromkeys((row['ray'], row['wavelength']) for row in seen)), lost)
    equal(list(dict.fromkeys(row['wavelength'] for row in seen)), ['0.4861327', '0.5875618'])
    nameless = written('surfaces:\n  - {type: odd_asphere, radius: 20, coefficients: [0, 1e-4, 0, 1e-5]}\n')
    _, seen, _ = watched('trace', nameless, '--rays', '-', '--max-evals', 1, stdin=rays((0, 3, -1, 0, 0.1, 1)), exit=UNDECIDED)
    equal({row['wavelength'] for row in seen}, {''})


def test_intersect():
    """Rows are counted by the table; with --all those of a ray with an undecided stretch are there."""
    text = random_rays(400, across=1.5, slope=0.1)
    for more in ((), ('--proof', 'first')):
        done, seen, _ = watched('intersect', '--surface', JULIA, '--rays', '-', '--max-evals', 12, *more, '--format', 'csv',
                                stdin=text, exit=UNDECIDED)
        spent = {row['ray']: int(row['evals']) for row in table(done) if row['status'] not in ('hit', 'graze', 'miss')}
        assert len(spent) > 20 and max(spent.values()) >= 12, spent
        equal([(row['ray'], row['eval']) for row in seen], [(ray, str(i + 1)) for ray, n in spent.items() for i in range(n)])
        equal({row['element'] for row in seen}, {'1'})
        ray = next(iter(spent))
        line = ' '.join(text.splitlines()[int(ray) + 1].split(','))
        alone = rows('diagnose', '--surface', JULIA, '--ray', line, '--max-evals', 12, *more, exit=UNDECIDED)
        equal([row['t'] for row in seen if row['ray'] == ray], [row['t'] for row in alone])
    done, seen, _ = watched('intersect', '--surface', JULIA, '--rays', '-', '--max-evals', 26, '--all', '--format', 'csv',
                            stdin=text, exit=UNDECIDED)
    undecided = {row['ray'] for row in table(done) if row['status'] not in ('hit', 'graze', 'miss')}
    equal({row['ray'] for row in seen}, undecided)
    # all that its entries took is there, and so the search behind the first root
    spent = {ray: sum(int(row['evals']) for row in table(done) if row['ray'] == ray) for ray in undecided}
    assert sum(row['root'] != '0' for row in table(done) if row['ray'] in undecided) > 5
    equal({ray: sum(row['ray'] == ray for row in seen) for ray in undecided}, spent)


def test_threads():
    """The same bytes, in the table and in the watch, for any number of threads."""
    for command in (('trace', LENS, '--max-evals', 4), ('intersect', '--surface', JULIA, '--max-evals', 6)):
        text = random_rays(9001, across=12 if command[0] == 'trace' else 1.5)
        one = watched(*command, '--rays', '-', '--threads', 1, '--format', 'csv', stdin=text, exit=UNDECIDED)
        assert len(one[1]) > 1000, len(one[1])
        for threads in (2, 7):
            more = watched(*command, '--rays', '-', '--threads', threads, '--format', 'csv', stdin=text, exit=UNDECIDED)
            assert (more[0].stdout, more[2]) == (one[0].stdout, one[2]), (command, threads)


def test_hexadecimal():
    one = ('trace', LENS, '--field', 15, '--max-evals', 2)
    _, plain, _ = watched(*one, exit=UNDECIDED)
    _, hexadecimal, _ = watched(*one, '--hex', exit=UNDECIDED)
    assert hexadecimal[0]['t'].startswith('0x1.'), hexadecimal[0]
    for row, other in zip(plain, hexadecimal, strict=True):
        for name in ('t', 'f', 'lo', 'wavelength'):
            equal(float(row[name]), float.fromhex(other[name]))


def test_errors():
    path = pathlib.Path(folder.name) / 'same'
    done = run('trace', LENS, '--watch', path, '--output', path, exit=USAGE)
    assert f'--output {path}: would be written over the file of --watch' in done.stderr, done.stderr
    done = run('trace', LENS, '--watch', LENS, exit=USAGE)
    assert f'--watch {LENS}: would be written over' in done.stderr, done.stderr
    nowhere = pathlib.Path(folder.name) / 'none' / 'watch.csv'
    for one in (('trace', LENS), ('intersect', '--surface', JULIA, '--ray', '0 0 -5 0 0 1')):
        done = run(*one, '--watch', nowhere, exit=BAD_INPUT)
        assert f'--watch {nowhere}: No such file' in done.stderr, done.stderr
    if os.path.exists('/dev/full'):
        done = run('trace', LENS, '--max-evals', 1, '--watch', '/dev/full', exit=BAD_INPUT)
        assert '--watch /dev/full: could not be written' in done.stderr, done.stderr


def test_one_ray_at_one_element():
    """Of a ray that is not lost, too: its rows are those of diagnose, with and without --watch-element, in threads."""
    lens = LENSES / 'ftheta.yaml'
    for threads in (1, 2):
        _, seen, _ = watched('trace', lens, '--field', 20, '--fan', 9, '--watch-ray', 7, '--threads', threads)
        alone = rows('diagnose', lens, '--field', 20, '--fan', 9, '--ray', 7)
        equal([{name: row[name] for name in DIAGNOSE.split(',')} for row in seen], alone)
        _, some, _ = watched('trace', lens, '--field', 20, '--fan', 9, '--watch-ray', 7, '--watch-element', 3, '--threads', threads)
        equal(some, [row for row in seen if row['element'] == '3'])
        assert some, seen
    text = random_rays(100)
    for more in ((), ('--all',)):
        asked = ('intersect', '--surface', '{type: sphere, radius: 20}', '--rays', '-', *more)
        met = next(row['ray'] for row in csv.DictReader(run(*asked, '--format', 'csv', stdin=text).stdout.splitlines())
                   if row['status'] == 'hit' and int(row['ray']) > 20)  # what misses may need no evaluation
        _, seen, _ = watched(*asked, '--watch-ray', met, stdin=text)
        equal({row['ray'] for row in seen}, {met})
    # of the lost rays, at one element
    asked = ('trace', LENS, '--rays', '-', '--max-evals', 1)
    _, seen, _ = watched(*asked, stdin=text, exit=UNDECIDED)
    _, some, _ = watched(*asked, '--watch-element', 1, stdin=text, exit=UNDECIDED)
    equal(some, [row for row in seen if row['element'] == '1'])
    _, one, _ = watched(*asked, '--watch-ray', 50, stdin=text, exit=UNDECIDED)  # among others that are lost
    equal(one, [row for row in seen if row['ray'] == '50'])
    assert one and len({row['ray'] for row in seen}) > 1
    run('trace', LENS, '--watch-ray', 1, exit=USAGE)
    run('trace', LENS, '--watch', pathlib.Path(folder.name) / 'w.csv', '--watch-element', 99, exit=USAGE)
    run('intersect', '--surface', JULIA, '--ray', '0 0 -3 0 0 1', '--watch', pathlib.Path(folder.name) / 'w.csv', '--watch-ray', 'x', exit=USAGE)


main(globals())
