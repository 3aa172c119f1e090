# SPDX-License-Identifier: MIT
"""The dispersion formulas of lens.h, evaluated at 50 digits.

By mpmath, or by the decimal module where that is not installed; both take the doubles as they are.
"""
import decimal

decimal.getcontext().prec = 50
try:
    import mpmath
    mpmath.mp.dps = 50
    N, root, ORACLE = mpmath.mpf, mpmath.sqrt, 'mpmath'
    def power(x, y): return x ** y
except ImportError:
    N, ORACLE = decimal.Decimal, 'decimal'
    def root(x): return x.sqrt()
    def power(x, y): return N(1) if y == 0 else x ** y


def exact(formula, coefficients, um):
    """The index by the formula as lens.h has it; None: n^2 is negative."""
    c, w = [N(x) for x in coefficients] + [N(0)] * 20, N(um)
    w2, count = w * w, len(coefficients)

    def pairs(first, end=None):
        return range(first, count if end is None else end, 2)

    def series(exponents):
        return sum(c[i] * power(w, N(e)) for i, e in enumerate(exponents))

    def sellmeier(first, end=None, square=False):
        return sum(c[i] * w2 / (w2 - (c[i + 1] ** 2 if square else c[i + 1])) for i in pairs(first, end) if c[i])

    if formula in (7, 103):
        l = 1 / (w2 - N(0.028))  # 0.028 as a double, as the program has it
        return c[0] + c[1] * l + c[2] * l ** 2 + c[3] * w2 + c[4] * w2 ** 2 + c[5] * w2 ** 3
    if formula == 5:
        return c[0] + sum(c[i] * power(w, c[i + 1]) for i in pairs(1))
    if formula == 6:
        return 1 + c[0] + sum(c[i] / (c[i + 1] - 1 / w2) for i in pairs(1))
    if formula == 105:
        return c[0] + c[1] / w + c[2] / power(w, N(3.5))
    extended = [0, 2, -2, -4, -6, -8, -10, -12]
    if formula == 1:
        square = 1 + c[0] + sellmeier(1, None, True)
    elif formula == 2:
        square = 1 + c[0] + sellmeier(1)
    elif formula == 3:
        square = c[0] + sum(c[i] * power(w, c[i + 1]) for i in pairs(1))
    elif formula == 4:
        square = c[0] + sum(c[i] * power(w, c[i + 1]) / (w2 - power(c[i + 2], c[i + 3])) for i in (1, 5) if c[i])
        square += sum(c[i] * power(w, c[i + 1]) for i in pairs(9))
    elif formula == 8:
        x = c[0] + sellmeier(1, 3) + c[3] * w2
        square = (1 + 2 * x) / (1 - x)
    elif formula == 9:
        square = c[0] + c[1] / (w2 - c[2]) + c[3] * (w - c[4]) / ((w - c[4]) ** 2 + c[5])
    elif formula in (102, 106, 111):
        square = 1 + sellmeier(0, {102: 6, 106: 8, 111: 10}[formula])
    elif formula == 104:
        square = 1 + c[0] + sellmeier(1, 3, True) + c[3] / (w2 - c[4] ** 2)
    elif formula == 107:
        square = c[0] + c[1] / (w2 - c[2]) - c[3] * w2
    elif formula in (108, 109):
        square = c[0] + (sellmeier(1, 3) - c[3] * w2 if formula == 108 else sellmeier(1, 5))
    else:
        square = series({101: extended[:6], 110: extended, 112: extended[:6] + [4, 6],
                         113: [0, 2, 4, -2, -4, -6, -8, -10, -12]}[formula])
    return root(square) if square > 0 else None
