# SPDX-License-Identifier: MIT
"""An analysis in shares, for as many processes or machines, and its answer put together of them (sgt_shard of study.h).

    parts = [lens.part("spot", k, 50, pattern="random", rays=10**9) for k in range(1, 51)]     # anywhere
    spot = sagitta.join(parts)      # to the last bit lens.spot(pattern="random", rays=10**9)

Which rays a share has depends on its number alone.  A part knows the lens and what was asked, so parts that do not
belong together are refused by their numbers; it is pickled with both, in some KB if the analysis is one of sums.
"""
from __future__ import annotations

import sys
import zlib
from typing import TYPE_CHECKING, Any, Iterable

from . import _library as C
from ._tables import alike

if TYPE_CHECKING:
    from .lens import Lens
    from .study import Answer


def _version() -> str:
    """What has to be the same where parts are made and where they are joined."""
    return f"sagitta {C.text(C.library.sgt_version())}, {sys.byteorder}-endian"


class Part:
    """One of `of` shares of an analysis, by its number from 1: see Lens.part().  size: bytes when it is packed."""

    def __init__(
        self, lens: "Lens", analysis: str, number: int, of: int, asked: dict[str, Any], written: bytes
    ) -> None:
        self.lens, self.analysis, self.number, self.of, self.asked = lens, analysis, number, of, asked
        self.version = _version()
        self._packed = zlib.compress(written, 1)  # (most of an exact sum is zeros)

    @property
    def size(self) -> int:
        return len(self._packed)

    def __repr__(self) -> str:
        return f"<part {self.number} of {self.of} of {self.analysis}: {self.size} bytes>"

    def _written(self) -> bytes:
        try:
            return zlib.decompress(self._packed)
        except zlib.error:
            raise ValueError(f"join: part {self.number} of {self.of} is damaged") from None

    def _unlike(self, other: "Part") -> str:
        """What of another part is another one's; "": nothing."""
        if self.version != other.version:
            return f"is of {other.version}; part {self.number} is of {self.version}"
        if (self.analysis, self.of) != (other.analysis, other.of):
            return f"is of {other.analysis} in {other.of} parts, not of {self.analysis} in {self.of}"
        named = {name for asked in (self.asked, other.asked) for name in asked}
        for name in sorted(named):
            if not _alike(self.asked.get(name), other.asked.get(name)):
                return f"was asked with another {name} than part {self.number}"
        return "" if self.lens == other.lens else f"is of another lens than part {self.number}"


def _alike(a: Any, b: Any) -> bool:
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(map(_alike, a, b))
    return alike(a, b)


def join(parts: Iterable[Part], threads: int = 1) -> "Answer":
    """The answer of one run, to the last bit, of all its parts in any order.

    ValueError: a part is missing, there twice, damaged or of another run; the message names it.

    >>> import sagitta
    >>> lens = sagitta.Lens.text("{pupil: {semi_diameter: 5}, fields: [0, 2], surfaces: ["
    ...     "{type: sphere, radius: 50, thickness: 98, index: 1.5}, {type: plane}]}")
    >>> parts = [lens.part("spot", k, 3, rays=20) for k in (3, 1, 2)]
    >>> sagitta.join(parts) == lens.spot(rays=20)
    True
    """
    from .study import ask

    given = list(parts)
    for part in given:
        if not isinstance(part, Part):
            raise TypeError(f"join: must be parts, not {type(part).__name__}")
    if not given:
        raise ValueError("join: there are no parts")
    first, found = given[0], {}
    for part in given:
        unlike = first._unlike(part)
        if unlike:
            raise ValueError(f"join: part {part.number} of {part.of} {unlike}")
        if part.number in found:
            raise ValueError(f"join: part {part.number} of {part.of} is there twice")
        found[part.number] = part
    missing = [k for k in range(1, first.of + 1) if k not in found]
    if missing:
        more = f", and {len(missing) - 1} more" if len(missing) > 1 else ""
        raise ValueError(f"join: part {missing[0]} of {first.of} is missing{more}")
    written = [found[k]._written() for k in range(1, first.of + 1)]
    answer: Answer = ask(first.lens, first.analysis, {**first.asked, "threads": threads}, 0, first.of, written)
    return answer


__all__ = ["Part", "join"]
