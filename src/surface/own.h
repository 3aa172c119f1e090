/* own.h - what a built-in surface can do that a user's cannot: answer by itself, SGT_INVALID
 * included where a parameter is.  ray and opt have been checked. */
#ifndef SGT_SURFACE_OWN_H
#define SGT_SURFACE_OWN_H

#include <sagitta/sagitta.h>

/* The entries of sgt_intersect_all: those beyond cap are counted and not kept, but for the last. */
typedef struct sgt_list { sgt_hit *hits; int cap, count; sgt_hit last; } sgt_list;

static inline void sgt_list_add(sgt_list *list, const sgt_hit *hit)
{
    if (list->count < list->cap) list->hits[list->count] = *hit;
    list->last = *hit;
    list->count++;
}

/* Two undecided stretches with little between them (where rounding decides a cell here and there) are told as
 * one.  false: these are not such. */
static inline bool sgt_list_merge(sgt_list *list, const sgt_hit *hit)
{
    sgt_hit *last = &list->last;
    bool near = list->count > 0 && last->status == hit->status && hit->lo - last->hi <= 4 * ((hit->hi - hit->lo) + (last->hi - last->lo));
    if (!near) return false;
    last->hi = hit->hi;
    last->t = 0.5 * last->lo + 0.5 * last->hi;
    last->t_err = (last->hi - last->lo) * (0.5 + 0x1p-50);
    last->evals += hit->evals;
    if (list->count <= list->cap) list->hits[list->count - 1] = *last;
    return true;
}

/* A hit as near to the last as the errors of both: one root seen twice, or two that cannot be told apart.  The last
 * is made to cover both; false: it is another. */
static inline bool sgt_list_same(sgt_list *list, double t, double t_err)
{
    sgt_hit *last = &list->last;
    if (!(list->count > 0 && last->status == SGT_HIT && t - t_err <= last->t + last->t_err)) return false;
    double far = (t > last->t ? t - last->t : last->t - t) + t_err;
    if (far > last->t_err) {
        last->t_err = far * (1 + 0x1p-50);
        last->lo = last->t - last->t_err, last->hi = last->t + last->t_err;
        if (list->count <= list->cap) list->hits[list->count - 1] = *last;
    }
    return true;
}

struct sgt_own {
    sgt_hit (*meet)(const void *self, const sgt_ray *ray, const sgt_options *opt);
    /* SGT_INVALID, or zero with every entry added. */
    sgt_status (*all)(const void *self, const sgt_ray *ray, const sgt_options *opt, sgt_list *list);
};

#endif
