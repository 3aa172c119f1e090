# SPDX-License-Identifier: MIT
"""What a .zmx file means, and where its rays go, at 50 digits: the oracle of test_zmx.py.

It shares nothing with the library.  A file is read into a list of surfaces; a ray goes from one to the next.

    local     the frame of a surface: vertex at the origin, light coming along +z
    global    the frame in which surface 1 is entered, before a break that stands there
    break     order 0: old = (dx, dy, 0) + Rx Ry Rz new;  else: old = Rz Ry Rx (new + (dx, dy, 0))

On a surface z = s(x, y) the crossing nearest to the vertex plane is found in doubles, by Newton's method from
that plane, and then to 50 digits by the same.  Numbers of the file are doubles, as a program reads them; all
that is made of them is exact to some 45 digits.
"""
import csv
import decimal
import math
import pathlib
import re

from dispersion import exact

D = decimal.Decimal
PI = D('3.14159265358979323846264338327950288419716939937510582097494')
GLASSES = pathlib.Path(__file__).resolve().parents[2] / 'data' / 'glass'
APERTURES = ('CLAP', 'FLAP', 'OBSC', 'SQAP', 'SQOB', 'ELAP', 'ELOB', 'SPID')
OF_SURFACES = set(APERTURES) | set('TYPE CURV DISZ CONI GLAS DIAM STOP PARM XDAT OBDC SCBD COMM UDAD'.split())
UNITS = {'MM': 1000, 'CM': 10000, 'IN': 25400, 'METER': 1000000}  # in micrometres
INFINITE = 1e10  # from here on a distance to the object is infinite


def text_of(data):
    if data[:2] in (b'\xff\xfe', b'\xfe\xff'):
        return data.decode('utf-16')
    try:
        return data.decode('utf-8-sig')
    except UnicodeDecodeError:
        return data.decode('latin-1')


def number(word):
    return math.inf if word.upper() == 'INFINITY' else float(word)


# ------------------------------------------------------------------ media

def table():
    """Each glass by its name in capitals: a list of (maker, formula, coefficients)."""
    if not table.all:
        for name in ('glasses.csv', 'older.csv'):
            lines = [line for line in (GLASSES / name).read_text().splitlines() if not line.startswith('#')]
            for row in csv.DictReader(lines):
                coefficients = [float(x) for x in row['coefficients'].split()]
                table.all.setdefault(row['glass'].upper(), []).append(
                    (row['maker'].upper(), int(row['formula']), coefficients))
    return table.all


table.all = {}


def catalogue(name, makers, um):
    several = table()[name.upper()]
    of_makers = [g for m in makers for g in several if g[0] == m.upper()]
    _, formula, coefficients = (of_makers or several)[0]
    n = exact(formula, coefficients, um)
    if isinstance(n, D):
        return n
    import mpmath
    return D(mpmath.nstr(n, 48))


def model(nd, vd, more, um):
    """nd, vd and the deviation of PgF from the normal line, in Buchdahl's coordinate."""
    nd, vd, more, um = (D(x) for x in (nd, vd, more, um))
    if not vd:
        return nd

    def omega(w):
        return (w - D('0.5875618')) / (1 + D('2.5') * (w - D('0.5875618')))
    f, c, g, w = (omega(w) for w in (D('0.4861327'), D('0.6562725'), D('0.4358343'), um))
    dispersion = (nd - 1) / vd
    partial = dispersion * (D('0.6438') - D('0.001682') * vd + more)
    # v1 (f - c) + v2 (f^2 - c^2) = nF - nC,  v1 (g - f) + v2 (g^2 - f^2) = ng - nF
    v2 = (partial / (g - f) - dispersion / (f - c)) / (g - c)
    v1 = dispersion / (f - c) - v2 * (f + c)
    return nd + v1 * w + v2 * w * w


# ------------------------------------------------------------------ frames

def cos_sin(degrees):
    degrees = D(degrees) % 360
    quarters = int((degrees / 90).to_integral_value(decimal.ROUND_HALF_EVEN))
    x = (degrees - 90 * quarters) * PI / 180
    c, s, term, n = D(0), D(0), D(1), 0
    while term and abs(term) > D('1e-55'):
        c, s = (c + term, s) if n % 2 == 0 else (c, s + term)
        n += 1
        term = term * x / n * (-1 if n % 2 == 0 else 1)
    return [(c, s), (-s, c), (-c, -s), (s, -c)][quarters % 4]


def times(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def turned(a, v):
    return [a[i][0] * v[0] + a[i][1] * v[1] + a[i][2] * v[2] for i in range(3)]


def back(a, v):
    return [a[0][i] * v[0] + a[1][i] * v[1] + a[2][i] * v[2] for i in range(3)]


def rotations(tilts):
    (cx, sx), (cy, sy), (cz, sz) = (cos_sin(t) for t in tilts)
    return ([[D(1), D(0), D(0)], [D(0), cx, -sx], [D(0), sx, cx]],
            [[cy, D(0), sy], [D(0), D(1), D(0)], [-sy, D(0), cy]],
            [[cz, -sz, D(0)], [sz, cz, D(0)], [D(0), D(0), D(1)]])


class Frame:
    def __init__(self, turn=None, vertex=None):
        self.turn = turn or [[D(i == j) for j in range(3)] for i in range(3)]
        self.vertex = vertex or [D(0)] * 3

    def moved(self, x, y, z):
        return Frame(self.turn, [v + s for v, s in zip(self.vertex, turned(self.turn, [D(x), D(y), D(z)]))])

    def broken(self, dx, dy, tilts, order):
        rx, ry, rz = rotations(tilts)
        if order == 0:
            place = self.moved(dx, dy, 0)
            return Frame(times(place.turn, times(times(rx, ry), rz)), place.vertex)
        return Frame(times(self.turn, times(times(rz, ry), rx)), self.vertex).moved(dx, dy, 0)


# ------------------------------------------------------------------ sags

def conic(c, k, r2, root):
    """The sag, and its derivative by r^2."""
    w = root(1 - (1 + k) * c * c * r2)
    return c * r2 / (1 + w), c / (2 * w)


def polynomial(count):
    """The exponents of XPOLYNOM: x, y, x^2, xy, y^2, x^3, x^2 y, ..."""
    order, out = 1, []
    while len(out) < count:
        out += [(order - j, j) for j in range(order + 1)]
        order += 1
    return out[:count]


def zernike_index(j, fringe):
    """n, m and whether it is the sine, of the j-th polynomial: by search over all in their order."""
    if fringe:  # groups of n + m = 2 g; in a group m falls, the cosine before the sine
        order = [(2 * g - m, m, sine) for g in range(40) for m in range(g, -1, -1)
                 for sine in ((False, True) if m else (False,))]
        return order[j - 1]
    place = 0  # Noll 1976: by n, then m rises; even numbers are cosines
    for n in range(60):
        for m in range(n % 2, n + 1, 2):
            for _ in range(2 if m else 1):
                place += 1
                if place == j:
                    return n, m, bool(m) and j % 2 == 1
    raise ValueError(j)


def zernike(j, fringe, x, y, zero):
    """Z_j and its slopes by x and y, from its factorials (Noll 1976, equation 2; Wyant and Creath 1992) and
    the powers of x + i y; Noll's have the mean square 1."""
    n, m, sine = zernike_index(j, fringe)
    one, r2 = zero + 1, x * x + y * y
    powers = [(one, zero)]  # of x + i y
    for _ in range(m):
        a, b = powers[-1]
        powers.append((a * x - b * y, a * y + b * x))
    part, d_part = zero, zero  # the rest is a polynomial in r^2
    for s in range((n - m) // 2 + 1):
        factor = (math.factorial(n - s) // math.factorial(s)) * one * (-1) ** s
        factor /= math.factorial((n + m) // 2 - s) * math.factorial((n - m) // 2 - s)
        e = (n - m) // 2 - s
        power = one
        for _ in range(e - 1):
            power *= r2
        part += factor * (power * r2 if e else one)
        d_part += factor * e * (power if e else zero)
    a, b = powers[m]
    c, d = powers[m - 1] if m else (zero, zero)
    turn, tx, ty = (b, m * d, m * c) if sine else (a, m * c, -m * d)
    scale = one if fringe else (one * (n + 1) * (2 if m else 1)) ** (one / 2)
    return (scale * part * turn, scale * (2 * x * d_part * turn + part * tx),
            scale * (2 * y * d_part * turn + part * ty))


def q_con(count, x, one):
    """The Jacobi polynomials P_m^(0, 4)(2 x - 1) and their derivatives by x, from their sum of products of
    binomial coefficients (Abramowitz and Stegun 22.3.1)."""
    out = []
    for m in range(count):
        value, slope = 0 * one, 0 * one
        for s in range(m + 1):
            c = math.comb(m, s) * math.comb(m + 4, m - s) * one
            up, down = x ** s if s else one, (x - 1) ** (m - s) if m - s else one
            value += c * down * up
            if s:
                slope += c * s * down * (x ** (s - 1) if s > 1 else one)
            if m - s:
                slope += c * (m - s) * up * ((x - 1) ** (m - s - 1) if m - s > 1 else one)
        out.append((value, slope))
    return out


def q_bfs(count, x, one):
    """Forbes 2010, Opt. Express 18, 19700, equations 2.8 to 2.12: the polynomials and their derivatives by x."""
    root = (lambda a: a.sqrt()) if isinstance(one, D) else math.sqrt
    f, g, h = [2 * one, root(19 * one) / 2], [-one / 2], []
    for m in range(2, count + 1):
        h.append(-m * (m - 1) / (2 * f[m - 2]))
        g.append(-(1 + g[m - 2] * h[m - 2]) / f[m - 1])
        f.append(root(m * (m + 1) + 3 - g[m - 1] ** 2 - h[m - 2] ** 2))
    p = [(2 * one, 0 * one), (6 - 8 * x, -8 * one)]
    q = [(one, 0 * one), ((13 - 16 * x) / root(19 * one), -16 / root(19 * one))]
    for m in range(2, count):
        p.append(((2 - 4 * x) * p[-1][0] - p[-2][0], (2 - 4 * x) * p[-1][1] - 4 * p[-1][0] - p[-2][1]))
        q.append(tuple((p[m][i] - g[m - 1] * q[m - 1][i] - h[m - 2] * q[m - 2][i]) / f[m] for i in (0, 1)))
    return q[:count]


class Shape:
    """A sag in floats or in decimals: value and slopes at (x, y)."""

    def __init__(self, s, number, kind=None):
        self.type, self.c, self.k = kind or s.type, number(s.c), number(s.k)
        self.p = [number(s.parm.get(i, 0.0)) for i in range(9)]
        self.root = math.sqrt if number is float else D.sqrt
        self.zero = number(0)
        if s.type == 'BICONICX':
            self.cx = 1 / self.p[1] if self.p[1] else self.zero
        if s.type == 'IRREGULA':
            self.norm = number(s.size)
            c, sn = cos_sin(s.parm.get(8, 0.0))
            self.turn = number(sn), number(c)
        if s.type in ('XASPHERE', 'XODDASPH', 'FZERNSAG', 'SZERNSAG', 'QED_TYPE'):
            first = 2 if s.type == 'QED_TYPE' else 1
            count = int(s.xdat.get(first, 0))
            self.norm, self.kind = number(s.xdat.get(first + 1, 0.0) or 1.0), s.xdat.get(1, 0)
            self.a = [number(s.xdat.get(first + 2 + i, 0.0)) for i in range(count)]
        if s.type == 'BINARY_3':
            self.a = [number(s.xdat.get(2 + i, 0.0)) for i in range(4 * int(s.xdat.get(1, 0)))]
        if s.type == 'XPOLYNOM':
            self.norm = number(s.xdat.get(2, 1.0))
            self.terms = [(a, b, number(s.xdat.get(3 + i, 0.0)))
                          for i, (a, b) in enumerate(polynomial(int(s.xdat.get(1, 0))))]

    def zone(self, c, k, a, r2):
        """A conic and powers of r: the sag and its derivative by r^2."""
        s, d = conic(c, k, r2, self.root)
        power = self.zero + 1
        for i, one in enumerate(a, 1):
            d += i * one * power
            power *= r2
            s += one * power
        return s, d

    def __call__(self, x, y):
        p, c, k, root = self.p, self.c, self.k, self.root
        r2 = x * x + y * y
        if self.type == 'BINARY_3':
            if r2 <= p[3] * p[3]:
                s, d = self.zone(c, k, self.a[0::4], r2)
                return s, 2 * d * x, 2 * d * y
            outer = (1 / p[1] if p[1] else self.zero), p[2], self.a[2::4]
            s, d = self.zone(*outer, r2)
            s += self.zone(c, k, self.a[0::4], p[3] * p[3])[0] - self.zone(*outer, p[3] * p[3])[0]
            return s, 2 * d * x, 2 * d * y
        if self.type in ('STANDARD', 'DGRATING', 'FZERNPHA', 'SZERNPHA', 'HOLOGRM1', 'HOLOGRM2'):
            s, d = conic(c, k, r2, root)
            return s, 2 * d * x, 2 * d * y
        if self.type in ('EVENASPH', 'FZERNSAG', 'SZERNSAG', 'BINARY_1', 'BINARY_2'):
            s, d = conic(c, k, r2, root)
            power = self.zero + 1
            for i in range(1, 9):
                d += i * p[i] * power
                power *= r2
                s += p[i] * power
            sx, sy = 2 * d * x, 2 * d * y
            for j, a in enumerate(self.a if self.type[1:] == 'ZERNSAG' else (), 1):
                v, vx, vy = zernike(j, self.type[0] == 'F', x / self.norm, y / self.norm, self.zero)
                s, sx, sy = s + a * v, sx + a * vx / self.norm, sy + a * vy / self.norm
            return s, sx, sy
        if self.type in ('XASPHERE', 'XODDASPH'):
            s, d = conic(c, k, r2, root)
            sx, sy, u = 2 * d * x, 2 * d * y, root(r2) / self.norm
            for i, a in enumerate(self.a, 1):
                e = 2 * i if self.type == 'XASPHERE' else i
                low = u ** (e - 1) if e > 1 else self.zero + 1
                s += a * low * u
                if r2:
                    over = a * e * low / (self.norm * root(r2))
                    sx, sy = sx + over * x, sy + over * y
            return s, sx, sy
        if self.type == 'QED_TYPE':
            s, d = conic(c, k, r2, root)
            norm2 = self.norm * self.norm
            u2 = r2 / norm2
            if self.kind == 1:
                q = q_con(len(self.a), u2, self.zero + 1)
                front, d_front = u2 * u2, 2 * u2
            else:
                # 1 over the cosine of the conic's normal, which is sqrt(w / (w + c^2 r^2)), and its slope by u^2
                w = 1 - (1 + k) * c * c * r2
                by = root(1 + c * c * r2 / w)
                q = q_bfs(len(self.a), u2, self.zero + 1)
                front = u2 * (1 - u2) * by
                d_front = (1 - 2 * u2) * by + u2 * (1 - u2) * c * c * norm2 / (2 * by * w * w)
            total, slope = (sum((a * one[i] for a, one in zip(self.a, q)), self.zero) for i in (0, 1))
            s += front * total
            d += (d_front * total + front * slope) / norm2
            return s, 2 * d * x, 2 * d * y
        if self.type == 'IRREGULA':
            s, d = conic(c, k, r2, root)
            sn, cs = self.turn
            z4, a2, c3, n2 = p[5], p[6], p[7], self.norm * self.norm
            q2, v = r2 / n2, (x * sn + y * cs) / self.norm
            s += z4 * q2 * q2 + a2 * v * v + c3 * q2 * v
            over, along = 2 * (2 * z4 * q2 + c3 * v) / n2, (2 * a2 * v + c3 * q2) / self.norm
            return s, (2 * d + over) * x + along * sn, (2 * d + over) * y + along * cs
        if self.type == 'ODDASPHE':
            s, d = conic(c, k, r2, root)
            r = root(r2)
            slope, power = self.zero, self.zero + 1
            for i in range(1, 9):
                slope += i * p[i] * power
                power *= r
                s += p[i] * power
            over = slope / r if r else self.zero
            return s, (2 * d + over) * x, (2 * d + over) * y
        if self.type == 'TOROIDAL':
            y2 = y * y
            g, d = conic(c, k, y2, root)
            power = self.zero + 1
            for i in range(2, 9):
                d += (i - 1) * p[i] * power
                power *= y2
                g += p[i] * power
            slope, radius = 2 * d * y, p[1]
            if not radius:
                return g, self.zero, slope
            q = root((radius - g) * (radius - g) - x * x)
            q = q if radius > 0 else -q
            return radius - q, x / q, (radius - g) * slope / q
        if self.type == 'BICONICX':
            cx, kx = self.cx, p[2]
            w = root(1 - (1 + kx) * cx * cx * x * x - (1 + k) * c * c * y * y)
            n = cx * x * x + c * y * y
            wx, wy = -(1 + kx) * cx * cx * x / w, -(1 + k) * c * c * y / w
            square = (1 + w) * (1 + w)
            return (n / (1 + w), (2 * cx * x * (1 + w) - n * wx) / square,
                    (2 * c * y * (1 + w) - n * wy) / square)
        if self.type == 'XPOLYNOM':
            s, d = conic(c, k, r2, root)
            sx, sy, u, v = 2 * d * x, 2 * d * y, x / self.norm, y / self.norm
            for a, b, factor in self.terms:
                s += factor * u ** a * v ** b if a and b else factor * (u ** a if a else v ** b)
                if a:
                    sx += factor * a * (u ** (a - 1) if a > 1 else 1) * (v ** b if b else 1) / self.norm
                if b:
                    sy += factor * b * (v ** (b - 1) if b > 1 else 1) * (u ** a if a else 1) / self.norm
            return s, sx, sy
        if self.type == 'TILTSURF':
            return p[1] * x + p[2] * y, p[1], p[2]
        if self.type in ('PARAXIAL', 'PARAX_XY', 'FRESNELS'):
            return self.zero, self.zero, self.zero
        raise ValueError(f'{self.type} has no sag')


# ------------------------------------------------------------------ phases

PHASES = ('DGRATING', 'BINARY_1', 'BINARY_2', 'BINARY_3', 'FZERNPHA', 'SZERNPHA', 'HOLOGRM1', 'HOLOGRM2')


def phase(s, unit, x, y, z):
    """The phase of a surface at a point, in waves and times its order, and its gradient.  unit: micrometres."""
    p, a = {i: D(v) for i, v in s.parm.items()}, {i: D(v) for i, v in s.xdat.items()}
    order, zero, r2 = p.get(0, D(0)), D(0), x * x + y * y

    def radial(terms, norm):
        """A sum of a (r/norm)^(2i), i from 1, over a turn; its derivative by r^2."""
        u = r2 / (norm * norm)
        values = [(t * u ** i, i * t * (u ** (i - 1) if i > 1 else 1) / (norm * norm)) for i, t in enumerate(terms, 1)]
        return [sum(column, zero) / (2 * PI) for column in zip(*values)] if values else [zero, zero]
    if s.type == 'DGRATING':
        lines = p.get(1, zero) * unit * p.get(2, zero)
        return lines * y, (zero, lines, zero)
    if s.type == 'BINARY_2':
        w, d = radial([a.get(3 + i, zero) for i in range(int(a.get(1, 0)))], a.get(2))
        return order * w, (2 * order * d * x, 2 * order * d * y, zero)
    if s.type == 'BINARY_3':
        terms = [a.get(2 + i, zero) for i in range(4 * int(a.get(1, 0)))]
        edge = p[3] * p[3]
        if r2 <= edge:
            w, d = radial(terms[1::4], p[3])
            return p.get(5, zero) * w, tuple(2 * p.get(5, zero) * d * b for b in (x, y)) + (zero,)
        w, d = radial(terms[3::4], p[4])
        kept, r2 = r2, edge  # the path is continuous there
        step = p.get(5, zero) * radial(terms[1::4], p[3])[0] - p.get(6, zero) * radial(terms[3::4], p[4])[0]
        return p.get(6, zero) * w + step, tuple(2 * p.get(6, zero) * d * b for b in (x, y)) + (zero,)
    if s.type == 'BINARY_1':
        w, wx, wy, n = zero, zero, zero, a.get(2)
        for i, (e, f) in enumerate(polynomial(int(a.get(1, 0)))):
            t = a.get(3 + i, zero) / (2 * PI)
            u, v = (x / n) ** e if e else D(1), (y / n) ** f if f else D(1)
            w += t * u * v
            wx += t * e * ((x / n) ** (e - 1) if e > 1 else 1) * v / n
            wy += t * f * ((y / n) ** (f - 1) if f > 1 else 1) * u / n
        return order * w, (order * wx, order * wy, zero)
    if s.type in ('FZERNPHA', 'SZERNPHA'):
        w, wx, wy, n = zero, zero, zero, a.get(2)
        for j in range(1, int(a.get(1, 0)) + 1):
            t = a.get(2 + j, zero)
            v, vx, vy = zernike(j, s.type[0] == 'F', x / n, y / n, zero)
            w, wx, wy = w + t * v, wx + t * vx / n, wy + t * vy / n
        return order * w, (order * wx, order * wy, zero)
    q, order = (x, y, z), p.get(8, zero)  # of a hologram; the phase at the vertex is taken off
    w, grad = zero, [zero] * 3
    for first, sign in ((1, 1), (4, -1)):
        point = [p.get(first + i, zero) for i in range(3)]
        sign = -1 if s.type == 'HOLOGRM2' else sign
        apart = [b - c for b, c in zip(q, point)]
        size = sum(b * b for b in apart).sqrt()
        w += sign * (size - sum(b * b for b in point).sqrt())
        grad = [g + sign * b / size for g, b in zip(grad, apart)]
    scale = order * unit / p[7]
    return scale * w, tuple(scale * g for g in grad)


# ------------------------------------------------------------------ apertures

def outside(keyword, v, x, y):
    """Does this record stop a ray at (x, y), seen from the aperture's own centre?"""
    if keyword in ('CLAP', 'FLAP', 'OBSC'):
        inside = v[0] <= math.hypot(x, y) <= v[1]
        return inside if keyword == 'OBSC' else not inside
    if keyword in ('SQAP', 'SQOB'):
        inside = abs(x) <= v[0] and abs(y) <= v[1]
        return inside if keyword == 'SQOB' else not inside
    if keyword in ('ELAP', 'ELOB'):
        inside = (x / v[0]) ** 2 + (y / v[1]) ** 2 <= 1
        return inside if keyword == 'ELOB' else not inside
    if keyword == 'SPID':  # arms of one width, at equal angles, the first along +x
        angles = [2 * math.pi * i / int(v[1]) for i in range(int(v[1]))]
        return any(x * math.cos(a) + y * math.sin(a) >= 0 and
                   abs(y * math.cos(a) - x * math.sin(a)) <= v[0] / 2 for a in angles)
    raise ValueError(keyword)


# ------------------------------------------------------------------ files

class Surface:
    def __init__(self):
        self.type, self.c, self.t, self.k, self.glass, self.stop = 'STANDARD', 0.0, 0.0, 0.0, None, False
        self.parm, self.xdat, self.apertures, self.centre = {}, {}, [], (0.0, 0.0)
        self.before = self.after = None
        self.size = 0.0

    def record(self, keyword, fields):
        if keyword == 'TYPE':
            self.type = fields[0]
        elif keyword in ('CURV', 'DISZ', 'CONI'):
            setattr(self, {'CURV': 'c', 'DISZ': 't', 'CONI': 'k'}[keyword], number(fields[0]))
        elif keyword == 'DIAM':
            self.size = number(fields[0])
        elif keyword == 'GLAS':
            self.glass = fields
        elif keyword == 'STOP':
            self.stop = True
        elif keyword in ('PARM', 'XDAT'):
            (self.parm if keyword == 'PARM' else self.xdat)[int(fields[0])] = number(fields[1])
        elif keyword == 'OBDC':
            self.centre = number(fields[0]), number(fields[1])
        elif keyword in APERTURES:
            self.apertures.append((keyword, [number(f) for f in fields[:2]]))
        elif keyword == 'SCBD':
            v = [number(f) for f in fields]
            moved = v[3], v[4], v[5:8], int(v[1])
            if v[0] == 1:
                self.before = moved
            else:
                self.after = moved

    def without(self, keyword):
        """Takes the apertures of this keyword away; how many there were."""
        before = len(self.apertures)
        self.apertures = [a for a in self.apertures if a[0] != keyword]
        return before - len(self.apertures)

    def stops(self, x, y):
        """True, False, or None where a hair decides."""
        x, y = float(x) - self.centre[0], float(y) - self.centre[1]
        hair = 1e-9 * (1 + abs(x) + abs(y))
        tries = {any(outside(k, v, x + dx, y + dy) for k, v in self.apertures)
                 for dx in (-hair, 0, hair) for dy in (-hair, 0, hair)}
        return tries.pop() if len(tries) == 1 else None


class Step:
    """A ray at a surface: the surface's numbers with and without breaks, the ray's fate, where, and how."""


def ideal(powers, n, behind, p, d, mirror):
    """The direction behind a PARAXIAL or PARAX_XY surface, of the powers in x and y.  What it adds to the path depends on all that is in front of it:
    analysis_oracle.py has that, for lenses with paraxial data."""
    w = [a / abs(d[2]) for a in d[:2]]
    out = [(n * a - x * power) / behind for a, x, power in zip(w, p, powers)]
    size = (1 + out[0] * out[0] + out[1] * out[1]).sqrt()
    return [a / size for a in [*out, D(-1 if (d[2] > 0) == mirror else 1)]]


class Lens:
    def __init__(self, data):
        system, self.surfaces = {}, []
        for line in re.split('\r\n|\r|\n', text_of(data)):
            words = line.split()
            if not words:
                continue
            if words[0] == 'SURF':
                self.surfaces.append(Surface())
            elif words[0] in OF_SURFACES and self.surfaces:
                self.surfaces[-1].record(words[0], words[1:])
            else:
                system.setdefault(words[0], []).append(words[1:])
        self.unit = system.get('UNIT', [['MM']])[0][0]
        self.makers = [m for fields in system.get('GCAT', []) for m in fields]
        self.primary = int(system.get('PWAV', [['1']])[0][0])
        count = int(system['FTYP'][0][3]) if 'FTYP' in system and len(system['FTYP'][0]) > 3 else None
        if 'WAVM' in system:
            waves = [number(f[1]) for f in sorted(system['WAVM'], key=lambda f: int(f[0]))]
        else:
            waves = [number(f) for f in system.get('WAVL', [['0.5876']])[0]]
        self.wavelengths = waves[:count]
        self.shapes, self.indices = {}, {}
        self.frames = self.placed()
        self.length = max([1e-300] + [sum(abs(s.t) for s in self.surfaces[1:-1])])

    def placed(self):
        """The frame of each surface from the first; of a break None."""
        frame, frames = Frame(), [None]
        for s in self.surfaces[1:]:
            if s.type == 'COORDBRK':
                p = [s.parm.get(i, 0.0) for i in range(7)]
                frame = frame.broken(p[1], p[2], p[3:6], p[6])
                frames.append(None)
            else:
                if s.before:
                    frame = frame.broken(*s.before)
                p = [s.parm.get(i, 0.0) for i in range(5)]
                alone = s.type == 'IRREGULA'  # decentred and tilted, and nothing behind it
                frames.append(frame.broken(p[1], p[2], (p[3], p[4], 0.0), 0) if alone else frame)
                if s.after:
                    frame = frame.broken(*s.after)
            if s is not self.surfaces[-1]:
                frame = frame.moved(0, 0, s.t)
        return frames

    def mirror(self, i):
        glass = self.surfaces[i].glass
        return bool(glass) and glass[0] == 'MIRROR'

    def index(self, i, um):
        """The index behind surface i."""
        if (i, um) not in self.indices:
            self.indices[i, um] = self.index_of(i, um)
        return self.indices[i, um]

    def index_of(self, i, um):
        s = self.surfaces[i]
        if s.type == 'COORDBRK' or self.mirror(i):
            return self.index(i - 1, um)
        if not s.glass:
            return D(1)
        name, code = s.glass[0], int(s.glass[1]) if len(s.glass) > 1 else 0
        values = [number(f) for f in s.glass[3:6]] + [0.0] * 3
        if code == 2:
            return self.index(int(s.glass[2]), um)
        if code == 1:
            return model(*values[:3], um)
        if re.fullmatch(r'\d{6}', name):
            return model(1 + float(name[:3]) / 1000, float(name[3:]) / 10, 0.0, um)
        return catalogue(name, self.makers, um)

    def conic_crossings(self, s, p, d):
        """Where a ray meets the conic c, k: both roots, the one nearer to the vertex plane first."""
        q, m = s.c * (1 + s.k), (d[0] * p[0] + d[1] * p[1])
        a = s.c * (d[0] ** 2 + d[1] ** 2) + q * d[2] ** 2
        b = s.c * m + q * p[2] * d[2] - d[2]
        e = s.c * (p[0] ** 2 + p[1] ** 2) + q * p[2] ** 2 - 2 * p[2]
        square = b * b - a * e
        if square < 0 or not a:
            return []
        w = -b - math.copysign(math.sqrt(square), b)
        several = [w / a] + ([e / w] if w else [])
        return sorted(several, key=lambda t: abs(p[2] + t * d[2]))

    def crossing(self, i, p, d):
        """t, and the slopes there, of a ray in the frame of surface i; None: no crossing."""
        s = self.surfaces[i]
        if i not in self.shapes:
            self.shapes[i] = Shape(s, float), Shape(s, D)
        rough, fine = self.shapes[i]
        px, py, pz = map(float, p)
        dx, dy, dz = map(float, d)
        start, scale = -pz / dz, self.length

        def newton(t):
            try:
                for _ in range(60):
                    z, sx, sy = rough(px + t * dx, py + t * dy)
                    step = (pz + t * dz - z) / (dz - sx * dx - sy * dy)
                    t -= step
                    if abs(step) < 1e-13 * scale:
                        return t
            except (ValueError, ZeroDivisionError):
                pass
            return None
        t = newton(start)
        if t is None:  # the ray meets the plane outside the sag's domain: from the conic's own crossings
            starts = self.conic_crossings(s, (px, py, pz), (dx, dy, dz))
            t = next((u for u in map(newton, starts) if u is not None), None)
        if t is None:
            return None
        # No other crossing between the vertex plane and this one: of one sign up to it.
        signs = set()
        for j in range(16):
            at = start + (t - start) * j / 16
            try:
                value = pz + at * dz - rough(px + at * dx, py + at * dy)[0]
            except ValueError:
                continue
            signs |= {value > 0} if abs(value) > 1e-11 * scale else set()
        if len(signs) > 1:
            raise AssertionError(f'surface {i}: not the crossing nearest to the vertex plane')
        t = D(t)
        for _ in range(8):
            x, y = p[0] + t * d[0], p[1] + t * d[1]
            z, sx, sy = fine(x, y)
            step = (p[2] + t * d[2] - z) / (d[2] - sx * d[0] - sy * d[1])
            t -= step
            if abs(step) < D('1e-22') * D(scale):
                break
        x, y = p[0] + t * d[0], p[1] + t * d[1]
        return t, fine(x, y)[1:]

    def trace(self, origin, direction, um=None, apertures=True):
        """The steps of a ray given by doubles in the global frame."""
        um = self.wavelengths[self.primary - 1] if um is None else um
        p, d = [D(x) for x in origin], [D(x) for x in direction]
        size = sum(x * x for x in d).sqrt()
        d = [x / size for x in d]
        opl, element, steps = D(0), 0, []
        n = self.index(0, um)
        for i, (s, frame) in enumerate(zip(self.surfaces, self.frames)):
            if frame is None:
                continue
            element += 1
            step = Step()
            step.surface, step.element, step.type, step.fate, step.hair = i, element, s.type, 'passed', False
            steps.append(step)
            here = back(frame.turn, [a - b for a, b in zip(p, frame.vertex)])
            there = back(frame.turn, d)
            met = self.crossing(i, here, there)
            if met is None:
                step.fate = 'missed'
                return steps
            t, (sx, sy) = met
            opl = None if opl is None else opl + n * t  # not known behind a PARAXIAL
            here = [a + t * b for a, b in zip(here, there)]
            p = [a + t * b for a, b in zip(p, d)]
            step.t, step.opl, step.local, step.everywhere = t, opl, here, p
            step.local_direction = step.direction = None
            if apertures:
                stops = s.stops(here[0], here[1])
                step.hair = stops is None
                if stops or step.hair:
                    step.fate = 'clipped'
                    return steps
            if s.type == 'FRESNELS':  # facets with the slopes of a sag, on a plane; of no known path
                _, sx, sy = Shape(s, D, 'EVENASPH')(here[0], here[1])
                opl = step.opl = None
            size = (1 + sx * sx + sy * sy).sqrt()
            normal = [-sx / size, -sy / size, 1 / size]
            cosine = sum(a * b for a, b in zip(there, normal))
            behind = self.index(i, um)
            if s.type in PHASES:
                unit = D(UNITS[self.unit])
                waves, grad = phase(s, unit, *here)
                length = D(um) / unit
                t = [n * a + length * g for a, g in zip(there, grad)]
                along = sum(a * b for a, b in zip(t, normal))
                t = [a - along * b for a, b in zip(t, normal)]
                square = behind * behind - sum(a * a for a in t)
                if square < 0:
                    step.fate = 'evanescent'
                    return steps
                opl = step.opl = None if opl is None else opl + waves * length
                root = square.sqrt() * (-1 if (cosine < 0) != self.mirror(i) else 1)
                there = [(a + root * b) / behind for a, b in zip(t, normal)]
            elif s.type in ('PARAXIAL', 'PARAX_XY'):
                powers = [D(s.parm.get(j, 0.0)) for j in (1, 2)] if s.type == 'PARAX_XY' else [1 / D(s.parm[1])] * 2
                there = ideal(powers, n, behind, here[:2], there, self.mirror(i))
                opl = step.opl = None
            elif self.mirror(i):
                there = [a - 2 * cosine * b for a, b in zip(there, normal)]
            elif behind != n:
                ratio = n / behind
                square = 1 - ratio * ratio * (1 - cosine * cosine)
                if square < 0:
                    step.fate = 'tir'
                    return steps
                root = square.sqrt() if cosine > 0 else -square.sqrt()
                there = [ratio * a + (root - ratio * cosine) * b for a, b in zip(there, normal)]
            n, d = behind, turned(frame.turn, there)
            step.local_direction, step.direction = there, d
        return steps
