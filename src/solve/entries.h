/* entries.h - the hits of one ray as a list in order, and the evaluations that were spent on them. */
#ifndef SGT_SOLVE_ENTRIES_H
#define SGT_SOLVE_ENTRIES_H

#include "accept.h"

/* [t - t_err, t + t_err], rounded outward: where t_err is below an ulp of t, t alone would not have the
 * root. */
static inline sgt_interval sgt_about(double t, double t_err)
{
    double e = t_err * (1 + 0x1p-50) + 0x1p-52 * fabs(t);
    return (sgt_interval){t - e, t + e};
}

/* The entries of sgt_intersect_all: those beyond cap are counted and not kept, but for the last.  evals:
 * all that were spent, by the surfaces that answer by themselves. */
typedef struct sgt_list { sgt_hit *hits; int cap, count, evals; sgt_hit last; } sgt_list;

static inline void sgt_list_add(sgt_list *list, const sgt_hit *hit)
{
    if (list->count < list->cap) list->hits[list->count] = *hit;
    list->last = *hit;
    list->count++;
}

/* t and t_err of a stretch from its ends; of an endless one t is the end there is, or 0. */
static inline void sgt_list_centre(sgt_hit *hit)
{
    bool from = hit->lo > -HUGE_VAL, to = hit->hi < HUGE_VAL;
    hit->t = from && to ? 0.5 * hit->lo + 0.5 * hit->hi : from ? hit->lo : to ? hit->hi : 0;
    if (hit->t < hit->lo) hit->t = hit->lo; /* halves of subnormal numbers */
    if (hit->t > hit->hi) hit->t = hit->hi;
    hit->t_err = (hit->hi - hit->t > hit->t - hit->lo ? hit->hi - hit->t : hit->t - hit->lo) * (1 + 0x1p-50);
}

/* Two undecided stretches with little between them (where rounding decides a cell here and there) are told as
 * one.  false: these are not such. */
static inline bool sgt_list_merge(sgt_list *list, const sgt_hit *hit)
{
    sgt_hit *last = &list->last;
    if (!(list->count > 0 && last->status == hit->status)) return false;
    double gap = hit->lo - last->hi, room = 4 * ((hit->hi - hit->lo) + (last->hi - last->lo));
    if (!(gap <= room)) return false; /* nor of NaN */
    if (hit->lo < last->lo) last->lo = hit->lo;
    if (hit->hi > last->hi) last->hi = hit->hi;
    last->evals += hit->evals;
    sgt_list_centre(last);
    if (list->count <= list->cap) list->hits[list->count - 1] = *last;
    return true;
}

/* The last entry, a hit, is all that is told of [lo, hi]. */
static inline void sgt_list_cover(sgt_list *list, double lo, double hi)
{
    sgt_hit *last = &list->last;
    if (lo < last->lo) last->lo = lo;
    if (hi > last->hi) last->hi = hi;
    double far = (last->hi - last->t > last->t - last->lo ? last->hi - last->t : last->t - last->lo) *
                 (1 + 0x1p-50);
    if (far > last->t_err) last->t_err = far;
    sgt_interval about = sgt_about(last->t, last->t_err);
    if (about.lo < last->lo) last->lo = about.lo;
    if (about.hi > last->hi) last->hi = about.hi;
    if (list->count <= list->cap) list->hits[list->count - 1] = *last;
}

/* A hit as near to the last as the errors of both: one root seen twice, or two that cannot be told apart.
 * The last is made to cover both; false: it is another. */
static inline bool sgt_list_same(sgt_list *list, double t, double t_err)
{
    sgt_hit *last = &list->last;
    if (!(list->count > 0 && last->status == SGT_HIT && t - t_err <= last->t + last->t_err)) return false;
    double far = ((t > last->t ? t - last->t : last->t - t) + t_err) * (1 + 0x1p-50);
    if (far > last->t_err) last->t_err = far; /* it may be below the ulp that lo and hi can show */
    sgt_interval about = sgt_about(t, t_err);
    sgt_list_cover(list, about.lo, about.hi);
    return true;
}

SGT_INLINE sgt_hit hit_without(sgt_status status, const sgt_ray *ray, int evals)
{
    return (sgt_hit){.status = status,
                     .evals = evals,
                     .t = (double)NAN,
                     .t_err = (double)NAN,
                     .t_lo = (double)NAN,
                     .lo = ray->tmin,
                     .hi = ray->tmax,
                     .f = (double)NAN,
                     .p = {(double)NAN, (double)NAN, (double)NAN},
                     .n = {(double)NAN, (double)NAN, (double)NAN},
                     .p_err = (double)NAN};
}

/* What is undecided is in [lo, hi], cut to the ray's ends; where that leaves nothing it is all of the ray. */
SGT_INLINE sgt_hit hit_undecided(sgt_status status, const sgt_ray *ray, int evals, double lo, double hi)
{
    sgt_hit hit = hit_without(status, ray, evals);
    lo = larger(lo, ray->tmin), hi = hi < ray->tmax ? hi : ray->tmax;
    if (lo <= hi) hit.lo = lo, hit.hi = hi;
    return hit;
}

/* The evaluations spent on one ray, of these the ones told with earlier entries of a list, those up to the
 * last root (the budget is each root's own; an undecided stretch has none), and what its watcher said. */
typedef struct tally { const sgt_options *opt; int evals, before, root, budget; bool stopped; } tally;

SGT_INLINE bool spent(const tally *w) { return w->evals - w->root >= w->budget; }

/* A root is found: the next has the budget anew.  Answers made at random have roots without end, so all of
 * them together have one, too: 1024 budgets, of which the last begins here. */
SGT_INLINE void next_root(tally *w)
{
    w->root = w->evals;
    if (w->evals >= 1023LL * w->budget) w->budget = 0;
}

SGT_INLINE void tell(tally *w, sgt_move move, double t, double f, double slope, double lo, double hi)
{
    w->evals++;
    if (!w->opt->watch) return;
    sgt_step step = {.eval = w->evals, .move = move, .t = t, .f = f, .slope = slope, .lo = lo, .hi = hi};
    if (w->opt->watch(w->opt->watch_data, &step)) w->stopped = true;
}

/* The hit, with one last evaluation at p: f.  Of numbers that are out of range it is UNPROVEN. */
SGT_INLINE sgt_hit hit_at(const meeting *h, sgt_status status, double f, sgt_move move, const sgt_ray *ray,
                          tally *w)
{
    if (w->opt->watch)
        tell(w, move, h->t, f, h->n.x * ray->d.x + h->n.y * ray->d.y + h->n.z * ray->d.z, h->t - h->t_err,
             h->t + h->t_err);
    else w->evals++;
    if (w->stopped) return hit_without(SGT_STOPPED, ray, w->evals - w->before);
    if (!(h->t_err < HUGE_VAL && h->p_err < HUGE_VAL))
        return hit_without(SGT_UNPROVEN, ray, w->evals - w->before);
    sgt_interval about = sgt_about(h->t, h->t_err);
    return (sgt_hit){.status = status,
                     .evals = w->evals - w->before,
                     .t = h->t,
                     .t_err = h->t_err,
                     .t_lo = h->t_lo,
                     .lo = about.lo,
                     .hi = about.hi,
                     .f = f,
                     .p = h->p,
                     .n = h->n,
                     .p_err = h->p_err};
}

/* What a search for the first entry came to: that entry, or a miss. */
SGT_INLINE sgt_hit first_entry(const sgt_list *list, const sgt_ray *ray, int evals)
{
    if (!list->count) return hit_without(SGT_MISS, ray, evals);
    sgt_hit hit = list->last;
    if (hit.status < 0) hit.t = hit.t_err = (double)NAN;
    return hit;
}

/* [lo, hi], cut to the ray's ends, is not decided, or was not searched. */
SGT_INLINE void add_stretch(sgt_list *list, tally *w, sgt_status status, const sgt_ray *ray, double lo,
                            double hi)
{
    sgt_hit hit = hit_without(status, ray, w->evals - w->before);
    lo -= 2 * SGT_U * fabs(lo), hi += 2 * SGT_U * fabs(hi); /* outward, by at least an ulp */
    hit.lo = larger(lo, ray->tmin), hit.hi = hi < ray->tmax ? hi : ray->tmax;
    /* what is left is behind it */
    if (list->count && status != SGT_UNPROVEN) hit.lo = larger(hit.lo, list->last.hi);
    if (!(hit.lo <= DBL_MAX)) hit.lo = DBL_MAX; /* beyond the range of t: its t is a number all the same */
    if (!(hit.hi >= -DBL_MAX)) hit.hi = -DBL_MAX;
    if (hit.lo > hit.hi && status == SGT_STOPPED) hit.lo = hit.hi; /* at the very end: told all the same */
    if (hit.lo > hit.hi) return;
    sgt_list_centre(&hit);
    if (!sgt_list_merge(list, &hit)) sgt_list_add(list, &hit);
    w->before = w->evals;
}

/* hit_at as an entry of a list; what was spent since the last entry is told with it. */
SGT_INLINE void add_hit(sgt_list *list, const meeting *h, sgt_status status, double f, sgt_move move,
                        const sgt_ray *ray, tally *w)
{
    sgt_hit hit = hit_at(h, status, f, move, ray, w);
    if (w->stopped) return; /* what is left is told by whoever searches */
    if (hit.status > 0) sgt_list_add(list, &hit), w->before = w->evals;
    else add_stretch(list, w, hit.status, ray, hit.lo, hit.hi);
    next_root(w);
}

#endif
