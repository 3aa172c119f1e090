#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The renderer from outside: its pictures against closed forms, its errors, its reproducibility.

    python3 test_render.py RENDER
"""
import importlib.util
import math
import os
import pathlib
import pty
import re
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import time
import traceback
import zlib
from random import Random

SCENES = sorted((pathlib.Path(__file__).resolve().parent / 'scenes').glob('*.yaml'))
RENDER = os.path.abspath(sys.argv[1])
FOLDER = tempfile.TemporaryDirectory()
LEAKS = pathlib.Path(FOLDER.name, 'leaks.supp')
LEAKS.write_text('leak:libfontconfig\n')  # it keeps its configuration until the program ends
ENVIRONMENT = dict(os.environ, LSAN_OPTIONS=f'suppressions={LEAKS}:print_suppressions=0')

DRAWN, USAGE, BAD_INPUT = 0, 2, 3
HIT, MISS, EXHAUSTED = 0x56b4e9, 0xe8e8e8, 0xd55e00


def run(*words, exit=DRAWN):
    """Runs the program; what it says on standard error (and on standard output, of --help)."""
    done = subprocess.run([RENDER, *map(str, words)], capture_output=True, env=ENVIRONMENT, cwd=FOLDER.name, timeout=100)
    if done.returncode != exit:
        raise AssertionError(f'exit {done.returncode}, not {exit}: {words}\n{done.stderr.decode()[-1500:]}')
    return done.stderr.decode() + done.stdout.decode()


def written(text, name='scene.yaml'):
    path = pathlib.Path(tempfile.mkdtemp(dir=FOLDER.name)) / name
    path.write_text(text)
    return path


class Picture:
    """A PNG of 8 bits a channel, without interlacing, read by the format's rules."""

    def __init__(self, data):
        assert data[:8] == b'\x89PNG\r\n\x1a\n', data[:8]
        at, packed = 8, b''
        while at < len(data):
            length, kind = struct.unpack('>I4s', data[at:at + 8])
            chunk = data[at + 8:at + 8 + length]
            assert zlib.crc32(data[at + 4:at + 8 + length]) == struct.unpack('>I', data[at + 8 + length:at + 12 + length])[0]
            if kind == b'IHDR':
                self.width, self.height, depth, colours, *rest = struct.unpack('>IIBBBBB', chunk)
                assert (depth, colours, rest) == (8, 2, [0, 0, 0]), chunk
            packed += chunk if kind == b'IDAT' else b''
            at += 12 + length
        raw, before, self.rows = zlib.decompress(packed), bytes(3 * self.width), []
        for y in range(self.height):
            kind, row = raw[y * (3 * self.width + 1)], bytearray(raw[y * (3 * self.width + 1) + 1:(y + 1) * (3 * self.width + 1)])
            for i in range(len(row)):
                a, b, c = row[i - 3] if i >= 3 else 0, before[i], before[i - 3] if i >= 3 else 0
                p = a + b - c
                paeth = a if abs(p - a) <= abs(p - b) and abs(p - a) <= abs(p - c) else b if abs(p - b) <= abs(p - c) else c
                row[i] = row[i] + (0, a, b, (a + b) // 2, paeth)[kind] & 255
            self.rows.append(bytes(row))
            before = self.rows[-1]

    def at(self, x, y):
        return tuple(self.rows[y][3 * x:3 * x + 3])

    def code(self, x, y):
        r, g, b = self.at(x, y)
        return r << 16 | g << 8 | b

    def pixels(self):
        return [self.at(x, y) for y in range(self.height) for x in range(self.width)]


def linear(code):
    x = code / 255
    return x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4


def draw(scene, *words):
    """The picture of a scene, which is a path or a text; and what was said."""
    path = scene if isinstance(scene, pathlib.Path) else written(scene)
    file = pathlib.Path(tempfile.mkdtemp(dir=FOLDER.name)) / 'out.png'
    said = run(path, '--output', file, *words)
    return Picture(file.read_bytes()), said


# ------------------------------------------------- vectors, and a camera of our own

def add(a, b, s=1.0):
    return [p + s * q for p, q in zip(a, b)]


def dot(a, b):
    return sum(p * q for p, q in zip(a, b))


def unit(a):
    return [p / math.sqrt(dot(a, a)) for p in a]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def direction(picture_size, eye, look_at, field, x, y, up=(0, 0, 1)):
    """Of the ray through the middle of pixel x, y."""
    width, height = picture_size
    ahead = unit(add(look_at, eye, -1))
    right = unit(cross(ahead, up))
    down = cross(ahead, right)
    step = 2 * math.tan(math.radians(field) / 2) / height
    return unit(add(add(ahead, right, (x + 0.5 - width / 2) * step), down, (y + 0.5 - height / 2) * step))


def nearest_to_ring(o, d, major, far):
    """The least distance of o + t d, t from 0 to far, to the circle of radius `major` about z."""
    def distance(t):
        p = add(o, d, t)
        return math.hypot(math.hypot(p[0], p[1]) - major, p[2])
    steps = 120
    best = min(range(steps + 1), key=lambda i: distance(far * i / steps))
    lo, hi = far * max(best - 1, 0) / steps, far * min(best + 1, steps) / steps
    for _ in range(40):
        a, b = lo + (hi - lo) * 0.382, lo + (hi - lo) * 0.618
        lo, hi = (lo, b) if distance(a) < distance(b) else (a, hi)
    return distance(lo)


# ------------------------------------------------------------------ every scene

def test_scenes_are_drawn():
    """Each at a small size, the same to the last bit for 1 and 3 threads, and not blank."""
    assert len(SCENES) >= 7, SCENES
    for scene in SCENES:
        files = []
        for threads in (1, 3):
            file = pathlib.Path(tempfile.mkdtemp(dir=FOLDER.name)) / 'out.png'
            said = run(scene, '--size', '48x36', '--samples', '1', '--threads', threads, '--output', file)
            files.append(file.read_bytes())
            assert re.match(r'render: \d+ rays, [\d.]+ evaluations each, \d+ undecided', said), said
        assert files[0] == files[1], f'{scene.name}: threads change the picture'
        picture = Picture(files[0])
        assert (picture.width, picture.height) == (48, 36)
        pixels = picture.pixels()
        light = [sum(p) / 3 for p in pixels]
        mean = sum(light) / len(light)
        spread = math.sqrt(sum((x - mean) ** 2 for x in light) / len(light))
        assert len(set(pixels)) > 200, f'{scene.name}: {len(set(pixels))} colours'
        assert 20 < mean < 230 and spread > 15, f'{scene.name}: mean {mean}, spread {spread}'
        blown = sum(min(p) >= 254 for p in pixels) / len(pixels)
        assert blown < 0.1, f'{scene.name}: {blown} of it is white'


def test_status_of_scenes():
    """What is met and what is not is there to see, and where no dt_min is given hardly a ray is undecided."""
    for scene in SCENES:
        picture, said = draw(scene, '--size', '48x36', '--paint', 'status')
        codes = [picture.code(x, y) for y in range(36) for x in range(48)]
        assert codes.count(HIT) > 150, f'{scene.name}: {codes.count(HIT)} hits'
        if 'dt_min' not in scene.read_text():
            assert sum(c in (HIT, MISS) for c in codes) >= 0.995 * len(codes), f'{scene.name}: {said}'


# -------------------------------------------------------------------- closed forms

TORUS = '''
picture: {size: [64, 48], samples: 1}
camera: {position: [1.5, -4, 3], look_at: [0, 0, 0.1], field: 36}
sky: {zenith: [0, 0, 0], horizon: [0, 0, 0]}
ambient: {strength: 0}
lights:
  - {position: [3, -2, 9]}
objects:
  - {type: torus, major: 1.2, minor: 0.4}
'''
EYE, LOOK_AT, FIELD, SIZE = (1.5, -4, 3), (0, 0, 0.1), 36, (64, 48)


def test_silhouette_of_a_torus():
    """A ray meets it where it comes nearer to the circle than `minor`."""
    picture, said = draw(TORUS, '--paint', 'status')
    compared = met = 0
    for y in range(48):
        for x in range(64):
            near = nearest_to_ring(EYE, direction(SIZE, EYE, LOOK_AT, FIELD, x, y), 1.2, 9)
            if abs(near - 0.4) > 1e-4:
                compared += 1
                met += near < 0.4
                assert picture.code(x, y) == (HIT if near < 0.4 else MISS), (x, y, near)
    assert compared > 3050 and 500 < met < 2500, (compared, met)
    assert ' 0 undecided' in said or ' undecided' in said


def test_silhouette_of_one_placed():
    """Moved, turned and scaled: the ray is taken into the frame by a formula of our own."""
    text = TORUS.replace('minor: 0.4', 'minor: 0.4, position: [0.2, 0.3, -0.1], rotation: [90, 0, 30], scale: 0.8')
    picture, _ = draw(text, '--paint', 'status')
    c, s = math.cos(math.radians(30)), math.sin(math.radians(30))
    ex, ey, ez = (c, s, 0), (0, 0, 1), (s, -c, 0)  # Rz(30) Rx(90)
    wrong = met = 0
    for y in range(48):
        for x in range(64):
            d, o = direction(SIZE, EYE, LOOK_AT, FIELD, x, y), add(EYE, (0.2, 0.3, -0.1), -1)
            o, d = ([dot(e, v) / 0.8 for e in (ex, ey, ez)] for v in (o, d))
            near = nearest_to_ring(o, d, 1.2, 9)
            met += near < 0.4
            wrong += abs(near - 0.4) > 1e-4 and picture.code(x, y) != (HIT if near < 0.4 else MISS)
    assert wrong == 0 and 300 < met < 2500, (wrong, met)


FLOOR = '''
picture: {size: [64, 48], samples: 16}
camera: {position: [0, -6, 5], look_at: [0, 0, 0], field: 30}
sky: {zenith: [0, 0, 0], horizon: [0, 0, 0]}
ambient: {strength: 0}
lights:
  - {position: [0.5, 0, 4], colour: [0.9, 0.6, 0.3]}
objects:
  - {type: plane, material: {colour: [0.6, 0.6, 0.6]}}
'''


def floor_point(x, y, eye=(0, -6, 5), look_at=(0, 0, 0), field=30, size=(64, 48)):
    d = direction(size, eye, look_at, field, x, y)
    return add(eye, d, -eye[2] / d[2])


def test_light_on_a_floor():
    """The diffuse light of one lamp is its colour times the cosine, and pictures are sRGB."""
    picture, said = draw(FLOOR)
    for y in range(2, 46, 3):
        for x in range(2, 62, 3):
            to = add((0.5, 0, 4), floor_point(x, y), -1)
            cosine = to[2] / math.sqrt(dot(to, to))
            for code, colour in zip(picture.at(x, y), (0.9, 0.6, 0.3)):
                wanted = 0.6 * colour * cosine
                assert abs(linear(code) - wanted) < 0.006, (x, y, linear(code), wanted)
    assert ', 0 undecided' in said, said


def test_shadow_of_a_torus():
    """Hard: dark where the way to the lamp comes near the circle; soft: dim at the border and the same elsewhere."""
    scene = FLOOR + '  - {type: torus, major: 0.8, minor: 0.25, position: [0, 0, 1]}\n'
    light, (hard, _), (soft, _) = (0.5, 0, 4), draw(scene), draw(scene.replace('0.3]}', '0.3], radius: 0.3}'), '--samples', 64)
    dark = lit = dim = 0
    for y in range(48):
        for x in range(64):
            p = floor_point(x, y)
            d = add(p, (0, -6, 5), -1)
            seen = nearest_to_ring((0, -6, 4), unit(d), 0.8, math.sqrt(dot(d, d))) > 0.3
            to = add(light, p, -1)
            near = nearest_to_ring(add(p, (0, 0, -1)), unit(to), 0.8, math.sqrt(dot(to, to)))
            if seen and near < 0.15:
                dark += 1
                assert max(hard.at(x, y)) == 0, (x, y, hard.at(x, y))
            if seen and near > 0.36:
                lit += 1
                assert hard.at(x, y)[0] > 60 and abs(hard.at(x, y)[0] - soft.at(x, y)[0]) <= 4, (x, y)
            if seen and abs(near - 0.25) < 0.02:
                dim += 0.1 < linear(soft.at(x, y)[0]) / (0.54 * to[2] / math.sqrt(dot(to, to))) < 0.95
    assert dark > 80 and lit > 800 and dim > 10, (dark, lit, dim)


def test_ambient_occlusion():
    """Under a torus that lies on the floor it is darker; far from it the whole sky is seen."""
    scene = FLOOR.replace('strength: 0', 'strength: 1, rays: 4').replace('horizon: [0, 0, 0]', 'horizon: [0.5, 0.5, 0.5]') \
                 .replace('zenith: [0, 0, 0]', 'zenith: [0.5, 0.5, 0.5]').replace('0.9, 0.6, 0.3', '0, 0, 0')
    picture, _ = draw(scene + '  - {type: torus, major: 0.9, minor: 0.25, position: [0, 0, 0.25], material: {colour: [0, 0, 0]}}\n')
    # a point of the floor at distance r from the axis, and the part of the sky that a cosine-weighted sum over
    # directions leaves; the torus is met where a ray comes nearer to its circle than `minor`
    def part(p):
        got = n = 0
        for i in range(24):
            for j in range(48):
                s, a = math.sqrt((i + 0.5) / 24), 2 * math.pi * (j + 0.5) / 48
                d = (s * math.cos(a), s * math.sin(a), math.sqrt(1 - s * s))
                n += 1
                got += nearest_to_ring(add(p, (0, 0, -0.25)), d, 0.9, 4) > 0.25
        return got / n
    parts = []
    for x, y in ((32, 21), (30, 21), (34, 21), (10, 40), (60, 10)):
        p = floor_point(x, y)
        wanted = 0.3 * part(p)
        near = [linear(picture.at(x + i, y + j)[0]) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        parts.append(wanted / 0.3)
        assert abs(sum(near) / 9 - wanted) < 0.02, (x, y, sum(near) / 9, wanted)
    assert min(parts) < 0.9 and max(parts) > 0.97, parts


CHECKS = '''
picture: {size: [64, 48], samples: 16, depth: 6}
camera: {position: [0.1, -4, 4], look_at: [0.1, 0.2, 0], field: 30}
sky: {zenith: [0, 0, 0], horizon: [0, 0, 0]}
ambient: {strength: 0}
lights:
  - {position: [0, 0, 50]}
objects:
  - {type: plane, material: {colour: {checks: 0.8, colours: [[0.9, 0.9, 0.9], [0, 0, 0]]}}}
'''


CHECK = 0.8


def compare_checks(picture, where, reach=20, margin=0.2, white=90):
    """Of the checks at `where(x, y)`, which is white?  Pixels near a border, or too far out, are left out."""
    compared = even = 0
    for y in range(48):
        for x in range(64):
            p = where(x, y)
            if max(map(abs, p[:2])) > reach or min(abs(v / CHECK - round(v / CHECK)) for v in p[:2]) < margin:
                continue
            is_even = (math.floor(p[0] / CHECK) + math.floor(p[1] / CHECK)) % 2 == 0
            compared += 1
            even += is_even
            assert (picture.at(x, y)[1] > white) == is_even, (x, y, p, picture.at(x, y))
    assert compared > 300 and 0.3 < even / compared < 0.7, (compared, even)


def checks_ray(x, y):
    return direction((64, 48), (0.1, -4, 4), (0.1, 0.2, 0), 30, x, y)


def straight(x, y):
    d = checks_ray(x, y)
    return add((0.1, -4, 4), d, -4 / d[2])


def test_checks():
    compare_checks(draw(CHECKS)[0], straight)


def test_refraction():
    """Through a slab of glass the floor is where Snell's law puts it: a shift of half a check and more."""
    slab = ''.join(f'  - {{type: plane, position: [0, 0, {z}], material: {{index: 1.7}}}}\n' for z in (2.0, 0.5))

    def bent(x, y):
        d = checks_ray(x, y)
        p = add((0.1, -4, 4), d, -2 / d[2])
        sine = math.hypot(d[0], d[1]) / 1.7
        inside = (d[0] / 1.7, d[1] / 1.7, -math.sqrt(1 - sine * sine))
        return add(add(p, inside, -1.5 / inside[2]), d, -0.5 / d[2])
    compare_checks(draw(CHECKS + slab)[0], bent)
    assert abs(straight(31, 23)[1] - bent(31, 23)[1]) > 0.4, (straight(31, 23), bent(31, 23))


def test_reflection():
    """A mirror on the floor shows a chequered ceiling; with depth 0 it shows the sky, which is black."""
    ceiling = CHECKS.replace('material: {colour', 'position: [0, 0, 3], material: {colour').replace('[0, 0, 50]', '[0, 5, 0.5]') \
                    .replace('4], look_at', '2.5], look_at')
    mirror = ceiling + '  - {type: plane, material: {reflection: 1}}\n'
    picture, _ = draw(mirror)

    def where(x, y):
        d = direction((64, 48), (0.1, -4, 2.5), (0.1, 0.2, 0), 30, x, y)
        p = add((0.1, -4, 2.5), d, -2.5 / d[2])
        return add(p, (d[0], d[1], -d[2]), -3 / d[2])
    compare_checks(picture, where, reach=8, margin=0.3, white=40)
    dark, _ = draw(mirror.replace('depth: 6', 'depth: 0'))
    assert max(map(max, dark.pixels())) == 0


# --------------------------------------------------------------- every type, by height

# Only the sky's light, white everywhere: what is seen is the colour itself.
WHITE = """
picture: {size: [64, 48], samples: 16}
camera: {position: [%s], look_at: [%s], field: %s}
sky: {zenith: [1, 1, 1], horizon: [1, 1, 1], ground: [1, 1, 1]}
ambient: {strength: 1, rays: 0}
objects:
"""
ABOVE = (0.3, -3, 24)


def conic(c, k, r2):
    return c * r2 / (1 + math.sqrt(1 - (1 + k) * c * c * r2))


def ball(radius):
    return lambda x, y: math.sqrt(radius * radius - x * x - y * y)


def q_bfs(x, y):
    u2 = (x * x + y * y) / 16
    return conic(0.05, 0, x * x + y * y) + u2 * (1 - u2) / math.sqrt(1 - 0.0025 * (x * x + y * y)) \
        * (1.5 - 0.8 * (13 - 16 * u2) / math.sqrt(19))


def toroid(x, y):
    profile = 0.1 * y * y / (1 + math.sqrt(1 - 0.4 * 0.01 * y * y)) + 1e-3 * y ** 4
    return (1 - math.sqrt((1 - 0.07 * profile) ** 2 - 0.0049 * x * x)) / 0.07


def biconic(x, y):
    return (0.1 * x * x - 0.07 * y * y) / (1 + math.sqrt(1 - 0.4 * 0.01 * x * x - 1.3 * 0.0049 * y * y))


def fringe(x, y):
    u, a = math.hypot(x, y) / 4, math.atan2(y, x)
    return 0.2 * u * math.cos(a) + 0.3 * (2 * u * u - 1) - 0.4 * u * u * math.sin(2 * a)


ROWS = [[round(0.05 * (x - 2) ** 2 - 0.03 * (y - 2) * (x - 2) + 0.1 * (y - 2), 3) for x in range(5)] for y in range(5)]

# type: its keys, what is seen from above, how far out
HEIGHTS = {
    'plane': ('', lambda x, y: 0, 3),
    'sphere': ('radius: -8', lambda x, y: conic(-0.125, 0, x * x + y * y), 3),
    'conic': ('curvature: 0.1, conic: -2', lambda x, y: conic(0.1, -2, x * x + y * y), 3),
    'even_asphere': ('curvature: 0.1, coefficients: [-0.1, 5e-3]', lambda x, y: conic(0.1, 0, x * x + y * y)
                     - 0.1 * (x * x + y * y) + 5e-3 * (x * x + y * y) ** 2, 3),
    'odd_asphere': ('coefficients: [-0.3, 0, 0.02]', lambda x, y: -0.3 * math.hypot(x, y) + 0.02 * math.hypot(x, y) ** 3, 3),
    'polynomial_xy': ('coefficients: [[0, 0.1, -0.05], [0, 0.06], [0.04]]',
                      lambda x, y: 0.1 * y - 0.05 * y * y + 0.06 * x * y + 0.04 * x * x, 3),
    'toroidal': ('curvature: 0.1, conic: -0.6, curvature_x: 0.07, coefficients: [0, 1e-3]', toroid, 3),
    'biconic': ('radius_x: 10, conic_x: -0.6, curvature_y: -0.07, conic_y: 0.3', biconic, 3),
    'cylinder': ('curvature: 0.2, conic: -1', lambda x, y: 0.1 * y * y, 3),
    'zernike': ('norm: 4, order: fringe, coefficients: [0, 0.2, 0, 0.3, 0, -0.4]', fringe, 3),
    'chebyshev': ('norm_x: 4, norm_y: 5, coefficients: [[0, 0.3], [0.2, -0.3, 0], [0.4]]',
                  lambda x, y: 0.3 * y / 5 + 0.2 * x / 4 - 0.3 * x * y / 20 + 0.4 * (2 * x * x / 16 - 1), 3),
    'q_con': ('norm: 4, coefficients: [0.9, 0.5]', lambda x, y: ((x * x + y * y) / 16) ** 2
              * (0.9 - 0.5 * (5 - 6 * (x * x + y * y) / 16)), 3),
    'q_bfs': ('radius: 20, norm: 4, coefficients: [1.5, -0.8]', q_bfs, 3),
    'grid': (f'step_x: 1.5, step_y: 2, sag: {ROWS}', lambda x, y: 0.05 * (x / 1.5) ** 2 - 0.01 * x * y
             + 0.05 * y, 2.5),
    'sum': ('terms: [{type: even_asphere, coefficients: [0.04]}, {type: polynomial_xy, coefficients: [[0, 0.1], [0, 0.05]]}]',
            lambda x, y: 0.04 * (x * x + y * y) + 0.1 * y + 0.05 * x * y, 3),
    'quadric': ('squares: [1, 2, 1], constant: -16', lambda x, y: math.sqrt(16 - x * x - 2 * y * y), 2),
    'torus': ('major: 2, minor: 1', lambda x, y: math.sqrt(1 - (math.hypot(x, y) - 2) ** 2), 0),
    'ellipsoid': ('a: 4, f: 0.5', lambda x, y: 0.5 * math.sqrt(16 - x * x - y * y), 2.5),
    'julia': ('c: [0, 0, 0, 0], iterations: 1, escape: 16', ball(4), 2.5),
    'mandelbrot': ('iterations: 1, escape: 4', ball(4), 2.5),
    'mandelbulb': ('iterations: 1, escape: 4', ball(4), 2.5),
    'box': ('half: [3, 2.5, 0.5]', lambda x, y: 0.5, 2.3),
}


def test_every_type():
    """Each type of the catalogue, once: its heights, seen as shades of grey, are those of its formula."""
    rows = (pathlib.Path(__file__).resolve().parents[2] / 'src' / 'types.def').read_text()
    missing = set(re.findall(r'^TYPE\(\w+, (\w+),', rows, re.M)) - set(HEIGHTS) - {'formula'}
    assert not missing, missing
    size, at = (64, 48), (0, 0, 0)
    for name, (keys, height, reach) in HEIGHTS.items():
        def point(x, y):
            d, z = direction(size, ABOVE, at, 16, x, y), 0.0
            for _ in range(60):
                p = add(ABOVE, d, (z - ABOVE[2]) / d[2])
                z = height(p[0], p[1])
            return p, z
        near = [(x, y) for y in range(48) for x in range(64) if math.hypot(x - 32, y - 24) < 22 and (x + y) % 3 == 0]
        seen = {}
        for x, y in near:
            try:
                p, z = point(x, y)
            except ValueError:
                continue
            r = math.hypot(p[0], p[1])
            if r < reach or (name == 'torus' and abs(r - 2) < 0.6):
                seen[x, y] = z
        assert len(seen) > 66, (name, len(seen))
        lo, hi = min(seen.values()) - 0.05, max(seen.values()) + 0.05
        text = WHITE % (', '.join(map(str, ABOVE)), '0, 0, 0', 16)
        text += f'  - {{type: {name}{", " if keys else ""}{keys}, material: {{colour: {{blend: z, from: {lo}, to: {hi}, ' \
                'colours: [[0, 0, 0], [0.7, 0.7, 0.7]]}}}\n'
        picture, said = draw(text, '--samples', '25')
        assert ' 0 undecided' in said, (name, said)
        for (x, y), z in seen.items():
            grey, wanted = linear(picture.at(x, y)[0]), 0.7 * (z - lo) / (hi - lo)
            assert abs(grey - wanted) < 0.025, (name, x, y, grey, wanted)


def test_tables_from_files():
    """A file of heights is looked for beside the scene."""
    text = WHITE % ('0, -3, 9', '0, 0, 0', 30) + '  - {type: grid, step_x: 1, step_y: 1, sag: %s}\n'
    path = written(text % 'heights.csv')
    (path.parent / 'heights.csv').write_text('\n'.join(','.join(map(str, row)) for row in ROWS) + '\n')
    assert draw(path)[0].rows == draw(text % ROWS)[0].rows


# ------------------------------------------------------- union, intersection, difference

def turn(degrees, v):
    """Rz Ry Rx v."""
    for axis, angle in enumerate(degrees):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        i, j = ((1, 2), (2, 0), (0, 1))[axis]
        v = list(v)
        v[i], v[j] = c * v[i] - s * v[j], s * v[i] + c * v[j]
    return v


class Part:
    """A ball, a box or the half below a plane, placed: where a ray is in it."""

    def __init__(self, kind, size, position=(0, 0, 0), rotation=(0, 0, 0), colour=(0.5, 0.5, 0.5)):
        self.kind, self.size, self.position, self.rotation, self.colour = kind, size, position, rotation, colour
        self.axes = [turn(rotation, e) for e in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]

    def yaml(self):
        keys = {'ball': lambda: f'type: ellipsoid, a: {self.size}', 'box': lambda: f'type: box, half: {list(self.size)}',
                'half': lambda: 'type: plane'}[self.kind]()
        return f'{{{keys}, position: {list(self.position)}, rotation: {list(self.rotation)}, ' \
               f'material: {{colour: {list(self.colour)}}}}}'

    def stretch(self, o, d):
        """(from, to) along the ray; None: nothing of it."""
        o = [dot(e, add(o, self.position, -1)) for e in self.axes]
        d = [dot(e, d) for e in self.axes]
        if self.kind == 'ball':
            b, w = dot(o, d), dot(o, d) ** 2 - dot(o, o) + self.size ** 2
            return (-b - math.sqrt(w), -b + math.sqrt(w)) if w > 0 else None
        if self.kind == 'half':
            t = -o[2] / d[2]
            return (t, math.inf) if d[2] < 0 else (-math.inf, t)
        slabs = [sorted(((-h - a) / b, (h - a) / b)) for h, a, b in zip(self.size, o, d)]
        lo, hi = max(s[0] for s in slabs), min(s[1] for s in slabs)
        return (lo, hi) if lo < hi else None

    def parts(self):
        return [self]

    def has(self, stretches, t):
        s = stretches[self]
        return s is not None and s[0] < t < s[1]


class Tree:
    def __init__(self, how, *of):
        self.how, self.of = how, of

    def yaml(self):
        return f'{{{self.how}: [' + ', '.join(part.yaml() for part in self.of) + ']}'

    def parts(self):
        return [leaf for part in self.of for leaf in part.parts()]

    def has(self, stretches, t):
        states = [part.has(stretches, t) for part in self.of]
        return {'union': any(states), 'intersection': all(states), 'difference': states[0] and not any(states[1:])}[self.how]


def first_hit(tree, o, d, keep=lambda p: True):
    """(t, part) of the body's border; None: a miss; 'near': two borders are too near each other to tell."""
    stretches = {part: part.stretch(o, d) for part in tree.parts()}
    ends = sorted((t, part.kind, id(part), part) for part, s in stretches.items() if s for t in s if 0 < t < math.inf)
    for (t, *_), (u, *_) in zip(ends, ends[1:]):
        if u - t < 1e-5:
            return 'near'
    for t, _, _, part in ends:
        if tree.has(stretches, t - 1e-6) != tree.has(stretches, t + 1e-6) and keep(add(o, d, t)):
            return t, part
    return None


def random_tree(random, depth, colours):
    if depth == 0 or (depth < 3 and random.random() < 0.25):
        kind = random.choice(('ball', 'ball', 'box', 'box', 'half'))
        size = {'ball': round(random.uniform(0.5, 1.3), 3), 'half': 0,
                'box': tuple(round(random.uniform(0.3, 1.2), 3) for _ in range(3))}[kind]
        place = [round(random.uniform(-0.8, 0.8), 3) for _ in range(3)]
        return Part(kind, size, place, [round(random.uniform(-90, 90), 2) for _ in range(3)], colours.pop())
    how = random.choice(('union', 'intersection', 'difference'))
    return Tree(how, *(random_tree(random, depth - 1, colours) for _ in range(random.choice((2, 2, 3)))))


def all_colours():
    levels = (0.1, 0.4, 0.7)
    return [(r, g, b) for r in levels for g in levels for b in levels][::-1] * 2


LOOK = ((2.1, -4.3, 2.4), (0, 0, 0), 36, (64, 48))


def compare(text, seen):
    """Status of every pixel, and colours where all neighbours are of one part.  seen(o, d): as first_hit."""
    eye, at, field, size = LOOK
    status, said = draw(text, '--paint', 'status')
    picture, _ = draw(text)
    hits = [[seen(eye, direction(size, eye, at, field, x, y)) for x in range(64)] for y in range(48)]
    coloured = met = 0
    for y in range(48):
        for x in range(64):
            hit = hits[y][x]
            if hit == 'near':
                continue
            met += hit is not None
            assert status.code(x, y) == (HIT if hit else MISS), (text, x, y, hit, hex(status.code(x, y)))
            around = [hits[v][u] for v in range(max(y - 1, 0), min(y + 2, 48)) for u in range(max(x - 1, 0), min(x + 2, 64))]
            if not hit or any(h in ('near', None) or h[1] is not hit[1] for h in around):
                continue
            coloured += 1
            if all(abs(linear(a) - b) < 0.02 for a, b in zip(picture.at(x, y), hit[1].colour)):
                continue
            # or something thin between the middles of pixels
            between = [seen(eye, direction(size, eye, at, field, x + i / 16, y + j / 16)) for i in range(-16, 17) for j in range(-16, 17)]
            assert any(h in ('near', None) or h[1] is not hit[1] for h in between), (text, x, y, picture.at(x, y), hit[1].colour)
    return met, coloured, said


def test_random_trees():
    """Unions, intersections and differences within each other, of balls, boxes and halves: what is met first, and if."""
    seed = int(os.environ.get('SAGITTA_TEST_SEED', 1))
    scale = float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))
    random, met = Random(seed), 0
    print(f'SAGITTA_TEST_SEED={seed}')
    text = WHITE % tuple(', '.join(map(str, v)) if isinstance(v, tuple) else v for v in LOOK[:3])
    for _ in range(int(8 * scale)):
        tree = random_tree(random, random.choice((1, 1, 2, 3)), all_colours())
        if isinstance(tree, Part):
            continue
        body = text + f'  - {tree.yaml()}\n'
        met += compare(body, lambda o, d: first_hit(tree, o, d))[0] > 100
    assert met >= 2 * scale, met


A = Part('ball', 1.2, (0, 0, 0), (0, 0, 0), (0.7, 0.1, 0.1))
B = Part('ball', 0.9, (0.6, -0.5, 0.4), (0, 0, 0), (0.1, 0.7, 0.1))
C = Part('box', (0.9, 0.5, 0.8), (0.2, 0.1, 0), (20, 10, 30), (0.1, 0.1, 0.7))


def scene_of(*bodies):
    text = WHITE % tuple(', '.join(map(str, v)) if isinstance(v, tuple) else v for v in LOOK[:3])
    return text + ''.join(f'  - {body}\n' for body in bodies)


def test_operations():
    """Each by itself, and one that is placed as a whole."""
    for how in ('union', 'intersection', 'difference'):
        for parts in ((A, B), (B, A), (A, C, B)):
            tree = Tree(how, *parts)
            met, coloured, said = compare(scene_of(tree.yaml()), lambda o, d: first_hit(tree, o, d))
            assert met > 100 and coloured > 50 and ' 0 undecided' in said, (how, met, coloured, said)
    tree = Tree('difference', A, B)

    def placed(o, d):
        axes = [turn((10, 20, 30), e) for e in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
        return first_hit(tree, [dot(e, add(o, (0.3, 0.2, -0.1), -1)) / 0.8 for e in axes], [dot(e, d) for e in axes])
    text = scene_of(tree.yaml()[:-1] + ', position: [0.3, 0.2, -0.1], rotation: [10, 20, 30], scale: 0.8}')
    assert compare(text, placed)[0] > 300


def test_clips():
    """By a ball, a box, an object and what is outside of one; of a surface, and of a compound; and two at once."""
    box, c = Part('box', (0.9, 0.6, 1), (0.2, 0, 0.1), (0, 0, 25)), Part('ball', 0.8, (0.4, -0.6, 0.5))
    inside = {'ball': lambda p: dot(p, p) < 1.21, 'moved': lambda p: dot(add(p, (0.4, -0.6, 0.5), -1), add(p, (0.4, -0.6, 0.5), -1)) < 0.64,
              'box': lambda p: all(abs(dot(e, add(p, box.position, -1))) < h for e, h in zip(box.axes, box.size))}
    moved = '{ball: 0.8, position: [0.4, -0.6, 0.5]}'
    boxed = '{box: [0.9, 0.6, 1], position: [0.2, 0, 0.1], rotation: [0, 0, 25]}'
    clips = [('{ball: 1.1}', inside['ball']), (moved, inside['moved']), (boxed, inside['box']),
             (f'{{object: {c.yaml()}}}', inside['moved']), (f'{{outside: {c.yaml()}}}', lambda p: not inside['moved'](p)),
             (f'{{outside: {box.yaml()}}}', lambda p: not inside['box'](p)),
             (f'[{boxed}, {{outside: {c.yaml()}}}]', lambda p: inside['box'](p) and not inside['moved'](p)),
             (f'{{object: {{union: [{c.yaml()}, {box.yaml()}]}}}}', lambda p: inside['moved'](p) or inside['box'](p))]
    for i, (text, keep) in enumerate(clips):
        body = (Tree('difference', C, B), Tree('union', A, C))[i % 2]
        yaml = body.yaml()[:-1] + f', clip: {text}}}'
        met = compare(scene_of(yaml), lambda o, d: first_hit(body, o, d, keep))[0]
        assert met > 20, (yaml, met)
    # of one surface, in its own frame, which is moved and scaled
    for text, keep in clips[1:]:
        yaml = A.yaml()[:-1].replace('position: [0, 0, 0]', 'position: [0.1, 0.2, 0.3], scale: 0.9') + f', clip: {text}}}'
        met = compare(scene_of(yaml), lambda o, d: first_hit(A, [v / 0.9 for v in add(o, (0.1, 0.2, 0.3), -1)], d, keep))[0]
        assert met > 20, (yaml, met)


def test_shadow_and_mirror_of_a_difference():
    """Shadow rays and reflected ones meet the same body: a ball with a ball taken out of it, over a mirror."""
    tree, light = Tree('difference', Part('ball', 0.9, (0, 0, 1.2), colour=(0.7, 0.1, 0.1)),
                       Part('ball', 0.8, (0.3, -0.5, 1.5), colour=(0.1, 0.1, 0.7))), (0.5, -0.4, 6)
    picture, said = draw(FLOOR.replace('0.5, 0, 4', '0.5, -0.4, 6') + f'  - {tree.yaml()}\n')
    dark = lit = 0
    for y in range(48):
        for x in range(64):
            p = floor_point(x, y)
            if first_hit(tree, (0, -6, 5), unit(add(p, (0, -6, 5), -1))):
                continue
            shades = {first_hit(tree, q, unit(add(light, q, -1))) is None for q in
                      (floor_point(x + i / 2, y + j / 2) for i in (-2, 0, 2) for j in (-2, 0, 2))}
            if len(shades) > 1:
                continue
            dark, lit = dark + (shades == {False}), lit + (shades == {True})
            assert (picture.at(x, y)[0] > 40) == (shades == {True}), (x, y, picture.at(x, y))
    assert dark > 100 and lit > 1000 and ', 0 undecided' in said, (dark, lit, said)
    mirror = scene_of(tree.yaml(), '{type: plane, material: {reflection: 1}}')
    eye, at, field, size = LOOK
    picture, _ = draw(mirror)

    def seen(x, y):
        d = direction(size, eye, at, field, x, y)
        if d[2] >= 0 or first_hit(tree, eye, d):
            return None
        return first_hit(tree, add(eye, d, -eye[2] / d[2]), (d[0], d[1], -d[2]))
    hits, compared = [[seen(x, y) for x in range(64)] for y in range(48)], 0
    for y in range(1, 47):
        for x in range(1, 63):
            around = [hits[y + j][x + i] for i in (-1, 0, 1) for j in (-1, 0, 1)]
            if all(isinstance(h, tuple) and h[1] is around[0][1] for h in around):
                compared += 1
                assert all(abs(linear(a) - b) < 0.02 for a, b in zip(picture.at(x, y), around[0][1].colour)), (x, y)
    assert compared > 30, compared


UNPROVEN = 0xe69f00


def test_undecided_parts():
    """What cannot be told is told so, where it matters and nowhere else."""
    def codes(body):
        picture, said = draw(scene_of(body), '--paint', 'status')
        return [picture.code(x, y) for y in range(48) for x in range(64)], said
    ball_at = A.yaml()
    alone, _ = codes(ball_at)
    # the same ball twice: its borders coincide
    for how in ('union', 'intersection'):
        assert codes(f'{{{how}: [{ball_at}, {ball_at}]}}')[0] == alone, how
    twice, said = codes(f'{{difference: [{ball_at}, {ball_at}]}}')
    assert all(b == (UNPROVEN if a == HIT else MISS) for a, b in zip(alone, twice)), said
    assert f' {alone.count(HIT)} undecided' in said, said
    # a part that is given up matters only where it may be seen
    # (a spindle: of a ring one evaluation tells the root)
    torus = '{type: torus, major: 0.5, minor: 0.9, max_evals: 1, position: [%s]}'
    given_up, _ = codes(torus % '0, 0, 0')
    assert given_up.count(EXHAUSTED) > 300
    within, said = codes(f'{{intersection: [{{type: ellipsoid, a: 2.5}}, {torus % "0, 0, 0"}]}}')
    assert within == given_up and f' {within.count(EXHAUSTED)} undecided' in said, said
    behind, said = codes(f'{{difference: [{ball_at}, {torus % "-2.1, 4.3, -2.4"}]}}')
    assert behind == alone and ' 0 undecided' in said, said
    cut, said = codes(f'{{difference: [{ball_at}, {torus % "0, 0, 0"}]}}')
    assert 50 < cut.count(EXHAUSTED) < 2000 and set(cut) <= {HIT, MISS, EXHAUSTED}, said
    assert f' {cut.count(EXHAUSTED)} undecided' in said, said
    for a, b in zip(alone, cut):
        assert b == MISS or a == HIT  # outside of the ball nothing is undecided


# ----------------------------------------------------------- what must not matter

def unlike(one, other, levels):
    """The part of the pixels that differ by more than so many of 255 levels."""
    pairs = list(zip(one.pixels(), other.pixels()))
    return sum(max(abs(a - b) for a, b in zip(p, q)) > levels for p, q in pairs) / len(pairs)


LIT = TORUS.replace('strength: 0', 'strength: 0.5')


def test_no_acne():
    """A coarse hit starts its shadow rays from a point off the surface, and no dark specks come of it."""
    exact, _ = draw(LIT, '--samples', '4')
    for tolerance in ('1e-9', '1e-5', '1e-3'):
        coarse, _ = draw(LIT.replace('minor: 0.4', f'minor: 0.4, t_tol: {tolerance}'), '--samples', '4')
        assert unlike(exact, coarse, 12) < 0.01, (tolerance, unlike(exact, coarse, 12))


def test_a_lit_side_is_lit():
    """Where the lamp is straight above the whole upper half of a torus is lit: no speck in it."""
    scene = TORUS.replace('[3, -2, 9]', '[0, 0, 500]').replace('[1.5, -4, 3]', '[0.01, 0, 5]')
    for place in ('', ', position: [0, 0, -0.3], scale: 0.9', ', t_tol: 1e-4'):
        picture, _ = draw(scene.replace('minor: 0.4', 'minor: 0.4' + place))
        status, _ = draw(scene.replace('minor: 0.4', 'minor: 0.4' + place), '--paint', 'status')
        inner = [(x, y) for y in range(1, 47) for x in range(1, 63)
                 if all(status.code(x + i, y + j) == HIT for i in (-1, 0, 1) for j in (-1, 0, 1))]
        assert len(inner) > 300
        for x, y in inner:
            assert picture.at(x, y)[0] > 25, (place, x, y, picture.at(x, y))


def test_normals():
    """By differences they are those of the gradient; the potential's are near them on a long orbit."""
    assert unlike(draw(LIT)[0], draw(LIT, '--normal', 'difference')[0], 1) < 0.002
    julia = LIT.replace('type: torus, major: 1.2, minor: 0.4', 'type: julia, c: [-0.2, 0.8, 0, 0], iterations: 6')
    gradient, difference, potential = (draw(julia, '--normal', kind)[0] for kind in ('gradient', 'difference', 'potential'))
    assert unlike(gradient, difference, 3) < 0.02, unlike(gradient, difference, 3)
    assert 0 < unlike(gradient, potential, 3) and unlike(gradient, potential, 90) < 0.1
    of_scene, _ = draw(julia.replace('iterations: 6', 'iterations: 6, normal: potential'))
    assert of_scene.rows == potential.rows


def test_samples():
    """More samples are nearer to very many; and a pixel's noise is its own."""
    soft = LIT.replace('[3, -2, 9]}', '[3, -2, 9], radius: 2}').replace('minor: 0.4', 'minor: 0.4')
    few, more, most = (draw(soft, '--samples', n)[0] for n in (1, 16, 256))

    def distance(a, b):
        return math.sqrt(sum((p - q) ** 2 for row, other in zip(a.rows, b.rows) for p, q in zip(row, other)) / len(a.rows) / len(a.rows[0]))
    assert 1 < distance(few, most) and distance(more, most) < 0.3 * distance(few, most), (distance(few, most), distance(more, most))
    wide, _ = draw(soft.replace('size: [64, 48]', 'size: [64, 64]').replace('field: 36', f'field: {2 * math.degrees(math.atan(64 / 48 * math.tan(math.radians(18))))}'))
    assert wide.width == wide.height == 64


# -------------------------------------------------------------- frames, paint, terminal

PATH = TORUS.replace('position: [1.5, -4, 3]', 'position: [[1.5, -4, 3], [4, 0, 1], [0, 4, 5]]')


def test_frames():
    """Numbered files along a Bezier curve: its ends are the first and last point, its middle (a + 2 b + c) / 4."""
    file = pathlib.Path(tempfile.mkdtemp(dir=FOLDER.name)) / 'ring.png'
    run(written(PATH), '--frames', 3, '--output', file, '--paint', 'status')
    names = sorted(p.name for p in file.parent.iterdir())
    assert names == ['ring-0001.png', 'ring-0002.png', 'ring-0003.png'], names
    for name, eye in zip(names, ('1.5, -4, 3', '2.375, 0, 2.5', '0, 4, 5')):
        still, _ = draw(TORUS.replace('1.5, -4, 3', eye), '--paint', 'status')
        assert Picture((file.parent / name).read_bytes()).rows == still.rows, name
    # without --frames the picture is that of the beginning, and it is the first frame
    run(written(PATH), '--frames', 2, '--output', file)
    assert draw(PATH)[0].rows == Picture((file.parent / 'ring-0001.png').read_bytes()).rows


# ------------------------------------------------------------------------------ films

FILM = '''picture: {size: [30, 20], samples: 2}
camera: {position: [[0, -4, 1], [1, -4, 2], [3, -3, 1]], look_at: [0, 0, 0], field: 36}
lights:
  - {position: [-4, -4, 7], radius: 0.6}
objects:
  - {type: julia, c: [-0.2, 0.8, 0, 0], iterations: 5, material: {colour: {blend: trap, trap: [0, 0.1, 0, 0], colours: [[1, 0, 0], [0, 0, 1]]}}}
film:
  frames: 48
  rate: 12
  tracks:
    - {c: [[-0.2, 0.8, 0, 0], [-0.3, -0.4, 0.3, 0.4], [-0.1, 0, -0.8, 0]]}
    - {slice: [0, 0.2, 0.1, 0], times: [0, 1, 2, 3], curve: catmull-rom}
    - {exposure: [1, 1.3, 0.8], curve: bezier, times: [0.5, 3]}
'''


def frames_of(folder):
    return {p.name: p.read_bytes() for p in sorted(folder.iterdir()) if p.suffix != '.part'}


def test_a_film_survives():
    """48 frames: one run; killed five times and resumed; two halves by two processes at once; backwards: the same bytes."""
    seed = int(os.environ.get('SAGITTA_TEST_SEED', '1'))
    print(f'SAGITTA_TEST_SEED={seed}')
    random, scene = Random(seed), written(FILM)
    folder = lambda: pathlib.Path(tempfile.mkdtemp(dir=FOLDER.name))
    whole = folder()
    said = run('--film', scene, '--output', whole / 'f.png')
    wanted = frames_of(whole)
    assert len(wanted) == 48 and len(set(wanted.values())) == 48, sorted(wanted)
    assert f"ffmpeg -framerate 12 -start_number 1 -i '{whole}/f-%04d.png' -frames:v 48 " in said, said

    killed, kills = folder(), sorted(random.sample(range(1, 48), 5))
    for count in kills:  # once so many frames are there, and a random while later
        words = [RENDER, '--film', '--resume', '--threads', str(random.randint(1, 3)), '--output', str(killed / 'f.png'), str(scene)]
        alive = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=ENVIRONMENT)
        while len(frames_of(killed)) < count and alive.poll() is None:
            time.sleep(0.002)
        time.sleep(random.uniform(0, 0.03))
        alive.kill()
        alive.wait()
        for name, data in frames_of(killed).items():  # whole, or not there
            assert data == wanted[name], name
    there = len(frames_of(killed))
    said = run('--film', '--resume', scene, '--output', killed / 'f.png')
    assert f'render: {there} kept, {48 - there} drawn' in said, (there, said)
    assert frames_of(killed) == wanted

    halves = folder()
    both = [subprocess.Popen([RENDER, '--film', '--frames', part, '--output', str(halves / 'f.png'), str(scene)], stdout=subprocess.DEVNULL,
                             stderr=subprocess.DEVNULL, env=ENVIRONMENT) for part in ('25:48', '1:24')]
    assert [p.wait(timeout=100) for p in both] == [0, 0]
    assert frames_of(halves) == wanted
    apart = folder()
    for i in (48, 7, 1):
        run('--film', '--frames', f'{i}:{i}', scene, '--output', apart / 'f.png')
    assert frames_of(apart) == {k: v for k, v in wanted.items() if k[2:6] in ('0048', '0007', '0001')}

    # what is not whole, or of another film, is drawn anew
    names = sorted(wanted)
    for name, data in ((names[0], b''), (names[1], wanted[names[1]][:-1]), (names[2], wanted[names[3]]),
                       (names[4], wanted[names[4]][:300] + b'?' + wanted[names[4]][301:]), (names[5], wanted[names[5]] + b'?')):
        (killed / name).write_bytes(data)
    said = run('--film', '--resume', scene, '--output', killed / 'f.png')
    assert 'render: 43 kept, 5 drawn' in said and frames_of(killed) == wanted, said
    for words, kept in ((('--frames', 48), 0), (('--frames', 48), 48), (('--film', '--frames', '1:2', '--arrays'), 0), (('--film', '--frames', '1:2'), 0)):
        said = run(*words, '--resume', scene, '--output', killed / 'f.png')  # the same names, and other pictures
        assert f'render: {kept} kept' in said, (words, said)
    said = run('--film', '--resume', '--samples', 1, scene, '--output', killed / 'f.png')
    assert 'render: 0 kept, 48 drawn' in said, said


def test_films_follow_their_curves():
    """Catmull-Rom goes through its keys, Bezier curves are half way at (a + 2 b + c) / 4; a frame is the still of its numbers."""
    still = FILM[:FILM.index('film:')]

    def frame(film, i, changes):
        folder, text = pathlib.Path(tempfile.mkdtemp(dir=FOLDER.name)), still
        run('--film', '--frames', f'{i}:{i}', '--paint', 'status', written(still + film), '--output', folder / 'f.png')
        for old, new in changes:
            assert text.count(old) == 1, old
            text = text.replace(old, new)
        return Picture((folder / f'f-{i:04d}.png').read_bytes()).rows, draw(text, '--paint', 'status')[0].rows

    path, c, here = '[[0, -4, 1], [1, -4, 2], [3, -3, 1]]', '[-0.2, 0.8, 0, 0]', 'iterations: 5'
    keys = 'film: {frames: 5, rate: 2, tracks: [{c: [[0, 0.5, 0, 0], [-0.3, -0.4, 0.3, 0.4], [-0.1, 0, -0.8, 0]]}]}'
    for film, i, changes in (
            (keys, 1, [(path, '[0, -4, 1]'), (c, '[0, 0.5, 0, 0]')]),
            (keys, 3, [(path, '[1.25, -3.75, 1.5]'), (c, '[-0.3, -0.4, 0.3, 0.4]')]),
            (keys, 5, [(path, '[3, -3, 1]'), (c, '[-0.1, 0, -0.8, 0]')]),
            # half way between uneven keys: (a + b) / 2 + (slope at a - slope at b) times / 8
            ('film: {frames: 5, rate: 1, tracks: [{slice: [0, 0.2, 0.1], times: [0, 2, 4]}]}', 2, [(path, '[0.5625, -3.9375, 1.375]'), (here, here + ', slice: 0.11875')]),
            ('film: {frames: 3, rate: 1, tracks: [{position: [[0, -4, 1], [1, -5, 1], [2, -4, 3]], curve: bezier}, {field: [20, 60, 40]}]}', 2,
             [(path, '[1, -4.5, 1.5]'), ('field: 36', 'field: 60')]),
            ('film: {frames: 9, rate: 1, tracks: [{look_at: [[0, 0, 0], [0.5, 0, 0.25]], times: [1, 3]}]}', 9, [(path, '[3, -3, 1]'), ('look_at: [0, 0, 0]', 'look_at: [0.5, 0, 0.25]')])):
        seen, wanted = frame(film, i, changes)
        assert seen == wanted, (film, i)


def test_films_that_are_wrong():
    """Named with line and key; what a curve makes impossible is told with its frame, before any frame is drawn."""
    head, tracks = FILM[:FILM.index('film:')], '    - {exposure: [1, 1.3, 0.8], curve: bezier, times: [0.5, 3]}\n'
    line = FILM.count('\n')
    for old, new, at, key in (('frames: 48', 'frames: 0', 8, 'frames'), ('  frames: 48\n', '', 8, 'frames'), ('rate: 12', 'rate: 0', 9, 'rate'),
                              ('exposure: [1, 1.3, 0.8]', 'exposure: [1]', line, 'exposure'), ('exposure: [1, 1.3, 0.8], curve', 'curve', line, 'tracks'),
                              ('exposure: [1, 1.3, 0.8]', 'exposure: [1, 2], field: [1, 2]', line, 'exposure'), ('[0.5, 3]', '[3, 0.5]', line, 'times'),
                              ('[0.5, 3]', '[0, 1, 2]', line, 'times'), ('curve: bezier', 'curve: straight', line, 'curve'),
                              ('curve: bezier', 'curve: bezier, object: 1', line, 'object'), ('exposure: [1, 1.3, 0.8]', 'slice: [0, 1, 2]', line, 'slice'),
                              ('[-0.1, 0, -0.8, 0]', '[-0.1, 0, -0.8]', 11, 'c')):
        assert FILM.count(old) == 1, old
        path = written(FILM.replace(old, new))
        said = run('--film', path, '--output', path.parent / 'out.png', exit=BAD_INPUT)
        assert f'{path}:{at}: {key}: ' in said, (new, said)
    for old, new, word in (('1.3, 0.8], curve: bezier', '0, 0, 1.5, 0], curve: catmull-rom', 'times'),
                           (tracks, '    - {field: [100, 170, 170, 100]}\n', 'frame 17: field is out of range there'),
                           (tracks, '    - {look_at: [[0, 0, 0], [3, -3, 1]]}\n', 'frame 48: look_at must be'),
                           (tracks, '    - {object: 1, c: [[0, 1, 0, 0], [9e6, 1, 0, 0]]}\n', 'c: ')):
        path = written(FILM.replace(old, new))
        said = run('--film', path, '--output', path.parent / 'out.png', exit=BAD_INPUT)
        assert word in said and not list(path.parent.glob('out*')), (new, said)
    assert 'film: missing' in run('--film', written(head), exit=BAD_INPUT)
    for words, word in ((('--frames', '1:2'), 'of a --film'), (('--film', '--frames', '3'), 'A:B'), (('--film', '--frames', '5:4'), 'above'),
                        (('--film', '--frames', '5:'), 'frames'), (('--resume',), '--resume')):
        assert word in run(*words, written(FILM), exit=USAGE), words
    assert 'only 48 frames' in run('--film', '--frames', '1:49', written(FILM), exit=BAD_INPUT)


def test_pictures_are_whole():
    """A run that is killed, at any time, leaves the picture that was there, or none; links and pipes are followed."""
    scene, random = written(FILM.replace('[30, 20]', '[60, 40]')), Random(1)
    folder = pathlib.Path(tempfile.mkdtemp(dir=FOLDER.name))
    file = folder / 'out.png'
    for words, old in ((('--samples', 4000), None), (('--samples', 4000), b'old'), (('--samples', 4000, '--paint', 'status', '--size', '4000x4000'), b'old')):
        if old:
            file.write_bytes(old)
        alive = subprocess.Popen([RENDER, *map(str, words), '--output', str(file), str(scene)], stderr=subprocess.DEVNULL, env=ENVIRONMENT)
        time.sleep(random.uniform(0.02, 0.2))
        alive.kill()
        alive.wait()
        assert (file.read_bytes() if file.exists() else None) == old, words
        assert [p for p in folder.iterdir() if p != file and p.suffix != '.part'] == []
    def small():  # a disk that is full after 100 bytes
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))

    for words in ((), ('--arrays',), ('--paint', 'evaluations')):
        file.write_bytes(b'old')
        done = subprocess.run([RENDER, *words, '--samples', '1', '--output', str(file), str(scene)], capture_output=True, env=ENVIRONMENT,
                              preexec_fn=small, timeout=100)
        assert done.returncode == BAD_INPUT and b'File too large' in done.stderr, done
        assert [p.name for p in folder.iterdir() if p.suffix != '.part'] == ['out.png'] and file.read_bytes() == b'old', words
    file.unlink(missing_ok=True)
    (folder / 'real.png').write_bytes(b'')
    file.symlink_to('real.png')
    run(scene, '--samples', 1, '--output', file)
    assert file.is_symlink() and Picture((folder / 'real.png').read_bytes()).width == 60
    os.mkfifo(folder / 'pipe.png')
    reader = subprocess.Popen(['cat', str(folder / 'pipe.png')], stdout=subprocess.PIPE)
    run(scene, '--samples', 1, '--output', folder / 'pipe.png')
    assert reader.communicate(timeout=100)[0] == (folder / 'real.png').read_bytes()
    (folder / 'folder.png').mkdir()
    assert 'folder.png: ' in run(scene, '--output', folder / 'folder.png', exit=BAD_INPUT)


def array_of(path):
    """What NumPy's np.load would give, as (shape, flat numbers)."""
    data = path.read_bytes()
    assert data[:8] == b'\x93NUMPY\x01\x00'
    length = struct.unpack('<H', data[8:10])[0]
    assert (10 + length) % 64 == 0
    kind, shape = re.fullmatch(r"\{'descr': '(.*)', 'fortran_order': False, 'shape': \((.*)\), \} *\n", data[10:10 + length].decode()).groups()
    rest = data[10 + length:]
    code, size = {'<f8': ('<%dd', 8), '>f8': ('>%dd', 8), '|i1': ('%db', 1)}[kind]
    return tuple(map(int, shape.split(','))), struct.unpack(code % (len(rest) // size), rest)


def test_arrays():
    """Depth, normal and t_err of a ball against the closed form; the picture is that of a run without them."""
    text = 'picture: {size: [40, 30], samples: 1}\ncamera: {position: [0, -5, 1], look_at: [0, 0, 0], field: 40}\nobjects:\n  - {type: ellipsoid, a: 1.25, position: [0.25, 0, 0]}\n'
    folder = pathlib.Path(tempfile.mkdtemp(dir=FOLDER.name))
    run(written(text), '--arrays', '--output', folder / 'out.png')
    assert sorted(p.name for p in folder.iterdir()) == ['out-depth.npy', 'out-normal.npy', 'out-status.npy', 'out-t_err.npy', 'out.png']
    assert Picture((folder / 'out.png').read_bytes()).rows == draw(text)[0].rows
    (shape, depth), (deep, normal), (_, t_err), (_, status) = (array_of(folder / f'out-{k}.npy') for k in ('depth', 'normal', 't_err', 'status'))
    assert shape == (30, 40) and deep == (30, 40, 3)
    hits = 0
    for i in range(1200):
        d = direction((40, 30), (0, -5, 1), (0, 0, 0), 40, i % 40, i // 40)
        o = (-0.25, -5, 1)
        b = dot(o, d)
        inside = b * b - dot(o, o) + 1.25 ** 2
        if abs(inside) < 1e-9:
            continue
        assert (status[i] > 0) == (inside > 0), i
        if inside < 0:
            assert depth[i] == math.inf and math.isnan(t_err[i]) and math.isnan(normal[3 * i])
            continue
        hits += 1
        t = -b - math.sqrt(inside)
        assert abs(depth[i] - t) < 1e-12 and 0 < t_err[i] < 1e-11, (i, depth[i], t, t_err[i])
        n = unit(add(o, d, t))
        assert max(abs(a - b) for a, b in zip(n, normal[3 * i:3 * i + 3])) < 1e-12
    assert hits > 200
    run('--frames', 2, '--arrays', '--resume', written(FILM[:FILM.index('film:')]), '--output', folder / 'f.png')
    assert (folder / 'f-0002-depth.npy').exists()
    (folder / 'f-0002-depth.npy').unlink()
    assert '1 kept, 1 drawn' in run('--frames', 2, '--arrays', '--resume', written(FILM[:FILM.index('film:')]), '--output', folder / 'f.png')
    again = ('--frames', 2, '--arrays', '--resume', written(FILM[:FILM.index('film:')]), '--output', folder / 'f.png')
    assert '2 kept, 0 drawn' in run(*again)
    whole = (folder / 'f-0001-depth.npy').read_bytes()
    for data in (whole[:-8], whole[:-1] + bytes([whole[-1] ^ 1]), (folder / 'f-0002-depth.npy').read_bytes()):  # cut, changed, of another frame
        (folder / 'f-0001-depth.npy').write_bytes(data)
        assert '1 kept, 1 drawn' in run(*again)
        assert (folder / 'f-0001-depth.npy').read_bytes() == whole


def test_automatic_levels():
    """More levels for a larger picture; the picture is that of the number told.  Only level sets have orbits."""
    text = FILM[:FILM.index('film:')].replace('[[0, -4, 1], [1, -4, 2], [3, -3, 1]]', '[0, -4, 1]').replace('iterations: 5', 'iterations: auto')
    levels = []
    for size in ('30x20', '300x200'):
        picture, said = draw(text, '--size', size, '--paint', 'status')
        levels.append(int(re.search(r'iterations: auto is (\d+)\n', said).group(1)))
        assert draw(text.replace('auto', str(levels[-1])), '--size', size, '--paint', 'status')[0].rows == picture.rows
    assert 2 <= levels[0] < levels[1] < 15, levels
    assert 'auto is of julia' in run(written(text.replace('type: julia, c: [-0.2, 0.8, 0, 0]', 'type: mandelbulb')), exit=BAD_INPUT)
    assert 'a trap is of an orbit' in run(written(text.replace('type: julia, c: [-0.2, 0.8, 0, 0], iterations: auto', 'type: torus, major: 1, minor: 0.3')), exit=BAD_INPUT)
    assert 'trap: only of' in run(written(text.replace('blend: trap', 'blend: x')), exit=BAD_INPUT)


def test_orbit_traps():
    """c = 0, two levels, E = 1 would be a ball; there |Q_1| = |p|^2.  So the colour of a trap at 0 is told by the radius."""
    text = '''picture: {size: [16, 16], samples: 1}
camera: {position: [0, -4, 0], look_at: [0, 0, 0], field: 10}
sky: {zenith: [1, 1, 1], horizon: [1, 1, 1], ground: [1, 1, 1]}
ambient: {strength: 1, rays: 0}
objects:
  - {type: julia, c: [0, 0, 0, 0], escape: 2, iterations: 2, material: {colour: {blend: trap, from: 0, to: 4, colours: [[0, 0, 0], [1, 1, 1]]}}}
'''
    # |Q_2| = r^4 = 2: the nearest to 0 of Q_1, Q_2 is Q_1, sqrt(2) off; to (2, 0, 0, 0) it depends on the place
    seen = {linear(p[0]) for p in draw(text)[0].pixels()}
    assert all(abs(x - math.sqrt(2) / 4) < 0.004 for x in seen), seen
    many = {p for p in draw(text.replace('from: 0', 'trap: [2, 0, 0, 0], from: 0'))[0].pixels()}
    assert len(many) > 8, many


def test_default_name():
    run(written(TORUS, 'named.yaml'))
    assert Picture(pathlib.Path(FOLDER.name, 'named.png').read_bytes()).width == 64


def test_paint():
    """The picture as asked for, a legend below it; costs differ; what is given up is marked and counted."""
    costs, _ = draw(LIT, '--paint', 'evaluations', '--size', '500x40')
    assert costs.width == 500 and 80 < costs.height < 160
    assert len({costs.code(x, y) for y in range(40) for x in range(500)}) >= 3
    small, _ = draw(LIT, '--paint', 'status')
    assert small.width >= 300 and small.height > 48
    assert len({small.code(x, y) for y in range(48, small.height) for x in range(small.width)}) > 10  # words are there
    given_up, said = draw(LIT.replace('minor: 0.4', 'minor: 0.4, max_evals: 1'), '--paint', 'status')
    marked = sum(given_up.code(x, y) == EXHAUSTED for y in range(48) for x in range(64))
    told = re.search(r'render: 3072 rays, .* (\d+) undecided, (\d+) exhausted', said)
    assert told and int(told.group(1)) == int(told.group(2)) == marked > 100, (said, marked)


def test_progress():
    """A bar on a terminal, none elsewhere."""
    try:
        ours, its = pty.openpty()
    except OSError as error:  # a machine without pseudo-terminals: nothing to be seen here
        print(f'the bar of progress is not looked at: {error}')
        return
    done = subprocess.run([RENDER, str(written(TORUS)), '--output', 'bar.png'], stderr=its, cwd=FOLDER.name, env=ENVIRONMENT, timeout=100)
    os.close(its)
    said = os.read(ours, 100000).decode()
    os.close(ours)
    assert done.returncode == 0 and '[####' in said and '100 %' in said and 'rays' in said, said
    assert '[#' not in draw(TORUS)[1]


# --------------------------------------------------------------------------- errors

GOOD = '''name: a scene
picture: {size: [8, 6], samples: 1}
camera: {position: [0, -5, 1], look_at: [0, 0, 0]}
lights:
  - {position: [1, 2, 3]}
objects:
  - {type: julia, c: [-0.2, 0.8, 0, 0], iterations: 4}
  - {type: torus, major: 1, minor: 0.3}
  - {type: sphere, radius: 2, semi_diameter: 1, material: {colour: [1, 0, 0], index: 1.5}}
'''

# what to replace, by what, the line, the key
WRONG = [
    ('name: a scene', 'nmae: a scene', 1, 'nmae'),
    ('name: a scene', 'name: [a]', 1, 'name'),
    ('[8, 6]', '[8]', 2, 'size'),
    ('[8, 6]', '[8, 0]', 2, 'size'),
    ('[8, 6]', '[8, 2.5]', 2, 'size'),
    ('[8, 6]', '8', 2, 'size'),
    ('samples: 1', 'samples: 0', 2, 'samples'),
    ('samples: 1', 'sample: 1', 2, 'sample'),
    ('samples: 1', 'samples: 1, samples: 2', 2, 'samples'),
    ('samples: 1', 'exposure: .nan', 2, 'exposure'),
    ('samples: 1', 'depth: 99', 2, 'depth'),
    ('position: [0, -5, 1], ', '', 3, 'position'),
    ('[0, -5, 1]', '[0, -5]', 3, 'position'),
    ('[0, -5, 1]', '[0, -5, .inf]', 3, 'position'),
    ('[0, -5, 1]', '[[0, -5, 1], [1, 2]]', 3, 'position'),
    ('[0, -5, 1]', '[0, 0, 7]', 3, 'look_at'),
    ('look_at: [0, 0, 0]', 'look_at: [0, 0, 0], field: 180', 3, 'field'),
    ('camera: {position: [0, -5, 1], look_at: [0, 0, 0]}\n', '', 1, 'camera'),
    ('- {position: [1, 2, 3]}', '- {position: [1, 2, x]}', 5, 'position'),
    ('- {position: [1, 2, 3]}', '- {colour: [1, 2, 3]}', 5, 'position'),
    ('- {position: [1, 2, 3]}', '- {position: [1, 2, 3], radius: -1}', 5, 'radius'),
    ('- {position: [1, 2, 3]}', '- 5', 5, 'lights'),
    ('type: julia', 'type: juila', 7, 'type'),
    ('type: julia, ', '', 7, 'type'),
    ('iterations: 4', 'iterations: 0', 7, 'iterations'),
    ('iterations: 4', 'iterations: 10001', 7, 'iterations'),
    ('iterations: 4', 'iterations: 4.5', 7, 'iterations'),
    ('iterations: 4', 'power: 1', 7, 'power'),
    ('iterations: 4', 'power: 9', 7, 'power'),
    ('iterations: 4', 'escape: 0.5', 7, 'escape'),
    ('iterations: 4', 'ex: [1, 0, 0, 0], ey: [2, 0, 0, 0], ez: [0, 0, 1, 0]', 7, 'ey'),
    ('iterations: 4', 'at: [1, 0, 0, 0], slice: 1', 7, 'slice'),
    ('iterations: 4', 'iteration: 4', 7, 'iteration'),
    ('iterations: 4', 'dt_min: -1', 7, 'dt_min'),
    ('iterations: 4', 't_tol: nan', 7, 't_tol'),
    ('iterations: 4', 'scale: 0', 7, 'scale'),
    ('iterations: 4', 'normal: up', 7, 'normal'),
    ('[-0.2, 0.8, 0, 0]', '[-0.2, 0.8, 0]', 7, 'c'),
    ('[-0.2, 0.8, 0, 0]', '[-0.2, 0.8, .nan, 0]', 7, 'c'),
    ('[-0.2, 0.8, 0, 0]', '[-0.2, 1e7, 0, 0]', 7, 'c'),
    ('minor: 0.3', 'minor: -3', 8, 'minor'),
    ('minor: 0.3', 'minor: 0', 8, 'minor'),
    ('minor: 0.3', 'normal: potential', 8, 'minor'),
    ('minor: 0.3', 'minor: 0.3, normal: potential', 8, 'normal'),
    ('radius: 2', 'radius: 0', 9, 'radius'),
    ('radius: 2', 'radius: 2, curvature: 1', 9, 'radius'),
    ('radius: 2', 'conic: 1', 9, 'conic'),
    ('[1, 0, 0], index', '[1, 0, 2], index', 9, 'colour'),
    ('[1, 0, 0], index', '{checks: 1}, index', 9, 'colours'),
    ('[1, 0, 0], index', '{blend: w, colours: [[0, 0, 0], [1, 1, 1]]}, index', 9, 'blend'),
    ('[1, 0, 0], index', '{blend: x, from: 1, to: 1, colours: [[0, 0, 0], [1, 1, 1]]}, index', 9, 'to'),
    ('index: 1.5', 'index: 0.5', 9, 'index'),
    ('index: 1.5', 'indx: 1.5', 9, 'indx'),
    ('material: {colour', 'material: 5, matter: {colour', 9, 'matter'),
    ('  - {type: torus', '  - 7\n  - {type: torus', 8, 'objects'),
    ('  - {type: torus', '  - {[1]: 2, type: torus', 8, 'key'),
    ('minor: 0.3}', 'minor: 0.3', 9, ''),
    ('type: torus, major: 1, minor: 0.3', 'type: zernike, norm: 1, order: noll, coefficients: [0, x]', 8, 'coefficients[1]'),
    ('type: torus, major: 1, minor: 0.3', 'type: zernike, norm: 1, order: bad', 8, 'order'),
    ('type: torus, major: 1, minor: 0.3', 'type: grid, step_x: 1, step_y: 1, sag: absent.csv', 8, 'sag'),
    ('type: torus, major: 1, minor: 0.3', 'type: sum, terms: [{type: torus, major: 1, minor: 0.3}]', 8, 'terms[0]'),
    ('type: torus, major: 1, minor: 0.3', 'type: polynomial_xy, coefficients:\n      [[1, 2],\n       [3, 1,5m]]', 10,
     'coefficients[1][2]'),
    ('major: 1', 'mayor: 1', 8, 'mayor'),
    ('major: 1', 'positon: [0, 0, 0], major: 1', 8, 'rotation scale'),
    ('major: 1', '? "a b\\x41" : 1, major: 1', 8, 'a bA'),
    ('major: 1', 'clip: 5, major: 1', 8, 'clip'),
    ('major: 1', 'clip: {bal: 1}, major: 1', 8, 'ball, box, object, outside'),
    ('major: 1', 'clip: {ball: 0}, major: 1', 8, 'ball'),
    ('major: 1', 'clip: {ball: 1, box: [1, 1, 1]}, major: 1', 8, 'box'),
    ('major: 1', 'clip: {box: [1, 1]}, major: 1', 8, 'box'),
    ('major: 1', 'clip: {object: {type: edge, radius: 1, from: 0, to: 1}}, major: 1', 8, 'edge has no inside'),
    ('major: 1', 'clip: {outside: {type: ellipsoid}}, major: 1', 8, 'a: '),
    ('major: 1', 'clip: {object: {type: ellipsoid, a: 1}, position: [0, 0, 1]}, major: 1', 8, 'position'),
    ('major: 1', 'clip: [], major: 1', 8, 'clip'),
    ('type: torus, major: 1, minor: 0.3', 'type: box, half: [1, 0, 1]', 8, 'half'),
    ('type: torus, major: 1, minor: 0.3', 'union: [{type: ellipsoid, a: 1}]', 8, 'union'),
    ('type: torus, major: 1, minor: 0.3', 'union: 3', 8, 'union'),
    ('{type: torus', '{intersection: [{type: ellipsoid, a: 1}, {type: ellipsoid, a: 2}], type: torus', 8, 'type'),
    ('{type: torus, major: 1, minor: 0.3', '{union: [{type: plane}, {type: plane}], difference: [{type: plane}, {type: plane}]', 8,
     'difference'),
    ('type: torus, major: 1, minor: 0.3', 'union: [{type: plane}, {type: plane}], radius: 1', 8, 'radius'),
    ('{type: torus, major: 1, minor: 0.3}', 'difference:\n    - {type: plane}\n    - {type: plane, semi_diameter: 1}', 10,
     'semi_diameter'),
    ('{type: torus, major: 1, minor: 0.3}', 'difference:\n    - {type: plane}\n    - {type: ellipsoid, a: 1, clip: {ball: 1}}', 10,
     'clip'),
    ('{type: torus, major: 1, minor: 0.3}', 'difference:\n    - {type: plane}\n    - {type: ellipsoid, a: -1}', 10, 'a: '),
    ('  - {type: torus', '  - &a {union: [*a, *a]}\n  - {type: torus', 8, 'union: more than 32 within each other'),
    ('type: torus, major: 1, minor: 0.3', 'type: sum, terms: &b [*b]', 8, 'terms: too long, or holds itself'),
]


def test_errors():
    """Each names file, line and key, and nothing is drawn."""
    run(written(GOOD), '--output', 'good.png')
    for old, new, line, key in WRONG:
        assert GOOD.count(old) == 1, old
        path = written(GOOD.replace(old, new))
        said = run(path, '--output', path.parent / 'out.png', exit=BAD_INPUT)
        assert f'{path}:{line}: ' in said and key in said.split(f':{line}: ')[1], f'{new!r}: {said}'
        assert not (path.parent / 'out.png').exists(), new
    for text, word in (('', 'empty'), ('# nothing', 'empty'), ('[1]', 'map'), (GOOD + '---\n' + GOOD, 'second document'), (GOOD[:GOOD.index('objects')], 'objects')):
        said = run(written(text), exit=BAD_INPUT)
        assert word in said and 'scene.yaml' in said, (text, said)
    for text, line in (('{a: ' * 100000, 1), ('{a:\n' * 100000, 65), ('[' * 100000, 1), ('- ' * 100000, 1)):
        assert f'scene.yaml:{line}: lists and maps within each other more than 64 deep' in run(written(text), exit=BAD_INPUT), text[:10]
    assert 'scene.yaml:1: more than 1000 anchors' in run(written('[' + ''.join(f'&a{i} 1, ' for i in range(100000)) + '1]'), exit=BAD_INPUT)
    assert 'absent.yaml' in run('absent.yaml', exit=BAD_INPUT)
    assert FOLDER.name in run(FOLDER.name, exit=BAD_INPUT)
    assert 'nowhere' in run(written(GOOD), '--output', 'nowhere/out.png', exit=BAD_INPUT)


def options():
    found = re.findall(r'\{"(\w+)", \w+_argument', (pathlib.Path(__file__).parent / 'main.c').read_text())
    assert len(found) == 11, found
    return found


def test_usage():
    good = written(GOOD)
    for words, word in (((), 'scene'), ((good, good), 'one scene'), ((good, '--size', '5'), 'WxH'), ((good, '--size', '5x'), 'size'),
                        ((good, '--size', '0x5'), 'size'), ((good, '--size', '5x5x5'), 'size'), ((good, '--samples', '0'), 'samples'),
                        ((good, '--threads', '-1'), 'threads'), ((good, '--threads', 'two'), 'threads'), ((good, '--frames', '1e3'), 'frames'),
                        ((good, '--paint', 'red'), 'paint'), ((good, '--normal', ''), 'normal'), ((good, '--colour', 'red'), 'colour'),
                        ((good, '--output', 'a.jpg'), '.png'), ((good, '--output'), 'output')):
        said = run(*words, exit=USAGE)
        assert word in said and 'render --help' in said, (words, said)
    text = run('--help')
    for option in options():
        assert f'--{option}' in text, option
    for closed in ('>/dev/full', '>&-') if pathlib.Path('/dev/full').exists() else ():
        done = subprocess.run(['sh', '-c', f'"$0" --help {closed}', RENDER], stderr=subprocess.PIPE, text=True, timeout=100)
        assert done.returncode == BAD_INPUT and 'standard output: ' in done.stderr, (closed, done)


def test_documented():
    """docs/render.md has every key that the reader knows, and every option."""
    here = pathlib.Path(__file__).resolve().parent
    page = (here.parent.parent / 'docs' / 'render.md').read_text()
    reader = (here / 'read.c').read_text()
    keys = set(re.findall(r'(?:read_\w+|document_find)\(&?d, \w+, "(\w+)"', reader))
    keys |= set(re.findall(r'\{"(\w+)", "', (here / 'own.c').read_text()))
    assert len(keys) > 35, keys
    for key in keys:
        assert f'`{key}`' in page, key
    for option in options():
        assert f'`--{option}' in page, option
    for scene in SCENES:
        assert scene.name in page, scene.name


def test_gallery():
    """The page is what its script writes; two dozen pictures, 2 MB at most; each scene of this folder's that is shown is there."""
    docs = pathlib.Path(__file__).resolve().parent.parent.parent / 'docs'
    spec = importlib.util.spec_from_file_location('gallery', docs / 'gallery.py')
    gallery = importlib.util.module_from_spec(spec)
    sys.dont_write_bytecode = True
    spec.loader.exec_module(gallery)
    assert gallery.page() == (docs / 'gallery.md').read_text()
    pictures = [entry for entry in gallery.PICTURES if not isinstance(entry, str)]
    assert {p.name for p in (docs / 'gallery').iterdir()} == {name for name, *_ in pictures} and len(pictures) >= 24
    assert sum(p.stat().st_size for p in (docs / 'gallery').iterdir()) <= 2e6
    for _, _, command in pictures:
        for word in command.split():
            assert not word.endswith('.yaml') or (docs.parent / word).exists(), command


def main():
    failed = 0
    for name, test in list(globals().items()):
        if name.startswith('test_'):
            try:
                test()
            except Exception:
                failed += 1
                print(f'FAILED {name}: {test.__doc__ or ""}\n{traceback.format_exc()}')
            else:
                print(f'ok     {name}', flush=True)
    sys.exit(1 if failed else 0)


main()
