// SPDX-License-Identifier: MIT
// judge.h - is an answer of the library right?  The roots come from Arb; what the answer claims, from
// sagitta.h.
//
// Whatever is compared here is compared by balls: `certainly` is a proof.  A root counts `yes` or `no`
// where the rules of sgt_ray and of the rim say so whatever t_err the library might have (that of an
// unreported root is unknown, and taken as at most twice the margin of the rule itself, and on a level set
// as a thousand times what the rounding of F at the point makes of t: that of a cell is some hundred times
// as much), else `perhaps`.
#ifndef PROOF_JUDGE_H
#define PROOF_JUDGE_H

#include "optical.h"

#include <map>
#include <string>

namespace proof {

enum counts { no, perhaps, yes };

struct ends {
    double tmin, tmax;
    explicit ends(const sgt_ray &r) : tmin(r.tmin), tmax(r.tmax == 0 && r.tmin == 0 ? HUGE_VAL : r.tmax) {}
};

inline ball start_margin(const meeting &m) { return scaled(m.spread, -48) + scaled(size(m.t), -50); }

// `soft`: without proof the side of the rim is as the computed point has it.
inline counts counting(const meeting &m, const ends &e, bool soft = false)
{
    const bool hidden = soft && m.near_rim < 0x1p-48;
    if (m.inside < 0 && !hidden) return no;
    counts c = m.edge || !m.inside || m.twice || hidden ? perhaps : yes;
    const ball margin = start_margin(m), most = margin * 3 + ball(1000 * m.t_err);
    if (e.tmin > -HUGE_VAL) {
        const ball from = m.t - ball(e.tmin);
        if (less(from, margin)) return no;
        if (!less(most, from)) c = perhaps;
    }
    if (e.tmax < HUGE_VAL) {
        const ball left = ball(e.tmax) - m.t;
        if (less(left, -most)) return no;
        if (!less(most, left)) c = perhaps;
    }
    return c;
}

// Within [lo, hi]: yes, no, or too close to tell.
inline counts within(const ball &t, const ball &lo, const ball &hi)
{
    if (less(t, lo) || less(hi, t)) return no;
    return arb_le(lo.x, t.x) && arb_le(t.x, hi.x) ? yes : perhaps;
}
inline counts within(const meeting &m, const sgt_hit &h)
{
    return within(m.t, ball(h.t) - ball(h.t_err), ball(h.t) + ball(h.t_err));
}
inline bool doubted(const answer &a, const ball &lo, const ball &hi)
{
    for (const stretch &d : a.doubts)
        if (!less(d.hi, lo) && !less(hi, d.lo)) return true;
    return false;
}
inline const char *odd_number(const sgt_hit &h, const ends &e)
{
    if (!(h.t_err >= 0 && h.t_err < HUGE_VAL)) return "t_err is no bound";
    if (!(std::fabs(h.t_lo) <= h.t_err)) return "t_lo is beyond t_err";
    if (!(h.t >= e.tmin && h.t <= e.tmax)) return "t is not on the ray";
    if (!(h.p_err >= 0)) return "p_err is no bound";
    return nullptr;
}

// [lo, hi] of a hit: t +- t_err rounded outward, and no more.
inline const char *fault_of_stretch(const sgt_hit &h)
{
    const ball lo = ball(h.t) - ball(h.t_err), hi = ball(h.t) + ball(h.t_err),
               ulps = size(ball(h.t)) * 0x1p-51 + ball(h.t_err) * 0x1p-49 + 0x1p-1000;
    if (less(lo, ball(h.lo)) || less(ball(h.hi), hi)) return "t +- t_err is not within [lo, hi]";
    return less(ball(h.lo), lo - ulps) || less(hi + ulps, ball(h.hi)) ? "[lo, hi] is not t +- t_err"
                                                                      : nullptr;
}

// What is wrong with a hit of status HIT; NULL: nothing.  `alone`: one root and no other is promised.
inline const char *fault_of_hit(const answer &a, const sgt_hit &h, const ends &e, bool alone, bool soft,
                                const meeting **meant)
{
    const ball lo = ball(h.t) - ball(h.t_err), hi = ball(h.t) + ball(h.t_err);
    *meant = nullptr;
    if (const char *odd = odd_number(h, e)) return odd;
    if (a.lies) return "a change of sign where the ray lies in the surface";
    if (doubted(a, lo, hi)) return nullptr;
    int surely = 0, possibly = 0;
    for (const meeting &m : a.roots) {
        const counts c = within(m, h);
        surely += c == yes && !m.edge, possibly += c != no;
        if (c != no && (!*meant || less(size(m.t - ball(h.t) - ball(h.t_lo)),
                                        size((*meant)->t - ball(h.t) - ball(h.t_lo)))))
            *meant = &m;
    }
    if (possibly == 0) return "no root within t_err";
    if (alone && surely > 1) return "more than one root within t_err";
    if (surely == 1 && possibly == 1 && (*meant)->twice) return "a double root as a change of sign";
    if (possibly == 1) {
        if ((*meant)->inside < 0 && !(soft && (*meant)->near_rim < 0x1p-48)) return "a root beyond the rim";
        if (e.tmin > -HUGE_VAL && less((*meant)->t + ball(h.t_err) * 1.001,
                                       ball(e.tmin) + ball(h.t_err) + start_margin(**meant) * 0.999))
            return "a root at the start";
    }
    return nullptr;
}

// Of a graze: where |F| is of the order of its rounding.
inline const char *fault_of_graze(const sgt_hit &h, const ends &e)
{
    if (const char *odd = odd_number(h, e)) return odd;
    if (!(h.lo <= h.t && h.t <= h.hi)) return "a graze outside its stretch";
    return nullptr;
}

// A counting root certainly before `at`.
inline const meeting *before(const answer &a, const ball &at, const ends &e, bool soft)
{
    for (const meeting &m : a.roots)
        if (counting(m, e, soft) == yes && less(m.t, at)) return &m;
    return nullptr;
}

} // namespace proof
#endif
