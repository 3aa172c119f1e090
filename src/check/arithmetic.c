// SPDX-License-Identifier: MIT
/* arithmetic.c - is the arithmetic of this thread what the bounds were made for?  (sgt_arithmetic)
 *
 * Control words are different on each processor, so the arithmetic itself is asked, by operations whose exact
 * results are known.  `volatile` keeps the compiler from doing them beforehand.
 *
 * FLUSHES: half the least normal number is denormal, and exact.
 * DENORMALS ARE ZERO: the least denormal number, times 2^52, is normal, and exact.
 * NOT TO NEAREST: 1 + 0.6 ulp is 1 + ulp to nearest only if it is not cut, 1 + 0.4 ulp is 1 only if it is not
 * raised, and the same below zero tells upward from downward. */
#include <sagitta/sagitta.h>

#include <float.h>

int sgt_arithmetic(void)
{
    volatile double least = DBL_MIN, denormal = DBL_TRUE_MIN, one = 1, ulp = DBL_EPSILON, half = 0.5;
    int bad = 0;
    if (least * half == 0) bad |= SGT_FLUSHES;
    if (denormal * (1 / DBL_EPSILON) == 0) bad |= SGT_DENORMALS_ARE_ZERO;
    if (one + ulp * 0.4 != 1 || one + ulp * 0.6 == 1 || -one - ulp * 0.6 == -1 || -one - ulp * 0.4 != -1)
        bad |= SGT_NOT_TO_NEAREST;
    return bad;
}

#define FLUSHES "results below 2.2e-308 become zero (flush-to-zero)"
#define DENORMALS "numbers below 2.2e-308 are read as zero (denormals-are-zero)"
#define ROUNDING "rounding is not to nearest"

const char *sgt_arithmetic_text(int arithmetic)
{
    static const char *const texts[] = {
        "each operation is rounded to nearest",
        FLUSHES,
        DENORMALS,
        FLUSHES ", " DENORMALS,
        ROUNDING,
        FLUSHES ", " ROUNDING,
        DENORMALS ", " ROUNDING,
        FLUSHES ", " DENORMALS ", " ROUNDING,
    };
    return texts[arithmetic & (SGT_FLUSHES | SGT_DENORMALS_ARE_ZERO | SGT_NOT_TO_NEAREST)];
}
