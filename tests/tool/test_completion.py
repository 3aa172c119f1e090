#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What bash, zsh and fish make of a line of sagitta that is not yet whole, and the table that they ask for.

    python3 test_completion.py SAGITTA

Each shell that is on the machine is started in a terminal.  A beginning is typed, then Tab, then what shows what the
line has become.  The table, `sagitta COMMAND --help options`, is held against `--help all`.
"""
import os
import pathlib
import pty
import re
import select
import shutil
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from command import *  # noqa: E402

SCRIPTS = HERE.parent.parent / 'src' / 'tool' / 'completion'
LENSES = HERE.parent.parent / 'examples' / 'lenses'
SHELLS = {
    'bash': (['--norc', '--noprofile', '-i'], [f'source {SCRIPTS}/sagitta.bash', 'PS1=ready:']),
    'zsh': (['-f', '-i'], [f'fpath=({SCRIPTS} $fpath)', 'autoload -U compinit', 'compinit -u -D', 'PS1=ready:']),
    'fish': (['--no-config', '-i'], [f'source {SCRIPTS}/sagitta.fish',
                                     'function fish_prompt; echo -n ready:; end']),
}
# What is typed, and what the line is then.
LINES = [('sagitta spo', 'sagitta spot '), ('sagitta illu', 'sagitta illumination '),
         ('sagitta spot --hexa', 'sagitta spot --hexapolar '), ('sagitta spot --proof esti', 'sagitta spot --proof estimate '),
         ('sagitta trace x --format np', 'sagitta trace x --format npy '),
         ('sagitta edit --scal', 'sagitta edit --scale '),
         ('sagitta spot x --columns geo', 'sagitta spot x --columns geometric'),
         ('sagitta trace x --columns opl,fat', 'sagitta trace x --columns opl,fate'),
         (f'sagitta trace {LENSES}/cooke_tr', f'sagitta trace {LENSES}/cooke_triplet.yaml ')]


class Terminal:
    def __init__(self, shell, arguments):
        self.pid, self.file = pty.fork()
        if self.pid == 0:
            environment = {**os.environ, 'PATH': f'{pathlib.Path(SAGITTA).parent}:{os.environ["PATH"]}', 'TERM': 'dumb',
                           'COLUMNS': '300', 'LINES': '40', 'HISTFILE': '', 'HOME': '/nonexistent'}
            os.execve(shell, [shell, *arguments], environment)

    def read(self, until, seconds=20.0):
        """What comes, up to a word or for as long as something comes."""
        out, end = '', time.monotonic() + seconds
        while time.monotonic() < end and not re.search(until, out):
            if select.select([self.file], [], [], 0.1)[0]:
                try:
                    out += os.read(self.file, 65536).decode(errors='replace')
                except OSError:  # the shell has ended
                    break
        return out

    def write(self, text):
        os.write(self.file, text.encode())

    def close(self):
        os.close(self.file)
        os.kill(self.pid, 9)
        os.waitpid(self.pid, 0)


def completed(shell, line):
    """The line after Tab, as an echo of the shell shows it."""
    arguments, commands = SHELLS[shell]
    terminal = Terminal(shutil.which(shell), arguments)
    try:
        for command in commands:
            terminal.write(command + '\n')
        terminal.read('ready:')
        terminal.write(f'{line}\t')
        time.sleep(0.35)
        # quotes at both ends of the line, by ^A and ^E, and echo in front: then it is only printed
        terminal.write("\x01echo '<<\x05>>'\n")
        out = terminal.read('\n<<.*>>')
        found = re.findall(r'^<<(.*)>>', out.replace('\r', '').replace('\n\n', '\n'), re.M)
        assert found, (shell, line, out[-600:])
        return found[-1]
    finally:
        terminal.close()


def test_lines():
    shells = [shell for shell in SHELLS if shutil.which(shell)]
    faults = []
    for shell in shells:
        for typed, wanted in LINES:
            got = completed(shell, typed)
            if got.rstrip() != wanted.rstrip():
                faults.append(f'{shell}: {typed!r} became {got!r}, not {wanted!r}')
    assert not faults, '\n'.join(faults)
    print(f'{len(LINES)} lines each in {", ".join(shells)}')


def test_types_of_surfaces():
    """With the quotes and braces that a surface is written in, whether they were begun or not."""
    for begun in ('toru', "'toru", "'{type: toru", '"{type: toru'):
        # (The echo of `completed` takes single quotes away.)
        double = '"' if begun[0] == '"' else ''
        equal(completed('bash', f'sagitta intersect --surface {begun}').rstrip(),
              f'sagitta intersect --surface {double}{{type: torus}}{double}', begun)


def test_the_table():
    """Its options are those of --help all, and what it says of each is the first line there."""
    names = [line.split('\t')[0] for line in run('--help', 'options').stdout.splitlines()]
    equal(names, re.findall(r'^  sagitta ([a-z]+) +\S', run('--help').stdout.split('\n\n')[1], re.M))
    for name in names:
        rows = [line.split('\t') for line in run(name, '--help', 'options').stdout.splitlines()]
        assert all(len(row) == 4 and all(row) for row in rows), (name, rows)
        shown = re.findall(r'^  (--[a-z-]+)', run(name, '--help', 'all').stdout, re.M)
        equal(sorted(row[0] for row in rows), sorted(shown), name)
        for option, value, words, _ in rows:
            assert (value == '-') <= (words == '-'), (name, option)


def test_columns():
    """The names that are offered are those that --help all explains; of a lens file's analysis, with their views."""
    for name in ('intersect', 'trace', 'spot', 'opd', 'prove', 'sweep'):
        [words] = [line.split('\t')[2] for line in run(name, '--help', 'options').stdout.splitlines() if line.startswith('--columns')]
        told = set()
        for part in re.findall(r'^Columns[^\n]*\n(.*?)\n(?:\n|[A-Z])', run(name, '--help', 'all').stdout, re.M | re.S):
            for names in re.findall(r'^  (\S(?:[^ ]| (?! ))*)  ', part, re.M):
                told |= {word for word in names.split(', ') if not word.startswith('...')}
        equal(set(words.split()), told, name)


if __name__ == '__main__':
    main(globals())
