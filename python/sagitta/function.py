# SPDX-License-Identifier: MIT
"""A function of Python as a surface."""
from __future__ import annotations

import ctypes
import threading
from typing import Any, Callable, Hashable, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _library as C
from ._arrays import doubles
from ._tables import Floats
from .surface import Surface

Inside = Union[None, float, Sequence[Any], dict[str, Any]]


def _at(where: int, rows: int, n: int, stride: int) -> Floats:
    """rows of n numbers that stand there."""
    # (ctypes makes a type for each length, and keeps it.  So it is one type, and numpy is told how many.)
    return np.frombuffer(_most.from_address(where), np.float64, rows * stride).reshape(rows, stride)[:, :n]


_most: Any = ctypes.c_double * (1 << 40)


def ball_and_box(inside: Inside) -> tuple[float, Floats, Floats]:
    """A radius, or two corners, or {"ball": ..., "box": ...}; zeros: none."""
    ball, box = 0.0, np.zeros((2, 3))
    parts = (
        inside
        if isinstance(inside, dict)
        else {}
        if inside is None
        else ({"ball": inside} if np.ndim(inside) == 0 else {"box": inside})
    )
    for name in parts:
        if name not in ("ball", "box"):
            raise ValueError(f"inside: unknown word {name!r}; it may have ball and box")
    if parts.get("ball") is not None:
        ball = float(doubles(parts["ball"], "inside: ball"))
        if not (ball > 0 and np.isfinite(ball)):
            raise ValueError(f"inside: the radius of the ball must be above 0, not {ball}")
    if parts.get("box") is not None:
        box = doubles(parts["box"], "inside: box")
        if box.shape == (3,):
            box = np.array([-box, box])
        if box.shape != (2, 3) or not np.isfinite(box).all() or not (box[0] < box[1]).all():
            raise ValueError(
                "inside: the box must be two corners, ((x, y, z), (x, y, z)), the first below the "
                "second, or three half sides"
            )
    return ball, box[0], box[1]


def ball_key(inside: Inside) -> Hashable:
    ball, lo, hi = ball_and_box(inside)
    return ball, tuple(lo.tolist()), tuple(hi.tolist())


class Function(Surface):
    """The surface F(x, y, z) = 0 of a function of Python.

    values      called with arrays x, y, z of one length.  Returns F, or (F, Fx, Fy, Fz) with its gradient.
                NaN: F is not defined there.  Without a gradient it is taken by differences, for which
                `values` is asked at seven times as many points; the gradient is then good to some 1e-10
    inside      where rays are searched: the radius of a ball about the origin, two corners of a box, or
                {"ball": ..., "box": ...}.  Rays that pass it miss.  None: everywhere
    rounding    a bound on the error of F as computed: a number, or a function of x, y, z
    clearance   a function of x, y, z: a radius about the point in which the surface certainly is not
    enclose     a function (o, d, lo, hi), with o, d of shape (3, n) and lo, hi of (n,).  Returns four arrays:
                bounds on F over [lo, hi] of each ray, and on its slope along the ray.  With it, and finite
                ends (`inside`, or `tmax`), a miss is certain, and proofs can be had (sagitta.h, `enclose`)
    name        for messages

    What is promised of the answers is what sagitta.h says of a user's surface: without `clearance` and
    `enclose` a march may step over two roots that are close together.

    The functions are called for some thousand points at a time, from the thread that asks.  If one raises,
    the call ends and raises the same: what `out` holds is then STOPPED and NaN.

    >>> import numpy as np, sagitta
    >>> def bowl(x, y, z):
    ...     return z - 0.1 * (x*x + y*y), -0.2 * x, -0.2 * y, np.ones_like(z)
    >>> sagitta.Function(bowl, inside=20).intersect((1, 0, -5), (0, 0, 1)).p
    array([1. , 0. , 0.1])
    """

    def __init__(
        self,
        values: Callable[..., Any],
        *,
        inside: Inside = None,
        rounding: Union[None, float, Callable[..., Any]] = None,
        clearance: Optional[Callable[..., Any]] = None,
        enclose: Optional[Callable[..., Any]] = None,
        name: Optional[str] = None,
    ) -> None:
        for word, f in (("values", values), ("clearance", clearance), ("enclose", enclose)):
            if f is not None and not callable(f) or (f is None and word == "values"):
                raise TypeError(f"{word}: must be a function, not {type(f).__name__}")
        constant = -1.0
        if rounding is not None and not callable(rounding):
            constant = float(doubles(rounding, "rounding"))
            if not constant >= 0:
                raise ValueError(f"rounding: must not be negative, not {constant}")
        self.values, self.rounding, self.clearance, self.enclose = values, rounding, clearance, enclose
        self.inside, self.name = inside, name or getattr(values, "__name__", "function")
        ball, lo, hi = ball_and_box(inside)
        self._functions = (self,)
        self._raised: dict[int, BaseException] = {}
        # By weak reference: the callback is kept by this object, and must not keep it.
        import weakref

        me = weakref.ref(self)
        self._asker = C.Asker(lambda what, n, stride, given, out: _answer(me, what, n, stride, given, out))
        memory = ctypes.create_string_buffer(C.library.sagitta_function_size())
        answers = ((callable(rounding), C.ROUNDING), (clearance, C.CLEARANCE), (enclose, C.ENCLOSE))
        C.library.sagitta_function_begin(
            ctypes.addressof(memory),
            self._asker,
            ball,
            C.Vector(*lo),
            C.Vector(*hi),
            constant,
            sum(1 << what for f, what in answers if f),
        )
        self._set(ctypes.addressof(memory), memory)

    def __setattr__(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)  # (a class of a user's may have members of its own)

    def _key(self) -> Hashable:
        return self.values, self.rounding, self.clearance, self.enclose, ball_key(self.inside)

    def __reduce__(self) -> Any:
        return _again, (
            self.values,
            dict(
                inside=self.inside,
                rounding=self.rounding,
                clearance=self.clearance,
                enclose=self.enclose,
                name=self.name,
            ),
        )

    def __repr__(self) -> str:
        return f"Function({self.name})"

    def _reply(self, what: int, x: Floats, out: Floats) -> None:
        n = x.shape[1]
        if what in (C.VALUE, C.VALUE_GRAD):
            answer = self.values(x[0], x[1], x[2])
            if not isinstance(answer, tuple):
                _put(out[0], answer, "values", n)
                if what == C.VALUE_GRAD:
                    self._differences(x, out)
                return
            if len(answer) != 4:
                raise ValueError(f"values: must return F or (F, Fx, Fy, Fz), not {len(answer)} arrays")
            for row, part in zip(out, answer):
                _put(row, part, "values", n)
        elif what == C.ENCLOSE:
            assert self.enclose is not None
            answer = self.enclose(x[0:3], x[3:6], x[6], x[7])
            if not isinstance(answer, tuple) or len(answer) != 4:
                raise ValueError("enclose: must return four arrays: F from, F to, slope from, slope to")
            for row, part in zip(out, answer):
                _put(row, part, "enclose", n)
        else:
            f: Any = self.rounding if what == C.ROUNDING else self.clearance
            word = "rounding" if what == C.ROUNDING else "clearance"
            _put(out[0], f(x[0], x[1], x[2]), word, n)

    def _differences(self, x: Floats, out: Floats) -> None:
        """Central differences with the step at which rounding and the third derivative do equal harm."""
        n = x.shape[1]
        h = 6e-6 * np.maximum(np.abs(x).max(axis=0), 1e-300)
        points = np.repeat(x[:, None, :], 6, axis=1)
        for k in range(3):
            points[k, 2 * k] += h
            points[k, 2 * k + 1] -= h
        f = np.empty(6 * n)
        _put(f, self.values(*points.reshape(3, 6 * n)), "values", 6 * n)
        f = f.reshape(6, n)
        for k in range(3):
            out[k + 1] = (f[2 * k] - f[2 * k + 1]) / (points[k, 2 * k] - points[k, 2 * k + 1])


def _put(row: Floats, answer: Any, word: str, n: int) -> None:
    a = np.asarray(answer)
    if a.dtype.kind not in "fiu":
        raise TypeError(f"{word}: must return real numbers, not {a.dtype}")
    if a.shape not in ((n,), ()):
        raise ValueError(f"{word}: must return arrays of {n} numbers, like x; not of the shape {a.shape}")
    row[...] = a


def _answer(me: Any, what: int, n: int, stride: int, given: int, out: int) -> int:
    """What the library asks.  Nothing may be raised into C: it is kept, and raised when the call is over."""
    self = me()
    try:
        rows_in, rows_out = C.ROWS[what]
        # A copy: whoever keeps x, y, z has to find them there tomorrow.
        x = _at(given, rows_in, n, stride).copy()
        answer = _at(out, rows_out, n, stride)
        with np.errstate(all="ignore"):  # NaN is "not defined here"
            self._reply(what, x, answer)
        return 0
    except BaseException as error:  # KeyboardInterrupt too
        if self is not None:
            self._raised[threading.get_ident()] = error
        return 1


def _again(values: Any, given: dict[str, Any]) -> Function:
    return Function(values, **given)
