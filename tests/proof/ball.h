// SPDX-License-Identifier: MIT
// ball.h - Arb's balls as numbers, and the search for every root in a stretch.
//
// A ball is a real number known to within a radius; every operation's ball contains its result, so a
// sign that a ball shows is certain.  `bits` is the precision of the operations, for all.
//
// The search.  A cell is s = middle +- 2^e.  What an equation says of a cell is an enclosure of g and
// of g' on it, or that it has no root there.  A cell where g keeps its sign is done; one where g' does
// has one root at most, told by the signs of g at its ends, and an interval Newton step closes in on
// it; any other is halved.  The middle of the first cell is off the middle of the stretch by an odd
// part, so that no root is at the end of a cell unless someone means it to be; a sign that cannot be
// told there is a doubt.  Cells smaller than 2^-depth of the first are doubts as well: a double root,
// or two that no double can tell apart.
#ifndef PROOF_BALL_H
#define PROOF_BALL_H

#if __has_include(<arb.h>)
#include <arb.h>
#include <arb_poly.h>
#else
#include <flint/arb.h>
#include <flint/arb_poly.h>
#endif

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace proof {

inline slong bits = 128;

// The precision for the length of a block.
class precision {
public:
    explicit precision(slong b) : before_(bits) { bits = b; }
    ~precision() { bits = before_; }
    precision(const precision &) = delete;
    precision &operator=(const precision &) = delete;

private:
    slong before_;
};

class ball {
public:
    ball() { arb_init(x); }
    ball(double v) { arb_init(x), arb_set_d(x, v); }
    ball(const ball &b) { arb_init(x), arb_set(x, b.x); }
    ball(ball &&b) noexcept { arb_init(x), arb_swap(x, b.x); }
    ball &operator=(const ball &b) { arb_set(x, b.x); return *this; }
    ball &operator=(ball &&b) noexcept { arb_swap(x, b.x); return *this; }
    ~ball() { arb_clear(x); }

    friend ball operator+(const ball &a, const ball &b) { ball r; arb_add(r.x, a.x, b.x, bits); return r; }
    friend ball operator-(const ball &a, const ball &b) { ball r; arb_sub(r.x, a.x, b.x, bits); return r; }
    friend ball operator*(const ball &a, const ball &b) { ball r; arb_mul(r.x, a.x, b.x, bits); return r; }
    friend ball operator/(const ball &a, const ball &b) { ball r; arb_div(r.x, a.x, b.x, bits); return r; }
    ball operator-() const { ball r; arb_neg(r.x, x); return r; }
    ball &operator+=(const ball &b) { arb_add(x, x, b.x, bits); return *this; }
    ball &operator-=(const ball &b) { arb_sub(x, x, b.x, bits); return *this; }
    ball &operator*=(const ball &b) { arb_mul(x, x, b.x, bits); return *this; }
    void add_product(const ball &a, const ball &b) { arb_addmul(x, a.x, b.x, bits); }

    int sign() const { return arb_is_positive(x) ? 1 : arb_is_negative(x) ? -1 : 0; } // 0: not known, or zero
    bool is_zero() const { return arb_is_zero(x); }                                  // exactly
    bool is_finite() const { return arb_is_finite(x); }
    double rough() const { return arf_get_d(arb_midref(x), ARF_RND_NEAR); }
    double radius() const { return mag_get_d(arb_radref(x)); }

    arb_t x;
};

inline ball square(const ball &a) { ball r; arb_sqr(r.x, a.x, bits); return r; }
inline ball root_of(const ball &a) { ball r; arb_sqrtpos(r.x, a.x, bits); return r; }
inline ball size(const ball &a) { ball r; arb_abs(r.x, a.x); return r; }
inline ball scaled(const ball &a, slong e) { ball r; arb_mul_2exp_si(r.x, a.x, e); return r; }
inline ball middle(const ball &a) { ball r; arb_get_mid_arb(r.x, a.x); return r; }
inline ball low(const ball &a) { ball r; arb_get_lbound_arf(arb_midref(r.x), a.x, bits); return r; }
inline ball high(const ball &a) { ball r; arb_get_ubound_arf(arb_midref(r.x), a.x, bits); return r; }
inline ball between(const ball &a, const ball &b) { ball r; arb_union(r.x, a.x, b.x, bits); return r; }
inline bool is_number(const ball &a) { return !arf_is_nan(arb_midref(a.x)); } // or a ball without end
// Takes away from a what is not in b; false: a stays, as nothing would be left, or as one of them is NaN, of
// which arb_intersection makes numbers.
inline bool cut_to(const ball &b, ball *a)
{
    ball both;
    const bool common = is_number(*a) && is_number(b) && arb_intersection(both.x, a->x, b.x, bits);
    if (common) *a = both;
    return common;
}
inline ball around(const ball &a, slong e) { ball r = middle(a); arb_add_error_2exp_si(r.x, e); return r; }
inline bool less(const ball &a, const ball &b) { return arb_lt(a.x, b.x); } // certainly
inline std::string text(const ball &a, slong digits = 30)
{
    char *s = arb_get_str(a.x, digits, 0);
    std::string r(s);
    flint_free(s);
    return r;
}
// The least e with |a| <= 2^e, nearly.
inline slong exponent(const ball &a)
{
    mag_t m;
    mag_init(m);
    arb_get_mag(m, a.x);
    const slong e = mag_is_zero(m) ? -100000 : mag_is_inf(m) ? 100000 : MAG_EXP(m);
    mag_clear(m);
    return e;
}

struct stretch {
    ball lo, hi;
};

struct found {
    std::vector<ball> roots; // narrow, in order
    std::vector<stretch> doubts;
    long cells = 0;
    bool gave_up = false; // the budget of cells was spent: what is left is a doubt
};

// Equation: bool enclose(middle, e, &g, &slope): false, no root in the cell; ball value(s).
template <class equation> int sign_at(const equation &q, const ball &s, slong most = 2400)
{
    for (slong b = std::max<slong>(bits, 192); b <= most; b *= 2) {
        const precision p(b);
        const int sign = q.value(s).sign();
        if (sign) return sign;
    }
    return 0;
}

// One root in [lo, hi], where g' has the sign of `slope`; narrowed to 2^-230 of `unit`, or as far as can be
// told.
template <class equation> ball close_in(const equation &q, ball lo, ball hi, ball slope, slong unit)
{
    const precision p(320);
    ball x = between(lo, hi);
    for (int i = 0; i < 400; i++) {
        const ball m = middle(x), g = q.value(m), step = g / slope;
        ball next = m - step, both;
        slong before = exponent(x - m);
        if (!next.is_finite() || !arb_intersection(both.x, next.x, x.x, bits)) both = x;
        slong after = exponent(both - middle(both));
        if (after > before - 1) { // Newton does not halve it: bisect
            const int at = g.sign() * slope.sign();
            if (at > 0) both = between(low(x), m);
            else if (at < 0) both = between(m, high(x));
            else return both;
            after = exponent(both - middle(both));
            if (after >= before) return both;
        }
        x = both;
        if (after < unit - 230) return x;
        ball g_all, narrower;
        if (q.enclose(middle(x), after, &g_all, &narrower) && narrower.sign() != 0) slope = narrower;
    }
    return x;
}

template <class equation>
void search(const equation &q, const ball &lo, const ball &hi, slong depth, long budget, found *out)
{
    struct cell { ball m; slong e; };
    std::vector<cell> todo;
    const ball half = scaled(hi - lo, -1);
    const slong first = exponent(half) + 1;
    // (an odd part of a third of the slack that the power of two leaves, at least)
    todo.push_back({middle(scaled(lo + hi, -1) + scaled(ball(0.31830988618379067), first - 6)), first});
    const auto doubt = [&](const ball &a, const ball &b) {
        if (!out->doubts.empty() && arb_equal(out->doubts.back().hi.x, a.x)) out->doubts.back().hi = b;
        else out->doubts.push_back({a, b});
    };
    while (!todo.empty()) {
        const cell c = std::move(todo.back());
        todo.pop_back();
        const precision p(std::max<slong>(bits, 128 + 2 * (first - c.e)));
        const ball one = scaled(ball(1), c.e), a = c.m - one, b = c.m + one;
        if (out->cells++ >= budget) {
            out->gave_up = true;
            doubt(a, b);
            continue;
        }
        ball g, slope;
        if (!q.enclose(c.m, c.e, &g, &slope) || g.sign() != 0) continue;
        if (slope.sign() != 0) {
            const int at_a = sign_at(q, a), at_b = sign_at(q, b);
            if (at_a * at_b > 0) continue;
            if (at_a * at_b < 0) {
                out->roots.push_back(close_in(q, a, b, slope, first));
                continue;
            }
        }
        if (first - c.e > depth) {
            doubt(a, b);
            continue;
        }
        todo.push_back({c.m + scaled(one, -1), c.e - 1});
        todo.push_back({c.m - scaled(one, -1), c.e - 1});
    }
}

} // namespace proof
#endif
