# SPDX-License-Identifier: MIT
"""Lens.variables: figures by numbers of the file, for a solver."""
import math

import numpy as np
import pytest

import sagitta

PATHS = ["surfaces[1].radius", "surfaces[2].thickness", "surfaces[4].curvature", "surfaces[3].index"]


@pytest.fixture
def triplet(tree):
    return sagitta.Lens.read(tree / "examples" / "lenses" / "cooke_triplet.yaml")


@pytest.mark.parametrize("figure", ["spot", "opd", "chief", "efl", "distortion"])
def test_jacobian_and_gradient(triplet, figure):
    v = triplet.variables(PATHS, figure, rays=3) if figure in ("spot", "opd") else triplet.variables(PATHS, figure)
    x = v.x0 * (1 + np.array([1e-3, -2e-3, 1e-3, 2e-4]))
    jacobian, gradient = v.jacobian(x), v.gradient(x)
    assert v.backward > 0 or figure == "efl"
    for i, h in enumerate(np.abs(x) * 2.0**-18):
        step = np.eye(len(x))[i] * h
        by = (v.residuals(x + step) - v.residuals(x - step)) / (2 * h)
        assert np.allclose(jacobian[:, i], by, rtol=1e-5, atol=1e-5 * np.abs(by).max() + 1e-12)
        by = (v.values(x + step) - v.values(x - step)) / (2 * h)
        assert np.allclose(gradient[:, i], by, rtol=1e-4, atol=1e-9, equal_nan=True)


def test_figures_are_those_of_the_lens(triplet):
    v = triplet.variables(PATHS)
    rms = triplet.spot().of(wavelength=0).rms
    assert np.allclose(v.values(v.x0)[:-1], rms, rtol=1e-13)
    assert np.isclose(np.linalg.norm(v.residuals(v.x0)), math.sqrt(np.mean(rms**2)), rtol=1e-13)
    v = triplet.variables(PATHS, reference="centroid")
    assert np.allclose(v.values(v.x0)[:-1], triplet.spot(reference="centroid").of(wavelength=0).rms, rtol=1e-12)
    opd = triplet.variables(PATHS, "opd")
    assert np.allclose(opd.values(opd.x0)[:-1], triplet.wavefront().rms, rtol=1e-8)
    efl = triplet.variables(PATHS, "efl")
    assert efl.values(efl.x0)[0] == triplet.first_order().efl
    distortion = triplet.variables(PATHS, "distortion")
    percent = triplet.field().distortion_percent
    assert np.allclose(100 * distortion.values(distortion.x0), percent, rtol=1e-12, equal_nan=True)


def test_lens_with_the_numbers(triplet):
    v = triplet.variables(PATHS)
    x = v.x0 * 1.001
    made = v.lens(x)
    again = made.variables(PATHS)
    assert (again.x0 == x).all()
    assert (again.residuals(x) == v.residuals(x)).all()
    assert (v.residuals(v.x0) == triplet.variables(PATHS).residuals(v.x0)).all()  # and back
    assert made.yaml() != triplet.yaml() and triplet.variables(PATHS).x0[0] == v.x0[0]


def test_what_is_no_lens(triplet):
    v = triplet.variables(["surfaces[1].radius", "surfaces[1].index"])
    v.residuals(v.x0)
    assert np.isnan(v.residuals([0.0, 1.6])).all()
    assert np.isnan(v.residuals([3.0, 1.6])).any()  # rays miss so steep a surface
    with pytest.raises(sagitta.LensError, match="surfaces\\[1\\].radius"):
        v.jacobian([0.0, 1.6])
    assert np.isfinite(v.residuals(v.x0)).all()
    v = triplet.variables(["surfaces[1].radius"])
    with pytest.raises(sagitta.LensError):
        v.residuals([0.0])


def test_refusals(triplet):
    with pytest.raises(sagitta.LensError, match="surfaces\\[99\\]"):
        triplet.variables(["surfaces[99].radius"])
    with pytest.raises(sagitta.LensError, match="twice"):
        triplet.variables(["surfaces[1].radius", "surfaces[1].radius"])
    with pytest.raises(ValueError, match="bounds"):
        triplet.variables(PATHS, bounds={"surfaces[9].radius": (0, 1)})
    with pytest.raises(ValueError, match="bounds"):
        triplet.variables(PATHS, bounds={PATHS[0]: (1e4, 2e4)})
    with pytest.raises(ValueError, match="figure"):
        triplet.variables(PATHS, "strehl")
    with pytest.raises(ValueError, match="reference"):
        triplet.variables(PATHS, "opd", reference="centroid")
    with pytest.raises(TypeError, match="list"):
        triplet.variables("surfaces[1].radius")
    with pytest.raises(ValueError, match="shape"):
        triplet.variables(PATHS).residuals([1.0])
    weights = triplet.variables(["wavelengths[1]"], "opd")
    with pytest.raises(sagitta.LensError, match="wavelengths\\[1\\]"):
        weights.jacobian(weights.x0)
    low, high = triplet.variables(PATHS, bounds={PATHS[1]: (0.1, 20)}).bounds
    assert low[1] == 0.1 and high[1] == 20 and math.isinf(low[0])


def test_a_solver_takes_it(triplet):
    least_squares = pytest.importorskip("scipy.optimize").least_squares
    best = triplet.variables(["surfaces[6].thickness"], rays=3)
    x = least_squares(best.residuals, best.x0 + 1, best.jacobian)
    assert np.linalg.norm(x.fun) <= np.linalg.norm(best.residuals(best.x0)) and abs(x.grad[0]) < 1e-6


def test_pickups_among_the_paths():
    """A pickup that varies is a number of its own; one that does not follows what varies."""
    text = (
        "{pupil: {semi_diameter: 5, distance: 0}, surfaces: [{type: sphere, radius: 50, thickness: 4, index: 1.5},"
        "{type: sphere, radius: {pickup: 'surfaces[1].radius', scale: -1}, thickness: 45, index: 1}, {type: plane}]}"
    )
    lens, paths = sagitta.Lens.text(text), ["surfaces[1].radius", "surfaces[2].radius"]
    plain = lens.set(paths[1], -50.0)
    for order in (paths, paths[::-1]):
        both, apart = lens.variables(order), plain.variables(order)
        for x in (both.x0, both.x0 + [1, -0.5]):
            assert np.array_equal(both.values(x), apart.values(x))
            assert np.array_equal(both.jacobian(x), apart.jacobian(x))
    follows, x = lens.variables(paths[:1]), np.array([51.0])
    assert np.allclose(follows.values(x), plain.variables(paths).values([51, -51]), rtol=1e-12)
    turned = plain.variables(paths).gradient([51, -51])[-1] @ [1, -1]
    assert abs(follows.gradient(x)[-1][0] - turned) <= 1e-9 * abs(turned)
