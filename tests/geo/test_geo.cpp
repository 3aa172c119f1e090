// SPDX-License-Identifier: MIT
// test_geo.cpp - the surfaces about the Earth as such: values and bounds against quadruple precision, what
// they promise of themselves, parameters and files that are wrong.  SAGITTA_TEST_SEED, SAGITTA_TEST_SCALE
// as everywhere.
#include "quad_earth.h"

#include <sagitta/diagnose.h>
#include <sagitta/geo.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>

namespace {

using earth::quad;
using earth::rounded;

int faults = 0;
std::mt19937_64 random_bits;
double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_bits); }
int whole(int most) { return static_cast<int>(random_bits() % static_cast<unsigned>(most)); }
long count = 2000;

bool expect(bool good, const char *what, const std::string &more = "")
{
    if (!good && ++faults <= 20) std::printf("%s %s\n", what, more.c_str());
    return good;
}

sgt_vec3 direction()
{
    double z = uniform(-1, 1), turn = uniform(0, 6.283185307179586), r = std::sqrt(1 - z * z);
    switch (whole(12)) { // the odd ones too
    case 0: return {0, 0, whole(2) ? 1.0 : -1.0};
    case 1: return {std::cos(turn), std::sin(turn), 0};
    case 2: return {r * 1e-7, 0, 1};
    default: return {r * std::cos(turn), r * std::sin(turn), z};
    }
}
sgt_vec3 times(double a, sgt_vec3 v) { return {a * v.x, a * v.y, a * v.z}; }
double dot(sgt_vec3 a, sgt_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
std::string text(sgt_vec3 p)
{
    char line[100];
    std::snprintf(line, sizeof line, "at %a %a %a", p.x, p.y, p.z);
    return line;
}

// ------------------------------------------------------ values and their bounds

void heights()
{
    double worst = 0, up_worst = 0, hessian = 0;
    for (double f : {0.0, earth::WGS84.f, 0.1, 0.5, -0.1, -1.0})
        for (long i = 0; i < count / 2; i++) {
            double a = f == earth::WGS84.f ? earth::WGS84.a : std::exp(uniform(-20, 20)), b = a * (1 - f),
                   thin = std::min(a, b), least = std::min(b / a * b, a / b * a);
            sgt_geodetic_height s = {f == earth::WGS84.f && whole(2) ? 0 : a, 0, a * uniform(-0.1, 0.1)};
            if (s.a != 0) s.f = f;
            earth::ellipsoid e = {a, f};
            sgt_vec3 p = times(a * std::exp(uniform(-0.3, whole(4) ? 0.5 : 8)), direction()), grad;
            earth::vec up;
            double exact = rounded(earth::height(e, earth::exact(p), &up));
            if (!(exact > -0.5 * least) || thin < 0.1 * a) continue;
            double got = sgt_geodetic_height_ops.value(&s, p, &grad),
                   bound = sgt_geodetic_height_ops.rounding(&s, p);
            double off = std::fabs(rounded(got - (earth::height(e, earth::exact(p)) - s.h)));
            worst = std::max(worst, off / bound);
            expect(off <= bound && bound < 1e-13 * (a + std::sqrt(dot(p, p)) + b),
                   "a height off by more than its bound", text(p));
            double turn = std::max({std::fabs(rounded(grad.x - up.x)), std::fabs(rounded(grad.y - up.y)),
                                    std::fabs(rounded(grad.z - up.z))});
            up_worst = std::max(up_worst, turn);
            expect(turn < 1e-14, "up is not up", text(p));
            double clear = sgt_geodetic_height_ops.clearance(&s, p);
            expect(clear <= std::fabs(rounded(earth::height(e, earth::exact(p)) - s.h)),
                   "a clearance that is too much", text(p));
            // the Hessian against differences of up in quadruple precision
            double second[6], *out[6], at[3] = {p.x, p.y, p.z};
            for (int j = 0; j < 6; j++) out[j] = &second[j];
            sgt_geodetic_height_ops.second(&s, 1, {{&at[0], &at[1], &at[2]}}, out);
            for (int j = 0, m = 0; j < 3; j++) {
                earth::vec from = earth::exact(p), to = from, u, v;
                quad step = a * 1e-9;
                (j == 0   ? from.x
                 : j == 1 ? from.y
                          : from.z) -= step,
                    (j == 0   ? to.x
                     : j == 1 ? to.y
                              : to.z) += step;
                earth::height(e, from, &u), earth::height(e, to, &v);
                quad row[3] = {(v.x - u.x) / (2 * step), (v.y - u.y) / (2 * step), (v.z - u.z) / (2 * step)};
                for (int k = j; k < 3; k++, m++) {
                    double wrong = std::fabs(rounded(row[k]) - second[m]) * a;
                    if (std::hypot(p.x, p.y) > 1e-5 * a)
                        hessian = std::max(hessian, wrong),
                        expect(wrong < 1e-9, "a second derivative is wrong", text(p));
                }
            }
        }
    std::printf("heights: at most %.2f of their bound off, up %.1g, second derivatives %.1g\n", worst,
                up_worst, hessian);
}

void gravity()
{
    double worst = 0, most = 0;
    for (long i = 0; i < count; i++) {
        sgt_level_gravity s = {whole(3) ? uniform(-1e5, 1e7) : 0, 0};
        sgt_vec3 p = times(std::exp(uniform(std::log(6.25e6), std::log(whole(2) ? 6.6e6 : 4.2e7))),
                           direction()),
                 grad;
        if (!(dot(p, p) < 42e6 * 42e6)) continue;
        double got = sgt_level_gravity_ops.value(&s, p, &grad), bound = sgt_level_gravity_ops.rounding(&s, p),
               off = std::fabs(rounded(got - earth::over_level(earth::exact(p), s.h)));
        worst = std::max(worst, off / bound), most = std::max(most, off);
        expect(off <= bound && bound < 5e-15 * 8e7, "a level off by more than its bound", text(p));
        double g3[3] = {grad.x, grad.y, grad.z};
        for (int j = 0; j < 3; j++) {
            earth::vec from = earth::exact(p), to = from;
            (j == 0 ? from.x : j == 1 ? from.y : from.z) -= 1, (j == 0 ? to.x : j == 1 ? to.y : to.z) += 1;
            expect(std::fabs(rounded((earth::over_level(to, s.h) - earth::over_level(from, s.h)) / 2) -
                             g3[j]) < 1e-12,
                   "the gradient of a level is wrong", text(p));
        }
        // the same level by its potential, and what a change of either does
        sgt_level_gravity by = {0, rounded(earth::potential({quad(earth::WGS84.a) + s.h, 0, 0}))};
        double other = sgt_level_gravity_ops.value(&by, p, nullptr);
        expect(std::fabs(other - got) <= 2 * bound, "by its potential a level is another", text(p));
        double at[3] = {p.x, p.y, p.z}, change, step = 1;
        sgt_values out = {&change, {nullptr, nullptr, nullptr}};
        sgt_points points = {{&at[0], &at[1], &at[2]}};
        sgt_level_gravity_ops.by_parameter(&s, 0, 1, points, out);
        double difference = rounded(earth::over_level(earth::exact(p), s.h + step) -
                                    earth::over_level(earth::exact(p), s.h - step)) /
                            2;
        expect(std::fabs(change - difference) < 1e-9, "what h does to a level is wrong", text(p));
        sgt_level_gravity more = by;
        more.potential += 64;
        sgt_level_gravity_ops.by_parameter(&by, 0, 1, points, out);
        if (more.potential <= 6.36e7)
            expect(std::fabs(change - (sgt_level_gravity_ops.value(&more, p, nullptr) - other) / 64) <
                       2e-5 * change,
                   "what U does to a level is wrong", text(p));
    }
    std::printf("levels of gravity: at most %.2f of their bound off, %.2g m\n", worst, most);
}

// --------------------------------------------------------- what they promise

sgt_ray some_ray()
{
    sgt_ray ray = {times(whole(3) ? uniform(6.4e6, 9e6) : uniform(1e7, 4.3e7), direction()), {}, 0, 0};
    double R = std::sqrt(dot(ray.o, ray.o)), impact = whole(2) ? uniform(0, 6.3e6) : uniform(6.3e6, 6.5e6);
    sgt_vec3 side = direction(), down = times(-1 / R, ray.o);
    double along = dot(side, down);
    side = {side.x - along * down.x, side.y - along * down.y, side.z - along * down.z};
    double length = std::sqrt(dot(side, side)), sine = std::min(1.0, impact / R),
           cosine = std::sqrt(1 - sine * sine), scale = whole(2) ? 1 : std::exp(uniform(-6, 6));
    if (!(length > 1e-3)) return some_ray();
    ray.d = {scale * (cosine * down.x + sine * side.x / length),
             scale * (cosine * down.y + sine * side.y / length),
             scale * (cosine * down.z + sine * side.z / length)};
    ray.tmax = 3 * R / scale;
    return ray;
}

bool same(double a, double b)
{
    return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
}

void promises(const char *name, sgt_surface s, const std::function<quad(const earth::vec &)> &F)
{
    std::vector<sgt_ray> rays;
    for (long i = 0; i < count / 20; i++) rays.push_back(some_ray());
    sgt_vec3 where;
    sgt_fault fault = sgt_check(s, rays.size(), rays.data(), &where);
    expect(fault == SGT_SOUND, name, std::string(sgt_fault_text(fault)) + " " + text(where));
    long proven = 0, tight = 0, asked = 0, decided = 0;
    double widest = 0;
    for (long i = 0; i < count; i++) {
        sgt_ray ray = some_ray();
        double along = std::sqrt(dot(ray.d, ray.d));
        // many are as one
        sgt_span one = s.ops->first(s.self, &ray), many;
        s.ops->firsts(s.self, 1,
                      {{&ray.o.x, &ray.o.y, &ray.o.z}, {&ray.d.x, &ray.d.y, &ray.d.z}, &ray.tmin, &ray.tmax},
                      {&many.lo, &many.hi, &many.seed, &many.single});
        expect((one.lo > one.hi && many.lo > many.hi) ||
                   (same(one.lo, many.lo) && same(one.hi, many.hi) && same(one.seed, many.seed) &&
                    one.single == many.single),
               name, "firsts are not first");
        decided += one.single || one.lo > one.hi;
        // the enclosure
        sgt_span span = s.ops->span(s.self, &ray);
        double t = span.lo <= span.hi ? uniform(span.lo, span.hi) : -dot(ray.o, ray.d) / dot(ray.d, ray.d),
               width = std::exp(uniform(-2, 14)) / along;
        sgt_interval over = {t, t + width}, slope = {NAN, NAN},
                     g = s.ops->enclose(s.self, &ray, over, &slope);
        for (int j = 0; j <= 8; j++) {
            quad at = over.lo + (quad(over.hi) - over.lo) * j / 8, step = 1e-3 / along;
            earth::vec p = earth::at(ray, at);
            if (!(p.x * p.x + p.y * p.y + p.z * p.z < quad(41e6) * 41e6)) continue;
            if (!(p.x * p.x + p.y * p.y + p.z * p.z > quad(6e6) * 6e6)) continue;
            quad value = F(p),
                 rate = (F(earth::at(ray, at + step)) - F(earth::at(ray, at - step))) / (2 * step);
            double doubt = 1e-9;
            expect(g.lo <= value + doubt && value - doubt <= g.hi, name, "F leaves its enclosure");
            expect(slope.lo <= rate + 1e-8 * along && rate - 1e-8 * along <= slope.hi, name,
                   "the slope leaves its enclosure");
            asked++;
        }
        if (width * along < 10)
            tight += slope.hi - slope.lo < 1e-3 * along,
                widest = std::max(widest, (g.hi - g.lo) / (width * along + 1e-7));
        // a proof
        sgt_options options = {};
        sgt_hit guess = sgt_intersect(s, ray, &options);
        options.proof = SGT_PROVE_FIRST;
        sgt_hit proof = sgt_intersect(s, ray, &options);
        proven += proof.status >= 0;
        expect(proof.status < 0 || guess.status < 0 ||
                   (proof.status == guess.status &&
                    (proof.status == SGT_MISS || std::fabs(proof.t - guess.t) <= proof.t_err + guess.t_err)),
               name, "the proof is of something else " + text(ray.o) + text(ray.d));
    }
    std::printf("%s: %ld of %ld first roots told by `first`, %ld proven; %ld samples in their enclosures, "
                "%ld tight\n",
                name, decided, count, proven, asked, tight);
    expect(decided > count * 9 / 10, name, "few first roots are told");
    expect(proven > count * 99 / 100, name, "few are proven");
}

// From afar, and looking outward from the geostationary orbit: the far sheet is never met.
void far_sheet()
{
    sgt_level_gravity s = {0, 0};
    expect(std::isnan(sgt_level_gravity_ops.value(&s, {1.5e8, 0, 0}, nullptr)) &&
               std::isnan(sgt_level_gravity_ops.value(&s, {0, 4.3e7, 0}, nullptr)),
           "defined far out");
    for (long i = 0; i < count; i++) {
        double longitude = uniform(0, 6.283185307179586), R = whole(2) ? 42164e3 : uniform(4.2e7, 1e9);
        sgt_ray ray = {{R * std::cos(longitude), R * std::sin(longitude), 0}, direction(), 0, 0};
        if (whole(2))
            ray.d = times(-1 / R, ray.o), ray.d.z = uniform(-0.2, 0.2) * 6.4e6 / R,
            ray.d.x += uniform(-1, 1) * 6e6 / R;
        if (whole(4) == 0) ray.tmin = -INFINITY, ray.tmax = INFINITY;
        sgt_hit all[4], hit = sgt_intersect({&sgt_level_gravity_ops, &s}, ray, nullptr);
        int n = sgt_intersect_all({&sgt_level_gravity_ops, &s}, ray, 4, all, nullptr);
        expect(hit.status >= 0 && (hit.status == SGT_MISS || dot(hit.p, hit.p) < 6.4e6 * 6.4e6),
               "the far sheet, or nothing decided", text(ray.o) + text(ray.d));
        expect(n >= 0 && n <= 2, "more than in and out", text(ray.o) + text(ray.d));
        for (int j = 0; j < n && j < 4; j++)
            expect(all[j].status > 0 && dot(all[j].p, all[j].p) < 6.4e6 * 6.4e6, "the far sheet among all",
                   text(ray.o) + text(ray.d));
    }
}

// --------------------------------------------------------------- what is wrong

const sgt_builtin *row(const char *type)
{
    for (const sgt_builtin *r = sgt_geo_builtins(); r->type; r++)
        if (std::string(r->type) == type) return r;
    return nullptr;
}

template <typename S> void objects(const char *type, const S &s, const char *key)
{
    sgt_objection o = row(type)->object(&s);
    std::string got = o.param ? o.param : "none";
    expect(got == (key ? key : "none"), type, "objects to " + got + ", not to " + (key ? key : "none"));
    sgt_vec3 grad = {0, 0, 0};
    double f = row(type)->ops->value(&s, {7e6, 0, 1}, &grad);
    expect(std::isnan(f) == (key != nullptr) || !key, type, "has a value with a wrong parameter");
    sgt_hit hit = sgt_intersect({row(type)->ops, &s}, {{7e6, 0, 1}, {-1, 0, 0}, 0, 0}, nullptr);
    if (key) expect(hit.status < 0, type, "is met with a wrong parameter");
    for (const sgt_param *p = row(type)->params; o.param && p->name; p++)
        if (std::string(p->name) == o.param) return;
    expect(!key || std::string(key) == "file", type, "objects to a key it has not");
}

void parameters()
{
    const double nan = NAN, inf = INFINITY;
    objects("geodetic_height", sgt_geodetic_height{0, 0, 0}, nullptr);
    objects("geodetic_height", sgt_geodetic_height{1, 0, 0}, nullptr);
    objects("geodetic_height", sgt_geodetic_height{6378137, -1, -100}, nullptr);
    objects("geodetic_height", sgt_geodetic_height{0, 0, -6.2e6}, nullptr);
    objects("geodetic_height", sgt_geodetic_height{0, 0, -6.3e6}, "h");
    objects("geodetic_height", sgt_geodetic_height{0, 0, nan}, "h");
    objects("geodetic_height", sgt_geodetic_height{0, 0, inf}, "h");
    objects("geodetic_height", sgt_geodetic_height{0, 0.1, 0}, "f");
    objects("geodetic_height", sgt_geodetic_height{1, 1, 0}, "f");
    objects("geodetic_height", sgt_geodetic_height{1, 2, 0}, "f");
    objects("geodetic_height", sgt_geodetic_height{1, nan, 0}, "f");
    objects("geodetic_height", sgt_geodetic_height{1, -inf, 0}, "f");
    objects("geodetic_height", sgt_geodetic_height{-1, 0, 0}, "a");
    objects("geodetic_height", sgt_geodetic_height{nan, 0, 0}, "a");
    objects("geodetic_height", sgt_geodetic_height{inf, 0, 0}, "a");
    objects("level_gravity", sgt_level_gravity{0, 0}, nullptr);
    objects("level_gravity", sgt_level_gravity{0, 6.26e7}, nullptr);
    objects("level_gravity", sgt_level_gravity{100, 6.26e7}, "potential");
    objects("level_gravity", sgt_level_gravity{0, -1}, "potential");
    objects("level_gravity", sgt_level_gravity{0, 1.4e7},
            "potential"); // that of 1.5 GM / r at the geostationary radius
    objects("level_gravity", sgt_level_gravity{0, 1e9}, "potential");
    objects("level_gravity", sgt_level_gravity{0, nan}, "potential");
    objects("level_gravity", sgt_level_gravity{3.6e7, 0}, "h");
    objects("level_gravity", sgt_level_gravity{-1e6, 0}, "h");
    objects("level_gravity", sgt_level_gravity{nan, 0}, "h");
    objects("geoid", sgt_geoid_height{nullptr, 0}, "file");
}

// A grid of the globe every ten degrees, or what is left of it.
std::string written(const char *name, double south, double west, double step_y, double step_x, unsigned rows,
                    unsigned columns, size_t bytes, const std::function<float(unsigned, unsigned)> &z)
{
    std::vector<unsigned char> out;
    auto whole_number = [&](uint64_t x, int n) {
        while (n--) out.push_back(static_cast<unsigned char>(x >> (8 * n)));
    };
    for (double x : {south, west, step_y, step_x}) {
        uint64_t bits;
        std::memcpy(&bits, &x, 8);
        whole_number(bits, 8);
    }
    whole_number(rows, 4), whole_number(columns, 4);
    for (unsigned i = 0; i < rows && i < 100; i++)
        for (unsigned j = 0; j < columns && j < 100; j++) {
            float x = z(i, j);
            uint32_t bits;
            std::memcpy(&bits, &x, 4);
            whole_number(bits, 4);
        }
    out.resize(std::min(bytes, out.size() + 1), 0);
    std::string path = name;
    std::FILE *file = std::fopen(name, "wb");
    if (file) std::fwrite(out.data(), 1, out.size(), file), std::fclose(file);
    return path;
}

void refused(const std::string &path, const char *because)
{
    sgt_error error;
    sgt_geoid *g = sgt_geoid_open(path.c_str(), &error);
    expect(!g && error.file == path && std::string(error.words).find(because) != std::string::npos,
           "a file that is wrong is not refused, or for another reason:", path + ": " + error.words);
    sgt_geoid_close(g);
    expect(!sgt_geoid_open(path.c_str(), nullptr), "an error that is not wanted");
}

void files()
{
    const char *name = "test_geo.gtx";
    auto flat = [](unsigned, unsigned) { return 1.0f; };
    const size_t all = 40 + 4 * 19 * 36;
    std::remove(name);
    refused(name, "cannot be opened");
    refused(written(name, -90, -180, 10, 10, 19, 36, 0, flat), "cut off in the header: 0 of 40");
    refused(written(name, -90, -180, 10, 10, 19, 36, 39, flat), "cut off in the header: 39 of 40");
    refused(written(name, -90, -180, 10, 10, 19, 36, 40, flat),
            "cut off: 40 bytes, and 19 rows of 36 columns need 2776");
    refused(written(name, -90, -180, 10, 10, 19, 36, all - 1, flat), "cut off: 2775 bytes");
    refused(written(name, -90, -180, 10, 10, 19, 36, all + 1, flat), "too long");
    refused(written(name, -90, -180, 10, 10, 4000000000u, 4000000000u, all, flat), "not a .gtx grid");
    refused(written(name, -90, -180, 10, 10, 0, 36, all, flat), "not a .gtx grid");
    refused(written(name, -90, -180, 1.0 / 120, 1.0 / 120, 21601, 43200, all, flat), "cut off");
    refused(written(name, -80, -180, 10, 10, 19, 36, all, flat), "not a grid of the globe");
    refused(written(name, -90, -180, 10, NAN, 19, 36, all, flat), "not a grid of the globe");
    refused(written(name, -90, -180, 10, 5, 19, 36, all, flat), "not a grid of the globe");
    refused(written(name, -90, -180, 10, 10, 19, 36, all,
                    [](unsigned i, unsigned j) { return i == 3 && j == 5 ? -88.8888f : 1.0f; }),
            "row 4, column 6 has no height");
    refused(written(name, -90, -180, 10, 10, 19, 36, all,
                    [](unsigned i, unsigned j) { return i == 18 && j == 35 ? NAN : 1.0f; }),
            "row 19, column 36 has no height");
    for (unsigned pole : {0u, 18u}) // N would have a step there, which no bound of its slope holds
        refused(written(name, -90, -180, 10, 10, 19, 36, all,
                        [pole](unsigned i, unsigned j) { return i == pole && j == 7 ? 1.0001f : 1.0f; }),
                ("the heights of a pole differ: row " + std::to_string(pole + 1) +
                 " has 1.000000 in column 1 and 1.000100 in column 8")
                    .c_str());
    refused(".", "cannot be");

    // a smooth geoid: the nodes are met, the seam and the poles are crossed without a step
    auto smooth = [](unsigned i, unsigned j) {
        return static_cast<float>(10 * std::sin(i * 0.17453292519943295) * std::cos(j * 0.17453292519943295) +
                                  i);
    };
    sgt_error error = {};
    sgt_geoid *g = sgt_geoid_open(written(name, -90, 170, 10, 10, 19, 36, all, smooth).c_str(), &error);
    if (!expect(g, "a geoid that is right is refused:", error.words)) return;
    for (unsigned i = 0; i < 19; i++)
        for (unsigned j = 0; j < 36; j++)
            expect(std::fabs(sgt_geoid_undulation(g, -90 + 10.0 * i, 170 + 10.0 * j) -
                             static_cast<double>(smooth(i, j))) < 1e-12,
                   "a node is not met");
    for (double y = -89; y < 90; y += 7.3)
        for (double x : {170.0, -170.0, 180.0, 530.0, 0.0})
            expect(std::fabs(sgt_geoid_undulation(g, y, x - 1e-9) - sgt_geoid_undulation(g, y, x + 1e-9)) <
                       1e-8,
                   "a step at the seam");
    expect(std::isnan(sgt_geoid_undulation(g, 90.001, 0)) && std::isnan(sgt_geoid_undulation(g, NAN, 0)) &&
               std::isnan(sgt_geoid_undulation(g, 0, INFINITY)),
           "an undulation of nowhere");
    // the gradient is continuous across every line: both sides of 10 degrees
    sgt_geoid_height s = {g, 0};
    for (long i = 0; i < count; i++) {
        double lat = (10 * whole(17) - 80 + (whole(2) ? uniform(1, 9) : 0)) * 0.017453292519943295,
               lon = 10 * whole(36) * 0.017453292519943295;
        double c = std::cos(lat), t = std::tan(lat) * (1 - earth::WGS84.f);
        sgt_vec3 p = {6.4e6 * c * std::cos(lon), 6.4e6 * c * std::sin(lon), 6.4e6 * c * t}, q = p, a, b;
        p.x += 1e-3, p.y -= 2e-3, p.z += 1e-3, q.x -= 1e-3, q.y += 2e-3, q.z -= 1e-3;
        sgt_geoid_height_ops.value(&s, p, &a), sgt_geoid_height_ops.value(&s, q, &b);
        expect(std::fabs(a.x - b.x) + std::fabs(a.y - b.y) + std::fabs(a.z - b.z) < 1e-8, "a kink", text(p));
    }
    sgt_geoid_close(g);
    sgt_geoid_close(nullptr);
    std::remove(name);
}

} // namespace

int main()
{
    const char *seed = std::getenv("SAGITTA_TEST_SEED"), *scale = std::getenv("SAGITTA_TEST_SCALE");
    unsigned long long number = seed ? std::strtoull(seed, nullptr, 0) : 1;
    count = std::max(200L, static_cast<long>(2000 * (scale ? std::atof(scale) : 0.5)));
    std::printf("the Earth: SAGITTA_TEST_SEED=%llu\n", number);
    random_bits.seed(number);
    heights();
    gravity();
    for (double h : {0.0, -100.0, 1e5}) {
        sgt_geodetic_height over = {0, 0, h};
        promises("geodetic_height", {&sgt_geodetic_height_ops, &over},
                 [&](const earth::vec &p) { return earth::height(earth::WGS84, p) - h; });
        sgt_level_gravity level = {h * 10, 0};
        promises("level_gravity", {&sgt_level_gravity_ops, &level},
                 [&](const earth::vec &p) { return earth::over_level(p, h * 10); });
    }
    sgt_geodetic_height egg = {6.4e6, -0.2, -1000}, lens = {6.4e6, 0.3, 1000};
    promises("prolate", {&sgt_geodetic_height_ops, &egg}, [&](const earth::vec &p) {
        return earth::height({6.4e6, -0.2}, p) + 1000;
    });
    promises("oblate", {&sgt_geodetic_height_ops, &lens}, [&](const earth::vec &p) {
        return earth::height({6.4e6, 0.3}, p) - 1000;
    });
    char path[4096];
    sgt_error error = {};
    earth::grid grid;
    if (!sgt_geoid_find(path, sizeof path, nullptr)) {
        std::printf("geoid: skipped, egm96_15.gtx is not installed\n");
    } else if (sgt_geoid *geoid = sgt_geoid_open(path, &error);
               expect(geoid && grid.read(path), path, error.words)) {
        sgt_geoid_height above = {geoid, 10};
        for (long i = 0; i < count; i++) {
            double latitude = whole(10) ? uniform(-90, 90) : 90 * (whole(3) - 1),
                   longitude = uniform(-180, 180);
            expect(std::fabs(sgt_geoid_undulation(geoid, latitude, longitude) -
                             grid.undulation(latitude, longitude)) < 1e-12 * 110,
                   "N is not that of another reader");
        }
        promises("geoid", {&sgt_geoid_height_ops, &above},
                 [&](const earth::vec &p) { return grid.over(p, 10); });
        sgt_geoid_close(geoid);
    }
    far_sheet();
    parameters();
    files();
    std::printf("%d faults\n", faults);
    return faults ? 1 : 0;
}
