// Rays on which published programs have failed: the first root, or the miss, and then
// each root in its turn, from the one before.  The roots have 30 digits, no more.
#include "table.h"

#include <sagitta/sagitta.h>

#include <algorithm>

using namespace oracle;

static int failures;

static void fail(const hard_case &c, const char *how, const char *why, const sgt_hit &h)
{
    failures++;
    std::printf("FAIL %s %s: %s; %s t %.17g t_err %.3g evals %d\n", c.id.c_str(), how, why, sgt_status_text(h.status), h.t, h.t_err, h.evals);
}

static void walk(const hard_case &c, const char *how, sgt_surface s, bool asphere)
{
    sgt_ray ray = c.ray;
    double before = -HUGE_VAL;
    for (const decimal &root : c.roots) {
        const sgt_hit h = sgt_intersect(s, ray, nullptr);
        if (!(h.status > 0)) return fail(c, how, "not met", h);
        if (!(std::fabs(root.minus(h.t)) <= h.t_err + 1e-29 * std::fabs(root.hi))) return fail(c, how, "not the first root, or t_err is no bound", h);
        if (!(h.t_err <= 1e-6 * std::max(1.0, std::fabs(h.t)))) return fail(c, how, "t_err is large", h);
        if (!(h.t > before)) return fail(c, how, "no progress", h);
        before = ray.tmin = h.t; // the next one, from here
    }
    const sgt_hit h = sgt_intersect(s, ray, nullptr);
    if (h.status == SGT_MISS || (asphere && h.status < 0 && h.status != SGT_INVALID)) return; // a missed asphere needs a proof
    fail(c, how, c.roots.empty() ? "a miss is wanted" : "a root after the last", h);
}

int main(int argc, char **argv)
{
    if (argc < 2) return std::printf("usage: test_hard FOLDER-OF-DATA\n"), 2;
    const std::vector<hard_case> cases = hard_cases(argv[1]);
    for (const hard_case &c : cases) {
        sgt_asphere a = c.surface;
        sgt_conic k = {a.c, a.k, a.semi_diameter};
        const bool terms = has_terms(a);
        if (!terms) walk(c, "as conic", sgt_surface{&sgt_conic_ops, &k}, false);
        walk(c, "as asphere", sgt_surface{&sgt_asphere_ops, &a}, terms);
        if (a.semi_diameter > 0) {
            a.semi_diameter = 0;
            walk(c, "without its rim", sgt_surface{&sgt_asphere_ops, &a}, terms);
        }
    }
    std::printf("%zu cases, %d failures\n", cases.size(), failures);
    return failures != 0;
}
