/* torus.c - a surface of one's own whose range along a ray is known.
 *
 *     F = (x^2 + y^2 + z^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + y^2),   negative inside.
 *
 * Along a ray F is w^2 - 4 R^2 q with w and q quadratic in t.  About the middle of an interval, s = t - middle,
 *
 *     w = w0 + 2 w1 s + a s^2,   q = q0 + 2 q1 s + q2 s^2,   g = g0 + g1 s + g2 s^2 + g3 s^3 + g4 s^4,
 *
 * so for |s| <= h it is within |g1| h + |g2| h^2 + ... of g0, and its slope in the same way.  With that
 * `enclose` every root the library finds is the first for certain, and every miss a proof. */
#include "own.h"

#include "vector.h"

#include <string.h>

static const double U = 0x1p-53;

static double torus_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const torus *s = self;
    double R2 = s->major * s->major, q = p.x * p.x + p.y * p.y;
    double w = q + p.z * p.z + R2 - s->minor * s->minor;
    if (grad) *grad = (vec3){4 * p.x * (w - 2 * R2), 4 * p.y * (w - 2 * R2), 4 * p.z * w};
    return w * w - 4 * R2 * q;
}

/* No more than 24 roundings of terms that add up to this. */
static double torus_rounding(const void *self, sgt_vec3 p)
{
    const torus *s = self;
    double R2 = s->major * s->major, q = p.x * p.x + p.y * p.y;
    double w = q + p.z * p.z + R2 + s->minor * s->minor;
    return 24 * U * (w * w + 4 * R2 * q);
}

/* With W the sum of the magnitudes in w and V that in w', each a bound on its values too, no coefficient
 * has more than 16 roundings of terms that are at most 4 W^2, or 8 W V of the slope. */
static sgt_interval torus_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const torus *s = self;
    double middle = 0.5 * t.lo + 0.5 * t.hi, h = fmax(t.hi - middle, middle - t.lo) * (1 + 4 * U), R2 = s->major * s->major;
    vec3 d = ray->d, p = along(ray->o, middle, d);
    vec3 size = {fabs(ray->o.x) + fabs(middle * d.x), fabs(ray->o.y) + fabs(middle * d.y), fabs(ray->o.z) + fabs(middle * d.z)};
    double a = dot(d, d), q2 = d.x * d.x + d.y * d.y, w1 = dot(p, d), q1 = p.x * d.x + p.y * d.y;
    double q0 = p.x * p.x + p.y * p.y, w0 = q0 + p.z * p.z + R2 - s->minor * s->minor;
    double W = dot(size, size) + R2 + s->minor * s->minor, V = sqrt(W * a);
    double g = w0 * w0 - 4 * R2 * q0, g1 = 4 * w0 * w1 - 8 * R2 * q1, g2 = fabs(4 * w1 * w1 + 2 * w0 * a - 4 * R2 * q2);
    double g3 = fabs(4 * w1 * a), g4 = a * a, more = 1 + 64 * U;
    double around = h * (fabs(g1) + h * (g2 + h * (g3 + h * g4))) * more + 128 * U * (W * W + h * V * (W + h * V));
    double slope_around = h * (2 * g2 + h * (3 * g3 + h * 4 * g4)) * more + 256 * U * V * (W + h * V);
    *slope = (sgt_interval){g1 - slope_around, g1 + slope_around};
    return (sgt_interval){g - around, g + around};
}

/* Within a ball of radius R + r, and between the planes z = -r and z = r; both are drawn larger by a part in 10^9, for
 * what rounding does to the ends.  Without a branch: a loop around it becomes vector code. */
static inline sgt_span around(const torus *s, vec3 o, vec3 d)
{
    sgt_span span = own_ball(s->major + s->minor, o, d);
    double more = s->minor * (1 + 1e-9) + 1e-9 * fabs(o.z);
    double t1 = (-more - o.z) / d.z, t2 = (more - o.z) / d.z; /* of a level ray infinite, or NaN, which is no end */
    double lo = t1 < t2 ? t1 : t2, hi = t1 < t2 ? t2 : t1;
    span.lo = lo > span.lo ? lo : span.lo, span.hi = hi < span.hi ? hi : span.hi;
    return span;
}

static sgt_span torus_span(const void *self, const sgt_ray *ray) { return around(self, ray->o, ray->d); }

static void torus_spans(const void *self, size_t n, sgt_rays rays, sgt_spans out)
{
    memset(out.single, 0, n * sizeof *out.single);
    #pragma omp simd
    for (size_t i = 0; i < n; i++) {
        sgt_span span = around(self, own_at(rays.o, i), own_at(rays.d, i));
        out.lo[i] = span.lo, out.hi[i] = span.hi, out.seed[i] = span.seed;
    }
}

const sgt_surface_ops torus_ops = {.name = "torus", .value = torus_value, .span = torus_span, .rounding = torus_rounding,
                                   .enclose = torus_enclose, .spans = torus_spans};
