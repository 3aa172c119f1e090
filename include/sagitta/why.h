// SPDX-License-Identifier: MIT
/* why.h - what became of a ray, in words and numbers: why a search is undecided, why a
 * ray misses, how near it comes, why it ended at an element.  Part of sagitta_lens.
 *
 * The answer itself is taken as it stands.  The reason is found by asking the library
 * again: for more roots, without the rim, of a line beside the ray.
 *
 * TEXTS are in English, for people, and may change with any version: one or two
 * sentences, no full stop at the end, perhaps with a line break inside.  A text goes to
 * text[size], cut if it is too long, with a zero at its end; text may be NULL if size is
 * 0.  Returns the whole length, 0 where there is nothing to say: that is what snprintf
 * does.  Options are named as in sgt_options.
 *
 * Every function may run in any number of threads. */
#ifndef SAGITTA_WHY_H
#define SAGITTA_WHY_H
#include <sagitta/system.h>
#ifdef __cplusplus
extern "C" {
#endif

/* A search for the root of one surface, and its answer. */
typedef struct sgt_search {
    sgt_surface surface;
    double  semi_diameter;      /* of an element's clear aperture; 0: only the surface's
                                   own rim counts */
    sgt_ray ray;                /* in the surface's frame */
    const sgt_options *options; /* NULL: defaults */
    bool near_seed;             /* the pick was SGT_NEAR_SEED, asked for or by default */
    bool fast;                  /* it was the search of dt_min, which proves nothing */
    const sgt_hit *hit;
    unsigned long long reserved_[4]; /* leave it zero */
} sgt_search;

/* "unproven from t = 1 to 2: the ray grazes; there may be a root or none: rounding hides
 * which".  Of any status below 0. */
SGT_API size_t sgt_why_undecided(const sgt_search *s, size_t size, char text[]);

/* "it meets the surface only outside semi_diameter, first at r = 5.2".  Of a ray that
 * certainly misses; nothing if no reason is clear beyond rounding. */
SGT_API size_t sgt_why_missed(sgt_surface s, const sgt_ray *ray, size_t size,
                              char text[]);

/* "lies outside semi_diameter, at r = 5.2": why the library does not accept the place t
 * of the ray, on which another method has settled. */
SGT_API size_t sgt_why_refused(const sgt_search *s, double t, size_t size, char text[]);

/* How near a line that misses a surface comes to it. */
typedef struct sgt_nearest {
    bool     known;    /* else nothing was found near */
    double   distance;
    double   t;        /* the place on the line, in lengths of its direction */
    sgt_vec3 p;        /* the point of the surface that is nearest to it */
    unsigned long long reserved_[4];
} sgt_nearest;

/* An estimate, of the whole line of a ray that misses: tmin and tmax do not count, the
 * surface's own rim does.  A part of the surface that is small beside the distance may be
 * overlooked; then the distance is too large.  Some thousand searches. */
SGT_API sgt_nearest sgt_nearest_of(sgt_surface s, const sgt_ray *ray);

/* ----------------------------------------------------- why a ray ended at an element */

/* A ray as it came to an element, in the element's frame. */
typedef struct sgt_arrival {
    sgt_vec3 from;           /* the point before, or the launch */
    sgt_vec3 direction;      /* of unit length */
    sgt_vec3 p;              /* where it was met; not read if it was missed */
    double   index, behind;  /* of the media in front and behind */
    unsigned long long reserved_[4]; /* leave it zero */
} sgt_arrival;

/* The angle between the ray and the normal at p, in degrees, 0 to 90. */
SGT_API double sgt_incidence(const sgt_element *e, const sgt_arrival *a);

/* The least angle of total reflection in degrees; 90: there is none. */
SGT_API double sgt_critical_angle(const sgt_arrival *a);

/* "clipped by its semi_diameter: r = 5.2 is beyond 5", "totally reflected: incidence 53.1
 * degrees, critical angle 41.2", "clipped by aperture 2 (rectangle): 0.3 beyond its
 * edge", "missed it: its line crosses the vertex plane 20 from the axis"; nothing for a
 * ray that passed or was lost.
 *
 *     e           the element where the ray ended
 *     fate        what became of it there
 *     a           how it came, in the element's frame
 *     size, text  as in TEXTS above */
SGT_API size_t sgt_why_ended(const sgt_element *e, sgt_fate fate, const sgt_arrival *a,
                             size_t size, char text[]);

#ifdef __cplusplus
}
#endif
#endif
