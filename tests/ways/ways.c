// SPDX-License-Identifier: MIT
/* Which search a ray goes through: a line for each type of surface, with the share of rays that take each
 * way of src/solve/ways.h, as docs/ways_table.py wants it.
 *
 *     ways        type,rays,which root,share of each way in per cent ...
 *
 * Ordinary rays: like those of the benchmarks, on the specimen of src/types.def.  Hostile ones: hostile.h.
 * A user's surface is a saddle, with what a user may offer.  Rays and shares are the same on every system. */
#include "../ends.h"
#include "../batch/hostile.h"

#include "../../src/solve/ways.h"

enum { RAYS = 2000 };
long sgt_ways[WAYS];
static long taken[WAYS];
static sgt_ray rays[RAYS];

static void one_ray(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, bool all)
{
    sgt_hit hits[16];
    for (int w = 0; w < WAYS; w++) sgt_ways[w] = 0;
    if (all) sgt_intersect_all(s, *ray, 16, hits, opt);
    else sgt_intersect(s, *ray, opt);
    for (int w = 0; w < WAY_SINGLE; w++) taken[w] += sgt_ways[w] > 0;
}

static void print_line(const char *type, const char *kind, const char *which, long n)
{
    printf("%s,%s,%s", type, kind, which);
    for (int w = 0; w < WAYS; w++) printf(",%.0f", 100.0 * (double)taken[w] / (double)n), taken[w] = 0;
    puts("");
}

/* A line for each question; the batch is of the first roots. */
static void lines(const char *type, const char *kind, sgt_surface s)
{
    static double o[3][RAYS], d[3][RAYS], tmin[RAYS], tmax[RAYS], t[RAYS];
    const sgt_options near = {.pick = SGT_NEAR_SEED}, first = {0}, proven = {.proof = SGT_PROVE_FIRST};
    for (int i = 0; i < RAYS; i++) one_ray(s, &rays[i], &first, false);
    for (int i = 0; i < RAYS; i++)
        for (int j = 0; j < 3; j++)
            o[j][i] = *component(&rays[i], j), d[j][i] = *component(&rays[i], 3 + j),
            tmin[i] = rays[i].tmin, tmax[i] = end_of(&rays[i]);
    for (int w = 0; w < WAYS; w++) sgt_ways[w] = 0;
    sgt_intersect_batch(s, RAYS, (sgt_rays){{o[0], o[1], o[2]}, {d[0], d[1], d[2]}, tmin, tmax},
                        (sgt_hits){.t = t}, &first);
    taken[WAY_SINGLE] = sgt_ways[WAY_SINGLE];
    print_line(type, kind, "first", RAYS);
    for (int i = 0; i < RAYS; i++) one_ray(s, &rays[i], &near, false);
    print_line(type, kind, "near the seed", RAYS);
    for (int i = 0; i < RAYS; i++) one_ray(s, &rays[i], &first, true);
    print_line(type, kind, "all", RAYS);
    for (int i = 0; i < RAYS; i++) one_ray(s, &rays[i], &proven, false);
    print_line(type, kind, "proven", RAYS);
}

/* Origins uniform in a square of 4 at z = -5, directions within 0.15 of the axis. */
static void draw_ordinary(void)
{
    generator g = {1};
    for (int i = 0; i < RAYS; i++) {
        double x = uniform(&g, -2, 2), y = uniform(&g, -2, 2), l = uniform(&g, -0.15, 0.15),
               m = uniform(&g, -0.15, 0.15);
        rays[i] = (sgt_ray){{x, y, -5}, {l, m, sqrt(1 - l * l - m * m)}, 0, FAR};
    }
}

static void draw_hostile(const sgt_builtin *type, specimen *s)
{
    generator g = {2};
    *s = random_specimen(&g, type);
    for (int i = 0; i < RAYS; i++) rays[i] = hostile_ray(&g, s);
}

/* -------------------------------------------------------------- a user's surfaces */

/* A saddle, z = 0.02 (x^2 - 2 y^2) + 0.1 x y. */
static double saddle_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    (void)self;
    if (grad) *grad = (sgt_vec3){-0.04 * p.x - 0.1 * p.y, 0.08 * p.y - 0.1 * p.x, 1};
    return p.z - 0.02 * (p.x * p.x - 2 * p.y * p.y) - 0.1 * p.x * p.y;
}

static double saddle_rounding(const void *self, sgt_vec3 p)
{
    (void)self;
    return 0x1p-49 * (fabs(p.z) + p.x * p.x + p.y * p.y);
}

static sgt_span saddle_span(const void *self, const sgt_ray *ray)
{
    (void)self;
    double a = (-8 - ray->o.z) / ray->d.z, b = (8 - ray->o.z) / ray->d.z;
    return (sgt_span){.lo = a < b ? a : b, .hi = a < b ? b : a, .seed = -ray->o.z / ray->d.z};
}

/* g is a polynomial of degree 2 in t: its slope is monotone. */
static sgt_interval saddle_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    double g[3], dg[3], at[3] = {t.lo, 0.5 * t.lo + 0.5 * t.hi, t.hi};
    sgt_interval all = {FAR, -FAR}, steep = all;
    for (int i = 0; i < 3; i++) {
        sgt_vec3 n, p = sum(ray->o, times(at[i], ray->d));
        g[i] = saddle_value(self, p, &n), dg[i] = dot(n, ray->d);
        double e = 4 * saddle_rounding(self, p), f = 4 * e;
        steep.lo = fmin(steep.lo, dg[i] - f), steep.hi = fmax(steep.hi, dg[i] + f);
        all.lo = fmin(all.lo, g[i] - e), all.hi = fmax(all.hi, g[i] + e);
    }
    double beyond = 0.5 * (t.hi - t.lo) * (steep.hi - steep.lo); /* more than g can leave its values by */
    *slope = steep;
    return (sgt_interval){all.lo - beyond, all.hi + beyond};
}

int main(void)
{
    static const sgt_surface_ops value = {.value = saddle_value, .rounding = saddle_rounding},
                                 span = {.value = saddle_value, .rounding = saddle_rounding,
                                         .span = saddle_span},
                                 enclosed = {.value = saddle_value, .rounding = saddle_rounding,
                                             .span = saddle_span, .enclose = saddle_enclose};
    puts("type,rays,root,closed,rounds,quick,careful,cells,steps,parted,batch: one by one");
    for (const sgt_builtin *type = sgt_builtins(); type->type; type++) {
        specimen s;
        draw_ordinary();
        lines(type->type, "ordinary", (sgt_surface){type->ops, type->specimen});
        draw_hostile(type, &s);
        lines(type->type, "hostile", surface_of(&s));
    }
    draw_ordinary();
    lines("a user's value", "ordinary", (sgt_surface){&value, NULL});
    lines("and a span", "ordinary", (sgt_surface){&span, NULL});
    lines("and an enclosure", "ordinary", (sgt_surface){&enclosed, NULL});
}
