// SPDX-License-Identifier: MIT
/* watch.c - seeing each evaluation, and asking what is wrong.
 *
 * The first surface of a scan lens, given by its value alone, and a ray that starts out where
 * it is not defined.  The library finds the root.  So does a bare Newton iteration, until its
 * gradient is scaled to unit length: then it goes to and fro, and the diagnosis says so. */
#include <sagitta/diagnose.h>
#include <sagitta/sagitta.h>

#include <math.h>
#include <stdio.h>

typedef struct sphere { double radius; } sphere;

/* The sag of a sphere: z - s(x, y), undefined beyond the radius. */
static double sphere_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    double c = 1 / ((const sphere *)self)->radius, r2 = p.x * p.x + p.y * p.y, phi = sqrt(1 - c * c * r2);
    if (grad) *grad = (sgt_vec3){-c * p.x / phi, -c * p.y / phi, 1};
    return p.z - c * r2 / (1 + phi);
}

/* Newton alone, as it is often written; halving t where F is not defined. */
static sgt_diagnosis bare_newton(sgt_surface s, sgt_ray ray, double t, bool normalise)
{
    sgt_step steps[50];
    sgt_log log = {steps, 50, 0};
    sgt_move move = SGT_SEED;
    for (int i = 1; i <= 50; i++) {
        sgt_vec3 p = {ray.o.x + t * ray.d.x, ray.o.y + t * ray.d.y, ray.o.z + t * ray.d.z}, n;
        double f = s.ops->value(s.self, p, &n), length = sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
        double slope = n.x * ray.d.x + n.y * ray.d.y + n.z * ray.d.z;
        if (normalise) slope /= length;
        sgt_step step = {
            .eval = i, .move = move, .t = t, .f = f, .slope = slope, .lo = -HUGE_VAL, .hi = HUGE_VAL};
        sgt_log_step(&log, &step);
        if (i <= 5)
            printf("  %-8s t = %-18.16g F = %g\n", sgt_move_text(move), t,
                   isnan(f) ? (double)NAN : f); /* not "-nan" */
        if (f == 0) break;
        move = isnan(f) ? SGT_RETREAT : SGT_NEWTON;
        t = isnan(f) ? t / 2 : t - f / slope;
    }
    return sgt_diagnose(&log);
}

int main(void)
{
    sphere lens = {.radius = -2.2136};
    sgt_surface surface = {&(sgt_surface_ops){.name = "sphere", .value = sphere_value}, &lens};
    sgt_ray ray = {
        .o = {0, 0.5, -5}, .d = {0, 0.3420201433256687, 0.9396926207859084}, .tmin = 0, .tmax = 10};

    /* What the library does: each evaluation is kept in the caller's array. */
    sgt_step steps[200];
    sgt_log log = {steps, 200, 0};
    sgt_hit hit = sgt_intersect(surface, ray, &(sgt_options){.watch = sgt_log_step, .watch_data = &log});
    sgt_diagnosis d = sgt_diagnose(&log);
    printf("sagitta: %s at t = %.16g, %d evaluations\n", sgt_status_text(hit.status), hit.t, hit.evals);
    for (int i = log.n > 3 ? log.n - 3 : 0; i < log.n; i++)
        printf("  %-8s t = %-18.16g F = %g\n", sgt_move_text(steps[i].move), steps[i].t, steps[i].f);
    printf("  %s\n", sgt_verdict_text(d.verdict));

    /* From where the ray meets the vertex plane, as it should be and with the classic mistake. */
    double seed = 5 / ray.d.z;
    printf("bare Newton:\n");
    sgt_diagnosis good = bare_newton(surface, ray, seed, false);
    printf("  %s (order %.2g)\n", sgt_verdict_text(good.verdict), good.order);
    printf("the same, its gradient normalised:\n");
    sgt_diagnosis bad = bare_newton(surface, ray, seed, true);
    printf("  %s\n", sgt_verdict_text(bad.verdict));

    return hit.status == SGT_HIT && fabs(hit.t - 4.143085073464612) <= hit.t_err + 1e-15 && log.n == hit.evals
            && good.verdict == SGT_QUADRATIC && bad.verdict == SGT_OSCILLATING ? 0 : 1;
}
