#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What hostile files cost: the table of data/hostile.md (docs/tables.py has the convention).

    python3 docs/hostile_table.py build [--size MB]

Files of that size (8) are made, each to be as dear as its kind can be, and the command is asked once about each.  An end
by a signal, or a status that is neither 0 nor that of an error, stops the script.  The command is started by a small
process that was there before the files: what a child has used at most begins with what its parent has.
"""
import argparse
import json
import pathlib
import struct
import subprocess
import sys
import tempfile
import time

import tables

STARTER = '''
import json, os, sys
for line in sys.stdin:
    words, files = json.loads(line)
    child = os.fork()
    if not child:
        for number, file in enumerate(files, 1):
            os.dup2(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
        os.execv(words[0], words)
    _, status, usage = os.wait4(child, 0)
    print(json.dumps([os.waitstatus_to_exitcode(status), usage.ru_maxrss]), flush=True)
'''
HEAD = 'pupil: {semi_diameter: 1}\nsurfaces:\n'
SURFACE = '  - {type: sphere, radius: 50, thickness: 0.001, index: 1.5}\n'
ZMX = 'VERS 140124 258 36214\nMODE SEQ\nUNIT MM\nENPD 10\nSURF 0\n  TYPE STANDARD\n  DISZ INFINITY\n'
WAVES = 'sin(1e6*x*y)*sin(1e6*z*x)*cos(1e5*(x + y + z)) - 1e-9'
NEARLY = '1e-20*sin(1e5*x)^2 + ((y - 0.1)^2 + (z - 0.2)^2)^2'


def ten_of(name):
    return '[' + ', '.join([f'*{name}'] * 10) + ']'


def surface(f):
    return f'{{type: formula, f: "{f}", inside: {{ball: 1}}}}'


def shape_of(rows):
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows}, 6), }}"
    head += ' ' * (-(11 + len(head)) % 64) + '\n'
    return b'\x93NUMPY\x01\x00' + struct.pack('<H', len(head)) + head.encode() + bytes(4800)


def cases(size):
    """Rows of the table: what the file is, its name, its text, what is asked of it."""
    aliases = 'name: &a0 x\n' + ''.join(f'k{i}: &a{i} {ten_of(f"a{i - 1}")}\n' for i in range(1, 40))
    ray = ('intersect', '--ray', '-3 0.1 0.2 1 0 0', '--surface')
    rays = ('--surface', '{type: sphere, radius: 10}', '--format', 'csv', '--rays')
    term, row = 'x + ', '0,0,-5,0,0,1\n'
    return [
        ('a lens of as many surfaces as there is room for', 'a.yaml', HEAD + SURFACE * (size // len(SURFACE)), ('info',)),
        ('as many keys that mean nothing', 'a.yaml', ''.join(f'k{i}: 1\n' for i in range(size // 11)), ('info',)),
        ('lists in lists', 'a.yaml', 'name: ' + '[' * size, ('info',)),
        ('forty levels of aliases, ten to a level', 'a.yaml', aliases + HEAD + SURFACE, ('info',)),
        ('as many anchors', 'a.yaml', ''.join(f'k{i}: &n{i} 1\n' for i in range(size // 20)) + HEAD + SURFACE, ('info',)),
        ('one text', 'a.yaml', 'name: "' + 'x' * size + '"\n' + HEAD + SURFACE, ('info',)),
        ('one number', 'a.yaml', 'pupil: {semi_diameter: 1' + '0' * size + '}\nsurfaces:\n' + SURFACE, ('info',)),
        ('bytes that are no text', 'a.yaml', '\0\1\2' * (size // 3), ('info',)),
        ('a sum as a formula', 'a.yaml', HEAD + '  - {type: formula, sag: "' + term * (size // len(term)) + 'x"}\n', ('info',)),
        ('brackets as a formula', 'a.yaml', HEAD + '  - {type: formula, sag: "' + '(' * size + '"}\n', ('info',)),
        ('a lens of .zmx of as many surfaces', 'a.zmx', ZMX + ''.join(
            f'SURF {i}\n  TYPE STANDARD\n  CURV 0.01\n  DISZ 1\n' for i in range(1, size // 47)), ('info',)),
        ('one line of .zmx', 'a.zmx', 'VERS 140124\n' + 'x' * size, ('info',)),
        ('records of .zmx that nothing reads', 'a.zmx', ZMX + '  ZZZZ 1 2 3\n' * (size // 13), ('info',)),
        ('rays as csv', 'a.csv', 'ox,oy,oz,dx,dy,dz\n' + row * (size // len(row)), ('intersect', *rays)),
        ('rays as csv, one field too few in the last row', 'a.csv',
         'ox,oy,oz,dx,dy,dz\n' + row * (size // len(row)) + '0,0,-5,0,0\n', ('intersect', *rays)),
        ('an array that says it has 10^15 rows', 'a.npy', shape_of(10 ** 15), ('intersect', *rays)),
        ('a formula of a million waves', None, surface(WAVES), ray),
        ('a formula that is nearly 0 all along the ray', None, surface(NEARLY), ray),
        ('the same, asked for a proof', None, surface(NEARLY), ('intersect', '--proof', 'first', *ray[1:])),
    ]


def asked(program, starter, folder, name, text, words):
    """Seconds, MiB, whether it was read, and the last line of what it says."""
    last = text
    if name:
        last = folder / name
        last.write_bytes(text if isinstance(text, bytes) else text.encode())
    out = [folder / 'out', folder / 'err']
    begin = time.perf_counter()
    print(json.dumps([[str(program), *words, str(last)], list(map(str, out))]), file=starter.stdin, flush=True)
    status, memory = json.loads(starter.stdout.readline())
    seconds = time.perf_counter() - begin
    said = [file.read_text(errors='replace').replace(f'{folder}/', '').strip().split('\n')[-1] for file in out]
    if not 0 <= status <= 3:
        raise SystemExit(f'{words} {name}: status {status}: {said[1]}')
    answer = said[1].removeprefix('sagitta: ') if status > 1 else 'read' if name else said[0]
    return seconds, memory / 1024, answer[:90]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('build', type=pathlib.Path)
    parser.add_argument('--size', type=int, default=8)
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder, subprocess.Popen(
            [sys.executable, '-c', STARTER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as starter:
        for what, name, text, words in cases(options.size << 20):
            seconds, memory, answer = asked((options.build / 'src/tool/sagitta').resolve(), starter, pathlib.Path(folder), name,
                                            text, words)
            kind = name.split('.')[1] if name else 'surface'
            rows.append([what, kind, f'{len(text) / 1e6:.2g}', f'{seconds:.2g}', f'{memory:.0f}', answer])
        starter.stdin.close()
    tables.write('hostile', options.build, tables.table(
        ['what it is', 'kind', 'MB', 'seconds', 'most memory, MiB', 'what the command says'], rows))


if __name__ == '__main__':
    main()
