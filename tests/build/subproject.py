#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A meson project that has sagitta as a subproject: as a folder, and by a wrap file.

    python3 subproject.py TREE      skipped (77) where Ninja is missing

With the folder the project is only set up, with its default options.  With the wrap, an archive of this
tree, it is built and run too, with static libraries and one set of instructions.  Nothing may be
downloaded.
"""
import pathlib
import shutil
import sys
import tarfile
import tempfile

sys.dont_write_bytecode = True
import installed  # noqa: E402
import prefix  # noqa: E402
from find_package import CORE  # noqa: E402

PROJECT = """
project('bare', 'c', default_options: ['c_std=c11'])
foreach name, package : {'core': 'sagitta', 'lens': 'sagitta-lens', 'geo': 'sagitta-geo'}
  of_sagitta = dependency(package, required: name != 'geo', allow_fallback: true)
  if of_sagitta.found()
    executable(name, name + '.c', dependencies: of_sagitta)
  endif
endforeach
"""
WRAP = """
[wrap-file]
directory = sagitta-9
source_filename = sagitta-9.tar.gz

[provide]
dependency_names = sagitta, sagitta-lens, sagitta-geo
"""
PARTS = ['meson.build', 'meson_options.txt', 'cmake', 'src', 'include', 'data', 'LICENSE']


def project(folder):
    folder.mkdir()
    (folder / 'subprojects').mkdir()
    (folder / 'meson.build').write_text(PROJECT)
    for name, text in (('core', CORE), ('lens', installed.LENS), ('geo', installed.GEO)):
        (folder / f'{name}.c').write_text(text)
    return folder


def main(tree):
    if not shutil.which('ninja'):
        print('skipped: no ninja')
        return 77
    tree, setup = pathlib.Path(tree), [*prefix.meson_command(), 'setup', '--wrap-mode=nodownload']
    with tempfile.TemporaryDirectory() as name:
        by_folder, by_wrap = project(pathlib.Path(name, 'by_folder')), project(pathlib.Path(name, 'by_wrap'))
        (by_folder / 'subprojects' / 'sagitta').symlink_to(tree)
        (by_folder / 'meson.build').write_text(PROJECT.replace(
            'allow_fallback: true', "fallback: 'sagitta'"))
        said = prefix.run(*setup, '--force-fallback-for=sagitta', by_folder / 'b', by_folder)
        if 'Dependency sagitta-lens found: YES' not in said or '(overridden)' not in said:
            sys.exit(said)
        targets = prefix.run(*prefix.meson_command(), 'introspect', by_folder / 'b', '--targets')
        if 'test_' in targets or 'example_' in targets or 'sagitta_static' in targets:
            sys.exit(f'a subproject builds tests or examples:\n{targets}')
        print('by folder:', *(line for line in said.splitlines() if 'overridden' in line), sep='\n')

        packed = by_wrap / 'subprojects' / 'packagefiles' / 'sagitta-9.tar.gz'
        packed.parent.mkdir()
        with tarfile.open(packed, 'w:gz') as archive:
            for part in PARTS:
                archive.add(tree / part, f'sagitta-9/{part}')
        (by_wrap / 'subprojects' / 'sagitta.wrap').write_text(WRAP)
        prefix.run(*setup, '--force-fallback-for=sagitta', '-Ddefault_library=static',
                   '-Dsagitta:clones=none', '-Doptimization=0', '-Dsagitta:optimization=0', by_wrap / 'b', by_wrap)
        prefix.run('ninja', '-C', by_wrap / 'b')
        for program in ('core', 'lens', 'geo'):
            if (by_wrap / 'b' / program).exists():
                print(f'by wrap: {program}: {prefix.run(by_wrap / "b" / program)}', end='')
    return 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
