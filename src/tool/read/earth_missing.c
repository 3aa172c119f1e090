/* earth_missing.c - in place of earth.c where the command is built without GeographicLib. */
#include "earth.h"

#include <string.h>

const sgt_builtin *earth_types(void)
{
    static const sgt_builtin none = {0};
    return &none;
}

const char *earth_missing(const char *type)
{
    static const char *const types[] = {"geodetic_height", "level_gravity", "geoid"};
    for (int i = 0; i < 3; i++)
        if (strcmp(type, types[i]) == 0) return "not available; this command was built without GeographicLib";
    return NULL;
}

const char *earth_take(const document *d, const node *map, const sgt_builtin *type, void *self)
{
    (void)d, (void)map, (void)type, (void)self;
    return "";
}
