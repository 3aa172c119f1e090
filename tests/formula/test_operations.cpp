// SPDX-License-Identifier: MIT
// What a formula offers to a solver, operation by operation, against Arb: at random points of each formula of
// formulas.h, at special ones and beside these.
//
//   value      within `rounding` of F; NaN where F is not defined.  The gradient, to 40 bits of its terms
//   values     the same bits
//   enclose    has F and its slope at points of the stretch; a finite slope only where no jump is.  On cells
//              of width 0 to a tenth of the chord.  encloses: the same, of 1 to 19 cells, and one by one
//   second, by_parameter, sgt_differentiate   the same by dual numbers of dual numbers of balls
//   sgt_formula_set   another value of a parameter is the formula read with it
//
//     test_operations [--count N] [--seed S] [--only NAME] [--random [--seconds T]] [--single]
//
// --random: of random formulas (grown.h), for so long.
// --single: of formulas of one operation, each operation, whole power and form of its operands once.
#include "grown.h"
#include "rays.h"
#include "subject.h"

#include <sagitta/sensitivity.h>

#include <cstdio>
#include <cstring>
#include <ctime>
#include <map>

using namespace formula;
using second_dual = dual<dual<ball>>;

namespace
{

long failures, examples = 2, asked; // asked: points with a value
std::map<std::string, long> faults;

void fail(const written &f, const char *what, const sgt_vec3 &p, double have, double want)
{
    failures++;
    if (faults[f.name + ": " + what]++ < examples)
        std::printf("FAIL %s: %s at {%a, %a, %a}: %.17g, not %.17g\n", f.name.c_str(), what, p.x, p.y, p.z,
                    have, want);
}

double blur, blur_least; // of each coordinate, relative, but of none less than blur_least

ball coordinate(double x) { return ball(x) + plus_minus(blur * std::max(std::fabs(x), blur_least)); }

second_dual variable(double x, bool outer, bool inner)
{
    return {dual<ball>(coordinate(x), ball(inner)), dual<ball>(ball(outer), ball(0))};
}

// d^2 F / dx_i dx_j.
ball bend(const written &f, const sgt_vec3 &p, int i, int j)
{
    return f.at(variable(p.x, i == 0, j == 0), variable(p.y, i == 1, j == 1), variable(p.z, i == 2, j == 2))
        .s.s;
}

// dF/da_j and its derivative by x_i.
dual<ball> by_parameter(const written &f, std::size_t j, const sgt_vec3 &p, int i)
{
    return f.by(j, variable(p.x, false, i == 0), variable(p.y, false, i == 1), variable(p.z, false, i == 2))
        .s;
}

// Is it what balls of 256 bits have, within what is known of it by balls of 40 bits of a point that is known
// to 40 bits?
template <class W>
void near(const written &f, const char *what, const sgt_vec3 &p, double have, const W &want)
{
    const ball exact = want();
    if (!exact.is_finite()) return;
    const precision of_doubles(40);
    blur = 0x1p-40;
    const ball rough = want();
    blur = 0;
    const double allowed = rough.radius() + 0x1p-40 * std::fabs(exact.rough()) + 1e-290;
    if (!(proof::size(ball(have) - exact).rough() <= allowed) && allowed < HUGE_VAL)
        fail(f, what, p, have, exact.rough());
}

const int rows[6] = {0, 0, 0, 1, 1, 2}, columns[6] = {0, 1, 2, 1, 2, 2};

void at_point(const written &f, const sgt_surface &s, const sgt_vec3 &p)
{
    const precision prec(256);
    seen = marks();
    const ball exact = f.at(ball(p.x), ball(p.y), ball(p.z));
    sgt_vec3 n, again;
    const double v = s.ops->value(s.self, p, &n), alone = s.ops->value(s.self, p, nullptr);
    if (std::memcmp(&v, &alone, sizeof v) && !(v != v && alone != alone)) fail(f, "value alone", p, alone, v);
    double f_lane, g_lane[3];
    s.ops->values(s.self, 1, {{&p.x, &p.y, &p.z}}, {&f_lane, {&g_lane[0], &g_lane[1], &g_lane[2]}});
    again = {g_lane[0], g_lane[1], g_lane[2]};
    const double mine[4] = {v, n.x, n.y, n.z}, lane[4] = {f_lane, again.x, again.y, again.z};
    for (int i = 0; i < 4; i++)
        if (std::memcmp(&mine[i], &lane[i], sizeof v) && !(mine[i] != mine[i] && lane[i] != lane[i]))
            fail(f, "values are not value", p, lane[i], mine[i]);

    if (!exact.is_finite()) { // not defined, or a border that balls cannot tell
        if (!seen.nowhere || v != v) return;
        const ball some = plus_minus(0x1p-48 * f.where.size()); // beside a border rounding may be within
        const precision rough(40);
        seen = marks();
        f.at(ball(p.x) + some, ball(p.y) + some, ball(p.z) + some);
        if (seen.nowhere) fail(f, "a value where none is", p, v, NAN);
        return;
    }
    const double rounding = s.ops->rounding(s.self, p);
    asked++;
    if (v != v) {
        if (!seen.torn() && !(rounding > 1e-9)) fail(f, "no value", p, v, exact.rough());
        return;
    }
    if (!(rounding >= 0)) fail(f, "no rounding", p, rounding, 0);
    if (less(ball(rounding), proof::size(ball(v) - exact)))
        fail(f, "value beyond its rounding", p, v, exact.rough());

    // What is smooth there, and a little beside.
    const double size = f.where.size(), beside = 0x1p-48 * size;
    seen = marks();
    f.at(ball(p.x) + plus_minus(beside), ball(p.y) + plus_minus(beside), ball(p.z) + plus_minus(beside));
    dual<ball> edge[3] = {dual<ball>(ball(p.x) + plus_minus(beside), ball(1)),
                          dual<ball>(ball(p.y) + plus_minus(beside), ball(1)),
                          dual<ball>(ball(p.z) + plus_minus(beside), ball(1))};
    f.at(edge[0], edge[1], edge[2]);
    if (seen.torn() || seen.kink || seen.nowhere) return;

    if (!f.is_tame(p)) return;
    // (at a 0 equal terms cancel in balls, and not in doubles)
    blur_least = f.is_random() ? 0x1p-10 : 0;

    for (int i = 0; i < 3; i++)
        near(f, "gradient", p, mine[i + 1], [&] {
            const point3 g = gradient(f, {coordinate(p.x), coordinate(p.y), coordinate(p.z)});
            return i == 0 ? g.x : i == 1 ? g.y : g.z;
        });
    double h[6];
    double *const list[6] = {&h[0], &h[1], &h[2], &h[3], &h[4], &h[5]};
    s.ops->second(s.self, 1, {{&p.x, &p.y, &p.z}}, list);
    for (int k = 0; k < 6; k++)
        near(f, "second derivative", p, h[k], [&] { return bend(f, p, rows[k], columns[k]); });

    const std::size_t parameters = s.ops->parameters(s.self);
    if (parameters != f.named.size())
        return fail(f, "number of parameters", p, static_cast<double>(parameters),
                    static_cast<double>(f.named.size()));
    for (std::size_t j = 0; j < parameters; j++) {
        double fa, ga[3];
        s.ops->by_parameter(s.self, j, 1, {{&p.x, &p.y, &p.z}}, {&fa, {&ga[0], &ga[1], &ga[2]}});
        near(f, "by parameter", p, fa, [&] { return by_parameter(f, j, p, 0).v; });
        for (int i = 0; i < 3; i++)
            near(f, "gradient by parameter", p, ga[i], [&] { return by_parameter(f, j, p, i).s; });
    }
}

// v, slope: what is said of the stretch [lo, hi] of the ray.
void hold(const written &f, const sgt_ray &ray, double lo, double hi, const sgt_interval &v,
          const sgt_interval &slope)
{
    if (v.lo <= v.hi && !(slope.lo <= slope.hi) && slope.lo == slope.lo && slope.hi == slope.hi)
        fail(f, "an empty slope", ray.o, slope.lo, slope.hi);
    const bool smooth = slope.lo > -HUGE_VAL && slope.hi < HUGE_VAL;
    ball before;
    bool had = false;
    for (int i = 0; i <= 4; i++) {
        const ball t = ball(lo) + (ball(hi) - ball(lo)) * ball(i / 4.0);
        const ball x = ball(ray.o.x) + ball(ray.d.x) * t, y = ball(ray.o.y) + ball(ray.d.y) * t,
                   z = ball(ray.o.z) + ball(ray.d.z) * t;
        const sgt_vec3 p = {x.rough(), y.rough(), z.rough()};
        const bool follows = had;
        had = false;
        seen = marks();
        const dual<ball> e = f.at(dual<ball>(x, ray.d.x), dual<ball>(y, ray.d.y), dual<ball>(z, ray.d.z));
        if (seen.nowhere && smooth && v.lo <= v.hi)
            fail(f, "a finite slope where F is not defined", p, slope.lo, NAN);
        if (seen.nowhere || !e.v.is_finite()) continue;
        if (seen.torn() || seen.kink) continue;
        if (less(e.v, ball(v.lo)) || less(ball(v.hi), e.v) || v.lo > v.hi)
            fail(f, "F is not in its enclosure", p, v.lo, e.v.rough());
        if (e.s.is_finite() && (less(e.s, ball(slope.lo)) || less(ball(slope.hi), e.s)))
            fail(f, "F' is not in its enclosure", p, slope.lo, e.s.rough());
        if (smooth && follows) { // of a jump the difference is too large
            const ball step = (ball(hi) - ball(lo)) * ball(0.25), up = e.v - before;
            if (less(ball(slope.hi) * step, up) || less(up, ball(slope.lo) * step))
                fail(f, "a jump within a finite slope", p, slope.lo, up.rough());
        }
        before = e.v, had = true;
    }
}

void enclosed(generator &g, const written &f, const sgt_surface &s, const sgt_ray &ray)
{
    const precision prec(256);
    const sgt_span chord = chord_of(f.where, ray);
    if (!(chord.lo < chord.hi)) return;
    const double all = chord.hi - chord.lo;
    enum { most = 19, shown = 3 };
    double lo[most], hi[most], out[4][most], alone[4];
    const int n = 1 + g.below(most), from = g.below(n);
    double in[6][most];
    for (int i = 0; i < n; i++) {
        const double width = g.chance(0.1) ? 0 : all * g.log_uniform(1e-16, 0.1);
        lo[i] = chord.lo + g.uniform(0, 1) * all, hi[i] = lo[i] + width;
        const double v[6] = {ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z};
        for (int k = 0; k < 6; k++) in[k][i] = v[k];
    }
    sgt_interval slope;
    const sgt_interval v = s.ops->enclose(s.self, &ray, {lo[0], hi[0]}, &slope);
    hold(f, ray, lo[0], hi[0], v, slope);

    if (!s.ops->encloses) return;
    const auto rays = [&](int i) {
        return sgt_rays{{in[0] + i, in[1] + i, in[2] + i},
                        {in[3] + i, in[4] + i, in[5] + i},
                        nullptr,
                        nullptr};
    };
    s.ops->encloses(s.self, static_cast<std::size_t>(n), rays(0), lo, hi, {out[0], out[1], out[2], out[3]});
    for (int i = from; i < n && i < from + shown; i++) {
        s.ops->encloses(s.self, 1, rays(i), lo + i, hi + i, {&alone[0], &alone[1], &alone[2], &alone[3]});
        for (int k = 0; k < 4; k++)
            if (std::memcmp(&alone[k], &out[k][i], sizeof alone[k])) // nor a NaN, which would say all
                fail(f, "a cell among others is another", ray.o, out[k][i], alone[k]);
        hold(f, ray, lo[i], hi[i], {out[0][i], out[1][i]}, {out[2][i], out[3][i]});
    }
}

void differentiated(const written &f, const sgt_surface &s, const sgt_ray &ray)
{
    const sgt_hit h = sgt_intersect(s, ray, nullptr);
    if (h.status != SGT_HIT || !f.is_tame(h.p) || breaks_at(f, h.p)) return;
    const precision prec(256);
    seen = marks();
    const point3 g = gradient(f, widen(h.p));
    if (seen.torn() || seen.kink || !norm(g).is_finite()) return;
    const double n[3] = {g.x.rough(), g.y.rough(), g.z.rough()}, d[3] = {ray.d.x, ray.d.y, ray.d.z};
    const double slope = n[0] * d[0] + n[1] * d[1] + n[2] * d[2], steep = norm(g).rough(),
                 length = std::sqrt(inner(ray.d, ray.d)), size = f.where.size();
    if (!(std::fabs(slope) > 1e-2 * steep * length)) return;
    sgt_change by_o[3], by_a[8];
    const int lacks = sgt_differentiate(s, &ray, &h, by_o, by_a);
    if (lacks & SGT_LACKS_SECOND) return fail(f, "no second derivatives", h.p, lacks, 0);
    double bent[3][3], most = 0;
    for (int k = 0; k < 6; k++) {
        bent[rows[k]][columns[k]] = bent[columns[k]][rows[k]] = bend(f, h.p, rows[k], columns[k]).rough();
        most = std::max(most, std::fabs(bent[rows[k]][columns[k]]));
    }
    const double rounding = s.ops->rounding(s.self, h.p), noise = 1e-8 + 1e8 * rounding / (steep * size);
    const double bends = most * 3 + steep / size;
    if (!(noise < 1e-3) || !(h.p_err * bends < 1e-9 * steep)) return;
    const auto near = [&](double have, double want, double of, const char *what) {
        if (!(std::fabs(have - want) <= noise * of)) fail(f, what, h.p, have, want);
    };
    for (int j = 0; j < 3; j++) {
        const double dt = -n[j] / slope;
        near(by_o[j].t, dt, 100 / length, "dt/do");
        const double dp[3] = {by_o[j].p.x, by_o[j].p.y, by_o[j].p.z},
                     dn[3] = {by_o[j].n.x, by_o[j].n.y, by_o[j].n.z};
        double way[3];
        for (int i = 0; i < 3; i++) way[i] = (i == j) + d[i] * dt, near(dp[i], way[i], 100, "dp/do");
        for (int i = 0; i < 3; i++)
            near(dn[i], bent[i][0] * way[0] + bent[i][1] * way[1] + bent[i][2] * way[2], 100 * bends,
                 "dn/do");
    }
    for (std::size_t j = 0; j < f.named.size(); j++) {
        double mixed[3], fa = 0, terms = 0;
        for (int i = 0; i < 3; i++) {
            const dual<ball> e = by_parameter(f, j, h.p, i);
            fa = e.v.rough(), mixed[i] = e.s.rough(), terms = std::max(terms, std::fabs(mixed[i]));
        }
        const double dt = -fa / slope, unit = std::max(1.0, 1 / std::fabs(f.named[j].value)),
                     of = std::fabs(fa) / steep + (terms / steep + unit) * size;
        near(by_a[j].t, dt, 100 * of / length, "dt/da");
        const double dn[3] = {by_a[j].n.x, by_a[j].n.y, by_a[j].n.z},
                     dp[3] = {by_a[j].p.x, by_a[j].p.y, by_a[j].p.z};
        for (int i = 0; i < 3; i++) {
            near(dp[i], d[i] * dt, 100 * of, "dp/da");
            near(dn[i], (bent[i][0] * d[0] + bent[i][1] * d[1] + bent[i][2] * d[2]) * dt + mixed[i],
                 100 * (bends * of + terms), "dn/da");
        }
    }
}

// A parameter set anew, and read anew.
void set_anew(generator &g, const written &f)
{
    const std::size_t n = f.named.size();
    if (!n) return;
    std::vector<sgt_named> named = f.named;
    std::vector<double> values(n);
    for (std::size_t i = 0; i < n; i++) values[i] = named[i].value *= g.uniform(0.9, 1.1);
    const std::size_t size = sgt_formula_room(f.text.c_str(), n);
    std::vector<double> room[2];
    sgt_tape *tape[2];
    for (int k = 0; k < 2; k++) {
        room[k].resize(size / sizeof(double) + 1);
        tape[k] = sgt_formula_read(f.text.c_str(), f.sag() ? SGT_FORMULA_XY : SGT_FORMULA_XYZ, n,
                                   (k ? f.named : named).data(), room[k].data(), size, nullptr);
        if (!tape[k]) return fail(f, "not read", {0, 0, 0}, k, 0);
    }
    if (!sgt_formula_set(tape[1], values.data(), nullptr)) fail(f, "not set", {0, 0, 0}, 0, 0);
    values[0] = NAN;
    if (sgt_formula_set(tape[1], values.data(), nullptr)) fail(f, "NaN was set", {0, 0, 0}, 0, 0);
    for (int i = 0; i < 20; i++) {
        const sgt_vec3 p = random_point(g, f.where);
        double v[2];
        for (int k = 0; k < 2; k++) {
            const sgt_formula level = {tape[k], 0, {0, 0, 0}, {0, 0, 0}};
            const sgt_formula_sag sag = {tape[k], 0};
            v[k] = f.sag() ? sgt_formula_sag_ops.value(&sag, p, nullptr)
                           : sgt_formula_ops.value(&level, p, nullptr);
        }
        if (std::memcmp(&v[0], &v[1], sizeof v[0]) && !(v[0] != v[0] && v[1] != v[1]))
            fail(f, "set and read differ", p, v[1], v[0]);
    }
}

void operations(generator &g, const written &f, const sgt_surface &s, long count)
{
    for (long i = 0; i < count; i++) {
        sgt_vec3 p = random_point(g, f.where);
        if (g.chance(0.1)) (g.chance(0.5) ? p.x : p.y) = 0;
        if (g.chance(0.2) && !f.special.empty()) {
            p = f.special[static_cast<std::size_t>(g.below(static_cast<int>(f.special.size())))];
            if (g.chance(0.7)) p = plus(p, f.where.size() * g.log_uniform(1e-16, 1e-3), random_way(g));
        }
        at_point(f, s, p);
        const int kind = g.below(kinds_of_rays);
        const sgt_ray ray = random_ray(g, f, kind == 2 ? 0 : kind);
        enclosed(g, f, s, ray);
        differentiated(f, s, ray);
    }
    set_anew(g, f);
}

// Random formulas (grown.h), 12 points and rays each: 5 * run.count of them, as many as the time allows, or
// number `only`.
void randomly(const oracle::run &run, double seconds, const char *only)
{
    const std::time_t start = std::time(nullptr);
    long refused = 0, undefined = 0, read = 0, nodes = 0, told = 0, most = only ? std::atol(only) : -1;
    for (long i = std::max(most, 0L); most < 0 || i == most; i++) {
        if (seconds > 0 ? std::difftime(std::time(nullptr), start) >= seconds : i >= 5 * run.count && !only)
            break;
        generator g(run.seed + 7919 * static_cast<std::uint64_t>(i));
        const grown f(g, i);
        const subject s(f, false);
        const long before = failures;
        if (!s.error().empty()) {
            refused++;
            if (f.may_be_refused() || s.error().find("none of x, y, z, r") != std::string::npos) continue;
            std::printf("FAIL %s is refused: %s\n", f.name.c_str(), s.error().c_str());
            failures++;
        } else {
            read++, nodes += static_cast<long>(f.size()), asked = 0;
            operations(g, f, s.surface(), 12);
            undefined += asked == 0;
        }
        if ((failures > before && told++ < 40) || only) {
            std::printf("    %s\n   ", f.text.c_str());
            for (const sgt_named &n : f.named) std::printf(" %s = %a", n.name, n.value);
            std::printf("\n");
        }
    }
    std::printf("%ld random formulas of %.1f operations read and tried, %ld of them undefined where asked; "
                "%ld refused\n",
                read, read ? static_cast<double>(nodes) / static_cast<double>(read) : 0, undefined, refused);
}

// More points than are worked out at once: each has the bits that it has alone.
void many_at_once(generator &g, const written &f, const sgt_surface &s)
{
    const std::size_t n = static_cast<std::size_t>(1 + g.below(400));
    std::vector<double> p[3], out[4];
    for (auto &v : p) v.resize(n);
    for (auto &v : out) v.resize(n);
    for (std::size_t i = 0; i < n; i++) {
        const sgt_vec3 at = random_point(g, f.where);
        p[0][i] = at.x, p[1][i] = at.y, p[2][i] = at.z;
    }
    s.ops->values(s.self, n, {{p[0].data(), p[1].data(), p[2].data()}},
                  {out[0].data(), {out[1].data(), out[2].data(), out[3].data()}});
    for (std::size_t i = 0; i < n; i++) {
        const sgt_vec3 at = {p[0][i], p[1][i], p[2][i]};
        sgt_vec3 grad;
        const double v = s.ops->value(s.self, at, &grad), alone[4] = {v, grad.x, grad.y, grad.z};
        for (int k = 0; k < 4; k++)
            if (std::memcmp(&alone[k], &out[k][i], sizeof v) &&
                !(alone[k] != alone[k] && out[k][i] != out[k][i]))
                fail(f, "a point among many", at, out[k][i], alone[k]);
    }
}

// Each operation alone (grown.h, singles), at some points and rays.
void singly(const oracle::run &run, const char *only)
{
    const std::vector<single> all = singles();
    long refused = 0, undefined = 0, told = 0, most = only ? std::atol(only) : -1;
    const long points = std::max(run.count / 50, 1L);
    for (long i = 0; i < static_cast<long>(all.size()); i++) {
        if (most >= 0 && i != most) continue;
        generator g(run.seed + 7919 * static_cast<std::uint64_t>(i));
        const grown f(g, i, all[static_cast<std::size_t>(i)]);
        const subject s(f, false);
        const long before = failures;
        asked = 0;
        if (s.error().empty()) operations(g, f, s.surface(), points), many_at_once(g, f, s.surface());
        else if (f.may_be_refused() || s.error().find("none of x, y, z, r") != std::string::npos) refused++;
        else fail(f, s.error().c_str(), {0, 0, 0}, 0, 0);
        undefined += asked == 0;
        if ((failures > before && told++ < 40) || only) {
            std::printf("    %s\n   ", f.text.c_str());
            for (const sgt_named &n : f.named) std::printf(" %s = %a", n.name, n.value);
            std::printf("\n");
        }
    }
    std::printf("%zu formulas of one operation tried, %ld points each; %ld undefined there, %ld refused\n",
                all.size(), points, undefined, refused);
    if (!only && undefined > static_cast<long>(all.size()) / 20) failures++;
}

} // namespace

int main(int argc, char **argv)
{
    const char *only = nullptr;
    double seconds = 0;
    bool random = false, alone = false;
    for (int i = 1; i < argc; i++) {
        if (!std::strcmp(argv[i], "--only") && i + 1 < argc) only = argv[i + 1];
        if (!std::strcmp(argv[i], "--random")) random = true;
        if (!std::strcmp(argv[i], "--single")) alone = true;
        if (!std::strcmp(argv[i], "--seconds") && i + 1 < argc) seconds = std::atof(argv[i + 1]);
    }
    const oracle::run run(argc, argv, 200, 20261124);
    if (random) {
        randomly(run, seconds, only);
    } else if (alone) {
        singly(run, only);
    } else {
        std::uint64_t number = 0;
        for (const auto &f : formulas()) {
            number++;
            if (only && f->name != only) continue;
            const subject s(*f, false);
            if (!s.error().empty()) {
                std::printf("FAIL %s: %s\n", f->name.c_str(), s.error().c_str());
                failures++;
                continue;
            }
            generator g(run.seed + 7919 * number);
            operations(g, *f, s.surface(), run.count);
        }
    }
    for (const auto &x : faults) std::printf("    %6ld %s\n", x.second, x.first.c_str());
    std::printf("%ld failures\n", failures);
    return failures != 0;
}
