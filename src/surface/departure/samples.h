// SPDX-License-Identifier: MIT
/* samples.h - the range of a polynomial, from its values at some points.
 *
 * A polynomial p of degree n is at most C max |p(x_j)| on [-1, 1], where the x_j are the M > n zeros of
 * Chebyshev's T_M, and C = 1 / cos(n pi / 2 M) (Ehlich and Zeller 1964, Math. Z. 86, 41).  With M >= 4 n that
 * is 1.08240 at most.  For p less the middle of the values it says that p lies in the range of the values,
 * made wider by 8 % of it.
 *
 * This knows how the terms of a sum add up, which a sum of bounds does not: of alternating terms it is a
 * tenth, or less.  The nodes are rounded by 4 u, which moves p by 8 u n^2 of its greatest value (A. A.
 * Markov), far less than what C was rounded up by, as n is at most 64. */
#ifndef SGT_SURFACE_DEPARTURE_SAMPLES_H
#define SGT_SURFACE_DEPARTURE_SAMPLES_H

#include "departure.h"

#include "../../num/elementary.h"

enum { SAMPLES_A_DEGREE = 4 };
static const double SAMPLED = 1.0825;

/* cos(pi (2 j + 1) / (2 M)), j < M / 2: the node of T_M, of those above 0. */
SGT_INLINE double sample_node(size_t j, size_t M)
{
    const double quarter = 0.78539816339744831; /* pi / 4 */
    const double part = (double)(4 * j + 2) / (double)M; /* of it, at most 2 */
    return part <= 1 ? sine_cosine_of((twofold){quarter * part, 0}).cosine
                     : sine_cosine_of((twofold){quarter * (2 - part), 0}).sine;
}

/* The range of p if its values at the nodes lie in [lo, hi], each off by `off` at most. */
SGT_INLINE sgt_interval sampled_range(double lo, double hi, double off)
{
    double middle = 0.5 * (lo + hi), half = 0.5 * SAMPLED * (hi - lo) + 2 * off;
    return (sgt_interval){middle - half, middle + half};
}

#endif
