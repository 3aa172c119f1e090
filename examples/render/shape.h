// SPDX-License-Identifier: MIT
/* shape.h - the surface of an object, from its map. */
#ifndef RENDER_SHAPE_H
#define RENDER_SHAPE_H
#include "document.h"
#include "scene.h"

/* Reads `type` and the parameters of that type into o->surface, o->read and o->sheet; `more`
 * are the keys that are the caller's to read. */
void shape_read(document *d, const node *map, const char *more, object *o);

#endif
