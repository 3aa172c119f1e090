// SPDX-License-Identifier: MIT
// Rays through a wanted point (sgt_aim), on the lenses of examples/lenses: fields, object points and points
// of the stop are random.
//
//     test_aim FOLDER-OF-LENSES
//
// Every ray that is met is traced again in 113 bits (slow_trace.h) and has to meet the point within `miss`.
// Every answer "no such ray" is attacked: launch rays all over the box in 113 bits, and a descent from the
// nearest of them.  The proof alone, without a search, is asked of points that are met: of the same lenses,
// and of random rows of surfaces.  A point inside the aperture of the stop has to be met.
//
// What is told of a search is tried as well: `miss` with a tolerance, and each attempt.  So are the proofs
// that must not get lost: of each sag and each reason why there is no ray.
//
// SAGITTA_TEST_SCALE multiplies the points and the attacking rays; SAGITTA_TEST_SEED replaces the seed.
#include "slow_trace.h"
#include "../oracle/cases.h"

#include <sagitta/aim.h>
#include <sagitta/lens.h>

#include <cstdlib>
#include <string>

using namespace slow;

static int failures;
static double scale = 0.5;

static void fail(const char *lens, const char *what, double a, double b)
{
    if (failures++ < 30) std::printf("FAIL %s: %s: %.17g, %.17g\n", lens, what, a, b);
}

// ------------------------------------------------------------------ a question

struct question {
    const char *name;
    std::vector<sgt_element> e;
    std::vector<element> slow;
    double before;
    std::size_t stop;
    sgt_beam beam;
    sgt_vec2 wanted;
};

// The miss of a launch ray in quads; negative: it does not get there.
static quad slow_miss(const question &q, const vec &o, const vec &d, quad f[2])
{
    const end r = trace(q.slow, q.stop + 1, q.before, o, d, true);
    if (r.why) return -1;
    f[0] = r.p.x - q.wanted.x, f[1] = r.p.y - q.wanted.y;
    return square_root(f[0] * f[0] + f[1] * f[1]);
}

static quad slow_at(const question &q, quad u, quad v, quad f[2])
{
    const sgt_beam &b = q.beam;
    return slow_miss(q, of(b.o) + (u * of(b.ou) + v * of(b.ov)), of(b.d) + (u * of(b.du) + v * of(b.dv)), f);
}

static quad clamp(quad x, const sgt_interval &box)
{
    return x < box.lo ? quad(box.lo) : x > box.hi ? quad(box.hi) : x;
}

// The least miss that a search finds: random rays, then Newton's steps by differences from the best.
static double attack(const question &q, oracle::generator &random, int rays)
{
    quad best = -1, u = 0, v = 0, f[2];
    const sgt_interval bu = q.beam.u, bv = q.beam.v;
    for (int i = 0; i < rays; i++) {
        const double a = random.uniform(bu.lo, bu.hi), b = random.uniform(bv.lo, bv.hi);
        const quad miss = slow_at(q, a, b, f);
        if (miss >= 0 && (best < 0 || miss < best)) best = miss, u = a, v = b;
    }
    for (int i = 0; i < 12 && best > 0; i++) {
        quad g[2], h[2];
        const quad hu = quad(1e-9) * (bu.hi - bu.lo), hv = quad(1e-9) * (bv.hi - bv.lo);
        if (slow_at(q, u, v, f) < 0 || slow_at(q, u + hu, v, g) < 0 || slow_at(q, u, v + hv, h) < 0) break;
        const quad a = (g[0] - f[0]) / hu, b = (h[0] - f[0]) / hv, c = (g[1] - f[1]) / hu,
                   d = (h[1] - f[1]) / hv, det = a * d - b * c;
        const quad su = -(d * f[0] - b * f[1]) / det, sv = -(a * f[1] - c * f[0]) / det;
        bool better = false;
        for (quad part = 1; part > 1e-3 && !better; part /= 2) {
            const quad x = clamp(u + part * su, bu), y = clamp(v + part * sv, bv), miss = slow_at(q, x, y, g);
            if (miss >= 0 && miss < best) best = miss, u = x, v = y, better = true;
        }
        if (!better) break;
    }
    return to_double(best);
}

// ---------------------------------------------------------------------- answers

struct tally {
    long met, none, undecided, clipped, traces, boxes;
    double worst, largest;
};

static const sgt_aim_options *options = nullptr;

static sgt_aiming ask(const question &q, oracle::generator &random, tally *count, bool inside)
{
    std::vector<sgt_passage> passages(q.stop + 1);
    sgt_aiming a;
    const sgt_aimed status =
        sgt_aim(q.stop, q.e.data(), q.before, &q.beam, q.wanted, passages.data(), options, &a);
    if (status != a.status) fail(q.name, "status", status, a.status);
    count->traces += a.traces, count->boxes += a.boxes;
    if (status == SGT_MET) {
        quad f[2];
        const quad miss = slow_miss(q, of(a.ray.o), of(a.ray.d), f);
        const double off = to_double(miss);
        if (!(miss >= 0) || !(off <= a.miss)) fail(q.name, "the miss is not within its bound", off, a.miss);
        if (!(a.miss <= 1e-9 + (options ? options->tol : 0))) fail(q.name, "a large miss", a.miss, off);
        if (a.u < q.beam.u.lo || a.u > q.beam.u.hi || a.v < q.beam.v.lo || a.v > q.beam.v.hi)
            fail(q.name, "outside of the box", a.u, a.v);
        count->worst = std::max(count->worst, off / a.miss),
        count->largest = std::max(count->largest, a.miss);
        count->met++, count->clipped += a.clipped <= q.stop;
        // what is traced is what was said
        sgt_ray ray = a.ray;
        std::vector<sgt_passage> again(q.stop + 1);
        const std::size_t passed =
            sgt_trace(q.stop + 1, q.e.data(), q.before, &ray, again.data(), nullptr, nullptr);
        if (a.clipped > q.stop) {
            const sgt_vec3 p = again[q.stop].hit.p;
            if (passed < q.stop || p.x != a.point.x || p.y != a.point.y)
                fail(q.name, "traced again", p.x, a.point.x);
        } else if (passed != a.clipped) {
            fail(q.name, "clipped", double(passed), double(a.clipped));
        }
        return a;
    }
    if (status == SGT_NO_SUCH_RAY) {
        count->none++;
        const double miss = attack(q, random, std::max(20, int(100 * scale)));
        if (miss >= 0 && miss < 1e-9) fail(q.name, "there is such a ray", miss, 0);
        if (inside) fail(q.name, "no such ray inside the pupil", q.wanted.x, q.wanted.y);
    } else {
        count->undecided++;
        if (inside) fail(q.name, "undecided inside the pupil", q.wanted.x, q.wanted.y);
    }
    return a;
}

// ------------------------------------------------------------------------ lenses

static question of_lens(const sgt_lens *lens, const char *name)
{
    question q = {name, {}, {}, lens->index_before, lens->stop_marked ? lens->stop : 0, {}, {0, 0}};
    for (std::size_t i = 0; i < lens->count; i++) {
        q.e.push_back(lens->element[i]);
        q.slow.push_back(element_of(lens->element[i]));
    }
    return q;
}

// A beam from afar, or from an object point; u and v are x and y in the plane of the first vertex, up to
// `reach`.
static sgt_beam beam_of(oracle::generator &random, double angle, double reach, double size)
{
    sgt_beam b = {};
    const double a = random.uniform(-1, 1) * angle, c = random.uniform(-1, 1) * angle;
    b.u = b.v = {-reach, reach};
    if (random.chance(0.5)) {
        b.o = {-size * a, -size * c, -size}, b.ou = {1, 0, 0}, b.ov = {0, 1, 0}, b.d = {a, c, 1};
    } else {
        const double far = size * random.log_uniform(10, 1000);
        b.o = {-far * a, -far * c, -far}, b.d = {far * a, far * c, far}, b.du = {1, 0, 0}, b.dv = {0, 1, 0};
    }
    return b;
}

// What the proof says alone: no search has been made.
static sgt_aimed proof_alone(const question &q)
{
    sgt_aim_options alone = {};
    const sgt_vec2 start = {1e9, 1e9};
    alone.max_traces = 1, alone.start = &start, alone.starts = 1, alone.max_boxes = 100;
    std::vector<sgt_passage> passages(q.stop + 1);
    sgt_aiming a;
    return sgt_aim(q.stop, q.e.data(), q.before, &q.beam, q.wanted, passages.data(), &alone, &a);
}

// Points that a ray of the box does meet, for the proof alone.  It must not be
// proven that there is none, in boxes of any size, in which the ray is anywhere.
static long known_rays(const question &q, oracle::generator &random, double angle, double first, double rays)
{
    long asked = 0;
    for (int i = 0; i < rays; i++) {
        question other = q;
        other.stop = std::size_t(random.below(int(q.e.size())));
        other.beam = beam_of(random, angle * random.log_uniform(0.5, 5), first, 2 * first);
        const double u = random.uniform(-2, 2) * first, v = random.uniform(-2, 2) * first;
        std::vector<sgt_passage> passages(q.e.size());
        for (sgt_element &e : other.e) e.aperture = nullptr, e.semi_diameter *= random.chance(0.5) ? 1 : 2;
        sgt_ray ray = sgt_beam_ray(&other.beam, u, v);
        const std::size_t passed =
            sgt_trace(other.stop + 1, other.e.data(), q.before, &ray, passages.data(), nullptr, nullptr);
        if (passed < other.stop || passages[other.stop].hit.status <= 0) continue;
        other.wanted = {passages[other.stop].hit.p.x, passages[other.stop].hit.p.y};
        for (sgt_interval *x : {&other.beam.u, &other.beam.v}) {
            const double at = x == &other.beam.u ? u : v, wide = random.log_uniform(1e-6, 2) * first;
            x->lo = at - random.uniform(0.01, 1) * wide, x->hi = at + random.uniform(0.01, 1) * wide;
        }
        asked++;
        if (proof_alone(other) == SGT_NO_SUCH_RAY) fail(q.name, "a known ray is said not to be", u, v);
    }
    return asked;
}

// The digits of i in the base behind the point, backward (Halton 1960).
static double digits_of(int i, int base)
{
    return i == 0 ? 0 : (i % base + digits_of(i / base, base)) / base;
}

static double start_in(const sgt_interval &box, double part) { return box.lo + part * (box.hi - box.lo); }

// The attempts of a search without a proof.  They begin at the user's starts, moved into the box, in the
// middle of it, and then all over it.  Each is as if there had been none before; together they spend the
// traces.
static void try_attempts(const question &q, oracle::generator &random)
{
    enum { ROOM = 70 };
    sgt_attempt all[ROOM], one;
    sgt_vec2 starts[2];
    sgt_aim_options opt = {};
    opt.starts = std::size_t(random.below(3)), opt.start = starts, opt.room = ROOM, opt.attempt = all;
    opt.max_boxes = -1;
    const sgt_interval u = q.beam.u, v = q.beam.v;
    for (sgt_vec2 &s : starts)
        s = {start_in(u, random.uniform(-0.5, 1.5)), start_in(v, random.uniform(-0.5, 1.5))};
    std::vector<sgt_passage> passages(q.stop + 1);
    sgt_aiming a, b;
    sgt_aim(q.stop, q.e.data(), q.before, &q.beam, q.wanted, passages.data(), &opt, &a);
    int spent = 0;
    for (std::size_t i = 0; i < a.attempts && i < ROOM; i++) {
        const int k = int(i) - int(opt.starts);
        sgt_vec2 from = {start_in(u, k == 0 ? 0.5 : digits_of(k, 2)),
                         start_in(v, k == 0 ? 0.5 : digits_of(k, 3))};
        if (k < 0)
            from = {std::min(std::max(starts[i].x, u.lo), u.hi), std::min(std::max(starts[i].y, v.lo), v.hi)};
        if (!(std::fabs(all[i].from.x - from.x) <= 1e-12 * (u.hi - u.lo)) ||
            !(std::fabs(all[i].from.y - from.y) <= 1e-12 * (v.hi - v.lo)))
            fail(q.name, "an attempt begins elsewhere", all[i].from.x, from.x);
        spent += all[i].traces;
        if (all[i].reason == SGT_AIM_SPENT) continue; // of a budget that those before have shared
        sgt_aim_options alone = {};
        alone.starts = 1, alone.start = &all[i].from, alone.room = 1, alone.attempt = &one;
        alone.max_boxes = -1, alone.max_traces = all[i].traces + 1;
        sgt_aim(q.stop, q.e.data(), q.before, &q.beam, q.wanted, passages.data(), &alone, &b);
        if (one.reason != all[i].reason || one.fate != all[i].fate || one.element != all[i].element ||
            one.traces != all[i].traces || one.to.x != all[i].to.x || one.to.y != all[i].to.y ||
            !(one.miss == all[i].miss || (std::isnan(one.miss) && std::isnan(all[i].miss))))
            fail(q.name, "an attempt depends on those before it", double(i),
                 double(all[i].fate) - double(one.fate));
    }
    if (spent != a.traces) fail(q.name, "the traces of the attempts", spent, a.traces);
}

static void try_lens(const std::string &folder, const char *name, oracle::generator &random)
{
    sgt_error error;
    sgt_lens *lens = sgt_lens_read((folder + "/" + name + ".yaml").c_str(), nullptr, &error);
    if (!lens) return fail(name, error.words, 0, 0);
    question q = of_lens(lens, name);
    double field = 0;
    for (std::size_t i = 0; i < lens->fields; i++)
        field = std::max(field, std::hypot(lens->field[i].x, lens->field[i].y));
    const double angle = std::tan(field * std::acos(-1.0) / 180) / std::sqrt(2.0),
                 first = q.e[0].semi_diameter;
    const int points = std::max(10, int(125 * scale));
    tally in = {}, out = {}, end = {};
    for (int i = 0; i < points; i++) { // inside the pupil
        const double r = q.e[q.stop].semi_diameter * 0.95 * std::sqrt(random.uniform(0, 1)),
                     turn = random.uniform(0, 7);
        q.beam = beam_of(random, angle, 1.2 * first, 2 * first),
        q.wanted = {r * std::cos(turn), r * std::sin(turn)};
        ask(q, random, &in, true);
    }
    for (int i = 0; i < points; i++) { // anywhere, from a part of the beam, at any element
        question other = q;
        other.stop = std::size_t(random.below(int(q.e.size())));
        const double r = other.e[other.stop].semi_diameter * random.log_uniform(0.1, 4),
                     turn = random.uniform(0, 7);
        const double reach =
            i % 4 < 2 ? first : 0.3 * first; // of the second half all are inside the first aperture
        other.beam = beam_of(random, angle, first, 2 * first);
        for (sgt_interval *x : {&other.beam.u, &other.beam.v}) {
            const double middle = random.uniform(-0.7, 0.7) * reach,
                         half = random.log_uniform(0.1, 1.5) * reach;
            *x = {middle - half, middle + half};
        }
        other.wanted = {r * std::cos(turn), r * std::sin(turn)};
        ask(other, random, i % 2 ? &out : &end, false);
    }
    const long known = known_rays(q, random, angle, first, 1000 * scale);
    sgt_aim_options loose = {};
    options = &loose;
    tally near = {};
    for (int i = 0; i < std::max(10, points / 8); i++) {
        q.beam = beam_of(random, angle, 1.2 * first, 2 * first),
        loose.tol = random.log_uniform(1e-12, 1) * first;
        q.wanted = {random.uniform(-1.5, 1.5) * q.e[q.stop].semi_diameter, random.uniform(-0.5, 0.5) * first};
        loose.max_boxes = -1, ask(q, random, &near, false);
        if (i % 2 == 0) continue;
        q.beam =
            beam_of(random, 2 * angle, random.log_uniform(0.5, 8) * first, 2 * first); // many starts miss
        try_attempts(q, random);
    }
    options = nullptr;
    std::printf(
        "%-18s pupil: %ld met (%ld clipped), %ld none, %ld undecided, %.1f traces, worst %.2g of a miss of "
        "%.2g\n%18s anywhere: %ld met, %ld none, %ld undecided (%.1f %%), %.0f traces, %.0f boxes; %ld known "
        "rays\n",
        name, in.met, in.clipped, in.none, in.undecided, double(in.traces) / points, in.worst, in.largest, "",
        out.met + end.met, out.none + end.none, out.undecided + end.undecided,
        100.0 * double(out.undecided + end.undecided) / points, double(out.traces + end.traces) / points,
        double(out.boxes + end.boxes) / points, known);
    sgt_lens_free(lens);
}

// Random rows of conics, even aspheres and two departures, with turns, mirrors, rims and apertures: of points
// that their rays do meet it must not be said that there is no ray.
static void random_systems(oracle::generator &random)
{
    long asked = 0;
    const int systems = std::max(20, int(300 * scale));
    for (int i = 0; i < systems; i++) {
        std::vector<sgt_conic> conics(6);
        std::vector<sgt_even_asphere> aspheres(6);
        std::vector<sgt_odd_asphere> odds(6);
        std::vector<sgt_zernike> zernikes(6);
        const double terms[9] = {0, 0.02, -0.03, 0.05, 0.1, -0.04, 0.03, 0, 0.02};
        question q = {"random", {}, {}, random.chance(0.3) ? 1.5 : 1, 0, {}, {0, 0}};
        double z = 0, way = 1;
        const std::size_t count = std::size_t(1 + random.below(5));
        for (std::size_t k = 0; k < count; k++) {
            static const double constants[] = {0, 0, -1, -0.5, 0.7, -3, 10, -1.2};
            const double c = random.chance(0.1) ? 0 : random.sign() * random.log_uniform(0.005, 0.2),
                         conic = constants[random.below(8)],
                         rim = random.chance(0.4) ? random.uniform(3, 12) : 0;
            conics[k] = {c, conic, rim};
            aspheres[k] = {c, conic, rim, {}};
            for (int j = 0; j < 4; j++)
                if (random.chance(0.5))
                    aspheres[k].a[j] =
                        random.uniform(-1, 1) * std::pow(8.0, -2 * j - 1) * random.log_uniform(0.01, 1);
            sgt_element e = {};
            odds[k] = {c, conic, rim, {0, 1e-4, random.uniform(-1, 1) * 1e-4, random.uniform(-1, 1) * 1e-5}};
            const double norm = 12;
            zernikes[k] = {c, conic, rim, norm, SGT_FRINGE, 0, {terms, 1, 9}};
            const sgt_surface types[] = {
                {&sgt_conic_ops, &conics[k]},          {&sgt_conic_ops, &conics[k]},
                {&sgt_even_asphere_ops, &aspheres[k]}, {&sgt_even_asphere_ops, &aspheres[k]},
                {&sgt_odd_asphere_ops, &odds[k]},      {&sgt_zernike_ops, &zernikes[k]}};
            e.surface = types[random.below(6)];
            e.index = random.chance(0.25) ? SGT_MIRROR : random.chance(0.1) ? 0 : random.uniform(1, 1.9);
            e.semi_diameter = random.chance(0.6) ? random.uniform(2, 12) : 0;
            const sgt_vec3 origin = {random.uniform(-1, 1), random.uniform(-1, 1), z};
            if (random.chance(0.5))
                e.pose = sgt_pose_tilted(origin, {random.uniform(-20, 20), random.uniform(-20, 20), 0});
            else
                e.pose.origin = origin;
            q.e.push_back(e);
            if (e.index == SGT_MIRROR) way = -way;
            z += way * random.uniform(0, 15);
        }
        asked += known_rays(q, random, random.log_uniform(0.05, 0.5), 6, 5);
    }
    std::printf("%ld known rays of %d random systems\n", asked, systems);
    if (asked < systems) fail("random", "too few rays", double(asked), systems);
}

// Rays of one surface and a plane stop behind it, of which the root is meant that is not the nearer one: that
// is on the other sheet of a hyperboloid, or outside of the rim or of the aperture.  The proof has to know of
// it.
static void other_roots(oracle::generator &random)
{
    static sgt_conic plane = {0, 0, 0};
    long asked[2] = {0, 0};
    const long wanted = std::max(10L, long(60 * scale));
    for (long tried = 0; std::min(asked[0], asked[1]) < wanted && tried < 4000 * wanted; tried++) {
        const bool sheets = asked[0] < wanted, by_rim = random.chance(0.5);
        const double c = random.sign() * random.uniform(0.05, 0.3), inner = sheets ? 0 : random.uniform(2, 6),
                     k = sheets ? -random.log_uniform(1.2, 30) : -random.uniform(0, 1),
                     rim = by_rim ? inner : 0;
        const double terms[9] = {0, 0, 0, 0, 0, 0, 0, 0, -random.uniform(0.1, 1) * c};
        sgt_conic conic = {c, k, rim};
        sgt_even_asphere asphere = {c, k, rim, {0, -random.log_uniform(3e-4, 3e-2) * c}};
        sgt_zernike zernike = {c, k, rim, 6, SGT_FRINGE, 0, {terms, 1, 9}};
        const sgt_surface types[] = {
            {&sgt_conic_ops, &conic}, {&sgt_even_asphere_ops, &asphere}, {&sgt_zernike_ops, &zernike}};
        question q = {"the other root", {}, {}, 1, 1, {}, {0, 0}};
        sgt_element e = {};
        e.surface = types[sheets ? 0 : 1 + random.below(2)], e.semi_diameter = by_rim ? 0 : inner;
        e.index = random.chance(0.2) ? SGT_MIRROR : random.uniform(0.7, 1.5), q.e.push_back(e);
        e = {}, e.surface = {&sgt_conic_ops, &plane};
        e.pose = sgt_pose_tilted({random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(-9, 9)},
                                 {random.uniform(-60, 60), random.uniform(-60, 60), 0});
        q.e.push_back(e);
        const double slope = random.sign() * random.log_uniform(0.5, 10), x = random.uniform(-8, 8);
        q.beam.d = {slope, 0, 1}, q.beam.o = {x - 9 * slope, random.uniform(-3, 3), -9};
        q.beam.ou = {1, 0, 0}, q.beam.ov = {0, 1, 0};
        sgt_ray ray = sgt_beam_ray(&q.beam, 0, 0), again = ray;
        sgt_passage passages[2], open[2];
        if (sgt_trace(2, q.e.data(), 1, &ray, passages, nullptr, nullptr) != 2) continue;
        double near = 0; // t of the nearer one
        if (sheets) {
            const double y = q.beam.o.y, A = c * (slope * slope + 1 + k), B = 1 - c * x * slope,
                         C = c * (x * x + y * y);
            near = 9 + C / (B + std::copysign(std::sqrt(B * B - A * C), B));
        } else {
            asphere.semi_diameter = zernike.semi_diameter = q.e[0].semi_diameter = 0;
            sgt_trace(1, q.e.data(), 1, &again, open, nullptr, nullptr);
            asphere.semi_diameter = zernike.semi_diameter = rim, q.e[0].semi_diameter = by_rim ? 0 : inner;
            near = open[0].hit.t;
        }
        if (!(std::fabs(near - passages[0].hit.t) > 1e-3)) continue;
        q.wanted = {passages[1].hit.p.x, passages[1].hit.p.y};
        const double wide = random.log_uniform(1e-4, 1);
        q.beam.u = {-wide * random.uniform(0, 1), wide * random.uniform(0, 1)};
        q.beam.v = {-wide * random.uniform(0, 1), wide * random.uniform(0, 1)};
        asked[sheets ? 0 : 1]++;
        if (proof_alone(q) == SGT_NO_SUCH_RAY) fail(q.name, "a known ray is said not to be", c, k);
    }
    std::printf("%ld and %ld rays of which the other root is meant\n", asked[0], asked[1]);
    if (std::min(asked[0], asked[1]) < wanted)
        fail("the other root", "too few", double(asked[0]), double(asked[1]));
}

// -------------------------------------------------------- proofs that must not be lost

// One surface and a plane behind it.  No ray of the beam meets any point, or none far out.  (What is said of
// conics beside their rim is UNKNOWN, bundle_conic.c; where a hemisphere is met from within, also.)
static void provable(const char *name, sgt_surface s, bool deep, oracle::generator &random)
{
    static sgt_conic plane = {0, 0, 0};
    const char *why[] = {"out of reach", "out of reach, slanted", "beside the rim", "totally reflected"};
    for (int reason = 0; reason < 4; reason++) {
        if ((reason == 2 && s.ops == &sgt_conic_ops) || (reason == 3 && deep)) continue;
        question q = {name, {}, {}, reason == 3 ? 1.5 : 1, 1, {}, {0, 0}};
        sgt_element e = {};
        e.surface = s, e.index = reason == 3 ? 1 : 1.5, q.e.push_back(e);
        e.surface = {&sgt_conic_ops, &plane}, e.index = 0, e.pose.origin = {0, 0, 8}, q.e.push_back(e);
        const double slope = reason == 3 ? 2.5 : reason == 1 ? 0.3 : 0, aside = reason == 2 ? 12 : 0;
        q.beam.o = {aside - 20 * slope, 0, -20}, q.beam.d = {slope, 0, 1};
        q.beam.ou = {1, 0, 0}, q.beam.ov = {0, 1, 0};
        const double half = reason == 3 ? 0.5 : 2.5;
        q.beam.u = q.beam.v = {-half, half};
        for (int i = 0; i < 10; i++) { // the lines of rays that are bent by less would run to where x < 0
            q.wanted = {random.uniform(-12, i % 2 ? 12 : -5), random.uniform(-1, 1)};
            if (reason < 2) q.wanted = {random.sign() * 40, random.uniform(-12, 12)};
            sgt_passage passages[2];
            sgt_aiming a;
            if (sgt_aim(1, q.e.data(), q.before, &q.beam, q.wanted, passages, nullptr, &a) != SGT_NO_SUCH_RAY)
                fail(name, why[reason], q.wanted.x, a.status);
        }
    }
}

static void provable_by_type(oracle::generator &random)
{
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        if (b->specimen && b->family != SGT_FAMILY_LEVEL_SET && b->family != SGT_FAMILY_BODY)
            provable(b->type, {b->ops, b->specimen}, false, random);
    // Nearly hemispheres: a square about the rim is not all inside their edge.
    static const double terms[9] = {0, 0, 0, 0.01, 0.01, 0, 0, 0, 0.01};
    sgt_conic conic = {0.2, 0, 4.9};
    sgt_even_asphere asphere = {0.2, 0, 4.9, {1e-4, 1e-5}};
    sgt_odd_asphere odd = {0.2, 0, 4.9, {0, 0, 1e-4}};
    sgt_zernike zernike = {0.2, 0, 4.9, 5, SGT_FRINGE, 0, {terms, 1, 9}};
    provable("hemisphere", {&sgt_conic_ops, &conic}, true, random);
    provable("hemisphere, even asphere", {&sgt_even_asphere_ops, &asphere}, true, random);
    provable("hemisphere, odd asphere", {&sgt_odd_asphere_ops, &odd}, true, random);
    provable("hemisphere, zernike", {&sgt_zernike_ops, &zernike}, true, random);
}

// -------------------------------------------------------------------- odd questions

static void expect(const char *what, const question &q, sgt_aimed want, const sgt_aim_options *opt = nullptr)
{
    std::vector<sgt_passage> passages(q.stop + 1);
    sgt_aiming a;
    const sgt_aimed got = sgt_aim(q.stop, q.e.data(), q.before, &q.beam, q.wanted, passages.data(), opt, &a);
    if (got != want) fail(what, sgt_aimed_text(got), double(got), double(want));
    if (got != SGT_MET && (a.u == a.u || a.miss == a.miss)) fail(what, "numbers without a ray", a.u, a.miss);
}

static void odd_questions()
{
    static sgt_conic front = {1 / 50.0, 0, 0}, back = {-1 / 50.0, 0, 0}, plane = {0, 0, 0},
                     dish = {-1 / 200.0, -1, 0};
    question q = {"odd", {}, {}, 1, 2, {}, {1, 0.5}};
    sgt_element e = {};
    e.surface = {&sgt_conic_ops, &front}, e.index = 1.5, q.e.push_back(e);
    e.surface = {&sgt_conic_ops, &back}, e.index = 1, e.pose.origin = {0, 0, 5}, q.e.push_back(e);
    e.surface = {&sgt_conic_ops, &plane}, e.index = 0, e.pose.origin = {0, 0, 10}, q.e.push_back(e);
    e.surface = {&sgt_conic_ops, &dish}, e.index = SGT_MIRROR,
    e.pose = sgt_pose_tilted({0, 0, 40}, {10, -5, 0});
    q.e.push_back(e);
    e.surface = {&sgt_conic_ops, &plane}, e.index = 0, e.pose = sgt_pose_tilted({10, 20, 0}, {30, 20, 10});
    q.e.push_back(e);
    const sgt_beam beam = {{0, 0, -20}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1},
                           {0, 0, 0},   {0, 0, 0}, {-8, 8},   {-8, 8}, {}};
    q.beam = beam;
    for (std::size_t i = 0; i < q.e.size(); i++) q.slow.push_back(element_of(q.e[i]));
    oracle::generator random(3);
    tally count = {};
    for (q.stop = 0; q.stop < 5; q.stop++) { // the point of a known ray
        for (int i = 0; i < 5; i++) {
            std::vector<sgt_passage> passages(5);
            sgt_ray ray = sgt_beam_ray(&beam, random.uniform(-8, 8), random.uniform(-8, 8));
            if (sgt_trace(5, q.e.data(), 1, &ray, passages.data(), nullptr, nullptr) != 5) continue;
            q.wanted = {passages[q.stop].hit.p.x, passages[q.stop].hit.p.y};
            if (ask(q, random, &count, true).status != SGT_MET) fail("known", "not met", double(q.stop), i);
        }
    }
    if (count.met < 15) fail("known", "too few", double(count.met), 15);
    q.stop = 2, q.wanted = {1, 0.5};
    question bad = q;
    bad.wanted.x = NAN, expect("wanted NaN", bad, SGT_AIMED_INVALID);
    bad = q, bad.beam.o.y = NAN, expect("origin NaN", bad, SGT_AIMED_INVALID);
    bad = q, bad.beam.du.z = INFINITY, expect("infinite", bad, SGT_AIMED_INVALID);
    bad = q, bad.beam.u = {1, -1}, expect("empty box", bad, SGT_AIMED_INVALID);
    bad = q, bad.beam.v.lo = NAN, expect("box NaN", bad, SGT_AIMED_INVALID);
    bad = q, bad.beam.d = {0, 0, 0}, expect("no direction", bad, SGT_AIMED_INVALID);
    sgt_aim_options opt = {};
    opt.tol = NAN, expect("tol NaN", q, SGT_AIMED_INVALID, &opt);
    opt.tol = 0, opt.max_traces = -1, expect("no traces", q, SGT_AIMED_INVALID, &opt);
    opt.max_traces = 0, opt.reserved_[2] = 1, expect("reserved", q, SGT_AIMED_INVALID, &opt);
    // one parameter, or none: met only where the point is on its curve
    bad = q, bad.beam.ov = {0, 0, 0}, bad.wanted = {1, 0}, expect("a fan", bad, SGT_MET);
    bad.wanted = {1, 0.5};
    sgt_aim_options search = {};
    search.max_boxes = -1;
    expect("beside a fan", bad, SGT_AIMED_UNDECIDED, &search);
    bad = q, bad.beam.ov = bad.beam.ou, bad.wanted = {1, 0}, expect("u + v", bad, SGT_MET);
    bad = q, bad.beam.ou = bad.beam.ov = {0, 0, 0}, bad.wanted = {0, 0}, expect("one ray", bad, SGT_MET);
    bad = q, bad.beam.u = {2, 2}, bad.beam.v = {0, 0},
    expect("a point of the box", bad, SGT_AIMED_UNDECIDED, &search);
    // a bad element
    bad = q, bad.e[1].index = -3, expect("a bad index", bad, SGT_AIMED_UNDECIDED, &search);
    // the attempts, a start, a tolerance, and a budget
    sgt_attempt attempt[3];
    const sgt_vec2 start = {1.2, 0.6};
    search.attempt = attempt, search.room = 3, search.start = &start, search.starts = 1;
    expect("a start", q, SGT_MET, &search);
    if (attempt[0].reason != SGT_AIM_ARRIVED || attempt[0].from.x != 1.2 || attempt[0].traces > 8)
        fail("a start", "attempt", attempt[0].reason, attempt[0].traces);
    if (attempt[0].fate != SGT_PASSED || attempt[0].element != 0)
        fail("a start", "all rays have passed", attempt[0].fate, double(attempt[0].element));
    // behind a start whose ray misses the first surface: what became of that is not told of the next
    const sgt_vec2 lost_first[2] = {{150, 0}, start};
    bad = q, bad.beam.u = bad.beam.v = {-200, 200}, search.start = lost_first, search.starts = 2;
    expect("a second start", bad, SGT_MET, &search);
    if (attempt[0].reason != SGT_AIM_NO_WAY || attempt[0].fate != SGT_MISSED ||
        attempt[1].reason != SGT_AIM_ARRIVED || attempt[1].fate != SGT_PASSED)
        fail("a second start", "fates", attempt[0].fate, attempt[1].fate);
    search.start = &start, search.starts = 1;
    search.max_traces = 2, expect("a budget", q, SGT_AIMED_UNDECIDED, &search);
    if (attempt[0].reason != SGT_AIM_SPENT) fail("a budget", "reason", attempt[0].reason, 0);
    for (int budget = 1; budget <= 2; budget++) { // is spent to the last trace, and no further
        search.max_traces = budget, expect("a budget", q, SGT_AIMED_UNDECIDED, &search);
        if (attempt[0].traces != budget) fail("a budget", "traces", attempt[0].traces, budget);
    }
    search.max_traces = 0, search.tol = 0.5, expect("a tolerance", q, SGT_MET, &search);
    if (attempt[0].traces > 3) fail("a tolerance", "traces", attempt[0].traces, 3);
    search.tol = 0, bad = q, bad.wanted = {30, 0}, bad.beam.u = bad.beam.v = {-8, 8};
    expect("beyond the edge", bad, SGT_AIMED_UNDECIDED, &search);
    if (attempt[1].reason != SGT_AIM_AT_EDGE) fail("beyond the edge", "reason", attempt[1].reason, 0);
    bad.beam.o.x = 500, expect("beside the lens", bad, SGT_AIMED_UNDECIDED, &search);
    if (attempt[1].reason != SGT_AIM_NO_WAY || attempt[1].fate != SGT_MISSED)
        fail("beside the lens", "reason", attempt[1].reason, 0);
}

int main(int argc, char **argv)
{
    if (argc < 2) return std::printf("usage: test_aim FOLDER-OF-LENSES\n"), 2;
    const char *text = std::getenv("SAGITTA_TEST_SCALE"), *seed = std::getenv("SAGITTA_TEST_SEED");
    if (text) scale = std::atof(text);
    oracle::generator random(seed ? std::strtoull(seed, nullptr, 10) : 20262);
    for (const char *name : {"cooke_triplet", "ftheta", "cassegrain", "newtonian", "aspheric_singlet",
                             "toroidal_lens", "figured_mirror"})
        try_lens(argv[1], name, random);
    random_systems(random);
    other_roots(random);
    provable_by_type(random);
    odd_questions();
    return failures != 0;
}
