// SPDX-License-Identifier: MIT
/* parabasal.h - the two sections of a chief ray, the first of them along any direction. */
#ifndef SGT_LENS_PARABASAL_H
#define SGT_LENS_PARABASAL_H
#include <sagitta/lens.h>

/* focus: `image` of sgt_parabasal, also where the sections mix: where rays of a section have no distance from
 * the chief ray along it.  NaN: there is none.  along: the sections at the last element, in its frame. */
typedef struct sgt_sections { double focus[2]; sgt_vec3 along[2]; } sgt_sections;

/* A chief ray and how it went through the elements, from a point or from afar. */
typedef struct sgt_chief_ray {
    size_t elements;
    const sgt_element *e;
    double index_before;
    const sgt_ray *ray;
    const sgt_passage *passages;
    bool from_point;
} sgt_chief_ray;

/* sgt_lens_parabasal with [0] along `across`, global, as far as that is across the chief ray.  sections may
 * be NULL. */
bool sgt_parabasal_about(const sgt_chief_ray *chief, sgt_vec3 across, sgt_parabasal *out,
                         sgt_sections *sections);

#endif
