// SPDX-License-Identifier: MIT
// own_surface.cpp - a surface of one's own from lambdas, by sagitta.hpp: a cube with holes.
//
//     F = x^4 - 5 x^2 + y^4 - 5 y^2 + z^4 - 5 z^2 + 11.8
//
// F and its gradient are enough to meet it.  With `span` the solver knows where it ends.  With `enclose` a
// miss is a fact and a first root can be proven: the same formula, written with intervals.
#include <sagitta/sagitta.hpp>

#include <cmath>
#include <cstdio>
#include <vector>

int main()
{
    // One formula for doubles and for intervals: of a term, and of its derivative.
    auto term = [](auto x) { return x * x * (x * x - 5.0); };
    auto slope_of = [](auto x) { return x * (4.0 * x * x - 10.0); };

    auto cube =
        sagitta::surface([=](sgt_vec3 p) { return term(p.x) + term(p.y) + term(p.z) + 11.8; })
            .gradient([=](sgt_vec3 p) { return sgt_vec3{slope_of(p.x), slope_of(p.y), slope_of(p.z)}; })
            // A term is at least -6.25.  So no coordinate is beyond 2.27, and no point beyond 3.94.
            .span([](const sgt_ray &ray) -> sgt_span {
                sgt_vec3 o = ray.o, d = ray.d;
                double a = d.x * d.x + d.y * d.y + d.z * d.z, b = o.x * d.x + o.y * d.y + o.z * d.z;
                double x = o.x - b / a * d.x, y = o.y - b / a * d.y, z = o.z - b / a * d.z;
                double half2 = (4 * 4 - (x * x + y * y + z * z)) / a;
                if (!(half2 >= 0)) return {1, -1, NAN, false};  // passes by
                return {-b / a - std::sqrt(half2), -b / a + std::sqrt(half2), NAN, false};
            })
            // No more than 8 roundings of terms that add up to less than this.
            .rounding([=](sgt_vec3 p) {
                auto size = [](double x) { return x * x * (x * x + 5); };
                return 8 * 0x1p-53 * (size(p.x) + size(p.y) + size(p.z) + 11.8);
            })
            .enclose([=](const sgt_ray &ray, sgt_interval t, sgt_interval &slope) -> sgt_interval {
                using sagitta::interval;
                interval u = t, l = ray.d.x, m = ray.d.y, n = ray.d.z;
                interval x = ray.o.x + u * l, y = ray.o.y + u * m, z = ray.o.z + u * n;
                slope = slope_of(x) * l + slope_of(y) * m + slope_of(z) * n;
                return term(x) + term(y) + term(z) + 11.8;
            })
            .name("cube");

    // One ray, with a proof that no root comes before.
    sgt_options options{};
    options.proof = SGT_PROVE_FIRST;
    sgt_ray ray = sagitta::ray({0.3, -8, 0.2}, {0.1, 1, 0.05});
    sgt_hit hit = sagitta::intersect(cube, ray, options);
    std::printf("one ray: %s at t = %.15g +- %.1g, after %d evaluations\n",
                sgt_status_text(hit.status), hit.t, hit.t_err, hit.evals);

    // Many rays, from any container.  What is not set is not wanted.
    std::vector<double> x, y, z, along(100, 1.0), none(100, 0.0), t(100);
    std::vector<sgt_status> status(100);
    for (int i = 0; i < 100; i++) x.push_back(0.06 * i - 3), y.push_back(-8), z.push_back(0.1 * (i % 7));
    sagitta::hits out;
    out.t = t, out.status = status;
    std::size_t met = sagitta::intersect(cube, {{x, y, z}, {none, along, none}, {}, {}}, out, options);
    std::size_t missed = 0;
    for (sgt_status s : status) missed += s == SGT_MISS;
    std::printf("many rays: %zu met, %zu certainly missed, of %zu\n", met, missed, t.size());
    sgt_hit alone = sagitta::intersect(cube, sagitta::ray({x[20], y[20], z[20]}, {0, 1, 0}), options);

    // Does it keep its word?
    std::vector<sgt_ray> some{ray, sagitta::ray({-7, 1, 1}, {1, 0.1, 0}),
                              sagitta::ray({2, 1, 7}, {0, 0.1, -1})};
    sgt_fault fault = sagitta::check(cube, some);
    std::printf("check: %s\n", sgt_fault_text(fault));

    return hit.status == SGT_HIT && std::fabs(hit.f) < 1e-12 && alone.status == SGT_HIT && alone.t == t[20] &&
                   met > 0 && missed > 0 && met + missed == t.size() && fault == SGT_SOUND
               ? 0
               : 1;
}
