# SPDX-License-Identifier: MIT
"""The surfaces about the Earth: the bits of the command; and what is said where they are absent."""
import csv
import io
import os
import subprocess
import sys

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
