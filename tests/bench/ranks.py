#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""How much faster two ranks of sagitta-mpi are than one, and one than `sagitta`: rays a second, in turn.

    python3 tests/bench/ranks.py build/src/tool [ROUNDS [SHARE]]      build: with -Dmpi=enabled

Each of them has one thread.  A round runs all of them, and medians of rounds are compared.  A start of MPI takes as long
as a million rays: what a run of one ray takes is told, and times are compared with it and without it.  Files are
removed and the disk is waited for before each run, which else would pay for the one before.  The machine has to
be idle: its load is printed.  Without more words there are 5 rounds of 30 and 10 million rays, two minutes in
all; SHARE divides these.
"""
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

tool = pathlib.Path(sys.argv[1])
rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 5
share = int(sys.argv[3]) if len(sys.argv) > 3 else 1
lens = pathlib.Path(__file__).resolve().parents[2] / 'examples' / 'lenses' / 'cooke_triplet.yaml'
environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT='1', OMPI_ALLOW_RUN_AS_ROOT_CONFIRM='1',
                   OMPI_MCA_rmaps_base_oversubscribe='1', OMPI_MCA_hwloc_base_binding_policy='none',
                   OMPI_MCA_btl_vader_single_copy_mechanism='none')
ways = {'sagitta': [tool / 'sagitta'], 'one rank': ['mpirun', '-q', '-n', '1', tool / 'sagitta-mpi'],
        'two ranks': ['mpirun', '-q', '-n', '2', tool / 'sagitta-mpi']}


def seconds(way, arguments):
    for left in pathlib.Path(folder).iterdir():
        left.unlink()
    os.sync()
    started = time.monotonic()
    subprocess.run([*map(str, ways[way]), *arguments, '--threads', '1'], env=environment, check=True,
                   stdout=subprocess.DEVNULL)
    return time.monotonic() - started


with tempfile.TemporaryDirectory() as folder:
    asked = {
        'spot': (['spot', str(lens), '--fields', '3', '--random'], 30000000),
        'trace --last to npy': (['trace', str(lens), '--fields', '3', '--last', '--format', 'npy', '--output',
                                 f'{folder}/rows.npy', '--random'], 10000000)}
    print(f'load {os.getloadavg()[0]:.1f}, {os.cpu_count()} processors')
    for what, (arguments, rays) in asked.items():
        rays //= share
        took = {way: [] for way in ways}
        start = {way: seconds(way, [*arguments, '1']) for way in ways}
        for _ in range(rounds):
            for way in ways:
                took[way].append(seconds(way, [*arguments, str(rays)]))
        middle = {way: statistics.median(took[way]) for way in ways}
        for way in ways:
            print(f'{what}, {way}: {rays / middle[way]:.3g} rays a second, {middle[way]:.2f} s, start {start[way]:.2f} s')
        traced = {way: middle[way] - start[way] for way in ways}
        for times, name in (middle, 'with their start'), (traced, 'without it'):
            print(f'{what}, {name}: two ranks {times["one rank"] / times["two ranks"]:.2f} times as fast as one; one rank '
                  f'takes {times["one rank"] / times["sagitta"] - 1:+.1%} more than sagitta; load {os.getloadavg()[0]:.1f}')
