// SPDX-License-Identifier: MIT
// quick_sign.h - the sign of F at a point of a ray, certain or not told, in 113 bits.
//
// Each number comes with a bound on its error, worked out in double beside it and widened at the end: a
// product's is |a| e_b + |b| e_a + u |a b|, u = 2^-112, and so on.  Where the bound leaves a sign open, or
// the point is off the domain, Arb is asked.
#ifndef PROOF_QUICK_SIGN_H
#define PROOF_QUICK_SIGN_H

#include "../oracle/levels.h"

#include <cfloat>

namespace proof {

#if LDBL_MANT_DIG == 113
typedef long double quad;
#else
__extension__ typedef __float128 quad;
#endif

struct rounded {
    quad v;
    double e; // |v - exact| <= e
    rounded(double x = 0) : v(x), e(0) {}
    rounded(quad value, double error) : v(value), e(error * (1 + 0x1p-50)) {}
    double size() const { return std::fabs(static_cast<double>(v)) * (1 + 0x1p-52); }
    int sign() const { return size() > e * (1 + 0x1p-40) + DBL_MIN ? (v > 0 ? 1 : -1) : 0; }
    static constexpr double u = 0x1p-112;
    friend rounded operator+(const rounded &a, const rounded &b)
    {
        const quad sum = a.v + b.v;
        return {sum, a.e + b.e + u * std::fabs(static_cast<double>(sum))};
    }
    friend rounded operator-(const rounded &a, const rounded &b)
    {
        const quad sum = a.v - b.v;
        return {sum, a.e + b.e + u * std::fabs(static_cast<double>(sum))};
    }
    friend rounded operator*(const rounded &a, const rounded &b)
    {
        const quad product = a.v * b.v;
        return {product, a.e * (b.size() + b.e) + b.e * a.size() +
                             u * std::fabs(static_cast<double>(product)) + DBL_MIN};
    }
};

// Of F = z - s at t + by; 0: not told.
inline int quick_sign(const sgt_even_asphere &s, bool asphere, const sgt_ray &r, double at, double by)
{
    const rounded t = rounded(at) + rounded(by), x = rounded(r.o.x) + t * r.d.x,
                  y = rounded(r.o.y) + t * r.d.y, z = rounded(r.o.z) + t * r.d.z;
    const rounded rho = x * x + y * y, k1 = rounded(s.k) + rounded(1);
    rounded sum(0);
    int terms = asphere ? 8 : 0;
    while (terms > 0 && s.a[terms - 1] == 0) terms--;
    for (int i = terms; i-- > 0;) sum = (sum + rounded(s.a[i])) * rho;
    const rounded w = z - sum, kc = k1 * s.c, h = rounded(1) - kc * w;
    if ((rounded(1) - kc * s.c * rho).sign() <= 0) return 0;
    if (h.sign() < 0) return kc.sign(); // beyond the other sheet
    if (h.sign() == 0) return 0;
    return -(rounded(s.c) * (rho + k1 * w * w) - w - w).sign();
}

// Of |Q_N| - E.
inline int quick_sign(const oracle::level &f, const sgt_ray &r, double at, double by)
{
    const rounded t = rounded(at) + rounded(by);
    const rounded p[3] = {rounded(r.o.x) + t * r.d.x, rounded(r.o.y) + t * r.d.y, rounded(r.o.z) + t * r.d.z};
    rounded q[4], c[4];
    for (int i = 0; i < 4; i++) {
        q[i] = rounded(f.s.at[i]) + p[0] * f.s.ex[i] + p[1] * f.s.ey[i] + p[2] * f.s.ez[i];
        c[i] = f.mandelbrot ? q[i] : rounded(f.s.c[i]);
    }
    const rounded bound = rounded(f.s.escape) * f.s.escape;
    const double far = std::fmax(f.s.escape, oracle::safe_escape(f) * (1 + 1e-9));
    for (int n = f.mandelbrot;; n++) {
        const rounded size = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        if (n == f.s.iterations) return (size - bound).sign();
        if ((size - rounded(far) * far).sign() > 0) return 1;
        // (a + v)^p = A + f v with s = |v|^2: A' = a A - s f, f' = a f + A
        const rounded s = q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
        rounded A = q[0], along(1);
        for (int i = 1; i < f.s.power; i++) {
            const rounded next = q[0] * A - s * along;
            along = q[0] * along + A;
            A = next;
        }
        q[0] = A + c[0];
        for (int i = 1; i < 4; i++) q[i] = along * q[i] + c[i];
    }
}

} // namespace proof
#endif
