// SPDX-License-Identifier: MIT
/* answer.c - the answers about a surface that is met by its operations, with a proof or without.
 *
 * First a closed form is asked, where one is offered and no proof is wanted.  Then cells_batch.c is asked,
 * and by_slope.c under a proof, where they are offered.  What they leave:
 *
 *     proof          `enclose`  answer
 *     none           any        what general.c finds
 *     root or first  yes        if one root is wanted that need not be the first: general.c estimates it
 *                               with at most QUICK evaluations, and proof.c proves it.  If that fails, or
 *                               the first or all are wanted: proof.c searches the whole ray
 *     root or first  no         a ray that misses the span is a proven miss; nothing else can be proven.
 *                               Else it is the estimate, made UNPROVEN */
#include "answer.h"

#include "../solve/root.h"
#include "../solve/ways.h"
#include "cells_batch.h"
#include "proof.h"
#include "unique.h"
#include "vicinity.h"

/* The evaluations of an estimate that is to be proven. */
enum { QUICK = 24 };

/* The estimate of a surface without `enclose`: what is not proven is made UNPROVEN. */
static sgt_hit doubted(sgt_hit hit, const sgt_ray *ray)
{
    if (hit.status <= 0 && hit.status != SGT_EXHAUSTED) return hit;
    return hit_undecided(SGT_UNPROVEN, ray, hit.evals, hit.lo, hit.hi);
}

static sgt_options plain(const sgt_options *opt)
{
    sgt_options estimate = *opt;
    estimate.proof = SGT_ESTIMATE;
    return estimate;
}

/* Estimates a root with a few evaluations and proves it.  true: *hit is the proven root, or the watcher
 * has stopped. */
static bool prove_estimate(proof *w, sgt_hit *hit)
{
    sgt_options estimate = plain(w->told.opt);
    if (w->told.budget > QUICK) estimate.max_evals = QUICK;
    *hit = sgt_search_first(w->s, w->ray, &estimate);
    w->told.evals = hit->evals;
    if (hit->status <= 0) return hit->status == SGT_STOPPED;
    if (near_an_end(w->ray, hit)) return false; /* the search decides whether it is accepted */
    sgt_proof_take(w, hit->t, hit->t_lo, hit->t_err);
    if (w->told.stopped) {
        *hit = hit_without(SGT_STOPPED, w->ray, w->told.evals);
        return true;
    }
    *hit = w->list->last;
    bool proven = w->list->count > 0 && hit->status > 0;
    w->list->count = 0, w->told.before = 0, w->found = false;
    return proven;
}

sgt_hit sgt_prove_within(sgt_surface s, const sgt_ray *ray, double rim2, const sgt_options *opt)
{
    sgt_options estimate = plain(opt);
    sgt_span span;
    sgt_hit kept, hit;
    sgt_list list = {.hits = &kept, .cap = 1, .count = 0};
    bool near = opt->pick == SGT_NEAR_SEED, one = opt->proof == SGT_PROVE_ROOT;
    if (!sgt_proof_bounds(s, ray, &span)) return hit_without(SGT_MISS, ray, 0);
    proof w = sgt_proof_of(s, ray, opt, &span, &list, false);
    if (rim2 < w.rim2) w.rim2 = rim2;
    if (!s.ops->enclose) {
        hit = doubted(sgt_search_first(s, ray, &estimate), ray);
        if (hit.status == SGT_MISS) hit.status = SGT_UNPROVEN, hit.lo = span.lo, hit.hi = span.hi;
        return hit;
    }
    if (one && (near || span.single) && prove_estimate(&w, &hit)) return hit;
    w.all = near;
    sgt_proof_search(&w);
    if (list.count > 1 && one && !w.told.stopped) list.last = w.nearest;
    hit = first_entry(&list, ray, w.told.evals);
    hit.evals = w.told.evals;
    /* stopped at the very last evaluation */
    if (w.told.stopped && hit.status != SGT_STOPPED) return hit_without(SGT_STOPPED, ray, hit.evals);
    if (list.count < 2 || (one && !w.told.stopped)) return hit;
    sgt_status open = hit.status == SGT_STOPPED ? SGT_STOPPED : SGT_UNPROVEN;
    return hit_undecided(open, ray, hit.evals, kept.lo, hit.hi);
}

/* Is the root that a quick proof proves the only one, or is there none?  Then it is added.  *spent is set to
 * the evaluations. */
static bool unique_root(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_list *list, int *spent)
{
    sgt_options first = *opt;
    sgt_hit hit;
    first.pick = SGT_FIRST, *spent = 0;
    if (!sgt_quick_proof_offered(s, &first)) return false;
    bool proven = sgt_quick_proof_only(s, ray, &first, &hit);
    *spent = hit.evals;
    if (proven && hit.status != SGT_MISS) sgt_list_add(list, &hit);
    return proven;
}

/* Is the first root proven not to exist?  Enclosures may know less of a part of the ray far out.  spent: of
 * max_evals. */
static bool is_proven_miss(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, int spent)
{
    sgt_options first = *opt;
    sgt_hit hit;
    first.pick = SGT_FIRST;
    first.max_evals = (opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS) - spent;
    return first.max_evals > 0 && sgt_quick_proof_offered(s, &first) &&
           sgt_quick_proof_one(s, ray, &first, &hit) && hit.status == SGT_MISS;
}

static void prove_all(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_list *list)
{
    sgt_span span;
    if (!sgt_proof_bounds(s, ray, &span)) return;
    int spent;
    if (unique_root(s, ray, opt, list, &spent)) return;
    proof w = sgt_proof_of(s, ray, opt, &span, list, true);
    w.told.evals = w.told.root = spent;
    if (s.ops->enclose) {
        sgt_proof_search(&w);
        if (list->count > 0 && !list->decided && is_proven_miss(s, ray, opt, w.told.evals)) list->count = 0;
        return;
    }
    sgt_options estimate = plain(opt);
    sgt_search_all(s, ray, &estimate, list);
    for (int i = 0; i < list->count && i < list->cap; i++) {
        sgt_hit *hit = &list->hits[i];
        *hit = doubted(*hit, ray);
        if (isnan(hit->t)) sgt_list_centre(hit);
    }
    list->last = doubted(list->last, ray);
    if (!list->count) sgt_proof_stretch(&w, SGT_UNPROVEN, span.lo, span.hi);
}

/* --------------------------------------------------------------- with a proof, or without */

/* f_tol is not read for a built-in surface: clear it. */
static const sgt_options *read_of(sgt_surface s, const sgt_options *opt, sgt_options *own)
{
    if (!is_catalogue(s.ops) || opt->f_tol == 0) return opt;
    *own = *opt;
    own->f_tol = 0;
    return own;
}

/* A watcher of what follows on a search by cells: evaluations are counted from there. */
typedef struct counted {
    sgt_watch *watch;
    void *data;
    int before;
} counted;

static int watch_counted(void *data, const sgt_step *step)
{
    const counted *c = data;
    sgt_step own = *step;
    own.eval += c->before;
    return c->watch(c->data, &own);
}

SGT_INLINE sgt_hit by_operations(sgt_surface s, const sgt_ray *ray, const sgt_options *opt)
{
    return opt->proof ? sgt_prove_within(s, ray, HUGE_VAL, opt) : sgt_search_first(s, ray, opt);
}

/* Cells decide it, or a proof without enclosures, or what they leave has the evaluations that they left.
 * known: NULL, or what such a proof is given in place of `answer`. */
typedef bool quick_answer(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_hit *hit);
SGT_NOINLINE static sgt_hit tried_first(sgt_surface s, const sgt_ray *ray, const sgt_options *opt,
                                        quick_answer *answer, struct memo *known)
{
    sgt_hit hit;
    if (known ? sgt_quick_proof_kept(s, ray, opt, known, &hit) : answer(s, ray, opt, &hit)) return hit;
    sgt_options rest = *opt;
    counted told = {opt->watch, opt->watch_data, hit.evals};
    if (opt->watch) rest.watch = watch_counted, rest.watch_data = &told;
    rest.max_evals = (opt->max_evals ? opt->max_evals : SGT_DEFAULT_EVALS) - hit.evals;
    if (rest.max_evals <= 0) /* 0 would be the default */
        return hit_without(opt->proof == SGT_ESTIMATE ? SGT_EXHAUSTED : SGT_UNPROVEN, ray, hit.evals);
    hit = by_operations(s, ray, &rest);
    hit.evals += told.before;
    return hit;
}

sgt_hit sgt_intersect_general(sgt_surface s, const sgt_ray *ray, const sgt_options *opt)
{
    sgt_options own;
    opt = read_of(s, opt, &own);
    if (!rim_in_range(rim2_of_surface(s))) return hit_without(SGT_UNPROVEN, ray, 0);
    sgt_hit hit;
    if (easy_offered(s, opt) && s.ops->own_->easy_one(s.self, ray, opt, &hit)) {
        WENT(WAY_CLOSED);
        return hit;
    }
    if (sgt_cells_offered(s, opt)) return tried_first(s, ray, opt, sgt_cells_first, NULL);
    if (sgt_quick_proof_offered(s, opt)) return tried_first(s, ray, opt, sgt_quick_proof_one, NULL);
    return by_operations(s, ray, opt);
}

sgt_hit sgt_prove_kept(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, struct memo *known)
{
    return tried_first(s, ray, opt, NULL, known);
}

void sgt_intersect_all_general(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_list *list)
{
    sgt_options own;
    tally none = {.opt = opt};
    opt = read_of(s, opt, &own);
    if (!rim_in_range(rim2_of_surface(s))) add_stretch(list, &none, SGT_UNPROVEN, ray, -HUGE_VAL, HUGE_VAL);
    else if (opt->proof) prove_all(s, ray, opt, list);
    else sgt_search_all(s, ray, opt, list);
    const bool open = list->count > 0 && !list->decided;
    if (open && is_catalogue(s.ops) && s.ops->own_->ahead && sgt_nothing_ahead(s, ray)) list->count = 0;
}
