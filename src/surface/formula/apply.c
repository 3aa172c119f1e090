/* apply.c - one operation on intervals, and the numbers that a tape's steps share.
 *
 * The uniforms of a tape are worked out here once for all points, each from earlier ones, and as intervals:
 * so pi, 0.1 * 3 or exp(a) contain the real number that the formula means.  Evaluation at points takes the
 * middle.  It is NaN where the uniform is not defined, or not known to be finite: then F is NaN.
 *
 * Test: tests/formula/test_read.c. */
#include "tape.h"

#include <sagitta/interval.h>

sgt_interval sgt_formula_interval(formula_op op, int n, sgt_interval a, sgt_interval b)
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
    case FORMULA_COPY:
        return a;
    default:
        return sgt_interval_all();
    }
}

static sgt_interval uniform_value(const sgt_tape *tape, const formula_uniform *u)
{
    switch (u->op) {
    case FORMULA_NUMBER:
        return sgt_interval_of(u->number);
    case FORMULA_PI:
        return sgt_interval_angle(sgt_interval_of(0), sgt_interval_of(-1));
    case FORMULA_PARAMETER:
        return sgt_interval_of(tape->given[u->n]);
    default:
        return sgt_formula_interval((formula_op)u->op, u->n, tape->value[u->a], tape->value[u->b]);
    }
}

bool sgt_formula_set(sgt_tape *tape, const double values[])
{
    for (int i = 0; i < tape->parameters; i++)
        if (!isfinite(values[i])) return false;
    for (int i = 0; i < tape->parameters; i++) tape->given[i] = values[i];
    for (int i = 0; i < tape->uniforms; i++) {
        sgt_interval value = tape->value[i] = uniform_value(tape, tape->uniform + i);
        bool known = isfinite(value.lo) && isfinite(value.hi);
        tape->middle[i] = known ? sgt_interval_middle(value) : (double)NAN;
    }
    return true;
}
