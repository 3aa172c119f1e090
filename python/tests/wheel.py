#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""docs/python.md's installation as it is told there: a wheel by pip without the network, in an environment of
its own.

    python3 python/tests/wheel.py SOURCE

Then the page's examples and a lens with a glass of the table that ships are run with what was installed.  The
packages of Debian that the page names have to be among those that tests/run.sh installs.  Where pip, venv or
meson-python are missing it is skipped.
"""
import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
CHECK = """
import sagitta, sys
assert {environment!r} in sagitta.__file__, sagitta.__file__
lens = sagitta.Lens([sagitta.Element(sagitta.Sphere(radius=50), glass="SCHOTT N-BK7")], wavelengths=[0.5876])
assert abs(lens.sensitivity((0, 0, -5), (0, 0, 1), "n").fate[0]) == 1
print("sagitta", sagitta.__version__, "from", sagitta.__file__)
"""


def told(source):
    """The lines of the page's section Install that are to be typed."""
    page = (pathlib.Path(source) / "docs" / "python.md").read_text()
    section = page.split("\n## Install\n")[1].split("\n## ")[0]
    packages, *commands = re.findall(r"^    (.*)$", section, re.MULTILINE)
    listed = (pathlib.Path(source) / "tests" / "run.sh").read_text().replace("\\", " ").split()
    absent = set(packages.split()[2:]) - set(listed)
    if not packages.startswith("apt-get install ") or len(commands) != 2:
        sys.exit(f"docs/python.md tells another installation than this test knows: {packages}, {commands}")
    if absent:
        sys.exit(f"tests/run.sh does not install {', '.join(sorted(absent))}, as docs/python.md does")
    return commands


def main(source):
    commands = told(source)
    missing = [m for m in ("mesonpy", "venv", "pip", "ensurepip", "numpy") if not importlib.util.find_spec(m)]
    if missing or not shutil.which("git") or not (pathlib.Path(source) / ".git").exists():
        print("skipped: no " + ", ".join(missing or ["checkout"]))
        return SKIPPED
    env = {k: v for k, v in os.environ.items() if k not in ("SAGITTA_PYTHON_LIBRARY", "PYTHONPATH")}
    # What is tried is where everything goes: one set of instructions, without optimisation, is compiled in a
    # tenth of the time.
    env.update(PIP_NO_INDEX="1", PIP_DISABLE_PIP_VERSION_CHECK="1", CFLAGS=env.get("CFLAGS", "") + " -O0")

    def run(*words, **more):
        subprocess.run([str(w) for w in words], check=True, env=env, **more)

    with tempfile.TemporaryDirectory() as folder:
        tree, environment = pathlib.Path(folder) / "tree", pathlib.Path(folder) / "environment"
        # What is to be committed, and not what stands about: as in a fresh clone.
        files = subprocess.run(["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=source, check=True,
                               capture_output=True).stdout.decode().split("\0")
        for name in filter(None, files):
            if (pathlib.Path(source) / name).is_file():
                (tree / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(pathlib.Path(source) / name, tree / name)
        python = environment / "bin" / "python3"
        for command in commands:
            words = command.replace("~/sagitta", str(environment)).split()
            if "install" in words:
                words += ["--config-settings=setup-args=-Dclones=none"]
            run(*([sys.executable, *words[1:]] if words[0] == "python3" else words), cwd=tree)
        run(python, "-c", CHECK.format(environment=str(environment)), cwd=folder)
        tests = [tree / "python" / "tests" / f"test_{name}.py" for name in ("docs", "layouts")]
        run(python, "-m", "pytest", "-q", "-p", "no:cacheprovider", *tests, cwd=tree)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
