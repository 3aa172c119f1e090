# SPDX-License-Identifier: MIT
"""Formulas as text."""
import pickle

import numpy as np
import pytest
from bits import rays, same

import sagitta
from sagitta import Formula, FormulaError, Sag

TORUS = "(x^2 + y^2 + z^2 + R^2 - s^2)^2 = 4*R^2*(x^2 + y^2)"


def test_as_the_library_s_own(rng):
    o, d = rays(rng, 2000)
    mine = Formula(TORUS, R=2, s=0.5, inside=2.6).intersect(o, d)
    theirs = sagitta.Torus(major=2, minor=0.5).intersect(o, d)
    both = (mine.status == 1) & (theirs.status == 1)
    assert both.sum() > 300 and (np.abs(mine.t - theirs.t) <= mine.t_err + theirs.t_err)[both].all()
    assert not ((mine.status == 0) & (theirs.status == 1)).any()


def test_proofs_and_derivatives(rng):
    o, d = rays(rng, 300, 1.5, 0.1)
    sphere = Formula("x^2 + y^2 + z^2 = a", a=9.0, inside=4)
    proven = sphere.intersect(o, d, proof="first")
    assert (proven.status == 1).sum() > 200
    hits = sphere.intersect(o, d)
    by_a = sphere.differentiate(o, d, hits).t_by_a[0]
    h = 1e-5
    pair = [sphere.replace(a=9 + x).intersect(o, d).t for x in (h, -h)]
    good = hits.status == 1
    assert np.allclose(((pair[0] - pair[1]) / (2 * h))[good], by_a[good], rtol=1e-6)
    assert sphere.parameters == ("a",) and sphere.a == 9 and sphere.check(o[:, :10], d[:, :10], tmax=18).sound


def test_a_sag_is_a_sag(rng):
    o, d = rays(rng, 300)
    mine = Sag("c*r^2/(1 + sqrt(1 - (1+k)*c^2*r^2))", c=0.1, k=-0.6, semi_diameter=4).intersect(
        o, d, pick="near-seed"
    )
    theirs = sagitta.Conic(curvature=0.1, conic=-0.6, semi_diameter=4).intersect(o, d, pick="near-seed")
    both = (mine.status == 1) & (theirs.status == 1)
    assert both.sum() > 150 and (np.abs(mine.t - theirs.t) <= mine.t_err + theirs.t_err)[both].all()


def test_pickle(rng):
    o, d = rays(rng, 50)
    for surface in (Formula(TORUS, R=2, s=0.5, inside=((-3, -3, -1), (3, 3, 1))), Sag("0.1*r^2*k", k=1)):
        other = pickle.loads(pickle.dumps(surface))
        assert other == surface and repr(other) == repr(surface)
        assert same(other.intersect(o, d).t, surface.intersect(o, d).t)


def test_the_command_reads_what_python_writes(command):
    import json
    import subprocess

    surface = Formula(TORUS, R=2, s=0.5, inside=2.6)
    said = subprocess.run(
        [
            command,
            "intersect",
            "--surface",
            json.dumps(surface._yaml()),
            "--ray",
            "2 0 -5 0 0 1",
            "--format",
            "json",
        ],
        capture_output=True,
        text=True,
    )
    assert said.returncode == 0, said.stderr
    assert surface.intersect((2, 0, -5), (0, 0, 1)).t in [
        row.get("t") for row in _rows(json.loads(said.stdout))
    ]


def _rows(x):
    if isinstance(x, dict):
        yield x
    for v in x.values() if isinstance(x, dict) else x if isinstance(x, list) else ():
        yield from _rows(v)


@pytest.mark.parametrize(
    "make, says, column",
    [
        (lambda: Formula("x^2 + ) = 1"), "^", 7),
        (lambda: Formula("x^2 + q"), "q", 7),
        (lambda: Sag("x + z"), "z", 5),
        (lambda: Formula("x", a=float("nan")), "", 0),
        (lambda: Formula(""), "", None),
    ],
)
def test_bad_formulas(make, says, column):
    with pytest.raises(FormulaError) as error:
        make()
    assert says in str(error.value) and (column is None or error.value.column == column), str(error.value)
    assert pickle.loads(pickle.dumps(error.value)).column == error.value.column


def test_bad_arguments():
    for make in (
        lambda: Formula(3),
        lambda: Formula("x", a="b"),
        lambda: Formula("x", inside=0),
        lambda: Sag("x", semi_diameter=-1),
        lambda: Formula("a*x", a=[1, 2]),
    ):
        with pytest.raises((TypeError, ValueError)):
            make()
    with pytest.raises(AttributeError):
        Formula("a*x", a=1).b
