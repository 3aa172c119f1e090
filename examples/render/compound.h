// SPDX-License-Identifier: MIT
/* compound.h - bodies of several objects, and bodies that are clipped. */
#ifndef RENDER_COMPOUND_H
#define RENDER_COMPOUND_H
#include "lot.h"

/* What a body answers: the first hit of it that can be told, and whether something may lie before it. */
typedef struct answer {
    sgt_status undecided;  /* of the first stretch on which it cannot be told; SGT_MISS: there is none */
    const object *object;  /* what is met; NULL: nothing is */
    event hit;
    int evals;             /* spent on all */
} answer;

/* An object by itself, without clips. */
static inline bool body_is_plain(const scene *s, const body *of)
{
    return of->clips == 0 && s->knot[of->knot].op == PART;
}

/* One for each of n beams, not more than LOT; far[i] is not looked beyond. */
void body_meet(const scene *s, const body *of, size_t n, const beam b[], const double far[], answer a[]);

#endif
