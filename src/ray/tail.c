// SPDX-License-Identifier: MIT
/* tail.c - see tail.h. */
#include "tail.h"

#include "wings.h"

#include "../surface/sag/piece.h"

#include <float.h>

static double tail_from(sgt_surface s, double radius, sgt_tails *kept)
{
    if (!(radius > 0)) return 0;
    /* powers of two have a place each, and so have the eighths of one */
    int k = (place_of(radius, COARSE, TAILS) + 5 * place_of(radius, FINE, 8)) % TAILS;
    if (!kept->any)
        for (int i = 0; i < TAILS; i++) kept->radius[i] = 0;
    kept->any = true;
    if (kept->radius[k] != radius)
        kept->radius[k] = radius, kept->least[k] = s.ops->own_->tail(s.self, radius);
    return kept->least[k];
}

sgt_outlook sgt_outlook_of(sgt_vec3 o, sgt_vec3 d)
{
    double a = d.x * d.x + d.y * d.y, first = -(o.x * d.x + o.y * d.y) / a, x = o.x + first * d.x,
           y = o.y + first * d.y, t = first - (x * d.x + y * d.y) / a, cross = fabs(x * d.y - y * d.x),
           lost = 0x1p-49 * (fabs(o.x) + fabs(o.y) + fabs(first) * (fabs(d.x) + fabs(d.y))),
           near = larger(cross - lost, 0), far = cross + lost;
    return (sgt_outlook){t, near * near / a * (1 - 0x1p-40), far * far / a * (1 + 0x1p-40), o.z + t * d.z,
                         0x1p-40 * (fabs(o.z) + fabs(t * d.z)), d.z, a};
}

bool sgt_clear_beyond(sgt_surface s, const sgt_outlook *e, double radius, double side, sgt_tails *kept)
{
    double tail = tail_from(s, radius, kept);
    if (tail == 0) return false;
    double r2 = radius * radius, sign = copysign(1, tail),
           least = fabs(tail) * (1 - 0x1p-20), grows = sign * side * e->n, w = sgt_way_to(e, r2, e->far2),
           most = sgt_way_to(e, r2, e->near2), off = e->off + 0x1p-30 * (fabs(e->n) * most + fabs(e->z));
    if (!(w > 0)) return false;
    bool shrinks = grows <= 0 || 2 * e->a * w * least >= larger(r2 * grows, 0x1p-1000);
    return shrinks && sign * e->z + grows * (grows > 0 ? most : w) + off < least;
}

/* Of the eighths between a power of two and the next, the least that is clear, and below r; else `least`. */
static double least_eighth(sgt_surface s, const sgt_outlook *e, double whole, double r, double side,
                           double least, sgt_tails *kept)
{
    int low = 0, high = 8;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        double radius = whole * (1 + 0.125 * middle);
        bool clear = radius < r && sgt_clear_beyond(s, e, radius, side, kept);
        if (clear) high = middle, least = radius;
        else low = middle;
    }
    return least;
}

/* How far from its point nearest the axis the ray is certainly not nearer than the radius. */
static double way_beyond(const sgt_outlook *e, double radius)
{
    return sgt_way_to(e, radius * radius, e->near2) * (1 + 0x1p-30) + 0x1p-44 * fabs(e->t);
}

/* From r inward the least radius of the table from which on all is clear on the way in; 0: none. */
static double last_clear(sgt_surface s, const sgt_outlook *e, double r, sgt_tails *kept)
{
    double whole = rung_above(r, COARSE), least = 0;
    if (!(whole < HUGE_VAL)) return 0;
    while ((whole *= 0.5) > 0x1p-400 && sgt_clear_beyond(s, e, whole, -1, kept)) least = whole;
    return least_eighth(s, e, whole, r, -1, least, kept);
}

double sgt_past_tail(sgt_surface s, const sgt_outlook *e, double t, double r, sgt_tails *kept)
{
    if (!(t < e->t && e->a > 0x1p-80)) return t;
    double least = last_clear(s, e, r, kept);
    return least > 0 ? larger(e->t - way_beyond(e, least), t) : t;
}

bool sgt_leaves_by_tail(sgt_surface s, const sgt_outlook *e, double t, sgt_tails *kept)
{
    double w = (t - e->t) * (1 - 0x1p-30) - 0x1p-44 * (fabs(t) + fabs(e->t)), radius = w * sqrt(e->a);
    return w > 0 && e->a > 0x1p-80 && sgt_clear_beyond(s, e, rung_below(radius, FINE), 1, kept);
}

/* From r outward the first radius of the table that is clear; 0: none within 2^32 times as far. */
static double first_clear(sgt_surface s, const sgt_outlook *e, double r, double side, sgt_tails *kept)
{
    double whole = rung_above(larger(r, 0x1p-60), COARSE);
    for (int i = 0; i < 32 && whole < HUGE_VAL; i++, whole *= 2)
        if (sgt_clear_beyond(s, e, whole, side, kept))
            return least_eighth(s, e, 0.5 * whole, whole, side, whole, kept);
    return 0;
}

void sgt_cut_tails(sgt_surface s, const sgt_ray *ray, sgt_span *span, sgt_tails *kept)
{
    double scale = scale_of(ray->d), from = ray->tmin * inverse_of_scale(ray->d);
    sgt_vec3 d = {ray->d.x * scale, ray->d.y * scale, ray->d.z * scale};
    if (!is_catalogue(s.ops) || !s.ops->own_->tail) return;
    sgt_outlook e = sgt_outlook_of(ray->o, d);
    if (!(e.a > 0x1p-80 && fabs(e.t) < HUGE_VAL)) return;
    double nearest = sqrt(e.far2), begins = radius_at(ray->o.x, ray->o.y, d.x, d.y, from), in = 0;
    if (from == -HUGE_VAL) in = first_clear(s, &e, nearest, -1, kept);
    else if (from < e.t) in = last_clear(s, &e, begins, kept);
    double out = first_clear(s, &e, in > 0 ? in : begins < HUGE_VAL ? begins : nearest, 1, kept);
    double lo = in > 0 ? (e.t - way_beyond(&e, in)) * scale : -HUGE_VAL,
           hi = out > 0 ? (e.t + way_beyond(&e, out)) * scale : HUGE_VAL;
    if (lo > span->lo) span->lo = lo;
    if (hi < span->hi) span->hi = hi;
}

/* ---------------------------------------------------------------------- the heights */

/* The cone of asphere/unique.c, from where the ray begins.  Beyond that point, at a radius r, the ray is
 * no lower than high + q max(r - r0, 0) on the side it goes to.  Is it above all rings from `first` on?
 * This is coarser than ring by ring, but takes a few operations, and is all that can be said if the last
 * ring is endless. */
SGT_KERNEL
static mask is_above(const sgt_heights *g, const line *w, int first)
{
    double along = fabs(w->from - w->foot) + w->off, z = w->n * w->from, less = 1 - 0x1p-40, left = 0;
    double r0 = sqrt(w->nearest * w->nearest + w->a * (along * along)) * (1 + 0x1p-40) + w->aside,
           q = fabs(w->n) / sqrt(w->a) * less, high = (w->n > 0 ? z : -z) - 0x1p-40 * fabs(z);
    mask rises = MASK(w->n > 0);
#pragma omp simd reduction(+ : left)
    for (int j = first; j < SGT_RINGS; j++) {
        double rise = q * larger((double)j * g->width * less - r0, 0),
               least = (high - 0x1p-40 * fabs(high)) + rise * less;
        left += chosen(rises, g->high[j], -g->low[j]) < least ? 0.0 : 1.0;
    }
    return MASK(left == 0);
}

/* The least tau at which a root may be, by the heights of the first rings: HUGE_VAL if there is none.
 * (A reduction by min may begin at the largest finite number, and does so by clang.) */
SGT_KERNEL
static double first_not_apart(const sgt_heights *g, const line *w, int ended)
{
    double first = HUGE_VAL;
#pragma omp simd reduction(min : first)
    for (int j = 0; j < ended; j++) {
        piece p = piece_of(w, (double)j * g->width, (double)(j + 1) * g->width);
        mask before = p.passed_by | is_apart(w, -p.s_out, -p.s_in, g->low[j], g->high[j]),
             behind = p.passed_by | is_apart(w, p.s_in, p.s_out, g->low[j], g->high[j]);
        double one = chosen(before, HUGE_VAL, larger(w->foot - p.s_out, w->from)),
               other = chosen(behind, HUGE_VAL, larger(w->foot + p.s_in, w->from));
        first = lesser(first, lesser(one, other));
    }
    return first >= DBL_MAX ? HUGE_VAL : first;
}

/* The same for the last ring, which has no outer edge. */
static double first_endless(const sgt_heights *g, const line *w)
{
    piece p = piece_of(w, (SGT_RINGS - 1) * g->width, HUGE_VAL);
    if (is_above(g, w, SGT_RINGS - 1)) return HUGE_VAL;
    return w->from < w->foot - p.s_in ? w->from : larger(w->foot + p.s_in, w->from);
}

double sgt_clear_by_heights(const sgt_heights *g, const sgt_ray *ray, double from)
{
    line w = line_of(ray->o, ray->d, from, ray->tmax);
    int ended = g->endless ? SGT_RINGS - 1 : SGT_RINGS;
    if (!(g->width > 0 && line_in_range(&w))) return from;
    if (is_above(g, &w, 0)) return HUGE_VAL;
    double first = first_not_apart(g, &w, ended), t0 = from * inverse_of_scale(ray->d);
    if (g->endless) first = lesser(first, first_endless(g, &w));
    if (first == HUGE_VAL) return HUGE_VAL;
    double ahead = (first - w.from) * (1 - 0x1p-38) - 0x1p-38 * (fabs(t0) + fabs(w.from));
    return ahead > 0 ? from + ahead * scale_of(ray->d) : from;
}

bool sgt_passes_by(const sgt_heights *g, const sgt_ray *ray, double from)
{
    return sgt_clear_by_heights(g, ray, from) == HUGE_VAL;
}
