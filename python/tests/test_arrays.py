# SPDX-License-Identifier: MIT
"""Shapes, types and memory: what is taken, what is copied, what is refused and how that is said."""
import math
import pickle
import threading

import numpy as np
import pytest
from bits import rays, same

import sagitta
from sagitta import Hits, Traced
from sagitta._arrays import RayArrays, address

BALL = sagitta.Sphere(radius=10)


def test_what_is_no_copy(rng):
    o, d = rays(rng, 100)
    for a in (o, o[:, 10:90], o.T.copy(order="F"), o.T):
        kept = RayArrays(a, d[:, : max(a.shape)]).o
        assert [address(x) for x in kept] == [address(x) for x in (a if a.shape[0] == 3 else a.T)]
    three = (o[0], o[1], o[2])
    assert [address(x) for x in RayArrays(three, d).o] == [address(x) for x in three]


def test_all_shapes_say_the_same(rng):
    o, d = rays(rng, 100)
    want = BALL.intersect(o, d)
    wide = np.zeros((6, 200))
    wide[::2, ::2] = o
    for a in (
        o.tolist(),
        o.T.copy(),
        o.T,
        np.asfortranarray(o),
        wide[::2, ::2],
        o.astype(">f8"),
        tuple(o),
        list(o),
    ):
        got = BALL.intersect(a, d)
        assert same(got.t, want.t) and same(got._rows["p"], want._rows["p"])
    by_rows = BALL.intersect(o.T.copy(), d.T.copy())
    assert by_rows.p.shape == by_rows.n.shape == (100, 3) and same(by_rows.p, want.p.T)
    assert same(BALL.intersect(o.astype("f4"), d).t, BALL.intersect(o.astype("f4").astype("f8"), d).t)
    assert same(BALL.intersect(tuple(o[:, 0]), tuple(d[:, 0])).t, BALL.intersect(o[:, 0], d[:, 0].tolist()).t)


def test_one_vector_for_all(rng):
    o, d = rays(rng, 50)
    assert same(BALL.intersect(o, (0, 0, 1)).t, BALL.intersect(o, np.tile([[0.0], [0], [1]], 50)).t)
    assert same(BALL.intersect((0, 0, -20), d).t, BALL.intersect(np.tile([[0.0], [0], [-20]], 50), d).t)


def test_ends():
    o, d = np.tile([[0.0], [0], [-20]], 4), (0, 0, 1)
    said = BALL.intersect(o, d, tmin=[0, 25, -math.inf, 0], tmax=[10, 50, 50, 50]).status.tolist()
    assert said == [0, 0, 1, 1]
    assert (
        BALL.intersect((0, 0, -20), d, tmin=25).text == BALL.intersect((0, 0, -20), d, tmax=10).text == "miss"
    )


def test_three_by_three_is_refused():
    o = np.array([[0.0, 0, 0], [0, 1, 2], [-20, -20, -20]])
    with pytest.raises(ValueError, match="axis=0"):
        BALL.intersect(o, (0, 0, 1))
    columns, by_rows = BALL.intersect(o, (0, 0, 1), axis=0), BALL.intersect(o.T, (0, 0, 1), axis=1)
    assert same(columns.t, by_rows.t) and same(columns.p, by_rows.p.T)
    assert columns.t[0] != columns.t[2]


@pytest.mark.parametrize(
    "o, d, more, error, says",
    [
        ((0, 0), (0, 0, 1), {}, ValueError, "o: has the shape (2,)"),
        (np.zeros((3, 4)), np.zeros((3, 5)), {}, ValueError, "o 4, d 5"),
        (np.zeros((3, 4)), (0, 0, 1), {"tmin": [0, 0]}, ValueError, "tmin 2"),
        (np.zeros((2, 4)), (0, 0, 1), {}, ValueError, "o: has the shape (2, 4)"),
        (np.zeros((3, 4)), (0, 0, 1), {"axis": 1}, ValueError, "axis=1"),
        (np.zeros((3, 4)), (0, 0, 1), {"axis": 2}, ValueError, "axis"),
        (np.zeros((3, 4), complex), (0, 0, 1), {}, TypeError, "o: must be real numbers, not complex128"),
        (("a", "b", "c"), (0, 0, 1), {}, TypeError, "o: must be real numbers"),
        ((None, 0, 0), (0, 0, 1), {}, TypeError, "o: must be real numbers"),
        ((np.zeros(3), np.zeros(3), np.zeros(4)), (0, 0, 1), {}, ValueError, "x, y and z"),
        (
            (0, 0, 0),
            (0, 0, 1),
            {"pick": "last"},
            ValueError,
            "pick: must be one of 'default', 'first', 'near-seed'",
        ),
        ((0, 0, 0), (0, 0, 1), {"proof": 1}, ValueError, "proof"),
        ((0, 0, 0), (0, 0, 1), {"proof": []}, TypeError, "neither"),
        ((0, 0, 0), (0, 0, 1), {"t_tol": math.nan}, ValueError, "t_tol"),
        ((0, 0, 0), (0, 0, 1), {"t_tol": -1}, ValueError, "t_tol"),
        ((0, 0, 0), (0, 0, 1), {"t_tol": "x"}, TypeError, "t_tol"),
        ((0, 0, 0), (0, 0, 1), {"max_evals": 1.5}, TypeError, "max_evals"),
        (np.zeros((3, 4)), (0, 0, 1), {"threads": 0}, ValueError, "threads"),
        (np.zeros((3, 4)), (0, 0, 1), {"threads": 1.5}, TypeError, "threads"),
        (np.zeros((3, 4)), (0, 0, 1), {"threads": 2000}, ValueError, "threads"),
        (np.zeros((3, 4)), (0, 0, 1), {"out": {}}, TypeError, "out: must be Hits"),
        (
            np.zeros((3, 4)),
            (0, 0, 1),
            {"out": Hits.empty(5)},
            ValueError,
            "out has room for 5 rays; there are 4",
        ),
    ],
)
def test_bad_calls(o, d, more, error, says):
    with pytest.raises(error) as raised:
        BALL.intersect(o, d, **more)
    assert says in str(raised.value)


def test_read_only_outputs():
    frozen = np.zeros(4)
    frozen.flags.writeable = False
    with pytest.raises(ValueError, match="out: t is read-only"):
        Hits(t=frozen)
    out = Hits(t=np.zeros(4))
    out.t.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        BALL.intersect(np.zeros((3, 4)), (0, 0, 1), out=out)


@pytest.mark.parametrize(
    "arrays, error, says",
    [
        (dict(t=np.zeros(4, "f4")), TypeError, "out: t must be float64, not float32"),
        (dict(t=[0, 0]), TypeError, "out: t must be an array of numpy"),
        (dict(p=np.zeros((4, 3))), ValueError, "out: p has the shape (4, 3); it must be (3, n)"),
        (dict(t=np.zeros(8)[::2]), ValueError, "contiguous"),
        (dict(t=np.zeros(4), p=np.zeros((3, 5))), ValueError, "room for 5 rays"),
        (dict(q=np.zeros(4)), ValueError, "Hits has no 'q'"),
        ({}, ValueError, "at least one"),
    ],
)
def test_bad_outputs(arrays, error, says):
    with pytest.raises(error) as raised:
        Hits(**arrays)
    assert says in str(raised.value)


@pytest.mark.parametrize("n", [-1, 1.5, "3"])
def test_room_for_how_many(n):
    with pytest.raises(ValueError, match="whole number"):
        Hits.empty(n)


def test_outputs_may_not_overlap(rng):
    o, d = rays(rng, 50)
    for out in (Hits(t=o[0]), Hits(p=d)):
        with pytest.raises(ValueError, match="overlaps the rays"):
            BALL.intersect(o, d, out=out)
    a = np.zeros((3, 50))
    with pytest.raises(ValueError, match="another array"):
        BALL.intersect(o, d, out=Hits(p=a, t=a[1]))


def test_outputs_are_written_in_place(rng):
    o, d = rays(rng, 1000)
    want = BALL.intersect(o, d)
    t, p = np.full(1000, 7.0), np.zeros((3, 2000))[:, 500:1500]
    out = Hits(t=t, p=p)
    assert BALL.intersect(o, d, out=out) is out and same(t, want.t) and same(p, want.p)
    with pytest.raises(AttributeError, match="was not asked for"):
        out.status
    some = BALL.intersect(o, d, out=Hits.empty(1000, "status", "t"))
    assert same(some.t, want.t) and list(some._rows) == ["status", "t"]
    table = want.table()
    assert table.dtype.names == tuple(Hits.FIELDS) and same(table["p"], want.p.T) and same(table["t"], want.t)


def test_prepared_calls(rng):
    o, d = rays(rng, 1000)
    call = BALL.prepare(o, d)
    assert call() == (BALL.intersect(o, d).status > 0).sum()
    o[1] += 0.5
    call()
    assert same(call.out.t, BALL.intersect(o, d).t)
    assert BALL.prepare(o, d, threads=2)() == call()


def test_no_rays():
    assert len(BALL.intersect(np.zeros((3, 0)), (0, 0, 1))) == 0
    assert len(BALL.intersect_all(np.zeros((3, 0)), (0, 0, 1)).table) == 0
    assert len(BALL.intersect(np.zeros((3, 0)), (0, 0, 1), threads=4).table()) == 0


def test_rays_that_make_no_sense_are_told_by_status():
    hits = BALL.intersect(
        [[0, math.nan, 0, 0], [0, 0, 0, 0], [-20] * 4], [[0, 0, 0, 0], [0] * 4, [1, 1, 0, 1]]
    )
    assert hits.status.tolist() == [1, -5, -5, 1] and hits.met.tolist() == [True, False, False, True]
    assert BALL.intersect((0, 0, 0), (0, 0, 0)).text == "invalid"
    with pytest.raises(ValueError, match="ray 0 makes no sense"):
        BALL.intersect_all((0, 0, 0), (0, 0, 0))


def test_a_million_rays_in_two_threads(rng):
    o, d = rays(rng, 10**6)
    one, two = BALL.intersect(o, d), BALL.intersect(o, d, threads=2)
    for name in Hits.FIELDS:
        assert same(one._rows[name], two._rows[name])
    lens = sagitta.Lens([sagitta.Element(BALL, index=1.5, thickness=5), sagitta.Element(sagitta.Plane())])
    a, b = lens.trace(o, d), lens.trace(o, d, threads=2)
    for name in Traced.FIELDS:
        assert same(a._rows[name], b._rows[name])


def test_other_threads_run_meanwhile(rng):
    """The lock of the interpreter is released: this thread goes on while another one is in the library."""
    o, d = rays(rng, 2 * 10**6)
    torus = sagitta.Torus(major=2, minor=1)
    began, ended, count = threading.Event(), threading.Event(), 0

    def work():
        began.set()
        torus.intersect(o, d)
        ended.set()

    thread = threading.Thread(target=work)
    thread.start()
    began.wait()
    while not ended.wait(0.001):
        count += 1
    thread.join()
    assert count > 5


def test_results_from_a_pickle(rng):
    o, d = rays(rng, 20)
    lens = sagitta.Lens([sagitta.Element(BALL, index=1.5, thickness=5), sagitta.Element(sagitta.Plane())])
    for result in (BALL.intersect(o.T.copy(), d), lens.trace(o, d, passages=True)):
        again = pickle.loads(pickle.dumps(result))
        assert type(again) is type(result) and again._axis == result._axis
        assert all(same(again._rows[k], result._rows[k]) for k in result._rows)
    assert same(again.passages[1].direction, result.passages[1].direction)
    hit = BALL.intersect((0, 0, -20), (0, 0, 1))
    assert bytes(pickle.loads(pickle.dumps(hit))) == bytes(hit)
