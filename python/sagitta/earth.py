# SPDX-License-Identifier: MIT
"""The surfaces about the Earth, where the library was built with GeographicLib (geo.h).

All lengths are metres, in the Earth-centred Earth-fixed frame.  Where the library has none of them, each
class says on its first use which package to install; lens files that name them say the same.
"""
from __future__ import annotations

import ctypes
import os
from typing import Any, Hashable, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _library as C
from .surface import ROWS, Catalogue, builtins_at

try:
    C.library.sgt_geo_builtins.restype = ctypes.c_void_p
    _TABLE: Optional[int] = C.library.sgt_geo_builtins()
except AttributeError:
    _TABLE = None

available: bool = _TABLE is not None  # was the library built with GeographicLib?

_ABSENT = (
    "not available: sagitta was built without GeographicLib.  Install libgeographiclib-dev (for a geoid "
    "proj-data, too), then build and install sagitta again (a build folder: meson setup --reconfigure)"
)
_ROOM = 1200
_opened: dict[str, int] = {}  # geoids, by path: they are kept, since many surfaces share one
_told: Any = None  # the words of the last refusal, for the library to copy


def _open(file: Optional[str]) -> int:
    """The address of a geoid."""
    if file is None:
        words, error = ctypes.create_string_buffer(_ROOM), C.Error()
        if not C.library.sgt_geoid_find(words, ctypes.c_size_t(_ROOM), ctypes.byref(error)):
            raise ValueError("missing, and " + C.text(error.words))
        file = os.fsdecode(words.value)
    if file not in _opened:
        C.library.sgt_geoid_open.restype = ctypes.c_void_p
        error = C.Error()
        handle = C.library.sgt_geoid_open(os.fsencode(file), ctypes.byref(error))
        if not handle:
            raise ValueError(": ".join(filter(None, (C.text(error.file), C.text(error.words)))))
        _opened[file] = handle
    return _opened[file]


def _complete(_context: Any, _type: Any, memory: int, path: Optional[bytes]) -> Optional[int]:
    """For a reader of lens files: opens the file of a geoid."""
    global _told
    try:
        ctypes.c_void_p.from_address(memory).value = _open(os.fsdecode(path) if path else None)
    except ValueError as error:
        _told = ctypes.create_string_buffer(str(error).encode())
        return ctypes.addressof(_told)
    return None


_COMPLETE = ctypes.CFUNCTYPE(
    ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_char_p
)(_complete)


def lens_options() -> dict[str, Any]:
    """What a reader of lens files needs for these types."""
    if _TABLE is None:
        return {}
    return {
        "types": _TABLE,
        "file_ops": C.address_of("sgt_geoid_height_ops"),
        "complete": ctypes.cast(_COMPLETE, ctypes.c_void_p).value,
    }


class _Earth(Catalogue):
    def _make(self, given: dict[str, Any]) -> None:
        if not available:
            raise RuntimeError(f"{self.type}: {_ABSENT}")
        super()._make(given)


class GeodeticHeight(_Earth):
    """The points at geodetic height h over an ellipsoid of revolution.

    a  m, equatorial radius; none: WGS84, its f included
    f  flattening
    h  m
    """
    type = "geodetic_height"
    a: float
    f: float
    h: float

    def __init__(self, *, a: Optional[float] = None, f: Optional[float] = None,
                 h: Optional[float] = None) -> None:
        self._make(dict(a=a, f=f, h=h))


class LevelGravity(_Earth):
    """The level of WGS84's normal gravity through height h on the equator, or that of a potential.

    h          m
    potential  m^2/s^2; instead of h
    """
    type = "level_gravity"
    h: float
    potential: float

    def __init__(self, *, h: Optional[float] = None, potential: Optional[float] = None) -> None:
        self._make(dict(h=h, potential=potential))


class Geoid(_Earth):
    """The points h above a geoid.

    file  a grid in the form .gtx; none: egm96_15.gtx of proj-data
    h     m
    """
    type = "geoid"
    h: float
    _file: Optional[str]

    def __init__(self, *, file: Union[str, "os.PathLike[str]", None] = None,
                 h: Optional[float] = None) -> None:
        object.__setattr__(self, "_file", None if file is None else os.fspath(file))
        self._make(dict(h=h))

    def _fill(self, memory: Any) -> None:
        ctypes.c_void_p.from_buffer(memory).value = _open(self._file)

    def _yaml(self) -> dict[str, Any]:
        return {**super()._yaml(), **({} if self._file is None else {"file": os.path.abspath(self._file)})}

    def _key(self) -> Hashable:
        return self._file, super()._key()

    def __reduce__(self) -> Any:
        return _geoid, (self._file, dict(self._given))

    def replace(self, **changes: Any) -> "Geoid":
        given: dict[str, Any] = {"file": self._file, **self._given, **changes}
        return Geoid(**given)


def _geoid(file: Optional[str], given: dict[str, Any]) -> Geoid:
    return Geoid(file=file, **given)


class _Over(ctypes.Structure):
    _fields_ = [("a", ctypes.c_double), ("f", ctypes.c_double), ("h", ctypes.c_double)]


def _over(surface: Optional[Catalogue]) -> Any:
    """The ellipsoid below a surface, as sgt_geodetic_ellipsoid has it; None is WGS84."""
    if not available:
        raise RuntimeError(f"places: {_ABSENT}")
    if surface is None or isinstance(surface, (LevelGravity, Geoid)):
        return None
    if not isinstance(surface, GeodeticHeight):
        raise TypeError("over: must be a GeodeticHeight, LevelGravity or Geoid")
    return ctypes.byref(_Over(surface.a, surface.f, 0))


def _columns(many: NDArray[np.float64]) -> Any:
    return (ctypes.c_void_p * len(many))(*(row.ctypes.data for row in many))


def rays(lat: ArrayLike, lon: ArrayLike, height: ArrayLike, az: ArrayLike = 0.0, el: ArrayLike = -90.0, *,
         over: Optional[Catalogue] = None) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The rays from places: o and d, the last axis x, y, z.  The arguments are broadcast.

    lat, lon  degrees north and east.  NaN beyond latitudes of -90 and 90
    height    m over the ellipsoid
    az, el    degrees clockwise from north, and above the horizontal; absent: straight down
    over      a surface about the Earth whose ellipsoid is meant; absent: WGS84

    >>> o, d = sagitta.earth.rays(48, 11, 700e3)
    >>> hit = sagitta.GeodeticHeight(h=100).intersect(o, d)
    >>> [round(float(x), 6) for x in sagitta.earth.places(hit.p)]
    [48.0, 11.0, 100.0]
    """
    meant = _over(over)
    given = np.broadcast_arrays(*(np.asarray(x, dtype=np.float64) for x in (lat, lon, height, az, el)))
    flat = np.ascontiguousarray([x.reshape(-1) for x in given])
    out = np.empty((6, flat.shape[1]))
    C.library.sgt_geodetic_rays(meant, ctypes.c_size_t(flat.shape[1]), _columns(flat[:3]), _columns(flat[3:]),
                                _columns(out[:3]), _columns(out[3:]))
    shape = given[0].shape + (3,)
    return np.ascontiguousarray(out[:3].T).reshape(shape), np.ascontiguousarray(out[3:].T).reshape(shape)


def places(p: ArrayLike, *, over: Optional[Catalogue] = None) -> tuple[
        NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Latitudes and longitudes in degrees (above -180, up to 180), and heights in m, of points (..., 3)."""
    meant = _over(over)
    points = np.asarray(p, dtype=np.float64)
    if points.ndim == 0 or points.shape[-1] != 3:
        raise ValueError("p: the last axis must be x, y, z")
    flat = np.ascontiguousarray(points.reshape(-1, 3).T)
    out = np.empty_like(flat)
    C.library.sgt_geodetic_places(meant, ctypes.c_size_t(flat.shape[1]), _columns(flat), _columns(out))
    lat, lon, height = out.reshape((3,) + points.shape[:-1])
    return lat, lon, height


if _TABLE is not None:
    ROWS.update((row.type.decode(), row) for row in builtins_at(_TABLE))

__all__ = ["GeodeticHeight", "Geoid", "LevelGravity", "places", "rays"]
