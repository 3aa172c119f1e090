# SPDX-License-Identifier: MIT
"""Arrays of dask: the same bits as arrays of numpy, for any chunks, in threads and on two workers, also if one of them
is killed."""
import os
import pickle
import signal
import time

import numpy as np
import pytest
from bits import rays, same

import sagitta

dask = pytest.importorskip("dask", reason="dask is not installed (on Debian: apt-get install python3-dask)")
da = pytest.importorskip("dask.array")
import sagitta.dask as lazily  # noqa: E402

SCALE = float(os.environ.get("SAGITTA_TEST_SCALE", "0.5"))
THREADS = dict(scheduler="threads", num_workers=2)
ASPHERE = sagitta.EvenAsphere(radius=20, conic=-0.5, coefficients=[0, 1e-5], semi_diameter=4)
GYROID = sagitta.Function(lambda x, y, z: np.sin(x) * np.cos(y) + np.sin(y) * np.cos(z) + np.sin(z) * np.cos(x), inside=4)


def triplet(tree):
    return sagitta.Lens.read(tree / "examples" / "lenses" / "cooke_triplet.yaml")


def equal(a, b):
    """All columns, and all passages, bit for bit."""
    assert type(a) is type(b) and a.keys() == b.keys() and a.shape == b.shape
    assert all(same(a[name], b[name]) and a[name].dtype == b[name].dtype for name in a.keys())
    passages = [getattr(x, "passages", []) for x in (a, b)]
    assert len(passages[0]) == len(passages[1])
    for pair in zip(*passages):
        equal(*pair)


# ---------------------------------------------------------------------- threads


@pytest.mark.parametrize("surface", [ASPHERE, sagitta.Torus(2, 0.5), sagitta.Formula("x^2+y^2+z^4=a", a=3), GYROID])
@pytest.mark.parametrize("chunk", [(3, 64), (1, 1000), (3, (3, 1, 0, 700, 296))])
def test_intersect(rng, surface, chunk):
    o, d = rays(rng, 1000)
    if surface is GYROID:
        o[1, 100:] = 50.0  # (the others are slow)
    o[:, 5], d[:, 7] = np.nan, 0
    hits = lazily.intersect(surface, da.from_array(o, chunk), da.from_array(d, chunk), tmax=12, proof="root")
    equal(hits.compute(**THREADS), surface.intersect(o, d, tmax=12, proof="root"))
    assert hits.t.shape == (1000,) and hits["p"].dtype == float and "n" in dir(hits)


@pytest.mark.parametrize("axis", [0, -1])
@pytest.mark.parametrize("shape, chunks", [((4, 6), (3, 2)), ((3, 3), (3, 3)), ((3, 5, 2), (3, 3, 3)), ((7,), 3)])
def test_shapes(rng, axis, shape, chunks):
    o, d = (np.moveaxis(a.reshape(3, *shape), 0, axis) for a in rays(rng, int(np.prod(shape))))
    whole = (3, *np.broadcast_to(chunks, len(shape))) if axis == 0 else (*np.broadcast_to(chunks, len(shape)), 3)
    far = rng.uniform(5, 12, shape)
    hits = lazily.intersect(ASPHERE, da.from_array(o, tuple(map(int, whole))), d, tmax=da.from_array(far, 2), axis=axis)
    equal(hits.compute(**THREADS), ASPHERE.intersect(o, d, tmax=far, axis=axis))


def test_broadcast_and_three_arrays(rng):
    x, y = rng.uniform(-2, 2, 30), rng.uniform(-2, 2, 20)
    lazy = lazily.intersect(ASPHERE, (da.from_array(x[None], 7), da.from_array(y[:, None], 6), -9.0), (0, 0, 1))
    equal(lazy.compute(**THREADS), ASPHERE.intersect((x[None], y[:, None], -9.0), (0, 0, 1)))
    o, d = np.zeros((3, 20, 1)), np.zeros((3, 1, 30))
    o[1, :, 0], o[2], d[0, 0], d[2] = y, -9, x / 20, 1
    lazy = lazily.intersect(ASPHERE, da.from_array(o, (3, 7, 1)), da.from_array(d, (3, 1, 9)))
    equal(lazy.compute(**THREADS), ASPHERE.intersect(o, d))
    lazy = lazily.intersect(ASPHERE, (0, 0, -5), da.from_array(d, (3, 1, 9)), of="t")
    equal(lazy.compute(**THREADS), ASPHERE.intersect((0, 0, -5), d, out=sagitta.Hits.empty((1, 30), "t")))


@pytest.mark.parametrize("edit", [False, True])
def test_trace(tree, rng, edit):
    lens = triplet(tree)
    if edit:
        lens = lens.set({"surfaces[1].radius": 23.0, "surfaces[6].thickness": {"solve": "paraxial_focus"}})
        lens = lens.insert("surfaces[2]", sagitta.Element(ASPHERE, thickness=0.5, glass="N-BK7"))
        assert pickle.loads(pickle.dumps(lens)) == lens
    o, d = rays(rng, 1000, wide=8, steep=0.1)
    arrays = da.from_array(o, (3, 300)), da.from_array(d, (3, 300))
    names = ("p", "opl", "t_err")
    traced = lazily.trace(lens, *arrays, wavelength=0.6, passages=names, proof="first")
    equal(traced.compute(**THREADS), lens.trace(o, d, wavelength=0.6, passages=names, proof="first"))
    some = lazily.trace(lens, *arrays, of=("fate", "o"))
    assert some.keys() == ("fate", "o") and same(some.o.compute(**THREADS), lens.trace(o, d).o)


def test_what_is_shared(rng, monkeypatch):
    """Blocks are read where they are, each ray is met once whatever is asked of it, and equal graphs have equal keys."""
    o, d = rays(rng, 1000)
    seen, real = [], sagitta.EvenAsphere.intersect

    def intersect(self, o_of, d_of, **how):
        given = sagitta._arrays.RayArrays(o_of, d_of, None, None, how["axis"])
        seen.append(np.shares_memory(o, given.o[0]) and np.shares_memory(d, given.d[2]))
        return real(self, o_of, d_of, **how)

    monkeypatch.setattr(sagitta.EvenAsphere, "intersect", intersect)
    hits = lazily.intersect(ASPHERE, da.from_array(o, (3, 250)), da.from_array(d, (3, 250)))
    dask.compute(hits.t, hits.p, hits.n.sum(), **THREADS)
    assert seen == [True] * 4
    again = lazily.intersect(pickle.loads(pickle.dumps(ASPHERE)), da.from_array(o, (3, 250)), da.from_array(d, (3, 250)))
    assert again.t.name == hits.t.name
    other = lazily.intersect(ASPHERE.replace(radius=21), da.from_array(o, (3, 250)), da.from_array(d, (3, 250)))
    assert other.t.name != hits.t.name


def test_sums(tree, rng):
    lens = triplet(tree)
    ends = lens.ends(3, 1, pattern="random", rays=5000)
    columns = [np.array(c) for c in (ends.x, ends.y, ends.weight, ends.xy_err)]
    passed = ends.fate == 1
    start = sagitta.SpotSums((0.1, 18)).add(1, 2, 0)
    whole = (start + sagitta.SpotSums((0.1, 18))).add(*columns, passed=passed)
    for chunk in (17, 1000, 5000, (1, 4999)):
        lazy = [da.from_array(c, chunk) for c in columns]
        assert lazily.sums(start, *lazy, passed=passed).compute(**THREADS) == whole
    assert start.spot().rays == 1
    opd = rng.standard_normal((40, 30))
    lazy = lazily.sums(sagitta.WavefrontSums(), da.from_array(opd, (7, 11)), weight=da.from_array(opd**2, 8), error=1e-9)
    assert lazy.compute(**THREADS) == sagitta.WavefrontSums().add(opd, opd**2, 1e-9)


def test_analyses(tree):
    lens = triplet(tree)
    for parts, name, asked in (
        (1, "spot", dict(rays=30)), (7, "spot", dict(pattern="random", rays=9000, reference="centroid")),
        (5, "wavefront", dict(field=2, aim="real-stop")), (200, "fan", {}), (3, "sweep", dict(to=30, steps=4)),
    ):
        answer = lazily.analysis(lens, name, parts, **asked).compute(**THREADS)
        whole = getattr(lens, name)(**asked)
        assert answer.rows.tobytes() == whole.rows.tobytes() and answer.fates == whole.fates


def test_what_is_refused(tree, rng):
    o, d = map(da.from_array, rays(rng, 9))
    lens = triplet(tree)
    for call, error, words in (
        (lambda: lazily.intersect(lens, o, d), TypeError, "must be a Surface, not Lens"),
        (lambda: lazily.trace(ASPHERE, o, d), TypeError, "must be a Lens, not EvenAsphere"),
        (lambda: lazily.intersect(ASPHERE, (0, 0, 1), (0, 0, 1)), TypeError, "one of them must be an array"),
        (lambda: lazily.intersect(ASPHERE, o[:2], d), ValueError, r"\(2, 9\)"),
        (lambda: lazily.intersect(ASPHERE, o[:, :3], d), ValueError, "say axis=0 or -1"),
        (lambda: lazily.intersect(ASPHERE, (o, o), d), ValueError, "three arrays x, y, z, not 2"),
        (lambda: lazily.intersect(ASPHERE, o, d.T), ValueError, "along the same axis"),
        (lambda: lazily.intersect(ASPHERE, o, d, of="q"), ValueError, "Hits has no 'q'"),
        (lambda: lazily.intersect(ASPHERE, o, d).q, AttributeError, "no 'q'; there are status"),
        (lambda: lazily.intersect(ASPHERE, o, d, pick="last").compute(), ValueError, "pick"),
        (lambda: lazily.sums(sagitta.SpotSums(), 1, 2), ValueError, "arrays of one shape are needed, not none"),
        (lambda: lazily.sums(sagitta.SpotSums(), o[0], d), ValueError, r"not \(9,\), \(3, 9\)"),
        (lambda: lazily.sums(3, o[0]), TypeError, "must be SpotSums"),
        (lambda: lazily.analysis(lens, "spot", 0), ValueError, "parts"),
        (lambda: lazily.analysis(lens, "spot", 2, rays=-1).compute(), ValueError, "rays"),
        (lambda: lazily.analysis(lens, "spott", 2).compute(), ValueError, "there is no analysis 'spott'"),
    ):
        with pytest.raises(error, match=words):
            call()


# ------------------------------------------------------------------ two workers


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    distributed = pytest.importorskip(
        "distributed", reason="distributed is not installed (on Debian: apt-get install python3-distributed)"
    )
    dask.config.set({"distributed.scheduler.allowed-failures": 1})
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, host="127.0.0.1", dashboard_address=None, silence_logs=50,
        local_directory=str(tmp_path_factory.mktemp("workers")),
    ) as cluster, distributed.Client(cluster) as client:
        yield client


def test_on_workers(client, tree, rng):
    lens = triplet(tree).set("surfaces[6].thickness", 42.0)
    o, d = rays(rng, 5000, wide=8, steep=0.1)
    traced = lazily.trace(lens, da.from_array(o, (3, 700)), da.from_array(d, (3, 700)), passages="p")
    equal(traced.compute(), lens.trace(o, d, passages="p"))
    hits = lazily.intersect(GYROID, da.from_array(o, (3, 2000)), da.from_array(d, (3, 2000)), of=("status", "t"))
    equal(hits.compute(), GYROID.intersect(o, d, out=sagitta.Hits.empty(5000, "status", "t")))
    x, y, _ = (row for row in lens.trace(o, d).o)
    sums = lazily.sums(sagitta.SpotSums(), da.from_array(x, 300), da.from_array(y, 300), passed=~np.isnan(x))
    assert sums.compute() == sagitta.SpotSums().add(x, y, passed=~np.isnan(x))
    gauss = sagitta.Lens.read(tree / "examples" / "lenses" / "double_gauss.yaml")  # clips, at several wavelengths
    for name, asked in (
        ("spot", dict(pattern="sobol", rays=20000)),
        ("spot", dict(wavelength="all", proof="first", reference="centroid")),
        ("sweep", dict(to=40, steps=3, rays=3)),
        ("ends", dict(wavelength="all", rays=4)),
    ):
        answer, whole = lazily.analysis(gauss, name, 9, **asked).compute(), getattr(gauss, name)(**asked)
        assert answer.rows.tobytes() == whole.rows.tobytes() and (answer.fates, answer.notes) == (whole.fates, whole.notes)


def slowly(lens, name, asked, number, of, *, real=lazily._share):
    time.sleep(0.05)
    return real(lens, name, asked, number, of)


def test_a_worker_is_killed(client, tree, rng, monkeypatch):
    """In the middle, at a random time: what it had or did is done again, with the same answer."""
    lens = triplet(tree)
    monkeypatch.setattr(lazily, "_share", slowly)
    for seed in range(max(1, round(20 * SCALE - 10))):
        asked = dict(pattern="random", rays=20000, seed=seed + 1)
        client.wait_for_workers(2, timeout=150)
        victims = list(client.run(os.getpid).values())
        job = client.compute(lazily.analysis(lens, "spot", 40, **asked))  # (a second)
        time.sleep(rng.uniform(0, 0.9))
        assert not job.done()
        os.kill(rng.choice(victims), signal.SIGKILL)
        assert job.result(timeout=150) == lens.spot(**asked)


def deadly(x, y, z):
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_task_that_kills_its_workers(client):
    """An error that names the task, and no endless search for a worker that bears it."""
    from distributed import KilledWorker

    o = da.from_array(rays(np.random.default_rng(1), 10)[0])
    with pytest.raises(KilledWorker, match="Hits.t"):
        lazily.intersect(sagitta.Function(deadly), o, (0, 0, 1)).t.compute()
