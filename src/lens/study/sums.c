// SPDX-License-Identifier: MIT
/* sums.c - sums of rays from many places: those of spot.c and wavefront.c, which have no order.
 *
 * ABOUT THE CENTROID.  From the sums of w, w u, w u^2 of the distances u from a given point the mean square
 * about the mean is as in wavefront.c; of an rms less than 2^-49 of the largest distance is lost. */
#include "sums.h"

#include "../optics/launch.h"

#include <sagitta/pair.h>

sgt_sums *sgt_sums_new(sgt_sums_kind kind, const sgt_vec2 *about, const sgt_allocator *allocator)
{
    const sgt_launcher none = {.allocator = sgt_allocator_or(allocator)};
    sgt_sums *s = sgt_launch_take(&none, 1, sizeof *s);
    if (!s) return NULL;
    memset(s, 0, sizeof *s);
    s->allocator = none.allocator, s->kind = kind;
    if (about && kind == SGT_SUMS_SPOT) s->about = *about;
    return s;
}

void sgt_sums_free(sgt_sums *s)
{
    if (!s) return;
    const sgt_launcher was = {.allocator = s->allocator};
    sgt_launch_forget(&was, s);
}

void sgt_sums_add(sgt_sums *s, size_t count, const sgt_ray_end end[], const double opd[],
                  const double error[])
{
    if (s->kind == SGT_SUMS_WAVEFRONT) {
        sgt_wavefront_add(&s->front, count, end, opd, error);
    } else {
        sgt_middle_add(&s->middle, s->about, count, end);
        sgt_spread_add(&s->spread, s->about, count, end);
    }
}

bool sgt_sums_merge(sgt_sums *s, const sgt_sums *more)
{
    if (s->kind != more->kind || memcmp(&s->about, &more->about, sizeof s->about) != 0) return false;
    sgt_middle_merge(&s->middle, &more->middle), sgt_spread_merge(&s->spread, &more->spread);
    sgt_wavefront_merge(&s->front, &more->front);
    return true;
}

/* The mean square about the mean, of one coordinate. */
static double about_mean(const exact *weights, const exact *first, const exact *square, double *mean)
{
    sgt_pair w, one, two;
    w.hi = sgt_exact_value(weights, &w.lo), one.hi = sgt_exact_value(first, &one.lo);
    two.hi = sgt_exact_value(square, &two.lo);
    const sgt_pair m = sgt_pair_quotient(one, w);
    *mean = m.hi;
    return sgt_not_below_0(sgt_pair_quotient(sgt_pair_difference(two, sgt_pair_product(m, one)), w).hi);
}

sgt_spot sgt_sums_spot(const sgt_sums *s, bool centroid)
{
    const double none = (double)NAN;
    const sgt_spot empty = {.reference = {none, none}, .rms = none, .rms_x = none, .rms_y = none,
                            .geometric = none, .error = none};
    if (s->kind != SGT_SUMS_SPOT) return empty;
    const spot_spread spread = sgt_spread_rounded(&s->spread);
    sgt_spot out = sgt_spread_of(&spread, s->about);
    if (!centroid || isnan(out.rms)) return out;
    double x, y;
    const double xx = about_mean(&s->spread.w, &s->middle.x, &s->spread.x2, &x);
    const double yy = about_mean(&s->spread.w, &s->middle.y, &s->spread.y2, &y);
    out.rms_x = sqrt(xx), out.rms_y = sqrt(yy), out.rms = sqrt(xx + yy);
    out.reference = (sgt_vec2){s->about.x + x, s->about.y + y};
    out.error += 0x1p-48 * s->spread.far, out.geometric = none;
    return out;
}

sgt_wavefront sgt_sums_wavefront(const sgt_sums *s)
{
    static const sgt_wavefront_sum nothing;
    return sgt_wavefront_sum_of(s->kind == SGT_SUMS_WAVEFRONT ? &s->front : &nothing);
}

size_t sgt_sums_exact(sgt_sums *s, exact *out[SUMS_MOST_EXACT])
{
    exact *const spot[] = {&s->middle.w, &s->middle.x,  &s->middle.y,  &s->middle.off,
                           &s->spread.w, &s->spread.x2, &s->spread.y2, &s->spread.off};
    exact *const front[] = {&s->front.w, &s->front.first, &s->front.square};
    const bool waves = s->kind == SGT_SUMS_WAVEFRONT;
    const size_t count = waves ? sizeof front / sizeof *front : sizeof spot / sizeof *spot;
    memcpy(out, waves ? front : spot, count * sizeof *out);
    return count;
}
