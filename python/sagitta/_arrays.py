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

from typing import Any, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _library as C

Floats = NDArray[np.float64]
VectorsLike = Union[ArrayLike, Sequence[ArrayLike]]


def address(array: NDArray[Any]) -> int:
    """Where the numbers of an array are."""
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
    return a if a.flags.c_contiguous and a.flags.aligned else np.ascontiguousarray(a)


def ambiguous(name: str) -> ValueError:
    return ValueError(
        f"{name}: (3, 3) can be three vectors in columns or in rows; say axis=0 if "
        f"{name}[0] are the x of all, axis=1 if {name}[:, 0] are"
    )


def rows_of(x: VectorsLike, name: str, axis: Optional[int]) -> tuple[list[Floats], Optional[int]]:
    """Three rows, and the axis that holds x, y, z: 0, 1, or None of a single vector."""
    if axis not in (None, 0, 1, -1, -2):
        raise ValueError(f"axis: must be 0, 1 or None, not {axis!r}")
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
        return [a[0:1], a[1:2], a[2:3]], None
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
    if a.shape[1] > 1 and (a.strides[1] != 8 or not a.flags.aligned):
        a = np.ascontiguousarray(a)
    return [a[0], a[1], a[2]], axis


class RayArrays:
    """Rays, checked, and the struct that the library reads.  The arrays stay the caller's where they
    could."""

    __slots__ = ("n", "one", "axis", "struct", "o", "d", "keep")

    def __init__(
        self,
        o: VectorsLike,
        d: VectorsLike,
        tmin: Optional[ArrayLike] = None,
        tmax: Optional[ArrayLike] = None,
        axis: Optional[int] = None,
    ) -> None:
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
        self.o = rows_o if axis_o is not None or n == 1 else [np.full(n, x[0]) for x in rows_o]
        self.d = rows_d if axis_d is not None or n == 1 else [np.full(n, x[0]) for x in rows_d]
        self.keep = [None if x is None else np.full(n, x) if x.ndim == 0 else row(x) for x in ends]
        self.struct = C.Rays(
            C.Addresses(*map(address, self.o)),
            C.Addresses(*map(address, self.d)),
            *(None if x is None else address(x) for x in self.keep),
        )


class Columns:
    """A result: one array for each number, and the struct that the library writes to."""

    # name: the type of numpy, and how many numbers
    FIELDS: dict[str, tuple[str, int]] = {}
    _rows: dict[str, NDArray[Any]]

    def __init__(self, **arrays: NDArray[Any]) -> None:
        if not arrays:
            raise ValueError(f"{type(self).__name__}: give at least one of {', '.join(self.FIELDS)}")
        self._foreign = True
        self._set(arrays)

    @classmethod
    def _make(cls, n: int, fields: Sequence[str], axis: int = 0) -> "Any":
        if not isinstance(n, (int, np.integer)) or n < 0:
            raise ValueError(f"{cls.__name__}: the number of rays must be a whole number, not {n!r}")
        self = cls.__new__(cls)
        arrays: dict[str, NDArray[Any]] = {}
        for name in fields or cls.FIELDS:
            kind, count = cls._field(name)
            arrays[name] = np.empty(n if count == 1 else (count, n), kind)
        self._foreign = False
        self._rows = arrays
        self._ready(n, axis)
        return self

    @classmethod
    def _field(cls, name: str) -> tuple[str, int]:
        if name not in cls.FIELDS:
            raise ValueError(f"{cls.__name__} has no {name!r}; it may have {', '.join(cls.FIELDS)}")
        return cls.FIELDS[name]

    def _set(self, arrays: dict[str, NDArray[Any]], axis: int = 0) -> None:
        self._rows = {}
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
            self._rows[name] = a
        self._ready(int(n or 0), axis)

    def _ready(self, n: int, axis: int) -> None:
        self.size, self._axis = n, axis
        for name, a in self._rows.items():
            self.__dict__[name] = a.T if axis == 1 and a.ndim == 2 else a
        self._struct = self._fill()

    def _fill(self) -> Any:
        raise NotImplementedError

    def _at(self, name: str) -> Optional[int]:
        a = self._rows.get(name)
        return None if a is None else address(a)

    def _three(self, name: str) -> Any:
        a = self._rows.get(name)
        if a is None:
            return C.Addresses()
        first, step = address(a), a.strides[0]
        return C.Addresses(first, first + step, first + 2 * step)

    def __getattr__(self, name: str) -> Any:
        if name in type(self).FIELDS:
            raise AttributeError(f"{name} was not asked for: out has no array for it")
        raise AttributeError(f"{type(self).__name__} has no attribute {name!r}")

    def __len__(self) -> int:
        return self.size

    def __getstate__(self) -> dict[str, Any]:
        return {"arrays": self._rows, "axis": self._axis}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._foreign = False
        self._set(state["arrays"], state["axis"])

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.size} rays: {', '.join(self._rows)}>"

    def table(self) -> NDArray[Any]:
        """All of it as one structured array, with a field for each number: a copy."""
        fields = [
            (name, *((kind,) if count == 1 else (kind, (count,))))
            for name, (kind, count) in self.FIELDS.items()
            if name in self._rows
        ]
        table = np.empty(self.size, fields)
        for name, a in self._rows.items():
            table[name] = a.T
        return table

    def _void(self, status: str, stopped: int) -> None:
        """What a call that was stopped leaves: NaN everywhere."""
        for name, a in self._rows.items():
            a[...] = np.nan if a.dtype.kind == "f" else stopped if name == status else 0

    def _check(self, rays: RayArrays, may_be: Sequence[str] = ()) -> None:
        if self.size != rays.n:
            raise ValueError(f"out has room for {self.size} rays; there are {rays.n}")
        for name, a in self._rows.items():
            if not a.flags.writeable:
                raise ValueError(f"out: {name} is read-only")
        if not self._foreign:
            return
        outs = [(name, part) for name, a in self._rows.items() for part in np.atleast_2d(a)]
        ins = [x for x in (*rays.o, *rays.d, *rays.keep) if x is not None]
        for i, (name, part) in enumerate(outs):
            same = [x for x in ins if np.may_share_memory(part, x)]
            if same and not (name in may_be and all(address(x) == address(part) for x in same)):
                raise ValueError(f"out: {name} overlaps the rays")
            if any(np.may_share_memory(part, other) for _, other in outs[:i]):
                raise ValueError(f"out: {name} overlaps another array of out")
