#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a call from Python costs, beside the same from C and beside numpy.

    SAGITTA_PYTHON_LIBRARY=BUILD/python/libsagitta_python.so python3 python/costs.py [--write]

Prints the table of docs/python.md; --write puts it there.  Each figure is processor time of the thread, the
least of several rounds, and rounds of what is compared alternate.

A million rays    out= is given.  "In C": one call of sgt_intersect_batch or sgt_trace_batch, on the same
                  arrays.  (Where arrays stand in memory is worth a tenth of the time.)  More: (Python - C) / C.
One ray           "an empty call of the same kind" is the same method with the library's function replaced by
                  one that returns at once (sagitta_nothing); "of ctypes": that function by itself, with the
                  same arguments.  "`prepare`d": a prepared call of the same.
As arrays         the same call given arrays of shape (3, n), beside a prepared call of the same.
A function        of Python as a surface, 10^5 rays.  numpy: what numpy itself takes to evaluate it at as many
                  points as were asked for, by 10^5 at once; in brackets in arrays as long as those that were
                  asked for, which stay in the processor's cache.
"""
import ctypes
import pathlib
import sys
import time

import numpy as np

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here))

import sagitta  # noqa: E402
import sagitta.surface  # noqa: E402
from sagitta import _library as C  # noqa: E402
from sagitta._arrays import RayArrays  # noqa: E402

BEGIN, END = "<!-- costs -->", "<!-- end of costs -->"
LENS = here.parent / "examples" / "lenses" / "double_gauss.yaml"


def least(call, rounds=7):
    best = float("inf")
    for _ in range(rounds):
        begin = time.thread_time()
        call()
        best = min(best, time.thread_time() - begin)
    return best


def each(call, n=20000):
    """Microseconds a call, without those of the loop."""

    def calls():
        for _ in range(n):
            call()

    def nothing():
        for _ in range(n):
            pass

    return (least(calls) - least(nothing)) / n * 1e6


def million():
    n, rng = 10**6, np.random.default_rng(1)
    o, d = rng.uniform(-1, 1, (3, n)) * 10, rng.uniform(-0.02, 0.02, (3, n))
    o[2], d[2] = -20, 1
    conic, lens = sagitta.Conic(radius=100, conic=-1), sagitta.Lens.read(LENS)
    hits, traced = sagitta.Hits.empty(n), sagitta.Traced.empty(n)
    rays = RayArrays(o, d).struct
    row, before = lens._elements(None)
    intersect, trace = C.library.sgt_intersect_batch, C.library.sgt_trace_batch
    intersect.argtypes = [C.Surface, ctypes.c_size_t, C.Rays, C.Hits, ctypes.c_void_p]
    trace.argtypes = [ctypes.c_size_t, ctypes.c_void_p, ctypes.c_double, ctypes.c_size_t, C.Rays, C.Traced,
                      ctypes.c_void_p, ctypes.c_void_p]
    intersect.restype = trace.restype = ctypes.c_size_t
    of_python = (lambda: conic.intersect(o, d, out=hits), lambda: lens.trace(o, d, out=traced))
    of_c = (
        lambda: intersect(conic._struct, n, rays, hits._struct, None),
        lambda: trace(len(row), ctypes.addressof(row), before, n, rays, traced._struct, None, None),
    )
    best = np.full((2, 2), np.inf)
    for _ in range(20):
        best = np.minimum(best, [[least(call, 3) for call in calls] for calls in (of_python, of_c)])
    for i, name in enumerate(("conic, `intersect`", f"{len(lens)} surfaces, `trace`")):
        yield (
            f"a million rays, {name}",
            f"{best[0, i] * 1e3:.2f} ms",
            f"{best[1, i] * 1e3:.2f} ms in C",
            f"{(best[0, i] / best[1, i] - 1) * 100:+.1f} %",
        )


def one_ray():
    conic, o, d = sagitta.Conic(radius=100, conic=-1), (0, 1, -5), (0, 0, 1)
    a, b = np.array([[0.0], [1], [-5]]), np.array([[0.0], [0], [1]])
    call = conic.prepare(a, b)
    empty, at = C.library.sagitta_nothing, ctypes.byref(C.Call())
    bare = each(lambda: empty(at, at, None, at))
    full, ready = each(lambda: conic.intersect(o, d)), each(call)
    whole = each(lambda: conic.intersect(a, b), 5000)
    real, sagitta.surface._one = sagitta.surface._one, empty
    try:
        same = each(lambda: conic.intersect(o, d))
    finally:
        sagitta.surface._one = real
    yield (
        "one ray, `intersect((0, 1, -5), (0, 0, 1))`",
        f"{full:.2f} us",
        f"{same:.2f} us empty",
        f"{full - same:+.2f} us",
    )
    yield (
        "one ray, `prepare`d",
        f"{ready:.2f} us",
        f"{bare:.2f} us empty, of ctypes",
        f"{ready - bare:+.2f} us",
    )
    yield (
        "one ray as arrays (3, 1), `intersect`",
        f"{whole:.1f} us",
        f"{ready:.2f} us `prepare`d",
        f"{whole - ready:+.1f} us",
    )
    lens = sagitta.Lens.read(LENS)
    for n in (1, 100):
        o, d = np.zeros((3, n)), np.tile([[0.0], [0.1], [1]], n)
        o[1], o[2] = np.linspace(0, 10, n), -20
        whole, ready = each(lambda: lens.trace(o, d), 2000), each(lens.prepare(o, d), 2000)
        yield (
            f"{n} ray{'s' * (n > 1)} as arrays, {len(lens)} surfaces, `trace`",
            f"{whole:.1f} us",
            f"{ready:.1f} us `prepare`d",
            f"{whole - ready:+.1f} us",
        )


def torus(x, y, z):
    q = x * x + y * y
    s = q + z * z + 3.75
    return s * s - 16 * q, 4 * s * x - 32 * x, 4 * s * y - 32 * y, 4 * s * z


def tube(x, y, z):
    rho = np.hypot(x, y)
    u = rho - 2
    return np.hypot(u, z) - 0.5, u * x / rho, u * y / rho, z + 0 * x


def gyroid(x, y, z):
    a, b, c, p, q, r = np.sin(x), np.sin(y), np.sin(z), np.cos(x), np.cos(y), np.cos(z)
    return a * q + b * r + c * p, p * q - c * a, q * r - a * b, r * p - b * c


FORMULAS = {
    "torus, a polynomial": "(x^2 + y^2 + z^2 + 3.75)^2 = 16*(x^2 + y^2)",
    "gyroid, sines and cosines": "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x) = 0",
}
CENTRES = np.random.default_rng(2).uniform(-2, 2, (24, 3))


def blobs(x, y, z):
    """A sum of Gaussians, as surfaces fitted to points have."""
    f, fx, fy, fz = (np.zeros_like(x) for _ in range(4))
    for a, b, c in CENTRES:
        u, v, w = x - a, y - b, z - c
        g = np.exp(-2 * (u * u + v * v + w * w))
        f += g
        g *= -4
        fx += g * u
        fy += g * v
        fz += g * w
    return f - 0.3, fx, fy, fz


def functions():
    n, rng = 10**5, np.random.default_rng(1)
    o, d = rng.uniform(-3, 3, (3, n)), rng.uniform(-0.1, 0.1, (3, n))
    o[2], d[2] = -5, 1
    asked = []
    out = sagitta.Hits.empty(n)
    for name, f, inside in (
        ("torus, a polynomial", torus, 2.6),
        ("torus, by `hypot`", tube, 2.6),
        ("gyroid, sines and cosines", gyroid, 4),
        ("a sum of 24 Gaussians", blobs, 3.5),
    ):

        def counted(x, y, z, f=f):
            asked.append(len(x))
            return f(x, y, z)

        sagitta.Function(counted, inside=inside).intersect(o, d, out=out)
        surface = sagitta.Function(f, inside=inside)
        whole = own = once = float("inf")
        points, most = sum(asked), int(np.average(asked, weights=asked))
        asked.clear()
        x, wide = rng.uniform(-2, 2, (3, most)), rng.uniform(-2, 2, (3, n))
        for _ in range(5):
            whole = min(whole, least(lambda: surface.intersect(o, d, out=out), 2))
            own = min(own, least(lambda: f(*x), 20) / most * points)
            once = min(once, least(lambda: f(*wide), 5) / n * points)
        yield (
            f"{name}: {points / n:.0f} evaluations a ray, {most} at a time",
            f"{whole / n * 1e6:.2f} us a ray",
            f"{once / n * 1e6:.2f} ({own / n * 1e6:.2f}) us in numpy",
            f"{whole / once:.1f} ({whole / own:.1f}) times",
        )
        if name in FORMULAS:
            told = sagitta.Formula(FORMULAS[name], inside=inside)
            doubt = (surface.intersect(o, d).status < 0).mean() * 100
            cost = least(lambda: told.intersect(o, d, out=out), 3)
            yield (
                "the same as a `Formula`",
                f"{cost / n * 1e6:.2f} us a ray",
                f"undecided {(out.status < 0).mean() * 100:.1f} %, as a function {doubt:.0f} %",
                "",
            )


def main(*more):
    rows = [*million(), *one_ray(), *functions()]
    lines = [
        "| | from Python | beside | |",
        "|---|---|---|---|",
        *("| " + " | ".join(r) + " |" for r in rows),
    ]
    text = "\n".join(lines)
    print(text)
    if "--write" in more:
        page = here.parent / "docs" / "python.md"
        before, rest = page.read_text().split(BEGIN)
        page.write_text(f"{before}{BEGIN}\n{text}\n{END}{rest.split(END)[1]}")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
