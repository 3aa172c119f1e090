/* pose.c - the frame of an element: an origin, and axes turned by Rz Ry Rx.
 *
 * A point q of the local frame is p = origin + R q in the global one, with R = Rz Ry Rx.  The element is
 * turned about the global x first, then about the global y, then about the global z, each right-handed.
 * With c, s the cosine and sine of each angle, the columns of R are
 *
 *     ex = ( cz cy,            sz cy,            -sy   )
 *     ey = ( cz sy sx - sz cx, sz sy sx + cz cx, cy sx )
 *     ez = ( cz sy cx + sz sx, sz sy cx - cz sx, cy cx )
 *
 * They are the local axes seen from outside (Goldstein, Poole & Safko 2002, Classical Mechanics, appendix
 * A, the xyz convention, which lists the rows of the inverse).
 *
 * ROUNDING.  Degrees are an exact unit.  Radians are not: pi/180 is no double.  So whole turns and
 * quarters are taken off in degrees, which is exact.  What is left is at most 45 degrees.  It is zero for
 * every multiple of 90, whose cosines and sines are then 0 and +-1 to the bit.  The rest is multiplied by
 * pi/180 in twice the precision (2^-101 relative), and num/elementary.h takes that product.  Then
 *
 *     each cosine and sine       is within 0.65 ulp
 *     each component of an axis  is within 3 * 2^-53: two products and a sum of numbers of at most 1
 *     the axes                   are of unit length and at right angles within 2^-50: each dot product of two
 *                                axes has three such errors
 *
 * An angle that is not finite gives NaN axes.  sgt_trace answers these with SGT_INVALID. */
#include <sagitta/system.h>

#include "../num/elementary.h"

typedef struct pose_turn { double c, s; } pose_turn;

/* Returns degrees - 90 n, at most 45 in magnitude, and sets *quarters to n modulo 4.  Exact.
 *
 *     |degrees| < 2^53     90 n is exact, as it is even and at most 2^53 + 90.  degrees and 90 n are
 *                          multiples of an ulp of degrees, or of 1 if that is less.  Their difference is at
 *                          most 46: fewer than 2^53 of those, so it is a double.  If rounding has made the
 *                          quotient an integer and a half, n is one off, and is corrected
 *     |degrees| >= 2^53    degrees is m 2^e with m < 2^53, e > 0.  It is first reduced modulo 360, in
 *                          integers, by e doublings */
static double rest_of_quarters(double degrees, int *quarters)
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

static pose_turn turn_of(double degrees)
{
    static const twofold radian = {0x1.1df46a2529d39p-6, 0x1.5c1d8becdd291p-62}; /* pi / 180 */
    int quarters;
    sine_cosine r = sine_cosine_of(twofold_scaled(radian, rest_of_quarters(degrees, &quarters)));
    switch (quarters) {
    case 1: return (pose_turn){-r.sine, r.cosine};
    case 2: return (pose_turn){-r.cosine, -r.sine};
    case 3: return (pose_turn){r.sine, -r.cosine};
    default: return (pose_turn){r.cosine, r.sine};
    }
}

/* 0.0 + x makes a zero of either sign +0, so that equal tilts print equal. */
sgt_pose sgt_pose_tilted(sgt_vec3 origin, sgt_vec3 degrees)
{
    pose_turn x = turn_of(degrees.x), y = turn_of(degrees.y), z = turn_of(degrees.z);
    return (sgt_pose){
        .origin = origin, .ex = {0.0 + z.c * y.c, 0.0 + z.s * y.c, 0.0 - y.s},
        .ey = {0.0 + (z.c * y.s * x.s - z.s * x.c), 0.0 + (z.s * y.s * x.s + z.c * x.c), 0.0 + y.c * x.s},
        .ez = {0.0 + (z.c * y.s * x.c + z.s * x.s), 0.0 + (z.s * y.s * x.c - z.c * x.s), 0.0 + y.c * x.c},
    };
}
