# SPDX-License-Identifier: MIT
"""Centred lenses of conics at 50 digits: the oracle of docs/compare_table.py.

It shares nothing with the library, nor with the other oracles here but the dispersion of catalogued glass
(zmx_oracle.py).  A lens is rotationally symmetric, its object at infinity, its fields angles in the plane y-z:

    rays        the conic c (x^2 + y^2 + (1 + k) z^2) = 2 z in a closed form, the root near the vertex; a ray of
                the field a has the slope tan a, and goes through px, py times the radius of the paraxial
                entrance pupil
    paraxial    heights and true slopes y, u from vertex to vertex, n negative behind one mirror:
                n' u' = n u - y c (n' - n)
    Seidel      A = n (u + y c), with a bar for the chief ray, H = n (ubar y - u ybar):
                S1 = -A^2 y D(u/n), S2 = -A Abar y D(u/n), S3 = -Abar^2 y D(u/n), S4 = -H^2 c D(1/n),
                S5 = Abar/A (S3 + S4), which for A = 0 is the limit (Welford 1986, 8.2)
    Coddington  along a ray in the plane y-z, with the angles of incidence I, I' and the curvatures Kt along the
                plane, Ks across it: n' cos^2 I' / t' - n cos^2 I / t = (n' cos I' - n cos I) Kt, and the
                same with 1 for the cosines on the left for s (Welford 1986, 9.2)
"""
import pathlib

import yaml
from mpmath import mp, mpf

import zmx_oracle

mp.dps = 50


def decimal(x):
    """A number of a file as it is written, not the double next to it."""
    return mpf(repr(x))


class Lens:
    """R, k, thickness and n behind of each surface; n is negative behind one mirror.  The entrance pupil is that of the
    primary wavelength at all of them."""

    def __init__(self, path, wave=None, significant=None):
        """significant: curvatures, conics and thicknesses are rounded to so many digits, as in a file."""
        file = yaml.safe_load(pathlib.Path(path).read_text())
        place = file.get('primary', 1) - 1 if wave is None else wave
        self.um = decimal(file['wavelengths'][place])
        sizes = file['pupil']
        self.fields = [decimal(a) for a in file['fields']]
        self.hole = mpf(0)
        self.surfaces, n, self.stop = [], mpf(1), 0

        def kept(x):
            return mpf(mp.nstr(x, significant)) if significant else x
        for i, row in enumerate(file['surfaces']):
            c = kept(1 / decimal(row['radius'])) if 'radius' in row else mpf(0)
            self.stop = i if row.get('stop') else self.stop
            for shape in row.get('apertures', ()):
                self.hole = decimal(shape['radius'])
            if row.get('mirror'):
                n = -n
            elif row.get('glass', 'air') != 'air':
                maker, glass = (['SCHOTT'] + row['glass'].split())[-2:]
                n = mp.sign(n) * mpf(str(zmx_oracle.catalogue(glass, [maker], file['wavelengths'][place])))
            elif 'glass' in row:
                n = mp.sign(n)
            elif 'index' in row:
                n = mp.sign(n) * decimal(row['index'][place])
            self.surfaces.append((c, kept(decimal(row.get('conic', 0))), kept(decimal(row.get('thickness', 0))), n))
        self.indices = [mpf(1)] + [s[3] for s in self.surfaces]
        primary = self if wave in (None, file.get('primary', 1) - 1) else Lens(path)
        self.pupil = self.found_pupil() if primary is self else primary.pupil
        (kind, size), = sizes.items()
        efl = -1 / (primary.indices[-1] * primary.paraxial(mpf(1), mpf(0))[-1][1])
        size = decimal(size)
        self.radius = {'semi_diameter': size, 'diameter': size / 2, 'f_number': efl / size / 2}[kind]

    # -------------------------------------------------------------- paraxial

    def paraxial(self, y, u, first=0, last=None):
        """[(y, u before, u behind)] of the surfaces."""
        out = []
        for i in range(first, len(self.surfaces) if last is None else last + 1):
            c, _, thickness, n = self.surfaces[i]
            before = self.indices[i]
            behind = u if i + 1 == len(self.surfaces) else (before * u - y * c * (n - before)) / n
            out.append((y, u, behind))
            y, u = y + thickness * behind, behind
        return out

    def found_pupil(self):
        """z from the first vertex: a ray (y, u) with y = -z u meets the stop's centre."""
        a, b = self.paraxial(mpf(1), mpf(0), 0, self.stop)[-1][0], self.paraxial(mpf(0), mpf(1), 0, self.stop)[-1][0]
        return b / a

    def first_order(self):
        far = self.paraxial(mpf(1), mpf(0))[-1]
        n, u = self.indices[-1], far[1]
        out = {'efl': -1 / (n * u), 'focus': -far[0] / u, 'entrance pupil': self.pupil}
        out['bfd'] = out['focus'] + self.surfaces[-2][2]
        out['rear principal'] = (1 - far[0]) / u
        out['f number'] = abs(out['efl']) / (2 * self.radius)
        z = self.pupil
        chief = self.paraxial(-z, mpf(1))[-1]
        out['exit pupil'] = -chief[0] / chief[1]
        out['exit radius'] = self.radius * abs(far[0] + far[1] * out['exit pupil'])
        slope = mp.tan(self.fields[-1] * mp.pi / 180)
        out['lagrange'] = self.radius * slope
        out['at the stop'] = abs(self.radius * self.paraxial(mpf(1), mpf(0), 0, self.stop)[-1][0])
        out['image height'] = out['efl'] * slope
        out['slope'] = self.radius * u
        out['chief at the image'] = chief[0] * slope
        return out

    def seidel(self):
        slope, z = mp.tan(self.fields[-1] * mp.pi / 180), self.pupil
        marginal, chief = self.paraxial(self.radius, mpf(0)), self.paraxial(-z * slope, slope)
        sums = [mpf(0)] * 5
        invariant = marginal[0][0] * slope
        for i, (c, k, _, n2) in enumerate(self.surfaces[:-1]):
            n, (y, u, v), (ybar, ubar, _) = self.indices[i], marginal[i], chief[i]
            a, abar, delta = n * (u + y * c), n * (ubar + ybar * c), v / n2 - u / n
            one, two, three = -a * a * y * delta, -a * abar * y * delta, -abar * abar * y * delta
            four = -invariant ** 2 * c * (1 / n2 - 1 / n)
            aspheric = k * c ** 3 * (n2 - n)
            five = abar / a * (three + four) if a else -abar ** 3 * y * (1 / n2 ** 2 - 1 / n ** 2)
            more = [aspheric * y ** (4 - j) * ybar ** j for j in range(4)]
            for j, part in enumerate((one + more[0], two + more[1], three + more[2], four, five + more[3])):
                sums[j] += part
        return sums

    # -------------------------------------------------------------- rays

    def launch(self, degrees, px, py):
        t, z = mp.tan(degrees * mp.pi / 180), self.pupil
        size = mp.sqrt(1 + t * t)
        return [self.radius * px, self.radius * py, z], [mpf(0), t / size, 1 / size]

    def trace(self, o, d):
        """[(point, direction behind)] in the frames of the vertices; o in that of the first.  And the path from
        the wavefront through the axis there."""
        path, out = d[1] * o[1], []
        for i, (c, k, thickness, n2) in enumerate(self.surfaces):
            n = self.indices[i]
            t = -o[2] / d[2]
            p = [a + t * b for a, b in zip(o, d)]
            turn, a = 1 + k, c * (1 + k * d[2] ** 2)
            b = c * (p[0] * d[0] + p[1] * d[1]) - d[2]
            h = c * (p[0] ** 2 + p[1] ** 2)
            s = h / (-b + mp.sign(-b) * mp.sqrt(b * b - a * h)) if c else mpf(0)
            p = [x + s * y for x, y in zip(p, d)]
            path += abs(n) * (t + s)
            normal = [-c * p[0], -c * p[1], 1 - c * turn * p[2]]
            size = mp.sqrt(sum(x * x for x in normal))
            normal = [x / size for x in normal]
            if i + 1 < len(self.surfaces):
                cosine = sum(x * y for x, y in zip(d, normal))
                if n * n2 < 0:
                    d = [x - 2 * cosine * y for x, y in zip(d, normal)]
                elif n != n2:
                    mu = n / n2
                    bend = mp.sign(cosine) * mp.sqrt(1 - mu * mu * (1 - cosine * cosine)) - mu * cosine
                    d = [mu * x + bend * y for x, y in zip(d, normal)]
            out.append((p, d))
            o = [p[0], p[1], p[2] - thickness]
        return out, path

    def ray(self, degrees, px, py):
        return self.trace(*self.launch(degrees, mpf(px), mpf(py)))[0][-1]

    def crosses_axis(self, degrees):
        """z from the image vertex where the real chief ray crosses the axis."""
        p, d = self.ray(degrees, 0, 0)
        return p[2] - p[1] * d[2] / d[1]

    def meet(self, one, other, axis, level=False):
        """Along z from the first ray's point: where two rays have the same place along an axis.  level: as if both
        points had the same z."""
        (p, d), (q, e) = one, other
        lower = 0 if level else q[2] - p[2]
        slopes = d[axis] / d[2], e[axis] / e[2]
        return (q[axis] - slopes[1] * lower - p[axis]) / (slopes[0] - slopes[1])

    def coddington(self, degrees):
        """z to the tangential and the sagittal focus, from where the chief ray meets the image."""
        o, d = self.launch(degrees, mpf(0), mpf(0))
        several, _ = self.trace(o, d)
        focus, before = [None, None], d       # distances along the ray from the surface; None: infinite
        for i, (p, behind) in enumerate(several[:-1]):
            c, k, thickness, n2 = self.surfaces[i]
            n, r2 = abs(self.indices[i]), p[0] ** 2 + p[1] ** 2
            n2, mirror = abs(n2), self.indices[i] * n2 < 0
            root = mp.sqrt(1 - (1 + k) * c * c * r2)           # slope of the sag: c r / root
            bulge = mp.sqrt(root * root + c * c * r2)
            bent = c / bulge, c / bulge ** 3                   # across the plane, and along it
            normal = [-c * p[0] / bulge, -c * p[1] / bulge, root / bulge]
            one, two = (sum(x * y for x, y in zip(v, normal)) for v in (before, behind))
            for j, (curve, a, b) in enumerate(((bent[1], one * one, two * two), (bent[0], mpf(1), mpf(1)))):
                inverse = 0 if focus[j] is None else n * a / focus[j]
                # across a mirror the component along the normal turns: n' cos I' = n two, n cos I = n one
                total = inverse + (n2 * two - n * one) * curve
                focus[j] = n2 * b / total if total else None
            q, following = several[i + 1][0], several[i][1]
            apart = [q[0] - p[0], q[1] - p[1], q[2] - p[2] + thickness]
            step = sum(x * y for x, y in zip(apart, following))
            focus = [None if f is None else f - step for f in focus]
            before = following
        return [f * before[2] for f in focus]

    # -------------------------------------------------------------- spots and wavefronts

    def spot(self, degrees, rings, centroid=None, about=None):
        """RMS and largest distance of the rays of a hexapolar pattern that the hole lets pass, each alike."""
        points = [(mpf(0), mpf(0))] if not self.hole else []
        for j in range(1, rings + 1):
            points += [(mp.cos(mp.pi * i / (3 * j)) * j / rings, mp.sin(mp.pi * i / (3 * j)) * j / rings)
                       for i in range(6 * j)]
        points = [q for q in points if mp.hypot(*q) * self.radius > self.hole or not self.hole]
        ends = [self.ray(degrees, *q)[0][:2] for q in points]
        if centroid:
            about = [sum(e[i] for e in ends) / len(ends) for i in (0, 1)]
        about = about or self.ray(degrees, 0, 0)[0][:2]
        apart = [(e[0] - about[0]) ** 2 + (e[1] - about[1]) ** 2 for e in ends]
        return {'rms': mp.sqrt(sum(apart) / len(apart)), 'largest': mp.sqrt(max(apart)), 'about': about}

    def waves(self, degrees, points, unit=1000):
        """Paths up to the sphere about the chief ray's image through the paraxial exit pupil, less its own."""
        chief, path = self.trace(*self.launch(degrees, mpf(0), mpf(0)))
        c, z = chief[-1][0], self.first_order()['exit pupil']
        radius = mp.sqrt(c[0] ** 2 + c[1] ** 2 + (c[2] - z) ** 2)
        out = []
        for x, y in points:
            ends, length = self.trace(*self.launch(degrees, x, y))
            (p, d), apart = ends[-1], [a - b for a, b in zip(ends[-1][0], c)]
            b, square = sum(u * v for u, v in zip(apart, d)), sum(u * u for u in apart)
            out.append((length - path - b - mp.sqrt(b * b - square + radius ** 2) + radius) * unit / self.um)
        return out


def fringe(terms):
    """(n, m) of the fringe order; m negative: a sine of the angle from y, which for fields in y is 0."""
    out = []
    for k in range(7):
        for m in range(k, -1, -1):
            out += [(2 * k - m, m)] if m == 0 else [(2 * k - m, m), (2 * k - m, -m)]
    return out[:terms]


def zernike(lens, degrees, rings, terms=37):
    """Coefficients of the even part of a wavefront that is symmetric in x, by least squares: {place from 1: value}."""
    mp.dps = 35
    polar = [(mpf(j) / rings, mp.pi * (i + mpf(1) / 2) / (3 * j)) for j in range(1, rings + 1) for i in range(3 * j)]
    points = [(r * mp.sin(turn), r * mp.cos(turn)) for r, turn in polar]
    waves = lens.waves(degrees, points)
    kept = [(place, n, m) for place, (n, m) in enumerate(fringe(terms), 1) if m >= 0]
    rows = []
    for x, y in points:
        r, turn = mp.hypot(x, y), mp.atan2(x, y)
        rows.append([mp.cos(m * turn) * sum(
            (-1) ** s * mp.factorial(n - s) / (mp.factorial(s) * mp.factorial((n + m) // 2 - s)
                                               * mp.factorial((n - m) // 2 - s)) * r ** (n - 2 * s)
            for s in range((n - m) // 2 + 1)) for _, n, m in kept])
    count = len(kept)
    a, b = mp.matrix(count, count), mp.matrix(count, 1)
    for i in range(count):
        b[i] = mp.fdot((row[i], w) for row, w in zip(rows, waves))
        for j in range(i, count):
            a[i, j] = a[j, i] = mp.fdot((row[i], row[j]) for row in rows)
    out = mp.lu_solve(a, b)
    mp.dps = 50
    return {place: out[i] for i, (place, _, _) in enumerate(kept)}
