// SPDX-License-Identifier: MIT
// judge.h - the roots of a ray and a surface of the catalogue, and rays of many kinds.
//
// The ray is moved to where the surface is, in 113 bits, and cut to a window: of a sag the chord of a
// cylinder (its rim, or 1.5 h where it has none), between the planes of its least and greatest sag there;
// else a ball.  In the window `samples` values of F in double, and in 113 bits where their sign is not
// certain.  Two neighbours of unlike sign are a root, which bisection and Newton's method take to 113 bits;
// between neighbours of like sign with a minimum of |F| in between that is searched for, and where it is
// within rounding of zero the stretch is doubtful.  An edge of F's domain is a sample.  What is finer than
// a sample and announces itself by no dip is not seen: a judge of random rays, no proof.  About points
// where a root may be, `crowd` (t), the samples are closer and closer.
#ifndef TESTS_CATALOGUE_JUDGE_H
#define TESTS_CATALOGUE_JUDGE_H

#include "specimens.h"

namespace catalogue {

using oracle::counts;
using oracle::line;
using oracle::vector3;

struct root {
    quad t;
    vector3 p, n;
    quad slope, spread;
    bool edge; // within rounding of the rim
};

struct stretch {
    quad lo, hi;
};

// What stays the same for all rays of a surface.
struct subject {
    const specimen &s;
    formula<double> rough;
    formula<quad> exact;
    formula<dual<quad, 3>> by_point;
    double radius, low, high; // of a sag: the window; else the ball's radius
    explicit subject(const specimen &of)
        : s(of), rough(of.s), exact(of.s), by_point(of.s), radius(0), low(0), high(0)
    {
        if (!s.sag) {
            radius = 8 * s.h;
            if (s.type == "torus")
                radius = (static_cast<const sgt_torus *>(s.s.self)->major +
                          static_cast<const sgt_torus *>(s.s.self)->minor) *
                         1.01;
            if (s.type == "ellipsoid")
                radius = s.h * std::max(1.0, 1 - static_cast<const sgt_ellipsoid *>(s.s.self)->f) * 1.01;
            return;
        }
        radius = s.rim > 0 ? s.rim * (1 + 1e-9) : 1.5 * s.h;
        for (int i = 0; i <= 24; i++)
            for (int j = 0; j < 24; j++) {
                const double r = radius * i / 24, about = 6.283185307179586 * j / 24,
                             z = -rough(r * std::cos(about), r * std::sin(about), 0.0);
                if (z == z) low = std::min(low, z), high = std::max(high, z);
            }
        const double more = 0.3 * (high - low) + 1e-3 * s.h;
        low -= more;
        high += more;
    }
};

class judgement {
public:
    std::vector<root> roots; // in order of t
    std::vector<stretch> doubtful;
    bool looked = false;     // there is a window
    bool everywhere = false; // the ray lies in the surface
    double from = 0, to = 0; // in t: the window

    judgement(const subject &of, const sgt_ray &ray, int samples, const std::vector<double> &crowd = {})
        : of_(of), line_(ray, 0)
    {
        const double near = -(ray.o.x * ray.d.x + ray.o.y * ray.d.y + ray.o.z * ray.d.z) /
                            (ray.d.x * ray.d.x + ray.d.y * ray.d.y + ray.d.z * ray.d.z);
        if (!std::isfinite(near)) return;
        line_ = line(ray, near);
        double lo, hi;
        if (!window(&lo, &hi)) return;
        looked = true;
        const double middle = lo + (hi - lo) / 2;
        if (std::isfinite(near + middle)) { // nearer still
            line_ = line(ray, near + middle);
            const double by = oracle::to_double(quad(near) + middle - line_.t0);
            lo = lo - middle + by, hi = hi - middle + by;
        }
        from = line_.t0 + lo, to = line_.t0 + hi;
        walk(lo, hi, samples, crowd);
        std::sort(roots.begin(), roots.end(), [](const root &a, const root &b) { return a.t < b.t; });
    }

    quad at(quad t) const { return value(t - line_.t0); }

    // The root nearest t by Newton's method from there, in 113 bits; false: it leads nowhere.
    bool polish(quad t, root *r) const
    {
        quad s = t - line_.t0;
        for (int i = 0; i < 60; i++) {
            *r = about(s);
            const quad f = value(s), step = f / r->slope;
            if (!(step == step)) return false;
            if (oracle::magnitude(step) <=
                    quad(0x1p-104) *
                        (oracle::magnitude(s) + quad(of_.s.h) / oracle::norm(line_.d) * quad(0x1p-8)) ||
                f == 0)
                return true;
            s -= step;
        }
        return false;
    }

    root about(quad s) const
    {
        typedef dual<quad, 3> number;
        root r;
        r.t = quad(line_.t0) + s;
        r.p = line_.at(s);
        const number f = of_.by_point(number::variable(r.p.x, 0), number::variable(r.p.y, 1),
                                      number::variable(r.p.z, 2));
        r.n = {f.v[0], f.v[1], f.v[2]};
        r.slope = oracle::dot(r.n, line_.d);
        r.spread = oracle::magnitude(r.p.x * r.n.x) + oracle::magnitude(r.p.y * r.n.y) +
                   oracle::magnitude(r.p.z * r.n.z);
        r.edge = false;
        return r;
    }

private:
    const subject &of_;
    line line_;

    quad value(quad s) const
    {
        const vector3 p = line_.at(s);
        return of_.exact(p.x, p.y, p.z);
    }
    double rough(double s) const
    {
        return of_.rough(oracle::to_double(line_.o.x + quad(s) * line_.d.x),
                         oracle::to_double(line_.o.y + quad(s) * line_.d.y),
                         oracle::to_double(line_.o.z + quad(s) * line_.d.z));
    }
    // -1, 0, 1; 2: not defined.  Where rounding might hide it, f is made right.
    int sign(double s, double &f) const
    {
        if (f != f) return 2;
        if (std::fabs(f) > 1e-7 * of_.s.h *
                               (of_.s.sag                   ? 1
                                : of_.s.type == "ellipsoid" ? 1
                                : of_.s.type == "quadric"   ? of_.s.h
                                                            : of_.s.h * of_.s.h * of_.s.h))
            return f < 0 ? -1 : 1;
        const quad q = value(quad(s));
        f = oracle::to_double(q);
        return q != q ? 2 : q < 0 ? -1 : q > 0;
    }

    bool window(double *lo, double *hi)
    {
        const vector3 &o = line_.o, &d = line_.d;
        const double ox = oracle::to_double(o.x), oy = oracle::to_double(o.y), oz = oracle::to_double(o.z),
                     dx = oracle::to_double(d.x), dy = oracle::to_double(d.y), dz = oracle::to_double(d.z);
        const double w = of_.s.sag ? 0 : 1, A = dx * dx + dy * dy + w * dz * dz,
                     B = ox * dx + oy * dy + w * oz * dz,
                     C = ox * ox + oy * oy + w * oz * oz - of_.radius * of_.radius;
        const double D = B * B - A * C;
        *lo = -HUGE_VAL, *hi = HUGE_VAL;
        if (!(D >= 0)) return false;
        if (A > 0) *lo = (-B - std::sqrt(D)) / A, *hi = (-B + std::sqrt(D)) / A;
        else if (C > 0) return false;
        if (of_.s.sag && dz != 0) {
            const double a = (of_.low - oz) / dz, b = (of_.high - oz) / dz;
            *lo = std::max(*lo, std::min(a, b));
            *hi = std::min(*hi, std::max(a, b));
        } else if (of_.s.sag && !(oz >= of_.low && oz <= of_.high)) return false;
        return *lo < *hi && std::isfinite(*lo) && std::isfinite(*hi);
    }

    void walk(double lo, double hi, int samples, const std::vector<double> &crowd)
    {
        struct sample {
            double s, f;
            int sign;
        };
        std::vector<sample> all;
        const auto take = [&](double s) {
            double f = rough(s);
            const int side = sign(s, f);
            return sample{s, f, side};
        };
        std::vector<double> where;
        for (int i = 0; i < samples; i++)
            where.push_back(lo + (hi - lo) * (i + (i ? 0.3 * std::sin(double(i)) : 0)) / samples);
        where.push_back(hi);
        for (const double t : crowd)
            for (int k = 8; k < 52; k++)
                for (const double side : {-1, 1}) {
                    const double s = oracle::to_double(quad(t) - line_.t0) + side * std::ldexp(hi - lo, -k);
                    if (s > lo && s < hi) where.push_back(s);
                }
        std::sort(where.begin(), where.end());
        where.erase(std::unique(where.begin(), where.end()), where.end());
        for (const double here : where) {
            const sample next = take(here);
            if (!all.empty() && (next.sign == 2) != (all.back().sign == 2)) { // the edge of the domain
                double a = all.back().s, b = next.s;
                const bool inside_first = next.sign == 2;
                for (int k = 0; k < 60;
                     k++) { // in 113 bits: `rough` may be defined where F is not, its point rounded inward
                    const double m = a + (b - a) / 2;
                    if (!(m > a && m < b)) break;
                    const quad there = value(quad(m));
                    ((there == there) == inside_first ? a : b) = m;
                }
                const double beside = inside_first ? a : b;
                const quad q = value(quad(beside));
                if (q == q) all.push_back({beside, oracle::to_double(q), q < 0 ? -1 : q > 0});
            }
            all.push_back(next);
        }
        long zero = 0;
        for (const sample &a : all) zero += a.sign == 0;
        if ((everywhere = zero > static_cast<long>(all.size() / 2))) return;
        for (std::size_t i = 0; i < all.size(); i++) {
            if (all[i].sign == 0) {
                add(quad(all[i].s));
                continue;
            }
            if (i + 1 < all.size() && all[i].sign != 2 && all[i + 1].sign != 2 &&
                all[i].sign * all[i + 1].sign < 0)
                between(all[i].s, all[i + 1].s);
            if (i > 0 && i + 1 < all.size() && all[i].sign != 2 && all[i - 1].sign == all[i].sign &&
                all[i + 1].sign == all[i].sign) {
                const double a = std::fabs(all[i - 1].f), b = std::fabs(all[i].f),
                             c = std::fabs(all[i + 1].f);
                if (b <= a && b <= c && a + c - 2 * b > 0 &&
                    (a - c) * (a - c) / (8 * (a + c - 2 * b)) > 0.2 * b)
                    dip(all[i - 1].s, all[i].s, all[i + 1].s, all[i].sign);
                else if (b <= a && b <= c && b <= 0.3 * (a + c))
                    dip(all[i - 1].s, all[i].s, all[i + 1].s, all[i].sign);
            }
        }
    }

    void between(double a, double b)
    {
        quad lo = a, hi = b;
        const quad f_lo = value(lo), f_hi = value(hi);
        root r;
        if (!((f_lo < 0 && f_hi > 0) || (f_lo > 0 && f_hi < 0)))
            return; // beside the edge of the domain the doubles are wrong
        for (int i = 0; i < 110; i++) {
            const quad m = (lo + hi) / 2;
            if (i > 6 && i % 4 == 3 && polish(quad(line_.t0) + m, &r) && r.t - line_.t0 >= lo &&
                r.t - line_.t0 <= hi)
                return add(r.t - line_.t0);
            const quad f = value(m);
            if (f == 0) return add(m);
            ((f < 0) == (f_lo < 0) ? lo : hi) = m;
        }
        add((lo + hi) / 2);
    }

    void dip(double a, double m, double b, int was)
    {
        // Golden section.
        double fm = rough(m);
        sign(m, fm);
        fm = std::fabs(fm);
        for (int i = 0; i < 70; i++) {
            const double s = m - a > b - m ? m - 0.381966 * (m - a) : m + 0.381966 * (b - m);
            double f = rough(s);
            if (!(s > a && s < b)) break;
            const int now = sign(s, f);
            if (now == 2) return;
            if (now != was) {
                if (now == 0) return doubtful.push_back({quad(line_.t0) + a, quad(line_.t0) + b});
                between(a, s);
                between(s, b);
                return;
            }
            if (std::fabs(f) < fm) {
                (s < m ? b : a) = m;
                m = s;
                fm = std::fabs(f);
            } else (s < m ? a : b) = s;
        }
        const vector3 p = line_.at(quad(m));
        const double size = of_.s.s.ops->rounding(
            of_.s.s.self, {oracle::to_double(p.x), oracle::to_double(p.y), oracle::to_double(p.z)});
        if (!(fm > 64 * size))
            doubtful.push_back(
                {quad(line_.t0) + a - quad(1e-6) * (b - a), quad(line_.t0) + b + quad(1e-6) * (b - a)});
    }

    void add(quad s)
    {
        root r = about(s);
        if (of_.s.rim > 0) {
            const quad r2 = r.p.x * r.p.x + r.p.y * r.p.y,
                       rim2 = quad(of_.s.rim) * of_.s.rim * (1 + quad(0x1p-44));
            if (r2 > rim2 * (1 + quad(0x1p-48))) return;
            r.edge = r2 > rim2 * (1 - quad(0x1p-48));
        }
        for (const root &other : roots)
            if (oracle::magnitude(other.t - r.t) <=
                quad(0x1p-90) * (oracle::magnitude(s) + quad(of_.s.h) / oracle::norm(line_.d)))
                return;
        roots.push_back(r);
    }
};

// As oracle::counting: where the rule leaves a width neither answer is wrong.
inline counts counting(const root &m, double tmin, double tmax)
{
    const quad start = quad(0x1p-48) * m.spread / oracle::magnitude(m.slope);
    const quad slack = 8 * start + 64 * quad(oracle::ulp(oracle::to_double(m.t))),
               less = start * (1 - quad(0x1p-20));
    counts result = m.edge ? oracle::perhaps : oracle::yes;
    if (std::isfinite(tmin)) {
        const quad beyond = m.t - tmin;
        if (beyond <= 0) return oracle::no;
        if (!(start >= 0)) return oracle::perhaps;
        if (beyond <= less) return oracle::no;
        if (beyond <= start + slack) result = oracle::perhaps;
    }
    if (std::isfinite(tmax)) {
        const quad left = tmax - m.t;
        if (left < -slack) return oracle::no;
        if (left <= slack) result = oracle::perhaps;
    }
    return result;
}

// ---------------------------------------------------------------------- rays

enum ray_kind { ordinary, steep, far_off, grazing, wide, inside, on_surface, across, axial, ray_kinds };
static const char *const ray_names[] = {"ordinary",    "steep",      "far",    "grazing", "wide",
                                        "from inside", "from on it", "across", "axial"};

inline sgt_vec3 random_direction(generator &g)
{
    const double z = g.uniform(-1, 1), about = g.uniform(0, 6.283185307179586), r = std::sqrt(1 - z * z);
    return {r * std::cos(about), r * std::sin(about), z};
}

inline sgt_ray random_ray(generator &g, const subject &of, ray_kind kind)
{
    const specimen &s = of.s;
    const double pi = 3.141592653589793;
    sgt_vec3 at = random_point(g, s, of.rough, kind == wide ? 2.5 : 0.95);
    if (s.sag) {
        const double z = -of.rough(at.x, at.y, 0.0);
        at.z = z == z ? z : 0;
    }
    sgt_vec3 d = random_direction(g);
    if (s.sag && kind != inside && kind != wide) {
        const double tilt = kind == steep ? g.uniform(60, 89.9) * pi / 180
                                          : g.uniform(0, kind == ordinary ? 30 : 80) * pi / 180,
                     about = g.uniform(0, 2 * pi);
        d = {std::sin(tilt) * std::cos(about), std::sin(tilt) * std::sin(about), g.sign() * std::cos(tilt)};
    }
    if (kind == across) d.z = 0;
    if (kind == axial) d = {0, 0, g.sign()};
    if (kind == grazing) { // a direction of the tangent plane, lifted
        typedef dual<double, 3> number;
        const number f = level(s.s, std::vector<number>(of.rough.p.begin(), of.rough.p.end()).data(),
                               number::variable(at.x, 0), number::variable(at.y, 1),
                               number::variable(at.z, 2));
        const double size = std::sqrt(f.v[0] * f.v[0] + f.v[1] * f.v[1] + f.v[2] * f.v[2]),
                     n[3] = {f.v[0] / size, f.v[1] / size, f.v[2] / size};
        const double along = d.x * n[0] + d.y * n[1] + d.z * n[2],
                     lift = g.chance(0.1) ? 0 : g.sign() * g.log_uniform(1e-9, 0.1);
        if (along == along)
            d = {d.x - (along - lift) * n[0], d.y - (along - lift) * n[1], d.z - (along - lift) * n[2]};
    }
    const double length = g.chance(0.5) ? 1 : g.log_uniform(1e-3, 1e3);
    d = {length * d.x, length * d.y, length * d.z};
    double away = s.h *
                  (kind == far_off      ? g.log_uniform(1e2, 1e10)
                   : kind == inside     ? g.uniform(0, 1)
                   : kind == on_surface ? 0
                                        : g.uniform(1.5, 10)) /
                  length;
    if (g.chance(0.1)) away = -away;
    sgt_ray ray = {{at.x - away * d.x, at.y - away * d.y, at.z - away * d.z}, d, 0, 0};
    const int ends = g.below(4);
    if (ends == 1) ray.tmin = -HUGE_VAL, ray.tmax = HUGE_VAL;
    if (ends == 2 && g.chance(0.5))
        ray.tmin = away + s.h / length * g.uniform(-1, 0.5),
        ray.tmax = ray.tmin + s.h / length * g.uniform(0.1, 4);
    if (ray.tmin == 0 && ray.tmax == 0) ray.tmax = HUGE_VAL;
    return ray;
}

} // namespace catalogue
#endif
