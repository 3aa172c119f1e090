/* explain.h - what a person should conclude from a search that was watched. */
#ifndef TOOL_EXPLAIN_H
#define TOOL_EXPLAIN_H
#include "methods.h"
#include "table.h"

/* The library's own search and its answer. */
void explain_safeguarded(table *t, const record *r, sgt_surface surface, const sgt_hit *hit);

/* Why a ray certainly misses, where that is cheap to know: a line for people, or nothing. */
void explain_miss(table *t, size_t number, sgt_surface surface, const sgt_ray *ray);

/* A bare method, compared with the library's answer for the same ray. */
void explain_bare(table *t, method m, const record *r, sgt_surface surface, const sgt_ray *ray, const sgt_hit *hit);

#endif
