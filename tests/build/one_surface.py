#!/usr/bin/env python3
"""A program that links one surface statically carries one surface.

    python3 one_surface.py PROGRAM    (made of one_surface.c: a conic)
"""
import subprocess
import sys


def main(program):
    names = {line.split()[0] for line in subprocess.run(
        ['nm', '--format=posix', program], text=True, check=True, capture_output=True).stdout.splitlines()}
    carried = sorted(name for name in names if name.startswith('sgt_'))
    too_many = [name for name in names if 'asphere' in name or name in ('sgt_builtins', 'sgt_trace')]
    said = subprocess.run([program], text=True, capture_output=True)
    print(said.stdout, ' '.join(carried), f'{len(too_many)} too many: {" ".join(too_many)}', sep='\n')
    return 1 if too_many or said.returncode or 'sgt_conic_ops' not in names else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
