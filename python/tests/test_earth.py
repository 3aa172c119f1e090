# SPDX-License-Identifier: MIT
"""The surfaces about the Earth: the bits of the command; and what is said where they are absent."""
import csv
import io
import os
import subprocess
import sys

import numpy as np
import pytest

import sagitta
from sagitta import earth

COMMAND = os.environ.get("SAGITTA_COMMAND")
RAY = (7e6, 1e5, 2e5, -1, 0.02, 0.1)


def command(spec):
    done = subprocess.run(
        [COMMAND, "intersect", "--surface", spec, "--ray", " ".join(map(str, RAY)), "--format", "csv"],
        capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    row, = csv.DictReader(io.StringIO(done.stdout))
    return row


@pytest.mark.skipif(not earth.available or not COMMAND, reason="built without GeographicLib, or no command")
@pytest.mark.parametrize("surface, spec", [
    (lambda: sagitta.GeodeticHeight(h=1000), "{type: geodetic_height, h: 1000}"),
    (lambda: sagitta.GeodeticHeight(a=6e6, f=0.01, h=-5), "{type: geodetic_height, a: 6e6, f: 0.01, h: -5}"),
    (lambda: sagitta.LevelGravity(h=30), "{type: level_gravity, h: 30}"),
    (lambda: sagitta.Geoid(h=2), "{type: geoid, h: 2}"),
])
def test_bits(surface, spec):
    try:
        own = surface()
    except ValueError as error:
        pytest.skip(str(error))
    hit, row = own.intersect(o=RAY[:3], d=RAY[3:]), command(spec)
    assert (hit.t, *hit.p) == tuple(float(row[k]) for k in ("t", "x", "y", "z"))  # (t_err has 3 digits there)
    of_lens = sagitta.Lens.text("surfaces: [%s]" % spec)
    assert of_lens is not None


@pytest.mark.skipif(not earth.available or not COMMAND, reason="built without GeographicLib, or no command")
def test_places():
    """Rays from places and places of hits: the bits of the command; there and back; of another ellipsoid."""
    lat, lon = np.meshgrid([-90, -89.9999, -30, 0, 48, 90.0], [-180, -1e-12, 0, 11, 179.9999, 180.0])
    o, d = earth.rays(lat, lon, 7e5, 30, -80)
    assert o.shape == d.shape == (6, 6, 3)
    back = earth.places(o)
    assert np.abs(back[0] - lat).max() < 1e-13 and np.abs(back[2] - 7e5).max() < 1e-8
    inside = np.abs(lat) < 89.99
    assert np.abs((back[1] - lon + 180) % 360 - 180)[inside].max() < 1e-12
    assert (back[1] > -180).all() and (back[1] <= 180).all()
    hits = sagitta.GeodeticHeight(h=100).intersect(o, d)
    place = earth.places(hits.p)
    looks = [word for i in range(lat.size)
             for word in ("--from", f"{lat.flat[i]!r} {lon.flat[i]!r} 7e5".replace("np.float64(", "").replace(")", ""),
                          "--look", "30 -80")]
    done = subprocess.run([COMMAND, "intersect", "--surface", "{type: geodetic_height, h: 100}", *looks,
                           "--format", "csv"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for i, row in enumerate(csv.DictReader(io.StringIO(done.stdout))):
        assert tuple(a.flat[i] for a in place) == tuple(float(row[k]) for k in ("lat", "lon", "height"))
    other = sagitta.GeodeticHeight(a=1000, f=0.1, h=5)
    o, d = earth.rays([10, 20], 30, 500, over=other)
    at = earth.places(other.intersect(o, d).p, over=other)
    assert np.allclose(at[2], 5, atol=1e-10) and np.allclose(at[0], [10, 20], atol=1e-10)
    assert np.isnan(earth.rays(91, 0, 0)[0]).all()
    with pytest.raises(TypeError, match="over"):
        earth.places((1, 2, 3), over=sagitta.Plane())
    with pytest.raises(ValueError, match="last axis"):
        earth.places((1, 2))


@pytest.mark.skipif(not earth.available, reason="built without GeographicLib")
def test_refusals():
    with pytest.raises(ValueError):
        sagitta.Geoid(file="/nowhere.gtx")
    with pytest.raises(ValueError):
        sagitta.GeodeticHeight(h=float("nan"))


def test_absent(monkeypatch):
    monkeypatch.setattr(earth, "available", False)
    for of in (sagitta.GeodeticHeight, sagitta.LevelGravity, sagitta.Geoid):
        with pytest.raises(RuntimeError, match="libgeographiclib-dev.*proj-data.*reconfigure"):
            of(h=1)


if __name__ == "__main__":
    sys.exit(pytest.main([__file__]))
