#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Every number of info, trace, spot, fan, opd, field, map and sweep, against rays at 50 digits.

    python3 test_numbers.py SAGITTA [LENS ...]           status 77, skipped, without mpmath and PyYAML

The lenses are ../data/lenses and ../data/zmx, the oracle is numbers_oracle.py.  All
fields and wavelengths are taken, and a hexapolar pattern of two rings; from SAGITTA_TEST_SCALE 4 on, of
six rings; below 0.1 every third lens.  What is told may be off

    by no more than the error that is told with it, and by no more than digits says
    a length, by 1e-10 of the lens's length; points of a trace by 1e-12 of it
    first-order data, by a relative 1e-12, and as much more as a focus is far away

Each error is finite, and `digits` is above 0 unless the number is 0, within its error.
"""
import csv
import io
import json
import math
import os
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
try:
    from numbers_oracle import *
except ImportError as missing:
    print(f'skipped: {missing}')
    sys.exit(77)

SAGITTA, DATA = sys.argv[1], HERE.parent / 'data'
SCALE = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
RINGS = 6 if SCALE >= 4 else 2
PATTERN = '--hexapolar', str(RINGS)
TERMS = 6
MRAD = 1000  # of an afocal image angles are told, in milliradians, in columns that say so
os.environ['SAGITTA_GLASS'] = str(HERE.parents[1] / 'data' / 'glass')
FATES = 'missed clipped tir lost none'.split()


def number(cell):
    """Of csv or json; None: there is none."""
    if cell in ('', None, 'nan'):
        return None
    return float(cell)


def weight(rings, radius):
    """Of a point of a hexapolar pattern (docs/rays.md)."""
    ring = round(radius * rings)
    if ring == 0:
        return D(1) / (4 * rings ** 2)
    if ring == rings:
        return (D(rings) - D('0.25')) / (6 * rings ** 3)
    return D(1) / (3 * rings ** 2)


def is_of(rings, px, py):
    """Whether a point is in the pattern of so many rings."""
    ring = math.hypot(px, py) * rings
    if abs(ring - round(ring)) > 1e-9:
        return False
    step = math.atan2(py, px) / (2 * math.pi) * 6 * max(1, round(ring))
    return abs(step - round(step)) < 1e-9


class Ray:
    """Of a point of the pupil: hits; fate (None: not known), element where it ended, counted from 1."""

    def __init__(self, beam, px, py):
        self.hits = []
        try:
            self.hits, why = beam.hits(px, py)
        except Fails:
            self.fate, self.element = 'none', None
            return
        self.hair = any(h.clips is None for h in self.hits)
        self.fate, self.element = why or 'passed', len(self.hits) + (why == 'missed')
        for i, hit in enumerate(self.hits, 1):
            if hit.clips:
                self.fate, self.element = 'clipped', i
                break
        self.complete = why is None
        if self.hair:
            self.fate = None


class Check:
    def __init__(self, path):
        self.path, self.lens, self.told = path, read(path), []
        self.length = float(sum(map(abs, self.lens.thicknesses)) + (self.lens.object or 0))
        self.waves = [float(w) for w in self.lens.wavelengths]
        self.beams, self.rays, self.compared = {}, {}, 0

    # -------------------------------------------------------------- comparing

    def bad(self, what, text):
        self.told.append(f'{what}: {text}')

    def same(self, got, wanted, what):
        self.compared += 1
        if got != wanted:
            self.bad(what, f'{got!r}, not {wanted!r}')

    def close(self, got, wanted, within, what):
        got = number(got)
        self.compared += 1
        if got is None or wanted is None:
            if got is not None or wanted is not None:
                self.bad(what, f'{got}, not {None if wanted is None else float(wanted)}')
            return
        if not math.isfinite(got) or not abs(D(got) - dec(wanted)) <= D(within):
            off = abs(got - float(wanted))
            self.bad(what, f'{got}, not {float(wanted)!r}, off by {off:.3g}, within {within:.3g}')

    def error(self, cell, least, most, what):
        """An error that is told: finite, and no more than that."""
        value = number(cell)
        self.compared += 1
        if value is None or not math.isfinite(value) or not least <= value <= most:
            self.bad(what, f'an error of {cell}, at most {most:.3g}')
            return None
        return value

    def digits(self, row, got, wanted, zero, what):
        """So many digits hold; none only where the number is 0."""
        told, wanted = int(row['digits']), float(wanted)
        got = number(got)
        if got is None:
            return
        self.close(got, wanted, abs(got) * 10.0 ** -told if told else math.inf, what + f', {told} digits')
        if told <= 0 and abs(wanted) > zero:
            self.bad(what, f'digits {told} of {wanted}')

    # -------------------------------------------------------------- the command

    def run(self, *arguments):
        arguments = [str(a) for a in arguments]
        done = subprocess.run([SAGITTA, arguments[0], self.path, *arguments[1:]],
                              capture_output=True, text=True, timeout=300)
        if done.returncode not in (0, 1):
            last = done.stderr.strip().splitlines()[-1:]
            self.bad(' '.join(arguments), f'status {done.returncode}, {last}')
            return None
        return done.stdout

    def rows(self, *arguments):
        out = self.run(*arguments, '--format', 'csv')
        return [] if out is None else list(csv.DictReader(io.StringIO(out)))

    def beam(self, field, um):
        """Of a field, from 1, and a wavelength in micrometres."""
        at = field, self.waves.index(float(um))
        if at not in self.beams:
            self.beams[at] = Beam(self.lens, self.lens.fields[field - 1], at[1])
        return self.beams[at]

    def ray(self, row):
        at = int(row['field']), float(row['wavelength']), float(row['px']), float(row['py'])
        if at not in self.rays:
            self.rays[at] = Ray(self.beam(*at[:2]), *at[2:])
        return self.rays[at]

    def fate(self, row, ray, what):
        """Whether the ray passes, for both."""
        if ray.fate is None:
            return row['fate'] == 'passed' and ray.complete
        self.same(row['fate'], ray.fate, what + 'fate')
        return row['fate'] == 'passed' == ray.fate

    def where(self, command, row):
        return f"{command} field {row['field']} {row['wavelength']}" + (
            f" ({row['px']}, {row['py']}): " if 'px' in row else ': ')

    # -------------------------------------------------------------- info

    def info(self):
        out = self.run('info', '--wavelength', 'all', '--format', 'json')
        if out is None:
            return
        several = json.loads(out)
        several = several if isinstance(several, list) else [several]
        self.same([o['wavelength'] for o in several], self.waves, 'info wavelengths')
        table = self.rows('info', '--wavelength', 'all')
        for wave, (got, row) in enumerate(zip(several, table)):
            first = FirstOrder(self.lens, wave)
            for key, wanted in first.data.items():
                what = f'info {self.waves[wave]} {key}'
                if isinstance(wanted, tuple):
                    columns = key + '.z', key + '.radius'
                    for name, value, column in zip(('z', 'radius'), wanted, columns):
                        mine = (got[key] or {}).get(name)
                        self.length_of(mine, value, f'{what} {name}')
                        self.length_of(row[column], value, f'{what} {name}, csv')
                    continue
                self.length_of(got[key], wanted, what)
                self.length_of(row[key], wanted, what + ', csv')
            self.same(got['surfaces'], len(self.lens.surfaces), 'info surfaces')
            self.same(got['stop'], self.lens.stop + 1, 'info stop')
            self.same(got['units'], self.lens.units, 'info units')
            self.same([(f['x'], f['y'], f['kind']) for f in got['fields']],
                      [(float(f.x), float(f.y), self.lens.kind) for f in self.lens.fields], 'info fields')
            self.same(got['afocal'], self.lens.afocal, 'info afocal')
            if self.lens.afocal:
                what = f'info {self.waves[wave]} angular_magnification'
                self.length_of(got['angular_magnification'], first.angular, what)
            self.heights(got, first, wave)

    def heights(self, got, first, wave):
        """Paraxial images of the fields, and the invariant of the farthest."""
        # a real height is that of rays whose paraxial image is as high, at the primary wavelength
        kind = 'paraxial_image_height' if self.lens.kind == 'real_image_height' else None
        for i, (f, mine) in enumerate(zip(self.lens.fields, got['image_height']), 1):
            beam, size = Beam(self.lens, f, wave, kind), None
            across = root(beam.start[D][0] ** 2 + beam.start[D][1] ** 2)
            if self.lens.object is not None:
                m = first.data['magnification']
                size = None if m is None else across * dec(abs(m))
            elif first.power:
                size = across * dec(abs(self.lens.before[wave] / first.power))
            self.length_of(mine, size, f'info {self.waves[wave]} image height {i}')
        if self.lens.object is None:  # n u ybar - n ubar y in the entrance pupil, where ybar is 0
            beams = [Beam(self.lens, f, wave, kind) for f in self.lens.fields]
            slope = max(root(b.start[D][0] ** 2 + b.start[D][1] ** 2) for b in beams)
            wanted = -slope * dec(first.radius * self.lens.before[wave])
        else:                         # at the object, where y is 0
            far = max(self.lens.fields, key=lambda f: f.x ** 2 + f.y ** 2)
            b = Beam(self.lens, far, wave)
            u = b.radius / (1 if self.lens.telecentric else self.lens.object + b.pupil)
            wanted = -root(b.start[D][0] ** 2 + b.start[D][1] ** 2) * dec(u * self.lens.before[wave])
        self.length_of(got['lagrange'], wanted, f'info {self.waves[wave]} lagrange')

    def parabasal(self):
        """Along the real chief rays, through the centre of the stop, of a lens without mirrors."""
        lens, out = self.lens, self.run('info', '--format', 'json')
        if out is None or lens.telecentric or any(s.mirror for s in lens.surfaces):
            return
        data = json.loads(out)['parabasal'] or {'fields': []}
        for f, got in zip(lens.fields, data['fields']):
            if f.x or not self.symmetric(f) or got['efl_x'] is None:
                continue
            beam = Beam(lens, f, lens.primary, aim='stop')
            for axis in 'xy':
                efl, focus, image = beam.parabasal(axis)
                for key, wanted in (('efl', efl), ('focus', focus), ('image', image)):
                    what, far = f"info parabasal field {got['field']} {key}_{axis}", float(wanted or 0)
                    within = 1e-10 * (self.length + far * far / self.length)
                    self.close(got[f'{key}_{axis}'], wanted, within, what)

    def length_of(self, got, wanted, what):
        size = 0 if wanted is None else abs(float(wanted))
        self.close(got, wanted, 1e-12 * (self.length + size + size * size / self.length), what)

    # -------------------------------------------------------------- rays

    def trace(self):
        rows = self.rows('trace', *PATTERN, '--wavelength', 'all')
        infinite, first, last = self.lens.object is None, {}, {}
        for row in rows:
            ray, i = self.ray(row), int(row['element'])
            what = self.where('trace', row) + f'element {i}, '
            last[row['ray'], row['wavelength']] = row
            if len(ray.hits) < i or row['x'] == '':
                if len(ray.hits) >= i:
                    self.bad(what, 'no point')
                continue
            hit = ray.hits[i - 1]
            for cell, wanted in zip('xyz', hit.p):
                self.close(row[cell], wanted, 1e-12 * self.length, what + cell)
            if row['fate'] == 'passed':
                for cell, wanted in zip('lmn', hit.d):
                    self.close(row[cell], wanted, 1e-12, what + cell)
            # a beam from afar starts on a plane that the command may choose, one for each field
            group = row['field'], row['wavelength'], i
            opl, t, within = float(row['opl']), float(row['t']), 2e-12 * self.length
            base = first.setdefault(group, (opl - float(hit.opl), t - float(hit.t)))
            self.close(opl - base[0] * infinite, hit.opl, within, what + 'opl')
            self.close(t - base[1] * (infinite and i == 1), hit.t, within, what + 't')
            self.error(row['t_err'], 0, 1e-11 * self.length, what + 't_err')
        for row in last.values():
            self.fate(row, self.ray(row), self.where('trace', row))
            if self.ray(row).fate not in (None, 'none'):
                self.same(int(row['element']), self.ray(row).element, self.where('trace', row) + 'element')

    def map(self):
        for row in self.rows('map', *PATTERN, '--wavelength', 'all'):
            what, ray, field = self.where('map', row), self.ray(row), self.lens.fields[int(row['field']) - 1]
            self.same((float(row['fx']), float(row['fy'])), (float(field.x), float(field.y)), what + 'fx, fy')
            assert is_of(RINGS, float(row['px']), float(row['py'])), row
            if not self.fate(row, ray, what):
                continue
            self.same(int(row['element']), ray.element, what + 'element')
            condition = max(h.condition for h in ray.hits)
            self.close(row['condition'], condition, 1e-10 * float(condition) ** 3, what + 'condition')
            self.error(row['t_err'], 0, 1e-11 * self.length, what + 't_err')
            self.error(row['evals'], len(ray.hits), 1000 * len(ray.hits), what + 'evals')

    def place(self, hit, field, axis=None):
        """x and y at the image; or the angles of an afocal one from the primary chief ray (or an axis):
        toward x of the image's frame, and across."""
        if not self.lens.afocal:
            return hit.p[:2]
        z = axis or self.beam(field, self.waves[self.lens.primary]).chief().before
        x = unit([1 - z[0] * z[0], -z[0] * z[1], -z[0] * z[2]])
        y = [z[1] * x[2] - z[2] * x[1], z[2] * x[0] - z[0] * x[2], z[0] * x[1] - z[1] * x[0]]
        cosines = [mpf(str(dot(hit.before, e))) for e in (x, y, z)]
        return [MRAD * dec(mp.atan2(a, cosines[2])) for a in cosines[:2]]

    def centre(self, field):
        """Of the primary chief ray: where it ends; its angles from the axis."""
        chief = self.beam(field, self.waves[self.lens.primary]).chief()
        return self.place(chief, field, [D(0), D(0), D(1)])

    @property
    def size(self):
        """What lengths of the image, or its angles, are compared to."""
        return MRAD if self.lens.afocal else self.length

    def cell(self, row, name):
        return row.get(name + '_mrad' if self.lens.afocal else name)

    def fan(self):
        for row in self.rows('fan', *PATTERN):
            what, ray = self.where('fan', row), self.ray(row)
            if not self.fate(row, ray, what):
                continue
            field = int(row['field'])
            chief = self.place(self.beam(field, self.waves[self.lens.primary]).chief(), field)
            error = self.error(self.cell(row, 'e_err'), 0, 1e-8 * self.size, what + 'e_err')
            for cell, a, b in zip(('ex', 'ey'), self.place(ray.hits[-1], field), chief):
                within = min(error or math.inf, 1e-10 * self.size)
                self.close(self.cell(row, cell), a - b, within, what + cell)

    def spot(self):
        for about in ('chief', 'centroid'):
            self.spots(about)

    def spots(self, about):
        rays = self.points()
        for row in self.rows('spot', *PATTERN, '--reference', about):
            what, field = self.where(f'spot ({about})', row), int(row['field'])
            together = row['wavelength'] == 'all'
            of = [i for i, um in enumerate(self.waves) if together or um == float(row['wavelength'])]
            weights = self.lens.weights or [1.0] * len(self.waves)
            groups = [(um, D(weights[i]) if together else D(1)) for i, um in enumerate(self.waves) if i in of]
            if self.lens.weights is None and together and len(self.waves) > 1:
                continue  # the oracle does not read the weights of a .zmx file
            sent = [(w, at, self.ray({'field': field, 'wavelength': um, 'px': at[0], 'py': at[1]}))
                    for um, w in groups for at in rays]
            if any(r.fate is None for _, _, r in sent):
                continue
            self.same(int(row['rays']), len(sent), what + 'rays')
            for fate in ('passed', *FATES):
                self.same(int(row[fate]), sum(r.fate == fate for _, _, r in sent), what + fate)
            passed = [(w * weight(RINGS, math.hypot(*at)), at, self.place(r.hits[-1], field))
                      for w, at, r in sent if r.fate == 'passed']
            if not passed:
                continue
            full = self.figures(passed, about, field)
            for cell, wanted in full.items():
                self.close(self.cell(row, cell), wanted, 1e-10 * self.size, what + cell)
            self.digits(row, self.cell(row, 'rms'), full['rms'], 1e-13 * self.size, what + 'rms')
            half = [(w / weight(RINGS, math.hypot(*at)) * weight(RINGS // 2, math.hypot(*at)), at, p)
                    for w, at, p in passed if is_of(RINGS // 2, *at)]
            if half:
                self.close(self.cell(row, 'sampling'), full['rms'] - self.figures(half, about, field)['rms'],
                           2e-10 * self.size, what + 'sampling')
            self.airy(row, of[0] if not together else self.lens.primary, what)

    def points(self):
        """Of the pattern, by its definition: rings of 6 i."""
        table = self.rows('map', *PATTERN, '--wavelength', 'all')
        out = list(dict.fromkeys((float(r['px']), float(r['py'])) for r in table))
        self.same(len(out), 1 + 3 * RINGS * (RINGS + 1), 'points of the pattern')
        return out

    def figures(self, passed, about, field):
        total = sum(w for w, _, _ in passed)
        if about == 'chief':
            centre = self.place(self.beam(field, self.waves[self.lens.primary]).chief(), field)
        else:
            centre = [sum(w * p[i] for w, _, p in passed) / total for i in (0, 1)]
        mean = [sum(w * (p[i] - centre[i]) ** 2 for w, _, p in passed) / total for i in (0, 1)]
        far = max((p[0] - centre[0]) ** 2 + (p[1] - centre[1]) ** 2 for _, _, p in passed)
        at = [a + b for a, b in zip(centre, self.centre(field))] if self.lens.afocal else centre
        return {'x': at[0], 'y': at[1], 'rms': (mean[0] + mean[1]).sqrt(), 'rms_x': mean[0].sqrt(),
                'rms_y': mean[1].sqrt(), 'geometric': far.sqrt()}

    def airy(self, row, wave, what):
        """1.22 wavelength F-number; of an afocal image as an angle, 1.22 wavelength / diameter."""
        first, ring = FirstOrder(self.lens, wave), mpf('3.83170597020751231561443588630816') / mp.pi
        um = mpf(self.waves[wave]) / MICROMETRES[self.lens.units]
        if self.lens.afocal:
            radius = first.data['exit_pupil'][1]
            n = self.lens.surfaces[-2].index[wave]
            wanted = ring * um / (n * 2 * radius) * MRAD if radius else None
        else:
            f = first.data['f_number_working']
            wanted = None if f is None else ring * um * f
        self.close(self.cell(row, 'airy'), wanted, 1e-9 * float(wanted or 0), what + 'airy')

    # -------------------------------------------------------------- wavefronts

    def opd(self):
        kind, off, values = 'plane' if self.lens.afocal else 'sphere', {}, {}
        for row in self.rows('opd', *PATTERN):
            what, ray = self.where('opd', row), self.ray(row)
            if not self.fate(row, ray, what):
                continue
            beam = self.beam(int(row['field']), row['wavelength'])
            wanted = beam.opd(ray.hits[-1], kind)
            if wanted is None:
                self.same(row['opd'], '', what + 'misses the sphere')
                continue
            longest = max(abs(float(h.opl)) for h in ray.hits) + self.length
            waves = MICROMETRES[self.lens.units] / float(row['wavelength'])
            error = self.error(row['opd_err'], 0, 1e-13 * longest * waves, what + 'opd_err')
            within = error if error is not None else 1e-13 * longest * waves
            self.close(row['opd'], wanted, within, what + 'opd')
            at = row['field'], row['wavelength']
            off[at] = max(off.get(at, 0), error if error is not None else math.inf)
            values.setdefault(at, []).append((float(row['px']), float(row['py']), wanted))
        self.summary(values, off)
        self.zernike(values, off)

    def summary(self, values, off):
        for row in self.rows('opd', *PATTERN, '--summary'):
            at, what = (row['field'], row['wavelength']), self.where('opd --summary', row)
            several = values.get(at, [])
            if int(row['passed']) != len(several) or not several:
                self.same(int(row['passed']), len(several), what + 'passed')
                continue
            within = min(off[at], 1e300)
            full, half = self.rms_of(several, RINGS), self.rms_of(
                [v for v in several if is_of(RINGS // 2, *v[:2])], RINGS // 2)
            self.close(row['rms'], full, within, what + 'rms')
            every = [v for _, _, v in several]
            self.close(row['pv'], max(every) - min(every), 2 * within, what + 'pv')
            self.digits(row, row['rms'], full, 30 * within, what + 'rms')
            if half is not None:
                self.close(row['sampling'], full - half, 2 * within, what + 'sampling')
            self.same(sum(int(row[k]) for k in ('passed', *FATES)), int(row['rays']), what + 'fates')

    @staticmethod
    def rms_of(values, rings):
        if not values:
            return None
        weights = [weight(rings, math.hypot(x, y)) for x, y, _ in values]
        mean = dot_all(weights, [v for _, _, v in values]) / sum(weights)
        return (dot_all(weights, [(v - mean) ** 2 for _, _, v in values]) / sum(weights)).sqrt()

    def zernike(self, values, off):
        values = {at: v for at, v in values.items() if len(v) == 1 + 3 * RINGS * (RINGS + 1)}
        if not values:  # too few pass to know all terms
            return
        for order in ('noll', 'fringe'):
            fits = {}
            for row in self.rows('opd', *PATTERN, '--zernike', TERMS, '--order', order):
                at = row['field'], row['wavelength']
                if at not in values:
                    continue
                if at not in fits:
                    fits[at] = self.fit(order, values[at])
                coefficients, residual = fits[at]
                what, term = self.where(f'opd --zernike ({order})', row), int(row['term'])
                _, n, m = model.zernike(order, term)
                self.same((int(row['n']), int(row['m'])), (n, m), what + 'n, m')
                self.close(row['coefficient'], coefficients[term - 1], 14 * off[at], what + f'term {term}')
                self.close(row['residual'], residual, 4 * off[at], what + 'residual')

    @staticmethod
    def fit(order, values):
        """Weighted least squares by the normal equations."""
        rows, weights = [], [mpf(str(weight(RINGS, math.hypot(x, y)))) for x, y, _ in values]
        for x, y, _ in values:
            row = []
            for j in range(1, TERMS + 1):
                poly, n, m = model.zernike(order, j)
                scale = mp.sqrt((n + 1) * (2 if m else 1)) if order == 'noll' else 1
                row.append(scale * sum(f * mpf(x) ** a * mpf(y) ** b for (a, b), f in poly.items()))
            rows.append(row)
        v = [mpf(str(value)) for _, _, value in values]
        a = mp.matrix([[sum(w * r[i] * r[j] for w, r in zip(weights, rows)) for j in range(TERMS)]
                       for i in range(TERMS)])
        b = mp.matrix([sum(w * r[i] * x for w, r, x in zip(weights, rows, v)) for i in range(TERMS)])
        out = list(mp.lu_solve(a, b))
        left = [x - sum(p * q for p, q in zip(r, out)) for r, x in zip(rows, v)]
        return out, mp.sqrt(sum(w * e * e for w, e in zip(weights, left)) / sum(weights))

    # -------------------------------------------------------------- fields

    def field(self):
        for kind in ('tan', 'theta', 'tan-surface', 'theta-surface'):
            for row in self.rows('field', '--distortion', kind):
                self.curve(row, kind)

    def curve(self, row, kind):
        what, field = self.where(f'field ({kind})', row), self.lens.fields[int(row['field']) - 1]
        beam = self.beam(int(row['field']), row['wavelength'])
        self.same((float(row['fx']), float(row['fy'])), (float(field.x), float(field.y)), what + 'fx, fy')
        self.same(row['fate'], 'passed', what + 'fate')
        if row['fate'] != 'passed':
            return
        angles, u = self.lens.afocal and 'x_mrad' in row, beam.along_field()
        place = self.place(beam.chief(), 0, [D(0), D(0), D(1)]) if angles else beam.chief().p[:2]
        x, y, xy_err = (row[name + '_mrad' * angles] for name in ('x', 'y', 'xy_err'))
        error = self.error(xy_err, 0, 1e-8 * self.size, what + 'xy_err')
        for cell, mine, wanted in zip('xy', (x, y), place):
            self.close(mine, wanted, min(error or math.inf, 1e-10 * self.size), what + cell)
        for cell, way in (('tangential', u), ('sagittal', (-u[1], u[0]))):
            wanted = beam.focus(way)
            far = abs(float(wanted or 0))
            if self.lens.afocal:  # a vergence: 1 / length, in the frame of the image
                continue
            # in a lens without a plane of symmetry the command's sections turn with the chief ray
            within = 1e-10 * (self.length + far + far * far / self.length)
            within = within if self.symmetric(field) else 1e-3 * self.length
            self.close(row[cell], wanted, within, what + cell)
        height, size = place[0] * u[0] + place[1] * u[1], float(root(place[0] ** 2 + place[1] ** 2))
        self.digits(row, size, size, 1e-13 * self.size, what + 'height')
        if angles:  # tangents, against the angular magnification
            # as below: without a plane of symmetry the direction of the field turns with the chief ray
            near = 1e-8 if self.symmetric(field) else 1e-3
            first = FirstOrder(self.lens, beam.wave)
            slope = dec(first.angular) * (beam.start[D][0] * u[0] + beam.start[D][1] * u[1])
            chief = beam.chief().before
            if kind == 'tan':
                wanted = MRAD * dec(mp.atan(mpf(str(slope))))
                self.close(row['ideal_mrad'], wanted, 1e-10 * MRAD, what + 'ideal')
                tangent = (chief[0] * u[0] + chief[1] * u[1]) / chief[2]
                wanted = tangent / slope - 1 if slope else None
                within = 1e-9 if self.symmetric(field) else near * (1 + abs(float(wanted or 0)))
                self.close(row['distortion_percent'], None if wanted is None else 100 * wanted, 100 * within,
                           what + 'distortion')
            for cell, way in (('tangential', u), ('sagittal', (-u[1], u[0]))):
                far = beam.focus(way)
                # along the chief ray, in 1/m
                wanted = 0 if far is None else D(1000000) / MICROMETRES[self.lens.units] * chief[2] / far
                self.close(row[cell + '_dioptre'], wanted, near * (1 + abs(float(wanted))), what + cell)
        if self.lens.afocal:
            return
        ideal = beam.ideal_height(kind)
        self.close(row['ideal'], ideal, 1e-10 * self.length, what + 'ideal')
        within = 1e-10 * self.length / abs(float(ideal or 1)) if self.symmetric(field) else 1e-5
        self.close(row['distortion_percent'], 100 * (height / ideal - 1) if ideal else None, 100 * within,
                   what + 'distortion')

    def symmetric(self, field):
        """x = 0 is a plane of symmetry, or the lens is one of rotation."""
        plain = all(s.plain and not s.vertex[0] and not s.vertex[1] for s in self.lens.surfaces)
        return plain or (not field.x and not any(
            s.vertex[0] or s.turn[0][1] or s.turn[0][2] for s in self.lens.surfaces))

    def far(self, field):
        """How far a field is from the axis: the angle of its slope, or its height."""
        if self.lens.kind != 'angle':
            return math.hypot(field.x, field.y)
        return math.degrees(math.atan(math.hypot(*(math.tan(math.radians(a)) for a in (field.x, field.y)))))

    def sweep(self):
        rows = self.rows('sweep', '--steps', '3', '--hexapolar', '1')
        kind = 'angle' if self.lens.object is None else 'object_height'
        for i, row in enumerate(rows):
            what, at = f"sweep {row['at']}: ", float(row['at'])
            if self.lens.kind == kind:
                most = 2 * max(self.far(f) for f in self.lens.fields)
                most = min(most, 89) if kind == 'angle' else most
                self.close(at, (most or 89) * i / 2, 1e-12 * (most or 89), what + 'at')
            self.same(sum(int(row[k]) for k in ('passed', *FATES)), int(row['rays']), what + 'fates')
            if at >= 80 and kind == 'angle':
                continue
            try:
                beam = Beam(self.lens, model.Field(0.0, at), self.waves.index(float(row['wavelength'])), kind)
                rays = [Ray(beam, x, y) for x, y in self.points() if is_of(1, x, y) and (
                    math.hypot(x, y) < 1e-9 or math.hypot(x, y) > 1 - 1e-9)]
            except Fails:
                continue
            if any(r.fate in (None, 'none') for r in rays):
                continue
            for fate in ('passed', *FATES):
                self.same(int(row[fate]), sum(r.fate == fate for r in rays), what + fate)

    def all(self):
        for name in 'info parabasal trace map fan spot opd field sweep'.split():
            try:
                getattr(self, name)()
            except Fails as why:
                self.bad(name, f'the oracle has no ray: {why}')
        return self


def main(names):
    wrong, many, at_most = 0, 0, int(os.environ.get('NUMBERS_TOLD', '6'))
    for path in lenses(DATA)[::1 if SCALE >= 0.1 else 3]:
        if names and path.name not in names:
            continue
        check = Check(path).all()
        many += check.compared
        print(f'{path.name}: {check.compared} numbers, {len(check.told)} wrong', flush=True)
        for text in check.told[:at_most]:
            print('    ' + text)
        wrong += len(check.told)
    print(f'{many} numbers compared, {wrong} wrong')
    sys.exit(wrong > 0)


main(sys.argv[2:])
