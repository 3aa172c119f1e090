// SPDX-License-Identifier: MIT
/* earth.c - the surfaces about the Earth.
 *
 * A geoid is a grid in the file that `file` names; the default is that of proj-data.  Opened geoids are
 * closed when the command ends. */
#include "earth.h"

#include "../base/memory.h"

#include <sagitta/geo.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const sgt_builtin *earth_types(void) { return sgt_geo_builtins(); }

bool earth_rays(sgt_surface s, ray_list *list, sgt_geodetic_height *over)
{
    sgt_geodetic_height own;
    if (!sgt_geodetic_ellipsoid(s, &own)) return false;
    if (over) *over = own;
    for (size_t i = 0; i < list->count && list->places; i++) {
        sgt_ray *r = &list->ray[i].ray;
        const sgt_geodetic_place from = {.latitude = r->o.x, .longitude = r->o.y, .height = r->o.z};
        const sgt_ray ray = sgt_geodetic_ray(&own, from, r->d.x, r->d.y);
        r->o = ray.o, r->d = ray.d;
    }
    list->places = false;
    return true;
}

void earth_places(const sgt_geodetic_height *over, size_t n, const double *const p[3], double *const place[3])
{
    sgt_geodetic_places(over, n, p, place);
}

static sgt_geoid **opened;
static size_t count, room;

static void close_all(void)
{
    while (count > 0) sgt_geoid_close(opened[--count]);
}

const sgt_surface_ops *earth_file_ops(void) { return &sgt_geoid_height_ops; }

const char *earth_complete(void *context, const sgt_builtin *type, void *self, const char *path)
{
    static char why[sizeof(sgt_error) + 20];
    sgt_error error;
    char found[1000];
    (void)context, (void)type;
    if (!path && !sgt_geoid_find(found, sizeof found, &error)) {
        snprintf(why, sizeof why, "missing, and %s", error.words);
        return why;
    }
    opened = memory_room(opened, count, &room, sizeof *opened);
    if (count == 0) atexit(close_all);
    sgt_geoid *geoid = sgt_geoid_open(path ? path : found, &error);
    if (!geoid) {
        snprintf(why, sizeof why, "%s%s%s", error.file, *error.file ? ": " : "", error.words);
        return why;
    }
    opened[count++] = geoid;
    sgt_geoid_height *s = self;
    s->geoid = geoid;
    return NULL;
}
