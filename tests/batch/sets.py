#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The same bits from every set of instructions: base, v3 and v4 of src/dispatch/dispatch.h.

    python3 sets.py PROGRAM ...

Each program (checksum.c, checksum_earth.c) runs once for each set that the processor has (SAGITTA_SET).  All
print the same.  A set that the processor does not have is left out, and that is said.  If the library has
one set only, the test is skipped.  SAGITTA_TEST_SCALE (0.15) multiplies how many rays.
"""
import os
import pathlib
import re
import subprocess
import sys

SKIPPED = 77
# What a set asks of the processor, as /proc/cpuinfo calls it (x86-64 psABI 1.0, table 3.1).
V3 = set('avx avx2 bmi1 bmi2 f16c fma abm movbe xsave'.split())
SETS = {'base': set(), 'v3': V3, 'v4': V3 | set('avx512f avx512bw avx512cd avx512dq avx512vl'.split())}


def features():
    about = pathlib.Path('/proc/cpuinfo')
    flags = about.exists() and re.search(r'^flags\s*:(.*)$', about.read_text(errors='replace'), re.MULTILINE)
    return set(flags[1].split()) if flags else set()


def main(*programs):
    if os.uname().machine != 'x86_64':
        print('skipped: one set alone')
        return SKIPPED
    here, faults = features(), 0
    for program in programs:
        said = {}
        for name, needed in SETS.items():
            if not needed <= here:
                print(f'{name}: left out, the processor has it not')
                continue
            said[name] = subprocess.run([program], text=True, check=True, capture_output=True,
                                        env={'SAGITTA_TEST_SCALE': '0.15'} | os.environ | {'SAGITTA_SET': name}).stdout
        best = list(said)[-1]
        print(f'{program}, {best}:\n{said[best]}', end='')
        for name, lines in said.items():
            for ours, theirs in zip(said[best].splitlines(), lines.splitlines()):
                if ours != theirs:
                    print(f'{name}: {theirs}')
                    faults += 1
            faults += len(lines) != len(said[best])
    print(f'{faults} faults')
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
