#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Brings a double Gauss back from poor starts: scipy.optimize.least_squares, with the derivatives of the library.

    python3 examples/python/optimise.py [STARTS]

Radii and thicknesses of the file may vary within bounds; the glass stays.  What is made small is the RMS spot,
and the focal length is held.  A start is the lens with every variable moved at random, so far that its RMS spot
is ten times as large.  The same by differences traces the rays once for each variable.
"""
import pathlib
import sys
import time

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

import sagitta

Floats = NDArray[np.float64]
FOCAL_WEIGHT = 0.1  # of a length of focal length, beside a length of spot
LENS = pathlib.Path(__file__).parents[1] / "lenses" / "double_gauss.yaml"


class Task:
    """What is made small: the residuals of two figures of the same variables, one below the other."""

    def __init__(self, lens: sagitta.Lens) -> None:
        curved = [i for i in range(len(lens)) if getattr(lens.surface(i), "curvature", 0)]
        paths = [f"surfaces[{i + 1}].radius" for i in curved]
        paths += [f"surfaces[{i + 1}].thickness" for i in range(len(lens) - 1)]
        first = lens.variables(paths)
        bounds = {}
        for path, x in zip(paths, first.x0):
            ends = (0.6 * x, 1.6 * x) if "radius" in path else (max(0.3, 0.7 * x), 1.3 * x + 0.3)
            bounds[path] = (min(ends), max(ends))
        self.spot = lens.variables(paths, rays=4, apertures=False, bounds=bounds)
        self.focal = lens.variables(paths, "efl")
        self.x0, self.bounds = self.spot.x0, self.spot.bounds
        self.wanted, self.rms = self.focal.values(self.x0)[0], self.rms_at(self.x0)

    def rms_at(self, x: Floats) -> float:
        return float(np.linalg.norm(self.spot.residuals(x)))

    def residuals(self, x: Floats) -> Floats:
        return np.append(self.spot.residuals(x), FOCAL_WEIGHT * (self.focal.residuals(x) - self.wanted))

    def jacobian(self, x: Floats) -> Floats:
        return np.vstack([self.spot.jacobian(x), FOCAL_WEIGHT * self.focal.jacobian(x)])

    def start(self, number: int) -> Floats:
        way, share, x = np.random.default_rng(number).uniform(-1, 1, len(self.x0)), 5e-4, self.x0
        while not self.rms_at(x) >= 10 * self.rms:
            x = np.clip(self.x0 * (1 + share * way), *self.bounds)
            share *= 1.1
        inside: Floats = np.clip(x, self.bounds[0] + 1e-9, self.bounds[1] - 1e-9)
        return inside


def main(starts: int = 5) -> bool:
    task = Task(sagitta.Lens.read(LENS))
    print(f"{len(task.x0)} variables, rms spot {task.rms:.5f}, focal length {task.wanted:.2f}\n")
    print("start  derivatives      before     after  RMS / original  focal length  traces      rays  seconds")
    well = True
    for number in range(1, starts + 1):
        for kind in ("exact", "differences"):
            x = task.start(number)
            before, rays, traces, begun = task.rms_at(x), task.spot.rays, task.spot.evaluations, time.perf_counter()
            by = task.jacobian if kind == "exact" else "2-point"
            x = least_squares(task.residuals, x, by, bounds=task.bounds, x_scale="jac", ftol=1e-3, max_nfev=60).x
            seconds, traces, rays = time.perf_counter() - begun, task.spot.evaluations - traces, task.spot.rays - rays
            after, f = task.rms_at(x), task.focal.values(x)[0]
            well = well and after <= 1.05 * task.rms
            print(f"{number:5}  {kind:<12} {before:10.5f} {after:9.5f} {after / task.rms:15.3f} {f:13.3f} "
                  f"{traces:7} {rays:9} {seconds:8.2f}")
    print("\nall come back" if well else "\nnot all come back")
    return well


if __name__ == "__main__":
    sys.exit(not main(*map(int, sys.argv[1:2])))
