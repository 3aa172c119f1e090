#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Rounds of making and dropping under valgrind: no error in the library, and no block that it has lost.

    python3 python/tests/valgrind.py VALGRIND [ROUNDS]

Python's own allocator is told to be malloc, so that valgrind sees each block.  Of what it reports only that
counts which has libsagitta_python.so among its callers: numpy and Python keep things to their end.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

here = pathlib.Path(__file__).resolve().parent
WORK = """
import sys
sys.path[:0] = [{tests!r}, {package!r}]
import gc
from rounds import ROUNDS, one_round
for i in range({rounds}):
    for which in ROUNDS:
        one_round(which)
gc.collect()
"""


def main(valgrind, rounds="30"):
    work = WORK.format(tests=str(here), package=str(here.parent), rounds=int(rounds))
    with tempfile.TemporaryDirectory() as folder:
        log = pathlib.Path(folder) / "log"
        done = subprocess.run(
            [valgrind, "--leak-check=full", "--show-leak-kinds=definite,indirect", "--num-callers=20",
             "--error-limit=no", f"--log-file={log}", sys.executable, "-c", work],
            env={**os.environ, "PYTHONMALLOC": "malloc"},
        )
        text = log.read_text()
    reports = [r for r in re.split(r"==\d+== \n", text) if "libsagitta_python.so" in r]
    print(f"{rounds} rounds; {len(reports)} reports about the library")
    print(*reports, sep="\n")
    return 1 if done.returncode or reports or "HEAP SUMMARY" not in text else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
