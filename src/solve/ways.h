// SPDX-License-Identifier: MIT
/* ways.h - which search a ray goes through.  In the library of tests/ways, compiled with SGT_COUNT_WAYS, each
 * way counts how often it is taken; elsewhere WENT is nothing. */
#ifndef SGT_SOLVE_WAYS_H
#define SGT_SOLVE_WAYS_H

typedef enum search_way {
    WAY_CLOSED,  /* a conic, quadric, ellipsoid: closed forms */
    WAY_ROUNDS,  /* an asphere: rounds of Newton steps */
    WAY_QUICK,   /* solve/root.h: the quick form */
    WAY_ROOT,    /* solve/root.c: Newton in a bracket */
    WAY_CELLS,   /* solve/cells.h */
    WAY_STEPS,   /* a march by steps: general.c, and level.c with dt_min */
    WAY_PARTED,  /* the torus: a first root parted from the others */
    WAY_SINGLE,  /* a ray of a batch, left to the single ray */
    WAYS
} search_way;

#ifdef SGT_COUNT_WAYS
extern long sgt_ways[WAYS];
#define WENT(way) ((void)sgt_ways[way]++)
#else
#define WENT(way) ((void)0)
#endif

#endif
