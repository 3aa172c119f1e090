# SPDX-License-Identifier: MIT
"""A lens and its rays at 60 digits, by mpmath: the ground of analysis_oracle.py.

It shares nothing with the library.  Lenses come from two readers: YAML by PyYAML, for the keys that the
lenses at hand use (any other key is an error), and .zmx by zmx_oracle.py, of which only the reading of
records, breaks and glass is used.

    surface     z = s(x, y) in its frame; a ray meets it at the root of s that is nearest to the vertex
                plane, by Newton's method, in doubles first
    refraction  n' d' = n d + (n' cos I' - n cos I) N  (Welford 1986, Aberrations of Optical Systems, 4.2)
    paraxial    y and n u from vertex to vertex, n negative after a mirror  (Welford 3.2).  A lens whose
                places are given by `origin` is unfolded along the ray on its axis
    pupil       the paraxial image of the stop in object space, at the primary wavelength

Numbers of a file are doubles, as a program reads them; a radius is told by its curvature, rounded once, as
the lens file has it.  All that is made of them is exact to some 50 digits.
"""
import csv
import math
import pathlib

from mpmath import mp, mpf

import zmx_oracle

mp.dps = 60
SURFACE_KEYS = set('type radius curvature conic coefficients thickness index mirror stop semi_diameter '
                   'origin tilt decenter radius_x terms name'.split())
BY_ITSELF = 'odd_asphere', 'polynomial_xy'  # no curvature at the vertex, or a slope
LENS_KEYS = ('name units wavelengths wavelength_weights primary object pupil aim field_type fields '
             'vignetting surfaces')


class Fails(Exception):
    """A ray that does not get through."""


# ------------------------------------------------------------------ sags

def root(x):
    if x < 0:
        raise Fails('beyond the equator')
    return math.sqrt(x) if isinstance(x, float) else x.sqrt() if hasattr(x, 'sqrt') else mp.sqrt(x)


def zernike(order, j):
    """Polynomial j of an order, 1 at the edge: {(a, b): factor of x^a y^b}, n, and m (negative: a sine).

    Noll 1976 (J. Opt. Soc. Am. 66, 207): n rises, then |m|; even numbers are cosines.  Fringe (Wyant and
    Creath 1992): groups of equal n + |m|, in which |m| falls, the cosine before the sine."""
    if order == 'noll':
        n, first = 0, 1
        while first + n + 1 <= j:
            first += n + 1
            n += 1
        m, sign = n % 2 + 2 * ((j - first + 1 - n % 2) // 2), 1 if j % 2 == 0 else -1
    else:
        group = math.isqrt(j - 1)
        place = j - 1 - group * group
        m, sign = group - place // 2, 1 if place % 2 == 0 else -1
        n = 2 * group - m
    out = {}
    for s in range((n - m) // 2 + 1):
        factor = (-1) ** s * math.factorial(n - s) // (
            math.factorial(s) * math.factorial((n + m) // 2 - s) * math.factorial((n - m) // 2 - s))
        half = (n - m) // 2 - s  # r^(n - 2 s) = r^m (x^2 + y^2)^half
        for k in range(m + 1):   # (x + i y)^m
            if m and k % 2 == (1 if sign > 0 else 0):
                continue
            angular = math.comb(m, k) * (-1) ** (k // 2)
            for h in range(half + 1):
                at = m - k + 2 * (half - h), k + 2 * h
                out[at] = out.get(at, 0) + factor * angular * math.comb(half, h)
    return {at: f for at, f in out.items() if f}, n, sign * m


def powers(x, count):
    out = [x * 0 + 1]
    for _ in range(count):
        out.append(out[-1] * x)
    return out


class Departure:
    """What a term of a sum, or a type by itself, adds to a conic: value and slopes at x, y."""

    def __init__(self, term, folder, number):
        self.kind, self.norm, self.poly = term['type'], number(float(term.get('norm', 1))), {}
        if self.kind == 'odd_asphere':
            self.odd = [number(float(a)) for a in term['coefficients']]
        elif self.kind == 'polynomial_xy':
            self.poly = {(i, j): number(float(a)) for i, row in enumerate(term['coefficients'])
                         for j, a in enumerate(row)}
        elif self.kind == 'zernike':
            for j, a in enumerate(term['coefficients'], 1):
                for at, factor in zernike(term['order'], j)[0].items():
                    self.poly[at] = self.poly.get(at, 0) + factor * number(float(a))
        elif self.kind == 'grid':
            self.step = number(float(term['step_x'])), number(float(term['step_y']))
            rows = [[number(float(f)) for f in row] for row in csv.reader((folder / term['sag']).open())]
            self.z = self.extended([self.extended(row) for row in rows])
        else:
            raise ValueError(f'no departure {self.kind}')

    @staticmethod
    def extended(z):
        """One more at either end, by Keys' boundary condition; of rows, if these are lists."""
        if isinstance(z[0], list):
            return [list(column) for column in zip(*map(Departure.extended, zip(*z)))]
        return [3 * z[0] - 3 * z[1] + z[2], *z, 3 * z[-1] - 3 * z[-2] + z[-3]]

    @staticmethod
    def weights(x, step, count):
        """The first of four heights, extended, and their weights for value and slope: Keys 1981, a = -1/2."""
        u = x / step + (x * 0 + count - 1) / 2
        if not 0 <= u <= count - 1:
            raise Fails('outside the grid')
        j = min(int(math.floor(float(u))), count - 2)
        v = u - j
        return j, [(-v + 2 * v ** 2 - v ** 3) / 2, (2 - 5 * v ** 2 + 3 * v ** 3) / 2,
                   (v + 4 * v ** 2 - 3 * v ** 3) / 2, (-v ** 2 + v ** 3) / 2], [
            (-1 + 4 * v - 3 * v ** 2) / 2 / step, (-10 * v + 9 * v ** 2) / 2 / step,
            (1 + 8 * v - 9 * v ** 2) / 2 / step, (-2 * v + 3 * v ** 2) / 2 / step]

    def __call__(self, x, y):
        if self.kind == 'odd_asphere':
            r = root(x * x + y * y)
            u = powers(r, len(self.odd))
            slope = sum(i * a * u[i - 1] for i, a in enumerate(self.odd, 1)) / r
            return sum(a * v for a, v in zip(self.odd, u[1:])), slope * x, slope * y
        if self.poly:
            top = max(a + b for a, b in self.poly)
            u, v = powers(x / self.norm, top), powers(y / self.norm, top)
            return (sum(f * u[a] * v[b] for (a, b), f in self.poly.items()),
                    sum(f * a * u[a - 1] * v[b] for (a, b), f in self.poly.items() if a) / self.norm,
                    sum(f * b * u[a] * v[b - 1] for (a, b), f in self.poly.items() if b) / self.norm)
        j, wx, dx = self.weights(x, self.step[0], len(self.z[0]) - 2)
        i, wy, dy = self.weights(y, self.step[1], len(self.z) - 2)

        def total(a, b):
            return sum(a[q] * b[p] * self.z[i + p][j + q] for p in range(4) for q in range(4))
        return total(wx, wy), total(dx, wy), total(wx, dy)


class Sag:
    """A sag in floats or in mpf: value and slopes at x, y.

    conic + a[i] r^(2 i + 2) + departures;  of a toroid (`swept`) the profile of y, turned about an axis
    parallel to y at z = radius_x (0: at infinity)."""

    def __init__(self, c, k, coefficients, number, swept=None, departures=()):
        self.c, self.k, self.a = number(c), number(k), [number(a) for a in coefficients]
        self.swept = None if swept is None else number(swept)
        self.departures, self.zero = departures, number(0)

    def profile(self, r2):
        """The sag, and its derivative by r^2."""
        w = root(1 - (1 + self.k) * self.c * self.c * r2)
        s, d, power = self.c * r2 / (1 + w), self.c / (2 * w), self.zero + 1
        for i, a in enumerate(self.a, 1):
            d += i * a * power
            power *= r2
            s += a * power
        return s, d

    def __call__(self, x, y):
        if self.swept is not None:
            g, d = self.profile(y * y)
            if not self.swept:
                return g, self.zero, 2 * d * y
            q = root((self.swept - g) ** 2 - x * x)
            q = q if self.swept > 0 else -q
            return self.swept - q, x / q, (self.swept - g) * 2 * d * y / q
        s, d = self.profile(x * x + y * y)
        sx, sy = 2 * d * x, 2 * d * y
        for more in self.departures:
            p, px, py = more(x, y)
            s, sx, sy = s + p, sx + px, sy + py
        return s, sx, sy


# ------------------------------------------------------------------ surfaces and their places

IDENTITY = [[mpf(i == j) for j in range(3)] for i in range(3)]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def along(p, t, d):
    return [a + t * b for a, b in zip(p, d)]


def unit(d):
    size = mp.sqrt(dot(d, d))
    return [a / size for a in d]


def turned(m, v):
    return [dot(row, v) for row in m]


def back(m, v):
    return [m[0][i] * v[0] + m[1][i] * v[1] + m[2][i] * v[2] for i in range(3)]


def turn_of(tilt):
    """Rz Ry Rx, degrees."""
    def cos_sin(a):
        a = mpf(float(a)) / 180
        return mp.cospi(a), mp.sinpi(a)
    (cx, sx), (cy, sy), (cz, sz) = map(cos_sin, tilt)
    rx = mp.matrix([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    ry = mp.matrix([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    rz = mp.matrix([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    m = rz * ry * rx
    return [[m[i, j] for j in range(3)] for i in range(3)]


class Surface:
    """rough, fine: its sag; vertex, turn: its frame; index: behind it, at each wavelength of the lens,
    positive; c: curvature of the vertex in the y-z plane, None if it has none; focal: the focal length of an
    ideal lens, else None; clips: whether it stops a ray at x, y."""

    def __init__(self, c=0.0, k=0.0, a=(), mirror=False, swept=None, terms=(), folder=None, clips=None):
        self.rough = Sag(c, k, a, float, swept, [Departure(t, folder, float) for t in terms])
        self.fine = Sag(c, k, a, mpf, swept, [Departure(t, folder, mpf) for t in terms])
        self.c = mpf(c) + (2 * mpf(a[0]) if a else 0)
        self.mirror, self.focal, self.clips = mirror, None, clips or (lambda x, y: False)
        self.vertex, self.turn, self.plain, self.index = [mpf(0)] * 3, IDENTITY, True, []

    def placed(self, vertex, turn=None):
        self.vertex, self.turn, self.plain = vertex, turn or IDENTITY, turn is None
        return self

    def starts(self, p, d):
        """Where the conic is met, the root nearest to the vertex plane first; last, that plane."""
        c, k = self.rough.c, self.rough.k
        q, m = c * (1 + k), d[0] * p[0] + d[1] * p[1]
        a = c * (d[0] ** 2 + d[1] ** 2) + q * d[2] ** 2
        b = c * m + q * p[2] * d[2] - d[2]
        e = c * (p[0] ** 2 + p[1] ** 2) + q * p[2] ** 2 - 2 * p[2]
        square, out = b * b - a * e, []
        if square >= 0 and self.rough.swept is None:
            w = -b + math.copysign(math.sqrt(square), -b)
            out = ([w / a] if a else []) + ([e / w] if w else [])
        return sorted(out, key=lambda t: abs(p[2] + t * d[2])) + [-p[2] / d[2]]

    def newton(self, t, p, d):
        for _ in range(60):
            s, sx, sy = self.rough(p[0] + t * d[0], p[1] + t * d[1])
            step = (p[2] + t * d[2] - s) / (d[2] - sx * d[0] - sy * d[1])
            t -= step
            if abs(step) <= 1e-14 * (abs(t) + abs(p[2]) + 1e-9):
                return t
        raise Fails('no root')

    def met(self, p, d):
        """t and the slopes of the sag there, of a ray in this frame."""
        near = [float(x) for x in p], [float(x) for x in d]
        for start in self.starts(*near):
            try:
                t = mpf(self.newton(start, *near))
                break
            except (Fails, ZeroDivisionError):
                pass
        else:
            raise Fails('missed')
        for _ in range(8):
            s, sx, sy = self.fine(p[0] + t * d[0], p[1] + t * d[1])
            step = (p[2] + t * d[2] - s) / (d[2] - sx * d[0] - sy * d[1])
            t -= step
            if abs(step) < mpf(10) ** -32 * (1 + abs(t)):  # the next error is its square
                return t, sx, sy
        raise Fails('no root at 60 digits')

    def bent(self, p, d, slopes, n, behind, object_distance=None):
        """The direction behind, and what an ideal lens adds to the path for an object at a distance in front."""
        if self.focal is not None:
            return self.ideal(p, d, n, behind, object_distance)
        normal = unit([-slopes[0], -slopes[1], mpf(1)])
        cosine = dot(d, normal)
        if self.mirror:
            return along(d, -2 * cosine, normal), 0
        if n == behind:
            return d, 0
        square = behind * behind - n * n * (1 - cosine * cosine)
        if square < 0:
            raise Fails('tir')
        other = mp.sqrt(square) if cosine > 0 else -mp.sqrt(square)
        return [(n * a + (other - n * cosine) * b) / behind for a, b in zip(d, normal)], 0

    def ideal(self, p, d, n, behind, distance):
        """Slopes n' w' = n w - x / f.  The path from an object point to its image is that of the ray through
        the vertex.  An object at infinity (None): from the wavefront through the vertex."""
        if self.mirror or d[2] < 0 or self.focal < 0:
            raise ValueError('only a positive ideal lens that is not a mirror, and light along +z')
        w = [n * a / d[2] for a in d[:2]]
        out = unit([(a - x / self.focal) / behind for a, x in zip(w, p)] + [mpf(1)])
        if distance is not None:
            point = [a - distance * b / n for a, b in zip(p, w)] + [-distance]
            vergence, vertex, here = 1 / self.focal - n / distance, [mpf(0)] * 3, [p[0], p[1], mpf(0)]

            def leg(a, b):
                way = [y - x for x, y in zip(a, b)]
                return mp.sign(way[2]) * mp.sqrt(dot(way, way))
            if abs(vergence) < mpf(10) ** -40:  # to the wavefront through the vertex
                return out, n * (leg(point, vertex) - leg(point, here)) + behind * dot(here, out)
            to = behind / vergence
            image = [-a * n * to / (behind * distance) for a in point[:2]] + [to]
            return out, (n * (leg(point, vertex) - leg(point, here))
                         + behind * (leg(vertex, image) - leg(here, image)))
        focus = [self.focal * a for a in w] + [self.focal * behind]
        from_vertex, from_here = focus, [a - b for a, b in zip(focus, p)]
        return out, (behind * mp.sqrt(dot(from_vertex, from_vertex)) - n * dot(p, d)
                     - behind * mp.sqrt(dot(from_here, from_here)))


# ------------------------------------------------------------------ lenses

class Field:
    def __init__(self, x, y, cx=0.0, cy=0.0):
        self.x, self.y, self.cx, self.cy = mpf(x), mpf(y), mpf(cx), mpf(cy)


class Lens:
    """surfaces; wavelengths; before: the index in front, at each wavelength; primary, stop: places from 0;
    object: the distance, or None; kind of fields as in the lens file; aim: pupil, stop, real_stop;
    size: (kind, number) of the pupil."""

    def __init__(self, name):
        self.name, self.units, self.surfaces, self.wavelengths, self.before = name, 'mm', [], [], []
        self.primary, self.stop, self.object, self.kind, self.aim = 0, 0, None, 'angle', 'pupil'
        self.size, self.pupil_at, self.fields, self.thicknesses = None, None, [Field(0, 0)], []

    def unfold(self):
        """Distances from vertex to vertex where only places are given: the axis goes from one to the next."""
        sign = 1
        for s, following in zip(self.surfaces, self.surfaces[1:]):
            sign = -sign if s.mirror else sign
            apart = [b - a for a, b in zip(s.vertex, following.vertex)]
            self.thicknesses.append(sign * mp.sqrt(dot(apart, apart)))

    def signed(self, wave):
        """The indices in front of the first surface and behind each, negative after a mirror."""
        out = [self.before[wave]]
        for s in self.surfaces:
            sign = -1 if (out[-1] < 0) != s.mirror else 1
            out.append(sign * s.index[wave])
        return out

    def paraxial(self, y, nu, first, last, wave):
        """A ray in front of surface `first`: its y and n u in front of surface `last`, not yet bent there."""
        n, t = self.signed(wave), self.thicknesses
        for i in range(first, last):
            nu -= y * self.power_of(i, n)
            y += t[i] * nu / n[i + 1]
        return y, nu

    def power_of(self, i, n):
        s = self.surfaces[i]
        if s.c is None:
            raise Fails('no curvature at a vertex')
        return (n[i + 1] - n[i]) * s.c if s.focal is None else 1 / s.focal

    def power(self, wave):
        return -self.paraxial(mpf(1), mpf(0), 0, len(self.surfaces) - 1, wave)[1]

    def entrance_pupil(self):
        """Its z from the first vertex: where rays to the stop's centre cross the axis in object space, unless said."""
        if self.pupil_at is not None:
            return self.pupil_at
        a, b = (self.paraxial(mpf(y), mpf(nu), 0, self.stop, self.primary)[0] for y, nu in ((1, 0), (0, 1)))
        return b * self.before[self.primary] / a  # y + z (-nu / n) with a y + b nu = 0

    def exit_pupil(self):
        """Its z from the image surface, or None at infinity."""
        n, last = self.signed(self.primary), len(self.surfaces) - 1
        y, nu = self.thicknesses[self.stop] / n[self.stop + 1], mpf(1)
        y, nu = self.paraxial(y, nu, self.stop + 1, last, self.primary)
        return None if abs(nu) < mpf(10) ** -40 else -y * n[last] / nu

    def marginal(self):
        """The paraxial ray of unit height in the entrance pupil: y and n u in front of the first surface."""
        z, n = self.entrance_pupil(), self.before[self.primary]
        u = 0 if self.object is None else 1 / (self.object + z)
        return 1 - z * u, n * u

    def pupil_radius(self):
        kind, value = self.size
        if kind == 'semi_diameter':
            return value
        if kind == 'f_number':
            return abs(1 / self.power(self.primary)) / (2 * value)
        if kind == 'object_na':
            return mp.tan(mp.asin(value / self.before[self.primary])) * (self.object + self.entrance_pupil())
        y, _ = self.paraxial(*self.marginal(), 0, self.stop, self.primary)
        return value / abs(y)  # the semi-diameter of the stop

    def object_of(self, i, wave):
        """The distance of the paraxial object in front of surface i, or None at infinity."""
        start = (mpf(1), mpf(0)) if self.object is None else (self.object, self.before[wave])
        y, nu = self.paraxial(*start, 0, i, wave)
        return y * abs(self.signed(wave)[i]) / nu if nu else None

    def magnification(self, wave):
        """Of an object at a distance."""
        _, nu = self.paraxial(self.object / self.before[wave], mpf(1), 0, len(self.surfaces) - 1, wave)
        return 1 / nu  # n u / (n' u')

    def working_f_number(self, wave):
        """1 / (2 n' u') of the marginal ray at a wavelength, or None."""
        y, nu = (self.pupil_radius() * x for x in self.marginal())
        nu *= self.before[wave] / self.before[self.primary]
        nu = self.paraxial(y, nu, 0, len(self.surfaces) - 1, wave)[1]
        return 1 / abs(2 * nu) if nu else None

    def length(self):
        """Along the axis, from the object or else the first vertex to the image."""
        return sum(map(abs, self.thicknesses)) + (self.object or 0)

    # -------------------------------------------------------------- real rays

    def trace(self, wave, o, d, opl=mpf(0), last=None):
        """A global ray: point and direction behind surface `last` (the image) in its frame, path, and
        whether no aperture clips it."""
        n, inside = self.before[wave], True
        for i, s in enumerate(self.surfaces):
            p = [a - b for a, b in zip(o, s.vertex)]
            way = d
            if not s.plain:
                p, way = back(s.turn, p), back(s.turn, d)
            t, sx, sy = s.met(p, way)
            p, opl = along(p, t, way), opl + n * t
            inside = inside and not s.clips(p[0], p[1])
            distance = None if s.focal is None else self.object_of(i, wave)
            way, more = s.bent(p, way, (sx, sy), n, s.index[wave], distance)
            opl += more
            if i == last:
                break
            o, d, n = along(o, t, d), way if s.plain else turned(s.turn, way), s.index[wave]
        return p, way, opl, inside


# ------------------------------------------------------------------ readers

def curvature(s, ending=''):
    if 'curvature' + ending in s:
        return float(s['curvature' + ending])
    radius = float(s.get('radius' + ending, math.inf))
    return 0.0 if math.isinf(radius) else 1.0 / radius


def yaml_surface(s, folder):
    if set(s) - SURFACE_KEYS:
        raise ValueError(f'unknown keys {set(s) - SURFACE_KEYS}')
    kind = s['type']
    a = [float(x) for x in s.get('coefficients', [])] if kind in ('even_asphere', 'toroidal') else []
    if kind not in ('plane', 'sphere', 'conic', 'even_asphere', 'toroidal', 'sum', *BY_ITSELF):
        raise ValueError(f'unknown type {kind}')
    swept = None
    if kind == 'toroidal':
        c = curvature(s, '_x')
        swept = 1 / mpf(c) if c else mpf(0)  # as the surface has it: the curvature, rounded once
    limit = float(s.get('semi_diameter', 0)) or math.inf
    terms = [s] if kind in BY_ITSELF else s.get('terms', ())
    out = Surface(curvature(s), float(s.get('conic', 0)), a, bool(s.get('mirror')), swept, terms, folder,
                  lambda x, y: x * x + y * y > limit * limit)
    out.c = None if kind in BY_ITSELF else out.c
    return out


def indices(value, waves):
    several = [mpf(float(x)) for x in (value if isinstance(value, list) else [value])]
    return several * waves if len(several) == 1 else several


def place(lens, rows):
    """Vertices by thicknesses, or by origins."""
    z = mpf(0)
    for s, row in zip(lens.surfaces, rows):
        turn = turn_of(row['tilt']) if 'tilt' in row else None
        if 'origin' in row:
            s.placed([mpf(float(x)) for x in row['origin']], turn)
        else:
            aside = [mpf(float(x)) for x in row.get('decenter', (0, 0, 0))]
            s.placed([aside[0], aside[1], z + aside[2]], turn)
            if row is not rows[-1]:
                lens.thicknesses.append(mpf(float(row['thickness'])))
                z += lens.thicknesses[-1]
    if not lens.thicknesses:
        lens.unfold()


def read_yaml(path):
    import yaml
    path = pathlib.Path(path)
    file, lens = yaml.safe_load(path.read_text()), Lens(path.stem)
    unknown = set(file) - set(LENS_KEYS.split())
    if unknown:
        raise ValueError(f'unknown keys {unknown}')
    lens.wavelengths, lens.units = [float(x) for x in file['wavelengths']], file.get('units', 'mm')
    lens.primary, lens.aim = file.get('primary', 1) - 1, file.get('aim', 'pupil')
    far = float(file.get('object', {}).get('distance', math.inf))
    lens.object = None if math.isinf(far) else mpf(far)
    lens.kind = file.get('field_type', 'angle')
    maps = file.get('vignetting', [{}] * len(file['fields']))
    lens.fields = [Field(*map(float, f if isinstance(f, list) else (0, f)), float(v.get('cx', 0)),
                         float(v.get('cy', 0))) for f, v in zip(file['fields'], maps)]
    (kind, value), = file['pupil'].items()
    lens.size = kind, mpf(float(value))
    before = lens.before = indices(file.get('object', {}).get('index', 1), len(lens.wavelengths))
    for i, row in enumerate(file['surfaces']):
        s = yaml_surface(row, path.parent)
        s.index = before = indices(row['index'], len(lens.wavelengths)) if 'index' in row else before
        lens.stop = i if row.get('stop') else lens.stop
        lens.surfaces.append(s)
    place(lens, file['surfaces'])
    return lens


KINDS = 'angle object_height paraxial_image_height real_image_height'.split()


def zmx_system(lens, data):
    """Pupil, fields and aiming: the records in front of the surfaces."""
    system = {}
    for line in zmx_oracle.text_of(data).replace('\r', '\n').split('\n'):
        words = line.split()
        if words:
            system.setdefault(words[0], words[1:])
    first = system['FTYP']
    lens.kind = KINDS[int(first[0])]
    lens.fields = [Field(float(x), float(y)) for x, y in
                   list(zip(system['XFLN'], system['YFLN']))[:int(first[2])]]
    lens.aim = ('pupil', 'stop', 'real_stop')[int(system['RAIM'][1]) if 'RAIM' in system else 0]
    if 'ENPD' in system:
        lens.size = 'semi_diameter', mpf(float(system['ENPD'][0])) / 2
    elif 'FNUM' in system and system['FNUM'][1] == '0':
        lens.size = 'f_number', mpf(float(system['FNUM'][0]))
    else:
        stops = [block for block in zmx_oracle.text_of(data).split('SURF ') if 'STOP' in block.split()]
        words = stops[0].split()
        lens.size = 'stop_size', mpf(float(words[words.index('DIAM') + 1]))


def read_zmx(path):
    path = pathlib.Path(path)
    data = path.read_bytes()
    file, lens = zmx_oracle.Lens(data), Lens(path.name)
    zmx_system(lens, data)
    lens.wavelengths, lens.primary = file.wavelengths, file.primary - 1
    lens.units = {'MM': 'mm', 'IN': 'in', 'METER': 'm'}[file.unit]
    far = file.surfaces[0].t
    lens.object = None if abs(far) >= zmx_oracle.INFINITE else mpf(far)
    lens.before = [mpf(str(file.index(0, w))) for w in lens.wavelengths]
    for i, (s, frame) in enumerate(zip(file.surfaces, file.frames)):
        if frame is None:  # a break
            if lens.surfaces:
                lens.thicknesses[-1] += mpf(s.t)
            continue
        if s.type not in ('STANDARD', 'EVENASPH', 'TOROIDAL', 'PARAXIAL'):
            raise ValueError(f'unknown type {s.type}')
        p = [s.parm.get(j, 0.0) for j in range(9)]
        swept = mpf(p[1]) if s.type == 'TOROIDAL' else None
        a = p[1:] if s.type == 'EVENASPH' else p[2:] if s.type == 'TOROIDAL' else []
        made = Surface(s.c, s.k, a, file.mirror(i), swept, clips=s.stops)
        made.focal = mpf(p[1]) if s.type == 'PARAXIAL' else None
        made.index = [mpf(str(file.index(i, w))) for w in lens.wavelengths]
        turn = [[mpf(str(x)) for x in row] for row in frame.turn]
        made.placed([mpf(str(x)) for x in frame.vertex], None if turn == IDENTITY else turn)
        lens.stop = len(lens.surfaces) if s.stop else lens.stop
        lens.surfaces.append(made)
        lens.thicknesses.append(mpf(s.t))
    del lens.thicknesses[-1]
    return lens
