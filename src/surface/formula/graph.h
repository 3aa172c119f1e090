// SPDX-License-Identifier: MIT
/* graph.h - a formula as a graph: each operation is a node, and equal operations are one node. */
#ifndef SGT_SURFACE_FORMULA_GRAPH_H
#define SGT_SURFACE_FORMULA_GRAPH_H

#include "fault.h"
#include "tape.h"

/* The operation of the nodes 0, 1, 2: x, y, z. */
enum { NODE_VARIABLE = FORMULA_PARAMETER + 1 };

/* The largest whole exponent. */
enum { FORMULA_EXPONENT = 1 << 20 };

/* How far the order of the steps has come to a node (schedule.c). */
typedef struct node_place {
    int need; /* how many registers its steps take, as a tree */
    int uses; /* of its result that are still to come */
    int home; /* its register */
    int up;   /* the node that waits for it */
} node_place;

/* Operands are earlier nodes, so the nodes are in an order in which they can be worked out. */
typedef struct formula_node {
    unsigned char op, of;
    bool constant;       /* made of numbers alone: `value` contains it */
    unsigned char state; /* while read: 1 if it is defined wherever its operands are (schedule.c: its own) */
    int a, b, n;
    int next; /* of the nodes with the same hash, or -1; for a uniform that is used later its index */
    union {
        sgt_interval value; /* of a constant; of a NUMBER both ends are it */
        node_place place;   /* of what is not uniform */
    };
} formula_node;

typedef struct formula_graph {
    formula_node *node;
    int count, most; /* nodes, and for how many there is room */
    int *bucket;     /* the first node of each hash, or -1 */
    int buckets;     /* a power of two */
    size_t column;   /* of what is read just now, for errors */
    bool full;       /* a node was left out */
    formula_fault *fault;
} formula_graph;

/* Empty but for x, y, z; most >= 3. */
void sgt_graph_begin(formula_graph *g);

/* Each returns the index of a node.  If there was a fault, or the room is full, it is any node. */
int sgt_graph_number(formula_graph *g, double number);
int sgt_graph_parameter(formula_graph *g, int n);
int sgt_graph_pi(formula_graph *g);

/* op of a, and of b if it has two operands: of FORMULA_ADD ... FORMULA_TANH all but FORMULA_POWER. */
int sgt_graph_of(formula_graph *g, formula_op op, int a, int b);

/* a^n, |n| <= FORMULA_EXPONENT. */
int sgt_graph_power(formula_graph *g, int a, int n);

/* Is it a whole number that a text may mean by n?  *n: which. */
bool sgt_graph_is_whole(const formula_graph *g, int i, int *n);

#endif
