#!/usr/bin/env python3
"""sagitta trace --svg: a picture is XML, of a sensible size, and shows what it should.

    python3 test_picture.py SAGITTA
"""
import xml.etree.ElementTree as xml

from command import *

SVG = '{http://www.w3.org/2000/svg}'


def picture(lens, *arguments, **how):
    path = written('').parent / 'picture.svg'
    run('trace', lens, *arguments, '--svg', path, **how)
    return xml.parse(path).getroot()


def size(root):
    return [float(root.get(side).removesuffix('pt')) for side in ('width', 'height')]


def strokes(root):
    """How many lines there are of each colour and kind."""
    count = {}
    for path in root.iter(SVG + 'path'):
        look = path.get('style') or path.get('stroke')
        count[look] = count.get(look, 0) + 1
    return count


def test_examples():
    for lens in sorted(LENSES.glob('*.yaml')):
        root = picture(lens)
        equal(root.tag, SVG + 'svg')
        width, height = size(root)
        assert 700 <= width <= 1200 and 200 <= height <= 800, (lens, width, height)


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
    width, height = size(picture(written('surfaces:\n  - {type: plane}\n'), '--rays', '-', stdin=rays()))
    assert 0 < width < 2000 and 0 < height < 2000


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
    assert str(path) in run('trace', LENSES / 'ftheta.yaml', '--svg', path, exit=BAD_INPUT).stderr


def without_cairo():
    done = run('trace', LENSES / 'ftheta.yaml', '--svg', written('').parent / 'x.svg', exit=USAGE)
    assert 'without cairo' in done.stderr, done.stderr


main({'test_without_cairo': without_cairo} if '--without-cairo' in sys.argv else globals())
