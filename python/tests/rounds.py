# SPDX-License-Identifier: MIT
"""Rounds of making and dropping: of test_leaks.py and valgrind.py."""
import pickle

import numpy as np

import sagitta
from sagitta import Element, Lens, Plane, Sphere

O, D = np.array([[0.0, 1], [0, 1], [-5, -5]]), (0, 0, 1)


def surfaces():
    for s in (
        sagitta.Conic(radius=50, conic=-1),
        sagitta.Zernike(norm=4, order="noll", coefficients=[0.1, 0.2]),
        sagitta.Sum(terms=[sagitta.EvenAsphere(coefficients=[0, 1e-6])]),
    ):
        s.intersect(O, D)
        s.intersect((0, 1, -5), D)
        s.intersect_all(O, D)
        s.normal(O[0], O[1])
        s.value(*O)
        list(s.intersect(O.reshape(3, 1, 2), D)[..., 0])
        {s: s.replace(), s.replace(): s}


def functions():
    s = sagitta.Function(lambda x, y, z: (z - 0.1 * x, -0.1 + 0 * x, 0 * x, 1 + 0 * x), inside=20)
    s.intersect((0, 1, -5), D)
    s.prepare(O, D)()
    s.value(*O)


def raising():
    s = sagitta.Function(lambda x, y, z: 1 / 0)
    try:
        s.intersect((0, 1, -5), D)
    except ZeroDivisionError:
        pass


def formulas():
    sagitta.Formula("x^4 + y^4 + z^4 = a", a=16, inside=5).intersect((0, 1, -5), D)
    try:
        sagitta.Formula("x^4 + ) = a", a=16)
    except sagitta.FormulaError:
        pass


def lenses():
    lens = Lens(
        [Element(Sphere(radius=50), index=1.5, thickness=5, semi_diameter=5, stop=True), Element(Plane())],
        pupil={"semi_diameter": 4},
    )
    lens.trace(O, D, passages=True)
    lens.trace(np.tile(O, 2), np.tile(O, 2), passages=True).passages[1].t_err
    lens.trace(O, D, passages=("p", "opl")).passages[0].p
    lens.prepare(O, D, passages="t")()
    lens.sensitivity(O, D)
    lens.spot(1, pattern="fan", rays=3)
    lens.first_order()
    try:
        Lens([Element(Sphere(radius=50), index=-1)])
    except sagitta.LensError:
        pass


def pickles():
    pickle.loads(pickle.dumps(sagitta.Conic(radius=50).intersect(O, D)))
    pickle.loads(pickle.dumps(sagitta.Zernike(norm=4, order="noll", coefficients=[0.1, 0.2])))


def parts():
    lens = Lens([Element(Sphere(radius=50), index=1.5, thickness=99), Element(Plane())], pupil={"semi_diameter": 4})
    found = [lens.part("spot", k, 2, rays=3) for k in (2, 1)]
    sagitta.join(found)
    sums = sagitta.SpotSums().add(O[0], O[1])
    (sums + pickle.loads(pickle.dumps(sums))).spot()
    try:
        sagitta.join(found[:1])
    except ValueError:
        pass


ROUNDS = {f.__name__: f for f in (surfaces, functions, raising, formulas, lenses, pickles, parts)}


def one_round(which):
    ROUNDS[which]()
