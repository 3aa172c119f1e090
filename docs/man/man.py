#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Manual pages, made from what is there already, so that they cannot differ from it.

    python3 man.py command SAGITTA NAME OUT    sagitta(1), or sagitta-NAME(1): `sagitta NAME --help all`
    python3 man.py header FILE OUT             a page of section 3: a public header, its functions under NAME
    python3 man.py file FILE.md... OUT         sagitta-lens(5): pages of docs, one behind the other, by lowdown
    python3 man.py page FILE.in OUT            a page that is there: its version and its day

Of the environment SAGITTA_VERSION stands in the footer, and the day of SOURCE_DATE_EPOCH; today, if it is not set.
"""
import os
import pathlib
import re
import subprocess
import sys
import textwrap
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import help as helps  # noqa: E402

BOOK = 'sagitta'


def date():
    return time.strftime('%Y-%m-%d', time.gmtime(int(os.environ.get('SOURCE_DATE_EPOCH') or time.time())))


def escaped(text):
    """As roff prints it: a leading point or quote is no request, a hyphen of an option no dash."""
    text = text.replace('\\', '\\e').replace('-', '\\-').replace('`', '\\(ga').replace("'", '\\(aq').replace('^', '\\(ha')
    text = text.replace('~', '\\(ti').replace('"', '\\(dq')
    return '\n'.join(('\\&' + line if line.startswith('.') else line) for line in text.split('\n'))


def title(name, section, what):
    version = os.environ.get('SAGITTA_VERSION', '')
    return [f'.TH {name.upper()} {section} {date()} "{BOOK} {version}" "{what}"']


def flowing(text):
    """A paragraph: each sentence begins a line, and no line is long."""
    sentences = re.split(r'(?<=[.!?:])  +', ' '.join(text.split('\n')))
    return escaped('\n'.join(textwrap.fill(s, 72, break_long_words=False, break_on_hyphens=False) for s in sentences))


def literal(lines):
    return ['.PP', '.nf', *(escaped(line) for line in lines), '.fi']


def section(s):
    short, *more = re.split(r' *[,.(;] *', s.title, maxsplit=1)
    out = [f'.SH {escaped(short).upper()}'] + ([flowing(s.title)] if more else [])
    for item in s.items:
        out += ['.TP', f'.B {escaped(item.tag)}', flowing(item.text) or '\\&']
    return out + (literal(s.lines)[0 if more else 1:] if s.lines else [])


def of_command(program, name):
    brief = dict(helps.commands(program))[name]
    h = helps.read(program, name)
    out = title(f'sagitta-{name}', 1, 'User commands')
    out += ['.SH NAME', f'sagitta\\-{name} \\- {escaped(brief)}', '.SH SYNOPSIS', f'.B {escaped(" ".join(h.usage.split()))}']
    out += ['.SH DESCRIPTION', flowing(h.paragraphs[0]) if h.paragraphs else '']
    for paragraph in h.paragraphs[1:]:
        out += ['.PP', flowing(paragraph)]
    for s in h.sections:
        if isinstance(s, str):
            out += ['.PP', flowing(s)]
        elif s.title == 'More':
            out += ['.SH SEE ALSO', '.BR sagitta (1),', '.BR sagitta\\-lens (5)', '.PP', flowing(' '.join(
                [item.tag + ' ' + item.text for item in s.items] + [line.strip() for line in s.lines]))]
        else:
            out += section(s)
    return out


def of_all(program):
    text = helps.text_of(program, '--help').rstrip('\n').split('\n\n')
    brief = text[0].split(': ', 1)[1]
    out = title('sagitta', 1, 'User commands')
    out += ['.SH NAME', f'sagitta \\- {escaped(brief)}', '.SH SYNOPSIS', '.B sagitta', '.I command', '[options]',
            '.SH DESCRIPTION', 'sagitta finds where rays meet surfaces, sends them through lenses, and says of each '
            'answer how sure it is.', '.SH COMMANDS']
    for name, what in helps.commands(program):
        out += ['.TP', f'.BR sagitta\\-{name} (1)', escaped(what)]
    out += ['.SH EXAMPLES', *literal([line.strip() for line in text[-1].split('\n')[1:]])[1:]]
    out += ['.SH ENVIRONMENT', '.TP', '.B SAGITTA_GLASS', 'a file or folder of glasses, in place of those that ship', '.TP',
            '.B OMP_NUM_THREADS', 'in how many threads to work, where \\-\\-threads does not say']
    return out + ['.SH SEE ALSO', '.BR sagitta\\-lens (5)']


def of_header(path):
    text = path.read_text()
    head = re.search(r'/\*(?:\n \*)? \w+\.h(?:pp)? - (.*?)[.:]?(?= \*/|\n \*\n|\.  |:\n)', text, re.S)
    functions = list(dict.fromkeys(re.findall(r'\b(sgt_\w+)\(', re.sub(r'/\*.*?\*/', '', text, flags=re.S))))
    functions = [f for f in functions if re.search(rf'(SGT_API[^;]*|static inline[^;{{]*)\b{f}\(', text)]
    body = [line for line in text.split('\n') if not re.match(r'// SPDX|#(ifndef|define) SAGITTA_\w+_H$|#endif$|#ifdef __cplus'
                                                              r'|extern "C"|}$', line)]
    name = f'sagitta_{path.stem}' if path.stem != 'sagitta' else 'sagitta.h'
    out = title(name, 3, 'Library functions')
    names = ',\n'.join([escaped(name), *map(escaped, functions)])
    what = textwrap.fill(re.sub(r'[\s*]+', ' ', head[1]), 72)
    out += ['.SH NAME', f'{names}', f'\\- {escaped(what)}', '.SH SYNOPSIS', f'.B #include <sagitta/{path.name}>']
    return out + ['.SH DESCRIPTION', *literal(body)[1:], '.SH SEE ALSO', '.BR sagitta (1)']


def of_pages(first, *more):
    # A page that goes on from the first begins with its title and says so: its sections are taken.
    text = '\n'.join([first.read_text(), *(re.sub(r'.*?(?=^## )', '', page.read_text(), count=1, flags=re.S | re.M) for page in more)])
    text = re.sub(r'<!--.*?-->\n?', '', text, flags=re.S)
    made = subprocess.run(['lowdown', '-s', '-tman', '--nroff-nolinks', '-M', 'title=SAGITTA-LENS', '-M', 'section=5', '-M', f'date={date()}', '-'],
                          input=text, capture_output=True, text=True, check=True).stdout
    lines, kept = [], False  # kept: a line is a line
    made = re.sub(r'^(\.S[HS])\n(.*)\n\.[LP]P$', r'\1 \2', made, flags=re.M)  # a title in its line, no paragraph behind
    for line in made.replace('\\fC', '\\fB').split('\n'):  # mandoc knows no font C
        kept = line in ('.nf', '.EX') or (kept and line not in ('.fi', '.EE'))
        lines += [line] if kept or line.startswith('.') else textwrap.wrap(line, 78, break_long_words=False) or ['']
    at = next(i for i, line in enumerate(lines) if line.startswith('.SH'))
    return [line for line in lines[:at] if not line.startswith('.TH')] + [
        f'.TH SAGITTA-LENS 5 {date()} "{BOOK} {os.environ.get("SAGITTA_VERSION", "")}" "File formats"', '.SH NAME',
        'sagitta\\-lens \\- the lens file of sagitta', *lines[at:]]


def main(what, *words):
    *words, out = words
    if what == 'command':
        program, name = words
        lines = of_all(program) if name == 'sagitta' else of_command(program, name)
    elif what == 'page':
        version = os.environ.get('SAGITTA_VERSION', '')
        lines = [pathlib.Path(words[0]).read_text().replace('@DATE@', date()).replace('@VERSION@', version)]
    elif what == 'header':
        lines = of_header(pathlib.Path(words[0]))
    else:
        lines = of_pages(*map(pathlib.Path, words))
    pathlib.Path(out).write_text('\n'.join(lines).rstrip('\n') + '\n')


if __name__ == '__main__':
    main(*sys.argv[1:])
