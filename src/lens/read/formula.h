// SPDX-License-Identifier: MIT
/* formula.h (of the room) - reads a surface that is a formula from its map. */
#ifndef SGT_LENS_FORMULA_H
#define SGT_LENS_FORMULA_H
#include "surface.h"

/* As sgt_read_surface, of a map whose `type` is formula and has been taken. */
sgt_surface sgt_read_formula(source *s, const node *map, surface_rim rim, const sgt_builtin **type);

#endif
