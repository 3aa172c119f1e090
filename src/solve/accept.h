// SPDX-License-Identifier: MIT
/* accept.h - which roots are accepted, and what is known of them.
 *
 * ACCEPTED is a root that passes these tests, in this order:
 *
 *     1. it is on the sheet
 *     2. it is inside the rim: r^2 <= rim2
 *     3. it is in (tmin, tmax]
 *     4. it is not the start itself: the rule of sgt_ray in sagitta.h
 *
 * The rules for rim and ends are stated in computed numbers, so they are sharp and never undecided.  There
 * are two exceptions:
 * - If a proof is asked for, a root whose side of the rim is hidden by rounding is undecided (rim_hidden).
 * - If t_err is far wider than the rule of the start (extreme numbers: terms that underflow or cancel),
 *   the root is not taken for the start.  It is undecided (ends_hide).
 *
 * THE RULE OF THE START.  A root t is not accepted if
 *
 *     t <= tmin + t_err + 2^-48 (|x Fx| + |y Fy| + |z Fz|) / |grad F . d| + 2^-50 |t|,
 *
 * with the products taken at the root.  2^-48 is START_ULPS, and 2^-50 is 8 u.  Where all products vanish (at
 * the vertex of a sag, on a coordinate plane that is the surface) underflow alone hides where the root is.
 * So one within 2^-1000 (length) of the start is the start, too: START_LEAST.  Each way to a root evaluates
 * the rule with what it has at hand:
 *
 *     function                     file                 for whom
 *     accepted                     here                 surfaces with `meet`, single rays, careful form
 *     ends_hide                    here                 the same: is it certainly not accepted?
 *     acceptance_of                step.h               surfaces met by their operations: quick form, lanes,
 *                                                       walk of a single ray; proof.c asks it, too
 *     sharpened_of                 step.h               the same, with the rounding of F at the very point
 *     proof_take, start_width      ray/proof.c          enclosures: with certain bounds on the slope
 *     root_accepted                orbit/course.h       level sets, single rays and lanes
 *     lane_of                      sag/lanes.h          quick form of conic and asphere: by a wide margin
 *
 * Quick forms of single surfaces test a part of it with a margin, and leave the rest to the functions
 * above: starts_on (conic/easy.h), wavy_away (asphere/easy.h), side_on_of (asphere/side.h), is_start
 * (sag/poly.h), quadratic_first (body/quadratic.h), parting_judge (body/torus.c).
 *
 * TMAX.  Each way to a root computes another t.  So the first root and the first of all roots might differ
 * next to tmax.  The ways that are there for speed leave a root within END_ERRORS times its t_err of tmax
 * to the way that finds every root. */
#ifndef SGT_SOLVE_ACCEPT_H
#define SGT_SOLVE_ACCEPT_H

#include "../num/local.h"

static const double SOFT_RIM = 1 + 0x1p-44; /* factor on r^2; surfaces.h says why */
static const double START_ULPS = 0x1p-48;   /* 16 ulps; sagitta.h, sgt_ray */
static const double START_LEAST = 0x1p-1000; /* length */
static const double END_ERRORS = 16;        /* t of two ways differs by less than this times t_err */
static const double TINY_ERROR = 0x1p-1060;

/* A root, with all that a hit reports of it. */
typedef struct meeting {
    double t, t_lo, t_err;   /* in the ray's own measure */
    sgt_vec3 p, n;           /* the point, and the gradient of F */
    double p_err;
    double slope;            /* |grad F . d| for the scaled d, times v; see accepted */
    double v;                /* 1 - (1 + k) c w: positive on the sheet, 0 at the equator */
    double sag;              /* the conic's s(x, y) as `value` has it; NaN: not computed */
} meeting;

/* Sets t, t_lo, t_err, p and p_err of h, for the root at t0 + t0_lo + tau.  tau is known within tau_err. */
SGT_INLINE void meeting_place(meeting *h, const local *q, double tau, double tau_err)
{
    double small = q->t0_lo + tau;
    twofold t = two_sum(q->t0, small);
    double e = tau_err + SGT_U * fabs(small) + q->t0_err;
    h->t = t.hi * q->scale;
    h->t_lo = t.lo * q->scale;
    h->t_err = (fabs(t.lo) + e * (1 + 4 * SGT_U)) * (1 + 4 * SGT_U) * q->scale;
    if (!(fabs(h->t) < HUGE_VAL)) h->t_err = HUGE_VAL; /* t may be out of range in lengths of d */
    /* powers of x and y may underflow */
    bool away = (q->x != 0 || q->y != 0) && larger(fabs(q->x), fabs(q->y)) < 0x1p-60;
    if (fabs(h->t) < TINY && (h->t != 0 || h->t_err != 0 || away)) h->t_err += TINY_ERROR;
    double tl = tau * q->l, tm = tau * q->m, tn = tau * q->n;
    h->p = (sgt_vec3){q->x + tl, q->y + tm, q->z + tn};
    h->p_err = (fabs(q->l) + fabs(q->m) + fabs(q->n)) * tau_err * (1 + 4 * SGT_U)
             + 1.01 * SGT_U * ((q->xa + fabs(tl) + fabs(h->p.x)) + (q->ya + fabs(tm) + fabs(h->p.y))
                               + (q->za + fabs(tn) + fabs(h->p.z)));
    if (h->p_err < TINY && (h->p_err != 0 || away)) h->p_err += TINY_ERROR;
}

/* Is t as sharp as asked for?  If t is much smaller than the sag (a start near the surface), rounding at
 * the surface's scale leaves many of the last bits of t unknown. */
SGT_INLINE bool sharp(const meeting *h, double t_tol)
{
    return h->t_err <= 40 * SGT_U * fabs(h->t) || h->t_err <= t_tol;
}

/* Is the root inside the rim, in (tmin, tmax], and not the start itself?  The sheet is the caller's to
 * test.  The sum of |p_i F_i| and |grad F . d| share the factor 1/v, which drops out.  At the vertex both
 * are 0.  If v is negative (and so not certain), or so near 0 that n is infinite, the term drops out and
 * only the ends decide.  rim2 is infinite without a rim. */
SGT_INLINE bool accepted(const meeting *h, const sgt_ray *ray, double rim2, double scale)
{
    double terms = h->v * (fabs(h->p.x * h->n.x) + fabs(h->p.y * h->n.y) + fabs(h->p.z));
    bool lost = !(fabs(h->n.x) + fabs(h->n.y) < HUGE_VAL);
    double room = h->t - ray->tmin - h->t_err - 8 * SGT_U * fabs(h->t);
    bool started = ray->tmin == -HUGE_VAL ||
                   (room > 0 && (room * (h->slope / scale) > START_ULPS * terms || terms == 0 || lost));
    bool inside = !(h->p.x * h->p.x + h->p.y * h->p.y > rim2);
    return started && h->t <= ray->tmax && inside;
}

/* Does rounding hide on which side of the rim the root is?  Its r^2 is off by twice (|x| + |y|) p_err, by
 * p_err^2, and by 4 u of itself.  Asked under a proof only; else the rule is as sharp as it is stated. */
SGT_INLINE bool rim_hidden(const meeting *h, double rim2)
{
    double r2 = h->p.x * h->p.x + h->p.y * h->p.y,
           off = (2 * (fabs(h->p.x) + fabs(h->p.y)) + h->p_err) * h->p_err + 4 * SGT_U * r2;
    if (!(rim2 < HUGE_VAL)) return false;
    /* far beyond the rim */
    if (!(off < HUGE_VAL)) return !(larger(fabs(h->p.x), fabs(h->p.y)) - h->p_err > 2 * sqrt(rim2));
    return !(fabs(r2 - rim2) > 1.01 * off);
}

/* The root is not accepted because of its ends.  Is t_err so wide that it may be accepted after all?
 * - It may be dropped as the start if t_err is no more than the rule's own width, or if all of t +- t_err
 *   is within that width.
 * - It may be dropped as lying behind tmax if t_err is no more than rounding, or if all of t +- t_err is
 *   behind.
 *
 * width: of the rule of the start, 16 ulps in each coordinate as a t. */
SGT_INLINE bool ends_hide(const meeting *h, const sgt_ray *ray, double rim2, double width)
{
    double after = h->t - ray->tmin, most = (width < HUGE_VAL ? width : 0) + 8 * SGT_U * fabs(h->t);
    bool start = after <= h->t_err + most && (h->t_err <= most || after + h->t_err <= most);
    bool behind =
        h->t > ray->tmax && (h->t_err <= 64 * SGT_U * fabs(ray->tmax) || h->t - h->t_err > ray->tmax);
    bool outside = h->p.x * h->p.x + h->p.y * h->p.y > rim2 && !rim_hidden(h, rim2);
    return !start && !behind && !outside;
}

/* The square of the rim, softened; infinite without a rim.  2^500 and beyond is no rim (surfaces.h). */
static const double NO_RIM = 0x1p500;

SGT_INLINE double rim2_of(double semi_diameter)
{
    if (!(semi_diameter > 0)) return HUGE_VAL;
    return semi_diameter < NO_RIM ? semi_diameter * semi_diameter * SOFT_RIM : HUGE_VAL;
}

/* The rim within which a root in lanes is certain: conic/easy.h, asphere/easy.h. */
SGT_INLINE double sure_rim2(double rim2) { return rim2 * (1 - 0x1.dp-45); }

/* Is the square of the rim free of underflow?  If not, roots inside and outside cannot be told apart, and
 * every ray is UNPROVEN. */
SGT_INLINE bool rim_in_range(double rim2) { return rim2 > TINY; }

/* A ray lies in the surface from lo to hi.  At which t does it begin to be accepted?  Returns the first t,
 * as nearly as a few trials tell, whose point has r^2 <= rim2 as computed (chords are made longer than
 * they are).  NaN: none is found.  If the stretch has no beginning, it is the point nearest to `centre`.
 * All t count from t0. */
SGT_INLINE double start_within(const sgt_ray *ray, double t0, double lo, double hi, double centre,
                               double rim2)
{
    double begin = lo > -DBL_MAX ? lo : hi < centre ? hi : centre, length = hi - begin, t = begin;
    for (double part = 0x1p-48;; part *= 64) {
        double x = coordinate(ray->o.x, ray->d.x, t0, t).hi, y = coordinate(ray->o.y, ray->d.y, t0, t).hi;
        if (x * x + y * y <= rim2) return t;
        if (!(part <= 1 && length < HUGE_VAL)) return (double)NAN;
        t = begin + (part < 1 ? part : 0.5) * length;
    }
}

#endif
