#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The same bits of interval.h from every build: checksum.c by gcc and by clang, as C and as C++,
at each level of optimisation, without and with a fused multiply-add of the processor (without, the
C library's own is taken away as well, where it heeds GLIBC_TUNABLES).  Each has the compiler's
default of -ffp-contract, which for gcc is to fuse what it can: the header promises that there is
nothing.  Warnings are errors.  SAGITTA_TEST_SCALE above 1: each level for each kind of processor.

    python3 builds.py INCLUDE CHECKSUM.C [--planted]     --planted: a product beside a sum, to be seen
"""
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile

WARNINGS = '-Wall -Wextra -Wshadow -Wconversion -Wsign-conversion -Wfloat-conversion -Wundef -Wcast-qual -Wpedantic -Werror'.split()
COMPILERS = [('gcc', 'gnu17', 'c'), ('g++', 'c++11', 'c++'), ('clang', 'gnu17', 'c'), ('clang++', 'c++17', 'c++'), ('gcc', 'c11', 'c')]
SOFT = {'GLIBC_TUNABLES': 'glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2'}  # the C library's fma in integers or doubles


def fused():
    """Can this processor run x86-64-v3?"""
    about = pathlib.Path('/proc/cpuinfo')
    flags = re.search(r'^flags\s*:(.*)$', about.read_text(), re.MULTILINE) if about.exists() else None
    return flags is not None and {'fma', 'avx2', 'bmi2', 'movbe'} <= set(flags[1].split())


def main(include, source, planted):
    kinds = [('x86-64', SOFT)] + [('x86-64-v3', {})] * fused() if platform.machine() == 'x86_64' else [('native', {})]
    full = float(os.environ.get('SAGITTA_TEST_SCALE') or 1) > 1
    sums, fails = {}, 0
    with tempfile.TemporaryDirectory() as folder:
        if planted:
            target = pathlib.Path(folder, 'sagitta')
            shutil.copytree(pathlib.Path(include, 'sagitta'), target)
            header = target / 'interval.h'
            text = header.read_text()
            header.write_text(text.replace('m = lo + hi;', 'm = 0.5 * lo + 0.5 * hi;').replace('m = fabs(m)', 'if (0) m = fabs(m)'))
            assert header.read_text() != text
            include = folder
        for compiler, standard, language in COMPILERS:
            if not shutil.which(compiler):
                print(f'{compiler}: not here, skipped')
                continue
            for kind, environment in kinds:
                levels = ['-O2']
                if standard == 'gnu17':
                    levels = ['-O0', '-O1', '-O2', '-O3'] if full else ['-O1', '-O3'] if kind == 'x86-64-v3' else ['-O0', '-O2']
                elif not full and (kind, environment) != kinds[-1]:
                    continue
                for level in levels:
                    name = f'{compiler} -std={standard} {level} -march={kind}'
                    program = pathlib.Path(folder, 'checksum')
                    built = subprocess.run([compiler, f'-std={standard}', level, f'-march={kind}', *WARNINGS, f'-I{include}', '-x', language, source,
                                            '-o', program, '-lm'], text=True, capture_output=True)
                    if built.returncode and 'march' in built.stderr and ('unknown' in built.stderr or 'bad value' in built.stderr):
                        print(f'{name}: the compiler does not know it, skipped')
                        continue
                    if built.returncode:
                        print(f'FAIL {name}\n{built.stderr}')
                        fails += 1
                        continue
                    said = subprocess.run([program], text=True, capture_output=True, check=True, env={**os.environ, **environment}).stdout
                    sums.setdefault(said, []).append(name)
                    print(f'{name}: {said.split()[-1]}')
    if not sums:
        sys.exit(77)
    if len(sums) > 1:
        (first, names), (second, others) = list(sums.items())[:2]
        where = next(a for a, b in zip(first.splitlines(), second.splitlines()) if a != b).split()[0]
        print(f'FAIL: {names[0]} and {others[0]} differ within {where} operations')
    sys.exit(1 if fails or len(sums) > 1 else 0)


if __name__ == '__main__':
    words = [w for w in sys.argv[1:] if w != '--planted']
    main(*words, planted='--planted' in sys.argv)
