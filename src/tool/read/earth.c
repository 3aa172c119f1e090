/* earth.c - the surfaces about the Earth.
 *
 * A geoid is a grid in the file that `file` names; the default is that of proj-data.  Opened geoids are
 * closed when the command ends. */
#include "earth.h"

#include "../base/memory.h"

#include <sagitta/geo.h>
#include <stdlib.h>
#include <string.h>

const sgt_builtin *earth_types(void) { return sgt_geo_builtins; }

const char *earth_missing(const char *type)
{
    (void)type;
    return NULL;
}

static sgt_geoid **opened;
static size_t count, room;

static void close_all(void)
{
    while (count > 0) sgt_geoid_close(opened[--count]);
}

static const sgt_geoid *geoid_of(const document *d, const node *map)
{
    char found[1000], error[1200];
    const node *n = document_take(map, "file");
    if (!n && !sgt_geoid_find(found, sizeof found))
        document_fail(d, map, "file",
                      "missing, and the default grid, egm96_15.gtx of proj-data, is not installed");
    const char *path = n ? document_path(d, n, "file") : found;
    opened = memory_room(opened, count, &room, sizeof *opened);
    if (count == 0) atexit(close_all);
    sgt_geoid *geoid = sgt_geoid_open(path, error, sizeof error);
    if (!geoid) document_fail(d, n ? n : map, "file", "%s", error);
    opened[count++] = geoid;
    return geoid;
}

const char *earth_take(const document *d, const node *map, const sgt_builtin *type, void *self)
{
    if (type->ops != &sgt_geoid_height_ops) return "";
    sgt_geoid_height *s = self;
    s->geoid = geoid_of(d, map);
    return ", file";
}
