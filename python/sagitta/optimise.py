# SPDX-License-Identifier: MIT
"""Figures of a lens as functions of numbers of its file, with their derivatives: what a solver asks (figure.h).

There is no optimiser here: `residuals` and `jacobian` are what scipy.optimize.least_squares takes.
"""
from __future__ import annotations

import ctypes
import math
from typing import TYPE_CHECKING, Any, Mapping, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _calls
from . import _library as C
from ._arrays import address, doubles
from ._tables import Floats
from .study import Field, Wavelength, study_options

if TYPE_CHECKING:
    from .lens import Lens

FIGURES = {"spot": 0, "opd": 1, "chief": 2, "efl": 3, "distortion": 4}
_REFERENCES = {"chief": 0, "centroid": 1}
Bound = tuple[float, float]


class Variables:
    """Numbers of the file of a lens that may vary, and a figure as a function of them.  Lens.variables() makes it.

    paths       as in `surfaces[3].thickness`: surfaces count from 1, as in the file
    x0          these numbers, as the lens has them
    bounds      (lower, upper) as least_squares takes them; infinite where none was given
    evaluations, rays, backward     what was done: figures asked for, rays traced, rays that went back

    >>> import sagitta
    >>> lens = sagitta.Lens.text("{pupil: {semi_diameter: 5}, fields: [0, 2], surfaces: ["
    ...     "{type: sphere, radius: 50, thickness: 98, index: 1.5}, {type: plane}]}")
    >>> v = lens.variables(["surfaces[1].radius", "surfaces[1].thickness"])
    >>> v.x0, v.residuals(v.x0).shape == (v.jacobian(v.x0).shape[0],)
    (array([50., 98.]), True)
    >>> bool(abs(v.values(v.x0)[0] - lens.spot(field=1).of(wavelength=0).rms[0]) < 1e-12)
    True
    """

    def __init__(
        self,
        lens: "Lens",
        paths: Sequence[str],
        figure: str,
        reference: Optional[str],
        bounds: Optional[Mapping[str, Bound]],
        option: C.StudyOptions,
        keep: Any,
    ) -> None:
        if isinstance(paths, str):
            raise TypeError("paths: must be a list of paths")
        self.paths, self.figure = tuple(paths), figure
        kind = _calls.of_words(figure, FIGURES, "figure")  # type: ignore[arg-type]
        if reference is not None and figure != "spot":
            raise ValueError("reference: is for the figure spot")
        of = _calls.of_words(reference or "chief", _REFERENCES, "reference")  # type: ignore[arg-type]
        self._of, self._keep, error = lens, (option, keep), C.Error()
        raw = (ctypes.c_char_p * max(len(self.paths), 1))(*(p.encode() for p in self.paths))
        self._pointer: Any = C.library.sgt_figure_new(
            lens._handle.pointer,
            ctypes.byref(option),
            ctypes.byref(C.FigureOptions(kind=kind, reference=of)),
            len(self.paths),
            raw,
            ctypes.byref(error),
        )
        if not self._pointer:
            raise lens._fault(error)
        size = C.library.sgt_figure_size(self._pointer)
        self._residuals, self._values = int(size.residuals), int(size.values)
        self.x0: Floats = np.empty(len(self.paths))
        C.library.sgt_figure_start(self._pointer, address(self.x0))
        self.bounds: tuple[Floats, Floats] = self._bounds(bounds or {})
        self.evaluations = self.rays = self.backward = self.clipped = self.lost = 0
        self._good = False

    def __del__(self, free: Any = C.library.sgt_figure_free) -> None:
        if getattr(self, "_pointer", None):
            free(self._pointer)

    def __repr__(self) -> str:
        return f"<Variables: {self._residuals} residuals of {self.figure} by {', '.join(self.paths)}>"

    def __len__(self) -> int:
        return len(self.paths)

    def _bounds(self, given: Mapping[str, Bound]) -> tuple[Floats, Floats]:
        low, high = np.full(len(self.paths), -math.inf), np.full(len(self.paths), math.inf)
        for path, (lo, hi) in given.items():
            if path not in self.paths:
                raise ValueError(f"bounds: {path!r} is none of the paths")
            i = self.paths.index(path)
            low[i], high[i] = lo, hi
            if not lo <= self.x0[i] <= hi:
                raise ValueError(f"bounds: {path} is {self.x0[i]:g} at first, which is not between {lo:g} and {hi:g}")
        return low, high

    def _ask(self, x: Optional[ArrayLike], **wanted: Floats) -> Optional[C.Error]:
        """None: it is told.  An error: the reader refuses the lens, or a chief ray does not get through."""
        C.check_arithmetic()
        at = None
        if x is not None:
            at = np.ascontiguousarray(doubles(x, "x"))
            if at.shape != (len(self.paths),):
                raise ValueError(f"x: has the shape {at.shape}, but there are {len(self.paths)} paths")
        out, error = C.FigureOut(**{name: address(room) for name, room in wanted.items()}), C.Error()
        fine = C.library.sgt_figure_eval(
            self._pointer, None if at is None else address(at), ctypes.byref(out), ctypes.byref(error)
        )
        self.evaluations += 1
        self.rays, self.backward = self.rays + int(out.rays), self.backward + int(out.backward)
        self.clipped, self.lost = int(out.clipped), int(out.lost)
        self._good = self._good or bool(fine)
        return None if fine else error

    def residuals(self, x: ArrayLike) -> Floats:
        """The residuals at x: the sum of their squares is the square of the last of values(x).  NaN: rays are lost
        there, or there is no such lens; least_squares (trf, dogbox) then takes a shorter step.  The first call
        raises in such a case."""
        out = np.empty(self._residuals)
        first = not self._good
        error = self._ask(x, residual=out)
        if error is not None:
            if first:
                raise self._of._fault(error)
            out.fill(math.nan)
        elif first and self.lost:
            raise ValueError(f"residuals: {self.lost} rays do not get through the lens at the start")
        return out

    def jacobian(self, x: ArrayLike) -> Floats:
        """The derivatives of the residuals, (residuals, paths), by one trace and one sweep back."""
        out = np.empty((self._residuals, len(self.paths)))
        error = self._ask(x, jacobian=out)
        if error is not None:
            raise self._of._fault(error)
        return out

    def values(self, x: ArrayLike) -> Floats:
        """The figures themselves (figure.h): of "spot" rms of each field, then of all."""
        out = np.empty(self._values)
        error = self._ask(x, value=out)
        if error is not None:
            raise self._of._fault(error)
        return out

    def gradient(self, x: ArrayLike) -> Floats:
        """The derivatives of values(x), (values, paths)."""
        value, out = np.empty(self._values), np.empty((self._values, len(self.paths)))
        error = self._ask(x, value=value, gradient=out)
        if error is not None:
            raise self._of._fault(error)
        return out

    def lens(self, x: ArrayLike) -> "Lens":
        """The lens with the numbers x."""
        return self._of.set(dict(zip(self.paths, doubles(x, "x").tolist())))


def variables(
    lens: "Lens",
    paths: Sequence[str],
    figure: str = "spot",
    *,
    bounds: Optional[Mapping[str, Bound]] = None,
    reference: Optional[str] = None,
    field: Optional[Field] = None,
    fields: Optional[Sequence[Field]] = None,
    wavelength: Union[Wavelength, Sequence[Wavelength]] = None,
    pattern: Any = None,
    rays: int = 0,
    across: int = 0,
    seed: int = 0,
    weights: Optional[str] = None,
    aim: Optional[str] = None,
    apertures: bool = True,
) -> Variables:
    """A figure of the lens as a function of numbers of its file, for a solver: see Variables.

    paths       ["surfaces[1].radius", ...]
    figure      "spot", "opd" (path differences in waves), "chief" (x, y of the chief rays), "efl", "distortion"
    bounds      {path: (least, most)}
    reference   of "spot": "chief" (the default) or "centroid"
    The rest is as of Lens.spot().
    """
    lens._only_files("variables")
    option, keep = study_options(
        lens, field, wavelength, fields=fields, pattern=pattern, rays=rays, across=across, seed=seed, weights=weights,
        aim=aim, apertures=apertures,
    )
    return Variables(lens, paths, figure, reference, bounds, option, keep)


__all__ = ["Variables"]
