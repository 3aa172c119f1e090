// SPDX-License-Identifier: MIT
// How good dt/do is where rays graze, against F of formulas.h in 113 bits: what sensitivity.h promises
// ("HOW GOOD").
//
// Rays meet each type at angles down to 1e-8 from the tangent plane.  The root near t is polished in 113
// bits; with the gradient n there dt/do is -n / s, s = n . d.  With u = 2^-53, the error may be, of the
// largest component,
//
//     PART u c + p_err (|H d| / |s| + |H| / |n|),    c = |n| |d| / |s|:
//
// the rounding of s, and what s and n change by within p_err of p, or u times the surface's size.  Where a
// root is known to u c lengths (F has no more than doubles) the second is u c^2.  Conics and even aspheres
// polish the roots of grazing rays in twice the precision: of them it is within TWICE u c besides.
#include "../catalogue/specimens.h"

#include <sagitta/sensitivity.h>

#include <algorithm>

using namespace catalogue;
using oracle::magnitude;

namespace {

typedef dual<quad, 3> number;
struct v3 { quad x, y, z; };
v3 wide(const sgt_vec3 &a) { return {a.x, a.y, a.z}; }
v3 operator+(const v3 &a, const v3 &b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
v3 operator*(quad s, const v3 &a) { return {s * a.x, s * a.y, s * a.z}; }
quad dot(const v3 &a, const v3 &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
quad length(const v3 &a) { return square_root(dot(a, a)); }
v3 cross(const v3 &a, const v3 &b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

struct at { quad f; v3 n; };
at level_at(const formula<number> &f, const v3 &p)
{
    const number g = f(number::variable(p.x, 0), number::variable(p.y, 1), number::variable(p.z, 2));
    return {g.a, {g.v[0], g.v[1], g.v[2]}};
}

constexpr double PART = 8, TWICE = 64;
long failures;

void grazing(generator &g, const std::string &type, long count)
{
    const bool twice = type == "conic" || type == "asphere";
    long met = 0, steep = 0, over = 0;
    double worst = 0, worst_linear = 0, condition = 0;
    for (long i = 0; i < count; i++) {
        specimen s = {};
        if (twice) {
            s.type = type, s.h = g.uniform(0.5, 20), s.sag = true;
            double c, k;
            random_base(g, s.h, &c, &k);
            const double a = g.uniform(-0.02, 0.02) * s.h;
            if (type == "conic") s.s = {&sgt_conic_ops, s.keep(sgt_conic{c, k, 0})};
            else
                s.s = {&sgt_even_asphere_ops,
                       s.keep(sgt_even_asphere{c, k, s.h, {0, a / std::pow(s.h, 4), a / std::pow(s.h, 6)}})};
        } else {
            s = random_specimen(g, type);
        }
        const formula<double> rough(s.s);
        const formula<number> f(s.s);
        for (int j = 0; j < 4; j++) {
            sgt_vec3 near = random_point(g, s, rough, 0.8);
            if (s.sag) near.z = -rough(near.x, near.y, 0.0);
            const v3 p = wide(near);
            const at a = level_at(f, p);
            if (!(length(a.n) > 0)) continue;
            const v3 n = (1 / length(a.n)) * a.n,
                     any = {g.uniform(-1, 1), g.uniform(-1, 1), g.uniform(-1, 1)};
            v3 u = cross(n, any);
            if (!(length(u) > 0)) continue;
            u = (1 / length(u)) * u;
            const double tilt = g.sign() * g.log_uniform(1e-8, 1), away = s.h * g.log_uniform(1e-3, 10);
            const double by = g.chance(0.5) ? 1 : g.log_uniform(0.1, 10);
            const v3 d = quad(by) * (u + quad(tilt) * n), o = p + quad(-away / by) * d;
            const sgt_vec3 start = {plain(o.x), plain(o.y), plain(o.z)},
                           along = {plain(d.x), plain(d.y), plain(d.z)};
            const sgt_ray ray = {start, along, -HUGE_VAL, HUGE_VAL};
            sgt_options near_seed = {};
            near_seed.pick = g.chance(0.5) ? SGT_NEAR_SEED : SGT_FIRST;
            sgt_ray half = ray;
            if (near_seed.pick == SGT_FIRST) half.tmin = away / by * g.uniform(0, 1);
            const sgt_hit h = sgt_intersect(s.s, half, &near_seed);
            if (h.status != SGT_HIT) continue;
            const v3 from = wide(ray.o), way = wide(ray.d);
            quad t = quad(h.t) + h.t_lo;
            at root = {};
            bool found = false;
            for (int k = 0; k < 12 && !found; k++) {
                root = level_at(f, from + t * way);
                const quad step = root.f / dot(root.n, way);
                if (!(magnitude(step) < magnitude(quad(h.t_err)) * 4 + quad(1e-20) * magnitude(t))) break;
                t = t - step;
                found = magnitude(step) <= quad(1e-24) * s.h;
            }
            if (!found) continue;
            const quad slope = dot(root.n, way);
            const double c = plain(length(root.n) * length(way) / magnitude(slope));
            // H d p_err by a difference along the ray.
            const quad off_p = std::max(quad(h.p_err), quad(0x1p-53 * s.h)), e = off_p / length(way);
            const v3 ahead = level_at(f, from + (t + e) * way).n, back = level_at(f, from + (t - e) * way).n;
            quad turned2 = 0;
            const v3 axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, place = from + t * way;
            for (const v3 &axis : axes) {
                const v3 turn = level_at(f, place + off_p * axis).n +
                                quad(-1) * level_at(f, place + (-off_p) * axis).n;
                turned2 += dot(turn, turn) / 4;
            }
            const double bent = plain(length(ahead + quad(-1) * back) * length(way) / (2 * magnitude(slope)) +
                                      square_root(turned2) / length(root.n));
            if (!(bent < 0.1) || !(c < 1e9)) {
                steep++;
                continue;
            }
            sgt_change by_o[3];
            sgt_differentiate(s.s, &ray, &h, by_o, nullptr);
            const quad exact[3] = {-root.n.x / slope, -root.n.y / slope, -root.n.z / slope};
            quad off = 0, size = 0;
            for (int k = 0; k < 3; k++) {
                off = std::max(off, magnitude(exact[k] - by_o[k].t));
                size = std::max(size, magnitude(exact[k]));
            }
            const double part = plain(off / size), linear = part / (0x1p-53 * c);
            double most = PART * 0x1p-53 * c + bent;
            if (twice) most = std::min(most, TWICE * 0x1p-53 * c);
            met++, condition = std::max(condition, c);
            worst = std::max(worst, part / most), worst_linear = std::max(worst_linear, linear);
            if (part <= most) continue;
            over++;
            if (failures++ >= 5) continue;
            std::printf("FAIL %s: dt/do off by %.3g of itself, at most %.3g (condition %.3g, bent %.3g)\n",
                        type.c_str(), part, most, c, bent);
            std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}}\n", ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y,
                        ray.d.z);
            print_surface(s.s);
        }
    }
    std::printf("%-14s %6ld hits, condition to %.2g, %ld too steep to tell; ", type.c_str(), met, condition,
                steep);
    std::printf("dt/do within %.3f of what it may be off by, %.3g u c; over %ld\n", worst, worst_linear,
                over);
    if (met < count / 2 || (count > 100 && condition < 1e5))
        failures++, std::printf("FAIL %s: too few hits\n", type.c_str());
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run run(argc, argv, 1000, 9);
    generator g(run.seed);
    for (const char *type : {"conic", "asphere"}) grazing(g, type, run.count);
    for (const char *type : types) grazing(g, type, run.count);
    std::printf("%ld failures\n", failures);
    return failures != 0;
}
