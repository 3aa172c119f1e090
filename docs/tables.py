# SPDX-License-Identifier: MIT
"""How a measured table gets onto its page, and what guards it there.

    python3 docs/NAME_table.py BUILD    runs what measures, and writes the tables of docs/data/NAME.md

This holds for each of the scripts; BUILD is a folder of meson in which their programs are built.  What a script
writes stands between two marks, with an empty line behind the first and before the second:

    <!-- table NAME 0123456789abcdef: from here -->
    <!-- table NAME: to here -->

The number is the beginning of the SHA-256 of the text between them.  The test `measured figures`
(tests/build/measured.py) works it out anew, so it notices a figure that was changed by hand.  The text begins with
the machine and the day.  What stands outside of the marks is written by hand: what the tables show, and what their columns mean.
"""
import datetime
import hashlib
import os
import pathlib
import re
import subprocess
import sys

DOCS = pathlib.Path(__file__).resolve().parent
DATA = DOCS / 'data'
BLOCK = re.compile(r'^<!-- table ([\w ]+?) ([0-9a-f]{16}): from here -->\n(.*?)^<!-- table \1: to here -->\n',
                   re.MULTILINE | re.DOTALL)


def checksum(text):
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def put(page, name, text):
    """Writes text over what is between the marks of that name."""
    whole, text = page.read_text(), f'\n{text.strip()}\n\n'
    found = [block for block in BLOCK.finditer(whole) if block[1] == name]
    if len(found) != 1:
        raise SystemExit(f'{page.name} has no marks of the table {name}, or several')
    (old,) = found
    new = f'<!-- table {name} {checksum(text)}: from here -->\n{text}<!-- table {name}: to here -->\n'
    page.write_text(whole[:old.start()] + new + whole[old.end():])


def write(name, build, text, block=None):
    """The tables of docs/data/NAME.md; block: the name of the marks, where the page has several pairs."""
    put(DATA / f'{name}.md', block or name, f'{machine(build)}\n\n{text}')


def machine(build):
    """On what the figures were made: processor, compiler, commit, day; and the further words of the command."""
    processors = pathlib.Path('/proc/cpuinfo')
    model = re.search(r'^model name\s*: (.*)$', processors.read_text() if processors.exists() else '', re.M)
    log = pathlib.Path(build) / 'meson-logs/meson-log.txt'
    compiler = re.search(r'^C compiler for the host machine: .*?\((\w+ [\d.]+)', log.read_text() if log.exists()
                         else '', re.M)
    commit = subprocess.run(['git', 'rev-parse', '--short=8', 'HEAD'], cwd=DOCS, capture_output=True, text=True)
    parts = [model[1] if model else 'an unknown processor', f'{os.cpu_count()} processors',
             f'load {os.getloadavg()[0]:.1f}', compiler[1] if compiler else None,
             f'commit {commit.stdout.strip()}' if commit.returncode == 0 else None,
             datetime.date.today().isoformat(),
             f"with `{' '.join(re.sub('.*/', '', word) for word in sys.argv[2:])}`" if sys.argv[2:] else None]
    return f'Made on {", ".join(part for part in parts if part)}.'


def run(*command, **environment):
    """What a program prints."""
    return subprocess.run([*map(str, command)], env={**os.environ, **environment}, stdout=subprocess.PIPE,
                          text=True, check=True).stdout.strip('\n')


def row(cells):
    return '| ' + ' | '.join(cell.replace('|', '\\|') for cell in cells) + ' |'


def table(head, rows):
    return '\n'.join([row(head), '|' + '---|' * len(head), *map(row, rows)])


def short(number):
    """A count in full, with commas; else three digits, whole numbers from 100 on, powers of ten from 1e6 on and
    below 1e-3."""
    if str(number).isdigit():
        return f'{int(number):,}'
    x = float(number)
    if x != x:
        return '-'
    if x and not 1e-3 <= abs(x) < 1e6:
        return re.sub(r'e([-+])0?', lambda e: 'e-' if e[1] == '-' else 'e', f'{x:.2g}')
    return f'{x:,.0f}' if abs(x) >= 100 else f'{x:.3g}'
