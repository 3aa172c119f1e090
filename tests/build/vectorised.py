#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Loops that are meant to become vector code have: the instructions of the library are counted.

Meant are the kernels (SGT_KERNEL of src/num/exact.h): loops over rays or cells.  A loop that has become
vector code is in the library several times: in the widest registers, in narrower ones (v3), and up to three
times ray by ray, for the last few rays and for arrays that might overlap (of a short loop the last rays are
written out one by one, three for v3 and seven for v4).  A loop that has not become vector code is there once, ray by ray.

(A kernel that v4 shares with v3, src/meson.build, is there once.)  So in each kernel for x86-64-v3 and v4, the packed operations in the widest registers (ymm, zmm) must be at
least a quarter of the scalar ones for v3 and an eighth for v4 (a tenth, if those are below 64).  The scalar ones include what is worked
out once for all rays.  In the kernels that do most of the work, certain operations must be packed.

    python3 vectorised.py LIBRARY...      their names tell the set: libsagitta_v3.a, libsagitta_v3_small.a
"""
import collections
import re
import subprocess
import sys

# Packed operations, in the widest registers, for one that is scalar.  The last rays of a loop of eight lanes
# are written out, up to seven times: of a loop of nine operations that is 64 scalar ones.
LEAST, LEAST_SHORT, SHORT = {'v3': 0.25, 'v4': 0.125}, 0.1, 72
# Functions (a pattern; at least one must be there) and what must occur packed in each.
NEEDED = {
    r'conic_lanes_(first|near)\w*': {'sqrt', 'div', 'fma'},
    r'conic_lanes_plane(?!_leave)\w*': {'div', 'fma'},
    r'asphere_lanes(?!_\w*_bound)\w*': {'div', 'fma'},
    r'(look|meet)_\w*(julia|mandelbrot)': {'mul', 'add', 'cmp'},
    r'(march_all|meetings_(step|certify|take))': {'mul', 'div', 'cmp'},
    r'newton_step\w*': {'mul', 'sub', 'cmp'},
    r'bend_all': {'sqrt', 'div', 'mul'},
}
WIDE = {'v3': {'ymm'}, 'v4': {'ymm', 'zmm'}}
OPERATION = re.compile(r'\tv?(add|sub|mul|div|sqrt|min|max|cmp\w*?|u?comi|fn?m(?:add|sub)\d*)(pd|sd)\s+(.*)')
START = re.compile(r'^[0-9a-f]+ <([A-Za-z_]\w*?)(?:_v[34])?(?:\.[\w.]*)?>:$')
SECTION = '.text.sgt_kernels'


def count(kind, lines, found):
    """Into found {function: {kind: Counter of (operation, width)}}; width is xmm, ymm, zmm or scalar."""
    now, kernels = None, False
    for line in lines:
        if line.startswith('Disassembly of section'):
            kernels, now = line.startswith(f'Disassembly of section {SECTION}'), None
        elif line.endswith('>:'):
            start = START.match(line)
            now = found[start[1]][kind] if kernels and start else None
        elif now is not None:
            said = OPERATION.search(line)
            if said:
                operation = 'fma' if said[1].startswith('f') else 'cmp' if 'c' in said[1] else said[1]
                widths = re.findall(r'%([xyz]mm)', said[3])
                width = 'scalar' if said[2] == 'sd' else max(widths, default='xmm')
                now[operation, width] += 1


def faults_of(found):
    for name, kinds in sorted(found.items()):
        if 'v3' not in kinds:
            yield f'{name}: for x86-64-v4 and not for v3'
        for kind, counts in sorted(kinds.items()):
            by = collections.Counter()
            for (_, width), n in counts.items():
                by[width] += n
            packed = max(by[width] for width in WIDE[kind])
            print(f'{name}, {kind}:', ', '.join(f'{by[w]} {w}' for w in ('zmm', 'ymm', 'xmm', 'scalar')))
            if packed < (LEAST[kind] if by['scalar'] >= SHORT else LEAST_SHORT) * by['scalar']:
                yield f'{name}, {kind}: {packed} packed operations beside {by["scalar"]} scalar ones'
            for pattern, operations in NEEDED.items():
                if re.fullmatch(pattern, name):
                    there = {operation for operation, width in counts if width in WIDE[kind]}
                    yield from (f'{name}, {kind}: no packed {o}' for o in sorted(operations - there))
    for pattern in NEEDED:
        if not any(re.fullmatch(pattern, name) and set(kinds) == set(WIDE) for name, kinds in found.items()):
            yield f'{pattern}: no such kernel'


def main(*libraries):
    found = collections.defaultdict(lambda: collections.defaultdict(collections.Counter))
    for kind, library in [(kind, library) for kind in WIDE for library in libraries if f'_{kind}' in library]:
        try:
            listing = subprocess.run(['objdump', '-d', '--no-show-raw-insn', library], text=True, check=True,
                                     capture_output=True).stdout
        except FileNotFoundError:
            print('skipped: there is no objdump')
            return 77
        count(kind, listing.splitlines(), found)
    faults = list(faults_of(found))
    print('\n'.join(faults + [f'{len(found)} kernels, {len(faults)} faults']))
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main(*sys.argv[1:]))
