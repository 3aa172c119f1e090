// SPDX-License-Identifier: MIT
// The greatest error for its bound that a climb finds, of each row of sgt_builtins: climb.h has what is
// looked for and why.  And of some surfaces at which one part of a bound has to hold alone, that random
// ones do not come near.
//
//   --limits   prints climb_limits.h: the greatest quotients found, and a fifth more
//   --table    prints the table of docs/data/climb.md
//
// The limits hold for the seed and the scale that are the default; with others a quotient above 1 alone is
// a fault.
#include "climb.h"
#include "climb_limits.h"
#include "judge.h"

#include "../oracle/levels.h"

#include <map>

using namespace catalogue;

namespace {

// The numbers of a surface that may be changed; those that are 0 stay so.
void numbers_of(const sgt_surface &s, std::vector<double *> *to)
{
    const auto add = [to](const double *x, std::size_t n) {
        for (std::size_t i = 0; i < n; i++)
            if (x[i] != 0) to->push_back(const_cast<double *>(x) + i);
    };
    const auto list = [&](const sgt_numbers &a) { add(a.x, count_of(a)); };
    const double *x = static_cast<const double *>(s.self);
    if (base_of(s)) add(x, s.ops == &sgt_q_bfs_ops ? 1 : 2);
    if (s.ops == &sgt_even_asphere_ops) add(x + 3, 8);
    if (s.ops == &sgt_odd_asphere_ops) add(x + 3, 16);
    if (s.ops == &sgt_polynomial_xy_ops) list(static_cast<const sgt_polynomial_xy *>(s.self)->a);
    if (s.ops == &sgt_chebyshev_ops) list(static_cast<const sgt_chebyshev *>(s.self)->a);
    if (s.ops == &sgt_zernike_ops) list(static_cast<const sgt_zernike *>(s.self)->a);
    if (s.ops == &sgt_q_con_ops) list(static_cast<const sgt_q_con *>(s.self)->a);
    if (s.ops == &sgt_q_bfs_ops) list(static_cast<const sgt_q_bfs *>(s.self)->a);
    if (s.ops == &sgt_grid_ops) list(static_cast<const sgt_grid *>(s.self)->z);
    if (s.ops == &sgt_toroidal_ops) add(x, 3), add(x + 4, 8);
    if (s.ops == &sgt_biconic_ops) add(x, 4);
    if (s.ops == &sgt_quadric_ops) add(x, 10);
    if (s.ops == &sgt_ellipsoid_ops || s.ops == &sgt_torus_ops) add(x, 2);
    if (s.ops == &sgt_sum_ops)
        for (std::size_t i = 0; i < static_cast<const sgt_sum *>(s.self)->count; i++)
            numbers_of(static_cast<const sgt_sum *>(s.self)->terms[i], to);
}

void measure_anew(const sgt_surface &s)
{
    if (s.ops == &sgt_grid_ops) {
        sgt_grid *grid = static_cast<sgt_grid *>(const_cast<void *>(s.self));
        if (grid->height > 0) sgt_grid_measure(grid);
    }
    if (s.ops == &sgt_sum_ops)
        for (std::size_t i = 0; i < static_cast<const sgt_sum *>(s.self)->count; i++)
            measure_anew(static_cast<const sgt_sum *>(s.self)->terms[i]);
}

struct of_catalogue : climb::subject {
    std::string type;
    specimen s;
    std::unique_ptr<formula<quad>> exact;
    mutable std::unique_ptr<formula<dual<quad, 1>>> with_slope; // once it is asked for

    explicit of_catalogue(const std::string &name) : type(name), s() {}
    sgt_surface surface() const override { return s.s; }
    quad value(quad x, quad y, quad z) const override { return (*exact)(x, y, z); }
    quad slope(quad at) const override
    {
        typedef dual<quad, 1> number;
        const auto on = [at](double o, double d) {
            number x(quad(o) + at * d);
            x.v[0] = d;
            return x;
        };
        if (!with_slope) with_slope.reset(new formula<number>(s.s));
        return (*with_slope)(on(ray.o.x, ray.d.x), on(ray.o.y, ray.d.y), on(ray.o.z, ray.d.z)).v[0];
    }
    std::vector<double *> numbers() override
    {
        std::vector<double *> all;
        numbers_of(s.s, &all);
        return all;
    }
    void changed() override
    {
        measure_anew(s.s);
        exact.reset(new formula<quad>(s.s));
        with_slope.reset();
    }
    void print() const override
    {
        print_surface(s.s);
        if (s.s.ops == &sgt_conic_ops) print_list(s.s.self, 3), std::printf("\n");
    }

    void conic(generator &g, bool flat)
    {
        s = {};
        s.type = type, s.sag = true;
        s.h = g.chance(0.5) ? g.uniform(0.5, 20) : g.log_uniform(1e-3, 1e3);
        s.rim = g.chance(0.67) ? s.h : 0;
        double c, k;
        random_base(g, s.h, &c, &k);
        if (type == "sphere") k = 0;
        if (type == "plane" || flat) c = k = 0;
        if (type == "even_asphere")
            s.s = random_departure(g, &s, type, s.h, s.h * g.log_uniform(1e-6, 0.1), false);
        else s.s = {&sgt_conic_ops, s.keep(sgt_conic{})};
        double *x = first_number(s.s);
        x[0] = c, x[1] = k, x[2] = s.rim;
    }

    // One coefficient of several, and no base, now and then.
    void one_term(generator &g)
    {
        std::vector<double *> all = numbers();
        const std::size_t base = base_of(s.s) ? static_cast<std::size_t>(
                                                    (first_number(s.s)[0] != 0) +
                                                    (s.s.ops != &sgt_q_bfs_ops && first_number(s.s)[1] != 0))
                                              : 0;
        if (all.size() <= base + 1 || s.s.ops == &sgt_grid_ops || s.s.ops == &sgt_sum_ops || !base_of(s.s))
            return;
        const std::size_t kept = base +
                                 static_cast<std::size_t>(g.below(static_cast<int>(all.size() - base)));
        const bool bare = s.s.ops != &sgt_q_bfs_ops && g.chance(0.7);
        for (std::size_t i = bare ? 0 : base; i < all.size(); i++)
            if (i != kept) *all[i] = 0;
        const double louder = type != "even_asphere" && g.chance(0.4) ? g.log_uniform(1, 1e6) : 1;
        *all[kept] *= louder; // else its rounding is nothing beside that of z and of the base
        double *norm = s.s.ops == &sgt_zernike_ops || s.s.ops == &sgt_q_con_ops ? first_number(s.s) + 3
                       : s.s.ops == &sgt_q_bfs_ops                              ? first_number(s.s) + 2
                                                                                : nullptr;
        if (norm && g.chance(0.5)) *norm = s.h;
        if (s.s.ops == &sgt_q_bfs_ops && g.chance(0.6)) // near the end of its domain
            first_number(s.s)[0] = g.sign() * (1 - g.log_uniform(1e-4, 0.2)) /
                                   std::max(s.h, static_cast<const sgt_q_bfs *>(s.s.self)->norm);
        int order = 0;
        if (s.s.ops == &sgt_zernike_ops) { // a short list: a bound has a part for every number in it
            sgt_zernike &z = *static_cast<sgt_zernike *>(const_cast<void *>(s.s.self));
            double *a = const_cast<double *>(z.a.x);
            const std::size_t few = std::min<std::size_t>(
                z.a.columns, 1 + static_cast<std::size_t>(g.below(g.chance(0.5) ? 15 : 100)));
            std::swap(a[few - 1], *all[kept]);
            z.a.columns = few;
            order = z.order == SGT_NOLL ? noll(static_cast<int>(few)).first
                                        : fringe(static_cast<int>(few)).first;
        }
        if (s.s.ops == &sgt_chebyshev_ops) {
            const sgt_numbers &a = static_cast<const sgt_chebyshev *>(s.s.self)->a;
            const std::size_t at = static_cast<std::size_t>(all[kept] - a.x);
            order = static_cast<int>(at / a.columns + at % a.columns);
        }
        of_it = order <= 2 ? climb::low : order <= 6 ? climb::medium : climb::high;
        alone = louder > 100 || bare; // its own rounding is what is seen
    }

    void draw(generator &g) override
    {
        if (type == "plane" || type == "sphere" || type == "conic" || type == "even_asphere")
            conic(g, g.chance(0.1));
        else
            s = random_specimen(g, type,
                                type == "chebyshev" || type == "q_con" || type == "q_bfs" ? g.chance(0.3)
                                                                                          : g.chance(0.03));
        size = s.h, rim = s.rim, alone = false, of_it = climb::low;
        if (g.chance(0.5)) one_term(g);
        changed();
        const catalogue::subject of(s);
        ray = random_ray(g, of, g.chance(0.3) ? ordinary : static_cast<ray_kind>(g.below(int(ray_kinds))));
        if (s.rim > 0 && g.chance(0.3)) { // through the rim
            const double about = g.uniform(0, 6.283185307179586),
                         r = s.rim * (1 + g.sign() * g.log_uniform(1e-16, 1e-13)), x = r * std::cos(about),
                         y = r * std::sin(about), z = -of.rough(x, y, 0.0);
            if (z == z) {
                const sgt_vec3 d = random_direction(g);
                const double far = s.h * g.uniform(0.5, 5);
                ray = {{x - far * d.x, y - far * d.y, z - far * d.z}, d, 0, HUGE_VAL};
            }
        }
        if (g.chance(0.2)) { // in a plane of coordinates: there one term of a bound stands alone
            const bool x = g.chance(0.5);
            (x ? ray.o.x : ray.o.y) = (x ? ray.d.x : ray.d.y) = 0;
            if (ray.d.x == 0 && ray.d.y == 0 && ray.d.z == 0) ray.d.z = 1;
        }
        const double d = std::sqrt(ray.d.x * ray.d.x + ray.d.y * ray.d.y + ray.d.z * ray.d.z);
        t_tol = s.h / d * g.log_uniform(1e-12, 0.1);
        p = random_point(g, s, of.rough, g.chance(0.3) ? 0.999 : g.chance(0.3) ? 0.3 : 0.95);
        if (s.sag && g.chance(0.3)) { // near the end of the domain, where most bounds are the greatest
            const double r = std::sqrt(p.x * p.x + p.y * p.y), by = s.h * (1 - g.log_uniform(1e-8, 1e-2)) / r;
            const double z = -of.rough(by * p.x, by * p.y, 0.0);
            if (r > 0 && z == z) p = {by * p.x, by * p.y, z};
        }
        const sgt_hit h = sgt_intersect(s.s, ray, nullptr);
        t = h.status > 0 ? h.t : 0;
        if (g.chance(0.5)) t += s.h / d * g.uniform(-1, 1);
    }
};

// A departure that is one term, of a high degree, in an aperture that is a small part of its norm: its
// rounding is then nearly the same all over the aperture, and is what is seen.
struct of_inner_part : of_catalogue {
    explicit of_inner_part(const std::string &name) : of_catalogue(name) {}
    void draw(generator &g) override
    {
        s = {};
        s.type = type, s.sag = true, s.h = size = rim = s.rim = g.log_uniform(1e-2, 1e2);
        alone = true, of_it = climb::low;
        const double norm_x = s.h * g.log_uniform(4, 1e3), norm_y = s.h * g.log_uniform(4, 1e3);
        const int most = type == "zernike" ? 231 : type == "chebyshev" ? 64 : 30;
        const std::size_t n = static_cast<std::size_t>(most / 2 + 1 + g.below(most / 2));
        std::vector<double> z(n);
        const double sign = g.sign(), size_of_it = g.log_uniform(3, 1e3);
        z[n - 1] = sign * size_of_it * s.h;
        const bool upright = type == "chebyshev" && g.chance(0.5);
        const sgt_numbers a = s.numbers(upright ? n : 1, upright ? 1 : n, z);
        const sgt_chebyshev chebyshev = {0, 0, s.rim, norm_x, norm_y, a};
        const int order = g.chance(0.5) ? SGT_NOLL : SGT_FRINGE;
        const sgt_zernike zernike = {0, 0, s.rim, norm_x, order, g.chance(0.5), a};
        if (type == "chebyshev") s.s = {&sgt_chebyshev_ops, s.keep(chebyshev)};
        if (type == "zernike") s.s = {&sgt_zernike_ops, s.keep(zernike)};
        if (type == "q_con") s.s = {&sgt_q_con_ops, s.keep(sgt_q_con{0, 0, s.rim, norm_x, a})};
        if (type == "q_bfs") s.s = {&sgt_q_bfs_ops, s.keep(sgt_q_bfs{0, s.rim, norm_x, a})};
        changed();
        const catalogue::subject of(s);
        p = random_point(g, s, of.rough, 0.95);
        const double far = s.h * g.uniform(0.1, 3), way = g.sign(); // along the axis one step is all
        ray = {{p.x, p.y, p.z - way * far}, {0, 0, way}, g.chance(0.5) ? 0 : -HUGE_VAL, HUGE_VAL};
        t = far;
    }
};

// An even asphere of a base that is nearly flat and strongly aspheric, and a departure that is steep: there
// each part of the bounds on G' and G'' has its turn to be the greatest.  And tolerances of up to its size,
// with which the first step that is proven is the last.
struct of_steep_asphere : of_catalogue {
    of_steep_asphere() : of_catalogue("even_asphere") {}
    void draw(generator &g) override
    {
        s = {};
        s.type = type, s.sag = true, s.h = size = g.log_uniform(1e-2, 1e2);
        s.rim = rim = g.chance(0.67) ? s.h : 0;
        sgt_even_asphere a = {};
        const double bent = g.sign(), flatness = g.log_uniform(1e-3, 0.9), ch = bent * flatness;
        const double e = g.chance(0.7) ? g.uniform(0.1, 0.95) : g.uniform(-1, 0.1);
        a.c = ch / s.h, a.k = e / (ch * ch) - 1, a.semi_diameter = s.rim;
        for (int terms = g.chance(0.8) ? 1 : 2; terms > 0; terms--) {
            const int i = g.below(g.chance(0.7) ? 1 : 8);
            const double sign = g.chance(0.7) ? -bent : g.sign(), slope = g.log_uniform(0.1, 7);
            a.a[i] = sign * slope / ((2 * i + 2) * std::pow(s.h, 2 * i + 1));
        }
        s.s = {&sgt_even_asphere_ops, s.keep(a)};
        changed();
        const formula<double> rough(s.s);
        const double r = s.h * std::sqrt(g.uniform(0, 1)), about = g.uniform(0, 6.283185307179586);
        const int plane = g.below(5) / 2; // of y and z, of x and z
        const double x = plane == 1 ? 0 : r * std::cos(about), y = plane == 2 ? 0 : r * std::sin(about);
        const double z = -rough(x, y, 0.0), far = s.h * g.log_uniform(1e-3, 3);
        sgt_vec3 d = random_direction(g);
        if (plane == 1) d.x = 0;
        if (plane == 2) d.y = 0;
        if (g.chance(0.8)) { // nearly in the tangent plane, or less steep, or as steep to the other side
            dual<double, 2> fx(x), fy(y);
            fx.v[0] = fy.v[1] = 1;
            const dual<double, 2> f = formula<dual<double, 2>>(s.s)(fx, fy, dual<double, 2>(z));
            const double flat = -(f.v[0] * d.x + f.v[1] * d.y);
            const double sign = g.sign(), off = g.log_uniform(1e-4, 1);
            d.z = g.chance(0.3) ? flat + sign * off : flat * g.uniform(-1, 1);
        }
        p = {x, y, z};
        ray = {{x - far * d.x, y - far * d.y, z - far * d.z}, d, g.chance(0.5) ? 0 : -HUGE_VAL, HUGE_VAL};
        if (!(z == z)) ray.o = {0, 0, -s.h}, p = {0, 0, 0};
        t_tol = s.h * g.log_uniform(1e-9, 1);
        t = far;
        pick = g.chance(0.5) ? SGT_FIRST : SGT_NEAR_SEED;
    }
};

// A corrector plate: an even asphere of no curvature, of one to three powers of any height, and rays from
// near and from afar.  Up to r^6 its result is taken where t and the point need no more (asphere/easy.h,
// SHARP ENOUGH), higher powers have other forms.
struct of_plate : of_catalogue {
    of_plate() : of_catalogue("even_asphere") {}
    void draw(generator &g) override
    {
        s = {};
        s.type = type, s.sag = true, s.h = size = g.log_uniform(1e-2, 1e2);
        s.rim = rim = g.chance(0.67) ? s.h : 0;
        sgt_even_asphere a = {};
        a.k = g.chance(0.5) ? 0 : g.uniform(-2, 1), a.semi_diameter = s.rim;
        for (int terms = 1 + g.below(3); terms > 0; terms--) {
            const int i = g.below(g.chance(0.7) ? 3 : 8);
            a.a[i] = g.sign() * g.log_uniform(1e-7, 0.3) / std::pow(s.h, 2 * i + 1);
        }
        s.s = {&sgt_even_asphere_ops, s.keep(a)};
        changed();
        const double r = s.h * std::sqrt(g.uniform(0, 1)), about = g.uniform(0, 6.283185307179586),
                     x = r * std::cos(about), y = r * std::sin(about), z = -formula<double>(s.s)(x, y, 0.0),
                     far = s.h * g.log_uniform(1e-3, 1e3);
        sgt_vec3 d = random_direction(g);
        if (g.chance(0.8)) d.z = g.sign() * (1 + std::fabs(d.z));
        p = {x, y, z};
        ray = {{x - far * d.x, y - far * d.y, z - far * d.z}, d, g.chance(0.5) ? 0 : -HUGE_VAL, HUGE_VAL};
        t_tol = s.h * g.log_uniform(1e-12, 1e-3);
        t = far;
        pick = g.chance(0.5) ? SGT_FIRST : SGT_NEAR_SEED;
    }
};

struct of_level_set : climb::subject {
    oracle::level f;
    sgt_mandelbrot m;
    bool mandelbrot;

    explicit of_level_set(bool which) : f(), m(), mandelbrot(which) {}
    sgt_surface surface() const override
    {
        return {mandelbrot ? &sgt_mandelbrot_ops : &sgt_julia_ops,
                mandelbrot ? static_cast<const void *>(&m) : &f.s};
    }
    quad value(quad x, quad y, quad z) const override { return oracle::level_value<quad>(f, x, y, z); }
    std::vector<double *> numbers() override
    {
        std::vector<double *> all;
        for (double *list : {mandelbrot ? m.at : f.s.c, f.s.at})
            for (int i = 0; i < 4; i++) all.push_back(list + i);
        return all;
    }
    void changed() override
    {
        if (mandelbrot) std::memcpy(f.s.at, m.at, sizeof m.at);
        f.s.escape = m.escape = oracle::safe_escape(f) * 1.01;
    }
    quad slope(quad at) const override
    {
        typedef oracle::dual<quad> number;
        const number f_at = oracle::level_value<number>(f, number(ray.o.x + at * ray.d.x, ray.d.x),
                                                        number(ray.o.y + at * ray.d.y, ray.d.y),
                                                        number(ray.o.z + at * ray.d.z, ray.d.z));
        return f_at.v < quad(0.999) ? f_at.d
                                    : quad(NAN); // farther out the orbit is given up at another level
    }
    void print() const override { oracle::print_level(f); }
    void draw(generator &g) override
    {
        do f = oracle::random_level(g);
        while (f.mandelbrot != mandelbrot);
        oracle::as_surface(f, &m);
        changed();
        size = 1 / oracle::axis_length(f);
        alone = f.s.iterations == 1;
        ray = oracle::random_ray(g, f);
        ray.tmax = HUGE_VAL;
        const double d = std::sqrt(ray.d.x * ray.d.x + ray.d.y * ray.d.y + ray.d.z * ray.d.z);
        t_tol = size / d * g.log_uniform(1e-12, 1e-3);
        const sgt_hit h = sgt_intersect(surface(), ray, nullptr);
        t = h.status > 0 ? h.t : 0;
        if (g.chance(0.3)) t += size / d * g.uniform(-0.1, 0.1);
        p = h.status > 0 ? h.p : oracle::random_point(g, size);
    }
};

// Restarts of a type for one of the count: those whose F is dear get fewer.
double weight_of(const std::string &type)
{
    for (const char *cheap : {"plane", "sphere", "conic", "even_asphere", "quadric", "torus", "ellipsoid"})
        if (type == cheap) return 4;
    if (type == "even_asphere, steep" || type == "even_asphere, plate") return 2;
    if (type.find(", inner part") != std::string::npos) return type[0] == 'c' ? 1 : 0.2;
    return type == "q_con" || type == "sum" ? 0.3 : type == "zernike" || type == "q_bfs" ? 0.6 : 1;
}

} // namespace

int main(int argc, char **argv)
{
    const long standard = 110;
    bool limits = false, table = false;
    for (int i = 1; i < argc; i++)
        limits = limits || !std::strcmp(argv[i], "--limits"),
        table = table || !std::strcmp(argv[i], "--table");
    const oracle::run r(1, argv, standard, 20261101);
    const bool pinned = r.seed == 20261101 && r.count == standard && !limits && !table;
    const char *only = std::getenv("SAGITTA_TEST_TYPE");
    std::vector<std::string> names;
    for (const sgt_builtin *row = sgt_builtins(); row->type; row++) names.push_back(row->type);
    if (!table) {
        names.push_back("even_asphere, steep");
        for (const char *type : {"chebyshev", "zernike", "q_con", "q_bfs"})
            names.push_back(std::string(type) + ", inner part");
        names.push_back("even_asphere, plate");
    }
    const int with_tolerance = int(climb::of_t) + int(climb::tolerant) * int(climb::angles);
    int failed = 0;
    for (const std::string &type : names) {
        if (only && type != only && type.substr(0, type.find(',')) != only) continue;
        const bool inner = type.find(", inner part") != std::string::npos;
        std::unique_ptr<climb::subject> s;
        if (type == "julia" || type == "mandelbrot") s.reset(new of_level_set(type == "mandelbrot"));
        else if (type == "even_asphere, steep") s.reset(new of_steep_asphere);
        else if (type == "even_asphere, plate") s.reset(new of_plate);
        else if (inner) s.reset(new of_inner_part(type.substr(0, type.find(','))));
        else s.reset(new of_catalogue(type));
        climb::table t;
        t.type = type;
        for (const climb_limit &l : climb_limits)
            if (type == l.type) t.limits = l.most;
        const std::uint64_t row = static_cast<std::uint64_t>(&type - names.data());
        for (int seeds = limits ? -1 : 0; seeds < (limits ? 3 : 1); seeds++) { // -1: as it is by default
            generator g(r.seed + static_cast<std::uint64_t>(std::max(seeds, 0)) * 7919 + row * 0x100000000u);
            const double count = static_cast<double>(seeds < 0 ? standard : r.count);
            const long evaluations = static_cast<long>(weight_of(type) * count * 120);
            if (!inner) climb::go(g, s.get(), evaluations, 60, &t);
            for (long i = 0; inner && i < evaluations; i++) {
                s->draw(g);
                for (int c : climb::asked_of_all)
                    if (c != with_tolerance) climb::ask(*s, c, &t), i++;
            }
        }
        if (type == "even_asphere, steep") { // a quotient above 1 is rare there, and no climb leads to it
            generator g(r.seed);
            for (long i = 0; i < 250 * r.count; i++) {
                s->draw(g);
                climb::ask(*s, with_tolerance, &t);
            }
        }
        failed += climb::judge(t, pinned);
        climb::print(t, limits, table);
    }
    return failed > 0;
}
