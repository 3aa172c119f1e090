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
#include "../../num/bits.h"
#include "ahead.h"

typedef struct biconic_way {
    bool plain; /* a cylinder or a conic */
    double b;
    double o[2], d[2], c[2], bent[2];       /* of the start: x and y, c and A */
    ahead_poly g, bend, z, n, rest, inside; /* n: N; rest: N - z; inside: 1 - Q */
} biconic_way;

static ahead_poly square_of(double o, double d)
{
    ahead_poly p = ahead_linear(o, d);
    return ahead_product(&p, &p);
}

static ahead_look biconic_way_at(const void *w, double t)
{
    return sgt_ahead_poly_at(&((const biconic_way *)w)->g, t);
}

static bool biconic_way_off(const void *self, double from, double to)
{
    const biconic_way *w = self;
    sgt_interval z = sgt_ahead_poly_over(&w->z, from, to);
    if (w->plain) return smaller(w->b * z.lo, w->b * z.hi) > 1 + 0x1p-40;
    if (z.lo <= 0 && z.hi >= 0) return false;
    sgt_interval rest = sgt_ahead_poly_over(&w->rest, from, to);
    return z.lo > 0 ? rest.hi < 0 : rest.lo > 0;
}

static ahead_over biconic_way_over(const void *self, double from, double to)
{
    const biconic_way *w = self;
    bool none = biconic_way_off(w, from, to);
    if (!w->plain && !none) none = sgt_ahead_poly_over(&w->inside, from, to).hi < 0;
    sgt_interval all = {-HUGE_VAL, HUGE_VAL};
    return (ahead_over){all, none ? all : sgt_ahead_poly_over(&w->bend, from, to), none};
}

static bool biconic_way_tail(const void *self, double t, double sign)
{
    const biconic_way *w = self;
    if (sign != 0 && sgt_ahead_poly_keeps(&w->g, t, sign)) return true;
    const ahead_look z = sgt_ahead_poly_at(&w->z, t);
    if (w->plain) return w->b * w->z.c[1] >= 0 && w->b * z.g - fabs(w->b) * z.err > 1 + 0x1p-40;
    const double side = z.g > 0 ? 1 : -1;
    return fabs(z.g) > z.err && sgt_ahead_poly_keeps(&w->z, t, side) &&
           -side * sgt_ahead_poly_at(&w->rest, t).g > 0 && sgt_ahead_poly_keeps(&w->rest, t, -side);
}

/* THE START.  A plain G is -(1 - b z + phi) F, and phi = 1 - b z at a root.  The other is
 *     G = -K F,    K = (1 + phi) (2 s phi - (1 - phi) F),
 * as N = s (1 + phi) and Q = 1 - phi^2; and there s = z.  The terms are |x s_x| + |y s_y| + |z|. */
static bool plain_start(const biconic_way *w, double t, double f, double least, ahead_start *out)
{
    const double b = fabs(w->b), at = 1 - w->b * (w->z.c[0] + t * w->z.c[1]), K = 2 * at + b * f + 0x1p-40;
    out->width = f * K / least * (1 + 0x1p-20);
    const sgt_interval p = ahead_about(at, b * fabs(w->z.c[1]) * out->width + 0x1p-40),
                       z = ahead_about(w->z.c[0] + t * w->z.c[1], fabs(w->z.c[1]) * out->width),
                       n = sgt_ahead_poly_over(&w->n, t, t + out->width);
    out->ratio = K / (2 * p.lo);
    out->terms = larger(larger(n.lo, -n.hi), 0) / p.hi + z.lo;
    return at > 0 && p.lo > 0;
}

static bool biconic_way_start(const void *self, double t, double f, double least, ahead_start *out)
{
    const biconic_way *w = self;
    if (w->plain) return plain_start(w, t, f, least, out);
    const double at = w->z.c[0] + t * w->z.c[1], size = fabs(at);
    const ahead_look in = sgt_ahead_poly_at(&w->inside, t);
    if (!(in.g > 0x1p-10 && size > 0)) return false;
    double phi = sqrt(in.g), K = (1 + phi) * (2 * (size + f) * phi + fabs(1 - phi) * f) * (1 + 0x1p-16);
    out->width = f * K / least * (1 + 0x1p-20);
    const sgt_interval D = sgt_ahead_poly_over(&w->inside, t, t + out->width),
                       z = ahead_about(at, fabs(w->z.c[1]) * out->width);
    if (!(D.lo > 0x1p-12 && z.lo > 0)) return false;
    const double low = sqrt(D.lo) * (1 - 0x1p-40), high = sqrt(D.hi) * (1 + 0x1p-40);
    out->ratio = K / (2 * z.lo * low * (1 + low));
    out->terms = z.lo;
    for (int j = 0; j < 2; j++) {
        const double c = w->c[j], A = w->bent[j], by = A * at / phi,
                     off = fabs(A) * (z.hi / low - z.lo / high) + 0x1p-40 * (fabs(c) + fabs(by));
        const sgt_interval p =
            ahead_about(w->o[j] + t * w->d[j], fabs(w->d[j]) * out->width + 0x1p-40 * fabs(t * w->d[j]));
        out->terms += larger(fabs(2 * c + by) - off, 0) * (p.lo * p.lo) / (1 + high);
    }
    return true;
}

/* A t behind which F is not defined, or is on the other sheet, if that is before `to`. */
static double biconic_way_ends(const biconic_way *w, double from, double to)
{
    if (w->plain) {
        double over = (1 / w->b - w->z.c[0]) / w->z.c[1];
        over += 0x1p-20 * (fabs(over) + fabs(w->z.c[0] / w->z.c[1]) + fabs(from));
        return w->b * w->z.c[1] > 0 && over > from && over < to && biconic_way_off(w, over, over) ? over : to;
    }
    const double *c = w->inside.c;
    if (!(c[2] < 0)) return to;
    double end = (-c[1] - sqrt(c[1] * c[1] - 4 * c[2] * c[0])) / (2 * c[2]);
    end += 0x1p-20 * (fabs(end) + fabs(from));
    return end > from && end < to && sgt_ahead_poly_keeps(&w->inside, end, -1) ? end : to;
}

sgt_ahead_kind sgt_biconic_ahead(const departure_sag *s, const sgt_ray *ray, sgt_ahead *ahead)
{
    static const ahead_ops ops = {biconic_way_at, biconic_way_over, biconic_way_off, biconic_way_tail,
                                  biconic_way_start};
    const sgt_biconic *b = s->self;
    if (!ahead_usual(ray, b->c_x, b->c_y)) return AHEAD_OPEN;
    const double bx = (1 + b->k_x) * b->c_x, by = (1 + b->k_y) * b->c_y;
    const ahead_poly x2 = square_of(ray->o.x, ray->d.x), y2 = square_of(ray->o.y, ray->d.y),
                     n = ahead_sum(ahead_scaled(x2, b->c_x), ahead_scaled(y2, b->c_y));
    biconic_way w = {.o = {ray->o.x, ray->o.y},
                     .d = {ray->d.x, ray->d.y},
                     .c = {b->c_x, b->c_y},
                     .bent = {bx * b->c_x, by * b->c_y},
                     .z = ahead_linear(ray->o.z, ray->d.z),
                     .n = n};
    w.plain = b->c_x == 0 || b->c_y == 0 || (b->c_x == b->c_y && b->k_x == b->k_y);
    if (w.plain) {
        w.b = b->c_x != 0 ? bx : by;
        w.g =
            ahead_sum(ahead_sum(n, ahead_scaled(square_of(ray->o.z, ray->d.z), w.b)), ahead_scaled(w.z, -2));
    } else {
        const ahead_poly z2 = square_of(ray->o.z, ray->d.z),
                         q = ahead_sum(ahead_scaled(x2, bx * b->c_x), ahead_scaled(y2, by * b->c_y)),
                         one = {0, {1, 0, 0, 0, 0}, {1, 0, 0, 0, 0}};
        w.rest = ahead_sum(n, ahead_scaled(w.z, -1));
        const ahead_poly twice = ahead_sum(n, ahead_scaled(w.z, -2));
        w.g = ahead_sum(ahead_product(&n, &twice), ahead_product(&z2, &q));
        w.inside = ahead_sum(one, ahead_scaled(q, -1));
    }
    ahead->to = biconic_way_ends(&w, ahead->from, ahead->to), ahead->part = 1;
    w.bend = sgt_ahead_poly_bend(&w.g);
    return sgt_look_ahead(&ops, &w, ahead);
}
