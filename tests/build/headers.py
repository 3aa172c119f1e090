#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Each public header compiles alone, as C11 and as C++11, with every warning.

sagitta.hpp as C++17 and C++20, with and without exceptions; and it has every operation of sgt_surface_ops.
What a user of it gets wrong does not compile, and the compiler is made to say why.

    python3 headers.py INCLUDE_FOLDER C_COMPILER [CPP_COMPILER]   (a compiler: its words, by spaces)
"""
import pathlib
import re
import subprocess
import sys

WARNINGS = ['-Wall', '-Wextra', '-Wpedantic', '-Wshadow', '-Wundef', '-Werror']


F = '[](sgt_vec3 p) { return p.z; }'
WRONG = [  # (the words of the program, what the compiler has to say; '': it compiles)
    (f'auto s = sagitta::surface({F}); sagitta::intersect(s, {{}});', ''),
    (f'sagitta::intersect(sagitta::surface({F}), {{}});', 'deleted'),
    (f'auto s = sagitta::surface({F}).name("s"); sgt_surface c = std::move(s);', 'deleted'),
    ('auto s = sagitta::surface([](double x, double, double) { return x; }); sgt_surface c = s;',
     'F has to be double f(sgt_vec3 p)'),
    (f'auto s = sagitta::surface({F}).gradient([](sgt_vec3) {{ return 1.0; }});',
     'the gradient has to be sgt_vec3 f(sgt_vec3 p)'),
    (f'auto s = sagitta::surface({F}).span([](sgt_vec3) {{ return sgt_span(); }});',
     'a lambda has other arguments'),
    (f'auto s = sagitta::surface({F}).span([](sgt_ray) {{ return 1.0; }});', 'or another result'),
    (f'int n = 0; auto s = sagitta::surface({F}).rounding([n](sgt_vec3) mutable {{ return n++; }});',
     'or it is mutable'),
    (f'auto s = sagitta::surface({F}).gradient([](sgt_vec3 p) {{ return p; }})'
     '.gradient([](sgt_vec3 p) { return p; });', 'this operation is given twice'),
    ('auto s = sagitta::surface([](sgt_vec3, sgt_vec3 *) { return 1.0; })'
     '.gradient([](sgt_vec3 p) { return p; });', 'value gives the gradient already'),
    ('sgt_options o{}; sagitta::watch(o, [](const sgt_step &) { return false; });', 'deleted'),
]


def accepted_or_not_told(include, compiler):
    faults = []
    for program, words in WRONG:
        for standard in ('-std=c++17', '-std=c++14') if not words else ('-std=c++17',):
            text = '#include <sagitta/sagitta.hpp>\nint main() { ' + program + ' }\n'
            command = compiler.split() + ['-x', 'c++', standard, '-I', include, '-fsyntax-only', '-']
            run = subprocess.run(command, input=text, text=True, capture_output=True)
            wanted = words if standard == '-std=c++17' else 'sagitta.hpp is C++17'
            if bool(run.returncode) != bool(wanted) or wanted not in run.stderr:
                faults.append(f'{program}  {standard}\nshould be told: {wanted}\n{run.stderr}')
    return faults


def without_lambda(include):
    """Operations of sagitta.h for which sagitta.hpp makes no function of a lambda."""
    ops = re.search(r'typedef struct sgt_surface_ops \{(.*?)^\} sgt_surface_ops;',
                    pathlib.Path(include, 'sagitta', 'sagitta.h').read_text(), re.DOTALL | re.MULTILINE)[1]
    names = re.findall(r'\(\*(\w+)\)\(const void \*self', ops)
    text = pathlib.Path(include, 'sagitta', 'sagitta.hpp').read_text()
    return names, [name for name in names if name != 'value' and
                   not (f'offer<of::{name}>(table_.{name});' in text and f' auto {name}(F f) const' in text)]


def main(include, *compilers):
    tried, bad = 0, 0
    names, missing = without_lambda(include)
    if missing or len(names) < 13:
        bad += 1
        print(f'of {len(names)} operations sagitta.hpp lacks: {" ".join(missing)}')
    if compilers[1:]:
        faults = accepted_or_not_told(include, compilers[1])
        bad += len(faults)
        print(*faults, f'{len(WRONG)} programs, {len(faults)} treated wrongly', sep='\n')
    standards = ['-std=c++17', '-std=c++20', '-std=c++17 -fno-exceptions -fno-rtti'] if compilers[1:] else []
    for standard in standards:
        command = compilers[1].split() + ['-x', 'c++', *standard.split()] + WARNINGS + [
            '-Wconversion', '-I', include, '-fsyntax-only', '-']
        text = '#include <sagitta/sagitta.hpp>\n' * 2
        run = subprocess.run(command, input=text, text=True, capture_output=True)
        tried += 1
        if run.returncode or run.stderr:
            bad += 1
            print(' '.join(command), run.stderr, sep='\n')
    for header in sorted(pathlib.Path(include, 'sagitta').glob('*.h')):
        # Twice: a second inclusion must be none.
        text = f'#include <sagitta/{header.name}>\n' * 2 + 'typedef int not_empty;\n'
        for compiler, language in zip(compilers, (['-x', 'c', '-std=c11', '-Wstrict-prototypes'],
                                                  ['-x', 'c++', '-std=c++11'])):
            command = compiler.split() + language + WARNINGS + ['-I', include, '-fsyntax-only', '-']
            run = subprocess.run(command, input=text, text=True, capture_output=True)
            tried += 1
            if run.returncode or run.stderr:
                bad += 1
                print(' '.join(command), run.stderr, sep='\n')
    print(f'{tried} compilations of public headers, {bad} with complaints')
    return 1 if bad or not tried else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
