/* explain.h - what to conclude from the evaluations of a search. */
#ifndef TOOL_EXPLAIN_H
#define TOOL_EXPLAIN_H
#include "methods.h"
#include "../show/undecided.h"

/* What an answer under --dt-min does not claim. */
extern const char explain_fast[];

/* What the requested proof says of one hit, or of several: "proven to be the first". */
const char *explain_proof(const sgt_options *asked, bool near_seed, bool several);

/* Explains the library's own search and its answer.  told: why it is undecided has been said. */
void explain_safeguarded(table *t, const record *r, const search *s, bool told);

/* Prints why a ray certainly misses, if that is cheap to know; else nothing. */
void explain_miss(table *t, size_t number, sgt_surface surface, const sgt_ray *ray);

/* Explains a bare method, and compares it with the library's answer for the same ray. */
void explain_bare(table *t, method m, const record *r, const search *s);

#endif
