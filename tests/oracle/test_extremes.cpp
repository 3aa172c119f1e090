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

sgt_asphere conic(double c, double k = 0, double semi_diameter = 0) { return sgt_asphere{c, k, semi_diameter, {}}; }
sgt_asphere asphere(double c, double k, std::initializer_list<double> a, double semi_diameter = 0)
{
    sgt_asphere s = {c, k, semi_diameter, {}};
    std::copy(a.begin(), a.end(), s.a);
    return s;
}

const double inf = HUGE_VAL;

sgt_ray half(sgt_vec3 o, sgt_vec3 d) { return {o, d, 0, 0}; }
sgt_ray whole(sgt_vec3 o, sgt_vec3 d) { return {o, d, -inf, inf}; }
sgt_ray from(double tmin, sgt_vec3 o, sgt_vec3 d) { return {o, d, tmin, inf}; }

test_case make(const sgt_asphere &s, const sgt_ray &r)
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
    std::printf("\"\n    %s t %.17g (%a) t_err %.3g lo %.17g hi %.17g p %g %g %g p_err %.3g evals %d\n", sgt_status_text(h.status), h.t, h.t, h.t_err, h.lo, h.hi,
                h.p.x, h.p.y, h.p.z, h.p_err, h.evals);
    for (const meeting &m : all_roots(surface(t.surface), t.ray).roots) std::printf("    root %s%s\n", text(m.t()).c_str(), m.edge ? " (edge)" : "");
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
    if (!near || !(magnitude(near->minus(h.t)) <= quad(h.t_err) + near->blur + least)) return "no root within t_err";
    if (counting(*near, tmin, tmax) == no) return "a root that does not count";
    if (first && passed_over(a, *near, h, tmin, tmax)) return "not the first";
    if (magnitude(near->minus(h.t) - h.t_lo) > quad(h.t_err) + near->blur + least) return "t + t_lo is farther off than t_err";
    if (!std::isfinite(h.t_err)) return "t_err is not finite";
    const vector3 p = {h.p.x, h.p.y, h.p.z}, off = {p.x - near->p.x, p.y - near->p.y, p.z - near->p.z};
    if (!(norm(off) <= quad(h.p_err) + norm(near->p) * quad(0x1p-100) + near->blur * norm({t.ray.d.x, t.ray.d.y, t.ray.d.z}) + least)) return "p is farther off than p_err";
    return nullptr;
}

enum demand { decided, any };

void row(const char *name, const sgt_asphere &s, const sgt_ray &r, demand d = decided)
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
void met(const char *name, const sgt_asphere &s, const sgt_ray &r, demand d = decided)
{
    const test_case t = make(s, r);
    double tmin, tmax;
    ends_of(r, &tmin, &tmax);
    bool some = false;
    for (const meeting &m : all_roots(surface(s), r).roots) some = some || counting(m, tmin, tmax) == yes;
    if (!some) fail(name, "the row has no root", t, ask(t));
    row(name, s, r, d);
}

void tangent(const char *name, const sgt_asphere &s, const sgt_ray &r, double root, demand d = decided)
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
            met("a point of a surface, in its own size", conic(c, e), half({0, 0.25e-300, -5e-300}, {0, 0, 1e-300}), any);
            met("a point of a surface, in its own size, oblique", conic(c, e), half({0, -2e-300, c > 0 ? -2e-300 : 2e-300}, {0, 0.6e-300, c > 0 ? 0.8e-300 : -0.8e-300}), any);
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
        const double c = 1, r = k > 1 ? 0.02 : 0.6, w = std::sqrt(1 - (1 + k) * c * c * r * r), z = c * r * r / (1 + w), slope = c * r / w, m = std::sqrt(1 + slope * slope);
        for (double turn : {-e, e}) {
            const double l = (1 - turn * slope) / m, n = (slope + turn) / m; // the tangent, turned by e about y
            row("grazing a conic at 1e-8 in the meridian", conic(c, k), whole({r - 3 * l, 0, z - 3 * n}, {l, 0, n}));
            // At the vertex the doubles are fine enough for the chord (2e-8 long, 5e-17 deep).
            met("grazing a conic at 1e-8 at its vertex", conic(c, k), whole({-3, 0, -3 * turn}, {1, 0, turn}));
            row("grazing a conic at 1e-8 at its vertex, from far", conic(-c, k), whole({-1e9, 0, -1e9 * turn}, {1, 0, turn}));
        }
        met("grazing a conic at 1e-8 across", conic(c, k), whole({r + 3e-8 * slope, -3, z - 3e-8}, {-e * slope, 1, e}));
    }
    for (double side : {1.0, -1.0}) {
        const double y = 0.9999999999999999;
        met("just inside the equator", conic(side), half({0, y, -5 * side}, {0, 0, side}));
        row("just outside the equator", conic(side), half({0, 1.0000000000000002, -5 * side}, {0, 0, side}));
        row("at the equator", conic(side), half({0, 1, -5 * side}, {0, 0, side}), any);
        met("into the equator from outside, level", conic(side), half({0, -5, side * y}, {0, 1, 0}));
    }
    met("grazing an asphere at 1e-8", asphere(0, 0, {0.5, -0.125}), half({1, -3, 0.375 - 3e-8}, {0, 1, e}), any);
}

void tangents()
{
    tangent("tangent at the vertex", conic(1), whole({0, -5, 0}, {0, 1, 0}), 5);
    tangent("tangent at the vertex, far", conic(1), whole({0, -1e9, 0}, {0, 1, 0}), 1e9);
    tangent("tangent to a paraboloid", conic(1, -1), whole({-3, 0, -3.5}, {1, 0, 1}), 4);
    tangent("tangent to a paraboloid, short direction", conic(1, -1), whole({-3, 0, -3.5}, {0x1p-300, 0, 0x1p-300}), 0x1p302);
    tangent("tangent to a hyperboloid", conic(1, -2), whole({0.75 - 10, 0, 0.25 - 6}, {5, 0, 3}), 2);
    tangent("tangent to a hyperboloid, skew", conic(1, -2), whole({0.75, -4, 0.25}, {0, 1, 0}), 4);
    tangent("tangent to an asphere at its vertex", asphere(1, -1, {0, 0.25}), whole({-4, 0, 0}, {1, 0, 0}), 4, any);
    tangent("tangent to an asphere, across", asphere(0, 0, {0.5, -0.125}, 1.5), whole({1, -4, 0.375}, {0, 1, 0}), 4, any);
    tangent("tangent to an asphere, first of two", asphere(0, 0, {0.5, -0.0625}, 3), whole({-5, 0, 1}, {1, 0, 0}), 3, any);
    for (double o : {0x1p-50, -0x1p-50, 0x1p-40, -0x1p-40}) {
        row("a few ulps beside a tangent, paraboloid", conic(1, -1), whole({-3, 0, -3.5 + o}, {1, 0, 1}));
        row("a few ulps beside a tangent, hyperboloid", conic(1, -2), whole({0.75 - 10, 0, 0.25 - 6 + o}, {5, 0, 3}));
    }
    for (double o : {1e-20, -1e-20, 1e-30, 5e-324}) row("a hair beside the vertex", conic(1), whole({0, -5, o}, {0, 1, 0}), any);
    // With an end before it a tangent may count or not (the rule at tmin has 1/|grad F . d| in
    // it), but may not be somewhere else.
    const test_case t = make(conic(1, -1), half({-3, 0, -3.5}, {1, 0, 1}));
    const sgt_hit h = ask(t);
    rows++;
    if (h.status > 0 && !(std::fabs(h.t - 4) <= h.t_err)) fail("tangent from tmin = 0", "no root within t_err", t, h);
    std::printf("note: a tangent at t = 4 from tmin = 0 is: %s\n", sgt_status_text(h.status));
}

void starts()
{
    const sgt_asphere surfaces[] = {conic(0), conic(1), conic(-0.2), conic(0.3, -1), conic(0.3, -2), conic(1, 3), asphere(0.3, -1, {0, 0.01}, 2), asphere(0, 0, {-0.2, 0.02}, 4)};
    for (const sgt_asphere &s : surfaces)
        for (double x : {0.0, 0.1, 0.3}) {
            const double y = 0.2, z = rough_sag(s, x * x + y * y);
            for (sgt_vec3 d : {sgt_vec3{0, 0, 1}, sgt_vec3{0.1, -0.3, -1}, sgt_vec3{0.8, 0.1, 0.3}, sgt_vec3{-1, 0.2, 0.001}}) {
                test_case t = make(s, half({x, y, z}, d));
                sgt_hit h = ask(t);
                rows++;
                if (h.status > 0 && std::fabs(h.t) < 1e-12) fail("start on the surface, tmin = 0", "the root at the start is not skipped", t, h);
                row("start on the surface, tmin = 0", s, t.ray);
                met("start on the surface, tmin = -1e-3", s, from(-1e-3, {x, y, z}, d));
                met("start on the surface, tmin = -infinity", s, whole({x, y, z}, d));
                t.ray = from(-1e-3, {x, y, z}, d);
                h = ask(t);
                rows++;
                if (h.status <= 0 || !(h.t < 1e-12)) fail("start on the surface, tmin = -1e-3", "the root at the start is not found", t, h);
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
        met("length of the direction: asphere", asphere(0.1, -0.5, {1e-3, -1e-5}, 5), half({1, 2, -5}, {0.1 * l, 0.2 * l, l}));
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
        met("a subnormal origin on an asphere", asphere(0.3, -1, {0, 0.01}), half({tiny, tiny, -1}, {0, 0, 1}));
        met("a subnormal origin on a plane", conic(0), whole({tiny, 0, tiny}, {0.5, 0, 1}), any);
    }
    for (double far : {1e12, 1e15, 1e30, 1e100, 1e200, 1e300}) {
        met("far along the axis", conic(1), half({0, 0, -far}, {0, 0, 1}), far > 1e12 ? any : decided);
        met("far, parallel to the axis", conic(1), half({0.3, 0.2, -far}, {0, 0, 1}), far > 1e12 ? any : decided);
        row("far and oblique", conic(1, -0.5), half({-far, 0, -far}, {1, 0, 1}), far > 1e12 ? any : decided);
        row("far and oblique, asphere", asphere(0.3, -1, {0, 0.01}, 2), half({-far, 0, -far}, {1, 0, 1}), far > 1e12 ? any : decided);
        row("far plane", conic(0), half({-far, 3, -far}, {1, 0, 1}), far > 1e12 ? any : decided);
    }
}

void deep_aspheres()
{
    const sgt_asphere w = asphere(0, 0, {-1.5, 0.4});
    met("a deep W, first of four", w, half({0, -3, -1.2}, {0, 0.97, 0.24310491562286435}));
    met("a deep W, the second", w, from(1.5, {0, -3, -1.2}, {0, 0.97, 0.24310491562286435}));
    met("a deep W, the third", w, from(2.5, {0, -3, -1.2}, {0, 0.97, 0.24310491562286435}));
    met("a deep W, the last", w, from(4, {0, -3, -1.2}, {0, 0.97, 0.24310491562286435}));
    row("a deep W, past them all", w, from(6, {0, -3, -1.2}, {0, 0.97, 0.24310491562286435}), any);
    const sgt_asphere phone = asphere(1 / -4.2, -6.5, {0, -0.1206, 0.0653, -0.0352, 0.0134, -0.0029, 0.00032, -1.4e-05}, 2.8);
    for (double y : {-2.6, -1.9, -0.5, 0.0, 1.2, 2.7}) {
        row("a phone lens", phone, half({0.1, y, -3}, {0, 0.25, 0.9682458365518543}), any);
        row("a phone lens, level", phone, half({-4, y, -0.3}, {1, 0.01, 0.01}), any);
    }
    const sgt_asphere steep = asphere(0, 0, {0, 0, 0, 0, 0, 0, 0, 1e3}, 1);
    met("r^16 alone, steep", steep, half({0.95, 0, 2000}, {0, 0, -1}));
    met("r^16 alone, the flat floor", steep, half({-0.1, 0.05, 5}, {0.01, 0, -1}));
    met("r^16 alone, level", steep, half({-3, 0, 100}, {1, 0, 0}));
    met("a bowl of a sphere and more", asphere(1, 0, {0, 0.5, -2, 3}), half({0.7, 0.1, -3}, {0.05, 0, 1}), any);
    met("an asphere just inside its equator", asphere(1, 0, {0, 0.1}), half({0.999999, 0, -3}, {0, 0, 1}));
    row("an asphere just outside its equator", asphere(1, 0, {0, 0.1}), half({1.000001, 0, -3}, {0, 0, 1}), any);
    met("terms that cancel the conic", asphere(1, -1, {-0.5, 1e-9}, 3), half({1, 1, -3}, {0, 0, 1}));
    met("terms that cancel the conic, whole", asphere(1, -1, {-0.5}), half({1, 1, -3}, {0.1, 0, 1}), any);
    met("with every term zero it is the conic", asphere(1, -1, {}), half({1, 1, -3}, {0.1, 0, 1}));
}

void soft_rim()
{
    met("a marginal ray", conic(0.1, 0, 0.5), half({0.5000000000000004, 0, -5}, {0, 0, 1}));
    row("a ray outside the rim", conic(0.1, 0, 0.5), half({0.50000000000001, 0, -5}, {0, 0, 1}));
    met("a marginal ray on an asphere", asphere(0.1, 0, {0, 0.1}, 0.5), half({0.5000000000000004, 0, -5}, {0, 0, 1}));
    row("a ray outside an asphere's rim", asphere(0.1, 0, {0, 0.1}, 0.5), half({0.50000000000001, 0, -5}, {0, 0, 1}), any);
    met("a marginal ray on a plane", conic(0, 0, 0.5), half({0, 0.5000000000000004, -5}, {0, 0, 1}));
    row("a ray outside a plane's rim", conic(0, 0, 0.5), half({0.50000000000001, 0, -5}, {0, 0, 1}));
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
    const sgt_asphere asph = {0.1, 0, 0, {0, 1e-4}};
    const sgt_surface surfaces[2] = {{&sgt_conic_ops, &sphere}, {&sgt_asphere_ops, &asph}};
    const sgt_ray good = {{0.1, 0.2, -5}, {0, 0.1, 1}, 0, 0};
    if (sgt_intersect(surfaces[0], good, nullptr).status != SGT_HIT || sgt_intersect(surfaces[1], good, nullptr).status != SGT_HIT)
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
                    if (h.status > 0 && magnitude(a.roots.at(0).minus(h.t)) > quad(h.t_err) + quad(1e-25)) failures++, std::printf("FAIL an infinite option: no root within t_err\n");
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
        for (sgt_vec3 d : {sgt_vec3{0, 0, 0}, sgt_vec3{-0.0, 0, -0.0}, sgt_vec3{0, 0, 1e-310}, sgt_vec3{1e-310, 5e-324, -1e-309}, sgt_vec3{5e-324, 0, 0}}) {
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
            invalid("conic, parameter " + std::to_string(i) + " = " + std::to_string(bad), sgt_surface{&sgt_conic_ops, &c}, good, nullptr);
            c = sgt_conic{0, 0, 0};
            *(i == 0 ? &c.c : i == 1 ? &c.k : &c.semi_diameter) = bad;
            invalid("plane, parameter " + std::to_string(i) + " = " + std::to_string(bad), sgt_surface{&sgt_conic_ops, &c}, good, nullptr);
        }
        for (int i = 0; i < 11; i++) {
            sgt_asphere a = asph;
            *(i == 0 ? &a.c : i == 1 ? &a.k : i == 2 ? &a.semi_diameter : &a.a[i - 3]) = bad;
            invalid("asphere, parameter " + std::to_string(i) + " = " + std::to_string(bad), sgt_surface{&sgt_asphere_ops, &a}, good, nullptr);
        }
    }
}

void in_the_plane()
{
    for (double c : {0.0, -0.0}) {
        const test_case t = make(conic(c), half({1, 2, 0}, {0.3, 1, 0}));
        const sgt_hit h = ask(t);
        rows++;
        if (!(h.status == SGT_GRAZE || h.status == SGT_UNPROVEN)) fail("a ray in the plane", "neither graze nor unproven", t, h);
        if (h.status == SGT_GRAZE && !(h.t >= 0 && h.p.z == 0)) fail("a ray in the plane", "not in the plane", t, h);
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
    invalid_inputs();
    std::printf("%d rows, %d undecided, %d failures\n", rows, undecided, failures);
    return failures != 0;
}
