#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Random rays of `sagitta opd` and `sagitta fan` against the oracle at 50 digits.

    python3 analysis_random.py SAGITTA [LENS ...]        status 77, skipped, without mpmath and PyYAML

6 rays of each field and wavelength, through the lenses of the oracle and 20 of conics that are drawn here: an
object near or far, an image in glass or air, aimed in each way.  SAGITTA_TEST_SEED (1) draws others, and
SAGITTA_TEST_SCALE (0.5) multiplies how many rays and lenses.  Half of the rays are near the chief ray, where
paths differ least.  What is told of a ray may be off by no more than the error that is told; for each lens
the largest part of that error is printed.
"""
import csv
import io
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
try:
    import yaml  # noqa: F401
    from analysis_oracle import Beam, Fails, lenses, mpf, read_yaml
except ImportError as missing:
    print(f'skipped: {missing}')
    sys.exit(77)

SEED = int(os.environ.get('SAGITTA_TEST_SEED', '1'), 0)
SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
os.environ['SAGITTA_GLASS'] = str(HERE.parents[1] / 'data' / 'glass')


def random_points(draw):
    """Options that send rays through points of the pupil."""
    out = []
    for i in range(max(1, round(6 * SCALE))):
        r = 10 ** draw.uniform(-3, 0) if i % 2 else math.sqrt(draw.random())
        angle = draw.uniform(0, 2 * math.pi)
        out += ['--pupil', f'{r * math.cos(angle)!r} {r * math.sin(angle)!r}']
    return out


def random_lens(draw):
    """Up to five conics, weak enough that rays get through, and a plane."""
    u, size, count = draw.uniform, 10 ** draw.uniform(-1, 3), draw.randint(1, 5)
    stop, rows = draw.randrange(count), []
    for i in range(count):
        last = i == count - 1
        rows.append({'type': 'conic', 'radius': draw.choice((-1, 1)) * size * u(1.2, 8),
                     'conic': draw.choice((0, u(-2, 0.5))), 'stop': i == stop,
                     'thickness': size * (u(1, 6) if last else u(0.05, 0.6)),
                     'index': draw.choice((1, 1, 1, 1.45) if last else (1, u(1.4, 1.9), 1.333))})
    field = u(0.2, 6)
    return {'units': 'mm', 'wavelengths': [u(0.4, 1)], 'pupil': {'semi_diameter': size * u(0.05, 0.3)},
            'object': {'distance': draw.choice((math.inf, size * u(2, 10)))},
            'aim': draw.choice(('pupil', 'stop', 'real_stop')), 'fields': [0, field, [field / 2, -field / 3]],
            'surfaces': [*rows, {'type': 'plane'}]}


def told(command, path, points):
    done = subprocess.run([sys.argv[1], command, path, '--no-apertures', *points, '--format', 'csv'],
                          capture_output=True, text=True, check=True)
    return list(csv.DictReader(io.StringIO(done.stdout))), 'exit pupil is at infinity or not known' in done.stderr


class Beams(dict):
    """The beam of a field, from 1, and the place of a wavelength."""

    def __init__(self, lens):
        super().__init__()
        self.lens = lens

    def __missing__(self, at):
        field, wave = at
        self[at] = Beam(self.lens, self.lens.fields[field - 1], wave)
        return self[at]


def parts(path, lens, points):
    """Of each ray, how much of the error that is told is used, and what ray it is."""
    beams = Beams(lens)
    (paths, without_pupil), (fans, _) = (told(command, path, points) for command in ('opd', 'fan'))
    for row, fan in zip(paths, fans):
        field, wave = int(row['field']), lens.wavelengths.index(float(row['wavelength']))
        what = f"field {field}, {row['wavelength']}, {row['px']} {row['py']}"
        try:
            end = beams[field, wave].end(*(mpf(float(row[k])) for k in ('px', 'py')))
        except Fails as why:
            if row['fate'] == 'passed':
                raise AssertionError(f"{path.name}, {what}: the command's ray passes, the oracle's: {why}")
            continue
        opd = beams[field, wave].opd(end, 'foot' if without_pupil else 'sphere')
        chief = beams[field, lens.primary].chief()[0]
        for got, wanted, error in ((row['opd'], opd, row['opd_err']),
                                   (fan['ex'], end[0][0] - chief[0], fan['e_err']),
                                   (fan['ey'], end[0][1] - chief[1], fan['e_err'])):
            off = abs(mpf(float(got)) - wanted)
            yield (float(off / mpf(float(error))) if off else 0.0), f'{what}: {got}, off by {float(off):.3g}'


def check(path, lens, draw):
    part, what = max(parts(path, lens, random_points(draw)))
    good = part <= 1
    print(f'{path.name}: {part:.3f} of the error told{"" if good else ": FAILED, " + what}', flush=True)
    if not good and path.name.startswith('random'):
        print(path.read_text())
    return good


def main(names):
    print(f'seed {SEED}')
    draw, good = random.Random(SEED), True
    for name, (read, path) in lenses().items():
        if not names or name in names:
            good &= check(path, read(path), draw)
    with tempfile.TemporaryDirectory() as folder:
        for i in range(0 if names else max(1, round(10 * SCALE))):
            path = pathlib.Path(folder, f'random_{i}.yaml')
            path.write_text(yaml.safe_dump(random_lens(draw)))
            good &= check(path, read_yaml(path), draw)
    sys.exit(not good)


main(sys.argv[2:])
