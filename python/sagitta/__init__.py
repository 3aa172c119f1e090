# SPDX-License-Identifier: MIT
"""sagitta - where does a ray meet a surface, and how sure is the answer?

    >>> import sagitta
    >>> ball = sagitta.Sphere(radius=10)
    >>> hit = ball.intersect(o=(0, 6, -5), d=(0, 0, 1))
    >>> hit.text, hit.t, hit.t_err < 1e-13
    ('hit', 7.0, True)

Surfaces: the classes of `sagitta.surfaces` (Conic, Zernike, Torus ...), Formula, Sag and Function.  Lenses:
Lens and Element.  docs/python.md tells how they are used.  Nothing here may be used where flush-to-zero has
been set: that is an ArithmeticFault.
"""
from __future__ import annotations

from . import surfaces as _surfaces
from . import _library as _C
from ._library import ArithmeticFault
from .earth import GeodeticHeight, Geoid, LevelGravity
from .formula import Formula, FormulaError, Sag
from .function import Function
from .lens import Aims, Beam, Element, FirstOrder, Lens, LensError, Parabasal, Rays, Remark, Seidel
from .lens import Sensitivity
from .optimise import Variables
from .parts import Part, join
from .sums import Spot, SpotSums, Wavefront, WavefrontSums
from ._calls import Options
from .results import Aimed, Crossing, Crossings, End, Fate, Hit, Hits, Passage, Passed, Status, Traced
from .study import Answer, Fates
from .surface import AllHits, Check, Diagnosis, Fault, Jacobian, Prepared, SingleHits, Surface, Verdict
from .surfaces import *  # noqa: F401,F403
from .tolerance import Interval, Tolerance, Tolerancing, Trials, quantile, share

__version__: str = _C.text(_C.library.sgt_version())

__all__ = [
    "Aimed",
    "Aims",
    "AllHits",
    "Answer",
    "ArithmeticFault",
    "Beam",
    "Check",
    "Crossing",
    "Crossings",
    "Diagnosis",
    "Element",
    "End",
    "Fate",
    "Fates",
    "Fault",
    "FirstOrder",
    "Formula",
    "FormulaError",
    "Function",
    "GeodeticHeight",
    "Geoid",
    "Hit",
    "Hits",
    "Interval",
    "Jacobian",
    "Lens",
    "LensError",
    "LevelGravity",
    "Options",
    "Parabasal",
    "Part",
    "Passage",
    "Passed",
    "Prepared",
    "Rays",
    "Remark",
    "Sag",
    "Seidel",
    "Sensitivity",
    "SingleHits",
    "Spot",
    "SpotSums",
    "Status",
    "Surface",
    "Tolerance",
    "Tolerancing",
    "Traced",
    "Trials",
    "Variables",
    "Verdict",
    "Wavefront",
    "WavefrontSums",
    "join",
    "quantile",
    "share",
]
__all__ += _surfaces.__all__
