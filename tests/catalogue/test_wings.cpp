// SPDX-License-Identifier: MIT
// The first root of sags without a rim.  Coming from afar the ray passes the wings, which a departure of
// high powers makes as steep as can be, and a wing may be met before what is near the axis is.  Leaving
// from beside the surface it may meet one, too, or none: with an end to the ray, or as far as the surface
// goes.  From the side it comes nearly parallel to the vertex plane, or from far out beside the surface, and
// may miss.
//
// The judge is F in 113 bits (formulas.h), at points between the start and the root that are closer
// together the nearer they are to the axis and to the root:
//     a hit           F has unlike signs on either side of t, as far off as t_err says (and no rounding);
//     the first       F has one sign from the start, or the edge of its domain, up to it;
//     a miss          F has one sign from the start to the end, or the edge of its domain; of rays that
//                     come, none;
//     undecided       seldom: rays that come have no end, but there is a root near the axis on each.
// Where the base ends, rays start next to its edge, too, inward and outward.  There a hit takes some 12
// evaluations in the mean (observed), and 20 at most.
// Batches and single rays are the same to the last bit.
//
// LEAVING.  Rays from hits, of types with a rim and without, in directions of the whole sphere and along the
// surface, a tenth of them from next to the axis: by sgt_leave, one by one and in batches.  The judge is the
// same, from a millionth of the size on.  What is undecided are rays of a few specimens that have spent their
// evaluations far out: less than one in five of a type (observed), or all of two specimens.
//
// GRAZING.  Mirrors of beamlines (toroids, biconics, cylinders with one curvature a hundred times the other),
// bowls of other types and conics, with a rim and without.  Rays run at 0.1 to 45 degrees to the surface,
// along the axis of the mirror or across, or through a bowl parallel to the vertex plane.  A fifth of them
// start on the surface, and leave it.  The judge is the same, on the part of the ray within the rim; of rays
// that leave it looks from a millionth of the size on.  First roots take some 5 evaluations with a rim
// (observed), where enclosures took 30 and more; a tenth of the hits without one may need them.
//
// PAIRS.  Rays through two points of a surface that are near each other meet it there twice, or touch it.
// What a march knows of the second derivative is all that keeps it from passing over both, so the draw of
// such rays reaches every bound that it rests on: with a rim and without, from nearby and from afar, with
// each proof.  The judge is F in 113 bits at three points, before, between and behind; if they tell two roots
// apart, the answer has to be before the second, or undecided.
#include "../ends.h"
#include "specimens.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>

using namespace catalogue;

namespace {

std::map<std::string, int> failed;

void fail(const char *what, const specimen &s, const sgt_ray &r, const sgt_hit &h)
{
    if (failed[s.type + ": " + what]++ > 2) return;
    std::printf(
        "%s: %s\n    ray %.17g %.17g %.17g, %.17g %.17g %.17g\n    %s, t = %.17g +- %.3g, r = %.3g h\n    ",
        s.type.c_str(), what, r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, sgt_status_text(h.status), h.t,
        h.t_err, std::hypot(h.p.x, h.p.y) / s.h);
    print_surface(s.s);
}

quad along(const formula<quad> &f, const sgt_ray &r, quad t)
{
    return f(quad(r.o.x) + t * quad(r.d.x), quad(r.o.y) + t * quad(r.d.y), quad(r.o.z) + t * quad(r.d.z));
}

int sign(quad x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

// The sign of F at the last of these t if it has one sign at all of them, 0 if it has none there; CHANGES if
// it changes from one to the next.  Across a gap of the domain it may: so they are taken in order.
constexpr int CHANGES = 2;
int one_sign(const formula<quad> &f, const sgt_ray &r, std::vector<double> at)
{
    int before = 0;
    std::sort(at.begin(), at.end());
    for (double t : at) {
        const quad g = along(f, r, t);
        const int is = g == g ? sign(g) : 0;
        if (g != g) before = 0;
        if (is && before && is != before) return CHANGES;
        if (is) before = is;
    }
    return before;
}

// Has F more than one sign from the start to `to`, as far as 600 points tell?
bool earlier(const formula<quad> &f, const sgt_ray &r, quad to)
{
    const double a = r.d.x * r.d.x + r.d.y * r.d.y, nearest = -(r.o.x * r.d.x + r.o.y * r.d.y) / a,
                 end = static_cast<double>(to);
    std::vector<double> at;
    for (int i = 0; i < 600; i++) {
        const double part = (i + 0.5) / 600;
        // half of them crowd together at the axis, half at the root
        const double centre = i % 2 ? end : std::min(nearest, end),
                     t = centre - (centre - r.tmin) * std::pow(1e-6, part);
        if (t >= r.tmin && t < end) at.push_back(t);
    }
    const int before = one_sign(f, r, at);
    return before == CHANGES || (before && sign(along(f, r, to)) == -before);
}

// Has F more than one sign from the start to where the ray ends, or F is no more, as far as 600 points
// tell?
bool changes(const formula<quad> &f, const sgt_ray &r, double h)
{
    const double length = std::hypot(r.d.x, r.d.y, r.d.z), from = r.tmin;
    double end = std::min(r.tmax, from + 1e4 * h / length);
    if (along(f, r, end) != along(f, r, end) && along(f, r, from) == along(f, r, from)) {
        double in = from;
        for (int i = 0; i < 60; i++) {
            const double middle = in + (end - in) / 2;
            (along(f, r, middle) == along(f, r, middle) ? in : end) = middle;
        }
        end = in;
    }
    const double nearest = -(r.o.x * r.d.x + r.o.y * r.d.y) / (r.d.x * r.d.x + r.d.y * r.d.y),
                 centre = std::min(std::max(nearest, from), end);
    std::vector<double> at;
    for (int i = 0; i < 600; i++) {
        const double part = std::pow(1e-9, i / 600.0),
                     near = i % 6 == 5 ? centre + part * (end - centre) : centre - part * (centre - from);
        at.push_back(i == 599     ? end
                     : i % 3 == 2 ? near
                     : i % 3 == 1 ? end - part * (end - from)
                                  : from + (end - from) / (1e9 * part));
    }
    return one_sign(f, r, at) == CHANGES;
}

// Rays that start next to the edge of the base, on the surface or beside it.
void beside_edge(generator &g, int rays)
{
    long hits = 0, evals = 0, undecided = 0;
    for (int i = 0; i < rays; i++) {
        const double c = 0.1, k = g.chance(0.5) ? 0 : g.uniform(-0.9, 1), edge = 1 / (c * std::sqrt(1 + k)),
                     size = edge * g.log_uniform(1e-4, 0.1);
        std::vector<double> terms(16);
        sgt_odd_asphere odd = {c, k, 0, {}};
        for (int j = 3; j < 16; j++) terms[std::size_t(j)] = g.uniform(-0.5, 0.5) * size;
        for (int j = 2; j < 10; j++) odd.a[j] = g.uniform(-0.5, 0.5) * size * std::pow(edge, -j - 1);
        const sgt_zernike zernike = {c, k, 0, edge, SGT_FRINGE, 0, {terms.data(), 1, 16}};
        specimen s = {};
        s.type = "beside the edge", s.h = edge;
        s.s =
            g.chance(0.5) ? sgt_surface{&sgt_zernike_ops, &zernike} : sgt_surface{&sgt_odd_asphere_ops, &odd};
        const double r = edge * (1 - g.log_uniform(1e-6, 0x1p-8)), about = g.uniform(0, 6.283185307179586),
                     x = r * std::cos(about), y = r * std::sin(about), tilt = g.uniform(-1.5, 1.5),
                     to = about + g.uniform(-1.5, 1.5),
                     back = g.chance(0.5) ? 0 : edge * g.log_uniform(1e-3, 100);
        const sgt_vec3 d = {std::cos(to) * std::cos(tilt), std::sin(to) * std::cos(tilt), std::sin(tilt)};
        const double z = -formula<double>(s.s)(x, y, 0.0) + g.sign() * edge * g.log_uniform(1e-9, 0.5);
        const sgt_ray ray = {{x - back * d.x, y - back * d.y, z - back * d.z}, d, back, INFINITY};
        const sgt_hit h = sgt_intersect(s.s, ray, nullptr);
        const formula<quad> exact(s.s);
        undecided += h.status < 0;
        if (h.status == SGT_MISS && changes(exact, ray, s.h)) fail("a miss that meets", s, ray, h);
        if (h.status != SGT_HIT) continue;
        hits++, evals += h.evals;
        const quad at = quad(h.t) + quad(h.t_lo), off = quad(h.t_err) * (1 + quad(0x1p-20)),
                   left = along(exact, ray, at - off), right = along(exact, ray, at + off);
        if (left == left && right == right && sign(left) * sign(right) > 0)
            fail("no root within t_err", s, ray, h);
    }
    const double mean = static_cast<double>(evals) / static_cast<double>(hits);
    std::printf("beside the edge: %d rays, %ld hits by %.1f evaluations, %ld undecided\n", rays, hits, mean,
                undecided);
    if (!(mean < 20)) failed["beside the edge: too many evaluations"]++;
    if (undecided * 20 > rays) failed["beside the edge: too many are undecided"]++;
}

// Does F change its sign where r <= rim (0: anywhere), between these t, as far as 500 points tell.
bool changes_within(const formula<quad> &f, const sgt_ray &r, double rim, double start, double to)
{
    const double a = r.d.x * r.d.x + r.d.y * r.d.y, nearest = -(r.o.x * r.d.x + r.o.y * r.d.y) / a,
                 x = r.o.x + nearest * r.d.x, y = r.o.y + nearest * r.d.y,
                 half = std::sqrt(std::max(rim * rim - x * x - y * y, 0.0) / a);
    const double from = std::max(start, rim > 0 ? nearest - half : start),
                 end = std::min(to, rim > 0 ? nearest + half : to);
    std::vector<double> at;
    for (int i = 0; i < 500 && from < end; i++) {
        const double part = (i + 0.5) / 500;
        at.push_back(i % 2 ? from + part * (end - from) : end - (end - from) * std::pow(1e-6, part));
    }
    return one_sign(f, r, at) == CHANGES;
}

// Does the ray, which starts next to the surface, meet it before `to`, but certainly farther on than the
// rule of the start reaches (accept.h)?
bool beyond_start(const formula<quad> &f, const specimen &s, const sgt_ray &r, double to)
{
    const int before = sign(along(f, r, 0));
    if (!before || sign(along(f, r, to)) != -before) return false;
    quad in = 0, out = to;
    for (int i = 0; i < 120; i++) {
        const quad middle = (in + out) / 2;
        (sign(along(f, r, middle)) == before ? in : out) = middle;
    }
    sgt_vec3 n;
    s.s.ops->value(s.s.self, r.o, &n);
    const double terms = std::fabs(r.o.x * n.x) + std::fabs(r.o.y * n.y) + std::fabs(r.o.z * n.z),
                 slope = std::fabs(n.x * r.d.x + n.y * r.d.y + n.z * r.d.z);
    return in > quad(16 * (0x1p-48 * terms / slope)); // the sag has terms of its own
}

void grazing(generator &g, int surfaces)
{
    constexpr int RAYS = 20;
    long hits[2] = {0, 0}, evals[2] = {0, 0}, misses = 0, undecided = 0, rays = 0;
    long leavers = 0, left_evals = 0;
    for (int n = 0; n < surfaces; n++) {
        const int kind = n % 6;
        const bool bare = g.chance(0.3), mirror = kind < 3;
        const double size = g.log_uniform(1e-3, 1e3), narrow = size * g.uniform(1.2, 4),
                     rim = bare ? 0 : size * g.uniform(0.3, 1), c = g.sign() / narrow,
                     weak = g.sign() / (size * g.log_uniform(20, 1000)), k = g.uniform(-2, 1);
        std::vector<double> terms(11);
        const double strong = g.chance(0.7) ? 0.01 : 0.1; // strong ones have several roots close together
        for (std::size_t j = 4; j < terms.size(); j++) terms[j] = g.uniform(-strong, strong) * size;
        const sgt_toroidal toroid = {weak, g.uniform(-1, 0), c, rim, {}};
        const sgt_biconic biconic = {c, k, weak, 0, rim};
        const sgt_biconic cylinder = {g.chance(0.5) ? c : 0, k, 0, 0, rim};
        sgt_odd_asphere odd = {0.5 * c, k, rim, {}};
        odd.a[2] = g.uniform(-0.02, 0.02) / (size * size),
        odd.a[3] = g.uniform(-0.01, 0.01) / (size * size * size);
        const sgt_zernike zernike = {0.5 * c, k, rim, size, SGT_NOLL, 0, {terms.data(), 1, terms.size()}};
        const sgt_conic conic = {g.chance(0.5) ? c : weak, k, rim};
        const sgt_surface all[] = {{&sgt_toroidal_ops, &toroid},  {&sgt_biconic_ops, &biconic},
                                   {&sgt_biconic_ops, &cylinder}, {&sgt_odd_asphere_ops, &odd},
                                   {&sgt_zernike_ops, &zernike},  {&sgt_conic_ops, &conic}};
        specimen s = {};
        s.type = "grazing", s.h = size, s.s = all[kind];
        const formula<double> rough(s.s);
        const formula<quad> exact(s.s);
        // along the weak axis of a mirror, nearly, or anywhere
        const double angle = g.log_uniform(0.1, 45) * 3.14159 / 180,
                     to = mirror && g.chance(0.7) ? 1.570796 + g.uniform(-0.02, 0.02) : g.uniform(0, 6.28),
                     away = size * (g.chance(0.5) ? g.log_uniform(0.01, 3) : g.log_uniform(3, 300));
        const bool leaves = g.chance(0.2);
        const double far = leaves ? 0 : away, begin = leaves ? 1e-6 * size : 0;
        const bool level = !mirror && g.chance(0.5);
        std::vector<double> in[6], out[3];
        std::vector<sgt_ray> ray;
        for (int i = 0; i < RAYS; i++) {
            const double r = 0.9 * (bare ? 0.5 * size : rim) * std::sqrt(g.uniform(0, 1)),
                         about = g.uniform(0, 6.28), x = r * std::cos(about), y = r * std::sin(about),
                         z = -rough(x, y, 0.0),
                         tilt = level ? g.uniform(-0.02, 0.02) : (g.chance(0.5) ? 1 : -1) * angle;
            const sgt_vec3 d = {std::cos(tilt) * std::cos(to), std::cos(tilt) * std::sin(to), std::sin(tilt)};
            const double ulps = g.chance(0.5) ? 0 : size * g.log_uniform(1e-17, 1e-13),
                         past = leaves           ? g.sign() * ulps
                                : g.chance(0.8) ? 0
                                                : g.sign() * size * g.log_uniform(1e-4, 0.3);
            if (z == z) ray.push_back({{x - far * d.x, y - far * d.y, z - far * d.z + past}, d, 0, INFINITY});
        }
        const std::size_t count = ray.size();
        if (!count) continue;
        std::vector<sgt_status> status(count);
        for (std::vector<double> &a : in) a.resize(count);
        for (std::vector<double> &a : out) a.resize(count);
        for (std::size_t i = 0; i < count; i++) {
            const double of[] = {ray[i].o.x, ray[i].o.y, ray[i].o.z, ray[i].d.x, ray[i].d.y, ray[i].d.z};
            for (int j = 0; j < 6; j++) in[j][i] = of[j];
        }
        const sgt_rays many = {{in[0].data(), in[1].data(), in[2].data()},
                               {in[3].data(), in[4].data(), in[5].data()},
                               nullptr,
                               nullptr};
        sgt_hits told = {};
        told.status = status.data(), told.t = out[0].data(), told.t_err = out[1].data(),
        told.p_err = out[2].data();
        sgt_intersect_batch(s.s, count, many, told, nullptr);
        for (std::size_t i = 0; i < count; i++) {
            const sgt_hit h = sgt_intersect(s.s, ray[i], nullptr);
            const double one[] = {h.t, h.t_err, h.p_err};
            bool same = h.status == status[i];
            for (int j = 0; j < 3; j++)
                same = same && (std::memcmp(&one[j], &out[j][i], sizeof one[j]) == 0 ||
                                (one[j] != one[j] && out[j][i] != out[j][i]));
            if (!same) fail("a batch is not the single ray", s, ray[i], h);
            rays++, undecided += h.status < 0, misses += h.status == SGT_MISS;
            leavers += leaves, left_evals += leaves ? h.evals : 0;
            const double inside = rim * (1 - 1e-9);
            if (h.status == SGT_MISS && changes_within(exact, ray[i], inside, begin, 4 * far + 4 * size))
                fail("a miss that meets", s, ray[i], h);
            if (leaves && h.status == SGT_MISS && !(rim > 0 && std::hypot(ray[i].o.x, ray[i].o.y) > inside) &&
                beyond_start(exact, s, ray[i], begin))
                fail("a miss that meets next to the start", s, ray[i], h);
            if (h.status != SGT_HIT) continue;
            if (!leaves) hits[bare]++, evals[bare] += h.evals;
            const quad at = quad(h.t) + quad(h.t_lo), off = quad(h.t_err) * (1 + quad(0x1p-20)),
                       left = along(exact, ray[i], at - off), right = along(exact, ray[i], at + off);
            if (left == left && right == right && sign(left) * sign(right) > 0)
                fail("no root within t_err", s, ray[i], h);
            if (changes_within(exact, ray[i], inside, begin, static_cast<double>(at - off)))
                fail("another root is nearer", s, ray[i], h);
        }
    }
    std::printf(
        "grazing: %ld rays, %ld hits with a rim by %.1f evaluations, %ld without by %.1f, %ld misses, "
        "%ld undecided; %ld leave, by %.1f\n",
        rays, hits[0], static_cast<double>(evals[0]) / static_cast<double>(hits[0]), hits[1],
        static_cast<double>(evals[1]) / static_cast<double>(hits[1]), misses, undecided, leavers,
        static_cast<double>(left_evals) / static_cast<double>(leavers));
    if (!(static_cast<double>(evals[0]) < 12 * static_cast<double>(hits[0])))
        failed["grazing: too many evaluations"]++;
    // (seeds leave from 0.5 to 1.1 in a hundred, most on strong ripples)
    if (undecided * 50 > rays) failed["grazing: too many are undecided"]++;
}

void pairs(generator &g, const char *type, int surfaces)
{
    long rays = 0, hits = 0, undecided = 0;
    for (int n = 0; n < surfaces; n++) {
        const specimen s = random_specimen(g, type);
        const formula<double> rough(s.s);
        const formula<quad> exact(s.s);
        for (int i = 0; i < 40; i++) {
            const double r = s.h * std::sqrt(g.uniform(0, 0.9)), about = g.uniform(0, 6.28),
                         to = g.uniform(0, 6.28), apart = s.h * g.log_uniform(1e-4, 0.5);
            const sgt_vec3 a = {r * std::cos(about), r * std::sin(about), 0},
                           b = {a.x + apart * std::cos(to), a.y + apart * std::sin(to), 0};
            const double low = -rough(a.x, a.y, 0.0), high = -rough(b.x, b.y, 0.0),
                         before = g.chance(0.7) ? apart * g.log_uniform(1, 100) : s.h * g.log_uniform(1, 1e4);
            if (!(std::hypot(b.x, b.y) < s.h) || low != low || high != high) continue;
            const sgt_vec3 d = {(b.x - a.x) / apart, (b.y - a.y) / apart, (high - low) / apart};
            const sgt_ray ray = {
                {a.x - before * d.x, a.y - before * d.y, low - before * d.z}, d, 0, INFINITY};
            const quad middle = before + 0.5 * apart, wide = 0.5 * g.uniform(0.6, 0.95) * apart;
            const int there = sign(along(exact, ray, middle));
            bool parted = false; // a root is between `middle - w` and the middle
            for (int k = 1; k <= 3; k++)
                parted = parted || sign(along(exact, ray, middle - wide * k)) == -there;
            const quad begins = along(exact, ray, 0); // of a plane the ray runs in it: all of it is the start
            if (!there || !parted || (begins < 0 ? -begins : begins) < quad(1e-12 * s.h)) continue;
            rays++;
            for (sgt_proof proof : {SGT_ESTIMATE, SGT_PROVE_ROOT, SGT_PROVE_FIRST}) {
                sgt_options options = {};
                options.proof = proof, options.pick = SGT_FIRST;
                const sgt_hit h = sgt_intersect(s.s, ray, &options);
                if (proof == SGT_ESTIMATE) hits += h.status == SGT_HIT, undecided += h.status < 0;
                const double inside = s.rim * (1 - 1e-9);
                const quad x = quad(ray.o.x) + middle * quad(d.x), y = quad(ray.o.y) + middle * quad(d.y),
                           rim = inside;
                if (s.rim > 0 && (!(std::hypot(a.x, a.y) < inside) || !(x * x + y * y < rim * rim))) continue;
                if (h.status == SGT_MISS || (h.status == SGT_HIT && quad(h.t) - quad(h.t_err) > middle))
                    fail("a pair of roots is passed over", s, ray, h);
            }
        }
    }
    std::printf("%-14s %6ld rays through a pair of roots, %6ld hits, %4ld undecided\n", type, rays, hits,
                undecided);
}

void leaving(generator &g, const char *type, int surfaces)
{
    constexpr int RAYS = 40;
    long rays = 0, misses = 0, undecided = 0, evals = 0;
    for (int n = 0; n < surfaces; n++) {
        const specimen s = random_specimen(g, type);
        const formula<quad> exact(s.s);
        const double begin = 1e-6 * s.h, inside = s.rim > 0 ? s.rim * (1 - 1e-9) : 0;
        std::vector<sgt_start> all;
        for (int i = 0; i < RAYS; i++) {
            const double r = s.h * std::sqrt(g.uniform(0, 0.9)) * (g.chance(0.1) ? 1e-2 : 1),
                         about = g.uniform(0, 6.28), z = g.uniform(-1, 1), to = g.uniform(0, 6.28);
            const sgt_vec3 above = {r * std::cos(about), r * std::sin(about), 10 * s.h};
            const sgt_ray down = {above, {0, 0, -1}, 0, INFINITY};
            const sgt_hit at = sgt_intersect(s.s, down, nullptr);
            if (at.status != SGT_HIT) continue;
            double rise = z;
            if (g.chance(0.3)) rise = -(at.n.x * std::cos(to) + at.n.y * std::sin(to)) + g.uniform(-0.1, 0.1);
            const double across = rise != z ? 1 : std::sqrt(1 - z * z);
            all.push_back({at.p,
                           at.n,
                           at.p_err,
                           {across * std::cos(to), across * std::sin(to), rise},
                           g.chance(0.2) ? s.h * g.log_uniform(0.01, 10) : 0.0,
                           {}});
        }
        const std::size_t count = all.size();
        std::vector<double> in[11], out[2];
        std::vector<sgt_status> status(count);
        std::vector<signed char> sides(count);
        for (const sgt_start &a : all) {
            const double of[] = {a.p.x, a.p.y, a.p.z, a.n.x,   a.n.y, a.n.z,
                                 a.d.x, a.d.y, a.d.z, a.p_err, a.tmax};
            for (int k = 0; k < 11; k++) in[k].push_back(of[k]);
        }
        for (std::vector<double> &a : out) a.resize(count);
        sgt_starts from = {};
        for (int k = 0; k < 3; k++)
            from.p[k] = in[k].data(), from.n[k] = in[3 + k].data(), from.d[k] = in[6 + k].data();
        from.p_err = in[9].data(), from.tmax = in[10].data();
        sgt_hits told = {};
        told.status = status.data(), told.t = out[0].data(), told.t_err = out[1].data();
        sgt_leave_batch(s.s, count, from, told, sides.data(), nullptr);
        for (std::size_t i = 0; i < count; i++) {
            const sgt_crossing c = sgt_leave(s.s, &all[i], nullptr);
            const sgt_hit &h = c.hit;
            const double end = all[i].tmax > 0 ? all[i].tmax : INFINITY;
            sgt_ray ray = c.ray;
            ray.tmin = begin, ray.tmax = end;
            if (h.status != status[i] || c.side != sides[i] ||
                (h.status > 0 && (h.t != out[0][i] || h.t_err != out[1][i])))
                fail("a batch is not the single start", s, ray, h);
            rays++, misses += h.status == SGT_MISS, undecided += h.status < 0, evals += h.evals;
            const double reach = std::min(end, 1e3 * s.h);
            if (h.status == SGT_MISS &&
                (inside > 0 ? changes_within(exact, ray, inside, begin, reach) : changes(exact, ray, s.h)))
                fail("a miss that meets", s, ray, h);
            const bool within = !(inside > 0 && std::hypot(ray.o.x, ray.o.y) > inside) && end > begin;
            if (h.status == SGT_MISS && within && beyond_start(exact, s, ray, begin))
                fail("a miss that meets next to the start", s, ray, h);
            if (h.status != SGT_HIT || !(h.t > begin)) continue;
            const quad at = quad(h.t) + quad(h.t_lo), off = quad(h.t_err) * (1 + quad(0x1p-20)),
                       left = along(exact, ray, at - off), right = along(exact, ray, at + off);
            if (left == left && right == right && sign(left) * sign(right) > 0)
                fail("no root within t_err", s, ray, h);
            if (inside > 0 ? changes_within(exact, ray, inside, begin, static_cast<double>(at - off))
                           : earlier(exact, ray, at - off))
                fail("another root is nearer", s, ray, h);
        }
    }
    std::printf("%-14s %6ld starts, %6ld misses, %4ld undecided, %.1f evaluations\n", type, rays, misses,
                undecided, static_cast<double>(evals) / static_cast<double>(rays));
    if (undecided * 4 > rays + 8 * RAYS) failed[std::string(type) + ": too many starts are undecided"]++;
}

}  // namespace

int main()
{
    const char *seed = std::getenv("SAGITTA_TEST_SEED"), *scale = std::getenv("SAGITTA_TEST_SCALE"),
               *only = std::getenv("SAGITTA_TEST_TYPE");
    const std::uint64_t from = seed ? std::strtoull(seed, nullptr, 0) : 14;
    const int rounds = static_cast<int>(9 * (scale ? std::atof(scale) : 0.5));
    constexpr int RAYS = 24;
    std::printf("seed %llu\n", static_cast<unsigned long long>(from));
    for (const char *type : sags) {
        if (only && std::string(only) != type) continue;
        generator g(from ^ (static_cast<std::uint64_t>(type[0]) << 8 | static_cast<std::uint64_t>(type[2])));
        long rays = 0, decided = 0, wings = 0, leaving = 0, told = 0, misses = 0;
        for (int round = 0; round < rounds; round++) {
            specimen s = random_specimen(g, type);
            while (s.rim > 0) s = random_specimen(g, type);
            const formula<double> rough(s.s);
            const formula<quad> exact(s.s);
            const double away = s.h * g.log_uniform(3, 3e4);
            const bool side = round % 4 == 3, leave = round % 2; // either may miss
            std::vector<sgt_ray> all;
            for (int i = 0; i < RAYS; i++) {
                const double r = s.h * std::sqrt(g.uniform(0, 0.9)), about = g.uniform(0, 6.283185307179586),
                             x = r * std::cos(about), y = r * std::sin(about), z = -rough(x, y, 0.0);
                const double tilt = g.uniform(0.002, 0.7), to = g.uniform(0, 6.283185307179586),
                             size = g.chance(0.5) ? 1 : g.log_uniform(1e-3, 1e3);
                const sgt_vec3 d = {std::sin(tilt) * std::cos(to), std::sin(tilt) * std::sin(to),
                                    (g.chance(0.3) ? -1 : 1) * std::cos(tilt)};
                const double beside = s.h * g.log_uniform(1e-6, 3),
                             last = g.chance(0.3) ? beside + s.h * g.log_uniform(1e-3, 1e2) : INFINITY;
                if (z == z && side) { // toward a point of the surface from the side, or past it
                    const double steep = g.log_uniform(1e-6, 1), far = s.h * g.log_uniform(0.5, 1e4),
                                 past = g.chance(0.5) ? 0 : s.h * g.sign() * g.log_uniform(1e-6, 1);
                    const sgt_vec3 way = {std::cos(to), std::sin(to), g.sign() * steep};
                    all.push_back({{x - far * way.x, y - far * way.y, z - far * way.z + past},
                                   {way.x * size, way.y * size, way.z * size},
                                   0,
                                   (g.chance(0.5) ? 2 * far : far + last) / size});
                    continue;
                }
                if (z == z && leave)
                    all.push_back({{x + beside * d.x, y + beside * d.y, z + beside * d.z},
                                   {d.x * size, d.y * size, d.z * size},
                                   0,
                                   last / size});
                if (z == z && !leave)
                    all.push_back({{x - away * d.x, y - away * d.y, z - away * d.z},
                                   {d.x * size, d.y * size, d.z * size},
                                   0,
                                   INFINITY});
            }
            const std::size_t n = all.size();
            if (!n) continue;
            std::vector<double> in[8], t(n), t_err(n), p[3];
            std::vector<sgt_status> status(n);
            std::vector<int> evals(n);
            for (std::vector<double> &a : in) a.resize(n);
            for (std::vector<double> &a : p) a.resize(n);
            for (std::size_t i = 0; i < n; i++) {
                const double of[] = {all[i].o.x, all[i].o.y, all[i].o.z,  all[i].d.x,
                                     all[i].d.y, all[i].d.z, all[i].tmin, end_of(&all[i])};
                for (int k = 0; k < 8; k++) in[k][i] = of[k];
            }
            const sgt_rays many = {{in[0].data(), in[1].data(), in[2].data()},
                                   {in[3].data(), in[4].data(), in[5].data()},
                                   in[6].data(),
                                   in[7].data()};
            sgt_hits hits = {};
            hits.status = status.data(), hits.evals = evals.data(), hits.t = t.data(),
            hits.t_err = t_err.data();
            for (int k = 0; k < 3; k++) hits.p[k] = p[k].data();
            sgt_intersect_batch(s.s, n, many, hits, nullptr);
            for (std::size_t i = 0; i < n; i++) {
                const sgt_ray &ray = all[i];
                const sgt_hit h = sgt_intersect(s.s, ray, nullptr);
                const double one[] = {h.t, h.t_err, h.p.x, h.p.y, h.p.z},
                             batch[] = {t[i], t_err[i], p[0][i], p[1][i], p[2][i]};
                bool same = h.status == status[i] && h.evals == evals[i];
                for (int k = 0; k < 5; k++)
                    same = same && (std::memcmp(&one[k], &batch[k], sizeof(double)) == 0 ||
                                    (one[k] != one[k] && batch[k] != batch[k]));
                if (!same) fail("a batch is not the single ray", s, ray, h);
                rays += !leave, decided += !leave && h.status >= 0;
                leaving += leave, told += leave && h.status >= 0, misses += leave && h.status == SGT_MISS;
                if (h.status == SGT_MISS && !leave) fail("a miss", s, ray, h);
                if (h.status == SGT_MISS && leave && changes(exact, ray, s.h))
                    fail("a miss that meets", s, ray, h);
                if (h.status != SGT_HIT) continue;
                wings += std::hypot(h.p.x, h.p.y) > 1.1 * s.h;
                const quad at = quad(h.t) + quad(h.t_lo), off = quad(h.t_err) * (1 + quad(0x1p-20));
                const quad left = along(exact, ray, at - off), right = along(exact, ray, at + off);
                if (left == left && right == right && sign(left) * sign(right) > 0)
                    fail("no root within t_err", s, ray, h);
                if (earlier(exact, ray, at - off)) fail("another root is nearer", s, ray, h);
            }
        }
        std::printf(
            "%-14s %6ld rays come, %6ld decided, %5ld in the wings; %6ld leave, %6ld decided, %6ld misses\n",
            type, rays, decided, wings, leaving, told, misses);
        std::fflush(stdout);
        // a sphere under it ends, where a q_bfs is without bound; the rays of a round are of one surface
        const bool ends = std::string(type) == "q_bfs" || std::string(type) == "sum";
        const double most = (ends ? 0.2 : 0.04) + 4 / static_cast<double>(rounds);
        if (static_cast<double>(rays - decided) > most * static_cast<double>(rays))
            failed[std::string(type) + ": too many are undecided"]++;
    }
    generator g(from);
    for (const char *type : sags)
        if (!only || std::string(only) == type)
            pairs(g, type, rounds * 2), leaving(g, type, rounds);
    if (!only) beside_edge(g, static_cast<int>(200 * (scale ? std::atof(scale) : 0.5)) + 20);
    if (!only) grazing(g, static_cast<int>(120 * (scale ? std::atof(scale) : 0.5)) + 20);
    for (const auto &f : failed) std::printf("FAIL %6d  %s\n", f.second, f.first.c_str());
    return !failed.empty();
}
