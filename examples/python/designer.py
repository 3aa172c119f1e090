#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A day with a lens: read it, refocus it, optimise it, ask how badly it may be built, and draw it.

    python3 examples/python/designer.py [LENS [PICTURE]]

LENS is any lens file, such as a .zmx; PICTURE is drawn by matplotlib.
"""
import pathlib
import sys
from typing import Optional

import numpy as np
from scipy.optimize import least_squares

import sagitta
from sagitta import plot

LENS = pathlib.Path(__file__).parents[2] / "tests" / "data" / "zmx" / "optiland__lens1__ad519c.zmx"


def rms(lens: sagitta.Lens) -> float:
    """Over the fields, all wavelengths together, as the lens weighs them."""
    return float(np.linalg.norm(lens.variables([]).residuals([])))


def refocused(lens: sagitta.Lens) -> sagitta.Lens:
    """The last thickness such that the spots are least."""
    focus = lens.variables([f"surfaces[{len(lens) - 1}].thickness"])
    return focus.lens(least_squares(focus.residuals, focus.x0, focus.jacobian).x)


def optimised(lens: sagitta.Lens) -> sagitta.Lens:
    """Curved surfaces may bend by a tenth, and the image moves; the focal length is held."""
    curved = [i + 1 for i in range(len(lens)) if getattr(lens.surface(i), "curvature", 0)]
    paths = [f"surfaces[{i}].curvature" for i in curved] + [f"surfaces[{len(lens) - 1}].thickness"]
    bounds = {path: (x - 0.1 * abs(x), x + 0.1 * abs(x)) for path, x in zip(paths, lens.variables(paths).x0)}
    spot, focal = lens.variables(paths, bounds=bounds), lens.variables(paths, "efl")
    wanted = focal.residuals(focal.x0)  # at each wavelength
    found = least_squares(
        lambda x: np.append(spot.residuals(x), focal.residuals(x) - wanted),
        spot.x0,
        lambda x: np.vstack([spot.jacobian(x), focal.jacobian(x)]),
        bounds=spot.bounds,
        x_scale="jac",
        max_nfev=30,
    )
    return spot.lens(found.x)


def tolerated(lens: sagitta.Lens) -> sagitta.Lens:
    """A thousandth of each radius, 0.02 of each thickness; the image surface is set to the paraxial focus."""
    curved = [i + 1 for i in range(len(lens)) if getattr(lens.surface(i), "curvature", 0)]
    radii = lens.variables([f"surfaces[{i}].radius" for i in curved]).x0
    rows: list[dict[str, object]] = [{"surface": i, "radius": 1e-3 * abs(r)} for i, r in zip(curved, radii)]
    rows += [{"surface": i, "thickness": 0.02} for i in range(min(curved), len(lens) - 1)]
    rows += [{"surface": len(lens) - 1, "thickness": 0.5, "compensator": "paraxial"}]
    return lens.set("tolerances", rows)


def main(path: pathlib.Path = LENS, picture: Optional[pathlib.Path] = None) -> tuple[float, float, float]:
    lens = sagitta.Lens.read(path)
    focused = refocused(lens)
    better = optimised(focused)
    print(f"rms spot: {rms(lens):.5f} as read, {rms(focused):.5f} refocused, {rms(better):.5f} optimised")
    built = tolerated(better).tolerance(across=8)
    rows, estimate = built.sensitivity()
    print(f"designed {built.nominal:.5f}, built {estimate:.5f}; worst: {built.entries[rows['entry'][0]].text}")
    trials = built.trials(500)
    ninety = trials.quantile(0.9)
    print(f"90 % of 500 trials below {ninety.estimate:.5f} ({ninety.lower:.5f} to {ninety.upper:.5f})")
    if picture:
        import matplotlib

        matplotlib.use("Agg")
        plot.layout(better).figure.savefig(picture)
    return rms(lens), rms(better), ninety.estimate


if __name__ == "__main__":
    main(*map(pathlib.Path, sys.argv[1:3]))
