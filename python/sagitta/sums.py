# SPDX-License-Identifier: MIT
"""Exact sums of rays that come in parts, from threads or machines (sgt_sums of analysis.h).

Parts of any size, in any order, added one by one or merged, make the same bits: each sum is exact, and rounded
once when the answer is asked for.  A pickle has the bytes of sgt_sums_write, some 500, whatever the number of rays.
"""
from __future__ import annotations

import ctypes
import struct
from dataclasses import dataclass
from typing import Any, Optional, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _library as C
from ._arrays import address, doubles
from ._tables import Floats, Named

_SPOT, _WAVEFRONT = 1, 2


@dataclass(eq=False)
class Spot(Named):
    """The spot of some rays (sgt_spot).

    rays, passed    how many were added; those that passed count
    x, y            the reference: distances are from here
    rms             root of the weighted mean of their squares; rms_x, rms_y of one coordinate
    geometric       the largest; NaN about the centroid, which needs the rays once more
    error           a bound on what rounding does to rms
    """

    rays: int
    passed: int
    x: float
    y: float
    rms: float
    rms_x: float
    rms_y: float
    geometric: float
    error: float


@dataclass(eq=False)
class Wavefront(Named):
    """Path differences of some rays (sgt_wavefront): weighted mean, root of the mean square about it, the least and
    the largest, and a bound on what rounding does to each of these numbers."""

    rays: int
    passed: int
    mean: float
    rms: float
    least: float
    most: float
    error: float


Some = TypeVar("Some", bound="_Sums")


class _Sums:
    """What both kinds have.  One thread at a time may add to it; different sums share nothing."""

    _kind = 0

    def __init__(self, about: tuple[float, float] = (0.0, 0.0)) -> None:
        C.check_arithmetic()
        self._begin(C.library.sgt_sums_new(self._kind, C.Pair(*(float(x) + 0.0 for x in about)), None))

    def _begin(self, pointer: Optional[int]) -> None:
        if not pointer:
            raise MemoryError("sagitta: no memory")
        self._pointer = pointer

    def __del__(self, free: Any = C.library.sgt_sums_free) -> None:
        if getattr(self, "_pointer", None):
            free(self._pointer)

    def empty(self: Some) -> Some:
        """Sums of the same kind, about the same point, with nothing in them."""
        new = type(self).__new__(type(self))
        about = struct.unpack_from("<2d", bytes(self), 24)  # the fourth number and the fifth (sums_bytes.c)
        new._begin(C.library.sgt_sums_new(self._kind, C.Pair(*about), None))
        return new

    def _add(self: Some, points: dict[str, ArrayLike], weight: Any, error: Any, passed: Any) -> Some:
        C.check_arithmetic()
        given = {name: doubles(x, name) for name, x in points.items()}
        given.update(weight=doubles(weight, "weight"), error=doubles(error, "error"))
        through = np.asarray(passed)
        if through.dtype != np.bool_:
            raise TypeError(f"passed: must be True or False for each ray, not {through.dtype}")
        *columns, through = np.broadcast_arrays(*given.values(), through)
        kept: list[Floats] = [np.ascontiguousarray(a).ravel() for a in columns]
        flags: NDArray[Any] = np.ascontiguousarray(through).ravel()
        there = C.Summands(n=flags.size, passed=address(flags), **dict(zip(given, map(address, kept))))
        C.library.sagitta_sums_add(self._pointer, ctypes.byref(there))
        return self

    def merge(self: Some, more: Some) -> Some:
        """Adds all that `more` has, which stays as it is; returns these sums."""
        if type(more) is not type(self):
            raise TypeError(f"merge: must be {type(self).__name__}, not {type(more).__name__}")
        if not C.library.sgt_sums_merge(self._pointer, more._pointer):
            raise ValueError("merge: the other sums are about another point")
        return self

    def __iadd__(self: Some, more: Some) -> Some:
        return self.merge(more)

    def __add__(self: Some, more: Some) -> Some:
        return self.empty().merge(self).merge(more)

    def __bytes__(self) -> bytes:
        """As sgt_sums_write has them: the same on every system, with a version and a checksum."""
        room = ctypes.create_string_buffer(C.library.sgt_sums_write(self._pointer, 0, None))
        C.library.sgt_sums_write(self._pointer, len(room), room)
        return room.raw

    @classmethod
    def of_bytes(cls: type[Some], of: bytes, name: str = "sums") -> Some:
        """Sums of such bytes.  `name` is what an error calls them."""
        error, self = C.Error(), cls.__new__(cls)
        pointer = C.library.sgt_sums_read(name.encode(), len(of), bytes(of), None, ctypes.byref(error))
        if not pointer:
            raise ValueError(f"{name}: {C.text(error.words)}")
        self._begin(pointer)
        kind = int.from_bytes(of[16:24], "little")  # the third number (sums_bytes.c)
        if kind != cls._kind:
            raise ValueError(f"{name}: not {cls.__name__}, but sums of the other kind")
        return self

    def __reduce__(self) -> Any:
        return type(self).of_bytes, (bytes(self),)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, type(self)):
            return NotImplemented
        return bytes(self) == bytes(other)

    __hash__ = None  # type: ignore[assignment]


class SpotSums(_Sums):
    """Sums of points, about a given one.

    >>> import pickle, sagitta
    >>> a, b = sagitta.SpotSums(), sagitta.SpotSums()
    >>> spot = a.add([3, -3], [4, -4]).merge(pickle.loads(pickle.dumps(b.add(0, [0, 5])))).spot()
    >>> spot.rays, spot.rms_y, spot.geometric
    (4, 3.774917217635375, 5.0)
    >>> a.spot(centroid=True).y
    1.25
    """

    _kind = _SPOT

    def add(
        self, x: ArrayLike, y: ArrayLike, weight: ArrayLike = 1.0, error: ArrayLike = 0.0, passed: ArrayLike = True
    ) -> "SpotSums":
        """Adds rays: where each ended, how far rounding may have moved that (p_err), and whether it passed.  A ray that
        did not is counted among `rays` and no more.  Arrays are broadcast.  Returns the sums."""
        return self._add({"x": x, "y": y}, weight, error, passed)

    def spot(self, centroid: bool = False) -> Spot:
        """What the rays so far make, about the given point, or about their centroid."""
        out = C.library.sgt_sums_spot(self._pointer, bool(centroid))
        x, y = out.reference
        return Spot(out.rays, out.passed, x, y, out.rms, out.rms_x, out.rms_y, out.geometric, out.error)


class WavefrontSums(_Sums):
    """Sums of path differences.

    >>> import sagitta
    >>> sums = sagitta.WavefrontSums().add([0.25, 0.75])
    >>> sums.wavefront().mean, sums.wavefront().rms
    (0.5, 0.25)
    """

    _kind = _WAVEFRONT

    def __init__(self) -> None:
        super().__init__()

    def add(
        self, opd: ArrayLike, weight: ArrayLike = 1.0, error: ArrayLike = 0.0, passed: ArrayLike = True
    ) -> "WavefrontSums":
        """Adds rays: their path differences, and what rounding may have done to each.  A ray that has not passed, or
        whose difference is NaN, is counted among `rays` and no more.  Returns the sums."""
        return self._add({"opd": opd}, weight, error, passed)

    def wavefront(self) -> Wavefront:
        """What the rays so far make."""
        out = C.library.sgt_sums_wavefront(self._pointer)
        return Wavefront(out.rays, out.passed, out.mean, out.rms, out.least, out.most, out.error)


__all__ = ["Spot", "SpotSums", "Wavefront", "WavefrontSums"]
