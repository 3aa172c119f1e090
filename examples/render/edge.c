/* edge.c - a surface of one's own whose range along a ray is known: the edge of a lens.
 *
 *     F = (x^2 + y^2 - r^2) / 2r  for z from `from` to `to`, and undefined elsewhere.
 *
 * Along a ray F is a quadratic g = (a t^2 + 2 b t + c) / 2r, a and c not negative.  Over an
 * interval it takes its extremes at the ends, or at t = -b/a; its slope takes them at the ends.
 * So `enclose` is as narrow as rounding allows, and every root the library finds is the first
 * for certain, every miss a proof.  The slab of z is the span. */
#include "own.h"

#include "vector.h"

static const double U = 0x1p-53;

/* Defined a little beyond the slab, which is the span: a rounded end of it is no NaN. */
static bool within(const edge *s, double z)
{
    double more = 1e-9 * (fabs(s->from) + fabs(s->to));
    return z >= s->from - more && z <= s->to + more;
}

static double edge_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const edge *s = self;
    double r = s->radius;
    if (grad) *grad = (vec3){p.x / r, p.y / r, 0};
    return within(s, p.z) ? (p.x * p.x + p.y * p.y - r * r) / (2 * r) : (double)NAN;
}

static double edge_rounding(const void *self, sgt_vec3 p)
{
    const edge *s = self;
    double r = s->radius;
    return 4 * U * (p.x * p.x + p.y * p.y + r * r) / r;
}

static sgt_span edge_span(const void *self, const sgt_ray *ray)
{
    const edge *s = self;
    sgt_span span = {.lo = -HUGE_VAL, .hi = HUGE_VAL, .seed = NAN};
    if (ray->d.z == 0) return within(s, ray->o.z) ? span : (sgt_span){.lo = 1, .hi = -1};
    double t1 = (s->from - ray->o.z) / ray->d.z, t2 = (s->to - ray->o.z) / ray->d.z;
    span.lo = fmin(t1, t2), span.hi = fmax(t1, t2);
    return span;
}

/* Each coefficient has at most 3 roundings of terms of these sizes, g as many again. */
static sgt_interval edge_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const edge *s = self;
    vec3 o = ray->o, d = ray->d;
    double r = s->radius, a = d.x * d.x + d.y * d.y, b = o.x * d.x + o.y * d.y, b_size = fabs(o.x * d.x) + fabs(o.y * d.y);
    double c_size = o.x * o.x + o.y * o.y + r * r, far = fmax(fabs(t.lo), fabs(t.hi));
    double off = 8 * U * (a * far * far + 2 * b_size * far + c_size) / r, slope_off = 8 * U * (a * far + b_size) / r;
    double at_lo = edge_value(s, (vec3){o.x + t.lo * d.x, o.y + t.lo * d.y, s->from}, NULL);
    double at_hi = edge_value(s, (vec3){o.x + t.hi * d.x, o.y + t.hi * d.y, s->from}, NULL);
    double lowest = fmin(at_lo, at_hi), middle = -b / a;
    if (middle > t.lo && middle < t.hi)
        lowest = fmin(lowest, edge_value(s, (vec3){o.x + middle * d.x, o.y + middle * d.y, s->from}, NULL));
    *slope = (sgt_interval){(a * t.lo + b) / r - slope_off, (a * t.hi + b) / r + slope_off};
    return (sgt_interval){lowest - off, fmax(at_lo, at_hi) + off};
}

const sgt_surface_ops edge_ops = {.name = "edge", .value = edge_value, .span = edge_span, .rounding = edge_rounding,
                                  .enclose = edge_enclose};
