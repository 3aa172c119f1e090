#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""sagitta trace --picture: a picture is XML, of a sensible size, and shows what it should.

    python3 test_picture.py SAGITTA
"""
import re
import xml.etree.ElementTree as xml

from command import *

SVG = '{http://www.w3.org/2000/svg}'


FOLDED = '''pupil: {semi_diameter: 3}
surfaces:
  - {type: plane, thickness: 10, index: 1.5, semi_diameter: 10}
  - {type: plane, thickness: 5, index: 1, tilt: [40, 0, 0], semi_diameter: 20}
  - {type: plane, semi_diameter: 5}
'''


def picture(lens, *arguments, **how):
    path = written('').parent / 'picture.svg'
    run('trace', lens, *arguments, '--picture', path, **how)
    return xml.parse(path).getroot()


def size(root):
    return [float(root.get(side).removesuffix('pt')) for side in ('width', 'height')]


def strokes(root):
    """How many lines there are of each colour and kind."""
    count = {}
    for path in root.iter(SVG + 'path'):
        look = path.get('style') or path.get('stroke')
        if 'stroke-width' not in look and not path.get('stroke-width'):
            continue  # a letter
        count[look] = count.get(look, 0) + 1
    return count


def test_examples():
    for lens in sorted(LENSES.glob('*.yaml')):
        root = picture(lens)
        equal(root.tag, SVG + 'svg')
        width, height = size(root)
        assert 700 <= width <= 1200 and 200 <= height <= 800, (lens, width, height)


def points(root):
    """Every point that a line of the picture goes through."""
    for path in root.iter(SVG + 'path'):
        if 'stroke-width' not in (path.get('style') or '') and not path.get('stroke-width'):
            continue  # a letter
        words = [float(w) for w in re.findall(r'[-+.\de]+', re.sub('[A-Za-z]', ' ', path.get('d', '')))]
        shift = re.match(r'matrix\(([^)]*)\)', path.get('transform', 'matrix(1,0,0,1,0,0)'))
        a, b, c, d, e, f = (float(w) for w in re.split('[ ,]+', shift.group(1)))
        for x, y in zip(words[::2], words[1::2]):
            yield a * x + c * y + e, b * x + d * y + f


def test_edges_stay_on_the_page():
    """Glass is as wide as the wider of its faces, a tilted one included."""
    for lens in (FOLDED, FOLDED.replace('tilt: [40', 'tilt: [-70'), FOLDED.replace('semi_diameter: 10', 'semi_diameter: 60')):
        root = picture(written(lens))
        width, height = size(root)
        for x, y in points(root):
            assert -1 <= x <= width + 1 and -1 <= y <= height + 1, (x, y, width, height)


def test_bars_of_the_stop_begin_at_its_aperture():
    """On a face of semi_diameter 4 of a glass that is 12 high the bars are where they are without the other face."""
    text = '''pupil: {semi_diameter: 4}
surfaces:
  - {type: plane, thickness: 30, index: %s, stop: true, semi_diameter: 4}
  - {type: plane, thickness: 30, index: 1, semi_diameter: 12}
  - {type: plane, semi_diameter: 12}
'''
    heights = []
    for index in (1.5, 1):
        root = picture(written(text % index), '--field', '0')
        bars = [p.get('d') for p in root.iter(SVG + 'path') if '2.6' in (p.get('stroke-width') or p.get('style') or '')]
        equal(len(bars), 3)  # two, and that of the legend
        ends = [float(w) for d in bars[:2] for w in re.findall(r'[-.\d]+', d)[1::2]]
        heights.append(sorted(y - min(ends) for y in ends))
    for a, b in zip(*heights):
        close(a, b, 0.01)
    assert len(heights[0]) == 4, heights


def test_each_ray_is_a_line():
    few, many = (picture(LENSES / 'ftheta.yaml', '--field', '0', '--fan', n) for n in (3, 10))
    grown = {look: strokes(many)[look] - n for look, n in strokes(few).items() if strokes(many)[look] != n}
    equal(list(grown.values()), [7])


def test_lost_rays():
    """Every kind of loss, and rays that start in odd places, leave a picture of finite size."""
    lens = written('''name: <odd> & "odd"
units: mm
surfaces:
  - {type: sphere, radius: 20, thickness: 8, index: 1.5, semi_diameter: 11}
  - {type: sphere, radius: -14, thickness: 12, index: 1, semi_diameter: 11}
  - {type: plane, thickness: 3, stop: true}
  - {type: plane, thickness: 10, index: 1.9, tilt: [45, 0, 0], semi_diameter: 8}
  - {type: sphere, radius: 6, thickness: 10, index: 1, semi_diameter: 9}
''')
    text = rays((0, 0, -10, 0, 0, 1), (0, 9, -10, 0, 0, 1), (0, 30, -10, 0, 0, 1), (0, 0, -1e9, 0, 0, 1), (0, 0, -10, 0, 1, 0),
                (0, 0, 900, 0, 0, -1), (0, 25, -10, 0, 1, 1e-3), (0, 0, -10, 0, 1, 1))
    root = picture(lens, '--rays', '-', stdin=text)
    width, height = size(root)
    assert 700 <= width <= 1200 and 200 <= height <= 800, (width, height)


def test_nothing_to_draw():
    """No rays, no apertures, one plane."""
    width, height = size(picture(written('surfaces:\n  - {type: plane}\n'), '--rays', '-', '--skip-bad', stdin=rays((0, 0, 'x', 0, 0, 1))))
    assert 0 < width < 2000 and 0 < height < 2000


def test_bodies():
    """A body is drawn as its section, in many strokes; a sag that is no conic as any sag."""
    lens = written('''pupil: {semi_diameter: 11}
fields: [0]
surfaces:
  - {type: plane, thickness: 15, stop: true, semi_diameter: 12}
  - {type: torus, major: 10, minor: 2, thickness: 15}
  - {type: plane, semi_diameter: 12}
''')
    path = written('').parent / 'picture.svg'
    assert not run('trace', lens, '--fan', 2, '--picture', path).stderr
    drawn = list(points(xml.parse(path).getroot()))
    bare = list(points(picture(written(lens.read_text().replace('torus, major: 10, minor: 2', 'plane, semi_diameter: 12')), '--fan', 2)))
    assert len(drawn) > len(bare) + 200, (len(drawn), len(bare))
    cylinder = written(lens.read_text().replace('torus, major: 10, minor: 2', 'cylinder, radius: 20, semi_diameter: 12'))
    sphere = written(lens.read_text().replace('torus, major: 10, minor: 2', 'sphere, radius: 20, semi_diameter: 12'))
    first, second = (list(points(picture(lens, '--fan', 3))) for lens in (cylinder, sphere))
    equal(len(first), len(second))
    for (a, b), (c, d) in zip(first, second):
        assert abs(a - c) < 0.01 and abs(b - d) < 0.01, ((a, b), (c, d))


def test_ideal_lens():
    """Two barbs at each end: within the height of the line for a positive focal length, beyond it for a negative one."""
    text = '''pupil: {semi_diameter: 4}
fields: [0]
surfaces:
  - {type: plane, thickness: 20, semi_diameter: 12}
  - {type: ideal, focal_length: %g, thickness: 20, semi_diameter: 6}
  - {type: plane, semi_diameter: 12}
'''
    outward, inward = (list(points(picture(written(text % f), '--fan', 1))) for f in (50, -50))

    def only(these, others):
        return [(x, y) for x, y in these if all(abs(x - a) + abs(y - b) > 0.5 for a, b in others)]

    within, beyond = only(outward, inward), only(inward, outward)
    equal((len(outward), len(within), len(beyond)), (len(inward), 4, 4))
    (low, high), (lowest, highest) = (sorted({round(y) for _, y in these}) for these in (within, beyond))
    assert lowest < low < high < highest, (within, beyond)
    equal(len({round(x) for x, _ in within}), 2)


def test_level_set():
    """A set has no profile: its rays bend in the empty, and the user is told why."""
    lens = written('''pupil: {semi_diameter: 0.4, distance: 0}
surfaces:
  - {type: plane, thickness: 3}
  - {type: julia, c: [-0.2, 0.8, 0, 0], iterations: 5, index: 1.5, thickness: 4}
  - {type: plane}
''')
    path = written('').parent / 'picture.svg'
    said = run('trace', lens, '--fan', 3, '--picture', path).stderr
    assert '--picture: element 2 (julia)' in said, said
    bare = picture(written(lens.read_text().replace('julia, c: [-0.2, 0.8, 0, 0], iterations: 5', 'plane')), '--fan', 3)
    drawn, lines = strokes(xml.parse(path).getroot()), strokes(bare)
    assert 0 < sum(drawn.values()) < sum(lines.values()), (drawn, lines)  # the surface, and the glass behind it
    assert not run('trace', LENSES / 'ftheta.yaml', '--picture', path).stderr


def test_many_fields_need_more_rows():
    fields = [word for f in range(-20, 21) for word in ('--field', f)]
    one, many = size(picture(LENSES / 'ftheta.yaml')), size(picture(LENSES / 'ftheta.yaml', *fields))
    equal(one[0], many[0])
    assert many[1] > one[1]


def test_long_names_and_units():
    lens = written('name: %s\nunits: %s\npupil: {semi_diameter: 1}\nsurfaces:\n  - {type: plane, thickness: 3}\n  - {type: plane}\n'
                   % ('µ' * 300, 'ü' * 200))
    picture(lens)


def test_file_that_cannot_be_written():
    path = written('').parent / 'no' / 'picture.svg'
    done = run('trace', LENSES / 'ftheta.yaml', '--picture', path, exit=BAD_INPUT)
    assert f'{path}: No such file or directory' in done.stderr, done.stderr
    equal(done.stdout, '')


def test_inputs_are_not_written_over():
    lens = written(FOLDED, 'lens.svg')
    for arguments in (('--picture', lens), ('--picture', lens.parent / 'x.svg', '--output', lens.parent / 'x.svg')):
        done = run('trace', lens, *arguments, exit=USAGE)
        assert 'written over' in done.stderr, done.stderr
        equal((done.stdout, lens.read_text()), ('', FOLDED))


def without_cairo():
    done = run('trace', LENSES / 'ftheta.yaml', '--picture', written('').parent / 'x.svg', exit=USAGE)
    assert 'without cairo' in done.stderr, done.stderr
    done = run('trace', LENSES / 'ftheta.yaml', '--picture', written('').parent / 'x.png', exit=USAGE)
    assert '--picture: not available' in done.stderr, done.stderr


main({'test_without_cairo': without_cairo} if '--without-cairo' in sys.argv else globals())
