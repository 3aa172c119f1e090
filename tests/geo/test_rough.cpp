// SPDX-License-Identifier: MIT
// test_rough.cpp - the surface over a geoid that is rough: grids made here, of heights that jump from node
// to node, against another reader and dense samples.
//
// EGM96 is so smooth that bounds of its slope and of its curvature may be half or a quarter of what they
// have to be without any ray that shows it.  Here the heights are up to 900 m at nodes 20 km apart, in
// patterns where one direction alone is rough, so that the bound of that direction has nothing to lean on:
//
//   zonal        rows of nodes up and down in turn: the slope northward is 1.5 steps a cell, its change 6 a
//                cell and cell
//   meridional   columns in turn; towards the poles these become as narrow as the file has them
//   board        fields of a board: both at once
//   cliffs       plateaus of many nodes, with a step between
//   noise        every node at random
//
//   enclosures   F at samples of a stretch is in the enclosure of g, its slope in that of g'
//   roots        a first hit is where the samples first change sign; a miss has no such place; so under proof
//
// SAGITTA_TEST_SEED, SAGITTA_TEST_SCALE as everywhere.
#include "quad_earth.h"

#include <sagitta/geo.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>

namespace {

using earth::quad;
using earth::rounded;

std::mt19937_64 random_bits;
double uniform(double lo, double hi)
{
    return lo + (hi - lo) * static_cast<double>(random_bits() >> 11) * 0x1p-53;
}
int whole(int most) { return static_cast<int>(random_bits() % static_cast<unsigned>(most)); }
int faults = 0;

struct pattern {
    const char *name;
    std::function<double(int i, int j)> height;
};

bool write(const char *path, int rows, int columns, const pattern &p)
{
    std::vector<unsigned char> out;
    const auto put = [&](uint64_t x, int n) {
        while (n--) out.push_back(static_cast<unsigned char>(x >> (8 * n)));
    };
    for (double x : {-90.0, -180.0, 180.0 / (rows - 1), 360.0 / columns}) {
        uint64_t bits;
        std::memcpy(&bits, &x, 8);
        put(bits, 8);
    }
    put(static_cast<uint64_t>(rows), 4), put(static_cast<uint64_t>(columns), 4);
    for (int i = 0; i < rows; i++)
        for (int j = 0; j < columns; j++) {
            const float x = static_cast<float>(
                p.height(i, i == 0 || i == rows - 1 ? 0 : j)); // a pole has one
            uint32_t bits;
            std::memcpy(&bits, &x, 4);
            put(bits, 4);
        }
    std::FILE *file = std::fopen(path, "wb");
    const bool good = file && std::fwrite(out.data(), 1, out.size(), file) == out.size();
    return file && std::fclose(file) == 0 && good;
}

struct bench {
    const char *name;
    const earth::grid *grid;
    sgt_geoid_height over;
    long asked = 0, slopes = 0, hits = 0, misses = 0, undecided = 0;

    void fail(const char *why, const sgt_ray &ray, double a, double b, double c)
    {
        if (++faults > 20) return;
        std::printf("FAIL %s: %s: %.17g, of %.17g ... %.17g\n    {%a, %a, %a}, {%a, %a, %a}, %a, %a; h %a\n",
                    name, why, a, b, c, ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z, ray.tmin,
                    ray.tmax, over.h);
    }
    double F(const sgt_ray &ray, double t) const { return grid->about(earth::at(ray, t), over.h); }

    // Through a point at a place of a cell, level or falling, from near.
    sgt_ray some(double *at) const
    {
        const double degree = 0.017453292519943295, step = 180.0 / (grid->rows - 1);
        double latitude = (whole(4) ? uniform(-75, 75) : uniform(-89, 89)), longitude = uniform(-180, 180);
        if (whole(2))
            latitude = std::round(latitude / step) * step + (whole(2) ? 0 : 0.5 * step),
            longitude = std::round(longitude / step) * step + (whole(2) ? 0 : 0.5 * step);
        const double s = std::sin(latitude * degree), c = std::cos(latitude * degree),
                     e2 = earth::WGS84.f * (2 - earth::WGS84.f),
                     n = earth::WGS84.a / std::sqrt(1 - e2 * s * s);
        const double high = grid->undulation(latitude, longitude) + over.h +
                            (whole(3) ? uniform(-200, 200) : 0),
                     x = std::cos(longitude * degree), y = std::sin(longitude * degree);
        const double about = whole(4) ? 1.5707963267948966 * whole(4) : uniform(0, 6.283185307179586),
                     lift = whole(3) ? uniform(-0.2, 0.2) : uniform(-1.5, 1.5);
        const sgt_vec3 up = {c * x, c * y, s}, north = {-s * x, -s * y, c}, east = {-y, x, 0};
        const double a = std::cos(lift) * std::cos(about), b = std::cos(lift) * std::sin(about),
                     w = std::sin(lift), length = whole(2) ? 1 : std::exp(uniform(-5, 5));
        sgt_ray ray = {{(n + high) * c * x, (n + high) * c * y, (n * (1 - e2) + high) * s},
                       {length * (a * north.x + b * east.x + w * up.x),
                        length * (a * north.y + b * east.y + w * up.y),
                        length * (a * north.z + b * east.z + w * up.z)},
                       0,
                       0};
        const double away = whole(3) ? uniform(0, 3e5) : std::exp(uniform(0, 16));
        *at = away / length;
        ray.o = {ray.o.x - *at * ray.d.x, ray.o.y - *at * ray.d.y, ray.o.z - *at * ray.d.z};
        ray.tmax = *at + 3e5 / length;
        return ray;
    }

    void enclosures(long count)
    {
        for (long i = 0; i < count; i++) {
            double t;
            const sgt_ray ray = some(&t);
            const double along = std::sqrt(ray.d.x * ray.d.x + ray.d.y * ray.d.y + ray.d.z * ray.d.z),
                         width = std::exp(uniform(3, 12)) / along;
            const sgt_interval over_t = {t - (whole(2) ? 0 : 0.5 * width), t + width};
            sgt_interval slope = {NAN, NAN};
            const sgt_interval g = sgt_geoid_height_ops.enclose(&over, &ray, over_t, &slope);
            for (int j = 0; j <= 8; j++) {
                const double s = over_t.lo + (over_t.hi - over_t.lo) * j / 8, by = 0.5 / along, doubt = 1e-6;
                const double value = F(ray, s), rate = rounded(grid->over(earth::at(ray, s + by), over.h) -
                                                               grid->over(earth::at(ray, s - by), over.h)) /
                                                       (2 * by);
                if (!(g.lo <= value + doubt && value - doubt <= g.hi))
                    fail("F leaves its enclosure", ray, value, g.lo, g.hi);
                if (j > 0 && j < 8 && !(slope.lo <= rate + 1e-6 * along && rate - 1e-6 * along <= slope.hi))
                    fail("the slope leaves its enclosure", ray, rate, slope.lo, slope.hi);
                asked++;
            }
            slopes += slope.lo > 0 || slope.hi < 0;
        }
    }

    void roots(long count)
    {
        for (long i = 0; i < count; i++) {
            double at;
            sgt_ray ray = some(&at);
            const double along = std::sqrt(ray.d.x * ray.d.x + ray.d.y * ray.d.y + ray.d.z * ray.d.z);
            ray.tmin = std::max(0.0, at - 3e5 / along);
            sgt_options opt = {};
            opt.proof = whole(2) ? SGT_PROVE_FIRST : SGT_ESTIMATE;
            const sgt_hit h = sgt_intersect({&sgt_geoid_height_ops, &over}, ray, &opt);
            if (h.status < 0) {
                undecided++;
                continue;
            }
            (h.status > 0 ? hits : misses)++;
            // the first change of sign that samples are sure of
            const double step = 1500 / along, end = h.status > 0 ? h.t - h.t_err : ray.tmax;
            double before = NAN;
            for (double s = ray.tmin; s < end; s += step) {
                const double f = F(ray, s);
                if (std::fabs(f) < 1e-5) continue;
                if (before * f < 0) {
                    fail(h.status > 0 ? "a root before the first" : "a root of a miss", ray, s, h.t,
                         ray.tmax);
                    break;
                }
                before = f;
            }
            if (h.status == SGT_HIT) {
                const double by = h.t_err + 1e-5 / along, f = F(ray, h.t);
                if (std::fabs(f) > 1e-5 + 2 * h.t_err * along && F(ray, h.t - by) * F(ray, h.t + by) > 0)
                    fail("no root at a hit", ray, h.t, f, h.t_err);
            }
        }
    }
};

} // namespace

int main()
{
    const char *seed = std::getenv("SAGITTA_TEST_SEED"), *scale = std::getenv("SAGITTA_TEST_SCALE"),
               *path = "test_rough.gtx";
    const unsigned long long number = seed ? std::strtoull(seed, nullptr, 0) : 1;
    const double more = scale ? std::atof(scale) : 0.5;
    std::printf("a rough geoid: SAGITTA_TEST_SEED=%llu\n", number);
    random_bits.seed(number);
    std::vector<float> noise(1 << 16);
    for (float &x : noise) x = static_cast<float>(uniform(-900, 900));
    const pattern patterns[] = {
        {"zonal", [](int i, int) { return i % 2 ? 900.0 : -900.0; }},
        {"meridional", [](int, int j) { return j % 2 ? 30.0 : -30.0; }},
        {"board", [](int i, int j) { return (i + j) % 2 ? 400.0 : -400.0; }},
        {"cliffs", [](int i, int j) { return i % 14 < 5 && j % 18 < 9 ? 900.0 : -300.0; }},
        {"noise",
         [&](int i, int j) {
             return static_cast<double>(noise[static_cast<std::size_t>((i * 7919 + j * 104729) & 0xffff)]);
         }},
    };
    for (const pattern &p : patterns) {
        const int rows = p.name == std::string("meridional") ? 181 : 721,
                  columns = 2 * (rows - 1); // 1 degree, or a quarter of one
        sgt_error error = {};
        earth::grid grid;
        sgt_geoid *geoid = write(path, rows, columns, p) ? sgt_geoid_open(path, &error) : nullptr;
        if (!geoid || !grid.read(path)) {
            std::printf("FAIL %s: %s\n", p.name, error.words);
            faults++;
            continue;
        }
        bench b = {p.name, &grid, {geoid, whole(2) ? 0 : uniform(-100, 1000)}};
        b.enclosures(static_cast<long>(4000 * more));
        b.roots(static_cast<long>(250 * more));
        std::printf("%s: %ld samples in their enclosures, %ld stretches monotone; %ld hits, %ld misses, %ld "
                    "undecided\n",
                    p.name, b.asked, b.slopes, b.hits, b.misses, b.undecided);
        sgt_geoid_close(geoid);
        std::remove(path);
    }
    std::printf("%d faults\n", faults);
    return faults ? 1 : 0;
}
