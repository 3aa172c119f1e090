#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""libsagitta.so, stripped, is no larger than it has to be.

    python3 tests/build/size.py LIBRARY BYTES      at most BYTES, and not below nine tenths of it

It is for a build with all sets of instructions as it is installed (-O3, no sanitizer); meson.build asks no other.
Whoever makes the library smaller lowers the limit: so it cannot grow back unseen.  What fills it:

    size -A build/src/libsagitta_v3*.a.p/*.o      by files (v3_short, v3_plain, v3_small: src/meson.build)
    nm -S --size-sort build/src/libsagitta_v3*.a  by functions
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77


def stripped(library):
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder, 'library')
        subprocess.run(['strip', '-o', copy, library], check=True)
        return copy.stat().st_size


def judged(size, most):
    """What is wrong with that size, or nothing."""
    if size > most:
        return f'{size - most} bytes too many'
    return 'the limit is to be lowered' if size < 0.9 * most else ''


def main(library, most):
    if not shutil.which('strip'):
        print('skipped: there is no strip')
        return SKIPPED
    size, most = stripped(library), int(most)
    whole = pathlib.Path(library).stat().st_size
    # The test of the test: the symbols are taken off, and one byte too many is seen.
    planted = whole > size > 0 and judged(most + 1, most) and judged(most // 2, most) and not judged(most, most)
    fault = judged(size, most) if planted else 'the test itself is at fault'
    print(f'{size} bytes, {most} at most' + (f': {fault}' if fault else ''))
    return 1 if fault else 0


if __name__ == '__main__':
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
