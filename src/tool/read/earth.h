/* earth.h - the surface types of sagitta_geo, if the command is built with it. */
#ifndef TOOL_EARTH_H
#define TOOL_EARTH_H
#include "document.h"

#include <sagitta/surfaces.h>

/* A table like sgt_builtins; empty if the command is built without sagitta_geo. */
const sgt_builtin *earth_types(void);

/* Why a type of this name is not available; NULL if it is, or if there is no such type. */
const char *earth_missing(const char *type);

/* Takes the keys that are not numbers from the map and sets them in self: the file of a geoid.  Returns these
 * keys for messages: ", file" or "". */
const char *earth_take(const document *d, const node *map, const sgt_builtin *type, void *self);

#endif
