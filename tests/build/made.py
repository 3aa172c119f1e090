#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Builds a program that a plain build leaves out, and runs it or gives it to a script.

    python3 tests/build/made.py BUILD TARGET [ARGUMENT ...]

An ARGUMENT that is @ is the path of the program; without any the program is run.  (meson builds every
program that a test or a benchmark names, and so none names those.)
"""
import os
import subprocess
import sys


def main(build, target, *arguments):
    done = subprocess.run([os.environ.get('NINJA', 'ninja'), '-C', build, target], capture_output=True, text=True)
    if done.returncode:
        print(done.stdout + done.stderr)
        return done.returncode
    program = os.path.join(build, target)
    words = [program if a == '@' else a for a in arguments]
    return subprocess.run(words if '@' in arguments else [program] + words).returncode


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
