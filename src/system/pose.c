// SPDX-License-Identifier: MIT
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
 * ROUNDING.  turn.h takes an angle to its cosine and sine within 0.65 ulp, without the C library.  Then
 *
 *     each component of an axis  is within 3 * 2^-53: two products and a sum of numbers of at most 1
 *     the axes                   are of unit length and at right angles within 2^-50: each dot product of two
 *                                axes has three such errors
 *
 * An angle that is not finite gives NaN axes.  sgt_trace answers these with SGT_INVALID. */
#include <sagitta/system.h>

#include "turn.h"
#include "../num/lanes.h"

/* 0.0 + x makes a zero of either sign +0, so that equal tilts print equal. */
sgt_pose sgt_pose_tilted(sgt_vec3 origin, sgt_vec3 degrees)
{
    unit_turn x = turn_of(degrees.x), y = turn_of(degrees.y), z = turn_of(degrees.z);
    return (sgt_pose){
        .origin = origin, .ex = {0.0 + z.c * y.c, 0.0 + z.s * y.c, 0.0 - y.s},
        .ey = {0.0 + (z.c * y.s * x.s - z.s * x.c), 0.0 + (z.s * y.s * x.s + z.c * x.c), 0.0 + y.c * x.s},
        .ez = {0.0 + (z.c * y.s * x.c + z.s * x.s), 0.0 + (z.s * y.s * x.c - z.c * x.s), 0.0 + y.c * x.c},
    };
}

SGT_KERNEL
static void turns_near(size_t n, const double *restrict degrees, double *restrict cosine,
                       double *restrict sine)
{
    LANES for (size_t i = 0; i < n; i++)
    {
        const unit_turn t = turn_near(degrees[i]);
        cosine[i] = 0.0 + t.c, sine[i] = 0.0 + t.s;
    }
}

void sgt_turns(size_t n, const double degrees[], double cosine[], double sine[])
{
    turns_near(n, degrees, cosine, sine);
    for (size_t i = 0; i < n; i++) {
        if (fabs(degrees[i]) < 0x1p53) continue;
        const unit_turn t = turn_of(degrees[i]);
        cosine[i] = 0.0 + t.c, sine[i] = 0.0 + t.s;
    }
}
