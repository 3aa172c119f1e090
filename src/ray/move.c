// SPDX-License-Identifier: MIT
/* move.c - the origin of a ray moved along it, exactly.
 *
 * From afar an ulp of t is long.  So a search near the surface wants a ray that begins there (proof.c,
 * FROM AFAR).  The new origin has to be doubles; if it were rounded, the line would be another one.  So t0
 * is the multiple of the least power of two, nearest to `about`, at which all three coordinates are
 * doubles.  If coordinates begin much smaller than they end, there may be none.
 *
 * The unit starts at 2^-52 of the power of two in |about| and ends at |about| / 8.  |about| has to be in
 * (2^-900, 2^900). */
#include "move.h"

#include "../num/bits.h"
#include "../num/local.h"

/* Is o + t0 d a double?  *at is set to it.  The product must be above 2^-960, so that its lower part is
 * exact. */
static bool is_double(double o, double d, double t0, double *at)
{
    twofold p = two_product(t0, d), s = two_sum(o, p.hi), e = two_sum(s.lo, p.lo), f = two_sum(s.hi, e.hi);
    *at = d == 0 ? o : f.hi;
    return d == 0 || (e.lo == 0 && f.lo == 0 && fabs(p.hi) > 0x1p-960 && fabs(f.hi) < HUGE_VAL);
}

double sgt_move_exactly(const sgt_ray *ray, double about, sgt_ray *moved)
{
    *moved = *ray;
    if (!(fabs(about) > 0x1p-900 && fabs(about) < 0x1p900)) return 0;
    for (double unit = 0x1p-52 * inverse_of_scale((sgt_vec3){about, 0, 0}); unit <= 0.125 * fabs(about);
         unit *= 2) {
        double t0 = nearest_integer(about / unit) * unit;
        if (is_double(ray->o.x, ray->d.x, t0, &moved->o.x) &&
            is_double(ray->o.y, ray->d.y, t0, &moved->o.y) && is_double(ray->o.z, ray->d.z, t0, &moved->o.z))
            return t0;
    }
    return 0;
}
