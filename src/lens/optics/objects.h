// SPDX-License-Identifier: MIT
/* objects.h - what each surface of a lens has for an object; in first_order.c. */
#ifndef SGT_OPTICS_OBJECTS_H
#define SGT_OPTICS_OBJECTS_H
#include "../read/lens.h"

/* The paraxial distance of the object in front of each surface, as all that is in front of that forms its
 * image; on the side that light comes from, negative behind; infinite for collimated light.  NaN: a surface
 * in front has no vertex curvature, or is tilted by its origin. */
void sgt_paraxial_objects(const sgt_lens *lens, double um, source *s, double distance[]);

#endif
