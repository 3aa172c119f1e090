"""10^4 rounds of making and dropping: the memory of the process stays, and so does the number of objects.

Under `valgrind --leak-check=full` the same rounds are run by python/tests/valgrind.py.
"""
import gc
import os

import numpy as np
import pytest
from rounds import ROUNDS, one_round


def resident():
    with open("/proc/self/statm") as f:
        return int(f.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="reads /proc")
@pytest.mark.skipif(
    "libasan" in os.environ.get("LD_PRELOAD", ""), reason="AddressSanitizer keeps what is freed"
)
@pytest.mark.parametrize("which", ROUNDS)
def test_rounds(which):
    for _ in range(500):  # what is kept once
        one_round(which)
    gc.collect()
    objects, before = len(gc.get_objects()), resident()
    for _ in range(10000):
        one_round(which)
    gc.collect()
    assert len(gc.get_objects()) - objects < 100
    # 10^4 leaks of an object of 100 bytes are a megabyte.
    assert resident() - before < 700e3, f"{(resident() - before) / 1e4:.0f} bytes a round"


def test_dropped_while_in_use():
    """What a result or a prepared call needs stays: the surface, its functions, the rays."""
    import sagitta

    call = sagitta.Function(lambda x, y, z: (z, 0, 0, 1)).prepare(np.zeros((3, 100)) - 1, (0, 0, 1))
    gc.collect()
    assert call() == 100
    lens = sagitta.Lens([sagitta.Element(sagitta.Function(lambda x, y, z: (z, 0, 0, 1)))])
    gc.collect()
    assert lens.trace(np.zeros((3, 100)) - 1, (0, 0, 1)).through.all()
    total = sagitta.Sum(terms=[sagitta.EvenAsphere(coefficients=[0, 1e-6])], semi_diameter=5)
    gc.collect()
    assert total.intersect((0, 1, -5), (0, 0, 1)).met
