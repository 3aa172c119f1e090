// SPDX-License-Identifier: MIT
/* leave.c - transport of particles: a million crossings of a torus, and none is lost.
 *
 * Particles go through a thin torus.  At each crossing they go straight on; at every tenth they are
 * scattered into a new direction; those that fly away are turned back.  No particle is pushed by an epsilon:
 * sgt_leave_batch drops the root it starts at, and says on which side of the surface the particle flies.  So
 * one that was lost would show: its side would not be the other one behind the next crossing. */
#include <sagitta/surfaces.h>

#include <math.h>
#include <stdint.h>
#include <stdio.h>

enum { N = 1000, CROSSINGS = 1000000 };

static uint64_t seed = 7;

/* From -1 to 1 (splitmix64). */
static double number(void)
{
    uint64_t z = seed += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-52 - 1;
}

static sgt_vec3 direction(void)
{
    for (;;) {
        double x = number(), y = number(), z = number(), r = sqrt(x * x + y * y + z * z);
        if (r > 0.01 && r < 1) return (sgt_vec3){x / r, y / r, z / r};
    }
}

/* The particles: the crossing each comes from, where it goes, and what is met next. */
static double p[3][N], n[3][N], p_err[N], d[3][N];
static double next_p[3][N], next_n[3][N], next_err[N];
static sgt_status status[N];
static signed char side[N];
static int inside[N]; /* where it flies: -1 in the tube, 1 outside, 0: not known */

static void set(double a[3][N], size_t i, sgt_vec3 v) { a[0][i] = v.x, a[1][i] = v.y, a[2][i] = v.z; }

/* From the middle of the tube to its wall. */
static void start(sgt_surface torus, size_t i)
{
    sgt_vec3 a = direction(), way = direction();
    double r = sqrt(a.x * a.x + a.y * a.y);
    sgt_hit hit = sgt_intersect(torus, (sgt_ray){.o = {139 * a.x / r, 139 * a.y / r, 0}, .d = way}, NULL);
    set(p, i, hit.p), set(n, i, hit.n), set(d, i, way);
    p_err[i] = hit.p_err, inside[i] = 0;
}

int main(void)
{
    const sgt_torus shape = {.major = 139, .minor = 1};
    const sgt_surface torus = {&sgt_torus_ops, &shape};
    long crossings = 0, turned = 0, undecided = 0, lost = 0;
    for (size_t i = 0; i < N; i++) start(torus, i);
    const sgt_starts from = {
        .p = {p[0], p[1], p[2]}, .n = {n[0], n[1], n[2]}, .p_err = p_err, .d = {d[0], d[1], d[2]}};
    const sgt_hits hits = {.status = status,
                           .p = {next_p[0], next_p[1], next_p[2]},
                           .n = {next_n[0], next_n[1], next_n[2]},
                           .p_err = next_err};
    while (crossings < CROSSINGS) {
        sgt_leave_batch(torus, N, from, hits, side, NULL);
        for (size_t i = 0; i < N; i++) {
            if (status[i] < 0) { /* a tangent */
                undecided++, start(torus, i);
                continue;
            }
            lost += inside[i] * side[i] < 0;
            if (status[i] == SGT_MISS) { /* it flies away: turned back, it comes through the same point */
                turned++;
                for (int k = 0; k < 3; k++) d[k][i] = -d[k][i];
                inside[i] = -side[i];
                continue;
            }
            crossings++;
            for (int k = 0; k < 3; k++) p[k][i] = next_p[k][i], n[k][i] = next_n[k][i];
            p_err[i] = next_err[i];
            inside[i] = status[i] == SGT_HIT ? -side[i] : side[i]; /* a graze changes no side */
            if (crossings % 10 == 0) set(d, i, direction()), inside[i] = 0;
        }
    }
    printf("%ld crossings, %ld turned back: %ld lost, %ld undecided\n", crossings, turned, lost, undecided);
    return lost > 0 || undecided > 1;
}
