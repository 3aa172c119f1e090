// SPDX-License-Identifier: MIT
/* intersect.c - one ray meets one surface: sgt_intersect and sgt_intersect_all.  Here the arguments are
 * checked, and the surface's own `meet` or the general search is called.
 *
 * A conic answers a ray in some hundred instructions, so the way to it is short: nothing is copied, the last
 * call is a jump, and the ray is checked by `meet`, where its quick form has failed. */
#include "../solve/root.h"
#include "../surface/builtin.h"
#include "answer.h"
#include "unique.h"

/* Are the arguments valid?  The ray's tmax is explicit. */
static bool valid(sgt_surface s, const sgt_ray *ray, const sgt_options *opt)
{
    return s.ops && s.ops->value && ray_valid(ray) && sgt_options_valid(opt) && parameters_valid(s);
}

static const sgt_options defaults = {0};

/* Under a proof, running out of evaluations means UNPROVEN, not EXHAUSTED. */
static void ends_unproven(sgt_hit *hit, const sgt_options *opt)
{
    if (opt->proof != SGT_ESTIMATE && hit->status == SGT_EXHAUSTED) hit->status = SGT_UNPROVEN;
}

/* `meet` under a proof.  A function of its own, because a hit whose address is taken is copied at return,
 * which costs 8 ns. */
SGT_NOINLINE
static sgt_hit proven(sgt_surface s, const sgt_ray *ray, const sgt_options *opt)
{
    sgt_hit hit = s.ops->own_->meet(s.self, ray, opt);
    ends_unproven(&hit, opt);
    if ((hit.status > 0 || hit.status == SGT_UNPROVEN) && asks_unique(opt))
        sgt_prove_unique(s, ray, HUGE_VAL, opt, &hit);
    return hit;
}

/* Whatever does not answer itself, and what is invalid. */
SGT_NOINLINE
static sgt_hit asked_of_operations(sgt_surface s, const sgt_ray *ray, const sgt_options *opt)
{
    if (!valid(s, ray, opt)) return hit_without(SGT_INVALID, ray, 0);
    return sgt_intersect_general(s, ray, opt ? opt : &defaults);
}

sgt_hit sgt_intersect_copy(sgt_surface s, sgt_ray *ray, const sgt_options *opt)
{
    s = in_set(s);
    if (has_default_ends(ray)) ray->tmax = HUGE_VAL;
    if (!(s.ops && answers_itself(s.ops) && sgt_options_valid(opt))) return asked_of_operations(s, ray, opt);
    if (!opt) opt = &defaults;
    if (opt->proof != SGT_ESTIMATE) return proven(s, ray, opt);
    return s.ops->own_->meet(s.self, ray, opt);
}

sgt_hit sgt_intersect(sgt_surface s, sgt_ray ray, const sgt_options *opt)
{
    return sgt_intersect_copy(s, &ray, opt);
}

int sgt_intersect_all(sgt_surface s, sgt_ray ray, int cap, sgt_hit hits[], const sgt_options *opt)
{
    sgt_list list = {.hits = hits, .cap = hits ? cap : 0, .count = 0};
    s = in_set(s);
    ray.tmax = explicit_end(&ray);
    if (!valid(s, &ray, opt)) return SGT_INVALID;
    if (!opt) opt = &defaults;
    if (!answers_itself(s.ops)) sgt_intersect_all_general(s, &ray, opt, &list);
    else if (s.ops->own_->all(s.self, &ray, opt, &list) < 0) return SGT_INVALID;
    for (int i = 0; i < list.count && i < list.cap; i++) ends_unproven(&list.hits[i], opt);
    return list.count;
}
