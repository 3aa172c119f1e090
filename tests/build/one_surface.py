#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A program that links one surface statically carries one surface.

    python3 one_surface.py PROGRAM ALONE

Both are made of one_surface.c, which meets a conic: PROGRAM with the whole library to choose from, ALONE with
only the files that a conic needs.  Code and data of PROGRAM are no larger, but for gaps between objects that
are linked in another order.  So the rest of the library adds nothing.
"""
import subprocess
import sys


BETWEEN = 512  # bytes: a dozen objects, each at a multiple of 32


def sizes(program):
    """Code, data and room for data."""
    told = subprocess.run(['size', '--format=berkeley', program], text=True, check=True,
                          capture_output=True).stdout.splitlines()
    return [int(number) for number in told[1].split()[:3]]


def main(program, alone):
    names = {line.split()[0] for line in subprocess.run(
        ['nm', '--format=posix', program], text=True, check=True, capture_output=True).stdout.splitlines()}
    carried = sorted(name for name in names if name.startswith('sgt_'))
    too_many = [name for name in names if 'asphere' in name or 'departure' in name
                or name in ('sgt_builtins', 'sgt_trace')]
    size, least = sizes(program), sizes(alone)
    larger = any(a > b + BETWEEN for a, b in zip(size, least))
    said = subprocess.run([program], text=True, capture_output=True)
    print(said.stdout, ' '.join(carried), f'{len(too_many)} too many: {" ".join(too_many)}',
          f'code, data, room: {size}; of a conic alone {least}', sep='\n')
    return 1 if too_many or larger or said.returncode or 'sgt_conic_ops' not in names else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
