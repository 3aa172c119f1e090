// SPDX-License-Identifier: MIT
/* second.h - derivatives of the conic's sag for sensitivities: by the point twice, and by c and k.
 *
 * Let q = r^2, e = (1 + k) c^2, phi = sqrt(1 - e q) and s = c q / (1 + phi).  Then ds/dq = c / (2 phi), and
 *     dphi/dq = -e / (2 phi),   dphi/dc = -(1 + k) c q / phi,   dphi/dk = -c^2 q / (2 phi).
 * Since e q = (1 - phi)(1 + phi), the derivatives become
 *     s_xx = c (phi^2 + e x^2) / phi^3,     s_xy = c e x y / phi^3,
 *     ds/dc = q / (phi (1 + phi)),          its gradient (x, y) / phi^3,
 *     ds/dk = s^2 c / (2 phi),              its gradient (x, y) c^3 q / (2 phi^3).
 * phi^2 + e x^2 = 1 - e y^2.  The first form is a sum of like signs for e > 0, the second for e < 0.
 *
 * ROUNDING.  phi carries the condition of the sag, u (5 |e q| / phi^2 + 1) relative, and phi^3 three times
 * that.  Beside it no formula has more than 8 roundings.  Where c^2 r^2 overflows, the derivatives by c and
 * k are 0 or NaN. */
#ifndef SGT_SURFACE_SAG_SECOND_H
#define SGT_SURFACE_SAG_SECOND_H

#include "../../num/lanes.h"

#include <sagitta/sagitta.h>

/* s_xx, s_xy, s_yy. */
typedef struct curvatures { double xx, xy, yy; } curvatures;

SGT_INLINE curvatures conic_second(double c, double k, double x, double y)
{
    double k1c = (1 + k) * c, e = k1c * c, up = e > 0 ? e : 0, down = e > 0 ? 0 : e;
    double r2 = x * x + y * y, phi2 = 1 - k1c * (c * r2), phi = sqrt(phi2), base = e > 0 ? phi2 : 1,
           f = c / (phi2 * phi);
    return (curvatures){f * (base + (up * (x * x) - down * (y * y))), f * (e * (x * y)),
                        f * (base + (up * (y * y) - down * (x * x)))};
}

/* A derivative f of s, and g with the gradient (x, y) g. */
typedef struct derivative { double f, g; } derivative;

SGT_INLINE derivative conic_by_c(double c, double k, double r2)
{
    double phi2 = 1 - (1 + k) * c * (c * r2), phi = sqrt(phi2);
    return (derivative){r2 / (phi + phi2), 1 / (phi2 * phi)};
}

SGT_INLINE derivative conic_by_k(double c, double k, double r2)
{
    double cr2 = c * r2, phi2 = 1 - (1 + k) * c * cr2, phi = sqrt(phi2), more = 1 + phi;
    return (derivative){c * (cr2 * cr2) / (2 * phi * (more * more)), c * c * cr2 / (2 * phi2 * phi)};
}

void sgt_conic_second(const void *self, size_t n, sgt_points p, double *const out[6]);
size_t sgt_conic_parameters(const void *self);
void sgt_conic_by_parameter(const void *self, size_t j, size_t n, sgt_points p, sgt_values out);

void sgt_asphere_second(const void *self, size_t n, sgt_points p, double *const out[6]);
size_t sgt_asphere_parameters(const void *self);
void sgt_asphere_by_parameter(const void *self, size_t j, size_t n, sgt_points p, sgt_values out);

#endif
