// SPDX-License-Identifier: MIT
/* grammar.h - a text as the nodes of a graph. */
#ifndef SGT_SURFACE_FORMULA_GRAMMAR_H
#define SGT_SURFACE_FORMULA_GRAMMAR_H

#include "polar.h"
#include "scan.h"

/* What reads a text: begin with the scan before the first word, and an empty graph. */
typedef struct formula_reader {
    formula_scan scan;
    formula_graph graph;
    polar_waves waves;
    formula_fault fault;
    sgt_formula_kind kind;
    size_t names;
    const sgt_named *name;
    int depth;
} formula_reader;

/* Reads the whole text.  Returns the node of F, or of the sag; any, if there was a fault. */
int sgt_grammar_read(formula_reader *r);

/* Has a formula a meaning for that name, whatever the parameters are? */
bool sgt_grammar_reserves(const char *name, size_t length);

#endif
