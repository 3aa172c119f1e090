// SPDX-License-Identifier: MIT
/* chord.c - where on a ray a sag can be met.
 *
 * The domain of a sag is a cylinder about its axis, r <= rim or r <= the equator of the conic base.  A ray
 * cuts it in an interval.  Its middle is the point of the ray nearest the axis.  The half-chord is
 * sqrt(radius^2 - distance^2) over the sine of the angle to the axis.
 *
 * The chord is made longer by 2^-40 of itself and 2^-46 of where it is.  That is far more than rounding, so
 * no root is cut off.  Whether a root lies in the domain is decided elsewhere. */
#include "sag.h"

stretch sgt_chord(const sgt_ray *ray, double radius2)
{
    stretch all = {-HUGE_VAL, HUGE_VAL}, none = {1, -1};
    if (!(radius2 < HUGE_VAL)) return all;
    double scale = scale_of(ray->d), l = ray->d.x * scale, m = ray->d.y * scale, a = l * l + m * m;
    radius2 *= 1 + 0x1p-43;
    if (ray->d.x == 0 && ray->d.y == 0)
        return ray->o.x * ray->o.x + ray->o.y * ray->o.y <= radius2 * (1 + 0x1p-40) ? all : none;
    if (!(a > TINY)) return all; /* underflow */
    /* Found twice from the point nearest the axis.  The second time, rounding is of the size of the chord. */
    local q = local_at(ray, -(ray->o.x * l + ray->o.y * m) / a, 0);
    double middle = -(q.x * l + q.y * m) / a, cross = q.x * m - q.y * l, near2 = cross * cross / a;
    double half2 = (radius2 * (1 + 0x1p-40) - near2 * (1 - 0x1p-40)) / a;
    if (half2 < 0) return none;
    double half = sqrt(half2) * (1 + 0x1p-40) + 0x1p-46 * (fabs(middle) + fabs(q.t0));
    middle += q.t0;
    if (!isfinite(middle) || !isfinite(half)) return all;
    return (stretch){end_below(middle - half, scale), end_above(middle + half, scale)};
}

sgt_span sgt_sag_span(double c, double k, double semi_diameter, const sgt_ray *ray, bool bare)
{
    stretch chord = sgt_chord(ray, domain2_of(c, k, semi_diameter));
    sgt_span span = {.lo = chord.lo, .hi = chord.hi, .seed = NAN};
    local q = local_at_vertex_plane(ray);
    double a = q.l * q.l + q.m * q.m, k1 = 1 + k;
    double A = c * (a + k1 * q.n * q.n), B = q.n - c * (q.x * q.l + q.y * q.m),
           C = c * (q.x * q.x + q.y * q.y), D = B * B - A * C;
    double b = B + copysign(sqrt(D), B), near = C / b, far = b / A, v = 1 - k1 * c * near * q.n,
           v_far = 1 - k1 * c * far * q.n;
    double t = (q.t0 + (q.t0_lo + near)) * q.scale;
    double t_far = (q.t0 + (q.t0_lo + far)) * q.scale;
    if (v > 0 || !bare) span.seed = t;
    else if (v_far > 0) span.seed = t_far;
    if (!(span.seed >= span.lo && span.seed <= span.hi)) span.seed = NAN;
    /* If the signs of v at the two roots are opposite by a margin, certainly just one of them is on the
     * sheet. */
    double margin = 0x1p-30 * (1 + fabs(k1 * c * q.n) * (fabs(near) + fabs(far)));
    bool well = D > 0x1p-20 * (B * B + fabs(A * C));
    span.single = bare && (c == 0 ? q.n != 0
                                  : well && (A == 0 || (v > margin && v_far < -margin) ||
                                             (v < -margin && v_far > margin)));
    return span;
}
