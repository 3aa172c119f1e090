#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""How much faster two ranks of sagitta-mpi are than one, and one than `sagitta`: rays a second, in turn.

    python3 tests/bench/ranks.py build/src/tool [ROUNDS [SHARE]]      build: with -Dmpi=enabled

Each of them has one thread.  A round runs all of them, and medians of rounds are compared.  What a start of MPI takes
(a run of one ray) is told, and is in the times.  The machine has to be idle: its load is printed.  Without
more words there are 5 rounds of 30 and 10 million rays; SHARE divides these.
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
        print(f'{what}: two ranks {middle["one rank"] / middle["two ranks"]:.2f} times one rank; one rank '
              f'{middle["one rank"] / middle["sagitta"] - 1:+.1%} of the time of sagitta; load {os.getloadavg()[0]:.1f}')
