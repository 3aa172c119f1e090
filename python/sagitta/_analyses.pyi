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
                "unsure", "cos4", "illumination", "cos4_err", "illumination_err", "passes", "stops",
                "undecided", "ex_seen", "ex_px", "ex_py", "ey_seen", "ey_px", "ey_py", "spot", "spot_seen",
                "spot_px", "spot_py", "rms_least", "opd_least", "opd_most", "pv_seen", "low_px", "low_py",
                "high_px", "high_py", "opd_rms_least", "opd_rms", "incidence", "incidence_seen",
                "incidence_px", "incidence_py", "clearance", "clearance_seen", "clearance_px",
                "clearance_py", "height", "r0", "r1", "angle0", "angle1", "share", "value", "bound", "seen",
                "um", "sampled", "spot_sampled", "pv_sampled"]

Counts = Literal["field", "rays", "passed", "digits", "lost", "none", "proven", "term", "lacks", "element",
                 "boxes", "spent", "limit"]

FatesOfRays = Literal["fate", "verdict", "quantity"]


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


class ProveAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    passes: Floats
    stops: Floats
    undecided: Floats
    missed: Floats
    clipped: Floats
    tir: Floats
    evanescent: Floats
    ex: Floats
    ex_seen: Floats
    ex_px: Floats
    ex_py: Floats
    ey: Floats
    ey_seen: Floats
    ey_px: Floats
    ey_py: Floats
    spot: Floats
    spot_seen: Floats
    spot_px: Floats
    spot_py: Floats
    rms_least: Floats
    rms: Floats
    opd_least: Floats
    opd_most: Floats
    pv: Floats
    pv_seen: Floats
    low_px: Floats
    low_py: Floats
    high_px: Floats
    high_py: Floats
    opd_rms_least: Floats
    opd_rms: Floats
    boxes: NDArray[np.uintp]
    spent: NDArray[np.uintp]
    fx: Floats
    fy: Floats


class ProveElementsAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    element: NDArray[np.uintp]
    missed: Floats
    clipped: Floats
    tir: Floats
    evanescent: Floats
    incidence: Floats
    incidence_seen: Floats
    incidence_px: Floats
    incidence_py: Floats
    clearance: Floats
    clearance_seen: Floats
    clearance_px: Floats
    clearance_py: Floats
    height: Floats


class ProveRegionsAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    r0: Floats
    r1: Floats
    angle0: Floats
    angle1: Floats
    fate: NDArray[np.intc]
    element: NDArray[np.uintp]
    share: Floats


class ProveLimitsAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    limit: NDArray[np.uintp]
    verdict: NDArray[np.intc]
    value: Floats
    bound: Floats
    seen: Floats
    px: Floats
    py: Floats
    undecided: Floats
    boxes: NDArray[np.uintp]


class ProveBetweenAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    quantity: NDArray[np.intc]
    element: NDArray[np.uintp]
    bound: Floats
    seen: Floats
    fx: Floats
    fy: Floats
    um: Floats
    px: Floats
    py: Floats
    low_px: Floats
    low_py: Floats
    boxes: NDArray[np.uintp]
    spent: NDArray[np.uintp]


class ProveBetweenLimitsAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    limit: NDArray[np.uintp]
    verdict: NDArray[np.intc]
    value: Floats
    bound: Floats
    seen: Floats
    fx: Floats
    fy: Floats
    um: Floats
    px: Floats
    py: Floats
    low_px: Floats
    low_py: Floats
    undecided: Floats
    boxes: NDArray[np.uintp]


class ProveSamplesAnswer(Answer):
    field: NDArray[np.uintp]
    wavelength: Floats
    rays: NDArray[np.uintp]
    passed: NDArray[np.uintp]
    sampled: Floats
    passes: Floats
    stops: Floats
    undecided: Floats
    spot_sampled: Floats
    spot_seen: Floats
    spot: Floats
    pv_sampled: Floats
    pv_seen: Floats
    pv: Floats
    missed: NDArray[np.uintp]


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
    def prove(self, field: Optional[Field] = None,
              wavelength: Union[Wavelength, Sequence[Wavelength]] = None, *,
              undecided: Optional[float] = None, boxes: Optional[int] = None, steps: Optional[int] = None,
              **asked: Unpack[Asking]) -> ProveAnswer: ...
    def prove_elements(self, field: Optional[Field] = None,
                       wavelength: Union[Wavelength, Sequence[Wavelength]] = None, *,
                       undecided: Optional[float] = None, boxes: Optional[int] = None,
                       steps: Optional[int] = None, **asked: Unpack[Asking]) -> ProveElementsAnswer: ...
    def prove_regions(self, field: Optional[Field] = None,
                      wavelength: Union[Wavelength, Sequence[Wavelength]] = None, *,
                      undecided: Optional[float] = None, boxes: Optional[int] = None,
                      steps: Optional[int] = None, **asked: Unpack[Asking]) -> ProveRegionsAnswer: ...
    def prove_limits(self, field: Optional[Field] = None,
                     wavelength: Union[Wavelength, Sequence[Wavelength]] = None, *,
                     boxes: Optional[int] = None, limit: Optional[str] = None,
                     **asked: Unpack[Asking]) -> ProveLimitsAnswer: ...
    def prove_between(self, field: Optional[Field] = None,
                      wavelength: Union[Wavelength, Sequence[Wavelength]] = None, *,
                      boxes: Optional[int] = None,
                      between: Optional[Literal["both", "fields", "wavelengths"]] = None,
                      **asked: Unpack[Asking]) -> ProveBetweenAnswer: ...
    def prove_between_limits(self, field: Optional[Field] = None,
                             wavelength: Union[Wavelength, Sequence[Wavelength]] = None, *,
                             boxes: Optional[int] = None,
                             between: Optional[Literal["both", "fields", "wavelengths"]] = None,
                             limit: Optional[str] = None,
                             **asked: Unpack[Asking]) -> ProveBetweenLimitsAnswer: ...
    def prove_samples(self, field: Optional[Field] = None,
                      wavelength: Union[Wavelength, Sequence[Wavelength]] = None, *,
                      undecided: Optional[float] = None, boxes: Optional[int] = None,
                      steps: Optional[int] = None, **asked: Unpack[Asking]) -> ProveSamplesAnswer: ...
