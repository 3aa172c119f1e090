// SPDX-License-Identifier: MIT
/* own.c - the table of this program's own surfaces. */
#include "own.h"

static sgt_objection object_to_edge(const void *self)
{
    const edge *s = self;
    if (!(s->radius > 0)) return (sgt_objection){"radius", "must be above 0"};
    if (!(s->from < s->to)) return (sgt_objection){"to", "must be above from"};
    return (sgt_objection){NULL, NULL};
}

static const sgt_param bulb_params[] = {
    {.name = "iterations",
     .offset = offsetof(mandelbulb, iterations),
     .count = 1,
     .lo = 1,
     .hi = BULB_MOST_ITERATIONS,
     .kind = SGT_PARAM_WHOLE},
    {.name = "escape", .offset = offsetof(mandelbulb, escape), .count = 1, .lo = 1.2, .hi = 100},
    {0}};

#define LENGTH(of, low)                                                                                 \
    {                                                                                                   \
        .name = #of, .unit = {.length = 1}, .offset = offsetof(edge, of), .count = 1, .lo = low, .hi = 1e6 \
    }
static const sgt_param edge_params[] = {LENGTH(radius, 0), LENGTH(from, -1e6), LENGTH(to, -1e6), {0}};

static sgt_objection object_to_box(const void *self)
{
    const box *s = self;
    bool all = s->half[0] > 0 && s->half[1] > 0 && s->half[2] > 0;
    return all ? (sgt_objection){NULL, NULL} : (sgt_objection){"half", "must be three numbers above 0"};
}

static const sgt_param box_params[] = {{.name = "half",
                                        .unit = {.length = 1},
                                        .offset = offsetof(box, half),
                                        .count = 3,
                                        .hi = 1e6,
                                        .kind = SGT_PARAM_VECTOR},
                                       {0}};

#define LEVELS(of, most)                                                                            \
    {                                                                                               \
        .name = "iterations", .offset = offsetof(of, iterations), .count = 1, .lo = 1, .hi = most, \
        .kind = SGT_PARAM_WHOLE                                                                     \
    }
static const sgt_param menger_params[] = {LEVELS(menger, MENGER_MOST), {0}},
                       sierpinski_params[] = {LEVELS(sierpinski, SIERPINSKI_MOST), {0}},
                       mandelbox_params[] = {LEVELS(mandelbox, MANDELBOX_MOST), {0}};

const sgt_builtin own_surfaces[] = {
    {.type = "mandelbulb", .ops = &mandelbulb_ops, .size = sizeof(mandelbulb), .params = bulb_params},
    {.type = "edge", .ops = &edge_ops, .size = sizeof(edge), .params = edge_params, .object = object_to_edge},
    {.type = "box", .ops = &box_ops, .size = sizeof(box), .params = box_params, .object = object_to_box},
    {.type = "menger", .ops = &menger_ops, .size = sizeof(menger), .params = menger_params},
    {.type = "sierpinski", .ops = &sierpinski_ops, .size = sizeof(sierpinski), .params = sierpinski_params},
    {.type = "mandelbox", .ops = &mandelbox_ops, .size = sizeof(mandelbox), .params = mandelbox_params},
    {0},
};
