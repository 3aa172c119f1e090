// SPDX-License-Identifier: MIT
/* end_error.h - what rounding at one element does to the end of a ray: the formulas of aim_bound.c, for one
 * ray (aim_bound.c) and in loops over rays (error_batch.c).
 *
 * They have no branches but those that an element decides for all rays alike. */
#ifndef SGT_SYSTEM_END_ERROR_H
#define SGT_SYSTEM_END_ERROR_H
#include "chain.h"

SGT_INLINE double size_of(sgt_vec3 a) { return sqrt(dot(a, a)); }

/* Rows x and y of derivatives of two numbers at the end: how long (x . v, y . v) is at most for a v of unit
 * length.  The square of that is the larger eigenvalue of the matrix of xx, xy, yy (products of the rows).
 * It is at most the larger of xx and yy, and |xy| besides (Gershgorin); and at most xx + yy.  two: there is
 * a row y. */
SGT_INLINE double longest_of(bool two, sgt_vec3 x, sgt_vec3 y)
{
    if (!two) return size_of(x);
    const double xx = dot(x, x), yy = dot(y, y), xy = fabs(dot(x, y));
    const double most = xx > yy ? xx : yy, least = xx > yy ? yy : xx; /* a NaN stays one */
    return sqrt(most + (xy < least ? xy : least));
}

/* What is known of a surface's gradient. */
typedef enum gradient_kind { GRADIENT_OF_CONIC, GRADIENT_OF_ASPHERE, GRADIENT_OF_OTHER } gradient_kind;

SGT_INLINE gradient_kind gradient_kind_of(sgt_surface s) /* with the operations of the set */
{
    if (s.ops == &sgt_conic_ops) return GRADIENT_OF_CONIC;
    return s.ops == &sgt_even_asphere_ops ? GRADIENT_OF_ASPHERE : GRADIENT_OF_OTHER;
}

/* How far the gradient is off across itself.  n2 and n: its square and its length, by_n = 1 / n; a: of
 * GRADIENT_OF_ASPHERE. */
SGT_INLINE double of_gradient(gradient_kind kind, const sgt_even_asphere *a, sgt_vec3 p, sgt_vec3 normal,
                              double n2, double n, double by_n)
{
    if (kind == GRADIENT_OF_CONIC) {
        const double across = sqrt(normal.x * normal.x + normal.y * normal.y);
        return SGT_U * across * (2 + 4 * (1 + fabs(1 - normal.z)) * by_n);
    }
    if (kind == GRADIENT_OF_OTHER) return 64 * SGT_U * n * (normal.z == 1 ? n2 : 1);
    const double r2 = p.x * p.x + p.y * p.y, r = sqrt(r2), w = (1 + a->k) * a->c * a->c * r2;
    double terms = 16 * fabs(a->a[7]);
    terms = terms * r2 + 14 * fabs(a->a[6]);
    terms = terms * r2 + 12 * fabs(a->a[5]);
    terms = terms * r2 + 10 * fabs(a->a[4]);
    terms = terms * r2 + 8 * fabs(a->a[3]);
    terms = terms * r2 + 6 * fabs(a->a[2]);
    terms = terms * r2 + 4 * fabs(a->a[1]);
    terms = terms * r2 + 2 * fabs(a->a[0]);
    return SGT_U * (8 * (1 + fabs(w) / (1 - w)) * fabs(a->c) * r / sqrt(1 - w) + 22 * terms * r);
}

/* How far the direction behind is off, for the gradient and the direction in front as they are.  With q the
 * sum of both cosines, the sine is |d' x n| / n:
 *
 *     sine (|f| n (6 + (6 r + 2 + 6 n / |S|) / q) + n / |S|) = |d' x n| (|f| (6 + ...) + 1 / |S|).
 *
 * by_q: 1 / q. */
SGT_INLINE double of_bending(chain_link c, double n, double by_q)
{
    const double f = fabs(c.f), by_S = fabs(c.by_S), part = 6 + (6 * c.r + 2 + 6 * n * by_S) * by_q;
    const sgt_vec3 cross = cross_product(c.after, c.n);
    return SGT_U * (c.r + f * n + 3 + size_of(cross) * (f * part + by_S));
}

/* Both, of an element that bends. */
typedef struct bend_off { double bending, gradient; } bend_off;

/* With Q = q n, one quotient gives 1 / n and 1 / q = n / Q. */
SGT_INLINE bend_off bend_off_of(gradient_kind kind, const sgt_even_asphere *a, chain_link c)
{
    const double n2 = dot(c.n, c.n), n = sqrt(n2);
    const double Q = c.r * fabs(dot(c.d, c.n)) + fabs(dot(c.after, c.n)) + DBL_MIN; /* not 0: no 0 / 0 */
    const double by = 1 / (n * Q);
    return (bend_off){of_bending(c, n, n2 * by), of_gradient(kind, a, c.p, c.n, n2, n, Q * by)};
}

/* The adjoints of one number at the end, of the direction behind an element, and the step to the front; or
 * of two, x and y, if there are two. */
typedef struct error_steps { bool two; sgt_vec3 direction[2]; chain_step by[2]; } error_steps;

/* What the rounding at one element adds to the error of a number at the end, or of a point, as far as points,
 * frames and bending go.
 *
 *     bends, phased  those of the link; constants, where it is in a loop
 *     turns      the direction behind has a say in it
 *     turned     the element's frame is
 *     off        as above; read if the element bends */
SGT_INLINE double of_element(bool bends, bool phased, chain_link c, bool turns, bool turned, double p_err,
                             bend_off off, error_steps s)
{
    const double frame = 8 * SGT_U;
    const chain_step x = s.by[0], y = s.by[1];
    const sgt_vec3 point = s.two ? x.in.p : plus_times(x.in.p, x.x.opl * c.n1, c.d);
    double sum = longest_of(s.two, point, y.in.p) * p_err;
    if (turned && (turns || phased)) sum += longest_of(s.two, x.front, y.front) * frame;
    if (!turns) return sum;
    const double size = turned || bends ? longest_of(s.two, s.direction[0], s.direction[1]) : 0;
    if (turned) sum += size * frame;
    return bends ? sum + size * off.bending + longest_of(s.two, x.in.n, y.in.n) * off.gradient : sum;
}

/* What a phase in waves adds to that (waves.h). */
SGT_INLINE double of_waves(const sgt_element *e, const chain_link *c, bool turns, double p_err, error_steps s)
{
    const waves_slopes *at = &c->by_waves;
    if (c->passed != 1) return turns ? (double)NAN : 0;
    const bool facets = is_faceted(c->waves);
    const double per_wave = facets ? 0 : fabs(c->waves->per_wave);
    const waves_off off = sgt_waves_off(c->waves, c->p, p_err, at->at);
    const double path =
        facets && s.by[0].x.opl != 0 ? (double)NAN : fabs(s.by[0].x.opl) * per_wave * (off.w + off.g * p_err);
    if (!turns) return path;
    const sgt_surface surface = chain_surface(e->surface);
    const double n2 = dot(c->n, c->n), n = sqrt(n2), m = size_of(at->m);
    const double u = per_wave * off.g + 8 * SGT_U * (c->n1 + size_of(at->G));
    const double direction = u * m / (c->n2 * fabs(dot(c->after, at->m))) + 4 * SGT_U;
    const double size = longest_of(s.two, s.direction[0], s.direction[1]);
    if (facets) return path + size * (direction + fabs(c->f) * off.g * (1 + m * fabs(c->by_S)));
    double gradient = of_gradient(gradient_kind_of(surface), surface.self, c->p, c->n, n2, n, 1 / n);
    if (sgt_has_kinks(surface)) gradient = larger(gradient, sgt_kink_off(surface, c->p, p_err, c->n));
    return path + size * direction + longest_of(s.two, s.by[0].in.n, s.by[1].in.n) * gradient;
}

/* What a phase adds to that. */
SGT_INLINE double of_phase(const sgt_element *e, const chain_link *c, bool turns, double p_err, error_steps s)
{
    if (c->waves) return of_waves(e, c, turns, p_err, s);
    const phase_off off = phase_off_of(e->phase, c->n1, c->n2, c->p, c->d);
    const double size = longest_of(s.two, s.direction[0], s.direction[1]);
    return (turns ? size * off.direction : 0) + (c->passed == 1 ? fabs(s.by[0].x.opl) * off.path : 0);
}

/* What an ulp of each number of the launch ray does to a number at the end; index: in front of all. */
SGT_INLINE double of_launch(chain_back back, double index, sgt_vec3 o, sgt_vec3 d, unit_launch from)
{
    const sgt_vec3 by = plus_times(back.p, back.opl * index, from.d);
    return 2 * SGT_U * (size_of(by) * absolute(o) + size_of(back.d) * absolute(d) / from.length);
}

/* The error of a point, with what the second order may add. */
SGT_INLINE double of_point(double first_order) { return 1.5 * first_order; }

/* ------------------------------------------------------------------------ the path */

/* A point in global axes. */
typedef struct far_point {
    twofold x, y, z;
} far_point;

SGT_INLINE twofold far_number(twofold sum, sgt_vec3 p, double ex, double ey, double ez)
{
    sum = twofold_sum(sum, two_product(p.x, ex));
    sum = twofold_sum(sum, two_product(p.y, ey));
    return twofold_sum(sum, two_product(p.z, ez));
}

SGT_INLINE far_point far_point_of(const sgt_pose *pose, bool turned, sgt_vec3 p)
{
    const sgt_vec3 c = pose->origin, ex = pose->ex, ey = pose->ey, ez = pose->ez;
    if (!turned) return (far_point){two_sum(c.x, p.x), two_sum(c.y, p.y), two_sum(c.z, p.z)};
    return (far_point){far_number(twofold_of(c.x), p, ex.x, ey.x, ez.x),
                       far_number(twofold_of(c.y), p, ex.y, ey.y, ez.y),
                       far_number(twofold_of(c.z), p, ex.z, ey.z, ez.z)};
}

/* Within 2 u^2 (|a| + |b|): the upper parts exactly, one rounding of what is left. */
SGT_INLINE twofold far_between(twofold a, twofold b)
{
    const twofold s = two_sum(a.hi, -b.hi);
    return quick_two_sum(s.hi, s.lo + (a.lo - b.lo));
}

/* What is summed has one sign but for the lower parts, so that plain sums of these are enough: the square is
 * within 16 u^2 of itself, for the differences as they are.  Its root is s + (square - s^2) / 2 s, where the
 * upper parts of the difference cancel exactly.  With far_between the length is within 16 u^2 of itself and
 * of the numbers of the points. */
SGT_INLINE twofold length_between(far_point a, far_point b)
{
    const twofold x = far_between(a.x, b.x), y = far_between(a.y, b.y), z = far_between(a.z, b.z);
    const twofold xx = two_product(x.hi, x.hi), yy = two_product(y.hi, y.hi), zz = two_product(z.hi, z.hi);
    const twofold two = two_sum(zz.hi, xx.hi), all = two_sum(two.hi, yy.hi);
    const double twice = 2 * (x.hi * x.lo + y.hi * y.lo + z.hi * z.lo);
    const twofold square = quick_two_sum(all.hi, (two.lo + all.lo) + (xx.lo + yy.lo + zz.lo) + twice);
    const double s = sqrt(square.hi);
    const twofold own = two_product(s, s);
    const double rest = ((square.hi - own.hi) - own.lo) + square.lo;
    const twofold root = quick_two_sum(s, rest / (2 * s));
    return square.hi > 0 ? root : twofold_of(0);
}

/* The path with a stretch of length `by`, which is travelled backwards if t < 0. */
SGT_INLINE twofold path_with(twofold path, twofold by, double n1, double t)
{
    return twofold_sum(path, twofold_scaled(by, t < 0 ? -n1 : n1));
}

/* How far rounding moves that sum: 16 u^2 of the length and of the numbers of both points, 6 u^2 of the
 * sum.  The numbers of the other point are at most those of this one and the length, three times: 2^-100,
 * which is 64 u^2, covers it. */
SGT_INLINE double of_sum(twofold path, twofold by, double n1, far_point to)
{
    const double numbers = fabs(to.x.hi) + fabs(to.y.hi) + fabs(to.z.hi);
    return 0x1p-100 * (fabs(path.hi) + n1 * (by.hi + numbers));
}

/* |n d - n' d'| p_err; 0 if there is no direction behind. */
SGT_INLINE double of_kick(double n1, double n2, sgt_vec3 d, sgt_vec3 after, double p_err)
{
    const double off = size_of(plus_times(times(n1, d), -n2, after)) * p_err;
    return is_zero(after) ? 0 : off;
}

/* The told error of a path, with what the sum of its parts rounds (2^-53 at each element). */
SGT_INLINE double told_path(double off) { return off * (1 + 0x1p-45); }

/* What the axes of a turned frame do to lengths. */
SGT_INLINE double of_axes(sgt_vec3 p, double n1, double n2) { return 8 * SGT_U * size_of(p) * (n1 + n2); }

#endif
