// SPDX-License-Identifier: MIT
// quad.h - every meeting of a ray with a conic or even asphere, in quadruple precision.
//
// An oracle for tests.  It shares no code and no method with the library: the
// conic is a quadratic solved in closed form, the asphere is searched by
// subdivision with enclosures of g and g', all on a ray that is first moved near
// the surface.  Surface and ray are the stored doubles, taken exactly.
//
// The move.  With t0 a double, the product t0 d has at most 106 bits, so
// o' = o + t0 d is rounded once, to 113 bits: a relative error of 2^-113 in each
// coordinate of o', however far o is.  Everything after is in s = t - t0, and a
// root is kept as the pair (t0, s).
//
// The conic.  On the ray c (x^2 + y^2 + (1+k) z^2) - 2 z = 0 reads
// A s^2 - 2 B s + C = 0; both roots come without cancellation, from the sign of B.
// A root is on the sag sheet if and only if 1 - (1+k) c z >= 0; within 1e-25 of
// equality (relative) it is marked `edge`: too close to tell.  Where the sign of
// B^2 - A C is within its rounding even with B near 0 (two roots, if any, nearer
// than about 1e-16 of the chord), the stretch is listed as `doubtful`.
//
// The asphere.  With rho = x^2 + y^2, a quadratic in s, g(s) = z(s) - S(rho(s)).
// The base sag and its derivative are monotone in rho, and so are the positive
// and the negative terms of the polynomial taken apart: over any stretch of s the
// ranges of g and g' follow from the two ends of the range of rho.  A stretch is
// done when g is not zero on it, or when g' is not (then the signs at its ends
// decide); else it is split.  In double first, with paddings well above its
// rounding; what double cannot decide is handed to quad; what quad cannot decide
// (g and g' both vanish within rounding) is listed as doubtful.  Where the line never
// leaves the domain the highest term bounds the search: beyond it |a_j| rho^(j+1)
// is more than everything else together.
//
// Needs a type of 113 bits: gcc's and clang's __float128, or a long double of that
// width.  The arithmetic is in the compiler's own library; the square root is here.
#ifndef ORACLE_QUAD_H
#define ORACLE_QUAD_H

#include "../../src/truth/quad.hpp"

#include <sagitta/sagitta.h>
#include <sagitta/surfaces.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace oracle {

// The distance to the next double, at least the smallest normal one's.
inline double ulp(double x)
{
    x = std::fabs(x);
    return std::ldexp(1.0, (x < DBL_MIN ? DBL_MIN_EXP - 1 : std::ilogb(x)) - 52);
}

// As hi + lo, both in hexadecimal.
inline std::string text(quad x)
{
    double hi = to_double(x), lo = std::isfinite(hi) ? to_double(x - hi) : 0;
    char buffer[100];
    std::snprintf(buffer, sizeof buffer, "%.17g %+.17g (%a %+a)", hi, lo, hi, lo);
    return buffer;
}

// ------------------------------------------------------------------ surfaces

struct surface {
    bool asphere;
    double c, k, semi_diameter, a[8];
    surface() : asphere(false), c(0), k(0), semi_diameter(0), a() {}
    explicit surface(const sgt_conic &s) : asphere(false), c(s.c), k(s.k), semi_diameter(s.semi_diameter), a()
    {
    }
    explicit surface(const sgt_even_asphere &s)
        : asphere(true), c(s.c), k(s.k), semi_diameter(s.semi_diameter), a()
    {
        std::copy(s.a, s.a + 8, a);
    }
    bool bare() const { return std::all_of(a, a + 8, [](double v) { return v == 0; }); }
};

struct vector3 {
    quad x, y, z;
};
inline quad dot(const vector3 &a, const vector3 &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline quad norm(const vector3 &a) { return square_root(dot(a, a)); }

// F = z - s at a point, NaN outside the domain; its gradient; the largest of its
// terms (|z|, the base sag, each term of the polynomial, s); u = 1 - (1+k) c^2 r^2.
struct value {
    quad f, largest, u;
    vector3 gradient;
};

inline value evaluate(const surface &s, const vector3 &p)
{
    const quad c = s.c, rho = p.x * p.x + p.y * p.y, u = 1 - (1 + quad(s.k)) * c * c * rho;
    const quad root = square_root(u), base = c * rho / (1 + root);
    quad sag = 0, slope = 0, largest = std::max(magnitude(p.z), magnitude(base));
    for (int i = 7; i >= 0; i--) {
        slope = slope * rho + (i + 1) * quad(s.a[i]);
        sag = (sag + quad(s.a[i])) * rho;
    }
    quad power = 1;
    for (double a : s.a) {
        power *= rho;
        largest = std::max(largest, magnitude(quad(a) * power));
    }
    slope += c / (2 * root);
    sag += base;
    return value{p.z - sag, std::max(largest, magnitude(sag)), u, {-2 * p.x * slope, -2 * p.y * slope, 1}};
}

// The same in the polynomial form G = c (rho + (1+k) w^2) - 2 w, w = z - P(rho), that is
// smooth across the rim of the domain; G is about -2 (1 - (1+k) c w) F near the surface.
inline value evaluate_polynomial(const surface &s, const vector3 &p)
{
    const quad c = s.c, e = 1 + quad(s.k), rho = p.x * p.x + p.y * p.y;
    quad sag = 0, slope = 0;
    for (int i = 7; i >= 0; i--) {
        slope = slope * rho + (i + 1) * quad(s.a[i]);
        sag = (sag + quad(s.a[i])) * rho;
    }
    const quad w = p.z - sag, dw = 2 * (c * e * w - 1);
    value v = evaluate(s, p);
    v.f = c * (rho + e * w * w) - 2 * w;
    v.gradient = {2 * p.x * (c - dw * slope), 2 * p.y * (c - dw * slope), dw};
    return v;
}

// The distance of p from the surface, |F|/|grad F|, to first order.
inline quad normal_error(const surface &s, const vector3 &p, quad *largest)
{
    value v = evaluate(s, p);
    if (!(v.u > quad(0x1p-20))) v = evaluate_polynomial(s, p);
    *largest = v.largest;
    return magnitude(v.f) / norm(v.gradient);
}

// ------------------------------------------------------------------- answers

// One root, at t = t0 + s.
struct meeting {
    double t0;
    quad s;
    quad blur;          // how far the oracle itself may be off
    vector3 p;          // the point
    vector3 gradient;   // of F
    quad slope, spread; // grad F . d;  |x Fx| + |y Fy| + |z Fz|
    bool edge;          // within rounding of the rim, the soft rim or the sheet's limit: counts or not
    quad minus(double t) const { return (quad(t0) - t) + s; }
    quad t() const { return quad(t0) + s; }
};

struct answer {
    struct stretch {
        quad lo, hi;
    };
    std::vector<meeting> roots;     // in order of t
    std::vector<stretch> doubtful;  // none or two roots here (in t): too close to tell
    bool everywhere = false;        // the ray lies in a plane
    long stretches = 0;             // cost
    bool gave_up = false, at_fault = false;
};

// The soft rim: semi_diameter^2 (1 + 2^-44); this near to it either answer is right.
inline quad rim_squared(const surface &s)
{
    return quad(s.semi_diameter) * s.semi_diameter * (1 + quad(0x1p-44));
}
constexpr double rim_doubt = 0x1p-48;

struct line {
    double t0;
    vector3 o, d;
    line(const sgt_ray &r, double t)
        : t0(t), o{r.o.x + quad(t) * r.d.x, r.o.y + quad(t) * r.d.y, r.o.z + quad(t) * r.d.z}, d{r.d.x, r.d.y,
                                                                                                 r.d.z}
    {
    }
    vector3 at(quad s) const { return {o.x + s * d.x, o.y + s * d.y, o.z + s * d.z}; }
};

// Fills in what follows from s; false: certainly outside the soft rim.
inline bool complete(const surface &f, const line &l, meeting *m)
{
    m->t0 = l.t0;
    m->p = l.at(m->s);
    const value v = evaluate(f, m->p);
    m->gradient = v.gradient;
    m->slope = dot(v.gradient, l.d);
    m->spread = magnitude(m->p.x * v.gradient.x) + magnitude(m->p.y * v.gradient.y) + magnitude(m->p.z);
    if (f.semi_diameter > 0) {
        const quad rho = m->p.x * m->p.x + m->p.y * m->p.y, rim = rim_squared(f);
        if (rho > rim * (1 + rim_doubt)) return false;
        if (rho > rim * (1 - rim_doubt)) m->edge = true;
    }
    return true;
}

// ----------------------------------------------------------------- the conic

// The same root once more, from t0 = its own t: s is then less than an ulp of t, and its
// error that of C alone.
inline void polish_conic(const surface &f, const sgt_ray &ray, meeting *m)
{
    const quad c = f.c, e = 1 + quad(f.k), tiny = quad(0x1p-110);
    const double t = to_double(m->t());
    if (std::isfinite(t)) m->s = m->minus(t), m->t0 = t;
    const line l(ray, m->t0);
    const vector3 &o = l.o, &d = l.d;
    const quad A = c * (d.x * d.x + d.y * d.y + e * d.z * d.z),
               A_sum = magnitude(c) * (d.x * d.x + d.y * d.y + magnitude(e) * d.z * d.z);
    const quad B = d.z - c * (o.x * d.x + o.y * d.y + e * o.z * d.z);
    const quad B_sum = magnitude(d.z) + magnitude(c) * (magnitude(o.x * d.x) + magnitude(o.y * d.y) +
                                                        magnitude(e * o.z * d.z));
    const quad C = c * (o.x * o.x + o.y * o.y + e * o.z * o.z) - 2 * o.z;
    const quad C_sum = magnitude(c) * (o.x * o.x + o.y * o.y + magnitude(e) * o.z * o.z) + 2 * magnitude(o.z);
    const quad D = B * B - A * C, r = square_root(D > 0 ? D : quad(0)), q = B < 0 ? B - r : B + r;
    if (q != 0) {
        const quad near = C / q, other = A != 0 ? q / A : near;
        m->s = magnitude(near - m->s) <= magnitude(other - m->s) ? near : other;
    }
    // |ds| <= |dG| / |G'|, G' = -+ 2 sqrt(D)
    m->blur = tiny * ((A_sum * magnitude(m->s) + 2 * B_sum) * magnitude(m->s) + C_sum) / (2 * r) +
              tiny * magnitude(m->s);
}

inline answer conic_roots(const surface &f, const sgt_ray &ray)
{
    answer result;
    const quad c = f.c, e = 1 + quad(f.k), tiny = quad(0x1p-107);
    const line start(ray, 0);
    double t0 = to_double(-dot(start.o, start.d) / dot(start.d, start.d));
    if (!std::isfinite(t0)) t0 = 0;
    for (int pass = 0;; pass++) {
        const line l(ray, t0);
        const vector3 &o = l.o, &d = l.d;
        const quad a1 = d.x * d.x + d.y * d.y, a2 = e * d.z * d.z;
        const quad A = c * (a1 + a2), A_sum = magnitude(c) * (a1 + magnitude(a2));
        const quad B = d.z - c * (o.x * d.x + o.y * d.y + e * o.z * d.z);
        const quad B_sum = magnitude(d.z) + magnitude(c) * (magnitude(o.x * d.x) + magnitude(o.y * d.y) +
                                                            magnitude(e * o.z * d.z));
        const quad C = c * (o.x * o.x + o.y * o.y + e * o.z * o.z) - 2 * o.z;
        const quad C_sum = magnitude(c) * (o.x * o.x + o.y * o.y + magnitude(e) * o.z * o.z) +
                           2 * magnitude(o.z);
        const quad D = B * B - A * C,
                   D_error = tiny * (2 * magnitude(B) * B_sum + A_sum * magnitude(C) + magnitude(A) * C_sum);
        // A double root ahead: begin again in the middle of the chord, where B = 0.
        if (pass < 2 && magnitude(D) < quad(1e-3) * B * B && A != 0) {
            const double middle = to_double(quad(t0) + B / A);
            if (std::isfinite(middle) && middle != t0) {
                t0 = middle;
                continue;
            }
        }
        if (A == 0 && B == 0) {
            result.everywhere = C == 0;
            return result;
        }
        if (magnitude(D) <= D_error && A != 0) {
            const quad middle = B / A, half = 2 * square_root(D_error) / magnitude(A);
            const vector3 p = l.at(middle);
            const quad side = 1 - e * c * p.z,
                       margin = magnitude(e * c * d.z * half) + quad(1e-25) * (1 + magnitude(e * c * p.z));
            const quad reach = square_root(p.x * p.x + p.y * p.y) - square_root(a1) * half;
            if (side > -margin &&
                (f.semi_diameter == 0 || reach <= 0 || reach * reach < rim_squared(f) * (1 + rim_doubt)))
                result.doubtful.push_back({quad(t0) + middle - half, quad(t0) + middle + half});
            return result;
        }
        if (D < 0) return result;
        const quad r = square_root(D), q = B < 0 ? B - r : B + r;
        const quad s[2] = {C / q, q / A};
        for (int i = 0; i < (A == 0 ? 1 : 2); i++) {
            meeting m = {};
            m.t0 = t0;
            m.s = s[i];
            if (!(m.s - m.s == 0)) continue; // infinite: A is next to nothing
            polish_conic(f, ray, &m);
            const line at(ray, m.t0);
            const vector3 p = at.at(m.s);
            const quad side = 1 - e * c * p.z, margin = quad(1e-25) * (1 + magnitude(e * c * p.z));
            if (side < -margin) continue;
            m.edge = side < margin;
            if (complete(f, at, &m)) result.roots.push_back(m);
        }
        std::sort(result.roots.begin(), result.roots.end(),
                  [](const meeting &x, const meeting &y) { return x.minus(y.t0) < y.s; });
        return result;
    }
}

// --------------------------------------------------------------- the asphere

// The equation along one line, in the arithmetic T, with padded ranges.
template <class T> struct equation {
    T epsilon;
    T rho0, b, q, bottom; // rho = rho0 + 2 b s + q s^2, least at `bottom`
    T z0, n;
    T c, e2;              // |c|; (1 + k) c^2
    bool concave;         // c < 0
    T up[8], down[8];     // positive and negative terms

    static T infinity() { return T(HUGE_VAL); }

    struct range {
        T lo, hi;
        bool zero() const { return !(lo > 0 || hi < 0); } // NaN: yes
    };
    static range product(range x, range y)
    {
        if (x.lo != x.lo || x.hi != x.hi || y.lo != y.lo || y.hi != y.hi) return {-infinity(), infinity()};
        T lo = infinity(), hi = -infinity();
        for (T u : {x.lo, x.hi})
            for (T v : {y.lo, y.hi}) {
                const T w = u == 0 || v == 0 ? T(0) : u * v;
                lo = std::min(lo, w);
                hi = std::max(hi, w);
            }
        return {lo, hi};
    }
    static void horner(const T *a, T rho, T *sum, T *slope)
    {
        T p = 0, d = 0;
        for (int i = 7; i >= 0; i--) {
            d = d * rho + T(i + 1) * a[i];
            p = (p + a[i]) * rho;
        }
        *sum = p;
        *slope = d;
    }
    T rho_at(T s, T *pad) const
    {
        *pad = 16 * epsilon * (rho0 + 2 * magnitude(b * s) + q * s * s);
        return rho0 + (2 * b + q * s) * s;
    }

    // Ranges of g and g' over [s1, s2]; a part of it outside the domain is left out.
    void enclose(T s1, T s2, range *g, range *slope) const
    {
        T pad1, pad2;
        const T r1 = rho_at(s1, &pad1), r2 = rho_at(s2, &pad2);
        const T most = std::max(r1 + pad1, r2 + pad2);
        T least = std::min(r1 - pad1, r2 - pad2);
        if (s1 <= bottom && bottom <= s2)
            least = T(0) + std::min(least, rho0 - b * b / q - 16 * epsilon * rho0);
        if (!(least > 0)) least = 0;

        const T u_pad = 16 * epsilon * (1 + magnitude(e2) * most);
        const T u_least = 1 - e2 * least, u_most = 1 - e2 * most;
        auto root = [&](T u) { return u > 0 ? square_root(u) : T(0); };
        const T more = 1 + 64 * epsilon, less = 1 - 64 * epsilon;
        range base = {c * least / (1 + root(u_least + u_pad)) * less,
                      c * most / (1 + root(u_most - u_pad)) * more};
        const T ua = std::min(u_least, u_most) - u_pad, ub = std::max(u_least, u_most) + u_pad;
        range tilt = {ub > 0 ? c / (2 * root(ub)) * less : infinity(),
                      ua > 0 ? c / (2 * root(ua)) * more : (c > 0 ? infinity() : T(0))};
        if (concave) {
            base = {-base.hi, -base.lo};
            tilt = {-tilt.hi, -tilt.lo};
        }
        T p1, p2, d1, d2, m1, m2, k1, k2;
        horner(up, least, &p1, &d1);
        horner(up, most, &p2, &d2);
        horner(down, least, &m1, &k1);
        horner(down, most, &m2, &k2);
        const range sag = {base.lo + p1 * less - m2 * more, base.hi + p2 * more - m1 * less};
        const range profile = {tilt.lo + d1 * less - k2 * more, tilt.hi + d2 * more - k1 * less};
        const T sag_pad = 8 * epsilon * (p2 + m2 + magnitude(base.lo) + magnitude(base.hi));

        const T za = z0 + n * s1, zb = z0 + n * s2;
        const T z_pad = 8 * epsilon * (magnitude(z0) + magnitude(n) * std::max(magnitude(s1), magnitude(s2)));
        *g = {std::min(za, zb) - sag.hi - z_pad - sag_pad, std::max(za, zb) - sag.lo + z_pad + sag_pad};

        const T v_pad = 16 * epsilon * (magnitude(b) + q * std::max(magnitude(s1), magnitude(s2)));
        const range w = product(profile, range{2 * (b + q * s1) - v_pad, 2 * (b + q * s2) + v_pad});
        *slope = {n - w.hi - 8 * epsilon * (magnitude(n) + magnitude(w.hi)),
                  n - w.lo + 8 * epsilon * (magnitude(n) + magnitude(w.lo))};
        if (slope->lo != slope->lo) slope->lo = -infinity();
        if (slope->hi != slope->hi) slope->hi = infinity();
    }
};

class asphere_search {
public:
    asphere_search(const surface &f, const sgt_ray &ray) : surface_(f), ray_(ray), line_(ray, middle(ray))
    {
        fill(&exact_, quad(0x1p-113));
        fill(&quick_, 0x1p-53);
        run();
    }
    answer result;

private:
    surface surface_;
    sgt_ray ray_;
    line line_;
    equation<quad> exact_;
    equation<double> quick_;
    quad ends_[2] = {};          // the chord
    bool rim_ends_ = false;      // ... ends where u = 0
    long budget_ = 200000;

    // Nearest to the axis.
    static double middle(const sgt_ray &r)
    {
        const quad l = r.d.x, m = r.d.y, q = l * l + m * m;
        const double t = q > 0 ? to_double(-(r.o.x * l + r.o.y * m) / q) : to_double(-quad(r.o.z) / r.d.z);
        return std::isfinite(t) ? t : 0;
    }

    template <class T> void fill(equation<T> *f, T epsilon) const
    {
        const vector3 &o = line_.o, &d = line_.d;
        const quad b = o.x * d.x + o.y * d.y, q = d.x * d.x + d.y * d.y;
        f->epsilon = epsilon;
        f->rho0 = T(o.x * o.x + o.y * o.y);
        f->b = T(b);
        f->q = T(q);
        f->bottom = q > 0 ? T(-b / q) : T(0);
        f->z0 = T(o.z);
        f->n = T(d.z);
        f->c = T(magnitude(quad(surface_.c)));
        f->concave = surface_.c < 0;
        f->e2 = T((1 + quad(surface_.k)) * surface_.c * surface_.c);
        for (int i = 0; i < 8; i++) {
            f->up[i] = T(std::max(surface_.a[i], 0.0));
            f->down[i] = T(std::max(-surface_.a[i], 0.0));
        }
    }

    void run()
    {
        const quad e2 = exact_.e2, q = exact_.q, b = exact_.b, rho0 = exact_.rho0, n = exact_.n;
        quad limit = 0; // of rho; 0: none
        if (e2 > 0) limit = 1 / e2, rim_ends_ = true;
        if (surface_.semi_diameter > 0) {
            const quad rim = quad(surface_.semi_diameter) * surface_.semi_diameter * (1 + quad(0x1p-40));
            if (limit == 0 || rim < limit) limit = rim, rim_ends_ = false;
        }
        if (q == 0) { // parallel to the axis
            if (limit > 0 && rho0 > limit * (1 + quad(1e-30))) return;
            meeting m = {};
            m.edge = rim_ends_ && rho0 > limit * (1 - quad(1e-30));
            const quad z = line_.o.z;
            quad sag = -evaluate(surface_, {line_.o.x, line_.o.y, 0}).f;
            if (sag != sag) return;
            m.s = (sag - z) / n;
            m.blur = quad(0x1p-105) * (magnitude(sag) + magnitude(z)) / magnitude(n);
            if (complete(surface_, line_, &m)) {
                polish(&m);
                result.roots.push_back(m);
            }
            return;
        }
        if (limit > 0) {
            const quad D = b * b - q * (rho0 - limit);
            if (D <= 0) return;
            const quad r = square_root(D), w = b < 0 ? b - r : b + r;
            quad s1 = -w / q, s2 = -(rho0 - limit) / w;
            if (s1 > s2) std::swap(s1, s2);
            ends_[0] = s1, ends_[1] = s2;
        } else {
            const quad reach = bound();
            ends_[0] = -reach, ends_[1] = reach;
        }
        const double lo = to_double(ends_[0]), hi = to_double(ends_[1]);
        if (std::fabs(lo) < 1e150 && std::fabs(hi) < 1e150 && hi - lo > 1e-150) quick(lo, hi);
        else careful(ends_[0], ends_[1]);
        merge();
        auto &r = result.roots;
        std::sort(r.begin(), r.end(), [](const meeting &x, const meeting &y) { return x.minus(y.t0) < y.s; });
        // A root on a border between two stretches has been found from both sides.
        const quad same = quad(0x1p-80);
        r.erase(std::unique(r.begin(), r.end(),
                            [&](const meeting &x, const meeting &y) {
                                return y.s - x.minus(y.t0) <= same * (ends_[1] - ends_[0]) * quad(0x1p-20) &&
                                       (x.slope > 0) == (y.slope > 0);
                            }),
                r.end());
    }

    // No root has |s| beyond this: see the head.
    quad bound() const
    {
        int j = 7;
        quad a[8];
        for (int i = 0; i < 8; i++) a[i] = surface_.a[i];
        const bool paraboloid = exact_.e2 == 0; // then c rho/2 is a term of the polynomial
        if (paraboloid) a[0] += quad(surface_.c) / 2;
        while (j >= 0 && a[j] == 0) j--;
        const quad q = exact_.q, rho0 = exact_.rho0, b = exact_.b;
        quad s = std::max(square_root(rho0 / q), 2 * magnitude(b) / q);
        if (s == 0) s = square_root(1 / q);
        if (j < 0) return s + 2 * (magnitude(exact_.z0) + 1) / magnitude(exact_.n); // (nothing but a plane)
        for (int tries = 0; tries < 4000; tries++, s *= 2) {
            bool enough = true;
            for (quad sign : {quad(-1), quad(1)}) {
                const quad rho = rho0 + (2 * b + q * sign * s) * sign * s;
                quad power = 1, rest = magnitude(exact_.z0) + magnitude(exact_.n) * s;
                for (int i = 0; i < j; i++) {
                    power *= rho;
                    rest += magnitude(a[i]) * power;
                }
                if (!paraboloid && surface_.c != 0)
                    rest += std::min(exact_.c * rho / 2, square_root(rho * exact_.c * exact_.c / -exact_.e2));
                enough = enough && magnitude(a[j]) * power * rho > rest * quad(1.0001);
            }
            if (enough) return s * quad(1.001);
        }
        return s;
    }

    bool spend()
    {
        result.stretches++;
        if (--budget_ > 0) return true;
        result.gave_up = true;
        return false;
    }

    // Split, but not where symmetry would put a root.
    template <class T> static T split(T s1, T s2) { return s1 + (s2 - s1) * T(0.48710938); }

    // 0: no root; 1: monotone; 2: split; 3: too fine for this arithmetic
    template <class T> int judge(const equation<T> &f, T s1, T s2) const
    {
        typename equation<T>::range g, slope, gm, unused;
        f.enclose(s1, s2, &g, &slope);
        if (!g.zero()) return 0;
        if (!slope.zero()) return 1;
        const T m = split(s1, s2);
        if (!(s1 < m && m < s2)) return 3;
        f.enclose(m, m, &gm, &unused);
        if (slope.lo > -f.infinity() && slope.hi < f.infinity()) {
            const T left = m - s1, right = s2 - m;
            const T least = std::min(slope.lo * right, -slope.hi * left),
                    most = std::max(slope.hi * right, -slope.lo * left);
            const T lo = gm.lo + least * (least < 0 ? 1 + 16 * f.epsilon : 1 - 16 * f.epsilon);
            const T hi = gm.hi + most * (most > 0 ? 1 + 16 * f.epsilon : 1 - 16 * f.epsilon);
            if (lo > 0 || hi < 0) return 0;
            if (gm.hi - gm.lo > (most - least) / 4) return 3; // noise at a point is all there is
        }
        if (!(s2 - s1 > 1024 * f.epsilon * std::max(magnitude(s1), magnitude(s2)))) return 3;
        if (!(s2 - s1 > 1024 * f.epsilon * T(ends_[1] - ends_[0]))) return 3;
        return 2;
    }

    void quick(double s1, double s2)
    {
        if (!spend()) return;
        switch (judge(quick_, s1, s2)) {
        case 0: return;
        case 1: between(s1, s2); return;
        case 2: {
            const double m = split(s1, s2);
            quick(s1, m);
            quick(m, s2);
            return;
        }
        default: {
            quad a = s1, b = s2;
            true_ends(&a, &b);
            careful(a, b);
        }
        }
    }

    void careful(quad s1, quad s2)
    {
        if (!spend()) return;
        switch (judge(exact_, s1, s2)) {
        case 0: return;
        case 1: between(s1, s2); return;
        case 2: {
            const quad m = split(s1, s2);
            careful(s1, m);
            careful(m, s2);
            return;
        }
        default: doubt(s1, s2);
        }
    }

    void doubt(quad s1, quad s2)
    {
        const vector3 p = line_.at(s1);
        if (surface_.semi_diameter > 0 && p.x * p.x + p.y * p.y > rim_squared(surface_) * (1 + rim_doubt))
            return;
        result.doubtful.push_back({quad(line_.t0) + s1, quad(line_.t0) + s2});
    }

    // Stretches that touch, or nearly, are one; a root in one is part of it.
    void merge()
    {
        auto &d = result.doubtful;
        std::sort(d.begin(), d.end(),
                  [](const answer::stretch &x, const answer::stretch &y) { return x.lo < y.lo; });
        std::size_t n = 0;
        for (std::size_t i = 0; i < d.size(); i++)
            if (n && d[i].lo - d[n - 1].hi <= 16 * (d[i].hi - d[i].lo + d[n - 1].hi - d[n - 1].lo))
                d[n - 1].hi = std::max(d[n - 1].hi, d[i].hi);
            else d[n++] = d[i];
        d.resize(n);
        auto &r = result.roots;
        r.erase(std::remove_if(r.begin(), r.end(),
                               [&](const meeting &m) {
                                   return std::any_of(d.begin(), d.end(), [&](const answer::stretch &x) {
                                       const quad wide = 16 * (x.hi - x.lo);
                                       return m.t() >= x.lo - wide && m.t() <= x.hi + wide;
                                   });
                               }),
                r.end());
    }

    // g at s and how far it may be off; at an end of the domain u = 0 exactly.
    quad g_at(quad s, quad *slope, quad *error) const
    {
        const quad z = line_.o.z + s * line_.d.z, tiny = quad(0x1p-108);
        const quad moved = tiny * (magnitude(line_.o.z) + magnitude(s * line_.d.z));
        if (rim_ends_ && (s == ends_[0] || s == ends_[1])) {
            const quad rho = 1 / exact_.e2, base = rho * surface_.c;
            quad p1, p2, d1, d2;
            equation<quad>::horner(exact_.up, rho, &p1, &d1);
            equation<quad>::horner(exact_.down, rho, &p2, &d2);
            *error = moved + tiny * (magnitude(base) + p1 + p2);
            if (slope) *slope = 0;
            return z - base - p1 + p2;
        }
        const vector3 p = line_.at(s);
        const value v = evaluate(surface_, p);
        const quad u = v.u > 0 ? v.u : quad(0);
        *error = moved + tiny * (8 * v.largest + magnitude(quad(surface_.c)) * (p.x * p.x + p.y * p.y) /
                                                     (square_root(u) + quad(0x1p-50)));
        if (slope) *slope = dot(v.gradient, line_.d);
        return z != z ? z : v.f;
    }

    void found(quad s, bool edge)
    {
        meeting m = {};
        m.s = s;
        m.edge = edge;
        quad slope, error;
        g_at(s, &slope, &error);
        m.blur = (slope != 0 ? error / magnitude(slope) : quad(0)) + quad(0x1p-110) * magnitude(s);
        if (complete(surface_, line_, &m)) {
            polish(&m);
            result.roots.push_back(m);
        }
    }

    // One Newton step more, from t0 = its own t: what s and z lose in moving far is gone.
    // Its error is that of F: each operation's half ulp, with rho's fourfold one in each term.
    void polish(meeting *m) const
    {
        const double t = to_double(m->t());
        if (!std::isfinite(t)) return;
        const line l(ray_, t);
        const quad s = m->minus(t), c = surface_.c, ulp = quad(0x1p-113);
        const vector3 p = l.at(s);
        const value v = evaluate(surface_, p);
        if (!(v.u > quad(1e-20))) return;
        const quad rho = p.x * p.x + p.y * p.y, slope = dot(v.gradient, l.d);
        quad power = 1, sum = 0;
        for (int i = 0; i < 8; i++) {
            power *= rho;
            sum += (6 * i + 10) * magnitude(quad(surface_.a[i])) * power;
        }
        const quad base = magnitude(c) * rho * (10 + (4 + 2 * (1 + magnitude(1 - v.u))) / square_root(v.u));
        const quad moved = magnitude(l.o.z) + 2 * magnitude(s * l.d.z) +
                           2 * (magnitude(v.gradient.x * s * l.d.x) + magnitude(v.gradient.y * s * l.d.y));
        const quad blur = ulp * (base + sum + 2 * magnitude(p.z) + moved) / magnitude(slope) +
                          2 * ulp * magnitude(s);
        const quad next = s - v.f / slope;
        if (!(magnitude(next - s) <= 4 * (blur + m->blur))) return;
        m->s = next;
        m->blur = blur;
        const bool edge = m->edge;
        complete(surface_, l, m);
        m->edge = m->edge || edge;
    }

    // A double end of the chord stands for the true one.
    void true_ends(quad *s1, quad *s2) const
    {
        if (*s1 == quad(to_double(ends_[0]))) *s1 = ends_[0];
        if (*s2 == quad(to_double(ends_[1]))) *s2 = ends_[1];
    }

    // g is monotone on [s1, s2].
    void between(quad s1, quad s2)
    {
        true_ends(&s1, &s2);
        quad error1, error2;
        const quad g1 = g_at(s1, nullptr, &error1), g2 = g_at(s2, nullptr, &error2);
        const bool sure1 = magnitude(g1) > error1, sure2 = magnitude(g2) > error2;
        if (sure1 && sure2 && (g1 > 0) == (g2 > 0)) return;
        if (!sure1 || !sure2) {
            // At a simple root g leaves its noise at once; beside a double one it does not.
            const quad end = sure1 ? s2 : s1;
            quad slope, error;
            g_at(end, &slope, &error);
            const quad noise = slope == 0 ? s2 - s1 : error / magnitude(slope);
            if (slope != 0 && noise > quad(0x1p-80) * (ends_[1] - ends_[0])) {
                doubt(end - noise, end + noise);
                return;
            }
            const bool rim = rim_ends_ && (s1 - ends_[0] < quad(0x1p-40) * (ends_[1] - ends_[0]) ||
                                           ends_[1] - s2 < quad(0x1p-40) * (ends_[1] - ends_[0]));
            found(sure1 ? s2 : s1, rim);
            return;
        }
        // Double first, for a start, then quad; the bracket guards both.
        quad lo = s1, hi = s2;
        const bool rising = g1 < 0;
        double guess = to_double(split(s1, s2));
        {
            double a = to_double(s1), b = to_double(s2);
            for (int i = 0; i < 60 && b > a; i++) {
                const double rho = quick_.rho0 + (2 * quick_.b + quick_.q * guess) * guess,
                             u = 1 - quick_.e2 * rho;
                double p, d, m, k;
                equation<double>::horner(quick_.up, rho, &p, &d);
                equation<double>::horner(quick_.down, rho, &m, &k);
                const double root = u > 0 ? std::sqrt(u) : 0, sign = quick_.concave ? -1 : 1;
                const double g = quick_.z0 + quick_.n * guess - sign * quick_.c * rho / (1 + root) - p + m;
                const double slope = quick_.n - 2 * (quick_.b + quick_.q * guess) *
                                                    (sign * quick_.c / (2 * root) + d - k);
                ((g < 0) == rising ? a : b) = guess;
                double next = guess - g / slope;
                if (!(next > a && next < b)) next = a + (b - a) / 2;
                const double step = std::fabs(next - guess);
                guess = next;
                if (step <= 0x1p-50 * std::fabs(guess)) break;
            }
        }
        quad s = guess;
        if (!(s > lo && s < hi)) s = split(lo, hi);
        for (int i = 0; i < 400; i++) {
            quad slope, error;
            const quad g = g_at(s, &slope, &error);
            if (magnitude(g) <= error / 16) break;
            ((g < 0) == rising ? lo : hi) = s;
            quad next = s - g / slope;
            if (!(next > lo && next < hi)) next = lo + (hi - lo) / 2;
            const quad step = magnitude(next - s);
            s = next;
            if (step <= quad(0x1p-111) * magnitude(s) || !(hi - lo > quad(0x1p-112) * magnitude(s))) break;
        }
        found(s, false);
    }
};

// Every root on the whole line; the caller cuts it to [tmin, tmax].
inline answer all_roots(const surface &f, const sgt_ray &ray)
{
    answer a = f.bare() ? conic_roots(f, ray) : asphere_search(f, ray).result;
    // F must vanish there, or the oracle itself is at fault.
    for (const meeting &m : a.roots) {
        const value v = evaluate(f, m.p);
        if (!m.edge &&
            !(magnitude(v.f) <= (16 * m.blur + quad(0x1p-100) * magnitude(m.s)) * magnitude(m.slope) +
                                    quad(0x1p-100) * v.largest))
            a.at_fault = true;
    }
    return a;
}

// The same conic by the asphere's method: the oracle's check of itself.
inline answer all_roots_by_search(const surface &f, const sgt_ray &ray)
{
    return asphere_search(f, ray).result;
}

// Does this root count on the ray from tmin to tmax?  The rule is sgt_ray's.  Where it
// leaves a width - at tmin, where t_err takes part, at tmax, at the soft rim - a root
// within that width may count or not, and neither answer is wrong.
enum counts { no, perhaps, yes };

inline counts counting(const meeting &m, double tmin, double tmax)
{
    const quad start = quad(0x1p-48) * m.spread / magnitude(m.slope);
    const quad slack = 8 * start + 64 * quad(ulp(to_double(m.t()))) + m.blur,
               less = start * (1 - quad(0x1p-20)) - m.blur;
    counts result = m.edge ? perhaps : yes;
    if (std::isfinite(tmin)) {
        const quad beyond = m.minus(tmin);
        if (beyond <= 0) return no;
        if (!(start >= 0)) return perhaps; // at the equator itself both spread and slope are infinite
        if (beyond <= less) return no;
        if (beyond <= start + slack) result = perhaps;
    }
    if (std::isfinite(tmax)) {
        const quad left = -m.minus(tmax);
        if (left < -slack) return no;
        if (left <= slack) result = perhaps;
    }
    return result;
}

// Which root does an answer speak of?  The one nearest to t + t_lo: where the origin is far
// several roots can lie within t_err of one t.
inline const meeting *meant(const answer &a, const sgt_hit &h)
{
    const meeting *best = nullptr;
    quad least = 0;
    for (const meeting &m : a.roots) {
        const quad off = magnitude(m.minus(h.t) - h.t_lo);
        if (!best || off < least) best = &m, least = off;
    }
    return best;
}

// Is another root, before that one, left out?  (Not where t_err and p_err cover both.)
inline bool passed_over(const answer &a, const meeting &root, const sgt_hit &h, double tmin, double tmax)
{
    for (const meeting &m : a.roots) {
        if (!(m.minus(root.t0) < root.s) || counting(m, tmin, tmax) != yes) continue;
        if (magnitude(m.minus(h.t)) > quad(h.t_err) ||
            norm({m.p.x - h.p.x, m.p.y - h.p.y, m.p.z - h.p.z}) > quad(h.p_err))
            return true;
    }
    return false;
}

// Is t as near to a doubtful stretch as t_err says?
inline bool in_doubt(const answer &a, const sgt_hit &h)
{
    for (const answer::stretch &d : a.doubtful)
        if (d.lo <= quad(h.t) + h.t_err && d.hi >= quad(h.t) - h.t_err) return true;
    return false;
}

} // namespace oracle
#endif
