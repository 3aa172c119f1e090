# SPDX-License-Identifier: MIT
"""Tolerances: the numbers of the command, bit for bit; points of the box; what is refused."""
import csv
import io
import subprocess

import numpy as np
import pytest

import sagitta


@pytest.fixture(scope="module")
def lens(tree):
    return sagitta.Lens.read(tree / "examples" / "lenses" / "triplet_tolerances.yaml")


@pytest.fixture(scope="module")
def few(lens):
    return lens.tolerance(pattern="hexapolar", rays=2)


def test_entries_are_a_box(few):
    assert len(few.entries) == 13
    first, focus = few.entries[0], few.entries[-1]
    assert (first.text, first.lower, first.upper, first.unit) == ("surface 1 radius", -0.02, 0.02, "mm")
    assert (focus.text, focus.compensator) == ("back focus", "paraxial")
    assert few.entries[6].distribution == "normal"


def test_a_point_and_its_lens(few):
    value = few.draw(7)
    figure, compensated = few.at(value)
    assert figure != few.nominal and compensated[-1] != 0 == value[-1]
    built = few.lens(compensated)
    spot = built.spot(pattern="hexapolar", rays=2).of(wavelength=0).rms
    assert abs(np.sqrt(np.mean(spot**2)) - figure) <= 1e-15
    assert built.tolerance(pattern="hexapolar", rays=2).nominal == figure


def test_trials(few, lens):
    whole = few.trials(40)
    assert whole.figure.shape == (40,) and whole.value.shape == (40, 13)
    parts = [few.trials(15), few.trials(25, first=15)]
    assert np.array_equal(np.concatenate([p.figure for p in parts]), whole.figure)
    assert np.array_equal(np.concatenate([p.value for p in parts]), whole.value)
    threads = lens.tolerance(pattern="hexapolar", rays=2, threads=3).trials(40)
    assert np.array_equal(threads.figure, whole.figure) and np.array_equal(threads.value, whole.value)
    assert not np.array_equal(few.trials(40, seed=2).figure, whole.figure)
    low, high = whole.quantile(0.5).lower, whole.quantile(0.5).upper
    assert low <= np.median(whole.figure) <= high
    assert whole.share(np.inf) == sagitta.share(40, 40)
    assert whole.figure[whole.worst] == whole.figure.max()


def test_sensitivity(few):
    rows, estimate = few.sensitivity()
    assert len(rows) == 12 and list(rows["worse"]) == sorted(rows["worse"], reverse=True)
    for row in rows[:3]:
        value = np.zeros(13)
        value[row["entry"]] = few.entries[row["entry"]].upper
        assert few.at(value)[0] == row["figure_upper"]
    squares = (rows["change_lower"] ** 2 + rows["change_upper"] ** 2) / 2
    assert estimate == pytest.approx(rows["figure_upper"][0] - rows["change_upper"][0] + np.sqrt(squares.sum()))


def test_worst_case(few):
    found = few.worst_case(boxes=3)
    assert found.verdict == "undecided" and found.boxes == 3 and found.cuts.sum() == 1 and not found.why
    assert few.at(found.value)[0] == found.seen < found.bound < 1.5 * found.seen
    assert few.trials(40).figure.max() <= found.seen
    assert few.worst_case(limit=0.99 * found.seen, boxes=1).verdict == "broken"
    assert few.worst_case(limit=1.5 * found.seen, boxes=1).verdict == "proven"


def test_as_the_command(few, tree, command):
    path = tree / "examples" / "lenses" / "triplet_tolerances.yaml"
    done = subprocess.run(
        [command, "tolerance", path, "--hexapolar", "2", "--trials", "5", "--format", "csv"],
        capture_output=True,
        check=True,
        text=True,
    )
    rows = list(csv.reader(io.StringIO(done.stdout)))[1:]
    trials = few.trials(5)
    assert [float(r[1]) for r in rows] == list(trials.figure)
    assert [[float(x) for x in r[2:]] for r in rows] == [list(v) for v in trials.value]


def test_what_is_refused(few, lens):
    with pytest.raises(ValueError, match="13 numbers"):
        few.at([0, 0])
    with pytest.raises(ValueError, match="figure"):
        lens.tolerance("mtf")
    with pytest.raises(ValueError, match="count"):
        few.trials(0)
    with pytest.raises(IndexError):
        lens.tolerance(field=4)
    with pytest.raises(sagitta.LensError, match="tolerances.1.: surface 1 index at -2"):
        lens.set("tolerances", [{"surface": 1, "index": 2}]).tolerance()
    assert lens.remove("tolerances").tolerance().entries == []
