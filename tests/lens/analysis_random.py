#!/usr/bin/env python3
"""Random rays of `sagitta opd` and `sagitta fan` against the oracle at 50 digits.

    python3 analysis_random.py SAGITTA [LENS ...]        status 77, skipped, without mpmath and PyYAML

The command draws 6 rays of each field and wavelength, from SAGITTA_TEST_SEED (1), and prints px and py with
17 digits; SAGITTA_TEST_SCALE (1) multiplies how many.  What it tells of a ray may be off by no more than the
error it tells.  For each lens the largest part of that error is printed.
"""
import csv
import io
import os
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
try:
    import yaml  # noqa: F401
    from analysis_oracle import Beam, Fails, lenses, mpf
except ImportError as missing:
    print(f'skipped: {missing}')
    sys.exit(77)

SEED = os.environ.get('SAGITTA_TEST_SEED', '1')
RAYS = max(1, round(6 * float(os.environ.get('SAGITTA_TEST_SCALE', '1'))))
os.environ['SAGITTA_GLASS'] = str(HERE.parents[1] / 'data' / 'glass')


def told(command, path):
    done = subprocess.run([sys.argv[1], command, path, '--no-apertures', '--random', str(RAYS),
                           '--seed', SEED, '--format', 'csv'], capture_output=True, text=True, check=True)
    return list(csv.DictReader(io.StringIO(done.stdout))), 'exit pupil is not known' in done.stderr


class Beams(dict):
    """The beam of a field, from 1, and the place of a wavelength."""

    def __init__(self, lens):
        super().__init__()
        self.lens = lens

    def __missing__(self, at):
        field, wave = at
        self[at] = Beam(self.lens, self.lens.fields[field - 1], wave)
        return self[at]


def parts(path, lens):
    """Of each ray, how much of the error that is told is used, and what ray it is."""
    beams = Beams(lens)
    (paths, without_pupil), (fans, _) = told('opd', path), told('fan', path)
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


def main(names):
    print(f'seed {SEED}, {RAYS} rays of each field and wavelength')
    failed = False
    for name, (read, path) in lenses().items():
        if not names or name in names:
            part, what = max(parts(path, read(path)))
            good = part <= 1
            failed |= not good
            print(f'{name}: {part:.3f} of the error told{"" if good else ": FAILED, " + what}', flush=True)
    sys.exit(failed)


main(sys.argv[2:])
