/* shape.c - surfaces by the library's table and by our own, which are of one kind.
 *
 * The keys are the names in the table, so that a surface added to either can be read here at
 * once.  Where there is a `curvature` its `radius` may be given instead. */
#include "shape.h"

#include "own.h"

#include <stdio.h>
#include <string.h>

enum { KNOWN_SIZE = 600 };

/* Lists, tables, words and terms are not read here. */
static bool is_read(const sgt_builtin *b)
{
    for (const sgt_param *p = b->params; p->name; p++)
        if (p->kind != SGT_REAL && p->kind != SGT_VECTOR && p->kind != SGT_WHOLE) return false;
    return true;
}

static const sgt_builtin *type_named(const char *name, char known[KNOWN_SIZE])
{
    const sgt_builtin *const tables[] = {sgt_builtins, own_surfaces};
    *known = 0;
    for (int i = 0; i < 2; i++)
        for (const sgt_builtin *b = tables[i]; b->type; b++) {
            if (!is_read(b)) continue;
            if (strcmp(b->type, name) == 0) return b;
            size_t used = strlen(known);
            snprintf(known + used, KNOWN_SIZE - used, "%s%s", used ? ", " : "", b->type);
        }
    return NULL;
}

static bool is_curvature(const sgt_param *p) { return strcmp(p->name, "curvature") == 0; }

static size_t size_of(const sgt_param *p)
{
    return (size_t)p->count * (p->kind == SGT_WHOLE ? sizeof(int) : sizeof(double));
}

/* "slice" is at[3]: two names of one number contradict each other. */
static bool overlap(const sgt_param *p, const sgt_param *q)
{
    return p->offset < q->offset + size_of(q) && q->offset < p->offset + size_of(p);
}

static void read_parameter(document *d, const node *map, const sgt_builtin *b, const sgt_param *p, char *self)
{
    const node *n = document_find(d, map, p->name),
               *radius = is_curvature(p) ? document_find(d, map, "radius") : NULL;
    if (n && radius) document_fail(d, radius, "radius", "given beside curvature; one of the two is enough");
    for (const sgt_param *q = b->params; n && q < p; q++)
        if (overlap(p, q) && document_find(d, map, q->name))
            document_fail(d, n, p->name, "given beside %s, of which it is a part", q->name);
    double value[64] = {0};
    if (radius) {
        double r = document_number(d, radius, "radius", -1e300, 1e300);
        if (fabs(r) < 1e-300)
            document_fail(d, radius, "radius", "must not be zero; a flat surface is a plane");
        value[0] = 1 / r;
    } else if (!n) {
        return;
    } else if (p->count > 1) {
        document_numbers(d, n, p->name, p->kind == SGT_VECTOR ? p->count : 1, p->count, p->lo, p->hi, value);
    } else {
        value[0] = p->kind == SGT_WHOLE ? document_whole(d, n, p->name, (int)p->lo, (int)p->hi)
                                        : document_number(d, n, p->name, p->lo, p->hi);
    }
    int whole = p->kind == SGT_WHOLE ? (int)value[0] : 0;
    memcpy(self + p->offset, p->kind == SGT_WHOLE ? (const void *)&whole : value, size_of(p));
}

void shape_read(document *d, const node *map, const char *more, object *o)
{
    char known[KNOWN_SIZE];
    if (map->type != YAML_MAPPING_NODE)
        document_fail(d, map, "objects", "each must be a map, as {type: torus}");
    const node *type = document_find(d, map, "type");
    if (!type) document_fail(d, map, "type", "missing: which surface is it?");
    const char *name = document_word(d, type, "type");
    const sgt_builtin *b = type_named(name, known);
    if (!b) document_fail(d, type, "type", "no surface \"%.60s\"; there are: %s", name, known);
    if (b->size > SELF_SIZE) document_fail(d, type, "type", "has too many parameters for this program");

    snprintf(known, sizeof known, "type %s", more);
    o->solid = true;
    for (const sgt_param *p = b->params; p->name; p++) {
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, " %s%s", p->name, is_curvature(p) ? " radius" : "");
        if (strcmp(p->name, "semi_diameter") == 0) o->solid = false; /* a sheet with a rim */
    }
    document_map(d, map, NULL, known);
    for (const sgt_param *p = b->params; p->name; p++) read_parameter(d, map, b, p, o->self);
    sgt_objection no = b->object ? b->object(o->self) : (sgt_objection){NULL, NULL};
    if (b->prepare && !no.reason) b->prepare(o->self);
    if (no.reason) {
        const node *n = document_find(d, map, no.param);
        document_fail(d, n ? n : map, no.param, "%s", no.reason);
    }
    o->surface = (sgt_surface){.ops = b->ops, .self = o->self};
}
