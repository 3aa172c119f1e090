/* builtin.h - what a built-in surface can do that a user's cannot.  Either it answers by itself,
 * SGT_INVALID included where a parameter is (`meet` and what belongs to it); ray and opt have been checked.
 * Or, without `meet`, it is met as a surface of a user is, by its operations, and says here what they
 * cannot: whether its parameters are valid, and its rim. */
#ifndef SGT_SURFACE_BUILTIN_H
#define SGT_SURFACE_BUILTIN_H

#include "../solve/entries.h"

#include <math.h>
#include <stddef.h>
#include <sagitta/sagitta.h>
#include <sagitta/surfaces.h>

/* Some rays of a batch: at most SGT_TILE, or the surface's own `tile`, each array at the first of them.  Of
 * the rays no array is NULL, of the hits status is not; tmax is explicit.  t_tol: of each ray its own. */
enum { SGT_TILE = 128, SGT_MOST_TILE = 512, SGT_HARD = -100, SGT_NOT_UNIQUE = 1 };
typedef struct sgt_tile { size_t n; sgt_rays rays; const double *t_tol; sgt_hits hits; } sgt_tile;

/* What the rays and points of one surface share, worked out once for many (share): its use is the surface's
 * own. */
typedef struct sgt_shared { double c, k1, radius2, steep, base_c, base_k, most2, noise[2]; } sgt_shared;

/* What is known of the part of a surface within some radius: radius2 and steep as a sgt_shared has them;
 * size: no part of it is farther from the plane z = 0; bend: the norm of the second derivative of the sag is
 * nowhere above it; infinite where that is not known. */
typedef struct sgt_extent { double radius2, steep, size, bend; } sgt_extent;

/* What is known of a surface ring by ring: from j to j + 1 widths of the axis its sag is in [low[j],
 * high[j]]; low > high: there is none of it, nor beyond the last ring, which where it is endless has no outer
 * rim.  width 0: nothing is known. */
enum { SGT_RINGS = 16 };
typedef struct sgt_heights { double width, low[SGT_RINGS], high[SGT_RINGS]; bool endless; } sgt_heights;

struct sgt_builtin_ops {
    /* Of the table of operations that a program sees: those of each set of instructions (dispatch.h), and
     * nothing else; NULL in those. */
    const sgt_surface_ops *const *in_set;
    sgt_hit (*meet)(const void *self, const sgt_ray *ray, const sgt_options *opt);
    /* SGT_INVALID, or zero with every entry added. */
    sgt_status (*all)(const void *self, const sgt_ray *ray, const sgt_options *opt, sgt_list *list);
    /* Answers what it can of a tile, each ray as `meet` would, unchecked rays among them; gives the rest
     * the status SGT_HARD (what it leaves in their other outputs is of no account) and returns how many
     * those are.  opt has been checked and asks for no watcher; its t_tol is not to be read.  May be NULL. */
    size_t (*lanes)(const void *self, const sgt_tile *tile, const sgt_options *opt);
    /* Of the rays of a tile that have met the root near the seed: alone[i] is made all bits set where
     * certainly no other root that counts lies on the ray within r^2 <= rim2; SGT_NOT_UNIQUE where
     * certainly one does, in others[i] (may be NULL), unless it is the root that was met itself, and that
     * of a tile never is; else 0.  Of other rays it is of no account; hits and t_tol are not read.  true:
     * all are alone.  NULL: the surface has but first roots. */
    bool (*unique)(const void *self, const sgt_tile *tile, double rim2, unsigned long long unique[],
                   sgt_interval others[]);
    /* With or without `meet`: the most rays in a tile, SGT_TILE ... SGT_MOST_TILE; 0: SGT_TILE. */
    size_t tile;

    /* Without `meet`.  {NULL, NULL} where every parameter is valid, as in sgt_builtin; required. */
    sgt_objection (*object)(const void *self);
    /* What `roundings`, `span` and `spans` are to be given; NULL: nothing. */
    void (*share)(const void *self, sgt_shared *shared);
    /* The same as if semi_diameter were no more than that.  NULL: `least` of `spans` is not to be had so
     * (vicinity.h). */
    void (*share_within)(const void *self, double semi_diameter, sgt_shared *shared);
    /* Of vicinity.h, all of them or none: what is known within a radius; of n rays, each with such a part of
     * the surface of its own, what `spans` says but for the seed; */
    void (*extent_within)(const void *self, double radius, sgt_extent *extent);
    void (*chords)(size_t n, sgt_rays rays, const double *radius2, const double *steep, double *lo,
                   double *hi, double *least);
    void (*heights)(const void *self, sgt_heights *out);
    /* what the departure adds to the rounding of F within that radius of the axis, e[0] + e[1] r^2; NaN: not
     * known. */
    void (*noise_within)(const void *self, double radius, double e[2]);
    /* A bound as `rounding` gives it, at n points where F is f, in lanes, NaN where it is not known.  NULL,
     * or false, always of one surface: it knows none, and `rounding` is to be asked. */
    bool (*roundings)(const void *self, const sgt_shared *shared, size_t n, sgt_points p, const double f[],
                      double out[]);
    /* As `span` and `spans`, and of rays whose span is single *least, a bound from below on |dF/dtau| all
     * along it, tau in lengths of d made 1 ... 2 by a power of two (scale_of), or 0: with it a root needs
     * no look at either side.  Of `spans` it is above 0 just where the span is single, and out.single may
     * be NULL.  NULL: as 0. */
    sgt_span (*span)(const void *self, const sgt_shared *shared, const sgt_ray *ray, double *least);
    void (*spans)(const void *self, const sgt_shared *shared, size_t n, sgt_rays rays, sgt_spans out,
                  double least[]);
    /* As `enclose` of sgt_surface_ops, t counted from t0 of the ray, t0 + t exactly: from afar an ulp of t
     * alone is wide.  NULL: there is only that. */
    sgt_interval (*enclose)(const void *self, const sgt_ray *ray, double t0, sgt_interval t,
                            sgt_interval *slope);
    /* Its semi_diameter; NULL: it has no rim. */
    double (*rim)(const void *self);
    /* The sag without its conic base (departure.h), with or without `meet`; NULL: it has none that can be
     * told apart. */
    const struct departure *departure;
};

#ifdef SGT_SET_NUMBER
/* The same surface with the operations of the set that this is compiled for. */
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

static inline bool answers_itself(const sgt_surface_ops *ops) { return ops->own_ && ops->own_->meet; }

/* Is it a built-in surface without `meet`?  It is then met by its operations, as a user's is. */
static inline bool is_catalogue(const sgt_surface_ops *ops) { return ops->own_ && !ops->own_->meet; }

#endif
