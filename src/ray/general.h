// SPDX-License-Identifier: MIT
/* general.h - one ray, or a tile of rays, and a surface that is met by its operations (`value`,
 * `span`, `enclose` ...).
 *
 * Such a surface is a user's, or a built-in one without `meet` (is_catalogue in builtin.h).  The functions
 * are in intersect.c, general.c and lanes.c. */
#ifndef SGT_RAY_GENERAL_H
#define SGT_RAY_GENERAL_H
#include "../solve/accept.h"
#include "../surface/builtin.h"

/* The r^2 within which a root of a surface met by its operations is accepted; HUGE_VAL without a rim. */
SGT_INLINE double rim2_of_surface(sgt_surface s)
{
    return s.ops->own_ && s.ops->own_->rim ? rim2_of(s.ops->own_->rim(s.self)) : HUGE_VAL;
}

/* A built-in surface without `meet` checks its own parameters (`object`).  One with `meet` returns
 * SGT_INVALID itself.  The table of any surface but the former has to be whole (is_whole). */
SGT_INLINE bool parameters_valid(sgt_surface s)
{
    return is_catalogue(s.ops) ? !s.ops->own_->object(s.self).reason : is_whole(s.ops);
}

/* Is a closed form asked first?  Single rays and batches both ask this, so they agree. */
SGT_INLINE bool easy_offered(sgt_surface s, const sgt_options *opt)
{
    return s.ops && is_catalogue(s.ops) && s.ops->own_->easy && opt->proof == SGT_ESTIMATE;
}

/* Is the root so near an end that the search may not accept it?  The search has another t and t_err, and the
 * first root and the first of all are to be the same.  At the start the search drops a root that is nearer
 * than the width of the rule and twice its t_err, if t_err is at most 16 widths (proof_take in proof.c). */
SGT_INLINE bool near_an_end(const sgt_ray *ray, const sgt_hit *hit)
{
    sgt_vec3 p = hit->p, n = hit->n, d = ray->d;
    double room = END_ERRORS * (hit->t_err + SGT_U * fabs(hit->t));
    double terms = fabs(p.x * n.x) + fabs(p.y * n.y) + fabs(p.z * n.z),
           width = START_ULPS * terms / fabs(n.x * d.x + n.y * d.y + n.z * d.z) + 8 * SGT_U * fabs(hit->t);
    return fabs(hit->t - ray->tmax) <= room || !(hit->t - ray->tmin > room + 33 * width);
}

/* F and its gradient at n points. */
static inline void values_of(sgt_surface s, size_t n, sgt_points p, sgt_values out)
{
    const sgt_surface_ops *ops = s.ops;
    if (ops->values) {
        ops->values(s.self, n, p, out);
        return;
    }
    for (size_t i = 0; i < n; i++) {
        sgt_vec3 grad;
        out.f[i] = ops->value(s.self, (sgt_vec3){p.p[0][i], p.p[1][i], p.p[2][i]}, &grad);
        if (isnan(out.f[i])) grad.x = grad.y = grad.z = 0; /* a user's F may leave it then */
        out.grad[0][i] = grad.x, out.grad[1][i] = grad.y, out.grad[2][i] = grad.z;
    }
}

/* The spans of n rays.  Without `span`, `spans` is not read, as in sgt_intersect. */
static inline void spans_of(sgt_surface s, size_t n, sgt_rays rays, sgt_spans out)
{
    const sgt_surface_ops *ops = s.ops;
    if (ops->spans && ops->span) ops->spans(s.self, n, rays, out), n = 0;
    for (size_t i = 0; i < n; i++) {
        sgt_ray ray = ray_of(&rays, i);
        sgt_span span = {.lo = -HUGE_VAL, .hi = HUGE_VAL, .seed = (double)NAN};
        if (ops->span) span = ops->span(s.self, &ray);
        out.lo[i] = span.lo, out.hi[i] = span.hi, out.seed[i] = span.seed, out.single[i] = span.single;
    }
}

/* sgt_intersect, with the ray by address: its tmax is made explicit (explicit_end).  In intersect.c. */
sgt_hit sgt_intersect_copy(sgt_surface s, sgt_ray *ray, const sgt_options *opt);

/* As sgt_intersect_general and sgt_intersect_all_general of answer.h, without a proof: options.proof is not
 * read.  In general.c. */
sgt_hit sgt_search_first(sgt_surface s, const sgt_ray *ray, const sgt_options *opt);

/* The same, with what a batch keeps of parts of the surface (vicinity.h): the same bits at less cost. */
struct vicinities;
sgt_hit sgt_search_first_kept(sgt_surface s, const sgt_ray *ray, const sgt_options *opt,
                              struct vicinities *kept);

/* The same without steps 5 to 7: what they would be asked is EXHAUSTED.  kept: NULL if nothing is known. */
sgt_hit sgt_search_quickly(sgt_surface s, const sgt_ray *ray, const sgt_options *opt,
                           struct vicinities *kept);
void sgt_search_all(sgt_surface s, const sgt_ray *ray, const sgt_options *opt, sgt_list *list);

/* Answers a tile of rays as sgt_builtin_ops.lanes of builtin.h does.  Returns how many rays are left
 * SGT_HARD.  In lanes.c. */
size_t sgt_lanes_general(sgt_surface s, const sgt_tile *tile, const sgt_options *opt);

#endif
