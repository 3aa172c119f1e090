#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
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

HEADERS = ['aim.h', 'analysis.h', 'beam.h', 'diagnose.h', 'edit.h', 'figure.h', 'fma.h', 'formula.h', 'interval.h',
           'lens.h', 'pair.h', 'prove.h', 'sagitta.h', 'sagitta.hpp', 'sensitivity.h', 'shape.h', 'study.h', 'surfaces.h',
           'system.h',
           'tolerance.h', 'why.h']
GEO = r'''
#include <sagitta/geo.h>
#include <stdio.h>
int main(void)
{
    sgt_geodetic_height earth = {.h = 100};
    sgt_hit hit = sgt_intersect((sgt_surface){&sgt_geodetic_height_ops, &earth},
                                (sgt_ray){.o = {7e6, 0, 0}, .d = {-1, 0, 0}}, NULL);
    printf("%s at %.3f m\n", sgt_status_text(hit.status), hit.t);
    return !(hit.status == SGT_HIT && hit.t > 621762.9 && hit.t < 621763.1);
}
'''
LENS = r'''
#include <sagitta/lens.h>
#include <stdio.h>
int main(void)
{
    sgt_error error;
    sgt_catalogue *c = sgt_catalogue_new(NULL);
    sgt_glass g;
    if (!sgt_catalogue_add(c, NULL, &error) || !sgt_catalogue_find(c, "SCHOTT N-BK7", 0, NULL, &g, &error))
        return printf("%s:%zu: %s: %s\n", error.file, error.line, error.key, error.words), 1;
    double n = sgt_glass_index(&g, sgt_spectral_line("d"));
    printf("%zu glasses, N-BK7 %.5f\n", sgt_catalogue_count(c), n);
    sgt_catalogue_free(c);
    if (!(n > 1.516795 && n < 1.516805)) return 1;
    static const char zmx[] =
        "MODE SEQ\nENPD 10\nFTYP 0 0 1 1\nYFLN 0\nWAVM 1 0.5875618 1\nPWAV 1\nSURF 0\n DISZ INFINITY\n"
        "SURF 1\n STOP\n CURV 0.02\n DISZ 4\n GLAS N-BK7 0 0\nSURF 2\n CURV -0.02\n DISZ 40\nSURF 3\n DISZ 0\n";
    sgt_lens *lens = sgt_lens_read_text("a.zmx", zmx, sizeof zmx - 1, NULL, &error);
    if (!lens) return printf("%s:%zu: %s: %s\n", error.file, error.line, error.key, error.words), 1;
    sgt_first_order data;
    bool fine = sgt_lens_first_order(lens, 0.5875618, &data, NULL, &error);
    sgt_ray ray = {.o = {0, 1, -10}, .d = {0, 0, 1}};
    sgt_fate fate;
    size_t passed = sgt_trace(lens->count, lens->element, lens->index_before, &ray, NULL, &fate, NULL);
    printf("%zu surfaces, efl %.4f, the ray passed %zu\n", lens->count, data.efl, passed);
    sgt_lens_free(lens);
    return !(fine && passed == 3 && data.efl > 49 && data.efl < 50);
}
'''


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
        geo = (pc.parent / 'sagitta-geo.pc').exists()  # where GeographicLib was found
        if headers != sorted(HEADERS + ['geo.h'] * geo):
            sys.exit(f'installed headers: {headers}')

        def pkg_config(*arguments, package='sagitta'):
            environment = {**os.environ, 'PKG_CONFIG_PATH': str(pc.parent)}
            return shlex.split(run('pkg-config', f'--define-variable=prefix={prefix}',
                                   *arguments, package, env=environment))

        libraries = {
            'shared': pkg_config('--cflags', '--libs'),
            'static': pkg_config('--cflags', '--libs', '--static'),
        }
        libraries_geo = {
            'shared': pkg_config('--cflags', '--libs', package='sagitta-geo'),
            'static': pkg_config('--cflags', '--libs', '--static', package='sagitta-geo'),
        } if geo else {}
        libraries_lens = {
            'shared': pkg_config('--cflags', '--libs', package='sagitta-lens'),
            'static': pkg_config('--cflags', '--libs', '--static', package='sagitta-lens'),
        }
        library_folder = pathlib.Path(pkg_config('--variable=libdir')[0])
        [block] = re.findall(r'^```c\n(.*?)^```', pathlib.Path(readme).read_text(),
                             re.MULTILINE | re.DOTALL)
        (there / 'readme.c').write_text(block)
        (there / 'geo.c').write_text(GEO)
        (there / 'lens.c').write_text(LENS)
        glass = pathlib.Path(*(prefix / 'share').rglob('sagitta/glass'))
        shutil.copy(consumer_c, there / 'consumer.c')
        shutil.copy(consumer_cpp, there / 'consumer.cpp')
        programs = [(['-std=c11'], c_compiler, 'consumer.c'), (['-std=c11'], c_compiler, 'readme.c')]
        if cpp_compiler:
            programs.append((['-std=c++11'], cpp_compiler, 'consumer.cpp'))

        command = prefix / 'bin' / 'sagitta'  # where libyaml was found
        if command.exists():
            # It finds the libraries by itself.
            bare = {name: value for name, value in os.environ.items() if name != 'LD_LIBRARY_PATH'}
            print(run(str(command), '--version', env=bare), end='')

        for form, flags in libraries.items():
            if form == 'static':
                # Where both lie side by side the linker takes the shared one.
                for library in library_folder.glob('libsagitta*.so*'):
                    library.unlink()
            of_geo = [(['-std=c11'], c_compiler, 'geo.c')] if geo else []
            of_lens = [(['-std=c11'], c_compiler, 'lens.c')]
            flags_of = {'geo.c': libraries_geo.get(form), 'lens.c': libraries_lens[form]}
            for standard, compiler, program in programs + of_geo + of_lens:
                run(*compiler.split(), *standard, '-Wall', '-Wextra', '-Wpedantic', '-Werror',
                    program, '-o', 'program', *flags_of.get(program, flags), '-lm',
                    cwd=there)  # -lm: the programs' own
                environment = {**os.environ, 'LD_LIBRARY_PATH': str(library_folder),
                               'SAGITTA_GLASS': str(glass)}
                said = run('./program', cwd=there, env=environment)
                print(f'-- {program}, {form}\n{said}', end='')
                if program == 'readme.c' and f'It prints `{said.strip()}`' not in pathlib.Path(readme).read_text():
                    sys.exit(f'{readme} says that its program prints something else')
    return 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
