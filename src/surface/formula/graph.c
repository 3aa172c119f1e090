// SPDX-License-Identifier: MIT
/* graph.c - the graph of a formula: equal parts once, and what can be simpler is.
 *
 * EQUAL PARTS.  A node is looked for among those with the same hash before it is made (Ershov 1958, Comm. ACM
 * 1, 3).  So x^2 that stands in a text twice is one node.  The operands of a sum, a product, min, max and
 * hypot are in one order: the earlier node first, but a uniform last.
 *
 * SIMPLER.  The graph is not an algebra system.  It only replaces what has the same value at every point
 * and is defined at the same points, as functions of real numbers:
 *
 *     u + 0, u - 0, u * 1, u / 1, u^1, --u         u
 *     0 - u, u * -1, u / -1                        -u
 *     u + -v, u - -v, -(u - v), -u * -v            a difference, a sum, v - u, u v
 *     -u * v, -u / v                               the minus goes outward, or into a uniform v
 *     u * c * d, u / 2                             u * (c d), u * 0.5, where these are exact
 *     u * u, u^m * u^n (m, n >= 1)                 u^2, u^(m + n)
 *     u^0                                          1; + 0 u where u may be undefined
 *     (-u)^n, |u|^n (n even), hypot(u, v)^n        u^n, u^n, (u^2 + v^2)^(n/2)
 *     u^(n/2) (n odd)                              sqrt(u)^n, for n >= 3 one operation
 *     sqrt(u^2), |u| (u >= 0), |-u|                |u|, u, |u|
 *     sqrt(u^2 + v^2)                              hypot(u, v), which has a slope that is bounded
 *     cos(-u), cosh(-u); sin(-u), tan(-u), ...     cos u, cosh u; -sin u, -tan u, ...
 *     min(u, u), max(u, u)                         u
 *
 * u - u and 0 u stay, since u may be undefined, but for constants.  sqrt(u)^2 stays: it is not defined for u
 * < 0.
 *
 * CONSTANTS, that is what is made of numbers alone, have their interval at once.  If it is a point, the
 * constant is that number exactly: 2^0.5 stays, 4^0.5 becomes 2.  If it is empty, the text asks for what is
 * not defined anywhere, such as 1/0 or sqrt(-1): that is an error.  So is one without bounds, such as
 * exp(1000), 1/sin(pi) or log(sin(1e9)).
 *
 * Test: tests/unit/test_formula.c. */
#include "graph.h"

#include <sagitta/interval.h>

#include <string.h>

/* -------------------------------------------------------------------- nodes */

static unsigned node_hash(int op, int a, int b, int n, double number)
{
    unsigned long long bits, h;
    memcpy(&bits, &number, sizeof bits);
    h = bits ^ ((unsigned long long)(unsigned)op << 58 | (unsigned long long)(unsigned)a << 29) ^ (unsigned)b;
    h = (h ^ (unsigned long long)(unsigned)n << 40) * 0x9e3779b97f4a7c15u;
    return (unsigned)(h >> 32);
}

static bool node_is_partial(int op, int n)
{
    switch (op) {
    case FORMULA_DIV:
    case FORMULA_ATAN2:
    case FORMULA_REAL_POWER:
    case FORMULA_HALF_POWER:
    case FORMULA_SQRT:
    case FORMULA_LOG:
    case FORMULA_TAN:
    case FORMULA_ASIN:
    case FORMULA_ACOS:
        return true;
    case FORMULA_POWER:
        return n < 0;
    default:
        return false;
    }
}

static bool node_has_two(int op) { return op <= FORMULA_REAL_POWER; }

/* The interval of a constant; an error if there is none. */
static sgt_interval node_constant(formula_graph *g, const formula_node *q)
{
    sgt_interval a = g->node[q->a].value, b = g->node[q->b].value;
    sgt_interval v = q->op == FORMULA_PI
                         ? sgt_interval_angle(sgt_interval_of(0), sgt_interval_of(-1))
                         : sgt_formula_uniform((formula_op)q->op, q->n, a, node_has_two(q->op) ? b : a);
    if (v.lo > v.hi)
        sgt_formula_say(sgt_formula_blame(g->fault, g->column),
                        "this is made of numbers alone, and not defined");
    else if (!isfinite(v.lo) || !isfinite(v.hi))
        sgt_formula_say(sgt_formula_blame(g->fault, g->column),
                        "this is made of numbers alone, and too large, not known or not defined");
    return v;
}

/* The node of that operation, without a look at what could be simpler. */
static int node_of(formula_graph *g, int op, int a, int b, int n, double number)
{
    int *first = g->bucket + (node_hash(op, a, b, n, number) & (unsigned)(g->buckets - 1));
    for (int i = *first; i >= 0; i = g->node[i].next) {
        const formula_node *q = g->node + i;
        if (q->op == op && q->a == a && q->b == b && q->n == n &&
            (op != FORMULA_NUMBER || q->value.lo == number))
            return i;
    }
    formula_node q = {.op = (unsigned char)op, .a = a, .b = b, .n = n, .next = *first};
    if (op < FORMULA_NUMBER) {
        const formula_node *p = g->node + a, *r = g->node + (node_has_two(op) ? b : a);
        q.of = p->of | r->of;
        q.constant = p->constant && r->constant;
        q.state = p->state && r->state && !node_is_partial(op, n);
    } else {
        q.constant = op == FORMULA_NUMBER || op == FORMULA_PI, q.state = 1;
    }
    if (op == FORMULA_NUMBER)
        q.value = sgt_interval_of(number);
    else if (q.constant)
        q.value = node_constant(g, &q);
    if (q.constant && op != FORMULA_NUMBER && q.value.lo == q.value.hi)
        return sgt_graph_number(g, q.value.lo);
    if (g->fault->found) return 0;
    if (g->count == g->most) return g->full = true, 0;
    g->node[g->count] = q;
    return *first = g->count++;
}

void sgt_graph_begin(formula_graph *g)
{
    for (int i = 0; i < g->buckets; i++) g->bucket[i] = -1;
    for (int i = 0; i < 3; i++)
        g->node[i] = (formula_node){
            .op = NODE_VARIABLE, .of = (unsigned char)(1 << i), .state = 1, .n = i, .next = -1};
    g->count = 3, g->full = false;
}

/* -0 is 0 here: no operation of the grammar tells them apart. */
int sgt_graph_number(formula_graph *g, double number)
{
    return node_of(g, FORMULA_NUMBER, 0, 0, 0, number == 0 ? 0 : number);
}

int sgt_graph_parameter(formula_graph *g, int n) { return node_of(g, FORMULA_PARAMETER, 0, 0, n, 0); }
int sgt_graph_pi(formula_graph *g) { return node_of(g, FORMULA_PI, 0, 0, 0, 0); }

static int node_one(formula_graph *g, formula_op op, int a) { return node_of(g, (int)op, a, 0, 0, 0); }
static int node_two(formula_graph *g, formula_op op, int a, int b) { return node_of(g, (int)op, a, b, 0, 0); }

/* Where the operands may change places. */
static int node_either_way(formula_graph *g, formula_op op, int a, int b)
{
    bool uniform_a = !g->node[a].of, uniform_b = !g->node[b].of;
    bool change = uniform_a != uniform_b ? uniform_a : a > b;
    return change ? node_two(g, op, b, a) : node_two(g, op, a, b);
}

static bool node_is(const formula_graph *g, int i, int op) { return g->node[i].op == op; }

static bool node_is_number(const formula_graph *g, int i, double number)
{
    return node_is(g, i, FORMULA_NUMBER) && g->node[i].value.lo == number;
}

bool sgt_graph_is_whole(const formula_graph *g, int i, int *n)
{
    double x = g->node[i].value.lo;
    if (!node_is(g, i, FORMULA_NUMBER) || !(fabs(x) <= 1e9) || (double)(int)x != x) return false;
    *n = (int)x;
    return true;
}

/* ------------------------------------------------------- sums and products */

static int node_difference(formula_graph *g, int a, int b);

static int node_negative(formula_graph *g, int a)
{
    formula_node q = g->node[a];
    switch (q.op) {
    case FORMULA_NEG:
        return q.a;
    case FORMULA_SUB:
        return node_difference(g, q.b, q.a);
    case FORMULA_MUL:
        if (!g->node[q.b].of && q.of) return node_two(g, FORMULA_MUL, q.a, node_negative(g, q.b));
        break;
    default:
        break;
    }
    return node_one(g, FORMULA_NEG, a);
}

static int node_sum(formula_graph *g, int a, int b)
{
    if (node_is_number(g, a, 0)) return b;
    if (node_is_number(g, b, 0)) return a;
    if (node_is(g, b, FORMULA_NEG)) return node_two(g, FORMULA_SUB, a, g->node[b].a);
    if (node_is(g, a, FORMULA_NEG)) return node_two(g, FORMULA_SUB, b, g->node[a].a);
    return node_either_way(g, FORMULA_ADD, a, b);
}

static int node_difference(formula_graph *g, int a, int b)
{
    if (node_is_number(g, b, 0)) return a;
    if (node_is_number(g, a, 0)) return node_negative(g, b);
    if (a == b && g->node[a].constant) return sgt_graph_number(g, 0);
    if (node_is(g, b, FORMULA_NEG)) return node_sum(g, a, g->node[b].a);
    return node_two(g, FORMULA_SUB, a, b);
}

/* u = base^n with n >= 1. */
static int node_base(const formula_graph *g, int u, int *n)
{
    const formula_node *q = g->node + u;
    *n = q->op == FORMULA_SQUARE ? 2 : q->op == FORMULA_POWER ? q->n : 1;
    if (*n < 1) return *n = 1, u;
    return *n > 1 ? q->a : u;
}

/* The product or the quotient of two numbers, if it is a double other than 0: an operation on points is one
 * of the ends. */
static bool is_exact(sgt_interval v, double *number)
{
    *number = v.lo;
    return v.lo == v.hi && isfinite(v.lo) && v.lo != 0;
}

static int node_product(formula_graph *g, int a, int b)
{
    double number;
    int m, n;
    if (!g->node[a].of && g->node[b].of) {
        int other = a;
        a = b, b = other;
    }
    if (node_is_number(g, a, 1)) return b;
    if (node_is_number(g, b, 1)) return a;
    if (node_is_number(g, a, -1)) return node_negative(g, b);
    if (node_is_number(g, b, -1)) return node_negative(g, a);
    if (node_is(g, a, FORMULA_NEG)) {
        if (!g->node[b].of || node_is(g, b, FORMULA_NEG))
            return node_product(g, g->node[a].a, node_negative(g, b));
        return node_negative(g, node_product(g, g->node[a].a, b));
    }
    if (node_is(g, b, FORMULA_NEG) && g->node[b].of)
        return node_negative(g, node_product(g, a, g->node[b].a));
    if (a == b) return sgt_graph_power(g, a, 2);
    if (node_is(g, b, FORMULA_NUMBER) && node_is(g, a, FORMULA_MUL) &&
        node_is(g, g->node[a].b, FORMULA_NUMBER) &&
        is_exact(sgt_interval_product(g->node[b].value, g->node[g->node[a].b].value), &number))
        return node_product(g, g->node[a].a, sgt_graph_number(g, number));
    int base = node_base(g, a, &m);
    if (node_base(g, b, &n) == base && m + n <= FORMULA_EXPONENT) return sgt_graph_power(g, base, m + n);
    return node_either_way(g, FORMULA_MUL, a, b);
}

static int node_quotient(formula_graph *g, int a, int b)
{
    double number;
    if (node_is_number(g, b, 0)) {
        sgt_formula_say(sgt_formula_blame(g->fault, g->column), "a quotient by 0 is not defined");
        return 0;
    }
    if (node_is(g, b, FORMULA_NUMBER) &&
        is_exact(sgt_interval_quotient(sgt_interval_of(1), g->node[b].value), &number))
        return node_product(g, a, sgt_graph_number(g, number));
    if (node_is(g, a, FORMULA_NEG)) return node_negative(g, node_quotient(g, g->node[a].a, b));
    if (node_is(g, b, FORMULA_NEG)) return node_negative(g, node_quotient(g, a, g->node[b].a));
    return node_two(g, FORMULA_DIV, a, b);
}

/* ------------------------------------------------------------------ powers */

int sgt_graph_power(formula_graph *g, int a, int n)
{
    const formula_node q = g->node[a];
    bool even = n % 2 == 0;
    if (n == 0) {
        int one = sgt_graph_number(g, 1);
        return q.state ? one : node_sum(g, node_two(g, FORMULA_MUL, a, sgt_graph_number(g, 0)), one);
    }
    if (n == 1) return a;
    if (q.op == FORMULA_NEG) {
        int power = sgt_graph_power(g, q.a, n);
        return even ? power : node_negative(g, power);
    }
    if (even && q.op == FORMULA_ABS) return sgt_graph_power(g, q.a, n);
    if (even && q.op == FORMULA_HYPOT) {
        int first = sgt_graph_power(g, q.a, 2), second = sgt_graph_power(g, q.b, 2);
        return sgt_graph_power(g, node_sum(g, first, second), n / 2);
    }
    if (q.op == FORMULA_SQRT && !even && n >= 3) return node_of(g, FORMULA_HALF_POWER, q.a, 0, n, 0);
    return n == 2 ? node_one(g, FORMULA_SQUARE, a) : node_of(g, FORMULA_POWER, a, 0, n, 0);
}

static int node_real_power(formula_graph *g, int a, int b)
{
    int n;
    if (sgt_graph_is_whole(g, b, &n)) {
        if (n >= -FORMULA_EXPONENT && n <= FORMULA_EXPONENT) return sgt_graph_power(g, a, n);
        sgt_formula_say(sgt_formula_blame(g->fault, g->column),
                        "a whole exponent is from -1048576 to 1048576");
        return 0;
    }
    double half = 2 * g->node[b].value.lo;
    if (node_is(g, b, FORMULA_NUMBER) && fabs(half) <= 64 && (double)(int)half == half)
        return sgt_graph_power(g, sgt_graph_of(g, FORMULA_SQRT, a, 0), (int)half);
    return node_two(g, FORMULA_REAL_POWER, a, b);
}

/* --------------------------------------------------------------- functions */

static int node_root(formula_graph *g, int a)
{
    const formula_node q = g->node[a];
    if (q.op == FORMULA_SQUARE) return sgt_graph_of(g, FORMULA_ABS, q.a, 0);
    if (q.op == FORMULA_ADD && node_is(g, q.a, FORMULA_SQUARE) && node_is(g, q.b, FORMULA_SQUARE) &&
        g->node[q.b].of)
        return node_either_way(g, FORMULA_HYPOT, g->node[q.a].a, g->node[q.b].a);
    return node_one(g, FORMULA_SQRT, a);
}

static bool node_is_not_negative(const formula_graph *g, int i)
{
    const formula_node *q = g->node + i;
    switch (q->op) {
    case FORMULA_HYPOT:
    case FORMULA_REAL_POWER:
    case FORMULA_HALF_POWER:
    case FORMULA_SQUARE:
    case FORMULA_ABS:
    case FORMULA_SQRT:
    case FORMULA_EXP:
    case FORMULA_ACOS:
    case FORMULA_COSH:
        return true;
    case FORMULA_POWER:
        return q->n % 2 == 0;
    default:
        return q->constant && q->value.lo >= 0;
    }
}

int sgt_graph_of(formula_graph *g, formula_op op, int a, int b)
{
    bool negative = node_is(g, a, FORMULA_NEG);
    int inner = negative ? g->node[a].a : a;
    switch (op) {
    case FORMULA_ADD:
        return node_sum(g, a, b);
    case FORMULA_SUB:
        return node_difference(g, a, b);
    case FORMULA_MUL:
        return node_product(g, a, b);
    case FORMULA_DIV:
        return node_quotient(g, a, b);
    case FORMULA_MIN:
    case FORMULA_MAX:
        return a == b ? a : node_either_way(g, op, a, b);
    case FORMULA_HYPOT:
        if (node_is(g, b, FORMULA_NEG)) b = g->node[b].a;
        return node_either_way(g, op, inner, b);
    case FORMULA_ATAN2:
        return node_two(g, op, a, b);
    case FORMULA_REAL_POWER:
        return node_real_power(g, a, b);
    case FORMULA_SQUARE:
        return sgt_graph_power(g, a, 2);
    case FORMULA_NEG:
        return node_negative(g, a);
    case FORMULA_ABS:
        return node_is_not_negative(g, inner) ? inner : node_one(g, op, inner);
    case FORMULA_SQRT:
        return node_root(g, a);
    case FORMULA_COS:
    case FORMULA_COSH:
        return node_one(g, op, inner);
    case FORMULA_CBRT:
    case FORMULA_SIN:
    case FORMULA_TAN:
    case FORMULA_ASIN:
    case FORMULA_ATAN:
    case FORMULA_SINH:
    case FORMULA_TANH:
        return negative ? node_negative(g, node_one(g, op, inner)) : node_one(g, op, a);
    default:
        return node_one(g, op, a);
    }
}
