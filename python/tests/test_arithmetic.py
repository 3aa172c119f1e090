# SPDX-License-Identifier: MIT
"""A host that has changed the arithmetic is refused, in whichever thread."""
import ctypes
import platform
import threading

import pytest

import sagitta

# fesetenv and its kin by the C library: the control word alone, for x86-64, is set by a page of code.
x86 = pytest.mark.skipif(
    platform.machine() not in ("x86_64", "AMD64"), reason="sets the control word of x86-64"
)
FLUSH, DENORMALS, UP = 1 << 15, 1 << 6, 2 << 13


class Control:
    """The control word of the processor, through fegetenv and fesetenv: mxcsr is the last word of fenv_t."""

    def __init__(self, bits):
        self.libm, self.bits = ctypes.CDLL("libm.so.6"), bits

    def __enter__(self):
        self.before = (ctypes.c_uint32 * 8)()
        self.libm.fegetenv(self.before)
        changed = (ctypes.c_uint32 * 8)(*self.before)
        changed[7] |= self.bits
        self.libm.fesetenv(changed)

    def __exit__(self, *_):
        self.libm.fesetenv(self.before)


@x86
@pytest.mark.parametrize(
    "bits, says", [(FLUSH, "flush-to-zero"), (DENORMALS, "denormals-are-zero"), (UP, "not to nearest")]
)
def test_it_is_refused(bits, says):
    ball, o, d = sagitta.Sphere(radius=10), [[0.0] * 4, [0.0] * 4, [-5.0] * 4], (0, 0, 1)
    lens = sagitta.Lens([sagitta.Element(ball)], pupil={"semi_diameter": 1})
    hits, call, trace = ball.intersect(o, d), ball.prepare(o, d), lens.prepare(o, d)
    passage, room = lens.trace(o, d, passages=True).passages[0], sagitta.Traced.empty(4)
    said = []
    with Control(bits):
        for use in (
            lambda: ball.intersect((0, 0, -5), d),
            lambda: ball.intersect(o, d),
            call,
            lambda: ball.intersect_all(o, d),
            lambda: ball.differentiate(o, d, hits),
            lambda: ball.diagnose((0, 0, -5), d),
            lambda: ball.check(o, d, tmax=9),
            lambda: ball.intersect(o, d, threads=2, out=hits),
            trace,
            lambda: lens.trace(o, d),
            lambda: lens.trace(o, d, passages=True),
            lambda: lens.trace(o, d, passages=("p",), threads=2),
            lambda: lens.trace(o, d, out=room),
            lambda: passage.t,
            lambda: lens.sensitivity(o, d),
            lens.first_order,
            lens.spot,
            lens.launch,
            lens.seidel,
            lens.parabasal,
            lambda: sagitta.Lens([sagitta.Element(ball)]),
            lambda: lens.aim(0, (0, 0), sagitta.Beam((0, 0, -5), d)),
        ):
            try:
                use()
                said.append("nothing was raised")
            except sagitta.ArithmeticFault as fault:
                said.append(str(fault))
    assert all(says in text for text in said), said
    assert ball.intersect((0, 0, -5), d).t == 5
    assert call() == trace() == 4 and (passage.t == 5).all()


@x86
def test_another_thread_is_not_this_one():
    ball, results = sagitta.Sphere(radius=10), []

    def work():
        with Control(FLUSH):
            try:
                results.append(ball.intersect((0, 0, -5), (0, 0, 1)))
            except sagitta.ArithmeticFault:
                results.append("refused")

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert results == ["refused"] and ball.intersect((0, 0, -5), (0, 0, 1)).met
