// SPDX-License-Identifier: MIT
// cases.h - random surfaces and rays, the same wherever a test wants some.
//
// A generator of its own (splitmix64), so that a seed means the same cases with
// every standard library.  What is drawn:
//   surface   conic or even asphere in equal parts; R of either sign, log-uniform
//             from 1e-3 to 1e6, infinite in a tenth; k of every kind from -1e3 to
//             1e3, with 0, -1 and -1 +- 1e-12 among them; an aperture h that the
//             conic has room for; each term of an asphere up to h/10 at the rim;
//             h as the surface's semi_diameter in half the cases;
//   ray       aimed at a point of the surface inside h, or past its edge, in equal
//             parts; up to 80 degrees from the axis, either way; the origin from on
//             that point to 1e12 times h or |R| away, log-uniform; the direction of
//             unit length or of any from 1e-3 to 1e3;
//   interval  the half-line, the whole line, or bounded.
#ifndef ORACLE_CASES_H
#define ORACLE_CASES_H

#include <sagitta/surfaces.h>

#include <cinttypes>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace oracle {

class generator {
public:
    explicit generator(std::uint64_t seed) : state_(seed) {}
    std::uint64_t bits()
    {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    double uniform(double lo, double hi)
    {
        return lo + (hi - lo) * std::ldexp(static_cast<double>(bits() >> 11), -53);
    }
    double log_uniform(double lo, double hi) { return std::exp(uniform(std::log(lo), std::log(hi))); }
    bool chance(double p) { return uniform(0, 1) < p; }
    double sign() { return chance(0.5) ? 1 : -1; }
    int below(int n) { return static_cast<int>(uniform(0, n)); }

private:
    std::uint64_t state_;
};

struct test_case {
    sgt_even_asphere surface; // a conic is one without terms
    bool asphere;
    sgt_ray ray;
    bool aimed; // at a point inside h
    bool on_surface;
    bool narrow; // a graze, or near a rim
    double h;
};

// The same for both; the caller keeps *c in place while it is used.
inline sgt_surface as_surface(const test_case &t, sgt_conic *conic)
{
    *conic = sgt_conic{t.surface.c, t.surface.k, t.surface.semi_diameter};
    return t.asphere ? sgt_surface{&sgt_even_asphere_ops, &t.surface} : sgt_surface{&sgt_conic_ops, conic};
}

inline double random_conic_constant(generator &g)
{
    switch (g.below(8)) {
    case 0: return 0;
    case 1: return -1;
    case 2: return -1 + g.sign() * 1e-12;
    case 3: return g.uniform(-1e3, 1e3);
    case 4:
    case 5: return g.sign() * g.log_uniform(1e-3, 1e3);
    default: return g.uniform(-3, 3);
    }
}

// The sag in double, near enough to aim by.
inline double rough_sag(const sgt_even_asphere &s, double r2)
{
    const double u = 1 - (1 + s.k) * s.c * s.c * r2;
    double sag = 0;
    for (int i = 7; i >= 0; i--) sag = (sag + s.a[i]) * r2;
    return sag + s.c * r2 / (1 + std::sqrt(u > 0 ? u : 0));
}

inline test_case random_case(generator &g)
{
    test_case t = {};
    const double pi = 3.141592653589793;
    const bool flat = g.chance(0.1);
    const double R = g.sign() * g.log_uniform(1e-3, 1e6);
    sgt_even_asphere &s = t.surface;
    s.c = flat ? 0 : 1 / R;
    s.k = random_conic_constant(g);
    t.asphere = g.chance(0.5);

    // An aperture, up to the whole domain where that is bounded and not far out.
    const double e = (1 + s.k) * s.c * s.c, domain = e > 0 ? 1 / std::sqrt(e) : HUGE_VAL;
    double h = flat ? std::fabs(R) : std::fabs(R) * g.log_uniform(0.01, 10);
    if (h > domain) h = domain * (g.chance(0.3) ? 1 : g.uniform(0.05, 1));
    t.h = h;
    if (g.chance(0.5)) s.semi_diameter = h;
    if (t.asphere) {
        const int terms = 1 + g.below(8);
        for (int i = 0; i < terms; i++)
            if (g.chance(0.8)) s.a[i] = g.uniform(-0.1, 0.1) * h / std::pow(h, 2 * i + 2);
    }

    t.aimed = g.chance(0.5);
    double r = t.aimed ? h * std::sqrt(g.uniform(0, 1)) : h * (1 + g.log_uniform(1e-6, 3));
    if (g.chance(0.02)) r = 0;
    const double at = g.uniform(0, 2 * pi), z = rough_sag(s, t.aimed ? r * r : std::fmin(r * r, 1.1 * h * h));
    const sgt_vec3 target = {r * std::cos(at), r * std::sin(at), z};

    const double tilt = g.chance(0.02) ? 0 : g.uniform(0, 80) * pi / 180, about = g.uniform(0, 2 * pi),
                 way = g.sign();
    const double length = g.chance(0.5) ? 1 : g.log_uniform(1e-3, 1e3);
    const sgt_vec3 d = {length * std::sin(tilt) * std::cos(about), length * std::sin(tilt) * std::sin(about),
                        way * length * std::cos(tilt)};

    const double unit = flat || g.chance(0.5) ? h : std::fabs(R);
    t.on_surface = g.chance(0.1);
    double distance = t.on_surface ? 0 : unit * g.log_uniform(1e-12, 1e12);
    if (g.chance(0.15)) distance = -distance;
    const double away = distance / length;
    t.ray.o = {target.x - away * d.x, target.y - away * d.y, target.z - away * d.z};
    t.ray.d = d;
    switch (g.below(4)) {
    case 0:
    case 1: break; // the half-line
    case 2:
        t.ray.tmin = -HUGE_VAL;
        t.ray.tmax = HUGE_VAL;
        break;
    default: {
        const double span = unit / length;
        t.ray.tmin = away + g.sign() * span * g.log_uniform(1e-4, 10);
        t.ray.tmax = t.ray.tmin + span * g.log_uniform(1e-2, 100);
        if (t.ray.tmin == 0 && t.ray.tmax == 0) t.ray.tmax = 1;
        if (g.chance(0.2)) t.ray.tmin = -HUGE_VAL;
        else if (g.chance(0.2)) t.ray.tmax = HUGE_VAL;
    }
    }
    return t;
}

// Rays from the side, past the rim, and from afar.  In a half the terms are those of a lens, so that the
// sag is bent in one way.
inline test_case random_side_case(generator &g)
{
    test_case t = random_case(g);
    const double pi = 3.141592653589793, at = g.uniform(0, 2 * pi), about = g.uniform(0, 2 * pi);
    const double weaker = g.chance(0.5) ? g.log_uniform(1e-5, 0.1) : 1;
    for (double &a : t.surface.a) a *= weaker;
    const int kind = g.below(3); // 0: from the side; 1: past the rim; 2: from afar
    const double r = t.h * (kind == 1 ? 1 + g.log_uniform(1e-3, 10) : std::sqrt(g.uniform(0, 1))),
                 z = rough_sag(t.surface, std::fmin(r * r, t.h * t.h)) * g.uniform(0.9, 1.1);
    const double slope = kind == 0 ? g.log_uniform(1e-4, 0.3) : std::tan(g.uniform(0.2, 1.5)),
                 side = 1 / std::sqrt(1 + slope * slope),
                 away = t.h * (kind == 2 ? g.log_uniform(1e2, 1e8) : g.log_uniform(1e-2, 1e2));
    t.ray.d = {side * std::cos(about), side * std::sin(about), g.sign() * side * slope};
    t.ray.o = {r * std::cos(at) - away * t.ray.d.x, r * std::sin(at) - away * t.ray.d.y,
               z - away * t.ray.d.z};
    t.ray.tmin = 0, t.ray.tmax = g.chance(0.7) ? HUGE_VAL : away * g.uniform(0.5, 3);
    t.aimed = kind != 1, t.on_surface = false;
    return t;
}

// What the above draws too seldom: rays that graze (1e-12 to 0.1 rad from a tangent plane),
// and rays that meet the surface next to the rim of its domain or of its semi_diameter
// (1e-16 to 1e-2 of it, either side).
inline test_case random_narrow_case(generator &g)
{
    test_case t = random_case(g);
    t.narrow = true;
    t.on_surface = false;
    const sgt_even_asphere &s = t.surface;
    const double e = (1 + s.k) * s.c * s.c, domain = e > 0 ? 1 / std::sqrt(e) : HUGE_VAL,
                 pi = 3.141592653589793;
    const bool graze = g.chance(0.5);
    const double rim = domain < 100 * t.h && (s.semi_diameter == 0 || g.chance(0.5)) ? domain : t.h;
    const double r = graze ? t.h * std::sqrt(g.uniform(0, 1))
                           : rim * (1 + g.sign() * g.log_uniform(1e-16, 1e-2)),
                 at = g.uniform(0, 2 * pi);
    const double r2 = r * r, u = 1 - e * r2;
    double slope = u > 0 ? s.c / std::sqrt(u) : 0, power = 1; // ds/dr / r
    for (int i = 0; i < 8; i++, power *= r2) slope += (2 * i + 2) * s.a[i] * power;
    slope *= r;
    const sgt_vec3 target = {r * std::cos(at), r * std::sin(at), rough_sag(s, r2)};
    const double length = std::sqrt(t.ray.d.x * t.ray.d.x + t.ray.d.y * t.ray.d.y + t.ray.d.z * t.ray.d.z);
    if (graze) {
        // In the tangent plane: `out` is the meridian's tangent, across it the other; then lifted.
        const double m = std::sqrt(1 + slope * slope), about = g.uniform(0, 2 * pi),
                     lift = g.sign() * g.log_uniform(1e-12, 0.1);
        const double out = std::cos(about) / m, across = std::sin(about);
        const double radial = out - lift * slope / m, axial = out * slope + lift / m;
        t.ray.d = {length * (radial * std::cos(at) - across * std::sin(at)),
                   length * (radial * std::sin(at) + across * std::cos(at)), length * axial};
    }
    const double away = g.sign() * t.h * g.log_uniform(1e-2, g.chance(0.5) ? 1e2 : 1e10) / length;
    t.ray.o = {target.x - away * t.ray.d.x, target.y - away * t.ray.d.y, target.z - away * t.ray.d.z};
    t.ray.tmin = -HUGE_VAL;
    t.ray.tmax = HUGE_VAL;
    if (g.chance(0.3)) t.ray.tmin = t.ray.tmax = 0;
    return t;
}

// The ends as the header reads them.
inline void ends_of(const sgt_ray &r, double *tmin, double *tmax)
{
    *tmin = r.tmin;
    *tmax = r.tmax == 0 && r.tmin == 0 ? HUGE_VAL : r.tmax;
}

// Everything of a case in hexadecimal: c k semi_diameter a[8] o d tmin tmax.
inline void print_case(std::FILE *out, const test_case &t)
{
    const sgt_even_asphere &s = t.surface;
    std::fprintf(out, "%a %a %a ", s.c, s.k, s.semi_diameter);
    for (double a : s.a) std::fprintf(out, "%a ", a);
    const sgt_ray &r = t.ray;
    std::fprintf(out, "%a %a %a %a %a %a %a %a", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin, r.tmax);
}

inline bool read_case(const char *text, test_case *t)
{
    double v[19];
    char *end = nullptr;
    for (double &x : v) {
        x = std::strtod(text, &end);
        if (end == text) return false;
        text = end;
    }
    *t = test_case();
    t->surface = sgt_even_asphere{v[0], v[1], v[2], {v[3], v[4], v[5], v[6], v[7], v[8], v[9], v[10]}};
    for (double a : t->surface.a) t->asphere = t->asphere || a != 0;
    t->ray = sgt_ray{{v[11], v[12], v[13]}, {v[14], v[15], v[16]}, v[17], v[18]};
    t->h = 1;
    return true;
}

// SAGITTA_TEST_SCALE and SAGITTA_TEST_SEED, or --count N and --seed S.
struct run {
    std::uint64_t seed;
    long count;
    const char *replay;
    run(int argc, char **argv, long standard, std::uint64_t standard_seed)
        : seed(standard_seed), replay(nullptr)
    {
        const char *scale = std::getenv("SAGITTA_TEST_SCALE");
        count = static_cast<long>(static_cast<double>(standard) * (scale ? std::atof(scale) : 0.5));
        if (const char *e = std::getenv("SAGITTA_TEST_SEED")) seed = std::strtoull(e, nullptr, 0);
        for (int i = 1; i + 1 < argc; i += 2) {
            if (!std::strcmp(argv[i], "--seed")) seed = std::strtoull(argv[i + 1], nullptr, 0);
            else if (!std::strcmp(argv[i], "--count")) count = std::strtol(argv[i + 1], nullptr, 0);
            else if (!std::strcmp(argv[i], "--replay")) replay = argv[i + 1];
        }
        if (count < 1) count = 1;
        if (!replay) std::printf("seed %" PRIu64 ", count %ld\n", seed, count);
    }
};

} // namespace oracle
#endif
