// SPDX-License-Identifier: MIT
// Formulas against Arb: what each status, t, t_err, p and p_err claim, for rays of every kind.
//
//     test_roots [--count N] [--seed S] [--only NAME] [--by-hand] [--examples N] [--list]
//                [--random [--seconds T]]
//
// Every root within the clip is enclosed by balls (oracle.h).  Then the ray is asked for its first hit,
// without proof and with, for all hits, and in a batch:
//   - an answered root is one of the oracle's, within t_err, and the point within p_err;
//   - no root lies before the first, none on a ray that misses, and none is left out of all hits;
//   - a jump or a pole is no root, and a double root no change of sign;
//   - what is undecided, and a graze, has a reason: a double root, a tangent, a singular point, a kink, a
//   branch
//     cut, a pole, the end of a domain, of the clip or of the ray, within a millionth of the chord.  It is
//     counted by its reason.  Without one it is a fault.  Where max_evals was spent, a ray within 1e-4 of the
//     size of a tangent is let pass, if these are few;
//   - a batch is the single rays, to the last bit.
//
// --random: rays to random formulas (grown.h), for so long.
//
// --by-hand: the same surfaces made of C++ (subject.h), for a look at the oracle itself.  A user's surface
// may be hit in a jump (sagitta.h), which is let pass then.
#include "../ends.h"
#include "grown.h"
#include "rays.h"
#include "subject.h"

#include <cstdio>
#include <cstring>
#include <ctime>
#include <map>

using namespace formula;

namespace
{

long examples = 2, failures;

struct tally {
    long rays = 0, hits = 0, misses = 0, undecided = 0, grazes = 0;
    std::map<std::string, long> reasons, faults;
    double worst = 0; // of |t - oracle| / t_err
    double nanoseconds = 0, proven = 0;
    long evals = 0, most_evals = 0, spent = 0;
};

enum counts { no, perhaps, yes };

counts counting(const meeting &m, const sgt_ray &ray, double chord)
{
    if (m.inside < 0) return no;
    counts c = m.inside ? yes : perhaps;
    const ball margin = proof::scaled(m.spread, -48) + proof::scaled(proof::size(m.t), -50),
               most = margin * 3 + ball(1e-11 * chord);
    if (!m.spread.is_finite()) c = perhaps;
    if (ray.tmin > -HUGE_VAL) {
        const ball from = m.t - ball(ray.tmin);
        if (less(from, margin)) return no;
        if (!less(most, from)) c = perhaps;
    }
    if (ray.tmax < HUGE_VAL) {
        const ball left = ball(ray.tmax) - m.t;
        if (less(left, -most)) return no;
        if (!less(most, left)) c = perhaps;
    }
    return c;
}

const char *name_of(const sgt_proof p) { return p == SGT_ESTIMATE ? "estimate" : "proven first"; }

void print_ray(const sgt_ray &r)
{
    std::printf("    {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z,
                r.tmin, r.tmax);
}
void print_hit(const sgt_hit &h)
{
    std::printf("    %s t %.17g t_lo %.3g t_err %.3g [%.17g, %.17g] evals %d f %.3g p_err %.3g\n",
                sgt_status_text(h.status), h.t, h.t_lo, h.t_err, h.lo, h.hi, h.evals, h.f, h.p_err);
}
void print_answer(const answer &a)
{
    int left = 8;
    for (const meeting &m : a.roots)
        if (left-- > 0)
            std::printf("    root  %s inside %d slope %.3g\n", proof::text(m.t).c_str(), m.inside,
                        m.slope.rough());
    for (const meeting &m : a.touches)
        if (left-- > 0) std::printf("    touch %s inside %d\n", proof::text(m.t).c_str(), m.inside);
    for (const doubt &d : a.doubts)
        if (left-- > 0)
            std::printf("    doubt %s ... %s %s\n", proof::text(d.lo, 18).c_str(),
                        proof::text(d.hi, 18).c_str(), d.why);
    std::printf("    searched [%g, %g], %ld cells%s%s\n", a.lo, a.hi, a.cells, a.lies ? ", lies" : "",
                a.gave_up ? ", gave up" : "");
}

class judge
{
  public:
    judge(const written &f, const sgt_surface &s, double steep, bool jumps, tally *t)
        : f_(f), s_(s), steep_(steep), jumps_(jumps), t_(*t)
    {
    }

    void take(const sgt_ray &ray, const char *kind)
    {
        ray_ = ray, kind_ = kind;
        const course way(f_, ray, steep_);
        way_ = &way;
        const answer a = way.all_roots();
        a_ = &a;
        chord_ = a.lo < a.hi ? a.hi - a.lo : 0;
        t_.rays++;
        for (const sgt_proof p : {SGT_ESTIMATE, SGT_PROVE_FIRST}) {
            sgt_options o = {};
            o.proof = p;
            first(sgt_intersect(s_, ray, &o), p);
        }
        all();
    }

    void batch(const std::vector<sgt_ray> &rays)
    {
        const std::size_t n = rays.size();
        std::vector<double> in[8], out[10];
        for (auto &v : in) v.resize(n);
        for (auto &v : out) v.resize(n);
        std::vector<sgt_status> status(n);
        std::vector<int> evals(n);
        for (std::size_t i = 0; i < n; i++) {
            const sgt_ray &r = rays[i];
            const double v[8] = {r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z, r.tmin, end_of(&r)};
            for (int k = 0; k < 8; k++) in[k][i] = v[k];
        }
        const sgt_rays all = {{in[0].data(), in[1].data(), in[2].data()},
                              {in[3].data(), in[4].data(), in[5].data()},
                              in[6].data(),
                              in[7].data()};
        const sgt_hits to = {status.data(),
                             evals.data(),
                             out[0].data(),
                             out[1].data(),
                             out[2].data(),
                             {out[3].data(), out[4].data(), out[5].data()},
                             {out[6].data(), out[7].data(), out[8].data()},
                             out[9].data(),
                             {}};
        for (const sgt_proof p : {SGT_ESTIMATE, SGT_PROVE_FIRST}) {
            sgt_options o = {};
            o.proof = p;
            timespec from, till;
            clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &from);
            const std::size_t positive = sgt_intersect_batch(s_, n, all, to, &o);
            clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &till);
            (p == SGT_ESTIMATE ? t_.nanoseconds : t_.proven) =
                (static_cast<double>(till.tv_sec - from.tv_sec) * 1e9 +
                 static_cast<double>(till.tv_nsec - from.tv_nsec)) /
                static_cast<double>(n);
            std::size_t counted = 0;
            for (std::size_t i = 0; i < n; i++) {
                const sgt_hit h = sgt_intersect(s_, rays[i], &o);
                counted += h.status > 0;
                const double v[10] = {h.t,   h.t_err, h.t_lo, h.p.x, h.p.y,
                                      h.p.z, h.n.x,   h.n.y,  h.n.z, h.p_err};
                bool same = status[i] == h.status && evals[i] == h.evals;
                for (int k = 0; k < 10; k++)
                    same = same && (std::memcmp(&v[k], &out[k][i], sizeof v[k]) == 0 ||
                                    (v[k] != v[k] && out[k][i] != out[k][i]));
                if (same) continue;
                ray_ = rays[i], kind_ = "batch", a_ = nullptr;
                fault("a batch is not the single rays", h, name_of(p));
            }
            if (counted != positive) {
                ray_ = rays[0], kind_ = "batch", a_ = nullptr;
                fault("the count of a batch", sgt_hit(), name_of(p));
            }
        }
    }

  private:
    const written &f_;
    const sgt_surface s_;
    const double steep_;
    const bool jumps_;
    tally &t_;
    sgt_ray ray_ = {};
    const char *kind_ = "";
    const course *way_ = nullptr;
    const answer *a_ = nullptr;
    double chord_ = 0;

    void fault(const std::string &why, const sgt_hit &h, const char *how)
    {
        failures++;
        if (t_.faults[why]++ >= examples) return;
        std::printf("FAIL %s: %s (%s; %s)\n", f_.name.c_str(), why.c_str(), how, kind_);
        print_ray(ray_);
        print_hit(h);
        if (a_) print_answer(*a_);
    }

    counts count(const meeting &m) const { return counting(m, ray_, chord_); }

    const char *odd(const sgt_hit &h) const
    {
        if (!(h.t_err >= 0 && h.t_err < HUGE_VAL)) return "t_err is no bound";
        if (!(std::fabs(h.t_lo) <= h.t_err)) return "t_lo is beyond t_err";
        if (!(h.t >= ray_.tmin && h.t <= ray_.tmax)) return "t is not on the ray";
        if (!(h.lo <= h.t && h.t <= h.hi)) return "t is not within [lo, hi]";
        if (!(h.p_err >= 0)) return "p_err is no bound";
        return nullptr;
    }

    // Of a HIT, as the first or among all.
    const char *fault_of_hit(const sgt_hit &h, bool alone)
    {
        if (const char *why = odd(h)) return why;
        if (a_->lies) return "a change of sign where the ray lies in the surface";
        const ball lo = ball(h.t) - ball(h.t_err), hi = ball(h.t) + ball(h.t_err);
        const meeting *meant = nullptr;
        int surely = 0, possibly = 0;
        for (const meeting &m : a_->roots) {
            if (less(m.t, lo) || less(hi, m.t)) continue;
            possibly++;
            surely += arb_le(lo.x, m.t.x) && arb_le(m.t.x, hi.x);
            meant = &m;
        }
        if (possibly == 0) {
            for (const meeting &m : a_->touches)
                if (!less(m.t, lo) && !less(hi, m.t)) return "a double root as a change of sign";
            for (const doubt &d : a_->doubts)
                if (!less(d.hi, lo) && !less(hi, d.lo)) {
                    if (!jumps_ && (d.why == why_cut || d.why == why_pole))
                        return "a jump or a pole as a hit";
                    return nullptr;
                }
            return "no root within t_err";
        }
        if (alone && surely > 1) return "more than one root within t_err";
        if (possibly > 1) return nullptr;
        if (meant->inside < 0) return "a root beyond the clip";
        if (ray_.tmin > -HUGE_VAL && less(meant->t - ball(ray_.tmin),
                                          proof::scaled(meant->spread, -48) * 0.999 - ball(h.t_err) * 0.001))
            return "a root at the start";
        const double off = proof::low(proof::size(meant->t - ball(h.t))).rough(); // (t itself may be 0)
        if (off > t_.worst * h.t_err && h.t_err > 0) t_.worst = off / h.t_err;
        const ball away = norm(minus(widen(h.p), meant->p));
        if (less(ball(h.p_err), away)) return "p is farther from the root than p_err";
        const point3 n = gradient(f_, widen(h.p));
        if (norm(n).is_finite() && !breaks_at(f_, h.p) && h.p_err < 1e-9 * f_.where.size() &&
            less(ball(1e-9) * (norm(n) + ball(steep_)) + norm(minus(n, meant->n)) * 10,
                 norm(minus(n, widen(h.n)))))
            return "n is not the gradient";
        return nullptr;
    }

    const meeting *before(const ball &t) const
    {
        for (const meeting &m : a_->roots)
            if (count(m) == yes && less(m.t, t)) return &m;
        for (const meeting &m : a_->touches)
            if (count(m) == yes && less(m.t, t)) return &m;
        return nullptr;
    }

    // A stretch without a decision, or a graze.
    void excuse(const sgt_hit &h, const char *how, long before = 0)
    {
        const char *why = way_->reason(*a_, h.lo, h.hi);
        if (!why && before + h.evals >= 2000) {
            double t, off, along;
            way_->nearest(a_->lo, h.hi, &t, &off, &along);
            if (before > 1000)
                why = "max_evals was spent before";
            else if (h.status == SGT_EXHAUSTED && course::has_doubt(*a_, h.lo, h.hi))
                why = "max_evals before a pole or the like";
            else if (off < (f_.touches ? 1e-3 : 1e-4) * f_.where.size() && std::fabs(along) < 0.05)
                why = "max_evals near a tangent";
            t_.spent += why != nullptr;
        }
        if (!why) {
            for (const meeting &m : a_->roots)
                if (count(m) == perhaps && !less(m.t, ball(h.lo)) && !less(ball(h.hi), m.t)) why = why_start;
        }
        const std::string status = sgt_status_text(h.status);
        double t = 0, off = 0, along = 0;
        if (!why) {
            way_->nearest(h.lo, h.hi, &t, &off, &along);
            if (off < 1e-12 * f_.where.size() && std::fabs(along) < 1e-12)
                why = why_lies; // in a flat part of it
        }
        if (!why) {
            if (f_.is_random()) {
                t_.reasons[status + ": not explained"]++;
                return;
            }
            fault(status + " without a reason", h, how);
            if (t_.faults[status + " without a reason"] <= examples)
                std::printf("    nearest at t %.17g: distance %.3g of the size, cosine %.3g\n", t,
                            off / f_.where.size(), along);
            return;
        }
        t_.reasons[status + ": " + why]++;
    }

    void first(const sgt_hit &h, sgt_proof proof)
    {
        const char *how = name_of(proof), *why = nullptr;
        t_.evals += h.evals, t_.most_evals = std::max(t_.most_evals, static_cast<long>(h.evals));
        switch (h.status) {
        case SGT_HIT:
            t_.hits++;
            why = fault_of_hit(h, proof != SGT_ESTIMATE);
            if (!why && before(ball(h.t) - ball(h.t_err))) why = "a root before the first";
            break;
        case SGT_GRAZE:
            t_.grazes++;
            why = odd(h);
            if (!why && before(std::min(ball(h.lo), ball(h.t) - ball(h.t_err), less)))
                why = "a root before a graze";
            if (!why) excuse(h, how);
            break;
        case SGT_MISS:
            t_.misses++;
            if (before(ball(HUGE_VAL))) why = "a root on a miss";
            if (a_->lies && ray_.tmax > a_->lo && ray_.tmin < a_->hi && f_.where.ball > 0)
                why = "a miss in the surface";
            break;
        case SGT_UNPROVEN:
        case SGT_UNDEFINED:
        case SGT_EXHAUSTED:
            t_.undecided++;
            if (!(h.lo <= h.hi))
                why = "an undecided stretch that is empty";
            else if (before(ball(h.lo)))
                why = "a root before what is undecided";
            else
                excuse(h, how);
            break;
        default:
            why = "a status that nobody asked for";
        }
        if (why) fault(why, h, how);
    }

    void all()
    {
        static sgt_hit found[512];
        const int total = sgt_intersect_all(s_, ray_, 512, found, nullptr), n = std::min(total, 512);
        if (n < 0) return fault("not a number of hits", sgt_hit(), "all");
        long spent = 0;
        for (int i = 0; i < n; i++) {
            const sgt_hit &h = found[i];
            const char *why = nullptr;
            spent += h.evals;
            if (i > 0 && !(found[i - 1].t <= h.t))
                why = "hits out of order";
            else if (h.status == SGT_HIT)
                why = fault_of_hit(h, false);
            else if (h.status == SGT_GRAZE)
                why = odd(h);
            if (why)
                fault(why, h, "all");
            else if (h.status != SGT_HIT)
                excuse(h, "all", spent - h.evals);
        }
        if (total > n) return; // grazes, of a ray nearly in a plane
        // Each root is in an entry.  Two in one hit are as near as t_err.
        std::vector<int> taken(static_cast<std::size_t>(n), 0);
        for (const std::vector<meeting> *list : {&a_->roots, &a_->touches})
            for (const meeting &m : *list) {
                if (count(m) != yes) continue;
                int in = -1;
                for (int i = 0; i < n; i++) {
                    const sgt_hit &h = found[i];
                    const ball more = h.status > 0 ? ball(h.t_err) : ball(0);
                    if (less(m.t, std::min(ball(h.lo), ball(h.t) - more, less)) ||
                        less(std::max(ball(h.hi), ball(h.t) + more, less), m.t))
                        continue;
                    if (in < 0 || taken[static_cast<std::size_t>(in)]) in = i;
                }
                if (in < 0)
                    fault("a root left out of all", n ? found[0] : sgt_hit(), "all");
                else if (found[in].status == SGT_HIT && taken[static_cast<std::size_t>(in)]++ &&
                         found[in].t_err > 1e-6 * chord_)
                    fault("two roots as one hit", found[in], "all");
            }
    }
};

// Rays that something was wrong with.
const struct {
    const char *name;
    sgt_ray ray;
} past[] = {
    // From one face close to an edge, and along the next face: Newton's interval is as long as that face, and
    // the root was UNPROVEN in it (proof.c, between_signs).
    {"octahedron",
     {{0x1.cb7cccb8669a9p-2, -0x1.134c9aaeb651ep+1, -0x1.59c376a47e959p+1},
      {-0x1.2ac2e31c68306p-4, 0x1.7b43863d0bd94p-1, 0x1.55eb29d97ed3bp-1},
      0,
      HUGE_VAL}},
    {"octahedron",
     {{-0x1.06f60f3249c42p-2, -0x1.d2ab1f0241d08p+0, 0x1.21db37ff349d4p-1},
      {0x1.ee5e790bf57a8p-3, 0x1.97a6b3a631cb3p-1, -0x1.1c0f1563346cdp-1},
      0,
      HUGE_VAL}},
    {"octahedron",
     {{0x1.5450a80519b96p+0, -0x1.191208ff79337p-1, 0x1.c7b30be185302p+0},
      {-0x1.874c91a064752p-1, 0x1.10eb6f665cffcp-3, -0x1.4311b5c6cd357p-1},
      0,
      HUGE_VAL}},
    // In the plane x = 0, where 0^y is 0 and its derivative by y has a logarithm of 0 (numbers.h, power).
    {"real_power",
     {{0, -0x1.1d767e0bd2d78p+3, 0x1.27b54b7894b86p+3}, {0, 1, -1}, 0, HUGE_VAL}},
};

// The middle one of |grad F| in the volume.
double steepness(const written &f, generator &g)
{
    std::vector<double> all;
    for (int i = 0; i < 300; i++) {
        sgt_vec3 n;
        value_at(f, random_point(g, f.where), &n, f.touches);
        const double steep = std::sqrt(inner(n, n));
        if (steep < HUGE_VAL) all.push_back(steep);
    }
    std::sort(all.begin(), all.end());
    return all.empty() ? 1 : all[all.size() / 2];
}

// Nine rays each, one of every kind, to run.count / 2 random formulas, or to as many as the time allows.
// What is undecided there need not have a reason that oracle.h knows: it is counted.
void randomly(const oracle::run &run, double seconds, const char *only)
{
    const std::time_t start = std::time(nullptr);
    long formulas = 0, most = only ? std::atol(only) : -1;
    tally t;
    for (long i = std::max(most, 0L); most < 0 || i == most; i++) {
        if (seconds > 0 ? std::difftime(std::time(nullptr), start) >= seconds : 2 * i >= run.count && !only)
            break;
        generator g(run.seed + 7919 * static_cast<std::uint64_t>(i));
        const grown f(g, i);
        const subject s(f, false);
        if (!s.error().empty()) continue;
        formulas++;
        const long before = failures;
        judge j(f, s.surface(), steepness(f, g), false, &t);
        std::vector<sgt_ray> rays;
        for (int kind = 0; kind < kinds_of_rays; kind++) {
            rays.push_back(random_ray(g, f, kind));
            j.take(rays.back(), ray_kinds[kind]);
        }
        j.batch(rays);
        if (failures == before && !only) continue;
        std::printf("    %s\n   ", f.text.c_str());
        for (const sgt_named &n : f.named) std::printf(" %s = %a", n.name, n.value);
        std::printf("\n");
    }
    std::printf("%ld random formulas, %ld rays; of both questions %ld hits, %ld misses, %ld undecided, "
                "%ld grazes; |dt|/err %.3f\n",
                formulas, t.rays, t.hits, t.misses, t.undecided, t.grazes, t.worst);
    for (const auto &r : t.reasons) std::printf("    %6ld %s\n", r.second, r.first.c_str());
}

} // namespace

int main(int argc, char **argv)
{
    const char *only = nullptr;
    bool by_hand = false, random = false;
    double seconds = 0;
    for (int i = 1; i < argc; i++) {
        if (!std::strcmp(argv[i], "--random")) random = true;
        if (!std::strcmp(argv[i], "--seconds") && i + 1 < argc) seconds = std::atof(argv[i + 1]);
        if (!std::strcmp(argv[i], "--by-hand")) by_hand = true;
        if (!std::strcmp(argv[i], "--only") && i + 1 < argc) only = argv[i + 1];
        if (!std::strcmp(argv[i], "--examples") && i + 1 < argc) examples = std::atol(argv[i + 1]);
        if (!std::strcmp(argv[i], "--list"))
            for (const auto &f : formulas()) std::printf("%-20s %s\n", f->name.c_str(), f->text.c_str());
        if (!std::strcmp(argv[i], "--list")) return 0;
    }
    const char *count = nullptr, *seed = nullptr;
    for (int i = 1; i + 1 < argc; i++) {
        if (!std::strcmp(argv[i], "--count")) count = argv[i + 1];
        if (!std::strcmp(argv[i], "--seed")) seed = argv[i + 1];
    }
    char *own[] = {argv[0], const_cast<char *>("--count"), const_cast<char *>(count),
                   const_cast<char *>("--seed"), const_cast<char *>(seed)};
    char *own_seed[] = {argv[0], const_cast<char *>("--seed"), const_cast<char *>(seed)};
    const oracle::run run = count ? oracle::run(seed ? 5 : 3, own, 200, 20261123)
                                  : oracle::run(seed ? 3 : 1, own_seed, 120, 20261123);

    if (random) {
        randomly(run, seconds, only);
        std::printf("%ld failures\n", failures);
        return failures != 0;
    }
    std::printf("%-20s %6s %6s %6s %6s %6s %8s %8s %8s  undecided and grazes by reason\n", "formula", "rays",
                "hits", "misses", "undec.", "graze", "|dt|/err", "ns", "ns proof");
    long number = 0;
    std::map<std::string, long> reasons;
    tally sum;
    for (const auto &f : formulas()) {
        number++;
        if (only && f->name != only) continue;
        const subject s(*f, by_hand);
        if (!s.error().empty()) {
            std::printf("FAIL %s: %s\n", f->name.c_str(), s.error().c_str());
            failures++;
            continue;
        }
        generator g(run.seed + 7919 * static_cast<std::uint64_t>(number));
        tally t;
        const double steep = steepness(*f, g);
        judge j(*f, s.surface(), steep, by_hand, &t);
        std::vector<sgt_ray> rays;
        for (long i = 0; i < run.count; i++) {
            const int kind = static_cast<int>(i % kinds_of_rays);
            rays.push_back(random_ray(g, *f, kind));
            j.take(rays.back(), ray_kinds[kind]);
        }
        for (const auto &p : past)
            if (f->name == p.name) rays.push_back(p.ray), j.take(p.ray, "past");
        j.batch(rays);
        std::printf("%-20s %6ld %6ld %6ld %6ld %6ld %8.3f %8.0f %8.0f ", f->name.c_str(), t.rays, t.hits,
                    t.misses, t.undecided, t.grazes, t.worst, t.nanoseconds, t.proven);
        for (const auto &r : t.reasons) {
            std::printf(" %s %ld;", r.first.c_str(), r.second);
            reasons[r.first] += r.second;
        }
        for (const auto &r : t.faults) std::printf(" FAULT %s %ld;", r.first.c_str(), r.second);
        if (!f->touches && t.spent * 100 > t.rays * 3 + 600)
            std::printf(" FAULT too often max_evals"), failures++;
        std::printf("\n");
        std::fflush(stdout);
        sum.rays += t.rays, sum.hits += t.hits, sum.misses += t.misses, sum.undecided += t.undecided;
        sum.grazes += t.grazes;
    }
    std::printf("all: %ld rays; of both questions %ld hits, %ld misses, %ld undecided, %ld grazes\n",
                sum.rays, sum.hits, sum.misses, sum.undecided, sum.grazes);
    for (const auto &r : reasons) std::printf("    %6ld %s\n", r.second, r.first.c_str());
    std::printf("%ld failures\n", failures);
    return failures != 0;
}
