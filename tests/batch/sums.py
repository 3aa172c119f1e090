#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The sums of checksum.c against those in checksum.txt: an answer that changed by one bit is seen.

    python3 tests/batch/sums.py COMMAND...           of a tenth of the rays; COMMAND is checksum, or
                                                     `qemu-s390x checksum`
    python3 tests/batch/sums.py --full COMMAND...    of all rays, ten times as long
    python3 tests/batch/sums.py --write COMMAND...   writes checksum.txt: where answers were changed on
                                                     purpose, and where hostile.h or checksum.c were

Where a sum differs, `checksum PART` lists that part ray by ray, on both systems.
"""
import os
import pathlib
import subprocess
import sys

FILE = pathlib.Path(__file__).resolve().parent / 'checksum.txt'
SCALES = {'tenth': '0.1', 'full': '1'}
HEAD = '''# The sums of checksum.c, of a tenth of the rays and of all, on every system.  Written by
#     python3 tests/batch/sums.py --write BUILD/tests/batch/checksum
'''


def asked(command, scale, environment=None):
    """{part: sum} as the program says it."""
    environment = {**(environment or os.environ), 'SAGITTA_TEST_SCALE': SCALES[scale]}
    environment.pop('SAGITTA_TEST_SEED', None)
    done = subprocess.run(command, text=True, capture_output=True, env=environment)
    if done.returncode:
        said = f'{done.stdout}{done.stderr}exit status {done.returncode}'
        raise RuntimeError(f'{" ".join(map(str, command))}\n{said}')
    return {line[:16].strip(): line.split()[-1] for line in done.stdout.splitlines()}


def expected(scale):
    rows = [line.split() for line in FILE.read_text().splitlines() if not line.startswith('#')]
    return {' '.join(row[:-2]): row[-1 - (scale == 'tenth')] for row in rows}


def others(said, scale):
    """The parts whose sum is not the expected one, or that are in one list alone."""
    wanted = expected(scale)
    return [part for part in {**wanted, **said} if said.get(part) != wanted.get(part)]


def main(*words):
    options = {word for word in words if word in ('--full', '--write')}
    command = [word for word in words if word not in options]
    if not command:
        sys.exit(__doc__)
    if '--write' in options:
        tenth, full = asked(command, 'tenth'), asked(command, 'full')
        FILE.write_text(HEAD + ''.join(f'{part:16} {tenth[part]} {full[part]}\n' for part in full))
        return 0
    scale = 'full' if '--full' in options else 'tenth'
    said = asked(command, scale)
    wrong = others(said, scale)
    for part in wrong:
        print(f'{part}: {said.get(part, "not asked")}, expected {expected(scale).get(part, "nothing")}')
    print(f'{len(said)} sums, {len(wrong)} not as in {FILE.name}')
    if wrong:
        print(f'On purpose?  python3 tests/batch/sums.py --write {" ".join(command)}')
    return 1 if wrong or not said else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
