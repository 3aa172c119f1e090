/* surface.c - a surface from its YAML map, by the library's table.
 *
 * The keys are the names of the parameters in sgt_builtins, their places and limits the
 * table's: a surface added there can be read here.  One convenience is ours: wherever a
 * parameter is a `curvature`, the map may give the `radius` instead, and the parameter is
 * 1/radius, rounded once (an infinite one is a plane).  `curvature_x` has its `radius_x`
 * in the same way.
 *
 * Two parameters of a type may lie in the same memory: one is then a short name for a part
 * of the other, and a map that gives both contradicts itself.  What the ranges of single
 * numbers cannot say, the type's `object` does, when all have been read. */
#include "surface.h"

#include "memory.h"
#include "number.h"

#include <float.h>
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

/* The legal values in words: "a whole number from 1 to 100". */
static void check_range(const document *d, const node *n, const char *key, const sgt_param *p, double x)
{
    bool whole = p->kind == SGT_WHOLE;
    if (x >= p->lo && x <= p->hi && !(whole && x != floor(x))) return;
    char range[120], given[NUMBER_SIZE];
    number_print(given, x, false);
    if (p->hi < DBL_MAX) snprintf(range, sizeof range, "%sfrom %.10g to %.10g", whole ? "a whole number " : "", p->lo, p->hi);
    else if (p->lo > -DBL_MAX) snprintf(range, sizeof range, "finite and at least %.10g", p->lo);
    else snprintf(range, sizeof range, "finite");
    const char *unit = strcmp(p->unit, "1") == 0 ? "" : p->unit;
    document_fail(d, n, key, "must be %s%s%s%s, not %s", range, *unit ? " (unit: " : "", unit, *unit ? ")" : "", given);
}

static double read_number(const document *d, const node *n, const char *key, const sgt_param *p)
{
    double x = document_number(d, n, key, NUMBER_ANY);
    check_range(d, n, key, p, x);
    return x;
}

static void read_list(const document *d, const node *n, const sgt_param *p, double value[])
{
    size_t most = (size_t)p->count;
    bool exact = p->kind == SGT_VECTOR;
    if (n->kind != NODE_LIST) document_fail(d, n, p->name, "must be a list of %s%zu numbers", exact ? "" : "up to ", most);
    if (n->count == 0) document_fail(d, n, p->name, "must hold at least one number");
    if (n->count > most || (exact && n->count < most))
        document_fail(d, n, p->name, "has %zu number%s; %zu are %s", n->count, n->count == 1 ? "" : "s", most,
                      exact ? "wanted" : "the most");
    for (size_t i = 0; i < n->count; i++) {
        char key[NAME_SIZE + 30];
        snprintf(key, sizeof key, "%.*s[%zu]", NAME_SIZE, p->name, i);
        value[i] = read_number(d, n->item[i], key, p);
    }
}

/* The value of a parameter, and *key, the name it is given by; NULL: it is not given. */
static node *given_as(const document *d, const node *map, const sgt_param *p, char key[NAME_SIZE])
{
    radius_name(key, p->name);
    node *n = document_take(map, p->name), *reciprocal = *key ? document_take(map, key) : NULL;
    if (n && reciprocal) document_fail(d, reciprocal, key, "given beside %s; one of the two is enough", p->name);
    if (!reciprocal) snprintf(key, NAME_SIZE, "%s", p->name);
    return reciprocal ? reciprocal : n;
}

static bool share_memory(const sgt_param *a, const sgt_param *b)
{
    size_t end_a = a->offset + (size_t)a->count * (a->kind == SGT_WHOLE ? sizeof(int) : sizeof(double));
    size_t end_b = b->offset + (size_t)b->count * (b->kind == SGT_WHOLE ? sizeof(int) : sizeof(double));
    return a->offset < end_b && b->offset < end_a;
}

static void read_parameter(const document *d, const node *map, const sgt_builtin *b, const sgt_param *p, char *self)
{
    char key[NAME_SIZE];
    const node *n = given_as(d, map, p, key);
    if (!n) return;
    for (const sgt_param *q = b->params; q < p; q++)
        if (share_memory(p, q) && document_take(map, q->name))
            document_fail(d, n, key, "given beside %s, of which it is a part; one of the two is enough", q->name);
    void *to = self + p->offset;
    if (strcmp(key, p->name) != 0) {
        double *value = to;
        *value = curvature_of(d, n, key);
        check_range(d, n, key, p, *value);
    } else if (p->count > 1) {
        read_list(d, n, p, to);
    } else if (p->kind == SGT_WHOLE) {
        int *value = to;
        *value = (int)read_number(d, n, key, p);
    } else {
        double *value = to;
        *value = read_number(d, n, key, p);
    }
}

/* What is wrong with the whole is told of the parameter that makes it so, or, if that was
 * left out, of the map. */
static void check_whole(const document *d, const node *map, const sgt_builtin *b, const void *self)
{
    sgt_objection no = b->object ? b->object(self) : (sgt_objection){NULL, NULL};
    if (!no.reason) return;
    const node *n = document_take(map, no.param);
    document_fail(d, n ? n : map, no.param, "%s%s", n ? "" : "not given, and so ", no.reason);
}

sgt_surface surface_read(const document *d, const node *map, surface_rim rim, const sgt_builtin **type)
{
    const sgt_builtin *b = type_of(d, map);
    char *self = memory_take(1, b->size);
    for (const sgt_param *p = b->params; p->name; p++) {
        if (not_read(p, rim)) continue;
        read_parameter(d, map, b, p, self);
    }
    check_whole(d, map, b, self);
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
