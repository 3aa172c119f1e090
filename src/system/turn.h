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

/* Returns degrees - 90 n, at most 45 in magnitude, and sets *quarters to n modulo 4.  Exact.
 *
 *     |degrees| < 2^53     90 n is exact, as it is even and at most 2^53 + 90.  degrees and 90 n are
 *                          multiples of an ulp of degrees, or of 1 if that is less.  Their difference is at
 *                          most 46: fewer than 2^53 of those, so it is a double.  If rounding has made the
 *                          quotient an integer and a half, n is one off, and is corrected
 *     |degrees| >= 2^53    degrees is m 2^e with m < 2^53, e > 0.  It is first reduced modulo 360, in
 *                          integers, by e doublings */
static inline double rest_of_quarters(double degrees, int *quarters)
{
    *quarters = 0;
    if (!(fabs(degrees) <= DBL_MAX)) return (double)NAN;
    if (fabs(degrees) >= 0x1p53) {
        int e;
        unsigned rest = (unsigned)((unsigned long long)(fabs(binary_mantissa(degrees, &e)) * 0x1p53) % 360);
        for (; e > 53; e--) rest = 2 * rest % 360;
        degrees = copysign(rest, degrees);
    }
    double n = nearest_integer(degrees / 90), rest = degrees - 90 * n;
    if (fabs(rest) > 45) n += copysign(1, rest), rest -= copysign(90, rest);
    *quarters = (int)((long long)n & 3);
    return rest;
}

static inline unit_turn turn_of(double degrees)
{
    static const twofold radian = {0x1.1df46a2529d39p-6, 0x1.5c1d8becdd291p-62}; /* pi / 180 */
    int quarters;
    sine_cosine r = {0, 1};
    double rest = rest_of_quarters(degrees, &quarters);
    if (rest != 0) r = sine_cosine_of(twofold_scaled(radian, rest));
    switch (quarters) {
    case 1: return (unit_turn){-r.sine, r.cosine};
    case 2: return (unit_turn){-r.cosine, -r.sine};
    case 3: return (unit_turn){r.sine, -r.cosine};
    default: return (unit_turn){r.cosine, r.sine};
    }
}

#endif
