// SPDX-License-Identifier: MIT
/* spot.h - sums over the ends of rays, and the image surfaces of a study. */
#ifndef SGT_STUDY_SPOT_H
#define SGT_STUDY_SPOT_H
#include "analyses.h"
#include "exact.h"
#include "study.h"

/* Weighted sums for a centroid; `off`: of p_err.  Of rays, and rounded: of wavelengths together. */
typedef struct middle_sum { exact w, x, y, off; } middle_sum;
typedef struct spot_middle { double w, x, y, off; } spot_middle;
void        sgt_middle_add(middle_sum *m, sgt_vec2 from, size_t count, const sgt_ray_end end[]);
void        sgt_middle_merge(middle_sum *m, const middle_sum *more);
spot_middle sgt_middle_rounded(const middle_sum *m);
void        sgt_middle_join(spot_middle *m, const spot_middle *more, double weight);
sgt_vec2    sgt_middle_of(const spot_middle *m); /* NaN: nothing weighs */

/* Weighted sums of squares about a point; `off`: of p_err. */
typedef struct spread_sum { size_t rays, passed; double far; exact w, x2, y2, off; } spread_sum;
typedef struct spot_spread { size_t rays, passed, joined; double w, x2, y2, off, far; } spot_spread;
void        sgt_spread_add(spread_sum *s, sgt_vec2 about, size_t count, const sgt_ray_end end[]);
void        sgt_spread_merge(spread_sum *s, const spread_sum *more);
spot_spread sgt_spread_rounded(const spread_sum *s);
void        sgt_spread_join(spot_spread *s, const spot_spread *more, double weight);
sgt_spot    sgt_spread_of(const spot_spread *s, sgt_vec2 about);

/* Fields x image surfaces x wavelengths: the cells of a pass, in this order. */
typedef struct spots {
    sgt_asking *ask;
    bool centroid, moved;
    size_t surfaces, cells;
    double *z;                    /* [surfaces]: how far it is moved */
    sgt_element **chief_element;  /* [surfaces], at the primary wavelength */
    sgt_element **element;        /* [surfaces * bands] */
    sgt_ray_end *chief, *centre; /* [fields * surfaces]: at the primary wavelength; of an afocal lens `centre`
                                    is as angles from itself */
} spots;
bool sgt_spots_begin(sgt_asking *a, bool centroid, const sgt_list *defocus, spots *out);

/* For a pass whose data is a `spots`. */
bool sgt_spots_place(const pass *p, size_t i, cell *out, sgt_error *fault);
void sgt_spots_lost(const pass *p, size_t i, sgt_lost_ray *out);

/* Of sums that sgt_middle_add makes. */
void sgt_spots_merge_middles(const void *p, void *into, const void *more);

/* Of an afocal lens: the ends of a cell as angles from the chief ray. */
void sgt_spots_angles(const spots *w, size_t i, size_t count, sgt_ray_end end[]);

/* The weight of a wavelength among all; one alone counts whatever it weighs. */
static inline double sgt_spots_weight(const sgt_asking *a, size_t b)
{
    return a->bands > 1 ? a->band[b].weight : 1;
}

/* The radius of the Airy disc, in the unit of the image; NaN: not known. */
double sgt_spots_airy(const sgt_asking *a, const band *b);

/* Notes each field without a reference. */
void sgt_spots_say_reference(const spots *w);

#endif
