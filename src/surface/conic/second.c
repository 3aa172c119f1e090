// SPDX-License-Identifier: MIT
/* conic/second.c - derivatives of the conic for sensitivities.  The formulas are in sag/second.h. */
#include "../sag/second.h"

#include <sagitta/surfaces.h>
#include <string.h>

SGT_KERNEL
static void conic_second_lanes(double c, double k, size_t n, const double *x, const double *y,
                               double *const out[6])
{
    double *xx = out[0], *xy = out[1], *xz = out[2], *yy = out[3], *yz = out[4], *zz = out[5];
    LANES for (size_t i = 0; i < n; i++) {
        curvatures s = conic_second(c, k, x[i], y[i]);
        xx[i] = -s.xx, xy[i] = -s.xy, yy[i] = -s.yy;
        xz[i] = yz[i] = zz[i] = 0;
    }
}

void sgt_conic_second(const void *self, size_t n, sgt_points p, double *const out[6])
{
    const sgt_conic *s = self;
    conic_second_lanes(s->c, s->k, n, p.p[0], p.p[1], out);
}

size_t sgt_conic_parameters(const void *self)
{
    (void)self;
    return 2;
}

/* Two loops over points: F only, and F with its gradient. */
#define BY(NAME)                                                                                        \
    SGT_KERNEL                                                                                          \
    static void NAME##_only(double c, double k, size_t n, const double *x, const double *y, double *f) \
    {                                                                                                   \
        LANES for (size_t i = 0; i < n; i++) f[i] = -conic_##NAME(c, k, x[i] * x[i] + y[i] * y[i]).f;   \
    }                                                                                                   \
    SGT_KERNEL                                                                                          \
    static void NAME##_all(double c, double k, size_t n, const double *x, const double *y, double *f,   \
                           double *fx, double *fy, double *fz)                                          \
    {                                                                                                   \
        LANES for (size_t i = 0; i < n; i++)                                                            \
        {                                                                                               \
            derivative by = conic_##NAME(c, k, x[i] * x[i] + y[i] * y[i]);                              \
            f[i] = -by.f, fx[i] = -x[i] * by.g, fy[i] = -y[i] * by.g, fz[i] = 0;                        \
        }                                                                                               \
    }
BY(by_c)
BY(by_k)

/* For a plane the derivative by c is r^2 / 2, with gradient (x, y).  That by k is 0. */
SGT_KERNEL
static void plane_by_c(size_t n, const double *x, const double *y, double *f)
{
    LANES for (size_t i = 0; i < n; i++) f[i] = -0.5 * (x[i] * x[i] + y[i] * y[i]);
}

static void plane_by(size_t j, size_t n, const double *x, const double *y, sgt_values out)
{
    if (j == 0) plane_by_c(n, x, y, out.f);
    else memset(out.f, 0, n * sizeof(double));
    for (size_t i = 0; out.grad[0] && i < n; i++)
        out.grad[0][i] = j ? 0 : -x[i], out.grad[1][i] = j ? 0 : -y[i], out.grad[2][i] = 0;
}

void sgt_conic_by_parameter(const void *self, size_t j, size_t n, sgt_points p, sgt_values out)
{
    const sgt_conic *s = self;
    const double *x = p.p[0], *y = p.p[1];
    if (s->c == 0) plane_by(j, n, x, y, out);
    else if (!out.grad[0]) (j ? by_k_only : by_c_only)(s->c, s->k, n, x, y, out.f);
    else (j ? by_k_all : by_c_all)(s->c, s->k, n, x, y, out.f, out.grad[0], out.grad[1], out.grad[2]);
}
