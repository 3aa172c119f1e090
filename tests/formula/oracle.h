// SPDX-License-Identifier: MIT
// oracle.h - every root of a written formula along a ray, by Arb's balls; and where F is no smooth function.
//
// Formula and ray are the stored doubles.  The ray is moved first, exactly, to where it is nearest to the
// origin: t = t0 + s, t0 a double.  F along it is enclosed on cells of s by its natural form and, where it is
// defined and continuous all over the cell, by its mean value form; its slope by dual numbers (numbers.h).
// What keeps a sign is left, what is monotone has the root that its ends tell, all else is halved
// (../proof/ball.h).  Cells smaller than 2^-90 of the chord are doubts, and each has its reason: what
// numbers.h has seen in it, or a double root or a singular point.
//
// The search goes a part in 1000 beyond the clip.  A root within `hem` of the clip's border, of its size, may
// be accepted or not.
#ifndef FORMULA_ORACLE_H
#define FORMULA_ORACLE_H

#include "formulas.h"

#include <sagitta/sagitta.h>

namespace formula
{

using proof::less;
using proof::precision;

constexpr double hem = 1e-12;

struct point3 {
    ball x, y, z;
};
inline ball dot(const point3 &a, const point3 &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline ball norm(const point3 &a) { return proof::root_of(dot(a, a)); }
inline point3 minus(const point3 &a, const point3 &b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline point3 widen(const sgt_vec3 &p) { return {p.x, p.y, p.z}; }

inline ball plus_minus(double by)
{
    ball r;
    arb_add_error(r.x, ball(by).x);
    return r;
}

inline point3 gradient(const written &f, const point3 &p, bool root = false)
{
    const ball c[3] = {p.x, p.y, p.z};
    ball g[3];
    for (int i = 0; i < 3; i++) {
        dual<ball> v[3];
        for (int j = 0; j < 3; j++) v[j] = {c[j], ball(i == j)};
        g[i] = f.at(v[0], v[1], v[2], root).s;
    }
    return {g[0], g[1], g[2]};
}

// Is the point of the surface's volume?  1 within, -1 outside, 0 at its border.
inline int within_clip(const place &w, const point3 &p)
{
    int side = 1;
    const auto keep = [&](const ball &x, const ball &most) {
        if (less(most * (1 + 2 * hem), x))
            side = -1;
        else if (side > 0 && !less(x, most * (1 - 2 * hem)))
            side = 0;
    };
    if (w.open) return 1;
    if (w.ball > 0) keep(dot(p, p), proof::square(ball(w.ball)));
    if (w.rim > 0) keep(p.x * p.x + p.y * p.y, proof::square(ball(w.rim)));
    const ball *c[3] = {&p.x, &p.y, &p.z};
    for (int i = 0; i < 3; i++)
        if (w.box[i] > 0) keep(proof::size(*c[i]), ball(w.box[i]));
    return side;
}

struct meeting {
    ball t;
    point3 p, n;
    ball slope, spread; // n . d; (|x Fx| + |y Fy| + |z Fz|) / |slope|
    int inside;
};
struct doubt {
    ball lo, hi; // of t
    const char *why;
};
struct answer {
    std::vector<meeting> roots;
    std::vector<meeting> touches; // double roots, known to be
    std::vector<doubt> doubts;
    double lo = 1, hi = 0; // what was searched, of t; lo > hi: the ray misses the volume
    bool lies = false;     // F is 0 all along
    bool gave_up = false;
    long cells = 0;
};

static const char why_double[] = "double root", why_singular[] = "singular point", why_kink[] = "kink",
                  why_cut[] = "branch cut", why_pole[] = "pole", why_border[] = "end of the domain",
                  why_clip[] = "border of the clip", why_start[] = "start or end of the ray",
                  why_tangent[] = "tangent", why_near[] = "two roots close by",
                  why_lies[] = "ray in the surface", why_budget[] = "oracle in doubt";
// Does a kink or a jump lie within a few ulps of the point?
inline bool breaks_at(const written &f, const sgt_vec3 &p)
{
    const ball wide = plus_minus(0x1p-44 * f.where.size());
    seen = marks();
    f.at(dual<ball>(ball(p.x) + wide, ball(1)), dual<ball>(ball(p.y) + wide, ball(1)),
         dual<ball>(ball(p.z) + wide, ball(1)));
    return seen.torn() || seen.kink;
}

class course
{
  public:
    course(const written &f, const sgt_ray &ray, double steep) : f_(f), ray_(ray), steep_(steep)
    {
        const precision p(2000);
        const double size = std::max({std::fabs(ray.d.x), std::fabs(ray.d.y), std::fabs(ray.d.z)});
        const double x = ray.d.x / size, y = ray.d.y / size, z = ray.d.z / size;
        t0_ = -(ray.o.x * x + ray.o.y * y + ray.o.z * z) / (x * x + y * y + z * z) / size;
        d_ = widen(ray.d);
        o_ = {ball(ray.o.x) + d_.x * t0_, ball(ray.o.y) + d_.y * t0_, ball(ray.o.z) + d_.z * t0_};
        clip();
    }

    answer all_roots() const
    {
        const precision p(128);
        answer a;
        a.lo = t0_ + lo_, a.hi = t0_ + hi_;
        if (!(lo_ < hi_)) return a;
        a.lies = true;
        for (int i = 0; i < 5 && a.lies; i++) {
            const ball g = value(lo_ + (hi_ - lo_) * (0.12 + 0.171 * i));
            a.lies = g.is_finite() && less(proof::size(g), ball(steep_ * f_.where.size() * 1e-25));
            const precision high(2000);
            a.lies = a.lies && !value(lo_ + (hi_ - lo_) * (0.12 + 0.171 * i)).sign();
        }
        if (a.lies) return a;
        proof::found found;
        if (f_.touches) {
            root_ = true;
            search(*this, lo_, hi_, 90, 20000, &found);
            for (const ball &s : found.roots) a.touches.push_back(meet(s));
            found.roots.clear();
            root_ = false;
        } else {
            search(*this, lo_, hi_, 90, 20000, &found);
        }
        a.cells = found.cells;
        a.gave_up = found.gave_up;
        for (const ball &s : found.roots) a.roots.push_back(meet(s));
        for (const proof::stretch &s : found.doubts)
            a.doubts.push_back({s.lo + ball(t0_), s.hi + ball(t0_), a.gave_up ? why_budget : reason_at(s)});
        return a;
    }

    // ------------------------------------------------------------------------------ as ball.h wants it

    ball value(const ball &s) const
    {
        const point3 p = at(s);
        return f_.at(p.x, p.y, p.z, root_);
    }
    bool enclose(const ball &m, slong e, ball *g, ball *slope) const
    {
        const ball s = proof::around(m, e);
        const point3 p = at(s);
        seen = marks();
        const dual<ball> v =
            f_.at(dual<ball>(p.x, d_.x), dual<ball>(p.y, d_.y), dual<ball>(p.z, d_.z), root_);
        if (seen.nowhere) return false;
        *g = v.v;
        *slope = seen.torn() ? proof::unknown() : v.s;
        if (g->sign() || !slope->is_finite()) return true;
        proof::cut_to(value(m) + *slope * (s - m), g);
        return true;
    }

    // ------------------------------------------------------------------------------------- what else

    // Why an answer may be undecided that knows nothing of [lo, hi]; NULL: no reason.  What is looked at is
    // that stretch and a millionth of the chord (or the size) to each side of it; of a long one its ends.
    const char *reason(const answer &a, double lo, double hi) const
    {
        const double part = (f_.touches ? 0x1p-6 : 0x1p-10) * scale();
        lo = std::max(lo, a.lo), hi = std::min(hi, a.hi);
        if (!(lo <= hi)) return nullptr; // outside of the clip
        const char *why = reason_near(a, lo, std::min(hi, lo + part));
        return why || !(hi - lo > part) ? why : reason_near(a, hi - part, hi);
    }

    // Is there a place in [lo, hi] that the oracle cannot see through either?
    static bool has_doubt(const answer &a, double lo, double hi)
    {
        for (const doubt &d : a.doubts)
            if (!less(d.hi, ball(lo)) && !less(ball(hi), d.lo)) return true;
        return false;
    }

    // Of 4096 points from lo to hi the one where |F| / |grad F| is least, and the cosine there.
    void nearest(double lo, double hi, double *t, double *off, double *along) const
    {
        const precision prec(192);
        *off = HUGE_VAL, *t = *along = NAN;
        lo = std::max(lo, t0_ + lo_), hi = std::min(hi, t0_ + hi_);
        for (int i = 0; i <= 4096; i++) {
            const double at_t = lo + (hi - lo) * i / 4096;
            const point3 q = at(ball(at_t) - ball(t0_)), n = gradient(f_, q);
            const double by = std::fabs(f_.at(q.x, q.y, q.z).rough()) / norm(n).rough();
            if (by < *off) *off = by, *t = at_t, *along = dot(n, d_).rough() / (norm(n) * norm(d_)).rough();
        }
    }

    // The point at t, and F's distance from there: |F| / |grad F|.
    point3 at_t(const ball &t) const { return at(t - ball(t0_)); }
    double length() const { return norm(d_).rough(); }

  private:
    const written &f_;
    sgt_ray ray_;
    double steep_, t0_, lo_ = 1, hi_ = 0;
    point3 o_, d_;
    mutable bool root_ = false;

    point3 at(const ball &s) const { return {o_.x + d_.x * s, o_.y + d_.y * s, o_.z + d_.z * s}; }

    void clip()
    {
        const place &w = f_.where;
        const double o[3] = {o_.x.rough(), o_.y.rough(), o_.z.rough()}, d[3] = {ray_.d.x, ray_.d.y, ray_.d.z};
        double lo = -HUGE_VAL, hi = HUGE_VAL;
        const auto cut = [&](double a, double b) {
            lo = std::max(lo, std::min(a, b)), hi = std::min(hi, std::max(a, b));
        };
        const auto slab = [&](int i, double most) {
            most *= 1.001;
            if (d[i] != 0)
                cut((-most - o[i]) / d[i], (most - o[i]) / d[i]);
            else if (!(std::fabs(o[i]) <= most))
                cut(1, -1), lo = 1, hi = 0;
        };
        const auto round = [&](double most, int n) {
            double a = 0, b = 0, c = -most * most * 1.002;
            for (int i = 0; i < n; i++) a += d[i] * d[i], b += o[i] * d[i], c += o[i] * o[i];
            if (a == 0) {
                if (c > 0) lo = 1, hi = 0;
                return;
            }
            const double inner = b * b - a * c;
            if (!(inner > 0))
                lo = 1, hi = 0;
            else
                cut((-b - std::sqrt(inner)) / a, (-b + std::sqrt(inner)) / a);
        };
        if (w.ball > 0) round(w.ball, 3);
        if (w.rim > 0) round(w.rim, 2), slab(2, w.reach);
        for (int i = 0; i < 3; i++)
            if (w.box[i] > 0) slab(i, w.box[i]);
        lo_ = lo, hi_ = hi;
    }

    meeting meet(const ball &s) const
    {
        const precision p(320);
        meeting m;
        m.t = s + ball(t0_);
        m.p = at(s);
        m.inside = within_clip(f_.where, m.p);
        m.n = gradient(f_, m.p, root_);
        m.slope = dot(m.n, d_);
        m.spread = (proof::size(m.p.x * m.n.x) + proof::size(m.p.y * m.n.y) + proof::size(m.p.z * m.n.z)) /
                   proof::size(m.slope);
        return m;
    }

    const char *reason_near(const answer &a, double lo, double hi) const
    {
        const precision prec(192);
        const double near = 0x1p-20 * scale();
        if (a.lies) return why_lies;
        const ball from = ball(lo) - ball(near), to = ball(hi) + ball(near);
        for (const doubt &d : a.doubts)
            if (!less(d.hi, from) && !less(to, d.lo)) return d.why;
        const auto in = [&](const meeting &m) { return !less(m.t, from) && !less(to, m.t); };
        for (const meeting &m : a.touches)
            if (in(m)) return why_double;
        for (std::size_t i = 0; i < a.roots.size(); i++) {
            const meeting &m = a.roots[i];
            if (!in(m)) continue;
            if (m.inside == 0) return why_clip;
            for (double end : {ray_.tmin, ray_.tmax})
                if (less(proof::size(m.t - ball(end)),
                         m.spread * 0x1p-44 + ball(near) * 0x1p-10 + proof::size(m.t) * 0x1p-48))
                    return why_start;
            if (i > 0 && less(m.t - a.roots[i - 1].t, ball(2 * near))) return why_near;
        }
        const int pieces = 64;
        const ball step = (to - from) * ball(1.0 / pieces);
        const char *tangent = nullptr;
        const ball wide = plus_minus(1e-10 * steep_ * f_.where.size());
        const auto torn = [&](const ball &s) -> const char * {
            const point3 p = at(s);
            seen = marks();
            const dual<ball> v = f_.at(dual<ball>(p.x, d_.x), dual<ball>(p.y, d_.y), dual<ball>(p.z, d_.z));
            const ball blurred = v.v + wide;
            return seen.nowhere || blurred.sign() ? nullptr : seen_reason();
        };
        if (hi - lo <= 4 * near)
            if (const char *why = torn(proof::between(from, to) - ball(t0_))) return why;
        for (int i = 0; i < pieces; i++) {
            const ball t = from + step * ball(i), s = t - ball(t0_), whole = proof::between(s, s + step);
            if (const char *why = torn(whole)) return why;
            const point3 q = at(proof::middle(whole));
            const ball g = f_.at(q.x, q.y, q.z);
            const point3 n = gradient(f_, q);
            if (!g.is_finite() || !norm(n).is_finite()) continue;
            const double size = f_.where.size(), steep = norm(n).rough(), off = std::fabs(g.rough());
            if (steep < 1e-4 * steep_ && off < 1e-9 * steep_ * size) return why_singular;
            if (off < 1e-9 * steep * size && std::fabs(dot(n, d_).rough()) < 1e-4 * steep * norm(d_).rough())
                tangent = why_tangent;
        }
        return tangent;
    }

    // Of a short chord the size, in lengths of d.
    double scale() const { return std::max(hi_ - lo_, f_.where.size() / length()); }

    static const char *seen_reason()
    {
        return seen.cut      ? why_cut
               : seen.pole   ? why_pole
               : seen.border ? why_border
               : seen.kink   ? why_kink
                             : nullptr;
    }
    const char *reason_at(const proof::stretch &s) const
    {
        const precision p(320);
        const point3 q = at(proof::between(s.lo, s.hi));
        seen = marks();
        f_.at(dual<ball>(q.x, d_.x), dual<ball>(q.y, d_.y), dual<ball>(q.z, d_.z), root_);
        if (const char *why = seen_reason()) return why;
        const double steep = norm(gradient(f_, at(proof::middle(proof::between(s.lo, s.hi))))).rough();
        return steep < 1e-4 * steep_ ? why_singular : why_double;
    }
};

// ------------------------------------------------------------------------------------- in double, to aim by

inline double value_at(const written &f, const sgt_vec3 &p, sgt_vec3 *n, bool root = false)
{
    double g[3], v = 0;
    for (int i = 0; i < 3; i++) {
        const dual<double> r =
            f.at(dual<double>(p.x, i == 0), dual<double>(p.y, i == 1), dual<double>(p.z, i == 2), root);
        v = r.v, g[i] = r.s;
    }
    if (n) *n = {g[0], g[1], g[2]};
    return v;
}

inline sgt_span chord_of(const place &w, const sgt_ray &r)
{
    double lo = -HUGE_VAL, hi = HUGE_VAL;
    const double o[3] = {r.o.x, r.o.y, r.o.z}, d[3] = {r.d.x, r.d.y, r.d.z};
    const auto round = [&](double most, int n) {
        double a = 0, b = 0, c = 0;
        for (int i = 0; i < n; i++) a += d[i] * d[i], b += o[i] * d[i];
        const double m = a > 0 ? -b / a : 0;
        for (int i = 0; i < n; i++) c += (o[i] + m * d[i]) * (o[i] + m * d[i]);
        const double left = most * most - c;
        if (!(left >= 0))
            lo = 1, hi = -1;
        else if (a > 0)
            lo = std::max(lo, m - std::sqrt(left / a)), hi = std::min(hi, m + std::sqrt(left / a));
    };
    const auto slab = [&](int i, double most) {
        if (d[i] == 0) {
            if (!(std::fabs(o[i]) <= most)) lo = 1, hi = -1;
            return;
        }
        const double a = (-most - o[i]) / d[i], b = (most - o[i]) / d[i];
        lo = std::max(lo, std::min(a, b)), hi = std::min(hi, std::max(a, b));
    };
    if (w.ball > 0) round(w.ball, 3);
    if (w.rim > 0) round(w.rim, 2), slab(2, w.reach);
    for (int i = 0; i < 3; i++)
        if (w.box[i] > 0) slab(i, w.box[i]);
    return {lo, hi, static_cast<double>(NAN), false};
}

} // namespace formula
#endif
