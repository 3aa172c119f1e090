#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Designs a singlet: scipy.optimize.least_squares, with the derivatives of the trace.

    python3 examples/python/singlet.py

The variables are the curvatures of both sides, the conic constant of the rear and the distance to the image.
What is to vanish is how far from where they ought to be 91 rays of each of two fields meet the image.
Lens.sensitivity() gives the Jacobian in one sweep backward: no ray is traced again, and no step of a
difference has to be chosen.
"""
from __future__ import annotations

from typing import Any, Sequence

import numpy as np
import sagitta
from numpy.typing import NDArray
from sagitta import Element, Lens, Plane, Sensitivity
from scipy.optimize import least_squares

Floats = NDArray[np.float64]
FOCAL, INDEX, FIELDS = 100.0, 1.5168, np.radians([0, 1])
START = (0.005, -0.005, 0.0, 95.0)


def lens_of(v: Sequence[float] | Floats) -> Lens:
    front, rear, conic, back = v
    return Lens(
        [
            Element(Plane(), thickness=5, stop=True, semi_diameter=10),
            Element(sagitta.Sphere(curvature=front), thickness=6, index=INDEX),
            Element(sagitta.Conic(curvature=rear, conic=conic), thickness=back, index=1),
            Element(Plane()),
        ],
        pupil={"semi_diameter": 10},
    )


def launched() -> tuple[Floats, Floats, Floats]:
    """Rays of all fields through the stop, and where each ought to end."""
    at = lens_of(START).launch(1, "hexapolar", 5)
    stop = 10 * np.array([at.px, at.py, 0 * at.px])
    d = [np.array([[0], [np.tan(a)], [1]]) + 0 * stop for a in FIELDS]
    wanted = [np.array([[0], [FOCAL * np.tan(a)]]) + 0 * stop[:2] for a in FIELDS]
    return np.hstack([stop - 10 * v for v in d]), np.hstack(d), np.hstack(wanted)


def main() -> tuple[Lens, Any]:
    o, d, wanted = launched()

    def ends(v: Sequence[float] | Floats) -> Sensitivity:
        return lens_of(v).sensitivity(o, d, ("x", "y"))

    def miss(v: Sequence[float] | Floats) -> Floats:
        return (ends(v).value - wanted).ravel()

    def jacobian(v: Floats) -> Floats:
        found = ends(v)
        variables = ((1, "curvature"), (2, "curvature"), (2, "conic"), (2, "thickness"))
        return np.array([found.by(*v).ravel() for v in variables]).T

    found = least_squares(miss, START, jac=jacobian, x_scale=[0.01, 0.01, 1, 100])
    lens = lens_of(found.x)
    print(f"{found.nfev} evaluations: rms {rms(miss(START)):.3g} -> {rms(found.fun):.3g}")
    front, rear, conic, back = found.x
    print(f"radii {1 / front:.2f}, {1 / rear:.2f}, conic {conic:.2f}; image at {back:.2f}")
    print(f"focal length {lens.first_order().efl:.2f}")
    return lens, found


def rms(x: Floats) -> float:
    return float(np.sqrt(np.mean(x * x)))


if __name__ == "__main__":
    main()
