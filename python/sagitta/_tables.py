# SPDX-License-Identifier: MIT
"""Results by names: as mappings, as tables of pandas and data sets of xarray.

A result tells what it has once, in _table(): for each name its array and the names of its axes.  An axis of
vectors is called xyz, or xy.  A table of pandas has a row for each ray (or whatever the other axes are), and
vectors in columns p_x, p_y, p_z.  pandas and xarray are imported when they are asked for, and not before.
"""
from __future__ import annotations

import importlib
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Optional, Sequence, Union

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pandas
    import xarray

Floats = NDArray[np.float64]
Dims = Union[None, str, Sequence[str]]
Table = dict[str, tuple[tuple[str, ...], NDArray[Any]]]

VECTORS = {"xyz": ("x", "y", "z"), "xy": ("x", "y")}


def ray_axes(shape: tuple[int, ...], dims: Dims = None) -> tuple[str, ...]:
    """The names of the axes of rays: as given, or ray; ray_0, ray_1 ..."""
    if dims is None:
        return ("ray",) if len(shape) == 1 else tuple(f"ray_{i}" for i in range(len(shape)))
    names = (dims,) if isinstance(dims, str) else tuple(dims)
    if len(names) != len(shape) or len(set(names)) != len(names) or set(names) & set(VECTORS):
        raise ValueError(f"dims: {len(shape)} different names of axes are needed, not {', '.join(names)!r}")
    return names


def alike(a: Any, b: Any) -> bool:
    """The same numbers, a NaN for a NaN; words and tuples as they are."""
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray) and not a.dtype.names:
        return a.shape == b.shape and a.dtype == b.dtype and bool(np.all((a == b) | ((a != a) & (b != b))))
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        return a.dtype == b.dtype and all(alike(a[name], b[name]) for name in a.dtype.names)
    return bool(a == b or (a != a and b != b))


def _module(name: str, method: str) -> Any:
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(
            f"{method}() needs {name}, which is not installed: pip install {name} (on Debian: "
            f"apt-get install python3-{name})",
            name=name,
        ) from error


class Mapping:
    """A result whose numbers have names: a mapping of names to arrays."""

    def keys(self) -> tuple[str, ...]:
        raise NotImplementedError

    def values(self) -> list[Any]:
        return [self[name] for name in self.keys()]  # type: ignore[index]

    def items(self) -> list[tuple[str, Any]]:
        return [(name, self[name]) for name in self.keys()]  # type: ignore[index]

    def __contains__(self, name: object) -> bool:
        return name in self.keys()


class Tabular(Mapping):
    """One that tables are made of."""

    _units: dict[str, str] = {}
    _along: tuple[str, ...] = ()  # names that are labels of the rows

    def _table(self, dims: Dims) -> Table:
        raise NotImplementedError

    def _coords(self) -> dict[str, Any]:
        return {}

    def to_pandas(self, dims: Dims = None) -> "pandas.DataFrame":
        """A DataFrame with a row for each ray, and columns t, p_x, p_y, p_z ...: a copy.  Its index is called
        "ray".  Rays in several axes have an index of as many levels; `dims` names them.  It needs pandas."""
        module = _module("pandas", "to_pandas")
        columns: dict[str, NDArray[Any]] = {}
        axes: tuple[str, ...] = ("ray",)
        shape: tuple[int, ...] = (0,)
        for name, (where, a) in self._table(dims).items():
            first = where[0] if where and where[0] in VECTORS else None
            axes, shape = (where[1:], a.shape[1:]) if first else (where, a.shape)
            if first is None:
                columns[name] = a.reshape(-1).copy()
            else:
                for k, letter in enumerate(VECTORS[first]):
                    columns[f"{name}_{letter}"] = a[k].reshape(-1).copy()
        if len(axes) == 1:
            index = module.RangeIndex(shape[0], name=axes[0])
        else:
            index = module.MultiIndex.from_product([range(n) for n in shape], names=axes)
        frame: "pandas.DataFrame" = module.DataFrame(columns, index=index)
        frame.attrs.update({"units": dict(self._units)} if self._units else {})
        return frame

    def to_xarray(self, dims: Dims = None) -> "xarray.Dataset":
        """A Dataset with an array for each number: a copy.  The axes of the rays are called "ray", or
        "ray_0", "ray_1" ..., or as `dims` says; that of vectors "xyz", with labels.  It needs xarray."""
        module = _module("xarray", "to_xarray")
        table = self._table(dims)
        used = {axis for axes, _ in table.values() for axis in axes}
        labels = {name: list(letters) for name, letters in VECTORS.items() if name in used}
        arrays = {
            name: (axes, a.copy(), {"units": self._units[name]} if self._units.get(name) else {})
            for name, (axes, a) in table.items()
        }
        made: "xarray.Dataset" = module.Dataset(arrays, {**labels, **self._coords()})
        made = made.set_coords([name for name in self._along if name in arrays])
        return made


class Named(Mapping):
    """A dataclass as a mapping of its members, and equal by value: a NaN is equal to a NaN."""

    def keys(self) -> tuple[str, ...]:
        return tuple(f.name for f in fields(self) if not f.name.startswith("_"))

    def __getitem__(self, name: str) -> Any:
        if name not in self.keys():
            raise KeyError(f"{name}: there are {', '.join(self.keys())}")
        return getattr(self, name)

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return all(alike(a, b) for a, b in zip(self.values(), other.values()))  # type: ignore[attr-defined]

    __hash__ = None  # type: ignore[assignment]
