#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A long run measured, and longer ones scaled on paper: the tables of data/scale.md (docs/tables.py has the
convention).

    python3 docs/scale_table.py build [--rays 1000000000] [--threads 2] [--scratch FOLDER]

The run is `sagitta spot` of random rays through the Cooke triplet, three fields of so many rays each; before it
stand runs of a tenth, a hundredth ... of them, down to 10^6.  Of 10^9 rays it takes some 10 minutes of two cores.

ON PAPER.  With N rays, P cores, S shares in all, k of them for each core, and what was measured here (SCALED):

    compute       N c / P           c: processor time a ray, of one thread
    start-up      k s + S j         s: a command that has nothing to do; j: a part that is joined
    slowest       N c / P w         w: how much longer the slowest of as many shares as cores took than their mean;
                                    by k shares a core, taken as they become free, w / k
    disk          N b / D           b: bytes a ray that are written and read; D: bytes a second of the folder that
    network       N b / E           all share, E: of its network; both are assumed (ASSUMED)
    join          N r               r: what join takes for a ray, in one thread

Sums have no b and r but those of a part.  Files are the last points of all rays, as `sagitta trace --last` has them.
"""
import argparse
import csv
import io
import math
import os
import pathlib
import re
import statistics
import subprocess
import tempfile
import time

import tables

LENS = tables.DOCS.parent / 'examples' / 'lenses' / 'cooke_triplet.yaml'
GRID = 400
PATTERNS = [('--grid', GRID), ('--cells', GRID), ('--hexapolar', GRID // 2), ('--sobol', 125_000), ('--sobol', 8_000_000)]
FEW = 200_000     # rays of what is measured in one thread
SHARES = 16       # of the run whose shares are timed
ASSUMED = {'disk': 1e9, 'network': 1.25e9}  # bytes a second: a shared folder; 10 Gbit a second
CASES = [(1e9, 2), (1e9, 100), (1e12, 100), (1e12, 1000)]  # rays, cores
A_CORE = 10       # shares


def timed(*command, watch=False):
    """Seconds, seconds of processor, what was printed, and, to be watched, the most memory in MB: as the system has it
    while the command runs, to 20 ms.  (What wait4 tells of it is at least what this program had.)"""
    most = 0
    with tempfile.TemporaryFile('w+') as out:
        begin = time.perf_counter()
        child = subprocess.Popen(list(map(str, command)), stdout=out)
        while True:
            done, status, usage = os.wait4(child.pid, os.WNOHANG if watch else 0)
            if done:
                break
            found = re.search(r'VmHWM:\s*(\d+)', pathlib.Path(f'/proc/{child.pid}/status').read_text())
            most = max(most, int(found[1]) if found else 0)
            time.sleep(0.02)
        child.returncode = os.waitstatus_to_exitcode(status)
        assert child.returncode == 0, command
        took = time.perf_counter() - begin
        out.seek(0)
        return took, usage.ru_utime + usage.ru_stime, out.read(), most / 1000


def spots(text):
    """The rows of all wavelengths together."""
    return [row for row in csv.DictReader(io.StringIO(text)) if row['wavelength'] == 'all']


def chance(sagitta, fields):
    """The standard deviation of each rms, times the root of the number of rays, by the fourth moments of some.  The
    distances are from where `spot` has them."""
    ends = csv.DictReader(io.StringIO(timed(sagitta, 'ends', LENS, '--random', FEW, '--seed', 2, '--format', 'csv',
                                            '--columns', 'field,x,y')[2]))
    squares = {row['field']: [] for row in fields}
    about = {row['field']: (float(row['x']), float(row['y'])) for row in fields}
    for end in ends:
        x, y = about[end['field']]
        squares[end['field']].append((float(end['x']) - x) ** 2 + (float(end['y']) - y) ** 2)
    return [statistics.stdev(s) / (2 * math.sqrt(statistics.fmean(s))) for s in squares.values()]


def small(x, digits=2):
    """Two digits, as 1.2e-7."""
    return tables.short(f'{float(x):.{digits - 1}e}')


def certain(row):
    """The rms in its certain digits."""
    return f"{float(row['rms']):#.{int(row['digits'])}g}"


def long_run(sagitta, asked):
    """The table of times, that of the rms, and that of other patterns."""
    common = ('spot', LENS, '--seed', 1, '--format', 'csv', '--threads', asked.threads)
    other = {pattern: spots(timed(sagitta, 'spot', LENS, '--format', 'csv', '--threads', asked.threads, *pattern)[2])
             for pattern in PATTERNS}
    grid = other[PATTERNS[0]]
    wide, rows, rms = chance(sagitta, grid), [], []
    powers = [10 ** k for k in range(6, 16) if 10 ** k < asked.rays]
    for rays in [*powers, asked.rays]:
        took, processor, text, memory = timed(sagitta, *common, '--random', rays, watch=True)
        found = spots(text)
        rows.append([f'{rays:,}', f'{took:.1f}', f'{processor:.1f}', f'{1e9 * processor / rays / len(found):.0f}',
                     f'{memory:.0f}'])
        for row, of_grid, w in zip(found, grid, wide):
            off = float(row['rms']) - float(of_grid['rms'])
            rms.append([row['field'], f'{rays:,}', certain(row), row['digits'], small(w / math.sqrt(rays)), small(off)])
    rms.sort(key=lambda row: (row[0], int(row[1].replace(',', ''))))
    return [tables.table(['rays of each field', 'seconds', 'of processor', 'ns a ray', 'most memory, MB'], rows),
            tables.table(['field', 'random rays', 'rms, mm', 'certain digits', 'by chance', 'less that of the grid'], rms),
            tables.table(['pattern', 'rays', *(f"rms of field {row['field']}, mm" for row in grid)],
                         [[f'`{name} {n}`', f"{int(found[0]['rays']):,}", *map(certain, found)]
                          for (name, n), found in other.items()])]


def measured(sagitta, folder):
    """What the scaling needs, in seconds and bytes: by name the number and what it is."""
    one = lambda *command: timed(sagitta, *command, '--threads', 1)  # noqa: E731
    spot = ('spot', LENS, '--fields', 2)
    start = statistics.median(timed(sagitta, *spot, '--random', 1)[0] for _ in range(21))
    parts, shares = [folder / f'{k}.part' for k in range(1, SHARES + 1)], []
    for k, part in enumerate(parts, 1):
        shares.append(one(*spot, '--random', 10 * FEW * SHARES // 4, '--shard', f'{k}/{SHARES}', '--output', part)[1])
    few, many = (statistics.median(one(*spot, '--random', n)[1] for _ in range(5)) for n in (FEW, 10 * FEW))
    every = statistics.median(timed(sagitta, 'join', *parts)[0] for _ in range(5))
    alone = folder / 'alone.part'
    one(*spot, '--random', FEW, '--shard', '1/1', '--output', alone)
    single = statistics.median(timed(sagitta, 'join', alone)[0] for _ in range(5))
    rays, whole, npy = folder / 'rays.part', folder / 'whole.npy', folder / 'joined.npy'
    trace = ('trace', LENS, '--field', 14, '--random', 2 * FEW, '--last', '--format', 'npy')
    traced = one(*trace, '--output', whole)[1]
    one(*trace, '--shard', '1/1', '--output', rays)
    joined = one('join', rays, '--output', npy)[1]
    assert npy.read_bytes() == whole.read_bytes()
    return {
        'c': ((many - few) / 9 / FEW, 'ns', 1e9, '`spot --random`: processor time a ray, one thread'),
        's': (start, 'ms', 1e3, 'start-up: `spot --random 1`'),
        'j': (max(every - single, 0) / (SHARES - 1), 'ms', 1e3, '`join`: each part of a spot more'),
        'part': (parts[1].stat().st_size, 'KB', 1e-3, 'a part of a spot, of one field and wavelength'),
        'w': (max(shares) / statistics.fmean(shares) - 1, '%', 100, f'the slowest of {SHARES} shares above their mean'),
        'f': (traced / 2 / FEW, 'ns', 1e9, '`trace --last` as .npy: processor time a ray, one thread'),
        'p': (rays.stat().st_size / 2 / FEW, 'bytes', 1, 'its part, a ray'),
        'n': (whole.stat().st_size / 2 / FEW, 'bytes', 1, 'the .npy, a ray'),
        'r': (joined / 2 / FEW, 'ns', 1e9, '`join` of these parts to .npy: processor time a ray'),
    }


def said(seconds):
    for unit, size in (('days', 86400), ('h', 3600), ('min', 60)):
        if seconds >= 2 * size:
            return f'{seconds / size:.3g} {unit}'
    return f'{seconds:.2g} s' if seconds < 100 else f'{seconds:.0f} s'


def said_bytes(size):
    for unit, one in (('TB', 1e12), ('GB', 1e9), ('MB', 1e6)):
        if size >= one:
            return f'{size / one:.3g} {unit}'
    return f'{size / 1e3:.3g} KB'


def on_paper(of):
    """A row for each case, by sums and by files; SCALED is in the head."""
    at, rows = {name: value for name, (value, *_) in of.items()}, []
    for rays, cores in CASES:
        for what in ('sums', 'files'):
            sums, shares = what == 'sums', A_CORE * cores
            compute = rays * (at['c'] if sums else at['f']) / cores
            start = A_CORE * at['s'] + shares * at['j']
            size = shares * at['part'] if sums else rays * (2 * at['p'] + at['n'])  # written, read, and written
            join = 0 if sums else rays * at['r']
            disk, network = size / ASSUMED['disk'], size / ASSUMED['network']
            slowest = compute * at['w'] / A_CORE
            # (Disk and network carry the same bytes at the same time: the slower of them counts.)
            total = compute + start + slowest + max(disk, network) + join
            rows.append([f'10^{round(math.log10(rays))}', f'{cores:,}', what, said(compute), said(start), said(slowest),
                         said_bytes(size), said(disk), said(network), said(join) if join else '-', said(total)])
    return tables.table(['rays', 'cores', 'by', 'compute', 'start-up', 'slowest', 'bytes', 'disk', 'network', 'join',
                         'in all'], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('build', type=pathlib.Path)
    parser.add_argument('--rays', type=int, default=1_000_000_000)
    parser.add_argument('--threads', type=int, default=2)
    parser.add_argument('--scratch', help='where parts and arrays are written (100 MB)')
    asked = parser.parse_args()
    sagitta = asked.build / 'src/tool/sagitta'
    with tempfile.TemporaryDirectory(dir=asked.scratch) as folder:
        of = measured(sagitta, pathlib.Path(folder))
    terms = tables.table(['', 'what'], [[f'{value * times:.3g} {unit}', what] for value, unit, times, what in of.values()])
    paper = on_paper(of)
    times, rms, others = long_run(sagitta, asked)
    tables.write('scale', asked.build, '\n\n'.join([
        '### A long run', times, '### Its rms', rms, '### By other patterns', others, '### The terms', terms, '### On paper', paper]))


main()
