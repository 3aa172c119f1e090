// SPDX-License-Identifier: MIT
/* leave.c - rays that start where another has met the surface: sgt_leave and sgt_leave_batch.
 *
 * THE START.  sgt_intersect drops the root at the start of a ray by the rule of sgt_ray: one that 16 ulps in
 * each coordinate can put there.  A point that is known to p_err may be farther off than that: one that has
 * come from another frame, a hit with t_tol, the vertex of a sag, where an ulp of the coordinates is as small
 * as these are.  So the ray starts at a point o of the surface, within p_err of p:
 *
 *     |grad F| p_err, or else |F| at p, is       o = p: the rule of sgt_ray covers p_err.  (The other half is
 *     at most half of START_ULPS of the terms    for how far the gradient changes, and for rounding)
 *     else                                       Newton's steps o = p - F grad F / |grad F|^2, as long as |F|
 *                                                falls and o stays within p_err and 4 ulps
 *     |F| is still beyond half of the rule,      p is not on the surface within p_err: o = p, and no root is
 *     and beyond its rounding                    dropped but by the rule of sgt_ray
 *
 * So nothing has to be known of the solvers here: the answer is that of sgt_intersect for the ray o + t d.
 *
 * A HIDDEN START.  Where a gradient is along a coordinate that is nearly 0, the terms of the rule are too,
 * and F rounds by more.  Then sgt_intersect cannot tell the root at the start, and is UNPROVEN.  But the
 * surface is within p_err of p, as was promised.  So is o, as far as F computed tells, if |F| <= |grad F|
 * (p_err and 4 ulps).  Let G be an enclosure of g at o, and S one of g' over [0, h].  If 0 is not in S, one
 * root at most is in [0, h].  It lies before |G| / |S|.  If that is less than h / 4, it is the start, which
 * is the only root so near, and the ray is looked at from t = h on, its tmin.  (h: 2^-10 of the distance from
 * the origin, or less.)
 *
 * THE START AGAIN.  If p_err is wider than the rule (terms of F that cancel: a small ball far from the
 * origin), o may be on the wrong side of the surface by up to p_err, and a hit right at the start is the
 * start.  It shows: F rises, or falls, along the ray at o as at the hit, and between two crossings it would
 * have to turn.  Such a hit, if the surface there is within p_err and 4 ulps of p, measured along the normal,
 * is dropped: the ray is looked at from there on.
 *
 * THE SIDE is the sign of F between the start and the next crossing, and has to be that all along: there is
 * no accepted root in between.
 *
 *     met, with a slope n . d that is not nearly 0    the sign before a change of sign is that of -n . d
 *     missed, touched, or nearly along the surface    that of F at a point behind the start: 64 widths of the
 *                                                     rule, and farther off while rounding hides it.  By
 *                                                     `encloses`, where it is offered, else by `rounding`
 *     hidden all the way, from a point on it          that of grad F . d at the start, if it is not nearly 0
 *     missed, and the surface knows it (`behind`)      that: of a conic the slope at the start
 *     missed, and steeper than a sag within its rim    that of d_z: F rises, or falls, all along there
 *     undecided, or neither                           0
 *
 * MANY AT ONCE.  A batch looks at F behind all starts together, with one bound on its rounding for the circle
 * that holds the points, where a single ray has one for its point.  What such a look leaves open is asked as
 * of a single ray.
 *
 * A SURFACE THAT KNOWS (`leave`: planes, conics, even aspheres) tells of many starts at once that they are
 * on it, what they meet, and the side.  An even asphere is asked for a single start, too: so that a batch has
 * the same bits.  Its hits come from the start itself, and may differ from those of sgt_intersect by what
 * t_err allows.  The others of a tile are put side by side.
 *
 * A user's surface that is searched by steps may skip a root.  If its slope at the start and at the next
 * crossing say that F has unlike signs behind the one and before the other, one has been skipped: the answer
 * is UNPROVEN.
 *
 * With t_tol a hit may lie where F has another slope than at the root: then no slope there is trusted. */
#include "../num/lanes.h"
#include "../solve/entries.h"
#include "../solve/root.h"
#include "../surface/builtin.h"
#include "general.h"
#include "batch.h"
#include "vicinity.h"

enum { POLISHES = 4, LOOKS = 6, ASKS = 64 };

/* What is known of a start: the ray, and if it starts on the surface, certainly to p_err. */
typedef struct place {
    sgt_vec3 o;
    bool on;
} place;

SGT_INLINE double leave_size(sgt_vec3 a) { return larger(fabs(a.x), larger(fabs(a.y), fabs(a.z))); }
SGT_INLINE double leave_dot(sgt_vec3 a, sgt_vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
SGT_INLINE double leave_terms(sgt_vec3 p, sgt_vec3 n)
{
    return fabs(p.x * n.x) + fabs(p.y * n.y) + fabs(p.z * n.z);
}

SGT_INLINE bool leave_finite(sgt_vec3 a) { return a.x - a.x + (a.y - a.y) + (a.z - a.z) == 0; }

/* Is there a surface of which F may be asked? */
static bool asked_of(sgt_surface s) { return s.ops && s.ops->value && parameters_valid(s); }

/* Within half of the rule, and so is |F| if |grad F| p_err is. */
SGT_INLINE bool is_on(double f, sgt_vec3 p, sgt_vec3 n)
{
    return fabs(f) <= 0.5 * START_ULPS * leave_terms(p, n);
}

SGT_INLINE bool surely_on(sgt_vec3 p, sgt_vec3 n, double p_err)
{
    double steep = fabs(n.x) + fabs(n.y) + fabs(n.z);
    return (steep > 0) & is_on(steep * p_err, p, n);
}

/* p is not on the surface: f, n there. */
static place polished(sgt_surface s, sgt_vec3 p, double f, sgt_vec3 n, double p_err)
{
    sgt_vec3 o = p;
    double most = p_err + 4 * SGT_U * leave_size(p);
    for (int i = 0; i < POLISHES && !(fabs(f) <= 0x1p-5 * START_ULPS * leave_terms(o, n)); i++) {
        double scale = leave_size(n), by = f / scale;
        sgt_vec3 unit = {n.x / scale, n.y / scale, n.z / scale}, next, along = {0, 0, 0}, off;
        by /= leave_dot(unit, unit);
        next = (sgt_vec3){o.x - by * unit.x, o.y - by * unit.y, o.z - by * unit.z};
        off = (sgt_vec3){next.x - p.x, next.y - p.y, next.z - p.z};
        double g = s.ops->value(s.self, next, &along);
        if (!(fabs(g) < fabs(f) && leave_dot(off, off) <= most * most)) break; /* NaN, too */
        o = next, n = along, f = g;
    }
    if (is_on(f, o, n)) return (place){o, true};
    double own = s.ops->rounding ? s.ops->rounding(s.self, o) : 0;
    bool on = fabs(f) <= 0.5 * START_ULPS * leave_terms(o, n) + (own < HUGE_VAL ? own : 0);
    return (place){on ? o : p, on};
}

SGT_INLINE double leave_sign(double x) { return (x > 0 ? 1.0 : 0.0) - (x < 0 ? 1.0 : 0.0); }

/* The sign of the slope n . d; 0 if it is less than `part` of what it may be. */
SGT_INLINE double slope_sign(sgt_vec3 n, sgt_vec3 d, double part)
{
    double slope = leave_dot(n, d);
    return fabs(slope) > part * leave_size(n) * leave_size(d) ? leave_sign(slope) : 0;
}

/* The gradient at the start, or a multiple of it. */
static sgt_vec3 gradient_at(sgt_surface s, const sgt_start *from, sgt_vec3 o)
{
    sgt_vec3 n = from->n;
    if (!(leave_size(n) > 0 && leave_finite(n))) s.ops->value(s.self, o, &n);
    return n;
}

/* Starts whose side no hit tells.  t: where F is asked, next; `most`: no farther. */
typedef struct asked {
    double o[3][ASKS], d[3][ASKS], t[ASKS], most[ASKS], far[ASKS];
    double lo[ASKS], hi[ASKS];
    size_t of[ASKS], count;
    bool on[ASKS]; /* it starts on the surface */
} asked;

/* Is it a built-in surface without an edge?  Its F is continuous everywhere, so that its sign behind the last
 * root does not change. */
static bool is_body(const sgt_surface_ops *ops)
{
    return is_catalogue(ops) && ops->first && ops->values && ops->own_->roundings && !ops->own_->share;
}

/* How far the origin is, in lengths of d. */
SGT_INLINE double far_of(sgt_vec3 o, sgt_vec3 d) { return leave_size(o) / leave_size(d); }

/* The first t.  It is behind all that the rule of the start drops: roots there have t |slope| <= START_ULPS
 * of the terms.  Where the ray bends away from the surface, or twists, that is below 2^-24 or 2^-16 of the
 * lengths at hand, however small the slope at the start is.  If tmin has been moved behind the root of the
 * start, which p is then beside, the first look is behind it, too. */
SGT_INLINE double first_look(sgt_vec3 o, sgt_vec3 d, sgt_vec3 n, double far)
{
    double least = 0x1p-32 * far, t = 0x1p6 * START_ULPS * leave_terms(o, n) / fabs(leave_dot(n, d));
    t = t < 0x1p-14 * far ? t : 0x1p-14 * far;
    return t > least ? t : least; /* of a NaN: least */
}

/* F by `value` and its own rounding is off by no more than this from F at the point meant. */
SGT_INLINE double look_error(double own, sgt_vec3 p, sgt_vec3 n)
{
    return 2 * (own + 2 * SGT_U * leave_terms(p, n));
}

/* Is it a built-in surface of which a look may be taken before its span is known?  A span ends where F may
 * get another sign without a root, at a rim.  But if F at the first look and its slope there have one sign, F
 * has come from the root at the start: it is the sign behind it. */
static bool looks_early(const sgt_surface_ops *ops)
{
    return ops->own_ && ops->rounding && !encloses_of(ops) && !is_body(ops);
}

/* The side of a start on such a surface, from which the ray misses.  0: not known. */
static signed char early_side(sgt_surface s, const sgt_ray *ray, sgt_vec3 n)
{
    sgt_vec3 o = ray->o, d = ray->d;
    double t = larger(first_look(o, d, n, far_of(o, d)), 2 * ray->tmin);
    t = t < ray->tmax ? t : ray->tmax;
    sgt_vec3 m = {0, 0, 0},
             p = {moved_along(o.x, t, d.x), moved_along(o.y, t, d.y), moved_along(o.z, t, d.z)};
    if (!(t > 0)) return 0;
    double f = s.ops->value(s.self, p, &m), err = look_error(s.ops->rounding(s.self, p), p, m),
           there = (f - err > 0 ? 1.0 : 0.0) - (f + err < 0 ? 1.0 : 0.0);
    return there == slope_sign(m, d, 0x1p-20) ? (signed char)there : 0;
}

/* Asks for the side of number i. */
static double ask_side(sgt_surface s, asked *a, size_t i, const sgt_ray *ray, sgt_vec3 n, bool on,
                       const sgt_hit *hit)
{
    size_t k = a->count++;
    a->on[k] = on;
    const double o[3] = {ray->o.x, ray->o.y, ray->o.z}, d[3] = {ray->d.x, ray->d.y, ray->d.z};
    double far = far_of(ray->o, ray->d);
    for (int c = 0; c < 3; c++) a->o[c][k] = o[c], a->d[c][k] = d[c];
    a->far[k] = 0x1p-6 * far, a->most[k] = hit->status > 0 ? 0.5 * hit->t : ray->tmax, a->of[k] = i;
    double end = hit->status > 0 || !s.ops->span || is_body(s.ops) ? HUGE_VAL : s.ops->span(s.self, ray).hi;
    if (end > 0 && 0.5 * end < a->most[k]) a->most[k] = 0.5 * end; /* behind it F may have another sign */
    a->t[k] = larger(first_look(ray->o, ray->d, n, far), 2 * ray->tmin);
    return a->t[k];
}

/* Enclosures of F by `values` and the many roundings of a built-in surface without a share. */
static void value_asked(sgt_surface s, asked *a)
{
    double p[3][ASKS], f[ASKS], n[3][ASKS], own[ASKS];
    sgt_points points = {{p[0], p[1], p[2]}};
    for (int c = 0; c < 3; c++)
        for (size_t k = 0; k < a->count; k++) p[c][k] = moved_along(a->o[c][k], a->t[k], a->d[c][k]);
    s.ops->values(s.self, a->count, points, (sgt_values){f, {n[0], n[1], n[2]}});
    s.ops->own_->roundings(s.self, NULL, a->count, points, f, own);
    for (size_t k = 0; k < a->count; k++) {
        sgt_vec3 at = {p[0][k], p[1][k], p[2][k]}, grad = {n[0][k], n[1][k], n[2][k]};
        double err = look_error(own[k], at, grad);
        a->lo[k] = f[k] - err, a->hi[k] = f[k] + err;
    }
}

/* Enclosures of F at the points asked for. */
static void enclose_asked(sgt_surface s, asked *a)
{
    sgt_enclose_many *encloses = encloses_of(s.ops);
    if (encloses) {
        sgt_rays rays = {.o = {a->o[0], a->o[1], a->o[2]}, .d = {a->d[0], a->d[1], a->d[2]}};
        encloses(s.self, a->count, rays, a->t, a->t, (sgt_enclosures){a->lo, a->hi, NULL, NULL});
        return;
    }
    if (is_body(s.ops)) {
        value_asked(s, a);
        return;
    }
    for (size_t k = 0; k < a->count; k++) {
        double t = a->t[k];
        sgt_vec3 n = {0, 0, 0},
                 p = {moved_along(a->o[0][k], t, a->d[0][k]), moved_along(a->o[1][k], t, a->d[1][k]),
                      moved_along(a->o[2][k], t, a->d[2][k])};
        double f = s.ops->value(s.self, p, &n), own = s.ops->rounding ? s.ops->rounding(s.self, p) : 0,
               err = look_error(own, p, n);
        a->lo[k] = f - err, a->hi[k] = f + err;
    }
}

/* The side behind a start by the slope there. */
static signed char side_by_slope(sgt_surface s, sgt_vec3 o, sgt_vec3 d)
{
    sgt_vec3 n = {0, 0, 0};
    s.ops->value(s.self, o, &n);
    return (signed char)slope_sign(n, d, 0x1p-20);
}

/* Answers what has been asked: sign[of[k]]; 0 where F and the slope at the start hide it. */
static void answer_sides(sgt_surface s, asked *a, signed char sign[])
{
    for (int i = 0; i < LOOKS && a->count > 0; i++) {
        for (size_t k = 0; k < a->count; k++) a->t[k] = a->t[k] < a->most[k] ? a->t[k] : a->most[k];
        enclose_asked(s, a);
        size_t left = 0;
        for (size_t k = 0; k < a->count; k++) {
            double lo = a->lo[k], hi = a->hi[k], t = a->t[k];
            if (lo <= hi && (lo > 0 || hi < 0))
                sign[a->of[k]] = lo > 0 ? 1 : -1;
            else if (t < a->most[k] && 0x1p7 * t < a->far[k]) {
                for (int c = 0; c < 3; c++) a->o[c][left] = a->o[c][k], a->d[c][left] = a->d[c][k];
                a->t[left] = 0x1p7 * t, a->most[left] = a->most[k], a->far[left] = a->far[k];
                a->on[left] = a->on[k], a->of[left++] = a->of[k];
            } else if (a->on[k])
                sign[a->of[k]] = side_by_slope(s, (sgt_vec3){a->o[0][k], a->o[1][k], a->o[2][k]},
                                               (sgt_vec3){a->d[0][k], a->d[1][k], a->d[2][k]});
        }
        a->count = left;
    }
    a->count = 0;
}

/* The sides right behind starts that are on the surface, as the surface itself knows them. */
static bool sides_behind(sgt_surface s, size_t n, const sgt_rays *rays, double side[])
{
    return s.ops->own_ && s.ops->own_->behind && s.ops->own_->behind(s.self, n, rays, side);
}

/* Is there one bound on the slope of this sag, for rays that are steeper than that? */
static bool knows_steep(sgt_surface s)
{
    return s.ops->own_ && is_catalogue(s.ops) && s.ops->own_->share && s.ops->own_->spans;
}

/* The sign of dF/dt all along within the rim, where the slope is at most `steep`; 0: not certain, or the
 * start is not within the rim. */
SGT_INLINE double steep_side(double steep, double rim2, sgt_vec3 o, sgt_vec3 d)
{
    double scale = scale_of(d), l = d.x * scale, m = d.y * scale, n = d.z * scale;
    mask is = MASK(fabs(n) * (1 - 0x1p-40) > steep * sqrt(l * l + m * m)) &
              MASK(o.x * o.x + o.y * o.y <= rim2);
    return chosen(is, copysign(1, n), 0);
}

/* The side as the hit alone tells it; else F is to be asked.  sharp: t_tol is 0. */
static signed char side_told(sgt_surface s, const sgt_start *from, const sgt_ray *ray, bool on, bool sharp,
                             const sgt_hit *hit, size_t i, asked *a)
{
    if (hit->status < 0) return 0;
    double by_hit = sharp && hit->status == SGT_HIT ? -slope_sign(hit->n, ray->d, 0x1p-30) : 0;
    if (by_hit != 0) return (signed char)by_hit;
    const bool left = on && hit->status == SGT_MISS;
    double behind[1] = {0};
    const sgt_rays one = rays_of(ray);
    if (left && sides_behind(s, 1, &one, behind) && behind[0] != 0) return (signed char)behind[0];
    if (left && knows_steep(s)) {
        sgt_shared shared;
        s.ops->own_->share(s.self, &shared);
        const double steep = steep_side(shared.steep, shared.radius2, ray->o, ray->d);
        if (steep != 0) return (signed char)steep;
    }
    sgt_vec3 n = gradient_at(s, from, ray->o);
    signed char early = left && looks_early(s.ops) ? early_side(s, ray, n) : 0;
    if (early != 0) return early;
    double t = ask_side(s, a, i, ray, n, on, hit);
    if (t > 0) return 0;
    a->count--; /* at the origin all terms are 0 */
    double f = s.ops->value(s.self, ray->o, &n),
           own = s.ops->rounding ? s.ops->rounding(s.self, ray->o) : 0;
    if (fabs(f) > own) return (signed char)leave_sign(f); /* in mid-air */
    return side_by_slope(s, ray->o, ray->d);              /* the vertex of a sag, say */
}

/* Do the two ends of the way, of a user's surface without enclosures, say that a root has been skipped? */
static bool skipped(sgt_surface s, const sgt_ray *ray, bool on, bool sharp, const sgt_hit *hit)
{
    if (s.ops->own_ || s.ops->enclose || !on || !sharp || hit->status != SGT_HIT) return false;
    sgt_vec3 n = {0, 0, 0};
    s.ops->value(s.self, ray->o, &n);
    return slope_sign(n, ray->d, 0x1p-20) * slope_sign(hit->n, ray->d, 0x1p-20) > 0;
}

/* Enclosures of g and g' over [lo, hi] of the ray; of a surface without any: no numbers. */
static sgt_interval leave_enclosed(sgt_surface s, const sgt_ray *ray, double lo, double hi,
                                   sgt_interval *slope)
{
    sgt_enclose_many *encloses = encloses_of(s.ops);
    sgt_interval g = {(double)NAN, (double)NAN};
    *slope = g;
    if (encloses)
        encloses(s.self, 1, rays_of(ray), &lo, &hi, (sgt_enclosures){&g.lo, &g.hi, &slope->lo, &slope->hi});
    else if (s.ops->enclose)
        g = s.ops->enclose(s.self, ray, (sgt_interval){lo, hi}, slope);
    return g;
}

/* Is there a hidden start, and nothing else, up to some h?  Then tmin is set to it.  *evals is counted on. */
static bool past_hidden_start(sgt_surface s, const sgt_start *from, sgt_ray *ray, int *evals)
{
    double far = leave_size(ray->o) / leave_size(ray->d), h = 0x1p-10 * far,
           most = from->p_err + 4 * SGT_U * leave_size(from->p);
    sgt_vec3 n = {0, 0, 0};
    double f = s.ops->value(s.self, ray->o, &n);
    ++*evals;
    if (!(fabs(f) <= most * sqrt(leave_dot(n, n)))) return false;
    for (int i = 0; i < LOOKS; i++, h *= 0x1p-6) {
        sgt_interval slope, at_start;
        if (!(h < ray->tmax)) continue;
        leave_enclosed(s, ray, 0, h, &slope), ++*evals;
        bool finite = slope.lo > -HUGE_VAL && slope.hi < HUGE_VAL && slope.lo <= slope.hi;
        if (!finite || !(slope.lo > 0 || slope.hi < 0)) continue;
        double flat = slope.lo > 0 ? slope.lo : -slope.hi, sign = slope.lo > 0 ? 1 : -1;
        at_start = leave_enclosed(s, ray, 0, 0, &slope), ++*evals;
        double last = (sign > 0 ? -at_start.lo : at_start.hi) / flat;
        if (!(at_start.lo <= at_start.hi && last < 0.25 * h)) return false;
        ray->tmin = h;
        return true;
    }
    return false;
}

/* Is the hit the start?  Then tmin is set to it. */
static bool past_start_again(sgt_surface s, const sgt_start *from, sgt_ray *ray, const sgt_hit *hit,
                             int *evals)
{
    double most = from->p_err + 4 * SGT_U * leave_size(from->p), slope = leave_dot(hit->n, ray->d);
    if (!(hit->t * fabs(slope) <= most * sqrt(leave_dot(hit->n, hit->n)))) return false;
    sgt_vec3 n = {0, 0, 0};
    s.ops->value(s.self, ray->o, &n), ++*evals;
    if (!(slope * leave_dot(n, ray->d) > 0 && hit->t < ray->tmax)) return false;
    ray->tmin = hit->t;
    return true;
}

/* Where the start hides the rest of the ray, or is met again, the ray is asked once more, from behind it.
 * *hit: an array in a batch may lack its evals. */
static bool met_behind(sgt_surface s, const sgt_start *from, bool on, const sgt_options *opt, sgt_ray *ray,
                       sgt_hit *hit)
{
    int evals = hit->evals;
    bool hidden = hit->status == SGT_UNPROVEN && on && past_hidden_start(s, from, ray, &evals),
         again = hit->status == SGT_HIT && on && !(opt->t_tol > 0) &&
                 past_start_again(s, from, ray, hit, &evals);
    if (!hidden && !again) return false;
    *hit = sgt_intersect(s, *ray, opt);
    hit->evals += evals;
    return true;
}

/* The first root is asked for, whatever opt picks. */
static sgt_options first_of(const sgt_options *opt)
{
    sgt_options own = opt ? *opt : (sgt_options){0};
    if (own.pick == SGT_NEAR_SEED) own.pick = SGT_FIRST;
    return own;
}

SGT_INLINE bool sound_at(sgt_vec3 p, double p_err)
{
    return (p_err >= 0) & (p_err < HUGE_VAL) & leave_finite(p);
}

static bool start_sound(const sgt_start *from) { return sound_at(from->p, from->p_err); }

static double leave_end(double tmax) { return tmax == 0 && !signbit(tmax) ? HUGE_VAL : tmax; }

/* One that makes no sense has an origin that is not finite. */
static sgt_ray ray_from(const sgt_start *from, sgt_vec3 o)
{
    if (!start_sound(from)) o.x = (double)NAN;
    return (sgt_ray){o, from->d, 0, leave_end(from->tmax)};
}

/* Which points are on the surface, as the surface itself knows it?  1 or 0. */
static bool known_on(sgt_surface s, size_t n, const double *const p[3], double on[])
{
    return s.ops->own_ && s.ops->own_->on && s.ops->own_->on(s.self, n, p, on);
}

static place place_to_leave(sgt_surface s, const sgt_start *from)
{
    sgt_vec3 n = {0, 0, 0};
    if (!start_sound(from) || !asked_of(s)) return (place){from->p, false};
    const double *const at[3] = {&from->p.x, &from->p.y, &from->p.z};
    double own[1] = {0};
    if (known_on(s, 1, at, own) && own[0] > 0) return (place){from->p, true};
    if (surely_on(from->p, from->n, from->p_err)) return (place){from->p, true};
    double f = s.ops->value(s.self, from->p, &n);
    return is_on(f, from->p, n) ? (place){from->p, true} : polished(s, from->p, f, n, from->p_err);
}

/* No `leave` takes more evaluations. */
enum { MOST_LEAVING = 16 };

/* Is `leave` of the surface asked? */
static bool asks_leave(sgt_surface s, const sgt_options *opt)
{
    return (!opt->max_evals || opt->max_evals >= MOST_LEAVING) && s.ops && s.ops->own_ &&
           s.ops->own_->leave && !opt->watch && !(opt->t_tol > 0) && opt->proof == SGT_ESTIMATE &&
           sgt_options_valid(opt);
}

/* Are the hits of `leave` those of sgt_intersect, so that their sides are told as there?  That is so where
 * `on` tells which starts are on the surface. */
static bool sides_of_hits(sgt_surface s)
{
    const double *const nowhere[3] = {NULL, NULL, NULL};
    double on[1] = {0};
    return known_on(s, 0, nowhere, on);
}

/* A start that `leave` has an answer for, with its side. */
static bool leave_answers(sgt_surface s, const sgt_start *from, const sgt_options *opt, sgt_crossing *out)
{
    sgt_status status[1] = {SGT_HARD};
    double behind[1] = {0}, t_tol[1] = {0}, to[10];
    int evals[1] = {0};
    if (!asks_leave(s, opt) || !start_sound(from) || sides_of_hits(s)) return false;
    const sgt_ray ray = ray_from(from, from->p);
    const sgt_tile one = {.n = 1,
                          .rays = rays_of(&ray),
                          .t_tol = t_tol,
                          .hits = {.status = status,
                                   .evals = evals,
                                   .t = to,
                                   .t_err = to + 1,
                                   .t_lo = to + 2,
                                   .p = {to + 3, to + 4, to + 5},
                                   .n = {to + 6, to + 7, to + 8},
                                   .p_err = to + 9}};
    s.ops->own_->leave(s.self, &one, behind);
    if (status[0] == SGT_HARD) return false;
    *out = (sgt_crossing){.ray = ray, .side = (signed char)behind[0]};
    if (status[0] == SGT_MISS) {
        out->hit = hit_without(SGT_MISS, &ray, evals[0]);
        return true;
    }
    const meeting at = {.t = to[0], .t_err = to[1], .t_lo = to[2], .p_err = to[9], .p = {to[3], to[4], to[5]},
                        .n = {to[6], to[7], to[8]}};
    out->hit = hit_found(status[0], evals[0], s.ops->value(s.self, at.p, NULL), &at);
    return true;
}

sgt_crossing sgt_leave(sgt_surface s, const sgt_start *from, const sgt_options *opt)
{
    sgt_crossing out = {.side = 0};
    sgt_options own = first_of(opt);
    s = in_set(s);
    if (ROOM_IS_ZERO(from) && leave_answers(s, from, &own, &out)) return out;
    place at = place_to_leave(s, from);
    out.ray = ray_from(from, at.o);
    out.hit = sgt_intersect(s, out.ray, ROOM_IS_ZERO(from) ? &own : &sgt_options_invalid);
    if (out.hit.status == SGT_INVALID) return out;
    met_behind(s, from, at.on, &own, &out.ray, &out.hit);
    const bool sharp = !(own.t_tol > 0);
    if (skipped(s, &out.ray, at.on, sharp, &out.hit))
        out.hit = hit_undecided(SGT_UNPROVEN, &out.ray, out.hit.evals, 0, out.hit.t);
    asked a;
    signed char side;
    a.count = 0;
    side = side_told(s, from, &out.ray, at.on, sharp, &out.hit, 0, &a);
    answer_sides(s, &a, &side);
    out.side = side;
    return out;
}

static sgt_vec3 leave_vector(const double *const a[3], size_t i)
{
    return (sgt_vec3){a[0][i], a[1][i], a[2][i]};
}

static sgt_start start_of(const sgt_starts *from, size_t i)
{
    return (sgt_start){.p = leave_vector(from->p, i),
                       .n = from->n[0] ? leave_vector(from->n, i) : (sgt_vec3){0, 0, 0},
                       .p_err = from->p_err ? from->p_err[i] : 0,
                       .d = leave_vector(from->d, i),
                       .tmax = from->tmax ? from->tmax[i] : 0};
}

static double *leave_from(double *a, size_t i) { return a ? a + i : NULL; }

/* What the batch below keeps of a tile. */
typedef struct leaving {
    double o[3][SGT_MOST_TILE], n[3][SGT_MOST_TILE], t[SGT_MOST_TILE], tmax[SGT_MOST_TILE];
    sgt_status status[SGT_MOST_TILE];
    signed char side[SGT_MOST_TILE];
    bool on[SGT_MOST_TILE];
} leaving;

/* Sets a row of 1 and 0 to 1 where start_sound and surely_on say so of a start; what is 1 stays 1.  Returns
 * how many are 1 then. */
SGT_KERNEL
static double surely_all(size_t n, const double *const at[3], const double *const grad_of[3],
                         const double *p_err, double *restrict sure)
{
    const double *px = at[0], *py = at[1], *pz = at[2], *nx = grad_of[0], *ny = grad_of[1], *nz = grad_of[2];
    double count = 0;
    _Pragma("omp simd reduction(+ : count)") for (size_t i = 0; i < n; i++) {
        sgt_vec3 p = {px[i], py[i], pz[i]}, grad = {nx[i], ny[i], nz[i]};
        double is = ((int)sound_at(p, p_err[i]) & (int)surely_on(p, grad, p_err[i])) ? 1.0 : sure[i];
        sure[i] = is, count += is;
    }
    return count;
}

/* Sets a row of surely_all to 1 where is_on says so.  Returns how many are 1 then. */
SGT_KERNEL
static double on_all(size_t n, const double *const at[3], const double *p_err, const double *f,
                     const double *const grad_of[3], double *restrict sure)
{
    const double *px = at[0], *py = at[1], *pz = at[2], *nx = grad_of[0], *ny = grad_of[1], *nz = grad_of[2];
    double count = 0;
    _Pragma("omp simd reduction(+ : count)") for (size_t i = 0; i < n; i++) {
        sgt_vec3 p = {px[i], py[i], pz[i]};
        bool on = (int)sound_at(p, p_err[i]) & (int)is_on(f[i], p, (sgt_vec3){nx[i], ny[i], nz[i]});
        double is = on ? 1.0 : sure[i];
        sure[i] = is, count += is;
    }
    return count;
}

/* F, its gradient and the bound on its rounding at n points.  false: not known of all at once. */
static bool leave_rounded(sgt_surface s, size_t n, const double *const p[3], double *f, double *const grad[3],
                          double *own)
{
    const struct sgt_builtin_ops *with = s.ops->own_;
    return with && with->values_rounded && !with->share &&
           with->values_rounded(s.self, NULL, NULL, n, (sgt_points){{p[0], p[1], p[2]}},
                                (sgt_values){f, {grad[0], grad[1], grad[2]}}, own);
}

/* F and its gradient at n points, ASKS at most. */
static void leave_values(sgt_surface s, size_t n, const double *const p[3], double *f, double *const grad[3])
{
    double own[ASKS];
    if (s.ops->values) {
        s.ops->values(s.self, n, (sgt_points){{p[0], p[1], p[2]}},
                      (sgt_values){f, {grad[0], grad[1], grad[2]}});
        return;
    }
    if (leave_rounded(s, n, p, f, grad, own)) return;
    for (size_t k = 0; k < n; k++) {
        sgt_vec3 m = {0, 0, 0};
        f[k] = s.ops->value(s.self, (sgt_vec3){p[0][k], p[1][k], p[2][k]}, &m);
        grad[0][k] = m.x, grad[1][k] = m.y, grad[2][k] = m.z;
    }
}

/* The starts of at most ASKS rays, from number i of a tile on, whose p are in w->o.  F is asked of all
 * together. */
static void places(sgt_surface s, size_t n, const sgt_starts *from, size_t at, leaving *w, size_t i)
{
    double sure[ASKS], p_err[ASKS], f[ASKS], grad[3][ASKS], known = 0;
    double *const p[3] = {w->o[0] + i, w->o[1] + i, w->o[2] + i};
    double *const there[3] = {grad[0], grad[1], grad[2]};
    const double *const at_all[3] = {p[0], p[1], p[2]};
    const double *const *const m = from->n;
    bool many = asked_of(s);
    for (size_t k = 0; k < n; k++) { /* F is not asked for where a start makes no sense */
        p_err[k] = from->p_err ? from->p_err[at + i + k] : 0;
        if (sound_at((sgt_vec3){p[0][k], p[1][k], p[2][k]}, p_err[k])) continue;
        p[0][k] = p[1][k] = p[2][k] = 0, p_err[k] = (double)NAN;
    }
    memset(sure, 0, sizeof sure);
    if (many && known_on(s, n, at_all, sure))
        for (size_t k = 0; k < n; k++) sure[k] = p_err[k] >= 0 ? sure[k] : 0, known += sure[k]; /* not NaN */
    if (known < (double)n && m[0] && many)
        known = surely_all(n, at_all, (const double *const[3]){m[0] + at + i, m[1] + at + i, m[2] + at + i},
                           p_err, sure);
    if (known < (double)n && many) {
        leave_values(s, n, at_all, f, there);
        known = on_all(n, at_all, p_err, f, (const double *const[3]){grad[0], grad[1], grad[2]}, sure);
    }
    memset(w->on + i, true, n * sizeof *w->on);
    for (size_t k = 0; k < n && known < (double)n; k++) {
        if (sure[k] > 0) continue;
        sgt_start start = start_of(from, at + i + k);
        sgt_vec3 normal = {grad[0][k], grad[1][k], grad[2][k]};
        place here = many && start_sound(&start) ? polished(s, start.p, f[k], normal, p_err[k])
                                                 : place_to_leave(s, &start);
        sgt_vec3 o = ray_from(&start, here.o).o;
        w->on[i + k] = here.on, p[0][k] = o.x, p[1][k] = o.y, p[2][k] = o.z;
    }
}

/* Statuses as numbers, ASKS at most.  Two loops: of bytes and doubles in one no vector code is made. */
SGT_KERNEL
static void states_of(size_t n, const sgt_status *status, double *restrict state)
{
    int wide[ASKS];
    LANES for (size_t i = 0; i < n; i++) wide[i] = status[i];
    LANES for (size_t i = 0; i < n; i++) state[i] = wide[i];
}

/* The side where the hit alone tells it, as side_told has it; else OPEN.  The hit is certainly not the start
 * again (past_start_again). */
static const double OPEN = 2;

SGT_KERNEL
static void sides_by_hit(size_t n, const double *const p[3], const double *const grad[3],
                         const double *const d[3], const double *p_err, const double *t, const double *state,
                         double *restrict side)
{
    const double *px = p[0], *py = p[1], *pz = p[2], *nx = grad[0], *ny = grad[1], *nz = grad[2], *dx = d[0],
                 *dy = d[1], *dz = d[2];
    LANES for (size_t i = 0; i < n; i++) {
        sgt_vec3 m = {nx[i], ny[i], nz[i]}, way = {dx[i], dy[i], dz[i]};
        double slope = leave_dot(m, way),
               most = p_err[i] + 4 * SGT_U * leave_size((sgt_vec3){px[i], py[i], pz[i]});
        double flat = 0x1p-30 * leave_size(m) * leave_size(way);
        mask told = MASK(state[i] == SGT_HIT) & MASK(fabs(slope) > flat) &
                    MASK(t[i] * fabs(slope) > most * sqrt(leave_dot(m, m)));
        side[i] = chosen(told, chosen(MASK(slope > 0), -1, 1), OPEN);
    }
}

/* The first looks of answer_sides, of starts that miss.  p: where; asks: 0 (and p is 0) where
 * look_again has to ask. */
SGT_KERNEL
static void looks_at(size_t n, const sgt_rays *rays, const double *const grad[3], const double *state,
                     double *restrict px, double *restrict py, double *restrict pz, double *restrict asks)
{
    const double *ox = rays->o[0], *oy = rays->o[1], *oz = rays->o[2], *dx = rays->d[0], *dy = rays->d[1],
                 *dz = rays->d[2], *tmax = rays->tmax, *nx = grad[0], *ny = grad[1], *nz = grad[2];
    LANES for (size_t i = 0; i < n; i++) {
        sgt_vec3 o = {ox[i], oy[i], oz[i]}, d = {dx[i], dy[i], dz[i]}, m = {nx[i], ny[i], nz[i]};
        double t = first_look(o, d, m, far_of(o, d));
        mask told = MASK(state[i] == SGT_MISS) & MASK(leave_size(m) > 0) & MASK(leave_finite(m)) &
                    MASK(t > 0);
        t = t < tmax[i] ? t : tmax[i];
        px[i] = chosen(told, moved_along(o.x, t, d.x), 0), py[i] = chosen(told, moved_along(o.y, t, d.y), 0),
        pz[i] = chosen(told, moved_along(o.z, t, d.z), 0), asks[i] = chosen(told, 1, 0);
    }
}

/* What has been looked at: points, F there, its gradient, its own rounding, and whether it was asked for. */
typedef struct looks {
    double p[3][ASKS], f[ASKS], grad[3][ASKS], own[ASKS], asks[ASKS];
} looks;

SGT_KERNEL
static void sides_by_look(size_t n, const looks *at, const double *const way[3], double agree,
                          double *restrict side)
{
    const double *px = at->p[0], *py = at->p[1], *pz = at->p[2], *nx = at->grad[0], *ny = at->grad[1],
                 *nz = at->grad[2], *dx = way[0], *dy = way[1], *dz = way[2], *f = at->f, *own = at->own,
                 *asks = at->asks;
    LANES for (size_t i = 0; i < n; i++) {
        sgt_vec3 m = {nx[i], ny[i], nz[i]}, d = {dx[i], dy[i], dz[i]};
        double err = look_error(own[i], (sgt_vec3){px[i], py[i], pz[i]}, m),
               by_slope = slope_sign(m, d, 0x1p-20);
        double lo = f[i] - err, hi = f[i] + err, there = chosen(MASK(lo > 0), 1, -1);
        mask told = MASK(asks[i] > 0) & MASK(lo <= hi) & (MASK(lo > 0) | MASK(hi < 0)) &
                    (MASK(agree == 0) | MASK(there == by_slope));
        side[i] = chosen(told, there, side[i]);
    }
}

/* What a sag shares, once it has been asked for. */
typedef struct leave_shared { bool known; sgt_shared of; } leave_shared;

static const sgt_shared *leave_shares(sgt_surface s, leave_shared *shared)
{
    if (!shared->known) s.ops->own_->share(s.self, &shared->of), shared->of = bare_of(shared->of);
    shared->known = true;
    return &shared->of;
}

/* Bounds on the rounding of F at n points of a sag with a departure, by one bound on what the departure adds
 * within the radius that holds them all.  They are made twice as wide: so a single ray, which asks at its own
 * point, is not less certain.  false: not known. */
static bool leave_roundings(sgt_surface s, size_t n, double *const p[3], const double *f, double *own,
                            leave_shared *shared)
{
    const struct sgt_builtin_ops *with = s.ops->own_;
    double r2 = 0, e[2];
    if (n < 8 || !with->roundings || !with->share || !with->noise_within) return false;
    for (size_t k = 0; k < n; k++) r2 = larger(r2, p[0][k] * p[0][k] + p[1][k] * p[1][k]);
    leave_shares(s, shared);
    with->noise_within(s.self, sqrt(r2) * (1 + 0x1p-20), e);
    sgt_shared here = shared->of;
    here.noise[0] = e[0], here.noise[1] = e[1];
    if (!with->roundings(s.self, &here, n, (sgt_points){{p[0], p[1], p[2]}}, f, own)) return false;
    for (size_t k = 0; k < n; k++) own[k] *= 2;
    return true;
}

/* Sides of n starts that miss: as many of them as the first look tells. */
static void sides_of_misses(sgt_surface s, size_t n, const sgt_rays *rays, const double *const grad[3],
                            const double *state, double *side, leave_shared *shared)
{
    looks w;
    double(*p)[ASKS] = w.p, *own = w.own;
    const double *const at[3] = {p[0], p[1], p[2]};
    double *const out[3] = {w.grad[0], w.grad[1], w.grad[2]};
    bool body = is_body(s.ops);
    looks_at(n, rays, grad, state, p[0], p[1], p[2], w.asks);
    bool known = leave_rounded(s, n, at, w.f, out, own);
    if (!known) leave_values(s, n, at, w.f, out);
    if (!known && body) {
        s.ops->own_->roundings(s.self, NULL, n, (sgt_points){{p[0], p[1], p[2]}}, w.f, own);
        known = true;
    }
    known = known || leave_roundings(s, n, (double *const[3]){p[0], p[1], p[2]}, w.f, own, shared);
    for (size_t k = 0; k < n && !known; k++)
        own[k] = w.asks[k] > 0 ? s.ops->rounding(s.self, (sgt_vec3){p[0][k], p[1][k], p[2][k]}) : 0;
    sides_by_look(n, &w, rays->d, body ? 0 : 1, side);
}

/* Sides of starts that miss, by the bound on the slope.  Returns how many of these are still open. */
SGT_KERNEL
static double sides_if_steep(size_t n, const sgt_rays *rays, const double *state, const sgt_shared *shared,
                             double *restrict side)
{
    const double *ox = rays->o[0], *oy = rays->o[1], *dx = rays->d[0], *dy = rays->d[1], *dz = rays->d[2],
                 steep = shared->steep, rim2 = shared->radius2;
    double open = 0;
    _Pragma("omp simd reduction(+ : open)") for (size_t i = 0; i < n; i++)
    {
        double is = steep_side(steep, rim2, (sgt_vec3){ox[i], oy[i], 0}, (sgt_vec3){dx[i], dy[i], dz[i]});
        mask missed = MASK(state[i] == SGT_MISS);
        side[i] = chosen(missed & MASK(is != 0), is, side[i]);
        open += chosen(missed & MASK(is == 0), 1, 0);
    }
    return open;
}

/* Sides of n starts on a sag that miss: by its slope, and of the others, side by side, by a look. */
SGT_NOINLINE
static void sides_of_sag(sgt_surface s, size_t n, const sgt_rays *rays, const double *const grad[3],
                         const double *state, double *side, leave_shared *shared)
{
    double row[10][ASKS], missed[ASKS] = {0}, told[ASKS];
    const double *const of[10] = {rays->o[0], rays->o[1], rays->o[2], rays->d[0], rays->d[1],
                                  rays->d[2], rays->tmax, grad[0],    grad[1],    grad[2]};
    unsigned char number[ASKS];
    size_t open = 0;
    if (sides_if_steep(n, rays, state, leave_shares(s, shared), side) == 0) return;
    for (size_t i = 0; i < n; i++)
        if (state[i] == SGT_MISS && side[i] == OPEN) number[open++] = (unsigned char)i;
    for (int k = 0; k < 10; k++)
        for (size_t j = 0; j < open; j++) row[k][j] = of[k][number[j]];
    for (size_t j = 0; j < open; j++) missed[j] = SGT_MISS, told[j] = OPEN;
    const sgt_rays some = {.o = {row[0], row[1], row[2]}, .d = {row[3], row[4], row[5]}, .tmax = row[6]};
    sides_of_misses(s, open, &some, (const double *const[3]){row[7], row[8], row[9]}, missed, told, shared);
    for (size_t j = 0; j < open; j++) side[number[j]] = told[j];
}

/* Are there enough of these to be looked at together? */
static bool looked_at(sgt_surface s, size_t n, const double *state, const bool *on)
{
    size_t misses = 0;
    bool early = looks_early(s.ops);
    for (size_t i = 0; i < n; i++) early = early && on[i];
    if (!(is_body(s.ops) || early) || !asked_of(s)) return false;
    for (size_t i = 0; i < n; i++) misses += state[i] == SGT_MISS;
    return 8 * misses > n;
}

/* A tile: its starts from number `at` of the batch on, and where its answers are. */
typedef struct left_tile {
    sgt_surface s;
    const sgt_starts *from;
    size_t at;
    const sgt_rays *rays;
    const sgt_hits *own;
    leaving *w;
    const sgt_options *opt;
    bool sides;
    asked *a;
} left_tile;

/* The ray of number i of a tile once more, where its hit alone does not tell all.  Returns by how much there
 * are more hits. */
static int look_again(const left_tile *j, size_t i)
{
    const sgt_surface s = j->s;
    const sgt_hits *own = j->own;
    const sgt_options *opt = j->opt;
    const bool sharp = !(opt->t_tol > 0);
    leaving *w = j->w;
    asked *a = j->a;
    sgt_start start = start_of(j->from, j->at + i);
    sgt_ray ray = ray_of(j->rays, i);
    sgt_hit hit = {.status = w->status[i],
                   .evals = own->evals ? own->evals[i] : 0,
                   .t = w->t[i],
                   .n = {w->n[0][i], w->n[1][i], w->n[2][i]}};
    int was = hit.status > 0;
    if (met_behind(s, &start, w->on[i], opt, &ray, &hit)) put_hit(own, i, &hit);
    if (hit.status != SGT_INVALID && skipped(s, &ray, w->on[i], sharp, &hit)) {
        hit = hit_without(SGT_UNPROVEN, &ray, hit.evals);
        put_hit(own, i, &hit);
    }
    if (j->sides) w->side[i] = side_told(s, &start, &ray, w->on[i], sharp, &hit, i, a);
    if (a->count == ASKS) answer_sides(s, a, w->side);
    return (hit.status > 0) - was;
}

/* The rays from number `at` of the batch on. */
static size_t leave_tile(sgt_surface s, size_t n, const sgt_starts *from, size_t at, const sgt_hits *hits,
                         signed char *side, const sgt_options *opt)
{
    leaving w;
    for (int k = 0; k < 3; k++) memcpy(w.o[k], from->p[k] + at, n * sizeof *w.o[k]);
    for (size_t i = 0; i < n; i++) w.tmax[i] = HUGE_VAL;
    for (size_t i = 0; i < n && from->tmax; i++) w.tmax[i] = leave_end(from->tmax[at + i]);
    for (size_t i = 0; i < n; i += ASKS) places(s, n - i < ASKS ? n - i : ASKS, from, at, &w, i);
    sgt_rays rays = {.o = {w.o[0], w.o[1], w.o[2]},
                     .d = {from->d[0] + at, from->d[1] + at, from->d[2] + at},
                     .tmax = w.tmax};
    sgt_hits own = {.status = w.status,
                    .evals = hits->evals ? hits->evals + at : NULL,
                    .t = w.t,
                    .t_err = leave_from(hits->t_err, at),
                    .t_lo = leave_from(hits->t_lo, at),
                    .p = {leave_from(hits->p[0], at), leave_from(hits->p[1], at), leave_from(hits->p[2], at)},
                    .n = {w.n[0], w.n[1], w.n[2]},
                    .p_err = leave_from(hits->p_err, at)};
    size_t met = sgt_intersect_batch(s, n, rays, own, opt);
    /* where a march may have skipped roots, or a hit may lie beside its root, no hit tells all */
    const bool by_hit = !(opt->t_tol > 0) && s.ops && (s.ops->own_ || s.ops->enclose);
    double state[ASKS], told[ASKS], behind[ASKS], none[ASKS] = {0};
    asked a;
    leave_shared shared;
    shared.known = false;
    a.count = 0;
    const left_tile job = {s, from, at, &rays, &own, &w, opt, side != NULL, &a};
    for (size_t i = 0, few; i < n; i += few) {
        few = n - i < ASKS ? n - i : ASKS;
        const double *const p[3] = {from->p[0] + at + i, from->p[1] + at + i, from->p[2] + at + i},
                            *const grad[3] = {w.n[0] + i, w.n[1] + i, w.n[2] + i},
                            *const d[3] = {rays.d[0] + i, rays.d[1] + i, rays.d[2] + i};
        if (by_hit) {
            states_of(few, w.status + i, state);
            sides_by_hit(few, p, grad, d, from->p_err ? from->p_err + at + i : none, w.t + i, state, told);
            sgt_rays part = rays_from(&rays, i);
            part.tmax = w.tmax + i;
            if (side && sides_behind(s, few, &part, behind)) {
                for (size_t j = 0; j < few; j++)
                    if (!w.on[i + j]) behind[j] = 0;
                LANES for (size_t j = 0; j < few; j++) told[j] =
                    chosen(MASK(state[j] == SGT_MISS) & MASK(behind[j] != 0), behind[j], told[j]);
            } else if (side && from->n[0] && looked_at(s, few, state, w.on + i)) {
                const double *const first[3] = {from->n[0] + at + i, from->n[1] + at + i,
                                                from->n[2] + at + i};
                (knows_steep(s) ? sides_of_sag : sides_of_misses)(s, few, &part, first, state, told, &shared);
            }
        }
        for (size_t j = 0; j < few; j++) {
            if (by_hit && told[j] != OPEN) w.side[i + j] = (signed char)told[j];
            else
                met += (size_t)look_again(&job, i + j);
        }
    }
    if (side) answer_sides(s, &a, w.side), memcpy(side + at, w.side, n);
    if (hits->status) memcpy(hits->status + at, w.status, n * sizeof *w.status);
    if (hits->t) memcpy(hits->t + at, w.t, n * sizeof *w.t);
    for (int k = 0; k < 3 && hits->n[0]; k++) memcpy(hits->n[k] + at, w.n[k], n * sizeof *w.n[k]);
    return met;
}

/* Ends as leave_end has them; NaN where p_err is not sound, so that no ray is met or missed there. */
SGT_KERNEL
static void leave_ends(size_t n, const double *p_err, const double *given, double *restrict tmax)
{
    if (!given) LANES for (size_t i = 0; i < n; i++) tmax[i] = HUGE_VAL;
    for (size_t i = 0; given && i < n; i++) tmax[i] = leave_end(given[i]);
    if (p_err)
        LANES for (size_t i = 0; i < n; i++) tmax[i] =
            chosen(MASK(p_err[i] >= 0) & MASK(p_err[i] < HUGE_VAL), tmax[i], (double)NAN);
}

/* Starts of a tile that have no answer yet, side by side.  Returns how many are met. */
SGT_NOINLINE static size_t leave_others(sgt_surface s, size_t n, const sgt_starts *from, size_t at,
                                        const sgt_hits *to, signed char *side, const sgt_options *opt)
{
    double in[11][SGT_TILE], out[10][SGT_TILE];
    int evals[SGT_TILE];
    sgt_status status[SGT_TILE];
    signed char sides[SGT_TILE];
    unsigned char number[SGT_TILE];
    size_t few = 0;
    for (size_t i = 0; i < n; i++) {
        if (to->status[i] != SGT_HARD) continue;
        const sgt_start one = start_of(from, at + i);
        const double row[11] = {one.p.x, one.p.y, one.p.z,   one.n.x, one.n.y, one.n.z,
                                one.d.x, one.d.y, one.d.z, one.p_err, one.tmax};
        for (int k = 0; k < 11; k++) in[k][few] = row[k];
        number[few++] = (unsigned char)i;
    }
    const sgt_starts others = {.p = {in[0], in[1], in[2]},
                               .n = {from->n[0] ? in[3] : NULL, in[4], in[5]},
                               .d = {in[6], in[7], in[8]},
                               .p_err = in[9],
                               .tmax = in[10]};
    const sgt_hits found = {.status = status,
                            .evals = evals,
                            .t = out[0],
                            .t_err = out[1],
                            .t_lo = out[2],
                            .p = {out[3], out[4], out[5]},
                            .n = {out[6], out[7], out[8]},
                            .p_err = out[9]};
    const size_t met = leave_tile(s, few, &others, 0, &found, sides, opt);
    for (size_t j = 0; j < few; j++) {
        const sgt_hit hit = {.status = status[j], .evals = evals[j], .t = out[0][j], .t_err = out[1][j],
                             .t_lo = out[2][j],   .p = {out[3][j], out[4][j], out[5][j]},
                             .n = {out[6][j], out[7][j], out[8][j]}, .p_err = out[9][j]};
        put_hit(to, number[j], &hit);
        if (side) side[at + number[j]] = sides[j];
    }
    return met;
}

/* Of starts on a conic that meet it again, which hits tell the side, as side_told has it?  told: OPEN for the
 * others.  (The slopes of a start and of the other root have unlike signs: the hit is not the start again.)
 * known: how many do; open: how many others do not miss. */
SGT_KERNEL
static void sides_known(size_t n, const double *const grad[3], const double *const d[3], const double *state,
                        double *restrict told, double *restrict side, double *known, double *open)
{
    const double *nx = grad[0], *ny = grad[1], *nz = grad[2], *dx = d[0], *dy = d[1], *dz = d[2];
    double hits = 0, others = 0;
    _Pragma("omp simd reduction(+ : hits, others)") for (size_t i = 0; i < n; i++)
    {
        sgt_vec3 m = {nx[i], ny[i], nz[i]}, way = {dx[i], dy[i], dz[i]};
        double slope = leave_dot(m, way);
        double flat = 0x1p-30 * leave_size(m) * leave_size(way);
        const mask is = MASK(state[i] == SGT_HIT) & MASK(fabs(slope) > flat);
        told[i] = chosen(is, 0, OPEN), side[i] = chosen(is, chosen(MASK(slope > 0), -1, 1), side[i]);
        hits += chosen(is, 1, 0), others += chosen(is | MASK(state[i] == SGT_MISS), 0, 1);
    }
    *known = hits, *open = others;
}

/* Sides as bytes: two loops, as in states_of. */
SGT_KERNEL
static void bytes_of(size_t n, const double *of, signed char *restrict to)
{
    int wide[SGT_TILE];
    LANES for (size_t i = 0; i < n; i++) wide[i] = (int)of[i];
    LANES for (size_t i = 0; i < n; i++) to[i] = (signed char)wide[i];
}

/* A tile of starts of which the surface itself answers some.  Returns false, and answers nothing, if there
 * are none; else the others are asked side by side, or one by one if they are few. */
SGT_NOINLINE static bool leave_known(sgt_surface s, size_t n, const sgt_starts *from, size_t at,
                                     const sgt_hits *hits, signed char *side, const sgt_options *opt,
                                     size_t *met)
{
    static const double none[SGT_TILE];
    double tmax[SGT_TILE], behind[SGT_TILE], state[SGT_TILE], own[4][SGT_TILE];
    sgt_status status[SGT_TILE];
    const double *p_err = from->p_err ? from->p_err + at : NULL;
    sgt_tile tile = {.n = n,
                     .rays = {.o = {from->p[0] + at, from->p[1] + at, from->p[2] + at},
                              .d = {from->d[0] + at, from->d[1] + at, from->d[2] + at},
                              .tmin = none,
                              .tmax = tmax},
                     .t_tol = none,
                     .hits = hits_from(hits, at)};
    sgt_hits *to = &tile.hits;
    const bool normals = to->n[0];
    leave_ends(n, p_err, from->tmax ? from->tmax + at : NULL, tmax);
    if (!to->status) to->status = status;
    if (!to->t) to->t = own[0];
    for (int k = 0; k < 3 && !normals; k++) to->n[k] = own[k + 1];
    const size_t hard = s.ops->own_->leave(s.self, &tile, behind);
    if (hard == n) return false;
    if (to->status[0] == SGT_MISS && memcmp(to->status, to->status + 1, n - 1) == 0) {
        if (side) bytes_of(n, behind, side + at);
        return true;
    }
    const bool together = 8 * hard > n, own_sides = !sides_of_hits(s);
    double *told = tmax; /* not read any more */
    double known = 0, open = (double)hard;
    if (own_sides) {
        for (size_t i = 0; i < n; i++) known += to->status[i] > 0;
        for (size_t i = 0; hard > 0 && i < n; i++) told[i] = to->status[i] == SGT_HARD ? OPEN : 0;
    } else {
        for (size_t i = 0; i < n; i += ASKS)
            states_of(n - i < ASKS ? n - i : ASKS, to->status + i, state + i);
        sides_known(n, (const double *const[3]){to->n[0], to->n[1], to->n[2]}, tile.rays.d, state, told,
                    behind, &known, &open);
    }
    *met += (size_t)known;
    if (side) bytes_of(n, behind, side + at);
    for (size_t i = 0; open != 0 && i < n; i++) {
        if (told[i] != OPEN || to->status[i] == SGT_MISS || (together && to->status[i] == SGT_HARD)) continue;
        const sgt_start start = start_of(from, at + i);
        const sgt_crossing c = sgt_leave(s, &start, opt);
        *met += c.hit.status > 0;
        put_hit(to, i, &c.hit);
        if (side) side[at + i] = (signed char)c.side;
    }
    if (together) *met += leave_others(s, n, from, at, to, side, opt);
    return true;
}

size_t sgt_leave_batch(sgt_surface s, size_t n, sgt_starts from, sgt_hits hits, signed char *side,
                       const sgt_options *opt)
{
    sgt_options own = first_of(opt);
    numbered told = {own.watch, own.watch_data, 0};
    size_t met = 0;
    s = in_set(s);
    if (!ROOM_IS_ZERO(&from) || !ROOM_IS_ZERO(&hits)) own = sgt_options_invalid, own.watch = NULL;
    if (!own.watch) {
        const bool known = asks_leave(s, &own);
        const size_t most = known ? SGT_TILE : SGT_MOST_TILE;
        for (size_t i = 0, some; i < n; i += some) {
            some = n - i < most ? n - i : most;
            if (!known || !leave_known(s, some, &from, i, &hits, side, &own, &met))
                met += leave_tile(s, some, &from, i, &hits, side, &own);
        }
        return met;
    }
    own.watch = sgt_watch_numbered, own.watch_data = &told;
    for (size_t i = 0; i < n; i++) {
        sgt_start start = start_of(&from, i);
        told.ray = i;
        sgt_crossing c = sgt_leave(s, &start, &own);
        put_hit(&hits, i, &c.hit);
        if (side) side[i] = (signed char)c.side;
        met += c.hit.status > 0;
    }
    return met;
}
