#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The examples in the comments of the public headers compile and run, and each surface of theirs is met.

    python3 header_examples.py INCLUDE_FOLDER LIBRARY C_COMPILER [CPP_COMPILER]   (their words, by spaces)

An example is the indented text after a line of a comment that ends with `Example ... :`.  If it has an
`sgt_surface s`, one ray of a few has to meet it.  Each type of surfaces.h has an example.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

FLAGS = ['-std=c11', '-Wall', '-Wextra', '-Wpedantic', '-Werror', '-Wno-unused-variable',
         '-Wno-unused-but-set-variable']
FLAGS_CPP = ['-std=c++17', *FLAGS[1:]]
PROGRAM = r"""
#include <math.h>
#include <sagitta/diagnose.h>
#include <sagitta/interval.h>
#include <sagitta/sensitivity.h>
#include <sagitta/surfaces.h>
#include <sagitta/system.h>
#include <stdio.h>

static int meet(const char *where, sgt_surface s)
{
    static const double x[] = {0.1, 0.7, 0.3};
    int met = 0, invalid = 0;
    for (int i = 0; i < 3; i++) {
        sgt_ray ray = {{x[i], 0.2, -4}, {0, 0, 1}, 0, 0};
        sgt_hit hit = sgt_intersect(s, ray, NULL);
        met += hit.status == SGT_HIT, invalid += hit.status == SGT_INVALID;
    }
    printf("%s: %s, %d of 3 rays meet it\n", where, s.ops->name, met);
    return met == 0 || invalid != 0;
}

int main(void)
{
    int faults = 0;
EXAMPLES
    return faults;
}
"""


def examples(header):
    """(line, code) of each."""
    lines = header.read_text().splitlines()
    for i, line in enumerate(lines):
        if not re.search(r'\bExample\b[^:]*:$', line):
            continue
        code = []
        for text in lines[i + 1:]:
            if text == ' *' and not code:
                continue
            if not text.startswith(' *     '):
                break
            code.append(text[len(' *     '):])
        yield i + 1, code


def blocks_of(headers):
    """The code of all examples, each a block of its own; (blocks, all their text, faults)."""
    blocks, faults, shown = [], 0, ''
    for header in headers:
        for line, code in examples(header):
            where, text = f'{header.name}:{line}', '\n'.join(code)
            if not code:
                print(f'{where}: there is no example')
                faults += 1
            shown += text
            if re.search(r'\b(sgt_surface|auto) s =', text):
                text += f'\nfaults += meet("{where}", s);'
            blocks.append(f'{{\n#line {line + 2} "{header.name}"\n{text}\n}}\n')
    return blocks, shown, faults


def faults_when_run(blocks, name, command, include, library):
    with tempfile.TemporaryDirectory() as folder:
        source, program = pathlib.Path(folder, name), pathlib.Path(folder, 'examples')
        more = '#include <sagitta/sagitta.hpp>\n' if name.endswith('.cpp') else ''
        source.write_text(more + PROGRAM.replace('EXAMPLES', ''.join(blocks)))
        subprocess.run([*command, '-I', include, str(source), '-o', str(program), library, '-lm'], check=True)
        environment = {**os.environ, 'LD_LIBRARY_PATH': str(pathlib.Path(library).parent)}
        done = subprocess.run([str(program)], text=True, capture_output=True, env=environment)
        print(done.stdout, end='')
        return abs(done.returncode)


def main(include, library, compiler, cpp_compiler=None):
    folder = pathlib.Path(include, 'sagitta')
    blocks, shown, faults = blocks_of(header for header in sorted(folder.glob('*.h'))
                                      if header.name != 'geo.h')  # which is in a library of its own
    declared = re.sub(r'/\*.*?\*/|//[^\n]*', '', (folder / 'surfaces.h').read_text(), flags=re.DOTALL)
    types = set(re.findall(r'\bsgt_\w+_ops\b', declared)) - {'sgt_surface_ops'}
    for name in sorted(types - set(re.findall(r'\w+', shown))):
        print(f'{name}: surfaces.h has no example with it')
        faults += 1
    faults += faults_when_run(blocks, 'examples.c', [*compiler.split(), *FLAGS], include, library)
    if cpp_compiler:
        in_cpp, _, empty = blocks_of([folder / 'sagitta.hpp'])
        blocks += in_cpp
        faults += empty + (not in_cpp)
        faults += faults_when_run(in_cpp, 'examples.cpp', [*cpp_compiler.split(), *FLAGS_CPP], include,
                                  library)
    print(f'{len(blocks)} examples, {len(types)} tables of operations, {faults} faults')
    return 1 if faults or not blocks or not types else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
