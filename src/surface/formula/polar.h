// SPDX-License-Identifier: MIT
/* polar.h - products with their powers of r and their waves kept apart, until they are needed as one. */
#ifndef SGT_SURFACE_FORMULA_POLAR_H
#define SGT_SURFACE_FORMULA_POLAR_H

#include "graph.h"

/* The most periods of a wave cos(n atan2(y, x)) or sin(n atan2(y, x)). */
enum { POLAR_PERIODS = 64 };

/* A factor node^count that is such a wave. */
typedef struct polar_wave {
    int node, count, next;
} polar_wave;

/* rest r^power times the waves from first to last.  rest: a node, or -1 for 1; first -1: no waves. */
typedef struct polar_value {
    int rest, power, first, last;
} polar_value;

/* The waves that have been read; for `most` there is room. */
typedef struct polar_waves {
    polar_wave *wave;
    int count, most;
} polar_waves;

polar_value sgt_polar_of(formula_graph *g, polar_waves *w, int node);

/* Operations on values.  A value is used once: its waves go into the result. */
polar_value sgt_polar_product(formula_graph *g, polar_waves *w, polar_value a, polar_value b);
polar_value sgt_polar_quotient(formula_graph *g, polar_waves *w, polar_value a, polar_value b);
polar_value sgt_polar_negative(formula_graph *g, polar_value a);
polar_value sgt_polar_power(formula_graph *g, polar_waves *w, polar_value a, polar_value b);

/* The node of a value: r^n cos(n atan2(y, x)) as a polynomial. */
int sgt_polar_node(formula_graph *g, polar_waves *w, polar_value a);

#endif
