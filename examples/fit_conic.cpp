// SPDX-License-Identifier: MIT
// fit_conic.cpp - which conic is this mirror?  Its curvature and conic constant from where rays fall on a
// screen.
//
// Rays of known position and direction are reflected by a concave mirror onto a screen inside its focus,
// and the spots are measured.  Ceres looks for the c and k whose spots are nearest to them.  For that it
// wants the derivatives of each spot by c and k: sgt_differentiate_batch has those of the point of
// incidence and of the normal there, and two lines of algebra carry them through the reflection and on to
// the screen.  Nothing is differenced and no ray is traced twice.
#include <sagitta/sensitivity.h>
#include <sagitta/surfaces.h>

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

namespace {

struct vec {
    double x, y, z;
};
vec operator+(vec a, vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
vec operator-(vec a, vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
vec operator*(double s, vec a) { return {s * a.x, s * a.y, s * a.z}; }
double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

// One array for each number of many rays.
struct arrays {
    explicit arrays(std::size_t n) : x(n), y(n), z(n) {}
    vec at(std::size_t i) const { return {x[i], y[i], z[i]}; }
    void put(std::size_t i, vec v) { x[i] = v.x, y[i] = v.y, z[i] = v.z; }
    std::vector<double> x, y, z;
};

// The test bench, in millimetres: light along +z, in three bundles, onto the mirror at z = 0; the screen
// stands before it.
constexpr double APERTURE = 100, SCREEN = -450;

class bench {
public:
    enum { C, K, PARAMETERS };

    bench() : o(0), d(0), p(0), n(0)
    {
        for (double angle : {0.0, 0.01, -0.02}) // to the axis, in radian
            for (int i = -8; i <= 8; i++)
                for (int j = -8; j <= 8; j++) {
                    const vec on = {i * APERTURE / 8, j * APERTURE / 8, 0},
                              along = {0, std::sin(angle), std::cos(angle)};
                    if (std::hypot(on.x, on.y) > APERTURE) continue;
                    add(o, on - 600 * along), add(d, along);
                }
        p = n = arrays(size());
        for (int j = 0; j < PARAMETERS; j++) t_by.emplace_back(size()), n_by.push_back(arrays(size()));
    }
    std::size_t size() const { return o.x.size(); }

    // Where the rays fall on the screen: x and y of each, and their derivatives by c and k where they are
    // wanted, two numbers for each x and y.  false: some ray does not meet such a mirror.
    bool spots(double c, double k, double *xy, double *by)
    {
        const sgt_conic conic = {c, k, 0};
        const sgt_surface mirror = {&sgt_conic_ops, &conic};
        const sgt_rays rays = {
            {o.x.data(), o.y.data(), o.z.data()}, {d.x.data(), d.y.data(), d.z.data()}, nullptr, nullptr};
        sgt_hits hits = {};
        hits.p[0] = p.x.data(), hits.p[1] = p.y.data(), hits.p[2] = p.z.data();
        hits.n[0] = n.x.data(), hits.n[1] = n.y.data(), hits.n[2] = n.z.data();
        if (sgt_intersect_batch(mirror, size(), rays, hits, nullptr) < size()) return false;

        if (by) { // lists of arrays: one array for each parameter, here c and k
            double *t[] = {t_by[C].data(), t_by[K].data()};
            double *nx[] = {n_by[C].x.data(), n_by[K].x.data()}, *ny[] = {n_by[C].y.data(), n_by[K].y.data()},
                   *nz[] = {n_by[C].z.data(), n_by[K].z.data()};
            sgt_jacobian wanted = {};
            wanted.t_by_a = t, wanted.n_by_a[0] = nx, wanted.n_by_a[1] = ny, wanted.n_by_a[2] = nz;
            sgt_differentiate_batch(mirror, size(), rays, hits, wanted);
        }
        for (std::size_t i = 0; i < size(); i++) {
            // Reflected at p, on to the screen: q = p + s r.  n has any length.
            const vec incident = d.at(i), at = p.at(i), normal = n.at(i);
            const double square = dot(normal, normal), f = 2 * dot(incident, normal) / square;
            const vec r = incident - f * normal;
            const double s = (SCREEN - at.z) / r.z;
            const vec q = at + s * r;
            xy[2 * i] = q.x, xy[2 * i + 1] = q.y;
            for (std::size_t j = 0; by && j < PARAMETERS; j++) {
                // The same two lines, differentiated.
                const vec dp = t_by[j][i] * incident, dn = n_by[j].at(i);
                const double df = 2 * (dot(incident, dn) - f * dot(normal, dn)) / square;
                const vec dr = -1.0 * (df * normal + f * dn);
                const double ds = -(dp.z + s * dr.z) / r.z;
                const vec dq = dp + s * dr + ds * r;
                by[(2 * i) * PARAMETERS + j] = dq.x, by[(2 * i + 1) * PARAMETERS + j] = dq.y;
            }
        }
        return true;
    }

private:
    static void add(arrays &to, vec v) { to.x.push_back(v.x), to.y.push_back(v.y), to.z.push_back(v.z); }
    arrays o, d, p, n;
    std::vector<std::vector<double>> t_by;
    std::vector<arrays> n_by;
};

// What Ceres asks for: the differences of the spots to those measured, in units of their error, and their
// Jacobian.
class distances : public ceres::CostFunction {
public:
  distances(bench &with, const std::vector<double> &spots, double error)
      : on(with), measured(spots), sigma(error)
  {
      set_num_residuals(static_cast<int>(spots.size()));
      mutable_parameter_block_sizes()->push_back(bench::PARAMETERS);
    }
    bool Evaluate(const double *const *parameters, double *residuals, double **jacobians) const override
    {
        double *by = jacobians ? jacobians[0] : nullptr;
        if (!on.spots(parameters[0][bench::C], parameters[0][bench::K], residuals, by)) return false;
        for (std::size_t i = 0; i < measured.size(); i++) residuals[i] = (residuals[i] - measured[i]) / sigma;
        for (std::size_t i = 0; by && i < measured.size() * bench::PARAMETERS; i++) by[i] /= sigma;
        return true;
    }
private:
    bench &on;
    const std::vector<double> &measured;
    double sigma;
};

struct found {
    double c, k, c_error, k_error, rms; // rms: what is left between the spots, length
    int steps;
};

found fit(bench &on, const std::vector<double> &measured, double sigma, double c, double k)
{
    double x[bench::PARAMETERS] = {c, k};
    ceres::Problem problem;
    problem.AddResidualBlock(new distances(on, measured, sigma), nullptr, x);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 1e-13;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);

    // How far c and k may be off by the errors of the spots.
    ceres::Covariance::Options exactly;
    exactly.algorithm_type = ceres::DENSE_SVD;
    ceres::Covariance covariance(exactly);
    double v[4] = {};
    const std::vector<std::pair<const double *, const double *>> blocks = {{x, x}};
    if (covariance.Compute(blocks, &problem)) covariance.GetCovarianceBlock(x, x, v);
    return {x[0],
            x[1],
            std::sqrt(v[0]),
            std::sqrt(v[3]),
            sigma * std::sqrt(2 * summary.final_cost / static_cast<double>(measured.size())),
            static_cast<int>(summary.iterations.size()) - 1};
}

// The largest difference between the derivatives and differences of the spots, as a part of the largest
// derivative.
double check(bench &on, double c, double k)
{
    const std::size_t n = 2 * on.size();
    std::vector<double> xy(n), by(n * bench::PARAMETERS), low(n), high(n);
    on.spots(c, k, xy.data(), by.data());
    double worst = 0;
    for (std::size_t j = 0; j < bench::PARAMETERS; j++) {
        const double h = j == bench::C ? 1e-5 * std::fabs(c) : 1e-3, hc = j == bench::C ? h : 0,
                     hk = j == bench::K ? h : 0;
        on.spots(c - hc, k - hk, low.data(), nullptr);
        on.spots(c + hc, k + hk, high.data(), nullptr);
        double off = 0, size = 0;
        for (std::size_t i = 0; i < n; i++) {
            size = std::max(size, std::fabs(by[i * bench::PARAMETERS + j]));
            off = std::max(off, std::fabs(by[i * bench::PARAMETERS + j] - (high[i] - low[i]) / (2 * h)));
        }
        worst = std::max(worst, off / size);
    }
    return worst;
}

void print(const char *what, const found &f)
{
    std::printf("%-22s %5d %16.9f %13.2g %14.9f %12.2g %14.2g\n", what, f.steps, 1 / f.c,
                f.c_error / (f.c * f.c), f.k, f.k_error, 1000 * f.rms);
}

} // namespace

int main()
{
    const double radius = -1000, c = 1 / radius,
                 k = -1.07; // a hyperboloid; concave to the light, so R is negative
    bench on;
    std::vector<double> exact(2 * on.size());
    if (!on.spots(c, k, exact.data(), nullptr)) return 1;
    std::printf("A mirror of radius %g mm and conic constant %g, by the spots of %zu rays on a screen %g mm "
                "before it.\n\n",
                radius, k, on.size(), -SCREEN);

    const double jacobian = check(on, c, k);
    std::printf("Derivatives of the spots: within %.1e of differences.\n\n", jacobian);

    std::printf("%-22s %5s %16s %13s %14s %12s %14s\n", "spots", "steps", "radius, mm", "+-",
                "conic constant", "+-", "left over, um");
    const double start_c = 1.05 * c, start_k = 0; // a sphere, and not a good one
    std::printf("%-22s %5d %16.9f %13s %14.9f\n", "(start)", 0, 1 / start_c, "", start_k);

    // Exact spots: the error of the spots is a formality.
    const found best = fit(on, exact, 1e-3, start_c, start_k);
    std::printf("%-22s %5d %16.9f %13s %14.9f %12s %14.2g\n", "exact", best.steps, 1 / best.c, "", best.k, "",
                1000 * best.rms);

    bool right = jacobian < 1e-6 && std::fabs(best.c / c - 1) < 1e-12 && std::fabs(best.k - k) < 1e-9;
    std::mt19937_64 generator(1);
    for (double sigma : {1e-4, 1e-3, 1e-2}) {
        std::normal_distribution<double> error(0, sigma);
        std::vector<double> measured = exact;
        for (double &x : measured) x += error(generator);
        const found f = fit(on, measured, sigma, start_c, start_k);
        char what[40];
        std::snprintf(what, sizeof what, "off by %g um", 1000 * sigma);
        print(what, f);
        right = right && std::fabs(f.c - c) < 5 * f.c_error && std::fabs(f.k - k) < 5 * f.k_error &&
                f.rms < 1.2 * sigma;
    }
    std::printf("\n%s\n",
                right ? "Each is the mirror, within 5 standard deviations." : "That is not the mirror.");
    return right ? 0 : 1;
}
