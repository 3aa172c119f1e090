// SPDX-License-Identifier: MIT
// agree.h - can two answers to one question both be right?
//
// A question asked twice (at another scale, of the same shape as another type) has one truth.  Each answer
// may leave a part of it undecided, and its numbers may differ by both error bounds; more they may not.
#ifndef TESTS_CATALOGUE_AGREE_H
#define TESTS_CATALOGUE_AGREE_H

#include <sagitta/sagitta.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace catalogue {

// As far apart as the errors of both, and an ulp or two, allow.
inline bool one_root(const sgt_hit &a, const sgt_hit &b)
{
    return std::fabs(a.t - b.t) <=
           (a.t_err + b.t_err) * (1 + 0x1p-40) + 0x1p-51 * std::max(std::fabs(a.t), std::fabs(b.t));
}

// Two first roots.  NULL: they agree.
inline const char *first_contradiction(const sgt_hit &a, const sgt_hit &b)
{
    if ((a.status == SGT_HIT && b.status == SGT_MISS) || (a.status == SGT_MISS && b.status == SGT_HIT))
        return "a hit and a miss";
    if (a.status == SGT_HIT && b.status == SGT_HIT && !one_root(a, b)) return "two roots";
    const sgt_hit *graze = a.status == SGT_GRAZE   ? &a
                           : b.status == SGT_GRAZE ? &b
                                                   : nullptr,
                  *hit = graze == &a ? &b : &a;
    if (graze && hit->status == SGT_HIT && hit->t + hit->t_err < graze->lo)
        return "a hit before a graze that is the first";
    return nullptr;
}

// Two lists of all entries.  A hit of one is a hit or in an undecided stretch of the other.
inline const char *hits_missing(const std::vector<sgt_hit> &of, const std::vector<sgt_hit> &in)
{
    for (const sgt_hit &h : of) {
        if (h.status != SGT_HIT) continue;
        bool found = false;
        for (const sgt_hit &other : in) {
            const double room = h.t_err + 0x1p-51 * std::fabs(h.t);
            found = found || (other.status == SGT_HIT ? one_root(h, other)
                                                      : h.t + room >= other.lo && h.t - room <= other.hi);
        }
        if (!found) return "a root is missing";
    }
    return nullptr;
}

inline const char *list_contradiction(const std::vector<sgt_hit> &a, const std::vector<sgt_hit> &b)
{
    const char *why = hits_missing(a, b);
    return why ? why : hits_missing(b, a);
}

} // namespace catalogue
#endif
