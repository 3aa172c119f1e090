# SPDX-License-Identifier: MIT
"""What every surface can do: meet rays, be differentiated, be diagnosed and checked."""
from __future__ import annotations

import ctypes
import enum
import math
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Hashable, Iterator, Optional, Sequence, Type, TypeVar, Union
from typing import overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _calls
from . import _library as C
from ._arrays import (
    LARGE,
    Numbers1,
    RayArrays,
    Rows,
    Shape,
    Vector,
    Vectors,
    VectorsLike,
    address,
    doubles,
    places_of,
    spread,
)
from ._calls import Options, Proofs
from ._calls import Prepared as Prepared
from ._tables import Dims, Floats, Named, Table, Tabular, ray_axes
from .results import HIT_TABLE, STEP_TABLE, Crossings, Hit, Hits, Status

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .function import Function

_byref = ctypes.byref
_pack_ray = struct.Struct("8d").pack
_pack_meeting = C.packer(C.Meeting)
_one = C.library.sagitta_one
_meet = C.library.sagitta_meet
_ALL = places_of(Hits, ())
_SIZES = (tuple, list, np.ndarray)
Out = TypeVar("Out", bound=Hits)


@dataclass(eq=False)
class AllHits(Named, Tabular):
    """Every hit of every ray, in order of t.  `for entries in every` goes over the rays.

    count   (n,), or as the rays have it: how many entries each ray has; 0: it certainly misses
    table   a structured array of all entries, ray by ray: `ray` (its place in the order of C), and what a Hit
            has.  An entry with a status below 0 is a stretch of the ray that could not be decided
    """

    count: NDArray[np.int32]
    table: NDArray[Any]

    def of(self, ray: int) -> NDArray[Any]:
        """The entries of one ray."""
        count = self.count.reshape(-1)
        begin = int(np.maximum(count[:ray], 0).sum())
        return self.table[begin : begin + max(int(count[ray]), 0)]

    def __len__(self) -> int:
        return self.count.size

    def __iter__(self) -> Iterator[NDArray[Any]]:
        counts = np.maximum(self.count.reshape(-1), 0)
        return (self.table[end - count : end] for count, end in zip(counts, np.cumsum(counts)))

    def _table(self, dims: Dims) -> Table:
        axes = ray_axes((1,), dims or "entry")
        columns = {name: self.table[name].T for name in self.table.dtype.names or ()}
        return {name: (("xyz",) * (a.ndim - 1) + axes, a) for name, a in columns.items()}


Singles = NDArray[np.float32]


@dataclass(eq=False)
class SingleHits(Named, Tabular):
    """What intersect_single() answers, in single precision: arrays of float32, and `status` of int8.

    status  as of Hits (n is the shape of the rays, one axis or more)
    t       the root, in lengths of d             t_err   certainly |t - root| <= t_err
    p       (3, n) the point                      p_err   certainly the surface is as near to p
    n       (3, n) the gradient there, within 2^-15 of its length
    """

    status: NDArray[np.int8]
    t: Singles
    t_err: Singles
    p: Singles
    n: Singles
    p_err: Singles

    def __len__(self) -> int:
        return self.status.size

    def _table(self, dims: Dims) -> Table:
        axes = ray_axes(self.status.shape, dims)
        return {name: (("xyz",) * (name in "pn") + axes, self[name]) for name in self.keys()}


@dataclass(eq=False)
class Jacobian(Named, Tabular):
    """How t, p and n of each hit change: with the origin, and with the parameters of the surface.

    t_by_o  (3, n)          dt/do_j                   t_by_a  (m, n)         dt/da_j
    p_by_o  (3, 3, n)       [i, j]: dp_i/do_j         p_by_a  (3, m, n)
    n_by_o  (3, 3, n)                                 n_by_a  (3, m, n)
    parameters              the names of the m parameters

    n is the shape of the rays, one axis or more.  By the direction it is t times that by the origin.  NaN
    where the ray does not meet the surface, and where the surface does not offer what is needed (a Function
    has neither second derivatives nor parameters).
    """

    t_by_o: Floats
    p_by_o: Floats
    n_by_o: Floats
    t_by_a: Floats
    p_by_a: Floats
    n_by_a: Floats
    parameters: tuple[str, ...]

    def _table(self, dims: Dims) -> Table:
        axes = ray_axes(self.t_by_o.shape[1:], dims)
        found: Table = {}
        for name in self.keys()[:-1]:
            by = "o" if name.endswith("o") else "parameter"
            found[name] = (*("xyz",) * (name[0] != "t"), by, *axes), self[name]
        return found

    def _coords(self) -> dict[str, Any]:
        return {"o": ["x", "y", "z"], "parameter": list(self.parameters)}


class Verdict(enum.IntEnum):
    """How the solver converged (diagnose.h, sgt_verdict)."""

    QUADRATIC = 0
    LINEAR = 1
    BISECTING = 2
    OSCILLATING = 3
    WANDERING = 4
    ROUNDING = 5
    LATE = 6


@dataclass(eq=False)
class Diagnosis(Named):
    """How the solver came to its answer for one ray.

    verdict, text       as a number (Verdict), and as a sentence
    order, rate         |e_next| ~ rate |e|^order over the last steps; NaN: too few
    condition           1 / |slope| at the root: how grazing, how flat
    newton, bisect, march, retreat    how many evaluations were chosen so
    hit                 the answer
    before              how many evaluations came before the steps began to close in
    steps               each evaluation: eval, move, kind, t, f, slope, lo, hi, and the bounds f_lo, f_hi, slope_lo,
                        slope_hi.  kind 0: at t; 1: over the cell lo ... hi (sagitta.h, sgt_step)
    """

    verdict: Verdict
    text: str
    order: float
    rate: float
    condition: float
    newton: int
    bisect: int
    march: int
    retreat: int
    before: int
    hit: Hit
    steps: NDArray[Any]


class Fault(enum.IntEnum):
    """The first fault that check() found (diagnose.h, sgt_fault)."""

    SOUND = 0
    WRONG_GRADIENT = 1
    WRONG_SPAN = 2
    WRONG_ROUNDING = 3
    NO_VALUE = 4
    WRONG_VALUES = 5
    WRONG_SPANS = 6
    WRONG_CLEARANCE = 7
    WRONG_ENCLOSURE = 8
    WRONG_FIRST = 9
    WRONG_FIRSTS = 10
    WRONG_ENCLOSURES = 11
    WRONG_ARITHMETIC = 12


@dataclass(eq=False)
class Check(Named):
    """What check() found: the fault, a sentence about it, and a point that shows it."""

    fault: Fault
    text: str
    where: Floats

    @property
    def sound(self) -> bool:
        return self.fault == Fault.SOUND


def _as_singles(x: Any) -> Optional[Singles]:
    """x, if it is a (3, n) array of floats that the library can read where it is."""
    good = isinstance(x, np.ndarray) and x.dtype == np.float32 and x.ndim == 2 and x.shape[0] == 3 != x.shape[1]
    return x if good and x.flags.c_contiguous and x.flags.aligned else None


class Surface:
    """A surface: a class of the catalogue, a Formula, a Sag, or a Function.  It does not change once it is
    made."""

    # The functions of Python that are called for it.
    _functions: "tuple[Function, ...]" = ()
    _struct: C.Surface
    _ref: Any
    _address: int  # of _struct

    # ------------------------------------------------------------------------- rays

    @overload
    def intersect(
        self, o: Vector, d: Vector, *, tmin: Optional[float] = None, tmax: Optional[float] = None,
        threads: int = 1, axis: Optional[int] = None, out: None = None, **options: Unpack[Options],
    ) -> Hit: ...
    @overload
    def intersect(
        self, o: VectorsLike, d: VectorsLike, *, tmin: Optional[ArrayLike] = None,
        tmax: Optional[ArrayLike] = None, threads: int = 1, axis: Optional[int] = None, out: Out,
        **options: Unpack[Options],
    ) -> Out: ...
    @overload
    def intersect(
        self, o: Vectors, d: VectorsLike, *, tmin: Optional[ArrayLike] = None,
        tmax: Optional[ArrayLike] = None, threads: int = 1, axis: Optional[int] = None, out: None = None,
        **options: Unpack[Options],
    ) -> Hits: ...
    @overload
    def intersect(
        self, o: Vector, d: Vectors, *, tmin: Optional[ArrayLike] = None, tmax: Optional[ArrayLike] = None,
        threads: int = 1, axis: Optional[int] = None, out: None = None, **options: Unpack[Options],
    ) -> Hits: ...
    @overload
    def intersect(
        self, o: VectorsLike, d: VectorsLike, *, tmin: Optional[ArrayLike] = None,
        tmax: Optional[ArrayLike] = None, threads: int = 1, axis: Optional[int] = None,
        out: Optional[Hits] = None, **options: Unpack[Options],
    ) -> Union[Hit, Hits]: ...

    @_calls.takes(Options)
    def intersect(
        self,
        o: VectorsLike,
        d: VectorsLike,
        *,
        tmin: Optional[ArrayLike] = None,
        tmax: Optional[ArrayLike] = None,
        threads: int = 1,
        axis: Optional[int] = None,
        out: Optional[Hits] = None,
        **options: Unpack[Options],
    ) -> Union[Hit, Hits]:
        """Where the rays o + t d meet the surface: a Hit for one ray, Hits for many.

        o, d        (3,), (3, n), (n, 3), or three arrays; one of them may be (3,) for all rays.  Of rays in
                    more axes (3, ny, nx) or (ny, nx, 3): the answers have their shape.  Shapes are broadcast
        tmin, tmax  the ends, in lengths of d: a number, or one for each ray.  Default: 0 and infinity.  The
                    root at a finite tmin itself is not accepted; -inf takes the whole line
        pick        "first", or "near-seed": the root that the surface's own guess leads to
        proof       "estimate", "root" (exactly one root within t_err) or "first" (and none before it)
        t_tol, f_tol, dt_min, max_evals     as in sgt_options (sagitta.h)
        threads     in how many threads; the answers are the same to the last bit
        axis        which axis of o and d holds x, y, z, 0 or -1; needed for (3, 3)
        out         Hits to write to, and to return

        >>> import sagitta
        >>> ball = sagitta.Sphere(radius=10)
        >>> hit = ball.intersect((0, 6, -5), (0, 0, 1))
        >>> hit.text, hit.t, hit.p
        ('hit', 7.0, array([0., 6., 2.]))
        >>> many = ball.intersect((0, 0, -5), [[0, 0, 0, 0], [0, .1, .2, 3], [1, 1, 1, 1]])
        >>> many.status
        array([1, 1, 1, 0], dtype=int8)
        """
        option = _calls.options(options) if options else None
        if out is None and axis is None and threads == 1 and not (type(o) is np.ndarray and o.ndim == 2):
            try:
                ox, oy, oz = o  # type: ignore[misc]
                dx, dy, dz = d  # type: ignore[misc]
                ray = _pack_ray(
                    ox,
                    oy,
                    oz,
                    dx,
                    dy,
                    dz,
                    0.0 if tmin is None else tmin,
                    math.inf if tmax is None else tmax,
                )
            except (TypeError, ValueError, struct.error):
                pass  # not one ray of numbers: what it is, or what is wrong, RayArrays says
            else:
                if not isinstance(ox, _SIZES):
                    hit = Hit()
                    bad = _one(self._ref, ray, None if option is None else _byref(option), _byref(hit))
                    if bad:
                        _calls.raise_bad(bad, self._functions)
                    return hit
        rays = RayArrays(o, d, tmin, tmax, axis)
        if rays.one and out is None:
            return self._intersect_one(rays, option)
        if out is None:
            n, turned, shape = rays.n, rays.axis, rays.shape
            out = Hits._in_block(n, _ALL, turned, shape) if n < LARGE else Hits._make(n, (), turned, shape)
        elif not isinstance(out, Hits):
            raise TypeError(f"out: must be Hits, not {type(out).__name__}")
        else:
            out._settle()
            out._check(rays)
        if out._block is not None and type(threads) is int and threads == 1 and not self._functions:
            given = 0 if option is None else ctypes.addressof(option)
            bad = _meet(_pack_meeting(self._address, given, rays.n, out._base, out._places.bits, *rays.at))
            if bad:
                out._void("status", Status.STOPPED)
                C.refuse(bad)
            return out
        call = self._call(C.INTERSECT, rays, option)
        call.hits = out._hits_struct()
        _calls.run(call, rays.n, threads, self._functions, lambda: out._void("status", Status.STOPPED))
        return out

    def _intersect_one(self, rays: RayArrays, option: Optional[C.Options]) -> Hit:
        tmin, tmax = (None if x is None else float(x[0]) for x in rays.keep)
        ray = _pack_ray(
            *(float(x[0]) for x in (*rays.o, *rays.d)),
            0.0 if tmin is None else tmin,
            math.inf if tmax is None else tmax,
        )
        hit = Hit()
        bad = _one(self._ref, ray, None if option is None else _byref(option), _byref(hit))
        if bad:
            _calls.raise_bad(bad, self._functions)
        return hit

    def _call(self, task: int, rays: RayArrays, option: Optional[C.Options]) -> C.Call:
        call = C.Call(task=task, python=bool(self._functions), surface=self._struct, rays=rays.struct)
        if option is not None:
            call.opt = ctypes.pointer(option)
        call._keep = (self, rays, option)
        return call

    @_calls.takes(Options)
    def intersect_single(
        self,
        o: VectorsLike,
        d: VectorsLike,
        *,
        tmin: Optional[ArrayLike] = None,
        tmax: Optional[ArrayLike] = None,
        threads: int = 1,
        axis: Optional[int] = None,
        **options: Unpack[Options],
    ) -> SingleHits:
        """As intersect(), in single precision (sgt_intersect_batch_f of sagitta.h): half the memory.

        The rays are those of the floats that the arguments are rounded to, and t_err and p_err are as certain
        as in double.  It is faster on planes, conics and even aspheres with a semi_diameter; other surfaces are
        asked in double.  Two float32 arrays of (3, n) are read where they are; others are copied.  One ray is
        an array of one.  The vectors of the answers are (3, n).

        >>> import sagitta
        >>> ball = sagitta.Sphere(radius=10, semi_diameter=8)
        >>> hits = ball.intersect_single((0, 6, -5), (0, 0, 1))
        >>> hits.t, bool(0 < hits.t_err[0] < 1e-5)
        (array([7.], dtype=float32), True)
        """
        ends: list[Optional[Singles]] = [None, None]
        a, b = _as_singles(o), _as_singles(d)
        if a is not None and b is not None and a.shape == b.shape and tmin is tmax is axis is None:
            rows, shape = [a, b], a.shape[1:]
        else:
            rays = RayArrays(o, d, tmin, tmax, axis)
            shape = rays.shape or (rays.n,)
            with np.errstate(over="ignore", under="ignore"):
                rows = [
                    np.array([np.reshape(x, rays.n) for x in three], np.float32) for three in (rays.o, rays.d)
                ]
                ends = [None if x is None else x.astype(np.float32) for x in rays.keep]
        n = rows[0].shape[1]
        out = SingleHits(
            np.empty(n, np.int8),
            np.empty(n, np.float32),
            np.empty(n, np.float32),
            np.empty((3, n), np.float32),
            np.empty((3, n), np.float32),
            np.empty(n, np.float32),
        )
        option = _calls.options(options)
        call = C.Call(task=C.SINGLE, python=bool(self._functions), surface=self._struct)
        if option is not None:
            call.opt = ctypes.pointer(option)
        call._keep = (self, rows, ends, option)
        at = [C.Addresses(*(address(x) for x in three)) for three in [*rows, out.p, out.n]]
        call.rays_f = C.RaysF(at[0], at[1], *(0 if x is None else address(x) for x in ends))
        first = address(out.status), address(out.t), address(out.t_err)
        call.hits_f = C.HitsF(*first, at[2], at[3], address(out.p_err))
        _calls.run(call, n, threads, self._functions)
        return SingleHits(*(x.reshape(*x.shape[:-1], *shape) for x in out.values()))

    @_calls.takes(Options)
    def prepare(
        self,
        o: VectorsLike,
        d: VectorsLike,
        *,
        tmin: Optional[ArrayLike] = None,
        tmax: Optional[ArrayLike] = None,
        threads: int = 1,
        axis: Optional[int] = None,
        out: Optional[Hits] = None,
        **options: Unpack[Options],
    ) -> Prepared[Hits]:
        """The call of intersect(), to be made many times: all checks and addresses are done once.

        Change the arrays in place and call it; it writes to `out` and returns how many rays were met.  Arrays
        that had to be copied ((n, 3), other types) are copied now and not again: change `rays.o`, `rays.d`.
        It is for one thread at a time: a second one is refused.

        >>> import numpy as np, sagitta
        >>> o, d = np.array([[0.], [0], [-5]]), np.array([[0.], [0], [1]])
        >>> call = sagitta.Sphere(radius=10).prepare(o, d)
        >>> o[1] = 6
        >>> call(), call.out.t
        (1, array([7.]))
        """
        rays = RayArrays(o, d, tmin, tmax, axis)
        if out is None:
            out = Hits._make(rays.n, (), rays.axis, rays.shape)
        elif not isinstance(out, Hits):
            raise TypeError(f"out: must be Hits, not {type(out).__name__}")
        there = out
        there._settle()
        there._check(rays)
        call = self._call(C.INTERSECT, rays, _calls.options(options))
        call.hits = there._hits_struct()
        return Prepared(
            call, rays, there, self._functions, threads, lambda: there._void("status", Status.STOPPED)
        )

    @_calls.takes(Proofs)
    def leave(
        self,
        hits: Union[Hit, Hits],
        d: VectorsLike,
        *,
        tmax: Optional[ArrayLike] = None,
        threads: int = 1,
        axis: Optional[int] = None,
        out: Optional[Crossings] = None,
        **options: Unpack[Proofs],
    ) -> Crossings:
        """Where rays that start on the surface, at hits of it, meet it next (sgt_leave of sagitta.h).

        hits        of intersect() or leave(), with p and p_err; n makes it faster
        d           as of intersect(): where they go from there
        tmax        as of intersect()

        The root at the start is not accepted, and no ray has to be pushed off the surface.  A hit of a ray that
        met nothing is no start: its status is -5 (Status.INVALID).  t counts from a point within p_err and 4
        ulps of p.  The rest is as of intersect(); one hit is an array of one.

        >>> import sagitta
        >>> ball = sagitta.Ellipsoid(a=10)
        >>> hit = ball.intersect((0, 6, -50), (0, 0, 1))
        >>> across = ball.leave(hit, (0, 0, 1))
        >>> across.t, across.side
        (array([16.]), array([-1], dtype=int8))
        >>> ball.leave(across, (0, 0, 1)).status
        array([0], dtype=int8)
        """
        gradient: Optional[Rows] = None
        of: Shape = ()
        if isinstance(hits, Hit):
            p, p_err = hits.p, np.array([hits.p_err])
            gradient = hits.n.reshape(3, 1)
        elif isinstance(hits, Hits):
            p, p_err, of = hits.p, hits._row("p_err"), hits.shape
            gradient = hits._row("n") if "n" in hits._names else None
            if axis is None and p.shape[0] == p.shape[-1] == 3:  # as they came
                axis = -hits._axis
        else:
            raise TypeError(f"hits: must be a Hit or Hits, not {type(hits).__name__}")
        rays = RayArrays(p, d, None, tmax, axis)
        over = rays.shape or (rays.n,)
        starts = C.Starts(p=rays.rows_at[:3], d=rays.rows_at[3:6])
        keep: list[Any] = [rays, spread([p_err], of, over)[0]]
        starts.p_err = address(keep[1])
        if gradient is not None:
            keep.append([np.ascontiguousarray(x) for x in spread(gradient, of, over)])
            starts.n = tuple(address(x) for x in keep[-1])
        end = rays.keep[1]
        if end is not None:  # there, a 0 says that there is no end
            keep.append(np.where(end == 0, -0.0, end))
            starts.tmax = address(keep[-1])
        if out is None:
            out = Crossings._make(rays.n, (), rays.axis, rays.shape)
        elif not isinstance(out, Crossings):
            raise TypeError(f"out: must be Crossings, not {type(out).__name__}")
        there = out
        there._settle()
        there._check(rays)
        given = [p_err] if gradient is None else [p_err, *gradient]
        if there is hits or any(np.may_share_memory(a, x) for a in there._rows.values() for x in given):
            raise ValueError("out: overlaps the hits that the rays start at")
        call = self._call(C.LEAVE, rays, _calls.options(options, Proofs))
        call._keep = (call._keep, keep)
        call.starts, call.hits, call.side = starts, there._hits_struct(), there._at("side") or None
        _calls.run(call, rays.n, threads, self._functions, lambda: there._void("status", Status.STOPPED))
        return there

    @_calls.takes(Proofs)
    def intersect_all(
        self,
        o: VectorsLike,
        d: VectorsLike,
        *,
        tmin: Optional[ArrayLike] = None,
        tmax: Optional[ArrayLike] = None,
        threads: int = 1,
        axis: Optional[int] = None,
        **options: Unpack[Proofs],
    ) -> AllHits:
        """Every hit of every ray, in order of t.  Arguments as for intersect().

        >>> import sagitta
        >>> sagitta.Torus(major=2, minor=0.5).intersect_all((-5, 0, 0), (1, 0, 0)).table["t"]
        array([2.5, 3.5, 6.5, 7.5])
        """
        rays = RayArrays(o, d, tmin, tmax, axis)
        option = _calls.options(options, Proofs)
        count = np.empty(rays.n, np.int32)
        cap = 4
        while True:
            hits = np.empty((rays.n, cap), HIT_TABLE)
            call = self._call(C.ALL, rays, option)
            call.cap, call.count, call.hit = cap, address(count), address(hits)
            _calls.run(call, rays.n, threads, self._functions)
            most = int(count.max(initial=0))
            if most <= cap:
                break
            cap = most
        if (count < 0).any():
            bad = int(np.argmax(count < 0))
            raise ValueError(
                f"ray {bad} makes no sense: a number that is not finite, a direction of length 0, or "
                "tmin above tmax"
            )
        kept = np.arange(cap) < count[:, None]
        names = [name for name in HIT_TABLE.names or () if name != "reserved_"]
        table = np.empty(
            int(count.sum()),
            [("ray", np.dtype("i8")), *((name, HIT_TABLE[name]) for name in names)],
        )
        table["ray"] = np.repeat(np.arange(rays.n), count)
        for name in names:
            table[name] = hits[name][kept]
        return AllHits(count.reshape(rays.shape or (rays.n,)), table)

    # ---------------------------------------------------------------- the function itself

    @overload
    def sag(self, x: float, y: float) -> float: ...
    @overload
    def sag(self, x: Numbers1, y: Union[float, Numbers1]) -> Floats: ...
    @overload
    def sag(self, x: float, y: Numbers1) -> Floats: ...

    def sag(self, x: ArrayLike, y: ArrayLike) -> Union[float, Floats]:
        """z of the surface at x, y, on the sheet of its vertex: a number, or an array of the shape that x and y
        have together.

        It is where a line parallel to z is met.  NaN: there is no surface at x, y, the search was undecided, or
        the surface is no sag: a body, a level set.  Not of a Function.

        >>> import sagitta
        >>> sagitta.Sphere(radius=10).sag(0, [6, 8, 11])
        array([ 2.,  4., nan])
        """
        z = self._sag(x, y)
        return float(z) if z.ndim == 0 else z

    def _sag(self, x: ArrayLike, y: ArrayLike) -> Floats:
        if self._functions:
            raise TypeError("sag: not of a surface that asks functions of Python")
        across, up = np.broadcast_arrays(np.asarray(x, np.float64), np.asarray(y, np.float64))
        z = np.full(across.shape, np.nan)
        there = np.isfinite(across) & np.isfinite(up)
        if there.any() and C.library.sgt_is_sag(self._struct):
            at = np.array([across[there], up[there], np.zeros(np.count_nonzero(there))])
            hits = self.intersect(at, (0, 0, 1), tmin=-np.inf, pick="near-seed", axis=0)
            z[there] = np.where(hits.status > 0, hits.p[2], np.nan)
        return z

    @overload
    def value(self, x: float, y: float, z: float) -> float: ...
    @overload
    def value(self, x: Numbers1, y: Union[float, Numbers1], z: Union[float, Numbers1]) -> Floats: ...
    @overload
    def value(self, x: float, y: Numbers1, z: Union[float, Numbers1]) -> Floats: ...
    @overload
    def value(self, x: float, y: float, z: Numbers1) -> Floats: ...

    def value(self, x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Union[float, Floats]:
        """F at points: a number, or an array of the shape that x, y and z have together.

        F is 0 on the surface, above 0 outside of a body and above a sag, and NaN where it is not defined.
        Its unit is the surface's own (docs/surfaces.md).  The rim is not part of it.

        >>> import sagitta
        >>> sagitta.Plane().value(0, 0, [-1, 0, 2])
        array([-1.,  0.,  2.])
        """
        f = self._values(x, y, z)[0]
        return float(f) if f.ndim == 0 else f

    def normal(self, x: ArrayLike, y: ArrayLike, z: Optional[ArrayLike] = None) -> Floats:
        """The normal at points: of unit length, to where F grows.  (3,), or (3, ...) with the shape that x, y
        and z have together.  Without z, of a sag: at z = sag(x, y).  NaN where F or the sag is not defined,
        and where the gradient is 0.

        >>> import sagitta
        >>> sagitta.Sphere(radius=7).normal(2, 3).round(3)
        array([-0.286, -0.429,  0.857])
        >>> ring = sagitta.Torus(major=2, minor=0.5)
        >>> ring.normal(*ring.intersect((-5, 0, 0), (1, 0, 0)).p)
        array([-1.,  0.,  0.])
        """
        _, n = self._values(x, y, self._sag(x, y) if z is None else z)
        with np.errstate(invalid="ignore", divide="ignore"):
            n = n / np.max(np.abs(n), axis=0)  # so that no square overflows
            made: Floats = n / np.sqrt((n * n).sum(axis=0))
        return made

    def _values(self, x: ArrayLike, y: ArrayLike, z: ArrayLike) -> tuple[Floats, Floats]:
        """F and its gradient."""
        parts = np.broadcast_arrays(*(doubles(v, name) for v, name in ((x, "x"), (y, "y"), (z, "z"))))
        shape, n = parts[0].shape, parts[0].size
        rows, f, gradient = np.array([v.reshape(n) for v in parts]), np.empty(n), np.empty((3, n))
        call = C.Call(task=C.VALUES, python=bool(self._functions), surface=self._struct)
        call.rays.o = tuple(address(v) for v in rows) if n else (0, 0, 0)
        call.hits.t = address(f)
        call.hits.n = tuple(address(v) for v in gradient) if n else (0, 0, 0)
        _calls.run(call, n, 1, self._functions)
        return f.reshape(shape), gradient.reshape(3, *shape)

    # ------------------------------------------------------------------ derivatives

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the numbers that the surface has derivatives by, in their order."""
        return tuple(f"parameter {i}" for i in range(C.library.sgt_parameters(self._struct)))

    def differentiate(
        self, o: VectorsLike, d: VectorsLike, hits: Hits, *, axis: Optional[int] = None
    ) -> Jacobian:
        """How the hits of these rays change with the rays and with the parameters of the surface.

        `hits` are those of intersect(), with p and n.  No ray is met again.

        >>> import sagitta
        >>> plane, o, d = sagitta.Plane(), [[0, 1], [0, 0], [-5, -5]], (0, 0, 1)
        >>> plane.differentiate(o, d, plane.intersect(o, d)).t_by_o[2]
        array([-1., -1.])
        """
        rays = RayArrays(o, d, None, None, axis)
        if not isinstance(hits, Hits):
            raise TypeError(f"hits: must be Hits, not {type(hits).__name__}")
        if len(hits) != rays.n:
            raise ValueError(f"hits are of {len(hits)} rays; there are {rays.n}")
        if hits._shape != rays.shape and not rays.one:
            of = rays.shape or (rays.n,)
            raise ValueError(f"hits have the shape {hits.shape}; that of the rays is {of}")
        if "p" not in hits._names or "n" not in hits._names:
            raise ValueError("hits: p and n are needed")
        hits._row("p"), hits._row("n")
        there = C.Hits(p=C.Addresses(*hits._three("p")), n=C.Addresses(*hits._three("n")))
        C.check_arithmetic()
        names, n = self.parameters, rays.n
        m = len(names)
        by_o = [np.full(shape, np.nan) for shape in ((3, n), (3, 3, n), (3, 3, n))]
        by_a = [np.full(shape, np.nan) for shape in ((m, n), (3, m, n), (3, m, n))]
        out, lists = C.Jacobian(), []

        def addresses(a: Floats) -> list[int]:
            return [address(a) + 8 * n * i for i in range(a.size // n if n else 0)]

        for name, a in zip(("t_by_o", "p_by_o", "n_by_o"), by_o):
            at = getattr(out, name)
            for i, where in enumerate(addresses(a)):
                at[i] = where
        for name, a in zip(("t_by_a", "p_by_a", "n_by_a"), by_a):
            listed = (ctypes.c_void_p * max(a.size // n if n else 0, 1))(*addresses(a))
            lists.append(listed)
            if not m:
                continue
            if name == "t_by_a":
                out.t_by_a = ctypes.addressof(listed)
            else:
                at = getattr(out, name)
                for i in range(3):
                    at[i] = ctypes.addressof(listed) + 8 * m * i
        C.library.sgt_differentiate_batch(self._struct, n, rays.struct, there, out)
        by = [a.reshape(*a.shape[:-1], *hits.shape) for a in (*by_o, *by_a)]
        return Jacobian(by[0], by[1], by[2], by[3], by[4], by[5], names)

    # ------------------------------------------------------------------- diagnosis

    @_calls.takes(Options)
    def diagnose(
        self,
        o: Sequence[float],
        d: Sequence[float],
        *,
        tmin: float = 0.0,
        tmax: float = math.inf,
        **options: Unpack[Options],
    ) -> Diagnosis:
        """How the solver comes to its answer for one ray.

        >>> import sagitta
        >>> found = sagitta.Torus(major=2, minor=0.5).diagnose((-5, 0.3, 0.1), (1, 0, 0))
        >>> found.verdict.name, found.hit.text
        ('ROUNDING', 'hit')
        """
        rays = RayArrays(o, d, tmin, tmax)
        if not rays.one:
            raise ValueError("diagnose: takes one ray, o and d of shape (3,)")
        steps = np.zeros(4096, STEP_TABLE)
        log = C.Log(address(steps), len(steps), 0)
        given = _calls.options(options)
        option = C.Options.from_buffer_copy(given) if given is not None else C.Options()
        option.watch = ctypes.cast(C.library.sgt_log_step, ctypes.c_void_p)
        option.watch_data = ctypes.addressof(log)
        hit = self._intersect_one(rays, option)
        found = C.library.sgt_diagnose(_byref(log))
        return Diagnosis(
            Verdict(found.verdict),
            C.text(C.library.sgt_verdict_text(found.verdict)),
            found.order,
            found.rate,
            found.condition,
            found.newton,
            found.bisect,
            found.march,
            found.retreat,
            found.before,
            hit,
            steps[: min(log.n, log.cap)].copy(),
        )

    def check(
        self,
        o: VectorsLike,
        d: VectorsLike,
        *,
        tmin: ArrayLike = 0.0,
        tmax: ArrayLike = math.inf,
        axis: Optional[int] = None,
    ) -> Check:
        """Walks along the rays and tries to catch the surface breaking a promise (sgt_check of diagnose.h): a
        gradient that is not that of F, roots outside of the span, an enclosure that does not enclose.  Give
        finite ends.

        >>> import sagitta
        >>> sagitta.Function(lambda x, y, z: (x*x + y*y + z*z - 1, x, y, z)).check(
        ...     (0, 0.1, -2), (0, 0, 1), tmax=4).fault.name
        'WRONG_GRADIENT'
        """
        rays = RayArrays(o, d, tmin, tmax, axis)
        table = np.empty((rays.n, 8))
        for i, x in enumerate((*rays.o, *rays.d, *rays.keep)):
            table[:, i] = x
        table[table[:, 7] == 0, 7] = -0.0  # an end that is given, as sgt_ray_between has it
        where = np.full(3, np.nan)
        call = self._call(C.CHECK, rays, None)
        call.ray, call.where = address(table), address(where)
        _calls.run(call, rays.n, 1, self._functions)
        return Check(Fault(call.fault), C.text(C.library.sgt_fault_text(call.fault)), where)

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and "_struct" in self.__dict__:
            raise AttributeError(f"a surface does not change; use replace({name}=...) to get another")
        object.__setattr__(self, name, value)

    def _set(self, ops: int, memory: Any) -> None:
        """The struct of C; memory: what has to stay as long as this."""
        self._memory = memory
        self._struct = C.Surface(ops, ctypes.addressof(memory))
        self._ref, self._address = _byref(self._struct), ctypes.addressof(self._struct)

    def _yaml(self) -> dict[str, Any]:
        """As a lens file has it; {}: it cannot have it."""
        return {}

    def _key(self) -> Hashable:
        """What is equal of surfaces that are."""
        raise NotImplementedError

    def __eq__(self, other: object) -> bool:
        """The same class with the same parameters; one that is not given is equal to its default."""
        if not isinstance(other, Surface) or type(self) is not type(other):
            return NotImplemented
        return self is other or self._key() == other._key()

    def __hash__(self) -> int:
        return hash((type(self), self._key()))


# ------------------------------------------------------------------------ the catalogue


def builtins_at(at: int) -> Iterator[C.Builtin]:
    """The rows of a table like that of sgt_builtins()."""
    while True:
        row = C.Builtin.from_address(at)
        if not row.type:
            return
        yield row
        at += ctypes.sizeof(C.Builtin)


BUILTINS: dict[str, C.Builtin] = {row.type.decode(): row for row in builtins_at(C.library.sgt_builtins())}
ROWS: dict[str, C.Builtin] = dict(BUILTINS)  # and those about the Earth (earth.py)


def params_of(row: C.Builtin) -> Iterator[C.Param]:
    i = 0
    while row.params[i].name:
        yield row.params[i]
        i += 1


Self = TypeVar("Self", bound="Catalogue")
NOT_DIFFERENTIATED = {
    "semi_diameter",
    "norm",
    "norm_x",
    "norm_y",
    "step_x",
    "step_y",
    "order",
    "normalised",
    "sag",
}


class Catalogue(Surface):
    """A type of the catalogue.  Its parameters are those of a lens file, and can be read as attributes."""

    type: ClassVar[str] = ""
    _given: dict[str, Any]

    def _make(self, given: dict[str, Any]) -> None:
        """Takes the parameters that are not None; a radius stands for a curvature, 1/radius, rounded once."""
        row = ROWS[self.type]
        memory = ctypes.create_string_buffer(row.size)
        keep: list[Any] = []
        functions: "list[Function]" = []
        values: dict[str, Any] = {}
        for p in params_of(row):
            name = p.name.decode()
            radius = name.replace("curvature", "radius") if name.startswith("curvature") else ""
            value = given.get(name)
            if radius and given.get(radius) is not None:
                if value is not None:
                    raise ValueError(f"{self.type}: {radius} is given beside {name}; give one of the two")
                value = self._curvature(radius, given[radius])
            if value is None:
                continue
            try:
                values[name] = self._write(memory, p, name, value, keep)
            except (TypeError, ValueError) as error:
                raise type(error)(f"{self.type}: {error}") from None
        self._fill(memory)
        if row.object:
            no = row.object(ctypes.addressof(memory))
            if no.reason:
                raise ValueError(f"{self.type}: {C.text(no.param)} {C.text(no.reason)}")
        if row.prepare:
            row.prepare(ctypes.addressof(memory))
        for term in values.get("terms", ()):
            functions += term._functions
        object.__setattr__(self, "_given", values)
        object.__setattr__(self, "_keep", keep)
        self._set(row.ops, memory)

    def _fill(self, memory: Any) -> None:
        """Puts in what no row of the table describes."""

    def _curvature(self, name: str, radius: Any) -> float:
        r = float(doubles(radius, f"{self.type}: {name}"))
        if math.isnan(r) or r == 0:
            raise ValueError(
                f"{self.type}: {name} must not be {'NaN' if r else 'zero; a plane has math.inf'}"
            )
        if math.isinf(1 / r):
            raise ValueError(f"{self.type}: {name} is too small: {r}")
        return 0.0 if math.isinf(r) else 1 / r

    @staticmethod
    def _range(p: C.Param, name: str, x: Floats) -> None:
        inside = (x >= p.lo) & (x <= p.hi)
        if not np.all(inside):
            bad = float(x[~inside].flat[0])
            said = (
                f"from {p.lo:.10g} to {p.hi:.10g}"
                if p.hi < 1.7e308
                else f"finite and at least {p.lo:.10g}"
                if p.lo > -1.7e308
                else "finite"
            )
            raise ValueError(f"{name} must be {said}, not {bad}")

    def _write(self, memory: Any, p: C.Param, name: str, value: Any, keep: list[Any]) -> Any:
        if p.kind == C.TERMS:
            terms = tuple(value)
            for term in terms:
                if not isinstance(term, Catalogue):
                    raise TypeError(f"{name} must be surfaces of the catalogue, not {type(term).__name__}")
            if len(terms) > p.count:
                raise ValueError(f"{name}: has {len(terms)} surfaces; at most {p.count} are allowed")
            rows = (C.Surface * max(len(terms), 1))(*(term._struct for term in terms))
            keep += [rows, *terms]
            struct.pack_into("PN", memory, p.offset, ctypes.addressof(rows), len(terms))
            return terms
        if p.kind == C.WORD:
            words = p.words.decode().split("|")
            if value not in words:
                raise ValueError(f"{name} must be one of {', '.join(words)}, not {value!r}")
            struct.pack_into("i", memory, p.offset, words.index(value) + 1)
            return value
        if p.kind == C.TRUTH:
            if not isinstance(value, (bool, np.bool_)):
                raise TypeError(f"{name} must be True or False, not {value!r}")
            struct.pack_into("i", memory, p.offset, int(value))
            return bool(value)
        x = doubles(value, name)
        self._range(p, name, x)
        if p.kind == C.WHOLE:
            if x.ndim or x != np.floor(x):
                raise ValueError(f"{name} must be a whole number, not {value!r}")
            struct.pack_into("i", memory, p.offset, int(x))
            return int(x)
        if p.kind in (C.LIST, C.TABLE):
            x = np.array(x, order="C", ndmin=1)
            want = 1 if p.kind == C.LIST else 2
            if x.ndim != want or 0 in x.shape or max(x.shape) > p.count:
                raise ValueError(
                    f"{name} must be a {'list' if want == 1 else 'table'} of up to {p.count} "
                    f"{'numbers' if want == 1 else f'rows and {p.count} columns'}; it has the shape "
                    f"{x.shape}"
                )
            x.flags.writeable = False
            keep.append(x)
            struct.pack_into("PNN", memory, p.offset, address(x), *((1, *x.shape) if want == 1 else x.shape))
            return x
        if p.count == 1:
            if x.ndim:
                raise ValueError(f"{name} must be a number; it has the shape {x.shape}")
            struct.pack_into("d", memory, p.offset, float(x))
            return float(x)
        if x.ndim != 1 or len(x) > p.count or (p.kind == C.VECTOR and len(x) != p.count):
            raise ValueError(
                f"{name} must be a list of {'' if p.kind == C.VECTOR else 'up to '}{p.count} numbers; it "
                f"has the shape {x.shape}"
            )
        struct.pack_into(f"{len(x)}d", memory, p.offset, *x)
        x = x.copy()
        x.flags.writeable = False
        return x

    if not TYPE_CHECKING:  # (a class of surfaces.py says what it has)

        def __getattr__(self, name: str) -> Any:
            if name.startswith("_"):
                raise AttributeError(name)
            given = self._given
            if name in given:
                return given[name]
            if name.startswith("radius") and name.replace("radius", "curvature") in (
                p.name.decode() for p in params_of(ROWS[self.type])
            ):
                c = given.get(name.replace("radius", "curvature"), 0.0)
                return 1 / c if c else math.inf
            for p in params_of(ROWS[self.type]):
                if p.name.decode() == name:
                    return self._default(p)
            raise AttributeError(f"{self.type} has no parameter {name!r}")

    def _default(self, p: C.Param) -> Any:
        if p.kind == C.TERMS:
            return ()
        if p.kind == C.WORD:
            return None
        if p.kind == C.TRUTH:
            return False
        if p.kind == C.WHOLE:
            return 0
        return 0.0 if p.count == 1 else np.zeros(p.count if p.kind in (C.VECTOR,) else 0)

    def __dir__(self) -> list[str]:
        names = [p.name.decode() for p in params_of(ROWS[self.type])]
        radii = [name.replace("curvature", "radius") for name in names if name.startswith("curvature")]
        return [*super().__dir__(), *names, *radii]

    def replace(self: Self, **changes: Any) -> Self:
        """The same surface with some parameters changed; None takes one away.

        >>> import sagitta
        >>> sagitta.Conic(radius=50, conic=-1).replace(radius=40)
        Conic(curvature=0.025, conic=-1.0)
        """
        given = dict(self._given)
        for name in changes:
            if name.startswith("radius"):
                given.pop(name.replace("radius", "curvature"), None)
        given.update(changes)
        return type(self)(**{name: value for name, value in given.items() if value is not None})

    def __repr__(self) -> str:
        def shown(x: Any) -> str:
            return repr(x.tolist() if isinstance(x, np.ndarray) and x.size < 20 else x)

        return f"{type(self).__name__}({', '.join(f'{k}={shown(v)}' for k, v in self._given.items())})"

    def _key(self) -> Hashable:
        found: list[Hashable] = []
        for p in params_of(ROWS[self.type]):
            value = self._given.get(p.name.decode())
            if isinstance(value, np.ndarray):
                value = value.tolist()
                if p.kind not in (C.LIST, C.TABLE):  # numbers of the struct, which ends in zeros
                    while value and value[-1] == 0:
                        value.pop()
                value = tuple(tuple(x) if isinstance(x, list) else x for x in value)
            if value:
                found.append((p.name, value))
        return tuple(found)

    def __reduce__(self) -> Any:
        return _again, (type(self), self._given)

    @property
    def parameters(self) -> tuple[str, ...]:
        names: list[str] = []
        # Types that share operations share parameters: those of the type that names most of them.
        alike = [row for row in BUILTINS.values() if row.ops == ROWS[self.type].ops]
        row = max(alike, key=lambda row: len(list(params_of(row))))
        own = {p.offset: p.name.decode() for p in params_of(ROWS[self.type])}
        for p in sorted(params_of(row), key=lambda p: int(p.offset)):
            name = own.get(p.offset, p.name.decode())
            if name in NOT_DIFFERENTIATED:
                continue
            if p.kind == C.TERMS:
                for i, term in enumerate(self._given.get("terms", ())):
                    bare = () if term.type in ("toroidal", "biconic", "cylinder") else ("curvature", "conic")
                    names += [f"terms[{i}].{n}" for n in term.parameters if n not in bare]
            elif p.kind in (C.LIST, C.TABLE):
                shape = self._given[name].shape if name in self._given else (0,)
                names += [name + "".join(f"[{i}]" for i in at) for at in np.ndindex(*shape)]
            elif p.count > 1:
                names += [f"{name}[{i}]" for i in range(p.count)]
            else:
                names.append(name)
        count = C.library.sgt_parameters(self._struct)
        return tuple(names) if len(names) == count else super().parameters

    @classmethod
    def specimen(cls: Type[Self]) -> Self:
        """A usual surface of the type, of a few units of length, to test and to try."""
        row = ROWS[cls.type]
        made: Self = CLASSES[cls.type](**_read(row, row.specimen))
        return made

    def _yaml(self) -> dict[str, Any]:
        def plain(x: Any) -> Any:
            return (
                x.tolist()
                if isinstance(x, np.ndarray)
                else [t._yaml() for t in x]
                if isinstance(x, tuple)
                else x
            )

        return {"type": self.type, **{name: plain(x) for name, x in self._given.items()}}


def _read(row: C.Builtin, at: int) -> dict[str, Any]:
    """The parameters of a struct of C."""
    given: dict[str, Any] = {}
    taken: set[int] = set()
    for p in params_of(row):
        name, where = p.name.decode(), at + p.offset
        if p.offset in taken or (name == "slice"):
            continue
        value: Any
        if p.kind == C.TERMS:
            count = ctypes.c_size_t.from_address(where + 8).value
            terms = (C.Surface * count).from_address(ctypes.c_void_p.from_address(where).value or 0)
            by_ops = {int(r.ops): r for r in BUILTINS.values()}
            value = tuple(CLASSES[by_ops[t.ops].type.decode()](**_read(by_ops[t.ops], t.self)) for t in terms)
        elif p.kind in (C.LIST, C.TABLE):
            n = C.Numbers.from_address(where)
            if not n.x:
                continue
            value = np.array((ctypes.c_double * (n.rows * n.columns)).from_address(n.x))
            if p.kind == C.TABLE:
                value = value.reshape(n.rows, n.columns)
        elif p.kind in (C.WORD, C.WHOLE, C.TRUTH):
            number = ctypes.c_int.from_address(where).value
            value = (
                (p.words.decode().split("|")[number - 1] if number else None)
                if p.kind == C.WORD
                else (bool(number) if p.kind == C.TRUTH else number or None)
            )
        elif p.count > 1:
            value = np.array((ctypes.c_double * p.count).from_address(where))
            if not value.any():
                continue
        else:
            value = ctypes.c_double.from_address(where).value or None
        if value is not None:
            taken.add(p.offset)
            given[name] = value
    return given


def _again(cls: Any, given: dict[str, Any]) -> Any:
    return cls(**given)


# The classes of surfaces.py, by their types.
CLASSES: dict[str, Any] = {}
