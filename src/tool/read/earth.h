/* earth.h - the types of surfaces of sagitta_geo, where the command is built with it. */
#ifndef TOOL_EARTH_H
#define TOOL_EARTH_H
#include "document.h"

#include <sagitta/surfaces.h>

/* Its rows, as sgt_builtins is; none where the command is built without. */
const sgt_builtin *earth_types(void);

/* Why a type of this name is not among them; NULL: there is none of that name. */
const char *earth_missing(const char *type);

/* Takes what is no number out of the map, and puts it in: a geoid's file.  The keys so taken, for messages:
 * ", file", or "". */
const char *earth_take(const document *d, const node *map, const sgt_builtin *type, void *self);

#endif
