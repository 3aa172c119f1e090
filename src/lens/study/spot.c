/* spot.c - the spot of rays at the last element.
 *
 * ERROR.  An rms is a norm of the distances, each weighted: if each point is off by p_err, it is off by
 * the same norm of the p_err at most (the triangle inequality).  So is the centroid, by their mean, and
 * hence the rms about it by no more.  Sums of n terms are off by n roundings. */
#include "../optics/launch.h"

static bool counts(const sgt_ray_end *e) { return e->fate == SGT_PASSED; }

/* The weighted means over the rays that passed. */
static bool centroid_of(size_t groups, const sgt_ends group[], sgt_vec2 *at)
{
    double sum = 0, x = 0, y = 0;
    for (size_t g = 0; g < groups; g++)
        for (size_t i = 0; i < group[g].count; i++) {
            const sgt_ray_end *e = &group[g].end[i];
            if (!counts(e)) continue;
            double w = e->weight * group[g].weight;
            sum += w, x += w * e->p.x, y += w * e->p.y;
        }
    *at = (sgt_vec2){x / sum, y / sum};
    return sum > 0;
}

sgt_spot sgt_spot_of(size_t groups, const sgt_ends group[], const sgt_vec2 *reference)
{
    const double none = (double)NAN;
    sgt_spot s = {.reference = {none, none}, .rms = none, .rms_x = none, .rms_y = none, .geometric = none,
                  .error = none};
    double sum = 0, x2 = 0, y2 = 0, off = 0, far = 0;
    sgt_vec2 about;
    for (size_t g = 0; g < groups; g++) {
        s.rays += group[g].count;
        for (size_t i = 0; i < group[g].count; i++) s.passed += counts(&group[g].end[i]);
    }
    bool any = centroid_of(groups, group, &about);
    if (reference) about = *reference;
    for (size_t g = 0; g < groups && any; g++)
        for (size_t i = 0; i < group[g].count; i++) {
            const sgt_ray_end *e = &group[g].end[i];
            if (!counts(e)) continue;
            double w = e->weight * group[g].weight, x = e->p.x - about.x, y = e->p.y - about.y;
            sum += w, x2 += w * x * x, y2 += w * y * y, off += w * e->p_err * e->p_err;
            far = fmax(far, hypot(x, y));
        }
    if (!any) return s;
    s.reference = about, s.geometric = isnan(about.x + about.y) ? none : far;
    s.rms_x = sqrt(x2 / sum), s.rms_y = sqrt(y2 / sum), s.rms = sqrt((x2 + y2) / sum);
    s.error = sqrt(off / sum) + (double)s.passed * 0x1p-52 * s.rms;
    return s;
}

double sgt_airy_radius(double wavelength, double working_f_number)
{
    return 1.2196698912665045 * wavelength * working_f_number; /* the first zero of J1, over pi */
}
