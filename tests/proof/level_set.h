// SPDX-License-Identifier: MIT
// level_set.h - every root of |Q_N| = E along a ray, Q -> Q^p + c the quaternion orbit, by balls.
//
// A cell is s = m + H u, |u| <= 1/2, and an orbit on it a series Q = q0 + q1 u + q2 u^2 + the rest,
// the q quaternions of balls, the rest bounded by a number: the sum of the norms of all further
// coefficients, tau.  Norms of quaternions multiply, so a product's is at most
//     |a1||b2| + |a2||b1| + |a2||b2| + |A| tau_B + tau_A |B| + tau_A tau_B,  |A| = |a0| + |a1| + |a2|.
// That is for |u| <= 1; on |u| <= 1/2 the rest is at most tau / 8 and its derivative 3/4 tau.  All
// factors are powers of one series and commute, so a_i b_j + b_j a_i takes the place of 2 a_i b_j:
// the parts across cancel.  g = |Q_N|^2 - E^2 is a series of the same kind with numbers for quaternions.
//
// An orbit beyond max(E, R), x^p - x - |c| = 0 at R (for a Mandelbrot set beyond E >= 2^(1/(p-1))), goes
// on growing: a cell all of which is there, at any level, is outside.
//
// Everything is in t itself, about the middle of the chord of the ball |Q_0| <= E.
#ifndef PROOF_LEVEL_SET_H
#define PROOF_LEVEL_SET_H

#include "../oracle/levels.h"
#include "optical.h"

namespace proof {

struct four {
    ball v[4];
};
inline four operator+(const four &a, const four &b)
{
    return {{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2], a.v[3] + b.v[3]}};
}
inline ball dot(const four &a, const four &b)
{
    ball r = a.v[0] * b.v[0];
    for (int i = 1; i < 4; i++) r.add_product(a.v[i], b.v[i]);
    return r;
}
inline four scaled(const four &a, slong e)
{
    return {{scaled(a.v[0], e), scaled(a.v[1], e), scaled(a.v[2], e), scaled(a.v[3], e)}};
}
inline four times(const ball &k, const four &a) { return {{k * a.v[0], k * a.v[1], k * a.v[2], k * a.v[3]}}; }
// (a b + b a) / 2
inline four half_sum(const four &a, const four &b)
{
    four r;
    r.v[0] = a.v[0] * b.v[0];
    for (int i = 1; i < 4; i++) {
        arb_submul(r.v[0].x, a.v[i].x, b.v[i].x, bits);
        r.v[i] = a.v[0] * b.v[i];
        r.v[i].add_product(a.v[i], b.v[0]);
    }
    return r;
}

// A number that only ever bounds from above.
class bound {
public:
    bound() { mag_init(m); }
    bound(const bound &b) { mag_init(m), mag_set(m, b.m); }
    bound &operator=(const bound &b) { mag_set(m, b.m); return *this; }
    ~bound() { mag_clear(m); }
    friend bound operator+(const bound &a, const bound &b) { bound r; mag_add(r.m, a.m, b.m); return r; }
    friend bound operator*(const bound &a, const bound &b) { bound r; mag_mul(r.m, a.m, b.m); return r; }
    mag_t m;
};
inline bound size_of(const four &a)
{
    bound r, one;
    for (const ball &b : a.v) {
        arb_get_mag(one.m, b.x);
        mag_addmul(r.m, one.m, one.m);
    }
    mag_sqrt(r.m, r.m);
    return r;
}
inline bound size_of(const ball &a) { bound r; arb_get_mag(r.m, a.x); return r; }

struct series {
    four q[3];
    bound tau;
};
inline series product(const series &a, const series &b)
{
    series r;
    r.q[0] = half_sum(a.q[0], b.q[0]);
    r.q[1] = half_sum(a.q[0], b.q[1]) + half_sum(a.q[1], b.q[0]);
    r.q[2] = half_sum(a.q[0], b.q[2]) + half_sum(a.q[2], b.q[0]) + half_sum(a.q[1], b.q[1]);
    const bound a0 = size_of(a.q[0]), a1 = size_of(a.q[1]), a2 = size_of(a.q[2]);
    const bound b0 = size_of(b.q[0]), b1 = size_of(b.q[1]), b2 = size_of(b.q[2]);
    r.tau = a1 * b2 + a2 * b1 + a2 * b2 + (a0 + a1 + a2) * b.tau + a.tau * (b0 + b1 + b2) + a.tau * b.tau;
    return r;
}
inline series square(const series &a)
{
    series r;
    r.q[0] = half_sum(a.q[0], a.q[0]);
    r.q[1] = scaled(half_sum(a.q[0], a.q[1]), 1);
    r.q[2] = scaled(half_sum(a.q[0], a.q[2]), 1) + half_sum(a.q[1], a.q[1]);
    const bound a0 = size_of(a.q[0]), a1 = size_of(a.q[1]), a2 = size_of(a.q[2]), cross = a1 * a2,
                own = (a0 + a1 + a2) * a.tau;
    r.tau = cross + cross + a2 * a2 + own + own + a.tau * a.tau;
    return r;
}
inline series power_of(const series &a, int p)
{
    return p == 1 ? a : p % 2 ? product(a, power_of(a, p - 1)) : power_of(square(a), p / 2);
}
inline four power_of(const four &a, int p)
{
    return p == 1 ? a : p % 2 ? half_sum(a, power_of(a, p - 1)) : power_of(half_sum(a, a), p / 2);
}

class level_set {
public:
    level_set(const oracle::level &f, const sgt_ray &r) : f_(f), levels_(f.s.iterations - f.mandelbrot)
    {
        const precision p(256);
        for (std::size_t i = 0; i < 4; i++) {
            start_.v[i] = ball(f.s.at[i]) + ball(r.o.x) * f.s.ex[i] + ball(r.o.y) * f.s.ey[i] +
                          ball(r.o.z) * f.s.ez[i];
            way_.v[i] = ball(r.d.x) * f.s.ex[i] + ball(r.d.y) * f.s.ey[i] + ball(r.d.z) * f.s.ez[i];
            c_.v[i] = f.s.c[i];
        }
        o_ = widen(r.o), d_ = widen(r.d);
        E2_ = square(ball(f.s.escape));
        double far = oracle::safe_escape(f) * (1 + 1e-9);
        far2_ = high(square(ball(std::max(far, f.s.escape))));
    }

    // On lo <= t <= hi (which may be infinite).
    answer all_roots(double lo, double hi, long budget) const
    {
        answer a;
        const precision p(256);
        const ball vv = dot(way_, way_), pv = dot(start_, way_),
                   D = square(pv) - vv * (dot(start_, start_) - E2_);
        if (D.sign() < 0) return a;
        const ball mid = -pv / vv, half = root_of(high(D)) / vv;
        ball from = low(mid - half), to = high(mid + half);
        if (lo > -HUGE_VAL && less(from, ball(lo))) from = lo;
        if (hi < HUGE_VAL && less(ball(hi), to)) to = hi;
        if (!less(from, to)) return a;
        const precision coarse(128);
        found f;
        search(*this, from, to, 90, budget, &f);
        a.cells = f.cells;
        a.gave_up = f.gave_up;
        const precision fine(320);
        for (const ball &t : f.roots) a.roots.push_back(met(t));
        a.doubts = f.doubts;
        return a;
    }

    ball value(const ball &t) const
    {
        four q;
        for (int i = 0; i < 4; i++) q.v[i] = start_.v[i] + way_.v[i] * t;
        const four c = f_.mandelbrot ? q : c_;
        for (int k = 0; k < levels_; k++) q = power_of(q, f_.s.power) + c;
        return dot(q, q) - E2_;
    }

    bool enclose(const ball &m, slong e, ball *g, ball *slope) const
    {
        series a;
        for (int i = 0; i < 4; i++) {
            a.q[0].v[i] = start_.v[i] + way_.v[i] * m;
            a.q[1].v[i] = scaled(way_.v[i], e + 1); // H = 2 h
        }
        const series c = a;
        for (int k = 0;; k++) {
            const ball g0 = dot(a.q[0], a.q[0]), g1 = scaled(dot(a.q[0], a.q[1]), 1),
                       g2 = scaled(dot(a.q[0], a.q[2]), 1) + dot(a.q[1], a.q[1]);
            const bound a0 = size_of(a.q[0]), a1 = size_of(a.q[1]), a2 = size_of(a.q[2]), cross = a1 * a2,
                        own = (a0 + a1 + a2) * a.tau;
            const bound tau = cross + cross + a2 * a2 + own + own + a.tau * a.tau;
            ball n = g0 + scaled(g2, -3); // u^2 in 0 ... 1/4
            const bound by1 = size_of(scaled(g1, -1)), by2 = size_of(scaled(g2, -3));
            arb_add_error_mag(n.x, by1.m);
            arb_add_error_mag(n.x, by2.m);
            ball rest;
            mag_mul_2exp_si(arb_radref(rest.x), tau.m, -3);
            n += rest;
            if (less(far2_, n)) return false;
            if (k == levels_) {
                *g = n - E2_;
                *slope = g1;
                const bound turn = size_of(g2);
                arb_add_error_mag(slope->x, turn.m);
                arb_add_error_mag(slope->x, tau.m); // 3/4 of it
                *slope = scaled(*slope, -(e + 1));
                return true;
            }
            if (mag_cmp_2exp_si(tau.m, 200) > 0) break;
            a = power_of(a, f_.s.power);
            if (f_.mandelbrot) {
                a.q[0] = a.q[0] + c.q[0];
                a.q[1] = a.q[1] + c.q[1];
            } else
                a.q[0] = a.q[0] + c_;
        }
        mag_inf(arb_radref(g->x));
        mag_inf(arb_radref(slope->x));
        return true;
    }

    // g and its gradient at a point.
    void at_point(const vector3 &q, ball *g, vector3 *n) const
    {
        const double *const axis[3] = {f_.s.ex, f_.s.ey, f_.s.ez};
        const ball *const x[3] = {&q.x, &q.y, &q.z};
        four a, turn[3];
        for (int i = 0; i < 4; i++) {
            a.v[i] = f_.s.at[i];
            for (int j = 0; j < 3; j++) {
                turn[j].v[i] = axis[j][i];
                a.v[i].add_product(*x[j], turn[j].v[i]);
            }
        }
        const four point = a, unit[3] = {turn[0], turn[1], turn[2]};
        for (int k = 0; k < levels_; k++) {
            // d(Q^p) = the sum of Q^i dQ Q^(p-1-i), whole products this time
            for (int j = 0; j < 3; j++) {
                four sum, power = turn[j]; // Horner: S <- Q S + T Q^i
                sum = turn[j];
                for (int i = 1; i < f_.s.power; i++) {
                    power = whole(power, a);
                    sum = whole(a, sum) + power;
                }
                turn[j] = f_.mandelbrot ? sum + unit[j] : sum;
            }
            a = power_of(a, f_.s.power) + (f_.mandelbrot ? point : c_);
        }
        *g = dot(a, a) - E2_;
        *n = {scaled(dot(a, turn[0]), 1), scaled(dot(a, turn[1]), 1), scaled(dot(a, turn[2]), 1)};
    }

    meeting met(const ball &t) const
    {
        meeting m;
        m.t = t;
        m.p = {o_.x + d_.x * t, o_.y + d_.y * t, o_.z + d_.z * t};
        ball g;
        at_point(m.p, &g, &m.n);
        m.slope = proof::dot(m.n, d_);
        m.spread = (size(m.p.x * m.n.x) + size(m.p.y * m.n.y) + size(m.p.z * m.n.z)) / size(m.slope);
        m.inside = 1;
        m.edge = m.twice = false;
        m.near_rim = m.near_equator = HUGE_VAL;
        return m;
    }
    ball escape2() const { return E2_; }

private:
    oracle::level f_;
    int levels_;
    four start_, way_, c_;
    vector3 o_, d_;
    ball E2_, far2_;

    static four whole(const four &p, const four &q)
    {
        four r;
        const ball *a = p.v, *b = q.v;
        r.v[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
        r.v[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
        r.v[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
        r.v[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
        return r;
    }
};

} // namespace proof
#endif
