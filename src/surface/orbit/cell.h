// SPDX-License-Identifier: MIT
/* cell.h - the formulas of a cell (orbit.h), for one lane or many.  For p = 2 the numbers may be doubles
 * or vectors of doubles.  The verdict at level N is for one cell of any power.
 *
 * E WITHOUT A ROOT.  No square root of V2 is needed on the way, because 2 V h e <= V^2 h^2 / 4 + 4 e^2:
 *     (V h + e)^2 <= 5/4 V^2 h^2 + 5 e^2    and    16 u h A V <= 8 u (A^2 + h^2 V^2).
 * Let A2 = |Q|^2 and qv = <Q, v>.  Then a^2 - |q|^2 = 2 a^2 - A2 and a va - <q, vq> = 2 a va - qv.  A2 is
 * off by 3 u A^2 and qv by 3 u A V; the bounds of orbit.h include that.  An upper bound of 2 A is needed.
 * twice_root is one: it is too large by at most 0.4 %, and by at least 4e-5.  5/4 and 5 are taken as
 * 1.2501 and 5.001.  So every term of e has a part in 10^5 of slack, which covers the rounding of its sum
 * at each level.
 *
 * OUTSIDE.  |Q + v s|^2 = A2 + 2 qv s + V2 s^2 over |s| <= h.  Let x = |qv| h and y = V2 h^2.  The least
 * value is A2 - 2 x + y if x >= y, else A2 - x^2 / y >= A2 - x.  In both cases it is at least A2 - (x +
 * max(x - y, 0)).
 *
 * If that is above (E_k + e)^2, then y <= (2 R* + 1)^2 A2.  At level 0 the ball bounds y.  Later sqrt(y')
 * <= 2 sqrt(A2 y) <= A2 + y, where y < e' < A' and A2 <= A' + |c| (or y' = 0).  So all rounding, 12 u (A2
 * + A sqrt(y)) and less, is below 2^-47 (2 + R*) A2.  `keep` is 1 less that. */
#ifndef SGT_SURFACE_ORBIT_CELL_H
#define SGT_SURFACE_ORBIT_CELL_H

#include "orbit.h"

typedef union double_bits { double x; unsigned long long bits; } double_bits;

/* Newton's step toward 1 / sqrt(x) ends below it.  The start is within 3.43 % (the well-known constant,
 * for doubles: Lomont 2003), and the result within 0.18 %. */
#define HALF_WAY 0x5fe6eb50c7b537a9ULL
SGT_INLINE void one_guess(const double *x, double *r)
{
    double_bits guess = {.x = *x};
    guess.bits = HALF_WAY - (guess.bits >> 1);
    *r = guess.x;
}
SGT_INLINE void one_magnitude(const double *x, double *r) { *r = fabs(*x); }
SGT_INLINE void one_positive(const double *x, double *r) { *r = *x > 0 ? *x : 0; }

/* What the cells of a set share: |c|; 8 u |c|, the rounding of a step; `keep` of the head; and `far`, a
 * bound on |Q|^2 beyond which an open cell is of no use. */
typedef struct circle { double c_abs, round, keep, far; } circle;

/* Defines `name`, a cell at one of its levels, for numbers of type `real`.  `room` is positive if it is
 * outside. */
#define SGT_SQUARES(name, real)                                                                          \
    typedef struct name {                                                                                \
        real a, b, c, d, va, vb, vc, vd, e, A2, V2, qv;                                                  \
    } name;                                                                                              \
    typedef struct name##_constant {                                                                     \
        real a, b, c, d, extra;                                                                          \
    } name##_constant;                                                                                   \
    SGT_INLINE void name##_norms(name *s)                                                                \
    {                                                                                                    \
        s->A2 = (s->a * s->a + s->b * s->b) + (s->c * s->c + s->d * s->d);                               \
        s->V2 = (s->va * s->va + s->vb * s->vb) + (s->vc * s->vc + s->vd * s->vd);                       \
        s->qv = (s->a * s->va + s->b * s->vb) + (s->c * s->vc + s->d * s->vd);                           \
    }                                                                                                    \
    SGT_INLINE void name##_twice_root(const real *x, real *root)                                         \
    {                                                                                                    \
        real r, xr;                                                                                      \
        name##_guess(x, &r);                                                                             \
        xr = *x * r;                                                                                     \
        *root = xr * (3 * 1.0018 - 1.0018 * (xr * r));                                                   \
    }                                                                                                    \
    SGT_INLINE void name##_room(const name *s, double keep, const real *E, const real *x, const real *y, \
                                real *room)                                                              \
    {                                                                                                    \
        real T = *E + s->e, more = *x - *y;                                                              \
        name##_positive(&more, &more);                                                                   \
        *room = (s->A2 * keep - (*x + more)) - T * T;                                                    \
    }                                                                                                    \
    /* to the next level; 2 A as a bound, y = V2 h^2 */                                                  \
    SGT_INLINE void name##_step(name *s, const real *A_twice, const real *y, double round,               \
                                const name##_constant *c, bool mandelbrot)                               \
    {                                                                                                    \
        real two_a = s->a + s->a, two_va = s->va + s->va, turned = two_a * s->va - s->qv;                \
        s->e = ((*A_twice + 5.001 * s->e) * s->e + 1.2501 * *y) + (16 * SGT_U * s->A2 + round);          \
        if (mandelbrot) s->e += c->extra;                                                                \
        s->va = turned + turned;                                                                         \
        s->vb = two_a * s->vb + two_va * s->b, s->vc = two_a * s->vc + two_va * s->c,                    \
        s->vd = two_a * s->vd + two_va * s->d;                                                           \
        s->a = (two_a * s->a - s->A2) + c->a, s->b = two_a * s->b + c->b;                                \
        s->c = two_a * s->c + c->c, s->d = two_a * s->d + c->d;                                          \
    }                                                                                                    \
    /* d and the error of Q at the middle, likewise, from 2 A, V2, e of the level before */            \
    SGT_INLINE void name##_slope(const real *A_twice, const real *V2, const real *e, const real *h,      \
                                 double round, real *d, real *center)                                    \
    {                                                                                                    \
        real V, D, A = 0.5 * *A_twice;                                                                   \
        name##_twice_root(V2, &V);                                                                       \
        V *= 0.5, D = V * *h + *e;                                                                       \
        *d = 2 * (D * V + (A + D) * *d) + 16 * SGT_U * A * V;                                            \
        *center = (*A_twice + *center) * *center + (8 * SGT_U * (A * A) + round);                        \
    }

SGT_SQUARES(one, double)

/* For no more levels than are kept. */
static inline circle circle_of(const path *w)
{
    double most = 0;
    for (int k = w->mandelbrot ? 1 : 0; k < w->iterations; k++) most = larger(most, w->escape[k]);
    /* If the middle of a cell is so far outside that |Q|^2 > 3 E_k^2, and the cell is not outside as a
     * whole, it will not be outside at a later level either: its bounds grow as fast.  Only time depends
     * on the 3 (1.2: 15 % more cells; 64: 3 % more levels). */
    return (circle){w->c_abs, 8 * SGT_U * w->c_abs, 1 - 0x1p-47 * (2 + w->escape[w->mandelbrot ? 1 : 0]),
                    3 * most * most};
}

/* ----------------------------------------------------------------- at level N */

typedef struct pair_norms { double A2, V2, qv; } pair_norms;

/* A cell is monotone if |<Q, v>| > V2 h + e V + (A + D) d (orbit.h).  To know d takes a second pass over the
 * levels (judge_slope).  So it is asked for only if |<Q, v>| > STEEP V2 h + e V: a cell that is less steep
 * is seldom monotone, and of little use if it is.  Observed: with 1 the evaluations are as many as with 3,
 * but a third more cells are examined for their slope; 4 does as well as 3. */
#define STEEP 3.0

/* At level N.  Returns 1 if the cell is inside.  Returns 2 if W and g_err are wanted: the cell may be
 * monotone, or g may be near its rounding. */
SGT_INLINE double judge(double E, double E_err, pair_norms at, double V, double e, double h)
{
    double slack = 1 + 0x1p-38, room = (E - E_err) * (1 - 0x1p-50) - e * slack, qv = fabs(at.qv),
           least = STEEP * (at.V2 * h) + e * V;
    double asked = qv > least ? 2 : 0,
           inside = (at.A2 + at.V2 * h * h + 2 * qv * h) * (1 + 64 * SGT_U) < room * room ? 1 : 0;
    asked = (qv + least) * h <= 0x1p-30 * at.A2 ? 2 : asked;
    inside = room > 0 ? inside : 0;
    return inside > 0 ? 1 : asked;
}

typedef struct orbit_bounds { double W, g_err; } orbit_bounds;

/* The errors of a cell at level N: e and d of orbit.h; center: the bound on the error of Q at m. */
typedef struct orbit_errors {
    double e, d, center;
} orbit_errors;

/* W and g_err. */
SGT_INLINE orbit_bounds judge_slope(double E, double E_err, pair_norms at, double A, double V,
                                    orbit_errors by, double h)
{
    const double e = by.e, d = by.d, center = by.center;
    double D = V * h + e, slack = 1 + 0x1p-38;
    return (orbit_bounds){(at.V2 * h + e * V + (A + D) * d) * slack + 16 * SGT_U * A * V,
                          ((2 * A + center) * center) * slack + 8 * SGT_U * at.A2 +
                              4 * (E + E_err) * (E_err + SGT_U * E)};
}

/* What a cell at level N says of a root:
 *
 *   lo, hi  if the cell is monotone, the root is in m + [lo, hi]
 *   newton  Newton's step: m - newton.  It is F / F' of F = tanh(log(|Q_N| / E)), which is nearly linear
 *           where |Q_N|^2 is not
 *   wide    by what part of itself the slope varies, per unit of length */
typedef struct sighting { double lo, hi, newton, wide; } sighting;

SGT_INLINE sighting sight(double E2, double A2, double qv, double W, double g_err, double h)
{
    double g = A2 - E2, size = fabs(g), steep = fabs(qv), slack = 1 + 0x1p-48, least = size - g_err;
    double far = (size + g_err) / (2 * (steep - W)) * slack, near = least / (2 * (steep + W)) * (1 - 0x1p-48);
    near = least > 0 ? near : -far; /* on either side */
    double behind = g > 0 ? -qv : qv;
    return (sighting){behind > 0 ? near : -far, behind > 0 ? far : -near, g * (A2 + E2) / (4 * E2 * qv),
                      W / (steep * h)};
}

SGT_INLINE sighting sight_of(double E2, const cell *e, double h)
{
    return sight(E2, e->A2, e->qv, e->W, e->g_err, h);
}

SGT_INLINE double place_error(double start_size, double along_size, double m, double h)
{
    return 8 * SGT_U * (start_size + (fabs(m) + h) * along_size);
}

#endif
