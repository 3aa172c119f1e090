# SPDX-License-Identifier: MIT
"""Arrays of numpy as the library wants them: three rows of doubles for vectors.

A vector argument is one of these:

    (3,)              one vector, for one ray or for all
    (3, n)            n vectors: x[0] are all their x.  Used as it is if each row is contiguous doubles
    (n, 3)            n vectors, one a row: it is copied, which costs 24 bytes read and written a ray.
                      The transposed view of a (3, n) array is no copy
    (3, ny, nx ...), (ny, nx ..., 3)    the same of rays that stand in an array of the shape (ny, nx ...)
    (x, y, z)         three arrays of one shape, used as they are; a number stands for an array of it

Where the first and the last axis are both 3 it can be read both ways and is refused, unless `axis` says which
of the two holds x, y, z: axis=0 or axis=-1.  The shapes of the rays of o, d and their ends are broadcast as
numpy does it.  To the library all rays are in one row, in the order of C.  An array of rays is looked at as
that row, and the answers are rows that are looked at in the shape of the rays.
"""
from __future__ import annotations

import ctypes
import functools
import math
from typing import (
    Any,
    Callable,
    Generic,
    Iterable,
    Iterator,
    Literal,
    NamedTuple,
    Optional,
    Sequence,
    TypeVar,
    Union,
    overload,
)

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _library as C
from ._tables import Dims, Floats, Table, Tabular, alike, ray_axes

# One vector, and many.  (An array may be either: to a type it is many.)
Vector = Sequence[float]
Numbers1 = Union[NDArray[Any], Sequence[float], Sequence[Sequence[float]]]  # not one number, but an array
Vectors = Union[NDArray[Any], Sequence[Union[NDArray[Any], Sequence[float], Sequence[Sequence[float]]]]]
VectorsLike = Union[ArrayLike, Sequence[ArrayLike]]
Rows = Union[Floats, list[Floats]]  # three rows

# What a result may be indexed by: its names, by the type of their arrays, and the rays.
Doubles = Literal["t", "t_err", "t_lo", "p", "n", "p_err", "o", "d", "opl", "direction"]
Bytes = Literal["status", "side", "fate"]
Ints = Literal["evals", "passed"]
Numbers = Union[Floats, NDArray[np.int8], NDArray[np.int32]]

F8 = np.dtype(np.float64)
U1 = np.dtype(np.uint8)
_pack_rays = C.packer(C.Rays)
_ndarray, _addressof = np.ndarray, ctypes.addressof
_from_buffer: Callable[[Any], Any] = ctypes.c_char.from_buffer


def address(array: NDArray[Any]) -> int:
    """Where the numbers of an array are."""
    try:
        return _addressof(_from_buffer(array))  # a third of the time
    except (TypeError, ValueError):  # read-only, not contiguous, empty
        result: int = array.__array_interface__["data"][0]
        return result


def doubles(x: ArrayLike, name: str) -> Floats:
    """x as doubles, without a copy if that is what they are."""
    a = np.asarray(x)
    if a.dtype.kind not in "fiu":
        raise TypeError(f"{name}: must be real numbers, not {a.dtype}")
    return np.asarray(a, dtype=np.float64)


def row(a: Floats) -> Floats:
    """A one-dimensional array that the library can read."""
    return a if a.flags.c_contiguous and a.flags.aligned else a.copy()


Shape = tuple[int, ...]


def count_of(shape: Shape) -> int:
    return math.prod(shape)


def ambiguous(name: str, shape: Shape) -> ValueError:
    said, last = "read with x, y, z along its first axis or its last", f"axis=-1 if {name}[..., 0] are"
    if len(shape) == 2:
        said, last = "three vectors in columns or in rows", f"axis=1 if {name}[:, 0] are"
    return ValueError(f"{name}: {shape} can be {said}; say axis=0 if {name}[0] are the x of all, {last}")


def _is_xyz(x: Any) -> bool:
    """Three arrays, or arrays and numbers."""
    return (
        isinstance(x, (tuple, list))
        and len(x) == 3
        and any(isinstance(v, np.ndarray) and v.ndim for v in x)
        and all(isinstance(v, (np.ndarray, np.generic, int, float)) for v in x)
    )


def rows_of(x: VectorsLike, name: str, axis: Optional[int]) -> tuple[Rows, Optional[int], Shape]:
    """Three rows; the axis that holds x, y, z, 0 or 1 (the last), or None of a single vector; the shape of
    the rays."""
    if _is_xyz(x):
        parts = [doubles(v, name) for v in x]  # type: ignore[union-attr]
        if len({v.shape for v in parts}) != 1:
            try:
                parts = list(np.broadcast_arrays(*parts))
            except ValueError:
                raise ValueError(
                    f"{name}: x, y and z have {', '.join(_numbers(v.shape) for v in parts)} numbers; "
                    "they must have as many"
                ) from None
        return [row(v.reshape(-1)) for v in parts], 0, parts[0].shape
    a = doubles(x, name)  # type: ignore[arg-type]
    if a.shape == (3,):
        return (a if a.flags.aligned else a.copy()).reshape(3, 1), None, ()
    if a.ndim < 2 or 3 not in (a.shape[0], a.shape[-1]):
        raise ValueError(
            f"{name}: has the shape {a.shape}; it must be (3,), (3, n) or (n, 3), or (3, ...) or (..., 3)"
        )
    if axis is None:
        if a.shape[0] == a.shape[-1] == 3:
            raise ambiguous(name, a.shape)
        last = a.shape[0] != 3
    else:
        if axis not in (0, -a.ndim, -1, a.ndim - 1):
            raise ValueError(f"axis: of {name} with {a.ndim} axes it must be 0 or -1, not {axis}")
        last = axis in (-1, a.ndim - 1)
        if a.shape[-1 if last else 0] != 3:
            raise ValueError(
                f"{name}: has the shape {a.shape}, and axis={axis} says that it is "
                + (("(n, 3)" if last else "(3, n)") if a.ndim == 2 else "(..., 3)" if last else "(3, ...)")
            )
    if last:
        a = a.T if a.ndim == 2 else np.moveaxis(a, -1, 0)
    shape = a.shape[1:]
    if a.ndim > 2:
        a = a.reshape(3, count_of(shape))
    if (a.shape[1] > 1 and a.strides[1] != 8) or not a.flags.aligned:
        a = a.copy(order="C")
    return a, int(last), shape


def _numbers(shape: Shape) -> str:
    return str(shape[0]) if len(shape) == 1 else str(shape)


def common(shapes: dict[str, Shape]) -> Shape:
    """The shape that all have together."""
    found = set(shapes.values())
    if len(found) == 1:
        return found.pop()
    try:
        return tuple(np.broadcast_shapes(*found))
    except ValueError:
        raise ValueError(
            "the arrays are about different numbers of rays: "
            + ", ".join(f"{name} {_numbers(shape)}" for name, shape in shapes.items())
        ) from None


def spread(rows: Rows, shape: Shape, over: Shape) -> Rows:
    """Rows of rays of one shape, as often as a shape that it is broadcast to wants them."""
    if shape == over:
        return rows
    wide = np.empty((len(rows), *over))
    for place, x in zip(wide, rows):
        place[...] = np.reshape(x, shape)
    return wide.reshape(len(rows), count_of(over))


def _addresses(rows: Rows) -> Iterable[int]:
    if isinstance(rows, list):
        return map(address, rows)
    first, step = address(rows), rows.strides[0]
    return first, first + step, first + 2 * step


class RayArrays:
    """Rays, checked.  The arrays stay the caller's where they could.

    o, d   three rows each        keep   tmin and tmax, or None
    at     the addresses of these eight rows, as sgt_rays has them; 0: none.  If those of the second and
           third row of o or d are 0, they follow the first without a gap
    axis   which axis of the answers holds x, y, z: 0, or 1, the last
    shape  of the rays; None: (n,)
    one    o and d are single vectors
    """

    n: int
    one = False
    axis = 0
    shape: Optional[Shape] = None
    o: Rows
    d: Rows
    keep: Sequence[Optional[Floats]] = (None, None)
    at: tuple[int, ...]

    def __init__(
        self,
        o: VectorsLike,
        d: VectorsLike,
        tmin: Optional[ArrayLike] = None,
        tmax: Optional[ArrayLike] = None,
        axis: Optional[int] = None,
    ) -> None:
        # Contiguous (3, n) without ends: what follows looks at each row, and takes ten times as long.
        if type(o) is type(d) is _ndarray and tmin is None and tmax is None:
            shape = o.shape
            if (
                shape == d.shape
                and len(shape) == 2
                and shape[0] == 3
                and ((shape[1] != 3 and axis is None) or axis == 0)
                and o.dtype == d.dtype == F8
            ):
                try:
                    a, b = _addressof(_from_buffer(o)), _addressof(_from_buffer(d))
                except (TypeError, ValueError):  # as in address()
                    pass
                else:
                    if not (a | b) & 7:
                        self.n, self.o, self.d, self.at = shape[1], o, d, (a, 0, 0, b, 0, 0, 0, 0)
                        return
        self._look(o, d, tmin, tmax, axis)

    def _look(
        self,
        o: VectorsLike,
        d: VectorsLike,
        tmin: Optional[ArrayLike],
        tmax: Optional[ArrayLike],
        axis: Optional[int],
    ) -> None:
        if axis is not None and (not isinstance(axis, (int, np.integer)) or isinstance(axis, bool)):
            raise ValueError(f"axis: must be 0, -1 or None, not {axis!r}")
        rows_o, axis_o, shape_o = rows_of(o, "o", axis)
        rows_d, axis_d, shape_d = rows_of(d, "d", axis)
        shapes = {n: s for n, s, a in (("o", shape_o, axis_o), ("d", shape_d, axis_d)) if a is not None}
        ends = {n: doubles(x, n) for n, x in (("tmin", tmin), ("tmax", tmax)) if x is not None}
        shapes.update((name, end.shape) for name, end in ends.items() if end.ndim)
        self.one = not shapes
        shape = common(shapes) if shapes else (1,)
        self.n = n = count_of(shape)
        if len(shape) != 1:
            self.shape = shape
        self.axis = axis_o if axis_o is not None else axis_d if axis_d is not None else 0
        self.o = spread(rows_o, shape_o if axis_o is not None else (), shape)
        self.d = spread(rows_d, shape_d if axis_d is not None else (), shape)
        self.keep = [
            None if end is None else row(spread([end], end.shape, shape)[0].reshape(n))
            for end in (ends.get("tmin"), ends.get("tmax"))
        ]
        self.at = (
            *_addresses(self.o),
            *_addresses(self.d),
            *(0 if x is None else address(x) for x in self.keep),
        )

    @property
    def rows_at(self) -> tuple[int, ...]:
        """The addresses of all rows."""
        a, a2, _, b, b2, _, *ends = self.at
        step = 8 * self.n
        return self.at if a2 or b2 else (a, a + step, a + 2 * step, b, b + step, b + 2 * step, *ends)

    @property
    def struct(self) -> C.Rays:
        return C.Rays.from_buffer_copy(_pack_rays(*self.rows_at))


# From so many rays on each column has memory of its own: a column of doubles is then 4 MiB, for which numpy
# asks the system for large pages by itself.  With fewer rays they share a block, which is one call for memory
# and not ten.  (100,000 rays through 7 elements, with four numbers of each: 197 ns a ray, and 265 by columns.)
LARGE = 2**19
SMALL = 4096  # bytes; below that a bytearray is had 130 ns sooner than an array of numpy


class Places(NamedTuple):
    """Columns in a block (columns_of in bridge.c): doubles, then ints, then bytes.

    names   in the order in which they were asked for
    before  how many bytes a ray are in front of each
    width   bytes a ray
    bits    the sum of 1 << k of those that are the k-th of FIELDS
    """

    names: tuple[str, ...]
    before: dict[str, int]
    width: int
    bits: int


@functools.lru_cache(maxsize=1024)
def places_of(of: Any, names: tuple[str, ...]) -> Places:
    """names: (): all."""
    names = names or tuple(of.FIELDS)
    sizes = {name: np.dtype(of._field(name)[0]).itemsize for name in names}
    before, width = {}, 0
    for name in sorted(sizes, key=lambda name: (-sizes[name], list(of.FIELDS).index(name))):
        before[name] = width
        width += sizes[name] * of.FIELDS[name][1]
    return Places(names, before, width, sum(1 << k for k, name in enumerate(of.FIELDS) if name in sizes))


def _whole(cls: Any, n: Any) -> int:
    if not isinstance(n, (int, np.integer)) or n < 0:
        raise ValueError(f"{cls.__name__}: the number of rays must be a whole number, not {n!r}")
    return int(n)


class Column:
    """A number of Columns as an attribute: it makes the array when it is first read.  Then the array itself is
    the attribute."""

    def __init__(self, name: str, kind: str, count: int) -> None:
        self.name, self.kind, self.count = name, np.dtype(kind), count

    def __get__(self, of: "Optional[Columns[Any]]", owner: Any = None) -> Any:
        if of is None:
            return self
        name = self.name
        a = of._views.get(name)
        if a is None:
            before = of._places.before.get(name)
            if before is None:
                a = of._missing(name)
            else:
                n = of.size
                shape: Any = n if self.count == 1 else (self.count, n)
                a = np.ndarray(shape, self.kind, of._block, of._from + n * before)
            of._views[name] = a
        shape = of._shape
        if shape is not None:
            a = a.reshape(shape if self.count == 1 else (self.count, *shape))
        if of._axis == 1 and self.count > 1:
            a = a.T if shape is None else np.moveaxis(a, 0, -1)
        of.__dict__[name] = a
        return a


Rest = Union[slice, "ellipsis", None, list[int], list[bool], NDArray[Any], tuple[Any, ...]]
One = TypeVar("One", covariant=True)  # one ray of a result
Some = TypeVar("Some", bound="Columns[Any]")


class Columns(Tabular, Generic[One]):
    """A result: one array for each number, by its name: hits["t"] is hits.t.  `for hit in hits` goes over all
    rays, in the order of C, and hits[k] is one of them; hits[iy, ix] of rays in more axes.  hits[2:5],
    hits[hits.met], hits[0, ...] are some of the rays, as numpy has it: a copy.

    An array is made when it is first read: a view of a block that the library has written to.
    """

    # name: the type of numpy, and how many numbers
    FIELDS: dict[str, tuple[str, int]] = {}
    size: int
    _axis = 0
    _shape: Optional[Shape] = None  # None: (size,)
    _views: dict[str, NDArray[Any]]  # those that have been made, as (n,) or (3, n)
    _places: Places
    _block: Union[None, bytearray, NDArray[np.uint8]] = None
    _base = 0  # the address where the columns begin,
    _from = 0  # and their place in the block
    _c: Any = None

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        for name, (kind, count) in cls.FIELDS.items():
            setattr(cls, name, Column(name, kind, count))

    def __init__(self, **arrays: NDArray[Any]) -> None:
        if not arrays:
            raise ValueError(f"{type(self).__name__}: give at least one of {', '.join(self.FIELDS)}")
        self._set(arrays)

    @classmethod
    def _make(
        cls, n: Union[int, Shape], fields: Sequence[str] = (), axis: int = 0, shape: Optional[Shape] = None
    ) -> "Any":
        if isinstance(n, tuple):
            shape = tuple(_whole(cls, x) for x in n)
            n, shape = count_of(shape), None if len(shape) == 1 else shape
        if type(n) is not int or n < 0:
            n = _whole(cls, n)
        places = places_of(cls, tuple(fields))
        if n < LARGE:
            return cls._in_block(n, places, axis, shape)
        self = cls.__new__(cls)
        self.size, self._axis, self._places, self._shape = n, axis, places, shape
        self._views = {name: cls._column(n, name) for name in places.names}
        return self

    @classmethod
    def _in_block(cls, n: int, places: Places, axis: int, shape: Optional[Shape] = None) -> "Any":
        self = cls.__new__(cls)
        self.size, self._views, self._places = n, {}, places
        size = n * places.width + 8  # (8: never empty)
        block: Any = bytearray(size) if size < SMALL else np.empty(size, U1)
        self._block, self._base = block, _addressof(_from_buffer(block))
        if axis:
            self._axis = axis
        if shape is not None:
            self._shape = shape
        return self

    @classmethod
    def _column(cls, n: int, name: str) -> NDArray[Any]:
        kind, count = cls._field(name)
        return np.empty(n if count == 1 else (count, n), kind)

    @classmethod
    def _field(cls, name: str) -> tuple[str, int]:
        if name not in cls.FIELDS:
            raise ValueError(f"{cls.__name__} has no {name!r}; it may have {', '.join(cls.FIELDS)}")
        return cls.FIELDS[name]

    def _set(self, arrays: dict[str, NDArray[Any]], axis: int = 0, shape: Optional[Shape] = None) -> None:
        """Takes arrays (n,) and (3, n), or of rays in more axes.  shape: that of the rays, if it is not n."""
        found, rows = None, {}
        for name, a in arrays.items():
            kind, count = self._field(name)
            if not isinstance(a, np.ndarray):
                raise TypeError(f"out: {name} must be an array of numpy, not {type(a).__name__}")
            if a.dtype != np.dtype(kind):
                raise TypeError(f"out: {name} must be {np.dtype(kind)}, not {a.dtype}")
            if not a.flags.writeable:
                raise ValueError(f"out: {name} is read-only")
            first = 0 if count == 1 else 1
            if a.ndim < 1 + first or (first and a.shape[0] != count):
                want = f"({count}, n)" if first else "(n,)"
                raise ValueError(f"out: {name} has the shape {a.shape}; it must be {want}")
            of = a.shape[first:]
            if len(of) > 1:
                if not (a[0] if first else a).flags.c_contiguous:
                    raise ValueError(f"out: {name} must be contiguous along the axes of the rays")
                a = a.reshape(*a.shape[:first], count_of(of))
            if a.shape[-1] > 1 and (a.strides[-1] != a.itemsize or not a.flags.aligned):
                raise ValueError(f"out: {name} must be contiguous along its last axis")
            if found is not None and found != of:
                many, before = _numbers(of), _numbers(found)
                raise ValueError(f"out: {name} has room for {many} rays, the arrays before it for {before}")
            found, rows[name] = of, a
        of = found or (0,)
        self.size, self._axis, self._views = count_of(of), axis, rows
        self._shape = shape if shape is not None else of if len(of) != 1 else None
        self._places = Places(tuple(arrays), {}, 0, 0)

    @property
    def _names(self) -> tuple[str, ...]:
        return self._places.names

    def _row(self, name: str) -> NDArray[Any]:
        """The array of a number, (n,) or (3, n)."""
        getattr(self, name)
        return self._views[name]

    def _missing(self, name: str) -> NDArray[Any]:
        raise AttributeError(f"{name} was not asked for; there are {', '.join(self._names)}")

    @property
    def _rows(self) -> dict[str, NDArray[Any]]:
        return {name: self._row(name) for name in self._names}

    @property
    def _struct(self) -> Any:
        """What the library writes to."""
        if self._c is None:
            self._c = self._fill()
        return self._c

    def _fill(self) -> Any:
        raise NotImplementedError

    def _at(self, name: str) -> int:
        """The address of a number, if it has one; 0: none."""
        if self._block is not None and name in self._places.before:
            return self._base + self.size * self._places.before[name]
        return address(self._views[name]) if name in self._views else 0

    def _three(self, name: str) -> tuple[int, int, int]:
        first = self._at(name)
        step = self._views[name].strides[0] if name in self._views else 8 * self.size
        return (first, first + step, first + 2 * step) if first else (0, 0, 0)

    @property
    def shape(self) -> Shape:
        """That of the rays: (n,), or as their arrays have it without the axis of x, y, z."""
        return (self.size,) if self._shape is None else self._shape

    def __len__(self) -> int:
        """The number of rays, whatever their shape."""
        return self.size

    def keys(self) -> tuple[str, ...]:
        """The names of its numbers."""
        return self._names

    def _row_of(self, name: str, k: int) -> Any:
        """A number of a ray, or the numbers of a vector."""
        return self._row(name)[..., k].tolist()

    def _one(self, k: int) -> One:
        """Ray k of all."""
        raise NotImplementedError

    def __iter__(self) -> Iterator[One]:
        return (self._one(k) for k in range(self.size))

    @overload
    def __getitem__(self, key: Doubles) -> Floats: ...
    @overload
    def __getitem__(self, key: Bytes) -> NDArray[np.int8]: ...
    @overload
    def __getitem__(self, key: Ints) -> NDArray[np.int32]: ...
    @overload
    def __getitem__(self, key: str) -> Numbers: ...
    @overload
    def __getitem__(self, key: Union[int, tuple[int, ...]]) -> One: ...
    @overload
    def __getitem__(self: Some, key: Rest) -> Some: ...

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str):
            if key not in self._names:
                raise KeyError(f"{key}: there are {', '.join(self._names)}")
            return getattr(self, key)
        at = np.arange(self.size).reshape(self.shape)[key]
        if at.ndim == 0:
            return self._one(int(at))
        one = key if isinstance(key, tuple) else (key,)
        if all(isinstance(x, (int, np.integer)) for x in one):
            raise IndexError(
                f"{', '.join(map(str, one))} is about {len(one)} of the {len(self.shape)} axes of the rays; "
                f"for all along the others say [{', '.join(map(str, one))}, ...]"
            )
        return self._some(at)

    def _some(self: Some, at: NDArray[Any]) -> Some:
        """The rays of these places, in their shape."""
        new, flat = type(self).__new__(type(self)), at.reshape(-1)
        rows = {name: np.ascontiguousarray(row[..., flat]) for name, row in self._rows.items()}
        new._set(rows, self._axis, None if at.ndim == 1 else at.shape)
        return new

    def __eq__(self, other: object) -> bool:
        """The same numbers of rays of the same shape; a NaN is equal to a NaN."""
        if not isinstance(other, Columns) or type(self) is not type(other):
            return NotImplemented
        return (
            (self.shape, self._axis, set(self._names)) == (other.shape, other._axis, set(other._names))
            and all(alike(row, other._row(name)) for name, row in self._rows.items())
        )

    __hash__ = None  # type: ignore[assignment]

    def _table(self, dims: Dims) -> Table:
        axes = ray_axes(self.shape, dims)
        return {
            name: (("xyz",) * (row.ndim - 1) + axes, row.reshape(*row.shape[:-1], *self.shape))
            for name, row in self._rows.items()
        }

    def __getstate__(self) -> dict[str, Any]:
        return {"arrays": self._rows, "axis": self._axis, "shape": self._shape}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._set(state["arrays"], state["axis"], state["shape"])

    def __repr__(self) -> str:
        many = self.size if self._shape is None else " x ".join(map(str, self._shape))
        return f"<{type(self).__name__} of {many} rays: {', '.join(self._names)}>"

    def table(self) -> NDArray[Any]:
        """All of it as one structured array, with a field for each number: a copy."""
        fields = [
            (name, *((kind,) if count == 1 else (kind, (count,))))
            for name, (kind, count) in self.FIELDS.items()
            if name in self._names
        ]
        table = np.empty(self.size, fields)
        for name, a in self._rows.items():
            table[name] = a.T
        return table.reshape(self.shape)

    def _settle(self) -> None:
        """Makes room for what has none yet, to be written to."""

    def _void(self, status: str, stopped: int) -> None:
        """What a call that was stopped leaves: NaN everywhere."""
        for name, a in self._rows.items():
            a[...] = np.nan if a.dtype.kind == "f" else stopped if name == status else 0

    def _check(self, rays: RayArrays, may_be: Sequence[str] = ()) -> None:
        if self.size != rays.n:
            raise ValueError(f"out has room for {self.size} rays; there are {rays.n}")
        if self._shape != rays.shape and not rays.one:
            raise ValueError(f"out has the shape {self.shape}; that of the rays is {rays.shape or (rays.n,)}")
        for name, a in self._views.items():
            if not a.flags.writeable:
                raise ValueError(f"out: {name} is read-only")
        if self._block is not None:  # its columns are apart, and all within it
            begin, size = _addressof(_from_buffer(self._block)), len(self._block)
            if not any(begin - 8 * self.size < at < begin + size for at in rays.rows_at):
                return
        outs = [(name, part) for name, a in self._rows.items() for part in np.atleast_2d(a)]
        ins = [x for x in (*rays.o, *rays.d, *rays.keep) if x is not None]
        for i, (name, part) in enumerate(outs):
            same = [x for x in ins if np.may_share_memory(part, x)]
            if same and not (name in may_be and all(address(x) == address(part) for x in same)):
                raise ValueError(f"out: {name} overlaps the rays")
            if any(np.may_share_memory(part, other) for _, other in outs[:i]):
                raise ValueError(f"out: {name} overlaps another array of out")
