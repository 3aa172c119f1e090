// SPDX-License-Identifier: MIT
// test_line_of_sight.cpp - the camera and its pixels, against GeographicLib and closed forms.
//
// On random orbits, and on some chosen ones, over each surface:
//   - no pixel is undecided; one whose ray meets an ellipsoid within the surface sees it, one whose ray
//     passes by an ellipsoid about it does
//     not (a quadratic in long double, of which the library knows nothing); in wide scans there are both;
//   - Reverse has the surface's height at each point, NormalGravity its potential; Forward leads from
//     latitude, longitude and height back
//     to the point, which is on the ray; the incidence is that of the up vector there;
//   - the numbers of the csv read back to the same bits.
// Of the camera: it flies as Kepler has it, looks ahead and to the right as it says, and on a sphere its
// pixels are as far apart as trigonometry has it; on WGS84 the spacing at the nadir, by Geodesic, is the
// height times the angle and the speed times the time.  SAGITTA_TEST_SEED chooses other orbits,
// SAGITTA_TEST_SCALE more of them.
#include "camera.h"
#include "geodetic.h"
#include "scan.h"
#include "table.h"

#include <sagitta/geo.h>

#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/Geodesic.hpp>
#include <GeographicLib/NormalGravity.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>

namespace {

using namespace GeographicLib;
constexpr double DEGREE = 0.017453292519943295769, TURN = 6.2831853071795864769, A = 6378137,
                 ROTATION = 7.292115e-5, GM = 3.986004418e14;
constexpr double ON_SURFACE = 2e-8, SAME_POINT = 2e-8;

long faults = 0;
#define EXPECT(what, ...)                                                                     \
    ((what) ? (void)0                                                                         \
            : (++faults <= 20 ? (void)(std::printf("%s:%d: %s: ", __FILE__, __LINE__, #what), \
                                       std::printf(__VA_ARGS__), std::printf("\n"))           \
                              : (void)0))

double dot(sgt_vec3 a, sgt_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
sgt_vec3 sum(double a, sgt_vec3 x, double b, sgt_vec3 y)
{
    return {a * x.x + b * y.x, a * x.y + b * y.y, a * x.z + b * y.z};
}
sgt_vec3 cross(sgt_vec3 a, sgt_vec3 b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length(sgt_vec3 a) { return std::sqrt(dot(a, a)); }
double apart(sgt_vec3 a, sgt_vec3 b) { return length(sum(1, a, -1, b)); }
sgt_vec3 of(double *const v[3], size_t i) { return {v[0][i], v[1][i], v[2][i]}; }

std::mt19937_64 random_bits;
double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_bits); }

camera chosen(double altitude, double field, int pixels, int lines, double line_time)
{
    camera c = {};
    c.altitude = altitude, c.inclination = 98 * DEGREE, c.node = 30 * DEGREE, c.start = 35 * DEGREE;
    c.field = field, c.pixels = pixels, c.lines = lines, c.line_time = line_time;
    return c;
}

camera any_camera()
{
    camera c = chosen(std::exp(uniform(std::log(2e5), std::log(3.6e7))), uniform(0, 3.2), 40, 20,
                      std::exp(uniform(-6, 5)));
    c.inclination = uniform(0, TURN / 2), c.node = uniform(0, TURN), c.start = uniform(0, TURN);
    if (random_bits() % 2) c.roll = uniform(-0.7, 0.7), c.pitch = uniform(-0.7, 0.7);
    return c;
}

// ------------------------------------------------------------------- pixels

struct subject {
    const char *name;
    sgt_surface surface;
    double h, below,
        above; // it is between the ellipsoids whose axes are longer by h - below and by h + above
    enum { HEIGHT, POTENTIAL, GEOID } kind;
    const sgt_geoid *geoid;
};

// Does the ray meet the ellipsoid whose axes are WGS84's and `more`?  The camera is outside.
bool meets(sgt_vec3 o, sgt_vec3 d, double more)
{
    long double a = A + more, b = A * (1 - 1 / 298.257223563L) + more;
    long double ox = o.x / a, oy = o.y / a, oz = o.z / b, dx = d.x / a, dy = d.y / a, dz = d.z / b;
    long double dd = dx * dx + dy * dy + dz * dz, od = ox * dx + oy * dy + oz * dz, cx = oy * dz - oz * dy,
                cy = oz * dx - ox * dz, cz = ox * dy - oy * dx;
    return od < 0 && cx * cx + cy * cy + cz * cz < dd; // the least of |o + t d|^2 is |o x d|^2 / d^2
}

struct tally { long hits = 0, misses = 0, near_limb = 0; double height = 0, back = 0, tilt = 0; };

void judge(const scan &s, const subject &u, size_t i, tally &n)
{
    sgt_vec3 o = of(s.o, i), d = of(s.d, i), p = of(s.p, i);
    bool inner = meets(o, d, u.h - u.below), outer = meets(o, d, u.h + u.above);
    n.near_limb += inner != outer;
    EXPECT(s.status[i] >= 0, "%s, pixel %zu: %s", u.name, i,
           sgt_status_text(static_cast<sgt_status>(s.status[i])));
    EXPECT(s.status[i] != SGT_MISS || !inner, "%s: pixel %zu sees it, and so it is said that it does not",
           u.name, i);
    EXPECT(s.status[i] <= 0 || outer, "%s: pixel %zu looks past it, and is said to see it", u.name, i);
    if (s.status[i] <= 0) {
        n.misses++;
        EXPECT(std::isnan(s.latitude[i]) && std::isnan(s.range[i]) && std::isnan(s.incidence[i]), "pixel %zu",
               i);
        return;
    }
    n.hits++;
    double latitude, longitude, height;
    Geocentric::WGS84().Reverse(p.x, p.y, p.z, latitude, longitude, height);
    EXPECT(latitude == s.latitude[i] && longitude == s.longitude[i] && height == s.height[i], "pixel %zu", i);
    double off = height - u.h;
    if (u.kind == subject::GEOID) off -= sgt_geoid_undulation(u.geoid, latitude, longitude);
    if (u.kind == subject::POTENTIAL) {
        double x, y, z, top = NormalGravity::WGS84().U(A + u.h, 0, 0, x, y, z);
        off = (top - NormalGravity::WGS84().U(p.x, p.y, p.z, x, y, z)) / std::sqrt(x * x + y * y + z * z);
    }
    n.height = std::max(n.height, std::fabs(off));
    EXPECT(std::fabs(off) <= ON_SURFACE, "%s, h = %g: pixel %zu is %g m off", u.name, u.h, i, off);
    double back = std::max(apart(p, geodetic_point({s.latitude[i], s.longitude[i], s.height[i]})),
                           apart(p, sum(1, o, s.range[i], d)) - s.range_err[i]);
    n.back = std::max(n.back, back);
    EXPECT(back <= SAME_POINT, "%s: pixel %zu is %g m from where it should be", u.name, i, back);
    double lat = DEGREE * latitude, lon = DEGREE * longitude;
    double cosine = -dot(d, {std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat)});
    double tilt = std::fabs(std::acos(std::max(-1.0, std::min(1.0, cosine))) / DEGREE - s.incidence[i]);
    n.tilt = std::max(n.tilt, tilt);
    EXPECT(tilt <= (u.kind == subject::HEIGHT ? 2e-6 : 0.2), "%s: pixel %zu, incidence %g, off by %g", u.name,
           i, s.incidence[i], tilt); // acos is that bad at 0; slopes
    EXPECT(s.incidence[i] <= (u.kind == subject::GEOID ? 90.2 : 90 + 1e-6),
           "%s: pixel %zu from behind, incidence %.17g", u.name, i, s.incidence[i]);
}

bool same(double a, double b)
{
    return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
}

void reads_back(const scan &s)
{
    std::FILE *file = std::tmpfile();
    char row[1000];
    EXPECT(file, "no temporary file");
    if (!file) return;
    table_csv(file, &s);
    std::rewind(file);
    EXPECT(
        std::fgets(row, sizeof row, file) &&
            std::string(row) ==
                "line,pixel,seconds,status,latitude,longitude,height,incidence,range,range_err,x,y,z,evals\n",
        "%s", row);
    for (size_t i = 0; i < s.rays; i++) {
        EXPECT(std::fgets(row, sizeof row, file), "row %zu is missing", i);
        const double want[] = {
            s.latitude[i],  s.longitude[i], s.height[i], s.incidence[i], s.range[i],
            s.range_err[i], s.p[0][i],      s.p[1][i],   s.p[2][i],      static_cast<double>(s.evals[i])};
        char *at = row, status[20];
        long line = std::strtol(at, &at, 10), pixel = std::strtol(at + 1, &at, 10);
        double seconds = std::strtod(at + 1, &at);
        bool equal = std::sscanf(at, ",%19[a-z]", status) == 1 &&
                     std::string(status) == sgt_status_text(static_cast<sgt_status>(s.status[i]));
        equal = equal && scan_index(&s, static_cast<int>(line), static_cast<int>(pixel)) == i &&
                same(seconds, static_cast<double>(line) * s.camera.line_time);
        at += 1 + std::strlen(status);
        for (double x : want) equal = equal && *at == ',' && same(std::strtod(at + 1, &at), x);
        EXPECT(equal && *at == '\n', "row %zu: %s", i, row);
    }
    EXPECT(std::fgetc(file) == EOF, "more rows than pixels");
    std::fclose(file);
}

void look_at(const subject &u, int orbits)
{
    tally n;
    for (int k = 0; k < orbits + 3; k++) {
        camera c = any_camera();
        if (k == 0) c = chosen(700e3, 60 * DEGREE, 64, 16, 1);         // all on the Earth
        if (k == 1) c = chosen(700e3, 140 * DEGREE, 2000, 16, 20);     // beyond the limb
        if (k == 2) c = chosen(35786e3, 20 * DEGREE, 1000, 16, 600);   // from geostationary height
        if (c.altitude < u.h + 1e5) c.altitude += u.h;
        tally before = n;
        scan s = scan_begin(&c);
        scan_meet(&s, u.surface);
        for (size_t i = 0; i < s.rays; i++) judge(s, u, i, n);
        EXPECT(s.met == static_cast<size_t>(n.hits - before.hits) && s.undecided == 0, "%zu, %zu", s.met,
               s.undecided);
        if (k == 0) EXPECT(n.hits == static_cast<long>(s.rays), "%ld", n.hits);
        if (k == 1 || k == 2)
            EXPECT(n.hits > before.hits && n.misses > before.misses, "%ld, %ld", n.hits, n.misses);
        if (k < 4) reads_back(s);
        scan_end(&s);
    }
    std::printf("%s, h = %g m: %ld pixels see it, %ld look past it (%ld closer to the limb than the check "
                "can tell); off the surface at most %.2g m, "
                "from latitude and longitude back to the point %.2g m, incidence off by %.2g degrees\n",
                u.name, u.h, n.hits, n.misses, n.near_limb, n.height, n.back, n.tilt);
}

// ------------------------------------------------------------------- camera

// Kepler's speed, in a frame that does not turn, is ahead; down is to the centre; right is right.
void flies()
{
    for (int k = 0; k < 200; k++) {
        camera c = any_camera();
        double when = uniform(0, 6000), step = 0.5, r = A + c.altitude;
        station s = camera_station(&c, when), before = camera_station(&c, when - step),
                after = camera_station(&c, when + step);
        sgt_vec3 speed = sum(0.5 / step, after.place, -0.5 / step, before.place),
                 whirl = cross({0, 0, ROTATION}, s.place);
        speed = sum(1, speed, 1, whirl);
        double kepler = std::sqrt(GM / r);
        EXPECT(std::fabs(length(s.place) - r) < 1e-8 * r, "%g", length(s.place) - r);
        EXPECT(apart(speed, sum(kepler, s.ahead, 0, s.ahead)) < 1e-6 * kepler, "%g of %g",
               apart(speed, sum(kepler, s.ahead, 0, s.ahead)), kepler);
        sgt_vec3 up = sum(1 / r, s.place, 0, s.place), right = cross(s.ahead, up);
        EXPECT(apart(s.right, right) < 1e-12 && apart(s.down, sum(-1, up, 0, up)) < 1e-12, "%g",
               apart(s.right, right));
        sgt_vec3 normal = cross(up, s.ahead); // of the orbit
        EXPECT(std::fabs(normal.z - std::cos(c.inclination)) < 1e-12, "%g", normal.z);
        int pixel = static_cast<int>(random_bits() % static_cast<unsigned>(c.pixels));
        double b = c.field * (2 * pixel + 1 - c.pixels) / (2.0 * c.pixels) + c.roll;
        sgt_vec3 d = camera_look(&c, &s, camera_angle(&c, pixel));
        EXPECT(std::fabs(dot(d, right) - std::sin(b)) < 1e-12 &&
                   std::fabs(dot(d, s.ahead) - std::cos(b) * std::sin(c.pitch)) < 1e-12 &&
                   std::fabs(length(d) - 1) < 1e-12,
               "%g", b);
    }
    camera c = chosen(700e3, 1, 1, 1, 0);
    c.start = 0;
    geodetic g = geodetic_of(camera_station(&c, 0).place);
    EXPECT(std::fabs(g.latitude) < 1e-9 && std::fabs(g.longitude - 30) < 1e-9 &&
               std::fabs(g.height - 700e3) < 1e-6,
           "%g %g %g", g.latitude, g.longitude, g.height);
}

// On a sphere of radius R a ray at an angle a from down, from r, ends asin(r sin(a) / R) - a round the
// centre.
void spaced_on_a_sphere()
{
    double R = 6371e3, worst = 0;
    sgt_geodetic_height sphere = {R, 0, 0};
    Geocentric geocentric(R, 0);
    Geodesic geodesic(R, 0);
    camera c = chosen(700e3, 120 * DEGREE, 201, 3, 10);
    scan s = scan_begin(&c);
    scan_meet(&s, {&sgt_geodetic_height_ops, &sphere});
    auto place = [&](size_t i, double &latitude, double &longitude) {
        double h;
        geocentric.Reverse(s.p[0][i], s.p[1][i], s.p[2][i], latitude, longitude, h);
    };
    auto angle = [&](int pixel) {
        double a = c.field * (2 * pixel + 1 - c.pixels) / (2.0 * c.pixels);
        return std::asin((A + c.altitude) / R * std::sin(a)) - a;
    };
    for (int line = 0; line < c.lines; line++)
        for (int pixel = 0; pixel + 1 < c.pixels; pixel++) {
            double latitude[2], longitude[2], between;
            for (int k = 0; k < 2; k++) place(scan_index(&s, line, pixel + k), latitude[k], longitude[k]);
            geodesic.Inverse(latitude[0], longitude[0], latitude[1], longitude[1], between);
            double want = R * (angle(pixel + 1) - angle(pixel));
            worst = std::max(worst, std::fabs(between - want));
            EXPECT(std::fabs(between - want) < 1e-6, "pixel %d: %.9g m, and not %.9g", pixel, between, want);
        }
    std::printf("a sphere: neighbours are apart what trigonometry says, to %.2g m\n", worst);
    scan_end(&s);
}

// Below the camera a pixel is the height times its angle wide, and a line is as long as the ground runs.
void spaced_at_the_nadir()
{
    double worst[2] = {0, 0};
    for (int k = 0; k < 100; k++) {
        camera c = chosen(uniform(3e5, 1.2e6), 1e-4, 11, 3, 0.01);
        c.start = uniform(0, TURN), c.inclination = uniform(0, TURN / 2);
        sgt_geodetic_height ground = {0, 0, 0};
        scan s = scan_begin(&c);
        scan_meet(&s, {&sgt_geodetic_height_ops, &ground});
        size_t at = scan_index(&s, 1, 5), beside = scan_index(&s, 1, 6), next = scan_index(&s, 2, 5);
        double across, along, r = A + c.altitude, rate = std::sqrt(GM / r) / r,
                              latitude = DEGREE * s.latitude[at];
        Geodesic::WGS84().Inverse(s.latitude[at], s.longitude[at], s.latitude[beside], s.longitude[beside],
                                  across);
        Geodesic::WGS84().Inverse(s.latitude[at], s.longitude[at], s.latitude[next], s.longitude[next],
                                  along);
        double want_across = geodetic_of(of(s.o, at)).height * 1e-4 / 11;
        double turned = std::sqrt(rate * rate - 2 * rate * ROTATION * std::cos(c.inclination) +
                                  std::pow(ROTATION * std::cos(latitude), 2));
        double want_along = length(of(s.p, at)) * turned * 0.01;
        double off[2] = {across / want_across - 1, along / want_along - 1};
        for (int j = 0; j < 2; j++) worst[j] = std::max(worst[j], std::fabs(off[j]));
        EXPECT(std::fabs(off[0]) < 1e-4, "across: %g m, not %g", across,
               want_across); // the incidence is at most 0.2 degrees
        EXPECT(std::fabs(off[1]) < 1e-4, "along: %g m, not %g", along, want_along);
        scan_end(&s);
    }
    std::printf(
        "at the nadir: the sample distance is height times angle to %.2g, and speed times time to %.2g\n",
        worst[0], worst[1]);
}

} // namespace

int main()
{
    const char *seed = std::getenv("SAGITTA_TEST_SEED"), *scale = std::getenv("SAGITTA_TEST_SCALE");
    unsigned long long number = seed ? std::strtoull(seed, nullptr, 0) : 1;
    int orbits = std::max(1, static_cast<int>(25 * (scale ? std::atof(scale) : 0.5)));
    std::printf("line of sight: SAGITTA_TEST_SEED=%llu\n", number);
    random_bits.seed(number);
    flies();
    spaced_on_a_sphere();
    spaced_at_the_nadir();
    for (double h : {0.0, -100.0, 8848.0, 1e5}) {
        sgt_geodetic_height over = {0, 0, h};
        double slack = h == 0 ? 1e-7 : 1 + 1e-5 * std::fabs(h);
        look_at(
            {"geodetic_height", {&sgt_geodetic_height_ops, &over}, h, slack, slack, subject::HEIGHT, nullptr},
            orbits);
    }
    for (double h : {0.0, 1e4}) {
        sgt_level_gravity level = {h, 0};
        double slack = h == 0 ? 1e-6 : 1 + 0.01 * h;
        look_at(
            {"level_gravity", {&sgt_level_gravity_ops, &level}, h, slack, slack, subject::POTENTIAL, nullptr},
            orbits);
    }
    char path[4096];
    sgt_error error = {};
    if (!sgt_geoid_find(path, sizeof path, nullptr)) {
        std::printf("geoid: skipped, egm96_15.gtx is not installed\n");
    } else if (sgt_geoid *geoid = sgt_geoid_open(path, &error)) {
        sgt_geoid_height above = {geoid, 0};
        look_at({"geoid", {&sgt_geoid_height_ops, &above}, 0, 110, 90, subject::GEOID, geoid}, orbits);
        sgt_geoid_close(geoid);
    } else {
        EXPECT(false, "%s", error.words);
    }
    std::printf("%ld faults\n", faults);
    return faults ? 1 : 0;
}
