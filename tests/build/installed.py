#!/usr/bin/env python3
"""The library as a user has it: installed, found through pkg-config, linked.

Installs the build into a temporary folder; a C and a C++ program and the one in
README.md are then compiled against the shared and against the static library,
with no other file of the project, and run.

    python3 installed.py BUILD README CONSUMER_C CONSUMER_CPP C_COMPILER [CPP_COMPILER]
"""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

HEADERS = ['diagnose.h', 'interval.h', 'sagitta.h', 'surfaces.h', 'system.h']


def run(*command, **more):
    done = subprocess.run(command, text=True, capture_output=True, **more)
    if done.returncode:
        sys.exit(f'{shlex.join(command)}\n{done.stdout}{done.stderr}exit status {done.returncode}')
    return done.stdout


def main(build, readme, consumer_c, consumer_cpp, c_compiler, cpp_compiler=None):
    with tempfile.TemporaryDirectory() as name:
        there = pathlib.Path(name)
        meson = shlex.split(os.environ.get('MESONINTROSPECT', 'meson introspect'))[:-1]
        run(*meson, 'install', '-C', build, '--no-rebuild', '--destdir', str(there / 'root'))
        [pc] = (there / 'root').rglob('sagitta.pc')
        prefix_line = re.search(r'^prefix=(/.*)$', pc.read_text(), re.MULTILINE)[1]
        prefix = there / 'root' / prefix_line.lstrip('/')
        headers = sorted(p.name for p in (prefix / 'include' / 'sagitta').iterdir())
        if headers != HEADERS:
            sys.exit(f'installed headers: {headers}')

        def pkg_config(*arguments):
            environment = {**os.environ, 'PKG_CONFIG_PATH': str(pc.parent)}
            return shlex.split(run('pkg-config', f'--define-variable=prefix={prefix}',
                                   *arguments, 'sagitta', env=environment))

        libraries = {
            'shared': pkg_config('--cflags', '--libs'),
            'static': pkg_config('--cflags', '--libs', '--static'),
        }
        library_folder = pathlib.Path(pkg_config('--variable=libdir')[0])
        [block] = re.findall(r'^```c\n(.*?)^```', pathlib.Path(readme).read_text(),
                             re.MULTILINE | re.DOTALL)
        (there / 'readme.c').write_text(block)
        shutil.copy(consumer_c, there / 'consumer.c')
        shutil.copy(consumer_cpp, there / 'consumer.cpp')
        programs = [(['-std=c11'], c_compiler, 'consumer.c'), (['-std=c11'], c_compiler, 'readme.c')]
        if cpp_compiler:
            programs.append((['-std=c++11'], cpp_compiler, 'consumer.cpp'))

        command = prefix / 'bin' / 'sagitta'  # where libyaml was found
        if command.exists():
            print(run(str(command), '--version',
                      env={**os.environ, 'LD_LIBRARY_PATH': str(library_folder)}), end='')

        for form, flags in libraries.items():
            if form == 'static':
                # Where both lie side by side the linker takes the shared one.
                for library in library_folder.glob('libsagitta.so*'):
                    library.unlink()
            for standard, compiler, program in programs:
                run(*compiler.split(), *standard, '-Wall', '-Wextra', '-Wpedantic', '-Werror',
                    program, '-o', 'program', *flags, '-lm', cwd=there)  # -lm: the programs' own
                environment = {**os.environ, 'LD_LIBRARY_PATH': str(library_folder)}
                said = run('./program', cwd=there, env=environment)
                print(f'-- {program}, {form}\n{said}', end='')
    return 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
