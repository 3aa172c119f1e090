# SPDX-License-Identifier: MIT
"""A lens and all that is told of it, at 50 digits: the oracle of test_numbers.py.

It shares nothing with the library.  Sags, tilts and the reading of .zmx files are those of analysis_model.py.
Here are the other keys of a lens file, rays in decimals (which are some ten times as fast as mpmath), and

    ideal lens  slopes n' w' = n w - x / f.  The rays from a point O at the distance s in front, to its
                image I, n' / s' = 1 / f - n / s, have the same path as the one through the vertex V: a ray
                through p gets n |OV| + n' |VI| - n |Op| - n' |pI| more, with the sign of s and s'.  Where s
                is not told it is that of the paraxial image by all in front, at the ray's wavelength
    aiming      a ray is found by two numbers: where it meets the plane of the entrance pupil, or its slopes
                from a telecentric object point.  It meets the stop, in the stop's frame, at px, py times its
                radius.  The root is found in doubles by Newton's method.  With the same derivatives each
                further step in decimals gains some seven digits
    stop        its radius is the height of the paraxial marginal ray there, or (real_stop) of the real ray
                from the axis through the edge of the pupil, which no aperture stops

First-order data: y and n u from vertex to vertex, n negative after a mirror (Welford 1986, 3.2).
"""
import decimal
import math
import pathlib

import yaml
from mpmath import mp, mpf

import analysis_model as model
import zmx_oracle
from analysis_model import Fails, Sag, Departure

D = decimal.Decimal
decimal.getcontext().prec = 50
SURFACE = set('type radius curvature conic coefficients thickness index glass mirror stop semi_diameter '
              'apertures tilt decenter focal_length object_distance name draw_to'.split())
LENS = set('name units wavelengths wavelength_weights primary makers object pupil aim field_type fields '
           'afocal surfaces'.split())
MICROMETRES = {'mm': 1000, 'in': 25400, 'm': 1000000}


def dec(x):
    return D(mp.nstr(x, 58)) if isinstance(x, mpf) else D(x)


def root(x):
    if x < 0:
        raise Fails('beyond the equator')
    return math.sqrt(x) if isinstance(x, float) else x.sqrt()


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def unit(d):
    size = root(dot(d, d))
    return [a / size for a in d]


def along(p, t, d):
    return [a + t * b for a, b in zip(p, d)]


# ------------------------------------------------------------------ apertures

def outside_of(shape):
    """Whether a shape of a lens file clips at x, y."""
    ox, oy = shape.get('offset', (0, 0))
    turn, obscures, kind = math.radians(shape.get('turn', 0)), shape.get('obscures', False), shape['type']

    def clips(x, y):
        x, y = x - ox, y - oy
        x, y = x * math.cos(turn) + y * math.sin(turn), y * math.cos(turn) - x * math.sin(turn)
        if kind == 'circle':
            inside = math.hypot(x, y) <= shape['radius']
        elif kind == 'annulus':
            inside = shape['inner'] <= math.hypot(x, y) <= shape['outer']
        elif kind == 'ellipse':
            inside = (x / shape['half_width']) ** 2 + (y / shape['half_height']) ** 2 <= 1
        elif kind == 'rectangle':
            inside = abs(x) <= shape['half_width'] and abs(y) <= shape['half_height']
        elif kind == 'polygon':  # the sum of the angles of its edges, seen from the point
            points, total = shape['points'], 0.0
            for (ax, ay), (bx, by) in zip(points, points[1:] + points[:1]):
                ax, ay, bx, by = ax - x, ay - y, bx - x, by - y
                total += math.atan2(ax * by - ay * bx, ax * bx + ay * by)
            inside = abs(total) > math.pi
        else:
            raise ValueError(kind)
        return inside == obscures
    return clips


def clips_of(row):
    """True, False, or None where a hair decides."""
    several = [outside_of(a) for a in row.get('apertures', ())]
    if row.get('semi_diameter'):
        several.append(outside_of({'type': 'circle', 'radius': float(row['semi_diameter'])}))

    def clips(x, y):
        x, y = float(x), float(y)
        hair = 1e-9 * (1 + abs(x) + abs(y))
        near = -hair, 0, hair
        tries = {any(c(x + dx, y + dy) for c in several) for dx in near for dy in near}
        return tries.pop() if len(tries) == 1 else None
    return clips


# ------------------------------------------------------------------ readers

def medium(row, lens, before, makers):
    if 'index' in row:
        return model.indices(row['index'], len(lens.wavelengths))
    if row.get('glass') == 'air':
        return [mpf(1)] * len(lens.wavelengths)
    if 'glass' in row:
        return [mpf(str(zmx_oracle.catalogue(row['glass'], makers, um))) for um in lens.wavelengths]
    return before


def read_yaml(path):
    file, lens = yaml.safe_load(path.read_text()), model.Lens(path.name)
    for keys, known in ((file, LENS), *((s, SURFACE) for s in file['surfaces'])):
        if set(keys) - known:
            raise ValueError(f'unknown keys {set(keys) - known}')
    far = file.get('object', {})
    lens.wavelengths, lens.units = [float(x) for x in file['wavelengths']], file['units']
    lens.primary, lens.aim = file.get('primary', 1) - 1, file.get('aim', 'pupil')
    lens.weights = [float(x) for x in file.get('wavelength_weights', [1] * len(lens.wavelengths))]
    distance = float(far.get('distance', math.inf))
    lens.object = None if math.isinf(distance) else mpf(distance)
    lens.telecentric, lens.afocal = far.get('telecentric', False), file.get('afocal', False)
    lens.kind = file.get('field_type', 'angle')
    lens.fields = [model.Field(*map(float, f if isinstance(f, list) else (0, f))) for f in file['fields']]
    pupil = dict(file['pupil'])
    lens.pupil_at = mpf(float(pupil.pop('distance'))) if 'distance' in pupil else None
    (kind, value), = pupil.items()
    lens.size = kind, mpf(float(value))
    before = lens.before = medium(far, lens, [mpf(1)] * len(lens.wavelengths), [])
    z = mpf(0)
    for i, row in enumerate(file['surfaces']):
        a = [float(x) for x in row.get('coefficients', [])]
        s = model.Surface(model.curvature(row), float(row.get('conic', 0)), a, bool(row.get('mirror')))
        s.clips = clips_of(row)
        s.focal = mpf(float(row['focal_length'])) if row['type'] == 'ideal' else None
        s.far = float(row['object_distance']) if 'object_distance' in row else None
        s.index = before = medium(row, lens, before, file.get('makers', []))
        lens.stop = i if row.get('stop') else lens.stop
        x, y, dz = (mpf(float(v)) for v in row.get('decenter', (0, 0, 0)))
        s.placed([x, y, z + dz], model.turn_of(row['tilt']) if 'tilt' in row else None)
        lens.surfaces.append(s)
        if i + 1 < len(file['surfaces']):
            lens.thicknesses.append(mpf(float(row['thickness'])))
            z += lens.thicknesses[-1]
    return lens


def read_zmx(path):
    lens = model.read_zmx(path)
    text = zmx_oracle.text_of(path.read_bytes())
    flags = next(line.split()[1:] for line in text.splitlines() if line.startswith('FTYP'))
    lens.afocal = len(flags) > 6 and flags[6] == '1'
    lens.telecentric, lens.weights = flags[1] == '1', None  # weights of wavelengths: not read
    for s in lens.surfaces:
        s.far = None
    return lens


def read(path):
    lens = read_yaml(path) if path.suffix == '.yaml' else read_zmx(path)
    for s in lens.surfaces:
        rough = s.rough
        s.exact = Sag(rough.c, rough.k, rough.a, D, None)
        s.exact.swept = None if s.fine.swept is None else dec(s.fine.swept)
        s.at = {float: [float(x) for x in s.vertex], D: [dec(x) for x in s.vertex]}
        s.by = {n: [[n(str(x)) if n is float else dec(x) for x in row] for row in s.turn] for n in (float, D)}
        s.n = {float: [float(x) for x in s.index], D: [dec(x) for x in s.index]}
        s.f = {float: s.focal and float(s.focal), D: s.focal and dec(s.focal)}
    lens.front = {float: [float(x) for x in lens.before], D: [dec(x) for x in lens.before]}
    return lens


# ------------------------------------------------------------------ first-order data

class FirstOrder:
    """With the names of `sagitta info --format json`; None: there is none."""

    def __init__(self, lens, wave):
        self.lens, self.wave, last = lens, wave, len(lens.surfaces) - 1
        n = lens.signed(wave)
        n0, ni = n[0], n[last]

        def end(y, nu, first=0, to=last):
            return lens.paraxial(mpf(y), mpf(nu), first, to, wave)
        a, c = end(1, 0)
        b, d = end(0, 1)
        power = self.power = -c if abs(c) > mpf(10) ** -40 else None
        out = self.data = dict.fromkeys('efl efl_image bfd ffd focus f_number front_principal rear_principal '
                                        'front_nodal rear_nodal'.split())
        if power:
            out['efl'], out['efl_image'] = 1 / power, abs(ni) / power
            y_last = end(1, 0, 0, last)[0] + lens.thicknesses[-1] * power / ni
            out['bfd'], out['focus'], out['ffd'] = y_last * ni / power, a * ni / power, -d * n0 / power
            out['front_principal'], out['rear_principal'] = out['ffd'] + n0 / power, out['focus'] - ni / power
            out['front_nodal'], out['rear_nodal'] = out['ffd'] + ni / power, out['focus'] - n0 / power
        out['image'], out['magnification'] = out['focus'], None
        if lens.object is not None:
            y, nu = end(lens.object / n0, 1)
            out['image'] = -y * ni / nu if abs(nu) > mpf(10) ** -40 else None
            out['magnification'] = 1 / nu if abs(nu) > mpf(10) ** -40 else None
        petzval = sum(lens.power_of(i, n) / (n[i] * n[i + 1]) for i in range(last))
        out['petzval_radius'] = -1 / (ni * petzval) if petzval else None
        self.pupils(end, n, last)

    def pupils(self, end, n, last):
        """The marginal ray is the same at every wavelength, in front of the lens."""
        lens, out, stop = self.lens, self.data, self.lens.stop
        n0, ni, primary = n[0], n[last], lens.primary
        if lens.telecentric:
            u = mp.tan(mp.asin(lens.size[1] / lens.before[primary]))
            out['entrance_pupil'], self.radius, y, nu = (None, None), None, lens.object * u, n0 * u
        else:
            out['entrance_pupil'] = lens.entrance_pupil(), lens.pupil_radius()  # of the primary wavelength
            y, nu = (lens.pupil_radius() * v for v in lens.marginal())
            nu *= n0 / lens.before[primary]
            self.radius = lens.pupil_radius()
        if not lens.telecentric:  # the slope of the ray through the centre of the pupil, behind by in front
            z = lens.entrance_pupil()
            self.angular = end(-z, n0)[1] / ni
        out['stop_radius'] = abs(end(y, nu, 0, stop)[0])
        if lens.telecentric:  # the height at the image of the paraxial chief ray, for a slope or a height of 1
            self.here = end(1, 0)[0]
        elif lens.object is None:
            self.here = end(-lens.entrance_pupil(), n0)[0]
        else:
            u = -1 / (lens.object + lens.entrance_pupil())
            self.here = end(1 + lens.object * u, n0 * u)[0]
        y, nu_end = end(y, nu)
        out['f_number_working'] = 1 / abs(2 * nu_end) if abs(nu_end) > mpf(10) ** -40 else None
        if self.power and self.radius:
            out['f_number'] = abs(1 / self.power) / (2 * self.radius)
        yc, nuc = end(lens.thicknesses[stop] / n[stop + 1], 1, stop + 1) if stop < last else (None, None)
        if stop == last or abs(nuc) < mpf(10) ** -40:
            out['exit_pupil'] = None, None
        else:
            z = -yc * ni / nuc
            out['exit_pupil'] = z, abs(y + z * nu_end / ni)


# ------------------------------------------------------------------ rays

class Hit:
    """p, d: point and direction behind, in the element's frame; before: the direction in front; t, opl;
    condition: 1 / cos of the angle of incidence; clips: True, False, or None where a hair decides."""


class Rays:
    """The rays of a lens at one of its wavelengths, in floats or decimals."""

    def __init__(self, lens, wave):
        self.lens, self.wave, self.conjugates = lens, wave, {}
        self.conjugate = [self.conjugate_of(i) for i in range(len(lens.surfaces))]

    def conjugate_of(self, i):
        """The distance of the object of an ideal lens, or None: infinite."""
        lens, s = self.lens, self.lens.surfaces[i]
        if s.focal is None or s.far is not None:
            return None if s.focal is None or math.isinf(s.far) else mpf(s.far)
        y, nu = (mpf(1), mpf(0)) if lens.object is None else (lens.object / lens.before[self.wave], mpf(1))
        y, nu = lens.paraxial(y, nu, 0, i, self.wave)
        n = lens.signed(self.wave)[i]
        return None if abs(nu) < mpf(10) ** -40 else y * n / nu

    def met(self, s, p, d, number):
        near, way = [float(x) for x in p], [float(x) for x in d]
        for start in s.starts(near, way):
            try:
                t = self.newton(s, start, near, way)
                break
            except (Fails, ZeroDivisionError, OverflowError):
                pass
        else:
            raise Fails('missed')
        if number is float:
            return t, *s.rough(near[0] + t * way[0], near[1] + t * way[1])[1:]
        t = D(t)
        for _ in range(8):
            z, sx, sy = s.exact(p[0] + t * d[0], p[1] + t * d[1])
            step = (p[2] + t * d[2] - z) / (d[2] - sx * d[0] - sy * d[1])
            t -= step
            if abs(step) < D('1e-26') * (1 + abs(t)):
                return t, *s.exact(p[0] + t * d[0], p[1] + t * d[1])[1:]
        raise Fails('no root')

    @staticmethod
    def newton(s, t, p, d):
        for i in range(60):
            z, sx, sy = s.rough(p[0] + t * d[0], p[1] + t * d[1])
            step = (p[2] + t * d[2] - z) / (d[2] - sx * d[0] - sy * d[1])
            t -= step
            if abs(step) <= 1e-13 * (abs(t) + abs(p[2]) + 1e-9) or (i > 30 and abs(step) < 1e-9 * abs(t)):
                return t
        raise Fails('no root')

    def trace(self, o, d, number, last=None, opl=0):
        """The hits, and what ended the ray before the last surface (None: nothing).  Nothing clips."""
        lens, n, hits = self.lens, self.lens.front[number][self.wave], []
        opl = number(opl)
        for i, s in enumerate(lens.surfaces):
            p = [a - b for a, b in zip(o, s.at[number])]
            way, by = d, s.by[number]
            if not s.plain:
                p, way = model.back(by, p), model.back(by, d)
            try:
                t, sx, sy = self.met(s, p, way, number)
            except Fails:
                return hits, 'missed'
            hit = Hit()
            hits.append(hit)
            normal = unit([-sx, -sy, number(1)])
            cosine = dot(way, normal)
            hit.p, hit.t, hit.before = along(p, t, way), t, way
            hit.condition = 1 / abs(cosine)
            hit.clips = s.clips(hit.p[0], hit.p[1]) if number is D else False
            hit.t += opl / n if i == 0 else 0  # from the start of the path
            opl += n * t
            behind = s.n[number][self.wave]
            if s.focal is not None:
                way, more = self.ideal(i, s, hit.p, way, n, behind, number)
                opl += more
            elif s.mirror:
                way = along(way, -2 * cosine, normal)
            elif n != behind:
                square = behind * behind - n * n * (1 - cosine * cosine)
                if square < 0:
                    hit.opl = opl
                    return hits, 'tir'
                other = root(square) if cosine > 0 else -root(square)
                way = [(n * a + (other - n * cosine) * b) / behind for a, b in zip(way, normal)]
            hit.d, hit.opl = way, opl
            if i == last:
                break
            hit.where = o = along(o, t, d)
            d, n = way if s.plain else model.turned(by, way), behind
            hit.everywhere = d
        return hits, None

    def ideal(self, i, s, p, d, n, behind, number):
        """The direction behind, and what is added to the path."""
        if s.mirror or d[2] < 0:
            raise ValueError('only light along +z')
        f, far = s.f[number], self.conjugate[i]
        w = [a / d[2] for a in d[:2]]
        out = unit([(n * a - x / f) / behind for a, x in zip(w, p)] + [number(1)])
        if number is float:
            return out, 0.0
        more = D(0)
        if far is None:
            more -= n * dot(p, d)          # from the plane wavefront through the vertex
        else:
            far = dec(far)
            source = [a - far * b for a, b in zip(p, w)] + [-far]
            sign = 1 if far > 0 else -1
            there = [a - b for a, b in zip(p, source)]
            more += sign * n * (root(dot(source, source)) - root(dot(there, there)))
            w = [-a / far for a in source[:2]]  # of the ray through the vertex
        bent = 1 / f - (n / far if far is not None else 0)  # n' / s'
        if abs(bent) < D('1e-40'):
            return out, more + behind * dot(p, out)  # up to the plane wavefront through the vertex
        s2 = behind / bent
        image = [s2 * n * a / behind for a in w] + [s2]
        there = [a - b for a, b in zip(image, p)]
        sign = 1 if s2 > 0 else -1
        return out, more + sign * behind * (root(dot(image, image)) - root(dot(there, there)))


def inverse(m):
    """Of a small matrix of floats, by Gauss and Jordan."""
    n = len(m)
    rows = [list(row) + [float(i == j) for j in range(n)] for i, row in enumerate(m)]
    for i in range(n):
        best = max(range(i, n), key=lambda j: abs(rows[j][i]))
        rows[i], rows[best] = rows[best], rows[i]
        pivot = rows[i][i]
        rows[i] = [a / pivot for a in rows[i]]
        for j in range(n):
            if j != i:
                rows[j] = [a - rows[j][i] * b for a, b in zip(rows[j], rows[i])]
    return [row[n:] for row in rows]


def solve(miss, start, scale):
    """The root of several functions of as many unknowns: miss(x, number) is a list.  In floats, damped; then
    in decimals with the same derivatives."""
    def size(f):
        return math.sqrt(sum(a * a for a in f))
    x, n = [float(a) for a in start], len(start)
    f = miss(x, float)
    turns = 0
    for turns in range(60):
        rows = []
        for j in range(n):
            h = 1e-5 * scale[j]
            ends = [miss([a + s * h * (i == j) for i, a in enumerate(x)], float) for s in (1, -1)]
            rows.append([(a - b) / (2 * h) for a, b in zip(*ends)])
        try:
            back = inverse([list(column) for column in zip(*rows)])
        except ZeroDivisionError:
            raise Fails('singular') from None
        step, part = [sum(a * b for a, b in zip(row, f)) for row in back], 1.0
        while part > 1e-4:
            y = [a - part * b for a, b in zip(x, step)]
            try:
                g = miss(y, float)
                if size(g) < size(f) or part * max(abs(b) / s for b, s in zip(step, scale)) < 1e-11:
                    break
            except Fails:
                pass
            part /= 2
        else:
            raise Fails('stuck')
        x, f = y, g
        if max(abs(b) / s for b, s in zip(step, scale)) < 1e-9:
            break
    else:
        raise Fails('no convergence')
    x = [D(a) for a in x]
    back = [[D(a) for a in row] for row in back]
    for _ in range(14):
        f = miss(x, D)
        step = [dot_all(row, f) for row in back]
        x = [a - b for a, b in zip(x, step)]
        if max(abs(b) / D(s) for b, s in zip(step, scale)) < D('1e-34'):
            return x
    raise Fails('no convergence in decimals')


def dot_all(a, b):
    return sum(x * y for x, y in zip(a, b))


class Beam:
    """The rays of a field (x, y, kind) at one wavelength."""

    def __init__(self, lens, field, wave, kind=None, aim=None):
        self.lens, self.field, self.wave, self.kind = lens, field, wave, kind or lens.kind
        self.rays, self.n = Rays(lens, wave), lens.front
        self.aimed = (aim or lens.aim) != 'pupil'
        first = FirstOrder(lens, lens.primary)
        self.first = first
        if lens.telecentric:
            self.radius, self.pupil = mp.tan(mp.asin(lens.size[1] / lens.before[lens.primary])), mpf(0)
        else:
            self.pupil, self.radius = first.data['entrance_pupil']
        self.z = {float: float(self.pupil), D: dec(self.pupil)}
        self.r = {float: float(self.radius), D: dec(self.radius)}
        self.start = {}
        self.set_start(self.paraxial_start())
        if self.aimed:
            height = first.data['stop_radius'] if (aim or lens.aim) == 'stop' else self.real_height()
            self.stop = {float: float(height), D: dec(height)}
        if self.kind == 'real_image_height' and (field.x or field.y):
            self.find_real_height()
        self.known, self.chief_at = {}, None

    def set_start(self, start):
        """The slopes of the field, or x, y of the object point."""
        self.start = {float: [float(a) for a in start], D: [dec(a) for a in start]}

    def paraxial_start(self):
        lens, f = self.lens, self.field
        if self.kind == 'angle':
            slopes = [mp.tan(a * mp.pi / 180) for a in (f.x, f.y)]
            return slopes if lens.object is None else [-a * (lens.object + self.pupil) for a in slopes]
        if self.kind == 'object_height':
            return [f.x, f.y]
        p = lens.primary
        scale = lens.power(p) / lens.before[p] if lens.object is None else 1 / lens.magnification(p)
        return [f.x * scale, f.y * scale]

    def launch(self, u, v, number, start=None):
        """Start, direction and path of the ray through u, v: lengths in the pupil, or slopes."""
        lens, start = self.lens, start or self.start[number]
        one = number(1)
        if lens.object is None:
            d = unit([*start, one])
            return [u, v, self.z[number]], d, self.n[number][self.wave] * (d[0] * u + d[1] * v)
        o = [*start, -number(str(lens.object)) if number is float else -dec(lens.object)]
        if lens.telecentric:
            return o, unit([u, v, one]), number(0)
        d = unit([u - o[0], v - o[1], self.z[number] - o[2]])
        return o, d if d[2] > 0 else [-a for a in d], number(0)

    def real_height(self):
        """Of the marginal ray from the axis at the stop, at the primary wavelength."""
        field, rays = self.start, Rays(self.lens, self.lens.primary)
        self.set_start([mpf(0), mpf(0)])
        o, d, _ = self.launch(D(0), self.r[D], D)
        self.start = field
        hits, why = rays.trace(o, d, D, self.lens.stop)
        if why:
            raise Fails('the marginal ray does not reach the stop')
        return mpf(str(abs(hits[-1].p[1])))

    def miss_of(self, px, py, rays=None, start=None):
        """How far a launch ray is from px, py of the stop, in its radii."""
        def miss(x, number):
            o, d, _ = self.launch(x[0], x[1], number, start and start(x, number))
            hits, why = (rays or self.rays).trace(o, d, number, self.lens.stop)
            if len(hits) <= self.lens.stop:
                raise Fails(why)
            p, r = hits[-1].p, self.stop[number]
            return [p[0] / r - number(px), p[1] / r - number(py)]
        return miss

    def find_real_height(self):
        rays = Rays(self.lens, self.lens.primary)

        def start(x, number):
            return x[2:]

        def miss(x, number):
            out = self.miss_of(0, 0, rays, start)(x, number) if self.aimed else list(x[:2])
            o, d, _ = self.launch(x[0], x[1], number, x[2:])
            hits, why = rays.trace(o, d, number)
            if why:
                raise Fails(why)
            return out + [a - number(str(b)) for a, b in zip(hits[-1].p, (self.field.x, self.field.y))]
        r = self.r[float]
        size = max(map(abs, self.start[float]))
        x = solve(miss, [0, 0, *self.start[float]], [r, r, size, size])
        self.start = {float: [float(a) for a in x[2:]], D: x[2:]}

    def place(self, px, py):
        """u, v of a point of the pupil."""
        if not self.aimed:
            return D(px) * self.r[D], D(py) * self.r[D]
        if (px, py) not in self.known:
            if not self.known and (px or py):
                self.place(0.0, 0.0)
            self.known[px, py] = self.search(px, py)
        return self.known[px, py]

    def search(self, px, py):
        r = self.r[float]
        if self.known:
            near = min(self.known, key=lambda p: (p[0] - px) ** 2 + (p[1] - py) ** 2)
            starts = [self.known[near]]
        else:  # in rings about the axis, and about the vertex of the stop
            stop = self.lens.surfaces[self.lens.stop].at[float]
            starts = [(0, 0)] + ([] if self.lens.telecentric else [(stop[0], stop[1])])
            starts += [(k * r / 2 * math.cos(a), k * r / 2 * math.sin(a)) for k in range(1, 31)
                       for a in [i * math.pi / 4 for i in range(8)]]
        for start in starts:
            try:
                return solve(self.miss_of(px, py), start, [r, r])
            except (Fails, ZeroDivisionError, OverflowError):
                pass
        raise Fails('none')

    def hits(self, px, py):
        u, v = self.place(px, py)
        o, d, opl = self.launch(u, v, D)
        return self.rays.trace(o, d, D, opl=opl)

    def beside(self, du, dv):
        """The last hit of a ray beside the chief ray, by so many pupil radii."""
        u, v = self.place(0.0, 0.0)
        hits, why = self.rays.trace(*self.launch(u + du * self.r[D], v + dv * self.r[D], D)[:2], D)
        if why:
            raise Fails(why)
        return hits[-1]

    def chief(self):
        if self.chief_at is None:
            hits, why = self.hits(0.0, 0.0)
            if why:
                raise Fails(why)
            self.chief_at = hits[-1]
        return self.chief_at

    # -------------------------------------------------------------- what is told

    def opd(self, end, kind='sphere'):
        """In waves; None: the ray misses the sphere."""
        lens, chief = self.lens, self.chief()
        n, z = lens.surfaces[-1].n[D][self.wave], self.first.data['exit_pupil'][0]
        apart = [a - b for a, b in zip(end.p, chief.p)]
        if kind == 'plane':
            more = -dot(apart, chief.before) / dot(end.before, chief.before)
        elif kind == 'foot' or z is None:
            more = -dot(apart, end.before)
        else:
            z = dec(z)
            to = [chief.p[0], chief.p[1], chief.p[2] - z]
            r = root(dot(to, to)) * (1 if -z * chief.before[2] > 0 else -1)
            b = dot(apart, end.before)
            square = b * b - dot(apart, apart) + r * r
            if square < 0:
                return None
            more = -b - (root(square) if r > 0 else -root(square)) + r
        # the image surface bends no light here
        return (end.opl - chief.opl + n * more) * MICROMETRES[lens.units] / D(lens.wavelengths[self.wave])

    def along_field(self):
        x, y = self.field.x, self.field.y
        if self.kind == 'angle':
            x, y = (mp.tan(a * mp.pi / 180) for a in (x, y))
        size = mp.sqrt(x * x + y * y)
        return (dec(x / size), dec(y / size)) if size else (D(0), D(1))

    def focus(self, u):
        """Along z of the image, where rays beside the chief ray in the section u meet it.  None: nowhere."""
        h = D('1e-16')
        a, b = self.beside(h * u[0], h * u[1]), self.beside(-h * u[0], -h * u[1])
        place = sum(u[i] * (a.p[i] - b.p[i]) for i in (0, 1))
        slope = sum(u[i] * (a.before[i] / a.before[2] - b.before[i] / b.before[2]) for i in (0, 1))
        return None if abs(slope) < D('1e-36') else -place / slope

    def parabasal(self, axis):
        """Of the chief ray in a section that is a plane of symmetry, or across it: focal length, and from
        the image along the ray to the focus of parallel rays, and to the image of the object.  None: at
        infinity."""
        (u, v), h = self.place(0.0, 0.0), D('1e-16')
        o, d, _ = self.launch(u, v, D)
        across = [D(1), D(0), D(0)] if axis == 'x' else unit([D(0), d[2], -d[1]])

        def last(o, d):
            hits, why = self.rays.trace(o, unit(d), D)
            if why:
                raise Fails(why)
            return hits[-1]

        def differences(ends):
            a, b = ends
            out = unit([x + y for x, y in zip(a.before, b.before)])
            e = [D(1), D(0), D(0)] if axis == 'x' else unit([D(0), out[2], -out[1]])
            place = [(x - y) / (2 * h) for x, y in zip(a.p, b.p)]
            turn = [(x - y) / (2 * h) for x, y in zip(a.before, b.before)]
            return dot(place, e), dot(turn, e)
        p, t = differences([last(along(o, s * h, across), d) for s in (1, -1)])
        behind = self.lens.surfaces[-1].n[D][self.wave]
        if abs(t) < D('1e-25'):
            return None, None, None
        efl, focus = -1 / (behind * t), -p / t
        if self.lens.object is None:
            return efl, focus, focus
        p, t = differences([last(o, along(d, s * h, across)) for s in (1, -1)])
        return efl, focus, None if abs(t) < D('1e-25') else -p / t

    def ideal_height(self, kind):
        lens, wave = self.lens, self.wave
        u, first, here = self.along_field(), FirstOrder(lens, wave), kind.endswith('-surface')
        along_u = self.start[D][0] * u[0] + self.start[D][1] * u[1]
        if lens.object is not None:
            m = first.data['magnification']
            return None if m is None else dec(first.here if here else m) * along_u
        if not first.power:
            return None
        slope = dec(mp.atan(mpf(str(along_u)))) if kind.startswith('theta') else along_u
        return slope * dec(first.here if here else lens.before[wave] / first.power)


def lenses(data):
    return sorted([*(data / 'lenses').glob('*.*'), *(data / 'zmx').glob('*.zmx')])
