# SPDX-License-Identifier: MIT
"""Rounds of making and dropping: the memory of the process stays, and so does the number of objects.

What leaks grows in every stretch of rounds, but for one in which malloc had room left over.  What does not leak
moves, too, by what malloc keeps, but not each time.  So two stretches without growth pass, and four with it fail.

Under `valgrind --leak-check=full` the same rounds are run by python/tests/valgrind.py.
"""
import gc
import os

import numpy as np
import pytest
from rounds import ROUNDS, one_round

STRETCH = 500  # rounds
LEAST_LEAK = 40  # bytes a round: what malloc takes for 32


def resident():
    with open("/proc/self/statm") as f:
        return int(f.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="reads /proc")
@pytest.mark.skipif(
    "libasan" in os.environ.get("LD_PRELOAD", ""), reason="AddressSanitizer keeps what is freed"
)
@pytest.mark.parametrize("which", ROUNDS)
def test_rounds(which):
    for _ in range(250):  # what is kept once
        one_round(which)
    gc.collect()
    objects, still, grown = len(gc.get_objects()), 0, []
    while still < 2:
        before = resident()
        for _ in range(STRETCH):
            one_round(which)
        gc.collect()
        assert len(gc.get_objects()) - objects < 100
        bytes_a_round = (resident() - before) / STRETCH
        still += bytes_a_round < LEAST_LEAK
        grown += [bytes_a_round] if bytes_a_round >= LEAST_LEAK else []
        assert len(grown) < 4, f"bytes a round, in stretches of {STRETCH}: {grown}"


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
