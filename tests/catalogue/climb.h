// SPDX-License-Identifier: MIT
// climb.h - the greatest error for its bound that a climb finds.
//
// A bound of an error is told with every answer: t_err with t, p_err with p, `rounding` with F, the ends of
// an enclosure with g and g'.  Random cases come nowhere near it, so that a test which asks for error <=
// bound does not notice a bound that is made four times too small.  Here a climb makes the quotient error /
// bound great: from a random surface and a random ray one number after another is changed, by ulps or by
// more, and the change is kept if the quotient has grown.  The error is that of the answer against 113
// bits.
//
//   a quotient above 1      is a wrong answer;
//   one above its limit     is a bound that has become smaller, or an error that has become greater.  The
//                           limits are those of
//                           climb_limits.h: what longer climbs from several seeds have found, and a fifth
//                             more.  Who changes
//                           an error analysis on purpose writes them anew (--limits), and says why.
//
// The rounding of the answer itself to double is in every bound, is half an ulp, and is reached: it would
// hide the rest.  So of t the quotient that has a limit is that of t + t_lo, over what t_err has beyond
// |t_lo|; and bounds that are no more than a few ulps of t, F or g have none.
//
// One number a type would let through what is not the worst of it.  So the quotients are told apart by what
// tells paths apart: how the root was asked for, at which angle it is met, where on the surface, and
// whether there is one term alone.
#ifndef TESTS_CATALOGUE_CLIMB_H
#define TESTS_CATALOGUE_CLIMB_H

#include "../oracle/cases.h"
#include "../oracle/quad.h"

#include <algorithm>
#include <string>
#include <vector>

namespace climb {

using oracle::generator;
using oracle::quad;

enum way { plain, tolerant, proven, ways };         // to rounding; to a t_tol; under proof
enum angle {
    steep,
    slanting,
    grazing,
    angles
}; // between ray and surface: its sine above 1/2, above 1/20, below
enum zone {
    inner,
    middle,
    outer,
    brink,
    zones
}; // of the aperture: a third, nine tenths, but a hundredth, beyond
enum degree { low, medium, high, degrees };         // of a term that is alone: up to 2, up to 6, beyond
enum cell {
    of_t,
    of_p = of_t + int(ways) * int(angles),
    of_f = of_p + int(ways) * int(angles),
    of_g = of_f + (1 + int(degrees)) * int(zones), // several terms; one alone of each degree
    of_slope = of_g + 2,                           // 2: several terms, one alone
    of_rim = of_slope + 2, // p_err over the distance of p from the rim, of a hit under proof
    cells
};

struct name_of_cell {
    char text[64];
    explicit name_of_cell(int c)
    {
        static const char *const way_names[] = {"to rounding", "to t_tol", "proven"},
                                 *const angle_names[] = {"steep", "slanting", "grazing"},
                                 *const zone_names[] = {"inner", "middle", "outer", "on the brink"};
        static const char *const parts[] = {"", ", one term", ", one term of degree 3 to 6",
                                            ", one term of a high degree"};
        if (c < of_p)
            std::snprintf(text, sizeof text, "t %s, %s", way_names[c / int(angles)],
                          angle_names[c % int(angles)]);
        else if (c < of_f)
            std::snprintf(text, sizeof text, "p %s, %s", way_names[(c - of_p) / int(angles)],
                          angle_names[(c - of_p) % int(angles)]);
        else if (c < of_g)
            std::snprintf(text, sizeof text, "F %s%s", zone_names[(c - of_f) % int(zones)],
                          parts[(c - of_f) / int(zones)]);
        else if (c < of_slope) std::snprintf(text, sizeof text, "enclosed g%s", parts[c - of_g]);
        else if (c < of_rim) std::snprintf(text, sizeof text, "enclosed g'%s", parts[c - of_slope]);
        else std::snprintf(text, sizeof text, "rim");
    }
};

// What one climb works on.  A subject draws itself, says which numbers may be changed, and what F is in 113
// bits.
struct subject {
    sgt_ray ray = {};
    sgt_vec3 p = {};             // a point near the surface, for F
    double t = 0;                // of the ray, for the enclosure
    double t_tol = 0, size = 1;  // a length of the surface
    double rim = 0;              // 0: none
    sgt_pick pick = SGT_FIRST;
    bool alone = false;          // one term
    degree of_it = low;          // and its degree
    virtual ~subject() {}
    virtual void draw(generator &g) = 0;
    virtual sgt_surface surface() const = 0;
    virtual quad value(quad x, quad y, quad z) const = 0;
    virtual std::vector<double *> numbers() { return {}; } // of the surface
    virtual void changed() {}                              // one of these
    virtual quad slope(quad s) const = 0;                  // of F along the ray; NaN: not looked at
    virtual void print() const = 0;
    quad along(quad s) const
    {
        return value(ray.o.x + s * ray.d.x, ray.o.y + s * ray.d.y, ray.o.z + s * ray.d.z);
    }
};

struct table {
    double found[cells] = {};
    int told[cells] = {};
    const double *limits = nullptr; // NULL: 1 everywhere
    long asked = 0, wrong = 0;
    std::string type;
    double now[cells];               // of the last evaluation; -1: not told

    void pin(int c, double quotient)
    {
        found[c] = std::max(found[c], quotient);
        now[c] = quotient;
    }
    // 1 is the limit of this.
    void take(int c, double quotient, const subject &of)
    {
        asked++;
        if (quotient <= 1 || (wrong++, told[c]++ >= 1)) return;
        std::printf("FAIL %s, %s: %.4g of its bound\n", type.c_str(), name_of_cell(c).text, quotient);
        std::printf("    ray {%a, %a, %a}, {%a, %a, %a}, %a, %a; point {%a, %a, %a}; t %a, t_tol %a\n",
                    of.ray.o.x, of.ray.o.y, of.ray.o.z, of.ray.d.x, of.ray.d.y, of.ray.d.z, of.ray.tmin,
                    of.ray.tmax, of.p.x, of.p.y, of.p.z, of.t, of.t_tol);
        of.print();
    }
};

inline double magnitude(quad x) { return std::fabs(oracle::to_double(x)); }

// The quotients of a hit, if there are any: of t, of p, and at the rim.
inline void of_hit(const subject &s, way asked, table *to)
{
    sgt_options opt = {};
    opt.pick = s.pick;
    if (asked == tolerant) opt.t_tol = s.t_tol;
    if (asked == proven) opt.proof = SGT_PROVE_ROOT;
    const sgt_hit h = sgt_intersect(s.surface(), s.ray, &opt);
    if (h.status != SGT_HIT || !(h.t_err > 0 && h.t_err < HUGE_VAL)) return;
    // The secant method from there, in 113 bits; where these are not much more than the answer has there is
    // nothing to judge.
    const double n = std::sqrt(h.n.x * h.n.x + h.n.y * h.n.y + h.n.z * h.n.z),
                 d = std::sqrt(s.ray.d.x * s.ray.d.x + s.ray.d.y * s.ray.d.y + s.ray.d.z * s.ray.d.z);
    const double g = h.n.x * s.ray.d.x + h.n.y * s.ray.d.y + h.n.z * s.ray.d.z, sine = std::fabs(g) / (n * d);
    const double spread = std::fabs(h.p.x * h.n.x) + std::fabs(h.p.y * h.n.y) + std::fabs(h.p.z * h.n.z);
    const double noise = 0x1p-104 * (spread + n * 0x1p-4 * s.size) / std::fabs(g); // of t in 113 bits
    if (!(noise < 1e-3 * h.t_err)) return;
    quad t = h.t, f = s.along(t), step = f / quad(g);
    const double enough = h.p_err > 0 && h.p_err / d < h.t_err ? h.p_err / d : h.t_err;
    bool good = false;
    for (int i = 0; i < 12 && f == f && magnitude(step) < 1e3 * (h.t_err + s.size / d); i++) {
        if (magnitude(step) <= 1e-6 * enough) {
            good = true;
            break;
        }
        const quad next = t - step, now = s.along(next);
        step = now * (next - t) / (now - f);
        t = next, f = now;
    }
    if (!good || magnitude(t - quad(h.t)) > h.t_err) { // is there any root within t_err?
        int above = 0, below = 0, none = 0;
        for (int i = -16; i <= 16; i++) {
            const quad v = s.along(quad(h.t) + quad(h.t_err) * i / 16);
            above += v >= 0, below += v <= 0, none += v != v;
        }
        if (none) return;
        if (above && below && !good) return; // several, or flat
        if (!good) t = quad(h.t) + 2 * quad(h.t_err);
        if (above && below) return; // another one
    }
    const int place = int(asked) * int(angles) + (sine >= 0.5 ? steep : sine >= 0.05 ? slanting : grazing);
    to->take(of_t + place, std::max(magnitude(t - quad(h.t)) - noise, 0.0) / h.t_err, s);
    const double rest = (h.t_err - std::fabs(h.t_lo)) - 0x1p-52 * h.t_err,
                 by_t = good && rest > 0.05 * h.t_err && rest > 0x1p-50 * std::fabs(h.t)
                            ? magnitude(t - (quad(h.t) + h.t_lo)) / rest
                            : -1;
    if (by_t >= 0) to->pin(of_t + place, by_t);
    if (good && h.p_err > 0 && h.p_err < HUGE_VAL) {
        const oracle::vector3 off = {s.ray.o.x + t * s.ray.d.x - quad(h.p.x),
                                     s.ray.o.y + t * s.ray.d.y - quad(h.p.y),
                                     s.ray.o.z + t * s.ray.d.z - quad(h.p.z)};
        const double by_p = magnitude(oracle::norm(off)) / h.p_err;
        to->take(of_p + place, by_p, s);
        to->pin(of_p + place, by_p);
        if (asked == proven && s.rim > 0) {
            const quad r = oracle::square_root(quad(h.p.x) * h.p.x + quad(h.p.y) * h.p.y),
                       beside = magnitude(r - quad(s.rim) * (1 + quad(0x1p-45)));
            const double hidden = h.p_err / magnitude(beside);
            to->take(of_rim, hidden, s);
            to->pin(of_rim, hidden);
        }
    }
}

inline void of_value(const subject &s, table *to)
{
    const sgt_surface of = s.surface();
    const double f = of.ops->value(of.self, s.p, nullptr), bound = of.ops->rounding(of.self, s.p);
    const quad exact = s.value(s.p.x, s.p.y, s.p.z);
    if (!(exact == exact) || f != f || !(bound > 0 && bound < HUGE_VAL)) return;
    const double r = std::sqrt(s.p.x * s.p.x + s.p.y * s.p.y) / s.size,
                 quotient = magnitude(quad(f) - exact) / bound;
    const int c = of_f + (s.alone ? (1 + int(s.of_it)) * int(zones) : 0) +
                  (r < 0.3333 ? inner
                   : r < 0.9  ? middle
                   : r < 0.99 ? outer
                              : brink);
    to->take(c, quotient, s);
    if (!(bound > 8 * 0x1p-53 * std::fabs(f))) return;
    to->pin(c, quotient);
}

// Of an interval that is one number: its width is rounding alone.
inline void of_enclosure(const subject &s, table *to)
{
    const sgt_surface of = s.surface();
    sgt_interval slope = {(double)NAN, (double)NAN};
    const sgt_interval g = of.ops->enclose(of.self, &s.ray, {s.t, s.t}, &slope);
    for (int i = 0; i < 2; i++) {
        const sgt_interval x = i ? slope : g;
        if (!(x.hi > x.lo && x.lo > -HUGE_VAL && x.hi < HUGE_VAL)) continue;
        const quad exact = i ? s.slope(quad(s.t)) : s.along(quad(s.t));
        if (!(exact == exact)) continue;
        const int c = (i ? of_slope : of_g) + (s.alone ? 1 : 0);
        const double half = magnitude((quad(x.hi) - x.lo) / 2),
                     now = magnitude(exact - (quad(x.lo) + x.hi) / 2) / half;
        to->take(c, now, s);
        if (!(half > 16 * 0x1p-53 * std::fabs(x.lo))) continue;
        to->pin(c, now);
    }
}

// One change of a number.
inline double moved(generator &g, double x, double size)
{
    switch (g.below(4)) {
    case 0: return x * (1 + g.sign() * (1 + g.below(8)) * 0x1p-52);
    case 1: return x * (1 + g.sign() * g.log_uniform(1e-15, 1e-6));
    case 2: return x * (1 + g.sign() * g.log_uniform(1e-6, 0.3));
    default: return x + g.sign() * size * g.log_uniform(1e-16, 0.1);
    }
}

// What a cell is asked by.
inline void ask(const subject &s, int c, table *to)
{
    std::fill(to->now, to->now + cells, -1.0);
    if (c < of_f) of_hit(s, static_cast<way>((c < of_p ? c : c - of_p) / int(angles)), to);
    else if (c < of_g) of_value(s, to);
    else if (c < of_rim) of_enclosure(s, to);
    else of_hit(s, proven, to);
}

// One cell of each kind: asking it tells of all that are like it.
const int asked_of_all[] = {int(of_t) + int(plain) * int(angles), int(of_t) + int(tolerant) * int(angles),
                            int(of_t) + int(proven) * int(angles), int(of_f), int(of_g)};

// A subject that has been climbed: how it was drawn, and its numbers now.
struct place {
    double quotient = -1;
    long number = -1; // of the draw
    generator drawn{0};
    std::vector<double> numbers;
};

// Of each cell the best subjects of some draws.  (Cells help each other: what is good in one is a start in
// the next.  Mouret and Clune 2015, arXiv:1504.04909.)
struct archive {
    enum { islands = 3 };
    place best[cells][islands];

    void keep(int c, double quotient, long number, const generator &drawn,
              const std::vector<double *> &numbers)
    {
        place *worst = &best[c][0], *to = nullptr;
        for (place &p : best[c]) {
            if (p.number == number) to = &p;
            if (p.quotient < worst->quotient) worst = &p;
        }
        if (!to) to = worst;
        if (!(quotient > to->quotient)) return;
        to->quotient = quotient, to->number = number, to->drawn = drawn, to->numbers.clear();
        for (const double *x : numbers) to->numbers.push_back(*x);
    }
};

// The ray's, the point's and t, and then the surface's.
enum { of_ray = 6, of_point = of_ray + 3, not_of_surface = of_point + 1 };
inline std::vector<double *> numbers_of(subject *s)
{
    std::vector<double *> all = {&s->ray.o.x, &s->ray.o.y, &s->ray.o.z, &s->ray.d.x, &s->ray.d.y,
                                 &s->ray.d.z, &s->p.x,     &s->p.y,     &s->p.z,     &s->t};
    for (double *x : s->numbers()) all.push_back(x);
    return all;
}

// So many evaluations: three in ten of subjects as they are drawn, the others in climbs of `steps` from the
// best so far.
inline void go(generator &g, subject *s, long evaluations, int steps, table *to)
{
    archive kept;
    long number = 0;
    const auto told = [&](const generator &drawn, const std::vector<double *> &numbers) {
        for (int c = 0; c < int(cells); c++)
            if (to->now[c] >= 0) kept.keep(c, to->now[c], number, drawn, numbers);
    };
    long done = 0;
    for (const long drawn = evaluations * 3 / 10; done < drawn;) {
        const generator from = g;
        number++;
        s->draw(g);
        const std::vector<double *> numbers = numbers_of(s);
        for (int c : asked_of_all) ask(*s, c, to), told(from, numbers), done++;
    }
    while (done < evaluations) {
        const int c = g.below(int(cells));
        const place &begin = kept.best[c][g.below(archive::islands)];
        done++;
        if (!(begin.quotient >= 0) || begin.quotient > 0.99) continue;
        const generator from = begin.drawn;
        number = begin.number;
        generator again = from;
        s->draw(again);
        const std::vector<double *> numbers = numbers_of(s);
        for (std::size_t i = 0; i < numbers.size(); i++) *numbers[i] = begin.numbers[i];
        s->changed();
        double best = begin.quotient;
        const double length = std::sqrt(s->ray.d.x * s->ray.d.x + s->ray.d.y * s->ray.d.y +
                                        s->ray.d.z * s->ray.d.z);
        for (int k = 0; k < steps; k++, done++) {
            const int own = static_cast<int>(numbers.size()) - int(not_of_surface);
            const bool of_surface = own > 0 && g.chance(0.3);
            int i;
            if (of_surface) i = int(not_of_surface) + g.below(own);
            else if (c >= of_f && c < of_g) i = int(of_ray) + g.below(3);
            else if (c >= of_g && c < of_rim && g.chance(0.4)) i = int(of_point);
            else i = g.below(int(of_ray));
            double &x = *numbers[static_cast<std::size_t>(i)];
            const double before = x, size = of_surface                                         ? 0
                                            : i < 3 || (i >= int(of_ray) && i < int(of_point)) ? s->size
                                            : i < int(of_ray)                                  ? length
                                                              : s->size / length;
            x = moved(g, before, size);
            if (x == before) continue;
            if (of_surface) s->changed();
            ask(*s, c, to);
            told(from, numbers);
            if (to->now[c] >= best) {
                best = to->now[c];
                continue;
            }
            x = before;
            if (of_surface) s->changed();
        }
    }
}

// What was found against what may be; the cells that are above.
inline int judge(const table &t, bool pinned)
{
    int above = 0;
    if (pinned && !t.limits) std::printf("FAIL %s: it has no limits\n", t.type.c_str()), above++;
    for (int c = 0; c < int(cells); c++)
        if (pinned && t.limits && t.found[c] > t.limits[c])
            std::printf("FAIL %s, %s: %.4g of its bound, the limit is %.4g\n", t.type.c_str(),
                        name_of_cell(c).text, t.found[c], t.limits[c]),
                above++;
    return above + (t.wrong > 0);
}

inline double most(const table &t, int from, int to)
{
    return *std::max_element(t.found + from, t.found + to);
}

// A line: for climb_limits.h, for docs/data/climb.md, or to be read.
inline void print(const table &t, bool limits, bool markdown)
{
    if (limits) {
        std::printf("    {\"%s\", {", t.type.c_str());
        for (int c = 0; c < int(cells); c++)
            std::printf("%s%.3g", c ? ", " : "",
                        c == int(of_rim) || t.found[c] == 0 ? 1 : std::min(1.0, 1.2 * t.found[c] + 0.01));
        std::printf("}},\n");
    } else if (markdown)
        std::printf("| %s | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f |\n", t.type.c_str(),
                    most(t, of_t, of_t + int(angles)), most(t, of_t + int(angles) * int(proven), of_p),
                    most(t, of_p, of_f), most(t, of_f, of_g), most(t, of_g, of_slope),
                    most(t, of_slope, of_rim));
    else {
        std::printf("%-14s %7ld asked; t", t.type.c_str(), t.asked);
        for (int c = 0; c < int(cells); c++)
            std::printf("%s%.2f",
                        c == int(of_p)       ? "; p "
                        : c == int(of_f)     ? "; F "
                        : c == int(of_g)     ? "; g "
                        : c == int(of_slope) ? "; g' "
                        : c == int(of_rim)   ? "; rim "
                                             : " ",
                        t.found[c]);
        std::printf("\n");
    }
    std::fflush(stdout);
}

} // namespace climb
#endif
