// SPDX-License-Identifier: MIT
// Every derivative against Ceres' Jets: Newton's method runs once more, in numbers that carry their
// derivatives by the ray and by each parameter, on a formula that shares nothing with the library.
//
// From the t of sgt_intersect two steps t <- t - F(o + t d; a) / s are taken, s the slope at the hit: its
// derivatives come from those of F, and t itself is kept, since what its error does to them is not asked
// here (test_grazing).  p is o + t d.  n is the gradient of the formula by Jets whose numbers are Jets.
// Compared are the Jacobian of a single ray, and the forward product with a random change.
//
// Tolerances: PART of each derivative's own size, times |n| |d| / |s|, by which a grazing ray enlarges all
// that rounding does.  The size of a derivative by a parameter is the largest that any ray of the surface
// has: where it passes zero its terms cancel.
#include "subjects.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

constexpr double PART = 1e-13;
constexpr int RAY = 6, MOST = 24; // derivatives: o, d, parameters
typedef ceres::Jet<double, MOST> number;

// A number and its gradient by the point, both of them Jets (whose own nesting takes no doubles beside it).
struct nested {
    number f, by[3];
    explicit nested(double x = 0) : f(x), by{} {}
    explicit nested(const number &x) : f(x), by{} {}
    nested(const number &x, int i) : f(x), by{} { by[i] = number(1.0); }
    nested &operator+=(const nested &b) { return *this = *this + b; }
    nested &operator-=(const nested &b) { return *this = *this - b; }
    nested &operator*=(const nested &b) { return *this = *this * b; }
    template <class One> static nested chain(const number &f, const nested &a, const One &by_a)
    {
        return chain(f, a, by_a, a, number(0.0));
    }
    template <class One, class Other>
    static nested chain(const number &f, const nested &a, const One &by_a, const nested &b, const Other &by_b)
    {
        nested c(f);
        for (int i = 0; i < 3; i++) c.by[i] = a.by[i] * by_a + b.by[i] * by_b;
        return c;
    }
    friend nested operator+(const nested &a, const nested &b) { return chain(a.f + b.f, a, 1.0, b, 1.0); }
    friend nested operator-(const nested &a, const nested &b) { return chain(a.f - b.f, a, 1.0, b, -1.0); }
    friend nested operator*(const nested &a, const nested &b) { return chain(a.f * b.f, a, b.f, b, a.f); }
    friend nested operator/(const nested &a, const nested &b)
    {
        return chain(a.f / b.f, a, 1.0 / b.f, b, -a.f / (b.f * b.f));
    }
    friend nested operator+(double a, const nested &b) { return nested(a) + b; }
    friend nested operator-(double a, const nested &b) { return nested(a) - b; }
    friend nested operator*(double a, const nested &b) { return nested(a) * b; }
    friend nested operator+(const nested &a, double b) { return a + nested(b); }
    friend nested operator-(const nested &a, double b) { return a - nested(b); }
    friend nested operator*(const nested &a, double b) { return a * nested(b); }
    friend nested operator/(const nested &a, double b) { return a / nested(b); }
    friend nested sqrt(const nested &a)
    {
        const number root = sqrt(a.f);
        return chain(root, a, 0.5 / root);
    }
};

int failures;

struct answer { // of one ray: by Jets and by the library
    sgt_ray ray;
    sgt_hit hit;
    number t, p[3], n[3];
    std::vector<sgt_change> columns; // by o, d and each parameter
    double slope, condition;
};

double length(const sgt_vec3 &v) { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }
double part(const sgt_vec3 &v, int i) { return i == 0 ? v.x : i == 1 ? v.y : v.z; }

template <class Subject>
void by_jets(const Subject &subject, const std::vector<subjects::parameter> &parameters, answer &a)
{
    std::vector<number> of;
    for (std::size_t j = 0; j < parameters.size(); j++)
        of.push_back(number(*parameters[j].at, RAY + static_cast<int>(j)));
    const number o[3] = {number(a.ray.o.x, 0), number(a.ray.o.y, 1), number(a.ray.o.z, 2)};
    const number d[3] = {number(a.ray.d.x, 3), number(a.ray.d.y, 4), number(a.ray.d.z, 5)};
    a.t = number(a.hit.t);
    for (int step = 0; step < 2; step++) {
        for (int i = 0; i < 3; i++) a.p[i] = o[i] + a.t * d[i];
        a.t -= subject.formula(of, a.p[0], a.p[1], a.p[2]) / a.slope;
        a.t.a = a.hit.t;
    }
    for (int i = 0; i < 3; i++) a.p[i] = o[i] + a.t * d[i];
    std::vector<nested> nested_of;
    for (const number &parameter : of) nested_of.push_back(nested(parameter));
    const nested f = subject.formula(nested_of, nested(a.p[0], 0), nested(a.p[1], 1), nested(a.p[2], 2));
    for (int i = 0; i < 3; i++) a.n[i] = f.by[i];
}

void compare(const char *name, const answer &a, const char *what, int column, double ours, double jet,
             double size, double &worst)
{
    const double off = std::fabs(ours - jet) / (size * a.condition), of = off / PART;
    if (off <= PART || (ours == jet)) {
        worst = std::max(worst, of);
        return;
    }
    if (failures++ < 10)
        std::printf("FAIL %s: d%s by %d is %.17g, by Jets %.17g (size %.3g, condition %.3g)\n  ray %a %a %a  "
                    "%a %a %a\n",
                    name, what, column, ours, jet, size, a.condition, a.ray.o.x, a.ray.o.y, a.ray.o.z,
                    a.ray.d.x, a.ray.d.y, a.ray.d.z);
}

class visitor {
public:
    explicit visitor(const oracle::run &run) : g(run.seed), count(run.count) {}
    template <class Subject> void of()
    {
        long met = 0;
        double worst[3] = {0, 0, 0}, forward = 0;
        std::size_t parameters = 0;
        for (long i = 0; i < count; i++) one<Subject>(met, worst, forward, parameters);
        std::printf(
            "%-14s %zu parameters, %ld hits; worst of the tolerance: t %.3f, p %.3f, n %.3f, forward %.3f\n",
            Subject::name(), parameters, met, worst[0], worst[1], worst[2], forward);
        if (met < count * RAYS / 2) failures++, std::printf("FAIL %s: too few hits\n", Subject::name());
    }
private:
    enum { RAYS = 20 };
    template <class Subject> void one(long &met, double worst[3], double &worst_forward, std::size_t &counted)
    {
        Subject subject(g);
        const std::vector<subjects::parameter> parameters = subject.parameters();
        const sgt_surface s = subject.surface();
        counted = sgt_parameters(s);
        if (counted != parameters.size()) {
            if (failures++ < 10)
                std::printf("FAIL %s: %zu parameters, should have %zu\n", Subject::name(), counted,
                            parameters.size());
            return;
        }
        const std::size_t columns = RAY + counted;
        std::vector<answer> answers;
        for (int i = 0; i < RAYS; i++) {
            answer a;
            a.ray = subject.ray(g);
            a.hit = sgt_intersect(s, a.ray, nullptr);
            if (a.hit.status != SGT_HIT || !subject.near(a.hit.p)) continue;
            a.slope = a.hit.n.x * a.ray.d.x + a.hit.n.y * a.ray.d.y + a.hit.n.z * a.ray.d.z;
            a.condition = length(a.hit.n) * length(a.ray.d) / std::fabs(a.slope);
            if (a.condition > 1e3) continue;
            by_jets(subject, parameters, a);
            a.columns.resize(columns);
            sgt_change by_o[3];
            if (sgt_differentiate(s, &a.ray, &a.hit, by_o, counted ? a.columns.data() + RAY : nullptr) &&
                failures++ < 10)
                std::printf("FAIL %s: something is missing\n", Subject::name());
            for (int j = 0; j < 3; j++) { // by d: t times as much
                const sgt_change &c = by_o[j];
                const double t = a.hit.t;
                a.columns[static_cast<std::size_t>(j)] = c;
                a.columns[static_cast<std::size_t>(3 + j)] = {
                    t * c.t, {t * c.p.x, t * c.p.y, t * c.p.z}, {t * c.n.x, t * c.n.y, t * c.n.z}};
            }
            answers.push_back(a);
            met++;
        }
        // sizes of each column, and of all
        std::vector<double> t_size(columns), p_size(columns), n_size(columns);
        for (const answer &a : answers)
            for (std::size_t j = 0; j < columns; j++) {
                const int k = static_cast<int>(j);
                t_size[j] = std::max(t_size[j], std::fabs(a.t.v[k]));
                for (int i = 0; i < 3; i++)
                    p_size[j] = std::max(p_size[j], std::fabs(a.p[i].v[k])),
                    n_size[j] = std::max(n_size[j], std::fabs(a.n[i].v[k]));
            }
        for (const answer &a : answers) {
            for (std::size_t j = 0; j < columns; j++) {
                const int k = static_cast<int>(j);
                compare(Subject::name(), a, "t", k, a.columns[j].t, a.t.v[k], t_size[j], worst[0]);
                for (int i = 0; i < 3; i++) {
                    compare(Subject::name(), a, "p", k, part(a.columns[j].p, i), a.p[i].v[k], p_size[j],
                            worst[1]);
                    compare(Subject::name(), a, "n", k, part(a.columns[j].n, i), a.n[i].v[k], n_size[j],
                            worst[2]);
                }
            }
            product(Subject::name(), s, a, t_size, p_size, n_size, worst_forward);
        }
    }
    void product(const char *name, sgt_surface s, const answer &a, const std::vector<double> &t_size,
                 const std::vector<double> &p_size, const std::vector<double> &n_size, double &worst)
    {
        std::vector<double> change;
        for (std::size_t j = 0; j < a.columns.size(); j++)
            change.push_back(g.chance(0.2) ? 0 : g.uniform(-1, 1));
        double p[3] = {a.hit.p.x, a.hit.p.y, a.hit.p.z}, n[3] = {a.hit.n.x, a.hit.n.y, a.hit.n.z},
               t = a.hit.t, out[7];
        const double d[3] = {a.ray.d.x, a.ray.d.y, a.ray.d.z}, *c = change.data();
        const sgt_rays rays = {{d, d, d}, {d, d + 1, d + 2}, nullptr, nullptr},
                       by = {{c, c + 1, c + 2}, {c + 3, c + 4, c + 5}, nullptr, nullptr};
        sgt_hits hits = {};
        hits.t = &t;
        for (int i = 0; i < 3; i++) hits.p[i] = p + i, hits.n[i] = n + i;
        sgt_differentiate_forward(s, 1, rays, hits, by, c + RAY,
                                  {out, {out + 1, out + 2, out + 3}, {out + 4, out + 5, out + 6}});
        double jet[7] = {}, size[7] = {};
        for (std::size_t j = 0; j < a.columns.size(); j++) {
            const int k = static_cast<int>(j);
            jet[0] += a.t.v[k] * c[j], size[0] += t_size[j] * std::fabs(c[j]);
            for (int i = 0; i < 3; i++) {
                jet[1 + i] += a.p[i].v[k] * c[j], size[1 + i] += p_size[j] * std::fabs(c[j]);
                jet[4 + i] += a.n[i].v[k] * c[j], size[4 + i] += n_size[j] * std::fabs(c[j]);
            }
        }
        for (int i = 0; i < 7; i++) compare(name, a, "forward", i, out[i], jet[i], size[i], worst);
    }
    oracle::generator g;
    long count;
};

} // namespace

int main(int argc, char **argv)
{
    const oracle::run run(argc, argv, 300, 6);
    visitor visit(run);
    subjects::each_subject(visit);
    std::printf("%d failures\n", failures);
    return failures != 0;
}
