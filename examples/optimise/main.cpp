// SPDX-License-Identifier: MIT
// main.cpp - optimise LENS: a lens is brought back from poor starts, by Ceres.
//
// Radii and thicknesses of the lens file may vary within bounds; the glass stays.  What is made small are the
// residuals of the RMS spot (sagitta/figure.h), and beside them one more: the focal length shall be that of
// the lens.  Each is a cost function whose derivatives the library has: a Jacobian is one trace of the rays,
// and one sweep back.  The same by differences of residuals, as Ceres takes them where it knows no
// derivatives, traces the rays once for each variable.
//
// A start is the lens with every variable moved at random, all by the same share of theirs at most, so far
// that its RMS spot is ten times as large.
//
//     optimise double_gauss.yaml [STARTS]
#include <sagitta/figure.h>

#include <ceres/ceres.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace
{

constexpr double TIMES_WORSE = 10, FOCAL_WEIGHT = 0.1; // of a length of focal length, beside a length of spot
constexpr std::size_t RINGS = 4;                       // of rays over the pupil

[[noreturn]] void fail(const sgt_error &e)
{
    std::fprintf(stderr, "optimise: %s: %s\n", e.key, e.words);
    std::exit(2);
}

// A figure of a lens, as Ceres takes a function, and what it has cost.
class figure
{
  public:
    figure(const sgt_lens *lens, sgt_figure_kind kind, const std::vector<const char *> &paths)
    {
        sgt_study_options study = {};
        sgt_figure_options opt = {};
        sgt_error e = {};
        opt.kind = kind;
        if (kind == SGT_FIGURE_SPOT) study.rays = RINGS, study.open = true;
        of = sgt_figure_new(lens, &study, &opt, paths.size(), paths.data(), &e);
        if (!of) fail(e);
    }
    figure(const figure &) = delete;
    ~figure() { sgt_figure_free(of); }

    std::size_t residuals() const { return sgt_figure_size(of).residuals; }
    // false: there is no such lens, or rays are lost in it.
    bool at(const double *x, double *residual, double *jacobian)
    {
        sgt_figure_out out = {};
        out.residual = residual, out.jacobian = jacobian;
        const bool fine = sgt_figure_eval(of, x, &out, nullptr);
        rays += out.rays, traces++;
        return fine && out.lost == 0;
    }
    // The last of its values: of a spot, the rms of all fields; of a focal length, that.
    double value(const double *x)
    {
        std::vector<double> all(sgt_figure_size(of).values);
        sgt_figure_out out = {};
        out.value = all.data();
        return sgt_figure_eval(of, x, &out, nullptr) && out.lost == 0 ? all.back() : HUGE_VAL;
    }
    std::size_t rays = 0, traces = 0;

  private:
    sgt_figure *of;
};

// weight * (residual - wanted), with the derivatives of the library.
class cost : public ceres::CostFunction
{
  public:
    cost(figure &f, std::size_t variables, double by, double less) : of(f), weight(by), wanted(less)
    {
        set_num_residuals(static_cast<int>(f.residuals()));
        mutable_parameter_block_sizes()->push_back(static_cast<int>(variables));
    }
    bool Evaluate(const double *const *x, double *residual, double **jacobian) const override
    {
        double *by = jacobian ? jacobian[0] : nullptr;
        if (!of.at(x[0], residual, by)) return false;
        const std::size_t n = of.residuals(), columns = static_cast<std::size_t>(parameter_block_sizes()[0]);
        for (std::size_t i = 0; i < n; i++) residual[i] = weight * (residual[i] - wanted);
        for (std::size_t i = 0; by && i < n * columns; i++) by[i] *= weight;
        return true;
    }

  private:
    figure &of;
    double weight, wanted;
};

// The same by differences: Ceres calls it once more for each variable.
struct plain {
    figure &of;
    double weight, wanted;
    bool operator()(const double *const *x, double *residual) const
    {
        if (!of.at(x[0], residual, nullptr)) return false;
        for (std::size_t i = 0; i < of.residuals(); i++) residual[i] = weight * (residual[i] - wanted);
        return true;
    }
};

ceres::CostFunction *by_differences(figure &f, std::size_t variables, double weight, double wanted)
{
    auto *made =
        new ceres::DynamicNumericDiffCostFunction<plain, ceres::FORWARD>(new plain{f, weight, wanted});
    made->AddParameterBlock(static_cast<int>(variables));
    made->SetNumResiduals(static_cast<int>(f.residuals()));
    return made;
}

struct variables {
    std::vector<std::string> path;
    std::vector<double> x, low, high;
};

bool ends_with(const std::string &text, const char *end)
{
    const std::string tail(end);
    return text.size() >= tail.size() && text.compare(text.size() - tail.size(), tail.size(), tail) == 0;
}

// Radii within 0.6 and 1.6 times, thicknesses within 0.7 and 1.3 times and 0.3 more, and 0.3 at least.
variables variables_of(const sgt_lens *lens)
{
    std::vector<sgt_lens_path> all(sgt_lens_paths(lens, 0, nullptr));
    sgt_lens_paths(lens, all.size(), all.data());
    variables v;
    for (const sgt_lens_path &p : all) {
        const bool radius = ends_with(p.path, "].radius"), thickness = ends_with(p.path, "].thickness");
        if (!(radius || thickness) || !std::isfinite(p.value)) continue;
        const double a = radius ? 0.6 * p.value : std::max(0.3, 0.7 * p.value),
                     b = radius ? 1.6 * p.value : 1.3 * p.value + 0.3;
        v.path.emplace_back(p.path), v.x.push_back(p.value);
        v.low.push_back(std::min(a, b)), v.high.push_back(std::max(a, b));
    }
    return v;
}

std::vector<double> start_of(unsigned number, const variables &v, figure &spot, double rms)
{
    std::mt19937_64 random(number);
    std::vector<double> way, x = v.x;
    for (std::size_t i = 0; i < v.x.size(); i++)
        way.push_back(static_cast<double>(random() >> 11) * 0x1p-52 - 1); // the same on every system
    for (double share = 5e-4; spot.value(x.data()) < TIMES_WORSE * rms; share *= 1.1)
        for (std::size_t i = 0; i < x.size(); i++)
            x[i] = std::clamp(v.x[i] * (1 + share * way[i]), v.low[i], v.high[i]);
    return x;
}

void solve(const variables &v, std::vector<double> &x, figure &spot, figure &focal, double f, bool analytic)
{
    ceres::Problem problem;
    const std::size_t n = x.size();
    problem.AddParameterBlock(x.data(), static_cast<int>(n));
    for (int i = 0; i < static_cast<int>(n); i++) {
        problem.SetParameterLowerBound(x.data(), i, v.low[static_cast<std::size_t>(i)]);
        problem.SetParameterUpperBound(x.data(), i, v.high[static_cast<std::size_t>(i)]);
    }
    if (analytic) {
        problem.AddResidualBlock(new cost(spot, n, 1, 0), nullptr, x.data());
        problem.AddResidualBlock(new cost(focal, n, FOCAL_WEIGHT, f), nullptr, x.data());
    } else {
        problem.AddResidualBlock(by_differences(spot, n, 1, 0), nullptr, x.data());
        problem.AddResidualBlock(by_differences(focal, n, FOCAL_WEIGHT, f), nullptr, x.data());
    }
    ceres::Solver::Options options;
    options.max_num_iterations = 100;
    options.linear_solver_type = ceres::DENSE_QR;
    options.use_nonmonotonic_steps = true; // bounds are in the way of a straight descent
    options.function_tolerance = 1e-4;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
}

} // namespace

int main(int count, char **argument)
{
    if (count < 2) return std::fprintf(stderr, "optimise LENS [STARTS]\n"), 2;
    google::InitGoogleLogging(argument[0]);
    FLAGS_minloglevel = 3; // a step into a lens that is none is no news
    sgt_error e = {};
    const std::unique_ptr<sgt_lens, void (*)(sgt_lens *)> lens(sgt_lens_read(argument[1], nullptr, &e),
                                                               sgt_lens_free);
    if (!lens) fail(e);
    const variables v = variables_of(lens.get());
    std::vector<const char *> paths;
    for (const std::string &p : v.path) paths.push_back(p.c_str());

    const int starts = count > 2 ? std::atoi(argument[2]) : 5;
    figure spot(lens.get(), SGT_FIGURE_SPOT, paths), focal(lens.get(), SGT_FIGURE_EFL, paths);
    const double rms = spot.value(v.x.data()), f = focal.value(v.x.data());
    std::printf("%s: %zu variables, %zu residuals, rms spot %.5f, focal length %.2f\n\n", lens->name,
                v.x.size(), spot.residuals() + 1, rms, f);
    std::printf("start  derivatives      before     after  RMS / original  focal length  traces      rays"
                "  seconds\n");
    bool well = true;
    for (int i = 1; i <= starts; i++)
        for (bool analytic : {true, false}) {
            std::vector<double> x = start_of(static_cast<unsigned>(i), v, spot, rms);
            const double before = spot.value(x.data());
            spot.rays = spot.traces = 0;
            const auto begun = std::chrono::steady_clock::now();
            solve(v, x, spot, focal, f, analytic);
            const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begun;
            const double after = spot.value(x.data());
            well = well && after <= 1.05 * rms;
            std::printf("%5d  %-12s %10.5f %9.5f %15.3f %13.3f %7zu %9zu %8.2f\n", i,
                        analytic ? "exact" : "differences", before, after, after / rms, focal.value(x.data()),
                        spot.traces, spot.rays, seconds.count());
        }
    std::printf("\n%s\n", well ? "all come back" : "not all come back");
    return well ? 0 : 1;
}
