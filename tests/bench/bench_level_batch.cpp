// First hits on a quaternion Julia set, proven, with t and the gradient: one ray at a time, many at once, and POV-Ray.
//
//     build/tests/bench/bench_level_batch [--runs 5] [--width 640]
//
// The set is c = (-0.083, 0, -0.83, -0.025), N = 7; the rays are those of a 640 x 480 picture (level_sets.h).  Before
// anything is timed every number of the batch is compared with the single ray's, bit for bit.  The runs of all are shuffled
// among each other, on one processor; ns is the median of the runs, `ratio` how many times faster the batch is.
// levels is how many levels of the orbit a ray takes in the batch, the gradient's among them; busy the share of the lanes'
// levels that were spent on cells not decided yet (level_counts.c).
#include <random>
#include "level_counts.h"
#include "level_sets.h"

namespace {

struct Arrays {
    std::vector<double> numbers;
    size_t n;
    double *at(size_t i) { return numbers.data() + i * n; }
};

bool same(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0 || (std::isnan(a) && std::isnan(b)); }

struct Row { const char *name; int povray; std::vector<double> ns; };  // povray: its precision, or 0

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
    std::vector<signed char> status(n);
    std::vector<int> evals(n);
    for (size_t i = 0; i < n; i++) {
        const double numbers[6] = { rays[i].o.x, rays[i].o.y, rays[i].o.z, rays[i].d.x, rays[i].d.y, rays[i].d.z };
        for (size_t k = 0; k < 6; k++)
            in.at(k)[i] = numbers[k];
    }
    const sgt_rays many = { { in.at(0), in.at(1), in.at(2) }, { in.at(3), in.at(4), in.at(5) }, nullptr, nullptr };
    const sgt_hits hits = { status.data(), evals.data(), out.at(0), out.at(1), out.at(2), { out.at(3), out.at(4), out.at(5) },
                            { out.at(6), out.at(7), out.at(8) }, out.at(9) };
    sgt_intersect_batch(surface, n, many, hits, nullptr);
    size_t others = 0;
    double evaluations = 0;
    for (size_t i = 0; i < n; i++) {
        const sgt_hit hit = sgt_intersect(surface, rays[i], nullptr);
        const double numbers[10] = { hit.t, hit.t_err, hit.t_lo, hit.p.x, hit.p.y, hit.p.z, hit.n.x, hit.n.y, hit.n.z, hit.p_err };
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
    const double *const o[3] = { in.at(0), in.at(1), in.at(2) }, *const d[3] = { in.at(3), in.at(4), in.at(5) };
    const level_counts counts = level_counts_of(&set, n, o, d, 1024);

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
    std::printf("case,variant,ns,per_second,ratio,evals,levels,busy,hard\n");
    double batch = median(rows[0].ns);
    for (const Row &row : rows) {
        double ns = median(row.ns) - (row.povray ? 1e9 * median(empty) / static_cast<double>(n) : 0);
        std::printf("%s,%s,%.1f,%.4g,%.2f", CASES[0].name, row.name, ns, 1e9 / ns, ns / batch);
        if (row.povray)
            std::printf(",,,,\n");
        else if (&row == &rows[0])
            std::printf(",%.2f,%.1f,%.3f,%lld\n", evaluations / static_cast<double>(n), static_cast<double>(counts.levels) / static_cast<double>(n),
                        static_cast<double>(counts.levels) / static_cast<double>(counts.lanes), counts.hard);
        else
            std::printf(",%.2f,,,\n", evaluations / static_cast<double>(n));
    }
    return 0;
}
