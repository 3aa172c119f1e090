# SPDX-License-Identifier: MIT
"""Rays through the lenses of seq_lenses.py at 50 digits, by mpmath: the frames of CODE V, said anew.

A surface's frame is old = (XDE, YDE, ZDE) + R new, R = Rx(-ADE) Ry(-BDE) Rz(CDE) of right-handed turns: alpha and
beta are left-handed.  Behind a plain surface the thickness is along the new z; with DAR the old frame comes back;
with BEN the turn is done again; with REV the surface stands in the old frame, and behind it new = D + R old.
"""
from mpmath import mp, mpf, matrix, eye, sqrt, sin, cos, pi

mp.dps = 50
WAVE = mpf('0.5875618')   # micrometres
SERIES = [mpf(x) for x in ('2.2', '-0.01', '0.012', '2e-4', '-1e-5', '1e-6')]


def number(text):
    """What a program reads: a double; 1/50 is exact."""
    if isinstance(text, str) and '/' in text:
        above, below = text.split('/')
        return mpf(int(above)) / mpf(int(below))
    return mpf(float(text))


def turn(axis, degrees):
    a = number(degrees) * pi / 180
    i, j = [(1, 2), (2, 0), (0, 1)][axis]
    r = eye(3)
    r[i, i], r[i, j], r[j, i], r[j, j] = cos(a), -sin(a), sin(a), cos(a)
    return r


def minus(x):
    return -number(x)


def frames(surfaces):
    """Vertex and axes of each."""
    p, r, out = matrix([0, 0, 0]), eye(3), []
    for s in surfaces:
        m = s['moves']
        d = matrix([number(x) for x in m[:3]])
        q = turn(0, minus(m[3])) * turn(1, minus(m[4])) * turn(2, m[5])
        if s['kind'] == 'REV':
            out.append((p, r))
            p, r = p - r * q.T * d, r * q.T
        else:
            out.append((p + r * d, r * q))
            if s['kind'] == 'plain':
                p, r = out[-1]
            elif s['kind'] == 'BEN':
                p, r = out[-1][0], r * q * q
        p = p + r * matrix([0, 0, number(s['t'])])
    return out


def sag(s, x, y):
    """z, dz/dx, dz/dy"""
    c, k, r2 = number(s['c']), number(s['k']), x * x + y * y
    root = sqrt(1 - (1 + k) * c * c * r2)
    z, slope = c * r2 / (1 + root), c / root   # slope: dz/dr / r
    for power, a in s['powers'].items():
        z += number(a) * r2 ** (power // 2)
        slope += power * number(a) * r2 ** (power // 2 - 1)
    return z, slope * x, slope * y


def index(n):
    if n != 'series':
        return mpf(float(n))
    l = WAVE ** 2
    return sqrt(SERIES[0] + SERIES[1] * l + sum(SERIES[i] * l ** (1 - i) for i in range(2, 6)))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def trace(surfaces, origin, direction):
    """At each surface the point and the direction behind it, global, and the sum of the optical paths."""
    o, d = matrix([mpf(x) for x in origin]), matrix([mpf(x) for x in direction])
    d = d / sqrt(dot(d, d))
    n, path, out = mpf(1), mpf(0), []
    for s, (vertex, axes) in zip(surfaces, frames(surfaces)):
        a, b = axes.T * (o - vertex), axes.T * d
        t = -a[2] / b[2]
        for _ in range(60):
            p = a + t * b
            z, zx, zy = sag(s, p[0], p[1])
            step = (p[2] - z) / (b[2] - zx * b[0] - zy * b[1])
            t -= step
            if abs(step) < mpf(10) ** -45:
                break
        p = a + t * b
        normal = matrix([-zx, -zy, 1]) / sqrt(1 + zx * zx + zy * zy)
        path += n * t
        behind = n if s['n'] == 'mirror' else index(s['n'])
        # n d changes along the normal, and by the gradient of the phase's path along the surface
        push = sum((e * number(w) * (p[0] ** 2 + p[1] ** 2) ** (e // 2 - 1) for e, w in s['waves'].items()), mpf(0))
        gradient = push * matrix([p[0], p[1], 0])
        path += sum((number(w) * (p[0] ** 2 + p[1] ** 2) ** (e // 2) for e, w in s['waves'].items()), mpf(0))
        v = n * b + gradient
        v = v - dot(v, normal) * normal
        along = sqrt(behind * behind - dot(v, v))
        same = (dot(b, normal) > 0) != (s['n'] == 'mirror')
        b = (v + (along if same else -along) * normal) / behind
        n = behind
        o, d = vertex + axes * p, axes * b
        out.append((list(o), list(d), path))
    return out
