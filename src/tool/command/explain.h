// SPDX-License-Identifier: MIT
/* explain.h - what to conclude from the evaluations of a search. */
#ifndef TOOL_EXPLAIN_H
#define TOOL_EXPLAIN_H
#include "watched.h"
#include "../job/options.h"
#include "../../truth/unguarded.h"

/* The library's own, and those to compare it with. */
typedef enum method {
    METHOD_SAFEGUARDED,
    METHOD_NEWTON,
    METHOD_NORMALISED,
    METHOD_BISECTION,
    METHOD_MARCH,
    METHODS /* how many */
} method;
static inline unguarded_method method_unguarded(method m) { return (unguarded_method)(m - METHOD_NEWTON); }

/* One line of verdict on the evaluations of a method. */
const char *explain_advice(method m, const record *r);

/* Is t the library's root of the search, to within its error and the t_tol that the method was given? */
bool explain_agrees(double t, const sgt_search *s);

/* What an answer under --dt-min does not claim. */
extern const char explain_fast[];

/* From here on the words are about a function and its roots, and not about a ray and a surface. */
void explain_a_function(void);

/* What the requested proof says of one hit, or of several: "proven to be the first". */
const char *explain_proof(const sgt_options *asked, bool near_seed, bool several);

/* Explains the library's own search and its answer.  told: why it is undecided has been said. */
void explain_safeguarded(table *t, const record *r, const sgt_search *s, bool told);

/* Prints why a ray certainly misses, if that is cheap to know; else nothing. */
void explain_miss(table *t, size_t number, sgt_surface surface, const sgt_ray *ray);

/* Explains a bare method, and compares it with the library's answer for the same ray. */
void explain_bare(table *t, method m, const record *r, const unguarded *end, const sgt_search *s);

#endif
