// SPDX-License-Identifier: MIT
// cliff_search.cpp - looks for cliffs: ordinary input that costs many times what its type mostly costs.
//
//     bench_ordinary --search [--seconds N] [--seed S] [--type T]
//     bench_ordinary --case "type=... shape=... ..."
//
// A CASE is a line of numbers, and from them follow a surface, 256 rays and a way of asking.  They are drawn
// from what users have, each by itself:
//
//     type    each of the catalogue (by its row of sgt_builtins alone: a new one comes by itself), four sags
//             and four bodies as formulas, and a user's sag without and with `enclose`
//     shape   a seed of the coefficients
//     radius  of the part: half of them millimetres (0.5 to 200), half metres (a thousandth)
//     curve   curvature times radius: 0 in a quarter, else of either sign, 1e-4 to 0.9, by its logarithm
//     k       conic constant: 0 or -1 in half, else -3 to 2
//     depart  the largest coefficient by what it adds at the radius, in radii: 0 in a tenth, else 1e-8 to 0.1
//     terms   how many coefficients are not 0: 1 in a third, 2 in a sixth, else all
//     rim     semi_diameter in radii: none in a third, 1 in a half, else 0.3 to 2
//     aim     the rays meet the surface within this many radii about a point: 1 in a half, else 1e-3 to 1.5
//     aside   how far that point is from the axis, in radii: 0 in six of ten, else to 2.5, beside the rim
//     angle   of the central ray with the surface, in degrees: 30 to 90 in a half, else 0.1 to 30, by its
//             logarithm
//     spread  of the directions about it, in degrees: 0 in a third, else 0.01 to 20
//     from    the start before the surface, in radii: 0 in a tenth (on it), 0.1 to 100 in a half, else 1e-9
//             to 1e6; an eighth behind it (negative)
//     batch   rays of a call: 1 (sgt_intersect), 8, 100 or 256
//     pick    1: the first root, 2: near the seed
//     proof   0: none in seven of ten, 1: the root, 2: the first
//
// THE MEASURE is the time of the processor that this thread has had, in ns a ray, beside the median of all
// that has been drawn of the same type, alike single or in batches, and alike in proof.  The search draws
// for two fifths of its time, and so has the medians.  Then it climbs: it changes one or two numbers of one
// of the worst cases of a type and keeps the change if it costs more.
//
// Where the first eight rays cost more than half a millisecond each, these eight are all.
//
// STEADY ON A BUSY MACHINE.  A time is the least of several slices, so that other work only delays.  What
// seems worse than its parent, or is among the worst in the end, is timed again, after another slice of
// time.  A case counts by the least of all its times: it is a cliff only if it is slow each time.
//
// What is told: the ratio, ns a ray, the median beside it, evaluations a ray, how many rays of a hundred
// are met, missed and undecided, and the case.  --case builds the same rays from it, to the last bit.
#include "cliff_search.h"
#include "bench_clock.h"
#include "bench_subjects.h"
#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>
#include <sagitta/formula.h>
#include <sagitta/surfaces.h>

namespace {

using bench::now;
using bench::Random;

constexpr size_t RAYS_OF_CASE = 256, FEW_RAYS = 8, TOLD = 50, KEPT_OF_TYPE = 6;
constexpr double SLICE = 0.2e6;  // ns
constexpr double CLIFF = 3;

double within(Random &dice, double a, double b) { return a + (b - a) * dice.unit(); }
double log_within(Random &dice, double a, double b) { return a * std::pow(b / a, dice.unit()); }
template <class T> T &one_of(Random &dice, std::vector<T> &all)
{
    return all[static_cast<size_t>(dice.unit() * static_cast<double>(all.size()))];
}
double sign(Random &dice) { return dice.unit() < 0.5 ? -1 : 1; }

// ------------------------------------------------------------------- cases

enum Gene { SHAPE, RADIUS, CURVE, CONIC, DEPART, TERMS, RIM, AIM, ASIDE, ANGLE, SPREAD, FROM, BATCH, PICK,
            PROOF, GENES };
const char *const GENE[GENES] = { "shape", "radius", "curve", "k",      "depart", "terms", "rim", "aim",
                                  "aside", "angle",  "spread", "from",  "batch",  "pick",  "proof" };

struct Case {
    std::string type;
    double of[GENES];
    std::string words() const
    {
        std::string said = "type=" + type;
        for (int i = 0; i < GENES; i++) {
            char text[40];
            std::snprintf(text, sizeof text, " %s=%.9g", GENE[i], of[i]);
            said += text;
        }
        return said;
    }
    bool single() const { return of[BATCH] < 2; }
    std::string group() const
    {
        return type + (single() ? " one by one, proof " : " batch, proof ") +
               std::to_string(static_cast<int>(of[PROOF]));
    }
};

// Six digits are enough, and a line stays short.
double short_number(double x)
{
    char text[40];
    std::snprintf(text, sizeof text, "%.4g", x);
    return std::strtod(text, nullptr);
}

double drawn(Random &dice, int gene)
{
    double u = dice.unit();
    switch (gene) {
    case SHAPE: return std::floor(1e6 * u);
    case RADIUS: return log_within(dice, 0.5, 200) * (u < 0.5 ? 1 : 1e-3);
    case CURVE: return u < 0.25 ? 0 : sign(dice) * log_within(dice, 1e-4, 0.9);
    case CONIC: return u < 0.3 ? 0 : u < 0.5 ? -1 : within(dice, -3, 2);
    case DEPART: return u < 0.1 ? 0 : log_within(dice, 1e-8, 0.1);
    case TERMS: return u < 0.33 ? 1 : u < 0.5 ? 2 : 1000;
    case RIM: return u < 0.33 ? 0 : u < 0.83 ? 1 : within(dice, 0.3, 2);
    case AIM: return u < 0.5 ? 1 : log_within(dice, 1e-3, 1.5);
    case ASIDE: return u < 0.6 ? 0 : within(dice, 0, 2.5);
    case ANGLE: return u < 0.5 ? within(dice, 30, 90) : log_within(dice, 0.1, 30);
    case SPREAD: return u < 0.33 ? 0 : log_within(dice, 0.01, 20);
    case FROM:
        return u < 0.1 ? 0
                       : (dice.unit() < 0.125 ? -1 : 1)
                             * (u < 0.6 ? log_within(dice, 0.1, 100) : log_within(dice, 1e-9, 1e6));
    case BATCH: return u < 0.25 ? 1 : u < 0.4 ? 8 : u < 0.6 ? 100 : 256;
    case PICK: return u < 0.7 ? 1 : 2;
    default: return u < 0.7 ? 0 : u < 0.85 ? 1 : 2;
    }
}

// ---------------------------------------------------------------- surfaces

struct Formula { const char *name; sgt_formula_kind kind; const char *text; };
const Formula FORMULAS[] = {  // a: the radius, c: the curvature, k, d: the departure in lengths
    { "formula_conic", SGT_FORMULA_XY, "c*r^2/(1+sqrt(1-(1+k)*c^2*r^2))" },
    { "formula_asphere", SGT_FORMULA_XY, "c*r^2/2+d*(r/a)^4-d*(r/a)^6/3" },
    { "formula_waves", SGT_FORMULA_XY, "c*(x^2+y^2)/2+d*cos(5*x/a)*cos(3*y/a)" },
    { "formula_gauss", SGT_FORMULA_XY, "c*(x^2-y^2)/2+d*exp(-(x^2+2*y^2)/a^2)" },
    { "formula_sphere", SGT_FORMULA_XYZ, "x^2+y^2+z^2=a^2" },
    { "formula_quartic", SGT_FORMULA_XYZ, "x^4+y^4+z^4=a^4" },
    { "formula_torus", SGT_FORMULA_XYZ, "(sqrt(x^2+y^2)-0.7*a)^2+z^2=(0.25*a)^2" },
    { "formula_gyroid", SGT_FORMULA_XYZ,
      "sin(9*x/a)*cos(9*y/a)+sin(9*y/a)*cos(9*z/a)+sin(9*z/a)*cos(9*x/a)=0" },
};

// A user's sag: an even asphere by those of its operations that a user writes.
const sgt_even_asphere *asphere_of(const void *self) { return static_cast<const sgt_even_asphere *>(self); }
double user_value(const void *self, sgt_vec3 p, sgt_vec3 *grad)
{
    return sgt_even_asphere_ops.value(self, p, grad);
}
sgt_span user_span(const void *self, const sgt_ray *ray) { return sgt_even_asphere_ops.span(self, ray); }
double user_rounding(const void *self, sgt_vec3 p) { return sgt_even_asphere_ops.rounding(self, p); }
sgt_interval user_enclose(const void *self, const sgt_ray *ray, sgt_interval t, sgt_interval *slope)
{
    return sgt_even_asphere_ops.enclose(self, ray, t, slope);
}
sgt_surface_ops user_ops(bool enclose)
{
    sgt_surface_ops ops = {};
    ops.name = "user", ops.value = user_value;
    if (sgt_even_asphere_ops.span)
        ops.span = user_span;
    if (sgt_even_asphere_ops.rounding)
        ops.rounding = user_rounding;
    if (enclose && sgt_even_asphere_ops.enclose)
        ops.enclose = user_enclose;
    return ops;
}
const sgt_surface_ops USER_OPS = user_ops(false), USER_ENCLOSED_OPS = user_ops(true);

struct Built {
    sgt_surface s;
    bool sag, level;
    std::vector<std::shared_ptr<void>> kept;
    template <class S> S *keep(const S &from)
    {
        std::shared_ptr<S> p = std::make_shared<S>(from);
        kept.push_back(p);
        return p.get();
    }
};

const sgt_builtin *row_of(const std::string &type)
{
    const sgt_builtin *b = sgt_builtins();
    while (b->type && type != b->type)
        b++;
    return b->type ? b : nullptr;
}

bool is_sag(const sgt_builtin *b)
{
    return b->family == SGT_FAMILY_CONIC || b->family == SGT_FAMILY_ASPHERE ||
           b->family == SGT_FAMILY_DEPARTURE;
}

bool begins(const std::string &text, const char *with) { return text.rfind(with, 0) == 0; }

// Number i, j of a list: falling and of both signs; of a grid's heights a smooth shape.
double number(Random &dice, const Case &c, const sgt_param *p, int i, int j, bool heights, size_t count)
{
    double x = heights ? std::cos(0.6 * i + 0.4 * j) + 0.2 * std::sin(1.1 * j - 0.9 * i)
                       : within(dice, -1, 1) / (1 + 0.3 * (i + j));
    bool first = static_cast<double>(count) < c.of[TERMS] || heights;
    int power = p->unit.length + i * p->unit.by_i + j * p->unit.by_j;
    return first ? c.of[DEPART] * c.of[RADIUS] * x * std::pow(c.of[RADIUS], power - 1) : 0;
}

// A sag of the catalogue by its row: each parameter by its kind and unit.
sgt_surface sag_of(Built &to, Random &dice, const Case &c, const sgt_builtin *row, bool term);

sgt_surface sum_term(Built &to, Random &dice, const Case &c)
{
    std::vector<const sgt_builtin *> rows;
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        if ((b->family == SGT_FAMILY_DEPARTURE || b->family == SGT_FAMILY_ASPHERE) &&
            !begins(b->type, "sum") && b->ops != &sgt_biconic_ops && b->ops != &sgt_toroidal_ops)
            rows.push_back(b);
    return sag_of(to, dice, c, one_of(dice, rows), true);
}

sgt_surface sag_of(Built &to, Random &dice, const Case &c, const sgt_builtin *row, bool term)
{
    std::vector<double> &room = *to.keep(std::vector<double>(row->size / sizeof(double) + 1));
    char *self = reinterpret_cast<char *>(room.data());
    std::memcpy(self, row->specimen, row->size);
    double size = c.of[RADIUS] / 4;  // of a specimen's rim
    int curvatures = 0, conics = 0;
    bool grid = row->ops == &sgt_grid_ops;
    size_t side = grid ? 5 + static_cast<size_t>(within(dice, 0, 40)) : 0;
    for (const sgt_param *p = row->params; p->name; p++) {
        double *x = reinterpret_cast<double *>(self + p->offset);
        bool real = p->kind == SGT_PARAM_REAL;
        if (real && !std::strcmp(p->name, "semi_diameter"))
            *x = term ? 0 : c.of[RIM] * c.of[RADIUS];
        else if (real && p->count == 1 && p->unit.length == -1)
            *x = term            ? 0
                 : curvatures++ ? (dice.unit() < 0.3 ? 0 : c.of[CURVE] / c.of[RADIUS] * within(dice, -1, 1))
                                : c.of[CURVE] / c.of[RADIUS];
        else if (real && p->count == 1 && p->unit.length == 0)
            *x = term ? 0 : conics++ ? within(dice, -2, 1) : c.of[CONIC];
        else if (real && p->count == 1 && grid)
            *x = 10.5 / static_cast<double>(side - 1) * size;
        else if (real && p->count == 1)
            *x *= size * within(dice, 1, 1.3);
        else if (real) {
            bool cone = row->ops == &sgt_odd_asphere_ops;  // by the first number, which is left 0
            x[0] = cone ? 0 : x[0];
            for (int i = cone; i < p->count; i++)
                x[i] = number(dice, c, p, i, 0, false, static_cast<size_t>(i - cone));
        } else if (p->kind == SGT_PARAM_LIST || p->kind == SGT_PARAM_TABLE) {
            bool table = p->kind == SGT_PARAM_TABLE;
            size_t rows = grid ? side : table ? 2 + static_cast<size_t>(within(dice, 0, 6)) : 1,
                   columns = grid ? side : table ? rows : 2 + static_cast<size_t>(within(dice, 0, 35)),
                   counted = 0;
            columns = std::min(columns, static_cast<size_t>(p->count));
            std::vector<double> all(rows * columns);
            for (size_t i = 0; i < rows; i++)
                for (size_t j = 0; j < columns; j++) {
                    int a = static_cast<int>(table ? i : j), b = static_cast<int>(table ? j : 0);
                    bool tilt = p->unit.by_i != 0 && a + b < 2;
                    all[i * columns + j] = tilt ? 0 : number(dice, c, p, a, b, grid, counted++);
                }
            sgt_numbers *own = reinterpret_cast<sgt_numbers *>(x);
            *own = { to.keep(all)->data(), rows, columns };
        } else if (p->kind == SGT_PARAM_TERMS) {
            std::vector<sgt_surface> both = { sum_term(to, dice, c), sum_term(to, dice, c) };
            const sgt_surface *data = to.keep(both)->data();
            size_t count = both.size();
            std::memcpy(self + p->offset, &data, sizeof data);
            std::memcpy(self + p->offset + sizeof data, &count, sizeof count);
        }
    }
    if (row->prepare)
        row->prepare(self);
    return { row->ops, self };
}

// A body or a level set: its specimen, each number changed by a tenth at most, at the scale of the radius.
sgt_surface body_of(Built &to, Random &dice, const Case &c, const sgt_builtin *row)
{
    std::vector<double> &room = *to.keep(std::vector<double>(row->size / sizeof(double) + 1));
    char *self = reinterpret_cast<char *>(room.data());
    std::memcpy(self, row->specimen, row->size);
    bool level = row->family == SGT_FAMILY_LEVEL_SET;
    for (const sgt_param *p = row->params; p->name && !level; p++)
        if (p->kind == SGT_PARAM_REAL || p->kind == SGT_PARAM_VECTOR)
            for (int i = 0; i < p->count; i++)
                reinterpret_cast<double *>(self + p->offset)[i] *=
                    std::pow(c.of[RADIUS] / 5, p->unit.length) * within(dice, 0.9, 1.1);
    if (row->prepare)
        row->prepare(self);
    return { row->ops, self };
}

// false: the surface is not valid, or its sag is not there at the middle of the rays.
bool build(const Case &c, Built &to)
{
    Random dice(static_cast<uint64_t>(c.of[SHAPE]) + 1);
    double a = c.of[RADIUS], rim = c.of[RIM] * a;
    const sgt_builtin *row = row_of(c.type);
    to.sag = true, to.level = false;
    if (row) {
        to.sag = is_sag(row), to.level = row->family == SGT_FAMILY_LEVEL_SET;
        to.s = to.sag ? sag_of(to, dice, c, row, false) : body_of(to, dice, c, row);
        if (row->object && row->object(to.s.self).param)
            return false;
        return true;
    }
    if (begins(c.type, "user")) {
        sgt_even_asphere s = *asphere_of(sag_of(to, dice, c, row_of("even_asphere"), false).self);
        to.s = { c.type == "user" ? &USER_OPS : &USER_ENCLOSED_OPS, to.keep(s) };
        return true;
    }
    for (const Formula &f : FORMULAS)
        if (c.type == f.name) {
            const sgt_named named[] = { { "a", a },
                                        { "c", c.of[CURVE] / a },
                                        { "k", c.of[CONIC] },
                                        { "d", c.of[DEPART] * a } };
            std::vector<double> &room = *to.keep(std::vector<double>(sgt_formula_room(f.text, 4) / 8 + 8));
            sgt_tape *tape =
                sgt_formula_read(f.text, f.kind, 4, named, room.data(), room.size() * 8, nullptr);
            if (!tape)
                return false;
            to.sag = f.kind == SGT_FORMULA_XY;
            if (to.sag)
                to.s = { &sgt_formula_sag_ops, to.keep(sgt_formula_sag{ tape, rim }) };
            else
                to.s = { &sgt_formula_ops, to.keep(sgt_formula{ tape, 1.5 * a, {}, {} }) };
            return true;
        }
    return false;
}

// -------------------------------------------------------------------- rays

sgt_vec3 sum(sgt_vec3 a, double t, sgt_vec3 b) { return { a.x + t * b.x, a.y + t * b.y, a.z + t * b.z }; }
sgt_vec3 cross(sgt_vec3 a, sgt_vec3 b)
{
    return { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}
sgt_vec3 unit(sgt_vec3 a)
{
    double length = std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z);
    return length > 0 ? sgt_vec3{ a.x / length, a.y / length, a.z / length } : sgt_vec3{ 0, 0, 1 };
}

// A point of the surface and its normal: of a sag beside (x, y), else where a line to the middle meets it.
void target(const Built &b, Random &dice, const Case &c, sgt_vec3 &p, sgt_vec3 &n)
{
    double a = c.of[RADIUS], r = c.of[AIM] * a * std::sqrt(dice.unit()), about = 2 * M_PI * dice.unit(),
           x = c.of[ASIDE] * a + r * std::cos(about), y = r * std::sin(about);
    if (b.sag) {
        double z = -b.s.ops->value(b.s.self, { x, y, 0 }, &n);
        bool there = std::fabs(z) < 1e30 && std::fabs(n.x) < 1e30;
        p = { x, y, there ? z : 0 };
        n = there ? unit(n) : sgt_vec3{ 0, 0, 1 };
        return;
    }
    double size = b.level ? 1 : a, u = 2 * dice.unit() - 1, turn = 2 * M_PI * dice.unit(),
           flat = std::sqrt(1 - u * u);
    sgt_vec3 out = { flat * std::cos(turn), flat * std::sin(turn), u };
    sgt_vec3 side = unit(cross(out, { 0.3, 0.5, 0.8 }));
    sgt_ray ray = { sum(sum({ 0, 0, 0 }, 10 * size, out), c.of[ASIDE] * size, side),
                    sum({ 0, 0, 0 }, -1, out), 0, 0 };
    sgt_hit hit = sgt_intersect(b.s, ray, nullptr);
    p = hit.status > 0 ? hit.p : sum(ray.o, 10 * size, ray.d);
    n = hit.status > 0 ? unit(hit.n) : out;
}

struct Run {  // a case made ready, and what came of it
    Case c;
    double ns, ratio, evals;
    double met, missed, undecided;  // in a hundred
};

struct Rays {
    std::vector<double> in[6], out[8];
    std::vector<sgt_status> status;
    std::vector<int> evals;
    Rays() : status(RAYS_OF_CASE), evals(RAYS_OF_CASE)
    {
        for (std::vector<double> &x : in)
            x.resize(RAYS_OF_CASE);
        for (std::vector<double> &x : out)
            x.resize(RAYS_OF_CASE);
    }
};

void aim(const Built &b, const Case &c, Rays &to)
{
    Random dice(static_cast<uint64_t>(c.of[SHAPE]) + 77);
    double size = b.level ? 1 : c.of[RADIUS], angle = c.of[ANGLE] * M_PI / 180,
           spread = c.of[SPREAD] * M_PI / 180, way = 2 * M_PI * dice.unit();
    bool under = dice.unit() < 0.3;
    for (size_t i = 0; i < RAYS_OF_CASE; i++) {
        sgt_vec3 p = { 0, 0, 0 }, n = { 0, 0, 1 };
        target(b, dice, c, p, n);
        double tilt = std::min(M_PI / 2, std::fabs(angle + spread * (dice.unit() - 0.5))),
               turn = way + spread * (dice.unit() - 0.5);
        sgt_vec3 u = unit(cross(n, std::fabs(n.x) < 0.9 ? sgt_vec3{ 1, 0, 0 } : sgt_vec3{ 0, 1, 0 })),
                 v = cross(n, u);
        sgt_vec3 along = sum(sum({ 0, 0, 0 }, std::cos(turn), u), std::sin(turn), v);
        sgt_vec3 d = sum(sum({ 0, 0, 0 }, std::cos(tilt), along), (under ? 1 : -1) * std::sin(tilt), n);
        sgt_vec3 o = sum(p, -c.of[FROM] * size, d);
        const double x[] = { o.x, o.y, o.z, d.x, d.y, d.z };
        for (int k = 0; k < 6; k++)
            to.in[k][i] = x[k];
    }
}

sgt_options options_of(const Case &c)
{
    sgt_options opt = {};
    opt.pick = c.of[PICK] < 2 ? SGT_FIRST : SGT_NEAR_SEED;
    opt.proof = c.of[PROOF] < 1 ? SGT_ESTIMATE : c.of[PROOF] < 2 ? SGT_PROVE_ROOT : SGT_PROVE_FIRST;
    return opt;
}

void pass(const Built &b, const Case &c, const sgt_options &opt, Rays &r, size_t n, bool evals)
{
    if (c.single()) {
        for (size_t i = 0; i < n; i++) {
            sgt_ray ray = { { r.in[0][i], r.in[1][i], r.in[2][i] },
                            { r.in[3][i], r.in[4][i], r.in[5][i] }, 0, 0 };
            sgt_hit h = sgt_intersect(b.s, ray, &opt);
            r.status[i] = h.status, r.evals[i] = h.evals, r.out[0][i] = h.t;
        }
        return;
    }
    for (size_t i = 0, most = static_cast<size_t>(c.of[BATCH]); i < n; i += most) {
        sgt_rays rays = { { &r.in[0][i], &r.in[1][i], &r.in[2][i] },
                          { &r.in[3][i], &r.in[4][i], &r.in[5][i] }, nullptr, nullptr };
        sgt_hits hits = { &r.status[i], evals ? &r.evals[i] : nullptr, &r.out[0][i], &r.out[1][i], nullptr,
                          { &r.out[2][i], &r.out[3][i], &r.out[4][i] },
                          { &r.out[5][i], &r.out[6][i], &r.out[7][i] }, nullptr, {} };
        sgt_intersect_batch(b.s, std::min(most, n - i), rays, hits, &opt);
    }
}

// The least ns a ray of `slices`; NaN: the case is none.
double timed(const Case &c, Run *told, int slices)
{
    static Rays rays;
    Built b;
    if (!build(c, b))
        return NAN;
    aim(b, c, rays);
    sgt_options opt = options_of(c);
    double begin = now();
    size_t n = FEW_RAYS;
    pass(b, c, opt, rays, n, true);
    if (now() - begin < 20 * SLICE)
        n = RAYS_OF_CASE, pass(b, c, opt, rays, n, true);
    if (std::count(rays.status.begin(), rays.status.begin() + static_cast<long>(n), SGT_INVALID))
        return NAN;
    if (told) {
        double evals = 0;
        int met = 0, missed = 0;
        for (size_t i = 0; i < n; i++)
            evals += rays.evals[i], met += rays.status[i] > 0, missed += rays.status[i] == 0;
        double each = 100 / static_cast<double>(n);
        told->evals = evals * each / 100, told->met = each * met, told->missed = each * missed;
        told->undecided = 100 - told->met - told->missed;
    }
    double least = HUGE_VAL;
    for (int i = 0; i < slices; i++) {
        double start = now(), took = 0;
        int times = 0;
        do
            pass(b, c, opt, rays, n, false), times++, took = now() - start;
        while (took < SLICE);
        least = std::min(least, took / times / static_cast<double>(n));
        if (took > 100 * SLICE)
            break;
    }
    return least;
}

// ------------------------------------------------------------------ search

std::vector<std::string> all_types(const std::string &only)
{
    std::vector<std::string> all;
    for (const sgt_builtin *b = sgt_builtins(); b->type; b++)
        if (b->specimen)
            all.push_back(b->type);
    for (const Formula &f : FORMULAS)
        all.push_back(f.name);
    all.push_back("user");
    all.push_back("user_enclose");
    if (!only.empty())
        all.erase(std::remove_if(all.begin(), all.end(), [&](const std::string &t) { return t != only; }),
                  all.end());
    return all;
}

Case drawn_case(Random &dice, const std::string &type)
{
    Case c = { type, {} };
    for (int i = 0; i < GENES; i++)
        c.of[i] = short_number(drawn(dice, i));
    return c;
}

// One or two numbers anew; a number that has a size now and then by a third of itself.
Case changed(Random &dice, const Case &from)
{
    Case c = from;
    int how_many = dice.unit() < 0.6 ? 1 : 2;
    for (int i = 0; i < how_many; i++) {
        int gene = static_cast<int>(dice.unit() * GENES);
        double fresh = drawn(dice, gene), near = c.of[gene] * std::exp(within(dice, -0.3, 0.3));
        bool has_size = gene == RADIUS || gene == CURVE || gene == DEPART || gene == AIM || gene == ANGLE ||
                        gene == SPREAD || gene == FROM;
        if (gene == CURVE)
            near = std::max(-0.9, std::min(0.9, near));
        if (gene == ANGLE)
            near = std::max(0.1, std::min(90.0, near));
        if (gene == DEPART)
            near = std::min(0.1, near);
        c.of[gene] = short_number(has_size && dice.unit() < 0.5 ? near : fresh);
    }
    return c;
}

typedef std::map<std::string, std::vector<double>> Costs;

double median_of(const Costs &costs, const Case &c)
{
    Costs::const_iterator found = costs.find(c.group());
    if (found == costs.end() || found->second.size() < 5)
        return NAN;
    std::vector<double> all = found->second;
    std::nth_element(all.begin(), all.begin() + static_cast<long>(all.size() / 2), all.end());
    return all[all.size() / 2];
}

double seconds_now()
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void print(const Run &run)
{
    std::printf("%8.3g  %8.3g ns, median %.3g, %.3g evaluations, %.0f met %.0f missed %.0f undecided: %s\n",
                run.ratio, run.ns, run.ns / run.ratio, run.evals, run.met, run.missed,
                run.undecided, run.c.words().c_str());
}

bool worse(const Run &a, const Run &b) { return a.ratio > b.ratio; }

}  // namespace

int search_for_cliffs(double seconds, uint64_t seed, const std::string &only_type, bool brief)
{
    std::vector<std::string> types = all_types(only_type);
    if (types.empty()) {
        std::fprintf(stderr, "there is no type %s\n", only_type.c_str());
        return 2;
    }
    Random dice(seed);
    Costs costs;
    std::vector<Run> draws;
    double begin = seconds_now();
    while (draws.size() < 30 * types.size() || seconds_now() - begin < 0.4 * seconds)
        for (const std::string &type : types) {
            Run run = { drawn_case(dice, type), 0, 0, 0, 0, 0, 0 };
            run.ns = timed(run.c, &run, 2);
            if (std::isnan(run.ns))
                continue;
            costs[run.c.group()].push_back(run.ns);
            draws.push_back(run);
        }
    std::map<std::string, std::vector<Run>> worst;  // of each type, the worst first
    for (Run &run : draws)
        run.ratio = run.ns / median_of(costs, run.c);
    draws.erase(std::remove_if(draws.begin(), draws.end(), [](const Run &r) { return std::isnan(r.ratio); }),
                draws.end());  // of a group too small for a median
    std::sort(draws.begin(), draws.end(), worse);
    size_t tried = draws.size(), cliffs = 0;
    for (const Run &run : draws)
        if (worst[run.c.type].size() < KEPT_OF_TYPE)
            worst[run.c.type].push_back(run);
    while (seconds_now() - begin < 0.95 * seconds) {
        std::vector<Run> &own = worst[one_of(dice, types)];
        if (own.empty())
            continue;
        Run *parent = &one_of(dice, own);
        Run run = { changed(dice, parent->c), 0, 0, 0, 0, 0, 0 };
        double median = median_of(costs, run.c);
        run.ns = timed(run.c, &run, 2);
        tried++;
        if (!(run.ns / median > parent->ratio * 1.05))
            continue;
        run.ns = std::min(run.ns, timed(run.c, nullptr, 3));  // slow again?
        run.ratio = run.ns / median;
        if (run.ratio > parent->ratio * 1.05)
            *parent = run;
    }
    std::vector<Run> all;
    for (auto &of : worst)
        for (Run &run : of.second) {
            run.ns = std::min(run.ns, timed(run.c, nullptr, 3));
            run.ratio = run.ns / median_of(costs, run.c);
            all.push_back(run);
        }
    std::sort(all.begin(), all.end(), worse);
    for (const Run &run : draws)
        cliffs += run.ratio > CLIFF;
    if (!brief) {
        std::printf("Seed %llu, %.0f s: %zu cases of %zu types; of %zu that were drawn %zu cost more than %g "
                    "times the median of their type.\nThe worst, no more than %zu of a type:\n",
                    static_cast<unsigned long long>(seed), seconds, tried, types.size(), draws.size(), cliffs,
                    CLIFF, KEPT_OF_TYPE);
        for (size_t i = 0; i < all.size() && i < TOLD; i++)
            print(all[i]);
        return 0;
    }
    std::map<std::string, bool> said;
    std::printf("| type | times the median | ns a ray | undecided, %% | the case |\n|---|---|---|---|---|\n");
    for (size_t i = 0, rows = 0; i < all.size() && rows < 5; i++) {
        const Run &run = all[i];
        if (said[run.c.type])
            continue;
        said[run.c.type] = true, rows++;
        std::string words = run.c.words();
        std::printf("| %s | %.0f | %.3g | %.0f | `%s` |\n", run.c.type.c_str(), run.ratio, run.ns,
                    run.undecided, words.c_str());
    }
    std::printf("\nSeed %llu, %.0f s: %zu cases; of %zu drawn at random %.1f %% cost more than 3 times the "
                "median of their type.\n",
                static_cast<unsigned long long>(seed), seconds, tried, draws.size(),
                100 * static_cast<double>(cliffs) / static_cast<double>(draws.size()));
    return 0;
}

int run_case(const std::string &line)
{
    Case c = { "", {} };
    std::istringstream words(line);
    std::string word;
    int given = 0;
    while (words >> word) {
        size_t at = word.find('=');
        std::string key = word.substr(0, at), value = at == std::string::npos ? "" : word.substr(at + 1);
        int gene = 0;
        while (gene < GENES && key != GENE[gene])
            gene++;
        if (key == "type")
            c.type = value, given++;
        else if (gene < GENES)
            c.of[gene] = std::strtod(value.c_str(), nullptr), given++;
        else
            return std::fprintf(stderr, "a case has no %s\n", key.c_str()), 2;
    }
    if (given != GENES + 1)
        return std::fprintf(stderr, "a case has a type and %d numbers\n", static_cast<int>(GENES)), 2;
    Run run = { c, 0, 0, 0, 0, 0, 0 };
    run.ns = timed(c, &run, 9);
    if (std::isnan(run.ns))
        return std::fprintf(stderr, "there is no such surface\n"), 2;
    Random dice(1);
    Costs costs;
    for (int i = 0; i < 100; i++) {  // its neighbours, all of its group
        Case other = drawn_case(dice, c.type);
        other.of[PROOF] = c.of[PROOF];
        if (other.single() != c.single())
            other.of[BATCH] = c.of[BATCH];
        double ns = timed(other, nullptr, 2);
        if (!std::isnan(ns))
            costs[other.group()].push_back(ns);
    }
    run.ratio = run.ns / median_of(costs, c);
    print(run);
    return 0;
}
