// SPDX-License-Identifier: MIT
// The unit of length changes no bit: ordinary rays, all lengths times 2^k, every k from -40 to 40.
//
// Of each row of sgt_builtins, of the same surfaces given as a user's (their operations without what only a
// built-in surface can say: with and without an enclosure, a span, a first root), and of formulas, whose
// numbers are scaled in their text.  The parameters of a surface are multiplied by the power that their unit
// in the table of types says, rays, ends and tolerances by 2^k.  All operations are then scaled exactly.  So
// every number is to be the same but for its factor, every status and every count of evaluations equal:
//
//     sgt_intersect         both picks, all proofs
//     sgt_intersect_all     all proofs
//     sgt_intersect_batch   all numbers, against sgt_intersect at that scale
//     sgt_differentiate     by the origin and by the parameters
//     sgt_trace             a tilted element of glass with apertures, an ideal lens, a mirror and a plane
//     sgt_trace_gradient, sgt_trace_error, sgt_aim   through the same elements
//
// One thing is excused: see SEARCHED.
//
// The Julia and Mandelbrot sets take part with their slices scaled.  Surfaces of the Earth have one size.
//
// SAGITTA_TEST_SCALE from 10 on asks for all 80 powers; else for eight of them, odd and even.
#include "../ends.h"
#include "scaling.h"

#include <sagitta/aim.h>
#include <sagitta/formula.h>

#include <algorithm>
#include <functional>

using namespace catalogue;

namespace
{

long compared, failures, far_out;
std::map<std::string, long> failed;

// A ray without an end is searched to where powers of r leave the range of doubles.  That is at one number,
// whatever the unit of length.  So the last cells before it are divided a few times more or less, and an
// eighth of all; after hundreds of evaluations, and where the search stays undecided, more than that.  The
// count of evaluations may differ by that.
// Of what is undecided, a ray within the surface too, it may differ where it begins and ends, why, and how
// many such stretches are told.  A root that one tells may lie in a stretch that the other leaves undecided.
// A trace may be undecided at one scale alone, if the stretch it leaves undecided has no end.
// No hit and no miss may differ else, and no number of a hit.
//
// A number of a formula that is 1 at one scale is dropped by the reader of formulas, with the rounding of its
// product: none of the numbers below is a power of two.
enum { SEARCHED = 500, A_FEW = 8, PART = 8 };

bool undecided_of(int status) { return status != SGT_HIT && status != SGT_MISS; }

bool endless_of(const sgt_ray &r) { return !std::isfinite(r.tmin) || !std::isfinite(r.tmax); }

bool by_range(int got, int want)
{
    return std::max(got, want) >= SEARCHED || std::abs(got - want) <= A_FEW + std::max(got, want) / PART;
}

bool in_doubt_far_out(const sgt_hit &h)
{
    return undecided_of(h.status) && (std::isinf(h.lo) || std::isinf(h.hi));
}

// Do two lists of an endless ray tell the same roots?  Each root of one is a root of the other, to the bit,
// or lies in a stretch that the other leaves undecided.
bool same_roots(const std::vector<sgt_hit> &a, const std::vector<sgt_hit> &b)
{
    const auto told = [](const sgt_hit &h, const std::vector<sgt_hit> &list) {
        return h.status != SGT_HIT || std::any_of(list.begin(), list.end(), [&](sgt_hit one) {
            if (undecided_of(one.status)) return one.lo <= h.t && h.t <= one.hi;
            one.evals = h.evals;
            return !difference(h, one);
        });
    };
    return std::all_of(a.begin(), a.end(), [&](const sgt_hit &h) { return told(h, b); }) &&
           std::all_of(b.begin(), b.end(), [&](const sgt_hit &h) { return told(h, a); });
}

// A surface at each scale.  Numbers of F are 2^(k by_f) times those at k = 0.
struct maker {
    std::string name;
    double h;
    int by_f;
    std::function<sgt_surface(int k, bool *exact)> at;
    std::vector<int> powers; // of length, of each parameter for derivatives
};

void fail(const maker &m, int k, const std::string &what, const sgt_ray &r, const sgt_options &o,
          const sgt_hit *got = nullptr, const sgt_hit *want = nullptr)
{
    failures++;
    if (failed[m.name + ": " + what]++ >= 1) return;
    std::printf("FAIL %s, %s: lengths times 2^%d; pick %d proof %d t_tol %a\n", m.name.c_str(), what.c_str(),
                k, static_cast<int>(o.pick), static_cast<int>(o.proof), o.t_tol);
    bool exact;
    const sgt_surface s = m.at(0, &exact);
    if (row_named(m.name)->type) print_surface(s);
    std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z,
                r.tmin, r.tmax);
    for (const sgt_hit *h : {want, got})
        if (h)
            std::printf("    %-4s %s evals %d t %a t_err %a t_lo %a [%a, %a] p_err %a n.x %a f %a\n",
                        h == want ? "want" : "got", sgt_status_text(h->status), h->evals, h->t, h->t_err,
                        h->t_lo, h->lo, h->hi, h->p_err, h->n.x, h->f);
}

void compare(const maker &m, int k, const char *by, const sgt_ray &r, const sgt_options &o,
             const sgt_hit &got, const sgt_hit &want)
{
    compared++;
    const char *why = difference(got, want);
    const bool endless = endless_of(r) || by[0] == 't'; // a trace has no ends
    const bool undecided = undecided_of(got.status) && undecided_of(want.status);
    if (why && endless && (undecided || by_range(got.evals, want.evals))) {
        sgt_hit like = got;
        like.evals = want.evals;
        if (undecided || !difference(like, want)) why = nullptr, far_out++;
    }
    if (why) fail(m, k, std::string(by) + ", " + why, r, o, &got, &want);
}

void compare(const maker &m, int k, const char *what, const sgt_ray &r, const sgt_options &o, double got,
             double want, int by)
{
    compared++;
    if (!same(got, times(want, by))) {
        fail(m, k, what, r, o);
        if (failed[m.name + ": " + what] <= 1) std::printf("    want %a, got %a\n", times(want, by), got);
    }
}

sgt_ray scaled(const sgt_ray &r, int k) { return {times(r.o, k), r.d, times(r.tmin, k), times(r.tmax, k)}; }

// Elements of glass, an ideal lens, a mirror and a plane about a surface, with all that has a length.
struct row_of_elements {
    sgt_aperture_item items[3];
    sgt_vec2 corners[4];
    sgt_aperture aperture;
    sgt_phase phase;
    sgt_conic mirror, flat;
    sgt_element e[4];

    row_of_elements(const sgt_surface &s, double h0, int k)
        : items(), corners(), aperture(), phase(), mirror(), flat()
    {
        const double h = times(h0, k);
        items[0].shape = SGT_ELLIPSE, items[0].half = {0.9 * h, 0.8 * h}, items[0].degrees = 20;
        items[1].shape = SGT_SPIDER, items[1].obscuring = true, items[1].arms = 3;
        items[1].width = 0.02 * h, items[1].length = h;
        corners[0] = {h, 0}, corners[1] = {0, h}, corners[2] = {-h, 0.1 * h}, corners[3] = {0, -h};
        items[2].shape = SGT_POLYGON, items[2].vertices = corners, items[2].count = 4;
        aperture.count = 3, aperture.items = items;
        phase.kind = SGT_IDEAL_LENS, phase.focal_length = 7 * h, phase.object_distance = -30 * h;
        mirror.c = -0.05 / h, mirror.k = -0.5;
        std::memset(static_cast<void *>(e), 0, sizeof e);
        e[0].surface = s, e[0].pose = sgt_pose_tilted({0.1 * h, 0, h}, {3, -2, 10}), e[0].index = 1.5;
        e[0].aperture = &aperture, e[0].semi_diameter = 0.95 * h;
        e[1].surface = {&sgt_conic_ops, &flat}, e[1].pose.origin = {0, 0, 2 * h}, e[1].phase = &phase;
        e[2].surface = {&sgt_conic_ops, &mirror}, e[2].pose = sgt_pose_tilted({0, 0, 4 * h}, {1, 2, 0});
        e[2].index = SGT_MIRROR;
        e[3].surface = {&sgt_conic_ops, &flat};
    }
    row_of_elements(const row_of_elements &) = delete;
};

void compare_traces(const maker &m, int k, const sgt_surface &plain, const sgt_surface &resized,
                    const sgt_ray &r, const sgt_options &o)
{
    row_of_elements a(plain, m.h, 0), b(resized, m.h, k);
    sgt_passage pa[4] = {}, pb[4] = {};
    sgt_ray ra = r, rb = scaled(r, k);
    sgt_fate fa, fb;
    sgt_options ob = o;
    ob.t_tol = times(o.t_tol, k);
    const std::size_t na = sgt_trace(4, a.e, 1, &ra, pa, &fa, &o),
                      nb = sgt_trace(4, b.e, 1, &rb, pb, &fb, &ob);
    compared++;
    if (na != nb || fa != fb) {
        const std::size_t last = std::min({na, nb, std::size_t{3}});
        if (in_doubt_far_out(pa[last].hit) != in_doubt_far_out(pb[last].hit))
            far_out++;
        else
            fail(m, k, "trace, fate", r, o);
        return;
    }
    for (std::size_t i = 0; i < na + (na < 4); i++) {
        compare(m, k, "trace", r, o, pb[i].hit, expected(pa[i].hit, k, k, i ? k : m.by_f * k));
        compare(m, k, "trace, path", r, o, pb[i].opl, pa[i].opl, k);
        compared++;
        if (!same(pb[i].direction, pa[i].direction)) fail(m, k, "trace, direction", r, o);
    }
    if (na < 4) return;
    sgt_end_error ea, eb;
    const sgt_ray launch = scaled(r, k);
    const bool known = sgt_trace_error(4, a.e, 1, &r, pa, &ea);
    compared++;
    if (known != sgt_trace_error(4, b.e, 1, &launch, pb, &eb))
        fail(m, k, "error of the end, known", r, o);
    else if (known) {
        compare(m, k, "error of the end", r, o, eb.point, ea.point, k);
        compare(m, k, "error of the path", r, o, eb.path, ea.path, k);
        compare(m, k, "grain", r, o, eb.grain, ea.grain, k);
    }
    std::vector<int> powers = {1, 1, 1, 0, 0, 0, 0}; // of the launch and the index before
    for (int i = 0; i < 4; i++) {
        if (i == 0)
            powers.insert(powers.end(), m.powers.begin(), m.powers.end());
        else
            powers.insert(powers.end(), {-1, 0}); // c and k
        powers.insert(powers.end(), {1, 1, 1, 0, 0, 0, 0});
    }
    const std::size_t count = sgt_trace_parameters(4, a.e);
    compared++;
    if (count != powers.size()) {
        fail(m, k, "gradient, parameters", r, o);
        return;
    }
    const sgt_ray_change weight[2] = {{{1, 0.5, 0}, {0, 0, 0}, 0.25}, {{0, 0, 0}, {1, 0, 0.5}, 0}};
    std::vector<double> ga(2 * count), gb(2 * count);
    const int la = sgt_trace_gradient(4, a.e, 1, &r, pa, 2, weight, ga.data()),
              lb = sgt_trace_gradient(4, b.e, 1, &launch, pb, 2, weight, gb.data());
    compared++;
    if (la != lb) fail(m, k, "gradient, lacks", r, o);
    for (std::size_t j = 0; j < count && la == lb; j++) {
        compare(m, k, "gradient of a length", r, o, gb[j], ga[j], k * (1 - powers[j]));
        compare(m, k, "gradient of a direction", r, o, gb[count + j], ga[count + j], -k * powers[j]);
    }
}

void compare_aims(const maker &m, int k, const sgt_surface &plain, const sgt_surface &resized, generator g)
{
    row_of_elements a(plain, m.h, 0), b(resized, m.h, k);
    for (row_of_elements *e : {&a, &b}) e->e[1].phase = nullptr, e->e[1].index = 1;
    const double h = m.h;
    sgt_beam beam = {};
    beam.o = {0, 0, -3 * h}, beam.ou = {h, 0, 0}, beam.ov = {0, h, 0}, beam.d = {0.05, 0.02, 1};
    beam.u = beam.v = {-1.5, 1.5};
    sgt_beam other = beam;
    for (sgt_vec3 *x : {&other.o, &other.ou, &other.ov}) *x = times(*x, k);
    const sgt_vec2 at = {h * g.uniform(-0.5, 0.5), h * g.uniform(-0.5, 0.5)};
    sgt_aim_options o = {};
    o.max_boxes = 60;
    sgt_passage pa[2], pb[2];
    sgt_aiming x, y;
    sgt_aim(1, a.e, 1, &beam, at, pa, &o, &x);
    sgt_aim(1, b.e, 1, &other, {times(at.x, k), times(at.y, k)}, pb, &o, &y);
    compared++;
    if (x.status != y.status || !same(x.u, y.u) || !same(x.v, y.v) || x.boxes != y.boxes ||
        x.traces != y.traces ||
        x.clipped != y.clipped || !same(times(x.miss, k), y.miss) || !same(times(x.point.x, k), y.point.x)) {
        fail(m, k, "aim", {}, {});
        if (failed[m.name + ": aim"] <= 1)
            std::printf("    want %s u %a v %a miss %a %d %d\n    got  %s u %a v %a miss %a %d %d\n",
                        sgt_aimed_text(x.status), x.u, x.v, times(x.miss, k), x.traces, x.boxes,
                        sgt_aimed_text(y.status), y.u, y.v, y.miss, y.traces, y.boxes);
    }
}

void ask(const maker &m, generator &g, const std::vector<sgt_ray> &rays, const std::vector<int> &powers)
{
    enum { room = 12 };
    bool fine = true;
    const sgt_surface plain = m.at(0, &fine);
    const std::size_t n = rays.size();
    std::vector<sgt_hit> want[6], list[3];
    std::vector<int> many[3];
    const double tol = g.chance(0.2) ? m.h * std::ldexp(1.0, -10 - g.below(40)) : 0;
    const auto options_of = [&](int q, int k) {
        sgt_options o = {};
        o.pick = q / 3 ? SGT_NEAR_SEED : SGT_FIRST, o.proof = static_cast<sgt_proof>(q % 3);
        o.t_tol = times(tol, k);
        return o;
    };
    for (int q = 0; q < 6; q++) {
        const sgt_options o = options_of(q, 0);
        for (const sgt_ray &r : rays) {
            want[q].push_back(sgt_intersect(plain, r, &o));
            if (q >= 3) continue;
            sgt_hit some[room] = {};
            many[q].push_back(sgt_intersect_all(plain, r, room, some, &o));
            list[q].insert(list[q].end(), some, some + room);
        }
    }
    for (int k : powers) {
        bool exact = true;
        const sgt_surface s = m.at(k, &exact);
        if (!exact) continue;
        for (int q = 0; q < 6; q++) {
            const sgt_options o = options_of(q, k), plain_o = options_of(q, 0);
            std::vector<double> in[8], out[12];
            std::vector<sgt_status> status(n);
            for (std::vector<double> &x : out) x.resize(n);
            for (std::size_t i = 0; i < n; i++) {
                const sgt_ray r = scaled(rays[i], k);
                const auto expect = [&](const sgt_hit &h) { return expected(h, k, k, m.by_f * k); };
                const sgt_hit got = sgt_intersect(s, r, &o);
                compare(m, k, "one ray", rays[i], plain_o, got, expect(want[q][i]));
                const double x[8] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin, end_of(&r)};
                for (int j = 0; j < 8; j++) in[j].push_back(x[j]);
                if (q < 3) {
                    sgt_hit some[room] = {};
                    const int found = sgt_intersect_all(s, r, room, some, &o);
                    compared++;
                    const sgt_hit *const all = &list[q][i * room];
                    std::vector<sgt_hit> wanted(all, all + std::min<int>(many[q][i], room));
                    for (sgt_hit &h : wanted) h = expect(h);
                    if (found != many[q][i] && endless_of(r) && std::max(found, many[q][i]) <= room &&
                        same_roots({some, some + found}, wanted))
                        far_out++;
                    else if (found != many[q][i])
                        fail(m, k, "all, how many", rays[i], plain_o);
                    else
                        for (int j = 0; j < found && j < room; j++)
                            compare(m, k, "all", rays[i], plain_o, some[j], expect(all[j]));
                    compare_traces(m, k, plain, s, rays[i], plain_o);
                }
                if (q == 0 && got.status > 0 && want[q][i].status == got.status) {
                    const std::size_t count = m.powers.size();
                    std::vector<sgt_change> pa(count), pb(count);
                    sgt_change a[3], b[3];
                    sgt_differentiate(plain, &rays[i], &want[q][i], a, count ? pa.data() : nullptr);
                    sgt_differentiate(s, &r, &got, b, count ? pb.data() : nullptr);
                    for (int j = 0; j < 3; j++) {
                        compare(m, k, "dt/do", rays[i], plain_o, b[j].t, a[j].t, 0);
                        compare(m, k, "dp/do", rays[i], plain_o, b[j].p.y, a[j].p.y, 0);
                        compare(m, k, "dn/do", rays[i], plain_o, b[j].n.x, a[j].n.x, (m.by_f - 2) * k);
                    }
                    for (std::size_t j = 0; j < count; j++) {
                        const int by = m.powers[j];
                        compare(m, k, "dt/da", rays[i], plain_o, pb[j].t, pa[j].t, k * (1 - by));
                        compare(m, k, "dn/da", rays[i], plain_o, pb[j].n.x, pa[j].n.x, k * (m.by_f - 1 - by));
                    }
                }
            }
            sgt_hits hits = {};
            hits.status = status.data(), hits.t = out[0].data(), hits.t_err = out[1].data(),
            hits.t_lo = out[2].data();
            sgt_intersect_batch(s, n,
                                {{in[0].data(), in[1].data(), in[2].data()},
                                 {in[3].data(), in[4].data(), in[5].data()},
                                 in[6].data(),
                                 in[7].data()},
                                hits, &o);
            for (std::size_t i = 0; i < n; i++) {
                const sgt_hit h = expected(want[q][i], k, k, m.by_f * k);
                compared++;
                const bool undecided = undecided_of(h.status) && undecided_of(status[i]);
                if (endless_of(rays[i]) && (h.evals >= SEARCHED || undecided))
                    continue; // `one ray`, and tests of batches, have judged it
                if (status[i] != h.status || !same(out[0][i], h.t) || !same(out[1][i], h.t_err) ||
                    !same(out[2][i], h.t_lo))
                    fail(m, k, "batch", rays[i], plain_o);
            }
        }
        compare_aims(m, k, plain, s, g);
    }
    g.bits();
}

// --------------------------------------------------------------------------- what is asked

std::vector<sgt_ray> rays_at(generator &g, const target &t, int n)
{
    const subject of(t.shape);
    std::vector<sgt_ray> rays;
    for (int i = 0; i < n; i++)
        rays.push_back(
            random_ray(g, of, g.chance(0.6) ? ordinary : static_cast<ray_kind>(g.below(ray_kinds))));
    return rays;
}

// The powers of length of the parameters for derivatives, in their order: those of the struct but for the rim
// and what makes coordinates of length 1.  Planes and spheres are conics; the heights of a grid are none.
std::vector<int> powers_of(const sgt_surface &s, bool base = true)
{
    const char *const left_out[] = {"semi_diameter", "norm", "norm_x", "norm_y", "step_x", "step_y"};
    if (s.ops == &sgt_conic_ops) return {-1, 0};
    if (row_of(s.ops)->family == SGT_FAMILY_LEVEL_SET) return {};
    if (s.ops == &sgt_grid_ops) return base ? std::vector<int>{-1, 0} : std::vector<int>{};
    std::vector<int> powers;
    for (const sgt_param *p = row_of(s.ops)->params; p->name; p++) {
        const char *at = static_cast<const char *>(s.self) + p->offset;
        const std::string name = p->name;
        bool left = !base && (name == "curvature" || name == "conic") && s.ops != &sgt_toroidal_ops;
        for (const char *x : left_out) left = left || name == x;
        if (left) continue;
        if (p->kind == SGT_PARAM_REAL || p->kind == SGT_PARAM_VECTOR)
            for (int i = 0; i < p->count; i++) powers.push_back(power_of(p->unit, i, 0));
        sgt_numbers a;
        if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) std::memcpy(&a, at, sizeof a);
        if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE)
            for (std::size_t i = 0; i < a.rows * a.columns; i++) {
                const int row = static_cast<int>(i / a.columns), column = static_cast<int>(i % a.columns);
                powers.push_back(power_of(p->unit, p->kind == SGT_PARAM_LIST ? column : row, column));
            }
        if (p->kind != SGT_PARAM_TERMS) continue;
        const sgt_surface *terms;
        std::size_t count;
        std::memcpy(&terms, at, sizeof terms);
        std::memcpy(&count, at + sizeof terms, sizeof count);
        for (std::size_t i = 0; i < count; i++) {
            const std::vector<int> own = powers_of(terms[i], false);
            powers.insert(powers.end(), own.begin(), own.end());
        }
    }
    return powers;
}

void built_in(generator &g, const std::string &type, const std::vector<int> &powers)
{
    const target t = random_target(g, type);
    const sgt_builtin *row = row_named(type);
    std::vector<std::shared_ptr<scaling>> kept;
    maker m = {type, t.s.h,
               type == "quadric"              ? 2
               : row->family == SGT_FAMILY_LEVEL_SET ? 0
                                              : 1,
               [&](int k, bool *exact) {
                   kept.push_back(std::make_shared<scaling>(type));
                   const sgt_surface s = kept.back()->surface(t.s, k);
                   *exact = kept.back()->exact && kept.back()->moderate;
                   return s;
               },
               powers_of(t.s.s)};
    const std::vector<sgt_ray> rays = rays_at(g, t, 6);
    if (sgt_parameters(t.s.s) != m.powers.size())
        failures++, std::printf("FAIL %s: %zu parameters, not %zu\n", type.c_str(), sgt_parameters(t.s.s),
                                m.powers.size());
    ask(m, g, rays, powers);
    sgt_surface_ops offers = *row->ops;
    offers.own_ = nullptr;
    const int kind = g.below(4);
    if (kind == 1) offers.enclose = nullptr, offers.encloses = nullptr;
    if (kind == 2)
        offers.span = nullptr, offers.spans = nullptr, offers.first = nullptr, offers.firsts = nullptr;
    if (kind == 3) offers.first = nullptr, offers.firsts = nullptr, offers.rounding = nullptr;
    const auto built = m.at;
    m.name = "user's " + type + std::to_string(kind);
    m.at = [&](int k, bool *exact) { return sgt_surface{&offers, built(k, exact).self}; };
    ask(m, g, {rays.begin(), rays.begin() + 2}, {powers.begin(), powers.begin() + 2});
}

// A text in which a number and its power of length stand as <number:power>.  It is written with all its
// digits: the reader encloses a decimal number that is no double, more or less widely.
std::string text_at(const std::string &with, int k)
{
    std::string out;
    for (std::size_t i = 0; i < with.size(); i++) {
        if (with[i] != '<') {
            out += with[i];
            continue;
        }
        char *end, number[160];
        const double x = std::strtod(with.c_str() + i + 1, &end);
        const int by = static_cast<int>(std::strtol(end + 1, &end, 10));
        std::snprintf(number, sizeof number, "%.120g", std::ldexp(x, k * by));
        out += number;
        i = static_cast<std::size_t>(end - with.c_str());
    }
    return out;
}

struct formula_case {
    const char *text;
    bool sag;
    int by_f;
    double ball;
};
const formula_case formulas[] = {
    {"x^2 + y^2 + z^2 - <9:2>", false, 2, 5},
    {"z^2 + y^2*(<1.1:2> + y^2*<0.1:0>)*<0.3:-2> + x*y*<0.2:0> - <4:2>", false, 2, 6},
    {"sqrt(x^2 + <1.1:2>) + hypot(y, z) - <3.3:1>", false, 1, 6},
    {"sin(x*<1.1:-1>)*cos(y*<1.1:-1>) + sin(y*<1.1:-1>)*cos(z*<1.1:-1>) + sin(z*<1.1:-1>)*cos(x*<1.1:-1>)",
     false, 0, 5},
    {"max(x^2 + y^2 - <2.1:2>, abs(z)*<1.5:1> - <2.1:2>)", false, 2, 6},
    {"exp(-(x^2 + y^2)*<0.3:-2>)*<1.1:1> + cbrt(z*<2.3:2>) - <0.2:1>", false, 1, 5},
    {"<0.05:-1>*(x^2 + y^2)/(1 + sqrt(1 - <0.002:-2>*(x^2 + y^2)))", true, 1, 4},
    {"<0.05:-1>*r^2 + <1e-3:-2>*r^3 - <2e-5:-4>*r^5", true, 1, 4},
    {"<0.03:-1>*x^2 + <0.05:-1>*y^2 + <1e-3:-2>*x^3 + <0.01:1>*sin(y*<2.1:-1>)", true, 1, 4},
    {"<0.2:1>*exp(-r^2*<0.2:-2>)*cos(x*<0.6:-1>)", true, 1, 4},
};

void formula_made(generator &g, const formula_case &f, const std::vector<int> &powers)
{
    struct kept_formula {
        std::vector<double> room;
        sgt_formula whole;
        sgt_formula_sag sag;
    };
    std::vector<std::shared_ptr<kept_formula>> kept;
    const maker m = {f.text, f.ball, f.by_f,
                     [&](int k, bool *exact) {
                         kept.push_back(std::make_shared<kept_formula>());
                         kept_formula &to = *kept.back();
                         const std::string text = text_at(f.text, k);
                         const std::size_t size = sgt_formula_room(text.c_str(), 0);
                         to.room.resize(size / sizeof(double) + 8);
                         sgt_error error;
                         const sgt_tape *tape = sgt_formula_read(
                             text.c_str(), f.sag ? SGT_FORMULA_XY : SGT_FORMULA_XYZ, 0, nullptr,
                             to.room.data(), to.room.size() * sizeof(double), &error);
                         if (!tape) failures++, std::printf("FAIL %s: %s\n", text.c_str(), error.words);
                         *exact = tape != nullptr;
                         to.whole = {tape, times(f.ball, k), {0, 0, 0}, {0, 0, 0}};
                         to.sag = {tape, times(f.ball, k)};
                         return f.sag ? sgt_surface{&sgt_formula_sag_ops, &to.sag}
                                      : sgt_surface{&sgt_formula_ops, &to.whole};
                     },
                     {}};
    std::vector<sgt_ray> rays;
    for (int i = 0; i < 6; i++) {
        const sgt_vec3 d = random_direction(g);
        const sgt_vec3 at = {g.uniform(-3, 3), g.uniform(-3, 3), f.sag ? 0 : g.uniform(-3, 3)};
        const double away = g.uniform(0, 10);
        rays.push_back({{at.x - away * d.x, at.y - away * d.y, at.z - away * d.z}, d, 0, HUGE_VAL});
    }
    ask(m, g, rays, powers);
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run r(argc, argv, 1, 20260802);
    const char *only = std::getenv("SAGITTA_TEST_TYPE");
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++) {
        if (only && std::strcmp(only, row->type)) continue;
        generator g(r.seed + static_cast<std::uint64_t>(row - sgt_builtins()) * 1000003);
        for (long i = 0; i < r.count; i++) {
            std::vector<int> powers = {1, -1, 3, -2, 39, -37, 40, -40};
            if (r.count >= 10) {
                powers.clear();
                for (int k = 1; k <= 40; k++) powers.push_back(k), powers.push_back(-k);
            }
            built_in(g, row->type, powers);
            if (row == sgt_builtins())
                for (const formula_case &f : formulas) formula_made(g, f, powers);
        }
    }
    for (const auto &f : failed) std::printf("  FAIL %8ld  %s\n", f.second, f.first.c_str());
    std::printf("%ld comparisons, %ld failures; %ld searches beyond the range of doubles took another time\n",
                compared, failures, far_out);
    if (far_out * 1000 > compared) failures++, std::printf("FAIL these are too many\n");
    return failures != 0;
}
