#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The documentation as a site, by Sphinx: the pages of docs/, and a page for each header.

    python3 docs/site/website.py TREE OUT       makes OUT/index.html
    python3 docs/site/website.py --test TREE    makes it in a folder that is deleted, and follows its links
    python3 docs/site/website.py --names TREE   says which public names have no contract or no example; needs no Sphinx

A header's page has each declaration with the comment above it, which is its contract, and the first use of its
name: in examples/, in a block of code of docs/, or else in tests/.  What is not a page and is linked to comes along
as a file.  Nothing is loaded from the network: the search is Sphinx' own.
"""
import html.parser
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import urllib.parse

HERE = pathlib.Path(__file__).resolve().parent
SKIPPED = 77
# Pages of the tree beside those of docs/.
PAGES = ['README.md', 'CONTRIBUTING.md', 'SECURITY.md', 'tests/README.md', 'tests/data/**/*.md', 'src/**/*.md', 'examples/**/*.md']
USES = [('examples/**/*.c', 0), ('docs/*.md', 1), ('docs/notes/*.md', 1), ('examples/**/*.cpp', 0), ('tests/**/*.c', 0),
        ('tests/**/*.cpp', 0), ('include/sagitta/*.h', 0), ('src/tool/**/*.c', 0), ('src/**/*.[ch]', 0), ('python/*.c', 0)]
NAME = re.compile(r'\b(?:sgt|SGT)_\w*[A-Za-z0-9]\b')
TOKEN = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:[^"\\\n]|\\.)*"|^[ \t]*#(?:[^\n]*\\\n)*[^\n]*|[{}()\[\];]|\n|[^\S\n]+|[^\s{}()\[\];/"#]+|.',
                   re.DOTALL | re.MULTILINE)


# ------------------------------------------------------------------- headers


def declarations(text):
    """[(kind, comment, code)] of a header, in order.  kind: 'section', a title; 'text', a comment by itself; 'code'."""
    out, comment, code, depth, blank = [], None, '', 0, 0

    def end():
        nonlocal code, comment
        if code.strip():
            out.append(('code', comment, code.strip('\n')))
        code = ''

    for token in TOKEN.findall(text):
        outside = depth == 0 and not code.strip()
        if token.startswith('/*') and outside:
            said = words_of(token)
            if comment is not None and comment[1] == 0:  # of no declaration: what the file or the section is about
                out.append(('text', None, comment[0]))
            section = re.match(r'/\* -{8,}', token)
            if section:
                out.append(('section', None, said.strip('- ')))
            comment = None if section else [said, 0]
        elif token.startswith('//') and outside:
            pass
        elif re.match(r'[ \t]*#', token) and outside:
            macro = re.match(r'\s*#define (SGT_\w+)', token)
            if macro and not re.search(r'_H$', macro[1]):
                out.append(('code', comment, token))
                if comment:
                    comment[1] += 1
        else:
            code += token
            depth += token in ('{', '(', '[')
            depth -= token in ('}', ')', ']')
            if code.strip() in ('extern "C" {', '}'):
                code, depth = '', 0
            elif depth == 0 and (token == ';' or token == '}' and is_function(code)):
                if comment:
                    comment[1] += 1
                end()
    return out


def is_function(code):
    return not re.match(r'\s*(typedef|struct|enum|union)\b', code) and '=' not in code.split('{')[0]


def words_of(comment):
    lines = [re.sub(r'^ ?\* ?', '', line) for line in comment[2:-2].strip(' \n*').split('\n')]
    return '\n'.join(line.rstrip() for line in lines).strip('\n')


def names_of(code):
    """What a declaration declares, first what it is called."""
    macro = re.match(r'\s*#define (SGT_\w+)', code)
    if macro:
        return [macro[1]]
    bare = re.sub(r'/\*.*?\*/', ' ', code, flags=re.S)
    if re.match(r'\s*(typedef\s+)?(struct|enum|union)\b[^;()]*\{', bare):
        last = re.search(r'\}\s*(sgt_\w+)\s*;', bare) or re.match(r'\s*(?:typedef\s+)?\w+\s+(sgt_\w+)', bare)
        inner = re.findall(r'\b(SGT_\w+)\s*(?=[,=}]|$)', bare, re.M) if re.match(r'\s*(typedef\s+)?enum', bare) else []
        return ([last[1]] if last else []) + inner
    found = re.search(r'\b(sgt_\w+)\s*(?:\(|\[|=|;|,)', bare)
    return [found[1]] if found else []


def code_of(path, fenced):
    text = path.read_text(errors='replace')
    if not fenced:
        return text
    return '\n\n'.join(re.findall(r'^```(?:c|cpp)\b[^\n]*\n(.*?)^```', text, re.MULTILINE | re.DOTALL))


def examples(tree, names):
    """{name: (file, lines)}: the first use of each, outside of comments and of its own declaration."""
    wanted, found = set(names), {}
    for pattern, fenced in USES:
        for path in sorted(tree.glob(pattern)):
            if not wanted:
                return found
            text = code_of(path, fenced)
            bare = re.sub(r'/\*.*?\*/|//[^\n]*', lambda c: re.sub(r'[^\n]', ' ', c[0]), text, flags=re.S)
            lines, shown = bare.split('\n'), text.split('\n')
            for i, line in enumerate(lines):
                for name in wanted.intersection(NAME.findall(line)):
                    if re.match(r'\s*#define ' + name + r'\b|SGT_API\b.*\b' + name + r'\(|\} ' + name + ';', line):
                        continue
                    if path.suffix == '.h' and line.startswith(('SGT_API', 'typedef')) and name + '(' in line:
                        continue
                    found[name] = (path.relative_to(tree), [s for s in shown[max(0, i - 1):i + 3] if s.strip()])
                    wanted.discard(name)
    return found


def headers(tree):
    return sorted((tree / 'include/sagitta').glob('*.h'))


def fence(language, text):
    return f'```{language}\n{text}\n```\n'


def page_of(header, tree, uses):
    parts = declarations(header.read_text())
    out, last = [f'# {header.name}\n', f'`#include <sagitta/{header.name}>`\n'], None
    for kind, comment, code in parts:
        if kind == 'section':
            out.append(f'## {code}\n')
        elif kind == 'text':
            out.append(fence('text', code))
        else:
            names = names_of(code)
            if not names or re.fullmatch(r'\s*(typedef\s+)?struct \w+( \w+)?;', code):
                continue
            out.append(f'### {names[0].replace("_", chr(92) + "_")}\n')
            if comment:
                out.append(f'As of the declaration before it.\n' if comment is last else fence('text', comment[0]))
            last = comment
            out.append(fence('c', code))
            use = next((uses[n] for n in names if n in uses), None)
            if use:
                to = os.path.relpath(tree / use[0], tree / 'docs/headers')
                out.append(f'For example, in [{use[0]}]({to}):\n\n' + fence('c', '\n'.join(use[1])))
    return '\n'.join(out)


def all_names(tree):
    """{name: (header, has a contract)}"""
    found = {}
    for header in headers(tree):
        for kind, comment, code in declarations(header.read_text()):
            if kind == 'code' and not re.fullmatch(r'\s*(typedef\s+)?struct \w+( \w+)?;', code):
                for name in names_of(code)[:1]:
                    found[name] = header.name, comment is not None or '/*' in code
    return found


def lacking(tree):
    """What has no contract, no example, or is exported and on no page."""
    names = all_names(tree)
    uses = examples(tree, names)
    exported = re.findall(r'^\s+(sgt_\w+);', (tree / 'src/sagitta.map').read_text(), re.M)
    for name, (header, said) in sorted(names.items()):
        if not said:
            yield f'{header}: {name} has no contract'
        if name not in uses:
            yield f'{header}: {name} has no example'
    yield from (f'{name} goes out, and no header was seen to declare it' for name in exported if name not in names)
    if len(names) < 400:
        yield f'only {len(names)} names'


# ----------------------------------------------------------------- the source


def linked(text, page, tree):
    """The page's links as Sphinx takes them: a header's to its page, a folder's to its README or to nothing."""
    def one(found):
        words, target = found[1], found[2]
        name, _, anchor = target.partition('#')
        if '://' in target or not name:
            return found[0]
        there = (tree / page.parent / name).resolve()
        if there.name == 'NEWS.md':  # longer than a page may be: a file
            return f'[{words}]({name[:-2]}txt)'
        if there.suffix == '.h' and there.parent.name == 'sagitta' and 'include' in there.parts:
            to = tree / 'docs/headers' / (there.stem + '.md')
            return f'[{words}]({os.path.relpath(to, tree / page.parent)})'
        if there.is_dir():
            if (there / 'README.md').exists():
                return f'[{words}]({name.rstrip("/")}/README.md)'
            return words
        return found[0]
    blocks = re.split(r'(^```.*?^```)', text, flags=re.MULTILINE | re.DOTALL)
    return ''.join(b if b.startswith('```') else re.sub(r'(?<!!)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)', one, b)
                   for b in blocks)


def write_source(tree, into):
    pages = sorted({*tree.glob('docs/*.md'), *tree.glob('docs/notes/*.md'), *tree.glob('docs/data/*.md'),
                    *(p for pattern in PAGES for p in tree.glob(pattern))})
    for page in pages:
        relative = page.relative_to(tree)
        (into / relative).parent.mkdir(parents=True, exist_ok=True)
        text = page.read_text()
        (into / relative).write_text(linked(text, relative, tree))
        for link in re.findall(r'\]\(([^)\s#]+)', text) + re.findall(r'\bsrc="([^"]+)"', text):
            there = (page.parent / link).resolve()
            if '://' not in link and there.is_file() and (there.suffix != '.md' or there.name == 'NEWS.md'):
                copy = into / there.relative_to(tree)
                copy = copy.with_suffix('.txt') if there.name == 'NEWS.md' else copy
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(there, copy)
    names = all_names(tree)
    uses = examples(tree, names)
    (into / 'docs/headers').mkdir()
    for header in headers(tree):
        (into / 'docs/headers' / (header.stem + '.md')).write_text(page_of(header, tree, uses))
    for file, _ in uses.values():
        if file.suffix != '.md':
            (into / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(tree / file, into / file)
    (into / 'docs/headers/names.md').write_text('# Every public name\n\n' + ''.join(
        f'- [{name}]({pathlib.Path(header).stem}.md#{name.lower()})\n' for name, (header, _) in sorted(names.items())))
    rest = [p.relative_to(tree).with_suffix('').as_posix() for p in pages]
    first = ['docs/' + n for n in ('tour', 'concepts', 'lens_file', 'lens_file_surfaces', 'lens_file_phases', 'import', 'rays',
                                   'analysis', 'tolerance', 'prove', 'glass', 'render', 'scale')]
    code = ['docs/' + n for n in ('api', 'api_lens', 'api_surface', 'api_rules', 'python', 'cpp', 'cmake', 'surfaces',
                                  'add_a_surface', 'formula', 'optimise', 'line_of_sight')]
    named = ['docs/headers/names'] + ['docs/headers/' + h.stem for h in headers(tree)]
    others = [r for r in rest if r not in first + code + ['README']]

    def toc(title, names):
        joined = '\n'.join(names)
        return f'```{{toctree}}\n:caption: {title}\n:maxdepth: 1\n:hidden:\n\n{joined}\n```\n'
    (into / 'index.md').write_text(
        linked((tree / 'README.md').read_text(), pathlib.Path('README.md'), tree) + '\n' +
        toc('Use it', first) + toc('Program with it', code) + toc('Headers', named) +
        toc('Behind it', [r for r in others if r.startswith('docs/')]) +
        toc('Work on it', [r for r in others if not r.startswith('docs/')]))
    (into / 'README.md').unlink()
    for page in into.rglob('*.md'):  # the first page is index
        text = page.read_text()
        page.write_text(re.sub(r'\]\(((?:\.\./)*)README\.md(#[\w-]+)?\)', lambda m: found_index(m, page, into), text))
    shutil.copy(HERE / 'conf.py', into / 'conf.py')
    (into / 'style').mkdir()
    (into / 'style/site.css').write_text((HERE / 'site.css').read_text() + dark_code())


def found_index(found, page, into):
    there = (page.parent / (found[1] + 'README.md')).resolve()
    return f']({found[1]}index.md{found[2] or ""})' if there.parent == into.resolve() else found[0]


def dark_code():
    from pygments.formatters import HtmlFormatter
    return ('\n@media (prefers-color-scheme: dark) {\n' +
            HtmlFormatter(style='monokai').get_style_defs('.highlight') + '\n}\n')


def make(tree, out):
    """The number of faults."""
    with tempfile.TemporaryDirectory() as folder:
        source = pathlib.Path(folder) / 'source'
        source.mkdir()
        write_source(tree, source)
        version = re.search(r"version: '([\d.]+)'", (tree / 'meson.build').read_text())[1]
        done = subprocess.run([sys.executable, '-m', 'sphinx', '-q', '-b', 'html', '-d', folder + '/doctrees', '-D',
                               f'version={version}', '-D', f'release={version}', str(source), str(out)],
                              text=True, capture_output=True)
    said = [line.replace(str(source), '') for line in done.stderr.splitlines() if line.strip()]
    print(*said, sep='\n', end='\n' if said else '')
    return len(said) if done.returncode == 0 else max(1, len(said))


# ------------------------------------------------------------------- the links


class Page(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.links, self.ids = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for key, value in attributes:
            if key == 'id' or key == 'name' and tag == 'a':
                self.ids.add(value)
            elif key in ('href', 'src') and value:
                self.links.append(value)


def dead(site):
    """Links of the site that lead nowhere, or out into the network for what the page needs."""
    pages = {path.resolve(): Page(path.read_text()) for path in site.rglob('*.html')}
    for path, page in sorted(pages.items()):
        for link in page.links:
            if re.match(r'[a-z]+:', link):
                if re.search(r'\.(js|css|woff2?)$', link):
                    yield f'{path.relative_to(site.resolve())}: {link} is not here'
                continue
            name, _, anchor = link.partition('#')
            there = (path.parent / urllib.parse.unquote(name.split('?')[0])).resolve() if name else path
            if not there.exists():
                yield f'{path.relative_to(site.resolve())}: {link}'
            elif anchor and there in pages and urllib.parse.unquote(anchor) not in pages[there].ids:
                yield f'{path.relative_to(site.resolve())}: {link}: no such place'


def has_sphinx():
    try:
        import myst_parser  # noqa: F401
        import sphinx  # noqa: F401
    except ImportError as error:
        print(f'skipped: no site is made: {error}.  On Debian: apt install python3-sphinx python3-myst-parser')
        return False
    return True


def main(*words):
    if len(words) == 2 and words[0] == '--names':
        faults = list(lacking(pathlib.Path(words[1]).resolve()))
        print(*faults, f'{len(all_names(pathlib.Path(words[1]).resolve()))} names, {len(faults)} faults', sep='\n')
        return 1 if faults else 0
    if len(words) == 2 and words[0] == '--test':
        if not has_sphinx():
            return SKIPPED
        with tempfile.TemporaryDirectory() as folder:
            faults = make(pathlib.Path(words[1]).resolve(), pathlib.Path(folder))
            links = list(dead(pathlib.Path(folder)))
            pages = len(list(pathlib.Path(folder).rglob('*.html')))
        print(*links, f'{pages} pages, {faults} warnings, {len(links)} dead links', sep='\n')
        return 1 if faults or links or pages < 80 else 0
    if len(words) != 2:
        sys.exit(__doc__)
    if not has_sphinx():
        return 0
    faults = make(pathlib.Path(words[0]).resolve(), pathlib.Path(words[1]).resolve())
    print(f'{pathlib.Path(words[1]).resolve()}/index.html' + (f', {faults} warnings' if faults else ''))
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
