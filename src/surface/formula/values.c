/* values.c - a formula and its derivatives at many points, in doubles.
 *
 * GRADIENT.  Each register carries its number and its derivatives by x, y and z, forward, FORMULA_BLOCK points
 * at a time.  Backward would ask for every number of the tape again at its end, so tapes could not be
 * longer than the stack is; and most steps depend on one variable or two, for which `of` spares the others.
 *
 * MIXED SECOND DERIVATIVES.  Each register carries v, v_p, v_q and v_pq (a hyper-dual number: Fike and Alonso
 * 2011, AIAA 2011-886).  p and q are any two of the coordinates and parameters.  So one function gives the
 * second derivatives, those by the parameters, and their gradients. */
#include "formula.h"

#include "local.h"

#include <string.h>

/* -------------------------------------------------------------------------- operands */

/* A row of one number. */
static const double *filled_with(double x, formula_row row)
{
    for (int i = 0; i < FORMULA_BLOCK; i++) row[i] = x;
    return row;
}

static bool is_uniform(unsigned short operand) { return operand >= FORMULA_UNIFORM; }

static bool has_second_operand(int op) { return op <= FORMULA_REAL_POWER; }

/* Up to FORMULA_BLOCK points, those that are missing copies of the last. */
static void take_points(const double *of, size_t n, double *row)
{
    for (size_t i = 0; i < FORMULA_BLOCK; i++) row[i] = of ? of[i < n ? i : n - 1] : 0;
}

static void give(const double *row, size_t n, double *out)
{
    if (out) memcpy(out, row, n * sizeof *out);
}

/* -------------------------------------------------------------------------- gradient */

typedef struct graded { formula_row v, d[3]; } graded;

SGT_KERNEL
static void one_part(const double *restrict va, const double *restrict a, double *restrict out)
{
    LANES for (int i = 0; i < FORMULA_BLOCK; i++) out[i] = va[i] * a[i];
}

SGT_KERNEL
static void two_parts(const double *restrict va, const double *restrict a, const double *restrict vb,
                      const double *restrict b, double *restrict out)
{
    LANES for (int i = 0; i < FORMULA_BLOCK; i++) out[i] = va[i] * a[i] + vb[i] * b[i];
}

SGT_KERNEL
static void sum_of(const double *a, const double *b, double sign, double *out)
{
    LANES for (int i = 0; i < FORMULA_BLOCK; i++) out[i] = a[i] + sign * b[i];
}

/* v = a + sign b, or a b: without rows of 1, or copies.  The bits are those of two_parts, as a product by 1 is
 * exact.  true: done. */
static bool graded_quickly(formula_op op, const graded *a, const graded *b, int of_a, int of_b, graded *out)
{
    double sign = op == FORMULA_SUB ? -1.0 : 1.0;
    if (op == FORMULA_ADD || op == FORMULA_SUB) {
        for (int k = 0; k < 3; k++) {
            int in_a = of_a >> k & 1, in_b = of_b >> k & 1;
            if (in_a && in_b) sum_of(a->d[k], b->d[k], sign, out->d[k]);
            else if (in_a && out != a) memcpy(out->d[k], a->d[k], sizeof out->d[k]);
            else if (in_b && sign > 0 && out != b) memcpy(out->d[k], b->d[k], sizeof out->d[k]);
            else if (in_b && sign < 0) for (int i = 0; i < FORMULA_BLOCK; i++) out->d[k][i] = -b->d[k][i];
        }
        sum_of(a->v, b->v, sign, out->v);
        return true;
    }
    return false;
}

static void graded_step(const sgt_tape *tape, const formula_step *s, graded r[], const int of[], bool wanted)
{
    graded other, result;
    formula_row va, vb;
    bool two = has_second_operand(s->op), u_a = is_uniform(s->a), u_b = two && is_uniform(s->b);
    const graded *a = u_a ? &other : &r[s->a], *b = u_b ? &other : two ? &r[s->b] : NULL;
    int of_a = wanted && !u_a ? of[s->a] : 0, of_b = wanted && two && !u_b ? of[s->b] : 0;
    if (u_a) filled_with(tape->middle[s->a - FORMULA_UNIFORM], other.v);
    if (u_b) filled_with(tape->middle[s->b - FORMULA_UNIFORM], other.v);
    if (graded_quickly((formula_op)s->op, a, b, of_a, of_b, &r[s->out])) return;
    bool product = s->op == FORMULA_MUL, first = (of_a || of_b) && !product;
    const double *by_a = product ? b->v : va, *by_b = product ? a->v : vb;
    sgt_formula_local((formula_op)s->op, s->n, a->v, b ? b->v : NULL, first,
                      (formula_local){.v = result.v, .va = va, .vb = vb});
    for (int k = 0; k < 3; k++) {
        int in_a = of_a >> k & 1, in_b = of_b >> k & 1;
        double *out = result.d[k];
        if (in_a && in_b) two_parts(by_a, a->d[k], by_b, b->d[k], out);
        else if (in_a) one_part(by_a, a->d[k], out);
        else if (in_b) one_part(by_b, b->d[k], out);
    }
    memcpy(r[s->out].v, result.v, sizeof result.v);
    for (int k = 0; k < 3; k++)
        if ((of_a | of_b) >> k & 1) memcpy(r[s->out].d[k], result.d[k], sizeof result.d[k]);
}

void sgt_formula_values(const sgt_tape *tape, size_t n, sgt_points p, sgt_values out)
{
    graded r[FORMULA_REGISTERS];
    int of[FORMULA_REGISTERS] = {FORMULA_OF_X, FORMULA_OF_Y, FORMULA_OF_Z};
    int variables = tape->kind == SGT_FORMULA_XY ? 2 : 3;
    bool wanted = out.grad[0] != NULL;
    const graded *last = &r[tape->step[tape->steps - 1].out];
    for (int k = 0; k < variables && wanted; k++) filled_with(1, r[k].d[k]);
    for (size_t i = 0, few; i < n; i += few) {
        few = n - i < FORMULA_BLOCK ? n - i : FORMULA_BLOCK;
        for (int k = 0; k < variables; k++) take_points(p.p[k] + i, few, r[k].v);
        for (int j = 0; j < tape->steps; j++) {
            const formula_step *s = &tape->step[j];
            graded_step(tape, s, r, of, wanted);
            of[s->out] = s->of;
        }
        give(last->v, few, out.f + i);
        for (int k = 0; k < variables && wanted; k++) {
            bool in = tape->step[tape->steps - 1].of >> k & 1;
            for (size_t l = 0; l < few; l++) out.grad[k][i + l] = in ? last->d[k][l] : last->v[l] - last->v[l];
        }
    }
}

/* ------------------------------------------------------- mixed second derivatives */

typedef struct mixed { formula_row v, p, q, pq; } mixed;

static void mixed_step(formula_op op, int n, const mixed *a, const mixed *b, mixed *out)
{
    formula_row v, va, vb, vaa, vab, vbb;
    mixed m;
    sgt_formula_local(op, n, a->v, b ? b->v : NULL, true, (formula_local){v, va, vb, vaa, vab, vbb});
    for (int i = 0; i < FORMULA_BLOCK; i++) {
        double p = va[i] * a->p[i], q = va[i] * a->q[i], pq = va[i] * a->pq[i] + vaa[i] * (a->p[i] * a->q[i]);
        if (b) {
            p += vb[i] * b->p[i], q += vb[i] * b->q[i];
            pq += vb[i] * b->pq[i] + vbb[i] * (b->p[i] * b->q[i])
                + vab[i] * (a->p[i] * b->q[i] + a->q[i] * b->p[i]);
        }
        m.v[i] = v[i], m.p[i] = p, m.q[i] = q, m.pq[i] = pq;
    }
    *out = m;
}

/* A number and its derivatives by p and q. */
static void mixed_fill(double v, double p, double q, mixed *out)
{
    filled_with(v, out->v), filled_with(p, out->p), filled_with(q, out->q), filled_with(0, out->pq);
}

/* d[i]: the derivative of each uniform by the parameter j, in doubles.  All zero if there is no such parameter. */
static void uniforms_by(const sgt_tape *tape, size_t j, double d[FORMULA_UNIFORMS])
{
    for (int i = 0; i < tape->uniforms; i++) {
        const formula_uniform *u = &tape->uniform[i];
        bool leaf = u->op >= FORMULA_NUMBER, two = has_second_operand(u->op);
        double da = leaf ? 0 : d[u->a], db = two ? d[u->b] : 0;
        formula_row a, b, v, va, vb;
        d[i] = u->op == FORMULA_PARAMETER && (size_t)u->n == j;
        if (da == 0 && db == 0) continue;
        sgt_formula_local((formula_op)u->op, u->n, filled_with(tape->middle[u->a], a),
                          two ? filled_with(tape->middle[u->b], b) : NULL, true,
                          (formula_local){.v = v, .va = va, .vb = vb});
        d[i] = (da != 0 ? va[0] * da : 0) + (db != 0 ? vb[0] * db : 0);
    }
}

void sgt_formula_mixed(const sgt_tape *tape, size_t p, size_t q, size_t n, sgt_points at, formula_mixed out)
{
    mixed r[FORMULA_REGISTERS], other;
    const mixed *last = &r[tape->step[tape->steps - 1].out];
    size_t variables = tape->kind == SGT_FORMULA_XY ? 2 : 3;
    double by_p[FORMULA_UNIFORMS];
    if (p >= 3) uniforms_by(tape, p - 3, by_p);
    for (size_t i = 0, few; i < n; i += few) {
        few = n - i < FORMULA_BLOCK ? n - i : FORMULA_BLOCK;
        for (size_t k = 0; k < variables; k++) {
            mixed_fill(0, k == p, k == q, &r[k]);
            take_points(at.p[k] + i, few, r[k].v);
        }
        for (int j = 0; j < tape->steps; j++) {
            const formula_step *s = &tape->step[j];
            bool two = has_second_operand(s->op), u_a = is_uniform(s->a), u_b = two && is_uniform(s->b);
            unsigned u = (unsigned)(u_a ? s->a : s->b) - FORMULA_UNIFORM;
            if (u_a || u_b) mixed_fill(tape->middle[u], p >= 3 ? by_p[u] : 0, 0, &other);
            mixed_step((formula_op)s->op, s->n, u_a ? &other : &r[s->a], u_b ? &other : two ? &r[s->b] : NULL,
                       &r[s->out]);
        }
        give(last->v, few, out.f ? out.f + i : NULL), give(last->p, few, out.u ? out.u + i : NULL);
        give(last->q, few, out.v ? out.v + i : NULL), give(last->pq, few, out.uv ? out.uv + i : NULL);
    }
}
