// SPDX-License-Identifier: MIT
/* quantile.c - quantiles and shares with their intervals, whatever the distribution.
 *
 * Of n values let B be how many lie at or below the true quantile q of p: binomial of n and p.  The r-th
 * smallest is above q exactly if B < r, and the s-th is at or below it exactly if B >= s.  So with the
 * greatest r of P(B <= r - 1) <= a/2 and the least s of P(B >= s) <= a/2 the true one lies between them with
 * the probability 1 - a at least.
 *
 * A binomial sum needs no gamma function: weights are worked out from the most likely number outward, each
 * from its neighbour, w(k + 1) / w(k) = (n - k) / (k + 1) p / (1 - p), and divided by their sum.  Those
 * below LEAST of the greatest are left out: they fall at least geometrically from there. */
#include "tolerance.h"

#include <math.h>

static const double LEAST = 1e-30;

/* P(B <= k), and in *least P(B >= k). */
static double at_most(size_t n, double p, size_t k, double *least)
{
    if (p <= 0 || p >= 1) {
        const size_t all = p <= 0 ? 0 : n;
        *least = all >= k;
        return all <= k;
    }
    const double odds = p / (1 - p), most = floor((double)(n + 1) * p);
    const size_t mode = most < (double)n ? (size_t)most : n;
    double sum = 0, low = 0, high = 0, w = 1;
    for (size_t i = mode;; i--) { /* downward, the mode with them */
        sum += w;
        if (i <= k) low += w;
        if (i >= k) high += w;
        w *= (double)i / ((double)(n - i + 1) * odds);
        if (i == 0 || !(w > LEAST)) break;
    }
    w = 1;
    for (size_t i = mode; i < n; i++) {
        w *= (double)(n - i) / (double)(i + 1) * odds;
        if (!(w > LEAST)) break;
        sum += w;
        if (i + 1 <= k) low += w;
        if (i + 1 >= k) high += w;
    }
    *least = high / sum;
    return low / sum;
}

sgt_confidence sgt_quantile(size_t n, const double sorted[], double p, double confidence)
{
    const double half = (1 - confidence) / 2;
    sgt_confidence q = {(double)NAN, (double)NAN, (double)NAN};
    double least;
    if (n == 0 || !(p > 0 && p < 1) || !(confidence > 0 && confidence < 1)) return q;
    const double place = ceil((double)n * p);
    q.estimate = sorted[place < 1 ? 0 : (size_t)place - 1];
    size_t r = 0, s = n + 1;                     /* r: the greatest known, or none; s: the least */
    for (size_t from = 1, to = n; from <= to;) { /* P(B <= k - 1) rises with k */
        const size_t k = from + (to - from) / 2;
        if (at_most(n, p, k - 1, &least) <= half)
            r = k, from = k + 1;
        else
            to = k - 1;
    }
    for (size_t from = 1, to = n; from <= to;) { /* P(B >= k) falls with k */
        const size_t k = from + (to - from) / 2;
        at_most(n, p, k, &least);
        if (least <= half)
            s = k, to = k - 1;
        else
            from = k + 1;
    }
    if (r >= 1) q.lower = sorted[r - 1];
    if (s <= n) q.upper = sorted[s - 1];
    return q;
}

sgt_confidence sgt_share(size_t k, size_t n, double confidence)
{
    enum { HALVINGS = 60 };
    const double half = (1 - confidence) / 2;
    sgt_confidence q = {(double)NAN, 0, 1};
    double least;
    if (n == 0 || k > n || !(confidence > 0 && confidence < 1)) return q;
    q.estimate = (double)k / (double)n;
    double low = 0, high = q.estimate; /* P(B >= k) rises with p */
    for (int i = 0; k > 0 && i < HALVINGS; i++) {
        const double p = (low + high) / 2;
        at_most(n, p, k, &least);
        if (least <= half)
            low = p;
        else
            high = p;
    }
    if (k > 0) q.lower = low;
    low = q.estimate, high = 1; /* P(B <= k) falls with p */
    for (int i = 0; k < n && i < HALVINGS; i++) {
        const double p = (low + high) / 2;
        if (at_most(n, p, k, &least) <= half)
            high = p;
        else
            low = p;
    }
    if (k < n) q.upper = high;
    return q;
}
