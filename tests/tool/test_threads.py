#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""--threads: the same bytes for any number of them, on however many rays, good rows or bad.

    python3 test_threads.py SAGITTA [--without-openmp]
"""
import os
import random

from command import *

WITHOUT_OPENMP = '--without-openmp' in sys.argv

LENS = LENSES / 'ftheta.yaml'
SPHERE = '{type: sphere, radius: 3, semi_diameter: 2}'
ASPHERE = '{type: even_asphere, radius: 20, coefficients: [-2e-4, -5e-6, -6e-8]}'
JULIA = '{type: julia, c: [-0.2, 0.8, 0, 0], iterations: 6}'

# Rays go 1024 at a time, few ones 64 for each of several threads, and a thread may be 8 tiles ahead; a file is
# read in pieces of a quarter of a megabyte.  These are less than one of each, at their borders, and more than
# all places of two threads.
FEW, MANY, MANY_THROUGH_LENS = (1, 63, 64, 65, 1023, 1024, 1025), 35001, 17001


def random_rays(count, seed, across=2.5):
    draw = random.Random(seed)
    return [[draw.uniform(-across, across), draw.uniform(-across, across), -5.0,
             draw.uniform(-0.2, 0.2), draw.uniform(-0.2, 0.2), draw.uniform(0.5, 1.5)] for _ in range(count)]


def note(threads):
    """Without OpenMP it says that it works in one thread, and does."""
    told = f'sagitta: --threads {threads}: not used; this command is built without OpenMP and works in one thread\n'
    return told.encode() if WITHOUT_OPENMP and threads > 1 else b''


def same(*arguments, threads=(1, 2, 3, 7), exit=None, **how):
    """What it prints, and that it prints the same for every number of threads and for none given."""
    first = run(*arguments, exit=exit, binary=True, **how)
    for n in threads:
        done = run(*arguments, '--threads', n, exit=first.returncode, binary=True, **how)
        assert (done.stdout, done.stderr) == (first.stdout, note(n) + first.stderr), (arguments, n, done.stderr)
    return first


def test_few_rays():
    for count in FEW:
        text = rays(*random_rays(count, count))
        for form in ('csv', 'json', 'text'):
            same('intersect', '--surface', SPHERE, '--rays', '-', '--format', form, threads=(1, 2), stdin=text)
            same('trace', LENS, '--rays', '-', '--format', form, threads=(1, 2), stdin=text)


def test_many_rays():
    """The bytes are those of the numbers of threads, and the rows those of each ray asked for among fewer."""
    for command, surface, count in (('intersect', ('--surface', SPHERE), MANY), ('trace', (LENS,), MANY_THROUGH_LENS)):
        several = random_rays(count, 1)
        path = written(rays(*several), 'rays.csv')
        done = {form: same(command, *surface, '--rays', path, '--format', form, threads=(1, 2, 7)).stdout
                for form in ('csv', 'json', 'text')}
        if command == 'trace':
            equal(done['text'].count(b'\n\n'), count + 1, 'empty lines: between two rays, behind the last, and behind the legend')
        table = list(csv.DictReader(io.StringIO(done['csv'].decode())))
        draw, start = random.Random(2), 0
        while start < count:
            end = min(count, start + draw.choice((1, 100, 3000)))
            part = rows(command, *surface, '--rays', '-', exit=None, stdin=rays(*several[start:end]))
            whole = [dict(row, ray=str(int(row['ray']) - start)) for row in table if start <= int(row['ray']) < end]
            equal(part, whole, (command, start, end))
            start = end + draw.randint(0, 9000)


def test_all_roots():
    """Rows of a ray, and gaps between rays, at the borders of tiles."""
    for surface, count in ((SPHERE, 1500), (JULIA, 300)):
        for form in ('csv', 'json', 'text'):
            done = same('intersect', '--surface', surface, '--all', '--rays', '-', '--format', form, stdin=rays(*random_rays(count, 3)))
        equal(done.stdout.count(b'\n\n'), count + 1, 'empty lines: between two rays, behind the last, and behind the legend')


def test_grids():
    for lens in ('ftheta', 'cassegrain', 'aspheric_singlet'):
        for more in ((), ('--frame', 'global'), ('--hex', '--format', 'csv')):
            same('trace', LENSES / f'{lens}.yaml', '--grid', 21, *more)


def test_undecided():
    """The status at the end counts what all threads saw."""
    text = rays(*random_rays(MANY, 4, across=6))
    done = same('intersect', '--surface', ASPHERE, '--rays', '-', '--max-evals', '1', stdin=text, exit=UNDECIDED)
    assert b'exhausted' in done.stdout
    last = rays(*[[0, 0, -5, 0, 0, 1]] * 2000, (0, 9, -5, 0, 0.1, 1))
    same('intersect', '--surface', ASPHERE, '--rays', '-', '--max-evals', '1', stdin=last, exit=UNDECIDED)


def test_forms_of_numbers():
    """A line of plain numbers is read where it stands, any other is split: the same rays, however it is written."""
    draw = random.Random(6)
    blanks = ('', ' ', '\t', '  ')

    def written_as(x):
        return draw.choice((repr(x), f'{x:.17g}', f'{x:.25f}', f'{x:+.16e}', f'{x:.20E}', x.hex(), f'"{x!r}"',
                            f'0000{abs(x)!r}' if x >= 0 else f'-00{abs(x)!r}'))
    several = [[float(f'{x:.9f}') for x in ray] for ray in random_rays(4000, 6)]
    plain = run('intersect', '--surface', SPHERE, '--rays', '-', '--format', 'csv', stdin=rays(*several)).stdout
    lines = [','.join(draw.choice(blanks) + written_as(x) + draw.choice(blanks) for x in ray) for ray in several]
    text = 'ox,oy,oz,dx,dy,dz\n' + ''.join(line + draw.choice(('\n', '\r\n', '\n\n')) for line in lines).rstrip()
    for threads in (1, 2):
        equal(run('intersect', '--surface', SPHERE, '--rays', '-', '--format', 'csv', '--threads', threads,
                  stdin=text).stdout, plain)
    for wrong in ('1 2', '1,', '--1', '1e', '1.2.3', '0x', '1_000', '12345678a', '123456789012345678901x', '1;2', '1/2'):
        lines[77] = f'0,0,-5,0,0,{wrong}'
        text = 'ox,oy,oz,dx,dy,dz\n' + '\n'.join(lines)
        done = run('intersect', '--surface', SPHERE, '--rays', '-', stdin=text, exit=BAD_INPUT)
        assert done.stderr.startswith('sagitta: standard input:79: '), (wrong, done.stderr)


def test_first_miss():
    """The miss that is explained is the first of the file, whichever thread finds one first."""
    text = rays(*[[0, 0, -5, 0, 0, 1]] * 3000, *[[0, 5 + i / 1000, -5, 0, 0, 1] for i in range(3000)])
    done = same('intersect', '--surface', SPHERE, '--rays', '-', '--format', 'text', stdin=text)
    assert b'\nRay 3000: ' in done.stdout


def test_bad_rows():
    """Numbers of rows and lines, counted through bad rows, empty lines and pieces of the file."""
    draw = random.Random(5)
    header, lines, wanted, first_bad = 'id,ox,oy,oz,dx,dy,dz', [], [], None
    number = bad = 0
    while number < 12000:
        if draw.random() < 0.05:
            lines.append(draw.choice(('', '  ', '\t\r')))
            continue
        row = [f'ray {number}', *map(repr, random_rays(1, number)[0])]
        if draw.random() < 0.02 and number > 9000:
            bad += 1
            first_bad = first_bad or len(lines) + 2
            row = draw.choice((row[:-1], row + ['1'], row[:3] + ['x'] + row[4:], row[:4] + ['0', '0', '0'],
                               ['"'] + row[1:]))
        else:
            wanted.append((str(number), f'ray {number}'))
        lines.append(','.join(row))
        number += 1
    text = '\r\n'.join([header, *lines])
    shown = ('intersect', '--surface', '{type: plane}', '--format', 'csv')
    for source in ('-', written(text, 'rays.csv')):
        done = same(*shown, '--rays', source, '--skip-bad', stdin=text)
        table = csv.DictReader(io.StringIO(done.stdout.decode()))
        equal([(row['ray'], row['id']) for row in table], wanted)
        assert f'{bad} bad rows skipped, the first in line {first_bad}: '.encode() in done.stderr, done.stderr
        done = same(*shown, '--rays', source, stdin=text, exit=BAD_INPUT)
        assert f':{first_bad}: '.encode() in done.stderr or f'standard input:{first_bad}:'.encode() in done.stderr, done.stderr
        equal(done.stdout, b'')
    every = '\n'.join([header] + ['x,0,0,0,0,0,0'] * 9000)
    equal(same(*shown, '--rays', '-', '--skip-bad', stdin=every).stdout.decode(), INTERSECT + ',id\n')


def test_picture():
    """The rays of a picture are drawn in their order."""
    pictures = []
    for n in (1, 2, 7):
        path = written('').parent / 'lens.svg'
        done = run('trace', LENS, '--grid', 25, '--picture', path, '--threads', n, exit=None)
        pictures.append((done.stdout, path.read_bytes()))
    assert all(p == pictures[0] for p in pictures)


def test_number_of_threads():
    ray = ('intersect', '--surface', '{type: plane}', '--ray', '0 0 -5 0 0 1')
    for wrong in ('0', '-1', 'x', '', '2.5', '1e1', '99999999999999999999', '100000'):
        for command in (ray, ('trace', LENS)):
            done = run(*command, f'--threads={wrong}', exit=USAGE)
            assert '--threads' in done.stderr and f'"{wrong}"' in done.stderr, done.stderr
            equal(done.stdout, '')
    assert '--threads' in run(*ray, '--threads', exit=USAGE).stderr
    assert '--threads' in run('diagnose', LENS, '--threads', '2', exit=USAGE).stderr
    for n in (1, 2, 1024):
        equal(run(*ray, '--threads', n, binary=True).stderr, note(n))
    for command in ('intersect', 'trace'):
        assert '--threads N' in run(command, '--help', 'all').stdout


def test_threads_of_the_environment():
    text, before = rays(*random_rays(3000, 6)), os.environ.get('OMP_NUM_THREADS')
    shown = ('trace', LENS, '--rays', '-', '--format', 'csv')
    wanted = run(*shown, stdin=text, exit=None).stdout
    for n in ('1', '5'):
        os.environ['OMP_NUM_THREADS'] = n
        equal(run(*shown, stdin=text, exit=None).stdout, wanted)
    del os.environ['OMP_NUM_THREADS']
    if before is not None:
        os.environ['OMP_NUM_THREADS'] = before


main(globals())
