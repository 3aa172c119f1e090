// SPDX-License-Identifier: MIT
/* implicit.c - the surface F(x, y, z) = 0 of a formula, within a ball or a box.
 *
 * Each operation of a surface is worked out from the tape: F and its gradient by values.c, enclosures by
 * enclose.c.  `rounding` is the distance of F as computed from the enclosure of F at the very point, which
 * contains the exact F.
 *
 * THE SPAN is the stretch of the ray in the ball, cut to that in the box.  Both are made longer by a few
 * roundings of the point that is nearest the origin: points outside by so little may be met.  Without a ball
 * and a box it is the whole ray. */
#include "../../num/lanes.h"
#include "../builtin.h"
#include "formula.h"

#include <math.h>

static double implicit_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const sgt_formula *s = self;
    double f;
    sgt_vec3 n;
    sgt_values out = {&f, {grad ? &n.x : NULL, &n.y, &n.z}};
    sgt_formula_values(s->tape, 1, (sgt_points){{&p.x, &p.y, &p.z}}, out);
    if (grad) *grad = n;
    return f;
}

static void implicit_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    sgt_formula_values(((const sgt_formula *)self)->tape, n, p, out);
}

static sgt_interval radius_in(const sgt_interval at[3]) { return sgt_interval_hypotenuse(at[0], at[1]); }

static double implicit_rounding(const void *self, sgt_vec3 p)
{
    const sgt_formula *s = self;
    const sgt_interval none[3] = {{0, 0}, {0, 0}, {0, 0}};
    sgt_interval at[3] = {sgt_interval_of(p.x), sgt_interval_of(p.y), sgt_interval_of(p.z)};
    sgt_interval f = sgt_formula_jet(s->tape, at, radius_in(at), none, none, false).f;
    double v = implicit_value(self, p, NULL), off = larger(sgt_sum_above(f.hi, -v), sgt_sum_above(v, -f.lo));
    return f.lo <= f.hi && off < HUGE_VAL ? larger(off, 0) : HUGE_VAL;
}

static sgt_interval implicit_enclose_from(const void *self, const sgt_ray *ray, double t0, sgt_interval t,
                                          sgt_interval *slope)
{
    const sgt_formula *s = self;
    const double o[] = {ray->o.x, ray->o.y, ray->o.z}, d[] = {ray->d.x, ray->d.y, ray->d.z};
    sgt_interval at[3], by[3];
    for (int k = 0; k < 3; k++) {
        sgt_interval from = sgt_interval_of(o[k]);
        if (t0 != 0) from = sgt_interval_sum(from, sgt_interval_scaled(sgt_interval_of(t0), d[k]));
        at[k] = sgt_interval_sum(from, sgt_interval_scaled(t, d[k]));
        by[k] = sgt_interval_of(d[k]);
    }
    formula_jet jet = sgt_formula_jet(s->tape, at, radius_in(at), by, by, false);
    *slope = jet.u;
    return jet.f;
}

static sgt_interval implicit_enclose(const void *self, const sgt_ray *ray, sgt_interval t,
                                     sgt_interval *slope)
{
    return implicit_enclose_from(self, ray, 0, t, slope);
}

/* ------------------------------------------------------------------------- the span */

typedef struct within { double lo, hi; } within;

/* |o + t d| <= radius, which is above 0.  The point nearest the origin is at t = m, its distance off by e. */
SGT_INLINE within chord_in_ball(double radius, double ox, double oy, double oz, double dx, double dy,
                               double dz)
{
    double most = larger(fabs(dx), larger(fabs(dy), fabs(dz))), l = dx / most, m = dy / most, n = dz / most;
    double a = l * l + m * m + n * n, t = -(ox * l + oy * m + oz * n) / a;
    double x = ox + t * l, y = oy + t * m, z = oz + t * n;
    double e = 0x1p-49 * (fabs(ox) + fabs(oy) + fabs(oz) + fabs(t)) + 0x1p-49 * radius;
    double near2 = x * x + y * y + z * z, room = (radius + e) * (radius + e) - near2 + 4 * e * sqrt(near2);
    double half = sqrt(larger(room, 0) / a) * (1 + 0x1p-48) + e;
    mask met = MASK(!(room < 0));
    return (within){chosen(met, (t - half) / most, 1), chosen(met, (t + half) / most, -1)};
}

/* lo <= o + t d <= hi in one coordinate.  d may be 0. */
SGT_INLINE within chord_in_slab(double lo, double hi, double o, double d)
{
    double e = 0x1p-51 * (fabs(o) + fabs(lo) + fabs(hi)), a = (lo - e - o) / d, b = (hi + e - o) / d;
    double first = a < b ? a : b, last = a < b ? b : a;
    mask along = MASK(d == 0), in = MASK((o >= lo - e) & (o <= hi + e));
    first -= 0x1p-51 * fabs(first), last += 0x1p-51 * fabs(last);
    return (within){chosen(along, chosen(in, -HUGE_VAL, 1), first),
                   chosen(along, chosen(in, HUGE_VAL, -1), last)};
}

static bool has_box(const sgt_formula *s)
{
    return s->lo.x != 0 || s->lo.y != 0 || s->lo.z != 0 || s->hi.x != 0 || s->hi.y != 0 || s->hi.z != 0;
}

SGT_KERNEL
static void spans_in(size_t n, double radius, const sgt_rays *r, double *restrict lo, double *restrict hi)
{
    const double *ox = r->o[0], *oy = r->o[1], *oz = r->o[2], *dx = r->d[0], *dy = r->d[1], *dz = r->d[2];
    LANES for (size_t i = 0; i < n; i++) {
        within c = chord_in_ball(radius, ox[i], oy[i], oz[i], dx[i], dy[i], dz[i]);
        lo[i] = c.lo, hi[i] = c.hi;
    }
}

SGT_KERNEL
static void cut_to_slab(size_t n, double from, double to, const double *restrict o, const double *restrict d,
                        double *restrict lo, double *restrict hi)
{
    LANES for (size_t i = 0; i < n; i++) {
        within c = chord_in_slab(from, to, o[i], d[i]);
        lo[i] = lo[i] > c.lo ? lo[i] : c.lo, hi[i] = hi[i] < c.hi ? hi[i] : c.hi;
    }
}

static void implicit_spans(const void *self, size_t n, sgt_rays r, sgt_spans out)
{
    const sgt_formula *s = self;
    for (size_t i = 0; i < n; i++)
        out.lo[i] = -HUGE_VAL, out.hi[i] = HUGE_VAL, out.seed[i] = (double)NAN, out.single[i] = false;
    if (s->ball > 0) spans_in(n, s->ball, &r, out.lo, out.hi);
    if (!has_box(s)) return;
    cut_to_slab(n, s->lo.x, s->hi.x, r.o[0], r.d[0], out.lo, out.hi);
    cut_to_slab(n, s->lo.y, s->hi.y, r.o[1], r.d[1], out.lo, out.hi);
    cut_to_slab(n, s->lo.z, s->hi.z, r.o[2], r.d[2], out.lo, out.hi);
}

static sgt_span implicit_span(const void *self, const sgt_ray *ray)
{
    sgt_span s;
    implicit_spans(self, 1, rays_of(ray), (sgt_spans){&s.lo, &s.hi, &s.seed, &s.single});
    return s;
}

static void implicit_encloses(const void *self, size_t n, sgt_rays rays, const double *t_lo,
                              const double *t_hi, sgt_enclosures out)
{
    sgt_formula_encloses(((const sgt_formula *)self)->tape, n, rays, t_lo, t_hi, out);
}

/* ---------------------------------------------------------------------- derivatives */

static void implicit_second(const void *self, size_t n, sgt_points p, double *const out[6])
{
    static const unsigned char by[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
    const sgt_formula *s = self;
    for (int k = 0; k < 6; k++)
        sgt_formula_mixed(s->tape, by[k][0], by[k][1], n, p, (formula_mixed){.uv = out[k]});
}

static size_t implicit_parameters(const void *self)
{
    return (size_t)((const sgt_formula *)self)->tape->parameters;
}

static void implicit_by_parameter(const void *self, size_t j, size_t n, sgt_points p, sgt_values out)
{
    const sgt_formula *s = self;
    for (size_t k = 0; k < (out.grad[0] ? 3 : 1); k++)
        sgt_formula_mixed(s->tape, 3 + j, k, n, p, (formula_mixed){.u = out.f, .uv = out.grad[k]});
}

static bool all_finite(sgt_vec3 v) { return v.x - v.x + (v.y - v.y) + (v.z - v.z) == 0; }

static sgt_objection implicit_object(const void *self)
{
    const sgt_formula *s = self;
    if (!s->tape || s->tape->kind != SGT_FORMULA_XYZ)
        return (sgt_objection){"f", "must be a formula of x, y and z"};
    if (!(s->ball >= 0 && s->ball < 0x1p500))
        return (sgt_objection){"ball", "must be 0 or more, and below 2^500"};
    if (!all_finite(s->lo) || !all_finite(s->hi)) return (sgt_objection){"box", "must be finite"};
    if (s->lo.x > s->hi.x || s->lo.y > s->hi.y || s->lo.z > s->hi.z)
        return (sgt_objection){"box", "must have its lower corner first"};
    return (sgt_objection){NULL, NULL};
}

/* A little farther than the ball and the box: roundings of a point on them are within. */
static bool implicit_jumps(const void *self)
{
    const sgt_formula *s = self;
    double most = s->ball > 0 ? s->ball * (1 + 0x1p-40) : HUGE_VAL;
    sgt_interval ball = {-most, most}, at[3] = {ball, ball, ball}, r = {0, most};
    const double lo[] = {s->lo.x, s->lo.y, s->lo.z}, hi[] = {s->hi.x, s->hi.y, s->hi.z};
    for (int k = 0; has_box(s) && k < 3; k++) {
        double more = 0x1p-40 * larger(fabs(lo[k]), fabs(hi[k]));
        at[k] = sgt_interval_intersection(at[k], sgt_interval_between(lo[k] - more, hi[k] + more));
    }
    return sgt_formula_jumps(s->tape, at, sgt_interval_intersection(r, radius_in(at)));
}

static const struct sgt_builtin_ops implicit_builtin = {
    .object = implicit_object, .enclose = implicit_enclose_from, .jumps = implicit_jumps};

const sgt_surface_ops sgt_formula_ops = {
    .name = "formula", .own_ = &implicit_builtin, .value = implicit_value, .span = implicit_span,
    .rounding = implicit_rounding, .enclose = implicit_enclose, .encloses = implicit_encloses,
    .values = implicit_values, .spans = implicit_spans, .second = implicit_second,
    .parameters = implicit_parameters, .by_parameter = implicit_by_parameter};
