#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Sheets of src/tool/draw/chart.h, ordinary and hostile: well-formed files in which no text covers another.

    python3 test_chart.py SAGITTA CHART_SHEET
"""
import functools
import itertools
import math
import pathlib
import random
import re
import shutil
import struct
import subprocess
import sys
import xml.etree.ElementTree as xml

from command import *

SHEET = os.path.abspath(sys.argv[2])
SVG, LINK = '{http://www.w3.org/2000/svg}', '{http://www.w3.org/1999/xlink}href'
NAMES = subprocess.run([SHEET], capture_output=True, text=True, check=True).stdout.split()


def drawn(name, ending):
    path = written('').parent / f'{name}.{ending}'
    done = subprocess.run([SHEET, name, path], capture_output=True, text=True, timeout=60)
    equal((done.returncode, done.stdout, done.stderr), (0, '', ''), name)
    return path


first_drawn = functools.cache(drawn)


def size(root):
    return [float(root.get(side).removesuffix('pt')) for side in ('width', 'height')]


def numbers(text):
    return [float(w) for w in re.findall(r'[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?', text)]


def glyphs(root):
    """The box of each glyph, about its point; None for a space."""
    found = {}
    for node in root.iter():
        if (node.get('id') or '').startswith('glyph') and node.tag in (SVG + 'symbol', SVG + 'g'):
            values = [v for path in node.iter(SVG + 'path') for v in numbers(path.get('d') or '')]
            x, y = values[::2], values[1::2]
            if x:
                found['#' + node.get('id')] = min(x), min(y), max(x), max(y)
    return found


def texts(root):
    """The box of each text: cairo puts the glyphs of one text into one group."""
    shape = glyphs(root)
    for group in root.iter(SVG + 'g'):
        box = None
        for use in group.findall(SVG + 'use'):
            glyph = shape.get(use.get(LINK))
            if glyph:
                x, y = float(use.get('x')), float(use.get('y'))
                one = x + glyph[0], y + glyph[1], x + glyph[2], y + glyph[3]
                box = one if not box else (*map(min, box[:2], one[:2]), *map(max, box[2:], one[2:]))
        if box:
            yield box


def texts_apart(name):
    """All texts lie on the sheet, and none covers another.  How many there are."""
    root = xml.parse(first_drawn(name, 'svg')).getroot()
    width, height = size(root)
    equal(width, 900)
    boxes = sorted(texts(root))
    for i, (left, top, right, bottom) in enumerate(boxes):
        assert 0 <= left and 0 <= top and right <= width and bottom <= height, (name, boxes[i])
        for other in boxes[i + 1:]:
            if other[0] >= right:
                break
            assert other[1] >= bottom or other[3] <= top, (name, boxes[i], other)
    return len(boxes)


def test_texts_are_on_the_sheet_and_apart():
    for name in NAMES:
        assert texts_apart(name) > 0, name


def test_random_sheets():
    first = random.SystemRandom().randrange(1, 10**9)
    print(f'random sheets from seed {first}')
    for seed in range(first, first + 60):
        texts_apart(str(seed))


def test_png():
    for name in NAMES:
        data = first_drawn(name, 'png').read_bytes()
        equal(data[:8], b'\x89PNG\r\n\x1a\n', name)
        width, height = struct.unpack('>II', data[16:24])
        wanted = size(xml.parse(first_drawn(name, 'svg')).getroot())
        if name == 'tall':
            assert 31000 < height <= 32000 and abs(width / height - wanted[0] / wanted[1]) < 1e-3, (width, height)
        else:
            equal([width, height], [2 * w for w in wanted], name)


def test_pdf():
    for name in NAMES:
        data = first_drawn(name, 'pdf').read_bytes()
        assert data.startswith(b'%PDF-') and data.rstrip().endswith(b'%%EOF'), name


def test_same_bytes():
    for name in NAMES:
        for ending in ('svg', 'png', 'pdf'):
            first, second = (draw(name, ending).read_bytes() for draw in (first_drawn, drawn))
            assert first == second, (name, ending)
            assert ending != 'pdf' or b'CreationDate' not in first, name


def pdf_words(path):
    """What pdftotext reads: the middle of each word, in points."""
    done = subprocess.run(['pdftotext', '-bbox', path, '-'], capture_output=True, text=True, check=True)
    for x0, y0, x1, y1, word in re.findall(r'<word xMin="(.*?)" yMin="(.*?)" xMax="(.*?)" yMax="(.*?)">(.*?)<', done.stdout):
        yield (float(x0) + float(x1)) / 2, (float(y0) + float(y1)) / 2, word


def test_the_axis_of_fields():
    """What is drawn against the field has its angle below, and a ring for each field, even of one."""
    for fields in ('1,2,3', '2'):
        path = written('').parent / 'fields'
        for ending in ('pdf', 'svg'):
            run('illumination', LENSES / 'cooke_triplet.yaml', '--fields', fields, '--cells', 8,
                '--picture', path.with_suffix('.' + ending))
        # A ring is two curves; the legend has one more.  Letters have no stroke.
        curves = sum(p.get('d').count('C') for p in xml.parse(path.with_suffix('.svg')).getroot().iter(SVG + 'path')
                     if 'stroke:rgb' in (p.get('style') or '').replace(' ', '') or (p.get('stroke') or 'none') != 'none')
        equal(curves, 2 * (len(fields.split(',')) + 1), fields)
        if not shutil.which('pdftotext'):
            print('skipped: there is no pdftotext')
            continue
        words = [w for _, _, w in pdf_words(path.with_suffix('.pdf'))]
        assert '(degrees)' in words and '1.5' not in words, words


def line_through(pairs):
    """Intercept and slope of the line by least squares, and the largest distance from it."""
    n, sx, sy = len(pairs), sum(x for x, _ in pairs), sum(y for _, y in pairs)
    slope = (n * sum(x * y for x, y in pairs) - sx * sy) / (n * sum(x * x for x, _ in pairs) - sx * sx)
    base = (sy - slope * sx) / n
    return base, slope, max(abs(base + slope * x - y) for x, y in pairs)


def test_curves_are_where_the_numbers_say():
    """The sweep: a curve that is worked out here lies where the numbers of both axes put it."""
    if not shutil.which('pdftotext'):
        print('skipped: there is no pdftotext')
        return
    words = [(x, y, int(w)) for x, y, w in pdf_words(drawn('sweep', 'pdf')) if w.isdigit()]
    level, upright = max(y for _, y, _ in words), min(x for x, _, w in words if w > 100)
    across = [(w, x) for x, y, w in words if abs(y - level) < 1]
    up = [(w, y) for x, y, w in words if y < level - 1 and x < upright + 40 and w >= 1000]
    assert len(across) >= 5 and len(up) >= 4, words
    (x0, x1, x_off), (y0, y1, y_off) = line_through(across), line_through(up)
    assert x_off < 0.1 and y_off < 0.1, (across, up)
    root = xml.parse(drawn('sweep', 'svg')).getroot()
    first = max((p for p in root.iter(SVG + 'path') if re.search('stroke[^-]*rgb.0%, ?31', str(p.attrib))),
                key=lambda p: len(p.get('d')))
    shift = numbers(first.get('transform') or 'matrix(1,0,0,1,0,0)')
    equal(shift[:4], [1, 0, 0, 1])
    d = numbers(first.get('d'))
    assert len(d) > 100, d  # less than 2 * 91: straight pieces are joined
    for x, y in zip(d[::2], d[1::2]):
        angle = (x + shift[4] - x0) / x1
        close(2 * angle, round(2 * angle), 0.02, 'angle')
        passed = math.floor(10000 / (1 + math.exp((round(2 * angle) / 2 - 27) / 2)))
        close(y + shift[5], y0 + y1 * passed, 1.5, 'y')  # the middle of a word is not quite that of its digits


# Severity 1 of Machado, Oliveira & Fernandes (2009): protanopia, deuteranopia, tritanopia.
SIGHT = [
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
]
XYZ = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]  # of sRGB, D65


def lab(colour, sight):
    """CIELAB of an sRGB colour as it is seen."""
    def times(m, v):
        return [sum(a * b for a, b in zip(row, v)) for row in m]
    linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in colour]
    seen = [min(max(v, 0), 1) for v in times(sight, linear)]
    f = [t ** (1 / 3) if t > 0.008856 else 7.787 * t + 16 / 116
         for t in (v / white for v, white in zip(times(XYZ, seen), (0.9505, 1, 1.089)))]
    return 116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])


def distance(one, other):
    return min(math.dist(lab(one, sight), lab(other, sight)) for sight in SIGHT)


def colours(file, table, count):
    text = (HERE.parent.parent / 'src/tool/draw' / file).read_text()
    rows = re.search(table + r'\[\w+\]\[3\] = \{(.*?)\};', text, re.DOTALL).group(1)
    found = [numbers(row) for row in re.findall(r'\{([^{}]*)\}', rows)]
    equal(len(found), count, table)
    return found


def test_palette():
    """What the head of palette.c says."""
    palette = colours('palette.c', 'palette', 7)
    for one, other in zip(palette, palette[1:]):
        assert abs(lab(one, SIGHT[0])[0] - lab(other, SIGHT[0])[0]) >= 16.5, (one, other)
        assert distance(one, other) >= 31.5, (one, other)
    for one, other in itertools.combinations(palette[:5], 2):
        assert distance(one, other) >= 37.5, (one, other)


def test_ramps():
    """What the head of chart_map.c says."""
    ramp, two_sided = (colours('chart_map.c', table, 17) for table in ('sequence', 'two_sided'))
    lightness = [lab(c, SIGHT[0])[0] for c in ramp]
    close(lightness[0], 16, 0.5)
    close(lightness[-1], 91, 0.5)
    for k, value in enumerate(lightness):
        close(value, lightness[0] + (lightness[-1] - lightness[0]) * k / 16, 0.3, f'colour {k}')
    for one, other in [*zip(ramp, ramp[1:]), *zip(two_sided, two_sided[1:])]:
        assert distance(one, other) >= 4.35, (one, other)
    equal(len(set(two_sided[8])), 1, 'grey at zero')
    for half in (two_sided[8::-1], two_sided[8:]):
        lightness = [lab(c, SIGHT[0])[0] for c in half]
        equal(lightness, sorted(lightness, reverse=True), 'darker away from zero')


def refused(status, *words):
    done = subprocess.run([SHEET, *map(str, words)], capture_output=True, text=True, timeout=60)
    equal(done.returncode, status, words)
    return done.stderr


def test_bad_names():
    for name in ('x', 'x.jpg', 'svg', '.sv', 'x.svg.gz'):
        said = refused(USAGE, 'fan', name)
        assert f'--picture {name}' in said and '.svg' in said, said
    folder = written('').parent
    assert (folder / 'no' / 'x.svg').as_posix() in refused(BAD_INPUT, 'fan', folder / 'no' / 'x.svg')
    subprocess.run([SHEET, 'fan', folder / 'X.PDF'], check=True)


def test_full_disk():
    if pathlib.Path('/dev/full').exists():
        for ending in ('svg', 'png', 'pdf'):
            path = written('').parent / f'full.{ending}'
            path.symlink_to('/dev/full')
            assert str(path) in refused(BAD_INPUT, 'fan', path)


main(globals())
