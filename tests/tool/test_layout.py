#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sagitta trace --picture: what is drawn where.  Expected places are computed here from the numbers of the lens.

    python3 test_layout.py SAGITTA
"""
import math
import os
import random
import re
import struct
import xml.etree.ElementTree as xml

from command import *

SVG = '{http://www.w3.org/2000/svg}'
SURFACE, MIRROR, BLOCKED, FINE, WHITE = '0.9', '1.6', '2.6', '0.5', 'rgb(100%,100%,100%)'


class Line:
    """A stroke of the picture: width, colour and dash as they stand, and its parts, each a list of points."""

    def __init__(self, path):
        look = dict(item.strip().split(':') for item in (path.get('style') or '').split(';') if ':' in item)
        look.update({k: path.get(k) for k in ('stroke', 'stroke-width', 'stroke-dasharray') if path.get(k)})
        self.width, self.colour, self.dash = look.get('stroke-width'), look.get('stroke', ''), look.get('stroke-dasharray')
        self.colour = self.colour.replace(' ', '')
        self.grey = len(set(re.findall(r'[\d.]+', self.colour))) == 1
        matrix = re.match(r'matrix\(([^)]*)\)', path.get('transform', 'matrix(1,0,0,1,0,0)')).group(1)
        a, b, c, d, e, f = (float(w) for w in re.split('[ ,]+', matrix))
        self.parts = []
        for part in re.findall(r'M[^M]*', path.get('d', '')):
            words = [float(w) for w in re.findall(r'[-+.\de]+', re.sub('[A-Za-z]', ' ', part))]
            self.parts.append([(a * x + c * y + e, b * x + d * y + f) for x, y in zip(words[::2], words[1::2])])
        self.points = [p for part in self.parts for p in part]


def lines(lens, *arguments, **how):
    path = written('', 'picture.svg')
    lens = lens if isinstance(lens, pathlib.Path) else written(lens)
    run('trace', lens, *arguments, '--picture', path, **how)
    drawn = [Line(path) for path in xml.parse(path).getroot().iter(SVG + 'path')]
    return [line for line in drawn if line.width]


def of(drawn, width):
    """The points of each dark grey line of that width."""
    return [line.points for line in drawn if line.width == width and line.grey and line.colour != WHITE]


def span(points, axis):
    values = [p[axis] for p in points]
    return max(values) - min(values)


def boxes(drawn):
    """Those of the numbers: they have a white edge."""
    return [(min(x for x, _ in p), min(y for _, y in p), max(x for x, _ in p), max(y for _, y in p))
            for p in (line.points for line in drawn if line.colour == WHITE)]


# ------------------------------------------------------------------- files


def test_kinds_of_files():
    """Each ending has its kind, in either case, and the same picture the same bytes; png has two pixels a point."""
    where = written('').parent
    names = ('a.svg', 'a.png', 'a.pdf', 'a.SVG')
    for name in names:
        run('trace', LENSES / 'cooke_triplet.yaml', '--picture', where / name)
        first = (where / name).read_bytes()
        run('trace', LENSES / 'cooke_triplet.yaml', '--picture', where / name)
        assert (where / name).read_bytes() == first, name
    assert (where / 'a.svg').read_bytes() == (where / 'a.SVG').read_bytes()
    assert (where / 'a.pdf').read_bytes().startswith(b'%PDF-')
    png = (where / 'a.png').read_bytes()
    equal(png[:8], b'\x89PNG\r\n\x1a\n')
    root = xml.parse(where / 'a.svg').getroot()
    equal(struct.unpack('>II', png[16:24]), tuple(2 * int(root.get(k).removesuffix('pt')) for k in ('width', 'height')))


def test_wrong_options():
    where = written('').parent
    for arguments, said in ((('--picture', where / 'a.jpg'), 'must end in .svg, .png or .pdf'),
                            (('--picture', where / 'svg'), 'must end in'),
                            (('--picture', where / 'a.svg', '--plane', 'zy'), '--plane must be yz, xz or 3d, not "zy"'),
                            (('--plane', 'xz'), '--plane: is of a picture')):
        done = run('trace', LENSES / 'cooke_triplet.yaml', *arguments, exit=USAGE)
        assert said in done.stderr, done.stderr
        equal((done.stdout, list(where.glob('*.svg'))), ('', []))


def test_fan_seen_from_its_edge():
    path = written('', 'a.svg')
    for arguments, told in ((('--fan', 3), True), (('--cross', 3), False), (('--chief', '--fields', '1'), False)):
        said = run('trace', LENSES / 'cooke_triplet.yaml', *arguments, '--plane', 'xz', '--picture', path).stderr
        assert ('--cross N sends some in x' in said) == told, (arguments, said)


def test_picture_and_table_in_one_file():
    where = written('').parent
    for name in ('trace', 'spot', 'sweep'):
        done = run(name, LENSES / 'cooke_triplet.yaml', '--output', where / 'b.svg', '--picture', where / 'b.svg', exit=USAGE)
        assert 'would be written over the file of --' in done.stderr, done.stderr


# ------------------------------------------------------------------ places

BARE = '''pupil: {semi_diameter: 4}
fields: [0]
surfaces:
'''


def test_planes_of_a_cylinder():
    """It is curved in y only.  In x-z its section is straight; turned by 90 degrees about z the planes change places."""
    text = BARE + '''  - {type: cylinder, radius: 10, semi_diameter: 8, tilt: [0, 0, %d], thickness: 10, mirror: true}
  - {type: plane, semi_diameter: 8}
'''
    sag = 10 - math.sqrt(10 ** 2 - 8 ** 2)
    for turn in (0, 90):
        for plane in ('yz', 'xz'):
            drawn = lines(text % turn, '--fan', '1', '--plane', plane)
            mirror, = of(drawn, MIRROR)
            close(span(mirror, 0) / span(mirror, 1), sag / 16 if (plane == 'yz') == (turn == 0) else 0, 1e-5, (turn, plane))


def test_space():
    """A circle at a right angle to z is an ellipse.  Its short axis is |z . toward|, with angles of 40 and 20 degrees."""
    drawn = lines(BARE + '  - {type: plane, semi_diameter: 8, mirror: true, thickness: -10}\n  - {type: plane, semi_diameter: 2}\n',
                  '--fan', '1', '--plane', '3d')
    rim = next(p for p in of(drawn, MIRROR) if len(p) > 100)
    x, y = (sum(p[k] for p in rim[1:]) / (len(rim) - 1) for k in (0, 1))
    far = [math.hypot(a - x, b - y) for a, b in rim]
    close(min(far) / max(far), math.cos(math.radians(20)) * math.sin(math.radians(40)), 2e-3)


def test_holes_and_obscurations():
    """A mirror with a hole has a gap, as wide as the hole.  What obscures is bold, on any element."""
    text = BARE + '''  - {type: plane, thickness: 30, semi_diameter: 10, apertures: [{type: circle, radius: 3, obscures: true}]}
  - {type: conic, radius: -100, conic: -1, mirror: true, thickness: -30, apertures: [{type: annulus, inner: 2.5, outer: 10}]}
  - {type: plane, semi_diameter: 10}
'''
    for plane in ('yz', 'xz'):
        drawn = lines(text, '--fan', '1', '--no-apertures', '--plane', plane)
        equal((len(of(drawn, MIRROR)), of(drawn, BLOCKED)), (1, []))
        drawn = lines(text, '--fan', '1', '--plane', plane)
        bold, = of(drawn, BLOCKED)
        upper, lower = sorted(of(drawn, MIRROR), key=lambda p: p[0][1])
        heights = sorted(y for _, y in upper + lower)
        scale = (heights[-1] - heights[0]) / 20
        close(span(bold, 1) / scale, 6, 20 / 512)
        close((min(y for _, y in lower) - max(y for _, y in upper)) / scale, 5, 20 / 512, plane)
    drawn = lines(text, '--fan', '1', '--plane', '3d')
    outer, inner = sorted((span(p, 1) for p in of(drawn, MIRROR) if len(p) > 100), reverse=True)
    close(inner / outer, 0.25, 0.01)


def test_mirror_in_a_wider_aperture():
    """What semi_diameter clips is not drawn, though an aperture is wider."""
    drawn = lines(BARE + '''  - {type: plane, mirror: true, thickness: -30, semi_diameter: 5, apertures: [{type: annulus, inner: 1, outer: 10}]}
  - {type: plane, semi_diameter: 10}
''', '--fan', '1')
    mirror = [y for p in of(drawn, MIRROR) for _, y in p]
    close((max(mirror) - min(mirror)) / span(of(drawn, SURFACE)[0], 1), 0.5, 1e-3)
    drawn = lines(BARE + '''  - {type: plane, mirror: true, thickness: -30, semi_diameter: 5, apertures: [{type: circle, radius: 10}]}
  - {type: plane, semi_diameter: 10}
''', '--fan', '1', '--plane', '3d')
    rims = sorted(span(p, 1) for p in of(drawn, MIRROR) if len(p) > 100)
    close(rims[0] / max(span(p, 1) for p in of(drawn, SURFACE)), 0.5, 1e-3)


def test_stop_that_is_a_plate_with_a_hole():
    """Beside a dummy's opening there is a plate: it is drawn, and its opening is not."""
    drawn = lines(BARE + '''  - {type: plane, thickness: 20, stop: true, semi_diameter: 10, apertures: [{type: circle, radius: 4}]}
  - {type: plane, semi_diameter: 10}
''', '--fan', '1')
    bold = of(drawn, BLOCKED)
    image, = of(drawn, SURFACE)
    scale, middle = span(image, 1) / 20, (image[0][1] + image[-1][1]) / 2
    plates = [sorted(abs(y - middle) / scale for _, y in p) for p in bold if span(p, 0) < 0.1 and p[0][1] < image[0][1] + 1]
    plates = [p for p in plates if p[0] < 9]
    equal(len(plates), 2)
    for plate in plates:
        close(plate[0], 4, 20 / 512), close(plate[-1], 10, 1e-3)


def test_rims_that_rays_make():
    """A mirror without a rim, met beside its axis, is drawn a tenth wider than its rays; one met about its axis is whole."""
    text = '''pupil: {semi_diameter: 4, distance: 0}
surfaces:
  - {type: conic, radius: -800, conic: -1, origin: [0, 0, 0], mirror: true}
  - {type: plane, origin: [0, 0, -300], semi_diameter: 20}
'''
    for low, high, expected in ((100, 160, 66), (-30, 40, 2 * 1.1 * 40)):
        beams = rays(*((0, low + (high - low) * k / 6, -500, 0, 0, 1) for k in range(7)))
        drawn = lines(text, '--rays', '-', stdin=beams)
        mirror, = of(drawn, MIRROR)
        scale = span(of(drawn, SURFACE)[0], 1) / 40
        close(span(mirror, 1) / scale, expected, 0.01, (low, high))
        if low > 0:
            image = sum(y for _, y in of(drawn, SURFACE)[0]) / len(of(drawn, SURFACE)[0])
            close((image - (mirror[0][1] + mirror[-1][1]) / 2) / scale, 130, 0.01)


def test_off_axis_part():
    """An aperture beside the axis shows that part, in the plane in which it lies beside it, and its middle in the other."""
    text = BARE + '''  - {type: conic, radius: -800, conic: -1, mirror: true, thickness: -300, apertures: [{type: ellipse, half_width: 30, half_height: 20, offset: [120, 0]}]}
  - {type: plane, semi_diameter: 20}
'''
    sag = lambda r: -r * r / 1600
    for plane, wide, depth in (('xz', 60, sag(90) - sag(150)), ('yz', 40, sag(120) - sag(math.hypot(120, 20)))):
        drawn = lines(text, '--fan', '1', '--plane', plane)
        mirror, = of(drawn, MIRROR)
        scale = span(of(drawn, SURFACE)[0], 1) / 40
        close(span(mirror, 1) / scale, wide, 0.02, plane)
        close(span(mirror, 0) / scale, depth, 0.02, plane)


def test_what_a_surface_is_drawn_to():
    """semi_diameter, else the first aperture, else draw_to.  In the plane of the rectangle's longer side that is seen."""
    shapes = 'apertures: [{type: circle, radius: 1, obscures: true}, {type: rectangle, half_width: 7, half_height: 3}]'
    for keys, high, wide in (('semi_diameter: 4, draw_to: 9', 8, 8), (shapes + ', draw_to: 9', 6, 14), ('draw_to: 9', 18, 18)):
        text = BARE + '  - {type: sphere, radius: 100, thickness: 9, index: 1.5, %s}\n  - {type: plane, semi_diameter: 2}\n' % keys
        for plane, expected in (('yz', high), ('xz', wide)):
            glass = of(lines(text, '--fan', '1', '--plane', plane), SURFACE)
            image = max(glass, key=lambda p: min(x for x, _ in p))
            close(span([p for line in glass for p in line], 1) / (span(image, 1) / 4), expected, 1e-3, (keys, plane))


def test_turned_out_of_the_plane():
    """Of a mirror that is turned about y by 60 degrees y-z shows the rim, too: an ellipse of sin 60 by 1."""
    text = BARE + '  - {type: plane, semi_diameter: 8, mirror: true, tilt: [0, %d, 0], thickness: -30}\n  - {type: plane, semi_diameter: 8}\n'
    for turn in (0, 60):
        rims = [p for p in of(lines(text % turn, '--fan', '1'), FINE) if len(p) == 129]
        equal(len(rims), 1 if turn else 0)
        for rim in rims:
            close(span(rim, 0) / span(rim, 1), math.sin(math.radians(60)), 1e-4)


def test_rulers():
    """Long ticks are 1, 2 or 5 times a power of ten apart, in both directions alike if they are so on the page."""
    for height in (0.004, 3, 70, 12345):
        drawn = lines(f'pupil: {{semi_diameter: {height}}}\nsurfaces:\n'
                      f'  - {{type: plane, thickness: {4 * height}, semi_diameter: {height}}}\n  - {{type: plane, semi_diameter: {height}}}\n', '--fan', '1')
        image, = of(drawn, SURFACE)
        scale = span(image, 1) / (2 * height)
        rulers = [line.parts for line in drawn if len(line.parts) > 10 and line.width == FINE]
        equal(len(rulers), 2)
        for axis, parts in ((0, rulers[0]), (1, rulers[1])):
            ticks = [(p[0][axis], abs(p[1][1 - axis] - p[0][1 - axis])) for p in parts[1:]]
            places = sorted(at for at, long in ticks if long > 3)
            step = (places[1] - places[0]) / scale
            leading = step / 10 ** math.floor(math.log10(step) + 1e-4)
            assert min(abs(leading - k) for k in (1, 2, 5)) < 1e-2, (height, axis, step)
            if axis == 1:
                off = ((image[0][1] + image[-1][1]) / 2 - places[0]) / scale / step  # from y = 0
                close(off, round(off), 1e-2)


# ----------------------------------------------------------------- numbers


def test_numbers_of_elements():
    """Each element has one, and none lies over another, or over a surface: of random rows of glass."""
    seed = int(os.environ.get('SAGITTA_TEST_SEED', 20))
    print('seed', seed)
    draw = random.Random(seed)
    for _ in range(max(1, round(6 * float(os.environ.get('SAGITTA_TEST_SCALE', '0.5'))))):
        count = draw.randrange(1, 20)
        rows = [f'  - {{type: sphere, radius: {draw.choice((-1, 1)) * draw.uniform(40, 200):.3f}, thickness: {draw.uniform(0.1, 8):.3f}, '
                f'index: {draw.choice((1, 1.5, 1.7))}, semi_diameter: {draw.uniform(8, 14):.3f}}}\n' for _ in range(count)]
        drawn = lines('pupil: {semi_diameter: 2}\nsurfaces:\n' + ''.join(rows) + '  - {type: plane, semi_diameter: 9}\n', '--fan', '1',
                      '--plane', draw.choice(('yz', 'xz')), exit=None)
        found = boxes(drawn)
        equal(len(found), count + 1)
        for i, (left, top, right, bottom) in enumerate(found):
            assert all(right <= a or c <= left or bottom <= b or d <= top for a, b, c, d in found[:i]), (seed, found)
            for line in drawn:
                if line.width in (SURFACE, MIRROR, BLOCKED) and line.grey:
                    assert not any(left < x < right and top < y < bottom for x, y in line.points), (seed, i)


def test_too_many_elements_to_be_numbered():
    rows = ''.join(f'  - {{type: plane, thickness: 0.01, index: {1.5 if k % 2 else 1}, semi_diameter: 5}}\n' for k in range(200))
    found = boxes(lines('pupil: {semi_diameter: 1}\nsurfaces:\n' + rows + '  - {type: plane, semi_diameter: 5}\n', '--fan', '1'))
    assert 5 < len(found) < 200, len(found)
    assert min(top for _, top, _, _ in found) > 68  # below the title


def test_number_beside_a_steep_face():
    """A face goes through the place of the number of the plane in front of it; so the number is elsewhere."""
    text = 'pupil: {semi_diameter: 2}\nsurfaces:\n  - {type: plane, thickness: %g, semi_diameter: 5}\n'
    face = '  - {type: sphere, radius: -20, thickness: 5, index: 1.5, semi_diameter: 15}\n  - {type: plane, semi_diameter: 15}\n'
    for thickness in (0.6, 0.8, 1, 1.2):
        drawn = lines(text % thickness + face, '--fan', '1')
        found = boxes(drawn)
        equal(len(found), 3)
        for a, b in ((a, b) for p in of(drawn, SURFACE) for a, b in zip(p, p[1:])):
            for k in range(20):
                x, y = (u + k / 20 * (v - u) for u, v in zip(a, b))
                assert not any(left < x < right and top < y < bottom for left, top, right, bottom in found), thickness


# -------------------------------------------------------------------- rays


def test_marks_of_fates():
    """Clipped: two strokes; missed: a triangle; lost: a square.  One of each is in the legend, in grey."""
    lens = '''pupil: {semi_diameter: 4}
surfaces:
  - {type: sphere, radius: 10, thickness: 8, index: 1, semi_diameter: 5}
  - {type: plane, semi_diameter: 3}
'''
    corners = {'clipped': 2, 'missed': 3, 'lost': 4}

    def marks(drawn):
        count = {}
        for line in drawn:
            if line.width == '1.1':
                crossed = len([part for part in line.parts if len(part) > 1]) == 2
                shape = 2 if crossed else len(set(line.points))
                count[shape, line.grey] = count.get((shape, line.grey), 0) + 1
        return count

    beams = rays((0, 0, -5, 0, 0, 1), (0, 4, -5, 0, 0, 1), (0, -4, -5, 0, 0, 1), (0, 30, -5, 0, 0, 1))
    equal(marks(lines(lens, '--rays', '-', stdin=beams)), {(2, False): 2, (2, True): 1, (3, False): 1, (3, True): 1})
    lost = run('trace', LENSES / 'aspheric_singlet.yaml', '--max-evals', '1', '--fan', '3', '--field', '0', exit=UNDECIDED).stdout
    assert '2 lost' in lost
    drawn = lines(LENSES / 'aspheric_singlet.yaml', '--max-evals', '1', '--fan', '3', '--field', '0', exit=UNDECIDED)
    equal(marks(drawn), {(corners['lost'], False): 2, (corners['lost'], True): 1})


def test_missed_ray_goes_as_far_as_what_it_missed():
    text = BARE + '''  - {type: plane, thickness: 15, stop: true, semi_diameter: 12}
  - {type: torus, major: 10, minor: 2, thickness: 15}
  - {type: plane, semi_diameter: 12}
'''
    drawn = lines(text, '--fan', '3')
    image = max(of(drawn, SURFACE), key=lambda p: (span(p, 1) > 50, p[0][0]))
    scale = span(image, 1) / 24
    ends = [line.points[0] for line in drawn if line.width == '1.1' and not line.grey]
    equal(len(ends), 3)
    for x, _ in ends:
        z = 30 - (image[0][0] - x) / scale
        assert 15 < z < 15 + 0.1 * 40, z


def test_colours_and_dashes():
    """Fields differ by colour, then by dash; wavelengths of one field by colour."""
    fields = [word for f in range(9) for word in ('--field', f)]
    looks = [(line.colour, line.dash) for line in lines(LENSES / 'ftheta.yaml', '--fan', '2', *fields) if line.width == '0.6']
    equal((len(looks), len(set(looks))), (18, 9))
    equal(len({colour for colour, _ in looks}), 7)
    waves = ['--wavelength', '0.48', '--wavelength', '0.55', '--wavelength', '0.65']
    glass = '''wavelengths: [0.48, 0.55, 0.65]
pupil: {semi_diameter: 1}
fields: [0, 5]
surfaces:
  - {type: sphere, radius: 20, thickness: 2, glass: N-BK7, semi_diameter: 3}
  - {type: plane, semi_diameter: 3}
'''
    for field, colours in ((['--field', '0'], 3), ([], 2)):
        drawn = [line for line in lines(glass, '--fan', '3', *waves, *field) if line.width == '0.6']
        equal((len(drawn), len({line.colour for line in drawn})), (9 if field else 18, colours))


if '--without-cairo' not in sys.argv:
    main(globals())
