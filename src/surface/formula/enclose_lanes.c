// SPDX-License-Identifier: MIT
/* enclose_lanes.c - F and its slope along the ray, on many cells at a time.
 *
 * A cell is an interval of t on a ray.  x, y, z are intervals there, and their slopes by t are the numbers d.
 * The steps of the tape are done on INTERVAL_LANES cells at once, one kernel for a value and one for a slope,
 * by the rules of num/interval_lanes.h.  There an end that is not known is infinite or NaN.
 *
 * DEFINED AND CONTINUOUS.  A slope with two finite ends promises that F is, all over the cell.  So where an
 * operation may be undefined or jump in a part of the cell, its slope is NaN.  A slope that is not finite
 * never becomes finite again: sums keep it, products are NaN if any end is not finite, and where a slope is
 * chosen (minimum), that of the other is added as an unknown.  Most operations need no care for that: the
 * derivative of a root, a logarithm, an arc sine has a reciprocal in it, which is NaN where 0 may be in the
 * divisor.
 *
 * KINKS.  |a|, min and max have the slopes of the branches that are possible, and their hull is valid for the
 * mean value theorem (Lebourg 1975).  The hypotenuse of a, b has a slope of at most that of a', b' (Cauchy
 * and Schwarz), which holds at a = b = 0, too.
 *
 * THE MEAN VALUE FORM, g at the middle + slope (t - middle), is not worked out besides.  It costs half as
 * much again, and in pictures of 640 x 480 rays it saved 2 to 15 % of the cells: a first hit took 470 to 690
 * ns without it, and 650 to 990 ns with it (Barth, Clebsch, Chmutov 8, a gyroid, Kummer).
 *
 * COST with 16 cells, value and slope: 24 to 48 ns a cell with AVX2, 40 to 92 with SSE2, where interval.h
 * takes 1.2 to 3.6 microseconds (tests/bench/bench_formula_cells.c, the first four).  One cell alone costs as
 * much as 16.  Blocks of 32 would take a quarter less with AVX-512, and twice the stack.
 *
 * UNDEFINED ALL OVER.  A step that has no value in the cell at all (ends_no_root ...) leaves a mark for its
 * lane, and F has none there either: each step needs its operands.
 *
 * TAPES ARE NOT SHORTENED where a minimum or a maximum is decided.  All lanes would have to agree, and they
 * are of 16 rays.  What decides is the values of both operands, so only the slopes of one can be spared; and
 * that it is defined all over the cell is known by its slope alone.  A value takes 0.5 to 0.8 of the time of
 * value and slope (bench_formula_cells.c), so values first and slopes of the rest afterwards would gain only
 * where less than half of the steps are left.
 *
 * SINE AND COSINE of one operand cost as much as one of them; formulas with one often have the other.  So
 * the last of both are kept, until the operand's register is written. */
#include "../../num/interval_lanes.h"
#include "formula.h"

#include <math.h>

typedef lane_interval row;

/* A register: the value and the slope of a number. */
typedef struct cell_rows { row v, s; } cell_rows;

#define LANE(a) ends_of((a)->lo[i], (a)->hi[i])
#define EACH_LANE LANES for (int i = 0; i < INTERVAL_LANES; i++)
#define PUT(out, ends)                                   \
    {                                                    \
        two_ends result = ends;                         \
        (out)->lo[i] = result.lo, (out)->hi[i] = result.hi; \
    }

/* A kernel out = RESULT of x, or of x and y, ....  out may be one of the arguments. */
#define OF_1(NAME, RESULT)                               \
    SGT_KERNEL static void NAME(row *out, const row *a)  \
    {                                                    \
        EACH_LANE                                        \
        {                                                \
            two_ends x = LANE(a);                       \
            PUT(out, RESULT)                             \
        }                                                \
    }
#define OF_2(NAME, RESULT)                                               \
    SGT_KERNEL static void NAME(row *out, const row *a, const row *b)    \
    {                                                                    \
        EACH_LANE                                                        \
        {                                                                \
            two_ends x = LANE(a), y = LANE(b);                          \
            PUT(out, RESULT)                                             \
        }                                                                \
    }
#define OF_3(NAME, RESULT)                                                             \
    SGT_KERNEL static void NAME(row *out, const row *a, const row *b, const row *c)    \
    {                                                                                  \
        EACH_LANE                                                                      \
        {                                                                              \
            two_ends x = LANE(a), y = LANE(b), z = LANE(c);                            \
            (void)x, (void)y, (void)z; /* not every RESULT has all of them */          \
            PUT(out, RESULT)                                                           \
        }                                                                              \
    }
#define OF_4(NAME, RESULT)                                                                          \
    SGT_KERNEL static void NAME(row *out, const row *a, const row *b, const row *c, const row *d)   \
    {                                                                                               \
        EACH_LANE                                                                                   \
        {                                                                                           \
            two_ends x = LANE(a), y = LANE(b), z = LANE(c), w = LANE(d);                           \
            PUT(out, RESULT)                                                                        \
        }                                                                                           \
    }
/* With a uniform k. */
#define OF_UNIFORM(NAME, RESULT)                                         \
    SGT_KERNEL static void NAME(row *out, const row *a, two_ends k)     \
    {                                                                    \
        EACH_LANE                                                        \
        {                                                                \
            two_ends x = LANE(a);                                       \
            PUT(out, RESULT)                                             \
        }                                                                \
    }
/* Marks the lanes in which the operation has no value. */
#define NONE_OF(NAME, NO)                                                \
    SGT_KERNEL static void NAME(double *none, const row *a)              \
    {                                                                    \
        EACH_LANE                                                        \
        {                                                                \
            two_ends x = LANE(a);                                       \
            none[i] = NO ? 1.0 : none[i];                                \
        }                                                                \
    }

/* ------------------------------------------------------------------------- kernels */

/* o + t d, t from lo to hi.  The product is off by u of itself and e/2, the sum and the difference by u of
 * the sum: w is greater. */
SGT_KERNEL
static void on_line(row *out, const double *o, const double *d, const double *lo, const double *hi)
{
    EACH_LANE
    {
        double p = lo[i] * d[i], q = hi[i] * d[i], low = lesser_of(p, q), high = greater_of(p, q);
        double unknown = ends_unknown(p + q), a = o[i] + low, b = o[i] + high;
        out->lo[i] = a - ((fabs(low) + fabs(a)) * 0x1p-51 + (LANE_LEAST + unknown));
        out->hi[i] = b + ((fabs(high) + fabs(b)) * 0x1p-51 + (LANE_LEAST + unknown));
    }
}

OF_1(copy, x)
OF_1(negative, ends_negative(x))
OF_2(sum, ends_sum(x, y))
OF_2(difference, ends_difference(x, y))
OF_2(product, ends_product(x, y))
OF_4(two_products, ends_two_products(x, y, z, w))
OF_2(quotient, ends_quotient(x, y))
OF_2(minimum, ends_minimum(x, y))
OF_2(maximum, ends_maximum(x, y))
OF_2(hypotenuse, ends_hypotenuse(x, y))
OF_2(angle, ends_angle(x, y))
OF_1(absolute, ends_absolute(x))
OF_1(square, ends_square(x))
OF_1(cube, ends_cube(x))
OF_1(reciprocal, ends_reciprocal(x))
OF_1(root, ends_root(x))
OF_1(cube_root, ends_cbrt(x))
OF_1(exponential, ends_exp(x))
OF_1(logarithm, ends_log(x))
OF_1(tangent, ends_tan(x))
OF_1(arc_sine, ends_asin(x))
OF_1(arc_cosine, ends_acos(x))
OF_1(arc_tangent, ends_atan(x))
OF_1(hyperbolic_sine, ends_sinh(x))
OF_1(hyperbolic_cosine, ends_cosh(x))
OF_1(hyperbolic_tangent, ends_tanh(x))
OF_UNIFORM(sum_uniform, ends_sum(x, k))
OF_UNIFORM(product_uniform, ends_product(x, k))
OF_UNIFORM(product_positive, ends_product_positive(x, k))
NONE_OF(none_of_root, ends_no_root(x))
NONE_OF(none_of_log, ends_no_log(x))
NONE_OF(none_of_arc, ends_no_arc(x))

/* x k, for a number k. */
SGT_KERNEL
static void by_number(row *out, const double *lo, const double *hi, double k)
{
    EACH_LANE
    {
        two_ends x = ends_outward(lo[i] * k, hi[i] * k, 0);
        out->lo[i] = x.lo, out->hi[i] = x.hi;
    }
}

/* Slopes of one operand: x is its value, y its slope, z the value of the result. */
OF_3(copy_slope, y)
OF_3(negative_slope, ends_negative(y))
OF_3(square_slope, ends_two_products(x, y, x, y))
OF_3(cube_slope, ends_product(y, ends_scaled(ends_square(x), 3)))
OF_3(root_slope, ends_quotient(y, ends_sum(z, z)))
OF_3(cube_root_slope, ends_quotient(y, ends_scaled(ends_square(z), 3)))
OF_3(exponential_slope, ends_product(z, y))
OF_3(log_slope, ends_quotient(y, x))
OF_3(tangent_slope, ends_product(y, ends_sum(ends_of(1, 1), ends_square(z))))
OF_3(arc_sine_slope, ends_quotient(y, ends_root(ends_difference(ends_of(1, 1), ends_square(x)))))
OF_3(arc_cosine_slope,
     ends_negative(ends_quotient(y, ends_root(ends_difference(ends_of(1, 1), ends_square(x))))))
OF_3(arc_tangent_slope, ends_quotient(y, ends_sum(ends_of(1, 1), ends_square(x))))
OF_3(hyperbolic_sine_slope, ends_product(ends_cosh(x), y))
OF_3(hyperbolic_cosine_slope, ends_product(ends_sinh(x), y))
OF_3(hyperbolic_tangent_slope,
     ends_product(y, ends_within(ends_difference(ends_of(1, 1), ends_square(z)), 0, 1)))

/* A minimum of x and y with the slopes z and w: a branch that is not possible is moved to infinity. */
SGT_INLINE two_ends slope_of_branches(two_ends x, two_ends y, two_ends z, two_ends w)
{
    double unknown = ends_unknown((z.lo + z.hi) + (w.lo + w.hi));
    double no_y = x.hi < y.lo ? HUGE_VAL : 0, no_x = y.hi < x.lo ? HUGE_VAL : 0;
    double lo = lesser_of(z.lo + no_x, w.lo + no_y), hi = greater_of(z.hi - no_x, w.hi - no_y);
    return ends_of(lo + unknown, hi + unknown);
}
OF_4(branch_slope, slope_of_branches(x, y, z, w))

/* |x|, with the slope y, as the maximum of x and -x. */
OF_3(absolute_slope, slope_of_branches(ends_negative(x), x, y, ends_negative(y)))

/* x: a a' + b b'.  y: the hypotenuse of a and b.  z, w: a' and b'. */
SGT_INLINE two_ends slope_of_hypotenuse(two_ends x, two_ends y, two_ends z, two_ends w)
{
    two_ends most = ends_hypotenuse(z, w), q = ends_quotient(x, y);
    return ends_of(q.lo > -most.hi ? q.lo : -most.hi, q.hi < most.hi ? q.hi : most.hi);
}
OF_4(hypotenuse_slope, slope_of_hypotenuse(x, y, z, w))

/* x: b a' - a b', of atan2(a, b).  y, z: a and b. */
SGT_INLINE two_ends slope_of_angle(two_ends x, two_ends y, two_ends z)
{
    double cut = ends_beside_cut(y, z);
    two_ends s = ends_quotient(x, ends_sum(ends_square(y), ends_square(z)));
    return ends_of(s.lo + cut, s.hi + cut);
}
OF_3(angle_slope, slope_of_angle(x, y, z))

/* x, if y is not negative in any part. */
SGT_INLINE two_ends where_not_negative(two_ends x, two_ends y)
{
    double unknown = y.lo >= 0 ? 0 : (double)NAN;
    return ends_of(x.lo + unknown, x.hi + unknown);
}
OF_2(not_negative, where_not_negative(x, y))

SGT_KERNEL
static void waves(row *sine, row *cosine, const row *a)
{
    EACH_LANE
    {
        ends_wave w = ends_sin_cos(LANE(a));
        sine->lo[i] = w.sine.lo, sine->hi[i] = w.sine.hi;
        cosine->lo[i] = w.cosine.lo, cosine->hi[i] = w.cosine.hi;
    }
}

/* The ends of `power` times those of `by`, to nearest. */
SGT_KERNEL
static void raise(row *power, const row *by)
{
    EACH_LANE
    {
        power->lo[i] *= by->lo[i], power->hi[i] *= by->hi[i];
    }
}

/* `off` of each end outward, and `least`. */
SGT_KERNEL
static void widen(row *a, double off, double least)
{
    EACH_LANE
    {
        double lo = a->lo[i], hi = a->hi[i];
        a->lo[i] = lo - (fabs(lo) * off + least), a->hi[i] = hi + (fabs(hi) * off + least);
    }
}

OF_1(at_least_0, ends_within(x, 0, HUGE_VAL))

/* ---------------------------------------------------------------------- operations */

enum { WAVES = 4 };

/* of[k]: the register whose sine and cosine are kept, 0 and more, or -1. */
typedef struct kept_waves { int of[WAVES], next; row sine[WAVES], cosine[WAVES]; } kept_waves;

typedef struct run {
    const sgt_tape *tape;
    bool slopes;
    cell_rows reg[FORMULA_REGISTERS], given;   /* given: a uniform operand */
    kept_waves kept;
    double none[INTERVAL_LANES];           /* not 0: F is undefined all over the cell */
} run;

static void fill_row(row *a, two_ends k)
{
    for (int i = 0; i < INTERVAL_LANES; i++) a->lo[i] = k.lo, a->hi[i] = k.hi;
}

static void times_uniform(row *out, const row *a, two_ends k)
{
    if (k.lo != k.hi || !(fabs(k.lo) <= DBL_MAX)) product_uniform(out, a, k);
    else if (k.lo < 0) by_number(out, a->hi, a->lo, k.lo);
    else by_number(out, a->lo, a->hi, k.lo);
}

/* x^n, n not 0.  A product of n factors in any order is off by (n - 1) u of itself, and by n e, as numbers
 * that become subnormal on the way are below 1. */
static void whole_power(row *out, const row *a, int n)
{
    row by;
    double off = fabs((double)n);
    bool even = n % 2 == 0, first = true;
    if (even) absolute(&by, a);
    else copy(&by, a);
    for (unsigned left = n < 0 ? 0u - (unsigned)n : (unsigned)n; left; left >>= 1) {
        if (left & 1) {
            if (first) copy(out, &by);
            else raise(out, &by);
            first = false;
        }
        if (left > 1) raise(&by, &by);
    }
    widen(out, off * 0x1p-52, off * LANE_LEAST);
    if (even) at_least_0(out, out);
    if (n < 0) reciprocal(out, out);
}

static void power_step(run *w, const cell_rows *a, int n, cell_rows *out)
{
    row less;
    if (n == 3) {
        if (w->slopes) cube_slope(&out->s, &a->v, &a->s, &a->v);
        cube(&out->v, &a->v);
        return;
    }
    if (w->slopes) {
        whole_power(&less, &a->v, n - 1);
        product(&less, &less, &a->s);
        times_uniform(&out->s, &less, ends_of(n, n));
    }
    whole_power(&out->v, &a->v, n);
}

/* sqrt(a)^n, n at least 3, which has a slope at a = 0. */
static void half_power_step(run *w, const cell_rows *a, int n, cell_rows *out)
{
    row s, less;
    root(&s, &a->v);
    none_of_root(w->none, &a->v);
    if (w->slopes) {
        whole_power(&less, &s, n - 2);
        product(&less, &less, &a->s);
        times_uniform(&less, &less, ends_of(0.5 * n, 0.5 * n));
        not_negative(&out->s, &less, &a->v);
    }
    whole_power(&out->v, &s, n);
}

/* e^(k l), where an end of l may not be known. */
static void exponential_of(row *out, const row *l, two_ends k)
{
    row turned;
    if (k.lo > 0 && k.hi <= DBL_MAX) {
        product_positive(out, l, k);
    } else if (k.hi < 0 && k.lo >= -DBL_MAX) {
        negative(&turned, l);
        product_positive(out, &turned, ends_negative(k));
    } else {
        product_uniform(out, l, k);
    }
    exponential(out, out);
}

/* a^k = e^(k log a), with the slope k a^(k - 1) a'.  That is right at a = 0, too, for k > 1; else a^(k -
 * 1) is not known there. */
static void uniform_power_step(run *w, const cell_rows *a, two_ends k, cell_rows *out)
{
    row l;
    for (int i = 0; i < INTERVAL_LANES; i++)
        w->none[i] = a->v.hi[i] < 0 || (a->v.hi[i] <= 0 && k.hi <= 0) ? 1 : w->none[i];
    logarithm(&l, &a->v);
    if (w->slopes) {
        exponential_of(&out->s, &l, ends_difference(k, ends_of(1, 1)));
        product(&out->s, &out->s, &a->s);
        times_uniform(&out->s, &out->s, k);
        not_negative(&out->s, &out->s, &a->v);
    }
    exponential_of(&out->v, &l, k);
}

/* a^b, with the slope a^b (b' log a + b a' / a). */
static void real_power_step(run *w, const cell_rows *a, const cell_rows *b, cell_rows *out)
{
    row l, q;
    for (int i = 0; i < INTERVAL_LANES; i++) w->none[i] = a->v.hi[i] < 0 ? 1 : w->none[i];
    logarithm(&l, &a->v);
    product(&q, &b->v, &l);
    exponential(&out->v, &q);
    if (!w->slopes) return;
    quotient(&q, &a->s, &a->v);
    two_products(&q, &b->s, &l, &b->v, &q);
    product(&out->s, &out->v, &q);
}

/* Where sine and cosine of the register are. */
static int waves_of(run *w, int reg)
{
    kept_waves *kept = &w->kept;
    for (int k = 0; k < WAVES; k++)
        if (kept->of[k] == reg) return k;
    int k = kept->next;
    kept->next = (k + 1) % WAVES, kept->of[k] = reg;
    waves(&kept->sine[k], &kept->cosine[k], &w->reg[reg].v);
    return k;
}

static void wave_step(run *w, const formula_step *s, cell_rows *out)
{
    int k = waves_of(w, s->a);
    const row *sine = &w->kept.sine[k], *cosine = &w->kept.cosine[k];
    bool is_sine = s->op == FORMULA_SIN;
    copy(&out->v, is_sine ? sine : cosine);
    if (!w->slopes) return;
    product(&out->s, is_sine ? cosine : sine, &w->reg[s->a].s);
    if (!is_sine) negative(&out->s, &out->s);
}

/* What an operation of one operand is made of; none: NULL, it is defined everywhere. */
static const struct {
    void (*value)(row *out, const row *a);
    void (*none)(double *none, const row *a);
    void (*slope)(row *out, const row *value, const row *slope, const row *result);
} of_one[] = {
    [FORMULA_COPY] = {copy, NULL, copy_slope},
    [FORMULA_NEG] = {negative, NULL, negative_slope},
    [FORMULA_ABS] = {absolute, NULL, absolute_slope},
    [FORMULA_SQUARE] = {square, NULL, square_slope},
    [FORMULA_SQRT] = {root, none_of_root, root_slope},
    [FORMULA_CBRT] = {cube_root, NULL, cube_root_slope},
    [FORMULA_EXP] = {exponential, NULL, exponential_slope},
    [FORMULA_LOG] = {logarithm, none_of_log, log_slope},
    [FORMULA_TAN] = {tangent, NULL, tangent_slope},
    [FORMULA_ASIN] = {arc_sine, none_of_arc, arc_sine_slope},
    [FORMULA_ACOS] = {arc_cosine, none_of_arc, arc_cosine_slope},
    [FORMULA_ATAN] = {arc_tangent, NULL, arc_tangent_slope},
    [FORMULA_SINH] = {hyperbolic_sine, NULL, hyperbolic_sine_slope},
    [FORMULA_COSH] = {hyperbolic_cosine, NULL, hyperbolic_cosine_slope},
    [FORMULA_TANH] = {hyperbolic_tangent, NULL, hyperbolic_tangent_slope},
};

static void step_of_one(run *w, const formula_step *s, const cell_rows *a, cell_rows *out)
{
    of_one[s->op].value(&out->v, &a->v);
    if (of_one[s->op].none) of_one[s->op].none(w->none, &a->v);
    if (w->slopes) of_one[s->op].slope(&out->s, &a->v, &a->s, &out->v);
}

static void step_of_two(run *w, const formula_step *s, const cell_rows *a, const cell_rows *b, cell_rows *out)
{
    bool slopes = w->slopes;
    row turned;
    switch ((formula_op)s->op) {
    case FORMULA_ADD:
        sum(&out->v, &a->v, &b->v);
        if (slopes) sum(&out->s, &a->s, &b->s);
        return;
    case FORMULA_SUB:
        difference(&out->v, &a->v, &b->v);
        if (slopes) difference(&out->s, &a->s, &b->s);
        return;
    case FORMULA_MUL:
        product(&out->v, &a->v, &b->v);
        if (slopes) two_products(&out->s, &a->v, &b->s, &a->s, &b->v);
        return;
    case FORMULA_DIV: /* (a' - (a/b) b') / b */
        quotient(&out->v, &a->v, &b->v);
        if (!slopes) return;
        product(&turned, &out->v, &b->s);
        difference(&turned, &a->s, &turned);
        quotient(&out->s, &turned, &b->v);
        return;
    case FORMULA_MIN:
        minimum(&out->v, &a->v, &b->v);
        if (slopes) branch_slope(&out->s, &a->v, &b->v, &a->s, &b->s);
        return;
    case FORMULA_MAX:
        maximum(&out->v, &a->v, &b->v);
        if (slopes) branch_slope(&out->s, &a->v, &b->v, &b->s, &a->s);
        return;
    case FORMULA_HYPOT:
        hypotenuse(&out->v, &a->v, &b->v);
        if (!slopes) return;
        two_products(&turned, &a->v, &a->s, &b->v, &b->s);
        hypotenuse_slope(&out->s, &turned, &out->v, &a->s, &b->s);
        return;
    case FORMULA_ATAN2:
        angle(&out->v, &a->v, &b->v);
        if (!slopes) return;
        negative(&turned, &a->v);
        two_products(&turned, &b->v, &a->s, &turned, &b->s);
        angle_slope(&out->s, &turned, &a->v, &b->v);
        return;
    default: real_power_step(w, a, b, out); return;
    }
}

/* Of a sum, a difference, a product or a quotient with a uniform k.  Returns false if it is of another
 * kind. */
static bool step_with_uniform(run *w, const formula_step *s, const cell_rows *a, bool first, two_ends k,
                              cell_rows *out)
{
    switch ((formula_op)s->op) {
    case FORMULA_ADD: sum_uniform(&out->v, &a->v, k); break;
    case FORMULA_SUB:
        if (first) negative(&out->v, &a->v);
        sum_uniform(&out->v, first ? &out->v : &a->v, first ? k : ends_negative(k));
        if (w->slopes && first) negative(&out->s, &a->s);
        if (first) return true;
        break;
    case FORMULA_DIV:
        if (first) return false;
        k = ends_reciprocal(k);
        /* fallthrough */
    case FORMULA_MUL:
        times_uniform(&out->v, &a->v, k);
        if (w->slopes) times_uniform(&out->s, &a->s, k);
        return true;
    case FORMULA_REAL_POWER:
        if (first) return false;
        uniform_power_step(w, a, k, out);
        return true;
    default: return false;
    }
    if (w->slopes) copy(&out->s, &a->s);
    return true;
}

static void step_on_rows(run *w, const formula_step *s, cell_rows *out)
{
    bool two = s->op <= FORMULA_REAL_POWER, u_a = s->a >= FORMULA_UNIFORM;
    bool u_b = two && s->b >= FORMULA_UNIFORM;
    const cell_rows *a = u_a ? &w->given : &w->reg[s->a], *b = u_b ? &w->given : two ? &w->reg[s->b] : NULL;
    if (u_a || u_b) {
        sgt_interval value = w->tape->value[(u_a ? s->a : s->b) - FORMULA_UNIFORM];
        two_ends k = {value.lo, value.hi};
        if (k.lo > k.hi) /* undefined, and so is F */
            for (int i = 0; i < INTERVAL_LANES; i++) w->none[i] = 1;
        if (two && step_with_uniform(w, s, u_a ? b : a, u_a, k, out)) return;
        fill_row(&w->given.v, k), fill_row(&w->given.s, ends_of(0, 0));
    }
    if (two) step_of_two(w, s, a, b, out);
    else if (s->op == FORMULA_SIN || s->op == FORMULA_COS) wave_step(w, s, out);
    else if (s->op == FORMULA_POWER) power_step(w, a, s->n, out);
    else if (s->op == FORMULA_HALF_POWER) half_power_step(w, a, s->n, out);
    else step_of_one(w, s, a, out);
}

/* A uniform that is not known may be undefined. */
static bool is_known(const sgt_tape *tape, unsigned short operand)
{
    if (operand < FORMULA_UNIFORM) return true;
    sgt_interval k = tape->value[operand - FORMULA_UNIFORM];
    return fabs(k.lo) <= DBL_MAX && fabs(k.hi) <= DBL_MAX;
}

static void step(run *w, const formula_step *s)
{
    cell_rows *out = &w->reg[s->out];
    for (int k = 0; k < WAVES; k++)
        if (w->kept.of[k] == s->out) w->kept.of[k] = -1;
    step_on_rows(w, s, out);
    bool known = is_known(w->tape, s->a) && (s->op > FORMULA_REAL_POWER || is_known(w->tape, s->b));
    if (!known) fill_row(&out->s, ends_of((double)NAN, (double)NAN));
}

/* -------------------------------------------------------------------------- cell_rows */

/* The numbers of a block; those that are missing are copies of the last. */
static void take(double to[INTERVAL_LANES], const double *from, size_t count)
{
    for (size_t i = 0; i < INTERVAL_LANES; i++) to[i] = from[i < count ? i : count - 1];
}

/* Puts out the value: no end that is not known is left, nor a value where there is none. */
static void put_value(const run *w, const row *v, size_t count, double *lo, double *hi)
{
    for (size_t i = 0; i < count; i++) {
        bool none = w->none[i] != 0;
        lo[i] = none ? HUGE_VAL : v->lo[i] < HUGE_VAL ? v->lo[i] : -HUGE_VAL;
        hi[i] = none ? -HUGE_VAL : v->hi[i] > -HUGE_VAL ? v->hi[i] : HUGE_VAL;
    }
}

/* The same of the slope, which is all numbers if one end is not known. */
static void put_slope(const run *w, const row *s, size_t count, double *lo, double *hi)
{
    for (size_t i = 0; i < count; i++) {
        bool known = w->none[i] == 0 && fabs(s->lo[i]) <= DBL_MAX && fabs(s->hi[i]) <= DBL_MAX;
        lo[i] = known ? s->lo[i] : -HUGE_VAL, hi[i] = known ? s->hi[i] : HUGE_VAL;
    }
}

void sgt_formula_encloses(const sgt_tape *tape, size_t n, sgt_rays rays, const double *t_lo,
                          const double *t_hi, sgt_enclosures out)
{
    run w; /* its registers are not cleared */
    w.tape = tape, w.slopes = out.slope_lo != NULL;
    int variables = tape->kind == SGT_FORMULA_XY ? 2 : 3;
    const cell_rows *last = &w.reg[tape->step[tape->steps - 1].out];
    for (size_t first = 0, count; first < n; first += count) {
        count = n - first < INTERVAL_LANES ? n - first : INTERVAL_LANES;
        row t, on; /* on: o and d */
        take(t.lo, t_lo + first, count), take(t.hi, t_hi + first, count);
        for (int k = 0; k < variables; k++) {
            take(on.lo, rays.o[k] + first, count), take(on.hi, rays.d[k] + first, count);
            on_line(&w.reg[k].v, on.lo, on.hi, t.lo, t.hi);
            take(w.reg[k].s.lo, on.hi, INTERVAL_LANES), take(w.reg[k].s.hi, on.hi, INTERVAL_LANES);
        }
        for (int k = 0; k < WAVES; k++) w.kept.of[k] = -1;
        w.kept.next = 0;
        for (int i = 0; i < INTERVAL_LANES; i++) w.none[i] = 0;
        for (int j = 0; j < tape->steps; j++) step(&w, &tape->step[j]);
        put_value(&w, &last->v, count, out.lo + first, out.hi + first);
        if (w.slopes) put_slope(&w, &last->s, count, out.slope_lo + first, out.slope_hi + first);
    }
}
