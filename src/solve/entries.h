// SPDX-License-Identifier: MIT
/* entries.h - the hits of one ray as a list in order of t, and the evaluations spent on them. */
#ifndef SGT_SOLVE_ENTRIES_H
#define SGT_SOLVE_ENTRIES_H

#include "accept.h"

/* [t - t_err, t + t_err], rounded outward.  If t_err is below an ulp of t, the rounded ends might not
 * enclose the root; so they are moved by an ulp. */
static inline sgt_interval sgt_about(double t, double t_err)
{
    double e = t_err * (1 + 0x1p-50) + 0x1p-52 * fabs(t);
    return (sgt_interval){t - e, t + e};
}

/* The entries of sgt_intersect_all.  Entries beyond cap are counted and not kept; `last` is always the
 * last one.  evals: all evaluations, set by surfaces that answer by themselves. */
typedef struct sgt_list { sgt_hit *hits; int cap, count, evals; sgt_hit last; } sgt_list;

static inline void sgt_list_add(sgt_list *list, const sgt_hit *hit)
{
    if (list->count < list->cap) list->hits[list->count] = *hit;
    list->last = *hit;
    list->count++;
}

/* Sets t and t_err of a stretch from its ends.  If one end is infinite, t is the other; if both are, 0. */
static inline void sgt_list_centre(sgt_hit *hit)
{
    bool from = hit->lo > -HUGE_VAL, to = hit->hi < HUGE_VAL;
    hit->t = from && to ? 0.5 * hit->lo + 0.5 * hit->hi : from ? hit->lo : to ? hit->hi : 0;
    if (hit->t < hit->lo) hit->t = hit->lo; /* halves of subnormal numbers */
    if (hit->t > hit->hi) hit->t = hit->hi;
    hit->t_err = (hit->hi - hit->t > hit->t - hit->lo ? hit->hi - hit->t : hit->t - hit->lo) * (1 + 0x1p-50);
}

/* Joins the undecided stretch *hit to the last entry, if little lies between them.  Rounding decides a
 * cell here and there, which would make many entries of one stretch.  false: not joined. */
static inline bool sgt_list_merge(sgt_list *list, const sgt_hit *hit)
{
    sgt_hit *last = &list->last;
    if (!(list->count > 0 && last->status == hit->status)) return false;
    double gap = hit->lo - last->hi, room = 4 * ((hit->hi - hit->lo) + (last->hi - last->lo));
    if (!(gap <= room)) return false; /* nor a NaN */
    if (hit->lo < last->lo) last->lo = hit->lo;
    if (hit->hi > last->hi) last->hi = hit->hi;
    last->evals += hit->evals;
    sgt_list_centre(last);
    if (list->count <= list->cap) list->hits[list->count - 1] = *last;
    return true;
}

/* Makes the last entry, a hit, cover [lo, hi]. */
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

/* Is a hit at t within the errors of both of the last one?  Then it is one root seen twice, or two that
 * cannot be told apart, and the last entry is made to cover both.  false: it is another root. */
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

/* (The initialisers name every member: for one that does not, gcc first clears the whole struct.) */
SGT_INLINE sgt_hit hit_without(sgt_status status, const sgt_ray *ray, int evals)
{
    return (sgt_hit){.status = status, .evals = evals, .t = (double)NAN, .t_err = (double)NAN,
                     .t_lo = (double)NAN, .lo = ray->tmin, .hi = ray->tmax, .f = (double)NAN,
                     .p = {(double)NAN, (double)NAN, (double)NAN},
                     .n = {(double)NAN, (double)NAN, (double)NAN}, .p_err = (double)NAN,
                     .reserved_ = {0, 0}};
}

/* A hit or a graze, with lo and hi about t.  f: F there as computed.  Of h, what a hit reports is read. */
SGT_INLINE sgt_hit hit_found(sgt_status status, int evals, double f, const meeting *h)
{
    sgt_interval about = sgt_about(h->t, h->t_err);
    return (sgt_hit){.status = status, .evals = evals, .t = h->t, .t_err = h->t_err, .t_lo = h->t_lo,
                     .lo = about.lo, .hi = about.hi, .f = f, .p = h->p, .n = h->n, .p_err = h->p_err,
                     .reserved_ = {0, 0}};
}

/* An undecided answer about [lo, hi], cut to the ray's ends.  If nothing is left of it, it is about the
 * whole ray. */
SGT_INLINE sgt_hit hit_undecided(sgt_status status, const sgt_ray *ray, int evals, double lo, double hi)
{
    sgt_hit hit = hit_without(status, ray, evals);
    lo = larger(lo, ray->tmin), hi = hi < ray->tmax ? hi : ray->tmax;
    if (lo <= hi) hit.lo = lo, hit.hi = hi;
    return hit;
}

/* evals: spent on one ray so far.  before: of these, reported with earlier entries of a list.  root: of
 * these, up to the last root (the budget is for each root anew; an undecided stretch does not renew it).
 * stopped: what the watcher said. */
typedef struct tally { const sgt_options *opt; int evals, before, root, budget; bool stopped; } tally;

SGT_INLINE bool spent(const tally *w) { return w->evals - w->root >= w->budget; }

/* A root is found: the next one has the budget anew.  Answers made at random have roots without end.  So
 * all roots together have a budget, too: 1024 times as much, the last of which begins here. */
SGT_INLINE void next_root(tally *w)
{
    w->root = w->evals;
    if (w->evals >= 1023LL * w->budget) w->budget = 0;
}

/* What a watcher is told of a point. */
SGT_INLINE sgt_step step_at(int eval, sgt_move move, double t, double f, double slope, double lo, double hi)
{
    return (sgt_step){.eval = eval, .move = move, .kind = SGT_AT_POINT, .t = t, .f = f, .slope = slope,
                      .lo = lo, .hi = hi, .f_lo = f, .f_hi = f, .slope_lo = slope, .slope_hi = slope};
}

/* One evaluation of F, at t. */
SGT_INLINE void tell(tally *w, sgt_move move, double t, double f, double slope, double lo, double hi)
{
    w->evals++;
    if (!w->opt->watch) return;
    sgt_step step = step_at(w->evals, move, t, f, slope, lo, hi);
    if (w->opt->watch(w->opt->watch_data, &step)) w->stopped = true;
}

/* An enclosure as a watcher is told it: an end that is NaN is not known; NaN if it is empty. */
SGT_INLINE void told_bounds(sgt_interval x, double *lo, double *hi)
{
    *lo = x.lo > x.hi ? (double)NAN : isnan(x.lo) || isnan(x.hi) ? -HUGE_VAL : x.lo;
    *hi = x.lo > x.hi ? (double)NAN : isnan(x.lo) || isnan(x.hi) ? HUGE_VAL : x.hi;
}

/* One evaluation of bounds on F and on its slope over [lo, hi]. */
SGT_INLINE void tell_cell(tally *w, sgt_move move, double lo, double hi, sgt_interval f, sgt_interval slope)
{
    w->evals++;
    if (!w->opt->watch) return;
    sgt_step step = step_at(w->evals, move, 0.5 * lo + 0.5 * hi, (double)NAN, (double)NAN, lo, hi);
    step.kind = SGT_OVER_CELL;
    told_bounds(f, &step.f_lo, &step.f_hi);
    told_bounds(slope, &step.slope_lo, &step.slope_hi);
    if (w->opt->watch(w->opt->watch_data, &step)) w->stopped = true;
}

/* The hit, after one more evaluation at p, which gave f.  UNPROVEN if its numbers are out of range. */
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
    return hit_found(status, w->evals - w->before, f, h);
}

/* The result of a search for the first entry: that entry, or a miss. */
SGT_INLINE sgt_hit first_entry(const sgt_list *list, const sgt_ray *ray, int evals)
{
    if (!list->count) return hit_without(SGT_MISS, ray, evals);
    sgt_hit hit = list->last;
    if (hit.status < 0) hit.t = hit.t_err = (double)NAN;
    return hit;
}

/* Adds the stretch [lo, hi], cut to the ray's ends, which is not decided or was not searched. */
SGT_INLINE void add_stretch(sgt_list *list, tally *w, sgt_status status, const sgt_ray *ray, double lo,
                            double hi)
{
    sgt_hit hit = hit_without(status, ray, w->evals - w->before);
    lo -= 2 * SGT_U * fabs(lo), hi += 2 * SGT_U * fabs(hi); /* outward, by an ulp or more */
    hit.lo = larger(lo, ray->tmin), hit.hi = hi < ray->tmax ? hi : ray->tmax;
    /* what is left lies behind the last entry */
    if (list->count && status != SGT_UNPROVEN) hit.lo = larger(hit.lo, list->last.hi);
    if (!(hit.lo <= DBL_MAX)) hit.lo = DBL_MAX; /* beyond the range of t: its t is to be a number */
    if (!(hit.hi >= -DBL_MAX)) hit.hi = -DBL_MAX;
    if (hit.lo > hit.hi && status == SGT_STOPPED) hit.lo = hit.hi; /* at the very end: reported, too */
    if (hit.lo > hit.hi) return;
    sgt_list_centre(&hit);
    if (!sgt_list_merge(list, &hit)) sgt_list_add(list, &hit);
    w->before = w->evals;
}

/* Adds hit_at to a list, with the evaluations spent since the last entry. */
SGT_INLINE void add_hit(sgt_list *list, const meeting *h, sgt_status status, double f, sgt_move move,
                        const sgt_ray *ray, tally *w)
{
    sgt_hit hit = hit_at(h, status, f, move, ray, w);
    if (w->stopped) return; /* the searcher reports what is left */
    if (hit.status > 0) sgt_list_add(list, &hit), w->before = w->evals;
    else add_stretch(list, w, hit.status, ray, hit.lo, hit.hi);
    next_root(w);
}

#endif
