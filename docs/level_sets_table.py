#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The tables of data/level_sets.md, and docs/level_sets.svg (docs/tables.py has the convention).

    python3 docs/level_sets_table.py build
"""
import csv
import math
import sys

import tables

FAMILIES = [  # of variants: name, legend, colour, shape
    ('certified', 'certified: t_tol = 0, 1e-6, 1e-3', '#1f4e79', 'square'),
    ('estimate', 'max(estimate, dt_min), the library: 1e-1 ... 1e-4', '#2e8b57', 'circle'),
    ('estimate-by-hand', 'the same by hand', '#8fbc8f', 'circle'),
    ('estimate-newton', 'max(estimate, Newton, dt_min) by hand: 1e-1 ... 1e-4', '#c0392b', 'circle'),
    ('constant', 'constant steps by hand: 1e-1, 1e-2, 1e-3', '#7f7f7f', 'circle'),
    ('own-surface', 'constant steps, the library: 1e-2', '#c0c0c0', 'circle'),
    ('stop', 'stop at estimate &lt; eps by hand: 1e-2, 1e-3, 1e-4, 1e-6', '#8e44ad', 'circle'),
    ('povray', 'POV-Ray: precision 20, 100, 500', '#e08e0b', 'diamond'),
]
COLUMNS = [('c1-N7', 'c = (-0.083, 0, -0.83, -0.025), N = 7'), ('c1-N11', 'the same c, N = 11')]
WIDTH, HEIGHT, LEFT, TOP, GAP = 420, 320, 70, 40, 60
X_LOW, X_HIGH = 2.65, 4.7                            # decades of ns


def wrong(row):
    return (int(row['missed']) + int(row['late']) + int(row['false'])) / int(row['hits'])


def error(row):
    return float(row['err_99'])


ROWS = [  # title, what, lowest decade, highest, what is said below it, whose ends are lettered
    ('hits that are wrong: missed, late or false, by the hits there are', wrong, -6, 0, 'none',
     ('estimate', 'estimate-newton', 'povray')),
    ('error of t that 99 % of the other hits do not exceed', error, -16, 0, '0',
     ('certified', 'stop', 'povray')),
]


def parts(variant):
    family, _, parameter = variant.partition(' ')
    return family, parameter.partition('=')[2]


def mark(shape, x, y, colour):
    if shape == 'square':
        return f'<rect x="{x - 5:.1f}" y="{y - 5:.1f}" width="10" height="10" fill="{colour}"/>'
    if shape == 'diamond':
        return f'<path d="M{x:.1f} {y - 7:.1f} l7 7 l-7 7 l-7 -7 z" fill="{colour}"/>'
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="{colour}"/>'


def power(e):
    return f'10<tspan dy="-5" font-size="9">{e}</tspan>'


def panel(out, rows, left, top, what, low, high, floor, lettered):
    band = 22                                        # the strip below the lowest decade, for 0
    def X(ns): return left + (math.log10(ns) - X_LOW) / (X_HIGH - X_LOW) * WIDTH
    def Y(v):
        if v > 10.0**low:
            return top + (high - math.log10(v)) / (high - low) * (HEIGHT - band)
        return top + HEIGHT - band / 2
    out.append(f'<rect x="{left}" y="{top + HEIGHT - band}" width="{WIDTH}" height="{band}" fill="#eef3f8"/>')
    out.append(f'<text x="{left - 8}" y="{top + HEIGHT - band / 2 + 4}" text-anchor="end">{floor}</text>')
    for ns in (500, 1000, 2000, 5000, 10000, 20000, 50000):
        x = X(ns)
        out.append(f'<line x1="{x:.1f}" y1="{top}" x2="{x:.1f}" y2="{top + HEIGHT}" stroke="#ddd"/>')
        out.append(f'<text x="{x:.1f}" y="{top + HEIGHT + 16}" text-anchor="middle">{ns}</text>')
    for e in range(low, high + 1, 1 if high - low < 8 else 4):
        y = top + (high - e) / (high - low) * (HEIGHT - band)
        out.append(f'<line x1="{left}" y1="{y:.1f}" x2="{left + WIDTH}" y2="{y:.1f}" stroke="#ddd"/>')
        if e > low:
            out.append(f'<text x="{left - 8}" y="{y + 4:.1f}" text-anchor="end">{power(e)}</text>')
    out.append(f'<rect x="{left}" y="{top}" width="{WIDTH}" height="{HEIGHT}" fill="none" stroke="#888"/>')
    for family, _, colour, shape in FAMILIES:
        points = [(X(float(r['ns'])), Y(what(r)), parts(r['variant'])[1]) for r in rows
                  if parts(r['variant'])[0] == family and what(r) == what(r)]
        if len(points) > 1:
            line = ' '.join(f'{x:.1f},{y:.1f}' for x, y, _ in points)
            out.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="1.5" '
                       f'opacity="0.6"/>')
        for i, (x, y, parameter) in enumerate(points):
            out.append(mark(shape, x, y, colour))
            if i in (0, len(points) - 1) and family in lettered:
                place = f'x="{x + 8:.1f}"' if i else f'x="{x - 8:.1f}" text-anchor="end"'
                out.append(f'<text {place} y="{y + 3:.1f}" font-size="10" fill="{colour}">{parameter}</text>')


def picture(data):
    across, down = LEFT + 2 * (WIDTH + GAP) + 20, TOP + 2 * (HEIGHT + GAP) + 4 * 20 + 20
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {across} {down}" font-family="sans-serif" '
           f'font-size="12">',
           f'<rect width="{across}" height="{down}" fill="white"/>']
    for i, (case, heading) in enumerate(COLUMNS):
        left = LEFT + i * (WIDTH + GAP + 10)
        out.append(f'<text x="{left + WIDTH / 2}" y="16" text-anchor="middle" '
                   f'font-weight="bold">{heading}</text>')
        for j, (title, *rest) in enumerate(ROWS):
            top = TOP + j * (HEIGHT + GAP)
            out.append(f'<text x="{left}" y="{top - 7}">{title}</text>')
            panel(out, [r for r in data if r['case'] == case], left, top, *rest)
            out.append(f'<text x="{left + WIDTH}" y="{top + HEIGHT + 32}" text-anchor="end">ns a ray</text>')
    for i, (_, legend, colour, shape) in enumerate(FAMILIES):
        x, y = LEFT + 10 + i // 4 * (WIDTH + GAP + 10), TOP + 2 * (HEIGHT + GAP) + i % 4 * 20
        out.append(mark(shape, x, y, colour))
        out.append(f'<text x="{x + 14}" y="{y + 4}">{legend}</text>')
    out.append('</svg>')
    return '\n'.join(out) + '\n'


def percent(part, row):
    return f'{100 * part / int(row["hits"]):.2g} %' if part else '0'


def made(data):
    """The first set in full; of the others what a ray costs and how many hits are wrong."""
    first, *others = list(dict.fromkeys(row['case'] for row in data))
    of = {(row['case'], row['variant']): row for row in data}
    variants = [variant for case, variant in of if case == first]
    whole, rest = [], []
    for variant in variants:
        row = of[first, variant]
        whole.append([variant, f'{float(row["ns"]):.0f}', '-' if row['evals'] == 'nan' else row['evals'],
                      *(percent(int(row[name]), row) for name in ('missed', 'late', 'false')),
                      *(row[name] for name in ('err_median', 'err_99', 'err_worst'))])
        cells = [variant]
        for row in (of[other, variant] for other in others):
            cells += [f'{float(row["ns"]):.0f}', percent(wrong(row) * int(row['hits']), row), row['err_99']]
        rest.append(cells)
    return '\n\n'.join([
        tables.table([first, 'ns a ray', 'evaluations', 'missed', 'late', 'false', 'error: median', '99 %', 'worst'],
                     whole),
        tables.table(['', *(head for other in others for head in (f'{other}: ns a ray', 'wrong', 'error: 99 %'))],
                     rest)])


def main(build, *words):
    data = list(csv.DictReader(tables.run(f'{build}/tests/bench/bench_level_sets', *words).splitlines()))
    (tables.DOCS / 'level_sets.svg').write_text(picture(data))
    tables.write('level_sets', build, made(data))


if __name__ == '__main__':
    main(*sys.argv[1:])
