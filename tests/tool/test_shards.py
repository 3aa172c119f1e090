#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""--shard and join: the bytes of one run, for any number of shards, threads and formats; parts that are not whole.

    python3 test_shards.py SAGITTA [--without-cairo] [--without-openmp]
"""
import os
import random
import resource
import shutil
import signal
import struct
import time

from command import *

SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'))
DRAW = random.Random(SEED)
CAIRO = '--without-cairo' not in sys.argv
THREADS = ('1',) if '--without-openmp' in sys.argv else ('1', '2')
TRIPLET, GAUSS = LENSES / 'cooke_triplet.yaml', LENSES / 'double_gauss.yaml'
SPHERE = '{type: sphere, radius: 3, semi_diameter: 2}'
JULIA = '{type: julia, c: [-0.2, 0.8, 0, 0], iterations: 6}'
print(f'seed {SEED}')


def place(*names):
    """A folder of its own; paths in it."""
    path = pathlib.Path(tempfile.mkdtemp(dir=folder.name))
    return [path / name for name in names] if names else path


def shards(count, *arguments, **how):
    """The parts of all shards."""
    parts = place(*(f'{k + 1}.part' for k in range(count)))
    for k, part in enumerate(parts):
        done = run(*arguments, '--shard', f'{k + 1}/{count}', '--output', part, '--threads', DRAW.choice(THREADS),
                   **how)
        equal(done.stdout, '', 'a shard prints')
    assert sorted(os.listdir(parts[0].parent)) == sorted(p.name for p in parts), os.listdir(parts[0].parent)
    return parts


def joined(parts, *more, exit=None):
    parts = DRAW.sample(parts, len(parts))
    return run('join', *parts, *more, '--threads', DRAW.choice(THREADS), exit=exit, binary=True)


def same(count, *arguments):
    """One run, and shards joined in some order, print the same, say the same, and end alike."""
    whole = run(*arguments, exit=None, binary=True)
    done = joined(shards(count, *arguments), exit=whole.returncode)
    equal((done.stdout, done.stderr), (whole.stdout, whole.stderr), (count, arguments))


def test_analyses():
    """Lost and clipped rays, several fields and wavelengths, proofs, sums by a tree and by blocks."""
    asked = [('spot', GAUSS, '--hexapolar', 9, '--wavelength', 'all'),
             ('spot', GAUSS, '--reference', 'centroid', '--cells', 30, '--proof', 'first'),
             ('fan', GAUSS), ('opd', TRIPLET), ('opd', TRIPLET, '--summary', '--sobol', 700),
             ('opd', TRIPLET, '--zernike', 11, '--cells', 70), ('opd', TRIPLET, '--zernike', 11),
             ('field', GAUSS, '--steps', 5), ('map', GAUSS, '--random', 500, '--field', 40),
             ('map', GAUSS, '--over', 'field', '--steps', 4),
             ('sweep', GAUSS, '--to', 40, '--steps', 4, '--aim', 'real', '--hexapolar', 3),
             ('sweep', TRIPLET, '--over', 'surfaces[6].thickness', '--from', 42, '--to', 43, '--steps', 2),
             ('energy', TRIPLET), ('illumination', GAUSS), ('ends', GAUSS, '--hexapolar', 4)]
    for i, arguments in enumerate(asked):
        if SCALE < 0.1 and i % 3 != SEED % 3:
            continue
        for count in (1, 3, 7) if SCALE >= 1 else ((1, 3, 7)[i % 3],):
            same(count, *arguments, '--format', ('text', 'csv', 'json')[(i + count) % 3])


def some_rays(count):
    lines = [[DRAW.uniform(-3, 3), DRAW.uniform(-3, 3), -5.0, DRAW.uniform(-.2, .2), DRAW.uniform(-.2, .2), 1.0]
             for _ in range(count)]
    csv = written('id,ox,oy,oz,dx,dy,dz\n' + ''.join(f'r{i},' + ','.join(map(repr, r)) + '\n'
                                                   for i, r in enumerate(lines)), 'rays.csv')
    return csv, written(array(lines), 'rays.npy')


def array(lines):
    """The bytes of an array of N x 6."""
    head = "{'descr': '<f8', 'fortran_order': False, 'shape': (%d, 6), }" % len(lines)
    head += ' ' * (117 - len(head)) + '\n'
    return b'\x93NUMPY\x01\x00' + struct.pack('<H', len(head)) + head.encode() + b''.join(
        struct.pack('<6d', *line) for line in lines)


def test_rays_of_files():
    csv, npy = some_rays(3100)
    asked = [('intersect', '--surface', SPHERE, '--rays', csv),
             ('intersect', '--surface', SPHERE, '--rays', npy, '--all', '--proof', 'first'),
             ('intersect', '--surface', JULIA, '--rays', npy, '--max-evals', 20, '--proof', 'root'),
             ('trace', LENSES / 'ftheta.yaml', '--rays', csv),
             ('trace', LENSES / 'ftheta.yaml', '--rays', npy, '--last', '--proof', 'first')]
    for i, arguments in enumerate(asked):
        if SCALE >= 0.1 or i % 2:
            same((1, 3, 7)[i % 3], *arguments, '--format', ('csv', 'text', 'json')[i % 3])
    same(3, *asked[0], '--format', 'text'), same(3, *asked[4], '--format', 'csv')


def test_only_its_rays():
    """A shard reads only its rows of an array; that there is a bad one among them it says."""
    lines = [[0.1 * (i % 9), 0, -5, 0, 0, 1] for i in range(3000)]
    lines[2900][3] = float('nan')
    npy = written(array(lines), 'rays.npy')
    part, = place('x.part')
    arguments = 'intersect', '--surface', SPHERE, '--rays', npy, '--output', part
    run(*arguments, '--shard', '1/3')
    done = run(*arguments, '--shard', '3/3', exit=BAD_INPUT)
    assert 'row 2900' in done.stderr, done.stderr
    equal(os.listdir(part.parent), ['x.part'], 'of a shard that failed')
    same(3, 'intersect', '--surface', SPHERE, '--rays', npy, '--skip-bad', '--format', 'csv')


def test_rays_that_changed():
    """A number in the middle of an array that is another one when the parts are joined, or the next is made."""
    lines = [[0.1 * (i % 9), 0, -5, 0, 0, 1] for i in range(3000)]
    npy = written(array(lines), 'changing.npy')
    arguments = 'intersect', '--surface', SPHERE, '--rays', npy
    parts = shards(3, *arguments)
    joined(parts)
    lines[1500][1] = 1e-9
    npy.write_bytes(array(lines))
    done = joined(parts, exit=BAD_INPUT)
    assert b'of other rays' in done.stderr, done.stderr
    run(*arguments, '--shard', '2/3', '--output', parts[1])
    done = joined(parts, exit=BAD_INPUT)
    assert b'of other rays' in done.stderr, done.stderr
    count, row = 40000, struct.pack('<6d', 0, 0, -5, 0, 0, 1)  # 2 MB: of more than 1 pieces are compared
    big, part = place('big.npy', 'big.part')
    big.write_bytes(array([]).replace(b'(0, 6), }' + b' ' * 4, b'(%d, 6), }' % count) + row * count)
    arguments = 'intersect', '--surface', SPHERE, '--rays', big, '--shard', '1/40', '--output', part, '--resume'
    run(*arguments)
    with open(big, 'r+b') as f:
        for k in range(2000, 39000, 80):
            f.seek(128 + 48 * k), f.write(struct.pack('<d', 0.25))
    done = run(*arguments, exit=BAD_INPUT)
    assert 'of other rays' in done.stderr, done.stderr


def test_trace():
    same(3, 'trace', GAUSS, '--hexapolar', 9, '--wavelength', 'all', '--format', 'text')
    same(7, 'trace', GAUSS, '--grid', 30, '--aim', 'real', '--wavelength', 'all', '--last', '--format', 'csv')
    same(2, 'trace', GAUSS, '--random', 60, '--aim', 'real', '--field', 40, '--last', '--format', 'json')


def test_arrays():
    arguments = 'trace', GAUSS, '--hexapolar', 9, '--format', 'npy'
    one, other = place('one.npy', 'other.npy')
    run(*arguments, '--output', one)
    joined(shards(3, *arguments), '--output', other)
    equal(other.read_bytes(), one.read_bytes(), 'npy')


def test_pictures():
    if not CAIRO:
        return
    for arguments in (('spot', GAUSS, '--hexapolar', 6), ('spot', GAUSS, '--hexapolar', 82, '--fields', 1),
                      ('trace', GAUSS, '--fan', 5), ('fan', TRIPLET)):
        picture, = place('picture.svg')
        run(*arguments, '--picture', picture)
        once = picture.read_bytes()
        picture.unlink()
        parts = shards(3, *arguments, '--picture', picture)
        assert not picture.exists(), 'a shard draws'
        joined(parts)
        equal(picture.read_bytes(), once, arguments)


def refused(words, *arguments, exit=BAD_INPUT):
    done = run(*arguments, exit=exit)
    for word in words:
        assert str(word) in done.stderr, (word, done.stderr)
    equal(done.stdout, '', arguments)


RANDOM = ('spot', GAUSS, '--random')


def test_foreign_parts():
    """A part that is missing, doubled, overlapping or foreign is named."""
    a, b, c = parts = shards(3, *RANDOM, 700)
    refused([a, 'part 3 of 3'], 'join', a, b)
    refused([b, 'both part 2'], 'join', a, b, c, b)
    half = shards(2, *RANDOM, 700)[0]
    refused([half, 'part 1 of 2'], 'join', *parts, half)
    other = shards(3, *RANDOM, 701)[2]
    refused([other, '--random=701'], 'join', a, b, other)
    lens = written(GAUSS.read_text(), 'lens.yaml')
    first, second = shards(2, 'spot', lens, '--random', 500)
    lens.write_text(GAUSS.read_text() + '\n# another one\n')
    run('spot', lens, '--random', 500, '--shard', '2/2', '--output', second)
    refused([second, first, 'another lens'], 'join', first, second)
    run('spot', lens, '--random', 500, '--shard', '1/2', '--output', first)
    lens.write_text(GAUSS.read_text())
    refused([first, 'another lens'], 'join', first, second)
    version = written(a.read_bytes().replace(b'0.3.0\0', b'0.9.0\0'), 'later.part')
    refused([version], 'join', version, b, c)
    refused([GAUSS, 'not a part'], 'join', GAUSS)
    refused(['--shard'], *RANDOM, 9, '--shard', '4/3', '--output', a, exit=USAGE)
    refused(['--output'], *RANDOM, 9, '--shard', '1/3', exit=USAGE)
    link = a.with_suffix('.link')  # as a device would be replaced
    link.symlink_to(a)
    for odd in (link, a.parent):
        refused([odd, 'no plain file'], *RANDOM, 9, '--shard', '1/3', '--output', odd)
    refused(['--shard'], *RANDOM, 9, '--resume', exit=USAGE)


def test_damaged_parts():
    """Cut anywhere, or with another bit: named; --resume makes it anew, and then the join is right."""
    parts = shards(2, *RANDOM, 700)
    whole, bytes_ = run(*RANDOM, 700).stdout, parts[1].read_bytes()
    for _ in range(max(6, int(20 * SCALE))):
        at = DRAW.randrange(len(bytes_))
        damaged = bytes_[:at] if DRAW.random() < 0.5 else \
            bytes_[:at] + bytes([bytes_[at] ^ 1 << DRAW.randrange(8)]) + bytes_[at + 1:]
        parts[1].write_bytes(damaged)
        refused([parts[1]], 'join', *parts)
    again = RANDOM + (700, '--shard', '2/2', '--output', parts[1], '--resume')
    assert 'made anew' in run(*again).stderr
    equal(joined(parts).stdout.decode(), whole)
    assert 'is whole' in run(*again).stderr
    refused([parts[0], 'another run'], *RANDOM, 700, '--shard', '2/2', '--output', parts[0], '--resume')


def test_no_room():
    """A file that may not grow, as a full disk; a folder that is not there: named, and nothing is left."""
    part, = place('x.part')
    arguments = [SAGITTA, *map(str, RANDOM), '700', '--shard', '1/2', '--output']
    done = subprocess.run(arguments + [str(part)], capture_output=True, text=True,
                          preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2048, 2048)))
    equal(done.returncode, BAD_INPUT, done.stderr)
    assert str(part) in done.stderr, done.stderr
    equal(os.listdir(part.parent), [], 'left behind')
    refused(['/no/such/folder/x'], *RANDOM, 700, '--shard', '1/2', '--output', '/no/such/folder/x')
    gone = place()
    rays = '1000000' if SCALE >= 0.1 else '200000'
    running = subprocess.Popen(arguments[:3] + ['--random', rays, '--shard', '1/2', '--threads', '1', '--output',
                                                str(gone / 'x.part')], stderr=subprocess.PIPE, text=True)
    for _ in range(10000):
        if os.listdir(gone):
            break
        time.sleep(0.001)
    shutil.rmtree(gone)
    said = running.communicate()[1]
    equal(running.returncode, BAD_INPUT, said)
    assert str(gone / 'x.part') in said, said


def test_kills():
    """Killed at any time: nothing looks whole, and --resume gives the same bytes."""
    arguments = ('spot', TRIPLET, '--random', 60000 if SCALE >= 0.1 else 20000, '--threads', 1)
    whole = run(*arguments).stdout
    parts = place('1.part', '2.part')
    started = time.monotonic()
    run(*arguments, '--shard', '1/2', '--output', parts[0])
    lasts = time.monotonic() - started
    for kill in range(20 if SCALE >= 1 else 4 if SCALE >= 0.1 else 1):
        for k, part in enumerate(parts):
            part.unlink(missing_ok=True)
            running = subprocess.Popen([SAGITTA, *map(str, arguments), '--shard', f'{k + 1}/2', '--output', str(part)],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(DRAW.uniform(0, lasts))
            running.send_signal(signal.SIGKILL)
            running.wait()
        there = [part for part in parts if part.exists()]
        if len(there) < 2:
            run('join', *(there or parts), exit=BAD_INPUT)
        for k, part in enumerate(parts):
            run(*arguments, '--shard', f'{k + 1}/2', '--output', part, '--resume')
        equal(joined(parts).stdout.decode(), whole, kill)


main(globals())
