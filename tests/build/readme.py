#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What README.md, tests/README.md and the pages of docs/ show is what the command says; their links lead somewhere.
No page of docs/ has more than 5,000 words but the tables of docs/data.

    python3 readme.py README PROGRAM...

In each block marked `console` a line `$ sagitta ...`, or of another program that is
given, is run in the folder of the README and what follows is compared with what it
prints: word by word, numbers to 1e-9.  A line `...` stands for any number of lines.
A block marked with a language and a name, `yaml lens.yaml`, is a file of that name,
for the commands of its page.
"""
import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

WORDS = 5000


def same(word, other):
    if word == other:
        return True
    try:
        a, b = float(word), float(other)
    except ValueError:
        return False
    return '.' in word and abs(a - b) <= 1e-9 * abs(a)


def same_line(line, other):
    a, b = line.split(), other.split()
    return len(a) == len(b) and all(map(same, a, b))


def matches(quoted, said, i=0, j=0):
    """Is said[j:] what quoted[i:] shows?  Both lists of lines."""
    while i < len(quoted) and quoted[i].strip() != '...':
        if j == len(said) or not same_line(quoted[i], said[j]):
            return False
        i, j = i + 1, j + 1
    if i >= len(quoted) - 1:
        return i < len(quoted) or j == len(said)
    return any(same_line(quoted[i + 1], said[k]) and matches(quoted, said, i + 1, k)
               for k in range(j, len(said)))


def anchor_of(heading):
    """What GitHub makes of a heading: `#...` in a link leads there."""
    return re.sub(r'[^\w\- ]', '', re.sub(r'\[(.*?)\]\(.*?\)', r'\1', heading).lower()).replace(' ', '-')


def sections(page):
    """{anchor: the text from its heading to the next of the same level or a higher one}"""
    text = re.sub(r'^```.*?^```', lambda block: re.sub('^#', ' #', block[0], flags=re.MULTILINE),
                  page.read_text(),
                  flags=re.MULTILINE | re.DOTALL)
    return {anchor_of(title): re.split(rf'^#{{1,{len(level)}}} ', rest, maxsplit=1, flags=re.MULTILINE)[0]
            for level, title, rest in ((m[1], m[2], text[m.end():])
                                       for m in re.finditer(r'^(#+) (.*)$', text, re.MULTILINE))}


def dead_links(folder, pages):
    """Links of the pages to files, pictures and headings that are not there."""
    for page in pages:
        # Not in blocks of code: [](int i) is a lambda.
        text = re.sub(r'^```.*?^```', '', page.read_text(), flags=re.MULTILINE | re.DOTALL)
        for link in re.findall(r'\]\(([^)\s]+)', text) + re.findall(r'\bsrc="([^"]+)"', text):
            if '://' in link:
                continue
            name, _, anchor = link.partition('#')
            there = page.parent / name if name else page
            if not there.exists() or anchor and anchor not in sections(there):
                yield f'{page.relative_to(folder)}: {link}'


def differing(page, programs, folder, somewhere):
    """Runs the commands of a page; (how many were compared, how many of them say something else)."""
    text = page.read_text()
    files = {name: block for name, block in re.findall(r'^```\w+ (\S+)\n(.*?)^```', text,
                                                       re.MULTILINE | re.DOTALL)}
    for name, block in files.items():
        (somewhere / name).write_text(block)
    compared, bad = 0, 0
    for block in re.findall(r'^```console\n(.*?)^```', text, re.MULTILINE | re.DOTALL):
        joined = block.replace('\\\n', ' ')
        for command, quoted in re.findall(r'^\$ (.*)\n((?:(?!\$ ).*\n)*)', joined, re.MULTILINE):
            words = shlex.split(command)
            if words[0] not in programs:
                continue
            words = [str(somewhere / word) if word in files else word for word in words]
            # A picture is drawn, and not where the page says.
            for i, word in enumerate(words[:-1]):
                if word in ('--output', '--picture'):
                    words[i + 1] = str(somewhere / ('out' + pathlib.Path(words[i + 1]).suffix))
            said = subprocess.run([programs[words[0]]] + words[1:], text=True, capture_output=True,
                                  cwd=folder)
            compared += 1
            lines = (said.stdout + said.stderr).splitlines()
            if not matches(quoted.splitlines(), lines):
                bad += 1
                print(f'$ {command}\n{page.relative_to(folder)} says:\n{quoted}\nthe command says:', *lines,
                      sep='\n')
    return compared, bad


def main(readme, *programs):
    folder = pathlib.Path(readme).resolve().parent
    # What fontconfig keeps of a picture is no leak of the command (tests/tool/command.py).
    os.environ['LSAN_OPTIONS'] = f'suppressions={folder / "tests/tool/leaks.supp"}:print_suppressions=0'
    os.environ.setdefault('ASAN_OPTIONS', 'intercept_tls_get_addr=0')
    pages = [*sorted(folder.glob('*.md')), folder / 'tests/README.md', *sorted((folder / 'docs').rglob('*.md'))]
    programs = {pathlib.Path(program).name: str(pathlib.Path(program).resolve()) for program in programs}
    with tempfile.TemporaryDirectory() as somewhere:
        found = {page: differing(page, programs, folder, pathlib.Path(somewhere)) for page in pages}
    bad = sum(b for _, b in found.values())
    dead = list(dead_links(folder, pages))
    dead += [f'{page.relative_to(folder)}: {len(page.read_text().split())} words, {WORDS} at most' for page in pages
             if 'docs' in page.parts and 'data' not in page.parts and len(page.read_text().split()) > WORDS]
    for page, (compared, _) in found.items():
        if compared:
            print(f'{page.relative_to(folder)}: {compared} commands compared')
    print(*dead, f'{len(pages)} pages, {bad} commands differ; {len(dead)} dead links or long pages', sep='\n')
    return 1 if bad or dead or not found[folder / 'README.md'][0] else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
