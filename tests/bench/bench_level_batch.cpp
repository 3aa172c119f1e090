// SPDX-License-Identifier: MIT
// First hits on a quaternion Julia set, proven, with t and the gradient: one ray at a time, many at once,
// and POV-Ray.
//
//     build/tests/bench/bench_level_batch [--runs 5] [--width 640]
//
// The set is c = (-0.083, 0, -0.83, -0.025), N = 7; the rays are those of a 640 x 480 picture
// (level_sets.h).  Before anything is timed every number of the batch is compared with the single ray's,
// bit for bit.  The runs of all are shuffled among each other, on one processor; ns is the median of the
// runs, `ratio` how many times faster the batch is.  Then the batch with a tolerance, on this set and two
// more; there `ratio` is to the batch of the same set without one.  The rival in speed is a distance march
// in single precision (float_march.c), t alone, its `ratio` to the batch without a tolerance: `wrong` are
// the hits that it misses and those it shows where there is none, by the hits there are; err_99 is |t -
// t_ref| that 99 % of its other hits do not exceed.  levels is how many levels of the orbit a ray takes in
// the batch, the gradient's among them; busy the share of the lanes' levels that were spent on cells not
// decided yet (level_counts.c).
#include <random>
#include "float_march.h"
#include "level_counts.h"
#include "level_sets.h"

namespace {

struct Arrays {
    std::vector<double> numbers;
    size_t n;
    double *at(size_t i) { return numbers.data() + i * n; }
};

bool same(double a, double b)
{
    return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b));
}

struct Row { const char *name; int povray; std::vector<double> ns; };  // povray: its precision, or 0

const Case LOOSE[] = { CASES[0], CASES[1], { "i-N16", { 0, 1, 0, 0 }, 16, 0 } };
const double TOLERANCES[] = { 0, 1e-1, 1e-2, 1e-3, 1e-6 };

void print_row(const char *set, const char *name, double ns, double batch, double evals,
               const level_counts &counts, size_t n)
{
    double levels = static_cast<double>(counts.levels), lanes = static_cast<double>(counts.lanes);
    std::printf("%s,%s,%.1f,%.4g,%.2f,%.2f,%.1f,%.3f,%lld,,\n", set, name, ns, 1e9 / ns, ns / batch, evals,
                levels / static_cast<double>(n), levels / lanes, counts.hard);
}

// The march in single precision beside the batch, in the same runs.
void float_rows(const std::vector<sgt_ray> &rays, const sgt_rays &many, const sgt_hits &hits, size_t runs)
{
    static const float EPS[] = { 1e-2F, 1e-3F, 1e-4F };
    const size_t n = rays.size(), count = sizeof EPS / sizeof EPS[0];
    std::vector<float> in(6 * n), t(n);
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++) {
            in[k * n + i] = static_cast<float>(many.o[k][i]);
            in[(3 + k) * n + i] = static_cast<float>(many.d[k][i]);
        }
    const float *const o[3] = {&in[0], &in[n], &in[2 * n]}, *const d[3] = {&in[3 * n], &in[4 * n],
                                                                           &in[5 * n]};
    for (const Case &one : LOOSE) {
        const sgt_julia set = julia(one);
        std::vector<std::vector<double>> ns(count);
        std::vector<double> batch;
        for (size_t run = 0; run < runs; run++)
            for (size_t k = 0; k <= count; k++) {
                double start = now();
                if (k < count)
                    float_march(&set, n, o, d, EPS[k], t.data());
                else
                    sgt_intersect_batch({ &sgt_julia_ops, &set }, n, many, hits, nullptr);
                (k < count ? ns[k] : batch).push_back(1e9 * (now() - start) / static_cast<double>(n));
            }
        for (size_t k = 0; k < count; k++) {
            float_march(&set, n, o, d, EPS[k], t.data());
            size_t wrong = 0, met = 0;
            std::vector<double> error;
            for (size_t i = 0; i < n; i++) {
                bool hit = hits.status[i] > 0, shown = !std::isnan(t[i]);
                double off = std::fabs(static_cast<double>(t[i]) - hits.t[i]);
                met += hit;
                if (hit != shown)
                    wrong++;
                else if (hit)
                    error.push_back(off);
            }
            std::sort(error.begin(), error.end());
            double of = median(ns[k]), least = error.empty() ? march::NONE : error[error.size() * 99 / 100];
            std::printf("%s,float march eps=%g,%.1f,%.4g,%.2f,,,,,%.4f,%.2g\n", one.name,
                        static_cast<double>(EPS[k]), of, 1e9 / of, of / median(batch),
                        static_cast<double>(wrong) / static_cast<double>(met), least);
        }
    }
}

// The batch with each of the tolerances.
void with_tolerances(size_t n, const sgt_rays &many, const sgt_hits &hits, size_t runs)
{
    const size_t count = sizeof TOLERANCES / sizeof TOLERANCES[0];
    std::mt19937 random(2);
    for (const Case &one : LOOSE) {
        const sgt_julia set = julia(one);
        std::vector<std::vector<double>> ns(count);
        std::vector<double> evals(count);
        std::vector<size_t> order;
        for (size_t k = 0; k < count; k++)
            order.push_back(k);
        for (size_t run = 0; run < runs; run++) {
            std::shuffle(order.begin(), order.end(), random);
            for (size_t k : order) {
                sgt_options options = {};
                options.t_tol = TOLERANCES[k];
                double start = now(), sum = 0;
                sgt_intersect_batch({ &sgt_julia_ops, &set }, n, many, hits, &options);
                ns[k].push_back(1e9 * (now() - start) / static_cast<double>(n));
                for (size_t i = 0; i < n; i++)
                    sum += hits.evals[i];
                evals[k] = sum / static_cast<double>(n);
            }
        }
        for (size_t k = 0; k < count; k++) {
            char name[32];
            std::snprintf(name, sizeof name, "batch t_tol=%g", TOLERANCES[k]);
            print_row(one.name, name, median(ns[k]), median(ns[0]), evals[k],
                      level_counts_of(&set, n, many.o, many.d, 1024, TOLERANCES[k]), n);
        }
    }
}

} // namespace

int main(int argc, char **argv)
{
    size_t runs = 5;
    for (int i = 1; i + 1 < argc; i += 2) {
        if (std::strcmp(argv[i], "--runs") == 0)
            runs = static_cast<size_t>(std::max(1, std::atoi(argv[i + 1])));
        else if (std::strcmp(argv[i], "--width") == 0)
            width = std::max(4, std::atoi(argv[i + 1])), height = width * 3 / 4;
        else
            argc = 0;
    }
    if (argc % 2 == 0) {
        std::fprintf(stderr, "usage: bench_level_batch [--runs N] [--width N] > level_batch.csv\n");
        return 2;
    }
    to_one_processor();

    const std::vector<sgt_ray> rays = camera();
    const sgt_julia set = julia(CASES[0]);
    const sgt_surface surface = { &sgt_julia_ops, &set };
    const size_t n = rays.size();
    Arrays in = { std::vector<double>(6 * n), n }, out = { std::vector<double>(10 * n), n };
    std::vector<sgt_status> status(n);
    std::vector<int> evals(n);
    for (size_t i = 0; i < n; i++) {
        const double numbers[6] = {rays[i].o.x, rays[i].o.y, rays[i].o.z,
                                   rays[i].d.x, rays[i].d.y, rays[i].d.z};
        for (size_t k = 0; k < 6; k++)
            in.at(k)[i] = numbers[k];
    }
    const sgt_rays many = {{in.at(0), in.at(1), in.at(2)}, {in.at(3), in.at(4), in.at(5)}, nullptr, nullptr};
    const sgt_hits hits = {status.data(),
                           evals.data(),
                           out.at(0),
                           out.at(1),
                           out.at(2),
                           {out.at(3), out.at(4), out.at(5)},
                           {out.at(6), out.at(7), out.at(8)},
                           out.at(9),
                           {}};
    sgt_intersect_batch(surface, n, many, hits, nullptr);
    size_t others = 0;
    double evaluations = 0;
    for (size_t i = 0; i < n; i++) {
        const sgt_hit hit = sgt_intersect(surface, rays[i], nullptr);
        const double numbers[10] = {hit.t,   hit.t_err, hit.t_lo, hit.p.x, hit.p.y,
                                    hit.p.z, hit.n.x,   hit.n.y,  hit.n.z, hit.p_err};
        bool alike = hit.status == status[i] && hit.evals == evals[i];
        for (size_t k = 0; k < 10; k++)
            alike = alike && same(numbers[k], out.at(k)[i]);
        others += !alike;
        evaluations += hit.evals;
    }
    if (others) {
        std::fprintf(stderr, "%zu of %zu rays are not those of the single ray\n", others, n);
        return 1;
    }
    const level_counts counts = level_counts_of(&set, n, many.o, many.d, 1024, 0);

    Povray povray;
    if (!povray.found)
        std::fprintf(stderr, "skipped: POV-Ray was not found\n");
    else if (!same_rays(povray, rays)) {
        std::fprintf(stderr, "skipped: this POV-Ray traces other rays\n");
        povray.found = false;
    }
    std::vector<Row> rows = { { "batch", 0, {} }, { "single", 0, {} } };
    if (povray.found) {
        rows.push_back({ "povray precision=20", 20, {} });
        rows.push_back({ "povray precision=500", 500, {} });
    }
    std::mt19937 random(1);
    std::vector<size_t> order;
    for (size_t k = 0; k < rows.size(); k++)
        order.push_back(k);
    std::vector<double> empty;
    for (size_t run = 0; run < runs; run++) {
        if (povray.found)
            empty.push_back(povray.seconds_empty());
        std::shuffle(order.begin(), order.end(), random);
        for (size_t k : order) {
            double start = now(), seconds, sum = 0;
            if (rows[k].povray) {
                seconds = povray.seconds(CASES[0], rows[k].povray);
            } else {
                if (k == 0)
                    sgt_intersect_batch(surface, n, many, hits, nullptr);
                for (size_t i = 0; k == 1 && i < n; i++) {
                    const sgt_hit hit = sgt_intersect(surface, rays[i], nullptr);
                    sum += hit.t + hit.n.x + hit.n.y + hit.n.z;
                }
                volatile double kept = sum;  // the work is done for something
                (void)kept;
                seconds = now() - start;
            }
            rows[k].ns.push_back(1e9 * seconds / static_cast<double>(n));
        }
    }
    std::printf("case,variant,ns,per_second,ratio,evals,levels,busy,hard,wrong,err_99\n");
    double batch = median(rows[0].ns);
    for (const Row &row : rows) {
        double ns = median(row.ns) - (row.povray ? 1e9 * median(empty) / static_cast<double>(n) : 0);
        if (&row == &rows[0]) {
            print_row(CASES[0].name, row.name, ns, batch, evaluations / static_cast<double>(n), counts, n);
            continue;
        }
        std::printf("%s,%s,%.1f,%.4g,%.2f", CASES[0].name, row.name, ns, 1e9 / ns, ns / batch);
        if (row.povray)
            std::printf(",,,,,,\n");
        else
            std::printf(",%.2f,,,,,\n", evaluations / static_cast<double>(n));
    }
    with_tolerances(n, many, hits, runs);
    float_rows(rays, many, hits, runs);
    return 0;
}
