// SPDX-License-Identifier: MIT
/* mandelbulb.c - a surface of one's own with an enclosure: first hits and misses are proven.
 *
 * The triplex power 8 of v (D. White and P. Nylander, 2009) multiplies by 8 the angle from the z axis and the
 * angle about it.  With rho = |(x, y)|, a = z + i rho and e = (x + i y) / rho it is
 *
 *     z' = Re a^8,   x' + i y' = Im a^8 e^8,   |v'| = |v|^8,
 *
 * six squarings of complex numbers and no sine.  The surface is |v_N| = E of the orbit v_1 = p, v_{j+1} =
 * v_j^8 + p; F = (u - 1) / (u + 1), u = |v_N|^2 / E^2, is below zero inside.
 *
 * THE ENCLOSURE is the same orbit in models (model.h): each number is a straight line along the cell, with a
 * bound on what it is off.  So its width falls with the square of the cell's length, and it does not matter
 * that the power stretches by up to 64 r^7 at each level: along a ray, lines say which way.  With q = rho^2
 * the power is
 *
 *     A = z^2 - q,   B = 4 z^2 q,   R = A^2 - B = Re a^4,   Re a^8 = R^2 - 4 A^2 B,   Im a^8 = 8 z rho A R,
 *
 * and e^2 = (x^2 - y^2 + 2 i x y) / q: one root and one quotient a level.  On the axis rho has a kink, and e
 * is not defined; but |x' + i y'| <= |Im a^8|, which is all that is used of a cell that may meet it.  Its
 * slope is not known then, so a root on the axis, or where the orbit comes there, is undecided.
 *
 * LET GO.  With |p| <= C, and T^8 = E + C, T <= E: an orbit that is beyond T at some level is beyond T^8 - C
 * = E >= T at the next and ever after.  Then F is above zero, and the levels left need not be gone through.
 * Far from the surface most cells end so after one level or two.
 *
 * ROUNDING OF F.  In the directions of a (two of them) and about the axis, the power stretches by 8 r^7, 8
 * r^7 and 8 r^7 |sin 8 theta / sin theta|, and takes the three directions, at right angles to each other, to
 * three that are so too.  Hence its norm is J = 8 r^7 max(1, |sin 8 theta / sin theta|), where the quotient
 * is at most 8.  On the axis itself the power has no derivative, but it is continuous, and the bound holds on
 * both sides: J bounds how far two points move apart.  So an error e_n of v_n is one of at most J_n e_n, and
 * of the level's own rounding, in v_{n+1}.
 *
 * (Before it had an enclosure, the march went by a clearance from those norms.  That was a tenth of the
 * distance, and a ray that starts on the surface, as all shadow rays do, begins with a clearance of 0: a
 * quarter of all rays found nothing that way and were unproven.) */
#include "own.h"

#include "model.h"

typedef struct complex2 { double re, im; } complex2;

static complex2 times(complex2 a, complex2 b)
{
    return (complex2){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

static complex2 squared(complex2 a) { return (complex2){(a.re - a.im) * (a.re + a.im), 2 * a.re * a.im}; }

/* A triplex number taken apart: its length, its angles, and their powers. */
typedef struct triplex {
    vec3 v;
    double r, r8, rho;
    complex2 a, a2, a4, a8, e, e8;
} triplex;

static triplex triplex_of(vec3 v)
{
    double q = v.x * v.x + v.y * v.y, r2 = q + v.z * v.z;
    triplex x = {.v = v, .r = sqrt(r2), .r8 = r2 * r2 * (r2 * r2), .rho = sqrt(q)};
    x.a = (complex2){v.z, x.rho};
    x.a8 = squared(x.a4 = squared(x.a2 = squared(x.a)));
    x.e = x.rho > 0 ? (complex2){v.x / x.rho, v.y / x.rho} : (complex2){1, 0};
    x.e8 = squared(squared(squared(x.e)));
    return x;
}

static vec3 power_plus(const triplex *x, vec3 p)
{
    return (vec3){x->a8.im * x->e8.re + p.x, x->a8.im * x->e8.im + p.y, x->a8.re + p.z};
}

/* The transposed derivative of the power at x, times g: from the axes at v' to those at v. */
static vec3 pulled_back(const triplex *x, vec3 g)
{
    complex2 a7 = times(times(x->a4, x->a2), x->a);
    double out = g.x * x->e8.re + g.y * x->e8.im, about = g.y * x->e8.re - g.x * x->e8.im;
    double gz = 8 * (a7.re * g.z + a7.im * out), g_out = 8 * (a7.re * out - a7.im * g.z);
    double g_about = 8 * (8 * x->v.z * x->a2.re * x->a4.re) * about; /* Im a^8 / rho, without the division */
    return (vec3){g_out * x->e.re - g_about * x->e.im, g_out * x->e.im + g_about * x->e.re, gz};
}

/* v_1 to v_count in x[0] to x[count - 1].  It is let go where |v| is beyond GONE: F is 1 to the last bit
 * there, and the next power is finite still. */
typedef struct orbit { int count; triplex x[BULB_MOST_ITERATIONS]; } orbit;
static const double GONE = 1e15;

static double escape_of(const mandelbulb *s) { return s->escape > 0 ? s->escape : 2; }
static int levels(const mandelbulb *s) { return s->iterations ? s->iterations : 5; }

static void follow(orbit *o, const mandelbulb *s, vec3 p, double beyond)
{
    int count = levels(s);
    o->x[0] = triplex_of(p);
    for (o->count = 1; o->count < count && o->x[o->count - 1].r <= beyond; o->count++)
        o->x[o->count] = triplex_of(power_plus(&o->x[o->count - 1], p));
}

static double bulb_value(const void *self, vec3 p, vec3 *grad)
{
    const mandelbulb *s = self;
    orbit o;
    follow(&o, s, p, GONE);
    const triplex *last = &o.x[o.count - 1];
    double E2 = escape_of(s) * escape_of(s), u = last->r * last->r / E2;
    if (grad) {
        vec3 g = *grad = scaled(last->v, 4 / (E2 * (u + 1) * (u + 1)));
        for (int n = o.count - 2; n >= 0; n--) *grad = add(*grad, g = pulled_back(&o.x[n], g));
    }
    return u < HUGE_VAL ? (u - 1) / (u + 1) : 1;
}

/* The largest J in the ball of radius e about x, by sin theta >= (rho - e) / (r + e) and an angle that
 * changes by no more than asin(e/r) <= pi e / 2r. */
static double stretch(const triplex *x, double e)
{
    double R = x->r + e, R2 = R * R;
    /* both times R */
    double sine = x->rho - e, sine8 = R * fmin(1, fabs(x->a8.im) / x->r8 + 12.6 * e / x->r);
    double quotient = sine8 < 8 * sine ? sine8 / sine : 8;
    return 8 * R2 * R2 * R2 * R * fmax(1, quotient) * (1 + 1e-9);
}

/* What rounding adds to a level: 3 squarings of a leave 28 U, 3 of e (with its division) 52 U, the products
 * and the sum a few more. */
static double level_rounding(const triplex *x, double c) { return 128 * U * (x->r8 + c); }

static double threshold(double escape, double c) { return sqrt(sqrt(sqrt(escape + c))) * (1 + 1e-9); }

/* |dF/dr| = 4 x / (E (1 + x^2)^2), x = r/E, rises to 1.3 / E at x = 0.58 and falls from there on. */
static double bulb_rounding(const void *self, vec3 p)
{
    const mandelbulb *s = self;
    double escape = escape_of(s), e = 0;
    orbit o;
    follow(&o, s, p, GONE);
    for (int n = 0; n < o.count - 1; n++) e = stretch(&o.x[n], e) * e + level_rounding(&o.x[n], o.x[0].r);
    double nearest = (o.x[o.count - 1].r - e) / escape, q = 1 + nearest * nearest;
    /* F itself is from -1 to 1; NaN: 2 */
    return fmin(2, (nearest > 0.6 ? 4 * nearest / (q * q) : 1.3) * e / escape + 8 * U);
}

/* Beyond (E + 2)^(1/8) a point is beyond T, as long as E is at most 100.  With one level the surface is a
 * ball. */
static sgt_span bulb_span(const void *self, const sgt_ray *ray)
{
    const mandelbulb *s = self;
    double radius = levels(s) > 1 ? threshold(escape_of(s), 2) : escape_of(s);
    return own_ball(radius, ray->o, ray->d);
}

/* ----------------------------------------------------------- the enclosure */

typedef struct jet3 { jet x, y, z; } jet3;

static inline jet square_length(const jet3 *v, bool slope)
{
    return jet_plus(jet_plus(jet_square(v->x, slope), jet_square(v->y, slope)), jet_square(v->z, slope));
}

/* The power of a v that may be on the axis, plus p; squares of its numbers. */
static jet3 power_at_axis(const jet3 *v, const jet3 *p, model q, model z2)
{
    model a2 = minus(z2, q), b = scaled_model(product(z2, q), 4), a22 = product(a2, a2), a4 = minus(a22, b);
    double half = 0.5 * sqrt(fmax(0, highest(q))) * (1 + 4 * U);
    model rho = {half, 0, half}, out = product(product(v->z.f, a2), product(a4, rho)),
          a8 = minus(product(a4, a4), scaled_model(product(a22, b), 4)),
          side = {.e = 8 * fmax(fabs(lowest(out)), fabs(highest(out)))};
    return (jet3){{.f = plus(side, p->x.f)}, {.f = plus(side, p->y.f)}, {.f = plus(a8, p->z.f)}};
}

/* The power of v plus p, with its slope or without.  false: it has no slope. */
static inline bool jet_power(jet3 *v, const jet3 *p, bool slope)
{
    jet x2 = jet_square(v->x, slope), y2 = jet_square(v->y, slope), z2 = jet_square(v->z, slope),
        q = jet_plus(x2, y2);
    if (!(lowest(q.f) > 0x1p-40 * q.f.c)) {
        *v = power_at_axis(v, p, q.f, z2.f);
        return !slope;
    }
    jet xy = jet_scaled(jet_product(v->x, v->y, slope), 2), a2 = jet_minus(z2, q),
        b = jet_scaled(jet_product(z2, q, slope), 4), a22 = jet_square(a2, slope), a4 = jet_minus(a22, b),
        a8 = jet_minus(jet_square(a4, slope), jet_scaled(jet_product(a22, b, slope), 4));
    jet w = jet_inverse(q, slope), rho = jet_root(q, w, slope);
    jet re = jet_product(jet_minus(x2, y2), w, slope), im = jet_product(xy, w, slope); /* e^2 */
    for (int i = 0; i < 2; i++) {
        jet next = jet_product(jet_minus(re, im), jet_plus(re, im), slope);
        im = jet_scaled(jet_product(re, im, slope), 2), re = next;
    }
    jet out = jet_scaled(jet_product(jet_product(v->z, a2, slope), jet_product(a4, rho, slope), slope), 8);
    *v = (jet3){jet_plus(jet_product(out, re, slope), p->x), jet_plus(jet_product(out, im, slope), p->y),
                jet_plus(a8, p->z)};
    return true;
}

/* F and, if it is asked for and can be told, its slope, over a cell.  Twice its text: with the slope it costs
 * three times as much, and most cells do without. */
static inline sgt_interval enclosed(const mandelbulb *s, const jet3 *p, bool slope, sgt_interval *of_slope)
{
    const sgt_interval outside = {0x1p-1000, 1}, all = {-1, 1};
    int count = levels(s);
    double escape = escape_of(s), E2 = escape * escape;
    jet3 v = *p;
    jet u = square_length(&v, slope);
    double T = threshold(escape, sqrt(highest(u.f)));
    for (int n = 1; n < count; n++) {
        if (lowest(u.f) > T * T * (1 + 8 * U) && T <= escape) return outside;
        if (!(highest(u.f) < 1e6) || !jet_power(&v, p, slope)) return all;
        u = square_length(&v, slope);
    }
    double lo = fmax(0, lowest(u.f)) / E2 * (1 - 8 * U), hi = highest(u.f) / E2 * (1 + 8 * U);
    if (slope && hi < 1e12) { /* F' = 2 u' / (1 + u)^2 */
        double least = 2 / E2 / ((1 + hi) * (1 + hi)) * (1 - 16 * U),
               most = 2 / E2 / ((1 + lo) * (1 + lo)) * (1 + 16 * U), d_lo = lowest(u.d), d_hi = highest(u.d);
        *of_slope = (sgt_interval){d_lo * (d_lo < 0 ? most : least), d_hi * (d_hi < 0 ? least : most)};
        of_slope->lo -= 4 * U * fabs(of_slope->lo), of_slope->hi += 4 * U * fabs(of_slope->hi);
    }
    double f_lo = (lo - 1) / (lo + 1), f_hi = hi < HUGE_VAL ? (hi - 1) / (hi + 1) : 1;
    return (sgt_interval){fmax(-1, f_lo - 4 * U), fmin(1, f_hi + 4 * U)};
}

static sgt_interval bulb_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    const mandelbulb *s = self;
    const vec3 o = ray->o, d = ray->d;
    double m = 0.5 * t.lo + 0.5 * t.hi, h = fmax(t.hi - m, m - t.lo) * (1 + 4 * U);
    const jet3 p = {jet_on_ray(o.x, d.x, m, h), jet_on_ray(o.y, d.y, m, h), jet_on_ray(o.z, d.z, m, h)};
    *slope = (sgt_interval){-HUGE_VAL, HUGE_VAL};
    sgt_interval f = enclosed(s, &p, false, slope);
    return f.lo > 0 || f.hi < 0 ? f : enclosed(s, &p, true, slope);
}

const sgt_surface_ops mandelbulb_ops = {.name = "mandelbulb",
                                        .value = bulb_value,
                                        .span = bulb_span,
                                        .rounding = bulb_rounding,
                                        .enclose = bulb_enclose};
