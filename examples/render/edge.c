// SPDX-License-Identifier: MIT
/* edge.c - a surface of one's own whose range along a ray is known: the edge of a lens.
 *
 *     F = (x^2 + y^2 - r^2) / 2r  for z from `from` to `to`, and undefined elsewhere.
 *
 * Along a ray F is a quadratic g = (a t^2 + 2 b t + c) / 2r, a not negative: convex.  The ray is in the
 * slab of z from t1 to t2.  If g is below zero at both, so it is between; if its least value there is above
 * zero, the ray passes by as well.  Where g is of one sign at t1 and of the other at t2 it has one root
 * between, and that is the larger root of the quadratic if g rises, the smaller if it falls.  What rounding
 * leaves undecided, and two roots, are for `enclose`: over an interval g takes its extremes at the ends, or
 * at t = -b/a, and its slope at the ends, so it is as narrow as rounding allows.  Every root the library
 * finds is the first for certain, every miss a proof. */
#include "own.h"

#include "vector.h"

static const double U = 0x1p-53;

/* Defined a little beyond the slab, which is the span: a rounded end of it is no NaN. */
static inline double beyond(const edge *s) { return 1e-9 * (fabs(s->from) + fabs(s->to)); }

static inline double formula(const edge *s, vec3 p, vec3 *grad)
{
    double r = s->radius, f = (p.x * p.x + p.y * p.y - r * r) / (2 * r);
    *grad = (vec3){p.x / r, p.y / r, 0};
    f = p.z >= s->from - beyond(s) ? f : (double)NAN;
    return p.z <= s->to + beyond(s) ? f : (double)NAN;
}

static double edge_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    vec3 unwanted;
    return formula(self, p, grad ? grad : &unwanted);
}

static void edge_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    if (out.grad[0]) {
        #pragma omp simd
        for (size_t i = 0; i < n; i++) {
            vec3 grad;
            out.f[i] = formula(self, own_at(p.p, i), &grad);
            out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
        }
    } else {
        #pragma omp simd
        for (size_t i = 0; i < n; i++) out.f[i] = formula(self, own_at(p.p, i), &(vec3){0});
    }
}

static double edge_rounding(const void *self, sgt_vec3 p)
{
    const edge *s = self;
    double r = s->radius;
    return 4 * U * (p.x * p.x + p.y * p.y + r * r) / r;
}

/* 2 r g along a ray, and the sizes of what it is made of. */
typedef struct quadratic { double a, b, c, b_size, c_size; } quadratic;

static inline quadratic along_ray(const edge *s, vec3 o, vec3 d)
{
    double r2 = s->radius * s->radius, q2 = o.x * o.x + o.y * o.y;
    return (quadratic){d.x * d.x + d.y * d.y, o.x * d.x + o.y * d.y, q2 - r2,
                       fabs(o.x * d.x) + fabs(o.y * d.y), q2 + r2};
}

static inline double at(const quadratic *q, double t) { return (q->a * t + 2 * q->b) * t + q->c; }

/* How far rounding may put it off for |t| up to `far`: each coefficient has at most 3 roundings of terms of
 * these sizes, the sum as many again. */
static inline double off(const quadratic *q, double far)
{
    return 16 * U * (q->a * far * far + 2 * q->b_size * far + q->c_size);
}

/* Without a branch: a loop around it becomes vector code.  *one: 1 where there is one root at most, else 0.
 */
static inline sgt_span slab(const edge *s, vec3 o, vec3 d, double *one)
{
    double t1 = (s->from - o.z) / d.z, t2 = (s->to - o.z) / d.z, lo = t1 < t2 ? t1 : t2,
           hi = t1 < t2 ? t2 : t1;
    bool level = d.z == 0, in = (int)(o.z >= s->from - beyond(s)) & (int)(o.z <= s->to + beyond(s));
    lo = level ? -HUGE_VAL : lo, hi = level ? HUGE_VAL : hi;
    quadratic q = along_ray(s, o, d);
    double low = -q.b / q.a, far = fabs(lo) > fabs(hi) ? fabs(lo) : fabs(hi), more = 4 * off(&q, far);
    /* NaN, of an axis that is followed: g is the same all along */
    low = low > lo ? low : lo, low = low < hi ? low : hi;
    double g_lo = at(&q, lo), g_hi = at(&q, hi);
    bool inside = (g_lo < -more) & (g_hi < -more), outside = at(&q, low) > more;
    bool single = ((g_lo < -more) & (g_hi > more)) | ((g_lo > more) & (g_hi < -more));
    double w = q.b * q.b - q.a * q.c, root = sqrt(w > 0 ? w : 0);
    /* without cancellation: one root is this by a, the other c by this */
    double stable = -(q.b + (q.b > 0 ? root : -root));
    double seed = (q.b > 0) == !(g_hi > g_lo) ? stable / q.a : q.c / stable;
    bool passes = inside | outside | (level & !in);
    *one = single ? 1 : 0;
    return (sgt_span){.lo = passes ? 1 : lo, .hi = passes ? -1 : hi, .seed = single ? seed : (double)NAN};
}

static sgt_span edge_span(const void *self, const sgt_ray *ray)
{
    double one;
    sgt_span span = slab(self, ray->o, ray->d, &one);
    span.single = one > 0;
    return span;
}

static void edge_spans(const void *self, size_t n, sgt_rays rays, sgt_spans out)
{
    enum { LOT = 64 };
    double one[LOT];
    for (size_t i = 0; i < n; i += LOT) {
        size_t count = n - i < LOT ? n - i : LOT;
        #pragma omp simd
        for (size_t k = 0; k < count; k++) {
            sgt_span span = slab(self, own_at(rays.o, i + k), own_at(rays.d, i + k), &one[k]);
            out.lo[i + k] = span.lo, out.hi[i + k] = span.hi, out.seed[i + k] = span.seed;
        }
        for (size_t k = 0; k < count; k++) out.single[i + k] = one[k] > 0;
    }
}

static sgt_interval edge_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const edge *s = self;
    quadratic q = along_ray(s, ray->o, ray->d);
    double r = s->radius, far = fmax(fabs(t.lo), fabs(t.hi));
    double more = off(&q, far) / (2 * r), slope_more = 8 * U * (q.a * far + q.b_size) / r;
    double g_lo = at(&q, t.lo) / (2 * r), g_hi = at(&q, t.hi) / (2 * r), lowest = fmin(g_lo, g_hi),
           middle = -q.b / q.a;
    if (middle > t.lo && middle < t.hi) lowest = fmin(lowest, at(&q, middle) / (2 * r));
    *slope = (sgt_interval){(q.a * t.lo + q.b) / r - slope_more, (q.a * t.hi + q.b) / r + slope_more};
    return (sgt_interval){lowest - more, fmax(g_lo, g_hi) + more};
}

const sgt_surface_ops edge_ops = {.name = "edge",
                                  .value = edge_value,
                                  .span = edge_span,
                                  .rounding = edge_rounding,
                                  .enclose = edge_enclose,
                                  .values = edge_values,
                                  .spans = edge_spans};
