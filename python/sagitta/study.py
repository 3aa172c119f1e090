# SPDX-License-Identifier: MIT
"""What a designer asks of a lens: the analyses of the library (study.h), each a method of Lens.

The library has the analyses, their columns and their settings in tables; so each of them is a method here, also one
that is added later.  The numbers are those of the command and of C, bit for bit.
"""
from __future__ import annotations

import ctypes
import inspect
import keyword
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Iterator, Literal, Optional, Sequence, TypedDict, TypeVar, Union
from typing import overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _calls
from . import _library as C
from ._arrays import address, doubles
from ._tables import Dims, Floats, Table, Tabular, alike, ray_axes

if TYPE_CHECKING:
    from ._analyses import Counts, FatesOfRays, Reals
    from .lens import Lens

PATTERNS = {"fan": 0, "grid": 1, "hexapolar": 2, "random": 3, "sobol": 4, "cells": 5, "cross": 6}
_WEIGHTS = {"area": 0, "equal": 1}
_AIMS = {"pupil": 0, "stop": 1, "real-stop": 2}
_NUMBER, _EXACT, _ERROR, _WAVELENGTH, _COUNT, _PLACE, _WHOLE, _FATE, _VERDICT, _QUANTITY = range(10)
_FLAG, _SETTING_COUNT, _WORD, _ONE_NUMBER, _NUMBERS, _TEXT = range(6)
_FORMATS = {_COUNT: np.dtype(np.uintp), _PLACE: np.dtype(np.uintp), _FATE: np.dtype(np.intc)}
_FORMATS[_VERDICT] = _FORMATS[_QUANTITY] = np.dtype(np.intc)

Field = Union[int, Sequence[float]]
Rows = Union[slice, NDArray[Any], list[int], list[bool]]
Some = TypeVar("Some", bound="Answer")
Wavelength = Union[None, int, float, str]


def field_number(given: Any, fields: int) -> int:
    """A field by its number, from 1."""
    if not 1 <= given <= fields:
        from_one = "fields count from 1, as in the lens file" if given == 0 else ""
        has = f"the lens has fields 1 to {fields}"
        raise IndexError(f"field {given}: {from_one + '; ' if from_one else ''}{has}")
    return int(given)


def wavelength_of(given: Any, wavelengths: Sequence[float]) -> C.Wavelength:
    """A whole number: that of the lens, from 1; a float: micrometres; or the name of a spectral line."""
    if isinstance(given, str):
        um = float(C.library.sgt_spectral_line(given.encode()))
        if math.isnan(um):
            raise ValueError(f"wavelength: no spectral line {given!r}; there are i h g F' F e d D C' C r s t")
        return C.Wavelength(0, um)
    if isinstance(given, (int, np.integer)) and not isinstance(given, bool):
        count = max(len(wavelengths), 1)
        if not 1 <= given <= count:
            raise IndexError(
                f"wavelength {given}: a whole number is that of the lens, which has 1 to {count}; "
                "micrometres are a float"
            )
        return C.Wavelength(int(given), 0.0)
    um = float(given)
    if not (um > 0 and math.isfinite(um)):
        raise ValueError(f"wavelength: must be above 0 (micrometres), not {um}")
    return C.Wavelength(0, um)


@dataclass(frozen=True)
class Fates:
    """What became of all rays: as the columns of a table are named; `none`: proven, no such ray."""

    rays: int
    passed: int
    missed: int
    clipped: int
    tir: int
    lost: int
    none: int
    unfound: int
    within: float
    folded: int
    proven: int
    evanescent: int


class Answer(Tabular):
    """The rows of an analysis.  Each column is an attribute, an array of one number a row, as the command names it
    (`sagitta spot --help`, or help(Lens.spot)): answer.rms, answer.field ...

    rows        a structured array; rows[0]["rms"]
    units       of each column: {"rms": "mm", ...}; "" where there is none, or the lens does not say
    fates       what became of all rays
    notes       what lacks, in sentences; `legend`: what the numbers are

    In `wavelength` 0 are all wavelengths together.  In `fate` are Fate, or -2: proven, no such ray.  In `verdict`
    1 is proven, 0 broken, -1 undecided.  In `quantity` are numbers of prove.h: 1 ex, 2 ey, 3 spot, 5 opd, 7 incidence,
    8 clearance.

    >>> import sagitta
    >>> lens = sagitta.Lens.text("{pupil: {semi_diameter: 5}, units: mm, fields: [0, 2], surfaces: ["
    ...     "{type: sphere, radius: 50, thickness: 98, index: 1.5}, {type: plane}]}")
    >>> spot = lens.spot()
    >>> spot.units["rms"], spot.of(field=2, wavelength=0).rms.shape
    ('mm', (1,))
    """

    def __init__(
        self,
        analysis: str,
        rows: NDArray[Any],
        units: dict[str, str],
        fates: Fates,
        notes: Sequence[str] = (),
        legend: Sequence[str] = (),
    ) -> None:
        self.analysis, self.rows, self.units, self.fates = analysis, rows, units, fates
        self.notes, self.legend = list(notes), list(legend)

    if not TYPE_CHECKING:  # (_analyses.pyi says which columns an answer has)

        def __getattr__(self, name: str) -> NDArray[Any]:
            rows = self.__dict__.get("rows")
            if rows is None or name not in (rows.dtype.names or ()):
                columns = ", ".join(rows.dtype.names) if rows is not None else ""
                raise AttributeError(f"no column {name!r}; there are {columns}")
            return rows[name]

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *(self.rows.dtype.names or ())]

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[np.void]:
        return iter(self.rows)

    @overload
    def __getitem__(self, key: "Reals") -> Floats: ...
    @overload
    def __getitem__(self, key: "Counts") -> NDArray[np.uintp]: ...
    @overload
    def __getitem__(self, key: "FatesOfRays") -> NDArray[np.intc]: ...
    @overload
    def __getitem__(self, key: str) -> NDArray[Any]: ...
    @overload
    def __getitem__(self, key: int) -> np.void: ...
    @overload
    def __getitem__(self: Some, key: Rows) -> Some: ...

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str):
            if key not in self.keys():
                raise KeyError(f"{key}: there are {', '.join(self.keys())}")
            return self.rows[key]
        if isinstance(key, (int, np.integer)):
            return self.rows[key]
        return self._some(key)

    def keys(self) -> tuple[str, ...]:
        """The names of the columns."""
        return self.rows.dtype.names or ()

    def _some(self: Some, keep: Any) -> Some:
        return type(self)(self.analysis, self.rows[keep], self.units, self.fates, self.notes, self.legend)

    @property
    def _units(self) -> dict[str, str]:  # type: ignore[override]
        return self.units

    _along = ("field", "wavelength")

    def _table(self, dims: Dims) -> Table:
        axes = ray_axes((1,), dims or "row")
        return {name: (axes, self.rows[name]) for name in self.keys()}

    def __eq__(self, other: object) -> bool:
        """The same analysis with the same rows; a NaN is equal to a NaN."""
        if not isinstance(other, Answer):
            return NotImplemented
        return self.analysis == other.analysis and alike(self.rows, other.rows)

    __hash__ = None  # type: ignore[assignment]

    def of(self: Some, field: Optional[int] = None, wavelength: Optional[float] = None) -> Some:
        """The rows of one field, or of one wavelength (micrometres; 0: all together)."""
        keep = np.ones(len(self.rows), bool)
        if field is not None:
            keep &= self.rows["field"] == field
        if wavelength is not None:
            keep &= self.rows["wavelength"] == wavelength
        return self._some(keep)

    def __repr__(self) -> str:
        return f"<{self.analysis}: {len(self.rows)} rows of {', '.join(self.rows.dtype.names or ())}>"


class _Handle:
    """An sgt_study, and what it points to."""

    def __init__(self, lens: "Lens", option: C.StudyOptions, answer: C.Answer, keep: Any) -> None:
        self.keep, error = (lens, option, keep), C.Error()
        self.pointer = C.library.sagitta_study(
            lens._handle.pointer, ctypes.byref(option), ctypes.byref(answer), ctypes.byref(error)
        )
        if answer.no_memory:
            raise MemoryError("sagitta: no memory")
        if not self.pointer:
            raise lens._fault(error)

    def __del__(self, free: Any = C.library.sgt_study_free) -> None:
        if getattr(self, "pointer", None):
            free(self.pointer)


def points_of(pattern: Any) -> Floats:
    """x, y, weight of points of the unit circle that are given as (2, n); a row each."""
    given = doubles(pattern, "pattern")
    if given.ndim != 2 or given.shape[0] != 2:
        raise ValueError(f"pattern: must be a word or points of the pupil, (2, n); not {given.shape}")
    points = np.empty((given.shape[1], 3))
    points[:, :2], points[:, 2] = given.T, 1 / max(given.shape[1], 1)
    return points


def whole(value: Any, name: str, least: int = 0) -> int:
    if not isinstance(value, (int, np.integer)) or isinstance(value, bool) or value < least:
        above = "a whole number above 0" if least else "a whole number"
        raise ValueError(f"{name}: must be {above}, not {value!r}")
    return int(value)


def _is_point(given: Any) -> bool:
    return not isinstance(given, (int, np.integer))


def _set_fields(option: C.StudyOptions, lens: "Lens", field: Any, fields: Any) -> Any:
    if field is not None and fields is not None:
        raise ValueError("give field (one) or fields (several), not both")
    several = [field] if field is not None else list(fields) if fields is not None else []
    if not several:
        return None
    option.fields = len(several)
    if not any(_is_point(f) for f in several):
        numbers = (ctypes.c_size_t * len(several))(*(field_number(f, len(lens.fields)) for f in several))
        option.field = ctypes.addressof(numbers)
        return numbers
    at = (C.LensField * len(several))(*(lens._field(f) for f in several))
    option.field_at = ctypes.addressof(at)
    return at


def _set_wavelengths(option: C.StudyOptions, lens: "Lens", given: Any) -> Any:
    if given is None:
        return None
    if isinstance(given, str) and given == "all":
        option.every_wavelength = True
        return None
    several = list(given) if isinstance(given, (list, tuple, np.ndarray)) else [given]
    made = (C.Wavelength * len(several))(*(wavelength_of(w, lens.wavelengths) for w in several))
    option.wavelengths, option.wavelength = len(several), ctypes.addressof(made)
    return made


def _set_points(option: C.StudyOptions, pattern: Any, rays: int, across: int, seed: int) -> Any:
    option.rays, option.across = whole(rays, "rays"), whole(across, "across")
    option.seed = whole(seed, "seed")
    if pattern is None:
        return None
    if isinstance(pattern, str):
        kind = ctypes.c_int(_calls.of_words(pattern, PATTERNS, "pattern"))  # type: ignore[arg-type]
        option.pattern = ctypes.addressof(kind)
        return kind
    points = points_of(pattern)
    option.points, option.point = len(points), address(points)
    return points


def study_options(
    lens: "Lens",
    field: Any,
    wavelength: Any,
    *,
    fields: Any,
    pattern: Any,
    rays: int,
    across: int,
    seed: int,
    weights: Optional[str],
    aim: Optional[str],
    apertures: bool,
    solver: Optional[C.Options] = None,
) -> tuple[C.StudyOptions, list[Any]]:
    """What is asked of a lens, and what it points to."""
    equal = weights is not None and _calls.of_words(weights, _WEIGHTS, "weights")  # type: ignore[arg-type]
    option = C.StudyOptions(open=not apertures, equal_weights=bool(equal))
    keep = [
        _set_fields(option, lens, field, fields),
        _set_wavelengths(option, lens, wavelength),
        _set_points(option, pattern, rays, across, seed),
        solver,
    ]
    if solver is not None:
        option.solver = ctypes.addressof(solver)
    if aim is not None:
        keep.append(ctypes.c_int(_calls.of_words(aim, _AIMS, "aim")))  # type: ignore[arg-type]
        option.aim = ctypes.addressof(keep[-1])
    return option, keep


def _settings_of(analysis: C.Analysis, given: dict[str, Any]) -> tuple[Any, Any]:
    """The options of an analysis as bytes, and what they point to."""
    room = (ctypes.c_uint64 * (analysis.options_size // 8 + 1))()
    at = ctypes.addressof(room)
    keep: list[Any] = []
    known = {C.text(s.name): s for s in analysis.setting[: analysis.settings]}
    for name, value in given.items():
        if name not in known:
            takes = ", ".join(known) if known else "none"
            raise TypeError(f"{C.text(analysis.name)}: no setting {name!r}; its settings: {takes}")
        setting = known[name]
        place = at + setting.offset
        if setting.kind == _FLAG:
            ctypes.c_bool.from_address(place).value = bool(value)
        elif setting.kind == _SETTING_COUNT:
            number = whole(value, name, 1)
            if not setting.least <= number <= setting.most:
                raise ValueError(f"{name}: must be from {setting.least} to {setting.most}, not {number}")
            ctypes.c_size_t.from_address(place).value = number
        elif setting.kind == _WORD:
            words = {w: i for i, w in enumerate(C.text(setting.words).split("|"))}
            ctypes.c_int.from_address(place).value = _calls.of_words(value, words, name)  # type: ignore[arg-type]
        elif setting.kind == _TEXT:
            if not isinstance(value, str):
                raise ValueError(f"{name}: must be a text, not {value!r}")
            held = ctypes.create_string_buffer(value.encode())
            ctypes.c_void_p.from_address(place).value = ctypes.addressof(held)
            keep.append(held)
        else:
            numbers = np.atleast_1d(np.array(doubles(value, name)))
            if numbers.ndim != 1 or not np.isfinite(numbers).all():
                raise ValueError(f"{name}: must be finite numbers")
            if setting.kind == _ONE_NUMBER and len(numbers) != 1:
                raise ValueError(f"{name}: must be one number")
            there = C.List.from_address(place)
            there.count, there.at = len(numbers), address(numbers)
            keep.append(numbers)
    return room, keep


def _table_of(study: _Handle, analysis: C.Analysis, options: Any) -> tuple[np.dtype[Any], dict[str, str]]:
    names, formats, offsets, units = [], [], [], {}
    for i in range(analysis.columns):
        name, unit = (ctypes.c_char * 32)(), (ctypes.c_char * 32)()
        if not C.library.sgt_study_column(study.pointer, ctypes.byref(analysis), options, i, name, unit):
            continue
        column = analysis.column[i]
        names.append(C.text(name.value))
        formats.append(_FORMATS.get(column.kind, np.dtype(float)))
        offsets.append(column.offset)
        units[names[-1]] = C.text(unit.value)
    table = {"names": names, "formats": formats, "offsets": offsets, "itemsize": analysis.row_size}
    return np.dtype(table), units  # type: ignore[call-overload]


class Asking(TypedDict, total=False):
    """What every analysis may be told, besides its own settings: help(Lens.spot) says what each is."""

    fields: Optional[Sequence[Field]]
    pattern: Union[None, str, ArrayLike]
    rays: int
    across: int
    seed: int
    weights: Optional[Literal["area", "equal"]]
    aim: Optional[Literal["pupil", "stop", "real-stop"]]
    apertures: bool
    pick: Optional[_calls.Pick]
    proof: Optional[_calls.Proof]
    t_tol: float
    dt_min: float
    max_evals: int
    threads: int


_DEFAULTS: dict[str, Any] = dict(
    fields=None, pattern=None, rays=0, across=0, seed=0, weights=None, aim=None, apertures=True, pick=None,
    proof=None, t_tol=0.0, dt_min=0.0, max_evals=0, threads=1,
)


class _Share:
    """One of several shares of a study (sgt_shard), or number 0: all of it, of what these have written."""

    def __init__(self, number: int, of: int, written: Sequence[bytes]) -> None:
        self.number, self.of, self.written = number, of, written
        self._given = (C.Part * len(written))(*(C.Part(part, len(part)) for part in written))

    def set(self, answer: C.Answer) -> None:
        answer.number, answer.of = self.number, self.of
        answer.given = ctypes.addressof(self._given)

    def check(self) -> None:
        """Was all of it read?"""
        for k, part in enumerate(self._given, 1):
            if part.taken != part.size:
                raise ValueError(f"join: part {k} of {self.of} is longer than this study")


def ask(lens: "Lens", analysis: str, given: dict[str, Any], number: int, of: int, written: Sequence[bytes]) -> Any:
    """What a share writes; or, number 0, the Answer of all that were written."""
    found = C.library.sgt_analysis_named(analysis.encode())
    if not found:
        raise ValueError(f"there is no analysis {analysis!r}; there are {', '.join(C.text(a.name) for a in analyses())}")
    if not 1 <= whole(of, "of", 1) < 2**32 or not 0 <= whole(number, "number") <= of:
        raise ValueError(f"part {number} of {of}: parts are numbered from 1 to {of}")
    return _ask(found.contents, lens, _share=_Share(number, of, written), **given)


def _ask(
    analysis: C.Analysis,
    lens: "Lens",
    field: Optional[Field] = None,
    wavelength: Union[Wavelength, Sequence[Wavelength]] = None,
    *,
    _share: Optional[_Share] = None,
    **given: Any,
) -> Any:
    asked = {**_DEFAULTS, **{name: x for name, x in given.items() if name in _DEFAULTS}}
    settings = {name: x for name, x in given.items() if name not in _DEFAULTS and x is not None}
    fields, pattern, rays, across, seed, weights, aim, apertures, *solver, threads = asked.values()
    pick, proof, t_tol, dt_min, max_evals = solver
    lens._only_files(C.text(analysis.name))
    C.check_arithmetic()
    _calls.check_threads(threads)
    given_fields = field if field is not None else fields
    for wanted, flag in ((given_fields, analysis.no_fields), (proof, analysis.no_rays)):
        if flag and wanted is not None:
            what = "fields" if analysis.no_fields else "a proof"
            raise ValueError(f"{C.text(analysis.name)}: takes no {what}")
    if analysis.no_rays and (pattern is not None or rays or across or weights is not None):
        every = C.text(analysis.name).startswith("prove")
        rays_are = "all rays of the pupil are meant" if every else "they are those near the chief ray"
        raise ValueError(f"{C.text(analysis.name)}: takes no rays: {rays_are}")
    option_of_trace = _calls.options(dict(pick=pick, proof=proof, t_tol=t_tol, dt_min=dt_min, max_evals=max_evals))
    option, keep = study_options(
        lens, field, wavelength, fields=fields, pattern=pattern, rays=rays, across=across, seed=seed, weights=weights,
        aim=aim, apertures=apertures, solver=option_of_trace,
    )
    room, lists = _settings_of(analysis, settings)
    answer = C.Answer(threads=threads)
    if _share is not None:
        _share.set(answer)
    try:
        study = _Handle(lens, option, answer, keep)
        dtype, units = _table_of(study, analysis, room)
        error = C.Error()
        fine = C.library.sagitta_ask(study.pointer, analysis, room, ctypes.byref(answer), ctypes.byref(error))
        if answer.no_memory:
            raise MemoryError("sagitta: no memory")
        if not fine:
            raise lens._fault(error)
        if _share is not None:
            if _share.number:
                return ctypes.string_at(answer.part, answer.part_size) if answer.part_size else b""
            _share.check()
        held = ctypes.string_at(answer.row, answer.rows * analysis.row_size) if answer.rows else b""
        said = ctypes.string_at(answer.words, answer.length).decode().split("\0") if answer.length else []
    finally:
        C.library.sagitta_forget(ctypes.byref(answer))
    del lists
    rows = np.frombuffer(bytearray(held), dtype)
    fates = Fates(*(getattr(answer.fates, name) for name, _ in C.Fates._fields_[:-1]))
    notes = [s[1:] for s in said if s.startswith("n")]
    return Answer(C.text(analysis.name), rows, units, fates, notes, [s[1:] for s in said if s.startswith("l")])


_ARGUMENTS = """
field, fields   one field or several: its number, from 1, or (x, y) in the lens's own kind.  None: all of the lens
wavelength      one or a list: a whole number is that of the lens, from 1; a float is in micrometres; a spectral line
                "d"; "all".  None: {wavelengths}
"""
_RAYS = """
pattern         "fan", "grid", "hexapolar", "random", "sobol", "cells", "cross", or points of the unit circle (2, n)
rays, across    the n of that pattern (lens.h), or so many rays across.  Default: {pattern}, {rays}
seed            of "random"
weights         "area" (the default): a point counts by the area that it stands for; "equal": each alike
proof           "root" or "first": a ray for which it cannot be proven is lost
"""
_REST = """
aim             "pupil", "stop", "real-stop": None is as the lens says
apertures       False: they clip no ray
threads         the answer does not depend on it
"""


def _document(analysis: C.Analysis) -> str:
    def line(name: str, words: str) -> str:
        return f"{name:<15} {words}"

    wavelengths = "the primary one" if analysis.primary_alone else "all of the lens"
    pattern = {number: word for word, number in PATTERNS.items()}[analysis.pattern]
    parts = [C.text(analysis.help), "", _ARGUMENTS.format(wavelengths=wavelengths).strip()]
    if not analysis.no_rays:
        parts.append(_RAYS.format(pattern=pattern, rays=analysis.rays).strip())
    parts.append(_REST.strip())
    parts += [line(C.text(s.name), C.text(s.help)) for s in analysis.setting[: analysis.settings]]
    parts += ["", "An Answer has the columns"]
    parts += [line(C.text(c.name), C.text(c.help)) for c in analysis.column[: analysis.columns]]
    return "\n".join(parts)


def analyses() -> Iterator[C.Analysis]:
    place = 0
    while at := C.library.sgt_analysis_at(place):
        yield at.contents
        place += 1


def _signature(analysis: C.Analysis) -> inspect.Signature:
    """For help(): the settings by their names."""
    own = {C.text(s.name): False if s.kind == _FLAG else None for s in analysis.setting[: analysis.settings]}
    places = [inspect.Parameter(n, inspect.Parameter.POSITIONAL_OR_KEYWORD, default=d)
              for n, d in (("self", inspect.Parameter.empty), ("field", None), ("wavelength", None))]
    names = [inspect.Parameter(n, inspect.Parameter.KEYWORD_ONLY, default=d)
             for n, d in {**own, **_DEFAULTS}.items() if not keyword.iskeyword(n)]
    return inspect.Signature(places + names, return_annotation="Answer")


def add_to(lens: Any) -> None:
    """Makes a method of each analysis."""
    for analysis in analyses():

        def method(self: "Lens", *given: Any, _analysis: Any = analysis, **named: Any) -> Answer:
            answer: Answer = _ask(_analysis, self, *given, **named)
            return answer

        method.__name__ = C.text(analysis.name)
        method.__qualname__ = f"{lens.__name__}.{method.__name__}"
        method.__doc__ = _document(analysis)
        method.__signature__ = _signature(analysis)  # type: ignore[attr-defined]
        setattr(lens, method.__name__, method)


__all__ = ["Answer", "Fates"]
