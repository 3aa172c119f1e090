# SPDX-License-Identifier: MIT
"""Surface.leave(): rays that start at hits, against every root of their lines; shapes, threads, what is refused."""
import pickle

import numpy as np
import pytest
from bits import rays, same

import sagitta
from sagitta import Crossings, Status

RING = sagitta.Torus(major=2, minor=0.5)


def hits_of(rng, n=400):
    o, d = rays(rng, n, 2.0)
    hits = RING.intersect(o, d)
    met = hits.status == Status.HIT
    assert met.sum() > 50
    o, d = np.ascontiguousarray(o[:, met]), np.ascontiguousarray(d[:, met])
    return RING.intersect(o, d), o, d


def test_the_next_of_all_roots(rng):
    hits, o, d = hits_of(rng)
    every = RING.intersect_all(o, d)
    after = RING.leave(hits, d)
    steep = np.abs((hits.n * d).sum(0)) > 1e-3 * np.linalg.norm(hits.n, axis=0) * np.linalg.norm(d, axis=0)
    assert steep.sum() > 50
    for i in np.flatnonzero(steep):
        roots = every.of(i)["t"]
        assert (after.status[i] > 0) == (len(roots) > 1)
        assert after.side[i] == -1  # it went in
        if len(roots) > 1:
            assert abs(hits.t[i] + after.t[i] - roots[1]) < 1e-9
    out = RING.leave(after, d)
    there = after.status == Status.HIT
    assert (out.status[~there] == Status.INVALID).all()  # no hit, no start
    assert (out.side[there & steep] == 1).all()


def test_shapes_and_threads_say_the_same(rng):
    hits, _, d = hits_of(rng)
    want = RING.leave(hits, d)
    names = tuple(Crossings.FIELDS)
    room = Crossings.empty(len(want))
    assert RING.leave(hits, d, out=room) is room
    rows = RING.leave(RING.intersect(hits.p.T - d.T, d.T.copy()), d.T.copy())
    assert rows.p.shape == (len(want), 3)
    for other in (RING.leave(hits, d, threads=3), room, RING.leave(hits, d, tmax=np.inf),
                  pickle.loads(pickle.dumps(want))):
        for name in names:
            assert same(getattr(other, name), getattr(want, name)), name
    for i in (0, 7):
        one = RING.leave(RING.intersect(hits.p[:, i] - d[:, i], d[:, i]), d[:, i])
        assert len(one) == 1 and one.side[0] in (-1, 0, 1)
    some = RING.leave(hits, (0, 0, 1), out=Crossings.empty(len(want), "status", "side"))
    assert repr(some).endswith("status, side>")
    fan = RING.leave(RING.intersect((-5, 0, 0), (1, 0, 0)), rays(rng, 9)[1])
    assert len(fan) == 9
    plain = RING.intersect(hits.p - d, d, out=sagitta.Hits.empty(len(want), "p", "p_err"))
    assert (RING.leave(plain, d).status >= Status.UNPROVEN).all()


def test_ends(rng):
    hit = RING.intersect((-5, 0, 0), (1, 0, 0))
    assert RING.leave(hit, (1, 0, 0)).t == pytest.approx(1)
    assert RING.leave(hit, (1, 0, 0), tmax=0.5).status == Status.MISS
    assert RING.leave(hit, (1, 0, 0), tmax=0).status == Status.MISS  # an end at the start


def test_a_function_of_python():
    def ball(x, y, z):
        return x**2 + y**2 + z**2 - 1, 2 * x, 2 * y, 2 * z

    surface = sagitta.Function(ball, inside=2)
    hit = surface.intersect((0.1, 0.2, -3), (0, 0, 1))
    across = surface.leave(hit, (0, 0, 1))
    assert across.status == Status.HIT and across.p[2] == pytest.approx(0.95**0.5)


def test_what_is_refused(rng):
    hits, o, d = hits_of(rng)
    after = RING.leave(hits, d)
    for args, more, error, words in (
        ((o, d), {}, TypeError, "hits: must be a Hit or Hits"),
        ((hits, d[:, :5]), {}, ValueError, "different numbers of rays"),
        ((hits, d), {"out": hits}, TypeError, "out: must be Crossings"),
        ((after, d), {"out": after}, ValueError, "overlaps"),
        ((hits, d), {"out": Crossings.empty(3)}, ValueError, "room for 3"),
        ((RING.intersect(o, d, out=sagitta.Hits.empty(len(after), "t")), d), {}, AttributeError, "not asked for"),
    ):
        with pytest.raises(error, match=words):
            RING.leave(*args, **more)
