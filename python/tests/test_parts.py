# SPDX-License-Identifier: MIT
"""Sums and shares: the same bits in any parts and any order, and by the command; what does not belong is refused."""
import math
import pickle
import random
import subprocess
from fractions import Fraction

import numpy as np
import pytest

import sagitta
from sagitta import SpotSums, WavefrontSums


def triplet(tree):
    return sagitta.Lens.read(tree / "examples" / "lenses" / "cooke_triplet.yaml")


# --------------------------------------------------------------------------- sums


def hostile(rng, n):
    """Numbers of exponents far apart, half of which cancel."""
    x = rng.standard_normal(n) * 2.0 ** rng.integers(-300, 300, n)
    x[n // 2 :] = -x[: n - n // 2]
    return x


def divided(rng, make, columns, n):
    """Sums of rays in a random order, in random parts, some of which are pickled, merged in a random order."""
    order = rng.permutation(n)
    cuts = np.sort(rng.integers(0, n + 1, rng.integers(1, 9)))
    parts = [make().add(*(c[part] for c in columns)) for part in np.split(order, cuts)]
    while len(parts) > 1:
        more = parts.pop(rng.integers(len(parts)))
        into = rng.integers(len(parts))
        parts[into] = parts[into] + pickle.loads(pickle.dumps(more)) if rng.random() < 0.5 else parts[into].merge(more)
    return parts[0]


def test_any_parts_in_any_order(rng):
    n = 500
    columns = hostile(rng, n), hostile(rng, n), rng.uniform(0, 2, n), rng.uniform(0, 1e-9, n), rng.random(n) < 0.9
    for make, given in (
        (lambda: SpotSums((0.125, -3)), columns),
        (WavefrontSums, columns[1:]),
    ):
        whole = make().add(*given)
        for _ in range(20):
            again = divided(rng, make, given, n)
            assert again == whole and bytes(again) == bytes(whole)
    spot = SpotSums((0.125, -3)).add(*columns).spot()
    x, y, weight, _, passed = (column.tolist() for column in columns)
    of = [i for i in range(n) if passed[i]]
    # (The distances are doubles; all that follows is exact.)
    squares = sum(Fraction(weight[i]) * (Fraction(x[i] - 0.125) ** 2 + Fraction(y[i] + 3) ** 2) for i in of)
    mean = float(squares / sum(Fraction(weight[i]) for i in of))
    assert (spot.rays, spot.passed) == (n, len(of)) and math.isclose(spot.rms, math.sqrt(mean), rel_tol=1e-15)


def test_they_are_those_of_the_study(tree):
    """The sums of the rays of `ends`, about the reference of `spot`, make its row."""
    lens = triplet(tree)
    for field in (1, 2, 3):
        spot, ends = lens.spot(field, 1, rays=9), lens.ends(field, 1, pattern="hexapolar", rays=9)
        sums = SpotSums((spot.x[0], spot.y[0])).add(ends.x, ends.y, ends.weight, ends.xy_err, ends.fate == 1)
        found = sums.spot()
        for name in ("rays", "passed", "rms", "rms_x", "rms_y", "geometric"):
            assert getattr(found, name) == spot[name][0], (field, name)
        about = lens.spot(field, 1, rays=9, reference="centroid")
        assert abs(sums.spot(centroid=True).rms - about.rms[0]) <= found.error + 1e-15 * found.rms


def test_itself_and_nothing():
    a = SpotSums().add([1, 2], 0, passed=[True, False])
    assert (a.merge(a).spot().rays, a.spot().passed, a.spot().rms) == (4, 2, 1)
    assert math.isnan(SpotSums().spot().rms) and SpotSums().add([], []).spot().rays == 0
    assert SpotSums((-0.0, 0)) == SpotSums()
    assert math.isnan(SpotSums().add([1, np.nan], 0).spot().rms)


def test_what_is_refused():
    a, b = SpotSums(), WavefrontSums()
    with pytest.raises(TypeError, match="must be SpotSums, not WavefrontSums"):
        a.merge(b)
    with pytest.raises(ValueError, match="about another point"):
        a.merge(SpotSums((0, 1)))
    with pytest.raises(ValueError, match="of the other kind"):
        SpotSums.of_bytes(bytes(b))
    with pytest.raises(TypeError, match="passed"):
        a.add(1, 2, passed=1)
    with pytest.raises(TypeError, match="x: must be real"):
        a.add("1", 2)
    whole = bytes(a.add(1, 2))
    for i in range(0, len(whole), 7):
        for bad in (whole[:i], whole[:i] + bytes([whole[i] ^ 4]) + whole[i + 1 :]):
            with pytest.raises(ValueError, match="^of node 3: "):
                SpotSums.of_bytes(bad, "of node 3")


# -------------------------------------------------------------------------- parts

ASKED = {
    "spot": dict(pattern="random", rays=3000, seed=5, wavelength="all"),
    "fan": dict(field=2),
    "opd": dict(fields=[1, 3]),
    "wavefront": dict(pattern="sobol", rays=700),
    "zernike": dict(terms=11, pattern="cells", rays=70),
    "field": dict(steps=5),
    "map": dict(over="field", steps=4),
    "sweep": dict(to=40, steps=3, aim="real-stop", rays=3),
    "energy": {},
    "illumination": dict(pattern=np.array([[0.0, 0.5, 0.9], [0, 0.5, -0.9]])),
    "ends": dict(rays=4, proof="first"),
}


@pytest.mark.parametrize("name", ASKED)
def test_parts_make_one_run(tree, name):
    lens, draw = sagitta.Lens.read(tree / "examples" / "lenses" / "double_gauss.yaml"), random.Random(name)
    whole = getattr(lens, name)(**ASKED[name])
    for of in (1, 3, 7):
        parts = [pickle.loads(pickle.dumps(lens.part(name, k, of, threads=draw.choice([1, 2]), **ASKED[name])))
                 for k in range(1, of + 1)]
        answer = sagitta.join(draw.sample(parts, of))
        assert answer.rows.tobytes() == whole.rows.tobytes() and answer.units == whole.units
        assert (answer.fates, answer.notes, answer.legend) == (whole.fates, whole.notes, whole.legend)


def test_every_analysis_is_tried():
    from sagitta.study import analyses

    proofs = {name for name in (a.name.decode() for a in analyses()) if name.startswith("prove")}
    assert {a.name.decode() for a in analyses()} - proofs == set(ASKED)


@pytest.mark.parametrize("name", ["prove", "prove_between"])
def test_parts_of_proofs_make_one_run(tree, name):
    """Boxes of a field and a wavelength stay together, those between are divided."""
    lens = triplet(tree)
    whole = getattr(lens, name)(boxes=400)
    parts = [lens.part(name, k, 3, boxes=400) for k in (2, 3, 1)]
    assert sagitta.join(parts).rows.tobytes() == whole.rows.tobytes()


def test_as_the_command_has_it(tree, command):
    """A spot of parts in the digits that `sagitta spot` prints in full."""
    path = tree / "examples" / "lenses" / "cooke_triplet.yaml"
    said = subprocess.run([command, "spot", path, "--random", "3000", "--format", "csv", "--columns", "rms,rms_x,rms_y"],
                          capture_output=True, text=True, check=True)
    lens = triplet(tree)
    answer = sagitta.join(lens.part("spot", k, 4, pattern="random", rays=3000) for k in (2, 4, 1, 3))
    rows = [line.split(",") for line in said.stdout.splitlines() if line[:1].isdigit()]
    assert [[float(x) for x in row] for row in rows] == [[r["rms"], r["rms_x"], r["rms_y"]] for r in answer.rows]


def test_small(tree):
    """A part of sums does not grow with its rays."""
    lens = triplet(tree)
    sizes = [lens.part("spot", 1, 1, field=3, pattern="random", rays=rays).size for rays in (1000, 100000)]
    assert max(sizes) < 12000, sizes


def test_parts_that_do_not_belong(tree):
    lens = triplet(tree)
    one, two = (lens.part("spot", k, 2, rays=6) for k in (1, 2))

    def refused(words, *parts):
        with pytest.raises(ValueError, match=words):
            sagitta.join(parts)

    refused("there are no parts")
    refused("part 2 of 2 is missing", one)
    refused("part 1 of 2 is there twice", one, two, one)
    refused("part 2 of 2 was asked with another rays than part 1", one, lens.part("spot", 2, 2, rays=7))
    refused("another field", one, lens.part("spot", 2, 2, 1, rays=6))
    refused("is of spot in 2 parts, not of wavefront in 2", lens.part("wavefront", 2, 2, rays=6), one)
    refused("another lens", one, lens.scale(2).part("spot", 2, 2, rays=6))
    refused("part 2 of 2 is of spot in 2 parts, not of spot in 3", lens.part("spot", 1, 3, rays=6), two)
    other = pickle.loads(pickle.dumps(two))
    other.version = "sagitta 9.9.9"
    refused("part 2 of 2 is of sagitta", one, other)
    other = pickle.loads(pickle.dumps(two))
    other._packed = other._packed[:-9]
    refused("part 2 of 2 is damaged", one, other)
    written = two._written()
    with pytest.raises(ValueError, match="part 2 of 2 is longer"):
        sagitta.study.ask(lens, "spot", dict(rays=6), 0, 2, [one._written(), written + bytes(8)])
    for bad in (written[:-8], b"", bytes(len(written))):
        with pytest.raises(sagitta.LensError, match="shard 2 of 2 is not one of this study"):
            sagitta.study.ask(lens, "spot", dict(rays=6), 0, 2, [one._written(), bad])
    with pytest.raises(TypeError, match="must be parts, not int"):
        sagitta.join([3])
    for number, of in ((0, 2), (3, 2), (1, 0), (-1, 2), (1.5, 2)):
        with pytest.raises(ValueError, match="numbered from 1 to|must be a whole number"):
            lens.part("spot", number, of)
    with pytest.raises(ValueError, match="there is no analysis 'spott'; there are .*spot"):
        lens.part("spott", 1, 2)
