// SPDX-License-Identifier: MIT
/* orbit.h - quaternion orbits Q_{j+1} = Q_j^p + c, their level sets |Q_N| = E, and what can be said of one
 * over a stretch of a ray.
 *
 * POWERS.  Let Q = a + q with q imaginary.  Powers of Q commute with Q, so Q^i = s_i + f_i q with real s,
 * f:
 *     s_{i+1} = a s_i - |q|^2 f_i,   f_{i+1} = s_i + a f_i,   s_1 = a, f_1 = 1.
 * This is the complex product in the plane of 1 and q.  Along v = va + vq the product rule also gives s'
 * and f', with |q|^2' = 2 <q, vq> and (Q^p)' = s' + f' q + f vq.  For p = 2:
 *     Q^2 = a^2 - |q|^2 + 2 a q,   Q v + v Q = 2 (a va - <q, vq>) + 2 (a vq + va q).
 *
 * WHO ESCAPES.  R* is the positive root of x^p = x + |c|.  For |Q| > R*, |Q^p + c| >= |Q|^p - |c| > |Q|,
 * so the orbit grows from there on.  Hence, for E >= R*, with E_N = E and E_k = max(R*, (E_{k+1} +
 * |c|)^(1/p)):
 *     |Q_k| > E_k at some k implies |Q_N| > E.
 * For the Mandelbrot set c is the point.  R* and E_k are then those of B, a bound on |c| over the whole
 * stretch: B = max(2^(1/(p-1)), E).  Beyond B, |Q_1| = |c| grows past every bound that E sets: |Q|^p - |c|
 * >= |Q| (|Q|^(p-1) - 1) >= |Q| for |Q| >= |c|.
 *
 * A CELL is a stretch [m - h, m + h].  Over it carry, level by level, Q and v = dQ/dtau at m as computed,
 * and bounds
 *     |Q(m + s) - Q - v s| <= e,   |dQ/dtau (m + s) - v| <= d,   for |s| <= h.
 * Let A = |Q|, V = |v|, D = V h + e, so |Q(m + s) - Q| <= D.  Taylor's formula for x^p with x = A + D
 * gives
 *     |(Q + x)^p - Q^p - L x| <= p (p - 1) / 2 (A + D)^(p-2) D^2
 *         (L x is the linear part, |L x| <= p A^(p-1) |x|),
 *     e' = p A^(p-1) e + p (p - 1) / 2 (A + D)^(p-2) D^2,
 *     d' = p (A + D)^(p-1) d + p (p - 1) (A + D)^(p-2) D V.
 * For a product of p factors, each at most A + D, changes by at most that if one factor changes.  For p =
 * 2 these are e' = V^2 h^2 + 2 (A + V h) e + e^2 and d' = 2 ((V h + e) V + (A + V h + e) d).  For the
 * Mandelbrot set c(m + s) is added to Q'.  It is linear in s, and adds to v only.
 *
 * ROUNDING, with u = 2^-53.  A computed power is off by at most 16 p u (A^p + |c|), and its derivative by
 * 96 p^2 u A^(p-1) V.  For p = 2 the bounds are 8 u (A^2 + |c|) and 16 u A V.  (s and n f, n = |q|, are
 * rotated and stretched by exactly A at each step, so errors grow no faster than the powers.)  Both go
 * into e and d; the second also goes, times h, into e.
 *
 * VERDICTS.
 *     outside    min over |s| <= h of |Q + v s| > E_k + e at some level k.
 *     inside     max(|Q - v h|, |Q + v h|) + e < E at level N.  (A convex function is largest at an end.)
 *     monotone   |<Q, v>| > V^2 h + e V + (A + D) d = W at level N.  Then d|Q|^2/dtau keeps its sign, and
 *                lies between 2 (|<Q, v>| - W) and 2 (|<Q, v>| + W).
 * The first test leaves the orbit early.  The third needs d.  It is computed only when asked for, from the
 * stored A, V and e.  The sums of e and d round too, by less than 2^-40 in a hundred levels of ten
 * operations.  The last comparison allows for that.
 *
 * MORE THAN 100 LEVELS.  A, V and e are not stored then.  They are worked out a second time where d is asked
 * for, with d beside them.  Of E_k the last SGT_KEPT levels are stored.  Before them it is that of the first
 * one stored: E_N <= 2^20 is above R* >= 1, and each level back at least halves the difference.  So a hundred
 * levels back it is R* to the last bit.
 *     The sums of e and d round at each level.  So each level enlarges them by UP, 2^-46: more than its
 * roundings, some 60 u.
 *     Over so many levels the derivative may leave the range of a double.  If it overflows, V is infinite or
 * NaN, and e and d with it.  Every comparison fails, and the cell is open.  If V^2 underflows, |v| is below
 * 2^-511, and terms of d are lost.  So d is computed with V >= LEAST_SPEED.
 *
 * Sources: Hart, Sandin, Kauffman 1989 (SIGGRAPH Computer Graphics 23, 289) for the orbit and its
 * derivative; Moore 1966, Interval Analysis, for inclusion by a mean value form. */
#ifndef SGT_SURFACE_ORBIT_ORBIT_H
#define SGT_SURFACE_ORBIT_ORBIT_H

#include "../../num/exact.h"
#include <sagitta/surfaces.h>

/* The largest number of iterations; and of how many levels numbers are kept. */
enum { SGT_LEVELS = 10000, SGT_KEPT = 100 };

typedef struct quaternion { double a, b, c, d; } quaternion;

/* A level set, checked, with its defaults filled in. */
typedef struct orbit {
    quaternion c, at, x, y, z;
    double at_length, x_length, y_length, z_length;
    double c_abs;        /* |c|, rounded up; for the Mandelbrot set its bound B */
    double E, E_err;     /* the escape, and how far it may be from the root it stands for */
    double safe;         /* R* */
    double stretch;      /* p R*^(p-1); for the Mandelbrot set with B for R* */
    int iterations, power;
    bool mandelbrot;
} orbit;

/* Fill in *o.  Return the first invalid parameter, or {NULL, NULL}. */
sgt_objection sgt_orbit_of_julia(const void *s, orbit *o);
sgt_objection sgt_orbit_of_mandelbrot(const void *s, orbit *o);

SGT_INLINE double quaternion_dot(quaternion p, quaternion q)
{
    return (p.a * q.a + p.b * q.b) + (p.c * q.c + p.d * q.d);
}

SGT_INLINE quaternion quaternion_sum(quaternion p, quaternion q)
{
    return (quaternion){p.a + q.a, p.b + q.b, p.c + q.c, p.d + q.d};
}

SGT_INLINE quaternion quaternion_times(quaternion q, double r)
{
    return (quaternion){q.a * r, q.b * r, q.c * r, q.d * r};
}

/* at + x ex + y ey + z ez. */
SGT_INLINE quaternion quaternion_at(const orbit *o, double x, double y, double z)
{
    return (quaternion){
        o->at.a + x * o->x.a + y * o->y.a + z * o->z.a, o->at.b + x * o->x.b + y * o->y.b + z * o->z.b,
        o->at.c + x * o->x.c + y * o->y.c + z * o->z.c, o->at.d + x * o->x.d + y * o->y.d + z * o->z.d};
}

/* Q^p = s + f q, and the derivatives of s and f along v. */
typedef struct power_of { double s, f, ds, df; } power_of;

SGT_INLINE power_of power_along(quaternion q, quaternion v, int power)
{
    double n2 = q.b * q.b + (q.c * q.c + q.d * q.d), half_dn2 = q.b * v.b + (q.c * v.c + q.d * v.d);
    if (power == 2) return (power_of){q.a * q.a - n2, 2 * q.a, 2 * (q.a * v.a - half_dn2), 2 * v.a};
    power_of r = {q.a, 1, v.a, 0};
    for (int i = 1; i < power; i++)
        r = (power_of){q.a * r.s - n2 * r.f, r.s + q.a * r.f,
                       (v.a * r.s + q.a * r.ds) - (2 * half_dn2 * r.f + n2 * r.df),
                       r.ds + (v.a * r.f + q.a * r.df)};
    return r;
}

/* The same without v. */
SGT_INLINE power_of power_only(quaternion q, int power)
{
    double n2 = q.b * q.b + (q.c * q.c + q.d * q.d);
    if (power == 2) return (power_of){q.a * q.a - n2, 2 * q.a, 0, 0};
    power_of r = {q.a, 1, 0, 0};
    for (int i = 1; i < power; i++) r = (power_of){q.a * r.s - n2 * r.f, r.s + q.a * r.f, 0, 0};
    return r;
}

/* One level: Q to Q^p + c, and v to its derivative (plus dc for the Mandelbrot set). */
SGT_INLINE void orbit_step(quaternion *q, quaternion *v, quaternion c, quaternion dc, int power,
                           bool mandelbrot)
{
    power_of r = power_along(*q, *v, power);
    *v = (quaternion){r.ds, r.f * v->b + r.df * q->b, r.f * v->c + r.df * q->c, r.f * v->d + r.df * q->d};
    *q = (quaternion){r.s + c.a, r.f * q->b + c.b, r.f * q->c + c.c, r.f * q->d + c.d};
    if (mandelbrot) *v = quaternion_sum(*v, dc);
}

/* x^n for 0 <= n <= 7. */
SGT_INLINE double small_power(double x, int n)
{
    double r = 1;
    for (; n > 0; n--) r *= x;
    return r;
}

/* e of the next level, from A, V and e of this one. */
SGT_INLINE double next_e(double A, double V, double e, double h, double c_abs, int power)
{
    double D = V * h + e;
    if (power == 2) return (2 * A * e + D * D) + (8 * SGT_U * (A * A + c_abs) + 16 * SGT_U * h * A * V);
    double below = small_power(A, power - 2), P = power;
    double bend = 0.5 * P * (P - 1) * small_power(A + D, power - 2) * (D * D);
    return (P * below * A * e + bend) +
           (16 * P * SGT_U * (below * A * A + c_abs) + 96 * P * P * SGT_U * below * A * V * h);
}

/* An orbit along a ray: its point at tau is start + tau along. */
typedef struct path {
    quaternion start, along, c;
    double start_size, along_size;   /* sums of the magnitudes of their terms */
    double c_abs, E, E_err;
    double escape[SGT_KEPT + 1];     /* E_k of level before + k, rounded up */
    int iterations, power;
    int before;                      /* levels before those that are kept: N - SGT_KEPT, or 0 */
    bool mandelbrot;
} path;

/* The first level: Q_0, or Q_1 = c. */
SGT_INLINE int first_level(const path *w) { return w->mandelbrot ? 1 : 0; }

/* The first level that is kept. */
SGT_INLINE int first_kept(const path *w) { return w->before ? w->before : first_level(w); }

/* E_k of level k, and of the first level. */
SGT_INLINE double escape_at(const path *w, int k) { return w->escape[k > w->before ? k - w->before : 0]; }
SGT_INLINE double first_escape(const path *w) { return w->escape[w->before ? 0 : first_level(w)]; }

/* By what e and d of a level are enlarged, and the least V for d ("more than 100 levels"). */
#define UP (1 + 0x1p-46)
#define LEAST_SPEED 0x1p-450

typedef enum cell_verdict { CELL_OPEN, CELL_OUTSIDE, CELL_INSIDE, CELL_MONOTONE } cell_verdict;

typedef struct cell {
    cell_verdict verdict;
    int level;                /* N, or less if the orbit was left before */
    double A2, V2, qv, e;     /* at level N, and only there: |Q|^2, |v|^2, <Q, v>, the bound e */
    /* The bound W above.  Infinite if it was not computed, as where the orbit was left. */
    double W;
    double g_err;             /* with W: how far |Q|^2 - E^2 at m may be off */
} cell;

/* What can be said of cell 0 over [m - h, m + h], and of up to three more that the march may need next.
 * r[i] is set if known[i] is.
 *
 *   1  needed if 0 is outside or inside
 *   2  needed if 1 is too
 *   3  needed if 0 is open */
void sgt_orbit_cells(const path *w, const double m[4], const double h[4], cell r[4], bool known[4]);

/* The same for one cell. */
void sgt_orbit_cell(const path *w, double m, double h, cell *r);

/* Is the cell monotone?  Needs little of the stack. */
bool sgt_orbit_monotone(const path *w, double m, double h);

/* F and its derivative over [m - h, m + h].  If nothing is known of the slope, it is infinite. */
sgt_interval sgt_orbit_enclose(const path *w, double m, double h, sgt_interval *slope);

/* F = (u - 1) / (u + 1) with u = |Q_N|^2 / E^2, at m, and its derivative. */
double sgt_orbit_value(const path *w, double m, double *slope);

#endif
