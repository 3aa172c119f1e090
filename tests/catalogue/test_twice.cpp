// SPDX-License-Identifier: MIT
// The same question asked twice, of every row of sgt_builtins and of users' surfaces made from some of
// them.  No answer is compared with a truth, but all of them with each other:
//
//   first      sgt_intersect tells the first entry of sgt_intersect_all: the status and the root, under
//              each proof (of a
//              root alone the first that is proven);
//   only       the root near the seed, proven to be the only one, is the only one of all;
//   proof      what is proven does not contradict what is told without a proof, nor what another proof
//              proves;
//   ends       a root that counts with one tmax counts with a greater one, and a root that counts with one
//              tmin with a
//              lesser one: each root's own t, a few ulps and a few t_err about it.  Each of these is a
//                search of its own,
//              that tells t anew: within t_err of the root the two may differ;
//   reverse    the ray turned round at its origin has the same roots, at -t;
//   split      cut in two at any t, or at a root and a few ulps beside it, the halves have the roots of the
//              whole; the one
//              at the cut has to be in one half at most, and in one at least where it is farther from the
//                cut than what
//              sgt_ray's rule of the start and t_err can hide;
//   nothing    a coordinate or a component of d that is 0 may as well be 1e-160 or 5e-324 (a cosine of 90
//              degrees to some power);
//   tolerance  however coarse t_tol is, with tmax next to the root, a hit does not become a miss.
//
// Undecided stretches and grazes say less than a hit or a miss does, and contradict what they exclude alone.
#include "agree.h"
#include "judge.h"

using namespace catalogue;

namespace {

std::map<std::string, long> failed, counted;
std::string name_of_case;

// ------------------------------------------------------------------- surfaces

// Those that answer by themselves; rays at conics and aspheres are oracle's own.
const char *const themselves[] = {"plane", "sphere", "conic", "even_asphere", "julia", "mandelbrot"};

struct question {
    std::string type;
    sgt_surface s;
    sgt_ray ray; // the ends are explicit
    std::vector<std::shared_ptr<void>> kept;
    bool certain; // no march, which sees what its steps show: other ends are other steps
};

void print_question(const question &q, const sgt_ray &r)
{
    if (q.s.ops == &sgt_conic_ops) std::printf("    conic"), print_list(q.s.self, 3), std::printf("\n");
    else if (q.s.ops == &sgt_julia_ops)
        std::printf("    julia"), print_list(q.s.self, 21),
            std::printf(" N %d p %d\n", static_cast<const sgt_julia *>(q.s.self)->iterations,
                        static_cast<const sgt_julia *>(q.s.self)->power);
    else if (q.s.ops == &sgt_mandelbrot_ops)
        std::printf("    mandelbrot"), print_list(q.s.self, 17),
            std::printf(" N %d p %d\n", static_cast<const sgt_mandelbrot *>(q.s.self)->iterations,
                        static_cast<const sgt_mandelbrot *>(q.s.self)->power);
    else print_surface(q.s);
    std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z,
                r.tmin, r.tmax);
}

void print_hit(const char *what, const sgt_hit &h)
{
    std::printf("    %-12s %s, t %a +- %g, [%a, %a], evals %d\n", what, sgt_status_text(h.status), h.t,
                h.t_err, h.lo, h.hi, h.evals);
}

bool fail(const std::string &what, const question &q, const sgt_ray &r)
{
    const std::string key = q.type + ": " + what;
    if (failed[key]++ >= 2) return false;
    std::printf("FAIL %s%s\n", key.c_str(), name_of_case.c_str());
    print_question(q, r);
    return true;
}

sgt_ray with_ends(sgt_ray r)
{
    if (r.tmax == 0 && r.tmin == 0) r.tmax = HUGE_VAL;
    return r;
}

question conic_question(generator &g, const std::string &type)
{
    for (;;) {
        oracle::test_case t = g.chance(0.6) ? oracle::random_case(g) : oracle::random_narrow_case(g);
        if (t.asphere != (type == "even_asphere")) continue;
        if (type == "plane") t.surface.c = 0;
        if (type == "plane" || type == "sphere") t.surface.k = 0;
        question q = {type, {}, with_ends(t.ray), {}, true};
        std::shared_ptr<sgt_even_asphere> p =
            std::make_shared<sgt_even_asphere>(t.surface); // a conic is its beginning
        q.kept.push_back(p);
        q.s = {t.asphere ? &sgt_even_asphere_ops : &sgt_conic_ops, p.get()};
        return q;
    }
}

question level_question(generator &g, const std::string &type)
{
    question q = {type, {}, {}, {}, true};
    const int N = 1 + g.below(7), power = g.chance(0.8) ? 2 : 3;
    if (type == "julia") {
        sgt_julia j = {};
        for (double &x : j.c) x = g.chance(0.2) ? 0 : g.uniform(-0.7, 0.5);
        j.iterations = N, j.power = power;
        std::shared_ptr<sgt_julia> p = std::make_shared<sgt_julia>(j);
        q.kept.push_back(p), q.s = {&sgt_julia_ops, p.get()};
    } else {
        sgt_mandelbrot m = {};
        m.iterations = N, m.power = power;
        std::shared_ptr<sgt_mandelbrot> p = std::make_shared<sgt_mandelbrot>(m);
        q.kept.push_back(p), q.s = {&sgt_mandelbrot_ops, p.get()};
    }
    const sgt_vec3 at = random_direction(g), from = random_direction(g);
    const double near = g.uniform(0, 1), far = g.chance(0.8) ? g.uniform(0.2, 4) : g.log_uniform(4, 1e6);
    q.ray = {{far * from.x, far * from.y, far * from.z},
             {near * at.x - far * from.x, near * at.y - far * from.y, near * at.z - far * from.z},
             0,
             HUGE_VAL};
    if (g.chance(0.3)) q.ray.tmin = -HUGE_VAL;
    if (g.chance(0.2)) q.ray.tmax = g.uniform(0.5, 2);
    return q;
}

question catalogue_question(generator &g, const std::string &type)
{
    const specimen s = random_specimen(g, type);
    const subject of(s);
    return {type, s.s, with_ends(random_ray(g, of, static_cast<ray_kind>(g.below(ray_kinds)))), s.kept, true};
}

// A surface of the catalogue as a user's: what it offers, without what is the library's own.
enum offer { by_value, by_span, by_first, by_enclosure, offers };
const char *const offer_names[offers] = {"user, value", "user, span", "user, first", "user, enclose"};

question user_question(generator &g, offer what)
{
    static const char *const bodies[] = {"torus", "quadric", "ellipsoid"};
    static const char *const all[] = {"torus", "quadric", "ellipsoid", "zernike", "toroidal", "odd_asphere"};
    question q = catalogue_question(g, what == by_first       ? bodies[g.below(3)]
                                       : what == by_enclosure ? all[g.below(6)]
                                                              : bodies[g.below(3)]);
    const sgt_surface_ops &from = *q.s.ops;
    std::shared_ptr<sgt_surface_ops> ops = std::make_shared<sgt_surface_ops>();
    ops->name = from.name, ops->value = from.value, ops->values = from.values, ops->rounding = from.rounding;
    if (what != by_value) ops->span = from.span, ops->spans = from.spans;
    if (what == by_first) ops->first = from.first, ops->firsts = from.firsts, ops->enclose = from.enclose;
    if (what == by_enclosure) ops->enclose = from.enclose;
    q.kept.push_back(ops);
    q.s.ops = ops.get();
    q.type = offer_names[what];
    q.certain = ops->enclose != nullptr;
    const double length = std::sqrt(q.ray.d.x * q.ray.d.x + q.ray.d.y * q.ray.d.y + q.ray.d.z * q.ray.d.z);
    const double near = -(q.ray.o.x * q.ray.d.x + q.ray.o.y * q.ray.d.y + q.ray.o.z * q.ray.d.z) /
                        (length * length); // two ends, as cells have them
    q.ray.tmin = std::max(q.ray.tmin, near - 1e4 / length),
    q.ray.tmax = std::min(q.ray.tmax, near + 1e4 / length);
    if (!(q.ray.tmin <= q.ray.tmax)) q.ray.tmin = near - 1e4 / length, q.ray.tmax = near + 1e4 / length;
    return q;
}

// -------------------------------------------------------------------- answers

enum { most = 64 };
struct list {
    int count;
    std::vector<sgt_hit> hits;
};

list all_of(const question &q, const sgt_ray &ray, sgt_proof proof)
{
    list l = {0, std::vector<sgt_hit>(most)};
    sgt_options o = {};
    o.proof = proof;
    sgt_ray r = ray;
    if (r.tmin == 0 && r.tmax == 0) r.tmin = -0x1p-1074; // tmax = 0 stands for infinity
    l.count = sgt_intersect_all(q.s, r, most, l.hits.data(), &o);
    l.hits.resize(static_cast<std::size_t>(std::max(0, std::min(l.count, int(most)))));
    return l;
}

sgt_hit first_of(const question &q, const sgt_ray &ray, sgt_proof proof, sgt_pick pick)
{
    sgt_options o = {};
    o.proof = proof, o.pick = pick;
    sgt_ray r = ray;
    if (r.tmin == 0 && r.tmax == 0) r.tmin = -0x1p-1074;
    return sgt_intersect(q.s, r, &o);
}

bool meet(const sgt_hit &a, const sgt_hit &b) { return a.lo <= b.hi && b.lo <= a.hi; }

// A hit, or something undecided, where [lo, hi] is.
bool is_told(const list &l, double lo, double hi)
{
    for (const sgt_hit &h : l.hits)
        if (h.lo <= hi && lo <= h.hi) return true;
    return l.count > most;
}

// What sgt_ray's rule of the start can hide about a root, and 16 t_err: another search may tell that much
// worse.
double hidden_at(const sgt_hit &h, const sgt_ray &r)
{
    const double terms = std::fabs(h.p.x * h.n.x) + std::fabs(h.p.y * h.n.y) + std::fabs(h.p.z * h.n.z),
                 slope = std::fabs(h.n.x * r.d.x + h.n.y * r.d.y + h.n.z * r.d.z);
    const double width = 0x1p-47 * terms / slope;
    return 16 * h.t_err + (width < HUGE_VAL ? width : HUGE_VAL) + 0x1p-48 * std::fabs(h.t);
}

// --------------------------------------------------------------------- checks

void ask_first(const question &q, const sgt_ray &ray, sgt_proof proof, const list &all)
{
    static const char *const proofs[] = {"no proof", "proof root", "proof first"};
    const sgt_hit h = first_of(q, ray, proof, SGT_FIRST);
    counted["first"]++;
    bool same = all.count == 0 ? h.status == SGT_MISS
                               : h.status == all.hits[0].status || (h.status < 0 && all.hits[0].status < 0);
    if (same && h.status > 0)
        same = std::fabs(h.t - all.hits[0].t) <= h.t_err + all.hits[0].t_err + 4 * oracle::ulp(h.t) ||
               (h.status == SGT_GRAZE && meet(h, all.hits[0]));
    if (!same &&
        h.status >
            0) // a root is proven, not that none is before it; or all of them are more than can be told
        for (const sgt_hit &e : all.hits) {
            same = (proof == SGT_PROVE_ROOT ? e.status == h.status : e.status < 0) && meet(h, e);
            if (same || e.status > 0) break;
        }
    // the march through the wings spends evaluations that `all` does not, and shows misses that `all` has
    // not the evaluations for (a polynomial along the ray under proof, too); so do the heights of a surface
    // without an end, where enclosures leave what is far out
    const bool exhausted = h.status == SGT_EXHAUSTED || (h.status == SGT_MISS && all.hits[0].status < 0);
    if (!same && exhausted && (proof == SGT_ESTIMATE || h.status == SGT_MISS) &&
        ++counted["first exhausted"] <= counted["first"] / 1000 + 1)
        return;
    if (same) return;
    if (!fail(std::string("first is not the first of all, ") + proofs[proof], q, ray)) return;
    print_hit("first", h);
    for (const sgt_hit &e : all.hits) print_hit("of all", e);
}

// The root near the seed, proven to be the only one, is not one of two; a stretch about all of them has each.
void ask_only(const question &q, const sgt_ray &ray, const list &all)
{
    if (q.s.ops == &sgt_julia_ops || q.s.ops == &sgt_mandelbrot_ops) return; // their root is the first
    const sgt_hit h = first_of(q, ray, SGT_PROVE_FIRST, SGT_NEAR_SEED);
    counted[h.status == SGT_HIT ? "only" : h.status == SGT_UNPROVEN ? "only, or not" : "only: none"]++;
    bool fine = true;
    for (const sgt_hit &e : all.hits)
        if (e.status == SGT_HIT) fine = fine && h.status != SGT_MISS && !(e.hi < h.lo || e.lo > h.hi);
    if (fine || !fail("there are others than the only root", q, ray)) return;
    print_hit("near the seed", h);
    for (const sgt_hit &e : all.hits) print_hit("of all", e);
}

// A hit of one is told by the other, too.
void ask_alike(const char *what, const question &q, const sgt_ray &ray, const list &a, const list &b)
{
    counted[what]++;
    for (int twice = 0; twice < 2; twice++) {
        const list &one = twice ? b : a, &other = twice ? a : b;
        for (const sgt_hit &h : one.hits) {
            if (h.status != SGT_HIT || is_told(other, h.lo, h.hi)) continue;
            if (!fail(what, q, ray)) return;
            print_hit(twice ? "second" : "first", h);
            for (const sgt_hit &e : other.hits) print_hit("the other", e);
            return;
        }
    }
}

void ask_ends(generator &g, const question &q, const sgt_ray &ray, const list &whole, sgt_proof proof)
{
    if (whole.hits.empty()) return;
    const sgt_hit &h = whole.hits[static_cast<std::size_t>(g.below(static_cast<int>(whole.hits.size())))];
    if (h.status != SGT_HIT || !std::isfinite(h.t)) return;
    const bool far = g.chance(0.5);
    double at[6];
    list l[6];
    bool there[6];
    at[0] = h.t;
    const int k = g.below(3);
    for (int i = 0; i < 2 * k; i++) at[0] = std::nextafter(at[0], -HUGE_VAL);
    if (g.chance(0.3)) at[0] = h.t - 3 * h.t_err;
    for (int i = 1; i < 6; i++)
        at[i] = g.chance(0.7) ? std::nextafter(at[i - 1], HUGE_VAL)
                              : std::max(std::nextafter(at[i - 1], HUGE_VAL), at[i - 1] + h.t_err);
    for (int i = 0; i < 6; i++) {
        sgt_ray r = ray;
        (far ? r.tmax : r.tmin) = at[i];
        if (!(r.tmin <= r.tmax)) return;
        l[i] = all_of(q, r, proof);
        ask_first(q, r, proof, l[i]);
        there[i] = false;
        for (const sgt_hit &e : l[i].hits)
            there[i] = there[i] || (e.status == SGT_HIT &&
                                    std::fabs(e.t - h.t) <= e.t_err + h.t_err + 2 * oracle::ulp(h.t));
    }
    counted["ends"]++;
    for (int i = 0; i + 1 < 6; i++) {
        const int less = far ? i : i + 1, more = far ? i + 1 : i;
        if (!there[less] || there[more] || is_told(l[more], h.lo, h.hi)) continue;
        if (far && at[more] <= h.t + h.t_err + oracle::ulp(h.t)) continue;
        if (!far && at[more] + hidden_at(h, ray) >= h.t) continue;
        if (!fail(far ? "a greater tmax loses a root" : "a lesser tmin loses a root", q, ray)) return;
        print_hit("the root", h);
        std::printf("    ends %a with it, %a without\n", at[less], at[more]);
        return;
    }
}

void ask_reverse(const question &q, const sgt_ray &ray, const list &whole, sgt_proof proof)
{
    const sgt_ray back = {ray.o, {-ray.d.x, -ray.d.y, -ray.d.z}, -ray.tmax, -ray.tmin};
    list l = all_of(q, back, proof);
    for (sgt_hit &h : l.hits) {
        const double lo = h.lo;
        h.t = -h.t, h.lo = -h.hi, h.hi = -lo;
    }
    counted["reverse"]++;
    for (int twice = 0; twice < 2; twice++) {
        const list &one = twice ? l : whole, &other = twice ? whole : l;
        for (const sgt_hit &h : one.hits) {
            if (h.status != SGT_HIT || is_told(other, h.lo, h.hi)) continue;
            const double room = hidden_at(h, ray); // an end of one is the start of the other
            if (!(h.t - ray.tmin > room && ray.tmax - h.t > room)) continue;
            if (!fail(twice ? "a root of the reversed ray is not one of the ray"
                            : "a root of the ray is not one of the reversed ray",
                      q, ray))
                return;
            print_hit("the root", h);
            for (const sgt_hit &e : other.hits) print_hit("the other", e);
            return;
        }
    }
}

void ask_split(generator &g, const question &q, const sgt_ray &ray, const list &whole, sgt_proof proof)
{
    double cut, lo = std::max(ray.tmin, -1e3), hi = std::min(ray.tmax, 1e3);
    if (!whole.hits.empty() && g.chance(0.8)) {
        const sgt_hit &h = whole.hits[static_cast<std::size_t>(g.below(static_cast<int>(whole.hits.size())))];
        cut = h.t;
        if (g.chance(0.3)) cut += g.sign() * g.log_uniform(0.1, 100) * h.t_err;
        else if (g.chance(0.5)) cut += g.uniform(-2, 2) * std::max(std::fabs(h.t), 1.0);
        for (int n = g.below(4); n > 0; n--) cut = std::nextafter(cut, g.chance(0.5) ? HUGE_VAL : -HUGE_VAL);
    } else cut = g.uniform(lo, hi);
    if (!(cut >= ray.tmin && cut <= ray.tmax && std::isfinite(cut))) return;
    sgt_ray near = ray, far = ray;
    near.tmax = far.tmin = cut;
    const list a = all_of(q, near, proof), b = all_of(q, far, proof);
    ask_first(q, near, proof, a);
    ask_first(q, far, proof, b);
    counted["split"]++;
    for (const sgt_hit &h : whole.hits) {
        if (h.status != SGT_HIT) continue;
        const double room = hidden_at(h, ray);
        const bool in_a = is_told(a, h.lo, h.hi), in_b = is_told(b, h.lo, h.hi);
        const bool before = h.t + room < cut && h.t - ray.tmin > room && !in_a,
                   behind = h.t - room > cut && ray.tmax - h.t > room && !in_b;
        if ((before || behind) &&
            fail(before ? "a root before the cut is lost" : "a root behind the cut is lost", q, ray))
            print_hit("the root", h), std::printf("    cut at %a\n", cut);
    }
    for (const list *part : {&a, &b})
        for (const sgt_hit &h : part->hits) {
            const double room = hidden_at(h, ray);
            if (h.status != SGT_HIT || is_told(whole, h.lo, h.hi) || !(h.t - ray.tmin > room)) continue;
            if (fail("a root of a half is none of the whole", q, ray))
                print_hit("the root", h), std::printf("    cut at %a\n", cut);
        }
    for (const sgt_hit &h : a.hits) // the root at the cut twice?
        for (const sgt_hit &e : b.hits)
            if (h.status == SGT_HIT && e.status == SGT_HIT && h.t == e.t && h.t_err == e.t_err &&
                fail("one root in both halves", q, ray))
                print_hit("before", h), print_hit("behind", e);
}

// What is told of the first root, of the one near the seed, and of all.
struct answers {
    sgt_hit first, near;
    list all;
};

answers answers_of(const question &q, const sgt_ray &ray, sgt_proof proof)
{
    return {first_of(q, ray, proof, SGT_FIRST), first_of(q, ray, proof, SGT_NEAR_SEED),
            all_of(q, ray, proof)};
}

void ask_nothing(generator &g, const question &q, sgt_proof proof)
{
    static const double nothings[] = {1e-160, 1e-200, 0x1p-1000, 1e-310, 0x1p-1074};
    const double unit = 1 / std::sqrt(q.ray.d.x * q.ray.d.x + q.ray.d.y * q.ray.d.y + q.ray.d.z * q.ray.d.z);
    sgt_ray zero = q.ray;
    const int axis = g.below(3); // of a direction one component stays, so that it is one
    double *const d[] = {&zero.d.x, &zero.d.y, &zero.d.z}, *const o[] = {&zero.o.x, &zero.o.y, &zero.o.z};
    for (int i = 0; i < 3; i++) {
        *d[i] *= unit;
        if (i != axis && g.chance(0.7)) *d[i] = 0;
        if (g.chance(0.4)) *o[i] = 0;
    }
    if (zero.tmin > -HUGE_VAL) zero.tmin /= unit;
    if (zero.tmax < HUGE_VAL) zero.tmax /= unit;
    if (!(*d[axis] != 0)) *d[axis] = 1;
    zero.tmin = std::max(zero.tmin, -1e9),
    zero.tmax = std::min(zero.tmax, 1e9); // where it makes no difference
    if (!(zero.tmin < zero.tmax)) return;
    const sgt_vec3 start = {zero.o.x + zero.tmin * zero.d.x, zero.o.y + zero.tmin * zero.d.y,
                            zero.o.z + zero.tmin * zero.d.z};
    if (!(std::fabs(q.s.ops->value(q.s.self, start, nullptr)) > 1e-30)) return; // next to the start it does
    sgt_ray other = zero;
    for (double *x : {&other.o.x, &other.o.y, &other.o.z, &other.d.x, &other.d.y, &other.d.z})
        if (*x == 0 && g.chance(0.7)) *x = g.sign() * nothings[g.below(5)];
    const answers a = answers_of(q, zero, proof), b = answers_of(q, other, proof);
    counted["nothing"]++;
    const auto about_zero = [](const sgt_hit &h) {
        return std::fabs(h.t) <= 1e-60 + h.t_err;
    }; // there it is not
    const char *why = about_zero(a.first) || about_zero(b.first) ? nullptr
                                                                 : first_contradiction(a.first, b.first);
    for (int twice = 0; !why && proof != SGT_PROVE_ROOT && twice < 2; twice++) {
        std::vector<sgt_hit> of = (twice ? b : a).all.hits;
        of.erase(std::remove_if(of.begin(), of.end(), about_zero), of.end());
        why = hits_missing(of, (twice ? a : b).all.hits);
    }
    if (!why && (a.near.status == SGT_MISS || b.near.status == SGT_MISS))
        why = first_contradiction(a.near, b.near);
    if (!why || !fail(std::string("a number that is as good as 0: ") + why, q, zero)) return;
    std::printf("    and {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", other.o.x, other.o.y, other.o.z, other.d.x,
                other.d.y, other.d.z, other.tmin, other.tmax);
    for (const answers *of : {&a, &b}) {
        print_hit("first", of->first), print_hit("near the seed", of->near);
        for (const sgt_hit &h : of->all.hits) print_hit("of all", h);
    }
}

void ask_tolerance(generator &g, const question &q, const list &whole)
{
    if (whole.hits.empty()) return;
    const sgt_hit &h = whole.hits[static_cast<std::size_t>(g.below(static_cast<int>(whole.hits.size())))];
    if (h.status != SGT_HIT || !std::isfinite(h.t)) return;
    const double length = std::max(std::fabs(h.t), 64 * h.t_err), before = hidden_at(h, q.ray),
                 beside = g.log_uniform(1e-12, 1) * length;
    sgt_ray r = q.ray;
    if (g.chance(0.5)) r.tmin = -HUGE_VAL;
    if (g.chance(0.8)) r.tmax = std::min(r.tmax, h.t + 32 * h.t_err + beside);
    sgt_options o = {};
    o.t_tol = g.log_uniform(1e-3, 1e9) * beside;
    if (!(h.t - r.tmin > before + 2 * o.t_tol && r.tmax - h.t > 16 * h.t_err))
        return; // t_err is a part of what the start hides
    o.proof = static_cast<sgt_proof>(g.below(3));
    if (r.tmin == 0 && r.tmax == 0) return;
    counted["tolerance"]++;
    for (sgt_pick pick : {SGT_FIRST, SGT_NEAR_SEED}) {
        o.pick = pick;
        const sgt_hit other = sgt_intersect(q.s, r, &o);
        if (other.status != SGT_MISS || !fail("a tolerance that loses the root", q, r)) continue;
        std::printf("    t_tol %a, proof %d, pick %d\n", o.t_tol, int(o.proof), int(pick));
        print_hit("without", h), print_hit("with it", other);
    }
}

void ask(generator &g, const question &q)
{
    list of_proof[3];
    for (int p = SGT_ESTIMATE; p <= SGT_PROVE_FIRST; p++) {
        const sgt_proof proof = static_cast<sgt_proof>(p);
        of_proof[p] = all_of(q, q.ray, proof);
        counted[of_proof[p].count == 0 ? "misses" : "with entries"]++;
        ask_first(q, q.ray, proof, of_proof[p]);
    }
    ask_alike("no proof and proof root", q, q.ray, of_proof[0], of_proof[1]);
    ask_alike("no proof and proof first", q, q.ray, of_proof[0], of_proof[2]);
    ask_alike("proof root and proof first", q, q.ray, of_proof[1], of_proof[2]);
    ask_only(q, q.ray, of_proof[2]);
    if (!q.certain) return;
    ask_tolerance(g, q, of_proof[0]);
    if (q.type != offer_names[by_enclosure]) // its rim is in its span alone, which may be longer
        ask_nothing(g, q, static_cast<sgt_proof>(g.below(3)));
    const sgt_proof any = static_cast<sgt_proof>(g.chance(0.6) ? 0 : 1 + g.below(2));
    ask_ends(g, q, q.ray, of_proof[any], any);
    ask_reverse(q, q.ray, of_proof[any], any);
    ask_split(g, q, q.ray, of_proof[any], any);
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run r(argc, argv, 120, 20260401);
    const char *only = std::getenv("SAGITTA_TEST_TYPE");
    std::vector<std::string> names(themselves, themselves + 6);
    names.insert(names.end(), types.begin(), types.end());
    names.insert(names.end(), offer_names, offer_names + offers);
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        if (std::find(names.begin(), names.end(), b->type) == names.end())
            failed[std::string(b->type) + ": a row that is not asked"]++;
    for (std::size_t k = 0; k < names.size(); k++) {
        if (only && names[k] != only) continue;
        const std::string &type = names[k];
        for (long i = 0; i < r.count; i++) {
            generator g(r.seed ^ static_cast<std::uint64_t>(k) << 40 ^ static_cast<std::uint64_t>(i) << 20);
            name_of_case = ", case " + std::to_string(i);
            const std::size_t user = names.size() - offers;
            ask(g, k >= user ? user_question(g, static_cast<offer>(k - user))
                   : k < 4   ? conic_question(g, type)
                   : k < 6   ? level_question(g, type)
                             : catalogue_question(g, type));
        }
    }
    for (const auto &c : counted) std::printf("%-28s %9ld\n", c.first.c_str(), c.second);
    for (const auto &f : failed) std::printf("FAIL %6ld  %s\n", f.second, f.first.c_str());
    return !failed.empty();
}
