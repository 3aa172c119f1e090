// SPDX-License-Identifier: MIT
// A formula as the command's trade works it out in 113 bits (src/truth/text.hpp), against Arb: at random
// points of each formula of formulas.h, at special ones and at the vertex, and at points of random formulas
// (grown.h).  Values and gradients have to agree as far as balls of 96 bits can tell, at a point that is
// known to 96 bits; so a function that is only right as a double fails.  Where F is not defined it is NaN.
//
// Each elementary function (elementary.hpp) also by itself, at random arguments of 113 bits: its greatest
// error is printed, and is at most 2^-108 of the value.
//
//     test_text [--count N] [--seed S] [--only NAME]
#include "../../src/truth/text.hpp"
#undef FORMULA

#include "grown.h"
#include "rays.h"
#include "subject.h"

#include <cctype>
#include <cstdio>
#include <cstring>

namespace
{

using formula::ball;
using formula::seen;
using formula::written;
using oracle::generator;
using proof::precision;
typedef catalogue::dual<quad, 3> jet;

long failures, compared, undefined;

void fail(const std::string &name, const char *what, const sgt_vec3 &p, quad have, const ball &want)
{
    if (failures++ < 40)
        std::printf("FAIL %s: %s at {%a, %a, %a}: %.17g, not %s\n", name.c_str(), what, p.x, p.y, p.z,
                    oracle::to_double(have), proof::text(want, 40).c_str());
}

// Three doubles have it all.
ball exactly(quad x)
{
    const double a = oracle::to_double(x), b = oracle::to_double(x - a), c = oracle::to_double(x - a - b);
    return ball(a) + ball(b) + ball(c);
}

// ------------------------------------------------------------------------------------------------ texts

ball blurred(double x, double by)
{
    ball r(x);
    arb_add_error(r.x, ball(by * std::fmax(std::fabs(x), 0x1p-10)).x);
    return r;
}

struct level {
    ball v[4]; // F and its gradient
};
level level_of(const written &f, const sgt_vec3 &p, double blur)
{
    level l;
    for (int i = 0; i < 3; i++) {
        const formula::dual<ball> e =
            f.at(formula::dual<ball>(blurred(p.x, blur), ball(i == 0)),
                 formula::dual<ball>(blurred(p.y, blur), ball(i == 1)),
                 formula::dual<ball>(blurred(p.z, blur), ball(i == 2)));
        l.v[0] = e.v, l.v[i + 1] = e.s;
    }
    return l;
}

// Does it name r or atan2?
bool has_vertex(const std::string &text)
{
    const auto is_of_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
    for (std::size_t i = 0; i < text.size(); i++)
        if (text[i] == 'r' && !(i > 0 && is_of_name(text[i - 1])) &&
            !(i + 1 < text.size() && is_of_name(text[i + 1])))
            return true;
    return text.find("atan2") != std::string::npos;
}

void at_point(const written &f, const catalogue::text_formula<jet> &text, const sgt_vec3 &p)
{
    static const char *const name[4] = {"value", "slope by x", "slope by y", "slope by z"};
    const double BLUR = 0x1p-96, PART = 0x1p-94;
    const jet j = text(jet::variable(p.x, 0), jet::variable(p.y, 1), jet::variable(p.z, 2));
    const quad have[4] = {j.a, j.v[0], j.v[1], j.v[2]};
    const precision high(320);
    seen = formula::marks();
    const level exact = level_of(f, p, 0);
    if (seen.nowhere) {
        const precision rough(40);
        seen = formula::marks();
        level_of(f, p, 0x1p-48 * f.where.size());
        if (!seen.nowhere || (p.x == 0 && p.y == 0 && has_vertex(f.text))) return; // a border; text.hpp
        undefined++;
        if (have[0] == have[0]) fail(f.name, "a value where none is", p, have[0], exact.v[0]);
        return;
    }
    const bool smooth = !seen.torn() && !seen.kink;
    const precision less_of_it(96);
    seen = formula::marks();
    const level rough = level_of(f, p, BLUR);
    if (seen.torn() || seen.nowhere) return;
    // (113 bits end at 2^16384, and the sine of 2^53; what is there is of no use)
    double steep = 0;
    for (int i = 0; i < 4; i++) {
        if (!exact.v[i].is_finite() || !(std::fabs(exact.v[i].rough()) < 1e300)) return;
        if (i > 0) steep = std::fmax(steep, std::fabs(exact.v[i].rough()));
    }
    if (have[0] != have[0] && (steep > 0x1p40 || exact.v[0].radius() > 0x1p-40)) return;
    for (int i = 0; i < (smooth && !seen.kink ? 4 : 1); i++) {
        if (!rough.v[i].is_finite()) continue;
        const precision again(320);
        const double size = i == 0 ? std::fabs(exact.v[0].rough()) : steep,
                     allowed = 4 * rough.v[i].radius() + PART * (size + f.where.size() * 0x1p-16) + 1e-280;
        if (!(allowed < HUGE_VAL)) continue;
        compared++;
        if (have[i] != have[i]) fail(f.name, "NaN", p, have[i], exact.v[i]);
        else if (!(proof::size(exactly(have[i]) - exact.v[i]).rough() <= allowed))
            fail(f.name, name[i], p, have[i], exact.v[i]);
    }
}

void try_formula(generator &g, const written &f, long count)
{
    const catalogue::text_formula<jet> text(f.sag(), f.text.c_str(), f.named.size(), f.named.data());
    if (const std::size_t column = text.column()) {
        std::printf("FAIL %s: column %zu is not understood: %s\n", f.name.c_str(), column, f.text.c_str());
        failures++;
        return;
    }
    const long before = failures;
    for (long i = 0; i < count; i++) at_point(f, text, formula::random_point(g, f.where));
    for (const sgt_vec3 &p : f.special) at_point(f, text, p);
    at_point(f, text, {0, 0, 0});
    at_point(f, text, {0, 0, g.uniform(-1, 1) * f.where.size()});
    if (failures > before && before < 40) std::printf("    %s\n", f.text.c_str());
}

// -------------------------------------------------------------------------------- elementary functions

struct function {
    const char *name;
    quad (*mine)(quad);
    void (*arb)(arb_t, const arb_t, slong);
    double lo, hi;      // of the logarithms, base 2, of the arguments
    bool positive;      // arguments only
    double shift;       // is added to them
};
void cube_root(arb_t r, const arb_t x, slong p)
{
    arb_abs(r, x);
    arb_root_ui(r, r, 3, p);
    if (arb_is_negative(x)) arb_neg(r, r);
}
const function functions[] = {
    {"exp", oracle::exponential, arb_exp, -120, 9, false, 0},
    {"log", oracle::logarithm, arb_log, -900, 900, true, 0},
    {"log near 1", oracle::logarithm, arb_log, -100, -1, false, 1},
    {"sin", oracle::sine_of, arb_sin, -200, 52.9, false, 0},
    {"cos", oracle::cosine_of, arb_cos, -200, 52.9, false, 0},
    {"tan", oracle::tangent, arb_tan, -200, 52.9, false, 0},
    {"asin", oracle::arc_sine, arb_asin, -200, 0, false, 0},
    {"acos", oracle::arc_cosine, arb_acos, -200, 0, false, 0},
    {"atan", oracle::arc_tangent, arb_atan, -200, 200, false, 0},
    {"sinh", oracle::hyperbolic_sine, arb_sinh, -200, 9, false, 0},
    {"cosh", oracle::hyperbolic_cosine, arb_cosh, -200, 9, false, 0},
    {"tanh", oracle::hyperbolic_tangent, arb_tanh, -200, 9, false, 0},
    {"cbrt", oracle::cube_root, cube_root, -900, 900, false, 0},
};
const double MOST = 0x1p-108;

// Errors are parts of the value.  (Random arguments do not come so near to a zero of sine, cosine and tangent
// that this would be unfair.)
void try_function(generator &g, const function &f, long count)
{
    const precision high(400);
    double worst = 0;
    quad at = 0;
    for (long i = 0; i < count; i++) {
        quad x = std::exp2(g.uniform(f.lo, f.hi));
        x *= 1 + quad(g.uniform(-1, 0)) * quad(0x1p-53);
        if (!f.positive && g.chance(0.5)) x = -x;
        x += f.shift;
        ball want;
        f.arb(want.x, exactly(x).x, 400);
        const quad have = f.mine(x);
        const double error = have == have ? std::fabs(((exactly(have) - want) / want).rough()) : HUGE_VAL;
        if (error > worst) worst = error, at = x;
    }
    std::printf("%-10s 2^%.1f at %.17g\n", f.name, std::log2(worst), oracle::to_double(at));
    if (!(worst <= MOST)) failures++, std::printf("FAIL %s\n", f.name);
}

// Every quadrant, and near the axes.
void try_angles(generator &g, long count)
{
    const precision high(400);
    double worst = 0;
    for (long i = 0; i < count; i++) {
        const double y = g.sign() * std::exp2(g.uniform(-60, 60));
        const double x = g.sign() * std::exp2(g.uniform(-60, 60));
        const ball have = exactly(oracle::angle_of(quad(y), quad(x)));
        ball want;
        arb_atan2(want.x, ball(y).x, ball(x).x, 400);
        worst = std::fmax(worst, std::fabs(((have - want) / want).rough()));
    }
    std::printf("%-10s 2^%.1f\n", "atan2", std::log2(worst));
    if (!(worst <= MOST)) failures++, std::printf("FAIL atan2\n");
    const quad nowhere[] = {oracle::angle_of(quad(0), quad(0)), oracle::logarithm(0), oracle::logarithm(-1),
                            oracle::arc_sine(1.5), oracle::arc_cosine(-1.5), oracle::sine_of(0x1p60)};
    for (quad x : nowhere)
        if (x == x) failures++, std::printf("FAIL a value where none is known: %g\n", oracle::to_double(x));
}

} // namespace

int main(int argc, char **argv)
{
    const char *only = nullptr;
    for (int i = 1; i + 1 < argc; i++)
        if (!std::strcmp(argv[i], "--only")) only = argv[i + 1];
    const oracle::run run(argc, argv, 40, 20261125);
    generator g(run.seed);
    for (const function &f : functions) try_function(g, f, 50 * run.count);
    try_angles(g, 50 * run.count);
    std::uint64_t number = 0;
    for (const auto &f : formula::formulas()) {
        generator own(run.seed + 7919 * ++number);
        if (!only || f->name == only) try_formula(own, *f, run.count);
    }
    std::printf("%zu formulas: %ld numbers compared, not defined at %ld points\n", formula::formulas().size(),
                compared, undefined);
    compared = undefined = 0;
    long grown = 0, refused = 0;
    for (long i = 0; i < 20 * run.count && !only; i++) {
        generator own(run.seed + 104729 * static_cast<std::uint64_t>(i));
        const formula::grown f(own, i);
        if (!formula::subject(f, false).error().empty()) {
            refused++;
            continue;
        }
        grown++;
        try_formula(own, f, 4);
    }
    std::printf("%ld random formulas: %ld numbers compared, not defined at %ld points; %ld refused\n", grown,
                compared, undefined, refused);
    std::printf("%ld failures\n", failures);
    return failures != 0;
}
