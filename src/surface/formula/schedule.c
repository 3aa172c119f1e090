// SPDX-License-Identifier: MIT
/* schedule.c - in which order a formula's nodes are worked out, and in which registers.
 *
 * A node is worked out after its operands.  Its result stays in a register until the last node that needs it
 * has been worked out.  Of two operands, that which needs more registers goes first: while it is worked
 * out, nothing has to be kept for the other one.  For a tree this is best (Ershov 1958; Sethi and Ullman
 * 1970, J. ACM 17, 715), and a tree of n leaves needs log2 n + 1 registers at most.  A chain such as x + (y *
 * (x + ...)) needs one, as long as it may be.  Parts that stand in a formula more than once make the tree a
 * graph, for which the best order is hard to find (Bruno and Sethi 1976, J. ACM 23, 502).  The same rule is
 * used.  Each such part keeps one register between its first use and its last.
 *
 * A register is free for the step after the last one that reads it, not for that step itself.  So a step
 * never writes what it reads.  The lowest free register is taken: those at hand stay few.
 *
 * The graph may be as deep as the text is long, so there is no recursion: a node knows which node waits for
 * it.
 *
 * Test: tests/unit/test_formula.c. */
#include "schedule.h"

enum { UNUSED = -1, NEW = 1, FIRST_MADE, SECOND_MADE };

/* How many operands a node has that are nodes, and which. */
static int operands_of(const formula_node *q, int operand[2])
{
    operand[0] = q->a, operand[1] = q->b;
    if (q->op >= FORMULA_NUMBER) return 0;
    return q->op <= FORMULA_REAL_POWER ? 2 : 1;
}

static bool is_step(const formula_node *q) { return q->of && q->op != NODE_VARIABLE; }

formula_needs sgt_schedule_needs(formula_graph *g, int result)
{
    formula_needs needs = {0, 0};
    int operand[2];
    for (int i = 0; i <= result; i++) {
        formula_node *q = g->node + i;
        q->next = UNUSED, q->state = NEW;
        if (q->of) q->place = (node_place){0, 0, 0, -1};
    }
    g->node[result].next = 0;
    if (is_step(g->node + result)) g->node[result].place.uses = 1;
    for (int i = result; i >= 0; i--) {
        formula_node *q = g->node + i;
        if (q->next == UNUSED) continue;
        for (int k = operands_of(q, operand); k-- > 0;) {
            formula_node *p = g->node + operand[k];
            p->next = 0;
            if (is_step(p)) p->place.uses++;
        }
    }
    for (int i = 0; i <= result; i++) {
        formula_node *q = g->node + i;
        if (q->next == UNUSED) continue;
        if (!q->of) q->next = needs.uniforms++;
        if (!is_step(q)) continue;
        needs.steps++;
        int many = operands_of(q, operand), need[2] = {0, 0};
        for (int k = 0; k < many; k++)
            if (g->node[operand[k]].of) need[k] = g->node[operand[k]].place.need;
        int most = need[0] > need[1] ? need[0] : need[1];
        q->place.need = most + (need[0] == need[1] && many == 2 && most > 0);
        if (q->place.need < 1) q->place.need = 1;
    }
    if (!is_step(g->node + result)) needs.steps = 1; /* a copy */
    return needs;
}

/* ----------------------------------------------------------------- writing */

/* Registers: bit i of free is register i.  live: how many results are kept now. */
typedef struct formula_registers {
    unsigned long long free;
    int live, most;
} formula_registers;

static int register_taken(formula_registers *r)
{
    int home = 3;
    if (++r->live > r->most) r->most = r->live;
    for (; home < FORMULA_REGISTERS && !(r->free >> home & 1); home++) continue;
    if (home == FORMULA_REGISTERS) return 0; /* too many: told by `most` */
    r->free &= ~(1ULL << home);
    return home;
}

static void register_read(formula_registers *r, node_place *p)
{
    if (--p->uses > 0) return;
    r->live--;
    if (p->home) r->free |= 1ULL << p->home;
}

static unsigned short operand_number(const formula_node *q)
{
    if (!q->of) return (unsigned short)(FORMULA_UNIFORM + q->next);
    return (unsigned short)(q->op == NODE_VARIABLE ? q->n : q->place.home);
}

static formula_step schedule_step(formula_graph *g, formula_node *q, formula_registers *r)
{
    int operand[2], many = operands_of(q, operand);
    formula_step step = {.op = q->op, .of = q->of, .n = q->n};
    step.out = (unsigned short)(q->place.home = register_taken(r));
    step.a = operand_number(g->node + operand[0]);
    if (many == 2) step.b = operand_number(g->node + operand[1]);
    for (int k = 0; k < many; k++)
        if (is_step(g->node + operand[k])) register_read(r, &g->node[operand[k]].place);
    return step;
}

/* The operand that is made first, or second; -1: there is none to be made. */
static int operand_to_make(const formula_graph *g, const formula_node *q, bool first)
{
    int operand[2], many = operands_of(q, operand), need[2] = {0, 0};
    for (int k = 0; k < many; k++)
        if (is_step(g->node + operand[k])) need[k] = g->node[operand[k]].place.need;
    int chosen = many == 2 && (need[1] > need[0]) == first ? 1 : 0;
    if (many == 1 && !first) return -1;
    const formula_node *p = g->node + operand[chosen];
    return is_step(p) && p->state == NEW ? operand[chosen] : -1;
}

int sgt_schedule_write(formula_graph *g, int result, formula_uniform *uniform, formula_step *step)
{
    formula_registers r = {.free = ((1ULL << FORMULA_REGISTERS) - 1) & ~7ULL};
    for (int i = 0; i <= result; i++) {
        const formula_node *q = g->node + i;
        if (q->of || q->next == UNUSED) continue;
        bool leaf = q->op >= FORMULA_NUMBER;
        int second = q->op <= FORMULA_REAL_POWER ? g->node[q->b].next : 0;
        *uniform++ = (formula_uniform){.op = q->op,
                                       .n = q->n,
                                       .a = (unsigned short)(leaf ? 0 : g->node[q->a].next),
                                       .b = (unsigned short)second,
                                       .number = q->op == FORMULA_NUMBER ? q->value.lo : 0};
    }
    if (!is_step(g->node + result)) {
        *step = (formula_step){
            .op = FORMULA_COPY, .of = g->node[result].of, .out = 3, .a = operand_number(g->node + result)};
        return 4;
    }
    for (int i = result; i >= 0;) {
        formula_node *q = g->node + i;
        int operand = -1;
        while (operand < 0 && q->state < SECOND_MADE)
            operand = operand_to_make(g, q, q->state == NEW), q->state++;
        if (operand >= 0) {
            g->node[operand].place.up = i;
            i = operand;
            continue;
        }
        *step++ = schedule_step(g, q, &r);
        i = q->place.up;
    }
    return 3 + r.most;
}
