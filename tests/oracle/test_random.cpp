// SPDX-License-Identifier: MIT
// A million random rays and surfaces against quadruple precision (the default run: a hundredth), and a
// fifth as many that graze or meet a rim.  What each answer claims is checked for itself and counted by
// kind; the first of each kind are printed in hexadecimal, to be seen again with
//     test_random --replay "c k semi_diameter a[8] o d tmin tmax"
// and long runs by hand go
//     test_random --seed S --count N
#include "cases.h"
#include "quad.h"

#include <sagitta/sagitta.h>

#include <chrono>
#include <map>
#include <string>

using namespace oracle;

namespace {

struct kind {
    long count;
    bool failure;
};
std::map<std::string, kind> kinds[4]; // of conics, of aspheres; of narrow cases with either

int group(const test_case &t) { return t.asphere + 2 * t.narrow; }

const int shown_at_most = 10;

void print_hit(const char *name, const sgt_hit &h)
{
    std::printf("    %s: %s evals %d t %.17g (%a) t_err %.17g t_lo %.17g lo %.17g hi %.17g\n      p %a %a %a "
                "p_err %.17g f %.3g n %.6g %.6g %.6g\n",
                name, sgt_status_text(h.status), h.evals, h.t, h.t, h.t_err, h.t_lo, h.lo, h.hi, h.p.x, h.p.y,
                h.p.z, h.p_err, h.f, h.n.x, h.n.y, h.n.z);
}

void print_roots(const answer &a)
{
    for (const meeting &m : a.roots)
        std::printf("    root %s%s, slope %.3g, start's width %.3g\n", text(m.t()).c_str(),
                    m.edge ? " (on an edge)" : "", to_double(m.slope),
                    to_double(quad(0x1p-48) * m.spread / magnitude(m.slope)));
    for (const answer::stretch &s : a.doubtful)
        std::printf("    doubtful %s .. %s\n", text(s.lo).c_str(), text(s.hi).c_str());
    if (a.everywhere) std::printf("    the ray is in the surface\n");
}

void report(const char *name, bool failure, const test_case &t, const answer &a, const char *pick,
            const sgt_hit &h, double number = NAN)
{
    kind &k = kinds[group(t)][name];
    k.failure = failure;
    const bool undecided = h.status < 0 && h.status != SGT_INVALID; // some are allowed; seen they should be
    if (k.count++ >= (failure                                                      ? shown_at_most
                      : undecided && !t.narrow && std::string(name) == "undecided" ? 3
                                                                                   : 0))
        return;
    std::printf("%s %s (%s)", failure ? "FAIL" : "note", name, pick);
    if (number == number) std::printf(": %.3g", number);
    std::printf("\n    --replay \"");
    print_case(stdout, t);
    std::printf("\"\n");
    print_hit(pick, h);
    print_roots(a);
}

// Ratios, for quantiles.
struct sample {
    std::vector<float> v;
    double worst = 0;
    void add(double x)
    {
        v.push_back(static_cast<float>(x));
        if (!(x <= worst)) worst = x;
    }
    double quantile(double q)
    {
        if (v.empty()) return 0;
        const std::size_t i = static_cast<std::size_t>(q * double(v.size() - 1));
        std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(i), v.end());
        return v[i];
    }
    void print(const char *name)
    {
        std::printf("  %-46s %9zu  %9.3g  %9.3g  %9.3g  %9.3g\n", name, v.size(), quantile(0.5),
                    quantile(0.99), quantile(0.9999), worst);
    }
};

struct totals {
    sample t_err, t_err_graze, p_err, normal, evals, t_lo;
    long status[10] = {};
    long cases = 0, with_root = 0, undecided[2] = {}, too_close = 0, answers = 0, far = 0, fine = 0;
} total[4];

void check(const test_case &t, const surface &s, const answer &a, const char *pick, const sgt_hit &h)
{
    totals &sum = total[group(t)];
    double tmin, tmax;
    ends_of(t.ray, &tmin, &tmax);
    sum.answers++;
    sum.status[h.status + 5]++;
    sum.evals.add(h.evals);

    if (a.at_fault) {
        // on the wall at a rim even 113 bits can be too few: seen, counted, and not held against anyone
        report("the oracle is at fault: F does not vanish at its root", !t.narrow, t, a, pick, h);
        sum.too_close++;
        return;
    }
    bool some = false, close = a.gave_up;
    for (const meeting &m : a.roots) some = some || counting(m, tmin, tmax) == yes;
    for (const answer::stretch &d : a.doubtful) close = close || (d.hi >= quad(tmin) && d.lo <= quad(tmax));
    sum.too_close += close;
    sum.with_root += some;

    if (h.status == SGT_INVALID) report("valid input called invalid", true, t, a, pick, h);
    if (h.status < 0) {
        sum.undecided[*pick == 'f'] += !t.asphere || some;
        if (!t.asphere || some) report("undecided", false, t, a, pick, h);
        else report("undecided without a root (may be)", false, t, a, pick, h);
        return;
    }
    if (h.status == SGT_MISS) {
        if (some && !close) report("a miss where a root counts", true, t, a, pick, h);
        return;
    }

    // Met: at which root?
    if (!(h.t_err >= 0 && h.p_err >= 0 && std::isfinite(h.t) && std::isfinite(h.t_err) &&
          std::isfinite(h.p_err) && h.t <= tmax && h.t >= tmin)) {
        report("t, t_err or p_err makes no sense", true, t, a, pick, h);
        return;
    }
    if (in_doubt(a, h)) return; // as far as can be told
    const meeting *root = meant(a, h);
    if (!root || magnitude(root->minus(h.t)) > quad(h.t_err) + root->blur) {
        report(h.status == SGT_GRAZE ? "a graze without a root within t_err"
                                     : "a hit without a root within t_err",
               true, t, a, pick, h);
        return;
    }
    if (counting(*root, tmin, tmax) == no) report("a root that does not count", true, t, a, pick, h);
    if (*pick == 'f' && !close && passed_over(a, *root, h, tmin, tmax))
        report("not the first root", true, t, a, pick, h);

    // (half an ulp of 0 means nothing)
    const double error = to_double(magnitude(root->minus(h.t)));
    if (h.t != 0)
        (h.status == SGT_GRAZE && !t.asphere ? sum.t_err_graze : sum.t_err)
            .add(h.t_err / std::max(error, ulp(h.t) / 2));
    const quad off = magnitude(root->minus(h.t) - h.t_lo);
    if (!(off <= quad(h.t_err) + root->blur))
        report("t + t_lo is farther from the root than t_err", true, t, a, pick, h);
    if (off > magnitude(root->minus(h.t)) * (1 + quad(1e-6)) + root->blur) sum.far++;
    if (off > std::max(magnitude(root->minus(h.t)), quad(ulp(h.t) / 2)) + root->blur)
        report("t + t_lo is worse than t, by more than half an ulp of t", false, t, a, pick, h);
    if (h.t_err < 4 * to_double(root->blur)) sum.fine++;
    else sum.t_lo.add(to_double(off) / std::max(h.t_err, 1e-300));

    const vector3 p = {h.p.x, h.p.y, h.p.z}, moved = {p.x - root->p.x, p.y - root->p.y, p.z - root->p.z};
    const quad distance = norm(moved),
               blur = root->blur * norm({t.ray.d.x, t.ray.d.y, t.ray.d.z}) + norm(root->p) * quad(0x1p-108);
    if (!(distance <= quad(h.p_err) + blur))
        report("p is farther from the point than p_err", true, t, a, pick, h);
    const double coordinate = std::max({std::fabs(h.p.x), std::fabs(h.p.y), std::fabs(h.p.z)});
    if (coordinate != 0) sum.p_err.add(h.p_err / std::max(to_double(distance), ulp(coordinate) / 2));

    quad largest;
    const quad normal = normal_error(s, p, &largest);
    const double unit = ulp(to_double(largest)), ulps = normal == 0 ? 0 : to_double(normal / unit);
    // At the rim of a flat ellipsoid the wall is upright and its height small beside x and y:
    // there the doubles of x and y alone are that far from it.
    const double x = ulp(h.p.x) / 2, y = ulp(h.p.y) / 2,
                 allowed = 12 + (t.narrow ? std::hypot(x, y) / unit : 0);
    sum.normal.add(ulps / allowed * 12);
    if (!(ulps <= allowed))
        report("normal error of p over 12 ulps of the largest term", true, t, a, pick, h, ulps);
    if (!(h.lo <= h.t && h.t <= h.hi)) report("t is not in [lo, hi]", true, t, a, pick, h);
}

sgt_hit ask(const test_case &t, sgt_pick pick)
{
    sgt_conic conic;
    const sgt_surface s = as_surface(t, &conic);
    sgt_options options = {};
    options.pick = pick;
    return sgt_intersect(s, t.ray, &options);
}

} // namespace

int main(int argc, char **argv)
{
    const run r(argc, argv, 10000, 20240229);
    if (r.replay) {
        test_case t;
        if (!read_case(r.replay, &t)) return 2;
        const answer a = all_roots(surface(t.surface), t.ray);
        print_hit("first", ask(t, SGT_FIRST));
        print_hit("near-seed", ask(t, SGT_NEAR_SEED));
        print_roots(a);
        return 0;
    }
    const auto began = std::chrono::steady_clock::now();
    generator g(r.seed);
    long aimed_hits = 0, aimed = 0, past = 0, past_hits = 0;
    const long narrow = r.count / 5, sides = r.count / 2;
    for (long i = 0; i < r.count + narrow + sides; i++) {
        const test_case t = i < r.count            ? random_case(g)
                            : i < r.count + narrow ? random_narrow_case(g)
                                                   : random_side_case(g);
        const surface s(t.surface);
        const answer a = all_roots(s, t.ray);
        total[group(t)].cases++;
        const sgt_hit first = ask(t, SGT_FIRST), near_seed = ask(t, SGT_NEAR_SEED);
        check(t, s, a, "first", first);
        check(t, s, a, "near-seed", near_seed);
        if (t.narrow) continue;
        (t.aimed ? aimed : past)++;
        (t.aimed ? aimed_hits : past_hits) += first.status > 0;
    }

    int failures = 0;
    const char *names[4] = {"conics", "aspheres", "narrow: conics", "narrow: aspheres"};
    std::printf("aimed inside: %ld, of which %ld met; aimed past the edge: %ld, of which %ld met\n", aimed,
                aimed_hits, past, past_hits);
    for (int k = 0; k < 4; k++) {
        totals &sum = total[k];
        std::printf("\n%s: %ld cases, %ld answers (first, near-seed), %ld with a root that counts, %ld too "
                    "close to tell\n ",
                    names[k], sum.cases, sum.answers, sum.with_root, sum.too_close);
        for (int i = -5; i <= 2; i++)
            std::printf(" %s %ld", sgt_status_text(static_cast<sgt_status>(i)), sum.status[i + 5]);
        std::printf("\n  %-46s %9s  %9s  %9s  %9s  %9s\n", "", "number", "median", "99 %", "99.99 %",
                    "worst");
        sum.t_err.print("t_err / max(error, ulp(t)/2)");
        sum.t_err_graze.print("the same, grazes");
        sum.p_err.print("p_err / max(error, ulp(p)/2)");
        sum.t_lo.print("error of t + t_lo / t_err");
        sum.normal.print("normal error of p, ulps of the largest term");
        sum.evals.print("evaluations");
        std::printf("  t + t_lo worse than t (at all): %ld; t_err finer than the oracle can see: %ld\n",
                    sum.far, sum.fine);
        for (const auto &e : kinds[k]) {
            std::printf("  %-6s %8ld  %s\n", e.second.failure ? "FAIL" : "note", e.second.count,
                        e.first.c_str());
            if (e.second.failure) failures++;
        }
        if (double(sum.too_close) > 1e-3 * double(sum.answers) + 1)
            failures++, std::printf("  FAIL   the oracle could not tell too often\n");
        if (k > 1) continue; // grazes and rims: what is said must be right, that is all
        // Ten in a million rays, for either pick.
        const double allowed = std::max(1.0, 1e-5 * double(r.count));
        const long undecided = std::max(sum.undecided[0], sum.undecided[1]);
        if (double(undecided) > allowed)
            failures++, std::printf("  FAIL   undecided: %ld, at most %.0f allowed\n", undecided, allowed);
        if (sum.t_err.quantile(0.5) > 10 || sum.t_err.quantile(0.99) > 100)
            failures++, std::printf("  FAIL   t_err is too wide a bound\n");
    }
    std::printf("\n%.1f s; %d kinds of failure\n",
                std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(), failures);
    return failures != 0;
}
