#!/usr/bin/env python3
"""What README.md shows is what the command says, and what it links to is there.

    python3 readme.py README PROGRAM...

In each block marked `console` a line `$ sagitta ...`, or of another program that is
given, is run in the folder of the README and what follows is compared with what it
prints: word by word, numbers to 1e-9.  A line `...` stands for any number of lines.
"""
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile


def same(word, other):
    if word == other:
        return True
    try:
        a, b = float(word), float(other)
    except ValueError:
        return False
    return '.' in word and abs(a - b) <= 1e-9 * max(1, abs(a))


def same_line(line, other):
    a, b = line.split(), other.split()
    return len(a) == len(b) and all(map(same, a, b))


def matches(quoted, said):
    """Is `said` what `quoted` shows?  Both lists of lines."""
    if not quoted:
        return not said
    if quoted[0].strip() == '...':
        return any(matches(quoted[1:], said[skip:]) for skip in range(len(said) + 1))
    return bool(said) and same_line(quoted[0], said[0]) and matches(quoted[1:], said[1:])


def dead_links(folder):
    """Links of README.md and docs/ to files that are not there."""
    for page in [folder / 'README.md', *sorted((folder / 'docs').glob('*.md'))]:
        for link in re.findall(r'\]\(([^)\s#]+)', page.read_text()):
            if '://' not in link and not (page.parent / link).exists():
                yield f'{page.relative_to(folder)}: {link}'


def main(readme, *programs):
    text = pathlib.Path(readme).read_text()
    programs = {pathlib.Path(program).name: str(pathlib.Path(program).resolve()) for program in programs}
    compared, bad = 0, 0
    with tempfile.TemporaryDirectory() as somewhere:
        for block in re.findall(r'^```console\n(.*?)^```', text, re.MULTILINE | re.DOTALL):
            joined = block.replace('\\\n', ' ')
            for command, quoted in re.findall(r'^\$ (.*)\n((?:(?!\$ ).*\n)*)', joined, re.MULTILINE):
                words = shlex.split(command)
                if words[0] not in programs:
                    continue
                # A picture is drawn, and not where the README says.
                for i, word in enumerate(words[:-1]):
                    if word in ('--svg', '--output', '--picture'):
                        words[i + 1] = str(pathlib.Path(somewhere, 'out' + pathlib.Path(words[i + 1]).suffix))
                said = subprocess.run([programs[words[0]]] + words[1:], text=True, capture_output=True,
                                      cwd=pathlib.Path(readme).resolve().parent)
                compared += 1
                lines = (said.stdout + said.stderr).splitlines()
                if not matches(quoted.splitlines(), lines):
                    bad += 1
                    print(f'$ {command}\nthe README says:\n{quoted}\nthe command says:', *lines, sep='\n')
    dead = list(dead_links(pathlib.Path(readme).resolve().parent))
    print(*dead, f'{compared} commands compared, {bad} differ; {len(dead)} dead links', sep='\n')
    return 1 if bad or dead or not compared else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
