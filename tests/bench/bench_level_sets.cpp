// SPDX-License-Identifier: MIT
// First hits on quaternion Julia sets: what each rule of the march costs, and what it gets wrong.
//
//     build/tests/bench/bench_level_sets [--runs 5] [--width 640] [--rule WORD] > level_sets.csv
//
// Every rule answers for the same rays, those of a 640 x 480 picture (povray/camera.inc), with t and the
// gradient; the rules written by hand for every 7th of the rays, the slow ones for every 67th.  The
// certified march of sgt_intersect is the reference: t to rounding, no root before it.  It is not taken at
// its word: on one ray in 2003 quadruple precision looks for a change of sign at its t, and for none before
// it in steps of 1/1000.  A hit is
//     missed  where the reference hits and the rule does not,
//     false   where the rule hits and the reference does not,
//     late    where its t is more than 1e-6 (and its own tolerance) behind the first root and not before the
//             second: it shows another root.
// err is |t - t_ref| over the hits of both that are not late; evals is the mean of evaluations per ray.
//
// The runs of all are shuffled among each other, on one processor; ns is the median of the runs.
#include <cstdint>
#include <limits>
#include <random>
#include "level_sets.h"

namespace {

using march::Answer;

// ------------------------------------------------------------------ the rules

Answer of_hit(const sgt_hit &hit) { return { hit.status > 0, hit.t, hit.n, hit.evals }; }

Answer certified(const sgt_julia &s, const sgt_ray &ray, double t_tol)
{
    sgt_options options = {};
    options.t_tol = t_tol;
    return of_hit(sgt_intersect({ &sgt_julia_ops, &s }, ray, &options));
}

Answer fast_way(const sgt_julia &s, const sgt_ray &ray, double dt_min)
{
    sgt_options options = {};
    options.dt_min = dt_min;
    return of_hit(sgt_intersect({ &sgt_julia_ops, &s }, ray, &options));
}

// The library's march over a surface of one's own that offers F and the ball.
double own_value(const void *self, sgt_vec3 p, sgt_vec3 *grad) { return sgt_julia_ops.value(self, p, grad); }
sgt_span own_span(const void *self, const sgt_ray *ray)
{
    return march::ball(*ray, static_cast<const sgt_julia *>(self)->escape);
}

Answer own_surface(const sgt_julia &s, const sgt_ray &ray, double dt_min)
{
    static const sgt_surface_ops ops = [] {
        sgt_surface_ops made = {};
        made.name = "own";
        made.value = own_value;
        made.span = own_span;
        return made;
    }();
    sgt_options options = {};
    options.dt_min = dt_min;
    options.max_evals = 100000;
    return of_hit(sgt_intersect({ &ops, &s }, ray, &options));
}

struct Rule {
    const char *name;
    Answer (*solve)(const sgt_julia &, const sgt_ray &, double);  // NULL: POV-Ray
    double parameter;
    size_t stride;
    double tolerance;
};
const Rule RULES[] = {
    { "certified", certified, 0, 1, 0 },  // the reference: keep it first
    { "certified t_tol=1e-6", certified, 1e-6, 1, 1e-6 },
    { "certified t_tol=1e-3", certified, 1e-3, 1, 1e-3 },
    { "estimate dt_min=1e-1", fast_way, 1e-1, 1, 0 },
    { "estimate dt_min=1e-2", fast_way, 1e-2, 1, 0 },
    { "estimate dt_min=1e-3", fast_way, 1e-3, 1, 0 },
    { "estimate dt_min=1e-4", fast_way, 1e-4, 1, 0 },
    { "estimate-by-hand dt_min=1e-1", march::estimate_or_least, 1e-1, 7, 0 },
    { "estimate-by-hand dt_min=1e-2", march::estimate_or_least, 1e-2, 7, 0 },
    { "estimate-by-hand dt_min=1e-3", march::estimate_or_least, 1e-3, 7, 0 },
    { "estimate-by-hand dt_min=1e-4", march::estimate_or_least, 1e-4, 7, 0 },
    { "estimate-newton dt_min=1e-1", march::estimate_newton_or_least, 1e-1, 7, 0 },
    { "estimate-newton dt_min=1e-2", march::estimate_newton_or_least, 1e-2, 7, 0 },
    { "estimate-newton dt_min=1e-3", march::estimate_newton_or_least, 1e-3, 7, 0 },
    { "estimate-newton dt_min=1e-4", march::estimate_newton_or_least, 1e-4, 7, 0 },
    { "constant dt=1e-1", march::constant, 1e-1, 67, 0 },
    { "constant dt=1e-2", march::constant, 1e-2, 67, 0 },
    { "constant dt=1e-3", march::constant, 1e-3, 67, 0 },
    { "own-surface dt_min=1e-2", own_surface, 1e-2, 67, 0 },
    { "stop eps=1e-2", march::stop_when_near, 1e-2, 7, 0 },
    { "stop eps=1e-3", march::stop_when_near, 1e-3, 7, 0 },
    { "stop eps=1e-4", march::stop_when_near, 1e-4, 7, 0 },
    { "stop eps=1e-6", march::stop_when_near, 1e-6, 7, 0 },
    { "povray precision=20", nullptr, 20, 1, 0 },
    { "povray precision=100", nullptr, 100, 1, 0 },
    { "povray precision=500", nullptr, 500, 1, 0 },
};

// ----------------------------------------------------- the reference, checked

#ifdef __SIZEOF_FLOAT128__
__extension__ typedef __float128 quad;
#else
typedef long double quad;
#endif

struct Reference {
    sgt_hit first;
    double second;
}; // second: t of the next root, or where the undecided begins

// Is |Q_N|^2 < escape^2 on the ray at t?
bool within(const sgt_julia &s, const sgt_ray &ray, double t)
{
    quad x = ray.o.x + static_cast<quad>(t) * ray.d.x, y = ray.o.y + static_cast<quad>(t) * ray.d.y;
    quad z = ray.o.z + static_cast<quad>(t) * ray.d.z, w = 0,
         escape2 = static_cast<quad>(s.escape) * s.escape;
    for (int i = 0; i < s.iterations; i++) {
        quad x2 = x * x - y * y - z * z - w * w + s.c[0];
        y = 2 * x * y + s.c[1];
        z = 2 * x * z + s.c[2];
        w = 2 * x * w + s.c[3];
        x = x2;
        if (x * x + y * y + z * z + w * w > 1e6)  // beyond any safe escape: it stays out
            return false;
    }
    return x * x + y * y + z * z + w * w < escape2;
}

bool check_reference(const Case &one, const sgt_julia &s, const std::vector<sgt_ray> &rays,
                     const std::vector<Reference> &reference)
{
    size_t asked = 0, wrong = 0, undecided = 0;
    double worst = 0;
    for (size_t i = 0; i < rays.size(); i++) {
        undecided += reference[i].first.status < 0;
        if (reference[i].first.status > 0)
            worst = std::max(worst, reference[i].first.t_err);
        sgt_span inside = march::ball(rays[i], s.escape);
        if (i % 2003 != 0 || reference[i].first.status < 0 || !(inside.lo < inside.hi))
            continue;
        asked++;
        double end = inside.hi;
        bool right = true;
        if (reference[i].first.status == SGT_HIT) {
            double off = std::max(reference[i].first.t_err, 1e-12);
            end = reference[i].first.t - off;
            right = !within(s, rays[i], end) && within(s, rays[i], reference[i].first.t + off);
        }
        for (double t = inside.lo; t < end; t += 1e-3)
            right = right && !within(s, rays[i], t);
        wrong += !right;
    }
    std::fprintf(stderr,
                 "%s: t_err at most %.2g, %zu undecided; %zu rays asked in quadruple precision, %zu wrong\n",
                 one.name, worst, undecided, asked, wrong);
    return wrong == 0;
}

// ------------------------------------------------------------------- the rows

struct Row {
    std::vector<double> ns;
    std::vector<double> error;
    double evals;
    size_t rays, hits, missed, late, not_there;
};

// t(i), NaN for no hit, against the reference.
template <class T>
void compare(Row &row, const Rule &rule, const std::vector<Reference> &reference, T t)
{
    for (size_t i = 0; i < reference.size(); i += rule.stride) {
        row.rays++;
        if (reference[i].first.status < 0)
            continue;
        double off = t(i) - reference[i].first.t;
        row.hits += reference[i].first.status > 0;
        if (std::isnan(off)) {
            row.missed += reference[i].first.status > 0;
            row.not_there += reference[i].first.status == 0 && !std::isnan(t(i));
        } else if (off > rule.tolerance + 1e-6 && t(i) > reference[i].second - 1e-6) {
            row.late++;
        } else {
            row.error.push_back(std::fabs(off));
        }
    }
    std::sort(row.error.begin(), row.error.end());
}

double quantile(const std::vector<double> &sorted, double q)
{
    return sorted.empty() ? NONE : sorted[static_cast<size_t>(q * static_cast<double>(sorted.size() - 1))];
}

} // namespace

int main(int argc, char **argv)
{
    size_t runs = 5;
    const char *word = "";
    for (int i = 1; i + 1 < argc; i += 2) {
        if (std::strcmp(argv[i], "--runs") == 0)
            runs = static_cast<size_t>(std::max(1, std::atoi(argv[i + 1])));
        else if (std::strcmp(argv[i], "--width") == 0)
            width = std::max(4, std::atoi(argv[i + 1])), height = width * 3 / 4;
        else if (std::strcmp(argv[i], "--rule") == 0)
            word = argv[i + 1];
        else
            argc = 0;
    }
    if (argc % 2 == 0) {
        std::fprintf(stderr,
                     "usage: bench_level_sets [--runs N] [--width N] [--rule WORD] > level_sets.csv\n");
        return 2;
    }

    to_one_processor();
    const std::vector<sgt_ray> rays = camera();
    Povray povray;
    if (!povray.found)
        std::fprintf(stderr, "skipped: POV-Ray was not found\n");
    else if (!same_rays(povray, rays)) {
        std::fprintf(stderr, "skipped: this POV-Ray traces other rays\n");
        povray.found = false;
    }

    std::vector<sgt_julia> sets;
    std::vector<std::vector<Reference>> references;
    for (const Case &one : CASES) {
        sets.push_back(julia(one));
        references.push_back({});
        for (const sgt_ray &ray : rays) {
            sgt_hit hits[2];
            int n = sgt_intersect_all({ &sgt_julia_ops, &sets.back() }, ray, 2, hits, nullptr);
            references.back().push_back({ sgt_intersect({ &sgt_julia_ops, &sets.back() }, ray, nullptr),
                                          n > 1 ? hits[1].lo : std::numeric_limits<double>::infinity() });
        }
        if (!check_reference(one, sets.back(), rays, references.back()))
            return 1;
    }

    struct Run { size_t set, rule; };
    std::vector<Run> all;
    const size_t rules = sizeof RULES / sizeof RULES[0];
    std::vector<std::vector<Row>> rows(sets.size(), std::vector<Row>(rules));
    for (size_t k = 0; k < sets.size(); k++)
        for (size_t r = 0; r < rules; r++) {
            const Rule &rule = RULES[r];
            if (!std::strstr(rule.name, word) || (!rule.solve && !povray.found))
                continue;
            all.push_back({ k, r });
            Row &row = rows[k][r];
            if (rule.solve) {
                std::vector<double> t(rays.size());
                double evals = 0;
                for (size_t i = 0; i < rays.size(); i += rule.stride) {
                    Answer answer = rule.solve(sets[k], rays[i], rule.parameter);
                    t[i] = answer.hit ? answer.t : NONE;
                    evals += static_cast<double>(answer.evals);
                }
                compare(row, rule, references[k], [&](size_t i) { return t[i]; });
                row.evals = evals / static_cast<double>(row.rays);
            } else {
                std::vector<double> t = povray.depths(CASES[k].povray_c, CASES[k].iterations, rule.parameter);
                if (t.size() != rays.size())
                    return 1;
                compare(row, rule, references[k], [&](size_t i) { return t[i]; });
                row.evals = NONE;
            }
        }

    std::mt19937 random(1);
    std::vector<double> empty;
    for (size_t run = 0; run < runs; run++) {
        if (povray.found)
            empty.push_back(povray.seconds_empty());
        std::shuffle(all.begin(), all.end(), random);
        for (const Run &next : all) {
            const Rule &rule = RULES[next.rule];
            Row &row = rows[next.set][next.rule];
            double start = now(), seconds;
            if (rule.solve) {
                double sum = 0;
                for (size_t i = 0; i < rays.size(); i += rule.stride) {
                    Answer answer = rule.solve(sets[next.set], rays[i], rule.parameter);
                    sum += answer.t + answer.n.x + answer.n.y + answer.n.z;
                }
                volatile double kept = sum;  // the work is done for something
                (void)kept;
                seconds = now() - start;
            } else {
                seconds = povray.seconds(CASES[next.set], rule.parameter);
            }
            row.ns.push_back(1e9 * seconds / static_cast<double>(row.rays));
        }
    }

    std::printf("case,variant,ns,per_second,evals,rays,hits,missed,late,false,err_median,err_99,err_worst\n");
    for (size_t k = 0; k < sets.size(); k++)
        for (size_t r = 0; r < rules; r++) {
            const Row &row = rows[k][r];
            if (row.ns.empty())
                continue;
            double ns = median(row.ns);
            if (!RULES[r].solve)
                ns -= 1e9 * median(empty) / static_cast<double>(row.rays);
            std::printf("%s,%s,%.1f,%.4g,%.1f,%zu,%zu,%zu,%zu,%zu,%.2g,%.2g,%.2g\n", CASES[k].name,
                        RULES[r].name, ns, 1e9 / ns, row.evals, row.rays, row.hits, row.missed, row.late,
                        row.not_there, quantile(row.error, 0.5), quantile(row.error, 0.99),
                        quantile(row.error, 1));
        }
    return 0;
}
