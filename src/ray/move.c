/* move.c - the origin of a ray moved along it, exactly: a ray whose origin is doubles again (prove.c, FROM
 * AFAR). */
#include "move.h"

#include "../num/bits.h"
#include "../num/local.h"

/* o + t0 d, if that is a double. */
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
