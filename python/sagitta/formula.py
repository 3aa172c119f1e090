# SPDX-License-Identifier: MIT
"""A surface from its formula as text (formula.h has the grammar)."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Hashable

from . import _library as C
from ._arrays import doubles
from .function import Inside, ball_and_box, ball_key
from .surface import Surface


class FormulaError(ValueError):
    """What is wrong with a formula.  column: of the first character that is wrong, from 1; 0: none is to
    blame."""

    def __init__(self, message: str, column: int = 0) -> None:
        super().__init__(message)
        self.column = column

    def __reduce__(self) -> Any:
        return FormulaError, (str(self), self.column)


def _read(text: str, kind: int, parameters: dict[str, float]) -> tuple[Any, int]:
    """The room of a tape, and where the tape is."""
    if not isinstance(text, str):
        raise TypeError(f"formula: must be a text, not {type(text).__name__}")
    names = [name.encode() for name in parameters]
    named = (C.Named * max(len(names), 1))()
    for i, (name, value) in enumerate(parameters.items()):
        number = doubles(value, name)
        if number.ndim:
            raise ValueError(f"{name}: must be a number; it has the shape {number.shape}")
        named[i].name, named[i].value = names[i], float(number)
    size = C.library.sgt_formula_room(text.encode(), len(names))
    room = ctypes.create_string_buffer(max(size, 8))
    error = C.Error()
    tape = C.library.sgt_formula_read(
        text.encode(),
        kind,
        len(names),
        ctypes.addressof(named),
        ctypes.addressof(room),
        size,
        ctypes.byref(error),
    )
    if not tape:
        said = C.text(error.words)
        if error.column:
            before = text.encode()[: error.column - 1].decode("utf-8", "replace")
            said = f"{said}\n    {text}\n    {' ' * len(before)}^"
        raise FormulaError(f"formula: {said}", error.column)
    return room, tape


class _Written(Surface):
    formula: str
    given: dict[str, float]

    def __getattr__(self, name: str) -> float:
        if not name.startswith("_") and name in self.__dict__.get("given", {}):
            return self.given[name]
        raise AttributeError(f"{type(self).__name__} has no parameter {name!r}")

    @property
    def _numbers(self) -> Hashable:
        return frozenset((name, float(x)) for name, x in self.given.items())

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.given]

    @property
    def parameters(self) -> tuple[str, ...]:
        return tuple(self.given)


class Formula(_Written):
    """The surface F(x, y, z) = 0 of a formula.  It is proven and differentiated as a built-in one.

    formula     such as "x^4 + y^4 + z^4 = a".  It may name x, y, z, r = sqrt(x^2 + y^2), pi, the functions of
                formula.h, and the parameters
    inside      where it is clipped: the radius of a ball about the origin, two corners of a box, or
                {"ball": ..., "box": ...}.  None: nowhere
    the rest    the parameters, by their names

    >>> import sagitta
    >>> cube = sagitta.Formula("x^4 + y^4 + z^4 = a", a=16)
    >>> cube.intersect((0, 0, -5), (0, 0, 1)).t
    3.0
    >>> cube.replace(a=81).intersect((0, 0, -5), (0, 0, 1)).t
    2.0
    """

    def __init__(self, formula: str, *, inside: Inside = None, **parameters: float) -> None:
        ball, lo, hi = ball_and_box(inside)
        self.formula, self.inside, self.given = formula, inside, dict(parameters)
        self._room, tape = _read(formula, 0, parameters)
        self._set(C.address_of("sgt_formula_ops"), C.Formula(tape, ball, C.Vector(*lo), C.Vector(*hi)))

    def replace(self, **changes: Any) -> "Formula":
        """The same with some parameters, or `inside`, changed."""
        given: dict[str, Any] = {"inside": self.inside, **self.given, **changes}
        return Formula(self.formula, **given)

    def __repr__(self) -> str:
        more = "".join(f", {k}={v!r}" for k, v in self.given.items())
        return f"Formula({self.formula!r}{more}{'' if self.inside is None else f', inside={self.inside!r}'})"

    def __reduce__(self) -> Any:
        return _again, (Formula, self.formula, {"inside": self.inside, **self.given})

    def _key(self) -> Hashable:
        return self.formula, self._numbers, ball_key(self.inside)

    def _yaml(self) -> dict[str, Any]:
        ball, lo, hi = ball_and_box(self.inside)
        inside: dict[str, Any] = {
            **({"ball": ball} if ball else {}),
            **({"box": [lo.tolist(), hi.tolist()]} if hi.any() else {}),
        }
        return {"type": "formula", "f": self.formula, **self.given, **({"inside": inside} if inside else {})}


class Sag(_Written):
    """The sag z = s(x, y) of a formula: a surface of a lens.

    formula         such as "c*r^2/(1 + sqrt(1 - c^2*r^2))"; it may name x, y, r and what Formula may but z
    semi_diameter   of the rim, length; 0: none
    the rest        the parameters, by their names

    >>> import sagitta
    >>> sagitta.Sag("r^2/(2*R)", R=50, semi_diameter=10).intersect((0, 5, -5), (0, 0, 1)).p
    array([0.  , 5.  , 0.25])
    """

    def __init__(self, formula: str, *, semi_diameter: float = 0.0, **parameters: float) -> None:
        rim = float(doubles(semi_diameter, "semi_diameter"))
        if not 0 <= rim < float("inf"):
            raise ValueError(f"semi_diameter: must be finite and not negative, not {rim}")
        self.formula, self.semi_diameter, self.given = formula, rim, dict(parameters)
        self._room, tape = _read(formula, 1, parameters)
        self._set(C.address_of("sgt_formula_sag_ops"), C.FormulaSag(tape, rim))

    def replace(self, **changes: Any) -> "Sag":
        """The same with some parameters, or `semi_diameter`, changed."""
        return Sag(self.formula, **{"semi_diameter": self.semi_diameter, **self.given, **changes})

    def __repr__(self) -> str:
        more = "".join(f", {k}={v!r}" for k, v in self.given.items())
        rim = f", semi_diameter={self.semi_diameter}" if self.semi_diameter else ""
        return f"Sag({self.formula!r}{more}{rim})"

    def __reduce__(self) -> Any:
        return _again, (Sag, self.formula, {"semi_diameter": self.semi_diameter, **self.given})

    def _key(self) -> Hashable:
        return self.formula, self._numbers, self.semi_diameter

    def _yaml(self) -> dict[str, Any]:
        rim = {"semi_diameter": self.semi_diameter} if self.semi_diameter else {}
        return {"type": "formula", "sag": self.formula, **self.given, **rim}


def _again(cls: Any, text: str, given: dict[str, Any]) -> Any:
    return cls(text, **given)
