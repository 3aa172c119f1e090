"""The analyses as methods of Lens.  Written by python/generate.py from the library's tables.

study.py makes these methods when the package is loaded; this is for editors and for mypy.  Each answers with
an Answer; the classes here only say which columns it has, and of which type each is.
"""
from typing import Literal, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack

from ._tables import Floats
from .study import Answer, Asking, Field, Wavelength


Reals = Literal["wavelength", "x", "y", "rms", "rms_x", "rms_y", "geometric", "airy", "sampling", "defocus",
                "xy_err", "px", "py", "ex", "ey", "e_err", "opd", "opd_err", "pv", "m", "coefficient",
                "residual", "tangential", "sagittal", "distortion_percent", "fx", "fy", "ideal", "t_err",
                "condition", "at", "weight", "z", "l", "opl", "opl_err", "within", "radius", "fraction",
                "unsure", "cos4", "illumination", "cos4_err", "illumination_err"]

Counts = Literal["field", "rays", "passed", "digits", "missed", "clipped", "tir", "evanescent", "lost",
                 "none", "proven", "term", "lacks", "element"]

FatesOfRays = Literal["fate"]


class SpotAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    rays: NDArray[np.uintp]
    passed: NDArray[np.uintp]
    x: Floats
    y: Floats
    rms: Floats
    rms_x: Floats
    rms_y: Floats
    geometric: Floats
    airy: Floats
    digits: NDArray[np.uintp]
    sampling: Floats
    missed: NDArray[np.uintp]
    clipped: NDArray[np.uintp]
    tir: NDArray[np.uintp]
    evanescent: NDArray[np.uintp]
    lost: NDArray[np.uintp]
    none: NDArray[np.uintp]
    proven: NDArray[np.uintp]
    defocus: Floats
    xy_err: Floats


class FanAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    px: Floats
    py: Floats
    fate: NDArray[np.intc]
    ex: Floats
    ey: Floats
    e_err: Floats


class OpdAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    px: Floats
    py: Floats
    fate: NDArray[np.intc]
    opd: Floats
    opd_err: Floats


class WavefrontAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    pv: Floats
    rms: Floats
    digits: NDArray[np.uintp]
    sampling: Floats
    rays: NDArray[np.uintp]
    passed: NDArray[np.uintp]
    missed: NDArray[np.uintp]
    clipped: NDArray[np.uintp]
    tir: NDArray[np.uintp]
    evanescent: NDArray[np.uintp]
    lost: NDArray[np.uintp]
    none: NDArray[np.uintp]
    proven: NDArray[np.uintp]


class ZernikeAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    term: NDArray[np.uintp]
    n: NDArray[np.uintp]
    m: Floats
    coefficient: Floats
    residual: Floats


class FieldAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    tangential: Floats
    sagittal: Floats
    distortion_percent: Floats
    fx: Floats
    fy: Floats
    fate: NDArray[np.intc]
    x: Floats
    y: Floats
    xy_err: Floats
    ideal: Floats
    digits: NDArray[np.uintp]
    lacks: NDArray[np.uintp]


class MapAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    fx: Floats
    fy: Floats
    px: Floats
    py: Floats
    fate: NDArray[np.intc]
    element: NDArray[np.uintp]
    evals: NDArray[np.uintp]
    t_err: Floats
    condition: Floats


class SweepAnswer(Answer):
    at: Floats
    wavelength: Floats
    rays: NDArray[np.uintp]
    passed: NDArray[np.uintp]
    missed: NDArray[np.uintp]
    clipped: NDArray[np.uintp]
    tir: NDArray[np.uintp]
    evanescent: NDArray[np.uintp]
    lost: NDArray[np.uintp]
    none: NDArray[np.uintp]
    evals: Floats
    proven: NDArray[np.uintp]


class EndsAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    px: Floats
    py: Floats
    weight: Floats
    fate: NDArray[np.intc]
    element: NDArray[np.uintp]
    x: Floats
    y: Floats
    z: Floats
    l: Floats
    m: Floats
    n: Floats
    opl: Floats
    xy_err: Floats
    opl_err: Floats
    within: Floats


class EnergyAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    radius: Floats
    fraction: Floats
    unsure: Floats
    sampling: Floats


class IlluminationAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    rays: NDArray[np.uintp]
    passed: NDArray[np.uintp]
    fraction: Floats
    cos4: Floats
    illumination: Floats
    unsure: Floats
    sampling: Floats
    missed: NDArray[np.uintp]
    clipped: NDArray[np.uintp]
    tir: NDArray[np.uintp]
    evanescent: NDArray[np.uintp]
    lost: NDArray[np.uintp]
    none: NDArray[np.uintp]
    proven: NDArray[np.uintp]
    cos4_err: Floats
    illumination_err: Floats


class Analyses:
    def spot(self, field: Optional[Field] = None,
             wavelength: Union[Wavelength, Sequence[Wavelength]] = None, *,
             reference: Optional[Literal["chief", "centroid"]] = None, defocus: Optional[ArrayLike] = None,
             **asked: Unpack[Asking]) -> SpotAnswer: ...
    def fan(self, field: Optional[Field] = None, wavelength: Union[Wavelength, Sequence[Wavelength]] = None,
            **asked: Unpack[Asking]) -> FanAnswer: ...
    def opd(self, field: Optional[Field] = None, wavelength: Union[Wavelength, Sequence[Wavelength]] = None,
            *, afocal: bool = False, **asked: Unpack[Asking]) -> OpdAnswer: ...
    def wavefront(self, field: Optional[Field] = None,
                  wavelength: Union[Wavelength, Sequence[Wavelength]] = None, *, afocal: bool = False,
                  **asked: Unpack[Asking]) -> WavefrontAnswer: ...
    def zernike(self, field: Optional[Field] = None,
                wavelength: Union[Wavelength, Sequence[Wavelength]] = None, *, afocal: bool = False,
                terms: Optional[int] = None, order: Optional[Literal["noll", "fringe"]] = None,
                **asked: Unpack[Asking]) -> ZernikeAnswer: ...
    def field(self, field: Optional[Field] = None,
              wavelength: Union[Wavelength, Sequence[Wavelength]] = None, *,
              distortion: Optional[Literal["tan", "theta", "tan-surface", "theta-surface"]] = None,
              steps: Optional[int] = None, **asked: Unpack[Asking]) -> FieldAnswer: ...
    def map(self, field: Optional[Field] = None, wavelength: Union[Wavelength, Sequence[Wavelength]] = None,
            *, over: Optional[Literal["pupil", "field"]] = None, steps: Optional[int] = None,
            **asked: Unpack[Asking]) -> MapAnswer: ...
    def sweep(self, field: None = None, wavelength: Union[Wavelength, Sequence[Wavelength]] = None, *,
              to: Optional[float] = None, steps: Optional[int] = None,
              **asked: Unpack[Asking]) -> SweepAnswer: ...
    def ends(self, field: Optional[Field] = None,
             wavelength: Union[Wavelength, Sequence[Wavelength]] = None,
             **asked: Unpack[Asking]) -> EndsAnswer: ...
    def energy(self, field: Optional[Field] = None,
               wavelength: Union[Wavelength, Sequence[Wavelength]] = None, *,
               reference: Optional[Literal["centroid", "chief"]] = None, radius: Optional[ArrayLike] = None,
               steps: Optional[int] = None, **asked: Unpack[Asking]) -> EnergyAnswer: ...
    def illumination(self, field: Optional[Field] = None,
                     wavelength: Union[Wavelength, Sequence[Wavelength]] = None,
                     **asked: Unpack[Asking]) -> IlluminationAnswer: ...
