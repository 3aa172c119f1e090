#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Glass in a lens file: names, models, formulas, pairs; wavelengths by number, micrometres and line; catalogues.

The oracle is the same lens with the index as a number, worked out here by the formula as it is printed.
"""
import math
import pathlib

from command import BAD_INPUT, USAGE, equal, main, rows, run, written

LENS = """wavelengths: [0.5875618, 0.4861327]
pupil: {semi_diameter: 6}
surfaces:
  - {type: plane, thickness: 10, stop: true, semi_diameter: 6}
  - {type: sphere, radius: 51.68, thickness: 4, glass: N-BK7, semi_diameter: 8}
  - {type: sphere, radius: -70, thickness: 50, glass: air, semi_diameter: 8}
  - {type: plane, semi_diameter: 12}
primary: 1
"""
BK7 = [1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653]  # SCHOTT's data sheet
NUMBERS = ('x', 'y', 'z', 'l', 'm', 'n', 't', 'opl')


def sellmeier(w, c):
    return math.sqrt(1 + sum(k * w * w / (w * w - l) for k, l in zip(c[::2], c[1::2])))


def with_glass(glass, text=LENS):
    return written(text.replace('glass: N-BK7', f'glass: {glass}'))


def same_trace(lens, index, *options):
    """The trace of a lens is that with this index: to a few roundings, since n may differ in its last bit."""
    got = rows('trace', lens, *options)
    plain = LENS.replace('glass: N-BK7', f'index: {index!r}').replace('glass: air', 'index: 1')
    wanted = rows('trace', written(plain))
    equal(len(got), len(wanted))
    for a, b in zip(got, wanted):
        assert all(abs(float(a[k]) - float(b[k])) < 1e-12 for k in NUMBERS), (index, options, a, b)


def test_wavelengths():
    lens = written(LENS)
    for w, um in (('1', 0.5875618), ('2', 0.4861327), ('d', 0.5875618), ('F', 0.4861327), ("F'", 0.4799914),
                  ('C', 0.6562725), ("C'", 0.6438469), ('e', 0.5460740), ('g', 0.4358343), ('h', 0.4046561),
                  ('i', 0.3650146), ('r', 0.7065188), ('s', 0.85211), ('t', 1.01398), ('D', 0.5892938),
                  ('0.55', 0.55), ('1.', 1.0), ('1.5e0', 1.5)):
        same_trace(lens, sellmeier(um, BK7), '--wavelength', w)
    equal(run('trace', lens, '--wavelength', 'F').stdout, run('trace', lens, '--wavelength', '2').stdout)


def test_forms():
    same_trace(with_glass('{sellmeier: [%s]}' % ', '.join(map(repr, BK7))), sellmeier(0.5875618, BK7))
    same_trace(with_glass('[[0.4, 1.6], [0.5, 1.5], [0.7, 1.4]]'), 1.46, '--wavelength', '0.58')
    same_trace(with_glass('[[0.4, 1.6]]'), 1.6, '--wavelength', '0.4')
    same_trace(with_glass('{nd: 1.5168, vd: 64.17}'), 1.5168)
    same_trace(with_glass('{nd: 1.5168, vd: 0}'), 1.5168, '--wavelength', 'g')
    same_trace(with_glass('schott n-bk7'), sellmeier(0.5875618, BK7))
    said = run('trace', with_glass('{nd: 1.5168, vd: 64.17}')).stderr
    assert 'yaml:5: glass: taken as a model of nd and vd: its index is approximate' in said, said
    n = [float(r['opl']) for w in 'FdC' for r in rows('trace', with_glass('{nd: 1.5168, vd: 64.17}'), '--fan', '1',
                                                      '--wavelength', w) if r['element'] == '3']
    assert abs((n[1] - 20) / (n[0] - n[2]) - 64.17) < 1e-9, n  # 4 mm of glass on the axis


def test_object():
    text = LENS.replace('pupil:', 'object: {glass: N-BK7}\npupil:')
    plain = LENS.replace('pupil:', f'object: {{index: {sellmeier(0.5875618, BK7)!r}}}\npupil:')
    for a, b in zip(rows('trace', written(text), '--fan', '3'), rows('trace', written(plain), '--fan', '3')):
        assert all(abs(float(a[k]) - float(b[k])) < 1e-12 for k in NUMBERS), (a, b)


def test_notes():
    said = run('trace', written(LENS), '--wavelength', '3.0').stderr
    assert ':5: glass: 3 micrometres is outside the range of N-BK7, 0.3 to 2.5' in said, said
    equal(run('trace', written(LENS)).stderr, '')
    assert 'glass: taken as BAF10 of hoya, nd 1.67003; also of hikari (nd the same)' in run('trace', with_glass('BAF10')).stderr
    indices = [rows('trace', with_glass('BAF10', f'makers: [{makers}]\n' + LENS)) for makers in ('NOBODY, HOYA', 'HOYA', 'Hikari, HOYA')]
    assert indices[0] == indices[1] != indices[2]  # the lens says whose: no note
    equal(run('trace', with_glass('BAF10', 'makers: [NOBODY, HOYA]\n' + LENS)).stderr, '')
    equal(run('trace', with_glass('HOYA BAF10')).stderr, '')


def test_catalogues():
    agf = (f'CC own\nNM N-BK7 2 0 1.6 60 0 1 1\nCD {" ".join(map(repr, [1.5] + BK7[1:]))} 0 0\nLD 0.3 2.5\n'
           'NM MINE 5 0 1.5 60 0 1 1\nCD 1.5 0.01 0.001\nLD 0.3 2.5\n')
    one = written(agf, 'OWN.agf')
    for path in (one, one.parent):
        same_trace(with_glass('MINE'), 1.5 + 0.01 / 0.5875618 + 0.001 / 0.5875618 ** 3.5, '--glass', path)
        same_trace(with_glass('own N-BK7'), sellmeier(0.5875618, [1.5] + BK7[1:]), '--glass', path)
        same_trace(written(LENS), sellmeier(0.5875618, [1.5] + BK7[1:]), '--glass', path)
        same_trace(with_glass('SCHOTT N-BK7'), sellmeier(0.5875618, BK7), '--glass', path)
    bad = written(agf.replace('CD 1.5 0.01', 'CD nan 0.01'), 'BAD.AGF')
    said = run('trace', with_glass('MINE'), '--glass', bad, exit=BAD_INPUT).stderr
    assert f'{bad}:6: CD: "nan" is not a finite number' in said, said
    assert 'cannot be opened' in run('trace', written(LENS), '--glass', '/nowhere', exit=BAD_INPUT).stderr


def test_errors():
    for glass, words in (('N-BK77', 'glass: no glass "N-BK77"; nearest: schott N-BK7'), ('1.5', 'glass: no glass "1.5"'),
                         ('[]', 'glass: no coefficients'), ('{}', 'nd: missing'), ('{nd: 1.5}', 'vd: missing'),
                         ('{nd: -1, vd: 2}', 'nd: must be positive'), ('{nd: 1.5, vd: -2}', 'vd: must not be negative'),
                         ('{nd: .nan, vd: 2}', 'nd: '), ('{n: 1}', 'n: unknown key; known here: nd, vd, dPgF'),
                         ('{sellmeier: [1]}', 'must be pairs'), ('{sellmeier: []}', 'at least one number'),
                         ('{sellmeier: [1, 2], nd: 1}', 'sellmeier: given beside'), ('[1, 2]', 'must be pairs'),
                         ('[[1, 2, 3]]', 'must be pairs'), ('[[2, 1.5], [1, 1.5]]', 'must rise'),
                         ('[[-1, 2]]', 'not positive'), ('[[1, -2]]', 'not positive'), ('[[1, .nan]]', 'glass[1]'),
                         ('{sellmeier: [-5, 0.01]}', 'glass: the glass has no index at 0.587562 micrometres'),
                         ('N-BK7, index: 1.5', 'glass: given beside index'), ('N-BK7, mirror: true', 'glass: must be left')):
        said = run('trace', with_glass(glass), exit=BAD_INPUT).stderr
        assert ':5: ' in said and words in said, (glass, said)
    said = run('trace', written(LENS.split('\n', 1)[1]), exit=BAD_INPUT).stderr
    assert ':4: glass: needs a wavelength' in said, said
    same_trace(written(LENS.split('\n', 1)[1]), sellmeier(0.55, BK7), '--wavelength', '0.55')
    listed = written(LENS.replace('glass: N-BK7', 'index: [1.5, 1.6]'))
    same_trace(listed, 1.6, '--wavelength', '0.4861327')
    said = run('trace', listed, '--wavelength', '0.55', exit=BAD_INPUT).stderr
    assert ':5: index: is for the wavelengths of the file; 0.55 micrometres is none of them' in said, said
    said = run('trace', written('makers: SCHOTT\n' + LENS), exit=BAD_INPUT).stderr
    assert ':1: makers: must be a list of names' in said, said
    for w in ('x', '0', '-1', '3', '0.0', '-0.5', '.nan', '.inf', '', 'FF', 'f', '1e0'):
        run('trace', written(LENS), '--wavelength', w, exit=USAGE)
    run('diagnose', '--surface', '{type: plane}', '--ray', '0 0 -1 0 0 1', '--glass', 'x', exit=USAGE)


if __name__ == '__main__':
    main(globals())
