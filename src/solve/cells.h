// SPDX-License-Identifier: MIT
/* cells.h - the march by cells: every root of g on a stretch of a ray, in order, none missed.
 *
 * The stretch is covered by cells, nearest first.  The caller says what it can prove of g over the whole of
 * a cell (classify):
 *
 *     EMPTY       no root in it
 *     MONOTONE    g is monotone in it, so it has one root at most; `settle` finds that
 *     OPEN        nothing yet: the cell is made shorter, or divided where the caller has said (cells_divide)
 *     NOISE       nothing, and shorter cells will not tell either: rounding hides the sign of g
 *
 * It ends.  Where g and g' do not both vanish, short cells are EMPTY or MONOTONE.  Where they do, a short
 * cell is NOISE, as rounding does not shrink with it.
 *
 * AN UNDECIDED STRETCH is a run of NOISE.  It ends with the next decided cell.  The signs of g at its two
 * ends then tell what it holds:
 *
 *     unlike                   a root: a change of sign is certain (SGT_HIT)
 *     like, or not certain     a graze, if |g| was within a few roundings all over it; else UNPROVEN
 *
 * If the sign at an end is not certain, it is looked for farther away, in the part next to that end that
 * is known to be without a root.  A caller may be stricter: it is handed the verdict, and both signs.
 *
 * THE LENGTH OF A CELL.  h is halved after a failure, and multiplied by a factor after a success.  The
 * factor itself grows with each success by 1.08, beyond 1.2 by 1.15, to at most 2.  With each failure it
 * is multiplied by 0.8, to between 0.7 and 1.2.  On the way toward a surface cells have to shrink, and
 * learn it; on the way from it they have to grow.  This is a flat optimum among some dozens tried on level
 * sets.  Fixed factors of 1.15 and 0.35 take 7 % more levels of the orbit on rays from outside.  A factor
 * of at most 1.2 takes twice the cells on rays that start on the surface.
 *
 * Four callers: ray/enclosed.c (a user's `enclose`), ray/proof.c (proofs), surface/asphere/classify.c and
 * surface/orbit/level.c.  Everything is inline, so that each has a march of its own, without calls by
 * pointer.
 *
 * Source: Moore 1966; Hansen and Walster 2004, chapter 9. */
#ifndef SGT_SOLVE_CELLS_H
#define SGT_SOLVE_CELLS_H

#include "accept.h"
#include "ways.h"

#include <sagitta/interval.h>

/* -------------------------------------------------------------- the length of a cell */

/* The state of a march.  tau: where it is.  hi: the end of what is searched.  h: half the next cell.
 * growth: by what factor h has lately been growing or shrinking.  side: the sign of g where the cells so far
 * end, 0 if it is not known; for callers that know it without a look. */
typedef struct course { double tau, hi, h, growth, side; } course;

SGT_INLINE double grown(double growth)
{
    growth *= growth < 1.19 ? 1.08 : 1.15;
    return growth < 2 ? growth : 2;
}

SGT_INLINE double shrunk(double growth)
{
    double less = 0.8 * growth;
    return larger(less < 1.2 ? less : 1.2, 0.7);
}

static inline void faster(course *k) { k->growth = grown(k->growth), k->h *= k->growth; }

static inline void slower(course *k) { k->growth = shrunk(k->growth), k->h *= 0.5; }

/* The next double above x.  It is rarely needed.  Inline, it would cost the march registers, and 2.4 %
 * more instructions. */
SGT_NOINLINE static double next_double(double x) { return sgt_next_above(x); }

/* A cell as laid: [tau, end] about m, or what is left of [tau, hi].  h is as computed. */
typedef struct cell_place { double m, h, end; } cell_place;

static inline cell_place lay(const course *k)
{
    double tau = k->tau, h = 2 * k->h > k->hi - tau ? 0.5 * (k->hi - tau) : k->h, m = tau + h, end = m + h;
    if (!(m > tau && end > m)) m = next_double(tau), end = next_double(m);
    return (cell_place){m, larger(m - tau, end - m), end};
}

/* ------------------------------------------------------------------------ the march */

typedef enum cells_kind {
    CELLS_EMPTY,
    CELLS_MONOTONE,
    CELLS_OPEN,
    CELLS_NOISE,
    CELLS_LATER, /* settle has the answer, but nothing is decided that would end an undecided stretch */
    CELLS_AGAIN  /* none of these: classify knows more now, or has moved the march, or the search is over */
} cells_kind;

/* An undecided stretch.  before, after: the certain signs of g at its ends, or 0.  touches: |g| is within a
 * few roundings all over it. */
typedef struct undecided { bool any, touches; double lo, hi; int before, after; } undecided;

typedef struct cells {
    course k;
    cell_place at;        /* the cell at hand */
    undecided dark;
    double back;     /* no root in [back, k.tau] */
    bool touches;    /* set by classify with NOISE: |g| is within a few roundings all over the cell */
    /* For a caller that divides cells, and takes each piece whole: the pieces behind the one at hand, the
     * nearest last. */
    sgt_interval *rest;
    int count;
    double done;     /* no root is left before it */
    double leap;     /* by what h grows after NOISE: 1, or more if all the ray may lie in the surface */
    /* undecided cells with less than `gap` times their length between them are one stretch */
    double gap;
} cells;

/* What the march asks of its caller; self is the caller's. */
typedef struct cells_ops {
    bool (*over)(void *self);                         /* ask no more */
    cells_kind (*classify)(void *self, cells *c);     /* the cell c->at */
    cells_kind (*settle)(void *self, cells *c);       /* EMPTY: it has no root.  MONOTONE: that is added */
    /* the certain sign of g at tau, or 0; NULL: not asked */
    int (*sign)(void *self, cells *c, double tau);
    bool (*tell)(void *self, cells *c, sgt_status s); /* adds c->dark as an entry.  false: over before */
} cells_ops;

/* The piece pushed last is searched first. */
SGT_INLINE void cells_push(cells *c, double lo, double hi)
{
    if (lo <= hi) c->rest[c->count++] = (sgt_interval){lo, hi};
}

/* OPEN, and no root lies between m and past: the rest of the cell is two pieces. */
SGT_INLINE void cells_divide(cells *c, double m, double past)
{
    double lo = c->k.tau, hi = c->k.hi;
    cells_push(c, larger(past, lo), hi);
    cells_push(c, lo, m < hi ? m : hi);
    c->k.tau = hi;
}

SGT_INLINE bool cells_next(cells *c)
{
    while (c->count > 0) {
        sgt_interval x = c->rest[--c->count];
        c->k.tau = larger(x.lo, c->done), c->k.hi = x.hi;
        if (c->k.tau <= c->k.hi) return true;
    }
    return false;
}

/* Up to here all is decided and told, if the search is over before its end. */
SGT_INLINE double cells_reached(const cells *c) { return c->dark.any ? c->dark.lo : c->k.tau; }

/* The certain sign at tau; else farther into `free`, a length without a root.  0: none is certain. */
SGT_INLINE int cells_sign(cells *c, void *self, cells_ops ops, double tau, double free)
{
    if (!ops.sign) return 0;
    int sign = ops.sign(self, c, tau);
    for (double part = 0x1p-10; !sign && free != 0 && part < 1 && !ops.over(self); part *= 8)
        sign = ops.sign(self, c, tau + part * free);
    return sign;
}

/* Ends the undecided stretch, or leaves it if the search is over before it can be told.  behind: what is free
 * of roots behind it. */
SGT_INLINE void cells_end_dark(cells *c, void *self, cells_ops ops, double behind)
{
    undecided *dark = &c->dark;
    dark->after = cells_sign(c, self, ops, dark->hi, behind);
    if (!dark->after && ops.sign && ops.over(self)) return;
    int signs = dark->before * dark->after;
    dark->any = !ops.tell(self, c, signs < 0 ? SGT_HIT : dark->touches ? SGT_GRAZE : SGT_UNPROVEN);
}

SGT_INLINE void cells_join_dark(cells *c, void *self, cells_ops ops)
{
    undecided *dark = &c->dark;
    double tau = c->k.tau, end = c->at.end;
    if (!(dark->any && tau - dark->hi <= c->gap * ((dark->hi - dark->lo) + (end - tau)))) {
        if (dark->any) cells_end_dark(c, self, ops, 0);
        if (dark->any) return;
        int before = cells_sign(c, self, ops, tau, c->back - tau);
        *dark = (undecided){.any = true, .touches = true, .lo = tau, .before = before};
    }
    dark->hi = end, dark->touches = dark->touches && c->touches;
}

/* Marches to the end of the stretch.  false: the caller was over before, and cells_reached tells how far it
 * came.  With a `gap` an undecided stretch at the very end is left to the caller. */
SGT_INLINE bool cells_march(cells *c, void *self, cells_ops ops)
{
    course *k = &c->k;
    WENT(WAY_CELLS);
    while (k->tau < k->hi || cells_next(c)) {
        if (ops.over(self)) return false;
        bool far = c->dark.any && c->gap > 0 && k->tau - c->dark.hi > c->gap * (c->dark.hi - c->dark.lo);
        if (far) cells_end_dark(c, self, ops, 0);
        if (far && ops.over(self)) return false;
        c->at = lay(k);
        cells_kind kind = ops.classify(self, c);
        if (c->dark.any && c->gap == 0 && (kind == CELLS_EMPTY || kind == CELLS_MONOTONE)) {
            cells_end_dark(c, self, ops, kind == CELLS_EMPTY ? c->at.end - k->tau : 0);
            if (ops.over(self)) return false;
        }
        if (kind == CELLS_MONOTONE || kind == CELLS_LATER) kind = ops.settle(self, c);
        if (kind == CELLS_AGAIN) {
            if (c->gap > 0 && ops.over(self)) return false; /* the piece may be a single point */
            continue;
        }
        k->h = c->at.h;
        if (kind == CELLS_OPEN) {
            if (k->tau < k->hi) slower(k); /* else it was divided */
            continue;
        }
        if (kind == CELLS_NOISE) cells_join_dark(c, self, ops), k->h *= c->leap;
        else faster(k);
        c->back = kind == CELLS_EMPTY ? k->tau : c->at.end;
        k->tau = c->at.end;
    }
    if (!c->dark.any) return true;
    if (ops.over(self)) return false;
    if (c->gap == 0) cells_end_dark(c, self, ops, 0);
    return c->gap > 0 || !c->dark.any;
}

#endif
