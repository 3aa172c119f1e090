# SPDX-License-Identifier: MIT
"""What `sagitta COMMAND --help all` says, as data: the source of the manual pages.

The help is written from the tables of options of the command, so what is made of it cannot differ from them.
A SECTION is a line without indent, with indented lines below.  Its items have a tag in columns 2 to 19 and a
text from column 21 on, or from column 5 where the tag is a number; a longer tag has a line of its own.  Lines of
text alone go on with the item above.  A section without such items is kept line by line.  All else is a paragraph.
"""
import dataclasses
import re
import subprocess

TEXT = 21


@dataclasses.dataclass
class Item:
    tag: str
    text: str


@dataclasses.dataclass
class Section:
    title: str
    items: list
    lines: list  # where there are no items


@dataclasses.dataclass
class Help:
    name: str
    usage: str
    paragraphs: list  # in front of the first section
    sections: list    # of Section and, between them, of text


def text_of(program, *arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True, timeout=60)
    if done.returncode != 0:
        raise SystemExit(f'{program} {" ".join(arguments)}: {done.stderr}')
    return done.stdout


def commands(program):
    """Each command with the words that `sagitta --help` has for it."""
    return [line.split('\t') for line in text_of(program, '--help', 'options').splitlines()]


def items_of(lines, firsts):
    """The items of a section; None: it has none.  firsts: the line of each option that is a text by itself."""
    items = []
    for line, below in zip(lines, [*lines[1:], '']):
        number = re.match(r'^  (\d)  (\S.*)$', line)
        tagged = re.match(r'^  \S', line) and not re.match(r'^  sagitta ', line)
        short = len(line) < TEXT or (line[TEXT - 1] == ' ' and line[TEXT:TEXT + 1] != ' ')
        if number:
            items.append(Item(number[1], number[2]))
        elif tagged and short:
            items.append(Item(line[2:TEXT - 1].strip(), line[TEXT:].strip()))
        elif tagged and below.startswith(' ' * TEXT):
            items.append(Item(line.strip(), ''))
        elif items and line.startswith(' ' * TEXT):
            last, more = items[-1], line.strip()
            first = re.sub(' +', ' ', last.text)
            ended = first and first == firsts.get(last.tag.split()[0]) and first[-1] not in '.:;,'
            last.text = (last.text + ('.  ' if ended else ' ') + more).strip()
        elif items and line.startswith('and '):  # behind the last one
            items[-1].text += '; ' + line
        else:
            return None
    return items


def read(program, name):
    blocks, paragraphs, sections = text_of(program, name, '--help', 'all').rstrip('\n').split('\n\n'), [], []
    usage = blocks.pop(0).splitlines()
    rows = [row.split('\t') for row in text_of(program, name, '--help', 'options').splitlines()]
    firsts = {row[0]: re.sub(' +', ' ', row[3]) for row in rows}
    for block in blocks:
        lines = block.split('\n')
        below = next((i for i, line in enumerate(lines) if line.startswith(' ')), len(lines))
        head, rest = ' '.join(lines[:below]), lines[below:]
        if rest and below == 1:
            items = items_of(rest, firsts)
            sections.append(Section(head, items or [], [] if items else rest))
        elif sections:
            sections.append(block)
        else:
            paragraphs.append(block)
    return Help(name, '\n'.join(usage), paragraphs, sections)
