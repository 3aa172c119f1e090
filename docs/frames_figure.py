#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The picture of lens_file.md and tolerance.md: frames, breaks and the signs of tilts, as the command has them.

    python3 docs/frames_figure.py build/src/tool/sagitta > docs/frames_figure.svg

Nothing here is placed by a formula of its own.  Each panel is a lens file.  Three rays through it are traced, with
points in the global frame and in each surface's own: that gives the vertex and the axes of every surface (`poses`).
The panels of tolerances draw the lens that `sagitta tolerance --worst` has written.  What the pages say in words is
asserted beside the drawing, so a sign that differs stops the script.
"""
import csv
import io
import math
import pathlib
import re
import subprocess
import sys
import tempfile

WIDE, HIGH, MARGIN = 440, 268, 8               # a panel, in pixels
DARK, LIGHT, GREY = '#1f4e79', '#b03a2e', '#777'


class Command:
    def __init__(self, program, folder):
        self.program, self.folder = program, pathlib.Path(folder)

    def run(self, *words):
        return subprocess.run([self.program, *map(str, words)], text=True, capture_output=True, check=True).stdout

    def file(self, name, text):
        (self.folder / name).write_text(text)
        return self.folder / name

    def points(self, lens, frame):
        """[ray][element]: x, y, z, of rays along z through (0, 0), (0.1, 0) and (0, 0.1)."""
        rays = self.file('rays.csv', 'ox,oy,oz,dx,dy,dz\n0,0,-4,0,0,1\n0.1,0,-4,0,0,1\n0,0.1,-4,0,0,1\n')
        said = self.run('trace', lens, '--rays', rays, '--frame', frame, '--format', 'csv')
        found = {}
        for row in csv.DictReader(io.StringIO(said)):
            assert row['fate'] == 'passed', row
            found.setdefault(row['ray'], []).append([float(row[k]) for k in 'xyz'])
        return list(found.values())

    def poses(self, text):
        """(vertex, ex, ey, ez) of each surface, all of them planes, and where the first ray meets them."""
        lens = self.file('lens.yaml', text)
        whole, own = self.points(lens, 'global'), self.points(lens, 'local')
        found = []
        for i in range(len(whole[0])):
            (p, q, r), (a, b, c) = [ray[i] for ray in whole], [ray[i] for ray in own]
            (bx, by), (cx, cy) = [(s[0] - a[0], s[1] - a[1]) for s in (b, c)]
            dq, dr, det = [x - y for x, y in zip(q, p)], [x - y for x, y in zip(r, p)], bx * cy - by * cx
            ex = [(u * cy - v * by) / det for u, v in zip(dq, dr)]
            ey = [(v * bx - u * cx) / det for u, v in zip(dq, dr)]
            ez = [ex[(k + 1) % 3] * ey[(k + 2) % 3] - ex[(k + 2) % 3] * ey[(k + 1) % 3] for k in range(3)]
            found.append(([s - a[0] * u - a[1] * v for s, u, v in zip(p, ex, ey)], ex, ey, ez))
        return found, whole[0]

    def built(self, surfaces, entry):
        """The text of the lens that a tolerance with one entry makes, at its upper end."""
        lens = self.file('design.yaml', f'units: mm\npupil: {{semi_diameter: 1}}\nsurfaces:\n{surfaces}'
                                        f'tolerances:\n  - {entry}\n')
        worst = self.folder / 'worst.yaml'
        self.run('tolerance', lens, '--trials', '1', '--worst', worst)
        return worst.read_text()


class Panel:
    """A rectangle with a scene: z to the right, y up, x into the page."""

    def __init__(self, place, title, code, zoom, z0, y0):
        self.left, self.top = MARGIN + place % 2 * (WIDE + MARGIN), MARGIN + place // 2 * (HIGH + MARGIN)
        self.zoom, self.z0, self.y0 = zoom, z0, y0
        self.out = [f'<rect x="{self.left}" y="{self.top}" width="{WIDE}" height="{HIGH}" fill="none" '
                    f'stroke="#bbb"/>']
        self.words(10, 22, title, 'font-weight="bold"')
        for i, line in enumerate(code):
            self.words(10, 41 + 15 * i, line, 'font-size="12" font-family="DejaVu Sans Mono, monospace" fill="#333"')

    def words(self, x, y, text, style=''):
        text = text.replace('&', '&amp;').replace('<', '&lt;')
        self.out.append(f'<text x="{self.left + x:.1f}" y="{self.top + y:.1f}" '
                        f'xml:space="preserve" {style}>{text}</text>')

    def at(self, p):
        """A point (y, z), or (x, y, z), in pixels of the panel."""
        y, z = p[-2:]
        return self.z0 + z * self.zoom, self.y0 - y * self.zoom

    def label(self, p, text, dx=0, dy=0, style=''):
        x, y = self.at(p)
        self.words(x + dx, y + dy, text, style)

    def line(self, p, q, style):
        (a, b), (c, d) = self.at(p), self.at(q)
        self.out.append(f'<line x1="{self.left + a:.1f}" y1="{self.top + b:.1f}" x2="{self.left + c:.1f}" '
                        f'y2="{self.top + d:.1f}" {style}/>')

    def path(self, points, style):
        text = ' '.join(f'{self.left + x:.1f},{self.top + y:.1f}' for x, y in map(self.at, points))
        self.out.append(f'<polyline points="{text}" fill="none" {style}/>')

    def arc(self, centre, radius, begin, end, style=f'stroke="{LIGHT}" stroke-width="1.6" marker-end="url(#turn)"'):
        """Of a turn, in degrees from z toward y."""
        self.path([(centre[-2] + radius * math.sin(a), centre[-1] + radius * math.cos(a))
                   for a in (math.radians(begin + (end - begin) * i / 24) for i in range(25))], style)

    def axes(self, p, names=('y', 'z'), size=2.6, ey=(0, 1, 0), ez=(0, 0, 1), colour=GREY):
        """Two arrows at p."""
        style = f'stroke="{colour}" stroke-width="1.4" marker-end="url(#{"own" if colour == DARK else "axis"})"'
        for name, e in zip(names, (ey, ez)):
            if not name:
                continue
            tip = [p[-2] + size * e[-2], p[-1] + size * e[-1]]
            self.line(p, tip, style)
            beyond = size + 0.55 if colour == GREY or e is ez else 0.8 * size
            beside = 0 if colour == GREY or e is ez else -0.8       # y' of a surface stands beside its line
            self.label([t + beyond * a + beside * b for t, a, b in zip(p[-2:], e[-2:], ez[-2:])], name, -4, 4,
                       f'fill="{colour}" font-style="italic" font-size="13"')

    def surface(self, pose, half=3.4, style=f'stroke="{DARK}" stroke-width="4"', names=("y'", "z'"), own=True):
        vertex, _, ey, ez = pose
        self.line(*[[v + s * half * e for v, e in zip(vertex, ey)] for s in (-1, 1)], style)
        if own:
            self.axes(vertex, names, 2.4, ey, ez, DARK)

    def dashed(self, *points):
        self.path(points, f'stroke="{GREY}" stroke-dasharray="7 3 2 3"')

    def ray(self, *points):
        for p, q in zip(points, points[1:]):
            self.line(p, q, f'stroke="{LIGHT}" stroke-width="1.5" marker-end="url(#light)"')

    def ghost(self, vertex, half=3.4):
        self.line((vertex[-2] - half, vertex[-1]), (vertex[-2] + half, vertex[-1]),
                  f'stroke="{GREY}" stroke-width="1.5" stroke-dasharray="5 4"')


def lens(*surfaces):
    return 'pupil: {semi_diameter: 1}\nsurfaces:\n' + ''.join(f'  - {{{s}}}\n' for s in surfaces)


def near(a, b):
    return max(abs(x - y) for x, y in zip(a, b)) < 1e-9


def signs(command):
    """The three turns, each seen so that its axis is at right angles to the page."""
    panel = Panel(0, 'Signs of tilts: right-handed, in degrees', [], 15, 0, 0)
    sine, cosine = math.sin(math.radians(25)), math.cos(math.radians(25))
    for i, (turned, seen, up, right, away, says) in enumerate([
            ('[25, 0, 0]', 'x: into the page', 1, 2, True, 'about x: y toward z'),
            ('[0, 25, 0]', 'y: out of the page', 0, 2, False, 'about y: z toward x'),
            ('[0, 0, 25]', 'z: out of the page', 1, 0, False, 'about z: x toward y')]):
        (_, pose), _ = command.poses(lens('type: plane, thickness: 5', f'type: plane, tilt: {turned}'))
        vertex, *e = pose
        # The words: the axis keeps its place, and the axis named first turns toward the one named second.
        axis = 'xyz'.index(says[6])
        first, second = 'xyz'.index(says[9]), 'xyz'.index(says[-1])
        assert abs(e[axis][axis] - 1) < 1e-9 and abs(e[first][second] - sine) < 1e-9, says
        assert abs(e[first][first] - cosine) < 1e-9
        panel.z0, panel.y0 = 62 + 142 * i, 142
        flat = [(e[k][up], e[k][right]) for k in (up, right)]
        panel.axes((0, 0), ('xyz'[up], 'xyz'[right]), 4.2, (1, 0), (0, 1))
        x, y = panel.left + panel.z0, panel.top + panel.y0
        for colour, (ey, ez) in (('old', ((1, 0), (0, 1))), ('new', flat)):
            style = f'stroke="{GREY}" stroke-width="1.5" stroke-dasharray="5 4"' if colour == 'old' else \
                f'stroke="{DARK}" stroke-width="4"'
            if axis == 2:       # seen from the front: a square
                corners = [[a * u + b * v for u, v in zip(ey, ez)] for a, b in
                           ((2.3, 2.3), (2.3, -2.3), (-2.3, -2.3), (-2.3, 2.3), (2.3, 2.3))]
                panel.path(corners, style.replace('"4"', '"2.5"'))
            else:
                panel.line([-3 * u for u in ey], [3 * u for u in ey], style)
        # From where the axis named first was to where it is, in degrees from the right toward up.
        def degrees(v): return math.degrees(math.atan2(*v))
        old = {up: (1, 0), right: (0, 1)}[first]
        begin, end = degrees(old), degrees((e[first][up], e[first][right]))
        panel.arc((0, 0), 3.5, begin, end)
        panel.out.append(f'<circle cx="{x}" cy="{y}" r="6" fill="white" stroke="black"/>')
        panel.out.append(f'<path d="M{x - 4} {y - 4}L{x + 4} {y + 4}M{x - 4} {y + 4}L{x + 4} {y - 4}" stroke="black"/>'
                         if away else f'<circle cx="{x}" cy="{y}" r="2"/>')
        for j, (text, style) in enumerate([
                (f'tilt: {turned}', 'font-family="DejaVu Sans Mono, monospace" font-size="12"'),
                (says, 'font-size="13"'), (seen, 'font-size="12" fill="#555"')]):
            panel.words(12 + 142 * i, 222 + 17 * j, text, style)
    panel.words(10, 46, 'dashed: before.  solid: the surface, turned by +25', 'font-size="12" fill="#555"')
    return panel


def own(command):
    poses, _ = command.poses(lens('type: plane, thickness: 9',
                                  'type: plane, thickness: 9, decenter: [0, 1.5, 0], tilt: [20, 0, 0]',
                                  'type: plane'))
    assert near(poses[1][0], (0, 1.5, 9)) and near(poses[2][0], (0, 0, 18)) and poses[1][2][2] > 0
    panel = Panel(1, 'One surface: its own decenter and tilt', ['- {type: plane, thickness: 9}',
                  '- {type: plane, thickness: 9, decenter: [0, 1.5, 0],', '   tilt: [20, 0, 0]}', '- {type: plane}'], 16, 92, 178)
    panel.dashed((0, -2.5), (0, 20))
    panel.axes((-2.6, -4.6), size=2.2)
    panel.surface(poses[0], own=False)
    panel.ghost((0, 0, 9))
    panel.surface(poses[1])
    panel.surface(poses[2], own=False)
    for name, z in (('1', 0), ('2', 9), ('3', 18)):
        panel.label((-3.4, z), name, -4, 16)
    panel.words(10, 262, '3 stays where it was', 'font-size="12" fill="#555"')
    return panel


def broken(command, place, order):
    text = '' if order == 'decenter_first' else f', order: {order}'
    poses, _ = command.poses(lens('type: plane, thickness: 6',
                                  f'type: break, decenter: [0, 3], tilt: [25, 0, 0], thickness: 0{text}',
                                  'type: plane, thickness: 9', 'type: plane'))
    sine, cosine = math.sin(math.radians(25)), math.cos(math.radians(25))
    corner = (0, 3, 6) if order == 'decenter_first' else (0, 3 * cosine, 6 + 3 * sine)
    assert near(poses[1][0], corner) and near(poses[1][3], (0, -sine, cosine))
    assert near(poses[2][0], [v + 9 * e for v, e in zip(poses[1][0], poses[1][3])])
    words = {'decenter_first': ('A break: moved, then turned (decenter_first)', 'up by 3 along the old y, then turned there'),
             'tilt_first': ('A break: turned, then moved (tilt_first)', 'turned, then up by 3 along the new y')}[order]
    panel = Panel(place, words[0], ['- {type: plane, thickness: 6}', '- {type: break, decenter: [0, 3], tilt: [25, 0, 0],',
                  f'   thickness: 0{text}}}', '- {type: plane, thickness: 9}', '- {type: plane}'], 15, 92, 186)
    panel.dashed((0, -2.5), (0, 6), corner, poses[2][0], [v + 2 * e for v, e in zip(poses[2][0], poses[2][3])])
    panel.axes((-2.2, -4.8), size=2.2)
    panel.surface(poses[0], 2.6, own=False)
    beside = 0 if order == 'decenter_first' else 0.8        # not hidden by the surface
    shift = [beside * e for e in poses[1][3]]
    panel.line([v + s for v, s in zip((0, 0, 6), shift)], [v + s for v, s in zip(corner, shift)],
               f'stroke="{LIGHT}" stroke-width="1.8" marker-end="url(#light)"')
    panel.surface(poses[1], 2.6)
    panel.surface(poses[2], 2.6)
    panel.label((-2.6, 0), '1', -4, 16)
    panel.label([v - 2.6 * e for v, e in zip(poses[1][0], poses[1][2])], '2', -12, 14)
    panel.label([v - 2.6 * e for v, e in zip(poses[2][0], poses[2][2])], '3', 6, 8)
    panel.words(10, 262, words[1], 'font-size="12" fill="#555"')
    return panel


def fold(command):
    poses, met = command.poses(lens('type: plane, thickness: 10', 'type: break, tilt: [45, 0, 0], thickness: 0',
                                    'type: plane, mirror: true, thickness: 0',
                                    'type: break, tilt: [45, 0, 0], thickness: -7', 'type: plane'))
    assert near(poses[2][0], (0, 7, 10)) and near(poses[2][3], (0, -1, 0))
    panel = Panel(4, 'A mirror folds the light up', ['- {type: plane, thickness: 10}', '- {type: break, tilt: [45, 0, 0], thickness: 0}',
                  '- {type: plane, mirror: true, thickness: 0}',
                  '- {type: break, tilt: [45, 0, 0], thickness: -7}', '- {type: plane}'], 14.5, 125, 222)
    panel.ray((0, -4), *met)
    panel.axes((-2.2, -8), size=2.2)
    panel.surface(poses[0], 2, own=False)
    panel.surface(poses[1], 3, own=False)
    panel.surface(poses[2], 2.4)
    panel.label((-2, 0), '1', -4, 15)
    panel.label((-1.9, 8), '2', -12, 12)
    panel.label(poses[2][0], '3', -56, 4)
    panel.words(310, 178, 'thickness -7:', 'font-size="12" fill="#555"')
    panel.words(310, 193, 'against the new z', 'font-size="12" fill="#555"')
    return panel


def origins(command):
    poses, met = command.poses(lens('type: plane, origin: [0, 0, 0]',
                                    'type: plane, mirror: true, origin: [0, 0, 16], tilt: [30, 0, 0]',
                                    'type: plane, origin: [0, 7.7942, 11.5], tilt: [60, 0, 0]'))
    assert near(poses[1][0], (0, 0, 16)) and met[2][1] > 7
    panel = Panel(5, 'Vertices given by origin: no running frame', ['- {type: plane, origin: [0, 0, 0]}',
                  '- {type: plane, mirror: true, origin: [0, 0, 16],', '   tilt: [30, 0, 0]}',
                  '- {type: plane, origin: [0, 7.7942, 11.5],', '   tilt: [60, 0, 0]}'], 13, 100, 229)
    panel.ray((0, -4), *met)
    panel.axes((-2, -6.8), size=2.2)
    panel.surface(poses[0], 2, own=False)
    panel.surface(poses[1], 3, own=True)
    panel.surface(poses[2], 2.4)
    panel.label((-2, 0), '1', 6, 6)
    panel.label((-2.4, 14.6), '2', -12, 4)
    panel.label([v - 2.4 * e for v, e in zip(poses[2][0], poses[2][2])], '3', -14, 10)
    return panel


def fringes(command):
    panel = Panel(6, 'tolerances: fringes, and the sign of a radius',
                  ['{surface: 2, fringes: d}, d > 0 (drawn much too large)'], 22, 0, 150)
    d, half = 2400, 4
    for i, radius in enumerate((9, -9)):
        text = command.built('  - {type: plane, thickness: 5, stop: true}\n'
                             f'  - {{type: sphere, radius: {radius}, semi_diameter: {half}, thickness: 9, index: 1.5}}\n'
                             '  - {type: plane}\n', f'{{surface: 2, fringes: [{d}, {d + 0.001}]}}')
        curvature = float(re.search(r'type: sphere, (radius|curvature): ([-\d.e]+)', text)[2])
        curvature = 1 / curvature if abs(curvature) > 1 else curvature
        assert abs(curvature - (1 / radius + d * 0.5461e-3 / half ** 2)) < 1e-5

        def sag(c, y): return c * y * y / (1 + math.sqrt(1 - c * c * y * y))
        assert sag(curvature, half) > sag(1 / radius, half)
        panel.z0 = 100 + 215 * i
        ys = [half * (k / 20 - 1) for k in range(41)]
        panel.axes((0, 0), ('', 'z'), 3.1)
        panel.path([(y, sag(1 / radius, y)) for y in ys], f'stroke="{GREY}" stroke-width="2" stroke-dasharray="5 4"')
        panel.path([(y, sag(curvature, y)) for y in ys], f'stroke="{DARK}" stroke-width="4"')
        for y in (half, -half):
            panel.line((y, sag(1 / radius, y)), (y, sag(curvature, y)),
                       f'stroke="{LIGHT}" stroke-width="1.6" marker-end="url(#light)"')
        panel.words(20 + 215 * i, 256, 'radius > 0: more curved' if i == 0 else 'radius < 0: flatter', 'font-size="13"')
    panel.words(142, 82, 'the edge goes toward +z,', 'font-size="12" fill="#555"')
    panel.words(142, 97, 'by d half waves', 'font-size="12" fill="#555"')
    return panel


def tilted(command):
    design = ('  - {type: plane, thickness: 7, stop: true}\n  - {type: plane, thickness: 6, index: 1.5}\n'
              '  - {type: plane, thickness: 7, index: 1}\n  - {type: plane}\n')
    text = command.built(design, '{surfaces: [2, 3], tilt_x: [14.9999999, 15], pivot: 3}')
    poses, _ = command.poses(text)
    pivot, turn = (0, 0, 10), math.radians(15)
    for vertex, z in ((poses[1][0], -3), (poses[2][0], 3)):
        assert max(abs(a - b) for a, b in zip(vertex, (0, -math.sin(turn) * z, 10 + math.cos(turn) * z))) < 1e-6
    assert near(poses[3][0], (0, 0, 20))
    panel = Panel(7, 'tolerances: tilt_x of two surfaces, about a pivot',
                  ['{surfaces: [2, 3], tilt_x: d, pivot: 3}, d > 0'], 15, 92, 160)
    panel.dashed((0, -2.5), (0, 21.5))
    panel.axes((-2.9, -5), size=2.2)
    panel.surface(poses[0], 2.8, own=False)
    for z in (7, 13):
        panel.ghost((0, 0, z))
    for pose in poses[1:3]:
        panel.surface(pose, own=False)
    panel.surface(poses[3], 2.8, own=False)
    panel.ghost(pivot, 4.6)
    panel.line(pivot, (4.6 * math.cos(turn), 10 + 4.6 * math.sin(turn)), f'stroke="{LIGHT}" stroke-width="1.2"')
    panel.arc(pivot, 4.6, 90, 75)
    panel.words(180, 262, 'dot: the pivot, 3 behind vertex 2.  4 stays', 'font-size="12" fill="#555"')
    x, y = panel.at(pivot)
    panel.out.append(f'<circle cx="{panel.left + x}" cy="{panel.top + y}" r="4"/>')
    for name, p in (('1', (-2.8, 0)), ('2', (-3.4, 6)), ('3', (-3.4, 12.4)), ('4', (-2.8, 20))):
        panel.label(p, name, -4, 18)
    return panel


def main(program):
    with tempfile.TemporaryDirectory() as folder:
        command = Command(program, folder)
        panels = [signs(command), own(command), broken(command, 2, 'decenter_first'), broken(command, 3, 'tilt_first'),
                  fold(command), origins(command), fringes(command), tilted(command)]
    width, height = 2 * WIDE + 3 * MARGIN, 4 * HIGH + 5 * MARGIN
    tip = '<marker id="{}" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">' \
          '<path d="M0 0L8 4L0 8z" fill="{}"/></marker>'
    print(f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" '
          'font-family="DejaVu Sans, Helvetica, Arial, sans-serif" font-size="14">')
    print('<title>Frames, breaks, and the signs of tilts and tolerances</title>\n<defs>')
    for name, colour in (('axis', GREY), ('own', DARK), ('light', LIGHT), ('turn', LIGHT)):
        print(tip.format(name, colour))
    print(f'</defs>\n<rect width="{width}" height="{height}" fill="white"/>')
    for panel in panels:
        print('\n'.join(panel.out))
    print('</svg>')


if __name__ == '__main__':
    main(*sys.argv[1:])
