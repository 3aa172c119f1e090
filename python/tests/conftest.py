# SPDX-License-Identifier: MIT
"""The package of this tree, with the library that SAGITTA_PYTHON_LIBRARY names; or, if that is not set, as
installed.  SAGITTA_TEST_SEED=N draws other random cases."""
import os
import pathlib
import sys

import pytest

here = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(here))
if "SAGITTA_PYTHON_LIBRARY" in os.environ:
    sys.path.insert(0, str(here.parent))


def seed():
    return int(os.environ.get("SAGITTA_TEST_SEED", "1"))


def pytest_report_header(config):
    return f"SAGITTA_TEST_SEED={seed()}"


@pytest.fixture
def rng():
    import numpy

    return numpy.random.default_rng(seed())


@pytest.fixture(scope="session")
def command():
    """The command `sagitta`; tests that compare with it are skipped where it is not built."""
    path = os.environ.get("SAGITTA_COMMAND", "")
    if not path or not pathlib.Path(path).exists():
        pytest.skip("the command is not built (SAGITTA_COMMAND)")
    return path


@pytest.fixture(scope="session")
def tree():
    """The folder of the project, with its lens files."""
    return here.parent.parent
