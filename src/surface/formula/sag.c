// SPDX-License-Identifier: MIT
/* sag.c - the sag z = s(x, y) of a formula: a departure from a plane, whose bounds are made of intervals.
 *
 * departure/departure.c asks for P, its rounding, and bounds of P and its first two derivatives over a
 * region. Here all of these come from the tape: values.c and enclose.c.  At the vertex x = y = 0, where every
 * chief ray goes, r and atan2(y, x) have no derivatives.  read.c has made polynomials of what has; for the
 * rest the first derivative is bounded there (r is a cone, with one on each side), or not (atan2), and the
 * second is not. */
#include "../departure/bend.h"
#include "../departure/departure.h"
#include "formula.h"

static const sgt_tape *tape_of(const void *self) { return ((const sgt_formula_sag *)self)->tape; }

static void formula_at(const void *self, size_t n, const double *x, const double *y, sag_values out)
{
    sgt_formula_values(tape_of(self), n, (sgt_points){{x, y, NULL}},
                       (sgt_values){out.p, {out.px, out.py, NULL}});
}

static const sgt_interval BY_X[3] = {{1, 1}, {0, 0}, {0, 0}}, BY_Y[3] = {{0, 0}, {1, 1}, {0, 0}};

/* How far x is from the farther end of what it is known to be in. */
static double farthest(double x, sgt_interval in)
{
    double off = larger(sgt_sum_above(in.hi, -x), sgt_sum_above(x, -in.lo));
    return in.lo <= in.hi && off < HUGE_VAL ? larger(off, 0) : HUGE_VAL;
}

static void formula_rounding(const void *self, double x, double y, double *p_err, double *grad_err)
{
    double p, px, py;
    sgt_interval at[3] = {sgt_interval_of(x), sgt_interval_of(y), {0, 0}};
    formula_jet jet =
        sgt_formula_jet(tape_of(self), at, sgt_interval_hypotenuse(at[0], at[1]), BY_X, BY_Y, false);
    formula_at(self, 1, &x, &y, (sag_values){&p, &px, &py});
    *p_err = farthest(p, jet.f);
    *grad_err = larger(farthest(px, jet.u), farthest(py, jet.v));
}

/* Squares of slopes below 2^-537 are 0; length_of is not. */
static double norm(double a, double b) { return length_of(a, b) * (1 + 0x1p-40); }

/* r^2 all over the region. */
static sgt_interval square_within(const region *where)
{
    sgt_interval r = {where->r_lo, where->r_hi};
    sgt_interval sum = sgt_interval_sum(sgt_interval_square(where->x), sgt_interval_square(where->y));
    return sgt_interval_intersection(sgt_interval_square(r), sum);
}

static double or_none(double bound) { return bound < HUGE_VAL ? bound * (1 + 0x1p-40) : HUGE_VAL; }

/* Of P(s), s = r^2: the gradient is 2 P_s (x, y), and the second derivative has the eigenvalues 2 P_s and
 * 2 P_s + 4 s P_ss. */
static int radial_bounds(const sgt_tape *tape, const region *where, bounds *out)
{
    sgt_interval s = square_within(where);
    formula_jet jet = sgt_formula_radial_jet(tape, s, true);
    if (sgt_interval_is_empty(jet.f)) return 0;
    sgt_interval across = sgt_interval_scaled(jet.u, 2),
                 along = sgt_interval_sum(across, sgt_interval_scaled(sgt_interval_product(s, jet.uv), 4));
    double twice = sgt_interval_greatest(across), most = larger(twice, sgt_interval_greatest(along));
    *out = (bounds){or_none(sgt_interval_greatest(jet.f)), or_none(sgt_product_above(twice, where->r_hi)),
                    or_none(most)};
    return jet.whole ? 1 : -1;
}

static int formula_bounds(const void *self, region *where, bounds *out)
{
    if (tape_of(self)->radial) return radial_bounds(tape_of(self), where, out);
    sgt_interval at[3] = {where->x, where->y, {0, 0}}, r = {where->r_lo, where->r_hi};
    formula_jet xx = sgt_formula_jet(tape_of(self), at, r, BY_X, BY_X, true),
                xy = sgt_formula_jet(tape_of(self), at, r, BY_X, BY_Y, true),
                yy = sgt_formula_jet(tape_of(self), at, r, BY_Y, BY_Y, true);
    if (sgt_interval_is_empty(xx.f)) return 0;
    double size = sgt_interval_greatest(xx.f), across = sgt_interval_greatest(xy.uv),
           bend = larger(sgt_interval_greatest(xx.uv), sgt_interval_greatest(yy.uv)) + across;
    double steep = norm(sgt_interval_greatest(xy.u), sgt_interval_greatest(xy.v));
    bend *= 1 + 0x1p-40;
    *out = (bounds){size < HUGE_VAL ? size : HUGE_VAL, steep < HUGE_VAL ? steep : HUGE_VAL,
                    bend < HUGE_VAL ? bend : HUGE_VAL};
    return xx.whole ? 1 : -1;
}

static sgt_interval formula_range(const void *self, const region *where)
{
    sgt_interval at[3] = {where->x, where->y, {0, 0}}, r = {where->r_lo, where->r_hi};
    const sgt_interval none[3] = {{0, 0}, {0, 0}, {0, 0}};
    if (tape_of(self)->radial) return sgt_formula_radial_jet(tape_of(self), square_within(where), false).f;
    return sgt_formula_jet(tape_of(self), at, r, none, none, false).f;
}

/* The noise of all points within the radius. */
static void formula_noise(const void *self, double radius, double e[2])
{
    sgt_interval side = sgt_interval_between(-radius, radius), at[3] = {side, side, {0, 0}};
    e[0] = sgt_formula_noise(tape_of(self), at, sgt_interval_between(0, radius));
    e[1] = 0;
    if (!(e[0] < HUGE_VAL)) e[0] = e[1] = (double)NAN;
}

static void formula_second(const void *self, size_t n, const double *x, const double *y, double *pxx,
                           double *pxy, double *pyy)
{
    sgt_points at = {{x, y, NULL}};
    sgt_formula_mixed(tape_of(self), 0, 0, n, at, (formula_mixed){.uv = pxx});
    sgt_formula_mixed(tape_of(self), 0, 1, n, at, (formula_mixed){.uv = pxy});
    sgt_formula_mixed(tape_of(self), 1, 1, n, at, (formula_mixed){.uv = pyy});
}

static size_t formula_parameters(const void *self) { return (size_t)tape_of(self)->parameters; }

static void formula_by_parameter(const void *self, size_t j, size_t n, const double *x, const double *y,
                                 sag_values out)
{
    sgt_points at = {{x, y, NULL}};
    sgt_formula_mixed(tape_of(self), 3 + j, 0, n, at, (formula_mixed){.u = out.p, .uv = out.px});
    sgt_formula_mixed(tape_of(self), 3 + j, 1, n, at, (formula_mixed){.uv = out.py});
}

static sgt_objection formula_object(const void *self)
{
    const sgt_tape *tape = tape_of(self);
    if (!tape || tape->kind != SGT_FORMULA_XY) return (sgt_objection){"sag", "must be a formula of x and y"};
    return (sgt_objection){NULL, NULL};
}

/* A little farther than the rim: roundings of a point on it are within. */
static bool formula_jumps(const void *self)
{
    double rim = ((const sgt_formula_sag *)self)->semi_diameter,
           most = rim > 0 ? rim * (1 + 0x1p-40) : HUGE_VAL;
    sgt_interval side = {-most, most}, at[3] = {side, side, {0, 0}};
    return sgt_formula_jumps(tape_of(self), at, sgt_interval_between(0, most));
}

static const departure formula_sag_departure = {
    .at = formula_at, .rounding = formula_rounding, .bounds = formula_bounds, .range = formula_range,
    .second = formula_second, .parameters = formula_parameters, .by_parameter = formula_by_parameter,
    .object = formula_object, .noise = formula_noise, .jumps = formula_jumps};

static departure_sag formula_of(const sgt_formula_sag *s)
{
    return (departure_sag){.c = s->tape ? s->tape->c : 0, .k = s->tape ? s->tape->k : 0,
                           .semi_diameter = s->semi_diameter, .of = &formula_sag_departure, .self = s};
}

DEPARTURE_OPS(formula_sag, sgt_formula_sag, formula_of)
