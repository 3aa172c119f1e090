// SPDX-License-Identifier: MIT
/* root.h - what other files may ask of the solver (root.c) beyond sagitta.h. */
#ifndef SGT_SOLVE_ROOT_H
#define SGT_SOLVE_ROOT_H
#include "../num/room.h"
#include "step.h"

enum { SGT_DEFAULT_EVALS = 2000 };

/* ---------------------------------------------------------------------- the quick form */

/* Its stages (root.c).  QUICK_NONE: the solver goes through those of the careful search. */
enum { QUICK_NONE, QUICK_NEWTON, QUICK_LEFT, QUICK_RIGHT };

/* The quick form, from tau.  It ends with SGT_HIT, or with SGT_UNPROVEN if it has no answer.
 *
 *     last     the size of the step before
 *     first    |g| where the search began; negative: |g| at tau
 *
 * At the end r.hi is t + t_err; the look behind the root, if there was one; with f_tol, hi. */
SGT_INLINE sgt_root root_quickly(searched in, double tau, double last, double first, double t_tol,
                                 double f_tol)
{
    sgt_root r;
    r.t = tau, r.lo = in.lo, r.hi = in.hi, r.t_err = HUGE_VAL, r.evals = 0;
    r.move = SGT_SEED, r.status = SGT_UNPROVEN;
    struct sgt_root_private *p = &r.private_;
    p->quick = QUICK_NEWTON, p->probes = 0, p->done = false;
    p->step = last, p->first = first, p->least = in.least, p->own = 0;
    p->t_tol = t_tol, p->f_tol = f_tol;
    return r;
}

SGT_INLINE int root_sign_of(const sgt_root *r, double g) { return g > r->g_err ? 1 : g < -r->g_err ? -1 : 0; }

SGT_INLINE bool quick_ends(sgt_root *r, sgt_status status)
{
    r->status = status, r->private_.done = true;
    return false;
}

/* The next look beside the root. */
SGT_INLINE bool quick_probe(sgt_root *r, int stage)
{
    struct sgt_root_private *p = &r->private_;
    double c = p->candidate, left = c - p->width, right = c + p->width;
    if (stage == QUICK_LEFT && (p->probes++ == PROBES || !(left >= r->lo && right <= r->hi)))
        return quick_ends(r, SGT_UNPROVEN);
    r->t = stage == QUICK_LEFT ? left : right;
    r->move = SGT_PROBE, p->quick = stage;
    return true;
}

/* Both sides have been looked at.  |g| is greater on both than at a root; at a pole it is less. */
SGT_INLINE bool quick_signs(sgt_root *r, double g)
{
    struct sgt_root_private *p = &r->private_;
    double c = p->candidate, width = p->width, left = c - width, right = c + width;
    bool greater = fabs(p->g_lo) > fabs(p->g_last) && fabs(g) > fabs(p->g_last);
    int behind = root_sign_of(r, g), signs = greater ? p->sign_left * behind : 0;
    if (signs == 0) {
        p->width = 4 * width;
        return quick_probe(r, QUICK_LEFT);
    }
    if (signs > 0 || !(p->step_before * behind > 0)) return quick_ends(r, SGT_UNPROVEN);
    r->t = c, r->hi = right;
    r->t_err = larger(c - left, right - c);
    return quick_ends(r, SGT_HIT);
}

/* Takes g at a look beside the root. */
SGT_INLINE bool root_beside(sgt_root *r, double g)
{
    struct sgt_root_private *p = &r->private_;
    r->evals++;
    if (p->quick == QUICK_RIGHT) return quick_signs(r, g);
    p->g_lo = g, p->sign_left = root_sign_of(r, g);
    return quick_probe(r, QUICK_RIGHT);
}

/* Where the quick form searches. */
SGT_INLINE searched root_searched(const sgt_root *r) { return (searched){r->lo, r->hi, r->private_.least}; }

/* Newton's step from r->t.  If it is ready, all that rounds F has to be known: private_.own is to be set to
 * the part that r->g_err leaves out. */
SGT_INLINE newton root_newton(const sgt_root *r, double g, double slope)
{
    const struct sgt_root_private *p = &r->private_;
    return newton_of(g, slope, r->g_err, r->t, p->step, root_searched(r), p->t_tol, p->f_tol);
}

/* Takes g and g' at r->t, with the step from there: makes it, or ends, or asks to look beside the root.
 * Inline, so that the state stays in registers. */
SGT_INLINE bool root_quick_next(sgt_root *r, newton s, double g, double slope)
{
    struct sgt_root_private *p = &r->private_;
    r->evals++;
    if (p->first < 0) p->first = fabs(g);
    if (!(s.ready >= 0)) {
        if (!(s.go >= 0) || r->evals == QUICK_STEPS) return quick_ends(r, SGT_UNPROVEN);
        p->step = s.size, r->t -= s.step, r->move = SGT_NEWTON;
        return true;
    }
    if (!(fabs(g) <= p->first)) return quick_ends(r, SGT_UNPROVEN);
    if (p->f_tol > 0 && fabs(g) <= p->f_tol) {
        r->t_err = 2 * (fabs(g) + r->g_err) / fabs(slope); /* twice the first order, to cover the second */
        return quick_ends(r, r->t_err < HUGE_VAL ? SGT_HIT : SGT_UNPROVEN);
    }
    if (p->least > 0) {
        certified c = certified_of(r->t, g, r->g_err + p->own, root_searched(r));
        if (c.inside) {
            r->t_err = c.tau_err, r->hi = r->t + c.tau_err;
            return quick_ends(r, SGT_HIT);
        }
    }
    p->candidate = r->t, p->g_last = g, p->step_before = slope;
    p->width = width_of(g, slope, r->g_err, r->t, p->t_tol, root_searched(r));
    return quick_probe(r, QUICK_LEFT);
}

/* ------------------------------------------------------------------ the careful search */

/* Tells the solver of an evaluation made elsewhere: g at t, an end of a bracket that a march has found.  g
 * has a certain sign.  To be called before the first sgt_root_next.  It costs no budget. */
void sgt_root_tell(sgt_root *r, double t, double g);

/* Is every number of the options valid: not NaN, not negative, and `proof` one of its names?  What is
 * reserved for later versions has to be zero. */
static inline bool sgt_options_valid(const sgt_options *o)
{
    return !o || (o->t_tol >= 0 && o->f_tol >= 0 && o->dt_min >= 0 && o->max_evals >= 0 &&
                  (unsigned)o->proof <= SGT_PROVE_FIRST &&
                  ROOM_IS_ZERO(o));
}

/* Options with which every ray is SGT_INVALID: outputs have a member of a later version. */
static const sgt_options sgt_options_invalid = {.max_evals = -1};


#endif
