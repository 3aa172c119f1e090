// SPDX-License-Identifier: MIT
/* march_f.h - the first part of a march over a level set with p = 2, in single precision.
 *
 * The cells of a march are mostly outside, or open because they are too long.  Floats say so as well as
 * doubles, and twice as many fit a register.  So a march begins with cells whose ends are floats, and goes
 * on in double where floats end.  One ray and a batch take the same cells.
 *
 * WHAT IS CLAIMED is that no root lies in an outside cell.  It is the test of orbit.h, in the formulas of
 * cell.h, with u = 2^-24 in place of 2^-53.  Nothing else is concluded in single precision.  In detail:
 *
 *     tau is in units of the power of two at or below 1 over along_size, so the user's units do not matter.
 *     The cell is [tau, end] about m with half its length h = max(m - tau, end - m), all floats.  h is off by
 *     u h at most.
 *     p = h v stands in place of v.  x = |<Q, p>| and y = |p|^2 are |qv| h and V2 h^2 of cell.h.
 *     Q and p at the first level: start, along, m along, h along and the sum are rounded once each.  Both
 *     together are off by less than 4 u (|start| + (|m| + h) |along|), beside what doubles add; 8 u is taken.
 *     A level: e' of cell.h.  Each term of it has a part in 10^5 to spare (the root 4e-5), which is 100 u and
 *     more.  Ten roundings need 10 u.
 *     Outside: all rounding is below 64 u (2 + E_1) A2, as in cell.h.  `keep` is 1 less that.
 *     E_k: over' = growth over is off by 34 u of itself at the last of 16 levels, and is begun 2^-18 too
 *     large; limit is 2^-19 too large.
 *     Underflow: e is begun 2^-80 too large, and grows by 2^-60 more at each level.  |along| is at least 1
 *     in these units, and |tau|, |start| at most 2^60; so what underflows is below 2^-85.  Overflow: e is
 *     infinite or NaN, and the cell is not outside.
 *
 * THE START is rounded down, so nothing before the first end is left out.  The end of the ray is rounded up.
 *
 * FLOATS END where a cell has to be looked at near the surface (it may be inside or monotone, or meet
 * t_tol).  They also end where h is not above 2^32 times the least.  The rounding of Q is then an eighth of
 * h v, at every level, because both grow alike.  With 2^30 to 2^34 the time is the same within 3 %.
 *
 * A march that has gone on in double stays there.  Going back to floats wherever the cells grow long enough
 * was tried: 4 to 10 % slower, because rays that pass near the surface go to and fro. */
#ifndef SGT_SURFACE_ORBIT_MARCH_F_H
#define SGT_SURFACE_ORBIT_MARCH_F_H

#include "course.h"

/* For a benchmark: a lane takes a level of the orbit.  It is busy with a cell that is not decided, or
 * idle. */
#ifndef SGT_COUNT_LEVEL
#define SGT_COUNT_LEVEL(busy) ((void)0)
#endif

enum { MOST_LEVELS = 16 };

/* The verdict on a cell:
 *
 *   LIVE   not decided
 *   OUT    outside
 *   CLOSE  to be looked at near the surface
 *
 * Any other verdict (NaN too) means none of these, and not monotone.  It is |Q_N|^2, or infinite where the
 * orbit escaped before.  IDLE: a lane without a ray. */
enum { IDLE = -4, LIVE, OUT, CLOSE };

/* What the rays of a set share.  fits: it is in range. */
typedef struct march_f {
    float a, b, c, d, limit, over, growth, keep, round, far, E2, levels, budget;
    bool fits;
} march_f;

static inline march_f march_f_of(const orbit *o, const path *w, double budget)
{
    const escape s = escape_of(o);
    const circle near = circle_of(w);
    return (march_f){.a = (float)w->c.a, .b = (float)w->c.b, .c = (float)w->c.c, .d = (float)w->c.d,
                     .limit = (float)(s.limit * (1 + 0x1p-19)), .over = (float)(s.over * (1 + 0x1p-18)),
                     .growth = (float)s.growth, .round = (float)(8 * 0x1p-24 * near.c_abs + 0x1p-60),
                     .keep = (float)(1 - 0x1p-18 * (2 + (s.limit + s.over))), .far = (float)near.far,
                     .E2 = (float)(o->E * o->E), .levels = (float)(o->iterations - first_level(w)),
                     .budget = (float)budget,
                     .fits = o->power == 2 && o->iterations <= MOST_LEVELS &&
                             (s.over == 0 || s.over >= 0x1p-100)};
}

/* A ray in its march. */
typedef struct ray_f {
    float sa, sb, sc, sd, la, lb, lc, ld, start_size, along_size, tau, hi, step, growth, side, evals, t_tol,
        least;
} ray_f;

/* x as a float, rounded down; and up. */
SGT_INLINE float float_below(double x)
{
    float near = (float)x, less = near - (fabsf(near) * 0x1p-23f + 0x1p-120f);
    return (double)near > x ? less : near;
}
SGT_INLINE float float_above(double x) { return -float_below(-x); }

/* The unit of tau here: the power of two at or below along_size, and 1 over it. */
typedef struct unit_f { double of, inverse; } unit_f;

SGT_INLINE unit_f unit_f_of(double along_size)
{
    double_bits of = {.x = along_size}, inverse;
    of.bits &= 0x7ff0000000000000ULL, inverse.bits = (2046ULL << 52) - of.bits;
    return (unit_f){of.x, inverse.x};
}

/* at: start and along of a path; size: start_size and along_size; k: the course in double.  If the ray is
 * out of range, tau is NaN, and no cell is laid. */
SGT_INLINE ray_f ray_f_of(const march_f *w, const quaternion at[2], const double size[2], course k,
                          double t_tol, double least)
{
    const unit_f unit = unit_f_of(size[1]);
    double lo = k.tau * unit.of, hi = k.hi * unit.of;
    bool fits = w->fits & (size[0] <= 0x1p60) & (size[1] >= 0x1p-1000) & (size[1] <= 0x1p1000) &
                (fabs(lo) <= 0x1p60) & (fabs(hi) <= 0x1p60);
    return (ray_f){.sa = (float)at[0].a, .sb = (float)at[0].b, .sc = (float)at[0].c, .sd = (float)at[0].d,
                   .la = (float)(at[1].a * unit.inverse), .lb = (float)(at[1].b * unit.inverse),
                   .lc = (float)(at[1].c * unit.inverse), .ld = (float)(at[1].d * unit.inverse),
                   .start_size = (float)size[0], .along_size = (float)(size[1] * unit.inverse),
                   .tau = fits ? float_below(lo) : (float)NAN, .hi = float_above(hi),
                   .step = (float)(k.h * unit.of), .growth = (float)k.growth, .side = 0, .evals = 0,
                   .t_tol = (float)(t_tol * unit.of),
                   .least = (float)(0x1p32 * (least * unit.of))};
}

/* Where floats have ended: from there the march goes on in double. */
SGT_INLINE course course_after(course k, const ray_f *r, double along_size)
{
    const double unit = unit_f_of(along_size).inverse;
    k.tau = r->side > 0 ? (double)r->tau * unit : k.tau, k.side = (double)r->side;
    k.h = r->evals > 0 ? (double)r->step * unit : k.h, k.growth = r->evals > 0 ? (double)r->growth : k.growth;
    return k;
}

/* A cell on its way, and what is known of it. */
typedef struct flight_f { float a, b, c, d, pa, pb, pc, pd, e, over, left, verdict; } flight_f;

/* A cell as laid.  odd: CLOSE if it is too short. */
typedef struct cell_f { float m, h, end, odd; } cell_f;

SGT_INLINE cell_f lay_f(float tau, float hi, float step)
{
    float rest = hi - tau, laid = 2 * step > rest ? 0.5f * rest : step, m = tau + laid, end = m + laid,
          before = m - tau, behind = end - m, odd = m > tau ? LIVE : CLOSE;
    return (cell_f){m, before > behind ? before : behind, end, end > m ? odd : CLOSE};
}

SGT_INLINE flight_f begin_f(const ray_f *r, const march_f *w, float m, float h, float odd)
{
    return (flight_f){.a = r->sa + m * r->la, .b = r->sb + m * r->lb, .c = r->sc + m * r->lc,
                      .d = r->sd + m * r->ld, .pa = h * r->la, .pb = h * r->lb, .pc = h * r->lc,
                      .pd = h * r->ld,
                      .e = 8 * 0x1p-24f * (r->start_size + (fabsf(m) + h) * r->along_size) + 0x1p-80f,
                      .over = w->over, .left = w->levels, .verdict = odd};
}

/* Near 1 / sqrt(x): HALF_WAY of cell.h, for floats. */
SGT_INLINE float guess_f(float x)
{
    union { float x; unsigned bits; } guess = {.x = x};
    guess.bits = 0x5f375a86U - (guess.bits >> 1);
    return guess.x;
}

/* Takes a cell one level further, and judges the level before.  first: the cell as it began, for the
 * Mandelbrot set. */
SGT_INLINE void on_a_level_f(flight_f *s, const flight_f *first, const march_f *w, bool mandelbrot)
{
    SGT_COUNT_LEVEL(s->verdict == LIVE);
    float A2 = (s->a * s->a + s->b * s->b) + (s->c * s->c + s->d * s->d),
          y = (s->pa * s->pa + s->pb * s->pb) + (s->pc * s->pc + s->pd * s->pd),
          qp = (s->a * s->pa + s->b * s->pb) + (s->c * s->pc + s->d * s->pd);
    float r = guess_f(A2), xr = A2 * r, A = xr * (3 * 1.0018f - 1.0018f * (xr * r)); /* 2 A as a bound */
    float x = fabsf(qp), T = (w->limit + s->over) + s->e, more = x - y;
    more = more > 0 ? more : 0;
    float room = (A2 * w->keep - (x + more)) - T * T;
    /* What `judge` has to look at, or nearly so. */
    float last = x > (float)STEEP * y ? CLOSE : A2;
    last = (A2 + y) + (x + x) < w->E2 ? CLOSE : last;
    float verdict = A2 > w->far ? HUGE_VALF : LIVE;
    verdict = s->left > 0 ? verdict : last;
    verdict = room > 0 ? OUT : verdict;
    s->verdict = s->verdict == LIVE ? verdict : s->verdict;
    s->e = ((A + 5.001f * s->e) * s->e + 1.2501f * y) + (16 * 0x1p-24f * A2 + w->round);
    float two_a = s->a + s->a, two_pa = s->pa + s->pa, turned = two_a * s->pa - qp;
    float ca = mandelbrot ? first->a : w->a, cb = mandelbrot ? first->b : w->b,
          cc = mandelbrot ? first->c : w->c, cd = mandelbrot ? first->d : w->d;
    s->pa = turned + turned;
    s->pb = two_a * s->pb + two_pa * s->b, s->pc = two_a * s->pc + two_pa * s->c,
    s->pd = two_a * s->pd + two_pa * s->d;
    s->a = (two_a * s->a - A2) + ca, s->b = two_a * s->b + cb;
    s->c = two_a * s->c + cc, s->d = two_a * s->d + cd;
    if (mandelbrot) {
        s->e += first->e;
        s->pa += first->pa, s->pb += first->pb, s->pc += first->pc, s->pd += first->pd;
    }
    s->over *= w->growth, s->left -= 1;
}

SGT_INLINE float grown_f(float growth)
{
    growth *= growth < 1.19f ? 1.08f : 1.15f;
    return growth < 2 ? growth : 2;
}

SGT_INLINE float shrunk_f(float growth)
{
    float less = 0.8f * growth;
    less = less < 1.2f ? less : 1.2f;
    return less > 0.7f ? less : 0.7f;
}

/* Floats end at an open cell with h up to this. */
SGT_INLINE float shortest_f(float verdict, float side, float t_tol, float least, float E2)
{
    float wanted = side * (E2 - verdict) > 0 ? t_tol : 0; /* `decide` may call it ACROSS */
    return wanted > least ? wanted : least;
}

#endif
