# SPDX-License-Identifier: MIT
"""Rows of surfaces: lenses from files or from Python, and what a designer asks of them.

Each lens is one of the library's own (lens.h).  One that is made in Python is written as a lens file and read
back: so keys, defaults and error messages are those of docs/lens_file.md, and every analysis is there.
Numbers pass as their shortest decimals, which are read back as the same doubles.  A Function is no part of a
file: a plane stands there for it, and its own surface takes the place of the plane in the row of elements.
"""
from __future__ import annotations

import ctypes
import json
import math
import os
import pathlib
import threading
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING, Any, Callable, Collection, Iterable, Mapping, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _calls
from . import _library as C
from .earth import lens_options
from ._arrays import LARGE, RayArrays, VectorsLike, address, doubles, places_of
from ._calls import Options
from ._tables import Dims, Floats, Named, Table, Tabular, ray_axes
from .function import Function
from .optimise import variables
from .results import Aimed, Fate, Later, Passage, Room, Status, Traced
from .parts import Part
from .tolerance import Tolerancing
from .study import PATTERNS, Answer, Wavelength, add_to, ask, field_number, points_of, wavelength_of, whole
from .surface import BUILTINS, CLASSES, Surface
from .surface import _read as _parameters_at

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._analyses import Analyses
else:
    Analyses = object  # study.py adds them

_byref = ctypes.byref
_pack_passing = C.packer(C.Passing)
_pass = C.library.sagitta_pass
_ALL = places_of(Traced, ())


class LensError(ValueError):
    """What is wrong with a lens, and where: file, line (from 1; 0: none) and key."""

    def __init__(self, message: str, file: str = "", line: int = 0, key: str = "") -> None:
        super().__init__(message)
        self.file, self.line, self.key = file, line, key

    def __reduce__(self) -> Any:
        return LensError, (str(self), self.file, self.line, self.key)


def _fault(error: C.Error) -> LensError:
    file, key, words = C.text(error.file), C.text(error.key), C.text(error.words)
    where = f"{file}:{error.line}: " if file and error.line else f"{file}: " if file else ""
    words = words.replace("--glass PATH", "glasses=PATH")  # what the command calls it
    return LensError(where + (f"{key}: " if key else "") + words, file, error.line, key)


class _Glasses:
    """The table of glasses that the package brings, read when it is first needed."""

    handle: Optional[int] = None
    lock = threading.Lock()

    @classmethod
    def get(cls) -> Optional[int]:
        folder = pathlib.Path(__file__).parent / "glass"
        if "SAGITTA_GLASS" in os.environ or not folder.is_dir():
            return None  # the library looks for it
        with cls.lock:
            if cls.handle is None:
                cls.handle = _catalogue([folder / "glasses.csv", folder / "older.csv"])
        return cls.handle


def _catalogue(paths: Iterable[Union[str, os.PathLike[str], None]]) -> int:
    handle = C.library.sgt_catalogue_new(None)
    if not handle:
        raise MemoryError("sagitta: no memory")
    for path in paths:
        error = C.Error()
        if not C.library.sgt_catalogue_add(
            handle, os.fsencode(path) if path is not None else None, _byref(error)
        ):
            C.library.sgt_catalogue_free(handle)
            raise _fault(error)
    result: int = handle
    return result


class _Handle:
    """An sgt_lens, freed with this object.  keep: what an edit of it reads with (glasses)."""

    def __init__(self, pointer: Any, keep: Any) -> None:
        self.pointer, self.keep = pointer, keep

    def __del__(self, free: Any = C.library.sgt_lens_free) -> None:
        free(self.pointer)


class _Launcher:
    """An sgt_launcher, freed with this object."""

    def __init__(self, handle: _Handle, wavelength: float) -> None:
        self.handle, error = handle, C.Error()
        option = C.LauncherOptions(wavelength=0 if math.isnan(wavelength) else wavelength)
        self.pointer = C.library.sgt_launcher_new(handle.pointer, _byref(option), _byref(error))
        if not self.pointer:
            raise _fault(error)

    def __del__(self, free: Any = C.library.sgt_launcher_free) -> None:
        if getattr(self, "pointer", None):
            free(self.pointer)


@dataclass(frozen=True)
class Element:
    """A surface in a lens.  All but `surface` have the meaning and the defaults of docs/lens_file.md.

    surface         a Surface; None with focal_length: an ideal lens
    thickness       from this vertex to the next along z; negative after a mirror
    index, glass    behind the surface: a number (a list: one for each wavelength), or the name of a glass.
                    None: as in front
    mirror, stop    it reflects; it is the aperture stop
    semi_diameter   of the clear aperture; None: that of the surface
    decenter, tilt  of this element alone: lengths, and degrees about x, y, z
    origin          the vertex, global, instead of thickness and decenter: of all elements or of none
    apertures       a list of maps: {"type": "circle", "radius": 2, "obscures": True} ...
    focal_length, focal_length_y, object_distance       of an ideal lens; with focal_length_y, focal_length is along x
    phase           a formula in waves, "-0.4*r^2", or a map: {"lines": 600, "order": 1} ...
    facets          of a Fresnel surface: the sag whose slopes they have, {"type": "conic", "radius": 30} ...
    draw_to, name   for pictures; a comment
    """

    surface: Optional[Surface] = None
    thickness: Optional[float] = None
    index: Union[None, float, Sequence[float]] = None
    glass: Optional[str] = None
    mirror: bool = False
    stop: bool = False
    semi_diameter: Optional[float] = None
    decenter: Optional[Sequence[float]] = None
    tilt: Optional[Sequence[float]] = None
    origin: Optional[Sequence[float]] = None
    apertures: Optional[Sequence[dict[str, Any]]] = None
    focal_length: Optional[float] = None
    focal_length_y: Optional[float] = None
    object_distance: Optional[float] = None
    phase: Union[None, str, dict[str, Any]] = None
    facets: Optional[dict[str, Any]] = None
    draw_to: Optional[float] = None
    name: Optional[str] = None

    def replace(self, **changes: Any) -> "Element":
        return replace(self, **changes)

    def _yaml(self, last: bool, absolute: bool) -> dict[str, Any]:
        if self.surface is None and self.focal_length is None:
            raise ValueError("Element: needs a surface, or a focal_length")
        if self.surface is not None and not isinstance(self.surface, Surface):
            raise TypeError(f"Element: surface must be a Surface, not {type(self.surface).__name__}")
        shape = {"type": "ideal"} if self.surface is None else self.surface._yaml() or {"type": "plane"}
        rim = shape.pop("semi_diameter", 0.0)
        out: dict[str, Any] = dict(shape)
        for f in fields(self)[1:]:
            value = getattr(self, f.name)
            if value is not None and value is not False:
                out[f.name] = value
        if rim and "semi_diameter" not in out:
            out["semi_diameter"] = rim
        if not (last or absolute):
            out.setdefault("thickness", 0.0)
        return out


def _text(x: Any) -> Any:
    """As JSON has it; infinity is a word of YAML."""
    if isinstance(x, dict):
        return "{" + ", ".join(f"{json.dumps(str(k))}: {_text(v)}" for k, v in x.items()) + "}"
    if isinstance(x, (list, tuple, np.ndarray)):
        return "[" + ", ".join(_text(v) for v in x) + "]"
    if isinstance(x, (bool, np.bool_)):
        return "true" if x else "false"
    if isinstance(x, (int, np.integer)):
        return str(int(x))
    if isinstance(x, (float, np.floating)):
        x = float(x)
        return repr(x) if math.isfinite(x) else ".nan" if math.isnan(x) else ".inf" if x > 0 else "-.inf"
    if isinstance(x, str):
        return json.dumps(x)
    raise TypeError(f"a lens file has no {type(x).__name__}")


@dataclass(eq=False)
class Remark(Named):
    """What a user should know of a lens that was read: of interest, "turned" into something else, "left
    out"."""

    kind: str
    line: int
    key: str
    words: str


def _not_there(aimed: int, within: float) -> str:
    """The words of the command."""
    if aimed == Aimed.NO_SUCH_RAY:
        return "there is no ray, as is proven of all that the rims in front let through"
    if not within > 0:
        return "no ray was found, nor excluded"
    return f"no ray was found (none within {within:g} pupil radii; beyond that it is open)"


@dataclass(eq=False)
class Rays(Named, Tabular):
    """Rays of a field: o, d (3, n) as trace() wants them; the points of the unit circle of the pupil, with
    their weights; aimed (int32, Aimed): only where it is MET, o and d are a ray (else NaN).
    NO_SUCH_RAY is proven of all that the rims in front let through (analysis.h); else it is undecided.
    within: of those that are not MET: it is proven that there is none within so many radii of the paraxial
    entrance pupil; 0: not proven.  wanted (2, n): where on the stop they are aimed; 0 without aiming."""

    o: Floats
    d: Floats
    px: Floats
    py: Floats
    weight: Floats
    aimed: NDArray[np.int32]
    within: Floats
    wanted: Floats

    def _table(self, dims: Dims) -> Table:
        return vectors_of(self, ray_axes((len(self),), dims))

    def __len__(self) -> int:
        return len(self.px)

    def missing(self) -> list[str]:
        """What is known of each ray that is not there, in words."""
        return [
            f"ray {i} (px {self.px[i]:g}, py {self.py[i]:g}): {_not_there(self.aimed[i], self.within[i])}; "
            f"it is aimed at {self.wanted[0, i]:.6g}, {self.wanted[1, i]:.6g} of the stop"
            for i in np.flatnonzero(self.aimed != Aimed.MET)
        ]


@dataclass(eq=False)
class FirstOrder(Named):
    """Paraxial data (lens.h, sgt_first_order).  NaN: there is none: the focal length of an afocal lens.

    wavelength                      in um, or NaN
    power, efl, efl_image           P; 1 / P; n' / P, in the medium of the image
    ffd, bfd                        the front focus from the first vertex, the rear one from the last vertex
                                    before the image
    focus, image                    the rear focus and the paraxial image, from the last element
    front_principal, front_nodal    from the first vertex
    rear_principal, rear_nodal      from the last element
    magnification                   of an object at a distance
    entrance_pupil, entrance_radius from the first vertex; its semi-diameter
    exit_pupil, exit_radius         from the last element; its semi-diameter
    stop_radius                     the height of the marginal ray at the stop
    f_number, f_number_working      |efl| / (2 entrance_radius); 1 / (2 n' u') of the marginal ray
    image_height                    of the field farthest from the axis
    lagrange, petzval_radius        the invariant; the Petzval radius
    angular_magnification           the slope of the paraxial chief ray behind the lens by that in front: also
                                    of an afocal lens
    without_vertex                  the first element, from 1, that has no vertex curvature or stands off the
                                    axis: what depends on its power is NaN.  0: none
    """

    wavelength: float
    power: float
    efl: float
    efl_image: float
    ffd: float
    bfd: float
    focus: float
    image: float
    front_principal: float
    rear_principal: float
    front_nodal: float
    rear_nodal: float
    magnification: float
    entrance_pupil: float
    entrance_radius: float
    exit_pupil: float
    exit_radius: float
    stop_radius: float
    f_number: float
    f_number_working: float
    image_height: float
    lagrange: float
    petzval_radius: float
    without_vertex: int
    angular_magnification: float


@dataclass(eq=False)
class Parabasal(Named):
    """First-order data along the real chief ray of a field (analysis.h, sgt_field_parabasal), for lenses that
    are folded, tilted or freeform: in two sections, x and y.  Distances are along the ray, from the last
    element.  power_xy: how far the sections mix; if it is not 0, the rest is NaN.  why_not: why there are no
    data; "": there are.  Names are those of the json of `sagitta info`."""

    field: int
    efl_x: float
    efl_y: float
    focus_x: float
    focus_y: float
    image_x: float
    image_y: float
    magnification_x: float
    magnification_y: float
    power_xy: float
    why_not: str


@dataclass(eq=False)
class Seidel(Named, Tabular):
    """The Seidel sums of each surface, as wavefronts (lens.h, sgt_seidel), or why there are none."""

    spherical: Floats
    coma: Floats
    astigmatism: Floats
    petzval: Floats
    distortion: Floats
    axial: Floats
    lateral: Floats
    why_not: str

    def _table(self, dims: Dims) -> Table:
        axes = ray_axes(self.spherical.shape, dims or "element")
        return {name: (axes, a) for name, a in self.items() if name != "why_not"}


@dataclass(frozen=True)
class Beam:
    """Launch rays with two parameters: o + u ou + v ov, d + u du + v dv, in the box of u and v."""

    o: Sequence[float]
    d: Sequence[float]
    ou: Sequence[float] = (0, 0, 0)
    ov: Sequence[float] = (0, 0, 0)
    du: Sequence[float] = (0, 0, 0)
    dv: Sequence[float] = (0, 0, 0)
    u: Sequence[float] = (-1, 1)
    v: Sequence[float] = (-1, 1)

    def rays(self, u: ArrayLike, v: ArrayLike) -> tuple[Floats, Floats]:
        """o and d, (3, n), at n places of the box."""
        x, y = np.atleast_1d(doubles(u, "u")), np.atleast_1d(doubles(v, "v"))
        part = [np.asarray(a, float)[:, None] for a in (self.o, self.ou, self.ov, self.d, self.du, self.dv)]
        return part[0] + part[1] * x + part[2] * y, part[3] + part[4] * x + part[5] * y


@dataclass(eq=False)
class Aims(Named, Tabular):
    """The ray of a beam through each wanted point.  aimed (Aimed): MET; NO_SUCH_RAY is proven; else
    UNDECIDED. u, v, o, d: the launch ray (NaN unless met).  miss: the exact ray meets the element within
    `miss` of the point. clipped: the first element whose aperture clips it, or -1."""

    aimed: NDArray[np.int32]
    u: Floats
    v: Floats
    o: Floats
    d: Floats
    point: Floats
    miss: Floats
    clipped: NDArray[np.int64]

    def _table(self, dims: Dims) -> Table:
        return vectors_of(self, ray_axes(self.aimed.shape, dims))


def vectors_of(result: Named, axes: tuple[str, ...]) -> Table:
    """The members of a result; one with an axis more than `axes` is of vectors in rows."""
    return {
        name: ((("xyz" if len(a) == 3 else "xy",) if a.ndim > len(axes) else ()) + axes, a)
        for name, a in result.items()
    }


OUTPUTS = ("x", "y", "z", "l", "m", "n", "opl")


@dataclass(eq=False)
class Sensitivity(Named, Tabular):
    """The ends of rays and how they change.

    of          which numbers: x, y, z of the point on the last element and l, m, n of the direction behind
                it, in its frame; opl
    value       (rows, n), n as the rays have it: these numbers
    gradient    (n, rows, parameters): the derivatives by all numbers of the trace (aim.h, sgt_trace_gradient)
    fate        (n,)

    phases      (n, rows, numbers): the derivatives by the numbers of phases and ideal lenses (sgt_phase_gradient)

    NaN where the ray did not pass, and where a surface lacks second derivatives.
    """

    of: tuple[str, ...]
    value: Floats
    gradient: Floats
    fate: NDArray[np.int8]
    _lens: "Lens" = field(repr=False)
    phases: Floats = field(default_factory=lambda: np.empty((0, 0, 0)))

    def by(self, element: int, name: str) -> Floats:
        """The derivatives (rows, n) by one number of an element: a parameter of its surface ("curvature",
        "conic", "coefficients[1]" ...), "radius", "index", "x", "y", "z" of its vertex, "turn_x", "turn_y",
        "turn_z" (radians, about its vertex), or "thickness": all elements behind move along z.  Of a phase
        "per_wave" (order times wavelength) and "waves[0]" ..., the parameters of W or of facets; of an ideal
        lens "focal_length", "focal_length_y", "object_distance"."""
        lens = self._lens
        count = len(lens)
        if not 0 <= element < count:
            raise IndexError(f"element {element}: the lens has elements 0 to {count - 1}")
        if name == "thickness":
            rest = [lens._place(e, "z") for e in range(element + 1, count)]
            return np.asarray(self._at(rest).sum(axis=0) if rest else np.zeros_like(self.value))
        if name.startswith("radius"):
            place = lens._place(element, name.replace("radius", "curvature"))
            c = getattr(lens.surface(element), name.replace("radius", "curvature"))
            return np.asarray(-c * c * self._at([place])[0])
        own = f"{element}.{name}"
        if own in lens.phase_parameters:
            return np.asarray(self._at([lens.phase_parameters.index(own)], self.phases)[0])
        return np.asarray(self._at([lens._place(element, name)])[0])

    def _at(self, places: list[int], gradient: Optional[Floats] = None) -> Floats:
        of = self.gradient if gradient is None else gradient
        flat = of.reshape(-1, *of.shape[-2:])
        found: Floats = np.ascontiguousarray(flat[:, :, places].transpose(2, 1, 0))
        return found.reshape(len(places), *self.value.shape)

    def _table(self, dims: Dims) -> Table:
        axes = ray_axes(self.fate.shape, dims)
        return {
            "value": (("of", *axes), self.value),
            "gradient": ((*axes, "of", "parameter"), self.gradient),
            "fate": (axes, self.fate),
        }

    def _coords(self) -> dict[str, Any]:
        return {"of": list(self.of), "parameter": list(self._lens.parameters)}


class Lens(Analyses):
    """A row of elements, and how rays are launched into it.

    elements            a list of Element
    index_before        in front of the first
    wavelengths, primary, pupil, fields, field_type, object, aim ...     the keys of docs/lens_file.md, as
                        data: pupil={"semi_diameter": 6}, fields=[0, 5], object={"distance": 100}

    A lens does not change: set(), insert(), remove(), reverse() and scale() make another, by the paths of
    docs/lens_file.md; so does replace(), of one that was made of Elements.  Two are equal if they are
    written alike (yaml()).

    >>> import sagitta
    >>> from sagitta import Element, Lens, Plane, Sphere
    >>> lens = Lens([Element(Sphere(radius=50), thickness=4, index=1.5, semi_diameter=8),
    ...              Element(Sphere(radius=-50), thickness=48, index=1, semi_diameter=8),
    ...              Element(Plane())], pupil={"semi_diameter": 5})
    >>> round(lens.first_order().efl, 3)
    50.676
    >>> traced = lens.trace([[0, 0], [0, 5], [-10, -10]], (0, 0, 1))
    >>> traced.through.all()
    True
    """

    def __init__(
        self, elements: Sequence[Element], *, index_before: float = 1.0, glasses: Any = (), **keys: Any
    ) -> None:
        row = list(elements)
        for i, e in enumerate(row):
            if not isinstance(e, Element):
                raise TypeError(f"Lens: element {i} must be an Element, not {type(e).__name__}")
        absolute = any(e.origin is not None for e in row)
        top = dict(keys)
        if index_before != 1.0:
            top["object"] = {**top.get("object", {}), "index": index_before}
        top["surfaces"] = [e._yaml(i == len(row) - 1, absolute) for i, e in enumerate(row)]
        text = (
            "{\n"
            + ",\n".join(
                f"{json.dumps(k)}: "
                + (_text(v) if k != "surfaces" else "[\n  " + ",\n  ".join(map(_text, v)) + "\n]")
                for k, v in top.items()
            )
            + "\n}\n"
        )
        self._given: Optional[tuple[list[Element], dict[str, Any]]] = (
            row,
            {"index_before": index_before, **keys},
        )
        self._begin(_read_text("lens of Python", text, glasses, 0), row, glasses)

    @classmethod
    def read(
        cls, path: Union[str, os.PathLike[str]], *, glasses: Any = (), configuration: Union[int, str] = 0
    ) -> "Lens":
        """A lens from a file: .zmx, .seq of CODE V, or YAML.  glasses: catalogues (.agf, .csv, .yml, folders) besides the
        table that ships.  configuration: of a file with several, its number from 1 or its name; 0: the values of the
        file itself, with all configurations beside them."""
        C.check_arithmetic()
        if isinstance(configuration, str):
            return cls.read(path, glasses=glasses).configured(configuration)
        self = cls.__new__(cls)
        option, keep = _reading(glasses, configuration)
        error = C.Error()
        pointer = C.library.sgt_lens_read(os.fsencode(path), _byref(option), _byref(error))
        if not pointer:
            raise _fault(error)
        self._given = None
        self._begin(_Handle(pointer, keep), [], glasses)
        return self

    @classmethod
    def text(cls, text: str, *, name: str = "lens.yaml", glasses: Any = ()) -> "Lens":
        """The same of text; the ending of `name` tells its form."""
        self = cls.__new__(cls)
        self._given = None
        self._begin(_read_text(name, text, glasses, 0), [], glasses)
        return self

    def _begin(self, handle: _Handle, row: list[Element], glasses: Any) -> None:
        self._handle, self._glasses = handle, glasses
        self._written: Optional[str] = None
        lens = self._c = handle.pointer.contents
        self.name, self.units = C.text(lens.name), C.text(lens.units)
        self.wavelengths: tuple[float, ...] = (
            tuple(lens.wavelength[: lens.wavelengths]) if lens.wavelength else ()
        )
        self.remarks = [
            Remark(("note", "turned", "left out")[r.kind], r.line, C.text(r.key), C.text(r.words))
            for r in lens.remark[: lens.remarks]
        ]
        self._row = row
        functions = {id(f): f for e in row if e.surface is not None for f in e.surface._functions}
        self._functions: tuple[Function, ...] = tuple(functions.values())
        self._at: dict[float, tuple[Any, float, int]] = {}
        self._launchers: dict[float, _Launcher] = {}
        self._places: Optional[list[int]] = None

    def __len__(self) -> int:
        return int(self._c.count)

    def __repr__(self) -> str:
        return f"<Lens{f' {self.name!r}' if self.name else ''} of {len(self)} elements>"

    @property
    def elements(self) -> list[Element]:
        """Those that the lens was made of; of a lens from a file there are none."""
        if self._given is None:
            raise AttributeError(
                "a lens that was read from a file has no elements of Python; yaml() shows it"
            )
        return list(self._given[0])

    def surface(self, i: int) -> Optional[Surface]:
        """The surface of element i, of a lens from a file too; None: it is an ideal lens, or a formula or
        heights that were read from a file.

        >>> import sagitta
        >>> sagitta.Lens.text("surfaces: [{type: sphere, radius: 50}]").surface(0)
        Sphere(curvature=0.02)
        """
        if not 0 <= i < len(self):
            raise IndexError(f"element {i}: the lens has elements 0 to {len(self) - 1}")
        if self._row:
            return self._row[i].surface
        kind, there = C.text(self._c.surface[i].type), self._c.element[i].surface
        if kind not in BUILTINS or there.ops != BUILTINS[kind].ops:
            return None
        made: Surface = CLASSES[kind](**_parameters_at(BUILTINS[kind], there.self))
        return made

    def replace(self, elements: Optional[Sequence[Element]] = None, **keys: Any) -> "Lens":
        """The same lens with other elements, or other keys."""
        if self._given is None:
            raise TypeError("replace: a lens that was read from a file has no elements of Python; use set()")
        return Lens(
            self._given[0] if elements is None else elements,
            glasses=self._glasses,
            **{**self._given[1], **keys},
        )

    def yaml(self) -> str:
        """The lens as a lens file.  A Function stands in it as a plane."""
        if self._written is None:
            size = ctypes.c_size_t()
            at = C.library.sgt_lens_yaml(self._handle.pointer, _byref(size))
            if not at:
                raise MemoryError("sagitta: no memory")
            self._written = ctypes.string_at(at, size.value).decode()
        return self._written

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Lens):
            return NotImplemented
        return self._functions == other._functions and self.yaml() == other.yaml()

    def __hash__(self) -> int:
        return hash(self.yaml())

    # ------------------------------------------------------------------- configurations

    @property
    def configurations(self) -> tuple[str, ...]:
        """The names of the lens's configurations, in their order; "" where one has none.

        >>> import sagitta
        >>> lens = sagitta.Lens.text('''
        ... surfaces: [{type: sphere, radius: 50, thickness: 3}, {type: plane}]
        ... configurations:
        ...   - {name: wide}
        ...   - {name: tele, "surfaces[1].thickness": 9}''')
        >>> lens.configurations, lens.configured("tele").get("surfaces[1].thickness")
        (('wide', 'tele'), 9.0)
        """
        pointer, name = self._handle.pointer, C.library.sgt_lens_configuration_name
        count = C.library.sgt_lens_configurations(pointer)
        return tuple(C.text(name(pointer, i + 1)) for i in range(count))

    def configured(self, which: Union[int, str]) -> "Lens":
        """The lens of a configuration, by its number from 1 or its name.  It has no configurations itself."""
        error, pointer = C.Error(), self._handle.pointer
        number = which if isinstance(which, int) else C.library.sgt_lens_configuration_named(
            pointer, which.encode(), _byref(error)
        )
        if isinstance(which, str) and not number:
            raise _fault(error)
        other = C.library.sgt_lens_configured(pointer, max(number, 0), _byref(error))
        if not other:
            raise _fault(error)
        return self._built(other)

    def each_configuration(self) -> list["Lens"]:
        """The lenses of all configurations, in their order."""
        return [self.configured(i + 1) for i in range(len(self.configurations))]

    # ------------------------------------------------------------------- another lens

    def _edited(self, edits: Sequence[C.Edit]) -> "Lens":
        if self._functions:
            raise TypeError("a Function is no part of a file, so this lens has no paths; use replace()")
        error = C.Error()
        pointer = C.library.sgt_lens_copy(self._handle.pointer, _byref(error))
        if not pointer:
            raise _fault(error)
        handle = _Handle(pointer, self._handle.keep)
        if edits and not C.library.sgt_lens_edit(
            pointer, len(edits), (C.Edit * len(edits))(*edits), _byref(error)
        ):
            raise _fault(error)
        return self._beside(handle)

    def _beside(self, handle: _Handle) -> "Lens":
        """A lens made of this one."""
        other = Lens.__new__(Lens)
        other._given = None
        other._begin(handle, [], self._glasses)
        return other

    def _built(self, pointer: Any) -> "Lens":
        return self._beside(_Handle(pointer, self._handle.keep))

    def copy(self) -> "Lens":
        """The same lens once more."""
        return self._edited(())

    def paths(self) -> dict[str, float]:
        """The numbers of the lens that its file gives, by their paths, in the order of the file."""
        count = C.library.sgt_lens_paths(self._handle.pointer, 0, None)
        at = (C.LensPath * count)()
        C.library.sgt_lens_paths(self._handle.pointer, count, at)
        return {C.text(p.path): p.value for p in at}

    def get(self, path: str) -> Union[float, bool, str]:
        """What stands at a path: a number, true or false, a word; a list or map as YAML in one line.  Of a
        pickup or solve it is its number.

        >>> import sagitta
        >>> lens = sagitta.Lens.text("surfaces: [{type: sphere, radius: 50, glass: N-BK7, name: front}]")
        >>> lens.get("surfaces[1].radius"), lens.get("surfaces[front].glass")
        (50.0, 'N-BK7')
        """
        x, error = ctypes.c_double(), C.Error()
        if C.library.sgt_lens_get(self._handle.pointer, path.encode(), _byref(x), _byref(error)):
            return x.value
        room = ctypes.create_string_buffer(256)
        while True:
            size = C.library.sgt_lens_get_text(
                self._handle.pointer, path.encode(), len(room), room, _byref(error)
            )
            if size == ctypes.c_size_t(-1).value:
                raise _fault(error)
            if size < len(room):
                break
            room = ctypes.create_string_buffer(size + 1)
        text = room.value.decode()
        if text in ("true", "false"):
            return text == "true"
        return str(json.loads(text)) if text.startswith('"') else text

    def set(self, path: Union[str, Mapping[str, Any]], value: Any = None) -> "Lens":
        """The lens with another value at a path; or with several, {path: value}, which are set together.  A
        value is a number, a text, or a list or dict as the file has them.

        >>> import sagitta
        >>> lens = sagitta.Lens.text("{wavelengths: [d], surfaces: [{type: sphere, radius: 50, thickness: 3, "
        ...                          "glass: N-BK7}, {type: plane}]}")
        >>> lens.set("surfaces[1].thickness", {"solve": "paraxial_focus"}).get("surfaces[1].thickness") > 50
        True
        >>> lens.set({"surfaces[1].radius": 40, "surfaces[1].glass": "N-SF6"}) == lens
        False
        """
        given = path if isinstance(path, Mapping) else {path: value}
        return self._edited([_set(str(p), v) for p, v in given.items()])

    def insert(self, path: str, value: Any) -> "Lens":
        """The lens with an Element, or another value, in front of what stands at a place of a list:
        insert("surfaces[3]", Element(...)).  The place behind the last one is the end."""
        if isinstance(value, Element):
            value = value._yaml(False, value.origin is not None)
        return self._edited([C.Edit(C.EDIT_INSERT, path.encode(), 0, _text(value).encode())])

    def remove(self, path: str) -> "Lens":
        """The lens without an entry of a list, or a key."""
        return self._edited([C.Edit(C.EDIT_REMOVE, path.encode())])

    def reverse(self, first: str, last: str) -> "Lens":
        """The lens with the surfaces `first` to `last` turned front to back: reverse("surfaces[1]",
        "surfaces[4]")."""
        return self._edited([C.Edit(C.EDIT_REVERSE, first.encode(), 0, last.encode())])

    def scale(self, factor: float) -> "Lens":
        """The lens made larger by a factor: each length, and each number with a power of length."""
        return self._edited([C.Edit(C.EDIT_SCALE, None, factor)])

    def __reduce__(self) -> Any:
        if self._given is not None:
            return _made_again, (self._given[0], self._given[1], self._glasses)
        # Files that the lens names (heights) are not in it: they are looked for where they were.
        return _read_again, (self.yaml(), os.path.abspath(C.text(self._c.file)) + ".yaml", self._glasses)

    # --------------------------------------------------------------------------- rays

    def _um(self, wavelength: Wavelength) -> float:
        """In micrometres; NaN: the primary one, or the lens has none."""
        if wavelength is None:
            return math.nan
        at = wavelength_of(wavelength, self.wavelengths)
        if not at.number:
            return float(at.um)
        return float(self.wavelengths[at.number - 1]) if self.wavelengths else math.nan

    def _elements(self, wavelength: Wavelength) -> tuple[Any, float]:
        """The row of elements at a wavelength (None: the primary one), and the index in front."""
        row, before, _ = self._light(wavelength)
        return row, before

    def _light(self, wavelength: Wavelength) -> tuple[Any, float, int]:
        """The same, and the address of the row."""
        um = math.nan if wavelength is None else self._um(wavelength)
        key = PRIMARY if um != um else um
        found = self._at.get(key)
        if found is None:
            row, before, error = (C.Element * len(self))(), ctypes.c_double(), C.Error()
            if math.isnan(um):
                ctypes.memmove(row, self._c.element, ctypes.sizeof(row))
                before.value = self._c.index_before
            elif not C.library.sgt_lens_at(self._handle.pointer, um, row, _byref(before), _byref(error)):
                raise _fault(error)
            for i, e in enumerate(self._row):
                if e.surface is not None and not e.surface._yaml():
                    row[i].surface = e.surface._struct
            found = self._at[key] = row, before.value, ctypes.addressof(row)
        return found

    def _call(
        self, task: int, rays: RayArrays, option: Optional[C.Options], wavelength: Wavelength
    ) -> C.Call:
        row, before, at = self._light(wavelength)
        call = C.Call(task=task, rays=rays.struct, elements=len(row), element=at, index_before=before)
        if option is not None:
            call.opt = ctypes.pointer(option)
        call._keep = (self, rays, row, option)
        return call

    @_calls.takes(Options)
    def trace(
        self,
        o: Union[VectorsLike, Rays],
        d: Optional[VectorsLike] = None,
        *,
        wavelength: Wavelength = None,
        passages: Union[bool, str, Collection[str]] = False,
        threads: int = 1,
        axis: Optional[int] = None,
        out: Optional[Traced] = None,
        **options: Unpack[Options],
    ) -> Traced:
        """Traces rays through all elements, in their order; the whole line of each ray counts.

        o, d        as of Surface.intersect(), of any shape; or the Rays of launch() alone
        wavelength  a whole number: that of the lens, from 1; a float: micrometres; None: the primary one
        passages    tell how each element was met, too: traced.passages[i].  By the names of what is wanted,
                    ("p", "opl"), it is found in the same trace.  True: all; then only status, p and opl are.
                    The others are found by one more trace of the same rays, when one of them is first read
        out         Traced to write to (its passages are written if it has them, each number at once)
        The rest is as of Surface.intersect().  One ray is an array of one.

        >>> import sagitta
        >>> lens = sagitta.Lens([sagitta.Element(sagitta.Sphere(radius=10), index=1.5)])
        >>> traced = lens.trace((0, 6, -5), (0, 0, 1), passages=("t", "p"))
        >>> traced.passages[0], traced.passages[0].t
        (<Passage of 1 rays: t, p>, array([7.]))
        """
        option = _calls.options(options) if options else None
        rays = _rays(o, d, axis) if d is None or isinstance(o, Rays) else RayArrays(o, d, None, None, axis)
        if (
            out is not None
            or passages is not False
            or rays.n >= LARGE
            or type(threads) is not int
            or threads != 1
            or self._functions
        ):
            return self._trace(rays, option, wavelength, _names_of(passages), passages is True, threads, out)
        row, before, at = wavelength is None and self._at.get(PRIMARY) or self._light(wavelength)
        new: Traced = Traced._in_block(rays.n, _ALL, rays.axis, rays.shape)
        given = 0 if option is None else ctypes.addressof(option)
        bad = _pass(
            _pack_passing(len(row), at, before, given, rays.n, new._base, _ALL.bits, 0, 0, 0, *rays.at)
        )
        if bad:
            C.refuse(bad)
        return new

    def _trace(
        self,
        rays: RayArrays,
        option: Optional[C.Options],
        wavelength: Wavelength,
        names: tuple[str, ...],
        later: bool,
        threads: int,
        out: Optional[Traced],
    ) -> Traced:
        """trace() with whatever is asked for.  later: some numbers of the passages when they are read."""
        _calls.check_threads(threads)
        room = None
        if out is not None:
            self._settle(out, rays, names, later)
        else:
            out = Traced._make(rays.n, (), rays.axis, rays.shape)
            if later and not self._functions:
                trace = self._again(rays, option, wavelength, threads)
                room = Room(len(self), out, AT_ONCE, tuple(Later(group, trace) for group in LATER))
            elif names:
                room = Room(len(self), out, names)
            out._passages = [] if room is None else room
        blocks = out._block is not None and (not out._passages if room is None else room.block is not None)
        if blocks and threads == 1 and not self._functions:
            row, before, at = self._light(wavelength)
            given = 0 if option is None else ctypes.addressof(option)
            there = (0, 0, 0) if room is None else (room.base, room.pitch, room.places.bits)
            bad = _pass(
                _pack_passing(
                    len(row), at, before, given, rays.n, out._base, out._places.bits, *there, *rays.at
                )
            )
            if bad:
                self._void(out)
                C.refuse(bad)
            return out
        done = out
        call = self._prepared(done, rays, option, wavelength)
        _calls.run(call, rays.n, threads, self._functions, lambda: self._void(done))
        return done

    def _again(
        self, rays: RayArrays, option: Optional[C.Options], wavelength: Wavelength, threads: int
    ) -> Callable[[tuple[str, ...]], list[Passage]]:
        """A later trace of the same rays, for other numbers of the passages.  Of rays that may change: a copy."""
        kept = np.empty((6, rays.n))
        kept[:3], kept[3:] = rays.o, rays.d

        def trace(names: tuple[str, ...]) -> list[Passage]:
            again = RayArrays(kept[:3], kept[3:], axis=0)
            again.axis, again.shape = rays.axis, rays.shape
            return self._trace(again, option, wavelength, names, False, threads, None).passages

        return trace

    def _settle(self, out: Any, rays: RayArrays, names: tuple[str, ...], every: bool) -> None:
        """Refuses an `out` of the caller that cannot hold the answers.  every: what it has room for will do."""
        if not isinstance(out, Traced):
            raise TypeError(f"out: must be Traced, not {type(out).__name__}")
        if (names or out.passages) and len(out.passages) != len(self):
            raise ValueError(f"out has passages for {len(out.passages)} elements; the lens has {len(self)}")
        out._check(rays, ("o", "d"))
        for i, p in enumerate(out.passages):
            p._settle()
            p._check(rays)
            lacks = [name for name in names if name not in p._names]
            if lacks and not every:
                raise ValueError(f"out: passages[{i}] has no room for {', '.join(lacks)}")

    def _prepared(
        self, out: Traced, rays: RayArrays, option: Optional[C.Options], wavelength: Wavelength
    ) -> C.Call:
        call = self._call(C.TRACE, rays, option, wavelength)
        call.traced = out._struct
        if out.passages:
            structs: Any = [p._struct for p in out.passages]
            listed = (C.Passages * len(self))(*structs)
            call.passages = ctypes.addressof(listed)
            call._listed = (listed, tuple(out.passages))  # their memory stays, whatever becomes of the list
        return call

    @_calls.takes(Options)
    def prepare(
        self,
        o: Union[VectorsLike, Rays],
        d: Optional[VectorsLike] = None,
        *,
        wavelength: Wavelength = None,
        passages: Union[bool, str, Collection[str]] = False,
        threads: int = 1,
        axis: Optional[int] = None,
        out: Optional[Traced] = None,
        **options: Unpack[Options],
    ) -> _calls.Prepared[Traced]:
        """The call of trace(), to be made many times, as Surface.prepare() has it of intersect().  It returns
        how many rays passed all elements.  Passages are written at each call, all that are asked for.

        >>> import numpy as np, sagitta
        >>> lens = sagitta.Lens([sagitta.Element(sagitta.Sphere(radius=10), index=1.5)])
        >>> o, d = np.array([[0.], [0], [-5]]), np.array([[0.], [0], [1]])
        >>> call = lens.prepare(o, d, passages="p")
        >>> o[1] = 6
        >>> call(), call.out.passages[0].p[2]
        (1, array([2.]))
        """
        option = _calls.options(options)
        rays, names = _rays(o, d, axis), _names_of(passages)
        if out is not None:
            self._settle(out, rays, names, passages is True)
        else:
            out = Traced._make(rays.n, (), rays.axis, rays.shape)
            out._passages = Room(len(self), out, names) if names else []
        done = out
        call = self._prepared(done, rays, option, wavelength)
        return _calls.Prepared(call, rays, done, self._functions, threads, lambda: self._void(done))

    @staticmethod
    def _void(out: Traced) -> None:
        out._void("fate", Fate.LOST)
        for p in out.passages:
            p._void("status", Status.STOPPED)

    # -------------------------------------------------------------------- derivatives

    @property
    def parameters(self) -> tuple[str, ...]:
        """The names of the numbers that a trace depends on, in the order of Sensitivity.gradient."""
        names = ["o.x", "o.y", "o.z", "d.x", "d.y", "d.z", "index_before"]
        row, _ = self._elements(None)
        for i, e in enumerate(row):
            names += [f"{i}.{name}" for name in self._names(i, e)]
            names += [f"{i}.{name}" for name in ("x", "y", "z", "turn_x", "turn_y", "turn_z", "index")]
        return tuple(names)

    @property
    def phase_parameters(self) -> tuple[str, ...]:
        """The names of the numbers of phases that a trace depends on, in the order of Sensitivity.phases."""
        names: list[str] = []
        row, _ = self._elements(None)
        for i in range(len(self)):
            count = int(C.library.sgt_phase_parameters(i + 1, row)) - len(names)
            if C.text(self._c.surface[i].type) == "ideal":
                names += [f"{i}.{name}" for name in ("focal_length", "focal_length_y", "object_distance")]
            elif count:
                names += [f"{i}.per_wave", *(f"{i}.waves[{k}]" for k in range(count - 1))]
        return tuple(names)

    def _names(self, i: int, e: Any) -> tuple[str, ...]:
        count = C.library.sgt_parameters(e.surface)
        surface = self.surface(i)
        if surface is not None and len(surface.parameters) == count:
            return surface.parameters
        if count == 2:  # a plane that stands for an ideal lens
            return ("curvature", "conic")
        return tuple(f"parameter {k}" for k in range(count))

    def _place(self, element: int, name: str) -> int:
        try:
            return self.parameters.index(f"{element}.{name}")
        except ValueError:
            known = [n.split(".", 1)[1] for n in self.parameters if n.startswith(f"{element}.")]
            raise ValueError(f"element {element} has no {name!r}; it has {', '.join(known)}") from None

    def sensitivity(
        self,
        o: Union[VectorsLike, Rays],
        d: Optional[VectorsLike] = None,
        of: Sequence[str] = ("x", "y"),
        *,
        wavelength: Wavelength = None,
        threads: int = 1,
        axis: Optional[int] = None,
    ) -> Sensitivity:
        """Where rays end, and the derivatives of that by every number of the lens and of the ray.

        of      which of x, y, z, l, m, n, opl.  A sweep backward is shared by all of them

        >>> from sagitta import Element, Lens, Plane, Sphere
        >>> lens = Lens([Element(Sphere(radius=50), index=1.5, thickness=150), Element(Plane())])
        >>> there = lens.sensitivity([[0], [5], [-10]], (0, 0, 1), "y")
        >>> there.by(0, "thickness").round(4)
        array([[-0.0335]])
        """
        names = tuple(of) if not isinstance(of, str) else tuple(of.split()) if " " in of else (of,)
        for name in names:
            if name not in OUTPUTS:
                raise ValueError(f"of: unknown {name!r}; there are {', '.join(OUTPUTS)}")
        if not names:
            raise ValueError("of: name at least one of " + ", ".join(OUTPUTS))
        rays = _rays(o, d, axis)
        call = self._call(C.GRADIENT, rays, None, wavelength)
        weight = np.zeros((len(names), 7))
        for i, name in enumerate(names):
            weight[i, OUTPUTS.index(name)] = 1
        m = int(C.library.sgt_trace_parameters(len(self), call.element))
        q = int(C.library.sgt_phase_parameters(len(self), call.element))
        gradient, phases = np.empty((rays.n, len(names), m)), np.empty((rays.n, len(names), q))
        ends = np.empty((rays.n, 7))
        out = Traced._make(rays.n, ("fate", "passed"))
        call.traced, call.rows, call.parameters = out._struct, len(names), m
        call.weight, call.gradient, call.ends = address(weight), address(gradient), address(ends)
        call.phases, call.phase_gradient = q, address(phases) if q else None
        _calls.run(call, rays.n, threads, self._functions)
        value = np.ascontiguousarray(ends[:, [OUTPUTS.index(name) for name in names]].T)
        shape = rays.shape or (rays.n,)
        return Sensitivity(
            names,
            value.reshape(len(names), *shape),
            gradient.reshape(*shape, len(names), m),
            out.fate.reshape(shape),
            self,
            phases.reshape(*shape, len(names), q),
        )

    # ------------------------------------------------------------------------- aiming

    def aim(
        self,
        element: int,
        points: ArrayLike,
        beam: Beam,
        *,
        wavelength: Wavelength = None,
        tol: float = 0.0,
        max_traces: int = 0,
        max_boxes: int = 0,
        threads: int = 1,
    ) -> Aims:
        """The rays of a beam that meet an element at wanted points (x, y) of its frame: (2,), (2, n) or
        (2, ny, nx).

        >>> from sagitta import Beam, Element, Lens, Plane, Sphere
        >>> lens = Lens([Element(Sphere(radius=50), index=1.5, thickness=10), Element(Plane())])
        >>> found = lens.aim(1, (0, 2), Beam(o=(0, 0, -100), d=(0, 0, 1), du=(.1, 0, 0), dv=(0, .1, 0)))
        >>> bool(found.aimed[0] == 1), bool(found.miss[0] < 1e-13)
        (True, True)
        """
        wanted = doubles(points, "points")
        if wanted.ndim < 1 or wanted.shape[0] != 2:
            raise ValueError(f"points: has the shape {wanted.shape}; it must be (2,), (2, n) or (2, ...)")
        if not 0 <= element < len(self):
            raise IndexError(f"element {element}: the lens has elements 0 to {len(self) - 1}")
        for name, number in (("tol", tol), ("max_traces", max_traces), ("max_boxes", max_boxes)):
            if not isinstance(number, (int, float) if name == "tol" else int):
                raise TypeError(f"{name}: must be a number, not {type(number).__name__}")
        shape = wanted.shape[1:] or (1,)
        n = math.prod(shape)
        wanted = np.ascontiguousarray(wanted.reshape(2, n).T)
        rays = RayArrays((0, 0, 0), (0, 0, 1))
        call = self._call(C.AIM, rays, None, wavelength)
        parts = {f.name: tuple(float(x) for x in getattr(beam, f.name)) for f in fields(beam)}
        c_beam = C.Beam(**parts)
        option = C.AimOptions(tol=tol, max_traces=max_traces, max_boxes=max_boxes)
        answers = np.zeros(n, _dtype(C.Aiming))
        call.elements = element
        call.beam, call.aim = ctypes.addressof(c_beam), ctypes.addressof(option)
        call.point, call.aiming = address(wanted), address(answers)
        _calls.run(call, n, threads, self._functions)
        met = answers["status"] == 1
        clipped = answers["clipped"].astype(np.int64)
        clipped[~met | (clipped > element)] = -1

        def shaped(a: NDArray[Any]) -> Any:
            """A copy, vectors in rows."""
            return np.array(a.T, order="C").reshape(*a.shape[1:], *shape)

        return Aims(
            aimed=shaped(answers["status"]),
            u=shaped(answers["u"]),
            v=shaped(answers["v"]),
            o=shaped(answers["ray"]["o"]),
            d=shaped(answers["ray"]["d"]),
            point=shaped(answers["point"]),
            miss=shaped(answers["miss"]),
            clipped=shaped(clipped),
        )

    # ---------------------------------------------------------------- first-order data

    def _only_files(self, what: str) -> None:
        for i, e in enumerate(self._row):
            if e.surface is not None and not e.surface._yaml():
                raise ValueError(
                    f"{what}: element {i} is {e.surface!r}, and of a function of Python nothing is known "
                    "about its vertex; trace() and sensitivity() take it"
                )

    def first_order(self, wavelength: Wavelength = None) -> FirstOrder:
        """Paraxial data: efl, bfd, f_number, pupils, magnification ... as attributes."""
        self._only_files("first_order")
        C.check_arithmetic()
        out, error = C.FirstOrder(), C.Error()
        um = self._um(wavelength)
        if not C.library.sgt_lens_first_order(
            self._handle.pointer, um, _byref(out), None, _byref(error)
        ):
            raise _fault(error)
        return FirstOrder(**{of.name: getattr(out, of.name) for of in fields(FirstOrder)})

    def seidel(self, wavelength: Wavelength = None) -> Seidel:
        """The Seidel sums, surface by surface."""
        self._only_files("seidel")
        C.check_arithmetic()
        rows, out, error = (C.Seidel * len(self))(), C.FirstOrder(), C.Error()
        um = self._um(wavelength)
        if not C.library.sgt_lens_first_order(
            self._handle.pointer, um, _byref(out), rows, _byref(error)
        ):
            raise _fault(error)
        columns = np.array(
            [[r.spherical, r.coma, r.astigmatism, r.petzval, r.distortion, *r.chromatic] for r in rows]
        ).T
        names = ("spherical", "coma", "astigmatism", "petzval", "distortion", "axial", "lateral")
        sums: dict[str, Any] = dict(zip(names, columns))
        return Seidel(**sums, why_not=C.text(out.without_seidel))

    def parabasal(self, wavelength: Wavelength = None) -> list[Parabasal]:
        """First-order data along the real chief ray of each field of the lens, in their order."""
        self._only_files("parabasal")
        C.check_arithmetic()
        um, rows = self._um(wavelength), []
        for number in range(1, self._c.fields + 1):
            out, error = C.Parabasal(), C.Error()
            known = C.library.sgt_field_parabasal(self._handle.pointer, um, number, _byref(out), _byref(error))
            names = (of.name for of in fields(Parabasal)[1:-1])
            sections = (*out.efl, *out.focus, *out.image, *out.magnification, out.power_xy)
            data: dict[str, Any] = dict(zip(names, sections))
            rows.append(Parabasal(field=number, why_not="" if known else str(_fault(error)), **data))
        return rows

    @property
    def afocal(self) -> bool:
        """Whether the lens says that light leaves it as parallel rays; spot() then answers in angles."""
        return bool(self._c.afocal)

    # -------------------------------------------------------- what a designer asks (study.py)

    _fault = staticmethod(_fault)

    def part(
        self, analysis: str, number: int, of: int, field: Any = None, wavelength: Any = None, *, threads: int = 1,
        **asked: Any
    ) -> Part:
        """One of `of` shares of an analysis, number 1 to `of`, for sagitta.join(): part("spot", 3, 50, rays=100) is the
        third of lens.spot(rays=100), and takes its arguments.  Which rays it has depends on its number alone.

        spot, wavefront, sweep, zernike of many rays: a part has sums, and stays small however many rays there are.  Of
        the others it grows with its rays."""
        given = {"field": field, "wavelength": wavelength, **asked}
        if isinstance(number, (int, np.integer)) and number < 1:
            raise ValueError(f"part {number} of {of}: parts are numbered from 1 to {of}")
        written = ask(self, analysis, {**given, "threads": threads}, number, of, ())
        return Part(self, analysis, int(number), int(of), given, written)

    def tolerance(
        self,
        figure: str = "spot",
        *,
        reference: str = "chief",
        field: Any = None,
        fields: Any = None,
        wavelength: Any = None,
        pattern: Any = None,
        rays: int = 0,
        across: int = 0,
        aim: Optional[str] = None,
        apertures: bool = True,
        threads: int = 1,
    ) -> Tolerancing:
        """How badly it may be built: what the tolerances of its file do to a figure, "spot", "opd" or "boresight".  The other
        arguments are those of spot() and wavefront(); threads change no bit."""
        return Tolerancing(
            self,
            figure,
            reference,
            (field, fields, wavelength, pattern, rays, across, aim, apertures),
            threads,
        )

    variables = variables

    # -------------------------------------------------------------------------- fields

    @property
    def fields(self) -> list[tuple[float, float]]:
        """The fields of the lens, (x, y), in its own kind (degrees, heights)."""
        return [(f.x, f.y) for f in self._c.field[: self._c.fields]]

    def _field(self, given: Union[int, Sequence[float]]) -> C.LensField:
        if isinstance(given, (int, np.integer)) and not isinstance(given, bool):
            result: C.LensField = self._c.field[field_number(given, int(self._c.fields)) - 1]
            return result
        x, y = (float(v) for v in given)  # type: ignore[union-attr]
        return C.LensField(x=x, y=y, weight=1.0)

    def _launch(
        self, given: Union[int, Sequence[float]], wavelength: Wavelength
    ) -> tuple[_Launcher, Any]:
        self._only_files("launch")
        key = math.nan if self.wavelengths else self._um(wavelength)
        launcher = self._launchers.get(key)
        if launcher is None:
            launcher = self._launchers[key] = _Launcher(self._handle, key)
        beam, error = C.FieldBeam(), C.Error()
        if not C.library.sgt_launch_field(
            launcher.pointer, self._c.field_kind, _byref(self._field(given)), _byref(beam), _byref(error)
        ):
            raise _fault(error)
        return launcher, beam

    @staticmethod
    def _points(pattern: Any, rays: int, seed: int) -> Floats:
        """x, y, weight in the unit circle, a row each."""
        if not isinstance(pattern, str):
            return points_of(pattern)
        kind = _calls.of_words(pattern, PATTERNS, "pattern")  # type: ignore[arg-type]
        n = C.library.sgt_pupil_points(kind, whole(rays, "rays", 1), seed, 0, None)
        points = np.empty((n, 3))
        C.library.sgt_pupil_points(kind, rays, seed, n, address(points))
        return points

    def launch(
        self,
        field: Union[int, Sequence[float]] = 1,
        pattern: Any = "hexapolar",
        rays: int = 6,
        *,
        wavelength: Wavelength = None,
        seed: int = 0,
    ) -> Rays:
        """Rays of a field through points of the pupil, as trace() takes them.

        field       its number, from 1 as in the lens file, or (x, y) in the lens's own kind
        pattern     "fan", "grid", "hexapolar", "random", "sobol", "cells", "cross" with `rays` as lens.h
                    says, or points of the unit circle, (2, n)
        """
        C.check_arithmetic()
        launcher, beam = self._launch(field, wavelength)
        row, before = self._elements(wavelength)
        points = self._points(pattern, rays, seed)
        n = len(points)
        out, error = np.zeros(n, _dtype(C.Launched)), C.Error()
        if not C.library.sgt_launch_rays(
            launcher.pointer, _byref(beam), row, before, n, address(points), address(out), _byref(error)
        ):
            raise _fault(error)
        x = points.T.copy()
        o, d = out["ray"]["o"].T.copy(), out["ray"]["d"].T.copy()
        o[:, out["status"] != 1] = d[:, out["status"] != 1] = np.nan
        missing, within = out["status"] != Aimed.MET, out["within"].copy()
        within[~missing] = np.nan
        return Rays(o, d, x[0], x[1], x[2], out["status"].copy(), within, out["wanted"].T.copy())

    def surface_z(self, i: int, x: ArrayLike, y: ArrayLike) -> Floats:
        """The sag of element i at x, y of its frame, by rays along z, for drawings; NaN where there is
        none."""
        a, b = np.broadcast_arrays(doubles(x, "x"), doubles(y, "y"))
        row, _ = self._elements(None)
        rays = RayArrays((a.ravel(), b.ravel(), np.zeros(a.size)), (0.0, 0.0, 1.0), -math.inf)
        hits = Passage._make(a.size, ("status", "t"))
        call = C.Call(task=C.INTERSECT, surface=row[i].surface, rays=rays.struct, hits=hits._hits_struct())
        call.opt = ctypes.pointer(_calls.options({"pick": "near-seed"}))
        _calls.run(call, a.size, 1, self._functions)
        z: Floats = hits.t.reshape(a.shape)
        return z

    def vertex(self, i: int) -> tuple[Floats, Floats]:
        """Where element i stands: its origin, and its axes as the columns of a matrix."""
        pose = self._elements(None)[0][i].pose
        axes = np.array([pose.ex, pose.ey, pose.ez]).T
        return np.array(pose.origin), axes if axes.any() else np.eye(3)

    def size(self, i: int) -> float:
        """The half height of element i for drawings: its aperture, or what the file says; 0: not known."""
        e = self._elements(None)[0][i]
        semi = e.semi_diameter if 0 < e.semi_diameter < 2.0**500 else 0.0
        return float(semi or self._c.surface[i].size)


PRIMARY = -1.0  # among wavelengths

# Of passages=True: what is found in the trace itself, and in a later one when it is first read.
AT_ONCE = ("status", "p", "opl")
LATER = (("t", "direction"), ("evals", "t_err", "t_lo", "n", "p_err"))


def _names_of(passages: Any) -> tuple[str, ...]:
    """The numbers of a passage that are wanted; (): none."""
    if isinstance(passages, (bool, np.bool_)):
        return tuple(Passage.FIELDS) if passages else ()
    names = (passages,) if isinstance(passages, str) else passages
    if not isinstance(names, (tuple, list, set, frozenset)):
        raise TypeError(f"passages: must be True, False or names, not {type(passages).__name__}")
    for name in names:
        if not isinstance(name, str) or name not in Passage.FIELDS:
            raise ValueError(f"passages: there is no {name!r}; there are {', '.join(Passage.FIELDS)}")
    return tuple(dict.fromkeys(names))


def _rays(o: Union[VectorsLike, Rays], d: Optional[VectorsLike], axis: Optional[int]) -> RayArrays:
    if isinstance(o, Rays):
        if d is not None:
            raise ValueError("d: is given beside Rays, which have one")
        return RayArrays(o.o, o.d, None, None, 0)
    if d is None:
        raise TypeError("d: is needed; only the Rays of launch() have a direction of their own")
    return RayArrays(o, d, None, None, axis)


def _dtype(of: Any) -> np.dtype[Any]:
    """The struct of C as a type of numpy."""
    formats = []
    for name, kind in of._fields_:
        if issubclass(kind, ctypes.Structure):
            formats.append(_dtype(kind))
        elif issubclass(kind, ctypes.Array):
            formats.append(np.dtype((np.dtype(kind._type_), (kind._length_,))))
        else:
            formats.append(np.dtype(kind))
    names = [name for name, _ in of._fields_]
    return np.dtype(
        {
            "names": names,
            "formats": formats,
            "offsets": [getattr(of, n).offset for n in names],
            "itemsize": ctypes.sizeof(of),
        }
    )


def _reading(glasses: Any, configuration: int) -> tuple[C.LensOptions, Any]:
    paths = [glasses] if isinstance(glasses, (str, os.PathLike)) else list(glasses or ())
    keep = None
    handle = _Glasses.get()
    if paths:
        folder = pathlib.Path(__file__).parent / "glass"
        ship: list[Any] = [folder / "glasses.csv", folder / "older.csv"] if handle else [None]
        keep = _Catalogue(_catalogue([*ship, *paths]))
        handle = keep.handle
    return C.LensOptions(glasses=handle, configuration=configuration, **lens_options()), keep


class _Catalogue:
    def __init__(self, handle: int) -> None:
        self.handle = handle

    def __del__(self, free: Any = C.library.sgt_catalogue_free) -> None:
        free(self.handle)


def _read_text(name: str, text: str, glasses: Any, configuration: int) -> _Handle:
    C.check_arithmetic()
    option, keep = _reading(glasses, configuration)
    raw, error = text.encode(), C.Error()
    pointer = C.library.sgt_lens_read_text(os.fsencode(name), raw, len(raw), _byref(option), _byref(error))
    if not pointer:
        raise _fault(error)
    return _Handle(pointer, keep)


def _set(path: str, value: Any) -> C.Edit:
    if isinstance(value, (int, float, np.number)) and not isinstance(value, bool):
        return C.Edit(C.EDIT_SET, path.encode(), float(value))
    return C.Edit(C.EDIT_SET_TEXT, path.encode(), 0, _text(value).encode())


def _made_again(elements: list[Element], keys: dict[str, Any], glasses: Any) -> Lens:
    return Lens(elements, glasses=glasses, **keys)


def _read_again(text: str, name: str, glasses: Any) -> Lens:
    return Lens.text(text, name=name, glasses=glasses)


__all__ = [
    "Aims",
    "Beam",
    "Element",
    "Fate",
    "FirstOrder",
    "Lens",
    "LensError",
    "Parabasal",
    "Rays",
    "Remark",
    "Seidel",
    "Sensitivity",
]

add_to(Lens)
