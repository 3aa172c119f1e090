#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What a call from Python costs: arrays of one ray, of a hundred, of 10^5; passages; prepared calls.

    SAGITTA_PYTHON_LIBRARY=BUILD/python/libsagitta_python.so python3 tests/bench/python_costs.py
        --rounds N        how often each row is timed (25)
        --package FOLDER  the package of another tree, with its library in SAGITTA_PYTHON_LIBRARY

One ray: microseconds a call.  More: nanoseconds a ray.  Times are processor time of the thread.  All rows of
a size are timed in turn, N times, and the median is told: what else the machine does falls on all of them.
The lens is examples/lenses/cooke_triplet.yaml, 7 elements; the surface is a conic.

library     the same in the library alone: a prepared call less an empty call by ctypes
over it     what Python adds to that; for passages, times the plain trace of the same round
to reach    of the same unit as the first column, or "x" times plain

"read": an array of that name is read, of each element.  passages=True finds status, p and opl in the trace,
and the others in one more trace when they are read (docs/python.md).
"""
import argparse
import ctypes
import pathlib
import statistics
import sys
import time

import numpy as np

TREE = pathlib.Path(__file__).resolve().parent.parent.parent
LENS = TREE / "examples" / "lenses" / "cooke_triplet.yaml"


def timed(calls, rounds, repeats):
    """The medians of nanoseconds a call; None: it cannot be made."""
    took = {}
    for name, call in calls.items():
        try:
            call()
            took[name] = []
        except (TypeError, ValueError, AttributeError):
            pass  # a package without it
    for _ in range(rounds):
        for name in took:
            call = calls[name]
            begin = time.thread_time_ns()
            for _ in range(repeats):
                call()
            took[name].append((time.thread_time_ns() - begin) / repeats)
    return {name: statistics.median(took[name]) if name in took else None for name in calls}


def rays(n):
    rng = np.random.default_rng(1)
    o, d = rng.uniform(-3, 3, (3, n)), rng.uniform(-0.02, 0.02, (3, n))
    o[2], d[2] = -20, 1
    return o, d


def empty_call(C):
    call = ctypes.CDLL(C.library._name)["sagitta_nothing"]
    call.argtypes, call.restype = [ctypes.c_void_p], ctypes.c_int
    at = ctypes.byref(C.Call())
    return lambda: call(at)


def shown(name, took, library="", over="", goal=""):
    print(f"| {name:48} | {took:>10} | {library:>8} | {over:>8} | {goal:>5} |")


def small(sagitta, C, lens, conic, n, rounds):
    o, d = rays(n)
    hits, ends = sagitta.Hits.empty(n), sagitta.Traced.empty(n)
    # (Without out=, an older package makes ten arrays of the answer.)
    calls = {
        "ctypes, an empty call": empty_call(C),
        "intersect": lambda: conic.intersect(o, d),
        "intersect, p read": lambda: conic.intersect(o, d).p,
        "intersect, out=": lambda: conic.intersect(o, d, out=hits),
        "intersect, prepared": conic.prepare(o, d),
        "trace": lambda: lens.trace(o, d),
        "trace, opl read": lambda: lens.trace(o, d).opl,
        "trace, out=": lambda: lens.trace(o, d, out=ends),
        "trace, prepared": lens.prepare(o, d) if hasattr(lens, "prepare") else None,
        'trace, passages=("p", "opl")': lambda: lens.trace(o, d, passages=("p", "opl")),
        "trace, passages=True": lambda: lens.trace(o, d, passages=True),
    }
    took = timed({k: v or (lambda: getattr(lens, "prepare")) for k, v in calls.items()}, rounds, 300)
    bare = took["ctypes, an empty call"]
    for name, t in took.items():
        what = f"{n} ray{'s' * (n > 1)}, {name}"
        if t is None:
            shown(what, "not there")
            continue
        ready = took.get(name.split(",")[0] + ", prepared")
        plain = name.startswith(("intersect", "trace")) and "passages" not in name
        inside = ready - bare if ready and plain else None

        def told(x):
            return f"{x / 1e3:.2f}" if n == 1 else f"{x / n:.1f}"

        shown(
            what,
            told(t) + (" us" if n == 1 else " ns"),
            told(inside) if inside else "",
            told(t - inside) if inside else "",
            ("5" if n == 1 else "100") if plain else "",
        )


def many(sagitta, C, lens, conic, n, rounds):
    o, d = rays(n)
    every = tuple(sagitta.Passage.FIELDS)
    hits, ends = sagitta.Hits.empty(n), sagitta.Traced.empty(n)

    def read(names):
        return lambda: [getattr(p, x) for p in lens.trace(o, d, passages=True).passages for x in names]

    def named(*names):
        def call():
            traced = lens.trace(o, d, passages=names)
            if hasattr(traced.passages[0], "n") and "n" not in names:
                raise TypeError("an older package takes any names for True")

        return call

    calls = {
        "intersect": lambda: conic.intersect(o, d),
        "intersect, out=": lambda: conic.intersect(o, d, out=hits),
        "trace": lambda: lens.trace(o, d),
        "trace, out=": lambda: lens.trace(o, d, out=ends),
        'trace, passages=("p", "opl")': named("p", "opl"),
        'trace, passages=("p", "direction")': named("p", "direction"),
        "trace, all passages by their names": named(*every),
        "trace, passages=True": lambda: lens.trace(o, d, passages=True),
        "the same, p and opl read": read(("p", "opl")),
        "the same, p, direction and t read": read(("p", "direction", "t")),
        "the same, all of it read": read(every),
    }
    took = timed(calls, rounds, 2)
    for name, t in took.items():
        if t is None:
            shown(f"{n} rays, {name}", "not there")
            continue
        times = name.startswith(("trace, p", "trace, all", "the same"))
        shown(
            f"{n} rays, {name}",
            f"{t / n:.1f} ns",
            "",
            f"{t / took['trace']:.2f} x" if times else "",
            "2 x" if name in ("trace, passages=True", "the same, p and opl read") else "",
        )


def main():
    asked = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    asked.add_argument("--rounds", type=int, default=25)
    asked.add_argument("--package", default=str(TREE / "python"))
    asked = asked.parse_args()
    sys.path.insert(0, asked.package)
    import sagitta
    from sagitta import _library as C

    lens, conic = sagitta.Lens.read(LENS), sagitta.Conic(radius=100, conic=-1)
    shown("", "a call, ray", "library", "over it", "to reach")
    print("|---|---|---|---|---|")
    for n in (1, 100):
        small(sagitta, C, lens, conic, n, asked.rounds)
    many(sagitta, C, lens, conic, 10**5, asked.rounds)
    return 0


if __name__ == "__main__":
    sys.exit(main())
