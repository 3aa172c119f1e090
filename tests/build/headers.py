#!/usr/bin/env python3
"""Each public header compiles alone, as C11 and as C++11, with every warning.

sagitta.hpp as C++17 and C++20, with and without exceptions; and it has every operation of sgt_surface_ops.

    python3 headers.py INCLUDE_FOLDER C_COMPILER [CPP_COMPILER]   (a compiler: its words, by spaces)
"""
import pathlib
import re
import subprocess
import sys

WARNINGS = ['-Wall', '-Wextra', '-Wpedantic', '-Wshadow', '-Wundef', '-Werror']


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
