// SPDX-License-Identifier: MIT
/* tape_run.h - the tape of a formula looked at and run, step by step, for tests of the reader.
 *
 * It is the plain reading of src/surface/formula/tape.h, in long double, with the C library's functions. What
 * is not defined is NaN.  REQUIRE comes from who includes this. */
#ifndef TESTS_UNIT_TAPE_RUN_H
#define TESTS_UNIT_TAPE_RUN_H

#include "../../src/surface/formula/tape.h"

#include <sagitta/interval.h>

#include <math.h>

/* NaN where it is not defined; infinite if it is too large. */
static UNUSED long double op_value(formula_op op, int n, long double a, long double b)
{
    const long double none = (long double)NAN;
    if (isnan(a) || isnan(b)) return none;
    switch (op) {
    case FORMULA_ADD:
        return a + b;
    case FORMULA_SUB:
        return a - b;
    case FORMULA_MUL:
        return a * b;
    case FORMULA_DIV:
        return b == 0 ? none : a / b;
    case FORMULA_MIN:
        return a < b ? a : b;
    case FORMULA_MAX:
        return a > b ? a : b;
    case FORMULA_HYPOT:
        return hypotl(a, b);
    case FORMULA_ATAN2:
        return a == 0 && b == 0 ? none : atan2l(a == 0 ? 0 : a, b);
    case FORMULA_REAL_POWER:
        return a < 0 || (a == 0 && b <= 0) ? none : powl(a, b);
    case FORMULA_POWER:
        return n < 0 && a == 0 ? none : powl(a, n);
    case FORMULA_HALF_POWER:
        return a < 0 ? none : powl(a, n / 2.0L);
    case FORMULA_SQUARE:
        return a * a;
    case FORMULA_NEG:
        return -a;
    case FORMULA_ABS:
        return fabsl(a);
    case FORMULA_SQRT:
        return a < 0 ? none : sqrtl(a);
    case FORMULA_CBRT:
        return cbrtl(a);
    case FORMULA_EXP:
        return expl(a);
    case FORMULA_LOG:
        return a <= 0 ? none : logl(a);
    case FORMULA_SIN:
        return sinl(a);
    case FORMULA_COS:
        return cosl(a);
    case FORMULA_TAN:
        return tanl(a);
    case FORMULA_ASIN:
        return fabsl(a) > 1 ? none : asinl(a);
    case FORMULA_ACOS:
        return fabsl(a) > 1 ? none : acosl(a);
    case FORMULA_ATAN:
        return atanl(a);
    case FORMULA_SINH:
        return sinhl(a);
    case FORMULA_COSH:
        return coshl(a);
    case FORMULA_TANH:
        return tanhl(a);
    default:
        return a;
    }
}

enum { TAPE_UNIFORMS = 4096 };

/* F at a point, from the tape's numbers and parameters alone. */
static UNUSED long double tape_value(const sgt_tape *t, const long double point[3])
{
    static long double uniform[TAPE_UNIFORMS];
    long double r[FORMULA_REGISTERS] = {point[0], point[1], point[2]};
    REQUIRE(t->uniforms <= TAPE_UNIFORMS, "%d uniforms", t->uniforms);
    for (int i = 0; i < t->uniforms; i++) {
        const formula_uniform *u = t->uniform + i;
        uniform[i] = u->op == FORMULA_NUMBER      ? (long double)u->number
                     : u->op == FORMULA_PI        ? acosl(-1)
                     : u->op == FORMULA_PARAMETER ? (long double)t->given[u->n]
                                                  : op_value((formula_op)u->op, u->n, uniform[u->a],
                                                             u->op <= FORMULA_REAL_POWER ? uniform[u->b] : 0);
    }
    for (int i = 0; i < t->steps; i++) {
        const formula_step *s = t->step + i;
        long double a = s->a < FORMULA_UNIFORM ? r[s->a] : uniform[s->a - FORMULA_UNIFORM], b = 0;
        if (s->op <= FORMULA_REAL_POWER)
            b = s->b < FORMULA_UNIFORM ? r[s->b] : uniform[s->b - FORMULA_UNIFORM];
        r[s->out] = op_value((formula_op)s->op, s->n, a, b);
    }
    return r[t->step[t->steps - 1].out];
}

/* One operation on intervals. */
static UNUSED sgt_interval op_interval(formula_op op, int n, sgt_interval a, sgt_interval b)
{
    switch (op) {
    case FORMULA_ADD:
        return sgt_interval_sum(a, b);
    case FORMULA_SUB:
        return sgt_interval_difference(a, b);
    case FORMULA_MUL:
        return sgt_interval_product(a, b);
    case FORMULA_DIV:
        return sgt_interval_quotient(a, b);
    case FORMULA_MIN:
        return sgt_interval_minimum(a, b);
    case FORMULA_MAX:
        return sgt_interval_maximum(a, b);
    case FORMULA_HYPOT:
        return sgt_interval_hypotenuse(a, b);
    case FORMULA_ATAN2:
        return sgt_interval_angle(a, b);
    case FORMULA_REAL_POWER:
        return sgt_interval_real_power(a, b);
    case FORMULA_POWER:
        return sgt_interval_power(a, n);
    case FORMULA_HALF_POWER:
        return sgt_interval_power(sgt_interval_square_root(a), n);
    case FORMULA_SQUARE:
        return sgt_interval_square(a);
    case FORMULA_NEG:
        return sgt_interval_negative(a);
    case FORMULA_ABS:
        return sgt_interval_absolute(a);
    case FORMULA_SQRT:
        return sgt_interval_square_root(a);
    case FORMULA_CBRT:
        return sgt_interval_cube_root(a);
    case FORMULA_EXP:
        return sgt_interval_exponential(a);
    case FORMULA_LOG:
        return sgt_interval_logarithm(a);
    case FORMULA_SIN:
        return sgt_interval_sine(a);
    case FORMULA_COS:
        return sgt_interval_cosine(a);
    case FORMULA_TAN:
        return sgt_interval_tangent(a);
    case FORMULA_ASIN:
        return sgt_interval_arc_sine(a);
    case FORMULA_ACOS:
        return sgt_interval_arc_cosine(a);
    case FORMULA_ATAN:
        return sgt_interval_arc_tangent(a);
    case FORMULA_SINH:
        return sgt_interval_hyperbolic_sine(a);
    case FORMULA_COSH:
        return sgt_interval_hyperbolic_cosine(a);
    case FORMULA_TANH:
        return sgt_interval_hyperbolic_tangent(a);
    default:
        return a;
    }
}

/* F at a point in intervals, of the tape's own intervals. */
static UNUSED sgt_interval tape_interval(const sgt_tape *t, sgt_vec3 p)
{
    sgt_interval r[FORMULA_REGISTERS] = {{p.x, p.x}, {p.y, p.y}, {p.z, p.z}};
    for (int i = 0; i < t->steps; i++) {
        const formula_step *s = t->step + i;
        sgt_interval a = s->a < FORMULA_UNIFORM ? r[s->a] : t->value[s->a - FORMULA_UNIFORM], b = a;
        if (s->op <= FORMULA_REAL_POWER)
            b = s->b < FORMULA_UNIFORM ? r[s->b] : t->value[s->b - FORMULA_UNIFORM];
        r[s->out] = op_interval((formula_op)s->op, s->n, a, b);
    }
    return r[t->step[t->steps - 1].out];
}

static UNUSED int tape_count(const sgt_tape *t, formula_op op)
{
    int count = 0;
    for (int i = 0; i < t->steps; i++) count += t->step[i].op == op;
    return count;
}

static UNUSED bool op_commutes(int op)
{
    return op == FORMULA_ADD || op == FORMULA_MUL || op == FORMULA_MIN || op == FORMULA_MAX ||
           op == FORMULA_HYPOT;
}

/* Holds a tape to all that tape.h says of one. */
static UNUSED void tape_check(const sgt_tape *t)
{
    int of[FORMULA_REGISTERS] = {FORMULA_OF_X, FORMULA_OF_Y, FORMULA_OF_Z}, last = t->steps - 1, used = 3;
    bool written[FORMULA_REGISTERS] = {true, true, true}, read[FORMULA_REGISTERS] = {0};
    REQUIRE(t->steps >= 1 && t->registers >= 4 && t->registers <= FORMULA_REGISTERS, "%d steps, %d registers",
            t->steps, t->registers);
    for (int i = 0; i < t->uniforms; i++) {
        const formula_uniform *u = t->uniform + i;
        bool leaf = u->op >= FORMULA_NUMBER;
        REQUIRE(u->op <= FORMULA_PARAMETER && u->op != FORMULA_COPY, "uniform %d: operation %d", i, u->op);
        REQUIRE(leaf || u->a < i, "uniform %d is made of a later one, %d", i, u->a);
        REQUIRE(u->op > FORMULA_REAL_POWER || u->b < i, "uniform %d is made of a later one, %d", i, u->b);
        REQUIRE(u->op != FORMULA_PARAMETER || (u->n >= 0 && u->n < t->parameters), "parameter %d", u->n);
    }
    for (int i = 0; i < t->steps; i++) {
        const formula_step *s = t->step + i;
        int operand[2] = {s->a, s->b}, many = s->op <= FORMULA_REAL_POWER ? 2 : 1, mask = 0, uniforms = 0;
        REQUIRE(s->op <= FORMULA_COPY && (s->op != FORMULA_COPY || t->steps == 1), "step %d: operation %d", i,
                s->op);
        REQUIRE(s->op != FORMULA_POWER || s->n >= 3 || s->n <= -1, "step %d: exponent %d", i, s->n);
        REQUIRE(s->op != FORMULA_HALF_POWER || (s->n >= 3 && s->n % 2), "step %d: exponent %d", i, s->n);
        for (int k = 0; k < many; k++) {
            int o = operand[k];
            if (o >= FORMULA_UNIFORM) {
                uniforms++;
                REQUIRE(o - FORMULA_UNIFORM < t->uniforms, "step %d: no uniform %d", i, o);
                REQUIRE(k == 1 || !op_commutes(s->op), "step %d: its uniform operand is the first", i);
            } else {
                REQUIRE(o < t->registers && written[o], "step %d reads register %d, which is not written", i,
                        o);
                REQUIRE(o != s->out, "step %d writes register %d, which it reads", i, o);
                mask |= of[o], read[o] = true;
            }
        }
        REQUIRE(s->op == FORMULA_COPY || uniforms < many, "step %d is uniform", i);
        REQUIRE(mask == s->of, "step %d is of %d and says %d", i, mask, s->of);
        REQUIRE(s->out >= 3 && s->out < t->registers, "step %d writes register %d", i, s->out);
        REQUIRE(!written[s->out] || read[s->out], "step %d overwrites register %d, which nobody read", i,
                s->out);
        of[s->out] = mask, written[s->out] = true, read[s->out] = false;
        if (s->out >= used) used = s->out + 1;
    }
    for (int i = 3; i < used; i++) REQUIRE(read[i] != (i == t->step[last].out), "register %d at the end", i);
    REQUIRE(used == t->registers, "%d registers are used, not %d", used, t->registers);
    for (int i = 0; i < t->uniforms; i++) {
        sgt_interval v = t->value[i];
        bool known = v.lo <= v.hi && v.lo > -HUGE_VAL && v.hi < HUGE_VAL;
        REQUIRE(known ? t->middle[i] >= v.lo && t->middle[i] <= v.hi : isnan(t->middle[i]),
                "uniform %d: [%a, %a], middle %a", i, v.lo, v.hi, t->middle[i]);
    }
}

#endif
