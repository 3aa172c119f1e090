// SPDX-License-Identifier: MIT
/* surface.h - reads a surface from its map. */
#ifndef SGT_LENS_SURFACE_H
#define SGT_LENS_SURFACE_H
#include "tree.h"

/* What is `semi_diameter`?  OWN_RIM: a parameter of the surface.  NO_RIM: in a lens, the element's clear
 * aperture, which the reader of the lens has taken already.  TERM: a term of a sum has no rim and no base
 * conic; the sum has them. */
typedef enum surface_rim { SURFACE_OWN_RIM, SURFACE_NO_RIM, SURFACE_TERM } surface_rim;

/* Takes `type` and the parameters of that type from a map that tree_map has checked.  Any key that is left
 * is an error.  `others`: the keys that the caller has taken, for the message.  *type: the row of the
 * table. */
sgt_surface sgt_read_surface(source *s, const node *map, surface_rim rim, const char *others,
                             const sgt_builtin **type);

#endif
