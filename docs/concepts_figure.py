#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The picture of concepts.md, its numbers from the command itself.

    python3 docs/concepts_figure.py build/src/tool/sagitta > docs/concepts_figure.svg
"""
import csv
import io
import math
import subprocess
import sys

R = -2.2136
SURFACE = f'{{type: sphere, radius: {R}}}'
O = (0.5, -5.0)                                     # y, z
D = (0.3420201433256687, 0.9396926207859084)        # 20 degrees
RAY = f'0 {O[0]} {O[1]} 0 {D[0]} {D[1]}'


def rows(sagitta, *arguments):
    said = subprocess.run([sagitta, *arguments, '--format', 'csv'], text=True, capture_output=True,
                          check=True)
    return list(csv.DictReader(io.StringIO(said.stdout)))


def main(sagitta):
    [hit] = rows(sagitta, 'intersect', '--surface', SURFACE, '--ray', RAY)
    steps = rows(sagitta, 'diagnose', '--surface', SURFACE, '--ray', RAY, '--method', 'newton')
    t_root, y_root, z_root = (float(hit[name]) for name in ('t', 'y', 'z'))
    t_seed, t_back, t_newton = (float(step['t']) for step in steps[:3])

    scale, left, top = 130, -5.35, 2.95             # pixels a length; the corner at z, y
    def X(z): return round((z - left) * scale, 1)
    def Y(y): return round((top - y) * scale, 1)
    def at(t): return O[1] + t * D[1], O[0] + t * D[0]
    out = []
    def line(z1, y1, z2, y2, style):
        out.append(f'<line x1="{X(z1)}" y1="{Y(y1)}" x2="{X(z2)}" y2="{Y(y2)}" {style}/>')
    def dot(t, style, r=5):
        z, y = at(t)
        out.append(f'<circle cx="{X(z)}" cy="{Y(y)}" r="{r}" {style}/>')
    def text(z, y, words, style=''): out.append(f'<text x="{X(z)}" y="{Y(y)}" {style}>{words}</text>')

    rim = abs(R)
    # the domain of the sag, r <= |R|, and its edge
    out.append(f'<rect x="{X(-5.25)}" y="{Y(rim)}" width="{X(1.2) - X(-5.25)}" height="{Y(-0.75) - Y(rim)}" '
               f'fill="#eef3f8"/>')
    line(-5.25, rim, 1.2, rim, 'stroke="#7a93ab" stroke-dasharray="6 4"')
    text(-5.2, rim + 0.07, 'edge of the domain, r = |R|; F is NaN beyond', 'fill="#4d6880"')
    # axis, vertex plane
    line(-5.25, 0, 1.2, 0, 'stroke="#888" stroke-dasharray="12 4 2 4"')
    text(0.62, 0.08, 'z axis', 'fill="#666"')
    line(0, -0.75, 0, 2.75, 'stroke="#888"')
    text(0.06, -0.65, 'vertex plane, z = 0', 'fill="#666"')
    text(0.06, -0.17, 'vertex', 'fill="#666"')
    # the surface: z = s(y)
    points = []
    for i in range(0, 201):
        y = -0.75 + (rim + 0.75) * math.sin(math.pi / 2 * i / 200)
        points.append(f'{X(R + math.sqrt(max(R * R - y * y, 0)))},{Y(y)}')
    out.append(f'<polyline points="{" ".join(points)}" fill="none" stroke="#1f4e79" stroke-width="2.5"/>')
    text(-0.42, 0.62, 'F = 0', 'fill="#1f4e79" font-weight="bold" text-anchor="end"')
    # the ray
    t_edge = (rim - O[0]) / D[0]
    (z1, y1), (z2, y2), (z3, y3) = at(0), at(t_edge), at(6.05)
    line(z1, y1, z2, y2, 'stroke="#b03a2e" stroke-width="5" stroke-opacity="0.3"')
    line(z1, y1, z3, y3, 'stroke="#b03a2e" stroke-width="1.8"')
    text(z1 - 0.02, y1 - 0.24, 'o', 'fill="#b03a2e" font-style="italic" font-weight="bold"')
    text(-4.3, 0.45, 'ray o + t d', 'fill="#b03a2e"')
    text(-2.75, 0.95, 'chord of the domain', 'fill="#b03a2e"')
    text(-2.75, 0.79, f'(thick), to t = {t_edge:.4f}:', 'fill="#b03a2e"')
    text(-2.75, 0.63, 'the span', 'fill="#b03a2e"')
    dot(0, 'fill="#b03a2e"', 4)
    # the sag at the root
    line(z_root, y_root, 0, y_root,
         'stroke="#2e7d32" stroke-width="1.8" marker-start="url(#tip)" marker-end="url(#tip)"')
    text(z_root / 2 + 0.1, y_root + 0.07, 's(r)', 'fill="#2e7d32" font-style="italic" text-anchor="middle"')
    text(0.08, y_root - 0.05, f'sag at the root: {z_root:.5g}', 'fill="#2e7d32"')
    # the gradient there
    ny = float(hit['ny'])
    line(z_root, y_root, z_root + 0.45, y_root + 0.45 * ny,
         'stroke="#1f4e79" stroke-width="1.5" marker-end="url(#tip2)"')
    text(z_root + 0.43, y_root + 0.45 * ny + 0.06, 'grad F', 'fill="#1f4e79" text-anchor="end"')
    # the iterates
    dot(t_seed, 'fill="white" stroke="#b03a2e" stroke-width="2"')
    text(0.1, at(t_seed)[1] - 0.06, f'seed, t = {t_seed:.4f}: F is NaN', '')
    dot(t_back, 'fill="#e59866" stroke="#b03a2e"')
    text(at(t_back)[0] + 0.04, at(t_back)[1] - 0.2, f'back off, t = {t_back:.4f}', '')
    dot(t_newton, 'fill="#e59866" stroke="#b03a2e"')
    dot(t_root, 'fill="#b03a2e"')
    line(z_root - 0.03, y_root + 0.04, -1.3, rim + 0.06, 'stroke="#555" stroke-width="0.8"')
    text(-1.25, rim + 0.09, f'root, t = {t_root:.4f}', 'text-anchor="end" font-weight="bold"')
    z, y = at(t_newton)
    line(z, y - 0.05, z - 0.05, y - 0.84, 'stroke="#555" stroke-width="0.8"')
    text(z - 0.5, y - 1.0, f'Newton, t = {t_newton:.4f}', '')

    width, height = X(1.95), Y(-0.85)
    print(f'''<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" font-family="DejaVu Sans, Helvetica, Arial, sans-serif" font-size="14">
<title>A ray meets a spherical sag: vertex plane, domain, seed, back-off, root</title>
<defs>
<marker id="tip" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="7" markerHeight="7" orient="auto-start-reverse"><path d="M0 0L8 4L0 8z" fill="#2e7d32"/></marker>
<marker id="tip2" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" markerHeight="8" orient="auto"><path d="M0 0L8 4L0 8z" fill="#1f4e79"/></marker>
</defs>
<rect width="{width}" height="{height}" fill="white"/>''')
    print('\n'.join(out))
    print('</svg>')


main(*sys.argv[1:])
