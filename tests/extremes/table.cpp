// SPDX-License-Identifier: MIT
// The extremes as a table: accuracy, claims and cost where one quantity at a time is
// driven to the end of its range, all others being those of a lens.
//
//     table --count 2000              the tables of docs/data/extremes.md (docs/extremes_table.py)
//     table docs/data/extremes.md     the test: fewer rays, each row held to what the page says
//     table --row "Scale: 1e150, conic" --count 500
//                                     one row, and its rays that were undecided or lost, in hexadecimal
//
// Each row draws its own rays, from the seed and its own number, so that those of a short run
// are the first of a long one.  Each ray is asked three times: estimate, root, first (options.proof),
// always for the first root, and each claim is compared with quadruple precision (oracle/quad.h;
// level sets: oracle/brute.h and levels.h).  Of every answer, whatever the proof:
//   wrong    met, and: no root within t_err of t or of t + t_lo, a root that does not count, another
//            that counts before it, p farther off than p_err, with a proof a second root within t_err;
//            or undecided, and a root that counts lies before lo;
//   false    met, and no root of the ray counts;
//   missed   missed, and a root counts.
// And of those that are met:
//   normal   |F| / |grad F| at p, in ulps of the largest term of F (level sets: of the largest
//            coordinate of p);
//   t        |dt| |d| cos(incidence), how far from the surface t would put the point, in ulps of the
//            largest of the terms of F and the coordinates of p (on a plane F has no term left);
//   t + t_lo the same of both together;
//   path     |n2 cos2 - n1 cos1| times the normal error, from index 1 to 1.5, in waves of 0.5876 um,
//            a unit of length being a millimetre;
//   t_err    over max(error of t, ulp(t) / 2).
//
// Who lost it?  The condition of t is the sum of |input * dt/d(input)|, over the coordinates of o and
// of d and the parameters of the surface, over |t|: how many times more than the inputs t moves,
// relatively, if all of them move at their worst (of c of a Julia set: its length times the length of
// the derivative).  With u = 2^-53, half an ulp, no method that is given doubles and gives one is to be
// asked for more than
//     condition u |t| + ulp(t) / 2                                            of t,
//     (u (|x Fx| + |y Fy| + |z Fz|) + half a unit |grad F|) / |grad F|        of the normal error
// (level sets: or u times the sum of |input * dF/d(input)| over |grad F|, which is the condition of p).
//   nothing  p is within 12 units (what test_random allows), and t + t_lo; 99 % of the t are within
//            1000, three digits: what it costs that t counts from the start of the ray, and the
//            surface from its vertex;
//   method   a p or t farther off than that, and than four times what was to be asked for; or an
//            undecided ray that is not the problem's;
//   problem  else.
// An undecided ray is the problem's where some change of the inputs by an ulp or two (64 tries) changes
// how many roots count, or two of its roots are within 2 ulps of t; of a level set where F is within 16
// times the rounding of the inputs in the middle of [lo, hi].
#include "../oracle/brute.h"
#include "../oracle/cases.h"
#include "../oracle/levels.h"
#include "../oracle/quad.h"

#include <sagitta/sagitta.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <map>
#include <string>

using namespace oracle;

namespace {

const sgt_proof proofs[3] = {SGT_ESTIMATE, SGT_PROVE_ROOT, SGT_PROVE_FIRST};
const char *const proof_names[3] = {"estimate", "root", "first"};
const quad u = quad(0x1p-53);

bool shown = false; // --row: tell each fault, and what was undecided or lost

// ------------------------------------------------------------------- a row

struct sample {
    std::vector<double> v;
    void add(double x) { v.push_back(x); }
    double quantile(double q)
    {
        if (v.empty()) return NAN;
        const std::size_t i = static_cast<std::size_t>(q * double(v.size() - 1));
        std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(i), v.end());
        return v[i];
    }
};

enum loser { nothing, problem, method };
const char *const loser_names[3] = {"nothing", "problem", "method"};

struct row {
    std::string name;
    long rays = 0, met = 0, wrong = 0, falsely = 0, missed = 0, unsure = 0;
    long undecided[3] = {}, evals[3] = {};
    long unproblematic = 0; // undecided by the method's fault
    sample normal, t, t_whole, path, t_err, condition;
    loser lost = nothing;
};

void blame(row &r, loser who) { r.lost = std::max(r.lost, who); }

void complain(const row &r, const char *what, sgt_proof proof, const std::function<void()> &print)
{
    static std::map<std::string, int> printed;
    if (printed[what]++ >= 3 && !shown) return;
    std::fprintf(stderr, "%s: %s (proof: %s)\n", r.name.c_str(), what, proof_names[proof]);
    print();
}

void print_hit(const sgt_hit &h)
{
    std::fprintf(stderr,
                 "    %s evals %d t %.17g (%a) t_err %.9g (%a) t_lo %.9g lo %a hi %a\n      p %a %a %a p_err "
                 "%.3g f %.3g\n",
                 sgt_status_text(h.status), h.evals, h.t, h.t, h.t_err, h.t_err, h.t_lo, h.lo, h.hi, h.p.x,
                 h.p.y, h.p.z, h.p_err, h.f);
}

// The errors of one answer: lengths, along the normal.
struct errors {
    quad normal, t, t_whole; // of p; of t; of t + t_lo
    quad normal_bound, t_bound, unit, length_unit, cosine;
    double condition, ratio; // t_err / max(error, ulp / 2)
};

bool beyond(const errors &e)
{
    return e.normal > std::max(12 * e.unit, 4 * e.normal_bound) ||
           e.t > std::max(12 * e.length_unit, 4 * e.t_bound);
}

void take(row &r, const errors &e)
{
    const quad index1 = 1, index2 = 1.5,
               sine2 = (1 - e.cosine * e.cosine) * index1 / index2 * index1 / index2;
    const quad bend = magnitude(index2 * square_root(1 - sine2) - index1 * e.cosine);
    r.met++;
    r.normal.add(to_double(e.normal / e.unit));
    r.t.add(to_double(e.t / e.length_unit));
    r.t_whole.add(to_double(e.t_whole / e.length_unit));
    r.path.add(to_double(bend * e.normal / quad(0.5876e-3)));
    r.t_err.add(e.ratio);
    r.condition.add(e.condition);
    if (e.normal > 12 * e.unit || e.t_whole > 12 * e.length_unit) blame(r, problem);
    if (beyond(e)) blame(r, method);
}

void print_errors(const errors &e)
{
    std::fprintf(
        stderr, "    units: normal %.3g, at best %.3g; t %.3g, at best %.3g; condition %.3g, cosine %.3g\n",
        to_double(e.normal / e.unit), to_double(e.normal_bound / e.unit), to_double(e.t / e.length_unit),
        to_double(e.t_bound / e.length_unit), e.condition, to_double(e.cosine));
}

// ---------------------------------------------------------------- the oracle

// The same ray and surface in lengths times 2^-length and directions times 2^-way (exact, or the
// row has left the normal doubles), answered there and taken back.
answer roots_of(const test_case &t)
{
    const auto exponent = [](double x) {
        return x != 0 && std::fabs(std::ilogb(x)) > 100 ? std::ilogb(x) : 0;
    };
    const int length = exponent(t.h),
              way = exponent(std::max({std::fabs(t.ray.d.x), std::fabs(t.ray.d.y), std::fabs(t.ray.d.z)}));
    sgt_even_asphere s = t.surface;
    sgt_ray ray = t.ray;
    s.c = std::ldexp(s.c, length);
    s.semi_diameter = std::ldexp(s.semi_diameter, -length);
    for (int i = 0; i < 8; i++) s.a[i] = std::ldexp(s.a[i], length * (2 * i + 1));
    for (double *x : {&ray.o.x, &ray.o.y, &ray.o.z}) *x = std::ldexp(*x, -length);
    for (double *x : {&ray.d.x, &ray.d.y, &ray.d.z}) *x = std::ldexp(*x, -way);
    answer a = all_roots(surface(s), ray);
    const auto power = [](int e) { // 2^e, beyond the doubles too
        quad x = 1;
        for (; e > 0; e--) x *= 2;
        for (; e < 0; e++) x /= 2;
        return x;
    };
    const quad unit = power(length), per = power(length - way), slope = power(way);
    for (meeting &m : a.roots) {
        const quad whole = m.t() * per; // (to within 2^-113, and then the rest from t0)
        const double t0 = to_double(quad(m.t0) * per);
        m.s = std::isfinite(t0) ? (quad(m.t0) * per - t0) + m.s * per : whole;
        m.t0 = std::isfinite(t0) ? t0 : 0;
        m.blur *= per;
        m.p = {m.p.x * unit, m.p.y * unit, m.p.z * unit};
        m.slope *= slope;
        m.spread *= unit;
    }
    for (answer::stretch &d : a.doubtful) d.lo *= per, d.hi *= per;
    return a;
}

// Sum of |input * dF/d(input)| at a root: of the ray's numbers, and of the surface's.
quad inputs_of(const test_case &t, const meeting &m)
{
    const sgt_even_asphere &s = t.surface;
    const quad rho = m.p.x * m.p.x + m.p.y * m.p.y, time = m.t(), e = 1 + quad(s.k);
    quad polynomial = 0, sum = 0, power = 1;
    for (double a : s.a) {
        power *= rho;
        polynomial += quad(a) * power;
        sum += magnitude(quad(a) * power);
    }
    // The base sag b, from c (rho + e b^2) = 2 b.
    const quad b = m.p.z - polynomial, w = magnitude(1 - e * s.c * b);
    sum += magnitude(s.c * (rho + e * b * b)) / (2 * w) + magnitude(quad(s.k) * s.c * b * b) / (2 * w);
    const quad g[3] = {m.gradient.x, m.gradient.y, m.gradient.z}, o[3] = {t.ray.o.x, t.ray.o.y, t.ray.o.z},
               d[3] = {t.ray.d.x, t.ray.d.y, t.ray.d.z};
    for (int i = 0; i < 3; i++) sum += magnitude(g[i]) * (magnitude(o[i]) + magnitude(time * d[i]));
    return sum;
}

int counted(const answer &a, double tmin, double tmax)
{
    int n = 0;
    for (const meeting &m : a.roots) n += counting(m, tmin, tmax) == yes;
    return n;
}

bool hidden_by_inputs(const test_case &t, const answer &a, generator g)
{
    double tmin, tmax;
    ends_of(t.ray, &tmin, &tmax);
    if (!a.doubtful.empty()) return true;
    for (const meeting &m : a.roots) {
        if (counting(m, tmin, tmax) == perhaps) return true;
        for (const meeting &other : a.roots)
            if (&m != &other && magnitude(m.minus(other.t0) - other.s) <= 2 * quad(ulp(to_double(m.t()))))
                return true;
    }
    const int n = counted(a, tmin, tmax);
    const auto move = [&](double x) {
        for (int i = g.below(3); i > 0; i--) x = std::nextafter(x, g.chance(0.5) ? HUGE_VAL : -HUGE_VAL);
        return x;
    };
    for (int i = 0; i < 64; i++) {
        test_case near = t;
        for (double *x : {&near.ray.o.x, &near.ray.o.y, &near.ray.o.z, &near.ray.d.x, &near.ray.d.y,
                          &near.ray.d.z, &near.surface.c, &near.surface.k, &near.surface.semi_diameter})
            if (*x != 0) *x = move(*x);
        for (double &x : near.surface.a)
            if (x != 0) x = move(x);
        const answer b = roots_of(near);
        if (!b.doubtful.empty() || counted(b, tmin, tmax) != n) return true;
    }
    return false;
}

// ---------------------------------------------------------------------- sags

void ask(row &r, const test_case &t, const generator &g)
{
    sgt_conic conic;
    const sgt_surface s = as_surface(t, &conic);
    const surface f(t.surface);
    const answer a = roots_of(t);
    double tmin, tmax;
    ends_of(t.ray, &tmin, &tmax);
    const meeting *first = nullptr;
    bool perhaps_some = !a.doubtful.empty();
    for (const meeting &m : a.roots) {
        const counts c = counting(m, tmin, tmax);
        if (c == yes && !first) first = &m;
        perhaps_some = perhaps_some || c != no;
    }
    if (a.gave_up || a.at_fault || a.everywhere) {
        r.unsure++;
        if (shown)
            complain(r, a.gave_up ? "the oracle gave up" : "the oracle is at fault", SGT_ESTIMATE,
                     [&] { print_case(stderr, t), std::fprintf(stderr, "\n"); });
        return;
    }
    r.rays++;
    bool problematic = false, known = false;
    for (int i = 0; i < 3; i++) {
        sgt_options options = {};
        options.pick = SGT_FIRST;
        options.proof = proofs[i];
        const sgt_hit h = sgt_intersect(s, t.ray, &options);
        const auto fault = [&](long *n, const char *why) {
            ++*n;
            complain(r, why, proofs[i], [&] {
                std::fprintf(stderr, "    --replay \"");
                print_case(stderr, t);
                std::fprintf(stderr, "\"\n");
                print_hit(h);
                for (const meeting &m : a.roots)
                    std::fprintf(stderr, "    root %s%s blur %.3g\n", text(m.t()).c_str(),
                                 m.edge ? " (edge)" : "", to_double(m.blur));
                for (const answer::stretch &d : a.doubtful)
                    std::fprintf(stderr, "    doubtful %s .. %s\n", text(d.lo).c_str(), text(d.hi).c_str());
            });
        };
        r.evals[i] += h.evals;
        if (h.status == SGT_INVALID) {
            fault(&r.wrong, "valid input called invalid");
            continue;
        }
        if (h.status < 0) {
            r.undecided[i]++;
            const quad least = quad(0x1p-1074);
            if (first && first->minus(h.lo) < -first->blur - least)
                fault(&r.wrong, "undecided, and a root that counts lies before lo");
            else if (shown) {
                long none = 0;
                fault(&none, "undecided");
            }
            if (!known && r.unproblematic < 20) problematic = hidden_by_inputs(t, a, g), known = true;
            if (known && !problematic) r.unproblematic++;
            if (known) blame(r, problematic ? problem : method);
            continue;
        }
        if (h.status == SGT_MISS) {
            if (first) fault(&r.missed, "missed, and a root counts");
            continue;
        }
        if (!perhaps_some) {
            fault(&r.falsely, "met, and no root counts");
            continue;
        }
        if (in_doubt(a, h)) continue;
        const meeting *root = meant(a, h);
        const quad least = quad(0x1p-1074), off = root ? magnitude(root->minus(h.t)) : 0;
        const quad whole = root ? magnitude(root->minus(h.t) - h.t_lo) : 0;
        if (!root || !(off <= quad(h.t_err) + root->blur + least)) {
            fault(&r.wrong, "no root within t_err");
            continue;
        }
        const vector3 p = {h.p.x, h.p.y, h.p.z};
        const quad moved = norm({p.x - root->p.x, p.y - root->p.y, p.z - root->p.z});
        const quad blur = root->blur * norm({t.ray.d.x, t.ray.d.y, t.ray.d.z}) +
                          norm(root->p) * quad(0x1p-108) + least;
        int within = 0;
        for (const meeting &m : a.roots) within += magnitude(m.minus(h.t)) + m.blur <= quad(h.t_err);
        if (counting(*root, tmin, tmax) == no) fault(&r.wrong, "a root that does not count");
        else if (passed_over(a, *root, h, tmin, tmax)) fault(&r.wrong, "not the first root");
        else if (!(whole <= quad(h.t_err) + root->blur + least))
            fault(&r.wrong, "t + t_lo is farther off than t_err");
        else if (!(moved <= quad(h.p_err) + blur)) fault(&r.wrong, "p is farther off than p_err");
        else if (i > 0 && h.status == SGT_HIT && within > 1) fault(&r.wrong, "a second root within t_err");

        errors e = {};
        quad largest;
        const quad inputs = inputs_of(t, *root), length = norm(root->gradient);
        e.normal = normal_error(f, p, &largest);
        e.unit = ulp(to_double(largest));
        e.length_unit = std::max(e.unit,
                                 quad(ulp(std::max({std::fabs(h.p.x), std::fabs(h.p.y), std::fabs(h.p.z)}))));
        e.cosine = magnitude(root->slope) / (length * norm({t.ray.d.x, t.ray.d.y, t.ray.d.z}));
        e.t = off * magnitude(root->slope) / length;
        e.t_whole = whole * magnitude(root->slope) / length;
        e.normal_bound = u * root->spread / length + e.unit / 2;
        e.t_bound = u * inputs / length + quad(ulp(h.t) / 2) * magnitude(root->slope) / length;
        e.condition = to_double(inputs / (magnitude(root->slope) * magnitude(root->t())));
        e.ratio = h.t_err / std::max(to_double(off), ulp(h.t) / 2);
        if (shown && beyond(e)) {
            long none = 0;
            fault(&none, "lost by the method");
            print_errors(e);
        }
        take(r, e);
    }
}

// A lens in millimetres, rays from 20 to 100 away, up to 35 degrees from the axis, one in ten
// aimed past the rim.
struct lens_row {
    double c = 0.02, k = -0.6, a[8] = {1e-3, 1e-5, -5e-8, 2e-10}, h = 10;
    bool asphere = false, rim = true;
    double near = 20, far = 100;
    double way = 1;      // the direction's length
    double graze = 0;    // the incidence, from grazing
    bool vertex = false; // ... next to the vertex
};

test_case draw(generator &g, const lens_row &l)
{
    test_case t = {};
    const double pi = 3.141592653589793;
    sgt_even_asphere &s = t.surface;
    const double side = g.sign();
    s.c = side * l.c * g.uniform(0.7, 1.3);
    s.k = l.k;
    if (l.k != 0 && l.k != -1) s.k = l.k < -0.9 && l.k > -1.1 ? l.k : l.k * g.uniform(0.9, 1.1);
    t.asphere = l.asphere;
    if (l.asphere)
        for (int i = 0; i < 8; i++) s.a[i] = side * l.a[i] * g.uniform(0.7, 1.3);
    t.h = l.h;
    const double e = (1 + s.k) * s.c * s.c, domain = e > 0 ? 1 / std::sqrt(e) : HUGE_VAL;
    if (t.h > 0.95 * domain) t.h = 0.95 * domain;
    if (l.rim) s.semi_diameter = t.h;
    t.aimed = !g.chance(0.1);
    const double tilt = g.uniform(0, 35) * pi / 180, about = g.uniform(0, 2 * pi),
                 away = g.uniform(l.near, l.far);
    double r = t.aimed ? t.h * std::sqrt(g.uniform(0, 1)) : t.h * g.uniform(1, 1.3);
    if (l.vertex) r = 50 * l.graze * g.uniform(0, 1);
    const double at = g.uniform(0, 2 * pi);
    sgt_vec3 target = {r * std::cos(at), r * std::sin(at), rough_sag(s, r * r)},
             d = {std::sin(tilt) * std::cos(about), std::sin(tilt) * std::sin(about), std::cos(tilt)};
    if (l.graze > 0) { // in the tangent plane, then lifted
        double slope = s.c / std::sqrt(1 - e * r * r), power = 1;
        for (int i = 0; i < 8; i++, power *= r * r) slope += (2 * i + 2) * s.a[i] * power;
        slope *= r;
        const double m = std::sqrt(1 + slope * slope), lift = g.sign() * l.graze, out = std::cos(about) / m,
                     across = std::sin(about);
        const double radial = out - lift * slope / m, axial = out * slope + lift / m;
        d = {radial * std::cos(at) - across * std::sin(at), radial * std::sin(at) + across * std::cos(at),
             axial};
    } else if (g.chance(0.5)) d = {-d.x, -d.y, -d.z};
    t.ray.o = {target.x - away * d.x, target.y - away * d.y, target.z - away * d.z};
    t.ray.d = {d.x * l.way, d.y * l.way, d.z * l.way};
    return t;
}

// All lengths times `by`; a term that no double holds is left out.
test_case scaled(test_case t, double by)
{
    sgt_even_asphere &s = t.surface;
    s.c /= by;
    s.semi_diameter *= by;
    for (int i = 0; i < 8; i++)
        for (int j = 0; j < 2 * i + 1; j++) {
            s.a[i] /= by;
            if (!(std::fabs(s.a[i]) < 1e300 && std::fabs(s.a[i]) > 1e-300)) s.a[i] = 0;
        }
    t.h *= by;
    t.ray.o = {t.ray.o.x * by, t.ray.o.y * by, t.ray.o.z * by};
    return t;
}

// ---------------------------------------------------------------- level sets

brute::level_set as_brute(const level &f)
{
    brute::level_set s = {};
    s.power = f.s.power;
    s.iterations = f.s.iterations;
    s.escape = f.s.escape;
    const double *const axis[] = {f.s.ex, f.s.ey, f.s.ez};
    for (std::size_t i = 0; i < 4; i++) {
        s.c[i] = f.s.c[i];
        s.at[i] = f.s.at[i];
        for (std::size_t j = 0; j < 3; j++) s.axis[j][i] = axis[j][i];
    }
    return s;
}

// A root of q in the quaternions: (|q| + q) / |..| times the square root of |q|.
void root_of(double q[4], bool minus)
{
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    double v[4] = {q[0] + length, q[1], q[2], q[3]};
    const double n = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
    for (int i = 0; i < 4; i++)
        q[i] = n > 0 ? v[i] / n * std::sqrt(length) * (minus ? -1 : 1) : i == 1 ? std::sqrt(length) : 0;
}

// A Julia set, c in a random direction, and a ray: half at a point of it, found by going N levels
// back from a point of |Q| = E (the slice is moved so that it lies in it), half at any of its ball.
void draw(generator &g, int n, double size, level *f, sgt_ray *ray)
{
    *f = level();
    f->s.iterations = n;
    f->s.power = 2;
    double way[4], q[4];
    random_unit(g, way);
    for (int i = 0; i < 4; i++) f->s.c[i] = size * way[i];
    f->s.ex[0] = f->s.ey[1] = f->s.ez[2] = 1;
    f->s.escape = safe_escape(*f);
    const double radius = f->s.escape;
    sgt_vec3 aim = random_point(g, 0.6 * radius);
    f->s.at[3] = 0.1 * g.uniform(-1, 1);
    if (g.chance(0.5)) {
        random_unit(g, q);
        for (double &x : q) x *= radius;
        for (int i = 0; i < n; i++) {
            for (int j = 0; j < 4; j++) q[j] -= f->s.c[j];
            root_of(q, g.chance(0.5));
        }
        aim = {q[0], q[1], q[2]};
        f->s.at[3] = q[3];
    }
    const sgt_vec3 d = random_way(g);
    const double away = radius * g.uniform(2, 5);
    *ray = {{aim.x - away * d.x, aim.y - away * d.y, aim.z - away * d.z}, d, 0, 0};
}

// |Q_N|^2 / E^2 - 1 and its derivatives, in 113 bits: by x, y, z, and the sum of |input dF/d(input)|.
struct level_point {
    quad f, gradient[3], inputs;
};

level_point look(const level &f, const sgt_ray &ray, quad t)
{
    typedef quaternion<quad> Q;
    const quad o[3] = {ray.o.x, ray.o.y, ray.o.z}, d[3] = {ray.d.x, ray.d.y, ray.d.z};
    Q q = in_slice(f, o[0] + t * d[0], o[1] + t * d[1], o[2] + t * d[2]);
    const Q c = constant<quad>(f.s.c);
    Q by_point[4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}, by_c[4] = {};
    for (int n = 0; n < f.s.iterations; n++) {
        for (int i = 0; i < 4; i++) {
            by_point[i] = q * by_point[i] + by_point[i] * q;
            by_c[i] = q * by_c[i] + by_c[i] * q;
            (i == 0 ? by_c[i].a : i == 1 ? by_c[i].b : i == 2 ? by_c[i].c : by_c[i].d) += 1;
        }
        q = q * q + c;
    }
    const quad e2 = quad(f.s.escape) * f.s.escape;
    level_point p = {};
    quad slope2 = 0;
    p.f = dot(q, q) / e2 - 1;
    for (int i = 0; i < 4; i++) {
        const quad slope = 2 * dot(q, by_point[i]) / e2;
        if (i < 3)
            p.gradient[i] = slope, p.inputs += magnitude(slope) * (magnitude(o[i]) + magnitude(t * d[i]));
        p.inputs += magnitude(slope * f.s.at[i]);
        const quad other = 2 * dot(q, by_c[i]) / e2;
        slope2 += other * other;
    }
    p.inputs += square_root(slope2 * dot(c, c)) + 2 * dot(q, q) / e2; // of c as a whole; of E
    return p;
}

void ask_level(row &r, const level &f, const sgt_ray &ray)
{
    const brute::level_set set = as_brute(f);
    const brute::line line(set, {{ray.o.x, ray.o.y, ray.o.z}, {ray.d.x, ray.d.y, ray.d.z}});
    const brute::exact_line exact(set, {{ray.o.x, ray.o.y, ray.o.z}, {ray.d.x, ray.d.y, ray.d.z}});
    // The first change that steps of a thousandth of E see and 113 bits confirm.
    double first = HUGE_VAL;
    for (const brute::change &c : brute::changes(set, line, 1e-3 * f.s.escape, false))
        if (exact.is_inside(c.lo) != exact.is_inside(c.hi)) {
            first = to_double(exact.root(c.lo, c.hi));
            break;
        }
    r.rays++;
    for (int i = 0; i < 3; i++) {
        sgt_options options = {};
        options.proof = proofs[i];
        const sgt_hit h = sgt_intersect({&sgt_julia_ops, &f.s}, ray, &options);
        const auto fault = [&](long *n, const char *why) {
            ++*n;
            complain(r, why, proofs[i], [&] {
                std::fprintf(
                    stderr, "    julia N %d E %a c %a %a %a %a at %a %a %a %a o %a %a %a d %a %a %a\n",
                    f.s.iterations, f.s.escape, f.s.c[0], f.s.c[1], f.s.c[2], f.s.c[3], f.s.at[0], f.s.at[1],
                    f.s.at[2], f.s.at[3], ray.o.x, ray.o.y, ray.o.z, ray.d.x, ray.d.y, ray.d.z);
                print_hit(h);
                std::fprintf(stderr, "    first seen %.17g\n", first);
            });
        };
        r.evals[i] += h.evals;
        if (h.status < 0) {
            r.undecided[i]++;
            if (h.status == SGT_INVALID) fault(&r.wrong, "valid input called invalid");
            else if (first < h.lo) fault(&r.wrong, "undecided, and a root that counts lies before lo");
            else if (shown) {
                long none = 0;
                fault(&none, "undecided");
            }
            // Where F leaves its own rounding at neither end, the problem hides the answer.
            const level_point p = look(f, ray, (quad(h.lo) + h.hi) / 2);
            blame(r, magnitude(p.f) <= 16 * u * p.inputs ? problem : method);
            continue;
        }
        if (h.status == SGT_MISS) {
            if (first < HUGE_VAL) fault(&r.missed, "missed, and a root counts");
            continue;
        }
        if (h.status == SGT_GRAZE) continue;
        const quad lo = quad(h.t) - h.t_err, hi = quad(h.t) + h.t_err;
        if (!exact.changes_within(lo, hi)) {
            fault(first < HUGE_VAL ? &r.wrong : &r.falsely, "no root within t_err");
            continue;
        }
        if (first < h.t - h.t_err) fault(&r.wrong, "not the first root");
        if (i > 0) {
            int changes = 0;
            for (int k = 0; k < 64; k++)
                changes += exact.is_inside(lo + (hi - lo) * k / 64) !=
                           exact.is_inside(lo + (hi - lo) * (k + 1) / 64);
            if (changes > 1) fault(&r.wrong, "a second root within t_err");
        }
        const quad root = exact.root(lo, hi), off = magnitude(root - h.t),
                   whole = magnitude(root - h.t - h.t_lo);
        if (!(whole <= quad(h.t_err))) fault(&r.wrong, "t + t_lo is farther off than t_err");
        const quad moved = norm({h.p.x - (ray.o.x + root * ray.d.x), h.p.y - (ray.o.y + root * ray.d.y),
                                 h.p.z - (ray.o.z + root * ray.d.z)});
        if (!(moved <= quad(h.p_err) * (1 + quad(1e-9)) + quad(0x1p-108) * norm({h.p.x, h.p.y, h.p.z})))
            fault(&r.wrong, "p is farther off than p_err");

        const level_point at = look(f, ray, root), here = look(f, {h.p, ray.d, 0, 0}, 0);
        const quad length = norm({at.gradient[0], at.gradient[1], at.gradient[2]}),
                   slope = magnitude(at.gradient[0] * ray.d.x + at.gradient[1] * ray.d.y +
                                     at.gradient[2] * ray.d.z);
        errors e = {};
        e.unit = e.length_unit = ulp(std::max({std::fabs(h.p.x), std::fabs(h.p.y), std::fabs(h.p.z)}));
        e.normal = magnitude(here.f) / norm({here.gradient[0], here.gradient[1], here.gradient[2]});
        e.cosine = slope / length;
        e.t = off * slope / length;
        e.t_whole = whole * slope / length;
        e.normal_bound = u *
                             (magnitude(at.gradient[0] * h.p.x) + magnitude(at.gradient[1] * h.p.y) +
                              magnitude(at.gradient[2] * h.p.z)) /
                             length +
                         e.unit / 2;
        e.t_bound = u * at.inputs / length + quad(ulp(h.t) / 2) * e.cosine;
        e.condition = to_double(at.inputs / (slope * magnitude(root)));
        e.ratio = h.t_err / std::max(to_double(off), ulp(h.t) / 2);
        // (the parameters are inputs of p too)
        e.normal_bound = std::max(e.normal_bound, u * here.inputs / length);
        if (shown && beyond(e)) {
            long none = 0;
            fault(&none, "lost by the method");
            print_errors(e);
        }
        take(r, e);
    }
}

// -------------------------------------------------------------------- tables

std::string number(double x, int digits = 2)
{
    if (x != x) return "-";
    char text[40];
    std::snprintf(text, sizeof text, "%.*g", digits, x);
    std::string s = text;
    for (const char *sign : {"e+0", "e+", "e-0"}) {
        const std::size_t at = s.find(sign);
        if (at != std::string::npos) s.replace(at, std::strlen(sign), sign[1] == '-' ? "e-" : "e");
    }
    if (x >= 10 && x < 1e4) std::snprintf(text, sizeof text, "%.0f", x), s = text;
    return s;
}

std::string pair(double a, double b) { return number(a) + ", " + number(b); }

std::string percent(long n, long of)
{
    if (n == 0) return "0";
    if (n == of) return "100";
    return number(std::min(99.9, 100 * double(n) / double(std::max(of, 1L))));
}

struct table {
    std::string title, head;
    bool path; // has that column
    std::vector<std::pair<std::string, std::function<void(row &, generator, long)>>> rows;
};

std::string cells(const table &w, row &r)
{
    std::string s = "| " + r.name + " | " + number(r.normal.quantile(1)) + " | " +
                    number(r.t.quantile(0.99)) + " | " + number(r.t_whole.quantile(1)) + " | ";
    if (w.path) s += number(r.path.quantile(1)) + " | ";
    s += pair(r.t_err.quantile(0.5), r.t_err.quantile(0.99)) + " | " + number(r.condition.quantile(0.5)) +
         " | " + loser_names[r.lost] + " | ";
    s += std::to_string(r.wrong) + ", " + std::to_string(r.falsely) + ", " + std::to_string(r.missed) + " | ";
    for (int i = 0; i < 3; i++)
        s += (i ? ", " : "") + number(double(r.evals[i]) / double(std::max(r.rays, 1L)));
    s += " | ";
    for (int i = 0; i < 3; i++) s += (i ? ", " : "") + percent(r.undecided[i], r.rays);
    return s + " |";
}

std::vector<table> tables()
{
    std::vector<table> all;
    const auto add = [&](const char *title, const char *head, bool path = true) {
        all.push_back({title, head, path, {}});
    };
    const auto sag = [&](const std::string &name, const std::function<test_case(generator &)> &make) {
        all.back().rows.push_back({name, [make](row &r, generator g, long count) {
                                       for (long i = 0; i < count; i++) {
                                           const test_case t = make(g);
                                           ask(r, t, g);
                                       }
                                   }});
    };
    const auto lens = [&](const std::string &name, const lens_row &l) {
        for (bool asphere : {false, true}) {
            lens_row which = l;
            which.asphere = asphere;
            sag(name + (asphere ? ", asphere" : ", conic"), [which](generator &g) { return draw(g, which); });
        }
    };

    add("Scale", "semi-diameter");
    for (double size : {1e-150, 1e-143, 1e-100, 1e-10, 1.0, 1e10, 1e100, 1e150})
        for (bool rim : {true, false}) {
            if (!rim && size != 1e-150) continue;
            for (bool asphere : {false, true}) {
                lens_row l;
                l.asphere = asphere;
                l.rim = rim;
                l.h = 9.99; // (at 1e150 itself the library stops)
                sag(number(size) + (asphere ? ", asphere" : ", conic") +
                        (rim ? "" : ", without semi_diameter"),
                    [l, size](generator &g) { return scaled(draw(g, l), size / 10); });
            }
        }

    add("Curvature", "1/mm");
    for (double c : {0.0, 1e-300, 1e-150, 1e-15, 1e-5, 0.02, 0.11, 1e3, 1e6, 1e12}) {
        lens_row l;
        l.c = c;
        if (c > 0.2) {
            l.h = 1 / c; // a point of a surface, seen from a lens away
            for (int i = 0; i < 8; i++) l.a[i] = i < 3 ? 0.1 * std::pow(c, 2 * i + 1) : 0;
        }
        lens(number(c), l);
    }
    for (double c : {1e150, 1e300})
        for (bool asphere : {false, true}) {
            lens_row l;
            l.asphere = asphere;
            l.rim = false;
            sag(number(c) + (asphere ? ", asphere" : ", conic") + ", from 50 radii",
                [l, c](generator &g) { return scaled(draw(g, l), 0.02 / c); });
        }

    add("Conic constant", "k");
    for (double k : {-1e15, -1e6, -1e3, -1 - 1e-12, -1.0, -1 + 1e-12, 0.0, 1e3, 1e6, 1e15}) {
        lens_row l;
        l.k = k;
        const std::string name = k == -1 - 1e-12   ? "-1 - 1e-12"
                                 : k == -1 + 1e-12 ? "-1 + 1e-12"
                                 : k < 0           ? "-" + number(-k)
                                                   : number(k);
        lens(name, l);
    }

    add("Incidence", "rad from grazing");
    for (bool vertex : {true, false})
        for (double angle : {0.1, 1e-3, 1e-6, 1e-9, 1e-12}) {
            lens_row l;
            l.graze = angle;
            l.vertex = vertex;
            lens(number(angle) + (vertex ? " at the vertex" : " anywhere"), l);
        }

    add("Distance of the origin", "mm");
    for (double away : {1e-3, 1.0, 1e3, 1e6, 1e9, 1e12, 1e15}) {
        lens_row l;
        l.near = 0.7 * away, l.far = 1.3 * away;
        lens(number(away), l);
    }

    add("Size of the coefficients", "terms at the rim, over its radius");
    for (double size : {1e-300, 1e-15, 1e-6, 1e-2, 1.0, 1e2, 1e4, 1e6})
        for (bool cancel : {false, true}) {
            if (cancel && size < 1) continue;
            lens_row l;
            l.asphere = true;
            for (int i = 0; i < 8; i++)
                l.a[i] = cancel   ? (i % 2 ? -1 : 1) * size * std::pow(10, -2 * i - 1)
                         : i == 1 ? size * 1e-3
                                  : 0;
            sag(number(size) + (cancel ? ", all eight, of both signs" : ", r^4"),
                [l](generator &g) { return draw(g, l); });
        }

    add("Length of the direction", "mm");
    for (double way : {1e-300, 1e-150, 1e-3, 1e3, 1e150, 1e300}) {
        lens_row l;
        l.way = way;
        lens(number(way), l);
    }

    const auto julia = [&](const std::string &name, int n, double size) {
        all.back().rows.push_back({name, [n, size](row &r, generator g, long count) {
                                       for (long i = 0; i < count / 4 + 1; i++) {
                                           level f;
                                           sgt_ray ray;
                                           draw(g, n, size, &f, &ray);
                                           ask_level(r, f, ray);
                                       }
                                   }});
    };
    add("Julia set: N", "N, \\|c\\| = 0.8", false);
    for (int n : {1, 3, 5, 7, 9, 11, 14, 20, 30}) julia(std::to_string(n), n, 0.8);
    add("Julia set: size of c", "\\|c\\|, N = 7; from 1e3 on 2", false);
    for (double c : {0.0, 1e-3, 0.4, 0.8, 1.2, 2.0, 10.0}) julia(number(c), 7, c);
    for (double c : {1e3, 1e6}) julia(number(c), 2, c);
    return all;
}

// What the page says of a row: nothing undecided (by each proof), and who lost.
struct promise {
    bool decided[3];
    loser lost;
};

std::vector<std::string> split(const std::string &line)
{
    std::vector<std::string> cells;
    std::size_t at = 1, next;
    while ((next = line.find('|', at)) != std::string::npos) {
        std::string cell = line.substr(at, next - at);
        const std::size_t from = cell.find_first_not_of(' '), to = cell.find_last_not_of(' ');
        cells.push_back(from == std::string::npos ? "" : cell.substr(from, to - from + 1));
        at = next + 1;
    }
    return cells;
}

std::map<std::string, promise> read_page(const char *path)
{
    std::ifstream file(path);
    std::map<std::string, promise> rows;
    std::string line, title;
    bool inside = false;
    while (std::getline(file, line)) {
        if (line.find("<!-- table extremes") == 0) inside = true;
        if (line.find("<!-- table extremes: to here") == 0) inside = false;
        if (!inside) continue;
        if (line.find("### ") == 0) title = line.substr(4);
        if (line.find("| ") != 0) continue;
        const std::vector<std::string> cells = split(line);
        if (cells.size() < 8 || cells.back().find('%') != std::string::npos) continue;
        promise p = {};
        const std::string &undecided = cells.back(), &lost = cells[cells.size() - 4];
        int which = 0;
        std::size_t at = 0;
        while (which < 3) {
            const std::size_t next = std::min(undecided.find(", ", at), undecided.size());
            p.decided[which++] = undecided.substr(at, next - at) == "0";
            at = std::min(next + 2, undecided.size());
        }
        p.lost = lost == "nothing" ? nothing : lost == "problem" ? problem : method;
        rows[title + ": " + cells[0]] = p;
    }
    return rows;
}

} // namespace

int main(int argc, char **argv)
{
    const char *page = nullptr, *only = nullptr;
    std::uint64_t seed = 20261121;
    long count = 0;
    for (int i = 1; i < argc; i++) {
        if (!std::strcmp(argv[i], "--count") && i + 1 < argc) count = std::strtol(argv[++i], nullptr, 0);
        else if (!std::strcmp(argv[i], "--seed") && i + 1 < argc) seed = std::strtoull(argv[++i], nullptr, 0);
        else if (!std::strcmp(argv[i], "--row") && i + 1 < argc) only = argv[++i];
        else page = argv[i];
    }
    bool usual = seed == 20261121;
    if (const char *e = std::getenv("SAGITTA_TEST_SEED"))
        usual = usual && std::strtoull(e, nullptr, 0) == seed, seed = std::strtoull(e, nullptr, 0);
    if (!count) {
        const char *scale = std::getenv("SAGITTA_TEST_SCALE");
        count = std::max(1L, static_cast<long>(60 * (scale ? std::atof(scale) : 0.5)));
    }
    shown = only != nullptr;
    usual = usual && count <= 2000; // then the rays are among those of the page
    std::map<std::string, promise> said;
    if (page) {
        said = read_page(page);
        if (said.empty()) return std::printf("%s: no table of extremes\n", page), 1;
        std::printf("seed %" PRIu64 ", %ld rays a row, %zu rows on the page\n", seed, count, said.size());
    }

    const auto began = std::chrono::steady_clock::now();
    std::uint64_t index = 0;
    long failures = 0, answers = 0, unsure = 0, undecided = 0, rows = 0;
    for (table &w : tables()) {
        if (!page && !only) {
            std::printf("### %s\n\n| %s | normal, worst | t, 99 %% | t + t_lo, worst | %st_err: median, 99 "
                        "%% | condition | lost by | wrong, false, missed | evaluations | undecided, %% "
                        "|\n|---|---|---|---|---|---|---|---|---|---|%s\n",
                        w.title.c_str(), w.head.c_str(), w.path ? "path, worst | " : "",
                        w.path ? "---|" : "");
        }
        for (const auto &make : w.rows) {
            index++;
            const std::string key = w.title + ": " + make.first;
            if (only && key != only) continue;
            row r;
            r.name = make.first;
            generator g(seed + 0x1000003u * index);
            make.second(r, g, count);
            rows++;
            answers += 3 * r.rays;
            unsure += r.unsure;
            for (long n : r.undecided) undecided += n;
            if (r.wrong || r.falsely || r.missed)
                failures++, std::fprintf(stderr, "FAIL %s: wrong %ld, false %ld, missed %ld\n", key.c_str(),
                                         r.wrong, r.falsely, r.missed);
            if (r.t.quantile(0.99) > 1000) blame(r, problem);
            if (r.unsure > r.rays / 100 + 1)
                failures++, std::fprintf(stderr, "FAIL %s: the oracle could not tell %ld times\n",
                                         key.c_str(), r.unsure);
            if (!page) {
                std::printf("%s\n", cells(w, r).c_str());
                std::fflush(stdout);
                continue;
            }
            if (!said.count(key)) {
                failures++, std::printf("FAIL %s is not on the page\n", key.c_str());
                continue;
            }
            const promise &p = said[key];
            for (int i = 0; i < 3; i++)
                if (p.decided[i] && r.undecided[i] > (usual ? 0 : 1 + r.rays / 1000))
                    failures++, std::printf("FAIL %s: %ld undecided (%s), the page says 0\n", key.c_str(),
                                            r.undecided[i], proof_names[i]);
            if (usual && r.lost == method && p.lost != method)
                failures++, std::printf("FAIL %s: lost by %s, the page says %s\n", key.c_str(),
                                        loser_names[r.lost], loser_names[p.lost]);
        }
        if (!page && !only) std::printf("\n");
    }
    if (page && !only && said.size() != std::size_t(rows))
        failures++, std::printf("FAIL the page has %zu rows, and there are %ld\n", said.size(), rows);
    std::fprintf(
        page ? stdout : stderr,
        "%ld rows, %ld answers, %ld undecided, %ld rays that the oracle cannot tell, %ld failures, %.1f s\n",
        rows, answers, undecided, unsure, failures,
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
    return failures != 0;
}
