// SPDX-License-Identifier: MIT
// test_climb.cpp - the greatest error for its bound that a climb finds, of the surfaces about the Earth:
// tests/catalogue/climb.h.
//
// The geoid is not climbed: its oracle is in double, and its bound that of the height but for a part in 10^3.
// --limits prints the greatest quotients found and a fifth more, --table the rows of docs/data/climb.md.
#include "../catalogue/climb.h"
#include "quad_earth.h"

#include <sagitta/geo.h>

#include <memory>

namespace {

using climb::generator;
using climb::quad;

struct of_earth : climb::subject {
    int kind; // 0: a height over WGS84; 1: over another ellipsoid; 2: a level of gravity
    sgt_geodetic_height height = {};
    sgt_level_gravity level = {};
    earth::ellipsoid e = earth::WGS84;

    explicit of_earth(int which) : kind(which) {}
    sgt_surface surface() const override
    {
        return kind < 2 ? sgt_surface{&sgt_geodetic_height_ops, &height}
                        : sgt_surface{&sgt_level_gravity_ops, &level};
    }
    quad value(quad x, quad y, quad z) const override
    {
        if (!(x - x + y - y + z - z == 0)) return quad(NAN);
        return kind < 2 ? earth::height(e, {x, y, z}) - height.h
               : x * x + y * y + z * z < quad(41e6) * 41e6 && x * x + y * y + z * z > quad(6e6) * 6e6
                   ? earth::over_level({x, y, z}, level.h)
                   : quad(NAN);
    }
    quad slope(quad at) const override // five points; a part in 10^20
    {
        const quad by = quad(size) /
                        quad(std::sqrt(ray.d.x * ray.d.x + ray.d.y * ray.d.y + ray.d.z * ray.d.z)) *
                        quad(1e-5);
        return (8 * (along(at + by) - along(at - by)) - (along(at + 2 * by) - along(at - 2 * by))) /
               (12 * by);
    }
    std::vector<double *> numbers() override { return {kind < 2 ? &height.h : &level.h}; }
    void print() const override
    {
        std::printf("    kind %d, a %a, f %a, h %a\n", kind, e.a, e.f, kind < 2 ? height.h : level.h);
    }
    static sgt_vec3 way(generator &g)
    {
        const double z = g.uniform(-1, 1), about = g.uniform(0, 6.283185307179586), r = std::sqrt(1 - z * z);
        return {r * std::cos(about), r * std::sin(about), z};
    }
    void draw(generator &g) override
    {
        e = kind == 1 ? earth::ellipsoid{g.log_uniform(1e-3, 1e8), g.chance(0.3) ? 0 : g.uniform(-1, 0.5)}
                      : earth::WGS84;
        height = {kind == 1 ? e.a : 0, kind == 1 ? e.f : 0, g.chance(0.2) ? 0 : e.a * g.uniform(-0.01, 0.1)};
        level = {g.chance(0.2) ? 0 : g.uniform(-1e5, 1e6), 0};
        size = e.a;
        const double h = kind < 2 ? height.h : level.h;
        const sgt_vec3 up = way(g), d = way(g);
        p = {up.x * (e.a + h), up.y * (e.a + h), up.z * (e.a * (1 - e.f) + h)};
        const double length = g.chance(0.5) ? 1 : g.log_uniform(1e-3, 1e3),
                     away = e.a *
                            (g.chance(0.3) ? g.log_uniform(1e-6, 1e-2) : g.uniform(0, kind == 2 ? 4 : 10)) /
                            length;
        ray = {{p.x - away * d.x * length, p.y - away * d.y * length, p.z - away * d.z * length},
               {length * d.x, length * d.y, length * d.z},
               g.chance(0.5) ? 0 : -HUGE_VAL,
               HUGE_VAL};
        t = away + (g.chance(0.5) ? 0 : e.a / length * g.uniform(-0.1, 0.1));
        t_tol = e.a / length * g.log_uniform(1e-14, 1e-3);
        if (g.chance(0.5))
            p = {p.x * g.uniform(0.98, 1.5), p.y * g.uniform(0.98, 1.5), p.z * g.uniform(0.98, 1.5)};
    }
};

struct limit {
    const char *name;
    double most[climb::cells];
};
const limit limits_of[] = {
#include "climb_limits.inc"
};

} // namespace

int main(int argc, char **argv)
{
    bool limits = false, table = false;
    for (int i = 1; i < argc; i++)
        limits = limits || !std::strcmp(argv[i], "--limits"),
        table = table || !std::strcmp(argv[i], "--table");
    const long standard = 400;
    const oracle::run r(1, argv, standard, 20261101);
    const bool pinned = r.seed == 20261101 && r.count == standard && !limits && !table;
    int failed = 0;
    for (int kind = 0; kind < 3; kind++) {
        static const char *const names[] = {"geodetic_height", "ellipsoid's height", "level_gravity"};
        of_earth s(kind);
        climb::table t;
        t.type = names[kind];
        for (const limit &l : limits_of)
            if (t.type == l.name) t.limits = l.most;
        for (int seeds = limits ? -1 : 0; seeds < (limits ? 3 : 1); seeds++) { // -1: as it is by default
            generator g(r.seed + static_cast<std::uint64_t>(std::max(seeds, 0)) * 7919 +
                        static_cast<std::uint64_t>(kind) * 0x100000000u);
            climb::go(g, &s, 120 * (seeds < 0 ? standard : r.count) / (kind == 2 ? 2 : 1), 60, &t);
        }
        failed += climb::judge(t, pinned);
        climb::print(t, limits, table);
    }
    return failed > 0;
}
