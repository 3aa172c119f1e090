# SPDX-License-Identifier: MIT
"""What the tests share."""
import numpy as np


def same(a, b):
    """The same bits, a NaN for a NaN."""
    a, b = np.asarray(a), np.asarray(b)
    return a.shape == b.shape and bool(np.all((a == b) | ((a != a) & (b != b))))


def rays(rng, n, wide=3.0, steep=0.2, z=-9.0):
    """Rays along z from a plane."""
    o, d = rng.uniform(-wide, wide, (3, n)), rng.uniform(-steep, steep, (3, n))
    o[2], d[2] = z, 1
    return o, d
