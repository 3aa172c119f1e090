# SPDX-License-Identifier: MIT
"""How badly a lens may be built: tolerance.h, as `sagitta tolerance` has it, bit for bit."""
from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _calls
from . import _library as C
from ._arrays import address, doubles
from ._tables import Floats
from .study import _AIMS, _set_fields, _set_points, _set_wavelengths, whole

if TYPE_CHECKING:
    from .lens import Lens

_FIGURES = {"spot": 0, "opd": 1, "boresight": 2}
_REFERENCES = {"chief": 0, "centroid": 1}
_COMPENSATORS = (None, "figure", "paraxial")
_DISTRIBUTIONS = ("uniform", "normal", "ends")


class Interval(NamedTuple):
    """An estimate, and between which numbers the true one lies with the confidence asked for."""

    estimate: float
    lower: float
    upper: float


def quantile(values: ArrayLike, p: float, confidence: float = 0.95) -> Interval:
    """The quantile p of a sample, with an interval that assumes no distribution.  A NaN counts as beyond all.

    >>> import sagitta
    >>> sagitta.quantile(range(1, 101), 0.5)
    Interval(estimate=50.0, lower=40.0, upper=61.0)
    """
    ordered = np.sort(doubles(values, "values").ravel())
    q = C.library.sgt_quantile(len(ordered), address(ordered), p, confidence)
    return Interval(q.estimate, q.lower, q.upper)


def share(k: int, n: int, confidence: float = 0.95) -> Interval:
    """The share of which k in n were seen, with the interval of Clopper and Pearson.

    >>> import sagitta
    >>> sagitta.share(0, 10).upper < 0.31
    True
    """
    q = C.library.sgt_share(whole(k, "k"), whole(n, "n", 1), confidence)
    return Interval(q.estimate, q.lower, q.upper)


@dataclass(frozen=True)
class Tolerance:
    """An entry of `tolerances`: what is off in a few words, its box, its unit, and how it is drawn or set."""

    text: str
    first: int
    last: int
    lower: float
    upper: float
    unit: str
    distribution: str
    compensator: Optional[str]


@dataclass(frozen=True)
class Trials:
    """Lenses built at random: figure (n,), value (n, entries), compensators as they were set.  The number of the
    first is `first`."""

    first: int
    figure: Floats
    value: Floats

    def quantile(self, p: float, confidence: float = 0.95) -> Interval:
        return quantile(self.figure, p, confidence)

    def share(self, limit: float, confidence: float = 0.95) -> Interval:
        """The yield: the share of trials whose figure is at most the limit."""
        return share(int(np.count_nonzero(self.figure <= limit)), len(self.figure), confidence)

    @property
    def worst(self) -> int:
        """The place of the worst one; that of a lens without a figure, if there is one."""
        missing = np.isnan(self.figure)
        return int(np.argmax(missing if missing.any() else self.figure))


@dataclass(frozen=True)
class WorstCase:
    """No lens in tolerance has a figure above `bound` (infinite: not known, and `why`); the worst that was found has
    `seen`, and is the point `value`.  verdict: of the limit, "proven", "broken" or "undecided".  cuts: how many
    boxes were halved along each entry; boxes: were carried through; lenses: were built."""

    bound: float
    seen: float
    verdict: str
    value: Floats
    cuts: NDArray[Any]
    boxes: int
    lenses: int
    why: str


class Tolerancing:
    """What the tolerances of a lens do to its figure; Lens.tolerance() makes it.

    entries     what may be off: a list of Tolerance.  A point of their box has a number for each; 0 is the design
    nominal     the figure as designed, nothing compensated
    """

    def __init__(self, lens: "Lens", figure: str, reference: str, asked: tuple[Any, ...], threads: int) -> None:
        field, fields, wavelength, pattern, rays, across, aim, apertures = asked
        lens._only_files("tolerance")
        C.check_arithmetic()
        _calls.check_threads(threads)
        option = C.StudyOptions(open=not apertures)
        keep = [
            _set_fields(option, lens, field, fields),
            _set_wavelengths(option, lens, wavelength),
            _set_points(option, pattern, rays, across, 0),
        ]
        if aim is not None:
            keep.append(ctypes.c_int(_calls.of_words(aim, _AIMS, "aim")))  # type: ignore[arg-type]
            option.aim = ctypes.addressof(keep[-1])
        opt = C.TolerancingOptions(
            figure=_calls.of_words(figure, _FIGURES, "figure"),  # type: ignore[arg-type]
            reference=_calls.of_words(reference, _REFERENCES, "reference"),  # type: ignore[arg-type]
        )
        answer, error = C.Answer(threads=threads), C.Error()
        self._lens, self._keep = lens, (option, answer, keep)
        self._pointer = C.library.sagitta_tolerancing(
            lens._handle.pointer,
            ctypes.byref(opt),
            ctypes.byref(option),
            ctypes.byref(answer),
            ctypes.byref(error),
        )
        if not self._pointer:
            raise lens._fault(error)
        self.nominal: float = C.library.sgt_tolerancing_nominal(self._pointer)
        self.entries = self._entries()

    def __del__(self, free: Any = C.library.sgt_tolerancing_free) -> None:
        if getattr(self, "_pointer", None):
            free(self._pointer)

    def _entries(self) -> list[Tolerance]:
        lens, at = self._lens._handle.pointer, ctypes.POINTER(C.Tolerance)()
        made = []
        for i in range(C.library.sgt_lens_tolerances(lens, ctypes.byref(at))):
            e, text = at[i], (ctypes.c_char * 80)()
            C.library.sgt_tolerance_text(ctypes.byref(e), text)
            unit = C.text(C.library.sgt_tolerance_unit(lens, ctypes.byref(e)))
            drawn, sought = _DISTRIBUTIONS[e.distribution], _COMPENSATORS[e.compensator]
            made.append(Tolerance(C.text(text.value), e.first, e.last, e.lower, e.upper, unit, drawn, sought))
        return made

    def _point(self, value: ArrayLike) -> Floats:
        point = np.array(doubles(value, "value"))
        if point.shape != (len(self.entries),):
            raise ValueError(f"value: must be {len(self.entries)} numbers, one for each entry; not {point.shape}")
        return point

    def at(self, value: ArrayLike) -> tuple[float, Floats]:
        """The figure of a point of the box, and the point with its compensators set."""
        point, figure, error = self._point(value), ctypes.c_double(), C.Error()
        fine = C.library.sgt_tolerancing_at(
            self._pointer, address(point), ctypes.byref(figure), ctypes.byref(error)
        )
        if not fine:
            raise self._lens._fault(error)
        return figure.value, point

    def lens(self, value: ArrayLike) -> "Lens":
        """The lens of a point, compensators as they are given, without tolerances."""
        point, error = self._point(value), C.Error()
        built = C.library.sgt_tolerancing_lens(self._pointer, address(point), ctypes.byref(error))
        if not built:
            raise self._lens._fault(error)
        return self._lens._built(built)

    def sensitivity(self) -> tuple[NDArray[Any], float]:
        """A row for each entry that is no compensator, the worst first: `entry` is its place in `entries`; and the
        estimate of the figure of all together, by the root of the sum of squares.

        change      of the figure at lower and upper, by lenses built so
        derivative  of the figure by the entry, exact, compensators following; linear: times lower and upper
        """
        count, total, error = ctypes.c_size_t(), C.SensitivitySum(), C.Error()
        rows = (C.Sensitivity * (len(self.entries) + 1))()
        fine = C.library.sgt_tolerancing_sensitivity(
            self._pointer, ctypes.byref(count), rows, ctypes.byref(total), ctypes.byref(error)
        )
        if not fine:
            raise self._lens._fault(error)
        names = [name for name, _ in C.Sensitivity._fields_[:-1]]
        table = [("entry", np.uintp), *((name, float) for name in names[1:])]
        made = np.array([tuple(getattr(r, name) for name in names) for r in rows[: count.value]], table)
        return made, float(total.estimate)

    def worst_case(self, limit: Optional[float] = None, boxes: int = 0) -> WorstCase:
        """A figure that no lens in tolerance exceeds, proven, and the worst lens that was found.

        limit   is the figure at most that in every lens?
        boxes   at most so many boxes of lenses are carried through; 0: 32
        """
        opt, out, error = C.WorstOptions(boxes=whole(boxes, "boxes")), C.WorstCase(), C.Error()
        at = None if limit is None else ctypes.c_double(limit)
        if at is not None:
            opt.limit = C.List(1, ctypes.addressof(at))
        value, cuts = np.zeros(len(self.entries)), np.zeros(len(self.entries), np.uintp)
        fine = C.library.sgt_tolerancing_worst(
            self._pointer,
            ctypes.byref(opt),
            ctypes.byref(out),
            address(value),
            cuts.ctypes.data,
            ctypes.byref(error),
        )
        if not fine:
            raise self._lens._fault(error)
        verdict = {1: "proven", 0: "broken"}.get(out.verdict, "undecided")
        why = C.text(out.why) + (f" (element {out.element})" if out.element else "")
        return WorstCase(out.bound, out.seen, verdict, value, cuts, out.boxes, out.lenses, why)

    def draw(self, trial: int, seed: int = 1) -> Floats:
        """What is off in a trial, before compensators are set."""
        value = np.zeros(len(self.entries))
        C.library.sgt_tolerancing_draw(self._pointer, whole(seed, "seed"), whole(trial, "trial"), address(value))
        return value

    def trials(self, count: int, first: int = 0, seed: int = 1) -> Trials:
        """Monte Carlo: trials first ... first + count - 1.  A trial depends on the seed and its number alone."""
        count, first, seed = whole(count, "count", 1), whole(first, "first"), whole(seed, "seed")
        figure, value, error = np.empty(count), np.empty((count, len(self.entries))), C.Error()
        fine = C.library.sagitta_trials(
            self._pointer,
            len(self.entries),
            seed,
            first,
            count,
            address(figure),
            address(value),
            ctypes.byref(error),
        )
        if not fine:
            raise self._lens._fault(error)
        return Trials(first, figure, value)


__all__ = ["Interval", "Tolerance", "Tolerancing", "Trials", "quantile", "share"]
