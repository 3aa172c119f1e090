#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Two builds in two folders install the same bytes.

    python3 tests/build/same_bytes.py TREE [OPTION OF MESON...]     -Doptimization=3 takes the time of two whole builds
    python3 tests/build/same_bytes.py --planted                     tries the comparison on folders that differ

The sources are copied to two folders whose paths differ in length, and are compiled there without ccache, in other time
zones and languages, some seconds apart; SOURCE_DATE_EPOCH is the same.  Of each installed file the bytes, the mode and
the target of a link are compared: libraries, static ones too, commands, headers, pages of the manual, the package for
Python.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
OPTIONS = ['-Doptimization=0', '-Dclones=none', '--prefix=/usr', '--libdir=lib', '-Dtests=false', '-Dexamples=false',
           '-Dsource_folder=false', '-Dpython_package=true']
PLACES = [('one', {'TZ': 'UTC', 'LC_ALL': 'C'}), ('another/with a longer/path', {'TZ': 'Pacific/Kiritimati', 'LC_ALL': 'C.UTF-8'})]


def differences(first, second):
    """What is in one of two folders alone, or is not the same."""
    there = [{p.relative_to(f) for p in f.rglob('*') if p.is_symlink() or not p.is_dir()} for f in (first, second)]
    yield from (f'{path}: in one alone' for path in sorted(there[0] ^ there[1]))
    for path in sorted(there[0] & there[1]):
        a, b = first / path, second / path
        if a.is_symlink() or b.is_symlink():
            if not (a.is_symlink() and b.is_symlink() and os.readlink(a) == os.readlink(b)):
                yield f'{path}: links differ'
        elif a.read_bytes() != b.read_bytes():
            at = next((i for i, (x, y) in enumerate(zip(a.read_bytes(), b.read_bytes())) if x != y), 'the end')
            yield f'{path}: differs at byte {at}'
        elif a.stat().st_mode != b.stat().st_mode:
            yield f'{path}: modes differ'


def built(tree, folder, environment, options):
    shutil.copytree(tree, folder / 'source', ignore=shutil.ignore_patterns('build', '.git', '__pycache__'))
    environment = {**os.environ, **environment, 'SOURCE_DATE_EPOCH': '1700000000', 'CCACHE_DISABLE': '1'}
    for command in (['meson', 'setup', 'build', 'source', *OPTIONS, *options], ['meson', 'compile', '-C', 'build'],
                    ['meson', 'install', '-C', 'build', '--no-rebuild', '--destdir', str(folder / 'installed')]):
        done = subprocess.run(command, cwd=folder, env=environment, text=True, capture_output=True)
        if done.returncode:
            sys.exit(f'{" ".join(command)}\n{done.stdout[-3000:]}{done.stderr[-3000:]}')
    return folder / 'installed'


def planted():
    with tempfile.TemporaryDirectory() as name:
        one, other = pathlib.Path(name, 'one'), pathlib.Path(name, 'other')
        for folder in (one, other):
            folder.mkdir()
            (folder / 'same').write_text('same')
            (folder / 'unlike').write_text(f'a{folder.name}')
            (folder / 'mode').write_text('')
            (folder / 'link').symlink_to(folder.name)
        (one / 'mode').chmod(0o755)
        (one / 'alone').write_text('')
        found = list(differences(one, other))
    print(*found, sep='\n')
    return 0 if len(found) == 4 and not any('same' in line for line in found) else 1


def main(*words):
    if words == ('--planted',):
        return planted()
    if not words:
        sys.exit(__doc__)
    if not shutil.which('meson') or not shutil.which('ninja'):
        print('skipped: there is no meson or no ninja')
        return SKIPPED
    with tempfile.TemporaryDirectory() as name:
        installed = []
        for place, environment in PLACES:
            folder = pathlib.Path(name, place)
            folder.mkdir(parents=True)
            installed.append(built(pathlib.Path(words[0]).resolve(), folder, environment, words[1:]))
        files = sum(not p.is_dir() for p in installed[0].rglob('*'))
        found = list(differences(*installed))
    print(*found, f'{files} files, {len(found)} differ', sep='\n')
    return 1 if found or files < 30 else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
