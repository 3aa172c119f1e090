# SPDX-License-Identifier: MIT
"""What the library answers: arrays with one number for each ray."""
from __future__ import annotations

import ctypes
import enum
import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Iterator, Optional, Sequence, Union

import numpy as np
from numpy.typing import NDArray

from . import _library as C
from ._arrays import LARGE, Columns, Shape, address, places_of
from ._tables import Floats, Named, alike

_pack_hits, _pack_traced, _pack_passages = map(C.packer, (C.Hits, C.Traced, C.Passages))


class Status(enum.IntEnum):
    """Above 0: met.  0: certainly not met.  Below 0: undecided (sagitta.h, sgt_status)."""

    HIT = 1
    GRAZE = 2
    MISS = 0
    UNPROVEN = -1
    UNDEFINED = -2
    EXHAUSTED = -3
    STOPPED = -4
    INVALID = -5


class Fate(enum.IntEnum):
    """What became of a ray at an element (system.h, sgt_fate)."""

    PASSED = 1
    CLIPPED = 2
    TIR = 3
    EVANESCENT = 4
    MISSED = 0
    LOST = -1


class Aimed(enum.IntEnum):
    """What became of an aim (aim.h, sgt_aimed)."""

    MET = 1
    NO_SUCH_RAY = 0
    UNDECIDED = -1
    INVALID = -2


class Hit(ctypes.Structure):
    """One ray and one surface.

    status, evals   how it ended (Status), and how many evaluations of F that took
    t, t_err        the root lies within t_err of t, in lengths of d
    t_lo            t + t_lo is nearer to it still
    lo, hi          the stretch of the ray that the status is about
    f, p, n         F, the point, and the gradient there (not of unit length)
    p_err           the surface is within p_err of p

    Two are equal if all of this is; a NaN is equal to a NaN.  One that is taken out of Hits has what these
    have: lo, hi and f are NaN, and so is what was not asked for (evals: -1).
    """

    _fields_ = [
        ("status", ctypes.c_byte),
        ("evals", ctypes.c_int),
        ("t", ctypes.c_double),
        ("t_err", ctypes.c_double),
        ("t_lo", ctypes.c_double),
        ("lo", ctypes.c_double),
        ("hi", ctypes.c_double),
        ("f", ctypes.c_double),
        ("_p", C.Vector),
        ("_n", C.Vector),
        ("p_err", ctypes.c_double),
        ("_reserved", C.Words * 2),
    ]
    status: int
    evals: int
    t: float
    t_err: float
    t_lo: float
    lo: float
    hi: float
    f: float
    p_err: float

    @property
    def p(self) -> Floats:
        return np.array(self._p)

    @property
    def n(self) -> Floats:
        return np.array(self._n)

    @property
    def met(self) -> bool:
        return self.status > 0

    @property
    def text(self) -> str:
        """The status as a word: "hit", "miss" ..."""
        return C.text(C.library.sgt_status_text(self.status))

    def __repr__(self) -> str:
        at = f", t = {self.t!r} +- {self.t_err:.1g}" if self.met else ""
        return f"<{type(self).__name__}: {self.text}{at}>"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Hit) or type(self) is not type(other):
            return NotImplemented
        return all(alike(a, b) for a, b in zip(self._all(), other._all()))

    __hash__ = None  # type: ignore[assignment]

    @classmethod
    def _members(cls) -> list[tuple[str, Any]]:
        """What it has, and the types of ctypes: of a subclass all of it."""
        return [member for of in cls.__mro__ for member in of.__dict__.get("_fields_", ())]

    def _all(self) -> list[Any]:
        values = [getattr(self, name) for name, _ in self._members()]
        return [np.array(x) if isinstance(x, ctypes.Array) else x for x in values]


class Crossing(Hit):
    """One ray of Crossings: a Hit, and `side`."""

    _fields_ = [("side", ctypes.c_byte)]
    side: int


class Passed(Hit):
    """One ray of a Passage: a Hit, `direction` and `opl`."""

    _fields_ = [("_direction", C.Vector), ("opl", ctypes.c_double)]
    opl: float

    @property
    def direction(self) -> Floats:
        return np.array(self._direction)


class Hits(Columns[Hit]):
    """Many rays and one surface: an array for each number.

    status (int8), evals (int32), t, t_err, t_lo, p_err: (n,).  p, n: (3, n), or (n, 3) if the rays came so.
    Of rays in more axes (ny, nx), and (3, ny, nx) or (ny, nx, 3).

    `Hits.empty(1000)` makes room for 1000 rays, to be given as out= to any number of calls;
    `Hits.empty(1000, "status", "t")` for these numbers only, which is faster; `Hits.empty((ny, nx))` for rays
    of that shape.  `Hits(t=a, p=b)` takes arrays of yours: doubles (status: int8, evals: int32), (n,) and
    (3, n), contiguous and writable.

    >>> import sagitta
    >>> hits = sagitta.Sphere(10).intersect([[0, 0], [0, 6], [-5, -5]], (0, 0, 1))
    >>> [hit.t for hit in hits], hits["t"], hits.keys()[:3]
    ([5.0, 7.0], array([5., 7.]), ('status', 'evals', 't'))
    """

    FIELDS = {
        "status": ("i1", 1),
        "evals": ("i4", 1),
        "t": ("f8", 1),
        "t_err": ("f8", 1),
        "t_lo": ("f8", 1),
        "p": ("f8", 3),
        "n": ("f8", 3),
        "p_err": ("f8", 1),
    }
    status: NDArray[np.int8]
    evals: NDArray[np.int32]
    t: Floats
    t_err: Floats
    t_lo: Floats
    p: Floats
    n: Floats
    p_err: Floats

    @classmethod
    def empty(cls, n: Union[int, Shape], *fields: str) -> "Hits":
        result: Hits = cls._make(n, fields)
        return result

    _HIT = Hit

    def _one(self, k: int) -> Hit:
        names, kind_of_hit = self._names, self._HIT
        if "status" not in names:
            said = f"a {kind_of_hit.__name__} has a status, which was not asked for; there are "
            raise ValueError(said + ", ".join(names))
        hit = kind_of_hit(evals=-1)
        for name, kind in kind_of_hit._members():
            bare = name.lstrip("_")
            if bare in names:
                value = self._row_of(bare, k)
                setattr(hit, name, tuple(value) if isinstance(value, list) else value)
            elif kind is ctypes.c_double:
                setattr(hit, name, np.nan)
            elif kind is C.Vector:
                setattr(hit, name, (np.nan,) * 3)
        return hit

    def _fill(self) -> C.Hits:
        return C.Hits.from_buffer_copy(_pack_hits(*self._pointers()))

    def _pointers(self) -> tuple[int, ...]:
        at = self._at
        first = (at("status"), at("evals"), at("t"), at("t_err"), at("t_lo"))
        return (*first, *self._three("p"), *self._three("n"), at("p_err"), 0, 0)

    def _hits_struct(self) -> C.Hits:
        struct: C.Hits = self._struct
        return struct

    @property
    def met(self) -> NDArray[np.bool_]:
        """Where the status is above 0."""
        result: NDArray[np.bool_] = self.status > 0
        return result


class Crossings(Hits):
    """What Surface.leave() answers: Hits, and

    side    (int8) the sign of F between the start and the next crossing, where F > 0 is outside of a body and
            above a sag.  0: it cannot be told, or the status is below 0
    """

    FIELDS = {**Hits.FIELDS, "side": ("i1", 1)}
    side: NDArray[np.int8]

    @classmethod
    def empty(cls, n: Union[int, Shape], *fields: str) -> "Crossings":
        result: Crossings = cls._make(n, fields)
        return result

    _HIT = Crossing

    if TYPE_CHECKING:

        def __iter__(self) -> Iterator[Crossing]: ...


HIT_TABLE = np.dtype(
    [
        ("status", "i1"),
        ("evals", "i4"),
        ("t", "f8"),
        ("t_err", "f8"),
        ("t_lo", "f8"),
        ("lo", "f8"),
        ("hi", "f8"),
        ("f", "f8"),
        ("p", "f8", (3,)),
        ("n", "f8", (3,)),
        ("p_err", "f8"),
        ("reserved_", "u8", (2,)),
    ],
    align=True,
)

STEP_TABLE = np.dtype(
    [
        ("ray", "u8"),
        ("eval", "i4"),
        ("move", "i4"),
        ("kind", "i4"),
        ("t", "f8"),
        ("f", "f8"),
        ("slope", "f8"),
        ("lo", "f8"),
        ("hi", "f8"),
        ("f_lo", "f8"),
        ("f_hi", "f8"),
        ("slope_lo", "f8"),
        ("slope_hi", "f8"),
        ("reserved_", "u8", (4,)),
    ],
    align=True,
)


@dataclass(eq=False)
class End(Named):
    """One ray of Traced: fate (Fate), passed, o and d (3,), opl.  None, or NaN: it was not asked for."""

    fate: Optional[Fate]
    passed: Optional[int]
    o: Floats
    d: Floats
    opl: float

    @property
    def through(self) -> bool:
        """The ray passed all elements."""
        return self.fate == Fate.PASSED


class Traced(Columns[End]):
    """Many rays through a lens, and how they left it.

    fate (int8, Fate), passed (int32: how many elements), opl: (n,).  o, d: the ray at its end, global, (3,
    n), or (n, 3) if the rays came so; d is of unit length.  Of rays in more axes (ny, nx), and (3, ny, nx) or
    (ny, nx, 3).  If it was asked for, `passages` has a Passage for each element, in its own frame.
    """

    FIELDS = {"fate": ("i1", 1), "passed": ("i4", 1), "o": ("f8", 3), "d": ("f8", 3), "opl": ("f8", 1)}
    fate: NDArray[np.int8]
    passed: NDArray[np.int32]
    o: Floats
    d: Floats
    opl: Floats
    _passages: "Union[list[Passage], Room]" = []

    @classmethod
    def empty(
        cls, n: Union[int, Shape], *fields: str, passages: int = 0, of_passages: Sequence[str] = ()
    ) -> "Traced":
        """Room for n rays.  `passages`: for as many elements, and of each the numbers `of_passages`; (): all."""
        result: Traced = cls._make(n, fields)
        result.passages = [Passage.empty(n, *of_passages) for _ in range(passages)]
        return result

    @property
    def passages(self) -> "list[Passage]":
        found = self._passages
        if isinstance(found, Room):
            self._passages = found = found.made()
        return found

    @passages.setter
    def passages(self, given: "Sequence[Passage]") -> None:
        self._passages = list(given)

    def _fill(self) -> C.Traced:
        at = self._at
        return C.Traced.from_buffer_copy(
            _pack_traced(at("fate"), at("passed"), *self._three("o"), *self._three("d"), at("opl"), 0, 0)
        )

    def __getstate__(self) -> dict[str, Any]:
        return {**super().__getstate__(), "passages": self.passages}

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        self.passages = state["passages"]

    def _one(self, k: int) -> End:
        has = {name: np.array(self._row_of(name, k)) if self.FIELDS[name][1] > 1 else self._row_of(name, k)
               for name in self._names}
        fate = has.get("fate")
        return End(None if fate is None else Fate(fate), has.get("passed"), has.get("o", np.full(3, np.nan)),
                   has.get("d", np.full(3, np.nan)), has.get("opl", np.nan))

    def _some(self, at: NDArray[Any]) -> "Traced":
        new = super()._some(at)
        new.passages = [p._some(at) for p in self.passages]
        return new

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Traced):
            return NotImplemented
        return super().__eq__(other) is True and self.passages == other.passages

    __hash__ = None  # type: ignore[assignment]

    @property
    def through(self) -> NDArray[np.bool_]:
        """Where the ray passed all elements."""
        result: NDArray[np.bool_] = self.fate == Fate.PASSED
        return result


class Passage(Hits):
    """One element, as many rays met it, in the element's frame: all of Hits, and `direction` behind it, and
    `opl` from the launch to it.  `t` is the length along the ray from the element before, or from its start at
    element 1, in the unit of the lens.  A ray that did not reach it: status MISS, evals 0, direction 0, all
    else NaN."""

    FIELDS = {**Hits.FIELDS, "direction": ("f8", 3), "opl": ("f8", 1)}
    direction: Floats
    opl: Floats
    _later: "tuple[Later, ...]" = ()  # these bring the numbers that are in none of its arrays
    _element: int

    @classmethod
    def empty(cls, n: Union[int, Shape], *fields: str) -> "Passage":
        result: Passage = cls._make(n, fields)
        return result

    _HIT = Passed

    if TYPE_CHECKING:

        def __iter__(self) -> Iterator[Passed]: ...

    def _fill(self) -> C.Passages:  # type: ignore[override]
        return C.Passages.from_buffer_copy(
            _pack_passages(*self._pointers(), *self._three("direction"), self._at("opl"), 0, 0)
        )

    def _hits_struct(self) -> C.Hits:
        hits: C.Hits = self._struct.hits
        return hits

    @property
    def _names(self) -> tuple[str, ...]:
        return tuple(self.FIELDS) if self._later else self._places.names

    def _missing(self, name: str) -> NDArray[Any]:
        for later in self._later:
            if name in later.names:
                return later.passages()[self._element]._row(name)
        return super()._missing(name)

    def _settle(self) -> None:
        if self._later:
            for later in self._later:
                for name in later.names:
                    if name not in self._views:
                        self._views[name] = self._column(self.size, name)
            self._set(self._rows, self._axis, self._shape)
            self._block, self._later, self._c = None, (), None


class Later:
    """Numbers of the passages that nobody has read yet.  `trace` brings those called `names` of all elements,
    when one of them is first read."""

    def __init__(self, names: tuple[str, ...], trace: "Callable[[tuple[str, ...]], list[Passage]]") -> None:
        self.names = names
        self._trace: "Optional[Callable[[tuple[str, ...]], list[Passage]]]" = trace
        self._found: "list[Passage]" = []
        self._lock = threading.Lock()

    def passages(self) -> "list[Passage]":
        with self._lock:
            if self._trace is not None:
                self._found, self._trace = self._trace(self.names), None
        return self._found


class Room:
    """Where the passages of a trace are written to: a block, `pitch` bytes for each element.  The objects are
    made when they are first asked for."""

    __slots__ = ("count", "size", "axis", "shape", "places", "block", "base", "pitch", "later")

    def __init__(self, count: int, of: Traced, names: tuple[str, ...], later: tuple[Later, ...] = ()) -> None:
        self.count, self.size, self.axis, self.shape, self.later = count, of.size, of._axis, of._shape, later
        self.places = places_of(Passage, names)
        self.pitch = (self.size * self.places.width + 63) // 64 * 64
        # (Above LARGE each element has columns of its own.)
        self.block = np.empty(count * self.pitch + 8, np.uint8) if self.size < LARGE else None
        self.base = 0 if self.block is None else address(self.block)

    def made(self) -> "list[Passage]":
        all_of_them = []
        for i in range(self.count):
            if self.block is not None:
                p = Passage.__new__(Passage)
                p.size, p._axis, p._views, p._places = self.size, self.axis, {}, self.places
                p._block, p._from = self.block, i * self.pitch
                p._base, p._shape = self.base + p._from, self.shape
            else:
                p = Passage._make(self.size, self.places.names, self.axis, self.shape)
            p._element, p._later = i, self.later
            all_of_them.append(p)
        return all_of_them
