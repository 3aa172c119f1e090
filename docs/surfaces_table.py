#!/usr/bin/env python3
"""The measured tables of surfaces.md and accuracy.md: what the surfaces of the catalogue offer, how far off
they are, what they cost.

    python3 docs/surfaces_table.py build

runs build/tests/bench/bench_catalogue, and build/tests/catalogue/test_values with SCALE times its points, and
writes the tables over what is between the two marks of each page.
"""
import os
import pathlib
import re
import subprocess
import sys

SCALE = '20'
BEGIN, END = '<!-- docs/surfaces_table.py: from here -->\n', '<!-- to here -->\n'
WORST = re.compile(r'(\w+) +(\d+) points.*; F within (\S+) of its size and (\S+) of `rounding`.*gradient '
                   r'(\S+), second (\S+), by parameter (\S+)')
LONG = re.compile(r'(\S.*\S) +F within (\S+) of its size, the gradient within (\S+)')


def table(head, rows):
    lines = ''.join('| ' + ' | '.join(row) + ' |\n' for row in [head, ['---'] * len(head), *rows])
    return lines.replace('| --- ', '|---').replace('--- |', '---|')


def short(number):
    """Three digits, and no exponent."""
    if number in ('-', ''):
        return number
    return f'{float(number):.0f}' if float(number) >= 100 else f'{float(number):.3g}'


def of_which(surface):
    variant = surface['surface'][len(surface['type']) + 2:]
    return f' ({variant})' if variant else ''


def replaced(page, text):
    whole = page.read_text()
    before, rest = whole.split(BEGIN)
    page.write_text(before + BEGIN + '\n' + text + '\n' + END + rest.split(END)[1])


def run(program, **environment):
    return subprocess.run([program], env={**os.environ, **environment}, stdout=subprocess.PIPE, text=True,
                          check=True).stdout


def main(build):
    docs = pathlib.Path(__file__).parent
    values = run(f'{build}/tests/catalogue/test_values', SAGITTA_TEST_SCALE=SCALE)
    lines = run(f'{build}/tests/bench/bench_catalogue').splitlines()
    begin = next(i for i, line in enumerate(lines) if line.startswith('type;surface;'))
    surfaces = [dict(zip(lines[begin].split(';'), line.split(';'))) for line in lines[begin + 1:]]

    worst = {of[0]: of[1:] for of in WORST.findall(values)}
    long_sums = {}
    for name, f, gradient in LONG.findall(values):
        so_far = long_sums.get(name, (0, 0))
        long_sums[name] = max(so_far[0], float(f)), max(so_far[1], float(gradient))

    rows = []
    for kind in dict.fromkeys(s['type'] for s in surfaces if s['type'] in worst):
        points, f, of_rounding, gradient, second, by_parameter = worst[kind]
        of = [s for s in surfaces if s['type'] == kind]
        cost = [', '.join(short(s[column]) + of_which(s) for s in of) for column in ('first', 'one-first')]
        rows.append([f'`{kind}`', of[0]['offers'], f, of_rounding, gradient, second, by_parameter, *cost])
    text = table(['type', 'offers', 'F', 'of `rounding`', 'gradient', 'second', 'by parameter',
                  'ns a ray, in a batch', 'one ray, ns'], rows)
    text += '\n' + table(['a long sum', 'F', 'gradient'],
                         [[name, f'{f:.2g}', f'{gradient:.2g}'] for name, (f, gradient) in long_sums.items()])
    replaced(docs / 'surfaces.md', text)

    columns = ['met', 'evaluations', 'first', 'near', 'formula', 'times', 'one-first', 'one-near', 'boost']
    head = ['', 'met', 'evaluations', 'batch, first', 'batch, near', 'formula', 'times', 'one ray, first',
            'one ray, near', 'Boost']
    replaced(docs / 'accuracy.md', table(head, [[s['surface'], *[short(s[c]) for c in columns]]
                                                for s in surfaces]))


if __name__ == '__main__':
    main(*sys.argv[1:])
