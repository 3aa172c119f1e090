// SPDX-License-Identifier: MIT
/* formula.h (of the room) - reads a surface that is a formula from its map. */
#ifndef SGT_LENS_FORMULA_H
#define SGT_LENS_FORMULA_H
#include "surface.h"

/* As sgt_read_surface, of a map whose `type` is formula and has been taken. */
sgt_surface sgt_read_formula(source *s, const node *map, surface_rim rim, const sgt_builtin **type);

/* A function, whose text is n, and the parameters all keys of the map that are left: of x and y a
 * sgt_formula_sag, also of z a sgt_formula. */
sgt_surface sgt_read_function(source *s, const node *map, const node *n, const char *key);

#endif
