// SPDX-License-Identifier: MIT
// One row for each extreme: what a random test never draws.  The right answers come
// from quadruple precision, or, where even that cannot tell (a ray exactly tangent),
// from the construction of the row.
#include "cases.h"
#include "quad.h"

#include <sagitta/sagitta.h>

#include <string>

using namespace oracle;

namespace {

int failures, rows, undecided;

sgt_even_asphere conic(double c, double k = 0, double semi_diameter = 0)
{
    return sgt_even_asphere{c, k, semi_diameter, {}};
}
sgt_even_asphere asphere(double c, double k, std::initializer_list<double> a, double semi_diameter = 0)
{
    sgt_even_asphere s = {c, k, semi_diameter, {}};
    std::copy(a.begin(), a.end(), s.a);
    return s;
}

const double inf = HUGE_VAL;

sgt_ray half(sgt_vec3 o, sgt_vec3 d) { return {o, d, 0, 0}; }
sgt_ray whole(sgt_vec3 o, sgt_vec3 d) { return {o, d, -inf, inf}; }
sgt_ray from(double tmin, sgt_vec3 o, sgt_vec3 d) { return {o, d, tmin, inf}; }

test_case make(const sgt_even_asphere &s, const sgt_ray &r)
{
    test_case t = {};
    t.surface = s;
    t.ray = r;
    t.asphere = !surface(s).bare();
    t.h = 1;
    return t;
}

sgt_hit ask(const test_case &t, sgt_pick pick = SGT_FIRST)
{
    sgt_conic c;
    const sgt_surface s = as_surface(t, &c);
    sgt_options options = {};
    options.pick = pick;
    return sgt_intersect(s, t.ray, &options);
}

void fail(const char *name, const char *why, const test_case &t, const sgt_hit &h)
{
    failures++;
    std::printf("FAIL %s: %s\n    --replay \"", name, why);
    print_case(stdout, t);
    std::printf("\"\n    %s t %.17g (%a) t_err %.3g lo %.17g hi %.17g p %g %g %g p_err %.3g evals %d\n",
                sgt_status_text(h.status), h.t, h.t, h.t_err, h.lo, h.hi, h.p.x, h.p.y, h.p.z, h.p_err,
                h.evals);
    for (const meeting &m : all_roots(surface(t.surface), t.ray).roots)
        std::printf("    root %s%s\n", text(m.t()).c_str(), m.edge ? " (edge)" : "");
}

// What is wrong with this answer, or NULL.
const char *verdict(const test_case &t, const sgt_hit &h, bool first)
{
    const answer a = all_roots(surface(t.surface), t.ray);
    double tmin, tmax;
    ends_of(t.ray, &tmin, &tmax);
    bool some = false;
    for (const meeting &m : a.roots) some = some || counting(m, tmin, tmax) == yes;
    if (a.everywhere) return "the row is not for this oracle";
    if (h.status < 0) return nullptr;
    if (h.status == SGT_MISS) return some ? "a miss where a root counts" : nullptr;
    if (in_doubt(a, h)) return nullptr;
    // (below the smallest double t_err cannot say anything)
    const quad least = quad(0x1p-1074);
    const meeting *near = meant(a, h);
    if (!near || !(magnitude(near->minus(h.t)) <= quad(h.t_err) + near->blur + least))
        return "no root within t_err";
    if (counting(*near, tmin, tmax) == no) return "a root that does not count";
    if (first && passed_over(a, *near, h, tmin, tmax)) return "not the first";
    if (magnitude(near->minus(h.t) - h.t_lo) > quad(h.t_err) + near->blur + least)
        return "t + t_lo is farther off than t_err";
    if (!std::isfinite(h.t_err)) return "t_err is not finite";
    const vector3 p = {h.p.x, h.p.y, h.p.z}, off = {p.x - near->p.x, p.y - near->p.y, p.z - near->p.z};
    if (!(norm(off) <= quad(h.p_err) + norm(near->p) * quad(0x1p-100) +
                           near->blur * norm({t.ray.d.x, t.ray.d.y, t.ray.d.z}) + least))
        return "p is farther off than p_err";
    return nullptr;
}

enum demand { decided, any };

void row(const char *name, const sgt_even_asphere &s, const sgt_ray &r, demand d = decided)
{
    const test_case t = make(s, r);
    for (sgt_pick pick : {SGT_FIRST, SGT_NEAR_SEED}) {
        rows++;
        const sgt_hit h = ask(t, pick);
        if (const char *why = verdict(t, h, pick == SGT_FIRST)) fail(name, why, t, h);
        else if (h.status == SGT_INVALID) fail(name, "valid input called invalid", t, h);
        else if (h.status < 0 && d == decided) fail(name, "undecided", t, h);
        undecided += h.status < 0;
    }
}

// The root must be there, by construction: a row that turned into a miss by a slip
// of the pen tests nothing.
void met(const char *name, const sgt_even_asphere &s, const sgt_ray &r, demand d = decided)
{
    const test_case t = make(s, r);
    double tmin, tmax;
    ends_of(r, &tmin, &tmax);
    bool some = false;
    for (const meeting &m : all_roots(surface(s), r).roots) some = some || counting(m, tmin, tmax) == yes;
    if (!some) fail(name, "the row has no root", t, ask(t));
    row(name, s, r, d);
}

void tangent(const char *name, const sgt_even_asphere &s, const sgt_ray &r, double root, demand d = decided)
{
    const test_case t = make(s, r);
    rows++;
    const sgt_hit h = ask(t);
    if (h.status < 0 && h.status != SGT_INVALID && d == any) undecided++;
    else if (h.status <= 0) fail(name, "an exact tangent is not met", t, h);
    else if (!(std::fabs(h.t - root) <= h.t_err)) fail(name, "no root within t_err", t, h);
    else if (!(h.t_err <= 1e-6 * std::fabs(root))) fail(name, "t_err is more than rounding asks", t, h);
}

void curvatures()
{
    const double k[] = {0, -1, -2, 3};
    for (double e : k) {
        for (double c : {0.0, -0.0, 1e-300, -1e-300, 1e-310, 5e-324}) {
            met("nearly flat", conic(c, e), half({1, 2, -5}, {0.1, 0.2, 1}));
            met("nearly flat, grazing", conic(c, e), half({1, 2, -5}, {1, 0, 1e-8}));
            row("nearly flat, level", conic(c, e), half({1, 2, -5}, {1, 0, 0}), c == 0 ? decided : any);
        }
        for (double c : {1e300, -1e300}) {
            met("a point of a surface, to its vertex", conic(c, e), half({0, 0, -1}, {0, 0, 1}));
            met("a point of a surface, in its own size", conic(c, e),
                half({0, 0.25e-300, -5e-300}, {0, 0, 1e-300}), any);
            met("a point of a surface, in its own size, oblique", conic(c, e),
                half({0, -2e-300, c > 0 ? -2e-300 : 2e-300}, {0, 0.6e-300, c > 0 ? 0.8e-300 : -0.8e-300}),
                any);
            row("a point of a surface, far past it", conic(c, e), half({0, 1, -5}, {0, 0, 1}), any);
        }
        met("c = 1e150", conic(1e150, e), half({0, 0.25e-150, -5e-150}, {0, 0, 1}), any);
        met("c = 1e-150", conic(1e-150, e), half({0, 0.25e150, -5e150}, {0, 0, 1}), any);
    }
    row("flat, level", conic(0), half({1, 2, -5}, {1, 0, 0}));
    row("flat, going away", conic(0), half({1, 2, -5}, {1, 0, -1e-8}));
    met("an asphere on a nearly flat conic", asphere(1e-300, 0, {0, 1e-3}, 5), half({1, 2, -5}, {0, 0.1, 1}));
    met("an asphere on a subnormal conic", asphere(5e-324, 0, {0, 1e-3}, 5), half({1, 2, -5}, {0, 0.1, 1}));
    met("subnormal terms", asphere(0.1, 0, {5e-324, 1e-310}, 5), half({1, 2, -5}, {0, 0.1, 1}));
}

void grazing()
{
    const double e = 1e-8;
    met("grazing a plane at 1e-8", conic(0), half({-3, 0, -1e-8}, {1, 0, e}));
    met("grazing a plane at 1e-8 from far", conic(0), half({-1e8, 0, -1}, {1, 0, e}));
    for (double k : {0.0, -1.0, -2.0, 0.5, -1 + 1e-12, -1e3, 1e3}) {
        const double c = 1, r = k > 1 ? 0.02 : 0.6, w = std::sqrt(1 - (1 + k) * c * c * r * r),
                     z = c * r * r / (1 + w), slope = c * r / w, m = std::sqrt(1 + slope * slope);
        for (double turn : {-e, e}) {
            const double l = (1 - turn * slope) / m,
                         n = (slope + turn) / m; // the tangent, turned by e about y
            row("grazing a conic at 1e-8 in the meridian", conic(c, k),
                whole({r - 3 * l, 0, z - 3 * n}, {l, 0, n}));
            // At the vertex the doubles are fine enough for the chord (2e-8 long, 5e-17 deep).
            met("grazing a conic at 1e-8 at its vertex", conic(c, k),
                whole({-3, 0, -3 * turn}, {1, 0, turn}));
            row("grazing a conic at 1e-8 at its vertex, from far", conic(-c, k),
                whole({-1e9, 0, -1e9 * turn}, {1, 0, turn}));
        }
        met("grazing a conic at 1e-8 across", conic(c, k),
            whole({r + 3e-8 * slope, -3, z - 3e-8}, {-e * slope, 1, e}));
    }
    for (double side : {1.0, -1.0}) {
        const double y = 0.9999999999999999;
        met("just inside the equator", conic(side), half({0, y, -5 * side}, {0, 0, side}));
        row("just outside the equator", conic(side), half({0, 1.0000000000000002, -5 * side}, {0, 0, side}));
        row("at the equator", conic(side), half({0, 1, -5 * side}, {0, 0, side}), any);
        met("into the equator from outside, level", conic(side), half({0, -5, side * y}, {0, 1, 0}));
    }
    met("grazing an asphere at 1e-8", asphere(0, 0, {0.5, -0.125}), half({1, -3, 0.375 - 3e-8}, {0, 1, e}),
        any);
}

void tangents()
{
    tangent("tangent at the vertex", conic(1), whole({0, -5, 0}, {0, 1, 0}), 5);
    tangent("tangent at the vertex, far", conic(1), whole({0, -1e9, 0}, {0, 1, 0}), 1e9);
    tangent("tangent to a paraboloid", conic(1, -1), whole({-3, 0, -3.5}, {1, 0, 1}), 4);
    tangent("tangent to a paraboloid, short direction", conic(1, -1),
            whole({-3, 0, -3.5}, {0x1p-300, 0, 0x1p-300}), 0x1p302);
    tangent("tangent to a hyperboloid", conic(1, -2), whole({0.75 - 10, 0, 0.25 - 6}, {5, 0, 3}), 2);
    tangent("tangent to a hyperboloid, skew", conic(1, -2), whole({0.75, -4, 0.25}, {0, 1, 0}), 4);
    tangent("tangent to an asphere at its vertex", asphere(1, -1, {0, 0.25}), whole({-4, 0, 0}, {1, 0, 0}), 4,
            any);
    tangent("tangent to an asphere, across", asphere(0, 0, {0.5, -0.125}, 1.5),
            whole({1, -4, 0.375}, {0, 1, 0}), 4, any);
    tangent("tangent to an asphere, first of two", asphere(0, 0, {0.5, -0.0625}, 3),
            whole({-5, 0, 1}, {1, 0, 0}), 3, any);
    for (double o : {0x1p-50, -0x1p-50, 0x1p-40, -0x1p-40}) {
        row("a few ulps beside a tangent, paraboloid", conic(1, -1), whole({-3, 0, -3.5 + o}, {1, 0, 1}));
        row("a few ulps beside a tangent, hyperboloid", conic(1, -2),
            whole({0.75 - 10, 0, 0.25 - 6 + o}, {5, 0, 3}));
    }
    for (double o : {1e-20, -1e-20, 1e-30, 5e-324})
        row("a hair beside the vertex", conic(1), whole({0, -5, o}, {0, 1, 0}), any);
    // With an end before it a tangent may count or not (the rule at tmin has 1/|grad F . d| in
    // it), but may not be somewhere else.
    const test_case t = make(conic(1, -1), half({-3, 0, -3.5}, {1, 0, 1}));
    const sgt_hit h = ask(t);
    rows++;
    if (h.status > 0 && !(std::fabs(h.t - 4) <= h.t_err))
        fail("tangent from tmin = 0", "no root within t_err", t, h);
    std::printf("note: a tangent at t = 4 from tmin = 0 is: %s\n", sgt_status_text(h.status));
}

void starts()
{
    const sgt_even_asphere surfaces[] = {conic(0),
                                    conic(1),
                                    conic(-0.2),
                                    conic(0.3, -1),
                                    conic(0.3, -2),
                                    conic(1, 3),
                                    asphere(0.3, -1, {0, 0.01}, 2),
                                    asphere(0, 0, {-0.2, 0.02}, 4)};
    for (const sgt_even_asphere &s : surfaces)
        for (double x : {0.0, 0.1, 0.3}) {
            const double y = 0.2, z = rough_sag(s, x * x + y * y);
            for (sgt_vec3 d : {sgt_vec3{0, 0, 1}, sgt_vec3{0.1, -0.3, -1}, sgt_vec3{0.8, 0.1, 0.3},
                               sgt_vec3{-1, 0.2, 0.001}}) {
                test_case t = make(s, half({x, y, z}, d));
                sgt_hit h = ask(t);
                rows++;
                if (h.status > 0 && std::fabs(h.t) < 1e-12)
                    fail("start on the surface, tmin = 0", "the root at the start is not skipped", t, h);
                row("start on the surface, tmin = 0", s, t.ray);
                met("start on the surface, tmin = -1e-3", s, from(-1e-3, {x, y, z}, d));
                met("start on the surface, tmin = -infinity", s, whole({x, y, z}, d));
                t.ray = from(-1e-3, {x, y, z}, d);
                h = ask(t);
                rows++;
                if (h.status <= 0 || !(h.t < 1e-12))
                    fail("start on the surface, tmin = -1e-3", "the root at the start is not found", t, h);
            }
        }
    // Inside a sphere's bowl and across: the next root, not the start.
    met("across the bowl", conic(1), half({-0.6, 0, 0.2}, {1, 0, 0.1}));
    met("across the bowl, scaled down", conic(1e12), half({-0.6e-12, 0, 0.2e-12}, {1, 0, 0.1}));
}

void directions()
{
    for (double length : {1e-200, 1e200, 1.0, 1e-290, 1e290}) {
        const double l = length;
        met("length of the direction: sphere", conic(0.1), half({1, 2, -5}, {0.1 * l, 0.2 * l, l}));
        met("length of the direction: plane", conic(0), half({1, 2, -5}, {0.1 * l, 0.2 * l, l}));
        met("length of the direction: hyperboloid", conic(-0.1, -2), half({1, 2, -5}, {0.1 * l, 0.2 * l, l}));
        met("length of the direction: asphere", asphere(0.1, -0.5, {1e-3, -1e-5}, 5),
            half({1, 2, -5}, {0.1 * l, 0.2 * l, l}));
        row("length of the direction: a miss", conic(0.1), half({11, 2, -5}, {0, 0, l}));
    }
    for (double k : {0.0, -1.0, -2.0, 3.0, -0.5}) {
        met("level", conic(1, k), half({-3, 0.1, 0.2}, {1, 0, 0}));
        met("level, turned", conic(-1, k), half({-3, 0.1, -0.2}, {0.6, -0.02, 0}));
        row("level, beside", conic(1, k), half({-3, 0.1, -0.2}, {1, 0, 0}));
        row("level, far beside", conic(1, k), half({-3, 50, 0.2}, {1, 0, 0}));
        met("along the axis", conic(1, k), half({0, 0, -5}, {0, 0, 1}));
        met("along the axis, from 1e12", conic(1, k), half({0, 0, -1e12}, {0, 0, 1}));
        met("along the axis, upwards", conic(1, k), half({0, 0, 5}, {0, 0, -1}));
        met("beside the axis", conic(1, k), half({0.3, 0, -5}, {0, 0, 1}));
    }
    met("level, on an asphere", asphere(0, 0, {-0.2, 0.02}), half({0, -6, -0.3}, {0, 1, 0}));
    met("along the axis of an asphere", asphere(0.3, -1, {0, 0.01}), half({0, 0, -5}, {0, 0, 1}));
    met("beside the axis of an asphere", asphere(0.3, -1, {0, 0.01}), half({0.5, 0.5, -5}, {0, 0, 1}));
    met("one subnormal component", conic(1), half({0.3, 0, -5}, {1e-310, 0, 1}));
    met("one subnormal component, z", conic(1), half({-3, 0, 0.2}, {1, 0, 5e-324}));
    met("one subnormal component, asphere", asphere(0.3, -1, {0, 0.01}), half({0.5, 0, -5}, {1e-310, 0, 1}));
    for (double tiny : {1e-9, 1e-12, 1e-16, 1e-30, 1e-200, -1e-9}) {
        met("near-axial on a paraboloid", conic(-0.01, -1), half({10, 0, -50}, {tiny, 0, 1}));
        met("near-axial on a paraboloid, from 1e9", conic(-0.01, -1), half({10, 0, -1e9}, {tiny, 0, 1}));
        met("near-axial on nearly a paraboloid", conic(-0.01, -1 + 1e-12), half({10, 0, -50}, {tiny, 0, 1}));
        met("near-axial on nearly a paraboloid", conic(-0.01, -1 - 1e-12), half({10, 0, -50}, {tiny, 0, 1}));
    }
}

void origins()
{
    for (double tiny : {1e-310, 5e-324, -1e-310}) {
        met("a subnormal origin: x", conic(1), half({tiny, 0.2, -5}, {0, 0, 1}));
        met("a subnormal origin: z", conic(1), from(-1e-3, {0.1, 0.2, tiny}, {0, 0, 1}));
        met("a subnormal origin, all", conic(1), whole({tiny, tiny, tiny}, {0, 0.3, 1}), any);
        met("a subnormal origin on an asphere", asphere(0.3, -1, {0, 0.01}),
            half({tiny, tiny, -1}, {0, 0, 1}));
        met("a subnormal origin on a plane", conic(0), whole({tiny, 0, tiny}, {0.5, 0, 1}), any);
    }
    for (double far : {1e12, 1e15, 1e30, 1e100, 1e200, 1e300}) {
        met("far along the axis", conic(1), half({0, 0, -far}, {0, 0, 1}), far > 1e12 ? any : decided);
        met("far, parallel to the axis", conic(1), half({0.3, 0.2, -far}, {0, 0, 1}),
            far > 1e12 ? any : decided);
        row("far and oblique", conic(1, -0.5), half({-far, 0, -far}, {1, 0, 1}), far > 1e12 ? any : decided);
        row("far and oblique, asphere", asphere(0.3, -1, {0, 0.01}, 2), half({-far, 0, -far}, {1, 0, 1}),
            far > 1e12 ? any : decided);
        row("far plane", conic(0), half({-far, 3, -far}, {1, 0, 1}), far > 1e12 ? any : decided);
    }
}

void deep_aspheres()
{
    const sgt_even_asphere w = asphere(0, 0, {-1.5, 0.4});
    met("a deep W, first of four", w, half({0, -3, -1.2}, {0, 0.97, 0.24310491562286435}));
    met("a deep W, the second", w, from(1.5, {0, -3, -1.2}, {0, 0.97, 0.24310491562286435}));
    met("a deep W, the third", w, from(2.5, {0, -3, -1.2}, {0, 0.97, 0.24310491562286435}));
    met("a deep W, the last", w, from(4, {0, -3, -1.2}, {0, 0.97, 0.24310491562286435}));
    row("a deep W, past them all", w, from(6, {0, -3, -1.2}, {0, 0.97, 0.24310491562286435}), any);
    const sgt_even_asphere phone = asphere(1 / -4.2, -6.5,
                                      {0, -0.1206, 0.0653, -0.0352, 0.0134, -0.0029, 0.00032, -1.4e-05}, 2.8);
    for (double y : {-2.6, -1.9, -0.5, 0.0, 1.2, 2.7}) {
        row("a phone lens", phone, half({0.1, y, -3}, {0, 0.25, 0.9682458365518543}), any);
        row("a phone lens, level", phone, half({-4, y, -0.3}, {1, 0.01, 0.01}), any);
    }
    const sgt_even_asphere steep = asphere(0, 0, {0, 0, 0, 0, 0, 0, 0, 1e3}, 1);
    met("r^16 alone, steep", steep, half({0.95, 0, 2000}, {0, 0, -1}));
    met("r^16 alone, the flat floor", steep, half({-0.1, 0.05, 5}, {0.01, 0, -1}));
    met("r^16 alone, level", steep, half({-3, 0, 100}, {1, 0, 0}));
    met("a bowl of a sphere and more", asphere(1, 0, {0, 0.5, -2, 3}), half({0.7, 0.1, -3}, {0.05, 0, 1}),
        any);
    met("an asphere just inside its equator", asphere(1, 0, {0, 0.1}), half({0.999999, 0, -3}, {0, 0, 1}));
    row("an asphere just outside its equator", asphere(1, 0, {0, 0.1}), half({1.000001, 0, -3}, {0, 0, 1}),
        any);
    met("terms that cancel the conic", asphere(1, -1, {-0.5, 1e-9}, 3), half({1, 1, -3}, {0, 0, 1}));
    met("terms that cancel the conic, whole", asphere(1, -1, {-0.5}), half({1, 1, -3}, {0.1, 0, 1}), any);
    met("with every term zero it is the conic", asphere(1, -1, {}), half({1, 1, -3}, {0.1, 0, 1}));
}

void soft_rim()
{
    met("a marginal ray", conic(0.1, 0, 0.5), half({0.5000000000000004, 0, -5}, {0, 0, 1}));
    row("a ray outside the rim", conic(0.1, 0, 0.5), half({0.50000000000001, 0, -5}, {0, 0, 1}));
    met("a marginal ray on an asphere", asphere(0.1, 0, {0, 0.1}, 0.5),
        half({0.5000000000000004, 0, -5}, {0, 0, 1}));
    row("a ray outside an asphere's rim", asphere(0.1, 0, {0, 0.1}, 0.5),
        half({0.50000000000001, 0, -5}, {0, 0, 1}), any);
    met("a marginal ray on a plane", conic(0, 0, 0.5), half({0, 0.5000000000000004, -5}, {0, 0, 1}));
    row("a ray outside a plane's rim", conic(0, 0, 0.5), half({0.50000000000001, 0, -5}, {0, 0, 1}));
}

// Rows that long random runs have drawn, a few in a million: an asphere met within 1e-14 of
// the rim of its conic's domain (|grad F| of 1e6 and more), where the doubles of t, and the
// double nearest to the rim, lie farther apart than what is asked for; and on the axis, where
// p.z must come out as 0, or far out on a steep conic, where z must fit the rounded x and y.
void found_by_chance()
{
    const char *const rims[] = {
        "-0x1.9fb64d0a636d1p-6 0x1.832081c147cfp-2 0x0p+0 0x0p+0 -0x1.7246ef430a792p-22 "
        "-0x1.089de185699fdp-32 0x1.31a5956c8fb8fp-40 0x0p+0 -0x1.f1c408c170b0dp-61 0x0p+0 0x0p+0 "
        "-0x1.0c23297df992ep+26 -0x1.99dcaed677bcap+25 -0x1.e7ac7b4ce755bp+25 0x1.d1de641f2dcebp+2 "
        "0x1.640d59e832d05p+2 0x1.a7a5f034b04ccp+2 0x0p+0 0x0p+0",
        "0x1.479d6d76ac7fbp-8 0x0p+0 0x1.901454e924b97p+7 -0x1.fc31927c42e05p-12 0x1.99fdcab6ba6c1p-27 "
        "0x0p+0 -0x1.5a3ec81427e7cp-58 -0x1.ed40caa2f437bp-79 -0x1.42158c9ba94bp-88 0x1.cb53993003ca2p-106 "
        "0x0p+0 -0x1.9e59c119e7798p+25 -0x1.b82eb30bd436cp+23 0x1.746f477cace88p+25 0x1.2d6b8a1c97957p-5 "
        "0x1.4035a26251c01p-7 -0x1.0eed9577062fp-5 0x0p+0 0x0p+0",
        "0x1.3099fa2779baep+5 0x1.eb089b692e276p-9 0x1.ad80b4518628ap-6 -0x1.52eeb7650a50ap+1 "
        "-0x1.12fa552bfc85bp+12 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 -0x1.4c4e3da742998p+32 "
        "0x1.29241d92fec3p+30 0x1.78c97b29de5dcp+32 0x1.4f050c1c6ec97p-1 -0x1.2b9165cbd16c2p-3 "
        "-0x1.7bdd4ad00618cp-1 0x1.fbda263962e0bp+32 0x1.fbda26398cfcp+32",
        "-0x1.17eeac3641726p-15 0x1.b79ff3b7fdb6p+1 0x1.bcb1a4499980bp+13 0x1.282a0c87f0282p-18 0x0p+0 "
        "0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x1.195a715e7808dp+48 -0x1.4716d48c2d547p+48 "
        "0x1.6d91757e37459p+48 0x1.fd792decd034dp-2 -0x1.282556c9a842dp-1 0x1.4afc13d6a384p-1 "
        "-0x1.1abfa52ee4581p+49 -0x1.1abfa52eb4e73p+49",
        "0x1.d014977df4154p-16 -0x1.5439bdaa86acap-2 0x0p+0 -0x1.8811c6bfa4a26p-21 -0x1.9a6dc6410fdbfp-52 "
        "-0x1.babb8045b4f9bp-82 -0x1.659aacd0f4336p-114 -0x1.9ff69e503eaf9p-148 0x0p+0 "
        "-0x1.072fdcb1c089dp-213 -0x1.1fa8248e8057bp-241 -0x1.55f617e317d07p+51 -0x1.5f917f931c734p+52 "
        "0x1.5cedbe46821edp+52 0x1.4e1fc49769c4ap-2 0x1.5782ceac5ded9p-1 -0x1.54ee8a1ae1816p-1 0x0p+0 0x0p+0",
        "0x1.202d874c1da74p-17 0x1.8343fff0df373p-7 0x1.c42a88d4c6368p+16 0x1.cd2ecb2ba0659p-22 "
        "-0x1.98aadf7243fb3p-55 -0x1.f5790faa366cp-92 0x1.3da1d0e6bc41fp-123 0x0p+0 0x1.965ffdc187251p-190 "
        "0x0p+0 0x0p+0 0x1.003d75c5cfe6p+14 -0x1.bf9c8d59a96c8p+16 0x1.dac80a46fdf63p+16 "
        "0x1.f190cf5f5c0eap+1 0x1.7c676c13fc2a7p+1 -0x1.931d490cf84d1p+2 0x0p+0 0x0p+0",
        "-0x1.28d2d9d5c134bp-3 -0x1.6fe026be14728p-1 0x1.a025d9d11c365p+3 0x1.748678e22f84cp-8 "
        "0x1.076b3b386bc22p-17 0x0p+0 0x1.889b4bee7ed13p-31 -0x1.d95330392494ep-40 0x1.fc993e504fbe2p-46 "
        "0x0p+0 0x0p+0 -0x1.ec7b0ad2f4467p+9 -0x1.2ddfdeeea12f2p+10 -0x1.4c54331648c83p+11 "
        "0x1.d6c8bc520a395p+1 0x1.247bb5d724428p+2 0x1.3f3c74d62c02ap+3 0x0p+0 0x0p+0",
        "0x1.044571c043f2ep-5 -0x1.482d9bff7d838p-2 0x1.3175d0c07237cp+5 -0x1.b15e72460f39p-12 "
        "-0x1.aedf99d81f794p-20 -0x1.0eb05b5cc3898p-31 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 "
        "0x1.df69243805bb5p+3 0x1.18f69e6176328p+5 0x1.463c1f11c9f02p+5 0x1.a07aba8ab2077p-3 "
        "0x1.b280e53e1347ap-2 0x1.c3c78e9168fe1p-1 0x0p+0 0x0p+0",
        "-0x1.a96c5d3415a9cp-16 0x1.0f407ac06ab24p+0 0x1.ad5e2e7caea5p+14 0x1.ddb2c11285fcp-19 "
        "0x1.bd7eabf6032fbp-49 -0x1.8bd814bec04a2p-80 -0x1.702ac25247205p-110 0x1.949bec6b9fe94p-137 "
        "0x1.3c460b3eaa857p-166 0x0p+0 0x0p+0 -0x1.3ab81c9bbcf9fp+14 0x1.2414c3e37899ap+14 "
        "-0x1.55a24a8791d68p+13 0x1.3e65feb04716p+0 0x1.d443e87ea18efp-3 -0x1.13808e15d37c8p-1 0x0p+0 0x0p+0",
        "0x1.dd4ce59595277p+5 0x1.427b1fb27e028p+0 0x1.6d5cb81307211p-7 -0x1.19b23fd47e753p+3 0x0p+0 "
        "0x1.f8c04c1ecb671p+28 0x1.413e090c315bdp+40 0x1.09d55f88b735fp+54 -0x1.098df82ae1154p+65 "
        "-0x1.b3af90beba005p+76 -0x1.17ce48ae9fb73p+93 -0x1.9886c2223b247p-2 -0x1.7260934c1faabp-1 "
        "0x1.d434ef9d597d4p-1 0x1.34a53e9241678p-5 0x1.12ecc550b6bc4p-4 -0x1.5e1b662f1b5f9p-4 0x0p+0 0x0p+0"};
    const char *const residues[] = {
        "-0x1.0cb3745422ffcp-19 -0x1.752cf419aa52bp-4 0x1.ffa9d488551e1p+18 -0x1.0b6e44c3ab912p-23 "
        "-0x1.46c273b0c7dc7p-63 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 -0x0p+0 0x0p+0 "
        "-0x1.d4558ed51efa8p+25 0x0p+0 -0x0p+0 0x1.3f8be6a31863dp+6 0x0p+0 0x0p+0",
        "-0x1.d62227772f7e8p-6 0x1.fdbcffbfb8bap+8 0x1.8ac40f0c03ce4p+0 -0x1.a91e92bf9144fp-6 "
        "-0x1.56036261b3ff3p-6 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 -0x0p+0 "
        "0x1.0ee7d8f4c8337p-11 -0x0p+0 0x0p+0 -0x1.bcc4b64eae34fp-9 0x0p+0 0x0p+0",
        "-0x1.bc4cd315567e6p-10 0x1.91105b9a8b28bp+1 0x0p+0 0x1.c090cbc91bf73p-10 0x0p+0 0x0p+0 0x0p+0 "
        "0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 -0x0p+0 -0x1.31bbb579bb97ep+35 -0x0p+0 0x0p+0 "
        "0x1.51bf3d9cbe5f9p+9 -inf inf",
        "-0x1.cebdc77cf5dd7p-4 0x1.250dbdc4e03aap+2 0x0p+0 0x0p+0 -0x1.563dbccbfbfa4p-2 0x0p+0 0x0p+0 0x0p+0 "
        "0x0p+0 0x0p+0 0x0p+0 -0x0p+0 0x0p+0 0x1.17c4a5fda16d8p-9 0x0p+0 0x0p+0 -0x1.663a39658b6d8p-1 0x0p+0 "
        "0x0p+0",
        "0x1.48400e1bc0306p-7 0x1.c2f459d403744p+0 0x0p+0 -0x1.1c56dd5f29915p-9 -0x1.4ea8924be5bdap-22 "
        "0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 -0x0p+0 0x1.434e5a13294c4p+40 0x0p+0 0x0p+0 "
        "-0x1.66aeec4e0c055p+7 -inf inf",
        "-0x1.fad088dbf0472p-19 -0x1.13faea269ed7p-3 0x0p+0 0x0p+0 0x0p+0 -0x1.fe4229ab39df7p-95 0x0p+0 "
        "0x0p+0 0x0p+0 0x0p+0 0x0p+0 -0x0p+0 0x0p+0 0x1.53ca447262116p+22 0x0p+0 0x0p+0 "
        "-0x1.7f189c9922e74p+4 -inf inf",
        "-0x1.3e9f0e5b296eep-9 0x1.9b3cd6f399abp+0 0x0p+0 -0x1.3daa596d451c9p-6 -0x1.c360a01452be3p-12 "
        "-0x1.a04bb9815cae6p-15 0x1.118288fb2f9b2p-18 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 "
        "0x1.c6c7a21a853d5p+4 0x0p+0 -0x0p+0 -0x1.5fd861d7632p-3 0x1.4acc755ee029p+7 0x1.4cc748cf64b09p+7",
        "0x1.2a1ec5b11dc9ep+8 0x1.4cb7d662ab33cp-8 0x0p+0 -0x1.931c8b84fcdedp+5 0x1.08dc5624e3735p+22 "
        "-0x1.17a5e67fe8958p+40 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x1.84983a02d1e36p-4 "
        "-0x0p+0 0x0p+0 -0x1.6add55f873a73p-4 0x1.1202dfcd62196p+0 0x1.12f42d95e9219p+0",
        "-0x1.807402e80bf5ap+6 -0x1.fffffffffdcd1p-1 0x0p+0 0x1.04e8b131b5225p+9 0x1.a59b27d0789acp+28 "
        "0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x0p+0 0x1.dd53d2509c123p-21 -0x0p+0 -0x0p+0 "
        "-0x1.62b4de06a8d24p+3 -0x1.7d968f441a104p-22 0x1.745e0ee8784cp-14",
        "0x1.70010472c0552p-1 -0x1.5f0d923baaa4ep-4 0x0p+0 -0x1.3303bc3900ca1p-7 0x0p+0 "
        "-0x1.a3ffe55b7d2bdp-8 0x0p+0 0x0p+0 0x1.52fd21834330fp-10 0x0p+0 0x0p+0 0x0p+0 0x0p+0 "
        "0x1.a24af1e99d9c7p-7 -0x0p+0 0x0p+0 -0x1.ab5b1d85638cp-9 0x0p+0 0x0p+0"};
    test_case t;
    for (const char *text : rims)
        if (read_case(text, &t)) row("just inside the rim of an asphere's domain", t.surface, t.ray, any);
    for (const char *text : residues) {
        if (!read_case(text, &t)) continue;
        for (sgt_pick pick : {SGT_FIRST, SGT_NEAR_SEED}) {
            rows++;
            const sgt_hit h = ask(t, pick);
            quad largest;
            const quad off = normal_error(surface(t.surface), {h.p.x, h.p.y, h.p.z}, &largest);
            if (h.status > 0 && !(off <= 8 * quad(ulp(to_double(largest)))))
                fail("normal error", "over 8 ulps of the largest term of F", t, h);
        }
    }
}

// ------------------------------------------------------------------- invalid

void invalid(const std::string &name, const sgt_surface &s, const sgt_ray &r, const sgt_options *o)
{
    rows++;
    const sgt_hit h = sgt_intersect(s, r, o);
    if (h.status == SGT_INVALID && h.t != h.t) return;
    failures++;
    std::printf("FAIL invalid %s: %s, t %g\n", name.c_str(), sgt_status_text(h.status), h.t);
}

void invalid_inputs()
{
    const sgt_conic sphere = {0.1, 0, 0};
    const sgt_even_asphere asph = {0.1, 0, 0, {0, 1e-4}};
    const sgt_surface surfaces[2] = {{&sgt_conic_ops, &sphere}, {&sgt_even_asphere_ops, &asph}};
    const sgt_ray good = {{0.1, 0.2, -5}, {0, 0.1, 1}, 0, 0};
    if (sgt_intersect(surfaces[0], good, nullptr).status != SGT_HIT ||
        sgt_intersect(surfaces[1], good, nullptr).status != SGT_HIT)
        failures++, std::printf("FAIL the good ray does not hit\n");

    for (int which = 0; which < 2; which++) {
        const sgt_surface s = surfaces[which];
        const std::string on = which ? "on an asphere: " : "on a conic: ";
        for (double bad : {HUGE_VAL, -HUGE_VAL, double(NAN)}) {
            for (int i = 0; i < 6; i++) {
                sgt_ray r = good;
                double *field[6] = {&r.o.x, &r.o.y, &r.o.z, &r.d.x, &r.d.y, &r.d.z};
                *field[i] = bad;
                invalid(on + (i < 3 ? "origin" : "direction") + " of " + std::to_string(bad), s, r, nullptr);
            }
            for (int i = 0; i < 4; i++) {
                sgt_options o = {};
                if (i == 3) o.max_evals = -1;
                else *(i == 0 ? &o.t_tol : i == 1 ? &o.f_tol : &o.dt_min) = bad;
                if (bad == HUGE_VAL && i < 3) { // not said to be invalid: only never a wrong answer
                    const sgt_hit h = sgt_intersect(s, good, &o);
                    rows++;
                    const answer a = all_roots(which ? surface(asph) : surface(sphere), good);
                    if (h.status > 0 && magnitude(a.roots.at(0).minus(h.t)) > quad(h.t_err) + quad(1e-25))
                        failures++, std::printf("FAIL an infinite option: no root within t_err\n");
                    continue;
                }
                invalid(on + "option " + std::to_string(i), s, good, &o);
            }
        }
        for (int i = 0; i < 2; i++) {
            sgt_ray r = good;
            (i ? r.tmax : r.tmin) = NAN;
            invalid(on + (i ? "tmax" : "tmin") + " NaN", s, r, nullptr);
        }
        for (double negative : {-1.0, -5e-324})
            for (int i = 0; i < 3; i++) {
                sgt_options o = {};
                *(i == 0 ? &o.t_tol : i == 1 ? &o.f_tol : &o.dt_min) = negative;
                invalid(on + "a negative option", s, good, &o);
            }
        sgt_ray r = good;
        r.tmin = 5, r.tmax = 4;
        invalid(on + "tmin > tmax", s, r, nullptr);
        r.tmin = 5, r.tmax = -INFINITY;
        invalid(on + "tmin > tmax = -infinity", s, r, nullptr);
        for (sgt_vec3 d : {sgt_vec3{0, 0, 0}, sgt_vec3{-0.0, 0, -0.0}, sgt_vec3{0, 0, 1e-310},
                           sgt_vec3{1e-310, 5e-324, -1e-309}, sgt_vec3{5e-324, 0, 0}}) {
            r = good;
            r.d = d;
            invalid(on + "a direction of nothing", s, r, nullptr);
        }
        const sgt_surface_ops none = {};
        invalid(on + "no value", sgt_surface{&none, s.self}, good, nullptr);
    }
    for (double bad : {HUGE_VAL, -HUGE_VAL, double(NAN)}) {
        for (int i = 0; i < 3; i++) {
            sgt_conic c = sphere;
            *(i == 0 ? &c.c : i == 1 ? &c.k : &c.semi_diameter) = bad;
            invalid("conic, parameter " + std::to_string(i) + " = " + std::to_string(bad),
                    sgt_surface{&sgt_conic_ops, &c}, good, nullptr);
            c = sgt_conic{0, 0, 0};
            *(i == 0 ? &c.c : i == 1 ? &c.k : &c.semi_diameter) = bad;
            invalid("plane, parameter " + std::to_string(i) + " = " + std::to_string(bad),
                    sgt_surface{&sgt_conic_ops, &c}, good, nullptr);
        }
        for (int i = 0; i < 11; i++) {
            sgt_even_asphere a = asph;
            *(i == 0 ? &a.c : i == 1 ? &a.k : i == 2 ? &a.semi_diameter : &a.a[i - 3]) = bad;
            invalid("asphere, parameter " + std::to_string(i) + " = " + std::to_string(bad),
                    sgt_surface{&sgt_even_asphere_ops, &a}, good, nullptr);
        }
    }
}

void in_the_plane()
{
    for (double c : {0.0, -0.0}) {
        const test_case t = make(conic(c), half({1, 2, 0}, {0.3, 1, 0}));
        const sgt_hit h = ask(t);
        rows++;
        if (!(h.status == SGT_GRAZE || h.status == SGT_UNPROVEN))
            fail("a ray in the plane", "neither graze nor unproven", t, h);
        if (h.status == SGT_GRAZE && !(h.t >= 0 && h.p.z == 0))
            fail("a ray in the plane", "not in the plane", t, h);
        std::printf("note: a ray in the plane is: %s\n", sgt_status_text(h.status));
    }
}

} // namespace

int main()
{
    curvatures();
    grazing();
    tangents();
    starts();
    directions();
    origins();
    deep_aspheres();
    soft_rim();
    in_the_plane();
    found_by_chance();
    invalid_inputs();
    std::printf("%d rows, %d undecided, %d failures\n", rows, undecided, failures);
    return failures != 0;
}
