// SPDX-License-Identifier: MIT
/* disc.c - sectors of the unit disc. */
#include "disc.h"

#include <math.h>

static const sgt_interval PI = {0x1.921fb54442d18p+1, 0x1.921fb54442d19p+1};

/* A cover is wider than it has to be by that: so what rounds when it is made stays inside.  (Of rays that
 * start
 * within rounding of a point, beam.h takes care.) */
static const double DISC_PAD = 0x1p-44;

static bool is_whole(const sector *of) { return of->turn1 - of->turn0 == 1; }

double sgt_sector_area(const sector *of)
{
    return (of->r1 - of->r0) * (of->r1 + of->r0) * (of->turn1 - of->turn0);
}

bool sgt_sector_is_fit(const sector *of)
{
    return of->turn1 - of->turn0 <= 0.125 || (of->r0 == 0 && is_whole(of));
}

/* The cosine and sine of so many turns. */
static void turn_at(double turns, double *c, double *s)
{
    const double degrees = 360 * turns;
    sgt_turns(1, &degrees, c, s);
}

cover sgt_sector_cover(const sector *of)
{
    double c, s;
    if (is_whole(of)) return (cover){0, of->r1 + DISC_PAD, of->r1 + DISC_PAD};
    turn_at((of->turn1 - of->turn0) / 2, &c, &s);
    return (cover){(of->r0 * c + of->r1) / 2, (of->r1 - of->r0 * c) / 2 + DISC_PAD, of->r1 * s + DISC_PAD};
}

void sgt_sector_models(const sector *of, sgt_model *x, sgt_model *y)
{
    const cover k = sgt_sector_cover(of);
    double c = 1, s = 0;
    if (!is_whole(of)) turn_at((of->turn0 + of->turn1) / 2, &c, &s);
    *x = sgt_model_of(k.c * c), *y = sgt_model_of(k.c * s);
    x->by[0] = k.hs * c, x->by[1] = -k.ht * s;
    y->by[0] = k.hs * s, y->by[1] = k.ht * c;
}

/* x^n - y^n of two doubles, x >= y >= 0. */
static sgt_interval powers_between(double x, double y, int n)
{
    return sgt_interval_difference(sgt_interval_power(sgt_interval_of(x), n),
                                   sgt_interval_power(sgt_interval_of(y), n));
}

static sgt_interval times(sgt_interval x, sgt_interval y) { return sgt_interval_product(x, y); }

sgt_interval sgt_sector_integral(const sector *of, const sgt_model *f)
{
    const cover k = sgt_sector_cover(of);
    const sgt_interval width = sgt_interval_of(of->turn1 - of->turn0), w = times(PI, width);
            /* w = pi width */
    const sgt_interval sin_w = is_whole(of) ? sgt_interval_of(0) : sgt_interval_sine(w);
    const sgt_interval cos_w = is_whole(of) ? sgt_interval_of(-1) : sgt_interval_cosine(w);
    const sgt_interval bow = sgt_interval_quotient(times(sin_w, cos_w), PI), c = sgt_interval_of(k.c);
    const sgt_interval hs = sgt_interval_of(k.hs), ht = sgt_interval_of(k.ht);
    const sgt_interval r3 = sgt_interval_quotient(powers_between(of->r1, of->r0, 3), sgt_interval_of(3));
    const sgt_interval r4 = sgt_interval_scaled(powers_between(of->r1, of->r0, 4), 0.25);
    const sgt_interval one = sgt_interval_of(sgt_sector_area(of));
    const sgt_interval along = times(r3, sgt_interval_quotient(sgt_interval_scaled(sin_w, 2), PI));
    const sgt_interval along2 = times(r4, sgt_interval_sum(width, bow));
    const sgt_interval across2 = times(r4, sgt_interval_difference(width, bow));
    /* (r cos - c)^2 = (r cos)^2 - c (2 r cos - c).  No mean of a square is below 0 or above 1 */
    const sgt_interval twice = sgt_interval_difference(sgt_interval_scaled(along, 2), times(c, one));
    const sgt_interval square = {0, one.hi}, all = {-one.hi, one.hi};
    sgt_interval s = sgt_interval_quotient(sgt_interval_difference(along, times(c, one)), hs);
    sgt_interval ss = sgt_interval_quotient(sgt_interval_difference(along2, times(c, twice)),
                                            sgt_interval_square(hs));
    sgt_interval tt = sgt_interval_quotient(across2, sgt_interval_square(ht));
    s = sgt_interval_intersection(s, all);
    ss = sgt_interval_intersection(ss, square), tt = sgt_interval_intersection(tt, square);
    const double rest = sgt_product_above(f->rest, one.hi);
    sgt_interval sum = times(sgt_interval_of(f->c), one);
    sum = sgt_interval_sum(sum, times(sgt_interval_of(f->by[0]), s));
    sum = sgt_interval_sum(sum, times(sgt_interval_of(f->pair[SGT_MODEL_PAIR(0, 0)]), ss));
    sum = sgt_interval_sum(sum, times(sgt_interval_of(f->pair[SGT_MODEL_PAIR(1, 1)]), tt));
    return sgt_interval_sum(sum, (sgt_interval){-rest, rest});
}

void sgt_sector_halve(const sector *of, bool in_angle, sector half[2])
{
    half[0] = half[1] = *of;
    if (in_angle) half[0].turn1 = half[1].turn0 = (of->turn0 + of->turn1) / 2;
    else half[0].r1 = half[1].r0 = (of->r0 + of->r1) / 2;
}

bool sgt_sector_can_halve(const sector *of, bool in_angle)
{
    const double least = 1.0 / (1 << DISC_DEEPEST);
    if (in_angle) return of->turn1 - of->turn0 > least && !(of->r0 == 0 && is_whole(of));
    return of->r1 - of->r0 > least;
}

void sgt_sector_point(const sector *of, double p, double q, double *x, double *y)
{
    const double degrees = 360 * (of->turn0 + q * (of->turn1 - of->turn0));
    const double r = is_whole(of) && p == 0.5 ? 0 : of->r0 + p * (of->r1 - of->r0);
    double c, s;
    sgt_turns(1, &degrees, &c, &s);
    *x = r * c, *y = r * s;
}
