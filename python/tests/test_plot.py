# SPDX-License-Identifier: MIT
"""The pictures: drawn at all, and what is drawn is where the rays are."""
import numpy as np
import pytest

from sagitta import Lens

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("svg")


def test_a_layout(tree, tmp_path):
    import sagitta.plot

    lens = Lens.read(tree / "examples" / "lenses" / "double_gauss.yaml")
    ax = sagitta.plot.layout(lens, rays=3)
    lines = [np.array(line.get_data(), float) for line in ax.get_lines()]
    assert len(lines) == 12 + 3 * 3
    marginal = lens.trace(lens.launch(1, "fan", 3))
    assert np.allclose(lines[12 + 2][:, -1], marginal.o[[2, 1], 2])
    ax.figure.savefig(tmp_path / "layout.svg")
    assert (tmp_path / "layout.svg").stat().st_size > 1000


def test_spots(tree):
    import sagitta.plot

    lens = Lens.read(tree / "examples" / "lenses" / "cooke_triplet.yaml")
    ax = sagitta.plot.spots(lens, rays=4)
    points = np.concatenate([np.array(line.get_data()) for line in ax.get_lines()], axis=1)
    assert points.shape[1] == 61 * max(1, len(lens.wavelengths))
    assert np.abs(np.nanmean(points, axis=1)).max() < np.nanmax(np.abs(points))
