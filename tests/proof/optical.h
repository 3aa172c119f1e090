// SPDX-License-Identifier: MIT
// optical.h - every root of a conic or an even asphere along a ray, by balls.
//
// Surface and ray are the stored doubles.  With rho = x^2 + y^2, w = z - P(rho), the terms P alone
// taken off, and h = 1 - (1 + k) c w, the roots of F = z - s are those of
//     G = c (rho + (1 + k) w^2) - 2 w     with h >= 0:
// G = 0 makes h^2 = 1 - (1 + k) c^2 rho, so such a point is in the domain, and h is the square root
// of the sag.  h = 0 is the equator, where F stays defined and the root one.  Along the ray
//     G' = c rho' - 2 h w',  w' = dz - P' rho'.
// Without terms G is a quadratic in t, and solved in closed form; its discriminant is worked out
// exactly where a ball leaves its sign open, so that a double root is known as one.  With terms it is
// a polynomial of degree up to 32, searched (ball.h) in the stretch where rho is within the domain and
// the rim, with a margin of a part in 1000, or, with neither, within a bound on its roots (Fujiwara 1916):
// twice the greatest |g_(n-i) / g_n|^(1/i).
//
// The ray is moved first to where it is nearest to the vertex: t = t0 + s, t0 a double.
#ifndef PROOF_OPTICAL_H
#define PROOF_OPTICAL_H

#include "ball.h"

#include <sagitta/surfaces.h>

#include <cmath>

namespace proof {

struct vector3 {
    ball x, y, z;
};
inline ball dot(const vector3 &a, const vector3 &b)
{
    ball r = a.x * b.x;
    r.add_product(a.y, b.y);
    r.add_product(a.z, b.z);
    return r;
}
inline ball norm(const vector3 &a) { return root_of(dot(a, a)); }
inline vector3 minus(const vector3 &a, const vector3 &b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline vector3 widen(const sgt_vec3 &p) { return {p.x, p.y, p.z}; }

struct meeting {
    ball t;
    vector3 p, n;   // the gradient of F; not finite on the equator
    ball slope;     // n . d
    ball spread;    // (|x Fx| + |y Fy| + |z Fz|) / |slope|
    int inside;     // the rim: 1 within, -1 outside, 0 too close to tell
    bool edge;      // on the equator as far as can be told: perhaps on the other sheet
    bool twice;     // a double root, exactly
    double near_rim;     // |r / rim - 1|
    double near_equator; // h
    double t_err =
        0; // what the rounding of F alone makes of it, where that is more than of the point (level sets)
};

struct answer {
    std::vector<meeting> roots;
    std::vector<stretch> doubts; // in t
    bool lies = false;           // all the ray is on the surface
    bool gave_up = false;
    bool beyond = false;         // a root is on the other sheet, and next to the equator (h > -1e-4)
    long cells = 0;
};

class optical {
public:
  optical(const sgt_even_asphere &s, bool asphere, const sgt_ray &r)
      : c_(s.c), terms_(0), rim_(s.semi_diameter)
  {
      const precision p(256);
      k1_ = ball(s.k) + 1;
      for (int i = 0; i < 8 && asphere; i++)
          if (s.a[i] != 0) terms_ = i + 1;
      for (int i = 0; i < terms_; i++) a_.push_back(s.a[i]), da_.push_back(ball(s.a[i]) * (i + 1));
      // (scaled, for directions and places of any size)
      const double size = std::max({std::fabs(r.d.x), std::fabs(r.d.y), std::fabs(r.d.z)});
      const double x = r.d.x / size, y = r.d.y / size, z = r.d.z / size;
      t0_ = -(r.o.x * x + r.o.y * y + r.o.z * z) / (x * x + y * y + z * z) / size;
      if (!std::isfinite(t0_)) t0_ = 0;
      d_ = widen(r.d);
      q_ = {ball(r.o.x) + d_.x * t0_, ball(r.o.y) + d_.y * t0_, ball(r.o.z) + d_.z * t0_};
      rho0_ = q_.x * q_.x + q_.y * q_.y;
      half1_ = q_.x * d_.x + q_.y * d_.y;
      rho2_ = d_.x * d_.x + d_.y * d_.y;
      e_ = k1_ * c_ * c_;
      if (rim_ > 0) {
          rim2_ = square(ball(rim_)) * (ball(1) + scaled(ball(1), -44));
          window_ = rim2_ * 1.001;
          bounded_ = true;
      }
      if (e_.sign() > 0) {
          const ball domain = ball(1.001) / e_;
          window_ = bounded_ && less(window_, domain) ? window_ : domain;
          bounded_ = true;
      }
    }

    answer all_roots() const
    {
        answer a;
        const precision p(256);
        if (terms_ == 0) closed_form(&a);
        else searched(&a);
        return a;
    }

    // -------------------------------------------------- as ball.h wants it

    ball value(const ball &s) const
    {
        const ball rho = rho_at(s), w = w_at(s, rho);
        return c_ * (rho + k1_ * square(w)) - scaled(w, 1);
    }

    bool enclose(const ball &m, slong e, ball *g, ball *slope) const
    {
        const ball s = around(m, e), rho = rho_at(s);
        if (bounded_ && less(window_, rho)) return false;
        const ball d_rho = scaled(half1_ + rho2_ * s, 1);
        ball sum = 0, d_sum = 0;
        for (int i = terms_; i-- > 0;) {
            sum = (sum + a_[static_cast<std::size_t>(i)]) * rho;
            d_sum = d_sum * rho + da_[static_cast<std::size_t>(i)];
        }
        const ball w = q_.z + d_.z * s - sum, h = ball(1) - k1_ * c_ * w;
        if (h.sign() < 0) return false;
        *slope = c_ * d_rho - scaled(h * (d_.z - d_sum * d_rho), 1);
        *g = c_ * (rho + k1_ * square(w)) - scaled(w, 1);
        if (g->sign() != 0) return true;
        cut_to(value(m) + *slope * (s - m), g);
        return true;
    }

    // F at t, and its gradient, for a t where it is defined; false: it certainly is not.
    bool at(const ball &t, vector3 *p, vector3 *n, ball *f) const
    {
        return at_point(place(t - ball(t0_)), p, n, f);
    }
    bool at_point(const vector3 &q, vector3 *p, vector3 *n, ball *f) const
    {
        *p = q;
        const ball rho = square(q.x) + square(q.y), u = ball(1) - e_ * rho;
        if (u.sign() < 0) return false;
        const ball root = root_of(u);
        ball sum = 0, d_sum = 0;
        polynomial(rho, &sum, &d_sum);
        *f = q.z - sum - c_ * rho / (ball(1) + root);
        const ball by_rho = c_ / scaled(root, 1) + d_sum;
        *n = {-scaled(q.x * by_rho, 1), -scaled(q.y * by_rho, 1), 1};
        return true;
    }
    // The ray at its nearest to the axis is at the edge of the domain, within a part in 10^6.
    bool near_domain() const
    {
        const ball nearest = rho2_.is_zero() ? rho0_ : rho0_ - square(half1_) / rho2_;
        return e_.sign() > 0 && !less(ball(1e-6), size(ball(1) - e_ * nearest));
    }
    // The terms at a root are so large that their rounding hides v, and so the sheet.
    bool hides_sheet(const meeting &m) const
    {
        const ball r = root_of(square(m.p.x) + square(m.p.y));
        return less(ball(m.near_equator), size(k1_ * c_) * (steepness(m.p) * r + size(m.p.z)) * 0x1p-48);
    }
    // What its terms make of |grad s|, without their signs.
    ball steepness(const vector3 &q) const
    {
        const ball rho = square(q.x) + square(q.y);
        ball sum = 0;
        for (int i = terms_; i-- > 0;) sum = sum * rho + size(da_[static_cast<std::size_t>(i)]);
        return scaled(root_of(rho) * (sum + size(c_) / root_of(ball(1) - e_ * rho)), 1);
    }
    // No less than |d^2/dt^2| of any form of F, for d of unit length: what its terms make of it, without
    // their signs.
    ball bend(const vector3 &q) const
    {
        const ball steep = steepness(q);
        return size(k1_ * c_) * square(steep + 1) + scaled(steep, 4) / root_of(square(q.x) + square(q.y));
    }

private:
    ball c_, k1_, e_, rho0_, half1_, rho2_, rim2_, window_;
    std::vector<ball> a_, da_;
    int terms_;
    double rim_, t0_;
    vector3 q_, d_;
    bool bounded_ = false;

    vector3 place(const ball &s) const { return {q_.x + d_.x * s, q_.y + d_.y * s, q_.z + d_.z * s}; }
    ball rho_at(const ball &s) const { return square(q_.x + d_.x * s) + square(q_.y + d_.y * s); }
    void polynomial(const ball &rho, ball *sum, ball *d_sum) const
    {
        *sum = 0, *d_sum = 0;
        for (int i = terms_; i-- > 0;) {
            *sum = (*sum + a_[static_cast<std::size_t>(i)]) * rho;
            *d_sum = *d_sum * rho + da_[static_cast<std::size_t>(i)];
        }
    }
    ball w_at(const ball &s, const ball &rho) const
    {
        ball sum = 0;
        for (int i = terms_; i-- > 0;) sum = (sum + a_[static_cast<std::size_t>(i)]) * rho;
        return q_.z + d_.z * s - sum;
    }

    void keep(const ball &s, bool twice, answer *a) const
    {
        meeting m;
        m.t = s + ball(t0_);
        m.p = place(s);
        const ball rho = square(m.p.x) + square(m.p.y), w = w_at(s, rho), h = ball(1) - k1_ * c_ * w;
        if (h.sign() < 0) {
            a->beyond = a->beyond || less(ball(-1e-4), h);
            return;
        }
        m.edge = h.sign() == 0;
        m.near_equator = h.rough();
        m.twice = twice;
        m.inside = rim_ > 0 ? (rim2_ - rho).sign() : 1;
        m.near_rim = rim_ > 0 ? std::fabs((rho / rim2_ - 1).rough()) / 2 : HUGE_VAL;
        ball sum, d_sum;
        polynomial(rho, &sum, &d_sum);
        const ball by_rho = c_ / scaled(h, 1) + d_sum;
        m.n = {-scaled(m.p.x * by_rho, 1), -scaled(m.p.y * by_rho, 1), 1};
        m.slope = dot(m.n, d_);
        m.spread = (size(m.p.x * m.n.x) + size(m.p.y * m.n.y) + size(m.p.z * m.n.z)) / size(m.slope);
        a->roots.push_back(std::move(m));
    }

    // G = A s^2 + 2 B s + C.
    void closed_form(answer *a) const
    {
        for (slong b = 320; b <= 40960; b *= 4) {
            const precision p(b); // the last is exact for doubles not too far apart
            const ball A = c_ * (rho2_ + k1_ * square(d_.z)), B = c_ * (half1_ + k1_ * q_.z * d_.z) - d_.z;
            const ball C = c_ * (rho0_ + k1_ * square(q_.z)) - scaled(q_.z, 1);
            if (A.is_zero() && B.is_zero()) {
                a->lies = C.is_zero();
                if (C.sign() || C.is_zero()) return;
                continue;
            }
            if (A.is_zero()) {
                if (B.sign() == 0) continue;
                keep(-C / scaled(B, 1), false, a);
                return;
            }
            const ball D = square(B) - A * C;
            if (D.sign() < 0) return;
            if (A.sign() == 0) continue;
            if (D.is_zero()) {
                const precision fine(640);
                keep(-B / A, true, a);
                return;
            }
            if (D.sign() == 0) continue;
            const ball root = root_of(D);
            ball first, second;
            if (arf_sgn(arb_midref(B.x)) > 0) {
                const ball q = -(B + root);
                if (q.sign() == 0) continue;
                first = q / A, second = C / q;
            } else {
                const ball q = root - B;
                if (q.sign() == 0) continue;
                first = C / q, second = q / A;
            }
            if (arf_cmp(arb_midref(first.x), arb_midref(second.x)) > 0) std::swap(first, second);
            const std::size_t before = a->roots.size();
            keep(first, false, a);
            keep(second, false, a);
            bool open = false;
            for (const meeting &m : a->roots) open = open || m.edge || !m.inside;
            if (open && b < 10000) {
                a->roots.resize(before);
                continue;
            }
            return;
        }
        a->gave_up = true;
    }

    // A bound on the roots of G.
    bool bound(ball *s) const
    {
        arb_poly_t rho, sum, w, g;
        arb_poly_init(rho), arb_poly_init(sum), arb_poly_init(w), arb_poly_init(g);
        arb_poly_set_coeff_arb(rho, 0, rho0_.x);
        arb_poly_set_coeff_arb(rho, 1, scaled(half1_, 1).x);
        arb_poly_set_coeff_arb(rho, 2, rho2_.x);
        for (int i = terms_; i-- > 0;) {
            ball c0;
            arb_poly_get_coeff_arb(c0.x, sum, 0);
            arb_poly_set_coeff_arb(sum, 0, (c0 + a_[static_cast<std::size_t>(i)]).x);
            arb_poly_mul(sum, sum, rho, bits);
        }
        arb_poly_set_coeff_arb(w, 0, q_.z.x);
        arb_poly_set_coeff_arb(w, 1, d_.z.x);
        arb_poly_sub(w, w, sum, bits);
        arb_poly_mul(g, w, w, bits);
        arb_poly_scalar_mul(g, g, k1_.x, bits);
        arb_poly_add(g, g, rho, bits);
        arb_poly_scalar_mul(g, g, c_.x, bits);
        arb_poly_scalar_mul_2exp_si(w, w, 1);
        arb_poly_sub(g, g, w, bits);
        slong n = arb_poly_length(g) - 1, most = -100000;
        ball last, other;
        for (; n > 0; n--) {
            arb_poly_get_coeff_arb(last.x, g, n);
            if (!last.is_zero()) break;
        }
        const bool told = n > 0 && last.sign() != 0;
        for (slong i = 1; told && i <= n; i++) {
            arb_poly_get_coeff_arb(other.x, g, n - i);
            const ball ratio = other / last;
            if (!ratio.is_zero()) {
                const slong e = exponent(ratio);
                most = std::max(most, e >= 0 ? (e + i - 1) / i : -(-e / i));
            }
        }
        arb_poly_clear(rho), arb_poly_clear(sum), arb_poly_clear(w), arb_poly_clear(g);
        *s = scaled(ball(1), most + 1);
        return told;
    }

    void searched(answer *a) const
    {
        ball lo, hi;
        bool have = false;
        const auto cut = [&](const ball &l, const ball &h) {
            if (!have || less(lo, l)) lo = low(l);
            if (!have || less(h, hi)) hi = high(h);
            have = true;
        };
        if (bounded_ && rho2_.sign() > 0) { // rho <= window
            const ball inner = square(half1_) - rho2_ * (rho0_ - window_);
            if (inner.sign() < 0) return;
            const ball half = root_of(high(inner)) / rho2_;
            cut(-half1_ / rho2_ - half, -half1_ / rho2_ + half);
        }
        if (bounded_ && !d_.z.is_zero()) { // |z| <= the most a sag can be
            ball most = size(c_) * window_, power = window_;
            for (const ball &t : a_) most += size(t) * power, power *= window_;
            const ball one = (-q_.z - most) / d_.z, other = (-q_.z + most) / d_.z;
            if (d_.z.sign() > 0) cut(one, other);
            else cut(other, one);
        }
        if (!have) {
            ball b;
            if (!bound(&b)) {
                const precision p(4000);
                if (!bound(&b)) {
                    a->gave_up = true;
                    return;
                }
            }
            cut(-b, b);
        }
        if (less(hi, lo)) return;
        found f;
        search(*this, lo, hi, 110, 20000, &f);
        a->cells = f.cells;
        a->gave_up = f.gave_up;
        const precision p(320);
        for (const ball &s : f.roots) keep(s, false, a);
        for (const stretch &d : f.doubts) a->doubts.push_back({d.lo + ball(t0_), d.hi + ball(t0_)});
    }
};

} // namespace proof
#endif
