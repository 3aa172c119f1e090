// SPDX-License-Identifier: MIT
/* enclose.c - a formula over intervals: F, derivatives in two directions, and the second derivative of both.
 *
 * Each register carries intervals of f, f_u, f_v and f_uv (values.c has the same in doubles).  With exact
 * rules and outward rounding (interval.h) each contains all values over the region: Moore 1966.
 *
 * WHERE A FUNCTION IS NOT DEFINED on all of its operand, or jumps, its derivative is set to all numbers.  All
 * numbers times anything but exactly 0 stay without bound, through every rule below.  So a derivative with
 * two finite ends promises that F is defined and continuous all over.  For this a product with 0 must not end
 * it: interval.h has 0 times all numbers = 0.  That is right for derivatives of a number that is not there (a
 * formula of x alone, by y), and it is wrong for a promise.  So what may be undefined is remembered beside
 * the numbers: `whole` is false from there on, and the derivatives of the result are all numbers.
 *
 * KINKS.  |a|, min, max and the hypotenuse are continuous, and smooth but at kinks.  Over a region with a
 * kink the derivative is the hull of those of both sides (Clarke 1983, section 2.2), and for that the mean
 * value theorem holds (Lebourg 1975).  Second derivatives have no bound there. */
#include "../../num/exact.h"
#include "formula.h"

#include <math.h>

typedef struct jet { sgt_interval f, u, v, uv; bool whole, smooth; } jet;

/* v = op(a, b): the partial derivatives by the operands.  whole: op is defined and continuous all over;
 * smooth: so are its first derivatives. */
typedef struct parts { sgt_interval v, a, b, aa, ab, bb; bool whole, smooth; } parts;

static sgt_interval just(double x) { return sgt_interval_of(x); }
static sgt_interval mul(sgt_interval x, sgt_interval y) { return sgt_interval_product(x, y); }
static sgt_interval ratio(sgt_interval x, sgt_interval y) { return sgt_interval_quotient(x, y); }
static sgt_interval add(sgt_interval x, sgt_interval y) { return sgt_interval_sum(x, y); }
static sgt_interval sub(sgt_interval x, sgt_interval y) { return sgt_interval_difference(x, y); }
static sgt_interval negative(sgt_interval x) { return sgt_interval_negative(x); }
static sgt_interval squared(sgt_interval x) { return sgt_interval_square(x); }
static sgt_interval multiple_of(sgt_interval x, double by) { return sgt_interval_scaled(x, by); }
static bool may_be_zero(sgt_interval x) { return !(x.lo > 0) && !(x.hi < 0); }
static bool has_ends(sgt_interval x) { return x.lo > -HUGE_VAL && x.hi < HUGE_VAL; }

/* Of the origin alone any angle: a ray through it is left undecided, not missed. */
static sgt_interval angle_of(sgt_interval y, sgt_interval x)
{
    const sgt_interval around = {-1, 1};
    bool origin = y.lo == 0 && y.hi == 0 && x.lo == 0 && x.hi == 0;
    return origin ? sgt_interval_angle(around, around) : sgt_interval_angle(y, x);
}

sgt_interval sgt_formula_interval(formula_op op, int n, sgt_interval a, sgt_interval b)
{
    switch (op) {
    case FORMULA_ADD: return sgt_interval_sum(a, b);
    case FORMULA_SUB: return sgt_interval_difference(a, b);
    case FORMULA_MUL: return sgt_interval_product(a, b);
    case FORMULA_DIV: return sgt_interval_quotient(a, b);
    case FORMULA_MIN: return sgt_interval_minimum(a, b);
    case FORMULA_MAX: return sgt_interval_maximum(a, b);
    case FORMULA_HYPOT: return sgt_interval_hypotenuse(a, b);
    case FORMULA_ATAN2: return angle_of(a, b);
    case FORMULA_REAL_POWER: return sgt_interval_real_power(a, b);
    case FORMULA_POWER: return sgt_interval_power(a, n);
    case FORMULA_HALF_POWER: return sgt_interval_power(sgt_interval_square_root(a), n);
    case FORMULA_SQUARE: return sgt_interval_square(a);
    case FORMULA_NEG: return sgt_interval_negative(a);
    case FORMULA_ABS: return sgt_interval_absolute(a);
    case FORMULA_SQRT: return sgt_interval_square_root(a);
    case FORMULA_CBRT: return sgt_interval_cube_root(a);
    case FORMULA_EXP: return sgt_interval_exponential(a);
    case FORMULA_LOG: return sgt_interval_logarithm(a);
    case FORMULA_SIN: return sgt_interval_sine(a);
    case FORMULA_COS: return sgt_interval_cosine(a);
    case FORMULA_TAN: return sgt_interval_tangent(a);
    case FORMULA_ASIN: return sgt_interval_arc_sine(a);
    case FORMULA_ACOS: return sgt_interval_arc_cosine(a);
    case FORMULA_ATAN: return sgt_interval_arc_tangent(a);
    case FORMULA_SINH: return sgt_interval_hyperbolic_sine(a);
    case FORMULA_COSH: return sgt_interval_hyperbolic_cosine(a);
    case FORMULA_TANH: return sgt_interval_hyperbolic_tangent(a);
    case FORMULA_COPY:
    case FORMULA_NUMBER:
    case FORMULA_PI:
    case FORMULA_PARAMETER: break;
    }
    return a;
}

/* --------------------------------------------------------- derivatives of one operation */

static const sgt_interval ZERO = {0, 0}, ONE = {1, 1};

/* 1 where x > 0, -1 where x < 0, both between.  Of 0 alone both, too: the kink is all that is there, and
 * points nearby are on either side.  (A region that ends at the kink is on one.) */
static sgt_interval sign_in(sgt_interval x)
{
    if (x.lo == 0 && x.hi == 0) return sgt_interval_between(-1, 1);
    return x.lo >= 0 ? just(1) : x.hi <= 0 ? just(-1) : sgt_interval_between(-1, 1);
}

/* (1 - x)(1 + x), of |x| <= 1. */
static sgt_interval beside_one(sgt_interval x)
{
    return sgt_interval_maximum(mul(sub(ONE, x), add(ONE, x)), ZERO);
}

static sgt_interval kept_within(sgt_interval x, double most)
{
    return sgt_interval_intersection(x, sgt_interval_between(-most, most));
}

/* a / v, b / v with v the hypotenuse: a sine and a cosine. */
static void parts_of_hypotenuse(sgt_interval a, sgt_interval b, parts *p)
{
    sgt_interval s = kept_within(ratio(a, p->v), 1), c = kept_within(ratio(b, p->v), 1);
    p->a = s, p->b = c;
    p->smooth = p->v.lo > 0;
    p->aa = ratio(squared(c), p->v), p->bb = ratio(squared(s), p->v);
    p->ab = negative(ratio(mul(s, c), p->v));
}

/* The angle of the point (x, y); its gradient is (x, -y) / r^2. */
static void parts_of_angle(sgt_interval y, sgt_interval x, parts *p)
{
    sgt_interval r = sgt_interval_hypotenuse(x, y), r2 = squared(r);
    p->whole = p->smooth = r.lo > 0 && !(x.lo < 0 && may_be_zero(y));
    p->a = ratio(ratio(kept_within(x, r.hi), r), r), p->b = negative(ratio(ratio(y, r), r));
    sgt_interval twist = multiple_of(ratio(mul(ratio(x, r), ratio(y, r)), r2), 2);
    p->aa = negative(twist), p->bb = twist;
    p->ab = ratio(sub(squared(kept_within(ratio(y, r), 1)), squared(kept_within(ratio(x, r), 1))), r2);
}

/* a^b = exp(b log a). */
static void parts_of_real_power(sgt_interval a, sgt_interval b, parts *p)
{
    sgt_interval log = sgt_interval_logarithm(a);
    sgt_interval less = sgt_interval_real_power(a, sub(b, ONE)),
                 twice = sgt_interval_real_power(a, sub(b, just(2)));
    bool above = a.lo > 0, fixed = b.lo == b.hi || !(b.hi - b.lo > 0x1p-40 * fabs(b.hi));
    p->whole = above || (a.lo >= 0 && b.lo > 0 && fixed);
    p->smooth = above || (a.lo >= 0 && b.lo > 1 && fixed);
    p->a = mul(b, less), p->b = mul(p->v, log);
    p->aa = mul(mul(b, sub(b, ONE)), twice);
    p->ab = mul(less, add(ONE, mul(b, log))), p->bb = mul(p->b, log);
}

static void parts_of_power(int n, sgt_interval a, parts *p)
{
    p->whole = p->smooth = n > 0 || !may_be_zero(a);
    p->a = multiple_of(sgt_interval_power(a, n - 1), n);
    p->aa = multiple_of(sgt_interval_power(a, n - 2), (double)n * (n - 1)); /* exact: |n| < 2^26 */
}

/* sqrt(a)^n, n at least 3.  At a = 0 it has a derivative, which the chain of sqrt(a) and a power has not. */
static void parts_of_half_power(int n, sgt_interval a, parts *p)
{
    sgt_interval s = sgt_interval_square_root(a);
    p->whole = p->smooth = a.lo >= 0;
    p->a = multiple_of(sgt_interval_power(s, n - 2), 0.5 * n);
    p->aa = multiple_of(sgt_interval_power(s, n - 4), 0.25 * n * (n - 2.0)); /* exact */
}

/* All but the value, which is there.  Empty: at no point of the operands. */
static void parts_by_rule(formula_op op, int n, sgt_interval a, sgt_interval b, parts *p)
{
    sgt_interval s, v = p->v;
    p->whole = p->smooth = true;
    switch (op) {
    case FORMULA_ADD: p->a = p->b = ONE, p->aa = p->ab = p->bb = ZERO; break;
    case FORMULA_SUB: p->a = ONE, p->b = just(-1), p->aa = p->ab = p->bb = ZERO; break;
    case FORMULA_MUL: p->a = b, p->b = a, p->ab = ONE, p->aa = p->bb = ZERO; break;
    case FORMULA_DIV:
        p->whole = p->smooth = !may_be_zero(b);
        s = ratio(ONE, b);
        p->a = s, p->b = negative(ratio(v, b)), p->aa = ZERO, p->ab = negative(squared(s));
        p->bb = multiple_of(mul(v, squared(s)), 2);
        break;
    case FORMULA_MIN:
    case FORMULA_MAX:
        s = op == FORMULA_MIN ? sub(b, a) : sub(a, b);
        p->smooth = s.lo > 0 || s.hi < 0;
        p->a = s.lo > 0 ? ONE : s.hi < 0 ? ZERO : sgt_interval_between(0, 1), p->b = sub(ONE, p->a);
        p->aa = p->ab = p->bb = ZERO;
        break;
    case FORMULA_HYPOT: parts_of_hypotenuse(a, b, p); break;
    case FORMULA_ATAN2: parts_of_angle(a, b, p); break;
    case FORMULA_REAL_POWER: parts_of_real_power(a, b, p); break;
    case FORMULA_POWER: parts_of_power(n, a, p); break;
    case FORMULA_HALF_POWER: parts_of_half_power(n, a, p); break;
    case FORMULA_SQUARE: p->a = multiple_of(a, 2), p->aa = just(2); break;
    case FORMULA_NEG: p->a = just(-1), p->aa = ZERO; break;
    case FORMULA_ABS: p->a = sign_in(a), p->smooth = !may_be_zero(a), p->aa = ZERO; break;
    case FORMULA_SQRT:
        p->whole = a.lo >= 0, p->smooth = a.lo > 0;
        p->a = ratio(just(0.5), v), p->aa = negative(ratio(ratio(just(0.25), v), a));
        break;
    case FORMULA_CBRT:
        p->smooth = !may_be_zero(a);
        s = ratio(ONE, multiple_of(squared(v), 3));
        p->a = sgt_interval_maximum(s, ZERO),
        p->aa = negative(ratio(mul(just(2), s), mul(just(3), a)));
        break;
    case FORMULA_EXP: p->a = p->aa = v; break;
    case FORMULA_LOG:
        p->whole = p->smooth = a.lo > 0;
        p->a = ratio(ONE, a), p->aa = negative(squared(p->a));
        break;
    case FORMULA_SIN: p->a = sgt_interval_cosine(a), p->aa = negative(v); break;
    case FORMULA_COS: p->a = negative(sgt_interval_sine(a)), p->aa = negative(v); break;
    case FORMULA_TAN:
        p->whole = p->smooth = has_ends(v);
        p->a = add(ONE, squared(v)), p->aa = multiple_of(mul(v, p->a), 2);
        break;
    case FORMULA_ASIN:
    case FORMULA_ACOS:
        p->whole = a.lo >= -1 && a.hi <= 1, p->smooth = a.lo > -1 && a.hi < 1;
        s = ratio(ONE, sgt_interval_square_root(beside_one(a)));
        p->a = op == FORMULA_ASIN ? s : negative(s), p->aa = mul(a, mul(p->a, squared(s)));
        break;
    case FORMULA_ATAN:
        p->a = ratio(ONE, add(ONE, squared(a)));
        p->aa = multiple_of(mul(a, squared(p->a)), -2);
        break;
    case FORMULA_SINH: p->a = sgt_interval_hyperbolic_cosine(a), p->aa = v; break;
    case FORMULA_COSH: p->a = sgt_interval_hyperbolic_sine(a), p->aa = v; break;
    case FORMULA_TANH:
        p->a = sgt_interval_maximum(mul(sub(ONE, v), add(ONE, v)), ZERO);
        p->aa = multiple_of(mul(v, p->a), -2);
        break;
    case FORMULA_COPY: p->a = ONE, p->aa = ZERO; break;
    case FORMULA_NUMBER:
    case FORMULA_PI:
    case FORMULA_PARAMETER: break;
    }
}

static sgt_interval or_all(sgt_interval x) { return sgt_interval_is_empty(x) ? sgt_interval_all() : x; }

/* A derivative that is nowhere defined, as of sqrt at [0, 0], has no bound.  So times a 0 it is 0, and that
 * is right: the operand is the same all over.  On the plane x = 0 cbrt(x) has the slope 0. */
static void parts_of(formula_op op, int n, sgt_interval a, sgt_interval b, parts *p)
{
    parts_by_rule(op, n, a, b, p);
    p->a = or_all(p->a), p->b = or_all(p->b);
    p->aa = or_all(p->aa), p->ab = or_all(p->ab), p->bb = or_all(p->bb);
}

/* ------------------------------------------------------------------------- the tape */

/* Of one that may not be defined (all numbers) nothing else is. */
static jet jet_of_uniform(sgt_interval f)
{
    bool whole = has_ends(f);
    return (jet){f, {0, 0}, {0, 0}, {0, 0}, whole, whole};
}

/* The derivative of a minimum where either may be the less: that of one or of the other. */
static sgt_interval of_either(const parts *p, sgt_interval a, sgt_interval b)
{
    if (p->a.lo == p->a.hi) return p->a.lo == 1 ? a : b;
    return sgt_interval_hull(a, b);
}

static sgt_interval chained(const parts *p, sgt_interval a, sgt_interval b, bool two)
{
    sgt_interval d = mul(p->a, a);
    return two ? add(d, mul(p->b, b)) : d;
}

static sgt_interval chained_twice(const parts *p, const jet *a, const jet *b)
{
    sgt_interval d = add(mul(p->a, a->uv), mul(p->aa, mul(a->u, a->v)));
    if (!b) return d;
    d = add(d, add(mul(p->b, b->uv), mul(p->bb, mul(b->u, b->v))));
    return add(d, mul(p->ab, add(mul(a->u, b->v), mul(a->v, b->u))));
}

/* r: sqrt(x^2 + y^2) is known to be in it. */
static jet jet_step(formula_op op, int n, const jet *a, const jet *b, const sgt_interval *r, bool second)
{
    parts p = {.v = sgt_formula_interval(op, n, a->f, b ? b->f : ZERO)};
    if (r) p.v = sgt_interval_intersection(p.v, *r);
    jet out = {.f = p.v};
    if (sgt_interval_is_empty(p.v)) {
        out.u = out.v = out.uv = sgt_interval_all();
        return out;
    }
    parts_of(op, n, a->f, b ? b->f : ZERO, &p);
    bool either = op == FORMULA_MIN || op == FORMULA_MAX;
    out.u = either ? of_either(&p, a->u, b->u) : chained(&p, a->u, b ? b->u : ZERO, b);
    out.v = either ? of_either(&p, a->v, b->v) : chained(&p, a->v, b ? b->v : ZERO, b);
    out.uv = !second ? ZERO : either ? of_either(&p, a->uv, b->uv) : chained_twice(&p, a, b);
    out.whole = p.whole && a->whole && (!b || b->whole);
    out.smooth = p.smooth && a->smooth && (!b || b->smooth);
    return out;
}

/* The steps from `first` on. */
static formula_jet jet_of_steps(const sgt_tape *tape, int first, jet reg[], sgt_interval r, bool second)
{
    jet other;
    const jet *last = &reg[tape->step[tape->steps - 1].out];
    for (int i = first; i < tape->steps; i++) {
        const formula_step *s = &tape->step[i];
        bool two = s->op <= FORMULA_REAL_POWER, u_a = s->a >= FORMULA_UNIFORM,
             u_b = two && s->b >= FORMULA_UNIFORM;
        if (u_a || u_b) other = jet_of_uniform(tape->value[(u_a ? s->a : s->b) - FORMULA_UNIFORM]);
        bool is_r = s->op == FORMULA_HYPOT && s->a + s->b == 1; /* of x and y */
        reg[s->out] = jet_step((formula_op)s->op, s->n, u_a ? &other : &reg[s->a],
                               u_b ? &other : two ? &reg[s->b] : NULL, is_r ? &r : NULL, second);
    }
    formula_jet out = {last->f, last->u, last->v, last->uv, last->whole};
    if (!last->whole) out.u = out.v = sgt_interval_all();
    if (!last->whole || !last->smooth) out.uv = sgt_interval_all();
    return out;
}

formula_jet sgt_formula_jet(const sgt_tape *tape, const sgt_interval at[3], sgt_interval r,
                            const sgt_interval du[3], const sgt_interval dv[3], bool second)
{
    jet reg[FORMULA_REGISTERS];
    int variables = tape->kind == SGT_FORMULA_XY ? 2 : 3;
    for (int k = 0; k < variables; k++) reg[k] = (jet){at[k], du[k], dv[k], ZERO, true, true};
    return jet_of_steps(tape, 0, reg, r, second);
}

bool sgt_formula_jumps(const sgt_tape *tape, const sgt_interval at[3], sgt_interval r)
{
    const sgt_interval none[3] = {{0, 0}, {0, 0}, {0, 0}};
    return tape->jumps && !sgt_formula_jet(tape, at, r, none, none, false).whole;
}

formula_jet sgt_formula_radial_jet(const sgt_tape *tape, sgt_interval s, bool second)
{
    jet reg[FORMULA_REGISTERS];
    reg[tape->step[2].out] = (jet){s, ONE, ONE, ZERO, true, true};
    return jet_of_steps(tape, 3, reg, sgt_interval_all(), second);
}

/* At the vertex a conic is c s / 2 + (1 + k) c^3 s^2 / 8 + ..., with s = r^2.  c is the mean curvature, if
 * those by x and by y are much the same; k is from F_ss of a radial tape, where that is not far from a
 * sphere's. */
void sgt_formula_vertex(const sgt_tape *tape, double *c, double *k)
{
    const sgt_interval by[2][3] = {{ONE, ZERO, ZERO}, {ZERO, ONE, ZERO}}, vertex[3] = {ZERO, ZERO, ZERO};
    double bend = 0;
    *c = *k = 0;
    if (tape->radial) {
        formula_jet by_s = sgt_formula_radial_jet(tape, ZERO, true);
        *c = 2 * sgt_interval_middle(by_s.u), bend = 4 * sgt_interval_middle(by_s.uv);
    } else {
        double xx = sgt_interval_middle(sgt_formula_jet(tape, vertex, ZERO, by[0], by[0], true).uv),
               yy = sgt_interval_middle(sgt_formula_jet(tape, vertex, ZERO, by[1], by[1], true).uv);
        if (fabs(xx - yy) <= 0.25 * fabs(xx + yy)) *c = 0.5 * (xx + yy);
    }
    if (!(fabs(*c) < 0x1p300)) *c = 0;
    double k1 = bend / (*c * *c * *c);
    if (k1 > -8 && k1 < 2) *k = k1 - 1;
}

/* ---------------------------------------------------------------------------- noise */

/* A number and how far it is off as computed. */
typedef struct noisy { sgt_interval f; double off; } noisy;

/* What an operation itself rounds, in u of its result. */
static double rounds(formula_op op, int n)
{
    switch (op) {
    case FORMULA_NEG: case FORMULA_ABS: case FORMULA_COPY: case FORMULA_MIN: case FORMULA_MAX: return 0;
    case FORMULA_ADD: case FORMULA_SUB: case FORMULA_MUL: case FORMULA_DIV: case FORMULA_SQUARE:
    case FORMULA_SQRT: return 1;
    case FORMULA_POWER: return fabs((double)n) + 2;
    case FORMULA_HALF_POWER: return 2 * (double)n + 2;
    default: return FORMULA_FUNCTION_ULPS;
    }
}

static sgt_interval wider(const noisy *x)
{
    return sgt_interval_between(-sgt_sum_above(-x->f.lo, x->off), sgt_sum_above(x->f.hi, x->off));
}

/* By the mean value theorem between the operands and these as computed. */
static noisy noisy_step(formula_op op, int n, const noisy *a, const noisy *b)
{
    sgt_interval wide_a = wider(a), wide_b = b ? wider(b) : ZERO;
    parts p = {.v = sgt_formula_interval(op, n, wide_a, wide_b)};
    parts_of(op, n, wide_a, wide_b, &p);
    double off = a->off != 0 ? sgt_interval_greatest(p.a) * a->off : 0;
    if (b && b->off != 0) off += sgt_interval_greatest(p.b) * b->off;
    off += rounds(op, n) * SGT_U * sgt_interval_greatest(p.v);
    if (rounds(op, n) > 0) off += 0x1p-1060; /* underflow */
    off = p.whole && !sgt_interval_is_empty(p.v) ? off * (1 + 0x1p-40) : HUGE_VAL;
    return (noisy){sgt_formula_interval(op, n, a->f, b ? b->f : ZERO), off};
}

double sgt_formula_noise(const sgt_tape *tape, const sgt_interval at[3], sgt_interval r)
{
    noisy reg[FORMULA_REGISTERS], other;
    int variables = tape->kind == SGT_FORMULA_XY ? 2 : 3;
    for (int k = 0; k < variables; k++) reg[k] = (noisy){at[k], 0};
    for (int i = 0; i < tape->steps; i++) {
        const formula_step *s = &tape->step[i];
        bool two = s->op <= FORMULA_REAL_POWER, u_a = s->a >= FORMULA_UNIFORM,
             u_b = two && s->b >= FORMULA_UNIFORM;
        if (u_a || u_b) {
            sgt_interval u = tape->value[(u_a ? s->a : s->b) - FORMULA_UNIFORM];
            other = (noisy){u, u.hi > u.lo ? sgt_interval_width(u) : 0};
        }
        noisy out = noisy_step((formula_op)s->op, s->n, u_a ? &other : &reg[s->a],
                               u_b ? &other : two ? &reg[s->b] : NULL);
        if (s->op == FORMULA_HYPOT && s->a + s->b == 1) out.f = sgt_interval_intersection(out.f, r);
        if (tape->radial && i == 2) out.f = sgt_interval_intersection(out.f, squared(r));
        reg[s->out] = out;
    }
    double off = reg[tape->step[tape->steps - 1].out].off;
    return off < HUGE_VAL ? off : HUGE_VAL; /* nor NaN */
}
