// SPDX-License-Identifier: MIT
/* levels.c - how many levels of an orbit a picture shows; and how near an orbit comes to a point.
 *
 * The level sets |Q_N| = E of growing N lie in each other and close in on the set.  Where level N + 1 is less
 * than a pixel behind level N, a picture cannot show what N + 1 adds; it only gets grain.  So 32 x 32 rays of
 * the camera are put to the levels N and N + 1, from N = 2 on, until of those that meet level N three in four
 * also meet level N + 1 less than a pixel behind, measured along the normal.  That is a measurement at these
 * rays, and no bound for the others.
 *
 * WHAT IS PROVEN THEN.  Each hit and miss is proven of level N, whatever N is.  Since the set lies inside, a
 * ray that certainly misses level N misses the set, and a hit with the set is not before the hit that is
 * shown. How far behind it is, is not proven.
 *
 * THE TRAP colours a hit by the least |Q_k - trap|, k = 1 ... N (C. A. Pickover 1987).  It is rounded as it
 * comes, and nothing is decided by it. */
#include "levels.h"

#include "fail.h"
#include "lot.h"

#include <stdlib.h>
#include <string.h>

enum { RAYS = 32, MOST_LEVELS = 1000 };

static int *iterations_of(object *o)
{
    return o->surface.ops == &sgt_julia_ops ? &o->own.julia.iterations : &o->own.mandelbrot.iterations;
}

static bool valid(const object *o)
{
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        if (b->ops == o->surface.ops) return !b->object || !b->object(o->surface.self).param;
    return false;
}

typedef struct answers {
    double t[RAYS * RAYS], n[3][RAYS * RAYS];
    sgt_status status[RAYS * RAYS];
} answers;

static void ask_level(object *o, int level, const sgt_ray ray[], answers *a)
{
    *iterations_of(o) = level;
    for (int i = 0; i < RAYS * RAYS; i++) {
        const sgt_hit hit = sgt_intersect(o->surface, ray[i], &o->options);
        a->t[i] = hit.t, a->status[i] = hit.status;
        a->n[0][i] = hit.n.x, a->n[1][i] = hit.n.y, a->n[2][i] = hit.n.z;
    }
}

/* Is level b less than a pixel behind level a, for three in four of the rays that meet a? */
static bool resolved(const answers *a, const answers *b, const sgt_ray ray[], double pixel)
{
    int met = 0, near = 0;
    for (int i = 0; i < RAYS * RAYS; i++) {
        if (a->status[i] <= 0) continue;
        const vec3 n = {a->n[0][i], a->n[1][i], a->n[2][i]};
        const double cosine = fabs(dot(n, ray[i].d)) / (length(n) * length(ray[i].d));
        met++;
        near += b->status[i] > 0 && (b->t[i] - a->t[i]) * cosine < pixel * a->t[i];
    }
    return 4 * near >= 3 * met;
}

static int level_of(object *o, const scene *s, const view *v)
{
    sgt_ray *ray = room(NULL, RAYS * RAYS, sizeof *ray);
    answers *a = room(NULL, 1, sizeof *a), *b = room(NULL, 1, sizeof *b);
    for (int i = 0; i < RAYS * RAYS; i++) {
        const double x = (i % RAYS + 0.5) / RAYS * s->width, y = (i / RAYS + 0.5) / RAYS * s->height;
        const beam ahead = {.o = v->eye, .d = camera_direction(v, x, y), .far = HUGE_VAL};
        ray[i] = ray_in(o, &ahead);
    }
    int level = 2;
    ask_level(o, level, ray, a);
    for (; level < MOST_LEVELS; level++) {
        *iterations_of(o) = level + 1;
        if (!valid(o)) break; /* the derivative would leave the range of a double */
        ask_level(o, level + 1, ray, b);
        if (resolved(a, b, ray, length(v->right))) break;
        answers *first = a;
        a = b, b = first;
    }
    free(ray), free(a), free(b);
    return level;
}

void levels_choose(scene *s, const view *v, int *least, int *most)
{
    for (int i = 0; i < s->objects; i++) {
        object *o = &s->object[i];
        if (!o->automatic) continue;
        const int level = level_of(o, s, v);
        *iterations_of(o) = level;
        if (level < *least) *least = level;
        if (level > *most) *most = level;
    }
}

/* ------------------------------------------------------------------- traps */

static void product(const double a[4], const double b[4], double out[4])
{
    const double q[4] = {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
                         a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
                         a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
                         a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
    memcpy(out, q, sizeof q);
}

double levels_trap(const object *o, vec3 p, const double trap[4])
{
    const bool julia = o->surface.ops == &sgt_julia_ops;
    const sgt_julia *j = &o->own.julia;
    const sgt_mandelbrot *m = &o->own.mandelbrot;
    const double *at = julia ? j->at : m->at, *ex = julia ? j->ex : m->ex, *ey = julia ? j->ey : m->ey,
                 *ez = julia ? j->ez : m->ez;
    const int levels = julia ? j->iterations : m->iterations, power = julia ? j->power : m->power;
    double q[4], c[4], least = HUGE_VAL;
    bool plain = true;
    for (int k = 0; k < 4; k++) plain = plain && ex[k] == 0 && ey[k] == 0 && ez[k] == 0;
    for (int k = 0; k < 4; k++) {
        const double x = plain ? k == 0 : ex[k], y = plain ? k == 1 : ey[k], z = plain ? k == 2 : ez[k];
        q[k] = at[k] + p.x * x + p.y * y + p.z * z;
        c[k] = julia ? j->c[k] : q[k];
    }
    /* of a Mandelbrot set Q_1 is the point itself, which is where q is now */
    for (int n = julia ? 0 : 1; n <= (levels ? levels : 10); n++) {
        double far = 0, power_of[4];
        for (int k = 0; k < 4; k++) far += (q[k] - trap[k]) * (q[k] - trap[k]);
        if (n > 0 && far < least) least = far;
        memcpy(power_of, q, sizeof q);
        for (int i = 1; i < (power ? power : 2); i++) product(power_of, q, power_of);
        for (int k = 0; k < 4; k++) q[k] = power_of[k] + c[k];
    }
    return sqrt(least);
}
