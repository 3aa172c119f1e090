#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tables of the types in surfaces.md, from the list src/types.def; the specimens in it, for tests/tool.

    python3 docs/surfaces_types.py            writes them between their marks
    python3 docs/surfaces_types.py --check    says whether they are as the list is
"""
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
BEGIN, END = '<!-- docs/surfaces_types.py, {}: from here -->\n', '<!-- to here -->\n'
TABLES = {  # heading of the formula, kinds
    'sags': ('z = s(x, y)', ['CONIC', 'ASPHERE']),
    'departures': ('z = s(x, y), or P of conic + P', ['DEPARTURE']),
    'bodies': ('F = 0', ['QUADRIC', 'BODY']),
    'level sets': ('orbit', ['LEVEL_SET']),
}
NO_KEYS_OF_DERIVATIVES = re.compile('curvature$|conic$|semi_diameter|norm|step')
SLICE = ['at', 'slice', 'ex', 'ey', 'ez', 'escape', 'iterations', 'power']
MEMBERS = {'curvature': 'c', 'conic': 'k'}
BASES = {'BASE': ['curvature', 'conic', 'semi_diameter'], 'CURVATURE': ['curvature'], 'RIM': ['semi_diameter'], 'SLICE': SLICE}


def arguments(text):
    """The arguments of a call, text being behind its bracket."""
    found, depth, start, quoted = [], 0, 0, False
    for i, c in enumerate(text):
        quoted ^= c == '"'
        if quoted:
            continue
        if depth == 0 and c in ',)':
            found.append(' '.join(text[start:i].split()))
            start = i + 1
            if c == ')':
                return found
        depth += (c in '({[') - (c in ')}]')
    raise ValueError(text)


def parameters(text):
    """(key, most, member) of each; most: of a list or a table, as it is said."""
    found = []
    for one in arguments(text[1:]):
        macro, rest = one.split('(', 1)
        own = arguments(rest)
        if macro in BASES:
            found += [(key, '', MEMBERS.get(key, key)) for key in BASES[macro]]
        else:
            most = {'REALS': ', up to {}', 'LIST': ', up to {}', 'TERMS': ', up to {}', 'TABLE': ', up to {0} x {0}'}.get(macro, '')
            words = own[6].strip('"') if 'SGT_PARAM_WORD' in own else ''
            at = next(i for i, a in enumerate(own) if a.startswith('"'))
            found.append((own[at].strip('"'), most.format(own[3]) if most else f' ({words.replace("|", ", ")})' if words else '', own[at + 1]))
    return found


def formula_of(text, keys):
    kind, inside = text.split('(', 1)
    if kind == 'SAYS':
        return inside[1:-2]
    own = [key for key, _, _ in keys if not NO_KEYS_OF_DERIVATIVES.match(key)]
    inside = re.sub(r'p\[(\d+)\]', lambda m: own[int(m[1])], inside[:-1])
    inside = re.sub(r'T\(([\d.]+?)(?:\.0)?\)', r'\1', inside).replace('square_root', 'sqrt').replace('s.', '')
    return 'P = ' + inside


def lens_value(text):
    """A C initialiser as a lens file has it."""
    if text.startswith('ROWS('):
        rows, columns, *x = arguments(text[5:])
        table = [x[i:i + int(columns)] for i in range(0, len(x), int(columns))]
        return '[' + ', '.join(x if rows == '1' else ['[' + ', '.join(row) + ']' for row in table]) + ']'
    return text.replace('{', '[').replace('}', ']').replace('SGT_', '').lower()


def specimens():
    """{type: its specimen as a lens file has it}, but of a sum, whose terms are surfaces themselves."""
    found = {}
    for text in rows_of_list():
        _, type, _, _, _, _, specimen, listed, _ = arguments(text)
        members = dict(one[1:].split(' = ', 1) for one in arguments(specimen[1:]))
        if 'terms' not in members:
            found[type] = ', '.join(f'{key}: {lens_value(members[of])}' for key, _, of in parameters(listed) if of in members)
    return found


def rows_of_list():
    return re.split(r'^TYPE\(', (HERE.parent / 'src/types.def').read_text(), flags=re.M)[1:]


def rows():
    for text in rows_of_list():
        kind, type, name, file, formula, where, _, listed, _ = arguments(text)
        keys = parameters(listed)
        said = ', '.join(f'`{key}`{most}' for key, most, _ in keys).replace('`curvature`', '`radius` or `curvature`')
        yield kind, [f'`{type}`', formula_of(formula, keys), said, where.strip('"'), f'`sgt_{name}`',
                     f'[{file}](../src/surface/{file})']


def table(head, kinds):
    lines = [['type', head, 'keys of a lens file', 'defined', 'struct', 'file'], ['---'] * 6]
    lines += [[cell.replace('|', '\\|') for cell in row] for kind, row in rows() if kind in kinds]
    return ''.join('| ' + ' | '.join(line) + ' |\n' for line in lines).replace('| --- ', '|---').replace('--- |', '---|')


def main(*arguments):
    page = HERE / 'surfaces.md'
    now = page.read_text()
    new = now
    for name, (head, kinds) in TABLES.items():
        before, rest = new.split(BEGIN.format(name))
        new = before + BEGIN.format(name) + '\n' + table(head, kinds) + '\n' + END + rest.split(END, 1)[1]
    if arguments == ('--check',):
        print('as types.def is' if new == now else 'docs/surfaces.md is not as src/types.def: python3 docs/surfaces_types.py')
        return new != now
    page.write_text(new)
    return 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
