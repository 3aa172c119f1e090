# SPDX-License-Identifier: MIT
"""mypy --strict: the package, the examples, and what a program sees of the types (typed.py)."""
import pathlib
import re
import shutil
import subprocess

import pytest

TYPED = pathlib.Path(__file__).resolve().parent / "typed.py"
ARRAY = r"numpy\.ndarray\[Any, numpy\.dtype\[numpy\.%s\]\]"
SHORT = (
    (ARRAY % r"floating\[numpy\._typing\._64Bit\]", "array[float64]"),
    (ARRAY % r"signedinteger\[numpy\._typing\._(8|32)Bit\]", r"array[int\1]"),
    (ARRAY % r"unsignedinteger\[Any\]", "array[uint]"),
    (ARRAY % r"signedinteger\[Any\]", "array[intc]"),
    (r"\b(builtins|sagitta|results|surface|surfaces|lens|study|parts|sums|dask|_calls)\.", ""),
)


@pytest.fixture(scope="module")
def mypy(tree, tmp_path_factory):
    if not shutil.which("mypy"):
        pytest.skip("mypy is not installed (on Debian: apt-get install mypy)")
    if not (tree / "pyproject.toml").exists():
        pytest.skip("no pyproject.toml beside the tests")

    def run(*paths):
        cache = str(tmp_path_factory.getbasetemp() / "mypy")
        return subprocess.run(
            ["mypy", "--strict", "--config-file", "pyproject.toml", "--cache-dir", cache, *map(str, paths)],
            cwd=tree,
            env={"MYPYPATH": "python", "PATH": "/usr/local/bin:/usr/bin:/bin"},
            capture_output=True,
            text=True,
        )

    return run


def test_the_package_and_the_examples(mypy, tree):
    said = mypy("python/sagitta", *sorted((tree / "examples" / "python").glob("*.py")))
    assert said.returncode == 0, said.stdout + said.stderr


def test_what_a_program_sees(mypy):
    said, found = mypy(TYPED), {}
    for number, kind, words in re.findall(r"typed\.py:(\d+): (note|error): (.*)", said.stdout):
        reveals = re.fullmatch(r'Revealed type is "(.*)"', words)
        if reveals or kind == "error":
            short = reveals[1] if reveals else "error"
            for long, brief in SHORT:
                short = re.sub(long, brief, short)
            found[int(number)] = short
    lines = enumerate(TYPED.read_text().splitlines(), 1)
    wanted = {i: line.rsplit("  # ", 1)[1] for i, line in lines if "  # " in line}
    assert len(wanted) > 70 and found == wanted
