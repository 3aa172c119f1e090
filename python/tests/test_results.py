# SPDX-License-Identifier: MIT
"""Results by names, by rays, in any shape; as tables of pandas and xarray; surfaces by value."""
import importlib.util
import inspect
import itertools
import math
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
from bits import rays, same

import sagitta
from sagitta import Crossings, Element, Function, Hits, Lens, Plane, Traced
from sagitta.surface import BUILTINS, CLASSES, ROWS, params_of

BALL = sagitta.Sphere(10)
RING = sagitta.Torus(2, 0.5)
SHAPE = (4, 5)


def lens():
    rear = Element(sagitta.Conic(-40, -1), index=1, thickness=60)
    return Lens([Element(BALL, index=1.5, thickness=5), rear, Element(Plane())], pupil={"semi_diameter": 2})


def numbers(result):
    return {name: np.asarray(a) for name, a in result.items() if isinstance(a, np.ndarray)}


def flat(name, a, shape, turned):
    """An array of rays of a shape as that of rays in a row, (..., n)."""
    a = np.moveaxis(a, -1, 0) if turned and a.ndim > len(shape) else a
    assert a.shape[a.ndim - len(shape) :] == shape, name
    return a.reshape(*a.shape[: a.ndim - len(shape)], -1)


# -------------------------------------------------------------------------- shapes


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("shape", [(4, 5), (1, 1), (2, 3, 4), (5, 3), (3, 5), (3, 3), (0, 4), (7,), (1,)])
def test_any_shape_is_the_row_of_its_rays(rng, shape, turned):
    n = math.prod(shape)
    o, d = rays(rng, n, 8.0)
    axis = -1 if turned else 0
    shaped = [a.reshape(3, *shape) for a in (o, d)]
    if turned:
        shaped = [np.moveaxis(a, 0, -1).copy() for a in shaped]
    far = rng.uniform(5, 40, shape)
    answers = (
        lambda o, d, far, axis: BALL.intersect(o, d, tmax=far, axis=axis, proof="root"),
        lambda o, d, far, axis: BALL.intersect(o, d, axis=axis, threads=2),
        lambda o, d, far, axis: lens().trace(o, d, axis=axis),
        lambda o, d, far, axis: lens().trace(o, d, axis=axis, passages=True).passages[1],
        lambda o, d, far, axis: lens().trace(o, d, axis=axis, passages=("p", "opl", "direction")).passages[2],
        lambda o, d, far, axis: RING.leave(RING.intersect(o, d, axis=axis), d),
    )
    for answer in answers:
        got, want = answer(*shaped, far, axis), answer(o, d, far.reshape(-1), 0)
        assert got.shape == shape and len(got) == got.size == n
        for name in want.keys():
            assert same(flat(name, got[name], shape, turned), want[name]), name
        table = got.table()
        assert table.shape == shape
        assert all(same(table[name].reshape(a.T.shape), a.T) for name, a in want.items())
    # Prepared, and written to room of the shape.
    room = Hits.empty(shape)
    call = BALL.prepare(*shaped, axis=axis, out=room)
    want = BALL.intersect(o, d, axis=0)
    assert call() == want.met.sum() and same(room.p, want.p.reshape(3, *shape))
    # Derivatives and roots.
    hits = BALL.intersect(*shaped, axis=axis)
    change = BALL.differentiate(*shaped, hits, axis=axis)
    want = BALL.differentiate(o, d, BALL.intersect(o, d, axis=0), axis=0)
    for name in ("t_by_o", "p_by_a", "n_by_o"):
        assert change[name].shape == (*want[name].shape[:-1], *shape)
        assert same(change[name].reshape(want[name].shape), want[name])
    assert same(RING.intersect_all(*shaped, axis=axis).count.reshape(-1), RING.intersect_all(o, d, axis=0).count)
    there, row = lens().sensitivity(*shaped, axis=axis), lens().sensitivity(o, d, axis=0)
    assert there.value.shape == (2, *shape) and there.gradient.shape[: len(shape)] == shape
    assert same(there.by(1, "curvature").reshape(2, n), row.by(1, "curvature")) and there.fate.shape == shape
    aimed = lens().aim(1, shaped[0][..., :2].T * 0.1 if turned else shaped[0][:2] * 0.1,
                       sagitta.Beam(o=(0, 0, -20), d=(0, 0, 1), ou=(1, 0, 0), ov=(0, 1, 0)))
    assert aimed.u.shape == aimed.o.shape[1:] == (shape[::-1] if turned else shape)


def test_columns_with_memory_of_their_own(rng, monkeypatch):
    """As with very many rays."""
    o, d = (a.reshape(3, *SHAPE) for a in rays(rng, 20, 8.0))
    want, through = BALL.intersect(o, d), lens().trace(o, d, passages=True)
    for module in ("_arrays", "results", "surface", "lens"):
        monkeypatch.setattr(sys.modules[f"sagitta.{module}"], "LARGE", 10)
    got = BALL.intersect(o, d)
    assert got._block is None and got == want and got.shape == SHAPE
    for passages in (True, tuple(sagitta.Passage.FIELDS)):
        assert lens().trace(o, d, passages=passages) == through


def test_shapes_are_broadcast(rng):
    x, y = rng.uniform(-9, 9, (4, 1)), rng.uniform(-9, 9, 5)
    hits = BALL.intersect((x, y, -20.0), (0, 0, 1))
    full = np.array([*np.broadcast_arrays(x, y), np.full(SHAPE, -20.0)])
    want = BALL.intersect(full, (0, 0, 1))
    assert hits == want and hits.shape == SHAPE
    d = np.array([[0.0, 0.1], [0, 0], [1, 1]])
    two = BALL.intersect(full[..., None], d)
    assert two.shape == (4, 5, 2) and same(two.t[..., 0], want.t)
    ends = BALL.intersect(full, (0, 0, 1), tmax=np.linspace(1, 30, 5))
    assert same(ends.t[:, 4], want.t[:, 4]) and not ends.met[:, 0].any()
    left = RING.leave(RING.intersect((-5.0, 0, 0), (1, 0, 0)), full - full[:, :1, :1] + 1)
    assert left.shape == SHAPE
    spread = RING.leave(RING.intersect([[-5.0], [0], [0]], [[1.0], [0], [0]]), full)
    assert spread.shape == (4, 5) and same(spread.status[2, 3], RING.leave(
        RING.intersect((-5.0, 0, 0), (1, 0, 0)), full[:, 2, 3]).status[0])


@pytest.mark.parametrize(
    "o, more, says",
    [
        (np.zeros((3, 4, 3)), {}, r"o: \(3, 4, 3\) can be read with x, y, z along its first axis or its last"),
        (np.zeros((2, 3, 4)), {}, r"o: has the shape \(2, 3, 4\)"),
        (np.zeros((3, 4, 5)), {"axis": 1}, "axis: of o with 3 axes it must be 0 or -1, not 1"),
        (np.zeros((3, 4, 5)), {"axis": -1}, r"axis=-1 says that it is \(\.\.\., 3\)"),
        (np.zeros((3, 4, 5)), {"axis": 0.5}, "axis"),
        (np.zeros((3, 4, 5)), {"tmax": np.ones((5, 4))}, r"o \(4, 5\), tmax \(5, 4\)"),
        (np.zeros((3, 4, 5)), {"out": Hits.empty(20)}, r"out has the shape \(20,\); that of the rays is \(4, 5\)"),
        (np.zeros((3, 20)), {"out": Hits.empty((4, 5))}, r"out has the shape \(4, 5\)"),
    ],
)
def test_shapes_that_are_refused(o, more, says):
    with pytest.raises(ValueError, match=says):
        BALL.intersect(o, (0, 0, 1), **more)


def test_room_of_any_shape(rng):
    o, d = (a.reshape(3, *SHAPE) for a in rays(rng, 20))
    want = BALL.intersect(o, d)
    t, p = np.zeros(SHAPE), np.zeros((3, *SHAPE))
    BALL.intersect(o, d, out=Hits(t=t, p=p))
    assert same(t, want.t) and same(p, want.p)
    strips = np.zeros((3, 2, *SHAPE))[:, 0]
    BALL.intersect(o, d, out=Hits(p=strips))
    assert same(strips, want.p)
    with pytest.raises(ValueError, match="contiguous along the axes of the rays"):
        Hits(t=np.zeros((5, 4)).T)
    with pytest.raises(ValueError, match=r"p has room for \(5, 4\) rays, the arrays before it for \(4, 5\)"):
        Hits(t=t, p=np.zeros((3, 5, 4)))
    with pytest.raises(ValueError, match="whole number"):
        Hits.empty((4, -1))
    room = Traced.empty(SHAPE, passages=3, of_passages=("p",))
    lens().trace(o, d, out=room)
    assert same(room.passages[2].p, lens().trace(o, d, passages=True).passages[2].p)


OPTIONS = {"pick", "proof", "t_tol", "f_tol", "dt_min", "max_evals"}


@pytest.mark.parametrize(
    "call, lacks",
    [(BALL.intersect, ()), (BALL.prepare, ()), (BALL.leave, ("pick",)), (BALL.intersect_all, ("pick",)),
     (BALL.diagnose, ()), (lens().trace, ()), (lens().prepare, ()), (lens().spot, ("f_tol",))],
)
def test_options_are_in_signatures_and_have_no_others(call, lacks, rng):
    assert OPTIONS & set(inspect.signature(call).parameters) == OPTIONS - set(lacks)
    hits, d = BALL.intersect(*rays(rng, 4)), rays(rng, 4)[1]
    given = {"leave": (hits, d), "diagnose": ((0, 0, -9), (0, 0, 1)), "spot": ()}.get(call.__name__, (d, d))
    for name in ("colour", *lacks):
        with pytest.raises(TypeError, match=f"no (option|setting) '{name}'"):
            call(*given, **{name: "red"})


# ------------------------------------------------------------------ names and rays


def results(rng, shape=(6,)):
    o, d = (a.reshape(3, *shape) for a in rays(rng, math.prod(shape), 4.0))
    met = RING.intersect(o, d)
    traced = lens().trace(o, d, passages=True)
    return {"hits": met, "crossings": RING.leave(met, d), "traced": traced, "passage": traced.passages[1]}


@pytest.mark.parametrize("of", ["hits", "crossings", "traced", "passage"])
def test_names(rng, of):
    result = results(rng)[of]
    assert result.keys() == tuple(type(result).FIELDS) and list(dict(result)) == list(result.keys())
    for name, a in result.items():
        assert result[name] is a is getattr(result, name) and name in result
    assert "colour" not in result and len(result.values()) == len(result.keys())
    with pytest.raises(KeyError, match="colour: there are"):
        result["colour"]


@pytest.mark.parametrize("shape", [(6,), SHAPE])
@pytest.mark.parametrize("of", ["hits", "crossings", "traced", "passage"])
def test_rays_one_by_one(rng, of, shape):
    result = results(rng, shape)[of]
    every = list(result)
    assert len(every) == len(result) == result.size
    for k, at in enumerate(np.ndindex(*shape)):
        one = result[at if len(at) > 1 else at[0]]
        assert one == every[k]
        for name in result.keys():
            assert same(getattr(one, name), result[name][(..., *at)]), name
    if of == "hits":
        assert isinstance(every[0], sagitta.Hit) and every[0].met == result.met.flat[0]
        assert math.isnan(every[0].lo)
        assert BALL.intersect((0, 0, -20), (0, 0, 1)) != BALL.intersect((0, 1, -20), (0, 0, 1))
    with pytest.raises(IndexError):
        result[99] if len(shape) == 1 else result[0, 99]
    with pytest.raises(IndexError, match="2 axes" if len(shape) == 2 else "out of bounds"):
        result[0] if len(shape) == 2 else result[-99]


@pytest.mark.parametrize("of", ["hits", "crossings", "traced", "passage"])
@pytest.mark.parametrize("turned", [False, True])
def test_some_of_the_rays(rng, of, turned):
    result = results(rng, SHAPE)[of]
    mask = np.arange(20).reshape(SHAPE) % 3 == 0
    for key in (slice(1, 3), (0, ...), (..., 2), mask, [2, 0], (slice(None, None, -1), 1)):
        some = result[key]
        assert type(some) is type(result)
        for name in result.keys():
            a = result[name]
            want = a[(slice(None), *(key if isinstance(key, tuple) else (key,)))] if a.ndim > 2 else a[key]
            assert same(some[name], want), name
        if of == "traced":
            assert some.passages[1] == result.passages[1][key]


def test_a_hit_of_what_was_not_asked_for(rng):
    o, d = rays(rng, 4)
    some = BALL.intersect(o, d, out=Hits.empty(4, "status", "t"))
    assert some[0].evals == -1 and math.isnan(some[0].t_err) and np.isnan(some[0].p).all()
    with pytest.raises(ValueError, match="a Hit has a status, which was not asked for; there are t"):
        list(BALL.intersect(o, d, out=Hits.empty(4, "t")))
    end = lens().trace(o, d, out=Traced.empty(4, "opl"))[1]
    assert end.fate is None and not end.through and np.isnan(end.o).all() and end.opl > 0
    assert next(iter(RING.leave(RING.intersect((-5, 0, 0), (1, 0, 0)), (1, 0, 0)))).side == -1


@pytest.mark.parametrize("of", ["hits", "crossings", "traced", "passage"])
def test_results_by_value(rng, of):
    result = results(rng)[of]
    again = pickle.loads(pickle.dumps(result))
    assert again == result and not again != result
    again[again.keys()[0]][..., 0] += 1
    assert again != result and result != result[:3] and result != 1
    shaped = results(rng, (2, 4))[of]
    assert pickle.loads(pickle.dumps(shaped)) == shaped and shaped[...] == shaped
    with pytest.raises(TypeError):
        hash(result)


def test_results_of_lenses_by_value(rng):
    a, b = lens(), lens()
    points = np.array([[0.0, 0.1], [0, 0.2]])
    beam = sagitta.Beam(o=(0, 0, -20), d=(0, 0, 1), ou=(1, 0, 0), ov=(0, 1, 0))
    for ask in (
        lambda of: of.first_order(), lambda of: of.seidel(), lambda of: of.launch(), lambda of: of.parabasal(),
        lambda of: of.aim(1, points, beam), lambda of: of.spot(), lambda of: of.remarks,
        lambda of: BALL.intersect_all([[0, 9], [0, 9], [-20, -20]], (0, 0, 1)),
        lambda of: RING.check((0.3, 1.2, -5), (0.1, 0.2, 1), tmax=20),
    ):
        assert ask(a) == ask(b)
    assert a.launch(rays=3) != a.launch(rays=4) and a.first_order() != sagitta.Lens([Element(BALL)]).first_order()
    first = a.first_order()
    assert dict(first)["efl"] == first["efl"] == first.efl and "efl" in first
    spot = a.spot()
    assert spot["rms"] is not None and same(spot["rms"], spot.rms) and dict(spot).keys() == set(spot.keys())
    assert len(spot[:1]) == 1 and spot[0]["rms"] == spot.rms[0]
    with pytest.raises(KeyError, match="there are field"):
        spot["colour"]


# ----------------------------------------------------------------- pandas and xarray


def needs(name):
    if importlib.util.find_spec(name) is None:
        pytest.skip(f"{name} is not installed (on Debian: apt-get install python3-{name})")


@pytest.mark.parametrize("shape", [(8,), (2, 4)])
@pytest.mark.parametrize("of", ["hits", "crossings", "traced", "passage"])
def test_pandas(rng, of, shape):
    needs("pandas")
    result = results(rng, shape)[of]
    frame = result.to_pandas() if len(shape) == 1 else result.to_pandas(dims=("row", "column"))
    assert len(frame) == 8 and list(frame.index.names) == (["ray"] if len(shape) == 1 else ["row", "column"])
    for name, a in result.items():
        if a.ndim == len(shape):
            assert same(frame[name], a.reshape(-1)) and frame[name].dtype == a.dtype
        else:
            assert all(same(frame[f"{name}_{c}"], a[k].reshape(-1)) for k, c in enumerate("xyz"))
    frame.iloc[0, 0] = 7
    assert result[result.keys()[0]].flat[0] != 7  # a copy


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("shape", [(8,), (2, 4)])
def test_xarray(rng, shape, turned):
    needs("xarray")
    o, d = (np.moveaxis(a.reshape(3, *shape), 0, -1 if turned else 0) for a in rays(rng, 8))
    hits = BALL.intersect(o, d, axis=-1 if turned else 0)
    data = hits.to_xarray() if len(shape) == 1 else hits.to_xarray(dims=("y_in", "x_in"))
    axes = ("ray",) if len(shape) == 1 else ("y_in", "x_in")
    assert data["t"].dims == axes and data["p"].dims == ("xyz", *axes)
    assert list(data["xyz"].values) == ["x", "y", "z"]
    p = np.moveaxis(hits.p, -1, 0) if turned else hits.p
    assert same(data["p"].sel(xyz="y"), p[1]) and same(data["t"], hits.t) and set(data) == set(hits.keys())
    for dims in ("xyz", ("a", "a"), ("a", "b", "c")):
        with pytest.raises(ValueError, match="different names of axes"):
            hits.to_xarray(dims=dims)


def test_tables_of_what_a_lens_answers(rng):
    needs("pandas"), needs("xarray")
    of = lens()
    spot = of.spot()
    frame, data = spot.to_pandas(), spot.to_xarray()
    assert list(frame.columns) == list(spot.keys()) and same(frame["rms"], spot.rms) and frame.index.name == "row"
    assert same(data["rms"], spot.rms) and "field" in data.coords and data["rms"].dims == ("row",)
    named = sagitta.Lens.text("{pupil: {semi_diameter: 2}, units: mm, surfaces: [{type: plane}]}").spot()
    assert named.to_xarray()["rms"].attrs == {"units": "mm"} and named.to_pandas().attrs["units"]["rms"] == "mm"
    launched = of.launch(rays=2)
    assert {"px", "o_x", "wanted_y"} <= set(launched.to_pandas().columns)
    assert launched.to_xarray()["o"].dims == ("xyz", "ray")
    assert launched.to_xarray()["wanted"].dims == ("xy", "ray")
    there = of.sensitivity(launched, of=("x", "y")).to_xarray()
    assert there["gradient"].sel(of="y", parameter="0.curvature").shape == (len(launched),)
    o, d = rays(rng, 4)
    change = BALL.differentiate(o, d, BALL.intersect(o, d)).to_xarray()
    assert change["p_by_a"].dims == ("xyz", "parameter", "ray")
    assert list(change["parameter"].values) == ["curvature", "conic"]
    every = RING.intersect_all(o, d)
    assert len(every.to_pandas()) == len(every.table) and sum(len(e) for e in every) == len(every.table)
    assert all(same(a["t"], every.of(k)["t"]) for k, a in enumerate(every)) and len(list(every)) == 4
    assert list(RING.intersect_all(np.zeros((3, 0)), (0, 0, 1))) == []
    assert of.seidel().to_pandas().index.name == "element"
    aimed = of.aim(1, np.zeros((2, 3)), sagitta.Beam(o=(0, 0, -20), d=(0, 0, 1), ou=(1, 0, 0), ov=(0, 1, 0)))
    assert aimed.to_xarray()["o"].dims == ("xyz", "ray")


@pytest.mark.parametrize("name", ["pandas", "xarray"])
def test_without_pandas_and_xarray(rng, name, monkeypatch):
    monkeypatch.setitem(sys.modules, name, None)  # as if it were not installed
    hits = BALL.intersect(*rays(rng, 4))
    with pytest.raises(ImportError, match=f"to_{name}.. needs {name}, which is not installed: pip install"):
        getattr(hits, f"to_{name}")()


def test_nothing_is_imported_but_when_it_is_called():
    code = "import sagitta, sys; assert not {'pandas', 'xarray', 'matplotlib'} & set(sys.modules)"
    environment = {**os.environ, "PYTHONPATH": ":".join(sys.path)}
    subprocess.run([sys.executable, "-c", code], check=True, env=environment)


# ------------------------------------------------------------------------ surfaces


@pytest.mark.parametrize("of", sorted(BUILTINS))
def test_parameters_are_attributes_and_arguments(of):
    surface, names = CLASSES[of].specimen(), [p.name.decode() for p in params_of(ROWS[of])]
    names += [name.replace("curvature", "radius") for name in names if name.startswith("curvature")]
    assert set(names) == set(inspect.signature(CLASSES[of]).parameters) and set(names) <= set(dir(surface))
    assert all(hasattr(surface, name) for name in names if name != "slice")


def test_the_obvious_by_place():
    for short, long in (
        (sagitta.Sphere(50), sagitta.Sphere(radius=50)),
        (sagitta.Conic(50, -1), sagitta.Conic(radius=50, conic=-1)),
        (sagitta.Cylinder(50, -1), sagitta.Cylinder(radius=50, conic=-1)),
        (sagitta.EvenAsphere(50, -1, [1e-4]), sagitta.EvenAsphere(radius=50, conic=-1, coefficients=[1e-4])),
        (sagitta.OddAsphere(50, -1, [0, 1e-4]), sagitta.OddAsphere(radius=50, conic=-1, coefficients=[0, 1e-4])),
        (sagitta.Torus(2, 1), sagitta.Torus(major=2, minor=1)),
        (sagitta.Ellipsoid(2, 0.1), sagitta.Ellipsoid(a=2, f=0.1)),
    ):
        assert short == long and repr(short) == repr(long)
    with pytest.raises(TypeError, match="positional"):
        sagitta.Sphere(50, -1)
    assert "a" in dir(sagitta.Formula("x - a", a=1))


def functions():
    def f(x, y, z):
        return z

    return [Function(f), Function(f, inside=3), Function(f, rounding=1e-9), Function(lambda x, y, z: z)]


def test_surfaces_by_value():
    """Equal surfaces have one hash and meet rays alike; all others differ."""
    kinds = [
        *([CLASSES[of].specimen() for _ in range(2)] for of in sorted(BUILTINS) if of not in ("conic",)),
        [sagitta.Conic(50), sagitta.Conic(radius=50.0, conic=0), sagitta.Conic(curvature=0.02, conic=-0.0),
         sagitta.Conic(50, semi_diameter=0)],
        [sagitta.Conic(50, -1)] * 2,
        [sagitta.Conic(50, semi_diameter=3), sagitta.Conic(40, semi_diameter=3).replace(radius=50)],
        [sagitta.EvenAsphere(50, 0, [0, 1e-6]), sagitta.EvenAsphere(50, coefficients=(0, 1e-6, 0))],
        [sagitta.Sum(radius=50, terms=[sagitta.EvenAsphere(20)]),
         sagitta.Sum(curvature=0.02, terms=(sagitta.EvenAsphere(curvature=0.05),))],
        [sagitta.Formula("x - a", a=1), sagitta.Formula("x - a", a=1.0)],
        [sagitta.Formula("x - a", a=1, inside=((-1, -1, -1), (1, 1, 1))),
         sagitta.Formula("x - a", a=1, inside={"box": np.array([[-1, -1, -1], [1, 1, 1]])})],
        [sagitta.Formula("x - a", a=2)],
        [sagitta.Sag("r^2/a", a=1)], [sagitta.Sag("r^2/a", a=1, semi_diameter=2)],
        *([f] for f in functions()),
    ]
    for one in kinds:
        for a, b in itertools.product(one, one):
            assert a == b and hash(a) == hash(b) and not a != b
    for one, other in itertools.combinations(kinds, 2):
        assert all(a != b for a, b in itertools.product(one, other)), (one, other)
    table = {surface: repr(surface) for one in kinds for surface in one}
    assert len(table) == len(kinds)
    f = functions()[0]
    assert f == Function(f.values) and hash(f) == hash(Function(f.values)) and f != 1 and BALL != 1


def test_written_surfaces_do_not_change():
    for surface in (sagitta.Formula("x - a", a=1), sagitta.Sag("r^2/a", a=1)):
        for name in ("a", "formula", "colour"):
            with pytest.raises(AttributeError, match="does not change"):
                setattr(surface, name, 2)


# ------------------------------------------------------------- sag, normal and value


@pytest.mark.parametrize("of", sorted(BUILTINS))
def test_value_and_normal(of, rng):
    """F vanishes where rays meet it, its normal is the gradient there, and differences say the same."""
    surface = CLASSES[of].specimen()
    o, d = rays(rng, 200, 1.5)
    hits = surface.intersect(o, d)
    hits = hits[hits.status == 1]
    assert len(hits) > 20
    length = np.sqrt((hits.n**2).sum(axis=0))
    good = np.isfinite(length) & (length > 1e-9)
    f, n = surface.value(*hits.p), surface.normal(*hits.p)
    assert (np.abs(f) <= (hits.p_err + 1e-12) * length * 10 + 1e-12)[good].all()
    assert np.allclose(n[:, good], (hits.n / length)[:, good], rtol=1e-12, atol=1e-12)
    if of in ("julia", "mandelbrot"):
        return  # F is not smooth enough for differences
    h, found = 1e-6, np.empty_like(n)
    for k, e in enumerate(np.eye(3)[:, :, None] * h):
        found[k] = (surface.value(*(hits.p + e)) - surface.value(*(hits.p - e))) / (2 * h)
    good &= np.isfinite(found).all(axis=0)
    assert good.sum() > 10
    found, want = found[:, good], (n * length)[:, good]
    assert np.allclose(found, want, rtol=1e-4, atol=1e-5 * np.abs(found).max())


def test_value_of_functions_and_formulas(rng):
    def f(x, y, z):
        return x * y - z

    p = rng.uniform(-3, 3, (3, 10, 20))
    for surface in (Function(f), sagitta.Formula("x*y - z")):
        assert np.allclose(surface.value(*p), f(*p), atol=1e-14) and surface.value(1, 2, 3) == -1
        want = np.array([p[1], p[0], -np.ones_like(p[0])])
        assert np.allclose(surface.normal(*p), want / np.sqrt((want**2).sum(axis=0)), atol=1e-8)
    many = rng.uniform(-3, 3, (3, 20000))
    assert same(Function(f).value(*many), f(*many))
    with pytest.raises(RuntimeError, match="no such place"):
        Function(lambda x, y, z: (_ for _ in ()).throw(RuntimeError("no such place"))).value(0, 0, 0)


def test_normal_of_a_sag(rng):
    x, y = rng.uniform(-6, 6, (2, 30))
    n = BALL.normal(x, y)
    assert np.allclose(n, np.array([-x, -y, 10 - BALL.sag(x, y)]) / 10, atol=1e-14)
    assert np.allclose(n, BALL.normal(x, y, BALL.sag(x, y)))
    assert BALL.normal(0, 0).shape == (3,) and BALL.normal([[0, 1]], 0).shape == (3, 1, 2)
    assert np.isnan(BALL.normal(11, 0)).all() and np.isnan(RING.normal(0, 0)).all()
    assert np.isnan(RING.normal(0, 0, 0)).sum() in (0, 3) and BALL.value([], 0, 0).shape == (0,)
    with pytest.raises(TypeError, match="x: must be real numbers"):
        BALL.value("a", 0, 0)
    with pytest.raises(TypeError, match="functions of Python"):
        Function(lambda x, y, z: z).normal(0, 0)
