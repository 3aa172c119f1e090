// SPDX-License-Identifier: MIT
/* builtin.h - what a built-in surface can do that a user's surface cannot.
 *
 * There are two kinds of built-in surface:
 * - With `meet` the surface answers by itself, through `meet`, `all`, `lanes` and `unique`.  It returns
 *   SGT_INVALID if one of its parameters is invalid.  The caller has already checked the options and made
 *   tmax explicit, and but for `meet` and `lanes` checked the ray.
 * - Without `meet` the surface is met by its operations (sgt_surface_ops), as a user's surface is.  Here it
 *   adds what those operations cannot say.  `object` is then required; everything else is optional.
 *
 * self points to the parameters of the surface.  A member that is NULL is not offered. */
#ifndef SGT_SURFACE_BUILTIN_H
#define SGT_SURFACE_BUILTIN_H

#include "../solve/entries.h"

#include <math.h>
#include <stddef.h>
#include <string.h>
#include <sagitta/sagitta.h>
#include <sagitta/surfaces.h>

/* A tile: some consecutive rays of a batch.  n is at most SGT_TILE, or the surface's own `tile`.  Each
 * array starts at the first ray of the tile.  No array of `rays` is NULL, and tmax is explicit.  Of `hits`
 * only `status` is never NULL.  t_tol holds one tolerance for each ray. */
enum { SGT_TILE = 128, SGT_MOST_TILE = 512, SGT_NOT_UNIQUE = 1, SGT_FAR = 16384 };
#define SGT_HARD ((sgt_status)-100)
/* memo: what the tiles of one batch share (ray/vicinity.h); NULL where sgt_intersect_tile is called.
 * slopes: the same, but of all tiles of a trace; NULL: nothing is kept for them.
 * whole: each ray is known to be a whole line, with the ends -inf and inf, and each t_tol to be finite.
 * far: the arrays of the batch are too long for the second cache; only the time depends on it. */
struct memo;
struct slopes;
typedef struct sgt_tile {
    size_t n;
    sgt_rays rays;
    const double *t_tol;
    sgt_hits hits;
    struct memo *memo;
    struct slopes *slopes;
    bool whole, far;
} sgt_tile;

/* One ray as a batch of one. */
SGT_INLINE sgt_rays rays_of(const sgt_ray *ray)
{
    return (sgt_rays){
        {&ray->o.x, &ray->o.y, &ray->o.z}, {&ray->d.x, &ray->d.y, &ray->d.z}, &ray->tmin, &ray->tmax};
}

/* o and d from the i-th ray on; tmin and tmax are left out. */
SGT_INLINE sgt_rays rays_from(const sgt_rays *r, size_t i)
{
    return (sgt_rays){.o = {r->o[0] + i, r->o[1] + i, r->o[2] + i},
                      .d = {r->d[0] + i, r->d[1] + i, r->d[2] + i}};
}

/* The arrays from their i-th entry on. */
SGT_INLINE double *row_from(double *a, size_t i) { return a ? a + i : NULL; }

SGT_INLINE sgt_hits hits_from(const sgt_hits *h, size_t i)
{
    return (sgt_hits){.status = h->status ? h->status + i : NULL,
                      .evals = h->evals ? h->evals + i : NULL,
                      .t = row_from(h->t, i),
                      .t_err = row_from(h->t_err, i),
                      .t_lo = row_from(h->t_lo, i),
                      .p_err = row_from(h->p_err, i),
                      .p = {row_from(h->p[0], i), row_from(h->p[1], i), row_from(h->p[2], i)},
                      .n = {row_from(h->n[0], i), row_from(h->n[1], i), row_from(h->n[2], i)}};
}

/* n rays of the tile, from the i-th on. */
SGT_INLINE sgt_tile tile_part(const sgt_tile *tile, size_t i, size_t n)
{
    sgt_tile part = *tile;
    part.n = n, part.t_tol += i, part.hits = hits_from(&tile->hits, i), part.rays = rays_from(&tile->rays, i);
    part.rays.tmin = tile->rays.tmin + i, part.rays.tmax = tile->rays.tmax + i;
    return part;
}

/* DEFAULT ENDS.  A ray with ends of all bits zero, as {0} leaves them, has no end (sgt_ray).  An end of 0
 * that was given, in a batch or to sgt_ray_between, is stored as -0: the same number, and not the default. */
SGT_INLINE double given_end(double tmax) { return tmax == 0 ? -0.0 : tmax; }

/* Does the ray have no end? */
SGT_INLINE bool has_default_ends(const sgt_ray *ray)
{
    unsigned long long lo, hi;
    memcpy(&lo, &ray->tmin, sizeof lo), memcpy(&hi, &ray->tmax, sizeof hi);
    return (lo | hi) == 0;
}

/* The tmax that is meant. */
SGT_INLINE double explicit_end(const sgt_ray *ray) { return has_default_ends(ray) ? HUGE_VAL : ray->tmax; }

/* 0 if all three are finite, else NaN: x - x is 0 for a finite x and NaN for any other.  So one comparison
 * tests all of them. */
SGT_INLINE double not_finite(sgt_vec3 v) { return (v.x - v.x) + (v.y - v.y) + (v.z - v.z); }

/* Is the ray valid, as sgt_ray and SGT_INVALID of sagitta.h say?  Its ends are explicit (explicit_end). */
SGT_INLINE bool ray_valid(const sgt_ray *ray)
{
    double big = larger(fabs(ray->d.x), larger(fabs(ray->d.y), fabs(ray->d.z)));
    bool ends = (ray->tmin <= ray->tmax) & (ray->tmax > -HUGE_VAL);
    return (not_finite(ray->o) + not_finite(ray->d) == 0) & (big >= DBL_MIN) & ends & (ray->tmin < HUGE_VAL);
}

SGT_INLINE sgt_ray ray_of(const sgt_rays *r, size_t i)
{
    return (sgt_ray){{r->o[0][i], r->o[1][i], r->o[2][i]}, {r->d[0][i], r->d[1][i], r->d[2][i]},
                     r->tmin ? r->tmin[i] : 0, r->tmax ? given_end(r->tmax[i]) : HUGE_VAL};
}

/* Writes what is wanted of the hit of ray i. */
SGT_INLINE void put_hit(const sgt_hits *out, size_t i, const sgt_hit *hit)
{
    if (out->status) out->status[i] = hit->status;
    if (out->evals) out->evals[i] = hit->evals;
    if (out->t) out->t[i] = hit->t;
    if (out->t_err) out->t_err[i] = hit->t_err;
    if (out->t_lo) out->t_lo[i] = hit->t_lo;
    if (out->p[0]) out->p[0][i] = hit->p.x, out->p[1][i] = hit->p.y, out->p[2][i] = hit->p.z;
    if (out->n[0]) out->n[0][i] = hit->n.x, out->n[1][i] = hit->n.y, out->n[2][i] = hit->n.z;
    if (out->p_err) out->p_err[i] = hit->p_err;
}

/* A sag's derivatives, axis by axis: bounds on the magnitudes of s_x, s_y and s_xy, and what s_xx and s_yy
 * lie in.  Infinite: not known.  turn: 1 for a sag that is certainly convex, -1 for a concave one, else 0. */
typedef struct sgt_by_axis { double x, y, xy, turn; sgt_interval xx, yy; } sgt_by_axis;

/* What the rays and points of one surface have in common.  `share` works it out once for many of them.  How
 * the members are used is the surface's own affair. */
typedef struct sgt_shared {
    double c, k1, radius2, steep, base_c, base_k, most2, noise[2];
    sgt_interval bent; /* as in sgt_extent */
    sgt_by_axis axis;  /* these two are read only if by_axis is set */
    double lean;
    bool by_axis;
    bool boxed;  /* extent_in_part says more than extent_within */
    bool tailed; /* a tail may be known */
    bool ahead;  /* `ahead` may answer */
} sgt_shared;

/* What the departure adds to the rounding of F at a point of that r^2.  NaN beyond most2, and nearer to
 * the axis than half the radius of most2, where the bound is known but coarse.  The base's rounding is
 * `roundings` of what has no noise of its own (bare_of in ray/vicinity.h). */
SGT_INLINE double sgt_noise_at(double e0, double e1, double most2, double r2)
{
    return ((r2 <= most2) & (r2 >= 0.25 * most2)) ? 1.01 * sgt_fma(e1, r2, e0) : (double)NAN;
}

/* What is known of the part of a surface within some radius of the axis.  Lengths are in the unit of the
 * surface.
 *
 *   radius2, steep  as in sgt_shared
 *   z               the heights of all points of this part
 *   bent            the second derivative of the sag along (l, m) is l^2 + m^2 times a number in here
 *
 *   axis            steep and bent by axis; set only for a surface that is steeper along one of them
 *
 * Each bound is infinite if it is not known. */
typedef struct sgt_extent { double radius2, steep; sgt_interval z, bent; sgt_by_axis axis; } sgt_extent;
#define SGT_ANY_NUMBER {-HUGE_VAL, HUGE_VAL}
#define SGT_NO_AXES {HUGE_VAL, HUGE_VAL, HUGE_VAL, 0, SGT_ANY_NUMBER, SGT_ANY_NUMBER}
#define SGT_NO_EXTENT {0, HUGE_VAL, SGT_ANY_NUMBER, SGT_ANY_NUMBER, SGT_NO_AXES}

/* The part of a surface within a radius where |x| and |y| are at most these, and what is known of it along
 * (l, m): `steep` as in sgt_shared; what the second derivative of the sag along (l, m) lies in, as it is for
 * that length; and noise as noise_within has it. */
typedef struct sgt_part { double radius, x, y, l, m, steep; sgt_interval bent; double noise[2]; } sgt_part;

/* What is known of a surface ring by ring.  Ring j reaches from j to j + 1 times `width` from the axis.  In
 * it the sag lies in [low[j], high[j]].  If low[j] > high[j], no part of the surface lies in the ring.
 * Beyond the last ring there is no surface; if `endless` is set, the last ring itself has no outer edge.
 * If width is 0, nothing is known. */
enum { SGT_RINGS = 16 };
typedef struct sgt_heights { double width, low[SGT_RINGS], high[SGT_RINGS]; bool endless; } sgt_heights;

/* c, k and semi_diameter as in sgt_conic, and the sum of a[i] r^(2i + 2), i < terms. */
typedef struct sgt_even_sag { double c, k, semi_diameter; int terms; const double *a; } sgt_even_sag;

/* What `ahead` is asked of some rays, a row each, and answers: nothing is known beyond `clear`; no root is
 * ahead; the next root, if there is one, is the only one in [lo, hi], and near seed.  Up to `clear`, and
 * before lo, there is none.  start: the ray's own.  f: |F| at `from` at most, if that is the origin and may
 * be on the surface; else infinite.  A root there that the rule of the start drops is none.  length: of a
 * first step (in t).  `to` may be made less.  AHEAD_MORE: ask again from `clear`, with its step.
 * step is 0 the first time. */
enum { AHEAD_ROWS = 8 };
typedef double ahead_row[AHEAD_ROWS];
typedef enum sgt_ahead_kind { AHEAD_OPEN, AHEAD_NONE, AHEAD_ONE, AHEAD_MORE } sgt_ahead_kind;
typedef struct sgt_ahead {
    ahead_row o[3], d[3], start, from, to, f, length, step, clear, lo, hi, seed;
    sgt_ahead_kind kind[AHEAD_ROWS];
} sgt_ahead;

struct sgt_builtin_ops {
    /* The operations of each set of instructions (dispatch.h).  Set in the table of operations that a
     * program sees, and there nothing else is set.  NULL in the tables of the sets themselves. */
    const sgt_surface_ops *const *in_set;
    /* The ray has not been checked: SGT_INVALID if it is not valid (ray_valid).  So a form that meets no such
     * ray asks nothing before it has failed. */
    sgt_hit (*meet)(const void *self, const sgt_ray *ray, const sgt_options *opt);
    /* Adds every entry of sgt_intersect_all (roots and undecided stretches) to `list`, and returns 0.
     * Returns SGT_INVALID if a parameter is invalid.  Called by ray/intersect.c and ray/unique.c. */
    sgt_status (*all)(const void *self, const sgt_ray *ray, const sgt_options *opt, sgt_list *list);
    /* Answers the rays of a tile, each as `meet` would.  The rays have not been checked.  A ray that it
     * cannot answer gets the status SGT_HARD; its other outputs are then ignored.  Returns the number of
     * hard rays.  opt has been checked and has no watcher; do not read its t_tol.  May be NULL.  Called by
     * ray/batch.c. */
    size_t (*lanes)(const void *self, const sgt_tile *tile, const sgt_options *opt);
    /* For rays of a tile that have met the root near the seed: is it the only accepted root on the ray with
     * r^2 <= rim2?  Sets unique[i] to
     *
     *   all bits set    certainly no other one exists
     *   SGT_NOT_UNIQUE  certainly another one exists; its interval is stored in others[i] if others is given
     *   0               unknown
     *
     * The root in others[i] may be the one that was met itself, so compare the two.  For rays that `lanes`
     * has met it never is.  For rays that were not met unique[i] is ignored.  hits and t_tol are not read.
     * Returns true if all rays of the tile have all bits set.
     *
     * NULL for level sets: their root is always the first.  NULL for departures and bodies too:
     * ray/unique.c then asks for every root. */
    bool (*unique)(const void *self, const sgt_tile *tile, double rim2, unsigned long long unique[],
                   sgt_interval others[]);
    /* on[i] is 1 for a point that is certainly on the surface by half of the rule of the start (sgt_ray),
     * else 0.  Returns false, and does nothing, if none is known to be.  Called by ray/leave.c. */
    bool (*on)(const void *self, size_t n, const double *const p[3], double on[]);
    /* For n rays that start on the surface: side[i] is the sign of F right behind the start, up to the next
     * root of any kind; 0 where it is not certain.  Returns false, and does nothing, if no side is known.
     * Called by ray/leave.c. */
    bool (*behind)(const void *self, size_t n, const sgt_rays *rays, double side[]);
    /* The first roots of a tile of rays without a proof, from points that may be on the surface; tmin is 0.
     * It answers rays that start on the surface as `on` has it, each as `meet` would, and sets behind[i] as
     * `behind` does.  Others, those of which no side is known, and those that it cannot answer are left
     * SGT_HARD.  Returns how many these are; if it is all of them, nothing else is written.  NULL: all are
     * left.  Called by ray/leave.c. */
    size_t (*leave)(const void *self, const sgt_tile *tile, double behind[]);
    /* The surface as a conic and even powers, for ray/batch_f.c.  Returns false if a parameter is invalid.
     * NULL: it is none. */
    bool (*even_sag)(const void *self, sgt_even_sag *sag);
    /* The largest number of rays in a tile, SGT_TILE to SGT_MOST_TILE.  0 means SGT_TILE.  Read with or
     * without `meet`. */
    size_t tile;

    /* Required without `meet`.  The first parameter that is invalid, with the reason.  {NULL, NULL} if all
     * are valid.  The same as in sgt_builtin. */
    sgt_objection (*object)(const void *self);
    /* Fills what `roundings`, `span` and `spans` are given.  NULL: they need nothing. */
    void (*share)(const void *self, sgt_shared *shared);
    /* The same, as if semi_diameter were at most the one given (length).  Lets ray/by_slope.c ask `spans`
     * for `least` within a clear aperture.  NULL: no such bound; ray/unique.h tests for it. */
    void (*share_within)(const void *self, double semi_diameter, sgt_shared *shared);
    /* The next four are for ray/vicinity.c, ray/wings.c and ray/unique.c: give all of them or none.
     *
     * - extent_within: what is known of the surface within a radius (length); `bent` only if it is wanted.
     * - chords: for n rays, the lo, hi and least of `spans`.  Each ray has its own part of the surface,
     *   given by radius2[i] and steep[i], along x and y by axis[0][i] and axis[1][i] if axis is not NULL.
     * - heights: what is known of the whole surface, ring by ring.
     * - noise_within: how much the departure adds to the rounding of F within a radius of the axis: at most
     *   e[0] + e[1] r^2 (in the unit of F).  NaN: not known. */
    void (*extent_within)(const void *self, double radius, bool bent, sgt_extent *extent);
    void (*chords)(size_t n, sgt_rays rays, const double *radius2, const double *steep,
                   const double *const axis[2], double *lo, double *hi, double *least);
    void (*heights)(const void *self, sgt_heights *out);
    /* The slope and the axes of sgt_extent where |x| and |y| are at most these, and noise as noise_within has
     * it.  All is infinite, and noise NaN, for a surface that is not steeper along one axis than along the
     * other. */
    void (*extent_in_box)(const void *self, double x, double y, double *steep, sgt_by_axis *axis);
    void (*noise_in_box)(const void *self, double x, double y, double e[2]);
    void (*noise_within)(const void *self, double radius, double e[2]);
    /* At most the magnitude of the sag at r = radius (length), with its sign, if the sag has that sign for
     * all r >= radius where it is defined, and is at least (r / radius)^2 times that.  0: not known. */
    double (*tail)(const void *self, double radius);
    /* The range of the second derivative of the sag within the rim, along any direction: narrower than `bent`
     * of `share`, and dearer.  false: no more is known.  NULL: never. */
    bool (*bent)(const void *self, sgt_interval *bent);
    /* Fills in what is known of a part.  false: no more is known than within the radius. */
    bool (*extent_in_part)(const void *self, sgt_part *part);
    /* Looks along n rays, at most AHEAD_ROWS, from `from` to `to`, where none is on the surface as far as
     * rounding tells, but see sgt_ahead.  If n > 1, rows from n on are set, too, and are answered by nothing.
     * Asked where sgt_shared says so.  Called by ray/vicinity.c. */
    void (*ahead)(const void *self, size_t n, sgt_ahead *ahead);
    /* noise_within for n radii, to the bit.  NULL or false: ask one by one. */
    bool (*noises_within)(const void *self, size_t n, const double radius[], double e0[], double e1[]);
    /* Bounds like that of `rounding`, for n points at once.  F at the points is given in f.  out[i] is NaN
     * if no bound is known there.  Returns false if no bound is known anywhere; a given surface returns
     * false always or never.  If it is NULL or returns false, `rounding` is asked instead. */
    bool (*roundings)(const void *self, const sgt_shared *shared, size_t n, sgt_points p, const double f[],
                      double out[]);
    /* `values`, with the gradient, and `roundings` of them at once: the same bits at less cost.  rows is not
     * NULL where the bound on what the departure adds is one of each point; then shared has none of its own,
     * and this is added to each bound (sgt_noise_at of rows[0][i], rows[1][i], rows[2][i]).  Returns false,
     * and does nothing, as `roundings` does.  NULL: the two are asked.  Without `share` neither shared nor
     * rows is read (ray/leave.c). */
    bool (*values_rounded)(const void *self, const sgt_shared *shared, const double *const rows[3], size_t n,
                           sgt_points p, sgt_values out, double own[]);
    /* As `span` and `spans`, with one more output.  *least is a lower bound of |dF/dtau| along the whole
     * span, or 0 if none is known.  tau is counted in lengths of d scaled by a power of two, so that its
     * largest component is in [1, 2) (scale_of).  With such a bound a root needs no evaluation on either
     * side of it.
     *
     * `span` may give a bound only if the span is single.  In `spans`, least[i] > 0 exactly where the span
     * is single, and out.single may be NULL.  NULL: `span` of sgt_surface_ops is asked, and least is 0. */
    sgt_span (*span)(const void *self, const sgt_shared *shared, const sgt_ray *ray, double *least);
    void (*spans)(const void *self, const sgt_shared *shared, size_t n, sgt_rays rays, sgt_spans out,
                  double least[]);
    /* As `first` and `firsts` of sgt_surface_ops, which are offered too, with one more output: steep[i] is a
     * lower bound of |dF/dtau| in [lo, hi], or 0 if none is known.  A root in there needs no evaluation on
     * either side of it. */
    sgt_span (*first)(const void *self, const sgt_ray *ray, double *steep);
    void (*firsts)(const void *self, size_t n, sgt_rays rays, sgt_spans out, double steep[]);
    /* Without `meet`: a closed form of the root that is asked for, without a proof; near: of that near the
     * seed.  A ray that it cannot answer is left to what else there is: `easy` gives it the status SGT_HARD,
     * and its other outputs are then ignored; easy_one returns false.  The rays of `easy` have not been
     * checked, those of easy_one have, and so have the parameters.  `easy` returns the number of hard rays;
     * both have the same bits.  A hit spends one evaluation, a miss none.  Give both or none.  Called by
     * ray/batch.c and ray/answer.c. */
    size_t (*easy)(const void *self, const sgt_tile *tile, bool near);
    bool (*easy_one)(const void *self, const sgt_ray *ray, const sgt_options *opt, sgt_hit *hit);
    /* The seeds of `spans`, alone, and wherever they are: not only within their spans. */
    void (*seeds)(const void *self, const sgt_shared *shared, size_t n, sgt_rays rays, double seed[]);
    /* As `enclose` of sgt_surface_ops, but t is counted from t0 on the ray: the parameter is exactly t0 +
     * t.  The origin of the ray may be so far away that an ulp of t is long compared with what is asked; t0
     * avoids that.  NULL: only the operation of sgt_surface_ops exists.  Called by ray/proof.c and
     * ray/wings.c. */
    sgt_interval (*enclose)(const void *self, const sgt_ray *ray, double t0, sgt_interval t,
                            sgt_interval *slope);
    /* As `encloses` of sgt_surface_ops, and asked for under a proof only: it makes the proofs of a surface
     * that offers `first`.  No output is NULL.  At a point F is known to far more than a double, so a proven
     * root is as sharp as t.  Called by ray/cells_batch.c. */
    void (*encloses)(const void *self, size_t n, sgt_rays rays, const double *t_lo, const double *t_hi,
                     sgt_enclosures out);
    /* May F jump where it is defined (a formula with the cut of atan2)?  Then a change of sign may be no
     * root, and only enclosures are asked.  NULL: it does not. */
    bool (*jumps)(const void *self);
    /* The semi_diameter (length).  NULL: the surface has no rim. */
    double (*rim)(const void *self);
    /* With `departure`: c and k of that base; c is 0 if it is a plane.  Used by system/bundle_sag.c. */
    void (*base)(const void *self, double *c, double *k);
    /* The sag without its conic base (departure/departure.h), with or without `meet`.  Used by
     * departure/sum.c.  NULL: the surface has no such part. */
    const struct departure *departure;
};

#ifdef SGT_SET_NUMBER
/* The same surface with the operations of the set of instructions that this file is compiled for. */
static inline sgt_surface in_set(sgt_surface s)
{
    if (s.ops && s.ops->own_ && s.ops->own_->in_set) s.ops = s.ops->own_->in_set[SGT_SET_NUMBER];
    return s;
}
#endif

/* The members of version 0.2, that each table has; one that ends before them is not read. */
enum {
    SGT_OPS_LEAST = offsetof(sgt_surface_ops, by_parameter) + sizeof(((sgt_surface_ops *)0)->by_parameter)
};
static inline bool is_whole(const sgt_surface_ops *ops)
{
    return ops->own_ || ops->size == 0 || ops->size >= SGT_OPS_LEAST;
}

/* The members of later versions; NULL if the table ends before them.  `encloses` is not read without
 * `enclose`, which answers what cells in lanes leave open. */
typedef void sgt_enclose_many(const void *self, size_t n, sgt_rays rays, const double *t_lo,
                              const double *t_hi, sgt_enclosures out);
static inline bool offers_encloses(const sgt_surface_ops *ops)
{
    size_t end = offsetof(sgt_surface_ops, encloses) + sizeof ops->encloses;
    return (ops->own_ || ops->size >= end) && ops->encloses;
}
static inline sgt_enclose_many *encloses_of(const sgt_surface_ops *ops)
{
    return offers_encloses(ops) && ops->enclose ? ops->encloses : NULL;
}

typedef bool sgt_box_of_points(const void *self, const sgt_interval at[3], sgt_interval *f,
                               sgt_interval gradient[3], sgt_interval second[6]);
static inline sgt_box_of_points *box_of(const sgt_surface_ops *ops)
{
    size_t end = offsetof(sgt_surface_ops, box) + sizeof ops->box;
    return ops->own_ || ops->size >= end ? ops->box : NULL;
}

static inline bool answers_itself(const sgt_surface_ops *ops) { return ops->own_ && ops->own_->meet; }

/* Is it a built-in surface without `meet`?  It is then met by its operations, as a user's is. */
static inline bool is_catalogue(const sgt_surface_ops *ops) { return ops->own_ && !ops->own_->meet; }

#endif
