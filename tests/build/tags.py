#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Each function of the library is found by ctags, also those that macros make (.ctags.d/sagitta.ctags).

    python3 tests/build/tags.py TREE LIBRARY.a

compares the functions that the object files define with the tags.  Ends with 77 (skipped) where there is no
Universal Ctags.
"""
import re
import shutil
import subprocess
import sys

# What a compiler puts behind the name of a function that it has split or cloned; what dispatch adds.
ADDED = re.compile(r'(\.\w+)+$')
SET = re.compile(r'_(base|v3|v4)$')


def functions(library):
    listing = subprocess.run(['nm', library], capture_output=True, text=True, check=True).stdout
    for line in listing.splitlines():
        words = line.split()
        if len(words) == 3 and words[1] in 'tT':
            yield SET.sub('', ADDED.sub('', words[2]))


def main(tree, library):
    ctags = shutil.which('ctags')
    if not ctags or 'Universal' not in subprocess.run([ctags, '--version'], capture_output=True,
                                                      text=True).stdout:
        print('no Universal Ctags')
        return 77
    listing = subprocess.run([ctags, '-x', '-R', 'src', 'include'], cwd=tree, capture_output=True, text=True,
                             check=True).stdout
    tags = {line.split()[0] for line in listing.splitlines()}
    wanted = set(functions(library))
    missing = sorted(wanted - tags)
    print('\n'.join(f'{name}: no tag' for name in missing))
    print(f'{len(wanted)} functions, {len(missing)} without a tag')
    return 1 if missing or len(wanted) < 100 else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
