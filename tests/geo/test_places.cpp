// SPDX-License-Identifier: MIT
// test_places.cpp - latitude, longitude and height, there and back: against the closed form in long double,
// and against GeographicLib's Geocentric with its matrix of east, north and up, which the library does not
// use.  Poles, the date line, the equator and the axis are among the places.  SAGITTA_TEST_SEED,
// SAGITTA_TEST_SCALE as everywhere; at the default scale 10^5 rays.
#include <sagitta/geo.h>
#include <sagitta/surfaces.h>

#include <GeographicLib/Geocentric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

namespace {

typedef long double wide;
constexpr wide DEGREE = 3.14159265358979323846264338327950288L / 180;
constexpr double A = 6378137, F = 1 / 298.257223563;

int faults = 0;
std::mt19937_64 random_bits;
double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_bits); }
int whole(int most) { return static_cast<int>(random_bits() % static_cast<unsigned>(most)); }

bool expect(bool good, const char *what, double a, double b, double c)
{
    if (!good && ++faults <= 20) std::printf("%s: %.17g %.17g %.17g\n", what, a, b, c);
    return good;
}

// sin and cos of degrees: an exact remainder first, so that quarter turns are exact in degrees.
void turn(double degrees, wide &s, wide &c)
{
    const double rest = std::remainder(degrees, 90);
    int quarter = static_cast<int>(std::lround(std::remainder((degrees - rest) / 90, 4)));
    const wide u = std::sin(static_cast<wide>(rest) * DEGREE), v = std::cos(static_cast<wide>(rest) * DEGREE);
    switch (quarter & 3) {
    case 0: s = u, c = v; break;
    case 1: s = v, c = -u; break;
    case 2: s = -u, c = -v; break;
    default: s = -v, c = u;
    }
}

struct frame { wide p[3], east[3], north[3], up[3]; };
frame frame_at(double a, double f, double latitude, double longitude, double height)
{
    wide sb, cb, sl, cl;
    turn(latitude, sb, cb), turn(longitude, sl, cl);
    const wide wa = a, b = wa * (1 - static_cast<wide>(f)),
               n = wa * wa / std::sqrt(wa * wa * cb * cb + b * b * sb * sb), m = n * (b / wa) * (b / wa);
    return {{(n + height) * cb * cl, (n + height) * cb * sl, (m + height) * sb},
            {-sl, cl, 0},
            {-sb * cl, -sb * sl, cb},
            {cb * cl, cb * sl, sb}};
}

double off(const wide p[3], const sgt_vec3 &q)
{
    const wide x = p[0] - q.x, y = p[1] - q.y, z = p[2] - q.z;
    return static_cast<double>(std::sqrt(x * x + y * y + z * z));
}

double latitude()
{
    const double odd[] = {90, -90, 0, 89.9999999, -89.99999999999, 1e-13, 45};
    return whole(4) ? std::asin(uniform(-1, 1)) * 57.29577951308232 : odd[whole(7)];
}
double longitude()
{
    const double odd[] = {180, -180, 179.99999999999, -179.99999999999, 0, 90, -90, 360, 540, -1e-14};
    return whole(4) ? uniform(-180, 180) : odd[whole(10)];
}

struct worst { double point = 0, back = 0, height = 0, unit = 0, look = 0, library = 0, hit = 0; };

// A place, its point, and back.
void there_and_back(const sgt_geodetic_height *over, double a, double f, worst &w)
{
    const GeographicLib::Geocentric earth(a, f);
    const double odd[] = {0, -11000, 8848, 7e5, 3.6e7, 4e8};
    const sgt_geodetic_place from = {latitude(), longitude(),
                                     a / A * (whole(3) ? uniform(-1e4, 1e6) : odd[whole(6)]), {}};
    const double azimuth = whole(4) ? uniform(-360, 360) : 90 * whole(5),
                 elevation = whole(4) ? uniform(-90, 90) : 90 * (whole(3) - 1);
    const sgt_ray ray = sgt_geodetic_ray(over, from, azimuth, elevation);
    const frame true_one = frame_at(a, f, from.latitude, from.longitude, from.height);
    const double size = a + std::fabs(from.height);
    w.point = std::fmax(w.point, off(true_one.p, ray.o) / size);
    wide sa, ca, se, ce, d[3];
    turn(azimuth, sa, ca), turn(elevation, se, ce);
    for (int i = 0; i < 3; i++)
        d[i] = ce * (sa * true_one.east[i] + ca * true_one.north[i]) + se * true_one.up[i];
    w.look = std::fmax(w.look, off(d, ray.d));
    const wide dx = ray.d.x, dy = ray.d.y, dz = ray.d.z;
    w.unit = std::fmax(w.unit, static_cast<double>(std::fabs(std::sqrt(dx * dx + dy * dy + dz * dz) - 1)));

    double x, y, z;
    std::vector<double> m(9);
    earth.Forward(from.latitude, from.longitude, from.height, x, y, z, m);
    const double own[3] = {ray.d.x, ray.d.y, ray.d.z};
    const wide wanted[3] = {ce * sa, ce * ca, se};
    wide local[3] = {0, 0, 0};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) local[i] += static_cast<wide>(m[static_cast<size_t>(3 * k + i)]) * own[k];
    for (int i = 0; i < 3; i++)
        w.library = std::fmax(w.library, static_cast<double>(std::fabs(local[i] - wanted[i])));
    expect(std::fabs(x - ray.o.x) + std::fabs(y - ray.o.y) + std::fabs(z - ray.o.z) <= 1e-15 * size,
           "not GeographicLib's point", x, y, z);

    const sgt_geodetic_place to = sgt_geodetic_place_of(over, ray.o);
    const frame again = frame_at(a, f, to.latitude, to.longitude, to.height);
    w.back = std::fmax(w.back, off(again.p, ray.o) / size);
    w.height = std::fmax(w.height, std::fabs(to.height - from.height) / size);
    double la, lo, h;
    earth.Reverse(ray.o.x, ray.o.y, ray.o.z, la, lo, h);
    expect(std::fabs(la - to.latitude) <= 1e-13 && std::fabs(h - to.height) <= 4e-15 * size,
           "not GeographicLib's place", to.latitude, la, h);
    expect(lo == to.longitude || (lo == -180 && to.longitude == 180), "not its longitude", to.longitude, lo,
           0);
    expect(to.longitude > -180 && to.longitude <= 180 && std::fabs(to.latitude) <= 90, "out of range",
           to.latitude, to.longitude, to.height);
    if (std::fabs(from.latitude) == 90)
        expect(ray.o.x == 0 && ray.o.y == 0 && to.longitude == 0 && to.latitude == from.latitude,
               "not on the axis", ray.o.x, ray.o.y, to.latitude);
    if (std::fabs(from.longitude) == 180 && std::fabs(from.latitude) < 90)
        expect(to.longitude == 180, "not the date line", from.longitude, to.longitude, to.latitude);

    // by column, the same bits
    const double *const place[3] = {&from.latitude, &from.longitude, &from.height},
                        *const look[2] = {&azimuth, &elevation};
    double o[3], v[3], q[3];
    double *const to_o[3] = {o, o + 1, o + 2}, *const to_d[3] = {v, v + 1, v + 2};
    double *const to_q[3] = {q, q + 1, q + 2};
    sgt_geodetic_rays(over, 1, place, look, to_o, to_d);
    sgt_geodetic_places(over, 1, to_o, to_q);
    expect(o[0] == ray.o.x && o[1] == ray.o.y && o[2] == ray.o.z && v[0] == ray.d.x && v[1] == ray.d.y &&
               v[2] == ray.d.z && q[0] == to.latitude && q[1] == to.longitude && q[2] == to.height,
           "by column", from.latitude, from.longitude, from.height);
}

// Looks down at a surface: the hit's height over its ellipsoid is that of the surface.
void hits(sgt_surface s, double h, const sgt_geoid *geoid, worst &w)
{
    sgt_geodetic_height over;
    expect(sgt_geodetic_ellipsoid(s, &over), "whose ellipsoid", 0, 0, 0);
    const sgt_geodetic_place from = {latitude(), longitude(), h + uniform(2e5, 9e5), {}};
    const sgt_ray ray = sgt_geodetic_ray(&over, from, uniform(0, 360), whole(5) ? uniform(-90, -70) : -90);
    const sgt_hit hit = sgt_intersect(s, ray, nullptr);
    if (!expect(hit.status == SGT_HIT, "no hit", from.latitude, from.longitude, from.height)) return;
    const sgt_geodetic_place at = sgt_geodetic_place_of(&over, hit.p);
    const double n = geoid ? sgt_geoid_undulation(geoid, at.latitude, at.longitude) : 0;
    w.hit = std::fmax(w.hit, std::fabs(at.height - n - h));
    if (sgt_geodetic_ray(&over, from, 0, -90).d.z == ray.d.z) // straight down the place is kept
        expect(std::fabs(at.latitude - from.latitude) <= 1e-9, "straight down", at.latitude, from.latitude,
               h);
}

void refused()
{
    const double no = std::nan("");
    const sgt_geodetic_place bad[] = {{91, 0, 0, {}}, {-90.0000001, 0, 0, {}}, {no, 0, 0, {}},
                                      {0, no, 0, {}}, {0, HUGE_VAL, 0, {}},    {0, 0, no, {}}};
    for (const sgt_geodetic_place &b : bad)
        expect(std::isnan(sgt_geodetic_ray(nullptr, b, 0, 0).o.x), "taken", b.latitude, b.longitude,
               b.height);
    expect(std::isnan(sgt_geodetic_ray(nullptr, {0, 0, 0, {}}, 0, 91).d.x), "an elevation", 91, 0, 0);
    const sgt_geodetic_height wrong[] = {{-1, 0, 0}, {0, 0.1, 0}, {1, 1, 0}, {no, 0, 0}, {1, no, 0}};
    for (const sgt_geodetic_height &e : wrong) {
        expect(std::isnan(sgt_geodetic_place_of(&e, {7e6, 0, 0}).height), "an ellipsoid", e.a, e.f, 0);
        expect(std::isnan(sgt_geodetic_ray(&e, {0, 0, 0, {}}, 0, 0).o.x), "an ellipsoid", e.a, e.f, 0);
    }
    expect(std::isnan(sgt_geodetic_place_of(nullptr, {no, 0, 0}).latitude), "a point", no, 0, 0);
    const sgt_torus ring = {2, 1};
    expect(!sgt_geodetic_ellipsoid({&sgt_torus_ops, &ring}, nullptr), "a torus is no Earth", 0, 0, 0);
}

} // namespace

int main()
{
    const char *seed = std::getenv("SAGITTA_TEST_SEED"), *scale = std::getenv("SAGITTA_TEST_SCALE");
    const unsigned long long first = seed ? std::strtoull(seed, nullptr, 0) : 1;
    const long count = std::max(100L, static_cast<long>(200000 * (scale ? std::atof(scale) : 0.5)));
    random_bits.seed(first);
    std::printf("SAGITTA_TEST_SEED=%llu, %ld rays\n", first, count);
    refused();
    worst earth, other, sea;
    for (long i = 0; i < count; i++) there_and_back(nullptr, A, F, earth);
    for (double f : {0.0, 0.1, 0.5, -0.2, -1.0}) {
        const sgt_geodetic_height over = {3e3, f, 7};
        for (long i = 0; i < count / 50; i++) there_and_back(&over, 3e3, f, other);
    }
    for (long i = 0; i < count / 10; i++) {
        const sgt_geodetic_height s = {0, 0, uniform(-5e3, 1e4)};
        hits({&sgt_geodetic_height_ops, &s}, s.h, nullptr, earth);
    }
    char path[1000];
    sgt_geoid *geoid = sgt_geoid_find(path, sizeof path, nullptr) ? sgt_geoid_open(path, nullptr) : nullptr;
    for (long i = 0; i < count / 10 && geoid; i++) {
        const sgt_geoid_height s = {geoid, uniform(-5e3, 1e4)};
        hits({&sgt_geoid_height_ops, &s}, s.h, geoid, sea);
    }
    sgt_geoid_close(geoid);
    const double u = 0x1p-53;
    std::printf("WGS84, in 2^-53: point %.2f, back %.2f, height %.2f (of a + |h|); look %.2f, its length "
                "%.2f, beside GeographicLib's matrix %.2f\nothers: point %.2f, back %.2f, height %.2f\n"
                "heights of hits: %.2g m, of the geoid %.2g m%s\n",
                earth.point / u, earth.back / u, earth.height / u, earth.look / u, earth.unit / u,
                earth.library / u, other.point / u, other.back / u, other.height / u, earth.hit, sea.hit,
                geoid ? "" : " (no grid)");
    expect(earth.point <= 5 * u && earth.back <= 6 * u && earth.height <= 7 * u, "errors", earth.point / u,
           earth.back / u, earth.height / u);
    expect(other.point <= 7 * u && other.back <= 7 * u && other.height <= 9 * u, "errors of others",
           other.point / u, other.back / u, other.height / u);
    expect(earth.look <= 6 * u && earth.unit <= 4 * u && earth.library <= 8 * u, "directions", earth.look / u,
           earth.unit / u, earth.library / u);
    expect(earth.hit <= 2e-8 && sea.hit <= 2e-8, "heights of hits", earth.hit, sea.hit, 0);
    std::printf("%d faults\n", faults);
    return faults != 0;
}
