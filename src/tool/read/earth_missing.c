// SPDX-License-Identifier: MIT
/* earth_missing.c - in place of earth.c where the command is built without GeographicLib. */
#include "earth.h"

#include <stddef.h>

const sgt_builtin *earth_types(void) { return NULL; }

bool earth_rays(sgt_surface s, ray_list *list, sgt_geodetic_height *over)
{
    (void)s, (void)list, (void)over;
    return false;
}

void earth_places(const sgt_geodetic_height *over, size_t n, const double *const p[3], double *const place[3])
{
    (void)over, (void)n, (void)p, (void)place;
}

const sgt_surface_ops *earth_file_ops(void) { return NULL; }

const char *earth_complete(void *context, const sgt_builtin *type, void *self, const char *path)
{
    (void)context, (void)type, (void)self, (void)path;
    return NULL;
}
