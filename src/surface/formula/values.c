// SPDX-License-Identifier: MIT
/* values.c - a formula and its derivatives at many points, in doubles.
 *
 * GRADIENT.  Each register carries its number and its derivatives by x, y and z, forward, for a row of up to
 * FORMULA_BLOCK points.  Backward would ask for every number of the tape again at its end, so tapes could not
 * be longer than the stack is; and most steps depend on one variable or two, for which `of` spares the
 * others.
 *
 * MIXED SECOND DERIVATIVES.  Each register carries v, v_p, v_q and v_pq (a hyper-dual number: Fike and Alonso
 * 2011, AIAA 2011-886).  p and q are any two of the coordinates and parameters.  So one function gives the
 * second derivatives, those by the parameters, and their gradients. */
#include "formula.h"

#include "local.h"

#include <string.h>

static bool is_uniform(unsigned short operand) { return operand >= FORMULA_UNIFORM; }

static bool has_second_operand(int op) { return op <= FORMULA_REAL_POWER; }

static double uniform_at(const sgt_tape *tape, unsigned short operand)
{
    return tape->middle[operand - FORMULA_UNIFORM];
}

static void set_row(size_t n, double x, double *row)
{
    for (size_t i = 0; i < n; i++) row[i] = x;
}

/* ------------------------------------------------------------------------ rows of numbers */

SGT_KERNEL
static void row_sum(size_t n, const double *a, const double *b, double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = a[i] + b[i];
}

SGT_KERNEL
static void row_difference(size_t n, const double *a, const double *b, double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = a[i] - b[i];
}

/* by a + plus */
SGT_KERNEL
static void row_moved(size_t n, double by, const double *a, double plus, double *out)
{
    LANES for (size_t i = 0; i < n; i++) out[i] = by * a[i] + plus;
}

/* -------------------------------------------------------------------------- gradient */

enum { PARTS = 4, NUMBERS = 1536 }; /* 12 KiB */

/* A register: n numbers and their derivatives by x, y, z, each a row. */
typedef struct graded { double *v, *d[3]; } graded;

typedef struct graded_run {
    const sgt_tape *tape;
    size_t n, lanes;
    bool wanted;                 /* the gradient */
    int of[FORMULA_REGISTERS];   /* on which of x, y, z a register depends */
    double number[NUMBERS];
} graded_run;

/* Registers need PARTS rows each.  The fewer there are, the longer their rows. */
static size_t lanes_of(const sgt_tape *tape)
{
    size_t most = NUMBERS / (PARTS * (size_t)tape->registers) / 8 * 8;
    return most < FORMULA_BLOCK ? most : FORMULA_BLOCK;
}

static graded graded_of(graded_run *w, int reg)
{
    double *row = w->number + (size_t)reg * PARTS * w->lanes;
    return (graded){row, {row + w->lanes, row + 2 * w->lanes, row + 3 * w->lanes}};
}

/* out = by a + plus. */
static void graded_moved(graded_run *w, double by, const graded *a, int of, double plus, const graded *out)
{
    for (int k = 0; k < 3; k++) {
        if (!(of >> k & 1) || (by == 1 && a->v == out->v)) continue;
        if (by == 1) memcpy(out->d[k], a->d[k], w->n * sizeof(double));
        else sgt_row_scaled(w->n, by, a->d[k], out->d[k]);
    }
    row_moved(w->n, by, a->v, plus, out->v);
}

static void graded_sum(graded_run *w, const graded *a, int of_a, const graded *b, int of_b, bool less,
                       const graded *out)
{
    for (int k = 0; k < 3; k++) {
        int in_a = of_a >> k & 1, in_b = of_b >> k & 1;
        if (in_a && in_b) (less ? row_difference : row_sum)(w->n, a->d[k], b->d[k], out->d[k]);
        else if (in_a && out->v != a->v) memcpy(out->d[k], a->d[k], w->n * sizeof(double));
        else if (in_b && less) sgt_row_scaled(w->n, -1, b->d[k], out->d[k]);
        else if (in_b && out->v != b->v) memcpy(out->d[k], b->d[k], w->n * sizeof(double));
    }
    (less ? row_difference : row_sum)(w->n, a->v, b->v, out->v);
}

/* The derivatives of the result by those of the operands.  Each row is done by itself, so that out may be a
 * or b. */
static void graded_chain(graded_run *w, const double *va, const graded *a, int of_a, const double *vb,
                         const graded *b, int of_b, const graded *out)
{
    for (int k = 0; k < 3; k++) {
        int in_a = of_a >> k & 1, in_b = of_b >> k & 1;
        if (in_a && in_b) sgt_row_products(w->n, va, a->d[k], vb, b->d[k], out->d[k]);
        else if (in_a) sgt_row_product(w->n, va, a->d[k], out->d[k]);
        else if (in_b) sgt_row_product(w->n, vb, b->d[k], out->d[k]);
    }
}

static void graded_step(graded_run *w, const formula_step *s)
{
    formula_row va, vb, uniform;
    size_t n = w->n;
    formula_op op = (formula_op)s->op;
    bool two = has_second_operand(s->op), u_a = is_uniform(s->a), u_b = two && is_uniform(s->b);
    graded given = {uniform, {NULL, NULL, NULL}}, a = u_a ? given : graded_of(w, s->a),
           b = u_b ? given : two ? graded_of(w, s->b) : (graded){NULL, {NULL, NULL, NULL}},
           out = graded_of(w, s->out);
    int of_a = w->wanted && !u_a ? w->of[s->a] : 0, of_b = w->wanted && two && !u_b ? w->of[s->b] : 0;
    double u = u_a ? uniform_at(w->tape, s->a) : u_b ? uniform_at(w->tape, s->b) : 0;
    const graded *other = u_a ? &b : &a; /* the operand that is not uniform */
    w->of[s->out] = s->of;
    switch (op) {
    case FORMULA_ADD:
    case FORMULA_SUB:
        if (u_a) graded_moved(w, op == FORMULA_SUB ? -1 : 1, other, of_b, u, &out);
        else if (u_b) graded_moved(w, 1, other, of_a, op == FORMULA_SUB ? -u : u, &out);
        else graded_sum(w, &a, of_a, &b, of_b, op == FORMULA_SUB, &out);
        return;
    case FORMULA_MUL:
        if (u_a || u_b) {
            for (int k = 0; k < 3; k++)
                if ((of_a | of_b) >> k & 1) sgt_row_scaled(n, u, other->d[k], out.d[k]);
            sgt_row_scaled(n, u, other->v, out.v);
            return;
        }
        graded_chain(w, b.v, &a, of_a, a.v, &b, of_b, &out);
        sgt_row_product(n, a.v, b.v, out.v);
        return;
    case FORMULA_SQUARE:
        row_sum(n, a.v, a.v, va);
        graded_chain(w, va, &a, of_a, NULL, NULL, 0, &out);
        sgt_row_product(n, a.v, a.v, out.v);
        return;
    default: break;
    }
    if (u_a || u_b) set_row(n, u, uniform);
    sgt_formula_local(op, s->n, n, a.v, b.v, of_a || of_b, (formula_local){.v = out.v, .va = va, .vb = vb});
    graded_chain(w, va, &a, of_a, vb, &b, of_b, &out);
}

static void graded_points(graded_run *w, sgt_points p, size_t i, int variables)
{
    for (int k = 0; k < variables; k++) {
        graded r = graded_of(w, k);
        memcpy(r.v, p.p[k] + i, w->n * sizeof *r.v);
        if (w->wanted && i == 0) set_row(w->lanes, 1, r.d[k]);
    }
}

static void values_of_steps(const sgt_tape *tape, size_t n, sgt_points p, sgt_values out)
{
    graded_run w; /* its numbers are not cleared */
    w.tape = tape, w.lanes = lanes_of(tape), w.wanted = out.grad[0] != NULL;
    w.of[0] = FORMULA_OF_X, w.of[1] = FORMULA_OF_Y, w.of[2] = FORMULA_OF_Z;
    int variables = tape->kind == SGT_FORMULA_XY ? 2 : 3;
    const formula_step *end = &tape->step[tape->steps - 1];
    if (n < w.lanes) w.lanes = n;
    graded last = graded_of(&w, end->out);
    for (size_t i = 0; i < n; i += w.n) {
        w.n = n - i < w.lanes ? n - i : w.lanes;
        graded_points(&w, p, i, variables);
        for (int j = 0; j < tape->steps; j++) graded_step(&w, &tape->step[j]);
        memcpy(out.f + i, last.v, w.n * sizeof *out.f);
        for (int k = 0; k < variables && w.wanted; k++) {
            if (end->of >> k & 1) memcpy(out.grad[k] + i, last.d[k], w.n * sizeof *out.f);
            else row_difference(w.n, last.v, last.v, out.grad[k] + i); /* 0, or NaN */
        }
    }
}

/* Not in values_of_steps, so that its numbers are not on the stack twice. */
void sgt_formula_values(const sgt_tape *tape, size_t n, sgt_points p, sgt_values out)
{
    (tape->radial ? sgt_formula_radial : values_of_steps)(tape, n, p, out);
}

/* ------------------------------------------------------- mixed second derivatives */

enum { MIXED_BLOCK = 8 };
typedef double mixed_row[MIXED_BLOCK];
typedef struct mixed { mixed_row v, p, q, pq; } mixed;

static void mixed_step(formula_op op, int n, const mixed *a, const mixed *b, mixed *out)
{
    mixed_row v, va, vb, vaa, vab, vbb;
    mixed m;
    sgt_formula_local(op, n, MIXED_BLOCK, a->v, b ? b->v : NULL, true,
                      (formula_local){v, va, vb, vaa, vab, vbb});
    for (int i = 0; i < MIXED_BLOCK; i++) {
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
    set_row(MIXED_BLOCK, v, out->v), set_row(MIXED_BLOCK, p, out->p), set_row(MIXED_BLOCK, q, out->q);
    set_row(MIXED_BLOCK, 0, out->pq);
}

/* d[i]: the derivative of each uniform by the parameter j, in doubles.  All zero if there is no such
 * parameter. */
static void uniforms_by(const sgt_tape *tape, size_t j, double d[FORMULA_UNIFORMS])
{
    for (int i = 0; i < tape->uniforms; i++) {
        const formula_uniform *u = &tape->uniform[i];
        bool leaf = u->op >= FORMULA_NUMBER, two = has_second_operand(u->op);
        double da = leaf ? 0 : d[u->a], db = two ? d[u->b] : 0;
        double v, va = 0, vb = 0;
        d[i] = u->op == FORMULA_PARAMETER && (size_t)u->n == j;
        if (da == 0 && db == 0) continue;
        sgt_formula_local((formula_op)u->op, u->n, 1, &tape->middle[u->a], two ? &tape->middle[u->b] : NULL,
                          true, (formula_local){.v = &v, .va = &va, .vb = &vb});
        d[i] = (da != 0 ? va * da : 0) + (db != 0 ? vb * db : 0);
    }
}

void sgt_formula_mixed(const sgt_tape *tape, size_t p, size_t q, size_t n, sgt_points at, formula_mixed out)
{
    mixed r[FORMULA_REGISTERS], other;
    const mixed *last = &r[tape->step[tape->steps - 1].out];
    size_t variables = tape->kind == SGT_FORMULA_XY ? 2 : 3;
    double by_p[FORMULA_UNIFORMS];
    if (p >= 3) uniforms_by(tape, p - 3, by_p);
    for (size_t i = 0, few; i < n; i += few) { /* missing points are copies of the last */
        few = n - i < MIXED_BLOCK ? n - i : MIXED_BLOCK;
        for (size_t k = 0; k < variables; k++) {
            mixed_fill(0, k == p, k == q, &r[k]);
            for (size_t l = 0; l < MIXED_BLOCK; l++) r[k].v[l] = at.p[k][i + (l < few ? l : few - 1)];
        }
        for (int j = 0; j < tape->steps; j++) {
            const formula_step *s = &tape->step[j];
            bool two = has_second_operand(s->op), u_a = is_uniform(s->a), u_b = two && is_uniform(s->b);
            unsigned u = (unsigned)(u_a ? s->a : s->b) - FORMULA_UNIFORM;
            if (u_a || u_b) mixed_fill(tape->middle[u], p >= 3 ? by_p[u] : 0, 0, &other);
            mixed_step((formula_op)s->op, s->n, u_a ? &other : &r[s->a], u_b ? &other : two ? &r[s->b] : NULL,
                       &r[s->out]);
        }
        if (out.f) memcpy(out.f + i, last->v, few * sizeof(double));
        if (out.u) memcpy(out.u + i, last->p, few * sizeof(double));
        if (out.v) memcpy(out.v + i, last->q, few * sizeof(double));
        if (out.uv) memcpy(out.uv + i, last->pq, few * sizeof(double));
    }
}
