// SPDX-License-Identifier: MIT
/* radial.h - radial polynomials beyond the radius that they are made for.
 *
 * THE TAIL.  Let P be a sum of functions of r that are positive and grow from some radius R on, each faster
 * than the one before it: the quotients increase, and the least of those that count grows as r^2 or faster.
 * Take the sign of the last term, and the terms from the last on down to the first of the other sign.  From
 * these subtract all terms of the other sign.  What is left is less than |P|; and if it is above 0 at R, then
 * P has that sign for all r >= R, and |P| is at least (r / R)^2 times that.  The others of the same sign are
 * left out, as they grow too slowly.
 *
 * ZERNIKE'S.
 * R_n^m(u) = u^m P_k^(0,m)(2 u^2 - 1), n = m + 2 k, with P of Jacobi.  All zeros are in [0, 1], so R and its
 * derivatives increase beyond 1; and they are not above their values at 1 before (zernike.c).  So over [0, u]
 * the greatest values are those at u.  With w = u^2 - 1
 *     P_k^(0,m)(1 + 2 w) = sum over j of C(k, j) C(k + m + j, j) w^j
 * (Szego 1975, 4.21.2), where no term is negative: rounding is at most some 8 (k + m) u of the sum. */
#ifndef SGT_SURFACE_DEPARTURE_RADIAL_H
#define SGT_SURFACE_DEPARTURE_RADIAL_H

#include "departure.h"

#include "../../num/elementary.h"

/* |R|, |R'| and |R''| over [0, u], u >= 1, but for rounding.  They may overflow, and be NaN then. */
SGT_INLINE bounds radial_beyond(size_t k, size_t m, double u)
{
    double v = u * u, w = (u - 1) * (u + 1), order = (double)m, q = 0, dq = 0, ddq = 0;
    /* from the highest power on: c_j / c_(j-1) = (k - j + 1) (k + m + j) / j^2, taken into w */
    for (size_t j = k + 1; j-- > 0;) {
        double n = (double)j, next = (n + 1) * (n + 1),
               ratio = ((double)k - n) * ((double)(k + m) + n + 1) / next;
        ddq = ratio * (w * ddq + 2 * dq), dq = ratio * (w * dq + q), q = 1 + ratio * w * q;
    }
    double power = integer_power(u, (unsigned)m);
    return (bounds){power * q, power / u * (order * q + 2 * v * dq),
                    power / v * (order * (order - 1) * q + v * ((4 * order + 2) * dq + 4 * v * ddq))};
}

/* The tail of P = sum of a[m] p_m; size[m] is p_m at R, with the sign -1 for an odd m if they alternate.
 * a_err: as in q.h; NULL: they are exact.  `from`: the first m that may count. */
SGT_INLINE double radial_tail(const double *size, size_t from, size_t terms, const double *a,
                              const double *a_err, bool alternate)
{
    double sum = 0, all = 0, sign = 0;
    bool against = false;
    for (size_t m = terms; m-- > 0;) {
        double term = alternate && m % 2 == 1 ? -a[m] : a[m];
        if (sign == 0) sign = copysign(1, term);
        double least = sign * term - (a_err ? a_err[m] : 0);
        if (a[m] == 0 && !(least < 0)) continue;
        all += (fabs(a[m]) + fabs(least)) * size[m];
        against = against || least < 0;
        if (least < 0 || (!against && m >= from)) sum += least * size[m];
    }
    sum -= 0x1p-30 * all;
    return sum > 0 && sum < HUGE_VAL ? sign * sum : 0;
}

#endif
