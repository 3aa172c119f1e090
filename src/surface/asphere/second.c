// SPDX-License-Identifier: MIT
/* asphere/second.c - derivatives of the even asphere for sensitivities.
 *
 * The formulas of the conic are in sag/second.h.  With q = r^2 and P = sum of a[i] q^(i + 1), the departure
 * adds
 *     P_xx = 2 P' + 4 P'' x^2,   P_xy = 4 P'' x y,
 *     dP/da[i] = q^(i + 1),      its gradient 2 (i + 1) q^i (x, y). */
#include "../sag/second.h"

#include <sagitta/surfaces.h>

SGT_KERNEL
static void asphere_second_lanes(const double *a, size_t n, const double *x, const double *y, double *xx,
                                 double *xy, double *yy)
{
    double a0 = a[0], a1 = 2 * a[1], a2 = 3 * a[2], a3 = 4 * a[3], a4 = 5 * a[4], a5 = 6 * a[5],
           a6 = 7 * a[6], a7 = 8 * a[7];
    LANES for (size_t i = 0; i < n; i++) {
        double q = x[i] * x[i] + y[i] * y[i];
        double once = a0 + q * (a1 + q * (a2 + q * (a3 + q * (a4 + q * (a5 + q * (a6 + q * a7))))));
        double twice = a1 + q * (2 * a2 +
                                 q * (3 * a3 + q * (4 * a4 + q * (5 * a5 + q * (6 * a6 + q * (7 * a7))))));
        xx[i] -= 2 * once + 4 * twice * (x[i] * x[i]);
        xy[i] -= 4 * twice * (x[i] * y[i]);
        yy[i] -= 2 * once + 4 * twice * (y[i] * y[i]);
    }
}

void sgt_asphere_second(const void *self, size_t n, sgt_points p, double *const out[6])
{
    const sgt_even_asphere *s = self;
    sgt_conic base = {.c = s->c, .k = s->k};
    sgt_conic_second(&base, n, p, out);
    asphere_second_lanes(s->a, n, p.p[0], p.p[1], out[0], out[1], out[3]);
}

size_t sgt_asphere_parameters(const void *self)
{
    (void)self;
    return 10;
}

/* q^i for i = 0 ... 7, by squares.  A multiplication by 1 costs next to nothing. */
SGT_INLINE double asphere_power(double q, int i)
{
    double q2 = q * q;
    return (i & 1 ? q : 1) * (i & 2 ? q2 : 1) * (i & 4 ? q2 * q2 : 1);
}

SGT_KERNEL
static void by_term(int term, size_t n, const double *x, const double *y, double *f)
{
    LANES for (size_t i = 0; i < n; i++) {
        double q = x[i] * x[i] + y[i] * y[i];
        f[i] = -(q * asphere_power(q, term));
    }
}

SGT_KERNEL
static void by_term_all(int term, size_t n, const double *x, const double *y, double *f, double *fx,
                        double *fy, double *fz)
{
    double factor = -2.0 * (term + 1);
    LANES for (size_t i = 0; i < n; i++) {
        double q = x[i] * x[i] + y[i] * y[i], to = asphere_power(q, term), g = factor * to;
        f[i] = -(q * to), fx[i] = x[i] * g, fy[i] = y[i] * g, fz[i] = 0;
    }
}

void sgt_asphere_by_parameter(const void *self, size_t j, size_t n, sgt_points p, sgt_values out)
{
    const sgt_even_asphere *s = self;
    sgt_conic base = {.c = s->c, .k = s->k};
    if (j < 2) sgt_conic_by_parameter(&base, j, n, p, out);
    else if (!out.grad[0]) by_term((int)j - 2, n, p.p[0], p.p[1], out.f);
    else by_term_all((int)j - 2, n, p.p[0], p.p[1], out.f, out.grad[0], out.grad[1], out.grad[2]);
}
