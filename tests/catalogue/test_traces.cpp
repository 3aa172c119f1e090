// SPDX-License-Identifier: MIT
// What sgt_trace says of a ray at each element, against the ray that was given, in 113 bits.
//
//   roots   t, t_err, p and p_err of each row.  The ray is the launch ray as given, or the doubles of the
//           row before, taken
//           by the poses as stored; its root is polished by Newton's method on F of formulas.h.  Lenses
//             have tilts,
//           decentres, mirrors and places far from the origin; launches have lengths from 2^-300 to 2^300,
//             come from up to
//           1e12 away, and at grazing incidence.  No root may be outside t_err, no point outside p_err; and
//             t_err may not
//           be wide: its median is pinned.
//   paths   opl of each row is the sum of index * (t + t_lo) of the rows, to the rounding of the sum: what
//           the far way in
//           has added, a reference plane takes away again, and what is left is as good as from nearby.
//   angles  refraction near total reflection: what rounding does to Q = 1 - r^2 s^2 is searched for its
//     largest by
//           climbing from the worst of random rays.
#include "specimens.h"

#include <sagitta/system.h>

#include <algorithm>
#include <cstring>

using namespace catalogue;
using oracle::magnitude;

namespace {

long failures;

struct v3 { quad x, y, z; };
v3 wide(const sgt_vec3 &a) { return {a.x, a.y, a.z}; }
v3 operator+(const v3 &a, const v3 &b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
v3 operator-(const v3 &a, const v3 &b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
v3 operator*(quad s, const v3 &a) { return {s * a.x, s * a.y, s * a.z}; }
quad dot(const v3 &a, const v3 &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
quad length(const v3 &a) { return square_root(dot(a, a)); }
v3 unit(const v3 &a) { return (1 / length(a)) * a; }

bool is_turned(const sgt_pose &p) { return p.ex.x != 0 || p.ex.y != 0 || p.ex.z != 0; }
v3 into(const sgt_pose &p, const v3 &a)
{
    return is_turned(p) ? v3{dot(a, wide(p.ex)), dot(a, wide(p.ey)), dot(a, wide(p.ez))} : a;
}
v3 out_of(const sgt_pose &p, const v3 &a)
{
    return is_turned(p) ? a.x * wide(p.ex) + (a.y * wide(p.ey) + a.z * wide(p.ez)) : a;
}

// The root near *t of the ray o + t d, and the gradient there; false: there may be none.
bool polish(const sgt_surface &s, const v3 &o, const v3 &d, quad *t, v3 *n)
{
    typedef dual<quad, 3> number;
    const formula<number> f(s);
    const quad size = length(o) + magnitude(*t);
    for (int i = 0; i < 12; i++) {
        const v3 p = o + *t * d;
        const number g = f(number::variable(p.x, 0), number::variable(p.y, 1), number::variable(p.z, 2));
        *n = {g.v[0], g.v[1], g.v[2]};
        const quad step = g.a / dot(*n, d);
        if (!(magnitude(step) < size)) return false;
        *t = *t - step;
        if (magnitude(step) <= quad(1e-26) * size) return true;
    }
    return false;
}

// --------------------------------------------------------------------- lenses

enum { ELEMENTS = 5 };
struct lens {
    sgt_element e[ELEMENTS];
    std::vector<specimen> kept;
    sgt_vec3 at; // of its first element
};

lens random_lens(generator &g)
{
    static const char *const kinds[] = {"conic",     "conic", "asphere", "toroidal", "biconic",
                                        "ellipsoid", "torus", "quadric", "q_bfs",    "zernike"};
    lens l = {};
    const bool tilts = g.chance(0.5), decentred = g.chance(0.5);
    if (g.chance(0.4)) l.at = {g.uniform(-1, 1) * 1e3, g.uniform(-1, 1) * 1e3, g.uniform(-1, 1) * 1e3};
    double z = 0, way = 1;
    for (sgt_element &e : l.e) {
        const std::string kind = kinds[g.below(g.chance(0.8) ? 3 : 10)];
        specimen s = {};
        if (kind == "conic" || kind == "asphere") {
            const double c = g.chance(0.2) ? 0 : g.sign() / g.log_uniform(8, 1000),
                         k = g.chance(0.5) ? 0 : g.uniform(-2, 1);
            if (kind == "conic") s.s = {&sgt_conic_ops, s.keep(sgt_conic{c, k, 0})};
            else
                s.s = {
                    &sgt_even_asphere_ops,
                    s.keep(sgt_even_asphere{c, k, 0, {0, g.uniform(-1e-5, 1e-5), g.uniform(-1e-8, 1e-8)}})};
        } else {
            do s = random_specimen(g, kind);
            while (s.h < 2 || s.h > 40);
        }
        l.kept.push_back(s);
        const sgt_vec3 o = {l.at.x + (decentred ? g.uniform(-0.2, 0.2) : 0),
                            l.at.y + (decentred ? g.uniform(-0.2, 0.2) : 0), l.at.z + z};
        const double most = g.chance(0.5) ? 5 : 30;
        e = {};
        e.surface = s.s;
        e.pose.origin = o;
        if (tilts && g.chance(0.6))
            e.pose = sgt_pose_tilted(
                o, {most * g.uniform(-1, 1), most * g.uniform(-1, 1), g.uniform(-180, 180)});
        e.index = g.chance(0.1) ? SGT_MIRROR : g.chance(0.1) ? 0 : g.uniform(1, 2);
        if (e.index == SGT_MIRROR) way = -way;
        z += way * g.uniform(0.5, 6);
    }
    return l;
}

enum launch { ALONG_AXIS, UNIT, POWERS, LENGTHS, FAR, GRAZING, LATER };
const char *const names[] = {"along the axis", "unit length", "2^k times", "any length",
                             "from afar",      "grazing",     "later"};

sgt_ray random_launch(generator &g, const lens &l, launch kind)
{
    sgt_vec3 d = {g.uniform(-0.2, 0.2), g.uniform(-0.2, 0.2), 1},
             p = {l.at.x + g.uniform(-2, 2), l.at.y + g.uniform(-2, 2), l.at.z};
    if (kind == ALONG_AXIS) d = {0, 0, 1};
    if (kind == GRAZING) d.z = g.log_uniform(1e-5, 0.3);
    const double away = kind == FAR ? g.log_uniform(100, 1e12) : g.chance(0.05) ? 0 : g.uniform(1, 20);
    const double size = std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
    const double times = kind == POWERS    ? std::ldexp(1 / size, g.below(601) - 300)
                         : kind == LENGTHS ? g.log_uniform(1e-90, 1e90)
                                           : 1 / size;
    return {{p.x - away * d.x, p.y - away * d.y, p.z - away * d.z},
            {times * d.x, times * d.y, times * d.z},
            0,
            0};
}

// ---------------------------------------------------------------------- roots

struct tally {
    long rows, outside, p_outside, left;
    double worst, p_worst, condition;
    std::vector<double> wide; // t_err in half ulps of what t is made of
};
tally tallies[LATER + 1][2];

void print_row(const char *what, const lens &l, const sgt_ray &launch, std::size_t j, const sgt_hit &h,
               quad truth)
{
    if (failures++ >= 5) return;
    std::printf("FAIL element %zu, %s: t %.17g t_lo %.3g t_err %.3g p_err %.3g, the root %s\n", j, what, h.t,
                h.t_lo, h.t_err, h.p_err, oracle::text(truth).c_str());
    std::printf("    ray {{%a, %a, %a}, {%a, %a, %a}}\n", launch.o.x, launch.o.y, launch.o.z, launch.d.x,
                launch.d.y, launch.d.z);
    for (std::size_t i = 0; i <= j; i++) {
        const sgt_pose &p = l.e[i].pose;
        std::printf("    index %a, origin %a %a %a, ex %a %a %a, ey %a %a %a, ez %a %a %a\n", l.e[i].index,
                    p.origin.x, p.origin.y, p.origin.z, p.ex.x, p.ex.y, p.ex.z, p.ey.x, p.ey.y, p.ey.z,
                    p.ez.x, p.ez.y, p.ez.z);
        print_surface(l.e[i].surface);
    }
}

void check_root(const lens &l, const sgt_ray &launch, enum launch kind, const sgt_passage *p, std::size_t j)
{
    const sgt_hit &h = p[j].hit;
    const sgt_pose &pose = l.e[j].pose;
    const double power = std::ldexp(
        1.0,
        -std::ilogb(std::max(std::fabs(launch.d.x), std::max(std::fabs(launch.d.y), std::fabs(launch.d.z)))));
    v3 o, d;
    if (j == 0) {
        o = into(pose, wide(launch.o) - wide(pose.origin)), d = into(pose, quad(power) * wide(launch.d));
    } else {
        const sgt_pose &before = l.e[j - 1].pose;
        o = into(pose, out_of(before, wide(p[j - 1].hit.p)) + wide(before.origin) - wide(pose.origin));
        d = into(pose, out_of(before, wide(p[j - 1].direction)));
    }
    d = unit(d);
    quad t = quad(h.t) + h.t_lo;
    v3 n;
    tally &w = tallies[j == 0 ? kind : LATER][is_turned(pose) || (j > 0 && is_turned(l.e[j - 1].pose))];
    const bool found = polish(l.e[j].surface, o, d, &t, &n);
    const double condition = found ? plain(length(n) / magnitude(dot(n, d))) : HUGE_VAL;
    if (!(condition < 0x1p22)) {
        w.left++;
        return;
    }
    const double off = plain(magnitude(t - h.t)), p_off = plain(length(o + t * d - wide(h.p)));
    w.rows++;
    w.worst = std::max(w.worst, off / h.t_err), w.p_worst = std::max(w.p_worst, p_off / h.p_err),
    w.condition = std::max(w.condition, condition);
    if (condition < 2) w.wide.push_back(h.t_err / (0x1p-53 * (std::fabs(h.t) + plain(length(o)))));
    if (!(off <= h.t_err)) w.outside++, print_row("t is farther off than t_err", l, launch, j, h, t);
    if (!(p_off <= h.p_err)) w.p_outside++, print_row("p is farther off than p_err", l, launch, j, h, t);
    if (!(h.lo <= h.t && h.t <= h.hi && quad(h.lo) <= t && t <= quad(h.hi)))
        print_row("the root is not in [lo, hi]", l, launch, j, h, t);
}

// ---------------------------------------------------------------------- paths

double worst_path;

// The path so far by the rows, and what opl is off by, in half ulps of itself (and of 2^-45 of its largest
// part).
void check_path(const lens &l, const sgt_ray &launch, const sgt_passage *p, std::size_t j, double index,
                quad *path, quad *largest)
{
    const sgt_hit &h = p[j].hit;
    const quad part = quad(index) * (quad(h.t) + quad(h.t_lo));
    *path = *path + part, *largest = std::max(*largest, magnitude(part));
    const quad apart = magnitude(*path - quad(p[j].opl));
    const double off = apart == 0
                           ? 0
                           : plain(apart / (quad(0x1p-53) * magnitude(*path) + quad(0x1p-98) * *largest));
    worst_path = std::max(worst_path, off);
    if (!(off <= 1.01)) print_row("opl is not the sum of the rows", l, launch, j, h, *path);
}

void check_traces(generator &g, long count)
{
    for (long i = 0; i < count; i++) {
        const lens l = random_lens(g);
        const launch kind = static_cast<launch>(g.below(LATER));
        const sgt_ray launch = random_launch(g, l, kind);
        sgt_ray ray = launch;
        sgt_passage p[ELEMENTS];
        sgt_fate fate;
        const std::size_t passed = sgt_trace(ELEMENTS, l.e, 1, &ray, p, &fate, nullptr),
                          met = passed + (passed < ELEMENTS && fate > 0);
        quad path = 0, largest = 0;
        double index = 1;
        for (std::size_t j = 0; j < met; j++) {
            check_path(l, launch, p, j, index, &path, &largest);
            if (l.e[j].index > 0) index = l.e[j].index;
            if (p[j].hit.status == SGT_HIT) check_root(l, launch, kind, p, j);
        }
    }
    for (int kind = 0; kind <= LATER; kind++)
        for (int turned = 0; turned < 2; turned++) {
            tally &w = tallies[kind][turned];
            std::sort(w.wide.begin(), w.wide.end());
            const double median = w.wide.empty() ? 0 : w.wide[w.wide.size() / 2];
            std::printf("%-15s %-6s %7ld rows, %ld left out, condition to %.2g: t outside %ld, %.3f of t_err "
                        "at most; p outside %ld, %.3f of p_err; t_err %.2f half ulps of |t| + |o|\n",
                        names[kind], turned ? "turned" : "", w.rows, w.left, w.condition, w.outside, w.worst,
                        w.p_outside, w.p_worst, median);
            if (w.wide.size() > 100 && median > (turned ? 16 : 4))
                failures++, std::printf("FAIL: t_err is wide\n");
            if (w.left * 20 > w.rows + 100) failures++, std::printf("FAIL: too many left out\n");
        }
    std::printf("opl within %.3f half ulps of the sum\n", worst_path);
}

// A reference plane at the launch, met backwards: what is left of the path is of the size of the lens.
// Directions are along the axis, and the places on a grid: both exact, and the truth is worked out from the
// launch alone.
void check_far(generator &g, long count)
{
    double worst = 0;
    for (long i = 0; i < count; i++) {
        const double far = std::rint(g.log_uniform(1e3, 1e12) * 1024) / 1024, x = g.uniform(-1, 1),
                     y = g.uniform(-1, 1), c = g.uniform(-0.05, 0.05);
        const sgt_conic bent = {c, g.uniform(-2, 1), 0}, flat = {0, 0, 0};
        sgt_element e[3] = {};
        e[0].surface = {&sgt_conic_ops, &bent}, e[0].index = 0;
        e[1].surface = {&sgt_conic_ops, &flat}, e[1].pose.origin.z = 1 + g.below(9 * 1024) / 1024.0,
        e[1].index = g.chance(0.5) ? SGT_MIRROR : 0;
        e[2].surface = {&sgt_conic_ops, &flat}, e[2].pose.origin.z = -far, e[2].index = 0;
        const double index = g.uniform(1, 2);
        sgt_ray ray = {{x, y, -far}, {0, 0, g.chance(0.5) ? 1 : std::ldexp(1.0, g.below(100) - 50)}, 0, 0};
        sgt_passage p[3];
        sgt_fate fate;
        if (sgt_trace(3, e, index, &ray, p, &fate, nullptr) != 3)
            failures++, std::printf("FAIL a far ray is %s\n", sgt_fate_text(fate));
        // Forth to the plane and back (or on the same line backwards); the bent surface lies between and
        // bends nothing.
        const quad plane = quad(e[1].pose.origin.z),
                   way = e[1].index == SGT_MIRROR ? 2 * (plane + quad(far)) : quad(0);
        const quad bent_at = -formula<quad>(e[0].surface)(quad(x), quad(y), quad(0)) + quad(far);
        const double off = plain(magnitude(quad(index) * way - quad(p[2].opl))),
                     small = 0x1p-53 * 40 + 0x1p-53 * plain(magnitude(quad(index) * way));
        const double first = plain(magnitude(quad(index) * bent_at - quad(p[0].opl)) /
                                   (quad(index) * bent_at) / quad(0x1p-53));
        worst = std::max(worst, std::max(off / small, first));
        if ((off > small || first > 2) && failures++ < 5)
            std::printf(
                "FAIL from %a away: opl %.17g and %.17g, off by %.3g\n    x %a y %a c %a k %a plane %a\n",
                far, p[0].opl, p[2].opl, off, x, y, c, bent.k, e[1].pose.origin.z);
    }
    std::printf("%ld far launches: what is left of the path within %.3f of what it may be off by\n", count,
                worst);
}

// --------------------------------------------------------------------- angles

// A plane through the origin, of which the gradient is `a`.
double plane_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    const sgt_vec3 &a = *static_cast<const sgt_vec3 *>(self);
    if (grad) *grad = a;
    return a.x * p.x + a.y * p.y + a.z * p.z;
}

struct refraction { sgt_vec3 d, n; double n1, n2; };

// Q by the direction behind, off in 2^-53; 0: reflected, or not near the limit, or d is not of unit length.
double off_by(const refraction &r)
{
    const v3 d = wide(r.d), n = wide(r.n);
    if (!(magnitude(dot(d, d) - 1) <= quad(0x1p-56))) return 0;
    const quad ratio = quad(r.n1) / quad(r.n2), cosine = dot(d, n), along = cosine * cosine / dot(n, n),
               Q = 1 - ratio * ratio * (1 - along);
    if (!(Q > 0 && Q < quad(1e-6))) return 0;
    static sgt_surface_ops ops;
    ops.value = plane_value;
    sgt_element e = {};
    e.surface = {&ops, &r.n}, e.index = r.n2;
    sgt_ray ray = {{0, 0, 0}, r.d, 0, 0};
    sgt_passage p;
    const sgt_options near = {};
    if (sgt_trace(1, &e, r.n1, &ray, &p, nullptr, &near) != 1) return 0;
    const quad behind = dot(wide(p.direction), n);
    return plain(magnitude(behind * behind / dot(n, n) - Q) / quad(0x1p-53));
}

refraction near_limit(generator &g, double ratio)
{
    refraction r = {};
    const double sine = 1 / ratio * (1 - g.log_uniform(1e-14, 1e-7)), about = g.uniform(0, 6.28);
    v3 a, b;
    do
        a = {g.uniform(-1, 1), g.uniform(-1, 1), g.uniform(-1, 1)},
        b = {g.uniform(-1, 1), g.uniform(-1, 1), g.uniform(-1, 1)};
    while (plain(dot(a, a)) < 0.1 || plain(dot(b, b)) < 0.1);
    a = unit(a), b = unit(b - dot(a, b) * a);
    const v3 c = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    const v3 side = quad(std::cos(about)) * b + quad(std::sin(about)) * c,
             d = unit(quad(std::sqrt(1 - sine * sine)) * a + quad(sine) * unit(side));
    const double size = g.uniform(1, 2);
    r.n = {size * plain(a.x), size * plain(a.y), size * plain(a.z)};
    r.d = {plain(d.x), plain(d.y), plain(d.z)};
    r.n2 = g.uniform(1, 2), r.n1 = ratio * r.n2;
    return r;
}

double nudged(generator &g, double x) { return x + g.below(9) * g.sign() * 0x1p-53 * std::fabs(x); }

void check_bending(generator &g, long count)
{
    static const double ratios[][2] = {{1.0001, 1.22}, {1.23, 1.6}, {1.6, 2.4}, {2.4, 4}};
    for (const auto &range : ratios) {
        refraction best = {};
        double most = 0;
        for (long i = 0; i < count; i++) {
            refraction r = best;
            if (most == 0 || i < count / 2 || g.chance(0.1)) r = near_limit(g, g.uniform(range[0], range[1]));
            else {
                if (g.chance(0.5)) r.n = {nudged(g, r.n.x), nudged(g, r.n.y), nudged(g, r.n.z)};
                if (g.chance(0.5)) r.d = {nudged(g, r.d.x), nudged(g, r.d.y), nudged(g, r.d.z)};
                if (g.chance(0.5)) r.n1 = nudged(g, r.n1), r.n2 = nudged(g, r.n2);
            }
            const double off = off_by(r);
            if (off > most) most = off, best = r;
        }
        if (most > 10) failures++, std::printf("FAIL: the limit is told too roughly\n");
        std::printf("refraction near the limit, n1 / n2 from %g to %g: Q within %.2f of 2^-53\n", range[0],
                    range[1], most);
    }
}

} // namespace

int main(int argc, char **argv)
{
    const oracle::run run(argc, argv, 25000, 17);
    generator g(run.seed);
    check_traces(g, run.count);
    check_far(g, run.count / 5 + 1);
    check_bending(g, 8 * run.count);
    std::printf("%ld failures\n", failures);
    return failures != 0;
}
