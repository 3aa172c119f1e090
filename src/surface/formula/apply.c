// SPDX-License-Identifier: MIT
/* apply.c - the numbers that a tape's steps share.
 *
 * The uniforms of a tape are worked out here once for all points, each from earlier ones, and as intervals:
 * so pi, 0.1 * 3 or exp(a) contain the real number that the formula means.  Evaluation at points takes the
 * middle.  It is NaN where the uniform is not defined, or not known to be finite: then F is NaN.
 *
 * An operation of interval.h has the values of the part of its operands where it is defined.  Of a number
 * that is only known to lie in an interval that is too little: 0/(pi - pi) is not 0.  So a uniform that may
 * be undefined is all numbers.
 *
 * Test: tests/unit/test_formula.c. */
#include "fault.h"
#include "tape.h"

#include <sagitta/interval.h>

/* Is op defined on all of a, and of b? */
static bool is_defined_on(formula_op op, int n, sgt_interval a, sgt_interval b)
{
    switch (op) {
    case FORMULA_DIV:
        return !sgt_interval_has(b, 0);
    case FORMULA_POWER:
        return n > 0 || !sgt_interval_has(a, 0);
    case FORMULA_HALF_POWER:
    case FORMULA_SQRT:
        return a.lo >= 0;
    case FORMULA_LOG:
        return a.lo > 0;
    case FORMULA_ASIN:
    case FORMULA_ACOS:
        return a.lo >= -1 && a.hi <= 1;
    case FORMULA_ATAN2:
        return !(sgt_interval_has(a, 0) && sgt_interval_has(b, 0));
    case FORMULA_REAL_POWER:
        return a.lo > 0 || (a.lo == 0 && b.lo > 0);
    default:
        return true; /* a tangent with a pole is all numbers */
    }
}

sgt_interval sgt_formula_uniform(formula_op op, int n, sgt_interval a, sgt_interval b)
{
    sgt_interval value = sgt_formula_interval_base(op, n, a, b);
    return sgt_interval_is_empty(value) || is_defined_on(op, n, a, b) ? value : sgt_interval_all();
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
        return sgt_formula_uniform((formula_op)u->op, u->n, tape->value[u->a], tape->value[u->b]);
    }
}

static bool value_refused(int parameter, sgt_error *error)
{
    formula_fault fault = {.found = false};
    formula_fault *f = sgt_formula_say(sgt_formula_blame(&fault, 0), "value ");
    sgt_formula_say(sgt_formula_say_number(f, (size_t)parameter + 1), " is not finite");
    if (error) *error = fault.error;
    return false;
}

bool sgt_formula_set(sgt_tape *tape, const double values[], sgt_error *error)
{
    for (int i = 0; i < tape->parameters; i++)
        if (!isfinite(values[i])) return value_refused(i, error);
    for (int i = 0; i < tape->parameters; i++) tape->given[i] = values[i];
    for (int i = 0; i < tape->uniforms; i++) {
        sgt_interval value = tape->value[i] = uniform_value(tape, tape->uniform + i);
        bool known = isfinite(value.lo) && isfinite(value.hi);
        tape->middle[i] = known ? sgt_interval_middle(value) : (double)NAN;
    }
    tape->c = tape->k = 0;
    if (tape->kind == SGT_FORMULA_XY) sgt_formula_vertex_base(tape, &tape->c, &tape->k);
    return true;
}
