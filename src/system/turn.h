// SPDX-License-Identifier: MIT
/* turn.h - an angle in degrees as a cosine and a sine, without the C library.
 *
 * Degrees are an exact unit.  Radians are not: pi/180 is no double.  So whole turns and quarters are taken
 * off in degrees, which is exact.  What is left is at most 45 degrees.  It is zero for every multiple of 90,
 * whose cosines and sines are then 0 and +-1 to the bit.  The rest is multiplied by pi/180 in twice the
 * precision (2^-101 relative), and num/elementary.h takes that product.  Then each cosine and sine is within
 * 0.65 ulp.  An angle that is not finite gives NaN.
 *
 * Test: tests/unit/test_pose.c. */
#ifndef SGT_SYSTEM_TURN_H
#define SGT_SYSTEM_TURN_H

#include "../num/elementary.h"

typedef struct unit_turn { double c, s; } unit_turn;

/* An angle that has the same turn and is below 2^53: an angle that is not is reduced modulo 360.  It is m 2^e
 * with m < 2^53, e > 0, and is reduced in integers, by e doublings.  Exact; NaN if it is not finite. */
static inline double without_turns(double degrees)
{
    if (fabs(degrees) < 0x1p53) return degrees;
    if (!(fabs(degrees) <= DBL_MAX)) return (double)NAN;
    int e;
    unsigned rest = (unsigned)((unsigned long long)(fabs(binary_mantissa(degrees, &e)) * 0x1p53) % 360);
    for (; e > 53; e--) rest = 2 * rest % 360;
    return copysign(rest, degrees);
}

/* Of an angle below 2^53; without a branch, for loops.
 *
 * It is 90 n + rest, |rest| <= 45.  90 n is exact, as it is even and at most 2^53 + 90.  degrees and 90 n are
 * multiples of an ulp of degrees, or of 1 if that is less.  Their difference is at most 46: fewer than 2^53
 * of those, so it is a double.  If rounding has made the quotient an integer and a half, n is one off, and is
 * corrected.  Modulo 4 it is `quarters`, from -2 to 2. */
SGT_INLINE unit_turn turn_near(double degrees)
{
    static const twofold radian = {0x1.1df46a2529d39p-6, 0x1.5c1d8becdd291p-62}; /* pi / 180 */
    const double whole = nearest_integer(degrees / 90), left = degrees - 90 * whole;
    const double one = fabs(left) > 45 ? copysign(1, left) : 0, n = whole + one, rest = left - 90 * one;
    const double quarters = n - 4 * nearest_integer(n / 4), size = fabs(quarters);
    const sine_cosine r = sine_cosine_of(twofold_scaled(radian, rest));
    const double sine = rest == 0 ? 0 : r.sine;
    const double c = size == 1 ? sine : r.cosine, s = size == 1 ? r.cosine : sine;
    const double c_sign = size == 2 ? -1 : quarters == 1 ? -1 : 1, s_sign = size == 2 ? -1 : quarters;
    return (unit_turn){c_sign * c, (s_sign == 0 ? 1 : s_sign) * s};
}

static inline unit_turn turn_of(double degrees)
{
    static const unit_turn quarter[4] = {{1, 0}, {-0.0, 1}, {-1, -0.0}, {0, -1}}; /* the same, at once */
    const double near = without_turns(degrees), whole = nearest_integer(near / 90);
    return near == 90 * whole ? quarter[(long long)whole & 3] : turn_near(near);
}

#endif
