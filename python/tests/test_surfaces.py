# SPDX-License-Identifier: MIT
"""Every type of the catalogue: its class is the library's table, and its answers are the command's, bit for
bit."""
import csv
import io
import json
import math
import pickle
import subprocess

import numpy as np
import pytest
from bits import rays, same

import sagitta
from sagitta.surface import BUILTINS, CLASSES

TYPES = sorted(BUILTINS)


def test_a_class_for_each_type():
    assert set(CLASSES) == set(BUILTINS)


@pytest.mark.parametrize("of", TYPES)
def test_as_the_command(of, command, rng, tmp_path):
    surface = CLASSES[of].specimen()
    o, d = rays(rng, 200, 1.5 if CLASSES[of].__name__ in ("Julia", "Mandelbrot") else 3.0)
    np.save(tmp_path / "rays.npy", np.ascontiguousarray(np.vstack([o, d]).T))
    said = subprocess.run(
        [
            command,
            "intersect",
            "--surface",
            json.dumps(surface._yaml()),
            "--rays",
            str(tmp_path / "rays.npy"),
            "--format",
            "npy",
            "--output",
            str(tmp_path / "out.npy"),
        ],
        capture_output=True,
        text=True,
    )
    assert said.returncode == 0, said.stderr
    theirs, mine = np.load(tmp_path / "out.npy"), surface.intersect(o, d)
    assert (mine.status == theirs["status"]).all() and (mine.evals == theirs["evals"]).all()
    for name, a in (
        ("t", mine.t),
        ("t_err", mine.t_err),
        ("x", mine.p[0]),
        ("y", mine.p[1]),
        ("z", mine.p[2]),
    ):
        assert same(a, theirs[name]), name
    assert (mine.status > 0).sum() > 20


def test_csv_of_the_command_has_these_bits(command, tmp_path):
    """By text too: what csv prints reads back as the same double."""
    (tmp_path / "r.csv").write_text("ox,oy,oz,dx,dy,dz\n0.1,3,-5,0,0.1,1\n")
    said = subprocess.run(
        [
            command,
            "intersect",
            "--surface",
            "{type: conic, radius: 50, conic: -1}",
            "--rays",
            str(tmp_path / "r.csv"),
            "--format",
            "csv",
        ],
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    row = next(csv.DictReader(io.StringIO(said)))
    assert float(row["t"]) == sagitta.Conic(radius=50, conic=-1).intersect((0.1, 3, -5), (0, 0.1, 1)).t


@pytest.mark.parametrize("of", TYPES)
def test_one_is_many(of, rng):
    surface = CLASSES[of].specimen()
    o, d = rays(rng, 50)
    for pick in (None, "first", "near-seed"):
        many = surface.intersect(o, d, pick=pick)
        for i in range(50):
            one = surface.intersect(tuple(o[:, i]), tuple(d[:, i]), pick=pick)
            assert (one.status, one.evals) == (many.status[i], many.evals[i])
            assert same(
                [one.t, one.t_err, one.t_lo, one.p_err],
                [many.t[i], many.t_err[i], many.t_lo[i], many.p_err[i]],
            )
            assert same(one.p, many.p[:, i]) and same(one.n, many.n[:, i])


@pytest.mark.parametrize("of", TYPES)
def test_again_from_a_pickle(of, rng):
    surface = CLASSES[of].specimen()
    other = pickle.loads(pickle.dumps(surface))
    assert other == surface and repr(other) == repr(surface) and surface.replace() == surface
    o, d = rays(rng, 100)
    a, b = surface.intersect(o, d), pickle.loads(pickle.dumps(other.intersect(o, d)))
    assert all(same(a._rows[name], b._rows[name]) for name in a._rows)


@pytest.mark.parametrize("of", TYPES)
def test_all_hits_begin_with_the_first(of, rng):
    surface = CLASSES[of].specimen()
    o, d = rays(rng, 60)
    first, every = surface.intersect(o, d, pick="first"), surface.intersect_all(o, d)
    for i in range(60):
        entries = every.of(i)
        assert (np.diff(entries["t"]) >= 0).all() and (entries["ray"] == i).all()
        if first.status[i] > 0:
            assert abs(entries["t"][0] - first.t[i]) <= entries["t_err"][0] + first.t_err[i]
        elif first.status[i] == 0:
            assert len(entries) == 0


@pytest.mark.parametrize("of", TYPES)
def test_sag(of, rng):
    surface = CLASSES[of].specimen()
    x, y = rng.uniform(-2, 2, (2, 5, 20))
    z = surface.sag(x, y)
    assert z.shape == x.shape
    if of in ("ellipsoid", "torus", "quadric", "julia", "mandelbrot"):
        assert np.isnan(z).all()
        return
    assert np.isfinite(z).mean() > 0.5
    for i in np.argwhere(np.isfinite(z)):  # the line through the point, from far below, meets it there
        a, b = x[tuple(i)], y[tuple(i)]
        hit = surface.intersect((a, b, -1000), (0, 0, 1), pick="near-seed")
        assert abs(hit.p[2] - z[tuple(i)]) <= hit.t_err + 1e-14
    assert surface.sag(x[0, 0], y[0, 0]) == z[0, 0] and type(surface.sag(0, 0)) is float


def test_sag_of_a_sphere(rng):
    x, y = rng.uniform(-9, 9, 50), 2.5
    square = x**2 + y**2
    with np.errstate(invalid="ignore"):
        z = square / (10 + np.sqrt(100 - square))
    np.testing.assert_allclose(sagitta.Sphere(radius=10).sag(x, y), z, rtol=1e-14)
    assert np.isnan(sagitta.Sphere(radius=10).sag([np.nan, np.inf, 0], [0, 0, 10.1])).all()
    assert sagitta.Plane().sag([], []).shape == (0,)
    with pytest.raises(TypeError, match="functions of Python"):
        sagitta.Function(lambda x, y, z: (z, 0 * x, 0 * y, 0 * z + 1)).sag(0, 0)


@pytest.mark.parametrize("of", [t for t in TYPES if t not in ("julia", "mandelbrot")])
def test_derivatives_by_differences(of, rng):
    """Each derivative against a difference of two answers: another origin, another number."""
    surface = CLASSES[of].specimen()
    o, d = rays(rng, 60, 1.5)
    hits = surface.intersect(o, d, pick="near-seed")
    slope = np.abs((hits.n * d).sum(axis=0)) / np.linalg.norm(hits.n, axis=0)
    good = (hits.status == 1) & (slope > 0.3)
    assert good.sum() > 15
    change, names = surface.differentiate(o, d, hits), surface.parameters
    assert change.parameters == names and len(set(names)) == len(names)
    compared = 0

    def agree(there, back, said, h):
        both = good & (there.status == 1) & (back.status == 1)
        assert both.sum() > 10
        found = (there.t - back.t)[both] / (2 * h)
        assert np.allclose(found, said[both], rtol=1e-5, atol=2e-5 * max(1, np.abs(found).max()))

    for j in range(3):
        e = np.zeros((3, 1))
        e[j] = h = 1e-6
        agree(
            surface.intersect(o + e, d, pick="near-seed"),
            surface.intersect(o - e, d, pick="near-seed"),
            change.t_by_o[j],
            h,
        )
    for name in [*names[:4], *names[-2:]]:
        base, _, rest = name.partition("[")
        if base == "terms":
            continue
        at, pair = tuple(int(k.rstrip("]")) for k in rest.split("[")) if rest else (), []
        said = change.t_by_a[names.index(name)]
        h = 1e-6 / max(1, np.abs(said[good]).max())
        for sign in (1, -1):
            try:
                value = np.array(getattr(surface, base), float)
            except AttributeError:
                break  # a plane has the parameters of a conic, and cannot be given them
            if at and max(at) >= len(value):
                value = np.concatenate([value, np.zeros(max(at) + 1 - len(value))])
            value[at] += sign * h
            pair.append(
                surface.replace(**{base: value if at else float(value)}).intersect(o, d, pick="near-seed")
            )
        if pair:
            agree(*pair, said, h)
            compared += 1
    assert compared or of == "plane"


def test_radius_is_a_curvature():
    assert sagitta.Conic(radius=50).curvature == 1 / 50
    assert sagitta.Conic(curvature=0.02).radius == 50
    assert sagitta.Sphere(radius=math.inf).curvature == 0 and sagitta.Sphere().radius == math.inf
    assert sagitta.Biconic(radius_x=20).curvature_x == 0.05
    assert sagitta.Conic(radius=50).replace(radius=25).curvature == 0.04


@pytest.mark.parametrize(
    "make, says",
    [
        (lambda: sagitta.Conic(radius=math.nan), "NaN"),
        (lambda: sagitta.Conic(curvature=math.nan), "curvature must be finite, not nan"),
        (lambda: sagitta.Conic(radius=0), "zero"),
        (lambda: sagitta.Conic(radius=1e-310), "too small"),
        (lambda: sagitta.Conic(radius=1, curvature=1), "give one of the two"),
        (lambda: sagitta.Conic(semi_diameter=-1), "semi_diameter must be"),
        (lambda: sagitta.Conic(conic="flat"), "conic: must be real numbers"),
        (lambda: sagitta.Conic(conic=[1, 2]), "conic must be a number"),
        (lambda: sagitta.EvenAsphere(coefficients=[0] * 9), "up to 8"),
        (lambda: sagitta.EvenAsphere(coefficients=[0, math.inf]), "coefficients must be finite, not inf"),
        (lambda: sagitta.Zernike(norm=1, order="nol", coefficients=[1]), "one of noll, fringe"),
        (lambda: sagitta.Zernike(order="noll", coefficients=[1]), "norm"),
        (lambda: sagitta.Grid(step_x=1, step_y=1, sag=[[1, 2], [3, 4]]), "sag"),
        (lambda: sagitta.Julia(iterations=1.5), "whole number"),
        (lambda: sagitta.Julia(c=[1, 2]), "4 numbers"),
        (lambda: sagitta.Sum(terms=[1]), "surfaces of the catalogue"),
        (lambda: sagitta.Torus(major=1), "minor"),
        (lambda: sagitta.Quadric(), "quadric"),
    ],
)
def test_bad_parameters(make, says):
    with pytest.raises((ValueError, TypeError)) as error:
        make()
    assert says in str(error.value)


def test_surfaces_do_not_change():
    ball = sagitta.Sphere(radius=1)
    with pytest.raises(AttributeError, match="replace"):
        ball.radius = 2
    with pytest.raises(AttributeError, match="no parameter 'conic'"):
        ball.conic
    with pytest.raises(ValueError):
        sagitta.EvenAsphere(coefficients=[1, 2]).coefficients[0] = 3
    assert ball != sagitta.Sphere(radius=2) and ball == sagitta.Sphere(radius=1.0)
    assert hash(ball) == hash(sagitta.Sphere(1.0)) != hash(sagitta.Sphere(2))


def test_a_diagnosis():
    found = sagitta.Torus(major=2, minor=1).diagnose((0.3, 1.2, -5), (0.1, 0.2, 1))
    assert found.hit.status == 1 and len(found.steps) == found.hit.evals
    assert (found.steps["eval"] == np.arange(1, len(found.steps) + 1)).all()
    assert found.newton + found.bisect + found.march + found.retreat <= len(found.steps)
    assert found.text
    steps = sagitta.Torus(major=2, minor=1).diagnose((0.3, 1.2, -5), (0.1, 0.2, 1)).steps
    at = steps[steps["kind"] == 0]
    assert (at["f_lo"] == at["f"]).all() and (at["slope_hi"] == at["slope"]).all()
    cells = sagitta.Formula("x^4 + y^4 + z^4 = 4").diagnose((0.3, 1.2, -5), (0.1, 0.2, 1)).steps
    cells = cells[cells["kind"] == 1]
    assert len(cells) and np.isnan(cells["f"]).all() and (cells["f_lo"] <= cells["f_hi"]).all()
    # a cubic seen from its turning point: the words are those of the command
    far = sagitta.Formula("z^3 - z - 1").diagnose((0, 0, 0.55), (0, 0, 1))
    assert far.before >= 0 and (far.verdict == sagitta.Verdict.LATE) == far.text.startswith("wandering at first")


def test_check_is_sound(rng):
    for of in TYPES:
        said = CLASSES[of].specimen().check(*rays(rng, 20), tmax=20)
        assert said.sound, (of, said)
