// SPDX-License-Identifier: MIT
/* mandelbox.c - T. Lowe's Mandelbox (2010), scale 2, with proven first hits and misses.
 *
 * The orbit is v_1 = p, v_{n+1} = 2 k(|w|^2) w + p, where w folds each coordinate of v at 1 and -1 (x beyond
 * 1 becomes 2 - x, below -1 it becomes -2 - x) and k(q) = min(4, max(1, 1 / q)) is a fold by the unit
 * sphere, the inversion, stopped at radius 1/2.  The surface is |v_N| = E, and F = (u - 1) / (u + 1), u =
 * |v_N|^2 / E^2, is below zero inside.  Both folds are continuous, so F is.  It has kinks.
 *
 * WHO ESCAPES.  A fold by planes takes at most 2 sqrt(3) from |v|, and k >= 1.  So |v| > 4 sqrt(3) + |p|
 * gives |v'| >= 2 (|v| - 2 sqrt(3)) - |p| > |v|, and it grows from there on.
 *
 * WHERE.  Let x be a coordinate of p.  It goes x, 4 - x, 3 x - 12, 28 - 5 x, ... in v_n: each fold is at 1
 * or -1, and k is 1, as long as that coordinate is beyond 3 in size.  For x >= 22 these numbers are at least
 * 18 in size; from 3 x - 12 >= x + 4 on they grow.  So every level of E = 18 lies in the cube of half edge
 * 22, and in a ball of radius 22 sqrt(3) < 39.  With x = 6 + d they are 6 + d, -2 - d, 6 + 3 d, -2 - 5 d,
 * ..., and k > 1 only adds to d: the box itself lies in the cube of half edge 6.  There |p| <= 6 sqrt(3),
 * and |v| > 10 sqrt(3) escapes.  E is above that, so the box lies inside every level.
 *
 * THE ENCLOSURE is the same orbit in models (model.h), as for the bulb.  Where no kink is in a cell, a fold
 * is exact but for rounding, and k is 1, 4 or an inverse.  Where one may be, the number is replaced by the
 * hull of its values, and its slope by the hull of the slopes on all sides: F is continuous and has a slope
 * but at kinks, so a mean value theorem holds with the hull.  The width then falls with the first power of
 * the cell's length.  Which kinks a cell holds changes with the level, so most cells hold few.
 *
 * ROUNDING OF F.  A fold by planes moves no two points apart, the inversion where |w| >= r moves them apart
 * by at most 1 / r^2, and inside of 1/2 by 4.  So e' = 2 L e + what a level rounds: 3 U for |w|^2, 1 for its
 * inverse, 2 for the products, 1 for the sum, each of at most 2 |k w| + |p| + 4. */
#include "own.h"

#include "model.h"

static const double ESCAPE = 18, RADIUS = 39, GONE = 1e15;

/* |v| beyond it only grows, where |p| is at most `size`. */
static double escape_of(double size) { return fmax(ESCAPE, 7 + size); }

static int levels(const mandelbox *s) { return s->iterations ? s->iterations : 6; }

static double folded(double x) { return x > 1 ? 2 - x : x < -1 ? -2 - x : x; }
static double inverted(double q) { return q < 0.25 ? 4 : q < 1 ? 1 / q : 1; }

/* One level of the orbit. */
typedef struct fold { vec3 v, w; double q; } fold;

static fold fold_of(vec3 v)
{
    fold f = {.v = v, .w = {folded(v.x), folded(v.y), folded(v.z)}};
    f.q = dot(f.w, f.w);
    return f;
}

static vec3 next_of(const fold *f, vec3 p) { return along(p, 2 * inverted(f->q), f->w); }

/* The transposed derivative of a level, times g. */
static vec3 pulled_back(const fold *f, vec3 g)
{
    const double k = inverted(f->q);
    vec3 h = scaled(g, 2 * k);
    if (f->q >= 0.25 && f->q < 1) h = along(h, -4 * k * k * dot(f->w, g), f->w);
    return (vec3){fabs(f->v.x) > 1 ? -h.x : h.x, fabs(f->v.y) > 1 ? -h.y : h.y,
                  fabs(f->v.z) > 1 ? -h.z : h.z};
}

static double box_value(const void *self, vec3 p, vec3 *grad)
{
    fold at[MANDELBOX_MOST];
    vec3 v = p;
    int n = 0; /* levels gone through; where v is far away F is 1 to the last bit */
    for (; n < levels(self) - 1 && dot(v, v) < GONE * GONE; n++) at[n] = fold_of(v), v = next_of(&at[n], p);
    const double E2 = ESCAPE * ESCAPE, u = dot(v, v) / E2;
    if (grad) {
        vec3 g = *grad = scaled(v, 4 / (E2 * (u + 1) * (u + 1)));
        while (n-- > 0) *grad = add(*grad, g = pulled_back(&at[n], g));
    }
    return u < HUGE_VAL ? (u - 1) / (u + 1) : isfinite(p.x + p.y + p.z) ? 1 : (double)NAN;
}

static double box_rounding(const void *self, vec3 p)
{
    const double size = sqrt(dot(p, p));
    double e = 0;
    vec3 v = p;
    for (int n = 1; n < levels(self) && dot(v, v) < GONE * GONE; n++) {
        const fold f = fold_of(v);
        const double near = fmax(0, sqrt(f.q) * (1 - 8 * U) - e - 4 * U),
                     stretch = near < 0.5 ? 4 : near < 1 ? 1 / (near * near) : 1;
        v = next_of(&f, p);
        e = (2 * stretch * e + 16 * U * (sqrt(dot(v, v)) + 2 * size + 4)) * (1 + 16 * U);
    }
    /* dF/dr: as of the bulb */
    const double nearest = (sqrt(dot(v, v)) * (1 - 8 * U) - e) / ESCAPE, q = 1 + nearest * nearest;
    return fmin(2, (nearest > 0.6 ? 4 * nearest / (q * q) : 1.3) * e / ESCAPE + 16 * U);
}

static sgt_span box_span(const void *self, const sgt_ray *ray)
{
    (void)self;
    return own_ball(RADIUS, ray->o, ray->d);
}

/* ----------------------------------------------------------- the enclosure */

/* All numbers from lo to hi, which have come by a rounding or two. */
static model between(double lo, double hi)
{
    const double c = 0.5 * (lo + hi);
    return (model){c, 0, fmax(hi - c, c - lo) * (1 + 4 * U) + 4 * U * fabs(c) + 0x1p-1000};
}

static jet folded_jet(jet x)
{
    const double lo = lowest(x.f), hi = highest(x.f), at = folded(lo), to = folded(hi);
    if (lo >= -1 && hi <= 1) return x;
    if (lo > 1 || hi < -1) {
        const model middle = {lo > 1 ? 2 : -2, 0, 0};
        return (jet){minus(middle, x.f), negative(x.d)};
    }
    /* Between its values at the ends and at the kinks in between.  Rounding turned a few parts in 2^53. */
    const double off = 4 * U * (2 + fmax(fabs(lo), fabs(hi))), steep = fmax(-lowest(x.d), highest(x.d));
    const double least = fmin(fmin(at, to), lo <= -1 ? -1 : at), most = fmax(fmax(at, to), hi >= 1 ? 1 : to);
    return (jet){between(least - off, most + off), {0, 0, steep}};
}

/* The factor k of q = |w|^2. */
static jet factor_of(jet q, bool slope)
{
    const double lo = lowest(q.f), hi = highest(q.f);
    if (lo > 1) return (jet){{1, 0, 0}, {0, 0, 0}};
    if (hi < 0.25) return (jet){{4, 0, 0}, {0, 0, 0}};
    if (lo >= 0.25 && hi <= 1) return jet_inverse(q, slope);
    const double most = inverted(lo) * (1 + 4 * U), least = inverted(hi) * (1 - 4 * U),
                 steep = most * most * fmax(-lowest(q.d), highest(q.d)) * (1 + 8 * U);
    return (jet){between(least, most), {0, 0, steep}};
}

/* F and, if it is asked for, its slope over a cell. */
static inline sgt_interval enclosed(const mandelbox *s, const jet p[3], bool slope, sgt_interval *of_slope)
{
    const double E2 = ESCAPE * ESCAPE;
    jet v[3] = {p[0], p[1], p[2]}, u;
    double T = 0;
    for (int n = 1;; n++) {
        u = jet_plus(jet_plus(jet_square(v[0], slope), jet_square(v[1], slope)), jet_square(v[2], slope));
        if (n == levels(s)) break;
        if (n == 1) T = escape_of(sqrt(highest(u.f)) * (1 + 4 * U));
        if (lowest(u.f) > T * T * (1 + 8 * U)) return (sgt_interval){0x1p-1000, 1};
        if (!(highest(u.f) < 1e12)) return (sgt_interval){-1, 1};
        jet w[3];
        for (int i = 0; i < 3; i++) w[i] = folded_jet(v[i]);
        const jet q = jet_plus(jet_plus(jet_square(w[0], slope), jet_square(w[1], slope)),
                               jet_square(w[2], slope)),
                  k = jet_scaled(factor_of(q, slope), 2);
        for (int i = 0; i < 3; i++) v[i] = jet_plus(jet_product(k, w[i], slope), p[i]);
    }
    const double lo = fmax(0, lowest(u.f)) / E2 * (1 - 8 * U), hi = highest(u.f) / E2 * (1 + 8 * U);
    if (slope && hi < 1e12) { /* F' = 2 u' / (1 + u)^2 */
        const double least = 2 / E2 / ((1 + hi) * (1 + hi)) * (1 - 16 * U),
                     most = 2 / E2 / ((1 + lo) * (1 + lo)) * (1 + 16 * U), d_lo = lowest(u.d),
                     d_hi = highest(u.d);
        *of_slope = (sgt_interval){d_lo * (d_lo < 0 ? most : least), d_hi * (d_hi < 0 ? least : most)};
        of_slope->lo -= 4 * U * fabs(of_slope->lo), of_slope->hi += 4 * U * fabs(of_slope->hi);
    }
    const double f_lo = (lo - 1) / (lo + 1), f_hi = hi < HUGE_VAL ? (hi - 1) / (hi + 1) : 1;
    return (sgt_interval){fmax(-1, f_lo - 4 * U), fmin(1, f_hi + 4 * U)};
}

static sgt_interval box_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const vec3 o = ray->o, d = ray->d;
    const double m = 0.5 * t.lo + 0.5 * t.hi, h = fmax(t.hi - m, m - t.lo) * (1 + 4 * U);
    const jet p[3] = {jet_on_ray(o.x, d.x, m, h), jet_on_ray(o.y, d.y, m, h), jet_on_ray(o.z, d.z, m, h)};
    *slope = (sgt_interval){-HUGE_VAL, HUGE_VAL};
    const sgt_interval f = enclosed(self, p, false, slope);
    return f.lo > 0 || f.hi < 0 ? f : enclosed(self, p, true, slope);
}

const sgt_surface_ops mandelbox_ops = {.name = "mandelbox",
                                       .value = box_value,
                                       .span = box_span,
                                       .rounding = box_rounding,
                                       .enclose = box_enclose};
