# SPDX-License-Identifier: MIT
"""docs/python.md and the docstrings say what happens; the examples run."""
import doctest
import importlib
import importlib.util
import pathlib
import re
import subprocess
import sys

import numpy as np
import pytest

import sagitta


@pytest.mark.parametrize("name, least", [("python.md", 60), ("analysis.md", 2), ("optimise.md", 8)])
def test_the_page(tree, monkeypatch, name, least):
    page = tree / "docs" / name
    if not page.exists():
        pytest.skip("no docs beside the tests")
    monkeypatch.chdir(tree)
    blocks = re.findall(r"^```python\n(.*?)^```", page.read_text(), re.MULTILINE | re.DOTALL)
    test = doctest.DocTestParser().get_doctest("\n".join(blocks), {}, str(page), str(page), 0)
    assert len(test.examples) >= least
    said = []
    doctest.DocTestRunner().run(test, out=said.append)
    assert not said, "".join(said)


def test_dask(tree):
    pytest.importorskip("dask", reason="dask is not installed (on Debian: apt-get install python3-dask)")
    section = (tree / "docs" / "python.md").read_text().split("\n### Dask\n")[1].split("\n## ")[0]
    lines = re.findall(r"^    (.*)$", section, re.MULTILINE)
    assert len(lines) == 9
    lens = sagitta.Lens.read(tree / "examples" / "lenses" / "cooke_triplet.yaml")
    lines = [line.replace("10**9", "10**4").replace("10**7", "10**3").replace("10**6", "300") for line in lines]
    there = {"lens": lens, "surface": lens.surface(0)}
    exec("\n".join(lines), there)
    assert there["spot"] == lens.spot(pattern="random", rays=10**4)
    assert 0 < there["rms"] < 1 and 0 < there["mean"]


def test_the_pictures(tree):
    pytest.importorskip("matplotlib").use("svg")
    section = (tree / "docs" / "python.md").read_text().split("\n## Pictures\n")[1].split("\n## ")[0]
    lines = re.findall(r"^    (.*)$", section, re.MULTILINE)
    assert len(lines) == 3
    exec("\n".join(lines), {"lens": sagitta.Lens.read(tree / "examples" / "lenses" / "cooke_triplet.yaml")})


def test_the_tables(tree):
    for name in ("pandas", "xarray"):
        if importlib.util.find_spec(name) is None:
            pytest.skip(f"{name} is not installed (on Debian: apt-get install python3-{name})")
    section = (tree / "docs" / "python.md").read_text().split("\n## Results\n")[1].split("\n## ")[0]
    lines = re.findall(r"^    (.*)$", section, re.MULTILINE)
    assert len(lines) == 5
    lens = sagitta.Lens.read(tree / "examples" / "lenses" / "cooke_triplet.yaml")
    o = np.array([[0.0, 0, 0, 0], [0, 10, 20, 25], [-100] * 4])
    hits = sagitta.Conic(-200, -1).intersect(o, (0, 0, 1))
    there = {"hits": hits, "lens": lens, "o": o}
    exec("\n".join(lines), there)
    assert len(there["high"]) == 2 and there["height"].shape == (4,)
    assert np.array_equal(there["rms"][0], lens.spot().of(wavelength=0).rms)


def test_the_readme(tree, monkeypatch):
    """What README.md shows of Python, with a lens and rays for those that it does not have."""
    text = (tree / "README.md").read_text()
    (block,) = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    real = sagitta.Lens.read
    monkeypatch.setattr(
        sagitta.Lens, "read", lambda path: real(tree / "examples" / "lenses" / "cooke_triplet.yaml")
    )
    o = np.array([[0.0, 0], [0, 10], [-5, -5]])
    there = {"sagitta": sagitta, "o": o, "d": (0, 0, 1)}
    exec(block, there)
    assert there["hits"].met.all() and (0 < there["spot"].rms).all() and (there["spot"].rms < 1).all()


MODULES = ["__init__", "dask", "surface", "lens", "formula", "function", "optimise", "parts", "results", "study", "sums", "_arrays"]


@pytest.mark.parametrize("name", MODULES)
def test_docstrings(name):
    if name == "dask":
        pytest.importorskip("dask", reason="dask is not installed (on Debian: apt-get install python3-dask)")
    module = importlib.import_module("sagitta" if name == "__init__" else f"sagitta.{name}")
    said = []
    for test in doctest.DocTestFinder().find(module):
        doctest.DocTestRunner().run(test, out=said.append)
    assert not said, "".join(said)


def example(tree, name):
    path = tree / "examples" / "python" / name
    sys.path.insert(0, str(path.parent))
    try:
        return importlib.import_module(path.stem)
    finally:
        sys.path.remove(str(path.parent))


def test_the_design_of_a_singlet(tree, capsys):
    pytest.importorskip("scipy")
    lens, found = example(tree, "singlet.py").main()
    assert "rms 2.7" in capsys.readouterr().out and np.sqrt(np.mean(found.fun**2)) < 0.01
    assert abs(lens.first_order().efl - 100) < 1


def test_a_double_gauss_comes_back(tree, capsys):
    pytest.importorskip("scipy")
    assert example(tree, "optimise.py").main(2)
    rows = [line.split() for line in capsys.readouterr().out.splitlines() if line[:1] == " "]
    exact, differences = rows[:2]
    assert exact[1] == "exact" and int(differences[6]) > 5 * int(exact[6])  # traces


def test_a_day_with_a_lens(tree, capsys, tmp_path):
    pytest.importorskip("scipy")
    pytest.importorskip("matplotlib")
    module = example(tree, "designer.py")
    read, better, ninety = module.main(picture=tmp_path / "lens.png")
    assert better < 0.95 * read and better < ninety < 2 * better
    assert "90 % of 500 trials below" in capsys.readouterr().out
    assert (tmp_path / "lens.png").read_bytes()[:4] == b"\x89PNG"


def test_the_lens_class(tree, capsys):
    module = example(tree, "optic.py")
    module.main()
    assert "127 of 127 rays" in capsys.readouterr().out
    optic = module.cooke_triplet()

    def mean_square():
        optic.trace(2)
        last = optic.surfaces[-1]
        return ((last.x - last.x.mean()) ** 2 + (last.y - last.y.mean()) ** 2).mean()

    said, h, pair = optic.gradient(2, 0, "radius"), 1e-5, []
    for sign in (1, -1):
        optic.surfaces[0].radius = 22.01359 + sign * h
        pair.append(mean_square())
    # (The rays are launched anew, and the pupil moves a little with the radius.)
    assert abs((pair[0] - pair[1]) / (2 * h) - said) < 0.05 * abs(said)


def test_classes_are_as_the_table_has_them(tree):
    import os

    if "SAGITTA_PYTHON_LIBRARY" not in os.environ:
        pytest.skip("of an installed package")
    said = subprocess.run(
        [sys.executable, str(tree / "python" / "generate.py"), "--check"], capture_output=True, text=True
    )
    assert said.returncode == 0, said.stdout + said.stderr


def test_everything_named_is_there():
    assert all(hasattr(sagitta, name) for name in sagitta.__all__)
    assert sagitta.__version__ and (pathlib.Path(sagitta.__file__).parent / "py.typed").exists()
