// SPDX-License-Identifier: MIT
/* ellipsoid.c - the ellipsoid of revolution about z, oblate or prolate.
 *
 * With w = z / (1 - f) it is the sphere x^2 + y^2 + w^2 = a^2, and
 *     F = (x^2 + y^2 + w^2 - a^2) / 2a,     grad F = (x, y, z / (1 - f)^2) / a.
 *
 * THE ROUNDING.  The terms are added to -a^2 one by one, each by fma, the greatest cancellation last:
 *     ((e z^2 - a^2) + y^2) + x^2.
 * e = 1 / (1 - f)^2 and a^2 are two doubles each, so they are exact.  The errors are: z^2 u e z^2; the low
 * parts, at most 2 u (e z^2 + a^2), u of themselves; each sum u of itself.  Near the surface the sums are
 * a^2 - w^2 and x^2, so F is right to u a there.  That is less than what the rounding of the point itself
 * causes.  The quotient adds u |F|.
 *
 * THE CLEARANCE.  The map (x, y, z) -> (x, y, w) lengthens distances by at most K = max(1, 1 / (1 - f)).
 * So the surface is no nearer than | |(x, y, w)| - a | / K.
 *
 * THE RAY.  In (x, y, w) the local origin is the point of the ray nearest the centre.  The discriminant
 * there is that of half the chord (quadratic.h). */
#include "easy.h"

/* What all points share. */
typedef struct shell { double a, e, e_lo, a2, a2_lo, half, inverse, stretch; } shell;

SGT_INLINE shell shell_of(const sgt_ellipsoid *s)
{
    twofold b = two_sum(1, -s->f), e = twofold_quotient(twofold_of(1), twofold_product(b, b)),
            a2 = two_product(s->a, s->a);
    return (shell){s->a, e.hi, e.lo, a2.hi, a2.lo, 0.5 / s->a, 1 / s->a, 1 / b.hi};
}

SGT_INLINE double shell_at(const shell *s, double x, double y, double z, double *gx, double *gy, double *gz)
{
    double z2 = z * z, small = sgt_fma(z2, s->e_lo, -s->a2_lo),
           sum = sgt_fma(y, y, sgt_fma(z2, s->e, -s->a2));
    *gx = x * s->inverse, *gy = y * s->inverse, *gz = (z * s->e) * s->inverse;
    return (sgt_fma(x, x, sum) + small) * s->half;
}

static double ellipsoid_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    shell s = shell_of(self);
    sgt_vec3 n;
    double f = shell_at(&s, p.x, p.y, p.z, &n.x, &n.y, &n.z);
    if (grad) *grad = n;
    return f;
}

SGT_KERNEL
static void shell_values(const shell *shared, size_t n, sgt_points p, sgt_values out)
{
    const shell s = *shared;
    const double *x = p.p[0], *y = p.p[1], *z = p.p[2];
    double *f = out.f, *gx = out.grad[0], *gy = out.grad[1], *gz = out.grad[2];
    if (gx) {
        LANES for (size_t i = 0; i < n; i++) {
            double nx, ny, nz, value = shell_at(&s, x[i], y[i], z[i], &nx, &ny, &nz);
            f[i] = value, gx[i] = nx, gy[i] = ny, gz[i] = nz;
        }
    } else {
        LANES for (size_t i = 0; i < n; i++) {
            double nx, ny, nz;
            f[i] = shell_at(&s, x[i], y[i], z[i], &nx, &ny, &nz);
        }
    }
}

static void ellipsoid_values(const void *self, size_t n, sgt_points p, sgt_values out)
{
    shell s = shell_of(self);
    shell_values(&s, n, p, out);
}

SGT_INLINE double shell_rounding(const shell *s, double x, double y, double z)
{
    double z2 = z * z, w2 = s->e * z2, first = sgt_fma(z2, s->e, -s->a2), second = sgt_fma(y, y, first),
           all = sgt_fma(x, x, second);
    return 1.01 *
           (SGT_U * ((w2 + fabs(first)) + (fabs(second) + 4 * fabs(all)) + 0x1p-48 * (w2 + s->a2)) +
            0x1p-1020) *
           s->half;
}

static double ellipsoid_rounding(const void *self, sgt_vec3 p)
{
    shell s = shell_of(self);
    return shell_rounding(&s, p.x, p.y, p.z);
}

SGT_KERNEL
static void shell_roundings(const shell *shared, size_t n, sgt_points p, double *out)
{
    const shell s = *shared;
    const double *x = p.p[0], *y = p.p[1], *z = p.p[2];
    LANES for (size_t i = 0; i < n; i++) out[i] = shell_rounding(&s, x[i], y[i], z[i]);
}

static bool ellipsoid_roundings(const void *self, const sgt_shared *shared, size_t n, sgt_points p,
                                const double f[], double out[])
{
    shell s = shell_of(self);
    (void)f, (void)shared;
    shell_roundings(&s, n, p, out);
    return true;
}

SGT_KERNEL
static void shell_values_rounded(const shell *shared, size_t n, sgt_points p, sgt_values out, double *own)
{
    const shell s = *shared;
    const double *x = p.p[0], *y = p.p[1], *z = p.p[2];
    double *f = out.f, *gx = out.grad[0], *gy = out.grad[1], *gz = out.grad[2];
    LANES for (size_t i = 0; i < n; i++) {
        double nx, ny, nz, value = shell_at(&s, x[i], y[i], z[i], &nx, &ny, &nz);
        f[i] = value, gx[i] = nx, gy[i] = ny, gz[i] = nz;
        own[i] = shell_rounding(&s, x[i], y[i], z[i]);
    }
}

static bool ellipsoid_values_rounded(const void *self, const sgt_shared *shared, const double *const rows[3],
                                     size_t n, sgt_points p, sgt_values out, double own[])
{
    shell s = shell_of(self);
    (void)shared, (void)rows;
    shell_values_rounded(&s, n, p, out, own);
    return true;
}

static double ellipsoid_clearance(const void *self, sgt_vec3 p)
{
    shell s = shell_of(self);
    double w = p.z * s.stretch, r = sqrt(p.x * p.x + p.y * p.y + w * w);
    return (fabs(r - s.a) - 8 * SGT_U * (r + s.a)) / larger(1, s.stretch) * (1 - 8 * SGT_U);
}

SGT_INLINE void ellipsoid_approach(const sgt_ellipsoid *s, sgt_vec3 o, sgt_vec3 d, parabola *p, near_ray *r)
{
    double a = s->a, by = 1 / (1 - s->f);
    *r = near_ray_of(d);
    double l = r->d.x, m = r->d.y, n = r->d.z * by, A = l * l + m * m + n * n;
    near_ray_at(r, o, -(o.x * l + o.y * m + (o.z * by) * n) / A);
    double x = r->x.x, y = r->x.y, w = r->x.z * by, xl = x * l, ym = y * m, wn = w * n,
           r2 = x * x + y * y + w * w, a2 = a * a;
    *p = (parabola){A, xl + ym + wn, r2 - a2, A, fabs(xl) + fabs(ym) + fabs(wn), r2 + a2};
}

SGT_INLINE double ellipsoid_terms(const sgt_ellipsoid *s, const near_ray *r, double tau)
{
    return (void)r, (void)tau, 2 * (s->a * s->a);
}

/* The parabola is that of 2 a F. */
SGT_INLINE double ellipsoid_unit(const sgt_ellipsoid *s) { return 0.5 / s->a; }

SGT_INLINE outset ellipsoid_outset(const sgt_ellipsoid *self, sgt_vec3 p, sgt_vec3 d)
{
    shell s = shell_of(self);
    double x, y, z, unit = 2 * s.a, g = shell_at(&s, p.x, p.y, p.z, &x, &y, &z) * unit;
    x *= unit, y *= unit, z *= unit;
    return (outset){.g = g,
                       .g_err = shell_rounding(&s, p.x, p.y, p.z) * unit + 4 * SGT_U * fabs(g),
                       .slope = x * d.x + y * d.y + z * d.z,
                       .slope_err = COEFFICIENT * (fabs(x * d.x) + fabs(y * d.y) + fabs(z * d.z)),
                       .terms = fabs(x * p.x) + fabs(y * p.y) + fabs(z * p.z)};
}

QUADRATIC_SPANS(ellipsoid, sgt_ellipsoid, ellipsoid_approach, ellipsoid_unit, ellipsoid_terms,
                ellipsoid_outset)

/* F from x, y, z, and its slope along d, by plain intervals. */
static sgt_interval ellipsoid_plain(const sgt_ellipsoid *s, const sgt_ray *ray, double t0, sgt_interval t,
                                    sgt_interval *slope)
{
    sgt_interval x = plain_line(ray->o.x, ray->d.x, t0, t), y = plain_line(ray->o.y, ray->d.y, t0, t),
                 z = plain_line(ray->o.z, ray->d.z, t0, t), a = sgt_interval_of(s->a);
    sgt_interval b = sgt_interval_difference(sgt_interval_of(1), sgt_interval_of(s->f)),
                 w = sgt_interval_quotient(z, b), n = sgt_interval_quotient(sgt_interval_of(ray->d.z), b);
    sgt_interval half = sgt_interval_sum(
        sgt_interval_sum(sgt_interval_scaled(x, ray->d.x), sgt_interval_scaled(y, ray->d.y)),
        sgt_interval_product(w, n));
    sgt_interval g = sgt_interval_difference(
        sgt_interval_sum(sgt_interval_sum(sgt_interval_square(x), sgt_interval_square(y)),
                         sgt_interval_square(w)),
        sgt_interval_square(a));
    *slope = sgt_interval_quotient(half, a);
    return sgt_interval_quotient(g, sgt_interval_scaled(a, 2));
}

/* In twice the precision. */
typedef struct fine_shell { double a, half; twofold e, a2; mask known; } fine_shell;

static fine_shell fine_shell_of(const sgt_ellipsoid *s)
{
    twofold b = two_sum(1, -s->f);
    return (fine_shell){s->a, 0.5 / s->a, twofold_quotient(twofold_of(1), twofold_product(b, b)),
                        two_product(s->a, s->a),
                        MASK(s->a > 0x1p-200) & MASK(s->a < 0x1p200) & MASK(fabs(s->f) < 0x1p200)};
}

SGT_INLINE fine_parabola ellipsoid_parabola(const fine_shell *s, const fine_ray *r)
{
    twofold xl = twofold_scaled(r->x, r->l), ym = twofold_scaled(r->y, r->m),
            zn = twofold_product(twofold_scaled(r->z, r->n), s->e),
            n2 = twofold_product(two_product(r->n, r->n), s->e),
            w2 = twofold_product(twofold_product(r->z, r->z), s->e);
    twofold r2 = twofold_sum(twofold_sum(twofold_product(r->x, r->x), twofold_product(r->y, r->y)), w2);
    fine_parabola p = {twofold_sum(twofold_sum(two_product(r->l, r->l), two_product(r->m, r->m)), n2),
                       twofold_sum(twofold_sum(xl, ym), zn), twofold_difference(r2, s->a2), 0, 0, 0};
    p.Aa = p.A.hi, p.Ba = fabs(xl.hi) + fabs(ym.hi) + fabs(zn.hi) + 0x1p-700, p.Ca = r2.hi + s->a2.hi;
    return p;
}

SGT_NARROW(sgt_interval, sgt_ellipsoid_enclose_from,
           (const void *self, const sgt_ray *ray, double t0, sgt_interval t,
            sgt_interval *slope))
{
    const sgt_ellipsoid *s = self;
    sgt_interval g;
    fine_ray r;
    if (!stretch_valid(ray, t, &g, slope)) return g;
    if (!fine_ray_of(ray, t0, t, &r) || !(s->a > 0x1p-400 && s->a < 0x1p400 && fabs(s->f) < 0x1p200))
        return ellipsoid_plain(s, ray, t0, t, slope);
    fine_shell fine = fine_shell_of(s);
    fine_parabola p = ellipsoid_parabola(&fine, &r);
    sgt_interval twice = sgt_interval_of(2 * s->a);
    g = sgt_interval_quotient(fine_enclose(&p, &r, slope), twice);
    *slope = sgt_interval_quotient(*slope, twice);
    return g;
}

SGT_INLINE void ellipsoid_cell(const fine_shell *s, const fine_ray *r, lane_cell *out)
{
    fine_parabola p = ellipsoid_parabola(s, r);
    lane_parabola(&p, r, out);
}

LANE_CELLS(ellipsoid, fine_shell, fine_shell_of, ellipsoid_cell, s.half, s.known)

static sgt_interval ellipsoid_enclose(const void *self, const sgt_ray *ray, sgt_interval t,
                                      sgt_interval *slope)
{
    return sgt_ellipsoid_enclose_from(self, ray, 0, t, slope);
}

static void ellipsoid_second(const void *self, size_t n, sgt_points p, double *const out[6])
{
    shell s = shell_of(self);
    (void)p;
    for (size_t i = 0; i < n; i++) {
        out[0][i] = out[3][i] = s.inverse, out[5][i] = s.e * s.inverse;
        out[1][i] = out[2][i] = out[4][i] = 0;
    }
}

static size_t ellipsoid_parameters(const void *self) { return (void)self, 2; }

/* dF/da = -(x^2 + y^2 + w^2) / 2a^2 - 1/2, dF/df = z^2 / (a (1 - f)^3). */
static void ellipsoid_by_parameter(const void *self, size_t j, size_t n, sgt_points p, sgt_values out)
{
    const shell s = shell_of(self);
    const double *x = p.p[0], *y = p.p[1], *z = p.p[2], by_f = s.e * s.stretch * s.inverse,
                 i2 = s.inverse * s.inverse;
    for (size_t i = 0; i < n; i++) {
        out.f[i] = j ? by_f * (z[i] * z[i])
                     : -0.5 * ((x[i] * x[i] + y[i] * y[i] + s.e * (z[i] * z[i])) * i2 + 1);
        if (!out.grad[0]) continue;
        out.grad[0][i] = j ? 0 : -x[i] * i2, out.grad[1][i] = j ? 0 : -y[i] * i2,
        out.grad[2][i] = j ? 2 * by_f * z[i] : -(s.e * z[i]) * i2;
    }
}

static sgt_objection ellipsoid_object(const void *self)
{
    const sgt_ellipsoid *s = self;
    if (!(fabs(s->a) < HUGE_VAL)) return (sgt_objection){"a", "not finite"};
    if (!(fabs(s->f) < HUGE_VAL)) return (sgt_objection){"f", "not finite"};
    if (!(s->a > 0)) return (sgt_objection){"a", "not above 0"};
    if (!(s->f < 1)) return (sgt_objection){"f", "not below 1"};
    return (sgt_objection){NULL, NULL};
}

/* ---------------------------------------------------------------- in closed form (easy.h) */

typedef struct ball { sgt_ellipsoid self; shell shape; easy_shared easy; } ball;

/* The second derivatives are 1 / a, 1 / a and e / a. */
static ball ball_of(const sgt_ellipsoid *s)
{
    const shell all = shell_of(s);
    return (ball){*s, all, {0.5 / s->a, 2 * s->a, (2 + all.e) * all.inverse * (1 + 0x1p-40), 0x1p-860}};
}

SGT_INLINE easy_place ball_place(const ball *b, sgt_vec3 p)
{
    double x, y, z, f = shell_at(&b->shape, p.x, p.y, p.z, &x, &y, &z);
    return (easy_place){f, x, y, z, shell_rounding(&b->shape, p.x, p.y, p.z)};
}

EASY_LANES(ellipsoid, sgt_ellipsoid, ellipsoid_object, true, ball, ball_of, ellipsoid_approach,
           ball_place)

static const struct sgt_builtin_ops ellipsoid_builtin = {
    .object = ellipsoid_object, .roundings = ellipsoid_roundings, .enclose = sgt_ellipsoid_enclose_from,
    .encloses = ellipsoid_encloses, .values_rounded = ellipsoid_values_rounded,
    .first = ellipsoid_steep_first, .firsts = ellipsoid_steep_firsts, .easy = ellipsoid_easy,
    .easy_one = ellipsoid_easy_one};

const sgt_surface_ops sgt_ellipsoid_ops = {
    .name = "ellipsoid", .value = ellipsoid_value, .values = ellipsoid_values, .span = ellipsoid_span,
    .spans = ellipsoid_spans, .rounding = ellipsoid_rounding, .clearance = ellipsoid_clearance,
    .enclose = ellipsoid_enclose, .first = ellipsoid_first, .firsts = ellipsoid_firsts,
    .second = ellipsoid_second, .parameters = ellipsoid_parameters, .by_parameter = ellipsoid_by_parameter,
    .own_ = &ellipsoid_builtin};
