#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""How a design tool binds the library: a lens class of its own, with one call of the library for each trace.

    python3 examples/python/optic.py

The class is of the kind that such tools have (Optiland, rayoptics): surfaces are objects of Python that a
user edits, rays are arrays x, y, z, L, M, N, and every surface remembers where the rays met it.  Tools mostly
loop over the surfaces and ask each for a distance.  Here the loop only describes them; sgt_trace_batch traces
all rays through all surfaces, and keeps them in the processor's cache on the way.
"""
from __future__ import annotations

from typing import Any, Optional, Sequence

import numpy as np
import sagitta
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Surface:
    """What a user edits, and what the last trace has left."""

    def __init__(
        self,
        radius: float = np.inf,
        thickness: float = 0.0,
        index: Optional[float] = None,
        conic: float = 0.0,
        coefficients: Sequence[float] = (),
        semi_diameter: float = 0.0,
        is_stop: bool = False,
        mirror: bool = False,
    ) -> None:
        self.radius, self.thickness, self.index, self.conic = radius, thickness, index, conic
        self.coefficients, self.semi_diameter = list(coefficients), semi_diameter
        self.is_stop, self.mirror = is_stop, mirror
        self.x = self.y = self.z = self.L = self.M = self.N = self.opd = np.empty(0)

    def element(self) -> sagitta.Element:
        shape: sagitta.Surface = sagitta.Conic(self.radius, self.conic)
        if self.coefficients:
            shape = sagitta.EvenAsphere(self.radius, self.conic, self.coefficients)
        return sagitta.Element(
            shape,
            thickness=self.thickness,
            index=self.index,
            mirror=self.mirror,
            semi_diameter=self.semi_diameter,
            stop=self.is_stop,
        )


class Optic:
    """A row of surfaces; the last is the image."""

    def __init__(self, epd: float = 0.0, fields: Sequence[float] = (0.0,)) -> None:
        self.surfaces: list[Surface] = []
        self.epd, self.fields = epd, list(fields)
        self._lens: Optional[sagitta.Lens] = None
        self._state: Any = None

    def add_surface(self, **keys: Any) -> Optic:
        self.surfaces.append(Surface(**keys))
        return self

    @property
    def lens(self) -> sagitta.Lens:
        """The library's lens, made anew only if something has been edited."""
        elements = [s.element() for s in self.surfaces]
        state = (elements, self.epd, list(self.fields))
        if self._lens is None or state != self._state:
            self._lens = sagitta.Lens(elements, pupil={"semi_diameter": self.epd / 2}, fields=self.fields)
            self._state = state
        return self._lens

    def trace(self, field: int = 1, rays: int = 6, pattern: str = "hexapolar") -> sagitta.Traced:
        """Rays of a field; afterwards each surface has the global points and directions."""
        launched = self.lens.launch(field, pattern, rays)
        return self.trace_rays(*launched.o, *launched.d)

    def trace_rays(self, x: Floats, y: Floats, z: Floats, L: Floats, M: Floats, N: Floats) -> sagitta.Traced:
        traced = self.lens.trace((x, y, z), (L, M, N), passages=("p", "direction", "opl"))
        for i, (surface, passage) in enumerate(zip(self.surfaces, traced.passages)):
            vertex, _ = self.lens.vertex(i)  # no surface is tilted here
            surface.x, surface.y, surface.z = passage.p + vertex[:, None]
            surface.L, surface.M, surface.N = passage.direction
            surface.opd = passage.opl
        return traced

    def focal_length(self) -> float:
        return self.lens.first_order().efl

    def rms_spot(self, field: int = 1) -> float:
        return float(self.lens.spot(field, rays=6, reference="centroid").rms[0])

    def gradient(self, field: int, surface: int, name: str) -> float:
        """d(mean square of the spot) / d(radius, conic, thickness ...) of a surface."""
        there = self.lens.sensitivity(self.lens.launch(field), of=("x", "y"))
        centred = there.value - there.value.mean(axis=1, keepdims=True)
        return float(2 * (centred * there.by(surface, name)).sum(axis=0).mean())


def cooke_triplet() -> Optic:
    optic = Optic(epd=10, fields=[0, 14, 20])
    for radius, thickness, index, semi in (
        (22.01359, 3.25896, 1.62261, 9.5),
        (-435.76044, 6.00755, 1, 8.5),
        (-22.21328, 0.99997, 1.62040, 5),
        (20.29192, 4.75041, 1, 5),
        (79.68360, 2.95208, 1.62261, 7.5),
        (-18.39533, 42.20778, 1, 7.5),
    ):
        optic.add_surface(
            radius=radius, thickness=thickness, index=index, semi_diameter=semi, is_stop=radius == 20.29192
        )
    return optic.add_surface()


def main() -> None:
    optic = cooke_triplet()
    traced = optic.trace(1)
    print(f"{len(optic.surfaces)} surfaces, {int(traced.through.sum())} of {len(traced)} rays at the image")
    print(f"focal length {optic.focal_length():.3f}, rms {optic.rms_spot(2):.4f}")
    image = optic.surfaces[-1]
    print(f"image: y from {image.y.min():.3f} to {image.y.max():.3f}")
    optic.surfaces[-2].thickness += 0.1
    print(f"refocused by 0.1: rms {optic.rms_spot(2):.4f}")
    print(f"d(mean square)/d(radius of the front): {optic.gradient(1, 0, 'radius'):.5f}")


if __name__ == "__main__":
    main()
