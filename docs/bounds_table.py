#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The table of data/bounds.md: proven bounds beside the worst of a million rays (docs/tables.py has the convention).

    python3 docs/bounds_table.py BUILD [LENS...]    with lenses: prints their rows, and writes nothing
"""
import csv
import io
import os
import pathlib
import resource
import subprocess
import sys

import tables

ROOT = pathlib.Path(__file__).resolve().parents[1]
RINGS = 577                     # 1 + 3 * 577 * 578 rays
# Tilted, freeform, or without an axis of symmetry.
ASKEW = ('newtonian', 'toroidal_lens', 'figured_mirror', 'simple_fold_mirror', 'lj1598l1')
HEAD = ['lens', 'field', 'boxes', 's', 'passes %', 'undecided %', 'spot', 'pv', 'rms', 'rms of path']


def lenses():
    return [*sorted((ROOT / 'examples').glob('*/*.yaml')), *sorted((ROOT / 'tests/data/zmx').glob('*.zmx'))]


def ask(build, *command):
    done = subprocess.run([f'{build}/src/tool/sagitta', *map(str, command), '--threads', '1', '--aim', 'paraxial', '--format',
                           'csv'], capture_output=True, text=True, env={**os.environ,
                                                                        'SAGITTA_GLASS': str(ROOT / 'data/glass')})
    return [{k.removesuffix('_mrad'): v for k, v in r.items()} for r in csv.DictReader(io.StringIO(done.stdout))]


def seconds():
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


def value(row, name):
    return float(row[name]) if row.get(name) else float('nan')


def ratio(bound, seen, least):
    """The bound itself where less is seen than `least`: that is rounding."""
    return '' if not bound >= 0 or not seen >= 0 else f'{bound / seen:.4f}' if seen > least else f'bound {bound:.1e}'


def known(least, most, of):
    return f'{(most - least) / most:.0e}' if most > of and least >= 0 else ''


def rows_of(build, path):
    name = path.stem.split('__')[1] if '__' in path.stem else path.stem
    field, rows = 0, []
    while True:
        field, before = field + 1, seconds()
        proven = ask(build, 'prove', path, '--fields', field)
        if not proven:
            return rows
        spent, p = seconds() - before, proven[0]
        same = lambda r: r['wavelength'] == p['wavelength']
        rays = ['--fields', field, '--hexapolar', RINGS]
        spot = next(filter(same, ask(build, 'spot', path, *rays)), {})
        front = next(filter(same, ask(build, 'opd', path, '--summary', *rays)), {})
        rows.append([name + (' *' if any(word in name for word in ASKEW) else ''), str(field), p['boxes'], f'{spent:.1f}',
                     f"{value(p, 'passes'):.4g}", f"{value(p, 'undecided'):.2g}",
                     ratio(value(p, 'spot'), value(spot, 'geometric'), 1e-6), ratio(value(p, 'pv'), value(front, 'pv'), 1e-4),
                     known(value(p, 'rms_least'), value(p, 'rms'), 1e-6), known(value(p, 'opd_rms_least'), value(p, 'opd_rms'), 1e-4)])
        print('|', ' | '.join(rows[-1]), '|', flush=True)


def main(build, *names):
    rows = [row for path in ([pathlib.Path(n).resolve() for n in names] or lenses()) for row in rows_of(build, path)]
    if not names:
        tables.write('bounds', build, tables.table(HEAD, rows))


if __name__ == '__main__':
    main(*sys.argv[1:])
