// SPDX-License-Identifier: MIT
// The proofs against Arb: what a status, t_err, [lo, hi], p_err and n claim, for rays of every kind.
//
// Every root is computed by balls of at least 128 bits (optical.h, level_set.h), which share nothing with
// the library.  Then the same ray is asked for without proof, with PROVE_ROOT and with PROVE_FIRST, the
// first root and the one near the seed, alone, in batches, all of them, and in traces.
//
//     test_proof [--optical N] [--levels N] [--unproven N] [--seed S] [--examples N] [--verbose]
//
// An answer that is undecided, or a graze, has to have a reason that the oracle sees too: another root as
// near as rounding, a tangent, the rim, the equator, the start.  Those without are told, and fail.  With
// one, few may be: at most a part in 1000 of ordinary and far rays, and of each other kind a share that is
// about twice what is seen (most_undecided).  Where another root counts, near the seed nothing but UNPROVEN
// is right.
#include "draw.h"
#include "judge.h"
#include "level_set.h"
#include "quick_sign.h"

#include <sagitta/system.h>

#include <ctime>
#include <cstring>

using namespace proof;

namespace {

bool verbose;
long examples = 1, told;
std::map<std::string, long> failed;

struct tally {
    long rays = 0, hit = 0, graze = 0, miss = 0, another = 0, undecided = 0,
         unexcused = 0; // another: undecided, since another root counts
};
std::map<std::string, tally> tallies;
std::map<std::string, long> excuses;

struct asked {
    sgt_pick pick;
    sgt_proof proof;
    const char *name;
};
const asked questions[] = {
    {SGT_FIRST, SGT_ESTIMATE, "estimate"},
    {SGT_FIRST, SGT_PROVE_ROOT, "root"},
    {SGT_FIRST, SGT_PROVE_FIRST, "first"},
    {SGT_NEAR_SEED, SGT_PROVE_ROOT, "root, near the seed"},
    {SGT_NEAR_SEED, SGT_PROVE_FIRST, "first, near the seed"},
};

void print_subject(const subject &t, const sgt_ray &r)
{
    if (t.is_level) print_level(t.f);
    else {
        std::printf("    %s {%a, %a, %a", t.asphere ? "asphere" : "conic", t.s.c, t.s.k, t.s.semi_diameter);
        if (t.asphere) {
            std::printf(", {");
            for (int i = 0; i < 8; i++) std::printf("%s%a", i ? ", " : "", t.s.a[i]);
            std::printf("}");
        }
        std::printf("}  // k %g h %g\n", t.s.k, t.h);
    }
    std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z,
                r.tmin, r.tmax);
}
void print_hit(const sgt_hit &h)
{
    std::printf("    %s t %.17g t_lo %.3g t_err %.3g lo %.17g hi %.17g evals %d p_err %.3g\n",
                sgt_status_text(h.status), h.t, h.t_lo, h.t_err, h.lo, h.hi, h.evals, h.p_err);
}
void print_roots(const answer &a, const ends &e)
{
    int left = 12;
    for (const meeting &m : a.roots) if (left-- > 0)
            std::printf("    root %s (rounding %.3g) counts %d%s%s spread %.3g rim %.3g equator %.3g\n",
                        text(m.t).c_str(), m.t_err, counting(m, e), m.edge ? " edge" : "",
                        m.twice ? " twice" : "", m.spread.rough(), m.near_rim, m.near_equator);
    for (const stretch &d : a.doubts)
        std::printf("    doubt %s .. %s\n", text(d.lo).c_str(), text(d.hi).c_str());
}

struct oracle_of {
    const subject *t;
    optical *sag = nullptr;
    level_set *set = nullptr;
    sgt_ray ray;
};

const char another_root[] = "another root counts";

// Why an undecided answer may be one; NULL: nothing that the oracle knows.  In traces roots beyond the
// aperture (0: none) do not count, and the ray is not known to `blur`, a length.
const char *excuse(const oracle_of &q, const answer &a, const sgt_hit &h, const asked &by, const ends &e,
                   double aperture = 0, double blur = 0)
{
    if (a.lies) return "the ray lies in the surface";
    if (!a.doubts.empty() || a.gave_up) return "doubted by Arb as well";
    if (h.evals >= 2000) return "max_evals was spent";
    const double length = std::sqrt(q.ray.d.x * q.ray.d.x + q.ray.d.y * q.ray.d.y + q.ray.d.z * q.ray.d.z);
    if (a.beyond || (q.sag && q.sag->near_domain())) return "at the equator";
    int count = 0;
    for (const meeting &m : a.roots) {
        const counts c = counting(m, e);
        if (m.twice) return "a double root";
        count += c != no &&
                 (aperture == 0 || !less(square(ball(aperture)) * (1 + 1e-9), square(m.p.x) + square(m.p.y)));
        if (m.near_rim < HUGE_VAL &&
            m.near_rim < 0x1p-45 + (blur + 0x1p-52 * length * std::fabs(m.t.rough())) / q.t->s.semi_diameter)
            return "at the rim";
        if (m.near_equator < 1e-4) return "at the equator";
        if (q.sag && q.sag->hides_sheet(m))
            return "at the equator as far as the size of the terms lets it be told";
        if (c == perhaps) return "at the start or the end";
    }
    if (by.pick == SGT_NEAR_SEED && by.proof == SGT_PROVE_FIRST && count > 1) return another_root;
    for (std::size_t i = 1; i < a.roots.size(); i++) {
        const ball apart = a.roots[i].t - a.roots[i - 1].t;
        if (less(apart, scaled(start_margin(a.roots[i]) + start_margin(a.roots[i - 1]), 3)))
            return "two roots as near as rounding";
        // t_err is at least what rounding of F makes of t; of so many the slope has to keep its sign, by
        // bounds of a cell
        if (q.set && less(apart, ball(8 * (a.roots[i].t_err + a.roots[i - 1].t_err))))
            return "two roots as near as the rounding of the orbit";
    }
    for (const meeting &m : a.roots) { // t +- t_err is as wide as an ulp of t
        static const char steep[] = "from far away the slope may change within an ulp of t";
        if (by.proof == SGT_ESTIMATE) break;
        if (q.sag &&
            less(size(m.slope) * 0x1p-6, size(m.t) * 0x1p-52 * square(ball(length)) * q.sag->bend(m.p)))
            return steep;
        ball g, slope;
        if (q.set && q.set->enclose(m.t, exponent(m.t) - 48, &g, &slope) && slope.sign() == 0) return steep;
    }
    for (int i = 0; i <= 64 && h.lo > -HUGE_VAL; i++) { // (behind an end that is known, ever nearer to it)
        const ball t = h.hi < HUGE_VAL ? ball(h.lo) + (ball(h.hi) - ball(h.lo)) * ball(i / 64.0)
                                       : ball(h.lo) + ball(std::ldexp(q.t->h / length, -i));
        vector3 p, n;
        ball f;
        const auto along = [&] { return size(dot(n, widen(q.ray.d))) / (norm(n) * ball(length)); };
        if (q.sag) {
            if (!q.sag->at(t, &p, &n, &f) || less(ball(1e-5), along())) continue;
            const ball off = size(f) / norm(n), about = norm(p) * 0x1p-44;
            if (!less(about, off)) return "a tangent as near as rounding";
        } else {
            // its rounding grows with the orbit: the library's own bound of F = (g / E^2) / 2, that of a
            // stretch being greater
            subject s = *q.t;
            p = {ball(q.ray.o.x) + ball(q.ray.d.x) * t, ball(q.ray.o.y) + ball(q.ray.d.y) * t,
                 ball(q.ray.o.z) + ball(q.ray.d.z) * t};
            const double rounding = s.surface().ops->rounding(s.surface().self,
                                                              {p.x.rough(), p.y.rough(), p.z.rough()});
            q.set->at_point(p, &f, &n);
            if (!less(ball(256 * rounding), size(f) / q.set->escape2()) && !less(ball(0.01), along()))
                return "a tangent as near as rounding";
        }
    }
    return nullptr;
}

const char *fault_of_point(const oracle_of &q, const sgt_hit &h, const meeting &m)
{
    const vector3 p = widen(h.p), off = minus(p, m.p);
    if (less(ball(h.p_err), norm(off)) && h.p_err < HUGE_VAL) return "p is farther from the point than p_err";
    vector3 at, n, given = widen(h.n);
    ball f;
    if (q.sag) {
        if (m.near_equator < 1e-4 || h.p_err > 1e-6 * q.t->h || !q.sag->at_point(p, &at, &n, &f))
            return nullptr;
        const ball blur = norm(minus(n, m.n)) * 4 +
                          (q.sag->steepness(p) + 1) *
                              (0x1p-44 / std::fmin(1, m.near_equator * m.near_equator));
        if (less(blur, norm(minus(n, given)))) return "n is not the gradient";
    }
    return nullptr;
}

void report(const std::string &why, const oracle_of &q, const answer &a, const sgt_hit &h, const char *how,
            const std::string &kind)
{
    if (failed[why]++ >= examples) return;
    std::printf("FAIL %s (%s; %s)\n", why.c_str(), how, kind.c_str());
    print_subject(*q.t, q.ray);
    print_hit(h);
    print_roots(a, ends(q.ray));
}

// Each ray once.
void tell_undecided(const oracle_of &q, const answer &a, const sgt_hit &h, const char *how,
                    const std::string &kind)
{
    static sgt_ray last;
    if (std::memcmp(&last, &q.ray, sizeof last) == 0 || (told++ >= 4 * examples && !verbose)) return;
    last = q.ray;
    std::printf("UNDECIDED without a reason (%s; %s)\n", how, kind.c_str());
    print_subject(*q.t, q.ray);
    print_hit(h);
    print_roots(a, ends(q.ray));
}

void take_undecided(const oracle_of &q, const answer &a, const sgt_hit &h, const char *how,
                    const std::string &kind, const char *pardon, tally *n)
{
    if (pardon) excuses[pardon]++;
    if (pardon == another_root) n->another++;
    else if (h.status <= 0) n->undecided++;
    if (pardon) return;
    n->unexcused++;
    tell_undecided(q, a, h, how, kind);
}

void judge(const oracle_of &q, const answer &a, const sgt_hit &h, const asked &question,
           const std::string &kind)
{
    const ends e(q.ray);
    asked by = question;
    if (q.set) by.pick = SGT_FIRST; // a level set has but first roots
    const bool soft = by.proof == SGT_ESTIMATE;
    tally &n = tallies[kind + " | " + by.name];
    n.rays++;
    const char *why = nullptr;
    const meeting *meant = nullptr;
    if (h.status == SGT_HIT) {
        n.hit++;
        why = fault_of_hit(a, h, e, by.proof != SGT_ESTIMATE, soft, &meant);
        if (!why) why = fault_of_stretch(h);
        if (!why && by.pick == SGT_FIRST && before(a, ball(h.t) - ball(h.t_err), e, soft))
            why = "a root before the first";
        if (!why && by.pick == SGT_NEAR_SEED && by.proof == SGT_PROVE_FIRST)
            for (const meeting &m : a.roots)
                if (&m != meant && counting(m, e) == yes && within(m, h) == no) why = "another root counts";
        if (!why && meant && !doubted(a, ball(h.t) - ball(h.t_err), ball(h.t) + ball(h.t_err))) {
            int near = 0;
            for (const meeting &m : a.roots) near += within(m, h) != no;
            if (near == 1) why = fault_of_point(q, h, *meant);
        }
    } else if (h.status == SGT_GRAZE) {
        n.graze++;
        why = fault_of_graze(h, e);
        vector3 at, normal;
        ball f;
        if (!why && q.sag && q.sag->at_point(widen(h.p), &at, &normal, &f) &&
            less(ball(h.p_err) + norm(at) * 0x1p-44, size(f) / norm(normal)))
            why = "a graze where F is not small";
        if (!why && by.pick == SGT_FIRST &&
            before(a, std::min(ball(h.lo), ball(h.t) - ball(h.t_err), less), e, soft))
            why = "a root before a graze";
        if (!why && by.pick == SGT_NEAR_SEED && by.proof == SGT_PROVE_FIRST)
            for (const meeting &m : a.roots)
                if (counting(m, e) == yes && within(m.t, ball(h.lo), ball(h.hi)) == no && within(m, h) == no)
                    why = "another root counts beside a graze";
        if (const char *pardon = excuse(q, a, h, by, e); !pardon)
            take_undecided(q, a, h, by.name, kind, pardon, &n);
    } else if (h.status == SGT_MISS) {
        n.miss++;
        for (const meeting &m : a.roots)
            if (counting(m, e, soft) == yes) why = "a miss where a root counts";
        if (a.lies && e.tmin < e.tmax) why = "a miss where the ray lies in the surface";
    } else {
        if (!(h.lo <= h.hi)) why = "an undecided answer without a stretch";
        else if (h.status != SGT_UNPROVEN && (by.proof != SGT_ESTIMATE || h.status != SGT_EXHAUSTED))
            why = "undecided, but neither unproven nor exhausted";
        else if (by.pick == SGT_FIRST && before(a, ball(h.lo), e, soft))
            why = before(a, ball(h.lo) - size(ball(h.lo)) * 0x1p-50, e, soft)
                      ? "a root before the undecided stretch"
                      : "a root before the undecided stretch by rounding alone";
        else if (by.pick == SGT_NEAR_SEED && by.proof == SGT_PROVE_FIRST)
            for (const meeting &m : a.roots)
                if (counting(m, e) == yes && within(m.t, ball(h.lo), ball(h.hi)) == no)
                    why = within(m.t, ball(h.lo) - size(ball(h.lo)) * 0x1p-50,
                                 ball(h.hi) + size(ball(h.hi)) * 0x1p-50) == no
                              ? "a root outside the undecided stretch"
                              : "a root outside the undecided stretch by rounding alone";
        take_undecided(q, a, h, by.name, kind, excuse(q, a, h, by, e), &n);
    }
    if (why) report(why, q, a, h, by.name, kind);
}

// All, in order: each right, none left out.
void judge_all(const oracle_of &q, const answer &a, int count, const sgt_hit h[], sgt_proof proof,
               const std::string &kind)
{
    const ends e(q.ray);
    const bool soft = proof == SGT_ESTIMATE;
    const char *name = proof == SGT_ESTIMATE ? "all" : proof == SGT_PROVE_ROOT ? "all, root" : "all, first";
    static const sgt_hit none = {};
    tally &n = tallies[kind + " | " + name];
    n.rays++;
    for (int i = 0; i < count; i++) {
        const char *why = nullptr;
        const meeting *meant;
        if (h[i].status == SGT_HIT) {
            n.hit++;
            why = fault_of_hit(a, h[i], e, proof != SGT_ESTIMATE, soft, &meant);
            if (!why) why = fault_of_stretch(h[i]);
        } else {
            const char *const pardon = excuse(q, a, h[i], {SGT_FIRST, proof, name}, e);
            if (h[i].status == SGT_GRAZE) n.graze++, why = fault_of_graze(h[i], e);
            else if (!(h[i].lo <= h[i].hi)) why = "an entry without a stretch";
            else if (h[i].status != SGT_UNPROVEN && (proof != SGT_ESTIMATE || h[i].status != SGT_EXHAUSTED))
                why = "an entry neither unproven nor exhausted";
            if (h[i].status != SGT_GRAZE || !pardon) take_undecided(q, a, h[i], name, kind, pardon, &n);
        }
        if (i && !(h[i].t + h[i].t_err >= h[i - 1].t - h[i - 1].t_err)) why = "out of order";
        if (why) report(std::string("all: ") + why, q, a, h[i], name, kind);
    }
    n.miss += count == 0;
    for (const meeting &m : a.roots) {
        if (counting(m, e, soft) != yes) continue;
        bool known = false;
        for (int i = 0; i < count; i++) {
            const ball lo = h[i].lo <= h[i].hi ? ball(h[i].lo) : ball(h[i].t),
                       hi = h[i].lo <= h[i].hi ? ball(h[i].hi) : ball(h[i].t);
            known = known || within(m, h[i]) != no || (h[i].status != SGT_HIT && within(m.t, lo, hi) != no);
        }
        if (!known) report("all: a root in no entry", q, a, count ? h[0] : none, name, kind);
    }
}

bool same(double a, double b) { return (a != a && b != b) || std::memcmp(&a, &b, sizeof a) == 0; }

struct clock_of {
    double *sum;
    std::clock_t from = std::clock();
    explicit clock_of(double *s) : sum(s) {}
    ~clock_of() { *sum += static_cast<double>(std::clock() - from) / CLOCKS_PER_SEC; }
};
double in_oracle, in_library;
long cells_spent, unknown;

enum { together = 16, most = 4000 };

void run_surface(subject &t, const sgt_ray rays[], const std::string kinds[], int n, long budget)
{
    const sgt_surface s = t.surface();
    sgt_hit single[sizeof questions / sizeof *questions][together];
    for (std::size_t k = 0; k < sizeof questions / sizeof *questions; k++) {
        sgt_options opt = {};
        opt.pick = questions[k].pick;
        opt.proof = questions[k].proof;
        const clock_of c(&in_library);
        for (int i = 0; i < n; i++) single[k][i] = sgt_intersect(s, rays[i], &opt);
        // batches: the same bits
        double in[8][together], out[6][together];
        sgt_status status[together];
        for (int i = 0; i < n; i++) {
            const sgt_ray &r = rays[i];
            const ends e(r);
            const double v[8] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, e.tmin, e.tmax};
            for (int j = 0; j < 8; j++) in[j][i] = v[j];
        }
        sgt_rays many = {};
        sgt_hits hits = {};
        for (int j = 0; j < 3; j++) many.o[j] = in[j], many.d[j] = in[3 + j], hits.p[j] = out[3 + j];
        many.tmin = in[6], many.tmax = in[7];
        hits.status = status, hits.t = out[0], hits.t_err = out[1], hits.t_lo = out[2];
        sgt_intersect_batch(s, static_cast<std::size_t>(n), many, hits, &opt);
        for (int i = 0; i < n; i++) {
            const sgt_hit &h = single[k][i];
            if (status[i] != h.status || !same(out[0][i], h.t) ||
                (h.status > 0 &&
                 (!same(out[1][i], h.t_err) || !same(out[2][i], h.t_lo) || !same(out[3][i], h.p.x)))) {
                if (failed["a batch is not its single rays"]++ < examples) {
                    std::printf("FAIL a batch is not its single rays (%s; %s): status %d t %a\n",
                                questions[k].name, kinds[i].c_str(), status[i], out[0][i]);
                    print_subject(t, rays[i]);
                    print_hit(h);
                }
            }
        }
    }
    static sgt_hit list[most];
    for (int i = 0; i < n; i++) {
        answer a;
        oracle_of q = {&t, nullptr, nullptr, rays[i]};
        optical sag(t.s, t.asphere, rays[i]);
        level_set set(t.f, rays[i]);
        if (t.is_level) q.set = &set;
        else q.sag = &sag;
        {
            const clock_of c(&in_oracle);
            const ends e(rays[i]);
            a = t.is_level ? set.all_roots(e.tmin, e.tmax, budget) : sag.all_roots();
        }
        for (meeting &m : a.roots) // F is (g / E^2) / 2, nearly
            if (t.is_level)
                m.t_err = s.ops->rounding(s.self, {m.p.x.rough(), m.p.y.rough(), m.p.z.rough()}) *
                          std::fabs((set.escape2() * 2 / m.slope).rough());
        cells_spent += a.cells;
        if (a.gave_up) {
            if (verbose) {
                std::printf("the oracle gave up (%s) after %ld cells, %zu roots\n", kinds[i].c_str(), a.cells,
                            a.roots.size());
                print_subject(t, rays[i]);
            }
            unknown++;
        }
        for (std::size_t k = 0; k < sizeof questions / sizeof *questions; k++)
            judge(q, a, single[k][i], questions[k], kinds[i]);
        for (const sgt_proof proof : {SGT_ESTIMATE, SGT_PROVE_ROOT, SGT_PROVE_FIRST}) {
            sgt_options opt = {};
            opt.proof = proof;
            int count;
            {
                const clock_of c(&in_library);
                count = sgt_intersect_all(s, rays[i], most, list, &opt);
            }
            if (count < 0 || count > most) {
                if (!a.gave_up) report("all: invalid, or too many", q, a, sgt_hit(), "all", kinds[i]);
                continue;
            }
            judge_all(q, a, count, list, proof, kinds[i]);
        }
    }
}

// One element, or two, through the same oracle: the ray of each is what the passage before it says.  The
// launch and the step from one frame to the next round, so that a root is met within t_err and some more.
void judge_passage(const subject &t, const sgt_ray &ray, double aperture, const sgt_hit &h, sgt_fate fate,
                   sgt_proof proof, const std::string &kind)
{
    const char *name = proof == SGT_ESTIMATE     ? "trace"
                       : proof == SGT_PROVE_ROOT ? "trace, root"
                                                 : "trace, first";
    tally &n = tallies[kind + " | " + name];
    n.rays++;
    const bool soft = true;
    const ends e(ray);
    optical sag(t.s, t.asphere, ray);
    const answer a = sag.all_roots();
    const oracle_of q = {&t, &sag, nullptr, ray};
    const ball from = (size(ball(ray.o.x)) + size(ball(ray.o.y)) + size(ball(ray.o.z))) * 0x1p-44;
    const ball limit = square(ball(aperture));
    const auto slack = [&](const meeting &m) { return start_margin(m) * 64 + from + m.spread * 0x1p-44; };
    const auto clear = [&](const meeting &m) {
        return aperture == 0 || less((square(m.p.x) + square(m.p.y)) * (1 + 1e-9), limit);
    };
    // (one that a rounding of the ray cannot take away)
    const auto firm = [&](const meeting &m) {
        return counting(m, e, soft) == yes && m.near_equator > 1e-4 && less(m.spread * 0x1p-17, norm(m.p));
    };
    const char *why = nullptr;
    if (h.status == SGT_HIT) {
        n.hit++;
        bool met = !a.doubts.empty() || a.gave_up;
        for (const meeting &m : a.roots) {
            const bool here = less(size(m.t - ball(h.t)), ball(h.t_err) + slack(m)) ||
                              !arb_is_finite(m.spread.x);
            met = met || here;
            if (here || !firm(m)) continue;
            if (clear(m) && fate == SGT_CLIPPED)
                why = "trace: clipped where another root is within the aperture";
            if (clear(m) && proof == SGT_PROVE_FIRST) why = "trace: another root counts";
        }
        if (!met && !a.beyond && !sag.near_domain()) { // the ray that touched is not quite this one
            vector3 p, normal;
            ball f;
            if (!sag.at_point(widen(h.p), &p, &normal, &f) ||
                less(norm(p) * 0x1p-44 + from * norm(widen(ray.d)), size(f) / norm(normal)))
                why = "trace: no root within t_err";
        }
    } else if (h.status == SGT_GRAZE) n.graze++;
    else if (h.status == SGT_MISS) {
        n.miss++;
        for (const meeting &m : a.roots)
            if (firm(m) && clear(m)) why = "trace: a miss where a root counts";
    } else {
        if (h.status != SGT_UNPROVEN && (proof != SGT_ESTIMATE || h.status != SGT_EXHAUSTED))
            why = "trace: undecided, but neither unproven nor exhausted";
        const char *const pardon = excuse(q, a, h, {SGT_NEAR_SEED, proof, name}, e, aperture,
                                          from.rough() * 0x1p-6);
        take_undecided(q, a, h, name, kind + "; aperture " + std::to_string(aperture), pardon, &n);
    }
    if (why) report(why, q, a, h, name, kind);
}

void traces(generator &g, const subject &first, const sgt_ray &given, const std::string &kind)
{
    subject t[2] = {first, random_optical(g, first.h)};
    sgt_element e[2] = {};
    double index[2] = {g.chance(0.5) ? 0 : 1.5, 0};
    for (int i = 0; i < 2; i++) {
        e[i].surface = t[i].surface();
        e[i].index = index[i];
        if (g.chance(0.5)) e[i].semi_diameter = t[i].h * g.uniform(0.5, 1.2);
    }
    e[1].pose.origin.z = first.h * g.uniform(-1, 1);
    for (const sgt_proof proof : {SGT_ESTIMATE, SGT_PROVE_ROOT, SGT_PROVE_FIRST}) {
        sgt_options opt = {};
        opt.proof = proof;
        sgt_ray ray = given;
        sgt_passage p[2];
        sgt_fate fate;
        // (its own direction, of unit length)
        sgt_element straight = e[0];
        straight.index = 0, straight.semi_diameter = 0;
        sgt_ray launch = given;
        if (sgt_trace(1, &straight, 1, &launch, p, &fate, nullptr) != 1) return;
        const sgt_vec3 d = p[0].direction;
        const size_t passed = sgt_trace(2, e, 1, &ray, p, &fate, &opt);
        judge_passage(t[0], {given.o, d, -HUGE_VAL, HUGE_VAL}, e[0].semi_diameter, p[0].hit,
                      passed > 0 ? SGT_PASSED : fate, proof, kind);
        if (passed > 0) {
            const sgt_vec3 o = p[0].hit.p;
            judge_passage(t[1], {{o.x, o.y, o.z - e[1].pose.origin.z}, p[0].direction, -HUGE_VAL, HUGE_VAL},
                          e[1].semi_diameter, p[1].hit, passed > 1 ? SGT_PASSED : fate, proof, kind);
        }
        double in[6][1] = {{given.o.x}, {given.o.y}, {given.o.z}, {given.d.x}, {given.d.y}, {given.d.z}},
               out[3][1], opl;
        sgt_fate fate_of;
        int count;
        sgt_rays rays = {};
        sgt_traced traced = {};
        for (int j = 0; j < 3; j++) rays.o[j] = in[j], rays.d[j] = in[3 + j], traced.o[j] = out[j];
        traced.fate = &fate_of, traced.passed = &count, traced.opl = &opl;
        sgt_trace_batch(2, e, 1, 1, rays, traced, nullptr, &opt);
        if (fate_of != fate || count != static_cast<int>(passed) || !same(out[0][0], ray.o.x)) {
            if (failed["a batch of traces is not its single rays"]++ < examples) print_subject(first, given);
        }
    }
}

void optical_rays(generator &g, long count)
{
    sgt_ray rays[together];
    std::string kinds[together];
    for (long done = 0; done < count;) {
        subject t = random_optical(g);
        if (g.chance(0.3)) { // by one: the rim is its own
            rays[0] = hard_ray(g, &t, &kinds[0]);
            kinds[0] = kinds[0] + ", " + t.kind;
            run_surface(t, rays, kinds, 1, 0);
            if (g.chance(0.1)) traces(g, t, rays[0], kinds[0]);
            done++;
            continue;
        }
        const int n = static_cast<int>(std::min<long>(together, count - done));
        for (int i = 0; i < n; i++) rays[i] = ordinary_ray(g, t), kinds[i] = "ordinary, " + t.kind;
        // a few hard ones among them, that leave the rim as it is
        for (int i = 0; i < n; i++)
            if (g.chance(0.08)) {
                subject other = t;
                std::string kind;
                const sgt_ray r = hard_ray(g, &other, &kind);
                if (std::memcmp(&other.s, &t.s, sizeof t.s) == 0)
                    rays[i] = r, kinds[i] = kind + ", " + t.kind;
            }
        run_surface(t, rays, kinds, n, 0);
        if (g.chance(0.2)) traces(g, t, rays[0], kinds[0]);
        done += n;
    }
}

void level_rays(generator &g, long count)
{
    sgt_ray rays[4];
    std::string kinds[4];
    for (long done = 0; done < count; done += 4) {
        subject t = random_level_set(g);
        for (int i = 0; i < 4; i++) {
            kinds[i] = "ordinary";
            rays[i] = oracle::random_ray(g, t.f);
            if (g.chance(0.1)) rays[i] = hard_level_ray(g, &t, &kinds[i]);
            else if (g.chance(0.2)) rays[i].tmin = -HUGE_VAL, rays[i].tmax = HUGE_VAL;
            kinds[i] += ", " + t.kind;
        }
        run_surface(t, rays, kinds, 4, 20000);
    }
}

// Without proof: F certainly changes sign between t - t_err and t + t_err, where 113 bits tell, or Arb.
struct without_proof {
    long rays = 0, hits = 0, others = 0, by_arb = 0;
} plain;

void check_change(const subject &t, const sgt_ray &r, double at, double err, const char *how)
{
    plain.hits++;
    const int before = t.is_level ? quick_sign(t.f, r, at, -err) : quick_sign(t.s, t.asphere, r, at, -err);
    const int behind = t.is_level ? quick_sign(t.f, r, at, err) : quick_sign(t.s, t.asphere, r, at, err);
    if (before * behind < 0) return;
    plain.by_arb++;
    sgt_hit h = {};
    h.t = at, h.t_err = err, h.status = SGT_HIT;
    optical sag(t.s, t.asphere, r);
    level_set set(t.f, r);
    const answer a = t.is_level ? set.all_roots(at - 8 * err, at + 8 * err, 2000) : sag.all_roots();
    if (doubted(a, ball(at) - ball(err), ball(at) + ball(err)) || a.gave_up || a.lies) return;
    for (const meeting &m : a.roots)
        if (within(m, h) != no) return;
    const oracle_of q = {&t, t.is_level ? nullptr : &sag, t.is_level ? &set : nullptr, r};
    report("without proof: no root within t_err", q, a, h, how, t.kind);
}

void unproven(generator &g, long count)
{
    enum { many = 64 };
    sgt_ray rays[many];
    double in[8][many], t_of[many], t_err[many];
    sgt_status status[many];
    for (long done = 0; done < count;) {
        const bool is_level = g.chance(0.1);
        subject t = is_level ? random_level_set(g) : random_optical(g);
        int n = static_cast<int>(std::min<long>(many, count - done));
        std::string kind;
        if (!is_level && g.chance(0.5)) n = 1;
        for (int i = 0; i < n; i++) {
            if (is_level)
                rays[i] = g.chance(0.05) ? hard_level_ray(g, &t, &kind) : oracle::random_ray(g, t.f);
            else if (n > 1) {
                rays[i] = ordinary_ray(g, t);
                if (g.chance(0.1)) {
                    subject other = t;
                    const sgt_ray r = hard_ray(g, &other, &kind);
                    if (std::memcmp(&other.s, &t.s, sizeof t.s) == 0) rays[i] = r;
                }
            } else rays[i] = hard_ray(g, &t, &kind);
            const sgt_ray &r = rays[i];
            const ends e(r);
            const double v[8] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, e.tmin, e.tmax};
            for (int j = 0; j < 8; j++) in[j][i] = v[j];
        }
        sgt_rays batch = {};
        sgt_hits hits = {};
        for (int j = 0; j < 3; j++) batch.o[j] = in[j], batch.d[j] = in[3 + j];
        batch.tmin = in[6], batch.tmax = in[7];
        hits.status = status, hits.t = t_of, hits.t_err = t_err;
        const sgt_surface s = t.surface();
        for (const sgt_pick pick : {SGT_FIRST, SGT_NEAR_SEED}) {
            sgt_options opt = {};
            opt.pick = pick;
            if (is_level && pick == SGT_NEAR_SEED) continue;
            sgt_intersect_batch(s, static_cast<std::size_t>(n), batch, hits, &opt);
            for (int i = 0; i < n; i++) {
                if (status[i] == SGT_HIT)
                    check_change(t, rays[i], t_of[i], t_err[i],
                                 pick == SGT_FIRST ? "first" : "near the seed");
                else plain.others++;
            }
        }
        plain.rays += n;
        done += n;
    }
}

// The kind of ray without that of the surface; of a level set with "set".
std::string kind_of(const std::string &name)
{
    const std::size_t comma = name.find(", ");
    const bool set = name.find("julia") != name.npos || name.find("mandelbrot") != name.npos;
    return name.substr(0, comma) + (set ? ", set" : "");
}

// The greatest share of undecided answers to one question.
double most_undecided(const std::string &kind)
{
    static const std::map<std::string, double> hard = {
        {"pair", 0.3},   {"rim", 0.7},      {"equator", 0.15},    {"parallel", 0.01},
        {"start", 0.02}, {"tangent", 0.06}, {"tangent, set", 0.2}};
    const auto found = hard.find(kind);
    return found != hard.end() ? found->second : 0.001;
}

// A line for each kind; for each question the share that is undecided, and behind / what is since another
// root counts.  false: a share is too great, where there are enough of the kind to tell.
bool print_tallies()
{
    std::map<std::string, std::map<std::string, tally>> table;
    for (const auto &e : tallies) {
        const std::size_t bar = e.first.find(" | ");
        tally &sum = table[kind_of(e.first.substr(0, bar))][e.first.substr(bar + 3)];
        const tally &one = e.second;
        sum.rays += one.rays, sum.hit += one.hit, sum.graze += one.graze, sum.miss += one.miss;
        sum.another += one.another, sum.undecided += one.undecided, sum.unexcused += one.unexcused;
    }
    static const char *const columns[] = {
        "estimate",  "root",       "first", "root, near the seed", "first, near the seed", "all",
        "all, root", "all, first", "trace", "trace, root",         "trace, first"};
    bool few = true;
    std::printf("undecided, in %%: the first root by estimate, root, first; near the seed by root, first; "
                "all by estimate, root, first; traces by estimate, root, first\n");
    std::printf("%-15s %8s %8s %7s %8s\n", "kind", "rays", "hit", "graze", "miss");
    for (auto &row : table) {
        const tally &n = row.second["estimate"];
        std::printf("%-15s %8ld %8ld %7ld %8ld ", row.first.c_str(), n.rays, n.hit, n.graze, n.miss);
        for (const char *c : columns) {
            const tally &k = row.second[c];
            const double all = std::fmax(1, static_cast<double>(k.rays)),
                         share = static_cast<double>(k.undecided) / all;
            std::printf(" %6.3g", 100 * share);
            if (k.another) std::printf("/%.3g", 100 * static_cast<double>(k.another) / all);
            if (k.undecided > 5 + most_undecided(row.first) * all) { // (5: by chance, of few)
                few = false;
                std::printf(" (too many)");
            }
        }
        std::printf("\n");
    }
    for (const auto &e : excuses) std::printf("  %9ld undecided: %s\n", e.second, e.first.c_str());
    return few;
}

} // namespace

int main(int argc, char **argv)
{
    long count[3] = {4000, 60, 20000};
    std::uint64_t seed = 20240501;
    const char *const scale = std::getenv("SAGITTA_TEST_SCALE");
    for (long &c : count) c = static_cast<long>(static_cast<double>(c) * (scale ? std::atof(scale) : 0.5));
    if (const char *e = std::getenv("SAGITTA_TEST_SEED")) seed = std::strtoull(e, nullptr, 0);
    static const char *const names[] = {"--optical", "--levels", "--unproven"};
    for (int i = 1; i < argc; i++) {
        if (!std::strcmp(argv[i], "--verbose")) verbose = true;
        if (i + 1 >= argc) continue;
        for (int j = 0; j < 3; j++)
            if (!std::strcmp(argv[i], names[j])) count[j] = std::strtol(argv[i + 1], nullptr, 10);
        if (!std::strcmp(argv[i], "--examples")) examples = std::strtol(argv[i + 1], nullptr, 10);
        if (!std::strcmp(argv[i], "--seed")) seed = std::strtoull(argv[i + 1], nullptr, 0);
    }
    std::printf("seed %llu, optical %ld, levels %ld, unproven %ld\n", static_cast<unsigned long long>(seed),
                count[0], count[1], count[2]);
    generator g(seed);
    if (count[0] > 0) optical_rays(g, count[0]);
    std::printf("optical: %.2f s in the oracle, %.2f s in the library, %ld cells, %ld given up\n", in_oracle,
                in_library, cells_spent, unknown);
    in_oracle = in_library = 0, cells_spent = unknown = 0;
    if (count[1] > 0) level_rays(g, count[1]);
    std::printf("level sets: %.2f s in the oracle, %.2f s in the library, %ld cells, %ld given up\n",
                in_oracle, in_library, cells_spent, unknown);
    if (count[2] > 0) {
        double spent = 0;
        {
            const clock_of c(&spent);
            unproven(g, count[2]);
        }
        std::printf("without proof: %.2f s, %ld rays, %ld hits, %ld of them told by Arb, %ld other answers\n",
                    spent, plain.rays, plain.hits, plain.by_arb, plain.others);
    }
    const bool few = print_tallies();
    if (!few) std::printf("  FAIL too many are undecided\n");
    for (const auto &f : failed) std::printf("  FAIL %9ld  %s\n", f.second, f.first.c_str());
    long unexcused = 0;
    for (const auto &e : tallies) unexcused += e.second.unexcused;
    if (unexcused) std::printf("  FAIL %9ld  undecided without a reason\n", unexcused);
    return !failed.empty() || unexcused || !few;
}
