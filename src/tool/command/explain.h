/* explain.h - what a person should conclude from a search that was watched. */
#ifndef TOOL_EXPLAIN_H
#define TOOL_EXPLAIN_H
#include "methods.h"
#include "../show/undecided.h"

/* What the answers of --dt-min leave open. */
extern const char explain_fast[];

/* What a proof (that was asked for) says of a hit, or of several: "proven to be the first". */
const char *explain_proof(const sgt_options *asked, bool near_seed, bool several);

/* The library's own search and its answer. */
void explain_safeguarded(table *t, const record *r, const search *s);

/* Why a ray certainly misses, where that is cheap to know: a line for people, or nothing. */
void explain_miss(table *t, size_t number, sgt_surface surface, const sgt_ray *ray);

/* A bare method, compared with the library's answer for the same ray. */
void explain_bare(table *t, method m, const record *r, const search *s);

#endif
