#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tables of data/limits.md: where the kernels stand, beside peers and what memory allows (docs/tables.py has the
convention).

    python3 docs/limits_table.py build [--before OLD]      OLD: a build of an earlier version, for the column `before`
    python3 docs/limits_table.py build --threads [N]       what N threads gain; 2, unless it is said

The programs of both builds take turns, ROUNDS times each, and a figure is the median.
"""
import csv
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import tables

ROUNDS = 1
FILES_ROWS = 2_000_000
QUICK = ['--benchmark_repetitions=3', '--benchmark_min_time=0.05']
BATCH = ['--benchmark_filter=^(conic|sphere|plane|asphere)-1e[36]/(batch|copy|copy-by-array|closed-form-arrays|newton-arrays)']
CATALOGUE = ['quadric', 'ellipsoid', 'torus', 'biconic', 'cylinder', 'odd_asphere, to r^8', 'toroidal, to y^8',
             'polynomial_xy, 3 x 3']


def numbers(build):
    """{(program, case, variant): ns}; of the catalogue {('times', surface, ''): ratio} as well."""
    found = {}
    for program, words in (('one_ray', QUICK), ('batch', QUICK + BATCH), ('catalogue', QUICK), ('level_batch', ['--runs', '3'])):
        lines = tables.run(f'{build}/tests/bench/bench_{program}', *words).splitlines()
        for line in lines:
            cells = next(csv.reader([line]))
            if len(cells) >= 4 and cells[2].replace('.', '').replace('e+', '').isdigit():
                found[program, cells[0], cells[1]] = float(cells[2])
        for begin, line in enumerate(lines):
            if line.startswith('type;surface;'):
                for one in csv.DictReader(lines[begin:], delimiter=';'):
                    if one['formula'] != '-':
                        found['times', one['surface'], ''] = float(one['first']) / float(one['formula'])
                    found['catalogue', one['surface'], 'one ray'] = float(one['one-first'])
    return found


def rows():
    """What it is, its figure, the best of its peers, what the peer is, and the goal."""
    for case in ('plane', 'sphere', 'conic'):
        yield (f'{case}, 1e3 rays', ('batch', f'{case}-1e3', 'batch'), [('batch', f'{case}-1e3', 'closed-form-arrays')],
               'closed form by hand, no bound', 3.0)
    for case in ('plane', 'sphere', 'conic'):
        yield (f'{case}, 1e6 rays', ('batch', f'{case}-1e6', 'batch'),
               [('batch', f'{case}-1e6', 'copy'), ('batch', f'{case}-1e6', 'copy-by-array')], 'copy of the bytes', 7.0)
    for size in ('1e3', '1e6'):
        yield (f'asphere, 3 terms, {size} rays', ('batch', f'asphere-{size}', 'batch'),
               [('batch', f'asphere-{size}', 'newton-arrays')], "Newton's by hand, no bound", 6.8)
    for surface in CATALOGUE:
        yield f'{surface}: formulas a ray', ('times', surface, ''), [], 'three evaluations: 3', 9.0
    for case, goal in (('plane', 15), ('conic', 30), ('asphere', 70)):
        yield (f'{case}, one ray', ('one_ray', case, 'sagitta'),
               [('one_ray', case, 'boost-newton_raphson_iterate-31-bits')], "Boost's Newton, 31 bits", goal)
    yield 'Zernike, 16 terms, one ray', ('catalogue', 'zernike, fringe, 16', 'one ray'), [], '-', 500
    for precision in ('20', '500'):
        yield (f'Julia set, N = 7 (goal: a peer {5 if precision == "20" else 7} times as long)', ('level_batch', 'c1-N7', 'batch'),
               [('level_batch', 'c1-N7', f'povray precision={precision}')], f'POV-Ray, precision {precision}', None)


def limits(build, old):
    rounds = {place: [] for place in (old, build) if place}
    for _ in range(ROUNDS):
        for place, made in rounds.items():
            made.append(numbers(place))

    def figure(place, key):
        known = [made[key] for made in rounds.get(place, []) if key in made]
        return statistics.median(known) if known else float('nan')

    body = []
    for name, key, peers, peer, goal in rows():
        now, best = figure(build, key), min((figure(build, one) for one in peers), default=float('nan'))
        body.append([name, tables.short(figure(old, key)), tables.short(now), tables.short(best),
                     tables.short(now / best), peer, tables.short(goal) if goal else '-'])
    return tables.table(['', 'before', 'now', 'peer', 'now over peer', 'the peer', 'goal'], body)


def seconds(*commands):
    """That pass while all of them run beside each other."""
    start = time.monotonic()
    for one in [subprocess.Popen([*map(str, command)], stdout=subprocess.DEVNULL) for command in commands]:
        if one.wait():
            raise SystemExit(f'{one.args} failed')
    return time.monotonic() - start


def files(build, threads):
    """Rays from a file of numbers to a file of answers, in one thread and in several; and copies of those bytes."""
    import numpy
    command = f'{build}/src/tool/sagitta'
    with tempfile.TemporaryDirectory() as folder:
        random = numpy.random.default_rng(1)
        given, made = f'{folder}/rays.npy', f'{folder}/hits.npy'
        rays = numpy.zeros((FILES_ROWS, 6))
        rays[:, :2], rays[:, 2], rays[:, 5] = random.uniform(-2, 2, (FILES_ROWS, 2)), -5, 1
        numpy.save(given, rays)

        def ask(n, out):
            return [command, 'intersect', '--surface', '{type: conic, curvature: 0.1, conic: -0.6}', '--rays', given,
                    '--threads', n, '--format', 'npy', '--output', out]

        one, several = [], []
        seconds(ask(1, made))
        for _ in range(7):
            one.append(seconds(ask(1, made)))
            several.append(seconds(ask(threads, made)))
        size = os.path.getsize(made) >> 20

        def copy(n, to, part):
            for i in range(n):
                pathlib.Path(folder, to.format(i)).unlink(missing_ok=True)
            return seconds(*[['dd', f'if={made}', f'of={folder}/{to.format(i)}', 'bs=1M', 'conv=notrunc', 'status=none',
                              *part(i, size // n)] for i in range(n)])

        own = [[copy(n, 'copy{}', lambda i, each: []) for _ in range(7)] for n in (1, threads)]
        one_file = [[copy(n, 'copy', lambda i, each: [f'skip={i * each}', f'seek={i * each}', f'count={each}'])
                     for _ in range(7)] for n in (1, threads)]
    gain = statistics.median(a / b for a, b in zip(one, several))
    copied = statistics.median(threads * a / b for a, b in zip(*own))
    halves = statistics.median(a / b for a, b in zip(*one_file))
    return [[f'{FILES_ROWS:,} rays of a conic, from file to file', tables.short(1e9 * statistics.median(one) / FILES_ROWS),
             f'{gain:.2f}'],
            [f'`dd` of the answers, {threads} at a time, each to its file',
             tables.short(1e9 * statistics.median(own[0]) / FILES_ROWS), f'{copied:.2f}'],
            [f'`dd` of the answers, {threads} at a time, each its part of one file',
             tables.short(1e9 * statistics.median(one_file[0]) / FILES_ROWS), f'{halves:.2f}']]


def threads(build, count):
    lines = tables.run(f'{build}/tests/bench/bench_threads', count).splitlines()
    body = {}
    for line in csv.DictReader(lines, delimiter=';'):
        body.setdefault(line['row'], {})[line['rays']] = (tables.short(line['ns']), line['gain'])
    parts = [tables.table(['', '1e3 rays: ns', 'gain', '1e6 rays: ns', 'gain'],
                          [[name, *of['1000'], *of.get('1000000', ('-', '-'))] for name, of in body.items()]),
             tables.table(['', 'ns a ray', 'gain'], files(build, int(count)))]
    return '\n\n'.join(parts)


def main(build, *words):
    if words[:1] == ('--threads',):
        tables.write('limits', build, threads(build, (words + ('2',))[1]), 'threads')
        return
    old = words[1] if words[:1] == ('--before',) else None
    tables.write('limits', build, limits(build, old), 'limits')


if __name__ == '__main__':
    main(*sys.argv[1:])
