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
