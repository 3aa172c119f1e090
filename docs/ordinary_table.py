#!/usr/bin/env python3
"""The measured tables of *Ordinary input* in accuracy.md.

    python3 docs/ordinary_table.py build
    python3 docs/ordinary_table.py build --search [SECONDS [SEED]]

runs build/tests/bench/bench_ordinary, first for its tables and then for the fifty random sags, and writes
both over what is between the two marks of the page.  Further words are passed on to the program (--quick).
The second writes what the search for cliffs finds in SECONDS (1200) over what is between two others.
"""
import pathlib
import subprocess
import sys

BEGIN, END = '<!-- docs/ordinary_table.py: from here -->\n', '<!-- docs/ordinary_table.py: to here -->\n'
SEARCH = ('<!-- docs/ordinary_table.py --search: from here -->\n',
          '<!-- docs/ordinary_table.py --search: to here -->\n')
PAGE = pathlib.Path(__file__).parent / 'accuracy.md'


def run(*command):
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout.strip('\n')


def put(text, begin, end):
    before, rest = PAGE.read_text().split(begin)
    PAGE.write_text(f'{before}{begin}\n{text}\n\n{end}{rest.split(end)[1]}')


def main(build, *words):
    program = f'{build}/tests/bench/bench_ordinary'
    if words[:1] == ('--search',):
        seconds, seed = (*words[1:], *('1200', '1')[len(words) - 1:])
        put(run(program, '--search', '--brief', '--seconds', seconds, '--seed', seed), *SEARCH)
        return
    tables, drawn = run(program, *words), run(program, '--drawn', *words)
    put(f'{tables}\n\n### Fifty random sags\n\n{drawn}', BEGIN, END)


if __name__ == '__main__':
    main(*sys.argv[1:])
