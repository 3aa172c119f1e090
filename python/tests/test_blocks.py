# SPDX-License-Identifier: MIT
"""Answers in blocks, passages by names, prepared calls: the same bits by every way, and what is refused.

The other way is that of arrays of the caller (Hits(t=a, p=b)): each has a pointer of its own there.
"""
import gc
import itertools
import pickle
import threading
import weakref

import numpy as np
import pytest
from bits import rays, same

import sagitta
from sagitta import Element, Hits, Lens, Passage, Plane, Sphere, Traced
from sagitta import _arrays

BALL = Sphere(radius=10)
SIZES = [0, 1, 2, 3, 7, 63, 64, 65, 127, 128, 129, 1000]


def lens():
    """Some rays are clipped, miss, or are totally reflected; one element is turned."""
    return Lens(
        [
            Element(Sphere(radius=12), thickness=3, index=1.7, semi_diameter=4),
            Element(
                sagitta.EvenAsphere(radius=-9, coefficients=[0, 1e-4]), thickness=4, index=1, tilt=[1, 2, 3]
            ),
            Element(Sphere(radius=6), thickness=2, index=2.1),
            Element(Plane(), index=1),
        ]
    )


def wide_rays(rng, n):
    return rays(rng, n, wide=4.5, steep=0.3)


def own(of, n, names=()):
    """Arrays of the caller."""
    arrays = {}
    for name in names or of.FIELDS:
        kind, count = of.FIELDS[name]
        arrays[name] = np.zeros(n if count == 1 else (count, n), kind)
    return of(**arrays)


def own_trace(through, o, d, names=tuple(Passage.FIELDS), **more):
    out = own(Traced, o.shape[1])
    out.passages = [own(Passage, o.shape[1], names) for _ in range(len(through))]
    return through.trace(o, d, axis=0, out=out, **more)


def alike(a, b, names=None):
    assert len(a) == len(b)
    for name in names or a._names:
        assert same(getattr(a, name), getattr(b, name)), name


def subsets(names):
    for count in range(1, len(names) + 1):
        yield from itertools.combinations(names, count)


@pytest.mark.parametrize("n", SIZES)
def test_number_of_rays(rng, n):
    (o, d), through = wide_rays(rng, n), lens()
    want, got = BALL.intersect(o, d, axis=0, out=own(Hits, n)), BALL.intersect(o, d, axis=0)
    alike(got, want)
    alike(BALL.intersect(o, d, axis=0, proof="first", pick="first", threads=2),
          BALL.intersect(o, d, axis=0, proof="first", pick="first"))
    for i in range(min(n, 5)):
        hit = BALL.intersect(o[:, i], d[:, i])
        for name in Hits.FIELDS:
            assert same(getattr(hit, name), got._rows[name][..., i])
    want = own_trace(through, o, d)
    for passages in (False, True, tuple(Passage.FIELDS)):
        for threads in (1, 2):
            got = through.trace(o, d, axis=0, passages=passages, threads=threads)
            alike(got, want)
            assert len(got.passages) == (4 if passages else 0)
            for a, b in zip(got.passages, want.passages):
                assert a._names == tuple(Passage.FIELDS)
                alike(a, b)
    if n == 1000:
        assert len(set(got.fate.tolist())) > 2


def test_every_set_of_columns(rng):
    for n in (1, 6):
        (o, d), through = wide_rays(rng, n), lens()
        want, end = BALL.intersect(o, d, out=own(Hits, n)), own_trace(through, o, d)
        for names in subsets(tuple(Hits.FIELDS)):
            alike(BALL.intersect(o, d, out=Hits.empty(n, *names)), want, names)
        for names in subsets(tuple(Traced.FIELDS)):
            alike(through.trace(o, d, out=Traced.empty(n, *names)), end, names)
        for names in subsets(tuple(Passage.FIELDS)):
            got = through.trace(o, d, passages=names)
            for a, b in zip(got.passages, end.passages):
                assert a._names == names
                alike(a, b, names)
            alike(got, end)


def test_what_is_not_asked_for_is_not_there(rng):
    o, d = wide_rays(rng, 5)
    passage = lens().trace(o, d, passages=("p", "opl")).passages[0]
    with pytest.raises(AttributeError, match="t_err was not asked for; there are p, opl"):
        passage.t_err
    assert repr(passage) == "<Passage of 5 rays: p, opl>"
    assert passage.table().dtype.names == ("p", "opl")
    assert lens().trace(o, d, passages="opl").passages[3]._names == ("opl",)


@pytest.mark.parametrize(
    "passages, error, says",
    [
        (
            ("p", "q"),
            ValueError,
            "passages: there is no 'q'; there are status, evals, t, t_err, t_lo, p, n, p_err, direction, opl",
        ),
        ("q", ValueError, "there is no 'q'"),
        ([1], ValueError, "there is no 1"),
        (1, TypeError, "passages: must be True, False or names, not int"),
        (None, TypeError, "not NoneType"),
    ],
)
def test_names_of_passages(passages, error, says):
    for call in (lens().trace, lens().prepare):
        with pytest.raises(error) as raised:
            call(np.zeros((3, 4)), (0, 0, 1), passages=passages)
        assert says in str(raised.value)


def test_no_names_are_no_passages(rng):
    o, d = wide_rays(rng, 5)
    assert lens().trace(o, d, passages=()).passages == lens().trace(o, d, passages=np.False_).passages == []


def test_out_without_room_for_what_is_wanted(rng):
    (o, d), through = wide_rays(rng, 5), lens()
    out = Traced.empty(5, passages=4, of_passages=("p",))
    want = own_trace(through, o, d).passages[2]
    assert same(through.trace(o, d, passages="p", out=out).passages[2].p, want.p)
    with pytest.raises(ValueError, match=r"out: passages\[0\] has no room for opl"):
        through.trace(o, d, passages=("p", "opl"), out=out)
    through.trace(o, d, passages=True, out=out)  # whatever it has room for


def test_columns_with_memory_of_their_own(rng, monkeypatch):
    """As with very many rays."""
    (o, d), through = wide_rays(rng, 200), lens()
    hits, want = BALL.intersect(o, d), own_trace(through, o, d)
    for module in (_arrays, sagitta.results, sagitta.surface, sagitta.lens):
        monkeypatch.setattr(module, "LARGE", 100)
    alike(BALL.intersect(o, d), hits)
    assert BALL.intersect(o, d)._block is None
    for passages in (True, ("t", "n"), ("status",)):
        for threads in (1, 2):
            got = through.trace(o, d, passages=passages, threads=threads)
            alike(got, want)
            for a, b in zip(got.passages, want.passages):
                assert a._block is None
                alike(a, b)
    call = through.prepare(o, d, passages=True)
    call()
    alike(call.out.passages[3], want.passages[3])


# ------------------------------------------------------- what is found when it is read


def test_what_is_read_later_is_of_the_rays_as_they_were(rng):
    (o, d), through = wide_rays(rng, 300), lens()
    want = own_trace(through, o, d, proof="root")
    got = [through.trace(o, d, passages=True, proof="root"),
           through.trace(o.T.copy(), d.T.copy(), passages=True, proof="root")]
    o[:], d[:] = 7, 7
    for traced in got:
        for i in (3, 0, 1, 2):
            for name in ("direction", "t_err", "p", "t", "n"):
                a = getattr(traced.passages[i], name)
                assert same(a.T if a.ndim == 2 and traced is got[1] else a, getattr(want.passages[i], name))
                assert getattr(traced.passages[i], name) is a


def test_read_later_in_threads(rng):
    (o, d), through = wide_rays(rng, 2000), lens()
    want = own_trace(through, o, d)
    traced, wrong = through.trace(o, d, passages=True), []

    def read(name):
        for a, b in zip(traced.passages, want.passages):
            if not same(getattr(a, name), getattr(b, name)):
                wrong.append(name)

    readers = [threading.Thread(target=read, args=(name,)) for name in Passage.FIELDS]
    for reader in readers:
        reader.start()
    for reader in readers:
        reader.join()
    assert not wrong


def test_passages_from_a_pickle(rng):
    (o, d), through = wide_rays(rng, 20), lens()
    again = pickle.loads(pickle.dumps(through.trace(o, d, passages=True)))
    for a, b in zip(again.passages, own_trace(through, o, d).passages):
        alike(a, b)


def test_passages_as_room_for_others(rng):
    (o, d), through = wide_rays(rng, 20), lens()
    out, (o2, d2) = through.trace(o, d, passages=True), wide_rays(rng, 20)
    seen = out.passages[1].t
    through.trace(o2, d2, out=out)
    want = own_trace(through, o2, d2)
    alike(out, want)
    for a, b in zip(out.passages, want.passages):
        alike(a, b)
    assert out.passages[1].t is seen and same(seen, want.passages[1].t)
    first = through.trace(o, d, passages=True).passages[0]
    alike(BALL.intersect(o2, d2, out=first), BALL.intersect(o2, d2), tuple(Hits.FIELDS))


def test_derivatives_of_a_passage_s_hits():
    o, d = np.array([[0.0, 0], [0, 6], [-5, -5]]), np.array([[0.0, 0], [0, 0], [1, 1]])
    met = Lens([Element(BALL)]).trace(o, d, passages=True).passages[0]
    assert same(BALL.differentiate(o, d, met).p_by_a, BALL.differentiate(o, d, BALL.intersect(o, d)).p_by_a)


def test_a_function_is_not_asked_again(rng):
    asked = []

    def plane(x, y, z):
        asked.append(len(x))
        return z, 0 * x, 0 * x, 0 * x + 1

    o, d = wide_rays(rng, 30)
    traced = Lens([Element(sagitta.Function(plane))]).trace(o, d, passages=True)
    before = len(asked)
    assert np.allclose(traced.passages[0].t, 9 * np.sqrt((d * d).sum(axis=0)), rtol=1e-14)
    assert before == len(asked) > 0


# ---------------------------------------------------------------------- what comes in


def test_what_is_not_as_usual_is_looked_at(rng):
    (o, d), through = wide_rays(rng, 40), lens()
    want, end = BALL.intersect(o, d), through.trace(o, d)
    frozen = o.copy()
    frozen.flags.writeable = False
    unaligned = np.frombuffer(b"." + o.tobytes(), np.uint8)[1:].view(np.float64).reshape(3, 40)
    wide = np.zeros((3, 80))
    wide[:, ::2] = o
    below = np.zeros((5, 40))
    below[1:4] = o
    for a in (frozen, unaligned, pickle.loads(pickle.dumps(o)), wide[:, ::2], below[1:4], o.astype(">f8"),
              np.asfortranarray(o), o.view(np.ma.MaskedArray)):
        alike(BALL.intersect(a, d), want)
        alike(through.trace(a, d), end)
    assert not unaligned.flags.aligned
    alike(BALL.intersect(o[:, :1], d[:, :1]), BALL.intersect(o[:, :1].copy(), d[:, :1].copy()))
    alike(through.trace(BALL.intersect(o, d).p, d), through.trace(BALL.intersect(o, d).p.copy(), d))


def test_an_answer_is_not_written_over_its_own_rays(rng):
    o, d = wide_rays(rng, 40)
    hits, end = BALL.intersect(o, d), lens().trace(o, d)
    for call in (
        lambda: BALL.intersect(hits.p, d, out=hits),
        lambda: BALL.intersect(o, hits.n, out=hits),
        lambda: BALL.prepare(hits.p, d, out=hits),
        lambda: BALL.intersect(o, d, tmax=hits.t, out=hits),
        lambda: lens().trace((end.opl, o[1], o[2]), d, out=end),
        lambda: lens().prepare((o[0], o[1], end.opl), d, out=end),
    ):
        with pytest.raises(ValueError, match="overlaps the rays"):
            call()
    want = lens().trace(end.o.copy(), end.d.copy())
    alike(lens().trace(end.o, end.d, out=end), want)  # these may be where they came from
    hits.t.flags.writeable = False
    with pytest.raises(ValueError, match="out: t is read-only"):
        BALL.intersect(o, d, out=hits)


def test_a_column_outlives_its_answer(rng):
    o, d = wide_rays(rng, 40)
    want, hits = BALL.intersect(o, d).t.copy(), BALL.intersect(o, d)
    t, gone = hits.t, weakref.ref(hits)
    del hits
    gc.collect()
    junk = [np.full(40 * 93 // 8, 7.0) for _ in range(50)]
    assert gone() is None and same(t, want) and len(junk) == 50


@pytest.mark.parametrize("threads", [True, 1.0, 0, "1", None])
def test_threads_are_a_number(threads):
    o = np.zeros((3, 4))
    for call in (
        lambda: BALL.intersect(o, (0, 0, 1), threads=threads),
        lambda: BALL.prepare(o, o, threads=threads),
        lambda: lens().trace(o, o, threads=threads),
        lambda: lens().trace(o, o, threads=threads, passages=True),
        lambda: lens().prepare(o, o, threads=threads),
    ):
        with pytest.raises((TypeError, ValueError), match="threads: must be"):
            call()


# --------------------------------------------------------------------- prepared calls


@pytest.mark.parametrize("threads", [1, 2])
def test_prepared_traces(rng, threads):
    (o, d), through = wide_rays(rng, 300), lens()
    for passages in (False, True, ("direction", "status")):
        call = through.prepare(o, d, passages=passages, threads=threads)
        for _ in range(2):
            o[0] *= 0.9
            want = own_trace(through, o, d)
            assert call() == (want.fate == 1).sum()
            alike(call.out, want)
            for a, b in zip(call.out.passages, want.passages):
                alike(a, b)
    out = Traced.empty(300, "opl", passages=4, of_passages=("p",))
    call = through.prepare(o, d, passages="p", out=out, threads=threads)
    assert call() == (want.fate == 1).sum() and call.out is out
    alike(out, want)
    alike(out.passages[2], want.passages[2])
    launched = Lens.replace(through, pupil={"semi_diameter": 2}).launch(rays=3)
    assert through.prepare(launched)() == through.trace(launched).through.sum()


def slow_plane():
    """A surface whose function waits in the middle of a call: the surface, "it has begun", "go on"."""
    begun, go_on = threading.Event(), threading.Event()

    def f(x, y, z):
        begun.set()
        assert go_on.wait(60)
        return z, 0 * x, 0 * x, 0 * x + 1

    return sagitta.Function(f), begun, go_on


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("of_lens", [False, True])
def test_a_prepared_call_in_two_threads_is_refused(rng, threads, of_lens):
    o, d = rays(rng, 130)
    surface, begun, go_on = slow_plane()
    call = (Lens([Element(surface)]) if of_lens else surface).prepare(o, d, threads=threads)
    other = (Lens([Element(surface)]) if of_lens else surface).prepare(o, d, threads=threads)
    met = []
    first = threading.Thread(target=lambda: met.append(call()))
    first.start()
    assert begun.wait(60)
    for _ in range(3):
        with pytest.raises(RuntimeError, match="under way in another thread.*one call for each thread"):
            call()
    go_on.set()
    first.join()
    assert met == [130] and call() == 130 and other() == 130  # and no harm is done


def test_a_prepared_call_within_itself_is_refused(rng):
    o, d = rays(rng, 4)
    call = sagitta.Function(lambda x, y, z: (call() * z, 0 * x, 0 * x, 0 * x + 1)).prepare(o, d)
    for _ in range(2):  # it can be made again after it has raised
        with pytest.raises(RuntimeError, match="prepare one call for each thread"):
            call()
        assert np.isnan(call.out.t).all() and (call.out.status == -4).all()


def test_prepared_calls_of_their_own_in_threads(rng):
    through, met = lens(), {}
    given = [wide_rays(rng, 500) for _ in range(8)]
    want = [through.trace(o, d) for o, d in given]

    def work(i):
        call = through.prepare(*given[i], passages=("p",))
        met[i] = [call() for _ in range(50)], call.out

    workers = [threading.Thread(target=work, args=(i,)) for i in range(8)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    for i in range(8):
        assert met[i][0] == [int(want[i].through.sum())] * 50
        alike(met[i][1], want[i])
