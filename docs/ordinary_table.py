#!/usr/bin/env python3
"""The measured tables of *Ordinary input* in accuracy.md.

    python3 docs/ordinary_table.py build

runs build/tests/bench/bench_ordinary, first for its tables and then for the fifty random sags, and writes
both over what is between the two marks of the page.  Further words are passed on to the program (--quick).
"""
import pathlib
import subprocess
import sys

BEGIN, END = '<!-- docs/ordinary_table.py: from here -->\n', '<!-- docs/ordinary_table.py: to here -->\n'


def run(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout.strip('\n')


def main(build, *words):
    program = f'{build}/tests/bench/bench_ordinary'
    tables, drawn = run(program, *words), run(program, '--drawn', *words)
    page = pathlib.Path(__file__).parent / 'accuracy.md'
    before, rest = page.read_text().split(BEGIN)
    page.write_text(f'{before}{BEGIN}\n{tables}\n\n### Fifty random '
                    f'sags\n\n{drawn}\n\n{END}{rest.split(END)[1]}')


if __name__ == '__main__':
    main(*sys.argv[1:])
