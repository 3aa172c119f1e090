"""Arrays of numpy as the library wants them: three rows of doubles for vectors.

A vector argument is one of these:

    (3,)              one vector, for one ray or for all
    (3, n)            n vectors: x[0] are all their x.  Used as it is if each row is contiguous doubles
    (n, 3)            n vectors, one a row: it is copied, which costs 24 bytes read and written a ray.
                      The transposed view of a (3, n) array is no copy
    (x, y, z)         three arrays of one length, used as they are

(3, 3) can be read both ways and is refused, unless `axis` says which axis holds x, y, z: axis=0 or axis=1.
"""
from __future__ import annotations

import ctypes
import functools
from typing import Any, Callable, Hashable, Iterable, NamedTuple, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _library as C

Floats = NDArray[np.float64]
VectorsLike = Union[ArrayLike, Sequence[ArrayLike]]
Rows = Union[Floats, list[Floats]]  # three rows

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


def ambiguous(name: str) -> ValueError:
    return ValueError(
        f"{name}: (3, 3) can be three vectors in columns or in rows; say axis=0 if "
        f"{name}[0] are the x of all, axis=1 if {name}[:, 0] are"
    )


def rows_of(x: VectorsLike, name: str, axis: Optional[int]) -> tuple[Rows, Optional[int]]:
    """Three rows, and the axis that holds x, y, z: 0, 1, or None of a single vector."""
    if (
        isinstance(x, (tuple, list))
        and len(x) == 3
        and all(isinstance(v, np.ndarray) and v.ndim == 1 for v in x)
    ):
        parts = [row(doubles(v, name)) for v in x]
        if len({len(v) for v in parts}) != 1:
            raise ValueError(
                f"{name}: x, y and z have {', '.join(str(len(v)) for v in parts)} numbers; "
                "they must have as many"
            )
        return parts, 0
    a = doubles(x, name)  # type: ignore[arg-type]
    if a.shape == (3,):
        return (a if a.flags.aligned else a.copy()).reshape(3, 1), None
    if a.ndim != 2 or 3 not in a.shape:
        raise ValueError(f"{name}: has the shape {a.shape}; it must be (3,), (3, n) or (n, 3)")
    if axis is None:
        if a.shape == (3, 3):
            raise ambiguous(name)
        axis = 0 if a.shape[0] == 3 else 1
    axis %= 2
    if a.shape[axis] != 3:
        raise ValueError(
            f"{name}: has the shape {a.shape}, and axis={axis} says that it is "
            + ("(3, n)" if axis == 0 else "(n, 3)")
        )
    if axis == 1:
        a = a.T
    if (a.shape[1] > 1 and a.strides[1] != 8) or not a.flags.aligned:
        a = a.copy(order="C")
    return a, axis


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
    axis   which axis of the answers holds x, y, z
    one    o and d are single vectors
    """

    n: int
    one = False
    axis = 0
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
        if axis not in (None, 0, 1, -1, -2):
            raise ValueError(f"axis: must be 0, 1 or None, not {axis!r}")
        rows_o, axis_o = rows_of(o, "o", axis)
        rows_d, axis_d = rows_of(d, "d", axis)
        ends = [None if x is None else doubles(x, name) for x, name in ((tmin, "tmin"), (tmax, "tmax"))]
        lengths = {
            name: len(rows[0])
            for name, rows, a in (("o", rows_o, axis_o), ("d", rows_d, axis_d))
            if a is not None
        }
        for name, end in zip(("tmin", "tmax"), ends):
            if end is not None and end.ndim > 1:
                raise ValueError(
                    f"{name}: has the shape {end.shape}; it must be one number, or one for each ray"
                )
            if end is not None and end.ndim == 1:
                lengths[name] = len(end)
        if len(set(lengths.values())) > 1:
            raise ValueError(
                "the arrays are about different numbers of rays: "
                + ", ".join(f"{name} {n}" for name, n in lengths.items())
            )
        self.one = not lengths
        self.n = n = 1 if self.one else next(iter(lengths.values()))
        self.axis = axis_o if axis_o is not None else axis_d if axis_d is not None else 0
        self.o = rows_o if axis_o is not None or n == 1 else np.repeat(rows_o, n, axis=1)
        self.d = rows_d if axis_d is not None or n == 1 else np.repeat(rows_d, n, axis=1)
        self.keep = [None if x is None else np.full(n, x) if x.ndim == 0 else row(x) for x in ends]
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


class Column:
    """A number of Columns as an attribute: it makes the array when it is first read.  Then the array itself is
    the attribute."""

    def __init__(self, name: str, kind: str, count: int) -> None:
        self.name, self.kind, self.count = name, np.dtype(kind), count

    def __get__(self, of: "Optional[Columns]", owner: Any = None) -> Any:
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
        if of._axis == 1 and self.count > 1:
            a = a.T
        of.__dict__[name] = a
        return a


class Columns:
    """A result: one array for each number.  An array is made when it is first read: a view of a block that
    the library has written to."""

    # name: the type of numpy, and how many numbers
    FIELDS: dict[str, tuple[str, int]] = {}
    size: int
    _axis = 0
    _views: dict[str, NDArray[Any]]  # those that have been made, as (n,) or (3, n)
    _places: Places
    _block: Union[None, bytearray, NDArray[np.uint8]] = None
    _base = 0  # the address where the columns begin,
    _from = 0  # and their place in the block
    _c: Any = None

    def __init_subclass__(cls) -> None:
        for name, (kind, count) in cls.FIELDS.items():
            setattr(cls, name, Column(name, kind, count))

    def __init__(self, **arrays: NDArray[Any]) -> None:
        if not arrays:
            raise ValueError(f"{type(self).__name__}: give at least one of {', '.join(self.FIELDS)}")
        self._set(arrays)

    @classmethod
    def _make(cls, n: int, fields: Sequence[str] = (), axis: int = 0) -> "Any":
        if type(n) is not int or n < 0:
            if not isinstance(n, (int, np.integer)) or n < 0:
                raise ValueError(f"{cls.__name__}: the number of rays must be a whole number, not {n!r}")
            n = int(n)
        places = places_of(cls, tuple(fields))  # type: ignore[arg-type]
        if n < LARGE:
            return cls._in_block(n, places, axis)
        self = cls.__new__(cls)
        self.size, self._axis, self._places = n, axis, places
        self._views = {name: cls._column(n, name) for name in places.names}
        return self

    @classmethod
    def _in_block(cls, n: int, places: Places, axis: int) -> "Any":
        self = cls.__new__(cls)
        self.size, self._views, self._places = n, {}, places
        size = n * places.width + 8  # (8: never empty)
        block: Any = bytearray(size) if size < SMALL else np.empty(size, U1)
        self._block, self._base = block, _addressof(_from_buffer(block))
        if axis:
            self._axis = axis
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

    def _set(self, arrays: dict[str, NDArray[Any]], axis: int = 0) -> None:
        n = None
        for name, a in arrays.items():
            kind, count = self._field(name)
            if not isinstance(a, np.ndarray):
                raise TypeError(f"out: {name} must be an array of numpy, not {type(a).__name__}")
            if a.dtype != np.dtype(kind):
                raise TypeError(f"out: {name} must be {np.dtype(kind)}, not {a.dtype}")
            if not a.flags.writeable:
                raise ValueError(f"out: {name} is read-only")
            if a.ndim != (1 if count == 1 else 2) or (count > 1 and a.shape[0] != count):
                want = "(n,)" if count == 1 else f"({count}, n)"
                raise ValueError(f"out: {name} has the shape {a.shape}; it must be {want}")
            if a.shape[-1] > 1 and (a.strides[-1] != a.itemsize or not a.flags.aligned):
                raise ValueError(f"out: {name} must be contiguous along its last axis")
            if n not in (None, a.shape[-1]):
                raise ValueError(f"out: {name} has room for {a.shape[-1]} rays, the arrays before it for {n}")
            n = a.shape[-1]
        self.size, self._axis, self._views = int(n or 0), axis, dict(arrays)
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

    def __len__(self) -> int:
        return self.size

    def __getstate__(self) -> dict[str, Any]:
        return {"arrays": self._rows, "axis": self._axis}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._set(state["arrays"], state["axis"])

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.size} rays: {', '.join(self._names)}>"

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
        return table

    def _settle(self) -> None:
        """Makes room for what has none yet, to be written to."""

    def _void(self, status: str, stopped: int) -> None:
        """What a call that was stopped leaves: NaN everywhere."""
        for name, a in self._rows.items():
            a[...] = np.nan if a.dtype.kind == "f" else stopped if name == status else 0

    def _check(self, rays: RayArrays, may_be: Sequence[str] = ()) -> None:
        if self.size != rays.n:
            raise ValueError(f"out has room for {self.size} rays; there are {rays.n}")
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
