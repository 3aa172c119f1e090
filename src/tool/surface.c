/* surface.c - a surface from its YAML map, by the library's table.
 *
 * The keys are the names of the parameters in sgt_builtins, their places and limits the
 * table's: a surface added there can be read here.  One convenience is ours: wherever a
 * parameter is a `curvature`, the map may give the `radius` instead, and the parameter is
 * 1/radius, rounded once (an infinite one is a plane).  `curvature_x` has its `radius_x`
 * in the same way. */
#include "surface.h"

#include "memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char CURVATURE[] = "curvature", RADIUS[] = "radius";
enum { NAME_SIZE = 64 };

/* The name of the radius that stands for a curvature; "" where there is none. */
static void radius_name(char name[NAME_SIZE], const char *parameter)
{
    size_t stem = strlen(CURVATURE);
    if (strncmp(parameter, CURVATURE, stem) == 0) snprintf(name, NAME_SIZE, "%s%s", RADIUS, parameter + stem);
    else name[0] = 0;
}

static bool not_read(const sgt_param *p, surface_rim rim)
{
    return rim == SURFACE_NO_RIM && strcmp(p->name, "semi_diameter") == 0;
}

const char *surface_keys(const sgt_builtin *type, surface_rim rim)
{
    char text[600];
    size_t length = (size_t)snprintf(text, sizeof text, "type");
    for (const sgt_param *p = type->params; p->name && length < sizeof text; p++) {
        if (not_read(p, rim)) continue;
        char radius[NAME_SIZE];
        radius_name(radius, p->name);
        const char *or = *radius ? " or " : "";
        length += (size_t)snprintf(text + length, sizeof text - length, ", %s%s%s", p->name, or, radius);
    }
    return memory_text(text, strlen(text));
}

static const sgt_builtin *type_of(const document *d, const node *map)
{
    const node *n = document_take(map, "type");
    if (!n) document_fail(d, map, "type", "missing: which surface is it?");
    const char *name = document_text(d, n, "type");
    char known[300];
    size_t length = 0;
    for (const sgt_builtin *b = sgt_builtins; b->type; b++) {
        if (strcmp(b->type, name) == 0) return b;
        if (length < sizeof known)
            length += (size_t)snprintf(known + length, sizeof known - length, "%s%s", length ? ", " : "", b->type);
    }
    document_fail(d, n, "type", "no surface \"%.60s\"; there are: %s", name, known);
}

static double curvature_of(const document *d, const node *n, const char *key)
{
    double radius = document_number(d, n, key, NUMBER_MAYBE_INFINITE);
    if (isinf(radius)) return 0;
    if (radius == 0) document_fail(d, n, key, "must not be zero; a flat surface has the radius .inf");
    if (isinf(1 / radius)) document_fail(d, n, key, "too small: %.60s", n->text);
    return 1 / radius;
}

static void check_range(const document *d, const node *n, const char *key, const sgt_param *p, double x)
{
    if (x >= p->lo && x <= p->hi) return;
    document_fail(d, n, key, "must be at least %g and at most %g (unit: %s), not %.17g", p->lo, p->hi, p->unit, x);
}

static void read_parameter(const document *d, const node *map, const sgt_param *p, double *value)
{
    char radius[NAME_SIZE];
    radius_name(radius, p->name);
    const node *n = document_take(map, p->name);
    const node *reciprocal = *radius ? document_take(map, radius) : NULL;
    if (n && reciprocal) document_fail(d, reciprocal, radius, "given beside %s; one of the two is enough", p->name);
    if (reciprocal) {
        *value = curvature_of(d, reciprocal, radius);
        check_range(d, reciprocal, radius, p, *value);
    } else if (n && p->count > 1) {
        size_t count = document_numbers(d, n, p->name, (size_t)p->count, value);
        for (size_t i = 0; i < count; i++) check_range(d, n->item[i], p->name, p, value[i]);
    } else if (n) {
        *value = document_number(d, n, p->name, NUMBER_FINITE);
        check_range(d, n, p->name, p, *value);
    }
}

sgt_surface surface_read(const document *d, const node *map, surface_rim rim, const sgt_builtin **type)
{
    const sgt_builtin *b = type_of(d, map);
    char *self = memory_take(1, b->size);
    for (const sgt_param *p = b->params; p->name; p++) {
        if (not_read(p, rim)) continue;
        read_parameter(d, map, p, (double *)(void *)(self + p->offset));
    }
    if (type) *type = b;
    return (sgt_surface){.ops = b->ops, .self = self};
}

sgt_surface surface_parse(const char *option, const char *text)
{
    document d = document_parse(option, text, strlen(text));
    const sgt_builtin *type;
    document_map(&d, d.root, NULL);
    sgt_surface s = surface_read(&d, d.root, SURFACE_OWN_RIM, &type);
    document_finish(&d, d.root, surface_keys(type, SURFACE_OWN_RIM));
    return s;
}
