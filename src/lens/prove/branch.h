// SPDX-License-Identifier: MIT
/* branch.h - the pupil of a field at a wavelength, by branch and bound. */
#ifndef SGT_PROVE_BRANCH_H
#define SGT_PROVE_BRANCH_H
#include "carry.h"

#include <sagitta/prove.h>

/* The largest value that a traced ray has, and the ray. */
typedef struct prove_seen { double value, x, y; } prove_seen;

typedef struct prove_asked {
    const prove_cell *cell;
    double undecided;          /* share of the area, 0 to 1, that may stay undecided */
    size_t boxes;              /* the budget */
    size_t limits;             /* 0: all bounds are wanted */
    const sgt_prove_limit *limit;
    void (*run)(void *context, size_t tasks, void (*task)(void *data, size_t i), void *data);
    void *context;
} prove_asked;

typedef struct proof {
    const prove_asked *asked;
    size_t quantities;
    size_t count, room;
    prove_box *box;            /* [count]: they make up the disc */
    double *bound;             /* [count * quantities] */
    size_t carried;            /* so many were carried through */
    bool spent;                /* the budget */
    /* what follows of all boxes */
    double *most;              /* [quantities]: no ray that passes is beyond */
    prove_seen *seen;          /* [quantities] */
    double passes, stops, undecided; /* shares of the area */
    sgt_interval f_mean, w_mean, ww_mean; /* over what passes */
} proof;

/* false: no memory.  sgt_proof_free in either case. */
bool sgt_proof_run(const prove_asked *asked, proof *out);
void sgt_proof_free(proof *p);

/* What is known of a limit. */
typedef struct proof_limit { sgt_limit_verdict verdict; double bound, seen, x, y, undecided; } proof_limit;
proof_limit sgt_proof_limit(const proof *p, const sgt_prove_limit *limit);

/* The rms of a mean square, and of one about the mean. */
sgt_interval sgt_proof_rms(sgt_interval mean_square);
sgt_interval sgt_proof_rms_about_mean(const proof *p);

#endif
