// SPDX-License-Identifier: MIT
/* earth_missing.c - in place of earth.c where the command is built without GeographicLib. */
#include "earth.h"

#include <stddef.h>

const sgt_builtin *earth_types(void) { return NULL; }

const sgt_surface_ops *earth_file_ops(void) { return NULL; }

const char *earth_complete(void *context, const sgt_builtin *type, void *self, const char *path)
{
    (void)context, (void)type, (void)self, (void)path;
    return NULL;
}
