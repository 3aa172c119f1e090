// SPDX-License-Identifier: MIT
/* aperture.c - the apertures of a surface from its list of maps. */
#include "aperture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A shape and what it needs: sizes by their keys. */
static const struct shape {
    const char *name;
    sgt_aperture_shape shape;
    const char *keys;       /* for messages */
} shapes[] = {
    {"circle", SGT_CIRCLE, "radius"},
    {"annulus", SGT_ANNULUS, "inner, outer"},
    {"rectangle", SGT_RECTANGLE, "half_width, half_height"},
    {"ellipse", SGT_ELLIPSE, "half_width, half_height"},
    {"polygon", SGT_POLYGON, "points"},
    {"spider", SGT_SPIDER, "arms, width, length"},
};
static const double FARTHEST = 0x1p500; /* of a centre or a point: system.h */
enum { SHAPES = sizeof shapes / sizeof shapes[0], ARMS_MOST = 64 };

static const struct shape *shape_of(source *s, const node *map)
{
    const node *n = tree_take(map, "type");
    static const char known[] = "circle, annulus, rectangle, ellipse, polygon or spider";
    if (!n) tree_fail(s, map->line, "type", "missing; it is %s", known);
    const char *name = tree_read_text(s, n, "type");
    for (int i = 0; i < SHAPES; i++)
        if (strcmp(shapes[i].name, name) == 0) return &shapes[i];
    tree_fail(s, n->line, "type", "must be %s, not \"%.60s\"", known, name);
}

static double size_of(source *s, const node *map, const char *key, double otherwise)
{
    const node *n = tree_take(map, key);
    if (!n && otherwise >= 0) return otherwise;
    if (!n) tree_fail(s, map->line, key, "missing");
    double x = tree_read_number(s, n, key, NUMBER_FINITE);
    if (!(x >= 0)) tree_fail(s, n->line, key, "must not be negative, but is %g", x);
    return x;
}

static sgt_vec2 pair_of(source *s, const node *n, const char *key)
{
    double x[2] = {0};
    if (n && (n->kind != NODE_LIST || n->count != 2))
        tree_fail(s, n->line, key, "must be two numbers, [x, y]");
    if (n) tree_read_numbers(s, n, key, 2, x);
    for (int i = 0; i < 2; i++)
        if (!(fabs(x[i]) <= FARTHEST))
            tree_fail(s, n->line, key, "must be at most %.3g in magnitude, but is %g", FARTHEST, x[i]);
    return (sgt_vec2){x[0], x[1]};
}

static const sgt_vec2 *points_of(source *s, const node *map, size_t *count)
{
    const node *list = tree_take(map, "points");
    if (!list || list->kind != NODE_LIST || list->count < 3)
        tree_fail(s, (list ? list : map)->line, "points",
                  "must be a list of at least three points, like [[0, 0], [2, 0], [0, 2]]");
    sgt_vec2 *point = tree_room(s, list->count, sizeof *point);
    for (size_t i = 0; i < list->count; i++) point[i] = pair_of(s, list->item[i], "points");
    *count = list->count;
    return point;
}

static int arms_of(source *s, const node *map)
{
    const node *n = tree_take(map, "arms");
    if (!n) tree_fail(s, map->line, "arms", "missing");
    double x = tree_read_number(s, n, "arms", NUMBER_FINITE);
    if (!(x >= 1 && x <= ARMS_MOST) || x != (int)x)
        tree_fail(s, n->line, "arms", "must be a whole number from 1 to %d, not %g", ARMS_MOST, x);
    return (int)x;
}

static sgt_aperture_item item_of(source *s, const node *map)
{
    const struct shape *shape = shape_of(s, map);
    sgt_aperture_item item = {.shape = shape->shape};
    const node *turn = tree_take(map, "turn"), *obscures = tree_take(map, "obscures");
    switch (item.shape) {
    case SGT_CIRCLE: item.radius = size_of(s, map, "radius", -1); break;
    case SGT_ANNULUS:
        item.inner = size_of(s, map, "inner", -1), item.radius = size_of(s, map, "outer", -1);
        if (item.inner > item.radius) tree_fail(s, map->line, "inner", "must not be larger than outer");
        break;
    case SGT_RECTANGLE:
    case SGT_ELLIPSE:
        item.half.x = size_of(s, map, "half_width", -1), item.half.y = size_of(s, map, "half_height", -1);
        break;
    case SGT_POLYGON: item.vertices = points_of(s, map, &item.count); break;
    case SGT_SPIDER:
        item.arms = arms_of(s, map), item.width = size_of(s, map, "width", -1);
        item.length = size_of(s, map, "length", 0);
        break;
    }
    item.centre = pair_of(s, tree_take(map, "offset"), "offset");
    if (turn) item.degrees = tree_read_number(s, turn, "turn", NUMBER_FINITE);
    item.obscuring = obscures && tree_read_truth(s, obscures, "obscures");
    char known[120];
    snprintf(known, sizeof known, "type, %s, offset, turn, obscures", shape->keys);
    tree_finish(s, map, known);
    return item;
}

const sgt_aperture *sgt_read_apertures(source *s, const node *list)
{
    if (list->kind != NODE_LIST || list->count == 0)
        tree_fail(s, list->line, "apertures", "must be a list, like [{type: circle, radius: 5}]");
    sgt_aperture *a = tree_room(s, 1, sizeof *a);
    sgt_aperture_item *item = tree_room(s, list->count, sizeof *item);
    for (size_t i = 0; i < list->count; i++) {
        tree_map(s, list->item[i], "apertures");
        item[i] = item_of(s, list->item[i]);
    }
    a->count = list->count, a->items = item;
    return a;
}
