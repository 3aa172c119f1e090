# SPDX-License-Identifier: MIT
"""Surface.intersect_single(): floats against doubles of the same rays; shapes, threads, what is refused."""
import numpy as np
import pytest
from bits import rays, same

import sagitta
from sagitta import Status

PARABOLOID = sagitta.Conic(radius=20, conic=-1, semi_diameter=5)
TORUS = sagitta.Torus(major=2, minor=0.5)


@pytest.mark.parametrize("surface", [PARABOLOID, TORUS, sagitta.Sphere(radius=3, semi_diameter=2)])
def test_the_doubles_of_the_same_rays(rng, surface):
    o, d = (np.ascontiguousarray(x, np.float32) for x in rays(rng, 5000, 2.0))
    single, double = surface.intersect_single(o, d), surface.intersect(o.astype(float), d.astype(float))
    assert same(single.status, double.status)
    met = double.status > 0
    assert met.sum() > 500
    assert single.t.dtype == single.p.dtype == np.float32
    apart = np.abs(single.t.astype(float) - double.t)[met]
    assert (apart <= (single.t_err.astype(float) + double.t_err)[met]).all() and apart.max() > 1e-9
    off = np.linalg.norm(single.p.astype(float) - double.p, axis=0)[met]
    assert off.max() < 1e-5 and (single.p_err[met] > 0).all()
    lengths = np.linalg.norm(double.n, axis=0)[met]
    assert (np.linalg.norm(single.n - double.n, axis=0)[met] < 2.0**-15 * lengths).all()


def test_shapes_and_threads_say_the_same(rng):
    o, d = (np.ascontiguousarray(x, np.float32) for x in rays(rng, 600, 2.0))
    want = PARABOLOID.intersect_single(o, d)
    columns = [o.astype(float), d.astype(float)]
    for got in (
        PARABOLOID.intersect_single(*columns),
        PARABOLOID.intersect_single(o, d, threads=3),
        PARABOLOID.intersect_single(o.T, d.T),
        PARABOLOID.intersect_single(list(o), tuple(d)),
        PARABOLOID.intersect_single(o, d, tmin=0.0, tmax=np.inf),
    ):
        assert got == want
    square = PARABOLOID.intersect_single(o.reshape(3, 20, 30), d.reshape(3, 20, 30), axis=0)
    assert square.p.shape == (3, 20, 30) and same(square.t.ravel(), want.t)
    assert set(want.keys()) == {"status", "t", "t_err", "p", "n", "p_err"} and len(want) == 600
    one = PARABOLOID.intersect_single((0, 0, -5), (0, 0, 1))
    assert one.t.tolist() == [5.0] and one.p[:, 0].tolist() == [0, 0, 0]
    assert PARABOLOID.intersect_single((0, 0, -5), (0, 0, 1), tmax=4).status[0] == Status.MISS
    assert len(PARABOLOID.intersect_single(np.empty((3, 0), np.float32), np.empty((3, 0), np.float32))) == 0


def test_a_function_of_python(rng):
    """It is asked in double, many rays together, and what it raises comes through."""
    def ball(x, y, z):
        return x * x + y * y + z * z - 4

    o, d = (np.ascontiguousarray(x, np.float32) for x in rays(rng, 500, 2.0))
    own = sagitta.Function(ball, inside=3)
    single, double = own.intersect_single(o, d), own.intersect(o.astype(float), d.astype(float))
    assert same(single.status, double.status) and (double.status > 0).any()

    def broken(x, y, z):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        sagitta.Function(broken, inside=3).intersect_single(o, d)


def test_what_does_not_fit():
    far = PARABOLOID.intersect_single((0, 0, -1e39), (0, 0, 1))
    assert far.status[0] == Status.INVALID
    with pytest.raises(TypeError, match="proof|unexpected"):
        PARABOLOID.intersect_single((0, 0, -5), (0, 0, 1), prof="first")
    with pytest.raises(ValueError, match="threads"):
        PARABOLOID.intersect_single(np.zeros((3, 9)), np.ones((3, 9)), threads=0)
