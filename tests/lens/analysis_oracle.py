#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Spots, wavefronts and curves of fields at 50 digits, by mpmath: writes ../data/analysis_*.csv.

    python3 analysis_oracle.py [LENS ...]            all, or the rows of some; needs mpmath and PyYAML
    python3 analysis_oracle.py --reference FOLDER    rewrites analysis_reference.csv (../data/README.md) from
                                                     the json files in FOLDER, and compares

The lenses and their real and paraxial rays are those of analysis_model.py.  What is made of them here:

    launch      of a field of angles a, b the rays have the slopes tan a, tan b; of a height h of the paraxial
                image h P / n.  They start on the plane across the chief ray's direction through the centre
                of the paraxial entrance pupil, or at the object point.  px, py are in radii of that pupil.
                Aimed, they are in heights of the paraxial or real marginal ray at the stop, and Newton's
                method finds the ray to there
    image       x, y of a ray in the frame of the last surface; (l, m, n) its direction there
    opd         n (path of the ray - path of the chief ray), in waves, up to the sphere about the chief ray's
                image point through the axial point of the paraxial exit pupil (Welford 1986, Aberrations of
                Optical Systems, 7.1); positive where the ray's path is longer.  The chief ray is that of the
                same wavelength, the pupil that of the primary one.  opd_foot, and opd if that pupil is at
                infinity: up to the foot of the perpendicular from that point on the ray.  opd_plane, for an
                image at infinity: up to the plane across the chief ray
    foci        the chief ray and one beside it, by a step of 1e-20 of the pupil in the plane of the field and
                the axis (tangential) or across it (sagittal): the z of the image's frame where both have the
                same place in that direction.  In the limit these are Coddington's equations (Welford 9.2)
    distortion  (h - h') / h', h the chief ray's image height along the field, h' = tan(angle) n / P, or the
                angle n / P; of an object at a distance the magnification times its height.  P is the power at
                that wavelength
    spot, rms   of the 316 centres of a 20 x 20 grid of cells that lie in the circle, weighted equally, and
                without apertures, at the primary wavelength
"""
import csv
import json
import pathlib
import sys

from analysis_model import Fails, along, dot, mp, mpf, read_yaml, read_zmx, unit, zernike

HERE = pathlib.Path(__file__).resolve().parent
DATA, EXAMPLES = HERE.parent / 'data', HERE.parents[1] / 'examples' / 'lenses'
SKEW = [(0.45, 0.25), (-0.35, 0.75), (-0.85, -0.45), (0.65, -0.15)]  # these are centres of cells, too
CROSS = [(0.0, i / 4) for i in range(-4, 5)] + [(i / 4, 0.0) for i in range(-4, 5) if i]
CELLS = [(x, y) for y in range(-19, 20, 2) for x in range(-19, 20, 2) if x * x + y * y <= 400]
TERMS = {'noll': 15, 'fringe': 16}
MICROMETRES = {'mm': 1000, 'in': 25400, 'm': 1000000}


def newton(miss, x, what):
    """The root of several functions of as many unknowns, by differences of 1e-25."""
    h = mpf(10) ** -25
    for _ in range(40):
        f = miss(x)
        if max(map(abs, f)) < mpf(10) ** -45:
            return x
        m = mp.matrix(len(x), len(x))
        for j in range(len(x)):
            g = miss([a + h * (i == j) for i, a in enumerate(x)])
            for i, (a, b) in enumerate(zip(f, g)):
                m[i, j] = (b - a) / h
        x = [a - b for a, b in zip(x, mp.lu_solve(m, mp.matrix(f)))]
    raise Fails(f'no convergence: {what}')


def or_none(function, *arguments):
    """What depends on paraxial data, which a lens may not have."""
    try:
        return function(*arguments)
    except Fails:
        return None


class Beam:
    """The rays of one field at one wavelength."""

    def __init__(self, lens, field, wave, aim=None):
        self.lens, self.field, self.wave, self.aim = lens, field, wave, aim or lens.aim
        self.pupil, self.radius = lens.entrance_pupil(), lens.pupil_radius()
        self.places, self.chief_at = {}, None
        if self.aim != 'pupil':
            self.stop_radius = self.height_at_stop()
        self.set_field(self.field_start())
        if lens.kind == 'real_image_height':
            self.find_real_height()

    def set_field(self, start):
        """start: the slopes of the field, or the object point."""
        lens = self.lens
        if lens.object is None:
            self.object, self.direction = None, unit([*start, mpf(1)])
        else:
            self.object = [*start, -lens.object]

    def field_start(self):
        lens, f = self.lens, self.field
        if lens.kind == 'angle':
            slopes = [mp.tan(a * mp.pi / 180) for a in (f.x, f.y)]
            return slopes if lens.object is None else [-a * (lens.object + self.pupil) for a in slopes]
        if lens.kind == 'object_height':
            return [f.x, f.y]
        scale = lens.power(lens.primary) / lens.before[lens.primary] if lens.object is None else (
            1 / lens.magnification(lens.primary))
        return [f.x * scale, f.y * scale]

    def height_at_stop(self):
        """Of the marginal ray on the axis, at the primary wavelength."""
        lens, wave = self.lens, self.lens.primary
        y, nu = lens.marginal()
        if self.aim == 'stop':
            return abs(self.radius * lens.paraxial(y, nu, 0, lens.stop, wave)[0])
        edge, z = self.radius, self.pupil
        o, d = [mpf(0), edge, z], [mpf(0), mpf(0), mpf(1)]
        if lens.object is not None:
            o, d = [mpf(0), mpf(0), -lens.object], unit([mpf(0), edge, z + lens.object])
        return abs(lens.trace(wave, o, d, last=lens.stop)[0][1])

    def find_real_height(self):
        """The start of the field whose chief ray, at the primary wavelength, meets the image at x, y."""
        lens, aimed = self.lens, self.aim != 'pupil'

        def miss(x):
            self.set_field(x[:2])
            place = x[2:] if aimed else [mpf(0), mpf(0)]
            p = lens.trace(lens.primary, *self.through(*place))[0]
            out = [p[0] - self.field.x, p[1] - self.field.y]
            if aimed:
                out += lens.trace(lens.primary, *self.through(*place), last=lens.stop)[0][:2]
            return out
        x = self.field_start() + [mpf(0)] * (2 if aimed else 0)
        self.set_field(newton(miss, x, 'real image height')[:2])

    def through(self, x, y):
        """Start, direction and path of the ray through a place of the entrance pupil, in its radii."""
        p = [x * self.radius, y * self.radius, self.pupil]
        if self.object is not None:
            return self.object, unit(along(p, -1, self.object)), mpf(0)
        n = self.lens.before[self.wave]
        return p, self.direction, n * dot(self.direction, [p[0], p[1], mpf(0)])

    def at_stop(self, place):
        p = self.lens.trace(self.wave, *self.through(*place), last=self.lens.stop)[0]
        return p[0] / self.stop_radius, p[1] / self.stop_radius

    def place(self, px, py):
        """The place in the entrance pupil of a point of the pupil."""
        px, py = px * (1 - self.field.cx), py * (1 - self.field.cy)
        if self.aim == 'pupil':
            return px, py
        if (px, py) not in self.places:
            self.places[px, py] = self.aimed(px, py)
        return self.places[px, py]

    def aimed(self, px, py):
        """By Newton's method, from the nearest point that is known."""
        def miss(place):
            x, y = self.at_stop(place)
            return [x - px, y - py]
        if not self.places:
            if px or py:
                self.places[mpf(0), mpf(0)] = self.aimed(mpf(0), mpf(0))
            else:
                return self.aimed_chief(miss)
        near = min(self.places, key=lambda p: (p[0] - px) ** 2 + (p[1] - py) ** 2)
        return newton(miss, list(self.places[near]), f'aiming at {px}, {py}')

    def aimed_chief(self, miss):
        """The field grows from 0 in 32 steps, and each begins where the one before has ended."""
        full, place = (self.object or self.direction), [mpf(0), mpf(0)]
        start = [full[0], full[1]] if self.object is not None else [a / full[2] for a in full[:2]]
        for i in range(1, 33):
            self.set_field([a * i / 32 for a in start])
            place = newton(miss, place, f'aiming of the chief ray, {i}/32 of the field')
        return place

    def end(self, px, py):
        """Point, direction, path and whether no aperture clips, at the image."""
        return self.lens.trace(self.wave, *self.through(*self.place(mpf(px), mpf(py))))

    def chief(self):
        if self.chief_at is None:
            self.chief_at = self.end(0, 0)
        return self.chief_at

    # -------------------------------------------------------------- wavefronts

    def reference_radius(self):
        """From the axial point of the exit pupil to the chief ray's image point, negative if the pupil lies
        behind it in the direction of the light; None: at infinity."""
        z = self.lens.exit_pupil()
        if z is None:
            return None
        p, d, _, _ = self.chief()
        apart = [p[0], p[1], p[2] - z]
        return mp.sign(-z * d[2]) * mp.sqrt(dot(apart, apart))

    def opd(self, end, kind='sphere'):
        """In waves: up to the sphere, to the foot of the perpendicular, or to the plane."""
        lens, (c, along_chief, path, _) = self.lens, self.chief()
        n, (p, d, opl, _) = lens.surfaces[-1].index[self.wave], end
        apart = [a - b for a, b in zip(p, c)]
        if kind == 'plane':
            more = -dot(apart, along_chief) / dot(d, along_chief)
        elif kind == 'foot' or lens.exit_pupil() is None:
            more = -dot(apart, d)
        else:
            r, b = self.reference_radius(), dot(apart, d)
            square = b * b - dot(apart, apart) + r * r
            if square < 0:
                raise Fails('misses the sphere')
            more = -b - mp.sign(r) * mp.sqrt(square) + r
        return (opl - path + n * more) * MICROMETRES[lens.units] / mpf(lens.wavelengths[self.wave])

    # -------------------------------------------------------------- curves of a field

    def along_field(self):
        """The direction of the field in x, y: of its slopes, or of its height; on the axis y."""
        x, y = self.field.x, self.field.y
        if self.lens.kind == 'angle':
            x, y = (mp.tan(a * mp.pi / 180) for a in (x, y))
        size = mp.sqrt(x * x + y * y)
        return (x / size, y / size) if size else (mpf(0), mpf(1))

    def focus(self, u):
        """Where rays beside the chief ray meet it in the direction u, along z from the image surface."""
        h = mpf(10) ** -20
        ends = [self.end(s * h * u[0], s * h * u[1]) for s in (1, -1)]
        place, slope = (sum(u[i] * (a[i] - b[i]) for i in (0, 1)) for a, b in (
            [e[0] for e in ends], [[e[1][0] / e[1][2], e[1][1] / e[1][2]] for e in ends]))
        return None if abs(slope) < mpf(10) ** -38 else -place / slope

    def ideal(self, theta):
        """The height of an image without distortion."""
        lens = self.lens
        if lens.object is not None:
            start = self.object[:2]
            return lens.magnification(self.wave) * (start[0] * self.along_field()[0]
                                                    + start[1] * self.along_field()[1])
        if not lens.power(self.wave):
            return None
        slope = sum((a / self.direction[2]) * b for a, b in zip(self.direction, self.along_field()))
        return (mp.atan(slope) if theta else slope) * lens.before[self.wave] / lens.power(self.wave)

    def curves(self):
        (x, y), u = self.chief()[0][:2], self.along_field()
        out = {'x': x, 'y': y, 'tangential': self.focus(u), 'sagittal': self.focus((-u[1], u[0]))}
        for name, theta in (('tan', False), ('theta', True)):
            ideal = or_none(self.ideal, theta)
            out['ideal_' + name] = ideal
            out['distortion_' + name] = (x * u[0] + y * u[1]) / ideal - 1 if ideal else None
        return out


def root_mean(values):
    return mp.sqrt(sum(v * v for v in values) / len(values))


def spot(beam):
    """Of all cells; also the wavefront and its coefficients."""
    ends = []
    for x, y in CELLS:
        try:
            ends.append((x, y, beam.end(mpf(x) / 20, mpf(y) / 20)))
        except Fails:
            pass
    out = {'traced': len(ends), 'passed': sum(e[3] for _, _, e in ends)}
    if not ends:
        return out, {}
    points = [e[0][:2] for _, _, e in ends]
    centre = [sum(p[i] for p in points) / len(points) for i in (0, 1)]
    chief = beam.chief()[0][:2]
    out.update(x=centre[0], y=centre[1])
    for name, at in (('centroid', centre), ('chief', chief)):
        apart = [[p[0] - at[0], p[1] - at[1]] for p in points]
        rms = [root_mean([a[i] for a in apart]) for i in (0, 1)]
        out.update({f'rms_{name}': mp.sqrt(rms[0] ** 2 + rms[1] ** 2), f'rms_x_{name}': rms[0],
                    f'rms_y_{name}': rms[1],
                    f'geometric_{name}': max(mp.sqrt(a[0] ** 2 + a[1] ** 2) for a in apart)})
    waves = [or_none(beam.opd, e) for _, _, e in ends]
    if None in waves:
        return out, {}
    mean = sum(waves) / len(waves)
    out.update(opd_rms=root_mean([w - mean for w in waves]), opd_pv=max(waves) - min(waves))
    points = [(mpf(x) / 20, mpf(y) / 20) for x, y, _ in ends]
    return out, {order: fit(order, points, waves) for order in TERMS}


def fit(order, points, values):
    """Least squares by the normal equations, which at 60 digits leave 50 and more."""
    count = TERMS[order]
    rows = []
    for x, y in points:
        row = []
        for j in range(1, count + 1):
            poly, n, m = zernike(order, j)
            scale = mp.sqrt((n + 1) * (2 if m else 1)) if order == 'noll' else 1
            row.append(scale * sum(f * x ** a * y ** b for (a, b), f in poly.items()))
        rows.append(row)
    a = mp.matrix([[sum(r[i] * r[j] for r in rows) for j in range(count)] for i in range(count)])
    b = mp.matrix([sum(r[i] * v for r, v in zip(rows, values)) for i in range(count)])
    return list(mp.lu_solve(a, b))


# ------------------------------------------------------------------ files

def text(value):
    if value is None:
        return ''
    if isinstance(value, mpf):
        return '0' if abs(value) < mpf(10) ** -40 else mp.nstr(value, 25)
    return str(value)


def lenses():
    """All of them, by name: how to read it."""
    out = {p.name: (read_yaml, p) for p in sorted([*EXAMPLES.glob('*.yaml'), *DATA.glob('analysis_*.yaml')])}
    out.update({p.name: (read_zmx, p) for p in sorted((DATA / 'zmx').glob('*.zmx'))})
    return out


def rays_of(beam):
    for px, py in CROSS + SKEW:
        row = {'px': px, 'py': py}
        try:
            p, d, opl, inside = end = beam.end(px, py)
            row.update(zip('xyzlmn', [*p, *d]), opl=opl - beam.chief()[2], passed=int(inside),
                       opd=or_none(beam.opd, end), opd_foot=beam.opd(end, 'foot'),
                       opd_plane=beam.opd(end, 'plane'))
        except Fails as why:
            row.update(passed=why)
        yield row


TABLES = {
    'rays': 'px py passed x y z l m n opl opd opd_foot opd_plane',
    'fields': 'micrometres length working_f_number x y radius tangential sagittal '
              'ideal_tan distortion_tan ideal_theta distortion_theta',
    'spots': 'traced passed x y rms_centroid rms_x_centroid rms_y_centroid geometric_centroid rms_chief '
             'rms_x_chief rms_y_chief geometric_chief opd_rms opd_pv',
    'zernike': 'order term n m coefficient'}


def tables_of(name, lens):
    """The rows of a lens, of each table."""
    out = {table: [] for table in TABLES}
    for i, field in enumerate(lens.fields, 1):
        for wave, um in enumerate(lens.wavelengths):
            where, beam = {'lens': name, 'field': i, 'wavelength': um}, Beam(lens, field, wave)
            out['rays'] += [{**where, **row} for row in rays_of(beam)]
            try:
                out['fields'].append({
                    **where, 'micrometres': MICROMETRES[lens.units], 'length': lens.length(),
                    'working_f_number': or_none(lens.working_f_number, wave),
                    'radius': or_none(beam.reference_radius),
                    **beam.curves()})
            except Fails:
                continue
            if wave == lens.primary:
                row, fits = spot(beam)
                out['spots'].append({**where, **row})
                for order, several in fits.items():
                    out['zernike'] += [{**where, 'order': order, 'term': j, 'n': zernike(order, j)[1],
                                        'm': zernike(order, j)[2], 'coefficient': c}
                                       for j, c in enumerate(several, 1)]
    return out


def save(table, columns, rows):
    with (DATA / f'analysis_{table}.csv').open('w', newline='') as file:
        out = csv.DictWriter(file, ['lens', 'field', 'wavelength', *columns.split()], lineterminator='\n')
        out.writeheader()
        out.writerows({key: text(value) for key, value in row.items()} for row in rows)


def written(table, name):
    """The rows of a lens as they stand."""
    with (DATA / f'analysis_{table}.csv').open() as file:
        return [row for row in csv.DictReader(file) if row['lens'] == name]


def write(names):
    everything = {table: [] for table in TABLES}
    for name, (read, path) in lenses().items():
        if names and name not in names:
            for table in TABLES:
                everything[table] += written(table, name)
            continue
        print(name, flush=True)
        for table, rows in tables_of(name, read(path)).items():
            everything[table] += rows
    for table, columns in TABLES.items():
        save(table, columns, everything[table])


REFERENCE = 'traced rms_centroid rms_chief opd_pv opd_rms'


def reference(folder):
    """Of each field and wavelength, aimed at the paraxial pupil; prints how far off we are."""
    rows, off = [], mpf(0)
    for path in sorted(pathlib.Path(folder).glob('*.json')):
        lens = read_zmx(DATA / 'zmx' / f'{path.stem}.zmx')
        for r in json.loads(path.read_text())['rays']:
            theirs, waves = r['spot'], r.get('opd') or {}
            row = {'lens': f'{path.stem}.zmx', 'field': r['field'] + 1,
                   'wavelength': lens.wavelengths[r['wavelength']], 'traced': theirs['n'],
                   'rms_centroid': theirs.get('rms_centroid'), 'rms_chief': theirs.get('rms_chief'),
                   'opd_pv': waves.get('pv_waves'), 'opd_rms': waves.get('rms_waves')}
            beam = Beam(lens, lens.fields[r['field']], r['wavelength'])
            beam.aim = 'pupil'
            ours = spot(beam)[0] if theirs['n'] else {}
            for key in REFERENCE.split()[1:]:
                if row[key] and key in ours:
                    off = max(off, abs(ours[key] - mpf(row[key])) / (abs(ours[key]) + mpf(10) ** -20))
            rows.append(row)
    save('reference', REFERENCE, rows)
    print('the largest relative difference:', mp.nstr(off, 3))


if __name__ == '__main__':
    if sys.argv[1:2] == ['--reference']:
        reference(sys.argv[2])
    else:
        write(sys.argv[1:])
