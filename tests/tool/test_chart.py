#!/usr/bin/env python3
"""Sheets of src/tool/draw/chart.h, ordinary and hostile: well-formed files in which no text covers another.

    python3 test_chart.py SAGITTA CHART_SHEET
"""
import pathlib
import random
import re
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
    root = xml.parse(drawn(name, 'svg')).getroot()
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
        data = drawn(name, 'png').read_bytes()
        equal(data[:8], b'\x89PNG\r\n\x1a\n', name)
        width, height = struct.unpack('>II', data[16:24])
        wanted = size(xml.parse(drawn(name, 'svg')).getroot())
        if name == 'tall':
            assert 31000 < height <= 32000 and abs(width / height - wanted[0] / wanted[1]) < 1e-3, (width, height)
        else:
            equal([width, height], [2 * w for w in wanted], name)


def test_pdf():
    for name in NAMES:
        data = drawn(name, 'pdf').read_bytes()
        assert data.startswith(b'%PDF-') and data.rstrip().endswith(b'%%EOF'), name


def test_same_bytes():
    for name in NAMES:
        for ending in ('svg', 'png', 'pdf'):
            first, second = (drawn(name, ending).read_bytes() for _ in range(2))
            assert first == second, (name, ending)
            assert ending != 'pdf' or b'CreationDate' not in first, name


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
