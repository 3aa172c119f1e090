// SPDX-License-Identifier: MIT
/* contest.h - one search by each method, side by side: as a table, and drawn. */
#ifndef TOOL_CONTEST_H
#define TOOL_CONTEST_H
#include "explain.h"

enum { BARE_EVALS = 100 };

/* What a method other than the library's may read of a search. */
typedef struct contest_rules {
    double start;              /* NaN: the method's own */
    const sgt_options *solver; /* as asked for: t_tol, dt_min, max_evals (0: BARE_EVALS) */
} contest_rules;

/* How each method fared in one search.  seen[METHOD_SAFEGUARDED] is the library's, which `s` tells of. */
typedef struct contest {
    sgt_search s;
    record seen[METHODS];
    unguarded end[METHODS];
} contest;

/* Runs one of the bare methods. */
unguarded contest_bare(method m, const sgt_search *s, const contest_rules *rules, record *seen);

/* Runs all of them.  contest_drop: gives their records back. */
contest contest_run(const sgt_search *s, const record *own, const contest_rules *rules);
void contest_drop(contest *c);

/* Sums over searches; of one field, NaN: there is none. */
typedef struct tally {
    double field, worst; /* largest distance of the last t from the root */
    size_t rays, passed, searches, settled, agree, undefined, evals, most;
} tally;

/* Adds a search in which the library has met a root; others are left out.  sum: [METHODS]. */
void tally_add(tally sum[], const contest *c);

/* A row for each method of each field; sum: [fields * METHODS].  path: of a picture, or NULL; axis: what the
 * fields are there. */
void tally_show(const table_target *target, const char *title, size_t fields, const tally sum[],
                const char *path, const char *axis);

/* Draws a search as the method `shown` made it, and the errors of all.  function: of x, and not of a ray. */
void contest_draw(const char *path, const char *title, const contest *c, method shown, bool function);

/* The name of a method. */
extern const char *const method_name[METHODS];

#endif
