/* sag.h - what the rotationally symmetric sags share: the ray made local, the rules by
 * which a root counts, and the making of a hit.
 *
 * THE RAY MADE LOCAL.  The direction is scaled by a power of two, so that its largest
 * component lies in [1, 2); t_ray = t * scale, exactly.  Then the origin is moved to a
 * point t0 of the ray near the surface.  With t0 n and o + t0 l split by error-free
 * products and sums, the new origin is right to a relative u in each coordinate,
 * however far the old one was: a ray from 1e12 away is as good as one from nearby.
 * Two places are used: where the ray meets the vertex plane (z = 0: then the constant
 * term of the conic's equation, c r^2, is free of cancellation), and, for rays nearly
 * parallel to that plane, and to polish, any other t0.
 *
 * ROOTS THAT COUNT.  In this order: on the sheet, inside the rim, in (tmin, tmax], not
 * the start itself (sgt_ray in sagitta.h has the rule).  The rules for rim and ends are
 * stated in computed numbers, so they are sharp and never undecided; where a proof is asked for,
 * a root whose side of the rim rounding hides is.  And a root whose t_err is far wider than the rule of the
 * start (extreme numbers: terms that underflow or cancel) is not taken for the start: it is undecided
 * (ends_hide).
 *
 * Each way to a root computes another t.  So a root next to tmax, by END_ERRORS of its t_err, is
 * left by the ways that are there for speed to the one that finds every root: the first root and
 * the first of all are then the same. */
#ifndef SGT_SURFACE_SAG_H
#define SGT_SURFACE_SAG_H

#include "../num/exact.h"
#include "own.h"
#include <float.h>
#include <sagitta/sagitta.h>
#include <sagitta/surfaces.h>
#include <string.h>

static const double SOFT_RIM = 1 + 0x1p-44;  /* of r^2; surfaces.h says why */
static const double START_ULPS = 0x1p-48;    /* 16 ulps; sagitta.h, sgt_ray */
static const double END_ERRORS = 16;         /* t of two ways differ by less, times t_err */
static const double TINY = 0x1p-960;         /* below it, rounding is no longer relative */
static const double TINY_ERROR = 0x1p-1060;
static const double LEAST_PLACE = 0x1p-480;  /* what is smaller has a square below TINY */

typedef struct local {
    double x, y, z;       /* the local origin */
    double xa, ya, za;    /* |x| and what u * xa must be to bound its error */
    double l, m, n;       /* the scaled direction */
    double t0, t0_lo;     /* o + (t0 + t0_lo) d is the local origin */
    double t0_err;        /* for a t0_lo that is itself off by as much */
    double scale;         /* t_ray = t * scale */
} local;

/* The power of two that brings the largest component of d to [1, 2). */
SGT_INLINE double scale_of(sgt_vec3 d)
{
    double big = larger(fabs(d.x), larger(fabs(d.y), fabs(d.z)));
    unsigned long long bits;
    memcpy(&bits, &big, sizeof bits);
    bits = (2046ULL << 52) - (bits & 0x7ff0000000000000ULL); /* 2^-e from 2^e */
    double scale;
    memcpy(&scale, &bits, sizeof scale);
    return big < 0x1p1023 ? scale : 0x1p-1023;
}

/* An end of a stretch in the ray's own t, outward: where that is subnormal the product loses less. */
SGT_INLINE double end_below(double t, double scale) { return t * scale - DBL_MIN; }
SGT_INLINE double end_above(double t, double scale) { return t * scale + DBL_MIN; }

/* One coordinate of o + t0 d.  The product is hi + lo exactly, so is the sum of o and its hi.  Where they cancel to
 * less than half of the greater, that sum has no lo (Sterbenz 1974) and the product's own is added with one rounding;
 * else both lo are below 2 u of the result, and rounding them costs 4 u^2: right to u (1 + 4 u) of itself. */
SGT_INLINE double moved_along(double o, double t0, double d)
{
    twofold p = two_product(t0, d), s = two_sum(o, p.hi);
    return s.hi + (s.lo + p.lo);
}

/* 1 / scale_of(d), exactly: the power of two in its largest component. */
SGT_INLINE double inverse_of_scale(sgt_vec3 d)
{
    double big = larger(fabs(d.x), larger(fabs(d.y), fabs(d.z)));
    unsigned long long bits;
    memcpy(&bits, &big, sizeof bits);
    bits &= 0x7ff0000000000000ULL;
    memcpy(&big, &bits, sizeof big);
    return big;
}

/* The local origin where the ray meets the vertex plane; NaN where n = 0. */
SGT_INLINE local local_at_vertex_plane(const sgt_ray *ray)
{
    local q;
    q.scale = scale_of(ray->d);
    q.l = ray->d.x * q.scale, q.m = ray->d.y * q.scale, q.n = ray->d.z * q.scale;
    double inverse = 1 / q.n;
    q.t0 = -ray->o.z * inverse;
    /* what t0 leaves of z is a double, up to a last bit: the quotient is within an ulp or two */
    q.t0_lo = sgt_fma(-q.t0, q.n, -ray->o.z) * inverse;
    twofold px = two_product(q.t0, q.l), py = two_product(q.t0, q.m);
    twofold sx = two_sum(ray->o.x, px.hi), sy = two_sum(ray->o.y, py.hi);
    q.x = sx.hi + (sx.lo + px.lo + q.t0_lo * q.l);
    q.y = sy.hi + (sy.lo + py.lo + q.t0_lo * q.m);
    q.z = 0;
    q.t0_err = 8 * SGT_U * fabs(q.t0_lo);
    /* the small terms are below 4 u (|o| + |t0 l|), and rounded four times */
    q.xa = fabs(q.x) + 16 * SGT_U * (fabs(ray->o.x) + fabs(px.hi));
    q.ya = fabs(q.y) + 16 * SGT_U * (fabs(ray->o.y) + fabs(py.hi));
    q.za = 0;
    return q;
}

/* o + (t0 + t0_lo) d, one coordinate: right to 3 u^2 of the greater of the result and t0_lo d. */
SGT_INLINE twofold coordinate(double o, double d, double t0, double t0_lo)
{
    return twofold_sum(twofold_sum(twofold_of(o), two_product(t0, d)), two_product(t0_lo, d));
}

/* The local origin at a t0 + t0_lo (scaled) of the caller's. */
SGT_INLINE local local_at(const sgt_ray *ray, double t0, double t0_lo)
{
    local q;
    q.scale = scale_of(ray->d);
    q.l = ray->d.x * q.scale, q.m = ray->d.y * q.scale, q.n = ray->d.z * q.scale;
    q.t0 = t0, q.t0_lo = t0_lo, q.t0_err = 0;
    q.x = coordinate(ray->o.x, q.l, t0, t0_lo).hi;
    q.y = coordinate(ray->o.y, q.m, t0, t0_lo).hi;
    q.z = coordinate(ray->o.z, q.n, t0, t0_lo).hi;
    q.xa = fabs(q.x), q.ya = fabs(q.y), q.za = fabs(q.z);
    return q;
}

/* Are the local origin's coordinates off by products with t0 that have underflown, 2^-1070 at most? */
SGT_INLINE bool place_underflows(const local *q)
{
    double x = fabs(q->l * q->t0), y = fabs(q->m * q->t0), z = fabs(q->n * q->t0);
    return q->t0 != 0 && ((q->l != 0 && x < TINY) || (q->m != 0 && y < TINY) || (q->n != 0 && z < TINY));
}

/* The direction has been scaled exactly: no component of it has underflown. */
SGT_INLINE bool direction_is_whole(const local *q, sgt_vec3 d)
{
    double inverse = inverse_of_scale(d);
    return q->l * inverse == d.x && q->m * inverse == d.y && q->n * inverse == d.z;
}

/* Neither end underflows in the t of the scaled direction: one made 0 would be where the ray starts. */
SGT_INLINE bool ends_are_whole(const sgt_ray *ray, double scale)
{
    return ray->tmin / scale * scale == ray->tmin && ray->tmax / scale * scale == ray->tmax;
}

/* Is the ray so near the vertex, all the way to p at t, that squares of its coordinates have underflown, and t_err does not
 * hide it? */
SGT_INLINE bool place_is_tiny(const local *q, double t, sgt_vec3 p)
{
    double far = larger(fabs(p.x), larger(fabs(p.y), fabs(p.z)));
    return far > 0 && far < LEAST_PLACE && fabs(t) < LEAST_PLACE * q->scale;
}

/* The t0 nearest the vertex: right to an ulp or so, and that is all it needs to be. */
SGT_INLINE double nearest_to_vertex(const sgt_ray *ray)
{
    double s = scale_of(ray->d), l = ray->d.x * s, m = ray->d.y * s, n = ray->d.z * s;
    return -(ray->o.x * l + ray->o.y * m + ray->o.z * n) / (l * l + m * m + n * n);
}

/* A root, with all that a hit says of it. */
typedef struct meeting {
    double t, t_lo, t_err;   /* the ray's own */
    sgt_vec3 p, n;           /* point and gradient of F */
    double p_err;
    double slope;            /* |grad F . d| for the scaled d, times v; see below */
    double v;                /* 1 - (1 + k) c w: positive on the sheet, 0 at the equator */
    double sag;              /* the conic's s(x, y) as `value` has it; NaN: not worked out */
} meeting;

/* t = t0 + t0_lo + tau, with tau known to tau_err, in the ray's own measure. */
SGT_INLINE void meeting_place(meeting *h, const local *q, double tau, double tau_err)
{
    double small = q->t0_lo + tau;
    twofold t = two_sum(q->t0, small);
    double e = tau_err + SGT_U * fabs(small) + q->t0_err;
    h->t = t.hi * q->scale;
    h->t_lo = t.lo * q->scale;
    h->t_err = (fabs(t.lo) + e * (1 + 4 * SGT_U)) * (1 + 4 * SGT_U) * q->scale;
    if (!(fabs(h->t) < HUGE_VAL)) h->t_err = HUGE_VAL; /* in lengths of d */
    bool away = (q->x != 0 || q->y != 0) && larger(fabs(q->x), fabs(q->y)) < 0x1p-60; /* powers of theirs may underflow */
    if (fabs(h->t) < TINY && (h->t != 0 || h->t_err != 0 || away)) h->t_err += TINY_ERROR;
    double tl = tau * q->l, tm = tau * q->m, tn = tau * q->n;
    h->p = (sgt_vec3){q->x + tl, q->y + tm, q->z + tn};
    h->p_err = (fabs(q->l) + fabs(q->m) + fabs(q->n)) * tau_err * (1 + 4 * SGT_U)
             + 1.01 * SGT_U * ((q->xa + fabs(tl) + fabs(h->p.x)) + (q->ya + fabs(tm) + fabs(h->p.y))
                               + (q->za + fabs(tn) + fabs(h->p.z)));
    if (h->p_err < TINY && (h->p_err != 0 || away)) h->p_err += TINY_ERROR;
}

/* Is t as sharp as asked for?  Where t is much smaller than the sag (a start near the surface),
 * rounding at the surface's scale leaves t with many of its last bits unknown. */
SGT_INLINE bool sharp(const meeting *h, double t_tol)
{
    return h->t_err <= 40 * SGT_U * fabs(h->t) || h->t_err <= t_tol;
}

/* Inside the rim, in (tmin, tmax], and not the start itself: farther from tmin than 16 ulps in each
 * coordinate of the root can put it.  The sum of |p_i F_i| and |grad F . d| share the factor 1/v, which
 * drops out; at the vertex both are 0.  Of a v that is negative, and so no certain one, and of one so near 0 that n is
 * infinite, the ends alone count.  rim2 is infinite where there is none. */
SGT_INLINE bool counts(const meeting *h, const sgt_ray *ray, double rim2, double scale)
{
    double terms = h->v * (fabs(h->p.x * h->n.x) + fabs(h->p.y * h->n.y) + fabs(h->p.z));
    bool lost = !(fabs(h->n.x) + fabs(h->n.y) < HUGE_VAL);
    double room = h->t - ray->tmin - h->t_err - 8 * SGT_U * fabs(h->t);
    bool started = ray->tmin == -HUGE_VAL || (room > 0 && (room * (h->slope / scale) > START_ULPS * terms || terms == 0 || lost));
    bool inside = !(h->p.x * h->p.x + h->p.y * h->p.y > rim2);
    return started && h->t <= ray->tmax && inside;
}

/* Rounding hides on which side of the rim the root is: its r^2 is off by twice (|x| + |y|) p_err and what that makes of
 * itself, and 4 u.  Asked under proof alone; without, the rule is as sharp as it is stated. */
SGT_INLINE bool rim_hidden(const meeting *h, double rim2)
{
    double r2 = h->p.x * h->p.x + h->p.y * h->p.y, off = (2 * (fabs(h->p.x) + fabs(h->p.y)) + h->p_err) * h->p_err + 4 * SGT_U * r2;
    if (!(rim2 < HUGE_VAL)) return false;
    if (!(off < HUGE_VAL)) return !(larger(fabs(h->p.x), fabs(h->p.y)) - h->p_err > 2 * sqrt(rim2)); /* far beyond */
    return !(fabs(r2 - rim2) > 1.01 * off);
}

/* Of a root that does not count by its ends: t_err is so wide that it may count.  As the start it may be
 * dropped if t_err is no more than the rule's own width, or if all of t +- t_err is within that; as one
 * behind tmax if t_err is but rounding, or if all of t +- t_err is behind.  width: of the rule of the start,
 * 16 ulps in each coordinate as a t. */
SGT_INLINE bool ends_hide(const meeting *h, const sgt_ray *ray, double rim2, double width)
{
    double after = h->t - ray->tmin, most = (width < HUGE_VAL ? width : 0) + 8 * SGT_U * fabs(h->t);
    bool start = after <= h->t_err + most && (h->t_err <= most || after + h->t_err <= most);
    bool behind =
        h->t > ray->tmax && (h->t_err <= 64 * SGT_U * fabs(ray->tmax) || h->t - h->t_err > ray->tmax);
    bool outside = h->p.x * h->p.x + h->p.y * h->p.y > rim2 && !rim_hidden(h, rim2);
    return !start && !behind && !outside;
}

/* Infinite where there is none; 2^500 and beyond is none (surfaces.h). */
static const double NO_RIM = 0x1p500;

SGT_INLINE double rim2_of(double semi_diameter)
{
    if (!(semi_diameter > 0)) return HUGE_VAL;
    return semi_diameter < NO_RIM ? semi_diameter * semi_diameter * SOFT_RIM : HUGE_VAL;
}

/* Of the rim within which a root in lanes is certain: conic_easy.h, asphere_easy.h. */
SGT_INLINE double sure_rim2(double rim2) { return rim2 * (1 - 0x1.dp-45); }

/* Its square has lost nothing to underflow.  Where it has, no root is told from another: every ray is UNPROVEN. */
SGT_INLINE bool rim_in_range(double rim2) { return rim2 > TINY; }

/* Where a ray that lies in the surface from lo to hi begins to count: the first t, as nearly as a few trials tell, whose
 * point has r^2 <= rim2 as computed (chords are made longer than they are); NaN: none is found.  Of a stretch without a
 * beginning it is the point nearest to `centre`.  All t count from t0. */
SGT_INLINE double start_within(const sgt_ray *ray, double t0, double lo, double hi, double centre, double rim2)
{
    double begin = lo > -DBL_MAX ? lo : hi < centre ? hi : centre, length = hi - begin, t = begin;
    for (double part = 0x1p-48;; part *= 64) {
        double x = coordinate(ray->o.x, ray->d.x, t0, t).hi, y = coordinate(ray->o.y, ray->d.y, t0, t).hi;
        if (x * x + y * y <= rim2) return t;
        if (!(part <= 1 && length < HUGE_VAL)) return (double)NAN;
        t = begin + (part < 1 ? part : 0.5) * length;
    }
}

SGT_INLINE sgt_hit hit_without(sgt_status status, const sgt_ray *ray, int evals)
{
    return (sgt_hit){.status = status, .evals = evals, .t = (double)NAN, .t_err = (double)NAN, .t_lo = (double)NAN,
                     .lo = ray->tmin, .hi = ray->tmax, .f = (double)NAN, .p = {(double)NAN, (double)NAN, (double)NAN},
                     .n = {(double)NAN, (double)NAN, (double)NAN}, .p_err = (double)NAN};
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

/* A root is found: the next has the budget anew.  Answers made at random have roots without end, so all of them together
 * have one, too: 1024 budgets, of which the last begins here. */
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
SGT_INLINE sgt_hit hit_at(const meeting *h, sgt_status status, double f, sgt_move move, const sgt_ray *ray, tally *w)
{
    if (w->opt->watch) tell(w, move, h->t, f, h->n.x * ray->d.x + h->n.y * ray->d.y + h->n.z * ray->d.z, h->t - h->t_err, h->t + h->t_err);
    else w->evals++;
    if (w->stopped) return hit_without(SGT_STOPPED, ray, w->evals - w->before);
    if (!(h->t_err < HUGE_VAL && h->p_err < HUGE_VAL)) return hit_without(SGT_UNPROVEN, ray, w->evals - w->before);
    sgt_interval about = sgt_about(h->t, h->t_err);
    return (sgt_hit){.status = status, .evals = w->evals - w->before, .t = h->t, .t_err = h->t_err, .t_lo = h->t_lo,
                     .lo = about.lo, .hi = about.hi, .f = f, .p = h->p, .n = h->n, .p_err = h->p_err};
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
SGT_INLINE void add_stretch(sgt_list *list, tally *w, sgt_status status, const sgt_ray *ray, double lo, double hi)
{
    sgt_hit hit = hit_without(status, ray, w->evals - w->before);
    lo -= 2 * SGT_U * fabs(lo), hi += 2 * SGT_U * fabs(hi); /* outward, by at least an ulp */
    hit.lo = larger(lo, ray->tmin), hit.hi = hi < ray->tmax ? hi : ray->tmax;
    if (list->count && status != SGT_UNPROVEN) hit.lo = larger(hit.lo, list->last.hi); /* what is left is behind it */
    if (!(hit.lo <= DBL_MAX)) hit.lo = DBL_MAX; /* beyond the range of t: its t is a number all the same */
    if (!(hit.hi >= -DBL_MAX)) hit.hi = -DBL_MAX;
    if (hit.lo > hit.hi && status == SGT_STOPPED) hit.lo = hit.hi; /* at the very end: told all the same */
    if (hit.lo > hit.hi) return;
    sgt_list_centre(&hit);
    if (!sgt_list_merge(list, &hit)) sgt_list_add(list, &hit);
    w->before = w->evals;
}

/* hit_at as an entry of a list; what was spent since the last entry is told with it. */
SGT_INLINE void add_hit(sgt_list *list, const meeting *h, sgt_status status, double f, sgt_move move, const sgt_ray *ray, tally *w)
{
    sgt_hit hit = hit_at(h, status, f, move, ray, w);
    if (w->stopped) return; /* what is left is told by whoever searches */
    if (hit.status > 0) sgt_list_add(list, &hit), w->before = w->evals;
    else add_stretch(list, w, hit.status, ray, hit.lo, hit.hi);
    next_root(w);
}

#endif
