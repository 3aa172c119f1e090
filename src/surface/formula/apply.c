/* apply.c - the numbers that a tape's steps share.
 *
 * The uniforms of a tape are worked out here once for all points, each from earlier ones, and as intervals:
 * so pi, 0.1 * 3 or exp(a) contain the real number that the formula means.  Evaluation at points takes the
 * middle.  It is NaN where the uniform is not defined, or not known to be finite: then F is NaN.
 *
 * Test: tests/formula/test_read.c. */
#include "tape.h"

#include <sagitta/interval.h>

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
