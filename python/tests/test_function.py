# SPDX-License-Identifier: MIT
"""Functions of Python as surfaces: they answer as the library's own types do, and what they raise is
raised."""
import math
import pickle
import threading

import numpy as np
import pytest
from bits import rays, same

import sagitta
from sagitta import Function, Hits, _calls


def torus(x, y, z):
    rho = np.sqrt(x * x + y * y)
    f = (rho - 2) ** 2 + z * z - 0.25
    return f, 2 * (rho - 2) * x / rho, 2 * (rho - 2) * y / rho, 2 * z


def torus_only(x, y, z):
    return torus(x, y, z)[0]


def ball(x, y, z):
    return x * x + y * y + z * z - 4, 2 * x, 2 * y, 2 * z


def ball_enclosed(o, d, lo, hi):
    """Along the ray it is a parabola: its least value is at the vertex or at an end."""
    a, b, c = (d * d).sum(axis=0), 2 * (o * d).sum(axis=0), (o * o).sum(axis=0) - 4
    f = np.array([a * t * t + b * t + c for t in (lo, hi, np.clip(-b / (2 * a), lo, hi))])
    size = np.maximum(np.abs(lo), np.abs(hi))
    wide = 1e-14 * (a * size**2 + np.abs(b) * size + np.abs(c) + 8)
    slope = np.sort([2 * a * lo + b, 2 * a * hi + b], axis=0)
    return f.min(axis=0) - wide, f.max(axis=0) + wide, slope[0] - wide, slope[1] + wide


def far(x, y, z):
    return np.abs(np.sqrt(x * x + y * y + z * z) - 2) * 0.999


SURFACES = {
    "gradient": lambda: Function(torus, inside=2.6),
    "differences": lambda: Function(torus_only, inside={"box": (3, 3, 1)}),
    "enclose": lambda: Function(ball, enclose=ball_enclosed),
    "clearance": lambda: Function(ball, clearance=far, inside=3),
    "rounding": lambda: Function(ball, rounding=lambda x, y, z: 1e-14 + 0 * x, inside=3),
}


def test_as_the_torus_of_the_library(rng):
    o, d = rays(rng, 20000)
    mine, theirs = Function(torus, inside=2.6).intersect(o, d), sagitta.Torus(major=2, minor=0.5).intersect(
        o, d
    )
    both = (mine.status == 1) & (theirs.status == 1)
    assert both.sum() > 5000
    assert (mine.met != theirs.met).mean() < 0.01  # a march may step over two roots that are close
    assert np.median(np.abs(mine.t - theirs.t)[both]) < 1e-14
    assert (np.abs(mine.t - theirs.t)[both] < 1e-6).mean() > 0.99


@pytest.mark.parametrize("which", SURFACES)
def test_all_at_once_is_one_by_one(which, rng):
    """Blocks under way together, one after another, in two threads, and ray by ray: the same bits."""
    n = 400 if which == "enclose" else 3000
    o, d = rays(rng, n, 1.5)
    surface = SURFACES[which]()
    together = surface.intersect(o, d)
    assert (together.status > 0).sum() > n // 10
    blocks, _calls.BLOCKS = _calls.BLOCKS, 1
    try:
        after = surface.intersect(o, d)
    finally:
        _calls.BLOCKS = blocks
    two = surface.intersect(o, d, threads=2)
    for name in Hits.FIELDS:
        assert same(together._rows[name], after._rows[name]), name
        assert same(together._rows[name], two._rows[name]), name
    for i in range(0, n, 40):
        one = surface.intersect(tuple(o[:, i]), tuple(d[:, i]))
        assert same([one.status, one.t], [together.status[i], together.t[i]])


def test_without_a_gradient(rng):
    o, d = rays(rng, 2000)
    with_, without = Function(torus, inside=2.6).intersect(o, d), Function(torus_only, inside=2.6).intersect(
        o, d
    )
    both = (with_.status == 1) & (without.status == 1)
    assert both.sum() > 500 and np.abs(with_.t - without.t)[both].max() < 1e-7
    assert np.abs(with_.n - without.n)[:, both].max() < 1e-7


def test_enclosures_prove(rng):
    o, d = rays(rng, 500)
    surface = Function(ball, enclose=ball_enclosed, rounding=1e-13)
    proven = surface.intersect(o, d, proof="first", tmax=30)
    plain = Function(ball).intersect(o, d, proof="first", tmax=30)
    assert (proven.status == 1).sum() > 100 and (proven.status == 0).sum() > 100
    assert not (plain.status == 1).any()
    every = surface.intersect_all(o, d, tmax=30)
    assert (every.count == 2).sum() > 100 and every.count.max() <= 2
    # Within a ball no ray is left undecided; along whole rays those that miss are.
    clipped = Function(ball, enclose=ball_enclosed, rounding=1e-13, inside=3)
    assert same(clipped.intersect(o, d).status, proven.status)


def test_check_finds_what_is_wrong(rng):
    o, d = rays(rng, 6, 1.5)
    for which in SURFACES:
        said = SURFACES[which]().check(o[:, :2], d[:, :2], tmax=14)
        assert said.sound, (which, said)
    bad = Function(lambda x, y, z: (torus_only(x, y, z), x, y, z), inside=2.6).check(o, d, tmax=14)
    assert (
        bad.fault == sagitta.Fault.WRONG_GRADIENT and np.isfinite(bad.where).all() and "gradient" in bad.text
    )
    assert Function(torus, inside=1.9).check(o, d, tmax=14).fault == sagitta.Fault.WRONG_SPAN
    zero = Function(ball, enclose=lambda o, d, lo, hi: (lo * 0, lo * 0, lo * 0, lo * 0))
    assert zero.check(o, d, tmax=14).fault == sagitta.Fault.WRONG_ENCLOSURE


def test_in_a_lens(rng):
    """A sphere by numpy in the place of a sphere: the same rays to rounding."""

    def cap(x, y, z):
        s = np.sqrt(2500 - x * x - y * y)
        return z - (50 - s), -x / s, -y / s, np.ones_like(z)

    def lens(front):
        return sagitta.Lens(
            [
                sagitta.Element(front, index=1.5, thickness=5, semi_diameter=20),
                sagitta.Element(sagitta.Plane(), index=1, thickness=90),
                sagitta.Element(sagitta.Plane()),
            ]
        )

    o, _ = rays(rng, 5000, 10)
    mine, theirs = lens(Function(cap)), lens(sagitta.Sphere(radius=50))
    a, b = mine.trace(o, (0, 0, 1), passages=True), theirs.trace(o, (0, 0, 1), passages=True)
    assert a.through.all() and np.abs(a.o - b.o).max() < 1e-10 and np.abs(a.opl - b.opl).max() < 1e-10
    assert np.abs(a.passages[0].p - b.passages[0].p).max() < 1e-11
    assert same(a.o, mine.trace(o, (0, 0, 1), threads=2).o)
    for call in (mine.first_order, mine.seidel, mine.parabasal, mine.spot, mine.launch):
        with pytest.raises(ValueError, match=r"element 0 is Function\(cap\)"):
            call()
    change = mine.sensitivity(o[:, :200], (0, 0, 1))
    assert np.abs(change.value - b.passages[2].p[:2, :200]).max() < 1e-10


def test_many_functions_at_once():
    """More kinds of questions under way than are put together (bridge.c, KINDS): the bits are the same."""

    def steep(k):
        # z = 0.3.  The farther from the axis the more steps it takes, so the blocks drift apart.
        def f(x, y, z):
            a = 10 ** (k * x)
            u = z - 0.3
            return u * (1 + a * u * u), 0, 0, 1 + 3 * a * u * u

        return Function(f, rounding=lambda x, y, z: 1e-14 + 0 * x)

    lens = sagitta.Lens(
        [sagitta.Element(steep(k), index=1 + k % 2 * 0.1, thickness=1) for k in range(1, 8)]
    )
    n = 160
    o = np.array([np.linspace(0, 1, n), np.zeros(n), np.full(n, -5.0)])
    together = lens.trace(o, (0, 0, 1))
    blocks, _calls.BLOCKS = _calls.BLOCKS, 1
    try:
        after = lens.trace(o, (0, 0, 1))
    finally:
        _calls.BLOCKS = blocks
    assert together.through.mean() > 0.5
    assert all(same(together._rows[name], after._rows[name]) for name in after._rows)


class Trouble(Exception):
    pass


@pytest.mark.parametrize("when", [1, 5, 40])
def test_what_is_raised(rng, when):
    o, d = rays(rng, 50000)
    calls = []

    def fails(x, y, z):
        calls.append(len(x))
        if len(calls) >= when:
            raise Trouble("no more")
        return torus(x, y, z)

    surface = Function(fails, inside=2.6)
    out = Hits.empty(50000)
    with pytest.raises(Trouble, match="no more"):
        surface.intersect(o, d, out=out)
    assert len(calls) == when
    assert (out.status == sagitta.Status.STOPPED).all() and np.isnan(out.t).all() and np.isnan(out.p).all()
    calls.clear()
    with pytest.raises(Trouble):
        surface.intersect(o, d, threads=2)
    assert len(calls) <= when + 1
    lens = sagitta.Lens([sagitta.Element(surface)])
    for call in (
        lambda: surface.intersect((2, 0, -5), (0, 0, 1)),
        lambda: surface.intersect_all(o[:, :100], d[:, :100]),
        lambda: surface.prepare(o[:, :5], d[:, :5])(),
        lambda: surface.check(o[:, :5], d[:, :5], tmax=14),
        lambda: surface.diagnose((2, 0, -5), (0, 0, 1)),
        lambda: lens.trace(o[:, :500], d[:, :500], passages=True),
        lambda: lens.sensitivity(o[:, :500], d[:, :500]),
    ):
        calls[:] = [0] * when
        with pytest.raises(Trouble):
            call()
        assert len(calls) == when + 1
    assert not surface._raised


def test_it_works_again_afterwards(rng):
    o, d = rays(rng, 1000)
    broken = [True]

    def values(x, y, z):
        if broken[0]:
            raise KeyboardInterrupt
        return torus(x, y, z)

    surface = Function(values, inside=2.6)
    with pytest.raises(KeyboardInterrupt):
        surface.intersect(o, d)
    broken[0] = False
    assert same(surface.intersect(o, d).t, Function(torus, inside=2.6).intersect(o, d).t)


@pytest.mark.parametrize(
    "values, says",
    [
        (lambda x, y, z: "x", "real numbers"),
        (lambda x, y, z: (x, y, z), "not 3 arrays"),
        (lambda x, y, z: np.zeros(7), "like x"),
        (lambda x, y, z: (x, y, z, 1j * z), "real numbers"),
        (lambda x, y: x, "positional argument"),
        (lambda x, y, z: None, "real numbers"),
    ],
)
def test_answers_that_are_none(values, says, rng):
    for n in (1, 1000):
        with pytest.raises((TypeError, ValueError), match=says):
            Function(values).intersect(*rays(rng, n))


def test_bad_arguments():
    for make, says in (
        (lambda: Function(3), "values: must be a function"),
        (lambda: Function(None), "values"),
        (lambda: Function(torus, enclose=1), "enclose"),
        (lambda: Function(torus, inside=-1), "ball"),
        (lambda: Function(torus, inside=((1, 1, 1), (0, 0, 0))), "box"),
        (lambda: Function(torus, inside={"cube": 1}), "cube"),
        (lambda: Function(torus, rounding=-1), "rounding"),
    ):
        with pytest.raises((TypeError, ValueError), match=says):
            make()


def test_constants_and_nan(rng):
    """A scalar answer holds for all points; where F is NaN there is no surface."""
    o, d = rays(rng, 300)
    flat = Function(lambda x, y, z: (z, 0, 0, 1)).intersect(o, d)
    assert np.abs(flat.t - 9).max() < 1e-14
    half = Function(lambda x, y, z: (np.where(x > 0, z, np.nan), 0, 0, 1)).intersect(o, d, tmax=18)
    at = (o + 9 * d)[0]
    # A march that steps from a NaN over the root does not see it: rays that stay on one side.
    stays = np.sign(o[0]) == np.sign((o + 18 * d)[0])
    assert (half.status[stays & (at > 0)] == 1).all() and not (half.status[at < 0] > 0).any()


def test_a_function_that_asks_another_surface(rng):
    """From within `values` the library may be called, with functions too."""
    inner = Function(ball)

    def values(x, y, z):
        assert inner.intersect((0, 0, -5), (0, 0, 1)).met
        assert inner.intersect(*rays(np.random.default_rng(1), 100), tmax=18).met.any()
        return torus(x, y, z)

    o, d = rays(rng, 500)
    assert same(Function(values, inside=2.6).intersect(o, d).t, Function(torus, inside=2.6).intersect(o, d).t)


def test_many_threads_share_a_function(rng):
    surface, (o, d) = Function(torus, inside=2.6), rays(rng, 2000)
    want, got = surface.intersect(o, d), [None] * 4

    def work(i):
        got[i] = surface.intersect(o, d)

    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for t in threads:
        t.start()
    for t in threads:
        t.join()
    assert all(same(g.t, want.t) for g in got)


def test_pickle():
    surface = pickle.loads(pickle.dumps(Function(torus, inside=2.6, rounding=1e-12)))
    assert abs(surface.intersect((2, 0, -5), (0, 0, 1)).t - 4.5) < 1e-15 and surface.inside == 2.6
    assert surface.name == "torus"


def test_what_is_kept_stays(rng):
    kept = []

    def values(x, y, z):
        kept.append((x, x.copy()))
        return torus(x, y, z)

    Function(values, inside=2.6).intersect(*rays(rng, 1000))
    assert all((x == y).all() for x, y in kept)


def test_what_passes_the_ball_is_missed_at_once():
    calls = []
    surface = Function(lambda x, y, z: calls.append(1) or torus(x, y, z), inside=2.6)
    assert surface.intersect((0, 9, -5), (0, 0, 1)).text == "miss" and not calls
    assert surface.intersect((0, 2, -5e6), (0, 0, 1)).met
    assert surface.intersect((0, 2, -5), (0, 0, math.pi)).met
