#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What rays cost that come from files and go to files, a ray; and the memory of one ray through many surfaces.

    python3 tests/bench/files.py build [--rays N] [--runs N] [--before SAGITTA] [--instructions]

A million rays meet a conic, or go through the Cooke triplet, in one thread and in two.  The time is all of the
command's, with its start; medians of several runs, and of user and system time, too, as other programs may be
running.  Files are in the folder for temporary files: TMPDIR=/dev/shm keeps them in memory.  The column
`to reach` has what is aimed at, and before it what was measured before rays went by column (ns a ray, one core of a
Zen 4).  --before: another build of the command, run in turn with this one.  --instructions: counted by callgrind,
in one thread, for a machine that is not idle.
"""
import argparse
import os
import pathlib
import random
import shutil
import statistics
import struct
import subprocess
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
TRIPLET = HERE.parent.parent / 'examples' / 'lenses' / 'cooke_triplet.yaml'
CONIC = '{type: conic, radius: 20, conic: -0.5}'
SURFACES = 100000


def make_rays(folder, count):
    draw = random.Random(1)
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({count}, 6), }}".encode()
    header += b' ' * (117 - len(header)) + b'\n'
    with open(folder / 'rays.npy', 'wb') as array, open(folder / 'rays.csv', 'w') as text:
        array.write(b'\x93NUMPY\x01\x00' + struct.pack('<H', len(header)) + header)
        text.write('ox,oy,oz,dx,dy,dz\n')
        for _ in range(count):
            ray = (draw.uniform(-3, 3), draw.uniform(-3, 3), -5.0, draw.gauss(0, .1), draw.gauss(0, .1), 1.0)
            array.write(struct.pack('<6d', *ray))
            text.write(','.join(map(repr, ray)) + '\n')


def make_lens(folder):
    with open(folder / 'long.yaml', 'w') as text:
        text.write('pupil: {semi_diameter: 1}\nsurfaces:\n')
        for i in range(SURFACES):
            text.write(f'  - {{type: plane, thickness: 0.001, index: {2 - i % 2}}}\n')


def timed(folder, command, into=None):
    """Seconds on the clock, of the processor, and the most memory in MiB."""
    for old in (folder / 'o.npy', folder / 'o.csv'):
        old.unlink(missing_ok=True)
    begin = time.perf_counter()
    source = subprocess.Popen(['cat', into], stdout=subprocess.PIPE) if into else None
    child = subprocess.Popen(command, stdin=source.stdout if source else None, stdout=subprocess.DEVNULL)
    if source:
        source.stdout.close()
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    seconds = time.perf_counter() - begin
    assert child.returncode == 0 and (not source or source.wait() == 0), command
    return seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def instructions(folder, command, into=None):
    """The millions that callgrind counts."""
    counted = folder / 'callgrind.out'
    with open(into or os.devnull, 'rb') as source:
        subprocess.run(['valgrind', '--tool=callgrind', f'--callgrind-out-file={counted}', *command], check=True,
                       stdin=source, capture_output=True)
    lines = counted.read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith(('summary:', 'totals:')))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('build', type=pathlib.Path)
    parser.add_argument('--rays', type=int, default=1000000)
    parser.add_argument('--runs', type=int, default=7)
    parser.add_argument('--before', type=pathlib.Path)
    parser.add_argument('--instructions', action='store_true')
    asked = parser.parse_args()
    builds = {'': asked.build / 'src/tool/sagitta'}
    if asked.before:
        builds['before: '] = asked.before
    folder = pathlib.Path(tempfile.mkdtemp())
    try:
        make_rays(folder, asked.rays), make_lens(folder)
        meet, npy = ['intersect', '--surface', CONIC, '--rays'], ['--format', 'npy', '-o', folder / 'o.npy']
        csv, through = ['--format', 'csv', '-o', folder / 'o.csv'], ['trace', TRIPLET, '--field', '0', '--random']
        works = [('`intersect`, npy to npy', '140 to 180: 40', [*meet, folder / 'rays.npy', *npy], None),
                 ('csv to npy', '', [*meet, folder / 'rays.csv', *npy], None),
                 ('a pipe of csv to npy', '', [*meet, '-', *npy], folder / 'rays.csv'),
                 ('npy to csv', '', [*meet, folder / 'rays.npy', *csv], None),
                 ('npy to a pipe of csv', '', [*meet, folder / 'rays.npy', '--format', 'csv'], None),
                 ('`trace --random --last`, to npy', '290: 100', [*through, str(asked.rays), '--last', *npy], None)]
        count = ' instructions |' if asked.instructions else ''
        print(f'| ns a ray | to reach | one thread | of the processor | two threads | of the processor |{count}')
        print('|---|---|---|---|---|---|' + ('---|' if count else ''))
        for name, limit, words, into in works:
            found = {(which, n): [] for which in builds for n in (1, 2)}
            for _ in range(asked.runs):
                for which, n in found:
                    command = [builds[which], *words, '--threads', str(n)]
                    found[which, n].append(timed(folder, list(map(str, command)), into)[:2])
            for which, sagitta in builds.items():
                cells = [f'{statistics.median(t[k] for t in found[which, n]) / asked.rays * 1e9:.0f}'
                         for n in (1, 2) for k in (0, 1)]
                if asked.instructions:
                    command = list(map(str, [sagitta, *words, '--threads', '1']))
                    cells.append(f'{instructions(folder, command, into) / asked.rays:.0f}')
                print(f'| {which}{name} | {limit} | ' + ' | '.join(cells) + ' |')
        print(f'\n| MiB, a chief ray through {SURFACES} surfaces | to reach | most memory |\n|---|---|---|')
        for name, words in (('`trace --chief --last`', ['--last', *csv]), ('`trace --chief`, a row for each', csv),
                            ('the same as text', ['-o', folder / 'o.csv'])):
            for which, sagitta in builds.items():
                command = list(map(str, [sagitta, 'trace', folder / 'long.yaml', '--chief', *words]))
                print(f'| {which}{name} | 884: 100 | {timed(folder, command)[2]:.0f} |')
    finally:
        shutil.rmtree(folder)


if __name__ == '__main__':
    main()
