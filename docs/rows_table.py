#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What the rows of `sagitta trace` cost: the table of data/rows.md (docs/tables.py has the convention).

    python3 docs/rows_table.py build [--rays N] [--runs N] [--threads N] [--before SAGITTA]

Each kind of output is written in turn, N times, and the table has medians.  Beside them stands the trace alone,
by sgt_trace_batch (tests/bench/bench_rows.c), and a copy of the file (cat, to another file).  Files are in the
folder for temporary files; csv, json and text go to /dev/null.  --before: another build of the command, for
csv.
"""
import argparse
import os
import pathlib
import statistics
import subprocess
import tempfile
import time

import tables

HERE = pathlib.Path(__file__).resolve().parent
LENS = HERE.parent / 'examples' / 'lenses' / 'double_gauss.yaml'


def timed(*command):
    """Seconds, and the most memory in MB."""
    begin = time.perf_counter()
    child = subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    assert child.returncode == 0, command
    return time.perf_counter() - begin, usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('build', type=pathlib.Path)
    parser.add_argument('--rays', type=int, default=1000000)
    parser.add_argument('--runs', type=int, default=7)
    parser.add_argument('--threads', default='2')
    parser.add_argument('--before')
    asked = parser.parse_args()
    sagitta, bench = asked.build / 'src/tool/sagitta', asked.build / 'tests/bench/bench_rows'
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        trace = ('trace', LENS, '--field', 0, '--random', asked.rays, '--threads', asked.threads)
        kinds = {
            'npy': (sagitta, *trace, '--format', 'npy', '-o', folder / 'all.npy'),
            'npy, a folder': (sagitta, *trace, '--format', 'npy', '-o', folder / 'columns'),
            'npy, `--last`': (sagitta, *trace, '--last', '--format', 'npy', '-o', folder / 'last.npy'),
            'csv': (sagitta, *trace, '--format', 'csv', '-o', '/dev/null'),
            'json': (sagitta, *trace, '--format', 'json', '-o', '/dev/null'),
            'text': (sagitta, *trace, '-o', '/dev/null'),
        }
        if asked.before:
            kinds['csv before'] = (asked.before, *trace, '--format', 'csv', '--output', '/dev/null')
        copies = {'npy': folder / 'all.npy', 'npy, `--last`': folder / 'last.npy'}
        seconds, memory, copied, alone = {k: [] for k in kinds}, {k: 0 for k in kinds}, {k: [] for k in copies}, []
        for _ in range(asked.runs):
            done = subprocess.run([bench, LENS, str(asked.rays), asked.threads], capture_output=True, text=True,
                                  check=True)
            alone.append(float(done.stdout.split()[0]))
            for kind, command in kinds.items():
                for path in folder.iterdir():
                    subprocess.run(['rm', '-r', path], check=True)
                took, most = timed(*command)
                seconds[kind].append(took)
                memory[kind] = max(memory[kind], most)
                if kind in copies:
                    begin = time.perf_counter()
                    with open(folder / 'copy', 'wb') as copy:
                        subprocess.run(['cat', copies[kind]], stdout=copy, check=True)
                    copied[kind].append(time.perf_counter() - begin)
    median = statistics.median
    rows = []
    for kind in kinds:
        copy = f'{median(copied[kind]):.2f}' if kind in copied else ''
        rows.append([kind, f'{median(seconds[kind]):.2f}', copy, f'{memory[kind]:.0f}'])
    parts = [f'The trace alone: {median(alone):.2f} s.',
             tables.table(['output', 'seconds', 'a copy of the file, seconds', 'most memory, MB'], rows)]
    for kind in copies:
        most = 2 * median(alone) + median(copied[kind])
        parts.append(f'{kind}: {median(seconds[kind]) / most:.2f} of twice the trace and a copy.')
    tables.write('rows', asked.build, '\n\n'.join(parts))


main()
