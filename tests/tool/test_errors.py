#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Bad input: the right exit status, and a message that names file, line and key.

    python3 test_errors.py SAGITTA
"""
import re
import shlex
import subprocess

from command import *

RAY = ('--ray', '0 0 -5 0 0 1')

# surface, key (or word) the message must name
SURFACES = [
    ('{radius: 2}', 'type'),
    ('{type: sphare}', 'type'),
    ('{type: [sphere]}', 'type'),
    ('{type: sphere, radius: abc}', 'radius'),
    ('{type: sphere, radius: }', 'radius'),
    ('{type: sphere, radius: 0}', 'radius'),
    ('{type: sphere, radius: 1e-320}', 'radius'),
    ('{type: sphere, radius: .nan}', 'radius'),
    ('{type: sphere, radius: 1e999}', 'radius'),
    ('{type: sphere, radius: 2x}', 'radius'),
    ('{type: sphere, radius: "2"}', 'radius'),
    ('{type: sphere, radius: 1_000}', 'radius'),
    ('{type: sphere, radius: [2]}', 'radius'),
    ('{type: sphere, radius: 2, curvature: 0.5}', 'radius'),
    ('{type: sphere, curvature: .inf}', 'curvature'),
    ('{type: sphere, curvature: {}}', 'curvature'),
    ('{type: sphere, radius: 2, radius: 3}', 'radius'),
    ('{type: sphere, conic: -1}', 'conic'),
    ('{type: plane, radius: 2}', 'radius'),
    ('{type: sphere, raduis: 2}', 'raduis'),
    ('{type: sphere, semi_diameter: -1}', 'semi_diameter'),
    ('{type: sphere, thickness: 1}', 'thickness'),
    ('{type: even_asphere, coefficients: 1}', 'coefficients'),
    ('{type: even_asphere, coefficients: []}', 'coefficients'),
    ('{type: even_asphere, coefficients: [1, x]}', 'coefficients[1]'),
    ('{type: even_asphere, coefficients: [1, .inf]}', 'coefficients[1]'),
    ('{type: even_asphere, coefficients: [1,1,1,1,1,1,1,1,1]}', 'coefficients'),
    ('{type: even_asphere, coefficients: [1, [2]]}', 'coefficients[1]'),
    ('{type: julia, radius: 2}', 'radius: unknown key'),
    ('{type: julia, semi_diameter: 2}', 'semi_diameter: unknown key'),
    ('{type: mandelbrot, c: [0, 0, 0, 0]}', 'c: unknown key'),
    ('{type: julia, c: 1}', 'c: must be a list of 4 numbers'),
    ('{type: julia, c: []}', 'c: must hold'),
    ('{type: julia, c: [1, 2, 3]}', 'c: has 3 numbers; it must have 4'),
    ('{type: julia, c: [1, 2, 3, 4, 5]}', 'c: has 5 numbers; it must have 4'),
    ('{type: julia, c: [0, 0, x, 0]}', 'c[2]: must be a number'),
    ('{type: julia, c: [0, 0, 0, 1e7]}', 'c[3]: must be from -1000000 to 1000000, not 10000000'),
    ('{type: julia, c: [.nan, 0, 0, 0]}', 'c[0]: must be from -1000000 to 1000000, not nan'),
    ('{type: julia, at: [0, 0, 0, 0], slice: 0}', 'slice: given beside at'),
    ('{type: mandelbrot, slice: 0.5, at: [0, 0, 0, 0.5]}', 'slice: given beside at'),
    ('{type: julia, slice: [1]}', 'slice: must be a number'),
    ('{type: julia, slice: .inf}', 'slice: must be from'),
    ('{type: julia, ex: [1, 0, 0, 0]}', 'ey: missing, and so '),
    ('{type: julia, ey: [0, 1, 0, 0], ez: [1, 0, 0, 0]}', 'ex: missing, and so '),
    ('{type: julia, ex: [1, 0, 0, 0], ey: [0, 1, 0, 0], ez: [1, 1, 0, 0]}', 'ez: '),
    ('{type: mandelbrot, ex: [1, 0, 0, 0], ey: [0, 0, 0, 0], ez: [0, 0, 1, 0]}', 'ey: '),
    ('{type: mandelbrot, ex: [1e-110, 0, 0, 0], ey: [0, 1, 0, 0], ez: [0, 0, 1, 0]}', 'ex: '),
    ('{type: julia, ex: [1e101, 0, 0, 0], ey: [0, 1, 0, 0], ez: [0, 0, 1, 0]}', 'ex[0]: must be from'),
    ('{type: mandelbrot, ex: [1, 0, 0, 0], ey: [0, 1, 0], ez: [0, 0, 1, 0]}', 'ey: has 3 numbers'),
    ('{type: julia, ey: [.inf, 0, 0, 0]}', 'ey[0]'),
    ('{type: julia, ez: 3}', 'ez: '),
    ('{type: julia, c: [-0.2, 0.8, 0, 0], escape: 1.5}', 'escape: '),
    ('{type: mandelbrot, escape: 1.9}', 'escape: '),
    ('{type: mandelbrot, power: 3, escape: 1.4}', 'escape: '),
    ('{type: julia, escape: -1}', 'escape: must be from'),
    ('{type: julia, escape: 0}', 'escape: must be from'),
    ('{type: julia, escape: 1e7}', 'escape: must be from'),
    ('{type: julia, escape: .nan}', 'escape: must be from'),
    ('{type: julia, iterations: 0}', 'iterations: must be a whole number from 1 to 10000, not 0'),
    ('{type: julia, iterations: 10001}', 'iterations: must be a whole number from 1 to 10000, not 10001'),
    ('{type: julia, iterations: -3}', 'iterations: must be a whole number from 1 to 10000, not -3'),
    ('{type: julia, iterations: 2.5}', 'iterations: must be a whole number from 1 to 10000, not 2.5'),
    ('{type: julia, iterations: 1e30}', 'iterations: must be a whole number from 1 to 10000, not 1e+30'),
    ('{type: julia, iterations: .nan}', 'iterations: must be a whole number from 1 to 10000, not nan'),
    ('{type: mandelbrot, iterations: .inf}', 'iterations: must be a whole number from 1 to 10000, not inf'),
    ('{type: mandelbrot, iterations: [4]}', 'iterations: must be a number'),
    ('{type: mandelbrot, iterations: many}', 'iterations: must be a number'),
    ('{type: julia, iterations: "4"}', 'iterations: must be a number'),
    ('{type: julia, power: 1}', 'power: must be a whole number from 2 to 8, not 1'),
    ('{type: mandelbrot, power: 9}', 'power: must be a whole number from 2 to 8, not 9'),
    ('{type: julia, power: 2.1}', 'power: must be a whole number from 2 to 8, not 2.1'),
    ('{type: odd_asphere, coefficients: [%s]}' % ', '.join(['1'] * 17), 'coefficients: has 17 numbers; at most 16 are allowed'),
    ('{type: odd_asphere, coefficients: [1, ~]}', 'coefficients[1]: must be a number'),
    ('{type: odd_asphere, norm: 1}', 'norm: unknown key'),
    ('{type: polynomial_xy, coefficients: [1, 2]}', 'coefficients[0]: must be a row'),
    ('{type: polynomial_xy, coefficients: 1}', 'coefficients: must be a list of rows'),
    ('{type: polynomial_xy, coefficients: []}', 'coefficients: must hold at least one row'),
    ('{type: polynomial_xy, coefficients: [[1], []]}', 'coefficients[1]: must hold at least one number'),
    ('{type: polynomial_xy, coefficients: [[1], [1, .nan]]}', 'coefficients[1][1]: must be finite'),
    ('{type: polynomial_xy, coefficients: [[1], [1, [2]]]}', 'coefficients[1][1]: must be a number'),
    ('{type: polynomial_xy, coefficients: [%s]}' % ', '.join(['[1]'] * 33), 'coefficients: has 33 rows; at most 32 are allowed'),
    ('{type: polynomial_xy, coefficients: [[1], [%s]]}' % ', '.join(['1'] * 33), 'coefficients[1]: has 33 numbers; at most 32 are allowed'),
    ('{type: polynomial_xy, coefficients: &a [*a]}', 'coefficients[0][0]: must be a number'),
    ('{type: chebyshev, norm_x: 0, norm_y: 1, coefficients: [[1]]}', 'norm_x: '),
    ('{type: chebyshev, norm_x: 1, norm_y: -1, coefficients: [[1]]}', 'norm_y: '),
    ('{type: chebyshev, norm_x: 1, coefficients: [[1]]}', 'norm_y: missing'),
    ('{type: chebyshev, norm_x: 1, norm_y: .inf, coefficients: [[1]]}', 'norm_y: must be finite'),
    ('{type: chebyshev, norm_x: 1, norm_y: 1, coefficients: [%s]}' % ', '.join(['[1]'] * 65), 'coefficients: has 65 rows; at most 64 are allowed'),
    ('{type: zernike, norm: 0, order: noll, coefficients: [1]}', 'norm: '),
    ('{type: zernike, order: noll, coefficients: [1]}', 'norm: missing'),
    ('{type: zernike, norm: 1, coefficients: [1]}', 'order: missing'),
    ('{type: zernike, norm: 1, order: osa, coefficients: [1]}', 'order: must be one of noll|fringe, not "osa"'),
    ('{type: zernike, norm: 1, order: noll|fringe, coefficients: [1]}', 'order: must be one of'),
    ('{type: zernike, norm: 1, order: "", coefficients: [1]}', 'order: must be one of'),
    ('{type: zernike, norm: 1, order: 1, coefficients: [1]}', 'order: must be one of'),
    ('{type: zernike, norm: 1, order: [noll], coefficients: [1]}', 'order: must be a word'),
    ('{type: zernike, norm: 1, order: noll, normalised: 1, coefficients: [1]}', 'normalised: must be true or false'),
    ('{type: zernike, norm: 1, order: noll, normalised: maybe}', 'normalised: must be true or false'),
    ('{type: zernike, norm: 1, order: noll, coefficients: [%s]}' % ', '.join(['1'] * 5152), 'coefficients: has 5152 numbers; at most 5151 are allowed'),
    ('{type: zernike, norm: 1, order: noll, coefficients: [[1]]}', 'coefficients[0]: must be a number'),
    ('{type: q_con, norm: -2, coefficients: [1]}', 'norm: '),
    ('{type: q_con, coefficients: [1]}', 'norm: missing'),
    ('{type: q_con, norm: 1, coefficients: [%s]}' % ', '.join(['1'] * 65), 'coefficients: has 65 numbers; at most 64 are allowed'),
    ('{type: q_bfs, norm: 0, coefficients: [1]}', 'norm: '),
    ('{type: q_bfs, norm: 1, conic: -1, coefficients: [1]}', 'conic: unknown key'),
    ('{type: q_bfs, norm: 1, coefficients: [1, 1e999]}', 'coefficients[1]: '),
    ('{type: grid, step_x: 0, step_y: 1, sag: [[1, 1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 1]]}', 'step_x: '),
    ('{type: grid, step_x: 1, step_y: -1, sag: [[1, 1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 1]]}', 'step_y: '),
    ('{type: grid, step_x: 1, step_y: 1}', 'sag: missing'),
    ('{type: grid, step_x: 1, step_y: 1, sag: [[1, 1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 1]]}', 'sag: '),
    ('{type: grid, step_x: 1, step_y: 1, sag: [[1, 1, 1], [1, 1, 1], [1, 1, 1], [1, 1, 1]]}', 'sag: '),
    ('{type: grid, step_x: 1, step_y: 1, sag: [[1, 1, 1, 1], [1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 1]]}', 'sag[1]: has 3 numbers, but the rows before have 4'),
    ('{type: grid, step_x: 1, step_y: 1, sag: [[1, 1, 1, 1], [1, 1, 1, 1, 1], [1, 1, 1, 1], [1, 1, 1, 1]]}', 'sag[1]: has 5 numbers, but the rows before have 4'),
    ('{type: grid, step_x: 1, step_y: 1, sag: [[1, 1, 1, 1], [1, .nan, 1, 1], [1, 1, 1, 1], [1, 1, 1, 1]]}', 'sag[1][1]: must be finite'),
    ('{type: grid, step_x: 1, step_y: 1, sag: [[1, 1, 1, 1], [1, , 1, 1], [1, 1, 1, 1], [1, 1, 1, 1]]}', ''),
    ('{type: sum, terms: {type: odd_asphere}}', 'terms: must be a list of surfaces'),
    ('{type: sum, terms: []}', 'terms: must hold at least one surface'),
    ('{type: sum, terms: [odd_asphere]}', 'terms[0]: must be a map'),
    ('{type: sum, terms: [{coefficients: [1]}]}', 'type: missing'),
    ('{type: sum, terms: [{type: odd_asphare}]}', 'type: no surface is called "odd_asphare"'),
    ('{type: sum, terms: [{type: odd_asphere, radius: 3}]}', 'radius: unknown key'),
    ('{type: sum, terms: [{type: odd_asphere, conic: 3}]}', 'conic: unknown key'),
    ('{type: sum, terms: [{type: odd_asphere, semi_diameter: 3}]}', 'semi_diameter: unknown key'),
    ('{type: sum, terms: [{type: odd_asphere}, {type: zernike, norm: 0, order: noll}]}', 'norm: '),
    ('{type: sum, terms: [{type: odd_asphere}, {type: torus, major: 2, minor: 1}]}', 'terms[1]: '),
    ('{type: sum, terms: [{type: odd_asphere}, {type: sum, terms: []}]}', 'terms[1]: '),
    ('{type: sum, terms: &a [{type: sum, terms: *a}]}', 'terms[0]: '),
    ('{type: sum, terms: [%s]}' % ', '.join(['{type: odd_asphere}'] * 17), 'terms: has 17 surfaces; at most 16 are allowed'),
    ('{type: sum, coefficients: [1]}', 'coefficients: unknown key'),
    ('{type: toroidal, radius: 2, curvature_x: .inf}', 'curvature_x: must be finite'),
    ('{type: toroidal, radius_x: 0}', 'radius_x: must not be zero'),
    ('{type: toroidal, radius_x: 1, curvature_x: 1}', 'radius_x: given beside curvature_x'),
    ('{type: toroidal, radius_y: 1}', 'radius_y: unknown key'),
    ('{type: biconic, radius: 1}', 'radius: unknown key; did you mean radius_x?'),
    ('{type: biconic, conic_y: .nan}', 'conic_y: must be finite'),
    ('{type: cylinder, radius_y: 1}', 'radius_y: unknown key'),
    ('{type: cylinder, semi_diameter: -1}', 'semi_diameter: must be finite and at least 0'),
    ('{type: quadric}', 'squares: missing, and so all zero'),
    ('{type: quadric, squares: [0, 0, 0], constant: 3}', 'squares: '),
    ('{type: quadric, squares: [1, 2]}', 'squares: has 2 numbers; it must have 3'),
    ('{type: quadric, linear: [1, 2, 3, 4]}', 'linear: has 4 numbers; it must have 3'),
    ('{type: quadric, products: [1, 2, .inf]}', 'products[2]: must be finite'),
    ('{type: quadric, squares: [1, 1, 1], semi_diameter: 2}', 'semi_diameter: unknown key'),
    ('{type: ellipsoid}', 'a: missing'),
    ('{type: ellipsoid, a: 0}', 'a: '),
    ('{type: ellipsoid, a: -2}', 'a: '),
    ('{type: ellipsoid, a: 2, f: 1}', 'f: '),
    ('{type: ellipsoid, a: 2, f: 3}', 'f: '),
    ('{type: ellipsoid, a: 2, b: 1}', 'b: unknown key'),
    ('{type: torus, major: 2}', 'minor: missing'),
    ('{type: torus, major: -2, minor: 1}', 'major: '),
    ('{type: torus, major: 2, minor: 0}', 'minor: '),
    ('{type: torus, majr: 2, minor: 1}', 'majr: unknown key'),
    ('{type: sphere', ':1: '),
    ('{type: sphere}}', ''),
    ('[1, 2]', 'map'),
    ('sphere', 'map'),
    ('', 'empty'),
    ('# nothing', 'empty'),
    ('{type: sphere}\n---\n{type: sphere}', 'second document'),
    ('{[1]: 2}', 'key'),
    ('{type: "sphere\\0"}', ''),
    ('{type: *nobody}', ''),
]


def test_surfaces():
    for text, word in SURFACES:
        done = run('intersect', '--surface', text, *RAY, exit=BAD_INPUT)
        assert '--surface:' in done.stderr and word in done.stderr, f'{text!r}: {done.stderr}'
        equal(done.stdout, '', text)


def test_line_of_a_surface():
    done = run('intersect', '--surface', 'type: sphere\n\nradius: x\n', *RAY, exit=BAD_INPUT)
    assert '--surface:3: radius:' in done.stderr, done.stderr
    text = 'type: julia\nc: [-0.2, 0.8, 0, 0]\nescape: 1\niterations: 5\n'
    done = run('intersect', '--surface', text, *RAY, exit=BAD_INPUT)
    assert '--surface:3: escape:' in done.stderr, done.stderr


GOOD = '''name: a lens
units: mm
wavelengths: [0.5, 0.6]
object: {distance: .inf, index: 1}
pupil: {semi_diameter: 1}
fields: [0]
surfaces:
  - {type: sphere, radius: 10, thickness: 2, index: 1.5}
  - {type: plane, thickness: 5, index: [1.2, 1.3], stop: true}
  - {type: plane}
'''

# what to replace, by what, the line, the key
LENSES_WRONG = [
    ('units: mm', 'unitz: mm', 2, 'unitz'),
    ('name: a lens', 'name: [a]', 1, 'name'),
    ('name: a lens', 'units: in', 2, 'units'),
    ('[0.5, 0.6]', '0.5', 3, 'wavelengths'),
    ('[0.5, 0.6]', '[]', 3, 'wavelengths'),
    ('[0.5, 0.6]', '[0.5, -0.6]', 3, 'wavelengths'),
    ('distance: .inf', 'distance: -1', 4, 'object.distance'),
    ('distance: .inf', 'distance: .nan', 4, 'object.distance'),
    ('distance: .inf', 'distanse: 1', 4, 'distanse'),
    ('index: 1}', 'index: 0}', 4, 'object.index'),
    ('object: {distance: .inf, index: 1}', 'object: 5', 4, 'object'),
    ('semi_diameter: 1}', 'semi_diameter: 0}', 5, 'pupil.semi_diameter'),
    ('semi_diameter: 1}', 'distance: .inf}', 5, 'pupil.distance'),
    ('pupil: {semi_diameter: 1}\n', '', 1, 'pupil.semi_diameter'),
    ('fields: [0]', 'fields: [0, 90]', 6, 'fields'),
    ('fields: [0]', 'fields: []', 6, 'fields'),
    ('fields: [0]', 'fields: 3', 6, 'fields'),
    ('type: sphere', 'typ: sphere', 8, 'type'),
    ('type: sphere', 'type: box', 8, 'type'),
    ('radius: 10', 'radius: ten', 8, 'radius'),
    ('radius: 10', 'conic: 1', 8, 'conic'),
    ('thickness: 2', 'thickness: .inf', 8, 'thickness'),
    ('thickness: 2', 'thickness: 2, thickness: 3', 8, 'thickness'),
    ('thickness: 2', 'tickness: 2', 8, 'tickness'),
    ('thickness: 2, ', '', 8, 'thickness: missing; 0 if that is meant'),
    ('thickness: 5, ', '', 9, 'thickness: missing; 0 if that is meant'),
    ('index: 1.5', 'index: -1.5', 8, 'index'),
    ('index: 1.5', 'mirror: 1', 8, 'mirror'),
    ('index: 1.5', 'mirror: true, index: 1.5', 8, 'index'),
    ('index: 1.5', 'stop: true', 9, 'stop'),
    ('index: 1.5', 'stop: yes', 8, 'stop'),
    ('index: 1.5', 'tilt: [1, 2]', 8, 'tilt'),
    ('index: 1.5', 'decenter: 1', 8, 'decenter'),
    ('index: 1.5', 'semi_diameter: -1', 8, 'semi_diameter'),
    ('index: 1.5', 'semi_diameter: .inf', 8, 'semi_diameter'),
    ('thickness: 2', 'origin: [0, 0, 0]', 9, 'origin'),
    ('index: 1.5', 'origin: [0, 0, 0]', 8, 'thickness'),
    ('thickness: 2', 'origin: [0, 0, 0], decenter: [0, 0, 1]', 8, 'decenter'),
    ('[1.2, 1.3]', '[1.2]', 9, 'index'),
    ('[1.2, 1.3]', '[1.2, 1.3, 1.4]', 9, 'index'),
    ('[1.2, 1.3]', '[1.2, x]', 9, 'index'),
    ('  - {type: plane}\n', '  - 5\n', 10, 'surfaces'),
    ('  - {type: plane}\n', '  - {type: plane\n', 10, ''),
]


def test_lenses():
    run('trace', written(GOOD))
    for old, new, line, key in LENSES_WRONG:
        assert GOOD.count(old) >= 1, old
        path = written(GOOD.replace(old, new, 1))
        done = run('trace', path, exit=BAD_INPUT)
        assert f'{path}:{line}: {key}' in done.stderr, f'{new!r}: {done.stderr}'
        equal(done.stdout, '', new)


def test_lens_without_surfaces():
    for text in ('name: x\n', 'surfaces: []\n', 'surfaces: 3\n'):
        done = run('trace', written(text), exit=BAD_INPUT)
        assert ':1: surfaces: ' in done.stderr, done.stderr


def test_pupil_that_cannot_be_found():
    at_infinity = 'pupil: {semi_diameter: 1}\nsurfaces:\n  - {type: sphere, radius: 5, thickness: 15, index: 1.5}\n  - {type: plane, stop: true}\n'
    done = run('trace', written(at_infinity), exit=BAD_INPUT)
    assert ':1: pupil.distance: ' in done.stderr, done.stderr
    tilted = '''pupil: {semi_diameter: 1}
surfaces:
  - {type: plane, origin: [0, 0, 0], tilt: [45, 0, 0], mirror: true}
  - {type: plane, origin: [0, 5, 0], tilt: [90, 0, 0], stop: true}
'''
    done = run('trace', written(tilted), exit=BAD_INPUT)
    assert ':1: pupil.distance: ' in done.stderr, done.stderr


# a file of rays, the line, the column or word
RAYS = [
    ('', None, 'header'),
    ('\n\n', None, 'header'),
    ('ox,oy,oz,dx,dy\n0,0,0,0,0\n', 1, 'dz'),
    ('ox,oy,oz,dx,dy,dz,w\n', 1, 'w'),
    ('ox,oy,oz,dx,dy,dz,ox\n', 1, 'ox'),
    ('ox,oy,oz,dx,dy,dz\n0,0,-5,0,0,1\n0,0,x,0,0,1\n', 3, 'oz'),
    ('ox,oy,oz,dx,dy,dz\n\n\n0,0,-5,0,0,nan\n', 4, 'dz'),
    ('ox,oy,oz,dx,dy,dz\n0,0,-5,0,0,inf\n', 2, 'dz'),
    ('ox,oy,oz,dx,dy,dz\n0,0,-5,0,0,0\n', 2, 'direction'),
    ('ox,oy,oz,dx,dy,dz\n0,0,-5,0,0,1e-310\n', 2, 'direction'),
    ('ox,oy,oz,dx,dy,dz\n0,0,-5,0,0\n', 2, 'fewer'),
    ('ox,oy,oz,dx,dy,dz\n0,0,-5,0,0,1,2\n', 2, 'more'),
    ('ox,oy,oz,dx,dy,dz\n' + ','.join('1' * 200) + '\n', 2, 'more'),
    ('ox,oy,oz,dx,dy,dz\n0,0,-5,0,0,\n', 2, 'dz'),
    ('ox,oy,oz,dx,dy,dz\n0,0,-5,0,0,1 2\n', 2, 'dz'),
    ('ox,oy,oz,dx,dy,dz,tmin,tmax\n0,0,-5,0,0,1,3,2\n', 2, 'tmin'),
    ('ox,oy,oz,dx,dy,dz,tmin,tmax\n0,0,-5,0,0,1,nan,2\n', 2, 'tmin'),
    ('ox,oy,oz,dx,dy,dz,id\n0,0,-5,0,0,1,"a\n', 2, 'quote'),
    ('ox,oy,oz,dx,dy,dz,id\n0,0,-5,0,0,1,"a"b\n', 2, 'quote'),
    ('ox,oy,oz,dx,dy,dz\n0,0,-5,0,0,1\0002\n', 2, ''),
]


def test_rays():
    lens = written(GOOD)
    for text, line, word in RAYS:
        path = written(text, 'rays.csv')
        where = f'{path}:{line}: ' if line else f'{path}: '
        for command in (('intersect', '--surface', '{type: plane}'), ('trace', lens)):
            done = run(*command, '--rays', path, exit=BAD_INPUT)
            assert where in done.stderr and word in done.stderr.split(where)[1], f'{text!r}: {done.stderr}'
            equal(done.stdout, '', text)


def test_ray_option():
    for text in ('', '1 2 3', '0 0 0 0 0 0', '0 0 0 0 0 x', '0 0 0 0 0 inf', '0 0 0 0 0 1 2', '0 0 0 0 0 1 2 1',
                 '0 0 0 0 0 1 2 3 4', '0 ' * 1000):
        assert '--ray: ' in run('intersect', '--surface', '{type: plane}', '--ray', text, exit=BAD_INPUT).stderr, text
    # without quotes only the first number belongs to --ray
    said = run('intersect', '--surface', '{type: plane}', '--ray', *'0 0 5 0 0 1'.split(), exit=BAD_INPUT).stderr
    assert 'put the whole ray in quotes' in said, said


def test_inputs_are_not_written_over():
    lens, csv = written(GOOD), written(rays((0, 0, -1, 0, 0, 1)), 'rays.csv')
    other = lens.parent / 'other.yaml'
    other.hardlink_to(lens)
    text, points = lens.read_text(), csv.read_text()
    for arguments in (('trace', lens, '--output', lens), ('trace', lens, '--output', other), ('diagnose', lens, '--output', lens),
                      ('trace', lens, '--rays', csv, '--output', csv),
                      ('intersect', '--surface', '{type: plane}', '--rays', csv, '--output', csv)):
        done = run(*arguments, exit=USAGE)
        assert '--output' in done.stderr and 'written over' in done.stderr, done.stderr
        equal((done.stdout, lens.read_text(), csv.read_text()), ('', text, points))


def test_files_that_are_not_there():
    missing, here = written('').parent / 'nothing', written('').parent
    for arguments in (('trace', missing), ('trace', here), ('diagnose', missing),
                      ('intersect', '--surface', '{type: plane}', '--rays', missing),
                      ('intersect', '--surface', '{type: plane}', *RAY, '--output', missing / 'x'),
                      ('trace', written(GOOD), '--output', here)):
        done = run(*arguments, exit=BAD_INPUT)
        assert str(missing) in done.stderr or str(here) in done.stderr, done.stderr


USAGES = [
    (),
    ('bake',),
    ('--bake',),
    ('intersect',),
    ('intersect', '--surface', '{type: plane}'),
    ('intersect', *RAY),
    ('intersect', '--surface', '{type: plane}', *RAY, 'more'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--rays', '-'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--all', '--pick', 'first'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--proof', 'best'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--format', 'xml'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--pick', 'last'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--t-tol', 'x'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--t-tol', '-1'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--t-tol', 'inf'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--dt-min', 'x'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--dt-min', '-1'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--dt-min', 'nan'),
    ('diagnose', '--surface', '{type: plane}', *RAY, '--dt-min', '.inf'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--max-evals', '0'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--max-evals', '1.5'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--max-evals', '99999999999999999999'),
    ('intersect', '--surface', '{type: plane}', *RAY, '--unknown'),
    ('intersect', '--surface'),
    ('trace',),
    ('trace', 'LENS', 'more'),
    ('trace', 'LENS', '--field', '90'),
    ('trace', 'LENS', '--field', 'nan'),
    ('trace', 'LENS', '--fan', '0'),
    ('trace', 'LENS', '--fan', '-3'),
    ('trace', 'LENS', '--fan', '3', '--grid', '3'),
    ('trace', 'LENS', '--rays', '-', '--field', '3'),
    ('trace', 'LENS', '--rays', '-', '--grid', '3'),
    ('trace', 'LENS', '--wavelength', '0'),
    ('trace', 'LENS', '--wavelength', '3'),
    ('trace', 'LENS', '--frame', 'mine'),
    ('diagnose',),
    ('diagnose', 'LENS', '--surface', '{type: plane}', *RAY),
    ('diagnose', '--surface', '{type: plane}'),
    ('diagnose', '--surface', '{type: plane}', *RAY, '--element', '1'),
    ('diagnose', '--surface', '{type: plane}', *RAY, '--fan', '3'),
    ('diagnose', '--surface', '{type: plane}', *RAY, '--method', 'secant'),
    ('diagnose', 'LENS', '--ray', '99'),
    ('diagnose', 'LENS', '--ray', '0 0 0 0 0 1'),
    ('diagnose', 'LENS', '--element', '4'),
]


def test_usage():
    lens = written(GOOD)
    for arguments in USAGES:
        done = run(*(lens if a == 'LENS' else a for a in arguments), exit=USAGE)
        equal(done.stdout, '', arguments)
        assert 'sagitta' in done.stderr and '--help' in done.stderr, done.stderr


def test_small_slips():
    lens = written(GOOD)
    assert 'no ray' in run('trace', lens, '--grid', '2', exit=USAGE).stderr
    assert 'header missing' in run('trace', lens, '--rays', '-', stdin='0,0,-5,0,0,1\n', exit=BAD_INPUT).stderr
    assert 'decimal point' in run('intersect', '--surface', 'type: sphere\nradius: 51,68\n', *RAY, exit=BAD_INPUT).stderr
    assert ':9: origin: ' in run('trace', written(GOOD.replace('thickness: 5', 'origin: [0, 1]')), exit=BAD_INPUT).stderr
    for text, word in (('{type: sphere, radius: 51,68}', 'decimal point'), ('{type: sphere, radius: 2mm}', 'without its unit'), ('{type: sphere, radius: "2"}', 'without quotes'),
                       ('{type: torus, major: 3, minor: -1}', 'minor: must be above 0, not -1'), ('sphere', '{type: sphere, radius: 20}'), ('a:\n\tb: 1', 'not by tabs')):
        assert word in run('intersect', '--surface', text, *RAY, exit=BAD_INPUT).stderr, text
    said = run('trace', written(GOOD.replace('[0.5, 0.6]', '[500, 0.6]')))
    assert ':3: wavelengths: taken as 500 micrometres; for 500 nanometres write 0.5' in said.stderr, said.stderr
    for wrong in ('tilt: 45', 'tilt: [1, 2]'):
        assert ':8: tilt: must be three numbers' in run('trace', written(GOOD.replace('index: 1.5', wrong, 1)), exit=BAD_INPUT).stderr
    ended = run('trace', lens, '--rays', '-', stdin=rays((0, 0, -5, 0, 0, 1, 0, 1), header='ox,oy,oz,dx,dy,dz,tmin,tmax'))
    assert 'tmin' in ended.stderr and 'not used' in ended.stderr, ended.stderr
    for command in ('trace', 'intersect', 'diagnose'):
        equal(run(command, '-h').stdout, run(command, '--help').stdout)


def test_how_many_rays():
    done = run('diagnose', written(GOOD), '--ray', '99', exit=USAGE)
    assert 'there are 5' in done.stderr, done.stderr


def test_help_and_version():
    header = pathlib.Path(__file__).parents[2] / 'include' / 'sagitta' / 'sagitta.h'
    numbers = re.findall(r'^#define SGT_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)$', header.read_text(), re.MULTILINE)
    equal(run('--version').stdout, f"sagitta {'.'.join(numbers)}\n")
    assert 'docs/lens_file.md' in run('trace', '--help').stdout
    for command in ('intersect', 'trace', 'diagnose'):
        equal(run(command, '--version').stdout, run('--version').stdout)
        text = run(command, '--help', 'all').stdout
        for option in ('--format', '--output', '--help', '--version', '--dt-min', '--max-evals', 'Exit status'):
            assert option in text, (command, option)
        assert max(map(len, text.splitlines())) <= 100


COMMANDS = commands()


def test_help_in_one_screen():
    """Its options are those of --help all, by the same words, and its examples run."""
    root = pathlib.Path(__file__).parents[2]
    for command in COMMANDS:
        short, whole = run(command, '--help').stdout, run(command, '--help', 'all').stdout
        assert len(short.splitlines()) <= 40 and len(short) < len(whole), command
        assert max(map(len, (short + whole).splitlines())) <= 100, command
        options = [line for line in short.splitlines() if line.startswith('  --')]
        assert (3 if command == 'join' else 5) <= len(options) <= 12, (command, options)
        for line in options:
            assert line[:60] in whole, (command, line)
        names = [line.split()[0] for line in whole.splitlines() if line.startswith('  --')]
        equal(len(set(names) - {'--output'}), len(names) - names.count('--output'), (command, names))
        for name in ('--output', '--quiet', '--help', '--version'):
            assert name in names, (command, name)
        assert f'sagitta {command} --help all' in short and 'Exit status' in whole, command
        examples = re.findall(r'^  sagitta (.*)$', short[short.index('Examples'):short.index('\nMore')], re.MULTILINE)
        assert len(examples) >= 2, command
        for line in examples if SCALE >= 0.1 else examples[:1]:
            if 'trade' not in line and 'FILE' not in line and 'triplet.zmx' not in line and '--picture' not in line:
                few = ['--boxes', '2000'] if line.startswith('prove') else []  # a tenth, which none of them asks for
                subprocess.run([SAGITTA, *shlex.split(line), *few], cwd=root, check=True, capture_output=True,
                               timeout=100)


def test_old_spellings():
    """Each is refused, and the new one is told."""
    lens = written(GOOD)
    for new, *arguments in (('--picture FILE', 'trace', lens, '--svg', 'a.svg'), ('--picture FILE', 'trade', '--svg', 'a.svg'),
                            ('--grid N', 'trace', lens, '--pattern', 'grid'), ('--grid', 'spot', lens, '--rays-across', '9'),
                            ('--fields all', 'trace', lens, '--field', 'all')):
        done = run(*arguments, exit=USAGE)
        assert ' is now ' in done.stderr and new in done.stderr and not done.stdout, (arguments, done.stderr)


# ------------------------------------------------------------ long and deep input

DEEP = [('{a: ', 1), ('{a:\n', 65), ('[', 1), ('- ', 1), ('? ', 1), ('[{a: ', 1), ('surfaces: [{type: sum, terms: [', 1)]


def test_nesting():
    """Refused while it is read: what is made of it, and the time, would grow with the square of the depth."""
    for text, line in DEEP:
        path = written(text * 200000)
        done = run('trace', path, exit=BAD_INPUT)
        equal(done.stderr, f'sagitta: {path}:{line}: lists and maps nested more than 64 deep\n', text)
    done = run('intersect', '--surface', '{a: ' * 1000, *RAY, exit=BAD_INPUT)
    assert '--surface:1: lists and maps nested' in done.stderr, done.stderr
    path = written('surfaces: ' + '[' * 62 + ']' * 62)
    assert 'must be a map' in run('trace', path, exit=BAD_INPUT).stderr  # 63 deep with the file's own map


def spent(*arguments):
    """(seconds of the processor, bytes at most) of a run in one thread, whatever it says."""
    child = subprocess.Popen([SAGITTA, *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, _, usage = os.wait4(child.pid, 0)
    child.returncode = 0
    return usage.ru_utime + usage.ru_stime, 1024 * usage.ru_maxrss


def joined(item, n):
    return ''.join(item.format(i) for i in range(n))


PUPIL = 'pupil: {semi_diameter: 1}\n'
# A text with n of something; the bytes that each may take (before this was made linear a plane took 22,000).
LONG = {
    'surfaces': (lambda n: PUPIL + 'surfaces:\n' + joined('  - {{type: plane, thickness: 1}}\n', n), 800),
    'surfaces in blocks': (lambda n: PUPIL + 'surfaces:\n' + joined('  - type: plane\n    thickness: 1\n', n), 800),
    'fields': (lambda n: PUPIL + 'fields: [' + joined('{0}e-6, ', n) + '0]\nsurfaces: [{type: plane}]\n', 10000),
    'keys': (lambda n: '{' + joined('k{0}: 1, ', n) + 'a: 1}', 3000),
    'keys of a surface': (lambda n: 'surfaces:\n  - {type: plane, ' + joined('k{0}: 1, ', n) + 'a: 1}', 3000),
    'coefficients': (lambda n: 'surfaces: [{type: zernike, coefficients: [' + joined('{0}, ', n) + '1]}]', 3000),
    'anchors': (lambda n: 'a: [' + joined('&x{0} {0}, ', n) + '1]', 3000),
    'anchors and aliases': (lambda n: 'a: [' + joined('&x{0} {0}, ', n) + joined('*x{0}, ', n) + '1]', 3000),
    'aliases of one list': (lambda n: 'a: &x [1, 2]\nb: [' + joined('*x, ', n) + '1]', 3000),
    'directives': (lambda n: joined('%TAG !a{0}! x\n', n) + '---\na: 1\n', 3000),
    'long key': (lambda n: 'a' * 50 * n + ': 1', 3000),
    'long text': (lambda n: 'name: "' + 'a\\n' * 20 * n + '"', 3000),
    'comments': (lambda n: '# a comment\n' * n + 'a: 1', 3000),
}


def test_time_and_memory_grow_with_the_length():
    """Four times the length: not more than eight times the time (16 times would be the square), and a few bytes for each."""
    kept = b'__asan_init' in pathlib.Path(SAGITTA).read_bytes()  # with memory that no program would take
    for what, (text, most) in LONG.items():
        (seconds, few), (more_seconds, many) = (spent('trace', written(text(n)), '--grid', 1, '--format', 'csv', '--threads', 1) for n in (10000, 40000))
        assert more_seconds < 8 * seconds + 0.3, f'{what}: {seconds} s, of four times the length {more_seconds} s'
        assert (many - few) / 30000 < most * (12 if kept else 1), f'{what}: {few} bytes, of four times the length {many}'


# --------------------------------------------------------------- output that is not written

LENS = 'pupil: {semi_diameter: 1}\nsurfaces:\n  - {type: sphere, radius: 10, thickness: 1, index: 1.5}\n  - {type: plane}\n'


def ended(arguments, how):
    """The status and the words of a run whose standard output is a full device or closed."""
    path = {'full': ' >/dev/full', 'closed': ' >&-'}[how]
    done = subprocess.run(['sh', '-c', f'"$0" "$@" {path}', SAGITTA, *map(str, arguments)], stderr=subprocess.PIPE, text=True, timeout=100)
    return done.returncode, done.stderr


# What people ask for by other names, and what the answer has to name.  LENS: that of GOOD; SURFACE=...: a ray at that surface.
NAMED = [
    ('surfaces by other names', [(('SURFACE={type: %s}' % name,), BAD_INPUT, words) for name, words in (
        ('spherical', 'write sphere'), ('Asphere', 'write even_asphere'), ('mirror', 'mirror: true'), ('wgs84', '{type: geodetic_height}'),
        ('paraxial', 'type: ideal'), ('gyroid', 'type: formula'), ('STANDARD', 'sphere, or conic'), ('sphare', 'did you mean sphere?'))]),
    ('keys by other names', [(('SURFACE={type: conic, %s: 1}' % key,), BAD_INPUT, f'did you mean {meant}?') for key, meant in (
        ('diameter', 'semi_diameter'), ('r', 'radius'), ('k', 'conic'), ('ROC', 'radius'))]),
    ('keys of a lens', [(('trace', ('index: 1.5', 'n: 1.5')), BAD_INPUT, 'did you mean index?'),
                        (('trace', ('pupil: {semi_diameter: 1}', 'aperture: 2')), BAD_INPUT, 'did you mean pupil?'),
                        (('trace', ('index: 1.5', 'index: BK7')), BAD_INPUT, 'a glass by its name is `glass`'),
                        (('trace', ('index: 1.5', 'index: 1x')), BAD_INPUT, 'must be a number, not "1x"')]),
    ('paths', [(('edit', 'LENS', '--set', 'surface[1].radius=3'), BAD_INPUT, 'did you mean surfaces?'),
               (('edit', 'LENS', '--set', 'zebra[1].radius=3'), BAD_INPUT, 'zebra is not given\n')]),
    ('units', [(('trace', 'LENS', '--wavelength', '550'), USAGE, 'write micrometres, with a point: 0.5500'),
               (('trace', 'LENS', '--wavelength', '3'), USAGE, 'has 2 wavelengths\n')]),
    ('options', [(('spot', 'LENS', '--plot', 'a.svg'), USAGE, 'Did you mean --picture?'), (('trace', 'LENS', '--csv'), USAGE, 'Did you mean --format csv?'),
                 (('edit', 'LENS', '--thickness', '3'), USAGE, 'Did you mean --set surfaces[N].thickness=VALUE?'), (('trace', 'LENS', '--zebra'), USAGE, "'--zebra'\nTry:")]),
    ('places', [(('intersect', '--surface', '{type: sphere, radius: 1}', '--from', '1 2 3', '--look', '1 2'), USAGE, '{type: geodetic_height}'),
                (('intersect', '--surface', '{type: plane}', '--rays', 'X,oy'), BAD_INPUT, 'did you mean ox?'),
                (('intersect', '--surface', '{type: plane}', '--rays', '# mine'), BAD_INPUT, 'comments are not read')]),
    ('tolerances', [(('tolerance', 'LENS'), BAD_INPUT, 'tolerances: [{surface: 1, radius: 0.02}]')]),
]


def test_what_is_meant_is_named():
    lens = written(GOOD)
    for what, asked in NAMED:
        for arguments, status, words in asked:
            if arguments[0].startswith('SURFACE='):
                arguments = ('intersect', '--surface', arguments[0][8:], *RAY)
            arguments = [written(GOOD.replace(*a, 1)) if isinstance(a, tuple) else lens if a == 'LENS' else a for a in arguments]
            if '--rays' in arguments:
                arguments[-1] = written(arguments[-1] + '\n', 'rays.csv')
            said = run(*arguments, exit=status).stderr
            assert words in said, f'{what}: {arguments}: {said}'


def test_the_tolerances_that_are_named_are_read():
    said = run('tolerance', written(GOOD), exit=BAD_INPUT).stderr
    run('tolerance', written(GOOD + re.search(r'tolerances: \[.*?\]', said)[0]))


def test_columns_of_places():
    if 'geoid' not in run('intersect', '--surface', '{type: zebra}', *RAY, exit=BAD_INPUT).stderr.split('there are:')[1]:
        return  # built without GeographicLib
    for name, meant in (('latitude', 'lat'), ('Lat', 'lat'), ('altitude', 'height'), ('azimuth', 'az')):
        said = run('intersect', '--surface', '{type: geodetic_height}', '--rays', written(f'{name},lon\n', 'rays.csv'), exit=BAD_INPUT).stderr
        assert f'did you mean {meant}?' in said and 'lat, lon, height, az, el' in said, said


def test_other_programs_files_are_not_written():
    """A lens file under another program's name; and edit -o of the file that it read would lose it."""
    lens = written(GOOD)
    for name in ('a.zmx', 'A.SEQ', 'a.len'):
        for arguments in (('edit', lens, '-o'), ('import', lens, '-o'), ('tolerance', lens, '--trials', 2, '--worst')):
            path = lens.parent / name
            path.write_text('kept')
            said = run(*arguments, path, exit=USAGE).stderr
            assert 'end the name in .yaml' in said, said
            equal(path.read_text(), 'kept', (name, arguments))


def test_oslo():
    for name in ('a.len', 'a.txt', 'a.seq'):
        said = run('spot', written('// OSLO 6.1    40190     0 46208\nLEN NEW "x" 100.6 11\n', name), exit=BAD_INPUT).stderr
        assert 'an OSLO file is not read' in said, said


def test_chief_ray_that_fails():
    """The command that shows why runs, of a field by number and by angle."""
    lens = written(GOOD.replace('fields: [0]', 'fields: [0, 80]').replace('radius: 10', 'radius: 10, semi_diameter: 1'))
    for more in ((), ('--field', '80')):
        said = run('spot', lens, *more).stderr
        [line] = re.findall(r'^sagitta: sagitta (diagnose .*) shows why$', said, re.MULTILINE)
        assert 'clipped' in run(*shlex.split(line)).stdout or 'missed' in run(*shlex.split(line)).stdout, line


def test_legend_of_the_columns_shown():
    whole = run('intersect', '--surface', '{type: plane}', *RAY).stdout
    assert "t, t_err: in lengths of the ray's direction.  x y z: the point" in whole and 'evals: ' in whole, whole
    some = run('intersect', '--surface', '{type: plane}', *RAY, '--columns', 'status,nx').stdout
    assert 'nx ny nz: ' in some and 't, t_err' not in some and 'evals' not in some, some
    assert 'sampling: ' in run('spot', written(GOOD)).stdout


def test_no_such_command():
    """The next command is named: that which is a letter away, or what a lens file comes behind."""
    for word, said in (('tarce', 'did you mean sagitta trace?'), ('spo', 'did you mean sagitta spot?'),
                       ('lens.yaml', 'sagitta trace lens.yaml'), ('layout', 'it is: sagitta trace LENS --picture lens.svg'),
                       ('seidel', 'it is: sagitta info LENS --seidel'), ('render', 'sagitta --help lists them')):
        done = run(word, exit=USAGE)
        assert said in done.stderr, (word, done.stderr)


def test_no_such_option():
    """So is the option that is a letter away."""
    lens = 'examples/lenses/cooke_triplet.yaml'
    for option, said in (('--feild', 'Did you mean --field?  Try: sagitta spot --help'), ('--grd=3', 'Did you mean --grid?'),
                         ('--turbo', 'Try: sagitta spot --help')):
        done = run('spot', lens, option, exit=USAGE)
        assert said in done.stderr and ('Did' in done.stderr) == ('Did' in said), (option, done.stderr)


def test_output_that_cannot_be_written():
    """Of every command each output: an error, with a message and a status."""
    if not os.path.exists('/dev/full'):
        return
    lens, surface = written(LENS), ('--surface', '{type: plane}', *RAY)
    words = [[command, option] for command in ((), 'intersect', 'trace', 'diagnose', 'trade') for option in ('--help', '--version', '-h')
             if command or option != '-h']
    words = [[w for w in line if w] for line in words] + [['-h'], ['help']]
    data = [[*line, '--format', form] for form in ('text', 'csv', 'json')
            for line in (['intersect', *surface], ['intersect', *surface, '--all'], ['trace', lens], ['diagnose', *surface], ['diagnose', lens])]
    data.append(['trade', *surface, '--max-evals', '100', '--seconds', '0', '--format', 'csv'])
    for line in words + data:
        for how in ('full', 'closed'):
            equal(ended(line, how), (BAD_INPUT, 'sagitta: standard output: could not be written\n'), f'{line}, {how}')
    for line in data:
        done = run(*line, '--output', '/dev/full', exit=BAD_INPUT)
        assert done.stderr.endswith('/dev/full: could not be written\n'), (line, done.stderr)


def test_what_is_closed_is_not_written_into():
    """With standard error closed a note must not be written into the file that --output opens."""
    lens, out = written(LENS), written('', 'out.csv')
    read = ('trace', lens, '--dt-min', 1, '--format', 'csv')  # says that --dt-min is not used
    for closed in ('2>&-', '>&- 2>&-', '<&- >&- 2>&-'):
        subprocess.run(['sh', '-c', f'"$0" "$@" {closed}', SAGITTA, *map(str, read), '--output', str(out)], check=True, timeout=100)
        equal(out.read_text(), run(*read).stdout, closed)


main(globals())
