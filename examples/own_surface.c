// SPDX-License-Identifier: MIT
/* own_surface.c - a surface of one's own: a torus, in implicit form.
 *
 * One function is enough, F and its gradient; the rest of what a surface can answer makes the
 * solver faster or its answer surer.  sgt_check compares what the answers promise with what
 * they do. */
#include <sagitta/diagnose.h>
#include <sagitta/sagitta.h>

#include <math.h>
#include <stdio.h>

typedef struct torus { double major, minor; } torus;

/* F = (x^2 + y^2 + z^2 + R^2 - r^2)^2 - 4 R^2 (x^2 + y^2); the gradient keeps its length. */
static double torus_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const torus *s = self;
    double R2 = s->major * s->major, q = p.x * p.x + p.y * p.y;
    double w = q + p.z * p.z + R2 - s->minor * s->minor;
    if (grad) *grad = (sgt_vec3){4 * p.x * (w - 2 * R2), 4 * p.y * (w - 2 * R2), 4 * p.z * w};
    return w * w - 4 * R2 * q;
}

/* No root lies outside the sphere of radius R + r: where the ray is inside it.  The sphere is
 * drawn a little too large, for what rounding does to the ends. */
static sgt_span torus_span(const void *self, const sgt_ray *ray)
{
    const torus *s = self;
    sgt_vec3 o = ray->o, d = ray->d;
    double R = (s->major + s->minor) * (1 + 1e-9), a = d.x * d.x + d.y * d.y + d.z * d.z;
    double t = -(o.x * d.x + o.y * d.y + o.z * d.z) / a; /* nearest the centre */
    double x = o.x + t * d.x, y = o.y + t * d.y, z = o.z + t * d.z;
    double half2 = (R * R - (x * x + y * y + z * z)) / a;
    if (half2 < 0) return (sgt_span){.lo = 1, .hi = -1}; /* passes by */
    return (sgt_span){.lo = t - sqrt(half2), .hi = t + sqrt(half2), .seed = t - sqrt(half2)};
}

/* No more than 24 roundings of terms that add up to this. */
static double torus_rounding(const void *self, sgt_vec3 p)
{
    const torus *s = self;
    double R2 = s->major * s->major, q = p.x * p.x + p.y * p.y;
    double w = q + p.z * p.z + R2 + s->minor * s->minor;
    return 24 * 0x1p-53 * (w * w + 4 * R2 * q);
}

/* The same at n points, for batches: a loop that the compiler makes vector code of, `restrict` because the
 * arrays never overlap.  To the last bit the same: so by the same function. */
static void torus_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    const torus s = *(const torus *)self;
    const double *restrict x = p.p[0], *restrict y = p.p[1], *restrict z = p.p[2];
    double *restrict f = out.f, *restrict nx = out.grad[0], *restrict ny = out.grad[1],
                     *restrict nz = out.grad[2];
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 grad;
        f[i] = torus_value(&s, (sgt_vec3){x[i], y[i], z[i]}, &grad);
        if (nx) nx[i] = grad.x, ny[i] = grad.y, nz[i] = grad.z;
    }
}

static void torus_spans(const void *self, size_t n, sgt_rays rays, sgt_spans out)
{
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = {.o = {rays.o[0][i], rays.o[1][i], rays.o[2][i]},
                       .d = {rays.d[0][i], rays.d[1][i], rays.d[2][i]}};
        sgt_span span = torus_span(self, &ray);
        out.lo[i] = span.lo, out.hi[i] = span.hi, out.seed[i] = span.seed, out.single[i] = span.single;
    }
}

static const sgt_surface_ops torus_ops = {.name = "torus",
                                          .value = torus_value,
                                          .span = torus_span,
                                          .rounding = torus_rounding,
                                          .values = torus_values,
                                          .spans = torus_spans};

/* The classic mistake: a gradient of unit length. */
static double normalised_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    sgt_vec3 n;
    double f = torus_value(self, p, &n), length = sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    if (grad) *grad = (sgt_vec3){n.x / length, n.y / length, n.z / length};
    return f;
}

static const sgt_surface_ops normalised_ops = {
    .name = "torus, normalised", .value = normalised_value, .span = torus_span};

enum { RAYS = 100 };

int main(void)
{
    torus shape = {.major = 1, .minor = 0.25};
    sgt_surface surface = {&torus_ops, &shape};

    /* Along x through the middle: four roots, at 5 -+ 1.25 and 5 -+ 0.75. */
    sgt_ray ray = {.o = {-5, 0, 0}, .d = {1, 0, 0}};
    sgt_hit hit = sgt_intersect(surface, ray, NULL);
    printf("%s at t = %.17g, right within %.2g, after %d evaluations\n",
           sgt_status_text(hit.status), hit.t, hit.t_err, hit.evals);

    /* From there on: a root at the start does not count, so this is the next. */
    ray.tmin = hit.t, ray.tmax = INFINITY;
    sgt_hit next = sgt_intersect(surface, ray, NULL);
    printf("then %s at t = %.17g\n", sgt_status_text(next.status), next.t);

    /* Many rays at once, as arrays: each answer is the one it gets alone. */
    double x[RAYS], y[RAYS], z[RAYS], along[RAYS], none[RAYS], t[RAYS];
    for (int i = 0; i < RAYS; i++) x[i] = -5, y[i] = 1.5 * i / RAYS, z[i] = 0.1, along[i] = 1, none[i] = 0;
    size_t met = sgt_intersect_batch(surface, RAYS, (sgt_rays){.o = {x, y, z}, .d = {along, none, none}},
                                     (sgt_hits){.t = t}, NULL);
    sgt_hit last = sgt_intersect(surface, (sgt_ray){.o = {x[80], y[80], z[80]}, .d = {1, 0, 0}}, NULL);
    printf("%zu of %d rays meet it, the 81st at t = %.17g\n", met, RAYS, t[80]);

    /* Does it keep its word?  And would the mistake be noticed? */
    const sgt_ray rays[] = {
        {.o = {-5, 0, 0}, .d = {1, 0, 0}, .tmin = 0, .tmax = 10},
        {.o = {0.4, -5, 0.1}, .d = {0.1, 1, 0}, .tmin = 0, .tmax = 10},
        {.o = {0.3, 0.9, -3}, .d = {0.1, -0.1, 1}, .tmin = 0, .tmax = 6},
    };
    sgt_vec3 where;
    sgt_fault fault = sgt_check(surface, 3, rays, NULL);
    sgt_fault noticed = sgt_check((sgt_surface){&normalised_ops, &shape}, 3, rays, &where);
    printf("torus: %s\n", sgt_fault_text(fault));
    printf("normalised: %s, at (%g, %g, %g)\n", sgt_fault_text(noticed), where.x, where.y, where.z);

    return hit.status == SGT_HIT && fabs(hit.t - 3.75) <= hit.t_err && next.status == SGT_HIT &&
                   fabs(next.t - 4.25) <= next.t_err && met == 82 && t[80] == last.t && fault == SGT_SOUND &&
                   noticed == SGT_WRONG_GRADIENT
               ? 0
               : 1;
}
