// SPDX-License-Identifier: MIT
// Roots exactly on an edge of what counts, and 1 ... 20 steps beside: the rim, the start, the end of the
// ray, the clear aperture of an element; of every surface of surfaces.h but the level sets.
//
// The roots, and so their r^2 and their distance from the ends, are those of judge.h, in 113 bits, of the
// surface without its rim, its samples crowded about the points that the ray is laid through.  An edge is
// where surfaces.h and sgt_ray in sagitta.h put it.  Neither side is wrong within
//   the rim      what p_err and 4 u make of r^2;
//   the start    t_err, from the rule's own width to three times that (a t_err before the last bits are
//                polished is about as much);
//   the end      t_err, and as much; what is told has a t of at most tmax;
// t_err and p_err as the library tells them of that root on the whole line.  Where a proof is asked for, a
// root within u of the rim is not to be told as one that counts, nor as one that does not; without a proof
// nothing is undecided.  A clear aperture is asked of a trace, the element's surface without a rim, now and
// then with few evaluations: what was not searched is not told as clipped.  Each ray is asked for its first
// root, for the one near the seed, under each proof, for all of them, and in a batch; and `first` of its
// surface, if it has one, keeps what `single` promises.
//
// Asked again: a hit of any ray, with tmax = its t, with tmin = its t, and with tmax a few t_err behind it.
// A root at tmax is accepted if its computed t is at most tmax (sgt_ray).  The search counts from another
// point if the ray has another end, so the t computed anew may be rounded to the other side of tmax, and the
// root is lost.  That is seldom: of conics 0.7 % were lost, of other sags 2 to 5, of a torus 6, of quadrics
// and ellipsoids, whose t is rounded by more, 12 to 15; `most_lost` is above that by half.  With tmin = t the
// root is not told again.  With tmax behind the root nothing is lost.  A batch of all these, whose rays have
// unlike ends, tells what each tells alone.
#include "../ends.h"
#include "judge.h"

#include <sagitta/system.h>

using namespace catalogue;

namespace {

std::map<std::string, long> failed;
struct tally {
    long asked, hit, miss, undecided, unasked, narrowed;
} told;

const std::vector<const char *> edge_types = types_of({"conic", "even_asphere"}, true, true);

void set_rim(specimen *s, double rim)
{
    if (s->sag) *rim_of(*s) = s->rim = rim;
}

specimen make(generator &g, const std::string &type)
{
    if (type != "conic" && type != "even_asphere") return random_specimen(g, type);
    specimen s = {};
    s.type = type, s.sag = true, s.h = g.log_uniform(1e-2, 1e2), s.rim = s.h;
    double c, k;
    random_base(g, s.h, &c, &k);
    s.s = type == "conic" ? sgt_surface{&sgt_conic_ops, s.keep(sgt_conic{c, k, s.rim})}
                          : random_departure(g, &s, type, s.h, s.h * g.log_uniform(1e-6, 0.1), false);
    double *p = first_number(s.s);
    p[0] = c, p[1] = k, p[2] = s.rim;
    return s;
}

// A root, and what the library knows of it on the whole line.
struct known {
    root r;
    double t_err, p_err;
    quad over; // r^2 beyond the rim
    counts state;
    bool hidden; // nobody with doubles can tell on which side of the rim it is
};

struct scene {
    const subject *of;
    sgt_ray ray;
    std::vector<known> roots;
    const char *what;
    double step;
};

void fail(const char *why, const scene &c, const sgt_options &o, int n, const sgt_hit *h)
{
    const std::string &type = c.of->s.type;
    if (failed[type + ", " + c.what + ": " + why]++ >= 1) return;
    std::printf("FAIL %s, %s (%g): %s, pick %d, proof %d\n", type.c_str(), c.what, c.step, why, o.pick,
                o.proof);
    print_surface(c.of->s.s);
    if (type == "conic") print_list(c.of->s.s.self, 3), std::printf("\n");
    const sgt_ray &r = c.ray;
    std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z,
                r.tmin, r.tmax);
    for (int i = 0; i < n; i++)
        std::printf("    %s t %.17g t_err %.3g [%.17g, %.17g] p %a %a %a +- %.3g\n",
                    sgt_status_text(h[i].status), h[i].t, h[i].t_err, h[i].lo, h[i].hi, h[i].p.x, h[i].p.y,
                    h[i].p.z, h[i].p_err);
    for (const known &k : c.roots)
        std::printf("    root %s, start %.3g, t_err %.3g, beyond the rim %.3g of r^2: %s\n",
                    oracle::text(k.r.t).c_str(),
                    plain(quad(0x1p-48) * k.r.spread / oracle::magnitude(k.r.slope)), k.t_err,
                    plain(k.over / (k.r.p.x * k.r.p.x + k.r.p.y * k.r.p.y)),
                    k.state == oracle::yes  ? "counts"
                    : k.state == oracle::no ? "does not count"
                                            : "may count");
    std::fflush(stdout);
}

// What counts, by the rules.
counts state_of(const known &k, double tmin, double tmax)
{
    const quad start = quad(0x1p-48) * k.r.spread / oracle::magnitude(k.r.slope), t_err = k.t_err,
               ulps = quad(0x1p-50) * oracle::magnitude(k.r.t);
    counts result = oracle::yes;
    if (tmin > -HUGE_VAL) {
        const quad beyond = k.r.t - tmin;
        if (beyond <= 0 || beyond <= start * (1 - quad(1e-3)) - t_err) return oracle::no;
        if (!(beyond > 3 * start + 8 * t_err + 4 * ulps)) result = oracle::perhaps;
    }
    if (tmax < HUGE_VAL) {
        const quad left = tmax - k.r.t;
        if (left < -start - 2 * t_err) return oracle::no;
        if (left <= start + 2 * t_err) result = oracle::perhaps;
    }
    return result;
}

bool is_of(const known &k, const sgt_hit &h)
{
    return oracle::magnitude(k.r.t - h.t) <=
           quad(h.t_err) * (1 + quad(1e-6)) + quad(0x1p-90) * oracle::magnitude(k.r.t) +
               quad(0x1p-106) * oracle::norm(k.r.p) * oracle::norm(k.r.n) / oracle::magnitude(k.r.slope);
}

// It is behind tmax by no more than that search knows it, which another may know better: t at most tmax is
// what counts.
bool at_end(const known &k, const scene &c, const sgt_hit &h)
{
    const quad behind = k.r.t - c.ray.tmax;
    // (t is known as well as the coordinates of the point are)
    const sgt_vec3 d = c.ray.d;
    const double far = std::fabs(h.t) + std::hypot(h.p.x, h.p.y, h.p.z) / std::hypot(d.x, d.y, d.z);
    return behind > 0 && behind <= h.t_err && h.t <= c.ray.tmax && h.t_err <= 0x1p-46 * far;
}

bool same(double a, double b) { return !std::memcmp(&a, &b, sizeof a) || (a != a && b != b); }

void judge(const scene &c, const sgt_hit &h, const sgt_options &o, bool sharp)
{
    told.asked++, told.hit += h.status > 0, told.miss += h.status == SGT_MISS, told.undecided += h.status < 0;
    if (h.status == SGT_INVALID || h.status == SGT_STOPPED) return fail("invalid", c, o, 1, &h);
    if (h.status > 0 && !(h.t <= c.ray.tmax && h.t >= c.ray.tmin))
        return fail("t is outside the ray's ends", c, o, 1, &h);
    bool itself = h.status != SGT_HIT, excused = false;
    for (const known &k : c.roots) {
        if (h.status > 0 && is_of(k, h)) {
            itself = true;
            if (k.state == oracle::no && !at_end(k, c, h))
                return fail("a root that does not count", c, o, 1, &h);
            if (k.hidden && o.proof)
                return fail("proven, though rounding hides its side of the rim", c, o, 1, &h);
        }
        if (h.status == SGT_MISS && k.hidden && o.proof && k.state == oracle::perhaps)
            return fail("a proven miss, though rounding hides its side of the rim", c, o, 1, &h);
        excused = excused || k.hidden || k.state == oracle::perhaps;
        if (k.state != oracle::yes) continue;
        if (h.status == SGT_MISS) return fail("a miss that meets", c, o, 1, &h);
        if (o.pick == SGT_FIRST && h.status > 0 && k.r.t < quad(h.t) - h.t_err && !is_of(k, h))
            return fail("not the first", c, o, 1, &h);
        if (o.pick == SGT_FIRST && h.status < 0 && k.r.t < quad(h.lo) - 64 * quad(oracle::ulp(h.lo)))
            return fail("undecided, and a root before", c, o, 1, &h);
        if (o.pick == SGT_NEAR_SEED && o.proof == SGT_PROVE_FIRST && h.status == SGT_HIT && !is_of(k, h))
            return fail("the only one, and another", c, o, 1, &h);
    }
    if (sharp && !itself) return fail("a hit without a root", c, o, 1, &h);
    if (h.status < 0 && !o.proof && sharp && c.of->s.sag && c.of->s.rim > 0 && !excused)
        return fail("undecided without a proof", c, o, 1, &h);
}

// What `first` promises by `single`: one root at most in its stretch, and if that does not count none does.
void ask_first(const scene &c)
{
    const sgt_surface &s = c.of->s.s;
    if (!s.ops->first) return;
    const sgt_span f = s.ops->first(s.self, &c.ray);
    if (!f.single) return;
    told.narrowed++;
    const known *in = nullptr, *first = nullptr;
    bool perhaps = false;
    for (const known &k : c.roots) {
        perhaps = perhaps || k.state == oracle::perhaps;
        if (k.state == oracle::yes && (!first || k.r.t < first->r.t)) first = &k;
        if (!(k.r.t >= f.lo && k.r.t <= f.hi)) continue;
        if (in) fail("first: two roots in a stretch that is single", c, {}, 0, nullptr);
        in = &k;
    }
    if (first && !in) fail("first: the root that counts is not in the stretch", c, {}, 0, nullptr);
    if (first && in && in != first && !perhaps) fail("first: not the first that counts", c, {}, 0, nullptr);
}

// sharp: all roots are known.
void ask(const scene &c, bool sharp)
{
    const sgt_surface &s = c.of->s.s;
    if (sharp || (c.of->s.type == "quadric" && c.roots.size() == 2)) ask_first(c);
    for (int proof = 0; proof < 3; proof++)
        for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
            sgt_options o = {};
            o.pick = static_cast<sgt_pick>(pick), o.proof = static_cast<sgt_proof>(proof);
            const sgt_hit h = sgt_intersect(s, c.ray, &o);
            judge(c, h, o, sharp);
            sgt_status status;
            double t, t_err;
            sgt_hits out = {};
            out.status = &status, out.t = &t, out.t_err = &t_err;
            const sgt_ray &r = c.ray;
            sgt_intersect_batch(s, 1, {{&r.o.x, &r.o.y, &r.o.z}, {&r.d.x, &r.d.y, &r.d.z}, &r.tmin, &r.tmax},
                                out, &o);
            if (status != h.status || !same(t, h.t) || !same(t_err, h.t_err))
                fail("a batch says something else", c, o, 1, &h);
        }
    for (int proof = 0; proof < 3; proof += 2) {
        enum { most = 40 };
        sgt_hit hit[most];
        sgt_options o = {};
        o.proof = static_cast<sgt_proof>(proof);
        const int n = sgt_intersect_all(s, c.ray, most, hit, &o);
        if (n < 0 || n > most) {
            fail("all: invalid, or too many", c, o, 0, hit);
            continue;
        }
        for (const known &k : c.roots) {
            bool in = k.state == oracle::no;
            for (int i = 0; i < n; i++) {
                const bool it = hit[i].status == SGT_HIT ? is_of(k, hit[i])
                                                         : k.r.t >= hit[i].lo && k.r.t <= hit[i].hi;
                in = in || it;
                if (it && k.state == oracle::no && hit[i].status == SGT_HIT && !at_end(k, c, hit[i]))
                    fail("all: a root that does not count", c, o, n, hit);
                if (it && k.hidden && proof && hit[i].status == SGT_HIT)
                    fail("all: proven, though rounding hides its side of the rim", c, o, n, hit);
            }
            if (!in && (k.state == oracle::yes || (k.hidden && proof && k.state == oracle::perhaps)))
                fail("all: a root in no entry", c, o, n, hit);
        }
    }
}

// The roots of the surface without its rim, as the library tells them on the whole line.  false: not all of
// them are known.  laid: where some may be.
bool learn(specimen &s, const subject &bare, scene *c, const std::vector<double> &laid)
{
    const double rim = s.rim;
    set_rim(&s, 0);
    sgt_ray line = c->ray;
    line.tmin = -HUGE_VAL, line.tmax = HUGE_VAL;
    const judgement j(bare, line, 160, laid);
    enum { most = 40 };
    sgt_hit hit[most];
    const int n = sgt_intersect_all(s.s, line, most, hit, nullptr);
    set_rim(&s, rim);
    if (j.everywhere || !j.doubtful.empty()) return false;
    for (const root &r : j.roots) {
        known k = {r, HUGE_VAL, HUGE_VAL, quad(0), oracle::no, false};
        for (int i = 0; i < n && i < most; i++)
            if (hit[i].status == SGT_HIT && is_of(k, hit[i])) k.t_err = hit[i].t_err, k.p_err = hit[i].p_err;
        if (!(k.t_err < HUGE_VAL)) return false;
        c->roots.push_back(k);
    }
    return true;
}

void decide(scene *c, double rim)
{
    for (known &k : c->roots) {
        k.state = state_of(k, c->ray.tmin, c->ray.tmax), k.hidden = false;
        if (!(rim > 0)) continue;
        const quad x = oracle::magnitude(k.r.p.x), y = oracle::magnitude(k.r.p.y), r2 = x * x + y * y,
                   u = quad(0x1p-53), p_err = 2 * quad(k.p_err);
        const quad hides = (2 * (x + y) + p_err) * p_err + 4 * u * r2;
        k.over = r2 - quad(rim) * rim * (1 + quad(0x1p-44));
        if (k.over > hides) k.state = oracle::no;
        else if (k.over >= -hides && k.state == oracle::yes) k.state = oracle::perhaps;
        k.hidden = oracle::magnitude(k.over) <= u * r2 && k.state != oracle::no;
    }
}

int steps(generator &g) { return g.chance(0.25) ? 0 : static_cast<int>(g.sign()) * (1 + g.below(20)); }

double beside(double x, int n)
{
    for (; n > 0; n--) x = std::nextafter(x, HUGE_VAL);
    for (; n < 0; n++) x = std::nextafter(x, -HUGE_VAL);
    return x;
}

// On the surface at x, y, to rounding.
bool on_surface(const subject &bare, double x, double y, sgt_vec3 *p)
{
    const quad f = bare.exact(quad(x), quad(y), quad(0));
    *p = {x, y, -oracle::to_double(f)};
    return f == f && std::isfinite(p->z);
}

sgt_vec3 tilted(generator &g, bool axial)
{
    const double tilt = axial ? 0 : g.uniform(0, 1.2), about = g.uniform(0, 6.283185307179586),
                 way = g.sign();
    return {std::sin(tilt) * std::cos(about), std::sin(tilt) * std::sin(about), way * std::cos(tilt)};
}

sgt_ray through(sgt_vec3 p, sgt_vec3 d, double away)
{
    return {{p.x - away * d.x, p.y - away * d.y, p.z - away * d.z}, d, -HUGE_VAL, HUGE_VAL};
}

// A point whose r is within some ulps of the soft rim's.
bool at_radius(generator &g, const subject &bare, double radius, int n, sgt_vec3 *p)
{
    const double r = beside(radius * (1 + 0x1p-45), n), about = g.uniform(0, 6.283185307179586);
    double x = r, y = 0;
    if (g.chance(0.5)) x = r * std::cos(about), y = r * std::sin(about); // an ulp or so off, besides
    if (g.chance(0.3)) std::swap(x, y);
    return on_surface(bare, x, y, p);
}

void at_rim(generator &g, specimen &s, const subject &bare, const subject &of)
{
    if (!s.sag) return;
    const int n = steps(g);
    sgt_vec3 p;
    set_rim(&s, s.h * (g.chance(0.3) ? 1 : g.uniform(0.3, 0.9)));
    if (!at_radius(g, bare, s.rim, n, &p)) return;
    const bool axial = g.chance(0.4);
    const double away = s.h * g.uniform(0.5, 3);
    scene c = {&of, through(p, tilted(g, axial), away), {}, "the rim", double(n)};
    if (g.chance(0.3)) c.ray.tmin = 0;
    if (!learn(s, bare, &c, {away})) {
        told.unasked++;
        return;
    }
    decide(&c, s.rim);
    ask(c, true);
}

void at_ends(generator &g, specimen &s, const subject &bare, const subject &of)
{
    set_rim(&s, s.sag && g.chance(0.5) ? s.h : 0);
    sgt_vec3 p = random_point(g, s, of.rough, 0.9);
    if (s.sag && !on_surface(bare, p.x, p.y, &p)) return;
    const sgt_vec3 d = g.chance(0.5) && s.sag ? tilted(g, false) : random_direction(g);
    const double away = g.chance(0.5) ? 0 : g.sign() * s.h * g.log_uniform(1e-6, 3);
    scene c = {&of, through(p, d, away), {}, "", 0};
    if (!learn(s, bare, &c, {away})) {
        told.unasked++;
        return;
    }
    if (c.roots.empty()) return;
    const root &r = c.roots[static_cast<std::size_t>(g.below(static_cast<int>(c.roots.size())))].r;
    const quad start = quad(0x1p-48) * r.spread / oracle::magnitude(r.slope);
    if (!(start < quad(s.h))) return;
    for (int kind = 0; kind < 4; kind++) {
        c.ray.tmin = -HUGE_VAL, c.ray.tmax = HUGE_VAL;
        if (kind < 3) {
            c.what = "the start";
            c.step = kind == 0 ? g.below(21) : kind == 1 ? g.uniform(0, 1.2) : g.uniform(1, 20);
            c.ray.tmin = oracle::to_double(r.t - quad(c.step) * start);
            if (g.chance(0.3)) c.ray.tmax = c.ray.tmin + s.h * g.uniform(0.1, 3);
        } else {
            c.what = "the end";
            c.step = steps(g);
            c.ray.tmax = g.chance(0.5) ? beside(oracle::to_double(r.t), static_cast<int>(c.step))
                                       : oracle::to_double(r.t + quad(c.step) * start);
            if (g.chance(0.5)) c.ray.tmin = c.ray.tmax - s.h * g.uniform(0.1, 3);
            if (c.ray.tmax == 0) c.ray.tmax = -0x1p-1074;
        }
        decide(&c, s.rim);
        ask(c, s.rim > 0 || s.type == "ellipsoid" || s.type == "torus");
    }
}

// --------------------------------------------------------- the clear aperture

// One element, a ray through a point of it on the edge of the clear aperture and one that may be outside of
// it, or `both` are inside: then neither is the only one, though the one on the edge is near the end of the
// ray's chord of the aperture.
void at_aperture(generator &g, specimen &s, const subject &bare, const subject &of, bool both)
{
    if (!s.sag) return;
    set_rim(&s, 0);
    const double a = s.h * g.uniform(0.2, 0.6);
    // On the edge, or within by as much as a flat ray's start may reach (the other root is near, then).
    const bool near = both || g.chance(0.5);
    const int n = near ? -1 : steps(g);
    sgt_vec3 p, q;
    if (!at_radius(g, bare, near ? a * (1 - g.log_uniform(1e-15, 1e-9)) : a, near ? 0 : n, &p)) return;
    const double r = s.h * g.uniform(0.1, 1), about = g.uniform(0, 6.283185307179586),
                 out = 1 + (both ? -1 : 1) * g.log_uniform(1e-3, 0.5), turn = (out - 1) * g.uniform(-1, 1);
    if (!(near ? on_surface(bare, out * p.x - turn * p.y, out * p.y + turn * p.x, &q)
               : on_surface(bare, r * std::cos(about), r * std::sin(about), &q)))
        return;
    sgt_vec3 d = {q.x - p.x, q.y - p.y, q.z - p.z};
    if (g.chance(0.15)) d = tilted(g, g.chance(0.5));
    else if (g.chance(0.7)) d = {-d.x, -d.y, -d.z}; // from the outer one to that on the edge
    const double away = (g.chance(0.5) ? 1 : 0.1) * g.uniform(0, 2) *
                        std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    const double to_q = std::copysign(std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z),
                                      (q.x - p.x) * d.x + (q.y - p.y) * d.y + (q.z - p.z) * d.z);
    sgt_ray unit = {{0, 0, 0}, d, 0, 0};
    sgt_trace(0, nullptr, 1, &unit, nullptr, nullptr,
              nullptr); // of unit length: the trace leaves such a ray as it is
    scene c = {&of, through(p, unit.d, away), {}, "the clear aperture", double(n)};
    const double t_tol = g.chance(0.7) ? 0x1p-1000 : 0; // 0: of a trace, 2^-48 of the aperture
    sgt_element e = {};
    e.surface = s.s, e.index = 1.5, e.semi_diameter = a;
    if (!learn(s, bare, &c, {away, away + to_q})) {
        told.unasked++;
        return;
    }
    const sgt_vec3 made[2] = {p, q};
    for (int i = 0; i < 2; i++) { // two that are near each other the oracle may not see
        bool seen = !both;
        for (const known &k : c.roots)
            seen = seen || oracle::norm({k.r.p.x - made[i].x, k.r.p.y - made[i].y, k.r.p.z - made[i].z}) <
                               quad(1e-6) * s.h;
        if (!seen) {
            told.unasked++;
            return;
        }
    }
    decide(&c, a);
    for (known &k : c.roots) { // `decide` with what the tolerance adds
        const quad r2 = k.r.p.x * k.r.p.x + k.r.p.y * k.r.p.y,
                   p_err = 2 * quad(k.p_err) + (t_tol > 0 ? 0 : quad(0x1p-47) * a);
        const quad hides = (quad(2.9) * square_root(r2) + p_err) * p_err + 4 * quad(0x1p-53) * r2;
        k.state = k.over > hides    ? oracle::no
                  : k.over < -hides ? oracle::yes
                                    : oracle::perhaps,
        k.hidden = false;
    }
    const int short_of = g.chance(0.5) ? 1 + g.below(60)
                                       : 0; // of evaluations: what was not searched is not decided
    for (int proof = 0; proof < 3; proof++)
        for (int pick = SGT_FIRST; pick <= SGT_NEAR_SEED; pick++) {
            sgt_options o = {};
            o.pick = static_cast<sgt_pick>(pick), o.proof = static_cast<sgt_proof>(proof), o.t_tol = t_tol,
            o.max_evals = proof ? short_of : 0;
            sgt_ray ray = c.ray;
            sgt_passage passage;
            sgt_fate fate;
            sgt_trace(1, &e, 1, &ray, &passage, &fate, &o);
            const sgt_hit &h = passage.hit;
            told.asked++, told.hit += fate == SGT_PASSED || fate == SGT_TIR,
                told.miss += fate == SGT_MISSED || fate == SGT_CLIPPED, told.undecided += fate == SGT_LOST;
            long inside = 0, perhaps = 0;
            const known *it = nullptr;
            for (const known &k : c.roots) {
                inside += k.state == oracle::yes, perhaps += k.state == oracle::perhaps;
                if (h.status > 0 && oracle::norm({k.r.p.x - h.p.x, k.r.p.y - h.p.y, k.r.p.z - h.p.z}) <=
                                        2 * (quad(h.p_err) + k.p_err))
                    it = &k;
            }
            const bool passed = fate == SGT_PASSED || fate == SGT_TIR;
            if (fate == SGT_MISSED && !c.roots.empty()) fail("missed, and it is met", c, o, 1, &h);
            if (fate == SGT_CLIPPED && inside > 0) fail("clipped, and a root is inside", c, o, 1, &h);
            if (passed && it && it->state == oracle::no) fail("passed outside", c, o, 1, &h);
            if (passed && inside + perhaps == 0) fail("passed, and no root is inside", c, o, 1, &h);
            if (passed && proof == SGT_PROVE_FIRST && pick == SGT_NEAR_SEED && inside > 1)
                fail("the only one inside, and another", c, o, 1, &h);
            if (passed && it && it->state == oracle::perhaps && inside > 0 && proof == SGT_PROVE_FIRST &&
                pick == SGT_NEAR_SEED)
                fail("the only one inside, and another that certainly is", c, o, 1, &h);
            if (fate == SGT_LOST && !proof && n != 0 && inside + perhaps <= 1 && c.roots.size() == 1 &&
                c.of->s.type == "conic")
                fail("lost without a proof", c, o, 1, &h);
        }
}

// ------------------------------------------------------------------ asked again

struct again {
    const specimen *s;
    const subject *of;
    long hits, lost, behind, behind_undecided;
};

void fail_again(const char *why, const again &a, const sgt_ray &ray, const sgt_options &o, const sgt_hit &was,
                const sgt_hit &h)
{
    if (failed[a.s->type + ", asked again: " + why]++ >= 2) return;
    std::printf("FAIL %s, asked again: %s, pick %d, proof %d\n", a.s->type.c_str(), why, o.pick, o.proof);
    print_surface(a.s->s);
    if (a.s->type == "conic") print_list(a.s->s.self, 3), std::printf("\n");
    std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y,
                ray.d.z, ray.tmin, ray.tmax);
    for (const sgt_hit &x : {was, h})
        std::printf("    %s t %.17g (%a) t_lo %.3g t_err %.3g\n", sgt_status_text(x.status), x.t, x.t, x.t_lo,
                    x.t_err);
}

void ask_again(generator &g, again *a, const sgt_options &o)
{
    enum { rays = 16 };
    const sgt_surface &s = a->s->s;
    std::vector<sgt_ray> asked;
    std::vector<sgt_hit> told_alone;
    const auto ask = [&](const sgt_ray &r) {
        asked.push_back(r), told_alone.push_back(sgt_intersect(s, r, &o));
        return told_alone.back();
    };
    for (int i = 0; i < rays; i++) {
        const ray_kind kind = i % 4 ? ordinary : static_cast<ray_kind>(g.below(ray_kinds));
        const sgt_ray ray = random_ray(g, *a->of, kind);
        const sgt_hit h = ask(ray);
        // a root that is known badly says nothing about the end
        if (h.status != SGT_HIT || h.t == 0 || !(h.t > ray.tmin)) continue;
        if (!(h.t_err <= 1e-12 * std::fabs(h.t))) continue;
        a->hits++;
        sgt_ray end = ray, start = ray, later = ray;
        end.tmax = start.tmin = h.t;
        const sgt_hit at_end = ask(end), at_start = ask(start);
        a->lost += at_end.status <= 0;
        if (at_end.status > 0 && o.pick == SGT_FIRST && at_end.t + at_end.t_err < h.t - h.t_err)
            fail_again("a root before the first", *a, end, o, h, at_end);
        if (at_start.status == SGT_HIT && at_start.t < h.t + 64 * h.t_err) { // is it the same root?
            const judgement j(*a->of, ray, 2);
            root r;
            if (j.polish(quad(at_start.t) + at_start.t_lo, &r) &&
                oracle::magnitude(r.t - at_start.t) <= quad(at_start.t_err) &&
                catalogue::counting(r, start.tmin, start.tmax) == oracle::no)
                fail_again("the root at the start", *a, start, o, h, at_start);
        }
        later.tmax = h.t + (g.log_uniform(4, 1e4) * h.t_err + 0x1p-50 * std::fabs(h.t));
        if (!(later.tmax < ray.tmax)) continue;
        const sgt_hit behind = ask(later);
        a->behind++, a->behind_undecided += behind.status < 0;
        if (behind.status == SGT_MISS) fail_again("a miss, and the end is behind", *a, later, o, h, behind);
        if (behind.status > 0 && o.pick == SGT_FIRST &&
            std::fabs(behind.t - h.t) > behind.t_err + h.t_err)
            fail_again("another first, and the end is behind", *a, later, o, h, behind);
    }
    const std::size_t n = asked.size();
    std::vector<double> in[8], t(n), t_err(n);
    std::vector<sgt_status> status(n);
    for (std::vector<double> &v : in) v.resize(n);
    for (std::size_t i = 0; i < n; i++) {
        const sgt_ray &r = asked[i];
        const double of[] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin, end_of(&r)};
        for (int k = 0; k < 8; k++) in[k][i] = of[k];
    }
    sgt_hits out = {};
    out.status = status.data(), out.t = t.data(), out.t_err = t_err.data();
    const sgt_rays many = {{in[0].data(), in[1].data(), in[2].data()},
                           {in[3].data(), in[4].data(), in[5].data()},
                           in[6].data(),
                           in[7].data()};
    sgt_intersect_batch(s, n, many, out, &o);
    for (std::size_t i = 0; i < n; i++) {
        const sgt_hit &h = told_alone[i];
        sgt_hit b = h;
        b.status = static_cast<sgt_status>(status[i]), b.t = t[i], b.t_err = t_err[i];
        if (h.status != b.status || !same(h.t, b.t) || !same(h.t_err, b.t_err))
            fail_again("a batch of unlike ends says something else", *a, asked[i], o, h, b);
    }
}

long sags_again, sags_lost; // of departures together: few rays of each type tell little

void all_again(const oracle::run &r, const char *type, std::size_t k)
{
    generator g(r.seed ^ static_cast<std::uint64_t>(k) << 40 ^ 2);
    again sum = {nullptr, nullptr, 0, 0, 0, 0};
    for (long done = 0; done < 3 * r.count; done++) {
        specimen s = make(g, type);
        if (g.chance(0.3)) set_rim(&s, 0);
        const subject of(s);
        sum.s = &s, sum.of = &of;
        sgt_options o = {};
        o.proof = static_cast<sgt_proof>(done % 3), o.pick = g.chance(0.3) ? SGT_NEAR_SEED : SGT_FIRST;
        ask_again(g, &sum, o);
    }
    const bool conic = !std::strcmp(type, "conic"), body = row_named(type)->family == SGT_FAMILY_BODY;
    const double most_lost = conic ? 0.015 : body ? 0.22 : 0.08;
    std::printf("%-14s %6ld hits asked again: %ld lost with tmax = t (%.2f %%); %ld with an end behind, "
                "%ld undecided\n", type, sum.hits, sum.lost,
                100 * static_cast<double>(sum.lost) / static_cast<double>(sum.hits), sum.behind,
                sum.behind_undecided);
    const double hits = static_cast<double>(sum.hits);
    if (!conic && !body) sags_again += sum.hits, sags_lost += sum.lost;
    if (hits < 4 * static_cast<double>(r.count)) failed[std::string(type) + ", asked again: no test"]++;
    if (static_cast<double>(sum.lost) > most_lost * hits + 3 * std::sqrt(most_lost * hits) + 2)
        failed[std::string(type) + ", asked again: too many are lost with tmax = t"]++;
    if (static_cast<double>(sum.behind_undecided) > 0.01 * static_cast<double>(sum.behind) + 4)
        failed[std::string(type) + ", asked again: too many are undecided with an end behind"]++;
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run r(argc, argv, 4, 20241118);
    const char *only = std::getenv("SAGITTA_TEST_TYPE");
    for (std::size_t k = 0; k < edge_types.size(); k++) {
        if (only && std::strcmp(only, edge_types[k])) continue;
        generator g(r.seed ^ static_cast<std::uint64_t>(k) << 40),
            apart(r.seed ^ static_cast<std::uint64_t>(k) << 40 ^ 1);
        told = {};
        for (long done = 0; done < r.count; done++) {
            specimen s = make(g, edge_types[k]);
            if (s.type == "torus" && !(first_number(s.s)[1] < first_number(s.s)[0]))
                continue; // a spindle's roots on the axis
            set_rim(&s, 0);
            const subject bare(s), of(s);
            for (int i = 0; i < 4; i++) {
                at_rim(g, s, bare, of);
                at_ends(g, s, bare, of);
                for (int j = 0; j < 3; j++) at_aperture(g, s, bare, of, false);
                at_aperture(apart, s, bare, of, true);
            }
        }
        std::printf("%-14s %6ld answers: %6ld hits, %6ld misses, %6ld undecided; %ld rays not asked; first "
                    "single %ld times\n",
                    edge_types[k], told.asked, told.hit, told.miss, told.undecided, told.unasked,
                    told.narrowed);
        std::fflush(stdout);
        if (told.hit < told.asked / 5 || told.miss < told.asked / 50)
            failed[std::string(edge_types[k]) + ": these rays are no test"]++;
        all_again(r, edge_types[k], k);
    }
    const double again = static_cast<double>(sags_again);
    if (static_cast<double>(sags_lost) > 0.05 * again + 4 * std::sqrt(0.05 * again) + 2)
        failed["sags, asked again: too many are lost with tmax = t"]++;
    for (const auto &f : failed) std::printf("FAIL %6ld  %s\n", f.second, f.first.c_str());
    return !failed.empty();
}
