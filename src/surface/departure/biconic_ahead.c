// SPDX-License-Identifier: MIT
/* biconic_ahead.c - biconic.c, looked along by polynomials (ahead.c).
 *
 * With N = c_x x^2 + c_y y^2, Q = A x^2 + B y^2 and phi = sqrt(1 - Q), F = 0 is z (1 + phi) = N.  So it is z
 * phi = N - z, whence
 *     G = N^2 - 2 N z + z^2 Q = 0,    Q <= 1,    z (N - z) >= 0.
 * G is of degree 4 in t; 1 - Q, N - z and z tell where F has no root.
 *
 * A CYLINDER, and a conic.  Where Q = b N with a number b (one axis is flat, or the two are alike), phi is 1
 * - b z, and
 *     G = N + b z^2 - 2 z = 0,    b z <= 1.
 * b = (1 + k) c is computed with an error of 2 u of it, which is one of the 2^9 of ahead.c. */
#include "ahead.h"

typedef struct biconic_way {
    double b;             /* of a cylinder or a conic */
    double c[2], bent[2]; /* c and A, of x and y */
    const sgt_ahead *ray;
    ahead_quadratics g; /* up to t^2; then t^3 and t^4 */
    ahead_row g3, g4, m3, m4;
    ahead_quadratics bend, n, rest, inside; /* n: N; rest: N - z; inside: 1 - Q */
} biconic_way;

SGT_INLINE ahead_quadratic height_of(const sgt_ahead *e, size_t i)
{
    return ahead_linear(e->o[2][i], e->d[2][i]);
}

/* ------------------------------------------------------------- a cylinder or a conic */

SGT_KERNEL
static void plain_at(const void *self, size_t from, size_t n, const double *t, ahead_looks *restrict out)
{
    const biconic_way *w = self;
    LANES for (size_t i = from; i < n; i++)
    {
        const ahead_quadratic g = ahead_quadratic_of(&w->g, i);
        const double far = fabs(t[i]);
        out->g[i] = ahead_value(g, t[i]), out->err[i] = ahead_off(g, far);
        out->slope[i] = 2 * g.c2 * t[i] + g.c1;
        out->slope_err[i] = AHEAD_LOST * (2 * g.m2 * far + g.m1) + AHEAD_LEAST;
    }
}

SGT_KERNEL
static void plain_over(const void *self, size_t first, size_t n, const double *from, const double *to,
                       ahead_overs *restrict out)
{
    const biconic_way *w = self;
    const double b = w->b;
    LANES for (size_t i = first; i < n; i++)
    {
        const ahead_quadratic g = ahead_quadratic_of(&w->g, i);
        const sgt_interval z = ahead_range(height_of(w->ray, i), from[i], to[i]);
        const double off = 2 * (AHEAD_LOST * g.m2 + AHEAD_LEAST);
        out->none[i] = chosen(MASK(smaller(b * z.lo, b * z.hi) > 1 + 0x1p-40), 1, 0);
        out->g_lo[i] = -HUGE_VAL, out->g_hi[i] = HUGE_VAL;
        out->bend_lo[i] = 2 * g.c2 - off, out->bend_hi[i] = 2 * g.c2 + off;
    }
}

SGT_KERNEL
static void plain_tail(const void *self, size_t first, size_t n, const double *t, const double *sign,
                       double *restrict none)
{
    const biconic_way *w = self;
    const double b = w->b;
    LANES for (size_t i = first; i < n; i++)
    {
        const ahead_quadratic z = height_of(w->ray, i);
        const mask keeps = MASK(sign[i] != 0) & ahead_keeps(ahead_quadratic_of(&w->g, i), t[i], sign[i]),
                   over = MASK(b * z.c1 >= 0) &
                          MASK(b * ahead_value(z, t[i]) - fabs(b) * ahead_off(z, fabs(t[i])) > 1 + 0x1p-40);
        none[i] = chosen(keeps | over, 1, 0);
    }
}

/* THE START.  A plain G is -(1 - b z + phi) F, and phi = 1 - b z at a root.  The other is
 *     G = -K F,    K = (1 + phi) (2 s phi - (1 - phi) F),
 * as N = s (1 + phi) and Q = 1 - phi^2; and there s = z.  The terms are |x s_x| + |y s_y| + |z|. */
SGT_KERNEL
static void plain_start(const void *self, size_t first, size_t n, const double *t, const double *f,
                        const double *least, ahead_starts *restrict out)
{
    const biconic_way *w = self;
    const double curved = w->b, b = fabs(curved);
    LANES for (size_t i = first; i < n; i++)
    {
        const double height = w->ray->o[2][i] + t[i] * w->ray->d[2][i], fall = fabs(w->ray->d[2][i]),
                     at = 1 - curved * height, K = 2 * at + b * f[i] + 0x1p-40,
                     width = f[i] * K / least[i] * (1 + 0x1p-20);
        const sgt_interval p = ahead_about(at, b * fall * width + 0x1p-40),
                           z = ahead_about(height, fall * width),
                           N = ahead_range(ahead_quadratic_of(&w->n, i), t[i], t[i] + width);
        out->width[i] = chosen(MASK(at > 0) & MASK(p.lo > 0), width, (double)NAN);
        out->ratio[i] = K / (2 * p.lo);
        out->terms[i] = larger(larger(N.lo, -N.hi), 0) / p.hi + z.lo;
    }
}

/* ----------------------------------------------------------------------- a biconic */

SGT_KERNEL
static void biconic_way_at(const void *self, size_t first, size_t n, const double *t,
                           ahead_looks *restrict out)
{
    const biconic_way *w = self;
    LANES for (size_t i = first; i < n; i++)
    {
        const ahead_quadratic p = ahead_quadratic_of(&w->g, i);
        const double x = t[i], far = fabs(x), c3 = w->g3[i], c4 = w->g4[i], m3 = w->m3[i], m4 = w->m4[i];
        out->g[i] = (((c4 * x + c3) * x + p.c2) * x + p.c1) * x + p.c0;
        out->slope[i] = ((4 * c4 * x + 3 * c3) * x + 2 * p.c2) * x + p.c1;
        out->err[i] = AHEAD_LOST * ((((m4 * far + m3) * far + p.m2) * far + p.m1) * far + p.m0) + AHEAD_LEAST;
        out->slope_err[i] =
            AHEAD_LOST * (((4 * m4 * far + 3 * m3) * far + 2 * p.m2) * far + p.m1) + AHEAD_LEAST;
    }
}

SGT_KERNEL
static void biconic_way_over(const void *self, size_t first, size_t n, const double *from, const double *to,
                             ahead_overs *restrict out)
{
    const biconic_way *w = self;
    LANES for (size_t i = first; i < n; i++)
    {
        const double a = from[i], b = to[i];
        const sgt_interval z = ahead_range(height_of(w->ray, i), a, b),
                           rest = ahead_range(ahead_quadratic_of(&w->rest, i), a, b),
                           in = ahead_range(ahead_quadratic_of(&w->inside, i), a, b),
                           bend = ahead_range(ahead_quadratic_of(&w->bend, i), a, b);
        const mask none =
            (MASK(z.lo > 0) & MASK(rest.hi < 0)) | (MASK(z.hi < 0) & MASK(rest.lo > 0)) | MASK(in.hi < 0);
        out->none[i] = chosen(none, 1, 0);
        out->g_lo[i] = -HUGE_VAL, out->g_hi[i] = HUGE_VAL;
        out->bend_lo[i] = bend.lo, out->bend_hi[i] = bend.hi;
    }
}

/* Has G the sign, or is it 0, at t and beyond it?  As ahead_keeps. */
SGT_INLINE mask quartic_keeps(const biconic_way *w, size_t i, double t, double sign)
{
    double c0 = w->g.c0[i], c1 = w->g.c1[i], c2 = w->g.c2[i], c3 = w->g3[i], c4 = w->g4[i], m0 = w->g.m0[i],
           m1 = w->g.m1[i], m2 = w->g.m2[i], m3 = w->m3[i], m4 = w->m4[i], far = fabs(t);
    c3 += t * c4, c2 += t * c3, c1 += t * c2, c0 += t * c1;
    c3 += t * c4, c2 += t * c3, c1 += t * c2;
    c3 += t * c4, c2 += t * c3;
    c3 += t * c4;
    m3 += far * m4, m2 += far * m3, m1 += far * m2, m0 += far * m1;
    m3 += far * m4, m2 += far * m3, m1 += far * m2;
    m3 += far * m4, m2 += far * m3;
    m3 += far * m4;
    return ahead_signed(c0, m0, sign) & ahead_signed(c1, m1, sign) & ahead_signed(c2, m2, sign) &
           ahead_signed(c3, m3, sign) & ahead_signed(c4, m4, sign);
}

SGT_KERNEL
static void biconic_way_tail(const void *self, size_t first, size_t n, const double *t, const double *sign,
                             double *restrict none)
{
    const biconic_way *w = self;
    LANES for (size_t i = first; i < n; i++)
    {
        const ahead_quadratic z = height_of(w->ray, i), rest = ahead_quadratic_of(&w->rest, i);
        const double at = ahead_value(z, t[i]), side = copysign(1, at);
        const mask keeps = MASK(sign[i] != 0) & quartic_keeps(w, i, t[i], sign[i]),
                   beyond = MASK(fabs(at) > ahead_off(z, fabs(t[i]))) & ahead_keeps(z, t[i], side) &
                            MASK(-side * ahead_value(rest, t[i]) > 0) & ahead_keeps(rest, t[i], -side);
        none[i] = chosen(keeps | beyond, 1, 0);
    }
}

/* |x s_x|, at least: s_x = x (2 c + A s / phi) / (1 + phi). */
SGT_INLINE double least_term(double c, double A, double at, double phi, sgt_interval z, double low,
                             double high, double o, double d, double t, double width)
{
    const double by = A * at / phi,
                 off = fabs(A) * (z.hi / low - z.lo / high) + 0x1p-40 * (fabs(c) + fabs(by));
    const sgt_interval p = ahead_about(o + t * d, fabs(d) * width + 0x1p-40 * fabs(t * d));
    return larger(fabs(2 * c + by) - off, 0) * (p.lo * p.lo) / (1 + high);
}

SGT_KERNEL
static void biconic_way_start(const void *self, size_t first, size_t n, const double *t, const double *f,
                              const double *least, ahead_starts *restrict out)
{
    const biconic_way *w = self;
    const sgt_ahead *e = w->ray;
    const double cx = w->c[0], cy = w->c[1], A = w->bent[0], B = w->bent[1];
    LANES for (size_t i = first; i < n; i++)
    {
        const ahead_quadratic inside = ahead_quadratic_of(&w->inside, i);
        const double at = e->o[2][i] + t[i] * e->d[2][i], size = fabs(at), in = ahead_value(inside, t[i]),
                     phi = sqrt(larger(in, 0)),
                     K = (1 + phi) * (2 * (size + f[i]) * phi + fabs(1 - phi) * f[i]) * (1 + 0x1p-16),
                     width = f[i] * K / least[i] * (1 + 0x1p-20);
        const sgt_interval D = ahead_range(inside, t[i], t[i] + width),
                           z = ahead_about(at, fabs(e->d[2][i]) * width);
        const double low = sqrt(larger(D.lo, 0)) * (1 - 0x1p-40),
                     high = sqrt(larger(D.hi, 0)) * (1 + 0x1p-40);
        /* of four conditions at once gcc makes branches */
        const mask within = MASK(D.lo > 0x1p-12) & MASK(z.lo > 0),
                   begins = MASK(in > 0x1p-10) & MASK(size > 0);
        out->width[i] = chosen(begins, chosen(within, width, (double)NAN), (double)NAN);
        out->ratio[i] = K / (2 * z.lo * low * (1 + low));
        out->terms[i] = z.lo + least_term(cx, A, at, phi, z, low, high, e->o[0][i], e->d[0][i], t[i], width) +
                        least_term(cy, B, at, phi, z, low, high, e->o[1][i], e->d[1][i], t[i], width);
    }
}

/* ------------------------------------------------------------------- where it begins */

SGT_KERNEL
static void plain_begin(biconic_way *restrict w, size_t n, sgt_ahead *restrict e)
{
    const double cx = w->c[0], cy = w->c[1], b = w->b;
    LANES for (size_t i = 0; i < n; i++)
    {
        const ahead_quadratic x2 = ahead_square(e->o[0][i], e->d[0][i]),
                              y2 = ahead_square(e->o[1][i], e->d[1][i]),
                              z2 = ahead_square(e->o[2][i], e->d[2][i]), z = height_of(e, i),
                              N = ahead_sum(ahead_scaled(x2, cx), ahead_scaled(y2, cy));
        ahead_quadratic_put(&w->n, i, N);
        ahead_quadratic_put(&w->g, i, ahead_sum(ahead_sum(N, ahead_scaled(z2, b)), ahead_scaled(z, -2)));
        /* a t behind which F is on the other sheet */
        double over = (1 / b - z.c0) / z.c1;
        over += 0x1p-20 * (fabs(over) + fabs(z.c0 / z.c1) + fabs(e->from[i]));
        const mask ends = MASK(b * z.c1 > 0) & MASK(over > e->from[i]) & MASK(over < e->to[i]) &
                          MASK(b * ahead_value(z, over) - fabs(b) * ahead_off(z, fabs(over)) > 1 + 0x1p-40);
        e->to[i] = chosen(ends, over, e->to[i]);
    }
}

SGT_KERNEL
static void biconic_way_begin(biconic_way *restrict w, size_t n, sgt_ahead *restrict e)
{
    const double cx = w->c[0], cy = w->c[1], A = w->bent[0], B = w->bent[1];
    LANES for (size_t i = 0; i < n; i++)
    {
        const ahead_quadratic x2 = ahead_square(e->o[0][i], e->d[0][i]),
                              y2 = ahead_square(e->o[1][i], e->d[1][i]),
                              z2 = ahead_square(e->o[2][i], e->d[2][i]), z = height_of(e, i),
                              N = ahead_sum(ahead_scaled(x2, cx), ahead_scaled(y2, cy)),
                              q = ahead_sum(ahead_scaled(x2, A), ahead_scaled(y2, B)),
                              m = ahead_sum(N, ahead_scaled(z, -2)),
                              inside = ahead_sum((ahead_quadratic){1, 0, 0, 1, 0, 0}, ahead_scaled(q, -1));
        ahead_quadratic_put(&w->rest, i, ahead_sum(N, ahead_scaled(z, -1)));
        ahead_quadratic_put(&w->inside, i, inside);
        /* N (N - 2 z) + z^2 Q */
        const ahead_quadratic g = {
            N.c0 * m.c0 + z2.c0 * q.c0,
            (N.c0 * m.c1 + N.c1 * m.c0) + (z2.c0 * q.c1 + z2.c1 * q.c0),
            (N.c0 * m.c2 + N.c1 * m.c1 + N.c2 * m.c0) + (z2.c0 * q.c2 + z2.c1 * q.c1 + z2.c2 * q.c0),
            N.m0 * m.m0 + z2.m0 * q.m0,
            (N.m0 * m.m1 + N.m1 * m.m0) + (z2.m0 * q.m1 + z2.m1 * q.m0),
            (N.m0 * m.m2 + N.m1 * m.m1 + N.m2 * m.m0) + (z2.m0 * q.m2 + z2.m1 * q.m1 + z2.m2 * q.m0)};
        const double c3 = (N.c1 * m.c2 + N.c2 * m.c1) + (z2.c1 * q.c2 + z2.c2 * q.c1),
                     m3 = (N.m1 * m.m2 + N.m2 * m.m1) + (z2.m1 * q.m2 + z2.m2 * q.m1),
                     c4 = N.c2 * m.c2 + z2.c2 * q.c2, m4 = N.m2 * m.m2 + z2.m2 * q.m2;
        ahead_quadratic_put(&w->g, i, g);
        w->g3[i] = c3, w->g4[i] = c4, w->m3[i] = m3, w->m4[i] = m4;
        ahead_quadratic_put(&w->bend, i,
                            (ahead_quadratic){2 * g.c2, 6 * c3, 12 * c4, 2 * g.m2, 6 * m3, 12 * m4});
        /* a t behind which F is not defined */
        const double c = inside.c2, root = sqrt(larger(inside.c1 * inside.c1 - 4 * c * inside.c0, 0));
        double end = (-inside.c1 - root) / (2 * c);
        end += 0x1p-20 * (fabs(end) + fabs(e->from[i]));
        const mask ends =
            MASK(c < 0) & MASK(end > e->from[i]) & MASK(end < e->to[i]) & ahead_keeps(inside, end, -1);
        e->to[i] = chosen(ends, end, e->to[i]);
    }
}

void sgt_biconic_ahead(const departure_sag *s, size_t n, sgt_ahead *e)
{
    static const ahead_ops ops = {biconic_way_at, biconic_way_over, biconic_way_tail, biconic_way_start},
                           plain_ops = {plain_at, plain_over, plain_tail, plain_start};
    const sgt_biconic *b = s->self;
    const double bx = (1 + b->k_x) * b->c_x, by = (1 + b->k_y) * b->c_y;
    const bool plain = b->c_x == 0 || b->c_y == 0 || (b->c_x == b->c_y && b->k_x == b->k_y);
    const size_t rows = ahead_rows(n);
    biconic_way w;
    w.b = b->c_x != 0 ? bx : by, w.ray = e;
    w.c[0] = b->c_x, w.c[1] = b->c_y, w.bent[0] = bx * b->c_x, w.bent[1] = by * b->c_y;
    if (plain)
        plain_begin(&w, rows, e);
    else
        biconic_way_begin(&w, rows, e);
    ahead_drop_unusual(b->c_x, b->c_y, rows, e);
    sgt_look_ahead(plain ? &plain_ops : &ops, &w, n, 1, e);
}
