// SPDX-License-Identifier: MIT
/* polar.c - r^n cos(n atan2(y, x)) and r^n sin(n atan2(y, x)) as polynomials.
 *
 * Lenses have terms like a r^4 cos(3 atan2(y, x)).  Worked out as it is written, that has no slope at the
 * vertex: r has a kink there, and the angle is not even defined.  But every chief ray meets the vertex.  With
 * theta = atan2(y, x),
 *
 *     r^n cos(n theta) = Re (x + i y)^n,   r^n sin(n theta) = Im (x + i y)^n,
 *
 * polynomials without any such point.  And r^2 is x^2 + y^2.
 *
 * So a product is kept as rest * r^power * waves while its factors are read.  Factors come in any order, and
 * powers of r add up.  The product is made into nodes where it is needed as one number: as a term of a sum,
 * as an argument, as a divisor.  Each wave then takes r^n from the power, if so much is left, those of few
 * periods first.  What is left is (x^2 + y^2)^(m/2) for an even m, and hypot(x, y)^m for an odd one.  A
 * wave without enough r stays as it was written.  Divisors take nothing from the power: r^4 / r is not r^3 at
 * r = 0.
 *
 * (x + i y)^n is made by squares: with c + i s = (x + i y)^(n/2), the square is (c^2 - s^2) + i (2 c s), and
 * for an odd n one product with x + i y follows.  Cosine and sine of the same n share them.  x^3 - 3 x y^2 is
 * made as x (x^2 - 3 y^2), which has fewer operations and tighter intervals.
 *
 * Test: tests/unit/test_formula.c. */
#include "polar.h"

#include <sagitta/interval.h>

static const polar_value POLAR_ONE = {.rest = -1, .power = 0, .first = -1, .last = -1};

/* n, if the node is n atan2(y, x) with 1 <= |n| <= POLAR_PERIODS; else 0. */
static int polar_periods(const formula_graph *g, int node)
{
    int sign = 1, n = 1;
    if (g->node[node].op == FORMULA_NEG) sign = -1, node = g->node[node].a;
    if (g->node[node].op == FORMULA_MUL) {
        if (!sgt_graph_is_whole(g, g->node[node].b, &n)) return 0;
        node = g->node[node].a;
    }
    const formula_node *q = g->node + node;
    if (q->op != FORMULA_ATAN2 || q->a != 1 || q->b != 0) return 0;
    return n >= -POLAR_PERIODS && n <= POLAR_PERIODS ? sign * n : 0;
}

/* m, if the node is r^m, m >= 1; else 0. */
static int polar_radial(const formula_graph *g, int node)
{
    int times = 1;
    const formula_node *q = g->node + node;
    if (q->op == FORMULA_SQUARE)
        times = 2, q = g->node + q->a;
    else if (q->op == FORMULA_POWER && q->n > 0)
        times = q->n, q = g->node + q->a;
    if (q->op == FORMULA_HYPOT && q->a == 0 && q->b == 1) return times;
    if (q->op != FORMULA_ADD) return 0;
    const formula_node *x = g->node + q->a, *y = g->node + q->b;
    bool squares = x->op == FORMULA_SQUARE && y->op == FORMULA_SQUARE;
    return squares && x->a + y->a == 1 && times <= FORMULA_EXPONENT / 2 ? 2 * times : 0;
}

polar_value sgt_polar_of(formula_graph *g, polar_waves *w, int node)
{
    polar_value v = POLAR_ONE;
    const formula_node *q = g->node + node, *wave = q->op == FORMULA_NEG ? g->node + q->a : q;
    if ((v.power = polar_radial(g, node)) > 0) return v;
    if ((wave->op == FORMULA_COS || wave->op == FORMULA_SIN) && polar_periods(g, wave->a) &&
        w->count < w->most) {
        if (wave != q) v.rest = sgt_graph_number(g, -1);
        w->wave[w->count] = (polar_wave){.node = wave == q ? node : g->node[node].a, .count = 1, .next = -1};
        v.first = v.last = w->count++;
        return v;
    }
    return v.rest = node, v;
}

/* ------------------------------------------------------------- into nodes */

/* Re and Im of (x + i y)^n. */
static void polar_polynomial(formula_graph *g, int n, int *re, int *im)
{
    int c, s, x = 0, y = 1;
    if (n == 1) {
        *re = x, *im = y;
    } else if (n == 3) {
        int x2 = sgt_graph_power(g, x, 2), y2 = sgt_graph_power(g, y, 2), three = sgt_graph_number(g, 3);
        c = sgt_graph_of(g, FORMULA_SUB, x2, sgt_graph_of(g, FORMULA_MUL, y2, three));
        s = sgt_graph_of(g, FORMULA_SUB, sgt_graph_of(g, FORMULA_MUL, x2, three), y2);
        *re = sgt_graph_of(g, FORMULA_MUL, x, c);
        *im = sgt_graph_of(g, FORMULA_MUL, y, s);
    } else if (n % 2) {
        polar_polynomial(g, n - 1, &c, &s);
        *re = sgt_graph_of(g, FORMULA_SUB, sgt_graph_of(g, FORMULA_MUL, c, x),
                           sgt_graph_of(g, FORMULA_MUL, s, y));
        *im = sgt_graph_of(g, FORMULA_ADD, sgt_graph_of(g, FORMULA_MUL, c, y),
                           sgt_graph_of(g, FORMULA_MUL, s, x));
    } else {
        polar_polynomial(g, n / 2, &c, &s);
        *re = sgt_graph_of(g, FORMULA_SUB, sgt_graph_power(g, c, 2), sgt_graph_power(g, s, 2));
        s = sgt_graph_of(g, FORMULA_MUL, s, sgt_graph_number(g, 2));
        *im = sgt_graph_of(g, FORMULA_MUL, c, s);
    }
}

static int polar_times(formula_graph *g, int a, int b)
{
    return a < 0 ? b : sgt_graph_of(g, FORMULA_MUL, a, b);
}

/* The wave's factors, as many of them as the power suffices for as polynomials. */
static int polar_resolved(formula_graph *g, int product, const polar_wave *w, int *power)
{
    const formula_node *q = g->node + w->node;
    bool is_sine = q->op == FORMULA_SIN;
    int n = polar_periods(g, q->a), size = n < 0 ? -n : n, re, im;
    int many = *power / size < w->count ? *power / size : w->count;
    if (many > 0) {
        polar_polynomial(g, size, &re, &im);
        int factor = sgt_graph_power(g, is_sine ? im : re, many);
        if (is_sine && n < 0 && many % 2) factor = sgt_graph_of(g, FORMULA_NEG, factor, 0);
        product = polar_times(g, product, factor), *power -= many * size;
    }
    if (many < w->count) product = polar_times(g, product, sgt_graph_power(g, w->node, w->count - many));
    return product;
}

/* x^2 + y^2 or hypot(x, y), to that power. */
static int polar_powers(formula_graph *g, int power)
{
    return sgt_graph_power(g, sgt_graph_of(g, FORMULA_HYPOT, 0, 1), power);
}

int sgt_polar_node(formula_graph *g, polar_waves *w, polar_value a)
{
    int product = a.rest;
    if (g->fault->found || g->full) return 0;
    for (int n = 1; n <= POLAR_PERIODS && a.first >= 0; n++)
        for (int i = a.first; i >= 0; i = w->wave[i].next) {
            int periods = polar_periods(g, g->node[w->wave[i].node].a);
            if (periods == n || periods == -n) product = polar_resolved(g, product, w->wave + i, &a.power);
        }
    if (a.power) product = polar_times(g, product, polar_powers(g, a.power));
    return product < 0 ? sgt_graph_number(g, 1) : product;
}

/* ------------------------------------------------------------- operations */

static polar_value polar_whole(formula_graph *g, polar_waves *w, polar_value a)
{
    polar_value v = POLAR_ONE;
    v.rest = sgt_polar_node(g, w, a);
    return v;
}

polar_value sgt_polar_product(formula_graph *g, polar_waves *w, polar_value a, polar_value b)
{
    if (a.power > FORMULA_EXPONENT - b.power) a = polar_whole(g, w, a);
    a.power += b.power;
    if (b.rest >= 0) a.rest = polar_times(g, a.rest, b.rest);
    if (a.first < 0)
        a.first = b.first, a.last = b.last;
    else if (b.first >= 0)
        w->wave[a.last].next = b.first, a.last = b.last;
    return a;
}

/* The divisor goes to the rest, so that the powers of r stay at hand: r^2/u is (1/u) r^2. */
polar_value sgt_polar_quotient(formula_graph *g, polar_waves *w, polar_value a, polar_value b)
{
    int divisor = sgt_polar_node(g, w, b);
    a.rest = sgt_graph_of(g, FORMULA_DIV, a.rest < 0 ? sgt_graph_number(g, 1) : a.rest, divisor);
    return a;
}

polar_value sgt_polar_negative(formula_graph *g, polar_value a)
{
    a.rest = a.rest < 0 ? sgt_graph_number(g, -1) : sgt_graph_of(g, FORMULA_NEG, a.rest, 0);
    return a;
}

polar_value sgt_polar_power(formula_graph *g, polar_waves *w, polar_value a, polar_value b)
{
    int n, exponent = sgt_polar_node(g, w, b);
    bool apart = a.first >= 0 || a.power > 0;
    if (apart && sgt_graph_is_whole(g, exponent, &n) && n >= 1 && n <= FORMULA_EXPONENT &&
        a.power <= FORMULA_EXPONENT / n) {
        bool few = true;
        for (int i = a.first; i >= 0; i = w->wave[i].next)
            few = few && w->wave[i].count <= FORMULA_EXPONENT / n;
        if (few) {
            for (int i = a.first; i >= 0; i = w->wave[i].next) w->wave[i].count *= n;
            if (a.rest >= 0) a.rest = sgt_graph_power(g, a.rest, n);
            a.power *= n;
            return a;
        }
    }
    return sgt_polar_of(g, w, sgt_graph_of(g, FORMULA_REAL_POWER, sgt_polar_node(g, w, a), exponent));
}
