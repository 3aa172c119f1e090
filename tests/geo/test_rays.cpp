// SPDX-License-Identifier: MIT
// test_rays.cpp - look vectors from low, middle and geostationary orbits and at the limb, against quadruple
// precision.
//
//     test_rays [--rays N]     N rays for each surface (default 6000 times SAGITTA_TEST_SCALE);
//                              SAGITTA_TEST_SEED chooses others
//
// Heights are -100 m ... 100 km.  Of the rays a third looks down within the disc of the Earth, a third goes
// by the limb within 20 km, and a third is made to touch the surface, but for 0, 1e-9 m ... 1 km more or
// less.  Told of each:
//   - a hit: F in quadruple precision changes sign within t_err of t, from outside to inside, and for a ray
//     that starts inside the
//     other way; its point is on the surface to 2e-8 m, by quadruple precision and by GeographicLib's
//       Reverse;
//   - a miss: F has its least above zero; a graze: to within 1e-7 m of it;
//   - no ray is undecided; of the level of gravity none ends on the far sheet;
//   - a batch has the same bits;
//   - of a ray that starts on the surface, 0 ... 20 of the rule's own widths (sgt_ray in sagitta.h) before
//     or behind: the start
//     itself is not told, and the root behind the start is, inward and outward; of ellipsoids of any shape,
//       the first root is the first of all;
//     and `first` keeps what `single` promises.
#include "quad_earth.h"

#include <sagitta/geo.h>

#include <GeographicLib/Geocentric.hpp>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <limits>
#include <random>
#include <string>

namespace {

using earth::quad;
using earth::rounded;

constexpr double ON_SURFACE = 2e-8, TOUCH = 1e-7;

struct counts {
    long rays = 0, hits = 0, grazes = 0, misses = 0, undecided = 0, faults = 0;
    double evals = 0, off = 0, reverse = 0, t_err = 0;
    int most = 0;
};

std::mt19937_64 random_bits;
double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_bits); }
int whole(int most) { return static_cast<int>(random_bits() % static_cast<unsigned>(most)); }

sgt_vec3 direction()
{
    double z = uniform(-1, 1), turn = uniform(0, 6.283185307179586), r = std::sqrt(1 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
}
sgt_vec3 sum(double a, sgt_vec3 x, double b, sgt_vec3 y)
{
    return {a * x.x + b * y.x, a * x.y + b * y.y, a * x.z + b * y.z};
}
double dot(sgt_vec3 a, sgt_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
sgt_vec3 unit(sgt_vec3 a) { return sum(1 / std::sqrt(dot(a, a)), a, 0, a); }
sgt_vec3 square_to(sgt_vec3 a, sgt_vec3 b) { return unit(sum(1, a, -dot(a, b) / dot(b, b), b)); }

sgt_vec3 in_orbit()
{
    switch (whole(4)) {
    case 0: return sum(uniform(6.678e6, 7.4e6), direction(), 0, {});                             // low
    case 1: return sum(uniform(2.0e7, 3.0e7), direction(), 0, {});                               // middle
    case 2: { // geostationary
        double longitude = uniform(0, 6.283185307179586);
        return {42164e3 * std::cos(longitude), 42164e3 * std::sin(longitude), 0};
    }
    default: return sum(uniform(4.2e7, 4.3e7), direction(), 0, {});
    }
}

double height_of_surface()
{
    const double some[] = {0, -100, 100, 8848, 1e5};
    return whole(2) ? uniform(-100, 1e5) : some[whole(5)];
}

sgt_ray look(double h, const earth::grid *grid)
{
    sgt_ray ray = {in_orbit(), {}, 0, 0};
    double R = std::sqrt(dot(ray.o, ray.o)), length = whole(2) ? 1 : std::exp(uniform(-5, 5));
    sgt_vec3 down = sum(-1 / R, ray.o, 0, {}), across = square_to(direction(), down);
    int kind = whole(3);
    if (kind == 2) { // made to touch: the tangent at a point, backward to about the orbit
        const GeographicLib::Geocentric &wgs84 = GeographicLib::Geocentric::WGS84();
        double off = whole(4) ? std::pow(10, uniform(-9, 3)) * (whole(2) ? 1 : -1) : 0;
        double latitude = whole(8) ? uniform(-90, 90) : 90 * (whole(3) - 1), longitude = uniform(-180, 180),
               lat = latitude * std::acos(-1.0) / 180, lon = longitude * std::acos(-1.0) / 180;
        sgt_vec3 p, up = {std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat)},
                    d = square_to(direction(), up);
        wgs84.Forward(latitude, longitude, h + off + (grid ? grid->undulation(latitude, longitude) : 0), p.x,
                      p.y, p.z);
        double r = std::sqrt(dot(p, p)), back = std::sqrt(std::max(0.0, R * R - r * r));
        return {sum(1, p, -back, d), sum(length, d, 0, d), 0, 0};
    }
    double impact = kind == 0 ? uniform(0, 6.35e6) : 6.367e6 + h + uniform(-2e4, 2e4),
           sine = std::min(impact / R, 1.0), cosine = std::sqrt(1 - sine * sine);
    ray.d = sum(length * cosine, down, length * sine, across);
    if (whole(20) == 0)
        ray.o = sum(1, ray.o, uniform(0, 2) * R / length, ray.d); // on the way, inside, or behind
    return ray;
}

// The t of the least of F on the ray from tmin on: vertices of parabolas.
quad lowest(const std::function<quad(quad)> &g, const sgt_ray &ray)
{
    double along = std::sqrt(dot(ray.d, ray.d));
    quad t = -dot(ray.o, ray.d) / dot(ray.d, ray.d);
    for (double step : {3e4, 1e3, 30.0, 1.0, 0.1}) {
        quad h = step / along, a = g(t - h), b = g(t), c = g(t + h), bend = a - 2 * b + c;
        if (bend > 0) t -= h * (c - a) / (2 * bend);
    }
    return t < 0 ? quad(0) : t;
}

struct subject {
    const char *name;
    sgt_surface surface;
    std::function<quad(const earth::vec &)> F;
    std::function<double(const earth::vec &)> about; // the same, to 1e-6 m; or none:
    double bumps;                                    // F is that much off convex, at most
};

bool judge(const subject &s, const sgt_ray &ray, const sgt_hit &hit, counts &n, const char **why)
{
    auto g = [&](quad t) { return s.F(earth::at(ray, t)); };
    double along = std::sqrt(dot(ray.d, ray.d));
    bool inside = g(0) < 0;
    n.rays++, n.evals += hit.evals, n.most = std::max(n.most, hit.evals);
    if (hit.status < 0) {
        n.undecided++;
        *why = "undecided";
        return false;
    }
    if (hit.status == SGT_MISS) {
        n.misses++;
        *why = "a miss that is none";
        if (inside) return false;
        quad least = lowest(g, ray);
        if (!(g(least) > 0)) return false;
        if (s.bumps > 0 && g(least) < 2 * s.bumps) // look about
            for (int i = -200; i <= 200; i++)
                if (quad t = least + quad(i) * 400 / along; t >= 0 && s.about(earth::at(ray, t)) < -1e-6)
                    return false;
        return true;
    }
    quad t = quad(hit.t) + hit.t_lo, e = hit.t_err;
    if (hit.status == SGT_GRAZE) {
        n.grazes++;
        *why = "a graze that is none";
        quad least = g(lowest(g, ray));
        return s.bumps > 0 ? std::fabs(rounded(g(t))) < TOUCH : std::fabs(rounded(least)) < TOUCH;
    }
    n.hits++;
    double off = std::fabs(rounded(s.F(earth::exact(hit.p))));
    n.off = std::max(n.off, off), n.t_err = std::max(n.t_err, hit.t_err * along);
    *why = "a point off the surface";
    if (!(off <= ON_SURFACE)) return false;
    *why = "no change of sign within t_err of t";
    quad before = g(quad(hit.t) - e), behind = g(quad(hit.t) + e);
    if (!inside && behind > 0) // in and out again?
        if (quad least = lowest(g, ray); least > quad(hit.t) - e && least < quad(hit.t) + e)
            behind = g(least);
    if (inside ? !(before <= 0 && behind >= 0) : !(before >= 0 && behind <= 0)) return false;
    *why = "far off";
    if (!(dot(hit.p, hit.p) < 7e6 * 7e6)) return false;
    *why = "not the first";
    if (s.bumps > 0)
        for (int i = 1; i <= 60; i++)
            if (quad u = t - e - quad(i) * 2000 / along;
                u >= 0 && s.about(earth::at(ray, u)) * (inside ? -1 : 1) < -1e-6)
                return false;
    return true;
}

void run(const char *name, long count, const earth::grid *grid, const sgt_geoid *geoid, long &faults)
{
    counts n;
    auto start = std::chrono::steady_clock::now();
    const size_t block = 100;
    for (long done = 0; done < count; done += static_cast<long>(block)) {
        double h = height_of_surface();
        sgt_geodetic_height over = {0, 0, h};
        sgt_level_gravity level = {h, 0};
        sgt_geoid_height above = {geoid, h};
        subject s = {name,
                     {&sgt_geodetic_height_ops, &over},
                     [&](const earth::vec &p) { return earth::height(earth::WGS84, p) - h; },
                     nullptr,
                     0};
        if (name[0] == 'l')
            s.surface = {&sgt_level_gravity_ops, &level},
            s.F = [&](const earth::vec &p) { return earth::over_level(p, h); };
        if (grid)
            s.surface = {&sgt_geoid_height_ops, &above},
            s.F = [&](const earth::vec &p) { return grid->over(p, h); },
            s.about = [&](const earth::vec &p) { return grid->about(p, h); }, s.bumps = 220;
        std::vector<sgt_ray> rays(block);
        std::vector<double> x[6], t(block), t_err(block), p[3];
        std::vector<sgt_status> status(block);
        for (auto &v : x) v.resize(block);
        for (auto &v : p) v.resize(block);
        for (size_t i = 0; i < block; i++) {
            sgt_ray &ray = rays[i] = look(h, grid);
            x[0][i] = ray.o.x, x[1][i] = ray.o.y, x[2][i] = ray.o.z, x[3][i] = ray.d.x, x[4][i] = ray.d.y,
            x[5][i] = ray.d.z;
        }
        sgt_rays all = {{x[0].data(), x[1].data(), x[2].data()},
                        {x[3].data(), x[4].data(), x[5].data()},
                        nullptr,
                        nullptr};
        sgt_hits out = {};
        out.status = status.data(), out.t = t.data(), out.t_err = t_err.data();
        for (int i = 0; i < 3; i++) out.p[i] = p[i].data();
        sgt_intersect_batch(s.surface, block, all, out, nullptr);
        for (size_t i = 0; i < block; i++) {
            const sgt_ray &ray = rays[i];
            sgt_hit hit = sgt_intersect(s.surface, ray, nullptr);
            const char *why = "";
            bool good = judge(s, ray, hit, n, &why);
            if (good && hit.status == SGT_HIT && !grid && name[0] == 'g') {
                double latitude, longitude, high;
                GeographicLib::Geocentric::WGS84().Reverse(hit.p.x, hit.p.y, hit.p.z, latitude, longitude,
                                                           high);
                n.reverse = std::max(n.reverse, std::fabs(high - h));
                if (!(std::fabs(high - h) <= ON_SURFACE)) good = false, why = "Reverse has another height";
            }
            auto same = [](double a, double b) {
                return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
            };
            if (!(status[i] == hit.status && same(t[i], hit.t) && same(t_err[i], hit.t_err) &&
                  same(p[0][i], hit.p.x) && same(p[1][i], hit.p.y) && same(p[2][i], hit.p.z)))
                good = false, why = "the batch has other bits";
            if (!good && ++n.faults <= 5)
                std::printf("%s, h = %.17g: %s: %s t = %.17g t_err = %g [%.17g, %.17g]\n    o = %a %a %a\n   "
                            " d = %a %a %a\n",
                            name, h, why, sgt_status_text(hit.status), hit.t, hit.t_err, hit.lo, hit.hi,
                            ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z);
        }
    }
    double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf(
        "%s: %ld rays: %ld hits, %ld misses, %ld grazes, %ld undecided; off the surface at most %.2g m "
        "(Reverse %.2g), t_err at most %.2g m; %.2f evaluations a ray, at most %d; %ld faults; %.0f s\n",
        name, n.rays, n.hits, n.misses, n.grazes, n.undecided, n.off, n.reverse, n.t_err,
        n.evals / static_cast<double>(n.rays), n.most, n.faults, seconds);
    faults += n.faults + (n.hits == 0) + (n.misses == 0);
}

// A ray from on the surface, to some widths of the start.  Convex ones alone: there are two roots, the
// start and the other.
void from_surface(const char *name, long count, long &faults)
{
    long wrong = 0, undecided = 0, inward = 0, at_start = 0, narrowed = 0;
    for (long i = 0; i < count; i++) {
        double h = height_of_surface(), latitude = uniform(-90, 90), longitude = uniform(-180, 180);
        sgt_geodetic_height over = {0, 0, h};
        sgt_level_gravity level = {h, 0};
        bool gravity = name[0] == 'l';
        sgt_surface s = gravity ? sgt_surface{&sgt_level_gravity_ops, &level}
                                : sgt_surface{&sgt_geodetic_height_ops, &over};
        auto F = [&](const earth::vec &p) {
            return gravity ? earth::over_level(p, h) : earth::height(earth::WGS84, p) - h;
        };
        sgt_vec3 p, n, d = direction();
        GeographicLib::Geocentric::WGS84().Forward(latitude, longitude, h, p.x, p.y, p.z);
        for (int k = 0; k < 8; k++) { // of a level of gravity heights are some kilometres off
            s.ops->value(s.self, p, &n);
            p = sum(1, p, -rounded(F(earth::exact(p))) / dot(n, n), n);
        }
        double steep = dot(n, d) / std::sqrt(dot(n, n));
        if (!(std::fabs(steep) > 1e-3)) continue; // it nearly touches: above
        sgt_ray ray = {p, d, 0, 0};
        quad along = dot(n, d), root = 0; // Newton's method, to where the start's own root is
        for (int k = 0; k < 10; k++) root -= F(earth::at(ray, root)) / along;
        double spread = std::fabs(p.x * n.x) + std::fabs(p.y * n.y) + std::fabs(p.z * n.z),
               width = 0x1p-48 * spread / std::fabs(dot(n, d));
        double step = whole(3) ? uniform(-20, 20) : uniform(-1, 4);
        ray.tmin = rounded(root) - step * width, ray.tmax = std::numeric_limits<double>::infinity();
        // Before the start by more than `most` the root there counts; behind by less than `least`, or
        // after, it does not.
        bool counts = step > 4, gone = step < 0.5;
        sgt_hit hit = sgt_intersect(s, ray, nullptr);
        bool inside = steep < 0, told_start = hit.status > 0 && std::fabs(hit.t - rounded(root)) < 1;
        inward += inside, at_start += told_start, undecided += hit.status < 0;
        const char *why = nullptr;
        if (gone && told_start) why = "the start is told";
        if (counts && hit.status >= 0 && !told_start) why = "a root that counts is not";
        if (inside && hit.status == SGT_MISS) why = "a miss, inward"; /* whichever of the two counts */
        if (gone && !inside && hit.status > 0) why = "a hit, outward";
        // `first`, if single: its one root is the first that counts.  Behind the other one the ray is
        // outside.
        const sgt_span first = s.ops->first(s.self, &ray);
        const bool at_root = root >= first.lo && root <= first.hi, at_other = F(earth::at(ray, first.hi)) > 0;
        narrowed += first.single;
        const bool start_alone = gone && inside && at_root && root > ray.tmin;
        if (first.single && start_alone) why = "first: the start alone, which does not count";
        if (first.single && gone && inside && !at_other) why = "first: the root that counts is not there";
        if (first.single && counts && !at_root) why = "first: the root behind the start is not there";
        if (why && ++wrong <= 5)
            std::printf("%s, h = %.17g: %s, %g widths before: %s t = %.17g\n    o = %a %a %a\n    d = %a %a "
                        "%a tmin %a\n",
                        name, h, why, step, sgt_status_text(hit.status), hit.t, p.x, p.y, p.z, d.x, d.y, d.z,
                        ray.tmin);
    }
    std::printf("%s: %ld rays from on it, %ld inward: the start told of %ld, %ld undecided, first single %ld "
                "times; %ld faults\n",
                name, count, inward, at_start, undecided, narrowed, wrong);
    faults += wrong + (at_start == 0) + (narrowed == 0);
}

// Of ellipsoids of any shape, from a start on the surface or some roundings of F beside: the first root is
// the first of all roots, and under proof too.  (How far from the start a root counts depends on t_err;
// that the answers agree does not.)
void first_of_all(long count, long &faults)
{
    long wrong = 0, at_start = 0, behind = 0;
    for (long i = 0; i < count; i++) {
        double f = whole(3) ? uniform(-5, 0.9) : uniform(-0.1, 0.1), a = std::exp(uniform(-3, 18));
        sgt_geodetic_height over = {a, f, 0};
        sgt_surface s = {&sgt_geodetic_height_ops, &over};
        sgt_vec3 up = direction(), d = direction(), p = {up.x * a, up.y * a, up.z * a * (1 - f)}, n;
        for (int k = 0; k < 8; k++) {
            double g = s.ops->value(s.self, p, &n);
            p = sum(1, p, -g, n);
        }
        if (!(std::fabs(dot(n, d)) > 0.05)) continue;
        if (dot(n, d) > 0 && whole(4)) d = sum(-1, d, 0, d);
        p = sum(1, p, uniform(-1, 8) * s.ops->rounding(s.self, p), n);
        sgt_ray ray = {p, d, 0, std::numeric_limits<double>::infinity()};
        sgt_hit all[4];
        int roots = sgt_intersect_all(s, ray, 4, all, nullptr);
        for (int proof = 0; proof < 3; proof++) {
            sgt_options o = {};
            o.pick = SGT_FIRST, o.proof = static_cast<sgt_proof>(proof);
            sgt_hit hit = sgt_intersect(s, ray, &o);
            if (hit.status < 0) continue;
            bool start_told = roots > 0 && all[0].status == SGT_HIT && all[0].t < 1e-9 * a;
            at_start += start_told, behind += roots == 1 && all[0].status == SGT_HIT && all[0].t > 1e-9 * a;
            const char *why = nullptr;
            if (roots > 0 && all[0].status == SGT_HIT && hit.status == SGT_MISS)
                why = "a miss, and there are roots";
            if (roots > 0 && all[0].status == SGT_HIT && hit.status > 0 &&
                hit.t - hit.t_err > all[0].t + all[0].t_err)
                why = "not the first";
            if (why && ++wrong <= 5)
                std::printf("ellipsoid a = %a f = %a: %s under proof %d: %s t = %.17g, the first of %d: "
                            "%.17g +- %g\n    o = %a %a %a\n    d = %a %a %a\n",
                            a, f, why, proof, sgt_status_text(hit.status), hit.t, roots, all[0].t,
                            all[0].t_err, p.x, p.y, p.z, d.x, d.y, d.z);
        }
    }
    std::printf(
        "ellipsoids: %ld rays from on them: the start told of %ld, the other side of %ld; %ld faults\n",
        count, at_start, behind, wrong);
    faults += wrong + (at_start == 0) + (behind == 0);
}

} // namespace

int main(int argc, char **argv)
{
    const char *seed = std::getenv("SAGITTA_TEST_SEED"), *scale = std::getenv("SAGITTA_TEST_SCALE");
    unsigned long long number = seed ? std::strtoull(seed, nullptr, 0) : 1;
    long count = static_cast<long>(6000 * (scale ? std::atof(scale) : 0.5)), faults = 0;
    if (argc == 3 && std::string(argv[1]) == "--rays") count = std::atol(argv[2]);
    count = std::max(count, 100L);
    std::printf("rays about the Earth: SAGITTA_TEST_SEED=%llu\n", number);
    random_bits.seed(number);
    run("geodetic_height", count, nullptr, nullptr, faults);
    run("level_gravity", count, nullptr, nullptr, faults);
    from_surface("geodetic_height", count, faults);
    from_surface("level_gravity", count, faults);
    first_of_all(count, faults);
    char path[4096];
    sgt_error error = {};
    earth::grid grid;
    if (!sgt_geoid_find(path, sizeof path, nullptr)) {
        std::printf("geoid: skipped, egm96_15.gtx is not installed\n");
    } else if (sgt_geoid *geoid = sgt_geoid_open(path, &error); geoid && grid.read(path)) {
        run("geoid", count, &grid, geoid, faults);
        sgt_geoid_close(geoid);
    } else {
        std::printf("geoid: %s\n", geoid ? path : error.words);
        faults++;
    }
    return faults ? 1 : 0;
}
