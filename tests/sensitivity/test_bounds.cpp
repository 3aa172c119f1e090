// SPDX-License-Identifier: MIT
// What is said of rays that are not there: the bounds of sgt_beam_bounds, and the proofs of sgt_launch_rays.
//
//     test_bounds
//
// BOUNDS.  Random elements (turned, decentred, curved, with rims, apertures and mirrors) and families of
// rays. A point of one element is chosen, half of the time on its rim or on the edge of a conic.  The ray of
// the family through it is the solution of three linear equations, in 113 bits.  If the rims of the other
// elements let it through, up to the first that bends it, its u and v must be within the bounds.
//
// PROOFS.  Random lenses: cones, finite objects, tilted elements, aspheres, ideal lenses, mirrors, apertures.
// Of each ray that is not found, Newton's method in 113 bits seeks one from 200 random starts.  One that is
// found must be clipped in front, and lie outside of `within`.
//
// SAGITTA_TEST_SCALE multiplies the cases; SAGITTA_TEST_SEED replaces the seed.
#include "slow_trace.h"
#include "../oracle/cases.h"

#include <sagitta/aim.h>
#include <sagitta/analysis.h>
#include <sagitta/lens.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>

using namespace slow;

static int failures;
static double scale = 0.5;

static void fail(const char *what, long number, double a, double b)
{
    if (failures++ < 30) std::printf("FAIL %s, case %ld: %.17g, %.17g\n", what, number, a, b);
}

// ----------------------------------------------------------------- what a rim lets through

// The soft edge is 2^-45 of the sizes.
static bool item_passes(const sgt_aperture_item &i, double x, double y)
{
    const double soft = std::ldexp(1.0, -45), a = i.degrees * std::acos(-1.0) / 180;
    const double dx = x - i.centre.x, dy = y - i.centre.y, qx = dx * std::cos(a) + dy * std::sin(a),
                 qy = dy * std::cos(a) - dx * std::sin(a);
    const double away =
        soft * (std::fabs(i.centre.x) + std::fabs(i.centre.y) + std::fabs(dx) + std::fabs(dy));
    if (i.obscuring) return true; // at most: more rays are tried than pass
    switch (i.shape) {
    case SGT_CIRCLE:
    case SGT_ANNULUS:
        return std::hypot(dx, dy) <= i.radius * (1 + soft) + away;
    case SGT_RECTANGLE:
        return std::fabs(qx) <= i.half.x + away && std::fabs(qy) <= i.half.y + away;
    case SGT_ELLIPSE:
        return std::hypot(qx / (i.half.x + away), qy / (i.half.y + away)) <= 1;
    case SGT_POLYGON: {
        bool inside = false;
        for (std::size_t k = 0, last = i.count - 1; k < i.count; last = k++) {
            const sgt_vec2 p = i.vertices[last], q = i.vertices[k];
            if ((p.y > qy) != (q.y > qy) && qx < p.x + (qy - p.y) * (q.x - p.x) / (q.y - p.y))
                inside = !inside;
        }
        return inside;
    }
    default:
        return true;
    }
}

static bool passes(const sgt_element &e, double rim, const vec &p)
{
    const double x = to_double(p.x), y = to_double(p.y), soft = 1 + std::ldexp(1.0, -45),
                 r = std::hypot(x, y);
    if (e.semi_diameter > 0 && r > e.semi_diameter * soft) return false;
    if (rim > 0 && r > rim * soft) return false;
    for (std::size_t k = 0; e.aperture && k < e.aperture->count; k++)
        if (!item_passes(e.aperture->items[k], x, y)) return false;
    return true;
}

static quad sag(const element &e, double x, double y) { return -level_at(e, {x, y, 0}).a; }

// s with a s[0] + b s[1] + c s[2] = q; false: there is not one.
static bool solve(const vec &a, const vec &b, const vec &c, const vec &q, quad s[3])
{
    const quad by = inner(a, outer(b, c));
    if (by == 0) return false;
    s[0] = inner(q, outer(b, c)) / by, s[1] = inner(a, outer(q, c)) / by, s[2] = inner(a, outer(b, q)) / by;
    return true;
}

// -------------------------------------------------------------------------- bounds

struct row {
    std::vector<sgt_conic> conics;
    std::vector<sgt_even_asphere> aspheres;
    std::vector<sgt_zernike> zernikes;
    std::vector<sgt_aperture_item> items;
    std::vector<sgt_aperture> apertures;
    std::vector<sgt_element> e;
    std::vector<element> slow;
    std::vector<double> rim, edge;
    std::size_t last; // the first that bends, or the last
};

static const double terms[9] = {0, 0.02, -0.03, 0.05, 0.1, -0.04, 0.03, 0, 0.02};
static const sgt_vec2 corners[5] = {{-3, -2}, {4, -3}, {1, 1}, {2, 5}, {-4, 2}};

static void fill(row &r, oracle::generator &random)
{
    const std::size_t count = std::size_t(1 + random.below(4));
    r.conics.resize(count), r.aspheres.resize(count), r.zernikes.resize(count), r.items.resize(2 * count),
        r.apertures.resize(count);
    r.last = std::size_t(random.below(int(count)));
    double z = 0;
    for (std::size_t k = 0; k < count; k++) {
        static const double constants[] = {0, 0, -1, -0.5, 0.7, -3, 10, -1.2};
        const double c = random.chance(0.2) ? 0 : random.sign() * random.log_uniform(0.005, 0.2),
                     conic = constants[random.below(8)], rim = random.chance(0.4) ? random.uniform(3, 12) : 0;
        r.conics[k] = {c, conic, rim};
        r.aspheres[k] = {c, conic, rim, {random.uniform(-1, 1) * 1e-2, random.uniform(-1, 1) * 1e-4}};
        r.zernikes[k] = {c, conic, rim, 12, SGT_FRINGE, 0, {terms, 1, 9}};
        const sgt_surface types[] = {{&sgt_conic_ops, &r.conics[k]},
                                     {&sgt_conic_ops, &r.conics[k]},
                                     {&sgt_even_asphere_ops, &r.aspheres[k]},
                                     {&sgt_zernike_ops, &r.zernikes[k]}};
        sgt_element e = {};
        e.surface = types[random.below(4)];
        e.semi_diameter = random.chance(0.5) ? random.uniform(1, 12) : 0;
        e.index = k < r.last ? (random.chance(0.5) ? 0 : 1) : random.chance(0.3) ? SGT_MIRROR : 1.5;
        const sgt_vec3 origin = {random.uniform(-3, 3), random.uniform(-3, 3), z};
        e.pose.origin = origin;
        if (random.chance(0.5))
            e.pose = sgt_pose_tilted(
                origin, {random.uniform(-40, 40), random.uniform(-40, 40), random.uniform(-90, 90)});
        const int items = random.below(3);
        for (int j = 0; j < items; j++) {
            sgt_aperture_item &i = r.items[2 * k + std::size_t(j)];
            static const sgt_aperture_shape shapes[] = {SGT_CIRCLE,  SGT_ANNULUS, SGT_RECTANGLE,
                                                        SGT_ELLIPSE, SGT_POLYGON, SGT_SPIDER};
            i = {};
            i.shape = shapes[random.below(6)], i.obscuring = random.chance(0.3);
            i.centre = {random.uniform(-4, 4), random.uniform(-4, 4)}, i.degrees = random.uniform(-180, 180);
            i.radius = random.uniform(2, 8), i.inner = random.uniform(0, 1);
            i.half = {random.chance(0.1) ? double(INFINITY) : random.uniform(1, 8), random.uniform(1, 8)};
            i.vertices = corners, i.count = 5, i.arms = 3, i.width = 1;
        }
        r.apertures[k] = {};
        r.apertures[k].count = std::size_t(items), r.apertures[k].items = &r.items[2 * k];
        if (items) e.aperture = &r.apertures[k];
        r.e.push_back(e), r.slow.push_back(element_of(e)), r.rim.push_back(rim);
        r.edge.push_back(1 + conic > 0 && c != 0 ? 1 / (std::fabs(c) * std::sqrt(1 + conic)) : 100);
        z += random.uniform(-5, 15);
    }
}

static sgt_vec3 any(oracle::generator &random, double size)
{
    return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

// From a point (before or behind the elements) or of one direction (forward or backward).
// *flat: one of its parameters does nothing, or makes a direction longer.
static sgt_beam family(oracle::generator &random, bool *flat)
{
    sgt_beam b = {};
    const double way = random.sign() * random.log_uniform(1, 500);
    const int kind = random.below(8);
    *flat = kind > 3;
    b.u = b.v = {-1, 1};
    b.o = {random.uniform(-5, 5), random.uniform(-5, 5), -way};
    b.d = {random.uniform(-.5, .5), random.uniform(-.5, .5), random.sign() * 1.0};
    if (kind == 0)
        b.ou = {3, 0, 0}, b.ov = {0, 3, 0};
    else if (kind == 1)
        b.ou = any(random, 2), b.ov = any(random, 2);
    else if (kind == 2)
        b.du = {.2, 0, 0}, b.dv = {0, .2, 0};
    else if (kind == 3)
        b.du = any(random, 1), b.dv = any(random, 1);
    else if (kind == 4)
        b.d = {0, 0, 1}, b.du = {1, 0, 0}, b.dv = {0, 0, .5};
    else if (kind == 5)
        b.du = {0, .2, 0};
    else if (kind == 6)
        b.ov = {3, 0, 0};
    else
        b.d = {0, 0, 1}, b.ou = {3, 0, 0}, b.ov = {0, 0, 1};
    return b;
}

static void bounds(oracle::generator &random)
{
    const long cases = long(30000 * scale) + 100;
    long within = 0, bounded = 0;
    for (long n = 0; n < cases; n++) {
        row r;
        fill(r, random);
        bool flat;
        sgt_beam b = family(random, &flat);
        const std::size_t at = std::size_t(random.below(int(r.last) + 1)), count = r.e.size(),
                          stop = random.chance(0.5) ? r.last
                                                    : r.last + std::size_t(random.below(int(count - r.last)));
        double most = std::min(r.edge[at], 20.0);
        if (r.rim[at] > 0) most = std::min(most, r.rim[at]);
        if (r.e[at].semi_diameter > 0) most = std::min(most, r.e[at].semi_diameter);
        const double part = random.chance(0.5) ? 1 : std::sqrt(random.uniform(0, 1)),
                     turn = random.uniform(0, 7),
                     soft = most < r.edge[at] ? std::ldexp(part, -46) : -std::ldexp(1.0, -50),
                     radius = most * part * (1 + soft);
        const double x = radius * std::cos(turn), y = radius * std::sin(turn);
        const element &e = r.slow[at];
        const vec p = e.origin + e.global({x, y, sag(e, x, y)}), q = p - of(b.o);
        quad s[3], u, v;
        if (flat) { // no ray of it need go through the point
            u = random.uniform(-3, 3), v = random.uniform(-1, 3);
        } else if (b.ou.x == 0 && b.ou.y == 0 && b.ou.z == 0) {
            if (!solve(q, quad(-1) * of(b.du), quad(-1) * of(b.dv), of(b.d), s)) continue;
            u = s[1], v = s[2];
        } else {
            if (!solve(of(b.ou), of(b.ov), of(b.d), q, s)) continue;
            u = s[0], v = s[1];
        }
        const vec o = of(b.o) + (u * of(b.ou) + v * of(b.ov)), d = of(b.d) + (u * of(b.du) + v * of(b.dv));
        bool through = length(d) > 0;
        sgt_vec2 wanted = {random.uniform(-5, 5), random.uniform(-5, 5)};
        for (std::size_t i = 0; i <= r.last && through; i++) {
            const element &m = r.slow[i];
            const vec lo = m.local(o - m.origin), ld = m.local(d);
            quad t = 0;
            vec hit = m.local(p - m.origin);
            if (i != at || flat) {
                through =
                    m.surface.ops == &sgt_conic_ops ? meet_conic(m.a, lo, ld, &t) : meet_other(m, lo, ld, &t);
                hit = lo + t * ld;
                through = through && (r.edge[i] == 100 ||
                                      to_double(hit.x * hit.x + hit.y * hit.y) <= r.edge[i] * r.edge[i]);
            }
            through = through && to_double(magnitude(hit.x) + magnitude(hit.y)) < 1e6;
            if (i == stop)
                wanted = {to_double(hit.x), to_double(hit.y)}; // no rim of its own
            else
                through = through && passes(r.e[i], r.rim[i], hit);
            if (i == stop && r.rim[i] > 0) through = through && std::hypot(wanted.x, wanted.y) <= r.rim[i];
        }
        if (!through) continue;
        within++;
        sgt_interval bu, bv;
        if (!sgt_beam_bounds(stop, r.e.data(), 1, &b, wanted, &bu, &bv)) continue;
        bounded++;
        if (!(u >= bu.lo && u <= bu.hi))
            fail("u is not within its bounds", n, to_double(u), bu.lo > to_double(u) ? bu.lo : bu.hi);
        if (!(v >= bv.lo && v <= bv.hi))
            fail("v is not within its bounds", n, to_double(v), bv.lo > to_double(v) ? bv.lo : bv.hi);
    }
    std::printf("%ld cases: %ld rays that get through, %ld of them bounded\n", cases, within, bounded);
    if (bounded * 8 < cases) fail("too few", cases, double(bounded), 0);
}

// Of one surface whose sag rises outward, in a family of one direction, the bounds are those of the box about
// its points: x and y within the least of its rims, z from the vertex to there.
static void tight(oracle::generator &random)
{
    const long cases = long(2000 * scale) + 50;
    for (long n = 0; n < cases; n++) {
        static const double constants[] = {0, 0, -1, -0.5, 0.7, 0.3};
        const double c = random.uniform(0.02, 0.3), k = constants[random.below(6)],
                     edge = k > -1 ? 1 / (c * std::sqrt(1 + k)) : 100;
        const double rim = random.chance(0.5) ? random.uniform(1, 12) : 0,
                     aperture = rim == 0 || random.chance(0.5) ? random.uniform(1, 12) : 0;
        sgt_conic conic = {c, k, rim};
        sgt_even_asphere asphere = {c, k, rim, {random.uniform(0, 1e-2), random.uniform(0, 1e-4), 0, 1e-9}};
        const bool even = random.chance(0.5);
        sgt_element e = {};
        e.surface = {even ? &sgt_even_asphere_ops : &sgt_conic_ops, even ? (const void *)&asphere : &conic};
        e.index = 1.5, e.semi_diameter = aperture, e.pose.origin = {0, 0, random.uniform(-5, 5)};
        double R = edge, r2, z;
        if (rim > 0) R = std::min(R, rim);
        if (aperture > 0) R = std::min(R, aperture);
        r2 = R * R, z = c * r2 / (1 + std::sqrt(std::max(0.0, 1 - (1 + k) * c * c * r2)));
        for (int i = 0; even && i < 8; i++) z += asphere.a[i] * std::pow(r2, i + 1);
        sgt_beam b = {};
        b.o = {random.uniform(-5, 5), random.uniform(-5, 5), -20}, b.ou = {1, 0, 0}, b.ov = {0, 1, 0};
        b.d = {random.uniform(-1, 1), random.uniform(-1, 1), 1};
        const sgt_element two[2] = {e, e};
        sgt_interval got[2];
        if (!sgt_beam_bounds(1, two, 1, &b, {0, 0}, &got[0], &got[1])) {
            fail("no bounds", n, R, z);
            continue;
        }
        for (int i = 0; i < 2; i++) {
            const double rise = i ? b.d.y : b.d.x, o = i ? b.o.y : b.o.x, from = e.pose.origin.z - b.o.z,
                         shifted = -o - rise * from, more = -rise * z, room = 1e-6 * (R + z);
            const sgt_interval want = {shifted - R + std::min(more, 0.0), shifted + R + std::max(more, 0.0)};
            if (!(got[i].lo <= want.lo + room && got[i].hi >= want.hi - room))
                fail("bounds that are too narrow", n, got[i].lo, want.lo);
            if (!(got[i].lo >= want.lo - room && got[i].hi <= want.hi + room))
                fail("bounds that are too wide", n, got[i].hi - got[i].lo, want.hi - want.lo);
        }
    }
}

// -------------------------------------------------------------------------- proofs

static std::string random_lens(oracle::generator &random)
{
    char line[400];
    std::string s = "units: mm\naim: stop\n";
    const auto put = [&](const char *form, double a = 0, double b = 0, double c = 0) {
        std::snprintf(line, sizeof line, form, a, b, c), s += line;
    };
    const int object = random.below(4);
    const double rim = random.uniform(2, 8);
    if (object == 1) put("object: {distance: %.17g}\n", random.log_uniform(10, 200));
    if (object == 2) put("object: {distance: %.17g, telecentric: true}\n", random.uniform(10, 60));
    put(object == 2 ? "pupil: {object_na: %.17g}\n" : "pupil: {stop_size: true, distance: 0}\n",
        random.uniform(.05, .3));
    if (object == 1 || object == 2)
        put("field_type: object_height\nfields: [0, %.17g]\n", random.uniform(1, 15));
    else
        put("fields: [0, %.17g]\n", random.uniform(1, 40));
    s += "surfaces:\n";
    const int kind = random.below(4);
    double way = 1;
    if (random.chance(0.4)) { // a rim in front that bends nothing
        put("  - {type: plane, thickness: %.17g, index: 1", random.uniform(1, 20));
        if (random.chance(0.5))
            put(", apertures: [{type: rectangle, half_width: %.17g, half_height: %.17g, offset: [%.17g, 0]}]",
                rim, rim / 2, rim / 3);
        else
            put(", semi_diameter: %.17g", rim);
        s += "}\n";
    }
    const double radius = random.sign() * random.uniform(8, 30);
    if (kind == 0)
        put("  - {type: sphere, radius: %.17g, thickness: %.17g, index: 1.9", radius, random.uniform(3, 16));
    if (kind == 1)
        put("  - {type: even_asphere, radius: %.17g, thickness: %.17g, coefficients: [0, %.17g], index: 1.6",
            radius, random.uniform(3, 16), random.uniform(-1e-4, 1e-4));
    if (kind == 2)
        put("  - {type: ideal, focal_length: %.17g, thickness: %.17g, index: 1", random.uniform(10, 80),
            random.uniform(3, 60));
    if (kind == 3)
        put("  - {type: conic, radius: %.17g, conic: %.17g, thickness: %.17g, mirror: true", radius,
            random.uniform(-2, 1), random.uniform(-12, -3)),
            way = -1;
    put(", semi_diameter: %.17g", rim);
    if (random.chance(0.3))
        put(", decenter: [%.17g, %.17g, 0], tilt: [%.17g, 0, 0]", random.uniform(-2, 2),
            random.uniform(-2, 2), random.uniform(-20, 20));
    s += "}\n";
    put("  - {type: plane, stop: true, draw_to: %.17g, thickness: %.17g, index: 1", random.uniform(1, 25),
        way);
    if (random.chance(0.3)) put(", decenter: [0, %.17g, 0]", random.uniform(-60, 60));
    s += "}\n  - {type: plane, index: 1}\n";
    return s;
}

// The first element, from 0, that bends.
static std::size_t first_bend(const sgt_lens *l)
{
    std::size_t i = 0;
    while (i + 1 < l->count && !l->element[i].phase &&
           (l->element[i].index == 0 || l->element[i].index == l->index_before))
        i++;
    return i;
}

static bool sought(const sgt_lens *l, const std::vector<element> &slow, const sgt_field_beam &beam,
                   sgt_vec2 wanted, double reach, oracle::generator &random, sgt_vec2 *at)
{
    double x = random.uniform(-reach, reach), y = random.uniform(-reach, reach);
    const auto miss = [&](double a, double b, quad f[2]) {
        const sgt_ray ray = sgt_field_ray(&beam, a, b);
        const end r = trace(slow, l->stop + 1, l->index_before, of(ray.o), of(ray.d), true);
        f[0] = r.p.x - wanted.x, f[1] = r.p.y - wanted.y;
        return r.why == 0;
    };
    double best = HUGE_VAL;
    for (int i = 0; i < 40; i++) {
        quad f[2], g[2], h[2];
        const double step = 1e-6 * (1 + std::fabs(x) + std::fabs(y));
        if (!miss(x, y, f) || !miss(x + step, y, g) || !miss(x, y + step, h)) return false;
        best = std::hypot(to_double(f[0]), to_double(f[1]));
        if (best < 1e-9) {
            *at = {x, y};
            return true;
        }
        const double a = to_double(g[0] - f[0]) / step, b = to_double(h[0] - f[0]) / step,
                     c = to_double(g[1] - f[1]) / step, d = to_double(h[1] - f[1]) / step,
                     det = a * d - b * c;
        double sx = -(d * to_double(f[0]) - b * to_double(f[1])) / det,
               sy = -(a * to_double(f[1]) - c * to_double(f[0])) / det;
        if (!(std::fabs(sx) + std::fabs(sy) < 1e6)) return false;
        for (int k = 0; k < 12; k++, sx /= 2, sy /= 2)
            if (miss(x + sx, y + sy, g) && std::hypot(to_double(g[0]), to_double(g[1])) < best) break;
        x += sx, y += sy;
    }
    return false;
}

static void proofs(oracle::generator &random)
{
    const long cases = long(80 * scale) + 5;
    long met = 0, none = 0, undecided = 0, excluded = 0, found = 0, clipped = 0, known = 0, known_found = 0;
    for (long n = 0; n < cases; n++) {
        const std::string text = random_lens(random);
        sgt_error error;
        sgt_lens *l = sgt_lens_read_text("random.yaml", text.c_str(), text.size(), nullptr, &error);
        if (!l) {
            std::printf("%s", text.c_str()), fail(error.words, n, 0, 0);
            return;
        }
        sgt_launcher *from = sgt_launcher_new(l, nullptr, &error);
        if (!from) { // no pupil
            sgt_lens_free(l);
            continue;
        }
        std::vector<element> slow;
        for (std::size_t i = 0; i < l->count; i++) slow.push_back(element_of(l->element[i]));
        slow[l->stop].phase = nullptr;
        const std::size_t bend = first_bend(l);
        for (std::size_t field = 0; field < l->fields; field++) {
            sgt_field_beam beam;
            if (!sgt_launch_field(from, l->field_kind, &l->field[field], &beam, &error)) continue;
            const sgt_pupil_point at[3] = {{0, 0, 1}, {.6, .3, 1}, {0, -1, 1}};
            sgt_launched out[3];
            sgt_launch_rays(from, &beam, l->element, l->index_before, 3, at, out, nullptr);
            for (int k = 0; k < 3; k++) {
                met += out[k].status == SGT_MET, none += out[k].status == SGT_NO_SUCH_RAY,
                    undecided += out[k].status == SGT_AIMED_UNDECIDED;
                if (out[k].status == SGT_MET) { // is the attack worth something?
                    bool again = false;
                    sgt_vec2 there;
                    if (k != 1 || field != 0) continue;
                    for (int start = 0; start < 200 && !again; start++)
                        again =
                            sought(l, slow, beam, out[k].wanted, random.log_uniform(1, 30), random, &there);
                    known++, known_found += again;
                    continue;
                }
                excluded += out[k].within > 0;
                for (int start = 0; start < 200; start++) {
                    sgt_vec2 there;
                    if (!sought(l, slow, beam, out[k].wanted, random.log_uniform(1, 300), random, &there))
                        continue;
                    // is that the way that sgt_trace means, without apertures, and is it clipped in front?
                    std::vector<sgt_element> open(l->element, l->element + l->stop + 1);
                    for (sgt_element &e : open) e.semi_diameter = 0, e.aperture = nullptr;
                    std::vector<sgt_passage> passages(l->stop + 1);
                    sgt_ray ray = sgt_field_ray(&beam, there.x, there.y);
                    const std::size_t passed = sgt_trace(l->stop + 1, open.data(), l->index_before, &ray,
                                                         passages.data(), nullptr, nullptr);
                    if (passed < l->stop || passages[l->stop].hit.status <= 0) continue;
                    const sgt_vec3 p = passages[l->stop].hit.p;
                    if (!(std::hypot(p.x - out[k].wanted.x, p.y - out[k].wanted.y) < 1e-6)) continue;
                    found++;
                    bool outside = false;
                    for (std::size_t i = 0; i <= bend && i < l->stop; i++) {
                        const sgt_vec3 h = passages[i].hit.p;
                        outside = outside || !passes(l->element[i], 0, of(h));
                    }
                    clipped += outside;
                    if (std::max(std::fabs(there.x), std::fabs(there.y)) < out[k].within * (1 - 1e-6)) {
                        fail("a ray within what is excluded", n, there.x, there.y);
                        std::printf("%s", text.c_str());
                    }
                    if (!outside && out[k].status == SGT_NO_SUCH_RAY) {
                        fail("there is such a ray", n, there.x, there.y);
                        std::printf("%s", text.c_str());
                    }
                    break;
                }
            }
        }
        sgt_launcher_free(from);
        sgt_lens_free(l);
    }
    std::printf("%ld lenses: %ld rays met, %ld none, %ld undecided (%ld not met with a box excluded); the "
                "attack found %ld, %ld "
                "of them clipped in front, and %ld of %ld that are known\n",
                cases, met, none, undecided, excluded, found, clipped, known_found, known);
    if (known_found * 10 < known * 7) fail("the attack is weak", cases, double(known_found), double(known));
    if (none * 20 < cases) fail("too few proofs", cases, double(none), 0);
}

int main()
{
    const char *text = std::getenv("SAGITTA_TEST_SCALE"), *seed = std::getenv("SAGITTA_TEST_SEED");
    if (text) scale = std::atof(text);
    const unsigned long long first = seed ? std::strtoull(seed, nullptr, 10) : 20266;
    std::printf("seed %llu\n", first);
    oracle::generator random(first);
    bounds(random);
    tight(random);
    proofs(random);
    return failures != 0;
}
