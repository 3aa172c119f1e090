/* mandelbulb.c - a surface of one's own with a clearance that is proven.
 *
 * The triplex power 8 of v (D. White and P. Nylander, 2009) multiplies by 8 the angle from the z axis
 * and the angle about it.  With rho = |(x, y)|, a = z + i rho and e = (x + i y) / rho it is
 *
 *     z' = Re a^8,   x' + i y' = Im a^8 e^8,   |v'| = |v|^8,
 *
 * six squarings of complex numbers and no sine.  The surface is |v_N| = E of the orbit v_1 = p,
 * v_{j+1} = v_j^8 + p; F = (u - 1) / (u + 1), u = |v_N|^2 / E^2, is below zero inside.
 *
 * The derivative.  In the directions of a (two of them) and about the axis, the power stretches by
 * 8 r^7, 8 r^7 and 8 r^7 |sin 8 theta / sin theta|, and takes the three directions, at right angles
 * to each other, to three that are so too.  Hence its norm is J = 8 r^7 max(1, |sin 8 theta / sin
 * theta|), where the quotient is at most 8.  On the axis itself the power has no derivative, but it is
 * continuous, and the bound holds on both sides: J bounds how far two points move apart.
 *
 * The clearance.  If all p' with |p' - p| <= h have their v_n within e_n of that of p, then
 *
 *     e_1 = h,   e_{n+1} = J_n e_n + h,   J_n the largest J in the ball of radius e_n about v_n.
 *
 * With |p'| <= C, and T^8 = E + C, T <= E: an orbit that is beyond T at some level is beyond
 * T^8 - C = E >= T at the next and ever after.  So the ball about p is outside if |v_n| - e_n > T for
 * some n < N or |v_N| - e_N > E, and inside if |v_N| + e_N < E.  `ball_is_clear` tries that for a
 * given h, with the rounding of the orbit added to e_n; a h to try comes from the same recursion to
 * first order.  What is returned has passed the trial, so it is proven, rounding included.  It is
 * about a tenth of the distance, because norms are multiplied where the derivatives do not line up, and J is
 * the largest in the ball.  Not proven is that a march by it misses nothing: near the surface it asks for
 * steps below dt_min, and there the library takes dt_min, and says so where it found no root. */
#include "own.h"

#include "vector.h"

static const double U = 0x1p-53;

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

/* The orbit is that of the middle of the ball, let go beyond T at the earliest. */
static bool ball_is_clear(const orbit *o, int count, double escape, double T, double h)
{
    double e = h;
    for (int n = 1; n < count; n++) {
        const triplex *x = &o->x[n - 1];
        if (x->r - e > T) return true;
        if (n == o->count || !(e < 1)) return false;
        e = (stretch(x, e) * e + h + level_rounding(x, o->x[0].r)) * (1 + 1e-9);
    }
    double r = o->x[count - 1].r;
    return r - e > escape * (1 + 1e-9) || r + e < escape * (1 - 1e-9);
}

static double bulb_clearance(const void *self, vec3 p)
{
    const mandelbulb *s = self;
    int count = levels(s);
    orbit o;
    follow(&o, s, p, GONE);
    double escape = escape_of(s), c = o.x[0].r, T = threshold(escape, c), growth = 1, h = 0;
    for (int n = 1; n <= o.count; n++) {
        const triplex *x = &o.x[n - 1];
        h = fmax(h, (n == count ? fabs(x->r - escape) : x->r - T) / growth);
        growth = stretch(x, 0) * growth + 1;
    }
    T = threshold(escape, c + h);
    if (!(T <= escape)) return 0;
    h *= 0.8;
    for (int i = 0; i < 16; i++, h *= 0.75)
        if (ball_is_clear(&o, count, escape, T, h)) return h;
    return 0;
}

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

/* Beyond (E + 2)^(1/8) a point is beyond T, as long as E is at most 100. */
static sgt_span bulb_span(const void *self, const sgt_ray *ray)
{
    const mandelbulb *s = self;
    return own_ball(threshold(escape_of(s), 2), ray->o, ray->d);
}

const sgt_surface_ops mandelbulb_ops = {.name = "mandelbulb",
                                        .value = bulb_value,
                                        .span = bulb_span,
                                        .rounding = bulb_rounding,
                                        .clearance = bulb_clearance};
