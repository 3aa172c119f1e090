# SPDX-License-Identifier: MIT
"""Rays in arrays of dask: lazily, in threads, processes or on a cluster.  It needs dask, for this module only.

    import dask.array as da, sagitta.dask
    hits = sagitta.dask.intersect(surface, o, d)        # o, d: arrays of dask
    hits.t.mean().compute()
    spot = sagitta.dask.analysis(lens, "spot", parts=50, pattern="random", rays=10**9).compute()

What is computed of a ray depends on that ray alone, and sums over rays are exact.  So no bit depends on chunks, on
the number of workers, or on which worker did what; and a task that is done again, since its worker died, has the same
answer.  A surface or lens is one key of the graph, pickled once for each worker.
"""
from __future__ import annotations

import pickle
import uuid
import zlib
from functools import partial
from typing import Any, Collection, Mapping, Optional, Sequence, TypeVar, Union

import dask
import dask.array as da
import numpy as np
from dask.base import normalize_token
from dask.delayed import Delayed, delayed

from .lens import Lens, _names_of
from .results import Hits, Passage, Traced
from .study import ask
from .sums import SpotSums, WavefrontSums
from .surface import Surface

Array = Any  # dask.array.Array, of which mypy knows nothing
XYZ = -1  # the name of the axis of x, y, z
WIDE = 16  # sums that are merged at once
Sums = TypeVar("Sums", SpotSums, WavefrontSums)


@normalize_token.register((Lens, Surface))  # type: ignore[misc]
def _token(of: Union[Lens, Surface]) -> Any:
    """Equal surfaces and lenses make equal keys; what cannot be pickled, as a lambda in a Function, keys of its own."""
    try:
        return type(of).__name__, pickle.dumps(of)
    except (pickle.PicklingError, AttributeError, TypeError):
        return type(of).__name__, uuid.uuid4().hex


# -------------------------------------------------------------------- arrays of rays


class _Vectors:
    """o or d in blocks: one array, three of them (x, y, z), or one vector for all rays.

    pieces      what each block needs: pairs of an array and the names of its axes; a number has no names
    """

    def __init__(self, given: Any, name: str, axis: Optional[int]) -> None:
        self.axis = axis
        self.shape: tuple[int, ...] = ()
        if isinstance(given, (tuple, list)) and any(isinstance(x, da.Array) for x in given):
            if len(given) != 3:
                raise ValueError(f"{name}: must be three arrays x, y, z, not {len(given)}")
            arrays = [x if isinstance(x, da.Array) else np.asarray(x, float) for x in given]
            self.shape = np.broadcast_shapes(*(x.shape for x in arrays))
            self.pieces = [_piece(x, None) for x in arrays]
            return
        x = given if isinstance(given, da.Array) else np.asarray(given, float)
        if x.ndim < 2:
            self.pieces = [(np.asarray(x, float), None)]  # (of dask: it is computed)
            return
        self.axis = axis = _axis_of(x, name, axis)
        if isinstance(x, da.Array) and x.numblocks[axis] > 1:
            x = x.rechunk({axis: -1})
        self.shape = x.shape[1:] if axis == 0 else x.shape[:-1]
        self.pieces = [_piece(x, axis)]


def _axis_of(x: Any, name: str, axis: Optional[int]) -> int:
    """Which axis has x, y, z: as for arrays of numpy."""
    found = [k for k in (0, -1) if x.shape[k] == 3 and axis in (None, k, k % x.ndim)]
    if len(found) == 1:
        return found[0]
    if found:
        raise ValueError(f"{name}: {x.shape} can be read with x, y, z along its first axis or its last; say axis=0 or -1")
    raise ValueError(f"{name}: has the shape {x.shape}; it must be (3, n) or (n, 3), or of more axes")


def _piece(x: Any, axis: Optional[int]) -> tuple[Any, Optional[tuple[int, ...]]]:
    """An array and the names of its axes: those of the rays are numbers from the last, that of x, y, z is XYZ."""
    count = x.ndim - (axis is not None)
    if count == 0:
        return x, None
    rays = tuple(range(count - 1, -1, -1))
    names = rays if axis is None else (XYZ, *rays) if axis == 0 else (*rays, XYZ)
    return x if isinstance(x, da.Array) else da.from_array(x), names


def _whole(block: Any) -> Any:
    """Of an axis that is in one block, blockwise gives a list of that block."""
    return block[0] if isinstance(block, list) else block


def _block(
    *blocks: Any, of: Any, do: Any, counts: Sequence[int], ends: Sequence[str], fixed: Mapping[str, Any]
) -> Any:
    """One block of rays; counts: of how many blocks o and d are made."""
    given, vectors = list(map(_whole, blocks)), []
    for count in counts:
        part, given = given[:count], given[count:]
        vectors.append(part[0] if count == 1 else tuple(part))
    return do(of, *vectors, **dict(zip(ends, given)), **fixed)


def _in_blocks(
    of: Any, do: Any, called: str, o: Any, d: Any, axis: Optional[int], ends: Mapping[str, Any], fixed: dict[str, Any]
) -> tuple[Array, int]:
    """An array of dask of which each block is one result, and the axis of x, y, z."""
    both = _Vectors(o, "o", axis), _Vectors(d, "d", axis)
    if not any(names for v in both for _, names in v.pieces):
        raise TypeError("o, d: one of them must be an array of rays; of one ray the surface or lens knows without dask")
    axes = {v.axis for v in both if v.axis is not None}
    if len(axes) > 1:
        raise ValueError("o, d: x, y, z must be along the same axis of both")
    along = axes.pop() if axes else 0
    others = {name: x for name, x in ends.items() if x is not None}
    pieces = [p for v in both for p in v.pieces] + [_piece(np.asarray(x, float) if not isinstance(x, da.Array) else x, None)
                                                     for x in others.values()]
    rank = max(len(v.shape) for v in both)
    call = partial(_block, do=do, counts=[len(v.pieces) for v in both], ends=tuple(others), fixed={**fixed, "axis": along})
    made = da.blockwise(
        call, tuple(range(rank - 1, -1, -1)), *(x for piece in pieces for x in piece), of=delayed(of, pure=True),
        dtype=object, meta=np.empty((0,) * rank, object), token=called,
    )
    return made, along


def _column(block: Any, name: str, element: Optional[int]) -> Any:
    """A number of a block.  It shares memory with the others, and is copied so as not to keep them."""
    held = block if element is None else block.passages[element]
    found = held[name]
    return found if len(held.keys()) == 1 else found.copy()


class Lazy:
    """What `Hits` or `Traced` will be: each number an array of dask, by its name: hits.t, hits["p"].

    shape       that of the rays
    passages    of a trace, if they were asked for: one such result for each element

    Several numbers are best computed together, dask.compute(hits.t, hits.p), so that each ray is met once.
    """

    def __init__(self, of: Any, blocks: Array, names: Sequence[str], axis: int, element: Optional[int] = None) -> None:
        self._of, self._blocks, self._axis, self._element = of, blocks, axis, element
        self._names, self._made = tuple(names), {}  # type: tuple[str, ...], dict[str, Array]
        self.shape: tuple[int, ...] = blocks.shape
        self.passages: list[Lazy] = []

    def keys(self) -> tuple[str, ...]:
        """The names of its numbers."""
        return self._names

    def __getitem__(self, name: str) -> Array:
        if name not in self._names:
            raise KeyError(f"{name}: there are {', '.join(self._names)}")
        if name not in self._made:
            kind, count = self._of.FIELDS[name]
            rays = tuple(range(self._blocks.ndim - 1, -1, -1))
            names = rays if count == 1 else (XYZ, *rays) if self._axis == 0 else (*rays, XYZ)
            self._made[name] = da.blockwise(
                partial(_column, name=name, element=self._element), names, self._blocks, rays,
                new_axes={XYZ: count} if count > 1 else None, dtype=np.dtype(kind),
                meta=np.empty((0,) * len(names), kind), token=f"{self._of.__name__}.{name}",
            )
        return self._made[name]

    def __getattr__(self, name: str) -> Array:
        if name.startswith("_") or name not in self._names:
            raise AttributeError(f"no {name!r}; there are {', '.join(self.__dict__.get('_names', ()))}")
        return self[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._names]

    def __repr__(self) -> str:
        many = " x ".join(map(str, self.shape))
        return f"<lazily {self._of.__name__} of {many} rays in {self._blocks.npartitions} blocks: {', '.join(self._names)}>"

    def compute(self, **how: Any) -> Any:
        """The Hits or the Traced of all rays, here.  how: as for dask.compute."""
        every = [self, *self.passages]
        found = iter(dask.compute(*(of[name] for of in every for name in of._names), **how))
        made = [of._result({name: next(found) for name in of._names}) for of in every]
        if self._of is Traced:
            made[0].passages = made[1:]
        return made[0]

    def _result(self, arrays: dict[str, Any]) -> Any:
        result = self._of.__new__(self._of)
        rows = {name: np.ascontiguousarray(np.moveaxis(a, -1, 0) if self._axis and self._of.FIELDS[name][1] > 1 else a)
                for name, a in arrays.items()}
        result._set(rows, 1 if self._axis else 0, None if len(self.shape) == 1 else self.shape)
        return result


def _meet(surface: Surface, o: Any, d: Any, names: Sequence[str], **how: Any) -> Hits:
    out = Hits._make(_rays_of(o, d, how["axis"]), names, how["axis"] % 2)
    hits: Any = surface.intersect(o, d, out=out, **how)
    return hits  # type: ignore[no-any-return]


def _pass(lens: Lens, o: Any, d: Any, names: Sequence[str], passages: Any, **how: Any) -> Traced:
    shape, turned = _rays_of(o, d, how["axis"]), how["axis"] % 2
    out = Traced._make(shape, names, turned)
    out.passages = [Passage._make(shape, passages, turned) for _ in range(len(lens) if passages else 0)]
    return lens.trace(o, d, passages=passages or False, out=out, **how)


def _rays_of(o: Any, d: Any, axis: int) -> tuple[int, ...]:
    """The shape of the rays of a block."""
    shapes = []
    for v in (o, d):
        if isinstance(v, tuple):
            shapes.append(np.broadcast_shapes(*(x.shape for x in v)))
        elif v.ndim > 1:
            shapes.append(v.shape[1:] if axis == 0 else v.shape[:-1])
    return np.broadcast_shapes(*shapes)


def _wanted(of: Any, names: Union[None, str, Collection[str]]) -> tuple[str, ...]:
    several = tuple(of.FIELDS) if names is None else (names,) if isinstance(names, str) else tuple(names)
    for name in several:
        if name not in of.FIELDS:
            raise ValueError(f"of: {of.__name__} has no {name!r}; there are {', '.join(of.FIELDS)}")
    return several


def intersect(
    surface: Surface,
    o: Any,
    d: Any,
    *,
    of: Union[None, str, Collection[str]] = None,
    tmin: Any = None,
    tmax: Any = None,
    axis: Optional[int] = None,
    **options: Any,
) -> Lazy:
    """Surface.intersect() of arrays of dask, block by block: what Hits will be.

    o, d        as there; at least one is, or has, an array of dask.  x, y, z are in one chunk (else they are put into
                one).  A block whose rows are contiguous is used as it is, without a copy
    of          the numbers that are wanted, ("t", "p"); None: all.  Fewer take less time and memory
    tmin, tmax, axis, and the options       as there

    >>> import dask.array as da, sagitta, sagitta.dask
    >>> o = da.stack([da.zeros(1000), da.linspace(0, 12, 1000), da.full(1000, -20.0)]).rechunk((3, 250))
    >>> hits = sagitta.dask.intersect(sagitta.Sphere(radius=10), o, (0, 0, 1), of=("status", "t"))
    >>> hits
    <lazily Hits of 1000 rays in 4 blocks: status, t>
    >>> int((hits.status > 0).sum().compute())
    833
    """
    if not isinstance(surface, Surface):
        raise TypeError(f"surface: must be a Surface, not {type(surface).__name__}")
    names = _wanted(Hits, of)
    ends = {"tmin": tmin, "tmax": tmax}
    blocks, along = _in_blocks(surface, _meet, "intersect", o, d, axis, ends, {"names": names, **options})
    return Lazy(Hits, blocks, names, along)


def trace(
    lens: Lens,
    o: Any,
    d: Any,
    *,
    of: Union[None, str, Collection[str]] = None,
    wavelength: Any = None,
    passages: Union[bool, str, Collection[str]] = False,
    axis: Optional[int] = None,
    **options: Any,
) -> Lazy:
    """Lens.trace() of arrays of dask, block by block: what Traced will be.  o, d and `of` as for intersect(); the other
    arguments as for Lens.trace().

    >>> import dask.array as da, sagitta, sagitta.dask
    >>> lens = sagitta.Lens([sagitta.Element(sagitta.Sphere(radius=10), index=1.5)])
    >>> o = da.stack([da.zeros(8), da.full(8, 6.0), da.full(8, -5.0)]).rechunk((3, 3))
    >>> traced = sagitta.dask.trace(lens, o, (0, 0, 1), of="fate", passages="t")
    >>> traced.passages[0].t.compute()
    array([7., 7., 7., 7., 7., 7., 7., 7.])
    """
    if not isinstance(lens, Lens):
        raise TypeError(f"lens: must be a Lens, not {type(lens).__name__}")
    names, of_passages = _wanted(Traced, of), _names_of(passages)
    fixed = {"names": names, "passages": of_passages, "wavelength": wavelength, **options}
    blocks, along = _in_blocks(lens, _pass, "trace", o, d, axis, {}, fixed)
    traced = Lazy(Traced, blocks, names, along)
    if of_passages:
        traced.passages = [Lazy(Passage, blocks, of_passages, along, e) for e in range(len(lens))]
    return traced


# ------------------------------------------------------------------------------ sums


def _added(start: Sums, *columns: Any, **named: Any) -> Sums:
    sums: Any = start.empty()
    return sums.add(*columns, **named)  # type: ignore[no-any-return]


def _merged(parts: Sequence[Sums]) -> Sums:
    all_of_them = parts[0].empty()  # (a task may not change what it is given)
    for part in parts:
        all_of_them.merge(part)
    return all_of_them


def sums(start: Sums, *columns: Any, **named: Any) -> Delayed:
    """The sums of arrays of dask: each block is summed where it is, and the sums, some 500 bytes each, are merged in
    a tree.  They are exact, so chunks and tree have no part in a bit.

    start       SpotSums(about) or WavefrontSums(); what it has already is added
    columns, weight, error, passed      as for its add(): arrays of dask or numpy of one shape, or numbers

    >>> import dask.array as da, sagitta, sagitta.dask
    >>> x = da.linspace(-1, 1, 1001, chunks=100)
    >>> sagitta.dask.sums(sagitta.SpotSums(), x, x**2, weight=2).compute().spot().geometric
    1.4142135623730951
    """
    if not isinstance(start, (SpotSums, WavefrontSums)):
        raise TypeError(f"start: must be SpotSums or WavefrontSums, not {type(start).__name__}")
    given: dict[Any, Any] = {**dict(enumerate(columns)), **named}
    names = [name for name, x in given.items() if np.ndim(x)]
    arrays = [x if isinstance(x, da.Array) else da.from_array(np.asarray(x)) for x in (given[n] for n in names)]
    if len({x.shape for x in arrays}) != 1:
        raise ValueError(f"sums: arrays of one shape are needed, not {', '.join(str(x.shape) for x in arrays) or 'none'}")
    axes = tuple(range(arrays[0].ndim))
    blocks = [x.to_delayed().ravel() for x in da.core.unify_chunks(*(y for x in arrays for y in (x, axes)))[1]]
    first, add, merge = delayed(start, pure=False), delayed(_added), delayed(_merged)
    parts = [first]
    for of_block in zip(*blocks):
        now = {**given, **dict(zip(names, of_block))}
        parts.append(add(first, *(now.pop(i) for i in range(len(columns))), **now))
    while len(parts) > 1:
        parts = [merge(parts[i : i + WIDE]) for i in range(0, len(parts), WIDE)]
    return parts[0]


# -------------------------------------------------------------------------- analyses


def _share(lens: Lens, name: str, asked: dict[str, Any], number: int, of: int) -> bytes:
    return zlib.compress(ask(lens, name, asked, number, of, ()), 1)


def _joined(lens: Lens, name: str, asked: dict[str, Any], parts: list[bytes]) -> Any:
    return ask(lens, name, asked, 0, len(parts), [zlib.decompress(part) for part in parts])


def analysis(lens: Lens, name: str, parts: int, field: Any = None, wavelength: Any = None, **asked: Any) -> Delayed:
    """lens.spot(...) and its kin in so many parts, each a task: the Answer, to the last bit that of one run.

    Which rays a part has depends on its number alone, so nothing but the lens is sent to a worker, and of analyses
    that sum nothing but sums comes back: as many parts as keep all workers busy, some ten for each thread.

    >>> import sagitta, sagitta.dask
    >>> lens = sagitta.Lens.text("{pupil: {semi_diameter: 5}, fields: [0, 2], surfaces: ["
    ...     "{type: sphere, radius: 50, thickness: 98, index: 1.5}, {type: plane}]}")
    >>> spot = sagitta.dask.analysis(lens, "spot", 7, pattern="random", rays=9000).compute()
    >>> spot == lens.spot(pattern="random", rays=9000)
    True
    """
    if not isinstance(lens, Lens):
        raise TypeError(f"lens: must be a Lens, not {type(lens).__name__}")
    if not isinstance(parts, int) or parts < 1:
        raise ValueError(f"parts: must be a whole number above 0, not {parts!r}")
    given = {"field": field, "wavelength": wavelength, **asked}
    there, what = delayed(lens, pure=True), delayed(given, pure=False, traverse=False)
    share = delayed(_share)
    made = [share(there, name, what, k, parts) for k in range(1, parts + 1)]
    return delayed(_joined)(there, name, what, made)


__all__ = ["Lazy", "analysis", "intersect", "sums", "trace"]
