// SPDX-License-Identifier: MIT
// Rays that leave a departure, graze it or come from nearby: is a root passed over?
//
// F is looked at along each ray in doubles, at some 180 points from 1e-7 to 1e4 of the surface's size, with
// no knowledge of the library.  Where it changes its sign, the root between is found by bisection in 113
// bits.
// If it is within the rim, certainly not the start, and before the hit (or there is no hit), a root has
// been lost.  Starts are points of the surface as the formula has them, or hits; directions of the whole
// sphere, and along the surface.  Each batch of 200 has to answer as the single rays do, to the last bit and
// evaluation.
#include "as_batch.h"
#include "specimens.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

using namespace catalogue;

namespace {

struct counted { long rays, hits, misses, undecided, lost, differ; } all;

double rough_at(const formula<double> &f, const sgt_ray &r, double t)
{
    return f(r.o.x + t * r.d.x, r.o.y + t * r.d.y, r.o.z + t * r.d.z);
}

quad exact_at(const formula<quad> &f, const sgt_ray &r, quad t)
{
    return f(quad(r.o.x) + t * quad(r.d.x), quad(r.o.y) + t * quad(r.d.y), quad(r.o.z) + t * quad(r.d.z));
}

quad size_of(quad x) { return x < 0 ? -x : x; }

bool draw(generator &g, const specimen &s, const formula<double> &rough, sgt_ray *r)
{
    const double radius = s.h * std::sqrt(g.uniform(0, 0.95)) * (g.chance(0.2) ? g.log_uniform(1e-6, 1) : 1),
                 about = g.uniform(0, 6.28), x = radius * std::cos(about), y = radius * std::sin(about),
                 z = -rough(x, y, 0.0), to = g.uniform(0, 6.28), up = g.uniform(-1, 1),
                 across = std::sqrt(1 - up * up), e = 0x1p-20 * s.h;
    if (!(z == z)) return false;
    sgt_vec3 d = {across * std::cos(to), across * std::sin(to), up};
    const double nx = (rough(x + e, y, 0.0) - rough(x - e, y, 0.0)) / (2 * e),
                 ny = (rough(x, y + e, 0.0) - rough(x, y - e, 0.0)) / (2 * e);
    if (g.chance(0.4)) d.z = -(nx * d.x + ny * d.y) + g.sign() * g.log_uniform(1e-4, 0.5);
    *r = {{x, y, z}, d, 0, INFINITY};
    if (g.chance(0.45)) {
        const double back = s.h * g.log_uniform(1e-5, 1e2) * (g.chance(0.1) ? 1e3 : 1);
        r->o = {x - back * d.x, y - back * d.y, z - back * d.z};
    } else if (g.chance(0.5)) {
        const sgt_hit hit = sgt_intersect(s.s, {{x, y, z - s.h}, {0, 0, 1}, 0, INFINITY}, nullptr);
        if (hit.status != SGT_HIT) return false;
        r->o = hit.p;
    }
    if (g.chance(0.1)) r->tmax = s.h * g.log_uniform(0.1, 10);
    return true;
}

// The places at which F is looked at, up to `end`.
std::vector<double> places(const sgt_ray &r, double h, double end)
{
    const double first = 1e-7 * h, last = std::min(end, 1e4 * h), far = std::hypot(r.o.x, r.o.y, r.o.z) + h,
                 from = std::max(first, far - 3 * h), to = std::min(last, far + 3 * h);
    std::vector<double> t;
    for (int j = 0; j <= 90 && last > first; j++) {
        t.push_back(first * std::pow(last / first, j / 90.0));
        if (to > from) t.push_back(from + (to - from) * j / 90);
    }
    std::sort(t.begin(), t.end());
    return t;
}

// Is there a root in [left, right] that a hit, or a miss, has passed over?
bool passed_over(const specimen &s, const formula<quad> &exact, const sgt_ray &r, const sgt_hit &got,
                 quad left, quad right)
{
    const quad before = exact_at(exact, r, left), behind = exact_at(exact, r, right), h = quad(s.h);
    if (!(before * behind < 0)) return false;
    for (int i = 0; i < 70; i++) {
        const quad t = (left + right) / 2, f = exact_at(exact, r, t);
        if (!(f == f)) return false;
        (f * before > 0 ? left : right) = t;
    }
    const quad x = quad(r.o.x) + left * quad(r.d.x), y = quad(r.o.y) + left * quad(r.d.y),
               jump = size_of(exact_at(exact, r, left) - exact_at(exact, r, right)), rim = quad(s.rim);
    const bool inside = !(s.rim > 0) || x * x + y * y < rim * rim * quad(1 - 1e-9);
    return inside && jump < quad(1e-9) * h && left > quad(1e-7) * h &&
           left < quad(r.tmax) * quad(1 - 1e-12) &&
           (got.status == SGT_MISS || left < quad(got.t) - 4 * quad(got.t_err));
}

void ask(const char *type, const specimen &s, const std::vector<sgt_ray> &rays, const formula<double> &rough)
{
    const formula<quad> exact(s.s);
    const as_batch batch(s.s, rays);
    for (std::size_t i = 0; i < rays.size(); i++) {
        const sgt_ray &r = rays[i];
        const sgt_hit one = sgt_intersect(s.s, r, nullptr);
        const bool same = batch.same(i, one);
        all.rays++, all.hits += one.status > 0, all.misses += one.status == SGT_MISS;
        all.undecided += one.status < 0;
        if (!same && all.differ++ < 3)
            std::printf("%s: %s by %d evaluations, in a batch %s by %d\n", type, sgt_status_text(one.status),
                        one.evals, sgt_status_text(batch.status[i]), batch.evals[i]);
        if (one.status < 0) continue;
        double last = NAN, f_last = NAN;
        for (double at : places(r, s.h, one.status > 0 ? one.t - 4 * one.t_err : r.tmax)) {
            const double f = rough_at(rough, r, at);
            if (f * f_last < 0 && passed_over(s, exact, r, one, quad(last), quad(at))) {
                if (all.lost++ < 3) {
                    std::printf("%s: a root before %.17g is lost, %s %.17g\n    o %.17g %.17g %.17g, d %.17g "
                                "%.17g %.17g, up to %.17g\n    ",
                                type, at, sgt_status_text(one.status), one.t, r.o.x, r.o.y, r.o.z, r.d.x,
                                r.d.y, r.d.z, r.tmax);
                    print_surface(s.s);
                }
                break;
            }
            last = at, f_last = f;
        }
    }
}

}  // namespace

int main()
{
    const char *seed = std::getenv("SAGITTA_TEST_SEED"), *scale = std::getenv("SAGITTA_TEST_SCALE"),
               *only = std::getenv("SAGITTA_TEST_TYPE");
    const std::uint64_t from = seed ? std::strtoull(seed, nullptr, 0) : 47;
    const int rounds = static_cast<int>(6 * (scale ? std::atof(scale) : 1)) + 1;
    bool good = true;
    std::printf("seed %llu\n", static_cast<unsigned long long>(from));
    for (const char *type : sags) {
        if (only && std::string(only) != type) continue;
        generator g(from ^ (static_cast<std::uint64_t>(type[0]) << 8 | static_cast<std::uint64_t>(type[2])));
        all = {};
        for (int round = 0; round < rounds; round++) {
            const specimen s = random_specimen(g, type);
            const formula<double> rough(s.s);
            std::vector<sgt_ray> rays;
            for (int i = 0; i < 600 && rays.size() < 200; i++) {
                sgt_ray r;
                if (draw(g, s, rough, &r)) rays.push_back(r);
            }
            if (!rays.empty()) ask(type, s, rays, rough);
        }
        std::printf("%-14s %7ld rays, %6ld hits, %6ld misses, %4ld undecided, %ld roots lost, %ld differ in "
                    "a batch\n",
                    type, all.rays, all.hits, all.misses, all.undecided, all.lost, all.differ);
        good = good && all.lost == 0 && all.differ == 0 && all.undecided <= all.rays / 3;
    }
    return !good;
}
