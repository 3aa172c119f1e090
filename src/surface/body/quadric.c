// SPDX-License-Identifier: MIT
/* quadric.c - any surface of the second degree: both sheets of a hyperboloid, a pair of planes, a plane.
 *
 * The parameters are squares a, b, c; products d of xy, e of yz, f of xz; linear g, h, i.  The first row
 * of the gradient is G_x = 2 a x + d y + f z + g, and so on.  Euler's identity gives
 *     F = (x (G_x + g) + y (G_y + h) + z (G_z + i)) / 2 + constant.
 * So F costs four multiplications more than its gradient.
 *
 * THE ROUNDING.  A term of F is rounded at most 9 times on its way into the sum: the product, three sums
 * in its row, the product by the coordinate, two sums, the constant.  (Halves are exact.)  So F is right
 * to 9 u (1 + 9 u) of the sum of the terms' magnitudes.  The linear terms are taken twice where they are
 * added twice.
 *
 * THE RAY.  The local origin is the point of the ray nearest the origin of the frame.  The parabola there
 * is that of quadratic.h: B is half the slope, C is F, and A has the squares and products of the
 * direction.  Their terms are rounded at most 9 times, the coordinates included.  That is less than the 16
 * u of quadratic.h. */
#include "../../num/bits.h"
#include "easy.h"

#include <limits.h>

/* The rows of the gradient, linear in the point. */
typedef struct rows { double x, y, z; } rows;

SGT_INLINE rows quadric_rows_of(const sgt_quadric *s, double x, double y, double z)
{
    const double *a = s->squares, *b = s->products, *c = s->linear;
    return (rows){((2 * a[0]) * x + b[0] * y) + (b[2] * z + c[0]),
                  (b[0] * x + (2 * a[1]) * y) + (b[1] * z + c[1]),
                  (b[2] * x + b[1] * y) + ((2 * a[2]) * z + c[2])};
}

SGT_INLINE double quadric_at(const sgt_quadric *s, double x, double y, double z, rows *g)
{
    *g = quadric_rows_of(s, x, y, z);
    return 0.5 * ((x * (g->x + s->linear[0]) + y * (g->y + s->linear[1])) + z * (g->z + s->linear[2])) +
           s->constant;
}

/* The magnitudes of the coefficients. */
SGT_INLINE sgt_quadric quadric_sizes_of(const sgt_quadric *s)
{
    sgt_quadric a;
    for (int i = 0; i < 3; i++)
        a.squares[i] = fabs(s->squares[i]), a.products[i] = fabs(s->products[i]),
        a.linear[i] = fabs(s->linear[i]);
    a.constant = fabs(s->constant);
    return a;
}

static double quadric_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    rows g;
    double f = quadric_at(self, p.x, p.y, p.z, &g);
    if (grad) *grad = (sgt_vec3){g.x, g.y, g.z};
    return f;
}

SGT_KERNEL
static void quadric_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    const sgt_quadric s = *(const sgt_quadric *)self;
    const double *x = p.p[0], *y = p.p[1], *z = p.p[2];
    double *f = out.f, *gx = out.grad[0], *gy = out.grad[1], *gz = out.grad[2];
    if (gx) {
        LANES for (size_t i = 0; i < n; i++) {
            rows g;
            double value = quadric_at(&s, x[i], y[i], z[i], &g);
            f[i] = value, gx[i] = g.x, gy[i] = g.y, gz[i] = g.z;
        }
    } else {
        LANES for (size_t i = 0; i < n; i++) {
            rows g;
            f[i] = quadric_at(&s, x[i], y[i], z[i], &g);
        }
    }
}

/* sizes: the magnitudes of the coefficients.  The last term is for underflow in their products by a
 * coordinate. */
SGT_INLINE double sizes_rounding(const sgt_quadric *sizes, double x, double y, double z)
{
    rows unused;
    x = fabs(x), y = fabs(y), z = fabs(z);
    return 9 * SGT_U * (1 + 0x1p-40) * quadric_at(sizes, x, y, z, &unused) + 0x1p-1020 * (1 + (x + y + z));
}

static double quadric_rounding(const void *self, sgt_vec3 p)
{
    sgt_quadric sizes = quadric_sizes_of(self);
    return sizes_rounding(&sizes, p.x, p.y, p.z);
}

SGT_KERNEL
static bool quadric_roundings(const void *self, const sgt_shared *shared, size_t n, sgt_points p,
                              const double f[], double out[])
{
    const sgt_quadric sizes = quadric_sizes_of(self);
    const double *x = p.p[0], *y = p.p[1], *z = p.p[2];
    (void)f, (void)shared;
    LANES for (size_t i = 0; i < n; i++) out[i] = sizes_rounding(&sizes, x[i], y[i], z[i]);
    return true;
}

SGT_KERNEL
static bool quadric_values_rounded(const void *self, const sgt_shared *shared, const double *const rows_of[3],
                                   size_t n, sgt_points p, sgt_values out, double own[])
{
    const sgt_quadric s = *(const sgt_quadric *)self, sizes = quadric_sizes_of(&s);
    const double *x = p.p[0], *y = p.p[1], *z = p.p[2];
    double *f = out.f, *gx = out.grad[0], *gy = out.grad[1], *gz = out.grad[2];
    (void)shared, (void)rows_of;
    LANES for (size_t i = 0; i < n; i++) {
        rows g;
        double value = quadric_at(&s, x[i], y[i], z[i], &g);
        f[i] = value, gx[i] = g.x, gy[i] = g.y, gz[i] = g.z;
        own[i] = sizes_rounding(&sizes, x[i], y[i], z[i]);
    }
    return true;
}

/* Half the second derivative along d.  Given the magnitudes, it is the sum of its terms' magnitudes. */
SGT_INLINE double quadric_bent(const sgt_quadric *s, double l, double m, double n)
{
    const double *a = s->squares, *b = s->products;
    return l * ((a[0] * l + b[0] * m) + b[2] * n) + (m * (a[1] * m + b[1] * n) + n * (a[2] * n));
}

SGT_INLINE void quadric_approach(const sgt_quadric *s, sgt_vec3 o, sgt_vec3 d, parabola *p, near_ray *r)
{
    sgt_quadric size = quadric_sizes_of(s);
    rows g, ga;
    *r = near_ray_of(d);
    double l = r->d.x, m = r->d.y, n = r->d.z, la = fabs(l), ma = fabs(m), na = fabs(n);
    near_ray_at(r, o, -(o.x * l + o.y * m + o.z * n) / (l * l + m * m + n * n));
    p->C = quadric_at(s, r->x.x, r->x.y, r->x.z, &g),
    p->Ca = quadric_at(&size, fabs(r->x.x), fabs(r->x.y), fabs(r->x.z), &ga);
    p->A = quadric_bent(s, l, m, n), p->Aa = quadric_bent(&size, la, ma, na);
    p->B = 0.5 * (g.x * l + g.y * m + g.z * n), p->Ba = 0.5 * (ga.x * la + ga.y * ma + ga.z * na);
}

SGT_INLINE double quadric_terms(const sgt_quadric *s, const near_ray *r, double tau)
{
    double x = r->x.x + tau * r->d.x, y = r->x.y + tau * r->d.y, z = r->x.z + tau * r->d.z;
    rows g = quadric_rows_of(s, x, y, z);
    return fabs(x * g.x) + fabs(y * g.y) + fabs(z * g.z);
}

SGT_INLINE outset quadric_outset(const sgt_quadric *s, sgt_vec3 p, sgt_vec3 d)
{
    sgt_quadric size = quadric_sizes_of(s);
    rows g, ga;
    double f = quadric_at(s, p.x, p.y, p.z, &g),
           sizes = quadric_at(&size, fabs(p.x), fabs(p.y), fabs(p.z), &ga),
           across = ga.x * fabs(d.x) + ga.y * fabs(d.y) + ga.z * fabs(d.z);
    return (outset){.g = f, .g_err = 10 * SGT_U * sizes, .slope = g.x * d.x + g.y * d.y + g.z * d.z,
                       .slope_err = COEFFICIENT * across,
                       .terms = fabs(p.x * g.x) + fabs(p.y * g.y) + fabs(p.z * g.z)};
}

/* The parabola is that of F. */
SGT_INLINE double quadric_unit(const sgt_quadric *s) { return (void)s, 1; }

QUADRATIC_SPANS(quadric, sgt_quadric, quadric_approach, quadric_unit, quadric_terms, quadric_outset)

/* ------------------------------------------------------------------ by intervals */

/* a x + b y + c z + d. */
static sgt_interval form(double a, sgt_interval x, double b, sgt_interval y, double c, sgt_interval z,
                         double d)
{
    return sgt_interval_sum(sgt_interval_sum(sgt_interval_scaled(x, a), sgt_interval_scaled(y, b)),
                            sgt_interval_sum(sgt_interval_scaled(z, c), sgt_interval_of(d)));
}

static sgt_interval quadric_plain(const sgt_quadric *s, const sgt_ray *ray, double t0, sgt_interval t,
                                  sgt_interval *slope)
{
    const double *a = s->squares, *b = s->products, *c = s->linear;
    sgt_interval x = plain_line(ray->o.x, ray->d.x, t0, t), y = plain_line(ray->o.y, ray->d.y, t0, t),
                 z = plain_line(ray->o.z, ray->d.z, t0, t);
    sgt_interval gx = form(2 * a[0], x, b[0], y, b[2], z, c[0]),
                 gy = form(b[0], x, 2 * a[1], y, b[1], z, c[1]),
                 gz = form(b[2], x, b[1], y, 2 * a[2], z, c[2]);
    *slope = form(ray->d.x, gx, ray->d.y, gy, ray->d.z, gz, 0);
    gx = form(a[0], x, b[0], y, b[2], z, c[0]), gy = form(0, x, a[1], y, b[1], z, c[1]),
    gz = form(0, x, 0, y, a[2], z, c[2]);
    return sgt_interval_sum(sgt_interval_sum(sgt_interval_product(x, gx), sgt_interval_product(y, gy)),
                            sgt_interval_sum(sgt_interval_product(z, gz), sgt_interval_of(s->constant)));
}

typedef struct fine_rows { twofold x, y, z; } fine_rows;

/* a x + b y + c z + d. */
SGT_INLINE twofold fine_form(double a, twofold x, double b, twofold y, double c, twofold z, double d)
{
    return twofold_sum(twofold_sum(twofold_scaled(x, a), twofold_scaled(y, b)),
                       twofold_sum(twofold_scaled(z, c), twofold_of(d)));
}

SGT_INLINE twofold fine_dot(twofold a, twofold x, twofold b, twofold y, twofold c, twofold z)
{
    return twofold_sum(twofold_sum(twofold_product(a, x), twofold_product(b, y)), twofold_product(c, z));
}

/* Are all coefficients in the range in which products with them are split exactly?  If not, quadric_far
 * takes another unit. */
static bool moderate(const sgt_quadric *s)
{
    bool is = true;
    for (int i = 0; i < 10; i++) {
        double size = fabs(i < 3   ? s->squares[i]
                           : i < 6 ? s->products[i - 3]
                           : i < 9 ? s->linear[i - 6]
                                   : s->constant);
        is = is && size < 0x1p100 && (size == 0 || size > 0x1p-100);
    }
    return is;
}

SGT_INLINE fine_parabola quadric_parabola(const sgt_quadric *s, const sgt_quadric *size, const fine_ray *r)
{
    const double *a = s->squares, *b = s->products, *c = s->linear;
    twofold l = twofold_of(r->l), m = twofold_of(r->m), n = twofold_of(r->n), x = r->x, y = r->y, z = r->z;
    fine_rows full = {fine_form(2 * a[0], x, b[0], y, b[2], z, c[0]),
                      fine_form(b[0], x, 2 * a[1], y, b[1], z, c[1]),
                      fine_form(b[2], x, b[1], y, 2 * a[2], z, c[2])};
    fine_rows upper = {fine_form(a[0], x, b[0], y, b[2], z, c[0]), fine_form(0, x, a[1], y, b[1], z, c[1]),
                       fine_form(0, x, 0, y, a[2], z, c[2])};
    fine_rows along = {fine_form(a[0], l, b[0], m, b[2], n, 0), fine_form(0, l, a[1], m, b[1], n, 0),
                       fine_form(0, l, 0, m, a[2], n, 0)};
    rows sizes;
    double la = fabs(r->l), ma = fabs(r->m), na = fabs(r->n), tiny = 0x1p-700; /* for underflow */
    fine_parabola p = {fine_dot(l, along.x, m, along.y, n, along.z),
                       twofold_times_power(fine_dot(l, full.x, m, full.y, n, full.z), 0.5),
                       twofold_sum(fine_dot(x, upper.x, y, upper.y, z, upper.z), twofold_of(s->constant)),
                       0, 0, 0};
    p.Aa = quadric_bent(size, la, ma, na),
    p.Ca = quadric_at(size, fabs(x.hi), fabs(y.hi), fabs(z.hi), &sizes) + tiny;
    p.Ba = 0.5 * (sizes.x * la + sizes.y * ma + sizes.z * na) + tiny;
    return p;
}

/* Returns false if they are not moderate, or if the ray is out of range. */
static bool quadric_fine(const sgt_quadric *s, const sgt_ray *ray, double t0, sgt_interval t, sgt_interval *g,
                         sgt_interval *slope)
{
    fine_ray r;
    if (!fine_ray_of(ray, t0, t, &r) || !moderate(s)) return false;
    sgt_quadric size = quadric_sizes_of(s);
    fine_parabola p = quadric_parabola(s, &size, &r);
    *g = fine_enclose(&p, &r, slope);
    return true;
}

/* The exponent of the largest of three.  INT_MIN: all are 0. */
static int exponent_of(const double *x)
{
    double most = larger(larger(fabs(x[0]), fabs(x[1])), fabs(x[2]));
    return most > 0 ? binary_exponent(most) : INT_MIN;
}

/* The same surface in a unit of length and with a factor, both powers of two, in which its size is about
 * 1.  It is 2^of times F at 2^length times the point.  Returns false if a number would be rounded. */
static bool in_own_unit(const sgt_quadric *s, sgt_quadric *out, int *length, int *of)
{
    int square = exponent_of(s->squares), product = exponent_of(s->products), linear = exponent_of(s->linear);
    int constant = s->constant != 0 ? binary_exponent(s->constant) : INT_MIN;
    if (product > square) square = product;
    *length = 0;
    if (square == INT_MIN) { /* a plane */
        if (constant > INT_MIN) *length = constant - linear;
        square = linear - *length;
    } else {
        int by_linear = linear > INT_MIN ? linear - square : INT_MIN,
            by_constant = constant > INT_MIN ? (constant - square) >> 1 : INT_MIN;
        if (by_linear > INT_MIN || by_constant > INT_MIN)
            *length = by_linear > by_constant ? by_linear : by_constant;
    }
    *of = -square - 2 * *length;
    bool exact = true;
    for (int i = 0; i < 10; i++) {
        double x = i < 3   ? s->squares[i]
                   : i < 6 ? s->products[i - 3]
                   : i < 9 ? s->linear[i - 6]
                           : s->constant;
        int by = *of + *length * (i < 6 ? 2 : i < 9 ? 1 : 0);
        double *to = i < 3   ? &out->squares[i]
                     : i < 6 ? &out->products[i - 3]
                     : i < 9 ? &out->linear[i - 6]
                             : &out->constant;
        *to = times_power_of_two(x, by);
        exact = exact && times_power_of_two(*to, -by) == x;
    }
    return exact;
}

static bool normal_power(int of_two) { return of_two >= -1000 && of_two <= 1000; }

/* g and its slope for the surface in its own unit, whatever the caller's unit is.  Far from 1 the products
 * are not exact. */
static bool quadric_far(const sgt_quadric *s, const sgt_ray *ray, double t0, sgt_interval t, sgt_interval *g,
                        sgt_interval *slope)
{
    sgt_quadric own;
    int length, of;
    if (!in_own_unit(s, &own, &length, &of) || !normal_power(length) || !normal_power(of) ||
        !normal_power(of + length))
        return false;
    double unit = power_of_two(-length);
    sgt_ray moved = *ray;
    moved.o = (sgt_vec3){ray->o.x * unit, ray->o.y * unit, ray->o.z * unit};
    if (moved.o.x / unit != ray->o.x || moved.o.y / unit != ray->o.y || moved.o.z / unit != ray->o.z ||
        t0 * unit / unit != t0)
        return false;
    if (!quadric_fine(&own, &moved, t0 * unit, sgt_interval_scaled(t, unit), g, slope)) return false;
    *g = sgt_interval_scaled(*g, power_of_two(-of));
    *slope = sgt_interval_scaled(*slope, power_of_two(-of - length));
    return true;
}

SGT_NARROW(sgt_interval, sgt_quadric_enclose_from,
           (const void *self, const sgt_ray *ray, double t0, sgt_interval t,
            sgt_interval *slope))
{
    const sgt_quadric *s = self;
    sgt_interval g;
    if (!stretch_valid(ray, t, &g, slope)) return g;
    if (quadric_fine(s, ray, t0, t, &g, slope) || quadric_far(s, ray, t0, t, &g, slope)) return g;
    return quadric_plain(s, ray, t0, t, slope);
}

static sgt_interval quadric_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    return sgt_quadric_enclose_from(self, ray, 0, t, slope);
}

typedef struct fine_quadric { sgt_quadric s, size; mask known; } fine_quadric;

static fine_quadric fine_quadric_of(const sgt_quadric *s)
{
    return (fine_quadric){*s, quadric_sizes_of(s), MASK(moderate(s))};
}

SGT_INLINE void quadric_cell(const fine_quadric *s, const fine_ray *r, lane_cell *out)
{
    fine_parabola p = quadric_parabola(&s->s, &s->size, r);
    lane_parabola(&p, r, out);
}

LANE_CELLS(quadric, fine_quadric, fine_quadric_of, quadric_cell, 1.0, s.known)

/* ------------------------------------------------------------------ sensitivities */

static void quadric_second(const void *self, size_t n, sgt_points p, double *const out[6])
{
    const sgt_quadric *s = self;
    const double all[6] = {2 * s->squares[0], s->products[0], s->products[2],
                           2 * s->squares[1], s->products[1], 2 * s->squares[2]};
    (void)p;
    for (int j = 0; j < 6; j++)
        for (size_t i = 0; i < n; i++) out[j][i] = all[j];
}

static size_t quadric_parameters(const void *self) { return (void)self, 10; }

/* The monomials: the product of two of x, y, z and 1, by their places. */
static void quadric_by_parameter(const void *self, size_t j, size_t n, sgt_points p, sgt_values out)
{
    static const signed char first[10] = {0, 1, 2, 0, 1, 0, 0, 1, 2, 3},
                             second[10] = {0, 1, 2, 1, 2, 2, 3, 3, 3, 3};
    int a = first[j], b = second[j];
    (void)self;
    for (size_t i = 0; i < n; i++) {
        double u = a < 3 ? p.p[a][i] : 1, v = b < 3 ? p.p[b][i] : 1;
        out.f[i] = u * v;
        if (!out.grad[0]) continue;
        for (int k = 0; k < 3; k++) out.grad[k][i] = (a == k ? v : 0) + (b == k ? u : 0);
    }
}

static sgt_objection quadric_object(const void *self)
{
    const sgt_quadric *s = self;
    if (!numbers_finite(3, s->squares)) return (sgt_objection){"squares", "not finite"};
    if (!numbers_finite(3, s->products)) return (sgt_objection){"products", "not finite"};
    if (!numbers_finite(3, s->linear)) return (sgt_objection){"linear", "not finite"};
    if (!(fabs(s->constant) < HUGE_VAL)) return (sgt_objection){"constant", "not finite"};
    bool any = false;
    for (int i = 0; i < 3; i++) any = any || s->squares[i] != 0 || s->products[i] != 0 || s->linear[i] != 0;
    if (!any) return (sgt_objection){"squares", "all zero, as are products and linear"};
    return (sgt_objection){NULL, NULL};
}

/* ---------------------------------------------------------------- in closed form (easy.h) */

typedef struct second_degree { sgt_quadric self, size; easy_shared easy; } second_degree;

static second_degree second_degree_of(const sgt_quadric *s)
{
    const sgt_quadric a = quadric_sizes_of(s);
    const double bent = (a.squares[0] + a.squares[1] + a.squares[2]) +
                        (a.products[0] + a.products[1] + a.products[2]),
                 linear = a.linear[0] + a.linear[1] + a.linear[2];
    return (second_degree){*s, a, {1, 1, 2 * bent * (1 + 0x1p-40), 2 * linear + 0x1p-860}};
}

/* The rounding of F, as sizes_rounding has it, by Horner's rule: the same sum of magnitudes, with another
 * rounding, which the factor covers. */
SGT_INLINE double degree_rounding(const sgt_quadric *size, double x, double y, double z)
{
    const double *a = size->squares, *b = size->products, *c = size->linear;
    x = fabs(x), y = fabs(y), z = fabs(z);
    const double first = x * (((a[0] * x + b[0] * y) + b[2] * z) + c[0]),
                 sum = (first + y * ((a[1] * y + b[1] * z) + c[1])) +
                       (z * (a[2] * z + c[2]) + size->constant);
    return 9 * SGT_U * (1 + 0x1p-40) * sum + 0x1p-1020 * (1 + (x + y + z));
}

SGT_INLINE easy_place degree_place(const second_degree *s, sgt_vec3 p)
{
    rows g;
    const double f = quadric_at(&s->self, p.x, p.y, p.z, &g);
    return (easy_place){f, g.x, g.y, g.z, degree_rounding(&s->size, p.x, p.y, p.z)};
}

EASY_LANES(quadric, sgt_quadric, quadric_object, false, second_degree, second_degree_of,
           quadric_approach, degree_place)

static const struct sgt_builtin_ops quadric_builtin = {
    .object = quadric_object, .roundings = quadric_roundings, .enclose = sgt_quadric_enclose_from,
    .encloses = quadric_encloses, .values_rounded = quadric_values_rounded,
    .first = quadric_steep_first, .firsts = quadric_steep_firsts, .easy = quadric_easy,
    .easy_one = quadric_easy_one};

const sgt_surface_ops sgt_quadric_ops = {
    .name = "quadric", .value = quadric_value, .values = quadric_values, .span = quadric_span,
    .spans = quadric_spans, .rounding = quadric_rounding, .enclose = quadric_enclose,
    .first = quadric_first, .firsts = quadric_firsts, .second = quadric_second,
    .parameters = quadric_parameters, .by_parameter = quadric_by_parameter, .own_ = &quadric_builtin};
