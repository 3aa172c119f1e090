// SPDX-License-Identifier: MIT
// What surfaces of the catalogue owe whatever their numbers are.
//
//   sound        sgt_check finds no fault in random surfaces of each row;
//   bad numbers  a NaN or an infinity anywhere, a normalisation that is not above 0, a list too long, a
//     grid with a hole ... are
//                SGT_INVALID alone, in a batch and of all roots, and the row's `object` names the parameter;
//   identities   one polynomial as XY, Chebyshev, Zernike of both orders, Q or even asphere is one surface;
//                a biconic of equal
//                radii is the conic, a toroid the cylinder or the sphere, an ellipsoid the quadric, a grid
//                  of a quadratic that quadratic;
//                a surface and a ray upside down meet where they did.
#include "judge.h"

#include <sagitta/diagnose.h>
#include <sagitta/system.h>

using namespace catalogue;

namespace {

std::map<std::string, long> failed, counted;

void print_ray(const sgt_ray &r)
{
    std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}, %a, %a}\n", r.o.x, r.o.y, r.o.z, r.d.x, r.d.y, r.d.z,
                r.tmin, r.tmax);
}

// ------------------------------------------------------------------------ sound

double length_of(const sgt_vec3 &d) { return std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z); }

void sound(generator &g, const char *type)
{
    const specimen s = random_specimen(g, type, g.chance(0.1));
    const subject of(s);
    sgt_ray rays[6];
    for (sgt_ray &r : rays) r = random_ray(g, of, static_cast<ray_kind>(g.below(ray_kinds)));
    for (sgt_ray &r : rays) // differences far away step over what is near the axis
        if (!s.sag && s.type == "torus")
            r.tmin = std::max(r.tmin, -20 * s.h / length_of(r.d)),
            r.tmax = std::max(r.tmin, std::min(r.tmax, 20 * s.h / length_of(r.d)));
    sgt_vec3 where = {0, 0, 0};
    const sgt_fault fault = sgt_check(s.s, 6, rays, &where);
    if (fault == SGT_SOUND || failed[std::string(type) + ": " + sgt_fault_text(fault)]++ >= 2) return;
    std::printf("FAIL %s: %s at %a %a %a\n", type, sgt_fault_text(fault), where.x, where.y, where.z);
    print_surface(s.s);
    for (const sgt_ray &r : rays) {
        sgt_vec3 at;
        if (sgt_check(s.s, 1, &r, &at) != SGT_SOUND) print_ray(r);
    }
    std::fflush(stdout);
}

// ------------------------------------------------------------------- bad numbers

const sgt_builtin *row_of(const std::string &type)
{
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        if (type == b->type) return b;
    return nullptr;
}

void invalid(const char *type, const char *param, const char *what, const void *self)
{
    const sgt_builtin *row = row_of(type);
    const sgt_surface s = {row->ops, self};
    const double z[3] = {0.1, 0.2, -3}, d[3] = {0, 0, 1};
    const sgt_ray ray = {{0.1, 0.2, -3}, {0, 0, 1}, 0, HUGE_VAL};
    double t = 0;
    sgt_status status = SGT_STOPPED;
    const sgt_rays rays = {{z, z + 1, z + 2}, {d, d + 1, d + 2}, nullptr, nullptr};
    sgt_hits hits = {};
    hits.t = &t, hits.status = &status;
    sgt_hit hit;
    const sgt_status alone = sgt_intersect(s, ray, nullptr).status;
    const int all = sgt_intersect_all(s, ray, 1, &hit, nullptr);
    sgt_intersect_batch(s, 1, rays, hits, nullptr);
    // a trace through it, alone and in a batch, under each proof
    bool traced = true;
    for (const double aperture : {0.0, 1.0})
        for (const sgt_proof proof : {SGT_ESTIMATE, SGT_PROVE_ROOT, SGT_PROVE_FIRST}) {
            sgt_element e = {};
            e.surface = s, e.index = 1.5, e.semi_diameter = aperture;
            sgt_options opt = {};
            opt.proof = proof;
            sgt_ray launch = ray;
            sgt_passage passage;
            sgt_fate fate;
            sgt_fate fate_of = SGT_TIR;
            sgt_traced out = {};
            out.fate = &fate_of;
            traced = traced && sgt_trace(1, &e, 1, &launch, &passage, &fate, &opt) == 0 && fate == SGT_LOST;
            traced = traced && sgt_trace_batch(1, &e, 1, 1, rays, out, nullptr, &opt) == 0 &&
                     fate_of == SGT_LOST;
        }
    const sgt_objection o = row->object(self);
    counted["bad parameters"]++;
    if (!std::strcmp(type, "sum") && !std::strcmp(param, "terms") && o.param &&
        std::strcmp(o.param, "semi_diameter"))
        param = o.param; // the key of the term
    const bool named = o.param && o.reason && *o.reason && !std::strcmp(o.param, param);
    if (alone == SGT_INVALID && all == SGT_INVALID && status == SGT_INVALID && t != t && named && traced)
        return;
    failed[std::string(type) + ": " + param + " " + what]++;
    std::printf("FAIL %s with %s %s: %s, of all %d, in a batch %d%s, named %s (%s)\n", type, param, what,
                sgt_status_text(alone), all, status, traced ? "" : ", not lost in a trace",
                o.param ? o.param : "-", o.reason ? o.reason : "-");
}

void valid(const char *type, const char *what, const void *self)
{
    const sgt_builtin *row = row_of(type);
    const sgt_surface s = {row->ops, self};
    const sgt_ray ray = {{0.1, 0.2, -3}, {0, 0, 1}, 0, HUGE_VAL};
    counted["good parameters"]++;
    const sgt_hit h = sgt_intersect(s, ray, nullptr);
    if (h.status != SGT_INVALID && !row->object(self).param) return;
    failed[std::string(type) + ": " + what]++;
    std::printf("FAIL %s with %s: %s (%s)\n", type, what, sgt_status_text(h.status),
                row->object(self).param ? row->object(self).reason : "-");
}

// Each number of the struct in turn.
template <class S> void each_number(const char *type, const S &good)
{
    const sgt_builtin *row = row_of(type);
    valid(type, "good numbers", &good);
    for (const sgt_param *p = row->params; p->name; p++) {
        if (p->kind != SGT_PARAM_REAL && p->kind != SGT_PARAM_VECTOR) continue;
        for (int i = 0; i < p->count; i++)
            for (double bad : {static_cast<double>(NAN), HUGE_VAL, -HUGE_VAL}) {
                S s = good;
                reinterpret_cast<double *>(reinterpret_cast<char *>(&s) + p->offset)[i] = bad;
                invalid(type, p->name, "not finite", &s);
            }
        if (!std::strcmp(p->name, "semi_diameter")) {
            S s = good;
            *reinterpret_cast<double *>(reinterpret_cast<char *>(&s) + p->offset) = -1;
            invalid(type, p->name, "negative", &s);
        }
    }
}

template <class S> void not_above_zero(const char *type, const S &good, const char *param, double S::*member)
{
    for (double bad : {0.0, -0.0, -1.0}) {
        S s = good;
        s.*member = bad;
        invalid(type, param, "not above 0", &s);
    }
}

// Each number of the list in turn; too many of them; none at all behind a count.
template <class S>
void each_of_list(const char *type, const S &good, const char *param, sgt_numbers S::*member,
                  std::size_t rows, std::size_t columns)
{
    for (std::size_t i = 0; i < count_of(good.*member); i++)
        for (double bad : {static_cast<double>(NAN), HUGE_VAL}) {
            std::vector<double> x((good.*member).x, (good.*member).x + count_of(good.*member));
            x[i] = bad;
            S s = good;
            (s.*member).x = x.data();
            invalid(type, param, "not finite", &s);
        }
    const std::vector<double> long_one((rows + 1) * (columns + 1), 0.0);
    S s = good;
    s.*member = {long_one.data(), rows, columns + 1};
    invalid(type, param, "too long", &s);
    s.*member = {long_one.data(), rows + 1, columns};
    invalid(type, param, "of too many rows", &s);
    s.*member = {nullptr, 1, rows > 1 ? columns : 3};
    invalid(type, param, "without numbers", &s);
    s.*member = {long_one.data(), rows, columns};
    valid(type, "the longest list", &s);
}

void bad_numbers()
{
    const double a[16] = {0.1, 0.02, -0.03, 0.01, 0.02, -0.01, 0.03, 0.001,
                          0.1, 0.02, -0.03, 0.01, 0.02, -0.01, 0.03, 0.001};
    const sgt_odd_asphere odd = {0.1, -0.5, 5, {0.01, 0.02}};
    each_number("odd_asphere", odd);
    const sgt_polynomial_xy xy = {0.1, -0.5, 5, {a, 3, 4}};
    each_number("polynomial_xy", xy);
    each_of_list("polynomial_xy", xy, "coefficients", &sgt_polynomial_xy::a, 32, 32);
    const sgt_chebyshev cheb = {0.1, -0.5, 5, 6, 7, {a, 3, 4}};
    each_number("chebyshev", cheb);
    not_above_zero("chebyshev", cheb, "norm_x", &sgt_chebyshev::norm_x);
    not_above_zero("chebyshev", cheb, "norm_y", &sgt_chebyshev::norm_y);
    each_of_list("chebyshev", cheb, "coefficients", &sgt_chebyshev::a, 64, 64);
    const sgt_zernike zern = {0.1, -0.5, 5, 6, SGT_FRINGE, 1, {a, 1, 16}};
    each_number("zernike", zern);
    not_above_zero("zernike", zern, "norm", &sgt_zernike::norm);
    each_of_list("zernike", zern, "coefficients", &sgt_zernike::a, 1, 5151);
    for (int order : {0, 3, -1}) {
        sgt_zernike z = zern;
        z.order = order;
        invalid("zernike", "order", "unknown", &z);
    }
    const sgt_q_con con = {0.1, -0.5, 5, 6, {a, 1, 5}};
    each_number("q_con", con);
    not_above_zero("q_con", con, "norm", &sgt_q_con::norm);
    each_of_list("q_con", con, "coefficients", &sgt_q_con::a, 1, 64);
    const sgt_q_bfs bfs = {0.1, 5, 6, {a, 1, 5}};
    each_number("q_bfs", bfs);
    not_above_zero("q_bfs", bfs, "norm", &sgt_q_bfs::norm);
    each_of_list("q_bfs", bfs, "coefficients", &sgt_q_bfs::a, 1, 64);
    const sgt_grid grid = {0.1, -0.5, 5, 6, 7, {a, 4, 4}, 0, 0, 0};
    each_number("grid", grid);
    not_above_zero("grid", grid, "step_x", &sgt_grid::step_x);
    not_above_zero("grid", grid, "step_y", &sgt_grid::step_y);
    for (int i = 0; i < 16; i++) {
        double hole[16];
        std::copy(a, a + 16, hole);
        hole[i] = NAN;
        sgt_grid s = grid;
        s.z.x = hole;
        invalid("grid", "sag", "with a hole", &s);
    }
    for (const auto &size :
         {std::pair<std::size_t, std::size_t>(3, 5), {5, 3}, {0, 0}, {4097, 4}, {4, 4097}}) {
        const std::vector<double> z(size.first * size.second + 1, 0.0);
        sgt_grid s = grid;
        s.z = {z.data(), size.first, size.second};
        invalid("grid", "sag", "of a size that is none", &s);
    }
    sgt_grid none = grid;
    none.z.x = nullptr;
    invalid("grid", "sag", "without numbers", &none);

    const sgt_toroidal toroid = {0.1, -0.5, 0.05, 5, {0.01}};
    each_number("toroidal", toroid);
    const sgt_biconic biconic = {0.1, -0.5, 0.05, 1, 5};
    each_number("biconic", biconic);
    const sgt_biconic cylinder = {0, 0, 0.05, 1, 5};
    each_number("cylinder", cylinder);
    const sgt_quadric quadric = {{1, 2, 3}, {0.1, 0.2, 0.3}, {1, 2, 3}, -4};
    each_number("quadric", quadric);
    const sgt_quadric nothing = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, 1};
    const sgt_objection o = row_of("quadric")->object(&nothing);
    invalid("quadric", o.param ? o.param : "squares", "all zero", &nothing);
    const sgt_ellipsoid ellipsoid = {2, 0.1};
    each_number("ellipsoid", ellipsoid);
    not_above_zero("ellipsoid", ellipsoid, "a", &sgt_ellipsoid::a);
    for (double f : {1.0, 1.5, 1e300}) {
        const sgt_ellipsoid e = {2, f};
        invalid("ellipsoid", "f", "1 or more", &e);
    }
    const sgt_torus torus = {2, 0.1};
    each_number("torus", torus);
    not_above_zero("torus", torus, "major", &sgt_torus::major);
    not_above_zero("torus", torus, "minor", &sgt_torus::minor);

    // Sums: a term is asked as it would be by itself, but for c, k and semi_diameter.
    sgt_zernike part = zern;
    part.c = 3, part.k = NAN, part.semi_diameter = -5;
    const sgt_even_asphere even = {NAN, NAN, NAN, {0.1, 0.01}};
    const sgt_surface good[] = {{&sgt_zernike_ops, &part},    {&sgt_even_asphere_ops, &even},
                                {&sgt_toroidal_ops, &toroid}, {&sgt_biconic_ops, &biconic},
                                {&sgt_q_bfs_ops, &bfs},       {&sgt_grid_ops, &grid}};
    const sgt_sum sum = {0.1, -0.5, 5, good, 6};
    each_number("sum", sum);
    const sgt_sum inner = {0, 0, 0, good, 2};
    const sgt_conic conic = {0, 0, 0};
    sgt_zernike no_norm = part, hole = part;
    sgt_q_bfs curved = bfs;
    curved.c = NAN; // it is read
    no_norm.norm = 0;
    double x[16] = {NAN};
    hole.a.x = x;
    sgt_even_asphere nan_term = even;
    nan_term.a[3] = NAN;
    const sgt_toroidal own = {0, NAN, 0, 0, {}};
    const sgt_biconic other = {0, 0, HUGE_VAL, 0, 0};
    const sgt_surface bad[] = {
        {&sgt_sum_ops, &inner},       {&sgt_conic_ops, &conic},   {&sgt_q_bfs_ops, &curved},
        {&sgt_zernike_ops, &no_norm}, {&sgt_zernike_ops, &hole},  {&sgt_even_asphere_ops, &nan_term},
        {&sgt_toroidal_ops, &own},    {&sgt_biconic_ops, &other}, {&sgt_torus_ops, &torus},
        {nullptr, nullptr},           {&sgt_zernike_ops, nullptr}};
    for (const sgt_surface &b : bad) {
        const sgt_surface terms[] = {good[0], b};
        const sgt_sum s = {0.1, -0.5, 5, terms, 2};
        invalid("sum", "terms",
                (std::string("with a term that is bad: ") + (b.ops ? b.ops->name : "none")).c_str(), &s);
    }
    const sgt_sum no_terms = {0.1, -0.5, 5, nullptr, 2}, empty = {0.1, -0.5, 5, nullptr, 0};
    invalid("sum", "terms", "missing", &no_terms);
    valid("sum", "no terms", &empty);
    const std::vector<sgt_surface> seventeen(17, good[1]);
    const sgt_sum too_many = {0.1, -0.5, 5, seventeen.data(), 17},
                  enough = {0.1, -0.5, 5, seventeen.data(), 16};
    invalid("sum", "terms", "too many", &too_many);
    valid("sum", "16 terms", &enough);
}

// -------------------------------------------------------------------- identities

void same_roots(const char *law, const sgt_surface &a, const sgt_surface &b, const sgt_ray &ray,
                const sgt_ray &other, sgt_pick pick)
{
    sgt_options o = {};
    o.pick = pick;
    const sgt_hit h = sgt_intersect(a, ray, &o), k = sgt_intersect(b, other, &o);
    counted[law]++;
    const char *what = nullptr;
    if (h.status == SGT_INVALID || k.status == SGT_INVALID) what = "invalid";
    else if (h.status < 0 || k.status < 0) counted[std::string(law) + ", undecided"]++;
    else if ((h.status > 0) != (k.status > 0) && h.status != SGT_GRAZE && k.status != SGT_GRAZE)
        what = "one meets, one does not";
    else if (h.status == SGT_HIT && k.status == SGT_HIT &&
             !(std::fabs(h.t - k.t) <= h.t_err + k.t_err + 0x1p-52 * std::fabs(h.t))) {
        sgt_hit all[8];
        const int n = pick == SGT_FIRST
                          ? 0
                          : sgt_intersect_all(b, other, 8, all,
                                              nullptr); // which of two is near the seed is not said
        what = "two roots";
        for (int i = 0; i < n && i < 8; i++)
            if (std::fabs(h.t - all[i].t) <= h.t_err + all[i].t_err + 0x1p-52 * std::fabs(h.t))
                what = nullptr;
    } else if (h.status == SGT_MISS)
        counted[std::string(law) + ", misses"]++;
    if (!what || failed[std::string(law) + ": " + what]++ >= 2) return;
    std::printf("FAIL %s: %s, %s %a +- %.3g and %s %a +- %.3g\n", law, what, sgt_status_text(h.status), h.t,
                h.t_err, sgt_status_text(k.status), k.t, k.t_err);
    print_surface(a);
    print_surface(b);
    print_ray(ray);
}

// A ray at a sag of size h.
sgt_ray ray_at(generator &g, double h)
{
    const double tilt = g.uniform(0, g.chance(0.7) ? 0.6 : 1.5), about = g.uniform(0, 6.283185307179586),
                 r = h * std::sqrt(g.uniform(0, 1.2)), at = g.uniform(0, 6.283185307179586),
                 away = g.uniform(-1, 5) * h;
    const sgt_vec3 d = {std::sin(tilt) * std::cos(about), std::sin(tilt) * std::sin(about),
                        g.sign() * std::cos(tilt)};
    return {{r * std::cos(at) - away * d.x, r * std::sin(at) - away * d.y,
             -away * d.z + g.uniform(-0.1, 0.1) * h},
            d,
            g.chance(0.5) ? -HUGE_VAL : 0,
            HUGE_VAL};
}

// A number of few bits, so that what is made of it is exact.
double short_number(generator &g, double size) { return size * (g.below(255) - 127) / 128; }

void identities(generator &g)
{
    const double h = std::ldexp(1.0, g.below(7) - 3), h2 = h * h;
    double c, k;
    random_base(g, h, &c, &k);
    const double rim = g.chance(0.8) ? h : 0, strong = std::ldexp(h, -4 - g.below(12));
    const sgt_pick pick = g.chance(0.7) ? SGT_FIRST : SGT_NEAR_SEED;
    const auto both = [&](const char *law, const sgt_surface &a, const sgt_surface &b) {
        for (int i = 0; i < 3; i++) {
            const sgt_ray r = ray_at(g, h);
            same_roots(law, a, b, r, r, pick);
        }
    };
    const sgt_conic conic = {c, k, rim};
    const sgt_biconic biconic = {c, k, c, k, rim};
    both("a biconic of equal radii is the conic", {&sgt_biconic_ops, &biconic}, {&sgt_conic_ops, &conic});
    const sgt_toroidal straight = {c, k, 0, rim, {}};
    const sgt_biconic cylinder = {0, k, c, k, rim};
    both("a toroid that is straight in x is the cylinder", {&sgt_toroidal_ops, &straight},
         {&sgt_biconic_ops, &cylinder});
    const sgt_conic sphere = {c, 0, h};
    const sgt_toroidal ball = {c, 0, c, h, {}};
    both("a toroid of equal radii is the sphere", {&sgt_toroidal_ops, &ball}, {&sgt_conic_ops, &sphere});

    // An even asphere of few bits, as everything that can be one.
    const double a0 = short_number(g, strong), a1 = short_number(g, strong), a2 = short_number(g, strong);
    const sgt_even_asphere even = {c, k, rim, {a0 / h2, a1 / (h2 * h2), a2 / (h2 * h2 * h2)}};
    const sgt_surface wanted = {&sgt_even_asphere_ops, &even};
    sgt_odd_asphere odd = {c, k, rim, {}};
    odd.a[1] = even.a[0], odd.a[3] = even.a[1], odd.a[5] = even.a[2];
    both("an odd asphere of even terms is the even one", {&sgt_odd_asphere_ops, &odd}, wanted);
    std::vector<double> xy(49);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i + 1; j++)
            xy[static_cast<std::size_t>(2 * j * 7 + 2 * (i + 1 - j))] = even.a[i] *
                                                                        oracle::to_double(binomial(i + 1, j));
    const sgt_polynomial_xy poly = {c, k, rim, {xy.data(), 7, 7}};
    both("an XY polynomial of r^2 is the even asphere", {&sgt_polynomial_xy_ops, &poly}, wanted);
    // 6 rho^2 = 3 Z(2, 0) + 3,  6 rho^4 = Z(4, 0) + 3 Z(2, 0) + 2
    const sgt_even_asphere quartic = {c, k, rim, {6 * a0 / h2, 6 * a1 / (h2 * h2), 0}};
    const double noll_terms[11] = {3 * a0 + 2 * a1, 0, 0, 3 * a0 + 3 * a1, 0, 0, 0, 0, 0, 0, a1};
    const double fringe_terms[9] = {3 * a0 + 2 * a1, 0, 0, 3 * a0 + 3 * a1, 0, 0, 0, 0, a1};
    const sgt_zernike noll_one = {c, k, rim, h, SGT_NOLL, 0, {noll_terms, 1, 11}},
                      fringe_one = {c, k, rim, h, SGT_FRINGE, 0, {fringe_terms, 1, 9}};
    both("Zernike's of revolution, Noll, are the even asphere", {&sgt_zernike_ops, &noll_one},
         {&sgt_even_asphere_ops, &quartic});
    both("Zernike's of revolution, Fringe, are the even asphere", {&sgt_zernike_ops, &fringe_one},
         {&sgt_even_asphere_ops, &quartic});
    const double con_terms[2] = {6 * a1 + 5 * a2, a2}; // u^4 (6 a1 + 5 a2 - 5 a2 + 6 a2 u^2)
    const sgt_even_asphere conned = {c, k, rim, {0, 6 * a1 / (h2 * h2), 6 * a2 / (h2 * h2 * h2)}};
    const sgt_q_con con = {c, k, rim, h, {con_terms, 1, 2}};
    both("Q_con of two terms is the even asphere", {&sgt_q_con_ops, &con}, {&sgt_even_asphere_ops, &conned});
    const sgt_even_asphere flat_bfs = {0, 0, rim, {a0 / h2, -a0 / (h2 * h2)}};
    const sgt_q_bfs bfs = {0, rim, h, {&a0, 1, 1}};
    both("Q_bfs of one term on a plane is the even asphere", {&sgt_q_bfs_ops, &bfs},
         {&sgt_even_asphere_ops, &flat_bfs});

    // a u^2 + b v^2 + 2 e u v + f u + g v, u and v in units of h.
    const double a = short_number(g, strong), b = short_number(g, strong), e = short_number(g, strong),
                 fu = short_number(g, strong), gv = short_number(g, strong);
    const double of_xy[9] = {0, gv / h, b / h2, fu / h, 2 * e / h2, 0, a / h2, 0, 0};
    const sgt_polynomial_xy quadratic = {c, k, rim, {of_xy, 3, 3}};
    const sgt_surface second = {&sgt_polynomial_xy_ops, &quadratic};
    const double of_t[9] = {(a + b) / 2, gv, b / 2, fu, 2 * e, 0, a / 2, 0, 0};
    const sgt_chebyshev chebyshev = {c, k, rim, h, h, {of_t, 3, 3}};
    both("a quadratic by Chebyshev", {&sgt_chebyshev_ops, &chebyshev}, second);
    // a u^2 + b v^2 = (a + b)/2 rho^2 + (a - b)/2 (u^2 - v^2), rho^2 = (Z + 1)/2
    const double of_noll[6] = {(a + b) / 4, fu, gv, (a + b) / 4, e, (a - b) / 2},
                 of_fringe[6] = {(a + b) / 4, fu, gv, (a + b) / 4, (a - b) / 2, e};
    const sgt_zernike by_noll = {c, k, rim, h, SGT_NOLL, 0, {of_noll, 1, 6}},
                      by_fringe = {c, k, rim, h, SGT_FRINGE, 0, {of_fringe, 1, 6}};
    both("a quadratic by Zernike, Noll", {&sgt_zernike_ops, &by_noll}, second);
    both("a quadratic by Zernike, Fringe", {&sgt_zernike_ops, &by_fringe}, second);
    const sgt_surface two[] = {{&sgt_polynomial_xy_ops, nullptr}, {&sgt_zernike_ops, nullptr}};
    double half[9], half_z[6];
    for (int i = 0; i < 9; i++) half[i] = of_xy[i] / 2;
    for (int i = 0; i < 6; i++) half_z[i] = of_noll[i] / 2;
    const sgt_polynomial_xy first_half = {0, 0, 0, {half, 3, 3}};
    const sgt_zernike other_half = {0, 0, 0, h, SGT_NOLL, 0, {half_z, 1, 6}};
    const sgt_surface halves[] = {{two[0].ops, &first_half}, {two[1].ops, &other_half}};
    const sgt_sum sum = {c, k, rim, halves, 2};
    both("a quadratic as the sum of two halves", {&sgt_sum_ops, &sum}, second);
    double z[9 * 9];
    for (int i = 0; i < 9; i++)
        for (int j = 0; j < 9; j++) {
            const double u = (j - 4) / 4.0, v = (i - 4) / 4.0;
            z[i * 9 + j] = a * u * u + b * v * v + 2 * e * u * v + fu * u + gv * v;
        }
    sgt_polynomial_xy rimmed = quadratic;
    rimmed.semi_diameter = h * 0.875;
    const sgt_grid grid = {c, k, h * 0.875, h / 4, h / 4, {z, 9, 9}, 0, 0, 0};
    both("a quadratic by a grid", {&sgt_grid_ops, &grid}, {&sgt_polynomial_xy_ops, &rimmed});

    // About the origin.
    static const double flattening[] = {0, 0.5, -1, 0.75, -3};
    const double f = flattening[g.below(5)], polar = h * (1 - f);
    const sgt_ellipsoid ellipsoid = {h, f};
    const sgt_quadric quadric = {{1 / h2, 1 / h2, 1 / (polar * polar)}, {0, 0, 0}, {0, 0, 0}, -1};
    const sgt_biconic flipped = {-c, k, -c, k, rim};
    for (int i = 0; i < 3; i++) {
        const sgt_ray r = ray_at(g, 1.2 * h);
        same_roots("an ellipsoid is the quadric", {&sgt_ellipsoid_ops, &ellipsoid},
                   {&sgt_quadric_ops, &quadric}, r, r, pick);
        sgt_ray down = r;
        down.o.z = -r.o.z, down.d.z = -r.d.z;
        same_roots("a biconic upside down", {&sgt_biconic_ops, &biconic}, {&sgt_biconic_ops, &flipped}, r,
                   down, pick);
        sgt_ray turned = r; // Chebyshev's sum of x and y with the two exchanged
        std::swap(turned.o.x, turned.o.y), std::swap(turned.d.x, turned.d.y);
        const double across[9] = {of_t[0], of_t[3], of_t[6], of_t[1], of_t[4],
                                  of_t[7], of_t[2], of_t[5], of_t[8]};
        const sgt_chebyshev swapped = {c, k, rim, h, h, {across, 3, 3}};
        same_roots("Chebyshev's with x and y exchanged", {&sgt_chebyshev_ops, &chebyshev},
                   {&sgt_chebyshev_ops, &swapped}, r, turned, pick);
    }
}

// All lengths twice as long: so is t.
void scaled(generator &g)
{
    const specimen s = random_specimen(g, "zernike"), t = random_specimen(g, "toroidal");
    const sgt_zernike &z = *static_cast<const sgt_zernike *>(s.s.self);
    std::vector<double> twice(z.a.x, z.a.x + count_of(z.a)), less(z.a.x, z.a.x + count_of(z.a));
    for (double &x : twice) x *= 8;
    for (double &x : less) x = -x;
    sgt_zernike big = z, down = z;
    big.c /= 8, big.semi_diameter *= 8, big.norm *= 8, big.a.x = twice.data();
    down.c = -down.c, down.a.x = less.data();
    sgt_toroidal minus = *static_cast<const sgt_toroidal *>(t.s.self);
    minus.c = -minus.c, minus.c_x = -minus.c_x;
    for (double &x : minus.a) x = -x;
    for (int i = 0; i < 4; i++) {
        const sgt_pick pick = g.chance(0.7) ? SGT_FIRST : SGT_NEAR_SEED;
        const sgt_ray r = ray_at(g, s.h), q = ray_at(g, t.h);
        sgt_ray far_ray = r, turned = r, other = q;
        far_ray.o = {8 * r.o.x, 8 * r.o.y, 8 * r.o.z}, far_ray.d = {8 * r.d.x, 8 * r.d.y, 8 * r.d.z};
        same_roots("lengths eight times as long", s.s, {&sgt_zernike_ops, &big}, r, far_ray, pick);
        turned.o.z = -r.o.z, turned.d.z = -r.d.z;
        same_roots("Zernike's upside down", s.s, {&sgt_zernike_ops, &down}, r, turned, pick);
        other.o.z = -q.o.z, other.d.z = -q.d.z;
        same_roots("a toroid upside down", t.s, {&sgt_toroidal_ops, &minus}, q, other, pick);
    }
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run r(argc, argv, 20, 20240604);
    const char *only = std::getenv("SAGITTA_TEST_TYPE");
    for (std::size_t k = 0; k < types.size(); k++) {
        if (only && std::strcmp(only, types[k])) continue;
        generator g(r.seed ^ static_cast<std::uint64_t>(k) << 40);
        for (long i = 0; i < r.count; i++) sound(g, types[k]);
    }
    if (!only || !std::strcmp(only, "bad")) bad_numbers();
    if (!only || !std::strcmp(only, "identities")) {
        generator g(r.seed);
        for (long i = 0; i < 10 * r.count; i++) identities(g), scaled(g);
    }
    for (const auto &c : counted) std::printf("  %8ld  %s\n", c.second, c.first.c_str());
    for (const auto &f : failed) std::printf("FAIL %6ld  %s\n", f.second, f.first.c_str());
    return !failed.empty();
}
