// SPDX-License-Identifier: MIT
// slow_trace.h - a ray through a lens in 113 bits, written from the books and not from the library.
//
// Each element is a matrix and an origin.  Its axes are orthogonal and of unit length to some 1e-16 only: so
// directions are made of unit length wherever they are turned, and lengths are those of the global frame.
// Conics are met by the quadratic formula, other surfaces by Newton on the definition of F
// (catalogue/formulas.h), from the vertex plane.  Bending takes the unit normal and the cosines of both
// angles (Glassner 1989, An Introduction to Ray Tracing, chapter 2).  Ideal lenses are as system.h defines
// them, by slopes.  A phase in waves is n2 d' = n1 d + G + c N, with c from |d'| = 1.  Numbers of the lens
// are quads, so that they may be changed by less than an ulp.
#ifndef SENSITIVITY_SLOW_TRACE_H
#define SENSITIVITY_SLOW_TRACE_H
#include "../catalogue/formulas.h"

#include <sagitta/system.h>

#include <array>

namespace slow {

using catalogue::dual;
using oracle::magnitude;
using oracle::quad;
using oracle::square_root;
using oracle::to_double;

struct vec { quad x, y, z; };
inline vec of(const sgt_vec3 &a) { return {a.x, a.y, a.z}; }
inline vec operator+(const vec &a, const vec &b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline vec operator-(const vec &a, const vec &b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline vec operator*(quad f, const vec &a) { return {f * a.x, f * a.y, f * a.z}; }
inline quad inner(const vec &a, const vec &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline quad length(const vec &a) { return square_root(inner(a, a)); }
inline vec unit(const vec &a) { return quad(1) / length(a) * a; }
inline vec outer(const vec &a, const vec &b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Turns a by the small angle |w| about w: a series to the eighth order.
inline vec turned(const vec &w, vec a)
{
    vec sum = a;
    for (int i = 1; i <= 8; i++) {
        a = quad(1) / quad(i) * outer(w, a);
        sum = sum + a;
    }
    return sum;
}

struct element {
    sgt_surface surface;
    std::vector<quad> a;  // its parameters
    vec origin, axis[3], turn;
    quad index;           // 0: as in front; -1: a mirror
    const sgt_phase *phase;
    vec local(const vec &p) const
    {
        const vec q = turned(quad(-1) * turn, {inner(p, axis[0]), inner(p, axis[1]), inner(p, axis[2])});
        return q;
    }
    vec global(vec q) const
    {
        q = turned(turn, q);
        return q.x * axis[0] + (q.y * axis[1] + q.z * axis[2]);
    }
};

inline element element_of(const sgt_element &e)
{
    element r;
    r.surface = e.surface;
    for (double x : catalogue::parameters_of(e.surface)) r.a.push_back(x);
    r.origin = of(e.pose.origin);
    r.axis[0] = of(e.pose.ex), r.axis[1] = of(e.pose.ey), r.axis[2] = of(e.pose.ez);
    if (inner(r.axis[0], r.axis[0]) == 0)
        r.axis[0] = {1, 0, 0}, r.axis[1] = {0, 1, 0}, r.axis[2] = {0, 0, 1};
    r.turn = {0, 0, 0};
    r.index = e.index, r.phase = e.phase;
    return r;
}

// The end of a ray: in the frame of the last element, and how many it passed.  If it stops, `why` is 'm' (no
// root), 't' (total reflection) or 'e' (evanescent), p is the last point.
struct end {
    vec p, d;
    quad opl;
    std::size_t passed;
    char why;
};

// The root near the vertex plane, on the sheet of the conic; false: none.
inline bool meet_conic(const std::vector<quad> &a, const vec &o, const vec &d, quad *t)
{
    const quad c = a[0], k1 = 1 + a[1], A = c * (d.x * d.x + d.y * d.y + k1 * d.z * d.z),
               B = d.z - c * (o.x * d.x + o.y * d.y + k1 * o.z * d.z),
               C = c * (o.x * o.x + o.y * o.y + k1 * o.z * o.z) - 2 * o.z, D = B * B - A * C;
    if (!(D >= 0)) return false;
    const quad s = square_root(D), b = B < 0 ? B - s : B + s, vertex = -o.z / d.z;
    const quad roots[2] = {C / b, b / A};
    bool any = false;
    for (quad r : roots) {
        if (!(1 - k1 * c * (o.z + r * d.z) >= 0)) continue;
        if (!any || magnitude(r - vertex) < magnitude(*t - vertex)) *t = r;
        any = true;
    }
    return any;
}

inline dual<quad, 3> level_at(const element &e, const vec &p)
{
    typedef dual<quad, 3> D3;
    const std::vector<D3> a(e.a.begin(), e.a.end());
    return catalogue::level(e.surface, a.data(), D3::variable(p.x, 0), D3::variable(p.y, 1),
                            D3::variable(p.z, 2));
}

inline bool meet_other(const element &e, const vec &o, const vec &d, quad *t)
{
    *t = -o.z / d.z;
    quad last = 0;
    for (int i = 0; i < 60; i++) {
        const dual<quad, 3> v = level_at(e, o + *t * d);
        const quad step = v.a / (v.v[0] * d.x + v.v[1] * d.y + v.v[2] * d.z);
        if (!(magnitude(step) < 1e30)) return false;
        *t -= step;
        const quad size = magnitude(step);
        if (size <= 1e-31 * (1 + magnitude(*t)) || (i > 8 && size >= last && last < 1e-28)) return true;
        last = size;
    }
    return false;
}

inline vec normal_at(const element &e, const vec &p)
{
    vec n;
    if (e.surface.ops == &sgt_conic_ops) {
        const quad c = e.a[0], k1 = 1 + e.a[1];
        n = {-c * p.x, -c * p.y, 1 - k1 * c * p.z};
    } else {
        const dual<quad, 3> v = level_at(e, p);
        n = {v.v[0], v.v[1], v.v[2]};
    }
    return quad(1) / length(n) * n;
}

// A number of a phase that is moved by a little: per_wave is number -1, those of `waves` are from 0 on; of an
// ideal lens fx, fy and the object's distance are 0, 1, 2, and fx is that of both axes if there is one.
struct nudge {
    const sgt_phase *phase;
    int number;
    quad by;
};
inline nudge moved = {nullptr, 0, 0};
inline quad moved_by(const sgt_phase &a, int number)
{
    return &a == moved.phase && number == moved.number ? moved.by : quad(0);
}

// Behind an ideal lens at p; *more is what it adds to the path.
inline vec focused(const sgt_phase &a, bool mirror, quad n1, quad n2, const vec &p, const vec &d, quad *more)
{
    const quad to = d.z < 0 ? -1 : 1, fx = a.focal_length + moved_by(a, 0),
               fy = a.focal_length_y == 0 ? fx : a.focal_length_y + moved_by(a, 1), u = d.x / (to * d.z),
               v = d.y / (to * d.z);
    const bool afar = a.object_distance == 0 || std::isinf(a.object_distance);
    const quad object = a.object_distance + moved_by(a, 2), u0 = afar ? u : u - p.x / object,
               v0 = afar ? v : v - p.y / object;
    const quad x = (n1 * u - p.x / fx) / n2, y = (n1 * v - p.y / fy) / n2, x0 = n1 * u0 / n2,
               y0 = n1 * v0 / n2;
    const quad in = square_root(1 + u * u + v * v) + square_root(1 + u0 * u0 + v0 * v0),
               out = square_root(1 + x * x + y * y) + square_root(1 + x0 * x0 + y0 * y0);
    *more = n2 * (p.x * (x + x0) + p.y * (y + y0)) / out - n1 * (p.x * (u + u0) + p.y * (v + v0)) / in;
    const vec behind = {x, y, mirror ? -to : to};
    return quad(1) / length(behind) * behind;
}

// Behind a phase in waves, with the normal n; *more is what it adds to the path.  false: evanescent.
inline bool kicked(const sgt_phase &a, bool mirror, quad n1, quad n2, vec p, vec n, vec *d, quad *more)
{
    typedef dual<quad, 3> D3;
    const bool facets = a.kind == SGT_FACETS, sag = facets || a.kind == SGT_PHASE_SAG;
    std::vector<D3> numbers;
    for (double x : catalogue::parameters_of(a.waves)) {
        const int i = int(numbers.size());
        numbers.push_back(quad(x) + moved_by(a, i));
    }
    if (sag) p.z = 0;
    const D3 f = catalogue::level(a.waves, numbers.data(), D3::variable(p.x, 0), D3::variable(p.y, 1),
                                  D3::variable(p.z, 2));
    const quad per_wave = a.per_wave + moved_by(a, -1), scale = sag ? -per_wave : per_wave;
    if (facets) { // refraction, or reflection, by the normal of the sag
        const vec m =
            quad(1) / square_root(f.v[0] * f.v[0] + f.v[1] * f.v[1] + 1) * vec{f.v[0], f.v[1], quad(1)};
        const quad cosine = inner(*d, m), r = n1 / n2, square = 1 - r * r * (1 - cosine * cosine);
        if (!(cosine * inner(*d, n) > 0) || square < 0) return false;
        const quad side = inner(*d, n);
        if (mirror)
            *d = *d - 2 * cosine * m;
        else
            *d = r * *d + ((cosine < 0 ? -square_root(square) : square_root(square)) - r * cosine) * m;
        *more = 0;
        return (inner(*d, n) * side > 0) != mirror;
    }
    const vec u = n1 * *d + scale * vec{f.v[0], f.v[1], sag ? quad(0) : f.v[2]};
    const quad b = inner(u, n), square = b * b + n2 * n2 - inner(u, u);
    if (!(square > 0)) return false;
    const bool up = (inner(*d, n) > 0) != mirror;
    *d = 1 / n2 * (u + ((up ? square_root(square) : -square_root(square)) - b) * n);
    *more = scale * f.a;
    return true;
}

// count: so many elements; the last is met and need not be passed, if `to_point` is set.
inline end trace(const std::vector<element> &e, std::size_t count, quad index, vec o, vec d,
                 bool to_point = false)
{
    end r = {o, quad(1) / length(d) * d, 0, 0, 0};
    vec at = o, way = r.d;
    for (std::size_t i = 0; i < count; i++) {
        const element &s = e[i];
        const vec p = s.local(at - s.origin);
        vec l = s.local(way);
        quad t = 0;
        const bool conic = s.surface.ops == &sgt_conic_ops;
        if (!(conic ? meet_conic(s.a, p, l, &t) : meet_other(s, p, l, &t))) return r.why = 'm', r;
        r.p = p + t * l, r.opl += index * t;
        l = unit(l);
        if (to_point && i + 1 == count) return r.d = l, r;
        if (s.phase && s.phase->kind != SGT_IDEAL_LENS) {
            const quad behind = s.index == 0 || s.index == -1 ? index : s.index;
            quad more;
            r.d = l;
            if (!kicked(*s.phase, s.index == -1, index, behind, r.p, normal_at(s, r.p), &r.d, &more))
                return r.why = 'e', r;
            r.opl += more, index = behind, r.passed = i + 1;
            at = s.origin + s.global(r.p), way = unit(s.global(r.d));
            continue;
        }
        if (s.phase) {
            const quad behind = s.index == 0 || s.index == -1 ? index : s.index;
            quad more;
            r.d = focused(*s.phase, s.index == -1, index, behind, r.p, l, &more);
            r.opl += more, index = behind, r.passed = i + 1;
            at = s.origin + s.global(r.p), way = unit(s.global(r.d));
            continue;
        }
        const vec n = normal_at(s, r.p);
        const quad cosine = inner(l, n);
        if (s.index == -1) {
            r.d = l - 2 * cosine * n;
        } else {
            const quad behind = s.index == 0 ? index : s.index, mu = index / behind,
                       square = 1 - mu * mu * (1 - cosine * cosine);
            if (square < 0) return r.why = 't', r;
            const quad other = cosine < 0 ? -square_root(square) : square_root(square);
            r.d = mu * l + (other - mu * cosine) * n;
            index = behind;
        }
        r.passed = i + 1;
        at = s.origin + s.global(r.p), way = unit(s.global(r.d));
    }
    return r;
}

} // namespace slow
#endif
