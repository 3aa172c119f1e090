# SPDX-License-Identifier: MIT
"""Pictures by matplotlib, which is needed for this module only: layouts and spots.

    import sagitta.plot
    sagitta.plot.layout(lens)
    sagitta.plot.spots(lens)

Each function draws into `ax` (a new figure, if none is given) and returns the Axes.  The command draws more:
sagitta trace LENS --picture, sagitta spot, fan, opd, field.
"""
from __future__ import annotations

from typing import Any, Optional, Sequence, Union

import numpy as np

from .lens import Lens


def _axes(ax: Any) -> Any:
    if ax is not None:
        return ax
    import matplotlib.pyplot as pyplot

    return pyplot.subplots()[1]


def layout(
    lens: Lens,
    *,
    fields: Optional[Sequence[Any]] = None,
    rays: int = 5,
    wavelength: Optional[float] = None,
    size: float = 0.0,
    ax: Any = None,
) -> Any:
    """The lens in the plane of z and y: each element out to its aperture, and a fan of rays of each field.

    fields  as for Lens.launch(); None: all of the lens; (): no rays
    size    the half height of elements that have none
    """
    ax = _axes(ax)
    heights = [lens.size(i) for i in range(len(lens))]
    largest = size or max(heights, default=0.0) or 1.0
    for i, height in enumerate(heights):
        y = np.linspace(-1, 1, 101) * (height or largest)
        origin, axes = lens.vertex(i)
        points = origin[:, None] + axes @ np.array([0 * y, y, lens.surface_z(i, 0 * y, y)])
        ax.plot(points[2], points[1], color="black", linewidth=1)
    for k, field in enumerate(range(1, len(lens.fields) + 1) if fields is None else fields):
        there = lens.launch(field, "fan", rays, wavelength=wavelength)
        traced = lens.trace(there, wavelength=wavelength, passages=("status", "p"))
        path = [there.o]
        for i, passage in enumerate(traced.passages):
            origin, axes = lens.vertex(i)
            path.append(origin[:, None] + axes @ np.where(passage.status > 0, passage.p, np.nan))
        ax.plot(*np.array(path)[:, [2, 1]].transpose(1, 0, 2), color=f"C{k}", linewidth=0.6)
    ax.set_aspect("equal")
    unit = f" ({lens.units})" if lens.units else ""
    ax.set_xlabel("z" + unit)
    ax.set_ylabel("y" + unit)
    return ax


def spots(
    lens: Lens,
    *,
    field: Union[int, Sequence[float]] = 1,
    pattern: Any = "hexapolar",
    rays: int = 8,
    wavelengths: Optional[Sequence[float]] = None,
    ax: Any = None,
) -> Any:
    """The spot of a field about its centroid, a colour for each wavelength (None: all of the lens)."""
    ax = _axes(ax)
    given: dict[str, Any] = {"pattern": pattern, "rays": rays, "wavelength": wavelengths}
    whole = lens.spot(field, reference="centroid", **given)[-1]
    ends = lens.ends(field, **given)
    for k, um in enumerate(np.unique(ends.wavelength)):
        part = ends.of(wavelength=um) if um == um else ends
        label = f"{um:g} um" if um == um else None
        ax.plot(part.x - whole["x"], part.y - whole["y"], ".", color=f"C{k}", markersize=3, label=label)
    ax.set_aspect("equal")
    ax.set_title(f"rms {whole['rms']:.3g} {lens.units}".rstrip())
    if len(np.unique(ends.wavelength)) > 1:
        ax.legend()
    return ax
