#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""find_package(sagitta) from bare projects: every library, shared and static, and what has to be refused.

    python3 find_package.py BUILD C_COMPILER     skipped (77) without CMake

The build is installed, moved to another folder, and seen by nothing but CMAKE_PREFIX_PATH.  Programs use
the core, lens and geo, in C alone; each is run, and has to need our shared libraries if and only if they
were asked for.
"""
import pathlib
import shutil
import sys
import tempfile

sys.dont_write_bytecode = True
import installed  # noqa: E402
import prefix  # noqa: E402

CORE = r'''
#include <sagitta/surfaces.h>
#include <stdio.h>
int main(void)
{
    const sgt_conic sphere = {.c = 1 / -2.2136};
    sgt_ray ray = {.o = {0, 0.5, -5}, .d = {0, 0.3420201433256687, 0.9396926207859084}};
    sgt_hit hit = sgt_intersect((sgt_surface){&sgt_conic_ops, &sphere}, ray, NULL);
    printf("%s at t = %.16g, version %s\n", sgt_status_text(hit.status), hit.t, sgt_version());
    return !(hit.status == SGT_HIT && sgt_version_number() == SGT_VERSION);
}
'''
# It names nothing of the core, so it is linked to sagitta_lens alone, which has to find the core by itself.
GLASS = r'''
#include <sagitta/lens.h>
#include <stdio.h>
int main(void)
{
    double um = sgt_spectral_line("d");
    printf("line d %.7f um\n", um);
    return !(um > 0.58 && um < 0.59);
}
'''
PROJECT = '''cmake_minimum_required(VERSION {least})
project(bare LANGUAGES C)
{find}
{more}
'''
PROGRAM = 'add_executable({0} {0}.c)\ntarget_link_libraries({0} PRIVATE sagitta::{1}{2})\n'
SOURCES = {'core': ('sagitta', CORE), 'lens': ('lens', installed.LENS), 'glass': ('lens', GLASS),
           'geo': ('geo', installed.GEO)}


class Projects:
    def __init__(self, there, folder, compiler):
        self.there, self.folder, self.compiler, self.count = there, folder, compiler, 0
        self.least = '3.16'  # the version of CMake whose policies hold in the project
        self.environment = {name: value for name, value in there.environment.items()
                            if name not in ('LD_LIBRARY_PATH', 'PKG_CONFIG_PATH')}

    def configure(self, find, more='', fails=False):
        self.count += 1
        project = self.folder / f'project{self.count}'
        project.mkdir()
        for file, (_, source) in SOURCES.items():
            (project / f'{file}.c').write_text(source)
        (project / 'CMakeLists.txt').write_text(PROJECT.format(find=find, more=more, least=self.least))
        self.said = prefix.run('cmake', '-S', project, '-B', project / 'b',
                               f'-DCMAKE_PREFIX_PATH={self.there.path}', '-DCMAKE_BUILD_TYPE=Release',
                               f'-DCMAKE_C_COMPILER={self.compiler}', fails=fails, env=self.environment)
        return project / 'b'

    def runs(self, find, libraries, form, suffix=''):
        """The programs of these libraries, built and run, are of that form."""
        programs = {name: library for name, (library, _) in SOURCES.items() if library in libraries}
        build = self.configure(find, ''.join(PROGRAM.format(program, library, suffix)
                                             for program, library in programs.items()))
        prefix.run('cmake', '--build', build, env=self.environment)
        for program, library in programs.items():
            said = prefix.run(build / program, env=self.environment).splitlines()[-1]
            needed = prefix.run('readelf', '-d', build / program)
            shared = 'libsagitta' in needed
            if shared != (form == 'shared'):
                sys.exit(f'{find}: {program} is not {form}:\n{needed}')
            print(f'{"; ".join(find.splitlines())}: sagitta::{library}{suffix}, {form}: {said}')

    def refused(self, find, words):
        self.configure(find, fails=True)
        if ' '.join(words.split()) not in ' '.join(self.said.split()):
            sys.exit(f'{find}: is refused, but not for: {words}\n{self.said}')
        print(f'{"; ".join(find.splitlines())}: refused, {words}')


def main(build, compiler):
    if not shutil.which('cmake'):
        print('skipped: no cmake')
        return 77
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        there = prefix.Prefix(build, folder)
        projects = Projects(there, folder, compiler)
        version = prefix.run('pkg-config', '--modversion', 'sagitta', env=there.environment).strip()
        major, minor, _ = version.split('.')
        names = ['sagitta', 'lens'] + ['geo'] * there.geo
        rest = ' '.join(names[1:])

        projects.runs(f'find_package(sagitta {major}.{minor} REQUIRED COMPONENTS {rest})', names, 'shared')
        projects.runs(f'find_package(sagitta {major}.{minor} CONFIG REQUIRED)', names[:1], 'shared')
        projects.runs(f'find_package(sagitta {version} EXACT REQUIRED static {rest})', names, 'static')
        projects.runs('find_package(sagitta REQUIRED)', names[:1], 'static', '_static')
        # A project with two libraries that ask for it independently, and one that wants both forms.
        again = '\nfind_package(sagitta REQUIRED)'
        projects.runs('find_package(sagitta REQUIRED COMPONENTS lens)' + again, names[:2], 'shared')
        projects.runs('find_package(sagitta REQUIRED static)' + again, names[:2], 'static')

        if int(prefix.run('cmake', '--version').split()[2].split('.')[0]) < 4:  # which has no policies of 3.1
            projects.least = '3.1'
            projects.runs(f'find_package(sagitta {version} REQUIRED static {rest})', names, 'static')
            projects.least = '3.16'

        projects.refused('find_package(sagitta REQUIRED shared)\nfind_package(sagitta REQUIRED static)',
                         'stands for sagitta::sagitta_shared already')
        projects.refused('find_package(sagitta REQUIRED shared static)', 'ask for shared or for static')
        projects.refused('find_package(sagitta REQUIRED COMPONENTS none)', 'no component none')
        projects.refused(f'find_package(sagitta {major}.{int(minor) + 1} REQUIRED)', f'version: {version}')
        projects.refused('find_package(sagitta 0.1 REQUIRED)', f'version: {version}')
        projects.refused(f'find_package(sagitta 0.2...<{version} REQUIRED)', f'version: {version}')
        projects.runs(f'find_package(sagitta 0.2...{version} REQUIRED)', names[:1], 'shared')
        projects.refused('set(CMAKE_SIZEOF_VOID_P 2)\nfind_package(sagitta REQUIRED)', f'version: {version}')
        projects.configure('find_package(sagitta OPTIONAL_COMPONENTS none)\n'
                           'if(NOT sagitta_FOUND OR sagitta_none_FOUND)\nmessage(FATAL_ERROR no)\nendif()')

        # /lib beside /usr/lib: a link to the folder of libraries, from where /../include is not.
        (folder / 'links').mkdir()
        (folder / 'links' / 'lib').symlink_to(there.path / 'lib')
        moved, there.path = there.path, folder / 'links'
        projects.runs('find_package(sagitta REQUIRED)', names[:1], 'shared')
        there.path = moved

        there.without_shared()
        projects.runs('find_package(sagitta REQUIRED)', names[:2], 'static')
        projects.refused('find_package(sagitta REQUIRED shared)', 'no shared library')
    print(f'{projects.count} projects')
    return 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
