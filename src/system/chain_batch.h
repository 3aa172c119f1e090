// SPDX-License-Identifier: MIT
/* chain_batch.h - the chain rule of chain.h at one element, for a tile of rays.
 *
 * chain_tile_at makes the link of each ray: what chain_at makes of one.  chain_link_of takes it out of the
 * arrays again, inside a loop over rays.  What is the same for all rays, `bends` above all, is a constant
 * where the loop is written, so that nothing is left to branch on.
 *
 * A RAY THAT WAS NOT MET at the element has NaN in its link, as a single one has.  Its point is not shown to
 * the surface: a neighbour's takes its place. */
#ifndef SGT_SYSTEM_CHAIN_BATCH_H
#define SGT_SYSTEM_CHAIN_BATCH_H
#include "chain.h"
#include "../num/lanes.h"

/* Of a tile: 64 rays at one element are below 20 KiB, with what a sweep has besides. */
enum { CHAIN_RAYS = 64 };
typedef double chain_row[CHAIN_RAYS];
typedef struct chain_vectors {
    chain_row x, y, z;
} chain_vectors;

/* Where the numbers of the links are, and what is the same for all rays.  A loop has one in a variable of
 * its own, so that nothing of it is read again for each ray. */
typedef struct chain_arrays {
    const double *x, *y, *z;
} chain_arrays;
typedef struct chain_view {
    chain_arrays p, normal, after, d;
    const double *t, *inverse, *by_S, *f, *passed, *xx, *xy, *xz, *yy, *yz, *zz;
    double r, n1, n2;
    bool own_index;
} chain_view;

typedef struct chain_tile {
    size_t n, first; /* its rays, and the first of them in the arrays of the passages */
    const sgt_element *e;
    sgt_surface s;              /* with the operations of the set */
    bool turned, bends, phased; /* the element's frame is; the gradient has a say in d'; it has a phase */
    bending by;
    chain_view view;
    sgt_points shown; /* the points, for the surface */
    _Alignas(64) chain_row inverse, by_S, f, passed, met;
    chain_row h[6], waves[4], by_waves[6]; /* W, grad W, and its derivatives times second_factor */
    chain_vectors front, place; /* where view.d and `shown` may point to */
} chain_tile;

/* What a sweep through the elements is about. */
typedef struct chain_work {
    size_t elements;
    const sgt_element *e;
    double index_before;
    const sgt_rays *rays;
    const sgt_passages *passages;
} chain_work;

/* Sets all but h, for n rays from `first` on, at element i. */
void sgt_chain_tile_at(const chain_work *work, size_t i, size_t first, size_t n, chain_tile *b);

/* Sets what the passages tell: the points, the normals, the directions and t of the view. */
void sgt_chain_tile_place(const chain_work *work, size_t i, size_t first, size_t n, chain_tile *b);

/* Sets h; NaN if the surface has none, and false. */
bool sgt_chain_tile_second(chain_tile *b);

/* Turns vectors into the frame, or out of it, in place.  Nothing is done if it is not turned. */
void sgt_chain_into(const sgt_pose *pose, size_t n, chain_vectors *a);
void sgt_chain_out_of(const sgt_pose *pose, size_t n, chain_vectors *a);

SGT_INLINE sgt_vec3 chain_get(const chain_vectors *a, size_t i)
{
    return (sgt_vec3){a->x[i], a->y[i], a->z[i]};
}

SGT_INLINE void chain_put(chain_vectors *a, size_t i, sgt_vec3 v)
{
    a->x[i] = v.x, a->y[i] = v.y, a->z[i] = v.z;
}

SGT_INLINE chain_arrays chain_arrays_of(double *const a[3], size_t first)
{
    return (chain_arrays){a[0] + first, a[1] + first, a[2] + first};
}

SGT_INLINE sgt_vec3 chain_from(chain_arrays a, size_t i) { return (sgt_vec3){a.x[i], a.y[i], a.z[i]}; }

/* The link of ray i, without a phase.  bends: that of the tile, as a constant.  h is read only if it
 * bends. */
SGT_INLINE chain_link chain_link_of(const chain_view *v, bool bends, size_t i)
{
    chain_link c;
    c.d = chain_from(v->d, i), c.p = chain_from(v->p, i), c.n = chain_from(v->normal, i);
    c.after = chain_from(v->after, i), c.t = v->t[i];
    c.inverse = v->inverse[i], c.by_S = v->by_S[i], c.f = v->f[i], c.passed = v->passed[i];
    c.r = v->r, c.n1 = v->n1, c.n2 = v->n2, c.own_index = v->own_index;
    c.bends = bends, c.phased = false, c.waves = NULL;
    if (bends) {
        c.h[0] = v->xx[i], c.h[1] = v->xy[i], c.h[2] = v->xz[i];
        c.h[3] = v->yy[i], c.h[4] = v->yz[i], c.h[5] = v->zz[i];
    }
    return c;
}

/* The same at a phase: in loops that are no vector code. */
SGT_INLINE chain_link chain_phased_link(const chain_tile *b, size_t i)
{
    chain_link c = chain_link_of(&b->view, b->bends, i);
    c.phased = true;
    if (!b->bends) {
        chain_phase(b->e, &c);
        return c;
    }
    c.waves = b->e->phase;
    c.by_waves.at = (waves_here){b->waves[0][i], {b->waves[1][i], b->waves[2][i], b->waves[3][i]}};
    for (int k = 0; k < 6; k++) c.by_waves.h[k] = b->by_waves[k][i];
    chain_waves(c.waves, &c);
    return c;
}

#endif
