// SPDX-License-Identifier: MIT
/* float_march.c - see float_march.h.  A ray to a lane of vector registers; a lane whose ray has ended takes
 * the next.
 *
 * The step is |Q| log(|Q| / E) / (2 |Q'|), |Q'| = 2^n |Q_0| ... |Q_{n-1}| (Hart, Sandin, Kauffman 1989), as
 * the rule `stop` of march_rules.h has it in double precision, one ray at a time.  No sign is looked at,
 * and no gradient given. */
#include "float_march.h"

#include <math.h>

#if defined(HAVE_CLONES)
#define CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define CLONES
#endif

enum { LANES = 32, MOST_STEPS = 10000 };
#define FAR 256.0f /* of |Q|^2: beyond it the estimate hardly changes */

typedef struct lanes {
    float o[3][LANES], d[3][LANES], t[LANES], end[LANES], away[LANES];
    size_t ray[LANES];
    int steps[LANES];
} lanes;

/* x > 0: the exponent, and 2 atanh((m - 1) / (m + 1)) of the rest, 1 <= m < 2, to 2e-6. */
static inline float log_of(float x)
{
    union { float x; unsigned bits; } u = {.x = x};
    float exponent = (float)(int)(u.bits >> 23) - 127;
    u.bits = (u.bits & 0x7fffff) | 0x3f800000;
    float z = (u.x - 1) / (u.x + 1), z2 = z * z;
    return 0.69314718f * exponent +
           2 * z * (1 + z2 * (1 / 3.0f + z2 * (1 / 5.0f + z2 * (1 / 7.0f + z2 * (1 / 9.0f)))));
}

/* One step of each lane. */
CLONES static void step(lanes *s, const float c[4], float E2, int iterations)
{
    float x[LANES], y[LANES], z[LANES], w[LANES], A2[LANES], growth2[LANES];
    const float ca = c[0], cb = c[1], cc = c[2], cd = c[3];
#pragma omp simd
    for (int l = 0; l < LANES; l++) {
        float t = s->t[l];
        x[l] = s->o[0][l] + t * s->d[0][l], y[l] = s->o[1][l] + t * s->d[1][l],
        z[l] = s->o[2][l] + t * s->d[2][l], w[l] = 0;
        A2[l] = x[l] * x[l] + y[l] * y[l] + z[l] * z[l], growth2[l] = 1;
    }
    for (int k = 0; k < iterations; k++) {
#pragma omp simd
        for (int l = 0; l < LANES; l++) {
            float qa = x[l], qb = y[l], qc = z[l], qd = w[l], A = A2[l], g = growth2[l];
            float a = qa * qa - (qb * qb + qc * qc + qd * qd) + ca, twice = 2 * qa;
            float b = twice * qb + cb, c_ = twice * qc + cc, d = twice * qd + cd,
                  next = a * a + b * b + c_ * c_ + d * d;
            x[l] = A < FAR ? a : qa, y[l] = A < FAR ? b : qb, z[l] = A < FAR ? c_ : qc,
            w[l] = A < FAR ? d : qd;
            A2[l] = A < FAR ? next : A, growth2[l] = A < FAR ? 4 * A * g : g;
        }
    }
#pragma omp simd
    for (int l = 0; l < LANES; l++) {
        float u = A2[l] / E2, away = 0.25f * log_of(u) * sqrtf(A2[l] / growth2[l]);
        s->away[l] = u > 1 ? away : 0;
    }
}

void float_march(const sgt_julia *s, size_t n, const float *const o[3], const float *const d[3], float eps,
                 float t[])
{
    const float c[4] = {(float)s->c[0], (float)s->c[1], (float)s->c[2], (float)s->c[3]};
    const float E2 = (float)(s->escape * s->escape);
    lanes now = {.t = {0}};
    size_t next = 0;
    for (int l = 0; l < LANES; l++) now.ray[l] = n, now.end[l] = -1;
    for (;;) {
        int busy = 0;
        for (int l = 0; l < LANES; l++) {
            if (now.ray[l] < n) {
                bool met = now.away[l] < eps,
                     on = !met && now.t[l] + now.away[l] < now.end[l] && ++now.steps[l] < MOST_STEPS;
                if (on) now.t[l] += now.away[l];
                else t[now.ray[l]] = met ? now.t[l] : NAN, now.ray[l] = n;
            }
            for (; now.ray[l] == n && next < n; next++) { /* the ball of radius E */
                float a = o[0][next], b = o[1][next], e = o[2][next], u = d[0][next], v = d[1][next],
                      w = d[2][next];
                float middle = -(a * u + b * v + e * w),
                      half2 = middle * middle - (a * a + b * b + e * e - E2);
                float half = half2 >= 0 ? sqrtf(half2) : -1;
                t[next] = NAN;
                if (half < 0 || middle + half < 0) continue;
                now.o[0][l] = a, now.o[1][l] = b, now.o[2][l] = e, now.d[0][l] = u, now.d[1][l] = v,
                now.d[2][l] = w;
                now.t[l] = middle - half > 0 ? middle - half : 0, now.end[l] = middle + half;
                now.ray[l] = next, now.steps[l] = 0;
            }
            busy += now.ray[l] < n;
        }
        if (!busy) return;
        step(&now, c, E2, s->iterations);
    }
}
