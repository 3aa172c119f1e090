#!/usr/bin/env python3
"""Each public header compiles alone, as C11 and as C++11, with every warning.

    python3 headers.py INCLUDE_FOLDER C_COMPILER [CPP_COMPILER]   (a compiler: its words, by spaces)
"""
import pathlib
import subprocess
import sys

WARNINGS = ['-Wall', '-Wextra', '-Wpedantic', '-Wshadow', '-Wundef', '-Werror']


def main(include, *compilers):
    tried, bad = 0, 0
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
